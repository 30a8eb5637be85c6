//! Who looks and leaves comes back at once, as often as they like, and finds what they changed; also who was killed.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use socrates_model::job::Stage;
use socrates_orchestrator::{Attempt, AttemptEnd};
use socrates_store::{SqliteStore, Store as _};
use socrates_tests::program::{naming, poll, signal};

use crate::life::asking::asked;
use crate::{PROGRAM, WAREHOUSE};

/// Every attempt at a look, out of the job store.
fn looks(folder: &Path) -> Vec<Attempt> {
    let mut store = SqliteStore::open(&folder.join("bundle/.socrates/jobs.sqlite")).unwrap();
    let attempts = store.load().unwrap().attempts;
    attempts.into_iter().filter(|(key, _)| key.stage == Stage::Review).map(|(_, attempt)| attempt).collect()
}

fn speed(folder: &Path) -> f64 {
    let text = std::fs::read_to_string(folder.join("bundle/details/proposal.json")).unwrap();
    let proposal: serde_json::Value = serde_json::from_str(&text).unwrap();
    proposal["humans"][0]["speed_mps"].as_f64().unwrap()
}

#[test]
fn departures_hand_the_look_back_and_keep_what_was_changed() {
    leave(3);
}

#[test]
#[ignore = "sweep: a hundred visits of the whole program"]
fn a_hundred_departures_hand_the_look_back_and_keep_what_was_changed() {
    leave(100);
}

/// Visits of the whole program: each looks and leaves, the first changes a speed before; then the scenario is accepted.
#[expect(clippy::print_stderr, reason = "the times are printed, not judged")]
fn leave(visits: usize) {
    let folder = tempfile::tempdir().unwrap();
    let mut times: Vec<Duration> = Vec::new();
    for visit in 0..visits {
        let typed = if visit == 0 { "slow down human_1\nquit\n" } else { "quit\n" };
        let begun = Instant::now();
        let (finished, _) = asked(folder.path(), "visit", typed, "true");
        times.push(begun.elapsed());
        assert_eq!(finished.code, 4, "visit {visit}: {}", finished.err);
        assert!(finished.err.contains("left at look 1; nothing is lost"), "visit {visit}: {}", finished.err);
        assert!(!finished.err.contains("ERROR") && !finished.err.contains("WARN"), "visit {visit}: {}", finished.err);
    }
    times.sort_unstable();
    eprintln!(
        "{visits} visits, start to end of the program: median {:?}, slowest {:?}",
        times[visits / 2],
        times[visits - 1]
    );
    // The log of events says why: no visit waited for a lease, because each had handed the look back.
    let looks = looks(folder.path());
    assert_eq!(looks.len(), visits);
    let ends: Vec<_> = looks.iter().map(|look| look.end).filter(|end| *end != Some(AttemptEnd::Released)).collect();
    assert!(ends.is_empty(), "{ends:?}");
    let (finished, json) = asked(folder.path(), "last", "accept\naccept\n", "true");
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    assert!(speed(folder.path()) < 1.2, "{}", speed(folder.path()));
}

#[test]
#[expect(clippy::print_stderr, reason = "the time is printed, not judged")]
fn a_look_whose_program_was_killed_comes_back_with_what_was_changed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("asked.toml"), WAREHOUSE).unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    for _ in 0..4 {
        let mut program = Command::new(PROGRAM)
            .args(["--format", "json", "run", &path("asked.toml"), "--out", &path("bundle"), "--ask"])
            .args(["--author", "offline"])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(std::fs::File::create(folder.path().join("killed.err")).unwrap())
            .spawn()
            .unwrap();
        let mut typing = program.stdin.take().unwrap();
        let kept = || std::fs::read_to_string(folder.path().join("bundle/.socrates/ask.json")).unwrap_or_default();
        if !kept().contains("slow down human_1") {
            writeln!(typing, "slow down human_1").unwrap();
        }
        let shown = || std::fs::read_to_string(folder.path().join("killed.err")).unwrap_or_default();
        let asked =
            poll(|| (shown().contains("type what should change") && kept().contains("slow down")).then_some(()));
        assert!(asked.is_some(), "{}", shown());
        assert!(signal(program.id(), "KILL").unwrap());
        program.wait().unwrap();
        drop(typing);
    }
    let begun = Instant::now();
    let (finished, json) = asked(folder.path(), "after", "accept\naccept\n", "true");
    eprintln!("after four kills the scenario is there in {:?}", begun.elapsed());
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    assert!(speed(folder.path()) < 1.2, "{}", speed(folder.path()));
    let left = poll(|| naming(folder.path()).is_empty().then_some(()));
    assert!(left.is_some(), "left running: {:#?}", naming(folder.path()));
}
