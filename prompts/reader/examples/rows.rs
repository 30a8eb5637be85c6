//! The rows at work: what they make of a text, whether their examples hold, and what each of them earns.
//!
//! `cargo run -p socrates-reader --example rows -- --show TEXT`: every pass of a text; `--examples`: the examples of rows that do not hold;
//! `--ablate`: what each row earns of all corpora; nothing: facts of the corpora that are right, by kind. The rows are read from `data/`,
//! so that they can be tried without a build.
//!
//! A quarter of the open corpora is held out: the requests whose text has an FNV-1a hash (64 bits) that four divides. They, and the sets
//! kept aside, count in nothing here.

#![expect(clippy::print_stdout, reason = "a report for people")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;
use socrates_reader::{Act, Example, Fate, Files, Read, Reader, Reason};

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    text: String,
    facts: Vec<String>,
}

/// What a reader understood, one fact a line as the corpora write it.
#[derive(Default)]
struct View {
    facts: BTreeSet<String>,
    /// Whether it says that something was not read, or is not played.
    honest: bool,
}

impl View {
    fn holds(&self, fact: &str) -> bool {
        match fact.strip_prefix("not ") {
            Some(rest) => !self.holds(rest),
            None if fact.starts_with("problem") || fact.starts_with("ignored") => self.honest,
            None => self.facts.contains(fact),
        }
    }
}

fn act_name(act: Act, whom: Option<usize>) -> String {
    whom.map_or_else(|| act.name().to_owned(), |whom| format!("follow_human {}", whom + 1))
}

fn number(value: f64) -> String {
    format!("{value}")
}

fn cue_words(reason: &Reason<Vec<usize>>) -> Vec<String> {
    let kind = format!("{:?}", reason.cue).to_lowercase();
    let mut words = match kind.as_str() {
        "says" => reason.sign.map_or_else(Vec::new, |sign| match reason.who.as_ref() {
            None => vec![format!("when robot_says {sign}")],
            Some(who) => who.iter().map(|who| format!("when human_says {} {sign}", who + 1)).collect(),
        }),
        _ => vec![format!("when {kind}")],
    };
    words.extend(reason.amount.map(|amount| format!("at {}", number(amount))));
    words
}

fn view_of(read: &Read) -> View {
    let mut facts = BTreeSet::new();
    let story = &read.story;
    facts.insert(format!("humans {}", story.people.len()));
    facts.extend(story.place.map(|place| format!("place {place}")));
    facts.extend(story.robot_start.map(|place| format!("robot start {place}")));
    facts.extend(story.robot_goal.map(|place| format!("robot goal {place}")));
    facts.extend(story.robot_says.iter().map(|sign| format!("robot says {sign}")));
    let mut groups: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for (at, person) in story.people.iter().enumerate() {
        let n = at + 1;
        facts.insert(format!("{n} role {}", person.role));
        facts.extend(person.relation.map(|relation| format!("{n} {}", relation.name())));
        facts.extend(person.crosses.then(|| format!("{n} crossing")));
        if let Some(group) = person.group {
            groups.entry(group).or_default().push(n.to_string());
        }
        let mut before: Vec<Reason<Vec<usize>>> = Vec::new();
        let mut lasted = None;
        for step in &person.steps {
            facts.extend(step.says.map(|sign| format!("{n} says {sign}")));
            let act = format!("{n}: {}", act_name(step.act, step.whom.filter(|_| step.act == Act::Follow)));
            facts.insert(act.clone());
            facts.extend(step.for_s.map(|secs| format!("{act} for {}", number(secs))));
            let when = if step.when.is_empty() { &before } else { &step.when };
            for word in when.iter().flat_map(cue_words) {
                facts.insert(format!("{act} {word}"));
            }
            if let Some(secs) = lasted {
                facts.insert(format!("{act} when after"));
                facts.insert(format!("{act} at {}", number(secs)));
            }
            for word in step.until.iter().flat_map(cue_words) {
                facts.insert(format!("{n}: navigate"));
                facts.insert(format!("{n}: navigate {word}"));
            }
            before = when.clone();
            lasted = step.for_s;
        }
    }
    for members in groups.values() {
        facts.insert(format!("group {}", members.join(" ")));
    }
    let honest = read.pieces.iter().any(|piece| matches!(piece.fate, Fate::NotRead | Fate::NotPlayed(_)));
    View { facts, honest }
}

/// The kind of construct of which a fact is.
fn kind(fact: &str) -> String {
    let (not, bare) = fact.strip_prefix("not ").map_or(("", fact), |rest| ("not ", rest));
    let words: Vec<&str> = bare.split_whitespace().collect();
    let kind = match words[..] {
        ["humans", ..] => "humans".to_owned(),
        ["group", ..] => "group".to_owned(),
        ["place", ..] => "place".to_owned(),
        ["robot", what, ..] => format!("robot {what}"),
        ["problem" | "ignored", ..] => "problem".to_owned(),
        [_, "role", _] => "role".to_owned(),
        [_, "says", _] => "says".to_owned(),
        [who, relation] if !who.ends_with(':') => format!("relation {relation}"),
        [_, "follow_human", _, ref rest @ ..] => tail("follow_human", rest),
        [_, act, ref rest @ ..] => tail(act, rest),
        _ => "?".to_owned(),
    };
    format!("{not}{kind}")
}

fn tail(act: &str, rest: &[&str]) -> String {
    match rest {
        [] => format!("act {act}"),
        ["when", cue, ..] => format!("when {cue}"),
        [word, ..] => (*word).to_owned(),
    }
}

/// What each row earns: the facts that are right with it and not without it, and in how many requests, of what is worked on. A
/// request all of whose facts are right and of which nothing is said to be unread counts as one more.
fn ablate(files: Files<'_>, whole: &Reader) {
    let cases = corpora();
    let right = |reader: &Reader| -> Vec<i64> {
        let of = |case: &Case| {
            let view = view_of(&reader.read(&case.text));
            let right = case.facts.iter().filter(|fact| view.holds(fact)).count();
            let whole = right == case.facts.len() && !view.honest;
            i64::try_from(right + usize::from(whole)).unwrap_or_default()
        };
        cases.iter().map(of).collect()
    };
    let with = right(whole);
    let mut lines: Vec<(i64, usize, &str)> = Vec::new();
    for id in whole.rows() {
        let Ok(reader) = Reader::without(files, id) else { continue };
        let without = right(&reader);
        let facts: i64 = with.iter().zip(&without).map(|(with, without)| with - without).sum();
        let requests = with.iter().zip(&without).filter(|(with, without)| with > without).count();
        lines.push((facts, requests, id));
    }
    lines.sort_unstable();
    for (facts, requests, id) in lines {
        println!("{id:<20} {facts:>5} facts in {requests:>4} requests");
    }
}

/// All requests that may be looked at.
fn corpora() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../offline/corpus");
    let files = std::fs::read_dir(&folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let open = |path: &std::path::PathBuf| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("open") && name.to_string_lossy().ends_with(".toml"))
    };
    let mut paths: Vec<_> = files.filter(open).collect();
    paths.sort();
    let texts = paths.iter().filter_map(|path| std::fs::read_to_string(path).ok());
    let corpora = texts.filter_map(|text| toml::from_str::<Corpus>(&text).ok());
    corpora.flat_map(|corpus| corpus.request).filter(|case| !held_out(&case.text)).collect()
}

/// How many facts of each kind are right, those first of which the most are not.
fn kinds(reader: &Reader) {
    let mut kinds: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for case in corpora() {
        let view = view_of(&reader.read(&case.text));
        for fact in &case.facts {
            let (all, right) = kinds.entry(kind(fact)).or_default();
            *all += 1;
            *right += usize::from(view.holds(fact));
        }
    }
    let mut kinds: Vec<_> = kinds.into_iter().collect();
    kinds.sort_by_key(|(_, (all, right))| std::cmp::Reverse(all - right));
    for (kind, (all, right)) in kinds {
        println!("{kind:<26} {right:>5} of {all:>5} facts");
    }
}

fn example_line(reader: &Reader, example: Example<'_>) {
    if example.file == "edits" {
        let asks = reader.wishes(example.text).first().map_or("nothing", |wish| wish.edit.name());
        if (asks == example.gives) != example.does {
            println!("edits {}: “{}” asks for {asks}", example.row, example.text);
        }
        return;
    }
    let story = reader.read(example.text).story.to_string();
    let by_text = matches!(example.file, "rewrites" | "scopes");
    let holds = if by_text {
        story == reader.read(example.gives).story.to_string()
    } else {
        story.lines().any(|line| line.starts_with(example.gives))
    };
    if holds != example.does {
        println!(
            "{} {}: {} `{}` of “{}”:\n{story}",
            example.file,
            example.row,
            if example.does { "misses" } else { "gives" },
            example.gives,
            example.text
        );
    }
}

fn held_out(text: &str) -> bool {
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    hash.is_multiple_of(4)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let value = |flag: &str| words.iter().position(|word| word == flag).and_then(|at| words.get(at + 1)).cloned();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let file = |name: &str| std::fs::read_to_string(data.join(name)).unwrap_or_default();
    let texts = ["words", "frames", "places", "signs", "rewrites", "scopes", "errands", "edits"]
        .map(|name| file(&format!("{name}.toml")));
    let [words_file, frames, places, signs, rewrites, scopes, errands, edits] = &texts;
    let files = Files { words: words_file, frames, places, signs, rewrites, scopes, errands, edits };
    let reader = match Reader::of(files) {
        Ok(reader) => reader,
        Err(fault) => {
            println!("{fault}: {:?}", std::error::Error::source(&fault).map(ToString::to_string));
            return;
        }
    };
    if let Some(text) = value("--show") {
        println!("{}", reader.passes(&text));
        return;
    }
    if words.iter().any(|word| word == "--ablate") {
        return ablate(files, &reader);
    }
    if words.iter().any(|word| word == "--examples") {
        for example in reader.examples() {
            example_line(&reader, example);
        }
        return;
    }
    kinds(&reader);
}
