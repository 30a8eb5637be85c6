//! One human of the run: body, way, tree.

use socrates_bt::{Tree, TreeState};
use socrates_model::act::ActWay;
use socrates_model::{
    Action, AgentId, Gesture, GroupId, HumanId, NodeId, Point, Polyline, Relation, Side, Trigger, Vector,
};

use crate::gaze::Gaze;
use crate::make_room::Facing;
use crate::models::Walks;
use crate::near::Notice;

/// So far beyond a door line somebody is through, m.
const THROUGH_M: f64 = 0.7;
/// Less far beyond it somebody who goes in still stands in the door, m.
const AT_DOOR_M: f64 = 0.3;

/// Where a human meets the robot.
#[derive(Debug, Clone)]
pub(crate) struct Meeting {
    pub(crate) node: NodeId,
    pub(crate) at: Point,
    /// Length along the human's way, m.
    pub(crate) human_s: f64,
    /// Length along the robot's way, m.
    pub(crate) robot_s: f64,
    /// It aims at being there so long before the robot, s.
    pub(crate) lead_s: f64,
}

/// A door on the way.
#[derive(Debug, Clone)]
pub(crate) struct DoorOnWay {
    /// Place in the location's list.
    pub(crate) door: usize,
    /// Length along the way, m.
    pub(crate) s: f64,
}

/// What the present action needs to remember.
#[derive(Debug, Clone, Default)]
pub(crate) struct Errand {
    /// A spot that was chosen (to step aside, to run to).
    pub(crate) spot: Option<Point>,
    /// A way round walls that is being walked, and how far.
    pub(crate) way: Option<(Polyline, f64)>,
    /// When the spot was chosen, s.
    pub(crate) since_s: f64,
}

/// A human.
#[derive(Debug, Clone)]
pub(crate) struct Human {
    pub(crate) id: HumanId,
    pub(crate) role: String,
    pub(crate) relation: Relation,
    pub(crate) group: Option<GroupId>,
    /// Whether its group stands.
    pub(crate) standing: bool,
    /// Place beside the middle of a walking group, m to the left.
    pub(crate) lane_m: f64,
    /// Where it faces at first, if the proposal says so.
    pub(crate) gaze: Option<Gaze>,
    /// Side of the robot's way on which it is to be.
    pub(crate) side: Option<Side>,
    /// From the middle of its walking group to the outermost member, m; 0 for who walks alone.
    pub(crate) flank_m: f64,
    /// Whether it has come to its end behind others who stand there.
    pub(crate) lined_up: bool,
    /// How many block the robot where it does.
    pub(crate) blockers: usize,
    /// Its place among those while it blocks: m to the robot's left, and m farther ahead of it than the first.
    pub(crate) place_m: Option<(f64, f64)>,
    /// How far it stands or walks from where it would by plan, m to the left and ahead: nobody keeps to a line exactly.
    pub(crate) sway: (f64, f64),
    pub(crate) tree: Tree,
    pub(crate) state: TreeState,
    pub(crate) route: Polyline,
    /// Nodes of the path with their length along it.
    pub(crate) nodes: Vec<(NodeId, f64)>,
    pub(crate) next_node: usize,
    pub(crate) s: f64,
    /// Where it meets the robot, one after the other.
    pub(crate) meetings: Vec<Meeting>,
    pub(crate) doors: Vec<DoorOnWay>,
    pub(crate) at: Point,
    pub(crate) velocity: Vector,
    pub(crate) yaw: f64,
    /// Whether somebody else, or the robot, waits for something that they do.
    pub(crate) awaited: bool,
    /// How far beside the door they look at first where they stay behind it, rad.
    pub(crate) off_rad: f64,
    pub(crate) omega: f64,
    pub(crate) radius_m: f64,
    pub(crate) speed_mps: f64,
    pub(crate) action: Action,
    pub(crate) gesture: Option<Gesture>,
    /// To whom it is made, where that is one.
    pub(crate) gesture_to: Option<AgentId>,
    /// Its speed since it changed its pace, m/s.
    pub(crate) pace_mps: Option<f64>,
    /// Whether it has left its path, to go back or to another place.
    pub(crate) diverted: bool,
    pub(crate) errand: Errand,
    /// Where it was at tick 0.
    pub(crate) home: Point,
    /// How fast it walks at most to be in time, m/s.
    pub(crate) fastest_mps: f64,
    /// Whether the place at the end of its way is a stated one.
    pub(crate) bound: bool,
    /// Whether it makes room for the robot: then it stands in its way until then.
    pub(crate) opens: bool,
    /// Where it stands while it stands.
    pub(crate) anchor: Option<Point>,
    /// Sidestep that is being made on the way, m to the left.
    pub(crate) aside_m: f64,
    /// For how long it has been face to face with the robot without getting on, s.
    pub(crate) jammed_s: f64,
    /// Until when it lets the robot through, s.
    pub(crate) yields_until_s: f64,
    /// The person in its way, face to face.
    pub(crate) facing: Facing,
    /// How near the robot has been to it, m.
    pub(crate) nearest_robot_m: f64,
    /// How many steps its sequence has, and how many of them have ended.
    pub(crate) steps: u32,
    pub(crate) steps_ended: u32,
    /// Whether it ever walked.
    pub(crate) started: bool,
    /// Where it walked, a point every decimeter.
    pub(crate) trail: Polyline,
    /// What it noticed when it last looked round.
    pub(crate) notice: Notice,
    /// The model by which it walks.
    pub(crate) walks: Walks,
}

impl Human {
    /// As an agent.
    pub(crate) const fn agent(&self) -> AgentId {
        AgentId::Human(self.id)
    }

    /// Whether it gets on along its way.
    pub(crate) fn gets_on(&self) -> bool {
        self.action.row().way != ActWay::None
    }

    /// The first of its meetings: what trees and scripts call the encounter.
    pub(crate) fn meeting(&self) -> Option<&Meeting> {
        self.meetings.first()
    }

    /// Whether it is at the end of its path.
    pub(crate) fn at_goal(&self) -> bool {
        self.route.end().is_none_or(|end| {
            let reach = if self.route.length_m() > 0.0 { 0.45 + self.lane_m.abs() } else { 1.6 };
            let left = (self.at - end).norm();
            // Where somebody else stands at the end already, next to it is the end.
            let beside = self.started && left < 1.15 && self.velocity.norm() < 0.12 && self.is_through();
            self.lined_up
                || left < reach && self.s > self.route.length_m() - 0.6
                || beside && self.s > self.route.length_m() - 1.2
        })
    }

    /// Whether all its steps have ended; without steps, whether its walk has led it past where it meets the robot, or to its end.
    pub(crate) fn is_done(&self) -> bool {
        if self.steps > 0 {
            return self.steps_ended >= self.steps;
        }
        let past = self.meetings.last().is_some_and(|meeting| self.s > meeting.human_s + Trigger::DONE_M);
        past || self.at_goal()
    }

    /// Whether it is beyond the door that it waits for to go in; of anybody else it is not asked.
    pub(crate) fn is_through(&self) -> bool {
        self.relation != Relation::Static || self.doors.last().is_none_or(|door| self.s > door.s + AT_DOOR_M)
    }

    /// Direction it faces.
    pub(crate) fn heading(&self) -> Vector {
        let (sin, cos) = libm::sincos(self.yaw);
        Vector::new(cos, sin)
    }

    /// How far it has gone aside from its line for whoever is in its way, m to the left.
    pub(crate) fn gone_aside_m(&self) -> f64 {
        self.aside_m - self.lane_m
    }

    /// Direction of travel: along the way while there is some left, else where it faces.
    pub(crate) fn travel(&self) -> Vector {
        if self.velocity.norm() > 0.2 {
            return self.velocity.normalize();
        }
        let ahead = self.route.direction(self.s);
        if ahead.norm() > 0.5 && !self.at_goal() { ahead } else { self.heading() }
    }

    /// Whether it is to come out of a room or car and is not out yet.
    pub(crate) fn inside_still(&self) -> bool {
        self.relation == Relation::Leaving
            && match self.doors.first() {
                Some(door) => self.s < door.s + THROUGH_M,
                None => self.s < 2.0_f64.min(self.route.length_m() - 0.5),
            }
    }

    /// Whether it waits before a door to go in and is not in yet.
    pub(crate) fn outside_still(&self) -> bool {
        let goes_in = self.relation == Relation::Static && !self.at_goal();
        goes_in && self.doors.first().is_some_and(|door| self.s < door.s + THROUGH_M)
    }

    /// Whether it stands at its place, for good or until it sets off.
    pub(crate) fn keeps_place(&self) -> bool {
        self.stays() || self.relation == Relation::Static && !self.started
    }

    /// Whether it never leaves its place by itself.
    pub(crate) fn stays(&self) -> bool {
        self.route.length_m() < 0.05 || !self.diverted && self.relation.stands() && self.nodes.len() <= 1
    }
}
