//! `watch` and `status`: looking at a making from another process.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use serde_json::json;
use socrates_link::{Bus, LinkError, Overflow, keys};
use socrates_model::RunId;
use socrates_stream::{Sight, Watch};

use crate::bundle;
use crate::exit::{Code, Complaint};
use crate::process::client;
use crate::session;
use crate::supervise::endpoint;
use crate::talk::Talk;

/// Ticks that may wait unread; a minute of a run.
const DEPTH: usize = 6_000;
/// How long nothing may be heard before watching ends.
const PATIENCE: Duration = Duration::from_secs(60);

async fn connect(what: &str) -> Result<Arc<dyn Bus>, Complaint> {
    let (endpoint, namespace) = endpoint(what).ok_or_else(|| {
        Complaint::input(
            format!("nothing is being made in `{what}`"),
            "name the folder of a run that is going on, or an endpoint such as tcp/127.0.0.1:7447@main",
        )
    })?;
    client(&endpoint, &namespace, "watch").await
}

/// Follows one run to its end: every tick, or an exact list of the missing, which are then fetched.
pub(crate) async fn watch(talk: &Talk, what: &str, run: Option<&str>) -> Result<(), Complaint> {
    let bus = connect(what).await?;
    let ours =
        |why: String| Complaint::input(why, "the run may be over; `socrates status` shows it").with_code(Code::Ours);
    let run = match run {
        Some(name) => RunId::new(name)
            .map_err(|bad| Complaint::input(bad.to_string(), "run names look like scenario.planner-seed"))?,
        None => announced(bus.as_ref()).await?,
    };
    let mut watch = Watch::open(bus.clone(), &run, DEPTH).await.map_err(|why| ours(why.to_string()))?;
    let (mut received, mut fetched, mut ticks) = (0_u64, 0_u64, 0_u64);
    let mut gaps: Vec<(u64, u64)> = Vec::new();
    while let Some(sight) = watch.next(PATIENCE).await.map_err(|why| ours(why.to_string()))? {
        match sight {
            Sight::Header(header) => {
                let agents: Vec<String> = header.agents.iter().map(|info| info.agent.to_string()).collect();
                talk.line(&format!(
                    "run        {} · planner {} · seed {} · {}",
                    header.run,
                    header.planner,
                    header.seed,
                    agents.join(", ")
                ));
            }
            Sight::Tick { tick, states } => {
                received += 1;
                ticks = ticks.max(tick + 1);
                if tick % 100 == 0 {
                    let places: Vec<String> = states
                        .iter()
                        .map(|state| format!("{} ({:.2}, {:.2})", state.agent_id(), state.x, state.y))
                        .collect();
                    talk.line(&format!(
                        "{:>7.2} s  {}",
                        socrates_model::SimTime::at_tick(tick).secs(),
                        places.join("  ")
                    ));
                }
            }
            Sight::Missing(range) => {
                gaps.push((range.from, range.to));
                match watch.fetch(range).await {
                    Ok(states) => {
                        let got: std::collections::BTreeSet<u64> = states.iter().map(|state| state.tick).collect();
                        fetched += got.len() as u64;
                        talk.line(&format!(
                            "missed     ticks {} to {}; {} of them fetched",
                            range.from,
                            range.to,
                            got.len()
                        ));
                    }
                    Err(why) => {
                        talk.line(&format!("missed     ticks {} to {}; not fetched: {why}", range.from, range.to))
                    }
                }
            }
            Sight::Event(event) => talk.line(&format!(
                "{:>7.2} s  {}",
                event.time.secs(),
                serde_json::to_string(&event.kind).unwrap_or_default()
            )),
            Sight::End { ticks: all } => {
                ticks = all;
                break;
            }
        }
    }
    let missing: u64 = watch.missing().iter().map(|range| range.to - range.from + 1).sum();
    let lists: Vec<(u64, u64)> = watch.missing().iter().map(|range| (range.from, range.to)).collect();
    bus.close().await;
    talk.line(&format!("end        {ticks} ticks: {received} received, {fetched} fetched, {missing} missing"));
    talk.result(&json!({
        "run": run, "ticks": ticks, "received": received + fetched, "live": received, "fetched": fetched,
        "missing_ticks": missing, "missing": lists, "gaps": gaps,
    }));
    Ok(())
}

/// The first run that is announced, or one that is going on.
async fn announced(bus: &dyn Bus) -> Result<RunId, Complaint> {
    let none = || {
        Complaint::input(
            "no run was announced within a minute",
            "`socrates status` shows how far it is; --run names one",
        )
    };
    let mut metas = bus
        .subscribe(keys::RUNS, 16, Overflow::DropOldest)
        .await
        .map_err(|why| Complaint::input(why.to_string(), "").with_code(Code::Ours))?;
    let name = |key: &str| {
        key.strip_prefix("live/").and_then(|rest| rest.strip_suffix("/meta")).and_then(|name| RunId::new(name).ok())
    };
    let heard = tokio::time::timeout(PATIENCE, async {
        // A run that goes on is known to the orchestrator; one that begins announces itself.
        let mut look = tokio::time::interval(Duration::from_millis(200));
        loop {
            tokio::select! {
                message = metas.next() => return message.and_then(|(key, _)| name(&key)),
                _ = look.tick() => if let Some(run) = going_on(bus).await { return Some(run) },
            }
        }
    });
    heard.await.ok().flatten().ok_or_else(none)
}

async fn going_on(bus: &dyn Bus) -> Option<RunId> {
    let reply = session::status(bus, 0).await.ok()?;
    let jobs = reply.scenarios.iter().flat_map(|scenario| &scenario.jobs);
    let mut leased =
        jobs.filter(|job| job.key.stage == socrates_model::job::Stage::Simulation && job.state == "leased");
    let key = &leased.next()?.key;
    RunId::new(format!("{}.{}", key.scenario, key.item)).ok()
}

/// Shows how the jobs of a folder or endpoint stand.
pub(crate) async fn status(talk: &Talk, what: &str) -> Result<(), Complaint> {
    if endpoint(what).is_none() {
        return finished(talk, what);
    }
    let bus = connect(what).await?;
    let mut from = 0;
    let mut rows = Vec::new();
    let mut first = None;
    loop {
        let reply = session::status(bus.as_ref(), from).await.map_err(|why: LinkError| {
            Complaint::input(format!("the orchestrator does not answer: {why}"), "try again in a moment")
                .with_code(Code::Ours)
        })?;
        if reply.scenarios.is_empty() {
            first = first.or(Some(reply));
            break;
        }
        from += u32::try_from(reply.scenarios.len()).unwrap_or(u32::MAX);
        for scenario in &reply.scenarios {
            let state = if scenario.done { scenario.result.as_str() } else { "going on" };
            talk.line(&format!("{:<28} {state:<14} {}", scenario.id, crate::run::stage_line(scenario)));
            rows.push(json!({ "scenario": scenario.id, "done": scenario.done, "result": scenario.result }));
        }
        first = first.or(Some(reply));
    }
    bus.close().await;
    let (total, done, workers) =
        first.map_or((0, 0, BTreeMap::new()), |reply| (reply.total, reply.done, reply.workers));
    let serving: Vec<String> = workers.iter().map(|(stage, count)| format!("{count} {stage}")).collect();
    talk.line(&format!("done       {done} of {total} · workers: {}", serving.join(", ")));
    talk.result(&json!({ "total": total, "done": done, "workers": workers, "scenarios": rows }));
    Ok(())
}

fn finished(talk: &Talk, what: &str) -> Result<(), Complaint> {
    if let Some(manifest) = bundle::manifest(Path::new(what)) {
        talk.line(&format!("{:<28} {} · finished", manifest.scenario, manifest.verdict));
        talk.result(&json!({ "total": 1, "done": 1, "scenarios": [{ "scenario": manifest.scenario, "done": true, "result": manifest.verdict }] }));
        return Ok(());
    }
    if let Some(library) = crate::library::read(Path::new(what)) {
        for row in &library.scenarios {
            talk.line(&format!("{:<28} {}", row.scenario, row.verdict));
        }
        talk.result(
            &json!({ "total": library.count, "done": library.scenarios.len(), "scenarios": library.scenarios }),
        );
        return Ok(());
    }
    Err(Complaint::input(
        format!("nothing is made, or being made, in `{what}`"),
        "name a bundle, a library, or an endpoint such as tcp/127.0.0.1:7447@main",
    ))
}
