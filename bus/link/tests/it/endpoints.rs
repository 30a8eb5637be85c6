//! Endpoints, as people and files write them.

use std::path::{Path, PathBuf};

use socrates_link::check_endpoint;

/// Names of transports that an endpoint may begin with in zenoh, whether they are spoken here or not.
const TRANSPORTS: [&str; 9] = ["quic", "serial", "tcp", "tls", "udp", "unixpipe", "unixsock-stream", "vsock", "ws"];

/// The endpoints in a text: words that begin with the name of a transport and go on behind a `/`.
fn endpoints(text: &str) -> Vec<&str> {
    let between = |c: char| c.is_whitespace() || "\"'`,()[]{}<>|;=".contains(c);
    let named = |word: &&str| {
        word.split_once('/').is_some_and(|(transport, rest)| TRANSPORTS.contains(&transport) && !rest.is_empty())
    };
    text.split(between).filter(named).collect()
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

#[test]
fn every_endpoint_of_the_files_for_deployment_and_of_the_documents_is_spoken() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = vec![root.join("README.md")];
    for folder in ["deploy", "docs"] {
        files(&root.join(folder), &mut found);
    }
    let mut seen = 0;
    let mut refused = Vec::new();
    for file in found {
        let Ok(text) = std::fs::read_to_string(&file) else { continue };
        for endpoint in endpoints(&text) {
            seen += 1;
            if let Err(why) = check_endpoint(endpoint) {
                refused.push(format!("{}: {why}", file.display()));
            }
        }
    }
    assert!(seen > 20, "{seen} endpoints were found");
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn an_endpoint_is_found_in_a_script_and_one_that_is_not_spoken_is_refused_with_what_to_write() {
    let script = "endpoint=tls/$host:${PORT:-7447}\nup --listen \"udp/0.0.0.0:1\" # as `quic/a:1`, not `tls/`, a/tcp/b";
    assert_eq!(endpoints(script), ["tls/$host:$", "udp/0.0.0.0:1", "quic/a:1"]);
    let told = |endpoint: &str| check_endpoint(endpoint).unwrap_err().to_string();
    assert!(told("tls/a:1").contains("write `quic/a:1`"), "{}", told("tls/a:1"));
    for endpoint in ["udp/a:1", "tcp/", "lab-3:7447", ""] {
        let told = told(endpoint);
        assert!(told.contains(&format!("`{endpoint}`")) && told.contains("`tcp/HOST:PORT`"), "{told}");
    }
    for endpoint in ["tcp/127.0.0.1:7447", "quic/lab-3:7447", "unixsock-stream//run/x"] {
        assert_eq!(check_endpoint(endpoint), Ok(()));
    }
}
