//! Edits in words: what they change, and that they change nothing else.

use socrates_model::job::Stage;
use socrates_model::{Action, FaultCode, Gesture, HumanId, Location, PlaceClass, Predicate, Relation, Trigger};
use socrates_offline::{Draft, Edited, Offline, edit};
use socrates_prompts::Question;

use crate::common::question;

/// A scenario as the stages write it.
fn draft(on: &str, text: &str) -> (Question, Draft) {
    let mut ask = question(on, text);
    let proposal = socrates_prompts::parse_proposal(&Offline::answer(&ask)).unwrap();
    ask.proposal = Some(proposal.clone());
    ask.stage = Stage::Paths;
    let paths = socrates_prompts::parse_paths(&Offline::answer(&ask), &ask).unwrap();
    ask.stage = Stage::Behaviors;
    let behaviors = socrates_prompts::parse_behaviors(&Offline::answer(&ask), &ask).unwrap();
    (ask, Draft { proposal, paths: Some(paths), behaviors: Some(behaviors) })
}

const TWO: &str =
    "A nurse comes towards the robot in the corridor and stops when it is within 2 m. A visitor follows the robot.";

/// The scenario before and after an edit that is done without a remainder.
fn edited(on: &str, text: &str, words: &str) -> (Draft, Edited) {
    let (ask, before) = draft(on, text);
    let after = edit(&ask, &before, words);
    assert!(after.not_done.is_empty(), "{words}: {:?}", after.not_done);
    assert!(!after.done.is_empty() && after.draft != before, "{words}");
    (before, after)
}

fn length_m(location: &Location, nodes: &[socrates_model::NodeId]) -> f64 {
    nodes.windows(2).map(|pair| location.graph.edge_length_m(&pair[0], &pair[1]).unwrap()).sum()
}

fn id(number: u32) -> HumanId {
    HumanId::new(number)
}

#[test]
fn the_robots_path_gets_longer_or_shorter_and_nothing_else_changes() {
    let place = socrates_maps::shipped::load("hospital").unwrap();
    for (words, longer) in [
        ("make the robot's path longer", true),
        ("Please lengthen the route of the robot by 4 m.", true),
        ("the robot should drive further", true),
        ("shorten the robot's path", false),
        ("a shorter way for the robot", false),
    ] {
        let (before, after) = edited("hospital", TWO, words);
        let (old, new) = (before.paths.unwrap(), after.draft.paths.unwrap());
        assert_eq!(length_m(&place, &new.robot) > length_m(&place, &old.robot), longer, "{words}");
        assert_eq!((&new.humans, &new.encounters), (&old.humans, &old.encounters), "{words}");
        assert_eq!((after.draft.proposal, after.draft.behaviors), (before.proposal, before.behaviors), "{words}");
    }
}

#[test]
fn a_humans_path_changes_alone() {
    for words in ["make the nurse's path longer", "extend the way of human 1"] {
        let (before, after) = edited("hospital", TWO, words);
        let (old, new) = (before.paths.unwrap(), after.draft.paths.unwrap());
        assert!(new.humans[&id(1)].len() > old.humans[&id(1)].len(), "{words}");
        assert_eq!((&new.robot, &new.humans[&id(2)]), (&old.robot, &old.humans[&id(2)]), "{words}");
        assert_eq!(after.draft.proposal, before.proposal, "{words}");
    }
}

#[test]
fn somebody_who_waits_somewhere_joins() {
    let (before, after) = edited("office", TWO, "add a third person who waits at the door");
    let new = &after.draft;
    assert_eq!((new.proposal.humans.len(), new.proposal.humans[2].relation), (3, Relation::Static));
    assert_eq!(new.proposal.humans[..2], before.proposal.humans[..]);
    let (old, paths) = (before.paths.unwrap(), new.paths.clone().unwrap());
    assert_eq!(paths.robot, old.robot);
    assert_eq!(paths.humans[&id(3)].len(), 1);
    assert_eq!((&paths.humans[&id(1)], &paths.humans[&id(2)]), (&old.humans[&id(1)], &old.humans[&id(2)]));
    let trees = new.behaviors.clone().unwrap();
    let known = before.behaviors.unwrap();
    assert_eq!((trees.humans.len(), &trees.humans[&id(1)]), (3, &known.humans[&id(1)]));
    let counts = |clause: &socrates_model::Clause| matches!(clause.predicate, Predicate::Humans { count: 3 });
    assert!(new.proposal.expected_events.iter().any(counts));
    assert!(after.reading.facts.iter().any(|fact| fact.kind == socrates_model::FactKind::Humans(3)));
}

#[test]
fn somebody_new_does_what_is_said() {
    for (words, relation, act) in [
        ("add a doctor who comes towards the robot and looks at it", Relation::Frontal, Some(Action::LookAtRobot)),
        ("Add another visitor who overtakes the robot.", Relation::Behind, None),
        ("a guard should follow the robot", Relation::Behind, Some(Action::FollowRobot)),
    ] {
        let (_, after) = edited("office", TWO, words);
        let human = &after.draft.proposal.humans[2];
        assert_eq!(human.relation, relation, "{words}");
        assert_eq!(human.rules.first().map(|rule| rule.act.clone()), act, "{words}");
        assert!(after.draft.paths.unwrap().humans[&id(3)].len() > 1, "{words}");
    }
}

#[test]
fn the_pace_of_one_changes() {
    for (words, who, faster) in [
        ("the second one should be slower", 1, false),
        ("let the nurse walk faster", 0, true),
        ("human 2: slower, please", 1, false),
        ("speed the visitor up", 1, true),
    ] {
        let (before, after) = edited("office", TWO, words);
        let [old, new] = [&before.proposal, &after.draft.proposal];
        let mps = |proposal: &socrates_model::Proposal| proposal.humans[who].speed_mps.unwrap_or(1.2);
        assert_eq!(mps(new) > mps(old), faster, "{words}");
        assert_eq!(new.humans[1 - who], old.humans[1 - who], "{words}");
        assert_eq!((&after.draft.paths, &after.draft.behaviors), (&before.paths, &before.behaviors), "{words}");
        assert_eq!(new.expected_events, old.expected_events, "{words}");
    }
    let (_, after) = edited("office", TWO, "the visitor walks at 0.6 m/s");
    assert_eq!(after.draft.proposal.humans[1].speed_mps, Some(0.6));
}

#[test]
fn the_meeting_moves_to_another_place() {
    let one = "A person comes towards the robot in the corridor.";
    let (before, after) = edited("office", one, "move it to the other corridor");
    let node = |draft: &Draft| draft.paths.as_ref().unwrap().encounters[0].node.clone();
    assert_ne!(node(&before), node(&after.draft));
    assert_eq!(after.draft.proposal, before.proposal);
    let (_, after) = edited("office", one, "let them meet at the intersection instead");
    assert_eq!(after.draft.proposal.place, PlaceClass::Intersection);
    let place = socrates_maps::shipped::load("office").unwrap();
    assert!(place.graph.node_is(&node(&after.draft), PlaceClass::Intersection));
    let (ask, before) = draft("warehouse", "A worker comes towards the robot.");
    let after = edit(&ask, &before, "move the meeting to the elevator");
    assert_eq!((after.not_done[0].code, &after.draft), (FaultCode::PPlace, &before));
}

#[test]
fn somebody_leaves_and_the_others_are_numbered_anew() {
    let (before, after) = edited("office", TWO, "remove the nurse");
    let new = &after.draft;
    assert_eq!((new.proposal.humans.len(), new.proposal.humans[0].role.as_str()), (1, "visitor"));
    assert_eq!(new.proposal.humans[0].id, id(1));
    let (old, paths) = (before.paths.unwrap(), new.paths.clone().unwrap());
    assert_eq!((&paths.robot, &paths.humans[&id(1)]), (&old.robot, &old.humans[&id(2)]));
    assert!(new.proposal.expected_events.iter().all(|clause| clause.predicate.human().is_none_or(|who| who == id(1))));
    assert_eq!(new.behaviors.as_ref().unwrap().humans.len(), 1);
    let (_, after) = edited("office", TWO, "delete human 2");
    assert_eq!(after.draft.proposal.humans[0].role, "nurse");
}

#[test]
fn a_group_leaves_or_is_broken_up() {
    let text = "A group of three employees stands in the open area and talks. A visitor comes towards the robot.";
    let (_, after) = edited("office", text, "remove the group");
    let proposal = &after.draft.proposal;
    assert_eq!((proposal.humans.len(), proposal.humans[0].role.as_str(), proposal.groups.len()), (1, "visitor", 0));
    assert!(proposal.expected_events.iter().all(|clause| clause.predicate.group().is_none()));
    let (before, after) = edited("office", text, "break up the group");
    assert_eq!((after.draft.proposal.humans.len(), after.draft.proposal.groups.len()), (4, 0));
    assert_eq!(after.draft.paths, before.paths);
}

#[test]
fn nobody_gestures_any_more() {
    let text =
        "A nurse crosses at the intersection and gestures WAIT. A visitor steps aside when the robot says EXCUSE_ME.";
    for words in ["no gestures", "without any gestures please", "remove all gestures"] {
        let (_, after) = edited("hospital", text, words);
        let proposal = &after.draft.proposal;
        assert!(proposal.humans.iter().flat_map(|human| &human.rules).all(|rule| rule.gesture.is_none()), "{words}");
        let gestures = |clause: &socrates_model::Clause| matches!(clause.predicate, Predicate::Gestures { .. });
        assert!(!proposal.expected_events.iter().any(gestures), "{words}");
        // Somebody who waited for the word reacts to the robot itself.
        assert_eq!(proposal.humans[1].rules[0].when, [Trigger::RobotNear(3.0)], "{words}");
    }
}

#[test]
fn what_somebody_does_changes_in_place() {
    let (before, after) =
        edited("office", "A nurse comes towards the robot in the corridor.", "let her stop 3 m before the robot");
    let human = &after.draft.proposal.humans[0];
    assert_eq!((human.rules.len(), &human.rules[0].act), (1, &Action::StandStill));
    assert_eq!(human.rules[0].when, [Trigger::RobotNear(3.0)]);
    assert_eq!(after.draft.paths, before.paths);
    // The distance of a rule that is there changes, and nothing else of it.
    let (before, after) = edited("office", TWO, "the nurse should stop 3 m before the robot");
    let [old, new] = [&before.proposal.humans[0], &after.draft.proposal.humans[0]];
    assert_eq!((&new.rules[0].when[..], new.rules[0].for_s), (&[Trigger::RobotNear(3.0)][..], old.rules[0].for_s));
    assert_eq!(after.draft.proposal.humans[1], before.proposal.humans[1]);
    let trees = |draft: &Draft| draft.behaviors.clone().unwrap().humans;
    assert_eq!(trees(&after.draft)[&id(2)], trees(&before)[&id(2)]);
    assert_ne!(trees(&after.draft)[&id(1)], trees(&before)[&id(1)]);
}

#[test]
fn deeds_durations_and_refusals_are_edited() {
    let (_, after) = edited("office", TWO, "the nurse waits for 9 seconds");
    assert_eq!(after.draft.proposal.humans[0].rules[0].for_s, Some(9.0));
    let (_, after) = edited("office", TWO, "the nurse does not stop");
    assert!(after.draft.proposal.humans[0].rules.is_empty());
    let (_, after) = edited("office", TWO, "the nurse gestures WAIT to the robot");
    assert!(after.draft.proposal.humans[0].rules.iter().any(|rule| rule.gesture == Some(Gesture::Wait)));
    let (_, after) = edited("office", TWO, "the visitor runs away when the robot comes within 2 m");
    let rules = &after.draft.proposal.humans[1].rules;
    assert!(
        rules.iter().any(|rule| rule.act == Action::RunAway && rule.when == [Trigger::RobotNear(2.0)]),
        "{rules:?}"
    );
    let (_, after) = edited("office", TWO, "both look at the robot");
    let looks = |human: &socrates_model::HumanProposal| human.rules.iter().any(|rule| rule.act == Action::LookAtRobot);
    assert!(after.draft.proposal.humans.iter().all(looks));
}

#[test]
fn what_the_documents_and_other_rooms_show_is_done() {
    for (words, who) in [
        ("human_1 should wave at the robot", 0),
        ("human_1 should wave at the robot for 3 s when it is within 2 m", 0),
        ("human_1 walks at 0.8 m/s", 0),
        ("human_1 walks slower", 0),
        ("human_1 gives way when the robot is within 2 m", 0),
        ("slow down the visitor", 1),
    ] {
        let (before, after) = edited("office", TWO, words);
        let humans = before.proposal.humans.iter().zip(&after.draft.proposal.humans);
        let changed: Vec<usize> = humans.enumerate().filter(|(_, (old, new))| old != new).map(|(at, _)| at).collect();
        assert_eq!(changed, [who], "{words}");
    }
    let (_, after) = edited("office", TWO, "add a third person who follows human_2, then remove the first");
    assert_eq!(after.draft.proposal.humans.len(), 2);
    assert_eq!(after.draft.proposal.humans[1].rules[0].act, Action::FollowHuman(id(1)));
    let (_, after) = edited("office", TWO, "let human_1 and human_2 swap places; slow down the second one");
    assert_eq!(after.done.len(), 2, "{:?}", after.done);
}

#[test]
fn ways_start_end_turn_and_avoid() {
    let one = "A person comes towards the robot in the corridor.";
    let (before, after) = edited("office", one, "reverse the robot's path");
    let (old, new) = (before.paths.unwrap(), after.draft.paths.unwrap());
    assert!(
        new.robot.iter().eq(old.robot.iter().rev()) && new.humans[&id(1)].iter().eq(old.humans[&id(1)].iter().rev())
    );
    let (before, after) = edited("office", one, "the robot should end at the exit");
    let place = socrates_maps::shipped::load("office").unwrap();
    let (old, new) = (before.paths.unwrap(), after.draft.paths.unwrap());
    assert!(place.graph.node_is(new.robot.last().unwrap(), PlaceClass::Exit));
    assert_eq!((&new.humans, &new.encounters), (&old.humans, &old.encounters));
    assert_eq!(after.draft.proposal.robot.goal, Some(PlaceClass::Exit));
}

#[test]
fn several_wishes_are_done_one_after_the_other() {
    let (before, after) =
        edited("office", TWO, "Make the robot's path longer and remove the visitor. The nurse should be slower.");
    assert_eq!(after.done.len(), 3, "{:?}", after.done);
    assert_eq!(after.draft.proposal.humans.len(), 1);
    assert!(after.draft.paths.unwrap().robot.len() > before.paths.unwrap().robot.len());
}

#[test]
fn what_cannot_be_done_is_said_and_changes_nothing() {
    let (ask, before) = draft("office", TWO);
    for words in [
        "",
        "make it nicer",
        "the robot should be slower",
        "remove everybody",
        "remove the astronaut",
        "he should wait",
        "paint the walls blue",
        "ungroup them",
        "let the fourth one be faster",
    ] {
        let after = edit(&ask, &before, words);
        assert_eq!(after.draft, before, "{words}: {:?}", after.done);
        assert!(after.not_done.iter().all(|fault| fault.is_soft() || fault.code == FaultCode::PPlace), "{words}");
        assert!(
            !after.not_done.is_empty() && after.not_done[0].message.to_string().contains("what can be said"),
            "{words}: {:?}",
            after.not_done
        );
    }
    // What can be done of an edit is done, and the rest is named.
    let after = edit(&ask, &before, "the nurse should be slower and wear a hat");
    assert!(after.draft != before && !after.not_done.is_empty());
}

#[test]
fn the_same_edit_gives_the_same_bytes_and_any_text_is_answered() {
    let (ask, before) = draft("hospital", TWO);
    for words in [
        "move it to the other corridor",
        "add a child",
        "ß’t né 3 m m m",
        "and and and",
        "human_99 stops",
        "\u{202e}remove",
    ] {
        let bytes = || serde_json::to_vec(&edit(&ask, &before, words).draft.proposal).unwrap();
        assert_eq!(bytes(), bytes(), "{words}");
    }
}

#[test]
fn a_way_starts_at_the_place_that_was_named() {
    let place = socrates_maps::shipped::load("office").unwrap();
    let mut done = 0;
    for rough in ["A nurse comes towards the robot.", "A visitor crosses at the intersection.", "A visitor crosses."] {
        for (words, starts) in [("start human_1 at the kitchen", true), ("human_1 should end at the kitchen", false)] {
            let (ask, before) = draft("office", rough);
            let after = edit(&ask, &before, words);
            // Where no way keeps the meeting, that is said.
            if after.draft == before {
                assert!(!after.not_done.is_empty(), "{rough} {words}");
                continue;
            }
            let way = &after.draft.paths.unwrap().humans[&id(1)];
            let end = if starts { way.first() } else { way.last() };
            let kind = place.graph.node(end.unwrap()).unwrap().kind.to_lowercase();
            assert!(kind.contains("kitchen"), "{rough} {words}: {kind}");
            done += 1;
        }
    }
    assert!(done > 0);
    let (ask, before) = draft("office", "A nurse comes towards the robot.");
    let after = edit(&ask, &before, "start human_1 at the cafeteria");
    assert_eq!(after.draft, before);
    assert!(after.not_done[0].message.to_string().contains("no place called"), "{:?}", after.not_done);
}

#[test]
fn two_change_places() {
    for words in ["swap the nurse and the visitor", "let human_1 and human_2 exchange their paths", "swap them"] {
        let (before, after) = edited("office", TWO, words);
        let (old, new) = (before.paths.unwrap(), after.draft.paths.unwrap());
        assert_eq!((&new.humans[&id(1)], &new.humans[&id(2)]), (&old.humans[&id(2)], &old.humans[&id(1)]), "{words}");
        let (was, is) = (&before.proposal.humans, &after.draft.proposal.humans);
        assert_eq!((is[0].relation, is[1].relation), (was[1].relation, was[0].relation), "{words}");
        assert_eq!((&is[0].rules, &is[0].role), (&was[0].rules, &was[0].role), "{words}");
    }
}

#[test]
fn a_group_is_made_and_a_group_joins() {
    for words in ["make the nurse and the visitor a group", "group human_1 and human_2", "put both into one group"] {
        let (_, after) = edited("office", "A nurse comes towards the robot. A visitor crosses.", words);
        let proposal = &after.draft.proposal;
        assert_eq!(proposal.groups.len(), 1, "{words}");
        assert_eq!(proposal.groups[0].members, [id(1), id(2)], "{words}");
        assert!(proposal.humans.iter().all(|human| human.group == Some(proposal.groups[0].id)), "{words}");
        let told = |clause: &socrates_model::Clause| clause.predicate.group() == Some(proposal.groups[0].id);
        assert!(proposal.expected_events.iter().any(told), "{words}");
    }
    let (before, after) =
        edited("office", "A nurse comes towards the robot.", "add a group of three visitors who talk");
    let proposal = &after.draft.proposal;
    assert_eq!((proposal.humans.len(), before.proposal.humans.len()), (4, 1));
    assert_eq!(proposal.groups.iter().map(|group| group.members.len()).collect::<Vec<_>>(), [3]);
}

#[test]
fn gestures_come_and_change() {
    let said = |edited: &Edited, who: usize| -> Vec<Gesture> {
        edited.draft.proposal.humans[who].rules.iter().filter_map(|rule| rule.gesture).collect()
    };
    let (_, after) = edited("office", TWO, "add a WAIT gesture to the nurse");
    assert_eq!(said(&after, 0), [Gesture::Wait]);
    let asks = |clause: &socrates_model::Clause| {
        matches!(clause.predicate, Predicate::Gestures { gesture: Gesture::Wait, .. })
    };
    assert!(after.draft.proposal.expected_events.iter().any(asks));
    let one = "A nurse crosses at the intersection and gestures WAIT.";
    for words in ["change the nurse's gesture to PROCEED", "replace the gesture WAIT by PROCEED"] {
        let (_, after) = edited("hospital", one, words);
        assert_eq!(said(&after, 0), [Gesture::Proceed], "{words}");
        assert!(!after.draft.proposal.expected_events.iter().any(asks), "{words}");
    }
    let (_, after) = edited("hospital", one, "remove the nurse's gesture");
    assert_eq!(said(&after, 0), []);
    let (ask, before) = draft("office", TWO);
    for words in ["change the nurse's gesture to PROCEED", "add a gesture to the nurse", "swap the nurse"] {
        let after = edit(&ask, &before, words);
        assert_eq!(after.draft, before, "{words}");
        assert!(!after.not_done.is_empty(), "{words}");
    }
}

#[test]
fn the_story_tells_of_everybody_who_is_there_and_of_nobody_else() {
    let two = "A person comes towards the robot in the corridor. A person follows the robot.";
    let (before, after) = edited("office", two, "add a person who walks towards the robot");
    let story = &after.draft.proposal.description;
    assert!(before.proposal.description.contains("2 humans take part."), "{}", before.proposal.description);
    assert!(story.contains("3 humans take part.") && story.contains("human_3: "), "{story}");
    assert!(story.contains("human_1: ") && story.contains("human_2: "), "{story}");
    let ask = Question { proposal: None, ..draft("office", two).0 };
    let changed = edit(&ask, &after.draft, "human_3 stops when the robot is within 2 m");
    let story = changed.draft.proposal.description;
    let told = |id: &str| story.split(&format!("{id}: ")).nth(1).unwrap().split("human_").next().unwrap().to_owned();
    assert!(told("human_3").contains("stand still") && !told("human_1").contains("stand still"), "{story}");
    let fewer = edit(&ask, &after.draft, "remove human_2").draft.proposal.description;
    assert!(fewer.contains("2 humans take part.") && !fewer.contains("human_3"), "{fewer}");
    assert_eq!(fewer.matches("human_2: ").count(), 1, "{fewer}");
}

#[test]
fn a_wish_is_done_whole_or_not_at_all_and_words_left_out_are_named_as_such() {
    let (ask, before) = draft("office", TWO);
    let after = edit(&ask, &before, "the visitor stops and yodels when the robot is within 2 m");
    assert!(after.not_done.is_empty() != after.done.is_empty(), "{after:?}");
    if after.done.is_empty() {
        assert_eq!(after.draft, before);
    } else {
        assert!(after.left_out.iter().any(|words| words.contains("yodels")), "{:?}", after.left_out);
    }
    let slow = edit(
        &ask,
        &before,
        "the nurse walks slower. the nurse walks slower. the nurse walks slower. the nurse walks slower. the nurse walks slower. the nurse walks slower",
    );
    let again = edit(&ask, &slow.draft, "the nurse walks slower. the nurse walks slower. the nurse walks slower");
    let last = edit(&ask, &again.draft, "the nurse walks slower");
    assert!(last.done.is_empty() && last.not_done[0].message.to_string().contains("0.3 to 1.8 m/s"), "{last:?}");
}

#[test]
fn somebody_who_is_named_twice_is_removed_once() {
    let rough = "Three people are in the corridor: a nurse, a visitor and a porter. They walk towards the robot.";
    let (ask, before) = draft("hospital", rough);
    let ids =
        |draft: &Draft| draft.proposal.humans.iter().map(|human| human.id).collect::<std::collections::BTreeSet<_>>();
    for words in [
        "add a thi human_2, then remove person first",
        "remove human_2 and human_2",
        "remove the second person and human_2",
        "remove human_3, the third and the porter",
    ] {
        let after = edit(&ask, &before, words);
        assert_eq!(ids(&after.draft).len(), after.draft.proposal.humans.len(), "{words}");
        assert!(!after.draft.proposal.humans.is_empty(), "{words}");
    }
}

#[test]
fn a_man_or_a_woman_is_whoever_is_called_so_and_else_nobody_is_changed() {
    let two = "A nurse comes towards the robot in the corridor. A visitor crosses its way.";
    for (roles, words, changed) in [
        (["man", "woman"], "the woman should wait 3 s", Some(1)),
        (["elderly man", "young woman"], "the woman stops 2 m before the robot", Some(1)),
        (["employee (man)", "employee (woman)"], "the man stops 2 m before the robot", Some(0)),
        (["male nurse", "female visitor"], "the visitor runs away", Some(1)),
        (["nurse", "visitor"], "the woman runs away", None),
        (["man", "woman"], "the lady runs away when the robot is within 2 m", None),
        (["man", "woman"], "she stops 2 m before the robot", None),
    ] {
        let (ask, mut before) = draft("office", two);
        for (human, role) in before.proposal.humans.iter_mut().zip(roles) {
            human.role = role.to_owned();
        }
        let after = edit(&ask, &before, words);
        let humans = before.proposal.humans.iter().zip(&after.draft.proposal.humans);
        let others: Vec<usize> = humans.enumerate().filter(|(_, (old, new))| old != new).map(|(at, _)| at).collect();
        assert_eq!(others, changed.into_iter().collect::<Vec<_>>(), "{roles:?}: {words}");
        assert_eq!(after.not_done.is_empty(), changed.is_some(), "{words}: {:?}", after.not_done);
    }
}
