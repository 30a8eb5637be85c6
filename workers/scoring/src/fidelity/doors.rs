//! Doors through the run: open or closed, and who crosses their line.

use socrates_model::geometry::segments_cross;
use socrates_model::{Door, DoorOpens, EventKind, Location, NodeId, Point, Recording};

use crate::tracks::Sample;

/// A crossing counts this far beyond the ends of the door line, m: people cut the frame's corner.
pub(crate) const FRAME_M: f64 = 0.3;

/// Doors of a location with the changes that the recording tells.
#[derive(Debug, Clone)]
pub struct Doors<'a> {
    doors: Vec<DoorStory<'a>>,
}

/// A door, whether it is open at the start, and its changes: time in s, open or closed.
type DoorStory<'a> = (&'a Door, bool, Vec<(f64, bool)>);

impl<'a> Doors<'a> {
    /// Doors of a location; none where there is no location.
    #[must_use]
    pub fn of(location: Option<&'a Location>, recording: &Recording) -> Self {
        let doors = location.map_or(&[][..], |location| &location.doors);
        let changes = |id: &str| -> Vec<(f64, bool)> {
            recording
                .events
                .iter()
                .filter_map(|event| match &event.kind {
                    EventKind::Door { door, open } if door == id => Some((event.time.secs(), *open)),
                    EventKind::Door { .. }
                    | EventKind::Gesture { .. }
                    | EventKind::Leaf { .. }
                    | EventKind::StepEnded { .. }
                    | EventKind::Sees { .. }
                    | EventKind::Encounter { .. }
                    | EventKind::Contact { .. }
                    | EventKind::WallContact { .. }
                    | EventKind::Node { .. }
                    | EventKind::RobotArrived
                    | EventKind::Stuck { .. }
                    | EventKind::End { .. } => None,
                })
                .collect()
        };
        Self {
            doors: doors
                .iter()
                .map(|door| {
                    let changes = changes(&door.id);
                    let open = changes.first().map_or(door.opens == DoorOpens::Always, |(_, opens)| !opens);
                    (door, open, changes)
                })
                .collect(),
        }
    }

    /// Whether the place has doors at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.doors.is_empty()
    }

    /// Segments of the doors that are closed at a time.
    #[must_use]
    pub fn closed_at(&self, t: f64) -> Vec<(Point, Point)> {
        self.doors
            .iter()
            .filter(|(_, open, changes)| {
                !changes.iter().take_while(|(when, _)| *when <= t + 1e-9).last().map_or(*open, |(_, opens)| *opens)
            })
            .map(|(door, _, _)| (door.from, door.to))
            .collect()
    }

    /// First time at which the door is open: 0 for one that stands open.
    #[must_use]
    pub fn first_open_s(&self, id: &str) -> Option<f64> {
        let (_, open, changes) = self.doors.iter().find(|(door, _, _)| door.id == id)?;
        if *open { Some(0.0) } else { changes.iter().find(|(_, opens)| *opens).map(|(t, _)| *t) }
    }

    /// Whether the door stands open from the start.
    #[must_use]
    pub fn stands_open(&self, id: &str) -> bool {
        self.doors.iter().any(|(door, open, _)| door.id == id && *open)
    }
}

/// A crossing of a door line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// When, s.
    pub t: f64,
    /// Whether it leads out of the room or car.
    pub outward: bool,
}

/// A point behind the door: the middle of its inside nodes, or `None` where it names none.
#[must_use]
pub(super) fn inside_point(door: &Door, location: &Location) -> Option<Point> {
    let points: Vec<Point> =
        door.inside.iter().filter_map(|id: &NodeId| location.graph.node(id)).map(|node| node.at).collect();
    let first = points.first()?;
    #[expect(clippy::cast_precision_loss, reason = "a door has few inside nodes")]
    let count = points.len() as f64;
    Some(first + points.iter().map(|point| point - first).sum::<socrates_model::Vector>() / count)
}

/// The pieces of a track that lead over the door line, in time order: both samples, and how far each lies on the side that counts as
/// positive, m.
pub(crate) fn pieces_over<'s>(
    door: &Door,
    samples: &'s [Sample],
    depth_m: impl Fn(&Point) -> f64,
) -> impl Iterator<Item = ((&'s Sample, f64), (&'s Sample, f64))> {
    let along = door.to - door.from;
    let length = along.norm();
    let frame = along * (FRAME_M / length);
    let (from, to) = (door.from - frame, door.to + frame);
    samples
        .iter()
        .zip(samples.iter().skip(1))
        .filter(move |(a, b)| length > 0.0 && a.there && b.there && segments_cross(&a.at, &b.at, &from, &to))
        .map(move |(a, b)| ((a, depth_m(&a.at)), (b, depth_m(&b.at))))
        // A sample exactly on the line belongs to the piece that ends there.
        .filter(|((_, before), (_, after))| (*before > 0.0) != (*after > 0.0))
}

/// Crossings of the door line by a track, in time order.
#[must_use]
pub(super) fn crossings(door: &Door, inside: &Point, samples: &[Sample]) -> Vec<Crossing> {
    pieces_over(door, samples, |at| door.depth_m(at, inside))
        .map(|((_, before), (b, _))| Crossing { t: b.t, outward: before > 0.0 })
        .collect()
}
