//! Pass 1: text to tokens.
//!
//! ```text
//! "doesn't stop at 2m." ─► does/do n't/not stop at #2 m <Stop>
//! ```

use unicode_segmentation::UnicodeSegmentation as _;

use crate::token::{Bent, Kind, Mark, OWNS, Sort, Token};
use crate::words::Words;

/// What stands for what it is short of: the rest of a word after its apostrophe.
const SHORT: &[(&str, &str)] =
    &[("n't", "not"), ("'re", "be"), ("'m", "be"), ("'ll", "will"), ("'ve", "have"), ("'d", "would")];
/// Words of fewer letters are not corrected.
const CORRECTED_FROM: usize = 5;

/// Cuts a text into tokens.
pub(crate) fn lex(text: &str, words: &Words) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    for (start, piece) in text.split_word_bound_indices() {
        if piece.chars().next().is_some_and(char::is_alphanumeric) {
            word(start, piece, words, &mut tokens);
        } else {
            marks(start, piece, text, words, &mut tokens);
        }
    }
    unnumbered(corrected(summed(tokens, words), words), words)
}

/// The tokens with `forty-five` and `forty five` as one number.
fn summed(tokens: Vec<Token>, words: &Words) -> Vec<Token> {
    let named = |token: &Token| words.numbers.get(&token.lemma).copied().filter(|_| token.is_said());
    let mut all: Vec<Token> = Vec::with_capacity(tokens.len());
    for token in tokens {
        let ones = named(&token).filter(|number| (1..10).contains(number));
        let tens = all.last().and_then(named).filter(|number| *number >= 20 && number % 10 == 0);
        match (tens.zip(ones), all.last_mut()) {
            (Some((tens, ones)), Some(last)) => {
                last.kind = Kind::Number(f64::from(tens + ones));
                last.at.end = token.at.end;
            }
            _ => all.push(token),
        }
    }
    all
}

/// The tokens with a number that was taken back later: `three visitors sitting there, no, two.`
fn corrected(mut tokens: Vec<Token>, words: &Words) -> Vec<Token> {
    let counts = |token: &Token| token.number().is_some() || words.numbers.contains_key(&token.lemma);
    let mut at = 0;
    while at < tokens.len() {
        let is = |at: usize, test: &dyn Fn(&Token) -> bool| tokens.get(at).is_some_and(test);
        let marks =
            is(at, &|token| token.is_mark(Mark::Comma) || token.is_mark(Mark::Dash) || token.is_mark(Mark::Stop));
        let behind = (at + 1..at + 5).find(|next| !is(*next, &|token| token.is(Sort::Regret))).unwrap_or(at + 5);
        let meant = behind + usize::from(is(behind, &|token| token.is_mark(Mark::Comma)));
        let alone = tokens.get(meant + 1).is_none_or(|next| !next.is_said());
        let old = (0..at).rev().find(|old| is(*old, &counts));
        // `two porters, no wait, three porters`
        let role = |token: &&Token| token.is(Sort::Role) || token.is(Sort::People);
        let noun = |at: usize| tokens.get(at + 1).filter(role).map(|token| token.lemma.as_str());
        if let Some(old) = old.filter(|old| {
            marks && behind > at + 1 && is(meant, &counts) && noun(meant).is_some_and(|own| noun(*old) == Some(own))
        }) {
            tokens.drain(old..meant);
            at = old + 1;
            continue;
        }
        match old.filter(|_| marks && behind > at + 1 && is(meant, &counts) && alone && meant <= at + 5) {
            Some(old) if old + 1 < at => {
                let new = tokens.get(meant).cloned();
                if let (Some(new), Some(own)) = (new, tokens.get_mut(old)) {
                    *own = Token { at: own.at.clone(), ..new };
                }
                tokens.drain(at..=meant);
            }
            Some(_) | None => at += 1,
        }
    }
    tokens
}

/// The tokens without the numbers of a list: `1. The robot …`.
fn unnumbered(tokens: Vec<Token>, words: &Words) -> Vec<Token> {
    let stops =
        |token: Option<&Token>| token.is_none_or(|token| token.is_mark(Mark::Stop) || token.is_mark(Mark::Colon));
    let close =
        |token: Option<&Token>| token.is_some_and(|token| token.is_mark(Mark::Stop) || token.is_mark(Mark::Close));
    let of_list = |at: usize| {
        let before = at.checked_sub(1).and_then(|before| tokens.get(before));
        tokens.get(at).is_some_and(|token| token.number().is_some()) && stops(before) && close(tokens.get(at + 1))
    };
    let number = |at: usize| tokens.get(at).is_some_and(|token| token.number().is_some());
    let touch =
        |at: usize| tokens.get(at).zip(tokens.get(at + 1)).is_some_and(|(one, next)| one.at.end == next.at.start);
    // `14:00` is a time of day.
    let clock = |at: usize| {
        number(at)
            && number(at + 2)
            && touch(at)
            && touch(at + 1)
            && tokens.get(at + 1).is_some_and(|token| token.is_mark(Mark::Colon))
    };
    let of_clock = |at: usize| (0..3).any(|back| at.checked_sub(back).is_some_and(clock));
    // `three, no, two`
    let counts = |at: usize| number(at) || tokens.get(at).is_some_and(|token| words.numbers.contains_key(&token.lemma));
    // The number taken back, a mark, words of regret, perhaps a mark again, and the number that is meant.
    let regrets = |at: usize| tokens.get(at).is_some_and(|token| token.is(Sort::Regret));
    let taken_back = |at: usize| -> usize {
        if !counts(at) || tokens.get(at + 1).is_none_or(Token::is_said) || !regrets(at + 2) {
            return 0;
        }
        let behind = (at + 2..at + 6).find(|next| !regrets(*next)).unwrap_or(at + 6);
        let meant = behind + usize::from(tokens.get(behind).is_some_and(|token| token.is_mark(Mark::Comma)));
        if counts(meant) { meant - at } else { 0 }
    };
    let of_correction = |at: usize| (0..7).any(|back| at.checked_sub(back).is_some_and(|from| taken_back(from) > back));
    let keep: Vec<bool> = (0..tokens.len())
        .map(|at| {
            !of_clock(at)
                && !of_list(at)
                && !at.checked_sub(1).is_some_and(|before| of_list(before) && !of_clock(before))
                && !of_correction(at)
        })
        .collect();
    tokens.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(token, _)| token).collect()
}

/// A word of the alphabet, or a number with what is stuck to it: `2m`, `doesn't`, `robot's`.
fn word(start: usize, piece: &str, words: &Words, tokens: &mut Vec<Token>) {
    let lower = piece.to_lowercase().replace('\u{2019}', "'");
    let digits = lower.find(|c: char| !c.is_ascii_digit() && c != '.' && c != ',').unwrap_or(lower.len());
    if digits > 0 {
        let number = lower.get(..digits).unwrap_or_default().replace(',', ".");
        if let Ok(number) = number.parse::<f64>() {
            tokens.push(token(
                start..start + digits,
                piece.get(..digits).unwrap_or_default(),
                Kind::Number(number),
                words,
            ));
            if digits < piece.len() {
                let rest = piece.get(digits..).unwrap_or_default();
                tokens.push(token(start + digits..start + piece.len(), rest, Kind::Word, words));
            }
            return;
        }
    }
    // The byte lengths differ where an apostrophe is a curly one: only the end is cut, and it is found in the piece itself.
    let short =
        SHORT.iter().map(|(end, _)| *end).chain([OWNS]).find(|end| lower.ends_with(end) && lower.len() > end.len());
    let Some(end) = short else {
        tokens.push(token(start..start + piece.len(), piece, Kind::Word, words));
        return;
    };
    let cut = piece.char_indices().rev().nth(end.chars().count() - 1).map_or(piece.len(), |(at, _)| at);
    tokens.push(token(start..start + cut, piece.get(..cut).unwrap_or_default(), Kind::Word, words));
    let mut tail = token(start + cut..start + piece.len(), end, Kind::Word, words);
    if let Some((_, whole)) = SHORT.iter().find(|(short, _)| *short == end) {
        tail.lemma = (*whole).to_owned();
        tail.sorts = words.sorts(whole);
    }
    tokens.push(tail);
}

fn marks(start: usize, piece: &str, text: &str, words: &Words, tokens: &mut Vec<Token>) {
    let before = text.get(..start).unwrap_or_default();
    let after = text.get(start + piece.len()..).unwrap_or_default();
    let apart = before.ends_with(' ') && after.starts_with(' ');
    let mark = match piece.chars().next() {
        Some(',') => Mark::Comma,
        Some('.' | '!' | '?' | '\n' | '\r' | ';' | '…' | '|') => Mark::Stop,
        Some(':' | '=') => Mark::Colon,
        Some('–' | '—') => Mark::Dash,
        Some('-') if after.starts_with('>') => Mark::Arrow,
        Some('-') if apart || before.is_empty() || before.ends_with('\n') => Mark::Dash,
        Some('→') => Mark::Arrow,
        Some('(' | '[') => Mark::Open,
        Some(')' | ']') => Mark::Close,
        Some('"' | '“' | '”' | '„' | '«' | '»') => Mark::Quote,
        Some('\'' | '‘' | '’' | '`')
            if !before.ends_with(char::is_alphanumeric) || !after.starts_with(char::is_alphanumeric) =>
        {
            Mark::Quote
        }
        Some('<' | '+' | '&' | '@' | '#') => {
            tokens.push(Token {
                at: start..start + piece.len(),
                spelled: piece.to_owned(),
                lemma: words.base(piece).0,
                kind: Kind::Word,
                sorts: words.sorts(&words.base(piece).0),
                bent: Bent::Base,
                capital: false,
            });
            return;
        }
        _ => return,
    };
    // `the nurses' station` has no quote in it.
    let quotes = tokens.iter().filter(|token| token.is_mark(Mark::Quote)).count();
    if mark == Mark::Quote && matches!(piece, "'" | "’") && before.ends_with('s') && quotes.is_multiple_of(2) {
        return;
    }
    // `Dr. Meyer` is one sentence.
    if mark == Mark::Stop && piece == "." && tokens.last().is_some_and(|last| last.is(Sort::Title)) {
        return;
    }
    // `...` and a line's end after a full stop are one.
    if mark == Mark::Stop && tokens.last().is_none_or(|last| last.is_mark(Mark::Stop)) {
        return;
    }
    let kind = Kind::Mark(mark);
    tokens.push(Token {
        at: start..start + piece.len(),
        spelled: piece.to_owned(),
        lemma: piece.to_owned(),
        kind,
        sorts: crate::token::Sorts::default(),
        bent: Bent::Base,
        capital: false,
    });
}

/// A word as a token, in its base form; a slip of the pen is read as the word that was meant.
pub(crate) fn token(at: std::ops::Range<usize>, piece: &str, kind: Kind, words: &Words) -> Token {
    let text = piece.to_lowercase().replace('\u{2019}', "'");
    let (mut lemma, bent) = words.base(&text);
    let mut sorts = words.sorts(&text);
    sorts = sorts.and(words.sorts(&lemma));
    let strange = kind == Kind::Word && lemma == text && sorts.is_empty() && text.len() >= CORRECTED_FROM;
    let mut bent = bent;
    let unknown = kind == Kind::Word && sorts.is_empty() && text.len() >= CORRECTED_FROM && !words.knows_bent(&text);
    if let Some(meant) = meant(&text, words).filter(|_| strange) {
        (lemma, bent) = words.base(&meant);
        sorts = words.sorts(&lemma);
    } else if unknown {
        let mut stems = Words::stems(&text).filter(|(stem, _)| stem.len() >= CORRECTED_FROM);
        if let Some((stem, of)) = stems.find_map(|(stem, bent)| Some((meant(&stem, words)?, bent))) {
            (lemma, bent) = (words.base(&stem).0, of);
            sorts = words.sorts(&lemma);
        }
    }
    let capital = piece.chars().next().is_some_and(char::is_uppercase) && piece.chars().skip(1).all(char::is_lowercase);
    Token { at, spelled: text, lemma, kind, sorts, bent, capital }
}

/// The known word of which another is a slip of the pen: two letters swapped, or one letter doubled or lost.
fn meant(text: &str, words: &Words) -> Option<String> {
    if words.knows_bent(text) {
        return None;
    }
    let first = text.chars().next()?;
    let near = |known: &&str| {
        known.len().abs_diff(text.len()) <= 1 && strsim::osa_distance(known, text) == 1 && swapped_or_lost(known, text)
    };
    words.long(first, CORRECTED_FROM).find(near).map(str::to_owned)
}

/// Not a letter in place of another: `patent` is no `patient`, `coridor` is a `corridor`.
fn swapped_or_lost(known: &str, text: &str) -> bool {
    let sorted = |word: &str| {
        let mut letters: Vec<char> = word.chars().collect();
        letters.sort_unstable();
        letters
    };
    let squeezed = |word: &str| {
        let mut letters: Vec<char> = word.chars().collect();
        letters.dedup();
        letters
    };
    // `lecture` is no `lecturer`.
    let lost = known.len() == text.len() + 1 && text.len() > CORRECTED_FROM && !known.starts_with(text);
    // `docter`
    let other = || known.chars().zip(text.chars()).filter(|(one, other)| one != other);
    let vowels = |(one, other): (char, char)| "aeiou".contains(one) && "aeiou".contains(other);
    let vowel =
        known.len() == text.len() && known.len() > CORRECTED_FROM && other().count() == 1 && other().all(vowels);
    // `visitior`
    let more = known.len() + 1 == text.len() && known.len() > CORRECTED_FROM + 1;
    sorted(known) == sorted(text) || squeezed(known) == squeezed(text) || lost || more || vowel
}
