//! What each role may do on a router with keys. What is refused is dropped without a word, so each fact is read at the other end.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use socrates_link::rules::{Role, router_config};
use socrates_link::{Bus, LinkError, Overflow, Qos, ZenohBus, keys};
use socrates_model::job::{MESSAGE_BYTES, Stage};

use crate::deployment::{Deployment, text_of};
use crate::promises::over_zenoh::free_udp_port;
use crate::promises::{SOON, ask_until_served, guarded, until};

const GUESTS: [Role; 4] = [Role::Worker, Role::Client, Role::Viewer, Role::Driver];

/// Serves a key from now on, and remembers what it was asked.
async fn served(bus: &dyn Bus, key: &str) -> Arc<Mutex<Vec<String>>> {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let (mut serving, kept) = (bus.serve(key).await.unwrap(), Arc::clone(&heard));
    drop(tokio::spawn(async move {
        while let Some(ask) = serving.next().await {
            kept.lock().unwrap().push(String::from_utf8_lossy(ask.body()).into_owned());
            ask.reply(b"yes".to_vec()).await.unwrap();
        }
    }));
    heard
}

/// Publishes under a key until somebody hears it; gives everything that was heard by then.
async fn told(from: &dyn Bus, key: &str, word: &[u8], inbox: &mut socrates_link::Subscription) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    loop {
        from.publish(key, word.to_vec(), Qos::Control).await.unwrap();
        while let Ok(Some((_, body))) = tokio::time::timeout(Duration::from_millis(50), inbox.next()).await {
            all.push(body);
        }
        if all.iter().any(|body| body == word) {
            return all;
        }
    }
}

async fn close(all: &[&ZenohBus]) {
    for bus in all {
        bus.close().await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_question_reaches_the_orchestrator_from_the_roles_that_may_put_it_alone() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = deployment.router().await;
        let mut asked = Vec::new();
        for key in keys::RPC {
            asked.push((key, served(&router, key).await));
        }
        for role in GUESTS {
            let guest = deployment.guest(role, &endpoint).await;
            let own: &[&str] = match role {
                Role::Worker => &[
                    keys::HELLO,
                    keys::ACQUIRE,
                    keys::BEAT,
                    keys::REPORT,
                    keys::RELEASE,
                    keys::BLOB_GET,
                    keys::BLOB_PUT,
                ],
                Role::Client => {
                    &[keys::SUBMIT, keys::CONTROL, keys::STATUS, keys::PAST, keys::BLOB_GET, keys::BLOB_PUT]
                }
                Role::Viewer => &[keys::BLOB_GET],
                Role::Driver | Role::Orchestrator | Role::Router => &[],
            };
            for key in own {
                assert_eq!(ask_until_served(&guest, key, role.name().as_bytes()).await, b"yes", "{role} {key}");
            }
            for (key, heard) in &asked {
                let answer = guest.query(key, role.name().as_bytes().to_vec(), SOON).await;
                assert_eq!(answer.is_ok(), own.contains(key), "{role} {key}: {answer:?}");
                let reached = heard.lock().unwrap().iter().any(|name| name == role.name());
                assert_eq!(reached, own.contains(key), "{role} {key}");
            }
            guest.close().await;
        }
        router.close().await;
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_does_everything_that_its_work_needs() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = deployment.router().await;
        let worker = deployment.guest(Role::Worker, &endpoint).await;
        let viewer = deployment.guest(Role::Viewer, &endpoint).await;
        let driver = deployment.guest(Role::Driver, &endpoint).await;
        // It is present, and hears hints and commands.
        let mut presence = router.watch_alive(keys::WORKERS_ALIVE).await.unwrap();
        let alive = worker.declare_alive(&keys::worker_alive(Stage::Paths, "w1")).await.unwrap();
        assert_eq!(presence.next().await.unwrap(), ("live/worker/paths/w1".to_owned(), true));
        drop(alive);
        assert_eq!(presence.next().await.unwrap(), ("live/worker/paths/w1".to_owned(), false));
        for key in [keys::hint(Stage::Paths), keys::command("w1")] {
            let mut inbox = worker.subscribe(&key, 64, Overflow::DropOldest).await.unwrap();
            told(&router, &key, b"work", &mut inbox).await;
        }
        // It tells of a run, knows whether anybody listens, and is asked about the run.
        let publisher = worker.publisher("live/r1/agents", Qos::Stream).await.unwrap();
        assert!(!publisher.is_heard());
        let mut eyes = viewer.subscribe("live/*/agents", 64, Overflow::DropOldest).await.unwrap();
        until(|| publisher.is_heard()).await;
        publisher.put(vec![7]).await.unwrap();
        assert_eq!(eyes.next().await.unwrap().1, [7]);
        let _heard = served(&worker, "live/r1/*").await;
        assert_eq!(ask_until_served(&viewer, "live/r1/meta", &[]).await, b"yes");
        assert_eq!(viewer.query_all(keys::RUNS, vec![], 8, SOON).await.unwrap(), [b"yes"]);
        // It finds a driver and asks it.
        let mut claims = worker.watch_alive(keys::DRIVERS_ALIVE).await.unwrap();
        let _asked = served(&driver, &keys::drive_mission("mine")).await;
        let _stepped = served(&driver, &keys::drive_step("mine")).await;
        let _claim = driver.declare_alive(&keys::drive_claim("mine", "1")).await.unwrap();
        assert_eq!(claims.next().await.unwrap(), ("drive/mine/claim/1".to_owned(), true));
        assert_eq!(ask_until_served(&worker, &keys::drive_step("mine"), &[]).await, b"yes");
        let _runs = served(&router, keys::SERVE_RUN).await;
        assert_eq!(ask_until_served(&driver, keys::SERVE_RUN, &[]).await, b"yes");
        close(&[&worker, &viewer, &driver, &router]).await;
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nobody_plays_the_part_of_another() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = deployment.router().await;
        let mut hears = router.subscribe("**", 256, Overflow::DropOldest).await.unwrap();
        let mut presence = router.watch_alive("**").await.unwrap();
        let worker = deployment.guest(Role::Worker, &endpoint).await;
        for (role, allowed) in
            [(Role::Client, keys::STATUS), (Role::Viewer, keys::BLOB_GET), (Role::Driver, keys::SERVE_RUN)]
        {
            let _answers = served(&router, allowed).await;
            let guest = deployment.guest(role, &endpoint).await;
            for key in ["live/r1/agents", "live/r1/meta", "hint/paths", "cmd/w1", "ev/b/s"] {
                drop(guest.publish(key, b"forged".to_vec(), Qos::Control).await);
            }
            // They serve what is not theirs: they are not asked, by anybody.
            for key in [keys::ACQUIRE, keys::REPORT, "live/r9/*"] {
                let _heard = served(&guest, key).await;
            }
            let _token = guest.declare_alive(&keys::worker_alive(Stage::Paths, role.name())).await;
            let _master = guest.declare_alive(&keys::orchestrator_alive(role.name())).await;
            let mut nosy = guest.subscribe("**", 64, Overflow::DropOldest).await.unwrap();
            // Something that may pass, from the same guest and after it, tells that all of it was judged.
            ask_until_served(&guest, allowed, &[]).await;
            let measure = deployment.guest(Role::Orchestrator, &endpoint).await;
            let all = told(&measure, "ev/fence", b"fence", &mut hears).await;
            assert!(!all.iter().any(|body| body == b"forged"), "{role}: {all:?}");
            for key in [keys::ACQUIRE, keys::REPORT, "live/r9/meta"] {
                let why = router.query(key, vec![], SOON).await.unwrap_err();
                assert!(matches!(why, LinkError::NoReply { .. }), "{role} {key}: {why}");
                assert!(worker.query(key, vec![], SOON).await.is_err(), "{role} {key}");
            }
            assert!(nosy.try_next().is_none(), "{role} heard everything");
            close(&[&guest, &measure]).await;
        }
        // What they told under keys of others would have come before this.
        let _alive = worker.declare_alive(&keys::worker_alive(Stage::Paths, "true")).await.unwrap();
        assert_eq!(presence.next().await.unwrap(), ("live/worker/paths/true".to_owned(), true));
        // A worker is no orchestrator and no client.
        let _heard = served(&worker, keys::SUBMIT).await;
        assert!(router.query(keys::SUBMIT, vec![], SOON).await.is_err());
        close(&[&worker, &router]).await;
    })
    .await;
}

/// A router that is a program of its own, from the shipped configuration.
async fn shipped_router(deployment: &Deployment) -> (zenoh::Session, String) {
    let (folder, endpoint) = (deployment.folder(Role::Router), format!("quic/127.0.0.1:{}", free_udp_port()));
    let mut text = std::fs::read_to_string(folder.join("router.json5")).unwrap();
    assert_eq!(text, router_config());
    for name in ["ca.pem", "cert.pem", "key.pem"] {
        text = text.replace(&format!("{name:?}"), &text_of(&folder.join(name)));
    }
    let config = zenoh::Config::from_json5(&text.replace("quic/0.0.0.0:7447", &endpoint)).unwrap();
    (zenoh::open(config).await.unwrap(), endpoint)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_viewer_by_the_shipped_rules_reads_live_keys_and_nothing_else() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = shipped_router(&deployment).await;
        let run = deployment.guest(Role::Worker, &endpoint).await;
        let other = deployment.guest(Role::Orchestrator, &endpoint).await;
        let viewer = deployment.guest(Role::Viewer, &endpoint).await;
        // What a viewer may: ask a run, and hear it.
        let _run = served(&run, "live/r1/*").await;
        assert_eq!(ask_until_served(&viewer, "live/r1/meta", &[]).await, b"yes");
        let mut hears = viewer.subscribe("live/**", 64, Overflow::DropOldest).await.unwrap();
        told(&run, "live/r1/latest", b"seen", &mut hears).await;
        // What it may not: tell, serve, be present, ask for work, hear anything else. A process that may is the measure.
        let mut others = other.subscribe("**", 64, Overflow::DropOldest).await.unwrap();
        let mut presence = other.watch_alive("**").await.unwrap();
        let asked = served(&other, keys::ACQUIRE).await;
        assert_eq!(ask_until_served(&run, keys::ACQUIRE, b"run").await, b"yes");
        assert!(viewer.query(keys::ACQUIRE, b"viewer".to_vec(), SOON).await.is_err(), "work was handed to a viewer");
        assert!(!asked.lock().unwrap().iter().any(|name| name == "viewer"));
        let mut nosy = viewer.subscribe("hint/**", 64, Overflow::DropOldest).await.unwrap();
        drop(viewer.publish("live/r1/latest", vec![9], Qos::Control).await);
        drop(viewer.publish("cmd/worker", vec![9], Qos::Control).await);
        let _token = viewer.declare_alive("live/worker/simulation/fake").await;
        let _serving = served(&viewer, keys::HELLO).await;
        assert!(other.query(keys::HELLO, vec![], SOON).await.is_err(), "a viewer was asked");
        let heard = told(&other, "hint/simulation", b"hint", &mut others).await;
        assert!(!heard.contains(&vec![9]), "a viewer told something");
        assert!(nosy.try_next().is_none(), "a viewer heard a hint");
        let seen = tokio::time::timeout(Duration::from_millis(200), presence.next()).await;
        assert!(seen.is_err(), "a viewer is present");
        close(&[&run, &other, &viewer]).await;
        router.close().await.unwrap();
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_message_that_is_too_large_is_refused_where_it_comes_in() {
    guarded(async {
        let deployment = Deployment::new();
        let (router, endpoint) = deployment.router().await;
        let viewer = deployment.guest(Role::Viewer, &endpoint).await;
        let worker = deployment.raw_guest(Role::Worker, &endpoint).await;
        let large = || vec![1_u8; MESSAGE_BYTES + 1];
        let mut hears = viewer.subscribe("live/r1/*", 64, Overflow::DropOldest).await.unwrap();
        let publisher = worker.declare_publisher("soc/v1/t/live/r1/agents").await.unwrap();
        while !publisher.matching_status().await.unwrap().matching() {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let put = |body: Vec<u8>| {
            worker.put("soc/v1/t/live/r1/agents", body).congestion_control(zenoh::qos::CongestionControl::Block)
        };
        put(large()).await.unwrap();
        put(vec![2; MESSAGE_BYTES]).await.unwrap();
        assert_eq!(
            hears.next().await.unwrap().1,
            vec![2; MESSAGE_BYTES],
            "the largest that is allowed comes, no larger one"
        );
        // A question, and an answer.
        let asked = served(&router, keys::REPORT).await;
        let question =
            |body: Vec<u8>| async { worker.get("soc/v1/t/rpc/report").payload(body).await.unwrap().recv_async().await };
        assert!(question(large()).await.is_err(), "a question that is too large was answered");
        assert!(question(vec![3]).await.is_ok());
        assert_eq!(asked.lock().unwrap().len(), 1);
        let _answers = worker
            .declare_queryable("soc/v1/t/live/r1/meta")
            .complete(true)
            .callback(|query| {
                drop(zenoh::Wait::wait(query.reply(query.key_expr().clone(), vec![1_u8; MESSAGE_BYTES + 1])))
            })
            .await
            .unwrap();
        loop {
            match viewer.query("live/r1/meta", vec![], SOON).await {
                Err(LinkError::NoReply { .. }) => tokio::time::sleep(Duration::from_millis(10)).await,
                Err(LinkError::TooLarge { len, .. }) => break assert_eq!(len, MESSAGE_BYTES + 1),
                other => panic!("{other:?}"),
            }
        }
        assert!(viewer.query_all("live/*/meta", vec![], 8, SOON).await.unwrap().is_empty());
        // What fills memory is not even put together, and everybody else goes on.
        put(vec![4; 32 * MESSAGE_BYTES]).await.unwrap();
        let second = deployment.guest(Role::Worker, &endpoint).await;
        told(&second, "live/r1/latest", b"on", &mut hears).await;
        close(&[&viewer, &second, &router]).await;
        drop(worker.close().await);
    })
    .await;
}
