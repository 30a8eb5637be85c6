//! Where somebody faces who stands, as the words say it: `with her back to the robot`, `facing away`, `facing the robot`.

use socrates_model::proposal::Facing;
use socrates_model::{FactKind, Fault, HumanId, HumanProposal, Reading, Relation};

use crate::cast::Person;
use crate::clause::mark_each;
use crate::cut::Stretch;
use crate::negation::negated;
use crate::short;
use crate::story::{Story, Subject};

/// Takes where a clause says that somebody faces. The wall, a shelf or a window have no place of their own: those words stay unread.
pub(crate) fn note(
    story: &mut Story,
    subject: &Subject,
    stretch: &mut Stretch,
    meant: &[(usize, usize, Vec<usize>)],
    quote: &str,
) {
    let Some((facing, words)) = said(stretch) else { return };
    let Some(first) = words.first().copied() else { return };
    let denied = |k: usize| {
        stretch.words.get(k).is_some_and(|word| matches!(word.text.as_str(), "not" | "never" | "without" | "nor"))
    };
    if negated(stretch, first) || (0..first).any(denied) {
        let said: Vec<&str> =
            words.iter().filter_map(|k| stretch.words.get(*k)).map(|word| word.text.as_str()).collect();
        return short::unplayed(
            &mut story.problems,
            quote,
            &format!("not `{}`: where somebody does not face", said.join(" ")),
        );
    }
    let before = meant.iter().rev().find(|(from, _, some)| *from < first && !some.is_empty());
    let people = match (before, subject) {
        (Some((_, _, some)), _) => some.clone(),
        (None, Subject::People(people)) => people.clone(),
        (None, Subject::Robot | Subject::Nobody) => return,
    };
    for who in people {
        if let Some(person) = story.cast.people.get_mut(who) {
            person.facing.get_or_insert_with(|| (facing.clone(), quote.to_owned()));
        }
    }
    mark_each(stretch, &words);
}

/// The first words of a clause that say where somebody faces.
fn said(stretch: &Stretch) -> Option<(Facing, Vec<usize>)> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let robot = |from: usize| {
        let at = if matches!(text(from), "the" | "our") { from + 1 } else { from };
        stretch.words.get(at).is_some_and(|word| word.stem == "robot").then_some(at)
    };
    (0..stretch.words.len()).find_map(|at| {
        // `facing away (from the robot)`, `faces the robot`
        if matches!(text(at), "facing" | "faces" | "face" | "faced") {
            if text(at + 1) == "away" {
                let from = (text(at + 2) == "from").then(|| robot(at + 3)).flatten();
                let other = text(at + 2) == "from" && from.is_none();
                return (!other).then(|| (Facing::Away, (at..=from.unwrap_or(at + 1)).collect()));
            }
            let to = at + 1 + usize::from(matches!(text(at + 1), "towards" | "toward"));
            return robot(to).map(|to| (Facing::Robot, (at..=to).collect()));
        }
        // `with their backs to the robot`, `her back turned to it`
        if !matches!(text(at), "back" | "backs")
            || !matches!(text(at.checked_sub(1)?), "his" | "her" | "their" | "its" | "the" | "a")
        {
            return None;
        }
        let turned = at + 1 + usize::from(text(at + 1) == "turned");
        let to = matches!(text(turned), "to" | "towards" | "toward").then(|| robot(turned + 1)).flatten()?;
        let with = at.checked_sub(2).filter(|k| text(*k) == "with").unwrap_or(at - 1);
        Some((Facing::Away, (with..=to).collect()))
    })
}

/// The fact of where somebody faces, if they stand alone.
pub(crate) fn fact(
    human: HumanId,
    relation: Option<Relation>,
    person: &Person,
    problems: &mut Vec<Fault>,
) -> Option<(String, FactKind)> {
    let (facing, quote) = person.facing.as_ref()?;
    let stands = relation.is_some_and(Relation::stands);
    if !stands || person.group.is_some() {
        short::unplayed(problems, quote, "where somebody faces who walks, or stands in a group,");
        return None;
    }
    Some((quote.clone(), FactKind::Facing { human, facing: facing.clone() }))
}

/// Where somebody faces, for the reading line; nothing for another fact.
pub(crate) fn words(kind: &FactKind) -> String {
    if let FactKind::Facing { facing, .. } = kind { format!("faces {}", facing.phrase()) } else { String::new() }
}

/// The people of a proposal with where they face, as the reading states it.
pub(crate) fn stated(mut humans: Vec<HumanProposal>, reading: &Reading) -> Vec<HumanProposal> {
    for fact in &reading.facts {
        let FactKind::Facing { human, facing } = &fact.kind else { continue };
        let Some(found) = humans.iter_mut().find(|other| other.id == *human) else { continue };
        found.facing = Some(facing.clone());
        // What somebody does names no nodes and nobody else.
        let to = match facing {
            Facing::Node(_) => "a place".to_owned(),
            Facing::Human(_) => "somebody".to_owned(),
            Facing::Robot | Facing::Away | Facing::Left | Facing::Right => facing.phrase(),
        };
        found.behavior.push_str(&format!(" They face {to} at first."));
    }
    humans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    fn read(text: &str) -> Vec<(u32, Facing)> {
        let reading = crate::read(&request("Deliver mail to the meeting room", Some(text)), &map("office"));
        let facing = |kind: FactKind| {
            if let FactKind::Facing { human, facing } = kind { Some((human.number(), facing)) } else { None }
        };
        reading.facts.into_iter().filter_map(|fact| facing(fact.kind)).collect()
    }

    #[test]
    fn where_somebody_faces_is_read_where_it_can_be_played() {
        for (text, wanted) in [
            ("A woman stands in the corridor with her back to the robot.", &[(1, Facing::Away)][..]),
            ("An employee stands in the corridor, facing away from the robot.", &[(1, Facing::Away)]),
            ("An employee stands in the corridor facing the robot.", &[(1, Facing::Robot)]),
            ("An employee stands in the corridor facing the wall.", &[]),
            ("An employee stands in the corridor and looks out of the window.", &[]),
            ("An employee stands in the corridor, not facing the robot.", &[]),
        ] {
            assert_eq!(read(text), wanted, "{text}");
        }
    }
}
