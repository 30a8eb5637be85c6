//! The story of a run in lines with times, and what the robot did in one sentence.

use std::collections::BTreeSet;

use socrates_model::act::{ACTS, Takes};
use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::report::Standing;
use socrates_model::{Action, AgentId, ClauseRole, Event, EventKind, HumanId};

use crate::fidelity::{Judged, Signals};
use crate::metrics::Scene;
use crate::tracks::MOVING_MPS;

/// Longest story, lines; what is over is counted in a last line.
const MAX_LINES: usize = 120;
/// Shorter stops of the robot are not worth a line, s.
const STOP_SECS: f64 = 0.8;
/// Who moves so soon after it is to walk goes at once, s.
const AT_ONCE_SECS: f64 = 0.3;

/// One line per thing that happened, in time order: `3.2 s  human_1 sees the robot at 4.8 m`.
pub(crate) fn story(signals: &Signals<'_>) -> Vec<String> {
    let mut lines: Vec<(f64, String)> = Vec::new();
    let mut add = |t: f64, text: String| lines.push((t, text));
    let events = &signals.evidence.recording.events;
    let mut led: BTreeSet<HumanId> = BTreeSet::new();
    for (index, event) in events.iter().enumerate() {
        let t = event.time.secs();
        if let EventKind::Leaf { human, leaf } = &event.kind {
            let first = led.insert(*human);
            if Action::Navigate.is_leaf(leaf) {
                // Who is sent on its way and held back for a while goes when it goes.
                let next = events.iter().skip(index + 1).find(|later| is_leaf_of(&later.kind, *human));
                if let Some(goes) = goes_at(signals, *human, t, next.map_or(f64::INFINITY, |next| next.time.secs())) {
                    add(goes, format!("{human} {}", if first { "sets off" } else { "walks on" }));
                }
                continue;
            }
        }
        if let Some(text) = told(signals, event) {
            add(t, text);
        }
    }
    let has_gestures =
        signals.evidence.recording.events.iter().any(|event| matches!(event.kind, EventKind::Gesture { .. }));
    for track in signals.tracks.all().filter(|_| !has_gestures) {
        let mut before = None;
        for sample in &track.samples {
            if sample.gesture != before
                && let Some(gesture) = sample.gesture
            {
                add(sample.t, format!("{} says {gesture}", track.agent));
            }
            before = sample.gesture;
        }
    }
    for (t, text) in robot_stops(signals).into_iter().chain(closest(signals)) {
        add(t, text);
    }
    lines.sort_by(|a, b| a.0.total_cmp(&b.0));
    lines.dedup();
    let over = lines.len().saturating_sub(MAX_LINES);
    lines.truncate(MAX_LINES);
    let mut story: Vec<String> = lines.into_iter().map(|(t, text)| format!("{t:.1} s  {text}")).collect();
    if over > 0 {
        story.push(format!("and {over} more"));
    }
    story
}

fn is_leaf_of(kind: &EventKind, human: HumanId) -> bool {
    matches!(kind, EventKind::Leaf { human: who, .. } if *who == human)
}

/// When somebody who is to walk from a time on first moves, before another time; `None` where it never does.
fn goes_at(signals: &Signals<'_>, human: HumanId, from_s: f64, to_s: f64) -> Option<f64> {
    let Some(track) = signals.tracks.human(human) else { return Some(from_s) };
    let moves = track.present().find(|sample| sample.t >= from_s && sample.t < to_s && sample.speed() > MOVING_MPS)?;
    Some(if moves.t - from_s <= AT_ONCE_SECS { from_s } else { moves.t })
}

/// An event in words; steps along paths are not told.
fn told(signals: &Signals<'_>, event: &Event) -> Option<String> {
    Some(match &event.kind {
        EventKind::Gesture { gesture: None, .. } | EventKind::Node { .. } => return None,
        EventKind::Gesture { agent, gesture: Some(gesture), to } => {
            format!("{agent} says {gesture}{}", to.map_or_else(String::new, |to| format!(" to {to}")))
        }
        EventKind::Leaf { human, leaf } => match phrase(leaf) {
            Some(words) => format!("{human} {words}"),
            None if leaf == "GoToPlace" => format!("{human} goes to another place"),
            None if Action::ChangePace(0.0).is_leaf(leaf) => format!("{human} changes pace"),
            None if Action::LookAt(*human).is_leaf(leaf) => format!("{human} stops and looks at another human"),
            None if Action::FollowHuman(*human).is_leaf(leaf) => format!("{human} follows {}", leader(signals, *human)),
            None if leaf == DRIVEN_LEAF => format!("a driver outside moves {human}"),
            None => format!("{human} runs {leaf}"),
        },
        EventKind::StepEnded { human, step } => format!("step {step} of {human} is over"),
        EventKind::Sees { human, distance_m } => format!("{human} sees the robot at {distance_m:.1} m"),
        EventKind::Encounter { .. } => return signals.evidence.recording.encounter_words(event),
        EventKind::Contact { a, b, depth_m } => format!("{a} and {b} touch, {:.0} mm deep", depth_m * 1e3),
        EventKind::WallContact { agent, depth_m } => format!("{agent} touches a wall, {:.0} mm deep", depth_m * 1e3),
        EventKind::Door { door, open } => format!("{door} {}", if *open { "opens" } else { "closes" }),
        EventKind::RobotArrived => "the robot is at its goal".to_owned(),
        EventKind::Stuck { agent } => format!("{agent} is stuck"),
        EventKind::End { reason } => format!("the run ends: {reason}"),
    })
}

/// Whom somebody follows who follows another human.
fn leader(signals: &Signals<'_>, human: HumanId) -> String {
    let rules = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |who| &who.rules);
    let led = rules.iter().find_map(|rule| if let Action::FollowHuman(id) = rule.act { Some(id) } else { None });
    led.map_or_else(|| "another human".to_owned(), |id| id.to_string())
}

/// What a leaf does, in words.
fn phrase(leaf: &str) -> Option<String> {
    if leaf.is_empty() {
        return None;
    }
    ACTS.iter().rev().find(|act| act.takes == Takes::Nothing && act.is_leaf(leaf)).map(|act| act.does.to_owned())
}

/// Stops of the robot before it is at its goal, with who is nearest ahead.
fn robot_stops(signals: &Signals<'_>) -> Vec<(f64, String)> {
    let Some(robot) = &signals.tracks.robot else { return Vec::new() };
    let end = signals.arrived_s.unwrap_or(f64::INFINITY);
    let mut found = Vec::new();
    let mut since: Option<f64> = None;
    let mut moved = false;
    for sample in robot.samples.iter().filter(|sample| sample.t < end) {
        if sample.speed() > MOVING_MPS {
            if let Some(from) = since.take().filter(|from| moved && sample.t - from >= STOP_SECS) {
                found.push((from, format!("the robot stops for {:.1} s{}", sample.t - from, near(signals, from))));
            }
            moved = true;
        } else {
            since.get_or_insert(sample.t);
        }
    }
    if let Some(from) = since.filter(|_| moved) {
        found.push((from, format!("the robot stops for good{}", near(signals, from))));
    }
    found
}

fn near(signals: &Signals<'_>, t: f64) -> String {
    let nearest = signals
        .moments
        .iter()
        .filter_map(|(human, moments)| {
            Some((human, moments.iter().find(|moment| moment.t >= t && moment.t < t + 1.0)?))
        })
        .filter(|(_, moment)| moment.ahead_m > 0.0 && moment.distance_m < 3.0)
        .min_by(|a, b| a.1.distance_m.total_cmp(&b.1.distance_m));
    nearest.map_or_else(String::new, |(human, moment)| {
        format!(", {human} {:.1} m ahead, center to center", moment.distance_m)
    })
}

/// The closest approach of every human, where they come near at all.
fn closest(signals: &Signals<'_>) -> Vec<(f64, String)> {
    signals
        .moments
        .iter()
        .filter_map(|(human, moments)| {
            let moment = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))?;
            (moment.distance_m < 5.0).then(|| {
                (moment.t, format!("{human} and the robot are closest, {:.2} m center to center", moment.distance_m))
            })
        })
        .collect()
}

/// What the robot did, in one sentence: `arrived at 41.2 s · smallest distance 0.71 m …`.
pub(crate) fn robot_text(scene: &Scene<'_>, judged: &Judged) -> String {
    if scene.robot().is_none() {
        return "no robot in the recording".to_owned();
    }
    let mut parts = vec![match (scene.arrived_s, scene.goal) {
        (Some(t), _) => format!("arrived at {t:.1} s"),
        (None, Some(goal)) => {
            let last = scene.robot().and_then(|robot| robot.samples.last());
            let left = last
                .map_or(f64::NAN, |sample| scene.to_goal_m(&sample.at).unwrap_or_else(|| (goal - sample.at).norm()));
            format!("did not arrive, {left:.1} m short")
        }
        (None, None) => format!("went {:.1} m, goal not known", scene.path_length_m()),
    }];
    let outcome = || judged.clauses.iter().filter(|(clause, _)| clause.role == ClauseRole::Outcome);
    let entered = outcome().find(|(clause, _)| clause.predicate == socrates_model::Predicate::RobotEntersLast);
    if let Some((_, finding)) = entered {
        match finding.standing {
            Standing::Holds | Standing::Late => parts.push("entered after everybody had left".to_owned()),
            Standing::Fails | Standing::NotTriggered => parts.push(finding.evidence.clone()),
            Standing::NotApplicable => {}
        }
    }
    let least = scene
        .pairs()
        .zip(&scene.distances)
        .filter_map(|((_, human), distance)| Some((distance.least()?, human.agent)))
        .min_by(|a, b| a.0.1.total_cmp(&b.0.1));
    if let Some(((t, distance), who)) = least {
        parts.push(format!("smallest distance {distance:.2} m (surface to surface, {who} at {t:.1} s)"));
    }
    let contacts = scene.distances.iter().filter(|distance| distance.least().is_some_and(|(_, d)| d < 0.0)).count();
    if contacts > 0 {
        parts.push(format!("touched {contacts} of {} humans", scene.distances.len()));
    }
    let judged_outcomes = outcome().filter(|(_, finding)| finding.standing != Standing::NotApplicable).count();
    if judged_outcomes > 0 {
        let good = outcome().filter(|(_, f)| matches!(f.standing, Standing::Holds | Standing::Late)).count();
        let missed =
            |finding: &crate::fidelity::Finding| matches!(finding.standing, Standing::Fails | Standing::NotTriggered);
        let first = outcome().find(|(_, finding)| missed(finding));
        let not = first.map_or_else(String::new, |(clause, _)| format!(", not: {}", clause.text));
        parts.push(format!("{good} of {judged_outcomes} outcome clauses{not}"));
    }
    let stuck = scene
        .signals
        .evidence
        .recording
        .events
        .iter()
        .any(|event| event.kind == (EventKind::Stuck { agent: AgentId::Robot }));
    if stuck {
        parts.push("got stuck".to_owned());
    }
    parts.join(" · ")
}
