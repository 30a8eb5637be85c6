//! The layout of a bundle: one list, `orchestrator/app/src/layout.rs`, from which all others take the paths of its files.

use super::members;
use super::modules::{Module, program};

/// The list.
const LIST: &str = "orchestrator/app/src/layout.rs";
/// Folder of a bundle, and what paths in it begin with.
const FOLDER: (&str, &str) = ("details", "details/");
/// Rooms that know what a bundle is; elsewhere the word alone may mean something else.
const OF_BUNDLES: &[&str] = &["orchestrator/app", "orchestrator/cli"];

/// Texts of a module that name the folder.
fn named(module: &Module, of_bundles: bool) -> Vec<&str> {
    let (folder, path) = FOLDER;
    let names = |text: &&str| text.contains(path) || of_bundles && *text == folder;
    module.names.texts.iter().map(String::as_str).filter(names).collect()
}

#[test]
fn paths_of_a_bundle_stand_in_its_layout_alone() {
    let (mut told, mut listed) = (Vec::new(), 0);
    for room in members().keys().filter(|room| *room != "tests") {
        let of_bundles = OF_BUNDLES.contains(&room.as_str());
        for module in program(room) {
            let found = named(&module, of_bundles);
            if module.file == LIST {
                listed = found.len();
            } else {
                told.extend(found.iter().map(|text| format!("  {}: \"{text}\"", module.file)));
            }
        }
    }
    assert!(told.is_empty(), "paths of a bundle beside {LIST}:\n{}", told.join("\n"));
    assert!(listed > 10, "{LIST} has {listed} paths");
}

#[test]
fn a_path_of_a_bundle_is_found_in_a_macro_and_not_in_a_comment_or_a_test() {
    let found = |text: &str| {
        let module = Module::of(&["m"], "m.rs", text);
        (named(&module, true).len(), named(&module, false).len())
    };
    assert_eq!(found("fn f() { g(\"details/paths.json\"); }"), (1, 1));
    assert_eq!(found("fn f() { format!(\"read `details/{role}.json`\"); }"), (1, 1));
    assert_eq!(found("const LAST: &str = \"details\";"), (1, 0));
    assert_eq!(
        found("/// `details/paths.json`\nfn f() { g(\"in details\"); } #[test] fn h() { g(\"details/\"); }"),
        (0, 0)
    );
}
