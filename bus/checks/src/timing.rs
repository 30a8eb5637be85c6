//! Whether robot and human can be at the encounter at about the same time: G-TIME, a warning.

use socrates_model::{Fault, FaultCode, NodeId, Paths, Proposal, Relation, SceneGraph};

/// Nominal speed of the robot, m/s.
const ROBOT_MPS: f64 = 0.8;
/// Desired speed of a human without one of its own, m/s (mean of the native profile).
const HUMAN_MPS: f64 = 1.2;
/// Fastest speed the rendezvous may ask of a human, m/s.
const FASTEST_MPS: f64 = 1.8;
/// Largest lateness of the human that is no matter, s.
const WINDOW_S: f64 = 8.0;

/// A warning per human who comes too late even at its fastest. Who comes early waits before it starts.
pub(crate) fn check(paths: &Paths, proposal: &Proposal, graph: &SceneGraph) -> Vec<Fault> {
    let mut faults = Vec::new();
    for encounter in &paths.encounters {
        let Some(human) = proposal.human(encounter.human) else { continue };
        let Some(nodes) = paths.humans.get(&encounter.human) else { continue };
        // Who walks with the robot meets it along the way, whenever that is.
        if matches!(human.relation, Relation::Behind | Relation::Ahead | Relation::Abreast) {
            continue;
        }
        let (Some(robot_m), Some(human_m)) =
            (upto_m(&paths.robot, &encounter.node, graph), upto_m(nodes, &encounter.node, graph))
        else {
            continue;
        };
        let robot_s = robot_m / ROBOT_MPS;
        let usual_s = human_m / human.speed_mps.unwrap_or(HUMAN_MPS).max(0.1);
        let least_s = human_m / FASTEST_MPS;
        if least_s > robot_s + WINDOW_S {
            let message = format!(
                "is at `{}` after {usual_s:.0} s ({human_m:.1} m; at the fastest {least_s:.0} s), the robot after {robot_s:.0} s \
                 ({robot_m:.1} m); start it nearer, or the robot further away",
                encounter.node
            );
            faults.push(Fault::new(FaultCode::GTime, encounter.human, message));
        }
    }
    faults
}

/// Length of a path up to the first visit of a node, m.
fn upto_m(nodes: &[NodeId], node: &NodeId, graph: &SceneGraph) -> Option<f64> {
    let at = nodes.iter().position(|other| other == node)?;
    Some(graph.length_m(nodes.get(..=at)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_paths, crossing_proposal, nodes, plus_map};
    use socrates_model::HumanId;

    #[test]
    fn who_comes_far_too_late_is_warned_of_and_not_refused() {
        let mut paths = crossing_paths();
        paths.robot = nodes(&["w_1", "n_center", "e_1", "e_2"]);
        assert!(check(&paths, &crossing_proposal(), &plus_map().graph).is_empty());
        let back_and_forth = ["n_2", "n_1", "n_2", "n_1", "n_2", "n_1", "n_2", "n_1", "n_center", "s_1"];
        paths.humans.insert(HumanId::new(1), nodes(&back_and_forth));
        let faults = check(&paths, &crossing_proposal(), &plus_map().graph);
        assert_eq!(codes(&faults), ["G-TIME"]);
        assert!(faults[0].is_soft());
    }
}
