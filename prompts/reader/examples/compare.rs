//! The two readers of requests side by side: all corpora, by kind of construct.
//!
//! `cargo run -p socrates-offline --example snapshot > old.tsv`, then
//! `cargo run -p socrates-reader --example compare -- old.tsv [--sets] [--list KIND] [--set NAME]`; `--show TEXT`, `--examples` and
//! `--ablate` (what each row earns) need no snapshot. The rows are read from `data/`, so that they can be tried without a build.
//!
//! A quarter of the open corpora is held out: the requests whose text has an FNV-1a hash (64 bits) that four divides. `--list` never
//! shows those, nor the sets kept aside: of these only counts are printed, and only where `--aside` asks for them.

#![expect(clippy::print_stdout, reason = "a report for people")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::Instant;

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

fn new_view(read: &Read) -> View {
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
    let cases: Vec<Case> = corpora().into_iter().filter(|(aside, _)| !aside).flat_map(|(_, cases)| cases).collect();
    let right = |reader: &Reader| -> Vec<i64> {
        let of = |case: &Case| {
            let view = new_view(&reader.read(&case.text));
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

/// All requests, those aside apart.
fn corpora() -> Vec<(bool, Vec<Case>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../offline/corpus");
    let mut paths: Vec<_> =
        std::fs::read_dir(&folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let mut all = Vec::new();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let Ok(corpus) = toml::from_str::<Corpus>(&std::fs::read_to_string(path).unwrap_or_default()) else { continue };
        let sealed = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("sealed"));
        let (aside, open): (Vec<Case>, Vec<Case>) =
            corpus.request.into_iter().partition(|case| sealed || held_out(&case.text));
        all.extend([(true, aside), (false, open)]);
    }
    all
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

fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn held_out(text: &str) -> bool {
    hash(text).is_multiple_of(4)
}

/// What the old reader understood, by the hash of the text.
fn snapshot(path: &str) -> BTreeMap<u64, View> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let line = |line: &str| {
        let mut parts = line.split('\t');
        let hash = u64::from_str_radix(parts.next()?, 16).ok()?;
        let honest = parts.next()? == "true";
        Some((hash, View { facts: parts.next()?.split(';').map(str::to_owned).collect(), honest }))
    };
    text.lines().filter_map(line).collect()
}

#[derive(Default, Clone)]
struct Tally {
    requests: usize,
    facts: usize,
    old: usize,
    new: usize,
    both: usize,
    /// Wrong or missing facts of requests of which nothing was said to be unread.
    silent: usize,
    /// The same of the old reader.
    old_silent: usize,
    /// Requests read without a word left.
    whole: usize,
    /// The same of the old reader.
    old_whole: usize,
    /// Requests whose facts are all right although something is said to be unread.
    needless: usize,
    /// Facts of the old reader, and of both.
    old_said: usize,
    agreed: usize,
    new_said: usize,
}

impl Tally {
    fn line(&self, name: &str) -> String {
        let share = |part: usize, all: usize| if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 };
        format!(
            "{name:<28} {:>5} requests {:>6} facts  old {:>5.1} %  new {:>5.1} %  silent: old {:>4.2} %, new {:>4.2} %  read whole: old {:>5.1} %, new {:>5.1} %, needlessly not {:>5.1} %  statements: agreed {:>5.1} % of old, {:>5.1} % of new",
            self.requests,
            self.facts,
            share(self.old, self.facts),
            share(self.new, self.facts),
            share(self.old_silent, self.facts),
            share(self.silent, self.facts),
            share(self.old_whole, self.requests),
            share(self.whole, self.requests),
            share(self.needless, self.requests),
            share(self.agreed, self.old_said),
            share(self.agreed, self.new_said),
        )
    }

    fn add(&mut self, other: &Self) {
        self.requests += other.requests;
        self.facts += other.facts;
        self.old += other.old;
        self.new += other.new;
        self.both += other.both;
        self.silent += other.silent;
        self.old_silent += other.old_silent;
        self.whole += other.whole;
        self.old_whole += other.old_whole;
        self.needless += other.needless;
        self.old_said += other.old_said;
        self.agreed += other.agreed;
        self.new_said += other.new_said;
    }
}

/// What is seen of all requests together.
#[derive(Default)]
struct Seen {
    kinds: BTreeMap<String, Tally>,
    times: Vec<f64>,
    unread: BTreeMap<String, usize>,
}

struct Options {
    list: Option<String>,
    set: Option<String>,
    only_wrong: bool,
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
        ablate(files, &reader);
        return;
    }
    if words.iter().any(|word| word == "--examples") {
        for example in reader.examples() {
            example_line(&reader, example);
        }
        return;
    }
    let options =
        Options { list: value("--list"), set: value("--set"), only_wrong: !words.iter().any(|word| word == "--all") };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../offline/corpus");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .collect();
    names.sort();
    let old = snapshot(words.first().map_or("", String::as_str));
    let mut tallies: BTreeMap<(bool, String), Tally> = BTreeMap::new();
    let mut seen = Seen::default();
    for name in names.iter().filter(|name| options.set.as_ref().is_none_or(|set| **name == format!("{set}.toml"))) {
        let Ok(text) = std::fs::read_to_string(folder.join(name)) else { continue };
        let Ok(corpus) = toml::from_str::<Corpus>(&text) else { continue };
        for case in &corpus.request {
            let aside = name.starts_with("sealed") || held_out(&case.text);
            let tally = judge(&reader, case, old.get(&hash(&case.text)), aside, &options, &mut seen);
            tallies.entry((aside, name.trim_end_matches(".toml").to_owned())).or_default().add(&tally);
        }
    }
    let flag = |flag: &str| words.iter().any(|word| word == flag);
    report(flag("--sets"), flag("--aside"), &tallies, seen);
}

fn judge(reader: &Reader, case: &Case, old: Option<&View>, aside: bool, options: &Options, seen: &mut Seen) -> Tally {
    let nothing = View::default();
    let old = old.unwrap_or(&nothing);
    let start = Instant::now();
    let read = reader.read(&case.text);
    seen.times.push(start.elapsed().as_secs_f64() * 1e6);
    let new = new_view(&read);
    let right = case.facts.iter().all(|fact| new.holds(fact));
    let mut tally = Tally {
        requests: 1,
        whole: usize::from(!new.honest),
        old_whole: usize::from(!old.honest),
        // What a text contradicts, or wants and cannot be, is said to be so: that is needed.
        needless: usize::from(right && new.honest && !case.facts.iter().any(|fact| kind(fact).contains("problem"))),
        ..Tally::default()
    };
    let mut shown = options.list.is_none();
    if !aside && options.list.as_deref() == Some("dump") {
        println!(
            "### {} {}\n{}",
            if right { "right" } else { "wrong" },
            if new.honest { "flagged" } else { "whole" },
            reader.passes(&case.text)
        );
    }
    for fact in &case.facts {
        let kind = kind(fact);
        let old_honest = old.honest;
        let (old, right) = (old.holds(fact), new.holds(fact));
        let silent = !right && !new.honest;
        let own = Tally {
            facts: 1,
            old: usize::from(old),
            new: usize::from(right),
            both: usize::from(old && right),
            silent: usize::from(silent),
            old_silent: usize::from(!old && !old_honest),
            ..Tally::default()
        };
        if !kind.contains("problem") {
            tally.add(&own);
        }
        if !aside {
            seen.kinds.entry(kind.clone()).or_default().add(&own);
        }
        let wanted =
            options.list.as_ref().is_some_and(|list| kind == *list || list == "silent" && silent || list == "any");
        if wanted && !aside && (!right || !options.only_wrong) {
            if !shown || options.list.as_deref() == Some("any") && tally.facts == 1 {
                println!("\n{}", case.text);
                for line in read.story.to_string().lines() {
                    println!("      {line}");
                }
                for piece in read.pieces.iter().filter(|piece| piece.fate != Fate::Read) {
                    println!("      {:?}: {}", piece.fate, case.text.get(piece.at.clone()).unwrap_or_default());
                }
                shown = true;
            }
            println!(
                "   {} `{fact}`{}",
                if right { "right" } else { "missing" },
                if old { " (old right)" } else { "" }
            );
        }
    }
    if !aside {
        let lost = |piece: &&socrates_reader::Piece| matches!(piece.fate, Fate::NotRead | Fate::NotPlayed(_));
        let wanted = options.list.is_none() || right;
        for piece in read.pieces.iter().filter(lost).filter(|_| wanted) {
            *seen.unread.entry(case.text.get(piece.at.clone()).unwrap_or_default().to_lowercase()).or_default() += 1;
        }
    }
    tally.old_said = old.facts.len();
    tally.new_said = new.facts.len();
    tally.agreed = old.facts.intersection(&new.facts).count();
    tally
}

fn report(sets: bool, aside: bool, tallies: &BTreeMap<(bool, String), Tally>, seen: Seen) {
    let Seen { kinds, mut times, unread } = seen;
    for aside in [Some(false), aside.then_some(true)].into_iter().flatten() {
        let mut all = Tally::default();
        println!("\n{}", if aside { "held out, and sets kept aside" } else { "worked on" });
        for ((_, name), tally) in tallies.iter().filter(|((own, _), _)| *own == aside) {
            if sets {
                println!("{}", tally.line(name));
            }
            all.add(tally);
        }
        println!("{}", all.line("ALL"));
    }
    println!("\nby kind, of what is worked on");
    let mut kinds: Vec<(&String, &Tally)> = kinds.iter().collect();
    kinds.sort_by_key(|(_, tally)| std::cmp::Reverse(tally.facts - tally.new));
    for (kind, tally) in kinds.iter().take(60) {
        println!(
            "{kind:<26} {:>5} facts  old {:>5}  new {:>5}  lost {:>4}  silent {:>4}",
            tally.facts,
            tally.old,
            tally.new,
            tally.facts - tally.new,
            tally.silent
        );
    }
    let mut unread: Vec<(&String, &usize)> = unread.iter().collect();
    unread.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    println!("\nnot read most often");
    for (words, count) in unread.iter().take(400) {
        print!("{count} {words} | ");
    }
    times.sort_by(f64::total_cmp);
    let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
    println!(
        "\n{} requests, {mean:.0} µs each, {:.0} µs at the median",
        times.len(),
        times.get(times.len() / 2).copied().unwrap_or_default()
    );
}
