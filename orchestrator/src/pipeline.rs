//! How the stages hang together: who needs whose output, which runs there are, which seeds.
//!
//! ```text
//! proposal ─► look? ─┬─► paths ─────┐
//!                    └─► behaviors ─┴─► look? ─► simulation ─► scoring      (per planner and seed)
//! ```
//!
//! A look is a job of stage `review`: a person accepts what was made, changes it, or wants stages made again.

use std::collections::BTreeSet;

use socrates_model::fault::Remedy;
use socrates_model::job::{Artifact, Item, Look, Stage};
use socrates_model::seeds::derive_seed;
use socrates_model::wire::ScenarioSpec;
use socrates_model::{Digest, Family, Fault, PlannerName, Role, Run};

/// The stages as they are handed out: later ones first, so that started scenarios get finished.
pub const URGENCY: [Stage; 6] =
    [Stage::Scoring, Stage::Simulation, Stage::Behaviors, Stage::Paths, Stage::Review, Stage::Proposal];

/// Whether a job of this stage and item needs, directly or not, what the stage `earlier` makes.
#[must_use]
pub fn is_after(stage: Stage, item: &Item, earlier: Stage) -> bool {
    match stage {
        Stage::Proposal => false,
        Stage::Review if item.look() == Some(Look::Draft) => is_authored(earlier),
        Stage::Review | Stage::Paths | Stage::Behaviors => earlier == Stage::Proposal,
        Stage::Simulation => is_authored(earlier),
        Stage::Scoring => is_authored(earlier) || earlier == Stage::Simulation,
    }
}

/// Whether a job of this stage and item waits for this look.
#[must_use]
pub fn is_after_look(stage: Stage, item: &Item, look: Look) -> bool {
    match stage {
        Stage::Proposal => false,
        Stage::Review => item.look() == Some(Look::Draft) && look == Look::Proposal,
        Stage::Paths | Stage::Behaviors => look == Look::Proposal,
        Stage::Simulation | Stage::Scoring => true,
    }
}

/// Whether an author (perhaps a language model) does this stage.
#[must_use]
pub const fn is_authored(stage: Stage) -> bool {
    matches!(stage, Stage::Proposal | Stage::Paths | Stage::Behaviors)
}

/// The run whose verdict is the scenario's: the reference robot with the first seed.
#[must_use]
pub fn lead(spec: &ScenarioSpec) -> Run {
    Run::reference(spec.run_seeds.first().copied().unwrap_or(1))
}

/// Every run of a scenario once, reference first for every seed, the lead run at the front.
#[must_use]
pub fn runs(spec: &ScenarioSpec) -> Vec<Run> {
    let seeds: &[u64] = if spec.run_seeds.is_empty() { &[1] } else { &spec.run_seeds };
    let mut seen = BTreeSet::new();
    std::iter::once(PlannerName::reference())
        .chain(spec.planners.iter().cloned())
        .flat_map(|planner| seeds.iter().map(move |seed| Run { planner: planner.clone(), seed: *seed }))
        .filter(|run| seen.insert(run.clone()))
        .collect()
}

/// The authoring and review jobs that a scenario needs, stage and item, in pipeline order.
#[must_use]
pub fn authored(spec: &ScenarioSpec) -> Vec<(Stage, Item)> {
    let asked = |role: Role| !spec.pinned.contains_key(&role);
    let (proposal, paths, behaviors) = (asked(Role::Proposal), asked(Role::Paths), asked(Role::Behaviors));
    [
        (Stage::Proposal, Item::Whole, proposal),
        // Whoever pins a proposal has looked at it.
        (Stage::Review, Look::Proposal.into(), spec.review && proposal),
        (Stage::Paths, Item::Whole, paths),
        (Stage::Behaviors, Item::Whole, behaviors),
        (Stage::Review, Look::Draft.into(), spec.review && (paths || behaviors)),
    ]
    .into_iter()
    .filter_map(|(stage, item, needed)| needed.then_some((stage, item)))
    .collect()
}

/// Seed of a job. Simulation and scoring take the run's seed and nothing of planner or revision, so
/// that every planner meets the same people and an unchanged run can be used again.
#[must_use]
pub fn seed(spec: &ScenarioSpec, stage: Stage, run: Option<&Run>, seed_revision: u32, reseeds: u32) -> u64 {
    match run {
        Some(run) => derive_seed(spec.seed, &[stage.name(), &run.seed.to_string()]),
        None => authored_seed(spec.seed, stage, seed_revision, reseeds),
    }
}

/// Seed of a job that asks an author, in a scenario of this base seed.
#[must_use]
pub fn authored_seed(base_seed: u64, stage: Stage, seed_revision: u32, reseeds: u32) -> u64 {
    derive_seed(base_seed, &[stage.name(), &seed_revision.to_string(), &reseeds.to_string()])
}

/// The output of this role among artifacts.
#[must_use]
pub fn output(artifacts: &[Artifact], role: Role) -> Option<Digest> {
    artifacts.iter().find(|artifact| artifact.role == role).map(|artifact| artifact.digest)
}

/// The text of a refused answer among what a failed attempt left.
#[must_use]
pub fn refused(artifacts: &[Artifact]) -> Option<Digest> {
    output(artifacts, Role::Refused)
}

/// The stage that can do something about a fault found in `found_by`.
#[must_use]
pub fn owner(fault: &Fault, found_by: Stage) -> Option<Stage> {
    if let Remedy::BackTo(stage) = fault.code.remedy() {
        return Some(stage);
    }
    let by_code = match fault.code.family() {
        Family::Proposal => Some(Stage::Proposal),
        Family::Paths => Some(Stage::Paths),
        Family::Behaviors => Some(Stage::Behaviors),
        Family::Transport | Family::Answer | Family::Dynamic | Family::Map | Family::Job => None,
    };
    match by_code {
        Some(stage) if stage == found_by || is_after(found_by, &Item::Whole, stage) => Some(stage),
        // Paths and behaviors cannot send each other back, and syntax is the asked stage's own.
        Some(_) | None => is_authored(found_by).then_some(found_by),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::FaultCode;
    use std::collections::BTreeMap;

    fn spec(planners: &[&str], seeds: &[u64]) -> ScenarioSpec {
        ScenarioSpec {
            id: "a".parse().unwrap(),
            request: Digest::of(b"r"),
            location: Digest::of(b"l"),
            reading: Digest::of(b"g"),
            seed: 7,
            planners: planners.iter().map(|name| name.parse().unwrap()).collect(),
            run_seeds: seeds.to_vec(),
            pinned: BTreeMap::new(),
            settings: BTreeMap::new(),
            review: false,
            order: None,
        }
    }

    #[test]
    fn the_reference_robot_runs_first_and_once() {
        let items: Vec<String> =
            runs(&spec(&["mppi", "reference", "mppi"], &[3, 4, 3])).iter().map(Run::to_string).collect();
        assert_eq!(items, ["reference-3", "reference-4", "mppi-3", "mppi-4"]);
        assert_eq!(runs(&spec(&[], &[])).len(), 1);
    }

    #[test]
    fn every_planner_meets_the_same_people() {
        let spec = spec(&["mppi"], &[3]);
        let of = |planner: &str| {
            let run = Run { planner: planner.parse().unwrap(), seed: 3 };
            seed(&spec, Stage::Simulation, Some(&run), 0, 0)
        };
        assert_eq!(of("reference"), of("mppi"));
        assert_ne!(seed(&spec, Stage::Paths, None, 0, 0), seed(&spec, Stage::Paths, None, 1, 0));
    }

    #[test]
    fn a_pinned_proposal_is_neither_asked_nor_reviewed() {
        let mut spec = spec(&[], &[1]);
        spec.review = true;
        let proposal = [(Stage::Proposal, Item::Whole), (Stage::Review, Look::Proposal.into())];
        let draft = (Stage::Review, Item::Look(Look::Draft));
        let rest = [(Stage::Paths, Item::Whole), (Stage::Behaviors, Item::Whole), draft];
        assert_eq!(authored(&spec), [&proposal[..], &rest[..]].concat());
        spec.pinned.insert(Role::Proposal, Digest::of(b"p"));
        assert_eq!(authored(&spec), rest);
        spec.pinned.insert(Role::Paths, Digest::of(b"p"));
        spec.pinned.insert(Role::Behaviors, Digest::of(b"b"));
        assert_eq!(authored(&spec), [], "everything was written by hand");
    }

    #[test]
    fn a_fault_goes_to_the_stage_that_can_mend_it() {
        let fault = |code| Fault::new(code, "x", "y");
        assert_eq!(owner(&fault(FaultCode::GDisc), Stage::Simulation), Some(Stage::Paths));
        assert_eq!(owner(&fault(FaultCode::DNoTrig), Stage::Scoring), Some(Stage::Behaviors));
        assert_eq!(owner(&fault(FaultCode::PPlace), Stage::Paths), Some(Stage::Proposal));
        assert_eq!(owner(&fault(FaultCode::BMatch), Stage::Paths), Some(Stage::Paths));
        assert_eq!(owner(&fault(FaultCode::EJson), Stage::Proposal), Some(Stage::Proposal));
        assert_eq!(owner(&fault(FaultCode::JSpec), Stage::Simulation), None);
    }
}
