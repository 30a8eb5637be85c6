//! What scenarios and runs took: as measured for this program, or in the bundles that lie where a library goes.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;
use socrates_model::PlannerName;

use crate::keep::Keep;
use crate::{bundle, layout};

/// Share of the cores that a library keeps busy; README, Speed: 1.76 to 1.80 of two.
pub(super) const BUSY: f64 = 0.88;
/// CPU of a scenario without its runs: authors by rules, orchestrator, pictures, bundle, page, s. As all that follows, measured with 36
/// scenarios of the shipped requests on two busy cores of an AMD EPYC host; docs/libraries.md has the table.
const SCENARIO_S: f64 = 0.1;
/// CPU of a run of each planner, simulated, recorded and scored, s; others take [`OTHER_S`].
const RUN_S: [(&str, f64); 11] = [
    ("none", 0.04),
    ("reference", 0.045),
    ("reactive", 0.07),
    ("straight_line", 0.085),
    ("social_force", 0.135),
    ("orca", 0.17),
    ("rpp", 0.135),
    ("socrates_mppi", 0.6),
    ("mppi", 0.5),
    ("ha_mppi", 0.63),
    ("nav2can", 0.65),
];
const OTHER_S: f64 = 0.2;
/// Bytes and files of a bundle as a folder, and of each run in it; the same packed; the same of the line that a library keeps of a scenario
/// instead.
const FOLDER: Size = Size { each: 358e3, run: 473e3, files: 20.8, run_files: 2.0 };
const PACKED: Size = Size { each: 191e3, run: 249e3, files: 1.0, run_files: 0.0 };
const LINE: Size = Size { each: 4.84e3, run: 0.9e3, files: 0.0, run_files: 0.0 };
/// The same of a scenario's part of list, page and tables, and of the work folder until all is made.
const LISTED: Size = Size { each: 3.4e3, run: 0.44e3, files: 0.0, run_files: 0.0 };
const WORK: Size = Size { each: 392e3, run: 381e3, files: 0.0, run_files: 0.0 };
/// Files of a library beside its bundles, and scenarios on each page.
const LISTS: f64 = 5.0;
const ON_A_PAGE: f64 = 1_000.0;
/// Bytes of `planners.csv` for a scenario, in libraries of as many as it has rows of.
const FIGURES: f64 = 12.6e3;
const FIGURES_OF: f64 = 1_000.0;
/// Share of scenarios that are not realised: 1611 of 1668 different ones of the shipped requests were.
const NOT_REALISED: f64 = 0.04;
/// Bundles that are looked into for what their runs took, at most.
const LOOKED_AT: usize = 200;
/// Runs of a planner that say more than what was measured for this program.
const ENOUGH: usize = 5;

/// What runs took that lie here.
#[derive(Debug, Clone, Default)]
pub(super) struct Past {
    /// Seconds of simulation and scoring of each planner, and of how many runs.
    runs: BTreeMap<String, (f64, usize)>,
    bundles: usize,
}

impl Past {
    /// What the bundles in these folders say.
    pub(super) fn of(folders: &[&Path]) -> Self {
        let mut past = Self::default();
        let names = |folder: &Path| {
            let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
            let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
            paths.sort();
            paths
        };
        let bundles = folders.iter().flat_map(|folder| names(folder)).filter(|path| bundle::is_bundle(path));
        for path in bundles.take(LOOKED_AT) {
            let text = bundle::file(&path, layout::PROVENANCE.path).unwrap_or_default();
            past.add(&serde_json::from_slice(&text).unwrap_or_default());
        }
        past
    }

    /// Adds what the provenance of a bundle says.
    fn add(&mut self, provenance: &Value) {
        self.bundles += 1;
        for job in provenance.get("jobs").and_then(Value::as_array).into_iter().flatten() {
            let word = |key: &str| job.pointer(&format!("/job/{key}")).and_then(Value::as_str).unwrap_or_default();
            let attempts = job.get("attempts").and_then(Value::as_array).into_iter().flatten();
            // The last attempt is the one that was taken.
            let ms = attempts.filter_map(|attempt| attempt.get("wall_ms")?.as_f64()).next_back().unwrap_or(0.0);
            let planner = word("item").rsplit_once('-').map(|(planner, _)| planner.to_owned());
            let (Some(planner), stage) = (planner, word("stage")) else { continue };
            let (sum, runs) = self.runs.entry(planner).or_default();
            if matches!(stage, "simulation" | "scoring") {
                *sum += ms / 1e3;
            }
            *runs += usize::from(stage == "simulation");
        }
    }

    /// CPU of a scenario with runs of these planners, s.
    pub(super) fn cpu_s(&self, runs: &[PlannerName]) -> f64 {
        SCENARIO_S + runs.iter().map(|planner| self.run_s(planner.as_str())).sum::<f64>()
    }

    fn run_s(&self, planner: &str) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a few hundred runs")]
        let own = self.runs.get(planner).filter(|(_, runs)| *runs >= ENOUGH).map(|(sum, runs)| sum / *runs as f64);
        let measured = || RUN_S.iter().find(|(name, _)| *name == planner).map_or(OTHER_S, |(_, seconds)| *seconds);
        own.unwrap_or_else(measured)
    }

    /// Runs that say more than what was measured for this program.
    pub(super) fn runs(&self) -> usize {
        self.runs.values().map(|(_, runs)| *runs).filter(|runs| *runs >= ENOUGH).sum()
    }

    /// Where the figures are from.
    pub(super) fn source(&self) -> String {
        match self.runs() {
            0 => "by what was measured for this program (docs/libraries.md)".to_owned(),
            runs => format!("by {runs} runs of {} bundles that lie there", self.bundles),
        }
    }
}

/// Bytes and files of a scenario.
#[derive(Debug, Clone, Copy)]
struct Size {
    each: f64,
    run: f64,
    files: f64,
    run_files: f64,
}

impl Size {
    fn bytes(&self, runs: f64) -> f64 {
        self.each + self.run * runs
    }

    fn files(&self, runs: f64) -> f64 {
        self.files + self.run_files * runs
    }
}

/// Bytes and files of a library.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Disk {
    kept: f64,
    work: f64,
    scenarios: f64,
    files: f64,
}

impl Disk {
    /// Of a scenario with so many runs.
    pub(super) fn of(keep: Keep, runs: usize) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a few runs")]
        let runs = runs as f64;
        let bundles = |size: &Size, share: f64| (size.bytes(runs) * share, size.files(runs) * share);
        let (kept, files) = match keep {
            Keep::Folders => bundles(&FOLDER, 1.0),
            Keep::Packed => bundles(&PACKED, 1.0),
            Keep::Failed => {
                let (bytes, files) = bundles(&PACKED, NOT_REALISED);
                (bytes + LINE.bytes(runs) * (1.0 - NOT_REALISED), files)
            }
            Keep::Index => bundles(&LINE, 1.0),
        };
        Self { kept: kept + LISTED.bytes(runs), work: WORK.bytes(runs), scenarios: 1.0, files }
    }

    pub(super) fn and(self, other: Self) -> Self {
        Self {
            kept: self.kept + other.kept,
            work: self.work + other.work,
            scenarios: self.scenarios + other.scenarios,
            files: self.files + other.files,
        }
    }

    /// What stays, GB.
    pub(super) fn kept_gb(&self) -> f64 {
        let figures = if self.scenarios > 1.0 && self.scenarios <= FIGURES_OF { self.scenarios * FIGURES } else { 0.0 };
        (self.kept + figures) / 1e9
    }

    /// What lies there besides until all is made, GB.
    pub(super) const fn work_gb(&self) -> f64 {
        self.work / 1e9
    }

    /// Files that stay; of one scenario alone those of its bundle.
    pub(super) fn files(&self) -> f64 {
        let pages = (self.scenarios / ON_A_PAGE).ceil().max(1.0) - 1.0;
        self.files.round() + if self.scenarios > 1.0 { LISTS + pages } else { 0.0 }
    }

    /// `0.02 GB in 14 files stay (--keep index) · 0.40 GB more while it is made`.
    pub(super) fn told(&self, keep: Keep) -> String {
        let gb = |value: f64| match value {
            value if value < 0.0095 => format!("{:.1} MB", value * 1e3),
            value if value < 0.95 => format!("{:.0} MB", value * 1e3),
            value => format!("{value:.1} GB"),
        };
        format!(
            "{} in {:.0} files stay (--keep {}) · {} more while it is made",
            gb(self.kept_gb()),
            self.files(),
            keep.name(),
            gb(self.work_gb())
        )
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn runs_that_lie_there_say_more_than_what_was_measured_for_the_program() {
        let job = |stage: &str, item: &str, ms: f64| json!({ "job": { "stage": stage, "item": item }, "attempts": [{ "wall_ms": 9e9 }, { "wall_ms": ms }] });
        let provenance = json!({ "jobs": [
            job("simulation", "mppi-1", 3_000.0), job("scoring", "mppi-1", 1_000.0), job("simulation", "reference-1", 10.0),
            job("proposal", "whole", 5.0),
        ] });
        let mut past = Past::default();
        let planner = |name: &str| name.parse::<PlannerName>().unwrap();
        let cost = |past: &Past, name: &str| past.cpu_s(&[planner(name)]) - SCENARIO_S;
        past.add(&provenance);
        assert!((cost(&past, "mppi") - 4.0).abs() > 1.0 && past.runs() == 0, "one run says little");
        (1..ENOUGH).for_each(|_| past.add(&provenance));
        assert!((cost(&past, "mppi") - 4.0).abs() < 1e-9, "{past:?}");
        assert!((cost(&past, "external:mine") - OTHER_S).abs() < 1e-9);
        assert_eq!(past.runs(), 2 * ENOUGH);
        assert!(past.source().contains("5 bundles"), "{}", past.source());
    }

    #[test]
    fn a_library_of_ten_thousand_without_bundles_is_few_files_and_megabytes() {
        let library = |keep: Keep| (0..10_000).fold(Disk::default(), |sum, _| sum.and(Disk::of(keep, 1)));
        let index = library(Keep::Index);
        assert!(index.kept_gb() < 0.2 && index.files() < 200.0, "{}", index.told(Keep::Index));
        assert!(library(Keep::Folders).files() > 200_000.0);
        assert!(library(Keep::Failed).kept_gb() > index.kept_gb());
        assert!(library(Keep::Failed).kept_gb() < library(Keep::Packed).kept_gb());
        assert!(Disk::of(Keep::Folders, 1).files() < 30.0, "one alone has no list");
    }
}
