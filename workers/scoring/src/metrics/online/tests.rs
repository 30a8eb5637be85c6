use socrates_model::{AgentId, EventKind, Paths, Recording};

use super::*;
use crate::evidence::Evidence;
use crate::fidelity::Signals;
use crate::fixture::{Draw, Walk, absent, event, floor, paths, recording};
use crate::metrics::{Scene, measure};
use crate::tracks::Tracks;

impl Draw {
    /// Walks about with rests, mostly where the others do.
    fn walk(&mut self, agent: AgentId) -> Walk {
        let mut stops = vec![(0.0, self.within(-6.0, 6.0), self.within(-2.0, 2.0))];
        while let Some((t, x, y)) = stops.last().copied().filter(|(t, ..)| *t < 20.0) {
            let rests = self.next() < 0.3;
            let to = if rests { (x, y) } else { (self.within(-6.0, 6.0), self.within(-2.0, 2.0)) };
            stops.push((t + self.within(0.3, 6.0), to.0, to.1));
        }
        stops.push((1000.0, 0.0, 0.0));
        Walk::through(agent, &stops)
    }

    /// A run of four with people who come and go, steps that vary, and sometimes an arrival.
    fn run(&mut self) -> Recording {
        let walks: Vec<Walk> = std::iter::once(AgentId::Robot)
            .chain((1..=3).map(|number| AgentId::Human(socrates_model::HumanId::new(number))))
            .map(|agent| self.walk(agent))
            .collect();
        let step = [0.01, 0.05, 0.1, 0.23][(self.next() * 4.0) as usize];
        let mut run = recording(&walks, 12.0, step);
        for number in 1..=3 {
            if self.next() < 0.4 {
                let from = self.within(-4.0, 12.0);
                absent(&mut run, number, from..from + self.within(0.0, 16.0));
            }
        }
        if self.next() < 0.5 {
            // Some ticks are lost.
            let agents = run.header.agents.len();
            let kept: Vec<bool> = (0..run.ticks()).map(|_| self.next() < 0.7).collect();
            let mut index = 0;
            run.frames.retain(|_| {
                index += 1;
                kept[(index - 1) / agents]
            });
        }
        if self.next() < 0.4 {
            let t = self.within(2.0, 12.0);
            event(&mut run, t, EventKind::RobotArrived);
        }
        run
    }
}

/// The recording up to some of its ticks.
fn begun(run: &Recording, ticks: usize) -> Recording {
    let mut begun = run.clone();
    begun.frames.truncate(ticks * run.header.agents.len());
    let end_s = begun.frames.last().map_or(0.0, |state| state.tick as f64 * run.header.step_s);
    begun.events.retain(|event| event.time.secs() <= end_s);
    begun
}

/// What is kept of a value for a comparison to the last bit.
fn bits(values: &[MetricValue]) -> Vec<(String, Option<u64>, String)> {
    values.iter().map(|v| (v.id.clone(), v.value.map(f64::to_bits), v.note.clone())).collect()
}

/// Pushes a run time by time; after each of `looks` ticks, and at the end, the values are those of the recording
/// that ends there.
fn same(run: &Recording, place: &socrates_model::Location, ways: &Paths, looks: &[usize]) {
    let whole = Evidence { location: Some(place), paths: Some(ways), ..Evidence::of(run) };
    let full = Tracks::read(run).unwrap();
    let signals = Signals::new(&whole, &full);
    let scene = Scene::new(&signals);
    let radii: Vec<f64> = full.humans.iter().map(|human| human.radius_m).collect();
    let mut online = Online::new(scene.setting(&radii));
    let ticks = run.ticks();
    let arrives = run.events.iter().find(|event| event.kind == EventKind::RobotArrived).map(|e| e.time.secs());
    for tick in 0..ticks {
        let robot = full.robot.as_ref().map(|robot| robot.samples[tick]);
        let t = full.all().next().unwrap().samples[tick].t;
        if let Some(arrived) = arrives.filter(|arrived| *arrived < t - 1e-9) {
            online.arrived(arrived);
        }
        let humans: Vec<Sample> = full.humans.iter().map(|human| human.samples[tick]).collect();
        online.push(robot.as_ref(), &humans);
        let last = tick + 1 == ticks;
        if let Some(arrived) = arrives.filter(|arrived| *arrived <= t) {
            online.arrived(arrived);
        }
        if !(last || looks.contains(&tick)) || tick == 0 {
            continue;
        }
        let so_far = begun(run, tick + 1);
        let evidence = Evidence { recording: &so_far, ..whole };
        let Ok(tracks) = Tracks::read(&so_far) else { continue };
        let signals = Signals::new(&evidence, &tracks);
        let values = online.values();
        let batch: Vec<MetricValue> = measure(&Scene::new(&signals))
            .into_iter()
            .filter(|value| values.iter().any(|mine| mine.id == value.id))
            .collect();
        assert!(values.len() >= 60, "{}", values.len());
        for (mine, theirs) in bits(&values).iter().zip(bits(&batch)) {
            assert_eq!(*mine, theirs, "after tick {tick} of {ticks}");
        }
    }
}

#[test]
fn values_while_it_goes_on_are_those_of_the_recording_to_the_last_bit() {
    let place = floor(
        &[(-20., 4., 20., 5.), (-20., -5., 20., -4.), (-2., 2.6, 2., 4.)],
        &[("a", "CORRIDOR", -5., 0.), ("b", "CORRIDOR", 4., 0.)],
        &[("a", "b")],
    );
    let ways = paths(&["a", "b"], &[]);
    let mut draw = Draw(5);
    for _ in 0..60 {
        let run = draw.run();
        let looks: Vec<usize> = (0..3).map(|_| (draw.next() * run.ticks() as f64) as usize).collect();
        same(&run, &place, &ways, &looks);
    }
}

#[test]
fn a_run_without_a_robot_or_without_people_says_what_it_lacks() {
    let place = floor(&[], &[("a", "CORRIDOR", -5., 0.), ("b", "CORRIDOR", 4., 0.)], &[("a", "b")]);
    let ways = paths(&["a", "b"], &[]);
    same(&recording(&[Walk::human(1, 0., 0., 1., 0.)], 4.0, 0.1), &place, &ways, &[3]);
    same(&recording(&[Walk::robot(-5., 0., 1., 0.)], 12.0, 0.1), &place, &ways, &[3, 60, 100]);
}

#[test]
fn what_waits_for_the_end_says_why() {
    let waiting: Vec<&str> = CATALOG.iter().filter_map(crate::metrics::Family::waits).collect();
    assert!(waiting.iter().all(|why| !why.is_empty()) && waiting.len() < CATALOG.len());
}
