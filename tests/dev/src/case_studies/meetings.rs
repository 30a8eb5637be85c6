//! Somebody who meets the robot twice: both meetings happen where and when the paths say, and the two part in between.

use std::path::Path;

use socrates_app::config::Config;
use socrates_app::prepare::{Prepared, prepare_text};
use socrates_model::{EventKind, HumanId, Verdict};

use super::Case;
use crate::mutations::{Scenario, Tally, realised, try_all};

/// Seeds that are looked at.
const MANY: u64 = 10;
/// Larger gaps than this are no meeting at about the same time, s.
const GAP_SECS: f64 = 4.0;
/// Between the meetings they are once at least so far apart, m.
const PARTED_M: f64 = 3.0;

fn asked(place: &str, rough: &str) -> Prepared {
    let text = format!(
        "location = \"{place}\"\nsocial_context = \"An ordinary day\"\ntask = \"Deliver a parcel\"\nrough_scenario = \"{rough}\"\n"
    );
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    prepare_text(place, &text, place, Path::new("."), None, &config).unwrap()
}

/// What is wrong with a run in which this human should meet the robot twice.
fn wrong(scenario: &Scenario, human: HumanId) -> Vec<String> {
    let mut found = Vec::new();
    let met: Vec<(f64, u32, f64)> = scenario
        .run
        .events
        .iter()
        .filter_map(|event| {
            let EventKind::Encounter { human: who, gap_s, nth, .. } = &event.kind else { return None };
            (*who == human).then_some((event.time.secs(), *nth, *gap_s))
        })
        .collect();
    let [(first, 1, early), (second, 2, late)] = met[..] else {
        return vec![format!("meetings: {met:?}")];
    };
    if early.abs() > GAP_SECS || late.abs() > GAP_SECS {
        found.push(format!("gaps of {early:.1} s and {late:.1} s"));
    }
    let case = Case::of(scenario);
    let apart = case.robot.iter().zip(case.person(human)).map(|(r, h)| (r.point() - h.point()).norm());
    let between = apart.skip(super::tick(first)).take(super::tick(second - first));
    let most = between.fold(0.0, f64::max);
    if most < PARTED_M {
        found.push(format!("never more than {most:.1} m apart between the meetings"));
    }
    found
}

/// Of so many seeds on each of these maps at least nine are realised, with both meetings on time and apart from each other.
#[expect(clippy::print_stdout, reason = "a sweep prints its figure")]
async fn study(places: &[&str], rough: &str, seeds: u64) {
    for place in places {
        let prepared = asked(place, rough);
        assert_eq!(prepared.reading.problems, [], "{rough}");
        let mut missed: Vec<String> = Vec::new();
        for seed in 1..=seeds {
            let scenario = match realised(prepared.clone(), seed).await {
                Ok(scenario) => scenario,
                Err(why) => {
                    missed.push(format!("seed {seed}: {why}"));
                    continue;
                }
            };
            let report = &scenario.report;
            let human = HumanId::new(1);
            let mut found = wrong(&scenario, human);
            if report.verdict != Verdict::Realised {
                found.push(format!("{} · {}", report.verdict, report.verdict_text));
            }
            if seed == 1 && found.is_empty() {
                let mut tally = Tally::default();
                try_all(&scenario, place, &mut tally);
                let (tried, right) = tally.spoiled_of("N: second encounter left out");
                assert_eq!((tried, right), (1, 1), "{place}: {:#?}", tally.wrong());
            }
            missed.extend(found.into_iter().map(|what| format!("seed {seed}: {what}")));
        }
        println!("{place}: {rough}: {} of {seeds} seeds missed, bound {}", missed.len(), usize::from(seeds > 1));
        assert!(missed.len() <= usize::from(seeds > 1), "{place}: {rough}: {missed:#?}");
    }
}

#[tokio::test]
async fn who_comes_towards_the_robot_meets_it_again() {
    study(&["office"], "A nurse comes towards the robot and meets it again later.", 1).await;
}

#[tokio::test]
#[ignore = "sweep: 10 seeds on each shipped location"]
async fn who_comes_towards_the_robot_meets_it_again_over_ten_seeds() {
    study(&["office", "hospital", "warehouse"], "A nurse comes towards the robot and meets it again later.", MANY)
        .await;
}

#[tokio::test]
async fn who_looks_for_a_while_meets_it_again_where_it_was_said() {
    let rough =
        "A nurse comes towards the robot, stops and looks at it for 5 seconds, and meets it again at an intersection.";
    study(&["office"], rough, 1).await;
}

#[tokio::test]
#[ignore = "sweep: 10 seeds on each shipped location"]
async fn who_looks_for_a_while_meets_it_again_where_it_was_said_over_ten_seeds() {
    let rough =
        "A nurse comes towards the robot, stops and looks at it for 5 seconds, and meets it again at an intersection.";
    study(&["office", "hospital", "warehouse"], rough, MANY).await;
}

#[tokio::test]
async fn who_crosses_the_robots_way_does_so_twice() {
    study(&["office"], "A visitor crosses the robot's path twice.", 1).await;
}

#[tokio::test]
#[ignore = "sweep: 10 seeds on each shipped location"]
async fn who_crosses_the_robots_way_does_so_twice_over_ten_seeds() {
    study(&["office", "hospital", "warehouse"], "A visitor crosses the robot's path twice.", MANY).await;
}
