//! Plain English, counted per room against ceilings that only go down: `english.toml` beside this file.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::members;
use super::rooms::{Prose, Source, asked_to_write, sources, table};

/// The table.
const TABLE: &str = "english.toml";
/// Environment variable that lowers the table.
const WRITE: &str = "SOCRATES_WRITE_ENGLISH";
/// Number of places that a failure names per room and rule.
const SHOWN: usize = 20;
/// Fewest words of a string that is a message.
const MESSAGE: usize = 3;
/// Words that no sentence begins with, in small letters.
const BEGINNINGS: &[&str] = &["who", "whoever", "whom", "what"];
/// Words that follow "so" in a phrase to avoid.
const AFTER_SO: &[&str] = &["many", "far"];
/// Words to avoid, in small letters.
const WORDS: &[&str] = &["somebody", "nobody", "anew", "told"];

/// A rule, in the order of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    Begins,
    So,
    Words,
    Types,
}

impl Rule {
    const ALL: [Self; 4] = [Self::Begins, Self::So, Self::Words, Self::Types];

    /// Its column in the table.
    const fn column(self) -> &'static str {
        match self {
            Self::Begins => "begins",
            Self::So => "so",
            Self::Words => "words",
            Self::Types => "types",
        }
    }

    /// The rule in words.
    const fn text(self) -> &'static str {
        match self {
            Self::Begins => {
                "no sentence begins with Who, Whoever, Whom, What, So many or So far: use a noun phrase or an imperative"
            }
            Self::So => "no \"so many\" or \"so far\": name the quantity and its unit",
            Self::Words => {
                "no \"somebody\", \"nobody\", \"anew\", \"told\", \"reckon…\" or \"of before\": use the plain word"
            }
            Self::Types => "a type has a name of its own in the workspace: rename it by its one idea",
        }
    }
}

/// Counts of a room, by rule.
type Counts = BTreeMap<Rule, usize>;

/// An offending place.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    rule: Rule,
    file: String,
    line: usize,
    what: String,
}

/// A word of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Spoken {
    /// The word in small letters.
    word: String,
    /// Whether it is written with a capital.
    capital: bool,
    /// Whether it begins the text.
    first: bool,
    /// Whether it begins a sentence.
    begins: bool,
    line: usize,
}

/// A text without what stands in backticks, fences or braces; lines stay where they are.
fn plain(text: &str) -> String {
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(['`', '{']) {
        out.push_str(&rest[..at]);
        let mark = if rest[at..].starts_with("```") { "```" } else { &rest[at..=at] };
        let close = if mark == "{" { "}" } else { mark };
        let inside = &rest[at + mark.len()..];
        let Some(end) = inside.find(close) else {
            rest = inside;
            continue;
        };
        // A name stands for a word, so that nothing before it seems to begin after it.
        out.push_str(" 0 ");
        out.extend(inside[..end].chars().filter(|letter| *letter == '\n'));
        rest = &inside[end + close.len()..];
    }
    out.push_str(rest);
    out
}

/// The words of a text that begins at this line.
fn words(text: &str, line: usize) -> Vec<Spoken> {
    let mut found: Vec<Spoken> = Vec::new();
    let mut begins = true;
    for (number, part) in plain(text).split('\n').enumerate() {
        begins |= part.trim().is_empty();
        for chunk in part.split_whitespace() {
            let name = chunk.contains(['_', '@']) || chunk.contains("::") || chunk.contains("//");
            if name {
                begins = false;
            } else if matches!(chunk, "-" | "*" | "#") {
                begins = true;
            } else {
                for word in chunk.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()) {
                    let capital = word.starts_with(|letter: char| letter.is_uppercase());
                    let first = found.is_empty() && begins;
                    found.push(Spoken { word: word.to_lowercase(), capital, first, begins, line: line + number });
                    begins = false;
                }
            }
            begins |= chunk.trim_end_matches(['"', ')', '\'']).ends_with(['.', '!', '?']);
        }
    }
    found
}

/// Breaches of the rules in a text, each with its line.
fn broken(prose: &Prose) -> Vec<(Rule, usize, String)> {
    let spoken = words(&prose.text, prose.line);
    if prose.message && spoken.len() < MESSAGE {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (place, word) in spoken.iter().enumerate() {
        let next = spoken.get(place + 1).filter(|next| !next.begins).map_or("", |next| next.word.as_str());
        let so = word.word == "so" && AFTER_SO.contains(&next);
        let begins = word.first || word.begins && word.capital;
        let pair = format!("{} {next}", word.word);
        if begins && (so || BEGINNINGS.contains(&word.word.as_str())) {
            found.push((Rule::Begins, word.line, pair.clone()));
        }
        if so {
            found.push((Rule::So, word.line, pair.clone()));
        }
        if WORDS.contains(&word.word.as_str()) || word.word.starts_with("reckon") {
            found.push((Rule::Words, word.line, word.word.clone()));
        } else if pair == "of before" {
            found.push((Rule::Words, word.line, pair));
        }
    }
    found
}

/// Every offending place by room; every room has an entry.
fn places<'a>(
    sources: impl IntoIterator<Item = &'a Source> + Clone,
    rooms: &BTreeSet<String>,
) -> BTreeMap<String, Vec<Place>> {
    let mut found: BTreeMap<String, Vec<Place>> = rooms.iter().map(|room| (room.clone(), Vec::new())).collect();
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    for defined in sources.clone().into_iter().flat_map(|source| &source.types) {
        *names.entry(&defined.name).or_default() += 1;
    }
    for source in sources {
        let of_room = found.entry(source.room.clone()).or_default();
        let place = |rule, line, what| Place { rule, file: source.file.clone(), line, what };
        of_room.extend(source.prose.iter().flat_map(broken).map(|(rule, line, what)| place(rule, line, what)));
        let shared = source.types.iter().map(|defined| (defined, names[defined.name.as_str()]));
        of_room.extend(
            shared.filter(|(_, types)| *types > 1).map(|(defined, types)| {
                place(Rule::Types, defined.line, format!("{} names {types} types", defined.name))
            }),
        );
    }
    found
}

/// Types of the workspace per name.
fn types_per_name(sources: &[Source]) -> f64 {
    let types: Vec<&str> =
        sources.iter().flat_map(|source| &source.types).map(|defined| defined.name.as_str()).collect();
    let names: BTreeSet<&str> = types.iter().copied().collect();
    f64::from(u32::try_from(types.len()).unwrap()) / f64::from(u32::try_from(names.len().max(1)).unwrap())
}

fn counts(places: &[Place]) -> Counts {
    Rule::ALL.into_iter().map(|rule| (rule, places.iter().filter(|place| place.rule == rule).count())).collect()
}

/// The ceilings: types per name, and the counts of each room.
fn ceilings(text: &str) -> (f64, BTreeMap<String, Counts>) {
    let table: toml::Table = text.parse().unwrap_or_else(|why| panic!("tests/house/{TABLE}: {why}"));
    let ratio = table["types_per_name"].as_float().unwrap();
    let rooms = table["rooms"].as_table().unwrap().iter().map(|(room, row)| {
        let count = |rule: Rule| {
            let value = row.get(rule.column()).and_then(toml::Value::as_integer);
            let value = value.unwrap_or_else(|| panic!("tests/house/{TABLE}: `{room}` has no `{}`", rule.column()));
            (rule, usize::try_from(value).unwrap())
        };
        (room.clone(), Rule::ALL.into_iter().map(count).collect())
    });
    (ratio, rooms.collect())
}

/// The table under its old head, each count the lower of the old one and the present one.
fn lowered(old: &str, ratio: f64, found: &BTreeMap<String, Vec<Place>>) -> String {
    let (old_ratio, rows) = ceilings(old);
    let head = old.lines().take_while(|line| line.starts_with('#'));
    let mut text: String = head.map(|line| format!("{line}\n")).collect();
    // A ceiling is rounded up, or the present ratio would be above it.
    writeln!(text, "types_per_name = {:.2}\n\n[rooms]", old_ratio.min((ratio * 100.0).ceil() / 100.0)).unwrap();
    let width = found.keys().map(String::len).max().unwrap_or_default() + 2;
    for (room, places) in found {
        let cells = counts(places).into_iter().map(|(rule, count)| {
            let count = rows.get(room).map_or(count, |row| row[&rule].min(count));
            format!("{} = {count:>4}", rule.column())
        });
        writeln!(text, "{:<width$} = {{ {} }}", format!("\"{room}\""), cells.collect::<Vec<_>>().join(", ")).unwrap();
    }
    text
}

/// Counts above the ceilings, and ceilings that can be lowered.
fn compared(rows: &BTreeMap<String, Counts>, found: &BTreeMap<String, Vec<Place>>) -> (Vec<String>, Vec<String>) {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (room, places) in found {
        let Some(row) = rows.get(room) else {
            above.push(format!("`{room}` has no row; {WRITE}=1 writes one"));
            continue;
        };
        for (rule, count) in counts(places) {
            let (ceiling, column) = (row[&rule], rule.column());
            if count < ceiling {
                below.push(format!("`{room}`: `{column}` is {count}, its ceiling {ceiling}"));
            } else if count > ceiling {
                let mut text = format!("`{room}`: `{column}` is {count}, its ceiling {ceiling}; {}", rule.text());
                let broken: Vec<&Place> = places.iter().filter(|place| place.rule == rule).collect();
                for place in broken.iter().take(SHOWN) {
                    write!(text, "\n  {}:{}: {}", place.file, place.line, place.what).unwrap();
                }
                if broken.len() > SHOWN {
                    write!(text, "\n  and {} more", broken.len() - SHOWN).unwrap();
                }
                above.push(text);
            }
        }
    }
    let gone = rows.keys().filter(|room| !found.contains_key(*room));
    above.extend(gone.map(|room| format!("`{room}` has a row and is no room; {WRITE}=1 removes it")));
    (above, below)
}

#[test]
#[expect(clippy::print_stdout, reason = "a hint is no failure, and `--nocapture` shows it")]
fn english_of_a_room_gets_no_worse() {
    let rooms: BTreeSet<String> = members().into_keys().collect();
    let found = places(sources(), &rooms);
    let ratio = types_per_name(sources());
    let (path, text) = table(TABLE);
    if asked_to_write(WRITE) {
        let new = lowered(&text, ratio, &found);
        if new != text {
            std::fs::write(&path, new).unwrap();
            panic!("wrote tests/house/{TABLE}; the next run is green where no count was above its ceiling");
        }
    }
    let (ceiling, rows) = ceilings(&text);
    let (mut above, below) = compared(&rows, &found);
    if ratio > ceiling {
        above.push(format!(
            "the workspace has {ratio:.3} types per name, its ceiling is {ceiling}; {}",
            Rule::Types.text()
        ));
    }
    let totals = counts(&found.values().flatten().cloned().collect::<Vec<_>>());
    let totals: Vec<String> = totals.iter().map(|(rule, count)| format!("{} {count}", rule.column())).collect();
    println!("English of the workspace: {}, types per name {ratio:.3}", totals.join(", "));
    if !below.is_empty() {
        println!("lower tests/house/{TABLE} with {WRITE}=1:\n  {}", below.join("\n  "));
    }
    assert!(above.is_empty(), "tests/house/{TABLE}:\n{}", above.join("\n"));
}

fn said(text: &str, message: bool) -> Vec<(Rule, usize, String)> {
    broken(&Prose { line: 1, text: text.to_owned(), message })
}

#[test]
fn each_rule_finds_its_words_with_their_lines() {
    let found = said(" Who comes. It is\n so\n many. What is told, nobody reckons anew of before.", false);
    let found: Vec<(&str, usize, &str)> =
        found.iter().map(|(rule, line, what)| (rule.column(), *line, what.as_str())).collect();
    assert_eq!(
        found,
        [
            ("begins", 1, "who comes"),
            ("so", 2, "so many"),
            ("begins", 3, "what is"),
            ("words", 3, "told"),
            ("words", 3, "nobody"),
            ("words", 3, "reckons"),
            ("words", 3, "anew"),
            ("words", 3, "of before"),
        ]
    );
}

#[test]
fn names_short_strings_and_words_within_sentences_are_not_counted() {
    for text in [
        "Address of those who ask for what is there.",
        "`told` and {anew} and is_told, told::of, nobody@example.org",
        "It is so. Many come.",
        "soldered, untold",
        "```text\nWho is it?\n```\nThe end",
    ] {
        assert_eq!(said(text, false), [], "{text}");
    }
    assert_eq!(said("who is", true), []);
    assert_eq!(said("who is it", true).len(), 1);
    assert_eq!(said("{name} what is it", true), []);
}

#[test]
fn a_table_is_only_lowered_and_keeps_its_head() {
    let place = |rule, line| Place { rule, file: "r/src/a.rs".to_owned(), line, what: "who".to_owned() };
    let found = BTreeMap::from([
        ("r".to_owned(), vec![place(Rule::Begins, 1), place(Rule::So, 2), place(Rule::So, 3)]),
        ("s".to_owned(), vec![place(Rule::Words, 1)]),
    ]);
    let old = "# head\ntypes_per_name = 1.50\n\n[rooms]\n\"r\" = { begins = 3, so = 1, words = 0, types = 0 }\n\"gone\" = { begins = 0, so = 0, words = 0, types = 0 }\n";
    let (above, below) = compared(&ceilings(old).1, &found);
    assert!(
        above[0].starts_with("`r`: `so` is 2, its ceiling 1") && above[0].contains("\n  r/src/a.rs:3: who"),
        "{above:?}"
    );
    assert!(above[1].starts_with("`s` has no row") && above[2].starts_with("`gone` has a row"), "{above:?}");
    assert_eq!((above.len(), below.as_slice()), (3, &["`r`: `begins` is 1, its ceiling 3".to_owned()][..]));
    let new = lowered(old, 1.421, &found);
    assert!(new.starts_with("# head\ntypes_per_name = 1.43\n"), "{new}");
    let rows = ceilings(&new).1;
    let row = |room: &str| rows[room].values().copied().collect::<Vec<_>>();
    assert_eq!((row("r"), row("s"), rows.len()), (vec![1, 1, 0, 0], vec![0, 0, 1, 0], 2));
}
