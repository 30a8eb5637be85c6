//! Does a scenario repeat an earlier one of its library?

use socrates_model::likeness::{ELSEWHERE_M, LATER_S, Likeness};
use socrates_model::{Fault, FaultCode, ScenarioId};

/// P-DUP, a warning, where a scenario repeats the one of this id: [`Likeness::repeats`] says what makes a difference.
#[must_use]
pub fn check_repeats(scenario: &Likeness, id: &ScenarioId, earlier: &Likeness) -> Option<Fault> {
    if !scenario.repeats(earlier) {
        return None;
    }
    let message = format!(
        "repeats the scenario `{id}`: the same people come from the same sides and do the same in the same order, each place is \
         within {ELSEWHERE_M} m of its own, each trigger within {LATER_S} s; choose another place, start, goal, side or number of humans"
    );
    Some(Fault::new(FaultCode::PDup, "description", message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{crossing_paths, crossing_proposal, plus_map};

    #[test]
    fn the_same_again_in_other_words_is_a_repetition_and_another_number_of_people_is_none() {
        let id = ScenarioId::new("first").unwrap();
        let (first, paths, map) = (crossing_proposal(), crossing_paths(), plus_map());
        let earlier = Likeness::of(&first, &paths, &map);
        let mut words = first.clone();
        words.description = "The same, told in entirely other words.".into();
        let fault = check_repeats(&Likeness::of(&words, &paths, &map), &id, &earlier).unwrap();
        assert_eq!(fault.code, FaultCode::PDup);
        assert!(fault.is_soft() && fault.message.to_string().contains("`first`"), "{fault}");
        let mut fewer = first;
        fewer.humans.pop();
        assert_eq!(check_repeats(&Likeness::of(&fewer, &paths, &map), &id, &earlier), None);
    }
}
