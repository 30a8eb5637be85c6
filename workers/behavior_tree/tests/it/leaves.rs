//! Leaves that the world ticks in its own meaning, and the libraries they come from.

use std::collections::BTreeMap;

use crate::common::Room;
use socrates_bt::{Kind, LeafCall, Library, Meaning, Options, Status, Tree, World, nodes};
use socrates_model::{Action, FaultCode, Gesture, HumanId, SimTime};

/// A world that ticks every leaf itself, and keeps what it was told.
#[derive(Default)]
struct Upstream {
    told: Vec<String>,
    runs: bool,
}

impl World for Upstream {
    fn robot_distance_m(&self) -> Option<f64> {
        None
    }
    fn robot_visible(&self, _within_m: f64) -> bool {
        false
    }
    fn robot_blocking(&self, _within_m: f64) -> bool {
        false
    }
    fn robot_moving(&self) -> bool {
        false
    }
    fn robot_gesture(&self) -> Option<Gesture> {
        None
    }
    fn human_gesture(&self, _id: HumanId) -> Option<Gesture> {
        None
    }
    fn goal_reached(&self) -> bool {
        false
    }
    fn next_goal(&mut self) {}
    fn at_encounter(&self) -> bool {
        false
    }
    fn now(&self) -> SimTime {
        SimTime::ZERO
    }
    fn step_s(&self) -> f64 {
        0.01
    }
    fn act(&mut self, _action: &Action, _leaf: u16) {
        self.told.push("native".to_owned());
    }
    fn gesture(&mut self, _gesture: Option<Gesture>) {}
    fn leaf(&mut self, call: &mut LeafCall<'_>) -> Option<Status> {
        let ports: Vec<String> = (0..call.sheet().ports.len())
            .map(|port| call.text(port).map_or_else(|| "-".to_owned(), Into::into))
            .collect();
        self.told.push(format!("{} {} {} {}", call.leaf(), call.tag(), ports.join(","), call.is_running()));
        match call.tag() {
            "FindNearestAgent" => {
                assert!(call.set(1, 7_u32));
                Some(Status::Success)
            }
            "FollowAgent" => {
                assert_eq!(call.int(1), Some(7));
                assert_eq!(call.real(5), Some(0.0));
                Some(if self.runs { Status::Running } else { Status::Success })
            }
            "RegularNav" => None,
            _ => Some(Status::Failure),
        }
    }
    fn leaf_halted(&mut self, call: &mut LeafCall<'_>) {
        self.told.push(format!("halted {}", call.tag()));
    }
}

fn document(format: &str, body: &str) -> String {
    format!("<root {format} main_tree_to_execute='T'><BehaviorTree ID='T'>{body}</BehaviorTree></root>")
}

fn upstream(library: Library) -> Options<'static> {
    Options { library, meaning: Meaning::World, ..Options::default() }
}

#[test]
fn a_world_ticks_leaves_in_its_own_meaning() {
    let xml = document(
        "BTCPP_format='4'",
        "<ReactiveFallback name='f'><IsRobotVisible agent_id='{id}'/><Sequence name='s'>\
         <FindNearestAgent agent_id='{id}' target_agent_id='{who}'/>\
         <FollowAgent agent_id='{id}' time_step='0.1' target_agent_id='{who}'/></Sequence>\
         <RegularNav agent_id='{id}'/></ReactiveFallback>",
    );
    let tree = Tree::parse_with(&xml, &upstream(Library::HunavSim2)).unwrap();
    assert_eq!(tree.world_leaves(), [2, 3]);
    let mut state = tree.start_with(&BTreeMap::from([("id".to_owned(), "3".to_owned())]));
    let mut world = Upstream { runs: true, ..Upstream::default() };
    assert_eq!(tree.tick(&mut state, &mut world), Status::Running);
    assert_eq!(tree.tick(&mut state, &mut world), Status::Running);
    world.runs = false;
    assert_eq!(tree.tick(&mut state, &mut world), Status::Success);
    let follow = "3 FollowAgent 3,7,0.1,1.5,1.5,0";
    assert_eq!(
        world.told,
        [
            "1 IsRobotVisible 3,5.0 false".to_owned(),
            "2 FindNearestAgent 3,- false".to_owned(),
            format!("{follow} false"),
            "1 IsRobotVisible 3,5.0 false".to_owned(),
            format!("{follow} true"),
            "1 IsRobotVisible 3,5.0 false".to_owned(),
            format!("{follow} true"),
        ]
    );
    assert_eq!(state.unanswered(), None);
}

#[test]
fn a_running_leaf_is_told_that_it_is_stopped_and_no_answer_means_the_native_meaning() {
    let xml = document(
        "BTCPP_format='4'",
        "<Fallback name='f'><Parallel name='p' success_count='2' failure_count='1'>\
         <FollowAgent agent_id='1' time_step='0.1' target_agent_id='7'/>\
         <RegularNav agent_id='1'/><IsRobotVisible agent_id='1'/></Parallel></Fallback>",
    );
    let tree = Tree::parse_with(&xml, &upstream(Library::HunavSim2)).unwrap();
    let mut world = Upstream { runs: true, ..Upstream::default() };
    assert_eq!(tree.tick(&mut tree.start(), &mut world), Status::Failure);
    assert_eq!(
        world.told,
        [
            "1 FollowAgent 1,7,0.1,1.5,1.5,0 false",
            "2 RegularNav 1,0.1 false",
            "native",
            "3 IsRobotVisible 1,5.0 false",
            "halted FollowAgent"
        ]
    );
}

#[test]
fn a_leaf_that_nobody_ticks_fails_and_is_named() {
    let xml = document("BTCPP_format='4'", "<SetGoal agent_id='{id}' goal_id='2'/>");
    let tree = Tree::parse_with(&xml, &upstream(Library::HunavSim2)).unwrap();
    let mut state = tree.start();
    assert_eq!(tree.tick(&mut state, &mut Room::default()), Status::Failure);
    assert_eq!(state.unanswered(), Some(1));
}

#[test]
fn a_native_run_refuses_by_name_what_has_no_plain_meaning() {
    for sheet in nodes::known_to(Library::HunavSim2) {
        if !matches!(sheet.kind, Kind::Action | Kind::Condition) || sheet.library == Library::BuiltIn {
            continue;
        }
        let ports: String = sheet
            .ports
            .iter()
            .filter(|port| port.default.is_none())
            .map(|port| format!(" {}='{}'", port.name, if port.name.ends_with("_id") { "1" } else { "2" }))
            .collect();
        let xml = document("BTCPP_format='4'", &format!("\n<{}{ports}/>", sheet.tag));
        let native = Options { library: Library::HunavSim2, ..Options::default() };
        let read = Tree::parse_with(&xml, &native);
        assert_eq!(read.is_ok(), sheet.is_native(), "{}", sheet.tag);
        if let Err(faults) = read {
            assert_eq!(faults[0].code, FaultCode::BNode);
            assert!(faults[0].at.to_string().starts_with("2:1"), "{}", faults[0]);
            assert!(
                faults[0].message.to_string().contains(sheet.tag) && faults[0].message.to_string().contains("allowed"),
                "{}",
                faults[0]
            );
        }
        let world = Tree::parse_with(&xml, &upstream(Library::HunavSim2));
        assert!(world.is_ok(), "{}: {world:?}", sheet.tag);
    }
}

#[test]
fn the_native_wait_stands_still_for_its_time_and_a_delay_lets_its_child_wait() {
    let xml = document("BTCPP_format='4'", "<StopAndWaitTimerAction agent_id='1' wait_duration='0.05'/>");
    let options = Options { library: Library::HunavSim2, ..Options::default() };
    let tree = Tree::parse_with(&xml, &options).unwrap();
    let (mut state, mut room) = (tree.start(), Room::default());
    let stood = (0..5).filter(|_| room.tick(&tree, &mut state) == [Action::StandStill]).count();
    assert_eq!(stood, 5);
    assert!(room.tick(&tree, &mut state).is_empty());
    let xml = document("BTCPP_format='4'", "<TimeDelay delay='0.03'><RegularNav agent_id='1'/></TimeDelay>");
    let tree = Tree::parse_with(&xml, &options).unwrap();
    let (mut state, mut room) = (tree.start(), Room::default());
    let walked: Vec<bool> = (0..5).map(|_| !room.tick(&tree, &mut state).is_empty()).collect();
    assert_eq!(walked, [false, false, false, true, false]);
}

#[test]
fn each_library_has_its_own_ports() {
    let curious = "<CuriousNav agent_id='2' time_step='{dt}' stop_distance='1' agent_vel='0.8'/>";
    let of = |library| Tree::parse_with(&document("", curious), &upstream(library)).map(|_| ());
    assert!(of(Library::HunavSim1_1).is_ok());
    let faults = of(Library::HunavSim1_0).unwrap_err();
    assert!(faults.iter().all(|fault| fault.code == FaultCode::BPort), "{faults:?}");
    let faults = of(Library::Native).unwrap_err();
    assert!(faults[0].message.to_string().contains("hunav-1.0, hunav-1.1, hunav-2.0"), "{}", faults[0]);
    let seen = "<IsRobotVisible agent_id='3' distance='99'/>";
    assert!(Tree::parse_with(&document("", seen), &upstream(Library::HunavSim1_0)).is_ok());
    assert!(Tree::parse(&document("", seen)).is_err());
}

#[test]
fn the_fork_counts_people_from_zero_and_we_from_one() {
    let xml = r#"<root main_tree_to_execute="M"><BehaviorTree ID="M">
  <FollowHuman agent_id="{id}" target_id="0" time_step="{dt}"/></BehaviorTree></root>"#;
    assert!(Tree::parse_with(xml, &upstream(Library::SocratesFork)).is_ok());
    let faults = Tree::parse(xml).unwrap_err();
    assert!(faults[0].to_string().contains("target_id"), "{}", faults[0]);
}
