//! The edits of the table, done to a run.

use socrates_model::geometry::wrap_angle;
use socrates_model::{
    Action, AgentId, AgentState, ClauseResult, EventKind, Gesture, GroupId, Point, Predicate, Recording, Relation,
    SimTime, Vector,
};
use socrates_scoring::Evidence;

use super::Edit;
use super::Whose;
use super::robot;
use crate::mutants::early::seen_ahead;
use crate::mutants::edit::{
    beside, delayed, dropped, frozen, gone_from, humans, joined, jumped, reversed, shifted, silenced, slowed,
    stands_at, states, stops_at, straight_on, swapped, ticks_of, time_of, walks_off, walks_to, with_states,
};

/// Far away is so far, m.
const FAR_M: f64 = 60.0;
/// A step aside that leaves the robot's line free, m.
const ASIDE_M: f64 = 2.0;
/// Late by this much more than the limit, s.
const MORE_SECS: f64 = 1.0;
/// A limit missed by less than this factor is late and not wrong.
const LATE_FACTOR: f64 = 2.0;
/// Two events this near in time are at the same time, s.
const SAME_SECS: f64 = 0.03;
/// What begins at a time has not begun so long before it, s.
const JUST_BEFORE_SECS: f64 = 0.3;
/// Somebody this near to an encounter node is met there, m.
pub(super) const NODE_M: f64 = 3.0;

/// A clause in a run in which it holds.
pub(super) struct Scene<'a> {
    pub(super) evidence: &'a Evidence<'a>,
    pub(super) predicate: &'a Predicate,
    pub(super) seen: &'a ClauseResult,
    /// When the evidence begins, s.
    pub(super) from_s: f64,
    /// When the act of the clause begins by the log, s.
    pub(super) act_s: Option<f64>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(evidence: &'a Evidence<'a>, predicate: &'a Predicate, seen: &'a ClauseResult) -> Self {
        let from_s = seen.times_s.iter().copied().fold(f64::INFINITY, f64::min);
        let from_s = if from_s.is_finite() { from_s } else { 0.0 };
        let mut scene = Self { evidence, predicate, seen, from_s, act_s: None };
        scene.act_s = scene.begins();
        scene
    }

    pub(super) fn run(&self) -> &'a Recording {
        self.evidence.recording
    }

    pub(super) fn end_s(&self) -> f64 {
        self.run().frames.last().map_or(0.0, |state| time_of(self.run(), state))
    }

    /// The act that the clause tells of.
    #[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
    pub(super) fn act(&self) -> Option<Action> {
        match self.predicate {
            Predicate::Blocks { .. } => Some(Action::Block),
            Predicate::Looks { .. } => Some(Action::LookAtRobot),
            Predicate::StandsStill { .. } => Some(Action::StandStill),
            Predicate::RunsAway { .. } => Some(Action::RunAway),
            Predicate::GivesWay { .. } => Some(Action::GiveWay),
            Predicate::MakesRoom { .. } => Some(Action::MakeRoom),
            Predicate::Reacts { act, .. } => Some(act.clone()),
            Predicate::Follows { leader: AgentId::Robot, .. } => Some(Action::FollowRobot),
            Predicate::Follows { leader: AgentId::Human(id), .. } => Some(Action::FollowHuman(*id)),
            _ => None,
        }
    }

    fn begins(&self) -> Option<f64> {
        let act = self.act()?;
        let Some(AgentId::Human(id)) = self.person() else { return None };
        let begins =
            |kind: &EventKind| matches!(kind, EventKind::Leaf { human, leaf } if *human == id && act.is_leaf(leaf));
        self.run().events.iter().find(|event| begins(&event.kind)).map(|event| event.time.secs())
    }

    /// The one whom the clause is about; the last human where it counts them.
    #[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
    pub(super) fn person(&self) -> Option<AgentId> {
        let last = || humans(self.run()).last().copied().map(AgentId::Human);
        match self.predicate {
            Predicate::Follows { follower, .. } => Some(*follower),
            Predicate::Gestures { agent, .. }
            | Predicate::Reaches { agent, .. }
            | Predicate::StartsAt { agent, .. } => Some(*agent),
            Predicate::Before { first, .. } => Some(*first),
            Predicate::RobotStep { .. } => robot::companion(self).or(Some(AgentId::Robot)),
            Predicate::Order { first, .. } => {
                let first = self.evidence.proposal?.expected_events.iter().find(|clause| clause.id == *first)?;
                Scene::new(self.evidence, &first.predicate, self.seen).person()
            }
            _ => self.predicate.human().map(AgentId::Human).or_else(last),
        }
    }

    pub(super) fn agents(&self, whose: Whose) -> Vec<AgentId> {
        let people = || humans(self.run()).into_iter().map(AgentId::Human);
        let members = || self.predicate.group().map_or_else(Vec::new, |group| self.members(group));
        match whose {
            Whose::Person => self.person().into_iter().collect(),
            Whose::Everybody => people().collect(),
            Whose::Members => members(),
            Whose::LastMember => members().pop().into_iter().collect(),
            Whose::Leavers => people().filter(|agent| self.relation(*agent) == Some(Relation::Leaving)).collect(),
            Whose::Robot => vec![AgentId::Robot],
        }
    }

    pub(super) fn members(&self, group: GroupId) -> Vec<AgentId> {
        let groups = self.evidence.proposal.map_or(&[][..], |proposal| &proposal.groups);
        let members = groups.iter().filter(|found| found.id == group).flat_map(|found| &found.members);
        members.map(|id| AgentId::Human(*id)).collect()
    }

    pub(super) fn relation(&self, agent: AgentId) -> Option<Relation> {
        let AgentId::Human(id) = agent else { return None };
        Some(self.evidence.proposal?.human(id)?.relation)
    }

    /// Where the agent meets the robot: of several encounters the one that the clause is about.
    pub(super) fn node(&self, agent: AgentId) -> Option<Point> {
        let AgentId::Human(id) = agent else { return None };
        let nth = if let Predicate::MeetsAgain { nth, .. } = self.predicate { *nth } else { 1 };
        let paths = self.evidence.paths?;
        let all = paths.encounters.iter().filter(|encounter| encounter.human == id);
        let node = all.clone().nth(usize::try_from(nth).ok()?.checked_sub(1)?)?.node.clone();
        Some(self.evidence.location?.graph.node(&node)?.at)
    }

    pub(super) fn at(&self, agent: AgentId, t: f64) -> Option<AgentState> {
        let all = states(self.run(), agent);
        let k = ticks_of(self.run(), t).min(all.len().saturating_sub(1));
        all.get(k).copied()
    }
}

/// A run changed for each of the agents in turn.
fn each(run: &Recording, agents: &[AgentId], change: impl Fn(&Recording, AgentId) -> Recording) -> Recording {
    agents.iter().fold(run.clone(), |run, agent| change(&run, *agent))
}

/// The run without the log of the robot's arrival, where the robot is changed.
fn without_arrival(mut run: Recording, agents: &[AgentId]) -> Recording {
    if agents.contains(&AgentId::Robot) {
        run.events.retain(|event| event.kind != EventKind::RobotArrived);
    }
    run
}

fn named(agents: &[AgentId]) -> String {
    agents.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The run after an edit of the agents, and who was changed; `None` where the run has nobody for it.
pub(super) fn edited(scene: &Scene<'_>, edit: Edit, agents: &[AgentId]) -> Option<(String, Recording)> {
    let run = scene.run();
    let person = *agents.first()?;
    let begins_s = scene.act_s.unwrap_or(scene.from_s);
    let far = Vector::new(FAR_M, FAR_M);
    let changed = match edit {
        Edit::StandsFromStart => each(run, agents, frozen),
        Edit::StandsThere => {
            let there = scene.at(person, scene.from_s)?;
            stands_at(run, person, &there.point(), there.yaw)
        }
        Edit::StandsFromEvidence => {
            let from_s = (begins_s.min(scene.from_s) - JUST_BEFORE_SECS).max(0.0);
            each(run, agents, |run, agent| stops_at(run, agent, from_s, false))
        }
        Edit::Gone => each(run, agents, dropped),
        Edit::GoneHalfway => each(run, agents, |run, agent| gone_from(run, agent, 0.5 * scene.end_s())),
        Edit::FarAway => each(run, agents, |run, agent| shifted(run, agent, &far)),
        Edit::Backwards => each(run, agents, reversed),
        Edit::TurnedAbout => each(run, agents, turned_about),
        Edit::TurnedAway => each(run, agents, turned_away),
        Edit::TowardsInstead => each(run, agents, |run, agent| towards(run, agent, begins_s)),
        Edit::AheadInstead => beside(run, person, leader(scene), 0.0, 2.5),
        Edit::BesideInstead => beside(run, person, leader(scene), 1.0, 0.0),
        Edit::Aside => shifted(run, person, &aside(scene, person)?),
        Edit::OutOfTime => each(run, agents, |run, agent| {
            let begins_s = begins_s.min(scene.from_s).min(sets_off_s(run, agent));
            delayed(run, agent, scene.end_s() - begins_s + 0.5)
        }),
        Edit::AfterRobot | Edit::Later | Edit::Sooner | Edit::AtTheSameTime | Edit::AlreadyDone => {
            delayed(run, person, shift_s(scene, edit, person)?)
        }
        Edit::SeenAhead => return before_sight(scene, person),
        Edit::Swapped => {
            if let Some(other) = super::bites::stranger(scene, person) {
                return Some((format!("{person} with {other}"), swapped(run, person, other, 0.0)));
            }
            // Where there is nobody else who does otherwise, somebody comes who stands far away.
            let (with_other, other) = joined(run, &(scene.at(person, 0.0)?.point() + far));
            return Some((format!("{person} with somebody far away"), swapped(&with_other, person, other, 0.0)));
        }
        Edit::SwappedPair => {
            let Predicate::Before { first, then, .. } = scene.predicate else { return None };
            swapped(run, *first, *then, 0.0)
        }
        Edit::SwappedMidway => {
            let other = humans(run).into_iter().map(AgentId::Human).find(|other| *other != person)?;
            swapped(run, person, other, 0.5 * scene.end_s())
        }
        Edit::LogStands => each(run, agents, |run, agent| stops_at(run, agent, scene.act_s.unwrap_or(0.0), true)),
        Edit::LogWalks => {
            let from_s = (scene.from_s - JUST_BEFORE_SECS).max(0.0).min(begins_s);
            each(run, agents, |run, agent| straight_on(run, agent, from_s))
        }
        Edit::LogAlone => {
            let gesture = gesture(scene)?;
            each(run, agents, |run, agent| silenced(run, agent, gesture))
        }
        Edit::WalksToRobot => walks_to(run, person, &end_of_robot(scene, person)?, 1.0),
        Edit::WalksOff => {
            let center = middle(run, agents)?;
            each(run, agents, |run, agent| walks_off(run, agent, &center, 0.5 * scene.from_s))
        }
        Edit::DoorShut => doors(run, None),
        Edit::DoorAtStart => doors(run, Some(0.05)),
        Edit::DoorAtEnd => doors(run, Some(scene.end_s())),
        Edit::OnRobotsWay => {
            let at = halfway_of_robot(run)?;
            stands_at(run, person, &at, 0.0)
        }
        Edit::IntoRobot => beside(run, person, AgentId::Robot, 0.0, 0.1),
        Edit::HalfPace => slowed(run, person),
        Edit::SkipsAhead => jumped(run, person, 3.0)?,
        Edit::SignSooner | Edit::SignLater | Edit::StandsSooner | Edit::SetsOffSooner => robot::edited(scene, edit)?,
    };
    let keeps_log = matches!(edit, Edit::LogStands | Edit::LogWalks);
    let changed = if keeps_log { changed } else { without_arrival(changed, agents) };
    Some((named(agents), changed))
}

/// Nobody has set off who is no farther than this from where they start, m.
const SET_OFF_M: f64 = 0.1;

/// When an agent sets off, s; infinite where it never does.
fn sets_off_s(run: &Recording, agent: AgentId) -> f64 {
    let all = states(run, agent);
    let Some(start) = all.first().map(AgentState::point) else { return f64::INFINITY };
    let off = all.iter().find(|state| (state.point() - start).norm() > SET_OFF_M);
    off.map_or(f64::INFINITY, |state| time_of(run, state))
}

/// By how much an agent comes later, s; negative: sooner.
fn shift_s(scene: &Scene<'_>, edit: Edit, person: AgentId) -> Option<f64> {
    let times = &scene.seen.times_s;
    match (edit, scene.predicate) {
        (Edit::AfterRobot, _) => {
            let (left, came) = at_node(scene, person)?;
            Some(left - came + MORE_SECS)
        }
        (Edit::AlreadyDone, Predicate::StartsAt { .. }) => Some(-6.0),
        (Edit::AlreadyDone, _) => Some(-(scene.from_s + 0.5)),
        (Edit::Later, Predicate::Crosses { gap_s, .. } | Predicate::OnTime { gap_s, .. }) => {
            Some(LATE_FACTOR * gap_s + MORE_SECS - (times.get(2)? - times.get(1)?))
        }
        (Edit::Sooner, Predicate::Crosses { gap_s, .. } | Predicate::OnTime { gap_s, .. }) => {
            Some(-(LATE_FACTOR * gap_s + MORE_SECS + (times.get(2)? - times.get(1)?)))
        }
        (Edit::Later, Predicate::Converges { within_s, .. }) => {
            Some(LATE_FACTOR * within_s + MORE_SECS + (times.first()? - times.get(1)?).abs())
        }
        (Edit::Later, Predicate::Before { .. }) => Some(times.get(2)? - times.get(1)? + MORE_SECS),
        (Edit::AtTheSameTime, Predicate::Before { .. }) => Some(times.get(2)? - times.get(1)? - SAME_SECS),
        (Edit::Later, Predicate::Order { .. }) => Some(times.first()? - times.get(1)? + MORE_SECS),
        (Edit::AtTheSameTime, Predicate::Order { .. }) => Some(times.first()? - times.get(1)? - SAME_SECS),
        _ => None,
    }
}

/// When the robot has last been near the node of an agent, and when the agent comes near it for what was seen, s.
pub(super) fn at_node(scene: &Scene<'_>, person: AgentId) -> Option<(f64, f64)> {
    let (run, node) = (scene.run(), scene.node(person)?);
    let near = |state: &AgentState| (state.point() - node).norm() <= NODE_M + 0.2;
    let left = states(run, AgentId::Robot).iter().rfind(|state| near(state)).map(|state| time_of(run, state))?;
    let mine = states(run, person);
    let seen = ticks_of(run, scene.from_s).min(mine.len().saturating_sub(1));
    let came = mine.get(..=seen)?.iter().rev().take_while(|state| near(state)).last()?;
    Some((left, time_of(run, came)))
}

pub(super) fn leader(scene: &Scene<'_>) -> AgentId {
    if let Predicate::Follows { leader, .. } = scene.predicate { *leader } else { AgentId::Robot }
}

#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn gesture(scene: &Scene<'_>) -> Option<Gesture> {
    match scene.predicate {
        Predicate::Gestures { gesture, .. } | Predicate::RobotObeys { gesture, .. } => Some(*gesture),
        _ => robot::sign(scene),
    }
}

fn turned_about(run: &Recording, agent: AgentId) -> Recording {
    let turned = |state: &AgentState| AgentState { yaw: wrap_angle(state.yaw + std::f64::consts::PI), ..*state };
    with_states(run, agent, &states(run, agent).iter().map(turned).collect::<Vec<_>>(), Some)
}

/// The agent has its back to the robot all the time.
fn turned_away(run: &Recording, agent: AgentId) -> Recording {
    let old = states(run, agent);
    let away = |(state, robot): (&AgentState, &AgentState)| {
        let line = state.point() - robot.point();
        AgentState { yaw: libm::atan2(line.y, line.x), ..*state }
    };
    let robot = states(run, AgentId::Robot);
    with_states(run, agent, &old.iter().zip(&robot).map(away).collect::<Vec<_>>(), Some)
}

/// From a time on as far the opposite way.
fn towards(run: &Recording, agent: AgentId, from_s: f64) -> Recording {
    let old = states(run, agent);
    let from = ticks_of(run, from_s);
    let Some(pivot) = old.get(from).map(AgentState::point) else { return run.clone() };
    let opposite = |(k, state): (usize, &AgentState)| {
        if k <= from {
            return *state;
        }
        let at = pivot - (state.point() - pivot);
        let yaw = wrap_angle(state.yaw + std::f64::consts::PI);
        AgentState { x: at.x, y: at.y, vx: -state.vx, vy: -state.vy, yaw, ..*state }
    };
    with_states(run, agent, &old.iter().enumerate().map(opposite).collect::<Vec<_>>(), Some)
}

/// To the side, where the robot stays farthest off.
fn aside(scene: &Scene<'_>, person: AgentId) -> Option<Vector> {
    let me = scene.at(person, scene.from_s)?.point();
    let robot = states(scene.run(), AgentId::Robot);
    let off = |by: &Vector| robot.iter().map(|state| (me + by - state.point()).norm()).fold(f64::INFINITY, f64::min);
    let step = std::f64::consts::FRAC_PI_4;
    let all = (0..8).map(|k| f64::from(k) * step).map(|yaw| Vector::new(libm::cos(yaw), libm::sin(yaw)) * ASIDE_M);
    all.max_by(|a, b| off(a).total_cmp(&off(b)))
}

fn before_sight(scene: &Scene<'_>, person: AgentId) -> Option<(String, Recording)> {
    let AgentId::Human(id) = person else { return None };
    let mut found = None;
    seen_ahead(scene.evidence, id, &mut |_, about, recording| found = Some((about, recording)));
    found
}

/// The end of the robot's way that is farther from where somebody starts.
fn end_of_robot(scene: &Scene<'_>, person: AgentId) -> Option<Point> {
    let start = scene.at(person, 0.0)?.point();
    let robot = states(scene.run(), AgentId::Robot);
    let off = |at: &Point| (at - start).norm();
    [robot.first()?.point(), robot.last()?.point()].into_iter().max_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Where the robot has driven half of its way.
fn halfway_of_robot(run: &Recording) -> Option<Point> {
    let robot = states(run, AgentId::Robot);
    let (first, last) = (robot.first()?.point(), robot.last()?.point());
    let middle = |state: &&AgentState| (state.point() - first).norm() >= 0.5 * (last - first).norm();
    robot.iter().find(middle).map(AgentState::point)
}

fn middle(run: &Recording, agents: &[AgentId]) -> Option<Point> {
    let at: Vec<Point> = agents.iter().filter_map(|agent| run.track(*agent).next()).map(AgentState::point).collect();
    let first = at.first()?;
    #[expect(clippy::cast_precision_loss, reason = "a group has few members")]
    let count = at.len() as f64;
    Some(first + at.iter().map(|point| point - first).sum::<Vector>() / count)
}

/// The doors' opening at another time, or never.
#[expect(clippy::wildcard_enum_match_arm, reason = "only doors are told otherwise")]
fn doors(run: &Recording, opens_s: Option<f64>) -> Recording {
    let mut found = run.clone();
    found.events.retain(|event| opens_s.is_some() || !matches!(event.kind, EventKind::Door { .. }));
    // The first change of a door is its opening; later ones would tell of another.
    let mut told = std::collections::BTreeSet::new();
    found.events.retain(|event| match &event.kind {
        EventKind::Door { door, open } => *open && told.insert(door.clone()),
        _ => true,
    });
    for event in &mut found.events {
        if let (EventKind::Door { .. }, Some(t)) = (&event.kind, opens_s) {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "seconds of a run, not negative"
            )]
            let nanos = libm::round(t * 1e9) as u64;
            event.time = SimTime::from_nanos(nanos);
        }
    }
    found.events.sort_by_key(|event| event.time);
    found
}
