//! Text is for people: nothing is read back out of it. Facts that a program decides by have a type of their own.
//!
//! The sources are parsed, and two things are looked for outside of tests:
//! - text for people (a message, the place of a fault, a verdict's words, what an error prints) that is split, searched or
//!   compared, directly or through a local name;
//! - a text field of a public type that is split, or compared with a text that stands in the program.
//!
//! Not seen: a text that is handed to a function which splits it, and a comparison through a local name.
#![expect(clippy::wildcard_enum_match_arm, reason = "expressions and items are open lists; a few of them hold text")]

use std::collections::BTreeSet;
use std::path::Path;

use syn::visit::{self, Visit};
use syn::{
    Attribute, Expr, Fields, ImplItemConst, ImplItemFn, Item, ItemConst, ItemFn, ItemMod, Local, Member, Pat, Type,
    Visibility,
};

use crate::{files, shown};

/// Fields of public types whose text is for people.
const FOR_PEOPLE: &[&str] = &["message", "verdict_text", "robot_text", "evidence", "remark", "notes", "hint", "causes"];
/// Places of faults: for people once they are printed.
const PLACES: &[&str] = &["at"];
/// What names of errors are called where they are caught.
const ERRORS: &[&str] = &["why", "error", "err", "fault", "bad", "broken"];

/// Methods that read a text.
const READS: &[&str] = &[
    "contains",
    "starts_with",
    "ends_with",
    "find",
    "rfind",
    "matches",
    "match_indices",
    "eq_ignore_ascii_case",
    "parse",
    "split",
    "splitn",
    "rsplit",
    "rsplitn",
    "split_once",
    "rsplit_once",
    "split_whitespace",
    "split_at",
    "strip_prefix",
    "strip_suffix",
    "trim_start_matches",
    "trim_end_matches",
    "split_terminator",
    "split_inclusive",
];
/// Those of them that take a text apart.
const SPLITS: &[&str] = &[
    "split",
    "splitn",
    "rsplit",
    "rsplitn",
    "split_once",
    "rsplit_once",
    "split_whitespace",
    "strip_prefix",
    "strip_suffix",
    "split_terminator",
    "split_inclusive",
];
/// Methods whose text is still the same text.
const SAME: &[&str] = &[
    "as_str",
    "as_ref",
    "clone",
    "to_owned",
    "to_lowercase",
    "to_uppercase",
    "trim",
    "trim_end",
    "trim_start",
    "into",
    "iter",
    "first",
    "last",
    "unwrap_or_default",
    "replace",
    "chars",
    "bytes",
    "as_deref",
    "shortened",
];

/// `(file, what is read there, why it may be)`.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    (
        "workers/author/src/stated.rs",
        "fact .split",
        "an account names lines of a scenario by their paths, such as `human_1.does.2`",
    ),
    ("orchestrator/app/src/explain.rs", "about .split_inclusive", "lays the words of a page out in lines"),
    ("orchestrator/study/src/kit/legend.rs", "instructions .split", "lays an author's text out in paragraphs"),
    (
        "bus/stream/src/ros/schema.rs",
        "kind .split_once",
        "the door itself: a type as a definition of messages writes it",
    ),
    ("bus/stream/src/ros/tracks.rs", "name .split", "the door itself: the parts of a topic's name, as a bag writes it"),
    ("bus/link/src/envelope.rs", "kind ==", "the door itself: of which kind the message is that its bytes hold"),
    ("prompts/llm/src/wire/anthropic.rs", "kind ==", "the door itself: of which kind a block of a server's answer is"),
    (
        "workers/scoring/src/fidelity/setting.rs",
        "role ==",
        "the role that the engine gives to people who walk as recorded",
    ),
    ("workers/simulation/hunav/src/run/prepare.rs", "file .rsplit", "the name of a file becomes that of a run"),
];

/// A reading of text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Reading {
    /// Function in which it stands.
    within: String,
    what: String,
}

/// Names of the text fields of public types.
fn text_fields(item: &Item, out: &mut BTreeSet<String>) {
    let fields = |fields: &Fields, out: &mut BTreeSet<String>| {
        for field in fields.iter().filter(|field| matches!(field.vis, Visibility::Public(_))) {
            if let (Some(name), Type::Path(path)) = (&field.ident, &field.ty)
                && path.path.is_ident("String")
            {
                out.insert(name.to_string());
            }
        }
    };
    match item {
        Item::Struct(item) if matches!(item.vis, Visibility::Public(_)) => fields(&item.fields, out),
        Item::Mod(item) if !is_test(&item.attrs) => {
            item.content.iter().flat_map(|(_, items)| items).for_each(|item| text_fields(item, out));
        }
        _ => {}
    }
}

/// `#[cfg(test)]` and the like.
fn is_test(attrs: &[Attribute]) -> bool {
    attrs.iter().any(|attr| {
        attr.path().is_ident("test")
            || attr.path().segments.last().is_some_and(|last| last.ident == "test")
            || attr.path().is_ident("cfg") && attr.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

/// Names of the constants of a file that are texts.
#[derive(Default)]
struct Texts(BTreeSet<String>);

impl Texts {
    fn add(&mut self, name: &syn::Ident, of: &Type) {
        let Type::Reference(of) = of else { return };
        if matches!(&*of.elem, Type::Path(path) if path.path.is_ident("str")) {
            self.0.insert(name.to_string());
        }
    }
}

impl<'ast> Visit<'ast> for Texts {
    fn visit_item_const(&mut self, item: &'ast ItemConst) {
        self.add(&item.ident, &item.ty);
    }

    fn visit_impl_item_const(&mut self, item: &'ast ImplItemConst) {
        self.add(&item.ident, &item.ty);
    }
}

struct Reader<'a> {
    /// Text fields of public types; nothing is looked for in them where there are none.
    fields: &'a BTreeSet<String>,
    /// Constants that are texts.
    texts: &'a Texts,
    /// Names of this function that hold text for people.
    known: Vec<String>,
    within: String,
    found: Vec<Reading>,
}

impl Reader<'_> {
    /// The field or name that holds the text for people which an expression gives.
    fn shows(&self, expr: &Expr) -> Option<String> {
        match expr {
            Expr::Field(field) => match &field.member {
                Member::Named(name) if FOR_PEOPLE.iter().any(|known| name == known) => Some(name.to_string()),
                Member::Named(_) | Member::Unnamed(_) => None,
            },
            Expr::MethodCall(call) => {
                let method = call.method.to_string();
                let receiver = bare(&call.receiver);
                if method == "to_string" {
                    return self.shows(receiver).or_else(|| printed(receiver));
                }
                if method == "message" && call.args.is_empty() {
                    return name_of(receiver)
                        .filter(|name| ERRORS.contains(&name.as_str()))
                        .map(|name| name + ".message()");
                }
                SAME.contains(&method.as_str()).then(|| self.shows(receiver)).flatten()
            }
            Expr::Path(_) => name_of(expr).filter(|name| self.known.contains(name)),
            Expr::Reference(inner) => self.shows(&inner.expr),
            Expr::Paren(inner) => self.shows(&inner.expr),
            Expr::Index(inner) => self.shows(&inner.expr),
            Expr::Try(inner) => self.shows(&inner.expr),
            _ => None,
        }
    }

    /// The text field of a public type that an expression is, as it stands or as a `str`.
    fn field_of(&self, expr: &Expr) -> Option<String> {
        match bare(expr) {
            Expr::Field(field) => match &field.member {
                Member::Named(name) => Some(name.to_string()).filter(|name| self.fields.contains(name)),
                Member::Unnamed(_) => None,
            },
            Expr::MethodCall(call) if SAME.contains(&call.method.to_string().as_str()) => self.field_of(&call.receiver),
            _ => None,
        }
    }

    /// Whether an expression is a text that stands in the program.
    fn is_text(&self, expr: &Expr) -> bool {
        match bare(expr) {
            Expr::Lit(lit) => matches!(lit.lit, syn::Lit::Str(_)),
            Expr::Path(path) => {
                path.path.segments.last().is_some_and(|last| self.texts.0.contains(&last.ident.to_string()))
            }
            _ => false,
        }
    }

    fn add(&mut self, what: String) {
        self.found.push(Reading { within: self.within.clone(), what });
    }

    /// Looks into a function with names of its own.
    fn enter(&mut self, name: &syn::Ident, look: impl FnOnce(&mut Self)) {
        let outer = (std::mem::take(&mut self.known), std::mem::replace(&mut self.within, name.to_string()));
        look(self);
        (self.known, self.within) = outer;
    }
}

/// What `to_string` prints, where it is the place of a fault or an error.
fn printed(expr: &Expr) -> Option<String> {
    match expr {
        Expr::Field(field) => match &field.member {
            Member::Named(name) if PLACES.iter().any(|known| name == known) => Some(format!("{name}.to_string()")),
            Member::Named(_) | Member::Unnamed(_) => None,
        },
        _ => name_of(expr).filter(|name| ERRORS.contains(&name.as_str())).map(|name| name + ".to_string()"),
    }
}

fn bare(expr: &Expr) -> &Expr {
    match expr {
        Expr::Reference(inner) => bare(&inner.expr),
        Expr::Paren(inner) => bare(&inner.expr),
        other => other,
    }
}

/// Whether a pattern compares with a text that stands in the program.
fn is_text_pattern(pat: &Pat) -> bool {
    match pat {
        Pat::Lit(lit) => matches!(lit.lit, syn::Lit::Str(_)),
        Pat::Or(or) => or.cases.iter().any(is_text_pattern),
        Pat::Paren(inner) => is_text_pattern(&inner.pat),
        Pat::TupleStruct(parts) => parts.elems.iter().any(is_text_pattern),
        _ => false,
    }
}

fn name_of(expr: &Expr) -> Option<String> {
    match bare(expr) {
        Expr::Path(path) => path.path.get_ident().map(ToString::to_string),
        _ => None,
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        if !is_test(&item.attrs) {
            self.enter(&item.sig.ident, |inner| visit::visit_item_fn(inner, item));
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        if !is_test(&item.attrs) {
            self.enter(&item.sig.ident, |inner| visit::visit_impl_item_fn(inner, item));
        }
    }

    fn visit_local(&mut self, local: &'ast Local) {
        visit::visit_local(self, local);
        let name = match &local.pat {
            Pat::Ident(name) => name.ident.to_string(),
            _ => return,
        };
        let shows = local.init.as_ref().is_some_and(|init| self.shows(&init.expr).is_some());
        // A name that is given anew holds what it was given last.
        self.known.retain(|known| *known != name);
        if shows {
            self.known.push(name);
        }
    }

    fn visit_expr(&mut self, expr: &'ast Expr) {
        match expr {
            Expr::MethodCall(call) => {
                let (method, receiver) = (call.method.to_string(), bare(&call.receiver));
                let cut = |field: &str| SPLITS.contains(&method.as_str()) && self.fields.contains(field);
                if let Some(text) = self.shows(receiver).filter(|_| READS.contains(&method.as_str())) {
                    self.add(format!("{text} .{method}"));
                } else if let Expr::Field(field) = receiver
                    && let Member::Named(name) = &field.member
                    && cut(&name.to_string())
                {
                    self.add(format!("{name} .{method}"));
                }
            }
            Expr::Binary(both) if matches!(both.op, syn::BinOp::Eq(_) | syn::BinOp::Ne(_)) => {
                if let Some(text) = self.shows(&both.left).or_else(|| self.shows(&both.right)) {
                    self.add(format!("{text} =="));
                } else if let Some(name) = self
                    .field_of(&both.left)
                    .filter(|_| self.is_text(&both.right))
                    .or_else(|| self.field_of(&both.right).filter(|_| self.is_text(&both.left)))
                {
                    self.add(format!("{name} =="));
                }
            }
            Expr::Match(of) => {
                if let Some(text) = self
                    .shows(&of.expr)
                    .or_else(|| self.field_of(&of.expr).filter(|_| of.arms.iter().any(|arm| is_text_pattern(&arm.pat))))
                {
                    self.add(format!("{text} match"));
                }
            }
            _ => {}
        }
        visit::visit_expr(self, expr);
    }
}

fn readings(file: &syn::File, fields: &BTreeSet<String>, texts: &Texts) -> Vec<Reading> {
    let mut reader = Reader { fields, texts, known: Vec::new(), within: String::new(), found: Vec::new() };
    reader.visit_file(file);
    reader.found
}

fn is_code(name: &str) -> bool {
    let test_file = name.ends_with("tests.rs") || name.ends_with("_test.rs");
    !test_file
        && !["tests/", "/tests/", "/benches/", "/examples/"]
            .iter()
            .any(|part| name.starts_with(part) || name.contains(part))
}

fn parsed(path: &Path) -> syn::File {
    syn::parse_file(&std::fs::read_to_string(path).unwrap()).unwrap_or_else(|why| panic!("{}: {why}", shown(path)))
}

/// Modules that only tests have: `#[cfg(test)] mod name;`.
fn test_modules(file: &syn::File, path: &Path, out: &mut BTreeSet<String>) {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = path.parent().unwrap();
    let folder = if matches!(stem.as_str(), "lib" | "main" | "mod") { folder.to_owned() } else { folder.join(stem) };
    for item in &file.items {
        if let Item::Mod(item) = item
            && item.content.is_none()
            && is_test(&item.attrs)
        {
            out.insert(shown(&folder.join(format!("{}.rs", item.ident))));
        }
    }
}

#[test]
fn nothing_is_read_back_out_of_a_text_for_people() {
    let sources: Vec<_> = files(".rs").into_iter().filter(|path| is_code(&shown(path))).collect();
    let parsed: Vec<(String, syn::File)> = sources.iter().map(|path| (shown(path), parsed(path))).collect();
    let (mut fields, mut tests) = (BTreeSet::new(), BTreeSet::new());
    for ((name, file), path) in parsed.iter().zip(&sources) {
        // The reader of requests has its own words until it is replaced; of it only the texts of faults are looked at.
        if !name.starts_with("prompts/offline") {
            file.items.iter().for_each(|item| text_fields(item, &mut fields));
        }
        test_modules(file, path, &mut tests);
    }
    assert!(fields.contains("verdict_text") && fields.len() > 40, "{fields:?}");
    let none = BTreeSet::new();
    let mut texts = Texts::default();
    parsed.iter().for_each(|(_, file)| texts.visit_file(file));
    let mut found = Vec::new();
    let mut used = BTreeSet::new();
    for (name, file) in parsed.iter().filter(|(name, _)| !tests.contains(name)) {
        let own = name.starts_with("prompts/offline");
        for reading in readings(file, if own { &none } else { &fields }, &texts) {
            let excepted = EXCEPTIONS.iter().position(|(file, what, _)| *file == name && reading.what == *what);
            match excepted {
                Some(place) => {
                    used.insert(place);
                }
                None => found.push(format!("  {name} {}: {}", reading.within, reading.what)),
            }
        }
    }
    assert!(found.is_empty(), "facts are read out of texts for people; give them a type:\n{}", found.join("\n"));
    let stale: Vec<_> = EXCEPTIONS.iter().enumerate().filter(|(place, _)| !used.contains(place)).collect();
    assert!(stale.is_empty(), "exceptions that are not needed any more: {stale:#?}");
    assert!(EXCEPTIONS.iter().all(|(_, _, why)| why.len() > 15));
}

#[test]
fn a_line_that_reads_a_text_is_found_and_one_that_shows_it_is_not() {
    let fields = BTreeSet::from(["item".to_owned()]);
    let texts = Texts(BTreeSet::from(["WHOLE".to_owned()]));
    let what = |body: &str| -> Vec<String> {
        let file = syn::parse_file(&format!("fn f() {{ {body} }}")).unwrap();
        readings(&file, &fields, &texts).into_iter().map(|reading| reading.what).collect()
    };
    for (body, found) in [
        ("let wish = fault.message.to_string().split('`').nth(1);", "message .split"),
        (
            "let human = !faults.iter().any(|fault| fault.at.to_string().contains(\"human\"));",
            "at.to_string() .contains",
        ),
        (
            "let message = why.message().replace('\\n', \" \"); if message.contains(\"unknown field\") {}",
            "message .contains",
        ),
        (
            "let text = why.to_string(); let text = text.trim(); if text.starts_with(\"missing field\") {}",
            "text .starts_with",
        ),
        ("if report.verdict_text == \"realised\" {}", "verdict_text =="),
        ("match job.remark.as_str() { \"x\" => {} _ => {} }", "remark match"),
        ("let seed = run.item.rsplit_once('-');", "item .rsplit_once"),
        ("if run.item.as_str() != \"whole\" {}", "item =="),
        ("if WHOLE == run.item {}", "item =="),
        ("match run.item.as_str() { \"whole\" => {} _ => {} }", "item match"),
    ] {
        assert_eq!(what(body), [found], "{body}");
    }
    for body in [
        "println(&fault.message.to_string());",
        "let name = node.name.contains(\"x\");",
        "if fault.at == Where::key(\"task\") {}",
        "let text = why.to_string(); let text = read(file); text.contains(\"x\");",
        "let same = run.item == other.item;",
        "if run.item == LIMIT {}",
        "match run.item { Item::Whole => {} Item::Part => {} }",
    ] {
        assert_eq!(what(body), Vec::<String>::new(), "{body}");
    }
    let tests = "#[cfg(test)] mod tests { fn f() { fault.message.to_string().contains(\"x\"); } } #[test] fn t() { a.message.find('x'); }";
    assert_eq!(readings(&syn::parse_file(tests).unwrap(), &fields, &texts), []);
}
