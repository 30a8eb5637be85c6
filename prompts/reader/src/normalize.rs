//! Pass 2: scope and normal forms, by the rows of `scopes.toml` and `rewrites.toml`.
//!
//! ```text
//! I want to see whether | a nurse stops | the moment ─► when | she sees it
//! └ background: comment ┘
//! ```

use std::ops::Range;

use socrates_model::statement::Background;

use crate::lexicon::Lexicon;
use crate::pattern::{Part, Pattern, Patterns};
use crate::rows::Extent;
use crate::token::{Bent, Kind, Mark, Sort, Token};
use crate::words::Words;

/// Tokens of the scene, and what stands beside it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Scene {
    /// What is said of the scene, in normal words.
    pub(crate) tokens: Vec<Token>,
    /// What asks for nothing, by its bytes, and why.
    pub(crate) background: Vec<(Range<usize>, Background)>,
}

/// Splits tokens into scene and background, and puts normal words in the place of others.
pub(crate) fn normalize(tokens: Vec<Token>, lexicon: &Lexicon) -> Scene {
    scoped(rewritten(tokens, lexicon), lexicon)
}

/// The end of the longest of some patterns that match tokens from a place on, and its row.
fn longest(tokens: &[Token], at: usize, patterns: &Patterns, may: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    let first = tokens.get(at).filter(|token| token.is_said())?;
    patterns
        .beginning(&first.lemma)
        .chain(patterns.beginning(&first.spelled).filter(|_| first.spelled != first.lemma))
        .filter(|pattern| may(pattern.row))
        .filter_map(|pattern| Some((end_of(tokens, at, pattern)?, pattern.row)))
        .max_by_key(|(end, row)| (*end, std::cmp::Reverse(*row)))
}

/// Where a pattern of words ends that begins at a token; articles may stand between.
pub(crate) fn end_of(tokens: &[Token], at: usize, pattern: &Pattern) -> Option<usize> {
    let mut here = at;
    for (number, slot) in pattern.slots.iter().enumerate() {
        let fits = |token: Option<&Token>| {
            token.is_some_and(|token| match &slot.part {
                Part::Word(words) => {
                    token.is_said() && (words.contains(&token.lemma) || words.contains(&token.spelled))
                }
                // Among words alone an amount is a number, or the letter of a list.
                Part::Amount => token.number().is_some() || token.spelled.len() == 1 && token.is_said(),
                Part::Anybody | Part::Robot | Part::Person | Part::Somebody | Part::Whose | Part::Place => false,
            })
        };
        let article = |token: Option<&Token>| {
            token.is_some_and(|token| token.is(Sort::Indefinite) || token.is(Sort::Definite) && !token.is(Sort::Who))
        };
        if fits(tokens.get(here)) {
            here += 1;
        } else if number > 0 && article(tokens.get(here)) && fits(tokens.get(here + 1)) {
            here += 2;
        } else if !slot.optional {
            return None;
        }
    }
    Some(here)
}

fn rewritten(tokens: Vec<Token>, lexicon: &Lexicon) -> Vec<Token> {
    let mut out = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        let found = longest(&tokens, at, &lexicon.rewrite_patterns, |_| true);
        let Some((end, row)) = found else {
            out.push(token.clone());
            at += 1;
            continue;
        };
        let whole = token.at.start..tokens.get(end - 1).map_or(token.at.end, |last| last.at.end);
        let becomes = lexicon.rewrites.get(row).map_or("", |row| row.becomes.as_str());
        for word in becomes.split_whitespace() {
            let put = crate::lex::lex(word, &lexicon.words).into_iter();
            out.extend(put.map(|token| Token { at: whole.clone(), ..token }));
        }
        at = end;
    }
    out
}

fn scoped(tokens: Vec<Token>, lexicon: &Lexicon) -> Scene {
    let mut scene = Scene::default();
    let mut at = 0;
    // Where the sentence begins, in the scene and among the tokens.
    let (mut kept, mut first) = (0, 0);
    while let Some(token) = tokens.get(at) {
        // What is asked of the program has no ending: `gives way` is no request.
        let begins = at == first && token.bent == Bent::Base;
        let may = |row: usize| lexicon.scopes.get(row).is_some_and(|row| !row.first || begins);
        let row = longest(&tokens, at, &lexicon.scope_patterns, may)
            .and_then(|(end, row)| Some((end, lexicon.scopes.get(row)?)));
        if let Some((end, row)) = row {
            let end = match row.extent {
                Extent::Words | Extent::Lead => end,
                Extent::Clause => clause_end(&tokens, end, &lexicon.words),
                Extent::Sentence => ends(&tokens, end, |token| token.is_mark(Mark::Stop)),
            };
            let tells = |token: &Token| {
                token.is(Sort::Robot) || lexicon.place_patterns.beginning(&token.lemma).next().is_some()
            };
            let leads = row.extent == Extent::Lead && !scene.tokens.iter().skip(kept).any(tells);
            let from = if row.extent == Extent::Sentence || leads {
                scene.tokens.truncate(kept);
                first
            } else {
                at
            };
            let whole =
                tokens.get(from).map_or(0, |token| token.at.start)..tokens.get(end - 1).map_or(0, |token| token.at.end);
            scene.background.push((whole, row.reason));
            if at == first {
                first = end;
            }
            // `because two operators cross`: what is told of somebody who is new is a clause of its own.
            let own = row.extent == Extent::Clause && tokens.get(end).is_some_and(Token::is_said);
            let comma = tokens.get(at).filter(|_| own && at > 0 && tokens.get(at - 1).is_none_or(Token::is_said));
            scene.tokens.extend(comma.map(|because| Token { kind: Kind::Mark(Mark::Comma), ..because.clone() }));
            at = end;
            continue;
        }
        scene.tokens.push(token.clone());
        at += 1;
        if token.is_mark(Mark::Stop) {
            (kept, first) = (scene.tokens.len(), at);
        } else if at == first + 1 && !token.is_said() {
            // A comma after words that ask for nothing: the sentence begins behind it.
            first = at;
        }
    }
    scene
}

/// Where a clause ends that asks for nothing: before a mark, and before what somebody does after it: `because he is late and stops`.
/// It ends at once where it tells of somebody new, who is there.
fn clause_end(tokens: &[Token], from: usize, words: &Words) -> usize {
    let acts = |at: usize| tokens.get(at + 1).is_some_and(|next| next.is(Sort::Verb) && next.bent == Bent::S);
    let marked = |token: &Token| matches!(token.kind, Kind::Mark(mark) if mark != Mark::Quote);
    let end = ends(tokens, from, marked);
    let joined = (from..end).find(|at| tokens.get(*at).is_some_and(|token| token.is(Sort::And)) && acts(*at));
    let said = tokens.get(from..end).unwrap_or_default();
    let one = |token: &Token| {
        token.is(Sort::Indefinite) || words.numbers.contains_key(&token.lemma) || token.number().is_some()
    };
    let new = said.iter().position(one).is_some_and(|at| said.iter().skip(at).any(|token| token.is(Sort::Role)));
    // Nor is what somebody says.
    let quoted = said.iter().any(|token| token.is_mark(Mark::Quote));
    if new || quoted { from } else { joined.unwrap_or(end) }
}

fn ends(tokens: &[Token], from: usize, is: impl Fn(&Token) -> bool) -> usize {
    (from..tokens.len()).find(|at| tokens.get(*at).is_some_and(&is)).unwrap_or(tokens.len())
}
