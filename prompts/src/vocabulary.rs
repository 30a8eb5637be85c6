//! Tables of the prompts, made from the types that the readers take.

use serde::Serialize;
use socrates_model::proposal::Relation;
use socrates_model::rule::{RobotDo, RobotWhen};
use socrates_model::{Action, AgentId, Gesture, GroupId, HumanId, PlaceClass, Predicate, Trigger};

/// Everything a proposal may say.
pub(crate) fn proposal_tables() -> String {
    let place = PlaceClass::ALL.map(|class| class.name()).join(", ");
    format!(
        "{}\n## Relations of a human to the robot's way\n{}\n## Robot script, `when`\n{}\n## Robot script, `act`\n{}\n\
         ## Predicates of clauses (distances in m from centre to centre, times in s)\n{}\n## Place classes\n{place}\n",
        rule_tables(),
        lines(&relations()),
        lines(&robot_when()),
        lines(&robot_do()),
        lines(&predicates()),
    )
}

/// Triggers, actions and gestures of rules.
pub(crate) fn rule_tables() -> String {
    let gestures: Vec<String> =
        Gesture::ALL.iter().map(|gesture| format!("{} = {}", gesture.code(), gesture.name())).collect();
    let triggers: Vec<(String, String)> =
        triggers().iter().map(|trigger| (spelled(trigger), trigger.phrase())).collect();
    let actions: Vec<(String, String)> = actions().iter().map(|action| (spelled(action), action.phrase())).collect();
    format!(
        "## Triggers (`when`; all of a rule's triggers must hold)\n{}\n## Actions (`act`)\n{}\n## Gestures, the same for everybody\n{}\n",
        lines(&triggers),
        lines(&actions),
        gestures.join(", ")
    )
}

/// The node library of behavior trees, one line per node.
pub(crate) fn nodes() -> String {
    socrates_bt::CATALOG.iter().map(|sheet| format!("- {}\n", sheet.line())).collect()
}

fn lines(rows: &[(String, String)]) -> String {
    rows.iter().map(|(form, meaning)| format!("- `{form}`: {meaning}\n")).collect()
}

fn spelled<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn row<T: Serialize>(value: &T, meaning: &str) -> (String, String) {
    (spelled(value), meaning.to_owned())
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

fn relations() -> Vec<(String, String)> {
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

fn robot_when() -> Vec<(String, String)> {
    vec![
        row(&RobotWhen::Start, "from the start"),
        row(&RobotWhen::Blocked(3.0), "a human has stood in its way for so many seconds"),
        row(&RobotWhen::HumanNear(3.0), "a human is within this distance"),
        row(&RobotWhen::HumanSays(Gesture::Wait), "a human makes this gesture"),
        row(&RobotWhen::AtEncounter(HumanId::new(1)), "it comes to the place where it meets this human"),
        row(&RobotWhen::AfterSecs(10.0), "so many seconds after the start"),
    ]
}

fn robot_do() -> Vec<(String, String)> {
    vec![
        row(&RobotDo::Say(Gesture::ExcuseMe), "makes the gesture"),
        row(&RobotDo::Hold(3.0), "stands for so many seconds"),
        row(&RobotDo::WaitForLeavers, "waits outside a door until everybody who leaves is out"),
        row(&RobotDo::Follow(HumanId::new(1)), "follows this human"),
        row(&RobotDo::Abreast(HumanId::new(1)), "goes beside this human"),
        row(&RobotDo::Lead(4.0), "waits for followers who fall further behind than this"),
    ]
}

fn predicates() -> Vec<(String, String)> {
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
            // A proposal names kinds of places, so authors are not told of the predicate that names a node.
            for alternative in found.into_iter().filter(|name| name != "reaches") {
                assert!(text.contains(&format!("\"{alternative}\"")), "{name} `{alternative}` is not in the tables");
            }
        }
    }

    #[test]
    fn the_node_list_comes_from_the_catalogue() {
        let text = nodes();
        for tag in ["Sequence", "FollowRobot", "IsRobotVisible"] {
            assert!(text.contains(&format!("- {tag} ")), "{tag}");
        }
    }
}
