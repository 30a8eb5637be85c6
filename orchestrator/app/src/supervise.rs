//! The supervisor: one router on a socket of this user alone, one orchestrator and one process per worker as children.
//!
//! It keeps no state. Children leave when its end of their standard input closes, so that a kill -9 of
//! the supervisor leaves nothing running; a child that dies is started again, unless it says that this would not help.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, SECURE, keys};
use socrates_model::job::Stage;
use tempfile::TempDir;
use tokio::sync::mpsc;

use crate::config::Config;
use crate::crew::{Crew, Member, ours};
use crate::driver_process::DriverCommand;
use crate::exit::{Code, Diagnostic};
use crate::logs;
use crate::router::{ENDPOINT_FILE, Router, SOCKET, read_endpoint};

/// How long the orchestrator may take to appear.
const START_LIMIT: Duration = Duration::from_secs(20);

/// The running system of one `socrates run`.
pub(crate) struct Supervisor {
    /// The bus, with this process as its router.
    pub(crate) bus: Arc<dyn Bus>,
    work: PathBuf,
    /// Closed to other users; removed with this.
    _socket: TempDir,
    workers: Crew,
    orchestrator: Crew,
    gave_up: mpsc::Receiver<Diagnostic>,
}

impl Supervisor {
    /// Binds the listener, then starts the children and waits until the orchestrator answers.
    pub(crate) async fn start(
        work: &Path,
        config: &Config,
        simulations: u32,
        driven_by: Option<&str>,
    ) -> Result<Self, Diagnostic> {
        let namespace = "run";
        logs::keep(config, &logs::file(work, "supervisor"));
        let Router { bus, socket, endpoint } = Router::open(work, config, namespace).await?;
        let mut presence = bus.watch_alive(keys::ORCHESTRATORS_ALIVE).await.map_err(|why| ours(&why.to_string()))?;
        let (report, gave_up) = mpsc::channel(16);
        let restarts = usize::try_from(config.number("supervisor.restarts")).unwrap_or(20);
        let (mut workers, mut orchestrator) = (Crew::new(), Crew::new());
        for role in roles(work, &endpoint, namespace, simulations, config)? {
            let crew = if role.first.is_empty() { &mut workers } else { &mut orchestrator };
            crew.add(role, report.clone(), restarts)?;
        }
        if let Some(line) = driven_by {
            let command = DriverCommand::read(line, &endpoint, namespace)?;
            let claims = bus.watch_alive(keys::DRIVERS_ALIVE).await.map_err(|why| ours(&why.to_string()))?;
            let child = command.start()?;
            let kept = command.keep(child, claims, workers.stop.subscribe(), report.clone());
            workers.keepers.push(tokio::spawn(kept));
        }
        let work = work.to_path_buf();
        let mut supervisor = Self { bus, work, _socket: socket, workers, orchestrator, gave_up };
        let appeared = async {
            while let Some((_, alive)) = presence.next().await {
                if alive {
                    return true;
                }
            }
            false
        };
        let refused = tokio::select! {
            appeared = tokio::time::timeout(START_LIMIT, appeared) => match appeared {
                Ok(true) => return Ok(supervisor),
                Ok(false) | Err(_) => ours("the orchestrator did not start; see the messages above"),
            },
            // Nothing was begun: what is in the way is there, not with us.
            refused = supervisor.gave_up() => refused.with_code(Code::Input),
        };
        supervisor.stop().await;
        Err(refused)
    }

    /// Why a child cannot be kept alive, once that is so.
    pub(crate) async fn gave_up(&mut self) -> Diagnostic {
        match self.gave_up.recv().await {
            Some(diagnostic) => diagnostic,
            None => ours("every process has ended"),
        }
    }

    /// Ends the children and the bus: the workers first, so that they can hand back what they hold.
    pub(crate) async fn stop(self) {
        self.workers.leave().await;
        tracing::debug!("the workers left");
        self.orchestrator.leave().await;
        tracing::debug!("the orchestrator left");
        self.bus.close().await;
        tracing::debug!("the bus is closed");
        drop(std::fs::remove_file(self.work.join(ENDPOINT_FILE)));
    }
}

/// Every process of a run, the orchestrator first.
fn roles(
    work: &Path,
    endpoint: &str,
    namespace: &str,
    simulations: u32,
    config: &Config,
) -> Result<Vec<Member>, Diagnostic> {
    let text = |path: PathBuf| path.display().to_string();
    let role = |name: &str, own: &[String], first: Vec<String>| {
        let at = ["--connect", endpoint, "--namespace", namespace, "--tied"].map(str::to_owned);
        Member::new(config, name, [own, &at].concat(), first)
    };
    // Every process that knows of a commit runs on this machine.
    let words = ["orchestrator", "--dir", &text(work.to_path_buf()), "--durable", "process"].map(str::to_owned);
    // The workers of an earlier supervisor left with it; those of this one outlive an orchestrator.
    let mut roles = vec![role("orchestrator", &words, vec!["--alone".to_owned()])?];
    for stage in Stage::WORKERS {
        let count = if stage == Stage::Simulation { simulations.clamp(1, 64) } else { 1 };
        for name in names(stage, count) {
            let (blobs, spool) = (text(work.join("blobs")), text(work.join("spool").join(&name)));
            let log = text(logs::file(work, &name));
            let words =
                ["worker", stage.name(), "--blobs", &blobs, "--spool", &spool, "--log-file", &log, "--own-jobs"];
            roles.push(role(&name, &words.map(str::to_owned), Vec::new())?);
        }
    }
    Ok(roles)
}

/// Names of so many workers of a stage.
pub(crate) fn names(stage: Stage, count: u32) -> Vec<String> {
    match count {
        1 => vec![stage.to_string()],
        count => (1..=count).map(|number| format!("{stage}-{number}")).collect(),
    }
}

/// Endpoint and namespace of a folder whose run is being made, or of an endpoint given as it is.
pub(crate) fn endpoint(what: &str) -> Option<(String, String)> {
    if what.contains("/127.") || what.starts_with("tcp/") || what.starts_with(SECURE) || what.starts_with("unixsock") {
        let (endpoint, namespace) = what.split_once('@').unwrap_or((what, "main"));
        return Some((endpoint.to_owned(), namespace.to_owned()));
    }
    // The endpoint of a killed supervisor stands there still; nobody listens at it.
    let listens = |(endpoint, _): &(String, String)| {
        endpoint.strip_prefix(SOCKET).is_none_or(|socket| std::os::unix::net::UnixStream::connect(socket).is_ok())
    };
    read_endpoint(&Path::new(what).join(".socrates")).filter(listens)
}
