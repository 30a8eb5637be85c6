//! Three people at three places of a map, drawn: how many of the forms are played as stated.

use std::collections::BTreeMap;
use std::path::Path;

use socrates_app::config::Config;
use socrates_app::prepare::prepare_text;
use socrates_model::Verdict;
use socrates_model::seeds::SplitMix64;

use crate::mutations::realised;

/// Forms of the gate, of which each is realised, and of a sweep.
const FEW: [(&str, [&str; 3]); 3] = [
    ("office", ["blind corner", "doorway", "kitchen"]),
    ("hospital", ["corridor", "corridor end", "pharmacy room"]),
    ("warehouse", ["intersection", "packing area", "break room"]),
];
const MANY: usize = 60;
/// Least share of a sweep that is realised.
const LEAST: f64 = 0.33;
/// Places by map.
const PLACES: [(&str, &[&str]); 3] = [
    (
        "hospital",
        &[
            "corridor",
            "intersection",
            "blind corner",
            "waiting area",
            "nurse station area",
            "doorway",
            "ward",
            "pharmacy room",
        ],
    ),
    (
        "office",
        &[
            "corridor",
            "intersection",
            "blind corner",
            "reception area",
            "open-plan area",
            "kitchen",
            "doorway",
            "meeting room",
        ],
    ),
    (
        "warehouse",
        &[
            "passageway",
            "intersection",
            "blind corner",
            "packing area",
            "open area",
            "narrow aisle",
            "break room",
            "loading dock",
        ],
    ),
];

/// The verdict of a form with a person at each place; in words where there is no run.
async fn verdict(map: &str, people: &[(&str, &str)], seed: u64) -> String {
    let human = |(relation, place): &(&str, &str)| {
        format!("[[human]]\nrole = \"visitor\"\nrelation = \"{relation}\"\nplace = \"{place}\"\n")
    };
    let people: String = people.iter().map(human).collect();
    let text = format!("location = \"{map}\"\ntask = \"Deliver mail\"\n{people}");
    let config = Config::load(None, std::iter::empty(), &[]).unwrap();
    let Ok(prepared) = prepare_text(map, &text, map, Path::new("."), None, &config) else {
        return "refused".to_owned();
    };
    let made = realised(prepared, seed).await;
    made.map_or_else(|_no_way| "no way".to_owned(), |scenario| scenario.report.verdict.to_string())
}

#[tokio::test]
async fn people_who_stand_at_dead_ends_of_a_map_are_met_where_they_stand() {
    for (map, places) in FEW {
        let people = places.map(|place| ("static", place));
        assert_eq!(verdict(map, &people, 1).await, Verdict::Realised.to_string(), "{map}: {places:?}");
    }
}

#[tokio::test]
#[ignore = "sweep: 60 forms with three people at three places"]
#[expect(clippy::print_stdout, reason = "a sweep prints its figure")]
async fn people_at_three_places_are_met_there() {
    let mut draw = SplitMix64::new(20_261_130);
    let mut verdicts: BTreeMap<String, usize> = BTreeMap::new();
    for _ in 0..MANY {
        let (map, places) = PLACES[draw.below(PLACES.len())];
        let mut left = places.to_vec();
        let mut person =
            || (["static", "static", "frontal", "crossing"][draw.below(4)], left.remove(draw.below(left.len())));
        let people = [person(), person(), person()];
        *verdicts.entry(verdict(map, &people, 1).await).or_default() += 1;
    }
    let done = verdicts.get(&Verdict::Realised.to_string()).copied().unwrap_or_default();
    println!("{done} of {MANY} realised, bound {LEAST}: {verdicts:?}");
    assert!(done as f64 >= LEAST * MANY as f64, "{verdicts:?}");
}
