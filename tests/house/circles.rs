//! Circles: modules of a room that name each other around a ring, so that none of them is read or changed alone.
//!
//! Looked at are the modules right below a room's root, each with its submodules, and what stands in the root itself. A module is
//! named by its path or by the name under which the root hands one of its items on. What only tests name does not count.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::modules::{EVERYTHING, Module, Named, program};

/// Rooms whose modules stand in an order. In the rooms that are missing here some modules still name each other around a ring.
const ROOMS: &[&str] = &[
    "bus/stream",
    "maps/edit",
    "prompts/offline",
    "prompts/reader",
    "workers/authoring",
    "workers/gateway",
    "workers/scoring/stats",
    "workers/simulation",
    "workers/simulation/planners",
    "orchestrator/app",
    "orchestrator/cli",
    "orchestrator/experiment",
    "orchestrator/export",
];

/// What the root file is called where it stands beside its modules.
const ROOT: &str = "the root";

/// Arrows between modules, and where each stands: `file: path`.
type Arrows = BTreeMap<String, BTreeMap<String, String>>;

/// A path from the root of a room on; none where it leaves the room or stays within the module that names it.
fn from_root(at: &[String], parts: &[String]) -> Option<Vec<String>> {
    let (first, rest) = parts.split_first()?;
    let mut place = match first.as_str() {
        "crate" => Vec::new(),
        "self" => at.to_vec(),
        "super" => at.split_last()?.1.to_vec(),
        // What has no such word before it is a submodule or a library.
        _ if at.is_empty() => return Some(parts.to_vec()),
        _ => return None,
    };
    let ups = rest.iter().take_while(|part| *part == "super").count();
    place.truncate(place.len().checked_sub(ups)?);
    place.extend(rest.iter().skip(ups).cloned());
    Some(place)
}

/// The arrows between the modules of a room.
fn arrows(modules: &[Module]) -> Arrows {
    let mut tops: BTreeSet<String> = BTreeSet::new();
    for module in modules {
        let inline = module.names.all().map(|named| [&module.path[..], &named.inside[..]].concat());
        tops.extend(inline.chain([module.path.clone()]).filter_map(|path| path.first().cloned()));
    }
    let roots: Vec<&Module> = modules.iter().filter(|module| module.path.is_empty()).collect();
    let handed_on = || roots.iter().flat_map(|root| &root.names.uses).filter(|used| used.what.inside.is_empty());
    // Modules that a path leads to; through a name that the root has from elsewhere, to where it is from.
    let target = |at: &[String], named: &Named| -> Vec<String> {
        let Some(path) = from_root(at, &named.parts) else { return Vec::new() };
        let Some(first) = path.first() else { return Vec::new() };
        if tops.contains(first) {
            return vec![first.clone()];
        }
        let from: Vec<String> = handed_on()
            .filter(|used| used.name == *first || used.name == EVERYTHING)
            .filter_map(|used| from_root(&[], &used.what.parts)?.first().cloned())
            .filter(|top| tops.contains(top))
            .collect();
        // In the root itself any other name is one of its own, or a library.
        if from.is_empty() && !at.is_empty() { vec![ROOT.to_owned()] } else { from }
    };
    let mut arrows = Arrows::new();
    for module in modules {
        let own = module.names.paths.iter();
        // What the root hands on it does not need itself.
        let uses = module.names.uses.iter().filter(|used| !(module.path.is_empty() && used.handed_on));
        for named in own.chain(uses.map(|used| &used.what)) {
            let at = [&module.path[..], &named.inside[..]].concat();
            let from = at.first().map_or(ROOT, String::as_str);
            for to in target(&at, named) {
                if to != from {
                    let place = format!("{}: {}", module.file, named.parts.join("::"));
                    arrows.entry(from.to_owned()).or_default().entry(to).or_insert(place);
                }
            }
        }
    }
    arrows
}

/// The shortest way from a module back to itself.
fn way_back(arrows: &Arrows, from: &str) -> Option<Vec<String>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut waiting = VecDeque::from([from]);
    while let Some(here) = waiting.pop_front() {
        for to in arrows.get(here).into_iter().flat_map(BTreeMap::keys) {
            if to == from {
                let mut way = vec![from.to_owned(), here.to_owned()];
                let mut last = here;
                while last != from {
                    last = before[last];
                    way.push(last.to_owned());
                }
                way.reverse();
                return Some(way);
            }
            if !before.contains_key(to.as_str()) {
                before.insert(to, here);
                waiting.push_back(to);
            }
        }
    }
    None
}

/// The shortest circle, an arrow a line; none where there is no circle.
fn circle(arrows: &Arrows) -> Option<String> {
    let way = arrows.keys().filter_map(|from| way_back(arrows, from)).min_by_key(Vec::len)?;
    let arrow = |pair: &[String]| format!("  {} names {} ({})", pair[0], pair[1], arrows[&pair[0]][&pair[1]]);
    Some(way.windows(2).map(arrow).collect::<Vec<_>>().join("\n"))
}

#[test]
fn modules_of_these_rooms_name_each_other_around_no_ring() {
    let mut told = Vec::new();
    for room in ROOMS {
        told.extend(circle(&arrows(&program(room))).map(|circle| format!("{room}:\n{circle}")));
    }
    assert!(told.is_empty(), "modules name each other around a ring; move what both need:\n{}", told.join("\n"));
}

#[test]
fn the_arrows_of_the_command_line_are_seen() {
    let arrows = arrows(&program("orchestrator/app"));
    for (from, to) in [("run", "session"), ("session", "bundler"), ("bundler", "bundle"), ("bundle", "prepare")] {
        assert!(arrows[from].contains_key(to), "{from} names {to}");
    }
    let count: usize = arrows.values().map(BTreeMap::len).sum();
    assert!(count > 250, "{count} arrows");
}

/// The circle of made-up modules, each a path and a text.
fn circle_of(modules: &[(&[&str], &str)]) -> Option<String> {
    let file = |path: &[&str]| format!("{}.rs", if path.is_empty() { "lib".to_owned() } else { path.join("/") });
    let modules: Vec<Module> = modules.iter().map(|(path, text)| Module::of(path, &file(path), text)).collect();
    circle(&arrows(&modules))
}

#[test]
fn a_circle_is_found_however_its_arrows_are_written() {
    let lib = "mod a; mod b; mod c;";
    let around = [
        ("use crate::b::B;", "use crate::{c, d::E};", "fn f() { crate::a::g(); }"),
        ("use super::b;", "fn f() -> super::c::C { g() }", "use super::{a::A as B};"),
        ("use crate::b::*;", "fn f() { println!(\"{}\", crate::c::g()); }", "#[serde(with = \"crate::a\")] struct S;"),
        ("mod inner { use super::super::b::B; }", "use crate::c::C;", "impl crate::a::A for C {}"),
    ];
    for (a, b, c) in around {
        let modules: [(&[&str], &str); 4] = [(&[], lib), (&["a"], a), (&["b"], b), (&["c"], c)];
        let told = circle_of(&modules).unwrap_or_else(|| panic!("no circle in {a} {b} {c}"));
        for words in ["a names b (a.rs: ", "b names c (b.rs: ", "c names a (c.rs: "] {
            assert!(told.contains(words), "{words}: {told}");
        }
    }
}

#[test]
fn a_circle_is_found_through_a_submodule_and_through_the_root() {
    let below: [(&[&str], &str); 4] = [
        (&[], "mod a; mod b;"),
        (&["a"], "mod below; use self::below::X;"),
        (&["a", "below"], "use super::super::b::B;"),
        (&["b"], "use crate::a::A;"),
    ];
    assert_eq!(
        circle_of(&below).unwrap(),
        "  a names b (a/below.rs: super::super::b::B)\n  b names a (b.rs: crate::a::A)"
    );
    let handed_on: [(&[&str], &str); 3] = [
        (&[], "mod a; mod b; pub use a::A as Renamed; pub use self::b::B;"),
        (&["a"], "use crate::B;"),
        (&["b"], "use crate::Renamed;"),
    ];
    assert_eq!(circle_of(&handed_on).unwrap(), "  a names b (a.rs: crate::B)\n  b names a (b.rs: crate::Renamed)");
    let item: [(&[&str], &str); 2] = [(&[], "mod a; fn f() { a::g(); }"), (&["a"], "use crate::f;")];
    assert_eq!(circle_of(&item).unwrap(), "  a names the root (a.rs: crate::f)\n  the root names a (lib.rs: a::g)");
}

#[test]
fn an_order_a_submodule_with_its_parent_and_what_tests_name_are_no_circle() {
    let modules: [(&[&str], &str); 5] = [
        (&[], "mod a; mod b; mod c; pub use a::A; use std::fmt;"),
        (&["a"], "mod below; use crate::b::B; use self::below::X; pub(crate) use below::Y;"),
        (&["a", "below"], "use super::Z; use crate::c::C; pub(super) fn f() {}"),
        (&["b"], "use crate::c; #[cfg(test)] mod tests { use crate::a::A; } fn g() { h(\"crate::a\") }"),
        (&["c"], "/// Of crate::a::A.\nuse other::a::A; #[cfg(test)] use crate::b;"),
    ];
    assert_eq!(circle_of(&modules), None);
}
