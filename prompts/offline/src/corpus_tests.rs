//! Every request that people wrote is answered at every stage, or refused before anything runs.

use serde::Deserialize;
use socrates_model::job::Stage;
use socrates_model::{Fault, Request};
use socrates_prompts::Question;

use crate::{Offline, read};

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    on: String,
    text: String,
}

const OPEN: [&str; 14] = [
    include_str!("../corpus/open.toml"),
    include_str!("../corpus/open-2.toml"),
    include_str!("../corpus/open-3.toml"),
    include_str!("../corpus/open-4.toml"),
    include_str!("../corpus/open-5.toml"),
    include_str!("../corpus/open-6.toml"),
    include_str!("../corpus/open-7.toml"),
    include_str!("../corpus/open-8.toml"),
    include_str!("../corpus/open-9.toml"),
    include_str!("../corpus/open-10.toml"),
    include_str!("../corpus/open-11.toml"),
    include_str!("../corpus/open-12.toml"),
    include_str!("../corpus/open-13.toml"),
    include_str!("../corpus/open-14.toml"),
];

/// What a stage says of the answer, if it does not take it.
fn refused(case: &Case) -> Option<(Stage, Vec<Fault>)> {
    let request: Request = serde_json::from_value(serde_json::json!({
        "location": case.on, "social_context": "", "task": "Deliver mail", "rough_scenario": case.text,
    }))
    .unwrap();
    let location = socrates_maps::shipped::load(&case.on).unwrap();
    let reading = read(&request, &location);
    if reading.problems.iter().any(|fault| !fault.is_soft()) {
        return None;
    }
    let mut ask = Question::first(request, reading, location, 1);
    match socrates_prompts::parse_proposal(&Offline::answer(&ask), &ask) {
        Ok(proposal) => ask.proposal = Some(proposal),
        Err(faults) => return Some((Stage::Proposal, faults)),
    }
    ask.stage = Stage::Paths;
    if let Err(faults) = socrates_prompts::parse_paths(&Offline::answer(&ask), &ask) {
        return Some((Stage::Paths, faults));
    }
    ask.stage = Stage::Behaviors;
    socrates_prompts::parse_behaviors(&Offline::answer(&ask), &ask).err().map(|faults| (Stage::Behaviors, faults))
}

/// No answer is ever refused for its form; what a map cannot hold may still be said by the stage of paths.
#[test]
#[expect(clippy::print_stdout, reason = "the figure is what the test is for")]
fn what_people_write_is_answered_at_every_stage() {
    let (mut all, mut failed) = (0_usize, Vec::new());
    for corpus in OPEN {
        let corpus: Corpus = toml::from_str(corpus).unwrap();
        for case in &corpus.request {
            all += 1;
            if let Some((stage, faults)) = refused(case) {
                println!("{stage}: “{}”: {}", case.text, faults.first().map(ToString::to_string).unwrap_or_default());
                failed.push(stage);
            }
        }
    }
    println!("{} of {all} requests are refused by a stage", failed.len());
    assert!(failed.len() * 200 <= all, "{} of {all} requests are refused by a stage", failed.len());
}
