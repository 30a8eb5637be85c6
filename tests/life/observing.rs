//! What a cluster writes down while it works: logs that share a trace, a timeline out of them, and never a key.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use serde_json::Value;
use socrates_tests::program::{finish, naming, poll, signal, start, start_typed};

use crate::{PROGRAM, WAREHOUSE, socrates};

/// The key of the author's server, of no shape that any vendor has.
const KEY: &str = "of-the-lab-and-nobody-else";

/// A server on loopback that turns everybody away and repeats the key in its answer; gives its port and the keys that it saw.
fn indiscreet() -> (u16, Arc<Mutex<Vec<String>>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (port, seen) = (listener.local_addr().unwrap().port(), Arc::new(Mutex::new(Vec::new())));
    let keys = Arc::clone(&seen);
    // The thread ends with the test's process.
    std::thread::spawn(move || {
        for mut stream in listener.incoming().filter_map(Result::ok) {
            let (mut head, mut byte) = (Vec::new(), [0]);
            while !head.ends_with(b"\r\n\r\n") && stream.read_exact(&mut byte).is_ok() {
                head.extend(byte);
            }
            let head = String::from_utf8_lossy(&head).into_owned();
            let header = |name: &str| {
                let found = head.lines().find(|line| line.to_ascii_lowercase().starts_with(name));
                found.and_then(|line| Some(line.split_once(':')?.1.trim().to_owned())).unwrap_or_default()
            };
            // A client that is not heard out takes the connection for broken.
            let mut body = vec![0; header("content-length").parse().unwrap_or(0)];
            drop(stream.read_exact(&mut body));
            let key = header("authorization");
            let body = format!("{{\"error\":{{\"message\":\"{key} is not known here\"}}}}");
            let answer = format!(
                "HTTP/1.1 401 Unauthorized\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
                body.len()
            );
            keys.lock().unwrap().push(key);
            drop(stream.write_all(answer.as_bytes()));
        }
    });
    (port, seen)
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().filter_map(Result::ok) {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.is_file() {
            found.push(path);
        }
    }
    found
}

/// The lines of a log, each of which is an object with what every line has.
fn lines(file: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(file).unwrap_or_else(|why| panic!("{}: {why}", file.display()));
    let line = |line: &str| {
        let object: Value =
            serde_json::from_str(line).unwrap_or_else(|why| panic!("{}: {why}: {line}", file.display()));
        for name in ["ts", "level", "target", "process", "msg"] {
            assert!(object[name].is_string(), "no `{name}` in {line}");
        }
        object
    };
    text.lines().map(line).collect()
}

#[test]
fn the_logs_of_a_job_share_a_trace_over_all_processes_and_no_key_stands_in_any_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("sing.toml"), WAREHOUSE.replace("follows the robot.\"", "follows the robot. She sings.\""))
        .unwrap();
    let endpoint = format!("unixsock-stream/{}", at.join("bus").display());
    // All that is ever said, also by libraries, in both logs.
    let loud = ["--log", "json", "--set", "log.keep=debug", "--set", "log.filter=debug"];
    let up = [&["cluster", "up", "--dir", "jobs", "--listen", &endpoint][..], &loud].concat();
    let up = start(PROGRAM, &up, at, "up").unwrap();
    assert!(poll(|| at.join("bus").exists().then_some(())).is_some());
    let (port, seen) = indiscreet();
    let url = format!("author.vllm.url=http://127.0.0.1:{port}/v1");
    let author = ["--set", "author.vllm.key_variable=LAB_KEY", "--set", &url];
    let work = ["cluster", "work", "--connect", &endpoint, "--slots", "1", "--dir", "spool"];
    let work = [&work[..], &loud, &author].concat();
    let work = start_typed(PROGRAM, &work, at, "work", "", &[("LAB_KEY", KEY)]).unwrap();

    let submit = ["cluster", "submit", "sing.toml", "--connect", &endpoint, "--batch", "night", "--priority", "bulk"];
    let by_model = ["--author", "vllm:m"];
    let submitted = socrates(at, "submit", &[&submit[..], &by_model, &author].concat());
    assert_eq!(submitted.code, 0, "{}", submitted.err);
    let status = || socrates(at, "status", &["--format", "json", "status", &endpoint, "--all"]).json();
    assert!(poll(|| (status()["done"] == 1).then_some(())).is_some(), "{}", status());
    let told = socrates(at, "told", &["status", &endpoint]).out;
    assert!(told.contains("priority bulk") && told.contains(" · done in "), "{told}");
    let name = status()["scenarios"][0]["scenario"].as_str().unwrap().to_owned();
    // What rules cannot read is said at once, not when the bundle is looked at.
    std::fs::copy(at.join("sing.toml"), at.join("song.toml")).unwrap();
    let again = ["cluster", "submit", "song.toml", "--connect", &endpoint, "--author", "offline"];
    let read = socrates(at, "submit-offline", &again);
    assert!(read.out.contains("problem    song: P-READ") && read.out.contains("`sings`"), "{}{}", read.out, read.err);
    assert!(poll(|| (status()["done"] == 2).then_some(())).is_some(), "{}", status());
    for (child, name) in [(work, "work"), (up, "up")] {
        assert!(signal(child.id(), "TERM").unwrap());
        let ended = finish(child, at, name).unwrap();
        assert_eq!(ended.code, 0, "{name}: {}{}", ended.out, ended.err);
    }

    // The server was really shown the key, and repeated it.
    assert!(seen.lock().unwrap().iter().any(|key| key.contains(KEY)), "{:?}", seen.lock().unwrap());
    for file in files(at) {
        let bytes = std::fs::read(&file).unwrap();
        let shown = bytes.windows(KEY.len()).any(|some| some == KEY.as_bytes());
        assert!(!shown, "the key stands in {}", file.display());
    }
    let (orchestrator, worker) = (at.join("jobs/logs/orchestrator.jsonl"), at.join("spool/logs/proposal.jsonl"));
    let job = format!("{name}/proposal/r0");
    let of_job = |file: &Path, msg: &str| {
        let found = lines(file).into_iter().find(|line| line["msg"] == msg && line["job"] == job.as_str());
        found.unwrap_or_else(|| panic!("no `{msg}` of {job} in {}", file.display()))
    };
    let begun = of_job(&worker, "the attempt begins");
    let trace = begun["trace_id"].as_str().unwrap().to_owned();
    assert_eq!(trace.len(), 32, "{begun}");
    assert_eq!(
        (&begun["stage"], &begun["attempt"], &begun["scenario"]),
        (&"proposal".into(), &1.into(), &name.as_str().into())
    );
    assert_eq!(begun["process"], "proposal", "{begun}");
    for (file, msg) in [
        (&orchestrator, "an attempt is handed out"),
        (&worker, "the attempt ended"),
        (&orchestrator, "a report came"),
        (&worker, "the report is recorded"),
    ] {
        let line = of_job(file, msg);
        assert_eq!(
            (&line["trace_id"], &line["span_id"], &line["worker"]),
            (&begun["trace_id"], &begun["span_id"], &begun["worker"]),
            "{msg}"
        );
    }
    let artifacts = lines(&orchestrator).into_iter().filter(|line| line["msg"] == "an artifact went out");
    assert!(artifacts.clone().any(|line| line["trace_id"] == trace.as_str()), "the inputs went over the bus");
    // The log on standard error is written so, too, by the crew and by its workers.
    let shown = std::fs::read_to_string(at.join("work.err")).unwrap();
    assert!(shown.lines().any(|line| line.starts_with("{\"ts\":") && line.contains(&trace)), "{shown}");

    let explained =
        socrates(at, "explain", &["explain", &format!("{name}/proposal"), "--dir", "jobs", "--logs", "spool/logs"]);
    assert_eq!(explained.code, 0, "{}", explained.err);
    assert!(explained.out.contains(&format!("trace      {trace}")), "{}", explained.out);
    let steps = [
        "an attempt is handed out",
        "the attempt begins",
        "the attempt ended",
        "a report came",
        "the report is recorded",
    ];
    let place = |step: &str| explained.out.lines().position(|line| line.starts_with("log ") && line.contains(step));
    let places: Vec<Option<usize>> = steps.iter().map(|step| place(step)).collect();
    assert!(places.iter().all(Option::is_some), "{places:?} {}", explained.out);
    assert!(poll(|| naming(at).is_empty().then_some(())).is_some(), "left running: {:#?}", naming(at));
}
