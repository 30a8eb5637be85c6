//! The stage: decodes what the job brings, scores, hands back the report.

use socrates_kit::{Done, Failure, Job, Output, Stage, media};
use socrates_model::{Fault, FaultCode, Location, Paths, Proposal, Reading, Recording, Report, Request, Role, Where};

use crate::evidence::Evidence;
use crate::metrics;
use crate::score::score;

/// Longest remark of a job, characters.
const REMARK_CHARS: usize = 160;

/// Scores one recording per job.
///
/// Inputs: `recording` (MCAP); where there are any, `location`, `request`, `reading`, `proposal`, `paths` (JSON) and
/// `reference` (MCAP, the same scenario and seed with the reference robot) and `twin` (MCAP, the same without a robot). Outputs: `report` (JSON) and `metrics`
/// (CSV). A verdict that asks for repair is part of a job that was done, never a failure.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScoringStage;

/// The inputs, decoded.
struct Inputs {
    recording: Recording,
    location: Option<Location>,
    request: Option<Request>,
    reading: Option<Reading>,
    proposal: Option<Proposal>,
    paths: Option<Paths>,
    reference: Option<Recording>,
    twin: Option<Recording>,
}

impl Inputs {
    fn of(job: &Job) -> Result<Self, Failure> {
        let wants_reference =
            job.has(Role::Reference) && !job.spec().run().is_some_and(|run| run.planner.is_reference());
        Ok(Self {
            recording: decode(job, Role::Recording)?,
            location: job.json_if_there(Role::Location)?,
            request: job.json_if_there(Role::Request)?,
            reading: job.json_if_there(Role::Reading)?,
            proposal: job.json_if_there(Role::Proposal)?,
            paths: job.json_if_there(Role::Paths)?,
            reference: if wants_reference { Some(decode(job, Role::Reference)?) } else { None },
            twin: if job.has(Role::Twin) { Some(decode(job, Role::Twin)?) } else { None },
        })
    }

    fn score(&self) -> Report {
        score(&Evidence {
            location: self.location.as_ref(),
            request: self.request.as_ref(),
            reading: self.reading.as_ref(),
            proposal: self.proposal.as_ref(),
            paths: self.paths.as_ref(),
            reference: self.reference.as_ref(),
            twin: self.twin.as_ref(),
            ..Evidence::of(&self.recording)
        })
    }
}

fn decode(job: &Job, role: Role) -> Result<Recording, Failure> {
    socrates_stream::mcap::read(job.bytes(role)?).map_err(|why| {
        let message = format!("input `{role}` cannot be read as a recording: {why}");
        Failure::from(Fault::new(FaultCode::JSpec, Where::key(format_args!("{} {role}", job.spec().key)), message))
    })
}

impl Stage for ScoringStage {
    const STAGE: socrates_model::job::Stage = socrates_model::job::Stage::Scoring;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        let inputs = Inputs::of(job)?;
        let run = inputs.recording.header.run.clone();
        // Tens of milliseconds of computation do not belong on a thread that answers messages.
        let report = tokio::task::spawn_blocking(move || inputs.score()).await.map_err(|why| {
            let message = format!("scoring run `{run}` broke: {why}");
            Failure::from(Fault::new(FaultCode::JPanic, &job.spec().key, message))
        })?;
        tracing::info!(run = %report.run, verdict = report.verdict.name(), score = report.score, "scored");
        Ok(Done {
            artifacts: vec![
                Output::json(Role::Report, &report)?,
                Output::text(Role::Metrics, media::CSV, metrics::csv(&report)),
            ],
            remark: shortened(&report.verdict_text),
            repair: report.repair,
            verdict: Some(report.verdict),
            ..Done::default()
        })
    }
}

/// The sentence on the verdict, cut for a status line.
fn shortened(text: &str) -> String {
    if text.chars().count() <= REMARK_CHARS {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(REMARK_CHARS - 1).collect();
    short.push('…');
    short
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use socrates_model::job::{JobKey, JobSpec};
    use socrates_model::{FailureClass, ScenarioId, Verdict};

    use super::*;
    use crate::fixture::{Walk, recording};

    fn job(inputs: BTreeMap<Role, Vec<u8>>) -> Job {
        let key = JobKey {
            scenario: ScenarioId::new("test").unwrap(),
            stage: socrates_model::job::Stage::Scoring,
            item: "mppi-1".parse().unwrap(),
            revision: 0,
        };
        let spec = JobSpec {
            key,
            inputs: BTreeMap::new(),
            seed: 1,
            feedback: vec![],
            refused: None,
            settings: BTreeMap::new(),
        };
        Job::detached(spec, inputs)
    }

    #[tokio::test]
    async fn a_recording_alone_gives_a_report_and_a_table() {
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.), Walk::human(1, 9., 1., -1., 0.)], 8.0, 0.01);
        let bytes = socrates_stream::mcap::write(&run, None).unwrap();
        let done = ScoringStage.run(&job([(Role::Recording, bytes)].into())).await.unwrap();
        let report: Report = serde_json::from_slice(&done.artifacts[0].bytes).unwrap();
        assert_eq!(report.recording, run.hash());
        assert_eq!(done.verdict, Some(Verdict::Invalid));
        let table = String::from_utf8(done.artifacts[1].bytes.clone()).unwrap();
        let names = metrics::peers::NAMES.len();
        assert!(table.contains(",socnavbench.closest_pedestrian_distance,"), "{table}");
        assert_eq!(table.lines().count(), report.metrics.len() + names + 1);
    }

    #[tokio::test]
    async fn a_twin_among_the_inputs_tells_what_the_robot_costs_people() {
        let walks = || Walk::human(1, 9., 1., -1., 0.);
        let run = recording(&[Walk::robot(0., 0., 0.5, 0.), walks()], 8.0, 0.01);
        let bytes = |run: &socrates_model::Recording| socrates_stream::mcap::write(run, None).unwrap();
        let inputs = [(Role::Recording, bytes(&run)), (Role::Twin, bytes(&recording(&[walks()], 8.0, 0.01)))];
        let done = ScoringStage.run(&job(inputs.into())).await.unwrap();
        let report: Report = serde_json::from_slice(&done.artifacts[0].bytes).unwrap();
        let of = |id: &str| report.metrics.iter().find(|metric| metric.id == id).unwrap().value;
        assert_eq!((of("people_deviation"), of("flow_delay_mean")), (Some(0.0), Some(0.0)));
        // The person walks past just as near where the robot had stopped: not the robot's doing.
        assert_eq!(of("blame_counterfactual"), Some(0.0));
    }

    #[tokio::test]
    async fn bytes_that_are_no_recording_are_poison_with_a_reason() {
        let failure = ScoringStage.run(&job([(Role::Recording, vec![1, 2, 3])].into())).await.unwrap_err();
        assert_eq!(failure.class, FailureClass::Poison);
        assert!(failure.faults[0].message.to_string().contains("recording"));
        let missing = ScoringStage.run(&job(BTreeMap::new())).await.unwrap_err();
        assert_eq!(missing.class, FailureClass::Poison);
    }
}
