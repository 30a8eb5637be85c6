//! A site: an orchestrator with a flaw, its store, and what is noticed of it. It may die around any commit.

use std::path::Path;

use socrates_store::{SqliteStore, Store as _};

use super::flaw::Flaw;
use super::witness::Witness;
use crate::histories::{Dice, Unfit, kept};
use crate::world::{answer, saved};
use crate::{Answer, Event, Policy, Row, State, Token, fsck};

/// Where an orchestrator dies in the course of one event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Death {
    /// Nowhere.
    Never,
    /// Before its rows are saved.
    Before,
    /// While they are saved.
    Within,
    /// After they are saved, before its answer is out.
    After,
}

/// What found a flaw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Check {
    /// The checker of the state, after every event.
    State,
    /// The store: what it refuses, and the audit of its file at the end.
    Store,
    /// What workers and clients were told.
    Told,
    /// Whether everything comes to an end.
    End,
}

impl Check {
    /// Every check, in the order of the table.
    pub(super) const ALL: [Self; 4] = [Self::State, Self::Store, Self::Told, Self::End];
}

/// An orchestrator on its store.
pub(super) struct Site {
    pub(super) state: State,
    /// The monotonic clock, ms.
    pub(super) now: u64,
    /// How far the clock of the wall is ahead of it, ms.
    pub(super) ahead: i64,
    pub(super) witness: Witness,
    /// Events so far.
    pub(super) events: u64,
    /// What was noticed first by each check, and after how many events.
    pub(super) noticed: std::collections::BTreeMap<Check, (u64, String)>,
    flaw: Flaw,
    dice: Dice,
    rows: Vec<Row>,
    tokens: Token,
}

impl Site {
    pub(super) fn new(flaw: Flaw, seed: u64) -> Self {
        Self {
            state: State::new(Policy { open_per_worker: 1, ..Policy::default() }),
            now: 10_000_000,
            ahead: 0,
            witness: Witness::default(),
            events: 0,
            noticed: std::collections::BTreeMap::new(),
            flaw,
            dice: Dice::new(seed ^ 0x5eed),
            rows: Vec::new(),
            tokens: 0,
        }
    }

    fn notice(&mut self, check: Check, wrong: &[String]) {
        if let Some(first) = wrong.first() {
            let events = self.events;
            self.noticed.entry(check).or_insert_with(|| (events, first.clone()));
        }
    }

    /// Lets an event in and hands back its answer, unless the orchestrator dies of it first.
    pub(super) fn send(&mut self, event: impl FnOnce(Token) -> Event, death: Death) -> Option<Answer> {
        self.events += 1;
        self.tokens += 1;
        let token = self.tokens;
        let wall = self.now.saturating_add_signed(self.ahead);
        let effects = self.flaw.step(&mut self.state, event(token), (self.now, wall), &mut self.dice);
        let wrong = fsck(&self.state);
        self.notice(Check::State, &wrong);
        let rows = self.flaw.saves(saved(&effects), &mut self.dice);
        let count = rows.len() as u64;
        let saved = match (death, self.flaw) {
            (Death::Never | Death::After, _) => count,
            (Death::Within, Flaw::SplitStep) => self.dice.below(count + 1),
            // A transaction is there whole or not at all.
            (Death::Before | Death::Within, _) => 0,
        };
        self.rows.extend(rows.into_iter().take(usize::try_from(saved).unwrap()));
        let answer = answer(&effects, token);
        match death {
            Death::Never => answer,
            Death::Before if self.flaw == Flaw::AnswersFirst => {
                self.restart();
                answer
            }
            Death::Before | Death::Within | Death::After => {
                self.restart();
                None
            }
        }
    }

    /// Another orchestrator begins on what was saved.
    fn restart(&mut self) {
        self.now += 50;
        let epoch = self.state.epoch + 1;
        let (store, unfit) = kept(&self.rows);
        let second = |one: Unfit| match one {
            Unfit::Second(key) => Some(format!("the store refuses a second result of {key}")),
            Unfit::Gap(_) => None,
        };
        let refused: Vec<String> = unfit.into_iter().filter_map(second).collect();
        self.notice(Check::Store, &refused);
        self.state = State::restore(store, self.state.policy.clone(), self.now);
        self.state.epoch = epoch;
        self.witness.reign(self.now);
        if self.flaw == Flaw::ReusedFences {
            self.state.next_fence = 1;
        }
        if self.flaw != Flaw::NoTimers {
            self.send(|_| Event::Recover { alone: false }, Death::Never);
        }
    }

    /// Audits what was saved, in a file that the real store wrote.
    pub(super) fn audit(&mut self, folder: &Path) {
        if self.noticed.contains_key(&Check::Store) {
            return;
        }
        let path = folder.join("jobs.sqlite");
        let mut store = SqliteStore::open_with(&path, socrates_store::Durability::Process).unwrap();
        // The texts of these lives are not what their addresses say.
        let rows: Vec<&Row> = self.rows.iter().filter(|row| !matches!(row, Row::Text(..))).collect();
        // The store's rows are those of the crate that is not under test: they go over as text.
        let text = serde_json::to_string(&rows).unwrap();
        let wrong = match store.save(serde_json::from_str::<Vec<_>>(&text).unwrap().as_slice()) {
            Ok(()) => socrates_store::audit(&path).unwrap().wrong(),
            Err(why) => vec![why.to_string()],
        };
        drop(store);
        self.notice(Check::Store, &wrong);
        std::fs::remove_file(&path).unwrap();
    }

    /// Asks the witness once more, now that the store is known.
    pub(super) fn close(&mut self) {
        let (store, _) = kept(&self.rows);
        self.witness.close(&store);
        self.hear();
    }

    /// Notes what the witness found.
    pub(super) fn hear(&mut self) {
        let wrong = std::mem::take(&mut self.witness.wrong);
        self.notice(Check::Told, &wrong);
    }

    /// Notes that not everything came to an end.
    pub(super) fn stuck(&mut self) {
        let open: Vec<String> =
            self.state.jobs.values().filter(|job| !job.state.is_terminal()).map(|job| job.key.to_string()).collect();
        let told = vec![format!("does not come to an end: {}", open.join(", "))];
        self.notice(Check::End, &told);
    }
}
