//! `D-`: what a run showed, in recordings of shipped requests that were spoiled on purpose.

use socrates_author::offline::Offline;
use socrates_author::{Written, attempt};
use socrates_model::job::Stage;
use socrates_model::{
    AgentId, Event, EventKind, Family, FaultCode, HumanId, Location, Paths, PlannerName, Proposal, Reading, Recording,
    Request, RunId, SimTime,
};
use socrates_prompts::Question;
use socrates_scoring::Evidence;

use super::{Examples, keep, proposed, question, shipped};

pub(super) async fn examples() -> Examples {
    let mut all = Examples::new();
    let wanted = FaultCode::ALL.iter().filter(|code| code.family() == Family::Dynamic).count();
    for (request, location) in shipped() {
        if all.len() == wanted {
            break;
        }
        let reading = socrates_offline::read(&request, &location);
        let proposal = proposed(&request, &location).await;
        let asked = question(&request, &location, Stage::Paths).await;
        let Ok(Written::Paths(paths)) = attempt(&Offline, &asked).await.map(|made| made.written) else {
            continue;
        };
        let behaviors = Question { stage: Stage::Behaviors, ..asked.clone() };
        let Ok(Written::Behaviors(behaviors)) = attempt(&Offline, &behaviors).await.map(|made| made.written) else {
            continue;
        };
        let run = RunId::new("example.reference-1").unwrap();
        let setup = socrates_simulation::setup(
            location.clone(),
            proposal.clone(),
            paths.clone(),
            behaviors,
            Some(&request),
            run,
            1,
        );
        let Ok(mut recording) = socrates_simulation::simulate(setup, &PlannerName::reference()) else { continue };
        let made = (&location, &request, &reading, &proposal, &paths);
        for mutant in socrates_dev::mutants::spoiled(&evidence(made, &recording)) {
            let report = socrates_scoring::score(&evidence(made, &mutant.recording));
            keep(&mut all, report.repair.into_iter().flat_map(|repair| repair.faults));
        }
        // As the engine says it of somebody who came no further.
        let agent = AgentId::Human(HumanId::new(1));
        let time = SimTime::at_tick(recording.ticks().saturating_sub(1) as u64);
        recording.events.push(Event { time, kind: EventKind::Stuck { agent } });
        let report = socrates_scoring::score(&evidence(made, &recording));
        keep(&mut all, report.repair.into_iter().flat_map(|repair| repair.faults));
    }
    all.retain(|code, _| code.family() == Family::Dynamic);
    all
}

/// What a scenario was made of.
type Made<'a> = (&'a Location, &'a Request, &'a Reading, &'a Proposal, &'a Paths);

fn evidence<'a>((location, request, reading, proposal, paths): Made<'a>, recording: &'a Recording) -> Evidence<'a> {
    Evidence {
        location: Some(location),
        request: Some(request),
        reading: Some(reading),
        proposal: Some(proposal),
        paths: Some(paths),
        ..Evidence::of(recording)
    }
}
