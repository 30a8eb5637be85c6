//! A simulated worker process: one job at a time, questions that are sent again until an answer comes, beats as long as it lives.

use socrates_model::Digest;
use socrates_model::Role;
use socrates_model::job::{Artifact, Stage};
use socrates_model::report::Verdict;
use socrates_model::wire::{Acquire, Beat, Grant, Held, Outcome as Told, Report};

use crate::fate::{Fate, Outcome};

/// What a worker sends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Message {
    /// It asks for work.
    Acquire(Acquire),
    /// It says what it holds.
    Beat(Beat),
    /// It reports an attempt.
    Report(Box<Report>),
}

/// An attempt in a worker's hand.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Work {
    /// What was granted.
    pub(crate) grant: Grant,
    /// What becomes of it.
    pub(crate) fate: Fate,
    /// Its place in the ledger.
    pub(crate) place: usize,
    /// Whether its report was sent.
    pub(crate) reported: bool,
}

/// A worker.
#[derive(Debug)]
pub(crate) struct Worker {
    /// Stage it serves.
    pub(crate) stage: Stage,
    /// Number among those of its stage.
    number: u32,
    /// How often it was started; what happens to an earlier life is nothing to it.
    pub(crate) life: u32,
    /// Whether it lives.
    pub(crate) alive: bool,
    /// Name of this life.
    pub(crate) instance: String,
    /// Questions sent so far.
    pub(crate) asked: u64,
    /// The question that waits for its answer.
    pub(crate) waits: Option<(u64, Message)>,
    /// What it works on.
    pub(crate) work: Option<Work>,
    /// Grants that a beat told it of and that it has not begun.
    pub(crate) queue: Vec<Grant>,
    /// Until when nothing that it sends or is sent gets through.
    pub(crate) cut_until: u64,
    /// Whether a hint came while a question was under way, so that its "no work" may be old.
    pub(crate) hinted: bool,
}

impl Worker {
    /// A worker that is to be started.
    pub(crate) fn new(stage: Stage, number: u32) -> Self {
        Self {
            stage,
            number,
            life: 0,
            alive: false,
            instance: String::new(),
            asked: 0,
            waits: None,
            work: None,
            queue: Vec::new(),
            cut_until: 0,
            hinted: false,
        }
    }

    /// It starts, as somebody new.
    pub(crate) fn start(&mut self) {
        self.life += 1;
        self.alive = true;
        self.instance = format!("{}-{}-{}", self.stage, self.number, self.life);
    }

    /// It dies with all that it holds.
    pub(crate) fn die(&mut self) -> Option<Work> {
        self.alive = false;
        self.waits = None;
        self.hinted = false;
        self.queue.clear();
        self.cut_until = 0;
        self.work.take()
    }

    /// Whether it has nothing to do and no question under way.
    pub(crate) const fn is_idle(&self) -> bool {
        self.alive && self.waits.is_none() && self.work.is_none()
    }

    /// Its next question for work.
    pub(crate) fn acquire(&self) -> Message {
        Message::Acquire(Acquire {
            req_id: format!("{}/{}", self.instance, self.asked),
            instance: self.instance.clone(),
            stages: vec![self.stage],
            credits: 1,
            code_version: String::new(),
        })
    }

    /// Its beat.
    pub(crate) fn beat(&self) -> Message {
        let grants = self.work.iter().map(|work| &work.grant).chain(&self.queue);
        let held: Vec<Held> = grants
            .map(|grant| Held {
                key: grant.spec.key.clone(),
                attempt: grant.attempt,
                fence: grant.fence,
                characters: 0,
            })
            .collect();
        Message::Beat(Beat { instance: self.instance.clone(), held, draining: false })
    }

    /// Whether it knows this grant already.
    pub(crate) fn holds(&self, grant: &Grant) -> bool {
        let mut held = self.work.iter().map(|work| &work.grant).chain(&self.queue);
        held.any(|held| held.fence == grant.fence && held.spec.key == grant.spec.key)
    }
}

/// The report of an attempt that has come to its end. `wrong` says whether what it judges is wrong, `wish_ms` which wait a
/// server asks for that was asked too much.
pub(crate) fn report(instance: &str, work: &Work, wrong: bool, wish_ms: Option<u64>) -> Report {
    let (grant, fate) = (&work.grant, &work.fate);
    let key = &grant.spec.key;
    let artifact = |role: Role, text: String| Artifact {
        role,
        digest: Digest::of(text.as_bytes()),
        len: text.len() as u64,
        media: "application/json".to_owned(),
        inline: None,
    };
    let (outcome, artifacts) = match fate.outcome.failure() {
        None => {
            let made = Role::made_by(key.stage).map(|role| artifact(role, made(work)));
            (Told::Ok, made.into_iter().collect())
        }
        Some((class, fault)) => {
            // What was refused lies beside the report, so that the author can be shown it.
            let refused = fate.outcome.answered().map(|_| artifact(Role::Refused, format!("refused {}", grant.fence)));
            let retry_after_ms = wish_ms.filter(|_| fate.outcome == Outcome::Overload);
            (Told::Failed { class, faults: vec![fault], retry_after_ms }, refused.into_iter().collect())
        }
    };
    let judged = key.stage == Stage::Scoring && outcome == Told::Ok;
    let verdict = judged.then_some(if wrong { Verdict::Contradicted } else { Verdict::Realised });
    let [tokens_in, tokens_out] = fate.tokens;
    Report {
        instance: instance.to_owned(),
        key: key.clone(),
        attempt: grant.attempt,
        fence: grant.fence,
        outcome,
        artifacts,
        wall_ms: fate.works_ms,
        tokens: (tokens_in, tokens_out),
        remark: String::new(),
        repair: None,
        anew: Vec::new(),
        verdict,
        rates: None,
    }
}

/// What a successful attempt makes: a text that no other attempt makes.
pub(crate) fn made(work: &Work) -> String {
    let key = &work.grant.spec.key;
    let wrong = if work.fate.outcome == Outcome::Unseen { "wrong" } else { "right" };
    format!("{wrong} {key} {}", work.grant.fence)
}
