//! Tasks: the places of the robot's way, as a task names them. What a map calls so is for those who have a map.
//!
//! ```text
//! Bring mail from ward 2 to the exit, without entering the kitchen ─► From "ward 2" · To "exit" · denied "without entering the kitchen"
//! ```

use std::ops::Range;

use socrates_model::PlaceClass;

use crate::chunk::{Chunk, Is, chunks, place};
use crate::lexicon::Lexicon;
use crate::rows::Set;
use crate::token::{Mark, OWNS, Sort, Sorts, Token};

/// What a place by name is for the robot's way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Toward {
    /// It begins there.
    From,
    /// It ends there.
    To,
    /// The work is there: it ends there, if it is a place of its own.
    Within,
    /// It leads past.
    Past,
}

/// A place by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leg {
    /// What it is for the way.
    pub toward: Toward,
    /// Its name, in bytes.
    pub name: Range<usize>,
    /// Its class, where its words say one.
    pub class: Option<PlaceClass>,
    /// Whether it may be something that the robot does: `go to charge`.
    pub may_be_deed: bool,
    /// Whether it is a name by how it stands there: behind an article, or at the end.
    pub stands_alone: bool,
}

/// A kind of place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spot {
    /// What it is for the way.
    pub toward: Toward,
    /// Which kind.
    pub class: PlaceClass,
    /// Where it stands, in bytes.
    pub at: Range<usize>,
}

/// Words that say where the robot is not to go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Denied {
    /// All of them, in bytes.
    pub at: Range<usize>,
    /// Where the words behind the denial stand.
    pub rest: Range<usize>,
    /// Whether a kind of place is among them.
    pub names_a_place: bool,
}

/// One clause of a task.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Errand {
    /// Where it stands, in bytes.
    pub at: Range<usize>,
    /// Whether it asks for a way back.
    pub returns: bool,
    /// Whether its beginning is where the way leads: `fetch goods from the rack`.
    pub fetches: bool,
    /// Where the robot is not to go.
    pub denied: Option<Denied>,
    /// Places by name.
    pub legs: Vec<Leg>,
    /// Kinds of places.
    pub spots: Vec<Spot>,
}

/// A name has no more words than this.
const NAME: usize = 4;
/// Words before a kind of place that tell what it is for the way.
const BEFORE: usize = 3;

/// The clauses of a task, in order.
pub(crate) fn errands(text: &str, lexicon: &Lexicon) -> Vec<Errand> {
    let tokens = crate::lex::lex(text, &lexicon.words);
    let goes = tokens.iter().any(|token| lexicon.errands.to.contains(&token.spelled));
    let joins = |token: &Token| {
        !token.is_said() && !token.is_mark(Mark::Quote)
            || [Sort::And, Sort::Then, Sort::But, Sort::When, Sort::While].iter().any(|sort| token.is(*sort))
    };
    let clauses = tokens.split(joins).filter(|clause| !clause.is_empty());
    clauses.map(|clause| Clause { tokens: clause, chunks: chunks(clause, lexicon), lexicon, goes }.errand()).collect()
}

/// Whether a word of these sorts may tell one place from others: `packing` and `line`, not `the`, `towards` or `small`.
pub(crate) fn may_name(word: &str, sorts: Sorts, lexicon: &Lexicon) -> bool {
    !lexicon.errands.nameless.contains(word) && (sorts.has(Sort::Empty) || !sorts.say_nothing())
}

struct Clause<'a> {
    tokens: &'a [Token],
    chunks: Vec<Chunk>,
    lexicon: &'a Lexicon,
    /// Whether any clause of the task says where to.
    goes: bool,
}

impl Clause<'_> {
    fn errand(&self) -> Errand {
        let words = &self.lexicon.errands;
        let all = self.bytes(0..self.tokens.len());
        let fetches = !self.goes && self.tokens.iter().any(|token| words.fetches.contains(&token.lemma));
        let (denied, spots) = (self.denied(), self.spots(fetches));
        Errand { at: all, returns: self.returns(), fetches, denied, legs: self.legs(), spots }
    }

    fn bytes(&self, tokens: Range<usize>) -> Range<usize> {
        let own = self.tokens.get(tokens).unwrap_or_default();
        let start = own.first().map_or(0, |token| token.at.start);
        start..own.last().map_or(start, |token| token.at.end)
    }

    fn is(&self, at: usize, words: &Set) -> bool {
        self.tokens.get(at).is_some_and(|token| words.contains(&token.spelled))
    }

    /// `return to the desk`, `comes back`; `return the cup to the kitchen` does not.
    fn returns(&self) -> bool {
        let words = &self.lexicon.errands;
        (0..self.tokens.len()).any(|at| {
            let last = at + 1 == self.tokens.len();
            self.is(at, &words.returns) && (last || self.is(at + 1, &words.returns_to))
                || self.is(at, &words.comes) && self.is(at + 1, &words.back)
        })
    }

    fn denied(&self) -> Option<Denied> {
        let words = &self.lexicon.errands;
        let at = (0..self.tokens.len()).find(|at| self.is(*at, &words.denies))?;
        let from = at.checked_sub(1).filter(|before| self.is(*before, &words.before_denial)).unwrap_or(at);
        let place = |chunk: &Chunk| matches!(chunk.is, Is::Place(_)) && chunk.tokens.start > at;
        Some(Denied {
            at: self.bytes(from..self.tokens.len()),
            rest: self.bytes(at + 1..self.tokens.len()),
            names_a_place: self.chunks.iter().any(place),
        })
    }

    fn class(&self, tokens: &Range<usize>) -> Option<PlaceClass> {
        self.chunks.iter().find_map(|chunk| match chunk.is {
            Is::Place(class) if chunk.tokens.start < tokens.end && tokens.start < chunk.tokens.end => class,
            Is::Place(_) | Is::Noun(_) | Is::Whose(_) | Is::Amount(_) | Is::Mark(_) | Is::Word => None,
        })
    }

    /// The kind of place of which some words name a part.
    fn of_part(&self, tokens: &Range<usize>) -> Option<PlaceClass> {
        let part = tokens.clone().find(|at| self.is(*at, &self.lexicon.errands.part))?;
        let within = self.tokens.get(..tokens.end).unwrap_or_default();
        (part + 1..tokens.end).find_map(|at| place(within, at, self.lexicon)?.0)
    }

    fn legs(&self) -> Vec<Leg> {
        let words = &self.lexicon.errands;
        let mut found = Vec::new();
        for at in 0..self.tokens.len() {
            let toward = match () {
                () if self.is(at, &words.past) => Toward::Past,
                () if self.is(at, &words.from) => Toward::From,
                () if self.is(at, &words.to) => Toward::To,
                () if self.is(at, &words.within) => Toward::Within,
                () => continue,
            };
            let from = (at + 1..self.tokens.len()).find(|next| !self.is(*next, &words.joins)).unwrap_or(at + 1);
            let tells = |token: &&Token| {
                token.is_said()
                    && !token.is(Sort::Robot)
                    && !token.is(Sort::Other)
                    && !token.is(Sort::Slow)
                    && !token.is(Sort::Brisk)
                    && (token.number().is_some()
                        || token.spelled == OWNS
                        || may_name(&token.spelled, token.sorts, self.lexicon))
            };
            let count = self.tokens.iter().skip(from).take(NAME).take_while(tells).count();
            let name = from..from + count;
            // `to the nurse`; `to the doctor's office` is a place.
            let person = self.chunks.iter().any(|chunk| match chunk.is {
                Is::Noun(_) => name.contains(&(chunk.tokens.end - 1)),
                Is::Whose(_) => name.contains(&(chunk.tokens.end - 1)) && name.end <= chunk.tokens.end,
                Is::Place(_) | Is::Amount(_) | Is::Mark(_) | Is::Word => false,
            });
            if count == 0 || person {
                continue;
            }
            let deed = self.tokens.get(from).is_some_and(|first| words.does.contains(&first.lemma));
            found.push(Leg {
                toward,
                class: self.class(&name),
                may_be_deed: from == at + 1 && deed,
                stands_alone: from > at + 1 || name.end == self.tokens.len(),
                name: self.bytes(name),
            });
        }
        found
    }

    fn spots(&self, fetches: bool) -> Vec<Spot> {
        let words = &self.lexicon.errands;
        let spot = |chunk: &Chunk| {
            let Is::Place(Some(class)) = chunk.is else { return None };
            // The place itself begins behind its article.
            let article = |at: &usize| {
                self.tokens.get(*at).is_some_and(|token| token.is(Sort::Definite) || token.is(Sort::Indefinite))
            };
            let first = chunk.tokens.clone().find(|at| !article(at)).unwrap_or(chunk.tokens.start);
            if first.checked_sub(1).is_some_and(|at| self.is(at, &words.any)) {
                return None;
            }
            let near =
                |words: &Set| (1..=BEFORE).find(|back| first.checked_sub(*back).is_some_and(|at| self.is(at, words)));
            // `to the other end of the corridor`: which end is which no map tells.
            if let Some(class) = self.of_part(&chunk.tokens) {
                return Some(Spot { toward: Toward::Past, class, at: self.bytes(chunk.tokens.clone()) });
            }
            let rides = class == PlaceClass::Elevator && near(&words.rides).is_some();
            let toward = match (near(&words.from), near(&words.ends), near(&words.along)) {
                (Some(_), None, _) if fetches => Toward::To,
                (Some(from), Some(to), _) if from < to => Toward::From,
                (Some(_), None, _) => Toward::From,
                (_, Some(_), _) => Toward::To,
                (None, None, None) if rides => Toward::To,
                (None, None, _) => Toward::Past,
            };
            Some(Spot { toward, class, at: self.bytes(chunk.tokens.clone()) })
        };
        self.chunks.iter().filter_map(spot).collect()
    }
}
