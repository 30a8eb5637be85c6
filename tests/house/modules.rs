//! The parsed modules of a room's program, with what each of them names and says. Items for tests, wherever they stand, are left out.

use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};
use socrates_tests::root;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, File, Item, ItemUse, LitStr, Macro, Meta, Token, UseTree, Visibility};

use super::shown;

/// What stands for everything at the end of a `use`.
pub(crate) const EVERYTHING: &str = "*";

/// A file of a room's program.
pub(crate) struct Module {
    /// Names of the modules down to this one; empty for the root file.
    pub(crate) path: Vec<String>,
    /// Its file, from the root of the repository.
    pub(crate) file: String,
    /// What it names.
    pub(crate) names: Names,
}

impl Module {
    /// The module that a text would be.
    pub(crate) fn of(path: &[&str], file: &str, text: &str) -> Self {
        let parsed = syn::parse_file(text).unwrap_or_else(|why| panic!("{file}: {why}"));
        let path = path.iter().map(|&name| name.to_owned()).collect();
        Self { path, file: file.to_owned(), names: Names::of(&parsed) }
    }
}

/// A path that is named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Named {
    /// Modules within the file in which it stands.
    pub(crate) inside: Vec<String>,
    /// Its parts.
    pub(crate) parts: Vec<String>,
}

/// What a `use` brings in.
pub(crate) struct Used {
    /// The name that it has from then on; [`EVERYTHING`] for all names of a module.
    pub(crate) name: String,
    /// What is brought in.
    pub(crate) what: Named,
    /// Whether it is only handed on to others.
    pub(crate) handed_on: bool,
}

/// What a parsed file names outside of its tests.
#[derive(Default)]
pub(crate) struct Names {
    /// Paths, but for those of a `use`.
    pub(crate) paths: Vec<Named>,
    /// What every `use` brings in.
    pub(crate) uses: Vec<Used>,
    /// Texts that stand in the program, comments left out.
    pub(crate) texts: Vec<String>,
    /// Modules in files of their own, with the path that an attribute gives.
    modules: Vec<(String, Option<String>)>,
    inside: Vec<String>,
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
    pub(crate) fn of(file: &File) -> Self {
        let mut names = Self::default();
        if !for_tests(&file.attrs) {
            names.visit_file(file);
        }
        names
    }

    /// Every path, those of a `use` among them.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Named> {
        self.paths.iter().chain(self.uses.iter().map(|used| &used.what))
    }

    fn named(&self, parts: Vec<String>) -> Named {
        Named { inside: self.inside.clone(), parts }
    }

    fn add(&mut self, parts: Vec<String>) {
        let named = self.named(parts);
        self.paths.push(named);
    }

    fn used(&mut self, before: &[String], tree: &UseTree, handed_on: bool) {
        let with = |name: &dyn ToString| [before, &[name.to_string()]].concat();
        let (name, parts) = match tree {
            UseTree::Path(path) => return self.used(&with(&path.ident), &path.tree, handed_on),
            UseTree::Group(group) => return group.items.iter().for_each(|tree| self.used(before, tree, handed_on)),
            UseTree::Name(name) if name.ident == "self" => {
                (before.last().cloned().unwrap_or_default(), before.to_vec())
            }
            UseTree::Name(name) => (name.ident.to_string(), with(&name.ident)),
            UseTree::Rename(name) => (name.rename.to_string(), with(&name.ident)),
            UseTree::Glob(_) => (EVERYTHING.to_owned(), with(&EVERYTHING)),
        };
        let what = self.named(parts);
        self.uses.push(Used { name, what, handed_on });
    }

    /// Paths and texts in tokens, which are no parsed code.
    fn tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons): (Vec<String>, usize) = (Vec::new(), 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.add(std::mem::take(&mut path));
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Literal(literal) => {
                    self.texts.extend(syn::parse_str::<LitStr>(&literal.to_string()).ok().map(|text| text.value()));
                    colons = 0;
                }
                TokenTree::Punct(_) => colons = 0,
            }
        }
        self.add(path);
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast Item) {
        if for_tests(attributes(item)) {
            return;
        }
        let Item::Mod(module) = item else { return visit::visit_item(self, item) };
        if module.content.is_some() {
            self.inside.push(module.ident.to_string());
            visit::visit_item(self, item);
            self.inside.pop();
            return;
        }
        let path = module.attrs.iter().find(|attribute| attribute.path().is_ident("path")).map(|attribute| {
            let text = attribute.meta.require_name_value().unwrap();
            let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &text.value else {
                panic!("a path of a module that is no text");
            };
            text.value()
        });
        self.modules.push((module.ident.to_string(), path));
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
        self.used(&[], &item.tree, !matches!(item.vis, Visibility::Inherited));
    }

    /// What an attribute names as a text, such as `with = "crate::digest"`, is a path; its other texts are comments.
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        let before = self.texts.len();
        visit::visit_attribute(self, attribute);
        if let Ok(list) = attribute.meta.require_list() {
            self.tokens(list.tokens.clone());
        }
        let paths = self.texts.split_off(before);
        let paths = paths.iter().filter(|text| text.starts_with("crate::") || text.starts_with("super::"));
        paths.for_each(|text| self.add(text.split("::").map(str::to_owned).collect()));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.add(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, of: &'ast Macro) {
        self.tokens(of.tokens.clone());
        visit::visit_macro(self, of);
    }

    fn visit_lit_str(&mut self, text: &'ast LitStr) {
        self.texts.push(text.value());
    }
}

/// The root file of a room.
fn entrance(room: &str) -> Option<PathBuf> {
    ["src/lib.rs", "src/main.rs"].into_iter().map(|file| root().join(room).join(file)).find(|file| file.is_file())
}

/// Every module of a room's program, from its root file on.
pub(crate) fn program(room: &str) -> Vec<Module> {
    let mut found = Vec::new();
    read(&entrance(room).unwrap_or_else(|| panic!("{room} has no program")), &[], &mut found);
    found
}

/// Reads the module in a file, then those that it declares.
fn read(file: &Path, path: &[&str], found: &mut Vec<Module>) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|why| panic!("{}: {why}", shown(file)));
    let module = Module::of(path, &shown(file), &text);
    let folder = file.parent().unwrap();
    let own = match file.file_stem().and_then(|stem| stem.to_str()) {
        Some("lib" | "main" | "mod") => folder.to_path_buf(),
        stem => folder.join(stem.unwrap()),
    };
    let declared = module.names.modules.clone();
    found.push(module);
    for (name, at) in &declared {
        let places = match at {
            Some(at) => vec![folder.join(at)],
            None => vec![own.join(format!("{name}.rs")), own.join(name).join("mod.rs")],
        };
        let place = places.into_iter().find(|place| place.is_file());
        let place = place.unwrap_or_else(|| panic!("{}: `{name}` has no file", shown(file)));
        read(&place, &[path, &[name.as_str()]].concat(), found);
    }
}

#[test]
fn paths_and_texts_of_the_program_are_told_and_those_of_tests_and_comments_are_not() {
    let text = "/// Of `a/b`.\nuse crate::a::{self, B as C};\nmod inner { fn f() { super::g(\"one\"); } }\n\
                fn h() { i!(\"two {}\", crate::j::K); }\n#[serde(with = \"crate::l\")]\nstruct M;\n\
                #[cfg(test)]\nmod tests { fn n() { crate::o::p(\"three\"); } }\n#[cfg(test)]\nmod q;\nmod r;";
    let names = Module::of(&["m"], "m.rs", text).names;
    assert_eq!(names.texts, ["one", "two {}"]);
    let told = |parts: &[&str]| names.all().any(|named| named.parts == parts);
    assert!(told(&["crate", "a"]) && told(&["crate", "a", "B"]) && told(&["crate", "j", "K"]) && told(&["crate", "l"]));
    assert!(!told(&["crate", "o", "p"]));
    let inner = names.paths.iter().find(|named| named.parts == ["super", "g"]).unwrap();
    assert_eq!(inner.inside, ["inner"]);
    let uses: Vec<&str> = names.uses.iter().map(|used| used.name.as_str()).collect();
    assert_eq!((uses, names.modules), (vec!["a", "C"], vec![("r".to_owned(), None)]));
}
