//! The robot's ways: as long as the shortest there is, also where the task names both ends.

use std::collections::BTreeMap;

use socrates_maps::{DistanceField, Geodesic};
use socrates_model::job::Stage;
use socrates_model::{Location, Paths, Request};
use socrates_offline::{Offline, catalog};
use socrates_prompts::Question;

fn paths(request: &Request, location: &Location, seed: u64) -> Result<Paths, String> {
    let reading = socrates_offline::read(request, location);
    let mut ask = Question::first(request.clone(), reading, location.clone(), seed);
    let proposal = socrates_prompts::parse_proposal(&Offline::answer(&ask)).map_err(|why| format!("{why:?}"))?;
    ask.stage = Stage::Paths;
    ask.proposal = Some(proposal);
    socrates_prompts::parse_paths(&Offline::answer(&ask), &ask).map_err(|why| format!("{why:?}"))
}

/// Three people at three places that no way without a node twice leads over.
#[test]
fn people_at_places_of_dead_ends_are_met_on_a_way_that_comes_back() {
    for (on, places) in [
        ("hospital", ["corridor", "corridor end", "pharmacy room"]),
        ("warehouse", ["intersection", "packing area", "break room"]),
        ("office", ["intersection", "corridor end", "kitchen"]),
    ] {
        let people = places.map(|place| serde_json::json!({ "role": "visitor", "relation": "static", "place": place }));
        let request =
            serde_json::json!({ "location": on, "social_context": "", "task": "Deliver mail", "human": people });
        let location = socrates_maps::shipped::load(on).unwrap();
        let paths =
            paths(&serde_json::from_value(request).unwrap(), &location, 1).unwrap_or_else(|why| panic!("{on}: {why}"));
        let met: std::collections::BTreeSet<_> = paths.encounters.iter().map(|meet| &meet.node).collect();
        assert_eq!(met.len(), 3, "{on}: {:?}", paths.encounters);
        let nodes: std::collections::BTreeSet<_> = paths.robot.iter().collect();
        assert!(nodes.len() < paths.robot.len(), "{on}: {:?}", paths.robot);
        assert!(met.iter().all(|node| nodes.contains(node)), "{on}: {paths:?}");
    }
}

/// The shortest free way on the grid over the way of the graph.
fn efficiency(location: &Location, field: &DistanceField, paths: &Paths) -> f64 {
    let at = |node| location.graph.node(node).unwrap().at;
    let (first, last) = (at(paths.robot.first().unwrap()), at(paths.robot.last().unwrap()));
    Geodesic::to(field, &last, 0.25).distance(&first).unwrap_or(0.0) / location.graph.length_m(&paths.robot)
}

fn asked(on: &str, task: &str, rough: Option<&str>, pattern: Option<&str>) -> Request {
    let mut value = serde_json::json!({ "location": on, "social_context": "", "task": task, "rough_scenario": rough });
    if let Some(pattern) = pattern {
        value["expect"] = serde_json::json!({ "pattern": pattern });
    }
    serde_json::from_value(value).unwrap()
}

/// Tasks that name both ends of the way, by map.
const TASKS: &[(&str, &str)] = &[
    ("hospital", "Bring pills from the pharmacy to the nurse station"),
    ("hospital", "Bring linen from the nurse station to ward 2"),
    ("office", "Bring mail from the reception to the meeting room"),
    ("office", "Bring coffee from the kitchen to the reception"),
    ("warehouse", "Bring a box from the packing area to the loading dock"),
];
const ROUGH: &[&str] = &[
    "A person comes towards the robot.",
    "Two people talk and stand in the way.",
    "Someone crosses the robot's path.",
    "A person overtakes the robot.",
    "Three people walk side by side towards the robot.",
    "A slow person walks ahead of the robot.",
];

#[test]
#[expect(clippy::print_stdout, reason = "figures are for whoever runs the test")]
fn the_robots_way_is_hardly_longer_than_the_shortest() {
    let mut found: Vec<(f64, String)> = Vec::new();
    let mut different: BTreeMap<String, std::collections::BTreeSet<String>> = BTreeMap::new();
    let mut none = Vec::new();
    let mut note =
        |name: String, location: &Location, field: &DistanceField, answer: Result<Paths, String>| match answer {
            Ok(paths) => {
                different.entry(name.clone()).or_default().insert(format!("{:?}", (&paths.robot, &paths.encounters)));
                found.push((
                    efficiency(location, field, &paths),
                    format!("{name}: {:?} {}", paths.robot, paths.reasoning),
                ));
            }
            Err(why) => none.push(format!("{name}: {why}")),
        };
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).unwrap();
        let field = DistanceField::new(&location.grid);
        for card in catalog().iter().filter(|card| card.fits(&location)) {
            for seed in 1..=6 {
                let request = asked(name, "Deliver mail", None, Some(&card.id));
                note(format!("{name}/{}", card.id), &location, &field, paths(&request, &location, seed));
            }
        }
        for (_, task) in TASKS.iter().filter(|(on, _)| on == name) {
            for rough in ROUGH {
                let request = asked(name, task, Some(rough), None);
                note(format!("{task}/{rough}"), &location, &field, paths(&request, &location, 1));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let good = found.iter().filter(|(share, _)| *share >= 0.8).count();
    for (share, name) in found.iter().take(60) {
        println!("{share:.2} {name}");
    }
    println!("{good} of {} ways at 0.8 or more; without an answer: {none:#?}", found.len());
    let kinds: usize = different.values().map(std::collections::BTreeSet::len).sum();
    println!("{kinds} different in {} questions", found.len());
    assert!(good * 100 >= found.len() * 95, "{good} of {}", found.len());
}
