//! Kinds of content of a scenario, and where each stands in one.

use std::collections::BTreeSet;

use socrates_model::{AgentId, AgentState, Cell, DoorOpens, Recording};

use super::Scenario;

/// Why tracks lack headings, velocities and the like.
pub(super) const POSITIONS: &str = "the format holds positions alone";
/// Why tracks lack roles, rules and texts.
pub(super) const WORDS: &str = "the format has no place for words or rules";

/// Why cells that nobody has seen are not told from walls.
pub(super) const NEVER_SEEN: &str = "what was never seen is no floor, as walls are";

/// What formats of tracks lack: `first`, all of states but places, words and rules; of the floor `floor`, and the graph for a reason of
/// their own.
macro_rules! tracks_lack {
    ([$($first:expr),*], $states:expr, [$($floor:expr),* $(,)?], $graph:expr) => {
        &[
            $($first,)*
            (Content::Velocities, $states),
            (Content::Gestures, $states),
            (Content::Leaves, $states),
            (Content::Events, $states),
            (Content::Radii, $states),
            (Content::Speeds, $states),
            (Content::Roles, WORDS),
            (Content::Groups, WORDS),
            $($floor,)*
            (Content::Graph, $graph),
            (Content::AreaNames, $graph),
            (Content::Paths, WORDS),
            (Content::Encounters, WORDS),
            (Content::Trees, WORDS),
            (Content::Clauses, WORDS),
            (Content::Texts, WORDS),
        ]
    };
}
pub(super) use tracks_lack;

/// A kind of content. A format holds it or lists it as lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Content {
    /// Where the robot was, tick by tick.
    RobotTrack,
    /// Where people were, tick by tick.
    PeopleTracks,
    /// Which way everybody faced, tick by tick.
    Headings,
    /// How fast everybody moved, tick by tick.
    Velocities,
    /// Gestures that were made.
    Gestures,
    /// Which leaf of its tree each human ran, tick by tick.
    Leaves,
    /// Events of the run: encounters, contacts, doors that opened.
    Events,
    /// Radii of the bodies.
    Radii,
    /// Speeds at which people want to walk.
    Speeds,
    /// Role words of people.
    Roles,
    /// Groups of people.
    Groups,
    /// Occupied cells of the map.
    Walls,
    /// Cells of the map that were never seen.
    UnknownCells,
    /// Doors and where they are.
    Doors,
    /// When doors open and close.
    DoorRules,
    /// Scene graph: ways between places, and types of both.
    Graph,
    /// Names of areas.
    AreaNames,
    /// Node sequences of robot and people, as they were intended.
    Paths,
    /// Where robot and people should meet.
    Encounters,
    /// Behavior trees.
    Trees,
    /// Clauses by which the run is judged.
    Clauses,
    /// Title, description, task and expected behavior in words.
    Texts,
}

impl Content {
    /// Every kind, in the order of the lists.
    pub const ALL: [Self; 22] = [
        Self::RobotTrack,
        Self::PeopleTracks,
        Self::Headings,
        Self::Velocities,
        Self::Gestures,
        Self::Leaves,
        Self::Events,
        Self::Radii,
        Self::Speeds,
        Self::Roles,
        Self::Groups,
        Self::Walls,
        Self::UnknownCells,
        Self::Doors,
        Self::DoorRules,
        Self::Graph,
        Self::AreaNames,
        Self::Paths,
        Self::Encounters,
        Self::Trees,
        Self::Clauses,
        Self::Texts,
    ];

    /// Name in lists of losses and documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RobotTrack => "robot track",
            Self::PeopleTracks => "people tracks",
            Self::Headings => "headings",
            Self::Velocities => "velocities",
            Self::Gestures => "gestures",
            Self::Leaves => "running leaves",
            Self::Events => "events",
            Self::Radii => "radii",
            Self::Speeds => "desired speeds",
            Self::Roles => "roles",
            Self::Groups => "groups",
            Self::Walls => "walls",
            Self::UnknownCells => "unknown cells",
            Self::Doors => "doors",
            Self::DoorRules => "door rules",
            Self::Graph => "scene graph",
            Self::AreaNames => "names of areas",
            Self::Paths => "intended paths",
            Self::Encounters => "planned encounters",
            Self::Trees => "behavior trees",
            Self::Clauses => "clauses",
            Self::Texts => "texts",
        }
    }

    /// Where content of this kind stands in a scenario, as paths of its bundle; empty where there is none.
    #[must_use]
    pub fn places(self, scenario: &Scenario) -> Vec<String> {
        let location = &scenario.location;
        let cells = |kind: Cell| {
            let count = location.grid.cells.iter().filter(|cell| **cell == kind).count();
            if count == 0 { Vec::new() } else { vec![format!("location.json grid: {count} cells")] }
        };
        match self {
            Self::RobotTrack
            | Self::PeopleTracks
            | Self::Headings
            | Self::Velocities
            | Self::Gestures
            | Self::Leaves
            | Self::Events
            | Self::Radii
            | Self::Speeds => scenario.recording.as_ref().map_or_else(Vec::new, |run| self.of_run(run)),
            Self::Roles => {
                let humans = scenario.proposal.humans.iter().filter(|human| !human.role.is_empty());
                humans.map(|human| format!("proposal.json {}.role", human.id)).collect()
            }
            Self::Groups => {
                scenario.proposal.groups.iter().map(|group| format!("proposal.json groups: {}", group.id)).collect()
            }
            Self::Walls => cells(Cell::Occupied),
            Self::UnknownCells => cells(Cell::Unknown),
            Self::Doors => location.doors.iter().map(|door| format!("location.json door `{}`", door.id)).collect(),
            Self::DoorRules => location
                .doors
                .iter()
                .filter(|door| door.opens != DoorOpens::Always)
                .map(|door| format!("location.json door `{}`: opens", door.id))
                .collect(),
            Self::Graph => {
                let (nodes, edges) = (location.graph.nodes().len(), location.graph.edges().len());
                if edges == 0 { Vec::new() } else { vec![format!("location.json graph: {nodes} nodes, {edges} edges")] }
            }
            Self::AreaNames => {
                location.names.iter().map(|area| format!("location.json name `{}`", area.name)).collect()
            }
            Self::Paths => {
                let robot = (!scenario.paths.robot.is_empty()).then(|| "paths.json robot".to_owned());
                let humans = scenario.paths.humans.iter().filter(|(_, nodes)| !nodes.is_empty());
                robot.into_iter().chain(humans.map(|(id, _)| format!("paths.json {id}"))).collect()
            }
            Self::Encounters => {
                let encounters = scenario.paths.encounters.iter();
                encounters.map(|one| format!("paths.json encounters: {} at `{}`", one.human, one.node)).collect()
            }
            Self::Trees => scenario.behaviors.humans.keys().map(|id| format!("behaviors.json {id}.tree")).collect(),
            Self::Clauses => {
                let clauses = scenario.proposal.expected_events.iter();
                clauses.map(|clause| format!("proposal.json expected_events: {}", clause.id)).collect()
            }
            Self::Texts => texts(scenario),
        }
    }

    /// The same for what a run holds.
    fn of_run(self, run: &Recording) -> Vec<String> {
        let absent = run.header.absent();
        let there = |agent: AgentId| run.track(agent).any(|state| state.is_there(absent));
        let who = |wanted: &dyn Fn(AgentId) -> bool| {
            let agents = run.header.agents.iter().map(|info| info.agent);
            agents.filter(|agent| wanted(*agent)).map(|agent| format!("recording: {agent}")).collect::<Vec<String>>()
        };
        let whose = |holds: fn(&AgentState) -> bool| {
            who(&|agent| run.track(agent).any(|state| state.is_there(absent) && holds(state)))
        };
        match self {
            Self::RobotTrack => who(&|agent| agent == AgentId::Robot && there(agent)),
            Self::PeopleTracks => who(&|agent| agent != AgentId::Robot && there(agent)),
            Self::Headings => whose(|state| state.yaw != 0.0),
            Self::Velocities => whose(|state| state.vx != 0.0 || state.vy != 0.0 || state.omega != 0.0),
            Self::Gestures => whose(|state| state.gesture().is_some()),
            Self::Leaves => whose(|state| state.leaf() != 0),
            Self::Events => {
                run.events.iter().map(|event| format!("recording: event at {:.2} s", event.time.secs())).collect()
            }
            Self::Radii => run
                .header
                .agents
                .iter()
                .filter(|info| info.radius_m > 0.0)
                .map(|info| format!("recording: radius of {}", info.agent))
                .collect(),
            Self::Speeds => {
                let walkers = run.header.agents.iter().filter(|info| info.speed_mps > 0.0);
                walkers.map(|info| format!("recording: speed of {}", info.agent)).collect()
            }
            Self::Roles
            | Self::Groups
            | Self::Walls
            | Self::UnknownCells
            | Self::Doors
            | Self::DoorRules
            | Self::Graph
            | Self::AreaNames
            | Self::Paths
            | Self::Encounters
            | Self::Trees
            | Self::Clauses
            | Self::Texts => Vec::new(),
        }
    }
}

/// Texts of a scenario that are not empty.
fn texts(scenario: &Scenario) -> Vec<String> {
    let proposal = &scenario.proposal;
    let named = [
        ("title", &proposal.title),
        ("description", &proposal.description),
        ("robot.task", &proposal.robot.task),
        ("robot.expected_behavior", &proposal.robot.expected_behavior),
    ];
    let own = named.into_iter().filter(|(_, text)| !text.is_empty()).map(|(key, _)| format!("proposal.json {key}"));
    let behaviors = proposal.humans.iter().filter(|human| !human.behavior.is_empty());
    let all: BTreeSet<String> =
        own.chain(behaviors.map(|human| format!("proposal.json {}.behavior", human.id))).collect();
    all.into_iter().collect()
}
