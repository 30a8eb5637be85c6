//! Text into sentences, clauses and words.

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
}

impl Word {
    /// The number that the word is, by digits or by name.
    pub(crate) fn number(&self) -> Option<f64> {
        self.text.parse::<f64>().ok().filter(|n| n.is_finite()).or_else(|| self.count().map(f64::from))
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
        lexicon().numbers.get(&self.text).copied().or_else(digits)
    }

    /// Whether it is written in digits.
    pub(crate) fn is_digits(&self) -> bool {
        self.text.starts_with(|c: char| c.is_ascii_digit())
    }
}

/// How a clause is joined to the one before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joint {
    /// It opens the sentence.
    Opens,
    /// Comma, `but`, `so`, `because`, brackets.
    Comma,
    /// `and`.
    And,
    /// `then`.
    Then,
    /// `while`, `whereas`.
    While,
    /// `when`, `once`, `upon`, `if`, `as`, `after` …
    When,
    /// `until`.
    Until,
    /// `who`, `that`, `which`.
    Who,
    /// `except`: of those just spoken of, not these.
    Except,
}

/// A clause: a stretch of words between two joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stretch {
    pub(crate) joint: Joint,
    /// Whether `and` stood before the joint: `…, and when it stops, …` looks ahead, not back.
    pub(crate) after_and: bool,
    pub(crate) words: Vec<Word>,
}

impl Stretch {
    /// The words of the text that it spans.
    pub(crate) fn quote<'a>(&self, text: &'a str) -> &'a str {
        let from = self.words.first().map_or(0, |word| word.from);
        let to = self.words.last().map_or(0, |word| word.to);
        text.get(from..to).unwrap_or_default()
    }
}

enum Piece {
    Word(Word),
    Comma,
    Stop,
}

/// Sentences, each as its clauses.
pub(crate) fn sentences(text: &str) -> Vec<Vec<Stretch>> {
    let mut found = Vec::new();
    let mut words: Vec<Option<Word>> = Vec::new();
    for piece in pieces(text) {
        match piece {
            Piece::Word(word) => words.push(Some(word)),
            Piece::Comma => words.push(None),
            Piece::Stop => found.push(stretches(settled(std::mem::take(&mut words)))),
        }
    }
    found.push(stretches(settled(words)));
    found.retain(|sentence| !sentence.is_empty());
    found
}

/// Words with which people take back a number that they have just given.
const CORRECTS: &[&str] = &["no", "actually", "rather", "sorry", "correction"];

/// A sentence with its corrections made (`three, no, two people` are two), and with `left` told from `left`.
fn settled(words: Vec<Option<Word>>) -> Vec<Option<Word>> {
    let count = |item: &Option<Word>| item.as_ref().is_some_and(|word| word.count().is_some());
    let mut out: Vec<Option<Word>> = Vec::with_capacity(words.len());
    let mut i = 0;
    while let Some(item) = words.get(i) {
        // A number, at most two words, then a correction and another number.
        let taken_back = count(item).then(|| {
            let corrects = |k: &usize| {
                words.get(*k).and_then(Option::as_ref).is_some_and(|word| CORRECTS.contains(&word.text.as_str()))
            };
            let at = (i + 2..i + 6).find(corrects)?;
            let paused = words.get(i + 1..at)?.iter().any(|item| item.as_ref().is_none_or(|word| word.text == "or"));
            (at + 1..at + 4).find(|k| words.get(*k).is_some_and(count)).filter(|_| paused)
        });
        if let Some(next) = taken_back.flatten() {
            i = next;
            continue;
        }
        let mut item = item.clone();
        let before = out.last().and_then(Option::as_ref).map_or("", |word| word.text.as_str());
        if let Some(word) = &mut item
            && word.text == "left"
            && matches!(
                before,
                "the"
                    | "on"
                    | "to"
                    | "its"
                    | "his"
                    | "her"
                    | "their"
                    | "from"
                    | "far"
                    | "turn"
                    | "turns"
                    | "turned"
                    | "turning"
                    | "keep"
                    | "keeps"
                    | "look"
                    | "looks"
                    | "bear"
                    | "veers"
            )
        {
            // The side, nobody who leaves.
            word.stem = "left".to_owned();
        }
        out.push(item);
        i += 1;
    }
    out
}

fn pieces(text: &str) -> Vec<Piece> {
    let chars: Vec<(usize, char)> = text.char_indices().collect();
    let at = |i: usize| chars.get(i).map(|(_, c)| *c);
    let byte = |i: usize| chars.get(i).map_or(text.len(), |(b, _)| *b);
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(c) = at(i) {
        if c.is_ascii_digit() {
            let start = i;
            let mut digits = String::new();
            while let Some(c) = at(i) {
                let between = at(i + 1).is_some_and(|d| d.is_ascii_digit());
                if c.is_ascii_digit() || c == '.' && between && !digits.contains('.') {
                    digits.push(c);
                } else if !(c == ',' && (1..=3).all(|k| at(i + k).is_some_and(|d| d.is_ascii_digit()))) {
                    break;
                }
                i += 1;
            }
            out.push(Piece::Word(word(digits, byte(start), byte(i))));
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
                ',' | ':' | '(' | ')' | '–' | '—' => out.push(Piece::Comma),
                '\n' if at(i + 1) == Some('\n') => out.push(Piece::Stop),
                '-' if at(i + 1).is_some_and(char::is_whitespace) => out.push(Piece::Comma),
                _ => {}
            }
            i += 1;
        }
    }
    out
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
        "robot" | "robots" | "robot's" | "it" | "its" | "amr" | "agv" | "cobot" => "robot".to_owned(),
        other => lexicon().stem(other),
    };
    Word { text, stem, from, to, used: false, capital: false }
}

/// Cuts a sentence (`None` is a comma) at its joints.
fn stretches(words: Vec<Option<Word>>) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    let mut open = Stretch { joint: Joint::Opens, after_and: false, words: Vec::new() };
    let mut i = 0;
    while let Some(item) = words.get(i) {
        let (joint, took) = match item {
            None => (Some(Joint::Comma), 1),
            Some(_) => joint_at(&words, i),
        };
        if let Some(joint) = joint {
            let done = std::mem::replace(&mut open, Stretch { joint, after_and: false, words: Vec::new() });
            if done.words.is_empty() {
                open.after_and = done.after_and || done.joint == Joint::And && joint != Joint::And;
                // `, and when`: the stronger joint stays; a sentence that opens with `when` is known by its index.
                if matches!(joint, Joint::Comma | Joint::And)
                    && !matches!(done.joint, Joint::Opens | Joint::Comma | Joint::And)
                {
                    open.joint = done.joint;
                }
            } else {
                found.push(done);
            }
        } else {
            open.words.extend(item.clone());
        }
        i += took;
    }
    if !open.words.is_empty() {
        found.push(open);
    }
    found
}

fn joint_at(words: &[Option<Word>], i: usize) -> (Option<Joint>, usize) {
    let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
    let stem = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.stem.as_str());
    let sees = |k: usize| matches!(stem(k), "see" | "notice" | "spot");
    let before = if i == 0 { "" } else { stem(i - 1) };
    let person = lexicon().roles.contains_key(before) || matches!(before, "one" | "other" | "two" | "three");
    let digit = words.get(i + 1).and_then(Option::as_ref).is_some_and(|word| word.number().is_some());
    match text(i) {
        "and" => (Some(Joint::And), 1),
        "but" if before == "all" => (None, 1),
        "except" | "apart" if matches!(text(i + 1), "for" | "from") => (Some(Joint::Except), 2),
        "besides" => (Some(Joint::Except), 1),
        "other" | "rather" if text(i + 1) == "than" && text(i.wrapping_sub(1)) != "each" && text(i) == "other" => {
            (Some(Joint::Except), 2)
        }
        "except" => (Some(Joint::Except), 1),
        "but" | "so" | "because" | "since" | "although" | "though" | "however" => (Some(Joint::Comma), 1),
        "then" | "afterwards" => (Some(Joint::Then), 1),
        "while" | "whereas" if before != "a" => (Some(Joint::While), 1),
        "as" if text(i + 1) == "soon" => (Some(Joint::When), 3),
        "as" if matches!(text(i + 1), "they" | "he" | "she" | "it")
            || stem(i + 1) == "robot"
            || stem(i + 2) == "robot" =>
        {
            (Some(Joint::When), 1)
        }
        "when" | "whenever" | "upon" | "if" => (Some(Joint::When), 1),
        "once" if i == 0 || !text(i + 1).is_empty() && !before.is_empty() => (Some(Joint::When), 1),
        "on" | "after" if sees(i + 1) => (Some(Joint::When), 1),
        // `one after another`, `one after the other` is a manner.
        "after" if before == "one" && (text(i + 1) == "another" || text(i + 2) == "other") => (None, 1),
        "after" | "before" if !digit && !matches!(text(i + 1), "a" | "half") => (Some(Joint::When), 1),
        "until" | "till" => (Some(Joint::Until), 1),
        "who" | "whom" | "which" => (Some(Joint::Who), 1),
        "that" if person => (Some(Joint::Who), 1),
        _ => (None, 1),
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
        Item::Word(wanted) => {
            let word = words.get(at)?;
            let same = if as_written {
                word.text == *wanted || rest.is_empty() && word.text.strip_suffix('s') == Some(wanted)
            } else {
                word.stem == *wanted
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
    let wanted = match rest.first() {
        Some(Item::Word(wanted)) => wanted.as_str(),
        Some(Item::Gap) | None => return at,
    };
    let fill = |word: &Word| {
        matches!(
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
        ) || !as_written && matches!(word.text.as_str(), "its" | "this" | "by" | "of" | "at" | "to")
    };
    while words.get(at).is_some_and(|word| word.stem != wanted && word.text != wanted && fill(word)) {
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuts(text: &str) -> Vec<(Joint, String)> {
        sentences(text).into_iter().flatten().map(|s| (s.joint, s.quote(text).to_owned())).collect()
    }

    #[test]
    fn a_sentence_is_cut_at_commas_and_joining_words() {
        let cut = cuts("Two leave, and one stays when it sees the robot. Done!");
        assert_eq!(
            cut,
            [
                (Joint::Opens, "Two leave".to_owned()),
                (Joint::And, "one stays".to_owned()),
                (Joint::When, "it sees the robot".to_owned()),
                (Joint::Opens, "Done".to_owned()),
            ]
        );
    }

    #[test]
    fn numbers_units_and_apostrophes_are_taken_apart() {
        let words: Vec<String> = sentences("within 1.5m, 10,000 people don't; human_2's")
            .into_iter()
            .flatten()
            .flat_map(|s| s.words)
            .map(|w| w.text)
            .collect();
        assert_eq!(words, ["within", "1.5", "m", "10000", "people", "do", "not", "human", "2"]);
    }

    #[test]
    fn any_text_is_cut_without_breaking() {
        for text in ["", "…", "'''", "1.2.3,,,4", "ß’t né", "\u{202e}and and and", "- -- —"] {
            let _cut = sentences(text);
        }
    }
}
