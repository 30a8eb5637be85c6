//! The trajectory database of JuPedSim, version 2: tables of SQLite with frames, floor and metadata.
//!
//! Later versions of the writer drop the orientation; the readers that are released take version 2 alone.

use socrates_model::AgentState;

use super::content::{Content, NEVER_SEEN, WORDS, tracks_lack};
use super::frames::{file_name, samples};
use super::outline::walkable;
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// Frames a second.
const FPS: i64 = 100;
/// Most frames that the shell writes in one database.
const MOST_ROWS: usize = 50_000_000;

/// A value of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number.
    Integer(i64),
    /// A real.
    Real(f64),
    /// Text.
    Text(String),
}

/// A table with its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The statement that makes it.
    pub create: &'static str,
    /// The statement that puts a row in, with a question mark for each value.
    pub insert: &'static str,
    /// Rows in the order in which they are put in.
    pub rows: Vec<Vec<Value>>,
}

/// A database of SQLite before it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Database {
    /// Tables in order.
    pub tables: Vec<Table>,
    /// Statements after the rows.
    pub indexes: &'static [&'static str],
}

const LACKS_POSITIONS: &str = "the format holds positions and orientations alone";

pub(super) const FORMAT: Format = Format {
    name: "jupedsim-2",
    stem: "jupedsim",
    about: "trajectory database of JuPedSim (SQLite, version 2), 100 frames a second; the robot is 0",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `jupedsim` 1.4.2 and `pedpy` 1.5.1",
    needs_run: true,
    feature: None,
    lacks: tracks_lack!(
        [],
        LACKS_POSITIONS,
        [
            (Content::UnknownCells, NEVER_SEEN),
            (Content::Doors, "doors stand open: the floor is written once"),
            (Content::DoorRules, "doors stand open: the floor is written once"),
        ],
        WORDS
    ),
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    if run.frames.len() > MOST_ROWS {
        let problem = format!("the run has {} states; at most {MOST_ROWS} are written", run.frames.len());
        return Err(Unusable::new("recording", problem, "export a shorter run"));
    }
    let floor = walkable(&scenario.location.grid, losses)?;
    let samples = samples(run, 1)?;
    let frame = |number: u64| i64::try_from(number).unwrap_or(i64::MAX);
    let row = |number: u64, state: &AgentState| {
        vec![
            Value::Integer(frame(number)),
            Value::Integer(i64::from(state.agent)),
            Value::Real(micro(state.x)),
            Value::Real(micro(state.y)),
            Value::Real(micro(libm::cos(state.yaw))),
            Value::Real(micro(libm::sin(state.yaw))),
        ]
    };
    let tracks: Vec<Vec<Value>> = samples
        .iter()
        .flat_map(|sample| sample.states.iter().map(|state| row(sample.number, state)).collect::<Vec<_>>())
        .collect();
    // The hash only has to tell geometries apart, and there is one.
    let geometry = Value::Integer(1);
    let frames = samples.iter().map(|sample| vec![Value::Integer(frame(sample.number)), geometry.clone()]).collect();
    let corners = floor.rings.iter().flatten();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for corner in corners {
        low = [low[0].min(corner.x), low[1].min(corner.y)];
        high = [high[0].max(corner.x), high[1].max(corner.y)];
    }
    let meta = |key: &str, value: String| vec![Value::Text(key.to_owned()), Value::Text(value)];
    let real = super::frames::real;
    let metadata = vec![
        meta("version", "2".to_owned()),
        meta("fps", format!("{FPS}.0")),
        meta("xmin", real(low[0])),
        meta("xmax", real(high[0])),
        meta("ymin", real(low[1])),
        meta("ymax", real(high[1])),
    ];
    let wkt = format!("GEOMETRYCOLLECTION ({})", floor.polygon());
    let database = Database {
        tables: vec![
            Table {
                create: "CREATE TABLE trajectory_data (frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL, \
                         pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL)",
                insert: "INSERT INTO trajectory_data VALUES (?, ?, ?, ?, ?, ?)",
                rows: tracks,
            },
            Table {
                create: "CREATE TABLE metadata (key TEXT NOT NULL UNIQUE, value TEXT NOT NULL)",
                insert: "INSERT INTO metadata VALUES (?, ?)",
                rows: metadata,
            },
            Table {
                create: "CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL)",
                insert: "INSERT INTO geometry VALUES (?, ?)",
                rows: vec![vec![geometry.clone(), Value::Text(wkt)]],
            },
            Table {
                create: "CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL)",
                insert: "INSERT INTO frame_data VALUES (?, ?)",
                rows: frames,
            },
        ],
        indexes: &[
            "CREATE UNIQUE INDEX geometry_hash ON geometry (hash)",
            "CREATE INDEX frame_id_idx ON trajectory_data (frame, id)",
        ],
    };
    Ok(Files::from([(format!("{}.sqlite", file_name(&scenario.name, losses)), File::Database(database))]))
}
