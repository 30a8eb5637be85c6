//! What a request asks for shows in the verdict: reactions, ways out of rooms without doors, looks, and the counts of clauses.

use socrates_model::reading::{Fact, FactKind};
use socrates_model::report::Standing;
use socrates_model::rule::{RobotDo, RobotRule, RobotWhen};
use socrates_model::{
    Action, Clause, ClauseRole, EventKind, FORMAT, Gesture, HumanId, PlaceClass, Predicate, Reading, Relation, Report,
    Rule, Trigger, Verdict,
};

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, event, floor, node, paths, recording};

const H1: HumanId = HumanId::new(1);

fn found<'a>(report: &'a Report, id: &str) -> &'a socrates_model::ClauseResult {
    report.clauses.iter().find(|clause| clause.id == id).unwrap()
}

/// Somebody stands beside the robot's way; the robot asks to pass, and it is to step aside then.
fn asked_to_give_way() -> Case {
    let when = vec![Trigger::RobotSays(Gesture::ExcuseMe)];
    let rule = Rule { when: when.clone(), act: Action::GiveWay, for_s: Some(3.0), latched: true, ..Rule::default() };
    let reacts = Predicate::Reacts { human: H1, when, act: Action::GiveWay, within_s: 3.0 };
    let mut plan = proposal(
        1,
        vec![
            Clause { source: "f1".into(), ..must("c1", Predicate::GivesWay { human: H1 }) },
            Clause { source: "f1".into(), must: false, ..must("c2", reacts) },
        ],
    );
    plan.humans[0].relation = Relation::Static;
    plan.humans[0].rules = vec![rule.clone()];
    let fact = Fact { id: "f1".into(), quote: "steps aside".into(), kind: FactKind::Reacts { human: H1, rule } };
    Case {
        place: corridor(),
        plan,
        ways: paths(&["a", "m", "b"], &[(&["m"], "m")]),
        reading: Some(Reading { format: FORMAT, facts: vec![fact], ..Reading::default() }),
    }
}

fn asks(from: f64) -> Walk {
    Walk::through(
        socrates_model::AgentId::Robot,
        &[(0., -8., -0.6), (8., -3., -0.6), (20., -3., -0.6), (34., 8., -0.6)],
    )
    .says(from, from + 2.0, Gesture::ExcuseMe)
}

#[test]
fn an_asked_reaction_that_does_not_come_contradicts_whatever_else_was_seen() {
    let case = asked_to_give_way();
    // It stands 0.3 m beside the line all the time the robot asks, and has gone aside when the robot passes in the end.
    let stays = Walk::human_through(1, &[(0., 0., -0.3), (18., 0., -0.3), (19., 0., 0.6), (40., 0., 0.6)]);
    let report = case.judge(&recording(&[asks(9.0), stays.leaf(0.0, 1).leaf(9.0, 6).leaf(12.0, 1)], 34.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Holds);
    assert_eq!(report.verdict, Verdict::Contradicted, "{}", report.verdict_text);
    assert!(
        found(&report, "c2").must && report.verdict_text.contains("c2: trigger at 9.0 s"),
        "{}",
        report.verdict_text
    );

    let yields = || Walk::human_through(1, &[(0., 0., -0.3), (9.2, 0., -0.3), (10., 0., 0.6), (40., 0., 0.6)]);
    let report = case.judge(&recording(&[asks(9.0), yields().leaf(0.0, 1).leaf(9.0, 6).leaf(12.0, 1)], 34.0, 0.01));
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);

    // The robot never asks: the scenario was not triggered, even though it goes aside of itself.
    let report = case.judge(&recording(&[asks(90.0), yields().leaf(0.0, 1)], 34.0, 0.01));
    assert_eq!(report.verdict, Verdict::NotTriggered, "{}", report.verdict_text);
}

/// A room without a door behind the wall x = 4, the robot on the corridor before it.
fn from_a_room() -> Case {
    let place = floor(
        &[(4., 0.6, 4.2, 4.), (4., -4., 4.2, -0.6), (4., 4., 9., 4.2), (4., -4.2, 9., -4.), (9., -4., 9.2, 4.)],
        &[
            ("r", "KITCHEN", 7., 0.),
            ("d", "DOORWAY", 4.1, 0.),
            ("m", "INTERSECTION", 1., 0.),
            ("s", "CORRIDOR", 1., -8.),
            ("n", "CORRIDOR", 1., 8.),
        ],
        &[("r", "d"), ("d", "m"), ("s", "m"), ("m", "n")],
    );
    let mut plan = proposal(1, vec![must("c1", Predicate::Leaves { human: H1, door: String::new() })]);
    plan.humans[0].relation = Relation::Leaving;
    Case { place, plan, ways: paths(&["s", "m", "n"], &[(&["r", "d", "m", "s"], "m")]), reading: None }
}

#[test]
fn coming_out_of_a_room_without_a_door_is_judged_at_its_opening() {
    let case = from_a_room();
    let robot = || Walk::robot(1.4, -8., 0., 0.8);
    let out = Walk::human_through(1, &[(0., 7., 0.), (6., 7., 0.), (12., 0.4, 0.), (20., 0.4, -8.)]);
    let report = case.judge(&recording(&[robot(), out], 20.0, 0.01));
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert!(
        found(&report, "c1").evidence.starts_with("human_1 leaves through `d` at 8."),
        "{}",
        found(&report, "c1").evidence
    );

    let waits = Walk::human_through(1, &[(0., 2., 0.), (8., 2., 0.), (12., 0.4, 0.), (20., 0.4, -8.)]);
    let report = case.judge(&recording(&[robot(), waits], 20.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Fails, "who waits in the corridor does not come out");
    let stays = Walk::human_through(1, &[(0., 7., 0.), (8., 7., 0.), (12., 4.8, 0.), (20., 7., 0.)]);
    let report = case.judge(&recording(&[robot(), stays], 20.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Fails, "who turns back in the room does not come out");
}

#[test]
fn who_goes_into_a_room_without_a_door_or_stays_in_it_is_judged_there_too() {
    let mut case = from_a_room();
    case.ways = paths(&["s", "m", "n"], &[(&["n", "m", "d", "r"], "m")]);
    case.plan.expected_events = vec![must("c1", Predicate::Enters { human: H1, door: String::new() })];
    case.plan.humans[0].relation = Relation::Crossing;
    let into = Walk::human_through(1, &[(0., 0.4, 8.), (9., 0.4, 0.), (16., 7., 0.)]);
    let report = case.judge(&recording(&[Walk::robot(1.8, -8., 0., 0.8), into], 20.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
    case.ways = paths(&["s", "m", "n"], &[(&["r"], "")]);
    case.plan.expected_events = vec![must("c1", Predicate::StaysInside { human: H1, door: String::new() })];
    let report = case.judge(&recording(&[Walk::robot(1.8, -8., 0., 0.8), Walk::human(1, 7., 0., 0., 0.)], 20.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
}

/// A room of its own behind the wall x = 4 with two openings 1.2 m wide, at y = -2 with a doorway node and at y = 2 with an edge.
fn from_a_room_with_two_doors() -> Case {
    let place = floor(
        &[
            (4., 2.6, 4.2, 4.),
            (4., -1.4, 4.2, 1.4),
            (4., -4., 4.2, -2.6),
            (4., 4., 9., 4.2),
            (4., -4.2, 9., -4.),
            (9., -4., 9.2, 4.),
        ],
        &[
            ("r", "WARD", 7., -2.),
            ("q", "WARD", 7., 2.),
            ("d", "DOORWAY", 4.1, -2.),
            ("m", "INTERSECTION", 1., -2.),
            ("k", "CORRIDOR", 1., 2.),
            ("s", "CORRIDOR", 1., -8.),
            ("n", "CORRIDOR", 1., 8.),
        ],
        &[("r", "q"), ("r", "d"), ("d", "m"), ("q", "k"), ("s", "m"), ("m", "k"), ("k", "n")],
    );
    let mut plan = proposal(1, vec![must("c1", Predicate::Leaves { human: H1, door: String::new() })]);
    plan.humans[0].relation = Relation::Leaving;
    Case { place, plan, ways: paths(&["s", "m", "k", "n"], &[(&["r", "d", "m", "s"], "m")]), reading: None }
}

#[test]
fn who_comes_out_by_the_other_door_of_the_room_is_out_and_who_comes_in_again_is_not() {
    let case = from_a_room_with_two_doors();
    let judge = |human: Walk| {
        let report = case.judge(&recording(&[Walk::robot(0.2, -8., 0., 0.8), human], 24.0, 0.01));
        let leaves = found(&report, "c1");
        (leaves.standing, leaves.evidence.clone())
    };
    let (standing, text) =
        judge(Walk::human_through(1, &[(0., 7., -2.), (5., 7., -2.), (9., 1., -2.), (20., 1., -8.)]));
    assert!(standing == Standing::Holds && text.starts_with("human_1 leaves through `d` at "), "{text}");
    let (standing, text) = judge(Walk::human_through(1, &[(0., 7., -2.), (5., 7., 2.), (9., 1., 2.), (20., 1., 8.)]));
    assert!(standing == Standing::Holds && text.starts_with("human_1 leaves through `q-k` at "), "{text}");
    let round = [(0., 7., -2.), (5., 7., -2.), (9., 1., -2.), (14., 1., 2.), (20., 7., 2.)];
    let (standing, text) = judge(Walk::human_through(1, &round));
    assert_eq!(standing, Standing::Fails, "out by one door and in by the other: {text}");
    let (standing, text) = judge(Walk::human_through(1, &[(0., 3., 2.), (9., 1., 2.), (20., 1., 8.)]));
    assert!(standing == Standing::Fails && text.contains("outside the door `d` or `q-k`"), "{text}");
    let (standing, text) = judge(Walk::human_through(1, &[(0., 7., -2.), (20., 7., 2.)]));
    assert_eq!(standing, Standing::Fails, "never out: {text}");
}

#[test]
fn a_must_that_cannot_be_judged_is_told_and_not_counted_as_seen() {
    let mut case = from_a_room();
    // A corridor is no room that one could come out of.
    case.place.graph = case.place.graph.edited(|nodes, _| nodes[0].kind = "CORRIDOR".into());
    let robot = Walk::robot(1.4, -8., 0., 0.8);
    let out = Walk::human_through(1, &[(0., 7., 0.), (6., 7., 0.), (12., 0.4, 0.), (20., 0.4, -8.)]);
    let report = case.judge(&recording(&[robot, out], 20.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::NotApplicable);
    assert!(
        report.verdict_text.contains(", 1 not applicable: c1: the map `floor` declares no doors"),
        "{}",
        report.verdict_text
    );
    let counted: Vec<usize> = report.verdict_text.split(' ').filter_map(|word| word.parse().ok()).take(2).collect();
    assert_eq!(counted[0] + 1, counted[1], "{}", report.verdict_text);
}

#[test]
fn a_run_is_not_realised_while_a_wish_cannot_be_judged() {
    let robot = || Walk::robot(1.4, -8., 0., 0.8);
    let out = || Walk::human_through(1, &[(0., 7., 0.), (6., 7., 0.), (12., 0.4, 0.), (20., 0.4, -8.)]);
    let run = recording(&[robot(), out()], 20.0, 0.01);
    let wish = |source: &str| {
        let mut case = from_a_room();
        case.plan.expected_events[0].source = source.to_owned();
        let kind = FactKind::Relates { human: H1, relation: Relation::Leaving };
        let fact = Fact { id: "f1".into(), kind, quote: "comes out of the ward".into() };
        case.reading = Some(Reading { facts: vec![fact], ..asked_to_give_way().reading.unwrap() });
        case
    };
    assert_eq!(wish("f1").judge(&run).verdict, Verdict::Realised, "{}", wish("f1").judge(&run).verdict_text);

    let mut without_a_room = wish("f1");
    // A corridor is no room that a person could come out of.
    without_a_room.place.graph = without_a_room.place.graph.edited(|nodes, _| nodes[0].kind = "CORRIDOR".into());
    let report = without_a_room.judge(&run);
    assert_eq!((report.verdict, report.score), (Verdict::Invalid, 0.0), "{}", report.verdict_text);
    let start = "1 wish cannot be judged: `comes out of the ward` · 0 of 1 wishes seen, by ";
    assert!(report.verdict_text.starts_with(start), "{}", report.verdict_text);
    assert!(report.verdict_text.contains("declares no doors"), "{}", report.verdict_text);

    // A clause that tells of no wish takes nothing from the request.
    let mut unasked = wish("auto");
    unasked.place = without_a_room.place;
    let report = unasked.judge(&run);
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert!(!report.verdict_text.contains("wishes seen"), "{}", report.verdict_text);
}

#[test]
fn a_look_that_follows_the_robot_behind_a_corner_for_a_moment_goes_on() {
    // A pier at x = 0 hides the robot from the one who looks, from about 5 s to 7 s.
    let mut place = corridor();
    let pier = floor(&[(-0.8, -0.6, 0.8, 0.2)], &[], &[]);
    for (cell, other) in place.grid.cells.iter_mut().zip(&pier.grid.cells) {
        if *other == socrates_model::Cell::Occupied {
            *cell = *other;
        }
    }
    let mut plan = proposal(1, vec![must("c1", Predicate::Looks { human: H1, for_s: 8.0 })]);
    plan.place = PlaceClass::Corridor;
    plan.humans[0].relation = Relation::Static;
    let case = Case { place, plan, ways: paths(&["a", "m", "b"], &[(&["m"], "")]), reading: None };
    let robot = || Walk::robot(-4., -1.1, 0.6, 0.);
    let (x, y) = (0.0, 1.1);
    let mut run = recording(&[robot(), Walk::human(1, x, y, 0., 0.)], 14.0, 0.01);
    let turned = |run: &mut socrates_model::Recording, until_s: f64| {
        let id = socrates_model::AgentId::Human(H1).number();
        for state in run.frames.iter_mut().filter(|state| state.agent == id) {
            let t = state.tick as f64 * 0.01;
            state.yaw = if t <= until_s { (-1.1 - y).atan2(-4.0 + 0.6 * t - x) } else { 2.0 };
        }
    };
    turned(&mut run, 14.0);
    let report = case.judge(&run);
    assert_eq!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
    turned(&mut run, 7.0);
    let report = case.judge(&run);
    assert_ne!(found(&report, "c1").standing, Standing::Holds, "who turns away looks no more");
    // A person who has not seen the robot does not look at it, however it stands.
    let hidden = recording(&[Walk::robot(0., -1.1, 0., 0.), Walk::human(1, x, y, 0., 0.).facing(-1.57)], 12.0, 0.01);
    assert_ne!(found(&case.judge(&hidden), "c1").standing, Standing::Holds);
}

#[test]
fn the_first_outcome_that_is_missing_and_what_came_late_are_told() {
    let keeps = Clause {
        role: ClauseRole::Outcome,
        text: "the robot keeps 2 m from everybody".into(),
        ..must("o1", Predicate::RobotKeeps { min_m: 2.0 })
    };
    let arrives = Clause { role: ClauseRole::Outcome, ..must("o2", Predicate::RobotArrives) };
    let case = Case {
        place: corridor(),
        plan: proposal(1, vec![must("c1", Predicate::OnTime { human: H1, gap_s: 3.0 }), keeps, arrives]),
        ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]),
        reading: None,
    };
    let late = Walk::human_through(1, &[(0., 8., 0.5), (4., 8., 0.5), (24., -8., 0.5)]);
    let report = case.judge(&recording(&[Walk::robot(-8., -0.5, 0.8, 0.), late], 24.0, 0.01));
    assert_eq!(report.verdict, Verdict::RealisedLate, "{}", report.verdict_text);
    assert!(report.verdict_text.contains("setup clauses, 1 of them late · "), "{}", report.verdict_text);
    assert!(report.robot_text.contains("outcome clauses, not: the robot keeps 2 m"), "{}", report.robot_text);
}

#[test]
fn the_story_tells_when_somebody_goes_whom_it_follows_and_who_is_come_to() {
    let mut plan = proposal(3, vec![]);
    plan.humans[1].rules = vec![Rule { when: vec![Trigger::Always], act: Action::FollowHuman(H1), ..Rule::default() }];
    plan.humans[2].relation = Relation::Static;
    let ways = paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m"), (&["b", "m", "a"], ""), (&["m"], "m")]);
    let case = Case { place: corridor(), plan, ways, reading: None };
    let walks = |number: u32, y: f64| Walk::human_through(number, &[(0., 8., y), (4., 8., y), (24., -8., y)]);
    let mut run = recording(
        &[Walk::robot(-8., -0.5, 0.8, 0.), walks(1, 0.5), walks(2, 1.1), Walk::human(3, 0., 1.2, 0., 0.)],
        24.,
        0.01,
    );
    for (number, leaf) in [(1, "RegularNav"), (2, "FollowHuman"), (3, "RegularNav")] {
        event(&mut run, 0.0, EventKind::Leaf { human: HumanId::new(number), leaf: leaf.into() });
    }
    event(&mut run, 10.0, EventKind::Encounter { human: HumanId::new(3), node: node("m"), gap_s: 0.0, nth: 1 });
    let report = case.judge(&run);
    for line in ["4.0 s  human_1 sets off", "0.0 s  human_2 follows human_1", "10.0 s  the robot comes to human_3 at m"]
    {
        assert!(report.story.iter().any(|told| told == line), "{line}: {:?}", report.story);
    }
    assert!(!report.story.iter().any(|told| told.contains("human_3 walks on")), "it never walks: {:?}", report.story);
}

/// Somebody is to be at the encounter with the robot within 3 s.
fn timed(ends: &[f64]) -> Case {
    let mut plan = proposal(1, vec![must("c1", Predicate::OnTime { human: H1, gap_s: 3.0 })]);
    plan.robot.script.extend(
        ends.iter().map(|secs| RobotRule { when: RobotWhen::HumanSays(Gesture::Wait), act: RobotDo::Hold(*secs) }),
    );
    Case { place: corridor(), plan, ways: paths(&["a", "m", "b"], &[(&["b", "m", "a"], "m")]), reading: None }
}

#[test]
fn how_long_the_robot_stands_because_it_is_asked_to_is_not_late() {
    // It stands at 2.5 m from the encounter from 6 s to 10.5 s; whoever asks it to is there at about 7 s.
    let way = [(0., -8., -0.5), (6., -2.5, -0.5), (10.5, -2.5, -0.5), (24., 8., -0.5)];
    let robot = || Walk::through(socrates_model::AgentId::Robot, &way);
    let asks = || Walk::human_through(1, &[(0., 8., 0.5), (20., -8., 0.5)]).says(6.0, 9.0, Gesture::Wait);
    let report = timed(&[4.0]).judge(&recording(&[robot(), asks()], 24.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
    assert!(found(&report, "c1").evidence.contains(" on request"), "{}", found(&report, "c1").evidence);
    // Nobody has it wait in its script, or nobody asks: then it is late.
    let report = timed(&[]).judge(&recording(&[robot(), asks()], 24.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Late, "{}", found(&report, "c1").evidence);
    let repair = report.repair.unwrap();
    let told = repair.faults[0].to_string();
    assert!(
        repair.stage == socrates_model::job::Stage::Paths && told.contains("came true late"),
        "what is late is tried again: {told}"
    );
    let silent = Walk::human_through(1, &[(0., 8., 0.5), (20., -8., 0.5)]);
    let report = timed(&[4.0]).judge(&recording(&[robot(), silent], 24.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Late, "{}", found(&report, "c1").evidence);
}

#[test]
fn who_passes_beside_the_encounter_is_there_when_it_is_nearest() {
    let robot = || Walk::robot(-8., -1.0, 0.8, 0.);
    let beside = |from: f64| Walk::human_through(1, &[(0., 8., 2.0), (from, 8., 2.0), (from + 20., -8., 2.0)]);
    let report = timed(&[]).judge(&recording(&[robot(), beside(0.0)], 24.0, 0.01));
    assert_eq!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
    let report = timed(&[]).judge(&recording(&[robot(), beside(10.0)], 30.0, 0.01));
    assert_ne!(found(&report, "c1").standing, Standing::Holds, "{}", found(&report, "c1").evidence);
}

#[test]
fn a_run_that_shows_all_its_clauses_is_invalid_while_a_wish_is_not_played() {
    let wish = |words: &str| {
        let message = format!("`{words}`: what somebody does is played once");
        socrates_model::Fault::new(socrates_model::FaultCode::PRead, "rough_scenario", message).about([words])
    };
    let mut case = asked_to_give_way();
    let yields = || Walk::human_through(1, &[(0., 0., -0.3), (9.2, 0., -0.3), (10., 0., 0.6), (40., 0., 0.6)]);
    let shown = recording(&[asks(9.0), yields().leaf(0.0, 1).leaf(9.0, 6).leaf(12.0, 1)], 34.0, 0.01);
    let stays = Walk::human_through(1, &[(0., 0., -0.3), (18., 0., -0.3), (19., 0., 0.6), (40., 0., 0.6)]);
    let otherwise = recording(&[asks(9.0), stays.leaf(0.0, 1).leaf(9.0, 6).leaf(12.0, 1)], 34.0, 0.01);
    let never = recording(&[asks(90.0), yields().leaf(0.0, 1)], 34.0, 0.01);
    let verdicts = |case: &Case| [&shown, &otherwise, &never].map(|run| case.judge(run).verdict);
    assert_eq!(verdicts(&case), [Verdict::Realised, Verdict::Contradicted, Verdict::NotTriggered]);

    if let Some(reading) = &mut case.reading {
        reading.problems = vec![wish("drops"), wish("kneels down"), wish("drops")];
    }
    assert_eq!(verdicts(&case), [Verdict::Invalid, Verdict::Contradicted, Verdict::NotTriggered]);
    let report = case.judge(&shown);
    let start = "2 wishes are not in this run: `drops`, `kneels down` · 1 of 1 wishes seen, by 5 of 5 setup clauses";
    assert!(report.verdict_text.starts_with(start), "{}", report.verdict_text);
    assert_eq!((report.score, report.repair), (0.0, None), "no author can mend a wish that cannot be played");
    let text = case.judge(&otherwise).verdict_text;
    assert!(text.ends_with(" · 2 wishes are not in this run: `drops`, `kneels down`"), "{text}");
}

#[test]
fn a_planner_that_prevents_a_scenario_does_so_also_where_a_wish_is_not_played() {
    let mut case = asked_to_give_way();
    let message = "`sings` cannot be simulated";
    if let Some(reading) = &mut case.reading {
        reading.problems = vec![
            socrates_model::Fault::new(socrates_model::FaultCode::PRead, "rough_scenario", message).about(["sings"]),
        ];
    }
    let yields = || Walk::human_through(1, &[(0., 0., -0.3), (9.2, 0., -0.3), (10., 0., 0.6), (40., 0., 0.6)]);
    let reference = recording(&[asks(9.0), yields().leaf(0.0, 1).leaf(9.0, 6).leaf(12.0, 1)], 34.0, 0.01);
    let mut other = recording(&[asks(90.0), yields().leaf(0.0, 1)], 34.0, 0.01);
    other.header.planner = "reactive".parse().unwrap();
    let report = crate::score(&crate::Evidence { reference: Some(&reference), ..case.evidence(&other) });
    assert_eq!(report.verdict, Verdict::RobotPrevented, "{}", report.verdict_text);
}
