//! What those who are driven get to see, and when their drivers are asked.

use std::collections::BTreeMap;

use socrates_model::drive::HumanCue;
use socrates_model::rule::RobotWhen;
use socrates_model::time::STEP_SECS;
use socrates_model::{
    AgentId, Command, Cues, EventKind, Gesture, HumanId, Observation, Point, Pose, RobotDriver, SeenDoor, SeenPerson,
    SeenRobot, SimTime,
};

use crate::doors::{Doors, LiveDoor};
use crate::floor::Floor;
use crate::human::{Human, Meeting};
use crate::lidar::{self, Disc};
use crate::recorder::Recorder;
use crate::robot::Robot;
use crate::run::Engine;
use crate::script::Cue;

/// How long a gesture of a driver is held, s.
pub(crate) const GESTURE_S: f64 = 2.0;

/// Drivers of a run. A robot without one stands, and so does a person who is to be driven and has none.
#[derive(Default)]
pub struct Drivers<'a> {
    /// Of the robot.
    pub robot: Option<&'a mut dyn RobotDriver>,
    /// Of people who are driven: see [`crate::HumanModel::Driven`].
    pub people: BTreeMap<HumanId, &'a mut dyn RobotDriver>,
}

impl<'a> From<Option<&'a mut dyn RobotDriver>> for Drivers<'a> {
    fn from(robot: Option<&'a mut dyn RobotDriver>) -> Self {
        Self { robot, people: BTreeMap::new() }
    }
}

/// Whose eyes a driver looks through, and how they move.
pub(crate) struct Eyes {
    pub(crate) me: AgentId,
    pub(crate) pose: Pose,
    /// Speed forward and to the left, m/s, and turning rate, rad/s.
    pub(crate) moves: (f64, f64, f64),
    /// Range of the scan, m.
    pub(crate) range_m: f64,
}

/// What is around them.
pub(crate) struct Around<'a> {
    pub(crate) floor: &'a Floor,
    pub(crate) doors: &'a Doors,
    pub(crate) humans: &'a [Human],
    /// The robot, where they are not the robot themselves.
    pub(crate) robot: Option<SeenRobot>,
}

/// Whether a driver that was called so often is due.
pub(crate) fn is_due(calls: u64, driver: &dyn RobotDriver, now_s: f64) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "calls of one run")]
    let due_s = calls as f64 / driver.rate_hz().clamp(1.0, 100.0);
    now_s + 1e-9 >= due_s
}

/// Asks a driver: `people` are those in sight.
pub(crate) fn ask(
    driver: &mut dyn RobotDriver,
    now: SimTime,
    eyes: &Eyes,
    around: &Around<'_>,
    people: &[SeenPerson],
    cues: Cues<'_>,
) -> Command {
    let Around { floor, doors, humans, robot } = *around;
    let door = |live: &LiveDoor| SeenDoor {
        id: live.door.id.clone(),
        from: live.door.from,
        to: live.door.to,
        open: live.open,
    };
    let doors: Vec<SeenDoor> = doors.doors.iter().map(door).collect();
    let others = || humans.iter().filter(|human| human.present() && human.agent() != eyes.me);
    let scan = || {
        let mut discs: Vec<Disc> = others().map(|human| Disc { center: human.at, radius_m: human.radius_m }).collect();
        discs.extend(robot.map(|robot| Disc { center: robot.at, radius_m: robot.radius_m }));
        lidar::scan(floor, &eyes.pose, &discs, eyes.range_m)
    };
    let everybody = || others().map(|human| seen_by(eyes.me, human)).collect();
    let (v, vy, omega) = eyes.moves;
    driver.drive(&Observation {
        time: now,
        pose: eyes.pose,
        v,
        vy,
        omega,
        people,
        robot,
        everybody: &everybody,
        doors: &doors,
        lidar: &scan,
        cues,
    })
}

/// Somebody as the one looks at them who is driven.
pub(crate) fn seen_by(me: AgentId, human: &Human) -> SeenPerson {
    SeenPerson {
        id: human.id,
        at: human.at,
        velocity: human.velocity,
        yaw: human.yaw,
        radius_m: human.radius_m,
        // A sign to somebody else is none for them.
        gesture: human.gesture.filter(|_| human.gesture_to.is_none_or(|to| to == me)),
    }
}

impl Engine {
    /// Asks every driver that is due. Whether one of them is gone, and the run over.
    pub(crate) fn ask_drivers(&mut self, drivers: &mut Drivers<'_>, now: SimTime, recorder: &mut Recorder) -> bool {
        if let Some(driver) = drivers.robot.as_deref_mut() {
            self.drive(driver, now, recorder);
            if driver.is_gone() {
                return true;
            }
        }
        drivers.people.iter_mut().any(|(id, driver)| {
            self.drive_person(*id, &mut **driver, now, recorder);
            driver.is_gone()
        })
    }

    /// Asks the planner when it is due, and plays the script's gestures.
    fn drive(&mut self, driver: &mut dyn RobotDriver, now: SimTime, recorder: &mut Recorder) {
        let Some(robot) = &mut self.robot else { return };
        let now_s = now.secs();
        let at = robot.at();
        let due = is_due(robot.calls, driver, now_s);
        // Nobody is looked for while nobody asks.
        let seen: Vec<SeenPerson> = self
            .humans
            .iter()
            .filter(|human| human.present() && (due || self.script.has_lines()))
            .filter(|human| (human.at - at).norm() <= robot.model.lidar_range_m && self.floor.sees(&at, &human.at))
            .map(|human| seen_by(AgentId::Robot, human))
            .collect();
        let bearing =
            |to: &Point| socrates_model::geometry::wrap_angle(libm::atan2(to.y - at.y, to.x - at.x) - robot.pose.yaw);
        let noticed: Vec<(HumanId, f64, f64, Option<Gesture>)> = seen
            .iter()
            .map(|person| (person.id, (person.at - at).norm(), bearing(&person.at), person.gesture))
            .collect();
        let at_encounter: Vec<HumanId> = self
            .humans
            .iter()
            .filter(|human| {
                let apart = |meeting: &Meeting| {
                    let (node, own) = ((meeting.at - at).norm(), (meeting.at - human.at).norm());
                    RobotWhen::at_encounter_m(node, (human.at - at).norm(), own)
                };
                human.meeting().is_some_and(|meeting| apart(meeting) > 0.0)
            })
            .map(|human| human.id)
            .collect();
        let people: Vec<HumanCue> = self
            .humans
            .iter()
            .map(|human| HumanCue { human: human.id, steps_ended: human.steps_ended, is_done: human.is_done() })
            .collect();
        let cue = Cue { now_s, dt: STEP_SECS, humans: &noticed, at_encounter: &at_encounter, people: &people };
        let mut gesture = self.script.step(&cue);
        if due {
            robot.calls += 1;
            // Whoever goes in where the robot does goes before it.
            let awaited = self.humans.iter().zip(&self.timings);
            let awaited =
                awaited.filter(|(human, timing)| human.inside_still() || timing.robot_enters && human.outside_still());
            let leavers_inside = u32::try_from(awaited.count()).unwrap_or(u32::MAX);
            let cues = Cues { leavers_inside, people: &people };
            let eyes = Eyes {
                me: AgentId::Robot,
                pose: robot.pose,
                moves: (robot.v, robot.vy, robot.omega),
                range_m: robot.model.lidar_range_m,
            };
            let around = Around { floor: &self.floor, doors: &self.doors, humans: &self.humans, robot: None };
            robot.command = ask(driver, now, &eyes, &around, &seen, cues);
            gesture = robot.command.gesture.or(gesture);
        }
        if let Some(gesture) = gesture {
            if Some(gesture) != robot.gesture {
                recorder.tell(EventKind::Gesture { agent: AgentId::Robot, gesture: Some(gesture), to: None });
            }
            robot.say(gesture, now_s);
        } else if robot.gesture.is_some() && now_s >= robot.gesture_until_s {
            robot.gesture = None;
            recorder.tell(EventKind::Gesture { agent: AgentId::Robot, gesture: None, to: None });
        }
    }
}

impl Robot {
    /// The robot as a person sees it who is driven.
    pub(crate) fn seen(&self, in_sight: bool) -> SeenRobot {
        let (at, velocity, yaw) = (self.at(), self.velocity, self.pose.yaw);
        SeenRobot { at, velocity, yaw, radius_m: self.model.radius_m, gesture: self.gesture, in_sight }
    }
}
