//! Walls: who may name whom, and where each foreign library lives, as the two tables in ARCHITECTURE.md say.

use std::collections::{BTreeMap, BTreeSet};

use socrates_tests::root;

use super::{members, tables};

/// Heading over the table of rooms.
const ROOMS: &str = "## Walls";
/// Heading over the table of foreign libraries.
const LIBRARIES: &str = "## Foreign libraries";
/// Homes of a library that every room may name.
const ANYWHERE: &str = "anywhere";

/// Who names what: the program, or only tests, benches and builds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum For {
    Program,
    Tests,
}

/// What each room names, rooms by their folders.
type Named = BTreeMap<String, BTreeSet<(For, String)>>;

/// What one line of a manifest names, by which folder it lies in where it is a room.
fn named(manifest: &toml::Table, rooms: &BTreeMap<String, String>) -> BTreeSet<(For, String)> {
    let mut found = BTreeSet::new();
    let mut add = |table: Option<&toml::Value>, to: For| {
        let names = table.and_then(toml::Value::as_table).into_iter().flat_map(|table| table.keys());
        found.extend(names.map(|name| (to, rooms.get(name).unwrap_or(name).clone())));
    };
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let parts = targets.into_iter().flat_map(|targets| targets.values()).filter_map(toml::Value::as_table);
    for part in parts.chain([manifest]) {
        add(part.get("dependencies"), For::Program);
        add(part.get("dev-dependencies"), For::Tests);
        add(part.get("build-dependencies"), For::Tests);
    }
    // What the program names its tests name too.
    let whole: Vec<String> = found.iter().filter(|(to, _)| *to == For::Program).map(|(_, name)| name.clone()).collect();
    found.retain(|(to, name)| *to == For::Program || !whole.contains(name));
    found
}

/// What the manifests say, apart for rooms and for foreign libraries.
fn found() -> (Named, Named) {
    let members = members();
    let package = |manifest: &toml::Table| manifest["package"]["name"].as_str().unwrap().to_owned();
    let folders: BTreeMap<String, String> =
        members.iter().map(|(folder, manifest)| (package(manifest), folder.clone())).collect();
    let (mut rooms, mut libraries) = (Named::new(), Named::new());
    for (folder, manifest) in &members {
        let (inside, outside): (BTreeSet<_>, BTreeSet<_>) =
            named(manifest, &folders).into_iter().partition(|(_, name)| members.contains_key(name));
        rooms.insert(folder.clone(), inside);
        for (to, library) in outside {
            libraries.entry(library).or_default().insert((to, folder.clone()));
        }
    }
    (rooms, libraries)
}

/// What a table of three columns allows: a name, what the program may name, what only tests may.
fn allowed(document: &str, heading: &str) -> Named {
    let mut rows = Named::new();
    for row in tables::under(document, heading) {
        let mut cells = row.iter();
        let name = tables::names(cells.next().unwrap()).concat();
        let mut cell = |to: For| {
            let cell = cells.next().cloned().unwrap_or_default();
            let names = if cell == ANYWHERE { vec![cell] } else { tables::names(&cell) };
            names.into_iter().map(move |name| (to, name))
        };
        let both: BTreeSet<(For, String)> = cell(For::Program).chain(cell(For::Tests)).collect();
        assert!(rows.insert(name.clone(), both).is_none(), "{heading}: `{name}` has two rows");
    }
    assert!(!rows.is_empty(), "ARCHITECTURE.md has no table under `{heading}`");
    rows
}

/// The row as it would have to be.
fn row(name: &str, found: &BTreeSet<(For, String)>) -> String {
    let cell = |to: For| {
        let names: Vec<String> =
            found.iter().filter(|(of, _)| *of == to).map(|(_, name)| format!("`{name}`")).collect();
        names.join(" ")
    };
    format!("| `{name}` | {} | {} |", cell(For::Program), cell(For::Tests))
        .replace("|  |", "| |")
        .replace("|  |", "| |")
}

/// What a manifest names that its row does not, and what a row names that no manifest does; `word` says what is named.
fn broken(rows: &Named, found: &Named, word: &str) -> Vec<String> {
    let nothing = BTreeSet::new();
    let mut broken = Vec::new();
    for name in rows.keys().chain(found.keys()).collect::<BTreeSet<_>>() {
        let is = found.get(name).unwrap_or(&nothing);
        let Some(row_is) = rows.get(name) else {
            broken.push(format!("  `{name}` has no row: {}", row(name, is)));
            continue;
        };
        if !found.contains_key(name) {
            broken.push(format!("  `{name}` has a row and is gone"));
            continue;
        }
        if row_is.iter().any(|(_, other)| other == ANYWHERE) {
            continue;
        }
        let strangers = is.difference(row_is).map(|(to, other)| {
            let tests = if *to == For::Tests { " for its tests" } else { "" };
            format!("  `{name}` {word} `{other}`{tests}")
        });
        let unused = row_is.difference(is).map(|(_, other)| format!("  `{name}`: its row has `{other}` for nothing"));
        let wrong: Vec<String> = strangers.chain(unused).collect();
        if !wrong.is_empty() {
            broken.extend(wrong);
            broken.push(format!("    as it is: {}", row(name, is)));
        }
    }
    broken
}

fn architecture() -> String {
    std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap()
}

#[test]
fn every_room_names_what_its_row_allows_and_nothing_else() {
    let broken = broken(&allowed(&architecture(), ROOMS), &found().0, "names");
    assert!(broken.is_empty(), "walls of ARCHITECTURE.md, `{ROOMS}`, are broken:\n{}", broken.join("\n"));
}

#[test]
fn every_foreign_library_lives_where_its_row_says() {
    let broken = broken(&allowed(&architecture(), LIBRARIES), &found().1, "is named by");
    assert!(broken.is_empty(), "homes of ARCHITECTURE.md, `{LIBRARIES}`, are wrong:\n{}", broken.join("\n"));
}

#[test]
fn nothing_depends_on_the_command_line_and_on_the_tools_of_developers() {
    for (room, named) in found().0 {
        let last = named.iter().find(|(_, other)| matches!(other.as_str(), "orchestrator/cli" | "tests/dev"));
        assert_eq!(last, None, "{room} depends on it");
    }
}

#[test]
fn a_stranger_an_unused_word_and_a_missing_row_are_named() {
    let text = format!(
        "{ROOMS}\n\n| room | names | tests |\n|---|---|---|\n| `a` | `b` | |\n| `b` | `c` | `d` |\n| `e` | | |\n| `g` | {ANYWHERE} | |\n"
    );
    let of = |pairs: &[(For, &str)]| pairs.iter().map(|(to, name)| (*to, (*name).to_owned())).collect();
    let found = Named::from([
        ("a".to_owned(), of(&[(For::Program, "b"), (For::Program, "c")])),
        ("b".to_owned(), of(&[(For::Program, "d")])),
        ("f".to_owned(), of(&[(For::Tests, "a")])),
        ("g".to_owned(), of(&[(For::Program, "x")])),
    ]);
    let told = broken(&allowed(&text, ROOMS), &found, "names").join("\n");
    for words in [
        "`a` names `c`",
        "as it is: | `a` | `b` `c` | |",
        "`b` names `d`",
        "`b`: its row has `c` for nothing",
        "`e` has a row and is gone",
        "`f` has no row: | `f` | | `a` |",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert!(!told.contains("`g`"), "{told}");
    assert!(broken(&allowed(&text, ROOMS), &found, "names").len() == 8, "{told}");
}

#[test]
fn what_is_only_for_tests_or_one_target_is_seen() {
    let manifest: toml::Table = "[dependencies]\na = \"1\"\n[dev-dependencies]\na = \"1\"\nb = \"1\"\n[build-dependencies]\nc = \"1\"\n[target.'cfg(unix)'.dependencies]\nd = \"1\"\nroom = \"1\"\n".parse().unwrap();
    let named = named(&manifest, &BTreeMap::from([("room".to_owned(), "maps/room".to_owned())]));
    let told: Vec<String> = named.iter().map(|(to, name)| format!("{to:?} {name}")).collect();
    assert_eq!(told, ["Program a", "Program d", "Program maps/room", "Tests b", "Tests c"]);
}
