//! Somebody who is driven from outside: their body obeys commands as an omnidirectional robot's does, within what people can do.

use socrates_model::robot::Kinematics;
use socrates_model::time::STEP_SECS;
use socrates_model::{AgentId, Command, EventKind, HumanId, RobotDriver, RobotModel, SimTime, Vector};

use crate::drive::{Around, Eyes, GESTURE_S, ask, is_due, seen_by};
use crate::gait::{A_MAX, TURN_WALKING, V_MAX};
use crate::human::Human;
use crate::models::Walks;
use crate::motion::Want;
use crate::recorder::Recorder;
use crate::run::Engine;
use crate::view::in_field_of_view;

/// Largest change of a person's turning rate, rad/s²: to the fastest turn in an eighth of a second.
const ALPHA_MAX: f64 = 50.0;
/// Range of the scan that a person's driver may ask for, m: that of most robots.
const SCAN_M: f64 = 12.0;
/// No number of a command counts for more than this, m/s, so that its size can be reckoned.
const TOLD_MPS: f64 = 1e3;
/// Somebody who is told to go slower than this stands, m/s.
const STANDS_MPS: f64 = 0.02;

/// What a person's driver wants, and how often it was asked.
#[derive(Debug, Clone, Default)]
pub(crate) struct Driven {
    command: Command,
    calls: u64,
    gesture_until_s: f64,
}

/// The body of a person as their driver is told it: a disc that goes in every direction, as fast as people do.
#[must_use]
pub fn body_of(id: HumanId, radius_m: f64) -> RobotModel {
    let usual = RobotModel::default();
    RobotModel {
        name: id.to_string().parse().unwrap_or(usual.name),
        kinematics: Kinematics::Omnidirectional,
        radius_m,
        v_max_mps: V_MAX,
        v_min_mps: -V_MAX,
        vy_max_mps: V_MAX,
        a_max_mps2: A_MAX,
        omega_max_radps: TURN_WALKING,
        alpha_max_radps2: ALPHA_MAX,
        lidar_min_m: 0.0,
        lidar_range_m: SCAN_M,
    }
}

impl Human {
    /// Whether a driver outside moves them.
    pub(crate) const fn is_driven(&self) -> bool {
        matches!(self.walks, Walks::Driven(_))
    }

    /// Whether their driver says that they stand on purpose.
    pub(crate) fn waits(&self) -> bool {
        matches!(&self.walks, Walks::Driven(driven) if driven.command.waiting)
    }

    /// What their driver wants this tick; nothing of anybody else.
    pub(crate) fn told(&self) -> Option<Want> {
        let Walks::Driven(driven) = &self.walks else { return None };
        let wish = self.wished(&driven.command);
        let speed_mps = wish.norm();
        Some(if speed_mps > STANDS_MPS { Want::go(self.at + wish, speed_mps) } else { Want::STAND })
    }

    /// The velocity of a command in the map, m/s: held to the fastest that people are, in whatever direction.
    fn wished(&self, command: &Command) -> Vector {
        let number = |value: f64| if value.is_finite() { value.clamp(-TOLD_MPS, TOLD_MPS) } else { 0.0 };
        let heading = self.heading();
        let wish = heading * number(command.v) + Vector::new(-heading.y, heading.x) * number(command.vy);
        wish * (V_MAX / wish.norm().max(V_MAX))
    }

    /// Velocity and turning rate after this tick, before contacts.
    pub(crate) fn obey(&mut self) {
        let Walks::Driven(driven) = &self.walks else { return };
        let command = driven.command;
        let change = self.wished(&command) - self.velocity;
        let most = A_MAX * STEP_SECS;
        self.velocity += change * (most / change.norm().max(most));
        let omega = if command.omega.is_finite() { command.omega.clamp(-TURN_WALKING, TURN_WALKING) } else { 0.0 };
        let swing = ALPHA_MAX * STEP_SECS;
        self.omega += (omega - self.omega).clamp(-swing, swing);
    }
}

impl Engine {
    /// Asks the driver of a person when it is due, and has them make its gestures.
    pub(crate) fn drive_person(
        &mut self,
        id: HumanId,
        driver: &mut dyn RobotDriver,
        now: SimTime,
        recorder: &mut Recorder,
    ) {
        let now_s = now.secs();
        let Some(place) = self.humans.iter().position(|human| human.id == id && human.is_driven()) else { return };
        let asked = match self.humans.get(place).map(|human| &human.walks) {
            Some(Walks::Driven(driven)) if is_due(driven.calls, driver, now_s) => Some(self.asked(place, driver, now)),
            Some(_) | None => None,
        };
        let Some(human) = self.humans.get_mut(place) else { return };
        let Walks::Driven(driven) = &mut human.walks else { return };
        let mut gesture = None;
        if let Some(command) = asked {
            driven.calls += 1;
            driven.command = command;
            gesture = command.gesture;
        }
        let agent = AgentId::Human(id);
        if let Some(gesture) = gesture {
            driven.gesture_until_s = now_s + GESTURE_S;
            if human.gesture != Some(gesture) {
                human.gesture = Some(gesture);
                recorder.tell(EventKind::Gesture { agent, gesture: human.gesture, to: None });
            }
        } else if human.gesture.is_some() && now_s >= driven.gesture_until_s {
            human.gesture = None;
            recorder.tell(EventKind::Gesture { agent, gesture: None, to: None });
        }
    }

    /// The command for what somebody has before their eyes.
    fn asked(&self, place: usize, driver: &mut dyn RobotDriver, now: SimTime) -> Command {
        let Some(human) = self.humans.get(place) else { return Command::default() };
        let heading = human.heading();
        let in_sight =
            |at: &socrates_model::Point| in_field_of_view(&heading, &(at - human.at)) && self.floor.sees(&human.at, at);
        let others = self.humans.iter().filter(|other| other.id != human.id && other.present());
        let people: Vec<_> =
            others.filter(|other| in_sight(&other.at)).map(|other| seen_by(human.agent(), other)).collect();
        let robot = self.robot.as_ref().map(|robot| robot.seen(in_sight(&robot.at())));
        let left = Vector::new(-heading.y, heading.x);
        let eyes = Eyes {
            me: human.agent(),
            pose: socrates_model::Pose::new(human.at.x, human.at.y, human.yaw),
            moves: (human.velocity.dot(&heading), human.velocity.dot(&left), human.omega),
            range_m: SCAN_M,
        };
        let around = Around { floor: &self.floor, doors: &self.doors, humans: &self.humans, robot };
        ask(driver, now, &eyes, &around, &people, socrates_model::Cues::default())
    }
}
