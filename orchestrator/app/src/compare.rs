//! `compare`: planners over the same scenarios and seeds, as tables, a page and a film.
//!
//! ```text
//! requests ─► a library of runs ─┐
//! folders of bundles ────────────┴─► reports ─► socrates_scoring::compare ─► CSV, LaTeX
//!                                └─► recordings, a scenario at a time ────► the page
//! ```

mod found;
mod page;

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_model::PlannerName;
use socrates_scoring::compare::{CompareFault, Comparison, Entry, compare as compared, enough, runs_csv, under_test};

use self::found::{Found, FoundScenario};
use self::page::Rows;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::run_options::RunOptions;
use crate::video::{self, Labels, VideoOptions};
use crate::{batch, bundle, files, run};

/// Planners of the paper's case study, compared where nothing else is asked for (Marpally et al. 2024).
const CASE_STUDY: [&str; 3] = ["socrates_mppi", "ha_mppi", "nav2can"];
/// Folder of the runs, in that of the comparison.
const RUNS: &str = "scenarios";
/// The page.
const PAGE: &str = "compare.html";
/// One row per run.
const TABLE: &str = "compare.csv";
/// One row per metric and planner.
const DIFFERENCES: &str = "differences.csv";
/// The figures for a paper.
const LATEX: &str = "compare.tex";

/// Options of `compare`.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// Request files and folders of them, or bundles and folders of them.
    pub what: Vec<PathBuf>,
    /// What requests are run with; `out` is the folder of the comparison, by default `runs/compare-SEED`.
    pub run: RunOptions,
    /// The planner that the others are compared with; by default the first.
    pub against: Option<PlannerName>,
    /// Film of the first scenario and seed, side by side.
    pub film: Option<PathBuf>,
    /// Whether the film calls the planners robot A, robot B, and so on.
    pub opaque: bool,
}

/// Compares planners.
///
/// # Errors
/// Requests that cannot be run, folders without bundles, planners without runs in common, files that cannot be written.
pub async fn compare(talk: &Printer, config: &Config, options: &CompareOptions) -> Result<Code, Diagnostic> {
    let kept: Vec<bool> = options.what.iter().map(|what| holds_bundles(what)).collect();
    let default = || PathBuf::from("runs").join(format!("compare-{}", options.run.seed));
    let out = options.run.out.clone().unwrap_or_else(default);
    if kept.iter().all(|kept| *kept) {
        let (found, planners) = (found::read(&options.what)?, options.run.planner.clone());
        return write(talk, config, options, &out, &found, planners);
    }
    if let Some((what, _)) = options.what.iter().zip(&kept).find(|(_, kept)| **kept) {
        return Err(Diagnostic::input(
            format!("`{}` holds bundles, and something else that is named is to be run", what.display()),
            "run the requests first, then name all folders of bundles together",
        ));
    }
    let named = match options.run.planner.as_slice() {
        [] => CASE_STUDY.iter().filter_map(|name| PlannerName::new(*name).ok()).collect(),
        named => named.to_vec(),
    };
    let planners = tested(&named, options.against.as_ref());
    // Before anything is run.
    enough(&planners).map_err(|why| refused(&why))?;
    // The run without a robot tells whose doing it is that a scenario does not come about.
    let with_twin = planners.iter().cloned().chain([PlannerName::no_robot()]).collect();
    let run_options = RunOptions { out: Some(out.join(RUNS)), planner: with_twin, ..options.run.clone() };
    let made = run::library(talk, config, &options.what, &run_options).await?;
    let code = write(talk, config, options, &out, &found::read(&[made.root])?, planners)?;
    Ok(if made.code == Code::Input { made.code } else { code })
}

/// The planners that are named, each once, the one that the others are compared with first.
fn tested(named: &[PlannerName], against: Option<&PlannerName>) -> Vec<PlannerName> {
    let mut planners: Vec<PlannerName> = Vec::new();
    for planner in against.into_iter().chain(named).filter(|planner| !planner.is_no_robot()) {
        if !planners.contains(planner) {
            planners.push(planner.clone());
        }
    }
    planners
}

/// Whether this is a bundle or a folder of bundles.
fn holds_bundles(what: &Path) -> bool {
    bundle::is_bundle(what) || what.is_dir() && batch::bundles(what).is_ok_and(|names| !names.is_empty())
}

/// Writes tables, page and film, and tells what they say.
fn write(
    talk: &Printer,
    config: &Config,
    options: &CompareOptions,
    out: &Path,
    found: &Found,
    planners: Vec<PlannerName>,
) -> Result<Code, Diagnostic> {
    let entries: Vec<Entry<'_>> = found.scenarios.iter().flat_map(FoundScenario::entries).collect();
    let planners = if planners.is_empty() { under_test(&entries) } else { planners };
    let planners = tested(&planners, options.against.as_ref());
    let comparison = compared(&entries, &planners).map_err(|why| refused(&why))?;
    files::write(&out.join(TABLE), runs_csv(&entries).as_bytes())?;
    files::write(&out.join(DIFFERENCES), comparison.differences_csv().as_bytes())?;
    files::write(&out.join(LATEX), comparison.latex().as_bytes())?;
    let rows = Rows::of(&comparison);
    let left_out = page::write(talk, &out.join(PAGE), found, &comparison, &rows)?;
    tell(talk, found, &comparison, &rows);
    if let Some(film) = &options.film {
        self::film(talk, config, options, film, found, &planners)?;
    }
    talk.line(&format!("table      {}", out.join(TABLE).display()));
    talk.line(&format!("paper      {}", out.join(LATEX).display()));
    talk.line(&format!("look       {}", out.join(PAGE).display()));
    talk.result(&json!({
        "page": out.join(PAGE).display().to_string(), "table": out.join(TABLE).display().to_string(),
        "planners": comparison.planners, "scenarios": comparison.scenarios, "common": comparison.common,
        "basis": comparison.basis(), "outcomes": rows.planners, "figures": rows.metrics,
        "left_out": found.left_out, "not_played": left_out,
    }));
    Ok(Code::Ok)
}

/// Why there is no comparison, with what helps.
fn refused(why: &CompareFault) -> Diagnostic {
    let hint = match why {
        CompareFault::Few { .. } => "name several planners: --planner socrates_mppi,nav2can",
        CompareFault::Unknown { .. } => {
            "name planners that were run, or run the requests with it: compare REQUEST --planner …"
        }
        CompareFault::Apart { .. } => {
            "run the same requests with the same seeds: compare REQUEST --planner A,B --seeds 1..20"
        }
        CompareFault::Unlike(why) => why.hint(),
    };
    Diagnostic::input(why.to_string(), hint)
}

/// Prints what became of the runs and the figures that differ.
fn tell(talk: &Printer, found: &Found, comparison: &Comparison, rows: &Rows) {
    for (name, why) in &found.left_out {
        talk.warn(&format!("left out   {name}: {why}"));
    }
    talk.line(&format!("compared   {}", comparison.basis()));
    for row in &rows.planners {
        let parts = row.parts.iter().filter(|part| part.count > 0).map(|part| format!("{} {}", part.count, part.words));
        talk.line(&format!("planner    {}: {} runs · {}", row.name, row.runs, parts.collect::<Vec<_>>().join(" · ")));
    }
    let against = comparison.planners.first().map_or("", PlannerName::as_str);
    for row in &comparison.rows {
        let others = comparison.planners.iter().skip(1).zip(&row.differences);
        let clear: Vec<String> = others
            .filter(|(_, difference)| difference.is_clear())
            .map(|(planner, difference)| {
                let (low, high) = difference.interval.unwrap_or_default();
                let unit = row.metric.unit_shown().map_or_else(String::new, |unit| format!(" {unit}"));
                format!("{planner} {:+.2} [{low:+.2}, {high:+.2}]{unit}", difference.estimate)
            })
            .collect();
        if !clear.is_empty() {
            let of = if row.runs < comparison.common {
                format!(" · {} of {} runs", row.runs, comparison.common)
            } else {
                String::new()
            };
            talk.line(&format!("differs    {} from {against}: {}{of}", row.metric.id, clear.join(" · ")));
        }
    }
}

/// Films the first scenario and seed that all planners have a result of.
fn film(
    talk: &Printer,
    config: &Config,
    options: &CompareOptions,
    film: &Path,
    found: &Found,
    planners: &[PlannerName],
) -> Result<(), Diagnostic> {
    let shown: Vec<PlannerName> = planners.iter().take(socrates_draw::film::PANELS).cloned().collect();
    let filmed = found.scenarios.iter().find_map(|scenario| Some((scenario, scenario.seeds(&shown).next()?)));
    let (scenario, seed) = filmed.ok_or_else(|| {
        Diagnostic::input(
            "there is nothing to film: no scenario and seed has a result with every planner",
            "leave --film out",
        )
    })?;
    let labels = if options.opaque { Labels::Opaque } else { Labels::On };
    let run = shown.into_iter().map(|planner| socrates_model::Run { planner, seed }).collect();
    let video = VideoOptions {
        bundle: scenario.dir.clone(),
        out: Some(film.to_path_buf()),
        labels,
        run,
        speed: "auto".to_owned(),
        size: None,
        from: None,
    };
    video::film(talk, config, &video).map(|_told| ())
}
