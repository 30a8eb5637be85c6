//! The main job with real processes: requests in, bundles out.

mod asking;
mod bad_input;
mod bags;
mod batches;
mod bundles;
mod clusters;
mod comparing;
mod consoles;
mod coverage;
mod doors;
mod evaluations;
mod experiments;
mod exports;
mod folders;
mod judges;
mod kept;
mod keys;
pub(crate) mod kits;
mod leaving;
mod libraries;
mod live;
mod map_edit;
mod maps;
mod no_ways;
pub(crate) mod observers;
mod observing;
mod opinions;
mod originals;
mod pages;
mod readme;
mod release;
mod repairs;
mod requests;
mod restarts;
mod series;
mod slow_author;
mod soundness;
mod steering;
pub(crate) mod studies;
mod tables;
mod training;

use std::process::Child;

/// Stages that workers serve.
const STAGES: [&str; 5] = ["proposal", "paths", "behaviors", "simulation", "scoring"];

/// Processes that end with the test, however it ends.
struct Ended(Vec<Child>);

impl Drop for Ended {
    fn drop(&mut self) {
        for child in &mut self.0 {
            drop(child.kill());
            drop(child.wait());
        }
    }
}
