use super::*;
use crate::geometry::Pose;
use crate::graph::{GraphEdge, GraphNode, SceneGraph};
use crate::grid::{Cell, Grid};
use crate::{Encounter, FORMAT, PlaceClass, RobotProposal, RobotRule, Signature};

fn node(text: &str) -> NodeId {
    NodeId::new(text).unwrap()
}

/// A corridor from west to east with a way across it at `m`, and nodes 2 m and 5 m beside its ends.
fn map() -> Location {
    let at = [
        ("w", -9.0, 0.0),
        ("w_near", -11.0, 0.0),
        ("w_far", -14.0, 0.0),
        ("m", 0.0, 0.0),
        ("m_far", 5.0, 0.0),
        ("e", 9.0, 0.0),
        ("n", 0.0, 6.0),
        ("s", 0.0, -6.0),
    ];
    let nodes: Vec<GraphNode> = at
        .iter()
        .map(|(id, x, y)| GraphNode { id: node(id), kind: "CORRIDOR".into(), at: Point::new(*x, *y) })
        .collect();
    let edges = [("w", "m"), ("m", "m_far"), ("m_far", "e"), ("n", "m"), ("m", "s")].map(|(a, b)| GraphEdge {
        from: node(a),
        to: node(b),
        kind: String::new(),
        via: Vec::new(),
    });
    Location {
        format: FORMAT,
        name: "cross".into(),
        description: String::new(),
        grid: Grid { width: 0, height: 0, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells: Vec::new() },
        graph: SceneGraph::new(nodes, edges.to_vec()),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

fn proposal() -> Proposal {
    let rule = Rule {
        when: vec![Trigger::AfterSecs(5.0)],
        act: Action::LookAtRobot,
        gesture: None,
        for_s: Some(3.0),
        latched: true,
        ..Rule::default()
    };
    Proposal {
        format: FORMAT,
        title: String::new(),
        description: "Words.".into(),
        pattern: "intersection_crossing".into(),
        place: PlaceClass::Intersection,
        humans: vec![HumanProposal {
            id: HumanId::new(1),
            role: "nurse".into(),
            behavior: String::new(),
            relation: Relation::Crossing,
            side: None,
            facing: None,
            rules: vec![rule],
            group: None,
            speed_mps: Some(1.0),
            start: None,
            goal: None,
        }],
        groups: Vec::new(),
        robot: RobotProposal {
            task: String::new(),
            start: None,
            goal: None,
            script: Vec::new(),
            expected_behavior: String::new(),
        },
        expected_events: Vec::new(),
        not_understood: Vec::new(),
        notes: Vec::new(),
        author: Signature::default(),
    }
}

fn paths(robot: &str, human: &str, meet: &str) -> Paths {
    let nodes = |text: &str| text.split(' ').map(node).collect::<Vec<NodeId>>();
    Paths {
        format: FORMAT,
        robot: nodes(robot),
        humans: [(HumanId::new(1), nodes(human))].into(),
        encounters: vec![Encounter { human: HumanId::new(1), node: node(meet) }],
        reasoning: String::new(),
        author: Signature::default(),
    }
}

/// The scenario that the others are compared with.
fn first() -> (Proposal, Paths) {
    (proposal(), paths("w m m_far e", "n m s", "m"))
}

fn repeats(change: impl Fn(&mut Proposal, &mut Paths)) -> bool {
    let (old, old_ways) = first();
    let (mut new, mut ways) = first();
    change(&mut new, &mut ways);
    let (one, other) = (Likeness::of(&old, &old_ways, &map()), Likeness::of(&new, &ways, &map()));
    assert_eq!((one.repeats(&other), one.distance(&other) > 0.0), (other.repeats(&one), other.distance(&one) > 0.0));
    // Whatever differs is some way off.
    assert!(one.repeats(&other) || one.distance(&other) >= 1.0);
    one.repeats(&other)
}

#[test]
fn pace_words_and_the_time_for_which_something_is_done_make_no_difference() {
    assert!(repeats(|_, _| ()));
    assert!(repeats(|new, _| {
        new.humans[0].speed_mps = Some(1.5);
        new.humans[0].rules[0].for_s = Some(9.0);
        new.description = "Entirely other words about the same.".into();
        new.title = "Another".into();
    }));
}

#[test]
fn a_place_makes_a_difference_from_three_meters_on() {
    assert!(repeats(|_, ways| ways.robot[0] = node("w_near")));
    assert!(!repeats(|_, ways| ways.robot[0] = node("w_far")));
    assert!(!repeats(|_, ways| *ways = paths("w m m_far", "n m s", "m")), "the goal is elsewhere");
    assert!(!repeats(|_, ways| *ways = paths("w m m_far e", "n m m_far s", "m_far")), "they meet elsewhere");
}

#[test]
fn side_relation_number_role_and_act_make_a_difference() {
    assert!(!repeats(|_, ways| *ways = paths("w m m_far e", "s m n", "m")), "from the other side");
    assert!(!repeats(|new, _| new.humans[0].relation = Relation::Leaving));
    assert!(!repeats(|new, _| new.humans[0].role = "visitor".into()));
    assert!(!repeats(|new, _| new.humans[0].rules[0].act = Action::StandStill));
    assert!(!repeats(|new, _| new.humans.push(HumanProposal { id: HumanId::new(2), ..new.humans[0].clone() })));
    let line = RobotRule { when: RobotWhen::Start, act: RobotDo::WaitForLeavers };
    assert!(!repeats(|new, _| new.robot.script = vec![line.clone()]));
}

#[test]
fn the_order_of_acts_makes_a_difference_and_numbers_of_people_do_not() {
    let second = |new: &mut Proposal| {
        let mut other = HumanProposal { id: HumanId::new(2), role: "visitor".into(), ..new.humans[0].clone() };
        other.rules.push(Rule { act: Action::GiveWay, ..other.rules[0].clone() });
        new.humans.push(other);
    };
    let likeness = |turned: bool, ids: [u32; 2]| {
        let (mut new, mut ways) = first();
        second(&mut new);
        new.humans[0].id = HumanId::new(ids[0]);
        new.humans[1].id = HumanId::new(ids[1]);
        if turned {
            new.humans[1].rules.reverse();
        }
        let own = ways.humans[&HumanId::new(1)].clone();
        ways.humans = ids.map(|id| (HumanId::new(id), own.clone())).into();
        ways.encounters = [1, 2].map(|id| Encounter { human: HumanId::new(id), node: node("m") }).to_vec();
        Likeness::of(&new, &ways, &map())
    };
    assert!(likeness(false, [1, 2]).repeats(&likeness(false, [2, 1])), "the same people by other numbers");
    assert!(!likeness(false, [1, 2]).repeats(&likeness(true, [1, 2])), "the acts in another order");
}

#[test]
fn a_trigger_makes_a_difference_from_two_seconds_on() {
    let after = |s: f64| repeats(|new, _| new.humans[0].rules[0].when = vec![Trigger::AfterSecs(s)]);
    assert!(after(6.9) && after(3.1) && !after(7.2) && !after(2.5));
    // A robot of 0.8 m/s and a person of 1.2 m/s who comes from its side come 2.9 m nearer to each other in 2 s.
    let likeness = |m: f64| {
        let (mut new, ways) = first();
        new.humans[0].rules[0].when = vec![Trigger::RobotNear(m)];
        Likeness::of(&new, &ways, &map())
    };
    assert!(likeness(2.0).repeats(&likeness(4.6)) && !likeness(2.0).repeats(&likeness(5.3)));
    // They are never farther from each other than 10.8 m.
    assert!(likeness(12.0).repeats(&likeness(30.0)));
}

#[test]
fn a_distance_makes_no_difference_where_a_wall_hides_the_robot() {
    let mut walled = map();
    // A wall of 1 m stands north of the corridor and west of the way across it; the person comes from the north.
    let (width, height) = (40, 20);
    let origin = Pose::new(-10.0, -3.0, 0.0);
    walled.grid = Grid { width, height, resolution_m: 0.5, origin, cells: vec![Cell::Free; width * height] };
    let likeness = |map: &Location, m: f64| {
        let (mut new, ways) = first();
        new.humans[0].rules[0].when = vec![Trigger::RobotVisible(m)];
        Likeness::of(&new, &ways, map)
    };
    assert!(!likeness(&walled, 4.5).repeats(&likeness(&walled, 8.0)));
    for row in 0..height {
        for column in 0..width {
            let at = walled.grid.center_of(column, row);
            if at.y > 1.0 && at.x < -1.0 {
                walled.grid.cells[row * width + column] = Cell::Occupied;
            }
        }
    }
    assert!(likeness(&walled, 4.5).repeats(&likeness(&walled, 8.0)));
}
