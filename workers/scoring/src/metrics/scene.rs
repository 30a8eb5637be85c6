//! What the metrics look at: the run cut to the robot's trip, with distances ready.

use std::borrow::Cow;

use socrates_maps::Geodesic;
use socrates_model::{Missing, Point};

use crate::fidelity::{GOAL_M, Signals};
use crate::metrics::{Measured, Need, Online, Setting};
use crate::series::Series;
use crate::tracks::{Sample, Track, Tracks};

/// Step of the even grid on which sums over changes are taken, s.
pub(super) const EVEN_SECS: f64 = 0.1;

/// The robot's trip.
pub struct Scene<'a> {
    /// Signals of the whole run.
    pub signals: &'a Signals<'a>,
    /// Tracks from the start to the robot's arrival.
    pub tracks: Cow<'a, Tracks>,
    /// The robot's goal, if known.
    pub goal: Option<Point>,
    /// When the robot arrived, s.
    pub arrived_s: Option<f64>,
    /// Shortest ways to the goal for the robot's disc.
    pub geodesic: Option<Geodesic>,
    /// The robot on the even grid.
    pub even: Vec<Sample>,
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
        let goal = crate::fidelity::robot_goal(signals).or(robot_end);
        let reached = goal.and_then(|goal| {
            let robot = full.robot.as_ref()?;
            robot.samples.iter().find(|sample| (sample.at - goal).norm() <= GOAL_M).map(|sample| sample.t)
        });
        let arrived_s = signals.arrived_s.or(reached);
        let tracks = match arrived_s.filter(|arrived| *arrived < full.end_s()) {
            Some(arrived) => Cow::Owned(full.until(arrived)),
            None => Cow::Borrowed(full),
        };
        let distances: Vec<Series> = tracks
            .robot
            .as_ref()
            .map(|robot| tracks.humans.iter().map(|human| surface(robot, human)).collect())
            .unwrap_or_default();
        let radius = tracks.robot.as_ref().map_or(0.0, |robot| robot.radius_m);
        let geodesic =
            signals.field.as_ref().zip(goal).map(|(field, goal)| Geodesic::to(field, &goal, (radius - 0.05).max(0.05)));
        let even = tracks.robot.as_ref().map(|robot| robot.even(EVEN_SECS)).unwrap_or_default();
        let twin = signals.evidence.twin.ok_or_else(|| "there is no twin run".to_owned());
        let twin =
            twin.and_then(|twin| Tracks::read(twin).map_err(|why| format!("the twin run cannot be read: {why}")));
        Self { signals, tracks, goal, arrived_s, geodesic, even, distances, twin }
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
                Need::Groups => self.signals.evidence.proposal.is_some_and(|proposal| !proposal.groups.is_empty()),
                Need::Twin => self.signals.evidence.twin.is_some(),
                Need::PlannerTimes | Need::Commands | Need::Solo | Need::OtherRobots => false,
                Need::Events => {
                    self.signals.full.all().any(|track| track.samples.iter().any(|s| s.gesture.code() != 0))
                }
            };
            (!there).then(|| (need.missing(), need.lacking().to_owned()))
        })
    }

    /// What is known before the first sample; `humans_radius_m` in the order of `tracks.humans`.
    #[must_use]
    pub fn setting<'s>(&'s self, humans_radius_m: &'s [f64]) -> Setting<'s> {
        let robot = self.tracks.robot.as_ref();
        Setting {
            robot_radius_m: robot.map_or(0.0, |robot| robot.radius_m),
            robot_speed_mps: robot.map_or(0.0, |robot| robot.speed_mps),
            humans_radius_m,
            goal: self.goal,
            field: self.signals.field.as_ref(),
            geodesic: self.geodesic.as_ref(),
        }
    }

    /// The trip, sample by sample.
    #[must_use]
    pub(super) fn online(&self) -> Vec<Vec<Measured>> {
        let tracks = &self.tracks;
        let radii: Vec<f64> = tracks.humans.iter().map(|human| human.radius_m).collect();
        let mut online = Online::new(self.setting(&radii));
        let times = tracks.all().next().map_or(0, |track| track.samples.len());
        let mut humans: Vec<Sample> = Vec::with_capacity(radii.len());
        for index in 0..times {
            humans.clear();
            humans.extend(tracks.humans.iter().filter_map(|human| human.samples.get(index)));
            online.push(tracks.robot.as_ref().and_then(|robot| robot.samples.get(index)), &humans);
        }
        if let Some(arrived) = self.arrived_s {
            online.arrived(arrived);
        }
        online.measured()
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

/// Surface distance of two agents over time, m.
fn surface(robot: &Track, human: &Track) -> Series {
    robot.between(human, |r, h| (r.at - h.at).norm() - robot.radius_m - human.radius_m)
}

/// A contact is over when the two have been this far apart, m, for this long, s.
pub(super) const REARM_M: f64 = 0.05;
pub(super) const REARM_SECS: f64 = 0.5;
