//! The robot's script as `reference` plays it: everything but gestures, which the engine makes for every planner.

use std::collections::BTreeMap;

use socrates_model::geometry::wrap_angle;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{HumanId, Observation, Point};

/// Within this distance of an encounter the robot is at it, m.
const AT_ENCOUNTER_M: f64 = 1.0;

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
    lines: Vec<(RobotRule, f64, bool)>,
    encounters: BTreeMap<HumanId, Point>,
    hold_until_s: f64,
    /// What it waits for, with its memory of being blocked, s.
    waits_for: Option<(RobotWhen, f64)>,
    /// For how long it has to be blocked before it does what it does then, and how long it has been, s; none once it has been, or
    /// where it does nothing then.
    blocked_s: Option<(f64, f64)>,
    wish: Wish,
}

impl Script {
    pub(crate) fn new(rules: &[RobotRule], encounters: &BTreeMap<HumanId, Point>) -> Self {
        let lines =
            rules.iter().filter(|rule| !matches!(rule.act, RobotDo::Say(_))).map(|rule| (rule.clone(), 0.0, false));
        let blocked = rules.iter().filter_map(|rule| match rule.when {
            RobotWhen::Blocked(secs) => Some(secs),
            RobotWhen::Start
            | RobotWhen::HumanNear(_)
            | RobotWhen::HumanSays(_)
            | RobotWhen::AtEncounter(_)
            | RobotWhen::AfterSecs(_) => None,
        });
        Self {
            lines: lines.collect(),
            encounters: encounters.clone(),
            hold_until_s: 0.0,
            waits_for: None,
            blocked_s: blocked.reduce(f64::max).map(|secs| (secs, 0.0)),
            wish: Wish::default(),
        }
    }

    /// One call on, `dt` seconds after the last.
    pub(crate) fn step(&mut self, seen: &Observation<'_>, dt: f64) -> Wish {
        let now = seen.time.secs();
        let encounters = &self.encounters;
        if let Some((secs, held_s)) = &mut self.blocked_s
            && holds(&RobotWhen::Blocked(*secs), held_s, encounters, seen, dt)
        {
            self.blocked_s = None;
        }
        if let Some((until, held_s)) = &mut self.waits_for
            && (holds(until, held_s, encounters, seen, dt) || now >= self.hold_until_s)
        {
            (self.waits_for, self.hold_until_s) = (None, now);
        }
        for (rule, held_s, done) in &mut self.lines {
            let holds = holds(&rule.when, held_s, encounters, seen, dt);
            if !holds || *done {
                continue;
            }
            *done = true;
            match &rule.act {
                RobotDo::Hold(secs) => self.hold_until_s = self.hold_until_s.max(now + secs),
                RobotDo::HoldUntil(until) => {
                    self.waits_for = Some((until.clone(), 0.0));
                    self.hold_until_s = now + RobotDo::HOLD_MOST_S;
                }
                RobotDo::WaitForLeavers => self.wish.wait_for_leavers = true,
                RobotDo::Follow(human) => self.wish.follow = Some(*human),
                RobotDo::Abreast(human) => self.wish.abreast = Some(*human),
                RobotDo::Overtake(human) => self.wish.overtake = Some(*human),
                RobotDo::Lead(reach) => self.wish.lead_m = Some(*reach),
                RobotDo::Say(_) => {}
            }
        }
        self.wish.hold = now < self.hold_until_s;
        self.wish
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
        RobotWhen::HumanSays(gesture) => {
            seen.people.iter().any(|person| person.gesture == Some(*gesture) && (person.at - at).norm() < 10.0)
        }
        RobotWhen::AtEncounter(human) => encounters.get(human).is_some_and(|spot| (spot - at).norm() < AT_ENCOUNTER_M),
        RobotWhen::AfterSecs(secs) => seen.time.secs() >= *secs,
    }
}
