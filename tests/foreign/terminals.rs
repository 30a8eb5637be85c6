//! What a terminal shows.

use std::path::Path;
use std::process::{Command, Stdio};

use socrates_tests::skip;

use crate::{PROGRAM, WAREHOUSE, make, socrates};

/// What a terminal of its own, made by the program `script`, shows while a command runs there.
fn on_a_terminal(script: &Path, folder: &Path, words: &[&str]) -> String {
    let line: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    let mut script = Command::new(script);
    script.args(["-qec", &format!("{PROGRAM} {}", line.join(" ")), "/dev/null"]);
    let out = script.current_dir(folder).env("TERM", "xterm").stdin(Stdio::null()).output().unwrap();
    String::from_utf8_lossy(&out.stdout).into_owned()
}

#[test]
fn what_takes_time_shows_a_bar_on_a_terminal_and_leaves_nothing_of_it() {
    let script = skip::program("script").ok_or_else(|| "there is no program `script` that makes a terminal".to_owned());
    let Some(script) = skip::installed(script) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = make(folder.path(), "shown", WAREHOUSE, &["--require", "any", "--variants", "2"]);
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
