//! Headings and labels: words and numbers that name something and count nobody.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, word_at};

/// What a heading speaks of.
const HEADS: &[&str] = &[
    "scenario",
    "test",
    "condition",
    "case",
    "study",
    "experiment",
    "trial",
    "setup",
    "run",
    "variant",
    "setting",
    "criterion",
    "requirement",
    "protocol",
    "pilot",
    "session",
    "block",
    "item",
    "feature",
    "bug",
    "issue",
    "ticket",
    "step",
    "manipulation",
    "paradigm",
    "script",
    "note",
    "outline",
    "expected",
    "input",
    "check",
    "task",
    "benchmark",
    "reproduction",
    "acceptance",
    "try",
    "attempt",
    "regression",
    "repro",
    "phase",
    "part",
];

/// Of these, verbs and nouns of the story where no number follows.
const ALSO_DEEDS: &[&str] = &[
    "step", "run", "check", "block", "part", "item", "task", "note", "input", "test", "bug", "issue", "phase",
    "expected",
];

/// Whether a heading speaks of it at this place: `block 2`, `test case`, `Setup:`.
fn head(words: &[&Word], at: usize) -> bool {
    let Some(word) = words.get(at) else { return false };
    let known = HEADS.contains(&word.text.as_str()) || HEADS.contains(&word.stem.as_str());
    let deed = ALSO_DEEDS.contains(&word.stem.as_str());
    known
        && (!deed
            || words.len() <= 2
            || words.get(at + 1).is_some_and(|next| next.count().is_some())
            || word.capital && at == 0
            || words.get(at + 1).is_none() && !word.text.ends_with("ing"))
}

/// Whether one of the words says what a heading speaks of.
fn heads(words: &[&Word]) -> bool {
    (0..words.len()).any(|at| head(words, at))
}

/// Makes words labels, which nobody reads.
fn label<'a>(words: impl IntoIterator<Item = &'a mut Option<Word>>) {
    for word in words.into_iter().flatten() {
        (word.label, word.used) = (true, true);
    }
}

/// Words that count no people, but how often, how long ago or what hour it is.
const COUNTED: &[&str] = &[
    "runs",
    "times",
    "trials",
    "tries",
    "attempts",
    "repetitions",
    "repeats",
    "episodes",
    "cases",
    "percent",
    "years",
    "days",
    "weeks",
    "months",
    "am",
    "pm",
    "oclock",
    "degrees",
    "points",
    "conditions",
    "sessions",
    "blocks",
    "sentences",
    "steps",
];

/// Headings that say nothing by themselves.
const LISTS: &[&str] = &[
    "participants",
    "participant",
    "people",
    "persons",
    "humans",
    "human",
    "agents",
    "actors",
    "roles",
    "who",
    "and",
    "pedestrians",
];

/// `Turn-taking, block 2, trial 14.`: a title without anybody in it counts nothing; nor do `10 of 10 runs`.
pub(crate) fn titled(words: &mut [Option<Word>]) {
    let asks = crate::asker::told(words);
    let whole: Vec<&Word> = words.iter().flatten().collect();
    let somebody = |word: &Word| {
        lexicon().roles.contains_key(&word.stem)
            || word.stem == "robot"
            || matches!(word.text.as_str(), "he" | "she" | "they" | "them" | "who")
    };
    // `Pilot trial 3`
    let titles = |at: usize| at == 0 && head(&whole, 0) && head(&whole, 1);
    let nobody = !whole.iter().enumerate().any(|(at, word)| somebody(word) && !titles(at));
    // `Regression 204.`
    let numbered = whole.len() <= 3
        && whole.iter().any(|word| word.is_digits())
        && !whole.iter().any(|word| lexicon().verbs.contains(&word.stem));
    if nobody && !asks && (numbered || whole.len() <= 9 && heads(&whole)) {
        label(words);
        return;
    }
    let stem = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.stem.as_str());
    let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
    let number = |k: usize| words.get(k).and_then(Option::as_ref).is_some_and(|word| word.count().is_some());
    let mut labels = Vec::new();
    for at in 0..words.len() {
        // `half past three`
        if text(at) == "past" && number(at + 1) {
            labels.extend([at.saturating_sub(1), at + 1]);
        }
        if !number(at) {
            continue;
        }
        // `between racks 7 and 8`
        let numbered = at >= 3
            && matches!(text(at - 1), "and" | "or" | "to")
            && words.get(at - 2).and_then(Option::as_ref).is_some_and(Word::is_digits)
            && lexicon().labels.contains(stem(at - 3));
        if numbered {
            labels.push(at);
        }
        let of = text(at + 1) == "of" && number(at + 2);
        let noun = at + if of { 3 } else { 1 };
        let several = words.get(at).and_then(Option::as_ref).and_then(Word::count).is_some_and(|n| n > 1);
        // `human 2 runs away`
        let somebody = at > 0 && lexicon().roles.contains_key(stem(at - 1));
        if several && !somebody && COUNTED.contains(&text(noun)) {
            labels.extend([at, noun]);
            labels.extend(Some(at + 2).filter(|_| of));
        }
    }
    for at in labels {
        if let Some(Some(word)) = words.get_mut(at) {
            (word.label, word.used) = (true, true);
        }
    }
}

/// A number right before a colon names what comes: `test case 14:`, `study 2:`, `scenario for 3 planners:`.
pub(crate) fn labels(words: &mut [Option<Word>]) {
    if crate::asker::told(words) {
        return;
    }
    let start = words.iter().rposition(Option::is_none).map_or(0, |at| at + 1);
    // `Field notes, ward 7, day 2:`
    let article = |word: &Word| matches!(word.text.as_str(), "a" | "an" | "the") || word.stem == "robot";
    let role = |word: &Word| lexicon().roles.contains_key(&word.stem);
    let counted = words
        .windows(2)
        .any(|pair| matches!(pair, [Some(number), Some(noun)] if number.count().is_some() && role(noun)));
    let sentence: Vec<&Word> = words.iter().flatten().collect();
    let title =
        start > 0 && sentence.len() <= 9 && heads(&sentence) && !sentence.iter().any(|word| article(word)) && !counted;
    if title {
        label(words);
        return;
    }
    let whole: Vec<&Word> = words.iter().skip(start).flatten().collect();
    let heading = (0..whole.len().min(3)).any(|at| head(&whole, at));
    let counts = |word: &Word| word.count().is_some() || matches!(word.text.as_str(), "one" | "someone" | "somebody");
    let placed = whole.first().is_some_and(|word| matches!(word.text.as_str(), "in" | "at" | "on" | "near" | "inside"));
    // `Explicit signalling condition:`, `Reproduction steps for #882:` name what comes, and nobody in it.
    let somebody = whole.iter().any(|word| role(word) || !heading && word.stem == "robot");
    let uncounted = heading || whole.len() > 3 || !whole.iter().any(|word| counts(word));
    if !placed && !somebody && uncounted {
        label(words.iter_mut().skip(start));
        return;
    }
    let list = |word: &Word| {
        LISTS.contains(&word.text.as_str())
            || lexicon().adjectives.contains(&word.text)
            || role(word) && crate::noun::plural(word)
    };
    if whole.len() <= 2 && whole.iter().all(|word| list(word)) {
        label(words.iter_mut().skip(start));
    }
    let purpose = words.iter().skip(start).position(|word| word.as_ref().is_some_and(|word| word.text == "for"));
    if let Some(purpose) = purpose.filter(|_| heading) {
        for word in words.iter_mut().skip(start + purpose).flatten() {
            word.label = true;
        }
    }
    if let [.., Some(noun), Some(number)] = words
        && number.count().is_some()
        && !lexicon().verbs.contains(&noun.stem)
        && !lexicon().roles.contains_key(&noun.stem)
    {
        number.label = true;
    }
}

/// Words before the robot's name that only describe it: `the little delivery robot`.
const OF_ROBOT: &[&str] = &[
    "delivery",
    "mobile",
    "service",
    "little",
    "small",
    "big",
    "large",
    "white",
    "approaching",
    "moving",
    "passing",
    "cleaning",
    "transport",
    "autonomous",
    "new",
    "slow",
    "waiting",
    "stopped",
    "humanoid",
    "guide",
    "hospital",
    "office",
    "warehouse",
    "logistics",
    "mail",
    "coming",
    "incoming",
    "same",
    "strange",
    "stationary",
    "social",
    "assistive",
    "elder",
    "care",
];

/// Marks what only describes the robot.
pub(crate) fn described(words: &mut [Option<Word>]) {
    for at in 1..words.len() {
        let named = |word: &Word| word.stem == "robot" && !matches!(word.text.as_str(), "it" | "its" | "itself");
        if !words.get(at).and_then(Option::as_ref).is_some_and(named) {
            continue;
        }
        for back in (0..at).rev() {
            match words.get_mut(back) {
                Some(Some(word)) if OF_ROBOT.contains(&word.text.as_str()) => (word.label, word.used) = (true, true),
                Some(_) | None => break,
            }
        }
    }
}

/// Words before a total that say no more than that it is one: `number of pedestrians: 2`.
const OF_TOTALS: &[&str] = &["number", "no", "n", "num", "total", "count", "amount", "of", "the", "and", "with", "a"];

/// `pedestrians: 2` and `humans=4` give a number of people: `exactly 2 pedestrians`.
pub(crate) fn totals(pieces: &mut Vec<Piece>) {
    let mut at = 0;
    while at < pieces.len() {
        let found = {
            let word = |k: usize| word_at(pieces, k);
            let noun = word(at).filter(|word| lexicon().roles.contains_key(&word.stem));
            let counted = word(at + 1).is_some_and(|word| word.text == "count");
            let several = noun.is_some_and(crate::noun::plural) || counted;
            let next = at + 1 + usize::from(counted);
            let colon = usize::from(matches!(pieces.get(next), Some(Piece::Colon)));
            let number = word(next + colon).filter(|word| word.is_digits() && word.count().is_some());
            let ends = !matches!(pieces.get(next + colon + 1), Some(Piece::Word(_)));
            match (noun, number) {
                (Some(noun), Some(number)) if several && ends => Some((noun.clone(), number.clone(), next + colon)),
                _ => None,
            }
        };
        if let Some((noun, number, end)) = found {
            // What stands before is a sentence of its own: `smoke everywhere pedestrians: 2`.
            let before =
                (0..at).rev().take_while(|k| matches!(pieces.get(*k), Some(Piece::Word(_)))).last().unwrap_or(at);
            let of = |k: &usize| word_at(pieces, *k).is_some_and(|word| OF_TOTALS.contains(&word.text.as_str()));
            let from = (before..at).rev().take_while(of).last().unwrap_or(at);
            for piece in pieces.iter_mut().take(from).skip(before) {
                if let Piece::Word(word) = piece {
                    // `speed 1 pedestrians: 2` counts nobody before the colon.
                    word.label |= word.is_digits();
                }
            }
            let exactly = Word { text: "exactly".to_owned(), stem: "exactly".to_owned(), ..number.clone() };
            let stop = (from > before).then_some(Piece::Stop);
            let stops = usize::from(stop.is_some());
            let total = [Piece::Word(exactly), Piece::Word(number), Piece::Word(noun), Piece::Stop];
            let _before: Vec<Piece> = pieces.splice(from..=end, stop.into_iter().chain(total)).collect();
            at = from + stops + 3;
        }
        at += 1;
    }
}

/// Marks names everywhere, those that are known and those of which one place shows that they are names:
/// `Anna follows Tom. Tom stops.`
pub(crate) fn names(pieces: &mut [Piece], known: Vec<String>) {
    let lex = lexicon();
    let word = |k: usize| word_at(pieces, k);
    // `Perception runs at 5 Hz` names nobody.
    let notion = |word: &Word| {
        ["tion", "ness", "ment", "ity", "ance", "ence", "ing", "ism", "ics", "ogy"]
            .iter()
            .any(|end| word.text.ends_with(end))
    };
    let strange = |word: &Word| {
        !notion(word)
            && word.capital
            && word.text.len() > 1
            && word.text.chars().all(char::is_alphabetic)
            && !lex.has(word)
    };
    let verb = |k: usize| word(k).is_some_and(|word| lex.verbs.contains(&word.stem) && !word.capital);
    let does = |k: usize| {
        // `Privacy is the question` names nobody.
        let copula = word(k).is_some_and(|word| matches!(word.text.as_str(), "is" | "was" | "has"));
        let goes_on = word(k + 1).is_some_and(|word| {
            word.text.ends_with("ing")
                || matches!(
                    word.text.as_str(),
                    "in" | "at" | "on" | "a" | "an" | "not" | "our" | "my" | "standing" | "also"
                )
        });
        word(k).is_some_and(|word| {
            lex.verbs.contains(&word.stem)
                && !word.capital
                && word.text != word.stem
                && (!copula || goes_on)
                && !matches!(word.stem.as_str(), "finish" | "start" | "begin" | "end" | "happen" | "continue")
                || matches!(
                    word.text.as_str(),
                    "who"
                        | "both"
                        | "then"
                        | "just"
                        | "only"
                        | "never"
                        | "also"
                        | "always"
                        | "will"
                        | "would"
                        | "does"
                        | "can"
                        | "neither"
                )
        }) || matches!(pieces.get(k), Some(Piece::Comma)) && word(k + 1).is_some_and(|word| word.text == "who")
    };
    let title =
        |k: usize| word(k).is_some_and(|word| matches!(word.text.as_str(), "mr" | "mrs" | "ms" | "miss" | "prof"));
    let begins = |k: usize| {
        k == 0
            || title(k - 1)
            || !matches!(pieces.get(k - 1), Some(Piece::Word(_)))
            || word(k - 1).is_some_and(|word| {
                matches!(
                    word.text.as_str(),
                    "and" | "when" | "while" | "whereas" | "but" | "if" | "then" | "as" | "once" | "until"
                )
            })
    };
    let mut found: Vec<String> = known;
    for k in 0..pieces.len() {
        let Some(name) = word(k).filter(|word| strange(word)) else { continue };
        // `Anna and Ben both cross`
        let pair = word(k + 1).is_some_and(|word| word.text == "and")
            && word(k + 2).is_some_and(strange)
            && (does(k + 3)
                || verb(k + 3)
                || matches!(pieces.get(k + 3), Some(Piece::Comma))
                    && word(k + 4).is_some_and(|word| word.text == "both" || word.text.ends_with("ing")));
        // `From the opposite direction comes Anna, …`
        let after_verb = k > 1
            && word(k - 1)
                .is_some_and(|word| matches!(word.text.as_str(), "comes" | "walks" | "stands" | "sits" | "waits"))
            && !matches!(pieces.get(k + 1), Some(Piece::Word(_)));
        if begins(k) && (does(k + 1) || pair) || after_verb {
            found.push(name.text.clone());
            found.extend(word(k + 2).filter(|_| pair).map(|word| word.text.clone()));
        }
    }
    for k in 0..pieces.len() {
        let titles = title_before_name(pieces, k, &found);
        if let Some(Piece::Word(word)) = pieces.get_mut(k) {
            word.name = word.capital && (found.contains(&word.text) || found.contains(&word.stem));
            word.label |= titles;
            word.used |= titles;
        }
    }
}

/// `Mr.` in `Mr. Hartmann`.
fn title_before_name(pieces: &[Piece], at: usize, names: &[String]) -> bool {
    let text = |k: usize| word_at(pieces, k).map_or("", |word| word.text.as_str());
    matches!(text(at), "mr" | "mrs" | "ms" | "miss") && names.iter().any(|name| name == text(at + 1))
}

#[cfg(test)]
mod tests {
    use crate::tests::told;

    #[test]
    fn words_before_a_total_are_a_sentence_of_their_own() {
        let reading = told("Rainy evening pedestrians: 2", "office");
        assert_eq!(reading.humans.len(), 2);
        assert_eq!(crate::tests::loose(&reading), ["rainy", "evening"]);
        let reading = told("A nurse follows the robot visitors: 2", "office");
        assert_eq!(reading.humans.len(), 3, "{reading:#?}");
    }

    #[test]
    fn words_that_only_say_that_a_total_comes_are_read() {
        for rough in ["Number of pedestrians: 2", "total pedestrians: 2.", "pedestrians: 2"] {
            let reading = told(rough, "office");
            assert_eq!((reading.humans.len(), reading.missing()), (2, Vec::new()), "{rough}");
        }
        // A number before it counts nobody, and is told.
        let reading = told("level 1 pedestrians: 2", "office");
        assert_eq!(reading.humans.len(), 2);
    }
}
