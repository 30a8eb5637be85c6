//! Sentences for the proposal.

use socrates_model::{Action, HumanProposal, PlaceClass, Relation, Rule, Trigger};

use crate::place::words;

/// What a human does, in sentences about this human alone.
pub(crate) fn behavior(
    role: &str,
    relation: Relation,
    place: PlaceClass,
    start: Option<PlaceClass>,
    rules: &[Rule],
    grouped: bool,
) -> String {
    let place = words(place);
    let inside = if start == Some(PlaceClass::Elevator) { "elevator" } else { "room" };
    let company = if grouped { " in company" } else { "" };
    let first = match relation {
        Relation::Frontal => format!("The {role} walks{company} towards the robot and meets it at the {place}."),
        Relation::Behind => format!("The {role} starts behind the robot and walks{company} the same way."),
        Relation::Ahead => format!("The {role} walks ahead of the robot, the same way and slower."),
        Relation::Crossing => format!("The {role} walks across the robot's way at the {place}."),
        Relation::Static if grouped => format!("The {role} stands at the {place} in a circle of people who talk."),
        Relation::Static => format!("The {role} stands at the {place}."),
        Relation::Leaving => {
            format!("The {role} is inside the {inside} at first, comes out of it and walks past the robot.")
        }
        Relation::Staying => format!("The {role} is inside the {inside} and stays there."),
        Relation::Abreast => format!("The {role} walks beside the robot."),
        Relation::Aside => format!("The {role} stands beside the robot's way at the {place}, and never in it."),
    };
    let mut text = first;
    for rule in rules {
        text.push(' ');
        text.push_str(&sentence(rule));
    }
    text
}

/// A rule as a sentence: `When they see the robot within 3 m they stop and look at the robot for 5 s.`
pub(crate) fn sentence(rule: &Rule) -> String {
    let mut text = Trigger::phrases(&rule.when);
    text.push_str(" they ");
    text.push_str(&rule.act.they());
    if let Some(gesture) = rule.gesture {
        text.push_str(&format!(" and gesture {gesture}"));
    }
    if let Some(secs) = rule.for_s {
        text.push_str(&format!(" for {secs} s"));
    }
    text.push('.');
    let mut letters = text.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("{first}{}", letters.as_str())
}

/// How many take part: `2 humans take part.`
pub(crate) fn headcount(humans: usize) -> String {
    match humans {
        1 => "One human takes part.".to_owned(),
        n => format!("{n} humans take part."),
    }
}

/// The whole scenario in sentences that name types of places only.
pub(crate) fn description(about: &str, location: &str, place: PlaceClass, humans: &[HumanProposal]) -> String {
    let count = headcount(humans.len());
    let mut text = format!(
        "{about} It happens at {} of the {}. {count}",
        crate::place::an(place),
        location.replace(['_', '-'], " ")
    );
    for human in humans {
        text.push_str(&format!(" {}: {}", human.id, human.behavior));
    }
    text
}

/// What an action is called in a clause: `runs away from the robot`.
pub(crate) fn done(act: &Action) -> String {
    act.phrase()
}
