//! Pages, films, figures and what to cite: everything that is made of a finished bundle.

use std::path::Path;
use std::process::Command;

use crate::{PROGRAM, WAREHOUSE, make, socrates};

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// The data that a page's script reads.
fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_bundle_gives_a_page_films_a_figure_and_a_paragraph() {
    let folder = tempfile::tempdir().unwrap();
    let more = ["--require", "any", "--planner", "reference,reactive"];
    let (finished, _) = make(folder.path(), "shown", WAREHOUSE, &more);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let bundle = folder.path().join("bundle-shown");
    let name = bundle.display().to_string();
    let said = |args: &[&str]| {
        let mut all = vec!["--format", "json"];
        all.extend(args);
        let finished = socrates(folder.path(), "say", &all);
        (finished.code, finished.json())
    };

    // The page: every clause of the reports with its times, and the same page again without simulating.
    let page = text(&bundle.join("report.html"));
    let report: serde_json::Value =
        serde_json::from_str(&text(&bundle.join("details/reports/reference-1.json"))).unwrap();
    let shown = data(&page);
    assert_eq!(shown["runs"].as_array().unwrap().len(), 2);
    for (clause, drawn) in
        report["clauses"].as_array().unwrap().iter().zip(shown["runs"][0]["clauses"].as_array().unwrap())
    {
        assert_eq!((&clause["id"], &clause["times_s"]), (&drawn["id"], &drawn["times"]));
    }
    // The plot and the metric say the same of the smallest distance.
    let least = shown["runs"][0]["series"]["distance"].as_array().unwrap().iter().filter_map(serde_json::Value::as_f64);
    let metric =
        report["metrics"].as_array().unwrap().iter().find(|metric| metric["id"] == "human_distance_min").unwrap();
    let (least, metric) = (least.fold(f64::MAX, f64::min), metric["value"].as_f64().unwrap());
    assert!((least - metric).abs() < 0.06, "{least} {metric}");
    assert_eq!(said(&["report", &name]).0, 0);
    assert_eq!(data(&text(&bundle.join("report.html"))), shown);

    // Films of our own are the same bytes again, and at most 20 s long.
    for file in ["film.gif", "film.svg"] {
        let (code, first) = said(&["video", &name, "--out", file, "--size", "320x180"]);
        let (_, again) = said(&["video", &name, "--out", file, "--size", "320x180"]);
        assert_eq!(code, 0, "{first}");
        assert!(first["digest"].is_string() && first["digest"] == again["digest"], "{first} {again}");
        assert!(first["seconds"].as_f64().unwrap() <= 20.0);
        assert!(folder.path().join(file).metadata().unwrap().len() > 2000);
    }
    assert!(std::fs::read(folder.path().join("film.gif")).unwrap().starts_with(b"GIF89a"));
    let (code, both) =
        said(&["video", &name, "--out", "two.svg", "--run", "reference-1,reactive-1", "--labels", "off"]);
    assert_eq!((code, both["runs"].as_array().unwrap().len()), (0, 2));
    assert!(!text(&folder.path().join("two.svg")).contains("reactive"), "a film without labels names the planner");

    // What needs ffmpeg says so where there is none.
    let bare = Command::new(PROGRAM)
        .args(["video", &name, "--out", "film.mp4"])
        .current_dir(folder.path())
        .env("PATH", "")
        .output()
        .unwrap();
    assert_eq!(bare.status.code(), Some(2));
    let words = String::from_utf8_lossy(&bare.stderr);
    assert!(words.contains("ffmpeg") && words.contains("hint:") && words.contains(".gif"), "{words}");
    for wrong in [["--run", "mppi-9"], ["--out", "film.avi"], ["--speed", "fast"], ["--size", "9x9"]] {
        let (code, said) = said(&["video", &name, wrong[0], wrong[1]]);
        assert!(code == 2 && said["hint"].as_str().is_some_and(|hint| !hint.is_empty()), "{wrong:?}: {said}");
    }

    let (code, figure) = said(&["figure", &name, "--out", "figure.svg"]);
    assert_eq!(code, 0, "{figure}");
    assert!(text(&folder.path().join("figure.svg")).contains("width=\"84mm\""));
    assert_eq!(said(&["figure", &name, "--out", "figure.bmp"]).0, 2);
    assert_eq!(said(&["figure", &name, "--width-mm", "3"]).0, 2);

    let (code, cite) = said(&["cite", &name]);
    assert_eq!(code, 0, "{cite}");
    let methods = cite["methods"].as_str().unwrap();
    for word in [env!("CARGO_PKG_VERSION"), "warehouse", "reactive", "seed 1", "0.01 s", "offline"] {
        assert!(methods.contains(word), "`{word}` is not in: {methods}");
    }
    let manifest: serde_json::Value = serde_json::from_str(&text(&bundle.join("details/manifest.json"))).unwrap();
    assert_eq!(cite["hashes"]["recording reference-1"], manifest["runs"][0]["recording_hash"]);
    assert!(cite["bibtex"].as_str().unwrap().contains("2412.19595"));

    // The label page knows runs by the ids that the reports have, and no verdict.
    let (code, labels) = said(&["labels", "page", &name, "--out", "labels.html"]);
    assert_eq!((code, labels["runs"].as_array().unwrap().len()), (0, 2), "{labels}");
    let page = data(&text(&folder.path().join("labels.html")));
    assert_eq!(page["runs"][0]["name"], report["run"]);
    assert!(page["runs"][0]["verdict"].is_null());
    let (code, twice) = said(&["labels", "page", &name, &name, "--out", "labels.html"]);
    assert_eq!(
        (code, twice["runs"].as_array().unwrap().len()),
        (0, 2),
        "a bundle that is named twice is there once: {twice}"
    );
}

#[test]
fn a_folder_of_bundles_has_a_page_even_when_one_is_damaged() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, json) =
        make(folder.path(), "many", WAREHOUSE, &["--require", "any", "--variants", "2", "--repeats"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let root = folder.path().join("bundle-many");
    let rows = |page: &Path| data(&text(page))["rows"].as_array().unwrap().clone();
    let page = root.join("report.html");
    let made = rows(&page);
    assert_eq!(made.len(), 2);
    assert_eq!(made[0]["verdict"], json["scenarios"][0]["verdict"]);
    for row in &made {
        assert!(root.join(row["folder"].as_str().unwrap()).join("report.html").is_file(), "the link leads nowhere");
    }
    let broken = root.join(made[1]["folder"].as_str().unwrap()).join("details/proposal.json");
    std::fs::write(broken, "{").unwrap();
    let again = socrates(folder.path(), "again", &["--format", "json", "report", &root.display().to_string()]);
    assert_eq!(again.code, 0, "{}", again.err);
    assert_eq!(again.json()["left_out"].as_array().unwrap().len(), 1);
    assert_eq!(rows(&page)[1]["verdict"], "failed");
    let nothing = socrates(folder.path(), "nothing", &["report", &folder.path().display().to_string()]);
    assert_eq!(nothing.code, 2);
    assert!(nothing.err.contains("holds none") && nothing.err.contains("hint:"), "{}", nothing.err);
}
