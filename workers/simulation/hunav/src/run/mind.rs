//! What the tree of one agent sees and does: the leaves of every library, in the meaning of the profile.

use socrates_bt::{LeafCall, Status, World};
use socrates_model::{Action, Gesture, HumanId, SimTime};

use super::agent::Memory;
use super::leaves::{MOTIONS, motion};
use super::scene::{Deed, Scene, Target, bearing};
use super::upstream;
use super::{leaves_2, scene};

/// Half angle within which a robot ahead blocks the way, rad.
const BLOCKING_RAD: f64 = 0.5;

/// The mind of one agent for one tick.
pub(crate) struct Mind<'a> {
    pub(crate) scene: &'a mut Scene,
    pub(crate) me: usize,
    /// What it does, where motion is not done at once.
    pub(crate) deed: Option<Deed>,
    /// The last leaf that moved it.
    pub(crate) leaf: u16,
    /// The gesture it makes, seen by others from the next tick on.
    pub(crate) gesture: Option<i64>,
}

impl Mind<'_> {
    /// Does something for this tick; natively the first deed of a tick counts and waits for everybody's.
    pub(crate) fn act(&mut self, tag: &str, deed: Deed) {
        let leaf = MOTIONS.iter().position(|name| *name == tag).and_then(|at| u16::try_from(at).ok()).unwrap_or(0);
        if self.scene.rules.native {
            if self.deed.is_none() {
                self.deed = Some(deed);
                self.leaf = leaf;
            }
        } else {
            upstream::perform(self.scene, self.me, deed);
            self.leaf = leaf;
        }
    }

    /// Memory of a leaf.
    pub(crate) fn memory(&mut self, leaf: u16) -> Option<&mut Memory> {
        self.scene.agents.get_mut(self.me).map(|agent| agent.memory.entry(leaf).or_default())
    }

    /// Seconds since a running leaf began.
    pub(crate) fn elapsed_s(&mut self, call: &LeafCall<'_>) -> f64 {
        let now_s = self.scene.now_s;
        let starts = !call.is_running();
        self.memory(call.leaf()).map_or(0.0, |memory| {
            if starts {
                memory.since_s = now_s;
            }
            now_s - memory.since_s
        })
    }

    /// A timer that adds its step at every tick it gets, as upstream adds it.
    fn timer(&mut self, call: &LeafCall<'_>) -> Status {
        let (Some(seconds), once) = (real(call, "seconds"), flag(call, "only_once").unwrap_or(false)) else {
            return Status::Failure;
        };
        let step_s = real(call, "ts").unwrap_or(self.scene.dt);
        let Some(memory) = self.memory(call.leaf()) else { return Status::Failure };
        if memory.fired {
            return Status::Success;
        }
        memory.counted_s += step_s;
        if memory.counted_s < seconds {
            return Status::Failure;
        }
        memory.fired = once;
        memory.counted_s = 0.0;
        Status::Success
    }

    fn condition(&mut self, call: &LeafCall<'_>) -> Option<Status> {
        let me = self.me;
        let within = |call: &LeafCall<'_>| real(call, "distance").unwrap_or(0.0);
        let holds = match call.tag() {
            "IsRobotVisible" => self.scene.sees_robot(me, within(call)).is_some(),
            "IsRobotNearby" => self.scene.distance_m(me, Target::Robot).is_some_and(|m| m <= within(call)),
            "IsRobotBlocking" => self.robot_blocking(within(call)),
            "RobotMoved" => self.scene.robot_moved(),
            "RobotSays" => int(call, "message") == Some(i64::from(Gesture::code_of(self.robot_gesture()))),
            "HumanSays" => {
                let index = int(call, "target_id")
                    .and_then(|target| usize::try_from(target - self.scene.rules.first_human).ok());
                let shown = index.and_then(|index| self.scene.agents.get(index)).map(|agent| agent.shown);
                shown.is_some() && shown == int(call, "message")
            }
            "IsGoalReached" => self.goal_reached(),
            "TimeExpiredCondition" if !self.scene.rules.native => return Some(self.timer(call)),
            _ => return None,
        };
        Some(Status::of(holds))
    }
}

/// Number in the port of this name.
pub(crate) fn real(call: &LeafCall<'_>, port: &str) -> Option<f64> {
    call.real(place(call, port)?).filter(|value| value.is_finite())
}

/// Whole number in the port of this name.
pub(crate) fn int(call: &LeafCall<'_>, port: &str) -> Option<i64> {
    let port = place(call, port)?;
    #[expect(clippy::cast_possible_truncation, reason = "ids and codes that scripts wrote as numbers are small")]
    call.int(port).or_else(|| call.real(port).map(|value| value as i64))
}

/// Truth value in the port of this name.
pub(crate) fn flag(call: &LeafCall<'_>, port: &str) -> Option<bool> {
    call.flag(place(call, port)?)
}

/// Place of the port of this name.
pub(crate) fn place(call: &LeafCall<'_>, port: &str) -> Option<usize> {
    call.sheet().ports.iter().position(|sheet| sheet.name == port)
}

impl World for Mind<'_> {
    fn leaf(&mut self, call: &mut LeafCall<'_>) -> Option<Status> {
        if let Some(status) = self.condition(call) {
            return Some(status);
        }
        match call.tag() {
            "UpdateGoal" => self.next_goal(),
            "MakeGesture" => self.gesture = int(call, "message"),
            _ => {
                if let Some(status) = leaves_2::tick(self, call) {
                    return Some(status);
                }
                let deed = motion(self.scene, self.me, call)?;
                self.act(call.tag(), deed);
            }
        }
        Some(Status::Success)
    }

    fn robot_distance_m(&self) -> Option<f64> {
        self.scene.distance_m(self.me, Target::Robot)
    }

    fn robot_visible(&self, within_m: f64) -> bool {
        self.scene.sees_robot(self.me, within_m).is_some()
    }

    fn robot_blocking(&self, within_m: f64) -> bool {
        let Some(agent) = self.scene.agents.get(self.me) else { return false };
        self.scene.place(Target::Robot).is_some_and(|robot| {
            (robot - agent.at).norm() <= within_m
                && scene::bearing(&agent.at, agent.yaw, &robot).abs() <= BLOCKING_RAD
                && (!self.scene.rules.sight || self.scene.floor.sees(&agent.at, &robot))
        })
    }

    fn robot_moving(&self) -> bool {
        self.scene.robot_moved()
    }

    fn robot_gesture(&self) -> Option<Gesture> {
        self.scene.robot.as_ref().and_then(|robot| robot.gesture)
    }

    fn human_gesture(&self, id: HumanId) -> Option<Gesture> {
        let shown = self.scene.agents.iter().find(|agent| agent.human == id).map_or(0, |agent| agent.shown);
        u8::try_from(shown).ok().and_then(|code| Gesture::from_code(code).ok()).flatten()
    }

    fn goal_reached(&self) -> bool {
        self.scene.agents.get(self.me).is_some_and(super::agent::Agent::at_goal)
    }

    fn path_done(&self) -> bool {
        self.goal_reached() && self.scene.agents.get(self.me).is_some_and(|agent| agent.goals.len() == 1)
    }

    fn next_goal(&mut self) {
        let keep = self.scene.rules.keeps_last_goal;
        self.scene.take_goal(self.me, keep);
    }

    fn at_encounter(&self) -> bool {
        // An agents file has no encounters.
        false
    }

    fn now(&self) -> SimTime {
        SimTime::at_tick(super::tick_of(self.scene.now_s))
    }

    fn step_s(&self) -> f64 {
        self.scene.dt
    }

    fn act(&mut self, action: &Action, _leaf: u16) {
        // Every motion is answered as a leaf; this is for one that a newer catalog adds.
        if matches!(action, Action::StandStill) {
            Mind::act(self, "StandStill", Deed::Stand);
        }
    }

    fn gesture(&mut self, gesture: Option<Gesture>) {
        self.gesture = Some(i64::from(Gesture::code_of(gesture)));
    }
}

/// Whether an agent faces a point to within an angle.
pub(crate) fn faces(scene: &Scene, who: Target, to: Target, within_rad: f64) -> bool {
    match (scene.place(who), scene.place(to)) {
        (Some(from), Some(to)) => bearing(&from, scene.yaw(who), &to).abs() <= within_rad,
        (None, _) | (_, None) => false,
    }
}
