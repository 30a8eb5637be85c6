//! `evaluate author`: how often an author's scenarios are right at first, after repair, after asking again, and in
//! the run; arm by arm, on the same scenarios.
//!
//! ```text
//! specification ─► cases ─┬─► arm 1: one batch of the whole pipeline ─► outcomes ─┐
//!                         ├─► arm 2: …                                            ┴─► results.csv, report.md
//!                         └─► every injected fault against every check ───────────────► confusion.csv, confusion.md
//! ```

mod confusion;
mod outcome;
mod report;
mod spec;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use socrates_model::{AuthorSpec, Digest};

use crate::bundler::Bundler;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::files;
use crate::keep::Keep;
use crate::output::Printer;
use crate::prepare::{Prepared, prepare_text, scenario_id};
use crate::run_options::RunOptions;
use crate::session::Making;
use crate::wanted::Wanted;
use crate::words::plural;
use outcome::Outcome;
use spec::{Arm, Case, Spec};

/// Options of `evaluate author`.
#[derive(Debug, Clone)]
pub struct AuthorOptions {
    /// Specification: a TOML file, or one that comes with the program: `paper`, `feedback` (what being told the faults is
    /// worth), `faults` (which check finds which injected fault), `arms` (every way of asking one author).
    pub spec: PathBuf,
    /// Folder for `results.csv` and `report.md`, `confusion.csv` and `confusion.md`.
    pub out: PathBuf,
    /// Only the first so many scenarios of every location and kind, for a quick look.
    pub limit: Option<usize>,
    /// Author of every arm of a grid; the one of the specification by default.
    pub author: Option<AuthorSpec>,
    /// Whether the bundles of arm N stay, in `arm-N`, for `labels page`.
    pub bundles: bool,
    /// Worker processes of the simulation stage.
    pub workers: Option<u32>,
}

/// Evaluates.
pub async fn evaluate(talk: &Printer, config: &Config, options: &AuthorOptions) -> Result<(), Diagnostic> {
    let spec = Spec::load(&options.spec)?.with_grid(options.author.as_ref())?;
    let cases = limited(spec.cases(), options.limit);
    talk.line(&format!(
        "evaluation {}: {} an arm, {}",
        spec.title,
        plural(cases.len(), "scenario"),
        plural(spec.arms.len(), "arm")
    ));
    let maker = Maker { talk, config, options, spec: &spec };
    if spec.confusion {
        maker.confusion(&cases).await?;
    }
    if spec.arms.is_empty() {
        talk.result(&json!({ "out": options.out.display().to_string(), "arms": [] }));
        return Ok(());
    }
    // Before the first arm: hours are lost where the last one turns out to have no key.
    for arm in &spec.arms {
        crate::authors::check(&config.clone().with(&flags_of(arm))?, [&arm.author]).await?;
    }
    let mut done: Vec<report::Done<'_>> = Vec::new();
    for (number, arm) in (1..).zip(&spec.arms) {
        let work = options.out.join(".socrates").join(format!("arm-{number}"));
        let bundles = options.bundles.then(|| options.out.join(format!("arm-{number}")));
        let outcomes = maker.run(arm, &cases, &work, bundles.as_deref()).await?;
        let realised = outcomes.iter().filter(|outcome| outcome.realised).count();
        talk.line(&format!("arm        {:<26} {realised} of {} realised", arm.name, outcomes.len()));
        done.push((arm, outcomes));
    }
    let lines = done
        .iter()
        .flat_map(|(arm, outcomes)| cases.iter().zip(outcomes).map(|(case, outcome)| outcome.line(&arm.name, case)));
    let table: Vec<String> = std::iter::once(Outcome::COLUMNS.to_owned()).chain(lines).collect();
    files::write(&options.out.join("results.csv"), (table.join("\n") + "\n").as_bytes())?;
    files::write(&options.out.join("report.md"), report::markdown(&spec, &cases, &done).as_bytes())?;
    drop(std::fs::remove_dir_all(options.out.join(".socrates")));
    talk.line(&format!("look       {}", options.out.join("report.md").display()));
    let arms = done.iter().map(|(arm, outcomes)| {
        let count = |is: fn(&Outcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
        json!({
            "arm": arm.name, "scenarios": outcomes.len(), "first_pass": count(|o| o.first_pass),
            "after_repair": count(|o| o.after_repair), "after_asking": count(|o| o.after_asking),
            "first_run": count(|o| o.first_run), "unaided": count(Outcome::unaided), "realised": count(|o| o.realised),
        })
    });
    talk.result(&json!({ "out": options.out.display().to_string(), "arms": arms.collect::<Vec<_>>() }));
    Ok(())
}

/// The first so many of every request and location.
fn limited(cases: Vec<Case>, limit: Option<usize>) -> Vec<Case> {
    let Some(limit) = limit else { return cases };
    let mut seen: std::collections::BTreeMap<(String, bool), usize> = std::collections::BTreeMap::new();
    let mut keeps = |case: &Case| {
        let count = seen.entry((case.location.clone(), case.guided)).or_default();
        *count += 1;
        *count <= limit
    };
    cases.into_iter().filter(|case| keeps(case)).collect()
}

/// The configuration values of an arm, as flags.
fn flags_of(arm: &Arm) -> Vec<String> {
    let values = [("orchestrator.asks_again", arm.asks_again), ("orchestrator.repairs", arm.repairs)];
    let budgets = values.into_iter().filter_map(|(key, value)| Some(format!("{key}={}", value?)));
    let own = arm.set.iter().map(|(key, value)| match value.as_str() {
        Some(text) => format!("{key}={text}"),
        None => format!("{key}={value}"),
    });
    own.chain(budgets).collect()
}

/// What is the same for every arm.
struct Maker<'a> {
    talk: &'a Printer,
    config: &'a Config,
    options: &'a AuthorOptions,
    spec: &'a Spec,
}

impl Maker<'_> {
    /// Makes every scenario the way of one arm, in one batch of the whole pipeline.
    async fn run(
        &self,
        arm: &Arm,
        cases: &[Case],
        work: &Path,
        bundles: Option<&Path>,
    ) -> Result<Vec<Outcome>, Diagnostic> {
        std::fs::create_dir_all(work).map_err(|why| {
            Diagnostic::input(format!("cannot write into `{}`: {why}", work.display()), "--out chooses another folder")
        })?;
        let own = flags_of(arm);
        let config = self.config.clone().with(&own)?;
        let prepared = cases
            .iter()
            .map(|case| self.prepare(arm, case, &config).map(Arc::new))
            .collect::<Result<Vec<Arc<Prepared>>, _>>()?;
        let wanted = (0_u32..)
            .zip(cases.iter().zip(&prepared))
            .map(|(index, (case, prepared))| {
                let id = scenario_id(&prepared.name, case.seed, index, u32::MAX)?;
                Ok(Wanted { id, index: 0, seed: case.seed, prepared })
            })
            .collect::<Result<Vec<_>, Diagnostic>>()?;
        let options = RunOptions { workers: self.options.workers, ..RunOptions::plain(self.spec.seed) };
        let making = Making { talk: self.talk, config: &config, options: &options, work, wanted: &wanted };
        let mut bundler = bundles.map(|root| Bundler::start(root, work, Keep::Folders, &wanted, &prepared));
        let made = making.all(wanted.len(), bundler.as_mut()).await?;
        if let Some(bundler) = bundler {
            // What could not be made has no bundle; one that could not be written is told.
            for bundled in bundler.finish(self.talk).await?.into_values() {
                bundled?;
            }
        }
        let fetch = |digest: &Digest| made.fetch(digest).ok();
        Ok(made.statuses.iter().map(|status| Outcome::of(status, made.history.of(&status.id), &fetch)).collect())
    }

    /// The table of injected faults, on the offline author's answers.
    async fn confusion(&self, cases: &[Case]) -> Result<(), Diagnostic> {
        let offline = Arm { author: AuthorSpec::Offline, ..Arm::default() };
        let prepared = cases
            .iter()
            .map(|case| Ok((self.prepare(&offline, case, self.config)?, case.seed)))
            .collect::<Result<Vec<_>, Diagnostic>>()?;
        let table = confusion::table(self.talk, &prepared).await;
        let shown = self.options.spec.display().to_string();
        let page = self.options.out.join("confusion.md");
        files::write(&self.options.out.join("confusion.csv"), confusion::csv(&table).as_bytes())?;
        files::write(&page, confusion::markdown(self.spec, &shown, &table).as_bytes())?;
        self.talk.line(&format!("look       {}", page.display()));
        Ok(())
    }

    fn prepare(&self, arm: &Arm, case: &Case, config: &Config) -> Result<Prepared, Diagnostic> {
        let rates = arm.faults_unguided.as_ref().filter(|_| !case.guided).or(arm.faults.as_ref());
        let rates = rates.and_then(|name| self.spec.rates.get(name)).into_iter().flatten();
        let options = RunOptions {
            author: Some(arm.author.clone()),
            inject: rates.map(|(kind, rate)| format!("{kind}={rate}")).collect::<Vec<_>>().join(","),
            ..RunOptions::plain(case.seed)
        };
        let shown = format!("{} at {}", case.request, case.location);
        prepare_text(&case.request, &case.toml, &shown, Path::new("."), Some(&options), config)
    }
}
