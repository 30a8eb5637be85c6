//! What the README shows is what happens.

use socrates_tests::program::{finish, start_typed};
use socrates_tests::root;

use crate::{PROGRAM, socrates};

/// The conversation of the README, line by line.
fn conversation() -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let section = readme.split("## Steering it").nth(1).unwrap();
    let block = section.split("```text\n").nth(1).unwrap().split("```").next().unwrap();
    block.lines().map(str::to_owned).collect()
}

#[test]
fn the_conversation_of_the_readme_does_what_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let new = socrates(folder.path(), "new", &["new", "my.toml", "--location", "office"]);
    assert_eq!(new.code, 0, "{}", new.err);
    let lines = conversation();
    let typed: Vec<&str> = lines.iter().filter_map(|line| line.strip_prefix("look 2> ")).collect();
    assert!(typed.len() >= 3 && typed.last() == Some(&"accept"), "{typed:?}");
    // The README begins at the second look.
    let keys = format!("accept\n{}\n", typed.join("\n"));
    let args = ["run", "my.toml", "--ask", "--author", "offline", "--require", "any"];
    let child = start_typed(PROGRAM, &args, folder.path(), "asked", &keys, &[("EDITOR", "true")]).unwrap();
    let finished = finish(child, folder.path(), "asked").unwrap();
    assert_eq!(finished.code, 0, "{}\n{}", finished.err, finished.out);
    let said = format!("{}\n{}", finished.out, finished.err);
    for wrong in ["no difference", "not done", "nothing to undo"] {
        assert!(!said.contains(wrong), "{said}");
    }
    // Every line that it shows begins as one that is printed: numbers and nodes may change with the map.
    for line in lines.iter().filter(|line| !line.starts_with("look 2>")) {
        let beginning: String = line.chars().take(11).collect();
        assert!(
            said.lines().any(|printed| printed.starts_with(beginning.trim_end())),
            "`{beginning}` of `{line}`\n{said}"
        );
    }
}
