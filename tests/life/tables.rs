//! Tables of runs, tracks of one's own, the glossary, and a request to start from.

use std::path::Path;

use serde_json::Value;

use crate::{WAREHOUSE, make, socrates};

/// The lines of a table of the program, by column.
fn table(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
    let mut lines = text.lines().map(cells);
    let head = lines.next().unwrap();
    lines.map(|row| head.iter().cloned().zip(row).collect()).collect()
}

/// Cells of a line; a comma in quotes is text.
fn cells(line: &str) -> Vec<String> {
    let parts: Vec<&str> = line.split('"').collect();
    let marked: Vec<String> = parts
        .iter()
        .enumerate()
        .map(|(index, part)| if index % 2 == 0 { part.replace(',', "\u{1}") } else { (*part).to_owned() })
        .collect();
    marked.concat().split('\u{1}').map(str::to_owned).collect()
}

/// A request that leaves little open, and one of another kind.
fn requests(folder: &Path) {
    std::fs::create_dir_all(folder.join("requests")).unwrap();
    std::fs::write(folder.join("requests/dock.toml"), WAREHOUSE).unwrap();
    let other = WAREHOUSE.replace(
        "One person walks towards the robot. One person follows the robot.",
        "A worker stands in the way of the robot.",
    );
    std::fs::write(folder.join("requests/block.toml"), other).unwrap();
}

#[test]
fn a_batch_writes_one_row_per_run_and_counts_distinct_scenarios() {
    let folder = tempfile::tempdir().unwrap();
    requests(folder.path());
    let args = [
        "--format",
        "json",
        "run",
        "requests",
        "--variants",
        "3",
        "--repeats",
        "--seeds",
        "1,2",
        "--out",
        "library",
        "--require",
        "any",
    ];
    let made = socrates(folder.path(), "batch", &args);
    assert_eq!(made.code, 0, "{}", made.err);
    let rows = table(&folder.path().join("library/index.csv"));
    assert_eq!(rows.len(), 12, "two requests, three variants, two seeds: {rows:?}");
    let head = std::fs::read_to_string(folder.path().join("library/index.csv")).unwrap();
    let wanted = "request,location,planner,seed,verdict,reason,kind,path,success,time_to_goal,path_length,path_efficiency,robot_speed_mean,\
                  stalled_time,human_collisions,wall_collisions,human_distance_min,ttc_min,space_compliance,jerk_mean,\
                  scenario,pattern,place,people,encounter,context,density_2_5m_max";
    assert_eq!(head.lines().next(), Some(wanted));
    for row in &rows {
        assert!(["dock", "block"].contains(&row["request"].as_str()), "{row:?}");
        assert_eq!((row["location"].as_str(), row["planner"].as_str()), ("warehouse", "reference"));
        assert!(folder.path().join("library").join(&row["path"]).join("report.html").is_file(), "{row:?}");
        assert!(row["reason"].contains("setup clauses"), "{row:?}");
        assert!(row["human_distance_min"].parse::<f64>().is_ok(), "{row:?}");
    }
    // Variants of a request that leaves little open are one scenario.
    let distinct: std::collections::BTreeSet<&str> =
        rows.iter().filter(|row| row["kind"] == "distinct").map(|row| row["path"].as_str()).collect();
    let paths: std::collections::BTreeSet<&str> = rows.iter().map(|row| row["path"].as_str()).collect();
    assert!(distinct.len() >= 2 && distinct.len() < paths.len(), "{distinct:?} of {paths:?}");
    assert_eq!(made.json()["distinct"], distinct.len());
    assert!(made.err.contains(&format!("distinct   {}", distinct.len())), "{}", made.err);
    // The figures of the planners are those of distinct scenarios.
    let pooled = table(&folder.path().join("library/planners.csv"));
    let overall = pooled.iter().find(|row| row["scenario"].is_empty() && row["metric"] == "success").unwrap();
    assert_eq!(overall["runs"], (2 * distinct.len()).to_string());
    let page = socrates(folder.path(), "page", &["--format", "json", "report", "library"]);
    assert_eq!(page.json()["distinct"], distinct.len(), "{}", page.err);
    assert_eq!(table(&folder.path().join("library/index.csv")), rows, "made anew from what lies there, it is the same");
}

#[test]
fn agents_csv_holds_all_runs_and_each_can_be_scored() {
    let folder = tempfile::tempdir().unwrap();
    let (made, _) =
        make(folder.path(), "all", WAREHOUSE, &["--require", "any", "--planner", "reactive,none", "--seeds", "1,2"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let rows = table(&folder.path().join("bundle-all/agents.csv"));
    let runs: std::collections::BTreeSet<(String, String)> =
        rows.iter().map(|row| (row["planner"].clone(), row["seed"].clone())).collect();
    let named: Vec<String> = runs.iter().map(|(planner, seed)| format!("{planner} {seed}")).collect();
    assert_eq!(named, ["none 1", "none 2", "reactive 1", "reactive 2", "reference 1", "reference 2"]);
    let score = |name: &str, more: &[&str]| {
        let args = [&["--format", "json", "score", "bundle-all/agents.csv"], more].concat();
        socrates(folder.path(), name, &args).json()
    };
    let (first, second) = (score("first", &[]), score("second", &["--planner", "reactive", "--seed", "2"]));
    assert!(first["told"].to_string().contains("6 runs: that of reference seed 1"), "{}", first["told"]);
    assert_ne!(first["recording_hash"], second["recording_hash"]);
    let none = socrates(folder.path(), "none", &["score", "bundle-all/agents.csv", "--seed", "9"]);
    assert_eq!(none.code, 2, "{}", none.err);
    assert!(none.err.contains("no run of seed 9"), "{}", none.err);
}

#[test]
fn anyones_tracks_give_twelve_figures_a_page_and_no_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("t,id,x,y\n");
    for k in 0..=100 {
        let t = f64::from(k) / 10.0;
        text.push_str(&format!("{t:.1},base_link,{:.2},0\n{t:.1},ped7,{:.2},1\n", 0.5 * t, 6.0 - 0.8 * t));
    }
    std::fs::write(folder.path().join("tracks.csv"), text).unwrap();
    let args = ["score", "tracks.csv", "--robot", "base_link", "--goal", "5,0", "--out", "scored"];
    let scored = socrates(folder.path(), "scored", &args);
    assert_eq!(scored.code, 0, "{}", scored.err);
    let lines: Vec<&str> = scored.out.lines().collect();
    assert!(lines[0].starts_with("success") && lines[0].contains("yes"), "{}", scored.out);
    assert!(lines[11].starts_with("jerk_mean"), "{}", scored.out);
    assert!(lines.last().unwrap().starts_with("warning"), "{}", scored.out);
    assert!(scored.out.contains("`ped7` is human_7"), "{}", scored.out);
    assert!(!scored.out.contains("verdict") && lines.len() < 24, "{}", scored.out);
    let page = std::fs::read_to_string(folder.path().join("scored/report.html")).unwrap();
    assert!(page.contains("id=\"play\"") && page.contains("tracks.csv") && !page.contains("src=\"http"));
    let metrics = table(&folder.path().join("scored/metrics.csv"));
    assert!(metrics.len() > 100 && metrics[0]["planner"] == "tracks", "{}", metrics.len());
    let json = [&["--format", "json"], args.as_slice()].concat();
    let json = socrates(folder.path(), "json", &json).json();
    assert!(json["verdict"].is_null() && json["metrics"]["success"] == 1.0, "{json}");
    // Without a robot, and with one that is not there.
    let nobody = socrates(folder.path(), "nobody", &["score", "tracks.csv"]);
    assert!(nobody.out.contains("--robot ID says who it is"), "{}", nobody.out);
    let wrong = socrates(folder.path(), "wrong", &["score", "tracks.csv", "--robot", "base"]);
    assert!(wrong.code == 2 && wrong.err.contains("`base_link`, `ped7`"), "{}", wrong.err);
}

#[test]
fn a_new_request_is_read_without_a_complaint_whatever_its_location() {
    let folder = tempfile::tempdir().unwrap();
    let (made, _) = make(folder.path(), "lab", WAREHOUSE, &["--require", "any"]);
    assert_eq!(made.code, 0, "{}", made.err);
    // A user's folder: that of the bundle, under another name.
    std::fs::rename(folder.path().join("bundle-lab/details/location"), folder.path().join("my lab")).unwrap();
    for (name, location) in [("office", "office"), ("hospital", "hospital"), ("own", "my lab")] {
        let file = format!("{name}.toml");
        let new = socrates(folder.path(), &format!("new-{name}"), &["new", &file, "--location", location]);
        assert_eq!(new.code, 0, "{}", new.err);
        let read = socrates(folder.path(), &format!("read-{name}"), &["read", &file]);
        assert_eq!(read.code, 0, "{}", read.err);
        // The one note is said of every request.
        let of_all = "note       of the social context, only roles and pace are used";
        for word in ["note", "problem", "ignored"] {
            let mut lines = read.out.lines().filter(|line| *line != of_all);
            assert!(!lines.any(|line| line.starts_with(word)), "{location}: {}", read.out);
        }
    }
}

#[test]
fn words_of_output_and_pages_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    for word in
        ["contradicted", "encounter gap", "setup clause", "surface distance", "promised by", "auto-time-human_1"]
    {
        let told = socrates(folder.path(), &word.replace(' ', "-"), &["--format", "json", "explain", word]);
        assert_eq!(told.code, 0, "{word}: {}", told.err);
        assert!(told.json()["about"].as_str().is_some_and(|about| about.len() > 20), "{word}: {}", told.out);
    }
    let unknown = socrates(folder.path(), "unknown", &["--format", "json", "explain", "verdikt"]);
    assert_eq!(unknown.code, 2);
    assert!(unknown.json()["hint"].as_str().is_some_and(|hint| hint.contains("verdict")), "{}", unknown.out);
    let all: Value = socrates(folder.path(), "words", &["--format", "json", "explain", "words"]).json();
    assert!(all["words"].as_array().is_some_and(|words| words.len() > 90));
}
