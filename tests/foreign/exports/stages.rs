//! Stages of USD and tables of Parquet in the hands of readers that others wrote.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use socrates_tests::skip;

use super::{export, requests};
use crate::foreign::python::python;
use crate::{make, socrates};

/// The reader of stages, and what it finds.
const STAGE_READERS: [&str; 1] = ["usd-core==26.11"];
const STAGES: &str = include_str!("stages.py");
/// The reader of tables, and what it finds.
const TABLE_READERS: [&str; 1] = ["pyarrow==26.0.1"];
const TABLES: &str = include_str!("tables.py");
/// Formats that are read here.
pub(super) const FORMATS: [&str; 2] = ["usda-1.0", "parquet"];

fn read(python: &Path, at: &Path, program: &str, args: &[&str]) -> (bool, String) {
    let mut reads = Command::new(python);
    reads.args(["-c", program]).args(args).current_dir(at).stdin(Stdio::null());
    let out = reads.output().unwrap();
    let text = if out.status.success() { out.stdout } else { out.stderr };
    (out.status.success(), String::from_utf8_lossy(&text).into_owned())
}

#[test]
fn the_validators_of_usd_find_nothing_and_walls_and_people_are_where_they_were() {
    let Some(python) = skip::installed(python("stage-readers", &STAGE_READERS, "from pxr import UsdValidation")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, request) in requests() {
        let (made, _) = make(at, name, &request, &[]);
        assert!(matches!(made.code, 0 | 3), "{name}: {}", made.err);
        let bundle = format!("bundle-{name}");
        let told = export(at, &bundle, FORMATS[0]);
        let stage = format!("out/{}/{}", FORMATS[0], told["files"][0].as_str().unwrap());
        // The map of another format, whose reader is not ours either.
        export(at, &bundle, "sdf-1.6");
        let args = [stage.as_str(), "out/sdf-1.6/map/map.yaml", &format!("{bundle}/agents.csv")];
        let (is_read, said) = read(&python, at, STAGES, &args);
        assert!(is_read, "{name}: {said}");
        let found: Value = serde_json::from_str(&said).unwrap();
        assert!(
            found["validators"].as_u64().unwrap() >= 20 && found["faults"] == serde_json::json!([]),
            "{name}: {found}"
        );
        assert!(found["walls"].as_u64().unwrap() > 10 && found["wrong"] == 0, "{name}: {found}");
        let (positions, off) = (found["positions"].as_u64().unwrap(), found["off"].as_f64().unwrap());
        // A millimeter, and half a digit of the table.
        assert!(positions > 100 && off <= 0.001_1, "{name}: {found}");
        // The same reader notices what is wrong.
        let good = std::fs::read_to_string(at.join(&stage)).unwrap();
        for (from, to) in [
            ("    metersPerUnit = 1\n", ""),
            ("def PhysicsScene", "def PhysicsScen"),
            ("(-0.5, -0.5, -0.5)", "(-0.5, -0.5"),
        ] {
            std::fs::write(at.join(&stage), good.replacen(from, to, 1)).unwrap();
            let (is_read, said) = read(&python, at, STAGES, &args);
            assert!(!is_read || !said.contains("\"faults\": []"), "`{from}` is not missed: {said}");
        }
    }
}

#[test]
fn a_reader_of_parquet_finds_the_positions_of_the_run() {
    let Some(python) = skip::installed(python("table-readers", &TABLE_READERS, "import pyarrow.parquet")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (name, request) = requests().swap_remove(0);
    let (made, _) = make(at, name, &request, &[]);
    assert!(matches!(made.code, 0 | 3), "{}", made.err);
    let bundle = format!("bundle-{name}");
    let out = socrates(at, "tables", &["export", &bundle, "--to", FORMATS[1], "--out", "tables"]);
    let built =
        if out.err.contains("without the feature") { Err("the program has no `parquet`".to_owned()) } else { Ok(()) };
    if skip::installed(built).is_none() {
        return;
    }
    assert_eq!(out.code, 0, "{}", out.err);
    let (is_read, said) = read(&python, at, TABLES, &["tables", &format!("{bundle}/agents.csv")]);
    assert!(is_read, "{said}");
    let found: Value = serde_json::from_str(&said).unwrap();
    assert!(found["positions"].as_u64().unwrap() > 100 && found["off"].as_f64().unwrap() <= 0.000_1, "{found}");
}
