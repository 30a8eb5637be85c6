//! Words into sentences and clauses.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, pieces};

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
