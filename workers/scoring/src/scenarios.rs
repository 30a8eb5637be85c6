//! Scenarios in small, each with the mutants that must not be realised.

use std::f64::consts::PI;

use socrates_model::job::Stage;
use socrates_model::reading::{Fact, FactKind};
use socrates_model::report::Standing;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Action, AgentId, Clause, ClauseRole, Door, DoorKind, DoorOpens, EventKind, FORMAT, FaultCode, Gesture, GroupId,
    HumanId, PlaceClass, Point, Predicate, Reading, Recording, Relation, Rule, Trigger, Verdict,
};

use crate::cases::{Case, corridor, group_of, must, proposal};
use crate::evidence::Evidence;
use crate::fixture::{Walk, event, floor, paths, recording};
use crate::score::score;

const H1: HumanId = HumanId::new(1);

fn frontal() -> Case {
    Case {
        place: corridor(),
        plan: proposal(1, vec![must("c1", Predicate::HeadOn { human: H1 })]),
        ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]),
        reading: None,
    }
}

fn robot() -> Walk {
    Walk::robot(-8., -0.5, 0.8, 0.)
}

#[test]
fn a_frontal_approach_that_happens_is_realised_and_told_with_times() {
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    let report = frontal().judge(&run);
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert!(report.verdict_text.starts_with("6 of 6 setup clauses · encounter gap"), "{}", report.verdict_text);
    assert!((report.score - 1.0).abs() < 1e-9);
    assert_eq!(report.repair, None);
    assert!(report.story.iter().any(|line| line.contains("human_1 and the robot are closest, 1.00 m")));
    assert_eq!(report.encounter_gaps_s.len(), 1);
    assert!(report.success);
}

#[test]
fn a_run_in_which_they_never_meet_is_never_realised() {
    // Promising nothing: the only clause is that people are there.
    let mut case = frontal();
    case.plan.expected_events = vec![must("c1", Predicate::Humans { count: 1 })];
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, 0., 0.)], 9.0, 0.01);
    let report = case.judge(&run);
    assert_eq!(report.verdict, Verdict::NotTriggered);
    let repair = report.repair.unwrap();
    assert_eq!(repair.stage, Stage::Paths);
    assert_eq!(repair.faults[0].code, FaultCode::DNoMeet);
    assert!(repair.faults[0].message.to_string().contains("nearest to `m`"), "{}", repair.faults[0].message);
}

#[test]
fn a_human_who_walks_the_same_way_does_not_come_head_on() {
    let verdict = frontal().verdict(&[robot(), Walk::human(1, -5., 0.5, 0.6, 0.)], 20.0);
    assert_eq!(verdict, Verdict::Contradicted);
    let missing = frontal().verdict(&[robot()], 20.0);
    assert_eq!(missing, Verdict::Contradicted);
}

/// A corridor that turns to the left, and the robot's way round the corner.
fn corner() -> Case {
    let nodes = [("a", "CORRIDOR", -8., 0.), ("m", "BLIND CORNER", 0., 0.), ("b", "CORRIDOR", 0., 8.)];
    Case {
        place: floor(&[(-10., 10., 2., 11.)], &nodes, &[("a", "m"), ("m", "b")]),
        plan: proposal(1, vec![must("c1", Predicate::HeadOn { human: H1 })]),
        ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]),
        reading: None,
    }
}

#[test]
fn round_a_corner_people_come_towards_the_robot_along_its_way() {
    let robot = || Walk::through(AgentId::Robot, &[(0., -8., -0.5), (10., -0.5, -0.5), (20., 0.5, 8.)]);
    // They pass each other in the corner itself, where neither heading tells of it.
    let human = Walk::human_through(1, &[(0., 0.5, 9.), (9.5, 0.2, 0.6), (20., -8., 0.6)]);
    let report = corner().judge(&recording(&[robot(), human], 20.0, 0.01));
    let head_on = report.clauses.iter().find(|clause| clause.id == "c1").unwrap();
    assert_eq!(head_on.standing, Standing::Holds, "{}", head_on.evidence);
    // Ahead of the robot and on its way, but walking the same way.
    let away = Walk::human_through(1, &[(0., -4., 0.), (8., -0.2, 0.), (20., 0.2, 8.)]);
    let report = corner().judge(&recording(&[robot(), away], 20.0, 0.01));
    let head_on = report.clauses.iter().find(|clause| clause.id == "c1").unwrap();
    assert_ne!(head_on.standing, Standing::Holds, "{}", head_on.evidence);
}

#[test]
fn an_overlap_or_a_jump_proves_nothing() {
    let through = frontal().verdict(&[robot(), Walk::human(1, 8., -0.4, -0.8, 0.)], 20.0);
    assert_eq!(through, Verdict::Invalid);
    let fast = Walk::human_through(1, &[(0., 8., 0.5), (5., 8., 0.5), (8., -1., 0.5), (20., -8., 0.5)]);
    assert_eq!(frontal().verdict(&[robot(), fast], 20.0), Verdict::Invalid);
    let mut broken = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    broken.frames[77].y = f64::INFINITY;
    assert_eq!(frontal().judge(&broken).verdict, Verdict::Invalid);
}

#[test]
fn what_only_another_planner_misses_was_prevented_by_the_robot() {
    let reference = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    let mut run = recording(&[Walk::robot(-8., -0.5, 0., 0.), Walk::human(1, 8., 0.5, -0.2, 0.)], 20.0, 0.01);
    run.header.planner = "mppi".parse().unwrap();
    let case = frontal();
    let evidence = Evidence {
        location: Some(&case.place),
        proposal: Some(&case.plan),
        paths: Some(&case.ways),
        reference: Some(&reference),
        ..Evidence::of(&run)
    };
    let report = score(&evidence);
    assert_eq!(report.verdict, Verdict::RobotPrevented);
    assert_eq!(report.repair, None);
    assert!(!report.success);
    assert_eq!(score(&Evidence { reference: None, ..evidence }).verdict, Verdict::NotTriggered);
}

#[test]
fn tracks_alone_have_nothing_to_verify_but_their_metrics() {
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.1);
    let report = score(&Evidence::of(&run));
    assert_eq!(report.verdict, Verdict::Invalid);
    assert!(report.verdict_text.starts_with("nothing to verify"), "{}", report.verdict_text);
    let of = |id: &str| report.metrics.iter().find(|metric| metric.id == id).unwrap();
    assert!(of("human_distance_min").value.is_some());
    assert_eq!(of("spl").value, None);
    assert!(of("spl").note.starts_with("not applicable"));
}

#[test]
fn a_fact_without_a_clause_makes_the_run_unverifiable() {
    let mut case = frontal();
    let rule = Rule { when: vec![Trigger::RobotNear(3.0)], act: Action::RunAway, ..Rule::default() };
    let fact = Fact { id: "f1".into(), quote: "runs away".into(), kind: FactKind::Reacts { human: H1, rule } };
    case.reading = Some(Reading { format: FORMAT, facts: vec![fact], ..Reading::default() });
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    let report = case.judge(&run);
    assert_eq!(report.verdict, Verdict::Invalid);
    assert!(report.verdict_text.contains("f1"), "{}", report.verdict_text);
    assert_eq!(report.repair.unwrap().faults[0].code, FaultCode::PVerify);
}

/// A human comes up to the robot, sees it at 4 m, and runs.
fn frightened(trigger_m: f64) -> Case {
    let when = vec![Trigger::RobotVisible(trigger_m)];
    let mut case = frontal();
    case.plan.expected_events = vec![
        must("c1", Predicate::Reacts { human: H1, when: when.clone(), act: Action::RunAway, within_s: 1.0 }),
        must("c2", Predicate::RunsAway { human: H1, by_m: 1.5 }),
        must("c3", Predicate::Meets { human: H1, within_m: 4.5 }),
    ];
    case.plan.humans[0].rules = vec![Rule { when, act: Action::RunAway, latched: true, ..Rule::default() }];
    case.ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], "")]);
    case
}

fn runner() -> Walk {
    // Distances: 16 m at 0 s, closing at 1.6 m/s: 4 m at 7.5 s.
    Walk::human_through(1, &[(0., 8., 0.5), (7.6, 1.92, 0.5), (13., 10.6, 0.5)]).leaf(0.0, 1).leaf(7.6, 2)
}

#[test]
fn a_reaction_in_time_is_realised_and_one_before_its_trigger_is_early() {
    let run = recording(&[robot(), runner()], 13.0, 0.01);
    let report = frightened(4.1).judge(&run);
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    let early = frightened(2.0).judge(&run);
    assert_eq!(early.verdict, Verdict::Contradicted, "{}", early.verdict_text);
    let repair = early.repair.unwrap();
    assert_eq!(repair.faults[0].code, FaultCode::DEarly);
    assert_eq!(repair.stage, Stage::Behaviors);
}

#[test]
fn a_leaf_without_its_motion_is_no_reaction() {
    let walks_on = Walk::human(1, 8., 0.5, -0.8, 0.).leaf(0.0, 1).leaf(7.6, 2);
    let verdict = frightened(4.1).verdict(&[robot(), walks_on], 9.0);
    assert_eq!(verdict, Verdict::Contradicted);
}

#[test]
fn a_reaction_whose_trigger_never_comes_goes_to_whoever_can_bring_it_about() {
    let mut case = frontal();
    let when = vec![Trigger::RobotSays(Gesture::ExcuseMe)];
    case.plan.expected_events =
        vec![must("c1", Predicate::Reacts { human: H1, when, act: Action::GiveWay, within_s: 2.0 })];
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    let report = case.judge(&run);
    assert_eq!(report.verdict, Verdict::NotTriggered);
    let repair = report.repair.unwrap();
    assert_eq!((repair.stage, repair.faults[0].code), (Stage::Proposal, FaultCode::DNoTrig));
    let told = repair.faults[0].message.to_string();
    assert!(told.contains("never says EXCUSE_ME: its script has no such line"), "{told}");

    // With a line that waits for somebody in the way, the message says how long that was at the longest.
    let line = RobotRule { when: RobotWhen::Blocked(2.0), act: RobotDo::Say(Gesture::ExcuseMe) };
    case.plan.robot.script = vec![line];
    let told = case.judge(&run).repair.unwrap().faults[0].message.to_string();
    assert!(told.contains("when it was blocked for 2 s (0.") && told.contains("s at the longest"), "{told}");

    // Somebody whom the robot does not come near enough to is for those who say how near that is.
    let when = vec![Trigger::RobotNear(0.2)];
    case.plan.expected_events =
        vec![must("c1", Predicate::Reacts { human: H1, when, act: Action::GiveWay, within_s: 2.0 })];
    let repair = case.judge(&run).repair.unwrap();
    assert_eq!(repair.stage, Stage::Behaviors);
    let told = repair.faults[0].message.to_string();
    assert!(told.contains("comes no nearer than 1.0 m"), "{told}");
}

#[test]
fn an_order_of_which_a_part_never_came_is_told_of_by_that_part() {
    let mut case = frontal();
    let waits = Predicate::Reacts {
        human: H1,
        when: vec![Trigger::RobotSays(Gesture::ExcuseMe)],
        act: Action::GiveWay,
        within_s: 2.0,
    };
    let order = |first: &str, then: &str| Predicate::Order { first: first.into(), then: then.into() };
    let meets = must("c2", Predicate::EncounterAt { place: PlaceClass::Corridor, nodes: vec![], human: None });
    case.plan.expected_events = vec![must("c1", waits), meets, must("c3", order("c2", "c1"))];
    let run = recording(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 20.0, 0.01);
    let told = |case: &Case| {
        let repair = case.judge(&run).repair.unwrap();
        let faults: Vec<String> = repair.faults.iter().map(ToString::to_string).collect();
        (repair.stage, faults.join("\n"))
    };
    let (stage, faults) = told(&case);
    assert_eq!(stage, Stage::Proposal, "{faults}");
    assert!(faults.contains("clause c1") && !faults.contains("clause c3"), "{faults}");

    // The part decides nothing by itself: the order is told with what is wrong with it.
    case.plan.expected_events[0].must = false;
    let (stage, faults) = told(&case);
    assert_eq!(stage, Stage::Proposal, "{faults}");
    assert!(faults.contains("waits for it: clause c1") && faults.contains("never says EXCUSE_ME"), "{faults}");
}

#[test]
fn nobody_behind_a_wall_stands_aside_or_is_passed() {
    let run = recording(&[robot(), Walk::human(1, 0., 1.6, 0., 0.)], 20.0, 0.01);
    let judged = |walls: &[(f64, f64, f64, f64)], predicate: Predicate| {
        let mut case = frontal();
        case.place = floor(
            walls,
            &[("a", "CORRIDOR", -8., 0.), ("m", "CORRIDOR", 0., 0.), ("b", "CORRIDOR", 8., 0.)],
            &[("a", "m"), ("m", "b")],
        );
        case.plan.humans[0].relation = Relation::Aside;
        case.plan.expected_events = vec![must("c1", predicate)];
        let report = case.judge(&run);
        report.clauses.into_iter().find(|clause| clause.id == "c1").unwrap()
    };
    for predicate in [Predicate::StaysAside { human: H1 }, Predicate::RobotPasses { human: H1 }] {
        let open = judged(&[(-9., 2.4, 9., 2.5)], predicate.clone());
        assert_eq!(open.standing, Standing::Holds, "{}", open.evidence);
        let behind = judged(&[(-9., 0.9, 9., 1.0)], predicate);
        assert_ne!(behind.standing, Standing::Holds, "{}", behind.evidence);
        assert!(behind.evidence.contains("a wall is between"), "{}", behind.evidence);
    }
}

#[test]
fn a_follower_behind_holds_and_one_ahead_does_not() {
    let follows =
        Predicate::Follows { follower: AgentId::Human(H1), leader: AgentId::Robot, gap_m: [0.5, 3.0], for_s: 6.0 };
    let mut case = frontal();
    case.plan.expected_events = vec![must("c1", follows)];
    case.plan.humans[0].relation = Relation::Behind;
    assert_eq!(case.verdict(&[robot(), Walk::human(1, -10., -0.5, 0.8, 0.)], 18.0), Verdict::Realised);
    assert_eq!(case.verdict(&[robot(), Walk::human(1, -6., -0.5, 0.8, 0.)], 18.0), Verdict::Contradicted);
    // A gap of 6 m that is never nearer.
    assert_eq!(case.verdict(&[robot(), Walk::human(1, -14., -0.5, 0.8, 0.)], 18.0), Verdict::NotTriggered);
}

#[test]
fn a_blocker_must_be_in_the_way_long_enough() {
    let mut case = frontal();
    case.plan.expected_events = vec![must("c1", Predicate::Blocks { human: H1, for_s: 3.0 })];
    case.plan.humans[0].relation = Relation::Static;
    case.ways = paths(&["a", "m", "b"], &[(&["m"], "m")]);
    let waits = || Walk::through(AgentId::Robot, &[(0., -8., 0.), (8., -1.5, 0.), (14., -1.5, 0.), (25., 8., 0.)]);
    let blocks = Walk::human_through(1, &[(0., 0., 0.), (13., 0., 0.), (14., 0., 1.0)]);
    assert_eq!(case.verdict(&[waits(), blocks], 25.0), Verdict::Realised);
    let beside = Walk::human_through(1, &[(0., 0., 1.1)]);
    assert_eq!(case.verdict(&[waits(), beside], 25.0), Verdict::Contradicted);
    let brief =
        Walk::human_through(1, &[(0., 0., 1.1), (9., 0., 1.1), (10., 0., 0.3), (10.5, 0., 0.3), (11.5, 0., 1.1)]);
    assert_eq!(case.verdict(&[waits(), brief], 25.0), Verdict::Contradicted);
}

#[test]
fn crossing_is_judged_by_angle_and_time() {
    let place = floor(
        &[],
        &[
            ("a", "CORRIDOR", -8., 0.),
            ("m", "JUNCTION", 0., 0.),
            ("b", "CORRIDOR", 8., 0.),
            ("s", "CORRIDOR", 0., -8.),
            ("n", "CORRIDOR", 0., 8.),
        ],
        &[("a", "m"), ("m", "b"), ("s", "m"), ("m", "n")],
    );
    let case = Case {
        place,
        plan: proposal(1, vec![must("c1", Predicate::Crosses { human: H1, gap_s: 2.0 })]),
        ways: paths(&["a", "m", "b"], &[(&["s", "m", "n"], "m")]),
        reading: None,
    };
    let late = |seconds: f64| Walk::human_through(1, &[(0., 0., -8.), (seconds, 0., -8.), (seconds + 20., 0., 8.)]);
    let robot = || Walk::robot(-8., 0., 0.8, 0.);
    assert_eq!(case.verdict(&[robot(), late(1.5)], 24.0), Verdict::Realised);
    assert_eq!(case.verdict(&[robot(), late(3.0)], 24.0), Verdict::RealisedLate);
    assert_ne!(case.verdict(&[robot(), late(9.0)], 30.0), Verdict::Realised);
    let along = Walk::human_through(1, &[(0., 8., 0.8), (20., -8., 0.8)]);
    assert_eq!(case.verdict(&[robot(), along], 24.0), Verdict::Contradicted);
}

pub(crate) fn elevator() -> Case {
    // A car behind the wall x = 4, door from (4, -1) to (4, 1).
    let mut place = floor(
        &[(4., 1.0, 4.1, 3.0), (4., -3.0, 4.1, -1.0), (4., 3.0, 8., 3.1), (4., -3.1, 8., -3.0), (8., -3., 8.1, 3.)],
        &[
            ("a", "CORRIDOR", -8., 0.),
            ("l", "ELEVATOR LOBBY", 1., 0.),
            ("c", "IN ELEVATOR", 5.5, 0.),
            ("d", "IN ELEVATOR", 7., 1.5),
        ],
        &[("a", "l"), ("l", "c"), ("c", "d")],
    );
    place.doors.push(Door {
        id: "car".into(),
        kind: DoorKind::Elevator,
        from: Point::new(4.05, -1.),
        to: Point::new(4.05, 1.),
        opens: DoorOpens::RobotNear(3.0),
        hold_s: 15.0,
        inside: vec![crate::fixture::node("c"), crate::fixture::node("d")],
    });
    let mut plan = proposal(
        2,
        vec![
            must("c1", Predicate::Leaves { human: H1, door: String::new() }),
            must("c2", Predicate::StaysInside { human: HumanId::new(2), door: String::new() }),
            must("c3", Predicate::DoorOpens { door: String::new(), robot_m: [1.0, 4.0] }),
            must("c4", Predicate::HiddenUntil { human: HumanId::new(2), within_m: 5.0 }),
            must("c5", Predicate::EncounterAt { place: PlaceClass::Elevator, nodes: vec![], human: None }),
            must("c6", Predicate::Looks { human: HumanId::new(2), for_s: 2.0 }),
            must("c7", Predicate::Order { first: "c3".into(), then: "c1".into() }),
            Clause { role: ClauseRole::Outcome, ..must("o1", Predicate::RobotEntersLast) },
        ],
    );
    plan.humans[0].relation = Relation::Leaving;
    plan.humans[1].relation = Relation::Staying;
    plan.robot.script = vec![RobotRule { when: RobotWhen::Start, act: RobotDo::WaitForLeavers }];
    Case { place, plan, ways: paths(&["a", "l", "c"], &[(&["c", "l", "a"], "l"), (&["d"], "c")]), reading: None }
}

fn elevator_run(leaver: Walk, opens_s: f64) -> Recording {
    let robot = Walk::through(AgentId::Robot, &[(0., -8., 0.), (12.5, 1.5, -1.2), (19., 1.5, -1.2), (25., 5.5, 0.)]);
    // Turns to the door as it opens.
    let stayer = Walk::human_through(2, &[(0., 7., 1.2), (11., 7., 1.2), (12., 7., 1.5)]).facing(-2.7);
    let mut run = recording(&[robot, leaver, stayer], 30.0, 0.01);
    event(&mut run, opens_s, EventKind::Door { door: "car".into(), open: true });
    run
}

fn leaver() -> Walk {
    Walk::human_through(1, &[(0., 5.5, 0.), (14., 5.5, 0.), (18., 1.5, 0.5), (25., -6., 0.5)])
}

#[test]
fn an_elevator_with_one_who_leaves_and_one_who_stays_is_realised() {
    let report = elevator().judge(&elevator_run(leaver(), 12.0));
    assert_eq!(report.verdict, Verdict::Realised, "{}\n{:#?}", report.verdict_text, report.clauses);
    assert!(report.robot_text.contains("entered after everybody had left"), "{}", report.robot_text);
    assert!(report.story.iter().any(|line| line == "12.0 s  car opens"), "{:?}", report.story);
}

#[test]
fn a_place_that_is_named_is_judged_by_its_nodes() {
    let at = |node: &str| {
        let mut case = elevator();
        for clause in &mut case.plan.expected_events {
            if let Predicate::EncounterAt { nodes, .. } = &mut clause.predicate {
                nodes.push(crate::fixture::node(node));
            }
        }
        let report = case.judge(&elevator_run(leaver(), 12.0));
        report.clauses.iter().find(|clause| clause.id == "c5").unwrap().standing
    };
    assert_eq!(at("c"), Standing::Holds);
    // A human who stays inside is met before the door.
    assert_eq!(at("d"), Standing::Holds);
    // Nobody is met there, and nobody comes out of it.
    assert_eq!(at("a"), Standing::Fails);
}

#[test]
fn elevator_mutants_are_not_realised() {
    let stays = Walk::human_through(1, &[(0., 5.5, -2.0)]);
    let stays = elevator().judge(&elevator_run(stays, 12.0));
    assert_eq!(stays.verdict, Verdict::NotTriggered, "who never comes out never meets the robot outside");
    let clause = stays.clauses.iter().find(|clause| clause.id == "c1").unwrap();
    assert_eq!(clause.standing, Standing::Fails);
    let early_door = elevator().judge(&elevator_run(leaver(), 1.0));
    assert_eq!(early_door.verdict, Verdict::Contradicted);
    let clause = early_door.clauses.iter().find(|clause| clause.id == "c3").unwrap();
    assert_eq!(clause.standing, Standing::Fails);
    let returns =
        Walk::human_through(1, &[(0., 5.5, 0.), (13., 5.5, 0.), (17., 2.5, 0.4), (21., 5.5, 1.6), (30., 5.5, 1.6)]);
    assert_ne!(elevator().judge(&elevator_run(returns, 12.0)).verdict, Verdict::Realised);
}

#[test]
fn a_group_in_a_circle_is_a_formation_and_one_back_to_back_is_not() {
    let mut case = frontal();
    case.place = floor(
        &[],
        &[("a", "OPEN AREA", -8., 0.), ("m", "OPEN AREA", 0., 0.), ("b", "OPEN AREA", 8., 0.)],
        &[("a", "m"), ("m", "b")],
    );
    case.plan =
        group_of(proposal(3, vec![must("c1", Predicate::Formation { group: GroupId(1), spread_m: 1.5 })]), &[1, 2, 3]);
    case.ways = paths(&["a", "m", "b"], &[(&["m"], "m"), (&["m"], "m"), (&["m"], "m")]);
    for human in &mut case.plan.humans {
        human.relation = Relation::Static;
    }
    let stand = |turn: f64, far: f64| -> Vec<Walk> {
        let mut walks = vec![Walk::robot(-8., -1.4, 0.8, 0.)];
        for n in 0..3_u32 {
            let angle = f64::from(n) * 2.0 * PI / 3.0 + 0.5;
            let reach = if n == 2 { far } else { 0.8 };
            walks.push(
                Walk::human(n + 1, reach * angle.cos(), 0.8 + reach * angle.sin(), 0., 0.).facing(angle + PI + turn),
            );
        }
        walks
    };
    assert_eq!(case.verdict(&stand(0.0, 0.8), 20.0), Verdict::Realised);
    assert_eq!(case.verdict(&stand(PI, 0.8), 20.0), Verdict::Contradicted);
    let mut away = stand(0.0, 0.8);
    away.pop();
    away.push(Walk::human(3, 2.8, 4.5, 0., 0.));
    assert_ne!(case.verdict(&away, 20.0), Verdict::Realised);
}

#[test]
fn a_gesture_far_away_or_never_made_is_not_realised() {
    let mut case = frontal();
    let says = Predicate::Gestures { agent: AgentId::Human(H1), gesture: Gesture::Wait };
    case.plan.expected_events = vec![must("c1", says)];
    let walk = || Walk::human(1, 8., 0.5, -0.8, 0.);
    assert_eq!(case.verdict(&[robot(), walk().says(7.0, 9.0, Gesture::Wait)], 20.0), Verdict::Realised);
    assert_eq!(case.verdict(&[robot(), walk().says(1.0, 2.0, Gesture::Wait)], 20.0), Verdict::Contradicted);
    let silent = case.judge(&recording(&[robot(), walk()], 20.0, 0.01));
    assert_eq!(silent.verdict, Verdict::NotTriggered);
    assert_eq!(silent.repair.unwrap().faults[0].code, FaultCode::DNoGest);
}

#[test]
fn overtaking_giving_way_and_passing_are_told_apart() {
    let mut case = frontal();
    case.plan.expected_events = vec![must("c1", Predicate::Overtakes { human: H1 })];
    case.plan.humans[0].relation = Relation::Behind;
    let over = || Walk::human(1, -11., 0.5, 1.2, 0.);
    assert_eq!(case.verdict(&[robot(), over()], 19.0), Verdict::Realised);
    assert_ne!(case.verdict(&[robot(), Walk::human(1, 8., 0.5, -0.8, 0.)], 19.0), Verdict::Realised);
    case.plan.expected_events =
        vec![must("c1", Predicate::RobotPasses { human: H1 }), must("c2", Predicate::GivesWay { human: H1 })];
    let aside = || Walk::human_through(1, &[(0., 0., 0.), (2., 0., 0.), (3., 0., 0.5), (30., 0., 0.5)]);
    assert_eq!(case.verdict(&[robot(), aside()], 19.0), Verdict::Realised);
    assert_eq!(case.verdict(&[robot(), Walk::human(1, 0., 0.5, 0., 0.)], 19.0), Verdict::Contradicted, "went nowhere");
    assert_eq!(case.verdict(&[robot(), Walk::human(1, 0., 0.05, 0., 0.)], 19.0), Verdict::Contradicted);
}
