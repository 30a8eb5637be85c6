//! The tools as processes, and what faults say, whose examples are made by the tools.
#![cfg(test)]

mod doors;
#[path = "../../../faults/mod.rs"]
mod faults;
mod golden;
mod originals;

use std::path::Path;

use socrates_tests::program::{Finished, run};

/// Runs a tool in a folder.
pub(crate) fn tool(folder: &Path, name: &str, args: &[&str]) -> Finished {
    run(env!("CARGO_BIN_EXE_socrates-dev"), args, folder, name).unwrap()
}
