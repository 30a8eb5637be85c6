//! Writes what this reader understands of every request of the corpora, a line each, for `prompts/reader/examples/compare.rs`:
//!
//! `cargo run -p socrates-offline --example snapshot > /tmp/old.tsv`
//!
//! A line has the FNV-1a hash of the text (64 bits), whether something was said to be a problem, and the facts as the corpora write them.

#![expect(clippy::print_stdout, reason = "the lines are the result")]

mod corpora;

use corpora::{each, facts, hash};

fn main() {
    each(|text, _, (request, location), _| {
        let reading = socrates_offline::understood(request, location, socrates_model::ReadBy::Grammar);
        let facts: Vec<String> = facts(&reading).into_iter().collect();
        println!("{:016x}\t{}\t{}", hash(text), !reading.problems.is_empty(), facts.join(";"));
    });
}
