//! Flaws: each is put round the sound step, or into what saves its rows, so that the core itself stays as it is.

use socrates_model::wire::{Acquired, Grant, Outcome, Recorded, Report};

use crate::histories::Dice;
use crate::state::{AttemptEnd, JobResult};
use crate::{Answer, Effect, Event, JobState, Row, State, Token, step};

/// What is wrong with an orchestrator, on purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Flaw {
    /// Nothing.
    None,
    /// It answers before its rows are saved.
    AnswersFirst,
    /// It takes a report of an attempt of before for one of the attempt that holds the job.
    NoFence,
    /// It does not know a question again that is repeated.
    NoRequestIds,
    /// Its leases are on the clock of the wall.
    WallClock,
    /// It takes a second success for a job, and its store keeps the newer.
    SecondResult,
    /// It saves the rows of a step in two transactions.
    SplitStep,
    /// It loses an entry of the outbox now and then.
    LostEntry,
    /// It saves an attempt when it ends, not when it is granted.
    LostAttempt,
    /// It does not always save that a scenario ended.
    LostEnd,
    /// It begins its fences anew after a restart.
    ReusedFences,
    /// It arms no timers after a restart.
    NoTimers,
    /// It gives a second worker what another has, rather than nothing.
    DoubleGrant,
    /// It acknowledges a report now and then without looking at it.
    LostReport,
}

impl Flaw {
    /// Every flaw, in the order of the table.
    pub(super) const ALL: [Self; 13] = [
        Self::AnswersFirst,
        Self::NoFence,
        Self::NoRequestIds,
        Self::WallClock,
        Self::SecondResult,
        Self::SplitStep,
        Self::LostEntry,
        Self::LostAttempt,
        Self::LostEnd,
        Self::ReusedFences,
        Self::NoTimers,
        Self::DoubleGrant,
        Self::LostReport,
    ];

    /// What it is called in the table.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::None => "none: the core as it is",
            Self::AnswersFirst => "answers before the rows are saved",
            Self::NoFence => "takes a stale report for the current one",
            Self::NoRequestIds => "does not know a repeated question again",
            Self::WallClock => "leases on the wall clock",
            Self::SecondResult => "commits a second result for a job",
            Self::SplitStep => "saves a step in two transactions",
            Self::LostEntry => "loses an entry of the outbox",
            Self::LostAttempt => "saves an attempt only when it ends",
            Self::LostEnd => "does not save the end of a scenario",
            Self::ReusedFences => "begins fences anew after a restart",
            Self::NoTimers => "arms no timers after a restart",
            Self::DoubleGrant => "grants a job that another worker holds",
            Self::LostReport => "acknowledges a report that it drops",
        }
    }

    /// One step of a core with this flaw. `true_now` is the monotonic clock, `wall_now` the one that people set.
    pub(super) fn step(self, state: &mut State, event: Event, clocks: (u64, u64), dice: &mut Dice) -> Vec<Effect> {
        let (true_now, wall_now) = clocks;
        match (self, event) {
            (Self::NoFence, Event::Report { report, to }) => {
                let report = Box::new(as_current(state, *report));
                step(state, Event::Report { report, to }, true_now)
            }
            (Self::NoRequestIds, Event::Acquire { mut ask, to }) => {
                ask.req_id = format!("{}#{}", ask.req_id, state.next_fence);
                step(state, Event::Acquire { ask, to }, true_now)
            }
            (Self::WallClock, event) => step(state, event, wall_now),
            (Self::SecondResult, Event::Report { report, to }) => {
                let late = report.clone();
                let effects = step(state, Event::Report { report, to }, true_now);
                second_result(state, *late, to).unwrap_or(effects)
            }
            (Self::DoubleGrant, Event::Acquire { ask, to }) => {
                let effects = step(state, Event::Acquire { ask: ask.clone(), to }, true_now);
                match held_by_another(state, &ask.instance) {
                    Some(grant) if answers_nothing(&effects) => {
                        let answer = Box::new(Answer::Acquired(Acquired::Grants(vec![grant])));
                        vec![Effect::Reply { to, answer }]
                    }
                    Some(_) | None => effects,
                }
            }
            (Self::LostReport, Event::Report { report, to }) => {
                if dice.below(20) > 0 {
                    return step(state, Event::Report { report, to }, true_now);
                }
                vec![Effect::Reply { to, answer: Box::new(Answer::Recorded(Recorded::Accepted)) }]
            }
            (_, event) => step(state, event, true_now),
        }
    }

    /// The rows of a step that reach the store.
    pub(super) fn saves(self, rows: Vec<Row>, dice: &mut Dice) -> Vec<Row> {
        let is_lost = |row: &Row, dice: &mut Dice| match (self, row) {
            (Self::LostEntry, Row::Event(..)) => dice.below(40) == 0,
            (Self::LostAttempt, Row::Attempt(_, attempt)) => attempt.end.is_none(),
            (Self::LostEnd, Row::Scenario(scenario)) => scenario.end.is_some() && dice.below(3) == 0,
            _ => false,
        };
        rows.into_iter().filter(|row| !is_lost(row, dice)).collect()
    }
}

/// The report as if the attempt that holds the job had sent it.
fn as_current(state: &State, report: Report) -> Report {
    let Some(current) = state.jobs.get(&report.key).and_then(|job| job.current()) else { return report };
    Report { attempt: current.number, fence: current.fence, instance: current.instance.clone(), ..report }
}

/// What is saved and answered where a success of another attempt takes the place of the result.
fn second_result(state: &mut State, report: Report, to: Token) -> Option<Vec<Effect>> {
    let job = state.jobs.get_mut(&report.key).filter(|job| job.state == JobState::Succeeded)?;
    let before = job.result.as_ref().filter(|result| result.attempt != 0 && result.attempt != report.attempt)?.clone();
    let idem_key = job.idem_key?;
    let attempt = job.attempts.iter_mut().find(|attempt| attempt.number == report.attempt)?;
    if report.outcome != Outcome::Ok || attempt.end == Some(AttemptEnd::Succeeded) {
        return None;
    }
    attempt.end = Some(AttemptEnd::Succeeded);
    attempt.reported = true;
    let attempt = attempt.clone();
    let result = JobResult { attempt: report.attempt, idem_key, artifacts: report.artifacts, ..before };
    job.result = Some(result.clone());
    Some(vec![
        Effect::Save(Row::Attempt(report.key.clone(), Box::new(attempt))),
        Effect::Save(Row::Result(report.key, Box::new(result))),
        Effect::Reply { to, answer: Box::new(Answer::Recorded(Recorded::Accepted)) },
    ])
}

fn answers_nothing(effects: &[Effect]) -> bool {
    effects.iter().any(|effect| match effect {
        Effect::Reply { answer, .. } => matches!(**answer, Answer::Acquired(Acquired::None { .. })),
        Effect::Save(_) | Effect::Notice { .. } | Effect::Hint(_) | Effect::ScenarioDone { .. } => false,
    })
}

/// The grant of a job that another worker has.
fn held_by_another(state: &State, instance: &str) -> Option<Grant> {
    let job = state.jobs.values().find(|job| {
        job.state == JobState::Leased && job.current().is_some_and(|attempt| attempt.instance != instance)
    })?;
    let attempt = job.current()?;
    Some(Grant {
        spec: job.spec.clone(),
        attempt: attempt.number,
        fence: attempt.fence,
        lease_ms: state.policy.lease_ms,
        deadline_ms: state.policy.deadline_ms(job.key.stage),
        idem_key: job.idem_key?,
        inline: std::collections::BTreeMap::new(),
        traceparent: None,
    })
}
