//! A worker against an orchestrator of a few lines.
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "helpers of tests may fail the test")]

#[path = "worker/stores.rs"]
mod stores;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use socrates_kit::{
    BlobMove, Blobs, Done, Failure, FaultPlan, Job, KitError, LocalBlobs, Output, Stage, Stop, WorkerConfig, media,
    serve, serve_blobs,
};
use socrates_link::{Ask, Bus, MemoryBus, Qos, ReignId, keys};
use socrates_model::job::{Item, JobKey, JobSpec};
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatReply, BeatVerdict, Grant, Hello, NoWork, Outcome, Recorded, Release, Report, Welcome,
};
use socrates_model::{Digest, FailureClass, FaultCode, Role, ScenarioId, TraceContext};
use tokio::sync::watch;
use tokio::task::JoinHandle;

const WATCHDOG: Duration = Duration::from_secs(60);

async fn guarded<T>(what: impl Future<Output = T>) -> T {
    tokio::time::timeout(WATCHDOG, what).await.expect("within the watchdog's time")
}

/// Writes its input backwards; the settings `do` say what else it does.
struct Backwards(Arc<AtomicU32>);

impl Stage for Backwards {
    const STAGE: socrates_model::job::Stage = socrates_model::job::Stage::Paths;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        self.0.fetch_add(1, Ordering::SeqCst);
        match job.setting("do") {
            Some("panic") => panic!("index out of range"),
            Some("wait") => job.cancel().stopped().await,
            Some("hang") => std::future::pending::<()>().await,
            Some("big") => {
                return Ok(Done::with(vec![Output::bytes(Role::Paths, media::MCAP, vec![7; 200_000])]));
            }
            Some(_) | None => {}
        }
        let text: String = job.text(Role::Proposal)?.chars().rev().collect();
        Ok(Done::with(vec![Output::text(Role::Paths, media::TEXT, text)]).remark("turned"))
    }
}

#[derive(Default)]
struct Office {
    open: VecDeque<Grant>,
    granted: BTreeMap<String, Vec<Grant>>,
    reports: Vec<Report>,
    released: Vec<Release>,
    asked: Vec<String>,
    lose_acquires: u32,
    lose_reports: u32,
    cancel: bool,
    /// What reports and releases said of their trace.
    traces: Vec<Option<TraceContext>>,
    beats: u32,
    /// Reigns after the first.
    reigns: u64,
    /// Number of the store; each has reigns of its own.
    store: u64,
    /// Workers that asked for work of this store.
    instances: BTreeSet<String>,
    /// Questions of workers of other stores.
    disowned: u32,
    /// The orchestrator of another store answers two of three beats.
    intruded: bool,
    beaten: u32,
    hellos: u32,
    /// A job that is handed back is granted again at once, to whoever asks.
    eager: bool,
}

impl Office {
    /// Reign `epoch` of the store.
    fn reign(&self, epoch: u64) -> ReignId {
        ReignId(100 * self.store + epoch)
    }

    /// Whether a worker of that reign is one of this store, in this state or an earlier one.
    fn knows(&self, asked: ReignId) -> bool {
        (1..=1 + self.reigns).any(|epoch| self.reign(epoch) == asked)
    }

    /// The present reign and its id, and whether a question is answered in it.
    fn admit(&mut self, ask: &Ask) -> (u64, ReignId, bool) {
        let beaten = ask.key() == keys::BEAT && self.intruded;
        self.beaten += u32::from(beaten);
        let intruder = beaten && !self.beaten.is_multiple_of(3);
        let known = asked_in(ask).is_none_or(|asked| self.knows(asked)) && !intruder;
        self.disowned += u32::from(!known);
        let reign = 1 + self.reigns;
        (reign, self.reign(reign), known)
    }
}

/// The reign that a question is for.
fn asked_in(ask: &Ask) -> Option<ReignId> {
    ask.read::<serde::de::IgnoredAny>(ask.key().rsplit('/').next().unwrap()).unwrap().reign
}

/// Serves the worker protocol the way the orchestrator would.
fn office(bus: &MemoryBus) -> (Arc<Mutex<Office>>, JoinHandle<()>) {
    let state = Arc::new(Mutex::new(Office::default()));
    let (shared, bus) = (Arc::clone(&state), bus.named("office"));
    let task = tokio::spawn(async move {
        let mut all = bus.serve("rpc/*").await.unwrap();
        while let Some(ask) = all.next().await {
            let key = ask.key().to_owned();
            let (reign, id, known) = shared.lock().unwrap().admit(&ask);
            let ask = ask.in_reign(id);
            if !known {
                ask.disown("office", reign).await.unwrap();
                continue;
            }
            match key.as_str() {
                keys::HELLO => {
                    ask.read::<Hello>("hello").unwrap();
                    shared.lock().unwrap().hellos += 1;
                    ask.answer("hello", "office", reign, &Welcome::Welcome { epoch: 1, lease_ms: 1000, beat_ms: 20 })
                        .await
                        .unwrap();
                }
                keys::ACQUIRE => {
                    let acquire = ask.read::<Acquire>("acquire").unwrap().body;
                    let reply = {
                        let mut office = shared.lock().unwrap();
                        office.asked.push(acquire.req_id.clone());
                        office.instances.insert(acquire.instance);
                        let known = office.granted.get(&acquire.req_id).cloned();
                        let grants = known.unwrap_or_else(|| {
                            let credits = office.open.len().min(acquire.credits as usize);
                            office.open.drain(..credits).collect()
                        });
                        office.granted.insert(acquire.req_id, grants.clone());
                        if office.lose_acquires > 0 && !grants.is_empty() {
                            office.lose_acquires -= 1;
                            None
                        } else if grants.is_empty() {
                            Some(Acquired::None { retry_after_ms: 60_000, reason: NoWork::Empty })
                        } else {
                            Some(Acquired::Grants(grants))
                        }
                    };
                    // A lost answer: the ask is dropped and the worker hears no reply.
                    if let Some(reply) = reply {
                        ask.answer("acquire", "office", reign, &reply).await.unwrap();
                    }
                }
                keys::BEAT => {
                    let beat = ask.read::<Beat>("beat").unwrap().body;
                    let reply = {
                        let mut office = shared.lock().unwrap();
                        office.beats += 1;
                        let verdict = if office.cancel { BeatVerdict::Cancel } else { BeatVerdict::Ok };
                        let verdicts = beat.held.into_iter().map(|held| (held.key, held.attempt, verdict)).collect();
                        BeatReply { verdicts, missing: vec![], epoch: 1 }
                    };
                    ask.answer("beat", "office", reign, &reply).await.unwrap();
                }
                keys::REPORT => {
                    let envelope = ask.read::<Report>("report").unwrap();
                    let report = envelope.body;
                    let recorded = {
                        let mut office = shared.lock().unwrap();
                        office.traces.push(envelope.traceparent);
                        let same = |r: &Report| r.key == report.key && r.attempt == report.attempt;
                        let known = office.reports.iter().any(same);
                        let granted = office.instances.contains(&report.instance);
                        if granted && !known {
                            office.reports.push(report);
                        }
                        if office.lose_reports > 0 {
                            office.lose_reports -= 1;
                            None
                        } else if granted {
                            Some(if known { Recorded::Duplicate } else { Recorded::Accepted })
                        } else {
                            Some(Recorded::Late)
                        }
                    };
                    if let Some(recorded) = recorded {
                        ask.answer("report", "office", reign, &recorded).await.unwrap();
                    }
                }
                keys::RELEASE => {
                    let envelope = ask.read::<Release>("release").unwrap();
                    let release = envelope.body;
                    let mut hinted = false;
                    {
                        let mut office = shared.lock().unwrap();
                        office.traces.push(envelope.traceparent);
                        let granted = office.granted.values().flatten().find(|grant| grant.spec.key == release.key);
                        let again = granted.cloned().filter(|_| office.eager);
                        if let Some(grant) = again {
                            let attempt = release.attempt + 1;
                            office.open.push_back(Grant { attempt, fence: release.fence + 1, ..grant });
                            hinted = true;
                        }
                        office.released.push(release);
                    }
                    if hinted {
                        bus.publish(&keys::hint(socrates_model::job::Stage::Paths), vec![], Qos::Hint).await.unwrap();
                    }
                    ask.answer("release", "office", reign, &Recorded::Accepted).await.unwrap();
                }
                other => panic!("unexpected key {other}"),
            }
        }
    });
    (state, task)
}

fn grant(number: u32, text: &str, act: &str) -> Grant {
    let key = JobKey {
        scenario: ScenarioId::new(format!("s{number}")).unwrap(),
        stage: socrates_model::job::Stage::Paths,
        item: Item::Whole,
        revision: 0,
    };
    let digest = Digest::of(text.as_bytes());
    let spec = JobSpec {
        key,
        inputs: BTreeMap::from([(Role::Proposal, digest)]),
        seed: 1,
        feedback: vec![],
        refused: None,
        settings: BTreeMap::from([("do".to_owned(), act.to_owned())]),
    };
    let idem_key = spec.idem_key("t");
    let inline = BTreeMap::from([(digest, text.to_owned())]);
    let traceparent = Some(format!("00-{:032x}-00f067aa0ba902b7-01", number + 1).parse().unwrap());
    Grant { spec, attempt: 1, fence: 1, lease_ms: 1000, deadline_ms: 20_000, idem_key, inline, traceparent }
}

struct Rig {
    bus: MemoryBus,
    office: Arc<Mutex<Office>>,
    runs: Arc<AtomicU32>,
    stop: watch::Sender<Stop>,
    _office_task: JoinHandle<()>,
}

impl Rig {
    fn new() -> Self {
        let bus = MemoryBus::new();
        let (office, task) = office(&bus);
        Self { bus, office, runs: Arc::default(), stop: watch::Sender::new(Stop::Run), _office_task: task }
    }

    fn config(dir: &Path) -> WorkerConfig {
        let mut config =
            WorkerConfig::new(Blobs::Local(LocalBlobs::new(dir.join("blobs"), false)), dir.join("spool"), "t");
        config.durable = false;
        config.timeout = Duration::from_millis(500);
        config
    }

    fn worker(&self, config: WorkerConfig) -> JoinHandle<Result<(), KitError>> {
        let bus: Arc<dyn Bus> = Arc::new(self.bus.named("worker"));
        tokio::spawn(serve(Backwards(Arc::clone(&self.runs)), bus, config, self.stop.subscribe()))
    }

    async fn open(&self, grant: Grant) {
        self.office.lock().unwrap().open.push_back(grant);
        self.bus.publish(&keys::hint(socrates_model::job::Stage::Paths), vec![], Qos::Hint).await.unwrap();
    }

    async fn until(&self, holds: impl Fn(&Office) -> bool) {
        while !holds(&self.office.lock().unwrap()) {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
    }
}

fn spooled(dir: &Path) -> usize {
    std::fs::read_dir(dir.join("spool"))
        .unwrap()
        .filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|x| x == "report"))
        .count()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_job_is_done_reported_once_and_its_spool_is_empty_again() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        rig.open(grant(1, "abc", "")).await;
        rig.open(grant(2, "xyz", "big")).await;
        rig.until(|office| office.reports.len() == 2).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        assert_eq!(office.reports[0].outcome, Outcome::Ok);
        assert_eq!(office.reports[0].remark, "turned");
        assert_eq!(office.reports[0].artifacts[0].inline.as_deref(), Some("cba"));
        // Large outputs go to the artifact store before the report is made.
        let big = &office.reports[1].artifacts[0];
        assert_eq!((big.inline.as_ref(), big.len), (None, 200_000));
        assert_eq!(LocalBlobs::new(dir.path().join("blobs"), false).get(&big.digest).unwrap(), vec![7; 200_000]);
        assert_eq!(spooled(dir.path()), 0);
        let traces: Vec<_> = [1, 2].map(|number| grant(number, "", "").traceparent).into();
        assert!(traces[0].is_some() && office.traces == traces, "a report says of which trace it is");
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_lost_grant_is_asked_for_under_the_same_id_and_run_once() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().lose_acquires = 2;
        rig.office.lock().unwrap().open.push_back(grant(1, "abc", ""));
        let worker = rig.worker(Rig::config(dir.path()));
        rig.until(|office| office.reports.len() == 1).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        assert!(office.asked.len() >= 3 && office.asked[0] == office.asked[1] && office.asked[1] == office.asked[2]);
        assert_eq!(rig.runs.load(Ordering::SeqCst), 1);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_report_is_sent_until_it_is_recorded() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().lose_reports = 2;
        let mut config = Rig::config(dir.path());
        config.faults = FaultPlan::parse("drop_report=1").unwrap();
        let worker = rig.worker(config);
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1 && office.lose_reports == 0).await;
        while spooled(dir.path()) > 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        assert_eq!(rig.runs.load(Ordering::SeqCst), 1);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_killed_workers_report_is_sent_by_its_successor() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().lose_reports = u32::MAX;
        let first = rig.worker(Rig::config(dir.path()));
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1).await;
        first.abort();
        assert!(first.await.unwrap_err().is_cancelled());
        assert_eq!(spooled(dir.path()), 1);
        {
            let mut office = rig.office.lock().unwrap();
            office.reports.clear();
            office.lose_reports = 0;
        }
        let second = rig.worker(Rig::config(dir.path()));
        rig.until(|office| office.reports.len() == 1).await;
        while spooled(dir.path()) > 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        rig.stop.send_replace(Stop::Drain);
        second.await.unwrap().unwrap();
        assert_eq!(rig.runs.load(Ordering::SeqCst), 1);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn planned_deaths_end_the_worker_where_they_should() {
    guarded(async {
        for (plan, sent) in [("die_before_report=1", 0), ("die_after_report=1", 1)] {
            let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
            let mut config = Rig::config(dir.path());
            config.faults = FaultPlan::parse(plan).unwrap();
            rig.office.lock().unwrap().open.push_back(grant(1, "abc", ""));
            let died = rig.worker(config).await.unwrap();
            assert!(matches!(died, Err(KitError::InjectedDeath { .. })), "{plan}");
            assert_eq!(rig.office.lock().unwrap().reports.len(), sent, "{plan}");
            assert_eq!(spooled(dir.path()), sent, "{plan}");
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_panic_is_poison_a_missing_input_is_passing_and_a_hang_ends_at_its_deadline() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        let mut lost = grant(2, "abc", "");
        lost.inline.clear();
        let mut hangs = grant(3, "abc", "hang");
        hangs.deadline_ms = 50;
        rig.open(grant(1, "abc", "panic")).await;
        rig.open(lost).await;
        rig.open(hangs).await;
        rig.until(|office| office.reports.len() == 3).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        let mut ends: Vec<(FailureClass, FaultCode)> = office
            .reports
            .iter()
            .map(|report| match &report.outcome {
                Outcome::Failed { class, faults, .. } => (*class, faults[0].code),
                Outcome::Ok => panic!("{} is no success", report.key),
            })
            .collect();
        // The jobs run side by side, so their ends have no order of their own.
        ends.sort_unstable();
        let mut expected = [
            (FailureClass::Poison, FaultCode::JPanic),
            (FailureClass::Transient, FaultCode::JBlob),
            (FailureClass::Transient, FaultCode::JDeadline),
        ];
        expected.sort_unstable();
        assert_eq!(ends, expected);
        // The pages of the two that no other test provokes show what was found here.
        for report in &office.reports {
            if let Outcome::Failed { faults, .. } = &report.outcome
                && matches!(faults[0].code, FaultCode::JPanic | FaultCode::JBlob)
            {
                let (page, shown) = (faults[0].code.page(), faults[0].to_string());
                assert!(page.contains(&format!("```text\n{shown}\n```")), "its page does not show\n{shown}");
            }
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_canceled_job_stops_and_is_not_reported() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        rig.open(grant(1, "abc", "hang")).await;
        rig.until(|office| office.granted.values().any(|grants| !grants.is_empty())).await;
        rig.office.lock().unwrap().cancel = true;
        rig.until(|office| office.released.len() == 1).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        assert!(rig.office.lock().unwrap().reports.is_empty());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_told_to_stop_now_hands_back_what_it_holds() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        rig.open(grant(1, "abc", "hang")).await;
        while rig.runs.load(Ordering::SeqCst) == 0 {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        rig.stop.send_replace(Stop::Now);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        assert_eq!(office.released.len(), 1);
        assert!(office.reports.is_empty());
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_leaves_is_not_given_again_what_it_hands_back() {
    guarded(async {
        for _ in 0..20 {
            let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
            rig.office.lock().unwrap().eager = true;
            let worker = rig.worker(Rig::config(dir.path()));
            rig.open(grant(1, "abc", "hang")).await;
            while rig.runs.load(Ordering::SeqCst) == 0 {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
            rig.stop.send_replace(Stop::Now);
            worker.await.unwrap().unwrap();
            let office = rig.office.lock().unwrap();
            assert_eq!(office.open.len(), 1, "the job waits for the next one: {:?}", office.released);
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_tells_a_new_orchestrator_who_it_is() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        rig.until(|office| office.beats > 2).await;
        assert_eq!(rig.office.lock().unwrap().hellos, 1);
        rig.office.lock().unwrap().reigns = 1;
        rig.until(|office| office.hellos == 2).await;
        let beats = rig.office.lock().unwrap().beats;
        rig.until(|office| office.beats > beats + 3).await;
        assert_eq!(rig.office.lock().unwrap().hellos, 2, "once for each");
        rig.stop.send_replace(Stop::Now);
        worker.await.unwrap().unwrap();
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_supervised_worker_ends_with_the_reason_when_nothing_can_be_written() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let mut config = Rig::config(dir.path());
        config.waits_for_disk = false;
        // A file where a folder has to be: no write succeeds, whoever the user is.
        std::fs::write(dir.path().join("blobs"), "").unwrap();
        let worker = rig.worker(config);
        rig.open(grant(1, "abc", "big")).await;
        let why = worker.await.unwrap().unwrap_err();
        assert!(matches!(&why, KitError::Folder { path, .. } if path.starts_with(dir.path().join("blobs"))), "{why}");
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn artifacts_cross_the_bus_in_parts() {
    guarded(async {
        let dir = tempfile::tempdir().unwrap();
        let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
        let moves = Arc::new(Mutex::new(Vec::new()));
        let told = Arc::clone(&moves);
        let seen = move |moved: BlobMove| told.lock().unwrap().push(moved);
        let server = tokio::spawn(serve_blobs(Arc::clone(&bus), LocalBlobs::new(dir.path(), false), seen));
        let bytes: Vec<u8> = (0..150_001_u32).map(|n| n.to_le_bytes()[0]).collect();
        let limit = Duration::from_secs(5);
        let digest = Blobs::Bus.put(&bus, bytes.clone(), limit).await.unwrap();
        assert_eq!(Blobs::Bus.get(&bus, digest, limit).await.unwrap(), bytes);
        let empty = Blobs::Bus.put(&bus, vec![], limit).await.unwrap();
        assert!(Blobs::Bus.get(&bus, empty, limit).await.unwrap().is_empty());
        assert!(Blobs::Bus.get(&bus, Digest::of(b"nobody"), limit).await.is_err());
        let strange: Result<u64, _> = socrates_link::call(&*bus, keys::BLOB_PUT, "blob_put", &7, limit).await;
        assert!(strange.is_err());
        // Four parts each way, the empty one each way, what is not there and what cannot be read: each is told after its answer went out.
        while moves.lock().unwrap().len() < 12 {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        server.abort();
        let moves = moves.lock().unwrap();
        for put in [true, false] {
            let own = moves.iter().filter(|moved| moved.put == put);
            let (bytes, whole) = own.fold((0, 0), |sum, moved| (sum.0 + moved.bytes, sum.1 + u32::from(moved.whole)));
            assert_eq!((bytes, whole), (150_001, 2), "{put}: both artifacts, all bytes");
        }
        assert_eq!(moves.iter().filter(|moved| moved.refused).count(), 1, "{moves:?}");
    })
    .await;
}

#[expect(clippy::print_stdout, reason = "a time is shown to people, never judged")]
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn many_jobs_pass_with_little_overhead() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        let worker = rig.worker(Rig::config(dir.path()));
        let begun = Instant::now();
        for n in 0..100 {
            rig.open(grant(n, "abc", "")).await;
        }
        rig.until(|office| office.reports.len() == 100).await;
        // Shown, not judged: a busy machine says nothing about the code.
        println!("{:?} per job", begun.elapsed() / 100);
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        assert_eq!(rig.runs.load(Ordering::SeqCst), 100);
    })
    .await;
}
