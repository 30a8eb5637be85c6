//! Purity: what a room may not name, read from its parsed modules. Items for tests, wherever they stand, are left out.

use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};
use socrates_tests::root;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, File, Item, ItemUse, Macro, Meta, Token, UseTree};

use super::{members, shown};

/// Rooms without clock, sleep, hidden chance, unordered collections, files and environment.
const PURE: &[&str] = &[
    "bus/model",
    "bus/checks",
    "workers/simulation/crowd",
    "workers/simulation/engine",
    "workers/simulation/planners",
    "workers/behavior_tree",
    "orchestrator",
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

/// Paths that a parsed file names outside of its tests, and the modules it declares in files of their own.
#[derive(Default)]
struct Names {
    paths: Vec<Vec<String>>,
    modules: Vec<(String, Option<String>)>,
}

/// Whether these attributes keep an item out of the program.
fn for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        if path.segments.last().is_some_and(|last| last.ident == "test") {
            return true;
        }
        path.is_ident("cfg") && attribute.parse_args::<Meta>().is_ok_and(|condition| in_tests_alone(&condition))
    })
}

/// Whether a condition holds in tests alone: `test`, or `all` of several of which one does.
fn in_tests_alone(condition: &Meta) -> bool {
    match condition {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("all") => list
            .parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated)
            .is_ok_and(|conditions| conditions.iter().any(in_tests_alone)),
        Meta::List(_) | Meta::NameValue(_) => false,
    }
}

#[expect(clippy::wildcard_enum_match_arm, reason = "the list of items is open; the others are read as they are")]
fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

impl Names {
    fn of(file: &File) -> Self {
        let mut names = Self::default();
        if !for_tests(&file.attrs) {
            names.visit_file(file);
        }
        names
    }

    fn used(&mut self, before: &[String], tree: &UseTree) {
        let with = |name: &dyn ToString| [before, &[name.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.used(&with(&path.ident), &path.tree),
            UseTree::Name(name) => self.paths.push(with(&name.ident)),
            UseTree::Rename(name) => self.paths.push(with(&name.ident)),
            UseTree::Glob(_) => self.paths.push(before.to_vec()),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.used(before, tree)),
        }
    }

    /// Paths in the tokens of a macro, which are no parsed code.
    fn tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons): (Vec<String>, usize) = (Vec::new(), 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.paths.push(std::mem::take(&mut path));
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Punct(_) | TokenTree::Literal(_) => colons = 0,
            }
        }
        self.paths.push(path);
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast Item) {
        if for_tests(attributes(item)) {
            return;
        }
        if let Item::Mod(module) = item
            && module.content.is_none()
        {
            let path = module.attrs.iter().find(|attribute| attribute.path().is_ident("path")).map(|attribute| {
                let text = attribute.meta.require_name_value().unwrap();
                let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &text.value else {
                    panic!("a path of a module that is no text");
                };
                text.value()
            });
            self.modules.push((module.ident.to_string(), path));
        }
        visit::visit_item(self, item);
    }

    #[expect(clippy::wildcard_enum_match_arm, reason = "the list of items is open; the others are read as they are")]
    fn visit_impl_item(&mut self, item: &'ast syn::ImplItem) {
        let tests = match item {
            syn::ImplItem::Fn(item) => for_tests(&item.attrs),
            syn::ImplItem::Const(item) => for_tests(&item.attrs),
            _ => false,
        };
        if !tests {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.used(&[], &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, of: &'ast Macro) {
        self.tokens(of.tokens.clone());
        visit::visit_macro(self, of);
    }
}

/// What of these names is among the paths.
fn found(paths: &[Vec<String>], forbidden: &[&[&str]]) -> Vec<String> {
    let holds = |path: &Vec<String>, name: &[&str]| path.windows(name.len()).any(|part| part == name);
    let named = forbidden.iter().filter(|name| paths.iter().any(|path| holds(path, name)));
    named.map(|name| name.join("::")).collect()
}

/// What a room names of these in its program: the parsed modules from this file on, those of tests left out.
fn named_from(file: &Path, forbidden: &[&[&str]], told: &mut Vec<String>) -> usize {
    let text = std::fs::read_to_string(file).unwrap_or_else(|why| panic!("{}: {why}", shown(file)));
    let names = Names::of(&syn::parse_file(&text).unwrap_or_else(|why| panic!("{}: {why}", shown(file))));
    told.extend(found(&names.paths, forbidden).iter().map(|name| format!("  {}: {name}", shown(file))));
    let folder = file.parent().unwrap();
    let own = match file.file_stem().and_then(|stem| stem.to_str()) {
        Some("lib" | "main" | "mod") => folder.to_path_buf(),
        stem => folder.join(stem.unwrap()),
    };
    let place = |(name, path): &(String, Option<String>)| -> PathBuf {
        let places = match path {
            Some(path) => vec![folder.join(path)],
            None => vec![own.join(format!("{name}.rs")), own.join(name).join("mod.rs")],
        };
        let found = places.into_iter().find(|place| place.is_file());
        found.unwrap_or_else(|| panic!("{}: `{name}` has no file", shown(file)))
    };
    1 + names.modules.iter().map(|module| named_from(&place(module), forbidden, told)).sum::<usize>()
}

/// The root file of a room.
fn entrance(room: &str) -> Option<PathBuf> {
    ["src/lib.rs", "src/main.rs"].into_iter().map(|file| root().join(room).join(file)).find(|file| file.is_file())
}

#[test]
fn pure_rooms_have_no_clock_no_chance_no_unordered_map_and_no_files() {
    let (mut told, mut read) = (Vec::new(), 0);
    for room in PURE {
        read += named_from(&entrance(room).unwrap(), IMPURE, &mut told);
    }
    assert!(told.is_empty(), "clock, chance, unordered maps or files in pure rooms:\n{}", told.join("\n"));
    assert!(read > 100, "{read} files are read");
}

#[test]
fn only_the_command_line_reads_the_environment_or_exits() {
    let mut told = Vec::new();
    for room in members().keys().filter(|room| !matches!(room.as_str(), "orchestrator/cli" | "tests")) {
        named_from(&entrance(room).unwrap(), SURROUNDINGS, &mut told);
    }
    assert!(told.is_empty(), "environment or exit outside the command line:\n{}", told.join("\n"));
}

/// What of the impure is found in a text.
fn in_text(text: &str) -> Vec<String> {
    found(&Names::of(&syn::parse_file(text).unwrap()).paths, IMPURE)
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
