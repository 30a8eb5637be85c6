//! A small world for tests: a state, a clock, workers, and the checker after every step.

use std::collections::BTreeMap;

use socrates_model::fault::{FailureClass, Fault, FaultCode, Where};
use socrates_model::job::{Artifact, Item, JobKey, Stage};
use socrates_model::report::{Repair, Verdict};
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatReply, Control, Grant, Held, Outcome, Priority, Recorded, Release, Report,
    ScenarioSpec, Submit, Submitted,
};
use socrates_model::{Digest, PlannerName, Role, ScenarioId};

use crate::{Answer, Effect, Event, Job, JobState, Policy, Row, Scenario, State, Token, fsck, step};

pub(crate) struct World {
    pub(crate) state: State,
    pub(crate) now: u64,
    pub(crate) effects: Vec<Effect>,
    pub(crate) rows: Vec<Row>,
    tokens: Token,
    asked: u64,
}

pub(crate) fn spec(id: &str) -> ScenarioSpec {
    ScenarioSpec {
        id: ScenarioId::new(id).unwrap(),
        request: Digest::of(id.as_bytes()),
        location: Digest::of(b"map"),
        reading: Digest::of(b"reading"),
        seed: 7,
        planners: vec![PlannerName::reference()],
        run_seeds: vec![1],
        pinned: BTreeMap::new(),
        settings: BTreeMap::new(),
        review: false,
        order: None,
    }
}

/// A fault at a place of this name.
pub(crate) fn fault(code: FaultCode, text: &str) -> Fault {
    Fault::new(code, Where::key(text), text)
}

/// The rows that a step saves, in their order.
pub(crate) fn saved(effects: &[Effect]) -> Vec<Row> {
    let row = |effect: &Effect| match effect {
        Effect::Save(row) => Some(row.clone()),
        Effect::Reply { .. } | Effect::Notice { .. } | Effect::Hint(_) | Effect::ScenarioDone { .. } => None,
    };
    effects.iter().filter_map(row).collect()
}

/// What a step answers to this question.
pub(crate) fn answer(effects: &[Effect], token: Token) -> Option<Answer> {
    effects.iter().find_map(|effect| match effect {
        Effect::Reply { to, answer } if *to == token => Some((**answer).clone()),
        Effect::Reply { .. }
        | Effect::Save(_)
        | Effect::Notice { .. }
        | Effect::Hint(_)
        | Effect::ScenarioDone { .. } => None,
    })
}

impl World {
    pub(crate) fn new() -> Self {
        Self::with(Policy::default())
    }

    pub(crate) fn with(policy: Policy) -> Self {
        Self { state: State::new(policy), now: 1_000, effects: Vec::new(), rows: Vec::new(), tokens: 0, asked: 0 }
    }

    pub(crate) fn send(&mut self, event: impl FnOnce(Token) -> Event) -> Option<Answer> {
        self.tokens += 1;
        let token = self.tokens;
        self.effects = step(&mut self.state, event(token), self.now);
        let wrong = fsck(&self.state);
        assert!(wrong.is_empty(), "{wrong:#?}");
        self.rows.extend(saved(&self.effects));
        answer(&self.effects, token)
    }

    pub(crate) fn submit(&mut self, specs: Vec<ScenarioSpec>) -> Submitted {
        self.submit_as("b", Priority::Normal, specs)
    }

    pub(crate) fn submit_as(&mut self, batch: &str, priority: Priority, scenarios: Vec<ScenarioSpec>) -> Submitted {
        let submit = Submit::new(batch, priority, scenarios);
        match self.send(|to| Event::Submit { submit, to }) {
            Some(Answer::Submitted(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn control(&mut self, control: Control) -> Submitted {
        match self.send(|to| Event::Control { control, to }) {
            Some(Answer::Submitted(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn ask(&mut self, instance: &str, stages: &[Stage], credits: u32) -> Acquired {
        self.asked += 1;
        let req_id = format!("q{}", self.asked);
        self.ask_as(instance, stages, credits, &req_id)
    }

    pub(crate) fn ask_as(&mut self, instance: &str, stages: &[Stage], credits: u32, req_id: &str) -> Acquired {
        let ask = Acquire {
            req_id: req_id.to_owned(),
            instance: instance.to_owned(),
            stages: stages.to_vec(),
            credits,
            code_version: "1".to_owned(),
        };
        match self.send(|to| Event::Acquire { ask, to }) {
            Some(Answer::Acquired(answer)) => answer,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn grants(&mut self, instance: &str, stage: Stage) -> Vec<Grant> {
        match self.ask(instance, &[stage], 16) {
            Acquired::Grants(grants) => grants,
            Acquired::None { .. } => Vec::new(),
        }
    }

    pub(crate) fn grant(&mut self, instance: &str, stage: Stage) -> Grant {
        match self.ask(instance, &[stage], 1) {
            Acquired::Grants(mut grants) => grants.remove(0),
            Acquired::None { reason, .. } => panic!("no {stage}: {reason:?}"),
        }
    }

    pub(crate) fn beat(&mut self, instance: &str, held: &[&Grant]) -> BeatReply {
        let held = held
            .iter()
            .map(|grant| Held {
                key: grant.spec.key.clone(),
                attempt: grant.attempt,
                fence: grant.fence,
                characters: 0,
            })
            .collect();
        let beat = Beat { instance: instance.to_owned(), held, draining: false };
        match self.send(|to| Event::Beat { beat, to }) {
            Some(Answer::Beat(reply)) => reply,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn release(&mut self, grant: &Grant) -> Recorded {
        self.send_release(Release {
            instance: self.holder(&grant.spec.key, grant.attempt),
            key: grant.spec.key.clone(),
            attempt: grant.attempt,
            fence: grant.fence,
        })
    }

    pub(crate) fn send_release(&mut self, release: Release) -> Recorded {
        match self.send(|to| Event::Release { release, to }) {
            Some(Answer::Recorded(recorded)) => recorded,
            other => panic!("{other:?}"),
        }
    }

    /// The worker that an attempt was granted to.
    fn holder(&self, key: &JobKey, attempt: u32) -> String {
        let found = self.state.jobs.get(key).and_then(|job| job.attempts.iter().find(|one| one.number == attempt));
        found.map_or_else(|| "w".to_owned(), |attempt| attempt.instance.clone())
    }

    /// Sends it as the worker that holds the attempt does.
    pub(crate) fn send_report(&mut self, report: Report) -> Recorded {
        let instance = self.holder(&report.key, report.attempt);
        self.send_as_it_is(Report { instance, ..report })
    }

    pub(crate) fn send_as_it_is(&mut self, report: Report) -> Recorded {
        match self.send(|to| Event::Report { report: Box::new(report), to }) {
            Some(Answer::Recorded(recorded)) => recorded,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn fail(&mut self, grant: &Grant, class: FailureClass, faults: Vec<Fault>) -> Recorded {
        let outcome = Outcome::Failed { class, faults, retry_after_ms: None };
        self.send_report(report(grant, outcome))
    }

    pub(crate) fn succeed(&mut self, grant: &Grant) -> Recorded {
        self.send_report(success(grant))
    }

    pub(crate) fn score(&mut self, grant: &Grant, verdict: Verdict, repair: Option<Repair>) -> Recorded {
        self.send_report(Report { verdict: Some(verdict), repair, ..success(grant) })
    }

    /// Grants and finishes one job of the stage.
    pub(crate) fn pass(&mut self, stage: Stage) -> Grant {
        let grant = self.grant("w", stage);
        assert_eq!(self.succeed(&grant), Recorded::Accepted);
        grant
    }

    /// Brings a lone scenario as far as its first scoring grant.
    pub(crate) fn reach_scoring(&mut self) -> Grant {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors, Stage::Simulation] {
            self.pass(stage);
        }
        self.grant("w", Stage::Scoring)
    }

    pub(crate) fn wait(&mut self, ms: u64) {
        self.now += ms;
        self.send(|_| Event::Tick);
    }

    pub(crate) fn scenario(&self, id: &str) -> &Scenario {
        &self.state.scenarios[&ScenarioId::new(id).unwrap()]
    }

    pub(crate) fn job(&self, id: &str, stage: Stage, item: Item, revision: u32) -> &Job {
        let key = JobKey { scenario: ScenarioId::new(id).unwrap(), stage, item, revision };
        self.state.jobs.get(&key).unwrap_or_else(|| panic!("no {key}"))
    }

    pub(crate) fn state_of(&self, grant: &Grant) -> JobState {
        self.state.jobs[&grant.spec.key].state
    }
}

pub(crate) fn report(grant: &Grant, outcome: Outcome) -> Report {
    Report {
        instance: "w".to_owned(),
        key: grant.spec.key.clone(),
        attempt: grant.attempt,
        fence: grant.fence,
        outcome,
        artifacts: Vec::new(),
        wall_ms: 5,
        tokens: (1, 1),
        remark: String::new(),
        repair: None,
        anew: Vec::new(),
        verdict: None,
        rates: None,
    }
}

/// A success whose outputs are a function of the inputs, as with real workers.
pub(crate) fn success(grant: &Grant) -> Report {
    let role = Role::made_by(grant.spec.key.stage);
    let artifacts = role
        .map(|role| Artifact {
            role,
            digest: Digest::of(format!("{role} {}", grant.idem_key).as_bytes()),
            len: 4,
            media: "application/json".to_owned(),
            inline: Some("text".to_owned()),
        })
        .into_iter()
        .collect();
    Report { artifacts, ..report(grant, Outcome::Ok) }
}
