//! Words that stand for others, people who are nobody, the robot's errand, and counts taken back.

use socrates_model::{Action, FactKind, FaultCode, Gesture, HumanId, PlaceClass, Reading, Relation, Trigger};

use crate::tests::told;

fn reading(on: &str, rough: &str) -> Reading {
    told(rough, on)
}

fn roles(on: &str, rough: &str) -> Vec<String> {
    reading(on, rough).humans.into_iter().map(|human| human.role).collect()
}

#[test]
fn people_who_are_only_spoken_of_are_nobody() {
    for (rough, roles_of) in [
        (
            "We had a complaint about a patient near room 214. So: an elderly patient runs away from the robot.",
            "patient",
        ),
        ("Anna comes towards the robot. She doesn't stop, she thinks that robots should go around people.", "anna"),
        ("The night shift of 12 has gone home, the only person left is a guard. He walks ahead of the robot.", "guard"),
        ("The night team has 12 members, but only one of them is in the corridor: an orderly who crosses.", "orderly"),
        ("A worker blocks the robot. The point of the scene is a person who does not yield.", "worker"),
        ("For the trust study I need someone who obeys it. A doctor comes towards the robot.", "doctor"),
        ("Although 60 people work on this floor, one is enough: a cleaner who walks ahead of the robot.", "cleaner"),
        ("A guard blocks the robot. The landlord wants to know what the robot does then.", "guard"),
    ] {
        assert_eq!(roles("hospital", rough), [roles_of], "{rough}");
    }
}

#[test]
fn a_number_that_is_taken_back_is_the_later_one_whatever_words_take_it_back() {
    for (rough, wanted) in [
        ("Three nurses, no sorry, two, are standing in the corridor.", 2),
        ("There are three nurses standing there, no, two.", 2),
        ("Six nurses, scratch that, three, cross the corridor.", 3),
        ("Five nurses, or better make that four, cross the corridor.", 4),
        ("Five nurses, that is, four, cross the corridor.", 4),
        ("It should be four nurses and not three. They cross the corridor.", 4),
        ("Two nurses cross the corridor, no one else.", 2),
    ] {
        let found = roles("hospital", rough);
        assert_eq!(found, vec!["nurse"; wanted], "{rough}");
    }
}

#[test]
fn the_robot_s_errand_is_read_in_the_story() {
    let ends = |rough: &str| {
        let reading = reading("hospital", rough);
        let of = |wanted: fn(&FactKind) -> Option<PlaceClass>| reading.facts.iter().find_map(|fact| wanted(&fact.kind));
        (
            of(|kind| if let FactKind::RobotStart(class) = kind { Some(*class) } else { None }),
            of(|kind| if let FactKind::RobotGoal(class) = kind { Some(*class) } else { None }),
        )
    };
    let way = (Some(PlaceClass::Room), Some(PlaceClass::Exit));
    for rough in [
        "Task: pharmacy -> exit. A nurse crosses the robot's way in the corridor.",
        "Send the robot from the pharmacy to the exit. A nurse crosses its way in the corridor.",
        "From the pharmacy to the exit, the robot has a nurse walking behind it.",
        "Robot: from the pharmacy to the exit, via the waiting area. A nurse crosses its way in the corridor.",
    ] {
        assert_eq!(ends(rough), way, "{rough}");
    }
}

#[test]
fn who_stays_inside_is_read_wherever_the_robot_comes_in() {
    for rough in [
        "Two managers sit in the meeting room and stay there when the robot comes in.",
        "The robot drives into the meeting room, where two managers are sitting. Both stay inside.",
        "Kitchen: two managers are inside and remain there when the robot comes in.",
    ] {
        let reading = reading("office", rough);
        let relations: Vec<Option<Relation>> = reading.humans.iter().map(|human| human.relation).collect();
        assert_eq!(relations, [Some(Relation::Staying); 2], "{rough}");
        assert_eq!(reading.place, Some(PlaceClass::Room), "{rough}");
    }
}

#[test]
fn what_is_said_last_is_what_others_wait_for() {
    for (rough, who, act, when) in [
        (
            "Unless the robot says excuse me, the picker won't make room.",
            0,
            Action::GiveWay,
            Trigger::RobotSays(Gesture::ExcuseMe),
        ),
        (
            "A clerk stays put unless the robot says excuse me. If it does, he makes room.",
            0,
            Action::GiveWay,
            Trigger::RobotSays(Gesture::ExcuseMe),
        ),
        (
            "A foreman comes towards the robot and two packers walk after him. He says wait, so both packers stop.",
            1,
            Action::StandStill,
            Trigger::HumanSays(HumanId::new(1), Gesture::Wait),
        ),
    ] {
        let reading = reading("warehouse", rough);
        let rule = reading.humans[who].rules.iter().find(|rule| rule.act == act);
        assert_eq!(rule.map(|rule| rule.when.clone()), Some(vec![when]), "{rough}");
    }
}

#[test]
fn what_hands_do_to_the_robot_and_amounts_beyond_reason_are_told() {
    for (rough, code) in [
        ("A nurse comes towards the robot and puts her lunch tray on its lid.", FaultCode::PRead),
        ("A nurse comes towards the robot and takes a box of pills from its tray.", FaultCode::PRead),
        ("A nurse comes towards the robot and hops onto it.", FaultCode::PRead),
        ("A nurse overtakes the robot at 35 m/s.", FaultCode::PLimit),
        ("Exactly three people: a nurse, two visitors and a cleaner.", FaultCode::PContra),
        ("Two nurses come towards the robot. All three nurses stop.", FaultCode::PContra),
    ] {
        let reading = reading("hospital", rough);
        assert!(reading.problems.iter().any(|fault| fault.code == code), "{rough}: {:?}", reading.problems);
    }
    for rough in
        ["A nurse sets off for the exit and crosses the robot's way.", "A nurse takes a break in the corridor."]
    {
        let reading = reading("hospital", rough);
        assert!(reading.problems.iter().all(|fault| fault.code != FaultCode::PRead), "{rough}: {:?}", reading.problems);
    }
}

#[test]
fn slips_of_the_pen_are_mended_and_names_are_left_alone() {
    assert_eq!(roles("office", "A docter corsses the corridor wiht a coleague."), ["doctor", "colleague"]);
    assert_eq!(roles("office", "Lena follows the robot."), ["lena"]);
}
