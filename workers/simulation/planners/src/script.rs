//! The robot's script as `reference` plays it: everything but gestures, which the engine makes for every planner.

use std::collections::BTreeMap;

use socrates_model::geometry::wrap_angle;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::script::ScriptProgress;
use socrates_model::{Gesture, HumanId, Observation, Point, SeenPerson};

/// Shortest stand of a robot that waits, s; a shorter one only slows it down.
const LEAST_STAND_S: f64 = 1.0;
/// A robot slower than this stands, m/s.
const STANDS_MPS: f64 = 0.05;

/// What the script wants now.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Wish {
    /// Stand still.
    pub(crate) hold: bool,
    /// Wait outside until everybody who leaves is out.
    pub(crate) wait_for_leavers: bool,
    /// Keep behind this human.
    pub(crate) follow: Option<HumanId>,
    /// Keep level with this human.
    pub(crate) abreast: Option<HumanId>,
    /// Pass this human.
    pub(crate) overtake: Option<HumanId>,
    /// Wait for followers farther behind than this, m.
    pub(crate) lead_m: Option<f64>,
}

/// The script with its memory.
#[derive(Debug, Clone)]
pub(crate) struct Script {
    progress: ScriptProgress,
    encounters: BTreeMap<HumanId, Point>,
    /// For how long it has to be blocked before it does what it does then, and how long it has been, s; none once it has been, or
    /// where it does nothing then.
    blocked_s: Option<(f64, f64)>,
    /// Remaining time for which it stands, s: a robot that waits is seen to.
    stands_s: f64,
    wish: Wish,
}

impl Script {
    pub(crate) fn new(rules: &[RobotRule], encounters: &BTreeMap<HumanId, Point>) -> Self {
        let blocked = |rule: &RobotRule| if let RobotWhen::Blocked(secs) = rule.when { Some(secs) } else { None };
        let blocked = rules.iter().filter_map(blocked);
        Self {
            progress: ScriptProgress::new(rules),
            encounters: encounters.clone(),
            blocked_s: blocked.reduce(f64::max).map(|secs| (secs, 0.0)),
            stands_s: 0.0,
            wish: Wish::default(),
        }
    }

    /// One call on, `dt` seconds after the last.
    pub(crate) fn step(&mut self, seen: &Observation<'_>, dt: f64) -> Wish {
        let Self { progress, encounters, blocked_s, stands_s, wish } = self;
        if let Some((secs, held_s)) = blocked_s
            && holds(&RobotWhen::Blocked(*secs), held_s, encounters, seen, dt)
        {
            *blocked_s = None;
        }
        let moment = |when: &RobotWhen, held_s: &mut f64| holds(when, held_s, encounters, seen, dt);
        progress.step(seen.time.secs(), moment, |rule| match &rule.act {
            RobotDo::WaitForLeavers => wish.wait_for_leavers = true,
            RobotDo::Follow(human) => wish.follow = Some(*human),
            RobotDo::Abreast(human) => wish.abreast = Some(*human),
            RobotDo::Overtake(human) => wish.overtake = Some(*human),
            RobotDo::Lead(reach) => wish.lead_m = Some(*reach),
            RobotDo::Hold(secs) => *stands_s = stands_s.max(secs.min(LEAST_STAND_S)),
            RobotDo::HoldUntil(_) => *stands_s = stands_s.max(LEAST_STAND_S),
            RobotDo::Say(_) => {}
        });
        let holds = progress.active().any(|rule| matches!(rule.act, RobotDo::Hold(_) | RobotDo::HoldUntil(_)));
        if seen.v.abs() < STANDS_MPS {
            *stands_s = (*stands_s - dt).max(0.0);
        }
        wish.hold = holds || *stands_s > 0.0;
        *wish
    }

    /// Whether it still has something to do for which somebody has to block it.
    pub(crate) const fn is_to_be_blocked(&self) -> bool {
        self.blocked_s.is_some()
    }

    /// Everybody who leaves is out.
    pub(crate) const fn leavers_are_out(&mut self) {
        self.wish.wait_for_leavers = false;
    }
}

/// Whether a moment has come; `held_s` is for how long the robot has been blocked.
fn holds(
    when: &RobotWhen,
    held_s: &mut f64,
    encounters: &BTreeMap<HumanId, Point>,
    seen: &Observation<'_>,
    dt: f64,
) -> bool {
    let at = seen.pose.point();
    match when {
        RobotWhen::Start => true,
        RobotWhen::Blocked(secs) => {
            let blocked = seen.people.iter().any(|person| {
                let to = person.at - at;
                let bearing = wrap_angle(libm::atan2(to.y, to.x) - seen.pose.yaw);
                RobotWhen::is_blocked_by(to.norm(), bearing)
            });
            *held_s = if blocked { *held_s + dt } else { 0.0 };
            *held_s >= *secs
        }
        RobotWhen::HumanNear(reach) => seen.people.iter().any(|person| (person.at - at).norm() <= *reach),
        RobotWhen::Near(human, reach) => {
            seen.people.iter().any(|person| person.id == *human && (person.at - at).norm() <= *reach)
        }
        RobotWhen::HumanSays(gesture) => {
            let near = |person: &SeenPerson| (person.at - at).norm() < Gesture::SEEN_M;
            seen.people.iter().any(|person| person.gesture == Some(*gesture) && near(person))
        }
        RobotWhen::AtEncounter(human) => encounters.get(human).is_some_and(|spot| {
            let person = seen.people.iter().find(|person| person.id == *human);
            let apart = |from: &Point| person.map_or(f64::INFINITY, |person| (person.at - from).norm());
            RobotWhen::at_encounter_m((spot - at).norm(), apart(&at), apart(spot)) > 0.0
        }),
        RobotWhen::AfterSecs(secs) => seen.time.secs() >= *secs,
        RobotWhen::Did(human, step) => seen.cues.people.iter().any(|one| one.has_ended(*human, *step)),
        RobotWhen::Done(human) => seen.cues.people.iter().any(|one| one.human == *human && one.is_done),
        RobotWhen::AfterLine(_) => false,
    }
}
