//! Changes after which the recording no longer shows what was asked.

use socrates_model::nalgebra::Vector2;
use socrates_model::rule::RobotDo;
use socrates_model::{
    AgentId, AgentState, Clause, ClauseRole, EventKind, Gesture, GroupProposal, HumanId, Point, Predicate, Recording,
    Relation,
};
use socrates_scoring::Evidence;

use super::Mutant;
use super::edit::{
    beside_robot, delayed, dropped, frozen, humans, regestured, reversed, shifted, stands_at, states, time_of,
    walks_off,
};

/// Somebody whose start and end are nearer to each other than this goes no way that could be reversed, m.
const WAY_M: f64 = 4.0;

/// Who comes out of a room meets the robot after at least so much way, m.
const OUT_M: f64 = 1.5;

/// Every change that contradicts something the scenario asks for. Needs the proposal and the paths.
#[must_use]
pub fn spoiled(evidence: &Evidence<'_>) -> Vec<Mutant> {
    let Some(proposal) = evidence.proposal else { return Vec::new() };
    let run = evidence.recording;
    let mut found = Vec::new();
    let mut add = |kind: &'static str, about: String, recording: Recording| {
        found.push(Mutant { kind, about, recording });
    };
    for id in humans(run) {
        let agent = AgentId::Human(id);
        add("a person is missing", id.to_string(), dropped(run, agent));
        if walks_before_meeting(evidence, id, WAY_M) {
            // Who comes too soon would be better for a later start: then it starts sooner still.
            let shift = if gap_s(evidence, id).is_some_and(|gap| gap < -0.5) { -5.0 } else { 5.0 };
            add("start shifted by 5 s", format!("{id} {shift:+.0} s"), delayed(run, agent, shift));
        }
        if way_m(run, agent) >= WAY_M {
            add("path reversed", id.to_string(), reversed(run, agent));
        }
        for gesture in asked_gestures(evidence, id) {
            let other = if gesture == Gesture::Wait { Gesture::Proceed } else { Gesture::Wait };
            add(
                "another gesture",
                format!("{id}: {other} for {gesture}"),
                regestured(run, agent, gesture, Some(other)),
            );
            add("no gesture", format!("{id}: {gesture}"), regestured(run, agent, gesture, None));
        }
    }
    for group in &proposal.groups {
        broken(run, group, &mut add);
        if group.standing {
            standing(evidence, group, &mut add);
        }
    }
    case_lists(evidence, &mut add);
    super::early::early(evidence, &mut add);
    super::sides::sides(evidence, &mut add);
    super::facing::facing(evidence, &mut add);
    super::named_way::named_way(evidence, &mut add);
    super::steps::steps(evidence, &mut add);
    let mut seen = std::collections::BTreeSet::new();
    found.retain(|mutant| seen.insert((mutant.kind, mutant.about.clone())));
    found
}

type Add<'a> = dyn FnMut(&'static str, String, Recording) + 'a;

fn musts<'a>(evidence: &Evidence<'a>) -> impl Iterator<Item = &'a Clause> {
    evidence
        .proposal
        .into_iter()
        .flat_map(|proposal| &proposal.expected_events)
        .filter(|clause| clause.must && clause.role == ClauseRole::Setup)
}

/// Distance from where the agent starts to where it ends, m.
fn way_m(run: &Recording, agent: AgentId) -> f64 {
    let all = states(run, agent);
    match (all.first(), all.last()) {
        (Some(a), Some(b)) => (b.point() - a.point()).norm(),
        _ => 0.0,
    }
}

/// Time and distance at which the robot is nearest.
fn nearest(run: &Recording, agent: AgentId) -> Option<(f64, f64, usize)> {
    let robot = states(run, AgentId::Robot);
    states(run, agent)
        .iter()
        .zip(&robot)
        .enumerate()
        .map(|(k, (a, b))| ((a.point() - b.point()).norm(), time_of(run, a), k))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(distance, t, k)| (t, distance, k))
}

/// Whether it comes to the meeting by its own way of some length: else a late start changes nothing.
fn walks_before_meeting(evidence: &Evidence<'_>, id: HumanId, way_m: f64) -> bool {
    let run = evidence.recording;
    let all = states(run, AgentId::Human(id));
    let (Some(first), Some((_, _, k))) = (all.first(), nearest(run, AgentId::Human(id))) else { return false };
    all.get(k).is_some_and(|state| (state.point() - first.point()).norm() >= way_m)
}

/// How much later than the robot the human is at its encounter, s.
fn gap_s(evidence: &Evidence<'_>, id: HumanId) -> Option<f64> {
    let node = evidence.paths?.encounter_of(id)?;
    let at = evidence.location?.graph.node(node)?.at;
    let arrival = |agent: AgentId| {
        let all = states(evidence.recording, agent);
        let there = all.iter().find(|state| (state.point() - at).norm() <= 1.5);
        there
            .or_else(|| all.iter().min_by(|a, b| (a.point() - at).norm().total_cmp(&(b.point() - at).norm())))
            .map(|state| time_of(evidence.recording, state))
    };
    Some(arrival(AgentId::Human(id))? - arrival(AgentId::Robot)?)
}

/// The delay after which the human comes 8 s after the robot, s.
fn until_8_s_late(evidence: &Evidence<'_>, id: HumanId) -> f64 {
    (8.0 - gap_s(evidence, id).unwrap_or(0.0)).max(5.0)
}

/// Gestures that a deciding clause asks of the human and that it makes.
fn asked_gestures(evidence: &Evidence<'_>, id: HumanId) -> Vec<Gesture> {
    let mut found: Vec<Gesture> = musts(evidence)
        .filter_map(|clause| {
            if let Predicate::Gestures { agent: AgentId::Human(who), gesture } = clause.predicate {
                (who == id).then_some(gesture)
            } else {
                None
            }
        })
        .collect();
    found.sort_by_key(|gesture| gesture.code());
    found.dedup();
    found
}

fn middle(points: &[Point]) -> Option<Point> {
    let first = points.first()?;
    #[expect(clippy::cast_precision_loss, reason = "a group has few members")]
    let count = points.len() as f64;
    Some(first + points.iter().map(|point| point - first).sum::<socrates_model::Vector>() / count)
}

fn starts(run: &Recording, group: &GroupProposal) -> Vec<Point> {
    group.members.iter().filter_map(|id| run.track(AgentId::Human(*id)).next()).map(|s| s.point()).collect()
}

/// One member is 4 m away from the others.
fn broken(run: &Recording, group: &GroupProposal, add: &mut Add<'_>) {
    let (Some(last), Some(center)) = (group.members.last(), middle(&starts(run, group))) else { return };
    let Some(at) = run.track(AgentId::Human(*last)).next().map(|state| state.point()) else { return };
    let line = at - center;
    let away = if line.norm() > 1e-6 { line / line.norm() } else { Vector2::new(1.0, 0.0) };
    add("group broken", format!("{last} 4 m off"), shifted(run, AgentId::Human(*last), &(away * 4.0)));
}

/// What the list N of the group says of groups that stand.
fn standing(evidence: &Evidence<'_>, group: &GroupProposal, add: &mut Add<'_>) {
    let run = evidence.recording;
    let places = starts(run, group);
    let Some(center) = middle(&places) else { return };
    let mut lined = run.clone();
    let mut apart = run.clone();
    let robot_line = robot_line(run, &center);
    for (index, id) in (0_u32..).zip(&group.members) {
        let agent = AgentId::Human(*id);
        let along = Vector2::new(-robot_line.y, robot_line.x);
        let at = center + along * (0.7 * f64::from(index));
        // One looks this way, the next the other: back to back.
        let yaw = libm::atan2(along.y, along.x) + if index % 2 == 0 { std::f64::consts::PI } else { 0.0 };
        lined = stands_at(&lined, agent, &at, yaw);
        apart = shifted(&apart, agent, &(Vector2::new(-robot_line.y, robot_line.x) * 5.0));
    }
    add("N: a line back to back", group.id.to_string(), lined);
    add("N: 5 m from the way", group.id.to_string(), apart);
    let arrival = group
        .members
        .iter()
        .filter_map(|id| {
            let robot = states(run, AgentId::Robot);
            states(run, AgentId::Human(*id))
                .iter()
                .zip(&robot)
                .find(|(a, b)| (a.point() - b.point()).norm() <= 3.0)
                .map(|(a, _)| time_of(run, a))
        })
        .min_by(f64::total_cmp);
    if let Some(arrival) = arrival.filter(|t| *t > 3.0) {
        let mut gone = run.clone();
        for id in &group.members {
            gone = walks_off(&gone, AgentId::Human(*id), &center, (arrival - 5.0).max(1.0));
        }
        add("N: dissolves before the robot comes", group.id.to_string(), gone);
    }
}

/// Direction of the robot where it is nearest to a point.
fn robot_line(run: &Recording, point: &Point) -> socrates_model::Vector {
    let robot = states(run, AgentId::Robot);
    let near = robot
        .iter()
        .filter(|state| state.speed() > 0.1)
        .min_by(|a, b| (a.point() - point).norm().total_cmp(&(b.point() - point).norm()));
    near.map_or_else(|| Vector2::new(1.0, 0.0), |state| Vector2::new(libm::cos(state.yaw), libm::sin(state.yaw)))
}

/// The rest of the lists N, wherever a clause makes them fit.
fn case_lists(evidence: &Evidence<'_>, add: &mut Add<'_>) {
    let run = evidence.recording;
    let Some(proposal) = evidence.proposal else { return };
    let leavers: Vec<HumanId> = musts(evidence)
        .filter_map(|clause| if let Predicate::Leaves { human, .. } = clause.predicate { Some(human) } else { None })
        .collect();
    let every = |change: &dyn Fn(&Recording, AgentId) -> Recording, who: &[HumanId]| {
        who.iter().fold(run.clone(), |run, id| change(&run, AgentId::Human(*id)))
    };
    let opens = run.events.iter().any(|event| matches!(event.kind, EventKind::Door { open: true, .. }));
    if !leavers.is_empty() && opens {
        add("N: leavers 15 s late", "all".to_owned(), every(&|run, who| delayed(run, who, 15.0), &leavers));
    }
    if leavers.len() > 1
        && let Some(one) = leavers.last()
    {
        add("N: one leaver fewer", one.to_string(), frozen(run, AgentId::Human(*one)));
    }
    for clause in musts(evidence) {
        if let Predicate::Follows { follower: AgentId::Human(who), leader: AgentId::Robot, .. } = clause.predicate {
            let agent = AgentId::Human(who);
            add("N: follower ahead", who.to_string(), beside_robot(run, agent, 0.9, 2.5));
            add("N: follower beside", who.to_string(), beside_robot(run, agent, 1.0, 0.0));
            add("N: gap over 5 m", who.to_string(), delayed(run, agent, 10.0));
        }
        if let Predicate::Blocks { human, .. } = clause.predicate {
            let agent = AgentId::Human(human);
            let place = nearest(run, agent).and_then(|(.., k)| states(run, agent).get(k).map(AgentState::point));
            if let Some(place) = place {
                let line = robot_line(run, &place);
                let aside = Vector2::new(-line.y, line.x) * 1.0;
                add("N: beside the way all the time", human.to_string(), shifted(run, agent, &aside));
            }
        }
        if let Predicate::HiddenUntil { human, .. } = clause.predicate
            && walks_before_meeting(evidence, human, OUT_M)
        {
            let agent = AgentId::Human(human);
            add("N: 8 s late", human.to_string(), delayed(run, agent, until_8_s_late(evidence, human)));
            add("N: already outside at the start", human.to_string(), delayed(run, agent, -8.0));
            add("N: walks along with the robot", human.to_string(), beside_robot(run, agent, 1.0, 1.5));
        }
    }
    let waits = proposal.robot.script.iter().any(|rule| rule.act == RobotDo::WaitForLeavers);
    let comes = |relation: Relation| relation == Relation::Crossing || relation == Relation::Leaving && !waits;
    for human in proposal.humans.iter().filter(|human| comes(human.relation)) {
        let agent = AgentId::Human(human.id);
        if humans(run).contains(&human.id) && walks_before_meeting(evidence, human.id, OUT_M) {
            let late = until_8_s_late(evidence, human.id);
            add("N: 8 s late", human.id.to_string(), delayed(run, agent, late));
            if human.relation == Relation::Leaving {
                add("N: already outside at the start", human.id.to_string(), delayed(run, agent, -8.0));
            }
            add("N: walks along with the robot", human.id.to_string(), beside_robot(run, agent, 1.0, 1.5));
        }
    }
}
