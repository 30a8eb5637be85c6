//! The recordings that real processes make, by hash: a changed line needs a commit that gives the reason. The other lines of the list are
//! held by `tests/dev/tests/it/golden.rs`.

use socrates_tests::program::run;
use socrates_tests::root;

use crate::PROGRAM;

/// Where the list is kept.
const LIST: &str = "tests/golden/recordings.txt";
/// Kind of the lines that real processes made.
const RUN: &str = "run";

/// Lines of the list that say something.
fn entries(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()).collect()
}

#[test]
fn runs_by_processes_record_what_the_list_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut made = Vec::new();
    for (location, name) in [("hospital", "elevator"), ("office", "corridor"), ("warehouse", "group")] {
        let request = root().join(format!("maps/{location}/scenarios/{name}.toml")).display().to_string();
        for seed in ["1", "2"] {
            let bundle = format!("{name}-{seed}");
            let program =
                |args: &[&str]| run(PROGRAM, &[&["--format", "json"], args].concat(), folder.path(), &bundle).unwrap();
            let done = program(&["run", &request, "--out", &bundle, "--seed", seed]);
            assert_eq!(done.code, 0, "{}", done.err);
            let again = program(&["simulate", &bundle]);
            let hash = again.json()["runs"][0]["recording_hash"].as_str().unwrap_or_default().to_owned();
            made.push(format!("{RUN:<7} {:<42} {seed} {hash}", format!("{location}-{name}")));
        }
    }
    let kept = std::fs::read_to_string(root().join(LIST)).unwrap();
    let kept: Vec<&str> = entries(&kept).into_iter().filter(|line| line.starts_with(RUN)).collect();
    assert_eq!(kept, made, "the lines of {LIST} by processes differ; these are the new ones:\n{}", made.join("\n"));
}
