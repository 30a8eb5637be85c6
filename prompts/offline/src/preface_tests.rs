//! Names, times of day, interjections, denials and what stands before the story, each in its own words.

use crate::summary;
use crate::tests::told;

fn read(rough: &str) -> String {
    summary(&told(rough, "hospital")).replace(" · robot: deliver mail", "")
}

fn all(pairs: &[(&str, &str)]) {
    let found: Vec<(&str, String)> = pairs.iter().map(|(rough, _)| (*rough, read(rough))).collect();
    let wanted: Vec<(&str, String)> = pairs.iter().map(|(rough, line)| (*rough, (*line).to_owned())).collect();
    assert_eq!(found, wanted);
}

#[test]
fn names_beside_who_somebody_is_are_no_others() {
    all(&[
        ("Dele, our porter, follows the robot. Dele stops.", "1 human · 1 follows the robot, stops"),
        (
            "Our porter on shift 2, Dele, comes towards the robot and Dele steps aside.",
            "1 human · 1 comes towards the robot, gives way",
        ),
        (
            "Two nurses, Ana and Big Tom, come towards the robot. Ana steps aside.",
            "2 humans · 1 comes towards the robot, gives way · 1 comes towards the robot",
        ),
        (
            "A nurse comes towards the robot. Her colleague Jonas follows her. Jonas stops.",
            "2 humans · 1 nurse comes towards the robot · 1 colleague follows human_1, stops",
        ),
        (
            "A second person, a visitor who follows the robot, stops. A nurse stands there.",
            "2 humans · 1 visitor follows the robot, stops · 1 nurse stops",
        ),
    ]);
}

#[test]
fn times_of_day_count_nobody() {
    for when in ["Around half six", "At a quarter to eight", "Ten past two", "At ten", "Around 9 our robot is busy and"]
    {
        assert_eq!(read(&format!("{when}, a nurse follows the robot.")), "1 human · 1 follows the robot", "{when}");
    }
    assert_eq!(read("At four metres, a nurse stops."), "1 human · 1 stops");
}

#[test]
fn what_stands_between_marks_and_says_nothing_breaks_no_sentence() {
    all(&[
        ("A nurse, bless her, follows the robot.", "1 human · 1 follows the robot"),
        ("Folks, a nurse follows the robot.", "1 human · 1 follows the robot"),
        (
            "A nurse follows the robot, by contrast, a visitor comes towards it.",
            "2 humans · 1 nurse follows the robot · 1 visitor comes towards the robot",
        ),
        // Wishes are no interjections.
        ("When they see it, two nurses stop, look, and walk on.", "2 humans · 2 stop, look at the robot, walk on"),
        ("Following her notion of space, two nurses cross the corridor.", "2 humans · 2 cross · place: corridor"),
    ]);
    let faults =
        told("A nurse never, under any circumstances, steps aside. When it is 2 m away, she steps aside.", "hospital");
    assert_eq!(faults.problems.len(), 1, "{faults:#?}");
}

#[test]
fn each_of_a_list_of_denials_is_denied() {
    for denied in [
        "without yielding, stopping or looking at it",
        "and does not stop and look at it",
        "with no reaction: no looking, no getting out of the way",
    ] {
        let reading = told(&format!("A nurse comes towards the robot {denied}."), "hospital");
        assert!(reading.humans[0].rules.is_empty(), "{denied}: {:?}", reading.humans[0].rules);
    }
    let reading = told("A nurse does not step aside by herself, only after the robot has said EXCUSE_ME.", "hospital");
    assert_eq!(reading.humans[0].rules.len(), 1, "{reading:#?}");
}

#[test]
fn people_in_general_before_the_story_are_nobody_in_it() {
    for before in [
        "Tenants have complained that the robot frightens people.",
        "This one is about gestures between humans.",
        "I am looking at how people keep their distance:",
        "The safety officer won't let me switch it on before I have seen this.",
        "Does the tracker cope with somebody who hurries?",
        "Some people love to tease the robot, and the vendor claims it can handle that.",
        "Participants are going to see this from above:",
        "For the pilot (n = 12 participants) this is enough.",
    ] {
        assert_eq!(
            read(&format!("{before} Two nurses follow the robot.")),
            "2 humans · 2 follow the robot",
            "{before}"
        );
    }
    all(&[(
        "A family comes towards the robot: a father, a mother and a child.",
        "3 humans · 1 father comes towards the robot · 1 mother comes towards the robot · 1 child comes towards the robot · group of 3",
    )]);
    // Whom the story takes up again is in it.
    for (rough, humans) in [
        ("Our porter comes towards the robot. A nurse follows it.", 2),
        ("People cross the corridor. A nurse follows the robot.", 3),
        ("I want someone who blocks the robot. A nurse follows it.", 2),
    ] {
        assert_eq!(told(rough, "hospital").humans.len(), humans, "{rough}");
    }
}

#[test]
fn parts_of_several_are_those_of_whom_it_is_said() {
    all(&[
        (
            "Three people are in the elevator: 2 get out, 1 stays. The one who stays asks the robot to wait.",
            "3 humans · 2 leave the elevator · 1 stays, gestures WAIT · place: elevator",
        ),
        (
            "Two people come towards the robot: a nurse and a visitor. The nurse stops.",
            "2 humans · 1 nurse comes towards the robot, stops · 1 visitor comes towards the robot",
        ),
        (
            "A mother and her two sons come towards the robot. The boys stop.",
            "3 humans · 1 mother comes towards the robot · 2 sons come towards the robot, stop",
        ),
    ]);
}

#[test]
fn what_is_done_again_and_again_is_done_three_times() {
    let reading = told("A nurse obstructs the robot again and again.", "hospital");
    let acts: Vec<_> = reading.humans[0].rules.iter().map(|rule| rule.act.clone()).collect();
    assert_eq!(acts.iter().filter(|act| **act == socrates_model::Action::Block).count(), 3, "{acts:?}");
    assert_eq!(acts.len(), 5);
    assert!(reading.problems.is_empty(), "{:?}", reading.problems);
    // Of other deeds it is said that they are played once.
    let reading = told("A nurse looks at the robot again and again.", "hospital");
    assert_eq!(reading.problems.len(), 1, "{:?}", reading.problems);
}
