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
use socrates_model::hash::derive_seed;
use socrates_model::job::{Artifact, Stage};
use socrates_model::wire::ScenarioSpec;
use socrates_model::{Digest, Fault};

/// The planner that plays the robot script; it always runs.
pub const REFERENCE: &str = "reference";
/// The planner that is no robot: the twin run.
pub const NO_ROBOT: &str = "none";

/// The stages as they are handed out: later ones first, so that started scenarios get finished.
pub const URGENCY: [Stage; 6] =
    [Stage::Scoring, Stage::Simulation, Stage::Behaviors, Stage::Paths, Stage::Review, Stage::Proposal];

/// Item of the review job in which a person looks at the proposal.
pub const PROPOSAL_LOOK: &str = "proposal";
/// Item of the review job in which a person looks at proposal, paths and behaviors together.
pub const DRAFT_LOOK: &str = "draft";

/// Whether a job of this stage and item needs, directly or not, what the stage `earlier` makes.
#[must_use]
pub fn is_after(stage: Stage, item: &str, earlier: Stage) -> bool {
    match stage {
        Stage::Proposal => false,
        Stage::Review if item == DRAFT_LOOK => is_authored(earlier),
        Stage::Review | Stage::Paths | Stage::Behaviors => earlier == Stage::Proposal,
        Stage::Simulation => is_authored(earlier),
        Stage::Scoring => is_authored(earlier) || earlier == Stage::Simulation,
    }
}

/// Whether a job of this stage and item waits for this look.
#[must_use]
pub fn is_after_look(stage: Stage, item: &str, look: &str) -> bool {
    match stage {
        Stage::Proposal => false,
        Stage::Review => item == DRAFT_LOOK && look == PROPOSAL_LOOK,
        Stage::Paths | Stage::Behaviors => look == PROPOSAL_LOOK,
        Stage::Simulation | Stage::Scoring => true,
    }
}

/// Role of the output that a successful attempt must have.
#[must_use]
pub const fn main_role(stage: Stage) -> Option<&'static str> {
    match stage {
        Stage::Proposal => Some("proposal"),
        Stage::Paths => Some("paths"),
        Stage::Behaviors => Some("behaviors"),
        Stage::Simulation => Some("recording"),
        Stage::Scoring => Some("report"),
        // A person who changes nothing hands nothing back.
        Stage::Review => None,
    }
}

/// Whether an author (perhaps a language model) does this stage.
#[must_use]
pub const fn is_authored(stage: Stage) -> bool {
    matches!(stage, Stage::Proposal | Stage::Paths | Stage::Behaviors)
}

/// A run: planner and seed.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Run {
    /// Planner.
    pub planner: String,
    /// Simulation seed.
    pub seed: u64,
}

impl Run {
    /// Item of the job keys of this run.
    #[must_use]
    pub fn item(&self) -> String {
        format!("{}-{}", self.planner, self.seed)
    }
}

/// The run whose verdict is the scenario's: the reference robot with the first seed.
#[must_use]
pub fn lead(spec: &ScenarioSpec) -> Run {
    Run { planner: REFERENCE.to_owned(), seed: spec.run_seeds.first().copied().unwrap_or(1) }
}

/// Every run of a scenario once, reference first for every seed, the lead run at the front.
#[must_use]
pub fn runs(spec: &ScenarioSpec) -> Vec<Run> {
    let seeds: &[u64] = if spec.run_seeds.is_empty() { &[1] } else { &spec.run_seeds };
    let mut seen = BTreeSet::new();
    std::iter::once(REFERENCE)
        .chain(spec.planners.iter().map(String::as_str))
        .flat_map(|planner| seeds.iter().map(move |seed| Run { planner: planner.to_owned(), seed: *seed }))
        .filter(|run| seen.insert(run.clone()))
        .collect()
}

/// The authoring and review jobs that a scenario needs, stage and item, in pipeline order.
#[must_use]
pub fn authored(spec: &ScenarioSpec) -> Vec<(Stage, &'static str)> {
    let asked = |stage: Stage| !spec.pinned.contains_key(stage.name());
    [
        (Stage::Proposal, "", asked(Stage::Proposal)),
        // Who pins a proposal has looked at it.
        (Stage::Review, PROPOSAL_LOOK, spec.review && asked(Stage::Proposal)),
        (Stage::Paths, "", asked(Stage::Paths)),
        (Stage::Behaviors, "", asked(Stage::Behaviors)),
        (Stage::Review, DRAFT_LOOK, spec.review && (asked(Stage::Paths) || asked(Stage::Behaviors))),
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
        None => derive_seed(spec.seed, &[stage.name(), &seed_revision.to_string(), &reseeds.to_string()]),
    }
}

/// The output of this role among artifacts.
#[must_use]
pub fn output(artifacts: &[Artifact], role: &str) -> Option<Digest> {
    artifacts.iter().find(|artifact| artifact.role == role).map(|artifact| artifact.digest)
}

/// The text of a refused answer among what a failed attempt left.
#[must_use]
pub fn refused(artifacts: &[Artifact]) -> Option<Digest> {
    output(artifacts, "refused").or_else(|| output(artifacts, "answer"))
}

/// The stage that can do something about a fault found in `found_by`.
#[must_use]
pub fn owner(fault: &Fault, found_by: Stage) -> Option<Stage> {
    if let Remedy::BackTo(stage) = fault.code.remedy() {
        return Some(stage);
    }
    let by_code = match fault.code.code().split('-').next() {
        Some("P") => Some(Stage::Proposal),
        Some("G") => Some(Stage::Paths),
        Some("B") => Some(Stage::Behaviors),
        Some(_) | None => None,
    };
    match by_code {
        Some(stage) if stage == found_by || is_after(found_by, "", stage) => Some(stage),
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
            planners: planners.iter().map(|p| (*p).to_owned()).collect(),
            run_seeds: seeds.to_vec(),
            pinned: BTreeMap::new(),
            settings: BTreeMap::new(),
            review: false,
        }
    }

    #[test]
    fn the_reference_robot_runs_first_and_once() {
        let items: Vec<String> =
            runs(&spec(&["mppi", "reference", "mppi"], &[3, 4, 3])).iter().map(Run::item).collect();
        assert_eq!(items, ["reference-3", "reference-4", "mppi-3", "mppi-4"]);
        assert_eq!(runs(&spec(&[], &[])).len(), 1);
    }

    #[test]
    fn every_planner_meets_the_same_people() {
        let spec = spec(&["mppi"], &[3]);
        let of = |planner: &str| {
            let run = Run { planner: planner.to_owned(), seed: 3 };
            seed(&spec, Stage::Simulation, Some(&run), 0, 0)
        };
        assert_eq!(of("reference"), of("mppi"));
        assert_ne!(seed(&spec, Stage::Paths, None, 0, 0), seed(&spec, Stage::Paths, None, 1, 0));
    }

    #[test]
    fn a_pinned_proposal_is_neither_asked_nor_reviewed() {
        let mut spec = spec(&[], &[1]);
        spec.review = true;
        let proposal = [(Stage::Proposal, ""), (Stage::Review, PROPOSAL_LOOK)];
        let rest = [(Stage::Paths, ""), (Stage::Behaviors, ""), (Stage::Review, DRAFT_LOOK)];
        assert_eq!(authored(&spec), [&proposal[..], &rest[..]].concat());
        spec.pinned.insert("proposal".to_owned(), Digest::of(b"p"));
        assert_eq!(authored(&spec), rest);
        spec.pinned.insert("paths".to_owned(), Digest::of(b"p"));
        spec.pinned.insert("behaviors".to_owned(), Digest::of(b"b"));
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
