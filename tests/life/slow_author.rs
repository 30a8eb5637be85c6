//! An author's server that takes questions and never answers.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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
