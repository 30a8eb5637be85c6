//! Messages of `foxglove`, which Foxglove, Lichtblick and Rerun know by name: what recordings and live views share.
//!
//! Functions write into a message that is open, in order of its fields; `field` is the number of a message within.

mod floor;
mod proto;
mod schema;

use socrates_model::grid::Grid;
use socrates_model::recording::{AgentInfo, AgentState};
use socrates_model::{AgentId, SimTime};

pub use floor::FLOOR_CELLS;
pub use proto::Proto;
pub(crate) use schema::description;
pub use schema::description_by_files;

/// Frame of the map.
pub const MAP: &str = "map";
/// Kind of a line of two points each.
pub const LINE_LIST: u64 = 2;
/// Number of `UINT8` among the types of a packed field.
const UINT8: u64 = 1;
/// Number of `FLOAT32` among the types of a packed field.
pub const FLOAT32: u64 = 7;
/// Height at which people are drawn, m.
const PERSON_M: f64 = 1.7;
/// Height at which the robot is drawn, m.
const ROBOT_M: f64 = 0.6;
/// Height of a line of text, m.
const TEXT_M: f64 = 0.25;
const NANOS: u64 = 1_000_000_000;

/// Red, green, blue and opacity, each from 0 to 1.
pub type Color = [f64; 4];
const DARK: Color = [0.1, 0.1, 0.1, 1.0];

/// A time.
pub fn stamp(out: &mut Proto, field: u32, time: SimTime) {
    let (seconds, nanos) = (time.nanos() / NANOS, time.nanos() % NANOS);
    if !(out.is_lean && seconds > u64::from(u32::MAX)) {
        out.message(field, |out| {
            out.number(1, seconds);
            out.number(2, nanos);
        });
    }
}

/// The first two fields of most messages: the time, and the frame in which the rest is.
pub fn head(out: &mut Proto, time: SimTime, frame: &str) {
    stamp(out, 1, time);
    out.text(2, frame);
}

/// A vector or a point.
pub fn vector(out: &mut Proto, field: u32, at: [f64; 3]) {
    out.message(field, |out| (1_u32..).zip(at).for_each(|(axis, value)| out.double(axis, value)));
}

/// A rotation around the vertical, rad.
fn turned(out: &mut Proto, field: u32, yaw: f64) {
    out.message(field, |out| {
        out.double(3, libm::sin(yaw / 2.0));
        out.double(4, libm::cos(yaw / 2.0));
    });
}

/// A place, m, and a heading, rad.
pub fn pose(out: &mut Proto, field: u32, at: [f64; 3], yaw: f64) {
    out.message(field, |out| {
        vector(out, 1, at);
        turned(out, 2, yaw);
    });
}

fn color(out: &mut Proto, field: u32, rgba: Color) {
    out.message(field, |out| (1_u32..).zip(rgba).for_each(|(channel, value)| out.double(channel, value)));
}

/// A number of a packed point or cell: its name, its place, m, and the number of its type.
pub fn packed(out: &mut Proto, field: u32, name: &str, offset: u32, kind: u64) {
    out.message(field, |out| {
        out.text(1, name);
        out.fixed(2, offset);
        out.number(3, kind);
    });
}

/// `FrameTransforms`: one more frame in that of the map.
pub fn transform(out: &mut Proto, name: &str, state: &AgentState, time: SimTime) {
    out.message(1, |out| {
        head(out, time, MAP);
        out.text(3, name);
        vector(out, 4, [state.x, state.y, 0.0]);
        turned(out, 5, state.yaw);
    });
}

/// `Grid`: the map, its first row at the bottom; nothing where cells are missing or there are none.
pub fn occupancy(out: &mut Proto, grid: &Grid) {
    let Some(floor) = floor::floor(grid) else { return };
    let Ok(columns) = u32::try_from(floor.columns) else { return };
    head(out, SimTime::ZERO, MAP);
    pose(out, 3, [grid.origin.x, grid.origin.y, 0.0], grid.origin.yaw);
    out.fixed(4, columns);
    out.message(5, |out| (1..=2).for_each(|axis| out.double(axis, floor.side_m)));
    out.fixed(6, columns);
    out.fixed(7, 1);
    packed(out, 8, "occupancy", 0, UINT8);
    out.data(9, &floor.cells);
}

/// `SceneUpdate`: one more entity, with what `shapes` writes into it.
pub fn entity(out: &mut Proto, time: SimTime, frame: &str, id: &str, shapes: impl FnOnce(&mut Proto)) {
    out.message(2, |out| {
        head(out, time, frame);
        out.text(3, id);
        shapes(out);
    });
}

/// `SceneEntity`: it moves with its frame.
pub fn locked(out: &mut Proto) {
    out.number(5, 1);
}

/// `SceneEntity`: a fact about it.
pub fn fact(out: &mut Proto, key: &str, value: &str) {
    out.message(6, |out| {
        out.text(1, key);
        out.text(2, value);
    });
}

/// `SceneEntity`: a cylinder around a place, m; `top` is the ratio of its upper width to its lower width.
pub fn cylinder(out: &mut Proto, at: [f64; 3], size: [f64; 3], top: f64, rgba: Color) {
    out.message(10, |out| {
        pose(out, 1, at, 0.0);
        vector(out, 2, size);
        out.double(3, 1.0);
        out.double(4, top);
        color(out, 5, rgba);
    });
}

/// `SceneEntity`: a line at one height, m, of one thickness, m; `kind` is 0 for a line through all points or [`LINE_LIST`].
pub fn line(out: &mut Proto, kind: u64, points: impl Iterator<Item = [f64; 2]>, z: f64, thickness: f64, rgba: Color) {
    out.message(11, |out| {
        out.number(1, kind);
        pose(out, 2, [0.0; 3], 0.0);
        out.double(3, thickness);
        points.for_each(|[x, y]| vector(out, 5, [x, y, z]));
        color(out, 6, rgba);
    });
}

/// `SceneEntity`: a text above its frame that faces the viewer; height in m.
fn text(out: &mut Proto, z: f64, text: &str, rgba: Color) {
    out.message(13, |out| {
        pose(out, 1, [0.0, 0.0, z], 0.0);
        out.number(2, 1);
        out.double(3, TEXT_M);
        color(out, 5, rgba);
        out.text(6, text);
    });
}

/// Color of an agent and of the way it took.
#[must_use]
pub const fn color_of(agent: AgentId) -> Color {
    match agent {
        AgentId::Robot => [0.0, 0.45, 0.7, 1.0],
        AgentId::Human(_) => [0.84, 0.37, 0.0, 1.0],
    }
}

/// An agent as it is drawn, fixed to its own frame.
#[derive(Debug, Clone)]
pub struct AgentShape {
    /// The agent.
    pub agent: AgentId,
    /// Name of the agent, which is that of its frame and of its entity.
    pub name: String,
    radius_m: f64,
    height_m: f64,
}

impl AgentShape {
    /// The body of an agent.
    #[must_use]
    pub fn of(info: &AgentInfo) -> Self {
        let height_m = if info.agent == AgentId::Robot { ROBOT_M } else { PERSON_M };
        Self { agent: info.agent, name: info.agent.to_string(), radius_m: info.radius_m, height_m }
    }

    /// `SceneUpdate`: body, heading and a text, with the facts that `facts` writes.
    pub fn draw(&self, out: &mut Proto, time: SimTime, facts: impl FnOnce(&mut Proto), label: &str) {
        entity(out, time, &self.name, &self.name, |out| {
            locked(out);
            facts(out);
            out.message(7, |out| {
                pose(out, 1, [0.0, 0.0, self.height_m + 0.05], 0.0);
                out.double(2, self.radius_m + 0.2);
                out.double(3, 0.06);
                out.double(4, 0.15);
                out.double(5, 0.15);
                color(out, 6, DARK);
            });
            let size = [2.0 * self.radius_m, 2.0 * self.radius_m, self.height_m];
            cylinder(out, [0.0, 0.0, self.height_m / 2.0], size, 0.8, color_of(self.agent));
            text(out, self.height_m + 0.3, label, DARK);
        });
    }

    /// `SceneUpdate`: a text of its own above that.
    pub fn label(&self, out: &mut Proto, time: SimTime, label: &str, rgba: Color) {
        entity(out, time, &self.name, &format!("label_{}", self.name), |out| {
            locked(out);
            text(out, self.height_m + 0.65, label, rgba);
        });
    }
}
