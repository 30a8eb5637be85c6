//! A random life of a site: workers that ask, repeat themselves, lose answers, die and come back; clients; clocks that jump; orchestrators that die
//! around a commit.

use std::path::Path;

use socrates_model::job::Stage;
use socrates_model::report::Verdict;
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatVerdict, Control, Grant, Held, Priority, Recorded, Release, Report, ScenarioSpec,
    Submit, Submitted,
};

use super::flaw::Flaw;
use super::site::{Death, Site};
use crate::histories::{ALL, Dice, scenarios, some_report};
use crate::world::success;
use crate::{Answer, Event};

/// Events of a life before it is brought to its end.
const LENGTH: usize = 150;
/// Rounds in which a healthy worker must have brought everything to an end.
const ROUNDS: usize = 400;

/// A worker process as it sees itself.
struct Worker {
    place: usize,
    /// Processes in this place so far.
    lives: u32,
    held: Vec<Grant>,
    /// A question without an answer, and when it was asked first.
    open: Option<(Acquire, u64)>,
    /// Reports that are not recorded, and whether they went out before; they outlive the process.
    spool: Vec<(Report, bool)>,
}

impl Worker {
    fn name(&self) -> String {
        format!("w{}.{}", self.place, self.lives)
    }
}

struct Life {
    site: Site,
    dice: Dice,
    workers: Vec<Worker>,
    specs: Vec<ScenarioSpec>,
    said: Vec<Report>,
    asked: u64,
}

/// Lives the life of this seed under an orchestrator with a flaw.
pub(super) fn live(flaw: Flaw, seed: u64, folder: &Path) -> Site {
    let mut dice = Dice::new(seed);
    let specs = scenarios(&mut dice);
    let worker = |place| Worker { place, lives: 0, held: Vec::new(), open: None, spool: Vec::new() };
    let workers = (0..3).map(worker).collect();
    let mut life = Life { site: Site::new(flaw, seed), dice, workers, specs, said: Vec::new(), asked: 0 };
    life.submit(Death::Never);
    for _ in 0..LENGTH {
        life.event();
        life.site.hear();
    }
    life.site.audit(folder);
    life.end();
    life.site.audit(folder);
    life.site.close();
    life.site
}

impl Life {
    fn death(&mut self) -> Death {
        match self.dice.below(60) {
            0 => Death::Before,
            1 => Death::Within,
            2 => Death::After,
            _ => Death::Never,
        }
    }

    /// Whether an answer is lost on its way.
    fn lost(&mut self) -> bool {
        self.dice.below(12) == 0
    }

    fn event(&mut self) {
        let n = usize::try_from(self.dice.below(3)).unwrap();
        let death = self.death();
        match self.dice.below(22) {
            0..6 => self.ask(n, death),
            6..12 => self.report(n, death),
            12 => self.repeat(),
            13 => self.die(n),
            14 | 15 => self.beat(n, death),
            16 => self.release(n, death),
            17 => self.submit(death),
            18 => self.control(death),
            19 => self.site.ahead = self.dice.pick(&[-3_600_000, -20_000, 0, 20_000, 3_600_000]),
            _ => {
                let ms = self.dice.pick(&[1, 100, 1_000, 4_000, 16_000, 125_000]);
                self.wait(ms, death);
            }
        }
    }

    fn wait(&mut self, ms: u64, death: Death) {
        self.site.now += ms;
        self.site.send(|_| Event::Tick, death);
        if death == Death::Never {
            self.site.witness.look(&self.site.state, self.site.now);
        }
    }

    fn submit(&mut self, death: Death) {
        let submit = Submit::new("b", Priority::Normal, self.specs.clone());
        if let Some(Answer::Submitted(Submitted::Accepted { .. })) =
            self.site.send(|to| Event::Submit { submit, to }, death)
        {
            self.site.witness.submitted(self.specs.iter().map(|spec| spec.id.clone()));
        }
    }

    fn control(&mut self, death: Death) {
        let control = match self.dice.below(10) {
            0 => Control::Cancel("b".to_owned()),
            1 => Control::Pause("b".to_owned()),
            2..5 => Control::Resume("b".to_owned()),
            _ => Control::Requeue(self.dice.pick(&self.specs).id),
        };
        self.site.send(|to| Event::Control { control, to }, death);
    }

    /// A worker asks, with the question that was not answered where there is one.
    fn ask(&mut self, n: usize, death: Death) {
        let (ask, asked) = match self.workers[n].open.clone() {
            Some(open) => open,
            None => {
                self.asked += 1;
                let ask = Acquire {
                    req_id: format!("q{}", self.asked),
                    instance: self.workers[n].name(),
                    stages: ALL.into_iter().filter(|_| self.dice.below(3) > 0).collect(),
                    credits: u32::try_from(self.dice.below(4)).unwrap(),
                    code_version: "1".to_owned(),
                };
                (ask, self.site.now)
            }
        };
        self.workers[n].open = Some((ask.clone(), asked));
        let Some(first) = self.acquire(&ask, death) else { return };
        if death == Death::Never && self.dice.below(4) == 0 {
            // The question came twice.
            if let Some(second) = self.acquire(&ask, Death::Never) {
                self.site.witness.doubled(&ask, &first, &second);
            }
        }
        if self.lost() {
            return;
        }
        self.workers[n].open = None;
        self.take(n, &first, Some(asked));
    }

    fn acquire(&mut self, ask: &Acquire, death: Death) -> Option<Vec<Grant>> {
        let ask = ask.clone();
        let answer = self.site.send(|to| Event::Acquire { ask, to }, death)?;
        if let Answer::Acquired(Acquired::Grants(grants)) = answer { Some(grants) } else { Some(Vec::new()) }
    }

    fn take(&mut self, n: usize, grants: &[Grant], asked: Option<u64>) {
        let (name, now, policy) = (self.workers[n].name(), self.site.now, self.site.state.policy.clone());
        self.site.witness.granted(&name, grants, asked, now, &policy);
        for grant in grants {
            let worker = &mut self.workers[n];
            let slot = |one: &Grant| one.spec.key == grant.spec.key && one.attempt == grant.attempt;
            let is_done =
                worker.spool.iter().any(|(report, _)| report.key == grant.spec.key && report.attempt == grant.attempt);
            if !worker.held.iter().any(slot) && !is_done {
                worker.held.push(grant.clone());
            }
        }
    }

    /// A worker is done with something it holds, or sends again what was not recorded.
    fn report(&mut self, n: usize, death: Death) {
        if !self.workers[n].held.is_empty() && (self.workers[n].spool.is_empty() || self.dice.below(2) == 0) {
            let count = self.workers[n].held.len() as u64;
            let grant = self.workers[n].held.remove(usize::try_from(self.dice.below(count)).unwrap());
            let report = Report { instance: self.workers[n].name(), ..some_report(&mut self.dice, &grant) };
            self.workers[n].spool.push((report, false));
        }
        if self.workers[n].spool.is_empty() {
            return;
        }
        let (report, sent_before) = self.workers[n].spool.remove(0);
        self.site.witness.over(&report.key, report.attempt);
        let recorded = self.record(&report, death);
        match recorded {
            Some(recorded) if !self.lost() => {
                self.site.witness.reported(&report, recorded, sent_before);
                self.said.push(report);
            }
            Some(_) | None => self.workers[n].spool.push((report, true)),
        }
    }

    fn record(&mut self, report: &Report, death: Death) -> Option<Recorded> {
        let report = Box::new(report.clone());
        let answer = self.site.send(|to| Event::Report { report, to }, death)?;
        let Answer::Recorded(recorded) = answer else { panic!("{answer:?}") };
        Some(recorded)
    }

    /// A report that was acknowledged comes once more.
    fn repeat(&mut self) {
        if self.said.is_empty() {
            return;
        }
        let report = self.dice.pick(&self.said);
        if let Some(recorded) = self.record(&report, Death::Never) {
            self.site.witness.reported(&report, recorded, true);
        }
    }

    /// The token of a worker goes; half of the time its process too.
    fn die(&mut self, n: usize) {
        let instance = self.workers[n].name();
        self.site.witness.gone(&instance);
        if self.dice.below(2) == 0 {
            let worker = &mut self.workers[n];
            worker.lives += 1;
            worker.held.clear();
            worker.open = None;
        }
        self.site.send(|_| Event::Gone { instance }, Death::Never);
    }

    fn beat(&mut self, n: usize, death: Death) {
        let of = |grant: &Grant| Held {
            key: grant.spec.key.clone(),
            attempt: grant.attempt,
            fence: grant.fence,
            characters: 0,
        };
        let held: Vec<Held> = self.workers[n].held.iter().map(of).collect();
        let beat = Beat { instance: self.workers[n].name(), held: held.clone(), draining: false };
        let now = self.site.now;
        self.site.witness.beat(&held, now, false);
        let Some(Answer::Beat(reply)) = self.site.send(|to| Event::Beat { beat, to }, death) else { return };
        if self.lost() {
            return;
        }
        for (key, attempt, verdict) in &reply.verdicts {
            let is_it = |grant: &Grant| grant.spec.key == *key && grant.attempt == *attempt;
            if *verdict == BeatVerdict::Ok {
                let one: Vec<Held> = self.workers[n].held.iter().filter(|grant| is_it(grant)).map(of).collect();
                self.site.witness.beat(&one, now, true);
            } else {
                self.workers[n].held.retain(|grant| !is_it(grant));
                self.site.witness.over(key, *attempt);
            }
        }
        self.take(n, &reply.missing, None);
    }

    fn release(&mut self, n: usize, death: Death) {
        let Some(grant) = self.workers[n].held.pop() else { return };
        let (key, attempt) = (grant.spec.key.clone(), grant.attempt);
        self.site.witness.over(&key, attempt);
        let release = Release { instance: self.workers[n].name(), key: key.clone(), attempt, fence: grant.fence };
        if let Some(Answer::Recorded(recorded)) = self.site.send(|to| Event::Release { release, to }, death) {
            self.site.witness.released(&key, attempt, recorded);
        }
    }

    /// From anywhere, what lies in the spools and a healthy worker bring everything to an end.
    fn end(&mut self) {
        let reports: Vec<(Report, bool)> = self.workers.iter_mut().flat_map(|worker| worker.spool.drain(..)).collect();
        for (report, sent_before) in reports {
            if let Some(recorded) = self.record(&report, Death::Never) {
                self.site.witness.reported(&report, recorded, sent_before);
            }
        }
        self.site.send(|to| Event::Control { control: Control::Resume(String::new()), to }, Death::Never);
        for _ in 0..ROUNDS {
            if self.site.state.is_done() {
                return;
            }
            self.wait(130_000, Death::Never);
            self.asked += 1;
            let (instance, asked) = ("healthy".to_owned(), self.site.now);
            let (req_id, code_version) = (format!("q{}", self.asked), "1".to_owned());
            let ask = Acquire { req_id, instance: instance.clone(), stages: ALL.to_vec(), credits: 16, code_version };
            let Some(grants) = self.acquire(&ask, Death::Never) else { continue };
            let policy = self.site.state.policy.clone();
            self.site.witness.granted(&instance, &grants, Some(asked), asked, &policy);
            for grant in grants {
                let verdict = (grant.spec.key.stage == Stage::Scoring).then_some(Verdict::Realised);
                let report = Report { instance: instance.clone(), verdict, ..success(&grant) };
                self.site.witness.over(&report.key, report.attempt);
                if let Some(recorded) = self.record(&report, Death::Never) {
                    self.site.witness.reported(&report, recorded, false);
                }
            }
        }
        self.site.stuck();
    }
}
