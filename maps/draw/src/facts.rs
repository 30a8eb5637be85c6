//! What a fact of the reading says, in words.

use socrates_model::{FactKind, HumanId, PlaceClass, Relation, Rule};

/// The fact in a few words, for people.
#[must_use]
pub fn fact_words(kind: &FactKind) -> String {
    match kind {
        FactKind::Humans(1) => "1 human".to_owned(),
        FactKind::Humans(count) => format!("{count} humans"),
        FactKind::Group { group, members } => format!("{} are a group ({group})", names(members)),
        FactKind::Reacts { human, rule } => format!("{human} {}", rule_words(rule)),
        FactKind::Pace { human, mps } => format!("{human} walks at {mps} m/s"),
        FactKind::Goal { human, name, .. } => format!("{human} goes to {name}"),
        FactKind::MeetsAt { human, name, .. } => format!("{human} meets the robot at {name}"),
        FactKind::MeetsTimes { human, times, place } => {
            let place = place.map_or_else(String::new, |class| format!(", at last at: {}", place_words(class)));
            format!("{human} meets the robot {times} times{place}")
        }
        FactKind::Side { human, side } => format!("{human} is on the {} of the robot's way", side.name()),
        FactKind::Facing { human, facing } => format!("{human} faces {}", facing.phrase()),
        FactKind::Before { first, then, at_door } => {
            format!("{first} is {} before {then}", if *at_door { "through the door" } else { "there" })
        }
        FactKind::Relates { human, relation } => format!("{human} {}", relation_words(*relation)),
        FactKind::Gestures { human, gesture } => format!("{human} says {gesture}"),
        FactKind::GesturesTo { human, gesture, to } => format!("{human} says {gesture} to {to}"),
        FactKind::Place(place) => format!("place: {}", place_words(*place)),
        FactKind::RobotTask(task) => format!("task of the robot: {task}"),
        FactKind::RobotSays(gesture) => format!("the robot says {gesture}"),
        FactKind::RobotDoes(line) => format!("the robot: {}", line.phrase()),
        FactKind::RobotStart(place) => format!("the robot starts at: {}", place_words(*place)),
        FactKind::RobotGoal(place) => format!("the robot goes to: {}", place_words(*place)),
        FactKind::RobotAt { part, name, .. } => format!("the robot's way {} {name}", part.does()),
        FactKind::Asked { of: Some(agent) } => format!("{agent}: as the author read it"),
        FactKind::Asked { of: None } => "as the author read it".to_owned(),
        FactKind::Pattern(card) => format!("pattern: {}", card.replace('_', " ")),
    }
}

fn names(members: &[HumanId]) -> String {
    members.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

fn place_words(place: PlaceClass) -> String {
    place.name().replace('_', " ")
}

fn rule_words(rule: &Rule) -> String {
    let mut out = rule.act.phrase();
    if let Some(gesture) = rule.gesture {
        out.push_str(&format!(" and says {gesture}"));
    }
    if let Some(secs) = rule.for_s {
        out.push_str(&format!(" for {secs} s"));
    }
    if rule.when.is_empty() { out } else { format!("{out} {}", socrates_model::Trigger::phrases(&rule.when)) }
}

const fn relation_words(relation: Relation) -> &'static str {
    match relation {
        Relation::Frontal => "comes towards the robot",
        Relation::Behind => "comes from behind the robot",
        Relation::Ahead => "walks ahead of the robot",
        Relation::Crossing => "crosses the robot's way",
        Relation::Static => "stands where the robot passes",
        Relation::Leaving => "comes out as the robot arrives",
        Relation::Staying => "stays inside",
        Relation::Abreast => "walks beside the robot",
        Relation::Aside => "stands aside",
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_fact_is_told_in_words() {
        let told = |value: serde_json::Value| fact_words(&serde_json::from_value(value).unwrap());
        assert_eq!(told(json!({ "humans": 1 })), "1 human");
        assert_eq!(
            told(json!({ "reacts": { "human": "human_2", "rule": {
                "when": [{ "robot_visible": 5.0 }], "act": "run_away", "for_s": 4.0 } } })),
            "human_2 runs away from the robot for 4 s when they see the robot within 5 m"
        );
        assert_eq!(
            told(json!({ "group": { "group": 1, "members": ["human_1", "human_2"] } })),
            "human_1, human_2 are a group (group_1)"
        );
        assert_eq!(told(json!({ "place": "narrow_passage" })), "place: narrow passage");
    }
}
