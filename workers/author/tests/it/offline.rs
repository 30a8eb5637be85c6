//! The offline author meets the checks: every shipped request gets a proposal, paths and behaviors within the ladder of attempts.
#![expect(clippy::print_stdout, reason = "a long ladder says so")]

use std::path::Path;

use socrates_author::{Asking, AuthorContext, JobAnswer, Question, Written};
use socrates_model::job::Stage;
use socrates_model::seeds::derive_seed;
use socrates_model::{Behaviors, Fault, Location, Paths, Proposal, Reading, Request};
use socrates_tests::skip::shared;

/// Attempts that a stage has before it is given up.
const ATTEMPTS: u32 = 4;

fn question(
    stage: Stage,
    request: &Request,
    reading: &Reading,
    location: &Location,
    proposal: Option<&Proposal>,
    seed: u64,
) -> Question {
    Question {
        stage,
        proposal: proposal.cloned(),
        ..Question::first(request.clone(), reading.clone(), location.clone(), derive_seed(seed, &[stage.name()]))
    }
}

/// Asks until an answer passes, with the reasons of the refusals; the attempts that were needed and the faults on the way.
async fn ladder(mut question: Question, mut asking: Asking) -> Result<(JobAnswer, u32), Vec<Fault>> {
    let context = AuthorContext::default();
    loop {
        match context.answer(&question, &asking).await {
            Ok(answer) => return Ok((answer, asking.attempt)),
            Err(refusal) => {
                question.feedback.extend(refusal.faults);
                question.refused = refusal.text;
                asking.attempt += 1;
                if asking.attempt > ATTEMPTS {
                    return Err(question.feedback);
                }
            }
        }
    }
}

async fn author(
    request: &Request,
    location: &Location,
    seed: u64,
) -> Result<(Proposal, Paths, Behaviors, u32), String> {
    let reading = socrates_offline::read(request, location);
    let told = |stage: Stage, faults: Vec<Fault>| {
        let lines: Vec<String> = faults.iter().map(ToString::to_string).collect();
        format!("{stage}:\n    {}", lines.join("\n    "))
    };
    let ask = async |stage: Stage, proposal: Option<&Proposal>| {
        let question = question(stage, request, &reading, location, proposal, seed);
        ladder(question, Asking::offline()).await.map_err(|faults| told(stage, faults))
    };
    let (answer, first) = ask(Stage::Proposal, None).await?;
    let Written::Proposal(proposal) = answer.written else { return Err("no proposal".into()) };
    let (answer, second) = ask(Stage::Paths, Some(&proposal)).await?;
    let Written::Paths(paths) = answer.written else { return Err("no paths".into()) };
    let (answer, third) = ask(Stage::Behaviors, Some(&proposal)).await?;
    let Written::Behaviors(behaviors) = answer.written else { return Err("no behaviors".into()) };
    let faults = socrates_checks::check_all(location, Some(&reading), &proposal, &paths, &behaviors);
    let hard = socrates_model::fault::hard(&faults);
    if hard.is_empty() {
        Ok((proposal, paths, behaviors, first.max(second).max(third)))
    } else {
        Err(format!("all together: {hard:?}"))
    }
}

#[tokio::test]
async fn every_shipped_request_is_answered_within_the_ladder() {
    let mut broken = Vec::new();
    let mut asked = 0;
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).expect("a shipped location loads");
        for (file, text) in socrates_maps::shipped::requests(name) {
            let request: Request = toml::from_str(text).unwrap_or_else(|why| panic!("{name}/{file}: {why}"));
            for seed in 1..=5 {
                asked += 1;
                match author(&request, &location, seed).await {
                    Ok((_, _, _, attempts)) => {
                        if attempts > 1 {
                            println!("{name}/{file} seed {seed}: {attempts} attempts");
                        }
                    }
                    Err(why) => broken.push(format!("{name}/{file} seed {seed}: {why}")),
                }
            }
        }
    }
    assert!(asked > 0, "no shipped request");
    assert!(broken.is_empty(), "{} of {asked} failed:\n{}", broken.len(), broken.join("\n"));
}

/// Asks for a location of others with people described, and without.
async fn answered_guided_and_unguided(folder: &Path) {
    let location = socrates_maps::load(folder).expect("the location loads");
    let rough = "Two people walk together through the aisles; one of them runs away when they see the robot, the other one follows it";
    let mut broken = Vec::new();
    for (rough, seed) in [(Some(rough), 1), (Some(rough), 2), (None, 1), (None, 2), (None, 3), (None, 4)] {
        let request: Request = serde_json::from_value(serde_json::json!({
            "location": location.name,
            "social_context": "A busy warehouse with racks and a packaging area",
            "task": "Deliver coffee from one corner of the warehouse to another",
            "rough_scenario": rough,
        }))
        .expect("a request");
        if let Err(why) = author(&request, &location, seed).await {
            broken.push(format!("{rough:?} seed {seed}: {why}"));
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[tokio::test]
async fn a_location_in_the_style_of_others_is_answered_guided_and_unguided() {
    answered_guided_and_unguided(&socrates_tests::root().join(socrates_tests::ANNEX)).await;
}

#[tokio::test]
async fn the_small_warehouse_is_answered_guided_and_unguided() {
    let Some(folder) = shared("socrates_hunav/socrates/locations/small_warehouse") else { return };
    answered_guided_and_unguided(&folder).await;
}

#[tokio::test]
async fn injected_faults_are_survived_and_leave_the_same_answer() {
    let name = socrates_maps::shipped::names()[0];
    let location = socrates_maps::shipped::load(name).expect("a shipped location loads");
    let requests = socrates_maps::shipped::requests(name);
    let request: Request = toml::from_str(requests[0].1).expect("a request");
    let reading = socrates_offline::read(&request, &location);
    let clean = question(Stage::Proposal, &request, &reading, &location, None, 3);
    let mut faulty = Asking::offline();
    for (key, value) in [("fault.trunc", "1"), ("fault.first_only", "true")] {
        faulty.settings.insert(key.to_owned(), value.to_owned());
    }
    let (_, attempts) = ladder(clean.clone(), faulty).await.expect("the second attempt passes");
    assert_eq!(attempts, 2);
    assert_eq!(ladder(clean, Asking::offline()).await.expect("passes").1, 1);
}
