//! Checks of rules by themselves, before there is a tree.

use socrates_model::{Action, Fault, FaultCode, HumanId, Rule, Trigger, Where};

/// Smallest and largest distance a rule may name, m.
const METERS: std::ops::RangeInclusive<f64> = 0.3..=15.0;
/// Longest time a rule may name, s.
const MAX_SECS: f64 = 3600.0;

/// Faults of a rule list: `B-RANGE` for values, `B-CONTRA` for rules that want different things at once.
pub(crate) fn check(human: HumanId, rules: &[Rule]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (place, rule) in rules.iter().enumerate() {
        let at = Where::rule(human, place + 1);
        for trigger in rule.when.iter().chain(&rule.until) {
            values(human, trigger, &at, &mut faults);
        }
        if rule.act == Action::FollowHuman(human) {
            faults.push(Fault::new(FaultCode::BRange, &at, format!("{human} cannot follow itself")));
        }
        if rule.act == Action::LookAt(human) || rule.to == Some(human.into()) {
            faults.push(Fault::new(FaultCode::BRange, &at, format!("{human} cannot turn to itself")));
        }
        if let Some(secs) = rule.for_s
            && !(secs > 0.0 && secs <= MAX_SECS)
        {
            let message = format!("for_s is `{secs}`; allowed: above 0 and at most {MAX_SECS} s");
            faults.push(Fault::new(FaultCode::BRange, &at, message));
        }
        // Two rules of one trigger may follow each other in time, but not without an end of the first.
        for (before, earlier) in rules.iter().take(place).enumerate() {
            if earlier.for_s.is_none()
                && earlier.step.is_none()
                && earlier.act != rule.act
                && same_triggers(earlier, rule)
            {
                let message = format!(
                    "{} it should do two things: rule {} says it {}, rule {} says it {}; give the first an end (for_s) or another trigger",
                    when(rule),
                    before + 1,
                    earlier.act.phrase(),
                    place + 1,
                    rule.act.phrase()
                );
                faults.push(Fault::new(FaultCode::BContra, &at, message));
            }
        }
    }
    faults
}

fn values(human: HumanId, trigger: &Trigger, at: &Where, faults: &mut Vec<Fault>) {
    match trigger {
        Trigger::RobotVisible(m) | Trigger::RobotNear(m) | Trigger::RobotBlocking(m) => {
            if !METERS.contains(m) {
                let message = format!("the distance is `{m}`; allowed: {} to {} m", METERS.start(), METERS.end());
                faults.push(Fault::new(FaultCode::BRange, at, message));
            }
        }
        Trigger::AfterSecs(secs) | Trigger::StoppedFor(secs) => {
            if !(*secs > 0.0 && *secs <= MAX_SECS) {
                let message = format!("the time is `{secs}`; allowed: above 0 and at most {MAX_SECS} s");
                faults.push(Fault::new(FaultCode::BRange, at, message));
            }
        }
        Trigger::HumanSays(id, _) => {
            if *id == human {
                faults.push(Fault::new(FaultCode::BRange, at, format!("{human} cannot wait for their own gesture")));
            }
        }
        Trigger::Did(_, step) => {
            if *step == 0 {
                faults.push(Fault::new(FaultCode::BRange, at, "steps are counted from 1"));
            }
        }
        Trigger::Done(id) => {
            if *id == human {
                faults.push(Fault::new(FaultCode::BRange, at, format!("{human} cannot wait for all their own steps")));
            }
        }
        Trigger::Always
        | Trigger::RobotMoving
        | Trigger::RobotStopped
        | Trigger::RobotPassed
        | Trigger::RobotSays(_)
        | Trigger::GoalReached
        | Trigger::AtEncounter => {}
    }
}

/// Triggers that are really asked: `Always` asks nothing.
pub(crate) fn asked(rule: &Rule) -> impl Iterator<Item = &Trigger> {
    rule.when.iter().filter(|trigger| **trigger != Trigger::Always)
}

/// Whether a rule holds from the start to the end of a run, so that no later one ever runs.
pub(crate) fn is_endless(rule: &Rule) -> bool {
    asked(rule).next().is_none() && rule.for_s.is_none() && rule.until.is_empty()
}

fn same_triggers(a: &Rule, b: &Rule) -> bool {
    asked(a).all(|trigger| b.when.contains(trigger)) && asked(b).all(|trigger| a.when.contains(trigger))
}

/// The triggers in words.
pub(crate) fn when(rule: &Rule) -> String {
    let phrases: Vec<String> = asked(rule).map(Trigger::phrase).collect();
    if phrases.is_empty() { Trigger::Always.phrase() } else { phrases.join(" and ") }
}

/// What ends a step, in words.
pub(crate) fn until(rule: &Rule) -> String {
    let phrases: Vec<String> = rule.until.iter().map(Trigger::clause).collect();
    phrases.join(" and ")
}
