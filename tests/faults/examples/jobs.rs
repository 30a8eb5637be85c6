//! `J-`: jobs that come to nothing.

use std::collections::BTreeMap;

use socrates_author::{Asking, AuthorContext};
use socrates_kit::KitError;
use socrates_model::job::Stage;
use socrates_model::wire::{Acquire, Acquired, Grant, Hello, Outcome, Priority, Report, ScenarioSpec, Submit, Welcome};
use socrates_model::{Digest, FailureClass, Fault, FaultCode, PlannerName, ScenarioId};
use socrates_orchestrator::{Answer, Effect, Event, Policy, State, step};
use socrates_prompts::Style;

use super::{Examples, keep, office, question};

/// A machine with one scenario, and a worker that holds its first job.
struct Machine {
    state: State,
    now: u64,
}

impl Machine {
    fn new(policy: Policy) -> (Self, Grant) {
        let mut machine = Self { state: State::new(policy), now: 1_000 };
        let spec = ScenarioSpec {
            id: ScenarioId::new("demo").unwrap(),
            request: Digest::of(b"request"),
            location: Digest::of(b"location"),
            reading: Digest::of(b"reading"),
            seed: 1,
            planners: vec![PlannerName::reference()],
            run_seeds: vec![1],
            pinned: BTreeMap::new(),
            settings: BTreeMap::new(),
            review: false,
            order: None,
        };
        machine.send(|to| Event::Submit { submit: Submit::new("b", Priority::Normal, vec![spec]), to });
        let ask = Acquire {
            req_id: "q".to_owned(),
            instance: "worker-1".to_owned(),
            stages: vec![Stage::Proposal],
            credits: 1,
            code_version: "1".to_owned(),
        };
        let grant = match machine.send(|to| Event::Acquire { ask, to }) {
            Some(Answer::Acquired(Acquired::Grants(mut grants))) => grants.remove(0),
            other => panic!("{other:?}"),
        };
        (machine, grant)
    }

    fn send(&mut self, event: impl FnOnce(u64) -> Event) -> Option<Answer> {
        let token = self.now;
        step(&mut self.state, event(token), self.now).into_iter().find_map(|effect| {
            let Effect::Reply { to, answer } = effect else { return None };
            (to == token).then_some(*answer)
        })
    }

    fn faults(&self) -> Vec<Fault> {
        self.state.jobs.values().flat_map(|job| &job.attempts).flat_map(|attempt| attempt.faults.clone()).collect()
    }

    /// The faults after so much time without a word of the worker.
    fn after(mut self, ms: u64) -> Vec<Fault> {
        self.now += ms;
        self.send(|_| Event::Tick);
        self.faults()
    }

    /// What a worker of version `ours` is told by an orchestrator that works with version `theirs`.
    fn other_version(ours: &str, theirs: &str) -> Option<Fault> {
        let policy = Policy { code_version: theirs.to_owned(), ..Policy::default() };
        let mut machine = Self { state: State::new(policy), now: 1_000 };
        let hello = Hello {
            instance: "worker-1".to_owned(),
            stages: vec![Stage::Proposal],
            code_version: ours.to_owned(),
            pid: 1,
            host: String::new(),
        };
        let Some(Answer::Welcome(Welcome::Incompatible { range })) = machine.send(|to| Event::Hello { hello, to })
        else {
            return None;
        };
        let KitError::Incompatible(fault) = KitError::incompatible(ours, &range) else { return None };
        Some(fault)
    }

    fn report(mut self, grant: &Grant, outcome: Outcome) -> Vec<Fault> {
        let report = Report {
            instance: "worker-1".to_owned(),
            key: grant.spec.key.clone(),
            attempt: grant.attempt,
            fence: grant.fence,
            outcome,
            artifacts: Vec::new(),
            wall_ms: 5,
            tokens: (1_000, 200),
            remark: String::new(),
            repair: None,
            anew: Vec::new(),
            verdict: None,
            rates: None,
        };
        self.now += 1;
        self.send(|to| Event::Report { report: Box::new(report), to });
        self.faults()
    }
}

pub(super) async fn examples() -> Examples {
    let mut all = Examples::new();
    let policy = Policy::default();
    let (machine, _) = Machine::new(Policy { lease_ms: 15_000, ..policy.clone() });
    keep(&mut all, machine.after(15_001));
    let (machine, _) = Machine::new(Policy { lease_ms: 600_000, author_deadline_ms: 120_000, ..policy.clone() });
    keep(&mut all, machine.after(120_001));
    let (machine, grant) = Machine::new(Policy { tokens_per_scenario: 1_000, ..policy.clone() });
    let faults = vec![Fault::new(FaultCode::PCount, "humans", "lists 2 humans, asked for were 3")];
    let wrong = Outcome::Failed { class: FailureClass::Semantic, faults, retry_after_ms: None };
    keep(&mut all, machine.report(&grant, wrong).into_iter().filter(|fault| fault.code == FaultCode::JBudget));
    let (machine, grant) = Machine::new(policy);
    keep(&mut all, machine.report(&grant, Outcome::Ok));
    keep(&mut all, Machine::other_version("0.1.0", "0.2.0"));
    keep(&mut all, [socrates_planners::catalog::unknown("teb")]);
    let style = BTreeMap::from([("prompt.mode".to_owned(), "verbose".to_owned())]);
    keep(&mut all, Style::from_settings(&style).err());
    // A job without the proposal it needs.
    let (request, location) = office("Drive to the exit", "A visitor comes towards the robot.");
    let mut bare = question(&request, &location, Stage::Paths).await;
    bare.proposal = None;
    let refused = AuthorContext::default().answer(&bare, &Asking::offline()).await.err();
    keep(&mut all, refused.into_iter().flat_map(|refusal| refusal.faults));
    all
}
