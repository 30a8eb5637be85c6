//! Does a proposal repeat an earlier one of its library?

use std::collections::BTreeSet;

use socrates_model::{Fault, FaultCode, PlaceClass, Proposal, Relation, ScenarioId};

/// Two proposals of the same signature whose words have more than this in common repeat each other.
const ALIKE: f64 = 0.9;

/// What makes two scenarios the same kind of scenario: pattern, place, and how everybody stands to the robot's way.
pub type Signature = (String, PlaceClass, Vec<Relation>);

/// What of a proposal is compared: taken once, however many it is compared with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Likeness {
    /// Its kind.
    pub signature: Signature,
    words: BTreeSet<String>,
}

impl Likeness {
    /// The likeness of a proposal.
    #[must_use]
    pub fn of(proposal: &Proposal) -> Self {
        let mut relations: Vec<Relation> = proposal.humans.iter().map(|human| human.relation).collect();
        relations.sort_unstable();
        Self { signature: (proposal.pattern.clone(), proposal.place, relations), words: words(&proposal.description) }
    }
}

/// P-DUP, a warning, where a proposal repeats the one of the scenario `id`: the same [`Signature`], and more than nine tenths of
/// the words of both descriptions in common (Jaccard index over lower-case words).
#[must_use]
pub fn check_repeats(proposal: &Likeness, id: &ScenarioId, earlier: &Likeness) -> Option<Fault> {
    if proposal.signature != earlier.signature {
        return None;
    }
    let (new, old) = (&proposal.words, &earlier.words);
    #[expect(clippy::cast_precision_loss, reason = "words of a description")]
    let (both, any) = (new.intersection(old).count() as f64, new.union(old).count() as f64);
    if any == 0.0 || both <= ALIKE * any {
        return None;
    }
    let message = format!(
        "repeats the scenario `{id}`: {:.0} % of the words are the same, and so are pattern, place and relations; choose another \
         pattern, place or number of humans",
        100.0 * both / any
    );
    Some(Fault::new(FaultCode::PDup, "description", message))
}

fn words(text: &str) -> BTreeSet<String> {
    let parts = text.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    parts.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::crossing_proposal;

    #[test]
    fn the_same_again_is_a_repetition_and_another_place_or_story_is_none() {
        let id = ScenarioId::new("first").unwrap();
        let first = crossing_proposal();
        let check_repeats = |new: &Proposal, id: &ScenarioId, earlier: &Proposal| {
            check_repeats(&Likeness::of(new), id, &Likeness::of(earlier))
        };
        let fault = check_repeats(&first, &id, &first).unwrap();
        assert_eq!(fault.code, FaultCode::PDup);
        assert!(fault.is_soft() && fault.message.to_string().contains("`first`: 100 %"), "{fault}");
        let mut elsewhere = first.clone();
        elsewhere.place = if first.place == PlaceClass::Room { PlaceClass::Corridor } else { PlaceClass::Room };
        assert_eq!(check_repeats(&elsewhere, &id, &first), None);
        let mut other = first.clone();
        other
            .description
            .push_str(" An entirely different story with many other words follows here and goes on and on.");
        assert_eq!(check_repeats(&other, &id, &first), None);
        let mut empty = first.clone();
        empty.description.clear();
        assert_eq!(check_repeats(&empty, &id, &empty), None, "nothing repeats nothing");
    }
}
