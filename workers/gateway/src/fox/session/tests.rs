use super::*;
use crate::fox::facts::{Facts, Frame};
use serde_json::{Value, json};
use socrates_model::recording::{AgentInfo, AgentState, Event, EventKind};
use socrates_model::{AgentId, Gesture};

fn stage() -> Stage {
    let agents = [0, 1].map(|number| AgentInfo {
        agent: AgentId::from_number(number),
        radius_m: 0.3,
        speed_mps: 1.0,
        role: "nurse".to_owned(),
    });
    Stage::new(&Facts { agents: &agents, way: &[[0.0, 0.0], [1.0, 0.0]], ..Facts::default() })
}

fn state(agent: u32) -> AgentState {
    let flags = AgentState::flags(AgentId::from_number(agent), Some(Gesture::Wait), 1);
    AgentState { tick: 3, agent, flags, x: 1.0, y: 2.0, yaw: 0.0, vx: 0.0, vy: 0.0, omega: 0.0 }
}

fn live(stage: &Stage) -> Session {
    Session::new("run 1", None, "s1", stage.offers())
}

fn kept(stage: &Stage) -> Session {
    Session::new("run 1", Some((0, 60_000_000_000)), "s1", stage.offers())
}

fn texts(out: &[Out]) -> Vec<Value> {
    let text = |out: &Out| match out {
        Out::Text(text) => Some(serde_json::from_str(text).unwrap()),
        Out::Binary(_) | Out::Data { .. } => None,
    };
    out.iter().filter_map(text).collect()
}

fn said(heard: &Heard) -> Vec<String> {
    texts(&heard.out).iter().map(|status| status["message"].as_str().unwrap().to_owned()).collect()
}

fn subscribe(pairs: &[(u32, u64)]) -> String {
    let list: Vec<Value> = pairs.iter().map(|(id, channel)| json!({"id": id, "channelId": channel})).collect();
    json!({"op": "subscribe", "subscriptions": list}).to_string()
}

fn control(command: u8, speed: f32, seek: Option<u64>, request: &str) -> Vec<u8> {
    let mut out = vec![3, command];
    out.extend(speed.to_le_bytes());
    out.push(u8::from(seek.is_some()));
    out.extend(seek.unwrap_or(0).to_le_bytes());
    out.extend(u32::try_from(request.len()).unwrap().to_le_bytes());
    out.extend(request.as_bytes());
    out
}

#[test]
fn the_opening_says_who_speaks_and_what_there_is() {
    let stage = stage();
    let out = texts(&live(&stage).opening());
    assert_eq!((out.len(), &out[0]["op"], &out[1]["op"]), (2, &json!("serverInfo"), &json!("advertise")));
    assert_eq!((&out[0]["capabilities"], out[0].get("dataStartTime")), (&json!(["time"]), None));
    let topics: Vec<&str> =
        out[1]["channels"].as_array().unwrap().iter().map(|channel| channel["topic"].as_str().unwrap()).collect();
    assert_eq!(topics, ["/scene", "/tf", "/robot/plan", "/robot/odom", "/events", "/socrates/labels"]);
    let opening = kept(&stage).opening();
    let info = &texts(&opening)[0];
    assert_eq!(info["capabilities"], json!(["time", "playbackControl"]));
    assert_eq!(info["dataEndTime"], json!({"sec": 60, "nsec": 0}));
    // The npm client, and with it Lichtblick, knows no state of a playback: it is told nothing that it did not ask for.
    assert_eq!(opening.len(), 2);
    let playback = kept(&stage).playback().unwrap();
    assert_eq!((playback.playing, playback.at, playback.end), (true, 0, 60_000_000_000));
}

#[test]
fn one_that_subscribes_is_given_what_it_missed_and_then_what_it_wants_alone() {
    let mut stage = stage();
    let mut viewer = live(&stage);
    let states = [state(0), state(1)];
    let frame = Frame { time: SimTime::at_tick(3), states: &states, scan: None };
    assert!(stage.frame(&frame, viewer.wanted()).is_empty());
    stage.event(&Event { time: SimTime::at_tick(3), kind: EventKind::RobotArrived }, "arrived", Topics::NONE);
    let (scene, frames, events) = (Topic::Scene.id(), Topic::Frames.id(), Topic::Events.id());
    let pairs = [(70, scene.into()), (71, frames.into()), (72, events.into())];
    let heard = viewer.hear(Inbound::Text(&subscribe(&pairs)), &stage);
    assert_eq!((heard.fresh, heard.asks.len()), (viewer.wanted(), 0));
    // The scene and the event, each with the viewer's own number; `/tf` comes with the next frame.
    let heads: Vec<u8> = heard.out.iter().map(|out| out.clone().into_bytes()[1]).collect();
    assert_eq!(heads, [70, 72]);
    assert!(viewer.wants(Topic::Scene) && viewer.wants(Topic::Frames) && !viewer.wants(Topic::Plan));
    let messages = stage.frame(&frame, viewer.wanted());
    let given: Vec<Out> = messages.iter().filter_map(|message| viewer.give(message)).collect();
    let [Out::Data { head, payload }] = given.as_slice() else { panic!("{given:?}") };
    assert_eq!(*head, message_head(71, 30_000_000));
    // What is sent is the same memory for every viewer.
    assert_eq!(payload.as_ptr(), messages[0].payload.as_ptr());
    let joined = given[0].clone().into_bytes();
    assert_eq!((joined.len(), &joined[..13], &joined[13..]), (given[0].len(), &head[..], &messages[0].payload[..]));
    assert_eq!(viewer.caught_up(&stage).len(), 2);
    let heard = viewer.hear(Inbound::Text(r#"{"op":"unsubscribe","subscriptionIds":[70,71]}"#), &stage);
    assert_eq!((heard, viewer.wanted()), (Heard::default(), Topics::NONE.with(Topic::Events)));
    assert!(viewer.give(&messages[0]).is_none());
}

#[test]
fn subscriptions_that_cannot_be_are_named_and_change_nothing() {
    let stage = stage();
    let mut viewer = live(&stage);
    let scene = u64::from(Topic::Scene.id());
    viewer.hear(Inbound::Text(&subscribe(&[(1, scene)])), &stage);
    let crowd = u64::from(Topic::Crowd.id());
    for (pairs, wrong) in [
        ((2, 9_999), "asks for channel 9999, which is not advertised; channels: 2 /scene, 3 /tf"),
        ((2, crowd), "asks for channel 4, which is not advertised"),
        ((2, scene), "asks for channel 2 a second time"),
        ((1, scene + 1), "gives the id 1 a second time"),
    ] {
        let heard = viewer.hear(Inbound::Text(&subscribe(&[pairs])), &stage);
        assert!(said(&heard).len() == 1 && said(&heard)[0].contains(wrong), "{heard:?}");
        assert_eq!((viewer.wanted(), heard.fresh), (Topics::NONE.with(Topic::Scene), Topics::NONE));
    }
    let heard = viewer.hear(Inbound::Text(r#"{"op":"unsubscribe","subscriptionIds":[5]}"#), &stage);
    assert!(said(&heard)[0].contains("names the id 5, which no subscription has"));
}

#[test]
fn whatever_else_a_viewer_sends_is_answered_and_asks_for_nothing() {
    let stage = stage();
    let mut viewer = live(&stage);
    let inbounds = [
        Inbound::Text(
            r#"{"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel","encoding":"json","schemaName":"Twist"}]}"#,
        ),
        Inbound::Binary(&[1, 1, 0, 0, 0, 0x7b, 0x7d]),
        Inbound::Text(r#"{"op":"setParameters","parameters":[{"name":"pace","value":9}]}"#),
        Inbound::Text(r#"{"op":"getParameters","parameterNames":[]}"#),
        Inbound::Binary(&[2, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]),
        Inbound::Text(r#"{"op":"fetchAsset","uri":"file:///etc/passwd","requestId":1}"#),
        Inbound::Text(r#"{"op":"subscribeConnectionGraph"}"#),
    ];
    let before = viewer.clone();
    for inbound in inbounds {
        let heard = viewer.hear(inbound, &stage);
        assert!(said(&heard)[0].contains("viewers here only read, nothing of it reaches a run"), "{heard:?}");
        assert_eq!((heard.asks.len(), texts(&heard.out)[0]["level"].clone()), (0, json!(1)));
    }
    let heard = viewer.hear(Inbound::Binary(&control(0, 1.0, None, "r1")), &stage);
    assert!(said(&heard)[0].contains("this run goes on by itself") && heard.asks.is_empty());
    assert_eq!((viewer.wanted(), viewer.playback()), (before.wanted(), None));
}

#[test]
fn one_that_sends_nonsense_is_told_so_twenty_times_and_not_for_ever() {
    let stage = stage();
    let mut viewer = live(&stage);
    let told: Vec<usize> =
        (0..40).map(|_| viewer.hear(Inbound::Text(r#"{"op":"nonsense"}"#), &stage).out.len()).collect();
    assert_eq!((told[..21].iter().sum::<usize>(), told[21..].iter().sum::<usize>()), (21, 0));
    // It is heard all the same.
    viewer.hear(Inbound::Text(&subscribe(&[(1, Topic::Scene.id().into())])), &stage);
    assert!(viewer.wants(Topic::Scene));
}

#[test]
fn something_kept_is_played_stopped_and_wound_within_its_range() {
    let stage = stage();
    let mut viewer = kept(&stage);
    let heard = viewer.hear(Inbound::Binary(&control(0, 2.0, Some(5_000_000_000), "r1")), &stage);
    let ask = Ask::Play { playing: true, speed: 2.0, seek: Some(SimTime::from_nanos(5_000_000_000)) };
    assert_eq!(heard.asks, [ask]);
    let answer = playback_state(PlaybackStatus::Playing, 5_000_000_000, 2.0, true, "r1");
    assert_eq!(heard.out, [Out::Binary(answer.into())]);
    let heard = viewer.hear(Inbound::Binary(&control(1, 2.0, None, "r2")), &stage);
    let answer = playback_state(PlaybackStatus::Paused, 5_000_000_000, 2.0, false, "r2");
    assert_eq!(heard.out, [Out::Binary(answer.into())]);
    // Beyond the end is the end.
    let heard = viewer.hear(Inbound::Binary(&control(1, 1.0, Some(u64::MAX), "r3")), &stage);
    assert_eq!(viewer.playback().unwrap().at, 60_000_000_000);
    assert_eq!(heard.asks, [Ask::Play { playing: false, speed: 1.0, seek: Some(SimTime::from_nanos(60_000_000_000)) }]);
    for speed in [0.0, -1.0, 1e9, f32::NAN, f32::INFINITY] {
        let before = viewer.playback();
        let mut other = viewer.clone();
        let heard = other.hear(Inbound::Binary(&control(0, speed, Some(1), "r4")), &stage);
        assert!(said(&heard)[0].contains("allowed: 0.01 to 100"), "{heard:?}");
        assert_eq!((other.playback(), heard.asks.len(), heard.out.len()), (before, 0, 2));
    }
}

#[test]
fn the_end_of_something_kept_is_told_once() {
    let stage = stage();
    let mut viewer = kept(&stage);
    viewer.hear(Inbound::Binary(&control(0, 1.0, None, "r1")), &stage);
    assert_eq!(viewer.moved(SimTime::from_nanos(30_000_000_000)), None);
    let ended = playback_state(PlaybackStatus::Ended, 60_000_000_000, 1.0, false, "");
    assert_eq!(viewer.moved(SimTime::from_nanos(60_000_000_000)), Some(Out::Binary(ended.into())));
    assert_eq!(viewer.moved(SimTime::from_nanos(61_000_000_000)), None);
    assert_eq!(live(&stage).moved(SimTime::at_tick(1)), None);
    let mut without_keys = kept(&stage);
    assert_eq!(without_keys.moved(SimTime::from_nanos(60_000_000_000)), None);
    assert_eq!(without_keys.playback().unwrap().at, 60_000_000_000);
}

#[test]
fn another_run_takes_back_the_channels_of_the_one_before() {
    let stage = stage();
    let mut viewer = live(&stage);
    viewer.hear(Inbound::Text(&subscribe(&[(1, Topic::Scene.id().into())])), &stage);
    let out = texts(&viewer.restart("run 2", None, "s2", Topics::NONE.with(Topic::Frames)));
    assert_eq!(out[0], json!({"op": "unadvertise", "channelIds": [2, 3, 6, 7, 8, 9]}));
    assert_eq!(
        (&out[1]["op"], &out[1]["sessionId"], &out[1]["name"]),
        (&json!("serverInfo"), &json!("s2"), &json!("run 2"))
    );
    assert_eq!(out[2]["channels"].as_array().unwrap().len(), 1);
    assert!(viewer.wanted().is_empty());
    // A viewer ends what it had by itself when it hears that: no reason to complain, once.
    let ends = r#"{"op":"unsubscribe","subscriptionIds":[1]}"#;
    assert_eq!(viewer.hear(Inbound::Text(ends), &stage), Heard::default());
    assert_eq!(viewer.hear(Inbound::Text(ends), &stage).out.len(), 1);
}

#[test]
fn the_time_is_the_same_nine_bytes_for_everybody() {
    assert_eq!(Session::time(SimTime::at_tick(200)).into_bytes().as_ref(), protocol::time(2_000_000_000));
}
