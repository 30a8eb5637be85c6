//! Gestures of the robot's script, made whatever planner drives it.

use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Gesture, HumanId};

/// The moment as the script sees it.
#[derive(Debug, Clone)]
pub(crate) struct Cue<'a> {
    pub(crate) now_s: f64,
    pub(crate) dt: f64,
    /// Distance and bearing (from the robot's heading, rad) of humans in line of sight.
    pub(crate) humans: &'a [(HumanId, f64, f64, Option<Gesture>)],
    /// Encounters whose node the robot is at.
    pub(crate) at_encounter: &'a [HumanId],
}

/// The script with the memory of what was said.
#[derive(Debug, Clone)]
pub(crate) struct Script {
    lines: Vec<(RobotWhen, Gesture, f64, bool)>,
}

impl Script {
    pub(crate) fn new(rules: &[RobotRule]) -> Self {
        let say = |rule: &RobotRule| match rule.act {
            RobotDo::Say(gesture) => Some((rule.when.clone(), gesture, 0.0, false)),
            RobotDo::Hold(_)
            | RobotDo::HoldUntil(_)
            | RobotDo::WaitForLeavers
            | RobotDo::Follow(_)
            | RobotDo::Abreast(_)
            | RobotDo::Overtake(_)
            | RobotDo::Lead(_) => None,
        };
        Self { lines: rules.iter().filter_map(say).collect() }
    }

    /// Whether anything is ever said.
    pub(crate) const fn has_lines(&self) -> bool {
        !self.lines.is_empty()
    }

    /// The gesture that begins now, if any. Each line speaks once; a `blocked` line again each time it is blocked anew.
    pub(crate) fn step(&mut self, cue: &Cue<'_>) -> Option<Gesture> {
        let mut spoken = None;
        for (when, gesture, held_s, done) in &mut self.lines {
            let holds = match when {
                RobotWhen::Start => cue.now_s >= 0.5,
                RobotWhen::Blocked(secs) => {
                    let mut humans = cue.humans.iter();
                    let blocked = humans.any(|(_, distance, bearing, _)| RobotWhen::is_blocked_by(*distance, *bearing));
                    *held_s = if blocked { *held_s + cue.dt } else { 0.0 };
                    *done &= blocked;
                    *held_s >= *secs
                }
                RobotWhen::HumanNear(reach) => cue.humans.iter().any(|(_, distance, _, _)| distance <= reach),
                RobotWhen::HumanSays(wanted) => {
                    cue.humans.iter().any(|(_, distance, _, said)| *said == Some(*wanted) && *distance < 10.0)
                }
                RobotWhen::AtEncounter(human) => cue.at_encounter.contains(human),
                RobotWhen::AfterSecs(secs) => cue.now_s >= *secs,
            };
            if holds && !*done && spoken.is_none() {
                *done = true;
                spoken = Some(*gesture);
            }
        }
        spoken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blocked_robot_speaks_after_its_time_and_again_when_blocked_anew() {
        let rule = RobotRule { when: RobotWhen::Blocked(1.0), act: RobotDo::Say(Gesture::ExcuseMe) };
        let mut script = Script::new(&[rule]);
        let near = [(HumanId::new(1), 0.9, 0.1, None)];
        let mut said = 0;
        for step in 0..600 {
            let humans: &[_] = if (200..300).contains(&step) { &[] } else { &near };
            let cue = Cue { now_s: 0.0, dt: 0.01, humans, at_encounter: &[] };
            said += usize::from(script.step(&cue).is_some());
        }
        assert_eq!(said, 2);
    }
}
