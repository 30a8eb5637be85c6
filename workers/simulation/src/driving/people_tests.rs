//! Runs with people whom drivers move over a bus in memory: alone, and together with the robot.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Value, json};
use socrates_engine::Setup;
use socrates_kit::Cancel;
use socrates_link::{Bus, MemoryBus};
use socrates_model::driver::Commands;
use socrates_model::lockstep::{Step, command_bytes};
use socrates_model::{AgentId, Command, Fault, FaultCode, HumanId, Keeper, PersonModel, PlannerName, Point, Recording};
use tokio::runtime::Handle;

use super::tests::{Answer, guest, patient, runtime, steady};
use super::{Again, Drive, OverBus};
use crate::runs::one_frontal;
use crate::{Driven, simulate_into};

const ONE: HumanId = HumanId::new(1);
const MISSION: &str = r#"{"version": 1, "rate_hz": 20}"#;

/// Walks toward the point ahead, and stands on purpose while the robot is within 1.5 m of them.
#[expect(clippy::unnecessary_wraps, reason = "others keep silent")]
fn walks(step: &Step, _nth: usize) -> Option<Vec<u8>> {
    let way = step.head.ahead - step.pose.point();
    let near = step.robot.is_some_and(|robot| (robot.at - step.pose.point()).norm() < 1.5);
    let pace = if near { 0.0 } else { 1.0_f64.min(2.0 * way.norm()) };
    let turn = socrates_model::geometry::wrap_angle(way.y.atan2(way.x) - step.pose.yaw);
    let command =
        Command { v: pace * turn.cos(), vy: pace * turn.sin(), omega: 2.0 * turn, gesture: None, waiting: near };
    Some(command_bytes(step.head.session, step.head.call, &command))
}

/// Drives whoever it is asked for.
fn both(step: &Step, nth: usize) -> Option<Vec<u8>> {
    if step.robot.is_some() { walks(step, nth) } else { steady(step, nth) }
}

fn people(driver: &str) -> BTreeMap<HumanId, PersonModel> {
    BTreeMap::from([(ONE, format!("external:{driver}").parse().unwrap())])
}

type Played = (Option<Commands>, Recording);

fn play(
    planner: &str,
    people: &BTreeMap<HumanId, PersonModel>,
    outside: &mut dyn super::Outside,
) -> Result<Played, Vec<Fault>> {
    let planner: PlannerName = planner.parse().unwrap();
    let mut keeper = Keeper::default();
    let commands =
        simulate_into(one_frontal(), Driven { planner: &planner, nav2: None, people }, outside, &mut keeper)?;
    Ok((commands, keeper.recording().unwrap()))
}

/// A run whose person the driver `mine` moves.
fn driven(bus: &Arc<MemoryBus>, handle: &Handle, planner: &str, drive: Drive) -> Result<Played, Vec<Fault>> {
    let bus: Arc<dyn Bus> = Arc::clone(bus) as Arc<dyn Bus>;
    play(planner, &people("mine"), &mut OverBus::new(bus, handle.clone(), drive, Cancel::new()))
}

/// Where the person's way ends.
fn goal(setup: &Setup) -> Point {
    let node = setup.paths.of(ONE.into()).unwrap().last().unwrap();
    setup.location.graph.node(node).unwrap().at
}

fn last(recording: &Recording, agent: usize) -> Point {
    recording.tick(recording.ticks() - 1)[agent].point()
}

#[test]
fn a_person_of_a_driver_gets_where_their_way_ends_and_their_run_is_played_again_without_it() {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let heard = runtime.block_on(guest(&bus, "mine", MISSION, walks));
    let (commands, recording) = driven(&bus, runtime.handle(), "reference", Drive::default()).unwrap();
    let (_, once_more) = driven(&bus, runtime.handle(), "reference", Drive::default()).unwrap();
    assert_eq!(recording.hash(), once_more.hash());
    let end = goal(&one_frontal());
    assert!((last(&recording, 1) - end).norm() < 0.5, "{:?} {end:?}", last(&recording, 1));
    let (_, own) = play("reference", &BTreeMap::new(), &mut super::Nobody).unwrap();
    assert_ne!(own.hash(), recording.hash());

    let told = heard.told.lock().unwrap().clone();
    let (mission, ended) = (&told[0], &told[1]);
    assert_eq!(
        (mission["person"]["id"].clone(), mission["person"]["relation"].clone()),
        (json!("human_1"), json!("frontal"))
    );
    assert_eq!((mission["planner"].clone(), mission["people"].clone()), (json!("external:mine"), json!([])));
    assert_eq!(mission["goal"], json!([end.x, end.y]));
    assert_eq!(mission["person"]["meets"].as_array().map(Vec::len), Some(1));
    let body = &mission["robot"];
    assert_eq!((body["name"].clone(), body["kinematics"].clone()), (json!("human_1"), json!("omnidirectional")));
    assert_eq!((body["radius_m"].as_f64(), body["v_max_mps"].as_f64()), (Some(0.28), Some(1.95)));
    let pace = mission["person"]["pace_mps"].as_f64().unwrap();
    assert!((0.5..1.95).contains(&pace), "{pace}");
    assert_eq!((ended["socrates"].clone(), ended["arrived"].clone()), (json!("end"), json!(true)));

    let commands = commands.unwrap();
    assert_eq!((commands.rate_hz, commands.of(ONE.into()).unwrap().rate_hz), (None, 20.0));
    let written = serde_json::to_string(&commands).unwrap();
    let mut again = Again::new(serde_json::from_str(&written).unwrap());
    let (same, replayed) = play("reference", &people("mine"), &mut again).unwrap();
    assert_eq!((replayed.hash(), same), (recording.hash(), Some(commands)));
}

#[test]
fn one_driver_drives_the_robot_and_a_person_of_a_run_each_in_a_session_of_their_own() {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let heard = runtime.block_on(guest(&bus, "mine", MISSION, both));
    let (commands, recording) = driven(&bus, runtime.handle(), "external:mine", Drive::default()).unwrap();
    let told: Vec<Value> = heard.told.lock().unwrap().clone();
    assert_eq!(told.len(), 4, "{told:#?}");
    assert_ne!(told[0]["session"], told[1]["session"]);
    assert_eq!((told[0].get("person"), told[1]["person"]["id"].clone()), (None, json!("human_1")));
    assert_eq!(
        (told[0]["people"].clone(), told[0]["robot"]["name"].clone()),
        (json!(["human_1"]), json!("linorobot2"))
    );
    assert!(told[2..].iter().all(|end| end["arrived"] == json!(true)), "{told:#?}");

    let commands = commands.unwrap();
    let mut again = Again::new(commands.clone());
    let (_, replayed) = play("external:mine", &people("mine"), &mut again).unwrap();
    assert_eq!(replayed.hash(), recording.hash());
    // What was kept of the robot alone does not play the person, and says so.
    let robot = Commands::default().with(AgentId::Robot, commands.of(AgentId::Robot).unwrap());
    let faults = play("external:mine", &people("mine"), &mut Again::new(robot)).unwrap_err();
    assert_eq!(
        faults[0].to_string(),
        "J-DRIVER driver mine of human_1: the commands that were kept hold none for human_1"
    );
}

#[test]
fn a_driver_of_a_person_that_fails_ends_the_run_with_a_fault_that_names_the_person_and_the_time() {
    let dies: Answer = |step, nth| if nth < 40 { walks(step, nth) } else { None };
    let broken: Answer = |step, nth| {
        let omega = if nth < 64 { 0.0 } else { f64::NAN };
        Some(command_bytes(step.head.session, step.head.call, &Command { omega, ..Command::default() }))
    };
    for (answer, said) in [
        (dies, "J-DRIVER driver mine of human_1: at 2.00 s: no answer within 1.0 s"),
        (broken, "J-DRIVER driver mine of human_1: at 3.20 s: `omega` is NaN; allowed are finite numbers"),
    ] {
        let runtime = runtime();
        let bus = Arc::new(MemoryBus::new());
        let _guest = runtime.block_on(guest(&bus, "mine", MISSION, answer));
        let faults = driven(&bus, runtime.handle(), "reference", patient(1)).unwrap_err();
        assert_eq!((faults.len(), faults[0].to_string().as_str()), (1, said));
    }
    assert!(FaultCode::JDriver.page().contains("J-DRIVER driver mine of human_1: at 3.20 s: `omega` is NaN"));
}

#[test]
fn a_driver_for_somebody_who_is_not_there_is_refused_before_anything_is_asked() {
    let nobody = BTreeMap::from([(HumanId::new(4), "external:mine".parse().unwrap())]);
    let faults = play("reference", &nobody, &mut super::Nobody).unwrap_err();
    assert_eq!(faults[0].code, FaultCode::JRequest);
    let told = faults[0].to_string();
    assert!(told.contains("people.human_4") && told.contains("it has human_1"), "{told}");
    // Without a bus there is nobody to ask.
    let faults = play("reference", &people("mine"), &mut super::Nobody).unwrap_err();
    assert_eq!(faults[0].code, FaultCode::JDriver);
}

#[test]
fn a_person_is_driven_without_a_robot_as_well() {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let _guest = runtime.block_on(guest(&bus, "mine", MISSION, walks));
    let (_, recording) = driven(&bus, runtime.handle(), "none", Drive::default()).unwrap();
    assert!((last(&recording, 0) - goal(&one_frontal())).norm() < 0.5);
}

#[test]
fn a_person_is_told_of_the_robot_while_they_see_it_or_always_where_their_driver_asks_for_all() {
    // They turn on the spot, and their command says whether the robot was told.
    let answer: Answer = |step, _| {
        let command = Command { omega: 1.5, waiting: step.robot.is_some(), ..Command::default() };
        Some(command_bytes(step.head.session, step.head.call, &command))
    };
    let told = |mission: &'static str| {
        let runtime = runtime();
        let bus = Arc::new(MemoryBus::new());
        let _guest = runtime.block_on(guest(&bus, "mine", mission, answer));
        let (commands, _) = driven(&bus, runtime.handle(), "reference", Drive::default()).unwrap();
        let commands = commands.unwrap().of(ONE.into()).unwrap().commands;
        let with = commands.iter().filter(|command| command.waiting).count();
        (with, commands.len() - with)
    };
    let (seen, unseen) = told(MISSION);
    assert!(seen > 0 && unseen > 0, "{seen} {unseen}");
    let (all, without) = told(r#"{"version": 1, "people": "all"}"#);
    assert!(all > 0 && without == 0, "{all} {without}");
}
