//! Metrics while the run goes on.
//!
//! ```text
//! setting ─► Online ◄─ push(robot, people) at each time ◄─ arrived(t)
//!                └──► values() at any time: those of a recording that ends there
//! ```
//!
//! One code for both: what a recording is judged by ([`crate::metrics::measure`]) is fed sample by sample to the same
//! [`Online`]. Each time costs the same, however long the run is.

use std::collections::VecDeque;

use socrates_maps::{DistanceField, Geodesic};
use socrates_model::{MetricValue, Missing, Point};

use crate::fidelity::GOAL_M;
use crate::metrics::collisions::WALL_SLACK_M;
use crate::metrics::scene::{EVEN_SECS, REARM_M, REARM_SECS};
use crate::metrics::ttc::time_to_collision;
use crate::metrics::{CATALOG, Measure, Measured, Need, valued};
use crate::running::{Pen, Piece, Stretches};
use crate::tracks::{Sample, between};

/// So far back one looks for who closes in, s: just before a contact both still move as they meant to.
const BEFORE_SECS: f64 = 0.1;

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
    pub(super) pieces: &'a [Option<Piece>],
    /// The smallest surface distance, m.
    pub(super) nearest: Option<f64>,
    /// The piece of that curve that ends now.
    pub(super) nearest_piece: Option<Piece>,
    /// Time to collision with each human, s; `None` off any collision course and while the human is not there.
    pub(super) ttc_s: &'a [Option<f64>],
    /// Humans with whom a contact begins, and when, s.
    pub(super) touched: &'a [(usize, f64)],
    /// Distance of the robot's surface from the walls, m.
    pub(super) clearance: Option<f64>,
    /// The robot at the times of the even grid that have come since the last time.
    pub(super) even: &'a [Sample],
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
    /// The last state of the even grid, where rounding puts it a hair behind the last sample.
    pub(super) tail: Option<Sample>,
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
pub(super) trait Running {
    /// Takes the next time.
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>);
    /// The values of a run that ends here, one per sheet.
    fn values(&self, end: &End<'_>) -> Vec<Measured>;
}

/// The last moments, as far back as somebody looks.
#[derive(Default)]
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

/// The robot on an even grid of times. A time of the grid is known with the first sample at or after it.
#[derive(Default)]
struct Even {
    first_s: Option<f64>,
    next: u32,
    last: Option<Sample>,
    come: Vec<Sample>,
}

impl Even {
    fn next_s(&self) -> f64 {
        self.first_s.unwrap_or(0.0) + f64::from(self.next) * EVEN_SECS
    }

    fn push(&mut self, robot: &Sample) {
        self.first_s.get_or_insert(robot.t);
        self.come.clear();
        while self.next_s() <= robot.t && self.next < u32::MAX {
            self.come.extend(between(self.last.as_ref(), robot, self.next_s()));
            self.next += 1;
        }
        self.last = Some(*robot);
    }

    /// The state of a time that rounding puts behind the last sample.
    fn tail(&self) -> Option<Sample> {
        self.last.filter(|last| last.there && self.next_s() <= last.t + 1e-9)
    }
}

/// Every metric that needs nothing of what comes later.
pub struct Online<'a> {
    setting: Setting<'a>,
    families: Vec<Option<Box<dyn Running>>>,
    first: Option<Sample>,
    last: Option<Sample>,
    even: Even,
    past: Past,
    pens: Vec<Pen>,
    nearest: Pen,
    clearing: Pen,
    contacts: Vec<Stretches>,
    walls: Stretches,
    pieces: Vec<Option<Piece>>,
    ttc_s: Vec<Option<f64>>,
    touched: Vec<(usize, f64)>,
    /// Whether a human was there at all.
    came: bool,
    arrived_s: Option<f64>,
    /// When the robot came to its goal without saying so, and the values as they were then.
    reached: Option<(f64, Vec<Vec<Measured>>)>,
}

impl<'a> Online<'a> {
    /// Before the first sample.
    #[must_use]
    pub fn new(setting: Setting<'a>) -> Self {
        let humans = setting.humans_radius_m.len();
        let families = CATALOG.iter().map(|family| match family.measure {
            Measure::Online(begin) => Some(begin.0(humans)),
            Measure::Whole { .. } => None,
        });
        Self {
            setting,
            families: families.collect(),
            first: None,
            last: None,
            even: Even::default(),
            past: Past::default(),
            pens: vec![Pen::default(); humans],
            nearest: Pen::default(),
            clearing: Pen::default(),
            contacts: vec![Stretches::below(0.0, REARM_M, REARM_SECS); humans],
            walls: Stretches::below(-WALL_SLACK_M, REARM_M, REARM_SECS),
            pieces: Vec::new(),
            ttc_s: Vec::new(),
            touched: Vec::new(),
            came: false,
            arrived_s: None,
            reached: None,
        }
    }

    /// Takes the states of everybody at the next time; times rise. Velocities are needed: recordings without them are
    /// completed from the samples after. What comes after the robot's arrival is no part of its trip.
    pub fn push(&mut self, robot: Option<&Sample>, humans: &[Sample]) {
        if self.arrived_s.is_some() {
            return;
        }
        let Some(t) = robot.or_else(|| humans.first()).map(|sample| sample.t) else { return };
        self.came |= humans.iter().any(|human| human.there);
        self.pieces.clear();
        self.ttc_s.clear();
        self.touched.clear();
        self.even.come.clear();
        let (mut nearest, mut clearance) = (None, None);
        if let Some(robot) = robot {
            self.first.get_or_insert(*robot);
            self.last = Some(*robot);
            self.even.push(robot);
            self.past.push(robot, humans);
            for (index, human) in humans.iter().enumerate() {
                let radius_m = self.setting.humans_radius_m.get(index).copied().unwrap_or(0.0);
                let distance = (robot.there && human.there)
                    .then(|| (robot.at - human.at).norm() - self.setting.robot_radius_m - radius_m);
                nearest = distance.map_or(nearest, |distance| Some(nearest.map_or(distance, |old| distance.min(old))));
                let piece = self.pens.get_mut(index).and_then(|pen| pen.to(t, distance));
                let begins = self.contacts.get_mut(index).and_then(|contacts| contacts.add(piece));
                self.touched.extend(begins.map(|from_s| (index, from_s)));
                self.pieces.push(piece);
                let radii_m = self.setting.robot_radius_m + radius_m;
                self.ttc_s.push(human.there.then(|| time_to_collision(robot, human, radii_m)).flatten());
            }
            clearance = self.setting.field.map(|field| field.clearance(&robot.at) - self.setting.robot_radius_m);
            self.walls.add(self.clearing.to(t, clearance));
        }
        let now = Now {
            t,
            robot,
            humans,
            before: self.past.before(),
            pieces: &self.pieces,
            nearest,
            nearest_piece: self.nearest.to(t, nearest),
            ttc_s: &self.ttc_s,
            touched: &self.touched,
            clearance,
            even: &self.even.come,
            past: &self.past,
        };
        for family in self.families.iter_mut().flatten() {
            family.push(&self.setting, &now);
        }
        if self.reached.is_none()
            && let (Some(goal), Some(robot)) = (self.setting.goal, robot)
            && (robot.at - goal).norm() <= GOAL_M
        {
            self.reached = Some((t, self.families(Some(t))));
        }
    }

    /// The robot says that it has arrived, s: its trip ends with the samples up to then. A robot that says nothing
    /// has arrived when it first comes near its goal.
    pub fn arrived(&mut self, t: f64) {
        self.arrived_s.get_or_insert(t);
    }

    /// Values of every family, by its place in the catalogue.
    fn families(&self, arrived_s: Option<f64>) -> Vec<Vec<Measured>> {
        let end = End {
            setting: &self.setting,
            first: self.first,
            last: self.last,
            arrived_s,
            contacts: self.contacts.iter().map(|contacts| contacts.spans().len()).sum(),
            walls: &self.walls,
            tail: self.even.tail(),
        };
        let one = |family: &Option<Box<dyn Running>>| family.as_ref().map_or_else(Vec::new, |f| f.values(&end));
        self.families.iter().map(one).collect()
    }

    /// The same for the run so far.
    pub(super) fn measured(&self) -> Vec<Vec<Measured>> {
        match (self.arrived_s, &self.reached) {
            (None, Some((_, values))) => values.clone(),
            (arrived, _) => self.families(arrived),
        }
    }

    /// What is missing for metrics with these needs, and why.
    fn lacks(&self, needs: &[Need]) -> Option<(Missing, String)> {
        needs.iter().find_map(|need| {
            let there = match need {
                Need::Tracks => true,
                Need::Robot => self.first.is_some(),
                Need::Humans => self.came,
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
                family.sheets.iter().zip(values).map(|(sheet, value)| match self.lacks(sheet.needs) {
                    Some((missing, why)) => valued(sheet, Err(why), missing),
                    None => valued(sheet, value.clone(), Missing::NotApplicable),
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::{AgentId, EventKind, Paths, Recording};

    use super::*;
    use crate::evidence::Evidence;
    use crate::fidelity::Signals;
    use crate::fixture::{Draw, Walk, absent, event, floor, paths, recording};
    use crate::metrics::{Scene, measure};
    use crate::tracks::Tracks;

    impl Draw {
        /// Walks about with rests, mostly where the others do.
        fn walk(&mut self, agent: AgentId) -> Walk {
            let mut stops = vec![(0.0, self.within(-6.0, 6.0), self.within(-2.0, 2.0))];
            while let Some((t, x, y)) = stops.last().copied().filter(|(t, ..)| *t < 20.0) {
                let rests = self.next() < 0.3;
                let to = if rests { (x, y) } else { (self.within(-6.0, 6.0), self.within(-2.0, 2.0)) };
                stops.push((t + self.within(0.3, 6.0), to.0, to.1));
            }
            stops.push((1000.0, 0.0, 0.0));
            Walk::through(agent, &stops)
        }

        /// A run of four with people who come and go, steps that vary, and sometimes an arrival.
        fn run(&mut self) -> Recording {
            let walks: Vec<Walk> = std::iter::once(AgentId::Robot)
                .chain((1..=3).map(|number| AgentId::Human(socrates_model::HumanId::new(number))))
                .map(|agent| self.walk(agent))
                .collect();
            let step = [0.01, 0.05, 0.1, 0.23][(self.next() * 4.0) as usize];
            let mut run = recording(&walks, 12.0, step);
            for number in 1..=3 {
                if self.next() < 0.4 {
                    let from = self.within(-4.0, 12.0);
                    absent(&mut run, number, from..from + self.within(0.0, 16.0));
                }
            }
            if self.next() < 0.5 {
                // Some ticks are lost.
                let agents = run.header.agents.len();
                let kept: Vec<bool> = (0..run.ticks()).map(|_| self.next() < 0.7).collect();
                let mut index = 0;
                run.frames.retain(|_| {
                    index += 1;
                    kept[(index - 1) / agents]
                });
            }
            if self.next() < 0.4 {
                let t = self.within(2.0, 12.0);
                event(&mut run, t, EventKind::RobotArrived);
            }
            run
        }
    }

    /// The recording up to some of its ticks.
    fn begun(run: &Recording, ticks: usize) -> Recording {
        let mut begun = run.clone();
        begun.frames.truncate(ticks * run.header.agents.len());
        let end_s = begun.frames.last().map_or(0.0, |state| state.tick as f64 * run.header.step_s);
        begun.events.retain(|event| event.time.secs() <= end_s);
        begun
    }

    /// What is kept of a value for a comparison to the last bit.
    fn bits(values: &[MetricValue]) -> Vec<(String, Option<u64>, String)> {
        values.iter().map(|v| (v.id.clone(), v.value.map(f64::to_bits), v.note.clone())).collect()
    }

    /// Pushes a run time by time; after each of `looks` ticks, and at the end, the values are those of the recording
    /// that ends there.
    fn same(run: &Recording, place: &socrates_model::Location, ways: &Paths, looks: &[usize]) {
        let whole = Evidence { location: Some(place), paths: Some(ways), ..Evidence::of(run) };
        let full = Tracks::read(run).unwrap();
        let signals = Signals::new(&whole, &full);
        let scene = Scene::new(&signals);
        let radii: Vec<f64> = full.humans.iter().map(|human| human.radius_m).collect();
        let mut online = Online::new(scene.setting(&radii));
        let ticks = run.ticks();
        let arrives = run.events.iter().find(|event| event.kind == EventKind::RobotArrived).map(|e| e.time.secs());
        for tick in 0..ticks {
            let robot = full.robot.as_ref().map(|robot| robot.samples[tick]);
            let t = full.all().next().unwrap().samples[tick].t;
            if let Some(arrived) = arrives.filter(|arrived| *arrived < t - 1e-9) {
                online.arrived(arrived);
            }
            let humans: Vec<Sample> = full.humans.iter().map(|human| human.samples[tick]).collect();
            online.push(robot.as_ref(), &humans);
            let last = tick + 1 == ticks;
            if let Some(arrived) = arrives.filter(|arrived| *arrived <= t) {
                online.arrived(arrived);
            }
            if !(last || looks.contains(&tick)) || tick == 0 {
                continue;
            }
            let so_far = begun(run, tick + 1);
            let evidence = Evidence { recording: &so_far, ..whole };
            let Ok(tracks) = Tracks::read(&so_far) else { continue };
            let signals = Signals::new(&evidence, &tracks);
            let values = online.values();
            let batch: Vec<MetricValue> = measure(&Scene::new(&signals))
                .into_iter()
                .filter(|value| values.iter().any(|mine| mine.id == value.id))
                .collect();
            assert!(values.len() >= 60, "{}", values.len());
            for (mine, theirs) in bits(&values).iter().zip(bits(&batch)) {
                assert_eq!(*mine, theirs, "after tick {tick} of {ticks}");
            }
        }
    }

    #[test]
    fn values_while_it_goes_on_are_those_of_the_recording_to_the_last_bit() {
        let place = floor(
            &[(-20., 4., 20., 5.), (-20., -5., 20., -4.), (-2., 2.6, 2., 4.)],
            &[("a", "CORRIDOR", -5., 0.), ("b", "CORRIDOR", 4., 0.)],
            &[("a", "b")],
        );
        let ways = paths(&["a", "b"], &[]);
        let mut draw = Draw(5);
        for _ in 0..60 {
            let run = draw.run();
            let looks: Vec<usize> = (0..3).map(|_| (draw.next() * run.ticks() as f64) as usize).collect();
            same(&run, &place, &ways, &looks);
        }
    }

    #[test]
    fn a_run_without_a_robot_or_without_people_says_what_it_lacks() {
        let place = floor(&[], &[("a", "CORRIDOR", -5., 0.), ("b", "CORRIDOR", 4., 0.)], &[("a", "b")]);
        let ways = paths(&["a", "b"], &[]);
        same(&recording(&[Walk::human(1, 0., 0., 1., 0.)], 4.0, 0.1), &place, &ways, &[3]);
        same(&recording(&[Walk::robot(-5., 0., 1., 0.)], 12.0, 0.1), &place, &ways, &[3, 60, 100]);
    }

    #[test]
    fn what_waits_for_the_end_says_why() {
        let waiting: Vec<&str> = CATALOG.iter().filter_map(crate::metrics::Family::waits).collect();
        assert!(waiting.iter().all(|why| !why.is_empty()) && waiting.len() < CATALOG.len());
    }
}
