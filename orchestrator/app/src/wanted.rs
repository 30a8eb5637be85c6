//! Which scenarios are to be made, and what the orchestrator is told of them.

use std::borrow::Borrow;
use std::collections::BTreeMap;

use socrates_kit::LocalBlobs;
use socrates_model::ScenarioId;
use socrates_model::wire::{ScenarioSpec, Seeds, Series};

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::prepare::{Prepared, scenario_id};
use crate::run_options::RunOptions;
use crate::variants::Plan;

/// One scenario to be made.
#[derive(Debug, Clone)]
pub struct Wanted<'a> {
    /// Its id.
    pub id: ScenarioId,
    /// Which variant of its request it is, 0 the first.
    pub index: u32,
    /// Its seed.
    pub seed: u64,
    /// What it is made from.
    pub prepared: &'a Prepared,
}

/// Every scenario of these requests by its plan, with its id and seed.
pub(crate) fn wanted<'a, P: Borrow<Prepared>>(
    prepared: &'a [P],
    seed: u64,
    plans: &[Plan],
) -> Result<Vec<Wanted<'a>>, Diagnostic> {
    let mut wanted = Vec::new();
    for (one, plan) in prepared.iter().zip(plans) {
        let one: &Prepared = one.borrow();
        for (index, own) in (0..one.request.run.variants).zip(&plan.seeds) {
            let id = scenario_id(&one.name, seed, index, one.request.run.variants)?;
            wanted.push(Wanted { id, index, seed: *own, prepared: one });
        }
    }
    Ok(wanted)
}

/// Stores the inputs of scenarios and names them. Those that are made from one request differ by name and seed alone.
pub(crate) fn specs<'a>(
    wanted: &[Wanted<'a>],
    config: &Config,
    options: &RunOptions,
    blobs: &LocalBlobs,
) -> Result<Vec<ScenarioSpec>, Diagnostic> {
    let mut known: Vec<(&'a Prepared, ScenarioSpec)> = Vec::new();
    let mut of = |want: &Wanted<'a>| {
        if let Some((_, alike)) = known.iter().find(|(prepared, _)| std::ptr::eq(*prepared, want.prepared)) {
            return Ok(ScenarioSpec { id: want.id.clone(), seed: want.seed, ..alike.clone() });
        }
        let spec = spec(want, config, options, blobs)?;
        known.push((want.prepared, spec.clone()));
        Ok(spec)
    };
    wanted.iter().map(&mut of).collect()
}

/// Scenarios of a request that are submitted one by one, at most; more of them are a series.
const ONE_BY_ONE: usize = 16;
/// Seeds of one series at most, so that it fits a message.
const SEEDS: usize = 4_000;

/// Every scenario of these requests by its plan: where they are few, one by one, else as series of those that differ by name and seed alone.
/// With the place of the request that each is made from. The inputs are stored.
#[expect(clippy::type_complexity, reason = "two lists of the same kind")]
pub(crate) fn drawn(
    prepared: &[Prepared],
    plans: &[Plan],
    config: &Config,
    options: &RunOptions,
    blobs: &LocalBlobs,
) -> Result<(Vec<(usize, ScenarioSpec)>, Vec<(usize, Series)>), Diagnostic> {
    let (mut single, mut series) = (Vec::new(), Vec::new());
    for (place, (one, plan)) in prepared.iter().zip(plans).enumerate() {
        let named = |index: u32| scenario_id(&one.name, options.seed, index, one.request.run.variants);
        let Some(seed) = plan.seeds.first() else { continue };
        let first = spec(&Wanted { id: named(0)?, index: 0, seed: *seed, prepared: one }, config, options, blobs)?;
        let at_once = if plan.seeds.len() > ONE_BY_ONE { SEEDS } else { 1 };
        let mut index = 0;
        for seeds in plan.seeds.chunks(at_once) {
            let Some(seed) = seeds.first() else { continue };
            let first = ScenarioSpec { id: named(index)?, seed: *seed, ..first.clone() };
            index = index.saturating_add(u32::try_from(seeds.len()).unwrap_or(u32::MAX));
            if at_once == 1 {
                single.push((place, first));
            } else {
                series.push((place, Series { first, seeds: Seeds::Listed(seeds.to_vec()) }));
            }
        }
    }
    Ok((single, series))
}

/// Stores the inputs of a scenario and names them.
fn spec(
    want: &Wanted<'_>,
    config: &Config,
    options: &RunOptions,
    blobs: &LocalBlobs,
) -> Result<ScenarioSpec, Diagnostic> {
    let prepared = want.prepared;
    let put = |text: String| {
        blobs.put(text.as_bytes()).map_err(|why| {
            Diagnostic::input(format!("cannot store an artifact: {why}"), "--out chooses another folder")
        })
    };
    let json = |value: Result<String, serde_json::Error>| value.map_err(|why| Diagnostic::resumes(why.to_string()));
    let mut settings =
        BTreeMap::from([("author".to_owned(), prepared.author.to_string()), ("pace".to_owned(), options.pace.clone())]);
    settings.extend(prepared.injected.clone());
    if prepared.is_driven() {
        settings.insert("drive".to_owned(), config.text("simulation.drive"));
        settings.insert("drive_patience_s".to_owned(), config.number("simulation.drive_patience_s").to_string());
    }
    settings.extend(prepared.style.clone());
    if config.text("stream.live") != "off" {
        settings.insert("live".to_owned(), "on".to_owned());
    }
    let mut pinned = BTreeMap::new();
    for (role, text) in &prepared.pins {
        pinned.insert(*role, put(text.clone())?);
    }
    Ok(ScenarioSpec {
        id: want.id.clone(),
        request: put(json(serde_json::to_string(&prepared.request))?)?,
        location: put(json(serde_json::to_string(&prepared.location))?)?,
        reading: put(json(serde_json::to_string(&prepared.reading))?)?,
        seed: want.seed,
        planners: prepared.request.robot.planners.clone(),
        run_seeds: prepared.request.run.seeds().to_vec(),
        pinned,
        settings,
        review: prepared.looked_at,
        order: None,
    })
}
