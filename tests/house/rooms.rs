//! Rooms and their sources: which room a file belongs to, and which lines, comments and strings are no tests.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use socrates_tests::root;

use super::lexer::{Kind, Token, test_modules, tokens};
use super::{files, members, shown};

/// A comment or a string, with the line where it begins.
#[derive(Debug, Clone)]
pub(crate) struct Prose {
    /// Line of the file, from 1.
    pub(crate) line: usize,
    /// Its text; consecutive lines of comments are one text.
    pub(crate) text: String,
    /// Whether it is a string of the program.
    pub(crate) message: bool,
}

/// A type or trait that a file defines outside of tests.
#[derive(Debug, Clone)]
pub(crate) struct Defined {
    /// Line of the file, from 1.
    pub(crate) line: usize,
    /// Its name.
    pub(crate) name: String,
}

/// A file of source.
#[derive(Debug)]
pub(crate) struct Source {
    /// Folder of its room.
    pub(crate) room: String,
    /// Path from the root of the repository.
    pub(crate) file: String,
    /// Lines of code outside of tests, benches and examples: neither blank nor comments.
    pub(crate) lines: usize,
    /// Comments, those of tests included, and the strings of the program.
    pub(crate) prose: Vec<Prose>,
    /// Types of the program.
    pub(crate) types: Vec<Defined>,
}

/// The room with the longest folder that holds this file.
fn room_of<'a>(rooms: impl Iterator<Item = &'a String>, file: &str) -> Option<&'a String> {
    rooms
        .filter(|room| file.strip_prefix(room.as_str()).is_some_and(|rest| rest.starts_with('/')))
        .max_by_key(|room| room.len())
}

/// Whether a file of a room is of its program: below `src`, or its build script.
fn is_program(room: &str, file: &str) -> bool {
    let inside = &file[room.len() + 1..];
    inside.starts_with("src/") || inside == "build.rs"
}

/// Lines, prose and types of one source; `program` says whether its code counts.
fn source(room: &str, file: &str, text: &str, tokens: &[Token<'_>], program: bool) -> Source {
    let (mut lines, mut prose, mut types) = (BTreeSet::new(), Vec::<Prose>::new(), Vec::new());
    let blank: Vec<bool> = text.lines().map(|line| line.trim().is_empty()).collect();
    // The line after the last comment, while a comment there goes on with it.
    let mut goes_on = 0;
    for (place, token) in tokens.iter().enumerate() {
        let counts = program && !token.tests;
        if token.kind != Kind::Comment && counts {
            lines.extend((token.line..=token.last).filter(|line| blank.get(line - 1) == Some(&false)));
        }
        match token.kind {
            Kind::Comment => match prose.last_mut().filter(|_| goes_on == token.line) {
                Some(before) => before.text = format!("{}\n{}", before.text, token.text),
                None => prose.push(Prose { line: token.line, text: token.text.to_owned(), message: false }),
            },
            Kind::Text if counts => {
                prose.push(Prose { line: token.line, text: unescaped(token.text), message: true });
            }
            Kind::Word if counts && matches!(token.text, "struct" | "enum" | "trait") => {
                if let Some(next) = tokens.get(place + 1).filter(|next| next.kind == Kind::Word) {
                    types.push(Defined { line: next.line, name: next.text.to_owned() });
                }
            }
            Kind::Text | Kind::Word | Kind::Other | Kind::Sign(_) => {}
        }
        // A comment at the end of a line of code is one of its own.
        let alone = place == 0 || tokens[place - 1].last < token.line;
        goes_on = if token.kind == Kind::Comment && alone { token.last + 1 } else { 0 };
    }
    Source { room: room.to_owned(), file: file.to_owned(), lines: lines.len(), prose, types }
}

/// A literal with its escapes as spaces and line ends; the number of lines stays that of the source.
fn unescaped(text: &str) -> String {
    let (mut out, mut escaped) = (String::with_capacity(text.len()), false);
    for letter in text.chars() {
        if !escaped && letter == '\\' {
            escaped = true;
            continue;
        }
        match letter {
            letter if !escaped => out.push(letter),
            '\n' => out.push('\n'),
            // A line that begins within a text begins a sentence.
            'n' => out.push_str(". "),
            _ => out.push(' '),
        }
        escaped = false;
    }
    out
}

/// Every source of the workspace, read once.
pub(crate) fn sources() -> &'static [Source] {
    static SOURCES: OnceLock<Vec<Source>> = OnceLock::new();
    SOURCES.get_or_init(|| {
        let rooms = members();
        let paths = files(".rs");
        let texts: Vec<(String, String)> =
            paths.iter().map(|path| (shown(path), std::fs::read_to_string(path).unwrap())).collect();
        let parsed: Vec<(&str, &str, Vec<Token<'_>>)> =
            texts.iter().map(|(file, text)| (file.as_str(), text.as_str(), tokens(text))).collect();
        let tests: BTreeSet<String> =
            parsed.iter().flat_map(|(file, _, tokens)| only_for_tests(file, tokens)).collect();
        parsed
            .iter()
            .filter_map(|(file, text, tokens)| {
                let room = room_of(rooms.keys(), file)?;
                let of_tests =
                    Path::new(file).ancestors().any(|path| tests.contains(path.to_str().unwrap_or_default()));
                Some(source(room, file, text, tokens, is_program(room, file) && !of_tests))
            })
            .collect()
    })
}

/// Files and folders of the modules of a file that only tests have.
fn only_for_tests(file: &str, tokens: &[Token<'_>]) -> Vec<String> {
    let path = Path::new(file);
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let own: PathBuf = match path.file_stem().and_then(|stem| stem.to_str()) {
        Some("lib" | "main" | "mod") | None => folder.to_owned(),
        Some(stem) => folder.join(stem),
    };
    let mut found = Vec::new();
    for (name, at) in test_modules(tokens) {
        match at {
            Some(at) => found.push(folder.join(at)),
            None => found.extend([own.join(format!("{name}.rs")), own.join(name)]),
        }
    }
    found.iter().map(|path| path.display().to_string()).collect()
}

/// Whether this environment variable asks for a table to be written.
pub(crate) fn asked_to_write(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| value != "0")
}

/// A table of the house, by its file name in `tests/house`.
pub(crate) fn table(name: &str) -> (PathBuf, String) {
    let path = root().join("tests/house").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", shown(&path)));
    (path, text)
}

#[test]
fn lines_of_code_are_neither_blank_nor_comments_nor_tests() {
    let text = "//! page\n\nuse a::b; // why\n\n/// of c\nfn c() {\n    d(\"x\n\n y\");\n}\n\n#[cfg(test)]\nmod tests {\n    fn e() {}\n}\n";
    assert_eq!(source("r", "r/src/a.rs", text, &tokens(text), true).lines, 5);
    assert_eq!(source("r", "r/tests/a.rs", text, &tokens(text), false).lines, 0);
}

#[test]
fn comments_of_consecutive_lines_are_one_text_and_strings_of_tests_are_left_out() {
    let text =
        "/// One\n/// text.\nfn a() { b(\"two\\\n three\"); } // four\n// five\n#[test]\nfn c() { d(\"six\"); }\n";
    let found = source("r", "r/src/a.rs", text, &tokens(text), true).prose;
    let shown: Vec<(usize, &str)> = found.iter().map(|prose| (prose.line, prose.text.as_str())).collect();
    assert_eq!(shown, [(1, " One\n text."), (3, "two\n three"), (4, " four"), (5, " five")]);
}

#[test]
fn a_file_belongs_to_the_innermost_room() {
    let rooms = ["maps".to_owned(), "maps/draw".to_owned()];
    assert_eq!(room_of(rooms.iter(), "maps/draw/src/a.rs").map(String::as_str), Some("maps/draw"));
    assert_eq!(room_of(rooms.iter(), "maps/src/a.rs").map(String::as_str), Some("maps"));
    assert_eq!(room_of(rooms.iter(), "mapsy/src/a.rs"), None);
    assert!(is_program("maps", "maps/build.rs") && !is_program("maps", "maps/tests/it/a.rs"));
}
