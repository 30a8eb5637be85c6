//! Experiments: what the verb writes, and how it ends.

use crate::socrates;

const SPEC: &str = r#"
title = "A small experiment"
scenarios = 30
tries = [3]
policies = ["none", "ladder"]

[[workload]]
name = "hard"
first_cut = 0.5

[[fault]]
kinds = ["worker_kill", "orchestrator_kill"]
rates = [0.1]
"#;

#[test]
fn an_experiment_leaves_its_tables_its_page_and_what_does_it_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("small.toml"), SPEC).unwrap();
    let made = |spec: &str, out: &str| {
        let finished = socrates(folder.path(), out, &["--format", "json", "experiment", spec, "--out", out]);
        assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
        finished.json()
    };
    let object = made("small.toml", "one");
    let cells = object["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 2);
    let count = |cell: usize, what: &str| cells[cell][what].as_u64().unwrap();
    assert_eq!((count(0, "lost"), count(1, "doubled"), count(1, "complaints")), (0, 0, 0));
    assert!(count(1, "realised") > count(0, "realised"), "asking again mends some of thirty: {object}");
    made("one/spec.lock.toml", "two");
    for name in ["cells.csv", "scenarios.csv", "attempts.csv", "report.html", "spec.lock.toml", "plots/success.svg"] {
        let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join(name)).unwrap();
        // The page tells the command that does it again, which names its own folder.
        assert_eq!(read("one").replace("one/", "two/"), read("two"), "{name}");
    }
}

#[test]
fn an_experiment_that_cannot_be_done_says_why() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("odd.toml"), SPEC.replace("worker_kill", "worker_kiln")).unwrap();
    let finished = socrates(folder.path(), "odd", &["experiment", "odd.toml"]);
    assert_eq!(finished.code, 2);
    for words in [
        "`odd.toml` cannot be read",
        "worker_kiln",
        "worker_kill",
        "hint: name a file",
        "reliability, worker-loss, outages",
    ] {
        assert!(finished.err.contains(words), "{words}: {}", finished.err);
    }
    assert!(!folder.path().join("experiment").exists());
}
