//! Where people face at first, as facts and in words.

use socrates_model::proposal::Facing;
use socrates_model::{FactKind, Fault, HumanId, HumanProposal, Reading, Relation};

use crate::story::Person;
use crate::told::unplayed;

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
        unplayed(problems, quote, "where somebody faces who walks, or stands in a group,");
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
