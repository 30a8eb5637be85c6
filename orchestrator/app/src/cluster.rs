//! `cluster submit`: requests handed to a running orchestrator.

use std::path::PathBuf;

use serde_json::json;
use socrates_kit::{Blobs, LocalBlobs};
use socrates_link::rules::Role;
use socrates_model::wire::{Limits, Priority, ScenarioSpec};
use socrates_model::{Digest, FaultCode, Statement};

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::files::shell;
use crate::many::{told_apart, wish};
use crate::order::Order;
use crate::output::Printer;
use crate::prepare::Prepared;
use crate::refused::Refused;
use crate::run::prepared_all;
use crate::run_options::RunOptions;
use crate::wanted::drawn;
use crate::words::plural;
use crate::{calls, process, variants};

/// Problems of requests that are told one by one, at most.
const PROBLEMS: usize = 20;

/// Where scenarios are submitted.
#[derive(Debug, Clone)]
pub struct SubmitOptions {
    /// Endpoint of the orchestrator.
    pub connect: String,
    /// Namespace.
    pub namespace: String,
    /// Name of the batch; without one it is called after what it is made from.
    pub batch: Option<String>,
    /// How urgent it is beside other batches.
    pub priority: Priority,
    /// What it may take.
    pub limits: Limits,
}

/// Submits requests and returns; `socrates status ENDPOINT` shows how they stand, `socrates cluster collect` writes their bundles.
///
/// # Errors
/// No request that can be run, an option that is for runs on this machine, no orchestrator, or one that refuses.
pub async fn submit(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    to: &SubmitOptions,
    options: &RunOptions,
) -> Result<Code, Diagnostic> {
    elsewhere(options)?;
    let (mut prepared, refused) = prepared_all(&config.without_servers(), requests, options)?;
    if !refused.is_empty() {
        Refused::told(talk, &refused, prepared.len())?;
    }
    for one in &prepared {
        by_name(one)?;
        crate::prices::check_cents(config, &one.author, "--max-cents", to.limits.money / 10_000)?;
    }
    told_apart(&mut prepared);
    let (library, _) = wish(&prepared, options);
    let bus = process::client(config, Role::Client, &to.connect, &to.namespace, "submit").await?;
    let folder = tempfile::tempdir_in(&config.program().temp).map_err(|why| ours(why.to_string()))?;
    let blobs = LocalBlobs::new(folder.path(), false);
    let plans = variants::plans(talk, prepared.iter(), options.seed, options.repeats)?;
    let (mut single, mut series) = drawn(&prepared, &plans, config, options, &blobs)?;
    let orders = orders(&prepared, library, &blobs)?;
    let firsts = series.iter_mut().map(|(place, series)| (place, &mut series.first));
    for (place, spec) in single.iter_mut().map(|(place, spec)| (place, spec)).chain(firsts) {
        spec.order = orders.get(*place).map(|(digest, _)| *digest);
    }
    let firsts = series.iter().map(|(_, series)| &series.first);
    let mut digests: Vec<Digest> = single.iter().map(|(_, spec)| spec).chain(firsts).flat_map(inputs).collect();
    digests.extend(orders.iter().flat_map(|(_, order)| order.contents()));
    digests.sort();
    digests.dedup();
    for digest in digests {
        let bytes = blobs.get(&digest).map_err(|why| ours(why.to_string()))?;
        Blobs::Bus
            .put(&bus, bytes, calls::PART)
            .await
            .map_err(|why| ours(format!("an artifact could not be handed over: {why}")))?;
    }
    let many = series.iter().map(|(_, series)| usize::try_from(series.count()).unwrap_or(usize::MAX)).sum::<usize>();
    let count = single.len() + many;
    let batch = to.batch.clone().unwrap_or_else(|| format!("batch-{}", library.short()));
    if !to.limits.are_none() {
        calls::limit(bus.as_ref(), &batch, to.limits).await?;
    }
    let singles = single.into_iter().map(|(_, spec)| spec).collect();
    let mut fresh = calls::submit(bus.as_ref(), &batch, to.priority, singles).await?;
    for (_, series) in series {
        fresh = fresh.saturating_add(calls::submit_series(bus.as_ref(), &batch, to.priority, series).await?);
    }
    bus.close().await;
    talk.line(&format!(
        "submitted  {} from {} as `{batch}`{}",
        plural(count, "scenario"),
        plural(prepared.len(), "request"),
        match count.saturating_sub(usize::try_from(fresh).unwrap_or(usize::MAX)) {
            0 => String::new(),
            known => format!(" · {known} of them were there already"),
        }
    ));
    let problems = problems(&prepared);
    for (name, problem) in problems.iter().take(PROBLEMS) {
        talk.line(&format!("problem    {name}: {problem}"));
    }
    match problems.len().saturating_sub(PROBLEMS) {
        0 => {}
        more => talk.line(&format!("problem    and {more} more; `socrates read REQUEST` shows those of a request")),
    }
    let keys = match config.text(crate::keys::SETTING) {
        folder if folder.is_empty() => String::new(),
        folder => format!(" --keys {}", shell(std::path::Path::new(&folder))),
    };
    talk.line(&format!("next       socrates status {}@{}{keys}", to.connect, to.namespace));
    let named = shell(std::path::Path::new(&batch));
    talk.line(&format!(
        "then       socrates cluster collect --connect {} --batch {named} --out library{keys}",
        to.connect
    ));
    let refusals: Vec<_> = refused.iter().map(Refused::object).collect();
    let problems: Vec<_> =
        problems.iter().map(|(name, problem)| json!({ "request": name, "problem": problem })).collect();
    talk.result(
        &json!({ "submitted": count, "new": fresh, "batch": batch, "refused": refusals, "problems": problems }),
    );
    Ok(if refused.is_empty() { Code::Ok } else { Code::Input })
}

/// Wishes that cannot be played, and what else the reading of a request warns of, each with the name of the request.
fn problems(prepared: &[Prepared]) -> Vec<(&str, String)> {
    let lost = |one: &Prepared| {
        let all = one.reading.statements.iter().filter(|statement| statement.is_missing());
        let text = |statement: &Statement| {
            format!("{} `{}` {}: {}", FaultCode::PRead.code(), statement.quote, statement.fate(), statement.told())
        };
        all.map(text).collect::<Vec<_>>()
    };
    let of = |one: &Prepared| {
        let hard = socrates_model::fault::hard(&one.reading.problems);
        hard.iter().map(ToString::to_string).chain(lost(one)).collect::<Vec<_>>()
    };
    prepared.iter().flat_map(|one| of(one).into_iter().map(|problem| (one.name.as_str(), problem))).collect()
}

/// Refuses options that are for runs on this machine.
fn elsewhere(options: &RunOptions) -> Result<(), Diagnostic> {
    let here = [
        (options.out.is_some(), "--out", "`cluster collect --out` names the folder"),
        (options.ask, "--ask", "nobody looks while a cluster works"),
        (options.view, "--view", "`socrates view ENDPOINT` shows the runs of a cluster"),
        (options.driver.is_some(), "--driver", "start the driver beside the workers; it finds them by the endpoint"),
        (options.workers.is_some(), "--workers", "`cluster work --slots` says how many there are"),
    ];
    match here.into_iter().find(|(named, ..)| *named) {
        Some((_, option, hint)) => {
            Err(Diagnostic::input(format!("`{option}` is for runs on this machine, not for a cluster"), hint))
        }
        None => Ok(()),
    }
}

/// Refuses an author that is a folder: that of a cluster's worker is nothing that a submission may name.
fn by_name(prepared: &Prepared) -> Result<(), Diagnostic> {
    let Some(folder) = prepared.author.folder() else { return Ok(()) };
    Err(Diagnostic::input(
        format!(
            "the request `{}` has the author `{}`, and the workers of a cluster open no folder that a submission names: `{folder}`",
            prepared.name, prepared.author
        ),
        "name an author, such as `--author offline` or `--author openai:MODEL`; `socrates run` records and replays",
    ))
}

/// The order of each request, with the digest of its text.
fn orders(prepared: &[Prepared], library: Digest, blobs: &LocalBlobs) -> Result<Vec<(Digest, Order)>, Diagnostic> {
    let put = |bytes: &[u8]| blobs.put(bytes).map_err(|why| ours(why.to_string()));
    let one = |one: &Prepared| {
        let order = Order::of(one, library, &put)?;
        Ok((put(order.text()?.as_bytes())?, order))
    };
    prepared.iter().map(one).collect()
}

/// What a scenario needs that is stored under its digest.
fn inputs(spec: &ScenarioSpec) -> Vec<Digest> {
    let own = [spec.request, spec.location, spec.reading];
    own.into_iter().chain(spec.pinned.values().copied()).chain(spec.order).collect()
}

fn ours(why: String) -> Diagnostic {
    Diagnostic::input(why, "").with_code(Code::Ours)
}
