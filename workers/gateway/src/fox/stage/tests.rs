use super::*;
use crate::fox::facts::Door;
use foxglove::messages::{
    FrameTransforms, Grid as Map, LaserScan, Log, Odometry, PointCloud, PosesInFrame, SceneUpdate,
};
use foxglove::{Decode, Encode};
use socrates_model::grid::{Cell, Grid};
use socrates_model::recording::AgentInfo;
use socrates_model::{AgentId, Pose};

/// Index of the leaf of those who are not there.
const ABSENT: u16 = 3;

fn everybody(people: u32) -> Vec<AgentInfo> {
    (0..=people)
        .map(|number| AgentInfo {
            agent: AgentId::from_number(number),
            radius_m: 0.3,
            speed_mps: 1.2,
            role: if number == 0 { "robot".to_owned() } else { "nurse".to_owned() },
        })
        .collect()
}

fn stage(agents: &[AgentInfo]) -> Stage {
    let doors = [Door { id: "ward", from: [0.0, 1.0], to: [1.0, 1.0], open: false }];
    let grid = Grid {
        width: 2,
        height: 1,
        resolution_m: 1.0,
        origin: Pose::new(0.0, 0.0, 0.0),
        cells: vec![Cell::Free, Cell::Occupied],
    };
    Stage::new(&Facts {
        agents,
        absent: Some(ABSENT),
        grid: Some(&grid),
        doors: &doors,
        way: &[[0.0, 0.0], [5.0, 0.0]],
        goal: Some([5.0, 0.0]),
        scans: true,
    })
}

/// Person k stands k m to the right of the robot.
fn states(people: u32, flags: impl Fn(u32) -> u32) -> Vec<AgentState> {
    let at = |agent| AgentState {
        tick: 0,
        agent,
        flags: flags(agent),
        x: f64::from(agent),
        y: 0.0,
        yaw: 0.0,
        vx: 1.0,
        vy: 0.0,
        omega: 0.0,
    };
    (0..=people).map(at).collect()
}

fn flags(agent: u32, gesture: Option<Gesture>, leaf: u16) -> u32 {
    AgentState::flags(AgentId::from_number(agent), gesture, leaf)
}

fn show(stage: &mut Stage, tick: u64, states: &[AgentState], wanted: Topics) -> Vec<Message> {
    stage.frame(&Frame { time: SimTime::at_tick(tick), states, scan: Some(&[1.0; 360]) }, wanted)
}

fn only(topic: Topic) -> Topics {
    Topics::NONE.with(topic)
}

fn payload(messages: &[Message], topic: Topic) -> Bytes {
    let found: Vec<&Message> = messages.iter().filter(|message| message.topic == topic).collect();
    assert_eq!(found.len(), 1, "{topic:?}");
    found[0].payload.clone()
}

fn ids(scene: &SceneUpdate) -> Vec<&str> {
    scene.entities.iter().map(|entity| entity.id.as_str()).collect()
}

#[test]
fn what_there_is_not_is_not_offered() {
    let full = stage(&everybody(2)).offers();
    assert!(!full.has(Topic::Crowd) && !full.has(Topic::Agents) && full.has(Topic::Scan) && full.has(Topic::Map));
    let people: Vec<AgentInfo> = everybody(2).split_off(1);
    let bare = Stage::new(&Facts { agents: &people, ..Facts::default() });
    assert_eq!(bare.offers().iter().collect::<Vec<_>>(), [Topic::Scene, Topic::Frames, Topic::Events, Topic::Labels]);
    assert!(bare.with_records().offers().has(Topic::Agents));
    assert!(stage(&everybody(200)).offers().has(Topic::Crowd));
}

#[test]
fn shapes_are_sent_when_somebody_comes_or_goes_and_else_never() {
    let mut stage = stage(&everybody(2));
    let wanted = only(Topic::Scene) | only(Topic::Frames);
    let gone = |agent| flags(agent, None, if agent == 2 { ABSENT } else { 1 });
    let first = show(&mut stage, 0, &states(2, gone), wanted);
    let scene = SceneUpdate::decode(payload(&first, Topic::Scene)).unwrap();
    assert_eq!(ids(&scene), ["goal", "door_ward", "robot", "human_1"]);
    let person = scene.entities.last().unwrap();
    assert_eq!((person.frame_id.as_str(), person.frame_locked, person.lifetime), ("human_1", true, None));
    assert_eq!((person.metadata[0].key.as_str(), person.metadata[0].value.as_str()), ("role", "nurse"));
    assert!((person.cylinders[0].size.unwrap().x - 0.6).abs() < 1e-12);
    assert_eq!(person.texts[0].text, "human_1");
    // Everything that was drawn before is taken away, so that a message alone is the whole scene.
    assert_eq!((scene.deletions.len(), scene.deletions[0].r#type), (1, 1));
    let frames = FrameTransforms::decode(payload(&first, Topic::Frames)).unwrap();
    let children: Vec<&str> = frames.transforms.iter().map(|frame| frame.child_frame_id.as_str()).collect();
    assert_eq!(children, ["robot", "human_1"]);
    let second = show(&mut stage, 5, &states(2, gone), wanted);
    assert_eq!(second.iter().map(|message| message.topic).collect::<Vec<_>>(), [Topic::Frames]);
    let third = show(&mut stage, 10, &states(2, |agent| flags(agent, None, 1)), wanted);
    let scene = SceneUpdate::decode(payload(&third, Topic::Scene)).unwrap();
    assert_eq!(ids(&scene), ["goal", "door_ward", "robot", "human_1", "human_2"]);
    let fourth = show(&mut stage, 15, &states(2, gone), wanted);
    assert_eq!(ids(&SceneUpdate::decode(payload(&fourth, Topic::Scene)).unwrap()).len(), 4);
}

#[test]
fn messages_are_the_bytes_that_the_library_of_foxglove_writes() {
    fn again<M: Decode + Encode>(payload: &Bytes) -> Vec<u8> {
        let read = M::decode(payload.clone()).unwrap_or_else(|_| panic!("{payload:?}"));
        let mut out = Vec::new();
        read.encode(&mut out).unwrap_or_else(|_| panic!("{payload:?}"));
        out
    }
    let mut stage = stage(&everybody(300));
    let mut there = states(300, |agent| flags(agent, (agent % 3 == 1).then_some(Gesture::Wait), 1));
    (there[0].vx, there[1].y, there[2].yaw, there[3].x) = (-0.0, -0.0, -0.0, -7.25);
    (there[4].vx, there[5].yaw) = (f64::NAN, 2.5);
    let ranges = [0.0, 2.5, f32::INFINITY];
    let offers = stage.offers();
    let frame = Frame { time: SimTime::at_tick(1_234), states: &there, scan: Some(&ranges) };
    let mut messages = stage.frame(&frame, offers);
    let door = EventKind::Door { door: "ward".to_owned(), open: true };
    messages.extend(stage.event(&Event { time: SimTime::at_tick(1_235), kind: door }, "opens", offers));
    messages.extend([Topic::Map, Topic::Plan].into_iter().flat_map(|topic| stage.latched(topic)));
    for message in &messages {
        let again = match message.topic {
            Topic::Map => again::<Map>(&message.payload),
            Topic::Scene | Topic::Labels => again::<SceneUpdate>(&message.payload),
            Topic::Frames => again::<FrameTransforms>(&message.payload),
            Topic::Crowd => again::<PointCloud>(&message.payload),
            Topic::Scan => again::<LaserScan>(&message.payload),
            Topic::Plan => again::<PosesInFrame>(&message.payload),
            Topic::Odometry => again::<Odometry>(&message.payload),
            Topic::Events => again::<Log>(&message.payload),
            Topic::Agents => continue,
        };
        assert_eq!(message.payload, again, "{:?}", message.topic);
    }
    let shown: Topics = messages.iter().map(|message| message.topic).collect();
    assert_eq!(shown, offers);
}

#[test]
fn nothing_is_encoded_that_nobody_wants_and_yet_a_late_viewer_is_given_the_scene() {
    let mut stage = stage(&everybody(2));
    let waiting = |agent| flags(agent, (agent == 1).then_some(Gesture::Wait), 1);
    assert_eq!(show(&mut stage, 7, &states(2, waiting), Topics::NONE), []);
    let late = stage.latched(Topic::Scene);
    assert_eq!((late.len(), late[0].time), (1, SimTime::at_tick(7)));
    assert_eq!(ids(&SceneUpdate::decode(late[0].payload.clone()).unwrap()).len(), 5);
    let labels = SceneUpdate::decode(stage.latched(Topic::Labels)[0].payload.clone()).unwrap();
    assert_eq!((ids(&labels), labels.entities[0].texts[0].text.as_str()), (vec!["label_human_1"], "WAIT"));
    assert_eq!((stage.latched(Topic::Map).len(), stage.latched(Topic::Plan).len()), (1, 1));
    for topic in [Topic::Frames, Topic::Crowd, Topic::Scan, Topic::Odometry, Topic::Agents, Topic::Events] {
        assert!(stage.latched(topic).is_empty(), "{topic:?}");
    }
}

#[test]
fn a_gesture_is_told_when_it_begins_and_when_it_ends() {
    let mut stage = stage(&everybody(1));
    let wanted = only(Topic::Labels);
    let making = |gesture| move |agent| flags(agent, if agent == 0 { gesture } else { None }, 1);
    let mut sent = |tick, gesture| {
        let messages = show(&mut stage, tick, &states(1, making(gesture)), wanted);
        messages.first().map(|message| SceneUpdate::decode(message.payload.clone()).unwrap().entities.len())
    };
    let told = [sent(0, None), sent(1, Some(Gesture::Proceed)), sent(2, Some(Gesture::Proceed))];
    assert_eq!(told, [None, Some(1), None]);
    assert_eq!([sent(3, Some(Gesture::Wait)), sent(4, None), sent(5, None)], [Some(1), Some(0), None]);
}

#[test]
fn of_a_crowd_the_nearest_have_shapes_and_all_who_are_there_are_points() {
    let people = 1_000;
    let mut stage = stage(&everybody(people));
    let wanted = only(Topic::Scene) | only(Topic::Frames) | only(Topic::Crowd);
    let gone = |agent| flags(agent, None, if agent == 1 { ABSENT } else { 1 });
    let messages = show(&mut stage, 0, &states(people, gone), wanted);
    let frames = FrameTransforms::decode(payload(&messages, Topic::Frames)).unwrap();
    let children: Vec<&str> = frames.transforms.iter().map(|frame| frame.child_frame_id.as_str()).collect();
    assert_eq!((children.len(), children[0], children[1], children[50]), (51, "robot", "human_2", "human_51"));
    assert_eq!(ids(&SceneUpdate::decode(payload(&messages, Topic::Scene)).unwrap()).len(), 53);
    let crowd = PointCloud::decode(payload(&messages, Topic::Crowd)).unwrap();
    assert_eq!(crowd.data.len(), 16 * 999);
    // Those who are nearest are looked for once a second, and the shapes change no more often.
    let mut moved = states(people, gone);
    moved[0].x = 900.0;
    for (tick, shapes) in [(50, 0), (99, 0), (100, 1), (101, 0)] {
        let messages = show(&mut stage, tick, &moved, only(Topic::Scene));
        assert_eq!(messages.len(), shapes, "{tick}");
    }
    let frames = show(&mut stage, 102, &moved, only(Topic::Frames));
    let frames = FrameTransforms::decode(payload(&frames, Topic::Frames)).unwrap();
    assert_eq!(frames.transforms[1].child_frame_id, "human_875");
}

#[test]
fn a_crowd_without_a_robot_has_points_and_no_shapes() {
    let people: Vec<AgentInfo> = everybody(300).split_off(1);
    let mut stage = Stage::new(&Facts { agents: &people, ..Facts::default() });
    let there = states(300, |agent| flags(agent, None, 1)).split_off(1);
    let messages = show(&mut stage, 0, &there, only(Topic::Frames) | only(Topic::Crowd));
    assert!(FrameTransforms::decode(payload(&messages, Topic::Frames)).unwrap().transforms.is_empty());
    assert_eq!(PointCloud::decode(payload(&messages, Topic::Crowd)).unwrap().data.len(), 16 * 300);
}

#[test]
fn a_state_of_somebody_unknown_and_numbers_that_are_none_are_passed_over() {
    let mut stage = stage(&everybody(1));
    let mut there = states(1, |agent| flags(agent, None, 1));
    there.push(AgentState { agent: 77, ..there[1] });
    there[1].x = f64::NAN;
    let offers = stage.offers();
    let messages = show(&mut stage, 0, &there, offers);
    let frames = FrameTransforms::decode(payload(&messages, Topic::Frames)).unwrap();
    // Nobody is shown at a place that is no number.
    assert_eq!(frames.transforms.iter().map(|one| one.child_frame_id.as_str()).collect::<Vec<_>>(), ["robot"]);
    assert!(show(&mut stage, 1, &[], only(Topic::Odometry)).is_empty());
}

#[test]
fn a_door_that_opens_is_drawn_anew_and_every_event_is_kept_for_late_viewers() {
    let mut stage = stage(&everybody(1));
    let door = |open| Event { time: SimTime::at_tick(9), kind: EventKind::Door { door: "ward".to_owned(), open } };
    let wanted = only(Topic::Scene) | only(Topic::Events);
    let messages = stage.event(&door(true), "the door ward opens", wanted);
    let scene = SceneUpdate::decode(payload(&messages, Topic::Scene)).unwrap();
    let drawn = scene.entities.iter().find(|entity| entity.id == "door_ward").unwrap();
    assert_eq!((drawn.frame_id.as_str(), drawn.metadata[0].value.as_str()), ("map", "true"));
    assert!(drawn.lines[0].color.unwrap().a < 0.5);
    assert_eq!(Log::decode(payload(&messages, Topic::Events)).unwrap().message, "the door ward opens");
    // The same again changes nothing of the scene, and an unknown door none.
    assert_eq!(stage.event(&door(true), "again", wanted).len(), 1);
    let unknown = Event { time: SimTime::ZERO, kind: EventKind::Door { door: "other".to_owned(), open: true } };
    assert_eq!(stage.event(&unknown, "other", wanted).len(), 1);
    for _ in 0..EVENTS_KEPT {
        assert!(stage.event(&door(false), "shut", Topics::NONE).is_empty());
    }
    let kept = stage.latched(Topic::Events);
    assert_eq!(kept.len(), EVENTS_KEPT);
    assert_eq!(Log::decode(kept[0].payload.clone()).unwrap().message, "shut");
}

#[test]
fn a_stage_that_is_rewound_is_the_stage_before_the_first_frame() {
    let fresh = stage(&everybody(2));
    let mut used = fresh.clone();
    show(&mut used, 500, &states(2, |agent| flags(agent, Some(Gesture::Wait), 1)), Topics::NONE);
    used.event(
        &Event { time: SimTime::at_tick(500), kind: EventKind::Door { door: "ward".to_owned(), open: true } },
        "opens",
        Topics::NONE,
    );
    assert_ne!(used.latched(Topic::Scene), fresh.latched(Topic::Scene));
    used.rewind();
    for topic in [Topic::Map, Topic::Scene, Topic::Plan, Topic::Events, Topic::Labels] {
        assert_eq!(used.latched(topic), fresh.latched(topic), "{topic:?}");
    }
}
