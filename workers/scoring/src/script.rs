//! Lines of the robot's script, the pace of people and where they go: what nearly does it does not.

use socrates_model::report::Standing;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{Action, AgentId, ClauseResult, EventKind, Gesture, HumanId, Predicate, Recording, Rule, Trigger};

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, event, node, paths, recording};

const H1: HumanId = HumanId::new(1);
const H2: HumanId = HumanId::new(2);
/// Leaves of the fixture.
const WALKS: u16 = 1;
const FOLLOWS: u16 = 3;
const STANDS: u16 = 7;

fn of(predicate: Predicate) -> Case {
    let plan = proposal(2, vec![must("c1", predicate)]);
    let ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], ""), (&["b", "m", "a"], "")]);
    Case { place: corridor(), plan, ways, reading: None }
}

fn line(when: RobotWhen, act: RobotDo) -> Case {
    let rule = RobotRule { when, act };
    let mut case = of(Predicate::RobotStep { rule: rule.clone(), within_s: 3.0 });
    case.plan.robot.script = vec![rule];
    case
}

fn found(case: &Case, run: &Recording) -> ClauseResult {
    case.judge(run).clauses.into_iter().find(|clause| clause.id == "c1").unwrap()
}

fn robot(stops: &[(f64, f64)]) -> Walk {
    Walk::through(AgentId::Robot, &stops.iter().map(|(t, x)| (*t, *x, -0.5)).collect::<Vec<_>>())
}

/// The robot with somebody who stands at (2, 1), makes signs as given, and somebody who stands far ahead.
fn with_guard(robot: Walk, signs: &[(f64, f64, Gesture)]) -> Recording {
    let guard = Walk::human(1, 2., 1., 0., 0.).leaf(0.0, STANDS);
    let guard = signs.iter().fold(guard, |guard, (from, to, gesture)| guard.says(*from, *to, *gesture));
    recording(&[robot, guard, Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS)], 30.0, 0.01)
}

fn all(case: &Case, tried: Vec<(&str, Recording, Standing)>) {
    for (what, run, wanted) in tried {
        let clause = found(case, &run);
        assert_eq!(clause.standing, wanted, "{what}: {}", clause.evidence);
    }
}

#[test]
fn what_the_robot_says_comes_after_its_reason_and_not_before() {
    // It is within 4 m of the guard at 7.8 s.
    let case = line(RobotWhen::HumanNear(4.0), RobotDo::Say(Gesture::ExcuseMe));
    let says = |from: f64, to: f64| with_guard(robot(&[(0., -8.), (20., 8.)]).says(from, to, Gesture::ExcuseMe), &[]);
    all(
        &case,
        vec![
            ("at once", says(7.9, 9.9), Standing::Holds),
            ("two seconds later", says(9.9, 11.9), Standing::Holds),
            ("before it", says(5.0, 7.0), Standing::Fails),
            ("long after it", says(17.0, 19.0), Standing::Fails),
            ("for a moment", says(7.9, 8.0), Standing::Fails),
            (
                "something else",
                with_guard(robot(&[(0., -8.), (20., 8.)]).says(7.9, 9.9, Gesture::Wait), &[]),
                Standing::Fails,
            ),
            ("never near", with_guard(robot(&[(0., -8.), (10., -4.)]), &[]), Standing::NotTriggered),
        ],
    );
}

#[test]
fn a_hold_is_a_stand_from_its_reason_on_with_motion_before_and_after_it() {
    let case = line(RobotWhen::AfterSecs(5.0), RobotDo::Hold(4.0));
    let drives = |stops: &[(f64, f64)]| with_guard(robot(stops), &[]);
    all(
        &case,
        vec![
            ("stands", drives(&[(0., -8.), (5.4, -4.), (9.2, -4.), (25., 7.)]), Standing::Holds),
            ("does not stop", drives(&[(0., -8.), (25., 7.)]), Standing::Fails),
            ("for a second", drives(&[(0., -8.), (5.4, -4.), (6.4, -4.), (25., 7.)]), Standing::Fails),
            ("too early", drives(&[(0., -8.), (1., -7.), (5.5, -7.), (25., 7.)]), Standing::Fails),
            ("too late", drives(&[(0., -8.), (15., 0.), (19., 0.), (25., 7.)]), Standing::Fails),
            ("stands from the start", drives(&[(0., -8.), (9., -8.), (25., 7.)]), Standing::Fails),
            ("stands for good", drives(&[(0., -8.), (5.4, -4.)]), Standing::Fails),
        ],
    );
    let start = line(RobotWhen::Start, RobotDo::Hold(4.0));
    all(
        &start,
        vec![
            ("waits at the start", drives(&[(0., -8.), (4., -8.), (25., 7.)]), Standing::Holds),
            ("sets off at once", drives(&[(0., -8.), (25., 7.)]), Standing::Fails),
            ("never sets off", drives(&[(0., -8.)]), Standing::Fails),
        ],
    );
}

#[test]
fn a_hold_until_a_moment_ends_with_it() {
    let case = line(RobotWhen::HumanSays(Gesture::Wait), RobotDo::HoldUntil(RobotWhen::HumanSays(Gesture::Proceed)));
    let both = [(5.0, 7.0, Gesture::Wait), (12.0, 14.0, Gesture::Proceed)];
    let run = |go_s: f64| with_guard(robot(&[(0., -8.), (5.6, -4.), (go_s, -4.), (go_s + 10., 6.)]), &both);
    let mut to_another = run(12.5);
    event(
        &mut to_another,
        5.0,
        EventKind::Gesture { agent: H1.into(), gesture: Some(Gesture::Wait), to: Some(AgentId::Human(H2)) },
    );
    let only_wait = with_guard(robot(&[(0., -8.), (5.6, -4.), (12.5, -4.), (22., 6.)]), &both[..1]);
    all(
        &case,
        vec![
            ("goes with it", run(12.5), Standing::Holds),
            ("sets off before it", run(9.0), Standing::Fails),
            ("goes long after it", run(21.0), Standing::Fails),
            ("never goes", with_guard(robot(&[(0., -8.), (5.6, -4.)]), &both), Standing::Fails),
            ("does not stop", with_guard(robot(&[(0., -8.), (20., 8.)]), &both), Standing::Fails),
            ("nobody says it", only_wait, Standing::NotTriggered),
            ("told to another", to_another, Standing::NotTriggered),
        ],
    );
}

#[test]
fn a_hold_until_somebody_is_done_ends_with_their_step() {
    let case = line(RobotWhen::AfterSecs(5.0), RobotDo::HoldUntil(RobotWhen::Did(H1, 1)));
    let run = |go_s: f64, ends: bool| {
        let mut run = with_guard(robot(&[(0., -8.), (5.4, -4.), (go_s, -4.), (go_s + 10., 6.)]), &[]);
        if ends {
            event(&mut run, 12.0, EventKind::StepEnded { human: H1, step: 1 });
        }
        run
    };
    all(
        &case,
        vec![
            ("goes with it", run(12.5, true), Standing::Holds),
            ("sets off before it", run(9.0, true), Standing::Fails),
            ("goes long after it", run(21.0, true), Standing::Fails),
        ],
    );
    let never = line(RobotWhen::Done(H1), RobotDo::Hold(2.0));
    assert_eq!(found(&never, &run(12.5, false)).standing, Standing::NotTriggered);
}

#[test]
fn the_robot_goes_with_those_whom_its_script_names() {
    let ahead = |x: f64, mps: f64| Walk::human(1, x, -0.5, mps, 0.).leaf(0.0, WALKS);
    let run = |robot: Walk, human: Walk| {
        recording(&[robot, human, Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS)], 20.0, 0.01)
    };
    all(
        &line(RobotWhen::Start, RobotDo::Follow(H1)),
        vec![
            ("behind them", run(Walk::robot(-8., -0.5, 0.6, 0.), ahead(-6., 0.6)), Standing::Holds),
            ("stays behind", run(Walk::robot(-8., -0.5, 0.0, 0.), ahead(-6., 0.6)), Standing::NotTriggered),
            ("ahead of them", run(Walk::robot(-6., -0.5, 0.6, 0.), ahead(-8., 0.6)), Standing::Fails),
        ],
    );
    let beside = |y: f64| Walk::human(1, -8., y, 0.6, 0.).leaf(0.0, WALKS);
    all(
        &line(RobotWhen::Start, RobotDo::Abreast(H1)),
        vec![
            ("beside them", run(Walk::robot(-8., -0.5, 0.6, 0.), beside(0.5)), Standing::Holds),
            ("behind them", run(Walk::robot(-10., -0.5, 0.6, 0.), beside(0.5)), Standing::Fails),
        ],
    );
    all(
        &line(RobotWhen::AfterSecs(2.0), RobotDo::Overtake(H1)),
        vec![
            ("passes", run(Walk::robot(-8., -1.0, 0.8, 0.), ahead(-5., 0.3)), Standing::Holds),
            ("stays behind", run(Walk::robot(-8., -1.0, 0.3, 0.), ahead(-6., 0.3)), Standing::Fails),
        ],
    );
}

#[test]
fn a_robot_that_leads_leaves_nobody_behind() {
    let mut case = line(RobotWhen::Start, RobotDo::Lead(3.0));
    case.plan.humans[0].rules =
        vec![Rule { when: vec![Trigger::Always], act: Action::FollowRobot, latched: true, ..Rule::default() }];
    let run = |stops: &[(f64, f64, f64)]| {
        let follower = Walk::human_through(1, stops).leaf(0.0, FOLLOWS);
        let other = Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS);
        recording(&[Walk::robot(-8., -0.5, 0.6, 0.), follower, other], 24.0, 0.01)
    };
    all(
        &case,
        vec![
            ("comes along", run(&[(0., -10., -0.5), (24., 4.4, -0.5)]), Standing::Holds),
            ("is left behind", run(&[(0., -10., -0.5), (8., -5.2, -0.5), (24., -5.2, -0.5)]), Standing::Fails),
            ("goes ahead", run(&[(0., -6., -0.5), (24., 8.4, -0.5)]), Standing::Fails),
        ],
    );
}

#[test]
fn a_pace_is_that_of_walking_before_anything_else() {
    let walks = |mps: f64| {
        let me = Walk::human_through(1, &[(0., 8., 0.9), (2., 8., 0.9), (2. + 10. / mps, -2., 0.9), (60., -8., 0.9)]);
        let me = me.leaf(0.0, WALKS).leaf(2. + 10. / mps, STANDS);
        recording(&[Walk::robot(-8., -0.5, 0.4, 0.), me, Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS)], 24.0, 0.01)
    };
    let hops: Vec<(f64, f64, f64)> =
        (0..12).map(|k| (f64::from(k), 8.0 - 1.5 * f64::from(k / 2 + k % 2), 0.9)).collect();
    let hops = Walk::human_through(1, &hops).leaf(0.0, WALKS);
    let hops = recording(
        &[Walk::robot(-8., -0.5, 0.4, 0.), hops, Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS)],
        24.0,
        0.01,
    );
    all(
        &of(Predicate::Walks { human: H1, mps: 1.5 }),
        vec![
            ("so fast", walks(1.5), Standing::Holds),
            ("a little slower", walks(1.35), Standing::Holds),
            ("slower", walks(1.2), Standing::Fails),
            ("faster", walks(1.8), Standing::Fails),
            ("for a second at a time", hops, Standing::Fails),
            ("stands", with_guard(robot(&[(0., -8.), (20., 8.)]), &[]), Standing::Fails),
        ],
    );
}

#[test]
fn a_goal_is_where_somebody_ends_or_is_well_on_the_way_to() {
    let run = |stops: &[(f64, f64)]| {
        let stops: Vec<(f64, f64, f64)> = stops.iter().map(|(t, x)| (*t, *x, 0.6)).collect();
        let me = Walk::human_through(1, &stops).leaf(0.0, WALKS);
        let other = Walk::human(2, 12., 1., 0., 0.).leaf(0.0, STANDS);
        recording(&[Walk::robot(-8., -0.5, 0.8, 0.), me, other], 16.0, 0.01)
    };
    // The way leads from (8, 0) to (-8, 0).
    all(
        &of(Predicate::GetsTo { human: H1, nodes: vec![node("a")] }),
        vec![
            ("ends there", run(&[(0., 8.), (15., -7.5)]), Standing::Holds),
            ("most of the way", run(&[(0., 8.), (20., -8.)]), Standing::Holds),
            ("only begins to", run(&[(0., 8.), (6., 8.), (16., -1.)]), Standing::Fails),
            ("stops on the way", run(&[(0., 8.), (12., -4.)]), Standing::Fails),
            ("goes through it and back", run(&[(0., 8.), (11., -8.), (16., -2.)]), Standing::Fails),
            ("stands there from the start", run(&[(0., -7.)]), Standing::Fails),
            ("stands", run(&[(0., 8.)]), Standing::Fails),
        ],
    );
    let elsewhere = of(Predicate::GetsTo { human: H1, nodes: vec![node("m")] });
    all(&elsewhere, vec![("the way leads elsewhere", run(&[(0., 8.), (10., 0.)]), Standing::Fails)]);
}
