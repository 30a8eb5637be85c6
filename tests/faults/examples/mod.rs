//! The example on every fault's page: the text of a fault that was really provoked, by the checks, readers, doors and machines
//! that find it.
//!
//! ```text
//! one file per letter ──► code -> fault ──► `## Example` of bus/model/faults/CODE.md
//! ```
//!
//! A page that shows another text fails; `SOCRATES_WRITE_PAGES=1` writes the pages anew.

mod answers;
mod behaviors;
mod dynamic;
mod jobs;
mod maps;
mod paths;
mod proposals;
mod transport;

use std::collections::BTreeMap;

use socrates_author::offline::Offline;
use socrates_author::{FaultKind, FaultRates, FaultyAuthor, attempt};
use socrates_model::job::Stage;
use socrates_model::{Fault, FaultCode, Location, Proposal, Request};
use socrates_prompts::Question;
use socrates_tests::root;

use super::plain;

/// Codes that are provoked elsewhere, with the test that holds their pages to what it found.
const ELSEWHERE: &[(FaultCode, &str)] = &[
    (FaultCode::PPerson, "orchestrator/app/src/ask/tests.rs: a person sends something back in a conversation"),
    (FaultCode::JDriver, "workers/simulation/src/driving/tests.rs: a driver answers what is no number"),
    (FaultCode::JPanic, "workers/kit/tests/worker.rs: a stage panics"),
    (FaultCode::JBlob, "workers/kit/tests/worker.rs: an input is not where it should be"),
];

/// Heading of the example on a page.
const HEADING: &str = "## Example\n\n```text\n";

/// What a room provokes, by code, as it is printed; the first of each code is shown.
pub(crate) type Examples = BTreeMap<FaultCode, String>;

/// Keeps the first fault of each code.
pub(crate) fn keep(all: &mut Examples, faults: impl IntoIterator<Item = Fault>) {
    for fault in faults {
        all.entry(fault.code).or_insert_with(|| fault.to_string());
    }
}

/// A request to the shipped office.
pub(crate) fn office(task: &str, rough: &str) -> (Request, Location) {
    let request =
        serde_json::json!({ "location": "office", "social_context": "", "task": task, "rough_scenario": rough });
    (serde_json::from_value(request).unwrap(), socrates_maps::shipped::load("office").unwrap())
}

/// A long way to a blind corner leaves room for an encounter elsewhere.
const FURTHER: &str = r#"
location = "warehouse"
social_context = "An ordinary day"
task = "Bring a box from the loading dock to the packing area"
rough_scenario = "A worker comes towards the robot at a blind corner and steps aside."
"#;

/// The shipped requests, and one more, with their locations.
pub(crate) fn shipped() -> Vec<(Request, Location)> {
    let names = socrates_maps::shipped::names().iter();
    names
        .flat_map(|name| {
            let location = socrates_maps::shipped::load(name).unwrap();
            let requests = socrates_maps::shipped::requests(name).into_iter();
            requests.map(move |(_, text)| (toml::from_str(text).unwrap(), location.clone()))
        })
        .chain([(toml::from_str(FURTHER).unwrap(), socrates_maps::shipped::load("warehouse").unwrap())])
        .collect()
}

/// The question of a stage, answered as far as it needs.
pub(crate) async fn question(request: &Request, location: &Location, stage: Stage) -> Question {
    let reading = socrates_offline::read(request, location);
    let first = Question::first(request.clone(), reading, location.clone(), 1);
    if stage == Stage::Proposal {
        return first;
    }
    let proposal = proposed(request, location).await;
    Question { stage, proposal: Some(proposal), ..first }
}

/// The offline author's proposal.
pub(crate) async fn proposed(request: &Request, location: &Location) -> Proposal {
    let reading = socrates_offline::read(request, location);
    let question = Question::first(request.clone(), reading, location.clone(), 1);
    match attempt(&Offline, &question).await.unwrap().written {
        socrates_author::Written::Proposal(proposal) => proposal,
        other @ (socrates_author::Written::Paths(_) | socrates_author::Written::Behaviors(_)) => panic!("{other:?}"),
    }
}

/// What is found in answers into which faults of one family of kinds were put, one at a time.
pub(crate) async fn injected(stage: Stage, wanted: impl Fn(FaultKind) -> bool) -> Examples {
    let mut all = Examples::new();
    for (request, location) in shipped() {
        let left: Vec<FaultKind> =
            FaultKind::ALL.iter().copied().filter(|kind| wanted(*kind) && !all.contains_key(&kind.code())).collect();
        if left.is_empty() {
            break;
        }
        let question = question(&request, &location, stage).await;
        for kind in left {
            let rates = FaultRates { rates: BTreeMap::from([(kind, 1.0)]), ..FaultRates::default() };
            let exchange = match attempt(&FaultyAuthor::new(Offline, rates, 1), &question).await {
                Ok(made) => made.exchange,
                Err(refused) => *refused.exchange,
            };
            let found = exchange.faults.into_iter().chain(exchange.repairs);
            keep(&mut all, found.filter(|fault| fault.code == kind.code()));
        }
    }
    all
}

async fn examples() -> Examples {
    let mut all = Examples::new();
    for found in [
        transport::examples().await,
        answers::examples().await,
        proposals::examples().await,
        paths::examples().await,
        behaviors::examples().await,
        dynamic::examples().await,
        maps::examples(),
        jobs::examples().await,
    ] {
        found.into_iter().for_each(|(code, text)| {
            all.entry(code).or_insert(text);
        });
    }
    all
}

/// The page with this example in place of the one it has.
fn with_example(page: &str, text: &str) -> String {
    let block = format!("{HEADING}{text}\n```\n");
    let (before, after) = match page.split_once("## Example\n\n```text\n").or_else(|| page.split_once("```text\n")) {
        Some((before, rest)) => (before, rest.split_once("\n```\n").map_or("", |(_, after)| after)),
        None => (page, ""),
    };
    format!("{}\n\n{block}{after}", before.trim_end())
}

#[test]
fn every_page_shows_a_fault_that_was_really_found() {
    let _plain = plain();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let all = runtime.block_on(examples());
    let write = std::env::var_os("SOCRATES_WRITE_PAGES").is_some();
    let (mut missing, mut stale) = (Vec::new(), Vec::new());
    for code in FaultCode::ALL {
        let Some(text) = all.get(code) else {
            missing.push(*code);
            continue;
        };
        let file = root().join(format!("bus/model/faults/{code}.md"));
        let page = std::fs::read_to_string(&file).unwrap();
        let wanted = with_example(&page, text);
        if page == wanted {
            continue;
        }
        if write {
            std::fs::write(&file, wanted).unwrap();
        }
        stale.push(format!("{code}: {text}"));
    }
    let elsewhere: Vec<FaultCode> = ELSEWHERE.iter().map(|(code, _)| *code).collect();
    assert_eq!(missing, elsewhere, "codes that were not provoked here, and those that other tests provoke");
    assert!(
        stale.is_empty(),
        "pages show other examples; `SOCRATES_WRITE_PAGES=1` writes them anew, look at what they say then:\n{}",
        stale.join("\n")
    );
}

#[test]
fn an_example_takes_the_place_of_the_one_before() {
    let page = "# X\n\nAbout.\n\n```text\nold\n```\n\n**What you can do.**\n";
    let new = with_example(page, "new");
    assert_eq!(new, "# X\n\nAbout.\n\n## Example\n\n```text\nnew\n```\n\n**What you can do.**\n");
    assert_eq!(with_example(&new, "new"), new);
}
