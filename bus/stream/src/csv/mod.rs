//! Tracks as comma-separated text: for spreadsheets, and from other people's recordings.

mod ids;
mod plain;
mod table;

pub use ids::{Named, named};
pub use plain::{RunChoice, plain};
pub use table::{Row, Table};

use std::collections::BTreeMap;
use std::fmt::Write as _;

use socrates_model::recording::{ABSENT_LEAF, AgentInfo, AgentState, Recording, RecordingHeader};
use socrates_model::time::{STEP_SECS, SimTime};
use socrates_model::{AgentId, FORMAT, Gesture, PlannerName, RunId};

use crate::error::StreamError;

/// How many of the ticks are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rate {
    /// Ten a second.
    #[default]
    TenHertz,
    /// Every tick.
    Every,
}

impl Rate {
    const fn stride(self) -> usize {
        match self {
            Self::TenHertz => 10,
            Self::Every => 1,
        }
    }
}

/// Most states that a file may make at every tick: 256 MiB in memory. With more, there are ten a second.
const MAX_STATES: usize = 4 * 1024 * 1024;
/// Most states that a file may make at all: 1 GiB in memory, five hours with ninety people.
const MOST_STATES: usize = 4 * MAX_STATES;
/// Ticks between states where there would be too many: ten a second are what scores are computed from.
const SPARSE: usize = 10;
/// Assumed radius of a person where a file says nothing, m: as in the native profile.
pub const HUMAN_RADIUS_M: f64 = 0.28;
/// Assumed radius of the robot, m: as in the native profile.
pub const ROBOT_RADIUS_M: f64 = 0.25;
/// Assumed nominal speed of the robot, m/s: as in the native profile.
pub const ROBOT_SPEED_MPS: f64 = 0.8;
/// Assumed nominal speed of a person, m/s.
const HUMAN_SPEED_MPS: f64 = 1.2;
/// Times nearer than this are one time that was rounded twice, s.
const SAME_SECS: f64 = 1e-6;
/// Index of the leaf of the absent in the recordings that are made here.
const ABSENT: u16 = 1;
/// Slower than this no heading is taken from the motion, m/s.
const STILL_MPS: f64 = 0.05;

/// Columns of a table of agents, in order.
pub const AGENT_COLUMNS: [&str; 10] = ["planner", "seed", "t", "id", "x", "y", "yaw", "v", "gesture", "leaf"];

/// The states of all these recordings, one after another, ten times a second, with [`AGENT_COLUMNS`].
#[must_use]
pub fn write_agents(recordings: &[&Recording]) -> String {
    write_agents_at(recordings, Rate::TenHertz)
}

/// As [`write_agents`], at a rate of choice.
#[must_use]
pub fn write_agents_at(recordings: &[&Recording], rate: Rate) -> String {
    let mut text = AgentTable::head();
    for recording in recordings {
        let table = AgentTable::of(&recording.header);
        for tick in (0..recording.ticks()).step_by(rate.stride()) {
            table.append(&mut text, recording.tick(tick));
        }
    }
    text
}

/// The table of agents of one run while it goes, ten times a second.
#[derive(Debug, Clone)]
pub struct AgentTable {
    /// The first two cells.
    run: String,
    /// The last cell by the index of its leaf, with the comma before it.
    leaves: Vec<String>,
}

impl AgentTable {
    /// The table of the run with this header.
    #[must_use]
    pub fn of(header: &RecordingHeader) -> Self {
        let run = joined([header.planner.as_str(), &header.seed.to_string()]);
        // A cell that is empty and alone would be in quotes, hence the one before it.
        Self { run, leaves: header.leaves.iter().map(|leaf| joined(["", leaf.as_str()])).collect() }
    }

    /// The line that names the columns.
    #[must_use]
    pub fn head() -> String {
        AGENT_COLUMNS.join(",") + "\n"
    }

    /// The lines of a tick; none of those between two tenths of a second.
    #[must_use]
    pub fn rows(&self, states: &[AgentState]) -> String {
        let mut text = String::new();
        let stride = Rate::TenHertz.stride() as u64;
        if states.first().is_some_and(|state| state.tick.is_multiple_of(stride)) {
            self.append(&mut text, states);
        }
        text
    }

    fn append(&self, text: &mut String, states: &[AgentState]) {
        for state in states {
            let leaf = self.leaves.get(usize::from(state.leaf())).map_or(",", String::as_str);
            // Writing to a string cannot fail.
            let _infallible = writeln!(
                text,
                "{},{:.2},{},{:.4},{:.4},{:.4},{:.4},{}{leaf}",
                self.run,
                SimTime::at_tick(state.tick).secs(),
                state.agent_id(),
                state.x,
                state.y,
                state.yaw,
                state.speed(),
                Gesture::name_of(state.gesture()),
            );
        }
    }
}

/// A text as one line: with a line break in a cell a table cannot be read line by line.
#[must_use]
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A line of a table as RFC 4180 has it, without its end: a cell is in quotes only where it needs them. A cell that is
/// empty and alone is in quotes, so that it is no empty line.
#[must_use]
pub fn joined<C: AsRef<[u8]>>(cells: impl IntoIterator<Item = C>) -> String {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail, and text stays text.
    let _infallible = writer.write_record(cells);
    let mut line = String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default();
    if line.ends_with('\n') {
        line.pop();
    }
    line
}

/// One line of a track file.
#[derive(Debug, Clone, Copy)]
struct Fix {
    t: f64,
    x: f64,
    y: f64,
    yaw: Option<f64>,
    gesture: Option<Gesture>,
    /// Whether the agent is there.
    there: bool,
}

/// Reads tracks: columns `t` (s), `id` (`robot`, `human_3` or a number; 0 is the robot), `x`, `y` (m) and maybe `yaw`
/// (rad; empty where it is not known), `gesture` and `leaf`, in any order; other columns are passed over. Lines may come in
/// any order. The tracks are brought to the step of 0.01 s by straight lines between fixes, or to ten a second where that would
/// be too many.
/// Before its first and after its last fix an agent is not there, and neither it is at a fix whose `leaf` is `absent`
/// nor on the way to or from one; all other leaves are passed over.
///
/// # Errors
/// [`StreamError::Csv`] with the line.
pub fn read_tracks(text: &str) -> Result<Recording, StreamError> {
    read_table(&Table::read(text)?)
}

/// As [`read_tracks`], from a table that was read before.
///
/// # Errors
/// As [`read_tracks`].
pub fn read_table(table: &Table) -> Result<Recording, StreamError> {
    let columns = Columns::read(table)?;
    let mut tracks: BTreeMap<AgentId, Vec<Fix>> = BTreeMap::new();
    for row in &table.rows {
        let (agent, fix) = columns.fix(row)?;
        tracks.entry(agent).or_default().push(fix);
    }
    let last = table.last_line();
    if tracks.is_empty() {
        return Err(bad(last, "the file has no line after its head"));
    }
    let begin = tracks.values().flatten().map(|fix| fix.t).fold(f64::INFINITY, f64::min);
    let end = tracks.values().flatten().map(|fix| fix.t).fold(f64::NEG_INFINITY, f64::max);
    let steps = libm::floor((end - begin) / STEP_SECS + 1e-6);
    #[expect(clippy::cast_precision_loss, reason = "the limit is far below 2^53")]
    let stride = if steps * (tracks.len() as f64) >= MAX_STATES as f64 { SPARSE } else { 1 };
    #[expect(clippy::cast_precision_loss, reason = "the limit is far below 2^53")]
    if steps / stride as f64 * (tracks.len() as f64) >= MOST_STATES as f64 {
        return Err(bad(
            last,
            &format!(
                "{} agents over {:.0} s are more than {MOST_STATES} states at ten a second: are times in milliseconds or frames? Seconds are expected",
                tracks.len(),
                end - begin
            ),
        ));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded just above, and end >= begin")]
    let ticks = (steps as usize / stride) + 1;
    for track in tracks.values_mut() {
        track.sort_by(|a, b| a.t.total_cmp(&b.t));
        track.dedup_by(|later, kept| later.t <= kept.t);
    }
    let mut per_agent: Vec<Vec<AgentState>> =
        tracks.iter().map(|(agent, track)| resampled(*agent, track, begin, ticks, stride)).collect();
    let mut leaves = vec![String::new()];
    if per_agent.iter().flatten().any(|state| state.leaf() == ABSENT) {
        leaves.push(ABSENT_LEAF.to_owned());
    }
    let agents = tracks.keys().map(|agent| info(*agent)).collect();
    let mut frames = Vec::with_capacity(ticks.saturating_mul(tracks.len()));
    let mut columns: Vec<_> = per_agent.iter_mut().map(|states| states.drain(..)).collect();
    for _tick in 0..ticks {
        frames.extend(columns.iter_mut().filter_map(Iterator::next));
    }
    let run = RunId::new("tracks").map_err(|why| bad(1, &why.to_string()))?;
    let header = RecordingHeader {
        format: FORMAT,
        run,
        planner: PlannerName::tracks(),
        seed: 0,
        profile: "tracks".to_owned(),
        step_s: STEP_SECS,
        agents,
        leaves,
    };
    Ok(Recording { header, frames, events: Vec::new() })
}

fn info(agent: AgentId) -> AgentInfo {
    let (role, radius_m, speed_mps) = match agent {
        AgentId::Robot => ("robot", ROBOT_RADIUS_M, ROBOT_SPEED_MPS),
        AgentId::Human(_) => ("person", HUMAN_RADIUS_M, HUMAN_SPEED_MPS),
    };
    AgentInfo { agent, radius_m, speed_mps, role: role.to_owned() }
}

fn bad(line: usize, why: &str) -> StreamError {
    StreamError::Csv { line, why: why.to_owned() }
}

struct Columns {
    t: usize,
    id: usize,
    x: usize,
    y: usize,
    yaw: Option<usize>,
    gesture: Option<usize>,
    leaf: Option<usize>,
}

impl Columns {
    fn read(table: &Table) -> Result<Self, StreamError> {
        let find = |name: &str| table.column(name);
        let need = |name: &str| {
            find(name).ok_or_else(|| {
                bad(
                    table.head.line,
                    &format!("the head has no column `{name}`; needed are t, id, x, y, allowed are yaw, gesture, leaf"),
                )
            })
        };
        Ok(Self {
            t: need("t")?,
            id: need("id")?,
            x: need("x")?,
            y: need("y")?,
            yaw: find("yaw"),
            gesture: find("gesture"),
            leaf: find("leaf"),
        })
    }

    fn fix(&self, row: &Row) -> Result<(AgentId, Fix), StreamError> {
        let Row { line, cells } = row;
        let line = *line;
        let cell = |at: usize, name: &str| {
            row.cell(at)
                .ok_or_else(|| bad(line, &format!("column `{name}` is missing; the line has {} cells", cells.len())))
        };
        let number = |at: usize, name: &str| {
            let text = cell(at, name)?;
            // Beyond a million meters or seconds a track is an error of units.
            text.parse::<f64>().ok().filter(|value| value.abs() < 1e6).ok_or_else(|| {
                let shown: String = text.chars().take(40).collect();
                bad(line, &format!("`{shown}` in column `{name}` is not a number between -1000000 and 1000000"))
            })
        };
        let id = cell(self.id, "id")?;
        let agent = match id.parse::<u32>() {
            Ok(number) => AgentId::from_number(number),
            Err(_not_a_number) => {
                id.parse::<AgentId>().map_err(|why| bad(line, &format!("{why}, robot, or a number")))?
            }
        };
        // An empty heading is not known: it is taken from the motion.
        let yaw = match self.yaw {
            Some(at) if !cell(at, "yaw")?.is_empty() => Some(number(at, "yaw")?),
            Some(_) | None => None,
        };
        let gesture = match self.gesture.and_then(|at| cells.get(at)).filter(|gesture| !gesture.is_empty()) {
            Some(gesture) => Gesture::read(gesture).map_err(|why| bad(line, &why.to_string()))?,
            None => None,
        };
        let there = self.leaf.and_then(|at| cells.get(at)).is_none_or(|leaf| leaf != ABSENT_LEAF);
        let (t, x, y) = (number(self.t, "t")?, number(self.x, "x")?, number(self.y, "y")?);
        Ok((agent, Fix { t, x, y, yaw, gesture, there }))
    }
}

fn resampled(agent: AgentId, track: &[Fix], begin: f64, ticks: usize, stride: usize) -> Vec<AgentState> {
    let mut states: Vec<AgentState> = Vec::with_capacity(ticks);
    let mut at = 0_usize;
    let mut heading = track.first().and_then(|fix| fix.yaw).unwrap_or_else(|| first_heading(track));
    for tick in (0..ticks).map(|tick| tick * stride) {
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 ticks")]
        let t = begin + tick as f64 * STEP_SECS;
        while track.get(at + 1).is_some_and(|next| next.t <= t + SAME_SECS) {
            at += 1;
        }
        let Some(from) = track.get(at) else { break };
        let next = track.get(at + 1);
        let to = next.filter(|_| t >= from.t - SAME_SECS);
        // Half a step of slack at the ends, so that rounding of times takes nobody away.
        let (early, late) = (t < from.t - 0.5 * STEP_SECS, t > from.t + 0.5 * STEP_SECS);
        let there = from.there && !early && next.map_or(!late, |next| next.there || !late);
        let leaf = if there { 0 } else { ABSENT };
        let to = to.filter(|_| leaf != ABSENT);
        let (x, y, vx, vy) = match to {
            Some(to) => {
                let (span, share) = (to.t - from.t, (t - from.t) / (to.t - from.t));
                let (dx, dy) = (to.x - from.x, to.y - from.y);
                (from.x + dx * share, from.y + dy * share, dx / span, dy / span)
            }
            None => (from.x, from.y, 0.0, 0.0),
        };
        heading = match (from.yaw, to.and_then(|to| to.yaw.map(|yaw| (to.t, yaw)))) {
            (Some(a), Some((t1, b))) => {
                let share = (t - from.t) / (t1 - from.t);
                socrates_model::geometry::wrap_angle(a + socrates_model::geometry::wrap_angle(b - a) * share)
            }
            (Some(a), None) => a,
            (None, _) if libm::hypot(vx, vy) >= STILL_MPS => libm::atan2(vy, vx),
            (None, _) => heading,
        };
        let before = states.last().map_or(heading, |last| last.yaw);
        #[expect(clippy::cast_precision_loss, reason = "one or ten")]
        let omega = socrates_model::geometry::wrap_angle(heading - before) / (STEP_SECS * stride as f64);
        let gesture = if there { from.gesture } else { None };
        let flags = AgentState::flags(agent, gesture, leaf);
        states.push(AgentState { tick: tick as u64, agent: agent.number(), flags, x, y, yaw: heading, vx, vy, omega });
    }
    states
}

fn first_heading(track: &[Fix]) -> f64 {
    let moves = track.windows(2).filter_map(|pair| if let [a, b] = pair { Some((b.x - a.x, b.y - a.y)) } else { None });
    moves.into_iter().find(|(dx, dy)| libm::hypot(*dx, *dy) > 1e-3).map_or(0.0, |(dx, dy)| libm::atan2(dy, dx))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_come_to_the_step_with_heading_from_the_motion() {
        let recording = read_tracks("t,id,x,y\n0,robot,0,0\n1,robot,1,0\n0.5,2,0,3\n1,human_2,0,4\n").unwrap();
        assert_eq!(recording.ticks(), 101);
        assert_eq!(recording.header.agents.len(), 2);
        let robot = recording.tick(50)[0];
        assert!((robot.x - 0.5).abs() < 1e-9 && (robot.vx - 1.0).abs() < 1e-9);
        let human = recording.tick(75)[1];
        assert_eq!(human.agent_id().to_string(), "human_2");
        assert!((human.y - 3.5).abs() < 1e-9 && (human.yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        let before = recording.tick(10)[1];
        assert!((before.y - 3.0).abs() < 1e-12 && before.speed() < 1e-12);
    }

    #[test]
    fn a_cell_with_a_comma_is_quoted() {
        assert_eq!(joined(["a, \"b\"", "plain", "", " two\nlines"]), "\"a, \"\"b\"\"\",plain,,\" two\nlines\"");
        assert_eq!((joined([""]), joined(["plain"])), ("\"\"".to_owned(), "plain".to_owned()));
    }

    #[test]
    fn nobody_is_there_before_the_first_and_after_the_last_line() {
        let text = "t,id,x,y\n0.5,robot,0,0\n1,robot,1,0\n0,1,5,5\n2,1,5,3\n0.7,2,0,3\n1.3,2,0,4\n";
        let recording = read_tracks(text).unwrap();
        let absent = recording.header.absent().unwrap();
        let there = |number: u32| -> Vec<u64> {
            let states = recording.track(AgentId::from_number(number)).filter(|state| state.leaf() != absent);
            states.map(|state| state.tick).collect()
        };
        assert_eq!((there(0), there(1).len()), ((50..=100).collect::<Vec<u64>>(), 201));
        assert_eq!(there(2), (70..=130).collect::<Vec<u64>>());
        let gone = recording.tick(150)[2];
        assert!((gone.y - 4.0).abs() < 1e-12 && gone.speed() < 1e-12);
        // Where everybody is there all the time, there is no such leaf.
        assert_eq!(read_tracks("t,id,x,y\n0,1,5,5\n2,1,5,3\n").unwrap().header.leaves, [""]);
    }

    #[test]
    fn gestures_are_read_and_last_until_another_line_says_otherwise() {
        let text = "t,id,x,y,gesture\n0,1,5,5,NONE\n1,1,5,4,wait\n2,1,5,3,\n";
        let recording = read_tracks(text).unwrap();
        let waits: Vec<u64> = recording
            .frames
            .iter()
            .filter(|state| state.gesture() == Some(Gesture::Wait))
            .map(|state| state.tick)
            .collect();
        assert_eq!(waits, (100..200).collect::<Vec<u64>>());
    }

    #[test]
    fn a_crowd_over_a_long_time_is_read_ten_times_a_second() {
        let mut text = String::from("t,id,x,y\n");
        for id in 0..100 {
            text.push_str(&format!("0,{id},0,{id}\n500,{id},500,{id}\n"));
        }
        let recording = read_tracks(&text).unwrap();
        assert_eq!((recording.ticks(), recording.tick(1)[0].tick, recording.tick(5000)[7].tick), (5001, 10, 50_000));
        assert!((recording.tick(1)[3].x - 0.1).abs() < 1e-9);
    }

    #[test]
    fn who_is_written_as_absent_is_read_as_absent() {
        let text = "t,id,x,y\n0,1,5,5\n2,1,5,3\n0.5,2,0,3\n1,2,0,4\n";
        let mut first = read_tracks(text).unwrap();
        let away = |tick: u64| (60..80).contains(&tick);
        for state in first.frames.iter_mut().filter(|state| state.agent == 2 && away(state.tick)) {
            state.flags = AgentState::flags(state.agent_id(), None, ABSENT);
        }
        let again = read_tracks(&write_agents_at(&[&first], Rate::Every)).unwrap();
        let leaves = |recording: &Recording| recording.frames.iter().map(AgentState::leaf).collect::<Vec<_>>();
        assert_eq!(leaves(&again), leaves(&first));
    }

    #[test]
    fn what_is_written_is_read_again() {
        let first = read_tracks("t,id,x,y,yaw\n0,0,0,0,0\n2,0,2,0,1\n0,1,5,5,0\n2,1,5,3,0\n").unwrap();
        let again = read_tracks(&write_agents_at(&[&first], Rate::Every)).unwrap();
        assert_eq!(again.ticks(), first.ticks());
        for (a, b) in first.frames.iter().zip(&again.frames) {
            assert!((a.x - b.x).abs() < 1e-3 && (a.y - b.y).abs() < 1e-3 && (a.yaw - b.yaw).abs() < 1e-3);
        }
        assert_eq!(write_agents(&[&first]).lines().count(), 1 + 2 * 21);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, line, word) in [
            ("", 1, "empty"),
            ("t,id,x\n", 1, "`y`"),
            ("t,id,x,y\n", 1, "no line"),
            ("t,id,x,y\n0,robot,1,2\n\n0,dog,1,2\n", 4, "`dog`"),
            ("t,id,x,y\n0,1,one,2\n", 2, "`one`"),
            ("t,id,x,y\n0,1,nan,2\n", 2, "`nan`"),
            ("t,id,x,y\n0,1\n", 2, "`x`"),
            ("t,id,x,y\n0,1,0,0\n900000,1,0,0\n900000,2,0,0\n", 4, "milliseconds"),
            ("t,id,x,y,gesture\n0,1,0,0,BOW\n", 2, "`BOW`"),
        ] {
            let error = read_tracks(text).unwrap_err();
            let StreamError::Csv { line: found, why } = &error else { panic!("{error}") };
            assert_eq!((*found, why.contains(word)), (line, true), "{error}");
        }
    }
}
