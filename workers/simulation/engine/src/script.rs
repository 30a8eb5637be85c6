//! Gestures of the robot's script, made whatever planner drives it.

use socrates_model::drive::HumanCue;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::script::ScriptProgress;
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
    /// How far everybody is with their steps.
    pub(crate) people: &'a [HumanCue],
}

/// The script with the memory of what was said.
#[derive(Debug, Clone)]
pub(crate) struct Script {
    progress: ScriptProgress,
    speaks: bool,
}

impl Script {
    pub(crate) fn new(rules: &[RobotRule]) -> Self {
        let speaks = rules.iter().any(|rule| matches!(rule.act, RobotDo::Say(_)));
        Self { progress: ScriptProgress::new(rules), speaks }
    }

    /// Whether anything is ever said.
    pub(crate) const fn has_lines(&self) -> bool {
        self.speaks
    }

    /// The gesture that begins now, if any. Each line speaks once; a `blocked` line again each time it is blocked again.
    pub(crate) fn step(&mut self, cue: &Cue<'_>) -> Option<Gesture> {
        if !self.speaks {
            return None;
        }
        let holds = |when: &RobotWhen, held_s: &mut f64| match when {
            RobotWhen::Start => cue.now_s >= 0.5,
            RobotWhen::Blocked(secs) => {
                let mut humans = cue.humans.iter();
                let blocked = humans.any(|(_, distance, bearing, _)| RobotWhen::is_blocked_by(*distance, *bearing));
                *held_s = if blocked { *held_s + cue.dt } else { 0.0 };
                *held_s >= *secs
            }
            RobotWhen::HumanNear(reach) => cue.humans.iter().any(|(_, distance, _, _)| distance <= reach),
            RobotWhen::Near(human, reach) => {
                cue.humans.iter().any(|(id, distance, _, _)| id == human && distance <= reach)
            }
            RobotWhen::HumanSays(wanted) => {
                cue.humans.iter().any(|(_, distance, _, said)| *said == Some(*wanted) && *distance < Gesture::SEEN_M)
            }
            RobotWhen::AtEncounter(human) => cue.at_encounter.contains(human),
            RobotWhen::AfterSecs(secs) => cue.now_s >= *secs,
            RobotWhen::Did(human, step) => cue.people.iter().any(|one| one.has_ended(*human, *step)),
            RobotWhen::Done(human) => cue.people.iter().any(|one| one.human == *human && one.is_done),
            RobotWhen::AfterLine(_) => false,
        };
        let mut spoken = None;
        self.progress.step(cue.now_s, holds, |rule| {
            if let RobotDo::Say(gesture) = rule.act {
                spoken = Some(gesture);
            }
        });
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
            let cue = Cue { now_s: 0.0, dt: 0.01, humans, at_encounter: &[], people: &[] };
            said += usize::from(script.step(&cue).is_some());
        }
        assert_eq!(said, 2);
    }
}
