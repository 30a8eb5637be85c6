//! Recordings and films in the hands of programs that others wrote: the MCAP project's own reader, and ffmpeg.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use serde_json::Value;
use socrates_tests::skip;

use super::python::python;
use crate::{WAREHOUSE, make, socrates};

/// The reader of the MCAP project, from the package index of Python.
const READER: &str = "mcap==1.6.0";
/// What that reader finds in a file: the counts of its summary, and those of going through all of it.
const SCRIPT: &str = r#"
import json, sys
from mcap.reader import make_reader
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    read = {}
    for schema, channel, message in reader.iter_messages():
        read[channel.topic] = read.get(channel.topic, 0) + 1
    print(json.dumps({
        "counted": {summary.channels[number].topic: count for number, count in summary.statistics.channel_message_counts.items()},
        "read": read,
    }))
"#;

/// A Python that has the reader; where there is none, the running test is left out.
#[track_caller]
fn reader() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    skip::installed(PLACE.get_or_init(|| python("mcap-reader", &[READER], "import mcap.reader")).clone())
}

/// A finished bundle.
fn bundle(folder: &Path) -> PathBuf {
    let (finished, _) = make(folder, "shown", WAREHOUSE, &["--require", "any"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    folder.join("bundle-shown")
}

#[test]
fn the_reader_of_the_mcap_project_reads_every_message_of_a_recording() {
    let Some(python) = reader() else { return };
    let folder = tempfile::tempdir().unwrap();
    let recording = bundle(folder.path()).join("details/recordings/reference-1.mcap");
    let out = Command::new(python).arg("-c").arg(SCRIPT).arg(&recording).stdin(Stdio::null()).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(found["counted"], found["read"], "what the summary counts is there");
    assert_eq!(found["read"]["/socrates/header"], 1, "{found}");
    let states = found["read"]["/socrates/agents"].as_u64().unwrap_or_default();
    assert!(states > 100, "{found}");
}

/// A reader of Parquet files, from the package index of Python.
const ARROW: &str = "pyarrow==26.0.1";
/// Columns of a file with their types, the number of rows, and the sum of a figure without what it lacks.
const TABLE: &str = r#"
import json, sys
import pyarrow.compute, pyarrow.parquet
table = pyarrow.parquet.read_table(sys.argv[1])
print(json.dumps({
    "types": {field.name: str(field.type) for field in table.schema},
    "rows": table.num_rows,
    "requests": table.column("request").to_pylist(),
    "sum": pyarrow.compute.sum(table.column("path_length")).as_py(),
}))
"#;

#[test]
fn arrow_reads_the_table_of_a_library_as_parquet() {
    let python = skip::installed(python("pyarrow", &[ARROW], "import pyarrow.parquet"));
    let Some(python) = python else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("hall.toml"), WAREHOUSE).unwrap();
    let args =
        ["run", "hall.toml", "--variants", "4", "--repeats", "--require", "any", "--keep", "index", "--out", "library"];
    assert_eq!(socrates(at, "made", &args).code, 0);
    let made = socrates(at, "query", &["library", "query", "library", "--out", "runs.parquet"]);
    let built =
        if made.err.contains("without the feature") { Err("the program has no `parquet`".to_owned()) } else { Ok(()) };
    if skip::installed(built).is_none() {
        return;
    }
    assert_eq!(made.code, 0, "{}", made.err);
    let out =
        Command::new(python).arg("-c").arg(TABLE).arg("runs.parquet").current_dir(at).stdin(Stdio::null()).output();
    let out = out.unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((&found["rows"], &found["requests"][3]), (&4.into(), &"hall".into()), "{found}");
    let types = &found["types"];
    assert_eq!(
        (&types["verdict"], &types["seed"], &types["path_length"]),
        (&"string".into(), &"uint64".into(), &"double".into())
    );
    let table = std::fs::read_to_string(at.join("library/index.csv")).unwrap();
    let column = table.lines().next().unwrap().split(',').position(|name| name == "path_length").unwrap();
    // Nothing before it has a comma but the reason, which stands in quotes then: count from the end.
    let behind = table.lines().next().unwrap().split(',').count() - column;
    let cells = table.lines().skip(1).filter_map(|line| line.rsplit(',').nth(behind - 1)?.parse::<f64>().ok());
    let sum: f64 = cells.sum();
    assert!((found["sum"].as_f64().unwrap() - sum).abs() < 1e-6 && sum > 1.0, "{sum}: {found}");
}

#[test]
fn films_by_ffmpeg_play_in_a_player() {
    let missing = ["ffmpeg", "ffprobe"].into_iter().find(|name| skip::program(name).is_none());
    if skip::installed(missing.map_or(Ok(()), |name| Err(format!("there is no `{name}` in PATH")))).is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let name = bundle(folder.path()).display().to_string();
    for (file, codec) in [("film.mp4", "h264"), ("film.webm", "vp9")] {
        let made = socrates(folder.path(), "film", &["video", &name, "--out", file, "--size", "320x180"]);
        assert_eq!(made.code, 0, "{file}: {}", made.err);
        let asked = ["-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "json", file];
        let out = Command::new("ffprobe").args(asked).current_dir(folder.path()).output().unwrap();
        assert!(out.status.success() && out.stderr.is_empty(), "{file}: {}", String::from_utf8_lossy(&out.stderr));
        let told: Value = serde_json::from_slice(&out.stdout).unwrap();
        let stream = &told["streams"][0];
        assert_eq!((&stream["width"], &stream["height"]), (&Value::from(320), &Value::from(180)), "{told}");
        assert_eq!(stream["codec_name"], codec, "{told}");
        let seconds: f64 = told["format"]["duration"].as_str().unwrap().parse().unwrap();
        let frames: f64 = stream["nb_read_frames"].as_str().unwrap().parse().unwrap();
        assert!(seconds > 1.0 && seconds <= 20.5 && frames / seconds > 9.0, "{file}: {seconds} s, {frames} frames");
    }
}
