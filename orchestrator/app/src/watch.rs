//! `watch`: looking at a run that is being made from another process. For programs: one JSON object a line.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use serde_json::{Value, json};
use socrates_link::rules::Role;
use socrates_link::{Bus, Overflow, keys};
use socrates_model::wire::StatusAsk;
use socrates_model::{AgentState, EventKind, JobState, RunId, SimTime};
use socrates_stream::{Sight, TickRange, Watch};

use crate::calls;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::{Format, Printer};
use crate::process::client;
use crate::supervise::endpoint;

/// Messages of up to ten ticks that may wait unread; a minute of a run.
const DEPTH: usize = 600;
/// Ticks that are fetched at a time.
const FETCH_TICKS: u64 = 200;
/// How long a run is waited for that nobody has announced.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long nothing may be heard of a run before watching ends: a run that goes on tells something a hundred times a second.
const SILENCE: Duration = Duration::from_secs(10);
/// Runs that are asked what they are, at most.
const RUNS_ASKED: usize = 64;
/// The same once the run itself has said that it ends.
const LAST_WORDS: Duration = Duration::from_secs(2);

async fn connect(config: &Config, what: &str) -> Result<Arc<dyn Bus>, Diagnostic> {
    let (endpoint, namespace) = endpoint(what).ok_or_else(|| {
        Diagnostic::input(
            format!("nothing is being made in `{what}`"),
            "name the folder of a run that is going on, or an endpoint such as tcp/127.0.0.1:7447@main",
        )
    })?;
    client(config, Role::Viewer, &endpoint, &namespace, "watch").await
}

/// Follows one run to its end: every tick, or an exact list of the missing, which are then fetched.
pub async fn watch(talk: &Printer, config: &Config, what: &str, run: Option<&str>) -> Result<(), Diagnostic> {
    let bus = connect(config, what).await?;
    let ours =
        |why: String| Diagnostic::input(why, "the run may be over; `socrates status` shows it").with_code(Code::Ours);
    let run = match run {
        Some(name) => RunId::new(name)
            .map_err(|bad| Diagnostic::input(bad.to_string(), "run names look like scenario.planner-seed"))?,
        None => announced(bus.as_ref()).await?,
    };
    let mut watch = Watch::open(bus.clone(), &run, DEPTH).await.map_err(|why| ours(why.to_string()))?;
    let (mut received, mut fetched, mut ticks) = (0_u64, 0_u64, 0_u64);
    let mut gaps: Vec<(u64, u64)> = Vec::new();
    let (mut patience, mut ended) = (SILENCE, false);
    while let Some(sight) = watch.next(patience).await.map_err(|why| ours(why.to_string()))? {
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
                talk.result(&json!({ "type": "run", "run": header.run, "planner": header.planner, "seed": header.seed, "agents": agents }));
            }
            Sight::Tick { tick, states } => {
                received += 1;
                ticks = ticks.max(tick + 1);
                shown(talk, tick, &states, tick % 100 == 0);
            }
            Sight::Missing(range) => {
                gaps.push((range.from, range.to));
                fetched += made_good(talk, &mut watch, range).await;
            }
            Sight::Event(event) => {
                if matches!(event.kind, EventKind::End { .. }) {
                    patience = LAST_WORDS;
                }
                if let Some(words) = words(&event.kind) {
                    talk.line(&format!("{:>7.2} s  {words}", event.time.secs()));
                }
                talk.result(&json!({ "type": "event", "t": event.time.secs(), "event": event.kind }));
            }
            Sight::End { ticks: all, .. } => {
                (ticks, ended) = (all, true);
                break;
            }
        }
    }
    if !ended {
        talk.warn(&format!("nothing was heard of `{run}` for {} s; it is over or was given up", patience.as_secs()));
    }
    let missing: u64 = watch.missing().iter().map(|range| range.to - range.from + 1).sum();
    let lists: Vec<(u64, u64)> = watch.missing().iter().map(|range| (range.from, range.to)).collect();
    bus.close().await;
    talk.line(&format!("end        {ticks} ticks: {received} received, {fetched} fetched, {missing} missing"));
    talk.result(&json!({
        "type": "end", "run": run, "ticks": ticks, "received": received + fetched, "live": received, "fetched": fetched,
        "missing_ticks": missing, "missing": lists, "gaps": gaps,
    }));
    Ok(())
}

/// Fetches ticks that did not come, some at a time, and shows them; gives how many there were.
async fn made_good(talk: &Printer, watch: &mut Watch, range: TickRange) -> u64 {
    let (mut fetched, mut from) = (0, range.from);
    let mut why_not = String::new();
    while from <= range.to {
        let some = TickRange { from, to: range.to.min(from.saturating_add(FETCH_TICKS - 1)) };
        match watch.fetch(some).await {
            Ok(states) => {
                let mut by_tick: BTreeMap<u64, Vec<AgentState>> = BTreeMap::new();
                for state in states {
                    by_tick.entry(state.tick).or_default().push(state);
                }
                by_tick.iter().for_each(|(tick, states)| shown(talk, *tick, states, false));
                fetched += by_tick.len() as u64;
                if (by_tick.len() as u64) < some.len() {
                    break;
                }
            }
            Err(why) => {
                why_not = format!(": {why}");
                break;
            }
        }
        from = some.to.saturating_add(1);
    }
    talk.line(&format!("missed     ticks {} to {}; {fetched} of them fetched{why_not}", range.from, range.to));
    talk.result(&json!({ "type": "missed", "from": range.from, "to": range.to, "fetched": fetched }));
    fetched
}

/// One tick: an object with every agent for programs, a line now and then for people.
fn shown(talk: &Printer, tick: u64, states: &[AgentState], said: bool) {
    let t = SimTime::at_tick(tick).secs();
    if said {
        let places: Vec<String> =
            states.iter().map(|state| format!("{} ({:.2}, {:.2})", state.agent_id(), state.x, state.y)).collect();
        talk.line(&format!("{t:>7.2} s  {}", places.join("  ")));
    }
    if talk.format == Format::Json {
        talk.result(&tick_object(tick, states));
    }
}

/// A tick for programs.
fn tick_object(tick: u64, states: &[AgentState]) -> Value {
    let agent = |state: &AgentState| json!({ "id": state.agent_id(), "x": state.x, "y": state.y, "yaw": state.yaw, "vx": state.vx, "vy": state.vy, "omega": state.omega });
    let agents: Vec<Value> = states.iter().map(agent).collect();
    json!({ "type": "tick", "tick": tick, "t": SimTime::at_tick(tick).secs(), "agents": agents })
}

/// An event in words; nothing for what only programs want to know.
fn words(kind: &EventKind) -> Option<String> {
    (!matches!(kind, EventKind::Node { .. })).then(|| socrates_gateway::words::words(kind))
}

/// The first run that is announced, or one that is going on.
async fn announced(bus: &dyn Bus) -> Result<RunId, Diagnostic> {
    let none = || {
        Diagnostic::input(
            "no run was announced within a minute",
            "`socrates status` shows how far it is; --run names one",
        )
    };
    let mut metas = bus
        .subscribe(keys::RUNS, 16, Overflow::DropOldest)
        .await
        .map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
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
    // A viewer with keys may not ask the orchestrator, but every run.
    let Ok(reply) = calls::status(bus, &StatusAsk::default()).await else { return told_of_itself(bus).await };
    let jobs = reply.scenarios.iter().flat_map(|scenario| &scenario.jobs);
    let mut leased =
        jobs.filter(|job| job.key.stage == socrates_model::job::Stage::Simulation && job.state == JobState::Leased);
    let key = &leased.next()?.key;
    Some(key.item.run()?.id(&key.scenario))
}

/// A run that says of itself that it goes on.
async fn told_of_itself(bus: &dyn Bus) -> Option<RunId> {
    let metas = bus.query_all(keys::RUNS, Vec::new(), RUNS_ASKED, Duration::from_secs(1)).await.ok()?;
    metas.iter().find_map(|meta| {
        let meta: Value = serde_json::from_slice(meta).ok()?;
        let goes_on = meta.get("ended")?.is_null();
        goes_on.then_some(())?;
        RunId::new(meta.get("header")?.get("run")?.as_str()?).ok()
    })
}

#[cfg(test)]
mod tests {
    use socrates_model::{HumanId, NodeId};

    use super::*;

    #[tokio::test]
    async fn a_viewer_that_may_not_ask_the_orchestrator_asks_the_runs_and_takes_one_that_goes_on() {
        let bus = socrates_link::MemoryBus::new();
        for (run, ended) in [("a.none-1", json!({ "recording": null })), ("b.reference-1", Value::Null)] {
            let mut serving = bus.serve(&keys::live_meta(&RunId::new(run).unwrap())).await.unwrap();
            let meta = json!({ "header": { "run": run }, "ended": ended }).to_string();
            drop(tokio::spawn(async move {
                while let Some(ask) = serving.next().await {
                    ask.reply(meta.clone().into_bytes()).await.unwrap();
                }
            }));
        }
        let named = going_on(&bus).await.unwrap();
        assert_eq!(named.as_str(), "b.reference-1");
    }

    #[test]
    fn a_person_reads_words_and_a_program_reads_numbers() {
        let (human, node) = (HumanId::new(1), NodeId::new("h5").unwrap());
        let met = EventKind::Encounter { human, node, gap_s: -0.580_000_000_000_000_1, nth: 1 };
        assert_eq!(words(&met).as_deref(), Some("human_1 meets the robot at h5, 0.6 s before it"));
        assert_eq!(words(&EventKind::RobotArrived).as_deref(), Some("the robot is at its goal"));
        let object = tick_object(250, &[]);
        assert_eq!((&object["type"], object["t"].as_f64()), (&json!("tick"), Some(2.5)));
    }
}
