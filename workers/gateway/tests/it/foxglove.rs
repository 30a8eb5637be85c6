//! Foxglove's protocol over a socket.

use serde_json::{Value, json};
use socrates_gateway::guard::Rules;
use socrates_link::MemoryBus;
use tokio_tungstenite::tungstenite::Message;

use crate::stage::{Doors, Playing, guarded, recording};

fn channel(told: &Value, topic: &str) -> u64 {
    let channels = told["channels"].as_array().unwrap();
    channels.iter().find(|channel| channel["topic"] == topic).unwrap()["id"].as_u64().unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_viewer_of_either_name_is_advertised_topics_and_gets_their_messages() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(3, 4_000)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(30);
        for (path, protocol) in [("/", "foxglove.sdk.v1"), ("/run/hall.reference-1", "foxglove.websocket.v1")] {
            while doors.json("/runs").await["runs"].as_array().unwrap().is_empty() {}
            let mut viewer = doors.socket(path, protocol).await;
            let (info, _) = viewer.op("serverInfo").await;
            assert_eq!(info["capabilities"], json!(["time"]));
            let (told, _) = viewer.op("advertise").await;
            let subscriptions = json!([{ "id": 7, "channelId": channel(&told, "/tf") }, { "id": 8, "channelId": channel(&told, "/map") }]);
            viewer.json(&json!({ "op": "subscribe", "subscriptions": subscriptions })).await;
            let (mut maps, mut frames, mut times) = (0, 0, 0);
            while maps == 0 || frames < 3 || times < 3 {
                run.play(5);
                let bytes = viewer.bytes().await;
                match (bytes[0], bytes.get(1..5).map(|id| u32::from_le_bytes(id.try_into().unwrap()))) {
                    (1, Some(7)) => frames += 1,
                    (1, Some(8)) => maps += 1,
                    (2, _) => times += 1,
                    other => panic!("{other:?}"),
                }
            }
            assert_eq!(maps, 1, "the map is sent once");
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn frames_wait_for_the_answer_to_a_ping() {
    guarded(async {
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(2, 4_000)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(30);
        doors.json("/run/hall.reference-1/scene").await;
        let mut viewer = doors.socket("/run/hall.reference-1", "foxglove.sdk.v1").await;
        let (told, _) = viewer.op("advertise").await;
        let subscriptions = json!([{ "id": 1, "channelId": channel(&told, "/tf") }]);
        viewer.json(&json!({ "op": "subscribe", "subscriptions": subscriptions })).await;
        // The client answers a ping when it reads the next message: while it reads, frames come.
        for _ in 0..5 {
            run.play(20);
            viewer.bytes().await;
        }
        viewer.say(Message::text(json!({ "op": "advertise", "channels": [] }).to_string())).await;
        let (status, _) = viewer.op("status").await;
        assert!(status["message"].as_str().unwrap().contains("nothing of it reaches a run"), "{status}");
    })
    .await;
}
