//! Shapes: everybody as a body that stays what it is while their frame moves, gestures above them, the goal, the doors.
//!
//! A message holds the whole scene and takes away whatever is not in it. So the newest one is all that a late viewer needs, also
//! one that asks a viewer program's own memory for it; between two people who come or go nothing is sent at all.

use foxglove::bytes::Bytes;
use foxglove::messages::line_primitive::Type as LineType;
use foxglove::messages::scene_entity_deletion::Type as Deletion;
use foxglove::messages::{
    ArrowPrimitive, Color, CylinderPrimitive, KeyValuePair, LinePrimitive, Point3, SceneEntity, SceneEntityDeletion,
    SceneUpdate, TextPrimitive, Vector3,
};
use socrates_model::recording::AgentInfo;
use socrates_model::{AgentId, Gesture, SimTime};

use super::encode::{MAP, bytes, pose, stamp};
use super::facts::Door;

/// Height at which people are drawn, m; recordings have the same.
const PERSON_M: f64 = 1.7;
/// Height at which the robot is drawn, m; recordings have the same.
const ROBOT_M: f64 = 0.6;
/// Height of a line of text, m.
const TEXT_M: f64 = 0.25;
/// Radius of the goal as it is drawn, m.
const GOAL_M: f64 = 0.3;

const fn color([r, g, b, a]: [f64; 4]) -> Option<Color> {
    Some(Color { r, g, b, a })
}

const DARK: [f64; 4] = [0.1, 0.1, 0.1, 1.0];
const ROBOT_BLUE: [f64; 4] = [0.0, 0.45, 0.7, 1.0];
const PERSON_ORANGE: [f64; 4] = [0.84, 0.37, 0.0, 1.0];
const GESTURE_PINK: [f64; 4] = [0.8, 0.2, 0.55, 1.0];
const GOAL_GREEN: [f64; 4] = [0.0, 0.62, 0.45, 0.5];
/// A door that is shut.
const SHUT: [f64; 4] = [0.0, 0.62, 0.45, 1.0];
/// A door that is open: its line is still seen.
const OPEN: [f64; 4] = [0.0, 0.62, 0.45, 0.25];

/// One agent as it is drawn.
#[derive(Debug, Clone)]
pub(super) struct Figure {
    /// The name of the agent, which is that of its frame and of its entity.
    pub(super) name: String,
    /// Its place among the agents of the header.
    pub(super) place: usize,
    radius_m: f64,
    role: String,
    height_m: f64,
    color: [f64; 4],
}

impl Figure {
    pub(super) fn of(info: &AgentInfo, place: usize) -> Self {
        let (height_m, color) = match info.agent {
            AgentId::Robot => (ROBOT_M, ROBOT_BLUE),
            AgentId::Human(_) => (PERSON_M, PERSON_ORANGE),
        };
        Self { name: info.agent.to_string(), place, radius_m: info.radius_m, role: info.role.clone(), height_m, color }
    }

    /// Body, heading and name.
    fn entity(&self, time: SimTime) -> SceneEntity {
        SceneEntity {
            frame_locked: true,
            metadata: vec![KeyValuePair { key: "role".to_owned(), value: self.role.clone() }],
            arrows: vec![ArrowPrimitive {
                pose: Some(pose([0.0, 0.0, self.height_m + 0.05], 0.0)),
                shaft_length: self.radius_m + 0.2,
                shaft_diameter: 0.06,
                head_length: 0.15,
                head_diameter: 0.15,
                color: color(DARK),
            }],
            cylinders: vec![CylinderPrimitive {
                pose: Some(pose([0.0, 0.0, self.height_m / 2.0], 0.0)),
                size: Some(Vector3 { x: 2.0 * self.radius_m, y: 2.0 * self.radius_m, z: self.height_m }),
                bottom_scale: 1.0,
                top_scale: 0.8,
                color: color(self.color),
            }],
            texts: vec![text(self.height_m + 0.3, self.name.clone(), DARK)],
            ..entity(time, &self.name, self.name.clone())
        }
    }

    /// A gesture above the head.
    fn label(&self, time: SimTime, gesture: Gesture) -> SceneEntity {
        SceneEntity {
            frame_locked: true,
            texts: vec![text(self.height_m + 0.65, gesture.name().to_owned(), GESTURE_PINK)],
            ..entity(time, &self.name, format!("label_{}", self.name))
        }
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

    fn entity(&self, time: SimTime) -> SceneEntity {
        let points = [self.from, self.to].map(|[x, y]| Point3 { x, y, z: 0.03 }).into();
        SceneEntity {
            metadata: vec![KeyValuePair { key: "open".to_owned(), value: self.open.to_string() }],
            lines: vec![LinePrimitive {
                r#type: LineType::LineList.into(),
                pose: Some(pose([0.0; 3], 0.0)),
                thickness: 0.08,
                points,
                color: color(if self.open { OPEN } else { SHUT }),
                ..LinePrimitive::default()
            }],
            ..entity(time, MAP, format!("door_{}", self.id))
        }
    }
}

fn goal_entity(time: SimTime, [x, y]: [f64; 2]) -> SceneEntity {
    SceneEntity {
        cylinders: vec![CylinderPrimitive {
            pose: Some(pose([x, y, 0.02], 0.0)),
            size: Some(Vector3 { x: 2.0 * GOAL_M, y: 2.0 * GOAL_M, z: 0.02 }),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: color(GOAL_GREEN),
        }],
        ..entity(time, MAP, "goal".to_owned())
    }
}

/// An entity without shapes, which stays until it is taken away.
fn entity(time: SimTime, frame: &str, id: String) -> SceneEntity {
    SceneEntity { timestamp: stamp(time), frame_id: frame.to_owned(), id, ..SceneEntity::default() }
}

/// A text that faces the viewer.
fn text(height_m: f64, text: String, rgba: [f64; 4]) -> TextPrimitive {
    TextPrimitive {
        pose: Some(pose([0.0, 0.0, height_m], 0.0)),
        billboard: true,
        font_size: TEXT_M,
        scale_invariant: false,
        color: color(rgba),
        text,
    }
}

/// A message that replaces all that was drawn on its topic.
fn whole(time: SimTime, entities: Vec<SceneEntity>) -> Bytes {
    let all = SceneEntityDeletion { timestamp: stamp(time), r#type: Deletion::All.into(), id: String::new() };
    bytes(&SceneUpdate { deletions: vec![all], entities })
}

/// `/scene`: these figures, the doors, the goal, and nothing else.
pub(super) fn scene<'a>(
    time: SimTime,
    figures: impl Iterator<Item = &'a Figure>,
    doors: &[DoorShape],
    goal: Option<[f64; 2]>,
) -> Bytes {
    let goal = goal.map(|at| goal_entity(time, at));
    let doors = doors.iter().map(|door| door.entity(time));
    whole(time, goal.into_iter().chain(doors).chain(figures.map(|figure| figure.entity(time))).collect())
}

/// `/socrates/labels`: these gestures, and nothing else.
pub(super) fn labels<'a>(time: SimTime, made: impl Iterator<Item = (&'a Figure, Gesture)>) -> Bytes {
    whole(time, made.map(|(figure, gesture)| figure.label(time, gesture)).collect())
}
