//! Both readers over the same requests, as the layers above see them: facts of the corpora, shipped requests, texts of cards.
//!
//! `cargo run -p socrates-offline --example readers -- [--list] [--kinds] [--aside]`: `--list` prints every shipped request and card that is
//! read otherwise, `--kinds` what each reader gets right of every kind of fact. A quarter of the open corpora, and the sets kept aside, count
//! in one line, and only with `--aside`.

#![expect(clippy::print_stdout, reason = "a report for people")]

mod corpora;

use std::collections::{BTreeMap, BTreeSet};

use corpora::{asked, each, facts, hash};
use socrates_model::{ReadBy, Reading, Request};

/// Right facts of the grammar and of the small reader.
#[derive(Default, Clone, Copy)]
struct Count {
    facts: usize,
    grammar: usize,
    small: usize,
}

impl Count {
    fn add(&mut self, (grammar, small): (bool, bool)) {
        self.facts += 1;
        self.grammar += usize::from(grammar);
        self.small += usize::from(small);
    }

    fn line(&self, name: &str) -> String {
        let share = |part: usize| 100.0 * part as f64 / self.facts.max(1) as f64;
        let (old, new) = (share(self.grammar), share(self.small));
        format!("{name:<28} {:>6} facts  grammar {old:>5.1} %  small {new:>5.1} %", self.facts)
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let flag = |flag: &str| words.iter().any(|word| word == flag);
    corpora(flag("--kinds"), flag("--aside"));
    let mut shipped = Vec::new();
    for location in ["hospital", "office", "warehouse"] {
        for (name, text) in socrates_maps::shipped::requests(location) {
            let Ok(request) = Request::of_toml(text, None) else { continue };
            shipped.push((format!("{location}/{name}"), request));
        }
    }
    told("shipped requests", &shipped, flag("--list"));
    let mut cards = Vec::new();
    for card in socrates_offline::catalog() {
        for location in ["hospital", "office", "warehouse"] {
            let Some(request) = asked(location, &card.about) else { continue };
            cards.push((format!("{} on {location}", card.id), request));
        }
    }
    told("texts of cards", &cards, flag("--list"));
}

/// How many requests are read the same, and what differs.
fn told(what: &str, requests: &[(String, Request)], list: bool) {
    let (mut same, mut pieces, mut pattern) = (0, 0, 0);
    for (name, request) in requests {
        let Ok(location) = socrates_maps::shipped::load(&request.location) else { continue };
        let [old, new] = [ReadBy::Grammar, ReadBy::Small].map(|by| socrates_offline::read_by(request, &location, by));
        let (before, after) = (facts(&old), facts(&new));
        let told = |reading: &Reading| reading.missing().join(" | ");
        pieces += usize::from(told(&old) == told(&new));
        pattern += usize::from(old.pattern == new.pattern);
        same += usize::from(before == after);
        if list && (before != after || told(&old) != told(&new)) {
            println!("\n{name}: {}", request.rough_scenario.as_deref().unwrap_or_default().trim());
            println!("   grammar {:?}, small {:?}", old.pattern, new.pattern);
            before.difference(&after).for_each(|fact| println!("   - {fact}"));
            after.difference(&before).for_each(|fact| println!("   + {fact}"));
            println!("   missing by the grammar: {}\n   missing by the small reader: {}", told(&old), told(&new));
        }
    }
    let all = requests.len();
    println!(
        "{what}: {same} of {all} have the same facts, {pattern} the same pattern, {pieces} the same words that are missing"
    );
}

fn corpora(kinds: bool, aside: bool) {
    let (mut open, mut held) = (Count::default(), Count::default());
    let mut by_kind: BTreeMap<String, Count> = BTreeMap::new();
    each(|text, told, (request, location), sealed| {
        let [old, new] =
            [ReadBy::Grammar, ReadBy::Small].map(|by| facts(&socrates_offline::understood(request, location, by)));
        let is_aside = sealed || hash(text).is_multiple_of(4);
        for fact in told.iter().filter(|fact| !fact.starts_with("problem") && !fact.starts_with("ignored")) {
            let right = (holds(fact, &old), holds(fact, &new));
            if is_aside {
                held.add(right);
            } else {
                open.add(right);
                by_kind.entry(kind(fact)).or_default().add(right);
            }
        }
    });
    println!("{}", open.line("corpora, worked on"));
    if aside {
        println!("{}", held.line("held out and kept aside"));
    }
    let mut lines: Vec<(&String, &Count)> = by_kind.iter().filter(|_| kinds).collect();
    lines.sort_by_key(|(_, count)| std::cmp::Reverse(count.grammar.saturating_sub(count.small)));
    for (kind, count) in lines {
        println!("  {kind:<26} {:>5} facts  grammar {:>5}  small {:>5}", count.facts, count.grammar, count.small);
    }
}

fn holds(fact: &str, facts: &BTreeSet<String>) -> bool {
    fact.strip_prefix("not ").map_or_else(|| facts.contains(fact), |rest| !holds(rest, facts))
}

/// The kind of construct of which a fact is: its words without numbers and names.
fn kind(fact: &str) -> String {
    let is_name =
        |word: &&str| word.trim_end_matches(':').parse::<f64>().is_err() && !word.chars().any(char::is_uppercase);
    let words: Vec<&str> = fact.split_whitespace().filter(is_name).collect();
    let first = words.first().copied().unwrap_or_default();
    match words[..] {
        ["role" | "place", ..] => first.to_owned(),
        ["not", "role" | "place", ..] => words.iter().take(2).copied().collect::<Vec<_>>().join(" "),
        ["robot", part, ..] => format!("robot {part}"),
        _ => words.join(" "),
    }
}
