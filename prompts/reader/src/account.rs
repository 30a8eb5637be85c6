//! The account: what became of every word. A word of which nothing was made is said with its span, never dropped.

use std::ops::Range;

use socrates_model::statement::Background;

use crate::discourse::People;
use crate::normalize::Scene;
use crate::statement::{Says, Statement};
use crate::story::Story;

/// What became of a piece of a text.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// It is in the form.
    Read,
    /// It asks for nothing.
    Background(Background),
    /// It is understood, and not played.
    NotPlayed(String),
    /// It is not understood.
    NotRead,
}

/// A piece of the text, in bytes, and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Where it stands.
    pub at: Range<usize>,
    /// What became of it.
    pub fate: Fate,
}

/// What a text was read as.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Read {
    /// People, and what they do.
    pub story: Story,
    /// What became of every piece of the text.
    pub pieces: Vec<Piece>,
}

/// What became of every piece, in the order of the text.
pub(crate) fn account(scene: &Scene, statements: &[Statement<People>]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    for (at, reason) in &scene.background {
        pieces.push(Piece { at: at.clone(), fate: Fate::Background(*reason) });
    }
    for statement in statements {
        let fate = match &statement.says {
            Says::Background(reason) => Fate::Background(*reason),
            Says::NotPlayed(why) => Fate::NotPlayed(why.clone()),
            Says::NotRead => Fate::NotRead,
            // A sign that nobody can make out is not read.
            Says::RobotSays(None, _) => Fate::NotRead,
            Says::Introduce(_)
            | Says::Relate(..)
            | Says::Group(_)
            | Says::Pace(..)
            | Says::Do(_)
            | Says::RobotSays(Some(_), _)
            | Says::Then(_)
            | Says::Happens(..)
            | Says::RobotStart(_)
            | Says::RobotGoal(_) => Fate::Read,
        };
        let own = scene.tokens.get(statement.tokens.clone()).unwrap_or_default();
        let (Some(start), Some(end)) =
            (own.iter().map(|token| token.at.start).min(), own.iter().map(|token| token.at.end).max())
        else {
            continue;
        };
        let piece = Piece { at: start..end, fate };
        if !pieces.contains(&piece) {
            pieces.push(piece);
        }
    }
    pieces.sort_by_key(|piece| (piece.at.start, piece.at.end));
    pieces
}
