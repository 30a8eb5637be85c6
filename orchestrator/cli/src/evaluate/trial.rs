//! One scenario by one arm: its stages asked as often as allowed, then simulated and judged.

use std::time::Instant;

use socrates_author::{Desk, Papers, Written};
use socrates_model::fault::hard;
use socrates_model::hash::derive_seed;
use socrates_model::job::Stage;
use socrates_model::{Fault, FaultCode, RunId, Verdict};
use socrates_scoring::REFERENCE;

use super::spec::{Arm, Case, Feedback, Plan};
use crate::play::{self, Made};

/// A fault that was found: stage, attempt, code.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Found {
    pub(super) stage: Stage,
    pub(super) attempt: u32,
    pub(super) code: FaultCode,
}

/// What came of one scenario by one arm.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    pub(super) case: String,
    pub(super) guided: bool,
    pub(super) repeat: usize,
    pub(super) arm: String,
    /// Every stage was right at its first ask, as it came.
    pub(super) first: bool,
    /// Every stage was right at its first ask, repaired or not.
    pub(super) repaired: bool,
    /// Every stage was right in the end.
    pub(super) written: bool,
    /// The reference robot's run realised it; nothing where it was not simulated.
    pub(super) realised: Option<bool>,
    pub(super) asks: u32,
    pub(super) tokens: (u64, u64),
    pub(super) secs: f64,
    pub(super) faults: Vec<Found>,
    pub(super) injected: usize,
}

/// Makes one scenario. Its seed depends on plan, request and repeat alone, so that arms are paired.
pub(super) async fn run(desk: &Desk, plan: &Plan, case: &Case, repeat: usize, arm: &Arm) -> Trial {
    let seed = derive_seed(plan.seed, &[&case.name, &repeat.to_string()]);
    let mut trial = Trial {
        case: case.name.clone(),
        guided: case.guided,
        repeat,
        arm: arm.name.clone(),
        first: true,
        repaired: true,
        written: false,
        realised: None,
        asks: 0,
        tokens: (0, 0),
        secs: 0.0,
        faults: Vec::new(),
        injected: 0,
    };
    let start = Instant::now();
    let made = write(desk, plan, case, arm, seed, &mut trial).await;
    trial.secs = start.elapsed().as_secs_f64();
    trial.written = made.is_some();
    trial.first &= trial.written;
    trial.repaired &= trial.written;
    if let Some(made) = made.filter(|_| plan.simulate) {
        trial.realised = Some(is_realised(case, &made, seed));
    } else if plan.simulate {
        trial.realised = Some(false);
    }
    trial
}

async fn write(desk: &Desk, plan: &Plan, case: &Case, arm: &Arm, seed: u64, trial: &mut Trial) -> Option<Made> {
    let papers = |stage: Stage, proposal| Papers {
        stage,
        request: case.prepared.request.clone(),
        reading: case.prepared.reading.clone(),
        location: case.prepared.location.clone(),
        proposal,
        only: Vec::new(),
        feedback: Vec::new(),
        refused: None,
        seed: derive_seed(seed, &[stage.name()]),
        settings: arm.job_settings(),
        attempt: 1,
    };
    let most = arm.attempts.unwrap_or(plan.attempts);
    let Written::Proposal(proposal) = ask(desk, papers(Stage::Proposal, None), arm, most, trial).await? else {
        return None;
    };
    let asked = papers(Stage::Paths, Some(proposal.clone()));
    let Written::Paths(paths) = ask(desk, asked, arm, most, trial).await? else { return None };
    let asked = papers(Stage::Behaviors, Some(proposal.clone()));
    let Written::Behaviors(behaviors) = ask(desk, asked, arm, most, trial).await? else { return None };
    Some(Made { proposal, paths, behaviors })
}

/// One stage, asked again as the arm says until it is right.
async fn ask(desk: &Desk, mut papers: Papers, arm: &Arm, most: u32, trial: &mut Trial) -> Option<Written> {
    for attempt in 1..=most {
        papers.attempt = attempt;
        trial.asks += 1;
        match desk.answer(papers.clone()).await {
            Ok(answer) => {
                count(trial, Some(&answer.exchange));
                trial.first &= attempt == 1 && answer.exchange.repairs.is_empty();
                trial.repaired &= attempt == 1;
                return Some(answer.written);
            }
            Err(refusal) => {
                count(trial, refusal.exchange.as_deref());
                let found = hard(&refusal.faults);
                trial.faults.extend(found.iter().map(|fault| Found { stage: papers.stage, attempt, code: fault.code }));
                match arm.feedback {
                    Feedback::Named => {
                        papers.feedback.extend(refusal.faults);
                        papers.refused = refusal.text;
                    }
                    Feedback::Vague => {
                        let vague = Fault::new(FaultCode::ESchema, "answer", "something in it is wrong; try again");
                        papers.feedback = vec![vague];
                        papers.refused = refusal.text;
                    }
                    Feedback::None => {}
                }
            }
        }
    }
    None
}

fn count(trial: &mut Trial, exchange: Option<&socrates_author::Exchange>) {
    if let Some(exchange) = exchange {
        trial.tokens.0 += exchange.tokens.0;
        trial.tokens.1 += exchange.tokens.1;
        trial.injected += exchange.injected.len();
    }
}

/// Runs it with the reference robot and asks the judge.
fn is_realised(case: &Case, made: &Made, seed: u64) -> bool {
    let prepared = &case.prepared;
    let Ok(run) = RunId::new(format!("{REFERENCE}-1")) else { return false };
    let recording = play::simulate(&prepared.request, &prepared.location, made.clone(), run, REFERENCE, seed);
    recording.is_ok_and(|recording| {
        let evidence = play::evidence(&prepared.request, &prepared.reading, &prepared.location, made, &recording);
        socrates_scoring::score(&evidence).verdict == Verdict::Realised
    })
}
