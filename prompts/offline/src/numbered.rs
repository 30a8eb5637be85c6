//! People by number or letter: `human 2`, `worker number 6`, `person A`, `B follows A`.

use crate::lexicon::Lexicon;
use crate::noun::noun;
use crate::words::Word;

/// The number of whoever is named so here, where a word for people stands with it, and the last word.
pub(crate) fn numbered(words: &[Word], at: usize, lex: &Lexicon) -> Option<(u32, Option<usize>, usize)> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| words.get(k).map_or("", |word| word.stem.as_str());
    // `number five does not`
    if text(at) == "number"
        && let Some(number) = words.get(at + 1).and_then(Word::count).filter(|n| *n > 0)
        && words.get(at + 2).is_none_or(|word| lex.verbs.contains(&word.stem))
    {
        return Some((number, None, at + 1));
    }
    // `worker number 6`
    if lex.roles.contains_key(stem(at))
        && matches!(text(at + 1), "number" | "no" | "nr")
        && let Some(number) = words.get(at + 2).filter(|word| word.is_digits()).and_then(Word::count)
    {
        return Some((number, Some(at), at + 2));
    }
    if lex.roles.contains_key(stem(at))
        && !text(at).ends_with("ple")
        && let Some(number) = words.get(at + 1).filter(|word| word.is_digits()).and_then(Word::count)
    {
        // `human 2`, `person_1`; a number with a noun of its own belongs to that one.
        // `human 1 signals human 2 …`: a verb, no noun that describes whom it is done to.
        let does = words.get(at + 2).is_some_and(|word| lex.verbs.contains(&word.stem) && word.text.ends_with('s'));
        if does || noun(words, at + 2, lex).is_none() {
            return Some((number, Some(at), at + 1));
        }
    }
    // `H1 gives way`
    let numbered = words
        .get(at)
        .filter(|word| word.capital && word.text.len() == 2)
        .and_then(|word| word.text.strip_prefix(['h', 'p']).and_then(|digit| digit.parse::<u32>().ok()));
    if let Some(number) = numbered.filter(|number| *number > 0) {
        return Some((number, None, at));
    }
    // `person A`, `pedestrian B`; alone only where it cannot be an article.
    let letter = |k: usize| {
        // `lift B` is a lift.
        if k.checked_sub(1).and_then(|k| words.get(k)).is_some_and(|word| lex.labels.contains(&word.text)) {
            return None;
        }
        let word = words.get(k).filter(|word| word.capital && word.text.len() == 1)?;
        "abcdef".find(word.text.as_str()).and_then(|place| u32::try_from(place + 1).ok())
    };
    if lex.roles.contains_key(stem(at))
        && let Some(number) = letter(at + 1)
    {
        return Some((number, Some(at), at + 1));
    }
    let acts = |k: usize| words.get(k).is_some_and(|word| lex.verbs.contains(&word.stem));
    // `A walks off`: no article stands before such a verb.
    let finite = words.get(at + 1).is_some_and(|next| {
        next.text.ends_with('s')
            && next.text != next.stem
            && !lex.roles.contains_key(&next.stem)
            && !lex.things.contains(&next.stem)
    });
    // `B follows A`
    let last = at + 1 == words.len() && at > 0 && acts(at - 1);
    if letter(at) == Some(1) && (finite && acts(at + 1) || last) {
        return Some((1, None, at));
    }
    if let Some(number) =
        letter(at).filter(|number| *number > 1 && (acts(at + 1) || at + 1 == words.len() && (0..at).any(acts)))
    {
        return Some((number, None, at));
    }
    None
}
