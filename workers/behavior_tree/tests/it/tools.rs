//! Drawing, converting and the tick analysis.

use std::collections::BTreeMap;

use crate::common::Room;
use socrates_bt::{
    Analysis, Cover, Format, Library, Meaning, Options, Tree, analyze, check_report, convert, draw_svg, draw_text,
};
use socrates_model::{Action, FaultCode};

const WALK: &str = "<Sequence name='walk'><SetBlackboard output_key='agentid' value='{id}'/>\
    <SetBlackboard output_key='timestep' value='{dt}'/><SubTree ID='RegularNavTree' id='agentid' dt='timestep'/></Sequence>";
const SEEN: &str = "<IsRobotVisible agent_id='{id}' distance='5'/>";
const LOOK: &str = "<LookAtRobot agent_id='{id}'/>";
const FOLLOW: &str = "<FollowRobot agent_id='{id}' time_step='{dt}'/>";

fn document(format: &str, body: &str) -> String {
    format!(
        "<root {format} main_tree_to_execute='T'><include path='BTRegularNav.xml'/><BehaviorTree ID='T'>{body}</BehaviorTree></root>"
    )
}

fn tree(body: &str) -> Tree {
    Tree::parse(&document("", body)).unwrap_or_else(|faults| panic!("{faults:#?}"))
}

fn analysis(body: &str) -> Analysis {
    analyze(&tree(body))
}

fn says(code: u8) -> String {
    format!("<MakeGesture agent_id='{{id}}' message='{code}'/>")
}

#[test]
fn a_text_drawing_has_a_line_for_every_node() {
    let body = format!("<Fallback name='f'><Sequence name='s'>{SEEN}{LOOK}</Sequence>{WALK}</Fallback>");
    let drawn = draw_text(&tree(&body));
    let expected = "T (v3, 17 nodes)
└─ Fallback `f`
   ├─ Sequence `s`
   │  ├─ IsRobotVisible agent_id={id} distance=5
   │  └─ LookAtRobot agent_id={id}
   └─ Sequence `walk`
      ├─ SetBlackboard output_key=agentid value={id}
      ├─ SetBlackboard output_key=timestep value={dt}
      └─ SubTree ID=RegularNavTree id=agentid dt=timestep
         └─ Fallback `RegularNavFallback`
            ├─ Sequence `RegularNavigation`
            │  ├─ Inverter
            │  │  └─ IsGoalReached agent_id={id}
            │  └─ RegularNav agent_id={id} time_step={dt}
            └─ UpdateGoal agent_id={id}
";
    assert_eq!(drawn, expected.replace("17 nodes", "14 nodes"));
}

/// Boxes of a drawing: left, top, width, height.
fn boxes(svg: &str) -> Vec<[f64; 4]> {
    let number = |text: &str, name: &str| -> f64 {
        let from = text.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
        text[from..].split('"').next().unwrap().parse().unwrap()
    };
    svg.split("</title><rect")
        .skip(1)
        .map(|part| ["x", "y", "width", "height"].map(|name| number(part, name)))
        .collect()
}

#[test]
fn no_two_boxes_of_a_drawing_overlap_and_all_are_on_the_page() {
    let long =
        "<Script code=\"a := 1; b := 2; c := 'a text that is far too long to be written in one box of a drawing'\"/>";
    let many: String =
        (0..40).map(|k| format!("<Sequence name='s{k}'>{SEEN}<Inverter>{SEEN}</Inverter>{long}</Sequence>")).collect();
    let wide =
        "<Parallel name='p' success_count='1' failure_count='1'><Inverter><AlwaysSuccess/></Inverter></Parallel>";
    let body = format!("<Fallback name='a &lt;name&gt; &amp; more'>{many}{wide}</Fallback>");
    let tree = Tree::parse(&document("BTCPP_format='4'", &body)).unwrap();
    let svg = draw_svg(&tree);
    let boxes = boxes(&svg);
    assert_eq!(boxes.len(), tree.node_names().len());
    for (place, a) in boxes.iter().enumerate() {
        for b in &boxes[..place] {
            let apart = a[0] >= b[0] + b[2] || b[0] >= a[0] + a[2] || a[1] >= b[1] + b[3] || b[1] >= a[1] + a[3];
            assert!(apart, "{a:?} {b:?}");
        }
    }
    let size = svg.split("viewBox=\"0 0 ").nth(1).unwrap().split('"').next().unwrap();
    let size: Vec<f64> = size.split(' ').map(|text| text.parse().unwrap()).collect();
    assert!(boxes.iter().all(|a| a[0] >= 0.0 && a[1] >= 0.0 && a[0] + a[2] <= size[0] && a[1] + a[3] <= size[1]));
    assert!(svg.contains("a &lt;name&gt; &amp; more") && svg.contains('…') && !svg.contains("<name>"));
}

#[test]
fn version_3_becomes_version_4_and_back_and_does_the_same() {
    let body = format!(
        "<Fallback name='f'><SequenceStar name='m'>{SEEN}{LOOK}</SequenceStar>\
         <Parallel name='p' success_threshold='1' failure_threshold='2'><RobotMoved agent_id='{{id}}'/>{SEEN}</Parallel>\
         <Repeat num_cycles='2'>{SEEN}</Repeat>{WALK}</Fallback>"
    );
    let tree = tree(&body);
    let (v4, notes) = convert(&tree, Format::V4, Library::Native);
    for wanted in ["BTCPP_format=\"4\"", "<SequenceWithMemory", "success_count=\"1\"", "id=\"{agentid}\""] {
        assert!(v4.contains(wanted), "{wanted} in {v4}");
    }
    let about = |tag: &str| notes.iter().filter(|note| note.at.contains(tag)).count();
    assert!(about("Sequence") >= 2 && about("Parallel") == 1 && about("Repeat") == 1 && about("SubTree") == 1);
    assert!(notes.iter().any(|note| note.changes_meaning && note.message.contains("RUNNING")), "{notes:#?}");
    let read = Tree::parse(&v4).unwrap();
    assert_eq!(read.format(), Format::V4);
    let (v3, _) = convert(&read, Format::V3, Library::Native);
    for wanted in ["<SequenceStar", "success_threshold=\"1\"", "<SubTreePlus", "id=\"{agentid}\""] {
        assert!(v3.contains(wanted), "{wanted} in {v3}");
    }
    let back = Tree::parse(&v3).unwrap();
    let (mut a, mut b) = (tree.start(), back.start());
    for tick in 0..200_u32 {
        let room = || Room {
            distance_m: Some(3.0),
            visible: tick % 7 > 2,
            moving: tick % 3 == 0,
            at_goal: tick % 50 == 0,
            ..Room::default()
        };
        assert_eq!(room().tick(&tree, &mut a), room().tick(&back, &mut b), "tick {tick}");
    }
}

#[test]
fn nothing_is_noted_where_nothing_changes() {
    let body = format!("<Fallback name='f'><Sequence name='s'>{SEEN}{LOOK}</Sequence></Fallback>");
    let (xml, notes) = convert(&tree(&body), Format::V3, Library::SocratesFork);
    assert_eq!(notes, []);
    assert!(Tree::parse(&xml).is_ok());
}

#[test]
fn nodes_of_another_library_are_renamed_left_out_or_named() {
    let body = format!(
        "<Fallback name='f'>{LOOK}<GiveWaytoRobot agent_id='{{id}}' time_step='{{dt}}'/>\
         <ApproachRobot agent_id='{{id}}' time_step='{{dt}}'/></Fallback>"
    );
    let (xml, notes) = convert(&tree(&body), Format::V3, Library::HunavSim1_0);
    assert!(xml.contains("<SurprisedNav") && xml.contains("<CuriousNav") && xml.contains("<GiveWaytoRobot"), "{xml}");
    let told: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("no node `GiveWaytoRobot`")), "{told:#?}");
    assert!(told.iter().any(|text| text.contains("calls `LookAtRobot` `SurprisedNav`")), "{told:#?}");
    let curious = document("", "<CuriousNav agent_id='{id}' time_step='{dt}' stop_distance='1' agent_vel='1'/>");
    let read = Tree::parse_with(&curious, &Options { library: Library::HunavSim1_1, ..Options::default() }).unwrap();
    let (xml, notes) = convert(&read, Format::V3, Library::HunavSim1_0);
    assert!(!xml.contains("stop_distance") && notes.len() == 2, "{xml} {notes:#?}");
}

#[test]
fn attributes_that_version_3_lacks_are_left_out_and_noted() {
    let v4 = document(
        "BTCPP_format='4'",
        "<Sequence name='s'><AlwaysSuccess _skipIf='x == 1'/><RunOnce><AlwaysSuccess/></RunOnce></Sequence>",
    );
    let (xml, notes) = convert(&Tree::parse(&v4).unwrap(), Format::V3, Library::Native);
    assert!(!xml.contains("_skipIf"), "{xml}");
    assert_eq!(notes.iter().filter(|note| note.changes_meaning).count(), 2, "{notes:#?}");
}

#[test]
fn a_good_tree_has_no_findings_and_says_that_all_cases_were_ticked() {
    let body = format!("<Fallback name='f'><Sequence name='s'>{SEEN}{LOOK}</Sequence>{WALK}</Fallback>");
    let report = check_report(&document("", &body), &Options::default());
    assert!(report.is_clean(), "{report}");
    let analysis = report.analysis.unwrap();
    assert_eq!(analysis.cover, Cover::Every { cases: 4 });
    assert!(analysis.to_string().contains("all 4 cases of 2 conditions"), "{analysis}");
    assert!(check_report("<root/>", &Options::default()).analysis.is_none());
}

#[test]
fn dead_double_frozen_and_stuck_are_each_found() {
    let dead = analysis(&format!("<Fallback name='f'>{LOOK}{WALK}</Fallback>"));
    assert_eq!(dead.dead.len(), 1);
    assert_eq!(dead.dead[0].code, FaultCode::BDead);
    assert!(dead.dead[0].message.to_string().contains("`walk` can never run"), "{}", dead.dead[0]);
    let double = analysis(&format!(
        "<Fallback name='f'><Sequence name='a'>{SEEN}{LOOK}{FOLLOW}</Sequence>\
         <Sequence name='b'><RobotMoved agent_id='{{id}}'/>{FOLLOW}{LOOK}</Sequence>{WALK}</Fallback>"
    ));
    assert_eq!(double.double_motion.len(), 2, "{double}");
    let frozen = analysis(&format!("<Fallback name='f'><Sequence name='s'>{SEEN}{LOOK}</Sequence></Fallback>"));
    assert_eq!(frozen.frozen.len(), 1, "{frozen}");
    assert!(frozen.frozen[0].message.to_string().contains("when nothing holds"), "{frozen}");
    let stuck = analysis(&format!(
        "<Fallback name='f'><Sequence name='s'>{SEEN}{}{LOOK}</Sequence><Sequence name='t'><RobotMoved agent_id='{{id}}'/>{}{FOLLOW}</Sequence>{WALK}</Fallback>",
        says(1),
        says(0)
    ));
    assert_eq!(stuck.stuck_gestures.len(), 1, "{stuck}");
    assert!(stuck.stuck_gestures[0].message.to_string().contains("WAIT"), "{stuck}");
}

#[test]
fn a_pause_that_ends_by_itself_is_no_freeze_and_a_gesture_taken_back_everywhere_is_not_stuck() {
    let timer = "<TimeExpiredCondition seconds='5' ts='{dt}' only_once='true'/>";
    let pause = analysis(&format!("<Sequence name='s'>{timer}{LOOK}</Sequence>"));
    assert_eq!(pause.frozen, [], "the timer runs out");
    let calm = analysis(&format!(
        "<Fallback name='f'><Sequence name='s'>{SEEN}{}{LOOK}</Sequence><Sequence name='t'>{}{WALK}</Sequence></Fallback>",
        says(1),
        says(0)
    ));
    assert_eq!(calm.stuck_gestures, [], "{calm}");
    let for_ever = analysis(&format!(
        "<Fallback name='f'><Sequence name='s'><Latch>{SEEN}</Latch>{}{LOOK}</Sequence>{WALK}</Fallback>",
        says(1)
    ));
    assert_eq!(for_ever.stuck_gestures, [], "once raised it is raised for ever, and meant so");
}

#[test]
fn too_many_conditions_are_sampled_and_that_is_said() {
    let many: String = (1..=14)
        .map(|k| format!("<Sequence name='s{k}'><HasTimePassed seconds='{k}'/><RobotSays agent_id='{{id}}' message='{}'/>{LOOK}</Sequence>", k % 6))
        .collect();
    let analysis = analysis(&format!("<Fallback name='f'>{many}{WALK}</Fallback>"));
    assert!(matches!(analysis.cover, Cover::Sample { .. }));
    assert!(analysis.to_string().contains("sample"), "{analysis}");
}

#[test]
fn nested_repetitions_do_not_keep_the_analysis() {
    let asked: String = (1..=12).map(|k| format!("<Inverter><HasTimePassed seconds='{k}'/></Inverter>")).collect();
    let (open, close) = ("<Repeat num_cycles='-1'>".repeat(8), "</Repeat>".repeat(8));
    let found = analysis(&format!(
        "<Sequence name='s'>{open}<Fallback name='f'>{asked}{LOOK}</Fallback>{close}{WALK}</Sequence>"
    ));
    assert!(found.dead.iter().any(|fault| fault.message.to_string().contains("`walk` can never run")), "{found}");
}

#[test]
fn leaves_of_unknown_meaning_are_taken_both_ways_and_named() {
    let body = "<Fallback name='f'><Sequence name='s'><IsRobotFacingAgent agent_id='1'/><SetGoal agent_id='1' goal_id='1'/></Sequence><RegularNav agent_id='1'/></Fallback>";
    let options = Options { library: Library::HunavSim2, meaning: Meaning::World, ..Options::default() };
    let report = check_report(&document("BTCPP_format='4'", body), &options);
    let analysis = report.analysis.unwrap();
    assert_eq!(analysis.opaque, ["IsRobotFacingAgent", "SetGoal"]);
    assert_eq!(analysis.dead, []);
    assert_eq!(analysis.cover, Cover::Every { cases: 4 });
}

#[test]
fn ticking_never_makes_a_new_buffer() {
    let body = format!(
        "<Fallback name='f'><Sequence name='s'>{SEEN}<Inverter><TimeExpiredCondition seconds='3' ts='{{dt}}' only_once='false'/></Inverter>{LOOK}</Sequence>{WALK}</Fallback>"
    );
    let tree = tree(&body);
    let entries = BTreeMap::from([("id".to_owned(), "1".to_owned()), ("dt".to_owned(), "0.01".to_owned())]);
    let mut state = tree.start_with(&entries);
    let bytes = state.bytes();
    assert!(bytes <= 256, "{bytes} bytes");
    let mut acts = 0;
    for tick in 0..5000_u32 {
        let mut room = Room { distance_m: Some(2.0), visible: tick % 11 < 6, ..Room::default() };
        acts += usize::from(room.tick(&tree, &mut state) == [Action::LookAtRobot]);
        assert_eq!(state.bytes(), bytes);
    }
    assert!(acts > 100);
}
