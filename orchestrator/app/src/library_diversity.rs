//! `library diversity`: how different the scenarios of a library are from each other, by their ways and by how the robot drove.
//!
//! ```text
//! bundles ─► node sequences ─► Levenshtein, robot and people ─┐
//!        └─► first run, robot every 0.5 s ─► time warping ────┴─► by location: every pair, the nearest of each
//! ```
//!
//! The distances of RVSG that need no model: edits of node sequences over the longer of the two (0 the same, 1 nothing in
//! common) and dynamic time warping of tracks in m. Nodes and meters of two locations have nothing to do with each other, so only
//! pairs on one location are compared.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use serde_json::{Value, json};
use socrates_model::{AgentId, NodeId, Paths, Recording};
use socrates_stats::{median, quantile, time_warp};
use socrates_stream::csv::joined;

use crate::bundle;
use crate::exit::Diagnostic;
use crate::files;
use crate::labels::folders;
use crate::output::Printer;
use crate::progress::Progress;

/// Time between two points of a track, s.
const STEP_SECS: f64 = 0.5;

/// What is asked.
#[derive(Debug, Clone)]
pub struct DiversityOptions {
    /// Bundles, or folders of bundles.
    pub what: Vec<PathBuf>,
    /// Scenarios that are compared, at most: of more, as many that are evenly spread over the list.
    pub most: usize,
    /// A table of every pair (CSV); none writes none.
    pub out: Option<PathBuf>,
}

/// What is compared of a scenario.
#[derive(Debug, Clone)]
struct One {
    name: String,
    location: String,
    robot: Vec<NodeId>,
    people: Vec<Vec<NodeId>>,
    track: Vec<[f64; 2]>,
}

/// How far two scenarios are from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair {
    one: usize,
    other: usize,
    /// Edits of the robot's nodes over the longer way, 0 to 1.
    robot_way: f64,
    /// The same of people: mean over both of the nearest way in the other; `None` without people in both.
    people_way: Option<f64>,
    /// Time warping of the robot's tracks, m; `None` where one has no robot.
    track_m: Option<f64>,
}

/// Prints how different the scenarios of a library are; with `out`, writes every pair as a table too.
///
/// # Errors
/// A folder without bundles, a bundle that cannot be read, fewer than two scenarios on any location, a file that cannot be written or
/// is no `.csv`.
pub fn diversity(talk: &Printer, options: &DiversityOptions) -> Result<(), Diagnostic> {
    if let Some(out) = options.out.as_deref().filter(|out| out.extension().is_none_or(|ending| ending != "csv")) {
        let what = format!("cannot write `{}`: pairs are written as CSV", out.display());
        return Err(Diagnostic::input(what, "--out pairs.csv; `--format json` prints the summary for programs"));
    }
    let (all, found) = scenarios(talk, options)?;
    let mut places: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, one) in all.iter().enumerate() {
        places.entry(&one.location).or_default().push(index);
    }
    let pairs: BTreeMap<&str, Vec<Pair>> =
        places.iter().map(|(place, of)| (*place, pairs(&all, of))).filter(|(_, pairs)| !pairs.is_empty()).collect();
    if pairs.is_empty() {
        return Err(Diagnostic::input(
            format!("of `{}` scenarios no two are on one location: there is no pair to compare", all.len()),
            "name a library with two scenarios of a location, or several libraries",
        ));
    }
    if found > all.len() {
        talk.line(&format!("compared   {} of {found} scenarios, evenly spread over the list (--most)", all.len()));
    }
    let mut told = Vec::new();
    for (place, pairs) in &pairs {
        told.push(tell(talk, place, &all, pairs));
    }
    if let Some(out) = &options.out {
        files::write(out, csv(&all, pairs.values().flatten()).as_bytes())?;
        talk.line(&format!("wrote      {}", out.display()));
    }
    talk.result(&json!({ "scenarios": found, "compared": all.len(), "locations": told }));
    Ok(())
}

/// The scenarios that are compared, and how many there are.
fn scenarios(talk: &Printer, options: &DiversityOptions) -> Result<(Vec<One>, usize), Diagnostic> {
    let dirs = folders(&options.what)?;
    if options.most < 2 {
        return Err(Diagnostic::input(format!("`--most {}` leaves no pair", options.most), "2 or more; default 200"));
    }
    let kept = dirs.len().min(options.most);
    let mut progress = Progress::new(*talk, "reading", kept);
    let mut all = Vec::with_capacity(kept);
    for (index, dir) in (0..kept).filter_map(|k| Some((k, dirs.get(k * dirs.len() / kept)?))) {
        progress.at(index, "");
        let bundle = bundle::read_some(dir, |index, _| index == 0)?;
        let Paths { robot, humans, .. } = &bundle.paths;
        all.push(One {
            name: dir.file_name().map_or_else(|| dir.display().to_string(), |name| name.to_string_lossy().into_owned()),
            location: bundle.location.name.clone(),
            robot: robot.clone(),
            people: humans.values().cloned().collect(),
            track: bundle.runs.first().map_or_else(Vec::new, |(recording, _)| track(recording)),
        });
    }
    Ok((all, dirs.len()))
}

/// The robot's places, every half a second.
fn track(run: &Recording) -> Vec<[f64; 2]> {
    let mut next_s = f64::NEG_INFINITY;
    let mut found = Vec::new();
    for state in run.frames.iter().filter(|state| state.agent == AgentId::Robot.number()) {
        #[expect(clippy::cast_precision_loss, reason = "ticks of a run are far below 2^53")]
        let t = state.tick as f64 * run.header.step_s;
        if t >= next_s - 1e-9 {
            found.push([state.x, state.y]);
            next_s = t + STEP_SECS;
        }
    }
    found
}

/// Edits that make one way of the other, over the longer of both.
fn edits(one: &[NodeId], other: &[NodeId]) -> f64 {
    let longer = one.len().max(other.len());
    let (one, other): (Vec<&NodeId>, Vec<&NodeId>) = (one.iter().collect(), other.iter().collect());
    let edits = strsim::generic_levenshtein(&one, &other);
    #[expect(clippy::cast_precision_loss, reason = "ways have few nodes")]
    let share = edits as f64 / longer.max(1) as f64;
    share
}

/// How far the people of two scenarios walk from each other: everybody's nearest way in the other scenario, the mean of both sides.
fn people(one: &One, other: &One) -> Option<f64> {
    let nearest = |from: &[Vec<NodeId>], to: &[Vec<NodeId>]| {
        let all: Vec<f64> =
            from.iter().map(|way| to.iter().map(|other| edits(way, other)).fold(1.0, f64::min)).collect();
        socrates_stats::mean(&all).ok()
    };
    match (nearest(&one.people, &other.people), nearest(&other.people, &one.people)) {
        (Some(a), Some(b)) => Some(f64::midpoint(a, b)),
        (one, other) => one.or(other),
    }
}

fn pairs(all: &[One], of: &[usize]) -> Vec<Pair> {
    let mut found = Vec::new();
    for (place, one) in of.iter().enumerate() {
        for other in of.iter().skip(place + 1) {
            let Some((a, b)) = all.get(*one).zip(all.get(*other)) else { continue };
            found.push(Pair {
                one: *one,
                other: *other,
                robot_way: edits(&a.robot, &b.robot),
                people_way: people(a, b),
                track_m: time_warp(&a.track, &b.track).ok(),
            });
        }
    }
    found
}

/// A distance: its column, what it is, and how it is had.
type Kind<'k> = (&'k str, &'k str, &'k dyn Fn(&Pair) -> Option<f64>);

/// Prints the pairs of a location in short, and gives them for programs.
fn tell(talk: &Printer, place: &str, all: &[One], pairs: &[Pair]) -> Value {
    let scenarios: BTreeSet<usize> = pairs.iter().flat_map(|pair| [pair.one, pair.other]).collect();
    talk.line(&format!("{place:<10} {} scenarios, {} pairs", scenarios.len(), pairs.len()));
    let mut values = serde_json::Map::new();
    let kinds: [Kind<'_>; 3] = [
        ("robot_way", "robot's nodes, share of edits", &|pair| Some(pair.robot_way)),
        ("people_way", "people's nodes, share of edits", &|pair| pair.people_way),
        ("track_m", "robot's tracks, m", &|pair| pair.track_m),
    ];
    for (name, words, of) in kinds {
        let (every, nearest) = (spread(pairs.iter().filter_map(of).collect()), spread(nearest(&scenarios, pairs, of)));
        let shown = |told: Option<[f64; 3]>| {
            told.map_or_else(
                || "no value".to_owned(),
                |[low, middle, high]| format!("{middle:.2} ({low:.2} to {high:.2})"),
            )
        };
        talk.line(&format!("  {words:<31} all pairs {}, nearest of each {}", shown(every), shown(nearest)));
        values.insert(name.to_owned(), json!({ "pairs": every, "nearest": nearest }));
    }
    let alike = pairs
        .iter()
        .filter(|pair| pair.track_m.is_some())
        .min_by(|a, b| a.track_m.partial_cmp(&b.track_m).unwrap_or(std::cmp::Ordering::Equal));
    let names = alike.and_then(|pair| Some([&all.get(pair.one)?.name, &all.get(pair.other)?.name]));
    if let Some([one, other]) = names {
        talk.line(&format!("  most alike by tracks             {one} and {other}"));
    }
    json!({ "location": place, "scenarios": scenarios.len(), "pairs": pairs.len(), "distances": values, "most_alike": names })
}

/// The distance of each scenario to its nearest.
fn nearest(scenarios: &BTreeSet<usize>, pairs: &[Pair], of: &dyn Fn(&Pair) -> Option<f64>) -> Vec<f64> {
    let own = |index: &usize| {
        pairs.iter().filter(|pair| pair.one == *index || pair.other == *index).filter_map(of).reduce(f64::min)
    };
    scenarios.iter().filter_map(own).collect()
}

/// Smallest, median and largest; `None` of nothing.
fn spread(values: Vec<f64>) -> Option<[f64; 3]> {
    Some([quantile(&values, 0.0).ok()?, median(&values).ok()?, quantile(&values, 1.0).ok()?])
}

fn csv<'p>(all: &[One], pairs: impl Iterator<Item = &'p Pair>) -> String {
    let mut text = String::from("location,one,other,robot_way,people_way,track_m\n");
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
    for pair in pairs {
        let Some((a, b)) = all.get(pair.one).zip(all.get(pair.other)) else { continue };
        let [robot, people, track] = [Some(pair.robot_way), pair.people_way, pair.track_m].map(cell);
        text.push_str(&joined([a.location.as_str(), &a.name, &b.name, &robot, &people, &track]));
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(nodes: &str) -> Vec<NodeId> {
        nodes.split_whitespace().map(|id| NodeId::new(id).unwrap()).collect()
    }

    fn one(name: &str, robot: &str, people: &[&str], y: f64) -> One {
        One {
            name: name.into(),
            location: "office".into(),
            robot: way(robot),
            people: people.iter().map(|nodes| way(nodes)).collect(),
            track: (0..5).map(|x| [f64::from(x), y]).collect(),
        }
    }

    #[test]
    fn ways_are_as_far_as_edits_over_the_longer_and_people_as_far_as_their_nearest() {
        let all = [
            one("a", "a b c d", &["x y"], 0.0),
            one("b", "a c d", &["y x", "x y"], 2.0),
            one("c", "a b c d", &[], 0.0),
        ];
        let found = pairs(&all, &[0, 1, 2]);
        assert_eq!(found.len(), 3);
        // One edit of four nodes; of `x y` the nearest is the same, of `y x` two edits of two.
        assert_eq!((found[0].robot_way, found[0].people_way), (0.25, Some(0.25)));
        assert!((found[0].track_m.unwrap() - 2.0).abs() < 1e-12);
        // People in one scenario and none in the other have nothing in common; nobody in both is no figure.
        assert_eq!((found[1].robot_way, found[1].people_way, found[1].track_m), (0.0, Some(1.0), Some(0.0)));
        assert_eq!(people(&all[2], &all[2]), None);
        let text = csv(&all, found.iter());
        assert_eq!(text.lines().nth(1), Some("office,a,b,0.2500,0.2500,2.0000"));
        let scenarios = [0, 1, 2].into();
        assert_eq!(spread(nearest(&scenarios, &found, &|pair| pair.track_m)), Some([0.0, 0.0, 2.0]));
    }
}
