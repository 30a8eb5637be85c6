//! Revisions: stages are done anew, the scenario settles on one revision, the other runs follow, and
//! the scenario ends with exactly one result.

use std::collections::BTreeMap;

use socrates_model::fault::Fault;
use socrates_model::job::{BEHAVIORS_BY, BY_PROPOSAL, Item, JobKey, Stage};
use socrates_model::report::Verdict;
use socrates_model::{Role, Run, ScenarioId};

use crate::failure::feedback;
use crate::pipeline;
use crate::state::{AttemptEnd, JobResult, JobState, Scenario, ScenarioEnd};
use crate::turn::Turn;

impl Turn<'_> {
    /// A scoring job has its result. Only the lead run's verdict speaks for the revision.
    pub(crate) fn judged(&mut self, key: &JobKey, result: &JobResult) {
        let id = &key.scenario;
        let Some(scenario) = self.scenario(id) else { return };
        let leads = key.item.run() == Some(&pipeline::lead(&scenario.spec));
        if !leads || scenario.settled.is_some() || scenario.end.is_some() || key.revision != self.newest_score(id) {
            return;
        }
        // A report without a verdict proves nothing.
        let verdict = result.verdict.unwrap_or(Verdict::Invalid);
        let revision = scenario.revision;
        let partial = verdict == Verdict::Invalid && result.verdict.is_some() && result.repair.is_none();
        if let Some(scenario) = self.scenario_mut(id) {
            scenario.verdicts.insert(revision, verdict);
            if partial {
                scenario.partial.insert(revision);
            }
        }
        let wish = result.repair.as_ref().filter(|_| verdict != Verdict::Realised);
        if let Some(repair) = wish
            && self.repair(id, BTreeMap::from([(repair.stage, repair.faults.clone())]))
        {
            return;
        }
        self.settle(id);
    }

    fn newest_score(&self, id: &ScenarioId) -> u32 {
        self.scenario(id)
            .and_then(|scenario| {
                let item = pipeline::lead(&scenario.spec).into();
                self.state.place(id, Stage::Scoring, &item, scenario.revision)
            })
            .map_or(0, |key| key.revision)
    }

    /// A person has looked. What they want made again is not counted as a repair.
    pub(crate) fn reviewed(&mut self, key: &JobKey, result: &JobResult) {
        let Some(scenario) = self.scenario(&key.scenario) else { return };
        if result.anew.is_empty() || scenario.reviews >= self.state.policy.reviews || scenario.end.is_some() {
            return;
        }
        // What is compiled is changed where it is written.
        let compiled = is_compiled(scenario) && !scenario.spec.pinned.contains_key(&Role::Proposal);
        let mut targets: BTreeMap<Stage, Vec<Fault>> = BTreeMap::new();
        for wish in &result.anew {
            let up = compiled && wish.stage == Stage::Behaviors;
            let stage = if up { Stage::Proposal } else { wish.stage };
            targets.entry(stage).or_default().extend(wish.faults.iter().cloned());
        }
        if self.redo(&key.scenario, &targets)
            && let Some(scenario) = self.scenario_mut(&key.scenario)
        {
            scenario.reviews += 1;
        }
    }

    /// Does stages anew for these reasons, within the scenario's budget.
    pub(crate) fn repair(&mut self, id: &ScenarioId, targets: BTreeMap<Stage, Vec<Fault>>) -> bool {
        let limit = self.state.policy.repairs;
        if self.spent(id).is_some() {
            return false;
        }
        let targets = self.mendable(id, targets);
        if self.scenario(id).is_none_or(|scenario| scenario.repairs >= limit) || !self.redo(id, &targets) {
            return false;
        }
        if let Some(scenario) = self.scenario_mut(id) {
            scenario.repairs += 1;
        }
        true
    }

    /// Moves reasons to the stage that can do something about them: compiled behaviors are the proposal's, and what was sent back to a stage once
    /// and came again is not mended there.
    fn mendable(&self, id: &ScenarioId, targets: BTreeMap<Stage, Vec<Fault>>) -> BTreeMap<Stage, Vec<Fault>> {
        let Some(scenario) = self.scenario(id) else { return targets };
        let compiled = is_compiled(scenario);
        // A pinned proposal mends nothing.
        let asked = !scenario.spec.pinned.contains_key(&Role::Proposal);
        let mut moved: BTreeMap<Stage, Vec<Fault>> = BTreeMap::new();
        for (stage, faults) in targets {
            let told = self.state.place(id, stage, &Item::Whole, scenario.revision).and_then(|key| self.job(key));
            let again = told.is_some_and(|job| are_again(&job.sent_back, &faults));
            let up = asked && (again || compiled && stage == Stage::Behaviors);
            moved.entry(if up { Stage::Proposal } else { stage }).or_default().extend(faults);
        }
        moved
    }

    /// The last rung of the ladder: another proposal, told what went wrong.
    pub(crate) fn repropose(&mut self, key: &JobKey, faults: &[Fault]) -> bool {
        let (limit, repairs) = (self.state.policy.reproposals, self.state.policy.repairs);
        let Some(scenario) = self.scenario(&key.scenario) else { return false };
        if scenario.reproposals >= limit || scenario.repairs >= repairs {
            return false;
        }
        let anew = self.redo(&key.scenario, &BTreeMap::from([(Stage::Proposal, faults.to_vec())]));
        if anew && let Some(scenario) = self.scenario_mut(&key.scenario) {
            scenario.reproposals += 1;
            scenario.repairs += 1;
        }
        anew
    }

    /// Makes a new revision: new jobs for these stages and all after them. What is not ended of the
    /// old revision is superseded; siblings that nothing changed for stay.
    fn redo(&mut self, id: &ScenarioId, targets: &BTreeMap<Stage, Vec<Fault>>) -> bool {
        let Some(scenario) = self.scenario(id) else { return false };
        let authored = pipeline::authored(&scenario.spec);
        // A pinned stage is not asked; what comes after it cannot mend it.
        let able = targets
            .keys()
            .all(|stage| pipeline::is_authored(*stage) && authored.iter().any(|(authored, _)| authored == stage));
        if targets.is_empty() || !able || scenario.settled.is_some() || scenario.end.is_some() || scenario.canceled {
            return false;
        }
        let lead = pipeline::lead(&scenario.spec);
        let (former, revision) = (scenario.revision, scenario.revision + 1);
        let anew = |(stage, item): &(Stage, Item)| {
            targets.contains_key(stage) || targets.keys().any(|target| pipeline::is_after(*stage, item, *target))
        };
        let played = [Stage::Simulation, Stage::Scoring].map(|stage| (stage, Item::Run(lead.clone())));
        let steps: Vec<(Stage, Item)> = authored.into_iter().chain(played).filter(anew).collect();
        let old: Vec<JobKey> =
            steps.iter().filter_map(|(stage, item)| self.state.place(id, *stage, item, former).cloned()).collect();
        for key in &old {
            // The look that asks for it has its result and stands.
            if self.job(key).is_none_or(|job| job.state.is_terminal() || job.result.is_some()) {
                continue;
            }
            self.end_current(key, AttemptEnd::Superseded);
            self.move_to(key, JobState::Superseded, format!("revision {revision}"));
        }
        if let Some(scenario) = self.scenario_mut(id) {
            scenario.revision = revision;
        }
        let first = targets.keys().find(|stage| **stage == Stage::Proposal);
        let made: Vec<JobKey> = steps
            .iter()
            .filter_map(|(stage, item)| {
                // A new proposal makes reasons against the old paths and behaviors void; whoever looks is told all of them.
                let reasons = if *stage == Stage::Review {
                    targets.values().flatten().cloned().collect()
                } else {
                    let own = targets.get(stage).filter(|_| first.is_none_or(|first| first == stage));
                    own.cloned().unwrap_or_default()
                };
                let reasons = feedback(&reasons, &[]);
                self.make(id, (*stage, item.clone()), revision, &reasons)
            })
            .collect();
        for key in made {
            self.unblock(&key);
        }
        true
    }

    /// Settles on the best revision and lets the other runs follow.
    fn settle(&mut self, id: &ScenarioId) {
        let Some(scenario) = self.scenario(id) else { return };
        let Some((revision, _)) = best(scenario) else { return };
        let lead = pipeline::lead(&scenario.spec);
        let runs: Vec<Run> = pipeline::runs(&scenario.spec).into_iter().filter(|run| *run != lead).collect();
        if let Some(scenario) = self.scenario_mut(id) {
            scenario.settled = Some(revision);
        }
        let mut made = Vec::with_capacity(runs.len() * 2);
        for stage in [Stage::Simulation, Stage::Scoring] {
            made.extend(runs.iter().filter_map(|run| self.make(id, (stage, run.clone().into()), revision, &[])));
        }
        for key in made {
            self.unblock(&key);
        }
        self.moved.insert(id.clone());
    }

    /// Ends every scenario in which nothing is left to do.
    pub(crate) fn close_scenarios(&mut self) {
        // Settling may make jobs that end at once and settle nothing more: two rounds are enough,
        // but the loop does not rely on it.
        while let Some(id) = self.moved.pop_first() {
            let Some(scenario) = self.scenario(&id) else { continue };
            if scenario.open > 0 || scenario.end.is_some() {
                continue;
            }
            if scenario.canceled {
                self.end_scenario(&id, ScenarioEnd::Canceled);
            } else if let Some(settled) = scenario.settled {
                let verdict = scenario.verdicts.get(&settled).copied().unwrap_or(Verdict::Invalid);
                self.end_scenario(&id, ScenarioEnd::Judged(verdict));
            } else if best(scenario).is_some() {
                // The newest revision came to nothing; an older one has a verdict.
                self.settle(&id);
            } else {
                self.end_scenario(&id, ScenarioEnd::Failed);
            }
        }
    }
}

/// Whether the behaviors of a scenario are compiled from its proposal.
pub(crate) fn is_compiled(scenario: &Scenario) -> bool {
    scenario.spec.settings.get(BEHAVIORS_BY).is_some_and(|by| by == BY_PROPOSAL)
}

/// Whether every reason was given before.
fn are_again(before: &[Fault], now: &[Fault]) -> bool {
    !now.is_empty() && now.iter().all(|fault| before.iter().any(|other| other.is_like(fault)))
}

/// The revision that counts: the best, the newer of equals; one that came in time before one that came late, and one in which all that was
/// played was seen before one in which it was not.
fn best(scenario: &Scenario) -> Option<(u32, Verdict)> {
    let rank = |revision: u32, verdict: Verdict| match verdict {
        Verdict::Realised => 6,
        Verdict::RealisedLate => 5,
        Verdict::RobotPrevented => 4,
        Verdict::Invalid if scenario.partial.contains(&revision) => 3,
        Verdict::NotTriggered => 2,
        Verdict::Contradicted => 1,
        Verdict::Invalid => 0,
    };
    scenario.verdicts.iter().map(|(revision, verdict)| (*revision, *verdict)).max_by_key(|(r, v)| (rank(*r, *v), *r))
}
