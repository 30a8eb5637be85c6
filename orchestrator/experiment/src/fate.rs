//! The fate of an attempt: what strikes it, what comes of it, and when. A function of specification, cell, attempt and question;
//! what other attempts met does not enter.
//!
//! ```text
//! answer from the beginning:  with probability √ρ the draw that all answers of this stage and scenario have in common,
//!                             else a draw of its own; wrong where the draw is below v = 1 - (1 - rate) · first_cut^share
//! asked again with reasons:   with probability q the violation is gone, and then with probability c there is another;
//!                             else the answer has the same violation once more
//! ```
//!
//! So two answers that were made from the beginning break a rule with correlation ρ, and k of them are all wrong with probability
//! v (√ρ + (1 - √ρ) v)^k + (1 - v) ((1 - √ρ) v)^k, which is v^k where ρ is 0: [`all_wrong`].

use socrates_model::fault::{FailureClass, Fault, FaultCode};
use socrates_model::job::{JobSpec, Stage};
use socrates_model::{Where, seeds};

use crate::draws::{At, part};
use crate::kind::Kind;
use crate::policies::Told;
use crate::spec::{Cell, Spec};

/// Different violations that a stage has.
const VIOLATIONS: usize = 1_000;

/// What comes of an attempt, if its worker lives to report it.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A right answer, or work done.
    Right,
    /// A wrong answer that no check finds.
    Unseen,
    /// A wrong answer, and the fault that is found.
    Violated(Fault),
    /// An answer that cannot be read.
    Malformed,
    /// The server failed.
    Error,
    /// The server did not answer in time.
    Timeout,
    /// The server asks to slow down.
    Overload,
}

impl Outcome {
    /// Word in tables.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Unseen => "unseen",
            Self::Violated(_) => "violated",
            Self::Malformed => "malformed",
            Self::Error => "error",
            Self::Timeout => "timeout",
            Self::Overload => "overload",
        }
    }

    /// The class and the fault with which it is reported; none for a success.
    #[must_use]
    pub fn failure(&self) -> Option<(FailureClass, Fault)> {
        let fault = |code: FaultCode, text: &'static str| Fault::new(code, Where::default(), text);
        match self {
            Self::Right | Self::Unseen => None,
            Self::Violated(fault) => Some((FailureClass::Semantic, fault.clone())),
            Self::Malformed => {
                Some((FailureClass::Unparsable, fault(FaultCode::EJson, "injected: the answer is not JSON")))
            }
            Self::Error => Some((FailureClass::Transient, fault(FaultCode::T5xx, "injected: the server failed"))),
            Self::Timeout => Some((FailureClass::Transient, fault(FaultCode::TTimeout, "injected: no answer in time"))),
            Self::Overload => Some((FailureClass::Overload, fault(FaultCode::T429, "injected: slow down"))),
        }
    }

    /// Whether an answer came, and whether it was right.
    #[must_use]
    pub const fn answered(&self) -> Option<bool> {
        match self {
            Self::Right => Some(true),
            Self::Unseen | Self::Violated(_) | Self::Malformed => Some(false),
            Self::Error | Self::Timeout | Self::Overload => None,
        }
    }

    /// The kind of fault that it is.
    #[must_use]
    pub const fn kind(&self) -> Option<Kind> {
        match self {
            Self::Right | Self::Unseen => None,
            Self::Violated(_) => Some(Kind::SemanticViolation),
            Self::Malformed => Some(Kind::Malformed),
            Self::Error => Some(Kind::LlmError),
            Self::Timeout => Some(Kind::LlmTimeout),
            Self::Overload => Some(Kind::Overload),
        }
    }
}

/// When an orchestrator dies that records a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crash {
    /// Nothing of the step is saved.
    BeforeCommit,
    /// Everything is saved, nothing answered.
    AfterCommit,
}

/// The fate of one attempt.
#[derive(Debug, Clone, PartialEq)]
pub struct Fate {
    /// What comes of it.
    pub outcome: Outcome,
    /// Working time until it is reported, ms.
    pub works_ms: u64,
    /// Working time after which the worker dies.
    pub dies_ms: Option<u64>,
    /// Whether the worker is cut off from the beginning of the attempt on.
    pub cut: bool,
    /// Whether the orchestrator dies at the report.
    pub crash: Option<Crash>,
    /// Whether the worker is stopped from the beginning of the attempt on, for `times_ms.cut`.
    pub frozen: bool,
    /// Whether the report is committed slowly.
    pub slow: bool,
    /// Tokens in and out, as far as they are asked for.
    pub tokens: [u64; 2],
}

/// What decides the fates of a cell's attempts.
#[derive(Debug, Clone, Copy)]
pub struct Fates<'a> {
    /// Specification.
    pub spec: &'a Spec,
    /// Cell.
    pub cell: &'a Cell,
}

impl Fates<'_> {
    /// Whether a kind of fault strikes this attempt, which begins at this time.
    pub(crate) fn strikes(&self, kind: Kind, at: At, begun_ms: u64) -> bool {
        let strike = &self.cell.strike;
        strike.kinds.contains(&kind)
            && kind.strikes(at.stage)
            && strike.holds_at(begun_ms)
            && at.happens(self.spec.seed, kind.word(), self.cell.rate)
    }

    /// The fate of an attempt at this job, which begins at this time.
    #[must_use]
    pub fn of(&self, job: &JobSpec, at: At, begun_ms: u64) -> Fate {
        let (seed, times) = (self.spec.seed, &self.spec.times_ms);
        let strikes = |kind: Kind| self.strikes(kind, at, begun_ms);
        let whole_ms = self.spec.durations.of(at.stage).of(seed, at);
        let some_ms = part(whole_ms, at.draw(seed, "moment")).max(1);
        let told = self.told(job);
        let [asked, answered] = self.spec.tokens.of(at.stage);
        let asked = if told.is_some() { asked.saturating_add(self.spec.tokens.refused) } else { asked };
        let (outcome, works_ms, tokens) = if strikes(Kind::LlmTimeout) {
            // What was asked is paid for, whether or not an answer came.
            (Outcome::Timeout, times.timeout, [asked, 0])
        } else if strikes(Kind::Overload) {
            (Outcome::Overload, some_ms.min(1_000), [0, 0])
        } else if strikes(Kind::LlmError) {
            (Outcome::Error, some_ms, [0, 0])
        } else if strikes(Kind::Malformed) {
            (Outcome::Malformed, whole_ms, [asked, answered])
        } else {
            (self.answer(at, told, begun_ms), whole_ms, [asked, answered])
        };
        let dies_ms = strikes(Kind::WorkerKill).then(|| part(works_ms, at.draw(seed, "death")).max(1));
        Fate {
            outcome,
            works_ms,
            dies_ms,
            cut: strikes(Kind::Partition),
            crash: strikes(Kind::OrchestratorKill)
                .then(|| if at.draw(seed, "crash") < 0.5 { Crash::BeforeCommit } else { Crash::AfterCommit }),
            frozen: strikes(Kind::WorkerFreeze),
            slow: strikes(Kind::SlowStore),
            tokens: if dies_ms.is_some() { [tokens[0], 0] } else { tokens },
        }
    }

    /// The violation that the author is told of, where it has its refused answer before it.
    fn told<'g>(&self, job: &'g JobSpec) -> Option<&'g Fault> {
        let there = job.refused.is_some() && self.cell.policy.told != Told::None;
        job.feedback.first().filter(|_| there)
    }

    /// The kinds of the cell's faults that this fate has: what is to strike its attempt.
    pub fn due(&self, fate: &Fate) -> impl Iterator<Item = Kind> {
        let has = [
            (Kind::WorkerKill, fate.dies_ms.is_some()),
            (Kind::Partition, fate.cut),
            (Kind::WorkerFreeze, fate.frozen),
            (Kind::OrchestratorKill, fate.crash.is_some()),
            (Kind::SlowStore, fate.slow),
        ];
        let of_author = fate.outcome.kind().filter(|kind| self.cell.strike.kinds.contains(kind));
        has.into_iter().filter(|(_, has)| *has).map(|(kind, _)| kind).chain(of_author)
    }

    /// The answer of an author.
    fn answer(&self, at: At, told: Option<&Fault>, begun_ms: u64) -> Outcome {
        let (seed, model) = (self.spec.seed, &self.spec.model);
        let Some(share) = self.violation(at.stage, begun_ms) else { return Outcome::Right };
        let told = told.filter(|fault| fault.code == code(at.stage));
        let violation = match told {
            Some(fault) => {
                let mended = match self.cell.policy.told {
                    Told::Named => model.fix_if_named,
                    Told::Vague => model.fix_if_vague,
                    Told::None => 0.0,
                };
                if !at.happens(seed, "mended", mended) {
                    Some(fault.clone())
                } else if at.happens(seed, "collateral", model.collateral) {
                    Some(violation(at, at, seed))
                } else {
                    None
                }
            }
            None => {
                let common = at.happens(seed, "common", model.correlation.sqrt());
                let of = if common { at.all() } else { at };
                (of.draw(seed, "answer") < share).then(|| violation(at, of, seed))
            }
        };
        match violation {
            None => Outcome::Right,
            Some(fault) if at.happens(seed, "found", model.found) => Outcome::Violated(fault),
            Some(_) => Outcome::Unseen,
        }
    }

    /// Probability that an answer from the beginning breaks a rule; none where no author is asked.
    fn violation(&self, stage: Stage, begun_ms: u64) -> Option<f64> {
        let own = self.cell.workload.asks.of(stage).map(|_| self.cell.workload.violation(stage))?;
        let strike = &self.cell.strike;
        let put_in = strike.kinds.contains(&Kind::SemanticViolation) && strike.holds_at(begun_ms);
        Some(if put_in { 1.0 - (1.0 - own) * (1.0 - self.cell.rate) } else { own })
    }
}

/// The code under which a stage's violations are found.
const fn code(stage: Stage) -> FaultCode {
    match stage {
        Stage::Proposal => FaultCode::PVerify,
        Stage::Paths => FaultCode::GShort,
        Stage::Behaviors | Stage::Simulation | Stage::Scoring | Stage::Review => FaultCode::BMatch,
    }
}

/// One of the violations of a stage: which one is drawn by `of`.
fn violation(at: At, of: At, seed: u64) -> Fault {
    let which = seeds::below(of.bits(seed, "which"), VIOLATIONS);
    Fault::new(
        code(at.stage),
        Where::default().at_key(format_args!("rule {which}")),
        "injected: the answer breaks this rule",
    )
}

/// Probability that k answers which were made from the beginning are all wrong, each with probability `share` and two of them
/// with this correlation.
#[must_use]
pub fn all_wrong(share: f64, correlation: f64, tries: u32) -> f64 {
    let common = correlation.sqrt();
    let (hard, easy) = (common + (1.0 - common) * share, (1.0 - common) * share);
    let power = |base: f64| libm::pow(base, f64::from(tries));
    share * power(hard) + (1.0 - share) * power(easy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_correlation_tries_are_independent_and_with_all_of_it_they_are_one() {
        for (share, tries) in [(0.27, 1), (0.27, 3), (0.45, 5)] {
            assert!((all_wrong(share, 0.0, tries) - share.powi(i32::try_from(tries).unwrap())).abs() < 1e-12);
            assert!((all_wrong(share, 1.0, tries) - share).abs() < 1e-12);
            assert!((all_wrong(share, 0.3, 1) - share).abs() < 1e-12, "the first cut is the same whatever comes later");
        }
        // The second moment of two indicators is their correlation, by its definition.
        let (v, rho) = (0.3, 0.2);
        assert!((all_wrong(v, rho, 2) - (v * v + rho * v * (1.0 - v))).abs() < 1e-12);
    }
}
