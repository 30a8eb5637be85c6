//! A batch in virtual time: the orchestrator, its workers, and everything that strikes them.
//!
//! ```text
//! heap ─► what happens next ─┬─► orchestrator: step, commit, answer, hint ─┐
//!  ▲                         └─► worker: ask, work, beat, report, die      ├─► plans ─┐
//!  └────────────────────────────────────────────────────────────────────────┴──────────┘
//! ```

use std::collections::BTreeSet;

use socrates_model::Digest;
use socrates_model::job::Stage;
use socrates_model::wire::{Acquired, BeatReply, BeatVerdict, Grant, NoWork, Priority, Recorded, Submit};
use socrates_orchestrator::{Answer, Event};

use crate::asked::{BATCH, asked, of_authors};
use crate::draws::At;
use crate::fate::{Crash, Fates, Outcome};
use crate::head::{Head, Said, Step};
use crate::heap::{Happening, Heap};
use crate::kind::Kind;
use crate::ledger::{AttemptRow, Ledger};
use crate::spec::{Cell, Spec};
use crate::worker::{self, Message, Work, Worker};

/// Virtual time at which the batch is submitted, ms.
const BEGIN_MS: u64 = 1_000;
/// Things that may happen for each scenario before the batch is given up: more than a hundred times what usually does.
const MOST_HAPPENINGS: u64 = 50_000;
/// Virtual time after which the batch is given up, ms: a hundred days.
const MOST_MS: u64 = 8_640_000_000;
/// The checker looks at the state after so many things that happened.
const CHECKED_EVERY: u64 = 2_003;

/// Plays a batch of a cell to its end.
#[must_use]
pub(crate) fn play(spec: &Spec, cell: &Cell, batch: u32, step: Step<'_>) -> Ledger {
    let policy = cell.policy.of_orchestrator(cell.tries, spec.times_ms.timeout);
    let mut played = Batch {
        spec,
        fates: Fates { spec, cell },
        now: BEGIN_MS,
        heap: Heap::default(),
        head: Head::new(step, policy),
        workers: Stage::WORKERS
            .into_iter()
            .flat_map(|stage| (0..spec.workers.of(stage)).map(move |number| Worker::new(stage, number)))
            .collect(),
        ledger: Ledger::default(),
        met: BTreeSet::new(),
        wrong: BTreeSet::new(),
        lease_ms: cell.policy.lease_ms,
        beat_ms: cell.policy.beat_ms,
    };
    played.submit(cell, batch);
    played.run();
    let complaints = [played.head.checked(), played.head.checked_rows(played.now)].concat();
    played.ledger.complained(&complaints);
    played.ledger.close(&played.head.rows, &of_authors(cell));
    played.ledger
}

struct Batch<'a> {
    spec: &'a Spec,
    fates: Fates<'a>,
    now: u64,
    heap: Heap,
    head: Head<'a>,
    workers: Vec<Worker>,
    ledger: Ledger,
    /// Fences of attempts whose report met the fault that waited for it: it strikes once.
    met: BTreeSet<u64>,
    /// Outputs that are wrong and were not found out.
    wrong: BTreeSet<Digest>,
    lease_ms: u64,
    beat_ms: u64,
}

impl Batch<'_> {
    /// Virtual time since the submission.
    const fn since(&self) -> u64 {
        self.now.saturating_sub(BEGIN_MS)
    }

    fn submit(&mut self, cell: &Cell, batch: u32) {
        let mut scenarios = Vec::new();
        for (number, scenario) in asked(self.spec, cell, batch) {
            self.ledger.submitted(scenario.id.clone(), number);
            scenarios.push(scenario);
        }
        let submit = Submit::new(BATCH, Priority::Normal, scenarios);
        let said = self.head.takes(|to| Event::Submit { submit, to }, self.now, None);
        self.tell(said, None, 0);
        for place in 0..self.workers.len() {
            // Workers do not start at the same moment.
            self.plan(place as u64, Happening::Starts(place));
        }
    }

    /// Until everything has ended, and a lease longer for what comes late.
    fn run(&mut self) {
        let most = MOST_HAPPENINGS.saturating_mul(self.ledger.scenarios.len().max(20) as u64);
        let (mut until, mut happened) = (MOST_MS, 0_u64);
        while let Some((at, what)) = self.heap.next() {
            if at > until || happened > most {
                break;
            }
            self.now = self.now.max(at);
            self.happens(what);
            if until == MOST_MS && self.ledger.is_done() {
                until = self.now.saturating_add(self.lease_ms);
            }
            happened += 1;
            if happened.is_multiple_of(CHECKED_EVERY) {
                let complaints = self.head.checked();
                self.ledger.complained(&complaints);
            }
        }
    }

    fn plan(&mut self, after_ms: u64, what: Happening) {
        self.heap.plan(self.now.saturating_add(after_ms), what);
    }

    fn happens(&mut self, what: Happening) {
        match what {
            Happening::Arrives { from, life, ask, message } => self.arrives((from, life, ask), message),
            Happening::Answered { to, life, ask, answer } => self.answered((to, life, ask), *answer),
            Happening::Hinted(stage) => self.hinted(stage),
            Happening::Again { of, life, ask } => self.again(of, life, ask),
            Happening::Polls { of, life, asked } => {
                let same = self.workers.get(of).is_some_and(|one| one.life == life && one.asked == asked);
                if same {
                    self.next(of);
                }
            }
            Happening::Done { of, life, fence } => self.done(of, life, fence),
            Happening::Dies { of, life, fence } => self.dies(of, life, fence),
            Happening::Beats { of, life } => self.beats(of, life),
            Happening::Starts(of) => self.starts(of),
            Happening::Gone(instance) => self.steps(|_| Event::Gone { instance }),
            Happening::Ticks => self.ticks(),
            Happening::Rises => {
                let (said, complaints) = self.head.rises(self.now);
                self.ledger.complained(&complaints);
                let since = self.since();
                self.ledger.caught_up(&self.head.rows, since);
                self.tell(said, None, self.spec.times_ms.commit);
            }
        }
    }

    // The orchestrator.

    /// A step that nobody waits for an answer of. A token that is lost while the orchestrator is down is lost for it: it gives
    /// every lease a full term when it comes back.
    fn steps(&mut self, event: impl FnOnce(u64) -> Event) {
        let said = self.head.takes(event, self.now, None);
        self.tell(said, None, self.spec.times_ms.commit);
    }

    fn ticks(&mut self) {
        if self.head.ticks_at != Some(self.now) {
            return;
        }
        self.head.ticks_at = None;
        if self.head.busy_until > self.now {
            return self.wake(self.head.busy_until);
        }
        self.steps(|_| Event::Tick);
    }

    fn wake(&mut self, at: u64) {
        let at = at.max(self.now.saturating_add(1));
        if self.head.ticks_at.is_none_or(|planned| planned > at) {
            self.head.ticks_at = Some(at);
            self.heap.plan(at, Happening::Ticks);
        }
    }

    fn arrives(&mut self, (from, life, ask): (usize, u32, u64), message: Message) {
        if !self.head.is_up() {
            return;
        }
        if self.head.busy_until > self.now {
            return self.heap.plan(self.head.busy_until, Happening::Arrives { from, life, ask, message });
        }
        let (crash, slow) = self.fault_of(from, &message);
        let event = |to: u64| match message {
            Message::Acquire(ask) => Event::Acquire { ask, to },
            Message::Beat(beat) => Event::Beat { beat, to },
            Message::Report(report) => Event::Report { report, to },
        };
        let said = self.head.takes(event, self.now, crash);
        if crash.is_some() {
            return self.plan(self.spec.times_ms.down, Happening::Rises);
        }
        let commit_ms = if slow { self.spec.times_ms.slow } else { self.spec.times_ms.commit };
        if slow {
            self.head.busy_until = self.now.saturating_add(commit_ms);
        }
        self.tell(said, Some((from, life, ask)), commit_ms);
    }

    /// What strikes the orchestrator at this message: a fault waits for the report of an attempt, and strikes it once.
    fn fault_of(&mut self, from: usize, message: &Message) -> (Option<Crash>, bool) {
        let Message::Report(report) = message else { return (None, false) };
        let work = self.workers.get(from).and_then(|worker| worker.work.as_ref());
        let Some(work) = work.filter(|work| work.grant.fence == report.fence) else { return (None, false) };
        let (crash, slow) = (work.fate.crash, work.fate.slow);
        if !(crash.is_some() || slow) || !self.met.insert(report.fence) {
            return (None, false);
        }
        for (kind, strikes) in [(Kind::OrchestratorKill, crash.is_some()), (Kind::SlowStore, slow)] {
            if strikes {
                self.ledger.hit(kind);
            }
        }
        (crash, slow)
    }

    /// Tells what a step said, after its commit.
    fn tell(&mut self, said: Option<Said>, asked: Option<(usize, u32, u64)>, commit_ms: u64) {
        let Some(said) = said else { return };
        let way = commit_ms.saturating_add(self.spec.times_ms.message);
        if let (Some((to, life, ask)), Some(answer)) = (asked, said.answer) {
            if let (Answer::Acquired(Acquired::Grants(_)), Some(since)) = (&*answer, self.head.died_at) {
                self.head.died_at = None;
                self.ledger.recoveries.push((Kind::OrchestratorKill, self.now.saturating_sub(since)));
            }
            self.plan(way, Happening::Answered { to, life, ask, answer });
        }
        for stage in said.hints {
            self.plan(way, Happening::Hinted(stage));
        }
        let at = self.since().saturating_add(commit_ms);
        for (id, end) in said.ended {
            self.ledger.ended(&id, end, at);
        }
        if let Some(due) = self.head.due() {
            self.wake(due);
        }
    }

    // The workers.

    /// The worker, where it still lives this life.
    fn living(&mut self, of: usize, life: u32) -> Option<&mut Worker> {
        self.workers.get_mut(of).filter(|worker| worker.alive && worker.life == life)
    }

    fn starts(&mut self, of: usize) {
        let Some(worker) = self.workers.get_mut(of) else { return };
        worker.start();
        let life = worker.life;
        self.next(of);
        self.plan(self.beat_ms, Happening::Beats { of, life });
    }

    fn send(&mut self, of: usize, ask: u64, message: Message) {
        let Some(worker) = self.workers.get(of) else { return };
        if worker.cut_until > self.now {
            return;
        }
        let life = worker.life;
        self.plan(self.spec.times_ms.message, Happening::Arrives { from: of, life, ask, message });
    }

    /// Sends a question whose answer is waited for.
    fn ask(&mut self, of: usize, message: impl FnOnce(&Worker) -> Message) {
        let Some(worker) = self.workers.get_mut(of) else { return };
        worker.asked += 1;
        let (ask, life, message) = (worker.asked, worker.life, message(worker));
        worker.waits = Some((ask, message.clone()));
        self.send(of, ask, message);
        self.plan(self.spec.times_ms.resend, Happening::Again { of, life, ask });
    }

    fn again(&mut self, of: usize, life: u32, ask: u64) {
        let waits = self.living(of, life).and_then(|worker| worker.waits.as_ref());
        if let Some(message) = waits.filter(|(waits, _)| *waits == ask).map(|(_, message)| message.clone()) {
            self.send(of, ask, message);
            self.plan(self.spec.times_ms.resend, Happening::Again { of, life, ask });
        }
    }

    fn hinted(&mut self, stage: Stage) {
        for of in 0..self.workers.len() {
            let Some(worker) = self.workers.get_mut(of).filter(|worker| worker.stage == stage && worker.alive) else {
                continue;
            };
            if worker.cut_until > self.now {
                continue;
            }
            worker.hinted = worker.waits.is_some();
            if worker.is_idle() {
                self.next(of);
            }
        }
    }

    /// An idle worker takes what it was told of, or asks.
    fn next(&mut self, of: usize) {
        let Some(worker) = self.workers.get_mut(of).filter(|worker| worker.is_idle()) else { return };
        match worker.queue.pop() {
            Some(grant) => self.begin(of, grant),
            None => self.ask(of, Worker::acquire),
        }
    }

    fn begin(&mut self, of: usize, grant: Grant) {
        let key = grant.spec.key.clone();
        let Some(scenario) = self.ledger.number(&key.scenario) else { return };
        let at = At { scenario, stage: key.stage, revision: key.revision, attempt: grant.attempt };
        let fate = self.fates.of(&grant.spec, at, self.since());
        self.ledger.due(self.fates.due(&fate));
        let row = AttemptRow {
            at,
            begun_ms: self.since(),
            ended_ms: None,
            outcome: fate.outcome.word(),
            recorded: None,
            tokens: fate.tokens,
        };
        let place = self.ledger.begun(&key, row);
        let (now, since, cut_ms) = (self.now, self.since(), self.spec.times_ms.cut);
        let Some(worker) = self.workers.get_mut(of) else { return };
        // One that is stopped does nothing meanwhile.
        let still_ms = if fate.frozen { cut_ms } else { 0 };
        let later = |ms: u64| ms.saturating_add(still_ms);
        let (life, fence, works_ms, dies_ms) =
            (worker.life, grant.fence, later(fate.works_ms), fate.dies_ms.map(later));
        for kind in [(Kind::Partition, fate.cut), (Kind::WorkerFreeze, fate.frozen)] {
            if kind.1 {
                worker.cut_until = now.saturating_add(cut_ms);
                self.ledger.struck(&key, kind.0, since);
                self.ledger.hit(kind.0);
            }
        }
        worker.work = Some(Work { grant, fate, place, reported: false });
        match dies_ms {
            Some(ms) => self.plan(ms, Happening::Dies { of, life, fence }),
            None => self.plan(works_ms, Happening::Done { of, life, fence }),
        }
    }

    fn beats(&mut self, of: usize, life: u32) {
        let Some(beat) = self.living(of, life).map(|worker| worker.beat()) else { return };
        self.send(of, 0, beat);
        self.plan(self.beat_ms, Happening::Beats { of, life });
    }

    fn done(&mut self, of: usize, life: u32, fence: u64) {
        let (since, wish) = (self.since(), Some(self.spec.times_ms.retry_after).filter(|ms| *ms > 0));
        let Some(worker) = self.workers.get_mut(of).filter(|worker| worker.alive && worker.life == life) else {
            return;
        };
        let Some(work) = worker.work.as_mut().filter(|work| work.grant.fence == fence && !work.reported) else {
            return;
        };
        work.reported = true;
        let key = &work.grant.spec.key;
        self.ledger.answered(key, work.fate.outcome.answered());
        if let Some(kind) = work.fate.outcome.kind() {
            self.ledger.struck(key, kind, since);
            if self.fates.cell.strike.kinds.contains(&kind) {
                self.ledger.hit(kind);
            }
        } else if work.fate.slow {
            self.ledger.struck(key, Kind::SlowStore, since);
        }
        if work.fate.outcome == Outcome::Unseen {
            self.wrong.insert(Digest::of(worker::made(work).as_bytes()));
        }
        let wrong = work.grant.spec.inputs.values().any(|input| self.wrong.contains(input));
        let report = worker::report(&worker.instance, work, wrong, wish);
        self.ask(of, |_| Message::Report(Box::new(report)));
    }

    fn dies(&mut self, of: usize, life: u32, fence: u64) {
        let since = self.since();
        let Some(worker) = self.workers.get_mut(of).filter(|worker| worker.alive && worker.life == life) else {
            return;
        };
        if worker.work.as_ref().is_none_or(|work| work.grant.fence != fence) {
            return;
        }
        let instance = worker.instance.clone();
        if let Some(work) = worker.die() {
            self.ledger.stopped(work.place, "killed", since);
            self.ledger.struck(&work.grant.spec.key, Kind::WorkerKill, since);
            self.ledger.hit(Kind::WorkerKill);
        }
        self.plan(self.spec.times_ms.token, Happening::Gone(instance));
        self.plan(self.spec.times_ms.restart, Happening::Starts(of));
    }

    fn answered(&mut self, (to, life, ask): (usize, u32, u64), answer: Answer) {
        let now = self.now;
        let Some(worker) = self.living(to, life).filter(|worker| worker.cut_until <= now) else { return };
        let waited = worker.waits.as_ref().is_some_and(|(waits, _)| *waits == ask);
        match answer {
            Answer::Acquired(acquired) if waited => {
                worker.waits = None;
                self.acquired(to, acquired);
            }
            Answer::Recorded(said) if waited && said != Recorded::Busy => {
                worker.waits = None;
                self.recorded(to, said);
            }
            Answer::Beat(reply) => self.told(to, reply),
            Answer::Acquired(_)
            | Answer::Recorded(_)
            | Answer::Welcome(_)
            | Answer::Submitted(_)
            | Answer::Steered(_) => {}
        }
    }

    fn acquired(&mut self, of: usize, acquired: Acquired) {
        let Some(worker) = self.workers.get_mut(of) else { return };
        let hinted = std::mem::take(&mut worker.hinted);
        match acquired {
            Acquired::Grants(grants) => {
                let new: Vec<Grant> = grants.into_iter().filter(|grant| !worker.holds(grant)).collect();
                worker.queue.extend(new);
                self.next(of);
            }
            Acquired::None { .. } if hinted || !worker.queue.is_empty() => self.next(of),
            Acquired::None { retry_after_ms, reason } => {
                let (life, asked) = (worker.life, worker.asked);
                let wait = if reason == NoWork::Empty { self.spec.times_ms.poll } else { retry_after_ms };
                self.plan(wait, Happening::Polls { of, life, asked });
            }
        }
    }

    fn recorded(&mut self, of: usize, said: Recorded) {
        let since = self.since();
        let Some(work) = self.workers.get_mut(of).and_then(|worker| worker.work.take()) else { return };
        let is_result = work.fate.outcome.failure().is_none();
        self.ledger.recorded(work.place, (&work.grant.spec.key, work.grant.attempt), said, is_result, since);
        self.next(of);
    }

    /// What a beat was answered: work that is needless is dropped, grants whose answer was lost are taken.
    fn told(&mut self, of: usize, reply: BeatReply) {
        let since = self.since();
        let Some(worker) = self.workers.get_mut(of) else { return };
        for (key, attempt, verdict) in reply.verdicts {
            if verdict == BeatVerdict::Ok {
                continue;
            }
            worker.queue.retain(|grant| grant.spec.key != key || grant.attempt != attempt);
            let is_it = |work: &mut Work| work.grant.spec.key == key && work.grant.attempt == attempt && !work.reported;
            if let Some(work) = worker.work.take_if(is_it) {
                let how = if verdict == BeatVerdict::Cancel { "canceled" } else { "taken away" };
                self.ledger.stopped(work.place, how, since);
            }
        }
        for grant in reply.missing {
            if !worker.holds(&grant) {
                worker.queue.push(grant);
            }
        }
        self.next(of);
    }
}
