//! What is done for a reason counts from its reason: not the time before somebody sets off, nor what they do too early.

use socrates_model::report::Standing;
use socrates_model::{
    Action, AgentId, ClauseResult, Gesture, HumanId, Predicate, Recording, Report, Rule, Trigger, Verdict,
};
use socrates_scoring::Evidence;

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, paths, recording};
use crate::mutants::spoiled;

const H1: HumanId = HumanId::new(1);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const STANDS: u16 = 7;

fn clause<'a>(report: &'a Report, id: &str) -> &'a ClauseResult {
    report.clauses.iter().find(|clause| clause.id == id).unwrap()
}

fn rule(when: Trigger, act: Action, gesture: Option<Gesture>) -> Rule {
    Rule { when: vec![when], act, gesture, for_s: Some(3.0), latched: true, ..Rule::default() }
}

/// Somebody comes towards the robot and is to do something for a reason on the way.
fn comes(rule: Rule, predicate: Predicate) -> Case {
    let mut plan = proposal(1, vec![must("c1", predicate)]);
    plan.humans[0].rules = vec![rule];
    Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]), reading: None }
}

/// They are to hesitate where they see the robot within 3 m.
fn hesitates() -> Case {
    let stands = Predicate::StandsStill { human: H1, for_s: 2.0 };
    comes(rule(Trigger::RobotVisible(3.0), Action::StandStill, None), stands)
}

fn robot() -> Walk {
    Walk::robot(-12., -0.5, 0.8, 0.)
}

/// They set off after 6 s, are within 3 m of the robot at about 12 s, and stand there for so long.
fn stops_for(secs: f64) -> Walk {
    let stops = [(0., 8., 0.5), (6., 8., 0.5), (12., 0.2, 0.5), (12. + secs, 0.2, 0.5), (22. + secs, -8., 0.5)];
    let walk = Walk::human_through(1, &stops).leaf(0.0, WALKS);
    if secs > 0.0 { walk.leaf(12.0, STANDS).leaf(12.0 + secs, WALKS) } else { walk }
}

fn run(walks: &[Walk]) -> Recording {
    recording(walks, 24.0, 0.01)
}

#[test]
fn a_hesitation_is_not_proved_by_the_time_before_they_set_off() {
    let case = hesitates();
    let report = case.judge(&run(&[robot(), stops_for(3.0)]));
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    let seen = clause(&report, "c1");
    assert!(seen.times_s[0] > 11.0, "{seen:?}");
    assert!(seen.evidence.contains("for 3.0 s without a break (2.0 s asked), counted from 1"), "{}", seen.evidence);

    // They stand for 6 s before they set off, and walk past the robot.
    let report = case.judge(&run(&[robot(), stops_for(0.0)]));
    assert_eq!(clause(&report, "c1").standing, Standing::Fails, "{}", clause(&report, "c1").evidence);
    assert_eq!(report.verdict, Verdict::Contradicted, "{}", report.verdict_text);

    // They never set off: the robot is never within 3 m of them.
    let waits = Walk::human(1, 8., 1.0, 0., 0.).leaf(0.0, WALKS);
    let report = case.judge(&recording(&[robot(), waits], 20.0, 0.01));
    assert_eq!(clause(&report, "c1").standing, Standing::NotTriggered, "{}", clause(&report, "c1").evidence);
}

#[test]
fn what_their_tree_played_instead_of_the_deed_is_told() {
    let case =
        comes(rule(Trigger::RobotNear(3.0), Action::RunAway, None), Predicate::RunsAway { human: H1, by_m: 1.5 });
    let report = case.judge(&run(&[robot(), stops_for(3.0)]));
    let seen = clause(&report, "c1");
    assert_eq!(seen.standing, Standing::Fails, "{}", seen.evidence);
    let told = "the reason for it (when the robot is within 3 m) came at 11.8 s; their tree plays `StandStill` then";
    assert!(seen.evidence.contains(told), "{}", seen.evidence);
}

#[test]
fn whose_place_it_is_to_stand_there_stands_from_the_beginning() {
    let mut case = hesitates();
    case.plan.humans[0].relation = socrates_model::Relation::Static;
    case.ways = paths(&["a", "m", "b"], &[(&["m"], "m")]);
    let stands = Walk::human(1, 0.2, 0.6, 0., 0.).leaf(0.0, STANDS);
    let report = case.judge(&run(&[robot(), stands]));
    assert!(clause(&report, "c1").times_s[0].abs() < 1e-9, "{}", clause(&report, "c1").evidence);
}

#[test]
fn a_state_that_was_over_before_its_reason_is_no_reaction() {
    let when = vec![Trigger::RobotVisible(3.0)];
    let reacts = Predicate::Reacts { human: H1, when, act: Action::StandStill, within_s: 3.0 };
    let case = comes(rule(Trigger::RobotVisible(3.0), Action::StandStill, None), reacts);
    let early =
        Walk::human_through(1, &[(0., 8., 0.5), (6., 8., 0.5), (22., -8., 0.5)]).leaf(0.0, STANDS).leaf(6.0, WALKS);
    let report = case.judge(&run(&[robot(), early]));
    let found = clause(&report, "c1");
    assert_eq!(found.standing, Standing::Fails, "{}", found.evidence);
    assert!(found.evidence.contains("only before it, from 0.0 s to 6.0 s"), "{}", found.evidence);
    let report = case.judge(&run(&[robot(), stops_for(3.0)]));
    assert_eq!(clause(&report, "c1").standing, Standing::Holds, "{}", clause(&report, "c1").evidence);
}

#[test]
fn a_gesture_made_only_before_its_reason_is_no_answer() {
    let gestures = Predicate::Gestures { agent: AgentId::Human(H1), gesture: Gesture::Wait };
    let case = comes(rule(Trigger::RobotNear(3.0), Action::Navigate, Some(Gesture::Wait)), gestures);
    let says = |from: f64| stops_for(0.0).says(from, from + 1.5, Gesture::Wait);
    let report = case.judge(&run(&[robot(), says(12.0)]));
    assert_eq!(clause(&report, "c1").standing, Standing::Holds, "{}", clause(&report, "c1").evidence);
    // Within earshot, yet before the robot is as near as was asked.
    let report = case.judge(&run(&[robot(), says(9.0)]));
    let found = clause(&report, "c1");
    assert_eq!(found.standing, Standing::Fails, "{}", found.evidence);
    assert!(found.evidence.contains("only before the reason for it"), "{}", found.evidence);
}

#[test]
fn the_judge_refuses_a_run_in_which_a_reaction_comes_only_before_its_reason() {
    let gestures = Predicate::Gestures { agent: AgentId::Human(H1), gesture: Gesture::Wait };
    let answers = comes(rule(Trigger::RobotNear(3.0), Action::Navigate, Some(Gesture::Wait)), gestures);
    for (case, walk, kind) in [
        (hesitates(), stops_for(3.0), "N: reaction only before its reason"),
        (answers, stops_for(0.0).says(12.0, 13.5, Gesture::Wait), "N: gesture only before its reason"),
    ] {
        let run = run(&[robot(), walk]);
        let report = case.judge(&run);
        assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
        let all = spoiled(&Evidence { reading: None, ..case.evidence(&run) });
        let spoiled: Vec<_> = all.iter().filter(|mutant| mutant.kind == kind).collect();
        assert_eq!(spoiled.len(), 1, "{kind}: {:?}", all.iter().map(|mutant| mutant.kind).collect::<Vec<_>>());
        let report = case.judge(&spoiled[0].recording);
        assert_eq!(report.verdict, Verdict::Contradicted, "{kind}: {}", report.verdict_text);
        assert_eq!(clause(&report, "c1").standing, Standing::Fails, "{kind}: {}", clause(&report, "c1").evidence);
    }
}
