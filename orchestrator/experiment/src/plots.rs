//! What the plots show, as numbers: panels with lines, drawn elsewhere.

use std::collections::BTreeMap;

use socrates_stats::quantile;

use crate::draws::float;
use crate::fate::all_wrong;
use crate::results::{CellResult, Figures, seconds};
use crate::spec::{AUTHORED, Cell, Spec, Workload};

/// Panels of one plot at most; `cells.csv` has the rest.
pub const MOST_PANELS: usize = 8;
/// Points of a step line at most.
const MOST_POINTS: usize = 400;

/// A plot: panels of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Name, also of its file.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// What to read out of it, and how.
    pub caption: String,
    /// Its panels; none where the experiment has nothing to show.
    pub panels: Vec<Panel>,
    /// Panels that there would be besides.
    pub left_out: usize,
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it is of.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// Lines, in the order of the policies; those of no policy last.
    pub lines: Vec<Line>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub name: String,
    /// Whether it is logarithmic.
    pub log: bool,
    /// Ends.
    pub from: f64,
    /// Ends.
    pub to: f64,
    /// Whether the numbers are shares, shown in percent.
    pub percent: bool,
}

/// How points are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// By straight lines, with a mark at each.
    Straight,
    /// By steps.
    Steps,
    /// By a dashed line without marks.
    Dashed,
    /// By a dotted line without marks.
    Dotted,
}

/// A point: across, up, and the interval around it.
pub type Point = (f64, f64, Option<(f64, f64)>);

/// One line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Number of its policy, which gives it its color; none for theory.
    pub policy: Option<usize>,
    /// How its points are joined.
    pub join: Join,
    /// Its points.
    pub points: Vec<Point>,
}

/// The factor along the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Along {
    Rates,
    Tries,
}

/// A cell with its figures.
type Done<'a> = (&'a CellResult, &'a Figures);

/// Every plot of an experiment.
#[must_use]
pub fn plots(spec: &Spec, results: &[CellResult], figures: &[Figures]) -> Vec<Plot> {
    let done: Vec<Done<'_>> = results.iter().zip(figures).collect();
    let along = if spec.fault.iter().any(|strike| strike.rates.len() > 1) || spec.tries.len() < 2 {
        Along::Rates
    } else {
        Along::Tries
    };
    let by = match along {
        Along::Rates => "the rate of faults",
        Along::Tries => "the tries that each job is allowed",
    };
    let law = if along == Along::Tries && spec.fault.iter().any(|strike| strike.kinds.is_empty()) {
        " Dashed: what independent tries would give, 1 - (1 - p)^k for each question; dotted: what tries give that fail together as the model says. Telling the author what was wrong may rise above both."
    } else {
        ""
    };
    let clock = spec.level.clock();
    let mut all = vec![
        plot(
            ("success", format!("Realised scenarios against {by}")),
            format!("Share of scenarios that were realised, with Wilson intervals at 95 %.{law}"),
            across(spec, &done, along, &success),
        ),
        plot(
            ("open-by-asks", "Not yet realised, by questions to authors".to_owned()),
            format!(
                "Kaplan-Meier curves {}. A scenario that is given up stays open to the end: where a line ends flat, that share was never realised.",
                extreme(spec)
            ),
            extremes(&done, &open_by_asks),
        ),
        plot(
            ("open-by-seconds", "Not yet realised, by time".to_owned()),
            format!(
                "The same over {} seconds from the first attempt of a scenario, waiting for workers included, {}. The axis ends where 99.5 % of the realised ones are done.",
                clock,
                extreme(spec)
            ),
            extremes(&done, &|group, title| open_by_seconds(group, title, clock)),
        ),
        plot(
            ("cost", "What a realised scenario costs".to_owned()),
            format!(
                "Tokens of a whole cell, in and out, for each of its realised scenarios; a mark for each number of tries, {}. Better is up and to the left.",
                extreme(spec)
            ),
            extremes(&done, &cost),
        ),
        plot(
            ("amplification", format!("Attempts for each job against {by}")),
            "How much work a job makes: 1 means that every job was tried once.".to_owned(),
            across(spec, &done, along, &amplification),
        ),
        plot(
            ("recovery", "Until a struck job went on".to_owned()),
            format!(
                "Share of faults after which the job was taken up again, or its report recorded, within so many {} seconds, {}. Waiting for a free worker is part of it.",
                clock,
                extreme(spec)
            ),
            extremes(&done, &|group, title| recovery(group, title, clock)),
        ),
    ];
    all.retain(|plot| !plot.panels.is_empty());
    all
}

fn plot((name, title): (&'static str, String), caption: String, mut panels: Vec<Panel>) -> Plot {
    panels.retain(|panel| panel.lines.iter().any(|line| line.policy.is_some() && !line.points.is_empty()));
    let left_out = panels.len().saturating_sub(MOST_PANELS);
    panels.truncate(MOST_PANELS);
    Plot { name, title, caption, panels, left_out }
}

/// How the cells are called that the plots of extremes show.
fn extreme(spec: &Spec) -> &'static str {
    let rates = spec.fault.iter().any(|strike| strike.rates.len() > 1);
    match (rates, spec.tries.len() > 1) {
        (true, true) => "at the highest rate and the most tries",
        (true, false) => "at the highest rate",
        (false, true) => "at the most tries",
        (false, false) => "of each policy",
    }
}

/// `structured-guided · llm_error`.
fn heading(cell: &Cell) -> String {
    let fault = cell.strike.shown();
    if cell.strike.kinds.is_empty() { cell.workload.name.clone() } else { format!("{} · {fault}", cell.workload.name) }
}

fn axis(name: &str, from: f64, to: f64) -> Axis {
    Axis { name: name.to_owned(), log: false, from, to: if to > from { to } else { from + 1.0 }, percent: false }
}

fn shares(name: &str) -> Axis {
    Axis { percent: true, ..axis(name, 0.0, 1.0) }
}

/// Cells that belong into one panel.
type Group<'a> = Vec<Done<'a>>;

/// Groups of cells, in the order in which the first of each comes.
fn grouped<'a>(done: &[Done<'a>], key: &dyn Fn(&Cell) -> String) -> Vec<Group<'a>> {
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut groups: Vec<Group<'a>> = Vec::new();
    for one in done {
        let next = groups.len();
        let place = *places.entry(key(&one.0.cell)).or_insert(next);
        if place == next {
            groups.push(Vec::new());
        }
        if let Some(group) = groups.get_mut(place) {
            group.push(*one);
        }
    }
    groups
}

/// A line for each policy of a group.
fn by_policy(group: &[Done<'_>], join: Join, points: &dyn Fn(&[Done<'_>]) -> Vec<Point>) -> Vec<Line> {
    let policies = grouped(group, &|cell| cell.policy.name.clone());
    let line = |(number, cells): (usize, &Group<'_>)| {
        let name = cells.first().map(|(result, _)| result.cell.policy.name.clone())?;
        Some(Line { name, policy: Some(number), join, points: points(cells) })
    };
    policies.iter().enumerate().filter_map(line).collect()
}

/// A panel for each workload, fault, and number of tries or rate that is not along the axis.
fn across(spec: &Spec, done: &[Done<'_>], along: Along, panel: &dyn Fn(&[Done<'_>], &At) -> Panel) -> Vec<Panel> {
    let other = |cell: &Cell| match along {
        Along::Rates => cell.tries.to_string(),
        Along::Tries => cell.rate.to_string(),
    };
    let several = match along {
        Along::Rates => spec.tries.len() > 1,
        Along::Tries => spec.fault.iter().any(|strike| strike.rates.len() > 1),
    };
    grouped(done, &|cell| format!("{}\n{}\n{}", cell.workload.name, cell.strike.shown(), other(cell)))
        .iter()
        .filter_map(|group| {
            let cell = &group.first()?.0.cell;
            let more = match along {
                Along::Rates if several => format!(", {} tries", cell.tries),
                Along::Tries if several => format!(", rate {}", cell.rate),
                Along::Rates | Along::Tries => String::new(),
            };
            let places: Vec<f64> = group.iter().map(|(result, _)| along.of(&result.cell)).collect();
            let least = if along == Along::Rates { 0.0 } else { places.iter().copied().fold(f64::MAX, f64::min) };
            let most = places.iter().copied().fold(0.0, f64::max);
            let name = match along {
                Along::Rates => "rate of faults, % of attempts",
                Along::Tries => "tries that a job is allowed",
            };
            let x = Axis { percent: along == Along::Rates, ..axis(name, least, if most > 0.0 { most } else { 1.0 }) };
            let at = At { title: format!("{}{more}", heading(cell)), x, along, correlation: spec.model.correlation };
            Some(panel(group, &at))
        })
        .collect()
}

/// Where a panel of [`across`] stands.
struct At {
    title: String,
    x: Axis,
    along: Along,
    correlation: f64,
}

impl Along {
    fn of(self, cell: &Cell) -> f64 {
        match self {
            Self::Rates => cell.rate,
            Self::Tries => f64::from(cell.tries),
        }
    }
}

fn success(group: &[Done<'_>], at: &At) -> Panel {
    let point = |(result, figures): &Done<'_>| {
        let share = figures.success;
        (at.along.of(&result.cell), share.estimate, Some((share.low, share.high)))
    };
    let mut lines = by_policy(group, Join::Straight, &|cells| cells.iter().map(point).collect());
    if let Some(cell) = group.first().map(|(result, _)| &result.cell).filter(|cell| cell.strike.kinds.is_empty())
        && at.along == Along::Tries
    {
        lines.extend(laws(group, cell, at.correlation));
    }
    Panel { title: at.title.clone(), x: at.x.clone(), y: shares("realised, %"), lines }
}

/// What theory says of asking from the beginning.
fn laws(group: &[Done<'_>], cell: &Cell, correlation: f64) -> Vec<Line> {
    let tries: std::collections::BTreeSet<u32> = group.iter().map(|(result, _)| result.cell.tries).collect();
    let law = |name: &str, join: Join, correlation: f64| Line {
        name: name.to_owned(),
        policy: None,
        join,
        points: tries
            .iter()
            .map(|tries| (f64::from(*tries), expected(&cell.workload, correlation, *tries), None))
            .collect(),
    };
    let mut laws = vec![law("independent tries", Join::Dashed, 0.0)];
    if correlation > 0.0 {
        laws.push(law("correlated tries", Join::Dotted, correlation));
    }
    laws
}

/// Probability that every question of a workload has a right answer among so many that were made from the beginning.
#[must_use]
pub fn expected(workload: &Workload, correlation: f64, tries: u32) -> f64 {
    let asked = AUTHORED.into_iter().filter(|stage| workload.asks.of(*stage).is_some());
    asked.map(|stage| 1.0 - all_wrong(workload.violation(stage), correlation, tries)).product()
}

fn amplification(group: &[Done<'_>], at: &At) -> Panel {
    let point = |(result, figures): &Done<'_>| (at.along.of(&result.cell), figures.amplification(), None);
    let most = group.iter().map(|(_, figures)| figures.amplification()).fold(1.5, f64::max);
    let lines = by_policy(group, Join::Straight, &|cells| cells.iter().map(point).collect());
    Panel { title: at.title.clone(), x: at.x.clone(), y: axis("attempts for each job", 1.0, most), lines }
}

/// A panel for each workload and fault, of its cells with the highest rate; those with fewer tries come along.
fn extremes(done: &[Done<'_>], panel: &dyn Fn(&[Done<'_>], String) -> Option<Panel>) -> Vec<Panel> {
    grouped(done, &|cell| format!("{}\n{}", cell.workload.name, cell.strike.shown()))
        .iter()
        .filter_map(|group| {
            let highest = group.iter().map(|(result, _)| result.cell.rate).fold(0.0, f64::max);
            let chosen: Group<'_> = group.iter().filter(|(result, _)| result.cell.rate >= highest).copied().collect();
            let cell = &chosen.first()?.0.cell;
            let rate = if cell.strike.kinds.is_empty() {
                String::new()
            } else {
                format!(" {} %", (highest * 1e6).round() / 1e4)
            };
            panel(&chosen, format!("{}{rate}", heading(cell)))
        })
        .collect()
}

/// Those with the most tries.
fn with_most_tries<'a>(group: &[Done<'a>]) -> Group<'a> {
    let most = group.iter().map(|(result, _)| result.cell.tries).max().unwrap_or(0);
    group.iter().filter(|(result, _)| result.cell.tries == most).copied().collect()
}

/// Steps as points, from 1 at 0 to the end of the axis.
fn stepped(steps: &[(f64, f64)], to: f64) -> Vec<Point> {
    let seen: Vec<(f64, f64)> = steps.iter().copied().take_while(|(time, _)| *time <= to).collect();
    let every = seen.len().div_ceil(MOST_POINTS).max(1);
    let last = seen.last().map_or(1.0, |(_, share)| *share);
    let kept = seen.iter().enumerate().filter(|(place, _)| (place + 1) % every == 0).map(|(_, step)| *step);
    std::iter::once((0.0, 1.0)).chain(kept).chain([(to, last)]).map(|(x, y)| (x, y, None)).collect()
}

fn open_by_asks(group: &[Done<'_>], title: String) -> Option<Panel> {
    let group = with_most_tries(group);
    let asks = group.iter().flat_map(|(result, _)| &result.scenarios).filter(|row| row.succeeded());
    let to = float(asks.map(|row| row.asks).max()?);
    let lines = by_policy(&group, Join::Steps, &|cells| {
        cells.first().map(|(result, _)| stepped(&result.open_after_asks(), to)).unwrap_or_default()
    });
    Some(Panel { title, x: axis("questions to authors", 0.0, to), y: shares("not yet realised, %"), lines })
}

fn open_by_seconds(group: &[Done<'_>], title: String, clock: &str) -> Option<Panel> {
    let group = with_most_tries(group);
    let rows = group.iter().flat_map(|(result, _)| &result.scenarios).filter(|row| row.succeeded());
    let spans: Vec<f64> = rows.filter_map(|row| row.span_ms()).map(seconds).collect();
    let to = quantile(&spans, 0.995).ok()?;
    let lines = by_policy(&group, Join::Steps, &|cells| {
        cells.first().map(|(result, _)| stepped(&result.open_after_s(), to)).unwrap_or_default()
    });
    Some(Panel { title, x: axis(&format!("{clock} time, s"), 0.0, to), y: shares("not yet realised, %"), lines })
}

fn cost(group: &[Done<'_>], title: String) -> Option<Panel> {
    let thousands = |figures: &Figures| figures.tokens_per_success().map(|tokens| tokens / 1_000.0);
    let all = || group.iter().filter_map(|(_, figures)| thousands(figures));
    let (least, most) = (all().fold(f64::MAX, f64::min), all().fold(0.0, f64::max));
    let point = |(_, figures): &Done<'_>| {
        let share = figures.success;
        Some((thousands(figures)?, share.estimate, Some((share.low, share.high))))
    };
    let lines = by_policy(group, Join::Straight, &|cells| cells.iter().filter_map(point).collect());
    let x = axis("thousand tokens for each realised scenario", 0.9 * least, most);
    (most > 0.0).then(|| Panel { title, x, y: shares("realised, %"), lines })
}

fn recovery(group: &[Done<'_>], title: String, clock: &str) -> Option<Panel> {
    let group = with_most_tries(group);
    let times = |result: &CellResult| -> Vec<f64> {
        // A log axis has no zero: what went on within a hundredth of a second stands at its left end.
        let mut all: Vec<f64> = result.recoveries.iter().map(|(_, ms)| seconds(*ms).max(0.01)).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let all = || group.iter().flat_map(|(result, _)| times(result));
    let (least, to) = (all().fold(f64::MAX, f64::min), all().fold(0.0, f64::max));
    let from = libm::pow(10.0, libm::floor(libm::log10(least.max(0.01))));
    let lines = by_policy(&group, Join::Steps, &|cells| {
        let all = cells.first().map(|(result, _)| times(result)).unwrap_or_default();
        let every = all.len().div_ceil(MOST_POINTS).max(1);
        let count = float(all.len() as u64);
        let share = |place: usize| float(place as u64 + 1) / count;
        let kept = all.iter().enumerate().filter(|(place, _)| (place + 1) % every == 0);
        let points: Vec<_> = kept.map(|(place, time)| (*time, share(place), None)).collect();
        let last = all.last().map(|_| (to, 1.0, None));
        if points.is_empty() { Vec::new() } else { points.into_iter().chain(last).collect() }
    });
    let x = Axis { log: true, ..axis(&format!("{clock} time, s (logarithmic)"), from, to.max(10.0 * from)) };
    (to > 0.0).then(|| Panel { title, x, y: shares("went on, %"), lines })
}
