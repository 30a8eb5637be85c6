//! One scenario from a request to its report, in this process: no bus, no other process, no file.

use socrates_author::{Asking, AuthorContext, Question, Written};
use socrates_model::driver::Commands;
use socrates_model::job::Stage;
use socrates_model::{
    Behaviors, Fault, FaultCode, Keeper, Location, Onlooker, Paths, Proposal, Reading, Recording, Report, Request, Run,
    RunId,
};
use socrates_scoring::Evidence;
use socrates_simulation::Driven;
use socrates_simulation::driving::{Nobody, Outside};

/// Asks per stage, as many as `run` allows.
const ASKS: u32 = 4;

/// What the authoring stages make of a scenario.
#[derive(Debug, Clone)]
pub struct Made {
    /// The proposal.
    pub proposal: Proposal,
    /// The paths.
    pub paths: Paths,
    /// The behaviors.
    pub behaviors: Behaviors,
}

/// A scenario that was made and judged.
#[derive(Debug)]
pub struct Played {
    /// The proposal.
    pub proposal: Proposal,
    /// The paths.
    pub paths: Paths,
    /// The report.
    pub report: Report,
    /// The recording.
    pub recording: Recording,
}

/// Writes a scenario with the offline author, runs it with the reference robot and judges it. The seed is that of the author
/// and of the run.
///
/// # Errors
/// The faults of the last answer that was refused, or of the run.
pub async fn play(request: &Request, location: &Location, seed: u64) -> Result<Played, Vec<Fault>> {
    let reading = socrates_offline::read(request, location);
    let question = |stage, proposal| Question {
        stage,
        proposal,
        ..Question::first(request.clone(), reading.clone(), location.clone(), seed)
    };
    let Written::Proposal(proposal) = ask(question(Stage::Proposal, None)).await? else { return wrong() };
    let Written::Paths(paths) = ask(question(Stage::Paths, Some(proposal.clone()))).await? else { return wrong() };
    let Written::Behaviors(behaviors) = ask(question(Stage::Behaviors, Some(proposal.clone()))).await? else {
        return wrong();
    };
    let run = Run::reference(seed);
    // Of no scenario: it is called by its planner and seed alone.
    let id = RunId::new(run.to_string()).map_err(|bad| vec![ours(bad.to_string())])?;
    let made = Made { proposal, paths, behaviors };
    let recording = simulate(request, location, made.clone(), id, &run)?;
    let report = socrates_scoring::score(&evidence(request, &reading, location, &made, &recording));
    Ok(Played { proposal: made.proposal, paths: made.paths, report, recording })
}

/// The proposal alone, of the offline author.
///
/// # Errors
/// The faults of the last answer that was refused.
pub(crate) async fn propose(request: &Request, location: &Location, seed: u64) -> Result<Proposal, Vec<Fault>> {
    let reading = socrates_offline::read(request, location);
    match ask(Question::first(request.clone(), reading, location.clone(), seed)).await? {
        Written::Proposal(proposal) => Ok(proposal),
        Written::Paths(_) | Written::Behaviors(_) => wrong(),
    }
}

/// Proposal and paths as the offline author will write them in a scenario of this base seed: asked with the seeds that its jobs
/// get.
///
/// # Errors
/// The faults of the last answer that was refused.
pub(crate) async fn foresee(
    request: &Request,
    reading: &Reading,
    location: &Location,
    base_seed: u64,
) -> Result<(Proposal, Paths), Vec<Fault>> {
    let question = |stage| {
        let seed = socrates_orchestrator::pipeline::authored_seed(base_seed, stage, 0, 0);
        Question { stage, ..Question::first(request.clone(), reading.clone(), location.clone(), seed) }
    };
    let Written::Proposal(proposal) = ask(question(Stage::Proposal)).await? else { return wrong() };
    let asked = Question { proposal: Some(proposal.clone()), ..question(Stage::Paths) };
    let Written::Paths(paths) = ask(asked).await? else { return wrong() };
    Ok((proposal, paths))
}

/// A scenario of this base seed as the offline author writes it: asked with the seeds that its jobs would get.
///
/// # Errors
/// The faults of the last answer that was refused.
pub(crate) async fn author(
    request: &Request,
    reading: &Reading,
    location: &Location,
    base_seed: u64,
) -> Result<Made, Vec<Fault>> {
    let (proposal, paths) = foresee(request, reading, location, base_seed).await?;
    let stage = Stage::Behaviors;
    let seed = socrates_orchestrator::pipeline::authored_seed(base_seed, stage, 0, 0);
    let first = Question::first(request.clone(), reading.clone(), location.clone(), seed);
    let Written::Behaviors(behaviors) = ask(Question { stage, proposal: Some(proposal.clone()), ..first }).await?
    else {
        return wrong();
    };
    Ok(Made { proposal, paths, behaviors })
}

/// One stage, asked again with what was wrong until it is right.
async fn ask(mut question: Question) -> Result<Written, Vec<Fault>> {
    let context = AuthorContext::default();
    let mut faults = Vec::new();
    for attempt in 1..=ASKS {
        match context.answer(&question, &Asking { attempt, ..Asking::offline() }).await {
            Ok(answer) => return Ok(answer.written),
            Err(refusal) => {
                question.feedback.extend(refusal.faults.iter().cloned());
                question.refused = refusal.text;
                faults = refusal.faults;
            }
        }
    }
    Err(faults)
}

/// One run of a scenario.
///
/// # Errors
/// What is wrong with its parts or its planner.
pub fn simulate(
    request: &Request,
    location: &Location,
    made: Made,
    id: RunId,
    run: &Run,
) -> Result<Recording, Vec<Fault>> {
    let Made { proposal, paths, behaviors } = made;
    let setup = socrates_simulation::setup(location.clone(), proposal, paths, behaviors, Some(request), id, run.seed);
    let mut keeper = Keeper::default();
    socrates_simulation::simulate_into(setup, Driven::of(request, &run.planner), &mut Nobody, &mut keeper)?;
    keeper.recording().ok_or_else(|| vec![ours("the run ended before its first tick".to_owned())])
}

/// The same; `onlooker` gets everything as it comes, and nothing of it is kept. A driver that no catalog has is looked for
/// `outside`.
///
/// # Errors
/// As [`simulate`].
pub(crate) fn simulate_into(
    (request, location): (&Request, &Location),
    made: Made,
    id: RunId,
    run: &Run,
    outside: &mut dyn Outside,
    onlooker: &mut dyn Onlooker,
) -> Result<Option<Commands>, Vec<Fault>> {
    let Made { proposal, paths, behaviors } = made;
    let setup = socrates_simulation::setup(location.clone(), proposal, paths, behaviors, Some(request), id, run.seed);
    socrates_simulation::simulate_into(setup, Driven::of(request, &run.planner), outside, onlooker)
}

/// All that the judge may look at in a run of the reference robot.
#[must_use]
pub fn evidence<'a>(
    request: &'a Request,
    reading: &'a Reading,
    location: &'a Location,
    made: &'a Made,
    recording: &'a Recording,
) -> Evidence<'a> {
    Evidence {
        location: Some(location),
        request: Some(request),
        reading: Some(reading),
        proposal: Some(&made.proposal),
        paths: Some(&made.paths),
        ..Evidence::of(recording)
    }
}

fn wrong<T>() -> Result<T, Vec<Fault>> {
    Err(vec![ours("the author answered another question than it was asked".to_owned())])
}

fn ours(why: String) -> Fault {
    Fault::new(FaultCode::JSpec, "scenario", why)
}

#[cfg(test)]
mod tests {
    use socrates_model::Verdict;

    use super::*;

    /// A corridor with two elevators that only the types of their nodes tell; their openings are as wide as the cars.
    const CARS: &str = r#"
        description = "A corridor with two elevators."
        size_m = [20.0, 9.0]
        resolution_m = 0.05
        floors = [[0.5, 0.5, 19.5, 3.5], [5.0, 3.7, 7.6, 7.0], [12.0, 3.7, 14.6, 7.0]]
        openings = [[5.0, 3.6, 7.6, 3.6], [12.0, 3.6, 14.6, 3.6]]
        nodes = [
          { id = "w", type = "CORRIDOR", at = [1.5, 2.0] },
          { id = "h1", type = "CORRIDOR", at = [4.0, 2.0] },
          { id = "o1", type = "OUTSIDE_ELEVATOR_1", at = [6.3, 2.3] },
          { id = "d1", type = "WITHIN_ELEVATOR_1", at = [6.3, 4.6] },
          { id = "ac", type = "WITHIN_ELEVATOR_1", at = [6.3, 6.2] },
          { id = "h2", type = "CORRIDOR", at = [9.8, 2.0] },
          { id = "o2", type = "OUTSIDE_ELEVATOR_2", at = [13.3, 2.3] },
          { id = "d2", type = "WITHIN_ELEVATOR_2", at = [13.3, 4.6] },
          { id = "bc", type = "WITHIN_ELEVATOR_2", at = [13.3, 6.2] },
          { id = "h3", type = "CORRIDOR", at = [16.0, 2.0] },
          { id = "e", type = "CORRIDOR", at = [18.5, 2.0] },
        ]
        edges = [
          { type = "CORRIDOR", along = ["w", "h1", "o1", "h2", "o2", "h3", "e"] },
          { type = "ELEVATOR", along = ["o1", "d1", "ac"] },
          { type = "ELEVATOR", along = ["o2", "d2", "bc"] },
        ]
    "#;

    fn location(plan: &str) -> Location {
        socrates_maps::parse(&socrates_maps::generate(plan).unwrap(), "own").unwrap()
    }

    async fn judged(location: &Location, task: &str, rough: &str, seed: u64) -> Report {
        let request =
            serde_json::json!({ "location": "own", "social_context": "", "task": task, "rough_scenario": rough });
        let request: Request = serde_json::from_value(request).unwrap();
        play(&request, location, seed).await.unwrap_or_else(|faults| panic!("{rough}: {faults:#?}")).report
    }

    #[tokio::test]
    async fn elevators_that_only_node_types_tell_are_left_entered_and_stayed_in() {
        let place = location(CARS);
        for rough in [
            "The door opens and a visitor comes out of the elevator.",
            "Two people leave the elevator, one stays inside.",
            "A visitor comes out of the elevator and waves at the robot.",
        ] {
            for seed in 1..=3 {
                let report = judged(&place, "Take the elevator to deliver supplies", rough, seed).await;
                assert_eq!(report.verdict, Verdict::Realised, "{rough} {seed}: {}", report.verdict_text);
            }
        }
    }

    #[tokio::test]
    async fn somebody_comes_out_of_the_room_of_the_map_that_the_readme_makes() {
        let readme = include_str!("../../../maps/README.md");
        let plan = readme.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
        let place = location(plan);
        for seed in 1..=5 {
            let report = judged(&place, "Drive along the corridor", "A person comes out of the room.", seed).await;
            assert_eq!(report.verdict, Verdict::Realised, "{seed}: {}", report.verdict_text);
        }
    }

    #[tokio::test]
    async fn a_request_of_which_something_cannot_be_played_is_never_realised() {
        let place = socrates_maps::shipped::load("office").unwrap();
        for (rough, words) in [
            ("A person drops a cup and kneels down.", "1 wish is not in this run: `drops`"),
            (
                "A nurse comes towards the robot. Then she sings a song.",
                "2 wishes are not in this run: `sings a`, `song`",
            ),
        ] {
            let report = judged(&place, "Drive to the exit", rough, 1).await;
            assert_eq!(report.verdict, Verdict::Invalid, "{rough}: {}", report.verdict_text);
            assert!(report.verdict_text.starts_with(words), "{rough}: {}", report.verdict_text);
        }
    }
}
