//! The owner of the state: one task, events in one line, timers from the monotonic clock.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use socrates_kit::BlobError;
use socrates_model::TraceContext;
use socrates_model::job::Stage;
use socrates_model::wire::{Acquire, Acquired, NoWork, Outcome, Report};
use socrates_orchestrator::{Answer, Effect, Event, Millis, Row, Scenario, State, Token, status, step};
use tokio::sync::mpsc;

use super::counts::Counts;
use super::metrics;
use super::reader::{Came, Inbound, Question};
use super::writer::{Commit, Reply, Said, Say};

/// How long an acquire without work waits for some, ms. Well below the workers' query limit of 2 s.
const HOLD_MS: Millis = 1_000;
/// Pause after which a worker that has waited in vain asks again, ms: at once, so that somebody always waits where work appears.
const AGAIN_MS: Millis = 1;
/// Acquires held at one time at most; more are answered at once.
const HELD: usize = 4096;
/// Longest pause between two looks at the clock, ms.
const PAUSE_MS: Millis = 1_000;

/// The row of an effect, if it is one.
pub(super) fn row(effect: Effect) -> Option<Row> {
    match effect {
        Effect::Save(row) => Some(row),
        Effect::Reply { .. } | Effect::Notice { .. } | Effect::Hint(_) | Effect::ScenarioDone { .. } => None,
    }
}

/// The stage of an effect that is a hint.
fn hint(effect: &Effect) -> Option<Stage> {
    match effect {
        Effect::Hint(stage) => Some(*stage),
        Effect::Save(_) | Effect::Reply { .. } | Effect::Notice { .. } | Effect::ScenarioDone { .. } => None,
    }
}

/// The pause that an answer without work asks for.
fn pause_of_idle(effect: &mut Effect) -> Option<&mut Millis> {
    let Effect::Reply { answer, .. } = effect else { return None };
    match &mut **answer {
        Answer::Acquired(Acquired::None { retry_after_ms, reason: NoWork::Empty }) => Some(retry_after_ms),
        Answer::Acquired(_)
        | Answer::Welcome(_)
        | Answer::Beat(_)
        | Answer::Recorded(_)
        | Answer::Submitted(_)
        | Answer::Steered(_) => None,
    }
}

/// A line for each attempt that is handed out.
fn tell_of_grants(effects: &[Effect], worker: &str) {
    for effect in effects {
        let Effect::Reply { answer, .. } = effect else { continue };
        let Answer::Acquired(Acquired::Grants(grants)) = &**answer else { continue };
        for grant in grants {
            let (key, trace) = (&grant.spec.key, grant.traceparent);
            tracing::info!(
                job = %key, scenario = %key.scenario, stage = key.stage.name(), attempt = grant.attempt, fence = grant.fence,
                worker, trace_id = trace.map(|trace| trace.trace_id()), span_id = trace.map(|trace| trace.span_id()),
                "an attempt is handed out"
            );
        }
    }
}

/// A line for each report, in the trace that its worker says.
fn tell_of(report: &Report, trace: Option<TraceContext>) {
    let key = &report.key;
    let outcome = if report.outcome == Outcome::Ok { "ok" } else { "failed" };
    tracing::info!(
        job = %key, scenario = %key.scenario, stage = key.stage.name(), attempt = report.attempt, fence = report.fence,
        worker = report.instance, outcome, wall_ms = report.wall_ms, trace_id = trace.map(|trace| trace.trace_id()),
        span_id = trace.map(|trace| trace.span_id()), "a report came"
    );
}

/// An acquire that waits for work.
struct Waiting {
    until: Millis,
    acquire: Acquire,
    came: Came,
}

/// Owns the state. Dropping it ends the writer's line.
pub(super) struct Owner {
    state: State,
    started: Instant,
    /// Scenarios that were done when it began.
    done_before: usize,
    writer: mpsc::Sender<Commit>,
    asks: BTreeMap<Token, Came>,
    next: Token,
    waiting: VecDeque<Waiting>,
    counts: Counts,
}

impl Owner {
    pub(super) fn new(state: State, started: Instant, writer: mpsc::Sender<Commit>, counts: Counts) -> Self {
        let done_before = state.counts().1;
        let (asks, waiting) = (BTreeMap::new(), VecDeque::new());
        Self { state, started, done_before, writer, asks, next: 0, waiting, counts }
    }

    fn now(&self) -> Millis {
        u64::try_from(self.started.elapsed().as_millis()).unwrap_or(u64::MAX)
    }

    /// Works through the line until it ends, or the disk is full and nobody waits.
    pub(super) async fn run(&mut self, mut line: mpsc::Receiver<Inbound>) -> Option<BlobError> {
        // What the rebuilt state has to offer.
        let hints = Stage::WORKERS.into_iter().filter(|stage| self.state.has_ready(*stage)).map(Effect::Hint).collect();
        self.commit(hints).await;
        loop {
            let wait = Duration::from_millis(self.pause());
            tokio::select! {
                inbound = line.recv() => match inbound {
                    Some(Inbound::Asked(question, came)) => self.asked(question, came).await,
                    Some(Inbound::Gone(instance)) => {
                        // Nobody is left to hear the answer; a grant to it would only wait for its lease to end.
                        self.waiting.retain(|waiting| waiting.acquire.instance != instance);
                        self.event(Event::Gone { instance }).await;
                    }
                    // A collector that went away needs no answer.
                    Some(Inbound::Counted(answer)) => {
                        drop(answer.send(metrics::text(&self.state, self.now(), &self.counts.now())));
                    }
                    Some(Inbound::Full(why)) => return Some(why),
                    None => return None,
                },
                () = tokio::time::sleep(wait) => {}
            }
            let now = self.now();
            if self.state.next_due().is_some_and(|due| due <= now) || wait.is_zero() || self.state.author_wake_at > 0 {
                self.event(Event::Tick).await;
            }
            self.give_up_waiting(now).await;
        }
    }

    fn pause(&self) -> Millis {
        let now = self.now();
        let due = self.state.next_due().unwrap_or(Millis::MAX);
        let held = self.waiting.front().map_or(Millis::MAX, |waiting| waiting.until);
        due.min(held).saturating_sub(now).min(PAUSE_MS)
    }

    async fn asked(&mut self, question: Question, came: Came) {
        self.next += 1;
        let to = self.next;
        let mut leaving = None;
        let event = match question {
            Question::Status(about) => {
                let mut reply = status(&self.state, &about, self.now());
                reply.serving_ms = self.now();
                reply.done_before = u32::try_from(self.done_before).unwrap_or(u32::MAX);
                // Behind the rows it speaks of, as every answer.
                let said = Said { replies: vec![Reply { came, say: Say::Status(Box::new(reply)) }], ..Said::default() };
                return self.send(Commit { rows: Vec::new(), said }).await;
            }
            Question::Acquire(acquire) => return self.acquire(acquire, came, None).await,
            Question::Hello(hello) => Event::Hello { hello, to },
            Question::Beat(beat) => {
                leaving = beat.draining.then(|| beat.instance.clone());
                Event::Beat { beat, to }
            }
            Question::Report(report) => {
                tell_of(&report, came.trace);
                Event::Report { report, to }
            }
            Question::Release(release) => Event::Release { release, to },
            Question::Submit(submit) => Event::Submit { submit, to },
            Question::Control(control) => Event::Control { control, to },
        };
        self.asks.insert(to, came);
        self.event(event).await;
        if let Some(instance) = leaving {
            self.give_up_of(&instance).await;
        }
    }

    /// One step, and the acquires that it can serve now, in one commit: who waits for work hears of it as soon as
    /// the work is durable.
    async fn event(&mut self, event: Event) {
        let now = self.now();
        let mut effects = step(&mut self.state, event, now);
        let mut hinted: Vec<Stage> = effects.iter().filter_map(hint).collect();
        if !hinted.is_empty() {
            for waiting in std::mem::take(&mut self.waiting) {
                if waiting.acquire.stages.iter().any(|stage| hinted.contains(stage)) {
                    effects.extend(self.acquired(waiting.acquire, waiting.came, Some(waiting.until)));
                } else {
                    self.waiting.push_back(waiting);
                }
            }
            // A hint wakes every worker of its stage: only work that is left over is worth that.
            hinted.retain(|stage| self.state.has_ready(*stage));
            effects.retain(|effect| hint(effect).is_none_or(|stage| hinted.contains(&stage)));
        }
        self.commit(effects).await;
    }

    /// Answers an acquire, or lets it wait a little for work: then there is nothing to commit.
    fn acquired(&mut self, acquire: Acquire, came: Came, until: Option<Millis>) -> Vec<Effect> {
        self.next += 1;
        let to = self.next;
        let now = self.now();
        let mut effects = step(&mut self.state, Event::Acquire { ask: acquire.clone(), to }, now);
        let mut idle = false;
        for pause in effects.iter_mut().filter_map(pause_of_idle) {
            idle = true;
            if until.is_some() {
                *pause = AGAIN_MS;
            }
        }
        let until = until.unwrap_or_else(|| now.saturating_add(HOLD_MS));
        if idle && until > now && self.waiting.len() < HELD {
            let at = self.waiting.partition_point(|other| other.until <= until);
            self.waiting.insert(at, Waiting { until, acquire, came });
            return Vec::new();
        }
        tell_of_grants(&effects, &acquire.instance);
        self.asks.insert(to, came);
        effects
    }

    async fn acquire(&mut self, acquire: Acquire, came: Came, until: Option<Millis>) {
        let effects = self.acquired(acquire, came, until);
        self.commit(effects).await;
    }

    async fn give_up_waiting(&mut self, now: Millis) {
        while self.waiting.front().is_some_and(|waiting| waiting.until <= now) {
            if let Some(waiting) = self.waiting.pop_front() {
                self.acquire(waiting.acquire, waiting.came, Some(0)).await;
            }
        }
    }

    /// Answers what a worker that is about to leave has asked before: it gets no more work.
    async fn give_up_of(&mut self, instance: &str) {
        for waiting in std::mem::take(&mut self.waiting) {
            if waiting.acquire.instance == instance {
                self.acquire(waiting.acquire, waiting.came, Some(0)).await;
            } else {
                self.waiting.push_back(waiting);
            }
        }
    }

    /// Hands the effects of a step to the writer: rows to be saved, the rest to be told afterwards.
    async fn commit(&mut self, effects: Vec<Effect>) {
        let mut commit = Commit::default();
        for effect in effects {
            match effect {
                Effect::Save(row) => commit.rows.push(row),
                Effect::Reply { to, answer } => {
                    if let Some(came) = self.asks.remove(&to) {
                        commit.said.replies.push(Reply { came, say: Say::Answer(answer) });
                    }
                }
                Effect::Notice { batch, notice } => commit.said.notices.push((batch, *notice)),
                Effect::Hint(stage) => commit.said.hints.push(stage),
                Effect::ScenarioDone { id, end } => {
                    let trace = || self.state.scenarios.get(&id).map(Scenario::trace);
                    tracing::info!(
                        scenario = %id, result = end.name(), trace_id = trace().map(|trace| trace.trace_id()),
                        "a scenario ended"
                    );
                }
            }
        }
        if commit.rows.is_empty() && commit.said.is_empty() {
            return;
        }
        self.send(commit).await;
    }

    async fn send(&mut self, commit: Commit) {
        if self.writer.send(commit).await.is_err() {
            // The writer has ended with an error that the process ends with, too.
            tracing::error!("a step could not be saved");
        }
    }
}
