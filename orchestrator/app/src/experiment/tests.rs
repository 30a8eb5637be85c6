use super::*;
use crate::output::Format;

const SMALL: &str = r#"
title = "Small <and> quick"
scenarios = 40
tries = [1, 3]
policies = ["none", "ladder", "mine"]
attempt_rows = 500

[[workload]]
name = "hard"
first_cut = 0.5

[[fault]]
kinds = ["llm_error", "worker_kill"]
rates = [0.0, 0.1]

[policy.mine]
like = "fixed"
pause_ms = 100
"#;

/// Runs a specification in a folder; its files are in `out` there.
fn run(folder: &Path, spec: &Path, out: &str) -> Result<(), Diagnostic> {
    let options = ExperimentOptions { spec: spec.to_path_buf(), out: folder.join(out), scenarios: None };
    let config = Config::load(None, std::iter::empty(), &[])?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(experiment(&Printer::to_nobody(Format::Json), &config, &options))
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn an_experiment_writes_its_files_and_its_lock_does_it_again_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("small.toml");
    std::fs::write(&spec, SMALL).unwrap();
    run(folder.path(), &spec, "one").unwrap();
    let one = folder.path().join("one");
    let cells = read(&one, "cells.csv");
    assert_eq!(cells.lines().count(), 1 + 2 * 2 * 3, "{cells}");
    assert!(cells.lines().nth(1).unwrap().starts_with("0,hard,llm_error+worker_kill,0,1,none,40,"), "{cells}");
    assert_eq!(read(&one, "scenarios.csv").lines().count(), 1 + 12 * 40);
    assert_eq!(read(&one, "attempts.csv").lines().count(), 501, "a heading and as many as are allowed");
    let page = read(&one, "report.html");
    assert!(page.contains("Small &lt;and&gt; quick") && !page.contains("<and>"), "{page}");
    for part in
        ["Injected faults", "0 lost, 0 doubled, 0 complaints", "injected faults</text>", "<b>mine</b>", "Bonett"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("src=") && !page.contains("http://") || page.contains("http://www.w3.org/2000/svg"));
    assert!(!page.contains("NaN") && !page.contains("inf<"), "every number is one");
    let drawn: Vec<String> = std::fs::read_dir(one.join("plots"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert!(drawn.len() == 7 && drawn.contains(&"success.svg".to_owned()), "{drawn:?}");

    run(folder.path(), &one.join("spec.lock.toml"), "two").unwrap();
    let two = folder.path().join("two");
    for name in
        ["cells.csv", "scenarios.csv", "attempts.csv", "spec.lock.toml", "plots/success.svg", "plots/failures.svg"]
    {
        assert_eq!(read(&one, name), read(&two, name), "{name}");
    }
}

#[test]
fn what_cannot_be_done_is_said_with_file_key_value_and_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("odd.toml");
    for (from, to, words) in [
        ("tries = [1, 3]", "tries = [0, 3]", "`tries` is `0`; allowed: 1 to 20"),
        ("tries = [1, 3]", "trys = [1]", "unknown field `trys`"),
        ("rates = [0.0, 0.1]", "rates = [1.5]", "`rates` is `1.5`; allowed: a probability from 0 to 1"),
        ("first_cut = 0.5", "first_cut = 0.0", "`first_cut` is `0`; allowed: a probability above 0, up to 1"),
        ("\"worker_kill\"", "\"worker_quits\"", "unknown variant `worker_quits`"),
        ("\"none\", ", "\"hedged\", ", "`policies` names `hedged`; there is none, immediate"),
        ("\"ladder\", \"mine\"", "\"ladder\"", "`policy.mine` is not used"),
        ("pause_ms = 100", "pause_ms = 99999999", "`policy.mine.pause_ms` is `99999999`; allowed: 0 to 3600000"),
        ("scenarios = 40", "scenarios = 900000", "it asks for 10800000 scenarios"),
        ("scenarios = 40", "level = \"processes\"\nworkers = { paths = 200 }", "`workers` are"),
        ("scenarios = 40", "durations = { paths = { uniform = [5, 1] } }", "`durations.paths` is `uniform = [5, 1]`"),
        ("scenarios = 40", "workers = { paths = 0 }", "`workers.paths` is `0`; allowed: 1 to 256"),
    ] {
        assert!(SMALL.contains(from), "{from}");
        std::fs::write(&spec, SMALL.replacen(from, to, 1)).unwrap();
        let diagnostic = run(folder.path(), &spec, "none").unwrap_err();
        let told = diagnostic.to_string();
        assert_eq!(diagnostic.code, Code::Input, "{told}");
        assert!(told.contains(words) && told.contains("odd.toml") && !diagnostic.hint.is_empty(), "{words}: {told}");
    }
    assert!(!folder.path().join("none").exists(), "nothing is written before all of it can be done");
}

#[test]
fn what_cannot_be_done_to_processes_is_refused_by_its_name_with_what_can() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("cut.toml");
    for (kind, hint) in [("partition", "`worker_freeze` silences a worker"), ("slow_store", "`level = \"simulator\"`")]
    {
        let text =
            SMALL.replace("worker_kill", kind).replace("scenarios = 40", "scenarios = 40\nlevel = \"processes\"");
        std::fs::write(&spec, text).unwrap();
        let diagnostic = run(folder.path(), &spec, "none").unwrap_err();
        let told = diagnostic.to_string();
        assert_eq!(diagnostic.code, Code::Input, "{told}");
        assert!(told.contains(&format!("`{kind}` with `level = \"processes\"`")) && told.contains(hint), "{told}");
    }
    assert!(!folder.path().join("none").exists());
}

#[test]
fn shipped_experiments_can_be_done_and_are_small_enough_to_wait_for() {
    for (name, _) in DOOR.shipped {
        let spec = load(Path::new(name), None).unwrap();
        let scenarios = spec.cells().len() as u64 * u64::from(spec.scenarios);
        let few = spec.level == Level::Processes;
        let fit = if few { 50..=1_000 } else { 2_000..=100_000 };
        assert!(fit.contains(&scenarios), "{name} plays {scenarios} scenarios");
        assert!(!spec.about.is_empty() && spec.workload.iter().all(|workload| workload.first_cut > 0.0));
    }
    let spec = load(Path::new("reliability"), None).unwrap();
    let shares: Vec<f64> = spec.workload.iter().map(|workload| workload.first_cut).collect();
    assert_eq!(shares, [0.73, 0.55, 0.30, 0.10], "the paper's");
}
