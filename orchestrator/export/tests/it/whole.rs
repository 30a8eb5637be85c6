//! A scenario with content of every kind, and the same without one of them.

use socrates_export::scenario::{Content, Scenario};
use socrates_maps::shipped;
use socrates_model::{
    AgentId, AgentState, Cell, DoorOpens, Event, EventKind, Gesture, HumanId, Recording, RecordingHeader, SceneGraph,
    SimTime,
    recording::{ABSENT_LEAF, AgentInfo},
};

/// Ticks of the run: 20 s.
pub(crate) const TICKS: u64 = 2001;
/// The second human comes at this tick: 3 s.
pub(crate) const COMES: u64 = 300;

const PROPOSAL: &str = r#"{
    "format": 1, "title": "Zwei im Büro", "description": "Two people meet the robot.", "pattern": "free", "place": "corridor",
    "humans": [
        {"id": "human_1", "role": "nurse", "behavior": "walks up and waves", "relation": "frontal", "group": 1, "speed_mps": 1.0},
        {"id": "human_2", "role": "visitor", "behavior": "stands", "relation": "static", "group": 1}
    ],
    "groups": [{"id": 1, "members": ["human_1", "human_2"], "standing": false}],
    "robot": {"task": "deliver coffee", "expected_behavior": "waits"},
    "expected_events": [{"id": "c1", "text": "two people", "role": "setup", "must": true, "predicate": {"humans": {"count": 2}}}],
    "author": "offline/1"
}"#;

const TREE: &str = r#"<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <ReactiveFallback>
      <ReactiveSequence>
        <IsRobotNearby agent_id="{id}" distance="2.0"/>
        <LookAtRobot agent_id="{id}"/>
      </ReactiveSequence>
      <RegularNav agent_id="{id}" time_step="{dt}"/>
    </ReactiveFallback>
  </BehaviorTree>
</root>
"#;

/// Position, heading and speed of somebody at a tick.
fn state(tick: u64, agent: AgentId, leaf: u16) -> AgentState {
    let t = tick as f64 * 0.01;
    let (x, y, yaw, vx) = match agent {
        AgentId::Robot => (1.0 + 0.4 * t, 2.0, 0.0, 0.4),
        AgentId::Human(id) if id.number() == 1 => (9.0 - 0.3 * t, 2.5, 3.0, -0.3),
        AgentId::Human(_) => (5.0, 3.123_456_7, -1.5, 0.0),
    };
    let said = (agent != AgentId::Robot && tick > 1000).then_some(Gesture::Wait);
    let yaw = yaw + 0.1;
    AgentState {
        tick,
        agent: agent.number(),
        flags: AgentState::flags(agent, said, leaf),
        x,
        y,
        yaw,
        vx,
        vy: 0.0,
        omega: 0.1,
    }
}

fn recording() -> Recording {
    let ids = [AgentId::Robot, HumanId::new(1).into(), HumanId::new(2).into()];
    let info = |agent: AgentId| AgentInfo {
        agent,
        radius_m: if agent == AgentId::Robot { 0.25 } else { 0.3 },
        speed_mps: 1.1,
        role: if agent == AgentId::Robot { "robot".into() } else { "nurse".into() },
    };
    let header: RecordingHeader = serde_json::from_value(serde_json::json!({
        "format": 1, "run": "s.reference-1", "planner": "reference", "seed": 1, "profile": "native", "step_s": 0.01,
        "agents": ids.map(info), "leaves": ["", "RegularNav", ABSENT_LEAF],
    }))
    .unwrap();
    let leaf = |tick: u64, agent: AgentId| match agent {
        AgentId::Robot => 0,
        AgentId::Human(id) if id.number() == 2 && tick < COMES => 2,
        AgentId::Human(_) => 1,
    };
    let frames = (0..TICKS).flat_map(|tick| ids.map(|agent| state(tick, agent, leaf(tick, agent)))).collect();
    let events = vec![Event { time: SimTime::at_tick(700), kind: EventKind::RobotArrived }];
    Recording { header, frames, events }
}

/// A scenario with content of every kind, in the office.
pub(crate) fn whole() -> Scenario {
    let mut location = shipped::load("office").unwrap();
    let nodes: Vec<String> = location.graph.nodes().iter().map(|node| node.id.to_string()).collect();
    let (from, to) = (location.graph.nodes()[0].id.clone(), location.graph.nodes().last().unwrap().id.clone());
    let way = location.graph.shortest(&from, &to).unwrap();
    let back: Vec<_> = way.iter().rev().cloned().collect();
    location.names = vec![socrates_model::AreaName { name: "Süße Ecke".into(), nodes: vec![from] }];
    location.grid.cells[0] = Cell::Unknown;
    location.doors[0].opens = DoorOpens::Near(1.5);
    assert!(nodes.len() > 5 && way.len() > 3);
    let paths = serde_json::json!({
        "format": 1, "robot": way, "humans": {"human_1": back, "human_2": [way[2]]},
        "encounters": [{"human": "human_1", "node": way[2]}, {"human": "human_2", "node": way[2]}], "author": "offline/1",
    });
    let tree = |text: &str| serde_json::json!({"tree": text, "description": ""});
    let behaviors = serde_json::json!({
        "format": 1, "humans": {"human_1": tree(TREE), "human_2": tree(TREE)}, "author": "offline/1",
    });
    Scenario {
        name: "Büro drei-1".into(),
        location,
        proposal: serde_json::from_str(PROPOSAL).unwrap(),
        paths: serde_json::from_value(paths).unwrap(),
        behaviors: serde_json::from_value(behaviors).unwrap(),
        robot_radius_m: 0.2,
        recording: Some(recording()),
    }
}

/// Leaves agents out of a run.
fn only(run: &mut Recording, kept: impl Fn(AgentId) -> bool) {
    run.header.agents.retain(|info| kept(info.agent));
    run.frames.retain(|state| kept(state.agent_id()));
}

/// The same scenario without any content of a kind.
pub(crate) fn without(scenario: &Scenario, content: Content) -> Scenario {
    let mut scenario = scenario.clone();
    let (location, proposal, paths) = (&mut scenario.location, &mut scenario.proposal, &mut scenario.paths);
    let run = scenario.recording.as_mut().unwrap();
    let mut each = |change: &dyn Fn(&mut AgentState)| run.frames.iter_mut().for_each(change);
    match content {
        // The robot keeps its radius and its pace, which are content of other kinds, and is never there.
        Content::RobotTrack => each(&|state| {
            if state.agent_id() == AgentId::Robot {
                state.flags = AgentState::flags(AgentId::Robot, None, 2);
            }
        }),
        Content::PeopleTracks => only(run, |agent| agent == AgentId::Robot),
        Content::Headings => each(&|state| state.yaw = 0.0),
        Content::Velocities => each(&|state| (state.vx, state.vy, state.omega) = (0.0, 0.0, 0.0)),
        Content::Gestures => each(&|state| state.flags &= !0xff00),
        Content::Leaves => each(&|state| {
            // Absence is told by a leaf, and is part of the tracks.
            if state.leaf() == 1 {
                state.flags &= 0xffff;
            }
        }),
        Content::Events => run.events.clear(),
        Content::Radii => run.header.agents.iter_mut().for_each(|info| info.radius_m = 0.0),
        Content::Speeds => run.header.agents.iter_mut().for_each(|info| info.speed_mps = 0.0),
        Content::Roles => proposal.humans.iter_mut().for_each(|human| human.role.clear()),
        Content::Groups => {
            proposal.groups.clear();
            proposal.humans.iter_mut().for_each(|human| human.group = None);
        }
        Content::Walls | Content::UnknownCells => {
            let (gone, kept) =
                if content == Content::Walls { (Cell::Occupied, Cell::Free) } else { (Cell::Unknown, Cell::Occupied) };
            location.grid.cells.iter_mut().filter(|cell| **cell == gone).for_each(|cell| *cell = kept);
        }
        Content::Doors => location.doors.clear(),
        Content::DoorRules => location.doors.iter_mut().for_each(|door| door.opens = DoorOpens::Always),
        Content::Graph => {
            let nodes = location.graph.nodes().to_vec();
            location.graph = SceneGraph::new(nodes, Vec::new());
        }
        Content::AreaNames => location.names.clear(),
        Content::Paths => {
            paths.robot.clear();
            paths.humans.clear();
        }
        Content::Encounters => paths.encounters.clear(),
        Content::Trees => scenario.behaviors.humans.clear(),
        Content::Clauses => proposal.expected_events.clear(),
        Content::Texts => {
            for text in [&mut proposal.title, &mut proposal.description] {
                text.clear();
            }
            proposal.robot.task.clear();
            proposal.robot.expected_behavior.clear();
            proposal.humans.iter_mut().for_each(|human| human.behavior.clear());
        }
    }
    scenario
}
