//! Those who are not let in, and what they are told.

use std::os::unix::fs::PermissionsExt as _;
use std::time::Duration;

use socrates_link::rules::Role;
use socrates_link::{Bus as _, Credentials, KeysWish, LinkError, Mode, RoleFile, ZenohBus, ZenohConfig, keys};

use crate::deployment::{DAY_S, Deployment, now_s, raw_client, text_of, write_private};
use crate::promises::over_zenoh::{free_port, free_udp_port};
use crate::promises::{SOON, guarded};

/// Why somebody was not let in; bounded, or the watchdog barks.
async fn refused(config: ZenohConfig) -> String {
    let limit = Duration::from_secs(15);
    match tokio::time::timeout(limit, ZenohBus::open(config)).await.expect("told in time") {
        Ok(_bus) => panic!("a stranger was let in"),
        Err(why) => why.to_string(),
    }
}

fn plain(endpoint: &str) -> ZenohConfig {
    let mut config = ZenohConfig::new(Mode::Client, "t", "stranger").connect(endpoint);
    config.patience = Duration::from_millis(1_000);
    config
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stranger_is_not_let_in_and_told_why() {
    guarded(async {
        let (ours, theirs) = (Deployment::new(), Deployment::new());
        let (router, endpoint) = ours.router().await;
        let mut presence = router.watch_alive("**").await.unwrap();

        let why = refused(plain(&endpoint)).await;
        assert!(why.contains("needs keys") && why.contains("--keys"), "without keys: {why}");
        let why = refused(theirs.guest_config(Role::Worker, &endpoint)).await;
        assert!(why.contains("of another deployment"), "keys of others: {why}");
        let why = refused(plain(&endpoint.replace("quic/", "tcp/"))).await;
        assert!(why.contains("wants keys") && why.contains(&endpoint), "in clear: {why}");
        let by_name = ours.guest_config(Role::Worker, &endpoint.replace("127.0.0.1", "localhost"));
        ZenohBus::open(by_name).await.unwrap().close().await;
        let by_other = endpoint.replace("127.0.0.1", "127.0.0.2");
        let why = refused(ours.guest_config(Role::Worker, &by_other)).await;
        assert!(why.contains("connecting to"), "nobody listens there: {why}");

        // Programs of others: no certificate, and one of another authority that trusts ours.
        let folder = ours.folder(Role::Worker);
        let mut config = raw_client(&endpoint);
        config.insert_json5("transport/link/tls/root_ca_certificate", &text_of(&folder.join("ca.pem"))).unwrap();
        assert!(zenoh::open(config.clone()).await.is_err(), "no certificate");
        let foreign = theirs.folder(Role::Orchestrator);
        for (key, value) in [
            ("transport/link/tls/connect_certificate", text_of(&foreign.join("cert.pem"))),
            ("transport/link/tls/connect_private_key", text_of(&foreign.join("key.pem"))),
            ("transport/link/tls/enable_mtls", "true".to_owned()),
        ] {
            config.insert_json5(key, &value).unwrap();
        }
        assert!(zenoh::open(config).await.is_err(), "a certificate of another authority");

        // Nobody was there; somebody who may is seen.
        let worker = ours.guest(Role::Worker, &endpoint).await;
        let _alive = worker.declare_alive("live/worker/paths/w").await.unwrap();
        assert_eq!(presence.next().await.unwrap().0, "live/worker/paths/w");
        worker.close().await;
        router.close().await;
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_router_that_is_not_what_it_should_be_is_not_trusted() {
    guarded(async {
        let ours = Deployment::new();
        // In clear, where keys were expected.
        let tcp = format!("tcp/127.0.0.1:{}", free_port());
        let router = ZenohBus::open(ZenohConfig::new(Mode::Router, "t", "r").listen(&tcp)).await.unwrap();
        let why = refused(ours.guest_config(Role::Client, &tcp.replace("tcp/", "quic/"))).await;
        assert!(why.contains("does not speak QUIC"), "{why}");
        router.close().await;
        // A worker's certificate names no host: with it nobody can play the router.
        let endpoint = format!("quic/127.0.0.1:{}", free_udp_port());
        let listening = ZenohConfig::new(Mode::Router, "t", "r").listen(&endpoint);
        let why = refused(listening.credentials(Some(ours.keys(Role::Worker)))).await;
        assert!(why.contains("nobody can listen") && why.contains("`worker`"), "{why}");
        let why = refused(ours.guest_config(Role::Router, &endpoint)).await;
        assert!(why.contains("nobody can connect"), "{why}");
        let mut thief = zenoh::Config::default();
        let folder = ours.folder(Role::Worker);
        for (key, value) in [
            ("mode", "\"router\"".to_owned()),
            ("listen/endpoints", format!("[{endpoint:?}]")),
            ("scouting/multicast/enabled", "false".to_owned()),
            ("transport/link/tls/root_ca_certificate", text_of(&folder.join("ca.pem"))),
            ("transport/link/tls/listen_certificate", text_of(&folder.join("cert.pem"))),
            ("transport/link/tls/listen_private_key", text_of(&folder.join("key.pem"))),
            ("transport/link/tls/enable_mtls", "true".to_owned()),
        ] {
            thief.insert_json5(key, &value).unwrap();
        }
        let thief = zenoh::open(thief).await.unwrap();
        let why = refused(ours.guest_config(Role::Client, &endpoint)).await;
        assert!(why.contains(&endpoint) && why.contains("certificate"), "{why}");
        thief.close().await.unwrap();
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn without_keys_a_router_is_as_before() {
    guarded(async {
        let endpoint = format!("tcp/127.0.0.1:{}", free_port());
        let keys_at_hand = Deployment::new().keys(Role::Orchestrator);
        let config = ZenohConfig::new(Mode::Router, "t", "r").listen(&endpoint).credentials(Some(keys_at_hand));
        let router = ZenohBus::open(config).await.unwrap();
        let mut serving = router.serve(keys::STATUS).await.unwrap();
        let guest = ZenohBus::open(plain(&endpoint)).await.unwrap();
        let answers = tokio::spawn(async move { serving.next().await.unwrap().reply(vec![1]).await.unwrap() });
        assert_eq!(crate::promises::ask_until_served(&guest, keys::STATUS, &[]).await, [1]);
        answers.await.unwrap();
        // A router without keys cannot listen with TLS.
        let why = refused(ZenohConfig::new(Mode::Router, "t", "r").listen("quic/127.0.0.1:0")).await;
        assert!(why.contains("needs keys"), "{why}");
        guest.close().await;
        router.close().await;
        assert!(guest.query(keys::STATUS, vec![], SOON).await.is_err());
    })
    .await;
}

#[test]
fn each_thing_that_is_wrong_with_keys_is_told_with_its_file() {
    let (ours, theirs) = (Deployment::new(), Deployment::new());
    let folder = ours.folder(Role::Worker);
    let file = |which: RoleFile| folder.join(which.name());
    let told = || match Credentials::read(&folder, now_s()) {
        Err(LinkError::Keys { what, hint }) => format!("{what} / {hint}"),
        other => panic!("{other:?}"),
    };
    assert_eq!(Credentials::read(&folder, now_s()).unwrap().role(), Role::Worker);
    let keep: Vec<(RoleFile, String)> =
        RoleFile::ALL.map(|which| (which, std::fs::read_to_string(file(which)).unwrap())).into();
    for (which, right) in &keep {
        let name = which.name();
        let foreign = std::fs::read_to_string(theirs.folder(Role::Worker).join(name)).unwrap();
        let other = std::fs::read_to_string(ours.folder(Role::Viewer).join("cert.pem")).unwrap();
        for wrong in [
            "",
            "no keys",
            "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n",
            &foreign,
            &"x".repeat(70_000),
        ] {
            write_private(&file(*which), wrong);
            assert!(told().contains(name), "{name} {wrong:.20}: {}", told());
        }
        if *which == RoleFile::Certificate {
            write_private(&file(*which), &other);
            assert!(told().contains("is not the key of"), "{}", told());
        }
        std::fs::remove_file(file(*which)).unwrap();
        assert!(told().contains("cannot read") && told().contains(name), "{}", told());
        write_private(&file(*which), right);
    }
    let key = file(RoleFile::Key);
    for mode in [0o640, 0o604, 0o620] {
        std::fs::set_permissions(&key, std::fs::Permissions::from_mode(mode)).unwrap();
        assert!(told().contains("by others than its owner") && told().contains("chmod 600"), "{}", told());
    }
    std::fs::set_permissions(&key, std::fs::Permissions::from_mode(0o400)).unwrap();
    assert!(Credentials::read(&folder, now_s()).is_ok());
    let nowhere = Credentials::read(&folder.join("x"), now_s()).unwrap_err().to_string();
    assert!(nowhere.contains("cluster keys"), "{nowhere}");
    let odd = folder.parent().unwrap().join("a;b");
    std::fs::create_dir(&odd).unwrap();
    assert!(Credentials::read(&odd, now_s()).unwrap_err().to_string().contains("odd signs"));
}

#[test]
fn keys_hold_from_the_day_before_they_are_made_until_their_last_day() {
    let made_s = now_s();
    let folder = Deployment::made(&KeysWish { hosts: vec![], days: 3, now_s: made_s });
    let read = |at_s: u64| Credentials::read(&folder.folder(Role::Client), at_s);
    assert!(read(made_s - DAY_S + 60).is_ok() && read(made_s + 3 * DAY_S - 60).is_ok());
    assert_eq!(read(made_s + 60).unwrap().days_left(), 2);
    let early = read(made_s - 2 * DAY_S).unwrap_err().to_string();
    assert!(early.contains("does not hold before") && early.contains("clock"), "{early}");
    let late = read(made_s + 3 * DAY_S + 60).unwrap_err().to_string();
    assert!(late.contains("holds no more since") && late.contains("cluster keys"), "{late}");
}

#[test]
fn what_is_printed_of_a_participant_holds_no_secret() {
    let deployment = Deployment::new();
    let config = deployment.guest_config(Role::Client, "quic/127.0.0.1:1");
    let secret = std::fs::read_to_string(deployment.folder(Role::Client).join("key.pem")).unwrap();
    let line = secret.lines().nth(1).unwrap();
    assert!(line.len() > 40 && !format!("{config:?}").contains(line));
}
