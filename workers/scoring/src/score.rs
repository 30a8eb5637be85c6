//! Evidence in, report out.

use socrates_model::{FORMAT, Report, Verdict};

use crate::evidence::Evidence;
use crate::fidelity::{Signals, by_name, encounter_gaps, judge, rule, ruling_of_played};
use crate::metrics::{self, Scene};
use crate::tracks::{TrackFault, Tracks};
use crate::{narrative, repair};

/// Judges one recording: metrics, clauses, verdict, story. Pure; a broken recording gives a report
/// with the verdict `invalid` and metrics that are not applicable.
#[must_use]
pub fn score(evidence: &Evidence<'_>) -> Report {
    let recording = evidence.recording;
    let mut report = Report {
        format: FORMAT,
        run: recording.header.run.clone(),
        planner: recording.header.planner.clone(),
        seed: recording.header.seed,
        recording: recording.hash(),
        verdict: Verdict::Invalid,
        verdict_text: String::new(),
        score: 0.0,
        clauses: Vec::new(),
        metrics: Vec::new(),
        thresholds: metrics::signature(),
        robot_text: String::new(),
        success: false,
        story: Vec::new(),
        encounter_gaps_s: std::collections::BTreeMap::new(),
        simulated_s: 0.0,
        repair: None,
    };
    let tracks = match Tracks::read(recording) {
        Ok(tracks) => tracks,
        Err(fault) => {
            report.verdict_text = format!("the recording proves nothing: {fault}");
            report.robot_text = "the recording cannot be judged".to_owned();
            report.metrics = metrics::none(&fault.to_string());
            report.repair = repair::of_broken(evidence, &fault);
            return report;
        }
    };
    let signals = Signals::new(evidence, &tracks);
    let judged = judge(&signals);
    let gaps = encounter_gaps(&signals);
    let reference =
        evidence.reference.and_then(|recording| verdict_of(&Evidence { recording, reference: None, ..*evidence }).ok());
    let ruling = rule(evidence, &judged, &gaps, reference);
    let scene = Scene::new(&signals);
    report.metrics = metrics::measure(&scene);
    report.success = report.metric("success").and_then(|metric| metric.value).is_some_and(|yes| yes > 0.5);
    report.robot_text = narrative::robot_text(&scene, &judged);
    report.story = narrative::story(&signals);
    report.repair = repair::of(evidence, ruling.verdict, &judged);
    report.clauses = judged.results();
    report.verdict = ruling.verdict;
    report.verdict_text = ruling.text;
    report.score = ruling.score;
    report.encounter_gaps_s = by_name(&gaps);
    report.simulated_s = (tracks.end_s() * 1e3).round() / 1e3;
    report
}

/// The verdict on what was played, without metrics.
///
/// # Errors
/// A recording whose tracks cannot be read.
pub fn verdict_of(evidence: &Evidence<'_>) -> Result<Verdict, TrackFault> {
    let tracks = Tracks::read(evidence.recording)?;
    let signals = Signals::new(evidence, &tracks);
    let judged = judge(&signals);
    Ok(ruling_of_played(evidence, &judged, &encounter_gaps(&signals), None).verdict)
}
