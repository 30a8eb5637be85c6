//! Changes after which something is seen, or done, long before its time.

use socrates_maps::{Ground, sight_clear};
use socrates_model::{
    Action, AgentId, AgentState, Clause, ClauseRole, EventKind, Gesture, HumanId, Point, Predicate, Recording,
};
use socrates_scoring::Evidence;
use socrates_scoring::fidelity::{Signals, since};
use socrates_scoring::{MOVING_MPS, Tracks};

use super::edit::{Stood, ahead_of_time, delayed, gestures_from, reacts_first, stands_at, states, ticks_of};

/// From so far the robot sees somebody who should come up suddenly, m.
const SEEN_M: (f64, f64) = (6.0, 9.0);
/// Who stands for so long where the robot sees it is seen long before its time, s.
const LONG_SECS: f64 = 1.5;
/// A startle comes so long before the door opens, s.
const BEFORE_SECS: f64 = 2.0;
/// Who is no farther than this from where it starts has not set off, m.
const SET_OFF_M: f64 = 0.1;

/// A reason that comes no later than this has no time before it for a reaction without a reason, s.
const REASON_SECS: f64 = 6.0;
/// A reaction without a reason is over so long before the reason comes, s.
const CLEAR_SECS: f64 = 2.0;
/// Less standing than this shows no reaction, s.
const STANDS_SECS: f64 = 1.0;

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

fn musts<'a>(evidence: &Evidence<'a>) -> impl Iterator<Item = &'a Clause> {
    let all = evidence.proposal.into_iter().flat_map(|proposal| &proposal.expected_events);
    all.filter(|clause| clause.must && clause.role == ClauseRole::Setup)
}

/// `E: startle before opening`, `I: seen 8 m ahead` of the case studies, from where there is room for it.
pub(super) fn early(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let Some(proposal) = evidence.proposal else { return };
    for human in &proposal.humans {
        let stays = musts(evidence)
            .any(|clause| matches!(clause.predicate, Predicate::StaysInside { human: who, .. } if who == human.id));
        let looks = musts(evidence).any(|clause| {
            matches!(&clause.predicate, Predicate::Looks { human: who, .. }
                | Predicate::Reacts { human: who, act: Action::LookAtRobot, .. } if *who == human.id)
        });
        if stays && looks {
            startled(evidence.recording, human.id, add);
        }
        let hidden = musts(evidence)
            .any(|clause| matches!(clause.predicate, Predicate::HiddenUntil { human: who, .. } if who == human.id));
        if hidden {
            seen_ahead(evidence, human.id, add);
        }
    }
    before_reason(evidence, add);
}

/// What somebody does for a reason, they do before it and not after it: they stand where they start, and walk past when it
/// comes; they say early what they should answer.
fn before_reason(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let (Some(proposal), Ok(tracks)) = (evidence.proposal, Tracks::read(evidence.recording)) else { return };
    let (run, signals) = (evidence.recording, Signals::new(evidence, &tracks));
    for human in &proposal.humans {
        let id = human.id;
        for act in [Action::StandStill, Action::LookAtRobot] {
            let asked = |clause: &Clause| {
                let stands = matches!(clause.predicate, Predicate::StandsStill { human: who, .. } if who == id);
                let looks = matches!(clause.predicate, Predicate::Looks { human: who, .. } if who == id);
                let reacts = matches!(&clause.predicate, Predicate::Reacts { human: who, act: of, .. } if *who == id && *of == act);
                reacts || stands && act == Action::StandStill || looks && act == Action::LookAtRobot
            };
            if human.relation.stands() || !musts(evidence).any(asked) {
                continue;
            }
            let reason = since(&signals, id, |rule| rule.act == act).ok().filter(|reason| reason.secs() >= REASON_SECS);
            if let Some(stood) = reason.and_then(|reason| stands(run, &signals, id, &act, reason.secs())) {
                let about = format!("{id}, {}", act.phrase());
                add("N: reaction only before its reason", about, reacts_first(run, AgentId::Human(id), &stood));
            }
        }
        for clause in musts(evidence) {
            let Predicate::Gestures { agent: AgentId::Human(who), gesture } = clause.predicate else { continue };
            let reason = since(&signals, id, |rule| rule.gesture == Some(gesture)).ok();
            let Some(reason) = reason.filter(|reason| who == id && reason.secs() >= REASON_SECS) else { continue };
            let early = says_early(run, AgentId::Human(id), gesture, reason.secs());
            if let Some(recording) = early {
                add("N: gesture only before its reason", format!("{id}, {gesture}"), recording);
            }
        }
    }
}

/// When somebody stands for an act that they do from a time on; nothing where they do not stand, or do it more than once.
fn stands(run: &Recording, signals: &Signals<'_>, id: HumanId, act: &Action, from_s: f64) -> Option<Stood> {
    let mut spans = signals.leaves_of(id).iter().filter(|span| act.is_leaf(&span.name));
    let (span, other) = (spans.next()?, spans.next());
    if other.is_some() || span.from_s < from_s - STANDS_SECS {
        return None;
    }
    let all = states(run, AgentId::Human(id));
    let from = ticks_of(run, span.from_s);
    let still = |state: &AgentState| state.speed() < MOVING_MPS;
    let begins = from + all.iter().skip(from).take_while(|state| !still(state)).count();
    let ends = begins + all.iter().skip(begins).take_while(|state| still(state)).count();
    let walks_on = ends < all.len() && ends >= begins + ticks_of(run, STANDS_SECS);
    let stood = Stood { samples: (begins, ends), leaf_s: (span.from_s, span.to_s) };
    (walks_on && begins <= ticks_of(run, span.to_s)).then_some(stood)
}

/// The gesture as long as it was made, but over before its reason comes.
fn says_early(run: &Recording, agent: AgentId, gesture: Gesture, reason_s: f64) -> Option<Recording> {
    let all = states(run, agent);
    let long = all.iter().filter(|state| state.gesture() == Some(gesture)).count();
    let start = ticks_of(run, reason_s - CLEAR_SECS).checked_sub(long)?;
    (long > 0).then(|| gestures_from(run, agent, gesture, start))
}

/// Whoever is startled by the robot is so before the door opens.
fn startled(run: &Recording, id: HumanId, add: &mut Add<'_>) {
    let opens = run.events.iter().find(|event| matches!(event.kind, EventKind::Door { open: true, .. }));
    let looks = run.events.iter().find(
        |event| matches!(&event.kind, EventKind::Leaf { human, leaf } if *human == id && Action::LookAtRobot.is_leaf(leaf)),
    );
    let (Some(opens), Some(looks)) = (opens.map(|event| event.time.secs()), looks.map(|event| event.time.secs()))
    else {
        return;
    };
    if looks >= opens && opens > 2.0 * BEFORE_SECS {
        let by = looks - opens + BEFORE_SECS;
        add("N: startle before the door opens", id.to_string(), delayed(run, AgentId::Human(id), -by));
    }
}

/// Whoever should come up suddenly stands where the robot sees it from afar.
pub(super) fn seen_ahead(evidence: &Evidence<'_>, id: HumanId, add: &mut Add<'_>) {
    let run = evidence.recording;
    let Some(location) = evidence.location else { return };
    // Behind a door that opens by itself nobody is seen before.
    if run.events.iter().any(|event| matches!(event.kind, EventKind::Door { .. })) {
        return;
    }
    let ground = Ground::of(&location.grid);
    let sight = ground.sight();
    let (robot, old) = (states(run, AgentId::Robot), states(run, AgentId::Human(id)));
    let Some(start) = old.first().map(AgentState::point) else { return };
    let clear = |k: usize, at: &Point| {
        robot.get(k).is_some_and(|state| {
            (SEEN_M.0..=SEEN_M.1).contains(&(state.point() - at).norm()) && sight_clear(sight, &state.point(), at, &[])
        })
    };
    // It goes so much of its way as it has time for before it would set off.
    let waits = old.iter().take_while(|state| (state.point() - start).norm() <= SET_OFF_M).count();
    let long = ticks_of(run, LONG_SECS);
    let step = ticks_of(run, 0.2).max(1);
    let apart = old.iter().zip(&robot).map(|(a, b)| (a.point() - b.point()).norm()).enumerate();
    let meets = apart.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k);
    for upto in (waits..meets).step_by(step) {
        let Some(at) = old.get(upto).map(AgentState::point) else { break };
        let Some(k) = (0..upto.saturating_sub(long)).rev().step_by(step).find(|k| clear(*k, &at)) else { continue };
        if upto - k <= waits {
            let about = format!("{id} at {:.1}, {:.1}", at.x, at.y);
            add("N: seen from 6 m ahead and more", about, ahead_of_time(run, AgentId::Human(id), upto, upto - k));
            return;
        }
    }
    // Where its own way has no such place: at its encounter node, waiting for the robot.
    let node = evidence.paths.and_then(|paths| paths.encounter_of(id)).and_then(|node| location.graph.node(node));
    if let Some(node) = node.filter(|node| (0..meets).step_by(step).any(|k| clear(k, &node.at))) {
        let yaw = old.get(meets).map_or(0.0, |state| state.yaw);
        let about = format!("{id} at `{}`", node.id);
        add("N: seen from 6 m ahead and more", about, stands_at(run, AgentId::Human(id), &node.at, yaw));
    }
}
