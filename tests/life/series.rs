//! Batches that are longer than what is made of them ahead, and what a batch may take.

use std::path::Path;

use socrates_tests::program::{Finished, finish, naming, poll, signal, start};

use crate::{PROGRAM, WAREHOUSE, socrates};

/// One batch in the answer to `status`.
fn batch(at: &Path, endpoint: &str, name: &str) -> serde_json::Value {
    let told = socrates(at, "asked", &["--format", "json", "status", endpoint]).json();
    let batches = told["batches"].as_array().cloned().unwrap_or_default();
    batches.into_iter().find(|batch| batch["name"] == name).unwrap_or_default()
}

fn submit(at: &Path, endpoint: &str, words: &[&str]) -> Finished {
    let fixed = ["cluster", "submit", "hall.toml", "--repeats", "--connect", endpoint];
    socrates(at, "submitted", &[&fixed[..], words].concat())
}

#[test]
fn a_long_batch_is_made_bit_by_bit_collected_whole_and_ended_at_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let endpoint = format!("unixsock-stream/{}", at.join("bus").display());
    let up = start(PROGRAM, &["cluster", "up", "--dir", "jobs", "--listen", &endpoint], at, "up").unwrap();
    assert!(poll(|| at.join("bus").exists().then_some(())).is_some());

    // Five thousand scenarios are two series, of which sixteen each are made.
    let long = submit(at, &endpoint, &["--variants", "5000", "--seed", "1", "--batch", "long", "--max-hours", "0.001"]);
    assert!(long.code == 0 && long.out.contains("submitted  5000 scenarios"), "{}{}", long.out, long.err);
    let told = batch(at, &endpoint, "long");
    assert_eq!((&told["total"], &told["unmade"]), (&5000.into(), &4968.into()), "{told}");
    let again = submit(at, &endpoint, &["--variants", "5000", "--seed", "1", "--batch", "long"]);
    assert!(again.out.contains("5000 of them were there already"), "{}{}", again.out, again.err);
    // Nobody works, and its time is over: what waits fails with the reason, and nothing of it stays open.
    assert!(poll(|| (batch(at, &endpoint, "long")["failed"] == 5000).then_some(())).is_some());
    let told = socrates(at, "asked", &["status", &endpoint]);
    assert!(told.out.contains("nothing more of it is begun: the batch `long` ran for"), "{}", told.out);
    let why = socrates(at, "asked", &["explain", "hall-1-00001/proposal", "--connect", &endpoint]);
    assert!(why.out.contains("J-DEADLINE") && why.out.contains("its deadline is 3 s"), "{}{}", why.out, why.err);
    let checked = socrates(at, "asked", &["fsck", "jobs"]);
    assert_eq!(checked.code, 0, "{}{}", checked.out, checked.err);

    // One that is drawn from while workers are there comes out as a run of the same requests does.
    let short = submit(at, &endpoint, &["--variants", "20", "--seed", "2", "--batch", "short"]);
    assert_eq!(short.code, 0, "{}", short.err);
    let work = ["cluster", "work", "--connect", &endpoint, "--slots", "1", "--dir", "spool"];
    let work = start(PROGRAM, &work, at, "work").unwrap();
    assert!(poll(|| (batch(at, &endpoint, "short")["done"] == 20).then_some(())).is_some(), "not all was made");
    let collect = ["cluster", "collect", "--connect", &endpoint, "--batch", "short", "--out", "collected"];
    let collected = socrates(at, "collected", &collect);
    assert_eq!(collected.code, 0, "{}{}", collected.out, collected.err);
    let run =
        socrates(at, "run", &["run", "hall.toml", "--repeats", "--variants", "20", "--seed", "2", "--out", "own"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let table = |library: &str| std::fs::read_to_string(at.join(library).join("index.csv")).unwrap();
    assert_eq!(table("collected"), table("own"));
    assert_eq!(table("own").lines().count(), 21);

    for (child, name) in [(work, "work"), (up, "up")] {
        assert!(signal(child.id(), "TERM").unwrap());
        let ended = finish(child, at, name).unwrap();
        assert_eq!(ended.code, 0, "{name}: {}{}", ended.out, ended.err);
    }
    assert!(poll(|| naming(at).is_empty().then_some(())).is_some(), "left running: {:#?}", naming(at));
}

#[test]
fn a_limit_that_lets_nothing_be_made_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    for (words, told) in [
        (["--max-hours", "0"], "`--max-hours 0` is no time"),
        (["--max-hours", "-3"], "`--max-hours -3` is no time"),
        (["--max-hours", "1e9"], "at most 87600 hours"),
        (["--max-tokens", "0"], "`--max-tokens 0` lets nothing be made"),
        (["--max-cents", "0"], "`--max-cents 0` lets nothing be made"),
    ] {
        let words = words.join("=");
        let refused = submit(at, "unixsock-stream/nobody", &[&words]);
        assert!(refused.code == 2 && refused.err.contains(told), "{words}: {}{}", refused.out, refused.err);
    }
}
