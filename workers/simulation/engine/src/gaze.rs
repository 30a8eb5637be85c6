//! Where somebody who stands faces at first, as the proposal says.

use socrates_model::proposal::Facing;
use socrates_model::{HumanProposal, Point, Polyline, Vector};

use crate::human::Meeting;
use crate::setup::Setup;

/// The robot is seen coming from so far before the meeting on its way, m.
const COMES_FROM_M: f64 = 4.5;

/// Where somebody faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Gaze {
    /// To a point.
    To(Point),
    /// Away from a point.
    From(Point),
    /// Along a direction.
    Along(Vector),
}

impl Gaze {
    /// Heading of somebody who faces so from a place, rad.
    pub(crate) fn yaw(&self, at: &Point) -> f64 {
        let line = match self {
            Self::To(point) => point - at,
            Self::From(point) => at - point,
            Self::Along(direction) => *direction,
        };
        libm::atan2(line.y, line.x)
    }
}

/// Where a human faces by the proposal; `None` where it says nothing, or names what is nowhere.
pub(crate) fn of(
    setup: &Setup,
    proposal: &HumanProposal,
    meeting: Option<&Meeting>,
    robot_way: &Polyline,
) -> Option<Gaze> {
    let meet_s = meeting.map_or(0.0, |meeting| meeting.robot_s);
    let comes = robot_way.point((meet_s - COMES_FROM_M).max(0.0));
    let along = robot_way.direction(meet_s);
    let left = Vector::new(-along.y, along.x);
    let node = |id| setup.location.graph.node(id).map(|node| Gaze::To(node.at));
    match proposal.facing.as_ref()? {
        Facing::Robot => Some(Gaze::To(comes)),
        Facing::Away => Some(Gaze::From(comes)),
        Facing::Left => Some(Gaze::Along(left)),
        Facing::Right => Some(Gaze::Along(-left)),
        Facing::Human(id) => setup.paths.humans.get(id).and_then(|nodes| nodes.first()).and_then(node),
        Facing::Node(id) => node(id),
    }
}
