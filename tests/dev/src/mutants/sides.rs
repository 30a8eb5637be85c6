//! Changes after which somebody is on the other side of the robot's way, or does not come from where they should.

use socrates_model::nalgebra::Vector2;
use socrates_model::{AgentId, AgentState, Clause, ClauseRole, Point, Predicate, Recording, Relation, Vector};
use socrates_scoring::Evidence;

use super::edit::{frozen, states, with_states};

/// The robot's drive is taken in steps of this length, m.
const STEP_M: f64 = 0.2;

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

/// Somebody who should be on a side is on the other, and does not set off at all.
pub(super) fn sides(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let Some(proposal) = evidence.proposal else { return };
    let musts =
        proposal.expected_events.iter().filter(|clause: &&Clause| clause.must && clause.role == ClauseRole::Setup);
    for clause in musts {
        let Predicate::OnSide { human, side } = clause.predicate else { continue };
        let agent = AgentId::Human(human);
        add("on the other side", format!("{human}, asked for {}", side.name()), mirrored(evidence.recording, agent));
        let walks = proposal.human(human).is_some_and(|human| human.relation != Relation::Static);
        if walks {
            add("does not set off", human.to_string(), frozen(evidence.recording, agent));
        }
    }
}

/// The agent does the same on the other side of the way that the robot drives.
fn mirrored(run: &Recording, agent: AgentId) -> Recording {
    let mut drive: Vec<Point> = Vec::new();
    for state in states(run, AgentId::Robot) {
        if drive.last().is_none_or(|last| (state.point() - last).norm() >= STEP_M) {
            drive.push(state.point());
        }
    }
    let line = |at: &Point| -> Option<(Point, Vector)> {
        let pieces = drive.windows(2).filter_map(|pair| {
            let &[a, b] = pair else { return None };
            let along = (b - a) / (b - a).norm();
            let share = (at - a).dot(&along).clamp(0.0, (b - a).norm());
            Some(((at - (a + along * share)).norm(), a, along))
        });
        pieces.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, a, along)| (a, along))
    };
    let across = |vector: Vector, along: &Vector| along * (2.0 * vector.dot(along)) - vector;
    let new: Vec<AgentState> = states(run, agent)
        .iter()
        .map(|state| {
            let Some((from, along)) = line(&state.point()) else { return *state };
            let at = from + across(state.point() - from, &along);
            let velocity = across(Vector2::new(state.vx, state.vy), &along);
            let facing = across(Vector2::new(libm::cos(state.yaw), libm::sin(state.yaw)), &along);
            AgentState {
                x: at.x,
                y: at.y,
                vx: velocity.x,
                vy: velocity.y,
                yaw: libm::atan2(facing.y, facing.x),
                ..*state
            }
        })
        .collect();
    with_states(run, agent, &new, Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::{Case, corridor, must, proposal};
    use crate::fixture::{Walk, paths, recording};
    use socrates_model::report::Standing;
    use socrates_model::{HumanId, Side};

    const H1: HumanId = HumanId::new(1);

    fn case(relation: Relation, side: Side) -> Case {
        let mut plan = proposal(1, vec![must("c1", Predicate::OnSide { human: H1, side })]);
        plan.humans[0].relation = relation;
        Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[(&["m"], "m")]), reading: None }
    }

    fn standing(case: &Case, run: &Recording) -> Standing {
        case.judge(run).clauses.iter().find(|clause| clause.id == "c1").map(|clause| clause.standing).unwrap()
    }

    /// How somebody is on the left of a robot that drives along the x axis, by relation.
    fn on_the_left() -> Vec<(Relation, Walk)> {
        let walk = |x, y, vx, vy| Walk::human(1, x, y, vx, vy);
        vec![
            (Relation::Crossing, walk(0.0, 8.0, 0.0, -0.9)),
            (Relation::Leaving, walk(1.0, 6.0, 0.0, -0.6)),
            (Relation::Static, walk(0.0, 0.9, 0.0, 0.0)),
            (Relation::Frontal, walk(8.0, 0.7, -1.0, 0.0)),
            (Relation::Behind, walk(-11.0, 0.8, 1.2, 0.0)),
            (Relation::Ahead, walk(-4.0, 0.4, 0.5, 0.0)),
            (Relation::Abreast, walk(-8.0, 1.0, 0.8, 0.0)),
        ]
    }

    #[test]
    fn who_is_on_the_asked_side_is_seen_there_and_on_no_other() {
        for (relation, walk) in on_the_left() {
            let run = recording(&[Walk::robot(-8.0, 0.0, 0.8, 0.0), walk], 20.0, 0.02);
            let (left, right) = (case(relation, Side::Left), case(relation, Side::Right));
            assert_eq!(standing(&left, &run), Standing::Holds, "{relation:?}");
            assert_ne!(standing(&right, &run), Standing::Holds, "{relation:?}");
            // On the other side it is the other way round.
            let other = mirrored(&run, AgentId::Human(H1));
            assert_ne!(standing(&left, &other), Standing::Holds, "{relation:?}");
            assert_eq!(standing(&right, &other), Standing::Holds, "{relation:?}");
            if relation != Relation::Static {
                assert_ne!(standing(&left, &frozen(&run, AgentId::Human(H1))), Standing::Holds, "{relation:?}");
            }
            assert_ne!(standing(&left, &super::super::edit::dropped(&run, AgentId::Human(H1))), Standing::Holds);
        }
        for (relation, walk) in on_the_left() {
            let still = recording(&[Walk::robot(-8.0, 0.0, 0.0, 0.0), walk], 20.0, 0.02);
            assert_ne!(
                standing(&case(relation, Side::Left), &still),
                Standing::Holds,
                "a robot that stands has no way"
            );
        }
    }

    #[test]
    fn who_is_in_the_middle_of_the_way_is_on_no_side() {
        for (relation, walk) in [
            (Relation::Static, Walk::human(1, 0.0, 0.1, 0.0, 0.0)),
            (Relation::Frontal, Walk::human(1, 8.0, 0.05, -1.0, 0.0)),
            (Relation::Ahead, Walk::human(1, -4.0, 0.0, 0.5, 0.0)),
            // Coming towards the robot is coming from no side.
            (Relation::Crossing, Walk::human(1, 8.0, 0.2, -1.0, 0.0)),
            // Somebody who stands beside its way does not come from there.
            (Relation::Leaving, Walk::human(1, 0.0, 3.0, 0.0, 0.0)),
        ] {
            let run = recording(&[Walk::robot(-8.0, 0.0, 0.8, 0.0), walk], 20.0, 0.02);
            for side in [Side::Left, Side::Right] {
                assert_ne!(standing(&case(relation, side), &run), Standing::Holds, "{relation:?} {side:?}");
            }
        }
    }

    #[test]
    fn a_side_that_was_kept_loses_the_verdict_on_the_other() {
        let case = case(Relation::Static, Side::Left);
        let run = recording(&[Walk::robot(-8.0, 0.0, 0.8, 0.0), Walk::human(1, 0.0, 0.9, 0.0, 0.0)], 20.0, 0.02);
        let evidence = case.evidence(&run);
        let mutants = super::super::spoiled(&evidence);
        let other = mutants.iter().find(|mutant| mutant.kind == "on the other side").unwrap();
        assert_eq!(standing(&case, &other.recording), Standing::Fails);
    }
}
