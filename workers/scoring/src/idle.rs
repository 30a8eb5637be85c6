//! People who do nothing, or whose log alone tells of an act, on hand-made tracks: no clause holds by what the robot does.

use std::f64::consts::PI;

use socrates_model::report::Standing;
use socrates_model::{Action, AgentId, EventKind, Gesture, HumanId, Predicate, Recording, Relation, Rule, Trigger};

use crate::cases::{Case, corridor, must, proposal};
use crate::fidelity::standing_of;
use crate::fixture::{Walk, event, paths, recording};

const H1: HumanId = HumanId::new(1);

fn case(predicate: Predicate) -> Case {
    let plan = proposal(1, vec![must("c1", predicate)]);
    Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]), reading: None }
}

fn standing(case: &Case, run: &Recording) -> (Standing, String) {
    let found = standing_of(&case.evidence(run), &case.plan.expected_events[0]).unwrap();
    (found.standing, found.evidence)
}

fn robot() -> Walk {
    Walk::through(AgentId::Robot, &[(0., -8., 0.), (20., 8., 0.)])
}

#[test]
fn somebody_who_stands_behind_a_robot_that_drives_off_does_not_follow() {
    let follows = Predicate::Follows { follower: H1.into(), leader: AgentId::Robot, gap_m: [0.5, 3.5], for_s: 5.0 };
    let case = case(follows);
    // At 0.4 m/s the robot is between 0.5 and 3.5 m ahead of them for 7.5 s.
    let slow = || Walk::through(AgentId::Robot, &[(0., -6., 0.), (20., 2., 0.)]);
    let stands = recording(&[slow(), Walk::human(1, -6.5, 0., 0., 0.)], 20.0, 0.01);
    assert_ne!(standing(&case, &stands).0, Standing::Holds);
    let goes = recording(&[slow(), Walk::human(1, -7.5, 0., 0.4, 0.)], 20.0, 0.01);
    assert_eq!(standing(&case, &goes).0, Standing::Holds);
}

#[test]
fn somebody_who_stands_beside_the_line_all_the_time_gives_no_way() {
    let case = case(Predicate::GivesWay { human: H1 });
    let beside = recording(&[robot(), Walk::human(1, 2., 0.9, 0., 0.)], 20.0, 0.01);
    let (found, evidence) = standing(&case, &beside);
    assert_eq!(found, Standing::Fails, "{evidence}");
    let goes = [(0., 2., 0.), (6., 2., 0.), (7., 2., 0.9), (20., 2., 0.9)];
    let aside = recording(&[robot(), Walk::human_through(1, &goes)], 20.0, 0.01);
    let (found, evidence) = standing(&case, &aside);
    assert_eq!(found, Standing::Holds, "{evidence}");
}

#[test]
fn a_robot_that_swerves_moves_nobody_aside() {
    let case = case(Predicate::GivesWay { human: H1 });
    let swerves = [(0., -8., 0.), (8., 0., 0.), (9., 1., -1.), (12., 4., -1.), (16., 8., 0.)];
    let run = recording(&[Walk::through(AgentId::Robot, &swerves), Walk::human(1, 2., 0., 0., 0.)], 16.0, 0.01);
    let (found, evidence) = standing(&case, &run);
    assert_eq!(found, Standing::Fails, "{evidence}");
}

#[test]
fn somebody_who_faces_the_robot_by_chance_does_not_look_at_it() {
    let case = case(Predicate::Looks { human: H1, for_s: 2.0 });
    let stands = recording(&[robot(), Walk::human(1, 6., 0., 0., 0.).facing(PI)], 17.0, 0.01);
    let (found, evidence) = standing(&case, &stands);
    assert_eq!(found, Standing::Fails, "{evidence}");
    let stops = [(0., 8., 0.), (4., 6., 0.), (20., 6., 0.)];
    let looks = recording(&[robot(), Walk::human_through(1, &stops).facing(PI)], 17.0, 0.01);
    assert_eq!(standing(&case, &looks).0, Standing::Holds);
}

#[test]
fn a_sign_that_only_the_log_tells_of_is_none() {
    let case = case(Predicate::Gestures { agent: H1.into(), gesture: Gesture::Wait });
    let mut run = recording(&[robot(), Walk::human(1, 4., 0.9, 0., 0.)], 20.0, 0.01);
    event(&mut run, 9.0, EventKind::Gesture { agent: H1.into(), gesture: Some(Gesture::Wait), to: None });
    assert_eq!(standing(&case, &run).0, Standing::NotTriggered);
    let says = recording(&[robot(), Walk::human(1, 4., 0.9, 0., 0.).says(9.0, 11.0, Gesture::Wait)], 20.0, 0.01);
    assert_eq!(standing(&case, &says).0, Standing::Holds);
}

#[test]
fn an_arrival_that_only_the_log_tells_of_is_none() {
    let case = case(Predicate::RobotArrives);
    let of = |to_m: f64| {
        let way = [(0., -8., 0.), (10., to_m, 0.), (20., to_m, 0.)];
        let mut run = recording(&[Walk::through(AgentId::Robot, &way), Walk::human(1, 4., 0.9, 0., 0.)], 20.0, 0.01);
        event(&mut run, 10.0, EventKind::RobotArrived);
        standing(&case, &run).0
    };
    assert_eq!((of(7.9), of(0.0), of(-8.0)), (Standing::Holds, Standing::Fails, Standing::Fails));
}

#[test]
fn a_robot_that_has_stood_all_the_while_does_not_stop_for_a_sign() {
    let case = case(Predicate::RobotObeys { gesture: Gesture::Wait, within_s: 2.0 });
    let says = || Walk::human(1, 4., 0.9, 0., 0.).says(9.0, 11.0, Gesture::Wait);
    let of = |stops: &[(f64, f64, f64)]| {
        standing(&case, &recording(&[Walk::through(AgentId::Robot, stops), says()], 20.0, 0.01)).0
    };
    assert_eq!(of(&[(0., -2., 0.), (20., -2., 0.)]), Standing::NotTriggered);
    assert_eq!(of(&[(0., -8., 0.), (10., 0., 0.), (20., 0., 0.)]), Standing::Holds);
}

#[test]
fn a_place_at_which_nobody_meets_the_robot_is_none_of_an_encounter() {
    let place = socrates_model::PlaceClass::Corridor;
    let case = case(Predicate::EncounterAt { place, nodes: Vec::new(), human: None });
    let far = recording(&[robot(), Walk::human(1, 18., 0.5, 0., 0.)], 20.0, 0.01);
    assert_eq!(standing(&case, &far).0, Standing::NotTriggered);
    let meets = recording(&[robot(), Walk::human(1, 8., 0.7, -0.8, 0.)], 20.0, 0.01);
    assert_eq!(standing(&case, &meets).0, Standing::Holds);
}

#[test]
fn an_act_of_the_log_without_its_motion_is_no_reaction() {
    // The leaves of the fixture by their place in the list.
    for (act, leaf) in [(Action::FollowRobot, 3), (Action::GiveWay, 6), (Action::RunAway, 2)] {
        let when = vec![Trigger::RobotNear(3.0)];
        let mut case = case(Predicate::Reacts { human: H1, when: when.clone(), act: act.clone(), within_s: 3.0 });
        case.plan.humans[0].rules =
            vec![Rule { when, act: act.clone(), for_s: Some(5.0), latched: true, ..Rule::default() }];
        case.plan.humans[0].relation = Relation::Static;
        let stands = Walk::human(1, 2., 0.9, 0., 0.).leaf(0.0, 1).leaf(8.8, leaf);
        let (found, evidence) = standing(&case, &recording(&[robot(), stands], 20.0, 0.01));
        assert_ne!(found, Standing::Holds, "{act:?}: {evidence}");
    }
}
