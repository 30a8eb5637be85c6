//! The nouns of SocRATES: every artifact, id, unit, clause and fault that two rooms share.
//!
//! ```text
//! request ─► reading ─► proposal ─► paths ─┐
//!                          └─► behaviors ──┴─► recording ─► report
//! ```
//!
//! Modules in reading order: ids and units first, then the artifacts in the order in which a
//! scenario meets them, then what passes between processes.
//!
//! *Never here:* a runtime, a file, a socket, a clock, a generator of random numbers, another room's rule.

pub mod geometry;
pub mod gesture;
pub mod hash;
pub mod ids;
pub mod person_model;
pub mod planner_name;
pub mod polyline;
pub mod run;
pub mod seeds;
pub mod time;

pub mod graph;
mod graph_index;
pub mod grid;
pub mod location;
pub mod place;

pub mod act;
pub mod behaviors;
pub mod building;
pub mod clause;
pub mod form;
pub mod likeness;
pub mod paths;
pub mod priority;
pub mod proposal;
pub mod reading;
pub mod request;
pub mod rule;
pub mod scenario;
pub mod script;

pub mod drive;
pub mod driver;

pub mod live;
pub mod lockstep;
mod onlooker;
pub mod recording;
pub mod report;
pub mod robot;
mod telling;

pub mod fault;
pub mod job;
pub mod role;
pub mod schema;
pub mod signature;
pub mod standing;
pub mod statement;
pub mod trace;
pub mod wire;
pub mod words;

pub use nalgebra;

pub use act::Action;
pub use behaviors::{Behaviors, HumanBehavior};
pub use building::{BuildingBrief, BuildingKind, CorridorForm, RoomBrief, Unmet};
pub use clause::{Clause, ClauseRole, Predicate, Shows};
pub use drive::{Command, Cues, Observation, RobotDriver, SeenDoor, SeenPerson, SeenRobot};
pub use fault::{FailureClass, Family, Fault, FaultCode, Payload, Remedy, Where};
pub use geometry::{Point, Pose, Vector};
pub use gesture::Gesture;
pub use graph::{GraphEdge, GraphNode, SceneGraph};
pub use grid::{Cell, Grid};
pub use hash::{Digest, DigestWriter};
pub use ids::{AgentId, GroupId, HumanId, NodeId, RunId, ScenarioId};
pub use likeness::Likeness;
pub use location::{AreaName, Door, DoorKind, DoorOpens, Location};
pub use onlooker::{Keeper, Onlooker};
pub use paths::{Encounter, Paths, Visit, ordinal};
pub use person_model::PersonModel;
pub use place::PlaceClass;
pub use planner_name::PlannerName;
pub use polyline::Polyline;
pub use proposal::{GroupProposal, HumanProposal, Proposal, Relation, RobotProposal, Side};
pub use reading::{Fact, FactKind, ReadBy, Reading};
pub use recording::{AgentState, Event, EventKind, Recording, RecordingHeader};
pub use report::{ClauseResult, MetricValue, Missing, Report, Unit, Verdict};
pub use request::{AuthorSpec, BadRequest, Breadth, Moment, Request, Seeds};
pub use robot::{Kinematics, RobotModel};
pub use role::Role;
pub use rule::{RobotRule, Rule, Trigger};
pub use run::Run;
pub use scenario::Scenario;
pub use signature::Signature;
pub use standing::{JobState, ScenarioEnd};
pub use statement::Statement;
pub use time::SimTime;
pub use trace::TraceContext;

/// Format number written into every artifact. A reader refuses a larger one.
pub const FORMAT: u32 = 1;
