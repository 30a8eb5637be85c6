//! `run --dry-run`: what a run would make, and about what that takes. Nothing is written, and no model is asked.
//!
//! ```text
//! requests ─► plan of variants ─► scenarios and runs ─► jobs a stage ─► CPU, disk, calls and tokens, by what was measured
//! ```

mod measured;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_model::job::Stage;
use socrates_model::wire::ScenarioSpec;
use socrates_model::{AuthorSpec, Digest, PlannerName};
use socrates_orchestrator::{pipeline, price_of};
use socrates_prompts::Style;

use self::measured::{Disk, Past};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::keep::Keep;
use crate::kept::Lines;
use crate::output::Printer;
use crate::place::{self, Place, WORK};
use crate::prepare::Prepared;
use crate::refused::Refused;
use crate::run_options::RunOptions;
use crate::wanted::{Wanted, wanted};
use crate::words::plural;
use crate::{bundle, expected_tokens, keep, many, prices, variants};

/// Stages in the order in which they are told.
const STAGES: [Stage; 6] =
    [Stage::Proposal, Stage::Paths, Stage::Behaviors, Stage::Review, Stage::Simulation, Stage::Scoring];

/// Where it would be made.
#[derive(Debug)]
struct Goes {
    folder: PathBuf,
    /// Whether it is finished already.
    finished: bool,
    keep: Keep,
}

/// What would be asked of a model.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Asked {
    calls: u64,
    input: u64,
    output: u64,
}

/// Says what a run of these requests would make.
///
/// # Errors
/// Requests none of which can be run, a library that was begun otherwise, or a table of prices that cannot be read.
pub(crate) async fn tell(
    talk: &Printer,
    config: &Config,
    options: &RunOptions,
    mut prepared: Vec<Prepared>,
    refused: &[Refused],
) -> Result<Code, Diagnostic> {
    talk.line("dry run    nothing is written, no model is asked");
    if !refused.is_empty() {
        Refused::told(talk, refused, prepared.len())?;
    }
    many::told_apart(&mut prepared);
    let plans = variants::plans(talk, prepared.iter(), options.seed, options.repeats)?;
    let asked_for: u64 = prepared.iter().map(|one| u64::from(one.request.run.variants)).sum();
    let all = wanted(&prepared, options.seed, &plans)?;
    let (whole, alone) = (all.len(), asked_for == 1 && options.shard.is_none());
    let wanted = many::shared(talk, options.shard, all);
    let goes = goes(options, &prepared, whole, alone)?;
    let open: Vec<&Wanted<'_>> = wanted.iter().filter(|one| !goes.finished && !lies(&goes.folder, one)).collect();
    let there = wanted.len() - open.len();
    let beside = goes.folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let past = Past::of(&[goes.folder.as_path(), beside]);
    let jobs = jobs(&open);
    let seconds: f64 = open.iter().map(|one| past.cpu_s(&runs(one))).sum();
    let disk = open.iter().fold(Disk::default(), |sum, one| sum.and(Disk::of(goes.keep, runs(one).len())));
    let models = asked(&open).await?;

    let known =
        plans.iter().all(|plan| plan.known.is_some()) || asked_for == u64::try_from(prepared.len()).unwrap_or(0);
    let lost = asked_for.saturating_sub(u64::try_from(whole).unwrap_or(u64::MAX));
    let differ = match (known, lost) {
        (false, _) => " · which of them repeat another is known when they are made".to_owned(),
        (true, 0) => String::new(),
        (true, lost) => format!(" · {lost} of the {asked_for} asked for would repeat another"),
    };
    talk.line(&format!("scenarios  {} from {}{differ}", wanted.len(), plural(prepared.len(), "request")));
    talk.line(&format!("goes to    {}", told_place(&goes, there, wanted.len())));
    let total: u64 = jobs.values().sum();
    let each: Vec<String> = jobs.iter().map(|(stage, count)| format!("{count} {stage}")).collect();
    talk.line(&format!("jobs       {total} · {}", if each.is_empty() { "none".to_owned() } else { each.join(" · ") }));
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    talk.line(&format!("CPU        {} · {}", told_time(seconds, cores), past.source()));
    talk.line(&format!("disk       {}", disk.told(goes.keep)));
    for (author, asked) in &models {
        talk.line(&format!("author     {}", told_author(config, author, *asked)?));
    }
    if !goes.finished {
        talk.line("next       the same command without --dry-run makes it");
    }
    let models: BTreeMap<String, _> = models
        .iter()
        .map(|(author, asked)| {
            let Asked { calls, input, output } = asked;
            (author.clone(), json!({ "calls": calls, "tokens_in": input, "tokens_out": output }))
        })
        .collect();
    talk.result(&json!({
        "dry_run": true, "scenarios": wanted.len(), "asked_for": asked_for, "known_to_differ": known, "there": there, "folder": goes.folder,
        "keep": goes.keep.name(), "jobs": jobs.iter().map(|(stage, count)| (stage.name(), *count)).collect::<BTreeMap<_, _>>(),
        "cpu_h": seconds / 3600.0, "kept_gb": disk.kept_gb(), "files": disk.files(), "while_made_gb": disk.work_gb(),
        "measured_runs": past.runs(), "authors": models, "refused": refused.iter().map(Refused::object).collect::<Vec<_>>(),
    }));
    Ok(if refused.is_empty() { Code::Ok } else { Code::Input })
}

/// Where it goes, and what is kept there.
fn goes(options: &RunOptions, prepared: &[Prepared], scenarios: usize, alone: bool) -> Result<Goes, Diagnostic> {
    let driven = prepared.iter().any(Prepared::is_driven);
    let (base, wish) = match prepared.first() {
        Some(one) if alone => {
            let own = || PathBuf::from("runs").join(format!("{}-{}", one.name, options.seed));
            (options.out.clone().unwrap_or_else(own), bundle::wish(one, options.seed))
        }
        _ => (many::base(options), many::wish(prepared, options).0),
    };
    let (folder, finished) = match place::place(&base, wish, driven) {
        Place::Finished(folder) => (folder, true),
        Place::New(folder) => (folder, false),
    };
    let fixed = keep::agreed(&folder, place::fixed(&folder), options.keep)?;
    let otherwise = if alone { Keep::Folders } else { Keep::of(scenarios) };
    Ok(Goes { folder, finished, keep: fixed.unwrap_or(otherwise) })
}

/// Whether a scenario of a library that was begun is there.
fn lies(folder: &Path, one: &Wanted<'_>) -> bool {
    bundle::lies_in(&folder.join(one.id.as_str()), one.prepared, one.seed) || Lines::of(&folder.join(WORK)).has(&one.id)
}

fn told_place(goes: &Goes, there: usize, all: usize) -> String {
    let folder = goes.folder.display();
    if goes.finished {
        return format!("{folder}, which was made from these requests: nothing to do");
    }
    let begun = if there > 0 { format!(" · {there} of {all} lie there already") } else { String::new() };
    format!("{folder} · --keep {}{begun}", goes.keep.name())
}

/// The scenario as it would be submitted, as far as its jobs depend on it.
fn spec(one: &Wanted<'_>) -> ScenarioSpec {
    let (prepared, none) = (one.prepared, Digest::of(b""));
    ScenarioSpec {
        id: one.id.clone(),
        request: none,
        location: none,
        reading: none,
        seed: one.seed,
        planners: prepared.request.robot.planners.clone(),
        run_seeds: prepared.request.run.seeds().to_vec(),
        pinned: prepared.pins.keys().map(|role| (*role, none)).collect(),
        settings: BTreeMap::new(),
        review: prepared.looked_at,
        order: None,
    }
}

/// Planners of the runs of a scenario.
fn runs(one: &Wanted<'_>) -> Vec<PlannerName> {
    pipeline::runs(&spec(one)).into_iter().map(|run| run.planner).collect()
}

/// Jobs by stage, those of no number left out: what is made when every first attempt is taken.
fn jobs(open: &[&Wanted<'_>]) -> BTreeMap<Stage, u64> {
    let mut jobs: BTreeMap<Stage, u64> = BTreeMap::new();
    for one in open {
        let spec = spec(one);
        pipeline::authored(&spec).into_iter().for_each(|(stage, _)| *jobs.entry(stage).or_default() += 1);
        let runs = u64::try_from(pipeline::runs(&spec).len()).unwrap_or(0);
        for stage in [Stage::Simulation, Stage::Scoring] {
            *jobs.entry(stage).or_default() += runs;
        }
    }
    STAGES.into_iter().filter_map(|stage| Some((stage, *jobs.get(&stage)?))).collect()
}

/// What each author is asked, rules nothing.
async fn asked(open: &[&Wanted<'_>]) -> Result<BTreeMap<String, Asked>, Diagnostic> {
    let mut requests: Vec<(&Prepared, Vec<&Wanted<'_>>)> = Vec::new();
    for one in open {
        match requests.iter_mut().find(|(prepared, _)| std::ptr::eq(*prepared, one.prepared)) {
            Some((_, all)) => all.push(one),
            None => requests.push((one.prepared, vec![one])),
        }
    }
    let mut models: BTreeMap<String, Asked> = BTreeMap::new();
    for (prepared, all) in requests {
        let sum = models.entry(prepared.author.to_string()).or_default();
        if prepared.author == AuthorSpec::Offline {
            continue;
        }
        let style = Style::from_settings(&prepared.style)
            .map_err(|bad| Diagnostic::input(bad.to_string(), "`socrates config prompt` shows the style"))?;
        let expected =
            expected_tokens::expected(&prepared.request, &prepared.reading, &prepared.location, &style).await?;
        let stages: Vec<Stage> =
            all.first().map(|one| pipeline::authored(&spec(one))).into_iter().flatten().map(|job| job.0).collect();
        let scenarios = u64::try_from(all.len()).unwrap_or(u64::MAX);
        for (_, [input, output]) in expected.iter().filter(|(stage, _)| stages.contains(stage)) {
            sum.calls += scenarios;
            sum.input += scenarios.saturating_mul(*input);
            sum.output += scenarios.saturating_mul(*output);
        }
    }
    Ok(models)
}

fn told_author(config: &Config, author: &str, asked: Asked) -> Result<String, Diagnostic> {
    let Asked { calls, input, output } = asked;
    if author == AuthorSpec::Offline.to_string() {
        return Ok("offline: rules, no call of a model".to_owned());
    }
    let named = config.text("author.prices");
    let table = if named.is_empty() { BTreeMap::new() } else { prices::read_prices(Path::new(&named))? };
    #[expect(clippy::cast_precision_loss, reason = "sums of tokens stay far below 2^53")]
    let cost = price_of(&table, author).map_or_else(String::new, |price| {
        format!(" · {:.2} {}", (input as f64 * price.input + output as f64 * price.output) / 1e6, price.currency)
    });
    Ok(format!(
        "{author}: {} · {} tokens in, {} out{cost}, when every first answer is taken; one that is refused is asked again. Tokens are \
         estimated by bytes, answers as long as the offline author's",
        plural(usize::try_from(calls).unwrap_or(usize::MAX), "call"),
        thousands(input),
        thousands(output)
    ))
}

/// `1.2 million`, `34 thousand`, `560`.
fn thousands(number: u64) -> String {
    #[expect(clippy::cast_precision_loss, reason = "shown with two digits")]
    let value = number as f64;
    match number {
        0..1_000 => number.to_string(),
        1_000..1_000_000 => format!("{:.0} thousand", value / 1e3),
        _ => format!("{:.1} million", value / 1e6),
    }
}

/// `4 min of one core · about 2 min on the 2 cores of this machine`.
fn told_time(seconds: f64, cores: usize) -> String {
    #[expect(clippy::cast_precision_loss, reason = "a few cores")]
    let wall = seconds / (cores as f64 * measured::BUSY);
    let told = |s: f64| match s {
        s if s < 9.5 => format!("{s:.1} s"),
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5_400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3_600.0),
    };
    format!("{} of one core · about {} on the {cores} cores of this machine", told(seconds), told(wall))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_numbers_are_told_in_units_that_fit() {
        assert!(
            told_time(360.0, 2).starts_with("6 min of one core · about 3 min on the 2 cores"),
            "{}",
            told_time(360.0, 2)
        );
        assert!(told_time(72_000.0, 1).starts_with("20.0 h of one core"));
        assert_eq!([560, 34_200, 1_230_000].map(thousands), ["560", "34 thousand", "1.2 million"]);
    }
}
