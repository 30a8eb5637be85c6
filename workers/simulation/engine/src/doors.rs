//! Doors that open and close.
//!
//! ```text
//! time · who is near · events of the last tick ─► wanted ─► open ─► (hold_s with nobody near) ─► closed
//! ```
//!
//! Doors of an elevator that close the same car (they share a node inside and lie within 1 m of each other: the
//! landing door and the door of the car) are one gate: they open and close together.

use std::collections::BTreeSet;

use socrates_model::act::ACTS;
use socrates_model::{Door, DoorKind, DoorOpens, Event, EventKind, Gesture, Location, Point, Vector};

/// Nobody within this distance of the door line lets it close, m.
const CLOSING_REACH_M: f64 = 1.0;
/// Somebody slower than this does not come to a door, m/s.
const COMING_MPS: f64 = 0.05;
/// An event that happens at a spot opens the doors whose middle is nearer than this, m.
const EVENT_REACH_M: f64 = 4.0;
/// Two doors of one car are at most so far apart, m.
const GATE_M: f64 = 1.0;
/// The event that the rendezvous controller raises: somebody is about to go through.
pub(crate) const ENCOUNTER: &str = "encounter";

/// A call is for the door whose middle is nearer than this, m.
const CALL_M: f64 = 0.1;

/// Names of all events that can open a door of this location (`opens = { on_event = "…" }`).
///
/// - `encounter`: somebody whose way leads through the door is about to go through;
/// - a gesture (`PROCEED`) or a leaf (`GiveWaytoRobot`) that begins within 4 m of the door, whoever makes it;
/// - `node <id>`: anybody reaches this node of its path;
/// - `door <id> opens`, `door <id> closes`: another door changes;
/// - `robot arrived`: the robot is at its goal.
#[must_use]
pub fn event_names(location: &Location) -> BTreeSet<String> {
    let mut names: BTreeSet<String> = [ENCOUNTER, "robot arrived"].into_iter().map(str::to_owned).collect();
    names.extend(Gesture::ALL.iter().map(ToString::to_string));
    names.extend(ACTS.iter().map(|act| act.leaf.to_owned()));
    names.extend(location.graph.nodes().iter().map(|node| format!("node {}", node.id)));
    for door in &location.doors {
        names.extend([format!("door {} opens", door.id), format!("door {} closes", door.id)]);
    }
    names
}

/// Somebody as doors see them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passer {
    pub(crate) at: Point,
    pub(crate) velocity: Vector,
    pub(crate) robot: bool,
}

/// A named event that may open doors; with a spot only those near it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Raised {
    pub(crate) name: String,
    pub(crate) at: Option<Point>,
    /// Whether the door at the spot opens for it that else opens for the robot: an elevator that was called.
    pub(crate) calls: bool,
}

impl Raised {
    /// What a recorded event raises; `place` tells where an agent is.
    pub(crate) fn by(event: &Event, place: &dyn Fn(socrates_model::AgentId) -> Option<Point>) -> Option<Self> {
        let (name, at) = match &event.kind {
            EventKind::Gesture { agent, gesture, .. } => (Gesture::name_of(*gesture).to_owned(), place(*agent)),
            EventKind::Leaf { human, leaf } => (leaf.clone(), place(socrates_model::AgentId::Human(*human))),
            EventKind::Node { node, .. } => (format!("node {node}"), None),
            EventKind::Door { door, open: true } => (format!("door {door} opens"), None),
            EventKind::Door { door, open: false } => (format!("door {door} closes"), None),
            EventKind::RobotArrived => ("robot arrived".to_owned(), None),
            EventKind::Sees { .. }
            | EventKind::StepEnded { .. }
            | EventKind::Encounter { .. }
            | EventKind::Contact { .. }
            | EventKind::WallContact { .. }
            | EventKind::Stuck { .. }
            | EventKind::End { .. } => return None,
        };
        Some(Self { name, at, calls: false })
    }
}

/// One door of the run.
#[derive(Debug, Clone)]
pub(crate) struct LiveDoor {
    pub(crate) door: Door,
    pub(crate) open: bool,
    /// Place of the first door of its gate.
    gate: usize,
    idle_s: f64,
    /// How many of its times are over.
    over: usize,
}

/// All doors of the run.
#[derive(Debug, Clone)]
pub(crate) struct Doors {
    pub(crate) doors: Vec<LiveDoor>,
    /// Whether any door waits for an event that agents or other doors raise.
    pub(crate) listening: bool,
}

impl Doors {
    pub(crate) fn new(location: &Location) -> Self {
        let mut doors: Vec<LiveDoor> = Vec::new();
        for (place, door) in location.doors.iter().enumerate() {
            let gate = doors.iter().position(|other| same_gate(&other.door, door)).unwrap_or(place);
            let open = door.opens == DoorOpens::Always;
            doors.push(LiveDoor { door: door.clone(), open, gate, idle_s: 0.0, over: 0 });
        }
        let named = |live: &LiveDoor| matches!(&live.door.opens, DoorOpens::OnEvent(name) if name != ENCOUNTER);
        let listening = doors.iter().any(named);
        Self { doors, listening }
    }

    /// Lines that are closed now.
    pub(crate) fn closed(&self) -> Vec<(Point, Point)> {
        self.doors.iter().filter(|live| !live.open).map(|live| (live.door.from, live.door.to)).collect()
    }

    /// One tick on; `raised` are the events of the tick before. Gives back the doors that changed.
    pub(crate) fn step(&mut self, now_s: f64, dt: f64, passers: &[Passer], raised: &[Raised]) -> Vec<(String, bool)> {
        let moments: Vec<(usize, bool, bool, f64)> = self
            .doors
            .iter_mut()
            .map(|live| {
                let (from, to) = (live.door.from, live.door.to);
                let distance = |at: &Point| socrates_model::geometry::nearest_on_segment(at, &from, &to).0;
                let near = passers.iter().any(|passer| distance(&passer.at) < CLOSING_REACH_M);
                (live.gate, live.wanted(now_s, passers, raised), near, live.door.hold_s)
            })
            .collect();
        let mut changed = Vec::new();
        for live in &mut self.doors {
            let gate = || moments.iter().filter(|(gate, ..)| *gate == live.gate);
            let wanted = gate().any(|(_, wanted, ..)| *wanted);
            let near = gate().any(|(_, _, near, _)| *near);
            let hold_s = gate().fold(0.0_f64, |most, (.., hold_s)| most.max(*hold_s));
            live.idle_s = if near || wanted { 0.0 } else { live.idle_s + dt };
            let open = live.door.opens == DoorOpens::Always || wanted || live.open && live.idle_s < hold_s;
            if open != live.open {
                live.open = open;
                changed.push((live.door.id.clone(), open));
            }
        }
        changed
    }
}

/// Whether two doors close the same car.
fn same_gate(a: &Door, b: &Door) -> bool {
    a.kind == DoorKind::Elevator
        && b.kind == DoorKind::Elevator
        && a.inside.iter().any(|node| b.inside.contains(node))
        && (a.middle() - b.middle()).norm() <= GATE_M
}

impl LiveDoor {
    fn wanted(&mut self, now_s: f64, passers: &[Passer], raised: &[Raised]) -> bool {
        let middle = self.door.middle();
        let comes = |passer: &Passer, reach: f64| {
            let way = middle - passer.at;
            way.norm() <= reach && (passer.robot || passer.velocity.dot(&way) > COMING_MPS * way.norm().min(1.0))
        };
        match &self.door.opens {
            DoorOpens::Always => true,
            DoorOpens::Never => false,
            DoorOpens::AtTimes(times) => {
                let over = times.iter().filter(|at_s| now_s >= **at_s).count();
                let due = over > self.over;
                self.over = over;
                due
            }
            DoorOpens::Near(reach) => passers.iter().any(|passer| comes(passer, *reach)),
            DoorOpens::RobotNear(reach) => {
                let called = |event: &Raised| event.calls && event.at.is_some_and(|at| (at - middle).norm() < CALL_M);
                let robot = |passer: &Passer| passer.robot && (passer.at - middle).norm() <= *reach;
                passers.iter().any(robot) || raised.iter().any(called)
            }
            // What happens at a spot opens the doors there; others that wait for the same name stay shut.
            DoorOpens::OnEvent(name) => raised
                .iter()
                .any(|event| event.name == *name && event.at.is_none_or(|at| (at - middle).norm() < EVENT_REACH_M)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::DoorKind;

    fn doors(opens: DoorOpens) -> Doors {
        let (from, to) = (Point::new(0., -0.5), Point::new(0., 0.5));
        let door = Door { id: "d".into(), kind: DoorKind::Room, from, to, opens, hold_s: 2.0, inside: vec![] };
        Doors { doors: vec![LiveDoor { door, open: false, gate: 0, idle_s: 0.0, over: 0 }], listening: false }
    }

    fn at(x: f64, vx: f64, robot: bool) -> Passer {
        Passer { at: Point::new(x, 0.), velocity: Vector::new(vx, 0.), robot }
    }

    #[test]
    fn somebody_who_stands_beside_a_door_does_not_open_it() {
        let mut doors = doors(DoorOpens::Near(1.5));
        assert!(doors.step(0.0, 0.01, &[at(1.0, 0.0, false)], &[]).is_empty());
        assert_eq!(doors.step(0.01, 0.01, &[at(1.0, -0.5, false)], &[]), [("d".to_owned(), true)]);
    }

    #[test]
    fn an_open_door_closes_only_after_its_hold_with_nobody_near() {
        let mut doors = doors(DoorOpens::RobotNear(3.0));
        assert_eq!(doors.step(0.0, 0.01, &[at(2.0, 0.0, true)], &[]).len(), 1);
        let far = [at(9.0, 0.0, true)];
        let closes = (0..300).filter(|_| !doors.step(1.0, 0.01, &far, &[]).is_empty()).count();
        assert_eq!(closes, 1);
        assert_eq!(doors.closed().len(), 1);
    }

    #[test]
    fn a_door_opens_once_at_each_of_its_times() {
        let mut doors = doors(DoorOpens::AtTimes(vec![1.0, 5.0]));
        assert!(doors.step(0.5, 0.01, &[], &[]).is_empty());
        assert_eq!(doors.step(1.0, 0.01, &[], &[]).len(), 1);
        let closes = (0..300).filter(|_| !doors.step(1.1, 0.01, &[], &[]).is_empty()).count();
        assert_eq!((closes, doors.closed().len()), (1, 1));
        assert_eq!(doors.step(5.0, 0.01, &[], &[]).len(), 1, "opens again");
        assert!(doors.closed().is_empty() && doors.step(5.01, 0.01, &[], &[]).is_empty());
    }

    #[test]
    fn an_event_opens_the_doors_near_it_and_one_without_a_spot_opens_all() {
        let mut doors = doors(DoorOpens::OnEvent("PROCEED".into()));
        let event = |name: &str, at: Option<f64>| {
            [Raised { name: name.into(), at: at.map(|x| Point::new(x, 0.)), calls: false }]
        };
        assert!(doors.step(0.0, 0.01, &[], &event("WAIT", Some(1.0))).is_empty());
        assert!(doors.step(0.0, 0.01, &[], &event("PROCEED", Some(6.0))).is_empty());
        assert_eq!(doors.step(0.0, 0.01, &[], &event("PROCEED", Some(2.0))).len(), 1);
        let closes = (0..300).filter(|_| !doors.step(1.0, 0.01, &[], &[]).is_empty()).count();
        assert_eq!((closes, doors.closed().len()), (1, 1));
        assert_eq!(doors.step(9.0, 0.01, &[], &event("PROCEED", None)).len(), 1);
    }

    #[test]
    fn landing_and_car_door_of_an_elevator_are_one_gate() {
        let door = |id: &str, x: f64, opens: DoorOpens| Door {
            id: id.into(),
            kind: DoorKind::Elevator,
            from: Point::new(x, -0.5),
            to: Point::new(x, 0.5),
            opens,
            hold_s: 2.0,
            inside: vec![crate::fixture::id("car")],
        };
        let mut place = crate::fixture::location(crate::fixture::hall(4.0, 4.0), &[("car", 1.0, 1.0)], &[]);
        place.doors = vec![
            door("landing", 0.0, DoorOpens::RobotNear(3.0)),
            door("car", 0.3, DoorOpens::OnEvent(ENCOUNTER.into())),
            door("other_side", 9.0, DoorOpens::RobotNear(3.0)),
        ];
        let mut doors = Doors::new(&place);
        let opened = doors.step(0.0, 0.01, &[at(-2.0, 0.5, true)], &[]);
        assert_eq!(opened, [("landing".to_owned(), true), ("car".to_owned(), true)]);
        let mut closed = Vec::new();
        for _ in 0..300 {
            closed.extend(doors.step(1.0, 0.01, &[at(-9.0, 0.5, true)], &[]));
        }
        assert_eq!(closed, [("landing".to_owned(), false), ("car".to_owned(), false)]);
    }

    #[test]
    fn every_name_that_is_raised_is_in_the_list_of_names() {
        let mut place = crate::fixture::location(crate::fixture::hall(4.0, 4.0), &[("car", 1.0, 1.0)], &[]);
        place.doors = doors(DoorOpens::Never).doors.into_iter().map(|live| live.door).collect();
        let names = event_names(&place);
        let robot = socrates_model::AgentId::Robot;
        let kinds = [
            EventKind::Gesture { agent: robot, gesture: Some(Gesture::Proceed), to: None },
            EventKind::Leaf { human: socrates_model::HumanId::new(1), leaf: "RegularNav".into() },
            EventKind::Node { agent: robot, node: crate::fixture::id("car") },
            EventKind::Door { door: "d".into(), open: true },
            EventKind::Door { door: "d".into(), open: false },
            EventKind::RobotArrived,
        ];
        for kind in kinds {
            let event = Event { time: socrates_model::SimTime::ZERO, kind };
            let raised = Raised::by(&event, &|_| None).unwrap();
            assert!(names.contains(&raised.name), "{}", raised.name);
        }
    }
}
