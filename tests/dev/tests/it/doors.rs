//! Damaged inputs: every reader takes them or refuses them by name.

use crate::tool;

#[test]
fn damaged_inputs_at_every_door_are_read_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let finished = tool(folder.path(), "fuzz", &["--format", "json", "fuzz", "--seeds", "25", "--limit", "120"]);
    assert_eq!(finished.code, 0, "{}\n{}", finished.out, finished.err);
    let doors = finished.json()["doors"].as_array().unwrap().clone();
    assert!(doors.len() >= 14, "{doors:?}");
    // Neither all good nor all bad: the damage is neither nothing nor everything.
    let sum = |word: &str| doors.iter().map(|door| door[word].as_u64().unwrap()).sum::<u64>();
    let (read, refused, inputs) = (sum("read"), sum("refused"), sum("inputs"));
    assert_eq!(read + refused, inputs, "{doors:?}");
    assert!(read * 20 > inputs && refused * 5 > inputs, "{read} read, {refused} refused of {inputs}");
}

#[test]
fn what_panics_hangs_or_names_no_file_is_counted_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--format", "json", "fuzz", "--door", "alarm", "--seeds", "12", "--limit", "1", "--keep", "kept"];
    let finished = tool(folder.path(), "alarm", &args);
    assert_eq!(finished.code, 1, "{}", finished.err);
    let found = finished.json();
    for word in ["panicked", "hung", "unnamed", "ours"] {
        assert!(found["doors"][0][word].as_u64().unwrap() > 0, "{word}: {found}");
    }
    for find in found["finds"].as_array().unwrap() {
        assert!(folder.path().join(find["input"].as_str().unwrap()).is_file(), "{find}");
    }
}
