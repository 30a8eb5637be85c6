//! Events in words, and as the page is told.

use serde_json::{Value, json};
use socrates_model::{Event, EventKind};

/// An event as the page is told.
#[must_use]
pub fn event_json(event: &Event) -> Value {
    let (kind, who) = of(&event.kind);
    let mut told = json!({ "t": event.time.secs(), "kind": kind, "who": who, "text": words(&event.kind) });
    if let EventKind::Door { door, open } = &event.kind
        && let Some(told) = told.as_object_mut()
    {
        told.insert("door".to_owned(), json!(door));
        told.insert("open".to_owned(), json!(open));
    }
    told
}

/// Kind of an event in a word, and who it is of.
fn of(kind: &EventKind) -> (&'static str, Option<String>) {
    match kind {
        EventKind::Gesture { agent, .. } => ("gesture", Some(agent.to_string())),
        EventKind::Leaf { human, .. } => ("leaf", Some(human.to_string())),
        EventKind::StepEnded { human, .. } => ("step", Some(human.to_string())),
        EventKind::Sees { human, .. } => ("sees", Some(human.to_string())),
        EventKind::Encounter { human, .. } => ("encounter", Some(human.to_string())),
        EventKind::Contact { a, .. } => ("contact", Some(a.to_string())),
        EventKind::WallContact { agent, .. } => ("wall", Some(agent.to_string())),
        EventKind::Door { .. } => ("door", None),
        EventKind::Node { agent, .. } => ("node", Some(agent.to_string())),
        EventKind::RobotArrived => ("arrived", Some("robot".to_owned())),
        EventKind::Stuck { agent } => ("stuck", Some(agent.to_string())),
        EventKind::End { .. } => ("end", None),
    }
}

/// An event in words.
#[must_use]
pub fn words(kind: &EventKind) -> String {
    match kind {
        EventKind::Gesture { agent, gesture: Some(gesture), to } => {
            format!("{agent} gestures {gesture}{}", to.map_or_else(String::new, |to| format!(" to {to}")))
        }
        EventKind::Gesture { agent, .. } => format!("{agent} ends the gesture"),
        EventKind::Leaf { human, leaf } => format!("{human}: {leaf}"),
        EventKind::StepEnded { human, step } => format!("step {step} of {human} is over"),
        EventKind::Sees { human, distance_m } => format!("{human} sees the robot, {distance_m:.2} m away"),
        EventKind::Encounter { human, node, gap_s, .. } => {
            let order = if *gap_s < 0.0 { "before" } else { "after" };
            format!("{human} meets the robot at {node}, {:.1} s {order} it", gap_s.abs())
        }
        EventKind::Contact { a, b, depth_m } => format!("{a} touches {b}, {depth_m:.2} m deep"),
        EventKind::WallContact { agent, depth_m } => format!("{agent} touches a wall, {depth_m:.2} m deep"),
        EventKind::Door { door, open } => format!("{door} {}", if *open { "opens" } else { "closes" }),
        EventKind::Node { agent, node } => format!("{agent} is at {node}"),
        EventKind::RobotArrived => "the robot is at its goal".to_owned(),
        EventKind::Stuck { agent } => format!("{agent} makes no progress"),
        EventKind::End { reason } => format!("the run ends: {reason}"),
    }
}
