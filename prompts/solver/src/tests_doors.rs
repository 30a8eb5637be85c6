//! Problems in which somebody has to be seen to go through a door, and people who stay behind one.

use socrates_model::{AgentId, Clause, ClauseRole, DoorKind, HumanId, Location, PlaceClass, Predicate, Relation, Side};

use crate::testing::{block, door, map, node, proposal};
use crate::{Problem, solve};

/// A corridor of 28 m by 2 m with a room of 8 m by 3 m on its upper side, behind a door at its left end.
fn with_room() -> Location {
    let names: Vec<String> = (0..7).map(|k| format!("c{k}")).collect();
    let mut nodes = vec![
        ("door", "DOORWAY", 14.0, 4.1),
        ("in", "ROOM", 14.0, 5.6),
        ("near", "ROOM", 16.0, 5.6),
        ("far", "ROOM", 20.0, 5.6),
    ];
    nodes.extend(names.iter().enumerate().map(|(k, id)| (id.as_str(), "CORRIDOR", 2.0 + 4.0 * k as f64, 3.0)));
    let mut edges: Vec<(&str, &str)> = names.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect();
    edges.extend([("c3", "door"), ("door", "in"), ("in", "near"), ("near", "far")]);
    let floor = [[0.5, 2.0, 27.0, 2.0], [13.4, 3.9, 1.2, 0.5], [13.0, 4.3, 8.0, 3.0]];
    let mut location = map([28.0, 8.0], &floor, &nodes, &edges);
    location.doors = vec![door(serde_json::json!({
        "id": "office", "kind": DoorKind::Room, "from": [13.4, 4.1], "to": [14.6, 4.1], "opens": { "near": 1.5 },
        "inside": ["in", "near", "far"]
    }))];
    location
}

fn before(first: AgentId, then: AgentId) -> Clause {
    Clause {
        id: "c1".into(),
        text: "one is through the door before the other".into(),
        role: ClauseRole::Setup,
        must: true,
        source: "f1".into(),
        predicate: Predicate::Before { first, then, at_door: true },
    }
}

#[test]
fn an_order_at_a_door_leads_the_robot_through_it() {
    let location = with_room();
    let human = AgentId::Human(HumanId::new(1));
    for draw in 0..4 {
        let mut leaves = proposal(PlaceClass::Corridor, &[Relation::Leaving]);
        leaves.expected_events.push(before(human, AgentId::Robot));
        let paths = solve(&Problem { draw, ..Problem::of(&leaves, &location, "test".into()) }).unwrap().paths;
        assert!(paths.robot.contains(&node("door")), "{paths:?}");
        // Whoever comes towards the robot goes in where it came out.
        let mut comes = proposal(PlaceClass::Doorway, &[Relation::Frontal]);
        comes.expected_events.push(before(AgentId::Robot, human));
        let paths = solve(&Problem { draw, ..Problem::of(&comes, &location, "test".into()) }).unwrap().paths;
        let own = &paths.humans[&HumanId::new(1)];
        assert!(["in", "near", "far"].map(node).contains(&paths.robot[0]), "{paths:?}");
        assert!(paths.robot.contains(&node("door")) && own.contains(&node("door")), "{paths:?}");
        assert!(["in", "near", "far"].map(node).contains(own.last().unwrap()), "{paths:?}");
    }
}

#[test]
fn whoever_stays_inside_stands_where_the_robot_comes_near_them() {
    let location = with_room();
    let mut stays = proposal(PlaceClass::Room, &[Relation::Staying]);
    stays.robot.goal = Some(PlaceClass::Room);
    for draw in 0..4 {
        let paths = solve(&Problem { draw, ..Problem::of(&stays, &location, "test".into()) }).unwrap().paths;
        let at = |id| location.graph.node(id).unwrap().at;
        let apart_m = (at(paths.robot.last().unwrap()) - at(&paths.humans[&HumanId::new(1)][0])).norm();
        assert!(apart_m < 3.0, "{paths:?}");
    }
}

#[test]
fn whoever_stands_on_a_side_does_so_away_from_where_somebody_comes_towards_the_robot() {
    let location = block("CORRIDOR");
    let mut both = proposal(PlaceClass::Corridor, &[Relation::Static, Relation::Frontal]);
    both.humans[0].side = Some(Side::Left);
    for draw in 0..4 {
        let open = Problem::of(&both, &location, "test".into());
        let (starts, goals) = (vec![node("b0")], vec![node("b6")]);
        let paths = solve(&Problem { draw, starts, goals, ..open }).unwrap().paths;
        let at = |number| {
            let met = paths.encounters.iter().find(|encounter| encounter.human == HumanId::new(number)).unwrap();
            location.graph.node(&met.node).unwrap().at
        };
        assert!((at(1) - at(2)).norm() > 4.0, "{paths:?}");
    }
}
