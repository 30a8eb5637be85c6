//! What the metrics look at: the run cut to the robot's trip, with distances ready.

use std::borrow::Cow;
use std::sync::Arc;

use socrates_maps::Geodesic;
use socrates_model::{HumanId, Missing, Point, Proposal, Vector};

use crate::fidelity::Signals;
use crate::metrics::grid::{self, Row};
use crate::metrics::{Measured, Need, Online, Setting};
use crate::running::{Pen, Piece};
use crate::series::Series;
use crate::tracks::{Sample, Track, Tracks};

/// Step of the even grid on which sums over changes are taken, s.
pub(super) const EVEN_SECS: f64 = 0.1;

/// The robot's trip.
pub struct Scene<'a> {
    /// Signals of the whole run.
    pub signals: &'a Signals<'a>,
    /// Tracks on the even grid from the robot's first sample to its arrival or its last.
    pub tracks: Tracks,
    /// The robot's goal, if known.
    pub goal: Option<Point>,
    /// When the robot arrived, s.
    pub arrived_s: Option<f64>,
    /// Shortest ways to the goal for the robot's disc.
    pub geodesic: Option<Arc<Geodesic>>,
    /// When it came to its goal or said so, and everybody up to then on the even grid, row by row.
    rows: Vec<Row>,
    /// The robot on the even grid, while it is there.
    pub even: Vec<Sample>,
    /// The whole run on the even grid, with what is after the robot's arrival.
    pub whole: Tracks,
    /// The trip as it was recorded, for figures that are to depend on the rate as elsewhere.
    pub recorded: Cow<'a, Tracks>,
    /// Surface distance to each human over time, in the order of `tracks.humans`.
    pub distances: Vec<Series>,
    /// The same run without a robot, or why there is none.
    twin: Result<Tracks, String>,
}

impl<'a> Scene<'a> {
    /// Cuts the run to the robot's trip and computes distances.
    #[must_use]
    pub fn new(signals: &'a Signals<'a>) -> Self {
        let full = signals.full;
        let robot_end = signals.arrived_s.and_then(|t| full.robot.as_ref()?.at(t)).map(|sample| sample.at);
        let goal = signals.evidence.goal.or_else(|| crate::fidelity::robot_goal(signals)).or(robot_end);
        let whole = grid::even(full);
        let mut rows = match signals.arrived_s.filter(|arrived| *arrived < full.end_s()) {
            Some(arrived) => grid::rows(&full.until(arrived)),
            None => grid::rows(full),
        };
        let mut arrived_s = signals.arrived_s;
        if let Some(goal) = goal.filter(|_| arrived_s.is_none()) {
            let pairs = std::iter::once(None).chain(rows.iter().map(Some)).zip(&rows).enumerate();
            let reached =
                pairs.into_iter().find_map(|(index, (before, row))| Some((index, row.reaches_s(before, &goal)?)));
            if let Some((index, t)) = reached {
                rows.truncate(index + 1);
                arrived_s = Some(t);
            }
        }
        let tracks = grid::tracks_of(full, grid::trip(&rows));
        let ends = tracks.all().next().and_then(|track| Some((track.samples.first()?.t, track.samples.last()?.t)));
        let (first_s, last_s) = ends.unwrap_or((0.0, 0.0));
        // The grid may end up to a step before the last sample.
        let over = rows.last().and_then(Row::t).is_none_or(|t| t <= last_s + 1e-9);
        let last_s = if over { arrived_s.unwrap_or_else(|| full.end_s()) } else { last_s };
        let recorded = grid::recorded(full, first_s, last_s);
        let distances: Vec<Series> = tracks
            .robot
            .as_ref()
            .map(|robot| tracks.humans.iter().map(|human| surface(robot, human)).collect())
            .unwrap_or_default();
        let radius = tracks.robot.as_ref().map_or(0.0, |robot| robot.radius_m);
        let geodesic =
            signals.ground.as_ref().zip(goal).map(|(ground, goal)| ground.geodesic(&goal, (radius - 0.05).max(0.05)));
        let even = tracks.robot.as_ref().map_or_else(Vec::new, |robot| robot.present().copied().collect());
        let twin = signals.evidence.twin.ok_or_else(|| "there is no twin run".to_owned());
        let twin = twin
            .and_then(|twin| Tracks::read(twin).map_err(|why| format!("the twin run cannot be read: {why}")))
            .map(|twin| grid::even(&twin));
        Self { signals, tracks, goal, arrived_s, geodesic, rows, even, whole, recorded, distances, twin }
    }

    /// What is missing for metrics with these needs, and why; `None` when nothing is.
    #[must_use]
    pub fn lacks(&self, needs: &[Need]) -> Option<(Missing, String)> {
        needs.iter().find_map(|need| {
            let there = match need {
                Need::Tracks => true,
                Need::Robot => self.tracks.robot.is_some(),
                Need::Humans => !self.tracks.humans.is_empty(),
                Need::Map => self.signals.field.is_some(),
                Need::Goal => self.goal.is_some(),
                Need::Groups => !self.groups().is_empty(),
                Need::Twin => self.signals.evidence.twin.is_some(),
                Need::PlannerTimes | Need::Commands | Need::Solo | Need::OtherRobots => false,
                Need::Events => self.signals.full.all().any(|track| track.samples.iter().any(|s| s.gesture.is_some())),
            };
            (!there).then(|| (need.missing(), need.lacking().to_owned()))
        })
    }

    /// What is known before the first sample; `humans_radius_m` in the order in which they are pushed.
    #[must_use]
    pub fn setting<'s>(&'s self, humans_radius_m: &'s [f64]) -> Setting<'s> {
        let robot = self.tracks.robot.as_ref();
        Setting {
            robot_radius_m: robot.map_or(0.0, |robot| robot.radius_m),
            robot_speed_mps: robot.map_or(0.0, |robot| robot.speed_mps),
            humans_radius_m,
            goal: self.goal,
            field: self.signals.field.as_deref(),
            geodesic: self.geodesic.as_deref(),
        }
    }

    /// The trip, row by row.
    #[must_use]
    pub(super) fn online(&self) -> Vec<Vec<Measured>> {
        let radii: Vec<f64> = self.signals.full.humans.iter().map(|human| human.radius_m).collect();
        let mut online = Online::new(self.setting(&radii));
        for row in &self.rows {
            online.row(row.clone());
        }
        if let Some(arrived) = self.signals.arrived_s {
            online.arrived(arrived);
        }
        online.measured()
    }

    /// Groups of people, from the proposal or as they were told.
    #[must_use]
    pub fn groups(&self) -> Vec<Vec<HumanId>> {
        let evidence = self.signals.evidence;
        if !evidence.groups.is_empty() {
            return evidence.groups.to_vec();
        }
        let planned = |proposal: &Proposal| proposal.groups.iter().map(|group| group.members.clone()).collect();
        evidence.proposal.map_or_else(Vec::new, planned)
    }

    /// The same run without a robot.
    ///
    /// # Errors
    /// Why there is none: it was not given, or its recording cannot be read.
    pub fn twin(&self) -> Result<&Tracks, String> {
        self.twin.as_ref().map_err(Clone::clone)
    }

    /// The robot; metrics that need one are not computed without.
    #[must_use]
    pub fn robot(&self) -> Option<&Track> {
        self.tracks.robot.as_ref()
    }

    /// Length of the trip, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        let samples = self.robot().map_or(&[][..], |robot| &robot.samples);
        samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.t - first.t)
    }

    /// Robot and human side by side through time.
    pub fn pairs(&self) -> impl Iterator<Item = (&Track, &Track)> {
        self.tracks.robot.iter().flat_map(|robot| self.tracks.humans.iter().map(move |human| (robot, human)))
    }

    /// Shortest way from a point to the goal, m; straight where there is no map.
    #[must_use]
    pub fn to_goal_m(&self, from: &Point) -> Option<f64> {
        self.setting(&[]).to_goal_m(from)
    }

    /// Way of the robot on the even grid, m.
    #[must_use]
    pub fn path_length_m(&self) -> f64 {
        self.even.iter().zip(self.even.iter().skip(1)).map(|(a, b)| (b.at - a.at).norm()).sum()
    }
}

/// Surface distance of two agents over time, m, with a sample at each closest approach between rows.
fn surface(robot: &Track, human: &Track) -> Series {
    let mut gap = Gap::default();
    let mut found: Vec<(f64, Option<f64>)> = Vec::with_capacity(robot.samples.len());
    for (r, h) in robot.samples.iter().zip(&human.samples) {
        let line = (r.there && h.there).then(|| h.at - r.at);
        let (pieces, distance) = gap.to(r.t, line, robot.radius_m + human.radius_m);
        if let [Some((_, _, t, least)), Some(_)] = pieces {
            found.push((t, Some(least)));
        }
        found.push((r.t, distance));
    }
    found.into_iter().collect()
}

/// The surface distance of two who go straight between rows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gap {
    pen: Pen,
    line: Option<(f64, Vector)>,
}

impl Gap {
    /// The pieces up to a row and the distance there, m: two pieces where the closest approach lies between this row
    /// and the one before. Else a graze of less than a step would be missed.
    pub(super) fn to(&mut self, t: f64, line: Option<Vector>, radii_m: f64) -> ([Option<Piece>; 2], Option<f64>) {
        let distance = line.map(|line| line.norm() - radii_m);
        let before = std::mem::replace(&mut self.line, line.map(|line| (t, line)));
        let closest = before.zip(line).and_then(|((from_s, from), to)| {
            let step = to - from;
            let share = -from.dot(&step) / step.norm_squared().max(1e-12);
            (share > 1e-6 && share < 1.0 - 1e-6)
                .then(|| (from_s + (t - from_s) * share, (from + step * share).norm() - radii_m))
        });
        let first = closest.and_then(|(t, least)| self.pen.to(t, Some(least)));
        let last = self.pen.to(t, distance);
        (if first.is_some() { [first, last] } else { [last, None] }, distance)
    }
}

/// A contact is over when the two have been this far apart, m, for this long, s.
pub(super) const REARM_M: f64 = 0.05;
pub(super) const REARM_SECS: f64 = 0.5;
