//! Authors' servers that take their time: one that never answers, and one that writes slowly.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use socrates_tests::program::poll;

use crate::{WAREHOUSE, make};

/// A server on loopback that counts the questions put to it and keeps silent; it lists no models.
fn silent() -> (u16, Arc<AtomicUsize>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (port, asked) = (listener.local_addr().unwrap().port(), Arc::new(AtomicUsize::new(0)));
    let count = Arc::clone(&asked);
    // Both threads end with the test's process; a connection is kept open so that the caller has to give up by itself.
    std::thread::spawn(move || {
        let mut open = Vec::new();
        for mut stream in listener.incoming().filter_map(Result::ok) {
            let (mut head, mut byte) = (Vec::new(), [0]);
            while !head.ends_with(b"\r\n\r\n") && stream.read_exact(&mut byte).is_ok() {
                head.extend(byte);
            }
            if head.starts_with(b"POST") {
                count.fetch_add(1, Ordering::SeqCst);
                open.push(stream);
            } else {
                drop(stream.write_all(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"));
            }
        }
    });
    (port, asked)
}

#[test]
fn the_configured_time_of_an_author_governs_and_every_question_is_counted() {
    let (port, asked) = silent();
    let folder = tempfile::tempdir().unwrap();
    let url = format!("author.vllm.url=http://127.0.0.1:{port}/v1");
    let more =
        ["--author", "vllm:m", "--set", "author.timeout_s=1", "--set", "orchestrator.asks_again=2", "--set", &url];
    let (finished, _) = make(folder.path(), "silent", WAREHOUSE, &more);
    assert_eq!(finished.code, 5, "{}\n{}", finished.out, finished.err);
    assert_eq!(asked.load(Ordering::SeqCst), 3, "once, and twice again: {}", finished.err);
    assert!(
        finished.err.contains("T-TIMEOUT") && finished.err.contains("nothing came from the server within 1000 ms"),
        "{}",
        finished.err
    );
    assert!(finished.err.contains("2 retries: T-TIMEOUT"), "{}", finished.err);
}

/// A server on loopback that begins its answer to every question at once, and then writes a character every tenth of a second
/// until it has written so many.
fn slow(characters: u32) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    std::thread::spawn(move || {
        for mut stream in listener.incoming().filter_map(Result::ok) {
            std::thread::spawn(move || {
                let (mut head, mut byte) = (Vec::new(), [0]);
                while !head.ends_with(b"\r\n\r\n") && stream.read_exact(&mut byte).is_ok() {
                    head.extend(byte);
                }
                // What is not read would reset the connection in the end.
                let head = String::from_utf8_lossy(&head).to_lowercase();
                let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")?.trim().parse().ok());
                drop(stream.read_exact(&mut vec![0; length.unwrap_or(0)]));
                let kind = "HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\nconnection: close\r\n\r\n";
                drop(stream.write_all(kind.as_bytes()));
                let part = |delta: &str, finish: &str| {
                    format!(
                        "data: {{\"choices\": [{{\"index\": 0, \"delta\": {delta}, \"finish_reason\": {finish}}}]}}\n\n"
                    )
                };
                let (_keep, never) = std::sync::mpsc::sync_channel::<()>(1);
                for _ in 0..characters {
                    drop(stream.write_all(part("{\"content\": \"x\"}", "null").as_bytes()));
                    let _nothing = never.recv_timeout(std::time::Duration::from_millis(100));
                }
                drop(stream.write_all(part("{}", "\"stop\"").as_bytes()));
            });
        }
    });
    port
}

#[test]
fn a_server_that_writes_slowly_is_not_a_silent_one_and_a_run_shows_how_much_is_there() {
    // Four seconds in all, of which it is never silent for one.
    let port = slow(40);
    let folder = tempfile::tempdir().unwrap();
    let url = format!("author.vllm.url=http://127.0.0.1:{port}/v1");
    let file = folder.path().join("slow.toml");
    std::fs::write(&file, WAREHOUSE).unwrap();
    let (file, out) = (file.display().to_string(), folder.path().join("slow").display().to_string());
    let set = ["author.timeout_s=1", "orchestrator.asks_again=0", "orchestrator.beat_ms=100", url.as_str()];
    let set: Vec<&str> = set.iter().flat_map(|value| ["--set", value]).collect();
    let args = [&["run", &file, "--out", &out, "--author", "vllm:m"], set.as_slice()].concat();
    let mut child = socrates_tests::program::start(crate::PROGRAM, &args, folder.path(), "slow").unwrap();
    let shown = poll(|| {
        let finished = crate::socrates(folder.path(), "status", &["status", &out]);
        let told = finished.out.contains(" characters");
        (told || child.try_wait().unwrap().is_some()).then_some(finished.out)
    });
    let shown = shown.unwrap();
    assert!(shown.contains("proposal … ") && shown.contains(" characters"), "{shown}");
    let finished = socrates_tests::program::finish(child, folder.path(), "slow").unwrap();
    assert!(finished.err.contains("E-JSON") && !finished.err.contains("T-TIMEOUT"), "{}", finished.err);
}
