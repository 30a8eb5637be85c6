//! Pictures of a run for viewers that know the messages of `foxglove`: what stands still once, what moves ten times a second.

use socrates_model::grid::{Cell, Grid};
use socrates_model::recording::{AgentState, RecordingHeader};
use socrates_model::{AgentId, Gesture, Location, SimTime};

use super::floor;
use super::proto::Proto;

/// Height at which people are drawn, m.
const PERSON_M: f64 = 1.7;
/// Height at which the robot is drawn, m.
const ROBOT_M: f64 = 0.6;
/// Pause between two points of a drawn way at first, ticks.
const WAY_EVERY: u64 = 20;
/// Most points of all ways together: with more of them each way keeps every second.
const WAY_POINTS: usize = 128 * 1024;
/// Frame of the map.
const MAP: &str = "map";
/// A list of lines, two points each.
const LINE_LIST: u64 = 2;

const DARK: [f64; 4] = [0.1, 0.1, 0.1, 1.0];
const WALL: [f64; 4] = [0.2, 0.2, 0.2, 1.0];
const DOOR: [f64; 4] = [0.0, 0.62, 0.45, 1.0];

fn stamp(out: &mut Proto, field: u32, time: SimTime) {
    out.message(field, |out| {
        out.number(1, time.nanos() / 1_000_000_000);
        out.number(2, time.nanos() % 1_000_000_000);
    });
}

fn vector(out: &mut Proto, field: u32, [x, y, z]: [f64; 3]) {
    out.message(field, |out| {
        out.double(1, x);
        out.double(2, y);
        out.double(3, z);
    });
}

fn turned(out: &mut Proto, field: u32, yaw: f64) {
    out.message(field, |out| {
        out.double(3, libm::sin(yaw / 2.0));
        out.double(4, libm::cos(yaw / 2.0));
    });
}

fn pose(out: &mut Proto, field: u32, at: [f64; 3], yaw: f64) {
    out.message(field, |out| {
        vector(out, 1, at);
        turned(out, 2, yaw);
    });
}

fn color(out: &mut Proto, field: u32, rgba: [f64; 4]) {
    out.message(field, |out| (1_u32..).zip(rgba).for_each(|(channel, value)| out.double(channel, value)));
}

const fn color_of(agent: AgentId) -> [f64; 4] {
    match agent {
        AgentId::Robot => [0.0, 0.45, 0.7, 1.0],
        AgentId::Human(_) => [0.84, 0.37, 0.0, 1.0],
    }
}

/// An entity of a scene update, fixed to its frame.
fn entity(out: &mut Proto, time: SimTime, frame: &str, id: &str, shapes: impl FnOnce(&mut Proto)) {
    out.message(2, |out| {
        stamp(out, 1, time);
        out.text(2, frame);
        out.text(3, id);
        out.number(5, 1);
        shapes(out);
    });
}

/// A line primitive of an entity.
fn line(out: &mut Proto, kind: u64, points: impl Iterator<Item = [f64; 2]>, z: f64, thickness: f64, rgba: [f64; 4]) {
    out.message(11, |out| {
        out.number(1, kind);
        pose(out, 2, [0.0; 3], 0.0);
        out.double(3, thickness);
        points.for_each(|[x, y]| vector(out, 5, [x, y, z]));
        color(out, 6, rgba);
    });
}

/// One agent that is drawn.
#[derive(Debug)]
struct Figure {
    agent: AgentId,
    name: String,
    radius_m: f64,
    /// The gesture it is drawn with, or with none; outer `None` while it is not drawn.
    drawn: Option<Option<Gesture>>,
}

impl Figure {
    /// Body, heading and name, fixed to the agent's own frame.
    fn draw(&self, out: &mut Proto, time: SimTime, gesture: Option<Gesture>) {
        let height = if self.agent == AgentId::Robot { ROBOT_M } else { PERSON_M };
        entity(out, time, &self.name, &self.name, |out| {
            out.message(7, |out| {
                pose(out, 1, [0.0, 0.0, height + 0.05], 0.0);
                out.double(2, self.radius_m + 0.2);
                out.double(3, 0.06);
                out.double(4, 0.15);
                out.double(5, 0.15);
                color(out, 6, DARK);
            });
            out.message(10, |out| {
                pose(out, 1, [0.0, 0.0, height / 2.0], 0.0);
                vector(out, 2, [2.0 * self.radius_m, 2.0 * self.radius_m, height]);
                out.double(3, 1.0);
                out.double(4, 0.8);
                color(out, 5, color_of(self.agent));
            });
            out.message(13, |out| {
                pose(out, 1, [0.0, 0.0, height + 0.3], 0.0);
                out.number(2, 1);
                out.double(3, 0.25);
                color(out, 5, DARK);
                match gesture {
                    Some(gesture) => out.text(6, &format!("{}: {gesture}", self.name)),
                    None => out.text(6, &self.name),
                }
            });
        });
    }
}

/// Draws the agents of a run.
#[derive(Debug)]
pub(super) struct Painter {
    figures: Vec<Figure>,
    absent: Option<u16>,
    ways: Vec<Vec<[f64; 2]>>,
    way_every: u64,
    way_points: usize,
}

/// The messages of one moment, in memory that is used again; an empty one has nothing new.
#[derive(Debug, Default)]
pub(super) struct Picture {
    /// `foxglove.SceneUpdate`: who comes, who goes, who begins or ends a gesture.
    pub(super) scene: Proto,
    /// `foxglove.FrameTransforms`: where everybody is.
    pub(super) frames: Proto,
    /// `foxglove.PosesInFrame`: the people.
    pub(super) people: Proto,
    /// `foxglove.PoseInFrame`: the robot.
    pub(super) robot: Proto,
}

impl Painter {
    pub(super) fn new(header: &RecordingHeader) -> Self {
        let figures: Vec<Figure> = header
            .agents
            .iter()
            .map(|info| Figure {
                agent: info.agent,
                name: info.agent.to_string(),
                radius_m: info.radius_m,
                drawn: None,
            })
            .collect();
        let ways = figures.iter().map(|_| Vec::new()).collect();
        Self { figures, absent: header.absent(), ways, way_every: WAY_EVERY, way_points: 0 }
    }

    fn is_there(absent: Option<u16>, state: &AgentState) -> bool {
        absent.is_none_or(|absent| state.leaf() != absent)
    }

    /// Notes where everybody is, for the ways that are drawn at the end.
    pub(super) fn follow(&mut self, tick: u64, states: &[AgentState]) {
        if !tick.is_multiple_of(self.way_every) {
            return;
        }
        let absent = self.absent;
        for (way, state) in self.ways.iter_mut().zip(states).filter(|(_, state)| Self::is_there(absent, state)) {
            way.push([state.x, state.y]);
            self.way_points += 1;
        }
        if self.way_points > WAY_POINTS {
            self.way_every *= 2;
            for way in &mut self.ways {
                let mut place = 0_usize;
                way.retain(|_| {
                    place += 1;
                    !place.is_multiple_of(2)
                });
            }
            self.way_points = self.ways.iter().map(Vec::len).sum();
        }
    }

    /// Draws everybody who is there at one tick.
    pub(super) fn paint(&mut self, picture: &mut Picture, states: &[AgentState], time: SimTime) {
        let Picture { scene, frames, people, robot } = picture;
        [&mut *scene, frames, people, robot].into_iter().for_each(Proto::clear);
        stamp(people, 1, time);
        people.text(2, MAP);
        for (figure, state) in self.figures.iter_mut().zip(states) {
            if !Self::is_there(self.absent, state) {
                if figure.drawn.take().is_some() {
                    scene.message(1, |out| {
                        stamp(out, 1, time);
                        out.text(3, &figure.name);
                    });
                }
                continue;
            }
            let gesture = state.gesture();
            if figure.drawn != Some(gesture) {
                figure.draw(scene, time, gesture);
                figure.drawn = Some(gesture);
            }
            let at = [state.x, state.y, 0.0];
            frames.message(1, |out| {
                stamp(out, 1, time);
                out.text(2, MAP);
                out.text(3, &figure.name);
                vector(out, 4, at);
                turned(out, 5, state.yaw);
            });
            match figure.agent {
                AgentId::Human(_) => pose(people, 3, at, state.yaw),
                AgentId::Robot => {
                    stamp(robot, 1, time);
                    robot.text(2, MAP);
                    pose(robot, 3, at, state.yaw);
                }
            }
        }
    }

    /// The way that everybody took, as one line each: a scene update that is empty where nobody moved.
    pub(super) fn ways(&self) -> Proto {
        let mut out = Proto::default();
        for (figure, way) in self.figures.iter().zip(&self.ways).filter(|(_, way)| way.len() > 1) {
            entity(&mut out, SimTime::ZERO, MAP, &format!("way_{}", figure.name), |out| {
                line(out, 0, way.iter().copied(), 0.02, 0.04, color_of(figure.agent));
            });
        }
        out
    }
}

/// The outline of everything that is not free floor, and the doors.
pub(super) fn walls(location: &Location) -> Proto {
    let mut out = Proto::default();
    entity(&mut out, SimTime::ZERO, MAP, "walls", |out| {
        line(out, LINE_LIST, outline(&location.grid).into_iter(), 0.0, 0.05, WALL);
    });
    for door in &location.doors {
        let ends = [[door.from.x, door.from.y], [door.to.x, door.to.y]];
        entity(&mut out, SimTime::ZERO, MAP, &format!("door_{}", door.id), |out| {
            line(out, LINE_LIST, ends.into_iter(), 0.02, 0.08, DOOR);
        });
    }
    out
}

/// `foxglove.Grid`: the map, its first row at the bottom; none where it has no cells.
pub(super) fn grid(location: &Location) -> Option<Proto> {
    /// Number of `UINT8` among the types of a field.
    const UINT8: u64 = 1;
    let floor = floor::floor(&location.grid)?;
    let columns = u32::try_from(floor.columns).ok()?;
    let origin = &location.grid.origin;
    let mut out = Proto::default();
    stamp(&mut out, 1, SimTime::ZERO);
    out.text(2, MAP);
    pose(&mut out, 3, [origin.x, origin.y, 0.0], origin.yaw);
    out.fixed(4, columns);
    out.message(5, |out| {
        out.double(1, floor.side_m);
        out.double(2, floor.side_m);
    });
    out.fixed(6, columns);
    out.fixed(7, 1);
    out.message(8, |out| {
        out.text(1, "occupancy");
        out.number(3, UINT8);
    });
    out.data(9, &floor.cells);
    Some(out)
}

/// Pairs of points: every straight stretch between free floor and an occupied cell.
fn outline(grid: &Grid) -> Vec<[f64; 2]> {
    let differs = |a: Cell, b: Cell| matches!((a, b), (Cell::Free, Cell::Occupied) | (Cell::Occupied, Cell::Free));
    let mut points = Vec::new();
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let mut stretch = |from: (usize, usize), to: (usize, usize)| {
        for (column, row) in [from, to] {
            let point = grid.world_from_pixel(column as f64, row as f64);
            points.push([point.x, point.y]);
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
            outline.chunks(2).map(|pair| (pair[0][0] - pair[1][0]).abs() + (pair[0][1] - pair[1][1]).abs()).sum();
        assert!((length - 4.0).abs() < 1e-9);
    }
}
