//! How far the lines of the robot's script have come: one memory for whoever plays a part of it.
//!
//! ```text
//! moment (line before over, a person near, a sign …) ─► begins ─► over: after its time, at the moment that it waits for, or at once
//! ```

use crate::rule::{RobotDo, RobotRule, RobotWhen};

/// A line with its memory.
#[derive(Debug, Clone)]
struct ScriptLine {
    rule: RobotRule,
    /// Time for which the robot has been blocked, s, for the line's moment and for the end of its wait.
    held_s: f64,
    until_s: f64,
    begun_s: Option<f64>,
    over: bool,
}

/// The lines of a script, followed through a run.
#[derive(Debug, Clone)]
pub struct ScriptProgress {
    lines: Vec<ScriptLine>,
}

impl ScriptProgress {
    /// A script of which nothing has begun.
    #[must_use]
    pub fn new(rules: &[RobotRule]) -> Self {
        let line =
            |rule: &RobotRule| ScriptLine { rule: rule.clone(), held_s: 0.0, until_s: 0.0, begun_s: None, over: false };
        Self { lines: rules.iter().map(line).collect() }
    }

    /// The lines that have begun and are not over.
    pub fn active(&self) -> impl Iterator<Item = &RobotRule> {
        self.lines.iter().filter(|line| line.begun_s.is_some() && !line.over).map(|line| &line.rule)
    }

    /// One moment on. `holds` tells whether a moment has come, with its memory of being blocked, s; it is not asked for
    /// [`RobotWhen::AfterLine`]. `begins` is called with each line that begins, once; a sign that waits for being blocked begins again each time the
    /// robot is blocked again.
    pub fn step(
        &mut self,
        now_s: f64,
        mut holds: impl FnMut(&RobotWhen, &mut f64) -> bool,
        mut begins: impl FnMut(&RobotRule),
    ) {
        for place in 0..self.lines.len() {
            let speaks = self.active().any(|rule| matches!(rule.act, RobotDo::Say(_)));
            let before = self.is_over_before(place);
            let Some(line) = self.lines.get_mut(place) else { continue };
            if let Some(begun_s) = line.begun_s.filter(|begun_s| !line.over && *begun_s < now_s) {
                let ends = if let RobotDo::HoldUntil(until) = &line.rule.act {
                    holds(until, &mut line.until_s)
                } else {
                    false
                };
                line.over = ends || now_s >= begun_s + line.rule.act.longest_s();
            }
            let follows = matches!(line.rule.when, RobotWhen::AfterLine(_));
            let comes = if follows { before } else { holds(&line.rule.when, &mut line.held_s) };
            let anew = matches!((&line.rule.when, &line.rule.act), (RobotWhen::Blocked(_), RobotDo::Say(_)));
            if anew && line.held_s <= 0.0 {
                line.begun_s = None;
            }
            // One sign after the other.
            let waits = speaks && matches!(line.rule.act, RobotDo::Say(_));
            if comes && !waits && line.begun_s.is_none() {
                line.begun_s = Some(now_s);
                begins(&line.rule);
            }
        }
    }

    /// Whether the line is over after which another begins.
    fn is_over_before(&self, place: usize) -> bool {
        let when = self.lines.get(place).map(|line| &line.rule.when);
        let Some(RobotWhen::AfterLine(number)) = when else { return false };
        let before = usize::try_from(*number).ok().and_then(|number| number.checked_sub(1));
        before.and_then(|before| self.lines.get(before)).is_some_and(|line| line.over)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gesture::Gesture;

    #[test]
    fn a_line_begins_once_the_one_before_it_is_over() {
        let says = RobotDo::Say(Gesture::Proceed);
        let script = [
            RobotRule { when: RobotWhen::HumanNear(3.0), act: RobotDo::Hold(2.0) },
            RobotRule { when: RobotWhen::AfterLine(1), act: says.clone() },
            RobotRule {
                when: RobotWhen::AfterLine(2),
                act: RobotDo::HoldUntil(RobotWhen::HumanSays(Gesture::Proceed)),
            },
        ];
        let mut progress = ScriptProgress::new(&script);
        let mut begun = Vec::new();
        for tick in 0..100_u32 {
            let now_s = f64::from(tick) * 0.1;
            let holds = |when: &RobotWhen, _: &mut f64| {
                let near = matches!(when, RobotWhen::HumanNear(_)) && now_s >= 1.0;
                near || matches!(when, RobotWhen::HumanSays(_)) && now_s >= 8.0
            };
            progress.step(now_s, holds, |rule| begun.push((now_s, rule.act.clone())));
            let stands = progress.active().any(|rule| !matches!(rule.act, RobotDo::Say(_)));
            assert_eq!(stands, (1.0..2.95).contains(&now_s) || (5.0..7.95).contains(&now_s), "{now_s}");
        }
        let at: Vec<u32> = begun.iter().map(|(t, _)| (t * 10.0).round() as u32).collect();
        assert_eq!(at, [10, 30, 50]);
        assert_eq!(begun[1].1, says);
    }

    #[test]
    fn a_sign_of_a_blocked_robot_is_made_again_when_it_is_blocked_again() {
        let rule = RobotRule { when: RobotWhen::Blocked(1.0), act: RobotDo::Say(Gesture::ExcuseMe) };
        let mut progress = ScriptProgress::new(&[rule]);
        let mut begun = 0;
        for tick in 0..60_u32 {
            let blocked = tick % 30 < 20;
            let holds = |_: &RobotWhen, held_s: &mut f64| {
                *held_s = if blocked { *held_s + 0.1 } else { 0.0 };
                *held_s >= 1.0 - 1e-9
            };
            progress.step(f64::from(tick) * 0.1, holds, |_| begun += 1);
        }
        assert_eq!(begun, 2);
    }
}
