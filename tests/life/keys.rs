//! A cluster whose machines know each other by keys.

use std::net::UdpSocket;
use std::path::Path;

use socrates_tests::program::{Finished, children, poll, start};

use super::{Ended, STAGES};
use crate::{PROGRAM, WAREHOUSE, socrates};

const ROLES: [&str; 6] = ["orchestrator", "worker", "client", "viewer", "driver", "router"];

/// Every line of the private keys below a folder, without the first and the last.
fn secrets(keys: &Path) -> Vec<String> {
    let lines = |role: &str| {
        let text = std::fs::read_to_string(keys.join(role).join("key.pem")).unwrap();
        text.lines().filter(|line| !line.starts_with('-')).map(str::to_owned).collect::<Vec<_>>()
    };
    ROLES.iter().flat_map(|role| lines(role)).collect()
}

/// A cluster that listens with keys: its endpoint, and its processes with workers of these stages.
fn cluster(at: &Path, stages: &[&str]) -> (String, Ended) {
    let made = socrates(at, "keys", &["cluster", "keys", "keys", "--host", "lab-3.example", "--days", "2"]);
    assert_eq!(made.code, 0, "{}", made.err);
    assert!(made.out.contains("keys/worker") && made.out.contains("2 days"), "{}", made.out);
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let listen = format!("quic/127.0.0.1:{port}");
    std::fs::write(at.join("mine.toml"), WAREHOUSE).unwrap();
    // What libraries log of their settings too, so that a secret in any line would be seen.
    let loud = ["--set", "log.filter=debug,zenoh_link_quic=trace,zenoh_link=trace,zenoh_config=trace"];
    let up = ["cluster", "up", "--dir", "jobs", "--listen", listen.as_str(), "--keys", "keys/orchestrator"];
    let mut all = Ended(vec![start(PROGRAM, &[&up[..], &loud].concat(), at, "up").unwrap()]);
    for stage in stages {
        let args = ["cluster", "worker", stage, "--connect", &listen, "--spool", stage, "--keys", "keys/worker"];
        all.0.push(start(PROGRAM, &[&args[..], &loud].concat(), at, stage).unwrap());
    }
    (listen, all)
}

/// A command with the keys of a role.
fn with(at: &Path, name: &str, role: &str, args: &[&str]) -> Finished {
    let keys = format!("keys/{role}");
    socrates(at, name, &[args, &["--keys", keys.as_str()]].concat())
}

/// A cluster with keys at which a client is refused; no work may be there afterwards.
fn hands_in_nothing(refuse: impl Fn(&Path, &str)) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (listen, _all) = cluster(at, &[]);
    let endpoint = format!("{listen}@main");
    let status = || with(at, "status", "client", &["status", &endpoint]);
    assert!(poll(|| (status().code == 0).then_some(())).is_some(), "the orchestrator never came: {}", status().err);
    refuse(at, &listen);
    assert!(status().out.contains("0 of 0"), "work was handed in: {}", status().out);
}

#[test]
fn keys_of_other_roles_and_none_hand_in_no_work() {
    hands_in_nothing(|at, listen| {
        let submit = ["cluster", "submit", "mine.toml", "--connect", listen];
        for role in ["viewer", "worker", "driver", "router"] {
            let refused = with(at, "refused", role, &submit);
            assert_eq!(refused.code, 2, "{role}: {}", refused.err);
            let says = refused.err.contains(&format!("`{role}`")) && refused.err.contains("hint:");
            assert!(says, "{role}: {}", refused.err);
        }
        let plain = socrates(at, "plain", &submit);
        assert!(plain.code == 2 && plain.err.contains("needs keys"), "{}", plain.err);
    });
}

#[test]
fn keys_of_another_deployment_hand_in_no_work() {
    hands_in_nothing(|at, listen| {
        let other = socrates(at, "other", &["cluster", "keys", "others"]);
        assert_eq!(other.code, 0, "{}", other.err);
        let submit = ["cluster", "submit", "mine.toml", "--connect", listen, "--keys", "others/client"];
        let stranger = socrates(at, "stranger", &submit);
        assert!(stranger.code == 2 && stranger.err.contains("of another deployment"), "{}", stranger.err);
    });
}

#[test]
fn a_client_in_clear_hands_in_no_work() {
    hands_in_nothing(|at, listen| {
        let clear = listen.replace("quic/", "tcp/");
        let clear = socrates(at, "clear", &["cluster", "submit", "mine.toml", "--connect", clear.as_str()]);
        assert!(clear.code == 2 && clear.err.contains("wants keys"), "{}", clear.err);
    });
}

#[test]
fn a_cluster_with_keys_makes_a_scenario_and_shows_no_secret() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (listen, all) = cluster(at, &STAGES);
    let endpoint = format!("{listen}@main");
    let here = |out: &str| {
        let workers = out.lines().find(|line| line.starts_with("workers")).unwrap_or_default();
        STAGES.iter().all(|stage| workers.contains(stage))
    };
    let status = || with(at, "status", "client", &["status", &endpoint]);
    assert!(poll(|| here(&status().out).then_some(())).is_some(), "the workers never came: {}", status().err);
    let submit = ["cluster", "submit", "mine.toml", "--connect", listen.as_str()];

    let submitted = with(at, "submit", "client", &submit);
    assert_eq!(submitted.code, 0, "{}", submitted.err);
    let ended = poll(|| status().out.contains("done       1 of 1").then_some(()));
    assert!(ended.is_some(), "it was not made: {}", status().out);
    assert!(status().out.contains("verdicts   1 "), "{}", status().out);

    // Secrets are in no argument, no log line and no file of the jobs.
    let secrets = secrets(&at.join("keys"));
    assert!(secrets.len() >= 2 * ROLES.len(), "{}", secrets.len());
    let lines: Vec<String> = children(std::process::id()).into_iter().map(|(_, line)| line).collect();
    assert!(lines.iter().filter(|line| line.contains("keys/worker")).count() >= STAGES.len(), "{lines:?}");
    drop(all);
    let mut read = 0;
    let mut look = vec![at.to_path_buf()];
    while let Some(place) = look.pop() {
        if place.ends_with("keys") || place.ends_with("others") {
            continue;
        }
        if place.is_dir() {
            look.extend(std::fs::read_dir(&place).unwrap().map(|entry| entry.unwrap().path()));
        } else if let Ok(bytes) = std::fs::read(&place) {
            let text = String::from_utf8_lossy(&bytes);
            assert!(!secrets.iter().any(|secret| text.contains(secret)), "a secret is in `{}`", place.display());
            read += bytes.len();
        }
    }
    assert!(read > 100_000, "{read} bytes of logs and jobs were read");
    assert!(!lines.iter().any(|line| secrets.iter().any(|secret| line.contains(secret))));
}

#[test]
fn keys_are_made_once_and_what_is_wrong_with_them_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (args, word) in [
        (vec!["--host", "a/b"], "is no host"),
        (vec!["--host", "*.lab"], "is no host"),
        (vec!["--days", "0"], "0 days"),
        (vec!["--days", "4000"], "4000 days"),
    ] {
        let refused = socrates(at, "bad", &[&["cluster", "keys", "keys"][..], &args].concat());
        assert!(refused.code == 2 && refused.err.contains(word), "{args:?}: {}", refused.err);
        assert!(!at.join("keys").exists(), "{args:?}");
    }
    assert_eq!(socrates(at, "keys", &["cluster", "keys", "keys"]).code, 0);
    let again = socrates(at, "again", &["cluster", "keys", "keys"]);
    assert!(again.code == 2 && again.err.contains("--force"), "{}", again.err);
    assert_eq!(socrates(at, "force", &["cluster", "keys", "keys", "--force"]).code, 0);
    let up = |keys: &str, listen: &str| {
        socrates(at, "up", &["cluster", "up", "--dir", "jobs", "--listen", listen, "--keys", keys])
    };
    let worker = up("keys/worker", "quic/127.0.0.1:0");
    assert!(worker.code == 2 && worker.err.contains("`worker`"), "{}", worker.err);
    let nothing = up("nowhere", "quic/127.0.0.1:0");
    assert!(nothing.code == 2 && nothing.err.contains("no keys in `nowhere`"), "{}", nothing.err);
    let over_tcp = up("keys/orchestrator", "tls/127.0.0.1:0");
    assert!(over_tcp.code == 2 && over_tcp.err.contains("write `quic/127.0.0.1:0`"), "{}", over_tcp.err);
    let open = up("keys/orchestrator", "tcp/0.0.0.0:0");
    assert!(open.code == 2 && open.err.contains("--insecure"), "{}", open.err);
    let key = at.join("keys/worker/key.pem");
    std::fs::set_permissions(&key, std::os::unix::fs::PermissionsExt::from_mode(0o644)).unwrap();
    let seen = ["cluster", "worker", "paths", "--connect", "quic/127.0.0.1:1", "--spool", "s", "--keys", "keys/worker"];
    let seen = socrates(at, "seen", &seen);
    assert!(seen.code == 2 && seen.err.contains("chmod 600"), "{}", seen.err);
}
