//! Metrics while a run goes on are those of its recording, over every shipped request.

use socrates_model::{EventKind, MetricValue};
use socrates_scoring::fidelity::Signals;
use socrates_scoring::metrics::{Online, Scene, measure};
use socrates_scoring::{Sample, Tracks};

use crate::config::Config;
use crate::mutations::{evidence, realised, shipped};

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
