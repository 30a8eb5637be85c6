//! Tables of the prompts, made from the types that the readers take.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};
use socrates_model::proposal::Relation;
use socrates_model::reading::FactKind;
use socrates_model::{Action, Gesture, HumanId, Predicate, Proposal, RobotRule, Trigger};

use crate::terse;

/// A gesture, with what people call it where its name does not say so.
pub(crate) fn told_gesture(gesture: Gesture) -> String {
    if gesture == Gesture::Acknowledged { format!("{} (a wave)", gesture.name()) } else { gesture.name().to_owned() }
}

/// How the humans of a proposal go, by their relations to the robot's way: a line for each that there is.
pub(crate) fn ways_of(proposal: &Proposal) -> String {
    let there = |relation: &Relation| proposal.humans.iter().any(|human| human.relation == *relation);
    let rows = WAYS.iter().filter(|(relation, _)| there(relation));
    rows.map(|(relation, way)| format!("`{}`: {way}\n", relation.name())).collect()
}

const WAYS: [(Relation, &str); 9] = [
    (Relation::Frontal, "the robot's edges at the encounter in the other direction."),
    (
        Relation::Crossing,
        "comes to the encounter on one side of the robot's way and leaves it on the other; touching it is not enough.",
    ),
    (Relation::Behind, "the robot's nodes in the same direction, from its start or before it."),
    (Relation::Ahead, "the same direction, starting further on than the robot."),
    (Relation::Abreast, "the same nodes as the robot."),
    (Relation::Static, "one node, the encounter itself; start and goal are the same."),
    (
        Relation::Leaving,
        "starts inside the room or elevator, comes out of its door, meets the robot at a node in front of it, of whatever class, goes on.",
    ),
    (
        Relation::Aside,
        "one node off the robot's path, or on it where there is floor beside it; no encounter of their own.",
    ),
    (Relation::Staying, "one node inside the room or elevator; no encounter, or the robot's last node."),
];

/// Triggers, actions and gestures of rules, in their full form.
pub(crate) fn rule_tables() -> String {
    let all = |values: Vec<String>| values.join(", ");
    format!(
        "Triggers (`when`; all of a rule's must hold): {}\nActions (`act`): {}\nGestures: {}\n",
        all(triggers().iter().map(spelled).collect()),
        all(actions().iter().map(spelled).collect()),
        gestures()
    )
}

/// Codes and names of gestures.
pub(crate) fn gestures() -> String {
    Gesture::table()
}

/// The people that meet the robot more than once by the clauses of a proposal, and how often.
pub(crate) fn meetings(proposal: &Proposal) -> BTreeMap<HumanId, u32> {
    let mut found: BTreeMap<HumanId, u32> = BTreeMap::new();
    for clause in proposal.expected_events.iter().filter(|clause| clause.must) {
        if let Predicate::MeetsAgain { human, nth, .. } = clause.predicate {
            let times = found.entry(human).or_insert(nth);
            *times = nth.max(*times);
        }
    }
    found.retain(|_, times| *times > 1);
    found
}

/// What a fact says, in few words.
pub(crate) fn fact(kind: &FactKind) -> String {
    match kind {
        FactKind::Humans(count) => format!("humans {count}"),
        FactKind::Group { group, members } => {
            let members: Vec<String> = members.iter().map(ToString::to_string).collect();
            format!("group {}: {}", group.0, members.join(", "))
        }
        FactKind::Reacts { human, rule } => format!("{human}: {}", terse::rule_line(rule)),
        FactKind::Relates { human, relation } => format!("{human}: relation {}", terse::line(&json!(relation))),
        FactKind::Side { human, side } => format!("{human}: side {}", side.name()),
        FactKind::Facing { human, facing } => format!("{human}: faces {}", facing.phrase()),
        FactKind::Pace { human, mps } => format!("{human}: walks at {mps} m/s"),
        FactKind::Goal { human, name, .. } => format!("{human}: goes to {name}"),
        FactKind::MeetsAt { human, name, .. } => format!("{human}: meets the robot at {name}"),
        FactKind::MeetsTimes { human, times, place } => {
            let place = place.map_or_else(String::new, |class| format!(", at last at {}", class.name()));
            format!("{human}: meets the robot {times} times{place}")
        }
        FactKind::Before { first, then, at_door } => {
            format!("{first} before {then}{}", if *at_door { " through the door" } else { "" })
        }
        FactKind::Gestures { human, gesture } => format!("{human} says {gesture}"),
        FactKind::GesturesTo { human, gesture, to } => format!("{human} says {gesture} to {to}"),
        FactKind::Place(class) => format!("place {}", class.name()),
        FactKind::RobotTask(task) => format!("task: {task}"),
        FactKind::RobotSays(gesture) => format!("the robot says {gesture}"),
        FactKind::RobotDoes(line) => format!("the robot: {}", script_line(line)),
        FactKind::RobotStart(class) => format!("the robot starts at {}", class.name()),
        FactKind::RobotGoal(class) => format!("the robot ends at {}", class.name()),
        FactKind::RobotAt { part, name, .. } => format!("the robot's way {} {name}", part.does()),
        FactKind::Pattern(card) => format!("pattern {card}"),
        FactKind::Asked { of } => of.map_or_else(|| "asked for".to_owned(), |agent| format!("{agent}: asked for")),
    }
}

/// A line of the robot's script.
pub(crate) fn script_line(rule: &RobotRule) -> String {
    format!("{} -> {}", terse::line(&json!(rule.when)), terse::line(&json!(rule.act)))
}

pub(crate) fn short(rows: &[(Value, String)]) -> String {
    rows.iter().map(|(form, meaning)| format!("{}: {meaning}\n", terse::line(form))).collect()
}

fn spelled<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

pub(crate) fn row<T: Serialize>(value: &T, meaning: &str) -> (Value, String) {
    (json!(value), meaning.to_owned())
}

fn other() -> HumanId {
    HumanId::new(2)
}

fn triggers() -> Vec<Trigger> {
    vec![
        Trigger::Always,
        Trigger::RobotVisible(5.0),
        Trigger::RobotNear(2.0),
        Trigger::RobotBlocking(1.5),
        Trigger::RobotMoving,
        Trigger::RobotStopped,
        Trigger::RobotPassed,
        Trigger::RobotSays(Gesture::Proceed),
        Trigger::HumanSays(other(), Gesture::Wait),
        Trigger::GoalReached,
        Trigger::AtEncounter,
        Trigger::AfterSecs(10.0),
    ]
}

fn actions() -> Vec<Action> {
    vec![
        Action::Navigate,
        Action::FollowRobot,
        Action::FollowHuman(other()),
        Action::RunAway,
        Action::GiveWay,
        Action::Block,
        Action::LookAtRobot,
        Action::Approach,
        Action::StandStill,
    ]
}

pub(crate) fn relations() -> Vec<(Value, String)> {
    vec![
        row(&Relation::Frontal, "comes towards the robot"),
        row(&Relation::Behind, "comes from behind; follows or overtakes"),
        row(&Relation::Ahead, "walks ahead of the robot"),
        row(&Relation::Crossing, "crosses the robot's way"),
        row(&Relation::Static, "stands where the robot passes; every member of a standing group"),
        row(&Relation::Leaving, "comes out of the room or elevator, may cross then"),
        row(&Relation::Staying, "stays inside it as the robot enters"),
        row(&Relation::Abreast, "walks beside the robot"),
        row(&Relation::Aside, "stands beside its way, never in it; not met"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::act::ACTS;

    #[test]
    fn every_trigger_and_action_of_a_rule_has_a_row() {
        let schema = serde_json::to_value(schemars::schema_for!(socrates_model::Rule)).unwrap();
        let tables = rule_tables();
        // Only steps have these.
        let of_steps = ACTS.iter().filter(|act| act.is_of_steps()).map(|act| act.word);
        let of_steps: Vec<&str> = of_steps.chain(["stopped_for", "did", "done"]).collect();
        for name in ["Trigger", "Action"] {
            let found = crate::schema::alternatives(&schema["$defs"][name]);
            assert!(found.len() > 5, "{name}: {found:?}");
            for word in found.into_iter().filter(|word| !of_steps.contains(&word.as_str())) {
                assert!(tables.contains(&format!("\"{word}\"")), "{name} `{word}` is not in {tables}");
            }
        }
    }
}
