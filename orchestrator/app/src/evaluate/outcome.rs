//! What became of one scenario of an evaluation, out of the history of its jobs.

use std::collections::BTreeMap;

use serde::Deserialize;
use socrates_model::job::{Artifact, Stage};
use socrates_model::wire::ScenarioStatus;
use socrates_model::{Digest, FailureClass, Family, Fault, JobState, Role, ScenarioEnd, Verdict};
use socrates_orchestrator::{Attempt, AttemptEnd};
use socrates_stream::csv::joined;

use super::spec::Case;
use crate::history::PastJob;

/// The stages that an author answers.
const AUTHORED: [Stage; 3] = [Stage::Proposal, Stage::Paths, Stage::Behaviors];

/// One scenario of one arm.
#[derive(Debug, Clone, Default)]
pub(super) struct Outcome {
    /// How it ended: a verdict, or `failed`.
    pub(super) result: Option<ScenarioEnd>,
    /// Every stage's first answer was right as it came. What a server did (429, 5xx …) is no answer.
    pub(super) first_pass: bool,
    /// As above, or after a repair that changes no meaning.
    pub(super) after_repair: bool,
    /// Every stage had a right answer in the end, before anything was simulated.
    pub(super) after_asking: bool,
    /// The first run was as asked.
    pub(super) first_run: bool,
    /// The scenario was realised in the end.
    pub(super) realised: bool,
    /// Questions that were asked.
    pub(super) asks: usize,
    /// Paths that the solver wrote in the author's place.
    pub(super) by_solver: usize,
    /// Times that it went back after a run.
    pub(super) sent_back: usize,
    /// Tokens in and out.
    pub(super) tokens: (u64, u64),
    /// Time of the author, ms.
    pub(super) author_ms: u64,
    /// Codes that were put in, by stage, with how many of them the checks found in the same answer.
    pub(super) injected: BTreeMap<(Stage, String), (usize, usize)>,
    /// Codes that were found in refused answers, by stage.
    pub(super) found: BTreeMap<(Stage, String), usize>,
    /// Codes that were found in answers into which nothing was put.
    pub(super) in_clean: usize,
    /// Answers into which nothing was put.
    pub(super) clean: usize,
}

/// What an exchange tells beside its words.
#[derive(Debug, Default, Deserialize)]
struct Told {
    #[serde(default)]
    how: socrates_author::How,
    #[serde(default)]
    repairs: Vec<Fault>,
    #[serde(default)]
    injected: Vec<String>,
    #[serde(default)]
    faults: Vec<Fault>,
}

/// Reads an artifact's text.
pub(super) type Fetch<'a> = &'a dyn Fn(&Digest) -> Option<Vec<u8>>;

impl Outcome {
    /// Out of the history of a scenario.
    pub(super) fn of(status: &ScenarioStatus, jobs: &[PastJob], fetch: Fetch<'_>) -> Self {
        let realised = status.result == Some(ScenarioEnd::Judged(Verdict::Realised));
        let mut out = Self { result: status.result, realised, ..Self::default() };
        (out.first_pass, out.after_repair, out.after_asking) = (true, true, true);
        for stage in AUTHORED {
            let mut first = jobs.iter().filter(|job| job.key.stage == stage && job.key.revision == 0);
            let Some(job) = first.next() else {
                // A stage that was never reached had no right answer.
                (out.first_pass, out.after_repair, out.after_asking) = (false, false, false);
                continue;
            };
            let done = job.state == JobState::Succeeded;
            let refused = job.attempts.iter().filter(|attempt| was_refused(attempt)).count();
            let repaired = exchange(&job.artifacts, fetch).is_some_and(|told| !told.repairs.is_empty());
            out.after_asking &= done;
            out.after_repair &= done && refused == 0;
            out.first_pass &= done && refused == 0 && !repaired;
        }
        let mut scored = jobs.iter().filter(|job| job.key.stage == Stage::Scoring && job.key.revision == 0);
        out.first_run = scored.next().is_some_and(|job| job.verdict == Some(Verdict::Realised));
        out.sent_back = jobs.iter().filter(|job| !job.sent_back.is_empty()).count();
        for job in jobs.iter().filter(|job| AUTHORED.contains(&job.key.stage)) {
            out.count(job, fetch);
        }
        out
    }

    fn count(&mut self, job: &PastJob, fetch: Fetch<'_>) {
        let stage = job.key.stage;
        for attempt in &job.attempts {
            self.asks += 1;
            self.tokens.0 += attempt.tokens.0;
            self.tokens.1 += attempt.tokens.1;
            self.author_ms += attempt.wall_ms;
            let kept = if attempt.end == Some(AttemptEnd::Succeeded) { &job.artifacts } else { &attempt.artifacts };
            let told = exchange(kept, fetch).unwrap_or_default();
            self.by_solver += usize::from(told.how.by_solver);
            let found: Vec<&str> = told.faults.iter().chain(&told.repairs).map(|fault| fault.code.code()).collect();
            for code in &told.injected {
                let entry = self.injected.entry((stage, code.clone())).or_default();
                entry.0 += 1;
                entry.1 += usize::from(!found.is_empty());
            }
            if was_refused(attempt) {
                for fault in socrates_model::fault::hard(&attempt.faults) {
                    *self.found.entry((stage, fault.code.code().to_owned())).or_default() += 1;
                }
            }
            if told.injected.is_empty() && !is_transport(attempt) {
                self.clean += 1;
                self.in_clean += usize::from(was_refused(attempt));
            }
        }
    }

    /// Realised with its first answers, about which nothing was told.
    pub(super) const fn unaided(&self) -> bool {
        self.after_repair && self.first_run
    }

    /// Names of the columns of [`Outcome::line`], those of the case first.
    pub(super) const COLUMNS: &'static str = "arm,request,guided,location,repeat,seed,result,first_pass,after_repair,after_asking,first_run,unaided,realised,asks,by_solver,sent_back,tokens_in,tokens_out,author_ms,injected,found";

    /// A line of the table.
    pub(super) fn line(&self, arm: &str, case: &Case) -> String {
        let codes = |of: &mut dyn Iterator<Item = (&(Stage, String), usize)>| {
            let codes: Vec<String> = of.map(|((_, code), count)| format!("{code}:{count}")).collect();
            codes.join(" ")
        };
        let bit = |value: bool| u8::from(value).to_string();
        let cells = [
            arm.to_owned(),
            case.request.clone(),
            bit(case.guided),
            case.location.clone(),
            case.repeat.to_string(),
            case.seed.to_string(),
            self.result.map_or_else(String::new, |end| end.to_string()),
            bit(self.first_pass),
            bit(self.after_repair),
            bit(self.after_asking),
            bit(self.first_run),
            bit(self.unaided()),
            bit(self.realised),
            self.asks.to_string(),
            self.by_solver.to_string(),
            self.sent_back.to_string(),
            self.tokens.0.to_string(),
            self.tokens.1.to_string(),
            self.author_ms.to_string(),
            codes(&mut self.injected.iter().map(|(key, (count, _))| (key, *count))),
            codes(&mut self.found.iter().map(|(key, count)| (key, *count))),
        ];
        joined(&cells)
    }
}

/// Whether an answer came and was refused; what the server or the worker did is no answer.
fn was_refused(attempt: &Attempt) -> bool {
    matches!(attempt.class, Some(FailureClass::Semantic | FailureClass::Unparsable)) && !is_transport(attempt)
}

fn is_transport(attempt: &Attempt) -> bool {
    attempt.faults.iter().any(|fault| matches!(fault.code.family(), Family::Transport | Family::Job))
}

fn exchange(artifacts: &[Artifact], fetch: Fetch<'_>) -> Option<Told> {
    let artifact = artifacts.iter().find(|artifact| artifact.role == Role::Exchange)?;
    let bytes = match &artifact.inline {
        Some(text) => text.clone().into_bytes(),
        None => fetch(&artifact.digest)?,
    };
    serde_json::from_slice(&bytes).ok()
}
