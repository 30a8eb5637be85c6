//! What a run is asked for.

use std::path::PathBuf;

use socrates_model::{AuthorSpec, PlannerName, Seeds};

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
    /// Author.
    pub author: Option<AuthorSpec>,
    /// Pace of the simulation: `max`, or simulated seconds per second.
    pub pace: String,
    /// `realised` where any other verdict counts as not made, else `any`.
    pub require: String,
    /// Worker processes of the simulation stage.
    pub workers: Option<u32>,
    /// Faults put into the author's answers: `gdisc=0.3,bxml=0.1`.
    pub inject: String,
    /// Whether a person looks at what the authors made before it goes on.
    pub ask: bool,
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
            author: None,
            pace: "max".to_owned(),
            require: "any".to_owned(),
            workers: None,
            inject: String::new(),
            ask: false,
        }
    }
}
