//! Shapes: everybody as a body that stays what it is while their frame moves, gestures above them, the goal, the doors.
//!
//! A message holds the whole scene and takes away whatever is not in it. So the newest one is all that a late viewer needs, also
//! one that asks a viewer program's own memory for it; between two people who come or go nothing is sent at all.

use bytes::Bytes;
use socrates_model::recording::AgentInfo;
use socrates_model::{Gesture, SimTime};
use socrates_stream::foxglove::{AgentShape, Color, LINE_LIST, MAP, Proto, cylinder, entity, fact, line, stamp};

use super::encode::bytes;
use super::facts::Door;

/// Radius of the goal as it is drawn, m.
const GOAL_M: f64 = 0.3;
/// Number of `ALL` among the types of a deletion.
const ALL: u64 = 1;

const GESTURE_PINK: Color = [0.8, 0.2, 0.55, 1.0];
const GOAL_GREEN: Color = [0.0, 0.62, 0.45, 0.5];
/// A door that is shut.
const SHUT: Color = [0.0, 0.62, 0.45, 1.0];
/// A door that is open: its line is still seen.
const OPEN: Color = [0.0, 0.62, 0.45, 0.25];

/// One agent as it is drawn.
#[derive(Debug, Clone)]
pub(super) struct Figure {
    pub(super) body: AgentShape,
    /// Its place among the agents of the header.
    pub(super) place: usize,
    role: String,
}

impl Figure {
    pub(super) fn of(info: &AgentInfo, place: usize) -> Self {
        Self { body: AgentShape::of(info), place, role: info.role.clone() }
    }
}

/// A door that keeps its name.
#[derive(Debug, Clone)]
pub(super) struct DoorShape {
    pub(super) id: String,
    from: [f64; 2],
    to: [f64; 2],
    pub(super) open: bool,
}

impl DoorShape {
    pub(super) fn of(door: &Door<'_>) -> Self {
        Self { id: door.id.to_owned(), from: door.from, to: door.to, open: door.open }
    }

    fn draw(&self, out: &mut Proto, time: SimTime) {
        entity(out, time, MAP, &format!("door_{}", self.id), |out| {
            fact(out, "open", if self.open { "true" } else { "false" });
            line(out, LINE_LIST, [self.from, self.to].into_iter(), 0.03, 0.08, if self.open { OPEN } else { SHUT });
        });
    }
}

/// Takes away all that was drawn on a topic.
fn clear(out: &mut Proto, time: SimTime) {
    out.message(1, |out| {
        stamp(out, 1, time);
        out.number(2, ALL);
    });
}

/// `/scene`: these figures, the doors, the goal, and nothing else.
pub(super) fn scene<'a>(
    time: SimTime,
    figures: impl Iterator<Item = &'a Figure>,
    doors: &[DoorShape],
    goal: Option<[f64; 2]>,
) -> Bytes {
    bytes(|out| {
        clear(out, time);
        if let Some([x, y]) = goal {
            entity(out, time, MAP, "goal", |out| {
                cylinder(out, [x, y, 0.02], [2.0 * GOAL_M, 2.0 * GOAL_M, 0.02], 1.0, GOAL_GREEN);
            });
        }
        doors.iter().for_each(|door| door.draw(out, time));
        for Figure { body, role, .. } in figures {
            body.draw(out, time, |out| fact(out, "role", role), &body.name);
        }
    })
}

/// `/socrates/labels`: these gestures, and nothing else.
pub(super) fn labels<'a>(time: SimTime, made: impl Iterator<Item = (&'a Figure, Gesture)>) -> Bytes {
    bytes(|out| {
        clear(out, time);
        made.for_each(|(figure, gesture)| figure.body.label(out, time, gesture.name(), GESTURE_PINK));
    })
}
