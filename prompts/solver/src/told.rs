//! What the faults of earlier answers say to the solver.

use socrates_model::{AgentId, Fault, FaultCode, Paths, Proposal};

use crate::Told;

impl Told {
    /// What the faults of earlier answers say; `former` are the paths that were refused, where they can be read.
    #[must_use]
    pub fn of(faults: &[Fault], former: Option<Paths>, proposal: &Proposal) -> Self {
        let has = |code: FaultCode| faults.iter().any(|fault| fault.code == code);
        let short = |who: AgentId| {
            let own = |fault: &&Fault| fault.code == FaultCode::GShort && fault.at.names(who);
            faults.iter().filter(own).count()
        };
        let humans = proposal.humans.iter().map(|human| human.id);
        let robot = faults.iter().filter(|fault| fault.code == FaultCode::GShort && fault.at.human().is_none()).count();
        Self {
            // What is wrong with the place moves on to the next, and so does a simulation in which they did not meet.
            moves: faults.iter().filter(|fault| moves(fault.code)).count(),
            shorts: u32::try_from(robot).unwrap_or(0),
            person_shorts: humans.map(|id| (id, short(AgentId::Human(id)))).filter(|(_, times)| *times > 0).collect(),
            stuck: has(FaultCode::DStuck),
            another: has(FaultCode::PPerson),
            former,
        }
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
