//! The paths question as a problem of geometry: what task, text and card ask for, without their words.

use socrates_model::{AgentId, FaultCode, Paths, Proposal};
use socrates_prompts::Question;
use socrates_solver::{Layout, Miss, Problem, Told};

use crate::card::card;
use crate::draw::Draw;
use crate::{NAME, spot, task};

/// Answers a paths question.
pub(crate) fn solve(question: &Question, proposal: &Proposal) -> Result<Paths, Miss> {
    socrates_solver::solve(&problem(question, proposal)).map(|solved| solved.paths)
}

/// What is to be solved.
pub(crate) fn problem<'a>(question: &'a Question, proposal: &'a Proposal) -> Problem<'a> {
    let task = task::read(&question.request.task, &question.location);
    let told = told(question, proposal);
    let layout = card(&proposal.pattern).map_or_else(Layout::default, |card| Layout {
        ends: card.ends,
        start: card.start,
        arms: card.arms,
        width_m: card.width_m,
    });
    let purpose = if told.another { "other paths" } else { "paths" };
    Problem {
        proposal,
        location: &question.location,
        starts: spot::ends(question, &task.starts, proposal.robot.start, false),
        goals: spot::ends(question, &task.goals, proposal.robot.goal, true),
        via: task.via.map(|(class, _)| class),
        rooms: spot::rooms(question),
        layout,
        told,
        draw: Draw::new(question.seed, purpose).bits(),
        author: NAME.into(),
    }
}

/// What the faults of earlier answers say to a solver.
fn told(question: &Question, proposal: &Proposal) -> Told {
    let faults = &question.feedback;
    let has = |code: FaultCode| faults.iter().any(|fault| fault.code == code);
    let short = |who: AgentId| {
        let own = |fault: &&socrates_model::Fault| fault.code == FaultCode::GShort && fault.at.names(who);
        faults.iter().filter(own).count()
    };
    let humans = proposal.humans.iter().map(|human| human.id);
    let robot = faults.iter().filter(|fault| fault.code == FaultCode::GShort && fault.at.human().is_none()).count();
    Told {
        // What is wrong with the place moves on to the next, and so does a simulation in which they did not meet.
        moves: faults.iter().filter(|fault| moves(fault.code)).count(),
        shorts: u32::try_from(robot).unwrap_or(0),
        person_shorts: humans.map(|id| (id, short(AgentId::Human(id)))).filter(|(_, times)| *times > 0).collect(),
        stuck: has(FaultCode::DStuck),
        another: has(FaultCode::PPerson),
        former: question.refused.as_deref().and_then(|text| serde_json::from_str::<Paths>(text).ok()),
    }
}

/// Whether a fault is one of the place of the meeting. A slip of the pen is none: then the same paths are written again.
const fn moves(code: FaultCode) -> bool {
    matches!(
        code,
        FaultCode::GMeet
            | FaultCode::GMeetEnd
            | FaultCode::GType
            | FaultCode::GRel
            | FaultCode::GColl
            | FaultCode::GGrp
            | FaultCode::DNoMeet
            | FaultCode::DStuck
            | FaultCode::DPen
            | FaultCode::DGroup
            | FaultCode::DSetup
    )
}
