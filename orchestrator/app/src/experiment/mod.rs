//! `experiment`: faults at set rates against retry policies, in virtual time or on real processes, as tables and a page.
//!
//! ```text
//! specification ─► cells ─► units ─┬─► simulated, on every core ─┬─► results ─┬─► attempts.csv, scenarios.csv, cells.csv
//!                                  └─► processes, one by one ────┘            ├─► plots/*.svg ─► report.html
//!                                                                             └─► spec.lock.toml, predictions.csv
//! ```

mod chart;
mod heat;
mod page;
mod player;
mod processes;

pub use player::{PlayOptions, play};

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_experiment::beside::{Beside, PREDICTIONS};
use socrates_experiment::heat::heats;
use socrates_experiment::plots::plots;
use socrates_experiment::spec::{Cell, Level};
use socrates_experiment::{CellResult, Figures, Limited, Pairing, Played, Spec, checked, limited, tables, units};
use socrates_model::Digest;
use socrates_stream::csv::joined;

use crate::config::Config;
use crate::cores;
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::machine;
use crate::output::Printer;
use crate::progress::Progress;
use crate::protocol::Door;
use crate::words::plural;

/// Units that are played before their results are added up: enough for every core, few enough to be held.
const ROUND: usize = 64;
/// Cells that are told a line each; more are left to the page.
const TOLD: usize = 40;
/// Where specifications come in.
pub const DOOR: Door = Door {
    what: "experiment",
    shipped: &[
        ("reliability", include_str!("../../../../prompts/protocols/reliability.toml")),
        ("worker-loss", include_str!("../../../../prompts/protocols/worker-loss.toml")),
        ("outages", include_str!("../../../../prompts/protocols/outages.toml")),
        ("processes", include_str!("../../../../prompts/protocols/processes.toml")),
    ],
};

/// Options of `experiment`.
#[derive(Debug, Clone)]
pub struct ExperimentOptions {
    /// Specification: a TOML file, or one that comes with the program: `reliability`, `worker-loss`, `outages`,
    /// `processes`.
    pub spec: PathBuf,
    /// Folder for the tables, the plots, the page and the specification with every value.
    pub out: PathBuf,
    /// Number of scenarios of each cell, instead of those of the specification.
    pub scenarios: Option<u32>,
}

/// Folder below that of the results for job stores and logs of processes, as long as they are needed.
const PROCESSES: &str = "processes";

/// What was played.
struct Done {
    results: Vec<CellResult>,
    /// Lines of `attempts.csv`.
    attempts: Vec<String>,
    attempts_left_out: u64,
}

impl Done {
    fn of(cells: &[Cell]) -> Self {
        Self {
            results: cells.iter().cloned().map(CellResult::of).collect(),
            attempts: vec![tables::ATTEMPTS.to_owned()],
            attempts_left_out: 0,
        }
    }

    /// Adds a unit of a cell.
    fn add(&mut self, cell: usize, played: Played, most_attempts: u64) {
        let Some(result) = self.results.get_mut(cell) else { return };
        let attempts = result.add(played);
        let room = most_attempts.saturating_sub(self.attempts.len() as u64 - 1);
        let room = usize::try_from(room).unwrap_or(usize::MAX).min(attempts.len());
        self.attempts.extend(attempts.iter().take(room).map(|row| joined(tables::attempt(cell, row))));
        self.attempts_left_out += (attempts.len() - room) as u64;
    }
}

/// Plays an experiment and writes what came of it.
///
/// # Errors
/// A specification that cannot be read or done; a folder that cannot be written to; a result that was lost or doubled, or a state
/// that the checker complains of, with a code of its own, after everything is written.
pub async fn experiment(talk: &Printer, config: &Config, options: &ExperimentOptions) -> Result<(), Diagnostic> {
    let spec = load(&options.spec, options.scenarios)?;
    let cells = plural(spec.cells().len(), "cell");
    talk.line(&format!("experiment {}: {cells} of {}", spec.title, plural(spec.scenarios as usize, "scenario")));
    let (done, besides, machine) = match spec.level {
        Level::Simulator => (simulated(talk, &spec), Vec::new(), Vec::new()),
        Level::Processes => {
            let machine = machine::told(&config.program().build);
            machine.iter().for_each(|line| talk.line(line));
            let done = on_processes(talk, config, &spec, &options.out).await?;
            let foretold = simulated(talk, &Spec { level: Level::Simulator, attempt_rows: 0, ..spec.clone() });
            let pairs = done.results.iter().zip(&foretold.results);
            let besides: Vec<Beside> = pairs.map(|(here, there)| Beside::of(here, there)).collect();
            (done, besides, machine)
        }
    };
    let figures: Vec<Figures> = done.results.iter().map(CellResult::figures).collect();
    let pairings: Vec<Option<Pairing>> =
        done.results.iter().map(|one| done.results.get(one.cell.base).and_then(|first| one.beside(first))).collect();
    let means = limited(&done.results);
    let plots = plots(&spec, &done.results, &figures);
    let heats = heats(&done.results);
    let again = format!("socrates experiment {}", files::shell(&options.out.join("spec.lock.toml")));
    let told = page::Told {
        spec: &spec,
        results: &done.results,
        figures: &figures,
        means: &means,
        pairings: &pairings,
        plots: &plots,
        heats: &heats,
        again: &again,
        attempts_left_out: done.attempts_left_out,
        besides: &besides,
        machine: &machine,
    };
    let page = page::html(&told);
    write(&options.out, &told, &done.attempts, &page)?;
    tell(talk, &done.results, &figures);
    talk.line(&format!("look       {}", options.out.join("report.html").display()));
    let object = json!({
        "out": options.out.display().to_string(),
        "cells": done.results.iter().zip(&figures).map(|(one, figures)| object(one, figures)).collect::<Vec<_>>(),
    });
    let bad: Vec<String> = done.results.iter().filter(|one| !one.safety.is_clean()).map(broken).collect();
    if bad.is_empty() {
        talk.result(&object);
        return Ok(());
    }
    let what = format!("{} of {cells} lost or doubled something, or broke a rule", bad.len());
    let hint = "this is a fault of ours: please report it with spec.lock.toml, which does it again";
    Err(Diagnostic { causes: bad, result: Some(Box::new(object)), ..Diagnostic::input(what, hint) }
        .with_code(Code::Unsafe))
}

/// A specification with every default, and so many scenarios of each cell where that is said.
pub fn load(from: &Path, scenarios: Option<u32>) -> Result<Spec, Diagnostic> {
    let mut spec: Spec = DOOR.read(from)?;
    spec.scenarios = scenarios.unwrap_or(spec.scenarios);
    checked(spec).map_err(|problems| DOOR.refused(from, problems))
}

/// Plays every unit on every core in virtual time; results are added up in order, so that nobody can see how many cores there were.
fn simulated(talk: &Printer, spec: &Spec) -> Done {
    let cells = spec.cells();
    let all = units(spec, &cells);
    let mut done = Done::of(&cells);
    let mut progress = Progress::new(*talk, "playing", all.len());
    progress.at(0, "");
    let mut finished = 0;
    for round in all.chunks(ROUND) {
        let one = |number: usize| {
            let unit = round.get(number)?;
            let cell = cells.get(unit.cell)?;
            Some((unit.cell, socrates_experiment::play(spec, cell, unit.batch, &socrates_orchestrator::step)))
        };
        let made = cores::each(round.len(), one, &mut |_| {
            finished += 1;
            progress.at(finished, "");
        });
        for (number, played) in made.into_iter().flatten() {
            done.add(number, played, spec.attempt_rows);
        }
    }
    done
}

/// Plays every unit on processes, one after the other, so that none is measured while another takes its cores.
async fn on_processes(talk: &Printer, config: &Config, spec: &Spec, out: &Path) -> Result<Done, Diagnostic> {
    let root = out.join(PROCESSES);
    let file = root.join("spec.toml");
    files::write(&file, values(spec)?.as_bytes())?;
    let site = processes::Site { config, spec, file: &file, root: &root };
    let cells = spec.cells();
    let all = units(spec, &cells);
    let mut done = Done::of(&cells);
    let mut progress = Progress::new(*talk, "playing", all.len());
    for (finished, unit) in all.iter().enumerate() {
        progress.at(finished, "");
        let Some(cell) = cells.get(unit.cell) else { continue };
        let played = processes::play(&site, cell, unit.batch).await.map_err(|why| processes::about(unit.cell, why))?;
        done.add(unit.cell, played, spec.attempt_rows);
    }
    progress.at(all.len(), "");
    if done.results.iter().all(|one| one.safety.is_clean()) {
        drop(std::fs::remove_dir_all(&root));
    }
    Ok(done)
}

/// The specification as a file.
fn values(spec: &Spec) -> Result<String, Diagnostic> {
    toml::to_string(spec).map_err(|why| {
        Diagnostic::input(format!("the specification cannot be written down again: {why}"), "").with_code(Code::Ours)
    })
}

/// Writes every file; the page last.
fn write(out: &Path, told: &page::Told<'_>, attempts: &[String], page: &str) -> Result<(), Diagnostic> {
    let with_head = |head: &str, lines: Vec<String>| format!("{head}\n{}\n", lines.join("\n"));
    let rows = |one: &CellResult| -> Vec<String> {
        one.scenarios.iter().map(|row| joined(tables::scenario(one.cell.number, row))).collect()
    };
    let scenarios = with_head(tables::SCENARIOS, told.results.iter().flat_map(rows).collect());
    let cells = told.results.iter().zip(told.figures).zip(told.means).zip(told.pairings);
    let cell = |(((one, figures), means), pairing): (((&CellResult, &Figures), &Limited), &Option<Pairing>)| {
        joined(tables::cell(one, figures, means, pairing.as_ref()))
    };
    let cells = with_head(tables::CELLS, cells.map(cell).collect());
    let mut named = vec![("cells.csv", cells), ("scenarios.csv", scenarios)];
    if told.spec.attempt_rows > 0 {
        named.push(("attempts.csv", attempts.join("\n") + "\n"));
    }
    if !told.besides.is_empty() {
        let rows = told.besides.iter().zip(told.results).map(|(beside, one)| joined(beside.row(one))).collect();
        named.push(("predictions.csv", with_head(PREDICTIONS, rows)));
    }
    let lock = lock(told.spec, &named)?;
    named.push(("spec.lock.toml", lock));
    for (name, text) in &named {
        files::write(&out.join(name), text.as_bytes())?;
    }
    for plot in told.plots {
        files::write(&out.join("plots").join(format!("{}.svg", plot.name)), chart::svg(plot).as_bytes())?;
    }
    files::write(&out.join("plots/failures.svg"), heat::svg(told.heats).as_bytes())?;
    files::write(&out.join("report.html"), page.as_bytes())
}

/// The specification with every value, and what came of it by digest.
fn lock(spec: &Spec, tables: &[(&str, String)]) -> Result<String, Diagnostic> {
    let values = values(spec)?;
    let again = match spec.level {
        Level::Simulator => "does it again, byte for byte, with this version",
        Level::Processes => "does it again with the same faults; times are those of the machine",
    };
    let mut text = format!(
        "# Every value of this experiment. `socrates experiment spec.lock.toml` {again}.\n\
         # socrates {}\n# specification {}\n",
        env!("CARGO_PKG_VERSION"),
        Digest::of(values.as_bytes())
    );
    for (name, table) in tables {
        text.push_str(&format!("# {name} {}\n", Digest::of(table.as_bytes())));
    }
    Ok(format!("{text}\n{values}"))
}

/// A line for each cell, where they are few.
fn tell(talk: &Printer, results: &[CellResult], figures: &[Figures]) {
    if results.len() > TOLD {
        return;
    }
    for (one, figures) in results.iter().zip(figures) {
        let (cell, share) = (&one.cell, figures.success);
        let fault = if cell.strike.kinds.is_empty() {
            String::new()
        } else {
            format!("{} {} % · ", cell.strike.shown(), page::percent(cell.rate))
        };
        talk.line(&format!(
            "cell       {:<20} {fault}{} tries · {:<12} {} of {} realised ({:.0}–{:.0} %)",
            cell.workload.name,
            cell.policy.tries(cell.tries),
            cell.policy.name,
            figures.successes,
            one.scenarios.len(),
            100.0 * share.low,
            100.0 * share.high
        ));
    }
}

/// A cell for programs.
fn object(one: &CellResult, figures: &Figures) -> serde_json::Value {
    let cell = &one.cell;
    json!({
        "workload": cell.workload.name, "fault": cell.strike.shown(), "rate": cell.rate, "tries": cell.tries,
        "policy": cell.policy.name, "scenarios": one.scenarios.len(), "realised": figures.successes,
        "first_cut": figures.first_cuts, "attempts": figures.attempts, "jobs": figures.jobs,
        "faults": one.faults.iter().map(|(kind, tally)| (kind.word(), tally)).map(|(word, tally)| {
            json!({ "kind": word, "scheduled": tally.scheduled, "struck": tally.struck })
        }).collect::<Vec<_>>(),
        "lost": one.safety.lost, "doubled": one.safety.doubled, "complaints": one.safety.complaints,
    })
}

/// What is wrong with a cell, in a line.
fn broken(one: &CellResult) -> String {
    let (cell, safety) = (&one.cell, &one.safety);
    format!(
        "cell {} ({}, {} at {}, {} tries, {}): {} lost, {} doubled, {} complaints{}{}",
        cell.number,
        cell.workload.name,
        cell.strike.shown(),
        cell.rate,
        cell.tries,
        cell.policy.name,
        safety.lost,
        safety.doubled,
        safety.complaints,
        if safety.first.is_empty() { "" } else { ": " },
        safety.first
    )
}

#[cfg(test)]
mod tests;
