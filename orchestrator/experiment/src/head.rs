//! The orchestrator of a batch: the real state machine, the rows that it commits, and what a crash leaves of it.

use socrates_model::job::Stage;
use socrates_model::{ScenarioEnd, ScenarioId};
use socrates_orchestrator::{Answer, Effect, Event, Policy, State, fsck};

use crate::fate::Crash;
use crate::rows::Rows;

/// The orchestrator's step. The simulator is handed it, so that a test can hand it a broken one.
pub type Step<'a> = &'a (dyn Fn(&mut State, Event, u64) -> Vec<Effect> + Sync);

/// The question whose answer is wanted from a step.
const TOKEN: u64 = 1;

/// What comes out of a step beside its rows.
#[derive(Debug, Default)]
pub(crate) struct Said {
    /// The answer to the question.
    pub(crate) answer: Option<Box<Answer>>,
    /// Stages that have work.
    pub(crate) hints: Vec<Stage>,
    /// Scenarios that ended.
    pub(crate) ended: Vec<(ScenarioId, ScenarioEnd)>,
}

/// An orchestrator process and its store.
pub(crate) struct Head<'a> {
    step: Step<'a>,
    policy: Policy,
    state: Option<State>,
    pub(crate) rows: Rows,
    epoch: u64,
    /// Until when a slow commit keeps it from everything else.
    pub(crate) busy_until: u64,
    /// When its next timer is planned; none where nothing is.
    pub(crate) ticks_at: Option<u64>,
    /// When it died and has handed nothing out since.
    pub(crate) died_at: Option<u64>,
}

impl<'a> Head<'a> {
    /// A new one, with an empty store.
    pub(crate) fn new(step: Step<'a>, policy: Policy) -> Self {
        Self {
            step,
            state: Some(State::new(policy.clone())),
            policy,
            rows: Rows::default(),
            epoch: 1,
            busy_until: 0,
            ticks_at: None,
            died_at: None,
        }
    }

    /// Whether it runs.
    pub(crate) const fn is_up(&self) -> bool {
        self.state.is_some()
    }

    /// One step, committed; nothing where it is down, or dies over it.
    pub(crate) fn takes(&mut self, event: impl FnOnce(u64) -> Event, now: u64, crash: Option<Crash>) -> Option<Said> {
        let state = self.state.as_mut()?;
        let effects = (self.step)(state, event(TOKEN), now);
        if let Some(crash) = crash {
            self.state = None;
            self.ticks_at = None;
            self.died_at.get_or_insert(now);
            if crash == Crash::BeforeCommit {
                return None;
            }
        }
        let said = self.commit(effects);
        crash.is_none().then_some(said)
    }

    /// Saves the rows of a step, and says what is to be told.
    fn commit(&mut self, effects: Vec<Effect>) -> Said {
        let mut said = Said::default();
        for effect in effects {
            match effect {
                Effect::Save(row) => self.rows.save(row),
                Effect::Reply { to: TOKEN, answer } => said.answer = Some(answer),
                Effect::Hint(stage) => said.hints.push(stage),
                Effect::ScenarioDone { id, end } => said.ended.push((id, end)),
                Effect::Reply { .. } | Effect::Notice { .. } => {}
            }
        }
        said
    }

    /// Starts it again on what was saved; what the checker says of it comes with it.
    pub(crate) fn rises(&mut self, now: u64) -> (Option<Said>, Vec<String>) {
        self.epoch += 1;
        self.busy_until = now;
        self.state = Some(State::restore(self.rows.snapshot(self.epoch), self.policy.clone(), now));
        let said = self.takes(|_| Event::Recover { alone: false }, now, None);
        (said, self.checked())
    }

    /// When it wants to be woken.
    pub(crate) fn due(&self) -> Option<u64> {
        let state = self.state.as_ref()?;
        let wake = Some(state.author_wake_at).filter(|at| *at > 0);
        [state.next_due(), wake].into_iter().flatten().min()
    }

    /// What the checker says of the state.
    pub(crate) fn checked(&self) -> Vec<String> {
        self.state.as_ref().map(fsck).unwrap_or_default()
    }

    /// What the checker says of what another orchestrator would find in the store.
    pub(crate) fn checked_rows(&self, now: u64) -> Vec<String> {
        let mut state = State::restore(self.rows.snapshot(self.epoch + 1), self.policy.clone(), now);
        drop(socrates_orchestrator::step(&mut state, Event::Recover { alone: false }, now));
        fsck(&state)
    }
}
