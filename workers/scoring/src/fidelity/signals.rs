//! What the monitors look at: one moment per 0.05 s for every human and the robot.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_maps::openings::Enclosures;
use socrates_maps::{DistanceField, Ground, sight_clear};
use socrates_model::geometry::nearest_on_segment;
use socrates_model::{AgentId, EventKind, HumanId, NodeId, Point};

use crate::evidence::Evidence;
use crate::fidelity::doors::Doors;
use crate::fidelity::leaves::{LeafSpan, is_driven, leaf_spans};
use crate::fidelity::times::{Meeting, meetings_of};
use crate::tracks::{MOVING_MPS, Sample, Track, Tracks};

/// Time between two moments, s: a person at 2 m/s moves 0.1 m between them.
pub(super) const MOMENT_SECS: f64 = 0.05;

/// How a human and the robot stand to each other at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time, s.
    pub t: f64,
    /// Place of this time among the robot's samples: a human who is not there has no moment.
    pub index: usize,
    /// The robot.
    pub robot: Sample,
    /// The human.
    pub human: Sample,
    /// Distance of the centers, m.
    pub distance_m: f64,
    /// How far the human is ahead of the robot along its heading, m; negative behind.
    pub ahead_m: f64,
    /// How far the human is to the left of the robot's heading line, m.
    pub left_m: f64,
    /// Angle between the human's course and the robot's heading, 0 to pi.
    pub course_rad: f64,
    /// How fast they come nearer, m/s.
    pub closing_mps: f64,
    /// The same along the robot's intended way: how far ahead, how far off, m.
    pub way: Option<(f64, f64)>,
    /// Whether there is a line of sight; `None` without a map.
    pub sight: Option<bool>,
}

impl Moment {
    /// Distance of the human from the robot's line, m: the heading ray or the intended way, whichever is nearer.
    #[must_use]
    pub fn off_line_m(&self) -> f64 {
        let by_way = self.way.filter(|(ahead, _)| *ahead > 0.0).map_or(f64::INFINITY, |(_, off)| off);
        let by_heading = if self.ahead_m > 0.0 { self.left_m.abs() } else { f64::INFINITY };
        by_way.min(by_heading)
    }

    /// Unit vector from the robot to the human.
    #[must_use]
    pub fn away(&self) -> socrates_model::Vector {
        let line = self.human.at - self.robot.at;
        let length = line.norm();
        if length > 1e-9 { line / length } else { self.robot.facing() }
    }
}

/// Everything the monitors need, computed once.
pub struct Signals<'a> {
    /// Evidence as given.
    pub evidence: &'a Evidence<'a>,
    /// Tracks at the recording's own rate.
    pub full: &'a Tracks,
    /// Tracks at the rate of moments.
    pub tracks: Tracks,
    /// Moments by human, in time order; empty without a robot.
    pub moments: BTreeMap<HumanId, Vec<Moment>>,
    /// Doors.
    pub doors: Doors<'a>,
    /// Running leaves by human; empty where the recording tells none.
    pub leaves: BTreeMap<HumanId, Vec<LeafSpan>>,
    /// Whether the recording tells leaves of anybody: then one who has none does nothing by its tree.
    tells_leaves: bool,
    /// People who are driven from outside.
    driven: Vec<HumanId>,
    /// When the robot first moves, s; infinite where it never does.
    pub moves_s: f64,
    /// When the robot arrived, s.
    pub arrived_s: Option<f64>,
    /// What is computed of the map; `None` without one.
    pub ground: Option<Arc<Ground>>,
    /// Rooms and cars of the map; `None` without one.
    pub enclosures: Option<Arc<Enclosures>>,
    /// Distance to walls; `None` without a map.
    pub field: Option<Arc<DistanceField>>,
    /// The robot's intended way; `None` without a map or paths.
    pub(super) way: Option<Way>,
    /// Encounters of every human who has several, one after the other.
    pub(super) meetings: BTreeMap<HumanId, Vec<Meeting>>,
}

impl<'a> Signals<'a> {
    /// Computes the signals.
    #[must_use]
    pub fn new(evidence: &'a Evidence<'a>, full: &'a Tracks) -> Self {
        let tracks = full.thinned(MOMENT_SECS);
        let doors = Doors::of(evidence.location, evidence.recording);
        let way =
            evidence.location.zip(evidence.paths).map(|(place, paths)| Way::new(place.graph.polyline(&paths.robot)));
        let ground = evidence.location.map(|location| Ground::of(&location.grid));
        let enclosures = evidence.location.map(Enclosures::of);
        let sight = ground.as_ref().map(|ground| ground.sight());
        let closed: Vec<Vec<(Point, Point)>> = match &tracks.robot {
            Some(robot) if sight.is_some() => robot.samples.iter().map(|sample| doors.closed_at(sample.t)).collect(),
            _ => Vec::new(),
        };
        let mut moments = BTreeMap::new();
        if let Some(robot) = &tracks.robot {
            let robot_on_way: Vec<Option<(f64, f64)>> =
                robot.samples.iter().map(|sample| way.as_ref().and_then(|way| way.place(&sample.at))).collect();
            for track in &tracks.humans {
                let Some(id) = track.human() else { continue };
                let mut list: Vec<Moment> = Vec::with_capacity(track.samples.len());
                let both = robot.samples.iter().zip(&track.samples).enumerate();
                for (index, (r, h)) in both.filter(|(_, (r, h))| r.there && h.there) {
                    let mine = robot_on_way.get(index).copied().flatten();
                    let theirs = way.as_ref().and_then(|way| way.place(&h.at));
                    let closed = closed.get(index).map_or(&[][..], Vec::as_slice);
                    let seen = sight.map(|sight| sight_clear(sight, &r.at, &h.at, closed));
                    list.push(moment(index, r, h, mine.zip(theirs).map(|((a, _), (b, off))| (b - a, off)), seen));
                }
                moments.insert(id, list);
            }
        }
        let field = ground.as_ref().map(|ground| Arc::clone(ground.field()));
        let leaves: BTreeMap<HumanId, Vec<LeafSpan>> = tracks
            .humans
            .iter()
            .filter_map(|track| Some((track.human()?, leaf_spans(evidence.recording, track))))
            .collect();
        let tells_leaves = leaves.values().any(|spans| !spans.is_empty());
        let driven = tracks.humans.iter().filter(|track| is_driven(evidence.recording, track));
        let driven = driven.filter_map(Track::human).collect();
        let moves = full.robot.as_ref().and_then(|robot| robot.present().find(|sample| sample.speed() > MOVING_MPS));
        let moves_s = moves.map_or(f64::INFINITY, |sample| sample.t);
        let arrived_s = evidence
            .recording
            .events
            .iter()
            .find(|event| event.kind == EventKind::RobotArrived)
            .map(|event| event.time.secs());
        let meetings = meetings_of(evidence, tracks.robot.as_ref());
        Self {
            evidence,
            full,
            tracks,
            moments,
            doors,
            leaves,
            tells_leaves,
            driven,
            moves_s,
            arrived_s,
            ground,
            enclosures,
            field,
            way,
            meetings,
        }
    }

    /// Moments of a human; empty when it or the robot is missing.
    #[must_use]
    pub fn of(&self, human: HumanId) -> &[Moment] {
        self.moments.get(&human).map_or(&[], Vec::as_slice)
    }

    /// How near the robot comes to a human in the whole run, m; infinite where either is missing.
    #[must_use]
    pub fn nearest_m(&self, human: HumanId) -> f64 {
        self.of(human).iter().map(|moment| moment.distance_m).fold(f64::INFINITY, f64::min)
    }

    /// Leaves of a human.
    #[must_use]
    pub fn leaves_of(&self, human: HumanId) -> &[LeafSpan] {
        self.leaves.get(&human).map_or(&[], Vec::as_slice)
    }

    /// Whether leaves tell what this human does by their tree; where they do not, their motion alone decides.
    #[must_use]
    pub fn tells_leaves_of(&self, human: HumanId) -> bool {
        self.tells_leaves && !self.driven.contains(&human)
    }

    /// Position of a node.
    #[must_use]
    pub fn node(&self, id: &NodeId) -> Option<Point> {
        Some(self.evidence.location?.graph.node(id)?.at)
    }

    /// Node and position where a human meets the robot, for the first time if it does so several times.
    #[must_use]
    pub fn encounter(&self, human: HumanId) -> Option<(&'a NodeId, Point)> {
        let id = self.evidence.paths?.encounter_of(human)?;
        Some((id, self.node(id)?))
    }

    /// The nth encounter of a human, from 1, with the time that is its own.
    #[must_use]
    pub fn meeting(&self, human: HumanId, nth: u32) -> Option<&Meeting> {
        self.meetings.get(&human)?.get(usize::try_from(nth).ok()?.checked_sub(1)?)
    }

    /// Moments of the human's nth encounter: all where it has but one.
    #[must_use]
    pub fn of_meeting(&self, human: HumanId, nth: u32) -> &[Moment] {
        let all = self.of(human);
        let Some(meeting) = self.meeting(human, nth) else { return all };
        let from = all.partition_point(|moment| moment.t < meeting.from_s);
        let to = all.partition_point(|moment| moment.t < meeting.to_s);
        all.get(from..to).unwrap_or_default()
    }

    /// The track of an agent at the rate of moments.
    #[must_use]
    pub fn track(&self, agent: AgentId) -> Option<&Track> {
        self.tracks.of(agent)
    }

    /// Last time, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.full.end_s()
    }
}

fn moment(index: usize, r: &Sample, h: &Sample, way: Option<(f64, f64)>, sight: Option<bool>) -> Moment {
    let line = h.at - r.at;
    let distance_m = line.norm();
    let facing = r.facing();
    let relative = h.velocity - r.velocity;
    let closing_mps = if distance_m > 1e-9 { -line.dot(&relative) / distance_m } else { 0.0 };
    Moment {
        t: r.t,
        index,
        robot: *r,
        human: *h,
        distance_m,
        ahead_m: facing.dot(&line),
        left_m: facing.perp(&line),
        course_rad: libm::acos(h.course().dot(&facing).clamp(-1.0, 1.0)),
        closing_mps,
        way,
        sight,
    }
}

/// A polyline with the length up to each of its points.
#[derive(Debug, Clone)]
pub(super) struct Way {
    pieces: Vec<(f64, Point, Point)>,
}

impl Way {
    /// The way through the points.
    #[must_use]
    pub(super) fn new(points: Vec<Point>) -> Self {
        let mut s = 0.0;
        let pieces = points
            .iter()
            .zip(points.iter().skip(1))
            .map(|(a, b)| {
                let piece = (s, *a, *b);
                s += (b - a).norm();
                piece
            })
            .collect();
        Self { pieces }
    }

    /// Length along the way to the point nearest to a position, and the distance from the way, m.
    #[must_use]
    pub(super) fn place(&self, point: &Point) -> Option<(f64, f64)> {
        self.pieces
            .iter()
            .map(|(s, a, b)| {
                let (off, nearest) = nearest_on_segment(point, a, b);
                (s + (nearest - a).norm(), off)
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Unit vector along the way at the point of it nearest to a position.
    #[must_use]
    pub(super) fn direction(&self, point: &Point) -> Option<socrates_model::Vector> {
        let off_m = |(_, a, b): &&(f64, Point, Point)| nearest_on_segment(point, a, b).0;
        let (_, a, b) = self.pieces.iter().min_by(|one, other| off_m(one).total_cmp(&off_m(other)))?;
        (b - a).try_normalize(1e-9)
    }
}
