//! Tables of the prompts, made from the types that the readers take.

use serde::Serialize;
use serde_json::{Value, json};
use socrates_model::proposal::Relation;
use socrates_model::reading::FactKind;
use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{Action, AgentId, Gesture, GroupId, HumanId, PlaceClass, Predicate, RobotRule, Trigger};

use crate::terse;

/// Everything a proposal may say, in its short form.
pub(crate) fn proposal_tables() -> String {
    let place = PlaceClass::ALL.map(|class| class.name()).join(", ");
    let (setup, outcome): (Vec<_>, Vec<_>) =
        predicates().into_iter().partition(|(_, meaning)| meaning.ends_with(" (setup)"));
    let plain = |rows: Vec<(Value, String)>| {
        let rows: Vec<(Value, String)> = rows
            .into_iter()
            .map(|(form, meaning)| {
                let end = meaning.rfind(" (").unwrap_or(meaning.len());
                let meaning = meaning.get(..end).unwrap_or_default().to_owned();
                (form, meaning)
            })
            .collect();
        short(&rows)
    };
    format!(
        "# Lines\nA rule: `robot_near:2 + robot_moving -> run_away for=5 gesture=WAIT latched`; of the part after the action \
         take what is needed. `latched` goes on when the triggers no longer hold.\nA line of the script: \
         `blocked:3 -> say:EXCUSE_ME`. A `test`: `meets human=human_1 within_m=2.5`. Distances in m, times in s.\n\
         ## Triggers\n{}## Actions\n{}## Gestures\n{}\n## Relations to the robot's way\n{}## Script, when\n{}## Script, act\n{}\
         ## Tests of setup clauses\n{}## Tests of outcome clauses\n{}## Place classes\n{place}\n",
        short(&triggers().iter().map(|trigger| (json!(trigger), trigger.phrase())).collect::<Vec<_>>()),
        short(&actions().iter().map(|action| (json!(action), action.phrase())).collect::<Vec<_>>()),
        gestures(),
        short(&relations()),
        short(&robot_when()),
        short(&robot_do()),
        plain(setup),
        plain(outcome),
    )
}

/// Triggers, actions and gestures of rules, in their full form.
pub(crate) fn rule_tables() -> String {
    let triggers: Vec<(String, String)> =
        triggers().iter().map(|trigger| (spelled(trigger), trigger.phrase())).collect();
    let actions: Vec<(String, String)> = actions().iter().map(|action| (spelled(action), action.phrase())).collect();
    format!(
        "# Triggers (`when`; all of a rule's triggers must hold)\n{}# Actions (`act`)\n{}# Gestures, the same for everybody\n{}\n",
        lines(&triggers),
        lines(&actions),
        gestures()
    )
}

/// Codes and names of gestures.
pub(crate) fn gestures() -> String {
    let names: Vec<String> =
        Gesture::ALL.iter().map(|gesture| format!("{} {}", gesture.code(), gesture.name())).collect();
    names.join(", ")
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
        FactKind::Gestures { human, gesture } => format!("{human} says {gesture}"),
        FactKind::Place(class) => format!("place {}", class.name()),
        FactKind::RobotTask(task) => format!("task: {task}"),
        FactKind::RobotSays(gesture) => format!("the robot says {gesture}"),
        FactKind::RobotStart(class) => format!("the robot starts at {}", class.name()),
        FactKind::RobotGoal(class) => format!("the robot ends at {}", class.name()),
        FactKind::Pattern(card) => format!("pattern {card}"),
    }
}

/// A line of the robot's script.
pub(crate) fn script_line(rule: &RobotRule) -> String {
    format!("{} -> {}", terse::line(&json!(rule.when)), terse::line(&json!(rule.act)))
}

fn short(rows: &[(Value, String)]) -> String {
    rows.iter().map(|(form, meaning)| format!("- `{}`: {meaning}\n", terse::line(form))).collect()
}

fn lines(rows: &[(String, String)]) -> String {
    rows.iter().map(|(form, meaning)| format!("- `{form}`: {meaning}\n")).collect()
}

fn spelled<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn row<T: Serialize>(value: &T, meaning: &str) -> (Value, String) {
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

fn relations() -> Vec<(Value, String)> {
    vec![
        row(&Relation::Frontal, "comes towards the robot on the same way"),
        row(&Relation::Behind, "comes from behind; follows or overtakes"),
        row(&Relation::Ahead, "walks ahead of the robot, the same way"),
        row(&Relation::Crossing, "crosses the robot's way"),
        row(&Relation::Static, "stands where the robot passes; also every member of a standing group"),
        row(&Relation::Leaving, "comes out of the room or elevator that the robot passes or enters"),
        row(&Relation::Staying, "stays inside the room or elevator that the robot enters"),
        row(&Relation::Abreast, "walks beside the robot"),
    ]
}

fn robot_when() -> Vec<(Value, String)> {
    vec![
        row(&RobotWhen::Start, "from the start"),
        row(&RobotWhen::Blocked(3.0), "a human has stood in its way for so many seconds"),
        row(&RobotWhen::HumanNear(3.0), "a human is within this distance"),
        row(&RobotWhen::HumanSays(Gesture::Wait), "a human makes this gesture"),
        row(&RobotWhen::AtEncounter(HumanId::new(1)), "it comes to the place where it meets this human"),
        row(&RobotWhen::AfterSecs(10.0), "so many seconds after the start"),
    ]
}

fn robot_do() -> Vec<(Value, String)> {
    vec![
        row(&RobotDo::Say(Gesture::ExcuseMe), "makes the gesture"),
        row(&RobotDo::Hold(3.0), "stands for so many seconds"),
        row(&RobotDo::WaitForLeavers, "waits outside a door until everybody who leaves is out"),
        row(&RobotDo::Follow(HumanId::new(1)), "follows this human"),
        row(&RobotDo::Abreast(HumanId::new(1)), "goes beside this human"),
        row(&RobotDo::Lead(4.0), "waits for followers who fall further behind than this"),
    ]
}

fn predicates() -> Vec<(Value, String)> {
    let human = HumanId::new(1);
    let group = GroupId(1);
    vec![
        row(&Predicate::Humans { count: 2 }, "so many humans are there all the time (setup)"),
        row(
            &Predicate::Meets { human, within_m: 2.5 },
            "human and robot come so near to each other at their encounter (setup)",
        ),
        row(&Predicate::HeadOn { human }, "they come straight at each other (setup)"),
        row(
            &Predicate::Crosses { human, gap_s: 3.0 },
            "the human crosses the robot's way, both there within `gap_s` (setup)",
        ),
        row(
            &Predicate::Ahead { human, within_m: 4.0, for_s: 3.0 },
            "the human is ahead of the robot for so long (setup)",
        ),
        row(&Predicate::Overtakes { human }, "the human overtakes the robot (setup)"),
        row(&Predicate::RobotPasses { human }, "the robot passes the human (setup)"),
        row(
            &Predicate::Follows {
                follower: AgentId::Human(human),
                leader: AgentId::Robot,
                gap_m: [0.5, 3.5],
                for_s: 5.0,
            },
            "the follower goes behind the leader for so long (setup)",
        ),
        row(&Predicate::Abreast { human, for_s: 5.0 }, "side by side with the robot (setup)"),
        row(&Predicate::Parallel { human, for_s: 5.0 }, "the human goes the robot's way near it for so long (setup)"),
        row(
            &Predicate::Flow { count: 4, within_m: 4.0, angle_deg: [0.0, 30.0] },
            "so many different humans walk near the robot, at such angles to its heading (setup)",
        ),
        row(
            &Predicate::Density { per_m2: [0.1, 0.6], radius_m: 4.0, for_s: 3.0 },
            "so many people per m² are round the robot for so long (setup)",
        ),
        row(
            &Predicate::Surrounds { count: 3, within_m: 1.5, for_s: 3.0 },
            "so many humans are so near to the robot at one time (setup)",
        ),
        row(
            &Predicate::Converges { within_m: 2.5, within_s: 4.0 },
            "all humans come to the place of encounter at about the same time (setup)",
        ),
        row(&Predicate::Blocks { human, for_s: 3.0 }, "the human is in the robot's way for so long (setup)"),
        row(&Predicate::Looks { human, for_s: 2.0 }, "the human stands and looks at the robot (setup)"),
        row(&Predicate::StandsStill { human, for_s: 5.0 }, "the human stands still (setup)"),
        row(&Predicate::RunsAway { human, by_m: 2.0 }, "the human gets away from the robot by so much (setup)"),
        row(&Predicate::GivesWay { human }, "the human leaves the robot's way free (setup)"),
        row(
            &Predicate::Reacts { human, when: vec![Trigger::RobotNear(3.0)], act: Action::StandStill, within_s: 2.0 },
            "after the triggers hold, the action follows within so long (setup)",
        ),
        row(
            &Predicate::Gestures { agent: AgentId::Human(human), gesture: Gesture::Wait },
            "the agent makes the gesture (setup)",
        ),
        row(&Predicate::Leaves { human, door: String::new() }, "the human comes out through the door (setup)"),
        row(&Predicate::StaysInside { human, door: String::new() }, "the human stays behind the door (setup)"),
        row(&Predicate::Enters { human, door: String::new() }, "the human goes in through the door (setup)"),
        row(
            &Predicate::DoorOpens { door: String::new(), robot_m: [1.0, 4.0] },
            "the door opens while the robot is so near (setup)",
        ),
        row(&Predicate::HiddenUntil { human, within_m: 4.0 }, "the two cannot see each other until so near (setup)"),
        row(&Predicate::Formation { group, spread_m: 1.5 }, "the group stands together (setup)"),
        row(&Predicate::WalksTogether { group, spread_m: 3.0 }, "the group walks together (setup)"),
        row(&Predicate::Queues { group, gap_m: [0.5, 1.5] }, "the group stands in a line (setup)"),
        row(
            &Predicate::Order { first: "c2".to_owned(), then: "c3".to_owned() },
            "one clause is seen before another (setup)",
        ),
        row(&Predicate::EncounterAt { place: PlaceClass::Intersection }, "the encounter is at such a place (setup)"),
        row(
            &Predicate::OnTime { human, gap_s: 4.0 },
            "human and robot get to their place of encounter at most so far apart in time (setup)",
        ),
        row(&Predicate::Plausible, "nobody overlaps or runs impossibly fast (setup)"),
        row(&Predicate::RobotArrives, "the robot gets to its goal (outcome)"),
        row(&Predicate::RobotKeeps { min_m: 0.3 }, "the robot keeps this distance from everybody (outcome)"),
        row(&Predicate::RobotEntersLast, "the robot enters after everybody is out (outcome)"),
        row(&Predicate::RobotLeavesFirst, "the robot is out before anybody goes in (outcome)"),
        row(&Predicate::RobotJoins { group }, "the robot ends at the rim of the group (outcome)"),
        row(&Predicate::RobotLeavesGroup { group }, "the robot begins at the group and ends away from it (outcome)"),
        row(
            &Predicate::RobotObeys { gesture: Gesture::Wait, within_s: 2.0 },
            "the robot stops on the gesture (outcome)",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_alternative_of_the_types_has_a_row() {
        let schema = serde_json::to_value(schemars::schema_for!(socrates_model::Proposal)).unwrap();
        let text = proposal_tables();
        for name in ["Trigger", "Action", "Relation", "RobotWhen", "RobotDo", "Predicate"] {
            let found = crate::schema::alternatives(&schema["$defs"][name]);
            assert!(!found.is_empty(), "{name}");
            // A proposal names kinds of places, so authors are not told of the predicates that name a node.
            for alternative in found.into_iter().filter(|name| name != "reaches" && name != "starts_at") {
                let found = [" ", "`", ":"].iter().any(|end| text.contains(&format!("- `{alternative}{end}")));
                assert!(found, "{name} `{alternative}` is not in the tables");
            }
        }
    }

    #[test]
    fn every_test_of_the_table_is_read_back_as_it_was_meant() {
        for (form, _) in predicates() {
            let mut proposal = json!({"expected_events": [{"test": terse::line(&form)}]});
            terse::expand(&mut proposal);
            let read: Predicate = serde_json::from_value(proposal["expected_events"][0]["predicate"].clone()).unwrap();
            let meant: Predicate = serde_json::from_value(form).unwrap();
            assert_eq!(read, meant);
        }
    }
}
