//! Edits in words: what an edit asks for, by the rows of `edits.toml`, and whom it means. What people do is read as any other text
//! ([`crate::Reader::read_of`]).
//!
//! ```text
//! Make the robot's path longer and remove the visitor ─► Longer "Make the robot's path longer" · Remove "remove the visitor"
//! ```

use std::ops::Range;

use socrates_model::PlaceClass;

use crate::cast::{Cast, People};
use crate::chunk::{Amount, Chunk, Is, chunks};
use crate::find::longest;
use crate::lexicon::Lexicon;
use crate::noun::{Head, Noun, Pick};
use crate::rows::{Edit, EditRow};
use crate::token::{Mark, Sort, Token};
use crate::words::Words;

/// One wish of an edit.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// What it asks for.
    pub edit: Edit,
    /// Its words, in bytes.
    pub at: Range<usize>,
    /// Where, if it says.
    pub place: Option<PlaceClass>,
    /// How many meters, if it says.
    pub meters: Option<f64>,
    /// Whether it speaks of another place of the same kind.
    pub other: bool,
    /// Whether it speaks of somebody or something more.
    pub adds: bool,
    /// Whether it means everybody.
    pub everybody: bool,
    /// Whether it speaks of a group.
    pub group: bool,
}

/// The people that words mean, of people who are known.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Whom {
    /// The people, by their numbers from 0, in the order of the words.
    pub people: People,
    /// Whether the robot is named.
    pub robot: bool,
    /// Whether one of several is spoken of so that it may be anybody: `she`, `the man`, where nobody is called so.
    pub guess: bool,
}

/// The wishes of an edit, in order.
pub(crate) fn wishes(text: &str, lexicon: &Lexicon) -> Vec<Wish> {
    let tokens = crate::lex::lex(&unjoined(text), &lexicon.words);
    let joins = |token: &Token| {
        token.is_mark(Mark::Comma) || [Sort::And, Sort::Then, Sort::But].iter().any(|sort| token.is(*sort))
    };
    let mut found: Vec<Part<'_>> = Vec::new();
    for sentence in split(&tokens, 0..tokens.len(), |token| token.is_mark(Mark::Stop)) {
        let first = found.len();
        for range in split(&tokens, sentence, joins) {
            let own = Part::of(&tokens, range, lexicon);
            match found.pop_if(|before| before.number >= first && before.goes_on(&own)) {
                Some(before) => {
                    found.push(Part {
                        number: before.number,
                        ..Part::of(&tokens, before.range.start..own.range.end, lexicon)
                    });
                }
                None => found.push(Part { number: found.len(), ..own }),
            }
        }
    }
    found.iter().filter(|part| !part.only_asks()).map(Part::wish).collect()
}

/// The people that words mean, of people of these roles, of whom some were spoken of last.
pub(crate) fn whom(text: &str, known: &[String], last: &[usize], lexicon: &Lexicon) -> Whom {
    let tokens = crate::lex::lex(&unjoined(text), &lexicon.words);
    let mut cast = Cast::of(known, last, lexicon);
    let mut whom = Whom::default();
    for chunk in chunks(&tokens, lexicon) {
        let (noun, owns) = match chunk.is {
            Is::Noun(noun) => (noun, false),
            Is::Whose(noun) => (noun, true),
            Is::Place(_) | Is::Amount(_) | Is::Mark(_) | Is::Word => continue,
        };
        match noun.head {
            Head::Robot => whom.robot = true,
            Head::It => whom.robot |= owns,
            Head::He | Head::They | Head::Who | Head::Role(_) | Head::Name(_) | Head::Bare
                if noun.group || noun.pick == Pick::None => {}
            Head::He | Head::They | Head::Who | Head::Role(_) | Head::Name(_) | Head::Bare => {
                whom.guess |= is_guess(&noun, &cast, known);
                let before = cast.clone();
                let meant = cast.people(&vec![noun]);
                // Nobody is called so.
                if cast.roles.len() > known.len() {
                    cast = before;
                    continue;
                }
                for person in meant {
                    if !whom.people.contains(&person) {
                        whom.people.push(person);
                    }
                }
            }
        }
    }
    whom
}

/// Whether one of several is spoken of as a man or a woman, and nobody was, nor is called so.
fn is_guess(noun: &Noun, cast: &Cast, known: &[String]) -> bool {
    let several = known.len() > 1;
    match &noun.head {
        Head::He => several && cast.last.is_empty(),
        Head::Role(role) => {
            let one = noun.pick == Pick::The && !noun.several && noun.ordinal.is_none();
            several && one && noun.by_looks && !cast.roles.contains(role)
        }
        Head::Robot | Head::It | Head::They | Head::Who | Head::Name(_) | Head::Bare => false,
    }
}

/// `human_2` as `human 2`, so that it is a word and a number.
pub(crate) fn unjoined(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (at, letter) in text.char_indices() {
        let number = text.get(at + 1..).is_some_and(|rest| rest.starts_with(|next: char| next.is_ascii_digit()));
        out.push(if letter == '_' && number { ' ' } else { letter });
    }
    out
}

/// The stretches of some tokens between those of a kind; none is empty.
fn split(tokens: &[Token], range: Range<usize>, is: impl Fn(&Token) -> bool) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut from = range.start;
    for at in range.clone() {
        if tokens.get(at).is_some_and(&is) {
            found.push(from..at);
            from = at + 1;
        }
    }
    found.push(from..range.end);
    found.retain(|range| !range.is_empty());
    found
}

/// Words of an edit that may be a wish.
struct Part<'a> {
    /// Its place among the parts.
    number: usize,
    range: Range<usize>,
    tokens: &'a [Token],
    chunks: Vec<Chunk>,
    lexicon: &'a Lexicon,
    edit: Edit,
}

impl<'a> Part<'a> {
    fn of(all: &'a [Token], range: Range<usize>, lexicon: &'a Lexicon) -> Self {
        let tokens = all.get(range.clone()).unwrap_or_default();
        let chunks = chunks(tokens, lexicon);
        let mut part = Part { number: 0, range, tokens, chunks, lexicon, edit: Edit::Story };
        let row = lexicon.edits.rows.iter().find(|row| part.fits(row));
        part.edit = row.map_or(Edit::Story, |row| row.edit);
        part
    }

    /// Whether it has one of some words, in any form.
    fn has(&self, words: &str) -> bool {
        self.tokens.iter().any(|token| is_among(token, words))
    }

    fn fits(&self, row: &EditRow) -> bool {
        let begins = || {
            let word = row.has.first().map_or("", String::as_str);
            self.tokens.first().is_some_and(|first| is_among(first, word))
        };
        row.has.iter().all(|words| self.has(words))
            && !self.has(&row.lacks)
            && (!row.first || begins())
            && (!row.place || self.place().is_some())
            && (!row.still || !self.acts())
            && (!row.known || !self.names_somebody_new())
    }

    fn place(&self) -> Option<PlaceClass> {
        self.chunks.iter().find_map(|chunk| if let Is::Place(class) = chunk.is { class } else { None })
    }

    /// Whether somebody does something.
    fn acts(&self) -> bool {
        let patterns = &self.lexicon.frame_patterns;
        let rows = (0..self.chunks.len()).filter_map(|at| longest(&self.chunks, at, patterns));
        rows.filter_map(|found| self.lexicon.frames.get(found.row)).any(|frame| frame.act.is_some())
    }

    fn nouns(&self) -> impl Iterator<Item = &Noun> {
        self.chunks.iter().filter_map(Chunk::noun)
    }

    fn names_somebody_new(&self) -> bool {
        self.nouns().any(is_new)
    }

    /// Whether it names people, and nothing is said of them.
    fn is_bare(&self) -> bool {
        let people = |chunk: &Chunk| match &chunk.is {
            Is::Noun(noun) => noun.head != Head::Robot,
            Is::Mark(_) => true,
            Is::Word => {
                self.tokens.get(chunk.tokens.clone()).is_some_and(|own| own.iter().all(|token| self.is_asking(token)))
            }
            Is::Whose(_) | Is::Place(_) | Is::Amount(_) => false,
        };
        self.chunks.iter().all(people)
    }

    fn is_asking(&self, token: &Token) -> bool {
        is_among(token, &self.lexicon.edits.asks)
    }

    fn only_asks(&self) -> bool {
        self.tokens.iter().all(|token| !token.is_said() || self.is_asking(token))
    }

    /// Whether the next part goes with it: people alone go with what is said before or behind them; so does what more somebody does.
    fn goes_on(&self, next: &Self) -> bool {
        self.is_bare() || next.is_bare() || self.edit == Edit::Story && next.edit == Edit::Story
    }

    fn wish(&self) -> Wish {
        let words = &self.lexicon.edits;
        let start = self.tokens.first().map_or(0, |token| token.at.start);
        let meters = self.chunks.iter().find_map(|chunk| match chunk.is {
            Is::Amount(Amount::Distance(m)) => Some(m),
            Is::Amount(Amount::Time(_) | Amount::Speed(_))
            | Is::Noun(_)
            | Is::Whose(_)
            | Is::Place(_)
            | Is::Mark(_)
            | Is::Word => None,
        });
        Wish {
            edit: self.edit,
            at: start..self.tokens.last().map_or(start, |token| token.at.end),
            place: self.place(),
            meters,
            other: self.has(&words.other),
            adds: self.has(&words.adds) || self.nouns().next().is_some_and(is_new),
            everybody: self.has(&words.everybody),
            group: self.tokens.iter().any(|token| token.is(Sort::Group)),
        }
    }
}

/// Whether a noun phrase is about somebody more.
fn is_new(noun: &Noun) -> bool {
    matches!(noun.head, Head::Role(_)) && matches!(noun.pick, Pick::Some | Pick::Another)
}

/// Whether a word is one of some, in any form.
fn is_among(token: &Token, words: &str) -> bool {
    let has = |own: &str| words.split_whitespace().any(|word| word == own);
    has(&token.spelled) || has(&token.lemma) || Words::stems(&token.spelled).any(|(stem, _)| has(&stem))
}
