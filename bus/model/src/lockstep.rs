//! The bytes of one step of a driver outside: what the simulation shows, and what the driver answers.
//!
//! ```text
//! SOCO  head 120 bytes · people 56 bytes each · doors 1 byte each, filled up to 4 · lidar 4 bytes a beam
//! SOCC  48 bytes                                the command
//! SOCE  8 bytes and a text                      the driver gives up, and why
//! SOCM  32 bytes and cells of the map           before the first step, to a driver that asked for the map
//! ```
//!
//! Little endian throughout; `docs/wire.md` has every offset. What is longer than this version knows is skipped by the lengths
//! that the head states.

use crate::drive::{Command, Observation, SeenPerson, SeenRobot};
use crate::geometry::Point;
use crate::gesture::Gesture;
use crate::ids::HumanId;
use crate::{Pose, Vector};

/// Version of these bytes. A driver answers in the version that it is asked in.
pub const VERSION: u16 = 1;
/// Bytes of an observation before its people.
pub const HEAD_BYTES: usize = 120;
/// Bytes of a person.
pub const PERSON_BYTES: usize = 56;
/// Bytes of a command.
pub const COMMAND_BYTES: usize = 48;
/// Bytes before the cells of a part of the map.
pub const MAP_HEAD_BYTES: usize = 32;
/// Cells in one part of the map.
pub const MAP_PART_CELLS: usize = 60_000;

const OBSERVATION: [u8; 4] = *b"SOCO";
const COMMAND: [u8; 4] = *b"SOCC";
const GIVES_UP: [u8; 4] = *b"SOCE";
const MAP: [u8; 4] = *b"SOCM";

/// In a person's flags: the one who is driven has them in sight.
const IN_SIGHT: u16 = 1;
/// In a command's flags: the one who is driven stands on purpose.
const WAITING: u32 = 1;

/// Number of the robot among the people of a step, for a person who is driven; the least of `human_k` is 1.
const ROBOT: u32 = 0;

/// Which step of which run it is, and where the robot is to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepHead {
    /// Number of the run among those of this driver; the mission has told it.
    pub session: u64,
    /// Number of the step, from 0.
    pub call: u32,
    /// End of the way of the one who is driven, m.
    pub goal: Point,
    /// The point of the plan that is so far ahead of them as the driver asked for, m; the goal at last.
    pub ahead: Point,
}

/// A step as the driver reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Which step, and where to.
    pub head: StepHead,
    /// Time of the run, s.
    pub time_s: f64,
    /// Pose of the one who is driven.
    pub pose: Pose,
    /// Forward, to the left, m/s.
    pub velocity: (f64, f64),
    /// Turning rate, rad/s.
    pub omega: f64,
    /// The robot, for a person who is driven.
    pub robot: Option<SeenRobot>,
    /// Other people, by number, and whether they are in sight.
    pub people: Vec<(SeenPerson, bool)>,
    /// Whether each door of the mission is open.
    pub doors: Vec<bool>,
    /// Ranges in m, infinite where nothing is hit; empty where the driver did not ask for them.
    pub lidar: Vec<f32>,
}

/// Writes numbers one after the other.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        self.0.extend_from_slice(&bytes);
    }

    fn real(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    fn count(&mut self, value: usize) {
        self.put(u16::try_from(value).unwrap_or(u16::MAX).to_le_bytes());
    }
}

/// Reads numbers one after the other; past the end there is nothing.
struct Reader<'b>(&'b [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    fn real(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn skip(&mut self, bytes: usize) -> Option<()> {
        self.0 = self.0.get(bytes..)?;
        Some(())
    }
}

/// Somebody in the list of people.
struct Listed {
    number: u32,
    in_sight: bool,
    gesture: Option<Gesture>,
    at: Point,
    velocity: Vector,
    yaw: f64,
    radius_m: f64,
}

impl Listed {
    const fn robot(robot: &SeenRobot) -> Self {
        let SeenRobot { at, velocity, yaw, radius_m, gesture, in_sight } = *robot;
        Self { number: ROBOT, in_sight, gesture, at, velocity, yaw, radius_m }
    }

    const fn person(person: &SeenPerson, in_sight: bool) -> Self {
        let SeenPerson { id, at, velocity, yaw, radius_m, gesture } = *person;
        Self { number: id.number(), in_sight, gesture, at, velocity, yaw, radius_m }
    }

    fn put(&self, to: &mut Writer) {
        to.put(self.number.to_le_bytes());
        to.put(if self.in_sight { IN_SIGHT } else { 0 }.to_le_bytes());
        to.put(u16::from(Gesture::code_of(self.gesture)).to_le_bytes());
        let numbers = [self.at.x, self.at.y, self.velocity.x, self.velocity.y, self.yaw, self.radius_m];
        numbers.into_iter().for_each(|value| to.real(value));
    }

    fn read(from: &mut Reader<'_>, person_bytes: usize) -> Option<Self> {
        let (number, flags, code) = (from.u32()?, from.u16()?, from.u16()?);
        let at = Point::new(from.real()?, from.real()?);
        let velocity = Vector::new(from.real()?, from.real()?);
        let (yaw, radius_m) = (from.real()?, from.real()?);
        from.skip(person_bytes.checked_sub(PERSON_BYTES)?)?;
        let gesture = u8::try_from(code).ok().and_then(|code| Gesture::from_code(code).ok()).flatten();
        Some(Self { number, in_sight: flags & IN_SIGHT != 0, gesture, at, velocity, yaw, radius_m })
    }
}

/// The bytes of a step. `everybody` are shown beside those in sight, where the driver asked for all; `lidar` likewise.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "a lidar tells no more than a 32-bit number holds")]
pub fn step_bytes(head: &StepHead, seen: &Observation<'_>, hidden: &[SeenPerson], lidar: &[f64]) -> Vec<u8> {
    let mut all: Vec<Listed> = seen.robot.iter().map(Listed::robot).collect();
    all.extend(seen.people.iter().map(|person| Listed::person(person, true)));
    all.extend(hidden.iter().map(|person| Listed::person(person, false)));
    all.sort_by_key(|one| one.number);
    let people = all.len();
    let room = HEAD_BYTES + PERSON_BYTES * people + seen.doors.len() + 4 + 4 * lidar.len();
    let mut to = Writer(Vec::with_capacity(room));
    to.put(OBSERVATION);
    to.put(VERSION.to_le_bytes());
    to.count(HEAD_BYTES);
    to.put(head.session.to_le_bytes());
    to.put(head.call.to_le_bytes());
    to.count(people);
    to.count(PERSON_BYTES);
    to.count(seen.doors.len());
    to.count(lidar.len());
    to.put(0_u32.to_le_bytes());
    let pose = [seen.pose.x, seen.pose.y, seen.pose.yaw];
    let goals = [head.goal.x, head.goal.y, head.ahead.x, head.ahead.y];
    let moves = [seen.v, seen.vy, seen.omega];
    [seen.time.secs()].into_iter().chain(pose).chain(moves).chain(goals).for_each(|value| to.real(value));
    all.iter().for_each(|one| one.put(&mut to));
    to.0.extend(seen.doors.iter().map(|door| u8::from(door.open)));
    while !to.0.len().is_multiple_of(4) {
        to.0.push(0);
    }
    lidar.iter().for_each(|range| to.put((*range as f32).to_le_bytes()));
    to.0
}

/// Reads a step; `None` where the bytes are none of this version.
#[must_use]
pub fn read_step(bytes: &[u8]) -> Option<Step> {
    let mut from = Reader(bytes);
    if from.take()? != OBSERVATION || from.u16()? != VERSION {
        return None;
    }
    let head_bytes = usize::from(from.u16()?);
    let (session, call) = (from.u64()?, from.u32()?);
    let (people, person_bytes) = (from.u16()?, usize::from(from.u16()?));
    let (doors, beams) = (usize::from(from.u16()?), from.u16()?);
    from.u32()?;
    let time_s = from.real()?;
    let pose = Pose { x: from.real()?, y: from.real()?, yaw: from.real()? };
    let (velocity, omega) = ((from.real()?, from.real()?), from.real()?);
    let goal = Point::new(from.real()?, from.real()?);
    let ahead = Point::new(from.real()?, from.real()?);
    from.skip(head_bytes.checked_sub(HEAD_BYTES)?)?;
    let (mut robot, mut others) = (None, Vec::new());
    for _ in 0..people {
        let Listed { number, in_sight, gesture, at, velocity, yaw, radius_m } = Listed::read(&mut from, person_bytes)?;
        if number == ROBOT {
            robot = Some(SeenRobot { at, velocity, yaw, radius_m, gesture, in_sight });
        } else {
            others.push((SeenPerson { id: HumanId::new(number), at, velocity, yaw, radius_m, gesture }, in_sight));
        }
    }
    let open = from.0.get(..doors)?.iter().map(|byte| *byte != 0).collect();
    from.skip(doors.next_multiple_of(4))?;
    let lidar = (0..beams).map(|_| from.take().map(f32::from_le_bytes)).collect::<Option<Vec<f32>>>()?;
    let head = StepHead { session, call, goal, ahead };
    Some(Step { head, time_s, pose, velocity, omega, robot, people: others, doors: open, lidar })
}

/// The bytes of a command.
#[must_use]
pub fn command_bytes(session: u64, call: u32, command: &Command) -> Vec<u8> {
    let mut to = Writer(Vec::with_capacity(COMMAND_BYTES));
    to.put(COMMAND);
    to.put(VERSION.to_le_bytes());
    to.put(u16::from(Gesture::code_of(command.gesture)).to_le_bytes());
    to.put(session.to_le_bytes());
    to.put(call.to_le_bytes());
    to.put((if command.waiting { WAITING } else { 0 }).to_le_bytes());
    [command.v, command.vy, command.omega].into_iter().for_each(|value| to.real(value));
    to.0
}

/// The bytes with which a driver gives up.
#[must_use]
pub fn gives_up_bytes(why: &str) -> Vec<u8> {
    let mut to = Writer::default();
    to.put(GIVES_UP);
    to.put(VERSION.to_le_bytes());
    to.put(0_u16.to_le_bytes());
    to.0.extend_from_slice(why.as_bytes());
    to.0
}

/// A part of the map: cells from `first` on, row by row from the lower left; 0 free, 100 occupied, 255 unknown.
#[must_use]
pub fn map_bytes(session: u64, first: u64, whole: u64, cells: &[u8]) -> Vec<u8> {
    let mut to = Writer(Vec::with_capacity(MAP_HEAD_BYTES + cells.len()));
    to.put(MAP);
    to.put(VERSION.to_le_bytes());
    to.count(MAP_HEAD_BYTES);
    [session, first, whole].into_iter().for_each(|number| to.put(number.to_le_bytes()));
    to.0.extend_from_slice(cells);
    to.0
}

/// Why an answer is no command.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BadCommand {
    /// Too few bytes.
    #[error("the answer has {found} bytes; a command has {COMMAND_BYTES}")]
    Short {
        /// How many there are.
        found: usize,
    },
    /// Something else than a command.
    #[error("the answer begins with `{found}`; a command begins with `SOCC`, giving up with `SOCE`")]
    Kind {
        /// The first four bytes as text.
        found: String,
    },
    /// Bytes of another version.
    #[error("the answer is of version {found}; it was asked in version {VERSION}")]
    Version {
        /// Its version.
        found: u16,
    },
    /// The answer to another step.
    #[error("the answer is to step {call} of session {session}; asked was step {asked} of session {asked_session}")]
    Other {
        /// Session that is named.
        session: u64,
        /// Step that is named.
        call: u32,
        /// Session that asked.
        asked_session: u64,
        /// Step that asked.
        asked: u32,
    },
    /// A number that nobody can be told.
    #[error("`{name}` is {value}; allowed are finite numbers")]
    NotFinite {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A gesture that is not in the table.
    #[error("gesture {code}; allowed: 0 to 5")]
    Gesture {
        /// Its code.
        code: u16,
    },
    /// The driver itself gives up.
    #[error("the driver gives up: {why}")]
    GivesUp {
        /// Its reason.
        why: String,
    },
}

/// Reads the answer to a step.
///
/// # Errors
/// [`BadCommand`].
pub fn read_command(bytes: &[u8], session: u64, call: u32) -> Result<Command, BadCommand> {
    let short = || BadCommand::Short { found: bytes.len() };
    let mut from = Reader(bytes);
    let kind: [u8; 4] = from.take().ok_or_else(short)?;
    if kind == GIVES_UP {
        let why = bytes.get(8..).unwrap_or_default();
        let why = String::from_utf8_lossy(why.get(..why.len().min(2000)).unwrap_or_default()).into_owned();
        return Err(BadCommand::GivesUp { why });
    }
    if kind != COMMAND {
        return Err(BadCommand::Kind { found: kind.escape_ascii().to_string() });
    }
    let version = from.u16().ok_or_else(short)?;
    if version != VERSION {
        return Err(BadCommand::Version { found: version });
    }
    let numbers = (|| {
        let (code, its_session, its_call, flags) = (from.u16()?, from.u64()?, from.u32()?, from.u32()?);
        Some((code, its_session, its_call, flags, [from.real()?, from.real()?, from.real()?]))
    })();
    let (code, its_session, its_call, flags, reals) = numbers.ok_or_else(short)?;
    if (its_session, its_call) != (session, call) {
        let (asked_session, asked) = (session, call);
        return Err(BadCommand::Other { session: its_session, call: its_call, asked_session, asked });
    }
    for (name, value) in ["v", "vy", "omega"].into_iter().zip(reals) {
        if !value.is_finite() {
            return Err(BadCommand::NotFinite { name, value });
        }
    }
    let gesture = u8::try_from(code).ok().and_then(|code| Gesture::from_code(code).ok());
    let gesture = gesture.ok_or(BadCommand::Gesture { code })?;
    let [v, vy, omega] = reals;
    Ok(Command { v, vy, omega, gesture, waiting: flags & WAITING != 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Cues, SeenDoor};

    fn person(number: u32, x: f64) -> SeenPerson {
        SeenPerson {
            id: HumanId::new(number),
            at: Point::new(x, -1.5),
            velocity: Vector::new(0.25, 1.0),
            yaw: 0.5,
            radius_m: 0.28,
            gesture: (number == 2).then_some(Gesture::Wait),
        }
    }

    fn written(robot: Option<SeenRobot>, lidar: &[f64]) -> (StepHead, Vec<u8>) {
        let head = StepHead { session: 77, call: 3, goal: Point::new(9.0, 1.0), ahead: Point::new(4.0, 1.0) };
        let door = |open| SeenDoor { id: "d".into(), from: Point::origin(), to: Point::origin(), open };
        let observation = Observation {
            time: crate::SimTime::at_tick(150),
            pose: Pose { x: 1.0, y: 2.0, yaw: -0.5 },
            v: 0.4,
            vy: 0.1,
            omega: -0.2,
            people: &[person(2, 3.0)],
            robot,
            everybody: &Vec::new,
            doors: &[door(true), door(false)],
            lidar: &Vec::new,
            cues: Cues::default(),
        };
        (head, step_bytes(&head, &observation, &[person(1, 8.0)], lidar))
    }

    #[test]
    fn a_step_is_read_as_it_was_written_and_has_the_stated_length() {
        let (head, bytes) = written(None, &[1.0, f64::INFINITY]);
        assert_eq!(bytes.len(), HEAD_BYTES + 2 * PERSON_BYTES + 4 + 2 * 4);
        let step = read_step(&bytes).unwrap();
        assert_eq!((step.head, step.time_s, step.pose.yaw), (head, 1.5, -0.5));
        assert_eq!((step.velocity, step.omega), ((0.4, 0.1), -0.2));
        assert_eq!(step.people, [(person(1, 8.0), false), (person(2, 3.0), true)]);
        assert_eq!(step.doors, [true, false]);
        assert_eq!(step.lidar, [1.0, f32::INFINITY]);
        // Offsets that docs/wire.md states.
        assert_eq!(bytes[32..40], 1.5_f64.to_le_bytes());
        assert_eq!(bytes[88..96], 9.0_f64.to_le_bytes());
        assert_eq!(bytes[120..124], 1_u32.to_le_bytes());
        assert_eq!(bytes[128..136], 8.0_f64.to_le_bytes());
    }

    #[test]
    fn for_a_person_the_robot_is_the_first_of_the_people_with_the_number_0() {
        let robot = SeenRobot {
            at: Point::new(6.0, 2.0),
            velocity: Vector::new(-0.5, 0.0),
            yaw: 3.0,
            radius_m: 0.2,
            gesture: Some(Gesture::ExcuseMe),
            in_sight: true,
        };
        let (_, bytes) = written(Some(robot), &[]);
        assert_eq!(bytes.len(), HEAD_BYTES + 3 * PERSON_BYTES + 4);
        assert_eq!((&bytes[20..22], &bytes[120..124]), (&3_u16.to_le_bytes()[..], &0_u32.to_le_bytes()[..]));
        assert_eq!(bytes[128..136], 6.0_f64.to_le_bytes());
        let step = read_step(&bytes).unwrap();
        assert_eq!(step.robot, Some(robot));
        assert_eq!(step.people, [(person(1, 8.0), false), (person(2, 3.0), true)]);
        let (_, hidden) = written(Some(SeenRobot { in_sight: false, ..robot }), &[]);
        assert!(!read_step(&hidden).unwrap().robot.unwrap().in_sight);
    }

    #[test]
    fn a_step_that_is_cut_off_is_none() {
        let (_, bytes) = written(None, &[1.0]);
        for length in 0..bytes.len() {
            assert!(read_step(&bytes[..length]).is_none(), "{length}");
        }
    }

    #[test]
    fn a_command_is_read_as_it_was_written() {
        let command = Command { v: 0.3, vy: -0.1, omega: 1.0, gesture: Some(Gesture::ExcuseMe), waiting: true };
        let bytes = command_bytes(77, 3, &command);
        assert_eq!(bytes.len(), COMMAND_BYTES);
        assert_eq!(read_command(&bytes, 77, 3).unwrap(), command);
    }

    #[test]
    fn an_answer_that_is_no_command_says_what_is_wrong_with_it() {
        let good = command_bytes(77, 3, &Command::default());
        let with = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            bytes
        };
        let nan = command_bytes(77, 3, &Command { omega: f64::NAN, ..Command::default() });
        for (bytes, said) in [
            (Vec::new(), "the answer has 0 bytes; a command has 48"),
            (good[..47].to_vec(), "the answer has 47 bytes"),
            (with(0, b'X'), "begins with `XOCC`"),
            (with(4, 9), "of version 9; it was asked in version 1"),
            (with(6, 6), "gesture 6; allowed: 0 to 5"),
            (with(8, 1), "to step 3 of session 1; asked was step 3 of session 77"),
            (nan, "`omega` is NaN"),
            (gives_up_bytes("no way"), "the driver gives up: no way"),
        ] {
            let bad = read_command(&bytes, 77, 3).unwrap_err().to_string();
            assert!(bad.contains(said), "{said}: {bad}");
        }
    }
}
