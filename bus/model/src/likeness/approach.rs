//! How robot and person come near to each other on their ways, at usual paces: from which moment on the one is that near, and in
//! sight of the other.
//!
//! An estimate of the run, not the run: nobody makes way, waits for a door or is held up. Times are taken from the meeting, so that
//! the length of the ways before it makes no difference.

use crate::geometry::{Point, Vector};
use crate::grid::{Cell, Grid};
use crate::ids::AgentId;
use crate::location::Location;
use crate::paths::{Paths, Visit};
use crate::polyline::Polyline;
use crate::proposal::{HumanProposal, Relation};
use crate::rule::Trigger;

use super::ROBOT_MPS;

/// Usual pace of people, and of those who walk ahead of the robot, m/s.
const HUMAN_MPS: f64 = 1.2;
const AHEAD_MPS: f64 = 0.5;
/// Time between two looks, s, the longest time before a meeting that is looked at, and for how long after it.
const LOOK_S: f64 = 0.1;
const BEFORE_S: f64 = 60.0;
const AFTER_S: f64 = 10.0;
/// Cosine of half the field of view of people: 100° to either side, as people of a run have it.
const FIELD_OF_VIEW_COS: f64 = -0.173_648_177_666_930_33;

/// The ways of robot and person up to their first meeting and on from there.
pub(super) struct Approach<'a> {
    grid: &'a Grid,
    robot: Polyline,
    person: Polyline,
    /// Lengths along both at the meeting, m.
    met_m: [f64; 2],
    person_mps: f64,
}

impl<'a> Approach<'a> {
    /// The ways of a person and the robot; nothing where their first meeting is not on both.
    pub(super) fn of(human: &HumanProposal, paths: &Paths, location: &'a Location) -> Option<Self> {
        let visits = paths.visits(human.id);
        let Visit { robot_step, human_step, .. } = visits.first()?;
        let way = |agent: AgentId, step: Option<usize>| {
            let nodes = paths.of(agent)?;
            let upto = Polyline::new(&location.graph.polyline(nodes.get(..=step?)?));
            Some((Polyline::new(&location.graph.polyline(nodes)), upto.length_m()))
        };
        let (robot, robot_m) = way(AgentId::Robot, *robot_step)?;
        let (person, person_m) = way(AgentId::Human(human.id), *human_step)?;
        let person_mps = if human.relation == Relation::Ahead { AHEAD_MPS } else { HUMAN_MPS };
        Some(Self { grid: &location.grid, robot, person, met_m: [robot_m, person_m], person_mps })
    }

    /// When the robot is as near as a trigger wants for the first time, s from the meeting on; at the end of what is looked at where
    /// it never is.
    pub(super) fn since_meeting_s(&self, trigger: &Trigger, within_m: f64) -> f64 {
        let [robot_m, person_m] = self.met_m;
        let start_s = -(robot_m / ROBOT_MPS).min(BEFORE_S);
        // People who stand look around; people who walk see what is before them and beside them.
        let stands = self.person.length_m() < 1e-9;
        let mut at_s = start_s;
        while at_s < AFTER_S {
            let along_m = person_m + self.person_mps * at_s;
            let (robot, person) = (self.robot.point(robot_m + ROBOT_MPS * at_s), self.person.point(along_m));
            let way: Vector = robot - person;
            let distance_m = way.norm();
            if distance_m <= within_m {
                let heading = self.person.direction(along_m);
                let faces = stands || heading.dot(&way) >= FIELD_OF_VIEW_COS * distance_m;
                let needs_sight = matches!(trigger, Trigger::RobotVisible(_) | Trigger::RobotBlocking(_));
                if !needs_sight || faces && sees(self.grid, &person, &robot) {
                    return at_s;
                }
            }
            at_s += LOOK_S;
        }
        AFTER_S
    }
}

/// Whether no wall stands between two points; where the map says nothing nothing stands.
fn sees(grid: &Grid, from: &Point, to: &Point) -> bool {
    let step_m = grid.resolution_m.max(0.01);
    let way = to - from;
    let steps = libm::ceil(way.norm() / step_m).max(1.0);
    let mut step = 0.0;
    while step <= steps {
        let cell = grid.cell_of(&(from + way * (step / steps)));
        if cell.is_some_and(|(column, row)| grid.at(column, row) == Cell::Occupied) {
            return false;
        }
        step += 1.0;
    }
    true
}
