use super::*;
use socrates_model::AgentId;
use socrates_model::gesture::Gesture;
use socrates_model::recording::EventKind;

fn recording() -> Recording {
    let mut text = String::from("t,id,x,y\n");
    for n in 0..4 {
        text.push_str(&format!("{n},robot,{n},0\n{n},human_1,0,{n}\n"));
    }
    let mut recording = crate::csv::read_tracks(&text).unwrap();
    let gesture = |tick, gesture| Event {
        time: SimTime::at_tick(tick),
        kind: EventKind::Gesture { agent: AgentId::Robot, gesture },
    };
    recording.events = vec![
        gesture(3, Gesture::Wait),
        gesture(3, Gesture::None),
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
    let mut writer = Writer::new(Cursor::new(Vec::new())).unwrap();
    writer.finish().unwrap();
    let error = read(&writer.into_inner().into_inner()).unwrap_err().to_string();
    assert!(error.contains("no recording of ours") && error.contains("no message"), "{error}");
    let mut writer = Writer::new(Cursor::new(Vec::new())).unwrap();
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

#[test]
fn viewers_find_pictures_ten_times_a_second() {
    let recording = recording();
    let bytes = write(&recording, None).unwrap();
    let scenes = ::mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/scene")
        .collect::<Vec<_>>();
    // The ways, and one every tenth tick.
    assert_eq!(scenes.len(), 1 + recording.ticks().div_ceil(10));
    let last: serde_json::Value = serde_json::from_slice(&scenes.last().unwrap().data).unwrap();
    assert_eq!(last["entities"][1]["id"], "human_1");
    assert_eq!(last["entities"][1]["cylinders"][0]["pose"]["position"]["y"], 3.0);
    assert_eq!(scenes.last().unwrap().channel.schema.as_ref().unwrap().name, "foxglove.SceneUpdate");
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
