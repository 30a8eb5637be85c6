//! What a bundle holds, and that it says the same again.

use std::path::Path;

use socrates_app::layout::{LAYOUT, When, rows};

use crate::{WAREHOUSE, make, socrates};

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, &target).unwrap();
        }
    }
}

/// Every file below a folder, by its path in it.
fn files(root: &Path) -> Vec<String> {
    let (mut found, mut open) = (Vec::new(), vec![root.to_path_buf()]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.push(path.strip_prefix(root).unwrap().display().to_string());
            }
        }
    }
    found
}

#[test]
fn a_bundle_holds_the_files_of_its_layout_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = make(folder.path(), "listed", WAREHOUSE, &["--require", "any"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let bundle = folder.path().join("bundle-listed");
    let there = files(&bundle);
    for file in &there {
        assert!(LAYOUT.iter().any(|sheet| sheet.is(file)), "`{file}` is not in the layout");
    }
    for sheet in LAYOUT {
        // No driver outside drove here.
        let wanted = sheet.when != When::EachDrivenRun;
        assert_eq!(there.iter().any(|file| sheet.is(file)), wanted, "`{}` in the bundle", sheet.path);
    }
    // What counts stands in the manifest with its digest, and nothing else does.
    let manifest = std::fs::read_to_string(bundle.join("details/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    let mut listed: Vec<&String> = manifest["files"].as_object().unwrap().keys().collect();
    let mut counted: Vec<&String> =
        there.iter().filter(|file| LAYOUT.iter().any(|sheet| sheet.counted && sheet.is(file))).collect();
    listed.sort();
    counted.sort();
    assert_eq!(listed, counted);
}

#[test]
fn architecture_lists_the_layout_of_a_bundle() {
    let text = std::fs::read_to_string(socrates_tests::root().join("ARCHITECTURE.md")).unwrap();
    let table = rows().join("\n");
    assert!(text.contains(&table), "ARCHITECTURE.md, `## The bundle`, has to hold:\n{table}");
}

#[test]
fn a_bundle_holds_everything_and_can_be_moved() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, json) = make(folder.path(), "whole", WAREHOUSE, &["--require", "any"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    for key in ["bundle", "verdict", "stages", "metrics", "reading"] {
        assert!(!json[key].is_null(), "`{key}` is missing in {json}");
    }
    let bundle = folder.path().join("bundle-whole");
    for file in [
        "report.html",
        "run.png",
        "run.svg",
        "story.txt",
        "metrics.csv",
        "agents.csv",
        "request.toml",
        "details/manifest.json",
        "details/provenance.json",
        "details/proposal.json",
        "details/paths.json",
        "details/behaviors.json",
        "details/behaviors/human_1.xml",
        "details/location/map.yaml",
        "details/recordings/reference-1.mcap",
        "details/reports/reference-1.json",
    ] {
        assert!(bundle.join(file).metadata().is_ok_and(|meta| meta.len() > 20), "{file}");
    }
    let agents = std::fs::read_to_string(bundle.join("agents.csv")).unwrap();
    assert!(agents.starts_with("planner,seed,t,id,x,y,yaw,v,gesture,leaf"));
    let page = std::fs::read_to_string(bundle.join("report.html")).unwrap();
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page needs a network");
    assert!(!bundle.join(".socrates").exists(), "the work folder was left");
    let provenance = std::fs::read_to_string(bundle.join("details/provenance.json")).unwrap();
    let provenance: serde_json::Value = serde_json::from_str(&provenance).unwrap();
    let jobs = provenance["jobs"].as_array().unwrap();
    for stage in ["proposal", "paths", "behaviors", "simulation", "scoring"] {
        let job =
            jobs.iter().find(|job| job["job"]["stage"] == stage).unwrap_or_else(|| panic!("no {stage} in {jobs:?}"));
        assert!(job["attempts"].as_array().is_some_and(|attempts| !attempts.is_empty()), "{job}");
        assert!(job["seed"].is_number() && job["inputs"].is_object(), "{job}");
    }
    let proposal = jobs.iter().find(|job| job["job"]["stage"] == "proposal").unwrap();
    assert!(proposal["exchanges"].as_array().is_some_and(|exchanges| !exchanges.is_empty()), "{proposal}");
    let elsewhere = folder.path().join("else/where");
    copy(&bundle, &elsewhere);
    std::fs::remove_dir_all(&bundle).unwrap();
    let moved = elsewhere.display().to_string();
    for verb in ["simulate", "score"] {
        let again = socrates(folder.path(), verb, &["--format", "json", verb, &moved]);
        assert_eq!(again.code, 0, "{verb}: {}", again.err);
        assert_eq!(again.json()["runs"][0]["same"], true, "{verb}: {}", again.out);
    }
}

#[test]
fn the_same_request_and_seed_give_the_same_recording_with_one_and_four_workers() {
    let folder = tempfile::tempdir().unwrap();
    let hashes: Vec<String> = [("one", "1"), ("four", "4")]
        .iter()
        .map(|(name, workers)| {
            let (finished, json) =
                make(folder.path(), name, WAREHOUSE, &["--require", "any", "--seeds", "1..4", "--workers", workers]);
            assert_eq!(finished.code, 0, "{}", finished.err);
            let runs = json["runs"].as_array().unwrap().clone();
            assert_eq!(runs.len(), 4);
            runs.iter().map(|run| run["recording_hash"].as_str().unwrap().to_owned()).collect::<Vec<_>>().join(" ")
        })
        .collect();
    assert_eq!(hashes[0], hashes[1]);
    let seeds: std::collections::BTreeSet<&str> = hashes[0].split(' ').collect();
    assert_eq!(seeds.len(), 4, "other seeds give other recordings");
}

#[test]
fn the_same_folder_again_prints_the_bundle_and_another_wish_gets_a_suffix() {
    let folder = tempfile::tempdir().unwrap();
    let (first, json) = make(folder.path(), "again", WAREHOUSE, &["--require", "any"]);
    assert_eq!(first.code, 0, "{}", first.err);
    let (second, same) = make(folder.path(), "again", WAREHOUSE, &["--require", "any"]);
    assert_eq!(second.code, 0, "{}", second.err);
    assert_eq!(json["bundle"], same["bundle"]);
    assert!(second.err.contains("nothing to do"), "{}", second.err);
    let (third, other) = make(folder.path(), "again", WAREHOUSE, &["--require", "any", "--seed", "2"]);
    assert_eq!(third.code, 0, "{}", third.err);
    assert!(other["bundle"].as_str().unwrap().ends_with("bundle-again-2"), "{other}");
}

#[test]
fn a_run_in_which_robot_and_human_never_meet_is_not_realised() {
    let folder = tempfile::tempdir().unwrap();
    let (finished, _) = make(folder.path(), "meet", WAREHOUSE, &["--require", "any"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let details = folder.path().join("bundle-meet/details");
    let mut paths: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(details.join("paths.json")).unwrap()).unwrap();
    // The human is sent to the node that is farthest from everything the robot visits, and stays there.
    let location: socrates_model::Location =
        serde_json::from_str(&std::fs::read_to_string(details.join("location.json")).unwrap()).unwrap();
    let visited: Vec<String> =
        paths["robot"].as_array().unwrap().iter().map(|node| node.as_str().unwrap().to_owned()).collect();
    let robot: Vec<_> = location.graph.nodes().iter().filter(|node| visited.contains(&node.id.to_string())).collect();
    let reach = |node: &&socrates_model::GraphNode| {
        robot.iter().map(|other| (node.at - other.at).norm()).fold(f64::INFINITY, f64::min)
    };
    let far = location.graph.nodes().iter().max_by(|a, b| reach(a).total_cmp(&reach(b))).unwrap();
    paths["humans"]["human_1"] = serde_json::json!([far.id]);
    std::fs::write(folder.path().join("paths.json"), paths.to_string()).unwrap();
    std::fs::copy(details.join("proposal.json"), folder.path().join("proposal.json")).unwrap();
    let pinned = format!("proposal = \"proposal.json\"\npaths = \"paths.json\"\n{WAREHOUSE}");
    let (finished, json) = make(folder.path(), "apart", &pinned, &[]);
    assert_ne!(json["verdict"], "realised");
    assert_eq!(finished.code, 3, "{}\n{}", finished.err, finished.out);
}

#[test]
fn what_is_pinned_whole_is_played_without_the_author_that_wrote_it() {
    let folder = tempfile::tempdir().unwrap();
    let (first, json) = make(folder.path(), "whole", WAREHOUSE, &[]);
    assert_eq!(json["verdict"], "realised", "{}", first.err);
    let pins =
        ["proposal", "paths", "behaviors"].map(|part| format!("{part} = \"bundle-whole/details/{part}.json\"\n"));
    // Nobody listens there.
    let nobody = ["--author", "console:me", "--set", "author.console.url=http://127.0.0.1:9/v1"];
    let (again, json) = make(folder.path(), "pinned", &format!("{}{WAREHOUSE}", pins.concat()), &nobody);
    assert_eq!((again.code, &json["verdict"]), (0, &serde_json::json!("realised")), "{}\n{}", again.err, again.out);
    let (asked, _) = make(folder.path(), "part", &format!("{}{WAREHOUSE}", pins[0]), &nobody);
    assert_eq!(asked.code, 5, "the paths are still asked for: {}", asked.err);
}
