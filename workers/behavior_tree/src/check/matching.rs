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
