//! What was rated, as lines, as Markdown and as an object: cards, the matrix card × map, what does not fit, the robot's ways.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};
use socrates_offline::{Card, Unfit};
use socrates_stats::{Interval, Z_95, wilson};

use super::{Item, Outcome, Played, RateOptions};
use crate::cards::mark;

/// Seeds of a failure that are named.
const NAMED: usize = 6;
/// The worst ways that are named.
const WORST: usize = 10;
/// From which share on a way counts as straight.
const STRAIGHT: f64 = 0.8;
/// Columns of the matrix that a terminal still shows.
const COLUMNS: usize = 12;

/// Realised of played.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) played: usize,
    pub(crate) realised: usize,
    late: usize,
    success: usize,
}

impl Tally {
    fn of<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Self {
        outcomes.fold(Self::default(), |sum, one| Self {
            played: sum.played + 1,
            realised: sum.realised + usize::from(one.realised),
            late: sum.late + usize::from(one.late),
            success: sum.success + usize::from(one.success),
        })
    }

    /// The share with its 95 % Wilson interval; none of nothing.
    fn interval(self) -> Option<Interval> {
        wilson(self.realised, self.played, Z_95).ok()
    }

    /// Lower end of the interval; 0 of nothing.
    pub(crate) fn low(self) -> f64 {
        self.interval().map_or(0.0, |interval| interval.low)
    }
}

/// `97.1 % (96.0 to 97.9 %)`, or a dash of nothing.
fn percent(interval: Option<Interval>) -> String {
    interval.map_or_else(
        || "–".to_owned(),
        |share| format!("{:.1} % ({:.1} to {:.1} %)", share.estimate * 100.0, share.low * 100.0, share.high * 100.0),
    )
}

/// How straight the robot went.
#[derive(Debug)]
struct Straight<'a> {
    runs: usize,
    straight: usize,
    /// The least straight first.
    worst: Vec<(f64, &'a Item)>,
}

impl Played {
    /// Runs of a card.
    pub(crate) fn of_card(&self, card: usize) -> impl Iterator<Item = &(Item, Outcome)> {
        self.runs.iter().filter(move |(item, _)| item.card == card)
    }

    /// What came of a card's runs.
    pub(crate) fn tally(&self, card: usize) -> Tally {
        Tally::of(self.of_card(card).map(|(_, outcome)| outcome))
    }

    /// What came of all runs.
    pub(crate) fn pooled(&self) -> Tally {
        Tally::of(self.runs.iter().map(|(_, outcome)| outcome))
    }

    /// What a place is called.
    fn name(&self, place: usize) -> &str {
        self.places.get(place).map_or("", |place| place.name.as_str())
    }

    fn column(&self, place: usize) -> &str {
        self.places.get(place).map_or("", |place| place.column.as_str())
    }

    fn id(&self, card: usize) -> &str {
        self.cards.get(card).map_or("", |card| card.id.as_str())
    }

    /// The columns of the matrix, in order of the places.
    fn columns(&self) -> Vec<&str> {
        let mut columns: Vec<&str> = Vec::new();
        for place in &self.places {
            if !columns.contains(&place.column.as_str()) {
                columns.push(&place.column);
            }
        }
        columns
    }

    /// What went wrong with a card: the reason, and the seeds with their places.
    pub(crate) fn failures(&self, card: usize) -> BTreeMap<&str, Vec<(u64, &str)>> {
        let mut failures: BTreeMap<&str, Vec<(u64, &str)>> = BTreeMap::new();
        for (item, outcome) in self.of_card(card) {
            if let Some(why) = &outcome.failing {
                failures.entry(why.as_str()).or_default().push((item.seed, self.name(item.place)));
            }
        }
        failures
    }

    /// The failures of a card in words.
    fn failed(&self, card: usize, between: &str) -> String {
        let told = self.failures(card).into_iter().map(|(why, seeds)| {
            let some: Vec<String> = seeds.iter().take(NAMED).map(|(seed, _)| seed.to_string()).collect();
            let more = if seeds.len() > NAMED { " …" } else { "" };
            format!("{why} ×{} ({}{more})", seeds.len(), some.join(" "))
        });
        told.collect::<Vec<_>>().join(between)
    }

    /// The reasons why cards fit no map of a column, each once, in the order in which they come up: a footnote's number is its place.
    fn reasons(&self) -> Vec<&Unfit> {
        let mut reasons: Vec<&Unfit> = Vec::new();
        let columns = self.columns();
        for why in
            (0..self.cards.len()).flat_map(|card| columns.iter().filter_map(move |column| self.bars(card, column)))
        {
            why.iter().for_each(|why| {
                if !reasons.contains(why) {
                    reasons.push(why)
                }
            });
        }
        reasons
    }

    /// Why a card fits no map of a column; nothing where it fits one.
    fn bars(&self, card: usize, column: &str) -> Option<Vec<&Unfit>> {
        let maps = self.places.iter().filter(|place| place.column == column).count();
        let here = self.unfit.iter().filter(|(number, place, _)| *number == card && self.column(*place) == column);
        let why: Vec<&Unfit> = here.map(|(_, _, why)| why).collect();
        (why.len() == maps).then_some(why)
    }

    /// A cell of the matrix: `17/18`; `-[2]` with the number of the reason where the card fits no map of the column; a dot where it
    /// fits and no seed came to it.
    fn cell(&self, card: usize, column: &str, reasons: &[&Unfit]) -> String {
        let here = |place: usize| self.column(place) == column;
        let tally = Tally::of(self.of_card(card).filter(|(item, _)| here(item.place)).map(|(_, outcome)| outcome));
        if tally.played > 0 {
            return format!("{}/{}", tally.realised, tally.played);
        }
        let Some(bars) = self.bars(card, column) else { return "·".to_owned() };
        let why: BTreeSet<usize> =
            bars.iter().filter_map(|why| reasons.iter().position(|reason| reason == why)).collect();
        let numbers: Vec<String> = why.iter().map(|at| (at + 1).to_string()).collect();
        format!("-[{}]", numbers.join(","))
    }

    fn straight(&self) -> Straight<'_> {
        let mut ways: Vec<(f64, &Item)> =
            self.runs.iter().filter_map(|(item, outcome)| Some((outcome.efficiency?, item))).collect();
        ways.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.card.cmp(&b.1.card)));
        let straight = ways.iter().filter(|(share, _)| *share >= STRAIGHT).count();
        let runs = ways.len();
        ways.retain(|(share, _)| *share < STRAIGHT);
        ways.truncate(WORST);
        Straight { runs, straight, worst: ways }
    }

    /// The sentence about the pairs of a card and a map.
    fn fits(&self) -> String {
        let (pairs, lack) =
            (self.cards.len() * self.places.len(), |(_, _, why): &&(usize, usize, Unfit)| why.lacks_place());
        let fit = pairs - self.unfit.len();
        let there = pairs - self.unfit.iter().filter(lack).count();
        format!(
            "{fit} of {pairs} pairs of a card and a map; {fit} of the {there} whose map has the places that the card needs"
        )
    }

    /// The sentence about the robot's ways.
    fn ways(&self) -> String {
        let Straight { runs, straight, .. } = self.straight();
        format!(
            "{straight} of {runs} ways have an efficiency of {STRAIGHT} or more, {}",
            percent(wilson(straight, runs, Z_95).ok())
        )
    }

    /// The least straight ways, a line each.
    fn worst(&self) -> Vec<String> {
        let named = |(share, item): &(f64, &Item)| {
            format!("{share:.2}  {} on {}, seed {}", self.id(item.card), self.name(item.place), item.seed)
        };
        self.straight().worst.iter().map(named).collect()
    }

    /// Locations that a card was played on.
    fn locations(&self, card: usize) -> Vec<&str> {
        let unfit = |place: &usize| self.unfit.iter().any(|(number, other, _)| *number == card && other == place);
        let mut found: Vec<&str> = Vec::new();
        for place in (0..self.places.len()).filter(|place| !unfit(place)) {
            if !found.contains(&self.column(place)) {
                found.push(self.column(place));
            }
        }
        found
    }
}

/// The lines for a terminal.
pub(super) fn told(played: &Played) -> Vec<String> {
    let mut lines = Vec::new();
    for (number, card) in played.cards.iter().enumerate() {
        let tally = played.tally(number);
        lines.push(format!(
            "{:>3}  {:<26} {:>3}/{:<3}  {:.3}  {:>3} late  robot {:>3}  {}",
            mark(card),
            card.id,
            tally.realised,
            tally.played,
            tally.low(),
            tally.late,
            tally.success,
            played.failed(number, " · ")
        ));
    }
    lines.push(String::new());
    let (columns, reasons) = (played.columns(), played.reasons());
    if columns.len() <= COLUMNS {
        let wide: Vec<usize> = columns.iter().map(|column| column.chars().count().max(8)).collect();
        let row = |head: &str, cells: Vec<String>| {
            let cells = cells.iter().zip(wide.iter().copied());
            let cells: Vec<String> = cells.map(|(cell, wide)| format!("{cell:>wide$}")).collect();
            format!("{head:<31} {}", cells.join("  ")).trim_end().to_owned()
        };
        lines.push(row("", columns.iter().map(|column| (*column).to_owned()).collect()));
        for (number, card) in played.cards.iter().enumerate() {
            let cells = columns.iter().map(|column| played.cell(number, column, &reasons)).collect();
            lines.push(row(&format!("{:>3}  {}", mark(card), card.id), cells));
        }
        lines.extend(reasons.iter().enumerate().map(|(at, why)| format!("[{}] {why}", at + 1)));
    } else {
        lines.push(format!("matrix     {} maps are too wide for a terminal: --out FILE, --format json", columns.len()));
    }
    lines.push(String::new());
    lines.push(format!("fits       {}", played.fits()));
    let pooled = played.pooled();
    lines.push(format!("pooled     {}/{} = {}", pooled.realised, pooled.played, percent(pooled.interval())));
    lines.push(format!("ways       {}", played.ways()));
    lines.extend(played.worst().into_iter().map(|line| format!("           {line}")));
    lines
}

/// The command that makes the tables again.
fn command(options: &RateOptions) -> String {
    let mut words = vec!["socrates scenarios rate".to_owned()];
    words.extend(options.ids.iter().cloned());
    words.push(format!("--seeds {}", options.seeds));
    words.extend(options.locations.iter().map(|name| format!("--location {}", crate::files::shell(name.as_ref()))));
    words.extend(options.worlds.iter().map(|seeds| format!("--random {seeds}")));
    words.extend(options.kinds.iter().map(|kind| format!("--kind {kind}")));
    if options.each {
        words.push("--each".to_owned());
    }
    words.join(" ")
}

/// The tables as Markdown.
pub(super) fn markdown(played: &Played, options: &RateOptions) -> String {
    let mut text = String::from(
        "| | scenario | locations | realised | late | Wilson ≥ | robot succeeds | what failed (seeds) |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let few = |locations: Vec<&str>| match locations.len() {
        0..=COLUMNS => locations.join(", "),
        many => format!("{many} maps"),
    };
    for (number, card) in played.cards.iter().enumerate() {
        let tally = played.tally(number);
        text.push_str(&format!(
            "| {} | {} | {} | {}/{} | {} | {:.3} | {} | {} |\n",
            mark(card),
            card.id,
            few(played.locations(number)),
            tally.realised,
            tally.played,
            tally.late,
            tally.low(),
            tally.success,
            played.failed(number, "; ")
        ));
    }
    let (pooled, columns, reasons) = (played.pooled(), played.columns(), played.reasons());
    text.push_str(&format!(
        "\nPooled: {} of {}, {}. Command: `{}`.\n\n| | scenario | {} |\n|---|---|{}\n",
        pooled.realised,
        pooled.played,
        percent(pooled.interval()),
        command(options),
        columns.join(" | "),
        "---|".repeat(columns.len())
    ));
    for (number, card) in played.cards.iter().enumerate() {
        let cells: Vec<String> = columns.iter().map(|column| played.cell(number, column, &reasons)).collect();
        text.push_str(&format!("| {} | {} | {} |\n", mark(card), card.id, cells.join(" | ")));
    }
    text.push_str("\nRealised of played; `-` with the number of the reason where the card does not fit.\n\n");
    reasons.iter().enumerate().for_each(|(at, why)| text.push_str(&format!("- [{}] {why}\n", at + 1)));
    text.push_str(&format!("\nFits: {}.\n", played.fits()));
    text.push_str(&format!("\nReference robot: {}.\n", played.ways()));
    played.worst().iter().for_each(|line| text.push_str(&format!("- {line}\n")));
    text
}

/// The rows of a card for programs.
fn card_object(played: &Played, number: usize, card: &Card) -> Value {
    let tally = played.tally(number);
    let failures: BTreeMap<&str, Vec<u64>> = played
        .failures(number)
        .into_iter()
        .map(|(why, seeds)| (why, seeds.into_iter().map(|(seed, _)| seed).collect()))
        .collect();
    let verdicts: Vec<Value> = played
        .of_card(number)
        .filter_map(|(item, outcome)| {
            let verdict = outcome.verdict.as_ref()?;
            Some(json!({ "location": played.name(item.place), "seed": item.seed, "verdict": verdict }))
        })
        .collect();
    json!({ "id": card.id, "letter": card.letter, "runs": tally.played, "realised": tally.realised, "late": tally.late,
        "success": tally.success, "wilson_low": tally.low(), "failures": failures, "verdicts": verdicts,
        "locations": played.locations(number) })
}

/// A share for programs.
fn share(interval: Option<Interval>) -> Value {
    interval.map_or(Value::Null, |share| json!({ "share": share.estimate, "low": share.low, "high": share.high }))
}

/// Everything, for programs.
pub(super) fn object(played: &Played) -> Value {
    let rows: Vec<Value> =
        played.cards.iter().enumerate().map(|(number, card)| card_object(played, number, card)).collect();
    let mut matrix: BTreeMap<(usize, usize), Tally> = BTreeMap::new();
    for (item, outcome) in &played.runs {
        let tally = matrix.entry((item.card, item.place)).or_default();
        *tally = Tally { played: tally.played + 1, realised: tally.realised + usize::from(outcome.realised), ..*tally };
    }
    let matrix: Vec<Value> = matrix
        .iter()
        .map(|((card, place), tally)| {
            json!({ "id": played.id(*card), "location": played.name(*place), "column": played.column(*place),
                "runs": tally.played, "realised": tally.realised })
        })
        .collect();
    let unfit: Vec<Value> = played
        .unfit
        .iter()
        .map(|(card, place, why)| {
            json!({ "id": played.id(*card), "location": played.name(*place), "column": played.column(*place),
                "why": why.to_string(), "unfit": why })
        })
        .collect();
    let ways: Vec<Value> = played
        .runs
        .iter()
        .filter_map(|(item, outcome)| {
            let efficiency = outcome.efficiency?;
            Some(json!({ "id": played.id(item.card), "location": played.name(item.place), "seed": item.seed,
                "efficiency": efficiency }))
        })
        .collect();
    let (pooled, straight) = (played.pooled(), played.straight());
    json!({ "scenarios": rows, "runs": pooled.played, "realised": pooled.realised, "pooled": share(pooled.interval()),
        "matrix": matrix, "unfit": unfit, "efficiency": { "runs": straight.runs, "at_least": STRAIGHT, "reached": straight.straight,
            "share": share(wilson(straight.straight, straight.runs, Z_95).ok()), "ways": ways } })
}
