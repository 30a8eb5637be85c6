//! People by number or letter: `human 2`, `worker number 6`, `person A`, `B follows A`.

use crate::lexicon::{Lexicon, lexicon};
use crate::noun::{noun, plural};
use crate::words::{Piece, Word, word, word_at};

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

/// Nouns whose number tells where somebody belongs, before the word for people: `line 5 operators`.
const BELONGS: &[&str] = &[
    "ward",
    "line",
    "wing",
    "unit",
    "section",
    "gate",
    "platform",
    "bay",
    "dock",
    "station",
    "shift",
    "zone",
    "level",
    "sector",
    "block",
    "cell",
    "terminal",
    "team",
    "route",
    "bus",
    "building",
    "department",
];
/// Words before a place, behind which a number counts again: `in ward 6 nurses talk`.
const WHERE: &[&str] = &[
    "in", "at", "on", "along", "near", "by", "inside", "outside", "through", "from", "to", "into", "towards", "beside",
    "behind", "past", "of", "before",
];
/// The largest range that is one number of people.
const WIDEST: u32 = 20;

/// Numbers that count nobody are taken out of the text, and a range becomes one number within it: `24/7 staff`, `ward 6 nurse`,
/// `between two and four people`.
pub(crate) fn settled(text: &str, pieces: Vec<Piece>) -> Vec<Piece> {
    let mut out: Vec<Option<Piece>> = pieces.into_iter().map(Some).collect();
    for at in 0..out.len() {
        if let Some((from, to, number)) = range(text, &out, at) {
            let span = place(&out, from).zip(place(&out, to)).map(|(first, last)| (first.from, last.to));
            let Some((begin, end)) = span else { continue };
            for slot in out.iter_mut().take(to + 1).skip(from) {
                *slot = None;
            }
            if let Some(slot) = out.get_mut(to) {
                *slot = Some(Piece::Word(word(number.to_string(), begin, end)));
            }
        } else if always(text, &out, at) {
            drop(out.get_mut(at).and_then(Option::take));
            drop(out.get_mut(at + 1).and_then(Option::take));
        } else if let Some(behind) = belongs(&out, at) {
            if behind {
                if let Some(Some(Piece::Word(word))) = out.get_mut(at + 1) {
                    (word.label, word.used) = (true, true);
                }
            } else {
                drop(out.get_mut(at).and_then(Option::take));
                drop(out.get_mut(at + 1).and_then(Option::take));
            }
        }
    }
    out.into_iter().flatten().collect()
}

fn place(pieces: &[Option<Piece>], at: usize) -> Option<&Word> {
    if let Some(Some(Piece::Word(word))) = pieces.get(at) { Some(word) } else { None }
}

/// The words from here to the next mark, as far as a noun phrase goes.
fn following(pieces: &[Option<Piece>], at: usize) -> Vec<Word> {
    (at..at + 5).map_while(|k| place(pieces, k)).cloned().collect()
}

/// The noun for people that the words begin with.
fn people(words: &[Word]) -> Option<&Word> {
    noun(words, 0, lexicon()).and_then(|end| words.get(end))
}

/// `24/7`
fn always(text: &str, pieces: &[Option<Piece>], at: usize) -> bool {
    let (Some(a), Some(b)) = (place(pieces, at), place(pieces, at + 1)) else { return false };
    let stroke = a.is_digits() && b.is_digits() && text.get(a.to..b.from) == Some("/");
    stroke && (a.text == "24" && b.text == "7" || people(&following(pieces, at + 2)).is_some())
}

/// Whether a noun with its number tells where the people behind them belong; and whether a word for a place stands before it.
fn belongs(pieces: &[Option<Piece>], at: usize) -> Option<bool> {
    let (noun, number) = (place(pieces, at)?, place(pieces, at + 1)?);
    let count = number.count().filter(|_| noun.text == noun.stem && number.is_digits() && !number.label)?;
    let strict = BELONGS.contains(&noun.text.as_str());
    if !strict && !lexicon().labels.contains(&noun.text) {
        return None;
    }
    let after = following(pieces, at + 2);
    let many = plural(people(&after)?);
    let text = |back: usize| at.checked_sub(back).and_then(|k| place(pieces, k)).map_or("", |word| word.text.as_str());
    let article = usize::from(matches!(text(1), "the" | "a" | "an" | "our" | "my" | "one" | "this"));
    let behind = WHERE.contains(&text(1 + article));
    // `6 nurse` counts nobody; `5 operators` may, unless nothing else is said of the line.
    if !many && count != 1 || strict && !behind { Some(behind && article == 0) } else { None }
}

/// `between two and four people`, `2-4 people`, `two to four people`: first and last piece, and the number that is taken.
fn range(text: &str, pieces: &[Option<Piece>], at: usize) -> Option<(usize, usize, u32)> {
    let opens = place(pieces, at)?.text.as_str();
    let from = at + usize::from(matches!(opens, "between" | "from"));
    let first = place(pieces, from)?;
    let least = first.count()?;
    let comma = matches!(pieces.get(from + 1), Some(Some(Piece::Comma)));
    let joined = |to: usize| {
        let gap = place(pieces, to).and_then(|second| text.get(first.to..second.from)).unwrap_or_default();
        matches!(gap.trim(), "-" | "–" | "—")
    };
    let joins = |to: usize| match place(pieces, to - 1).map_or("", |word| word.text.as_str()) {
        "and" => opens == "between",
        "to" => opens != "between",
        _ => false,
    };
    let to = [from + 1 + usize::from(comma)].into_iter().find(|to| joined(*to));
    let to = to.or_else(|| Some(from + 2).filter(|to| joins(*to)))?;
    let most = place(pieces, to)?.count()?;
    let whom = following(pieces, to + 1);
    let fits = least > 0 && least < most && most <= least + WIDEST && people(&whom).is_some_and(plural);
    fits.then_some((at, to, u32::midpoint(least, most)))
}

/// What is said of each range that became one number, and of `two or three people`, which are as many as may be.
pub(crate) fn ranges(text: &str) -> Vec<String> {
    let pieces = crate::words::pieces(text);
    let either = (0..pieces.len()).filter_map(|at| {
        let (first, or, second) = (word_at(&pieces, at)?, word_at(&pieces, at + 1)?, word_at(&pieces, at + 2)?);
        let both = first.count().zip(second.count()).filter(|(a, b)| a < b && or.text == "or");
        let words: Vec<Word> = (at + 3..at + 7).map_while(|k| word_at(&pieces, k)).cloned().collect();
        let most = both.filter(|_| people(&words).is_some_and(plural))?.1;
        let quote = text.get(first.from..second.to)?;
        Some(format!("`{quote}` leaves the number open; it was read as {most}"))
    });
    let words = (0..pieces.len()).filter_map(|k| word_at(&pieces, k)).filter(|word| word.is_digits());
    let said = words.filter_map(|word| text.get(word.from..word.to).map(|quote| (word, quote)));
    said.filter(|(word, quote)| {
        // Digits alone, or with separators of thousands, are what they are.
        quote.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()).count() > 1
            && quote.replace([',', '.', ':'], "") != word.text.replace('.', "")
            && quote.contains([' ', '-', '–', '—'])
    })
    .map(|(word, quote)| format!("`{quote}` leaves the number open; it was read as {}", word.text))
    .chain(either)
    .collect()
}

#[cfg(test)]
mod tests {
    use crate::tests::{map, request};

    fn read(rough: &str) -> socrates_model::Reading {
        crate::read(&request("Deliver a parcel", Some(rough)), &map("hospital"))
    }

    #[test]
    fn numbers_that_name_something_count_nobody() {
        for (rough, count) in [
            ("Ward 6 nurse comes towards the robot.", 1),
            ("The ward 3 nurse crosses the corridor and stops.", 1),
            ("Line 5 operators walk towards the robot.", 2),
            ("24/7 staff walk towards the robot.", 2),
            ("In the corridor 3 people wait.", 3),
            ("In ward 2 three nurses talk.", 3),
            ("In aisle 4 two pickers come towards the robot.", 2),
            ("6 nurses come towards the robot.", 6),
        ] {
            let reading = read(rough);
            assert_eq!(reading.humans.len(), count, "{rough}: {reading:?}");
        }
    }

    #[test]
    fn a_range_is_one_number_within_it_and_says_so() {
        for rough in [
            "Between two and four people come towards the robot.",
            "2-4 people come towards the robot.",
            "2–4 people come towards the robot.",
            "Two to four people come towards the robot.",
            "Two or three people come towards the robot.",
        ] {
            let reading = read(rough);
            assert_eq!(reading.humans.len(), 3, "{rough}: {reading:?}");
            assert!(reading.notes.iter().any(|note| note.contains("was read as 3")), "{rough}: {:?}", reading.notes);
            assert_eq!(crate::tests::loose(&reading), [""; 0], "{rough}");
        }
        let plain = read("1,000 m away two people wait. Two nurses come at 2 to 4 m.");
        assert!(!plain.notes.iter().any(|note| note.contains("leaves the number open")), "{:?}", plain.notes);
    }
}
