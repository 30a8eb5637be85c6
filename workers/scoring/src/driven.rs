//! Somebody who is driven from outside is judged by their motion, also where others of the run act by their trees.

use socrates_model::recording::DRIVEN_LEAF;
use socrates_model::report::Standing;
use socrates_model::{Action, HumanId, Predicate, Recording, Rule, Trigger};

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, paths, recording};

const H1: HumanId = HumanId::new(1);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const STANDS: u16 = 7;

/// The first of two is to stop or look up where they see the robot within 3 m.
fn case(act: Action) -> Case {
    let when = vec![Trigger::RobotVisible(3.0)];
    let reacts = Predicate::Reacts { human: H1, when: when.clone(), act: act.clone(), within_s: 3.0 };
    let mut plan = proposal(2, vec![must("c1", reacts)]);
    plan.humans[0].rules = vec![Rule { when, act, for_s: Some(3.0), latched: true, ..Rule::default() }];
    let ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m"), (&["m"], "m")]);
    Case { place: corridor(), plan, ways, reading: None }
}

/// A run with somebody else whose tree is told; the first of them is driven, or has a tree in which they walk on.
fn run(first: Walk, driven: bool) -> Recording {
    let robot = Walk::robot(-12., -0.5, 0.8, 0.);
    let other = Walk::human(2, 9., 1.6, 0., 0.).leaf(0.0, STANDS);
    let number = u16::try_from(recording(&[], 1.0, 0.1).header.leaves.len()).unwrap();
    let first = first.leaf(0.0, if driven { number } else { WALKS });
    let mut run = recording(&[robot, first, other], 24.0, 0.01);
    run.header.leaves.push(DRIVEN_LEAF.to_owned());
    run
}

fn standing(case: &Case, run: &Recording) -> (Standing, String) {
    let report = case.judge(run);
    let found = report.clauses.iter().find(|clause| clause.id == "c1").unwrap();
    (found.standing, found.evidence.clone())
}

#[test]
fn somebody_who_is_driven_reacts_by_motion_alone() {
    let stops = || Walk::human_through(1, &[(0., 8., 0.5), (9., 1.0, 0.5), (16., 1.0, 0.5), (24., -6., 0.5)]);
    let case = case(Action::StandStill);
    let (found, evidence) = standing(&case, &run(stops(), true));
    assert_eq!(found, Standing::Holds, "{evidence}");
    // By a tree that has them walk on they stand for no reason of theirs.
    let (found, evidence) = standing(&case, &run(stops(), false));
    assert_ne!(found, Standing::Holds, "{evidence}");
}

#[test]
fn somebody_who_is_driven_and_does_not_do_what_was_asked_fails() {
    let walks_on = || Walk::human_through(1, &[(0., 8., 0.5), (20., -8., 0.5), (24., -8.5, 0.5)]);
    for act in [Action::StandStill, Action::LookAtRobot] {
        let (found, evidence) = standing(&case(act.clone()), &run(walks_on(), true));
        assert_eq!(found, Standing::Fails, "{act:?}: {evidence}");
    }
}

#[test]
fn nothing_is_authored_again_for_what_a_driver_outside_did() {
    let walks_on = || Walk::human_through(1, &[(0., 8., 0.5), (20., -8., 0.5), (24., -8.5, 0.5)]);
    let case = case(Action::StandStill);
    let driven = run(walks_on(), true);
    assert!(case.judge(&driven).repair.is_none());
    let mut by_tree = run(walks_on(), false);
    by_tree.header.leaves.pop();
    assert!(case.judge(&by_tree).repair.is_some());
}
