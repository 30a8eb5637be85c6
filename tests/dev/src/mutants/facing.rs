//! Changes after which somebody faces another way.

use socrates_model::geometry::wrap_angle;
use socrates_model::{AgentId, AgentState, Clause, ClauseRole, Predicate, Recording};
use socrates_scoring::Evidence;

use super::edit::{states, with_states};

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

/// Somebody who should face something faces the other way, and to the side of it.
pub(super) fn facing(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let Some(proposal) = evidence.proposal else { return };
    let musts =
        proposal.expected_events.iter().filter(|clause: &&Clause| clause.must && clause.role == ClauseRole::Setup);
    for clause in musts {
        let Predicate::Faces { human, facing } = &clause.predicate else { continue };
        let agent = AgentId::Human(*human);
        for (kind, rad) in [("faces the other way", std::f64::consts::PI), ("faces aside", 1.9)] {
            let about = format!("{human}, asked for {}", facing.phrase());
            add(kind, about, turned(evidence.recording, agent, rad));
        }
    }
}

/// The agent does the same turned by an angle all the time, rad.
fn turned(run: &Recording, agent: AgentId, rad: f64) -> Recording {
    let new: Vec<AgentState> =
        states(run, agent).iter().map(|state| AgentState { yaw: wrap_angle(state.yaw + rad), ..*state }).collect();
    with_states(run, agent, &new, Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::{Case, corridor, must, proposal};
    use crate::fixture::{Walk, paths, recording};
    use socrates_model::proposal::Facing;
    use socrates_model::report::Standing;
    use socrates_model::{HumanId, Relation};
    use std::f64::consts::{FRAC_PI_2, PI};

    const H1: HumanId = HumanId::new(1);

    fn standing(facing: Facing, run: &Recording) -> Standing {
        let mut plan = proposal(1, vec![must("c1", Predicate::Faces { human: H1, facing })]);
        plan.humans[0].relation = Relation::Static;
        let case = Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[(&["m"], "m")]), reading: None };
        case.judge(run).clauses.iter().find(|clause| clause.id == "c1").map(|clause| clause.standing).unwrap()
    }

    #[test]
    fn who_faces_as_asked_is_seen_so_and_turned_they_are_not() {
        let node = Facing::Node(crate::fixture::node("b"));
        for (facing, yaw) in [
            (Facing::Robot, PI),
            (Facing::Away, 0.0),
            (Facing::Left, FRAC_PI_2),
            (Facing::Right, -FRAC_PI_2),
            (node, 0.0),
        ] {
            let human = Walk::human(1, 0.0, 0.5, 0.0, 0.0).facing(yaw);
            let run = recording(&[Walk::robot(-8.0, 0.0, 0.8, 0.0), human], 16.0, 0.02);
            assert_eq!(standing(facing.clone(), &run), Standing::Holds, "{facing:?}");
            for rad in [PI, 1.9, -1.9] {
                let other = turned(&run, AgentId::Human(H1), rad);
                assert_eq!(standing(facing.clone(), &other), Standing::Fails, "{facing:?} {rad}");
            }
            let gone = super::super::edit::dropped(&run, AgentId::Human(H1));
            assert_ne!(standing(facing.clone(), &gone), Standing::Holds, "{facing:?}");
        }
    }

    #[test]
    fn who_turns_only_as_they_react_did_not_face_there_before() {
        // With their back to it at first; the look begins 4 s before it is there.
        let mut run = recording(
            &[
                Walk::robot(-8.0, 0.0, 0.8, 0.0),
                Walk::human(1, 0.0, 0.5, 0.0, 0.0).facing(PI).leaf(0.0, 1).leaf(3.0, 4),
            ],
            16.0,
            0.02,
        );
        for state in run.frames.iter_mut().filter(|state| state.agent == 1) {
            if (state.tick as f64) * 0.02 < 5.0 {
                state.yaw = 0.0;
            }
        }
        assert_ne!(standing(Facing::Robot, &run), Standing::Holds);
        // Somebody who never comes within sight of a moving robot faces nothing.
        let far =
            recording(&[Walk::robot(-18.0, 0.0, 0.1, 0.0), Walk::human(1, 0.0, 0.5, 0.0, 0.0).facing(PI)], 16.0, 0.02);
        assert_eq!(standing(Facing::Robot, &far), Standing::NotTriggered);
    }
}
