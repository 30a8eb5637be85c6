//! From a comparison to the answers of people: films, the kit, the survey page's server.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Child;

use serde_json::{Value, json};
use socrates_tests::console::ask;
use socrates_tests::program::{poll, start};

use super::studies::does;
use crate::{PROGRAM, WAREHOUSE, socrates};

/// Planners that a test has time for.
const PLANNERS: [&str; 3] = ["orca", "straight_line", "social_force"];

/// Runs of the warehouse under three planners, in `runs`.
pub(crate) fn compared(folder: &Path, request: &str) {
    std::fs::write(folder.join("dock.toml"), request).unwrap();
    let args = ["compare", "dock.toml", "--planner", &PLANNERS.join(","), "--out", "runs"];
    let made = socrates(folder, "compare", &args);
    assert_eq!(made.code, 0, "{} {}", made.out, made.err);
}

/// A kit of them, without clips.
pub(crate) fn kit(folder: &Path, more: &[&str]) -> Value {
    does(
        folder,
        "new",
        &[&["new", "runs/scenarios", "--people", "12", "--planner", &PLANNERS.join(",")], more].concat(),
    );
    let study = folder.join("study.toml");
    let text = std::fs::read_to_string(&study).unwrap();
    std::fs::write(&study, text.replace("# completion_code = \"…\"", "completion_code = \"CDONE42\"")).unwrap();
    does(folder, "build", &["build", "--no-clips"])
}

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    found
}

fn refused(folder: &Path, name: &str, args: &[&str]) -> String {
    let done = socrates(folder, name, &[&["study"], args].concat());
    assert_eq!(done.code, 2, "{name}: {} {}", done.out, done.err);
    done.err
}

/// A served survey; it ends with the test.
pub(crate) struct Served {
    child: Child,
    /// Where it listens.
    pub(crate) address: String,
}

impl Served {
    pub(crate) fn start(folder: &Path, name: &str) -> Self {
        let child = start(PROGRAM, &["--format", "json", "study", "serve"], folder, name).unwrap();
        let told = poll(|| {
            let text = std::fs::read_to_string(folder.join(format!("{name}.out"))).ok()?;
            serde_json::from_str::<Value>(text.lines().next()?).ok()
        });
        let page = told.unwrap()["page"].as_str().unwrap().to_owned();
        Self { child, address: page.trim_start_matches("http://").trim_end_matches('/').to_owned() }
    }

    pub(crate) fn post(&self, what: &str, body: &Value) -> (u16, Value) {
        ask(&self.address, &format!("POST /api/{what}"), "content-type: application/json\r\n", &body.to_string())
            .unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // As hard as can be: the answers must survive it.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

#[test]
fn nothing_in_a_kit_names_a_planner_and_the_same_study_gives_the_same_kit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    compared(at, WAREHOUSE);
    let built = kit(at, &["--instruments", "psi,principles,slider"]);
    assert_eq!((built["films"].as_u64(), built["orders"].as_u64()), (Some(3), Some(6)), "{built}");
    let first = files(&at.join("kit"));
    let text = std::fs::read_to_string(at.join("study.toml")).unwrap();
    for (path, bytes) in &first {
        let told = String::from_utf8_lossy(bytes);
        for planner in PLANNERS.iter().chain(&["reference", "WAREHOUSE", "CDONE42"]) {
            assert!(!told.contains(planner), "{} names {planner}", path.display());
        }
        assert!(!path.display().to_string().contains("orca"));
    }
    // One length, which the study states.
    let secret = std::fs::read_to_string(at.join("study.films.csv")).unwrap();
    let lengths: Vec<&str> = secret.lines().skip(1).map(|line| line.split(',').nth(5).unwrap()).collect();
    assert!(lengths.len() == 3 && lengths.iter().all(|length| *length == lengths[0]), "{secret}");
    assert_eq!(text.matches(&format!("length_s = {}", lengths[0].trim_end_matches(".0"))).count(), 3, "{text}");
    for planner in PLANNERS {
        assert!(secret.contains(&format!(",{planner},1,above,")), "{secret}");
    }
    does(at, "again", &["build", "--no-clips", "--out", "again"]);
    let again = files(&at.join("again"));
    assert!(first.values().eq(again.values()), "same study, same bytes");
    let warned = std::fs::read_to_string(at.join("again.err")).unwrap();
    let consent = std::fs::read_to_string(at.join("kit/consent.md")).unwrap();
    assert!(!consent.contains("[minutes]") && !warned.contains("[minutes]"), "{warned}");
    assert!(
        warned.contains("open slot, which people would read: [mail]")
            && warned.contains("`slider.overall` is a single item"),
        "{warned}"
    );
    let plain =
        refused(at, "plain", &["build", "--no-clips", "--media-url", "http://films.example.org", "--out", "plain"]);
    assert!(
        plain.contains("`--media-url` is `http://films.example.org`: survey pages show films from https only"),
        "{plain}"
    );
    // A changed study is another kit.
    std::fs::write(at.join("study.toml"), text.replace("alpha = 0.05", "alpha = 0.01")).unwrap();
    let other = refused(at, "other", &["build", "--no-clips"]);
    assert!(other.contains("`kit` is the kit of another study file") && other.contains("hint:"), "{other}");
    let told = text.replace("context = \"", "context = \"The orca robot. ");
    std::fs::write(at.join("study.toml"), told).unwrap();
    let named = refused(at, "named", &["build", "--no-clips", "--out", "third"]);
    assert!(named.contains("would tell participants of the planner `orca`"), "{named}");
    let longer = text.replacen(&format!("length_s = {}", lengths[0].trim_end_matches(".0")), "length_s = 9", 3);
    std::fs::write(at.join("study.toml"), longer).unwrap();
    let length = refused(at, "length", &["build", "--no-clips", "--out", "fourth"]);
    assert!(length.contains("the study says `length_s = 9`") && length.contains("write `length_s ="), "{length}");
}

#[test]
fn runs_that_cannot_be_compared_make_no_films() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    compared(at, WAREHOUSE);
    let one = refused(at, "one", &["new", "runs/scenarios", "--planner", "orca"]);
    assert!(one.contains("at least two planners") && one.contains("orca"), "{one}");
    let missing = refused(at, "missing", &["new", "runs/scenarios", "--planner", "orca,nav2can"]);
    assert!(missing.contains("has no run of `nav2can` with seed 1") && missing.contains("orca-1"), "{missing}");
    let seed = refused(at, "seed", &["new", "runs/scenarios", "--seeds", "7"]);
    assert!(seed.contains("with seed 7"), "{seed}");
    let people = refused(at, "people", &["new", "runs/scenarios", "--people", "40"]);
    assert!(people.contains("`participants` is `40`") && people.contains("take 36 or 42"), "{people}");
    does(at, "new", &["new", "runs/scenarios", "--from", "human_9"]);
    let nobody = refused(at, "nobody", &["build", "--no-clips"]);
    assert!(nobody.contains("`human_9` is not in the run") && nobody.contains("human_1"), "{nobody}");
    let there = refused(at, "there", &["new", "runs/scenarios"]);
    assert!(there.contains("is there already") && there.contains("--force"), "{there}");
    // Other thresholds, another map, and a scenario that did not come about.
    let bundle = std::fs::read_dir(at.join("runs/scenarios")).unwrap().map(|entry| entry.unwrap().path());
    let bundle = bundle.into_iter().find(|path| path.join("details/manifest.json").exists()).unwrap();
    let changed = |name: &str, file: &str, from: &str, to: &str| {
        let path = bundle.join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{file}: {text:.300}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let told = refused(at, name, &["new", "runs/scenarios", "--force"]);
        std::fs::write(&path, text).unwrap();
        told
    };
    let thresholds = changed("thresholds", "details/reports/orca-1.json", "\"standard-", "\"strange-");
    assert!(thresholds.contains("was scored with the thresholds `strange-"), "{thresholds}");
    let unreal = changed("unreal", "details/reports/reference-1.json", "\"realised\"", "\"not_triggered\"");
    assert!(unreal.contains("was not realised with seed 1") && unreal.contains("--seeds"), "{unreal}");
    let invalid =
        changed("invalid", "details/reports/orca-1.json", "\"verdict\": \"", "\"verdict\": \"invalid\", \"x\": \"");
    assert!(invalid.contains("orca-1"), "{invalid}");
}

#[test]
fn fifty_people_answer_and_no_kill_loses_an_answer() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    compared(at, WAREHOUSE);
    kit(at, &["--from", "human_1"]);
    let mut served = Served::start(at, "serve-0");
    let page = ask(&served.address, "GET /", "", "").unwrap();
    assert!(page.0 == 200 && page.1.as_str().unwrap().contains("Robots among people"));
    let items: Vec<String> = std::fs::read_to_string(at.join("kit/codebook.csv"))
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().to_owned())
        .collect();
    let answers: BTreeMap<&str, u32> = items.iter().zip((2..5).cycle()).map(|(code, at)| (code.as_str(), at)).collect();
    let mut orders: BTreeMap<String, u32> = BTreeMap::new();
    for number in 0..50 {
        let begin = json!({ "participant": format!("PID{number}"), "token": null });
        let (status, mut told) = served.post("begin", &begin);
        assert_eq!(status, 200, "{told}");
        *orders.entry(told["order"].as_str().unwrap().to_owned()).or_default() += 1;
        let films: Vec<String> = serde_json::from_value(told["films"].clone()).unwrap();
        for (index, film) in films.iter().enumerate() {
            let said = json!({ "film": film, "watched_s": 20.0, "rt_s": 9.5, "answers": answers, "checks": {} });
            let body = json!({ "token": told["token"], "said": said });
            let (status, done) = served.post("film", &body);
            assert_eq!((status, done["done"].as_u64()), (200, Some(index as u64 + 1)), "{done}");
            if (number + index) % 10 == 3 {
                drop(served);
                served = Served::start(at, &format!("serve-{number}-{index}"));
                // The reply may have been lost: the same once more, after coming back by id.
                let (_, back) = served.post("begin", &begin);
                assert_eq!((&back["token"], &back["done"]), (&told["token"], &done["done"]), "{back}");
                assert_eq!(served.post("film", &body).0, 200);
                told = back;
            }
        }
        let early = json!({ "token": "nobody", "duration_s": 1.0 });
        assert_eq!(served.post("end", &early).0, 401);
        let (status, end) = served.post("end", &json!({ "token": told["token"], "duration_s": 240.0 }));
        assert_eq!((status, end["code"].as_str()), (200, Some("CDONE42")), "{end}");
    }
    let counts: Vec<u32> = orders.values().copied().collect();
    assert_eq!(orders.len(), 6);
    assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{counts:?}");
    the_door_is_narrow(&served);
    drop(served);
    // A line that was cut off by the power is put aside.
    let book = at.join("answers/answers.jsonl");
    let whole = std::fs::read(&book).unwrap();
    assert!(!String::from_utf8_lossy(&whole).contains("PID1"), "no id is kept");
    std::fs::write(&book, [&whole[..], b"{\"kind\":\"film\",\"part"].concat()).unwrap();
    drop(Served::start(at, "torn"));
    assert_eq!(std::fs::read(&book).unwrap(), whole);
    let read = does(at, "read", &["read", "answers/answers.jsonl"]);
    let ratings = 50 * 3 * items.len() as u64;
    assert_eq!(
        (read["people"].as_u64(), read["ratings"].as_u64(), read["missing"].as_u64()),
        (Some(50), Some(ratings), Some(0))
    );
    let found = does(at, "analyze", &["analyze", "tables"]);
    assert_eq!(found["people"].as_u64(), Some(50), "{found}");
    let methods = std::fs::read_to_string(at.join("results/methods.txt")).unwrap();
    assert!(methods.contains("show what human_1 sees: 100 degrees wide, from a height of 1.6 m"), "{methods}");
}

/// What is asked of a survey that it must not do.
fn the_door_is_narrow(served: &Served) {
    let get = |line: &str, head: &str| ask(&served.address, line, head, "").unwrap();
    assert_eq!(get("GET /films/../../study.toml", "").0, 404);
    assert_eq!(get("GET /films/nothing.js", "").0, 404);
    assert_eq!(get("GET /answers.jsonl", "").0, 404);
    let stranger = get("POST /api/begin", "origin: https://evil.example\r\n");
    assert_eq!(stranger.0, 403, "{stranger:?}");
    let long = json!({ "participant": "x".repeat(2 << 20), "token": null });
    assert_eq!(served.post("begin", &long).0, 413);
    assert_eq!(served.post("begin", &json!({ "participant": "  ", "token": null })).0, 422);
    assert_eq!(served.post("begin", &json!({ "participant": "~000000000001", "token": null })).0, 422);
    assert_eq!(served.post("begin", &json!({ "who": "me" })).0, 400);
    let (_, told) = served.post("begin", &json!({ "participant": "PID0", "token": null }));
    let said = json!({ "film": told["films"][0], "watched_s": 1.0, "rt_s": 1.0, "answers": {}, "checks": {} });
    let (status, twice) = served.post("film", &json!({ "token": told["token"], "said": said }));
    assert!(status == 409 && twice["error"]["message"].as_str().unwrap().contains("answered already"), "{twice}");
}

#[test]
fn metrics_are_laid_beside_ratings_and_a_blind_search_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir_all(at.join("requests")).unwrap();
    std::fs::write(at.join("requests/dock.toml"), WAREHOUSE).unwrap();
    let other = "A worker stands in the way of the robot.";
    let asked = "One person walks towards the robot. One person follows the robot.";
    std::fs::write(at.join("requests/block.toml"), WAREHOUSE.replace(asked, other)).unwrap();
    let planners = PLANNERS.join(",");
    let args = ["compare", "requests", "--planner", &planners, "--seeds", "1..2", "--out", "runs"];
    assert_eq!(socrates(at, "compare", &args).code, 0);
    let args =
        ["new", "runs/scenarios", "--people", "12", "--planner", &planners, "--seeds", "1,2", "--instruments", "psi"];
    assert_eq!(does(at, "new", &args)["films"], 12);
    does(at, "simulate", &["simulate", "--effects", "0,1,2"]);
    does(at, "read", &["read", "simulated/limesurvey.csv"]);
    let none = refused(at, "none", &["correlate"]);
    assert!(none.contains("no metric is named") && none.contains("--hold-out"), "{none}");
    let blind = refused(at, "blind", &["correlate", "--search"]);
    assert!(blind.contains("0 films are held out") && blind.contains("by chance alone"), "{blind}");
    let typo = refused(at, "typo", &["correlate", "--metrics", "human_distance_mim"]);
    assert!(typo.contains("did you mean `human_distance_min`"), "{typo}");
    let half = refused(at, "half", &["correlate", "--search", "--hold-out", "dock-1"]);
    assert!(half.contains("6 films that are not held out were rated"), "{half}");
    let found = does(at, "correlate", &["correlate", "--metrics", "human_distance_min,time_to_goal"]);
    let rows = found["correlations"].as_array().unwrap();
    assert_eq!(rows.len(), 4, "two scales, two metrics: {found}");
    assert!(rows.iter().all(|row| row["films"] == 12 || !row["note"].as_str().unwrap().is_empty()), "{found}");
    assert!(found["ceilings"][0]["one_against_others"].as_f64().is_some(), "{found}");
    let text = std::fs::read_to_string(at.join("correlations/correlations.txt")).unwrap();
    assert!(text.starts_with("SIMULATED ANSWERS") && text.contains("psi.AB: 12 films, 24 simulated people"), "{text}");
}
