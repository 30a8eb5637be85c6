//! Our own page's socket and data.

use std::time::Duration;

use serde_json::json;
use socrates_gateway::guard::Rules;
use socrates_gateway::page::PROTOCOL;
use socrates_link::MemoryBus;
use tokio_tungstenite::tungstenite::Message;

use crate::stage::{Doors, Playing, guarded, recording};

fn number(frame: &[u8]) -> u32 {
    u32::from_le_bytes(frame[12..16].try_into().unwrap())
}

fn tick(frame: &[u8]) -> u64 {
    u64::from_le_bytes(frame[4..12].try_into().unwrap())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_page_is_told_the_scene_first_and_gets_frames_events_and_the_end() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(3, 200)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(10);
        let scene = doors.json("/run/hall.reference-1/scene").await;
        assert_eq!((&scene["state"], &scene["location"]), (&json!("live"), &json!("hall")));
        assert_eq!(scene["agents"][1]["role"], "<b>visitor</b>", "as it is: the page sets it as text");
        assert_eq!(scene["doors"][0]["open"], false);
        let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
        let (told, _) = page.op("scene").await;
        assert_eq!(told["scene"]["run"], "hall.reference-1");
        run.play(100);
        let (events, before) = page.op("events").await;
        let mut frames = before;
        assert_eq!((&events["from"], &events["events"][0]["kind"]), (&json!(0), &json!("sees")));
        while frames.last().is_none_or(|frame| tick(frame) < 109) {
            let frame = page.bytes().await;
            page.say(Message::binary(frame[12..16].to_vec())).await;
            frames.push(frame);
        }
        let last = frames.last().unwrap();
        assert_eq!(last.len(), 32 + 3 * 16 + 720, "three records and a scan");
        let x = f32::from_le_bytes(last[32..36].try_into().unwrap());
        assert!((f64::from(x) - run.recording.tick(109)[0].x).abs() < 1e-6, "{x}");
        let flags = u16::from_le_bytes(last[32 + 16 + 14..32 + 32].try_into().unwrap());
        assert_eq!(flags & 0x3f, 0x30, "there, and sees the robot that comes");
        let ahead_mm = u16::from_le_bytes(last[80..82].try_into().unwrap());
        assert!((5_700..5_900).contains(&ahead_mm), "{ahead_mm} mm to the wall behind the door, which is open by then");
        let hash = run.end();
        let (end, _) = page.op("end").await;
        assert_eq!(end["recording"], json!(hash));
        // The past is there to the tick.
        let (status, _, past) = doors.ask("GET /run/hall.reference-1/frames?from=50&to=59&every=3", &[]).await;
        let size = 32 + 3 * 16 + 720;
        assert_eq!((status, past.len()), (200, 4 * size));
        assert_eq!(past.chunks(size).map(tick).collect::<Vec<_>>(), [50, 53, 56, 59]);
        let all = doors.json("/run/hall.reference-1/events").await;
        assert_eq!(all["events"].as_array().unwrap().len(), 3);
        let runs = doors.json("/runs").await;
        assert_eq!((&runs["runs"][0]["run"], &runs["runs"][0]["state"]), (&json!("hall.reference-1"), &json!("ended")));
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_crowd_of_whom_an_announcement_names_the_first_is_told_whole() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(1_500, 60)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(30);
        let scene = doors.json("/run/hall.reference-1/scene").await;
        assert_eq!(scene["agents"].as_array().unwrap().len(), 1_500);
        let (status, _, past) = doors.ask("GET /run/hall.reference-1/frames?from=7&to=21&every=7", &[]).await;
        let size = 32 + 1_500 * 16;
        assert_eq!((status, past.len()), (200, 3 * size));
        assert_eq!(past.chunks(size).map(tick).collect::<Vec<_>>(), [7, 14, 21]);
        let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
        page.op("scene").await;
        run.play(10);
        assert_eq!(page.bytes().await.len(), size);
        run.end();
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_frames_are_on_their_way_and_the_next_is_the_newest() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 3_000)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(1);
        let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
        page.op("scene").await;
        page.json(&json!({ "op": "rate", "hz": 60 })).await;
        // Nothing is acknowledged: two come, and no third however long the run goes on.
        let first = page.bytes().await;
        run.play(100);
        let second = page.bytes().await;
        for _ in 0..5 {
            run.play(100);
            let third = tokio::time::timeout(Duration::from_millis(120), page.bytes()).await;
            assert!(third.is_err(), "a third frame came unasked");
        }
        page.say(Message::binary(number(&first).to_le_bytes().to_vec())).await;
        let third = page.bytes().await;
        assert_eq!(tick(&third), 600, "none of those between");
        page.say(Message::binary(number(&second).to_le_bytes().to_vec())).await;
        let (lag, _) = page.op("lag").await;
        assert!(lag["ms"].as_f64().unwrap() > 0.0 && lag["skipped"].as_u64().unwrap() > 0, "{lag}");
        drop(run);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_page_that_says_something_else_is_told_why_and_let_go() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 100)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(1);
        for (wrong, words) in [
            (Message::text("{\"op\":\"pause\"}"), "not understood"),
            (Message::text("{\"op\":\"rate\",\"hz\":1e9}"), "1 to 60"),
            (Message::binary(vec![1, 2, 3]), "4 bytes"),
        ] {
            let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
            page.op("scene").await;
            page.say(wrong).await;
            let (status, _) = page.op("status").await;
            assert!(status["text"].as_str().unwrap().contains(words), "{status}");
            while page.next().await.is_some() {}
        }
        // One that is too large is not read at all.
        let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
        page.say(Message::text("x".repeat(1 << 20))).await;
        while page.next().await.is_some() {}
    })
    .await;
}
