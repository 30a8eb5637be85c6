//! Hello and Submit: workers and scenarios come in; jobs are made and become ready.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::fault::Fault;
use socrates_model::job::{Item, JobKey, JobSpec, Look, Stage};
use socrates_model::wire::{Hello, Priority, ScenarioSpec, Submit, Submitted, Welcome};
use socrates_model::{Digest, Role, Run, ScenarioId};

use crate::event::{Answer, Token};
use crate::pipeline;
use crate::series::{AHEAD, Comes, meet};
use crate::state::{Job, JobState, Scenario, Tries, Worker};
use crate::turn::Turn;

/// Characters of a foreign version that are remembered.
const VERSION_CHARS: usize = 60;

impl Turn<'_> {
    pub(crate) fn hello(&mut self, hello: Hello, to: Token) {
        let wanted = &self.state.policy.code_version;
        let answer = if wanted.is_empty() || *wanted == hello.code_version {
            let now = self.now;
            self.state
                .workers
                .entry(hello.instance.clone())
                .and_modify(|worker| {
                    worker.hello = hello.clone();
                    worker.seen = now;
                })
                .or_insert_with(|| Worker::new(hello, now));
            let policy = &self.state.policy;
            Welcome::Welcome { epoch: self.state.epoch, lease_ms: policy.lease_ms, beat_ms: policy.beat_ms }
        } else {
            let range = wanted.clone();
            self.turned_away(&hello.stages, &hello.code_version);
            Welcome::Incompatible { range }
        };
        self.reply(to, Answer::Welcome(answer));
    }

    /// Remembers the version of a worker that is of another one than the jobs, for those who ask why nothing happens.
    pub(crate) fn turned_away(&mut self, stages: &[Stage], version: &str) {
        let version: String = version.chars().take(VERSION_CHARS).collect();
        for stage in stages {
            self.state.strangers.insert(*stage, version.clone());
        }
    }

    pub(crate) fn submit(&mut self, submit: Submit, to: Token) {
        let answer = self.take(submit);
        self.reply(to, Answer::Submitted(answer));
    }

    /// All of it or nothing.
    fn take(&mut self, submit: Submit) -> Submitted {
        let mut fresh: BTreeMap<ScenarioId, ScenarioSpec> = BTreeMap::new();
        let mut order = Vec::new();
        for spec in submit.scenarios {
            let later = self.state.queues.values().find_map(|one| Some((one.named(&spec.id)?, one.batch.as_str())));
            let known = self.scenario(&spec.id).map(|known| (&known.spec, known.batch.as_str()));
            let known = known.or_else(|| later.as_ref().map(|(spec, batch)| (spec, *batch)));
            let known = known.or_else(|| fresh.get(&spec.id).map(|spec| (spec, submit.batch.as_str())));
            match known {
                Some((known, batch)) if *known == spec && batch == submit.batch => {}
                Some((_, batch)) => {
                    let why =
                        format!("scenario `{}` is known already, with other inputs or in batch `{batch}`", spec.id);
                    return Submitted::Refused { why: format!("{why}; choose another name") };
                }
                None => {
                    if let Err(why) = self.acceptable(&spec) {
                        return Submitted::Refused { why };
                    }
                    order.push(spec.id.clone());
                    fresh.insert(spec.id.clone(), spec);
                }
            }
        }
        let (mut series, mut held, mut ahead) = (Vec::new(), 0_u32, 0_usize);
        for one in submit.series {
            if let Err(why) = self.acceptable(&one.first) {
                return Submitted::Refused { why };
            }
            held = held.saturating_add(one.count());
            match self.comes(&submit.batch, &one, &fresh) {
                Ok(Comes::Known) => {}
                Ok(Comes::New) if series.iter().any(|other| meet(other, &one)) => {
                    let why = format!("two series of a submission have names in common, from `{}` on", one.first.id);
                    return Submitted::Refused { why };
                }
                Ok(Comes::New) => {
                    ahead += usize::try_from(one.count().min(AHEAD)).unwrap_or(0);
                    series.push(one);
                }
                Err(why) => return Submitted::Refused { why },
            }
        }
        // A chain has at most six jobs; runs beyond the first are made when the first is judged.
        let coming = fresh.len() + ahead;
        if coming > 0 && self.state.open_jobs + coming * 6 > self.state.policy.max_open_jobs {
            return Submitted::Busy { retry_after_ms: 2_000 };
        }
        let new = series
            .iter()
            .fold(u32::try_from(order.len()).unwrap_or(u32::MAX), |new, one| new.saturating_add(one.count()));
        if new > 0 || !submit.limits.are_none() {
            self.limit(&submit.batch, submit.limits);
        }
        for one in series {
            self.join(&submit.batch, submit.priority, one);
        }
        let alone = u64::try_from(order.len()).unwrap_or(u64::MAX);
        if alone > 0 {
            self.opened(&submit.batch, alone);
        }
        for id in order {
            if let Some(spec) = fresh.remove(&id) {
                self.begin(&submit.batch, submit.priority, spec);
            }
        }
        Submitted::Accepted { new, held }
    }

    fn acceptable(&self, spec: &ScenarioSpec) -> Result<(), String> {
        let id = &spec.id;
        let most = self.state.policy.max_runs;
        let asked = spec.planners.len().saturating_add(1).saturating_mul(spec.run_seeds.len().max(1));
        if asked > most.saturating_mul(2) || pipeline::runs(spec).len() > most {
            return Err(format!("scenario `{id}` asks for `{asked}` runs; allowed: at most `{most}`"));
        }
        if let Some(role) = spec.pinned.keys().find(|role| !Role::PINNED.contains(role)) {
            return Err(format!("scenario `{id}` pins `{role}`; allowed: proposal, paths, behaviors"));
        }
        Ok(())
    }

    /// Begins a scenario that was counted as open.
    fn begin(&mut self, batch: &str, priority: Priority, spec: ScenarioSpec) {
        let order = self.state.next_order;
        self.state.next_order += 1;
        self.begin_at(order, batch, priority, spec);
    }

    /// Makes a scenario at its place in the order of submission, with the jobs of its first revision.
    pub(crate) fn begin_at(&mut self, order: u64, batch: &str, priority: Priority, spec: ScenarioSpec) {
        let id = spec.id.clone();
        let stages = pipeline::authored(&spec);
        let lead = pipeline::lead(&spec);
        let turn = self.state.take_turn(batch, priority);
        let scenario =
            Scenario { since_ms: self.state.wall_ms(self.now), priority, ..Scenario::new(batch, order, turn, spec) };
        self.state.scenarios.insert(id.clone(), scenario);
        self.state.by_order.insert(order, id.clone());
        self.scenario_mut(&id);
        let mut made: Vec<JobKey> =
            stages.into_iter().filter_map(|(stage, item)| self.make(&id, (stage, item), 0, &[])).collect();
        for stage in [Stage::Simulation, Stage::Scoring] {
            made.extend(self.make(&id, (stage, lead.clone().into()), 0, &[]));
        }
        for key in made {
            self.unblock(&key);
        }
    }

    /// Makes a blocked job at a revision, with its sources among the jobs of the plan at that
    /// revision. The caller unblocks it once the whole revision stands.
    pub(crate) fn make(
        &mut self,
        id: &ScenarioId,
        (stage, item): (Stage, Item),
        revision: u32,
        sent_back: &[Fault],
    ) -> Option<JobKey> {
        let scenario = self.scenario(id)?;
        let key = JobKey { scenario: id.clone(), stage, item, revision };
        let former = revision.checked_sub(1).and_then(|last| self.state.place(id, stage, &key.item, last));
        let former = former.and_then(|former| self.job(former));
        let seed_revision =
            if sent_back.is_empty() { former.map_or(0, |former| former.seed_revision) } else { revision };
        let refused = former.filter(|_| !sent_back.is_empty()).and_then(|former| {
            // What a person left of it counts, where it is newer.
            let holds = || {
                let writer = self.writer(&key, stage).and_then(|writer| self.job(&writer));
                self.output_of(writer.unwrap_or(former), Role::made_by(stage)?)
            };
            pipeline::refused(&former.result.as_ref()?.artifacts).or_else(holds)
        });
        let spec = JobSpec {
            key: key.clone(),
            inputs: BTreeMap::new(),
            seed: pipeline::seed(&scenario.spec, stage, key.item.run(), seed_revision, 0),
            feedback: sent_back.to_vec(),
            refused,
            settings: scenario.spec.settings.clone(),
        };
        let sources = self.sources(&key);
        self.enter(Job {
            key: key.clone(),
            state: JobState::Blocked,
            sources,
            spec,
            seed_revision,
            reseeds: 0,
            sent_back: sent_back.to_vec(),
            trial: 0,
            tries: Tries::default(),
            idem_key: None,
            delay_ms: 0,
            reason: String::new(),
            since_ms: self.state.wall_ms(self.now),
            attempts: Vec::new(),
            result: None,
            children: Vec::new(),
            due: None,
            lease_until: 0,
            deadline_at: 0,
            ready: 0,
        });
        Some(key)
    }

    /// Which job each input comes from.
    fn sources(&self, key: &JobKey) -> BTreeMap<Role, JobKey> {
        let written = [Stage::Proposal, Stage::Paths, Stage::Behaviors]
            .into_iter()
            .filter(|stage| pipeline::is_after(key.stage, &key.item, *stage))
            .filter_map(|stage| Some((Role::made_by(stage)?, self.writer(key, stage)?)));
        let mut sources: BTreeMap<Role, JobKey> = written.collect();
        // An author may read the request itself, and a person's wishes may change what it is read as; the next proposal is told of it.
        let is_told = |teller: &JobKey| {
            // The look that asks for another proposal has its result before it ends.
            key.stage != Stage::Proposal || self.job(teller).is_some_and(|job| job.result.is_some())
        };
        let teller = self.writer(key, Stage::Proposal).filter(is_told);
        sources.extend(teller.map(|teller| (Role::Reading, teller)));
        if key.stage == Stage::Review && key.item.look() == Some(Look::Proposal) {
            // The author may have proposed several; the person may take another.
            let author = self.state.place(&key.scenario, Stage::Proposal, &Item::Whole, key.revision);
            sources.extend(author.map(|author| (Role::Exchange, author.clone())));
        }
        let Some(run) = key.item.run().filter(|_| key.stage == Stage::Scoring) else { return sources };
        let roles = [
            (Role::Recording, Some(run.clone())),
            (Role::Simulation, Some(run.clone())),
            (Role::Reference, (!run.planner.is_reference()).then(|| Run::reference(run.seed))),
            (Role::Twin, (!run.planner.is_no_robot()).then(|| run.without_robot())),
        ];
        sources.extend(roles.into_iter().filter_map(|(role, run)| {
            let simulated = self.state.place(&key.scenario, Stage::Simulation, &run?.into(), key.revision)?;
            Some((role, simulated.clone()))
        }));
        sources
    }

    /// The job whose version of a stage's output holds for the job `key`: the newest, and among equally new ones what a
    /// person left of it.
    fn writer(&self, key: &JobKey, stage: Stage) -> Option<JobKey> {
        let author = self.state.place(&key.scenario, stage, &Item::Whole, key.revision);
        let looks = Look::ALL.into_iter().filter_map(|look| {
            // A look that comes later in the plan speaks for the next revision only.
            let waits = pipeline::is_after_look(key.stage, &key.item, look);
            let newest = if waits { key.revision } else { key.revision.checked_sub(1)? };
            let saw = pipeline::is_after(Stage::Review, &look.into(), stage);
            saw.then(|| self.state.look(&key.scenario, look, newest))?
        });
        // `max_by_key` takes the last of equals: the look at the draft, the look at the proposal, the author.
        author.into_iter().chain(looks).max_by_key(|job| job.revision).cloned()
    }

    /// What a job made in a role; a look that hands nothing back leaves it as it was.
    fn output_of(&self, job: &Job, role: Role) -> Option<Digest> {
        let made = pipeline::output(&job.result.as_ref()?.artifacts, role.made_as());
        made.or_else(|| (job.key.stage == Stage::Review).then(|| job.spec.inputs.get(&role).copied()).flatten())
    }

    /// Looks whether a blocked job has all it waits for: it becomes ready, is done already, or
    /// fails with the job it needed.
    pub(crate) fn unblock(&mut self, key: &JobKey) {
        let Some(job) = self.job(key) else { return };
        if job.state != JobState::Blocked {
            return;
        }
        let mut failed = None;
        for (role, source) in &job.sources {
            let Some(parent) = self.job(source) else { continue };
            if !parent.state.is_terminal() {
                return;
            }
            if parent.state != JobState::Succeeded && !role.is_beside() {
                failed = Some((parent.state, source.clone()));
            }
        }
        match failed {
            Some((JobState::Canceled, source)) => {
                self.move_to(key, JobState::Canceled, format!("{source} was canceled"))
            }
            Some((JobState::Superseded, source)) => {
                self.move_to(key, JobState::Superseded, format!("{source} was superseded"));
            }
            Some((_, source)) => self.move_to(key, JobState::Failed, format!("upstream: {source}")),
            None => {
                self.bind(key);
                self.offer(key, "");
            }
        }
    }

    /// Binds the inputs to what the sources made.
    fn bind(&mut self, key: &JobKey) {
        let (Some(job), Some(scenario)) = (self.job(key), self.scenario(&key.scenario)) else { return };
        let mut inputs = BTreeMap::from([
            (Role::Request, scenario.spec.request),
            (Role::Location, scenario.spec.location),
            (Role::Reading, scenario.spec.reading),
        ]);
        let wanted = |role: Role| {
            Stage::WORKERS
                .into_iter()
                .any(|stage| Role::made_by(stage) == Some(role) && pipeline::is_after(key.stage, &key.item, stage))
        };
        inputs.extend(scenario.spec.pinned.iter().filter(|(role, _)| wanted(**role)).map(|(role, d)| (*role, *d)));
        for (role, source) in &job.sources {
            let digest = self.job(source).and_then(|parent| self.output_of(parent, *role));
            inputs.extend(digest.map(|digest| (*role, digest)));
        }
        if let Some(job) = self.job_mut(key) {
            job.spec.inputs = inputs;
        }
        self.rekey(key);
    }

    /// Computes the idempotency key anew after the question changed. Never for a job in an index
    /// by key: ready, delayed or leased jobs are moved out of it first.
    pub(crate) fn rekey(&mut self, key: &JobKey) {
        let Some(idem_key) = self.job(key).map(|job| self.state.policy.idem_key(&job.spec)) else { return };
        if let Some(job) = self.job_mut(key) {
            job.idem_key = Some(idem_key);
        }
    }

    /// Makes a job ready, or done at once when its result is known.
    pub(crate) fn offer(&mut self, key: &JobKey, reason: &str) {
        if !self.take_known(key) {
            self.move_to(key, JobState::Ready, reason);
        }
    }
}

impl Worker {
    /// A worker that just came.
    #[must_use]
    pub(crate) fn new(hello: Hello, seen: u64) -> Self {
        Self {
            hello,
            seen,
            draining: false,
            held: std::collections::BTreeSet::new(),
            last: (String::new(), Vec::new()),
        }
    }
}

impl Scenario {
    /// A scenario that was just submitted.
    #[must_use]
    pub(crate) fn new(batch: &str, order: u64, turn: u64, spec: ScenarioSpec) -> Self {
        Self {
            batch: batch.to_owned(),
            order,
            turn,
            spec,
            revision: 0,
            repairs: 0,
            reproposals: 0,
            reviews: 0,
            verdicts: BTreeMap::new(),
            partial: BTreeSet::new(),
            settled: None,
            canceled: false,
            end: None,
            started: false,
            since_ms: 0,
            priority: Priority::Normal,
            jobs: Vec::new(),
            open: 0,
        }
    }
}
