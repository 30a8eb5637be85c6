//! Whether an edit takes the thing away in the run at hand: by the geometry of that run, not by the judge of the clause.

use socrates_model::report::Standing;
use socrates_model::{Action, AgentId, AgentState, Clause, Point, Predicate, Relation, Trigger, Vector};
use socrates_scoring::Evidence;
use socrates_scoring::fidelity::standing_of;

use super::Edit;
use super::edits::{NODE_M, Scene, at_node, leader};
use super::robot;
use crate::mutants::edit::{humans, states, ticks_of, time_of};

/// Somebody who starts this much outside the reach of a place is not there, m.
const CLEAR_M: f64 = 0.3;
/// Where no encounter tells the place, somebody this far from the robot's way is never met, m.
const FAR_M: f64 = 6.0;
/// Somebody this far from the robot's way does not stand in it, m.
const IN_WAY_M: f64 = 1.2;
/// From so far off one heading is not another, rad (40°).
const OFF_RAD: f64 = 0.7;
/// Another human this far from where somebody is does not stand for them, m.
const OTHER_M: f64 = 4.0;
/// So long before and after the evidence it counts where others are, s.
const AROUND_SECS: f64 = 6.0;

/// Whether the clause tells on which side somebody stands: to stand there all the time is the thing itself.
fn stands_beside(scene: &Scene<'_>) -> bool {
    let Predicate::OnSide { human, .. } = scene.predicate else { return false };
    let proposal = scene.evidence.proposal.and_then(|proposal| proposal.human(*human));
    proposal.is_some_and(|human| human.relation == Relation::Static)
}

/// Whether the edit of the agents takes the thing away.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
pub(super) fn bites(scene: &Scene<'_>, edit: Edit, agents: &[AgentId]) -> bool {
    let Some(person) = agents.first().copied() else { return false };
    if robot::line(scene).is_some_and(|rule| !robot::bites(scene, rule, edit)) {
        return false;
    }
    if stands_beside(scene)
        && matches!(edit, Edit::StandsFromStart | Edit::OutOfTime | Edit::Backwards | Edit::LogStands)
    {
        return false;
    }
    match edit {
        Edit::StandsFromStart | Edit::OutOfTime => start_is_no_place(scene, agents),
        Edit::StandsFromEvidence => scene.from_s > 0.5,
        Edit::AfterRobot => {
            at_node(scene, person).is_some_and(|(_, came)| came > 0.5) && start_is_no_place(scene, agents)
        }
        Edit::Later => at_events(scene) && comes_to_it(scene, person),
        Edit::AtTheSameTime => at_events(scene) && comes_to_it(scene, person) && gap_s(scene) > 0.5,
        Edit::Sooner => comes_to_it(scene, person) && sooner_fits(scene),
        Edit::AlreadyDone => already_done(scene, person),
        Edit::Backwards => other_way_round(scene, person),
        Edit::TurnedAway => match scene.predicate {
            Predicate::Reacts { act, .. } => *act == Action::LookAtRobot,
            _ => true,
        },
        Edit::TowardsInstead => scene.act() == Some(Action::RunAway),
        Edit::LogStands => log_stands(scene, agents),
        Edit::LogWalks => log_walks(scene, person),
        Edit::SwappedPair => pair_differs(scene),
        Edit::DoorAtStart => outside_range(scene, 0.0),
        Edit::DoorAtEnd => outside_range(scene, scene.end_s()),
        Edit::LogAlone => agents.iter().any(|agent| matches!(agent, AgentId::Human(_) | AgentId::Robot)),
        // Beside a leader who turns back is behind it, too.
        Edit::BesideInstead => straight(scene, leader(scene)).is_some(),
        Edit::WalksOff => scene.from_s > 2.0,
        Edit::SwappedMidway => midway_apart(scene, person),
        Edit::TurnedAbout
        | Edit::Gone
        | Edit::GoneHalfway
        | Edit::FarAway
        | Edit::AheadInstead
        | Edit::Aside
        | Edit::SeenAhead
        | Edit::Swapped
        | Edit::WalksToRobot
        | Edit::DoorShut
        | Edit::OnRobotsWay
        | Edit::IntoRobot
        | Edit::StandsThere
        | Edit::SkipsAhead
        | Edit::HalfPace
        | Edit::SignSooner
        | Edit::SignLater
        | Edit::StandsSooner
        | Edit::SetsOffSooner => true,
    }
}

fn distance_m(a: &Point, b: &Point) -> f64 {
    (a - b).norm()
}

fn start(scene: &Scene<'_>, agent: AgentId) -> Option<Point> {
    scene.at(agent, 0.0).map(|state| state.point())
}

/// Least distance of a place from where the robot drives, m.
fn from_robots_way_m(scene: &Scene<'_>, at: &Point) -> f64 {
    let robot = states(scene.run(), AgentId::Robot);
    robot.iter().map(|state| distance_m(&state.point(), at)).fold(f64::INFINITY, f64::min)
}

fn starts_off_way(scene: &Scene<'_>, agent: AgentId, least_m: f64) -> bool {
    start(scene, agent).is_some_and(|at| from_robots_way_m(scene, &at) > least_m)
}

/// Whether an agent starts so far from its encounter that it is not met there.
fn starts_off_node(scene: &Scene<'_>, agent: AgentId, least_m: f64) -> bool {
    match (start(scene, agent), scene.node(agent)) {
        (Some(at), Some(node)) => distance_m(&at, &node) > least_m + CLEAR_M,
        (Some(at), None) => from_robots_way_m(scene, &at) > FAR_M,
        (None, _) => false,
    }
}

/// Whether what is asked of a human is done for a reason, so that to stand there all the time is not it.
fn for_a_reason(scene: &Scene<'_>, agent: AgentId, act: &Action) -> bool {
    let AgentId::Human(id) = agent else { return false };
    let Some(human) = scene.evidence.proposal.and_then(|proposal| proposal.human(id)) else { return false };
    let reason = |when: &[Trigger]| !when.iter().all(|trigger| *trigger == Trigger::Always);
    !human.relation.stands() && human.rules.iter().any(|rule| rule.act == *act && reason(&rule.when))
}

/// Whether to stand where one starts is not the thing.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn start_is_no_place(scene: &Scene<'_>, agents: &[AgentId]) -> bool {
    let every = |test: &dyn Fn(AgentId) -> bool| agents.iter().all(|agent| test(*agent));
    match scene.predicate {
        Predicate::Meets { .. }
        | Predicate::MeetsAgain { .. }
        | Predicate::OnTime { .. }
        | Predicate::Crosses { .. }
        | Predicate::Before { at_door: false, .. } => every(&|agent| starts_off_node(scene, agent, NODE_M)),
        Predicate::EncounterAt { .. } => every(&|agent| starts_off_node(scene, agent, NODE_M + 1.0)),
        Predicate::Converges { within_m, .. } => every(&|agent| starts_off_node(scene, agent, *within_m)),
        Predicate::Reaches { within_m, .. } => every(&|agent| off_named(scene, agent, 0.0, within_m + CLEAR_M)),
        Predicate::HiddenUntil { within_m, .. } => every(&|agent| starts_off_way(scene, agent, within_m + 1.0)),
        Predicate::Blocks { .. } => every(&|agent| starts_off_way(scene, agent, IN_WAY_M)),
        Predicate::StandsStill { .. } => every(&|agent| for_a_reason(scene, agent, &Action::StandStill)),
        Predicate::Reacts { act: Action::StandStill, .. } => {
            every(&|agent| for_a_reason(scene, agent, &Action::StandStill))
        }
        Predicate::Reacts { act: Action::Block, .. } => every(&|agent| starts_off_way(scene, agent, IN_WAY_M)),
        Predicate::Reacts { act: Action::Approach, .. } => every(&|agent| starts_off_way(scene, agent, 2.0)),
        Predicate::Density { per_m2: [low, _], radius_m, .. } => {
            few_near(scene, low * std::f64::consts::PI * radius_m * radius_m, radius_m + 1.0)
        }
        Predicate::Surrounds { count, within_m, .. } => few_near(scene, f64::from(*count), within_m + 1.0),
        Predicate::DoorOpens { .. } => outside_range_at_start(scene),
        Predicate::RobotJoins { .. } => way_m(scene, AgentId::Robot) >= 3.0,
        Predicate::RobotArrives => way_m(scene, AgentId::Robot) >= 1.0,
        _ => true,
    }
}

/// Whether fewer than so many start near the robot's way.
fn few_near(scene: &Scene<'_>, least: f64, near_m: f64) -> bool {
    let near = humans(scene.run()).into_iter().filter(|id| !starts_off_way(scene, AgentId::Human(*id), near_m)).count();
    u32::try_from(near).is_ok_and(|near| f64::from(near) < least)
}

fn way_m(scene: &Scene<'_>, agent: AgentId) -> f64 {
    let all = states(scene.run(), agent);
    all.first().zip(all.last()).map_or(0.0, |(a, b)| distance_m(&a.point(), &b.point()))
}

/// Whether an agent is farther than this from the node that the clause names, at a time.
fn off_named(scene: &Scene<'_>, agent: AgentId, t: f64, least_m: f64) -> bool {
    let (Predicate::Reaches { node, .. } | Predicate::StartsAt { node, .. }) = scene.predicate else { return false };
    let node = scene.evidence.location.and_then(|location| location.graph.node(node));
    node.zip(scene.at(agent, t)).is_some_and(|(node, state)| distance_m(&state.point(), &node.at) > least_m)
}

/// Whether the agent comes to the thing by a way of its own, so that a later start brings it there later.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn comes_to_it(scene: &Scene<'_>, person: AgentId) -> bool {
    match scene.predicate {
        Predicate::Before { at_door: true, .. } => true,
        Predicate::Order { .. } => at_events(scene) || starts_off_node(scene, person, NODE_M),
        Predicate::Converges { .. } => scene.seen.times_s.len() > 1,
        _ if person == AgentId::Robot => true,
        _ => starts_off_node(scene, person, NODE_M),
    }
}

/// Whether what comes first is an event, which comes by so much later as its human does.
fn at_events(scene: &Scene<'_>) -> bool {
    let Predicate::Order { first, .. } = scene.predicate else { return true };
    let all = scene.evidence.proposal.map_or(&[][..], |proposal| &proposal.expected_events);
    let first = all.iter().find(|clause| clause.id == *first).map(|clause| &clause.predicate);
    matches!(first, Some(Predicate::Gestures { .. } | Predicate::Leaves { .. } | Predicate::Enters { .. }))
}

/// Time between the two things that the clause puts in order, s.
fn gap_s(scene: &Scene<'_>) -> f64 {
    let times = &scene.seen.times_s;
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    last - times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn sooner_fits(scene: &Scene<'_>) -> bool {
    let (Predicate::Crosses { gap_s, .. } | Predicate::OnTime { gap_s, .. }) = scene.predicate else { return false };
    scene.seen.times_s.get(1).is_some_and(|robot| robot - 2.0 * gap_s - 1.0 > 0.5)
}

#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn already_done(scene: &Scene<'_>, person: AgentId) -> bool {
    match scene.predicate {
        Predicate::StartsAt { within_m, .. } => off_named(scene, person, 6.0, within_m + CLEAR_M),
        _ => scene.from_s + 1.0 < scene.end_s(),
    }
}

/// Whether the way from the end to the start differs in the thing.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn other_way_round(scene: &Scene<'_>, person: AgentId) -> bool {
    match scene.predicate {
        Predicate::HeadOn { .. } => straight_against(scene, person),
        // Along the robot's way somebody is on the same side of it whichever way they go.
        Predicate::OnSide { .. } => {
            matches!(scene.relation(person), Some(Relation::Crossing | Relation::Leaving))
        }
        Predicate::StartsAt { within_m, .. } => off_named(scene, person, scene.end_s(), within_m + CLEAR_M),
        Predicate::RobotArrives => way_m(scene, AgentId::Robot) >= 1.0,
        Predicate::WalksTogether { .. } => way_m(scene, person) >= 6.0,
        _ => true,
    }
}

/// Share of the way that a straight one has from end to end.
const STRAIGHT: f64 = 0.9;

/// The direction of an agent that goes straight.
fn straight(scene: &Scene<'_>, agent: AgentId) -> Option<Vector> {
    let all = states(scene.run(), agent);
    let way: f64 = all.iter().zip(all.iter().skip(1)).map(|(a, b)| (b.point() - a.point()).norm()).sum();
    let chord = all.last()?.point() - all.first()?.point();
    (chord.norm() > STRAIGHT * way && way > 1.0).then(|| chord / chord.norm())
}

/// Whether an agent and the robot go straight against each other.
fn straight_against(scene: &Scene<'_>, person: AgentId) -> bool {
    straight(scene, person).zip(straight(scene, AgentId::Robot)).is_some_and(|(a, b)| a.dot(&b) < -STRAIGHT)
}

/// Whether the log alone shows the act, when the agent stands where it should begin.
fn log_stands(scene: &Scene<'_>, agents: &[AgentId]) -> bool {
    match scene.act() {
        Some(Action::StandStill | Action::Block) => false,
        // Somebody who faces the robot already does not have to turn.
        Some(Action::LookAtRobot) => agents.first().is_some_and(|agent| faces_elsewhere(scene, *agent)),
        Some(Action::Approach) => agents.first().is_some_and(|agent| {
            scene
                .at(*agent, scene.act_s.unwrap_or(scene.from_s))
                .is_some_and(|state| from_robots_way_m(scene, &state.point()) > 2.0)
        }),
        Some(_) => scene.act_s.is_some(),
        None => start_is_no_place(scene, agents),
    }
}

/// Whether the log alone shows the act, when the agent walks on where it should begin.
fn log_walks(scene: &Scene<'_>, person: AgentId) -> bool {
    match scene.act() {
        Some(Action::StandStill | Action::LookAtRobot | Action::Block | Action::RunAway) => scene.act_s.is_some(),
        // Somebody who walks across the robot's line leaves it.
        Some(Action::GiveWay) => scene.act_s.is_some() && walks_on_line(scene, person),
        Some(_) => false,
        None if robot::line(scene).is_some() => true,
        None => matches!(scene.predicate, Predicate::RobotObeys { gesture, .. } if !gesture_goes(*gesture)),
    }
}

const fn gesture_goes(gesture: socrates_model::Gesture) -> bool {
    matches!(gesture, socrates_model::Gesture::Proceed | socrates_model::Gesture::FollowMe)
}

fn faces_elsewhere(scene: &Scene<'_>, agent: AgentId) -> bool {
    let from_s = scene.act_s.unwrap_or(scene.from_s);
    let Some(stand) = scene.at(agent, from_s) else { return false };
    let run = scene.run();
    let off = |robot: &AgentState| {
        let line = robot.point() - stand.point();
        socrates_model::geometry::wrap_angle(libm::atan2(line.y, line.x) - stand.yaw).abs() > OFF_RAD
    };
    let (from, count) = (ticks_of(run, from_s), ticks_of(run, 4.0));
    states(run, AgentId::Robot).iter().skip(from).take(count).all(off)
}

/// Whether an agent walks along the robot's line where its act begins.
fn walks_on_line(scene: &Scene<'_>, agent: AgentId) -> bool {
    let t = scene.act_s.unwrap_or(scene.from_s);
    let (Some(me), Some(robot)) = (scene.at(agent, t), scene.at(AgentId::Robot, t)) else { return false };
    let (course, facing) = (libm::atan2(me.vy, me.vx), robot.yaw);
    let off = socrates_model::geometry::wrap_angle(course - facing).abs();
    let left = (me.y - robot.y) * libm::cos(facing) - (me.x - robot.x) * libm::sin(facing);
    me.speed() > 0.2 && off > std::f64::consts::PI - 0.1 && left.abs() < 0.4
}

/// Whether two who are exchanged have the same place to come to, or the door of the same.
fn pair_differs(scene: &Scene<'_>) -> bool {
    let Predicate::Before { first, then, at_door } = scene.predicate else { return false };
    if [*first, *then].contains(&AgentId::Robot) {
        return false;
    }
    *at_door || scene.node(*first).zip(scene.node(*then)).is_some_and(|(a, b)| distance_m(&a, &b) < 1.0)
}

#[expect(clippy::wildcard_enum_match_arm, reason = "only doors are looked for")]
fn range(scene: &Scene<'_>) -> Option<([f64; 2], Point)> {
    let Predicate::DoorOpens { door, robot_m } = scene.predicate else { return None };
    let location = scene.evidence.location?;
    let named = if door.is_empty() {
        let opens = scene.run().events.iter().find_map(|event| match &event.kind {
            socrates_model::EventKind::Door { door, open: true } => Some(door.as_str()),
            _ => None,
        });
        location.door(opens?)?
    } else {
        location.door(door)?
    };
    Some((*robot_m, named.middle()))
}

fn outside_range(scene: &Scene<'_>, t: f64) -> bool {
    let Some(([low, high], door)) = range(scene) else { return false };
    let distance = scene.at(AgentId::Robot, t).map(|state| distance_m(&state.point(), &door));
    distance.is_some_and(|distance| distance < low - CLEAR_M || distance > high + CLEAR_M)
}

fn outside_range_at_start(scene: &Scene<'_>) -> bool {
    outside_range(scene, 0.0)
}

fn midway_apart(scene: &Scene<'_>, person: AgentId) -> bool {
    let other = humans(scene.run()).into_iter().map(AgentId::Human).find(|other| *other != person);
    let at = |agent: AgentId| scene.at(agent, 0.5 * scene.end_s()).map(|state| state.point());
    other.and_then(at).zip(at(person)).is_some_and(|(a, b)| distance_m(&a, &b) > 1.0)
}

/// Another human who does not do the thing: elsewhere while it happens where the clause tells of a place, else one of whom the
/// same is not true in this run.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
pub(super) fn stranger(scene: &Scene<'_>, person: AgentId) -> Option<AgentId> {
    let members = scene.predicate.group().map_or_else(Vec::new, |group| scene.members(group));
    let others = humans(scene.run())
        .into_iter()
        .map(AgentId::Human)
        .filter(|other| *other != person && !members.contains(other));
    let elsewhere = |other: &AgentId| !members.is_empty() && apart_all_the_time(scene, person, *other);
    let not_there = |other: &AgentId| match scene.predicate {
        Predicate::Meets { .. }
        | Predicate::MeetsAgain { .. }
        | Predicate::OnTime { .. }
        | Predicate::Crosses { .. } => scene.node(person).is_some_and(|node| off_place(scene, *other, &node)),
        Predicate::Reaches { within_m, .. } => never_near_named(scene, *other, within_m + CLEAR_M),
        Predicate::StartsAt { within_m, .. } => off_named(scene, *other, 0.0, within_m + CLEAR_M),
        _ => told_of(scene.predicate, *other).is_some_and(|told| !holds(scene.evidence, told)),
    };
    let mut others = others;
    if members.is_empty() { others.find(not_there) } else { others.find(elsewhere) }
}

fn apart_all_the_time(scene: &Scene<'_>, person: AgentId, other: AgentId) -> bool {
    let run = scene.run();
    let both = states(run, person).into_iter().zip(states(run, other));
    let mut before = both.take_while(|(mine, _)| time_of(run, mine) <= scene.from_s.max(2.0));
    before.all(|(mine, theirs)| distance_m(&mine.point(), &theirs.point()) > OTHER_M)
}

fn off_place(scene: &Scene<'_>, other: AgentId, place: &Point) -> bool {
    let run = scene.run();
    let last = scene.seen.times_s.iter().copied().fold(scene.from_s, f64::max);
    let around = |state: &&AgentState| (scene.from_s - AROUND_SECS..=last + AROUND_SECS).contains(&time_of(run, state));
    states(run, other).iter().filter(around).all(|state| distance_m(&state.point(), place) > OTHER_M)
}

fn never_near_named(scene: &Scene<'_>, other: AgentId, least_m: f64) -> bool {
    let Predicate::Reaches { node, .. } = scene.predicate else { return false };
    let node = scene.evidence.location.and_then(|location| location.graph.node(node));
    node.is_some_and(|node| {
        states(scene.run(), other).iter().all(|state| distance_m(&state.point(), &node.at) > least_m)
    })
}

/// Whether a predicate holds in the run as it is.
fn holds(evidence: &Evidence<'_>, predicate: Predicate) -> bool {
    let clause = Clause {
        id: "told of another".to_owned(),
        text: String::new(),
        role: socrates_model::ClauseRole::Setup,
        must: true,
        source: String::new(),
        predicate,
    };
    standing_of(evidence, &clause).is_ok_and(|found| matches!(found.standing, Standing::Holds | Standing::Late))
}

/// The same thing told of another human.
#[expect(clippy::wildcard_enum_match_arm, reason = "few are told apart here; the table has a row for each")]
fn told_of(predicate: &Predicate, other: AgentId) -> Option<Predicate> {
    let AgentId::Human(id) = other else { return None };
    let mut told = predicate.clone();
    match &mut told {
        Predicate::HeadOn { human }
        | Predicate::Ahead { human, .. }
        | Predicate::Overtakes { human }
        | Predicate::RobotPasses { human }
        | Predicate::Abreast { human, .. }
        | Predicate::Parallel { human, .. }
        | Predicate::Blocks { human, .. }
        | Predicate::Looks { human, .. }
        | Predicate::StandsStill { human, .. }
        | Predicate::RunsAway { human, .. }
        | Predicate::GivesWay { human }
        | Predicate::Walks { human, .. }
        | Predicate::GetsTo { human, .. }
        | Predicate::Reacts { human, .. }
        | Predicate::Leaves { human, .. }
        | Predicate::StaysInside { human, .. }
        | Predicate::Enters { human, .. }
        | Predicate::HiddenUntil { human, .. } => *human = id,
        Predicate::Follows { follower, leader, .. } if *leader != other => *follower = other,
        Predicate::Gestures { agent, .. } => *agent = other,
        _ => return None,
    }
    Some(told)
}
