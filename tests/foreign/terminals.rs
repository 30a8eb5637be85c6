//! What a terminal shows.

use std::path::Path;
use std::process::{Command, Stdio};

use socrates_tests::skip;

use crate::{PROGRAM, WAREHOUSE, make, socrates};

/// What a terminal of its own, made by the program `script`, shows while a command runs there.
fn on_a_terminal(script: &Path, folder: &Path, words: &[&str]) -> String {
    on_a_terminal_of(80, script, folder, words)
}

/// The same on a terminal with so many columns.
fn on_a_terminal_of(columns: u32, script: &Path, folder: &Path, words: &[&str]) -> String {
    let line: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    let mut script = Command::new(script);
    script.args(["-qec", &format!("stty cols {columns} rows 24; {PROGRAM} {}", line.join(" ")), "/dev/null"]);
    let out = script.current_dir(folder).env("TERM", "xterm").stdin(Stdio::null()).output().unwrap();
    String::from_utf8_lossy(&out.stdout).into_owned()
}

#[test]
fn what_takes_time_shows_a_bar_on_a_terminal_and_leaves_nothing_of_it() {
    let script = skip::program("script").ok_or_else(|| "there is no program `script` that makes a terminal".to_owned());
    let Some(script) = skip::installed(script) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = make(folder.path(), "shown", WAREHOUSE, &["--require", "any", "--variants", "2", "--repeats"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let film = ["video", "bundle-shown/shown-1-00001", "--out", "film.gif", "--size", "320x180"];
    for (words, bar, last) in [
        (film.as_slice(), "filming", "wrote      film.gif"),
        (["report", "bundle-shown"].as_slice(), "reading", "look       bundle-shown/report.html"),
        (["scenarios", "rate", "a", "--seeds", "2"].as_slice(), "playing", "pooled "),
    ] {
        let shown = on_a_terminal(&script, folder.path(), words);
        assert!(shown.contains(&format!("{bar:<10} [")) && shown.contains(last), "{words:?}: {shown:?}");
        let plain = socrates(folder.path(), "plain", words);
        assert!(!plain.err.contains(bar) && !plain.out.contains(bar), "{words:?}: {}", plain.err);
    }
}

/// Lines that the next one replaces: what stands between the sign that empties a line and the next one, without what ends a line.
fn passing(shown: &str) -> Vec<&str> {
    let parts = shown.split("\x1b[2K").skip(1).filter(|part| !part.contains('\n'));
    parts
        .map(|part| part.split(['\r', '\x1b']).next().unwrap_or_default().trim_end())
        .filter(|it| !it.is_empty())
        .collect()
}

#[test]
fn a_line_that_the_next_one_replaces_stays_one_line_on_a_narrow_terminal() {
    let script = skip::program("script").ok_or_else(|| "there is no program `script` that makes a terminal".to_owned());
    let Some(script) = skip::installed(script) else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wide.toml"), WAREHOUSE).unwrap();
    for (columns, out) in [(40, "narrow"), (20, "narrowest")] {
        let words = ["run", "wide.toml", "--out", out, "--require", "any"];
        let shown = on_a_terminal_of(columns, &script, folder.path(), &words);
        let passing = passing(&shown);
        assert!(!passing.is_empty(), "nothing passes: {shown:?}");
        for line in passing {
            assert!(line.chars().count() <= columns as usize, "`{line}` is wider than {columns} columns");
        }
    }
}
