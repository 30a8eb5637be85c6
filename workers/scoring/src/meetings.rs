//! Somebody who meets the robot twice, on hand-made tracks.

use socrates_model::report::Standing;
use socrates_model::{
    Encounter, EventKind, Fact, FactKind, FaultCode, HumanId, Location, Predicate, Reading, Recording, Report, Verdict,
};

use crate::cases::{Case, must, proposal};
use crate::fixture::{Walk, event, floor, node, paths, recording};

const H1: HumanId = HumanId::new(1);

/// A corridor, and a way round it to the north.
fn ring() -> Location {
    floor(
        &[],
        &[
            ("a", "CORRIDOR", -8., 0.),
            ("m", "CORRIDOR", 0., 0.),
            ("n", "CORRIDOR", 8., 0.),
            ("b", "CORRIDOR", 16., 0.),
            ("nm", "CORRIDOR", 0., 6.),
            ("nn", "CORRIDOR", 8., 6.),
        ],
        &[("a", "m"), ("m", "n"), ("n", "b"), ("m", "nm"), ("nm", "nn"), ("nn", "n")],
    )
}

fn case() -> Case {
    let again = Predicate::MeetsAgain { human: H1, nth: 2, within_m: 3.0 };
    let mut ways = paths(&["a", "m", "n", "b"], &[(&["n", "m", "nm", "nn", "n", "b"], "m")]);
    ways.encounters.push(Encounter { human: H1, node: node("n") });
    Case { place: ring(), plan: proposal(1, vec![must("c1", again)]), ways, reading: None }
}

/// The robot at 0.8 m/s along the corridor: at `m` after 10 s, at `n` after 20 s.
fn robot() -> Walk {
    Walk::robot(-8., 0., 0.8, 0.)
}

/// The human at `m` at 10 s, round by the north, and at `n` at such a time.
fn human(at_n_s: f64) -> Walk {
    let stops = [(0.0, 8.0, 0.6), (10.0, 0.0, 0.6), (12.5, 0.0, 3.5), (at_n_s - 2.5, 8.0, 3.5), (at_n_s, 8.0, 0.6)];
    Walk::human_through(1, &[&stops[..], &[(at_n_s + 6.0, 16.0, 0.6)]].concat())
}

fn judged(at_n_s: f64) -> Report {
    case().judge(&recording(&[robot(), human(at_n_s)], 34.0, 0.01))
}

fn standing(report: &Report, id: &str) -> (Standing, Option<f64>) {
    let clause = report.clauses.iter().find(|clause| clause.id == id).unwrap();
    (clause.standing, clause.times_s.first().copied())
}

#[test]
fn two_meetings_are_judged_each_in_its_own_time() {
    let report = judged(20.5);
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    let (first, second) = (standing(&report, "auto-meet-human_1"), standing(&report, "c1"));
    assert_eq!((first.0, second.0), (Standing::Holds, Standing::Holds));
    assert!(first.1.unwrap() < 10.0 && second.1.unwrap() > 15.0, "{first:?} {second:?}");
    let gaps = &report.encounter_gaps_s;
    assert_eq!(gaps.keys().map(String::as_str).collect::<Vec<_>>(), ["human_1", "human_1 second meeting"]);
    assert!(gaps.values().all(|gap| gap.abs() < 2.0), "{gaps:?}");
}

#[test]
fn a_second_meeting_that_does_not_happen_is_not_realised() {
    let report = judged(32.0);
    assert_ne!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert_eq!(standing(&report, "auto-meet-human_1").0, Standing::Holds);
    assert_ne!(standing(&report, "c1").0, Standing::Holds);
    assert!(report.repair.unwrap().faults.iter().any(|fault| fault.code == FaultCode::DNoMeet));
}

#[test]
fn a_first_meeting_is_not_made_good_by_the_second() {
    let late = Walk::human_through(1, &[(0.0, 8.0, 6.0), (16.0, 8.0, 6.0), (20.0, 8.0, 0.6), (26.0, 16.0, 0.6)]);
    let report = case().judge(&recording(&[robot(), late], 34.0, 0.01));
    assert_ne!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert_ne!(standing(&report, "auto-meet-human_1").0, Standing::Holds);
    assert_eq!(standing(&report, "c1").0, Standing::Holds);
}

#[test]
fn paths_without_the_second_encounter_cannot_realize_it() {
    let mut one = case();
    one.ways.encounters.truncate(1);
    let report = one.judge(&recording(&[robot(), human(20.5)], 34.0, 0.01));
    assert_ne!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert_eq!(standing(&report, "c1").0, Standing::Fails);
}

#[test]
fn who_is_asked_to_meet_twice_needs_a_clause_for_it() {
    let asked = FactKind::MeetsTimes { human: H1, times: 2, place: None };
    let fact = Fact { id: "f1".into(), quote: "meets the robot twice".into(), kind: asked };
    let mut case = case();
    case.reading = Some(Reading { format: 1, facts: vec![fact], ..Reading::default() });
    let run: Recording = recording(&[robot(), human(20.5)], 34.0, 0.01);
    assert_eq!(case.judge(&run).verdict, Verdict::Realised);
    // A second encounter of the paths would be demanded whatever the proposal lists.
    case.ways.encounters.truncate(1);
    case.plan.expected_events[0].predicate = Predicate::Meets { human: H1, within_m: 3.0 };
    assert_eq!(case.judge(&run).verdict, Verdict::Invalid);
}

#[test]
fn a_node_that_both_visit_twice_is_met_at_twice() {
    // There and back for the robot, and the human comes across its way each time.
    let mut case = case();
    case.ways = paths(&["a", "m", "n", "m", "nm"], &[(&["nm", "m", "a", "m", "nm"], "m")]);
    case.ways.encounters.push(Encounter { human: H1, node: node("m") });
    let robot = Walk::through(
        socrates_model::AgentId::Robot,
        &[(0.0, -8.0, 0.0), (10.0, 0.0, 0.0), (20.0, 8.0, 0.0), (30.0, 0.0, 0.0), (37.5, 0.0, 6.0)],
    );
    let there = |again_s: f64| {
        let stops =
            [(0.0, 0.0, 6.0), (9.0, 1.0, 0.8), (14.0, -8.0, 0.6), (again_s - 8.0, -8.0, 0.6), (again_s, -0.8, 0.6)];
        recording(&[Walk::through(robot.agent, &robot.stops), Walk::human_through(1, &stops)], 40.0, 0.01)
    };
    let report = case.judge(&there(30.0));
    assert_eq!(standing(&report, "c1").0, Standing::Holds, "{}", report.verdict_text);
    assert!(standing(&report, "c1").1.unwrap() > 25.0);
    assert_ne!(standing(&case.judge(&there(39.9)), "c1").0, Standing::Holds);
}

#[test]
fn the_story_tells_which_meeting_it_is() {
    let mut run = recording(&[robot(), human(20.5)], 34.0, 0.01);
    let meets =
        |nth: u32, node: &str| EventKind::Encounter { human: H1, node: crate::fixture::node(node), gap_s: 0.25, nth };
    event(&mut run, 10.0, meets(1, "m"));
    event(&mut run, 20.0, meets(2, "n"));
    let report = case().judge(&run);
    assert!(report.story.iter().any(|line| line.contains("meet for the first time at m")));
    assert!(report.story.iter().any(|line| line.contains("meet for the second time at n")), "{:?}", report.story);
    assert!((report.encounter_gaps_s["human_1 second meeting"] - 0.25).abs() < 1e-9);
}

#[test]
fn who_is_to_stop_at_a_distance_is_not_asked_to_come_nearer() {
    let mut case = case();
    case.plan = proposal(1, vec![must("c1", Predicate::Humans { count: 1 })]);
    case.ways = paths(&["a", "m", "n", "b"], &[(&["nm", "m"], "m")]);
    // The robot goes by 3.7 m from where they stand.
    let stands = Walk::human_through(1, &[(0.0, 0.0, 6.0), (5.0, 0.0, 2.9), (34.0, 0.0, 2.9)]);
    let run = recording(&[Walk::robot(-8., -0.8, 0.8, 0.), stands], 34.0, 0.01);
    assert_eq!(standing(&case.judge(&run), "auto-meet-human_1").0, Standing::NotTriggered);
    let rule = |distance_m: f64| serde_json::json!({ "when": [{ "robot_visible": distance_m }], "act": "stand_still" });
    let mut told = |distance_m: f64| {
        case.plan.humans[0].rules = vec![serde_json::from_value(rule(distance_m)).unwrap()];
        standing(&case.judge(&run), "auto-meet-human_1").0
    };
    assert_eq!((told(2.0), told(4.0)), (Standing::NotTriggered, Standing::Holds));
}
