//! Writes what is understood of every request of the corpora, of every shipped request and of the text of every card, a line each: to
//! compare two versions of this crate with `diff`.
//!
//! `cargo run -p socrates-offline --example readings > readings.txt`

#![expect(clippy::print_stdout, reason = "the lines are the result")]

mod corpora;

use corpora::{asked, each, facts, hash};
use socrates_model::{Location, Reading, Request};

fn main() {
    each(|text, _, (request, location), _| line(&format!("{:016x}", hash(text)), request, location));
    for on in socrates_maps::shipped::names() {
        let Ok(location) = socrates_maps::shipped::load(on) else { continue };
        for (name, text) in socrates_maps::shipped::requests(on) {
            Request::of_toml(text, None).iter().for_each(|request| line(&format!("{on}/{name}"), request, &location));
        }
        for card in socrates_offline::catalog() {
            let request = asked(on, &card.about);
            request.iter().for_each(|request| line(&format!("{on}/{}", card.id), request, &location));
        }
    }
}

fn line(name: &str, request: &Request, location: &Location) {
    let reading = socrates_offline::read(request, location);
    let facts: Vec<String> = facts(&reading).into_iter().collect();
    let kinds: Vec<String> = reading.facts.iter().map(|fact| format!("{:?} {:?}", fact.kind, fact.quote)).collect();
    println!("{name}\n  {}\n  {}\n  {:?}\n  {}", facts.join("; "), kinds.join("; "), reading.pattern, rest(&reading));
}

/// Problems, notes and what became of the words.
fn rest(reading: &Reading) -> String {
    let problems: Vec<String> =
        reading.problems.iter().map(|fault| format!("{:?} {} {:?}", fault.code, fault.message, fault.quotes)).collect();
    let told: Vec<String> =
        reading.statements.iter().map(|statement| format!("{:?} {:?}", statement.quote, statement.became)).collect();
    let people: Vec<String> = reading.humans.iter().map(|human| format!("{human:?}")).collect();
    format!("{problems:?}\n  {:?}\n  {told:?}\n  {people:?}", reading.notes)
}
