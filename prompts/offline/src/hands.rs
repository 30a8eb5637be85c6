//! What people do with their hands to a robot and to things, which nobody can play.

use crate::lexicon::lexicon;
use crate::words::Word;

/// `pours coffee over it`
pub(crate) fn pours(words: &[Word], at: usize) -> bool {
    words.get(at).is_some_and(|word| matches!(word.stem.as_str(), "pour" | "spill"))
        && (at + 1..at + 5).any(|k| {
            words
                .get(k)
                .is_some_and(|word| lexicon().things.contains(&word.stem) || lexicon().goods.contains(&word.text))
        })
}

/// `takes a box from its tray`, `puts her cup down on its lid`
pub(crate) fn handles(words: &[Word], at: usize) -> bool {
    let lex = lexicon();
    let handles = words.get(at).is_some_and(|word| {
        matches!(
            word.stem.as_str(),
            "take"
                | "put"
                | "place"
                | "set"
                | "lay"
                | "load"
                | "drop"
                | "stick"
                | "balance"
                | "dump"
                | "stuff"
                | "hand"
        )
    });
    let object =
        |k: &usize| words.get(*k).is_some_and(|word| lex.goods.contains(&word.stem) || lex.goods.contains(&word.text));
    let open = |k: &usize| {
        words.get(*k).is_some_and(|word| {
            !matches!(word.text.as_str(), "to" | "from" | "on" | "in" | "at" | "and") && word.stem != "robot"
        })
    };
    // `takes a coffee break`
    let compound = |k: usize| words.get(k).is_some_and(|word| matches!(word.stem.as_str(), "break" | "note" | "order"));
    // `sticks a smiley on its screen`
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let sticks = words.get(at).is_some_and(|word| {
        matches!(
            word.stem.as_str(),
            "put" | "stick" | "hang" | "attach" | "lay" | "balance" | "draw" | "paint" | "write" | "throw" | "drape"
        )
    }) && matches!(text(at + 1), "a" | "an" | "his" | "her" | "the" | "some" | "their")
        && !matches!(text(at + 2), "hand" | "hands" | "eyes" | "eye" | "foot" | "palm")
        && (at + 2..at + 8).any(|k| {
            matches!(text(k), "on" | "onto" | "into" | "under" | "over" | "around")
                && (k + 1..k + 3).any(|k| words.get(k).is_some_and(|word| word.stem == "robot"))
        });
    if sticks {
        return true;
    }
    // `sets off for the dock`
    let leaves =
        matches!(text(at + 1), "off" | "out" | "up" | "forth") && matches!(text(at), "sets" | "set" | "takes" | "take");
    handles && !leaves && (at + 1..at + 6).take_while(open).find(object).is_some_and(|k| !compound(k + 1))
}

/// `hops onto the robot`, `gets on top of it`
pub(crate) fn mounts(words: &[Word], at: usize) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let jumps = words.get(at).is_some_and(|word| {
        matches!(
            word.stem.as_str(),
            "hop" | "jump" | "leap" | "step" | "get" | "climb" | "sit" | "stand" | "lean" | "ride"
        )
    });
    let onto = matches!(text(at + 1), "onto" | "on" | "upon" | "atop");
    let top = usize::from(matches!(text(at + 2), "top")) * 2;
    let to = at + 2 + top + usize::from(text(at + 2 + top) == "the");
    // `on its left` is beside it.
    jumps && onto && words.get(to).is_some_and(|word| word.stem == "robot" && word.text != "its")
}

/// `takes it away`, `took the child aside`.
pub(crate) fn takes_along(words: &[Word], at: usize) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let object = match text(at + 1) {
        "it" | "him" | "her" | "them" if matches!(text(at + 2), "away" | "along" | "aside" | "home" | "with") => 1,
        "the" | "his" | "her" | "their" | "its" => 2,
        _ => return false,
    };
    words.get(at).is_some_and(|word| word.stem == "take")
        && matches!(text(at + object + 1), "away" | "along" | "aside" | "home" | "with")
}
