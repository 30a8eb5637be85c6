//! The house rules, each as a test.
#![cfg(test)]

mod spelling;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socrates_tests::root;

/// `(room, strangers)`: no manifest of the room may name a stranger in its dependencies.
const WALLS: &[(&str, &[&str])] = &[
    ("bus/model", &["tokio", "zenoh", "iceoryx2", "reqwest", "rapier2d", "rusqlite", "rand_chacha", "socrates-"]),
    ("bus/checks", &["tokio", "zenoh", "socrates-link", "socrates-kit", "socrates-engine"]),
    ("maps", &["tokio", "zenoh", "socrates-draw", "socrates-link", "socrates-bt"]),
    ("maps/draw", &["tokio", "zenoh", "socrates-maps", "socrates-link"]),
    ("prompts", &["tokio", "zenoh", "reqwest", "socrates-llm", "socrates-offline", "socrates-author"]),
    ("prompts/llm", &["zenoh", "socrates-"]),
    ("prompts/offline", &["tokio", "zenoh", "reqwest", "socrates-llm", "socrates-author"]),
    ("workers/kit", &["zenoh", "iceoryx2", "socrates-orchestrator", "socrates-store", "socrates-stream"]),
    ("workers/desk", &["zenoh", "socrates-simulation", "socrates-scoring", "socrates-orchestrator", "socrates-store"]),
    (
        "workers/proposal",
        &[
            "zenoh",
            "socrates-paths",
            "socrates-behaviors",
            "socrates-simulation",
            "socrates-scoring",
            "socrates-orchestrator",
            "socrates-store",
        ],
    ),
    (
        "workers/paths",
        &[
            "zenoh",
            "socrates-proposal",
            "socrates-behaviors",
            "socrates-simulation",
            "socrates-scoring",
            "socrates-orchestrator",
            "socrates-store",
        ],
    ),
    (
        "workers/behaviors",
        &[
            "zenoh",
            "socrates-proposal",
            "socrates-paths",
            "socrates-simulation",
            "socrates-scoring",
            "socrates-orchestrator",
            "socrates-store",
        ],
    ),
    (
        "workers/behavior_tree",
        &["tokio", "zenoh", "rapier2d", "socrates-planners", "socrates-engine", "socrates-crowd"],
    ),
    (
        "workers/simulation",
        &["zenoh", "iceoryx2", "socrates-scoring", "socrates-orchestrator", "socrates-store", "socrates-author"],
    ),
    ("workers/simulation/crowd", &["tokio", "zenoh", "rapier2d", "socrates-"]),
    (
        "workers/simulation/engine",
        &["tokio", "zenoh", "iceoryx2", "socrates-planners", "socrates-stream", "socrates-kit", "socrates-link"],
    ),
    (
        "workers/simulation/hunav",
        &[
            "tokio",
            "zenoh",
            "iceoryx2",
            "rapier2d",
            "socrates-planners",
            "socrates-stream",
            "socrates-kit",
            "socrates-link",
        ],
    ),
    ("workers/simulation/planners", &["tokio", "zenoh", "rapier2d", "socrates-bt", "socrates-engine", "socrates-kit"]),
    (
        "workers/scoring",
        &[
            "zenoh",
            "iceoryx2",
            "socrates-simulation",
            "socrates-engine",
            "socrates-orchestrator",
            "socrates-store",
            "socrates-bt",
        ],
    ),
    ("orchestrator", &["tokio", "zenoh", "rusqlite", "socrates-link", "socrates-kit", "socrates-store"]),
    ("orchestrator/store", &["tokio", "zenoh", "socrates-link", "socrates-kit"]),
    ("orchestrator/export", &["tokio", "zenoh", "socrates-link", "socrates-kit", "socrates-store"]),
];

/// `(library, homes)`: a foreign library is named only by the manifests of its homes.
const HOMES: &[(&str, &[&str])] = &[
    ("zenoh", &["bus/link", "bus/stream"]),
    ("rmp-serde", &["bus/link", "bus/stream"]),
    ("iceoryx2", &["bus/stream"]),
    ("mcap", &["bus/stream"]),
    ("reqwest", &["prompts/llm"]),
    ("quick-xml", &["workers/behavior_tree"]),
    ("rapier2d", &["workers/simulation/engine"]),
    ("petgraph", &["bus/model", "orchestrator"]),
    ("resvg", &["maps/draw"]),
    ("krilla", &["maps/draw"]),
    ("krilla-svg", &["maps/draw"]),
    ("png", &["maps", "maps/draw"]),
    ("rusqlite", &["orchestrator/store"]),
    ("clap", &["orchestrator/cli"]),
    ("indicatif", &["orchestrator/cli"]),
    ("anyhow", &["orchestrator/cli"]),
];

/// Longest file of source, lines.
const FILE_CAP: usize = 600;

/// Every member of the workspace with its manifest.
fn members() -> BTreeMap<String, toml::Table> {
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    manifest["workspace"]["members"]
        .as_array()
        .unwrap()
        .iter()
        .map(|member| {
            let member = member.as_str().unwrap().to_owned();
            let text = std::fs::read_to_string(root().join(&member).join("Cargo.toml")).unwrap();
            (member, text.parse().unwrap())
        })
        .collect()
}

fn dependencies(manifest: &toml::Table) -> Vec<String> {
    let tables = ["dependencies", "build-dependencies"];
    tables.iter().filter_map(|name| manifest.get(*name)?.as_table()).flat_map(|table| table.keys().cloned()).collect()
}

/// Files under the root with this ending, without what is built.
fn files(ending: &str) -> Vec<PathBuf> {
    fn walk(dir: &Path, ending: &str, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                if !matches!(name.as_str(), "target" | ".git" | "runs" | ".socrates" | "node_modules") {
                    walk(&path, ending, found);
                }
            } else if name.ends_with(ending) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    walk(&root(), ending, &mut found);
    found.sort();
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

#[test]
fn no_room_names_a_stranger() {
    let members = members();
    let mut broken = Vec::new();
    for (room, strangers) in WALLS {
        let manifest = members.get(*room).unwrap_or_else(|| panic!("there is no room `{room}`"));
        for dependency in dependencies(manifest) {
            let allowed =
                dependency == "socrates-model" && *room != "bus/model" && !strangers.contains(&"socrates-model");
            if !allowed
                && strangers.iter().any(|stranger| {
                    dependency == *stranger || stranger.ends_with('-') && dependency.starts_with(stranger)
                })
            {
                broken.push(format!("  {room} names `{dependency}`"));
            }
        }
    }
    assert!(broken.is_empty(), "walls broken:\n{}", broken.join("\n"));
}

#[test]
fn each_foreign_library_has_its_home() {
    let mut broken = Vec::new();
    for (member, manifest) in members() {
        for dependency in dependencies(&manifest) {
            if let Some((_, homes)) = HOMES.iter().find(|(library, _)| *library == dependency)
                && !homes.contains(&member.as_str())
            {
                broken.push(format!("  {member} names `{dependency}`; its home is {}", homes.join(", ")));
            }
        }
    }
    assert!(broken.is_empty(), "strangers in the house:\n{}", broken.join("\n"));
}

#[test]
fn nothing_but_tests_depends_on_the_command_line() {
    for (member, manifest) in members() {
        assert!(!dependencies(&manifest).contains(&"socrates".to_owned()), "{member} depends on the command line");
    }
}

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
fn every_library_opens_with_a_page_and_a_never_list() {
    let mut thin = Vec::new();
    for member in members().keys() {
        let lib = root().join(member).join("src/lib.rs");
        let Ok(text) = std::fs::read_to_string(&lib) else { continue };
        let page: String = text.lines().take_while(|line| line.starts_with("//!")).collect::<Vec<_>>().join("\n");
        if !page.contains("```text") || !page.to_lowercase().contains("never") {
            thin.push(format!("  {}", shown(&lib)));
        }
    }
    assert!(thin.is_empty(), "front pages without a drawing or a never list:\n{}", thin.join("\n"));
}

#[test]
fn every_fault_has_a_page_and_every_page_a_fault() {
    let pages = root().join("bus/model/faults");
    let mut names: Vec<String> = std::fs::read_dir(pages)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().trim_end_matches(".md").to_owned())
        .collect();
    names.sort();
    let mut codes: Vec<String> = socrates_model::FaultCode::ALL.iter().map(|code| code.code().to_owned()).collect();
    codes.sort();
    assert_eq!(names, codes);
}

#[test]
fn links_and_paths_in_documents_lead_somewhere() {
    let mut dead = Vec::new();
    for document in files(".md") {
        let text = std::fs::read_to_string(&document).unwrap();
        let folder = document.parent().unwrap();
        for part in text.split("](").skip(1) {
            let target = part.split([')', '#', ' ']).next().unwrap_or_default();
            if target.is_empty() || target.contains("://") || target.starts_with('#') {
                continue;
            }
            if !folder.join(target).exists() {
                dead.push(format!("  {}: {target}", shown(&document)));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[test]
fn nothing_is_left_unfinished_or_allowed_away() {
    let marks = ["todo!(", "unimplemented!(", "dbg!(", "#[ignore", "#[allow("];
    let mut found = Vec::new();
    for path in files(".rs").iter().filter(|path| !path.ends_with("house/main.rs")) {
        for (number, line) in std::fs::read_to_string(path).unwrap().lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark)) {
                found.push(format!("  {}:{}: {}", shown(path), number + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "marks of unfinished work:\n{}", found.join("\n"));
}

#[test]
fn only_the_command_line_reads_the_environment_or_exits() {
    let marks = ["std::env::var", "std::env::args", "process::exit("];
    let mut found = Vec::new();
    for path in files(".rs") {
        let name = shown(&path);
        if name.starts_with("orchestrator/cli")
            || name.starts_with("tests/")
            || name.contains("/tests/")
            || name.contains("/benches/")
            || name.contains("/examples/")
        {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        // Tests beside the code may look for data files through the build's own variables.
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for mark in marks {
            if code.contains(mark) {
                found.push(format!("  {name}: {mark}"));
            }
        }
    }
    assert!(found.is_empty(), "environment or exit outside the command line:\n{}", found.join("\n"));
}

#[test]
fn pure_rooms_read_no_clock_and_draw_no_hidden_number() {
    let rooms = [
        "bus/model",
        "bus/checks",
        "workers/simulation/crowd",
        "workers/simulation/engine",
        "workers/simulation/planners",
        "workers/behavior_tree",
        "orchestrator/src",
    ];
    let marks = ["Instant::now", "SystemTime", "thread::sleep", "thread_rng", "rand::rng", "HashMap", "HashSet"];
    let mut found = Vec::new();
    for path in files(".rs") {
        let name = shown(&path);
        if !rooms.iter().any(|room| name.starts_with(room))
            || name.contains("/benches/")
            || name.contains("/tests/")
            || name.contains("/examples/")
        {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for mark in marks.iter().filter(|mark| code.contains(**mark)) {
            found.push(format!("  {name}: {mark}"));
        }
    }
    assert!(found.is_empty(), "clock, chance or unordered maps in pure rooms:\n{}", found.join("\n"));
}
