//! What was read of a clause, in plain words: offered in its place where some of its words were not read.
//!
//! ```text
//! "he gives, as it were, way at 2 m" ─► lines of the story in it ─► "he steps aside when the robot is within 2 m"
//! ```
//!
//! A clause of which a line has no plain words gets none: a sentence that says less than what was read helps nobody.

use std::ops::Range;

use socrates_model::{Gesture, Relation};
use socrates_reader::{Act, Cue, Line, Read, Reason, Step};

use crate::place;

/// Small numbers in words.
const NUMBERS: [&str; 9] = ["two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];

/// The clause at these bytes in plain words; none where nothing was read of it, or something that has none.
pub(super) fn clause(text: &str, read: &Read, at: &Range<usize>) -> Option<String> {
    let within = |own: &Range<usize>| at.start <= own.start && own.end <= at.end;
    let lines: Vec<&Line> = read.lines.iter().filter(|(_, own)| within(own)).map(|(line, _)| line).collect();
    let mut people: Vec<usize> = lines.iter().filter_map(|line| line.person()).collect();
    people.sort_unstable();
    people.dedup();
    let own = |who: usize| lines.iter().copied().filter(move |line| line.person() == Some(who)).collect::<Vec<_>>();
    let mut parts: Vec<String> = Vec::new();
    if let Some(first) = people.first() {
        let many = people.len() > 1;
        let does = phrases(read, *first, &own(*first), many)?;
        // Those of a clause do the same, or it is told in no one sentence.
        let same = |who: &usize| phrases(read, *who, &own(*who), many).as_ref() == Some(&does);
        if does.is_empty() || !people.iter().all(same) {
            return None;
        }
        parts.push(format!("{} {}", subject(text, read, &people, at.start)?, does.join(" and ")));
    }
    for line in lines.iter().filter(|line| line.person().is_none()) {
        match line {
            // Said already by whoever waits for it.
            Line::RobotSays(sign) if parts.iter().any(|part| part.ends_with(&format!("the robot says {sign}"))) => {}
            Line::RobotSays(sign) => parts.push(format!("the robot says {sign}")),
            Line::RobotGoal(class) => parts.push(format!("the robot drives to {}", the(*class))),
            Line::RobotStart(class) => parts.push(format!("the robot comes from {}", the(*class))),
            Line::Place(class) => match parts.last_mut() {
                Some(last) => last.push_str(&format!(" at {}", the(*class))),
                None => return None,
            },
            Line::Person(_)
            | Line::Relation(..)
            | Line::Side(_)
            | Line::Pace(_)
            | Line::Group(_)
            | Line::Twice(_)
            | Line::Step(..)
            | Line::RobotVia(_)
            | Line::RobotFirst(_)
            | Line::Before(..) => return None,
        }
    }
    (!parts.is_empty()).then(|| parts.join(", and "))
}

fn the(class: socrates_model::PlaceClass) -> String {
    format!("the {}", place::words(class))
}

/// The people that a clause tells of, by their role, `the nurse` where they were named before it.
fn subject(text: &str, read: &Read, people: &[usize], from: usize) -> Option<String> {
    let first = *people.first()?;
    let role = &read.story.people.get(first)?.role;
    let alike = |who: &usize| read.story.people.get(*who).is_some_and(|person| person.role == *role);
    let others = || (0..read.story.people.len()).filter(|who| alike(who) && !people.contains(who));
    let named = |who: usize| read.lines.iter().any(|(line, at)| line.person() == Some(who) && at.start < from);
    let known = people.iter().all(|who| named(*who));
    if !people.iter().all(alike) || known && others().next().is_some() || !known && people.iter().any(|who| named(*who))
    {
        return None;
    }
    let person = role == "people" || role == "person";
    let role = match (person, people.len() > 1) {
        (true, true) => "people".to_owned(),
        (true, false) => "person".to_owned(),
        (false, true) => format!("{role}s"),
        (false, false) => role.clone(),
    };
    let article = if known { "the" } else { "a" };
    let capital =
        text.get(..from).is_none_or(|before| before.trim_end().is_empty() || before.trim_end().ends_with('.'));
    let words = match people.len().checked_sub(2) {
        None if !known && role.starts_with(['a', 'e', 'i', 'o', 'u']) => format!("an {role}"),
        None => format!("{article} {role}"),
        Some(more) if known => format!("the {} {role}", NUMBERS.get(more)?),
        Some(more) => format!("{} {role}", NUMBERS.get(more)?),
    };
    let mut letters = words.chars();
    let first = letters.next()?;
    Some(if capital { format!("{}{}", first.to_uppercase(), letters.as_str()) } else { words })
}

/// What lines say that somebody does, a phrase each.
fn phrases(read: &Read, who: usize, lines: &[&Line], many: bool) -> Option<Vec<String>> {
    let person = read.story.people.get(who)?;
    let mut found = Vec::new();
    for line in lines {
        match line {
            Line::Relation(_, relation) => found.push(stands(*relation, many).to_owned()),
            Line::Step(_, number) => found.push(step(read, person.steps.get(*number)?, many)?),
            Line::Person(_) => {}
            Line::Group(_) if person.relation == Some(Relation::Static) => found.push(verb("talk in a group", many)),
            Line::Side(_)
            | Line::Pace(_)
            | Line::Group(_)
            | Line::Twice(_)
            | Line::Place(_)
            | Line::RobotStart(_)
            | Line::RobotGoal(_)
            | Line::RobotVia(_)
            | Line::RobotFirst(_)
            | Line::Before(..)
            | Line::RobotSays(_) => return None,
        }
    }
    found.dedup();
    Some(found)
}

fn stands(relation: Relation, many: bool) -> &'static str {
    match (relation, many) {
        (Relation::Frontal, false) => "comes towards the robot",
        (Relation::Frontal, true) => "come towards the robot",
        (Relation::Behind, false) => "comes from behind the robot",
        (Relation::Behind, true) => "come from behind the robot",
        (Relation::Ahead, false) => "walks ahead of the robot",
        (Relation::Ahead, true) => "walk ahead of the robot",
        (Relation::Crossing, false) => "crosses",
        (Relation::Crossing, true) => "cross",
        (Relation::Static, false) => "stands there",
        (Relation::Static, true) => "stand there",
        (Relation::Leaving, false) => "comes out",
        (Relation::Leaving, true) => "come out",
        (Relation::Staying, false) => "stays inside",
        (Relation::Staying, true) => "stay inside",
        (Relation::Abreast, false) => "walks beside the robot",
        (Relation::Abreast, true) => "walk beside the robot",
        (Relation::Aside, false) => "stands beside the robot's way",
        (Relation::Aside, true) => "stand beside the robot's way",
    }
}

/// A phrase whose first word is a verb, said of one or of several.
fn verb(phrase: &str, many: bool) -> String {
    let (first, rest) = phrase.split_once(' ').unwrap_or((phrase, ""));
    let ending = if many { "" } else { "s" };
    format!("{first}{ending} {rest}").trim_end().to_owned()
}

fn step(read: &Read, step: &Step, many: bool) -> Option<String> {
    if !step.until.is_empty() {
        return None;
    }
    let mut text = match (step.act, step.whom) {
        (Act::GiveWay, _) => verb("step aside", many),
        (Act::Block, _) => verb("block the robot", many),
        (Act::Look, _) => verb("look at the robot", many),
        (Act::Startle, _) => format!("{} startled by the robot", if many { "are" } else { "is" }),
        (Act::StandStill, _) => verb("stop", many),
        (Act::RunAway, _) => verb("run away", many),
        (Act::Approach, _) => verb("come up to the robot", many),
        (Act::Follow, None) => verb("follow the robot", many),
        (Act::Follow, Some(whom)) => verb(&format!("follow the {}", read.story.people.get(whom)?.role), many),
        (Act::Navigate, _) => verb("walk on", many),
        (Act::TurnBack, _) => verb("turn back", many),
        (Act::Sign, _) => verb(&format!("signal {}", step.says?), many),
    };
    if let Some(sign) = step.says.filter(|_| step.act != Act::Sign) {
        text.push_str(&format!(" and {}", verb(&format!("signal {sign}"), many)));
    }
    if let Some(secs) = step.for_s {
        text.push_str(&format!(" for {secs} s"));
    }
    for reason in &step.when {
        text.push_str(&format!(" {}", when(reason, many)?));
    }
    Some(text)
}

fn when(reason: &Reason<Vec<usize>>, many: bool) -> Option<String> {
    let sees = if many { "they see" } else { "seeing" };
    Some(match (reason.cue, reason.amount, &reason.who) {
        (Cue::Near | Cue::Visible, Some(m), None) => format!("when the robot is within {m} m"),
        (Cue::Near, None, None) => "when the robot is near".to_owned(),
        (Cue::Visible, None, None) if many => format!("when {sees} the robot"),
        (Cue::Visible, None, None) => format!("on {sees} the robot"),
        (Cue::Blocking, None, None) => "when the robot is in the way".to_owned(),
        (Cue::Moving, None, None) => "when the robot moves".to_owned(),
        (Cue::Stopped, None, None) => "when the robot stops".to_owned(),
        (Cue::Passed, None, None) => "when the robot has passed".to_owned(),
        (Cue::Says, None, None) => format!("when the robot says {}", reason.sign.unwrap_or(Gesture::ExcuseMe)),
        (Cue::After, Some(secs), None) => format!("after {secs} s"),
        _ => return None,
    })
}
