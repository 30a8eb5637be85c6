//! Text into words and marks, and where phrases stand in them.

use crate::lexicon::{Item, Phrase, lexicon};

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
    /// Whether it is written with a capital letter.
    pub(crate) capital: bool,
    /// A number that names something (`case 14`), or a word that only describes the robot: read by nobody.
    pub(crate) label: bool,
    /// Whether a colon stands right before it.
    pub(crate) after_colon: bool,
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
            out.push(Piece::Word(Word { label: clock, ..word(digits, byte(start), byte(i)) }));
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
                '.' | '!' | '?' | ';' => out.push(Piece::Stop),
                ':' => out.push(Piece::Colon),
                ',' | '(' | ')' | '[' | ']' | '–' | '—' | '•' => out.push(Piece::Comma),
                '\n' if at(i + 1) == Some('\n') => out.push(Piece::Stop),
                '-' if at(i + 1).is_some_and(char::is_whitespace) => out.push(Piece::Comma),
                _ => {}
            }
            i += 1;
        }
    }
    crate::again::joined(out)
}

/// Pushes a word and what its apostrophe hides (`don't` is `do not`, `robot's` is `robot`); says how many characters it took.
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
        let verb = lower.strip_suffix('n').filter(|verb| *verb != "ca").unwrap_or("can");
        out.push(Piece::Word(word(verb.to_owned(), from, to)));
        out.push(Piece::Word(word("not".to_owned(), from, to)));
    } else {
        match JOINED.iter().find(|(joined, _)| *joined == lower) {
            Some((_, apart)) => out.extend(apart.iter().map(|part| Piece::Word(word((*part).to_owned(), from, to)))),
            None => out.push(Piece::Word(word(lower.to_owned(), from, to))),
        }
    }
    taken
}

/// Words that people write together.
const JOINED: &[(&str, &[&str])] = &[("infront", &["in", "front"]), ("eachother", &["each", "other"])];

/// The word that was meant by a slip of the pen: the only one of the tables that is one letter away.
///
/// Short words and words that start otherwise are left alone: a slip is guessed, never a meaning.
fn mended(text: &str) -> Option<&'static str> {
    let lex = lexicon();
    let long = text.chars().count() >= 6;
    if !long
        || lex.telling.contains(text)
        || lex.known.contains(text)
        || lex.known.contains(&lex.stem(text))
        || lex.adjectives.contains(text)
    {
        return None;
    }
    let near = |word: &&String| {
        word.chars().count() >= 6 && word.chars().next() == text.chars().next() && strsim::osa_distance(word, text) == 1
    };
    let mut found = lex.telling.iter().filter(near);
    let only = found.next()?;
    if found.next().is_some() { None } else { Some(only) }
}

fn word(text: String, from: usize, to: usize) -> Word {
    let text = mended(&text).map_or(text, str::to_owned);
    let stem = match text.as_str() {
        "robot" | "robots" | "robot's" | "it" | "its" | "itself" | "amr" | "agv" | "cobot" | "bot" | "machine"
        | "droid" => "robot".to_owned(),
        other => lexicon().stem(other),
    };
    Word { text, stem, from, to, used: false, capital: false, label: false, after_colon: false }
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
