use std::collections::BTreeMap;
use std::io::Cursor;

use ::mcap::records::MessageHeader;
use socrates_model::gesture::Gesture;
use socrates_model::recording::{AgentState, Event, EventKind, Recording};
use socrates_model::{AgentId, SimTime};

use super::*;
use crate::error::StreamError;

fn recording() -> Recording {
    let mut text = String::from("t,id,x,y\n");
    for n in 0..4 {
        text.push_str(&format!("{n},robot,{n},0\n{n},human_1,0,{n}\n"));
    }
    let mut recording = crate::csv::read_tracks(&text).unwrap();
    let gesture = |tick, gesture| Event {
        time: SimTime::at_tick(tick),
        kind: EventKind::Gesture { agent: AgentId::Robot, gesture, to: None },
    };
    recording.events = vec![
        gesture(3, Some(Gesture::Wait)),
        gesture(3, None),
        Event { time: SimTime::at_tick(400), kind: EventKind::End { reason: "done".into() } },
    ];
    recording
}

#[test]
fn what_is_written_is_read_and_the_bytes_are_the_same_again() {
    let recording = recording();
    let bytes = write(&recording, None).unwrap();
    assert_eq!(write(&recording, None).unwrap(), bytes);
    assert_eq!(read(&bytes).unwrap(), recording);
}

#[test]
fn a_cut_file_is_an_error_at_every_length() {
    let bytes = write(&recording(), None).unwrap();
    let step = (bytes.len() / 300).max(1);
    for cut in (0..bytes.len()).step_by(step).chain([bytes.len() - 1]) {
        assert!(read(&bytes[..cut]).is_err(), "cut at {cut} of {}", bytes.len());
    }
    assert!(read(b"").is_err());
    assert!(read(&[0; 5000]).is_err());
}

#[test]
fn a_cut_file_is_read_up_to_the_cut_and_says_so() {
    let recording = recording();
    let bytes = write(&recording, None).unwrap();
    assert_eq!(read_rest(&bytes).unwrap(), Rest { recording: recording.clone(), cut: None });
    let mut read = 0;
    for cut in (bytes.len() / 2..bytes.len()).step_by(7) {
        let Ok(rest) = read_rest(&bytes[..cut]) else { continue };
        read += 1;
        let there = rest.recording.frames.len();
        assert!(rest.cut.is_some() || there == recording.frames.len(), "cut at {cut}");
        assert_eq!(rest.recording.frames[..], recording.frames[..there]);
    }
    assert!(read > 0);
    assert!(
        read_rest(&bytes[..4]).is_err() && begins(&bytes[..4]) && begins(&bytes) && !begins(b"t,id") && !begins(b"")
    );
}

#[test]
fn a_flipped_bit_is_an_error_or_changes_nothing() {
    let recording = recording();
    let good = write(&recording, None).unwrap();
    let step = (good.len() / 400).max(1);
    for at in (0..good.len()).step_by(step) {
        let mut bad = good.clone();
        bad[at] ^= 0x11;
        if let Ok(read) = read(&bad) {
            assert_eq!(read.hash(), recording.hash(), "byte {at}");
        }
    }
}

#[test]
fn a_file_of_another_program_is_told_apart() {
    let mut writer = ::mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    writer.finish().unwrap();
    let error = read(&writer.into_inner().into_inner()).unwrap_err().to_string();
    assert!(error.contains("no recording of ours") && error.contains("no message"), "{error}");
    let mut writer = ::mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let schema = writer.add_schema("foxglove.PosesInFrame", "jsonschema", b"{}").unwrap();
    let channel_id = writer.add_channel(schema, "/people", "json", &BTreeMap::new()).unwrap();
    let header = MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    writer.write_to_known_channel(&header, b"{}").unwrap();
    writer.finish().unwrap();
    let error = read_rest(&writer.into_inner().into_inner()).unwrap_err();
    assert!(
        matches!(&error, StreamError::Foreign { topics } if topics == "`/people` (foxglove.PosesInFrame)"),
        "{error}"
    );
    assert!(!error.to_string().contains("damaged"), "{error}");
}

#[test]
fn a_recording_without_ticks_comes_back() {
    let mut recording = recording();
    recording.frames.clear();
    recording.events.clear();
    assert_eq!(read(&write(&recording, None).unwrap()).unwrap(), recording);
}

/// The fields of a protobuf message: number, and the bytes of its value.
fn fields(mut rest: &[u8]) -> Vec<(u64, Vec<u8>)> {
    fn varint(rest: &mut &[u8]) -> u64 {
        let mut value = 0;
        for place in 0.. {
            let byte = rest[0];
            *rest = &rest[1..];
            value |= u64::from(byte & 0x7f) << (7 * place);
            if byte < 0x80 {
                break;
            }
        }
        value
    }
    let mut found = Vec::new();
    while !rest.is_empty() {
        let tag = varint(&mut rest);
        let value = match tag & 7 {
            0 => varint(&mut rest).to_le_bytes().to_vec(),
            kind => {
                let len = if kind == 1 { 8 } else { usize::try_from(varint(&mut rest)).unwrap() };
                let (value, left) = rest.split_at(len);
                rest = left;
                value.to_vec()
            }
        };
        found.push((tag >> 3, value));
    }
    found
}

/// The values of one field, each of its messages.
fn all(message: &[u8], field: u64) -> Vec<Vec<u8>> {
    fields(message).into_iter().filter(|(number, _)| *number == field).map(|(_, value)| value).collect()
}

fn text(message: &[u8], field: u64) -> String {
    all(message, field).first().map(|value| String::from_utf8(value.clone()).unwrap()).unwrap_or_default()
}

fn double(message: &[u8], field: u64) -> f64 {
    all(message, field).first().map_or(0.0, |value| f64::from_le_bytes(value.as_slice().try_into().unwrap()))
}

/// The messages of a topic.
fn topic<'a>(bytes: &'a [u8], topic: &str) -> Vec<::mcap::Message<'a>> {
    let messages = ::mcap::MessageStream::new(bytes).unwrap().map(Result::unwrap);
    messages.filter(|message| message.channel.topic == topic).collect()
}

#[test]
fn viewers_find_bodies_once_and_places_ten_times_a_second() {
    let mut recording = recording();
    // The person waves from tick 150 on, and is gone from tick 250 on.
    recording.header.leaves = vec![String::new(), "walk".into(), socrates_model::recording::ABSENT_LEAF.into()];
    for state in recording.frames.iter_mut().filter(|state| state.agent == 1) {
        let gesture = if state.tick >= 150 { Some(Gesture::Wait) } else { None };
        state.flags = AgentState::flags(AgentId::from_number(1), gesture, if state.tick >= 250 { 2 } else { 1 });
    }
    let bytes = write(&recording, None).unwrap();
    let pictures = recording.ticks().div_ceil(10);

    let scenes = topic(&bytes, "/scene");
    let schema = scenes[0].channel.schema.clone().unwrap();
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("foxglove.SceneUpdate", "protobuf"));
    let names: Vec<Vec<String>> =
        scenes.iter().map(|scene| all(&scene.data, 2).iter().map(|entity| text(entity, 3)).collect()).collect();
    assert_eq!(names, [vec!["robot", "human_1"], vec!["human_1"], vec![], vec!["way_robot", "way_human_1"]]);
    // Body, heading and name are fixed to the person's own frame, so that nobody is drawn anew because they walk.
    let first = &all(&scenes[0].data, 2)[1];
    assert_eq!(text(first, 2), "human_1");
    assert_eq!((all(first, 7).len(), all(first, 10).len()), (1, 1));
    assert_eq!(text(&all(first, 13)[0], 6), "human_1");
    let waves = &all(&scenes[1].data, 2)[0];
    assert_eq!((text(&all(waves, 13)[0], 6), scenes[1].log_time), ("human_1: WAIT".to_owned(), 1_500_000_000));
    let gone = &all(&scenes[2].data, 1)[0];
    assert_eq!((text(gone, 3), scenes[2].log_time), ("human_1".to_owned(), 2_500_000_000));

    let frames = topic(&bytes, "/tf");
    assert_eq!(frames.len(), pictures);
    let moved = all(&frames[20].data, 1);
    assert_eq!(
        (text(&moved[0], 3), text(&moved[1], 3), text(&moved[1], 2)),
        ("robot".into(), "human_1".into(), "map".into())
    );
    let state = &recording.tick(200)[1];
    assert!((double(&all(&moved[1], 4)[0], 2) - state.y).abs() < 1e-12);
    assert_eq!(all(&frames[pictures - 1].data, 1).len(), 1, "who is absent has no place");

    // The people and the robot apart, for viewers that draw nothing else.
    let (people, robot) = (topic(&bytes, "/crowd"), topic(&bytes, "/robot"));
    assert_eq!((people.len(), robot.len()), (pictures, pictures));
    assert_eq!(all(&people[20].data, 3).len(), 1);
    assert!((double(&all(&all(&people[20].data, 3)[0], 1)[0], 2) - state.y).abs() < 1e-12);
    assert_eq!(robot[0].channel.schema.as_ref().unwrap().name, "foxglove.PoseInFrame");
}

#[test]
fn a_foreign_reader_learns_from_the_schema_where_each_number_of_a_state_is() {
    let recording = recording();
    let bytes = write(&recording, None).unwrap();
    let ticks = topic(&bytes, AGENTS);
    let schema = ticks[0].channel.schema.clone().unwrap();
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("socrates.AgentState.v1", "jsonschema"));
    let known: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
    let len = usize::try_from(known["x-record-bytes"].as_u64().unwrap()).unwrap();
    let record = &ticks[203].data[len..2 * len];
    let read = |name: &str| {
        let field = &known["items"]["properties"][name];
        let at = usize::try_from(field["x-offset"].as_u64().unwrap()).unwrap();
        let eight = || record[at..at + 8].try_into().unwrap();
        match field["format"].as_str().unwrap() {
            "float64" => f64::from_le_bytes(eight()),
            "uint64" => u64::from_le_bytes(eight()) as f64,
            _ => f64::from(u32::from_le_bytes(record[at..at + 4].try_into().unwrap())),
        }
    };
    let state = &recording.tick(203)[1];
    let found: Vec<f64> =
        ["tick", "agent", "flags", "x", "y", "yaw", "vx", "vy", "omega"].into_iter().map(read).collect();
    let expected = [
        state.tick as f64,
        f64::from(state.agent),
        f64::from(state.flags),
        state.x,
        state.y,
        state.yaw,
        state.vx,
        state.vy,
        state.omega,
    ];
    assert_eq!(found, expected);
}

/// Tracks of two agents for so long.
fn long(seconds: u32) -> Recording {
    let mut text = String::from("t,id,x,y\n");
    for n in 0..=seconds {
        text.push_str(&format!("{n},robot,{n},0\n{n},human_1,0,{n}\n"));
    }
    crate::csv::read_tracks(&text).unwrap()
}

#[test]
fn a_run_that_breaks_off_leaves_a_recording_up_to_its_last_chunk() {
    let recording = long(25);
    let tape = Tape::default();
    let mut writer = tape.record(&recording.header, None).unwrap();
    for tick in 0..recording.ticks() {
        writer.tick(recording.tick(tick)).unwrap();
        let there = tape.ticks();
        assert!(tick as u64 - there <= 1_000, "tick {tick}: {there} are in the file");
    }
    // Nobody ends it, as when a process is killed.
    let bytes = tape.bytes();
    std::mem::forget(writer);
    let rest = read_rest(&bytes).unwrap();
    assert!(rest.cut.is_some());
    assert_eq!(rest.recording.ticks(), 2_000);
    assert_eq!(rest.recording.frames[..], recording.frames[..4_000]);
    assert!(read(&bytes).is_err());
}

#[test]
fn what_is_written_tick_by_tick_is_what_is_written_at_once() {
    let recording = recording();
    let mut writer = Writer::begin(Vec::new(), &recording.header, None).unwrap();
    for tick in 0..recording.ticks() {
        writer.tick(recording.tick(tick)).unwrap();
        let now = recording.events.iter().filter(|event| event.time.tick() == tick as u64);
        now.for_each(|event| writer.event(event).unwrap());
    }
    let late = recording.events.iter().filter(|event| event.time.tick() >= recording.ticks() as u64);
    late.for_each(|event| writer.event(event).unwrap());
    let (bytes, whole) = writer.finish().unwrap();
    assert_eq!(bytes, write(&recording, None).unwrap());
    let expected = Whole { ticks: recording.ticks() as u64, events: 3, hash: recording.hash() };
    assert_eq!(whole, expected);
}

#[test]
fn the_ways_of_a_long_run_take_no_more_room_than_those_of_a_short_one() {
    let recording = long(1);
    let mut painter = scene::Painter::new(&recording.header);
    for tick in 0..4_000_000_u64 {
        painter.follow(tick, recording.tick(0));
    }
    // Some bytes for each of at most 128 Ki points.
    assert!(painter.ways().bytes().len() < 128 * 1024 * 32);
}

#[test]
fn a_recording_of_an_older_version_is_read() {
    // As version 1 wrote them: no schema for the states, pictures as JSON.
    let recording = recording();
    let mut writer = ::mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let schema = writer.add_schema("socrates.Header", "jsonschema", br#"{"type":"object"}"#).unwrap();
    let channel = |writer: &mut ::mcap::Writer<_>, schema, topic: &str, encoding: &str| {
        writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
    };
    let header = channel(&mut writer, schema, HEADER, "json");
    let agents = channel(&mut writer, 0, AGENTS, "socrates.AgentState.v1");
    let events = channel(&mut writer, schema, EVENTS, "json");
    let end = channel(&mut writer, schema, END, "json");
    let pictures = channel(&mut writer, schema, "/scene", "json");
    let mut put = |channel_id, tick: u64, data: &[u8]| {
        let log_time = SimTime::at_tick(tick).nanos();
        let header = MessageHeader { channel_id, sequence: 0, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, data).unwrap();
    };
    put(header, 0, &serde_json::to_vec(&recording.header).unwrap());
    for tick in 0..recording.ticks() {
        let bytes: Vec<u8> = recording.tick(tick).iter().flat_map(AgentState::to_bytes).collect();
        put(agents, tick as u64, &bytes);
        put(pictures, tick as u64, br#"{"deletions":[],"entities":[]}"#);
    }
    for event in &recording.events {
        put(events, event.time.tick(), &serde_json::to_vec(event).unwrap());
    }
    let whole = End { ticks: recording.ticks() as u64, events: 3, hash: recording.hash() };
    put(end, 400, &serde_json::to_vec(&whole).unwrap());
    writer.finish().unwrap();
    assert_eq!(read(&writer.into_inner().into_inner()).unwrap(), recording);
}

/// Bytes of a recording in which one number was changed before it was written.
fn with(change: impl Fn(&mut Recording)) -> Vec<u8> {
    let mut recording = recording();
    change(&mut recording);
    write(&recording, None).unwrap()
}

#[test]
fn numbers_that_nobody_can_walk_are_refused_with_agent_tick_and_value() {
    let cases: [(Vec<u8>, &[&str]); 6] = [
        (with(|recording| recording.frames[7].y = 2.1e265), &["human_1", "y", "2.1e265", "tick 3"]),
        (with(|recording| recording.frames[4].x = f64::NAN), &["robot", "x", "NaN", "tick 2"]),
        (with(|recording| recording.frames[0].vx = -1e9), &["robot", "vx", "-1e9"]),
        (with(|recording| recording.header.step_s = 1e300), &["step_s"]),
        (with(|recording| recording.header.agents[1].radius_m = -1.0), &["radius_m", "human_1", "-1"]),
        (with(|recording| recording.events[2].time = SimTime::from_nanos(u64::MAX)), &["event", "e10 s"]),
    ];
    for (bytes, words) in cases {
        for error in [read(&bytes).unwrap_err().to_string(), read_rest(&bytes).unwrap_err().to_string()] {
            assert!(words.iter().all(|word| error.contains(word)), "{words:?} in {error}");
        }
    }
}

#[test]
fn a_damaged_chunk_is_dropped_whole_and_a_cut_one_is_read_up_to_the_cut() {
    let recording = recording();
    let mut bytes = write(&recording, None).unwrap();
    // Magic, header record, then the first chunk: its checksum stands 24 bytes into it.
    let header = u64::from_le_bytes(bytes[9..17].try_into().unwrap()) as usize;
    let chunk = 17 + header;
    assert_eq!(bytes[chunk], 6);
    bytes[chunk + 9 + 24] ^= 1;
    let error = read_rest(&bytes).unwrap_err().to_string();
    assert!(error.contains("crc") || error.contains("CRC"), "{error}");
}
