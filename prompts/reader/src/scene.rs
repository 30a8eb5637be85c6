//! What a text says of a scene in general: who is there, and how fast people go there. And single words, for those who have names of
//! places.
//!
//! ```text
//! A hospital at visiting hours, nurses in a hurry ─► role "nurse", pace 1.5 m/s
//! ```

use std::ops::Range;

use crate::lexicon::Lexicon;
use crate::noun::{BRISK_MPS, SLOW_MPS};
use crate::token::{Bent, Sort, Token};

/// What a text says of a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The first word for people that says who they are, in its base form.
    pub role: Option<String>,
    /// The pace that it suggests, m/s.
    pub pace_mps: Option<f64>,
    /// Where the words stand that say so, in bytes.
    pub used: Vec<Range<usize>>,
}

/// How much of a text the reader knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Familiar {
    /// Its words, without numbers.
    pub words: usize,
    /// Those that some list or row has, in any form.
    pub known: usize,
}

/// What a text says of a scene.
pub(crate) fn scene(text: &str, lexicon: &Lexicon) -> Scene {
    let tokens = crate::lex::lex(text, &lexicon.words);
    // `people pick orders` tells of no picks.
    let role =
        |token: &&Token| token.is(Sort::Role) && !token.is(Sort::People) && matches!(token.bent, Bent::Base | Bent::S);
    let pace = |token: &Token| {
        let hurried = &lexicon.words.hurried;
        let brisk = token.is(Sort::Brisk) || hurried.contains(&token.spelled) || hurried.contains(&token.lemma);
        brisk.then_some(BRISK_MPS).or_else(|| token.is(Sort::Slow).then_some(SLOW_MPS))
    };
    let who = tokens.iter().find(role);
    let fast = tokens.iter().find_map(|token| Some((pace(token)?, token)));
    Scene {
        role: who.map(|token| token.lemma.clone()),
        pace_mps: fast.map(|(mps, _)| mps),
        used: who.into_iter().chain(fast.map(|(_, token)| token)).map(|token| token.at.clone()).collect(),
    }
}

/// How much of a text the reader knows.
pub(crate) fn familiar(text: &str, lexicon: &Lexicon) -> Familiar {
    let tokens = crate::lex::lex(text, &lexicon.words);
    let words = tokens.iter().filter(|token| token.is_said() && token.spelled.starts_with(char::is_alphabetic));
    words.fold(Familiar::default(), |all, token| Familiar {
        words: all.words + 1,
        known: all.known + usize::from(lexicon.words.knows_bent(&token.spelled)),
    })
}
