//! What is said not to be done.

use crate::cut::{Joint, Stretch};
use crate::lexicon::lexicon;
use crate::words::Word;

/// Whether the deed at this word of a clause is said not to be done.
pub(crate) fn negated(stretch: &Stretch, at: usize) -> bool {
    let before =
        |back: usize| at.checked_sub(back).and_then(|i| stretch.words.get(i)).map_or("", |word| word.text.as_str());
    // `will not stop looking` looks on.
    if before(1) == "stop" && matches!(before(2), "not" | "never") {
        return false;
    }
    // `never turns round to look`, `does not want to move`
    let to = before(1) == "to"
        && (2..=5).any(|back| matches!(before(back), "not" | "never"))
        && !(2..=5)
            .take_while(|back| !matches!(before(*back), "not" | "never"))
            .any(|back| before(back) == "robot" || before(back) == "until");
    if to {
        return true;
    }
    // `…, nor does he give way`
    if at > 0 && stretch.words.first().is_some_and(|word| word.text == "nor") {
        return true;
    }
    // `no looking`, `no yield`, `any gaze`
    if before(1) == "no"
        || before(1) == "any" && (2..=4).any(|back| matches!(before(back), "not" | "without" | "never"))
    {
        return true;
    }
    // `without stopping or looking`, `do not step aside or stop`
    if matches!(before(1), "or" | "nor")
        && (0..at).any(|i| {
            stretch.words.get(i).is_some_and(|word| matches!(word.text.as_str(), "without" | "not" | "never" | "no"))
        })
    {
        return true;
    }
    // `never so much as glances`, `not even once looks`
    let reach = (1..=6)
        .find(|back| {
            !matches!(
                before(*back),
                "so" | "much"
                    | "as"
                    | "a"
                    | "even"
                    | "once"
                    | "really"
                    | "ever"
                    | "at"
                    | "all"
                    | "to"
                    | "actually"
                    | "simply"
                    | "any"
                    | "exhibit"
                    | "show"
            )
        })
        .unwrap_or(1);
    (1..=2).chain([reach]).any(|back| {
        matches!(before(back), "not" | "never" | "without" | "cannot" | "refuses" | "refuse" | "fails" | "fail" | "nor")
            || before(back) == "of" && before(back + 1) == "instead"
            || before(back) == "than" && before(back + 1) == "rather"
    }) || (0..at).any(|i| stretch.words.get(i).is_some_and(|word| matches!(word.text.as_str(), "neither" | "none")))
        // `at no point does she look`
        || (0..at).any(|i| {
            let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
            text(i) == "no"
                && matches!(text(i + 1), "one" | "point" | "time" | "moment" | "circumstances" | "way" | "case")
        })
}

/// `no reaction: no looking, getting out of the way`, `without yielding, stopping or looking`: each of a list is denied.
pub(crate) fn denied(found: &mut [Stretch]) {
    for at in 1..found.len() {
        let denies = |word: &Word| matches!(word.text.as_str(), "without" | "no");
        if denied_on(found, at) {
            continue;
        }
        let before = found.get(at - 1).and_then(|before| {
            let deny = before.words.iter().position(denies)?;
            // Nothing else is said behind the word that denies: a list goes on.
            let verbs = before.words.iter().skip(deny + 1);
            let list =
                verbs.filter(|word| lexicon().verbs.contains(&word.stem) && !word.text.ends_with("ing")).count() == 0;
            before.words.get(deny).cloned().filter(|_| list)
        });
        let Some(deny) = before else { continue };
        let Some(stretch) = found.get_mut(at) else { continue };
        let participle = stretch.words.first().is_some_and(|word| {
            word.text.ends_with("ing") && word.text != word.stem && lexicon().verbs.contains(&word.stem)
        });
        let or = stretch.words.first().is_some_and(|word| matches!(word.text.as_str(), "or" | "nor"));
        if matches!(stretch.joint, Joint::Comma | Joint::And) && (participle || or) {
            let at = usize::from(or);
            let without = Word { text: "without".to_owned(), stem: "without".to_owned(), used: true, ..deny };
            stretch.words.insert(at, without);
        }
    }
}

/// `must not stop and stare`: the second verb is denied as the first is.
fn denied_on(found: &mut [Stretch], at: usize) -> bool {
    let not = found.get(at - 1).and_then(|before| {
        let not = before.words.iter().position(|word| word.text == "not")?;
        let is_verb = |word: &Word| word.text == word.stem && lexicon().verbs.contains(&word.stem);
        before.words.get(not).cloned().filter(|_| before.words.iter().skip(not + 1).any(is_verb))
    });
    let base = |stretch: &&mut Stretch| {
        stretch.joint == Joint::And
            && stretch.words.first().is_some_and(|word| {
                matches!(word.text.as_str(), "stare" | "look" | "watch" | "block" | "follow" | "stop" | "wait" | "wave")
            })
    };
    match (not, found.get_mut(at).filter(base)) {
        (Some(not), Some(stretch)) => {
            stretch.words.insert(0, not);
            true
        }
        _ => false,
    }
}
