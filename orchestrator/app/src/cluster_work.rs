//! `cluster work`: workers of all stages on this machine, kept alive until they are asked to leave.

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_kit::Stop;
use socrates_link::rules::Role;
use socrates_link::{Presence, keys};
use socrates_model::job::Stage;
use tokio::sync::mpsc;

use crate::config::Config;
use crate::crew::{Crew, Member};
use crate::exit::{Code, Diagnostic};
use crate::folder::Hold;
use crate::logs;
use crate::output::Printer;
use crate::process;
use crate::signals::Signals;
use crate::supervise::names;
use crate::words::plural;

/// Processes of the simulation stage, at most.
const MOST_SLOTS: u32 = 512;

/// What works, and for whom.
#[derive(Debug, Clone)]
pub struct WorkOptions {
    /// Endpoint of the orchestrator.
    pub connect: String,
    /// Namespace.
    pub namespace: String,
    /// Folder for reports that are not yet recorded; none for one in the current folder that is called after the machine.
    pub dir: Option<PathBuf>,
    /// Processes of the simulation stage; none for one per core.
    pub slots: Option<u32>,
    /// Stages that are served; none for all.
    pub stages: Vec<String>,
}

/// Serves until a signal comes: the first lets the workers finish what they hold, the second makes them hand it back at once.
///
/// # Errors
/// An endpoint where nobody listens, an unknown stage, a worker that cannot go on.
pub async fn work(talk: &Printer, config: &Config, options: &WorkOptions) -> Result<Code, Diagnostic> {
    let stages = stages(&options.stages)?;
    let cores = || std::thread::available_parallelism().map_or(1, |cores| u32::try_from(cores.get()).unwrap_or(1));
    let slots = options.slots.unwrap_or_else(cores);
    if slots == 0 || slots > MOST_SLOTS {
        return Err(Diagnostic::input(
            format!("`--slots {slots}` is not 1 to {MOST_SLOTS}"),
            "without it there is one per core",
        ));
    }
    let dir = options.dir.clone().unwrap_or_else(|| PathBuf::from(format!("socrates-work-{}", process::host())));
    // Two crews in one folder would report each other's work.
    let _hold = Hold::take(&dir).map_err(|why| Diagnostic {
        what: format!("`{}` is used by another `cluster work`, or cannot be written: {}", dir.display(), why.what),
        hint: "end that one, or name another folder with --dir".to_owned(),
        ..why
    })?;
    logs::keep(config, &logs::file(&dir, "crew"));
    let mut signals = Signals::listen()?;
    let bus = process::client(config, Role::Worker, &options.connect, &options.namespace, "crew").await?;
    let mut orchestrators =
        bus.watch_alive(keys::ORCHESTRATORS_ALIVE).await.map_err(|why| Diagnostic::resumes(why.to_string()))?;
    let (report, mut gave_up) = mpsc::channel(16);
    let mut crew = Crew::new();
    let roles = roles(config, options, &dir, &stages, slots)?;
    let count = roles.len();
    for role in roles {
        // A router that is away for long is no reason to give up: a worker is started again until it is back.
        crew.add(role, report.clone(), usize::MAX)?;
    }
    let served: Vec<&str> = stages.iter().map(|stage| stage.name()).collect();
    talk.line(&format!("working    {} for {}: {}", plural(count, "worker"), options.connect, served.join(", ")));
    let ended = tokio::select! {
        why = gave_up.recv() => why.map_or(Ok(()), Err),
        _ = signals.interrupt.recv() => Ok(()),
        _ = signals.terminate.recv() => Ok(()),
        () = tell(talk, &mut orchestrators) => Ok(()),
    };
    if ended.is_ok() {
        talk.line("leaving    what is held is finished first; a second signal hands it back at once");
        crew.drain();
    }
    let stop = crew.stop.clone();
    let left = crew.ended();
    tokio::pin!(left);
    if ended.is_err() {
        stop.send_replace(Stop::Now);
    }
    tokio::select! {
        () = &mut left => {}
        _second = signals.come() => {
            stop.send_replace(Stop::Now);
            left.await;
        }
    }
    bus.close().await;
    ended?;
    talk.result(&json!({ "processes": count }));
    Ok(Code::Ok)
}

/// Says when the orchestrator comes and goes, until the bus closes.
async fn tell(talk: &Printer, orchestrators: &mut Presence) {
    while let Some((_, here)) = orchestrators.next().await {
        let line = if here {
            "bus        the orchestrator is there"
        } else {
            "bus        the orchestrator is away; reports are kept until it is back"
        };
        talk.line(line);
    }
    // A bus that closed by itself is opened again by the workers; a signal ends this.
    std::future::pending::<()>().await;
}

fn stages(named: &[String]) -> Result<Vec<Stage>, Diagnostic> {
    if named.is_empty() {
        return Ok(Stage::WORKERS.to_vec());
    }
    let one = |name: &String| {
        let stage = Stage::WORKERS.into_iter().find(|stage| stage.name() == name);
        let all = Stage::WORKERS.map(Stage::name).join(", ");
        stage.ok_or_else(|| Diagnostic::input(format!("there is no stage `{name}`"), format!("stages: {all}")))
    };
    let mut stages = named.iter().map(one).collect::<Result<Vec<_>, _>>()?;
    stages.dedup();
    Ok(stages)
}

/// Every process: one of each stage, of the simulation as many as there are slots.
fn roles(
    config: &Config,
    options: &WorkOptions,
    dir: &Path,
    stages: &[Stage],
    slots: u32,
) -> Result<Vec<Member>, Diagnostic> {
    let mut roles = Vec::new();
    for stage in stages {
        let count = if *stage == Stage::Simulation { slots } else { 1 };
        for name in names(*stage, count) {
            let spool = dir.join(&name).display().to_string();
            let log = logs::file(dir, &name).display().to_string();
            let words = ["worker", stage.name(), "--spool", &spool, "--log-file", &log, "--connect", &options.connect];
            let last = ["--namespace", &options.namespace, "--tied", "--durable"];
            let own = words.into_iter().chain(last).map(str::to_owned).collect();
            roles.push(Member::new(config, &name, own, Vec::new())?);
        }
    }
    Ok(roles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_named_or_all() {
        assert_eq!(stages(&[]).unwrap(), Stage::WORKERS);
        assert_eq!(stages(&["scoring".to_owned()]).unwrap(), [Stage::Scoring]);
        let why = stages(&["review".to_owned()]).unwrap_err();
        assert!(why.what.contains("`review`") && why.hint.contains("simulation"), "{why}");
    }
}
