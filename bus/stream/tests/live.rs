//! A run on the bus: every tick comes, or is listed and can be fetched.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests may fail the test")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, MemoryBus, Qos, keys};
use socrates_model::recording::{Event, EventKind, Recording};
use socrates_model::{RunId, SimTime};
use socrates_stream::{FrameSink as _, LiveSink, Sight, TickRange, Watch, csv};

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

fn play(sink: &mut LiveSink, recording: &Recording) {
    sink.announce(&recording.header);
    for tick in 0..recording.ticks() {
        for event in recording.events.iter().filter(|event| event.time.tick() == tick as u64) {
            sink.event(event);
        }
        sink.tick(tick as u64, recording.tick(tick));
    }
    sink.end(recording.ticks() as u64);
}

#[derive(Default)]
struct Tally {
    headers: usize,
    seen: Vec<u64>,
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
                assert_eq!(states.len(), 2);
                tally.seen.push(tick);
            }
            Sight::Missing(range) => tally.gaps.push(range),
            Sight::Event(event) => tally.events.push(event),
            Sight::End { ticks } => tally.end = Some(ticks),
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
        let run = RunId::new("r1").unwrap();
        let recording = recording(3);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, Duration::from_secs(30)).await.unwrap();
        let mut watch = Watch::open(bus, &run, 4096).await.unwrap();
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &played);
            sink
        });
        let tally = watched(&mut watch).await;
        assert_eq!(tally.headers, 1);
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
        let run = RunId::new("r2").unwrap();
        let recording = recording(20);
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, Duration::from_secs(30)).await.unwrap();
        // Room for few ticks, and nothing is read while the run goes on: most are lost.
        let mut watch = Watch::open(Arc::clone(&bus), &run, 16).await.unwrap();
        let mut fence = bus.subscribe(&keys::live_agents(&run), 1, socrates_link::Overflow::DropOldest).await.unwrap();
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &played);
            sink
        });
        // The end marker is the last message of the frame key.
        while fence.next().await.unwrap().1.len() != 64 {}
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
        let run = RunId::new("r3").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, Duration::from_secs(30)).await.unwrap();
        let recording = recording(1);
        let played = recording.clone();
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &played);
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
async fn bytes_of_a_stranger_on_the_frame_key_harm_nobody() {
    guarded(async {
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let run = RunId::new("r4").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, Duration::from_secs(30)).await.unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 4096).await.unwrap();
        for len in [0_usize, 1, 63, 65] {
            bus.publish(&keys::live_agents(&run), vec![7; len], Qos::Stream).await.unwrap();
        }
        let played = recording(1);
        let sink = tokio::task::spawn_blocking(move || {
            play(&mut sink, &played);
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
        let run = RunId::new("r5").unwrap();
        let mut sink = LiveSink::open(Arc::clone(&bus), &run, Duration::ZERO).await.unwrap();
        let mut watch = Watch::open(Arc::clone(&bus), &run, 64).await.unwrap();
        let recording = recording(1);
        sink.announce(&recording.header);
        for tick in 0..7 {
            sink.tick(tick as u64, recording.tick(tick));
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
