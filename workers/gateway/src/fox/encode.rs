//! Messages of a run as bytes, one function each.

use bytes::Bytes;
use socrates_model::grid::Grid;
use socrates_model::recording::{AGENT_STATE_BYTES, AgentState, Event, EventKind};
use socrates_model::{AgentId, SimTime};
use socrates_stream::foxglove::{FLOAT32, MAP, Proto, head, occupancy, packed, pose, stamp, transform, vector};

/// Frame of the robot.
const ROBOT: &str = "robot";
/// Height at which the beams of the lidar are drawn, m.
const SCAN_Z_M: f64 = 0.2;
/// Height at which the intended way is drawn, m: above the map, below everybody.
const WAY_Z_M: f64 = 0.02;
/// Height at which people are drawn as points, m.
const POINT_Z_M: f32 = 1.0;
/// Bytes of a point: x, y, z, speed.
const POINT_BYTES: u32 = 16;
/// A covariance that is not known: its schema asks for 6 by 6 numbers, and for zeros then.
const UNKNOWN: [f64; 36] = [0.0; 36];
/// Longest text of an event, characters.
const EVENT_CHARS: usize = 2_000;

/// A message as bytes.
pub(crate) fn bytes(write: impl FnOnce(&mut Proto)) -> Bytes {
    let mut out = Proto::lean();
    write(&mut out);
    out.into_bytes().into()
}

/// `/map`: the grid, its first row at the bottom; nothing where cells are missing or the map is empty.
#[must_use]
pub fn map(grid: &Grid) -> Option<Bytes> {
    Some(bytes(|out| occupancy(out, grid))).filter(|bytes| !bytes.is_empty())
}

/// `/robot/plan`: the points of the way, each facing the next; nothing for a way without points.
#[must_use]
pub fn plan(way: &[[f64; 2]]) -> Option<Bytes> {
    let mut yaw = 0.0;
    let next = way.iter().skip(1).map(Some).chain([None]);
    let poses = |out: &mut Proto| {
        head(out, SimTime::ZERO, MAP);
        for ([x, y], next) in way.iter().zip(next) {
            if let Some([to_x, to_y]) = next {
                yaw = libm::atan2(to_y - y, to_x - x);
            }
            pose(out, 3, [*x, *y, WAY_Z_M], yaw);
        }
    };
    (!way.is_empty()).then(|| bytes(poses))
}

/// `/tf`: a frame for each of these, named as they are.
#[must_use]
pub fn frames<'a>(shown: impl Iterator<Item = (&'a str, &'a AgentState)>, time: SimTime) -> Bytes {
    bytes(|out| shown.for_each(|(name, state)| transform(out, name, state, time)))
}

/// `/crowd`: a point for each of these; x, y, z in m and the speed in m/s.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than a 32-bit number holds")]
pub fn crowd<'a>(people: impl Iterator<Item = &'a AgentState>, time: SimTime) -> Bytes {
    let mut data = Vec::with_capacity(people.size_hint().1.unwrap_or_default() * POINT_BYTES as usize);
    for state in people {
        let speed = (state.vx * state.vx + state.vy * state.vy).sqrt();
        let point = [state.x as f32, state.y as f32, POINT_Z_M, speed as f32];
        data.extend_from_slice(point.map(f32::to_le_bytes).as_flattened());
    }
    bytes(|out| {
        head(out, time, MAP);
        pose(out, 3, [0.0; 3], 0.0);
        out.fixed(4, POINT_BYTES);
        for (name, offset) in [("x", 0), ("y", 4), ("z", 8), ("speed", 12)] {
            packed(out, 5, name, offset, FLOAT32);
        }
        out.data(6, &data);
    })
}

/// `/scan`: the ranges as they are, in the frame of the robot.
#[must_use]
pub fn scan(ranges: &[f32], time: SimTime) -> Bytes {
    #[expect(clippy::cast_precision_loss, reason = "a scan has fewer than 2^53 beams")]
    let beams = ranges.len().max(1) as f64;
    bytes(|out| {
        head(out, time, ROBOT);
        pose(out, 3, [0.0, 0.0, SCAN_Z_M], 0.0);
        out.double(5, std::f64::consts::TAU * (beams - 1.0) / beams);
        out.doubles(6, ranges.iter().copied().map(f64::from));
    })
}

/// `/robot/odom`: pose in the map, velocity turned into the frame of the robot.
#[must_use]
pub fn odometry(robot: &AgentState, time: SimTime) -> Bytes {
    let (sin, cos) = (libm::sin(robot.yaw), libm::cos(robot.yaw));
    bytes(|out| {
        head(out, time, MAP);
        out.text(3, ROBOT);
        pose(out, 4, [robot.x, robot.y, 0.0], robot.yaw);
        vector(out, 5, [robot.vx * cos + robot.vy * sin, robot.vy * cos - robot.vx * sin, 0.0]);
        vector(out, 6, [0.0, 0.0, robot.omega]);
        out.doubles(7, UNKNOWN.into_iter());
        out.doubles(8, UNKNOWN.into_iter());
    })
}

/// `/socrates/agents`: everybody's record, one after the other.
#[must_use]
pub fn agents(states: &[AgentState]) -> Bytes {
    let mut out = Vec::with_capacity(states.len() * AGENT_STATE_BYTES);
    states.iter().for_each(|state| out.extend_from_slice(&state.to_bytes()));
    out.into()
}

/// How much an event matters, as a number of `Log.Level`.
#[derive(Debug, Clone, Copy)]
enum LogLevel {
    Debug = 1,
    Info = 2,
    Warning = 3,
}

/// `/events`: an event with its text, told by whom it is about.
#[must_use]
pub fn log(event: &Event, text: &str) -> Bytes {
    let (level, name) = told_by(&event.kind);
    let message: String = text.chars().take(EVENT_CHARS).collect();
    bytes(|out| {
        stamp(out, 1, event.time);
        out.number(2, level as u64);
        out.text(3, &message);
        out.text(4, &name);
    })
}

/// How much an event matters, and whom it is about.
fn told_by(kind: &EventKind) -> (LogLevel, String) {
    let human = |human: &socrates_model::HumanId| human.to_string();
    match kind {
        EventKind::Gesture { agent, .. } => (LogLevel::Info, agent.to_string()),
        EventKind::Leaf { human: id, .. }
        | EventKind::StepEnded { human: id, .. }
        | EventKind::Sees { human: id, .. } => (LogLevel::Debug, human(id)),
        EventKind::Encounter { human: id, .. } => (LogLevel::Info, human(id)),
        EventKind::Contact { a: agent, .. } | EventKind::WallContact { agent, .. } | EventKind::Stuck { agent } => {
            (LogLevel::Warning, agent.to_string())
        }
        EventKind::Door { door, .. } => (LogLevel::Info, door.chars().take(EVENT_CHARS).collect()),
        EventKind::Node { agent, .. } => (LogLevel::Debug, agent.to_string()),
        EventKind::RobotArrived => (LogLevel::Info, AgentId::Robot.to_string()),
        EventKind::End { .. } => (LogLevel::Info, "run".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::grid::Cell;

    use super::*;
    use foxglove::Decode as _;
    use foxglove::messages::log::Level;
    use foxglove::messages::{Grid as GridMessage, LaserScan, Log, Odometry, PointCloud, PosesInFrame, Timestamp};
    use socrates_model::Pose as MapPose;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-6
    }

    fn state(agent: u32, x: f64, y: f64) -> AgentState {
        AgentState { tick: 150, agent, flags: 0, x, y, yaw: std::f64::consts::FRAC_PI_2, vx: 0.6, vy: 0.8, omega: 0.25 }
    }

    const AT: SimTime = SimTime::at_tick(150);

    #[test]
    fn a_transform_is_the_bytes_that_the_standard_gives() {
        // Worked out by hand: message 1 with stamp (1 s, 500 000 000 ns), parent, child, translation, rotation.
        let still = AgentState { yaw: 0.0, ..state(0, 1.0, 0.0) };
        let found = frames([("robot", &still)].into_iter(), AT);
        let mut inner = vec![0x0a, 0x08, 0x08, 0x01, 0x10, 0x80, 0xca, 0xb5, 0xee, 0x01];
        inner.extend(b"\x12\x03map\x1a\x05robot");
        inner.extend([0x22, 0x09, 0x09, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
        inner.extend([0x2a, 0x09, 0x21, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
        let mut wanted = vec![0x0a, u8::try_from(inner.len()).unwrap()];
        wanted.extend(inner);
        assert_eq!(found.as_ref(), wanted);
    }

    #[test]
    fn a_map_has_its_first_row_at_the_bottom() {
        let cells = [Cell::Occupied, Cell::Free, Cell::Free, Cell::Unknown, Cell::Free, Cell::Occupied].to_vec();
        let grid = Grid { width: 3, height: 2, resolution_m: 0.5, origin: MapPose::new(-1.0, 2.0, 0.0), cells };
        let read = GridMessage::decode(map(&grid).unwrap()).unwrap();
        assert_eq!(read.data.as_ref(), [50, 0, 100, 100, 0, 0]);
        assert_eq!((read.column_count, read.row_stride, read.cell_stride), (3, 3, 1));
        let at = read.pose.unwrap().position.unwrap();
        assert!(close(at.x, -1.0) && close(at.y, 2.0) && close(read.cell_size.unwrap().x, 0.5));
        let fields: Vec<(&str, u32, i32)> =
            read.fields.iter().map(|field| (field.name.as_str(), field.offset, field.r#type)).collect();
        assert_eq!(fields, [("occupancy", 0, 1)]);
    }

    #[test]
    fn a_map_without_cells_or_with_too_few_is_not_sent() {
        let grid = |width, height, cells| Grid {
            width,
            height,
            resolution_m: 0.5,
            origin: MapPose::new(0.0, 0.0, 0.0),
            cells: vec![Cell::Free; cells],
        };
        assert!(map(&grid(0, 0, 0)).is_none() && map(&grid(3, 2, 5)).is_none());
        assert!(map(&grid(usize::MAX, 2, 5)).is_none() && map(&grid(3, 2, 6)).is_some());
    }

    #[test]
    fn a_map_that_is_too_large_is_made_coarser_and_keeps_its_walls() {
        let (width, height) = (4_001, 2_001);
        let mut cells = vec![Cell::Free; width * height];
        // The lower left cell, and one in the middle of the upper row.
        cells[width * (height - 1)] = Cell::Occupied;
        cells[2_000] = Cell::Occupied;
        let grid = Grid { width, height, resolution_m: 0.05, origin: MapPose::new(0.0, 0.0, 0.0), cells };
        let read = GridMessage::decode(map(&grid).unwrap()).unwrap();
        assert_eq!((read.column_count, read.data.len()), (2_001, 2_001 * 1_001));
        assert!(read.data.len() <= socrates_stream::foxglove::FLOOR_CELLS && close(read.cell_size.unwrap().y, 0.1));
        let walls: Vec<usize> = (0..read.data.len()).filter(|at| read.data[*at] == 100).collect();
        assert_eq!(walls, [0, 2_001 * 1_000 + 1_000]);
    }

    #[test]
    fn a_way_faces_its_next_point_and_keeps_facing_at_its_end() {
        let read = PosesInFrame::decode(plan(&[[0.0, 0.0], [0.0, 2.0], [0.0, 3.0]]).unwrap()).unwrap();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!((read.frame_id.as_str(), read.poses.len()), ("map", 3));
        for pose in &read.poses {
            let turned = pose.orientation.unwrap();
            assert!(close(turned.z, half) && close(turned.w, half), "{turned:?}");
        }
        assert!(close(read.poses[1].position.unwrap().y, 2.0));
        assert!(plan(&[]).is_none() && plan(&[[1.0, 1.0]]).is_some());
    }

    #[test]
    fn a_crowd_is_16_bytes_a_person() {
        let people = [state(1, 1.5, -2.0), state(2, 3.0, 4.0)];
        let read = PointCloud::decode(crowd(people.iter(), AT)).unwrap();
        assert_eq!((read.point_stride, read.data.len(), read.frame_id.as_str()), (16, 32, "map"));
        let values: Vec<f32> = read.data.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert_eq!(values, [1.5, -2.0, 1.0, 1.0, 3.0, 4.0, 1.0, 1.0]);
        let fields: Vec<(&str, u32, i32)> =
            read.fields.iter().map(|field| (field.name.as_str(), field.offset, field.r#type)).collect();
        assert_eq!(fields, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("speed", 12, 7)]);
        let stamp = read.timestamp.unwrap();
        assert_eq!((stamp.sec(), stamp.nsec()), (1, 500_000_000));
    }

    #[test]
    fn a_scan_goes_once_round_from_straight_ahead() {
        let mut ranges = vec![f32::INFINITY; 360];
        ranges[90] = 2.5;
        let read = LaserScan::decode(scan(&ranges, AT)).unwrap();
        assert_eq!((read.frame_id.as_str(), read.ranges.len()), ("robot", 360));
        assert!(read.ranges[0].is_infinite() && close(read.ranges[90], 2.5));
        let step = (read.end_angle - read.start_angle) / 359.0;
        assert!(close(read.start_angle, 0.0) && close(90.0 * step, std::f64::consts::FRAC_PI_2));
        assert!(LaserScan::decode(scan(&[], AT)).unwrap().ranges.is_empty());
    }

    #[test]
    fn odometry_has_the_velocity_in_the_frame_of_the_robot() {
        // Facing up, (0.6, 0.8) of the map is 0.8 ahead and 0.6 to the right.
        let read = Odometry::decode(odometry(&state(0, 1.0, 2.0), AT)).unwrap();
        let (linear, angular) = (read.linear_velocity.unwrap(), read.angular_velocity.unwrap());
        assert!(close(linear.x, 0.8) && close(linear.y, -0.6) && close(angular.z, 0.25));
        assert_eq!((read.frame_id.as_str(), read.body_frame_id.as_str()), ("map", "robot"));
        assert_eq!((read.pose_covariance.len(), read.velocity_covariance.len()), (36, 36));
    }

    #[test]
    fn records_are_those_of_a_recording() {
        let states = [state(0, 1.0, 2.0), state(3, 4.0, 5.0)];
        let read: Vec<AgentState> =
            agents(&states).chunks(AGENT_STATE_BYTES).filter_map(AgentState::from_bytes).collect();
        assert_eq!(read, states);
    }

    #[test]
    fn an_event_is_told_by_whom_it_is_about_and_contacts_are_warnings() {
        let contact = EventKind::Contact { a: AgentId::Robot, b: AgentId::from_number(3), depth_m: 0.02 };
        let read = Log::decode(log(&Event { time: AT, kind: contact }, "robot touches human_3")).unwrap();
        assert_eq!(
            (read.level(), read.name.as_str(), read.message.as_str()),
            (Level::Warning, "robot", "robot touches human_3")
        );
        assert_eq!(read.timestamp, Timestamp::new_checked(1, 500_000_000));
        let node =
            EventKind::Node { agent: AgentId::from_number(2), node: socrates_model::NodeId::new("dock").unwrap() };
        let read = Log::decode(log(&Event { time: AT, kind: node }, &"x".repeat(5_000))).unwrap();
        assert_eq!((read.level(), read.name.as_str(), read.message.len()), (Level::Debug, "human_2", EVENT_CHARS));
    }

    #[test]
    fn time_beyond_what_a_stamp_holds_has_no_stamp() {
        let stamp = |time| Log::decode(log(&Event { time, kind: EventKind::RobotArrived }, "")).unwrap().timestamp;
        assert_eq!(stamp(SimTime::from_nanos(u64::MAX)), None);
        assert_eq!(stamp(SimTime::ZERO), Timestamp::new_checked(0, 0));
    }
}
