//! Metrics while a run goes on are those of its recording, of its recording at another rate, and of its tracks alone, over
//! every shipped request.

use std::collections::BTreeMap;

use socrates_app::config::Config;
use socrates_app::replay::tracks::{Group, Known, score};
use socrates_model::{AgentId, EventKind, MetricValue, Recording};
use socrates_scoring::fidelity::Signals;
use socrates_scoring::metrics::{Online, Scene, measure};
use socrates_scoring::{Sample, Tracks};

use crate::mutations::{Scenario, evidence, realised, shipped};

/// Metrics that may differ by more than 2 % between 10 and 100 Hz, with the reason; the README has the list too.
const BY_RATE: &[(&str, &str)] = &[];

/// Metrics that tracks alone give otherwise than the bundle, with the reason; the README has the list too.
const BY_TRACKS: &[(&str, &str)] = &[
    ("legibility", GOALS),
    ("legibility_observed", GOALS),
    ("clarity", GOALS),
    ("confusions", GOALS),
    ("readiness_envelope", GOALS),
    ("social_force_on_robot", SIDES),
    ("social_work", SIDES),
    ("social_work_rate", SIDES),
];
/// Metrics of tracks that are compared with those of a run whose places have four decimals as well, with the reason.
const BY_ROUNDING: &[(&str, &str)] = &[(
    "turning_excess",
    "it sums the size of every turn, and rounded places turn each step of some centimeters a little",
)];
/// The paths of a bundle say from which node to which the robot goes; a table has a point for the goal.
const GOALS: &str = "the goals that people may expect are those about the robot's nodes, which a table does not name";
/// The sideways force of the model changes its sign where somebody is straight ahead.
const SIDES: &str = "of people straight ahead the last decimals of their places say on which side they are";
/// Share and amount by which tracks may give another figure than the bundle: they end when the robot first comes near its goal,
/// and their places have four decimals.
const OF_TRACKS: (f64, f64) = (0.08, 5e-3);

/// Every so manieth tick of a recording.
fn thinned(run: &Recording, every: u64) -> Recording {
    let mut thin = run.clone();
    thin.frames.retain(|state| state.tick % every == 0);
    thin
}

/// The run with places of four decimals, as its table has them.
fn rounded(run: &Recording) -> Recording {
    let mut rounded = run.clone();
    for state in &mut rounded.frames {
        (state.x, state.y) = ((state.x * 1e4).round() / 1e4, (state.y * 1e4).round() / 1e4);
    }
    rounded
}

fn values(scenario: &Scenario, run: &Recording) -> BTreeMap<String, Option<f64>> {
    let evidence = evidence(&scenario.prepared, &scenario.made, run);
    let tracks = Tracks::read(run).unwrap();
    let signals = Signals::new(&evidence, &tracks);
    let values = measure(&Scene::new(&signals)).into_iter().filter(|value| !value.id.starts_with("hunav."));
    values.map(|value| (value.id, value.value)).collect()
}

/// What differs by more than a share and an amount, and is not excused.
fn differing(
    wanted: &BTreeMap<String, Option<f64>>,
    found: &BTreeMap<String, Option<f64>>,
    (share, amount): (f64, f64),
    excused: &[(&str, &str)],
) -> Vec<String> {
    let close = |a: f64, b: f64| (a - b).abs() <= share * a.abs().max(b.abs()) + amount;
    let same = |a: &Option<f64>, b: &Option<f64>| match (a, b) {
        (Some(a), Some(b)) => close(*a, *b),
        (None, None) => true,
        (Some(_), None) | (None, Some(_)) => false,
    };
    wanted
        .iter()
        .filter(|(id, _)| !excused.iter().any(|(excused, _)| excused == id))
        .filter(|(id, value)| found.get(*id).is_none_or(|found| !same(value, found)))
        .map(|(id, value)| format!("{id}: {value:?} and {:?}", found.get(id)))
        .collect()
}

#[tokio::test]
async fn every_metric_of_a_shipped_scenario_is_the_same_at_ten_and_at_a_hundred_hertz_and_from_its_tracks() {
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let mut wrong = Vec::new();
    for prepared in shipped(&config).unwrap() {
        let scenario = realised(prepared, 1).await.unwrap();
        let (name, run) = (&scenario.prepared.name, &scenario.run);
        let fine = values(&scenario, run);
        for every in [2, 5, 10] {
            let coarse = values(&scenario, &thinned(run, every));
            wrong.extend(
                differing(&fine, &coarse, (0.02, 1e-3), BY_RATE)
                    .iter()
                    .map(|what| format!("{name} by {every}: {what}")),
            );
        }
        // The table of the bundle, with what a user can say of it.
        let graph = &scenario.prepared.location.graph;
        let robot = run.header.agents.iter().find(|info| info.agent == AgentId::Robot).unwrap();
        let known = Known {
            location: Some(scenario.prepared.location.clone()),
            goal: scenario.made.paths.robot.last().and_then(|id| graph.node(id)).map(|node| node.at),
            radius_m: Some(robot.radius_m),
            speed_mps: Some(robot.speed_mps),
            groups: scenario
                .made
                .proposal
                .groups
                .iter()
                .map(|group| Group(group.members.iter().map(ToString::to_string).collect()))
                .collect(),
            ..Known::default()
        };
        let table = socrates_stream::csv::write_agents(&[run]);
        let scored = score("agents.csv", table.as_bytes(), &known).unwrap();
        let metrics = scored.report.metrics.into_iter().filter(|metric| !metric.id.starts_with("hunav."));
        let found = metrics.map(|metric| (metric.id, metric.value)).collect();
        // Tracks do not have the robot's word that it has arrived: it does so when it first comes near its goal.
        let mut silent = run.clone();
        silent.events.retain(|event| event.kind != EventKind::RobotArrived);
        let mut bundled = values(&scenario, &silent);
        let rounded = values(&scenario, &rounded(&silent));
        for (id, _) in BY_ROUNDING {
            bundled.insert((*id).to_owned(), rounded.get(*id).copied().flatten());
        }
        wrong.extend(
            differing(&bundled, &found, OF_TRACKS, BY_TRACKS).iter().map(|what| format!("{name} as a table: {what}")),
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[tokio::test]
async fn values_while_a_shipped_scenario_runs_are_those_of_its_recording() {
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    for prepared in shipped(&config).unwrap() {
        let scenario = realised(prepared, 1).await.unwrap();
        let run = &scenario.run;
        let evidence = evidence(&scenario.prepared, &scenario.made, run);
        let tracks = Tracks::read(run).unwrap();
        let signals = Signals::new(&evidence, &tracks);
        let scene = Scene::new(&signals);
        let radii: Vec<f64> = tracks.humans.iter().map(|human| human.radius_m).collect();
        let mut online = Online::new(scene.setting(&radii));
        let mut arrivals = run.events.iter().filter(|event| event.kind == EventKind::RobotArrived);
        let arrived = arrivals.next().map(|event| event.time.secs());
        for (index, robot) in tracks.robot.as_ref().unwrap().samples.iter().enumerate() {
            if let Some(t) = arrived.filter(|t| *t < robot.t - 1e-9) {
                online.arrived(t);
            }
            let humans: Vec<Sample> = tracks.humans.iter().map(|human| human.samples[index]).collect();
            online.push(Some(robot), &humans);
        }
        arrived.into_iter().for_each(|t| online.arrived(t));
        let grown = online.values();
        let bits = |value: &MetricValue| (value.id.clone(), value.value.map(f64::to_bits), value.note.clone());
        let whole: Vec<_> = measure(&scene).iter().map(bits).collect();
        assert!(grown.len() >= 60, "{}", grown.len());
        for value in grown.iter().map(bits) {
            assert!(whole.contains(&value), "{}: {value:?}", scenario.prepared.name);
        }
    }
}
