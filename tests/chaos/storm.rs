//! A storm: a batch on a cluster to which the faults of a schedule are done, and what must be left of it.
//!
//! `SOCRATES_CHAOS_SEED`, `SOCRATES_CHAOS_FAULTS` and `SOCRATES_CHAOS_SCENARIOS` make a longer one of it; `docs/reliability.md` has the command.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::Value;
use socrates_tests::program::{naming, poll};
use socrates_tests::skip;

use super::REQUEST;
use super::cluster::{Cluster, Disk, false_clock};
use super::figures::{Log, table};
use super::nemesis::{Storm, Struck};
use super::network::Network;
use super::schedule::{Kind, STAGES, draw, told};
use crate::socrates;

/// Scenarios of a storm that is compared with a calm run of the same batch, at most.
const COMPARED: u64 = 200;
/// How much faster than the clock a run is simulated: slow enough to be struck in the middle, 20 s in half a second.
const PACE: &str = "40";

/// A number from the environment.
fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().unwrap_or_else(|why| panic!("{name}={text}: {why}")))
}

/// Rules of `fsck` that something which is there twice breaks.
const DOUBLED: [&str; 4] = ["once", "result-or-dead", "result-attempt", "bundle-once"];

/// The object of `fsck`.
fn fsck(folder: &Path, what: &[&str]) -> Value {
    let args: Vec<&str> = ["--format", "json", "fsck"].iter().chain(what).copied().collect();
    let finished = socrates(folder, "fsck", &args);
    let told = finished.json();
    assert_eq!(told["sound"].as_bool(), Some(finished.code == 0), "{}\n{}", finished.out, finished.err);
    told
}

/// What breaks the rules of these names, in the object of `fsck`.
fn broken(told: &Value, names: &[&str]) -> usize {
    let rules = told["checked"].as_array().unwrap().iter();
    let of = rules.filter(|rule| names.contains(&rule["rule"].as_str().unwrap()));
    of.map(|rule| rule["wrong"].as_array().unwrap().len()).sum()
}

/// How many scenarios the orchestrator has done; none while it does not answer.
fn done(folder: &Path, endpoint: &str) -> Option<u64> {
    let at = format!("{endpoint}@main");
    socrates(folder, "status", &["--format", "json", "status", &at]).json()["done"].as_u64()
}

/// Manifests of the bundles of a library: digests of all that is in them.
fn manifests(library: &Path) -> BTreeMap<String, String> {
    let bundles = std::fs::read_dir(library).unwrap().map(|entry| entry.unwrap());
    let one = |entry: std::fs::DirEntry| {
        let text = std::fs::read_to_string(entry.path().join("details/manifest.json")).ok()?;
        Some((entry.file_name().into_string().unwrap(), text))
    };
    bundles.filter_map(one).collect()
}

/// Tells whoever reads the output of the test.
#[expect(clippy::print_stdout, reason = "schedule and table of the storm")]
fn tell(text: &str) {
    println!("{text}");
}

/// Inflicts the schedule as the batch goes on, then waits for its end.
fn strike(folder: &Path, storm: &mut Storm, seed: u64, faults: usize, count: u64) -> Vec<Struck> {
    let has = |kind: Kind| match kind {
        Kind::FullDisk => storm.disk.is_some(),
        Kind::ClockJump => storm.cluster.has_false_clock(),
        Kind::Partition | Kind::Loss => storm.cluster.network.is_some(),
        Kind::KillWorker
        | Kind::KillCrew
        | Kind::KillOrchestrator
        | Kind::KillRouter
        | Kind::FreezeWorker
        | Kind::FreezeOrchestrator => true,
    };
    let kinds: Vec<(Kind, u64)> = Kind::ALL.into_iter().filter(|(kind, _)| has(*kind)).collect();
    let faults = draw(seed, faults, count * STAGES.len() as u64, &kinds);
    tell(&told(seed, &faults).to_string());
    let mut struck = Vec::new();
    for fault in faults {
        let due = poll(|| {
            storm.tend();
            (storm.log.begun.len() as u64 >= fault.at).then_some(())
        });
        assert!(due.is_some(), "the batch stands still at {} attempts, before {fault:?}", storm.log.begun.len());
        struck.push(storm.inflict(fault));
    }
    let mut asked = Instant::now();
    let ended = poll(|| {
        storm.tend();
        if asked.elapsed() < Duration::from_secs(1) {
            return None;
        }
        asked = Instant::now();
        done(folder, &storm.cluster.endpoint).filter(|done| *done >= count)
    });
    assert!(ended.is_some(), "the batch did not end");
    struck
}

#[test]
fn nothing_is_lost_and_nothing_doubled_in_a_short_storm() {
    storm(1, 3, 16);
}

#[test]
#[ignore = "sweep: 16 faults during 120 scenarios, or as many as the environment says"]
fn nothing_is_lost_and_nothing_doubled_in_a_storm_of_faults() {
    let faults = usize::try_from(number("SOCRATES_CHAOS_FAULTS", 16)).unwrap();
    storm(number("SOCRATES_CHAOS_SEED", 1), faults, number("SOCRATES_CHAOS_SCENARIOS", 120));
}

/// A storm of this many faults during a batch of `count` scenarios.
fn storm(seed: u64, faults: usize, count: u64) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("batch.toml"), REQUEST).unwrap();
    let disk = skip::elsewhere(Disk::mount(&at.join("jobs"), 64 + count / 2));
    let clock = skip::installed(false_clock());
    let network = skip::elsewhere(Network::make());
    let cluster = Cluster::start(at, clock.as_deref(), network);
    let (variants, endpoint) = (count.to_string(), cluster.endpoint.clone());
    let mut storm = Storm { cluster, disk, log: Log::default(), off_s: 0 };
    let batch = ["batch.toml", "--variants", &variants, "--repeats", "--require", "any"];
    let submit = [&["cluster", "submit"][..], &batch, &["--pace", PACE, "--connect", &endpoint]].concat();
    let submitted = poll(|| Some(socrates(at, "submit", &submit)).filter(|submitted| submitted.code == 0));
    assert!(submitted.is_some(), "nothing was submitted");
    let begun = Instant::now();
    let struck = strike(at, &mut storm, seed, faults, count);
    let took = begun.elapsed();

    let collected = socrates(at, "collect", &["cluster", "collect", "--connect", &endpoint, "--out", "library"]);
    assert_eq!(collected.code, 0, "{}", collected.err);
    let told = fsck(at, &["jobs", "library"]);
    let counts = &told["stores"][0]["counts"];
    let of = |name: &str| counts[name].as_u64().unwrap_or_else(|| panic!("{told}"));
    let bundles = told["bundles"].as_u64().unwrap();
    tell(&table(&struck, &storm.log).join("\n"));
    tell(&format!(
        "seed {seed} · {} faults in {} s · {} scenarios, {} ended, {} failed · {} jobs, {} results, {} dead · {} attempts, \
         {} lost with their worker, {:.3} a result · lost {} · doubled {} · {} reigns · {} processes fell by themselves",
        struck.len(),
        took.as_secs(),
        of("scenarios"),
        of("ended"),
        of("failed"),
        of("jobs"),
        of("results"),
        of("dead"),
        of("attempts"),
        of("lapsed"),
        of("attempts") as f64 / of("results") as f64,
        count.saturating_sub(of("ended")),
        broken(&told, &DOUBLED),
        of("reigns"),
        storm.cluster.fell
    ));
    assert_eq!(told["sound"], true, "{:#}", told["wrong"]);
    let missed: Vec<_> = struck.iter().filter(|struck| !struck.fired).map(|struck| struck.fault).collect();
    assert!(missed.is_empty(), "not seen to strike: {missed:#?}");
    let last = struck.last().map(|struck| struck.over);
    assert!(storm.log.begun.last().map(|one| one.at) > last, "the batch was over before the last fault");
    assert_eq!((of("scenarios"), of("ended")), (count, count), "a scenario is lost");
    assert_eq!(bundles + of("failed"), count, "a bundle lacks, or one too many is there");
    // A job that loses its worker three times counts as one that kills it.
    assert!(of("failed") <= count / 20, "{} of {count} scenarios failed", of("failed"));
    drop(storm.cluster);
    let gone = poll(|| naming(at).is_empty().then_some(()));
    assert!(gone.is_some(), "left running: {:#?}", naming(at));
    assert_eq!(fsck(at, &["jobs"])["sound"], true, "the store of killed processes");
    if count <= COMPARED {
        let calm = [&["run"][..], &batch, &["--out", "calm"]].concat();
        let calm = socrates(at, "calm", &calm);
        assert_eq!(calm.code, 0, "{}", calm.err);
        let (calm, stormy) = (manifests(&at.join("calm")), manifests(&at.join("library")));
        assert_eq!(calm.len() as u64, count);
        let differ: Vec<&String> =
            stormy.iter().filter(|(name, text)| calm.get(*name) != Some(text)).map(|(name, _)| name).collect();
        assert!(differ.is_empty(), "not what a calm run makes: {differ:?}");
    }
}
