//! The recordings of everything that is shipped, by hash: a changed line needs a commit that gives the reason. Those of whole processes are
//! held by the tests of the product.

use socrates_tests::root;

use crate::tool;

/// Where the list is kept.
const LIST: &str = "tests/golden/recordings.txt";
/// Kind of the lines that real processes made.
const RUN: &str = "run";
/// Largest number of changed lines that are shown.
const SHOWN: usize = 20;

/// Lines of the list that say something.
fn entries(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()).collect()
}

#[test]
fn recordings_are_those_of_the_list() {
    let folder = tempfile::tempdir().unwrap();
    let mut agents: Vec<String> = std::fs::read_dir(root().join("tests/golden/agents"))
        .unwrap()
        .map(|entry| entry.unwrap().path().display().to_string())
        .collect();
    agents.sort();
    let mut args = vec!["golden"];
    args.extend(agents.iter().map(String::as_str));
    let made = tool(folder.path(), "golden", &args);
    assert_eq!(made.code, 0, "{}", made.err);
    let kept = std::fs::read_to_string(root().join(LIST)).unwrap();
    let kept: Vec<&str> = entries(&kept).into_iter().filter(|line| !line.starts_with(RUN)).collect();
    let made = entries(&made.out);
    let mut changed: Vec<String> = kept.iter().filter(|line| !made.contains(line)).map(|l| format!("- {l}")).collect();
    changed.extend(made.iter().filter(|line| !kept.contains(line)).map(|line| format!("+ {line}")));
    assert!(
        changed.is_empty(),
        "{} lines of {LIST} differ; where that is meant, write the list anew by the command at its head, in a commit of its own \
         that gives the reason:\n{}",
        changed.len(),
        changed.iter().take(SHOWN).cloned().collect::<Vec<_>>().join("\n")
    );
    assert_eq!(kept, made, "the order of {LIST} differs");
    // 12 requests, 25 canonical scenarios, 4 agents files by 2 profiles; 2 seeds each.
    assert_eq!(kept.len(), 2 * (12 + 25 + 4 * 2));
    assert!(kept.iter().all(|line| !line.contains("not made")), "a shipped scenario is not made");
}
