//! Doors that open and close.

use socrates_model::{Door, DoorOpens, Location, Point, Vector};

/// Nobody within this distance of the door line lets it close, m.
const CLOSING_REACH_M: f64 = 1.0;
/// Somebody slower than this does not come to a door, m/s.
const COMING_MPS: f64 = 0.05;

/// Somebody as doors see them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passer {
    pub(crate) at: Point,
    pub(crate) velocity: Vector,
    pub(crate) robot: bool,
}

/// One door of the run.
#[derive(Debug, Clone)]
pub(crate) struct LiveDoor {
    pub(crate) door: Door,
    pub(crate) open: bool,
    idle_s: f64,
    fired: bool,
}

/// All doors of the run.
#[derive(Debug, Clone)]
pub(crate) struct Doors {
    pub(crate) doors: Vec<LiveDoor>,
}

impl Doors {
    pub(crate) fn new(location: &Location) -> Self {
        let live = |door: &Door| LiveDoor {
            door: door.clone(),
            open: door.opens == DoorOpens::Always,
            idle_s: 0.0,
            fired: false,
        };
        Self { doors: location.doors.iter().map(live).collect() }
    }

    /// Lines that are closed now.
    pub(crate) fn closed(&self) -> Vec<(Point, Point)> {
        self.doors.iter().filter(|live| !live.open).map(|live| (live.door.from, live.door.to)).collect()
    }

    /// One tick on; `raised` are the names of events of this tick. Gives back the doors that changed.
    pub(crate) fn step(
        &mut self,
        now_s: f64,
        dt: f64,
        passers: &[Passer],
        raised: &[(String, Point)],
    ) -> Vec<(String, bool)> {
        let mut changed = Vec::new();
        for live in &mut self.doors {
            let wanted = live.wanted(now_s, passers, raised);
            let near = passers.iter().any(|passer| {
                socrates_model::geometry::nearest_on_segment(&passer.at, &live.door.from, &live.door.to).0
                    < CLOSING_REACH_M
            });
            live.idle_s = if near || wanted { 0.0 } else { live.idle_s + dt };
            let open = live.door.opens == DoorOpens::Always || wanted || live.open && live.idle_s < live.door.hold_s;
            if open != live.open {
                live.open = open;
                changed.push((live.door.id.clone(), open));
            }
        }
        changed
    }
}

impl LiveDoor {
    fn wanted(&mut self, now_s: f64, passers: &[Passer], raised: &[(String, Point)]) -> bool {
        let middle = self.door.middle();
        let comes = |passer: &Passer, reach: f64| {
            let way = middle - passer.at;
            way.norm() <= reach && (passer.robot || passer.velocity.dot(&way) > COMING_MPS * way.norm().min(1.0))
        };
        match &self.door.opens {
            DoorOpens::Always => true,
            DoorOpens::Never => false,
            DoorOpens::AtTime(at_s) => {
                let due = now_s >= *at_s && !self.fired;
                self.fired |= due;
                due
            }
            DoorOpens::Near(reach) => passers.iter().any(|passer| comes(passer, *reach)),
            DoorOpens::RobotNear(reach) => {
                passers.iter().any(|passer| passer.robot && (passer.at - middle).norm() <= *reach)
            }
            // An event is raised for one spot: the door nearest to it answers, others of that name far away stay shut.
            DoorOpens::OnEvent(name) => raised.iter().any(|(event, at)| event == name && (at - middle).norm() < 4.0),
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
        Doors { doors: vec![LiveDoor { door, open: false, idle_s: 0.0, fired: false }] }
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
    fn a_door_opens_at_its_time_once() {
        let mut doors = doors(DoorOpens::AtTime(1.0));
        assert!(doors.step(0.5, 0.01, &[], &[]).is_empty());
        assert_eq!(doors.step(1.0, 0.01, &[], &[]).len(), 1);
        let closes = (0..300).filter(|_| !doors.step(1.1, 0.01, &[], &[]).is_empty()).count();
        assert_eq!(closes, 1);
    }
}
