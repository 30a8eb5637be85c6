//! Purity: what a room may not name, read from its parsed modules. Items for tests, wherever they stand, are left out.

use super::members;
use super::modules::{Module, Named, program};

/// Rooms without clock, sleep, hidden chance, unordered collections, files and environment.
const PURE: &[&str] = &[
    "bus/model",
    "bus/checks",
    "maps/annotate",
    "maps/edit",
    "workers/simulation/crowd",
    "workers/simulation/engine",
    "workers/simulation/planners",
    "workers/behavior_tree",
    "orchestrator",
    "orchestrator/experiment",
    "orchestrator/study",
];

/// What they never name: parts of paths.
const IMPURE: &[&[&str]] = &[
    &["Instant"],
    &["SystemTime"],
    &["thread", "sleep"],
    &["time", "sleep"],
    &["thread_rng"],
    &["rand", "rng"],
    &["OsRng"],
    &["getrandom"],
    &["HashMap"],
    &["HashSet"],
    &["RandomState"],
    &["std", "fs"],
    &["std", "env"],
    &["std", "net"],
    &["std", "process"],
];

/// What nobody but the command line names: the surroundings of the process.
const SURROUNDINGS: &[&[&str]] = &[
    &["env", "var"],
    &["env", "var_os"],
    &["env", "vars"],
    &["env", "vars_os"],
    &["env", "args"],
    &["env", "args_os"],
    &["env", "current_exe"],
    &["env", "temp_dir"],
    &["process", "exit"],
];

/// What a module names of these.
fn found(module: &Module, forbidden: &[&[&str]]) -> Vec<String> {
    let holds = |named: &Named, name: &[&str]| named.parts.windows(name.len()).any(|part| part == name);
    let named = forbidden.iter().filter(|name| module.names.all().any(|path| holds(path, name)));
    named.map(|name| name.join("::")).collect()
}

/// What a room's program names of these, a line each, and how many files were read.
fn named_in(room: &str, forbidden: &[&[&str]], told: &mut Vec<String>) -> usize {
    let modules = program(room);
    for module in &modules {
        told.extend(found(module, forbidden).iter().map(|name| format!("  {}: {name}", module.file)));
    }
    modules.len()
}

#[test]
fn pure_rooms_have_no_clock_no_chance_no_unordered_map_and_no_files() {
    let (mut told, mut read) = (Vec::new(), 0);
    for room in PURE {
        read += named_in(room, IMPURE, &mut told);
    }
    assert!(told.is_empty(), "clock, chance, unordered maps or files in pure rooms:\n{}", told.join("\n"));
    assert!(read > 100, "{read} files are read");
}

#[test]
fn only_the_command_line_reads_the_environment_or_exits() {
    let mut told = Vec::new();
    for room in members().keys().filter(|room| !matches!(room.as_str(), "orchestrator/cli" | "tests" | "tests/dev")) {
        named_in(room, SURROUNDINGS, &mut told);
    }
    assert!(told.is_empty(), "environment or exit outside the command line:\n{}", told.join("\n"));
}

/// What of the impure is found in a text.
fn in_text(text: &str) -> Vec<String> {
    found(&Module::of(&["text"], "text.rs", text), IMPURE)
}

#[test]
fn a_forbidden_name_after_a_test_module_is_found() {
    let text = "#[cfg(test)]\nmod tests { fn a() {} }\nfn now() -> std::time::Instant { std::time::Instant::now() }\n";
    assert_eq!(in_text(text), ["Instant"]);
    assert_eq!(
        in_text("#[cfg(test)]\nmod tests;\nuse std::{fs as files, collections::{BTreeMap, HashMap}};"),
        ["HashMap", "std::fs"]
    );
    assert_eq!(in_text("fn a() { let b = vec![std::env::var(\"C\")]; }"), ["std::env"]);
    assert_eq!(in_text("#[cfg(not(test))]\nfn a() { std::thread::sleep(b()); }"), ["thread::sleep"]);
    for condition in ["any(unix, test)", "any(test, unix)", "not(all(unix, test))", "all(unix, any(unix, test))"] {
        let text = format!("#[cfg({condition})] fn a() {{ Instant::now(); }}");
        assert_eq!(in_text(&text), ["Instant"], "{condition}");
    }
    assert_eq!(in_text("struct S;\nimpl S { fn a(map: &HashSet<u8>) {} }"), ["HashSet"]);
}

#[test]
fn what_stands_in_tests_in_words_or_in_longer_names_is_not_found() {
    for text in [
        "#[cfg(test)]\nmod tests { use std::collections::HashMap; fn a() { std::fs::read(\"b\"); } }\nfn c() {}",
        "#[cfg(all(test, unix))]\nfn a() { std::env::var(\"B\"); }",
        "#[cfg(all(unix, all(feature = \"b\", test)))]\nfn a() { std::env::var(\"B\"); }",
        "struct S;\nimpl S { #[cfg(test)]\nfn a() { std::process::exit(1); } }",
        "#[test]\nfn a() { let _ = std::time::Instant::now(); }",
        "/// A HashMap of Instant, by std::fs.\nfn a() { b(\"std::env::var HashMap\"); }",
        "fn a(b: SimInstant) -> BTreeMap<u8, u8> { c(env!(\"CARGO_PKG_VERSION\")) }",
        "#![cfg(test)]\nuse std::fs;",
    ] {
        assert!(in_text(text).is_empty(), "{text}: {:?}", in_text(text));
    }
}
