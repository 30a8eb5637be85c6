//! Control: pause, resume, cancel, requeue. It is said what came of it, and what was left as it was.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::ScenarioId;
use socrates_model::job::{JobKey, Stage};
use socrates_model::standing::ScenarioEnd;
use socrates_model::wire::{Chosen, Control, Left, Part, Steer, Steered, Submitted};

use crate::event::{Answer, Row, Token};
use crate::state::{JobState, Tries};
use crate::turn::Turn;

/// Names that are told with a reason, at most.
const SOME: usize = 8;
/// Characters of a name that is not known, at most.
const NAME_CHARS: usize = 100;

/// Said of a scenario that was never submitted.
const UNKNOWN: &str = "is not known here";

/// What was left as it was: names by reason.
#[derive(Default)]
struct Leaves(BTreeMap<Why, (u32, Vec<String>)>);

/// Why something was left as it was.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Why {
    text: String,
    /// Whether nothing of the name is there.
    unknown: bool,
}

impl Why {
    fn unknown(text: impl Into<String>) -> Self {
        Self { text: text.into(), unknown: true }
    }
}

impl From<String> for Why {
    fn from(text: String) -> Self {
        Self { text, unknown: false }
    }
}

impl From<&str> for Why {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl Leaves {
    fn add(&mut self, why: impl Into<Why>, name: &str) {
        let (count, some) = self.0.entry(why.into()).or_default();
        *count += 1;
        if some.len() < SOME {
            some.push(name.chars().take(NAME_CHARS).collect());
        }
    }

    fn told(self) -> Vec<Left> {
        let left =
            |(why, (count, some)): (Why, (u32, Vec<String>))| Left { why: why.text, count, some, unknown: why.unknown };
        self.0.into_iter().map(left).collect()
    }
}

/// What was done to one scenario.
struct Touched {
    jobs: u32,
    held: u32,
}

impl Turn<'_> {
    pub(crate) fn control(&mut self, control: &Control, to: Token) {
        let part = |batch: &String| if batch.is_empty() { Part::All } else { Part::Batch(batch.clone()) };
        let steer = match control {
            Control::Pause(batch) => Steer::Pause(part(batch)),
            Control::Resume(batch) => Steer::Resume(part(batch)),
            Control::Cancel(batch) if batch.is_empty() => Steer::Cancel(Chosen::All),
            Control::Cancel(batch) => Steer::Cancel(Chosen::Batch(batch.clone())),
            Control::Requeue(id) => Steer::Requeue(Chosen::Scenarios(vec![id.clone()])),
            Control::Steer(steer) => {
                let steered = self.steer(steer);
                return self.reply(to, Answer::Steered(steered));
            }
        };
        // A question in the old way is answered with a number, or refused where nothing could be meant.
        let refused = if let Control::Requeue(id) = control {
            self.scenario(id).is_none_or(|scenario| scenario.canceled)
        } else {
            false
        };
        let steered = self.steer(&steer);
        let answer = match steered.left.into_iter().next().filter(|_| refused) {
            Some(left) => Submitted::Refused { why: format!("scenario `{}` {}", left.some.concat(), left.why) },
            None => Submitted::Accepted { new: steered.scenarios, held: 0 },
        };
        self.reply(to, Answer::Submitted(answer));
    }

    fn steer(&mut self, steer: &Steer) -> Steered {
        match steer {
            Steer::Pause(part) => self.pause(part, true),
            Steer::Resume(part) => self.pause(part, false),
            Steer::Cancel(chosen) => {
                let mut steered = self.each(chosen, Self::cancel);
                let batches: Vec<String> = match chosen {
                    Chosen::All => self.state.batches.keys().cloned().collect(),
                    Chosen::Batch(batch) => vec![batch.clone()],
                    Chosen::Scenarios(_) => Vec::new(),
                };
                for batch in batches {
                    let left = self.leave_out(&batch, ScenarioEnd::Canceled);
                    steered.scenarios = steered.scenarios.saturating_add(left);
                }
                steered
            }
            Steer::Requeue(chosen) => self.each(chosen, Self::requeue),
        }
    }

    /// Names of the batches that there are, each in quotes.
    fn batches(&self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for scenario in self.state.by_order.values().rev().filter_map(|id| self.state.scenarios.get(id)) {
            if names.len() >= SOME {
                break;
            }
            if !names.contains(&scenario.batch.as_str()) {
                names.push(&scenario.batch);
            }
        }
        let quoted: Vec<String> = names.iter().rev().map(|name| format!("`{name:.NAME_CHARS$}`")).collect();
        if quoted.is_empty() { "nothing was submitted yet".to_owned() } else { format!("known: {}", quoted.join(", ")) }
    }

    fn knows(&self, batch: &str) -> bool {
        self.state.batches.contains_key(batch)
    }

    fn no_batch(&self, batch: &str) -> Steered {
        let mut leaves = Leaves::default();
        leaves.add(Why::unknown(format!("there is no batch of this name; {}", self.batches())), batch);
        Steered { left: leaves.told(), ..Steered::default() }
    }

    /// Whether a part is held back by itself.
    fn is_paused(&self, part: &Part) -> bool {
        match part {
            Part::All => self.state.paused.contains(""),
            Part::Batch(batch) => self.state.paused.contains(batch),
            Part::Stage(stage) => self.state.paused_stages.contains(stage),
        }
    }

    fn pause(&mut self, part: &Part, paused: bool) -> Steered {
        if let Part::Batch(batch) = part
            && !self.knows(batch)
            && (paused || !self.is_paused(part))
        {
            return self.no_batch(batch);
        }
        let mut leaves = Leaves::default();
        let name = match part {
            Part::All => "everything",
            Part::Batch(batch) => batch.as_str(),
            Part::Stage(stage) => stage.name(),
        };
        let single = paused || *part != Part::All;
        if self.is_paused(part) == paused && single {
            leaves.add(if paused { "was held back already" } else { "was not held back by itself" }, name);
        }
        if !paused && *part != Part::All && self.is_paused(&Part::All) {
            leaves.add("everything is held back; resuming everything lets it go on", name);
        }
        if !paused && *part == Part::All && self.state.paused.is_empty() && self.state.paused_stages.is_empty() {
            leaves.add("nothing was held back", name);
            return Steered { left: leaves.told(), ..Steered::default() };
        }
        let batch = if let Part::Batch(batch) = part { batch.as_str() } else { "" };
        match (part, paused) {
            // Everything goes on: whatever was held back by itself, too.
            (Part::All, false) => {
                self.state.paused.clear();
                self.state.paused_stages.clear();
            }
            (Part::All | Part::Batch(_), true) => {
                self.state.paused.insert(batch.to_owned());
            }
            (Part::Batch(_), false) => {
                self.state.paused.remove(batch);
            }
            (Part::Stage(stage), true) => {
                self.state.paused_stages.insert(*stage);
            }
            (Part::Stage(stage), false) => {
                self.state.paused_stages.remove(stage);
            }
        }
        if !paused {
            for stage in Stage::WORKERS.into_iter().chain([Stage::Review]) {
                if self.state.has_ready(stage) {
                    self.hint(stage);
                }
            }
        }
        self.rows.push(Row::Paused(self.state.paused.iter().cloned().collect()));
        self.rows.push(Row::PausedStages(self.state.paused_stages.iter().copied().collect()));
        Steered { left: leaves.told(), ..self.waiting_in(part) }
    }

    /// Scenarios and jobs of a part that have not ended.
    fn waiting_in(&self, part: &Part) -> Steered {
        let mut scenarios: BTreeSet<&ScenarioId> = BTreeSet::new();
        let (mut jobs, mut held) = (0, 0);
        for job in self.state.jobs.values().filter(|job| !job.state.is_terminal()) {
            let meant = match part {
                Part::All => true,
                Part::Batch(batch) => self.scenario(&job.key.scenario).is_some_and(|one| one.batch == *batch),
                Part::Stage(stage) => job.key.stage == *stage,
            };
            if meant {
                scenarios.insert(&job.key.scenario);
                let is_held = matches!(job.state, JobState::Leased | JobState::Canceling);
                held += u32::from(is_held);
                jobs += u32::from(!is_held);
            }
        }
        let scenarios = u32::try_from(scenarios.len()).unwrap_or(u32::MAX);
        Steered { scenarios, jobs, held, left: Vec::new() }
    }

    /// Does something to each chosen scenario, in order of submission where none is named.
    fn each(&mut self, chosen: &Chosen, act: fn(&mut Self, &ScenarioId) -> Result<Touched, Why>) -> Steered {
        let ids: Vec<ScenarioId> = match chosen {
            Chosen::All => self.state.by_order.values().cloned().collect(),
            Chosen::Batch(batch) if !self.knows(batch) => return self.no_batch(batch),
            Chosen::Batch(batch) => {
                let own = |id: &&ScenarioId| self.scenario(id).is_some_and(|scenario| scenario.batch == *batch);
                self.state.by_order.values().filter(own).cloned().collect()
            }
            Chosen::Scenarios(ids) => ids.clone(),
        };
        let (mut steered, mut leaves) = (Steered::default(), Leaves::default());
        for id in ids {
            match act(self, &id) {
                Ok(Touched { jobs, held }) => {
                    steered.scenarios += 1;
                    steered.jobs += jobs;
                    steered.held += held;
                }
                Err(why) => leaves.add(why, id.as_str()),
            }
        }
        Steered { left: leaves.told(), ..steered }
    }

    /// Why nothing can be done about a scenario that is not there.
    fn unknown(&self, id: &ScenarioId) -> Why {
        if self.state.queues.values().any(|queue| queue.named(id).is_some()) {
            return "stands in a series and is not made yet; only its whole batch can be given up".to_owned().into();
        }
        Why::unknown(UNKNOWN)
    }

    fn cancel(&mut self, id: &ScenarioId) -> Result<Touched, Why> {
        let Some(scenario) = self.scenario(id) else { return Err(self.unknown(id)) };
        if let Some(end) = scenario.end {
            return Err(format!("ended before: {end}").into());
        }
        if scenario.canceled {
            return Err("is given up already; its workers are told to stop".into());
        }
        let keys = scenario.jobs.clone();
        let open = |held: bool| {
            let states = keys.iter().filter_map(|key| self.job(key)).map(|job| job.state);
            let meant = states.filter(|state| !state.is_terminal() && (*state == JobState::Leased) == held);
            u32::try_from(meant.count()).unwrap_or(u32::MAX)
        };
        let touched = Touched { jobs: open(false), held: open(true) };
        if let Some(scenario) = self.scenario_mut(id) {
            scenario.canceled = true;
        }
        // From the front: what waits for a canceled job is canceled with it.
        for key in keys {
            self.cancel_job(&key);
        }
        self.moved.insert(id.clone());
        Ok(touched)
    }

    fn cancel_job(&mut self, key: &JobKey) {
        let Some(state) = self.job(key).map(|job| job.state) else { return };
        match state {
            JobState::Blocked | JobState::Ready | JobState::Delayed => {
                self.move_to(key, JobState::Canceled, "canceled");
            }
            JobState::Leased => {
                self.move_to(key, JobState::Canceling, "canceled");
                let due = self.now.saturating_add(self.state.policy.cancel_ms);
                self.arm(key, Some(due));
            }
            JobState::Canceling
            | JobState::Succeeded
            | JobState::Failed
            | JobState::Dead
            | JobState::Canceled
            | JobState::Superseded => {}
        }
    }

    /// Dead and failed jobs of the newest revision once more, with new budgets.
    fn requeue(&mut self, id: &ScenarioId) -> Result<Touched, Why> {
        let Some(scenario) = self.scenario(id) else { return Err(self.unknown(id)) };
        if scenario.canceled {
            return Err("was given up; submit it under another name".into());
        }
        let end = scenario.end;
        let revision = scenario.settled.unwrap_or(scenario.revision);
        let again: Vec<JobKey> = scenario
            .jobs
            .iter()
            .filter(|key| self.state.place(id, key.stage, &key.item, revision) == Some(*key))
            .filter(|key| self.job(key).is_some_and(|job| matches!(job.state, JobState::Failed | JobState::Dead)))
            .cloned()
            .collect();
        if again.is_empty() {
            let how = end.map_or_else(|| "is going on".to_owned(), |end| format!("ended before: {end}"));
            return Err(format!("has no dead or failed job; it {how}").into());
        }
        self.reopen(id);
        for key in &again {
            if let Some(job) = self.job_mut(key) {
                job.tries = Tries::default();
                job.delay_ms = 0;
            }
            self.move_to(key, JobState::Blocked, "requeued");
        }
        for key in &again {
            self.unblock(key);
        }
        Ok(Touched { jobs: u32::try_from(again.len()).unwrap_or(u32::MAX), held: 0 })
    }

    fn reopen(&mut self, id: &ScenarioId) {
        let Some(scenario) = self.scenario_mut(id) else { return };
        scenario.repairs = 0;
        scenario.reproposals = 0;
        if scenario.end.take().is_some() {
            let counted = scenario.started && !scenario.spec.review;
            let (batch, order, waits) = (scenario.batch.clone(), scenario.order, !scenario.started);
            self.batch_mut(&batch).anew();
            self.opened(&batch, 1);
            if waits {
                self.waits_again(order);
            }
            self.state.done = self.state.done.saturating_sub(1);
            self.state.under_way += usize::from(counted);
        }
    }
}
