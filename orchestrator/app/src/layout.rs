//! What a bundle holds: the one list from which its files are written, read, looked for and listed in documents.
//!
//! A name with `*` stands for several files; what takes its place is said by [`When`].

use std::fmt::Display;
use std::path::Path;

/// When a file is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// In every bundle.
    Always,
    /// One for each human: `human_1`.
    EachHuman,
    /// One for each run: `reference-1`.
    EachRun,
    /// One for each run of a driver outside: `external.mine-1`.
    EachDrivenRun,
    /// One for each file of the location's folder.
    EachLocationFile,
}

impl When {
    /// The same in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::EachHuman => "for each human",
            Self::EachRun => "for each run",
            Self::EachDrivenRun => "for each run of a driver outside",
            Self::EachLocationFile => "for each file of its folder",
        }
    }
}

/// A file of a bundle, or the files of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sheet {
    /// Where it lies in the bundle.
    pub path: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What makes it: a stage, the request, or the drawing of it all.
    pub maker: &'static str,
    /// When it is there.
    pub when: When,
    /// Whether its digest stands in the manifest: not where working times are told, which differ from run to run.
    pub counted: bool,
}

impl Sheet {
    const fn new(path: &'static str, maker: &'static str, when: When, about: &'static str) -> Self {
        Self { path, about, maker, when, counted: true }
    }

    const fn uncounted(self) -> Self {
        Self { counted: false, ..self }
    }

    /// The path of the one of this name.
    #[must_use]
    pub fn of(&self, name: &dyn Display) -> String {
        self.path.replacen('*', &name.to_string(), 1)
    }

    /// The folder that it lies in, as a path in the bundle; empty for the bundle itself.
    #[must_use]
    pub fn folder(&self) -> &'static str {
        self.path.rsplit_once('/').map_or("", |(folder, _)| folder)
    }

    /// Its name without the folder.
    #[must_use]
    pub fn file_name(&self) -> &'static str {
        self.path.rsplit_once('/').map_or(self.path, |(_, name)| name)
    }

    /// Whether a path in a bundle is one of these.
    #[must_use]
    pub fn is(&self, path: &str) -> bool {
        let Some((before, after)) = self.path.split_once('*') else { return path == self.path };
        path.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)).is_some_and(|name| !name.is_empty())
    }
}

/// Folder of a bundle that holds all but what a person opens first. It holds the manifest, so it makes a folder a bundle.
pub const DETAILS: &str = "details";

/// Whether a path in a bundle is one of [`DETAILS`].
#[must_use]
pub fn in_details(path: &str) -> bool {
    Path::new(path).starts_with(DETAILS)
}

/// The page.
pub const PAGE: Sheet =
    Sheet::new("report.html", "drawing", When::Always, "the page: player, timeline, checklist, reading, result")
        .uncounted();
/// The picture of the leading run.
pub const PICTURE: Sheet = Sheet::new("run.png", "drawing", When::Always, "the leading run, seen from above");
/// The same as a drawing.
pub const DRAWING: Sheet = Sheet::new("run.svg", "drawing", When::Always, "the same as a drawing");
/// The story.
pub const STORY: Sheet = Sheet::new("story.txt", "scoring", When::Always, "what happened, in sentences");
/// Metrics.
pub const METRICS: Sheet = Sheet::new("metrics.csv", "scoring", When::Always, "every metric of every run");
/// Tracks.
pub const AGENTS: Sheet = Sheet::new("agents.csv", "simulation", When::Always, "where everybody was, in every run");
/// The request.
pub const REQUEST: Sheet = Sheet::new("request.toml", "request", When::Always, "the request, which makes it again");
/// The manifest.
pub const MANIFEST: Sheet =
    Sheet::new("details/manifest.json", "bundle", When::Always, "runs, verdicts and digests; written last").uncounted();
/// The provenance.
pub const PROVENANCE: Sheet =
    Sheet::new("details/provenance.json", "bundle", When::Always, "every question, answer, fault and attempt")
        .uncounted();
/// Files of the location.
pub const LOCATION_FILES: Sheet =
    Sheet::new("details/location/*", "request", When::EachLocationFile, "the location as it was given");
/// The location.
pub const LOCATION: Sheet = Sheet::new("details/location.json", "request", When::Always, "the location as it was read");
/// The reading.
pub const READING: Sheet = Sheet::new("details/reading.json", "request", When::Always, "how the request was read");
/// The proposal.
pub const PROPOSAL: Sheet = Sheet::new("details/proposal.json", "proposal", When::Always, "the scenario in detail");
/// The paths.
pub const PATHS: Sheet = Sheet::new("details/paths.json", "paths", When::Always, "ways and encounters");
/// The behaviors.
pub const BEHAVIORS: Sheet = Sheet::new("details/behaviors.json", "behaviors", When::Always, "trees and their rules");
/// Trees.
pub const TREES: Sheet =
    Sheet::new("details/behaviors/*.xml", "behaviors", When::EachHuman, "the tree, for BehaviorTree.CPP");
/// Recordings.
pub const RECORDINGS: Sheet =
    Sheet::new("details/recordings/*.mcap", "simulation", When::EachRun, "states and events of the run");
/// Commands.
pub const COMMANDS: Sheet = Sheet::new(
    "details/commands/*.json",
    "simulation",
    When::EachDrivenRun,
    "what drivers outside told the robot and people",
);
/// Reports.
pub const REPORTS: Sheet =
    Sheet::new("details/reports/*.json", "scoring", When::EachRun, "metrics, verdict and narrative of the run");

/// Every file of a bundle.
pub const LAYOUT: [Sheet; 19] = [
    PAGE,
    PICTURE,
    DRAWING,
    STORY,
    METRICS,
    AGENTS,
    REQUEST,
    MANIFEST,
    PROVENANCE,
    LOCATION_FILES,
    LOCATION,
    READING,
    PROPOSAL,
    PATHS,
    BEHAVIORS,
    TREES,
    RECORDINGS,
    COMMANDS,
    REPORTS,
];

/// The list as rows of a document's table.
#[must_use]
pub fn rows() -> Vec<String> {
    let row =
        |sheet: &Sheet| format!("| `{}` | {} | {} | {} |", sheet.path, sheet.about, sheet.maker, sheet.when.words());
    LAYOUT.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_path_is_that_of_one_kind_of_file() {
        for sheet in LAYOUT {
            let path = sheet.of(&"reference-1");
            let kinds: Vec<&str> = LAYOUT.iter().filter(|other| other.is(&path)).map(|other| other.path).collect();
            assert_eq!(kinds, [sheet.path], "{path}");
            assert_eq!(sheet.path.contains('*'), sheet.when != When::Always);
        }
        assert!(in_details(MANIFEST.path) && !in_details(PAGE.path) && !in_details("details.txt"));
        assert_eq!((LOCATION_FILES.folder(), PAGE.folder()), ("details/location", ""));
        assert_eq!((LOCATION.file_name(), PAGE.file_name()), ("location.json", PAGE.path));
        assert!(!TREES.is("details/behaviors/.xml") && !PAGE.is("report.html.bak"));
    }
}
