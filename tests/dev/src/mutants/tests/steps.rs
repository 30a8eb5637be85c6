//! Steps of a sequence: each begins for its reason, is done while it lasts, and is over when it should be.

use socrates_model::report::Standing;
use socrates_model::{
    Action, ClauseResult, EventKind, Gesture, HumanId, Predicate, Recording, Report, Rule, Trigger, Verdict,
};
use socrates_scoring::Evidence;

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, event, paths, recording};
use crate::mutants::spoiled;

const H1: HumanId = HumanId::new(1);
const H2: HumanId = HumanId::new(2);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const STANDS: u16 = 7;

fn step(number: u32, when: Trigger, act: Action) -> Rule {
    let mut all = if number > 1 { vec![Trigger::Did(H1, number - 1)] } else { Vec::new() };
    all.push(when);
    Rule { when: all, act, latched: true, step: Some(number), ..Rule::default() }
}

fn judged(rule: &Rule) -> Predicate {
    Predicate::Step { human: H1, rule: rule.clone(), within_s: 3.0 }
}

/// Somebody comes towards the robot, stands for 4 s at its sight within 6 m, and says PROCEED once somebody else is done.
fn case() -> Case {
    let stands = Rule { for_s: Some(4.0), ..step(1, Trigger::RobotVisible(6.0), Action::StandStill) };
    let says =
        Rule { for_s: Some(1.0), gesture: Some(Gesture::Proceed), ..step(2, Trigger::Done(H2), Action::Navigate) };
    let mut plan = proposal(2, vec![must("c1", judged(&stands)), must("c2", judged(&says))]);
    plan.humans[0].rules = vec![stands, says];
    plan.humans[1].rules =
        vec![Rule { when: vec![Trigger::Always], for_s: Some(12.0), latched: true, step: Some(1), ..Rule::default() }];
    let ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m"), (&["b", "m", "a"], "m")]);
    Case { place: corridor(), plan, ways, reading: None }
}

/// The run as it should be: within 6 m at about 6.3 s, standing from then to 10.3 s; the other is done at 12 s.
fn run(says_s: f64) -> Recording {
    let robot = Walk::robot(-8., -0.5, 0.8, 0.);
    let first = Walk::human_through(1, &[(0., 8., 0.5), (6.3, 2.0, 0.5), (10.3, 2.0, 0.5), (24., -8., 0.5)])
        .leaf(0.0, WALKS)
        .leaf(6.3, STANDS)
        .leaf(10.3, WALKS)
        .says(says_s, says_s + 1.0, Gesture::Proceed);
    let other = Walk::human_through(2, &[(0., 8., 1.2), (20., -8., 1.2)]).leaf(0.0, WALKS);
    let mut run = recording(&[robot, first, other], 28.0, 0.01);
    event(&mut run, 10.3, EventKind::StepEnded { human: H1, step: 1 });
    event(&mut run, 12.0, EventKind::StepEnded { human: H2, step: 1 });
    run
}

fn clause<'a>(report: &'a Report, id: &str) -> &'a ClauseResult {
    report.clauses.iter().find(|clause| clause.id == id).unwrap()
}

#[test]
fn a_step_that_is_done_for_its_reason_and_for_its_time_holds() {
    let report = case().judge(&run(12.1));
    assert_eq!(clause(&report, "c1").standing, Standing::Holds, "{}", clause(&report, "c1").evidence);
    assert_eq!(clause(&report, "c2").standing, Standing::Holds, "{}", clause(&report, "c2").evidence);
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
}

#[test]
fn a_step_before_its_reason_or_long_after_it_is_none() {
    for (says_s, wanted) in [(11.0, Standing::Fails), (20.0, Standing::Fails), (14.0, Standing::Holds)] {
        let report = case().judge(&run(says_s));
        let found = clause(&report, "c2");
        assert_eq!(found.standing, wanted, "{says_s}: {}", found.evidence);
    }
}

#[test]
fn a_step_whose_reason_never_comes_is_not_done() {
    let mut never = run(12.1);
    never.events.retain(|event| event.kind != EventKind::StepEnded { human: H2, step: 1 });
    let report = case().judge(&never);
    assert_eq!(clause(&report, "c2").standing, Standing::NotTriggered, "{}", clause(&report, "c2").evidence);
    assert_ne!(report.verdict, Verdict::Realised);
}

#[test]
fn a_step_that_does_not_end_is_refused() {
    let mut case = case();
    let stands =
        Rule { until: vec![Trigger::RobotNear(4.0)], ..step(1, Trigger::RobotVisible(6.0), Action::StandStill) };
    case.plan.expected_events = vec![must("c1", judged(&stands))];
    case.plan.humans[0].rules = vec![stands];
    // The robot is within 4 m at about 7.6 s; they stand to 10.3 s.
    let report = case.judge(&run(12.1));
    assert_eq!(clause(&report, "c1").standing, Standing::Fails, "{}", clause(&report, "c1").evidence);
    assert!(clause(&report, "c1").evidence.contains("goes on to 10.3 s"), "{}", clause(&report, "c1").evidence);
}

#[test]
fn the_judge_refuses_spoiled_steps() {
    let case = case();
    let run = run(12.1);
    let all = spoiled(&Evidence { reading: None, ..case.evidence(&run) });
    for (kind, id) in [("N: step's sign late", "c2"), ("N: step without its effect", "c1")] {
        let found: Vec<_> = all.iter().filter(|mutant| mutant.kind == kind).collect();
        assert_eq!(found.len(), 1, "{kind}: {:?}", all.iter().map(|mutant| mutant.kind).collect::<Vec<_>>());
        let report = case.judge(&found[0].recording);
        assert_eq!(clause(&report, id).standing, Standing::Fails, "{kind}: {}", clause(&report, id).evidence);
        assert_eq!(report.verdict, Verdict::Contradicted, "{kind}: {}", report.verdict_text);
    }
}
