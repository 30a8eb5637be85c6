//! A problem of a location, with what it is about and where that is.

use socrates_model::{Fault, FaultCode, NodeId, Point, Where};

/// What of a location a problem is about.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum About {
    /// The map, or the location as a whole.
    Whole,
    /// A node.
    Node(NodeId),
    /// The edge between two nodes, as the file names its ends.
    Edge(NodeId, NodeId),
    /// The door at this place of the list, from 0: its id may be the problem.
    Door(usize),
    /// The named area at this place of the list, from 0.
    Name(usize),
}

/// A problem of a location: a fault that a person can be led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub about: About,
    /// Where to look, map frame, m; `None` where it is about the whole.
    pub at: Option<Point>,
    /// The problem.
    pub fault: Fault,
}

impl Finding {
    pub(crate) fn new(about: About, at: Option<Point>, fault: Fault) -> Self {
        Self { about, at, fault }
    }

    /// A problem of the location as a whole.
    pub(crate) fn whole(code: FaultCode, place: impl Into<Where>, message: String) -> Self {
        Self::new(About::Whole, None, Fault::new(code, place, message))
    }
}
