//! Runs with drivers over a bus in memory: what each way of failing comes to, and the same run again.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::Value;
use socrates_kit::Cancel;
use socrates_link::{AliveToken, Bus, MemoryBus, keys};
use socrates_model::driver::Commands;
use socrates_model::lockstep::{Step, command_bytes, gives_up_bytes, read_step};
use socrates_model::{Command, Digest, Fault, FaultCode, Gesture, Keeper};
use tokio::runtime::{Builder, Handle, Runtime};

use super::{Again, Drive, Mode, OverBus};
use crate::runs::one_frontal;
use crate::simulate_into;

/// What a driver of a test answers to a step; none keeps silent.
pub(super) type Answer = fn(&Step, usize) -> Option<Vec<u8>>;

/// A driver on the bus, and what it heard.
pub(super) struct Guest {
    _claim: AliveToken,
    /// Missions and ends, as they were told.
    pub(super) told: Arc<Mutex<Vec<Value>>>,
    missions: Arc<AtomicUsize>,
    map_cells: Arc<AtomicUsize>,
    ended: Arc<AtomicUsize>,
}

/// Serves a driver of this name until the runtime ends.
pub(super) async fn guest(bus: &Arc<MemoryBus>, name: &str, mission: &'static str, answer: Answer) -> Guest {
    let mut missions = bus.serve(&keys::drive_mission(name)).await.unwrap();
    let mut steps = bus.serve(&keys::drive_step(name)).await.unwrap();
    let heard: [Arc<AtomicUsize>; 3] = std::array::from_fn(|_| Arc::default());
    let [told, cells, ended] = heard.clone();
    let all: Arc<Mutex<Vec<Value>>> = Arc::default();
    let kept = Arc::clone(&all);
    tokio::spawn(async move {
        while let Some(ask) = missions.next().await {
            if ask.body().starts_with(b"SOCM") {
                cells.fetch_add(ask.body().len() - 32, Ordering::Relaxed);
                ask.reply(b"{}".to_vec()).await.unwrap();
                continue;
            }
            let message: Value = serde_json::from_slice(ask.body()).unwrap();
            let end = message["socrates"] == "end";
            if end { &ended } else { &told }.fetch_add(1, Ordering::Relaxed);
            kept.lock().unwrap().push(message);
            ask.reply(mission.as_bytes().to_vec()).await.unwrap();
        }
    });
    tokio::spawn(async move {
        let mut nth = 0;
        let mut silent = Vec::new();
        while let Some(ask) = steps.next().await {
            let step = read_step(ask.body()).unwrap();
            match answer(&step, nth) {
                Some(bytes) => ask.reply(bytes).await.unwrap(),
                None => silent.push(ask),
            }
            nth += 1;
        }
    });
    let claim = bus.declare_alive(&keys::drive_claim(name, "1")).await.unwrap();
    let [missions, map_cells, ended] = heard;
    Guest { _claim: claim, told: all, missions, map_cells, ended }
}

pub(super) fn runtime() -> Runtime {
    Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap()
}

/// A run of the driver `mine` as this program plays it.
fn played(bus: &Arc<MemoryBus>, handle: &Handle, drive: Drive) -> Result<(Commands, Digest), Fault> {
    let bus: Arc<dyn Bus> = Arc::clone(bus) as Arc<dyn Bus>;
    let mut outside = OverBus::new(bus, handle.clone(), drive, Cancel::new());
    let mut keeper = Keeper::default();
    let played = simulate_into(one_frontal(), &"external:mine".parse().unwrap(), &mut outside, &mut keeper);
    played.map(|commands| (commands.unwrap(), keeper.recording().unwrap().hash())).map_err(|faults| faults[0].clone())
}

/// The same for a driver that answers so.
fn run(mission: &'static str, answer: Answer, drive: Drive) -> Result<(Commands, Digest), Fault> {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let _guest = runtime.block_on(guest(&bus, "mine", mission, answer));
    played(&bus, runtime.handle(), drive)
}

const MISSION: &str = r#"{"version": 1, "rate_hz": 10}"#;

/// Toward the point ahead, slowly.
#[expect(clippy::unnecessary_wraps, reason = "others keep silent")]
pub(super) fn steady(step: &Step, _nth: usize) -> Option<Vec<u8>> {
    let way = step.head.ahead - step.pose.point();
    let turn = socrates_model::geometry::wrap_angle(way.y.atan2(way.x) - step.pose.yaw);
    let v = 0.5 * turn.cos().max(0.0);
    Some(command_bytes(step.head.session, step.head.call, &Command { v, omega: 1.5 * turn, ..Command::default() }))
}

pub(super) fn patient(seconds: u64) -> Drive {
    Drive { patience: Duration::from_secs(seconds), ..Drive::default() }
}

#[test]
fn a_driver_that_follows_the_plan_arrives_and_its_run_is_played_again_without_it() {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let heard = runtime.block_on(guest(&bus, "mine", r#"{"version": 1, "rate_hz": 20, "map": true}"#, steady));
    let (commands, hash) = played(&bus, runtime.handle(), Drive::default()).unwrap();
    let (_, once_more) = played(&bus, runtime.handle(), Drive::default()).unwrap();
    assert_eq!(hash, once_more);
    assert_eq!((commands.rate_hz, commands.people.len()), (Some(20.0), 0));
    assert_eq!(heard.missions.load(Ordering::Relaxed), 2);
    assert_eq!(heard.ended.load(Ordering::Relaxed), 2);
    let grid = one_frontal().location.grid;
    assert_eq!(heard.map_cells.load(Ordering::Relaxed), 2 * grid.width * grid.height);

    let written = serde_json::to_string(&commands).unwrap();
    let mut keeper = Keeper::default();
    let mut again = Again::new(serde_json::from_str(&written).unwrap());
    simulate_into(one_frontal(), &"external:mine".parse().unwrap(), &mut again, &mut keeper).unwrap();
    let recording = keeper.recording().unwrap();
    assert_eq!(recording.hash(), hash);
    assert!(recording.events.iter().any(|event| matches!(event.kind, socrates_model::EventKind::RobotArrived)));

    // Without its last commands the run cannot be played to its end, and says so.
    let cut = Commands { commands: commands.commands[..10].to_vec(), ..commands };
    let mut nothing = Keeper::default();
    let faults = simulate_into(one_frontal(), &"external:mine".parse().unwrap(), &mut Again::new(cut), &mut nothing);
    assert!(faults.unwrap_err()[0].message.to_string().contains("its commands end after 10"));
}

#[test]
fn every_way_of_failing_ends_the_run_with_a_fault_that_says_which() {
    let cases: [(&'static str, Answer, &str); 8] = [
        (
            MISSION,
            |step, nth| if nth < 5 { steady(step, nth) } else { Some(Vec::new()) },
            "at 0.50 s: the answer has 0 bytes",
        ),
        (
            MISSION,
            |step, _| {
                let command = Command { v: f64::NAN, ..Command::default() };
                Some(command_bytes(step.head.session, step.head.call, &command))
            },
            "at 0.00 s: `v` is NaN",
        ),
        (MISSION, |_, _| Some(gives_up_bytes("lost")), "the driver gives up: lost"),
        (
            MISSION,
            |step, nth| steady(step, nth).map(|bytes| [&bytes[..4], &[9, 0], &bytes[6..]].concat()),
            "of version 9",
        ),
        (MISSION, |step, _| Some(command_bytes(step.head.session, 7, &Command::default())), "the answer is to step 7"),
        (MISSION, |step, nth| if nth < 3 { steady(step, nth) } else { None }, "no answer within 1.0 s"),
        (r#"{"version": 2}"#, steady, "the driver speaks version 2; this program speaks version 1"),
        (r#"{"version": 1, "error": "no office"}"#, steady, "the driver does not take this run: no office"),
    ];
    for (mission, answer, said) in cases {
        let fault = run(mission, answer, patient(1)).unwrap_err();
        assert_eq!(fault.code, FaultCode::JDriver);
        assert!(fault.message.to_string().contains(said), "{said}: {}", fault.message);
    }
}

#[test]
fn the_page_of_the_fault_shows_one_that_was_really_found() {
    let answer: Answer = |step, nth| {
        let omega = if nth < 32 { 0.0 } else { f64::NAN };
        Some(command_bytes(step.head.session, step.head.call, &Command { omega, ..Command::default() }))
    };
    let fault = run(MISSION, answer, Drive::default()).unwrap_err();
    assert!(FaultCode::JDriver.page().contains(&fault.to_string()), "{fault}");
}

#[test]
fn a_driver_that_never_comes_or_of_which_there_are_two_is_named() {
    let runtime = runtime();
    let bus = Arc::new(MemoryBus::new());
    let nobody = played(&bus, runtime.handle(), patient(1)).unwrap_err().message.to_string();
    assert!(
        nobody.contains("no driver of this name came within 1 s") && nobody.contains("drive/mine/claim/*"),
        "{nobody}"
    );
    let _other = runtime.block_on(guest(&bus, "theirs", MISSION, steady));
    let nobody = played(&bus, runtime.handle(), patient(1)).unwrap_err().message.to_string();
    assert!(nobody.ends_with("there are drivers called `theirs`"), "{nobody}");
    let _guest = runtime.block_on(guest(&bus, "mine", MISSION, steady));
    let _second = runtime.block_on(bus.declare_alive(&keys::drive_claim("mine", "2"))).unwrap();
    let two = played(&bus, runtime.handle(), patient(1)).unwrap_err().message.to_string();
    assert!(two.contains("two drivers have this name: `drive/mine/claim/1` and `drive/mine/claim/2`"), "{two}");
}

#[test]
fn a_driver_that_is_slow_in_the_mode_wait_lets_the_robot_stop() {
    // It answers the first ten steps alone.
    let answer: Answer = |step, nth| if nth < 10 { steady(step, nth) } else { None };
    let drive = Drive { mode: Mode::Wait(Duration::from_millis(2)), ..patient(600) };
    let Ok((commands, _)) = run(MISSION, answer, drive) else { panic!("the run goes on to its end") };
    let last_told = commands.commands.iter().rposition(|command| command.v > 0.0).unwrap();
    // The last command holds for half a second: five steps at 10 Hz.
    assert!((9..=15).contains(&last_told), "{last_told}");
    assert!(commands.commands.len() > 100);
}

#[test]
fn a_driver_in_the_mode_free_never_holds_the_run_up_and_its_run_is_played_again() {
    let drive = Drive { mode: Mode::Free, ..patient(30) };
    let (commands, hash) = run(MISSION, steady, drive).unwrap();
    let mut keeper = Keeper::default();
    simulate_into(one_frontal(), &"external:mine".parse().unwrap(), &mut Again::new(commands), &mut keeper).unwrap();
    assert_eq!(keeper.recording().unwrap().hash(), hash);
}

#[test]
fn a_gesture_of_a_driver_is_made_once_and_seen_in_the_recording() {
    let answer: Answer = |step, nth| {
        let gesture = (nth == 20).then_some(Gesture::ExcuseMe);
        Some(command_bytes(step.head.session, step.head.call, &Command { gesture, ..Command::default() }))
    };
    let (commands, _) = run(MISSION, answer, Drive::default()).unwrap();
    assert_eq!(commands.commands.iter().filter(|command| command.gesture.is_some()).count(), 1);
}
