//! The supervisor: one router on a socket of this user alone, one orchestrator and one process per worker as children.
//!
//! It keeps no state. Children leave when its end of their standard input closes, so that a kill -9 of
//! the supervisor leaves nothing running; a child that dies is started again, unless it says that this would not help.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, TLS, keys};
use socrates_model::job::Stage;
use tempfile::TempDir;
use tokio::io::AsyncReadExt as _;
use tokio::process::Child;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use crate::child::{command, ended, leave};
use crate::config::Config;
use crate::driver_process::DriverCommand;
use crate::exit::{Code, Complaint};
use crate::router::{ENDPOINT_FILE, Router, SOCKET, read_endpoint};

/// How long the orchestrator may take to appear.
const START_LIMIT: Duration = Duration::from_secs(20);
/// Deaths of a child in a minute after which it is not started again at once.
const SUDDEN: u32 = 3;
/// First pause before a child that dies again and again is started again; it doubles with every death.
const PAUSE: Duration = Duration::from_millis(50);
/// Longest such pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);
/// Most of what a child says at its end that is read, bytes.
const LAST_WORDS: u64 = 64 * 1024;
/// The running system of one `socrates run`.
pub(crate) struct Supervisor {
    /// The bus, with this process as its router.
    pub(crate) bus: Arc<dyn Bus>,
    work: PathBuf,
    /// Closed to other users; removed with this.
    _socket: TempDir,
    workers: Crew,
    orchestrator: Crew,
    gave_up: mpsc::Receiver<Complaint>,
}

/// Children that leave together.
struct Crew {
    stop: watch::Sender<bool>,
    keepers: Vec<JoinHandle<()>>,
}

impl Crew {
    fn new() -> Self {
        Self { stop: watch::Sender::new(false), keepers: Vec::new() }
    }

    fn add(&mut self, role: Role, report: mpsc::Sender<Complaint>, restarts: usize) -> Result<(), Complaint> {
        let child = spawn(&role, &role.first)?;
        self.keepers.push(tokio::spawn(keep(role, child, self.stop.subscribe(), report, restarts)));
        Ok(())
    }

    async fn leave(self) {
        self.stop.send_replace(true);
        for keeper in self.keepers {
            if let Err(why) = keeper.await {
                tracing::warn!(%why, "a keeper ended early");
            }
        }
    }
}

/// What a child is started with.
#[derive(Debug, Clone)]
struct Role {
    name: String,
    args: Vec<String>,
    /// What it is told besides when it is started for the first time.
    first: Vec<String>,
    /// The program that plays it.
    program: PathBuf,
    /// Whether the environment says nothing of [`ARENAS`].
    few_arenas: bool,
}

impl Supervisor {
    /// Binds the listener, then starts the children and waits until the orchestrator answers.
    pub(crate) async fn start(
        work: &Path,
        config: &Config,
        simulations: u32,
        driven_by: Option<&str>,
    ) -> Result<Self, Complaint> {
        let namespace = "run";
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
    pub(crate) async fn gave_up(&mut self) -> Complaint {
        match self.gave_up.recv().await {
            Some(complaint) => complaint,
            None => ours("every process has ended"),
        }
    }

    /// Ends the children and the bus: the workers first, so that they can hand back what they hold.
    pub(crate) async fn stop(self) {
        self.workers.leave().await;
        self.orchestrator.leave().await;
        self.bus.close().await;
        drop(std::fs::remove_file(self.work.join(ENDPOINT_FILE)));
    }
}

fn ours(what: &str) -> Complaint {
    Complaint::input(what, "`socrates doctor` checks this machine").with_code(Code::Ours)
}

/// Opens the router on a socket, and on a port of this machine where one is asked for.
fn roles(
    work: &Path,
    endpoint: &str,
    namespace: &str,
    simulations: u32,
    config: &Config,
) -> Result<Vec<Role>, Complaint> {
    let program = config.executable()?;
    let few_arenas = config.variable(ARENAS.0).is_none();
    let text = |path: PathBuf| path.display().to_string();
    let mut roles = Vec::new();
    let mut role = |name: String, own: Vec<String>, first: Vec<String>| {
        let mut args = own;
        args.extend_from_slice(config.passed_on());
        args.extend(["--connect", endpoint, "--namespace", namespace, "--tied"].map(str::to_owned));
        roles.push(Role { name, args, first, program: program.to_path_buf(), few_arenas });
    };
    role(
        "orchestrator".to_owned(),
        vec![
            "orchestrator".to_owned(),
            "--dir".to_owned(),
            text(work.to_path_buf()),
            // Whoever knows of a commit runs on this machine.
            "--durable".to_owned(),
            "process".to_owned(),
        ],
        // The workers of an earlier supervisor left with it; those of this one outlive an orchestrator.
        vec!["--alone".to_owned()],
    );
    for stage in Stage::WORKERS {
        let count = if stage == Stage::Simulation { simulations.clamp(1, 64) } else { 1 };
        for number in 0..count {
            let name = if count == 1 { stage.to_string() } else { format!("{stage}-{}", number + 1) };
            let own = vec![
                "worker".to_owned(),
                stage.to_string(),
                "--blobs".to_owned(),
                text(work.join("blobs")),
                "--spool".to_owned(),
                text(work.join("spool").join(&name)),
            ];
            role(name, own, Vec::new());
        }
    }
    Ok(roles)
}

/// Pools of memory of a process, for the C library of most Linux systems: with one for each of its threads a worker keeps twice
/// what it needs.
const ARENAS: (&str, &str) = ("MALLOC_ARENA_MAX", "2");

fn spawn(role: &Role, more: &[String]) -> Result<Child, Complaint> {
    let mut command = command(&role.program);
    if role.few_arenas {
        command.env(ARENAS.0, ARENAS.1);
    }
    command
        .args(&role.args)
        .args(more)
        .spawn()
        .map_err(|why| ours(&format!("the {} process cannot be started: {why}", role.name)))
}

/// What a child said last: why it ended.
async fn last_words(child: &mut Child) -> Option<Complaint> {
    let mut words = Vec::new();
    child.stdout.take()?.take(LAST_WORDS).read_to_end(&mut words).await.ok()?;
    Complaint::of_object(&serde_json::from_slice(&words).ok()?)
}

/// How long to wait before a child is started again that died so often in the last minute.
fn pause(deaths: usize) -> Duration {
    let again = u32::try_from(deaths).unwrap_or(u32::MAX).saturating_sub(SUDDEN);
    if again == 0 { Duration::ZERO } else { PAUSE.saturating_mul(1 << again.min(10)).min(LONGEST_PAUSE) }
}

/// Keeps one child alive until told to stop.
async fn keep(
    role: Role,
    mut child: Child,
    mut stopped: watch::Receiver<bool>,
    report: mpsc::Sender<Complaint>,
    restarts: usize,
) {
    let mut deaths: VecDeque<Instant> = VecDeque::new();
    // Waiting for a child closes its standard input, unless somebody else holds the pipe.
    let mut pipe = child.stdin.take();
    loop {
        let Some(status) = ended(&mut child, &mut stopped).await else {
            return leave(child, pipe, &role.name).await;
        };
        let now = Instant::now();
        deaths.push_back(now);
        while deaths.front().is_some_and(|first| now.duration_since(*first) > Duration::from_secs(60)) {
            deaths.pop_front();
        }
        let stuck = matches!(&status, Ok(status) if status.code() == Some(i32::from(Code::Stuck as u8)));
        let how = status.map_or_else(|why| why.to_string(), |status| status.to_string());
        let words = last_words(&mut child).await;
        let why = words.as_ref().map(|words| words.what.clone()).unwrap_or_default();
        let gave_up = if stuck {
            words
        } else if deaths.len() > restarts {
            let often = format!("the {} process died {} times in a minute, last with {how}", role.name, deaths.len());
            Some(ours(&if why.is_empty() { often } else { format!("{often}: {why}") }))
        } else {
            None
        };
        if let Some(complaint) = gave_up {
            // A process of ours that cannot go on is no fault of the input.
            drop(report.send(complaint.with_code(Code::Ours)).await);
            return;
        }
        tracing::warn!(role = role.name, how, why, "a child died and is started again");
        tokio::select! {
            () = tokio::time::sleep(pause(deaths.len())) => {}
            _stop = stopped.wait_for(|stop| *stop) => return,
        }
        match spawn(&role, &[]) {
            Ok(next) => {
                child = next;
                pipe = child.stdin.take();
            }
            Err(why) => {
                drop(report.send(why.with_code(Code::Ours)).await);
                return;
            }
        }
    }
}

/// Endpoint and namespace of a folder whose run is being made, or of an endpoint given as it is.
pub(crate) fn endpoint(what: &str) -> Option<(String, String)> {
    if what.contains("/127.") || what.starts_with("tcp/") || what.starts_with(TLS) || what.starts_with("unixsock") {
        let (endpoint, namespace) = what.split_once('@').unwrap_or((what, "main"));
        return Some((endpoint.to_owned(), namespace.to_owned()));
    }
    // The endpoint of a killed supervisor stands there still; nobody listens at it.
    let listens = |(endpoint, _): &(String, String)| {
        endpoint.strip_prefix(SOCKET).is_none_or(|socket| std::os::unix::net::UnixStream::connect(socket).is_ok())
    };
    read_endpoint(&Path::new(what).join(".socrates")).filter(listens)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_that_dies_again_and_again_is_started_ever_later() {
        assert_eq!((pause(1), pause(3)), (Duration::ZERO, Duration::ZERO));
        assert!(pause(4) > Duration::ZERO && pause(5) > pause(4));
        assert_eq!(pause(1_000), LONGEST_PAUSE);
        let until_given_up: Duration = (1..=20).map(pause).sum();
        assert!(until_given_up > Duration::from_secs(20), "{until_given_up:?}: no storm");
    }
}
