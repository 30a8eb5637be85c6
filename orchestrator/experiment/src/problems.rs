//! What cannot be done of a specification, a line each: key, value, what is allowed.

use std::collections::BTreeSet;
use std::fmt::Display;

use socrates_model::job::Stage;

use crate::draws::LONGEST_MS;
use crate::spec::{AUTHORED, Level, MOST_SCENARIOS, Spec};

/// Cells of one experiment at most.
const MOST_CELLS: usize = 2_000;
/// Scenarios of a batch at most: the orchestrator takes 200 000 open jobs, of which a scenario has six at most.
const MOST_BATCH: u32 = 20_000;
/// Scenarios of an experiment on real processes at most.
const MOST_ON_PROCESSES: u64 = 20_000;
/// Worker processes of an experiment at most.
const MOST_WORKERS: u32 = 64;
/// Tries at a job at most.
const MOST_TRIES: u32 = 20;

/// The specification with everything that it leaves open filled in, so that it says by itself what is done.
///
/// # Errors
/// Everything that is wrong with it, a line each: key, value, what is allowed.
pub fn checked(spec: Spec) -> Result<Spec, Vec<String>> {
    let (spec, mut problems) = spec.filled();
    problems.extend(of(&spec));
    if problems.is_empty() { Ok(spec) } else { Err(problems) }
}

/// Everything that is wrong with it but its policies.
fn of(spec: &Spec) -> Vec<String> {
    let mut found = Found(Vec::new());
    if spec.level == Level::Processes {
        on_processes(spec, &mut found);
    }
    factors(spec, &mut found);
    settings(spec, &mut found);
    for workload in &spec.workload {
        found.name("workload.name", &workload.name);
        let what = format!("workload `{}`: `first_cut`", workload.name);
        found.share_above_zero(&what, workload.first_cut);
        let shares: Vec<f64> = AUTHORED.iter().filter_map(|stage| workload.asks.of(*stage)).collect();
        let fit = shares.iter().all(|share| share.is_finite() && *share >= 0.0);
        if !fit || shares.iter().sum::<f64>() <= 0.0 {
            found.say(format!(
                "workload `{}`: `asks` is {:?}; allowed: numbers from 0 on for proposal, paths or behaviors, one of them above 0",
                workload.name, workload.asks
            ));
        }
    }
    for strike in &spec.fault {
        let shown = strike.shown();
        if !strike.name.is_empty() {
            found.name("fault.name", &strike.name);
        }
        if strike.rates.is_empty() {
            found.say(format!("fault `{shown}`: `rates` is empty; at least one is needed"));
        }
        for rate in &strike.rates {
            found.share(&format!("fault `{shown}`: `rates`"), *rate);
        }
        if strike.kinds.is_empty() && strike.rates.iter().any(|rate| *rate > 0.0) {
            found.say(format!("fault `{shown}`: `kinds` is empty and `rates` are not 0; say what is to strike"));
        }
        found.twice(&format!("fault `{shown}`: `kinds`"), strike.kinds.iter().map(|kind| kind.word()));
        if let Some(to) = strike.to_ms.filter(|to| *to <= strike.from_ms) {
            found.say(format!("fault `{shown}`: `to_ms` is `{to}`; allowed: above `from_ms` = {}", strike.from_ms));
        }
    }
    found.0
}

/// What real processes cannot do, or only in more time than anybody waits.
fn on_processes(spec: &Spec, found: &mut Found) {
    for strike in &spec.fault {
        for kind in &strike.kinds {
            if let Some(why) = kind.lacks_processes() {
                found.say(format!("fault `{}`: `{}` with `level = \"processes\"`: {why}", strike.shown(), kind.word()));
            }
        }
    }
    let all = u64::try_from(spec.count()).unwrap_or(u64::MAX).saturating_mul(u64::from(spec.scenarios));
    if all > MOST_ON_PROCESSES {
        found.say(format!(
            "it asks for {all} scenarios ({} cells of `scenarios` = {}); with `level = \"processes\"` at most {MOST_ON_PROCESSES}",
            spec.count(),
            spec.scenarios
        ));
    }
    let workers: u32 = Stage::WORKERS.into_iter().map(|stage| spec.workers.of(stage).min(MOST_WORKERS + 1)).sum();
    if workers > MOST_WORKERS {
        found.say(format!("`workers` are {workers} processes; with `level = \"processes\"` at most {MOST_WORKERS}"));
    }
}

struct Found(Vec<String>);

impl Found {
    fn say(&mut self, line: String) {
        self.0.push(line);
    }

    fn range<T: PartialOrd + Display>(&mut self, key: &str, value: T, least: T, most: T) {
        if value < least || value > most {
            self.say(format!("`{key}` is `{value}`; allowed: {least} to {most}"));
        }
    }

    fn share(&mut self, what: &str, value: f64) {
        if !(0.0..=1.0).contains(&value) {
            self.say(format!("{what} is `{value}`; allowed: a probability from 0 to 1"));
        }
    }

    fn share_above_zero(&mut self, what: &str, value: f64) {
        if !(value > 0.0 && value <= 1.0) {
            self.say(format!("{what} is `{value}`; allowed: a probability above 0, up to 1"));
        }
    }

    fn name(&mut self, key: &str, value: &str) {
        if value.is_empty() || value.chars().count() > 40 || value.chars().any(char::is_control) {
            self.say(format!("`{key}` is `{}`; allowed: 1 to 40 characters", value.escape_debug()));
        }
    }

    fn twice<'a>(&mut self, what: &str, names: impl Iterator<Item = &'a str>) {
        let mut seen = BTreeSet::new();
        for name in names {
            if !seen.insert(name.to_owned()) {
                self.say(format!("{what} has `{name}` twice"));
            }
        }
    }
}

/// The lists whose product are the cells.
fn factors(spec: &Spec, found: &mut Found) {
    for (key, empty) in [("tries", spec.tries.is_empty()), ("policies", spec.policies.is_empty())] {
        if empty {
            found.say(format!("`{key}` is empty; at least one is needed"));
        }
    }
    for tries in &spec.tries {
        found.range("tries", *tries, 1, MOST_TRIES);
    }
    found.twice("`policies`", spec.policies.iter().map(String::as_str));
    found.twice("`workload`", spec.workload.iter().map(|workload| workload.name.as_str()));
    let shown: Vec<String> = spec.fault.iter().map(crate::spec::Strike::shown).collect();
    found.twice("`fault`", shown.iter().map(String::as_str));
    spec.policies.iter().for_each(|name| found.name("policies", name));
    let cells = spec.count();
    found.range("number of cells", cells, 0, MOST_CELLS);
    let all = u64::try_from(cells).unwrap_or(u64::MAX).saturating_mul(u64::from(spec.scenarios));
    if all > MOST_SCENARIOS {
        found.say(format!(
            "it asks for {all} scenarios ({cells} cells of `scenarios` = {}); at most {MOST_SCENARIOS}",
            spec.scenarios
        ));
    }
}

/// What all cells share.
fn settings(spec: &Spec, found: &mut Found) {
    found.range("scenarios", spec.scenarios, 1, 1_000_000);
    found.range("batch", spec.batch, 1, MOST_BATCH);
    let model = &spec.model;
    for (key, value) in [
        ("fix_if_named", model.fix_if_named),
        ("fix_if_vague", model.fix_if_vague),
        ("collateral", model.collateral),
        ("correlation", model.correlation),
        ("found", model.found),
    ] {
        found.share(&format!("`model.{key}`"), value);
    }
    for stage in Stage::WORKERS {
        found.range(&format!("workers.{stage}"), spec.workers.of(stage), 1, 256);
        if let Some(problem) = spec.durations.of(stage).problem() {
            found.say(format!("`durations.{stage}` is {problem}"));
        }
        for tokens in spec.tokens.of(stage) {
            found.range(&format!("tokens.{stage}"), tokens, 0, 10_000_000);
        }
    }
    found.range("tokens.refused", spec.tokens.refused, 0, 10_000_000);
    let times = &spec.times_ms;
    for (key, value, least) in [
        ("message", times.message, 1),
        ("commit", times.commit, 0),
        ("resend", times.resend, 10),
        ("poll", times.poll, 10),
        ("token", times.token, 1),
        ("restart", times.restart, 1),
        ("down", times.down, 1),
        ("slow", times.slow, 1),
        ("cut", times.cut, 1),
        ("timeout", times.timeout, 1),
        ("retry_after", times.retry_after, 0),
    ] {
        found.range(&format!("times_ms.{key}"), value, least, LONGEST_MS);
    }
}
