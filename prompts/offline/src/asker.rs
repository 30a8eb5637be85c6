//! Whoever asks: what he says of himself, which nobody in the scenario does, and he himself where he is in it.

use crate::lexicon::{Item, lexicon};
use crate::words::{Piece, Word, text_at, word_at};

/// What whoever asks is called in the cast, where he is somebody in the scenario.
pub(crate) const NAME: &str = "asker";

/// What people do for a living or with a study, behind `I` and `we`.
const OWN: &[&str] =
    &["teach", "manage", "run", "work", "am", "are", "study", "own", "lead", "organise", "organize", "supervise"];

/// Makes nobody's what whoever asks says of himself: no mention and no deed is read there.
///
/// The words stay unused, so that what they wish for is reported as not understood. Says whether there are any.
pub(crate) fn told(words: &mut [Option<Word>]) -> bool {
    let to = silent(words);
    for word in words.iter_mut().take(to).flatten() {
        word.label = true;
    }
    to > 0
}

/// How many words at the beginning of a sentence speak of whoever asks.
fn silent(words: &[Option<Word>]) -> usize {
    let word = |k: usize| words.get(k).and_then(Option::as_ref);
    let text = |k: usize| word(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| word(k).map_or("", |word| word.stem.as_str());
    // `As the safety officer here I need …`
    if text(0) == "as" && matches!(text(1), "the" | "a" | "an") {
        return (3..8).find(|k| matches!(text(*k), "i" | "we")).unwrap_or(0);
    }
    // `My professor asked for two conditions.`
    if matches!(text(0), "my" | "our") && !words.iter().flatten().any(|word| word.stem == "robot") {
        let wants = (2..5).find(|k| {
            matches!(stem(*k), "ask" | "want" | "tell" | "say" | "think" | "suggest" | "require" | "insist" | "need")
                && matches!(text(k + 1), "for" | "me" | "us" | "that" | "to" | "whether" | "if")
        });
        return wants.map_or(0, |k| k + 2);
    }
    // `I manage this building and …`, `We run a pilot in a care home`
    if !matches!(text(0), "i" | "we") || !OWN.contains(&text(1)) {
        return 0;
    }
    // `I am looking for two visitors who …`
    // `I'm thinking of a teenager who …`
    if text(2).ends_with("ing") && matches!(text(3), "for" | "of" | "about") {
        return 4;
    }
    // `I run a ward where …`, `I run a ward, and two visitors follow the robot`: what comes then is of the scenario.
    let counted = |k: usize| word(k).is_some_and(|word| word.count().is_some()) || matches!(text(k), "a" | "an");
    let people = |k: usize| (k..k + 3).any(|k| lexicon().roles.contains_key(stem(k)));
    let story = |k: usize| {
        (text(k - 1) == "and" || text(k - 1).is_empty())
            && counted(k)
            && people(k + 1)
            && (k..words.len()).any(|k| stem(k) == "robot")
    };
    let ends = |k: &usize| {
        matches!(text(*k), "where" | "whether") || word(*k).is_some_and(|word| word.after_colon) || story(*k)
    };
    (2..words.len()).find(ends).unwrap_or(words.len())
}

/// Gives whoever asks a name where he himself acts: `I walk towards the robot, and it stops for me.`
///
/// Only what cannot be meant otherwise counts: a clause in which `I` do something to the robot.
pub(crate) fn takes_part(pieces: &mut [Piece]) {
    if !(0..pieces.len()).any(|k| meets(pieces, k)) {
        return;
    }
    // `… because I am a polite person`
    let is = |k: usize| matches!(text_at(pieces, k), "am" | "was") && matches!(text_at(pieces, k + 1), "a" | "an");
    let told =
        |k: usize| matches!(text_at(pieces, k), "show" | "shows" | "give" | "gives" | "tell" | "let" | "help" | "make");
    let himself = |k: &usize| match text_at(pieces, *k) {
        "i" => begins(pieces, *k) && (verb(pieces, *k).is_some() || is(k + 1)),
        "me" => !k.checked_sub(1).is_some_and(told),
        _ => false,
    };
    let himself: Vec<usize> = (0..pieces.len()).filter(himself).collect();
    for k in himself {
        if let Some(Piece::Word(word)) = pieces.get_mut(k) {
            NAME.clone_into(&mut word.text);
            NAME.clone_into(&mut word.stem);
            (word.name, word.capital) = (true, true);
        }
    }
}

/// Whether a clause may begin here: `can I …` asks for something else.
fn begins(pieces: &[Piece], at: usize) -> bool {
    at.checked_sub(1).is_none_or(|before| {
        matches!(
            text_at(pieces, before),
            "" | "and" | "but" | "then" | "when" | "while" | "as" | "if" | "once" | "until" | "because" | "so"
        )
    })
}

/// The verb of a deed behind `I`: `I walk`, `I am just walking`.
fn verb(pieces: &[Piece], at: usize) -> Option<usize> {
    let fill = |k: &usize| matches!(text_at(pieces, *k), "am" | "was" | "just" | "simply" | "only" | "then" | "also");
    let at = (at + 1..at + 4).find(|k| !fill(k))?;
    let verb = word_at(pieces, at)?;
    let opens = |items: &[Item]| items.first().is_some_and(|item| item.takes(&verb.stem));
    let known = lexicon().actions.iter().any(|phrase| opens(&phrase.items))
        || matches!(verb.stem.as_str(), "wave" | "approach");
    (known && !OWN.contains(&verb.text.as_str()) && lexicon().verbs.contains(&verb.stem)).then_some(at)
}

/// Whether `I` at this place do something to the robot: `I wave it through`, `I come down the corridor towards the robot`.
fn meets(pieces: &[Piece], at: usize) -> bool {
    if text_at(pieces, at) != "i" || !begins(pieces, at) {
        return false;
    }
    let Some(verb) = verb(pieces, at) else { return false };
    let robot = |k: &usize| word_at(pieces, *k).is_some_and(|word| word.stem == "robot");
    let Some(robot) = (verb + 1..verb + 9).find(robot) else { return false };
    let between: Vec<&str> = (verb + 1..robot).map(|k| text_at(pieces, k)).filter(|text| *text != "the").collect();
    let direct = word_at(pieces, verb).is_some_and(|word| {
        matches!(word.stem.as_str(), "follow" | "block" | "approach" | "overtake" | "wave" | "chase" | "obstruct")
    });
    let leads = matches!(between.last(), Some(&("towards" | "toward" | "behind" | "past" | "beside" | "after")))
        || between.ends_with(&["front", "of"])
        || between.ends_with(&["up", "to"])
        || between.ends_with(&["next", "to"]);
    direct && between.is_empty() || leads
}

#[cfg(test)]
mod tests {
    use crate::summary;
    use crate::tests::told;

    fn unread(rough: &str) -> Vec<String> {
        crate::tests::loose(&told(rough, "hospital")).into_iter().filter(|word| word != "mail").collect()
    }

    fn read(rough: &str) -> String {
        summary(&told(rough, "hospital")).replace(" · robot: deliver mail", "")
    }

    #[test]
    fn what_whoever_asks_says_of_himself_is_no_story_and_is_reported() {
        for (own, words) in [
            ("I run a surgical unit and this happened last Tuesday:", vec!["surgical", "tuesday"]),
            (
                "I manage this building and people keep blocking our robot.",
                vec!["manage", "building", "keep", "blocking"],
            ),
            ("As the safety officer, I need this:", vec!["safety", "officer"]),
            ("My professor asked for a bright light.", vec!["professor", "asked", "bright", "light"]),
            ("We run three trials.", vec!["three", "trials"]),
            ("We are two visitors who follow the robot.", vec!["visitors", "follow"]),
        ] {
            let rough = format!("{own} a nurse follows the robot.");
            assert_eq!(read(&rough), "1 human · 1 follows the robot", "{rough}");
            let missing: Vec<&&str> =
                words.iter().filter(|word| !unread(&rough).contains(&(**word).to_owned())).collect();
            assert!(missing.is_empty(), "{rough}: {missing:?} of {:?}", unread(&rough));
        }
    }

    #[test]
    fn what_he_wants_behind_such_words_is_read() {
        for rough in [
            "I run a lab where two visitors follow the robot.",
            "I run a lab and two visitors follow the robot.",
            "I am looking for a scenario where two visitors follow the robot.",
            "I'm looking for two visitors who follow the robot.",
        ] {
            assert!(read(rough).starts_with("2 humans · 2 follow the robot"), "{rough}: {}", read(rough));
        }
    }

    #[test]
    fn who_asks_is_somebody_where_he_does_something_to_the_robot() {
        for (rough, line) in [
            (
                "A nurse stands at the exit. I walk towards the robot.",
                "2 humans · 1 nurse stands · 1 asker comes towards the robot · place: exit",
            ),
            ("I am walking towards the robot.", "1 human · 1 comes towards the robot"),
            ("It's just me, and I wave it through because I'm a polite person.", "1 human · 1 gestures PROCEED"),
            (
                "A nurse stands at the exit. I follow the robot. She tells it to wait.",
                "2 humans · 1 nurse stands, gestures WAIT · 1 asker follows the robot · place: exit",
            ),
        ] {
            assert_eq!(read(rough), line, "{rough}");
        }
    }

    #[test]
    fn who_only_asks_is_nobody() {
        for rough in [
            "How can I block the robot with two visitors?",
            "I want two visitors who block the robot.",
            "I follow the news about the robot: two visitors block it.",
        ] {
            assert!(read(rough).starts_with("2 humans · 2 block the robot"), "{rough}: {}", read(rough));
        }
    }
}
