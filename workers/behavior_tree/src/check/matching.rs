//! Whether a tree does what the proposal asks, no less and no more.

use socrates_model::{Action, Fault, FaultCode, Rule, Trigger, Where};

use crate::check::CheckContext;
use crate::check::atoms::Atom;
use crate::check::cases::{Case, Cases};
use crate::rules::{asked, when};

/// Two numbers of a rule and a tree are the same within this.
const SAME: f64 = 1e-6;

/// `B-MATCH` for a missing or surplus action, trigger or gesture, `B-TIMER` for a timer that delays what it
/// should limit.
pub(super) fn check(cases: &Cases<'_>, ctx: &CheckContext<'_>) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (place, rule) in ctx.rules.iter().enumerate() {
        let at = Where::rule(ctx.human, place + 1);
        if let Some((code, message)) = mismatch(cases, ctx.rules, rule) {
            faults.push(Fault::new(code, at, message));
        }
    }
    // Which comes first is only asked of a tree that does each.
    if faults.is_empty() {
        faults.extend(out_of_order(cases, ctx));
    }
    let at = Where::agent(ctx.human);
    for action in cases.tree.actions() {
        if action != Action::Navigate && !ctx.rules.iter().any(|rule| rule.act == action) {
            let message = format!("the tree {}, which the proposal does not ask; leave it out", action.phrase());
            faults.push(Fault::new(FaultCode::BMatch, &at, message));
        }
    }
    for gesture in cases.tree.gestures_made() {
        if !ctx.rules.iter().any(|rule| rule.gesture == Some(gesture)) {
            let message = format!("the tree says {gesture}, which the proposal does not ask; leave it out");
            faults.push(Fault::new(FaultCode::BMatch, &at, message));
        }
    }
    faults
}

/// The first thing in which the tree differs from a rule.
fn mismatch(cases: &Cases<'_>, rules: &[Rule], rule: &Rule) -> Option<(FaultCode, String)> {
    let differs = |message: String| Some((FaultCode::BMatch, message));
    let act = rule.act.they();
    // To take the next goal of the path is a part of walking along it.
    let takes_goal = |case: &Case, tick: usize| rule.act == Action::Navigate && case.goals.get(tick) == Some(&true);
    let does = |case: &Case, tick: usize| {
        takes_goal(case, tick) || case.acts.get(tick).is_some_and(|acts| acts.iter().any(|(act, _)| *act == rule.act))
    };
    if cases.simplest(does).is_none() {
        return differs(format!("{}, {act}: the tree never does that", when(rule)));
    }
    let never_asked: Vec<String> =
        asked(rule).filter(|trigger| holds(cases, trigger, &[]).is_none()).map(Trigger::phrase).collect();
    if !never_asked.is_empty() {
        return differs(format!("{act} {}: the tree never asks for that", never_asked.join(" and ")));
    }
    let all_hold =
        |rule: &Rule, case: &Case| asked(rule).all(|trigger| holds(cases, trigger, &case.truth).unwrap_or(false));
    if cases.simplest(|case, tick| does(case, tick) && all_hold(rule, case)).is_none() {
        return differs(format!("{}, {act}: the tree does not do that then", when(rule)));
    }
    if let Some(gesture) = rule.gesture {
        let says =
            |case: &Case, tick: usize| case.gestures.get(tick).and_then(|made| made.last()) == Some(&Some(gesture));
        if cases.simplest(|case, tick| does(case, tick) && all_hold(rule, case) && says(case, tick)).is_none() {
            return differs(format!("{}, {act} and say {gesture}: the tree does not say it then", when(rule)));
        }
    }
    if let Some(found) = duration(cases, rule, &does) {
        return Some(found);
    }
    // Walking needs no trigger: it is also what is done otherwise.
    if rule.act == Action::Navigate || asked(rule).next().is_none() {
        return None;
    }
    let same_act = || rules.iter().filter(|other| other.act == rule.act);
    let surplus = cases
        .simplest(|case, tick| does(case, tick) && !same_act().any(|other| all_hold(other, case) || other.latched));
    if let Some((case, _)) = surplus {
        return differs(format!("{act} only {}; the tree also does it {}", when(rule), cases.words(case)));
    }
    if rule.latched && cases.simplest(|case, tick| does(case, tick) && !all_hold(rule, case)).is_none() {
        return differs(format!(
            "once started, {act} even when the trigger has passed; put the conditions under a Latch"
        ));
    }
    None
}

/// The first pair of rules of which the tree does the later one where the triggers of both hold: earlier rules win.
fn out_of_order(cases: &Cases<'_>, ctx: &CheckContext<'_>) -> Option<Fault> {
    let holds_all =
        |rule: &Rule, case: &Case| asked(rule).all(|trigger| holds(cases, trigger, &case.truth).unwrap_or(false));
    let does =
        |rule: &Rule, case: &Case| case.acts.first().is_some_and(|acts| acts.iter().any(|(act, _)| *act == rule.act));
    // A rule whose time is over leaves it to the next one.
    let over = |rule: &Rule, case: &Case| {
        let timers = cases.atoms.iter().zip(&case.truth);
        rule.for_s.is_some_and(|secs| {
            timers.into_iter().any(|(atom, ran_out)| match atom {
                Atom::Timer(_, found) => *ran_out && (found - secs).abs() < SAME,
                Atom::World(_) | Atom::Memory(_) | Atom::GoalHere | Atom::Answer(_) => false,
            })
        })
    };
    // Walking is also what is done otherwise, and a step that is over is not seen from outside.
    let acts = |rule: &&Rule| rule.act != Action::Navigate && rule.step.is_none();
    for (place, later) in ctx.rules.iter().enumerate().filter(|(_, rule)| acts(rule)) {
        let before = ctx.rules.get(..place).unwrap_or_default();
        for (earlier_place, earlier) in
            before.iter().enumerate().filter(|(_, rule)| acts(rule) && rule.act != later.act)
        {
            // What stands before both may do the same as the later one, and keeps doing it where it is latched.
            let by_another = |case: &Case| {
                let first = ctx.rules.get(..earlier_place).unwrap_or_default();
                first.iter().any(|rule| rule.act == later.act && (rule.latched || holds_all(rule, case)))
            };
            let turned = |case: &Case| {
                holds_all(earlier, case)
                    && holds_all(later, case)
                    && !over(earlier, case)
                    && does(later, case)
                    && !does(earlier, case)
                    && !by_another(case)
            };
            if cases.all.iter().any(turned) {
                let (first, second) = (earlier.act.they(), later.act.they());
                let message = format!(
                    "{}, {first}, and {}, {second}: where both hold the tree does the second; the proposal has the first one first, so put \
                     its branch before",
                    when(earlier),
                    when(later)
                );
                return Some(Fault::new(FaultCode::BMatch, Where::rule(ctx.human, place + 1), message));
            }
        }
    }
    None
}

/// Whether a time limit is there and limits.
fn duration(cases: &Cases<'_>, rule: &Rule, does: &impl Fn(&Case, usize) -> bool) -> Option<(FaultCode, String)> {
    let secs = rule.for_s?;
    let act = rule.act.they();
    let timers: Vec<usize> = cases
        .atoms
        .iter()
        .enumerate()
        .filter(|(_, atom)| matches!(atom, Atom::Timer(_, found) if (found - secs).abs() < SAME))
        .map(|(place, _)| place)
        .collect();
    if timers.is_empty() {
        return Some((FaultCode::BMatch, format!("{act} for {secs} s: the tree has no timer of {secs} s")));
    }
    // Walking goes on when its time is over: it is also what is done otherwise.
    if rule.act == Action::Navigate {
        return None;
    }
    let ran_out = |case: &Case, timer: usize| case.truth.get(timer).copied().unwrap_or(false);
    let limits = timers.iter().any(|timer| {
        cases.simplest(|case, tick| does(case, tick) && !ran_out(case, *timer)).is_some()
            && (cases.simplest(|case, tick| does(case, tick) && ran_out(case, *timer)).is_none()
                || others_do(cases, *timer, does))
    });
    if limits {
        return None;
    }
    let message = format!(
        "{act} for {secs} s: the timer does not limit that; put it under an Inverter, after the conditions and before the action"
    );
    Some((FaultCode::BTimer, message))
}

/// Whether the action stops in some case just because the timer runs out; another rule may do the same
/// action without a limit.
fn others_do(cases: &Cases<'_>, timer: usize, does: &impl Fn(&Case, usize) -> bool) -> bool {
    let leaves = |case: &Case| -> Vec<u16> { case.acts.iter().flatten().map(|(_, leaf)| *leaf).collect() };
    cases.all.iter().filter(|case| case.truth.get(timer) == Some(&false) && does(case, 0)).any(|case| {
        cases.all.iter().any(|other| {
            let differs_only_here = case
                .truth
                .iter()
                .zip(&other.truth)
                .enumerate()
                .all(|(place, (a, b))| if place == timer { a != b } else { a == b });
            differs_only_here && leaves(case) != leaves(other)
        })
    })
}

/// Whether a trigger holds in a case; `None` where the tree never asks about it. A timer that comes first
/// may stand for a time since the start.
fn holds(cases: &Cases<'_>, trigger: &Trigger, truth: &[bool]) -> Option<bool> {
    let at = cases.atoms.iter().position(|atom| match (atom, trigger) {
        (Atom::World(Trigger::RobotMoving), Trigger::RobotMoving | Trigger::RobotStopped) => true,
        (Atom::World(found), wanted) => same(found, wanted),
        (Atom::Timer(_, found), Trigger::AfterSecs(wanted)) => (found - wanted).abs() < SAME,
        (Atom::Timer(..) | Atom::Memory(_) | Atom::GoalHere | Atom::Answer(_), _) => false,
    })?;
    let holds = truth.get(at).copied().unwrap_or(false);
    Some(if *trigger == Trigger::RobotStopped { !holds } else { holds })
}

fn same(a: &Trigger, b: &Trigger) -> bool {
    use Trigger::{AfterSecs, RobotBlocking, RobotNear, RobotVisible, StoppedFor};
    match (a, b) {
        (RobotVisible(x), RobotVisible(y))
        | (RobotNear(x), RobotNear(y))
        | (RobotBlocking(x), RobotBlocking(y))
        | (AfterSecs(x), AfterSecs(y))
        | (StoppedFor(x), StoppedFor(y)) => (x - y).abs() < SAME,
        _ => a == b,
    }
}
