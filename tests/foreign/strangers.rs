//! Another user of the machine: sees nothing of a run, hands nothing in, and joins nothing.

use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

use socrates_tests::program::{Finished, finish, poll, signal, start};
use socrates_tests::skip;

use crate::{PROGRAM, WAREHOUSE};

/// Runs the program as the user `nobody`.
fn as_nobody(folder: &Path, name: &str, args: &[&str]) -> Finished {
    let output = |ending: &str| std::fs::File::create(folder.join(format!("{name}.{ending}"))).unwrap();
    let stranger = Command::new("setpriv")
        .args(["--reuid=65534", "--regid=65534", "--clear-groups", PROGRAM])
        .args(args)
        .current_dir("/tmp")
        .stdin(Stdio::null())
        .stdout(output("out"))
        .stderr(output("err"))
        .spawn()
        .unwrap();
    finish(stranger, folder, name).unwrap()
}

/// Whether the test can be made here, or why not: a machine's own rules forbid it, which no installation changes.
fn becomes_nobody(folder: &Path) -> Result<(), String> {
    if std::fs::metadata(folder).unwrap().uid() != 0 {
        return Err("only the administrator can become another user".to_owned());
    }
    let version = as_nobody(folder, "version", &["--version"]);
    if version.code == 0 { Ok(()) } else { Err(format!("nobody cannot start the program: {}", version.err)) }
}

fn mode(path: &Path) -> u32 {
    std::fs::metadata(path).unwrap().mode() & 0o777
}

#[test]
fn another_user_neither_sees_nor_submits_nor_joins() {
    use std::os::unix::fs::PermissionsExt as _;
    let setpriv =
        skip::program("setpriv").ok_or_else(|| "there is no program `setpriv` that changes the user".to_owned());
    if skip::installed(setpriv).is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    if skip::elsewhere(becomes_nobody(folder.path())).is_none() {
        return;
    }
    // Everything around the run is open to everybody; the run itself has to be closed.
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o755)).unwrap();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.path().join("mine").display().to_string());
    let args = ["run", file.as_str(), "--out", out.as_str(), "--require", "any", "--pace", "0.1"];
    let run = start(PROGRAM, &args, folder.path(), "run").unwrap();
    let work = folder.path().join("mine/.socrates");
    let endpoint = poll(|| {
        let text = std::fs::read_to_string(work.join("endpoint")).ok()?;
        let mut lines = text.lines();
        let endpoint = format!("{}@{}", lines.next()?, lines.next()?);
        (std::fs::read_dir(work.join("blobs")).ok()?.count() >= 5).then_some(endpoint)
    })
    .unwrap();
    let (bare, namespace) = endpoint.split_once('@').unwrap();
    let socket = Path::new(bare.strip_prefix("unixsock-stream/").unwrap());
    assert_eq!((mode(&work), mode(&work.join("endpoint"))), (0o700, 0o600));
    assert_eq!(mode(socket.parent().unwrap()), 0o700);

    // Their own user gets in by these ways. The first stages may be done before the last worker is there.
    let own = || crate::socrates(folder.path(), "own", &["status", &endpoint]);
    let seen = poll(|| Some(own()).filter(|own| own.code == 0 && own.out.contains("1 simulation")));
    assert!(seen.is_some(), "{}{}", own().out, own().err);
    // A spool in which the stranger may write, so that only the bus can refuse it.
    let spool = tempfile::tempdir().unwrap();
    std::fs::set_permissions(spool.path(), std::fs::Permissions::from_mode(0o777)).unwrap();
    let spool = spool.path().display().to_string();
    for (name, args) in [
        ("watch", vec!["watch", out.as_str()]),
        ("watch-endpoint", vec!["watch", endpoint.as_str()]),
        ("status", vec!["status", endpoint.as_str()]),
        ("submit", vec!["cluster", "submit", file.as_str(), "--connect", bare, "--namespace", namespace]),
        (
            "worker",
            vec![
                "cluster",
                "worker",
                "simulation",
                "--connect",
                bare,
                "--namespace",
                namespace,
                "--spool",
                spool.as_str(),
            ],
        ),
    ] {
        let stranger = as_nobody(folder.path(), name, &args);
        assert_eq!(stranger.code, 2, "{name}: {}\n{}", stranger.out, stranger.err);
        assert!(stranger.out.is_empty(), "{name} says: {}", stranger.out);
    }
    let own = crate::socrates(folder.path(), "own", &["status", &endpoint]);
    assert!(own.out.contains("done       0 of 1") && own.out.contains("1 simulation"), "nobody joined: {}", own.out);
    assert!(signal(run.id(), "INT").unwrap());
    finish(run, folder.path(), "run").unwrap();
    assert!(!socket.parent().unwrap().exists(), "the socket goes with the run");
}

#[test]
fn a_cluster_that_others_can_reach_needs_to_be_meant() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["cluster", "up", "--dir", "jobs", "--listen", "tcp/0.0.0.0:0"];
    let refused = crate::socrates(folder.path(), "up", &args);
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("join as a worker") && refused.err.contains("--insecure"), "{}", refused.err);
    let help = crate::socrates(folder.path(), "help", &["cluster", "up", "--help"]);
    assert!(help.out.contains("no password"), "{}", help.out);
}
