//! Metrics: how well the robot did. A catalog of families, one file each.
//!
//! Every value is independent of the recording's sampling rate: all are taken on one even 0.1 s grid of positions, with
//! velocities by differences (`grid`), times and shares on the piecewise-linear curve over it. Robot metrics are taken
//! from the robot's first sample to its arrival (or its last, where it never arrives).

mod alarm;
mod blame;
mod collisions;
mod comfort;
mod counterfactual;
mod crowding;
mod distances;
mod disturbance;
mod drac;
mod forces;
pub mod francis;
mod gaze;
mod goal;
mod goals;
mod grid;
mod groups;
mod hunav;
mod intrusion;
mod key;
mod near_misses;
mod online;
mod passages;
mod passing;
mod path;
pub mod peers;
mod pet;
mod progress;
#[cfg(test)]
mod rates;
mod response;
mod scene;
mod shape;
mod sides;
mod smoothness;
mod space;
mod speeds;
mod stalls;
mod success;
mod table;
mod thresholds;
mod ttc;
mod twin;
mod unrecorded;
mod yielding;
mod zones;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer};
use socrates_model::{MetricValue, Missing, Unit};

pub use goals::rival_goals;
pub use key::{KEY_FIGURES, in_words, key_figures};
pub use online::{Online, Setting};
pub use scene::Scene;
pub use table::csv;
pub use thresholds::signature;

/// What a metric needs; where it is missing, the metric is not applicable, never 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Need {
    /// Trajectories alone.
    Tracks,
    /// A robot among them.
    Robot,
    /// At least one human.
    Humans,
    /// The map.
    Map,
    /// The robot's goal.
    Goal,
    /// Group labels.
    Groups,
    /// The event log: gestures.
    Events,
    /// The same run without a robot.
    Twin,
    /// Computing times of the planner: recordings of ours have none, so that they are the same everywhere.
    PlannerTimes,
    /// The commands given to the robot, beside what it did.
    Commands,
    /// The same run with the robot and without people.
    Solo,
    /// Robots beside the one that is judged: recordings of ours have none.
    OtherRobots,
}

/// Whether more is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Direction {
    /// Larger is better.
    #[serde(rename = "more")]
    Up,
    /// Smaller is better.
    #[serde(rename = "less")]
    Down,
    /// Neither.
    #[serde(rename = "neither")]
    Neutral,
}

impl Direction {
    /// As reports have it: 1, -1 or 0.
    #[must_use]
    pub const fn sign(self) -> i8 {
        match self {
            Self::Up => 1,
            Self::Down => -1,
            Self::Neutral => 0,
        }
    }
}

/// The fact sheet of one metric, a row of `data/metrics.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    /// Id, as in reports and tables.
    #[serde(deserialize_with = "text")]
    pub id: &'static str,
    /// Unit.
    #[serde(deserialize_with = "text")]
    pub unit: &'static str,
    /// Whether more is better.
    #[serde(rename = "better")]
    pub direction: Direction,
    /// What it needs.
    #[serde(deserialize_with = "needs")]
    pub needs: &'static [Need],
    /// Where the definition comes from.
    #[serde(deserialize_with = "text")]
    pub source: &'static str,
    /// What it is, with its formula and convention.
    #[serde(deserialize_with = "text")]
    pub about: &'static str,
}

/// A text of a sheet; sheets live as long as the process.
fn text<'de, D: Deserializer<'de>>(from: D) -> Result<&'static str, D::Error> {
    String::deserialize(from).map(|text| &*text.leak())
}

/// The needs of a sheet.
fn needs<'de, D: Deserializer<'de>>(from: D) -> Result<&'static [Need], D::Error> {
    Vec::deserialize(from).map(|needs| &*needs.leak())
}

/// The file of the sheets.
const FILE: &str = include_str!("../../data/metrics.toml");

/// The sheets of every family, by its name. The tests read the file.
static SHEETS: LazyLock<BTreeMap<String, Vec<Sheet>>> = LazyLock::new(|| toml::from_str(FILE).unwrap_or_default());

impl Need {
    /// What is said of a run that has not got it.
    #[must_use]
    pub const fn lacking(self) -> &'static str {
        match self {
            Self::Tracks => "the recording is empty",
            Self::Robot => "there is no robot in the recording",
            Self::Humans => "there is no human in the recording",
            Self::Map => "there is no map",
            Self::Goal => "the robot's goal is not known",
            Self::Groups => "no groups are known",
            Self::Twin => "there is no run without the robot to compare with",
            Self::PlannerTimes => {
                "recordings hold no computing times of planners; it would need the time of each call, which differs by machine"
            }
            Self::Commands => {
                "recordings hold no commands; it would need the velocity that was commanded at every step"
            }
            Self::Solo => {
                "there is no run of the robot alone to compare with; it would need one with the same seed and no people"
            }
            Self::OtherRobots => "recordings hold one robot; it would need the tracks of the others",
            Self::Events => "nobody makes a gesture",
        }
    }

    /// What it says of a run when the need is not met: that it is not the kind of run that has such a value, or that
    /// the evidence lacks something which other evidence of the same run could hold.
    #[must_use]
    pub const fn missing(self) -> Missing {
        match self {
            Self::Tracks | Self::Robot | Self::Humans | Self::Groups | Self::Events | Self::OtherRobots => {
                Missing::NotApplicable
            }
            Self::Map | Self::Goal | Self::Twin | Self::PlannerTimes | Self::Commands | Self::Solo => {
                Missing::Unavailable
            }
        }
    }
}

/// A value, or why there is none.
pub type Measured = Result<f64, String>;

/// How a family is computed.
#[derive(Debug, Clone, Copy)]
pub enum Measure {
    /// While the run goes on, sample by sample, for a number of humans; it gives what the whole run gives.
    Online(Begin),
    /// From the whole run.
    Whole {
        /// Computes the values, one per sheet.
        measure: fn(&Scene<'_>) -> Vec<Measured>,
        /// Why it waits for the end.
        why: &'static str,
    },
}

/// Begins a family before the first sample.
#[derive(Debug, Clone, Copy)]
pub struct Begin(fn(usize) -> Box<dyn online::Running>);

/// Metrics that are computed together.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// Name of its sheets in `data/metrics.toml`.
    name: &'static str,
    /// Names and values of what decides what counts: distances, times, speeds. With other ones the figures are others,
    /// see [`signature`].
    pub thresholds: &'static [(&'static str, f64)],
    /// Computes the values, one per sheet.
    pub measure: Measure,
}

impl Family {
    /// Fact sheets, in the order of the values.
    #[must_use]
    pub fn sheets(&self) -> &'static [Sheet] {
        SHEETS.get(self.name).map_or(&[], Vec::as_slice)
    }

    /// Why the values can be had only when the run is over; `None` where [`Online`] gives them at any time.
    #[must_use]
    pub const fn waits(&self) -> Option<&'static str> {
        match self.measure {
            Measure::Online(_) => None,
            Measure::Whole { why, .. } => Some(why),
        }
    }
}

/// Every metric, in report order. Adding one is a row of `data/metrics.toml` and its value in its family's file,
/// or a new file and a line here.
pub const CATALOG: &[Family] = &[
    success::FAMILY,
    collisions::FAMILY,
    blame::FAMILY,
    distances::FAMILY,
    near_misses::FAMILY,
    ttc::FAMILY,
    pet::FAMILY,
    drac::FAMILY,
    alarm::FAMILY,
    progress::FAMILY,
    stalls::FAMILY,
    path::FAMILY,
    goal::FAMILY,
    speeds::FAMILY,
    shape::FAMILY,
    smoothness::FAMILY,
    zones::FAMILY,
    space::FAMILY,
    intrusion::FAMILY,
    groups::FAMILY,
    forces::FAMILY,
    crowding::FAMILY,
    yielding::FAMILY,
    passing::FAMILY,
    response::FAMILY,
    goals::FAMILY,
    sides::FAMILY,
    comfort::FAMILY,
    comfort::TOGETHER,
    disturbance::FAMILY,
    gaze::FAMILY,
    passages::FAMILY,
    twin::FAMILY,
    counterfactual::FAMILY,
    unrecorded::FAMILY,
    hunav::FAMILY,
    peers::FAMILY,
];

/// Version of the catalog: it changes when a formula does, so that figures of different versions are not mixed.
pub const VERSION: u32 = 3;

/// Version of what nothing else is said of: 2 since everything is taken on one even grid.
const ON_GRID: u32 = 2;

/// Metrics whose formula has changed beside that since it was first published here, with the version it has now.
const REVISED: &[(&str, u32)] =
    &[("ttc_p5", 3), ("drac_max", 3), ("post_encroachment_time", 3), ("path_irregularity", 3), ("freezing_events", 3)];

/// How values of several runs become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aggregation {
    /// Share of runs, with a Wilson interval.
    Share,
    /// Sum and mean per run.
    Count,
    /// Median, with a bootstrap interval.
    Median,
}

impl Sheet {
    /// How values of several runs become one; runs without a value are counted apart, never as 0.
    #[must_use]
    pub fn aggregation(&self) -> Aggregation {
        match self.unit {
            "0/1" => Aggregation::Share,
            "count" => Aggregation::Count,
            _ => Aggregation::Median,
        }
    }

    /// Version of this metric's formula, from 1; figures of different versions are not mixed.
    #[must_use]
    pub fn version(&self) -> u32 {
        let plain = if self.as_coded_elsewhere() { 1 } else { ON_GRID };
        REVISED.iter().find(|(id, _)| *id == self.id).map_or(plain, |(_, version)| *version)
    }

    /// The unit that stands behind a number; nothing behind counts, shares, and yes or no.
    #[must_use]
    pub fn unit_shown(&self) -> Option<&'static str> {
        match self.unit {
            "0/1" | "share" | "count" => None,
            unit => Some(unit),
        }
    }

    /// Whether the value is another tool's, with its dependence on sampling rate and map.
    #[must_use]
    pub fn as_coded_elsewhere(&self) -> bool {
        self.id.starts_with("hunav.")
    }
}

/// Fact sheets of every metric, in report order.
pub fn sheets() -> impl Iterator<Item = &'static Sheet> {
    CATALOG.iter().flat_map(Family::sheets)
}

/// The fact sheet of a metric.
#[must_use]
pub fn sheet(id: &str) -> Option<&'static Sheet> {
    sheets().find(|sheet| sheet.id == id)
}

/// Computes every metric.
#[must_use]
pub fn measure(scene: &Scene<'_>) -> Vec<MetricValue> {
    let mut values = computed(scene);
    values.extend(francis::named(&values));
    values
}

fn computed(scene: &Scene<'_>) -> Vec<MetricValue> {
    CATALOG
        .iter()
        .zip(scene.online())
        .flat_map(|(family, grown)| {
            let missing = family.sheets().iter().map(|sheet| scene.lacks(sheet.needs)).collect::<Vec<_>>();
            let values = match family.measure {
                Measure::Online(_) => grown,
                // A family runs when at least one of its metrics can be had.
                Measure::Whole { measure, .. } if missing.iter().any(Option::is_none) => measure(scene),
                Measure::Whole { .. } => Vec::new(),
            };
            family
                .sheets()
                .iter()
                .zip(missing)
                .enumerate()
                .map(|(index, (sheet, missing))| {
                    let value = match missing {
                        Some((missing, why)) => return valued(sheet, Err(why), missing),
                        None => values.get(index).cloned().unwrap_or_else(|| Err("not computed".to_owned())),
                    };
                    valued(sheet, value, Missing::NotApplicable)
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Every metric as not applicable, for one reason.
#[must_use]
pub fn none(why: &str) -> Vec<MetricValue> {
    let unread = |sheet: &Sheet| valued(sheet, Err(why.to_owned()), Missing::Unavailable);
    let mut values: Vec<MetricValue> = sheets().map(unread).collect();
    values.extend(francis::named(&values));
    values
}

fn valued(sheet: &Sheet, value: Measured, missing: Missing) -> MetricValue {
    let (value, note) = match value {
        // A sum of nothing is -0, which is no figure to print.
        Ok(value) if value.is_finite() => (Some((value * 1e6).round() / 1e6 + 0.0), String::new()),
        Ok(_) => (None, "not applicable: the value is not finite".to_owned()),
        Err(why) => (None, format!("not applicable: {why}")),
    };
    MetricValue {
        id: sheet.id.to_owned(),
        unit: Unit::new(sheet.unit),
        value,
        direction: sheet.direction.sign(),
        version: sheet.version(),
        missing: value.is_none().then_some(missing),
        note,
    }
}

/// A mean over a stretch of time, or why there is none.
fn or_why(value: Option<f64>, why: &str) -> Measured {
    value.ok_or_else(|| why.to_owned())
}

/// A count as a value.
#[expect(clippy::cast_precision_loss, reason = "counts of a run are far below 2^53")]
pub(crate) const fn count(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
pub(crate) mod tests;
