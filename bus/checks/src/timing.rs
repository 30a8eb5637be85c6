//! Whether robot and human can be at the encounter at about the same time: G-TIME, a warning.

use socrates_model::{Fault, FaultCode, HumanId, NodeId, Paths, Proposal, Relation, SceneGraph};

/// Nominal speed of the robot, m/s.
const ROBOT_MPS: f64 = 0.8;
/// Desired speed of a human without one of its own, m/s (mean of the native profile).
const HUMAN_MPS: f64 = 1.2;
/// Fastest speed the rendezvous may ask of a human, m/s.
const FASTEST_MPS: f64 = 1.8;
/// Largest lateness of the human that is no matter, s.
const WINDOW_S: f64 = 8.0;

/// Slowest speed the rendezvous asks for, m/s, and the longest it holds somebody between two encounters, s.
const SLOWEST_MPS: f64 = 0.6;
const HOLD_S: f64 = 10.0;

/// A warning per human who comes too late even at its fastest. Who comes early waits before it starts; between two encounters
/// it cannot wait long, and may come too early as well.
pub(crate) fn check(paths: &Paths, proposal: &Proposal, graph: &SceneGraph) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, encounter) in paths.encounters.iter().enumerate() {
        if paths.encounters.iter().take(index).any(|before| before.human == encounter.human) {
            continue;
        }
        faults.extend(between(encounter.human, paths, graph));
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
                 ({robot_m:.1} m); start them nearer, or the robot further away",
                encounter.node
            );
            faults.push(Fault::new(FaultCode::GTime, encounter.human, message));
        }
    }
    faults
}

/// What is wrong with the times between the encounters of one person.
fn between(human: HumanId, paths: &Paths, graph: &SceneGraph) -> Vec<Fault> {
    let visits = paths.visits(human);
    let own = paths.humans.get(&human).map_or(&[][..], Vec::as_slice);
    let length_m =
        |path: &[NodeId], from: Option<usize>, to: Option<usize>| Some(graph.length_m(path.get(from?..=to?)?));
    let mut faults = Vec::new();
    for pair in visits.windows(2) {
        let [before, next] = pair else { continue };
        let (Some(robot_m), Some(human_m)) = (
            length_m(&paths.robot, before.robot_step, next.robot_step),
            length_m(own, before.human_step, next.human_step),
        ) else {
            continue;
        };
        let robot_s = robot_m / ROBOT_MPS;
        let (least_s, most_s) = (human_m / FASTEST_MPS, human_m / SLOWEST_MPS + HOLD_S);
        let why = if least_s > robot_s + WINDOW_S {
            format!("takes at least {least_s:.0} s ({human_m:.1} m)")
        } else if own.len() > 1 && most_s + WINDOW_S < robot_s {
            format!("can take at most {most_s:.0} s ({human_m:.1} m)")
        } else {
            continue;
        };
        let message = format!(
            "{why} from `{}` to `{}`, the robot {robot_s:.0} s ({robot_m:.1} m); give both ways of about the same length between the two \
             encounters",
            before.node, next.node
        );
        faults.push(Fault::new(FaultCode::GTime, human, message));
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
    use socrates_model::Encounter;

    #[test]
    fn between_two_encounters_both_ways_take_about_the_same_time() {
        let human = HumanId::new(1);
        let mut paths = crossing_paths();
        paths.robot = nodes(&["w_1", "n_center", "n_1", "n_2", "n_1", "n_center", "e_1"]);
        paths.encounters.retain(|encounter| encounter.human != human);
        let node = &nodes(&["n_center"])[0];
        paths.encounters.extend([0, 1].map(|_| Encounter { human, node: node.clone() }));
        let faults = |between: &[&str]| {
            let mut paths = paths.clone();
            paths.humans.insert(human, nodes(&[&["n_2", "n_center"], between, &["n_center", "w_1"]].concat()));
            check(&paths, &crossing_proposal(), &plus_map().graph)
        };
        assert!(faults(&["s_1"]).is_empty());
        let late = faults(&["s_1", "s_2"].repeat(8));
        assert_eq!(codes(&late), ["G-TIME"]);
        assert!(late[0].is_soft() && late[0].message.to_string().contains("takes at least"), "{}", late[0].message);
        paths.robot = nodes(&["w_1", "n_center"]).into_iter().chain(nodes(&["n_1", "n_2"].repeat(4))).collect();
        paths.robot.extend(nodes(&["n_1", "n_center", "e_1"]));
        let mut early = paths.clone();
        early.humans.insert(human, nodes(&["s_1", "n_center", "s_1", "n_center", "w_1"]));
        let early = check(&early, &crossing_proposal(), &plus_map().graph);
        assert!(early[0].message.to_string().contains("can take at most"), "{}", early[0].message);
    }

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
