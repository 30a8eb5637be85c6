//! The even grid of times on which every metric is taken, at whatever rate the run was recorded.
//!
//! ```text
//! samples ─► positions every 0.1 s, straight between samples ─► velocities by central differences
//! ```
//!
//! Velocities are taken from the positions even where the recording has some: of recordings with and without, and of
//! ten and of a hundred samples a second, the same figures come.

use std::borrow::Cow;

use socrates_model::Point;

use crate::fidelity::GOAL_M;
use crate::metrics::scene::EVEN_SECS;
use crate::tracks::{Sample, Track, Tracks, between};

/// Everybody at one time of the grid.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) robot: Option<Sample>,
    /// In the order of the tracks.
    pub(super) humans: Vec<Sample>,
}

impl Row {
    /// Time, s; `None` for a row of nobody.
    pub(super) fn t(&self) -> Option<f64> {
        self.robot.as_ref().or_else(|| self.humans.first()).map(|sample| sample.t)
    }

    /// Whether the row is part of the robot's trip: it is recorded at that time, or there is no robot at all.
    pub(super) fn counts(&self) -> bool {
        self.robot.is_none_or(|robot| robot.there)
    }

    /// How far the robot is from a goal, m; `None` while it is not there.
    fn left_m(&self, goal: &Point) -> Option<f64> {
        self.robot.filter(|robot| robot.there).map(|robot| (robot.at - goal).norm())
    }

    /// When the robot comes to its goal, if it does so at this row at the latest and was not there at the row before.
    pub(super) fn reaches_s(&self, before: Option<&Self>, goal: &Point) -> Option<f64> {
        let (t, left) = (self.t()?, self.left_m(goal).filter(|left| *left <= GOAL_M)?);
        let earlier = before.and_then(|row| Some((row.t()?, row.left_m(goal)?))).filter(|(_, far)| *far > GOAL_M);
        Some(earlier.map_or(t, |(from, far)| from + (t - from) * (far - GOAL_M) / (far - left)))
    }

    /// Velocities from where everybody was and will be; as recorded for who is there at this one time only.
    pub(super) fn speed_up(&mut self, before: Option<&Self>, after: Option<&Self>) {
        let all = self.robot.iter_mut().map(|sample| (None, sample));
        let all = all.chain(self.humans.iter_mut().enumerate().map(|(index, sample)| (Some(index), sample)));
        for (index, sample) in all {
            let of = |row: Option<&Self>| {
                let found = match index {
                    None => row?.robot,
                    Some(index) => row?.humans.get(index).copied(),
                };
                found.filter(|found| found.there)
            };
            if sample.there {
                sample.velocity = velocity(of(before).as_ref(), sample, of(after).as_ref());
            }
        }
    }
}

fn velocity(before: Option<&Sample>, now: &Sample, after: Option<&Sample>) -> socrates_model::Vector {
    let (from, to) = (before.unwrap_or(now), after.unwrap_or(now));
    if to.t > from.t { (to.at - from.at) / (to.t - from.t) } else { now.velocity }
}

/// Turns samples into rows. A row is known with the first sample at or after its time.
#[derive(Debug, Clone, Default)]
pub(super) struct Grid {
    first_s: Option<f64>,
    next: u32,
    last: Row,
}

impl Grid {
    fn next_s(&self) -> f64 {
        self.first_s.unwrap_or(0.0) + f64::from(self.next) * EVEN_SECS
    }

    /// Takes the next samples and hands on the rows that come with them.
    pub(super) fn push(&mut self, robot: Option<&Sample>, humans: &[Sample], mut row: impl FnMut(Row)) {
        let Some(t) = robot.or_else(|| humans.first()).map(|sample| sample.t) else { return };
        self.first_s.get_or_insert(t);
        while self.next_s() <= t && self.next < u32::MAX {
            let at = self.next_s();
            let one = |before: Option<&Sample>, now: &Sample| {
                between(before, now, at).unwrap_or(Sample { t: at, there: false, ..*now })
            };
            let humans = humans.iter().enumerate().map(|(index, human)| one(self.last.humans.get(index), human));
            row(Row { robot: robot.map(|now| one(self.last.robot.as_ref(), now)), humans: humans.collect() });
            self.next += 1;
        }
        self.last.robot = robot.copied();
        self.last.humans.clear();
        self.last.humans.extend_from_slice(humans);
    }

    /// The row of a time that rounding puts a hair behind the last sample.
    pub(super) fn tail(&self) -> Option<Row> {
        self.last.t().filter(|t| self.first_s.is_some() && self.next_s() <= t + 1e-9).map(|_| self.last.clone())
    }
}

/// The rows of tracks that are whole.
pub(super) fn rows(tracks: &Tracks) -> Vec<Row> {
    let mut grid = Grid::default();
    let mut found = Vec::new();
    let mut humans: Vec<Sample> = Vec::with_capacity(tracks.humans.len());
    for index in 0..tracks.all().next().map_or(0, |track| track.samples.len()) {
        humans.clear();
        humans.extend(tracks.humans.iter().filter_map(|human| human.samples.get(index)));
        let robot = tracks.robot.as_ref().and_then(|robot| robot.samples.get(index));
        grid.push(robot, &humans, |row| found.push(row));
    }
    found.extend(grid.tail());
    found
}

/// Tracks on the grid, from rows in their order, with velocities.
pub(super) fn tracks_of(head: &Tracks, rows: &[Row]) -> Tracks {
    let speed_up = |index: usize, row: &Row| {
        let mut row = row.clone();
        row.speed_up(index.checked_sub(1).and_then(|index| rows.get(index)), rows.get(index + 1));
        row
    };
    let whole: Vec<Row> = rows.iter().enumerate().map(|(index, row)| speed_up(index, row)).collect();
    let robot = head.robot.as_ref().map(|robot| robot.with(whole.iter().filter_map(|row| row.robot).collect()));
    let robot = robot.filter(|robot: &Track| !robot.samples.is_empty());
    let human = |(index, track): (usize, &Track)| {
        track.with(whole.iter().filter_map(|row| row.humans.get(index).copied()).collect())
    };
    let humans = head.humans.iter().enumerate().map(human);
    // Who is not there during the trip is no part of it.
    let humans = humans.filter(|track| track.samples.iter().any(|sample| sample.there)).collect();
    Tracks { robot, humans }
}

/// Tracks on the grid.
pub(super) fn even(tracks: &Tracks) -> Tracks {
    tracks_of(tracks, &rows(tracks))
}

/// The part of the rows in which the robot is there: what comes before and after is no part of its trip.
pub(super) fn trip(rows: &[Row]) -> &[Row] {
    let first = rows.iter().position(Row::counts).unwrap_or(rows.len());
    let last = rows.iter().rposition(Row::counts).map_or(first, |last| last + 1);
    rows.get(first..last).unwrap_or_default()
}

/// The tracks as recorded while the robot is there, up to its arrival.
pub(super) fn recorded<'a>(full: &'a Tracks, first_s: f64, last_s: f64) -> Cow<'a, Tracks> {
    let ends = |track: &Track| {
        let from = track.samples.partition_point(|sample| sample.t < first_s - 1e-9);
        let to = track.samples.partition_point(|sample| sample.t <= last_s + 1e-9);
        (from, to)
    };
    if full.all().all(|track| ends(track) == (0, track.samples.len())) {
        return Cow::Borrowed(full);
    }
    let cut = |track: &Track| {
        let (from, to) = ends(track);
        track.with(track.samples.get(from..to).unwrap_or_default().to_vec())
    };
    Cow::Owned(Tracks {
        robot: full.robot.as_ref().map(cut),
        humans: full.humans.iter().map(cut).filter(|track| track.samples.iter().any(|s| s.there)).collect(),
    })
}
