//! Bystanders who are never in the way, and people who make room and close up again.

use socrates_model::report::Standing;
use socrates_model::{Action, GroupId, HumanId, Predicate, Recording, Relation, Rule, Trigger};

use crate::cases::{Case, corridor, group_of, must, proposal};
use crate::fixture::{Walk, paths, recording};

const H1: HumanId = HumanId::new(1);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const OPENS: u16 = 12;

fn standing(case: &Case, run: &Recording) -> (Standing, String) {
    let clause = case.judge(run).clauses.into_iter().find(|clause| clause.id == "c1").unwrap();
    (clause.standing, clause.evidence)
}

/// The robot drives along y = 0 from -8 to 8 in 20 s.
fn drives() -> Walk {
    Walk::robot(-8., 0., 0.8, 0.)
}

#[test]
fn a_bystander_stands_beside_the_way_all_the_time() {
    let mut plan = proposal(1, vec![must("c1", Predicate::StaysAside { human: H1 })]);
    plan.humans[0].relation = Relation::Aside;
    let ways = paths(&["a", "m", "b"], &[(&["m"], "")]);
    let case = Case { place: corridor(), plan, ways, reading: None };
    for (what, walk, wanted) in [
        ("1.3 m beside it", Walk::human(1, 0., 1.3, 0., 0.), Standing::Holds),
        ("in it", Walk::human(1, 0., 0.3, 0., 0.), Standing::Fails),
        ("walks along", Walk::human(1, -8., 1.3, 0.8, 0.), Standing::Fails),
        ("where the robot never comes", Walk::human(1, 60., 60., 0., 0.), Standing::NotTriggered),
    ] {
        let (found, why) = standing(&case, &recording(&[drives(), walk], 20.0, 0.01));
        assert_eq!(found, wanted, "{what}: {why}");
    }
}

/// Two who stand in the robot's way, and what they do from 5 s on: (time, x, y).
fn pair(first: &[(f64, f64, f64)], second: &[(f64, f64, f64)]) -> Recording {
    let person = |number, y: f64, stops: &[(f64, f64, f64)]| {
        let mut way = vec![(0., 0., y), (5., 0., y)];
        way.extend_from_slice(stops);
        Walk::human_through(number, &way).leaf(0.0, WALKS).leaf(5.0, OPENS)
    };
    recording(&[drives(), person(1, 0.3, first), person(2, -0.3, second)], 20.0, 0.01)
}

#[test]
fn a_group_that_makes_room_opens_and_closes_again() {
    let rule = Rule {
        when: vec![Trigger::AfterSecs(5.0)],
        act: Action::MakeRoom,
        until: vec![Trigger::RobotPassed],
        latched: true,
        step: Some(1),
        ..Rule::default()
    };
    let mut plan = group_of(proposal(2, vec![must("c1", Predicate::MakesRoom { human: H1 })]), &[1, 2]);
    for human in &mut plan.humans {
        (human.relation, human.rules) = (Relation::Static, vec![rule.clone()]);
    }
    assert_eq!(plan.groups[0].id, GroupId(1));
    let ways = paths(&["a", "m", "b"], &[(&["m"], ""), (&["m"], "")]);
    let case = Case { place: corridor(), plan, ways, reading: None };
    let (left, right) =
        ([(7., 0., 1.0), (13., 0., 1.0), (16., 0., 0.3)], [(7., 0., -1.0), (13., 0., -1.0), (16., 0., -0.3)]);
    let stay = |y: f64| [(20., 0., y)];
    for (what, run, wanted) in [
        ("both step aside and come back", pair(&left, &right), Standing::Holds),
        ("they stay aside", pair(&[(7., 0., 1.3), (20., 0., 1.3)], &right), Standing::Fails),
        ("they stand", pair(&stay(0.3), &stay(-0.3)), Standing::Fails),
        (
            "they come back before it has passed",
            pair(&[(7., 0., 1.0), (9., 0., 0.3), (20., 0., 0.3)], &right),
            Standing::Fails,
        ),
    ] {
        let (found, why) = standing(&case, &run);
        assert_eq!(found, wanted, "{what}: {why}");
    }
}
