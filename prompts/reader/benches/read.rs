//! How long a request takes to be read: every request of the open corpora, text to statements and form.
//!
//! ```text
//! cargo bench -p socrates-reader
//! ```
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use std::path::Path;
use std::time::Instant;

use serde::Deserialize;

/// A request takes at most so long, in the middle of all of them, µs.
const BUDGET_US: f64 = 200.0;
/// Every text is read so often, and its shortest time counts.
const TIMES: usize = 5;

#[derive(Deserialize)]
struct Corpus {
    request: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    text: String,
}

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../offline/corpus");
    let files = std::fs::read_dir(&folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let open = files.filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("open")));
    let texts = open.filter_map(|path| toml::from_str::<Corpus>(&std::fs::read_to_string(path).ok()?).ok());
    let texts: Vec<String> = texts.flat_map(|corpus| corpus.request).map(|case| case.text).collect();
    let mut times: Vec<f64> = texts.iter().map(|text| shortest(text)).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times.get((share * times.len() as f64) as usize).copied().unwrap_or_default();
    let verdict = if at(0.5) <= BUDGET_US { "within" } else { "OVER" };
    println!(
        "{} requests: {:.0} µs in the middle, {:.0} µs for 19 of 20; {verdict} the {BUDGET_US} µs of the budget",
        times.len(),
        at(0.5),
        at(0.95)
    );
}

/// The shortest of some times, µs.
fn shortest(text: &str) -> f64 {
    let once = |_turn: usize| {
        let start = Instant::now();
        std::hint::black_box(socrates_reader::read(std::hint::black_box(text)).story);
        start.elapsed().as_secs_f64() * 1e6
    };
    (0..TIMES).map(once).fold(f64::INFINITY, f64::min)
}
