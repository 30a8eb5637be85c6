//! Every fault of a tree is found, with its code; a good tree has none.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use socrates_bt::{CheckContext, Library, Options, Tree, check};
use socrates_model::{Action, Fault, FaultCode, Gesture, HumanId, Rule, Trigger};
use socrates_tests::skip::shared;

const WALK: &str = "<Sequence name='walk'><SetBlackboard output_key='agentid' value='{id}'/>\
    <SetBlackboard output_key='timestep' value='{dt}'/><SubTree ID='RegularNavTree' id='agentid' dt='timestep'/></Sequence>";
const QUIET_WALK: &str = "<Sequence name='walk'><MakeGesture agent_id='{id}' message='0'/>\
    <SetBlackboard output_key='agentid' value='{id}'/><SetBlackboard output_key='timestep' value='{dt}'/>\
    <SubTree ID='RegularNavTree' id='agentid' dt='timestep'/></Sequence>";
const SEEN: &str = "<IsRobotVisible agent_id='{id}' distance='5'/>";
const LOOK: &str = "<LookAtRobot agent_id='{id}'/>";

fn document(body: &str) -> String {
    format!(
        "<root main_tree_to_execute='T'><include path='BTRegularNav.xml'/><BehaviorTree ID='T'>{body}</BehaviorTree></root>"
    )
}

/// A fallback of these branches.
fn branches(branches: &[&str]) -> String {
    document(&format!("<Fallback name='f'>{}</Fallback>", branches.concat()))
}

fn sequence(parts: &[&str]) -> String {
    format!("<Sequence name='s'>{}</Sequence>", parts.concat())
}

fn timer(inverted: bool) -> String {
    let timer = "<TimeExpiredCondition seconds='5' ts='{dt}' only_once='true'/>";
    if inverted { format!("<Inverter>{timer}</Inverter>") } else { timer.to_owned() }
}

fn look() -> Rule {
    Rule {
        when: vec![Trigger::RobotVisible(5.0)],
        act: Action::LookAtRobot,
        gesture: None,
        for_s: None,
        latched: false,
        ..Rule::default()
    }
}

fn faults_of(xml: &str, rules: &[Rule]) -> Vec<Fault> {
    let tree = Tree::parse(xml).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let others = BTreeMap::from([(HumanId::new(2), vec![Gesture::Proceed])]);
    let ctx = CheckContext {
        human: HumanId::new(1),
        humans: 2,
        robot_says: &[Gesture::ExcuseMe],
        human_says: &others,
        rules,
    };
    check(&tree, &ctx)
}

fn codes(xml: &str, rules: &[Rule]) -> Vec<FaultCode> {
    let mut codes: Vec<FaultCode> = faults_of(xml, rules).iter().map(|fault| fault.code).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

fn refused(xml: &str) -> Vec<Fault> {
    Tree::parse(xml).map(|_| ()).unwrap_err()
}

#[test]
fn a_tree_that_does_what_is_asked_has_no_fault() {
    let xml = branches(&[&sequence(&[SEEN, LOOK]), WALK]);
    assert_eq!(faults_of(&xml, &[look()]), []);
    assert_eq!(faults_of(&branches(&[WALK]), &[]), []);
    assert_eq!(faults_of(&document(WALK), &[]), []);
}

#[test]
fn a_missing_walk_is_found() {
    let standing = branches(&[&sequence(&[SEEN, LOOK]), "<StandStill agent_id='{id}'/>"]);
    assert!(codes(&standing, &[look()]).contains(&FaultCode::BNav));
}

#[test]
fn a_damaged_walk_is_found() {
    let xml = branches(&[&WALK.replace("id='agentid'", "id='{id}'")]);
    assert_eq!(codes(&xml, &[]), [FaultCode::BNav]);
}

#[test]
fn a_timer_after_its_action_is_found() {
    let late = branches(&[&sequence(&[SEEN, LOOK, &timer(true)]), WALK]);
    assert!(codes(&late, &[look()]).contains(&FaultCode::BTimer));
}

#[test]
fn a_timer_that_delays_what_it_should_limit_is_found() {
    let asked = [Rule { for_s: Some(5.0), ..look() }];
    let limits = branches(&[&sequence(&[SEEN, &timer(true), LOOK]), WALK]);
    assert_eq!(faults_of(&limits, &asked), []);
    let delays = branches(&[&sequence(&[SEEN, &timer(false), LOOK]), WALK]);
    assert_eq!(codes(&delays, &asked), [FaultCode::BTimer]);
}

#[test]
fn a_condition_after_its_action_is_found() {
    let xml = branches(&[&sequence(&[LOOK, SEEN]), WALK]);
    assert!(codes(&xml, &[look()]).contains(&FaultCode::BOrder));
}

#[test]
fn a_branch_behind_one_that_always_ends_first_is_found() {
    let xml = branches(&[LOOK, WALK]);
    let faults = faults_of(&xml, &[look()]);
    let dead = faults.iter().find(|fault| fault.code == FaultCode::BDead).unwrap();
    assert!(dead.message.to_string().contains("`LookAtRobot` before it"), "{dead}");
}

#[test]
fn a_branch_whose_conditions_exclude_each_other_is_found() {
    let near = "<IsRobotNearby agent_id='{id}' distance='2'/>";
    let not_far = "<Inverter><IsRobotNearby agent_id='{id}' distance='4'/></Inverter>";
    let xml = branches(&[&sequence(&[near, not_far, LOOK]), WALK]);
    assert!(codes(&xml, &[look()]).contains(&FaultCode::BDead));
}

#[test]
fn two_motions_in_one_tick_are_found() {
    let xml = branches(&[&sequence(&[SEEN, LOOK, "<FollowRobot agent_id='{id}' time_step='{dt}'/>"]), WALK]);
    assert!(codes(&xml, &[look()]).contains(&FaultCode::BMove2));
}

#[test]
fn a_case_without_a_motion_is_found_in_words() {
    let xml = branches(&[&sequence(&[SEEN, "<MakeGesture agent_id='{id}' message='0'/>"]), WALK]);
    let faults = faults_of(&xml, &[]);
    let still = faults.iter().find(|fault| fault.code == FaultCode::BStill).unwrap();
    assert!(still.message.to_string().contains("see the robot within 5 m"), "{still}");
}

#[test]
fn a_gesture_that_is_never_taken_back_is_found() {
    let says = "<MakeGesture agent_id='{id}' message='1'/>";
    let asked = [Rule { gesture: Some(Gesture::Wait), ..look() }];
    let left = branches(&[&sequence(&[SEEN, says, LOOK]), WALK]);
    assert_eq!(codes(&left, &asked), [FaultCode::BLatch]);
    let taken_back = branches(&[&sequence(&[SEEN, says, LOOK]), QUIET_WALK]);
    assert_eq!(faults_of(&taken_back, &asked), []);
}

#[test]
fn a_gesture_that_nobody_makes_is_found() {
    let waits = |who: &str| branches(&[&sequence(&[who, LOOK]), WALK]);
    let rule = |trigger: Trigger| [Rule { when: vec![trigger], ..look() }];
    let robot = |code: u8| waits(&format!("<RobotSays agent_id='{{id}}' message='{code}'/>"));
    let human = |id: u8, code: u8| waits(&format!("<HumanSays agent_id='{{id}}' target_id='{id}' message='{code}'/>"));
    assert_eq!(codes(&robot(4), &rule(Trigger::RobotSays(Gesture::ExcuseMe))), []);
    assert_eq!(codes(&robot(1), &rule(Trigger::RobotSays(Gesture::Wait))), [FaultCode::BHear]);
    // No gesture is no message that could be waited for.
    assert!(codes(&robot(0), &rule(Trigger::Always)).contains(&FaultCode::BHear));
    let says = |id: u32, gesture| rule(Trigger::HumanSays(HumanId::new(id), gesture));
    assert_eq!(codes(&human(2, 2), &says(2, Gesture::Proceed)), []);
    assert_eq!(codes(&human(2, 1), &says(2, Gesture::Wait)), [FaultCode::BHear]);
    assert_eq!(codes(&human(1, 2), &says(1, Gesture::Proceed)), [FaultCode::BRange]);
    assert_eq!(codes(&human(3, 2), &says(3, Gesture::Proceed)), [FaultCode::BRange]);
}

#[test]
fn what_is_missing_and_what_is_too_much_is_found() {
    let xml = branches(&[&sequence(&[SEEN, LOOK]), WALK]);
    assert_eq!(codes(&xml, &[]), [FaultCode::BMatch]);
    assert_eq!(codes(&branches(&[WALK]), &[look()]), [FaultCode::BMatch]);
    let other_distance = [Rule { when: vec![Trigger::RobotVisible(3.0)], ..look() }];
    assert_eq!(codes(&xml, &other_distance), [FaultCode::BMatch]);
    assert_eq!(codes(&xml, &[Rule { gesture: Some(Gesture::Wait), ..look() }]), [FaultCode::BMatch]);
    assert_eq!(codes(&xml, &[Rule { for_s: Some(4.0), ..look() }]), [FaultCode::BMatch]);
    assert_eq!(codes(&xml, &[Rule { latched: true, ..look() }]), [FaultCode::BMatch]);
    let unguarded = [Rule { when: vec![Trigger::RobotVisible(5.0), Trigger::RobotStopped], ..look() }];
    assert_eq!(codes(&xml, &unguarded), [FaultCode::BMatch]);
}

#[test]
fn rules_are_done_in_the_order_of_the_proposal() {
    let follow = |for_s| Rule { when: vec![Trigger::RobotNear(3.0)], act: Action::FollowRobot, for_s, ..look() };
    let tree = |rules: &[Rule]| socrates_bt::compile(HumanId::new(1), rules).unwrap();
    for for_s in [None, Some(5.0)] {
        let (asked, turned) = ([follow(for_s), look()], [look(), follow(for_s)]);
        assert_eq!(faults_of(&tree(&asked), &asked), []);
        assert_eq!(faults_of(&tree(&turned), &turned), []);
        let faults = faults_of(&tree(&turned), &asked);
        assert_eq!(faults.iter().map(|fault| fault.code).collect::<Vec<_>>(), [FaultCode::BMatch], "{faults:?}");
        assert!(faults[0].to_string().contains("the first one first"), "{}", faults[0]);
        assert!(codes(&tree(&asked), &turned).contains(&FaultCode::BMatch));
    }
    // Rules that never hold together may stand in any order.
    let standing = |when| Rule { when: vec![Trigger::RobotVisible(5.0), when], ..look() };
    let (moves, stops) =
        (standing(Trigger::RobotMoving), Rule { act: Action::GiveWay, ..standing(Trigger::RobotStopped) });
    assert_eq!(faults_of(&tree(&[moves.clone(), stops.clone()]), &[stops, moves]), []);
}

#[test]
fn rules_that_contradict_each_other_are_found() {
    let xml = branches(&[&sequence(&[SEEN, LOOK]), WALK]);
    let rules = [look(), Rule { act: Action::RunAway, ..look() }];
    assert!(codes(&xml, &rules).contains(&FaultCode::BContra));
}

#[test]
fn all_faults_of_a_document_are_told_at_once_with_their_places() {
    let xml = document(
        "\n<Fallback name='f'>\n<Sequense name='s'/>\n<IsRobotVisible agent_id='3' distance='99' far='1'/>\n\
         <MakeGesture agent_id='{id}' message='WAIT'/>\n<MakeGesture agent_id='{id}' message='9'/>\n<Inverter/>\n\
         <SubTree ID='Nowhere'/>\n<RobotSays agent_id='{id}' message='??'/>\n<RobotMoved/>\n</Fallback>",
    );
    let faults = refused(&xml);
    let has = |code: FaultCode, at: &str, text: &str| {
        assert!(
            faults.iter().any(|fault| fault.code == code
                && fault.at.to_string().starts_with(at)
                && fault.message.to_string().contains(text)),
            "no {code} at {at} with `{text}` in {faults:#?}"
        );
    };
    has(FaultCode::BNode, "3:1", "nearest: Sequence");
    has(FaultCode::BPort, "4:1", "agent_id=`3`");
    has(FaultCode::BPort, "4:1", "no attribute `far`");
    has(FaultCode::BRange, "4:1", "distance=`99`");
    has(FaultCode::BCode, "5:1", "1 WAIT");
    has(FaultCode::BRange, "6:1", "message=`9`");
    has(FaultCode::BArity, "7:1", "exactly 1");
    has(FaultCode::BPort, "8:1", "Nowhere");
    has(FaultCode::BPort, "9:1", "left open");
    has(FaultCode::BPort, "10:1", "lacks `agent_id`");
    assert_eq!(faults.len(), 10, "{faults:#?}");
}

#[test]
fn the_main_tree_must_be_there_once() {
    let missing = "<root main_tree_to_execute='A'><BehaviorTree ID='B'><AlwaysSuccess/></BehaviorTree></root>";
    assert_eq!(refused(missing)[0].code, FaultCode::BMain);
    let twice = "<root main_tree_to_execute='A'><BehaviorTree ID='A'><AlwaysSuccess/></BehaviorTree>\
                 <BehaviorTree ID='A'><AlwaysSuccess/></BehaviorTree></root>";
    assert_eq!(refused(twice)[0].code, FaultCode::BMain);
    let itself = "<root main_tree_to_execute='A'><BehaviorTree ID='A'><SubTree ID='A'/></BehaviorTree></root>";
    assert_eq!(refused(itself)[0].code, FaultCode::BMain);
}

#[test]
fn a_document_that_unfolds_without_end_is_refused() {
    let mut xml = "<root main_tree_to_execute='t0'>".to_owned();
    for level in 0..14 {
        let call = format!("<SubTree ID='t{}'/>", level + 1);
        xml.push_str(&format!(
            "<BehaviorTree ID='t{level}'><Sequence name='s'>{call}{call}{call}{call}</Sequence></BehaviorTree>"
        ));
    }
    xml.push_str("<BehaviorTree ID='t14'><AlwaysSuccess/></BehaviorTree></root>");
    assert_eq!(refused(&xml)[0].code, FaultCode::BMain);
}

#[test]
fn an_attribute_of_version_4_is_refused_in_version_3() {
    let xml = document("<AlwaysSuccess _skipIf='x==1'/>");
    assert_eq!(refused(&xml)[0].code, FaultCode::BPort);
}

/// Reads a tree; its includes are found beside it.
fn beside(file: &Path, library: Library, declared: bool) -> Result<Tree, Vec<Fault>> {
    let text = fs::read_to_string(file).unwrap();
    let find = |name: &str| fs::read_to_string(file.parent()?.join(name)).ok();
    Tree::parse_with(&text, &Options { includes: Some(&find), library, declared, ..Options::default() })
}

/// Reads a shipped tree of another simulator.
#[track_caller]
fn shipped(path: &str, library: Library, declared: bool) -> Option<Result<Tree, Vec<Fault>>> {
    shared(&format!("socrates_hunav/{path}")).map(|file| beside(&file, library, declared))
}

/// Reads a tree of our own in the style of another simulator.
fn own(path: &str, library: Library) -> Result<Tree, Vec<Fault>> {
    beside(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/simulators").join(path), library, false)
}

#[test]
fn trees_of_our_own_in_the_style_of_other_simulators_load_or_are_refused() {
    for (path, library) in [
        ("fork/polite.xml", Library::SocratesFork),
        ("fork/waves.xml", Library::SocratesFork),
        ("hunav_1_0/startled.xml", Library::HunavSim1_0),
        ("hunav_1_1/inquisitive.xml", Library::HunavSim1_1),
        ("hunav_2/stroll.xml", Library::HunavSim2),
    ] {
        if let Err(faults) = own(path, library) {
            panic!("{path}: {faults:#?}");
        }
    }
    for (path, code) in [("fork/absent_node.xml", FaultCode::BNode), ("fork/absent_port.xml", FaultCode::BPort)] {
        let faults = own(path, Library::SocratesFork).map(|_| ()).unwrap_err();
        assert!(faults.iter().all(|fault| fault.code == code), "{path}: {faults:#?}");
    }
}

#[test]
fn good_trees_of_other_simulators_load() {
    let files = [
        ("hunav_sim_fork/behavior_trees/LLMBT_0.xml", Library::SocratesFork, false),
        ("hunav_sim_fork/behavior_trees/LLMBT_1.xml", Library::SocratesFork, false),
        ("hunav_sim_fork/behavior_trees/LLMBT_2.xml", Library::SocratesFork, false),
        ("hunav_sim_fork/behavior_trees/BTRegularNav.xml", Library::SocratesFork, false),
        ("hunav_sim_v1_0/behavior_trees/BTSurprisedNav.xml", Library::HunavSim1_0, false),
        ("hunav_sim_v1_0/behavior_trees/BTScaredNav.xml", Library::HunavSim1_0, false),
        ("hunav_sim_v1_1/behavior_trees/BTCuriousNav.xml", Library::HunavSim1_1, false),
        ("hunav_sim_v1_1/behavior_trees/BTScaredNav.xml", Library::HunavSim1_1, false),
        ("hunav_sim_v1_1/behavior_trees/BTThreateningNav.xml", Library::HunavSim1_1, false),
        ("isaac_wrapper_v2/behavior_trees/hospital_agents__agent_5_bt.xml", Library::Native, true),
        ("isaac_wrapper_v2/behavior_trees/warehouse_agents__agent_2_bt.xml", Library::Native, true),
    ];
    for (path, library, declared) in files {
        if let Some(Err(faults)) = shipped(path, library, declared) {
            panic!("{path}: {faults:#?}");
        }
    }
}

#[test]
fn bad_trees_of_other_simulators_are_refused() {
    for (path, code) in [
        ("hunav_sim_fork/behavior_trees/LLMBT_3.xml", FaultCode::BNode),
        ("hunav_sim_fork/behavior_trees/LLMBT_4.xml", FaultCode::BPort),
        ("hunav_sim_fork/behavior_trees/BTScaredNav.xml", FaultCode::BNode),
        ("hunav_sim_fork/behavior_trees/BTSurprisedNav.xml", FaultCode::BNode),
        ("hunav_sim_fork/behavior_trees/BTThreateningNav.xml", FaultCode::BNode),
    ] {
        if let Some(read) = shipped(path, Library::SocratesFork, false) {
            let faults = read.map(|_| ()).unwrap_err();
            assert!(faults.iter().any(|fault| fault.code == code), "{path}: {faults:#?}");
        }
    }
}
