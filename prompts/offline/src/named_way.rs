//! The robot's way by name: where it begins and ends, what it leads past, what it keeps out of, as form and task say it.

use socrates_model::form::PlaceWord;
use socrates_model::job::Stage;
use socrates_model::proposal::WayPart;
use socrates_model::{Fact, FactKind, Location, NodeId, Paths, Predicate, Proposal, Reading, Request};
use socrates_prompts::Question;
use socrates_reader::Reader;

use crate::task::{End, Task};
use crate::{form, named, solve};

/// Adds the facts of the ends that are played where the task says.
pub(crate) fn ends(found: &[(WayPart, &End)], reading: &mut Reading) {
    for (part, end) in found {
        add(reading, (*part, end.name.clone(), end.nodes.clone()), end.name.clone());
    }
}

/// Adds what a form says of the robot's way by name, and what the task says besides its ends.
pub(crate) fn rest(task: &Task, request: &Request, location: &Location, reading: &mut Reading) {
    let robot = &request.robot;
    let one = |part, place: Option<&PlaceWord>| place.cloned().map(|place| (part, place));
    let stated = [
        one(WayPart::Start, robot.start.as_ref()),
        one(WayPart::Goal, robot.goal.as_ref()),
        one(WayPart::Via, robot.via.as_ref()),
    ];
    let avoided = robot.avoid.iter().cloned().map(|place| (WayPart::Avoid, place));
    for (part, place) in stated.into_iter().flatten().chain(avoided) {
        let Some(bound) = form::bound(&place, location) else { continue };
        let by_class = bound.nodes.is_empty();
        // An end at any place of a class has a fact of its own.
        if by_class && matches!(part, WayPart::Start | WayPart::Goal) {
            continue;
        }
        add(
            reading,
            (part, place.to_string(), bound.all_nodes(location)),
            format!("robot.{} = \"{place}\"", part.name()),
        );
    }
    let back = task.back.as_ref().filter(|_| task.comes_home).cloned();
    if let Some(quote) = robot.returns.then(|| "robot.return = true".to_owned()).or(back) {
        add(reading, (WayPart::Back, "where it began".to_owned(), Vec::new()), quote);
    }
    for end in &task.vias {
        add(reading, (WayPart::Via, end.name.clone(), end.nodes.clone()), end.name.clone());
    }
    for quote in &task.denied {
        for (name, nodes) in avoided_by(quote, location) {
            add(reading, (WayPart::Avoid, name, nodes), quote.clone());
        }
    }
}

fn add(reading: &mut Reading, (part, name, nodes): (WayPart, String, Vec<NodeId>), quote: String) {
    let same = |fact: &Fact| matches!(&fact.kind, FactKind::RobotAt { part: own, .. } if *own == part && part != WayPart::Avoid);
    if nodes.is_empty() && part != WayPart::Back || reading.facts.iter().any(same) {
        return;
    }
    let id = format!("f{}", reading.facts.len() + 1);
    reading.facts.push(Fact { id, quote, kind: FactKind::RobotAt { part, name, nodes } });
}

/// Longest name that is looked for, words.
const LONGEST: usize = 3;

/// The places by name in words that say where the robot is not to go.
pub(crate) fn avoided_by(quote: &str, location: &Location) -> Vec<(String, Vec<NodeId>)> {
    let words: Vec<&str> =
        quote.split(|c: char| !c.is_alphanumeric() && c != '\'' && c != '-').filter(|word| !word.is_empty()).collect();
    let mut found: Vec<(String, Vec<NodeId>)> = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let name = |length: usize| words.get(at..at + length).map(|words| words.join(" "));
        let known = |name: &String| {
            // Each word is one of the name: `the kitchen`, not `enter the kitchen`; or says of what kind it is.
            let own = |word: &str| named::find(location, word).is_some();
            let first = name.split(' ').next().is_some_and(own);
            let last = name.split(' ').next_back().is_some_and(|word| Reader::shipped().may_name(word));
            let all = name.split(' ').all(|word| named::telling(word).is_empty() || own(word));
            (first && last && all).then(|| named::find(location, name)).flatten().filter(|found| found.exact)
        };
        let longest = (1..=LONGEST).rev().find_map(|length| {
            let name = name(length)?;
            Some((length, known(&name)?, name))
        });
        match longest {
            Some((length, place, name)) => {
                if !found.iter().any(|(_, nodes)| *nodes == place.nodes) {
                    found.push((name, place.nodes));
                }
                at += length;
            }
            None => at += 1,
        }
    }
    found
}

/// Whether paths do what a clause says of the robot's way by name; true of any other clause.
pub(crate) fn kept(predicate: &Predicate, paths: &Paths) -> bool {
    let Predicate::RobotWay { part, nodes } = predicate else { return true };
    let own = |node: &NodeId| nodes.contains(node);
    let (first, last) = (paths.robot.first().is_some_and(own), paths.robot_goal().is_some_and(own));
    let any = paths.robot.iter().any(own);
    match part {
        WayPart::Start => first,
        WayPart::Goal => last,
        WayPart::Via => any && !first && !last,
        WayPart::Avoid => !any,
        WayPart::Back => paths.comes_back(),
    }
}

/// Demands of a text that no way of the map does are given up, the hardest first, and said so; a form is refused instead.
pub(crate) fn playable(proposal: &mut Proposal, question: &Question) {
    let asks = |proposal: &Proposal, part: WayPart| {
        proposal
            .expected_events
            .iter()
            .any(|clause| matches!(clause.predicate, Predicate::RobotWay { part: own, .. } if own == part))
    };
    let parts = [WayPart::Via, WayPart::Avoid, WayPart::Back, WayPart::Start, WayPart::Goal];
    if !question.request.form.is_empty() || !parts.iter().any(|part| asks(proposal, *part)) {
        return;
    }
    let ask = Question { stage: Stage::Paths, feedback: Vec::new(), refused: None, ..question.clone() };
    for part in parts {
        if solve::solve(&ask, proposal).is_ok() {
            return;
        }
        if !asks(proposal, part) {
            continue;
        }
        for fact in &question.reading.facts {
            let FactKind::RobotAt { part: own, name, .. } = &fact.kind else { continue };
            if *own == part {
                proposal.notes.push(format!(
                    "`{name}` is not played: with these people no way of the robot on this map {} it",
                    part.does()
                ));
            }
        }
        proposal
            .expected_events
            .retain(|clause| !matches!(clause.predicate, Predicate::RobotWay { part: own, .. } if own == part));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    fn ways(task: &str) -> Vec<(WayPart, String)> {
        let reading = crate::read(&request(task, Some("A person walks towards the robot.")), &map("office"));
        let way =
            |fact: Fact| if let FactKind::RobotAt { part, name, .. } = fact.kind { Some((part, name)) } else { None };
        reading.facts.into_iter().filter_map(way).collect()
    }

    #[test]
    fn places_by_name_are_ends_of_the_way_and_kept_out_of() {
        let one = |part, name: &str| (part, name.to_owned());
        for (task, wanted) in [
            (
                "Bring mail from the reception to the kitchen",
                vec![one(WayPart::Start, "reception"), one(WayPart::Goal, "kitchen")],
            ),
            (
                "Bring mail to the meeting room and do not enter the kitchen",
                vec![one(WayPart::Avoid, "kitchen"), one(WayPart::Goal, "meeting room")],
            ),
            (
                "Drive to the reception past the kitchen",
                vec![one(WayPart::Goal, "reception"), one(WayPart::Via, "kitchen")],
            ),
            ("Drive along the corridor", vec![]),
        ] {
            // In whichever order they are read.
            let sorted = |mut ways: Vec<_>| {
                ways.sort_by_key(|way| format!("{way:?}"));
                ways
            };
            assert_eq!(sorted(ways(task)), sorted(wanted), "{task}");
        }
    }

    #[test]
    fn of_a_task_it_is_said_which_of_its_words_are_not_played() {
        for (on, task, missing) in [
            ("office", "Drive to the reception past the kitchen", vec![]),
            ("office", "Bring mail to the exit without entering the kitchen", vec![]),
            ("office", "Go to the pharmacy", vec!["pharmacy"]),
            ("hospital", "Go through the waiting area to the exit", vec![]),
        ] {
            let reading = crate::read(&request(task, Some("A person walks towards the robot.")), &map(on));
            assert_eq!(reading.missing(), missing, "{on}: {task}: {:?}", reading.statements);
        }
    }
}
