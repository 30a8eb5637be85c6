//! Text into words and marks, and where phrases stand in them.

use crate::lexicon::{Item, Phrase, lexicon};
use crate::slips::{JOINED, mended};

/// One word with its place in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Word {
    /// As written, in lower case.
    pub(crate) text: String,
    /// Its base form; `robot` for the robot by any name.
    pub(crate) stem: String,
    /// First byte in the text.
    pub(crate) from: usize,
    /// Byte after the last one.
    pub(crate) to: usize,
    /// Whether something was read from it.
    pub(crate) used: bool,
    /// Whether it only stands in a phrase that was read, and no rule read the word itself: `left` in `the left visitor`.
    pub(crate) skimmed: bool,
    /// Whether it is written with a capital letter.
    pub(crate) capital: bool,
    /// A number that names something (`case 14`), or a word that only describes the robot: read by nobody.
    pub(crate) label: bool,
    /// Whether a colon stands right before it.
    pub(crate) after_colon: bool,
    /// Somebody's name, told by a place where it can be nothing else.
    pub(crate) name: bool,
    /// The roles of the people that the noun stands for, where a list told them: `two people, a nurse and a visitor`.
    pub(crate) made_of: Vec<String>,
    /// Names of those for whom the noun stands: `Dele, the porter`.
    pub(crate) called: Vec<String>,
}

impl Word {
    /// The number that the word is, by digits or by name.
    pub(crate) fn number(&self) -> Option<f64> {
        let digits = self.text.parse::<f64>().ok().filter(|n| n.is_finite() && !self.label);
        digits.or_else(|| self.count().map(f64::from))
    }

    /// The whole number that the word is.
    pub(crate) fn count(&self) -> Option<u32> {
        let digits = || {
            if self.text.bytes().all(|b| b.is_ascii_digit()) {
                Some(self.text.parse().unwrap_or(u32::MAX))
            } else {
                None
            }
        };
        if self.label { None } else { lexicon().numbers.get(&self.text).copied().or_else(digits) }
    }

    /// Whether no rule read it.
    pub(crate) fn unread(&self) -> bool {
        !self.used || self.skimmed
    }

    /// Whether it is written in digits.
    pub(crate) fn is_digits(&self) -> bool {
        self.text.starts_with(|c: char| c.is_ascii_digit())
    }
}

/// A word, or a mark between words.
pub(crate) enum Piece {
    Word(Word),
    Comma,
    Colon,
    Stop,
}

/// The word at this place, if no mark stands there.
pub(crate) fn word_at(pieces: &[Piece], at: usize) -> Option<&Word> {
    if let Some(Piece::Word(word)) = pieces.get(at) { Some(word) } else { None }
}

/// The text of the word at this place; empty for a mark.
pub(crate) fn text_at(pieces: &[Piece], at: usize) -> &str {
    word_at(pieces, at).map_or("", |word| word.text.as_str())
}

/// Makes words nobody's: no mention and no deed is read there, and what they wish for is reported as not understood.
pub(crate) fn silence(pieces: &mut [Piece], places: impl IntoIterator<Item = usize>) {
    for at in places {
        if let Some(Piece::Word(word)) = pieces.get_mut(at) {
            word.label = true;
        }
    }
}

/// Whether a comma, or another mark inside a sentence, stands at this place.
pub(crate) fn comma_at(pieces: &[Piece], at: usize) -> bool {
    matches!(pieces.get(at), Some(Piece::Comma))
}

/// The words and marks of a text, in order.
pub(crate) fn pieces(text: &str) -> Vec<Piece> {
    let chars: Vec<(usize, char)> = text.char_indices().collect();
    let at = |i: usize| chars.get(i).map(|(_, c)| *c);
    let byte = |i: usize| chars.get(i).map_or(text.len(), |(b, _)| *b);
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(c) = at(i) {
        if c.is_ascii_digit() {
            let start = i;
            let mut digits = String::new();
            let mut clock = false;
            while let Some(c) = at(i) {
                let between = at(i + 1).is_some_and(|d| d.is_ascii_digit());
                // `14:30` is a time and counts nobody.
                if c == ':' && between && digits.len() <= 2 && !clock {
                    clock = true;
                    i += 1;
                    continue;
                }
                if c.is_ascii_digit() || c == '.' && between && !digits.contains('.') {
                    digits.push(c);
                } else if !(c == ',' && (1..=3).all(|k| at(i + k).is_some_and(|d| d.is_ascii_digit()))) {
                    break;
                }
                i += 1;
            }
            // `2.3.1`, `#882`, `R-31` and `4B` name something.
            let version = at(i) == Some('.') && at(i + 1).is_some_and(|d| d.is_ascii_digit());
            while version
                && at(i)
                    .is_some_and(|c| c == '.' && at(i + 1).is_some_and(|d| d.is_ascii_digit()) || c.is_ascii_digit())
            {
                i += 1;
            }
            let back = |k: usize| start.checked_sub(k).and_then(&at);
            let tagged = back(1) == Some('#') || back(1) == Some('-') && back(2).is_some_and(char::is_uppercase);
            let lettered = at(i).is_some_and(|c| c.is_uppercase() && c != 'M' && c != 'S')
                && !at(i + 1).is_some_and(char::is_alphanumeric);
            // `a 7-point scale`; but `a 2-person group`, `3-meter`
            let joined: String = if at(i) == Some('-') {
                (i + 1..).map_while(|k| at(k).filter(|c| c.is_lowercase())).collect()
            } else {
                String::new()
            };
            let unit = lexicon().stem(&joined);
            let named = joined.len() > 1
                && !lexicon().roles.contains_key(&unit)
                && !matches!(unit.as_str(), "meter" | "second" | "centimeter" | "minute");
            let label = clock || version || tagged || lettered || named;
            out.push(Piece::Word(Word { label, ..word(digits, byte(start), byte(i)) }));
            i += usize::from(lettered);
        } else if let Some(end) = short(&at, i) {
            // `i.e. roughly 2 m`, `e.g. stepping aside`
            out.push(Piece::Comma);
            i = end;
        } else if let Some(mark) = listed(&at, i, out.last()) {
            out.push(Piece::Stop);
            i = mark;
        } else if let Some(end) = identifier(&at, i) {
            i = end;
        } else if let Some(end) = chained(&chars, i) {
            i = end;
        } else if c.is_alphabetic() {
            let start = i;
            while at(i).is_some_and(char::is_alphabetic) {
                i += 1;
            }
            // `gate B12` is a name and counts nothing; `human2` is the second human.
            while i - start <= 4
                && chars.get(start + 1..i).is_none_or(|rest| rest.iter().all(|(_, c)| c.is_ascii_digit()))
                && at(i).is_some_and(|c| c.is_ascii_digit())
            {
                i += 1;
            }
            let lower: String =
                chars.get(start..i).unwrap_or_default().iter().flat_map(|(_, c)| c.to_lowercase()).collect();
            let capital = at(start).is_some_and(char::is_uppercase);
            let first = out.len();
            i += apostrophe(&lower, &at, i, &mut out, byte(start), &byte);
            if let Some(Piece::Word(word)) = out.get_mut(first) {
                word.capital = capital;
            }
        } else {
            // The tail of a possessive after a number (`human_2's`) is no word.
            let owns = matches!(c, '\'' | '’') && at(i + 1) == Some('s') && !at(i + 2).is_some_and(char::is_alphabetic);
            i += usize::from(owns);
            match c {
                // `No. 1 stops`
                '.' if text_at(&out, out.len().wrapping_sub(1)) == "no"
                    && (i + 1..i + 3).any(|k| at(k).is_some_and(|c| c.is_ascii_digit())) =>
                {
                    if let Some(Piece::Word(word)) = out.last_mut() {
                        "number".clone_into(&mut word.text);
                        "number".clone_into(&mut word.stem);
                    }
                }
                '.' if abbreviated(out.last()) => {}
                '.' | '!' | '?' | ';' => out.push(Piece::Stop),
                ':' => out.push(Piece::Colon),
                ',' | '(' | ')' | '[' | ']' | '–' | '—' | '•' => out.push(Piece::Comma),
                '|' => out.push(Piece::Stop),
                '/' if at(i + 1).is_some_and(char::is_whitespace) => out.push(Piece::Stop),
                '+' if at(i + 1).is_some_and(char::is_whitespace) => {
                    out.push(Piece::Word(word("and".to_owned(), byte(i), byte(i + 1))));
                }
                '>' => match arrow(&at, i, out.last()) {
                    [] => out.push(Piece::Comma),
                    to => {
                        out.extend(to.iter().map(|text| Piece::Word(word((*text).to_owned(), byte(i), byte(i + 1)))));
                    }
                },
                '-' if at(i + 1) == Some('-') => out.push(Piece::Comma),
                '\n' if at(i + 1) == Some('\n') => out.push(Piece::Stop),
                '-' if at(i + 1).is_some_and(char::is_whitespace) => out.push(Piece::Comma),
                _ => {}
            }
            i += 1;
        }
    }
    crate::numbered::settled(text, crate::again::joined(out))
}

/// What an arrow from a place to a place says: `pharmacy -> room 214`; `-> exit` is `to the exit`, and nobody exits.
fn arrow(at: &dyn Fn(usize) -> Option<char>, i: usize, before: Option<&Piece>) -> &'static [&'static str] {
    let bare = |name: &str| matches!(name, "dock" | "exit" | "gate");
    let place = |name: &str| {
        let named = Item::Word(name.to_owned());
        let ends = |place: &Phrase<_>| place.items.last() == Some(&named) || place.items.first() == Some(&named);
        bare(name) || name != "back" && lexicon().places.iter().any(ends)
    };
    let from = matches!(before, Some(Piece::Word(word)) if place(&word.text) || word.is_digits());
    let next: String =
        (i + 1..).skip_while(|k| at(*k) == Some(' ')).map_while(|k| at(k).filter(|c| c.is_alphabetic())).collect();
    let next = next.to_lowercase();
    match (from && place(&next), bare(&next)) {
        (false, _) => &[],
        (true, false) => &["to"],
        (true, true) => &["to", "the"],
    }
}

/// `i.e.`, `e.g.`, `viz.`, `sc.`, `etc.`: where that ends.
fn short(at: &dyn Fn(usize) -> Option<char>, i: usize) -> Option<usize> {
    if i > 0 && at(i - 1).is_some_and(char::is_alphanumeric) {
        return None;
    }
    let is = |text: &str| text.chars().enumerate().all(|(k, c)| at(i + k) == Some(c)).then(|| i + text.len());
    ["i.e.", "e.g.", "viz.", "sc.", "etc."].iter().find_map(|text| is(text))
}

/// Whether the dot belongs to the word before it: `Mr. Hartmann`, `approx. 2 m`.
fn abbreviated(before: Option<&Piece>) -> bool {
    let short =
        ["mr", "mrs", "ms", "dr", "prof", "st", "approx", "ca", "vs", "resp", "incl", "max", "min", "exp", "cond"];
    matches!(before, Some(Piece::Word(word)) if short.contains(&word.text.as_str()))
}

/// `(1)`, `(b)` and `2)` before an item of a list: where the item begins.
fn listed(at: &dyn Fn(usize) -> Option<char>, i: usize, before: Option<&Piece>) -> Option<usize> {
    if at(i) != Some('(') || matches!(before, Some(Piece::Word(_))) {
        return None;
    }
    let number = (i + 1..i + 3).take_while(|k| at(*k).is_some_and(|c| c.is_ascii_digit())).count();
    let letter = usize::from(number == 0 && at(i + 1).is_some_and(|c| c.is_ascii_lowercase()));
    let end = i + 1 + number + letter;
    if number + letter > 0 && at(end) == Some(')') { Some(end + 1) } else { None }
}

/// `TC_PED_07`: the name of something else than a person; where it ends.
fn identifier(at: &dyn Fn(usize) -> Option<char>, i: usize) -> Option<usize> {
    if !at(i).is_some_and(char::is_uppercase) {
        return None;
    }
    let end = (i..).find(|k| !at(*k).is_some_and(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_'))?;
    let inside = |wanted: &dyn Fn(char) -> bool| (i..end).any(|k| at(k).is_some_and(wanted));
    let joined = inside(&|c| c == '_') && inside(&|c| c.is_ascii_digit());
    if joined && !at(end).is_some_and(char::is_alphabetic) { Some(end) } else { None }
}

/// `Bring-your-child day`, and the tail of `brother-in-law`: hyphens make people into something else; where that ends.
fn chained(chars: &[(usize, char)], i: usize) -> Option<usize> {
    let letter = |k: usize| chars.get(k).is_some_and(|(_, c)| c.is_alphabetic());
    let hyphen = |k: usize| chars.get(k).is_some_and(|(_, c)| *c == '-');
    let begins = i == 0 || !letter(i - 1) && !hyphen(i - 1);
    let end = (i..).find(|k| !(letter(*k) || hyphen(*k) && letter(k + 1)))?;
    let text: String = chars.get(i..end)?.iter().flat_map(|(_, c)| c.to_lowercase()).collect();
    let parts: Vec<&str> = text.split('-').collect();
    let people = parts.iter().skip(1).any(|part| lexicon().roles.contains_key(&lexicon().stem(part)));
    if begins && parts.len() >= 3 && people { Some(end) } else { None }
}

/// Pushes a word and what its apostrophe hides (`don't` is `do not`, `I'm` is `I am`, `robot's` is `robot`); says how many characters it took.
fn apostrophe(
    lower: &str,
    at: &dyn Fn(usize) -> Option<char>,
    i: usize,
    out: &mut Vec<Piece>,
    from: usize,
    byte: &dyn Fn(usize) -> usize,
) -> usize {
    let mark = at(i).is_some_and(|c| matches!(c, '\'' | '’'));
    let tail: String =
        if mark { (1..4).map_while(|k| at(i + k).filter(|c| c.is_alphabetic())).collect() } else { String::new() };
    let taken = if mark && !tail.is_empty() { 1 + tail.chars().count() } else { 0 };
    let to = byte(i + taken);
    if tail == "t" && lower.ends_with('n') {
        let verb = match lower.strip_suffix('n') {
            Some("wo") => "will",
            Some("sha") => "shall",
            Some("ca") | None => "can",
            Some(verb) => verb,
        };
        out.push(Piece::Word(word(verb.to_owned(), from, to)));
        out.push(Piece::Word(word("not".to_owned(), from, to)));
    } else if tail == "s" && matches!(lower, "he" | "she" | "who" | "there") {
        // `he's` is `he is`; `it's` and `robot's` stay what they are.
        out.push(Piece::Word(word(lower.to_owned(), from, to)));
        out.push(Piece::Word(word("is".to_owned(), from, to)));
    } else if tail == "s" && lower == "it" && gone(at, i + taken) {
        out.push(Piece::Word(word(lower.to_owned(), from, to)));
        out.push(Piece::Word(word("has".to_owned(), from, to)));
    } else if tail == "m" && lower == "i" {
        out.push(Piece::Word(word(lower.to_owned(), from, to)));
        out.push(Piece::Word(word("am".to_owned(), from, to)));
    } else {
        match JOINED.iter().find(|(joined, _)| *joined == lower) {
            Some((_, apart)) => out.extend(apart.iter().map(|part| Piece::Word(word((*part).to_owned(), from, to)))),
            None => out.push(Piece::Word(word(lower.to_owned(), from, to))),
        }
    }
    taken
}

/// Whether what comes says where it has gone: `until it's gone past`.
fn gone(at: &dyn Fn(usize) -> Option<char>, from: usize) -> bool {
    let next: String = (from + 1..).map_while(|k| at(k).filter(|c| c.is_alphabetic())).collect();
    matches!(next.as_str(), "gone" | "passed" | "driven" | "rolled" | "moved" | "left" | "stopped" | "come")
}

/// A word by its letters, with its place in the text.
pub(crate) fn word(text: String, from: usize, to: usize) -> Word {
    let text = mended(&text).map_or(text, str::to_owned);
    let stem = match text.as_str() {
        "robot" | "robots" | "robot's" | "it" | "its" | "itself" | "amr" | "agv" | "cobot" | "bot" | "machine"
        | "droid" => "robot".to_owned(),
        other => lexicon().stem(other),
    };
    Word {
        text,
        stem,
        from,
        to,
        used: false,
        skimmed: false,
        capital: false,
        label: false,
        after_colon: false,
        name: false,
        made_of: Vec::new(),
        called: Vec::new(),
    }
}

/// Where a phrase stands in the words at or after `start`: its first and last index, and the indices of its own words.
pub(crate) fn find<T>(
    words: &[Word],
    phrase: &Phrase<T>,
    start: usize,
    as_written: bool,
    free: &dyn Fn(usize) -> bool,
) -> Option<Vec<usize>> {
    (start..words.len()).find_map(|from| match_at(words, &phrase.items, from, as_written, free))
}

fn match_at(
    words: &[Word],
    items: &[Item],
    at: usize,
    as_written: bool,
    free: &dyn Fn(usize) -> bool,
) -> Option<Vec<usize>> {
    let Some((item, rest)) = items.split_first() else { return Some(Vec::new()) };
    match item {
        Item::Word(_) | Item::OneOf(_) => {
            let word = words.get(at)?;
            let same = if as_written {
                item.takes(&word.text)
                    || rest.is_empty() && word.text.strip_suffix('s').is_some_and(|word| item.takes(word))
            } else {
                item.takes(&word.stem)
            };
            if same && free(at) {
                let mut found = vec![at];
                found.extend(match_at(words, rest, skip_fill(words, at + 1, rest, as_written), as_written, free)?);
                Some(found)
            } else {
                None
            }
        }
        Item::Gap => (0..=4).find_map(|gap| match_at(words, rest, at + gap, as_written, free)),
    }
}

/// Articles, possessives and `being` between the words of a phrase do not break it: `blocks the way`.
fn skip_fill(words: &[Word], at: usize, rest: &[Item], as_written: bool) -> usize {
    let mut at = at;
    let Some(wanted) = rest.first().filter(|item| **item != Item::Gap) else { return at };
    let fill = |word: &Word| {
        word.label
            || word.text.ends_with("ly") && word.text.len() > 4
            || matches!(
                word.text.as_str(),
                "the"
                    | "a"
                    | "an"
                    | "their"
                    | "his"
                    | "her"
                    | "being"
                    | "has"
                    | "have"
                    | "had"
                    | "is"
                    | "are"
                    | "been"
                    | "will"
                    | "suddenly"
                    | "slowly"
                    | "quickly"
                    | "still"
                    | "very"
                    | "just"
                    | "too"
                    | "directly"
                    | "right"
                    | "straight"
                    | "simply"
                    | "quietly"
                    | "calmly"
                    | "politely"
                    | "immediately"
                    | "abruptly"
                    | "quite"
                    | "really"
                    | "completely"
                    | "then"
                    | "both"
                    | "now"
                    | "nearly"
                    | "almost"
                    | "about"
                    | "any"
                    | "another"
            )
            || !as_written && matches!(word.text.as_str(), "its" | "this" | "by" | "of" | "at" | "to")
    };
    while words.get(at).is_some_and(|word| !wanted.takes(&word.stem) && !wanted.takes(&word.text) && fill(word)) {
        at += 1;
    }
    at
}
