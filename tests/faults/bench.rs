//! A whole scenario in this process: the real state machine hands jobs out, the real stages do them, and everything that is
//! decided is written down, without any text that is for people.

use std::collections::BTreeMap;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use socrates_author::{Asking, AuthorContext, JobRefusal, Written};
use socrates_kit::Failure;
use socrates_model::fault::hard;
use socrates_model::job::{Artifact, Stage};
use socrates_model::statement::Became;
use socrates_model::wire::{Acquire, Acquired, Grant, Outcome, Priority, Report, ScenarioSpec, Submit};
use socrates_model::{
    Behaviors, Digest, Fault, Location, Paths, PlannerName, Proposal, Reading, Recording, Request, Role, RunId,
    ScenarioId,
};
use socrates_orchestrator::{Answer, Effect, Event, Policy, State, step};
use socrates_prompts::Question;
use socrates_scoring::Evidence;

/// Turns after which a scenario that does not end is a mistake of this test.
const MOST_TURNS: usize = 2_000;
/// What the clock goes on where no job is there, ms.
const PAUSE_MS: u64 = 1_000;

/// What was decided, one line each.
pub(crate) type Decisions = Vec<String>;

/// The facts of faults: every member but their messages.
pub(crate) fn facts(faults: &[Fault]) -> Vec<String> {
    let bare = |fault: &Fault| {
        let mut value = json!(fault);
        value.as_object_mut().unwrap().remove("message").unwrap();
        value.to_string()
    };
    faults.iter().map(bare).collect()
}

/// What a report decides, without its sentences: the standing and margins of its clauses, every metric.
fn judged_facts(report: &impl Serialize) -> Digest {
    const SENTENCES: [&str; 9] =
        ["verdict_text", "robot_text", "story", "text", "evidence", "note", "message", "remark", "notes"];
    fn strip(value: &mut Value) {
        match value {
            Value::Object(members) => {
                members.retain(|name, _| !SENTENCES.contains(&name.as_str()));
                members.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }
    let mut value = json!(report);
    strip(&mut value);
    Digest::of(&serde_json::to_vec(&value).unwrap())
}

/// What was read, without notes and messages.
pub(crate) fn read_facts(reading: &Reading) -> String {
    let mut bare = Reading { notes: Vec::new(), problems: Vec::new(), ..reading.clone() };
    // Why something is not played is for people to read, as the message of a problem is.
    for statement in &mut bare.statements {
        if let Became::NotPlayed { why } = &mut statement.became {
            *why = "x".into();
        }
    }
    // The same problem said twice is one.
    let mut problems = facts(&reading.problems);
    problems.dedup();
    format!("reading {} problems {problems:?}", Digest::of(&serde_json::to_vec(&bare).unwrap()))
}

/// Plays a scenario to its end, with these settings of its author.
pub(crate) async fn play(
    request: &Request,
    location: &Location,
    seed: u64,
    settings: &BTreeMap<String, String>,
) -> Decisions {
    let mut bench = Bench::new(request, location, seed, settings);
    for _ in 0..MOST_TURNS {
        if bench.ended {
            return bench.decisions;
        }
        let grants = bench.ask();
        if grants.is_empty() {
            bench.now += PAUSE_MS;
            bench.send(|_| Event::Tick);
        }
        for grant in grants {
            let report = bench.work(&grant).await;
            bench.now += 1;
            bench.send(|to| Event::Report { report: Box::new(report), to });
        }
    }
    panic!("the scenario did not end: {:#?}", bench.decisions);
}

struct Bench {
    state: State,
    now: u64,
    token: u64,
    blobs: BTreeMap<Digest, Vec<u8>>,
    recordings: BTreeMap<Digest, Recording>,
    ended: bool,
    decisions: Decisions,
}

impl Bench {
    fn new(request: &Request, location: &Location, seed: u64, settings: &BTreeMap<String, String>) -> Self {
        let reading = socrates_offline::read(request, location);
        let mut bench = Self {
            state: State::new(Policy::default()),
            now: 1_000,
            token: 0,
            blobs: BTreeMap::new(),
            recordings: BTreeMap::new(),
            ended: false,
            decisions: vec![read_facts(&reading)],
        };
        let author = [("author".to_owned(), "offline".to_owned())];
        let spec = ScenarioSpec {
            id: ScenarioId::new("s").unwrap(),
            request: bench.keep(request),
            location: bench.keep(location),
            reading: bench.keep(&reading),
            seed,
            planners: vec![PlannerName::reference()],
            run_seeds: vec![seed],
            pinned: BTreeMap::new(),
            settings: author.into_iter().chain(settings.clone()).collect(),
            review: false,
            order: None,
        };
        let submit = Submit::new("b", Priority::Normal, vec![spec]);
        bench.send(|to| Event::Submit { submit, to });
        bench
    }

    fn send(&mut self, event: impl FnOnce(u64) -> Event) -> Option<Answer> {
        self.token += 1;
        let token = self.token;
        let mut answer = None;
        for effect in step(&mut self.state, event(token), self.now) {
            match effect {
                Effect::Reply { to, answer: reply } if to == token => answer = Some(*reply),
                Effect::ScenarioDone { end, .. } => {
                    self.ended = true;
                    self.decisions.push(format!("end {end:?}"));
                }
                Effect::Reply { .. } | Effect::Save(_) | Effect::Notice { .. } | Effect::Hint(_) => {}
            }
        }
        answer
    }

    fn ask(&mut self) -> Vec<Grant> {
        let ask = Acquire {
            req_id: format!("q{}", self.token),
            instance: "w".to_owned(),
            stages: vec![Stage::Proposal, Stage::Paths, Stage::Behaviors, Stage::Simulation, Stage::Scoring],
            credits: 16,
            code_version: "1".to_owned(),
        };
        match self.send(|to| Event::Acquire { ask, to }) {
            Some(Answer::Acquired(Acquired::Grants(grants))) => grants,
            _ => Vec::new(),
        }
    }

    fn keep<T: Serialize>(&mut self, value: &T) -> Digest {
        let bytes = serde_json::to_vec(value).unwrap();
        let digest = Digest::of(&bytes);
        self.blobs.insert(digest, bytes);
        digest
    }

    fn input<T: DeserializeOwned>(&self, grant: &Grant, role: Role) -> T {
        serde_json::from_slice(&self.blobs[&grant.spec.inputs[&role]]).unwrap()
    }

    async fn work(&mut self, grant: &Grant) -> Report {
        let spec = &grant.spec;
        self.decisions.push(format!(
            "job {} attempt {} seed {} refused {} told {:?}",
            spec.key,
            grant.attempt,
            spec.seed,
            spec.refused.is_some(),
            facts(&spec.feedback)
        ));
        let report = match spec.key.stage {
            Stage::Proposal | Stage::Paths | Stage::Behaviors => self.author(grant).await,
            Stage::Simulation => self.simulate(grant),
            Stage::Scoring => self.score(grant),
            Stage::Review => panic!("nobody looks"),
        };
        let job = self.state.jobs.get(&spec.key);
        self.decisions.push(format!("state {:?}", job.map(|job| (job.state, job.attempts.len()))));
        if let Outcome::Failed { class, faults, retry_after_ms } = &report.outcome {
            self.decisions.push(format!("failed {class:?} wait {retry_after_ms:?} {:?}", facts(faults)));
        }
        report
    }

    async fn author(&mut self, grant: &Grant) -> Report {
        let (spec, stage) = (&grant.spec, grant.spec.key.stage);
        let refused = spec.refused.map(|digest| String::from_utf8(self.blobs[&digest].clone()).unwrap());
        let question = Question {
            stage,
            request: self.input(grant, Role::Request),
            reading: self.input(grant, Role::Reading),
            location: self.input(grant, Role::Location),
            proposal: (stage != Stage::Proposal).then(|| self.input(grant, Role::Proposal)),
            only: Vec::new(),
            feedback: spec.feedback.clone(),
            refused,
            account: None,
            passing: None,
            seed: spec.seed,
        };
        let asking = Asking { settings: spec.settings.clone(), attempt: grant.attempt };
        match AuthorContext::default().answer(&question, &asking).await {
            Ok(answer) => {
                let (role, value) = match answer.written {
                    Written::Proposal(proposal) => (Role::Proposal, json!(proposal)),
                    Written::Paths(paths) => (Role::Paths, json!(paths)),
                    Written::Behaviors(behaviors) => (Role::Behaviors, json!(behaviors)),
                };
                self.decisions.push(format!("made {role} {}", Digest::of(&without_notes(value.clone()))));
                let artifact = self.artifact(role, &value);
                report(grant, Outcome::Ok, vec![artifact])
            }
            Err(JobRefusal { class, faults, text, retry_after_ms, .. }) => {
                let left = text.map(|text| {
                    let digest = Digest::of(text.as_bytes());
                    self.blobs.insert(digest, text.into_bytes());
                    artifact_of(Role::Refused, digest)
                });
                report(grant, Outcome::Failed { class, faults, retry_after_ms }, left.into_iter().collect())
            }
        }
    }

    fn simulate(&mut self, grant: &Grant) -> Report {
        let (location, request): (Location, Request) =
            (self.input(grant, Role::Location), self.input(grant, Role::Request));
        let reading: Reading = self.input(grant, Role::Reading);
        let proposal: Proposal = self.input(grant, Role::Proposal);
        let (paths, behaviors): (Paths, Behaviors) =
            (self.input(grant, Role::Paths), self.input(grant, Role::Behaviors));
        let found = hard(&socrates_checks::check_all(&location, Some(&reading), &proposal, &paths, &behaviors));
        let run = grant.spec.run().unwrap();
        let (name, seed): (RunId, u64) = (run.id(&grant.spec.key.scenario), run.seed);
        let recording = if found.is_empty() {
            let setup = socrates_simulation::setup(location, proposal, paths, behaviors, Some(&request), name, seed);
            socrates_simulation::simulate(setup, &PlannerName::reference())
        } else {
            Err(found)
        };
        match recording {
            Ok(recording) => {
                let digest = recording.hash();
                self.decisions.push(format!("recording {digest}"));
                self.recordings.insert(digest, recording);
                report(grant, Outcome::Ok, vec![artifact_of(Role::Recording, digest)])
            }
            Err(faults) => {
                let Failure { class, faults, .. } = Failure::from_faults(faults);
                report(grant, Outcome::Failed { class, faults, retry_after_ms: None }, Vec::new())
            }
        }
    }

    fn score(&mut self, grant: &Grant) -> Report {
        let recording = &self.recordings[&grant.spec.inputs[&Role::Recording]];
        let (location, request): (Location, Request) =
            (self.input(grant, Role::Location), self.input(grant, Role::Request));
        let (reading, proposal, paths): (Reading, Proposal, Paths) =
            (self.input(grant, Role::Reading), self.input(grant, Role::Proposal), self.input(grant, Role::Paths));
        let judged = socrates_scoring::score(&Evidence {
            location: Some(&location),
            request: Some(&request),
            reading: Some(&reading),
            proposal: Some(&proposal),
            paths: Some(&paths),
            ..Evidence::of(recording)
        });
        let asked = judged.repair.as_ref().map(|repair| (repair.stage, facts(&repair.faults)));
        let facts = judged_facts(&judged);
        self.decisions
            .push(format!("verdict {} score {} report {facts} repair {asked:?}", judged.verdict, judged.score));
        let artifact = self.artifact(Role::Report, &json!(judged));
        let (verdict, repair) = (Some(judged.verdict), judged.repair);
        Report { verdict, repair, ..report(grant, Outcome::Ok, vec![artifact]) }
    }

    fn artifact(&mut self, role: Role, value: &Value) -> Artifact {
        let digest = self.keep(value);
        artifact_of(role, digest)
    }
}

/// The bytes of an artifact without what it says to people about faults.
fn without_notes(mut value: Value) -> Vec<u8> {
    if let Some(members) = value.as_object_mut() {
        members.remove("notes");
    }
    serde_json::to_vec(&value).unwrap()
}

fn artifact_of(role: Role, digest: Digest) -> Artifact {
    Artifact { role, digest, len: 4, media: "application/json".to_owned(), inline: None }
}

fn report(grant: &Grant, outcome: Outcome, artifacts: Vec<Artifact>) -> Report {
    Report {
        instance: "w".to_owned(),
        key: grant.spec.key.clone(),
        attempt: grant.attempt,
        fence: grant.fence,
        outcome,
        artifacts,
        wall_ms: 5,
        tokens: (1, 1),
        remark: String::new(),
        repair: None,
        anew: Vec::new(),
        verdict: None,
        rates: None,
    }
}
