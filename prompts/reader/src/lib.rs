//! The reader of requests: text to statements to a story. No map, no catalog of cards, no geometry, no weights.
//!
//! ```text
//! text ─► tokens ─► scene ─────► chunks ─► clauses ──────► statements ─► people ────► story
//!         lex       normalize    chunk     sentence        clause_says   discourse    story
//!         words     scopes       phrase    subject         times         cast           │
//!                   rewrites     name      predicate       maker                        └─► account: what became of every word
//!                                places    find: rows of frames, signs
//! ```
//!
//! Each pass is a pure function of the one before it, and prints itself ([`Passes`]). Everything lexical is a row of `data/`
//! with examples that are tests; how a row is added stands in `ADDING.md`.
//!
//! Never: a map, a file, a random number; a word that vanishes: what no statement used is [`Fate::NotRead`].

use std::sync::LazyLock;

mod token;
mod words;

pub mod pattern;
mod rows;

mod lexicon;

mod lex;
mod normalize;

mod noun;

mod name;
mod phrase;

mod chunk;
mod find;

mod clause;
mod described;
mod parser;
mod predicate;
mod sentence;
mod subject;

mod statement;

mod maker;
mod times;

mod clause_says;

mod cast;
mod discourse;

mod line;
mod story;
mod told;

mod kept;

mod account;

mod passes;

mod errand;
mod scene;
mod spot;
mod wish;

mod examples;

pub use account::{Fate, Piece, Read, Verdict};
pub use cast::People;
pub use errand::{Denied, Errand, Leg, Spot, Toward};
pub use examples::Example;
pub use lexicon::{BadData, Files, SHIPPED};
pub use line::Line;
pub use passes::Passes;
pub use rows::{Act, Cue, Edit};
pub use scene::{Familiar, Scene};
pub use spot::Named;
pub use statement::{Deed, Reason, Says, Statement};
pub use story::{Person, Step, Story};
pub use wish::{Whom, Wish};

/// A reader with its rows.
#[derive(Debug, Default)]
pub struct Reader(lexicon::Lexicon);

impl Reader {
    /// The reader by the shipped rows. That they can be read is a test.
    #[must_use]
    pub fn shipped() -> &'static Self {
        static READER: LazyLock<Reader> = LazyLock::new(|| Reader::of(SHIPPED).unwrap_or_default());
        &READER
    }

    /// A reader by other rows.
    ///
    /// # Errors
    /// [`BadData`] for a file, key or pattern that cannot be.
    pub fn of(files: Files<'_>) -> Result<Self, BadData> {
        lexicon::Lexicon::read(files, None).map(Self)
    }

    /// A reader without the rows of a name, to count what they earn.
    ///
    /// # Errors
    /// As [`Reader::of`].
    pub fn without(files: Files<'_>, id: &str) -> Result<Self, BadData> {
        lexicon::Lexicon::read(files, Some(id)).map(Self)
    }

    /// Names of the rows that can be left out, in the order of the files.
    #[must_use]
    pub fn rows(&self) -> Vec<&str> {
        let frames = self.0.frames.iter().map(|row| row.id.as_str());
        let rewrites = self.0.rewrites.iter().map(|row| row.id.as_str());
        frames.chain(rewrites).chain(self.0.scopes.iter().map(|row| row.id.as_str())).collect()
    }

    /// The examples of the rows: name, text, what it gives, and whether it does.
    #[must_use]
    pub fn examples(&self) -> Vec<Example<'_>> {
        examples::all(&self.0)
    }

    /// Every pass of a text.
    #[must_use]
    pub fn passes(&self, text: &str) -> Passes<'_> {
        Passes::by(text, &self.0)
    }

    /// Reads a text. Never fails: what is not understood stands in [`Read::pieces`].
    #[must_use]
    pub fn read(&self, text: &str) -> Read {
        self.passes(text).read()
    }

    /// The same of a text about people of whom was spoken before, by their roles: they come first in the story, and `last` of them are
    /// those of whom it was last. `human_2` is the second of them.
    #[must_use]
    pub fn read_of(&self, text: &str, known: &[String], last: &[usize]) -> Read {
        Passes::of(&wish::unjoined(text), cast::Cast::of(known, last, &self.0), &self.0).read()
    }

    /// What an edit asks for, wish by wish.
    #[must_use]
    pub fn wishes(&self, text: &str) -> Vec<Wish> {
        wish::wishes(text, &self.0)
    }

    /// The people that words mean, of people of these roles, of whom some were spoken of last.
    #[must_use]
    pub fn whom(&self, text: &str, known: &[String], last: &[usize]) -> Whom {
        wish::whom(text, known, last, &self.0)
    }

    /// The clauses of a task: which places it names for the robot's way, and what for.
    #[must_use]
    pub fn errands(&self, text: &str) -> Vec<Errand> {
        errand::errands(text, &self.0)
    }

    /// What a text says of a scene in general.
    #[must_use]
    pub fn scene(&self, text: &str) -> Scene {
        scene::scene(text, &self.0)
    }

    /// How much of a text the reader knows.
    #[must_use]
    pub fn familiar(&self, text: &str) -> Familiar {
        scene::familiar(text, &self.0)
    }

    /// The base form of a word in lower case; one that nobody knows is one of several where it ends so.
    #[must_use]
    pub fn base(&self, word: &str) -> String {
        let (base, bent) = self.0.words.base(word);
        let one = base.strip_suffix('s').filter(|one| !one.ends_with(['s', 'u', 'i']));
        one.filter(|_| base == word && bent == token::Bent::S).map_or_else(|| base.clone(), str::to_owned)
    }

    /// How fast people of a role walk, m/s, where the word says something about it: `patient`, `child`.
    #[must_use]
    pub fn pace_of(&self, role: &str) -> Option<f64> {
        self.0.words.paces.get(role).copied()
    }

    /// Whether a word in lower case may tell one place from others in a name.
    #[must_use]
    pub fn may_name(&self, word: &str) -> bool {
        errand::may_name(word, self.0.words.sorts(word), &self.0)
    }

    /// Whether a word in lower case says nothing of its own, in any form.
    #[must_use]
    pub fn says_nothing(&self, word: &str) -> bool {
        let words = &self.0.words;
        words.sorts(word).and(words.sorts(&words.base(word).0)).say_nothing()
    }

    /// The places that a text names.
    #[must_use]
    pub fn places(&self, text: &str) -> Vec<Named> {
        spot::places(text, &self.0)
    }
}

/// Reads a text by the shipped rows.
#[must_use]
pub fn read(text: &str) -> Read {
    Reader::shipped().read(text)
}
