//! The runs that films are made of: found in bundles, and refused where films of them could not be compared.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use socrates_draw::{Seen, film_times};
use socrates_model::{HumanId, PlannerName, Recording, Report, Run, Verdict};
use socrates_study::kit::setup::View;

use crate::bundle::{self, Bundle};
use crate::exit::Diagnostic;
use crate::labels;

/// Seconds of a film that stand still before and behind the run.
const STILL_S: f64 = 2.0;

/// A run and the bundle that it lies in.
type Lying = (PathBuf, Recording, Report);

/// A scenario with the runs that are filmed.
pub(super) struct Scene {
    /// Its name.
    pub(super) name: String,
    /// Place, proposal and papers; without runs.
    pub(super) bundle: Bundle,
    /// Where each run lies, and the run.
    pub(super) runs: Vec<Lying>,
}

/// Bundles by the scenario that they hold.
pub(super) fn by_scenario(what: &[PathBuf]) -> Result<BTreeMap<String, Vec<PathBuf>>, Diagnostic> {
    let mut found: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for dir in labels::folders(what)? {
        let manifest = bundle::manifest(&dir).ok_or_else(|| crate::batch::none(&dir))?;
        found.entry(manifest.scenario).or_default().push(dir);
    }
    Ok(found)
}

impl Scene {
    /// Reads the runs of these planners and seeds from bundles of one scenario.
    ///
    /// # Errors
    /// Bundles of different maps, ways or people; a run that is not there; runs scored with different thresholds; a scenario that did
    /// not come about.
    pub(super) fn read(
        name: &str,
        dirs: &[PathBuf],
        planners: &[PlannerName],
        seeds: &[u64],
    ) -> Result<Self, Diagnostic> {
        let mut first: Option<(PathBuf, Bundle)> = None;
        let mut runs: Vec<Lying> = Vec::new();
        let mut references = Vec::new();
        for dir in dirs {
            let wanted = |planner: &PlannerName, seed: u64| planners.contains(planner) && seeds.contains(&seed);
            let (mut bundle, reports) = bundle::read_with_reports(dir, |_, entry| wanted(&entry.planner, entry.seed))?;
            references.extend(reports.into_iter().filter(|report| report.planner.is_reference()));
            for (recording, report) in std::mem::take(&mut bundle.runs) {
                // The same run in two bundles is one run.
                let known = |(_, _, other): &&Lying| other.planner == report.planner && other.seed == report.seed;
                if let Some((other, ..)) = runs.iter().find(known) {
                    return Err(Diagnostic::input(
                        format!(
                            "`{name}` has the run `{}-{}` twice: in `{}` and `{}`",
                            report.planner,
                            report.seed,
                            other.display(),
                            dir.display()
                        ),
                        "name only one of these bundles",
                    ));
                }
                runs.push((dir.clone(), recording, report));
            }
            match &first {
                None => first = Some((dir.clone(), bundle)),
                Some((other, known)) => alike(name, (other, known), (dir, &bundle))?,
            }
        }
        let Some((_, bundle)) = first else {
            return Err(Diagnostic::input(format!("`{name}` has no bundle"), "name a bundle with its runs"));
        };
        let scene = Self { name: name.to_owned(), bundle, runs };
        scene.complete(planners, seeds)?;
        scene.thresholds()?;
        scene.realised(seeds, &references)?;
        Ok(scene)
    }

    /// A run.
    pub(super) fn run(&self, planner: &str, seed: u64) -> Option<&Lying> {
        self.runs.iter().find(|(_, _, report)| report.planner.as_str() == planner && report.seed == seed)
    }

    fn complete(&self, planners: &[PlannerName], seeds: &[u64]) -> Result<(), Diagnostic> {
        for planner in planners {
            for seed in seeds {
                if self.run(planner.as_str(), *seed).is_none() {
                    let have: Vec<String> = self
                        .runs
                        .iter()
                        .map(|(_, _, report)| Run { planner: report.planner.clone(), seed: report.seed }.to_string())
                        .collect();
                    return Err(Diagnostic::input(
                        format!(
                            "`{}` has no run of `{planner}` with seed {seed}: films of other seeds show other people",
                            self.name
                        ),
                        format!(
                            "`socrates compare REQUEST --planner {} --seeds {seed}` makes what is missing; of what was asked for there are: {}",
                            planners.iter().map(PlannerName::as_str).collect::<Vec<_>>().join(","),
                            if have.is_empty() { "none".to_owned() } else { have.join(", ") }
                        ),
                    ));
                }
            }
        }
        Ok(())
    }

    fn thresholds(&self) -> Result<(), Diagnostic> {
        let Some((_, _, first)) = self.runs.first() else { return Ok(()) };
        let other = self.runs.iter().find(|(_, _, report)| report.thresholds != first.thresholds);
        let Some((_, _, other)) = other else { return Ok(()) };
        Err(Diagnostic::input(
            format!(
                "`{}`: `{}-{}` was scored with the thresholds `{}`, `{}-{}` with `{}`: their figures do not mean the same",
                self.name, first.planner, first.seed, first.thresholds, other.planner, other.seed, other.thresholds
            ),
            "make the older runs again with `socrates run BUNDLE/request.toml`",
        ))
    }

    /// What people are told about the scenario must have happened with some robot, for each seed; and no run may be broken.
    fn realised(&self, seeds: &[u64], references: &[Report]) -> Result<(), Diagnostic> {
        for seed in seeds {
            let of = |report: &&Report| report.seed == *seed;
            let own: Vec<&Report> = self.runs.iter().map(|(_, _, report)| report).filter(of).collect();
            let reference: Vec<&Report> = references.iter().filter(of).collect();
            // The reference robot drives the intended way: where it has run, it decides.
            let decides = if reference.is_empty() { &own } else { &reference };
            if !decides.iter().any(|report| labels::meets(report.verdict)) {
                let told: Vec<String> = decides
                    .iter()
                    .map(|report| {
                        format!("{}-{}: {} ({})", report.planner, report.seed, report.verdict, report.verdict_text)
                    })
                    .collect();
                let mut diagnostic = Diagnostic::input(
                    format!(
                        "`{}` was not realised with seed {seed}: people would be told of what they do not see",
                        self.name
                    ),
                    "leave the scenario out, or take a seed with which it was: `--seeds` names it",
                );
                diagnostic.causes = told;
                return Err(diagnostic);
            }
            if let Some(broken) = own.iter().find(|report| report.verdict == Verdict::Invalid) {
                let mut diagnostic = Diagnostic::input(
                    format!(
                        "`{}`: the run `{}-{seed}` is invalid, so nobody knows what it shows",
                        self.name, broken.planner
                    ),
                    "take another seed for all planners: `--seeds` names it",
                );
                diagnostic.causes = vec![broken.verdict_text.clone()];
                return Err(diagnostic);
            }
        }
        Ok(())
    }

    /// From when to when all films of it show their run, s: the same for all of them, beginning where something happens in the first of
    /// them; with how much at the end is not shown.
    pub(super) fn part(&self, longest_s: f64) -> ((f64, f64), f64) {
        let all: Vec<&Recording> = self.runs.iter().map(|(_, recording, _)| recording).collect();
        let (from_s, to_s) = film_times::window(&all);
        // Whole pictures at every usual rate, so that all films have the very same length.
        let length = ((to_s - from_s).max(1.0) * 10.0).ceil() / 10.0;
        let shown = length.min((longest_s - STILL_S).max(1.0));
        ((from_s, from_s + shown), length - shown)
    }

    /// Length of its films, s.
    pub(super) fn length_s(&self, longest_s: f64) -> f64 {
        let ((from_s, to_s), _) = self.part(longest_s);
        ((to_s - from_s + STILL_S) * 10.0).round() / 10.0
    }

    /// What people read before a film of it, where nobody wrote another text: where it is, and what the robot is to do.
    pub(super) fn context(&self) -> String {
        let request = &self.bundle.request;
        let sentence = |text: &str| {
            let text = text.trim();
            if text.is_empty() || text.ends_with(['.', '!', '?']) { text.to_owned() } else { format!("{text}.") }
        };
        let task = format!("The robot's task: {}", sentence(&request.task));
        [sentence(&request.social_context), task]
            .iter()
            .filter(|part| !part.is_empty())
            .cloned()
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// Refuses bundles that differ in anything but their runs.
fn alike(name: &str, (a, first): (&Path, &Bundle), (b, other): (&Path, &Bundle)) -> Result<(), Diagnostic> {
    let parts = [
        ("map", first.location == other.location),
        ("proposal", first.proposal == other.proposal),
        ("ways", first.paths == other.paths),
        ("behaviors of people", first.behaviors == other.behaviors),
    ];
    let Some((what, _)) = parts.iter().find(|(_, same)| !same) else { return Ok(()) };
    Err(Diagnostic::input(
        format!(
            "`{name}` is not the same in `{}` and `{}`: the {what} differ, so films of both cannot be compared",
            a.display(),
            b.display()
        ),
        "run all planners in one go: `socrates compare REQUEST --planner A,B,C`",
    ))
}

/// Planners and seeds that all these scenarios have in common, besides the reference and the run without a robot.
pub(super) fn common(scenes: &BTreeMap<String, Vec<PathBuf>>) -> (Vec<PlannerName>, Vec<u64>) {
    let (mut planners, mut seeds): (Option<Vec<PlannerName>>, Option<BTreeSet<u64>>) = (None, None);
    for dirs in scenes.values() {
        let runs: Vec<Run> = dirs
            .iter()
            .filter_map(|dir| bundle::manifest(dir))
            .flat_map(|manifest| manifest.runs.into_iter().map(|entry| entry.run()))
            .filter(|run| !run.planner.is_no_robot() && !run.planner.is_reference())
            .collect();
        let mut own: Vec<PlannerName> = Vec::new();
        runs.iter().filter(|run| !own.contains(&run.planner)).collect::<Vec<_>>().into_iter().for_each(|run| {
            if !own.contains(&run.planner) {
                own.push(run.planner.clone());
            }
        });
        let with_all =
            |seed: &u64| own.iter().all(|planner| runs.iter().any(|run| run.planner == *planner && run.seed == *seed));
        let of: BTreeSet<u64> = runs.iter().map(|run| run.seed).filter(with_all).collect();
        planners = Some(match planners {
            None => own,
            Some(known) => known.into_iter().filter(|planner| own.contains(planner)).collect(),
        });
        seeds = Some(seeds.map_or_else(|| of.clone(), |known| known.intersection(&of).copied().collect()));
    }
    (planners.unwrap_or_default(), seeds.unwrap_or_default().into_iter().collect())
}

/// How films of a view are seen.
pub(super) fn seen(view: &View) -> Seen {
    match view {
        View::Above => Seen::Above,
        View::Person(number) => Seen::By(HumanId::new(*number)),
    }
}

#[cfg(test)]
mod tests {
    use socrates_draw::film_eyes;
    use socrates_study::kit::setup;

    #[test]
    fn the_words_about_films_are_true() {
        assert!((film_eyes::FIELD_DEGREES - setup::FIELD_DEGREES).abs() < 1e-9);
        assert!((film_eyes::EYE_M - setup::EYE_M).abs() < 1e-9);
    }
}
