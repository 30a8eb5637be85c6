//! A cluster whose orchestrator is killed and started again.

use std::net::TcpListener;

use socrates_tests::program::{poll, start};

use super::{Ended, STAGES};
use crate::{PROGRAM, socrates};

#[test]
fn a_cluster_that_is_started_again_knows_the_workers_that_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let (listen, endpoint) = (format!("tcp/127.0.0.1:{port}"), format!("tcp/127.0.0.1:{port}@main"));
    let up = |name: &str| {
        let args = ["cluster", "up", "--dir", "jobs", "--listen", listen.as_str()];
        start(PROGRAM, &args, folder.path(), name).unwrap()
    };
    let known = |name: &str| {
        let all = |out: &str| {
            let workers = out.lines().find(|line| line.starts_with("workers")).unwrap_or_default();
            STAGES.iter().all(|stage| workers.contains(stage))
        };
        poll(|| all(&socrates(folder.path(), name, &["status", endpoint.as_str()]).out).then_some(()))
    };
    let mut first = Ended(vec![up("first")]);
    let mut workers = Ended(Vec::new());
    for stage in STAGES {
        let spool = format!("spool-{stage}");
        let args = ["cluster", "worker", stage, "--connect", listen.as_str(), "--spool", spool.as_str()];
        workers.0.push(start(PROGRAM, &args, folder.path(), stage).unwrap());
    }
    assert!(known("before").is_some(), "the workers never came");
    // SIGKILL: nothing is handed over.
    first.0.iter_mut().for_each(|child| child.kill().unwrap());
    drop(first);
    let _second = Ended(vec![up("second")]);
    assert!(known("after").is_some(), "the workers that go on were lost");
    assert!(workers.0.iter_mut().all(|child| child.try_wait().unwrap().is_none()), "a worker did not go on");
}
