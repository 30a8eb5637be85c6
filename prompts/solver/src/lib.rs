//! Ways by geometry: a proposal and a location give the robot's way, everybody else's, and where they meet.
//!
//! ```text
//! Problem ─► graph ─► robot_way ─► everybody ─► search ─► Solved { paths, alternatives }
//!  proposal   nodes     start to     people/*,    costs,      or Miss: what does not fit,
//!  location   by index  goal over    a file per   order       where and by how much
//!                       the place    relation
//! ```
//!
//! Open to every author: whoever made the proposal, the same geometry answers it. [`edit`] changes ways that stand.
//!
//! *Never here:* a word of a request, a file, a clock, a random number of its own (the draw is an argument).

mod breadth;
mod candidates;
mod cost;
pub mod edit;
mod everybody;
mod fit;
mod graph;
pub mod inside;
mod meant;
pub mod measure;
mod miss;
mod named_way;
mod over_all;
mod passable;
mod people;
mod robot_way;
mod search;
mod second_meeting;
mod sides;
mod spread;
mod through_door;
mod told;

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_by_hand;
#[cfg(test)]
mod tests_doors;

use std::collections::BTreeMap;

use serde::Deserialize;
use socrates_model::proposal::WayPart;
use socrates_model::{Breadth, HumanId, Location, NodeId, Paths, PlaceClass, Proposal, RobotModel, Signature};

pub use meant::{met_at, of_proposal};
pub use miss::{Miss, impossible};
pub use people::walks_later;
pub use search::solve;

/// Where on the robot's way people stand who stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// On the way: the robot gets past them.
    #[default]
    Past,
    /// At its end: the robot comes to them.
    With,
    /// At its start: the robot leaves them.
    From,
}

/// What a pattern wants of the place and of the robot's way. The default wants nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Layout {
    /// Where those stand who stand.
    pub ends: Ends,
    /// Class of the place where the robot starts; where it has an inside, the robot comes out of it.
    pub start: Option<PlaceClass>,
    /// Least number of ways that meet in the meeting node.
    pub arms: Option<usize>,
    /// Least and largest free width of the floor across the meeting node, m.
    pub width_m: Option<[f64; 2]>,
}

/// What was said of earlier answers to the same problem. The default: this is the first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// How often the place of the meeting was refused: so many places are passed over.
    pub moves: usize,
    /// How often the robot's way was too short.
    pub shorts: u32,
    /// How often a person's way was too short.
    pub person_shorts: BTreeMap<HumanId, usize>,
    /// Whether the robot got stuck: doorways and aisles are then kept away from.
    pub stuck: bool,
    /// Whether other paths are wanted than those that stand.
    pub another: bool,
    /// The paths that stand, if any.
    pub former: Option<Paths>,
}

/// What is to be solved.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The people who are there, how they stand to the robot's way, and the class of the place.
    pub proposal: &'a Proposal,
    /// The map.
    pub location: &'a Location,
    /// Nodes where the robot's way begins by name; empty where the task leaves it open.
    pub starts: Vec<NodeId>,
    /// Nodes where it ends by name; empty where the task leaves it open.
    pub goals: Vec<NodeId>,
    /// Radius of the disc that covers the robot, m; what is narrower it does not get through.
    pub radius_m: f64,
    /// A class of place that the task has the way lead past.
    pub via: Option<PlaceClass>,
    /// Nodes of the rooms that people come out of by name.
    pub rooms: BTreeMap<HumanId, Vec<NodeId>>,
    /// Nodes of the places by name where people's ways end.
    pub ends: BTreeMap<HumanId, Vec<NodeId>>,
    /// What the pattern wants.
    pub layout: Layout,
    /// What was said of earlier answers.
    pub told: Told,
    /// A random number: of solutions that are as good as each other it picks one.
    pub draw: u64,
    /// How far from the best a solution may be and still be drawn.
    pub breadth: Breadth,
    /// The author who answers, as the paths name it.
    pub author: Signature,
}

impl<'a> Problem<'a> {
    /// The problem of a proposal as it stands: ends by name as its clauses have them, nothing said before, the usual robot.
    #[must_use]
    pub fn of(proposal: &'a Proposal, location: &'a Location, author: Signature) -> Self {
        Self {
            proposal,
            location,
            starts: named_way::ends(proposal, WayPart::Start),
            goals: named_way::ends(proposal, WayPart::Goal),
            radius_m: RobotModel::default().radius_m,
            via: None,
            rooms: BTreeMap::new(),
            ends: BTreeMap::new(),
            layout: Layout::default(),
            told: Told::default(),
            draw: 0,
            breadth: Breadth::Usual,
            author,
        }
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// The chosen paths.
    pub paths: Paths,
    /// Different paths that are as good as the best, the best first, then each time those that play farthest from all before: two
    /// differ when the meeting, or the robot's start or goal, lies more than 3 m elsewhere. The draw picks among them. In a wide
    /// search, where somebody who comes from another side makes a difference too, those with the most points of them.
    pub alternatives: Vec<Paths>,
}
