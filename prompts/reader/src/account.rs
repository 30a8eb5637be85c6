//! The account: what became of every word. A word of which nothing was made is said with its span, never dropped.
//!
//! ```text
//! A nurse yodels and steps aside ─► Read "A nurse" · NotRead "yodels" · Read "and steps aside": a clause partly read
//! ```

use std::ops::Range;

use socrates_model::PlaceClass;
use socrates_model::statement::Background;
use unicode_segmentation::UnicodeSegmentation as _;

use crate::cast::People;
use crate::chunk::Chunk;
use crate::clause::Clause;
use crate::discourse::Told;
use crate::kept::missing;
use crate::line::Line;
use crate::normalize::Scene;
use crate::rows::{Act, Cue};
use crate::statement::{Reason, Says, Statement};
use crate::story::{Story, Telling};

/// Why what was said of somebody is not in the story.
const ONE_WAY: &str =
    "each person stands to the robot's way in one way, and the robot's way has one start and one goal";

/// Why somebody is named and may be read in part.
const UNPLACED: &str = "it was not made out what they do, or where they come from, though that of others was";

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
    /// Number of its clause, from 0; none: outside the scene.
    pub clause: Option<usize>,
    /// What became of it.
    pub fate: Fate,
}

/// What became of a clause as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Every word is in the form, or asks for nothing.
    Read,
    /// Part of it is in the form; these words are not, by their bytes.
    Partly(Vec<Range<usize>>),
    /// None of its words is in the form.
    NotRead,
}

/// What a text was read as.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Read {
    /// People, and what they do.
    pub story: Story,
    /// What became of every piece of the text: in its order, apart from each other, and every word in one of them.
    pub pieces: Vec<Piece>,
    /// What the text says of the story, in its order, each with the words that say it, in bytes.
    pub lines: Vec<(Line, Range<usize>)>,
}

impl Read {
    /// What became of each clause, by its number, in the order of the text.
    #[must_use]
    pub fn verdicts(&self) -> Vec<(usize, Verdict)> {
        let mut numbers: Vec<usize> = self.pieces.iter().filter_map(|piece| piece.clause).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers.into_iter().map(|number| (number, self.verdict(number))).collect()
    }

    fn verdict(&self, clause: usize) -> Verdict {
        let own = || self.pieces.iter().filter(|piece| piece.clause == Some(clause));
        let lost = |piece: &&Piece| matches!(piece.fate, Fate::NotRead | Fate::NotPlayed(_));
        let missing: Vec<Range<usize>> = own().filter(lost).map(|piece| piece.at.clone()).collect();
        match missing.is_empty() {
            true => Verdict::Read,
            false if own().any(|piece| piece.fate == Fate::Read) => Verdict::Partly(missing),
            false => Verdict::NotRead,
        }
    }
}

impl Fate {
    /// The fate that what a statement says gives its words; the rank of what wins over another on the same words.
    fn of(says: &Says<People>, story: &Story) -> (Self, u8) {
        let part =
            |class| story.place == Some(class) || story.robot_start == Some(class) || story.robot_goal == Some(class);
        // A sign that nobody made out is none.
        let unclear = |reason: &Reason<People>| reason.cue == Cue::Says && reason.sign.is_none();
        match says {
            Says::Do(deed)
                if deed.act == Act::Sign && deed.says.is_none()
                    || !deed.not && deed.when.iter().chain(&deed.until).any(unclear) =>
            {
                (Self::NotRead, 3)
            }
            // People meet the robot in one place: another one that is told is not played.
            Says::Happens(class, _) if !part(*class) && !story.robot_via.contains(class) => {
                (Self::NotPlayed("people meet the robot in one place".to_owned()), 2)
            }
            Says::From(..) => (Self::Read, 3),
            Says::NotRead | Says::RobotSays(None, _) => (Self::NotRead, 3),
            Says::After(None, _) => (Self::Background(Background::Comment), 0),
            Says::NotPlayed(why) => (Self::NotPlayed(why.clone()), 2),
            Says::Background(reason) => (Self::Background(*reason), 0),
            Says::Introduce(_)
            | Says::Noted(_)
            | Says::Walks(_)
            | Says::Relate(..)
            | Says::Group(_)
            | Says::Pace(..)
            | Says::Do(_)
            | Says::RobotSays(Some(_), _)
            | Says::Then(..)
            | Says::RobotFirst(_)
            | Says::After(Some(_), _)
            | Says::Queue(_)
            | Says::Twice(..)
            | Says::Goes
            | Says::Happens(..)
            | Says::There
            | Says::GoalThere
            | Says::RobotVia(_)
            | Says::RobotStart(_)
            | Says::RobotGoal(_) => (Self::Read, 1),
        }
    }
}

/// What became of every piece, in the order of the text.
pub(crate) fn account(
    text: &str,
    scene: &Scene,
    (chunks, clauses): (&[Chunk], &[Clause]),
    told: &Told,
    telling: &Telling,
) -> Vec<Piece> {
    let mut pieces = words(scene, (chunks, clauses), told, telling);
    let background = scene.background.iter();
    pieces.extend(background.map(|(at, reason)| Piece {
        at: at.clone(),
        clause: None,
        fate: Fate::Background(*reason),
    }));
    pieces.sort_by_key(|piece| (piece.at.start, piece.at.end));
    // Numbers of a list, times of day, a number taken back: left out before anything is read.
    for (start, word) in text.unicode_word_indices() {
        let at = start..start + word.len();
        let behind = pieces.partition_point(|piece| piece.at.end <= at.start);
        if pieces.get(behind).is_none_or(|piece| piece.at.start >= at.end) {
            let fate = Fate::Background(Background::Comment);
            pieces.insert(behind, Piece { at, clause: None, fate });
        }
    }
    joined(pieces)
}

/// The fate of every word of the scene, each a piece of its own.
fn words(scene: &Scene, (chunks, clauses): (&[Chunk], &[Clause]), told: &Told, telling: &Telling) -> Vec<Piece> {
    // The statement that is about the fewest words tells of a word; of two about the same, the one that loses more.
    let mut fates: Vec<Option<(usize, u8, Fate)>> = vec![None; scene.tokens.len()];
    let place = Place::of(told, telling, clauses);
    for (number, statement) in told.statements.iter().enumerate() {
        let (fate, rank) = if telling.lost.contains(&number) {
            (Fate::NotPlayed(ONE_WAY.to_owned()), 2)
        } else {
            Fate::of(&statement.says, &telling.story)
        };
        let (fate, rank) =
            if place.has_beside(statement) { (Fate::Background(Background::Setting), 1) } else { (fate, rank) };
        let length = statement.tokens.len();
        for own in fates.get_mut(statement.tokens.clone()).unwrap_or_default() {
            let wins = |(other, own): &(usize, u8)| *other > length || *other == length && *own < rank;
            if own.as_ref().is_none_or(|(other, own, _)| wins(&(*other, *own))) {
                *own = Some((length, rank, fate.clone()));
            }
        }
    }
    let mut fates: Vec<Option<Fate>> = fates.into_iter().map(|own| own.map(|(_, _, fate)| fate)).collect();
    for tokens in &telling.unplaced {
        fates.get_mut(tokens.clone()).unwrap_or_default().fill(Some(Fate::NotPlayed(UNPLACED.to_owned())));
    }
    for missing in missing(chunks, &telling.story) {
        let read = |fate: &&mut Option<Fate>| **fate == Some(Fate::Read) || fate.is_none();
        for own in fates.get_mut(missing).unwrap_or_default().iter_mut().filter(read) {
            *own = Some(Fate::NotRead);
        }
    }
    for doubt in &told.doubts {
        fates.get_mut(doubt.clone()).unwrap_or_default().fill(Some(Fate::NotRead));
    }
    let numbers = numbers(scene.tokens.len(), clauses);
    for (token, fate) in scene.tokens.iter().zip(&mut fates) {
        if fate.is_none() && token.is_said() && !token.says_nothing() {
            *fate = Some(Fate::NotRead);
        }
    }
    // What says nothing of its own goes with the word before it, or behind it.
    let silent = |at: usize| fates.get(at).is_some_and(Option::is_none);
    let near = |at: usize| {
        let same = |other: &usize| numbers.get(*other) == numbers.get(at);
        let of = |other: usize| fates.get(other).cloned().flatten().filter(|fate| *fate != Fate::NotRead);
        let before = (0..at).rev().take_while(same).find_map(of);
        before.or_else(|| (at + 1..numbers.len()).take_while(same).find_map(of))
    };
    let all: Vec<Fate> = (0..fates.len())
        .map(|at| {
            let own = if silent(at) { near(at) } else { fates.get(at).cloned().flatten() };
            own.unwrap_or(Fate::Background(Background::Comment))
        })
        .collect();
    let said = scene.tokens.iter().zip(all).zip(numbers).filter(|((token, _), _)| token.is_said());
    said.map(|((token, fate), clause)| Piece { at: token.at.clone(), clause, fate }).collect()
}

/// Where it happens, as the text says it.
struct Place<'a> {
    class: Option<PlaceClass>,
    /// The clause that says it.
    clause: Option<&'a Clause>,
}

impl<'a> Place<'a> {
    fn of(told: &Told, telling: &Telling, clauses: &'a [Clause]) -> Self {
        let class = telling.story.place;
        let says = told.statements.iter().filter_map(|statement| {
            let Says::Happens(own, rank) = statement.says else { return None };
            (class == Some(own)).then_some((rank, &statement.tokens))
        });
        // Of those that count the same, the first.
        let best = says.rev().max_by_key(|(rank, _)| *rank);
        let of = |tokens: &Range<usize>| clauses.iter().find(|clause| holds(&clause.tokens, tokens));
        Self { class, clause: best.and_then(|(_, tokens)| of(tokens)) }
    }

    /// Whether a statement names another place in the same clause, which tells no more than where this one is: `the corridor
    /// outside ward 3`.
    fn has_beside(&self, statement: &Statement<People>) -> bool {
        let other = if let Says::Happens(class, _) = statement.says { self.class != Some(class) } else { false };
        other && self.clause.is_some_and(|clause| holds(&clause.tokens, &statement.tokens))
    }
}

const fn holds(all: &Range<usize>, some: &Range<usize>) -> bool {
    all.start <= some.start && some.end <= all.end
}

/// The clause of every token, by its number.
fn numbers(tokens: usize, clauses: &[Clause]) -> Vec<Option<usize>> {
    let mut numbers: Vec<Option<usize>> = vec![None; tokens];
    for (number, clause) in clauses.iter().enumerate() {
        let own = [clause.tokens.clone()].into_iter();
        for range in own.chain(clause.conditions.iter().map(|condition| condition.clause.tokens.clone())) {
            for token in numbers.get_mut(range).unwrap_or_default() {
                token.get_or_insert(number);
            }
        }
    }
    numbers
}

/// Pieces that follow each other and became the same, as one.
fn joined(pieces: Vec<Piece>) -> Vec<Piece> {
    let mut joined: Vec<Piece> = Vec::new();
    for piece in pieces {
        match joined.last_mut() {
            Some(last) if last.fate == piece.fate && last.clause == piece.clause => {
                last.at.end = last.at.end.max(piece.at.end);
            }
            // Words that a rewrite put in place of others stand where those stand.
            Some(last) if piece.at.start < last.at.end => {
                let reads = piece.fate == Fate::Read && matches!(last.fate, Fate::Background(_));
                if piece.fate == Fate::NotRead || reads {
                    last.fate = piece.fate;
                }
                last.at.end = last.at.end.max(piece.at.end);
            }
            Some(_) | None => joined.push(piece),
        }
    }
    joined
}
