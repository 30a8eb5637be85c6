//! Viewers only read: whatever they send, the run is the same and the bus notices nothing.

use std::sync::atomic::Ordering;

use serde_json::json;
use socrates_gateway::guard::Rules;
use socrates_gateway::page::PROTOCOL;
use socrates_link::{MemoryBus, keys};
use tokio_tungstenite::tungstenite::Message;

use crate::stage::{Doors, Playing, guarded, recording};

/// Every message of Foxglove's protocol that a client can send, binary ones with their first bytes.
fn foxglove() -> Vec<Message> {
    let texts = [
        json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }, { "id": 2, "channelId": 2 }, { "id": 3, "channelId": 99 }] }),
        json!({ "op": "unsubscribe", "subscriptionIds": [2] }),
        json!({ "op": "advertise", "channels": [{ "id": 1, "topic": "/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist" }] }),
        json!({ "op": "unadvertise", "channelIds": [1] }),
        json!({ "op": "getParameters", "parameterNames": ["pace"], "id": "1" }),
        json!({ "op": "setParameters", "parameters": [{ "name": "pace", "value": 100 }], "id": "2" }),
        json!({ "op": "subscribeParameterUpdates", "parameterNames": ["pace"] }),
        json!({ "op": "unsubscribeParameterUpdates", "parameterNames": ["pace"] }),
        json!({ "op": "subscribeConnectionGraph" }),
        json!({ "op": "unsubscribeConnectionGraph" }),
        json!({ "op": "fetchAsset", "uri": "package://x/../../etc/passwd", "requestId": 1 }),
        json!({ "op": "drive", "v": 1.0 }),
    ];
    let published = [&[1_u8][..], &1_u32.to_le_bytes(), br#"{"linear":{"x":1}}"#].concat();
    let service = [&[2_u8][..], &[0; 12], &4_u32.to_le_bytes(), b"json{}"].concat();
    let playback =
        [&[3_u8, 0][..], &2.0_f32.to_le_bytes(), &[1], &5_u64.to_le_bytes(), &1_u32.to_le_bytes(), b"a"].concat();
    let binary = [published, service, playback, vec![9, 9, 9], Vec::new()];
    let texts = texts.iter().map(|text| Message::text(text.to_string()));
    texts.chain(binary.into_iter().map(Message::binary)).chain([Message::Ping(b"x".to_vec().into())]).collect()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn every_message_of_every_protocol_leaves_the_run_and_the_bus_as_they_are() {
    guarded(async {
        // What the run is without anybody.
        let alone = Playing::begin(&MemoryBus::new(), recording(3, 400)).await.end();
        let bus = MemoryBus::new();
        let mut run = Playing::begin(&bus, recording(3, 400)).await;
        let doors = Doors::open(&bus, Rules::default()).await;
        run.play(50);
        doors.json("/run/hall.reference-1/scene").await;
        let mut viewers = Vec::new();
        for message in foxglove() {
            let mut viewer = doors.socket("/run/hall.reference-1", "foxglove.sdk.v1").await;
            viewer.op("advertise").await;
            viewer.say(message).await;
            viewers.push(viewer);
            run.play(5);
        }
        for message in
            [json!({ "op": "rate", "hz": 60 }).to_string(), json!({ "op": "pause" }).to_string(), "{}".to_owned()]
        {
            let mut page = doors.socket("/run/hall.reference-1/ws", PROTOCOL).await;
            page.say(Message::text(message)).await;
            page.say(Message::binary(vec![0; 4])).await;
            viewers.push(page);
            run.play(5);
        }
        for path in ["/runs", "/run/hall.reference-1/frames?from=0&to=9", "/run/hall.reference-1/standing"] {
            assert_eq!(doors.ask(&format!("GET {path}"), &[]).await.0, 200, "{path}");
            doors.ask(&format!("POST {path}"), &[("Content-Length", "0")]).await;
        }
        assert_eq!(run.end(), alone, "the recording is the same");
        assert_eq!(doors.deeds.noticed.load(Ordering::Relaxed), 0, "nothing was published, served or declared");
        let asked = doors.deeds.asked.lock().unwrap().clone();
        assert!(!asked.is_empty());
        for key in asked {
            let reads = keys::covers("live/*/*", &key).unwrap() || key == keys::BLOB_GET;
            assert!(reads, "`{key}` was asked");
        }
    })
    .await;
}
