//! A run on the bus: every tick comes, or is listed and can be fetched.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests may fail the test")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, MemoryBus, Overflow, Qos, keys};
use socrates_model::driver::{MissionDoor, MissionMap, map_cells};
use socrates_model::live::{self, LiveDoor, LiveDoors, LiveEnd, LiveEvents, LiveMeta, LivePlace, LiveScene};
use socrates_model::recording::{AgentInfo, AgentState, Event, EventKind, Recording};
use socrates_model::{AgentId, Cell, Grid, Onlooker as _, Pose, RunId, SimTime};
use socrates_stream::mcap::Tape;
use socrates_stream::{Linger, LiveSink, Sharpness, Sight, TickRange, Watch, csv};

const WATCHDOG: Duration = Duration::from_secs(60);
const PATIENCE: Duration = Duration::from_secs(20);

fn recording(seconds: u32) -> Recording {
    let mut text = String::from("t,id,x,y\n");
    for n in 0..=seconds {
        let _infallible = writeln!(text, "{n},robot,{n},0\n{n},human_1,0,{n}");
    }
    let mut recording = csv::read_tracks(&text).unwrap();
    let event = |tick| Event { time: SimTime::at_tick(tick), kind: EventKind::RobotArrived };
    recording.events = vec![event(5), event(50)];
    recording
}

/// A run of which nothing is told but its header.
fn scene() -> (LiveScene, Vec<u8>) {
    (LiveScene::default(), Vec::new())
}

/// Longer than any test.
fn linger() -> Linger {
    Linger::new(Duration::from_secs(30), 4)
}

/// What happened at a tick.
fn events_at(recording: &Recording, tick: usize) -> Vec<Event> {
    recording.events.iter().filter(|event| event.time.tick() == tick as u64).cloned().collect()
}

/// Plays a run to its viewers; what is recorded of it on the tape comes first.
fn play(sink: &mut LiveSink, tape: &Tape, recording: &Recording) {
    let mut writer = tape.record(&recording.header, None).unwrap();
    sink.announce(&recording.header);
    for tick in 0..recording.ticks() {
        writer.tick(recording.tick(tick)).unwrap();
        sink.tick(recording.tick(tick), &events_at(recording, tick));
    }
    writer.finish().unwrap();
    sink.end(&LiveEnd::default());
}

#[derive(Default)]
struct Tally {
    headers: usize,
    seen: Vec<u64>,
    /// Of the last tick.
    agents: usize,
    gaps: Vec<TickRange>,
    events: Vec<Event>,
    end: Option<u64>,
}

async fn watched(watch: &mut Watch) -> Tally {
    let mut tally = Tally::default();
    while tally.end.is_none() {
        match watch.next(PATIENCE).await.unwrap().expect("the run ends") {
            Sight::Header(_) => tally.headers += 1,
            Sight::Tick { tick, states } => {
                assert!(states.iter().all(|state| state.tick == tick));
                tally.agents = states.len();
                tally.seen.push(tick);
            }
            Sight::Missing(range) => tally.gaps.push(range),
            Sight::Event(event) => tally.events.push(event),
            Sight::End { ticks, .. } => tally.end = Some(ticks),
        }
    }
    tally
}

async fn guarded<T>(what: impl Future<Output = T>) -> T {
    tokio::time::timeout(WATCHDOG, what).await.expect("within the watchdog's time")
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_watcher_gets_the_header_every_tick_every_event_and_the_end() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r1").unwrap();
        let recording = recording(3);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let mut watch = Watch::open(bus, &run, 4096).await.unwrap();
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        let tally = watched(&mut watch).await;
        assert_eq!((tally.headers, tally.agents), (1, 2));
        assert_eq!(tally.seen, (0..301).collect::<Vec<u64>>());
        assert!(tally.gaps.is_empty());
        assert_eq!(tally.events, recording.events);
        assert_eq!(tally.end, Some(301));
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_slow_watcher_knows_exactly_what_it_missed_and_can_fetch_it() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r2").unwrap();
        let recording = recording(20);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        // Room for few ticks, and nothing is read while the run goes on: most are lost.
        let mut watch = Watch::open(Arc::clone(&bus), &run, 4).await.unwrap();
        let mut fence = bus.subscribe(&keys::live_agents(&run), 1, Overflow::DropOldest).await.unwrap();
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        // The end marker is the last message of the frame key, a head alone.
        while fence.next().await.unwrap().1.len() != 16 {}
        let tally = watched(&mut watch).await;
        let listed: u64 = tally.gaps.iter().map(|range| range.len()).sum();
        assert!(listed > 1000, "{listed}");
        assert_eq!(tally.seen.len() as u64 + listed, 2001);
        assert_eq!(watch.missing(), tally.gaps);
        assert_eq!(tally.events.len(), 2);
        for range in tally.gaps {
            let states = watch.fetch(range).await.unwrap();
            let from = usize::try_from(range.from).unwrap() * 2;
            assert_eq!(states, recording.frames[from..from + states.len()]);
            assert_eq!(states.len() as u64, range.len() * 2);
        }
        assert!(watch.missing().is_empty());
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_late_joiner_of_a_finished_run_gets_header_gap_and_end() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r3").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let recording = recording(1);
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        let sink = sink.await.unwrap();
        let mut watch = Watch::open(bus, &run, 16).await.unwrap();
        let tally = watched(&mut watch).await;
        assert_eq!((tally.headers, tally.end), (1, Some(101)));
        let whole = tally.seen.len() as u64 + tally.gaps.iter().map(|range| range.len()).sum::<u64>();
        assert_eq!(whole, 101);
        assert_eq!(tally.events.len(), 2);
        drop(sink);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn eyes_are_told_the_end_and_a_question_of_another_length_is_told_what_is_wrong() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r3b").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let mut eyes = bus.subscribe(&keys::live_latest(&run), 64, Overflow::DropOldest).await.unwrap();
        let played = recording(1);
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        let over = loop {
            let message = eyes.next().await.unwrap().1;
            if message.len() == 16 {
                break message;
            }
        };
        assert_eq!((&over[..4], &over[8..]), (&[2, 0, 3, 0][..], &101_u64.to_le_bytes()[..]));
        for key in [keys::live_map(&run), keys::live_events(&run)] {
            let told = bus.query(&key, vec![1, 2, 3], WATCHDOG).await.unwrap();
            let told: serde_json::Value = serde_json::from_slice(&told).unwrap();
            assert!(told["error"].as_str().unwrap().contains("3 bytes"), "{told}");
            assert!(told["hint"].as_str().unwrap().contains("little endian"), "{told}");
        }
        let doors = bus.query(&keys::live_doors(&run), Vec::new(), WATCHDOG).await.unwrap();
        assert!(serde_json::from_slice::<serde_json::Value>(&doors).unwrap()["tick"].as_u64().unwrap() < 101);
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bytes_of_a_stranger_on_the_frame_key_harm_nobody() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r4").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 4096).await.unwrap();
        for len in [0_usize, 1, 63, 65] {
            bus.publish(&keys::live_agents(&run), vec![7; len], Qos::Stream).await.unwrap();
        }
        let played = recording(1);
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        let tally = watched(&mut watch).await;
        assert_eq!(tally.seen.len(), 101);
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_run_given_up_in_its_midst_ends_for_its_watchers_and_leaves_the_bus() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("r5").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &Linger::new(Duration::ZERO, 4))
            .await
            .unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 64).await.unwrap();
        let recording = recording(1);
        sink.announce(&recording.header);
        for tick in 0..7 {
            sink.tick(recording.tick(tick), &[]);
        }
        drop(sink);
        let tally = watched(&mut watch).await;
        assert_eq!((tally.seen.len(), tally.end), (7, Some(7)));
        while bus.query(&keys::live_meta(&run), vec![], PATIENCE).await.is_ok() {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
    })
    .await;
}

/// Many agents that walk in rows.
fn crowd(agents: u32, ticks: u64) -> Recording {
    let mut recording = recording(1);
    let info = recording.header.agents.last().unwrap().clone();
    let first = *recording.frames.first().unwrap();
    recording.header.agents = (1..=agents)
        .map(|number| AgentInfo {
            agent: AgentId::from_number(number),
            role: format!("walker {number}"),
            ..info.clone()
        })
        .collect();
    let state =
        |tick: u64, agent: u32| AgentState { tick, agent, flags: 1, x: f64::from(agent), y: tick as f64, ..first };
    recording.frames = (0..ticks)
        .flat_map(|tick| (1..=agents).map(move |agent| (tick, agent)))
        .map(|(tick, agent)| state(tick, agent))
        .collect();
    recording.events.clear();
    recording
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn three_thousand_agents_are_watched_whole() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("crowd").unwrap();
        let recording = crowd(3_000, 40);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 4096).await.unwrap();
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &played);
            sink
        });
        let mut frames = Vec::new();
        let mut header = None;
        loop {
            match watch.next(PATIENCE).await.unwrap().expect("the run ends") {
                Sight::Header(seen) => header = Some(seen),
                Sight::Tick { states, .. } => frames.extend(states),
                Sight::End { ticks, .. } => break assert_eq!(ticks, 40),
                other @ (Sight::Missing(_) | Sight::Event(_)) => panic!("{other:?}"),
            }
        }
        assert_eq!(header.unwrap(), recording.header);
        assert!(frames == recording.frames, "{} of {} states", frames.len(), recording.frames.len());
        // Parts of a large tick are fetched as they are sent.
        let fetched = watch.fetch(TickRange { from: 7, to: 8 }).await.unwrap();
        assert!(fetched == recording.frames[7 * 3_000..9 * 3_000]);
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_late_watcher_gets_every_tick_from_0_though_the_ring_has_passed_on() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("late").unwrap();
        let recording = recording(60);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let (half, halfway) = tokio::sync::oneshot::channel();
        let (go, gone) = std::sync::mpsc::sync_channel(1);
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            let mut writer = tape.record(&played.header, None).unwrap();
            let mut half = Some(half);
            sink.announce(&played.header);
            for tick in 0..played.ticks() {
                if tick == 5_000 {
                    half.take().unwrap().send(()).unwrap();
                    gone.recv().unwrap();
                }
                writer.tick(played.tick(tick)).unwrap();
                sink.tick(played.tick(tick), &[]);
            }
            writer.finish().unwrap();
            sink.end(&LiveEnd::default());
            sink
        });
        halfway.await.unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 4096).await.unwrap();
        // Older ticks than any ring holds, while the run goes on.
        let first = watch.fetch(TickRange { from: 0, to: 99 }).await.unwrap();
        assert!(first == recording.frames[..200]);
        go.send(()).unwrap();
        let mut states = BTreeMap::new();
        loop {
            match watch.next(PATIENCE).await.unwrap().expect("the run ends") {
                Sight::Tick { tick, states: now } => drop(states.insert(tick, now)),
                Sight::Missing(range) => {
                    let fetched = watch.fetch(range).await.unwrap();
                    assert_eq!(fetched.len() as u64, range.len() * 2);
                    fetched.chunks(2).for_each(|now| drop(states.insert(now[0].tick, now.to_vec())));
                }
                Sight::End { ticks, .. } => break assert_eq!(ticks, 6_001),
                Sight::Header(_) | Sight::Event(_) => {}
            }
        }
        assert!(watch.missing().is_empty());
        let all: Vec<AgentState> = states.into_values().flatten().collect();
        assert!(all == recording.frames, "{} of {} states", all.len(), recording.frames.len());
        // After the end too, as long as the run lingers.
        assert!(watch.fetch(TickRange { from: 10, to: 19 }).await.unwrap() == recording.frames[20..40]);
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn ticks_go_out_several_to_a_message() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let tape = Tape::default();
        let run = RunId::new("several").unwrap();
        let recording = recording(10);
        let mut heard = bus.subscribe(&keys::live_agents(&run), 4096, Overflow::DropOldest).await.unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, scene(), tape.clone(), &linger()).await.unwrap();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &tape, &recording);
            sink
        });
        let mut messages = 0;
        while heard.next().await.unwrap().1.len() != 16 {
            messages += 1;
        }
        assert!((101..400).contains(&messages), "{messages} messages for 1001 ticks");
        drop(sink.await.unwrap());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_version_tells_a_watcher_what_it_cannot_read() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let run = RunId::new("versions").unwrap();
        let mut sink =
            LiveSink::open(Arc::clone(&bus), &run, scene(), Tape::default(), &Linger::new(Duration::ZERO, 4))
                .await
                .unwrap();
        sink.announce(&recording(1).header);
        let reply = bus.query(&keys::live_meta(&run), Vec::new(), PATIENCE).await.unwrap();
        let said: serde_json::Value = serde_json::from_slice(&reply).unwrap();
        assert_eq!((&said["socrates"], &said["version"]), (&"run".into(), &3.into()));
        drop(sink);
        // One of a later version says which it is, and one before 3 spoke MessagePack.
        let old = RunId::new("old").unwrap();
        for (answer, found) in
            [(br#"{"socrates": "run", "version": 4, "header": 7}"#.to_vec(), 4), (vec![0x88, 0xa1, 0x76], 2)]
        {
            let mut door = bus.serve(&keys::live_served(&old)).await.unwrap();
            let served = tokio::spawn(async move { door.next().await.unwrap().reply(answer).await });
            let refused = Watch::open(Arc::clone(&bus), &old, 16).await.err().unwrap();
            served.await.unwrap().unwrap();
            assert!(
                format!("{refused:?}").contains(&format!("Incompatible {{ found: {found}, needs: 3")),
                "{refused:?}"
            );
        }
    })
    .await;
}

/// A scene on a map of 3 x 2 cells with a door.
fn told() -> (LiveScene, Grid) {
    let mut cells = vec![Cell::Free; 6];
    if let Some(first) = cells.first_mut() {
        *first = Cell::Occupied;
    }
    let grid = Grid { width: 3, height: 2, resolution_m: 0.5, origin: Pose::new(0.0, 0.0, 0.0), cells };
    let door = MissionDoor { id: "d1".into(), from: [0.0, 0.0], to: [1.0, 0.0] };
    let location = LivePlace { name: "hall".into(), map: MissionMap::of(&grid, &map_cells(&grid)) };
    let scene = LiveScene {
        location: Some(location),
        doors: vec![LiveDoor { door, open: false }],
        goal: Some([1.0, 2.0]),
        pace: Some(2.0),
        ..LiveScene::default()
    };
    (scene, grid)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_run_tells_its_scene_map_and_doors_and_with_its_end_how_it_is_recorded() {
    guarded(Box::pin(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let run = RunId::new("told").unwrap();
        let (scene, grid) = told();
        let mut recording = recording(1);
        recording
            .events
            .push(Event { time: SimTime::at_tick(60), kind: EventKind::Door { door: "d1".into(), open: true } });
        let tape = Tape::default();
        let mut sink =
            LiveSink::open(Arc::clone(&bus), &run, (scene.clone(), map_cells(&grid)), tape.clone(), &linger())
                .await
                .unwrap();
        let mut watch = Watch::open_as(Arc::clone(&bus), &run, 64, Sharpness::Newest).await.unwrap();
        let mut doors = bus.subscribe(&keys::live_doors(&run), 8, Overflow::DropOldest).await.unwrap();
        let end = LiveEnd { recording: Some(recording.hash()), file: None };
        let mut writer = tape.record(&recording.header, None).unwrap();
        sink.announce(&recording.header);
        for tick in 0..recording.ticks() {
            writer.tick(recording.tick(tick)).unwrap();
            sink.tick(recording.tick(tick), &events_at(&recording, tick));
        }
        writer.finish().unwrap();
        sink.end(&end);
        let mut newest = Vec::new();
        let mut events = 0;
        loop {
            match watch.next(PATIENCE).await.unwrap().expect("the run ends") {
                Sight::Header(header) => assert_eq!(header, recording.header),
                Sight::Tick { tick, .. } => newest.push(tick),
                Sight::Missing(range) => panic!("nothing is missing of the newest: {range:?}"),
                Sight::Event(_) => events += 1,
                Sight::End { ticks, end: told } => {
                    assert_eq!((ticks, told), (recording.ticks() as u64, end.clone()));
                    break;
                }
            }
        }
        assert_eq!(newest.last(), Some(&(recording.ticks() as u64 - 1)), "{newest:?}");
        assert!(newest.len() < 20, "{} of {} ticks in no time", newest.len(), recording.ticks());
        assert_eq!(events, 3);
        let said = &watch.told().unwrap().scene;
        assert_eq!((said.goal, said.pace, &said.location), (scene.goal, scene.pace, &scene.location));
        // The upper row is the last.
        assert_eq!(watch.map().await.unwrap(), [0, 0, 0, 100, 0, 0]);
        let mut turned = false;
        while let Some((_, body)) = doors.try_next() {
            turned = serde_json::from_slice::<LiveDoors>(&body).unwrap().doors[0].open;
        }
        assert!(turned);
        let now = bus.query(&keys::live_doors(&run), Vec::new(), PATIENCE).await.unwrap();
        assert!(serde_json::from_slice::<LiveDoors>(&now).unwrap().doors[0].open, "a late viewer asks");
        // Every run is found by one question.
        let all = bus.query_all(keys::RUNS, Vec::new(), 16, PATIENCE).await.unwrap();
        assert_eq!(all.len(), 1);
        let bad = bus.query(&keys::live_ctl(&run), b"frames!".to_vec(), PATIENCE).await.unwrap();
        assert!(String::from_utf8(bad).unwrap().contains("hint"));
    }))
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_many_finished_runs_the_last_stay_and_those_that_are_watched() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let linger = Linger::new(Duration::from_secs(30), 2);
        let recording = recording(1);
        let runs: Vec<RunId> = (0..6).map(|number| RunId::new(format!("short-{number}")).unwrap()).collect();
        let watched = runs.first().unwrap().clone();
        let mut watch = Watch::open(Arc::clone(&bus), &watched, 4096).await.unwrap();
        let mut done = Vec::new();
        for run in &runs {
            let tape = Tape::default();
            let mut sink = LiveSink::open(Arc::clone(&bus), run, scene(), tape.clone(), &linger).await.unwrap();
            let played = recording.clone();
            let playing = tokio::task::spawn_blocking(move || {
                play(&mut sink, &tape, &played);
                sink
            });
            done.push(playing.await.unwrap());
            if *run == watched {
                assert_eq!(self::watched(&mut watch).await.end, Some(101));
            }
        }
        // Two of the five others stay, and they are the last.
        let known = |run: RunId| {
            let bus = Arc::clone(&bus);
            async move { bus.query(&keys::live_meta(&run), vec![], PATIENCE).await.is_ok() }
        };
        let (mut stay, mut left) = (runs.clone(), runs.clone());
        left.retain(|run| ["short-1", "short-2", "short-3"].contains(&run.as_str()));
        stay.retain(|run| !left.contains(run));
        for run in left {
            while known(run.clone()).await {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
        }
        for run in stay {
            assert!(known(run.clone()).await, "{run}");
        }
        drop(done);
    })
    .await;
}

/// Bytes and texts of each version as they were when it was written down: readers of it still find them.
#[tokio::test]
async fn messages_of_every_version_are_read_as_they_were_written_down() {
    guarded(async {
        let meta = include_str!("data/live/meta-3.json");
        let read: LiveMeta = serde_json::from_str(meta).unwrap();
        assert_eq!((read.version, read.agents, read.scene.pace), (live::VERSION, 2, Some(2.0)));
        // Within a version keys may be added: what was said before is said still, and a message without them says nothing by them.
        let same = |text: &str, mut again: serde_json::Value| {
            let kept: serde_json::Value = serde_json::from_str(text).unwrap();
            if let (Some(old), Some(new)) = (kept.as_object(), again.as_object_mut()) {
                new.retain(|key, value| old.contains_key(key) || !value.is_null());
            }
            assert_eq!(kept, again);
        };
        same(meta, serde_json::to_value(&read).unwrap());
        let events = include_str!("data/live/events-3.json");
        same(events, serde_json::to_value(serde_json::from_str::<LiveEvents>(events).unwrap()).unwrap());
        let doors = include_str!("data/live/doors-3.json");
        same(doors, serde_json::to_value(serde_json::from_str::<LiveDoors>(doors).unwrap()).unwrap());
        // A run of a stranger that says only what is written down is watched to its end.
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let run = RunId::new("my-1.reference-1").unwrap();
        let mut asked = bus.serve(&keys::live_served(&run)).await.unwrap();
        let served = tokio::spawn(async move {
            while let Some(ask) = asked.next().await {
                match keys::live_topic(ask.key()) {
                    Some("meta") => ask.reply(meta.as_bytes().to_vec()).await.unwrap(),
                    _ => ask.reply(br#"{"first": 0, "events": []}"#.to_vec()).await.unwrap(),
                }
            }
        });
        let mut watch = Watch::open(Arc::clone(&bus), &run, 64).await.unwrap();
        for bytes in [&include_bytes!("data/live/ticks-2.bin")[..], include_bytes!("data/live/over-2.bin")] {
            bus.publish(&keys::live_agents(&run), bytes.to_vec(), Qos::Stream).await.unwrap();
        }
        let tally = watched(&mut watch).await;
        assert_eq!((tally.seen, tally.end), (vec![7, 8], Some(1200)));
        assert_eq!(watch.told().unwrap().ended.as_ref().unwrap().recording.unwrap().to_string(), "3".repeat(64));
        served.abort();
    })
    .await;
}
