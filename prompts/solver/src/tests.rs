//! Whole problems on small maps.

use std::collections::BTreeSet;

use socrates_model::proposal::WayPart;
use socrates_model::{
    Breadth, Clause, ClauseRole, Door, DoorKind, Location, NodeId, PlaceClass, Point, Predicate, Proposal, Relation,
    Side,
};

use crate::testing::{block, corridor, door, map, node, proposal};
use crate::{Layout, Miss, Problem, Solved, impossible, solve};

fn ids(names: &[&str]) -> Vec<NodeId> {
    names.iter().map(|name| node(name)).collect()
}

fn between<'a>(proposal: &'a Proposal, location: &'a Location, start: &str, goal: &str) -> Problem<'a> {
    Problem { starts: ids(&[start]), goals: ids(&[goal]), ..Problem::of(proposal, location, "test".into()) }
}

fn solved(problem: &Problem<'_>) -> Solved {
    solve(problem).unwrap_or_else(|miss| panic!("{miss}"))
}

#[test]
fn between_ends_by_name_the_robot_goes_the_shortest_way_and_people_come_to_it() {
    let location = block("INTERSECTION");
    let shortest = ids(&["b0", "b1", "b2", "b3", "b4", "b5", "b6"]);
    for (place, relation) in [
        (PlaceClass::Corridor, Relation::Frontal),
        (PlaceClass::Corridor, Relation::Behind),
        (PlaceClass::Corridor, Relation::Ahead),
        (PlaceClass::Corridor, Relation::Static),
        (PlaceClass::Intersection, Relation::Crossing),
        (PlaceClass::Intersection, Relation::Frontal),
    ] {
        let proposal = proposal(place, &[relation]);
        for draw in 0..5 {
            let paths = solved(&Problem { draw, ..between(&proposal, &location, "b0", "b6") }).paths;
            assert_eq!(paths.robot, shortest, "{relation:?}");
            assert!(paths.encounters.iter().all(|encounter| shortest.contains(&encounter.node)), "{paths:?}");
            assert!(!paths.reasoning.contains('%'), "{}", paths.reasoning);
        }
    }
}

#[test]
fn a_way_that_is_longer_than_the_shortest_says_why() {
    let location = block("CORRIDOR");
    let mut proposal = proposal(PlaceClass::BlindCorner, &[Relation::Frontal]);
    let mut location = location;
    location.graph = location.graph.edited(|nodes, _| {
        for corner in nodes.iter_mut().filter(|corner| corner.id.as_str() == "t3") {
            corner.kind = "BLIND_CORNER".into();
        }
    });
    let paths = solved(&between(&proposal, &location, "b0", "b6")).paths;
    assert!(paths.robot.contains(&node("t3")), "{:?}", paths.robot);
    assert!(paths.reasoning.contains("% more than the 24.0 m of the shortest way"), "{}", paths.reasoning);
    assert!(paths.reasoning.contains("does not lead over a blind corner"), "{}", paths.reasoning);
    // Without ends by name there is no reason for a detour.
    proposal.place = PlaceClass::Corridor;
    for draw in 0..20 {
        let open = Problem { draw, ..Problem::of(&proposal, &location, "test".into()) };
        let robot = solved(&open).paths.robot;
        let shortest = location.graph.shortest(robot.first().unwrap(), robot.last().unwrap()).unwrap();
        assert!(location.graph.length_m(&robot) <= 1.2 * location.graph.length_m(&shortest), "{robot:?}");
    }
}

#[test]
fn alternatives_differ_and_the_draw_picks_among_them() {
    let location = block("INTERSECTION");
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let all = solved(&Problem::of(&proposal, &location, "test".into())).alternatives;
    assert!(all.len() > 5, "{}", all.len());
    let at = |id: &NodeId| location.graph.node(id).unwrap().at;
    for (i, one) in all.iter().enumerate() {
        for other in all.iter().take(i) {
            let ends = |paths: &socrates_model::Paths| {
                [paths.robot.first(), paths.robot.last(), paths.encounters.first().map(|met| &met.node)]
                    .map(|id| at(id.unwrap()))
            };
            let apart_m = ends(one).iter().zip(ends(other)).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            assert!(apart_m > 3.0, "{one:?} {other:?}");
        }
    }
    let drawn: BTreeSet<String> = (0..all.len() as u64)
        .map(|draw| {
            format!("{:?}", solved(&Problem { draw, ..Problem::of(&proposal, &location, "test".into()) }).paths.robot)
        })
        .collect();
    assert!(drawn.len() > 3);
    let again = solved(&Problem::of(&proposal, &location, "test".into()));
    assert_eq!(again.alternatives, all);
}

fn miss(problem: &Problem<'_>) -> Miss {
    match solve(problem) {
        Err(miss) => miss,
        Ok(solved) => panic!("{:?}", solved.paths),
    }
}

#[test]
fn start_and_goal_in_one_place_and_islands_are_named() {
    let mut location = block("CORRIDOR");
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let at = Point::new(6.0, 6.0);
    assert_eq!(miss(&between(&proposal, &location, "b1", "b1")), Miss::OnePlace { node: node("b1"), at });
    // A place of two nodes beside each other, which the task names twice.
    let both = || ids(&["b1", "b2"]);
    let twice = Problem { starts: both(), goals: both(), ..Problem::of(&proposal, &location, "test".into()) };
    assert_eq!(miss(&twice), Miss::OnePlace { node: node("b1"), at });
    location.graph = location.graph.edited(|_, edges| {
        edges.retain(|edge| !["b0", "b6"].contains(&edge.from.as_str()) && edge.to.as_str() != "b6")
    });
    let apart = miss(&between(&proposal, &location, "b5", "t6"));
    assert_eq!(apart, Miss::Apart { from: node("b5"), to: node("t6"), nodes: [6, 10] });
    assert!(apart.to_string().contains("`b5`") && apart.to_string().contains("`t6`"));
}

#[test]
fn a_way_that_is_narrower_than_the_robot_and_a_node_in_a_wall_are_named_with_their_width() {
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let location = corridor(0.3);
    let Miss::Narrow { has_m, needs_m, .. } = miss(&between(&proposal, &location, "c0", "c6")) else { panic!() };
    assert!((0.2..0.4).contains(&has_m) && (needs_m - 0.5).abs() < 1e-9, "{has_m} {needs_m}");
    assert!(matches!(miss(&Problem::of(&proposal, &location, "test".into())), Miss::Narrow { .. }));
    assert!(solve(&between(&proposal, &corridor(2.0), "c0", "c6")).is_ok());
    let mut walled = corridor(2.0);
    walled.graph = walled.graph.edited(|nodes, _| {
        for wall in nodes.iter_mut().filter(|wall| wall.id.as_str() == "c3") {
            wall.at.y = 5.5;
        }
    });
    let Miss::Narrow { has_m, between: [a, b], .. } = miss(&between(&proposal, &walled, "c0", "c6")) else { panic!() };
    assert!(has_m < 1e-9 && [a, b].contains(&node("c3")));
}

#[test]
fn nobody_is_met_where_only_the_robot_gets_through_unless_its_task_leads_there() {
    // Two corridors between the same ends: the shorter one has a gap of 0.6 m.
    let nodes = [
        ("a", "CORRIDOR", 2.0, 3.0),
        ("g", "CORRIDOR", 8.0, 3.0),
        ("b", "CORRIDOR", 14.0, 3.0),
        ("c", "CORRIDOR", 2.0, 7.0),
        ("d", "CORRIDOR", 14.0, 7.0),
    ];
    let edges = [("a", "g"), ("g", "b"), ("a", "c"), ("c", "d"), ("d", "b")];
    let floor = [
        [1.0, 2.0, 6.0, 2.0],
        [7.0, 2.7, 2.0, 0.6],
        [9.0, 2.0, 6.0, 2.0],
        [1.0, 2.0, 2.0, 6.0],
        [13.0, 2.0, 2.0, 6.0],
        [1.0, 6.0, 14.0, 2.0],
    ];
    let both = map([16.0, 9.0], &floor, &nodes, &edges);
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let around = ids(&["a", "c", "d", "b"]);
    assert_eq!(solved(&between(&proposal, &both, "a", "b")).paths.robot, around);
    // The robot of 0.5 m gets through where its task leads there.
    let narrow = map([16.0, 9.0], &floor[..3], &nodes[..3], &edges[..2]);
    assert!(impossible(&between(&proposal, &narrow, "a", "b")).is_none());
    // Somebody who comes out of a room behind such a gap does not.
    let mut closet = with_room(1.6);
    closet.grid =
        map([28.0, 8.0], &[[0.5, 2.0, 27.0, 2.0], [13.7, 4.0, 0.6, 0.3], [13.4, 4.3, 1.2, 1.3]], &[], &[]).grid;
    closet.doors = vec![closet_door(serde_json::json!({ "near": 1.5 }))];
    let leaving = self::proposal(PlaceClass::Corridor, &[Relation::Leaving]);
    let why = solve(&Problem::of(&leaving, &closet, "test".into())).unwrap_err();
    assert!(matches!(why, Miss::Narrow { people: true, .. }), "{why}");
    assert!(why.to_string().starts_with("people need 0.64 m, and the way from `in` to `c3` has 0.6"), "{why}");
}

#[test]
fn a_door_that_never_opens_closes_the_way() {
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let mut location = corridor(2.0);
    location.doors = vec![door(serde_json::json!({
        "id": "gate", "kind": DoorKind::Room, "from": [12.0, 2.0], "to": [12.0, 4.0], "opens": "never"
    }))];
    assert_eq!(
        miss(&between(&proposal, &location, "c0", "c6")),
        Miss::Shut { from: node("c0"), to: node("c6"), door: "gate".into(), at: Point::new(12.0, 3.0) }
    );
}

/// A corridor of 28 m by 2 m with a room on its upper side, 1.2 m wide and so deep, m.
fn with_room(deep_m: f64) -> Location {
    let mut nodes = vec![("in", "ROOM", 14.0, 5.0)];
    let names: Vec<String> = (0..7).map(|k| format!("c{k}")).collect();
    nodes.extend(names.iter().enumerate().map(|(k, id)| (id.as_str(), "CORRIDOR", 2.0 + 4.0 * k as f64, 3.0)));
    let mut edges: Vec<(&str, &str)> = names.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect();
    edges.push(("c3", "in"));
    map([28.0, 8.0], &[[0.5, 2.0, 27.0, 2.0], [13.4, 4.0, 1.2, deep_m]], &nodes, &edges)
}

fn closet_door(opens: serde_json::Value) -> Door {
    door(serde_json::json!({
        "id": "closet", "kind": DoorKind::Room, "from": [13.4, 4.1], "to": [14.6, 4.1], "opens": opens, "inside": ["in"]
    }))
}

#[test]
fn nobody_comes_out_of_a_room_whose_door_never_opens_or_that_has_no_opening() {
    let leaving = proposal(PlaceClass::Corridor, &[Relation::Leaving]);
    let found = |location: &Location| solve(&Problem::of(&leaving, location, "test".into()));
    let mut location = with_room(1.6);
    location.doors = vec![closet_door("never".into())];
    let shut = Miss::Shut { from: node("in"), to: node("c3"), door: "closet".into(), at: Point::new(14.0, 4.1) };
    assert_eq!(found(&location), Err(shut));
    // An alcove: its walls begin farther from its node than an opening is wide.
    let mut alcove = with_room(1.6);
    alcove.graph = alcove.graph.edited(|nodes, _| {
        for inner in nodes.iter_mut().filter(|inner| inner.id.as_str() == "in") {
            inner.at = Point::new(14.0, 3.6);
        }
    });
    let why = found(&alcove);
    assert!(matches!(&why, Ok(_) | Err(Miss::OpenPlan { .. })), "{why:?}");
    let mut bay = corridor(5.0);
    bay.graph = bay.graph.edited(|nodes, _| nodes[3].kind = "ROOM".into());
    let open = found(&bay).unwrap_err();
    assert!(matches!(&open, Miss::OpenPlan { node: room, .. } if *room == node("c3")), "{open}");
    assert!(open.to_string().contains("(14.00, 3.00)"), "{open}");
    let none = found(&corridor(2.0)).unwrap_err();
    assert_eq!(none, Miss::NoPlace(PlaceClass::Room));
}

#[test]
fn what_is_impossible_whatever_is_drawn_is_known_without_a_search() {
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    assert_eq!(impossible(&between(&proposal, &corridor(2.0), "c0", "c6")), None);
    assert!(matches!(impossible(&between(&proposal, &corridor(0.3), "c0", "c6")), Some(Miss::Narrow { .. })));
    let one = map([6.0, 6.0], &[[0.5, 0.5, 5.0, 5.0]], &[("a", "CORRIDOR", 3.0, 3.0)], &[]);
    assert!(matches!(impossible(&Problem::of(&proposal, &one, "test".into())), Some(Miss::Short { .. })));
}

#[test]
fn a_map_of_one_node_or_none_is_too_short() {
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    for nodes in [&[][..], &[("a", "CORRIDOR", 3.0, 3.0)][..]] {
        let location = map([6.0, 6.0], &[[0.5, 0.5, 5.0, 5.0]], nodes, &[]);
        let found = miss(&Problem::of(&proposal, &location, "test".into()));
        assert!(matches!(found, Miss::Short { has_m: 0.0, needs_m: 6.0, .. }), "{found:?}");
    }
}

#[test]
fn ten_people_do_not_come_out_of_a_closet() {
    let mut location = with_room(1.6);
    location.doors = vec![closet_door(serde_json::json!({ "near": 1.5 }))];
    let ten = proposal(PlaceClass::Corridor, &[Relation::Leaving; 10]);
    let Miss::Full { node: room, has_m2, people, needs_m2 } = miss(&Problem::of(&ten, &location, "test".into())) else {
        panic!()
    };
    assert_eq!((room, people), (node("in"), 10));
    assert!(has_m2 < 2.0 && needs_m2 > 4.0, "{has_m2} {needs_m2}");
    assert!(
        solve(&Problem::of(&proposal(PlaceClass::Corridor, &[Relation::Leaving]), &location, "test".into())).is_ok()
    );
}

#[test]
fn a_width_that_no_place_has_is_named_with_the_nearest() {
    let proposal = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    let location = corridor(1.4);
    let wide = Layout { width_m: Some([1.9, 99.0]), ..Layout::default() };
    let problem = Problem { layout: wide, ..Problem::of(&proposal, &location, "test".into()) };
    let Miss::Width { has_m, needs_m: [least_m, _], .. } = miss(&problem) else { panic!() };
    assert!((has_m - 1.4).abs() < 0.15 && least_m > 1.8, "{has_m}");
    let four = Layout { arms: Some(4), ..Layout::default() };
    let problem = Problem { layout: four, ..Problem::of(&proposal, &location, "test".into()) };
    assert!(matches!(miss(&problem), Miss::Arms { has: 2, needs: 4, .. }));
}

#[test]
fn a_graph_of_two_thousand_nodes_is_solved() {
    let names: Vec<String> = (0..2000).map(|k| format!("n{k}")).collect();
    let at = |k: usize| (1.0 + (k % 50) as f64, 1.0 + (k / 50) as f64);
    let nodes: Vec<(&str, &str, f64, f64)> =
        names.iter().enumerate().map(|(k, id)| (id.as_str(), "OPEN_AREA", at(k).0, at(k).1)).collect();
    let mut edges: Vec<(&str, &str)> = Vec::new();
    for k in 0..2000 {
        if k % 50 != 49 {
            edges.push((&names[k], &names[k + 1]));
        }
        if k + 50 < 2000 {
            edges.push((&names[k], &names[k + 50]));
        }
    }
    let location = map([52.0, 42.0], &[[0.2, 0.2, 51.6, 41.6]], &nodes, &edges);
    let proposal = proposal(PlaceClass::OpenArea, &[Relation::Frontal, Relation::Crossing, Relation::Static]);
    assert_eq!(solved(&Problem::of(&proposal, &location, "test".into())).paths.humans.len(), 3);
    let proposal = self::proposal(PlaceClass::Exit, &[Relation::Frontal]);
    assert_eq!(miss(&Problem::of(&proposal, &location, "test".into())), Miss::NoPlace(PlaceClass::Exit));
}

#[test]
fn a_wide_search_leads_people_from_more_sides_and_plays_in_more_places() {
    let location = block("INTERSECTION");
    let proposal = proposal(PlaceClass::Intersection, &[Relation::Crossing]);
    let drawn = |problem: &Problem<'_>, breadth: Breadth| -> (BTreeSet<String>, BTreeSet<String>) {
        let of = |draw: u64| {
            let paths = solved(&Problem { draw, breadth, ..problem.clone() }).paths;
            let own = paths.humans.values().next().unwrap();
            let at = own.iter().position(|node| *node == paths.encounters[0].node).unwrap();
            (own[at - 1].to_string(), format!("{:?}", paths.robot))
        };
        (0..80).map(of).unzip()
    };
    // The lower way has one arm of its own, downwards; from where the robot goes to people come and turn into it.
    let named = between(&proposal, &location, "b0", "b6");
    let sides = |breadth| drawn(&named, breadth).0;
    assert_eq!(sides(Breadth::Usual), BTreeSet::from(["d".to_owned()]));
    assert_eq!(sides(Breadth::Wide), BTreeSet::from(["b4".to_owned(), "d".to_owned()]));
    let open = Problem::of(&proposal, &location, "test".into());
    let ways = |breadth| drawn(&open, breadth).1.len();
    assert!(ways(Breadth::Wide) > ways(Breadth::Usual), "{} {}", ways(Breadth::Wide), ways(Breadth::Usual));
}

#[test]
fn who_crosses_comes_from_the_side_that_is_asked_for_or_there_is_no_way() {
    let location = block("INTERSECTION");
    let at = |id: &NodeId| location.graph.node(id).map(|node| node.at).unwrap();
    for side in [Side::Left, Side::Right] {
        let mut proposal = proposal(PlaceClass::Intersection, &[Relation::Crossing]);
        proposal.humans[0].side = Some(side);
        for draw in 0..10 {
            let paths = solved(&Problem { draw, ..Problem::of(&proposal, &location, "test".into()) }).paths;
            let meet = &paths.encounters[0].node;
            let before = |way: &[NodeId]| {
                let index = way.iter().position(|node| node == meet).unwrap();
                at(&way[index - 1])
            };
            let own = paths.humans.values().next().unwrap();
            let left_m = (at(meet) - before(&paths.robot)).perp(&(before(own) - at(meet)));
            assert!(side.sign() * left_m > 0.5, "{side:?}: {paths:?}");
        }
    }
    // Between these ends the only place of that kind has its third way on one side.
    let mut asked = proposal(PlaceClass::Intersection, &[Relation::Crossing]);
    let sided: Vec<Result<Solved, Miss>> = [Side::Left, Side::Right]
        .into_iter()
        .map(|side| {
            asked.humans[0].side = Some(side);
            solve(&between(&asked, &location, "b0", "b6"))
        })
        .collect();
    for found in sided {
        if let Err(miss) = found {
            let Miss::Side { .. } = miss else { panic!("{miss}") };
            assert!(miss.to_string().contains("human_1 (`crossing`, `"), "{miss}");
        }
    }
}

#[test]
fn a_corridor_too_narrow_for_a_side_is_refused_with_the_side() {
    for (width_m, fits) in [(2.0, true), (1.3, false)] {
        let location = corridor(width_m);
        let mut proposal = proposal(PlaceClass::Corridor, &[Relation::Static]);
        proposal.humans[0].side = Some(Side::Left);
        let problem = Problem::of(&proposal, &location, "test".into());
        let miss = impossible(&problem).map(|miss| miss.to_string());
        assert_eq!(miss.is_none(), fits, "{width_m}: {miss:?}");
        assert!(miss.is_none_or(|miss| miss.contains("human_1 (`static`, `left`)")));
    }
}

#[test]
fn the_way_leads_past_a_place_by_name_and_keeps_out_of_another_or_is_refused() {
    let location = block("CORRIDOR");
    let clause = |part, name: &str| Clause {
        id: "c1".into(),
        text: "by name".into(),
        role: ClauseRole::Setup,
        must: true,
        source: String::new(),
        predicate: Predicate::RobotWay { part, nodes: ids(&[name]) },
    };
    let mut asked = proposal(PlaceClass::Corridor, &[Relation::Frontal]);
    asked.expected_events = vec![clause(WayPart::Via, "t3")];
    let past = solved(&between(&asked, &location, "b0", "b6")).paths.robot;
    assert!(past.contains(&node("t3")), "{past:?}");
    asked.expected_events = vec![clause(WayPart::Avoid, "b3")];
    let round = solved(&between(&asked, &location, "b0", "b6")).paths.robot;
    assert!(!round.contains(&node("b3")) && round.contains(&node("t3")), "{round:?}");
    asked.expected_events = vec![clause(WayPart::Avoid, "b6"), clause(WayPart::Goal, "b6")];
    let problem = between(&asked, &location, "b0", "b6");
    let miss = impossible(&problem).or_else(|| solve(&problem).err()).map(|miss| miss.to_string()).unwrap();
    assert!(miss.contains("`b6`"), "{miss}");
}
