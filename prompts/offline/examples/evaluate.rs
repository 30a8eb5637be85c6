//! What is read of requests in files: facts that are right, wrong and lost without a word.
//!
//! `cargo run -p socrates-offline --example evaluate -- [--unread] FILE.toml …`: files as in `corpus/`; `--unread` prints every piece of text
//! that is not read, with its request and the rewording that is offered. `--shipped` prints what is read of every shipped request and of
//! the text of every card.

#![expect(clippy::print_stdout, reason = "a report for people")]

#[expect(dead_code, reason = "shared by the examples")]
mod corpora;

use std::collections::BTreeSet;

use corpora::{Corpus, asked, facts};
use socrates_model::statement::Became;
use socrates_model::{Reading, Request};

/// What became of the requests of a file.
#[derive(Default)]
struct Count {
    requests: usize,
    facts: usize,
    right: usize,
    silent: usize,
    whole: usize,
    alarms: usize,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let unread = words.iter().any(|word| word == "--unread");
    for word in words.iter().filter(|word| *word != "--unread") {
        if word == "--shipped" {
            shipped();
        } else {
            file(word, unread);
        }
    }
}

fn holds(fact: &str, read: &BTreeSet<String>, honest: bool) -> bool {
    match fact.strip_prefix("not ") {
        Some(rest) => !holds(rest, read, honest),
        None if fact.starts_with("problem") || fact.starts_with("ignored") => honest,
        None => read.contains(fact),
    }
}

fn file(name: &str, unread: bool) {
    let Ok(corpus) = toml::from_str::<Corpus>(&std::fs::read_to_string(name).unwrap_or_default()) else {
        return println!("{name}: no file of requests");
    };
    let mut count = Count::default();
    for case in &corpus.request {
        let location = socrates_maps::shipped::load(&case.on);
        let Some((location, request)) = location.ok().zip(asked(&case.on, &case.text)) else { continue };
        let reading = socrates_offline::read(&request, &location);
        let read = facts(&reading);
        let honest = !reading.problems.is_empty() || !reading.missing().is_empty();
        let wrong = case.facts.iter().filter(|fact| !holds(fact, &read, honest)).count();
        count.requests += 1;
        count.facts += case.facts.len();
        count.right += case.facts.len() - wrong;
        count.silent += if honest { 0 } else { wrong };
        count.whole += usize::from(!honest);
        count.alarms += usize::from(honest && wrong == 0);
        if unread {
            pieces(&case.text, &reading);
        }
    }
    let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
    let Count { requests, facts, right, silent, whole, alarms } = count;
    println!(
        "{name}: {requests} requests, {facts} facts; right {right} ({:.1} %), silent {silent} ({:.2} %); read whole {whole} ({:.0} %), all \
         right and yet something said {alarms}",
        share(right, facts),
        share(silent, facts),
        share(whole, requests)
    );
}

/// Every piece that is not read, and its rewording.
fn pieces(text: &str, reading: &Reading) {
    for statement in &reading.statements {
        if let Became::NotRead { rewording } = &statement.became {
            println!("{text}\t{}\t{}", statement.quote, rewording.as_deref().unwrap_or("-"));
        }
    }
}

fn shipped() {
    for on in socrates_maps::shipped::names() {
        let Ok(location) = socrates_maps::shipped::load(on) else { continue };
        for (name, text) in socrates_maps::shipped::requests(on) {
            let request = Request::of_toml(text, None).ok();
            request.iter().for_each(|request| line(name, &socrates_offline::read(request, &location)));
        }
        for card in socrates_offline::catalog() {
            let request = asked(on, &card.about);
            request.iter().for_each(|request| line(&card.id, &socrates_offline::read(request, &location)));
        }
    }
}

fn line(name: &str, reading: &Reading) {
    let facts: Vec<String> = facts(reading).into_iter().collect();
    println!("{name}\t{:?}\t{}\t{}", reading.pattern, facts.join("; "), reading.missing().join(" | "));
}
