//! Sources: shared lints, the longest file, nothing unfinished.

use super::{files, members, shown};

/// Longest file of source, lines.
const FILE_CAP: usize = 600;

#[test]
fn every_member_inherits_the_lints() {
    for (member, manifest) in members() {
        let inherited = manifest.get("lints").and_then(|lints| lints.get("workspace")).and_then(toml::Value::as_bool);
        assert_eq!(inherited, Some(true), "{member} does not say `[lints] workspace = true`");
    }
}

#[test]
fn no_source_file_is_longer_than_the_cap() {
    let long: Vec<String> = files(".rs")
        .iter()
        .map(|path| (path, std::fs::read_to_string(path).unwrap().lines().count()))
        .filter(|(_, lines)| *lines > FILE_CAP)
        .map(|(path, lines)| format!("  {lines} lines: {}", shown(path)))
        .collect();
    assert!(long.is_empty(), "files over {FILE_CAP} lines:\n{}", long.join("\n"));
}

#[test]
fn nothing_is_left_unfinished_or_allowed_away() {
    let marks = ["todo!(", "unimplemented!(", "dbg!(", "#[allow("];
    let mut found = Vec::new();
    for path in files(".rs").iter().filter(|path| !path.ends_with("house/sources.rs")) {
        for (number, line) in std::fs::read_to_string(path).unwrap().lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark)) {
                found.push(format!("  {}:{}: {}", shown(path), number + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "marks of unfinished work:\n{}", found.join("\n"));
}
