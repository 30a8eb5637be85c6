//! A batch on real processes, as it was seen from outside: what workers said, what was done to them, and the rows that are left.
//!
//! ```text
//! lines of workers ─┐
//! faults done       ├─► events by time ─┐
//! ends of scenarios ┘                   ├─► ledger, as that of a simulated batch
//! rows of the store, what is wrong ─────┘
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socrates_model::job::JobKey;
use socrates_model::wire::{Recorded, ScenarioSpec};
use socrates_model::{ScenarioEnd, ScenarioId};
use socrates_orchestrator::{AttemptEnd, Snapshot};

use crate::asked::{number, of_authors};
use crate::draws::At;
use crate::kind::Kind;
use crate::ledger::{AttemptRow, Ledger};
use crate::results::Played;
use crate::rows::Rows;
use crate::spec::Cell;

/// What a worker says of an attempt: a line of its standard output.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Told {
    /// It begins.
    Begins {
        /// Job.
        key: JobKey,
        /// Attempt.
        attempt: u32,
        /// What is to strike it.
        due: Vec<Kind>,
        /// Tokens in and out, as far as they are asked for.
        tokens: [u64; 2],
    },
    /// Now is the moment of a fault of processes.
    Strikes {
        /// Job.
        key: JobKey,
        /// Attempt.
        attempt: u32,
        /// Which.
        kind: Kind,
    },
    /// Its work is done, and the report comes next.
    Ends {
        /// Job.
        key: JobKey,
        /// Attempt.
        attempt: u32,
        /// What it fails with; none for a success.
        fails: Option<Kind>,
        /// Whether it is wrong without anybody finding out.
        unseen: bool,
    },
}

/// Something that was seen.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Seen {
    Told(Told),
    Struck(Kind, JobKey, u32),
    Rose,
    Ended(ScenarioId, ScenarioEnd),
}

/// What was seen of a batch. Times are of the wall, ms after the batch was submitted.
#[derive(Debug, Default)]
pub struct Observed {
    scenarios: Vec<(u32, ScenarioId)>,
    ends: BTreeMap<ScenarioId, ScenarioEnd>,
    seen: Vec<(u64, Seen)>,
    complaints: Vec<String>,
}

impl Observed {
    /// Nothing yet of these scenarios.
    #[must_use]
    pub fn of(scenarios: &[(u32, ScenarioSpec)]) -> Self {
        let scenarios = scenarios.iter().map(|(number, scenario)| (*number, scenario.id.clone())).collect();
        Self { scenarios, ..Self::default() }
    }

    /// A worker said something.
    pub fn told(&mut self, at_ms: u64, told: Told) {
        self.seen.push((at_ms, Seen::Told(told)));
    }

    /// A fault was seen to strike a process.
    pub fn struck(&mut self, at_ms: u64, kind: Kind, key: JobKey, attempt: u32) {
        self.seen.push((at_ms, Seen::Struck(kind, key, attempt)));
    }

    /// A successor of the orchestrator serves.
    pub fn rose(&mut self, at_ms: u64) {
        self.seen.push((at_ms, Seen::Rose));
    }

    /// A scenario is told to have ended. It may be told as often as anybody looks; another end than before is a second one.
    pub fn ended(&mut self, at_ms: u64, id: &ScenarioId, end: ScenarioEnd) {
        if self.ends.insert(id.clone(), end) != Some(end) {
            self.seen.push((at_ms, Seen::Ended(id.clone(), end)));
        }
    }

    /// Something that must not be.
    pub fn complains(&mut self, what: String) {
        self.complaints.push(what);
    }

    /// Scenarios that are not told to have ended.
    #[must_use]
    pub fn open(&self) -> usize {
        self.scenarios.len().saturating_sub(self.ends.len())
    }

    /// Closes the books with the rows that the store holds, and what is wrong with them.
    #[must_use]
    pub fn closed(mut self, cell: &Cell, snapshot: Snapshot, wrong: Vec<String>) -> Played {
        let mut books = Books {
            ledger: Ledger::default(),
            rows: Rows::of(snapshot),
            cell,
            places: BTreeMap::new(),
            died: None,
            rose: false,
        };
        for (number, id) in self.scenarios {
            books.ledger.submitted(id, number);
        }
        // Lines of several processes come by several pipes.
        self.seen.sort_by_key(|(at_ms, _)| *at_ms);
        let last = self.seen.last().map_or(0, |(at_ms, _)| *at_ms);
        for (at_ms, seen) in self.seen {
            books.take(at_ms, seen);
        }
        self.complaints.extend(wrong);
        let Books { mut ledger, rows, .. } = books;
        ledger.caught_up(&rows, last);
        ledger.complained(&self.complaints);
        ledger.close(&rows, &of_authors(cell));
        ledger.into()
    }
}

/// The books of a batch that is over.
struct Books<'a> {
    ledger: Ledger,
    rows: Rows,
    cell: &'a Cell,
    places: BTreeMap<(JobKey, u32), usize>,
    /// When the orchestrator was killed after which nothing began yet.
    died: Option<u64>,
    /// Whether its successor serves.
    rose: bool,
}

impl Books<'_> {
    fn take(&mut self, at_ms: u64, seen: Seen) {
        match seen {
            Seen::Told(Told::Begins { key, attempt, due, tokens }) => self.begins(at_ms, key, attempt, &due, tokens),
            Seen::Told(Told::Strikes { .. }) => {}
            Seen::Told(Told::Ends { key, attempt, fails, unseen }) => self.ends(at_ms, key, attempt, fails, unseen),
            Seen::Struck(kind, key, attempt) => self.struck(at_ms, kind, key, attempt),
            Seen::Rose => self.rose = self.died.is_some(),
            Seen::Ended(id, end) => self.ledger.ended(&id, end, at_ms),
        }
    }

    fn begins(&mut self, at_ms: u64, key: JobKey, attempt: u32, due: &[Kind], tokens: [u64; 2]) {
        let Some(scenario) = number(&key.scenario) else { return };
        if self.rose
            && let Some(died) = self.died.take()
        {
            self.rose = false;
            self.ledger.recoveries.push((Kind::OrchestratorKill, at_ms.saturating_sub(died)));
        }
        let at = At { scenario, stage: key.stage, revision: key.revision, attempt };
        let outcome = "taken away";
        let row = AttemptRow { at, begun_ms: at_ms, ended_ms: None, outcome, recorded: None, tokens };
        self.ledger.due(due.iter().copied());
        let place = self.ledger.begun(&key, row);
        self.places.insert((key, attempt), place);
    }

    fn struck(&mut self, at_ms: u64, kind: Kind, key: JobKey, attempt: u32) {
        self.ledger.hit(kind);
        if kind == Kind::OrchestratorKill {
            self.died.get_or_insert(at_ms);
            self.rose = false;
            return;
        }
        self.ledger.struck(&key, kind, at_ms);
        let place = self.places.get(&(key, attempt)).copied();
        if let Some(place) = place.filter(|_| kind == Kind::WorkerKill) {
            self.ledger.stopped(place, "killed", at_ms);
        }
    }

    fn ends(&mut self, at_ms: u64, key: JobKey, attempt: u32, fails: Option<Kind>, unseen: bool) {
        let at = (key, attempt);
        let Some(place) = self.places.get(&at).copied() else { return };
        let (key, attempt) = at;
        let (word, right) = meaning(fails, unseen);
        self.ledger.stopped(place, word, at_ms);
        self.ledger.answered(&key, right);
        let row = self.rows.attempt(&key, attempt);
        let accepted = match fails {
            None => row.is_some_and(|row| row.end == Some(AttemptEnd::Succeeded)),
            Some(_) => row.is_some_and(|row| row.reported && row.class.is_some()),
        };
        if let Some(kind) = fails {
            self.ledger.struck(&key, kind, at_ms);
            if accepted && self.cell.strike.kinds.contains(&kind) {
                self.ledger.hit(kind);
            }
        }
        let said = if accepted { Recorded::Accepted } else { Recorded::Late };
        self.ledger.recorded(place, (&key, attempt), said, fails.is_none(), at_ms);
    }
}

/// The word of an attempt that ended so, and whether its author answered rightly.
const fn meaning(fails: Option<Kind>, unseen: bool) -> (&'static str, Option<bool>) {
    match fails {
        None if unseen => ("unseen", Some(false)),
        None => ("right", Some(true)),
        Some(Kind::SemanticViolation) => ("violated", Some(false)),
        Some(Kind::Malformed) => ("malformed", Some(false)),
        Some(Kind::LlmTimeout) => ("timeout", None),
        Some(Kind::Overload) => ("overload", None),
        Some(_) => ("error", None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asked::asked;
    use crate::fate::Outcome;
    use crate::laws::spec;
    use socrates_model::job::{Item, Stage};

    #[test]
    fn words_are_those_of_a_simulated_attempt() {
        for outcome in
            [Outcome::Right, Outcome::Unseen, Outcome::Malformed, Outcome::Error, Outcome::Timeout, Outcome::Overload]
        {
            let seen = meaning(outcome.kind(), outcome == Outcome::Unseen);
            assert_eq!(seen, (outcome.word(), outcome.answered()));
        }
    }

    #[test]
    fn books_tell_what_struck_how_long_it_took_and_what_is_lost() {
        let spec = spec(serde_json::json!({
            "title": "seen", "scenarios": 2, "policies": ["jitter"], "level": "processes",
            "fault": [{ "kinds": ["worker_kill", "llm_error", "orchestrator_kill"], "rates": [0.5] }],
        }));
        let cell = &spec.cells()[0];
        let scenarios = asked(&spec, cell, 0);
        let key = |number: usize| JobKey {
            scenario: scenarios[number].1.id.clone(),
            stage: Stage::Paths,
            item: Item::Whole,
            revision: 0,
        };
        let begins = |number: usize, attempt: u32, due: &[Kind]| Told::Begins {
            key: key(number),
            attempt,
            due: due.to_vec(),
            tokens: [7, 3],
        };
        let mut seen = Observed::of(&scenarios);
        // Lines may come in another order than their times.
        seen.struck(150, Kind::WorkerKill, key(0), 1);
        seen.told(100, begins(0, 1, &[Kind::WorkerKill]));
        seen.struck(200, Kind::OrchestratorKill, key(1), 1);
        seen.told(210, begins(1, 1, &[Kind::LlmError]));
        seen.rose(300);
        seen.told(450, begins(0, 2, &[]));
        seen.ended(900, &scenarios[0].1.id, ScenarioEnd::Failed);
        seen.ended(950, &scenarios[0].1.id, ScenarioEnd::Failed);
        assert_eq!(seen.open(), 1);
        let played = seen.closed(cell, Snapshot::default(), vec!["a rule: broken".to_owned()]);
        let tally = |kind: Kind| played.faults.get(&kind).map_or((0, 0), |one| (one.scheduled, one.struck));
        assert_eq!(tally(Kind::WorkerKill), (1, 1));
        assert_eq!(tally(Kind::LlmError), (1, 0), "it was drawn, and no report of it is in the store");
        assert_eq!(played.recoveries, [(Kind::OrchestratorKill, 250), (Kind::WorkerKill, 300)]);
        assert_eq!(
            played.attempts.iter().map(|row| row.outcome).collect::<Vec<_>>(),
            ["killed", "taken away", "taken away"]
        );
        let safety = &played.safety;
        assert_eq!(
            (safety.lost, safety.doubled, safety.complaints),
            (2, 0, 1),
            "no row of them is in the store: {safety:?}"
        );
        assert_eq!(played.scenarios[0].ended_ms, Some(900));
        assert_eq!(
            (played.scenarios[0].attempts, played.scenarios[0].jobs, played.scenarios[0].tokens),
            (2, 1, [14, 6])
        );
    }
}
