//! The process as workers and clients see it, over the memory bus and a real store.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use socrates_kit::{LocalBlobs, Stop};
use socrates_link::{Bus, MemoryBus, Overflow, call, decode, keys};
use socrates_model::job::{Artifact, Stage};
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatReply, Chosen, Control, Grant, Hello, NoWork, Notice, Outcome, Part, Priority,
    Recorded, Report, ScenarioSpec, StatusAsk, StatusReply, Steer, Steered, Submit, Submitted, Wait, Welcome,
};
use socrates_model::{Digest, ScenarioEnd, ScenarioId, Verdict};
use tokio::sync::watch;
use tokio::task::JoinHandle;

use super::{OrchestratorConfig, serve};

const LIMIT: Duration = Duration::from_secs(20);

/// A running orchestrator and a client of it.
struct Site {
    bus: Arc<dyn Bus>,
    blobs: LocalBlobs,
    stop: watch::Sender<Stop>,
    running: JoinHandle<anyhow::Result<()>>,
}

fn config(dir: &Path) -> OrchestratorConfig {
    OrchestratorConfig {
        dir: dir.to_owned(),
        lease_ms: 15_000,
        beat_ms: 2_000,
        deadlines_ms: (120_000, 1_200_000, 60_000),
        repairs: 3,
        asks_again: 3,
        author_rates: (0, 0),
        author_budget: (0, 0),
        cents_per_scenario: 0,
        prices: std::collections::BTreeMap::new(),
        circuit_percent: 0,
        durability: socrates_store::Durability::Disk,
        code_version: "1".to_owned(),
        alone: false,
        waits: true,
        metrics: None,
        rules: None,
    }
}

async fn open(dir: &Path) -> Site {
    open_on(Arc::new(MemoryBus::new()), config(dir)).await
}

async fn open_on(bus: Arc<dyn Bus>, config: OrchestratorConfig) -> Site {
    let (stop, shutdown) = watch::channel(Stop::Run);
    let blobs = LocalBlobs::new(config.dir.join("blobs"), false);
    let mut alive = bus.watch_alive(keys::ORCHESTRATORS_ALIVE).await.unwrap();
    let running = tokio::spawn(serve(config, Arc::clone(&bus), shutdown));
    tokio::time::timeout(LIMIT, alive.next()).await.expect("no token").expect("no bus");
    Site { bus, blobs, stop, running }
}

impl Site {
    async fn close(self) {
        let bus = self.leave().await;
        bus.close().await;
    }

    /// Ends the orchestrator; its bus stays for the next one.
    async fn leave(self) -> Arc<dyn Bus> {
        self.stop.send_replace(Stop::Drain);
        tokio::time::timeout(LIMIT, self.running).await.expect("does not stop").unwrap().unwrap();
        self.bus
    }

    async fn ask<Q: serde::Serialize + Sync, A: serde::de::DeserializeOwned>(&self, key: &str, what: &Q) -> A {
        call(&*self.bus, key, super::reader::kind(key), what, LIMIT).await.unwrap()
    }

    fn spec(&self, id: &str) -> ScenarioSpec {
        let input = |text: &str| self.blobs.put(text.as_bytes()).unwrap();
        ScenarioSpec {
            id: ScenarioId::new(id).unwrap(),
            request: input(id),
            location: input("map"),
            reading: input("reading"),
            seed: 1,
            planners: vec![socrates_model::PlannerName::reference()],
            run_seeds: vec![1],
            pinned: BTreeMap::new(),
            settings: BTreeMap::new(),
            review: false,
            order: None,
        }
    }

    async fn submit(&self, id: &str) -> Submitted {
        let submit = Submit::new("b", Priority::Normal, vec![self.spec(id)]);
        self.ask(keys::SUBMIT, &submit).await
    }

    async fn acquire(&self, req_id: &str) -> Acquired {
        self.acquire_as("w", req_id).await
    }

    async fn acquire_as(&self, instance: &str, req_id: &str) -> Acquired {
        let acquire = Acquire {
            req_id: req_id.to_owned(),
            instance: instance.to_owned(),
            stages: Stage::WORKERS.to_vec(),
            credits: 1,
            code_version: "1".to_owned(),
        };
        self.ask(keys::ACQUIRE, &acquire).await
    }

    async fn grant(&self, req_id: &str) -> Grant {
        self.grant_as("w", req_id).await
    }

    async fn grant_as(&self, instance: &str, req_id: &str) -> Grant {
        for _ in 0..100 {
            if let Acquired::Grants(mut grants) = self.acquire_as(instance, req_id).await {
                return grants.remove(0);
            }
        }
        panic!("no work");
    }

    async fn report(&self, grant: &Grant, text: Option<&str>) -> Recorded {
        let report = Report {
            instance: "w".to_owned(),
            key: grant.spec.key.clone(),
            attempt: grant.attempt,
            fence: grant.fence,
            outcome: Outcome::Ok,
            artifacts: vec![Artifact {
                role: socrates_model::Role::made_by(grant.spec.key.stage).unwrap(),
                digest: Digest::of(text.unwrap_or("nowhere").as_bytes()),
                len: 4,
                media: "text/plain".to_owned(),
                inline: text.map(str::to_owned),
            }],
            wall_ms: 1,
            tokens: (0, 0),
            remark: "fine".to_owned(),
            rates: None,
            repair: None,
            anew: Vec::new(),
            verdict: Some(Verdict::Realised),
        };
        self.ask(keys::REPORT, &report).await
    }

    async fn status(&self) -> StatusReply {
        self.ask(keys::STATUS, &StatusAsk::default()).await
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_scenario_is_made_over_the_bus_and_known_after_a_restart() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    let mut notices = site.bus.subscribe(keys::EVENTS, 1000, Overflow::DropOldest).await.unwrap();
    let hello = Hello {
        instance: "w".to_owned(),
        stages: Stage::WORKERS.to_vec(),
        code_version: "1".to_owned(),
        pid: 1,
        host: String::new(),
    };
    let welcome: Welcome = site.ask(keys::HELLO, &hello).await;
    assert!(matches!(welcome, Welcome::Welcome { epoch: 1, lease_ms: 15_000, beat_ms: 2_000 }));
    assert_eq!(site.submit("a").await, Submitted::Accepted { new: 1, held: 0 });
    let first = site.grant("q0").await;
    assert_eq!(site.grant("q0").await, first, "the same question, the same grant");
    assert_eq!(site.report(&first, Some("text")).await, Recorded::Accepted);
    assert_eq!(site.report(&first, Some("text")).await, Recorded::Duplicate);
    assert_eq!(site.blobs.get(&Digest::of(b"text")).unwrap(), b"text", "small contents are artifacts like others");
    let held = site.grant("q1").await;
    // Killed in the middle and started again; the bus is a new one, the folder is not.
    std::fs::remove_file(site.blobs.path(&Digest::of(b"text"))).unwrap();
    site.close().await;
    let site = open(dir.path()).await;
    assert!(site.blobs.has(&Digest::of(b"text")), "the store puts small contents back");
    let beat = Beat { instance: "w".to_owned(), held: Vec::new(), draining: false };
    let reply: BeatReply = site.ask(keys::BEAT, &beat).await;
    assert_eq!(reply.epoch, 2);
    assert_eq!(site.report(&held, Some("more")).await, Recorded::Accepted, "the lease outlived the orchestrator");
    for n in 2..5 {
        let grant = site.grant(&format!("q{n}")).await;
        assert_eq!(site.report(&grant, Some(&format!("text {n}"))).await, Recorded::Accepted);
    }
    let status = site.status().await;
    assert_eq!((status.total, status.done), (1, 1));
    assert_eq!(status.scenarios[0].result, Some(ScenarioEnd::Judged(Verdict::Realised)));
    let (key, body) = tokio::time::timeout(LIMIT, notices.next()).await.unwrap().unwrap();
    let notice = decode::<Notice>("notice", &body).unwrap().body;
    assert!(key.starts_with("ev/b/a") && notice.seq == 1, "{key} {notice:?}");
    site.close().await;
    let store = socrates_store::SqliteStore::open(&dir.path().join("jobs.sqlite")).unwrap();
    assert_eq!(socrates_store::Store::fsck(&store).unwrap(), Vec::<String>::new());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_acquire_waits_a_little_and_is_served_by_what_comes() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    assert!(matches!(site.acquire("idle").await, Acquired::None { reason: NoWork::Empty, .. }));
    // The grant comes to the ask that was there first, or to its repetition.
    let (grant, submitted) = tokio::join!(site.grant("q"), site.submit("a"));
    assert_eq!(submitted, Submitted::Accepted { new: 1, held: 0 });
    assert_eq!(grant.spec.key.stage, Stage::Proposal);
    site.close().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_report_without_its_artifact_is_a_passing_failure() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    site.submit("a").await;
    let grant = site.grant("q").await;
    assert_eq!(site.report(&grant, None).await, Recorded::Accepted);
    let status = site.status().await;
    let job = status.scenarios[0].jobs.iter().find(|job| job.key.stage == Stage::Proposal).unwrap();
    assert_eq!(job.faults[0].code, socrates_model::FaultCode::JBlob);
    assert!(job.artifacts.is_empty());
    site.close().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_cannot_be_read_is_refused_with_a_reason() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    for key in [keys::ACQUIRE, keys::REPORT, keys::SUBMIT, keys::CONTROL] {
        let answer = site.bus.query(key, vec![0xc1; 30], LIMIT).await.unwrap();
        assert!(decode::<u32>("any", &answer).is_err());
    }
    let mut spec = site.spec("a");
    spec.location = Digest::of(b"not there");
    let submit = Submit::new("b", Priority::Normal, vec![spec]);
    let answer: Submitted = site.ask(keys::SUBMIT, &submit).await;
    assert!(matches!(answer, Submitted::Refused { why } if why.contains("location")));
    let requeue = Control::Requeue(ScenarioId::new("nobody").unwrap());
    assert!(call::<Control, u32>(&*site.bus, keys::CONTROL, "control", &requeue, LIMIT).await.is_err());
    let paused: u32 = site.ask(keys::CONTROL, &Control::Pause(String::new())).await;
    assert_eq!(paused, 0);
    site.close().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_is_steered_is_answered_with_what_came_of_it_and_why_jobs_wait_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    site.submit("a").await;
    let pause = Control::Steer(Steer::Pause(Part::Stage(Stage::Proposal)));
    let steered: Steered = site.ask(keys::CONTROL, &pause).await;
    assert_eq!((steered.scenarios, steered.jobs, steered.left.len()), (1, 1, 0));
    // Over a restart as well.
    site.close().await;
    let site = open(dir.path()).await;
    let ask = StatusAsk { job: Some("a/proposal".parse().unwrap()), ..StatusAsk::default() };
    let reply: StatusReply = site.ask(keys::STATUS, &ask).await;
    let whys = reply.whys.unwrap();
    assert!(whys[0].why.contains(&Wait::Paused(Part::Stage(Stage::Proposal))), "{whys:?}");
    let cancel = Control::Steer(Steer::Cancel(Chosen::Scenarios(vec![ScenarioId::new("nobody").unwrap()])));
    let steered: Steered = site.ask(keys::CONTROL, &cancel).await;
    assert!(steered.scenarios == 0 && steered.left[0].unknown, "{steered:?}");
    let list: StatusReply = site.ask(keys::STATUS, &StatusAsk::default()).await;
    assert!(list.batches[0].since_ms > 1_600_000_000_000, "{:?}", list.batches);
    site.close().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_second_orchestrator_on_the_folder_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    let (_stop, shutdown) = watch::channel(Stop::Run);
    let bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
    let refused = tokio::time::timeout(LIMIT, serve(config(dir.path()), bus, shutdown)).await.expect("hangs");
    assert!(refused.unwrap_err().to_string().contains("in use by process"));
    site.close().await;
}

/// Writes a proposal out of nothing.
struct Proposes;

impl socrates_kit::Stage for Proposes {
    const STAGE: Stage = Stage::Proposal;

    async fn run(&self, _job: &socrates_kit::Job) -> Result<socrates_kit::Done, socrates_kit::Failure> {
        let output = socrates_kit::Output::text(socrates_model::Role::Proposal, "text/plain", "a proposal".to_owned());
        Ok(socrates_kit::Done::with(vec![output]))
    }
}

/// Submits a scenario under the same name to the store that is open, and waits until its proposal is made.
async fn proposed(site: &Site, id: &str) {
    assert_eq!(site.submit(id).await, Submitted::Accepted { new: 1, held: 0 });
    let made = async {
        loop {
            let status = site.status().await;
            let scenario = status.scenarios.iter().find(|one| one.id.as_str() == id).unwrap();
            let proposal = scenario.jobs.iter().find(|job| job.key.stage == Stage::Proposal).unwrap();
            assert!(proposal.faults.is_empty(), "{:?}", proposal.faults);
            if proposal.state == socrates_model::JobState::Succeeded {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    tokio::time::timeout(LIMIT, made).await.expect("no worker makes the proposal");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_that_served_reign_3_serves_a_fresh_store_and_a_restored_one() {
    let dirs = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let of = |dir: &Path| OrchestratorConfig { beat_ms: 20, ..config(dir) };
    let (old, fresh) = (dirs[0].path(), dirs[1].path());
    let mut bus: Arc<dyn Bus> = Arc::new(MemoryBus::new());
    let (stop, shutdown) = watch::channel(Stop::Run);
    let spool = tempfile::tempdir().unwrap();
    let settings = socrates_kit::WorkerConfig {
        timeout: Duration::from_millis(500),
        poll: Duration::from_millis(20),
        ..socrates_kit::WorkerConfig::new(socrates_kit::Blobs::Bus, spool.path(), "1")
    };
    let worker = tokio::spawn(socrates_kit::serve(Proposes, Arc::clone(&bus), settings, shutdown));
    for reign in 1..=3 {
        let site = open_on(bus, of(old)).await;
        proposed(&site, &format!("a{reign}")).await;
        bus = site.leave().await;
        if reign == 1 {
            std::fs::copy(old.join("jobs.sqlite"), fresh.join("copy")).unwrap();
        }
    }
    // Reign 1 of a store that knows nothing.
    let site = open_on(bus, of(fresh)).await;
    for id in ["a1", "a2"] {
        proposed(&site, id).await;
    }
    bus = site.leave().await;
    // Reign 2 of the first store as it was after its reign 1.
    for end in ["", "-wal", "-shm"] {
        drop(std::fs::remove_file(old.join(format!("jobs.sqlite{end}"))));
    }
    std::fs::copy(fresh.join("copy"), old.join("jobs.sqlite")).unwrap();
    let site = open_on(bus, of(old)).await;
    proposed(&site, "a2").await;
    stop.send_replace(Stop::Now);
    tokio::time::timeout(LIMIT, worker).await.expect("does not stop").unwrap().unwrap();
    site.close().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_vanished_token_gives_its_job_to_another() {
    let dir = tempfile::tempdir().unwrap();
    let site = open(dir.path()).await;
    site.submit("a").await;
    let token = site.bus.declare_alive(&keys::worker_alive(Stage::Proposal, "w")).await.unwrap();
    let first = site.grant("q").await;
    drop(token);
    // The grace is over in two seconds, long before the lease. Another asks: a question of the one that is gone has no answer.
    let second = tokio::time::timeout(LIMIT, site.grant_as("v", "r")).await.expect("never granted again");
    assert_eq!((second.spec.key, second.attempt), (first.spec.key, 2));
    site.close().await;
}
