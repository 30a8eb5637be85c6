//! A text as its words, clauses and sentences: only where they stand, nothing of what they mean.

use std::ops::Range;

/// One word of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    /// Where it stands, in bytes.
    pub(super) at: Range<usize>,
    /// In lower case.
    pub(super) lower: String,
    /// Number of its clause in the text.
    pub(super) clause: usize,
    /// Number of its sentence in the text.
    pub(super) sentence: usize,
}

/// Words before which a clause begins.
const OPENERS: &[&str] = &[
    "and", "but", "then", "who", "which", "that", "when", "whenever", "while", "until", "till", "after", "before",
    "because", "so", "if", "unless", "once", "as", "since", "whereas", "although", "though", "where", "whether", "or",
];

/// Short forms after which a full stop ends no sentence.
const SHORT: &[&str] =
    &["mr", "mrs", "ms", "dr", "prof", "approx", "ca", "e.g", "i.e", "no", "vs", "resp", "incl", "max", "min"];

/// The words of a text in order, each with the clause and the sentence that it is in.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut found: Vec<Token> = Vec::new();
    let (mut clause, mut sentence, mut last) = (0, 0, 0);
    for at in words(text) {
        let gap = text.get(last..at.start).unwrap_or_default();
        let lower = text.get(at.clone()).unwrap_or_default().to_lowercase();
        let short = found.last().is_some_and(|word| SHORT.contains(&word.lower.as_str()));
        let ends = gap.contains(['!', '?', ';']) || gap.contains("\n\n") || gap.contains('.') && !short;
        let marked = gap.contains([',', ':', '(', ')', '[', ']', '–', '—', '|', '\n', '"', '“', '”', '→', '>'])
            || gap.contains(" - ");
        // A clause has more than one word, or it is part of the next one: `and then`, `but when`.
        let alone = found
            .iter()
            .rev()
            .take_while(|word| word.clause == clause)
            .all(|word| OPENERS.contains(&word.lower.as_str()));
        if !found.is_empty() {
            sentence += usize::from(ends);
            clause += usize::from(ends || !alone && (marked || OPENERS.contains(&lower.as_str())));
        }
        last = at.end;
        found.push(Token { at, lower, clause, sentence });
    }
    found
}

/// Where the words stand: runs of letters and digits, with what joins them inside: `doesn't`, `head-on`, `0.6`, `human_2`.
fn words(text: &str) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut open: Option<usize> = None;
    let chars: Vec<(usize, char)> = text.char_indices().collect();
    for (place, (at, c)) in chars.iter().enumerate() {
        let before = place.checked_sub(1).and_then(|k| chars.get(k)).map(|(_, c)| *c);
        let next = chars.get(place + 1).map(|(_, c)| *c);
        let alike = |test: fn(char) -> bool| before.is_some_and(test) && next.is_some_and(test);
        let joins = match c {
            '\'' | '’' | '-' | '_' => alike(char::is_alphanumeric),
            '.' | ',' => alike(|c| c.is_ascii_digit()),
            other => other.is_alphanumeric(),
        };
        match (joins, open) {
            (true, None) => open = Some(*at),
            (false, Some(from)) => {
                found.push(from..*at);
                open = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }
    found.extend(open.map(|from| from..text.len()));
    found
}

/// The text with some of its words exchanged for one that nobody knows.
pub(super) fn masked(text: &str, tokens: &[Token], hidden: &dyn Fn(usize) -> bool) -> String {
    let mut out = String::with_capacity(text.len());
    let mut last = 0;
    for (place, token) in tokens.iter().enumerate() {
        if !hidden(place) {
            continue;
        }
        out.push_str(text.get(last..token.at.start).unwrap_or_default());
        out.push_str(&stranger(&token.lower));
        last = token.at.end;
    }
    out.push_str(text.get(last..).unwrap_or_default());
    out
}

/// A word that no table has, with the ending of this one, so that a sentence keeps its form.
fn stranger(word: &str) -> String {
    let endings = ["ing", "ly", "ed", "s"];
    let end = endings.into_iter().find(|end| word.len() > end.len() + 1 && word.ends_with(end)).unwrap_or_default();
    format!("qzxv{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clauses_and_sentences_are_told_apart() {
        let text = "A nurse, who hurries, crosses at 0.6 m/s and then stops. Dr. Weiss doesn't look.";
        let tokens = tokens(text);
        let clauses: Vec<String> = (0..=tokens.last().unwrap().clause)
            .map(|n| tokens.iter().filter(|t| t.clause == n).map(|t| t.lower.as_str()).collect::<Vec<_>>().join(" "))
            .collect();
        assert_eq!(
            clauses,
            ["a nurse", "who hurries", "crosses at 0.6 m s", "and then stops", "dr weiss doesn't look"]
        );
        assert_eq!(tokens.last().unwrap().sentence, 1);
        assert_eq!(masked("She stops.", &super::tokens("She stops."), &|n| n == 1), "She qzxvs.");
    }
}
