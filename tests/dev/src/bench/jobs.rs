//! `socrates-dev bench --jobs N`: how many jobs that do nothing a cluster passes on in a second, durably, and what one hand-over takes.
//!
//! ```text
//! this process: scenarios in, standing out ─► orchestrator, a process with a store on disk ◄─ workers, a process each, all stages
//! ```

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::output::Printer;
use socrates_app::{calls, machine, process};
use socrates_kit::{Blobs, Done, Failure, Job, LocalBlobs, Output, Stage, WorkerConfig, media};
use socrates_link::Bus;
use socrates_link::rules::Role as Part;
use socrates_model::job::Stage as StageName;
use socrates_model::wire::{Priority, ScenarioSpec};
use socrates_model::{PlannerName, Role, ScenarioId, Verdict};

use crate::program;

/// Jobs of a scenario with one run: a job of each stage.
const STAGES: u32 = 5;
/// Between two looks at how it stands.
const PAUSE: Duration = Duration::from_millis(50);
/// Longest time until the processes are there.
const START: Duration = Duration::from_secs(20);
/// Parts of the whole of which each has a rate of its own.
const BLOCKS: usize = 10;
/// Questions of the bare round trip, and scenarios that are made one after another.
const TRIPS: usize = 500;
const ALONE: usize = 40;
/// Key that is served for the bare round trip.
const ECHO: &str = "drive/bench/step";

/// What is measured.
#[derive(Debug, Clone, Copy)]
pub struct JobsOptions {
    /// Jobs, rounded up to whole scenarios of five.
    pub jobs: u32,
    /// Worker processes on this machine, each with one slot of every stage.
    pub workers: u32,
    /// Worker processes that come from other machines and are waited for: `socrates-dev idle`.
    pub others: u32,
    /// How long each job waits, ms.
    pub wait_ms: u32,
    /// Port to listen on for more workers on other machines; none for one of this machine alone.
    pub port: Option<u16>,
}

/// A stage that waits and gives back next to nothing.
struct Idle<const N: usize> {
    wait: Duration,
}

impl<const N: usize> Stage for Idle<N> {
    #[expect(clippy::indexing_slicing, reason = "looked up while the program is built")]
    const STAGE: StageName = StageName::WORKERS[N];

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        if !self.wait.is_zero() {
            tokio::time::sleep(self.wait).await;
        }
        let made = Role::made_by(Self::STAGE);
        let output = |role| Output::text(role, media::TEXT, format!("{role} of {}", job.spec().key.scenario));
        let verdict = (Self::STAGE == StageName::Scoring).then_some(Verdict::Realised);
        Ok(Done { verdict, ..Done::with(made.map(output).into_iter().collect()) })
    }
}

/// Serves all stages with jobs that wait for so long, until the process is asked to leave.
///
/// # Errors
/// No orchestrator at the endpoint.
pub async fn idle(config: &Config, connect: &str, dir: &Path, wait_ms: u32, tied: bool) -> Result<(), Diagnostic> {
    let wait = Duration::from_millis(u64::from(wait_ms));
    let shutdown = process::leave(tied);
    let bus = process::client(config, Part::Worker, connect, "main", "idle").await?;
    let settings = |stage: StageName| {
        let mut settings = WorkerConfig::new(Blobs::Bus, dir.join(stage.name()), process::CODE_VERSION);
        settings.host = process::host();
        settings
    };
    let [proposal, paths, behaviors, simulation, scoring] = StageName::WORKERS.map(settings);
    let served = tokio::try_join!(
        socrates_kit::serve(Idle::<0> { wait }, Arc::clone(&bus), proposal, shutdown.clone()),
        socrates_kit::serve(Idle::<1> { wait }, Arc::clone(&bus), paths, shutdown.clone()),
        socrates_kit::serve(Idle::<2> { wait }, Arc::clone(&bus), behaviors, shutdown.clone()),
        socrates_kit::serve(Idle::<3> { wait }, Arc::clone(&bus), simulation, shutdown.clone()),
        socrates_kit::serve(Idle::<4> { wait }, Arc::clone(&bus), scoring, shutdown),
    );
    bus.close().await;
    served.map(drop).map_err(|why| super::ours(why.to_string()))
}

/// Processes that end with the measurement.
struct Processes(Vec<Child>);

impl Drop for Processes {
    fn drop(&mut self) {
        for child in &mut self.0 {
            drop(child.kill());
            drop(child.wait());
        }
    }
}

/// Prints the figures.
pub(super) async fn bench(
    talk: &Printer,
    config: &Config,
    own: Option<&Path>,
    options: &JobsOptions,
    folder: &Path,
) -> Result<(), Diagnostic> {
    let own = own.ok_or_else(|| super::ours("this program cannot find itself".to_owned()))?;
    std::fs::create_dir_all(folder).map_err(|why| super::ours(why.to_string()))?;
    let (host, port) = match options.port {
        Some(port) => ("0.0.0.0", port),
        None => ("127.0.0.1", free_port()?),
    };
    let connect = format!("tcp/127.0.0.1:{port}");
    let mut running = Processes(Vec::new());
    let dir = folder.join("jobs");
    let up = ["cluster", "up", "--insecure", "--listen", &format!("tcp/{host}:{port}"), "--dir"].map(str::to_owned);
    running.0.push(start(program::of(config)?, config, &up, &dir, folder, "orchestrator")?);
    let bus = reached(config, &connect).await?;
    for number in 1..=options.workers {
        let name = format!("worker-{number}");
        let wait = options.wait_ms.to_string();
        let idle = ["idle", "--tied", "--wait", &wait, "--connect", &connect, "--dir"].map(str::to_owned);
        running.0.push(start(own, config, &idle, &folder.join(&name), folder, &name)?);
    }
    let spec = specs(&dir)?;
    let trip_ms = round_trip(config, &connect, bus.as_ref()).await?;
    waited(bus.as_ref(), options.workers + options.others).await?;
    let alone_ms = alone(bus.as_ref(), &spec).await?;
    let scenarios = options.jobs.div_ceil(STAGES);
    let id = running.0.first().map_or(0, Child::id);
    let made = stream(bus.as_ref(), &spec, scenarios, id).await?;
    told(talk, options, &made, trip_ms, alone_ms);
    bus.close().await;
    Ok(())
}

fn free_port() -> Result<u16, Diagnostic> {
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
    port.map(|address| address.port()).map_err(|why| super::ours(why.to_string()))
}

/// A process of a program; what it says goes into a file.
fn start(
    program: &Path,
    config: &Config,
    args: &[String],
    dir: &Path,
    folder: &Path,
    name: &str,
) -> Result<Child, Diagnostic> {
    let log = std::fs::File::create(folder.join(format!("{name}.log"))).map_err(|why| super::ours(why.to_string()))?;
    let mut command = Command::new(program);
    command.args(args).arg(dir).args(config.passed_on());
    // A pipe that nobody writes into: it closes with this process, and with it go those that are tied to it.
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(log);
    command.spawn().map_err(|why| super::ours(why.to_string()))
}

/// The orchestrator, once it serves.
async fn reached(config: &Config, connect: &str) -> Result<Arc<dyn Bus>, Diagnostic> {
    let begun = Instant::now();
    loop {
        let bus = process::client(config, Part::Client, connect, "main", "bench").await;
        if let Ok(bus) = bus {
            while begun.elapsed() < START {
                if calls::counts(bus.as_ref(), "").await.is_ok() {
                    return Ok(bus);
                }
                tokio::time::sleep(PAUSE).await;
            }
        }
        if begun.elapsed() >= START {
            return Err(super::ours("the orchestrator did not start".to_owned()));
        }
    }
}

/// Waits for this number of workers of every stage.
async fn waited(bus: &dyn Bus, workers: u32) -> Result<(), Diagnostic> {
    let begun = Instant::now();
    while begun.elapsed() < START {
        if let Ok(reply) = calls::counts(bus, "").await
            && calls::is_staffed(&reply, |_stage| workers)
        {
            return Ok(());
        }
        tokio::time::sleep(PAUSE).await;
    }
    Err(super::ours("the workers did not come".to_owned()))
}

/// What scenarios are made from, but for their names.
fn specs(dir: &Path) -> Result<ScenarioSpec, Diagnostic> {
    let blobs = LocalBlobs::new(dir.join("blobs"), true);
    let input = |text: &str| blobs.put(text.as_bytes()).map_err(|why| super::ours(why.to_string()));
    Ok(ScenarioSpec {
        id: ScenarioId::new("bench").map_err(|why| super::ours(why.to_string()))?,
        request: input("request")?,
        location: input("location")?,
        reading: input("reading")?,
        seed: 0,
        planners: vec![PlannerName::reference()],
        run_seeds: vec![1],
        pinned: BTreeMap::new(),
        settings: BTreeMap::new(),
        review: false,
        order: None,
    })
}

/// Scenarios of which no two are the same work.
fn named(spec: &ScenarioSpec, name: &str, count: u32) -> Result<Vec<ScenarioSpec>, Diagnostic> {
    let one = |number: u32| {
        let id = ScenarioId::new(format!("{name}-{number}")).map_err(|why| super::ours(why.to_string()))?;
        let seed = socrates_model::seeds::derive_seed(u64::from(number), &[name]);
        Ok(ScenarioSpec { id, seed, ..spec.clone() })
    };
    (0..count).map(one).collect()
}

/// A question and its answer through the router, without anything else, ms, median.
async fn round_trip(config: &Config, connect: &str, bus: &dyn Bus) -> Result<f64, Diagnostic> {
    let other = process::client(config, Part::Driver, connect, "main", "echo").await?;
    let mut serving = other.serve(ECHO).await.map_err(|why| super::ours(why.to_string()))?;
    let echo = tokio::spawn(async move {
        while let Some(ask) = serving.next().await {
            let body = ask.body().to_vec();
            drop(ask.reply(body).await);
        }
    });
    let mut times = Vec::with_capacity(TRIPS);
    let begun = Instant::now();
    while times.len() < TRIPS {
        let at = Instant::now();
        match bus.query(ECHO, vec![0; 256], PAUSE * 20).await {
            Ok(_) => times.push(at.elapsed().as_secs_f64() * 1e3),
            Err(_) if begun.elapsed() < START => {}
            Err(why) => return Err(super::ours(why.to_string())),
        }
    }
    other.close().await;
    echo.abort();
    times.sort_by(f64::total_cmp);
    Ok(super::spread(&times).0)
}

/// What a stage takes where nothing else is made, ms, median: a scenario of jobs that do nothing, one after another, by its stages.
async fn alone(bus: &dyn Bus, spec: &ScenarioSpec) -> Result<f64, Diagnostic> {
    let mut times = Vec::new();
    for one in named(spec, "alone", u32::try_from(ALONE).unwrap_or(u32::MAX))? {
        let before = calls::counts(bus, "").await.map_err(|why| super::ours(why.to_string()))?.done;
        let begun = Instant::now();
        calls::submit(bus, "alone", Priority::Normal, vec![one]).await?;
        // Asked as often as it answers: a pause would be measured with it.
        while calls::counts(bus, "").await.is_ok_and(|reply| reply.done == before) {
            if begun.elapsed() > START {
                return Err(super::ours("a scenario was not made".to_owned()));
            }
        }
        times.push(begun.elapsed().as_secs_f64() * 1e3 / f64::from(STAGES));
    }
    times.sort_by(f64::total_cmp);
    Ok(super::spread(&times).0)
}

/// How far it was, when, and how large the orchestrator was then.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at_s: f64,
    done: u32,
    mb: f64,
}

/// What a stream of scenarios took.
struct Made {
    scenarios: u32,
    samples: Vec<Sample>,
    cpu_s: f64,
}

/// Hands in all scenarios and waits for the last.
async fn stream(bus: &dyn Bus, spec: &ScenarioSpec, scenarios: u32, orchestrator: u32) -> Result<Made, Diagnostic> {
    let count = || async { calls::counts(bus, "").await.map(|reply| reply.done).ok() };
    let before = count().await.unwrap_or_default();
    let cpu_before = machine::cpu_s(orchestrator);
    let begun = Instant::now();
    let handed_in = calls::submit(bus, "stream", Priority::Normal, named(spec, "stream", scenarios)?);
    let mut samples = Vec::new();
    let looked = async {
        loop {
            if let Some(done) = count().await {
                let done = done.saturating_sub(before);
                samples.push(Sample {
                    at_s: begun.elapsed().as_secs_f64(),
                    done,
                    mb: machine::resident_mb(orchestrator),
                });
                if done >= scenarios {
                    return;
                }
            }
            tokio::time::sleep(PAUSE).await;
        }
    };
    let (came, ()) = tokio::join!(handed_in, looked);
    came?;
    Ok(Made { scenarios, samples, cpu_s: machine::cpu_s(orchestrator) - cpu_before })
}

impl Made {
    /// When so many scenarios were done, s, between two looks by their share.
    fn when(&self, done: f64) -> f64 {
        let mut last = Sample { at_s: 0.0, done: 0, mb: 0.0 };
        for sample in &self.samples {
            if f64::from(sample.done) >= done {
                let share = (done - f64::from(last.done)) / f64::from(sample.done - last.done).max(1.0);
                return last.at_s + share * (sample.at_s - last.at_s);
            }
            last = *sample;
        }
        last.at_s
    }

    /// Jobs a second in each block.
    fn rates(&self) -> Vec<f64> {
        let blocks = u32::try_from(BLOCKS).unwrap_or(1);
        let edge = |block: u32| f64::from(self.scenarios) * f64::from(block) / f64::from(blocks);
        let rate = |block: u32| {
            let (from, to) = (edge(block), edge(block + 1));
            f64::from(STAGES) * (to - from) / (self.when(to) - self.when(from)).max(1e-9)
        };
        (0..blocks).map(rate).collect()
    }
}

/// Change of a rate over all blocks by the line that fits them best, as a share of their mean; the first and the last block, in which
/// work is still handed in or runs out, are left out.
fn slope(rates: &[f64]) -> f64 {
    let inner = rates.get(1..rates.len().saturating_sub(1)).unwrap_or_default();
    let count = inner.len() as f64;
    let mean = inner.iter().sum::<f64>() / count;
    let middle = (count - 1.0) / 2.0;
    let (mut over, mut under) = (0.0, 0.0);
    for (place, rate) in inner.iter().enumerate() {
        let off = place as f64 - middle;
        over += off * (rate - mean);
        under += off * off;
    }
    over / under * (count - 1.0) / mean
}

fn told(talk: &Printer, options: &JobsOptions, made: &Made, trip_ms: f64, alone_ms: f64) {
    let jobs = made.scenarios * STAGES;
    let wall_s = made.samples.last().map_or(f64::NAN, |last| last.at_s);
    let (rates, mb) = (made.rates(), made.samples.iter().map(|sample| sample.mb));
    let (peak, third) =
        (mb.clone().fold(0.0, f64::max), made.samples.get(made.samples.len() / 3).map_or(0.0, |one| one.mb));
    let slope = slope(&rates);
    talk.line(&format!(
        "jobs       {jobs} that wait {} ms, {} workers here and {} elsewhere, store on disk: {wall_s:.1} s · {:.0} jobs/s",
        options.wait_ms,
        options.workers,
        options.others,
        f64::from(jobs) / wall_s
    ));
    let blocks: Vec<String> = rates.iter().map(|rate| format!("{rate:.0}")).collect();
    talk.line(&format!(
        "blocks     {} jobs/s by tenths · {:+.1} % over the inner eight",
        blocks.join(" "),
        slope * 1e2
    ));
    talk.line(&format!(
        "alone      {alone_ms:.2} ms a stage, one scenario at a time · {trip_ms:.2} ms a bare round trip · {:.2} ms between",
        alone_ms - trip_ms - f64::from(options.wait_ms)
    ));
    talk.line(&format!(
        "memory     {peak:.0} MB of the orchestrator at most, {third:.0} MB after a third · {:.2} ms of its CPU a job",
        made.cpu_s * 1e3 / f64::from(jobs)
    ));
    talk.result(&json!({
        "jobs": jobs, "workers": options.workers, "others": options.others, "wait_ms": options.wait_ms, "wall_s": wall_s, "jobs_per_s": f64::from(jobs) / wall_s,
        "blocks_per_s": rates, "slope": slope, "stage_ms": alone_ms, "round_trip_ms": trip_ms, "peak_mb": peak, "third_mb": third,
        "orchestrator_cpu_ms_per_job": made.cpu_s * 1e3 / f64::from(jobs),
    }));
}
