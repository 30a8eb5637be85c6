//! What people say in passing: where something happens, who is the exception, how long after, where the robot's task ends.

use socrates_model::job::Stage;
use socrates_model::{Action, Gesture, Paths, Predicate, Proposal, Reading, Relation, Trigger};
use socrates_prompts::Question;

use crate::proposal::propose;
use crate::solve::solve;
use crate::tests::{self, map};
use crate::{read, summary};

fn reading(on: &str, rough: &str) -> Reading {
    read(&tests::request("Deliver mail", Some(rough)), &map(on))
}

/// The reading line without the robot's part.
fn line(on: &str, rough: &str) -> String {
    let line = summary(&reading(on, rough));
    line.split(" · robot:").next().unwrap_or_default().to_owned()
}

fn planned(on: &str, task: &str, rough: &str) -> (Reading, Proposal, Paths) {
    let (request, location) = (tests::request(task, Some(rough)), map(on));
    let reading = read(&request, &location);
    let mut ask = Question { stage: Stage::Proposal, ..Question::first(request, reading.clone(), location, 1) };
    let proposal = propose(&ask);
    ask.stage = Stage::Paths;
    ask.proposal = Some(proposal.clone());
    let paths = solve(&ask, &proposal).unwrap();
    (reading, proposal, paths)
}

/// The nodes where the robot's way begins and ends.
fn ends(paths: &Paths) -> (String, String) {
    (paths.robot.first().unwrap().to_string(), paths.robot.last().unwrap().to_string())
}

#[test]
fn in_front_of_the_robot_only_says_where_somebody_comes_out() {
    for rough in [
        "At the junction two interns suddenly step out of the kitchen in front of the robot.",
        "At the junction two interns come right out of a room in front of the robot.",
    ] {
        assert_eq!(line("office", rough), "2 humans · 2 come out of the room · place: intersection", "{rough}");
    }
    assert_eq!(line("office", "Two interns walk in front of the robot."), "2 humans · 2 walk ahead of the robot");
}

#[test]
fn one_of_those_who_come_out_may_stay() {
    for rough in [
        "The lift opens and three visitors get out. One of them is startled by the robot and stays inside.",
        "Three visitors leave the lift, but one of them is startled by the robot and remains in it.",
    ] {
        let line = line("hospital", rough);
        assert!(line.contains("2 leave the elevator") && line.contains("1 startled, stays"), "{line}");
        let relations = reading("hospital", rough).humans;
        assert_eq!(relations.iter().filter(|human| human.relation == Some(Relation::Staying)).count(), 1);
        assert_eq!(reading("hospital", rough).problems, [], "{rough}");
    }
    let all = reading("hospital", "Two visitors get out of the lift. Both visitors stay in the lift.");
    assert!(!all.missing().is_empty(), "{:?}", all.statements);
}

#[test]
fn the_way_begins_and_ends_where_the_task_says_by_name() {
    let meets = "A person comes towards the robot.";
    for (on, task, rough, start, goal) in [
        ("office", "Bring the letters to the reception", meets, None, Some(&["r1", "r2"][..])),
        ("warehouse", "Drive to the loading bay", meets, None, Some(&["kx"][..])),
        (
            "hospital",
            "Carry pills from the pharmacy to the nurse station",
            "A nurse crosses its way.",
            Some("p3"),
            Some(&["ns"][..]),
        ),
        ("hospital", "Bring linen to ward 2", meets, None, Some(&["p2"][..])),
        ("office", "Wash the cups in the kitchen", "A person stands in the way.", None, Some(&["kt"][..])),
    ] {
        let (reading, _, paths) = planned(on, task, rough);
        let (first, last) = ends(&paths);
        assert!(start.is_none_or(|start| start == first), "{task}: {:?}", paths.robot);
        assert!(goal.is_none_or(|goal| goal.contains(&last.as_str())), "{task}: {:?}", paths.robot);
        assert_eq!(reading.problems, [], "{task}");
    }
}

#[test]
fn another_end_than_the_task_says_is_never_silent() {
    let note = |on: &str, task: &str, rough: &str| {
        let (reading, ..) = planned(on, task, rough);
        let messages = reading.problems.into_iter().map(|fault| fault.message.to_string());
        messages.filter(|message| message.starts_with("the robot's")).collect::<Vec<_>>()
    };
    let meets = "A person comes towards the robot.";
    assert_eq!(
        note("hospital", "Bring blood to the laboratory", meets),
        ["the robot's goal `laboratory`: this map has no place of that name; the robot's goal is a room instead"]
    );
    assert_eq!(
        note("hospital", "Deliver sheets to the ward", "Two visitors leave the elevator."),
        ["the robot's goal `ward`: the scenario has its way end at an elevator"]
    );
    assert_eq!(
        note("hospital", "Bring it to ward 9", meets),
        ["the robot's goal `ward 9`: this map has no place of that number; one of the same name is taken"]
    );
}

#[test]
fn who_comes_out_of_a_room_by_name_comes_out_of_that_one() {
    let (_, _, paths) = planned("hospital", "Deliver mail", "A doctor comes out of the ward.");
    let from = paths.humans.values().next().unwrap().first().unwrap().to_string();
    assert!(["p1", "p2"].contains(&from.as_str()), "{from}");
}

#[test]
fn whoever_is_asked_to_gives_way_then() {
    for rough in [
        "A porter stands in the corridor. He makes room when asked.",
        "A porter blocks the robot, but steps aside once asked politely.",
    ] {
        let rules = &reading("hospital", rough).humans[0].rules;
        let gives = rules.iter().find(|rule| rule.act == Action::GiveWay).unwrap();
        assert_eq!(gives.when, [Trigger::RobotSays(Gesture::ExcuseMe)], "{rough}");
    }
}

#[test]
fn whom_the_robot_comes_up_behind_walks_ahead() {
    let behind = reading("office", "The robot comes from behind and tries to overtake a guest.");
    assert_eq!(behind.humans.len(), 1);
    assert_eq!(behind.humans[0].relation, Some(Relation::Ahead));
    assert_eq!(behind.pattern.as_deref(), Some("robot_overtaking"));
    let other = reading("office", "The robot drives down the corridor. A guest comes from behind and overtakes it.");
    assert_eq!(other.humans[0].relation, Some(Relation::Behind));
}

#[test]
fn who_is_only_spoken_of_is_not_there() {
    assert!(!reading("office", "Three clerks chat about a customer.").missing().is_empty());
    assert_eq!(reading("office", "A clerk chats with a customer.").humans.len(), 2);
}

#[test]
fn a_queue_is_one_group_in_line_and_who_joins_it_is_one_more() {
    let rough = "Three visitors queue in the lobby. Another visitor crosses in front of the robot.";
    let (reading, proposal, _) = planned("hospital", "Deliver mail", rough);
    assert_eq!(reading.humans.len(), 4);
    assert_eq!(proposal.groups.len(), 1);
    assert!(proposal.groups[0].standing && proposal.groups[0].members.len() == 3);
    assert!(proposal.expected_events.iter().any(|clause| matches!(clause.predicate, Predicate::Queues { .. })));
    let counted = "There are three visitors. One stands still, another comes towards the robot.";
    assert_eq!(self::reading("hospital", counted).humans.len(), 3);
}

#[test]
fn a_wave_at_the_robot_greets_it() {
    let reading = reading("office", "Two clerks come towards the robot; one of them stops and waves at the robot.");
    let greets = |rule: &socrates_model::Rule| rule.gesture == Some(Gesture::Acknowledged);
    assert_eq!(reading.humans.iter().filter(|human| human.rules.iter().any(greets)).count(), 1);
}

#[test]
fn what_the_robot_carries_is_read() {
    assert_eq!(crate::tests::loose(&reading("office", "A person comes towards the robot.")), [""; 0]);
}

#[test]
fn who_crosses_a_robot_that_turns_does_not_cut_the_same_corner() {
    let (_, proposal, paths) =
        planned("hospital", "Bring pills from the pharmacy to the nurse station", "A nurse crosses its way.");
    let (location, met) = (map("hospital"), &paths.encounters[0].node);
    let chord = |nodes: &[socrates_model::NodeId]| {
        let at = |id: &socrates_model::NodeId| location.graph.node(id).unwrap().at;
        let meet = nodes.iter().position(|node| node == met).unwrap();
        at(&nodes[meet + 1]) - at(&nodes[meet - 1])
    };
    let (robot, human) = (chord(&paths.robot), chord(&paths.humans[&proposal.humans[0].id]));
    assert!((robot.dot(&human) / robot.norm() / human.norm()).abs() < 0.75, "{paths:?}");
}

#[test]
fn nobody_answers_its_own_word() {
    let read = reading("office", "A worker crosses the robot's way. When the worker says proceed, the robot goes on.");
    let rules = &read.humans[0].rules;
    assert!(rules.iter().all(|rule| !rule.when.iter().any(|when| matches!(when, Trigger::HumanSays(..)))), "{rules:?}");
    assert!(rules.iter().any(|rule| rule.gesture == Some(Gesture::Proceed)), "{rules:?}");
}

#[test]
fn a_word_interrupts_what_somebody_does_and_who_has_made_room_does_not_block_again() {
    let said = Trigger::RobotSays(Gesture::ExcuseMe);
    for rough in [
        "A nurse blocks the robot. When the robot says excuse me, she steps aside.",
        "A nurse blocks the robot until it says excuse me, then she steps aside.",
    ] {
        let rules = reading("hospital", rough).humans.remove(0).rules;
        let acts: Vec<(bool, Action)> =
            rules.iter().map(|rule| (rule.when == [said.clone()], rule.act.clone())).collect();
        assert_eq!(acts, [(true, Action::GiveWay), (true, Action::Navigate), (false, Action::Block)], "{rough}");
        assert_eq!(rules[2].for_s, Some(20.0), "{rough}");
    }
    // Whoever says how long keeps to it.
    let rough = "A nurse blocks the robot for 7 seconds. When the robot says excuse me, she steps aside.";
    let blocks = reading("hospital", rough).humans.remove(0).rules.pop().unwrap();
    assert_eq!((blocks.act, blocks.for_s), (Action::Block, Some(7.0)));
}
