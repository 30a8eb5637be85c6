//! Changes after which a step of a sequence is not done as it should: late, without effect, or without end.

use socrates_model::{Action, AgentId, AgentState, ClauseRole, EventKind, HumanId, Predicate, Recording};
use socrates_scoring::Evidence;
use socrates_scoring::Tracks;
use socrates_scoring::fidelity::{Signals, step_times};

use super::edit::{gestures_from, states, ticks_of, time_of, with_states};

/// A sign comes so much later than it should, s.
const LATE_SECS: f64 = 8.0;
/// Somebody who walks on instead of standing does so at this speed, m/s.
const WALKS_MPS: f64 = 0.4;
/// Time after the beginning of a step at which somebody who does not do it stands still, s.
const STEPS_SECS: f64 = 0.2;
/// A step that lasts less is no test, s.
const LEAST_SECS: f64 = 2.5;
/// After the end of a step that should have come so much has to be left of the run, s.
const AFTER_SECS: f64 = 4.0;

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

/// Every step that must be seen, spoiled.
pub(super) fn steps(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let (Some(proposal), Ok(tracks)) = (evidence.proposal, Tracks::read(evidence.recording)) else { return };
    let (run, signals) = (evidence.recording, Signals::new(evidence, &tracks));
    for clause in proposal.expected_events.iter().filter(|clause| clause.must && clause.role == ClauseRole::Setup) {
        let Predicate::Step { human, rule, .. } = &clause.predicate else { continue };
        let (human, agent) = (*human, AgentId::Human(*human));
        let others = || {
            let rules = proposal.human(human).map_or(&[][..], |one| &one.rules);
            rules.iter().filter(|other| *other != rule)
        };
        let Some((begun_s, over_s)) = step_times(&signals, human, rule) else { continue };
        let about = format!("{human}, step {}", rule.step.unwrap_or(0));
        let end_s = signals.end_s();
        if let Some(gesture) = rule.gesture
            && !others().any(|other| other.gesture == Some(gesture))
            && begun_s + LATE_SECS + AFTER_SECS < end_s
        {
            let late = gestures_from(run, agent, gesture, ticks_of(run, begun_s + LATE_SECS));
            add("N: step's sign late", about.clone(), late);
        }
        if matches!(
            rule.act,
            Action::TurnBack | Action::ComeBack | Action::GoTo(_) | Action::ChangePace(_) | Action::ApproachTo(_)
        ) {
            add("N: step without its effect", about, stays_on(run, human, begun_s + STEPS_SECS));
            continue;
        }
        if others().any(|other| other.act == rule.act) || !rule.act.stands() {
            continue;
        }
        if over_s - begun_s >= LEAST_SECS && rule.gesture.is_none() {
            add("N: step without its effect", about.clone(), walks_on(run, agent, (begun_s, over_s)));
        }
        if !rule.until.is_empty() && over_s + AFTER_SECS < end_s {
            add("N: step without end", about, stays_on(run, human, over_s - STEPS_SECS));
        }
    }
}

/// The agent walks on for a time in which it should stand; its tree says that it stands.
fn walks_on(run: &Recording, agent: AgentId, (from_s, to_s): (f64, f64)) -> Recording {
    let old = states(run, agent);
    let (mut x, mut y) = (0.0, 0.0);
    let mut last_s = from_s;
    let new: Vec<AgentState> = old
        .iter()
        .map(|state| {
            let t = time_of(run, state);
            let walks = t >= from_s && t <= to_s;
            // To and fro, so that nobody leaves the floor.
            let way = if libm::sin(2.0 * (t - from_s)) >= 0.0 { WALKS_MPS } else { -WALKS_MPS };
            let (sin, cos) = libm::sincos(state.yaw);
            if walks {
                x += way * cos * (t - last_s);
                y += way * sin * (t - last_s);
            }
            last_s = t;
            let (vx, vy) = if walks { (way * cos, way * sin) } else { (state.vx, state.vy) };
            AgentState { x: state.x + x, y: state.y + y, vx, vy, ..*state }
        })
        .collect();
    with_states(run, agent, &new, Some)
}

/// The human goes on with what they do at a time, to the end of the run.
fn stays_on(run: &Recording, human: HumanId, from_s: f64) -> Recording {
    let agent = AgentId::Human(human);
    let old = states(run, agent);
    let Some(stand) = old.iter().rfind(|state| time_of(run, state) < from_s).copied() else { return run.clone() };
    let still = AgentState { vx: 0.0, vy: 0.0, omega: 0.0, ..stand };
    let new: Vec<AgentState> =
        old.iter().map(|state| if time_of(run, state) < from_s { *state } else { still }).collect();
    let mut found = with_states(run, agent, &new, |t| (t < from_s).then_some(t));
    found.events.retain(|event| !matches!(&event.kind, EventKind::StepEnded { human: who, .. } if *who == human));
    found
}
