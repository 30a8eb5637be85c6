//! Pictures of a run for viewers that know `foxglove.SceneUpdate`.

use serde_json::{Value, json};
use socrates_model::grid::{Cell, Grid};
use socrates_model::recording::{AgentState, Recording, RecordingHeader};
use socrates_model::{AgentId, Gesture, Location, SimTime};

/// What a viewer needs to know of a scene message.
pub(super) const SCENE_SCHEMA: &str = r#"{"title":"foxglove.SceneUpdate","type":"object","properties":{"deletions":{"type":"array","items":{"type":"object"}},"entities":{"type":"array","items":{"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"frame_id":{"type":"string"},"id":{"type":"string"},"lifetime":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"frame_locked":{"type":"boolean"},"metadata":{"type":"array","items":{"type":"object"}},"arrows":{"type":"array","items":{"type":"object"}},"cubes":{"type":"array","items":{"type":"object"}},"spheres":{"type":"array","items":{"type":"object"}},"cylinders":{"type":"array","items":{"type":"object"}},"lines":{"type":"array","items":{"type":"object"}},"triangles":{"type":"array","items":{"type":"object"}},"texts":{"type":"array","items":{"type":"object"}},"models":{"type":"array","items":{"type":"object"}}}}}}}"#;
/// What a viewer needs to know of a frame message.
pub(super) const FRAME_SCHEMA: &str = r#"{"title":"foxglove.FrameTransform","type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},"rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}}}"#;

/// Height at which people are drawn, m.
const PERSON_M: f64 = 1.7;
/// Height at which the robot is drawn, m.
const ROBOT_M: f64 = 0.6;
/// Pause between two points of a drawn way, ticks.
const WAY_EVERY: usize = 20;

fn stamp(time: SimTime) -> Value {
    json!({ "sec": time.nanos() / 1_000_000_000, "nsec": time.nanos() % 1_000_000_000 })
}

fn color(r: f64, g: f64, b: f64, a: f64) -> Value {
    json!({ "r": r, "g": g, "b": b, "a": a })
}

fn position(x: f64, y: f64, z: f64) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

fn turned(yaw: f64) -> Value {
    json!({ "x": 0.0, "y": 0.0, "z": libm::sin(yaw / 2.0), "w": libm::cos(yaw / 2.0) })
}

fn agent_color(agent: AgentId) -> Value {
    match agent {
        AgentId::Robot => color(0.0, 0.45, 0.7, 1.0),
        AgentId::Human(_) => color(0.84, 0.37, 0.0, 1.0),
    }
}

fn entity(id: &str, time: SimTime, shapes: Vec<(&str, Value)>) -> Value {
    let mut entity = json!({
        "timestamp": stamp(time), "frame_id": "map", "id": id, "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": true, "metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": [],
        "lines": [], "triangles": [], "texts": [], "models": []
    });
    if let Some(fields) = entity.as_object_mut() {
        for (kind, shape) in shapes {
            fields.insert(kind.to_owned(), shape);
        }
    }
    entity
}

fn update(entities: Vec<Value>) -> Value {
    json!({ "deletions": [], "entities": entities })
}

fn line(kind: u8, points: &[(f64, f64)], z: f64, thickness: f64, color: &Value) -> Value {
    let points: Vec<Value> = points.iter().map(|(x, y)| position(*x, *y, z)).collect();
    json!({
        "type": kind, "pose": { "position": position(0.0, 0.0, 0.0), "orientation": turned(0.0) },
        "thickness": thickness, "scale_invariant": false, "points": points, "color": color, "colors": [], "indices": []
    })
}

/// Everybody at one tick: a cylinder, an arrow for the heading, name and gesture.
pub(super) fn agents(header: &RecordingHeader, states: &[AgentState], time: SimTime) -> Value {
    let drawn = header.agents.iter().zip(states).map(|(info, state)| {
        let height = if info.agent == AgentId::Robot { ROBOT_M } else { PERSON_M };
        let color_of = agent_color(info.agent);
        let pose = |z: f64| json!({ "position": position(state.x, state.y, z), "orientation": turned(state.yaw) });
        let size = position(2.0 * info.radius_m, 2.0 * info.radius_m, height);
        let cylinder = json!({ "pose": pose(height / 2.0), "size": size, "bottom_scale": 1.0, "top_scale": 0.8, "color": color_of });
        let arrow = json!({
            "pose": pose(height + 0.05), "shaft_length": info.radius_m + 0.2, "shaft_diameter": 0.06,
            "head_length": 0.15, "head_diameter": 0.15, "color": color(0.1, 0.1, 0.1, 1.0)
        });
        let gesture = state.gesture();
        let text =
            if gesture == Gesture::None { info.agent.to_string() } else { format!("{}: {gesture}", info.agent) };
        let label = json!({
            "pose": pose(height + 0.3), "billboard": true, "font_size": 0.25, "scale_invariant": false,
            "color": color(0.1, 0.1, 0.1, 1.0), "text": text
        });
        let shapes = vec![("cylinders", json!([cylinder])), ("arrows", json!([arrow])), ("texts", json!([label]))];
        entity(&info.agent.to_string(), time, shapes)
    });
    update(drawn.collect())
}

/// The frame of one agent in the map.
pub(super) fn frame(state: &AgentState, time: SimTime) -> Value {
    json!({
        "timestamp": stamp(time), "parent_frame_id": "map", "child_frame_id": state.agent_id().to_string(),
        "translation": position(state.x, state.y, 0.0), "rotation": turned(state.yaw)
    })
}

/// The way that everybody took, as one line each; `None` for an empty run.
pub(super) fn ways(recording: &Recording) -> Option<Value> {
    if recording.ticks() == 0 {
        return None;
    }
    let drawn = recording.header.agents.iter().map(|info| {
        let points: Vec<(f64, f64)> =
            recording.track(info.agent).step_by(WAY_EVERY).map(|state| (state.x, state.y)).collect();
        let way = line(0, &points, 0.02, 0.04, &agent_color(info.agent));
        entity(&format!("way_{}", info.agent), SimTime::ZERO, vec![("lines", json!([way]))])
    });
    Some(update(drawn.collect()))
}

/// The outline of everything that is not free floor, and the doors.
pub(super) fn walls(location: &Location) -> Value {
    let outline = line(2, &outline(&location.grid), 0.0, 0.05, &color(0.2, 0.2, 0.2, 1.0));
    let mut shapes = vec![entity("walls", SimTime::ZERO, vec![("lines", json!([outline]))])];
    for door in &location.doors {
        let ends = [(door.from.x, door.from.y), (door.to.x, door.to.y)];
        let drawn = line(2, &ends, 0.02, 0.08, &color(0.0, 0.62, 0.45, 1.0));
        shapes.push(entity(&format!("door_{}", door.id), SimTime::ZERO, vec![("lines", json!([drawn]))]));
    }
    update(shapes)
}

/// Pairs of points: every straight stretch between free floor and an occupied cell.
fn outline(grid: &Grid) -> Vec<(f64, f64)> {
    let differs = |a: Cell, b: Cell| matches!((a, b), (Cell::Free, Cell::Occupied) | (Cell::Occupied, Cell::Free));
    let mut points = Vec::new();
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let mut stretch = |from: (usize, usize), to: (usize, usize)| {
        for (column, row) in [from, to] {
            let point = grid.world_from_pixel(column as f64, row as f64);
            points.push((point.x, point.y));
        }
    };
    for row in 1..grid.height {
        runs(
            grid.width,
            |column| differs(grid.at(column, row - 1), grid.at(column, row)),
            |a, b| stretch((a, row), (b, row)),
        );
    }
    for column in 1..grid.width {
        runs(
            grid.height,
            |row| differs(grid.at(column - 1, row), grid.at(column, row)),
            |a, b| stretch((column, a), (column, b)),
        );
    }
    points
}

/// Calls `found(begin, end)` for every longest run of places where `is` holds.
fn runs(len: usize, is: impl Fn(usize) -> bool, mut found: impl FnMut(usize, usize)) {
    let mut begin = None;
    for at in 0..=len {
        let here = at < len && is(at);
        match (begin, here) {
            (None, true) => begin = Some(at),
            (Some(from), false) => {
                found(from, at);
                begin = None;
            }
            (None, false) | (Some(_), true) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::Pose;

    #[test]
    fn a_block_of_four_cells_has_four_walls() {
        let mut cells = vec![Cell::Free; 36];
        for at in [14, 15, 20, 21] {
            cells[at] = Cell::Occupied;
        }
        let grid = Grid { width: 6, height: 6, resolution_m: 0.5, origin: Pose::new(0., 0., 0.), cells };
        let outline = outline(&grid);
        assert_eq!(outline.len(), 8);
        let length: f64 =
            outline.chunks(2).map(|pair| (pair[0].0 - pair[1].0).abs() + (pair[0].1 - pair[1].1).abs()).sum();
        assert!((length - 4.0).abs() < 1e-9);
    }
}
