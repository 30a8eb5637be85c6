//! Folders that are in use, vanish or take nothing more: one line that says so, and nothing goes on.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use socrates_tests::program::{Finished, finish, naming, poll, start};

use crate::{PROGRAM, WAREHOUSE};

fn begun(folder: &Path, pace: &str) -> (Child, Vec<String>) {
    let file = folder.join("folder.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.join("bundle").display().to_string());
    let args = ["run", &file, "--out", &out, "--author", "offline", "--require", "any", "--pace", pace];
    let args: Vec<String> = args.iter().map(ToString::to_string).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let run = start(PROGRAM, &words, folder, "first").unwrap();
    let simulating = poll(|| {
        let blobs = std::fs::read_dir(folder.join("bundle/.socrates/blobs")).ok()?;
        (blobs.count() >= 5).then_some(())
    });
    assert!(simulating.is_some());
    (run, args)
}

/// One line, its hint, and nothing else.
fn one_line(finished: &Finished, words: &str) {
    let lines: Vec<&str> = finished.err.lines().filter(|line| !line.trim().is_empty()).collect();
    assert!(lines.len() <= 2 && finished.err.contains(words), "{}", finished.err);
}

fn nothing_runs(folder: &Path) {
    let left = poll(|| naming(folder).is_empty().then_some(()));
    assert!(left.is_some(), "left running: {:#?}", naming(folder));
}

#[test]
fn a_folder_in_which_something_is_made_is_refused_with_its_maker() {
    let folder = tempfile::tempdir().unwrap();
    let (first, args) = begun(folder.path(), "8");
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let second = start(PROGRAM, &words, folder.path(), "second").unwrap();
    let second = finish(second, folder.path(), "second").unwrap();
    assert_eq!(second.code, 2, "{}", second.err);
    one_line(&second, &format!("bundle` is being made by process {}", first.id()));
    let first = finish(first, folder.path(), "first").unwrap();
    assert_eq!(first.code, 0, "the first is not disturbed: {}", first.err);
    nothing_runs(folder.path());
}

#[test]
fn a_run_whose_folder_vanishes_says_so_once_and_ends() {
    let folder = tempfile::tempdir().unwrap();
    let (run, _) = begun(folder.path(), "1");
    // Somebody may write into it while it is emptied.
    assert!(poll(|| std::fs::remove_dir_all(folder.path().join("bundle")).is_ok().then_some(())).is_some());
    let ended = finish(run, folder.path(), "first").unwrap();
    assert_eq!(ended.code, 1, "{}", ended.err);
    one_line(&ended, "was removed while it was worked in");
    nothing_runs(folder.path());
}

/// Runs a request under a limit of the size of files, which shows a program the same as a disk without room.
fn cramped(folder: &Path, blocks: u32) -> Finished {
    std::fs::write(folder.join("full.toml"), WAREHOUSE).unwrap();
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" run full.toml --out full --author offline");
    let output = |ending: &str| std::fs::File::create(folder.join(format!("cramped.{ending}"))).unwrap();
    let run = Command::new("bash")
        .args(["-c", &script, PROGRAM])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(output("out"))
        .stderr(output("err"))
        .spawn()
        .unwrap();
    finish(run, folder, "cramped").unwrap()
}

#[test]
fn a_disk_that_takes_nothing_more_ends_the_run_with_one_line_and_it_is_resumed() {
    for blocks in [1, 100, 400] {
        let folder = tempfile::tempdir().unwrap();
        let ended = cramped(folder.path(), blocks);
        assert!(ended.code == 1 || ended.code == 2, "{blocks}: {}\n{}", ended.code, ended.err);
        one_line(&ended, "");
        assert!(!ended.err.contains("started again"), "{}", ended.err);
        nothing_runs(folder.path());
        let again =
            crate::socrates(folder.path(), "again", &["run", "full.toml", "--out", "full", "--author", "offline"]);
        assert_eq!(again.code, 0, "{}", again.err);
    }
}
