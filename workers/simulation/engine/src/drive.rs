//! What the robot's planner gets to see, and when it is asked.

use socrates_model::time::STEP_SECS;
use socrates_model::{
    AgentId, Cues, EventKind, Gesture, HumanId, Observation, Point, RobotDriver, SeenDoor, SeenPerson, SimTime,
};

use crate::human::Human;
use crate::lidar::{self, Disc};
use crate::recorder::Recorder;
use crate::run::Engine;
use crate::script::Cue;

impl Engine {
    /// Asks the planner when it is due, and plays the script's gestures.
    pub(crate) fn drive(&mut self, driver: &mut dyn RobotDriver, now: SimTime, recorder: &mut Recorder) {
        let Some(robot) = &mut self.robot else { return };
        let now_s = now.secs();
        let at = robot.at();
        #[expect(clippy::cast_precision_loss, reason = "calls of one run")]
        let due_s = robot.calls as f64 / driver.rate_hz().clamp(1.0, 100.0);
        let due = now_s + 1e-9 >= due_s;
        // Nobody is looked for while nobody asks.
        let seen: Vec<SeenPerson> = self
            .humans
            .iter()
            .filter(|human| human.present() && (due || self.script.has_lines()))
            .filter(|human| (human.at - at).norm() <= robot.model.lidar_range_m && self.floor.sees(&at, &human.at))
            .map(seen)
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
            .filter(|human| human.meeting().is_some_and(|meeting| (meeting.at - at).norm() < 1.0))
            .map(|human| human.id)
            .collect();
        let mut gesture =
            self.script.step(&Cue { now_s, dt: STEP_SECS, humans: &noticed, at_encounter: &at_encounter });
        if due {
            robot.calls += 1;
            let doors: Vec<SeenDoor> = self
                .doors
                .doors
                .iter()
                .map(|live| SeenDoor {
                    id: live.door.id.clone(),
                    from: live.door.from,
                    to: live.door.to,
                    open: live.open,
                })
                .collect();
            let disc = |human: &Human| Disc { center: human.at, radius_m: human.radius_m };
            let discs: Vec<Disc> = self.humans.iter().filter(|human| human.present()).map(disc).collect();
            let (floor, pose, range) = (&self.floor, robot.pose, robot.model.lidar_range_m);
            let scan = || lidar::scan(floor, &pose, &discs, range);
            let humans = &self.humans;
            let everybody = || humans.iter().filter(|human| human.present()).map(self::seen).collect();
            // Whoever goes in where the robot does goes before it.
            let awaited = self.humans.iter().zip(&self.timings);
            let awaited =
                awaited.filter(|(human, timing)| human.inside_still() || timing.robot_enters && human.outside_still());
            let leavers = awaited.count();
            robot.command = driver.drive(&Observation {
                time: now,
                pose,
                v: robot.v,
                vy: robot.vy,
                omega: robot.omega,
                people: &seen,
                everybody: &everybody,
                doors: &doors,
                lidar: &scan,
                cues: Cues { leavers_inside: u32::try_from(leavers).unwrap_or(u32::MAX) },
            });
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

fn seen(human: &Human) -> SeenPerson {
    SeenPerson {
        id: human.id,
        at: human.at,
        velocity: human.velocity,
        yaw: human.yaw,
        radius_m: human.radius_m,
        // A sign to a human is none for the robot.
        gesture: human.gesture.filter(|_| !matches!(human.gesture_to, Some(AgentId::Human(_)))),
    }
}
