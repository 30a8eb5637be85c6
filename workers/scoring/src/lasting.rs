//! What has to last, what has not begun, and who need not be met, on hand-made tracks.

use socrates_model::reading::{Fact, FactKind};
use socrates_model::report::Standing;
use socrates_model::{Action, AgentId, FORMAT, HumanId, Predicate, Reading, Relation, Report, Rule, Trigger, Verdict};

use crate::cases::{Case, corridor, must, proposal};
use crate::fixture::{Walk, paths, recording};

const H1: HumanId = HumanId::new(1);
const H2: HumanId = HumanId::new(2);

fn case(humans: u32, predicates: Vec<Predicate>) -> Case {
    let clauses = predicates.into_iter().zip(1..).map(|(predicate, n)| must(&format!("c{n}"), predicate)).collect();
    let ways: Vec<(&[&str], &str)> = (0..humans).map(|_| (&["b", "m", "a"][..], "m")).collect();
    Case { place: corridor(), plan: proposal(humans, clauses), ways: paths(&["a", "m", "b"], &ways), reading: None }
}

fn of(report: &Report, id: &str) -> (Standing, String) {
    let clause = report.clauses.iter().find(|clause| clause.id == id).unwrap();
    (clause.standing, clause.evidence.clone())
}

fn robot(stops: &[(f64, f64)]) -> Walk {
    let stops: Vec<(f64, f64, f64)> = stops.iter().map(|(t, x)| (*t, *x, -0.5)).collect();
    Walk::through(AgentId::Robot, &stops)
}

#[test]
fn a_robot_that_has_not_set_off_yet_has_not_stopped() {
    let when = vec![Trigger::RobotStopped];
    let case = case(1, vec![Predicate::Reacts { human: H1, when, act: Action::Navigate, within_s: 1.0 }]);
    let human = || Walk::human_through(1, &[(0., 6., 0.5), (12.5, 6., 0.5), (20., 1., 0.5)]);
    let halts = recording(&[robot(&[(0., -8.), (3., -8.), (12., 0.), (20., 0.)]), human()], 20.0, 0.01);
    let (standing, evidence) = of(&case.judge(&halts), "c1");
    assert_eq!(standing, Standing::Holds, "{evidence}");
    assert!(evidence.starts_with("trigger at 12.0 s"), "{evidence}");
    let goes_on = recording(&[robot(&[(0., -8.), (3., -8.), (20., 8.), (21., 9.)]), human()], 20.0, 0.01);
    let (standing, evidence) = of(&case.judge(&goes_on), "c1");
    assert_eq!(standing, Standing::NotTriggered, "{evidence}");
}

#[test]
fn who_is_to_stand_while_the_robot_moves_stands_for_most_of_that_time() {
    let when = vec![Trigger::RobotMoving];
    let act = Action::StandStill;
    let stands = Predicate::Reacts { human: H1, when: when.clone(), act: act.clone(), within_s: 3.0 };
    let mut case = case(1, vec![stands]);
    let rule = Rule { when, act, gesture: None, for_s: Some(5.0), latched: false, ..Rule::default() };
    // A rule before it that has no reason does not excuse who just walks.
    let walks = Rule { when: vec![Trigger::RobotStopped], act: Action::Navigate, for_s: None, ..rule.clone() };
    case.plan.humans[0].rules = vec![walks, rule.clone()];
    let run = |until: f64| {
        let human = Walk::human_through(1, &[(0., 6., 0.5), (until, 6., 0.5), (until + 17., -7., 0.5)]);
        let human = human.leaf(0.0, 7).leaf(until, 1);
        let mut run = recording(&[robot(&[(0., -8.), (22., 8.)]), human], 22.0, 0.01);
        run.header.leaves.push("StandStill".into());
        run
    };
    let judged = |case: &Case, until: f64| of(&case.judge(&run(until)), "c1");
    let (standing, evidence) = judged(&case, 5.0);
    assert_eq!(standing, Standing::Fails, "{evidence}");
    assert!(evidence.contains("of the 21."), "{evidence}");
    assert_eq!(judged(&case, 20.0).0, Standing::Holds);
    // Who says for how long does not ask for the whole time.
    let fact = |quote: &str| {
        let kind = FactKind::Reacts { human: H1, rule: rule.clone() };
        let fact = Fact { id: "f1".into(), quote: quote.into(), kind };
        Some(Reading { format: FORMAT, facts: vec![fact], ..Reading::default() })
    };
    case.reading = fact("the guard stands still for five seconds");
    assert_eq!(judged(&case, 5.0).0, Standing::Holds);
    case.reading = fact("the guard stands still");
    assert_eq!(judged(&case, 5.0).0, Standing::Fails);
}

#[test]
fn who_follows_another_human_need_not_meet_the_robot_but_somebody_has_to() {
    let follows = |follower: HumanId, leader: AgentId| Predicate::Follows {
        follower: follower.into(),
        leader,
        gap_m: [0.5, 3.5],
        for_s: 5.0,
    };
    let mut case = case(2, vec![follows(H1, AgentId::Robot), follows(H2, H1.into())]);
    for human in &mut case.plan.humans {
        human.relation = Relation::Behind;
    }
    let walks = |behind_m: f64| {
        let human = |number, behind_m: f64| Walk::human(number, -8. - behind_m, -0.5, 0.8, 0.);
        recording(&[Walk::robot(-8., -0.5, 0.8, 0.), human(1, behind_m), human(2, behind_m + 3.0)], 18.0, 0.01)
    };
    let report = case.judge(&walks(2.5));
    assert_eq!(report.verdict, Verdict::Realised, "{}", report.verdict_text);
    assert!(report.clauses.iter().all(|clause| !clause.id.starts_with("auto-meet")));
    // The first of them never comes near.
    let report = case.judge(&walks(6.0));
    assert_eq!(report.verdict, Verdict::NotTriggered, "{}", report.verdict_text);
    assert_eq!(of(&report, "auto-meet-human_1").0, Standing::NotTriggered);
    // Nobody but those who follow each other: then they have to be met.
    case.plan.expected_events = vec![must("c1", follows(H2, H1.into())), must("c2", follows(H1, H2.into()))];
    let report = case.judge(&walks(6.0));
    assert!(report.clauses.iter().any(|clause| clause.id == "auto-meet-human_2"));
    assert!(!matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate), "{}", report.verdict_text);
}

#[test]
fn a_body_in_a_wall_proves_nothing() {
    let verdict = |y: f64| {
        let case = case(1, vec![Predicate::Humans { count: 1 }]);
        case.judge(&recording(&[robot(&[(0., -8.), (20., 8.)]), Walk::human(1, 8., y, -0.8, 0.)], 20.0, 0.01))
    };
    // The wall is at 1.5 m, the body 0.28 m wide to either side.
    let inside = verdict(1.32);
    assert_eq!(inside.verdict, Verdict::Invalid, "{}", inside.verdict_text);
    assert!(inside.verdict_text.contains("inside a wall"), "{}", inside.verdict_text);
    let touches = verdict(1.225);
    assert_eq!(touches.verdict, Verdict::Realised, "{}", touches.verdict_text);
}

#[test]
fn what_never_came_about_is_said_in_words() {
    let case = case(1, vec![Predicate::Blocks { human: H1, for_s: 2.0 }]);
    let run = recording(&[Walk::robot(-8., -0.5, 0.8, 0.), Walk::human(1, -10., -0.5, 0.8, 0.)], 18.0, 0.01);
    let (standing, evidence) = of(&case.judge(&run), "c1");
    assert_eq!(standing, Standing::Fails);
    assert!(evidence.ends_with("it never came about") && !evidence.contains("inf"), "{evidence}");
}
