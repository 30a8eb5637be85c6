//! People of a scenario as agents of HuNavSim.

use std::collections::BTreeMap;

use socrates_hunav::agents::MAX_AGENTS;
use socrates_hunav::{AgentEntry, AgentsFile, BehaviorEntry, Dialect, GoalEntry, InitPose, Reaction};
use socrates_model::{AgentId, AgentState, HumanProposal, Point};

use super::super::Scenario;
use super::super::content::Content;
use super::super::frames::{angle, plain_name, real, small_ids};
use super::Kit;
use super::trees::Trees;
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// Radius of people where no run tells it, m.
const RADIUS_M: f64 = 0.3;
/// Pace of people where no run tells it, m/s.
const PACE_MPS: f64 = 1.2;
/// Range of a pace that HuNavSim keeps, m/s.
const PACES_MPS: std::ops::RangeInclusive<f64> = 0.2..=1.8;
/// Within this distance a goal is reached, m.
const GOAL_M: f64 = 0.3;
/// Within this distance of the node of an encounter somebody is there, m.
const THERE_M: f64 = 1.5;
/// Around the node of an encounter robot and person meet within this distance of it, m.
const AROUND_M: f64 = 3.0;
/// Looks of people.
const SKINS: i64 = 5;

/// The agents file of everybody.
pub(super) fn agents(
    scenario: &Scenario,
    kit: &Kit,
    base: &str,
    trees: &Trees,
    losses: &mut Losses,
) -> Result<AgentsFile, Unusable> {
    let humans = &scenario.proposal.humans;
    if humans.is_empty() || humans.len() > MAX_AGENTS {
        let problem = format!("{} people; an agents file has 1 to {MAX_AGENTS}", humans.len());
        return Err(Unusable::new("proposal.json humans", problem, "choose a format of tracks, such as `jupedsim`"));
    }
    small_ids(humans.iter().map(|human| human.id.into()))?;
    let map = plain_name(&scenario.location.name);
    if map != scenario.location.name {
        let at = format!("location `{}`", scenario.location.name);
        losses.note(
            "spelling of names",
            at,
            &format!("names of maps have letters, digits and `_`: it is written as `{map}`"),
        );
    }
    let is_v2 = kit.dialect == Dialect::V2_0;
    let mut file = AgentsFile {
        dialect: kit.dialect,
        map,
        publish_people: true,
        yaml_base_name: is_v2.then(|| base.to_owned()),
        simulator: is_v2.then(|| "Gazebo".to_owned()),
        global_goals: Vec::new(),
        agents: Vec::new(),
        warnings: Vec::new(),
    };
    for human in humans {
        let mut agent = agent(scenario, kit, human, trees, losses)?;
        if is_v2 {
            for goal in &mut agent.goals {
                file.global_goals.push(goal.at);
                goal.name = file.global_goals.len().to_string();
            }
        }
        file.agents.push(agent);
    }
    scenario.note_people(Content::PeopleTracks, "ways of people tick by tick", super::SIMULATED, losses);
    Ok(file)
}

fn agent(
    scenario: &Scenario,
    kit: &Kit,
    human: &HumanProposal,
    trees: &Trees,
    losses: &mut Losses,
) -> Result<AgentEntry, Unusable> {
    let nodes = scenario.paths.humans.get(&human.id).map_or(&[][..], Vec::as_slice);
    let way = scenario.location.graph.polyline(nodes);
    let track = Track::of(scenario, human.id.into(), losses);
    let first = way.first().copied();
    let start = track.first().map_or_else(
        || first.map(|at| InitPose { x: at.x, y: at.y, z: kit.z_m, h: heading(&way) }),
        |state| Some(InitPose { x: micro(state.x), y: micro(state.y), z: kit.z_m, h: micro(angle(state.yaw)) }),
    );
    let Some(start) = start else {
        let problem = format!("{} has neither a path nor a track, so it begins nowhere", human.id);
        return Err(Unusable::new("paths.json humans", problem, "export a bundle with paths"));
    };
    // The goal of somebody who stands is their place.
    let goals: Vec<Point> =
        if way.len() > 1 { way.iter().skip(1).copied().collect() } else { vec![Point::new(start.x, start.y)] };
    let goals = goals.iter().enumerate().map(|(place, at)| GoalEntry {
        name: format!("g{}", place + 1),
        at: Point::new(micro(at.x), micro(at.y)),
        heading: 0.0,
    });
    let info = scenario
        .recording
        .as_ref()
        .and_then(|run| run.header.agents.iter().find(|info| info.agent == AgentId::Human(human.id)).cloned());
    let wanted = info.as_ref().map_or_else(|| human.speed_mps.unwrap_or(PACE_MPS), |info| info.speed_mps);
    let pace = track.pace(scenario, human, &way).unwrap_or(wanted).clamp(*PACES_MPS.start(), *PACES_MPS.end());
    if (pace - wanted).abs() > 0.01 {
        let at = format!("recording: speed of {}", human.id);
        losses.note(
            "paces as they were wished",
            at,
            "the pace is that with which they came to the encounter in the run",
        );
    }
    let reaction = match (trees.own.contains(&human.id), kit.manager) {
        (true, true) => Reaction::Custom(u8::try_from(human.id.number() - 1).unwrap_or_default()),
        (true, false) | (false, true | false) => Reaction::Regular,
    };
    Ok(AgentEntry {
        name: human.id.to_string(),
        id: i64::from(human.id.number()),
        skin: i64::from(human.id.number() - 1) % SKINS,
        group_id: human.group.map_or(-1, |group| i64::from(group.0)),
        max_vel_mps: micro(pace),
        radius_m: micro(info.map_or(RADIUS_M, |info| info.radius_m)),
        start,
        goal_radius_m: GOAL_M,
        cyclic_goals: false,
        behavior: BehaviorEntry { reaction, ..BehaviorEntry::default() },
        goals: goals.collect(),
    })
}

/// Heading of the first part of a way, rad.
fn heading(way: &[Point]) -> f64 {
    match way {
        [a, b, ..] => micro(libm::atan2(b.y - a.y, b.x - a.x)),
        [] | [_] => 0.0,
    }
}

/// Where somebody was while they were there.
struct Track<'a>(Vec<&'a AgentState>);

impl<'a> Track<'a> {
    fn of(scenario: &'a Scenario, agent: AgentId, losses: &mut Losses) -> Self {
        let Some(run) = &scenario.recording else { return Self(Vec::new()) };
        let absent = run.header.absent();
        let all: Vec<&AgentState> = run.track(agent).collect();
        let there: Vec<&AgentState> = all.iter().copied().filter(|state| state.is_there(absent)).collect();
        if there.len() < all.len() {
            losses.note(
                "absence of people",
                format!("recording: {agent}"),
                "everybody is there from the first tick to the last",
            );
        }
        Self(there)
    }

    fn first(&self) -> Option<&AgentState> {
        self.0.first().copied()
    }

    /// When they came to a place.
    fn arrival(&self, at: &Point) -> Option<&AgentState> {
        self.0.iter().copied().find(|state| (state.point() - at).norm() <= THERE_M)
    }

    /// When they were nearest to the robot around the node of their encounter.
    fn meeting(&self, scenario: &Scenario, at: &Point) -> Option<&AgentState> {
        let run = scenario.recording.as_ref()?;
        let absent = run.header.absent();
        let robot = run.track(AgentId::Robot).filter(|state| state.is_there(absent));
        let robot: BTreeMap<u64, Point> = robot.map(|state| (state.tick, state.point())).collect();
        let around = self.0.iter().copied().filter(|state| (state.point() - at).norm() <= AROUND_M);
        let apart = around.filter_map(|state| Some((state, (robot.get(&state.tick)? - state.point()).norm())));
        apart.min_by(|one, other| one.1.total_cmp(&other.1)).map(|(state, _)| state)
    }

    /// The pace at which somebody walks to their first encounter in the time that the run took, waits included, m/s.
    fn pace(&self, scenario: &Scenario, human: &HumanProposal, way: &[Point]) -> Option<f64> {
        if way.len() < 2 {
            return None;
        }
        let node = scenario.paths.encounter_of(human.id)?;
        let at = scenario.location.graph.node(node)?.at;
        let (first, there) = (self.first()?, self.meeting(scenario, &at).or_else(|| self.arrival(&at))?);
        let walked: f64 = self
            .0
            .windows(2)
            .filter_map(|pair| match pair {
                [a, b] if b.tick <= there.tick => Some((b.point() - a.point()).norm()),
                _ => None,
            })
            .sum();
        #[expect(clippy::cast_precision_loss, reason = "a run has far fewer than 2^53 ticks")]
        let seconds = (there.tick - first.tick) as f64 * socrates_model::time::STEP_SECS;
        (seconds > 1.0 && walked > 1.0).then(|| walked / seconds)
    }
}

/// The robot's start and way points as the fork's scenario manager reads them.
pub(super) fn robot_poses(scenario: &Scenario) -> String {
    let graph = &scenario.location.graph;
    let nodes: Vec<Point> = scenario.paths.robot.iter().filter_map(|id| graph.node(id)).map(|node| node.at).collect();
    let pose = |at: &Point| format!("{{x: {}, y: {}, yaw: 0.0}}", real(at.x), real(at.y));
    let mut text = String::new();
    if let Some(first) = nodes.first() {
        text.push_str(&format!("initial_pose: {}\n", pose(first)));
    }
    text.push_str(if nodes.len() > 1 { "waypoints:\n" } else { "waypoints: []\n" });
    for at in nodes.iter().skip(1) {
        text.push_str(&format!("  - position: {}\n", pose(at)));
    }
    text
}
