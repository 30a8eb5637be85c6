//! The tests of the whole product, in one program: they need the command line's binary.
#![cfg(test)]

mod chaos;
mod foreign;
mod golden;
mod life;

use std::io::{Read as _, Write as _};
use std::path::Path;

use socrates_tests::program::{Finished, run};

/// The program under test.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_socrates");

/// Runs the program in a folder.
pub(crate) fn socrates(folder: &Path, name: &str, args: &[&str]) -> Finished {
    run(PROGRAM, args, folder, name).unwrap()
}

/// Makes scenarios from a request text and gives the process and its result object.
pub(crate) fn make(folder: &Path, name: &str, request: &str, more: &[&str]) -> (Finished, serde_json::Value) {
    let file = folder.join(format!("{name}.toml"));
    std::fs::write(&file, request).unwrap();
    let (file, out) = (file.display().to_string(), folder.join(format!("bundle-{name}")).display().to_string());
    let mut args = vec!["--format", "json", "run", file.as_str(), "--out", out.as_str()];
    args.extend(more);
    let finished = socrates(folder, name, &args);
    let json = finished.json();
    (finished, json)
}

/// The figures at the address that `cluster up` printed.
pub(crate) fn figures(up: &str) -> Option<String> {
    let (_, rest) = up.split_once("metrics    http://")?;
    let mut stream = std::net::TcpStream::connect(rest.split_once("/metrics")?.0).ok()?;
    stream.write_all(b"GET /metrics HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").ok()?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).ok()?;
    Some(answer)
}

/// A request for three people in the warehouse.
pub(crate) const WAREHOUSE: &str = r#"
location = "warehouse"
social_context = "A busy warehouse"
task = "Carry a box from the loading dock to the packing area"
rough_scenario = "One person walks towards the robot. One person follows the robot."
"#;
