//! Every message replaced by `x`: over the shipped requests, all cards and every kind of injected fault, everything that is
//! decided stays the same.

use std::collections::BTreeMap;

use serde_json::json;
use socrates_author::FaultKind;
use socrates_author::confusion::{answers, confusion};
use socrates_author::offline::Offline;
use socrates_model::{Location, Request};
use socrates_prompts::Question;

use super::bench::{Decisions, facts, play, read_facts};
use super::{Masked, plain};

/// A wish that the program cannot meet, contradictions, places that no map has: requests that end in faults.
const TROUBLED: &[&str] = &[
    "A person drops a cup and kneels down.",
    "A nurse comes towards the robot. When the robot stops.",
    "A visitor on the escalator looks at the robot.",
    "A worker follows the robot and runs away from it.",
    "Three people stand there. The fourth looks at the robot.",
];

fn shipped() -> Vec<(String, Location, Request)> {
    let mut all = Vec::new();
    for name in socrates_maps::shipped::names() {
        let location = socrates_maps::shipped::load(name).unwrap();
        for (file, text) in socrates_maps::shipped::requests(name) {
            all.push((format!("{name} {file}"), location.clone(), toml::from_str(text).unwrap()));
        }
    }
    all
}

/// Every card, each on a map that has what it needs.
fn cards() -> Vec<(String, Location, Request)> {
    let maps: Vec<Location> =
        socrates_maps::shipped::names().iter().map(|name| socrates_maps::shipped::load(name).unwrap()).collect();
    let cards = socrates_offline::catalog().iter();
    cards
        .map(|card| {
            let location = maps.iter().find(|map| card.fits(map)).unwrap_or_else(|| &maps[0]).clone();
            let request = json!({
                "location": location.name, "social_context": "", "task": "Deliver mail", "expect": { "pattern": card.id },
            });
            (card.id.clone(), location, serde_json::from_value(request).unwrap())
        })
        .collect()
}

/// Everything that is decided about requests, cards and answers with faults in them.
async fn decisions() -> BTreeMap<String, Decisions> {
    let mut all = BTreeMap::new();
    let none = BTreeMap::new();
    let (shipped, cards) = (shipped(), cards());
    assert_eq!((shipped.len(), cards.len()), (12, 45));
    for (name, location, request) in shipped.iter().chain(&cards) {
        all.insert(name.clone(), play(request, location, 1, &none).await);
    }
    let office = socrates_maps::shipped::load("office").unwrap();
    for rough in TROUBLED {
        let request =
            json!({ "location": "office", "social_context": "", "task": "Drive to the exit", "rough_scenario": rough });
        let request: Request = serde_json::from_value(request).unwrap();
        all.insert((*rough).to_owned(), play(&request, &office, 1, &none).await);
    }
    // Every kind, often enough that jobs are asked again, sent back and given up.
    for (index, kind) in FaultKind::ALL.iter().enumerate() {
        let (name, location, request) = &shipped[index % shipped.len()];
        let settings = BTreeMap::from([(format!("fault.{}", kind.word()), "0.7".to_owned())]);
        all.insert(format!("{name} with {}", kind.word()), play(request, location, 1, &settings).await);
    }
    all
}

/// What the checks find of every kind of fault in the answers to the shipped requests, one more and all cards; every kind strikes.
async fn found() -> Decisions {
    let mut all = Decisions::new();
    let mut right = Vec::new();
    // In the answers to the shipped requests alone not every kind of fault has a place.
    let cards = cards().into_iter().map(|(_, location, request)| (request, location));
    for (request, location) in super::examples::shipped().into_iter().chain(cards) {
        let reading = socrates_offline::read(&request, &location);
        all.push(read_facts(&reading));
        right.extend(answers(&Offline, &Question::first(request, reading, location, 1)).await);
    }
    let table = confusion(&right).await;
    let put_in = |kind: FaultKind| {
        table.rows.iter().filter(|((_, other), _)| *other == kind).map(|(_, row)| row.put_in).sum::<usize>()
    };
    for kind in FaultKind::ALL {
        assert!(put_in(*kind) > 0, "{} has no place in any answer", kind.word());
    }
    all.extend(table.rows.iter().map(|(key, row)| format!("{key:?} {row:?}")));
    all.extend(table.clean.iter().map(|(stage, alarms)| format!("{stage} {alarms:?}")));
    all
}

fn run<T>(work: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(work)
}

fn same(one: &Decisions, other: &Decisions) -> Result<(), String> {
    match one.iter().zip(other).find(|(a, b)| a != b) {
        Some((a, b)) => Err(format!("  with messages     {a}\n  every message `x` {b}\n")),
        None if one.len() == other.len() => Ok(()),
        None => Err(format!("  {} decisions with messages, {} without\n", one.len(), other.len())),
    }
}

/// The same with messages, then with every message `x`.
fn twice<T>(what: impl AsyncFn() -> T) -> (T, T) {
    let before = {
        let _plain = plain();
        run(what())
    };
    let _masked = Masked::begin();
    let fault = socrates_model::Fault::new(socrates_model::FaultCode::GDisc, "robot", "jumps");
    assert_eq!(fault.message.to_string(), "x");
    (before, run(what()))
}

#[test]
fn no_check_reads_a_message() {
    let (before, after) = twice(found);
    let wrong = same(&before, &after).err().unwrap_or_default();
    assert!(wrong.is_empty(), "found otherwise without messages:\n{wrong}");
}

#[test]
fn no_decision_reads_a_message() {
    let (before, after) = twice(decisions);
    let mut wrong = String::new();
    for (name, decided) in &before {
        if let Err(why) = same(decided, &after[name]) {
            wrong.push_str(&format!("{name}:\n{why}"));
        }
    }
    assert!(wrong.is_empty(), "decided otherwise without messages:\n{wrong}");
    // The comparison is of something: jobs were told reasons, sent back and given up.
    let all = || before.values().flatten();
    let count = |part: &str| all().filter(|line| line.contains(part)).count();
    assert!(count("told [\"") > 40 && count("failed ") > 40 && count("repair Some") > 0, "{}", all().count());
    assert!(count("end Judged") > 50 && count("end Failed") > 0);
    assert!(!facts(&[]).iter().any(String::is_empty));
}
