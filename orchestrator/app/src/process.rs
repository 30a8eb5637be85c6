//! Child processes: one worker, or the orchestrator.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use socrates_author::{Keys, Recordings};
use socrates_kit::{BlobError, Blobs, FaultPlan, KitError, LocalBlobs, Stop, WorkerConfig};
use socrates_link::rules::Role;
use socrates_link::{Bus, Mode, SECURE, ZenohConfig};
use socrates_model::job::Stage;
use socrates_orchestrator::Policy;
pub use socrates_store::Durability;
use socrates_store::StoreError;
use socrates_stream::{ShmConfig, ShmHost};
use tokio::sync::watch;

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::folder;
use crate::keys;
use crate::logs;
use crate::orchestrate::{self, OrchestratorConfig};
use crate::output::Printer;

/// Options of one worker process.
#[derive(Debug, Clone)]
pub struct WorkerOptions {
    /// Stage it serves.
    pub stage: String,
    /// Endpoint of the orchestrator's router.
    pub connect: String,
    /// Namespace.
    pub namespace: String,
    /// Artifact folder shared with the orchestrator; without it artifacts travel over the bus.
    pub blobs: Option<PathBuf>,
    /// Folder for reports that are not yet recorded.
    pub spool: PathBuf,
    /// Leave when standard input closes.
    pub tied: bool,
    /// Reports outlive a power cut; always so for a worker that is not tied.
    pub durable: bool,
    /// Faults to inject, for experiments: `die_before_report=0.1,drop_report=0.05`.
    pub inject: String,
    /// File in which its log is kept, as JSON lines; none for nowhere.
    pub log_file: Option<PathBuf>,
    /// Whether jobs may name folders of recordings: whoever hands them in is the user of this process.
    pub own_jobs: bool,
}

/// Options of the orchestrator process.
#[derive(Debug, Clone)]
pub struct OrchestratorOptions {
    /// Folder of the job store and the artifacts; on a local disk.
    pub dir: PathBuf,
    /// Endpoint to listen on, such as `tcp/127.0.0.1:7447`; one that other machines can reach takes keys, such as
    /// `quic/0.0.0.0:7447`, or needs `--insecure`.
    pub listen: Option<String>,
    /// Listens where other machines can reach it: whoever does may hand in and read jobs, and join as a worker that
    /// returns any result. There is no password and no encryption.
    pub insecure: bool,
    /// Endpoint of a router to use instead of listening.
    pub connect: Option<String>,
    /// Namespace.
    pub namespace: String,
    /// What a commit outlives.
    pub durable: Durability,
    /// Address on which figures are served for Prometheus, such as `127.0.0.1:9464`; one that other machines can reach needs
    /// `insecure`. None for nowhere.
    pub metrics: Option<String>,
    /// Leave when standard input closes.
    pub tied: bool,
    /// No worker of before is alive: what they held is handed out again at once.
    pub alone: bool,
    /// Rules of an experiment, instead of those of the configuration.
    pub rules: Option<Policy>,
}

/// Version of the stages' code; results of another version are not reused.
pub const CODE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// Where this user's shared memory is arranged.
pub(crate) fn shared_memory(config: &Config) -> ShmConfig {
    ShmConfig::of_user(&config.program().temp, rustix::process::getuid().as_raw())
}

/// Serves one stage until told to leave.
pub async fn worker(config: &Config, options: &WorkerOptions) -> Result<(), Diagnostic> {
    let stage: Stage = options.stage.parse().map_err(|bad: socrates_model::ids::BadId| {
        Diagnostic::input(bad.to_string(), "`socrates cluster worker --help`")
    })?;
    if let Some(file) = &options.log_file {
        logs::keep(config, file);
    }
    let shutdown = leave(options.tied);
    let (connect, namespace) = (&options.connect, &options.namespace);
    let bus = joined(config, Role::Worker, connect, namespace, &format!("worker-{stage}"), options.tied).await?;
    let blobs = options.blobs.as_ref().map_or(Blobs::Bus, |dir| Blobs::Local(LocalBlobs::new(dir, false)));
    let mut settings = WorkerConfig::new(blobs, &options.spool, CODE_VERSION);
    settings.faults = FaultPlan::parse(&options.inject)
        .map_err(|why| Diagnostic::input(why.to_string(), "for example --inject die_before_report=2"))?;
    settings.host = host();
    // A worker that leaves with its supervisor shares the machine with whoever records its reports.
    settings.durable = !options.tied || options.durable;
    settings.waits_for_disk = settings.durable;
    if stage == Stage::Simulation && config.text("stream.live") != "off" {
        // Control and stream never share a session, so that a frozen viewer stalls no job.
        settings.live = Some(joined(config, Role::Worker, connect, namespace, "stream", options.tied).await?);
    }
    let recordings = if options.own_jobs { Recordings::Own } else { Recordings::Refused };
    let author_keys = Keys { recordings, ..crate::authors::keys(config)? };
    let live = settings.live.clone();
    let served = match stage {
        Stage::Proposal => {
            socrates_kit::serve(socrates_authoring::ProposalStage::new(author_keys), bus.clone(), settings, shutdown)
                .await
        }
        Stage::Paths => {
            socrates_kit::serve(socrates_authoring::PathsStage::new(author_keys), bus.clone(), settings, shutdown).await
        }
        Stage::Behaviors => {
            socrates_kit::serve(socrates_authoring::BehaviorsStage::new(author_keys), bus.clone(), settings, shutdown)
                .await
        }
        Stage::Simulation => {
            let stage = socrates_simulation::Simulation::new(ShmHost::new(shared_memory(config)));
            socrates_kit::serve(stage, bus.clone(), settings, shutdown).await
        }
        Stage::Scoring => socrates_kit::serve(socrates_scoring::ScoringStage, bus.clone(), settings, shutdown).await,
        Stage::Review => {
            return Err(Diagnostic::input(
                "a review is done by a person: `socrates run --ask`",
                "stages of workers: proposal, paths, behaviors, simulation, scoring",
            ));
        }
    };
    if let Some(live) = live {
        live.close().await;
    }
    bus.close().await;
    if let Err(KitError::InjectedDeath { .. }) = served {
        // An experiment asked for this death: as sudden as kill -9, without any farewell.
        std::process::abort();
    }
    served.map_err(|why| {
        // Neither a folder nor a version mends itself when the worker is started again.
        let stuck = matches!(why, KitError::Folder { .. } | KitError::Incompatible(_));
        Diagnostic::input(format!("the {stage} worker stops: {why}"), "the same command resumes once that is mended")
            .with_code(if stuck { Code::Input } else { Code::Ours })
    })
}

/// A client of a router. That the router of a supervisor is gone is nothing that a child is stuck with: it leaves.
async fn joined(
    config: &Config,
    role: Role,
    endpoint: &str,
    namespace: &str,
    name: &str,
    tied: bool,
) -> Result<Arc<dyn Bus>, Diagnostic> {
    let joined = client(config, role, endpoint, namespace, name).await;
    joined.map_err(|why| if tied { why.with_code(Code::Ours) } else { why })
}

/// Refuses to listen where other machines can reach it, unless that is meant.
fn reachable(listen: &str, insecure: bool) -> Result<(), Diagnostic> {
    // Nobody comes in there without keys.
    if is_local(listen) || listen.starts_with(SECURE) {
        return Ok(());
    }
    let open = format!(
        "`{listen}` can be reached from other machines: whoever does can hand in jobs, read all of them, and join as a \
         worker that returns any result; there is no password and no encryption"
    );
    if insecure {
        tracing::warn!("{open}");
        return Ok(());
    }
    Err(Diagnostic::input(
        open,
        "make keys with `socrates cluster keys` and listen on quic/0.0.0.0:7447 with --keys; or listen on tcp/127.0.0.1:7447 and let \
         workers come through `ssh -L`, or say --insecure in a network that you trust",
    ))
}

/// Whether an endpoint can be reached from this machine alone. What is not understood is taken as open.
fn is_local(endpoint: &str) -> bool {
    let Some((protocol, rest)) = endpoint.split_once('/') else { return false };
    if protocol == "unixsock-stream" {
        return true;
    }
    let address = rest.split(['?', '#']).next().unwrap_or_default();
    let host = address.rsplit_once(':').map_or(address, |(host, _port)| host);
    let host = host.trim_start_matches('[').trim_end_matches(']');
    host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|host| host.is_loopback())
}

/// The listener of the figures: on this machine alone, unless more is meant.
async fn figures(talk: &Printer, address: &str, insecure: bool) -> Result<tokio::net::TcpListener, Diagnostic> {
    let such = "for example --metrics 127.0.0.1:9464";
    let cannot = |why: &dyn std::fmt::Display| {
        Diagnostic::input(format!("figures cannot be served on `{address}`: {why}"), format!("another port, {such}"))
    };
    let mut found = tokio::net::lookup_host(address)
        .await
        .map_err(|why| Diagnostic::input(format!("`{address}` is no address with a port: {why}"), such))?;
    let at = found.next().ok_or_else(|| Diagnostic::input(format!("`{address}` is no address of a machine"), such))?;
    if !at.ip().is_loopback() && !insecure {
        let open = format!("figures on `{address}` can be read from other machines, by anybody and in clear");
        return Err(Diagnostic::input(open, format!("{such}; or say --insecure in a network that you trust")));
    }
    let listener = tokio::net::TcpListener::bind(at).await.map_err(|why| cannot(&why))?;
    let at = listener.local_addr().map_err(|why| cannot(&why))?;
    talk.warn(&format!("metrics    http://{at}/metrics"));
    Ok(listener)
}

/// Runs the orchestrator until told to leave.
pub async fn orchestrator(talk: &Printer, config: &Config, options: &OrchestratorOptions) -> Result<(), Diagnostic> {
    // What one run makes is made again; what a cluster holds is not.
    if !options.tied {
        folder::of_one_machine(&options.dir)?;
    }
    logs::keep(config, &logs::file(&options.dir, "orchestrator"));
    let metrics = match &options.metrics {
        Some(address) => Some(figures(talk, address, options.insecure).await?),
        None => None,
    };
    let bus: Arc<dyn Bus> = match (&options.listen, &options.connect) {
        (Some(listen), None) => {
            reachable(listen, options.insecure)?;
            let keys = keys::of(config, Role::Orchestrator, listen)?;
            let settings = ZenohConfig::new(Mode::Router, &options.namespace, "orchestrator").listen(listen);
            let opened = socrates_link::join(settings.credentials(keys)).await.map_err(|why| {
                let hint = "another port, or end the program that has it";
                keys::told(why, &format!("cannot listen on `{listen}`"), hint)
            })?;
            talk.warn(&format!("listening  {listen} · namespace {}", options.namespace));
            opened
        }
        (None, Some(connect)) => {
            joined(config, Role::Orchestrator, connect, &options.namespace, "orchestrator", options.tied).await?
        }
        (Some(_), Some(_)) | (None, None) => {
            return Err(Diagnostic::input(
                "give either --listen or --connect",
                "for example `socrates cluster up --dir jobs --listen tcp/127.0.0.1:7447`",
            ));
        }
    };
    let settings = OrchestratorConfig {
        dir: options.dir.clone(),
        lease_ms: config.number("orchestrator.lease_ms").clamp(1_000, 600_000),
        beat_ms: config.number("orchestrator.beat_ms").clamp(100, 200_000),
        deadlines_ms: crate::authors::deadlines_ms(config)?,
        repairs: u32::try_from(config.number("orchestrator.repairs")).unwrap_or(3).min(10),
        asks_again: u32::try_from(config.number("orchestrator.asks_again")).unwrap_or(3).min(10),
        author_rates: (config.number("author.tokens_per_minute"), config.number("author.requests_per_minute")),
        author_budget: (
            config.number("orchestrator.tokens_per_scenario"),
            config.number("orchestrator.author_s_per_scenario").saturating_mul(1_000),
        ),
        cents_per_scenario: config.number("orchestrator.cents_per_scenario"),
        prices: crate::prices::prices_of(config)?,
        circuit_percent: if options.tied {
            0
        } else {
            u32::try_from(config.number("orchestrator.circuit_percent")).unwrap_or(0).min(100)
        },
        durability: options.durable,
        code_version: CODE_VERSION.to_owned(),
        alone: options.alone,
        waits: !options.tied,
        metrics,
        rules: options.rules.clone(),
    };
    let served = orchestrate::serve(settings, bus.clone(), leave(options.tied)).await;
    bus.close().await;
    served.map_err(|why| {
        // What is wrong with the store is still wrong after another start.
        let stuck = why.is::<StoreError>() || why.is::<BlobError>();
        let in_use = why.downcast_ref::<StoreError>().is_some_and(|why| matches!(why, StoreError::Locked { .. }));
        Diagnostic::input(
            format!("the orchestrator stops: {why:#}"),
            format!("the jobs are kept in `{}`", options.dir.display()),
        )
        .with_code(if in_use || stuck && options.tied { Code::Input } else { Code::Ours })
    })
}

/// How long somebody may take to answer who is only looked at.
const LOOK: Duration = Duration::from_secs(5);
/// How long a machine may take to say whether anybody listens on a port.
const KNOCK: Duration = Duration::from_secs(2);
/// How long joining tries where it is known already that nobody listens: for the reason alone.
const NO_HOPE: Duration = Duration::from_millis(200);

/// A client that looks or says one word: where nobody is there, it is said within [`LOOK`].
pub(crate) async fn looker(
    config: &Config,
    endpoint: &str,
    namespace: &str,
    name: &str,
) -> Result<Arc<dyn Bus>, Diagnostic> {
    let hint = "is `socrates run` or `socrates cluster up` running there, and is the port open from here?";
    let nobody = |tried: &str| {
        let what = format!("nobody answers at `{endpoint}`: {tried}");
        Diagnostic::input(what, hint)
    };
    not_in_clear(config, endpoint)?;
    let patience = match endpoint.strip_prefix("tcp/") {
        Some(address) => {
            let address = address.split(['?', '#']).next().unwrap_or_default();
            match tokio::time::timeout(KNOCK, tokio::net::TcpStream::connect(address)).await {
                // Somebody is there, perhaps a busy one.
                Ok(Ok(_stream)) => return client(config, Role::Client, endpoint, namespace, name).await,
                Ok(Err(_refused)) => NO_HOPE,
                Err(_elapsed) => {
                    let tried = format!("a TCP connection was neither taken nor refused within {} s", KNOCK.as_secs());
                    return Err(nobody(&tried));
                }
            }
        }
        None => KNOCK,
    };
    let joined = joining(config, Role::Client, endpoint, namespace, name, Some(patience));
    tokio::time::timeout(LOOK, joined).await.unwrap_or_else(|_elapsed| {
        let with = if endpoint.starts_with(SECURE) { " with the keys of this role" } else { "" };
        Err(nobody(&format!("a connection{with} was tried for {} s", LOOK.as_secs())))
    })
}

/// A client of a router, in this role: where there are keys they have to be of it.
pub async fn client(
    config: &Config,
    role: Role,
    endpoint: &str,
    namespace: &str,
    name: &str,
) -> Result<Arc<dyn Bus>, Diagnostic> {
    joining(config, role, endpoint, namespace, name, None).await
}

/// Refuses to go to another machine in clear where there are keys.
fn not_in_clear(config: &Config, endpoint: &str) -> Result<(), Diagnostic> {
    if config.text(keys::SETTING).is_empty() || endpoint.starts_with(SECURE) || is_local(endpoint) {
        return Ok(());
    }
    let what = format!("`{endpoint}` goes to another machine in clear, although there are keys");
    Err(Diagnostic::input(what, "connect to an endpoint that begins with quic/, or without keys: --keys ''"))
}

async fn joining(
    config: &Config,
    role: Role,
    endpoint: &str,
    namespace: &str,
    name: &str,
    patience: Option<Duration>,
) -> Result<Arc<dyn Bus>, Diagnostic> {
    not_in_clear(config, endpoint)?;
    let keys = keys::of(config, role, endpoint)?;
    if keys.is_none() && endpoint.starts_with(SECURE) {
        let hint =
            format!("--keys names the folder of the role, such as keys/{role}; `socrates cluster keys` makes them");
        return Err(Diagnostic::input(format!("`{endpoint}` needs keys"), hint));
    }
    let mut settings = ZenohConfig::new(Mode::Client, namespace, name).connect(endpoint).credentials(keys);
    settings.patience = patience.unwrap_or(settings.patience);
    let hint = "is `socrates run` or `socrates cluster up` running there?";
    socrates_link::join(settings).await.map_err(|why| keys::told(why, &format!("cannot connect to `{endpoint}`"), hint))
}

/// Turns SIGTERM, SIGINT and, for children of a supervisor, the end of standard input into a wish to leave.
pub fn leave(tied: bool) -> watch::Receiver<Stop> {
    let (wish, shutdown) = watch::channel(Stop::Run);
    let wish = Arc::new(wish);
    if tied {
        let wish = wish.clone();
        // Nothing is ever written to a child's standard input: reading it ends when its supervisor does.
        drop(tokio::task::spawn_blocking(move || {
            drop(std::io::copy(&mut std::io::stdin(), &mut std::io::sink()));
            wish.send_replace(Stop::Now);
        }));
    }
    drop(tokio::spawn(async move {
        use tokio::signal::unix::{SignalKind, signal};
        let (Ok(mut term), Ok(mut int)) = (signal(SignalKind::terminate()), signal(SignalKind::interrupt())) else {
            return;
        };
        let mut asked = 0;
        loop {
            tokio::select! {
                _ = term.recv() => {}
                _ = int.recv() => {}
            }
            asked += 1;
            wish.send_replace(if asked == 1 { Stop::Drain } else { Stop::Now });
        }
    }));
    shutdown
}

/// Name of this machine.
pub fn host() -> String {
    std::fs::read_to_string(Path::new("/proc/sys/kernel/hostname"))
        .map(|name| name.trim().to_owned())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn figures_are_for_this_machine_unless_more_is_meant() {
        let talk = Printer::to_nobody(crate::output::Format::Text);
        assert!(figures(&talk, "127.0.0.1:0", false).await.is_ok());
        let why = figures(&talk, "0.0.0.0:0", false).await.unwrap_err();
        assert!(why.what.contains("`0.0.0.0:0`") && why.hint.contains("--insecure"), "{why}");
        assert!(figures(&talk, "0.0.0.0:0", true).await.is_ok());
        for bad in ["", "9464", "127.0.0.1", "127.0.0.1:x"] {
            let why = figures(&talk, bad, false).await.unwrap_err();
            assert!(why.what.contains(&format!("`{bad}`")) && why.hint.contains("9464"), "{why}");
        }
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    #[cfg(feature = "zenoh")]
    async fn where_nobody_is_there_it_is_said_soon_and_what_was_tried() {
        let config = Config::load(None, std::iter::empty(), &[]).unwrap();
        // A port that was just free.
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let began = std::time::Instant::now();
        let why = looker(&config, &endpoint, "main", "look").await.err().unwrap();
        assert!(why.what.contains(&endpoint) && why.hint.contains("cluster up"), "{why}");
        assert!(began.elapsed() < Duration::from_secs(8), "ten seconds are for those who wait: {:?}", began.elapsed());
    }

    #[test]
    fn only_this_machine_is_listened_to_unless_more_is_meant() {
        reachable("quic/0.0.0.0:7447", false).unwrap();
        let near =
            ["tcp/127.0.0.1:7447", "tcp/127.8.9.1:1", "tcp/[::1]:7447", "tcp/localhost:0", "unixsock-stream//run/x"];
        for endpoint in near {
            reachable(endpoint, false).unwrap();
        }
        let far = [
            "tcp/0.0.0.0:7447",
            "tcp/[::]:7447",
            "tcp/192.0.2.2:7447",
            "tcp/a.example:1",
            "udp/0.0.0.0:1",
            "0.0.0.0:1",
        ];
        for endpoint in far {
            let why = reachable(endpoint, false).unwrap_err();
            assert_eq!(why.code, Code::Input, "{endpoint}");
            assert!(why.what.contains("join as a worker") && why.hint.contains("--insecure"), "{why}");
            reachable(endpoint, true).unwrap();
        }
    }
}
