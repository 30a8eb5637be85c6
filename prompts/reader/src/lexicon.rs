//! Everything that `data/` says, read and compiled once.

use serde::Deserialize;

use crate::pattern::{BadPattern, Patterns};
use crate::rows::{Edits, Errands, Frame, PlaceRow, Rewrite, Scope, SignRow};
use crate::token::Sort;
use crate::words::Words;

/// Words and rows.
#[derive(Debug, Default)]
pub(crate) struct Lexicon {
    pub(crate) words: Words,
    pub(crate) frames: Vec<Frame>,
    pub(crate) frame_patterns: Patterns,
    pub(crate) places: Vec<PlaceRow>,
    pub(crate) place_patterns: Patterns,
    pub(crate) signs: Vec<SignRow>,
    pub(crate) sign_patterns: Patterns,
    pub(crate) rewrites: Vec<Rewrite>,
    pub(crate) rewrite_patterns: Patterns,
    pub(crate) scopes: Vec<Scope>,
    pub(crate) scope_patterns: Patterns,
    pub(crate) errands: Errands,
    pub(crate) edits: Edits,
}

/// Why a file of `data/` cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum BadData {
    /// It has a key or value that cannot be.
    #[error("`{file}` cannot be read")]
    Toml {
        /// Which.
        file: &'static str,
        /// Why.
        #[source]
        why: Box<toml::de::Error>,
    },
    /// A phrase is no pattern.
    #[error("a pattern cannot be read")]
    Pattern(#[from] BadPattern),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File<T> {
    row: Vec<T>,
}

/// The files of `data/`, each as text.
#[derive(Debug, Clone, Copy)]
pub struct Files<'a> {
    /// `words.toml`.
    pub words: &'a str,
    /// `frames.toml`.
    pub frames: &'a str,
    /// `places.toml`.
    pub places: &'a str,
    /// `signs.toml`.
    pub signs: &'a str,
    /// `rewrites.toml`.
    pub rewrites: &'a str,
    /// `scopes.toml`.
    pub scopes: &'a str,
    /// `errands.toml`.
    pub errands: &'a str,
    /// `edits.toml`.
    pub edits: &'a str,
}

/// The files as shipped.
pub const SHIPPED: Files<'static> = Files {
    words: include_str!("../data/words.toml"),
    frames: include_str!("../data/frames.toml"),
    places: include_str!("../data/places.toml"),
    signs: include_str!("../data/signs.toml"),
    rewrites: include_str!("../data/rewrites.toml"),
    scopes: include_str!("../data/scopes.toml"),
    errands: include_str!("../data/errands.toml"),
    edits: include_str!("../data/edits.toml"),
};

impl Lexicon {
    /// Reads and compiles the files, but for the rows of a name, where one is given.
    ///
    /// # Errors
    /// [`BadData`] for a key or pattern that cannot be.
    pub(crate) fn read(files: Files<'_>, without: Option<&str>) -> Result<Self, BadData> {
        let bad = |file: &'static str| move |why: toml::de::Error| BadData::Toml { file, why: Box::new(why) };
        let words = Words::read(files.words).map_err(bad("words.toml"))?;
        let errands: Errands = toml::from_str(files.errands).map_err(bad("errands.toml"))?;
        let edits: Edits = toml::from_str(files.edits).map_err(bad("edits.toml"))?;
        let mut all = Self { words, errands, edits, ..Self::default() };
        all.frames = rows("frames.toml", files.frames)?;
        all.places = rows("places.toml", files.places)?;
        all.signs = rows("signs.toml", files.signs)?;
        all.rewrites = rows("rewrites.toml", files.rewrites)?;
        all.scopes = rows("scopes.toml", files.scopes)?;
        if let Some(id) = without {
            all.frames.retain(|row| row.id != id);
            all.rewrites.retain(|row| row.id != id);
            all.scopes.retain(|row| row.id != id);
        }
        all.compile()?;
        Ok(all)
    }

    fn compile(&mut self) -> Result<(), BadData> {
        let classes = &self.words.classes;
        let patterns = |rows: &mut dyn Iterator<Item = &Vec<String>>| -> Result<Patterns, BadData> {
            let mut patterns = Patterns::default();
            for (row, phrases) in rows.enumerate() {
                for phrase in phrases {
                    patterns.add(phrase, row, classes)?;
                }
            }
            Ok(patterns)
        };
        self.frame_patterns = patterns(&mut self.frames.iter().map(|row| &row.phrases))?;
        self.place_patterns = patterns(&mut self.places.iter().map(|row| &row.phrases))?;
        self.sign_patterns = patterns(&mut self.signs.iter().map(|row| &row.phrases))?;
        self.rewrite_patterns = patterns(&mut self.rewrites.iter().map(|row| &row.phrases))?;
        self.scope_patterns = patterns(&mut self.scopes.iter().map(|row| &row.phrases))?;
        // Words of rows are known, so that they are found in any form.
        let rows = [
            &self.frame_patterns,
            &self.place_patterns,
            &self.sign_patterns,
            &self.rewrite_patterns,
            &self.scope_patterns,
        ];
        let known: Vec<(String, bool)> =
            rows.iter().flat_map(|patterns| patterns.words()).map(|(word, first)| (word.to_owned(), first)).collect();
        for (word, _) in known {
            self.words.know(&word);
        }
        // The first word of a frame is mostly its verb; a preposition or number stays what it is.
        let verbs: Vec<String> =
            self.frame_patterns.words().filter(|(_, first)| *first).map(|(word, _)| word.to_owned()).collect();
        for verb in verbs {
            let sorts = self.words.sorts(&verb);
            let joins = [Sort::At, Sort::To, Sort::Of, Sort::By, Sort::And, Sort::Every, Sort::No, Sort::Definite];
            if !joins.iter().any(|sort| sorts.has(*sort)) {
                self.words.note(verb, Sort::Verb);
            }
        }
        Ok(())
    }
}

fn rows<T: for<'de> Deserialize<'de>>(file: &'static str, text: &str) -> Result<Vec<T>, BadData> {
    let rows: File<T> = toml::from_str(text).map_err(|why| BadData::Toml { file, why: Box::new(why) })?;
    Ok(rows.row)
}
