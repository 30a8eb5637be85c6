//! Crowds, queues and groups in small, each with the mutants that must not hold.

use std::f64::consts::{FRAC_PI_2, PI};

use socrates_model::report::Standing;
use socrates_model::{AgentId, Clause, ClauseRole, GroupId, HumanId, Predicate, Report};

use crate::cases::{Case, corridor, group_of, must, proposal};
use crate::fixture::{Walk, event, floor, paths, recording};
use crate::scenarios::elevator;

const H1: HumanId = HumanId::new(1);

/// A corridor with so many humans, who have clauses through one predicate.
fn crowd(humans: u32, predicate: Predicate) -> Case {
    let plan = proposal(humans, vec![must("c1", predicate)]);
    let nobody: Vec<(&[&str], &str)> = (0..humans).map(|_| (&["b", "m", "a"][..], "")).collect();
    Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &nobody), reading: None }
}

fn standing(case: &Case, walks: &[Walk], seconds: f64) -> (Standing, String) {
    let report: Report = case.judge(&recording(walks, seconds, 0.01));
    let clause = report.clauses.iter().find(|clause| clause.id == "c1").unwrap();
    (clause.standing, clause.evidence.clone())
}

fn robot() -> Walk {
    Walk::robot(-8., -0.5, 0.8, 0.)
}

#[test]
fn who_walks_beside_or_ahead_the_same_way_is_parallel_and_who_comes_is_not() {
    let case = crowd(1, Predicate::Parallel { human: H1, for_s: 5.0 });
    assert_eq!(standing(&case, &[robot(), Walk::human(1, -7., 0.5, 0.85, 0.)], 15.0).0, Standing::Holds);
    // Meets the robot and walks on: 2 m of way are on the same side of 4 m, but the heading is against it.
    assert_eq!(standing(&case, &[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 15.0).0, Standing::Fails);
    // The same way, far ahead.
    assert_eq!(standing(&case, &[robot(), Walk::human(1, -2., 0.5, 0.8, 0.)], 12.0).0, Standing::NotTriggered);
    // Beside it for three seconds only.
    let brief = Walk::human_through(1, &[(0., -7., 0.5), (3., -4.6, 0.5), (4., -4.6, 0.5), (15., -4.6, 1.2)]);
    assert_eq!(standing(&case, &[robot(), brief], 15.0).0, Standing::Fails);
}

#[test]
fn a_stream_is_counted_by_people_and_by_angle() {
    let stream = |count: u32, vx: f64| -> Vec<Walk> {
        let mut walks = vec![robot()];
        for n in 0..count {
            walks.push(Walk::human(n + 1, f64::from(n) * 2.0, 0.7, vx, 0.));
        }
        walks
    };
    let oncoming = Predicate::Flow { count: 4, within_m: 3.0, angle_deg: [150.0, 180.0] };
    assert_eq!(standing(&crowd(4, oncoming.clone()), &stream(4, -0.8), 15.0).0, Standing::Holds);
    let (found, evidence) = standing(&crowd(4, oncoming.clone()), &stream(3, -0.8), 15.0);
    assert_eq!(found, Standing::NotTriggered, "{evidence}");
    // They stand: near, but no stream.
    assert_eq!(standing(&crowd(4, oncoming.clone()), &stream(4, 0.0), 15.0).0, Standing::Fails);
    let across = Predicate::Flow { count: 4, within_m: 3.0, angle_deg: [60.0, 120.0] };
    assert_eq!(standing(&crowd(4, across), &stream(4, -0.8), 15.0).0, Standing::Fails);
}

#[test]
fn density_is_people_in_the_disc_over_its_area() {
    // Four people about the robot as it stands: 4 / (pi 2²) = 0.318 per m².
    let still = || Walk::robot(0., 0., 0., 0.);
    let ring = |reach: f64| -> Vec<Walk> {
        let mut walks = vec![still()];
        for n in 0..4_u32 {
            let angle = f64::from(n) * FRAC_PI_2;
            walks.push(Walk::human(n + 1, reach * angle.cos(), reach * angle.sin(), 0., 0.));
        }
        walks
    };
    let asked = |low, high| Predicate::Density { per_m2: [low, high], radius_m: 2.0, for_s: 3.0 };
    assert_eq!(standing(&crowd(4, asked(0.2, 0.6)), &ring(1.4), 5.0).0, Standing::Holds);
    assert_eq!(standing(&crowd(4, asked(0.35, 0.6)), &ring(1.4), 5.0).0, Standing::NotTriggered);
    assert_eq!(standing(&crowd(4, asked(0.1, 0.3)), &ring(1.4), 5.0).0, Standing::Fails);
    assert_eq!(standing(&crowd(4, asked(0.2, 0.6)), &ring(2.2), 5.0).0, Standing::NotTriggered);
}

#[test]
fn three_people_all_round_the_robot_surround_it_and_two_do_not() {
    let case = crowd(3, Predicate::Surrounds { count: 3, within_m: 1.2, for_s: 5.0 });
    let around = |third: Walk| {
        let still = Walk::robot(0., 0., 0., 0.);
        vec![still, Walk::human(1, 1.0, 0.2, 0., 0.), Walk::human(2, -0.8, 0.7, 0., 0.), third]
    };
    let comes = Walk::human_through(3, &[(0., 0., -1.4), (2., 0., -1.0), (9., 0., -1.0), (12., 0., -1.4)]);
    let (found, evidence) = standing(&case, &around(comes), 12.0);
    assert_eq!(found, Standing::Holds, "{evidence}");
    let far = Walk::human(3, 0., -1.4, 0., 0.);
    assert_eq!(standing(&case, &around(far), 12.0).0, Standing::NotTriggered);
    let brief = Walk::human_through(3, &[(0., 0., -1.4), (2., 0., -1.0), (5., 0., -1.0), (6., 0., -1.4)]);
    assert_eq!(standing(&case, &around(brief), 12.0).0, Standing::Fails);
}

#[test]
fn people_converge_who_come_to_the_place_at_one_time() {
    let mut case = crowd(2, Predicate::Converges { within_m: 1.0, within_s: 3.0 });
    case.ways = paths(&["a", "m", "b"], &[(&["b", "m"], "m"), (&["a", "m"], "m")]);
    let come = |start: f64, from: f64, n: u32| {
        Walk::human_through(n, &[(0., from, 0.6), (start, from, 0.6), (start + 6., 0.6 * from.signum(), 0.6)])
    };
    let run = |second: Walk| standing(&case, &[robot(), come(1.0, 6., 1), second], 14.0);
    assert_eq!(run(come(2.0, -6., 2)).0, Standing::Holds);
    assert_eq!(run(come(5.5, -6., 2)).0, Standing::Late);
    let (found, evidence) = run(Walk::human(2, -6., 0.6, 0., 0.));
    assert_eq!(found, Standing::NotTriggered, "{evidence}");
    let waits = run(Walk::human(2, -0.6, 0.6, 0., 0.));
    assert_eq!(waits.0, Standing::Fails, "who waits there does not come: {}", waits.1);
}

/// The elevator with one who goes in while the robot comes out.
fn going_in(outcome: bool) -> Case {
    let mut case = elevator();
    let enters = must("c1", Predicate::Enters { human: H1, door: String::new() });
    let first = Clause { role: ClauseRole::Outcome, ..must("o1", Predicate::RobotLeavesFirst) };
    case.plan = proposal(1, if outcome { vec![enters, first] } else { vec![enters] });
    case.ways = paths(&["c", "l", "a"], &[(&["l", "c"], "l")]);
    case
}

#[test]
fn entering_is_crossing_inward_once_and_the_robot_may_be_first() {
    let goes_in = |start: f64| Walk::human_through(1, &[(0., -2., 1.0), (start, 0.5, 0.9), (start + 6., 5.5, 0.6)]);
    let robot =
        || Walk::through(AgentId::Robot, &[(0., 5.5, -0.5), (4., 5.5, -0.5), (12., 1.0, -0.5), (19., -6., -0.5)]);
    let judge = |human: Walk| {
        let mut run = recording(&[robot(), human], 20.0, 0.01);
        event(&mut run, 0.5, socrates_model::EventKind::Door { door: "car".into(), open: true });
        let report = going_in(true).judge(&run);
        let of = |id: &str| report.clauses.iter().find(|clause| clause.id == id).unwrap().clone();
        (of("c1"), of("o1"))
    };
    let (enters, first) = judge(goes_in(6.0));
    assert_eq!((enters.standing, first.standing), (Standing::Holds, Standing::Holds), "{}", first.evidence);
    let (enters, first) = judge(goes_in(0.5));
    assert_eq!((enters.standing, first.standing), (Standing::Holds, Standing::Fails), "{}", first.evidence);
    let (enters, first) = judge(Walk::human(1, -2., 1.0, 0.1, 0.));
    assert_eq!((enters.standing, first.standing), (Standing::Fails, Standing::NotTriggered));
    let twice = Walk::human_through(1, &[(0., -2., 1.), (6., 5.5, 0.8), (11., 1.0, 0.8), (16., 5.5, 0.8)]);
    assert_eq!(judge(twice).0.standing, Standing::Fails);
    assert_eq!(judge(Walk::human(1, 7., 1.5, 0., 0.)).0.standing, Standing::Fails);
}

#[test]
fn a_queue_is_a_line_with_even_gaps() {
    let case = || {
        let mut case = crowd(4, Predicate::Queues { group: GroupId(1), gap_m: [0.6, 1.4] });
        case.plan = group_of(case.plan, &[1, 2, 3, 4]);
        case.place = floor(
            &[],
            &[("a", "OPEN AREA", -8., 0.), ("m", "OPEN AREA", 0., 0.), ("b", "OPEN AREA", 8., 0.)],
            &[("a", "m"), ("m", "b")],
        );
        case
    };
    let line = |points: [(f64, f64); 4]| -> Vec<Walk> {
        let mut walks = vec![robot()];
        walks.extend(points.iter().zip(1..).map(|((x, y), n)| Walk::human(n, *x, *y, 0., 0.)));
        walks
    };
    let (found, evidence) = standing(&case(), &line([(0., 1.), (0.9, 1.2), (1.8, 1.1), (2.8, 1.0)]), 18.0);
    assert_eq!(found, Standing::Holds, "{evidence}");
    let gap = line([(0., 1.), (0.9, 1.0), (1.8, 1.0), (4.8, 1.0)]);
    assert_eq!(standing(&case(), &gap, 18.0).0, Standing::Fails);
    let ring = line([(0., 1.), (1.2, 1.), (1.2, 2.2), (0., 2.2)]);
    assert_eq!(standing(&case(), &ring, 18.0).0, Standing::Fails);
    let mut walks = line([(0., 1.), (0.9, 1.2), (1.8, 1.1), (2.8, 1.0)]);
    walks.pop();
    walks.push(Walk::human_through(4, &[(0., 2.8, 1.0), (3., 2.8, 1.0), (9., 7., 1.2)]));
    assert_eq!(standing(&case(), &walks, 18.0).0, Standing::Fails, "one walks off before the robot is there");
}

#[test]
fn the_robot_meets_a_queue_in_the_one_it_comes_nearest_and_other_groups_in_everybody() {
    let line = || (1..=4).map(|n| Walk::human(n, 1.2 * f64::from(n), 1.0 + 1.0 * f64::from(n), 0., 0.));
    let verdict = |predicate: Predicate, robot: Walk| {
        let mut case = crowd(4, predicate);
        case.plan = group_of(case.plan, &[1, 2, 3, 4]);
        case.ways = paths(&["a", "m", "b"], &[(&["m"], "m"), (&["m"], "m"), (&["m"], "m"), (&["m"], "m")]);
        let walks: Vec<Walk> = [robot].into_iter().chain(line()).collect();
        let report = case.judge(&recording(&walks, 18.0, 0.01));
        let failed = |id: &str| report.clauses.iter().any(|found| found.id == id && found.standing != Standing::Holds);
        (1..=4).map(|n| failed(&format!("auto-meet-human_{n}"))).collect::<Vec<bool>>()
    };
    let queues = || Predicate::Queues { group: GroupId(1), gap_m: [0.6, 2.0] };
    assert_eq!(verdict(queues(), robot()), [false; 4]);
    assert_eq!(verdict(Predicate::Humans { count: 4 }, robot()), [false, true, true, true]);
    let away = Walk::robot(-8., -6.0, 0.8, 0.);
    assert_eq!(verdict(queues(), away), [true, false, false, false], "the robot never meets the queue");
}

/// Three people in a circle of 0.8 m about (0, 2), and the robot.
fn with_circle(robot: Walk) -> Vec<Walk> {
    let mut walks = vec![robot];
    for n in 0..3_u32 {
        let angle = f64::from(n) * 2.0 * PI / 3.0 + FRAC_PI_2;
        walks.push(Walk::human(n + 1, 0.8 * angle.cos(), 2.0 + 0.8 * angle.sin(), 0., 0.).facing(angle + PI));
    }
    walks
}

#[test]
fn the_robot_joins_a_group_at_its_rim_and_leaves_it_by_going_away() {
    let of = |predicate: Predicate| {
        let mut case = crowd(3, predicate);
        case.plan = group_of(case.plan, &[1, 2, 3]);
        case.plan.expected_events[0].role = ClauseRole::Outcome;
        case
    };
    let to = |y: f64| Walk::through(AgentId::Robot, &[(0., 0., -6.), (10., 0., y)]);
    let joins = of(Predicate::RobotJoins { group: GroupId(1) });
    assert_eq!(standing(&joins, &with_circle(to(1.1)), 12.0).0, Standing::Holds);
    assert_eq!(standing(&joins, &with_circle(to(1.6)), 12.0).0, Standing::Fails, "inside the o-space");
    assert_eq!(standing(&joins, &with_circle(to(0.0)), 12.0).0, Standing::Fails, "too far away");
    let leaves = of(Predicate::RobotLeavesGroup { group: GroupId(1) });
    let from = |end: f64| Walk::through(AgentId::Robot, &[(0., 0., 1.1), (8., 0., end)]);
    assert_eq!(standing(&leaves, &with_circle(from(-3.0)), 12.0).0, Standing::Holds);
    assert_eq!(standing(&leaves, &with_circle(from(0.4)), 12.0).0, Standing::Fails);
    assert_eq!(standing(&leaves, &with_circle(to(-3.0)), 12.0).0, Standing::NotTriggered);
}
