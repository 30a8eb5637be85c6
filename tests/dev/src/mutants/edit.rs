//! Changes of one agent's part of a recording.

use socrates_model::geometry::wrap_angle;
use socrates_model::nalgebra::Vector2;
use socrates_model::recording::{ABSENT_LEAF, AgentInfo};
use socrates_model::time::STEP_SECS;
use socrates_model::{AgentId, AgentState, Event, EventKind, Gesture, HumanId, Point, Recording, SimTime, Vector};

/// Flags without their gesture or without their leaf.
const NO_GESTURE: u32 = 0xffff_00ff;
const NO_LEAF: u32 = 0x0000_ffff;

/// States of an agent in tick order.
pub(super) fn states(run: &Recording, agent: AgentId) -> Vec<AgentState> {
    run.track(agent).copied().collect()
}

/// The agents of the recording that are human.
pub(super) fn humans(run: &Recording) -> Vec<HumanId> {
    let human = |agent: AgentId| match agent {
        AgentId::Human(id) => Some(id),
        AgentId::Robot => None,
    };
    run.header.agents.iter().filter_map(|info| human(info.agent)).collect()
}

/// Ticks in so many seconds.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a run, not negative")]
pub(super) fn ticks_of(run: &Recording, seconds: f64) -> usize {
    let step = if run.header.step_s > 0.0 { run.header.step_s } else { STEP_SECS };
    // Samples may be several ticks apart.
    let agents = run.header.agents.len().max(1);
    let apart = match (run.frames.first(), run.frames.get(agents)) {
        (Some(a), Some(b)) => b.tick.saturating_sub(a.tick).max(1),
        _ => 1,
    };
    #[expect(clippy::cast_precision_loss, reason = "a few ticks")]
    let apart = apart as f64;
    libm::round(seconds.max(0.0) / step / apart) as usize
}

/// Time of a sample, s.
pub(super) fn time_of(run: &Recording, state: &AgentState) -> f64 {
    let step = if run.header.step_s > 0.0 { run.header.step_s } else { STEP_SECS };
    #[expect(clippy::cast_precision_loss, reason = "2^53 ticks are millions of years")]
    let tick = state.tick as f64;
    tick * step
}

/// The recording with an agent's states replaced; ticks stay. Events about the agent are dropped but for its own
/// leaves and gestures, which `own` may move or drop.
pub(super) fn with_states(
    run: &Recording,
    agent: AgentId,
    states: &[AgentState],
    own: impl Fn(f64) -> Option<f64>,
) -> Recording {
    let mut found = run.clone();
    let agents = found.header.agents.len().max(1);
    let Some(column) = found.header.agents.iter().position(|info| info.agent == agent) else { return found };
    for (slot, state) in found.frames.iter_mut().skip(column).step_by(agents).zip(states) {
        *slot = AgentState { tick: slot.tick, agent: slot.agent, ..*state };
    }
    found.events = run.events.iter().filter_map(|event| moved(event, agent, &own)).collect();
    found.events.sort_by_key(|event| event.time);
    found
}

fn moved(event: &Event, agent: AgentId, own: &impl Fn(f64) -> Option<f64>) -> Option<Event> {
    let (about, keeps) = match &event.kind {
        EventKind::Gesture { agent: who, .. } => (*who == agent, true),
        EventKind::Leaf { human, .. } | EventKind::StepEnded { human, .. } => (AgentId::Human(*human) == agent, true),
        EventKind::Sees { human, .. } | EventKind::Encounter { human, .. } => (AgentId::Human(*human) == agent, false),
        EventKind::Contact { a, b, .. } => (*a == agent || *b == agent, false),
        EventKind::WallContact { agent: who, .. }
        | EventKind::Node { agent: who, .. }
        | EventKind::Stuck { agent: who } => (*who == agent, false),
        EventKind::Door { .. } | EventKind::RobotArrived | EventKind::End { .. } => (false, true),
    };
    if !about {
        return Some(event.clone());
    }
    if !keeps {
        return None;
    }
    let t = own(event.time.secs())?.max(0.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a run, not negative")]
    let time = SimTime::from_nanos(libm::round(t * 1e9) as u64);
    Some(Event { time, kind: event.kind.clone() })
}

fn still(state: &AgentState) -> AgentState {
    AgentState { vx: 0.0, vy: 0.0, omega: 0.0, ..*state }
}

/// The recording without an agent.
pub(super) fn dropped(run: &Recording, agent: AgentId) -> Recording {
    let mut found = run.clone();
    found.header.agents.retain(|info| info.agent != agent);
    found.frames.retain(|state| state.agent != agent.number());
    found.events = run.events.iter().filter_map(|event| moved(event, agent, &|_| None)).collect();
    found
}

/// The agent does everything so much later (negative: sooner); it stands where it starts until then.
pub(super) fn delayed(run: &Recording, agent: AgentId, seconds: f64) -> Recording {
    let old = states(run, agent);
    let n = ticks_of(run, seconds.abs());
    let last = old.len().saturating_sub(1);
    let new: Vec<AgentState> = (0..old.len())
        .filter_map(|k| {
            let (from, held) =
                if seconds >= 0.0 { (k.saturating_sub(n), k < n) } else { ((k + n).min(last), k + n > last) };
            // Somebody who waits to set off makes no sign and does nothing by their tree.
            let waits = |state: &AgentState| AgentState { flags: state.flags & NO_GESTURE & NO_LEAF, ..still(state) };
            old.get(from).map(|state| match (held, seconds >= 0.0) {
                (true, true) => waits(state),
                (true, false) => still(state),
                (false, _) => *state,
            })
        })
        .collect();
    let end = old.last().map_or(0.0, |state| time_of(run, state));
    with_states(run, agent, &new, |t| Some(t + seconds).filter(|t| *t <= end))
}

/// The agent goes its way at half its pace, and so half of it.
pub(super) fn slowed(run: &Recording, agent: AgentId) -> Recording {
    let old = states(run, agent);
    let half = |(k, now): (usize, &AgentState)| {
        let state = old.get(k / 2).unwrap_or(now);
        AgentState { flags: now.flags, vx: 0.5 * state.vx, vy: 0.5 * state.vy, ..*state }
    };
    with_states(run, agent, &old.iter().enumerate().map(half).collect::<Vec<_>>(), Some)
}

/// The agent goes its way up to a sample so many samples sooner, and stands there until it is its time.
pub(super) fn ahead_of_time(run: &Recording, agent: AgentId, upto: usize, by: usize) -> Recording {
    let old = states(run, agent);
    let Some(stand) = old.get(upto).copied() else { return run.clone() };
    let new: Vec<AgentState> = (0..old.len())
        .filter_map(|k| {
            let stands = k + by > upto && k < upto;
            if stands { Some(still(&stand)) } else { old.get(if k < upto { k + by } else { k }).copied() }
        })
        .collect();
    let at = time_of(run, &stand);
    let sooner =
        old.get(by).map_or(0.0, |state| time_of(run, state)) - old.first().map_or(0.0, |state| time_of(run, state));
    with_states(run, agent, &new, |t| Some(if t < at { t - sooner } else { t }))
}

/// The agent stays where it starts, doing nothing.
pub(super) fn frozen(run: &Recording, agent: AgentId) -> Recording {
    let old = states(run, agent);
    let Some(first) = old.first() else { return run.clone() };
    let stays = AgentState { flags: first.flags & NO_GESTURE & NO_LEAF, ..still(first) };
    with_states(run, agent, &vec![stays; old.len()], |_| None)
}

/// The agent goes its way from its end to its start.
pub(super) fn reversed(run: &Recording, agent: AgentId) -> Recording {
    let old = states(run, agent);
    let new: Vec<AgentState> = old
        .iter()
        .rev()
        .zip(&old)
        .map(|(state, now)| AgentState {
            flags: now.flags,
            yaw: wrap_angle(state.yaw + std::f64::consts::PI),
            vx: -state.vx,
            vy: -state.vy,
            ..*state
        })
        .collect();
    with_states(run, agent, &new, Some)
}

/// The agent does the same somewhere else.
pub(super) fn shifted(run: &Recording, agent: AgentId, by: &Vector) -> Recording {
    let new: Vec<AgentState> =
        states(run, agent).iter().map(|state| AgentState { x: state.x + by.x, y: state.y + by.y, ..*state }).collect();
    with_states(run, agent, &new, Some)
}

/// When somebody stood for an act: the samples, and the times of the leaf.
pub(super) struct Stood {
    pub(super) samples: (usize, usize),
    pub(super) leaf_s: (f64, f64),
}

/// The agent does an act first, where it starts, for as long as it stood for it, and walks on where it stood.
pub(super) fn reacts_first(run: &Recording, agent: AgentId, stood: &Stood) -> Recording {
    let old = states(run, agent);
    let Some(start) = old.first().copied() else { return run.clone() };
    let (from, to) = stood.samples;
    let long = to.saturating_sub(from);
    let new: Vec<AgentState> = (0..old.len())
        .filter_map(|k| match k {
            k if k < long => old.get(from + k).map(|state| AgentState { flags: state.flags, ..still(&start) }),
            k if k < to => old.get(k - long).copied(),
            k => old.get(k).copied(),
        })
        .collect();
    let time = |k: usize| old.get(k).map_or(0.0, |state| time_of(run, state));
    let later_s = time(to) - time(from);
    // The leaf begins at once; what came before it comes after it, but for the leaf of the beginning, which is that after it.
    let (begins, ends) = stood.leaf_s;
    with_states(run, agent, &new, |t| match t {
        t if t < 1e-9 => None,
        t if t < begins - 1e-9 => Some(t + later_s),
        t if t < ends - 1e-9 => Some(t - begins),
        t if t < ends + 1e-9 => Some(later_s),
        t => Some(t),
    })
}

/// The agent makes a gesture from a sample on for as long as it made it, and never elsewhere.
pub(super) fn gestures_from(run: &Recording, agent: AgentId, gesture: Gesture, from: usize) -> Recording {
    let mut found = regestured(run, agent, gesture, None);
    let old = states(run, agent);
    let long = old.iter().filter(|state| state.gesture() == Some(gesture)).count();
    let whom = run.events.iter().find_map(|event| {
        if let EventKind::Gesture { agent: who, gesture: Some(made), to } = &event.kind
            && (*who, *made) == (agent, gesture)
        {
            *to
        } else {
            None
        }
    });
    let begins = old.get(from).map_or(0.0, |state| time_of(run, state));
    let column = found.frames.iter_mut().filter(|state| state.agent == agent.number());
    for state in column.skip(from).take(long) {
        state.flags = state.flags & NO_GESTURE | (u32::from(gesture.code()) << 8);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a run, not negative")]
    let time = SimTime::from_nanos(libm::round(begins.max(0.0) * 1e9) as u64);
    found.events.push(Event { time, kind: EventKind::Gesture { agent, gesture: Some(gesture), to: whom } });
    found.events.sort_by_key(|event| event.time);
    found
}

/// The agent makes another gesture wherever it made one.
pub(super) fn regestured(run: &Recording, agent: AgentId, from: Gesture, to: Option<Gesture>) -> Recording {
    let mut found = run.clone();
    for state in found.frames.iter_mut().filter(|state| state.agent == agent.number() && state.gesture() == Some(from))
    {
        state.flags = state.flags & NO_GESTURE | (u32::from(Gesture::code_of(to)) << 8);
    }
    for event in &mut found.events {
        if let EventKind::Gesture { agent: who, gesture, .. } = &mut event.kind
            && *who == agent
            && *gesture == Some(from)
        {
            *gesture = to;
        }
    }
    found
}

/// The agent goes with the robot, so much to its left and so much of time ahead, whatever it did.
pub(super) fn beside_robot(run: &Recording, agent: AgentId, left_m: f64, ahead_s: f64) -> Recording {
    beside(run, agent, AgentId::Robot, left_m, ahead_s)
}

/// The agent goes with another, so much to their left and so much of time ahead, whatever it did.
pub(super) fn beside(run: &Recording, agent: AgentId, leader: AgentId, left_m: f64, ahead_s: f64) -> Recording {
    let lead = states(run, leader);
    let old = states(run, agent);
    let n = ticks_of(run, ahead_s);
    // The line of a leader is that of the way behind it: one who stands may turn.
    let back = ticks_of(run, 1.0);
    let mut line = lead
        .first()
        .map_or_else(|| Vector2::new(1.0, 0.0), |state| Vector2::new(libm::cos(state.yaw), libm::sin(state.yaw)));
    let new: Vec<AgentState> = old
        .iter()
        .enumerate()
        .filter_map(|(k, now)| {
            let state = lead.get(k + n).or_else(|| lead.last())?;
            let way = state.point() - lead.get((k + n).saturating_sub(back)).unwrap_or(state).point();
            if way.norm() > 0.1 {
                line = way / way.norm();
            }
            let left = Vector2::new(-line.y, line.x) * left_m;
            Some(AgentState {
                flags: now.flags & NO_GESTURE & NO_LEAF,
                x: state.x + left.x,
                y: state.y + left.y,
                ..*state
            })
        })
        .collect();
    with_states(run, agent, &new, |_| None)
}

/// From a time on the agent walks straight away from a point at 0.8 m/s.
pub(super) fn walks_off(run: &Recording, agent: AgentId, from: &Point, since_s: f64) -> Recording {
    let old = states(run, agent);
    let start = ticks_of(run, since_s).min(old.len().saturating_sub(1));
    let Some(stand) = old.get(start).copied() else { return run.clone() };
    let line = stand.point() - from;
    let away = if line.norm() > 1e-6 { line / line.norm() } else { Vector2::new(1.0, 0.0) };
    let speed = 0.8;
    let new: Vec<AgentState> = old
        .iter()
        .enumerate()
        .map(|(k, state)| {
            if k <= start {
                return *state;
            }
            let way = speed * (time_of(run, state) - time_of(run, &stand)).min(6.0);
            let walks = time_of(run, state) - time_of(run, &stand) < 6.0;
            let pace = if walks { speed } else { 0.0 };
            AgentState {
                x: stand.x + away.x * way,
                y: stand.y + away.y * way,
                yaw: libm::atan2(away.y, away.x),
                vx: away.x * pace,
                vy: away.y * pace,
                ..*state
            }
        })
        .collect();
    with_states(run, agent, &new, |t| Some(t).filter(|t| *t <= since_s))
}

/// The agent stands at a place with a heading, all the time.
pub(super) fn stands_at(run: &Recording, agent: AgentId, at: &Point, yaw: f64) -> Recording {
    let new: Vec<AgentState> =
        states(run, agent).iter().map(|state| AgentState { x: at.x, y: at.y, yaw, ..still(state) }).collect();
    with_states(run, agent, &new, Some)
}

/// The agent stands from a time on; the log goes on as it was, or tells nothing from then on.
pub(super) fn stops_at(run: &Recording, agent: AgentId, from_s: f64, keeps_log: bool) -> Recording {
    let old = states(run, agent);
    let from = ticks_of(run, from_s).min(old.len().saturating_sub(1));
    let Some(stand) = old.get(from).map(still) else { return run.clone() };
    let stands = |(k, state): (usize, &AgentState)| match k {
        k if k < from => *state,
        _ if keeps_log => AgentState { flags: state.flags, ..stand },
        _ => AgentState { flags: state.flags & NO_GESTURE & NO_LEAF, ..stand },
    };
    let new: Vec<AgentState> = old.iter().enumerate().map(stands).collect();
    with_states(run, agent, &new, |t| Some(t).filter(|t| keeps_log || *t < from_s))
}

/// Slower than this nobody walks on, m/s.
const WALKS_MPS: f64 = 1.0;

/// The agent walks straight on from a time on, wherever that leads; the log goes on as it was.
pub(super) fn straight_on(run: &Recording, agent: AgentId, from_s: f64) -> Recording {
    let old = states(run, agent);
    let from = ticks_of(run, from_s).min(old.len().saturating_sub(1));
    let Some(begin) = old.get(from).copied() else { return run.clone() };
    let pace = begin.speed().max(WALKS_MPS);
    let line = if begin.speed() > 0.2 {
        Vector2::new(begin.vx, begin.vy) / begin.speed()
    } else {
        Vector2::new(libm::cos(begin.yaw), libm::sin(begin.yaw))
    };
    let walks = |(k, state): (usize, &AgentState)| {
        if k < from {
            return *state;
        }
        let way = pace * (time_of(run, state) - time_of(run, &begin));
        let (x, y) = (begin.x + line.x * way, begin.y + line.y * way);
        AgentState { x, y, vx: line.x * pace, vy: line.y * pace, yaw: libm::atan2(line.y, line.x), ..*state }
    };
    with_states(run, agent, &old.iter().enumerate().map(walks).collect::<Vec<_>>(), Some)
}

/// The agent walks straight to a place after so many seconds and stands there; the log goes on as it was.
pub(super) fn walks_to(run: &Recording, agent: AgentId, to: &Point, after_s: f64) -> Recording {
    let old = states(run, agent);
    let from = ticks_of(run, after_s).min(old.len().saturating_sub(1));
    let Some(begin) = old.get(from).copied() else { return run.clone() };
    let line = to - begin.point();
    let length = line.norm();
    let unit = if length > 1e-6 { line / length } else { Vector2::new(1.0, 0.0) };
    let walks = |(k, state): (usize, &AgentState)| {
        if k < from {
            return *state;
        }
        let way = WALKS_MPS * (time_of(run, state) - time_of(run, &begin));
        let pace = if way < length { WALKS_MPS } else { 0.0 };
        let at = begin.point() + unit * way.min(length);
        let yaw = libm::atan2(unit.y, unit.x);
        AgentState { x: at.x, y: at.y, vx: unit.x * pace, vy: unit.y * pace, yaw, ..*state }
    };
    with_states(run, agent, &old.iter().enumerate().map(walks).collect::<Vec<_>>(), Some)
}

/// Two agents with each other's track and log from a time on; what the run tells of their meetings is left out.
pub(super) fn swapped(run: &Recording, one: AgentId, other: AgentId, from_s: f64) -> Recording {
    let (mine, theirs) = (states(run, one), states(run, other));
    let from = ticks_of(run, from_s);
    let part = |before: &[AgentState], after: &[AgentState]| -> Vec<AgentState> {
        before.iter().take(from).chain(after.iter().skip(from)).copied().collect()
    };
    let told = |event: &Event| {
        let exchanged = |agent: AgentId| match agent {
            agent if agent == one => other,
            agent if agent == other => one,
            agent => agent,
        };
        let kind = match &event.kind {
            EventKind::Gesture { agent, gesture, to } => {
                EventKind::Gesture { agent: exchanged(*agent), gesture: *gesture, to: to.map(exchanged) }
            }
            EventKind::Leaf { human, leaf } => match exchanged(AgentId::Human(*human)) {
                AgentId::Human(human) => EventKind::Leaf { human, leaf: leaf.clone() },
                AgentId::Robot => return None,
            },
            EventKind::Sees { .. }
            | EventKind::StepEnded { .. }
            | EventKind::Encounter { .. }
            | EventKind::Contact { .. }
            | EventKind::WallContact { .. }
            | EventKind::Node { .. }
            | EventKind::Stuck { .. } => return None,
            EventKind::Door { .. } | EventKind::RobotArrived | EventKind::End { .. } => event.kind.clone(),
        };
        Some(if event.time.secs() < from_s { event.clone() } else { Event { time: event.time, kind } })
    };
    let events = run.events.iter().filter_map(told).collect();
    let found = with_states(run, one, &part(&mine, &theirs), Some);
    Recording { events, ..with_states(&found, other, &part(&theirs, &mine), Some) }
}

/// The agent is not there from a time on.
pub(super) fn gone_from(run: &Recording, agent: AgentId, from_s: f64) -> Recording {
    let mut found = run.clone();
    if found.header.absent().is_none() {
        found.header.leaves.push(ABSENT_LEAF.into());
    }
    let leaf = found.header.absent().unwrap_or_default();
    let from = ticks_of(run, from_s);
    for state in found.frames.iter_mut().filter(|state| state.agent == agent.number()).skip(from) {
        *state = AgentState { flags: AgentState::flags(agent, None, leaf), ..still(state) };
    }
    found
}

/// The agent is so many seconds farther on its way from one moment to the next, where it walks most; `None` where it stands.
pub(super) fn jumped(run: &Recording, agent: AgentId, seconds: f64) -> Option<Recording> {
    let old = states(run, agent);
    let n = ticks_of(run, seconds);
    let way = |k: usize| Some((old.get(k + n)?.point() - old.get(k)?.point()).norm());
    let most = (0..old.len().saturating_sub(n))
        .max_by(|a, b| way(*a).partial_cmp(&way(*b)).unwrap_or(std::cmp::Ordering::Equal))?;
    way(most).filter(|way| *way > 1.0)?;
    let last = old.len().saturating_sub(1);
    let new: Vec<AgentState> =
        (0..old.len()).filter_map(|k| old.get(if k < most { k } else { (k + n).min(last) }).copied()).collect();
    Some(with_states(run, agent, &new, Some))
}

/// The log tells of an agent's gesture, and no state shows it.
pub(super) fn silenced(run: &Recording, agent: AgentId, gesture: Gesture) -> Recording {
    let mut found = run.clone();
    let made = |state: &&mut AgentState| state.agent == agent.number() && state.gesture() == Some(gesture);
    for state in found.frames.iter_mut().filter(made) {
        state.flags &= NO_GESTURE;
    }
    found
}

/// The recording with one more human, who stands at a place; and who it is.
pub(super) fn joined(run: &Recording, at: &Point) -> (Recording, AgentId) {
    let number = humans(run).into_iter().map(|id| AgentId::Human(id).number()).max().unwrap_or_default() + 1;
    let agent = AgentId::Human(HumanId::new(number));
    let mut found = run.clone();
    let agents = run.header.agents.len().max(1);
    if let Some(like) = run.header.agents.last() {
        found.header.agents.push(AgentInfo { agent, ..like.clone() });
    }
    let stands = |frame: &[AgentState]| {
        let tick = frame.first().map_or(0, |state| state.tick);
        let zero = frame.first().copied();
        let flags = AgentState::flags(agent, None, 0);
        let state =
            zero.map(|state| AgentState { tick, agent: agent.number(), x: at.x, y: at.y, flags, ..still(&state) });
        frame.iter().copied().chain(state).collect::<Vec<_>>()
    };
    found.frames = run.frames.chunks(agents).flat_map(stands).collect();
    (found, agent)
}
