//! Metrics while the run goes on.
//!
//! ```text
//! setting ─► Online ◄─ push(robot, people) at each time ◄─ arrived(t)
//!                └──► values() at any time: those of a recording that ends there
//! ```
//!
//! One code for both: what a recording is judged by ([`crate::metrics::measure`]) is fed row by row to the same
//! [`Online`]. Each time costs the same, however long the run is; a look at the values so far copies what has been kept,
//! because the last row's velocities are those of a run that ends there.

use std::collections::VecDeque;

use socrates_maps::{DistanceField, Geodesic};
use socrates_model::{MetricValue, Missing, Point};

use crate::metrics::collisions::WALL_SLACK_M;
use crate::metrics::grid::{Grid, Row};
use crate::metrics::scene::{EVEN_SECS, Gap, REARM_M, REARM_SECS};
use crate::metrics::ttc::time_to_collision;
use crate::metrics::{CATALOG, Measure, Measured, Need, valued};
use crate::running::{Pen, Piece, Stretches};
use crate::tracks::{Sample, between};

/// Time looked back for the agent that closes in, s: just before a contact both still move as they meant to. Two rows, because
/// velocities look one ahead.
const BEFORE_SECS: f64 = 2.0 * EVEN_SECS;

/// What is known before the first sample.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// Radius of the robot, m.
    pub robot_radius_m: f64,
    /// Nominal speed of the robot, m/s; 0 where it is not known.
    pub robot_speed_mps: f64,
    /// Radius of each human, m, in the order in which they are pushed.
    pub humans_radius_m: &'a [f64],
    /// The robot's goal; without it no metric of the goal has a value.
    pub goal: Option<Point>,
    /// Distance to walls; without it no metric of walls has a value.
    pub field: Option<&'a DistanceField>,
    /// Shortest ways to the goal; without them they are straight.
    pub geodesic: Option<&'a Geodesic>,
}

impl Setting<'_> {
    /// Shortest way from a point to the goal, m; straight where there is no map.
    pub(super) fn to_goal_m(self, from: &Point) -> Option<f64> {
        let goal = self.goal?;
        match self.geodesic {
            Some(geodesic) => geodesic.distance(from),
            None => Some((goal - from).norm()),
        }
    }
}

/// One time of the run with what several metrics look at.
pub(super) struct Now<'a> {
    pub(super) t: f64,
    pub(super) robot: Option<&'a Sample>,
    pub(super) humans: &'a [Sample],
    /// Robot and humans at the time before.
    pub(super) before: Option<(&'a Sample, &'a [Sample])>,
    /// The pieces of the curves of surface distance, by human, that end now; none while one of the two is not there.
    /// Two where the closest approach lies between the rows.
    pub(super) pieces: &'a [[Option<Piece>; 2]],
    /// The smallest surface distance, m.
    pub(super) nearest: Option<f64>,
    /// The smallest since the last row, m.
    pub(super) least: Option<f64>,
    /// The piece of the curve of `nearest` that ends now.
    pub(super) nearest_piece: Option<Piece>,
    /// Time to collision with each human, s; `None` off any collision course and while the human is not there.
    pub(super) ttc_s: &'a [Option<f64>],
    /// Humans with whom a contact begins, and when, s.
    pub(super) touched: &'a [(usize, f64)],
    /// Distance of the robot's surface from the walls, m.
    pub(super) clearance: Option<f64>,
    past: &'a Past,
}

impl Now<'_> {
    /// The robot's share of the closing speed just before a time since the last sample; `None` when nobody closes.
    pub(super) fn share(&self, human: usize, t: f64) -> Option<f64> {
        let (r, h) = self.past.both(human, t - BEFORE_SECS)?;
        super::collisions::closing_share(&r, &h)
    }
}

/// The run up to now.
pub(super) struct End<'a> {
    pub(super) setting: &'a Setting<'a>,
    /// First and last state of the robot.
    pub(super) first: Option<Sample>,
    pub(super) last: Option<Sample>,
    /// When the robot arrived, s.
    pub(super) arrived_s: Option<f64>,
    /// How many contacts with humans there were.
    pub(super) contacts: usize,
    /// Contacts with walls.
    pub(super) walls: &'a Stretches,
}

impl End<'_> {
    /// Length of the trip, s.
    pub(super) fn length_s(&self) -> f64 {
        self.first.zip(self.last).map_or(0.0, |(first, last)| last.t - first.t)
    }

    /// Time from the first sample to the arrival, s; `None` when the robot never arrives.
    pub(super) fn trip_s(&self) -> Option<f64> {
        self.arrived_s.zip(self.first).map(|(arrived, first)| arrived - first.t)
    }

    /// Whether the robot reached its goal without a collision.
    pub(super) fn succeeded(&self) -> bool {
        self.arrived_s.is_some() && self.contacts == 0 && self.walls.spans().is_empty()
    }
}

/// A family of metrics that grows with the run.
pub(super) trait Running: Copied {
    /// Takes the next time.
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>);
    /// The values of a run that ends here, one per sheet.
    fn values(&self, end: &End<'_>) -> Vec<Measured>;
}

/// A family can be copied, so that a run that goes on can be looked at as if it ended here.
pub(super) trait Copied {
    fn copied(&self) -> Box<dyn Running>;
}

impl<T: Running + Clone + 'static> Copied for T {
    fn copied(&self) -> Box<dyn Running> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Running> {
    fn clone(&self) -> Self {
        // Of what is in the box, not of the box.
        self.as_ref().copied()
    }
}

/// The last moments, as far back as somebody looks.
#[derive(Clone, Default)]
struct Past {
    first_s: f64,
    samples: VecDeque<(Sample, Vec<Sample>)>,
}

impl Past {
    fn push(&mut self, robot: &Sample, humans: &[Sample]) {
        if self.samples.is_empty() {
            self.first_s = robot.t;
        }
        let mut room = Vec::new();
        // A contact may begin right behind the last sample.
        let needed_s = self.samples.back().map_or(robot.t, |(last, _)| last.t) - BEFORE_SECS;
        while self.samples.get(1).is_some_and(|(second, _)| second.t < needed_s) {
            room = self.samples.pop_front().map_or_else(Vec::new, |(_, room)| room);
        }
        room.clear();
        room.extend_from_slice(humans);
        self.samples.push_back((*robot, room));
    }

    /// The moment before the last.
    fn before(&self) -> Option<(&Sample, &[Sample])> {
        let (robot, humans) = self.samples.get(self.samples.len().checked_sub(2)?)?;
        Some((robot, humans))
    }

    /// Robot and human at a time, not before the first.
    fn both(&self, human: usize, t: f64) -> Option<(Sample, Sample)> {
        let t = t.max(self.first_s);
        let index = self.samples.partition_point(|(robot, _)| robot.t < t);
        let (robot, humans) = self.samples.get(index)?;
        let earlier = index.checked_sub(1).and_then(|index| self.samples.get(index));
        let state = between(earlier.map(|(robot, _)| robot), robot, t)?;
        let person = between(earlier.and_then(|(_, humans)| humans.get(human)), humans.get(human)?, t)?;
        Some((state, person))
    }
}

/// Every metric that needs nothing of what comes later.
pub struct Online<'a> {
    setting: Setting<'a>,
    grid: Grid,
    /// The last row but one, and the last, which waits for the one after it: its velocities need both neighbors.
    earlier: Option<Row>,
    waiting: Option<Row>,
    run: Run,
    arrived_s: Option<f64>,
    /// When the robot came to its goal without saying so, and the values as they were then.
    reached: Option<Reached>,
}

/// The values of the run when the robot came to its goal, and whether a human had been there by then.
type Reached = (Vec<Vec<Measured>>, bool);

/// The run up to the last row that is complete.
#[derive(Clone)]
struct Run {
    families: Vec<Option<Box<dyn Running>>>,
    first: Option<Sample>,
    last: Option<Sample>,
    past: Past,
    distances: Vec<Gap>,
    nearest: Pen,
    clearing: Pen,
    contacts: Vec<Stretches>,
    walls: Stretches,
    pieces: Vec<[Option<Piece>; 2]>,
    ttc_s: Vec<Option<f64>>,
    touched: Vec<(usize, f64)>,
    /// Whether a human was there at all.
    came: bool,
}

impl Run {
    fn new(humans: usize) -> Self {
        let families = CATALOG.iter().map(|family| match family.measure {
            Measure::Online(begin) => Some(begin.0(humans)),
            Measure::Whole { .. } => None,
        });
        Self {
            families: families.collect(),
            first: None,
            last: None,
            past: Past::default(),
            distances: vec![Gap::default(); humans],
            nearest: Pen::default(),
            clearing: Pen::default(),
            contacts: vec![Stretches::below(0.0, REARM_M, REARM_SECS); humans],
            walls: Stretches::below(-WALL_SLACK_M, REARM_M, REARM_SECS),
            pieces: Vec::new(),
            ttc_s: Vec::new(),
            touched: Vec::new(),
            came: false,
        }
    }

    /// Takes the next row. One in which the robot is not recorded is a hole in everything.
    fn push(&mut self, setting: &Setting<'_>, row: &Row) {
        let Some(t) = row.t() else { return };
        let (robot, humans) = (row.robot.as_ref(), &row.humans);
        self.came |= humans.iter().any(|human| human.there);
        self.pieces.clear();
        self.ttc_s.clear();
        self.touched.clear();
        let (mut nearest, mut least, mut clearance) = (None, None, None);
        if let Some(robot) = robot {
            if robot.there {
                self.first.get_or_insert(*robot);
                self.last = Some(*robot);
            }
            self.past.push(robot, humans);
            for (index, human) in humans.iter().enumerate() {
                let radius_m = setting.humans_radius_m.get(index).copied().unwrap_or(0.0);
                let both = robot.there && human.there;
                let radii_m = setting.robot_radius_m + radius_m;
                let line = both.then(|| human.at - robot.at);
                let (pieces, distance) = match self.distances.get_mut(index) {
                    Some(gap) => gap.to(t, line, radii_m),
                    None => continue,
                };
                for piece in pieces {
                    let begins = self.contacts.get_mut(index).and_then(|contacts| contacts.add(piece));
                    self.touched.extend(begins.map(|from_s| (index, from_s)));
                    least = smaller(least, piece.map(|(_, from, _, to)| from.min(to)));
                }
                nearest = smaller(nearest, distance);
                self.pieces.push(pieces);
                self.ttc_s.push(both.then(|| time_to_collision(robot, human, radii_m)).flatten());
            }
            let field = setting.field.filter(|_| robot.there);
            clearance = field.map(|field| field.clearance(&robot.at) - setting.robot_radius_m);
            self.walls.add(self.clearing.to(t, clearance));
        }
        let now = Now {
            t,
            robot,
            humans,
            before: self.past.before(),
            pieces: &self.pieces,
            nearest,
            least: smaller(nearest, least),
            nearest_piece: self.nearest.to(t, nearest),
            ttc_s: &self.ttc_s,
            touched: &self.touched,
            clearance,
            past: &self.past,
        };
        for family in self.families.iter_mut().flatten() {
            family.push(setting, &now);
        }
    }

    /// Values of every family, by its place in the catalog.
    fn values(&self, setting: &Setting<'_>, arrived_s: Option<f64>) -> Vec<Vec<Measured>> {
        let end = End {
            setting,
            first: self.first,
            last: self.last,
            arrived_s,
            contacts: self.contacts.iter().map(|contacts| contacts.spans().len()).sum(),
            walls: &self.walls,
        };
        let one = |family: &Option<Box<dyn Running>>| family.as_ref().map_or_else(Vec::new, |f| f.values(&end));
        self.families.iter().map(one).collect()
    }
}

/// The smaller of two values that may be missing.
fn smaller(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    one.into_iter().chain(other).reduce(f64::min)
}

impl<'a> Online<'a> {
    /// Before the first sample.
    #[must_use]
    pub fn new(setting: Setting<'a>) -> Self {
        Self {
            setting,
            grid: Grid::default(),
            earlier: None,
            waiting: None,
            run: Run::new(setting.humans_radius_m.len()),
            arrived_s: None,
            reached: None,
        }
    }

    /// Takes the states of everybody at the next time; times rise. What comes after the robot's arrival is no part of
    /// its trip.
    pub fn push(&mut self, robot: Option<&Sample>, humans: &[Sample]) {
        if self.arrived_s.is_some() {
            return;
        }
        let mut come = Vec::new();
        self.grid.push(robot, humans, |row| come.push(row));
        for row in come {
            self.row(row);
        }
    }

    /// Takes the next row of the grid.
    pub(super) fn row(&mut self, mut row: Row) {
        // A trip begins where the robot is first recorded.
        if !row.counts() && self.waiting.is_none() {
            return;
        }
        if !row.counts() {
            row.humans.iter_mut().for_each(|human| human.there = false);
        }
        if let Some(mut done) = self.waiting.take() {
            let plain = done.clone();
            done.speed_up(self.earlier.as_ref(), Some(&row));
            self.run.push(&self.setting, &done);
            self.earlier = Some(plain);
        }
        let reached = self.setting.goal.filter(|_| self.reached.is_none());
        let reached = reached.and_then(|goal| row.reaches_s(self.earlier.as_ref(), &goal));
        self.waiting = Some(row);
        if let Some(t) = reached {
            self.reached = Some((self.concluded(None, Some(t)), self.came()));
        }
    }

    /// The robot says that it has arrived, s: its trip ends with the samples up to then. A robot that says nothing
    /// has arrived when it first comes near its goal.
    pub fn arrived(&mut self, t: f64) {
        self.arrived_s.get_or_insert(t);
    }

    /// The values of a run that ends with the rows so far and maybe one more.
    fn concluded(&self, tail: Option<Row>, arrived_s: Option<f64>) -> Vec<Vec<Measured>> {
        let mut run = self.run.clone();
        let rows: Vec<Row> = self.waiting.iter().cloned().chain(tail).collect();
        for (index, row) in rows.iter().enumerate() {
            let mut done = row.clone();
            let before = index.checked_sub(1).and_then(|index| rows.get(index)).or(self.earlier.as_ref());
            done.speed_up(before, rows.get(index + 1));
            run.push(&self.setting, &done);
        }
        run.values(&self.setting, arrived_s)
    }

    /// The same for the run so far.
    pub(super) fn measured(&self) -> Vec<Vec<Measured>> {
        if let (None, Some((values, _))) = (self.arrived_s, &self.reached) {
            return values.clone();
        }
        let tail = self.grid.tail();
        // The goal may be reached at that very row.
        let goal = self.setting.goal.filter(|_| self.arrived_s.is_none());
        let reached = goal.zip(tail.as_ref()).and_then(|(goal, row)| row.reaches_s(self.waiting.as_ref(), &goal));
        self.concluded(tail, self.arrived_s.or(reached))
    }

    fn robot(&self) -> bool {
        self.run.first.is_some() || self.waiting.as_ref().is_some_and(|row| row.robot.is_some())
    }

    /// Whether a human was there on the trip.
    fn came(&self) -> bool {
        if let (None, Some((_, came))) = (self.arrived_s, &self.reached) {
            return *came;
        }
        let there = |row: &Row| row.counts() && row.humans.iter().any(|human| human.there);
        self.run.came || self.waiting.iter().chain(self.grid.tail().iter()).any(there)
    }

    /// What is missing for metrics with these needs, and why.
    fn lacks(&self, needs: &[Need]) -> Option<(Missing, String)> {
        needs.iter().find_map(|need| {
            let there = match need {
                Need::Tracks => true,
                Need::Robot => self.robot(),
                Need::Humans => self.came(),
                Need::Map => self.setting.field.is_some(),
                Need::Goal => self.setting.goal.is_some(),
                Need::Groups
                | Need::Events
                | Need::Twin
                | Need::PlannerTimes
                | Need::Commands
                | Need::Solo
                | Need::OtherRobots => false,
            };
            (!there).then(|| (need.missing(), need.lacking().to_owned()))
        })
    }

    /// Values of a run that ends here, in report order: those that need nothing of what comes later.
    #[must_use]
    pub fn values(&self) -> Vec<MetricValue> {
        let measured = self.measured();
        CATALOG
            .iter()
            .zip(&measured)
            .filter(|(family, _)| family.waits().is_none())
            .flat_map(|(family, values)| {
                family.sheets().iter().zip(values).map(|(sheet, value)| match self.lacks(sheet.needs) {
                    Some((missing, why)) => valued(sheet, Err(why), missing),
                    None => valued(sheet, value.clone(), Missing::NotApplicable),
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
