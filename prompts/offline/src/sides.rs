//! Sides of the robot's way, as the words say them: `from the left`, `on the right side of the corridor`, `on its left`.

use socrates_model::{Action, FactKind, Fault, FaultCode, HumanId, HumanProposal, Reading, Relation, Side};

use crate::cast::{Person, ReadRule};
use crate::clause::{Found, mark_each};
use crate::cut::Stretch;
use crate::lexicon::lexicon;
use crate::negation::negated;
use crate::short;
use crate::story::{Story, Subject};

/// A side with the words that say it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Said {
    side: Side,
    words: Vec<usize>,
}

/// Words before a side.
const AT: &[&str] = &["from", "on", "to", "at", "by", "along"];
/// Words before a side that is the robot's, or nobody's own.
const WHOSE: &[&str] = &["the", "its"];
/// What has sides as the robot drives along it.
const SIDED: &[&str] =
    &["it", "corridor", "hallway", "hall", "aisle", "passage", "passageway", "way", "path", "route", "lane", "walkway"];
/// Acts of somebody who is where the words say.
const STANDS: &[&str] = &["stand", "wait", "sit", "remain", "be", "chat", "talk", "lean"];
/// Words that deny what stands after them in a clause.
const DENIES: &[&str] = &["not", "never", "neither", "nor", "without", "no", "cannot", "instead", "rather"];
/// Acts by which somebody goes to their own left or right.
const TURNS: &[&str] = &[
    "turn", "step", "move", "go", "walk", "look", "dodge", "swerve", "glance", "veer", "shift", "point", "keep", "lean",
];

/// Takes the side that a clause says of somebody. What is ruled out is said not to be played; a side of anything else stays unread.
pub(crate) fn note(
    story: &mut Story,
    subject: &Subject,
    stretch: &mut Stretch,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    quote: &str,
) {
    let Some(said) = said(stretch) else { return };
    let Some(first) = said.words.first().copied() else { return };
    // Before a side any denial may be one of it: `does not come from the left`.
    let denied = |k: usize| stretch.words.get(k).is_some_and(|word| DENIES.contains(&word.text.as_str()));
    if negated(stretch, first) || (0..first).any(denied) {
        let words: Vec<&str> =
            said.words.iter().filter_map(|k| stretch.words.get(*k)).map(|word| word.text.as_str()).collect();
        let what = format!("not `{}`: a side that is ruled out", words.join(" "));
        return short::unplayed(&mut story.problems, quote, &what);
    }
    let before = meant.iter().rev().find(|(from, _, some)| *from < first && !some.is_empty());
    // `the robot passes a visitor on the left`: whose left is open.
    let by_robot = found.robots.iter().any(|robot| *robot < before.map_or(first, |(from, _, _)| *from))
        && found.deeds.first().is_some_and(|deed| deed.at < first)
        && meant.iter().all(|(from, _, _)| found.robots.first().is_some_and(|robot| robot < from))
        && !stretch.words.iter().any(|word| matches!(word.text.as_str(), "from" | "coming"));
    if by_robot {
        return;
    }
    let people = match (before, subject) {
        (Some((_, _, some)), _) => some.clone(),
        (None, Subject::People(people)) if meant.is_empty() => people.clone(),
        (None, Subject::People(_) | Subject::Robot | Subject::Nobody) => {
            meant.iter().find(|(_, _, some)| !some.is_empty()).map(|(_, _, some)| some.clone()).unwrap_or_default()
        }
    };
    if people.is_empty() {
        return;
    }
    for who in people {
        let Some(person) = story.cast.people.get_mut(who) else { continue };
        match &person.side {
            None => person.side = Some((said.side, quote.to_owned())),
            Some((side, _)) if *side == said.side => {}
            Some((_, first)) => {
                let message =
                    format!("`{first}` and `{quote}` cannot both hold for the same human; correct one of the two");
                story.problems.push(Fault::new(FaultCode::PContra, crate::order::agent(who), message));
            }
        }
    }
    mark_each(stretch, &said.words);
}

/// The first side of the robot's way that a clause says.
fn said(stretch: &Stretch) -> Option<Said> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    let side = |k: usize| match text(k) {
        "left" | "lefthand" => Some(Side::Left),
        "right" | "righthand" => Some(Side::Right),
        _ => None,
    };
    for at in 0..stretch.words.len() {
        let Some(found) = side(at) else { continue };
        let label = stretch.words.get(at).is_some_and(|word| word.label);
        // `from left to right`: where they come from.
        if text(at + 1) == "to" && side(at + 2).is_some_and(|other| other != found) {
            let from = at.checked_sub(1).filter(|k| text(*k) == "from").unwrap_or(at);
            return Some(Said { side: found, words: (from..=at + 2).collect() });
        }
        let Some(whose) = at.checked_sub(1).filter(|_| !label) else { continue };
        if !WHOSE.contains(&text(whose)) && stem(whose) != "robot" {
            continue;
        }
        let article = |k: usize| text(k) == "the" && stem(whose) == "robot";
        let before = whose.checked_sub(1).filter(|k| !article(*k)).or_else(|| whose.checked_sub(2));
        let Some(prep) = before.filter(|k| AT.contains(&text(*k))) else { continue };
        if text(prep) == "to" && (1..=2).filter_map(|back| prep.checked_sub(back)).any(|k| TURNS.contains(&stem(k))) {
            continue;
        }
        // `gives way to the left` goes there; `stands to the left` is there.
        let stands = || (0..prep).any(|k| STANDS.contains(&stem(k)));
        let open = text(prep) == "to" && text(whose) == "the" && !stands();
        let mut to = at;
        for word in ["hand", "side"] {
            if text(to + 1) == word {
                to += 1;
            }
        }
        let next = to + 1;
        if matches!(text(next), "of" | "from") {
            // `of the corridor`, `of it`: what has sides as the robot drives along it; of a table: its own.
            let what =
                (next + 1..next + 4).find(|k| !matches!(text(*k), "the" | "its" | "this" | "that" | "main" | "long"));
            let Some(what) = what.filter(|k| SIDED.contains(&text(*k)) || stem(*k) == "robot") else { continue };
            return Some(Said { side: found, words: (prep..=to).chain([next]).chain(what..=what).collect() });
        }
        // `the left door`, `the right moment`
        let free = !open
            && (text(next).is_empty()
                || lexicon().stop.contains(text(next))
                || lexicon().verbs.contains(stem(next))
                || stem(next) == "robot");
        if free {
            return Some(Said { side: found, words: (prep..=to).collect() });
        }
    }
    None
}

/// The fact of somebody's side, if they can be on one.
pub(crate) fn fact(
    human: HumanId,
    relation: Option<Relation>,
    person: &Person,
    problems: &mut Vec<Fault>,
) -> Option<(String, FactKind)> {
    let (side, quote) = person.side.as_ref()?;
    let follows = |read: &ReadRule| matches!(read.rule.act, Action::FollowRobot | Action::FollowHuman(_));
    if relation == Some(Relation::Staying) || person.rules.iter().any(follows) {
        short::unplayed(problems, quote, "on which side of the robot's way somebody is who follows or stays inside");
        return None;
    }
    Some((quote.clone(), FactKind::Side { human, side: *side }))
}

/// A side for the reading line: `crosses, from the left`.
pub(crate) fn words(relation: Option<Relation>, side: Side) -> String {
    let comes = matches!(relation, Some(Relation::Crossing | Relation::Leaving));
    format!("{} the {}", if comes { "from" } else { "on" }, side.name())
}

/// The people of a proposal with the sides that the reading states.
pub(crate) fn stated(mut humans: Vec<HumanProposal>, reading: &Reading) -> Vec<HumanProposal> {
    for fact in &reading.facts {
        let FactKind::Side { human, side } = fact.kind else { continue };
        let Some(found) = humans.iter_mut().find(|other| other.id == human) else { continue };
        found.side = Some(side);
        let doing = match found.relation {
            Relation::Crossing => "come from",
            Relation::Leaving => "come out on",
            Relation::Static | Relation::Aside => "stand on",
            Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast => "walk on",
            Relation::Staying => continue,
        };
        found.behavior.push_str(&format!(" They {doing} the {} of the robot's way.", side.name()));
    }
    humans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    /// The sides of a text, by human, and whether anything of it is said not to be played.
    fn read(text: &str) -> (Vec<(u32, Side)>, Reading) {
        let reading = crate::read(&request("Deliver mail to the meeting room", Some(text)), &map("office"));
        let side = |kind: &FactKind| {
            if let FactKind::Side { human, side } = kind { Some((human.number(), *side)) } else { None }
        };
        (reading.facts.iter().filter_map(|fact| side(&fact.kind)).collect(), reading)
    }

    #[test]
    fn a_side_of_the_robots_way_is_read() {
        use Side::{Left, Right};
        for (text, wanted) in [
            ("A visitor crosses the intersection from the left.", &[(1, Left)][..]),
            ("A visitor crosses from right to left.", &[(1, Right)]),
            ("An employee stands on the right side of the corridor.", &[(1, Right)]),
            ("An employee stands to the robot's left.", &[(1, Left)]),
            ("A courier overtakes the robot on its left.", &[(1, Left)]),
            ("A woman comes out of a room on the right-hand side.", &[(1, Right)]),
            ("A visitor crosses from the left and an employee crosses from the right.", &[(1, Left), (2, Right)]),
            ("Two visitors cross from the robot's right.", &[(1, Right), (2, Right)]),
        ] {
            let (found, reading) = read(text);
            assert_eq!(found, wanted, "{text}");
            let loose = crate::tests::loose(&reading);
            assert!(!loose.iter().any(|word| word == "left" || word == "right"), "{text}: {loose:?}");
        }
    }

    #[test]
    fn what_is_no_side_of_the_robots_way_is_not_read_as_one() {
        for text in [
            "A visitor left the meeting room.",
            "A nurse stands in the corridor with a cup on her left.",
            "A visitor walks towards the robot and turns to the left.",
            "An employee stands to the left of the table.",
            "A visitor comes towards the robot right in front of it.",
            "An employee stands at the left door.",
        ] {
            assert_eq!(read(text).0, [], "{text}");
        }
    }

    #[test]
    fn a_side_that_is_ruled_out_is_no_side_and_is_said() {
        for text in ["A visitor crosses, but not from the left.", "A visitor does not cross from the left."] {
            let (found, reading) = read(text);
            assert_eq!(found, [], "{text}");
            let said = reading.problems.iter().any(|fault| fault.message.to_string().contains("left"))
                || reading.notes.iter().any(|note| note.contains("left"))
                || crate::tests::loose(&reading).iter().any(|word| word == "left");
            assert!(said, "{text}: {:?} {:?}", reading.problems, reading.notes);
        }
    }
}
