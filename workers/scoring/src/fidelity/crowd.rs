//! Monitors of many people: streams past the robot, density, people all round it, people who come together.

use std::f64::consts::PI;

use socrates_model::{HumanId, Point};

use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::LATE_FACTOR;
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::windows::{Mark, best, held, longest_s, stretches};

/// Slower than this is not walking, m/s.
const WALKING_MPS: f64 = 0.2;
/// How long somebody must walk past to be part of the stream, s.
const KEPT_SECS: f64 = 0.5;

/// What all these monitors need: a robot.
fn alone(signals: &Signals<'_>) -> Option<Finding> {
    signals.tracks.robot.is_none().then(|| Finding::not_applicable("there is no robot in the recording"))
}

/// At least so many different humans walk near the robot at an angle to its heading.
pub(super) fn flow(signals: &Signals<'_>, count: u32, within_m: f64, angle_deg: [f64; 2]) -> Finding {
    if let Some(found) = alone(signals) {
        return found;
    }
    let [low, high] = angle_deg.map(f64::to_radians);
    let mark = |moment: &Moment| {
        let mut margin = (within_m - moment.distance_m).min(moment.human.speed() - WALKING_MPS);
        // At 0 and at 180 degrees the band has no edge.
        if low > 0.0 {
            margin = margin.min(moment.course_rad - low);
        }
        if high < PI - 1e-9 {
            margin = margin.min(high - moment.course_rad);
        }
        Mark::new(moment.t, margin)
    };
    let mut each: Vec<(f64, f64, HumanId)> = signals
        .moments
        .iter()
        .filter_map(|(human, moments)| {
            let found = held(moments.iter().map(mark), KEPT_SECS, 0.0)?;
            Some((found.margin, found.first_s.unwrap_or(found.best_s), *human))
        })
        .collect();
    each.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
    let near = signals.moments.values().filter(|list| list.iter().any(|moment| moment.distance_m <= within_m)).count();
    let passing: Vec<&(f64, f64, HumanId)> = each.iter().filter(|found| found.0 >= 0.0).collect();
    let wanted = usize::try_from(count).unwrap_or(usize::MAX);
    let times: Vec<f64> = {
        let mut times: Vec<f64> = passing.iter().map(|found| found.1).collect();
        times.sort_by(f64::total_cmp);
        times
    };
    let [from, to] = angle_deg;
    let text = format!(
        "{} humans walk within {within_m:.1} m at {from:.0}° to {to:.0}° to the robot's heading ({count} asked); {near} come so near at all",
        passing.len()
    );
    let margin = each.get(wanted.saturating_sub(1)).map_or(-1.0, |found| found.0);
    if wanted == 0 || passing.len() >= wanted {
        // It was seen when the last of those asked for had come.
        let seen = times.get(wanted.saturating_sub(1)).copied().unwrap_or(0.0);
        return Finding::holds(margin.max(0.0), std::iter::once(seen).chain(times).collect(), text).scaled(0.3);
    }
    if near < wanted { Finding::never(margin, times, text) } else { Finding::fails(margin, times, text) }.scaled(0.3)
}

/// The moments of all humans side by side: at each time, the distances from the robot in rising order.
fn distances(signals: &Signals<'_>) -> Vec<(f64, Vec<f64>)> {
    let Some(robot) = &signals.tracks.robot else { return Vec::new() };
    let mut found: Vec<(f64, Vec<f64>)> = robot.samples.iter().map(|sample| (sample.t, Vec::new())).collect();
    for moment in signals.moments.values().flatten() {
        if let Some((_, all)) = found.get_mut(moment.index) {
            all.push(moment.distance_m);
        }
    }
    for (_, all) in &mut found {
        all.sort_by(f64::total_cmp);
    }
    found
}

/// Finding of a condition on the crowd that must hold for some time.
fn kept(marks: &[Mark], for_s: f64, what: &str, near: bool) -> Finding {
    let Some(found) = held(marks.iter().copied(), for_s, 0.0) else {
        return Finding::fails(-1.0, vec![], format!("{what}: the run is shorter than that"));
    };
    let longest = longest_s(marks.iter().copied());
    let finding = match found.first_s {
        Some(from) => {
            Finding::holds(found.margin, vec![from, from + for_s], format!("{what}: from {from:.1} s, {longest:.1} s"))
        }
        None if near => Finding::fails(found.margin, vec![found.best_s], format!("{what}: longest {longest:.1} s")),
        None => Finding::never(found.margin, vec![found.best_s], format!("{what}: never")),
    };
    finding.shifted(longest - for_s)
}

/// So many people per square meter about the robot for some time.
pub(super) fn density(signals: &Signals<'_>, per_m2: [f64; 2], radius_m: f64, for_s: f64) -> Finding {
    if let Some(found) = alone(signals) {
        return found;
    }
    let [low, high] = per_m2;
    let area = PI * radius_m * radius_m;
    let mut most = (0.0, 0.0);
    let marks: Vec<Mark> = distances(signals)
        .into_iter()
        .map(|(t, all)| {
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 people")]
            let density = all.iter().filter(|distance| **distance <= radius_m).count() as f64 / area;
            if density > most.0 {
                most = (density, t);
            }
            Mark::new(t, (density - low).min(high - density))
        })
        .collect();
    let what = format!(
        "{low:.2} to {high:.2} people per m² within {radius_m:.1} m for {for_s:.1} s, at most {:.2} at {:.1} s",
        most.0, most.1
    );
    kept(&marks, for_s, &what, most.0 >= low).scaled(0.1)
}

/// So many humans near the robot at one time, for some time.
pub(super) fn surrounds(signals: &Signals<'_>, count: u32, within_m: f64, for_s: f64) -> Finding {
    if let Some(found) = alone(signals) {
        return found;
    }
    let nth = usize::try_from(count).unwrap_or(usize::MAX).saturating_sub(1);
    let marks: Vec<Mark> = distances(signals)
        .into_iter()
        .map(|(t, all)| Mark::new(t, all.get(nth).map_or_else(|| -within_m.max(1.0), |distance| within_m - distance)))
        .collect();
    let nearest = best(marks.iter().copied());
    let what = format!("{count} humans within {within_m:.1} m of the robot for {for_s:.1} s");
    let what = nearest.map_or_else(
        || what.clone(),
        |mark| format!("{what} (nearest at {:.1} s: human number {count} at {:.1} m)", mark.t, within_m - mark.margin),
    );
    kept(&marks, for_s, &what, nearest.is_some_and(|mark| mark.margin >= 0.0))
}

/// The point a human comes to: its encounter, else the first one of the scenario.
fn goal(signals: &Signals<'_>, human: HumanId) -> Option<Point> {
    let paths = signals.evidence.paths?;
    signals.encounter(human).map(|(_, at)| at).or_else(|| signals.node(&paths.encounters.first()?.node))
}

/// All humans come to the encounter, at about the same time.
pub(super) fn converges(signals: &Signals<'_>, within_m: f64, within_s: f64) -> Finding {
    let mut arrivals: Vec<(f64, HumanId)> = Vec::new();
    let mut missed: Option<(f64, f64, HumanId)> = None;
    let mut there: Vec<HumanId> = Vec::new();
    let asked = signals.evidence.proposal.map_or(&[][..], |proposal| &proposal.humans);
    if let Some(gone) = asked.iter().find(|human| signals.tracks.human(human.id).is_none()) {
        return Finding::fails(-1.0, vec![], format!("{} is not in the recording", gone.id));
    }
    for track in &signals.tracks.humans {
        let Some(id) = track.human() else { continue };
        let Some(at) = goal(signals, id) else {
            return Finding::not_applicable("there is no encounter, or no map to tell where it is");
        };
        let marks = || track.present().map(|sample| Mark::new(sample.t, within_m - (sample.at - at).norm()));
        let inside = stretches(marks(), 0.0);
        match inside.first() {
            Some((from, _)) if track.present().next().is_some_and(|sample| sample.t >= *from) => there.push(id),
            Some((from, _)) => arrivals.push((*from, id)),
            None => {
                if let Some(top) = best(marks())
                    && missed.is_none_or(|(old, _, _)| top.margin < old)
                {
                    missed = Some((top.margin, top.t, id));
                }
            }
        }
    }
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((margin, t, who)) = missed {
        let text = format!(
            "{who} comes only within {:.1} m of the encounter at {t:.1} s ({within_m:.1} m asked)",
            within_m - margin
        );
        return Finding::never(margin, vec![t], text);
    }
    if let Some(who) = there.first() {
        let text = format!("{who} is within {within_m:.1} m of the encounter from the start and does not come to it");
        return Finding::fails(-1.0, vec![0.0], text);
    }
    let (Some((first, early)), Some((last, late))) = (arrivals.first(), arrivals.last()) else {
        return Finding::fails(-1.0, vec![], "there is no human in the recording");
    };
    let spread = last - first;
    let text = format!(
        "all within {within_m:.1} m of the encounter: {early} first at {first:.1} s, {late} last at {last:.1} s (at most {within_s:.1} s apart asked)"
    );
    let times = vec![*last, *first];
    let finding = match spread {
        spread if spread <= within_s => Finding::holds(within_s - spread, times, text),
        spread if spread <= LATE_FACTOR * within_s => Finding::late(within_s - spread, times, text),
        spread => Finding::fails(within_s - spread, times, text),
    };
    finding.shifted(within_s - spread)
}
