//! The proposal against the request's reading and the map: `P-` faults.

use socrates_model::{Fault, FaultCode, Location, NodeId, PlaceClass, Predicate, Proposal, Reading, RobotRule, Where};
use socrates_model::{Gesture, HumanId, SceneGraph, Trigger};

use socrates_model::rule::{RobotDo, RobotWhen};

use crate::lexicon::says;
use crate::places::{classes_of, nodes_of};
use crate::{list, people, verify, wishes};

/// Every fault of a proposal: what it says of itself, what the map can give, what the request asked for.
#[must_use]
pub fn check_proposal(proposal: &Proposal, reading: &Reading, location: &Location) -> Vec<Fault> {
    let mut faults = check_alone(proposal, location);
    faults.extend(wishes::check(proposal, reading));
    faults.extend(verify::facts(proposal, reading));
    faults
}

/// Every fault that needs no reading.
pub(crate) fn check_alone(proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let mut faults = people::check(proposal);
    faults.extend(places(proposal, location));
    faults.extend(labels(proposal, location));
    faults.extend(robot(proposal));
    faults.extend(verify::humans(proposal));
    faults.extend(verify::clauses(proposal));
    faults
}

/// P-PLACE: a class that no node or edge of the map has.
fn places(proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let graph = &location.graph;
    let mut wanted: Vec<(Where, PlaceClass)> = vec![("place".into(), proposal.place)];
    for human in &proposal.humans {
        wanted.extend(human.start.map(|class| (Where::agent(human.id).at_key("start"), class)));
        wanted.extend(human.goal.map(|class| (Where::agent(human.id).at_key("goal"), class)));
    }
    wanted.extend(proposal.robot.start.map(|class| (Where::robot("start"), class)));
    wanted.extend(proposal.robot.goal.map(|class| (Where::robot("goal"), class)));
    for clause in &proposal.expected_events {
        if let Predicate::EncounterAt { place, .. } = clause.predicate {
            wanted.push((Where::clause(&clause.id), place));
        }
    }
    let mut faults: Vec<Fault> = wanted
        .into_iter()
        .filter(|(_, class)| *class != PlaceClass::Plain && nodes_of(graph, *class).is_empty())
        .map(|(at, class)| {
            let message = format!("the map has no `{class}`; its place classes: {}", list(classes_of(graph)));
            Fault::new(FaultCode::PPlace, at, message)
        })
        .collect();
    for clause in &proposal.expected_events {
        let Predicate::EncounterAt { nodes, .. } = &clause.predicate else { continue };
        let unknown: Vec<&NodeId> = nodes.iter().filter(|node| graph.node(node).is_none()).collect();
        if !unknown.is_empty() {
            let message = format!("the map has no node {}; leave `nodes` out to mean the whole class", list(unknown));
            faults.push(Fault::new(FaultCode::PPlace, Where::clause(&clause.id), message));
        }
    }
    for (word, class) in absent_in_prose(&proposal.description, graph) {
        let message = format!(
            "the description speaks of `{word}`, but the map has no `{class}`; its place classes: {}",
            list(classes_of(graph))
        );
        faults.push(Fault::new(FaultCode::PPlace, "description", message));
    }
    faults
}

/// Words of a prose for places that the map lacks. Only words that are never used for another place are looked for.
fn absent_in_prose(prose: &str, graph: &SceneGraph) -> Vec<(&'static str, PlaceClass)> {
    [
        ("elevator", PlaceClass::Elevator),
        ("lift", PlaceClass::Elevator),
        ("intersection", PlaceClass::Intersection),
        ("blind corner", PlaceClass::BlindCorner),
    ]
    .into_iter()
    .filter(|(word, class)| {
        let missing = nodes_of(graph, *class).is_empty() && nodes_of(graph, nearby_class(*class)).is_empty();
        says(prose, word) && missing
    })
    .collect()
}

/// A lobby alone makes an elevator scenario possible to speak of.
const fn nearby_class(class: PlaceClass) -> PlaceClass {
    if matches!(class, PlaceClass::Elevator) { PlaceClass::ElevatorLobby } else { class }
}

/// P-LABEL (warning): ids of nodes in prose. Ids that could be ordinary words are passed over.
fn labels(proposal: &Proposal, location: &Location) -> Vec<Fault> {
    let telling =
        |id: &str| id.len() >= 2 && id.chars().any(|c| c.is_ascii_digit() || c == '_') && id.parse::<u32>().is_err();
    let named: Vec<&str> = location
        .graph
        .nodes()
        .iter()
        .map(|node| node.id.as_str())
        .filter(|id| telling(id) && says(&proposal.description, &id.to_lowercase()))
        .collect();
    if named.is_empty() {
        return Vec::new();
    }
    let message = format!("names the nodes {}; name types of places instead", list(named));
    vec![Fault::new(FaultCode::PLabel, "description", message)]
}

/// P-ROBOT: the robot's part.
fn robot(proposal: &Proposal) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut bad = |at: Where, message: String| faults.push(Fault::new(FaultCode::PRobot, at, message));
    if proposal.robot.expected_behavior.trim().is_empty() {
        bad(Where::robot("expected_behavior"), "is empty; say in a sentence what a good robot would do".to_owned());
    }
    if proposal.robot.task.trim().is_empty() {
        bad(Where::robot("task"), "is empty; say what the robot has to do".to_owned());
    }
    for (index, line) in proposal.robot.script.iter().enumerate() {
        for message in script_line(line, proposal) {
            bad(Where::robot(format!("script line {}", index + 1)), message);
        }
    }
    let said = robot_says(proposal);
    for human in &proposal.humans {
        for (index, rule) in human.rules.iter().enumerate() {
            for trigger in &rule.when {
                if let Trigger::RobotSays(gesture) = trigger
                    && !said.contains(gesture)
                {
                    let message = format!(
                        "waits for {gesture} from the robot, but the robot script never says it; it says {}. Add a script line \
                         that says {gesture}, or change the rule",
                        list(&said)
                    );
                    bad(Where::rule(human.id, index + 1), message);
                }
            }
        }
    }
    faults
}

/// Gestures that the robot's script makes, each once.
pub(crate) fn robot_says(proposal: &Proposal) -> Vec<Gesture> {
    let mut said = Vec::new();
    for line in &proposal.robot.script {
        if let RobotDo::Say(gesture) = line.act
            && !said.contains(&gesture)
        {
            said.push(gesture);
        }
    }
    said
}

fn script_line(line: &RobotRule, proposal: &Proposal) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut known = |id: &HumanId| {
        if proposal.human(*id).is_none() {
            wrong.push(format!(
                "names {id}; humans of the proposal: {}",
                list(proposal.humans.iter().map(|human| human.id))
            ));
        }
    };
    let until = if let RobotDo::HoldUntil(until) = &line.act { until.names() } else { None };
    let with = if let RobotDo::Follow(id) | RobotDo::Abreast(id) | RobotDo::Overtake(id) = &line.act {
        Some(id)
    } else {
        None
    };
    line.when.names().into_iter().chain(until).chain(with).for_each(&mut known);
    let own = proposal.robot.script.iter().position(|other| other == line).unwrap_or_default();
    if let RobotWhen::AfterLine(number) = line.when
        && !usize::try_from(number).is_ok_and(|number| (1..=own).contains(&number))
    {
        wrong.push(format!("begins after line {number}; allowed: the number of a line before it"));
    }
    let number = match (&line.when, &line.act) {
        (_, RobotDo::Hold(s)) if !(*s > 0.0 && *s <= 60.0) => Some(("hold", *s, "0 to 60 s")),
        (_, RobotDo::Lead(m)) if !(*m >= 1.0 && *m <= 15.0) => Some(("lead", *m, "1 to 15 m")),
        (RobotWhen::HumanNear(m) | RobotWhen::Near(_, m), _) if !(*m >= 0.3 && *m <= 15.0) => {
            Some(("human_near", *m, "0.3 to 15 m"))
        }
        (RobotWhen::Blocked(s), _) if !(*s > 0.0 && *s <= 60.0) => Some(("blocked", *s, "0 to 60 s")),
        (RobotWhen::AfterSecs(s), _) if !(*s >= 0.0 && *s <= 600.0) => Some(("after_secs", *s, "0 to 600 s")),
        _ => None,
    };
    wrong.extend(number.map(|(what, value, allowed)| format!("`{what}` is {value}; allowed: {allowed}")));
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{codes, crossing_proposal, plus_map, reading_of};

    #[test]
    fn a_good_proposal_has_no_fault() {
        let proposal = crossing_proposal();
        assert_eq!(check_proposal(&proposal, &reading_of(&proposal), &plus_map()), []);
    }

    #[test]
    fn a_place_the_map_does_not_have_is_named_with_those_it_has() {
        let mut proposal = crossing_proposal();
        proposal.place = PlaceClass::Elevator;
        let faults = check_alone(&proposal, &plus_map());
        assert_eq!(codes(&faults), ["P-PLACE"]);
        assert!(faults[0].message.to_string().contains("`intersection`"), "{}", faults[0].message);
    }

    #[test]
    fn a_gesture_that_the_robot_never_makes_cannot_be_waited_for() {
        let mut proposal = crossing_proposal();
        proposal.humans[0].rules[0].when = vec![Trigger::RobotSays(Gesture::Proceed)];
        assert_eq!(codes(&check_alone(&proposal, &plus_map())), ["P-ROBOT"]);
    }

    #[test]
    fn node_ids_in_prose_are_a_warning_only() {
        let mut proposal = crossing_proposal();
        proposal.description.push_str(" They meet at n_center.");
        let faults = check_alone(&proposal, &plus_map());
        assert_eq!(codes(&faults), ["P-LABEL"]);
        assert!(socrates_model::fault::hard(&faults).is_empty());
    }
}
