//! Signs to somebody, and acts that change the way or the pace: each needs the motion.

use std::f64::consts::PI;

use socrates_model::act::Destination;
use socrates_model::report::Standing;
use socrates_model::{
    Action, AgentId, ClauseResult, EventKind, Gesture, HumanId, Predicate, Recording, Rule, Trigger, Verdict,
};
use socrates_scoring::Evidence;

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, event, paths, recording};
use crate::mutants::spoiled;

const H1: HumanId = HumanId::new(1);
const H2: HumanId = HumanId::new(2);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const WATCHES: u16 = 8;
const TURNS: u16 = 9;
const PACES: u16 = 10;
const GOES: u16 = 11;
const COMES: u16 = 13;

fn case(rule: Rule, predicate: Predicate) -> Case {
    let mut plan = proposal(2, vec![must("c1", predicate)]);
    plan.humans[0].rules = vec![rule];
    let ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], ""), (&["b", "m", "a"], "")]);
    Case { place: corridor(), plan, ways, reading: None }
}

fn step(act: Action) -> Rule {
    let when = vec![Trigger::AfterSecs(5.0)];
    Rule { when, act, latched: true, step: Some(1), ..Rule::default() }
}

fn found(case: &Case, run: &Recording) -> ClauseResult {
    case.judge(run).clauses.into_iter().find(|clause| clause.id == "c1").unwrap()
}

/// Somebody stands and makes a sign from 5 to 7 s, facing as given; somebody else stands 3 m away, and the robot drives as given.
fn sign(yaw: f64, to: Option<AgentId>, robot: Walk) -> Recording {
    let me = Walk::human(1, 0., 1.1, 0., 0.).facing(yaw).leaf(0.0, WATCHES).says(5.0, 7.0, Gesture::Wait);
    let other = Walk::human(2, 3., 1.1, 0., 0.).leaf(0.0, WALKS);
    let mut run = recording(&[robot, me, other], 16.0, 0.01);
    event(&mut run, 5.0, EventKind::Gesture { agent: H1.into(), gesture: Some(Gesture::Wait), to });
    run
}

#[test]
fn a_sign_to_somebody_is_made_facing_them_and_stops_nobody_else() {
    let to = AgentId::Human(H2);
    let rule = Rule { gesture: Some(Gesture::Wait), to: Some(to), for_s: Some(2.0), ..step(Action::LookAt(H2)) };
    let case = case(rule, Predicate::GesturesTo { human: H1, gesture: Gesture::Wait, to });
    let drives = || Walk::robot(-8., -0.8, 0.8, 0.);
    let stops = Walk::through(AgentId::Robot, &[(0., -8., -0.8), (5.5, -3.6, -0.8), (16., -3.6, -0.8)]);
    for (what, run, wanted) in [
        ("facing them", sign(0.0, Some(to), drives()), Standing::Holds),
        ("a little beside them", sign(0.25, Some(to), drives()), Standing::Holds),
        ("facing away", sign(PI, Some(to), drives()), Standing::Fails),
        ("to nobody", sign(0.0, None, drives()), Standing::Fails),
        ("to the robot", sign(0.0, Some(AgentId::Robot), drives()), Standing::Fails),
        ("and the robot stops by it", sign(0.0, Some(to), stops), Standing::Fails),
    ] {
        let clause = found(&case, &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

/// Somebody walks towards the robot to (2, 0.9) at 6 s, and then through these stops.
fn walks(leaf: u16, then: &[(f64, f64, f64)]) -> Recording {
    let mut stops = vec![(0., 8., 0.9), (6., 2., 0.9)];
    stops.extend_from_slice(then);
    let me = Walk::human_through(1, &stops).leaf(0.0, WALKS).leaf(6.0, leaf);
    let other = Walk::human(2, 7., -1.1, 0., 0.).leaf(0.0, WALKS);
    recording(&[Walk::robot(-8., -0.5, 0.4, 0.), me, other], 20.0, 0.01)
}

#[test]
fn turning_back_is_walking_back() {
    let case = case(step(Action::TurnBack), Predicate::TurnsBack { human: H1 });
    for (what, run, wanted) in [
        ("walks back", walks(TURNS, &[(12., 8., 0.9)]), Standing::Holds),
        ("stands", walks(TURNS, &[(20., 2., 0.9)]), Standing::Fails),
        ("walks on", walks(TURNS, &[(12., -4., 0.9)]), Standing::Fails),
        ("walks back a meter", walks(TURNS, &[(7., 3., 0.9), (20., 3., 0.9)]), Standing::Fails),
        ("walks back long after", walks(TURNS, &[(14., 2., 0.9), (20., 8., 0.9)]), Standing::Fails),
    ] {
        let clause = found(&case, &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

#[test]
fn another_pace_is_a_quarter_faster_or_slower() {
    let paced = |mps| case(step(Action::ChangePace(mps)), Predicate::ChangesPace { human: H1, mps });
    for (what, mps, run, wanted) in [
        ("slower", 0.6, walks(PACES, &[(16., -4., 0.9)]), Standing::Holds),
        ("slower was asked", 0.6, walks(PACES, &[(10., -4., 0.9)]), Standing::Fails),
        ("faster", 1.5, walks(PACES, &[(10., -4., 0.9)]), Standing::Holds),
        ("as before", 0.6, walks(PACES, &[(12., -4., 0.9)]), Standing::Fails),
        ("stands", 0.6, walks(PACES, &[(20., 2., 0.9)]), Standing::Fails),
    ] {
        let clause = found(&paced(mps), &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

#[test]
fn going_to_a_place_is_getting_there() {
    let nodes = vec![crate::fixture::node("m")];
    let act = Action::GoTo(Destination { place: "corridor".into(), nodes: nodes.clone() });
    let case = case(step(act), Predicate::GoesTo { human: H1, nodes });
    // 1.8 m away from it they begin to go there.
    let me = Walk::human_through(1, &[(0., 8., 0.9), (6., 1.6, 0.9), (9., 0.3, 0.4), (20., 0.3, 0.4)]);
    let other = Walk::human(2, 7., -1.1, 0., 0.).leaf(0.0, WALKS);
    let near_already =
        recording(&[Walk::robot(-8., -0.5, 0.4, 0.), me.leaf(0.0, WALKS).leaf(6.0, GOES), other], 20.0, 0.01);
    for (what, run, wanted) in [
        ("gets there", walks(GOES, &[(9., 0.3, 0.4), (20., 0.3, 0.4)]), Standing::Holds),
        ("stands", walks(GOES, &[(20., 2., 0.9)]), Standing::Fails),
        ("walks back", walks(GOES, &[(12., 8., 0.9)]), Standing::Fails),
        ("is nearly there already", near_already, Standing::Fails),
    ] {
        let clause = found(&case, &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

#[test]
fn coming_back_is_getting_to_where_one_began() {
    let case = case(step(Action::ComeBack), Predicate::ComesBack { human: H1 });
    for (what, run, wanted) in [
        ("comes back", walks(COMES, &[(12., 8., 0.9), (20., 8., 0.9)]), Standing::Holds),
        ("stands", walks(COMES, &[(20., 2., 0.9)]), Standing::Fails),
        ("comes back by half", walks(COMES, &[(9., 5., 0.9), (20., 5., 0.9)]), Standing::Fails),
        ("walks on", walks(COMES, &[(12., -4., 0.9)]), Standing::Fails),
    ] {
        let clause = found(&case, &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

#[test]
fn the_judge_refuses_acts_without_their_effect() {
    let rule = step(Action::TurnBack);
    let clauses = vec![
        must("c1", Predicate::TurnsBack { human: H1 }),
        must("c2", Predicate::Step { human: H1, rule: rule.clone(), within_s: 3.0 }),
    ];
    let mut case = case(rule, Predicate::TurnsBack { human: H1 });
    case.plan.expected_events = clauses;
    let run = walks(TURNS, &[(12., 8., 0.9)]);
    assert_eq!(found(&case, &run).standing, Standing::Holds);
    let all = spoiled(&Evidence { reading: None, ..case.evidence(&run) });
    let still: Vec<_> = all.iter().filter(|mutant| mutant.kind == "N: step without its effect").collect();
    assert_eq!(still.len(), 1, "{:?}", all.iter().map(|mutant| mutant.kind).collect::<Vec<_>>());
    let report = case.judge(&still[0].recording);
    assert_eq!(report.verdict, Verdict::Contradicted, "{}", report.verdict_text);
    assert_eq!(found(&case, &still[0].recording).standing, Standing::Fails);
}
