//! Where a clause of its own begins without a word that joins it to the one before.

use crate::cut::{Joint, Stretch};
use crate::lexicon::lexicon;
use crate::mention::mentions;
use crate::words::Word;

/// Whether the verb of the sentence stands here, behind a relative clause that has its own.
fn main_verb(words: &[Option<Word>], (i, from): (usize, usize), open: &Stretch) -> bool {
    let verbs = &lexicon().verbs;
    let finite = |word: &Word| word.text != word.stem && word.text.ends_with('s') && verbs.contains(&word.stem);
    let own = |word: &Word| finite(word) || matches!(word.text.as_str(), "is" | "was" | "has");
    let before = from.checked_sub(1).and_then(|k| words.get(k)).and_then(Option::as_ref);
    // `the one who blocks it | gives way`
    let verb =
        open.words.len().checked_sub(2).and_then(|k| open.words.get(k)).is_some_and(|word| verbs.contains(&word.stem));
    let object = before.is_some_and(|word| word.text == "it") && verb;
    let joins = !object
        && before.is_none_or(|word| {
            verbs.contains(&word.stem) && word.text != word.stem
                || matches!(
                    word.text.as_str(),
                    "and"
                        | "or"
                        | "nor"
                        | "neither"
                        | "not"
                        | "never"
                        | "the"
                        | "a"
                        | "an"
                        | "its"
                        | "his"
                        | "her"
                        | "their"
                        | "who"
                        | "of"
                        | "to"
                        | "that"
                        | "which"
                        | "also"
                        | "then"
                        | "it"
                )
                || word.text.ends_with("ly")
                || word.number().is_some()
        });
    // `the one who crosses pauses`
    let alone = matches!(open.words.as_slice(), [only] if finite(only)) && i == from;
    words.get(i).and_then(Option::as_ref).is_some_and(finite)
        && (!joins || alone)
        && (open.words.len() >= 2 || alone)
        && open.words.iter().take(3).any(own)
}

/// Whether a clause of its own begins at a word without a joint: `as soon as she sees the robot | she signals`.
pub(crate) fn begins(words: &[Option<Word>], i: usize, open: &Stretch) -> bool {
    let lex = lexicon();
    let word = |k: usize| words.get(k).and_then(Option::as_ref);
    let text = |k: usize| word(k).map_or("", |word| word.text.as_str());
    let temporal = matches!(open.joint, Joint::When | Joint::Until | Joint::While);
    let acts = open.words.iter().skip(1).any(|word| lex.verbs.contains(&word.stem));
    if open.words.is_empty() || !(acts || temporal && open.words.len() > 1) {
        return false;
    }
    let before = if i == 0 { "" } else { text(i - 1) };
    // `on seeing the robot | halts`: who sees is who halts.
    let sees = temporal && open.words.first().is_some_and(|word| word.text.ends_with("ing"));
    if sees
        && matches!(before, "robot" | "it" | "him" | "her" | "this" | "that")
        && word(i)
            .is_some_and(|word| word.text != word.stem && word.text.ends_with('s') && lex.verbs.contains(&word.stem))
    {
        return true;
    }
    // `when it blocks her way, a cleaner who is coming along | stops`
    let adverb = text(i).len() > 4 && text(i).ends_with("ly") && i > 0;
    if open.joint == Joint::Who && (main_verb(words, (i, i), open) || adverb && main_verb(words, (i + 1, i), open)) {
        return true;
    }
    // `when it is two metres away Marta tells Tom to wait`
    let named = temporal
        && word(i).is_some_and(|word| word.name)
        && word(i + 1)
            .is_some_and(|word| word.text != word.stem && word.text.ends_with('s') && lex.verbs.contains(&word.stem));
    if named && !matches!(before, "and" | "or" | "of" | "to" | "with" | "by" | "mr" | "mrs" | "dr" | "that") {
        return true;
    }
    match text(i) {
        "he" | "she" | "they" => !matches!(
            before,
            "where"
                | "wherever"
                | "what"
                | "how"
                | "that"
                | "than"
                | "as"
                | "who"
                | "whom"
                | "which"
                | "whether"
                | "does"
                | "do"
                | "did"
                | "should"
                | "would"
                | "will"
                | "can"
                | "could"
                | "may"
                | "must"
                | "point"
        ),
        "there" => temporal && matches!(text(i + 1), "is" | "are"),
        "does" | "do" | "did" => {
            (matches!(text(i + 1), "he" | "she" | "they")
                || temporal && matches!(text(i + 1), "one" | "both" | "all" | "each" | "the"))
                && !matches!(before, "nor" | "neither")
                && !matches!(before, "point" | "time" | "moment" | "circumstances")
        }
        "both" | "the" | "a" | "an" | "one" | "another" | "each" | "all" | "two" | "three"
            if temporal && text(i + 1) != "times" =>
        {
            let closes = matches!(
                before,
                "robot"
                    | "it"
                    | "him"
                    | "her"
                    | "them"
                    | "m"
                    | "meter"
                    | "meters"
                    | "metre"
                    | "metres"
                    | "seconds"
                    | "s"
                    | "away"
                    | "close"
                    | "closer"
                    | "near"
                    | "nearer"
                    | "by"
                    | "past"
                    | "pass"
                    | "request"
                    | "signal"
                    | "gesture"
                    | "sign"
                    | "this"
                    | "that"
                    | "so"
                    | "way"
                    | "path"
                    | "room"
                    | "space"
                    | "through"
                    | "aside"
                    | "asked"
                    | "signalled"
                    | "stops"
                    | "arrives"
                    | "appears"
                    | "approaches"
                    | "proceed"
                    | "wait"
                    | "me"
                    | "acknowledged"
                    | "halts"
                    | "opens"
                    | "open"
            );
            let next = mentions(&following(words, i)).into_iter().next();
            // `when the robot comes into sight one of them goes up to it`: whoever a verb stands behind does it.
            let finite = next.as_ref().is_some_and(|mention| {
                word(i + mention.to + 1).is_some_and(|word| {
                    word.text != word.stem && word.text.ends_with('s') && lex.verbs.contains(&word.stem)
                })
            });
            let governed = matches!(
                before,
                "of" | "to"
                    | "at"
                    | "by"
                    | "with"
                    | "near"
                    | "from"
                    | "for"
                    | "behind"
                    | "beside"
                    | "before"
                    | "and"
                    | "or"
                    | "in"
                    | "on"
                    | "than"
                    | "between"
                    | "past"
                    | "towards"
                    | "as"
                    | "that"
                    | "both"
                    | "is"
                    | "are"
                    | "when"
                    | "the"
                    | "a"
                    | "not"
                    | "only"
            );
            // `a second one does so`: the rest of a mention is none of its own.
            let goes_on = lex.ordinals.contains_key(before)
                || lex.adjectives.contains(before)
                || matches!(before, "other" | "last");
            (closes || finite && !governed && !goes_on)
                && next.is_some_and(|mention| {
                    mention.from == 0
                        && word(i + mention.to + 1).is_some_and(|word| {
                            lex.verbs.contains(&word.stem)
                                || matches!(word.text.as_str(), "just" | "simply" | "then" | "both" | "all" | "of")
                        })
                })
        }
        _ => false,
    }
}

/// The words from here to the next mark.
fn following(words: &[Option<Word>], from: usize) -> Vec<Word> {
    words.iter().skip(from).map_while(Clone::clone).collect()
}
