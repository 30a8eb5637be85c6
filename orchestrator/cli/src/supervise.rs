//! The supervisor: one router on loopback, one orchestrator and one process per worker as children.
//!
//! It keeps no state. Children leave when its end of their standard input closes, so that a kill -9 of
//! the supervisor leaves nothing running; a child that dies is started again.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus as _, Mode, ZenohBus, ZenohConfig, keys};
use socrates_model::job::Stage;
use tokio::process::{Child, Command};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use crate::config::Config;
use crate::exit::{Code, Complaint};

/// How long a child may take to leave before it is ended.
const LEAVE_LIMIT: Duration = Duration::from_secs(3);
/// How long the orchestrator may take to appear.
const START_LIMIT: Duration = Duration::from_secs(20);
/// File in the work folder that tells `watch` and `status` where to connect.
pub(crate) const ENDPOINT_FILE: &str = "endpoint";

/// The running system of one `socrates run`.
pub(crate) struct Supervisor {
    /// The bus, with this process as its router.
    pub(crate) bus: Arc<ZenohBus>,
    work: PathBuf,
    stop: watch::Sender<bool>,
    keepers: Vec<JoinHandle<()>>,
    gave_up: mpsc::Receiver<String>,
}

/// What a child is started with.
#[derive(Debug, Clone)]
struct Role {
    name: String,
    args: Vec<String>,
}

impl Supervisor {
    /// Binds the listener, then starts the children and waits until the orchestrator answers.
    pub(crate) async fn start(
        work: &Path,
        config: &Config,
        workers: u32,
        passed_on: &[String],
    ) -> Result<Self, Complaint> {
        let namespace = "run";
        let (bus, endpoint) = listen(config.number("supervisor.port"), namespace).await?;
        let bus = Arc::new(bus);
        let mut presence = bus.watch_alive(keys::ORCHESTRATORS_ALIVE).await.map_err(|why| ours(&why.to_string()))?;
        std::fs::write(work.join(ENDPOINT_FILE), format!("{endpoint}\n{namespace}\n")).map_err(|why| {
            Complaint::input(format!("cannot write into `{}`: {why}", work.display()), "--out chooses another folder")
        })?;
        let (stop, stopped) = watch::channel(false);
        let (report, gave_up) = mpsc::channel(16);
        let restarts = usize::try_from(config.number("supervisor.restarts")).unwrap_or(20);
        let mut keepers = Vec::new();
        for role in roles(work, &endpoint, namespace, workers, passed_on) {
            let child = spawn(&role)?;
            keepers.push(tokio::spawn(keep(role, child, stopped.clone(), report.clone(), restarts)));
        }
        let supervisor = Self { bus, work: work.to_path_buf(), stop, keepers, gave_up };
        let appeared = tokio::time::timeout(START_LIMIT, async {
            while let Some((_, alive)) = presence.next().await {
                if alive {
                    return true;
                }
            }
            false
        });
        if !matches!(appeared.await, Ok(true)) {
            supervisor.stop().await;
            return Err(ours("the orchestrator did not start; see the messages above"));
        }
        Ok(supervisor)
    }

    /// A child that died too often, if one did.
    pub(crate) async fn gave_up(&mut self) -> Option<String> {
        self.gave_up.recv().await
    }

    /// Ends the children and the bus.
    pub(crate) async fn stop(self) {
        if self.stop.send(true).is_err() {
            tracing::debug!("every child has left already");
        }
        for keeper in self.keepers {
            if let Err(why) = keeper.await {
                tracing::warn!(%why, "a keeper ended early");
            }
        }
        self.bus.close().await;
        drop(std::fs::remove_file(self.work.join(ENDPOINT_FILE)));
    }
}

fn ours(what: &str) -> Complaint {
    Complaint::input(what, "`socrates doctor` checks this machine").with_code(Code::Ours)
}

/// Opens the router on the asked port, or on a free one.
async fn listen(port: u64, namespace: &str) -> Result<(ZenohBus, String), Complaint> {
    let mut last = String::new();
    // A free port may be taken by somebody else between the probe and the listener; then another is tried.
    for _ in 0..8 {
        let chosen = if port == 0 { free_port()? } else { port };
        let endpoint = format!("tcp/127.0.0.1:{chosen}");
        let config = ZenohConfig::new(Mode::Router, namespace, "supervisor").listen(&endpoint);
        match ZenohBus::open(config).await {
            Ok(bus) => return Ok((bus, endpoint)),
            Err(why) => last = why.to_string(),
        }
        if port != 0 {
            return Err(Complaint::input(
                format!("port {port} of 127.0.0.1 cannot be used: {last}"),
                "set supervisor.port to 0 for a free one, or to another number",
            ));
        }
    }
    Err(ours(&format!("no port of 127.0.0.1 could be used: {last}")))
}

fn free_port() -> Result<u64, Complaint> {
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .and_then(|listener| listener.local_addr())
        .map(|address| address.port());
    port.map(u64::from).map_err(|why| ours(&format!("127.0.0.1 cannot be used: {why}")))
}

fn roles(work: &Path, endpoint: &str, namespace: &str, simulations: u32, passed_on: &[String]) -> Vec<Role> {
    let text = |path: PathBuf| path.display().to_string();
    let common = passed_on;
    let mut roles = Vec::new();
    let mut role = |name: String, own: Vec<String>| {
        let mut args = own;
        args.extend_from_slice(common);
        args.extend(["--connect", endpoint, "--namespace", namespace, "--tied"].map(str::to_owned));
        roles.push(Role { name, args });
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
            role(name, own);
        }
    }
    roles
}

fn spawn(role: &Role) -> Result<Child, Complaint> {
    let program = std::env::current_exe().map_err(|why| ours(&format!("this program cannot find itself: {why}")))?;
    Command::new(program)
        .args(&role.args)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::inherit())
        .kill_on_drop(true)
        // Ctrl-C reaches the supervisor alone, which then asks the children to leave.
        .process_group(0)
        .spawn()
        .map_err(|why| ours(&format!("the {} process cannot be started: {why}", role.name)))
}

/// Keeps one child alive until told to stop.
async fn keep(
    role: Role,
    mut child: Child,
    mut stopped: watch::Receiver<bool>,
    report: mpsc::Sender<String>,
    restarts: usize,
) {
    let mut deaths: VecDeque<Instant> = VecDeque::new();
    // Waiting for a child closes its standard input, unless somebody else holds the pipe.
    let mut pipe = child.stdin.take();
    loop {
        let ended = tokio::select! {
            status = child.wait() => Some(status),
            changed = stopped.wait_for(|stop| *stop) => {
                drop(changed);
                None
            }
        };
        let Some(status) = ended else {
            // Closing its standard input asks the child to leave.
            drop(pipe);
            if tokio::time::timeout(LEAVE_LIMIT, child.wait()).await.is_err()
                && let Err(why) = child.kill().await
            {
                tracing::warn!(role = role.name, %why, "a child could not be ended");
            }
            return;
        };
        let now = Instant::now();
        deaths.push_back(now);
        while deaths.front().is_some_and(|first| now.duration_since(*first) > Duration::from_secs(60)) {
            deaths.pop_front();
        }
        let how = status.map_or_else(|why| why.to_string(), |status| status.to_string());
        tracing::warn!(role = role.name, how, "a child died and is started again");
        if deaths.len() > restarts {
            drop(
                report
                    .send(format!("the {} process died {} times in a minute, last with {how}", role.name, deaths.len()))
                    .await,
            );
            return;
        }
        match spawn(&role) {
            Ok(next) => {
                child = next;
                pipe = child.stdin.take();
            }
            Err(why) => {
                drop(report.send(why.what).await);
                return;
            }
        }
    }
}

/// Endpoint and namespace of a folder whose run is being made, or of an endpoint given as it is.
pub(crate) fn endpoint(what: &str) -> Option<(String, String)> {
    if what.contains("/127.") || what.starts_with("tcp/") || what.starts_with("unixsock") {
        let (endpoint, namespace) = what.split_once('@').unwrap_or((what, "main"));
        return Some((endpoint.to_owned(), namespace.to_owned()));
    }
    let text = std::fs::read_to_string(Path::new(what).join(".socrates").join(ENDPOINT_FILE)).ok()?;
    let mut lines = text.lines();
    Some((lines.next()?.to_owned(), lines.next().unwrap_or("main").to_owned()))
}
