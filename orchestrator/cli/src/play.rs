//! One scenario from a request to its report, in this process: no bus, no other process, no file.

use socrates_author::{Desk, Papers, Written};
use socrates_model::job::Stage;
use socrates_model::{Behaviors, Fault, FaultCode, Location, Paths, Proposal, Reading, Report, Request, RunId};
use socrates_scoring::Evidence;

/// Asks per stage, as many as `run` allows.
const ASKS: u32 = 4;
/// The planner that plays the robot script along the intended way.
const PLANNER: &str = "reference";

/// A scenario that was made and judged.
#[derive(Debug)]
pub(crate) struct Played {
    pub(crate) proposal: Proposal,
    pub(crate) report: Report,
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
        request: request.clone(),
        reading: reading.clone(),
        location: location.clone(),
        proposal,
        only: Vec::new(),
        feedback: Vec::new(),
        refused: None,
        seed,
        settings: [("author".to_owned(), "offline".to_owned())].into(),
        attempt: 1,
    };
    let Written::Proposal(proposal) = ask(&desk, papers(Stage::Proposal, None)).await? else { return wrong() };
    let Written::Paths(paths) = ask(&desk, papers(Stage::Paths, Some(proposal.clone()))).await? else { return wrong() };
    let Written::Behaviors(behaviors) = ask(&desk, papers(Stage::Behaviors, Some(proposal.clone()))).await? else {
        return wrong();
    };
    let report = judged(request, &reading, location, (&proposal, &paths, behaviors), seed)?;
    Ok(Played { proposal, report })
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

fn judged(
    request: &Request,
    reading: &Reading,
    location: &Location,
    (proposal, paths, behaviors): (&Proposal, &Paths, Behaviors),
    seed: u64,
) -> Result<Report, Vec<Fault>> {
    let run = RunId::new(format!("{PLANNER}-{seed}")).map_err(|bad| vec![ours(bad.to_string())])?;
    let setup = socrates_simulation::setup(
        location.clone(),
        proposal.clone(),
        paths.clone(),
        behaviors,
        Some(request),
        run,
        seed,
    )?;
    let recording = socrates_simulation::simulate(setup, PLANNER)?;
    Ok(socrates_scoring::score(&Evidence {
        recording: &recording,
        location: Some(location),
        request: Some(request),
        reading: Some(reading),
        proposal: Some(proposal),
        paths: Some(paths),
        reference: None,
        twin: None,
    }))
}

fn wrong<T>() -> Result<T, Vec<Fault>> {
    Err(vec![ours("the author answered another question than it was asked".to_owned())])
}

fn ours(why: String) -> Fault {
    Fault::new(FaultCode::JSpec, "scenario", why)
}
