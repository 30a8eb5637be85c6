//! What a run is asked for.

use std::path::PathBuf;

use socrates_model::{AuthorSpec, PlannerName, Seeds};

use crate::keep::Keep;
use crate::shard::Shard;

/// What a run has to be for its exit code to be 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Require {
    /// Made, with any verdict.
    Any,
    /// Realised.
    Realised,
}

impl Require {
    /// Whether a run is as required, when it is known whether everything was realised.
    #[must_use]
    pub const fn is_met(self, realised: bool) -> bool {
        match self {
            Self::Any => true,
            Self::Realised => realised,
        }
    }
}

/// Options of a run; what they name wins over the request.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Folder for the bundle; none for `runs/<name>`. With several scenarios: the folder that holds them.
    pub out: Option<PathBuf>,
    /// Base seed of authoring; of the simulation too, unless the request or `seeds` names its seeds.
    pub seed: u64,
    /// Simulation seeds, `1..20` or `1,4,9`.
    pub seeds: Option<Seeds>,
    /// Planners under test; empty for those of the request.
    pub planner: Vec<PlannerName>,
    /// Scenarios to make from each request, 1 to 100000.
    pub variants: Option<u32>,
    /// Whether variants may repeat one another: one of each seed in turn.
    pub repeats: bool,
    /// Which share of the scenarios is made; none for all of them.
    pub shard: Option<Shard>,
    /// Which bundles a library keeps; none decides by the number of scenarios.
    pub keep: Option<Keep>,
    /// Whether nothing is made, and it is said what would be.
    pub dry_run: bool,
    /// Author.
    pub author: Option<AuthorSpec>,
    /// Pace of the simulation: `max`, or simulated seconds per second.
    pub pace: String,
    /// Verdict that the exit code asks for.
    pub require: Require,
    /// Worker processes of the simulation stage.
    pub workers: Option<u32>,
    /// Faults put into the author's answers: `gdisc=0.3,bxml=0.1`.
    pub inject: String,
    /// Command line of a driver outside that is started with the run and ended with it.
    pub driver: Option<String>,
    /// Whether a person looks at what the authors made before it goes on.
    pub ask: bool,
    /// Whether viewers are shown the run, also when it is over, until somebody ends it.
    pub view: bool,
}

impl RunOptions {
    /// What a run is asked for that is asked for nothing, with this seed.
    pub fn plain(seed: u64) -> Self {
        Self {
            out: None,
            seed,
            seeds: None,
            planner: Vec::new(),
            variants: None,
            repeats: false,
            shard: None,
            keep: None,
            dry_run: false,
            author: None,
            pace: "max".to_owned(),
            require: Require::Any,
            workers: None,
            inject: String::new(),
            driver: None,
            ask: false,
            view: false,
        }
    }
}
