//! Changes after which the robot does not begin, end, pass or keep out where it should by name.

use socrates_model::proposal::WayPart;
use socrates_model::{AgentId, AgentState, Clause, ClauseRole, Point, Predicate, Recording};
use socrates_scoring::Evidence;

use super::edit::{frozen, reversed, states, with_states};

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

/// The robot starts at the other end, stays where it starts, or drives into what it should keep out of.
pub(super) fn named_way(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let (Some(proposal), Some(location)) = (evidence.proposal, evidence.location) else { return };
    let musts =
        proposal.expected_events.iter().filter(|clause: &&Clause| clause.must && clause.role == ClauseRole::Setup);
    for clause in musts {
        let Predicate::RobotWay { part, nodes } = &clause.predicate else { continue };
        let run = evidence.recording;
        let about = format!("robot, {}", part.name());
        match part {
            WayPart::Start => add("starts at the other end", about, reversed(run, AgentId::Robot)),
            WayPart::Goal | WayPart::Via | WayPart::Back => {
                add("the robot stays where it starts", about, frozen(run, AgentId::Robot))
            }
            WayPart::Avoid => {
                if let Some(node) = nodes.first().and_then(|id| location.graph.node(id)) {
                    add("drives where it should not", about, drives_into(run, node.at));
                }
            }
        }
    }
}

/// The robot is at a place for the middle fifth of the run.
fn drives_into(run: &Recording, at: Point) -> Recording {
    let old = states(run, AgentId::Robot);
    let middle = old.len() * 2 / 5..old.len() * 3 / 5;
    let new: Vec<AgentState> = old
        .iter()
        .enumerate()
        .map(|(k, state)| if middle.contains(&k) { AgentState { x: at.x, y: at.y, ..*state } } else { *state })
        .collect();
    with_states(run, AgentId::Robot, &new, Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::{Case, corridor, must, proposal};
    use crate::fixture::{Walk, node, paths, recording};
    use socrates_model::report::Standing;

    fn standing(part: WayPart, name: &str, run: &Recording) -> Standing {
        let mut plan = proposal(0, vec![must("c1", Predicate::RobotWay { part, nodes: vec![node(name)] })]);
        plan.humans.clear();
        let case = Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[]), reading: None };
        case.judge(run).clauses.iter().find(|clause| clause.id == "c1").map(|clause| clause.standing).unwrap()
    }

    #[test]
    fn a_way_by_name_is_planned_and_driven() {
        let run = recording(&[Walk::robot(-8.0, 0.0, 0.8, 0.0)], 20.0, 0.02);
        for (part, name, other) in
            [(WayPart::Start, "a", "b"), (WayPart::Goal, "b", "a"), (WayPart::Via, "m", "a"), (WayPart::Via, "m", "b")]
        {
            assert_eq!(standing(part, name, &run), Standing::Holds, "{part:?}");
            assert_eq!(standing(part, other, &run), Standing::Fails, "{part:?}");
        }
        assert_eq!(standing(WayPart::Avoid, "m", &run), Standing::Fails);
        // What is planned has to be driven.
        let other = reversed(&run, AgentId::Robot);
        assert_eq!(standing(WayPart::Start, "a", &other), Standing::Fails);
        let stays = frozen(&run, AgentId::Robot);
        assert_eq!(standing(WayPart::Goal, "b", &stays), Standing::Fails);
        assert_eq!(standing(WayPart::Via, "m", &stays), Standing::Fails);
    }
}
