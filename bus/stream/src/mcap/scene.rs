//! Pictures of a run for viewers that know the messages of `foxglove`: what stands still once, what moves ten times a second.

use socrates_model::grid::{Cell, Grid};
use socrates_model::recording::{AgentState, RecordingHeader};
use socrates_model::{AgentId, Gesture, Location, SimTime};

use crate::foxglove::{
    AgentShape, Color, LINE_LIST, MAP, Proto, color_of, entity, head, line, locked, pose, stamp, transform,
};

/// Pause between two points of a drawn way at first, ticks.
const WAY_EVERY: u64 = 20;
/// Most points of all ways together: with more of them each way keeps every second.
const WAY_POINTS: usize = 128 * 1024;
const WALL: Color = [0.2, 0.2, 0.2, 1.0];
const DOOR: Color = [0.0, 0.62, 0.45, 1.0];

/// An entity that is a line on the map.
fn drawn(out: &mut Proto, id: &str, line: impl FnOnce(&mut Proto)) {
    entity(out, SimTime::ZERO, MAP, id, |out| {
        locked(out);
        line(out);
    });
}

/// One agent that is drawn.
#[derive(Debug)]
struct Figure {
    body: AgentShape,
    /// The gesture it is drawn with, or with none; outer `None` while it is not drawn.
    drawn: Option<Option<Gesture>>,
}

impl Figure {
    fn draw(&self, out: &mut Proto, time: SimTime, gesture: Option<Gesture>) {
        let name = &self.body.name;
        let label = gesture.map_or_else(|| name.clone(), |gesture| format!("{name}: {gesture}"));
        self.body.draw(out, time, |_| {}, &label);
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
        let figures: Vec<Figure> =
            header.agents.iter().map(|info| Figure { body: AgentShape::of(info), drawn: None }).collect();
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
        head(people, time, MAP);
        for (figure, state) in self.figures.iter_mut().zip(states) {
            if !Self::is_there(self.absent, state) {
                if figure.drawn.take().is_some() {
                    scene.message(1, |out| {
                        stamp(out, 1, time);
                        out.text(3, &figure.body.name);
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
            transform(frames, &figure.body.name, state, time);
            match figure.body.agent {
                AgentId::Human(_) => pose(people, 3, at, state.yaw),
                AgentId::Robot => {
                    head(robot, time, MAP);
                    pose(robot, 3, at, state.yaw);
                }
            }
        }
    }

    /// The way that everybody took, as one line each: a scene update that is empty where nobody moved.
    pub(super) fn ways(&self) -> Proto {
        let mut out = Proto::default();
        for (figure, way) in self.figures.iter().zip(&self.ways).filter(|(_, way)| way.len() > 1) {
            drawn(&mut out, &format!("way_{}", figure.body.name), |out| {
                line(out, 0, way.iter().copied(), 0.02, 0.04, color_of(figure.body.agent));
            });
        }
        out
    }
}

/// The outline of everything that is not free floor, and the doors.
pub(super) fn walls(location: &Location) -> Proto {
    let mut out = Proto::default();
    drawn(&mut out, "walls", |out| {
        line(out, LINE_LIST, outline(&location.grid).into_iter(), 0.0, 0.05, WALL);
    });
    for door in &location.doors {
        let ends = [[door.from.x, door.from.y], [door.to.x, door.to.y]];
        drawn(&mut out, &format!("door_{}", door.id), |out| {
            line(out, LINE_LIST, ends.into_iter(), 0.02, 0.08, DOOR);
        });
    }
    out
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
