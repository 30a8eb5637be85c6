//! One scenario from a request to its report, in this process: no bus, no other process, no file.

use socrates_author::{Desk, Papers, Written};
use socrates_model::job::Stage;
use socrates_model::{
    Behaviors, Fault, FaultCode, Location, Paths, Proposal, Reading, Recording, Report, Request, RunId,
};
use socrates_scoring::{Evidence, REFERENCE};

/// Asks per stage, as many as `run` allows.
const ASKS: u32 = 4;

/// What the authoring stages make of a scenario.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub(crate) proposal: Proposal,
    pub(crate) paths: Paths,
    pub(crate) behaviors: Behaviors,
}

/// A scenario that was made and judged.
#[derive(Debug)]
pub(crate) struct Played {
    pub(crate) proposal: Proposal,
    pub(crate) report: Report,
    pub(crate) recording: Recording,
}

/// Writes a scenario with the offline author, runs it with the reference robot and judges it. The seed is that of the author
/// and of the run.
///
/// # Errors
/// The faults of the last answer that was refused, or of the run.
pub(crate) async fn play(request: &Request, location: &Location, seed: u64) -> Result<Played, Vec<Fault>> {
    let reading = socrates_offline::read(request, location);
    let desk = Desk::default();
    let papers = |stage, proposal| Papers {
        stage,
        proposal,
        settings: [("author".to_owned(), "offline".to_owned())].into(),
        ..Papers::first(request.clone(), reading.clone(), location.clone(), seed)
    };
    let Written::Proposal(proposal) = ask(&desk, papers(Stage::Proposal, None)).await? else { return wrong() };
    let Written::Paths(paths) = ask(&desk, papers(Stage::Paths, Some(proposal.clone()))).await? else { return wrong() };
    let Written::Behaviors(behaviors) = ask(&desk, papers(Stage::Behaviors, Some(proposal.clone()))).await? else {
        return wrong();
    };
    let run = RunId::new(format!("{REFERENCE}-{seed}")).map_err(|bad| vec![ours(bad.to_string())])?;
    let made = Made { proposal, paths, behaviors };
    let recording = simulate(request, location, made.clone(), run, REFERENCE, seed)?;
    let report = socrates_scoring::score(&evidence(request, &reading, location, &made, &recording));
    Ok(Played { proposal: made.proposal, report, recording })
}

/// The proposal alone, of the offline author.
///
/// # Errors
/// The faults of the last answer that was refused.
pub(crate) async fn propose(request: &Request, location: &Location, seed: u64) -> Result<Proposal, Vec<Fault>> {
    let reading = socrates_offline::read(request, location);
    let settings = [("author".to_owned(), "offline".to_owned())].into();
    let papers = Papers { settings, ..Papers::first(request.clone(), reading, location.clone(), seed) };
    match ask(&Desk::default(), Papers { stage: Stage::Proposal, ..papers }).await? {
        Written::Proposal(proposal) => Ok(proposal),
        Written::Paths(_) | Written::Behaviors(_) => wrong(),
    }
}

/// One stage, asked again with what was wrong until it is right.
async fn ask(desk: &Desk, mut papers: Papers) -> Result<Written, Vec<Fault>> {
    let mut faults = Vec::new();
    for attempt in 1..=ASKS {
        papers.attempt = attempt;
        match desk.answer(papers.clone()).await {
            Ok(answer) => return Ok(answer.written),
            Err(refusal) => {
                papers.feedback.extend(refusal.faults.iter().cloned());
                papers.refused = refusal.text;
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
pub(crate) fn simulate(
    request: &Request,
    location: &Location,
    made: Made,
    run: RunId,
    planner: &str,
    seed: u64,
) -> Result<Recording, Vec<Fault>> {
    let Made { proposal, paths, behaviors } = made;
    let setup = socrates_simulation::setup(location.clone(), proposal, paths, behaviors, Some(request), run, seed)?;
    socrates_simulation::simulate(setup, planner)
}

/// All that the judge may look at in a run of the reference robot.
pub(crate) fn evidence<'a>(
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
