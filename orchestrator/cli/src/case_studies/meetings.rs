//! Somebody who meets the robot twice: both meetings happen where and when the paths say, and the two part in between.

use std::path::Path;

use socrates_model::{EventKind, FaultCode, HumanId, Verdict};

use super::Case;
use crate::config::Config;
use crate::mutations::{Scenario, Tally, realised, try_all};
use crate::prepare::{Prepared, prepare_text};

/// Seeds that are looked at.
const SEEDS: u64 = 10;
/// Larger gaps than this are no meeting at about the same time, s.
const GAP_SECS: f64 = 4.0;
/// Between the meetings they are once at least so far apart, m.
const PARTED_M: f64 = 3.5;

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

#[tokio::test]
async fn look() {
    for rough in [
        "A nurse comes towards the robot and meets it again later.",
        "A visitor crosses the robot's path twice.",
        "A nurse comes towards the robot, stops and looks at it for 5 seconds, and meets it again at an intersection.",
        "Two people walk together towards the robot and meet it twice.",
        "The robot meets the same nurse two times. A visitor crosses its way.",
    ] {
        for place in ["office", "hospital", "warehouse"] {
            let prepared = asked(place, rough);
            let mut fine = 0;
            let mut lines = Vec::new();
            for seed in 1..=SEEDS {
                match realised(prepared.clone(), seed).await {
                    Err(why) => lines.push(format!("   {seed} {why}")),
                    Ok(scenario) => {
                        let done = scenario.report.verdict == Verdict::Realised;
                        let ids = scenario.made.proposal.humans.iter().map(|human| human.id);
                        let twice: Vec<HumanId> = ids.filter(|id| scenario.made.paths.encounters_of(*id).count() > 1).collect();
                        let bad: Vec<String> = twice.iter().flat_map(|id| wrong(&scenario, *id)).collect();
                        fine += u32::from(done && bad.is_empty() && !twice.is_empty());
                        let way = |id: HumanId| scenario.made.paths.humans[&id].iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
                        let robot = scenario.made.paths.robot.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
                        lines.push(format!("   {seed} {} {:?} {} | {bad:?} | {robot} | {}", scenario.report.verdict, scenario.report.encounter_gaps_s, if done { "" } else { &scenario.report.verdict_text }, twice.iter().map(|id| way(*id)).collect::<Vec<_>>().join("; ")));
                    }
                }
            }
            eprintln!("{fine}/{SEEDS} {place}: {rough}");
            for line in lines {
                eprintln!("{line}");
            }
        }
    }
    let _ = (FaultCode::GMeet, Tally::default(), try_all as fn(&Scenario, &str, &mut Tally));
}
