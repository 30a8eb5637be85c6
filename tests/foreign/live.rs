//! The live view in the hands of programs that others wrote: Foxglove's client, recorder and reference server, a client of zenoh, a
//! browser, and what strangers try on it. The scripts beside this file say in one line of JSON what they saw.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use serde_json::{Value, json};
use socrates_tests::program::{Finished, children, finish, poll, run, signal, start};
use socrates_tests::{browser, root, skip};

use super::python::python;
use crate::{PROGRAM, socrates};

const PACKAGES: [&str; 6] = [
    "eclipse-zenoh==1.10.2",
    "foxglove-schemas-protobuf==0.4.0",
    "foxglove-sdk==0.30.3",
    "mcap==1.6.0",
    "playwright==1.65.2",
    "websockets==17.4",
];
const IMPORT: &str = "import foxglove, foxglove_schemas_protobuf.FrameTransforms_pb2, mcap.reader, playwright.sync_api, websockets, zenoh";
const NODE_PACKAGES: [&str; 3] = ["@foxglove/ws-protocol@0.8.0", "@foxglove/ws-protocol-examples@0.10.0", "ws@8.23.0"];
/// Windows of a desk and of a phone, px.
const SIZES: [&str; 2] = ["1280x720", "390x844"];
/// A token of viewers.
const TOKEN: &str = "0123456789abcdef0123456789abcdef";

/// A Python with the packages; where there is none, the running test is left out.
#[track_caller]
pub(super) fn snake() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    skip::installed(PLACE.get_or_init(|| python("live", &PACKAGES, IMPORT)).clone())
}

/// The folder of the packages of Node; where there is none, the running test is left out.
#[track_caller]
fn node() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    skip::installed(PLACE.get_or_init(npm).clone())
}

fn npm() -> Result<PathBuf, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("live-npm");
    skip::alone(&folder, || installed(&folder))
}

fn installed(folder: &Path) -> Result<PathBuf, String> {
    let modules = folder.join("node_modules");
    let is_there = || modules.join("@foxglove/ws-protocol-examples/package.json").is_file();
    let asked = Command::new("node").arg("--version").stdin(Stdio::null()).output();
    if !asked.is_ok_and(|out| out.status.success()) {
        return Err("there is no Node here".to_owned());
    }
    if is_there() {
        return Ok(modules);
    }
    if !skip::second_ring() {
        return Err(format!("`{}` is not here; `./gate --foreign` installs it", NODE_PACKAGES.join(", ")));
    }
    std::fs::create_dir_all(folder).map_err(|why| why.to_string())?;
    let out = Command::new("npm")
        .args(["install", "--ignore-scripts", "--no-audit", "--no-fund", "--prefix"])
        .arg(folder)
        .args(NODE_PACKAGES)
        .stdin(Stdio::null())
        .output()
        .map_err(|why| format!("npm cannot be started: {why}"))?;
    if is_there() { Ok(modules) } else { Err(String::from_utf8_lossy(&out.stderr).lines().take(2).collect()) }
}

fn script(name: &str) -> String {
    root().join("tests/foreign/live").join(name).display().to_string()
}

/// What a script saw; it must have ended well.
#[track_caller]
fn saw(program: &Path, args: &[&str], folder: &Path, name: &str) -> Value {
    let finished = run(&program.display().to_string(), args, folder, name).unwrap();
    assert_eq!(finished.code, 0, "{name}: {}\n{}", finished.out, finished.err);
    finished.json()
}

/// A process of ours that is ended with the test.
struct Running {
    child: Option<Child>,
    folder: PathBuf,
    name: &'static str,
}

impl Running {
    fn start(args: &[&str], folder: &Path, name: &'static str) -> Self {
        let child = start(PROGRAM, args, folder, name).unwrap();
        Self { child: Some(child), folder: folder.to_path_buf(), name }
    }

    fn pid(&self) -> u32 {
        self.child.as_ref().unwrap().id()
    }

    /// Something that it says, as soon as it has said it.
    #[track_caller]
    fn says<T>(&self, ending: &str, find: impl Fn(&str) -> Option<T>) -> T {
        let file = self.folder.join(format!("{}.{ending}", self.name));
        let said = || std::fs::read_to_string(&file).unwrap_or_default();
        poll(|| find(&said())).unwrap_or_else(|| panic!("{} does not say it:\n{}", self.name, said()))
    }

    /// Asks it to leave, and waits.
    fn leave(mut self) -> Finished {
        let child = self.child.take().unwrap();
        assert!(signal(child.id(), "INT").unwrap());
        finish(child, &self.folder, self.name).unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            drop(child.kill());
            drop(child.wait());
        }
    }
}

/// The shipped demo made at a pace with viewers, and the address of its gateway such as `127.0.0.1:8780`.
fn live(folder: &Path, pace: &str) -> (Running, String) {
    let running = Running::start(&["demo", "--view", "--pace", pace, "--out", "lively"], folder, "lively");
    let address = running.says("out", |text| {
        let line = text.lines().find_map(|line| line.strip_prefix("view "))?;
        Some(line.trim().strip_prefix("http://")?.trim_end_matches('/').to_owned())
    });
    (running, address)
}

/// A gateway of a folder, and its address.
fn gateway(folder: &Path, what: &str, more: &[&str]) -> (Running, String) {
    let args = [&["--format", "json", "view", what, "--listen", "127.0.0.1:0"], more].concat();
    let running = Running::start(&args, folder, "gateway");
    let address = running.says("out", |text| {
        let told: Value = serde_json::from_str(text.lines().next()?).ok()?;
        Some(told["address"].as_str()?.to_owned())
    });
    (running, address)
}

/// The demo made without anybody looking.
fn plain(folder: &Path) -> PathBuf {
    let made = socrates(folder, "plain", &["demo", "--out", "plain"]);
    assert_eq!(made.code, 0, "{}", made.err);
    folder.join("plain")
}

/// Verdict and recording hash of the only run of a bundle, once it is written.
#[track_caller]
fn result(bundle: &Path) -> (String, String) {
    let manifest = poll(|| {
        let text = std::fs::read_to_string(bundle.join("details/manifest.json")).ok()?;
        serde_json::from_str::<Value>(&text).ok()
    });
    let manifest = manifest.unwrap_or_else(|| panic!("{} is never written", bundle.display()));
    let text = |key: &str| manifest["runs"][0][key].as_str().unwrap().to_owned();
    (text("verdict"), text("recording_hash"))
}

/// A run that was looked at has ended as the same run does that nobody looked at.
#[track_caller]
fn is_the_same_run(folder: &Path, running: Running) {
    let (verdict, hash) = result(&folder.join("lively"));
    let plain = result(&plain(folder));
    assert_eq!((verdict.as_str(), hash.as_str()), ("realised", plain.1.as_str()), "viewers change nothing");
    let left = running.leave();
    assert_eq!(left.code, 0, "{}", left.err);
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Where the robot of a bundle is at a time that its table has, m.
fn robot_at(bundle: &Path, time: &str) -> (f64, f64) {
    let text = std::fs::read_to_string(bundle.join("agents.csv")).unwrap();
    let row: Vec<&str> = text
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>())
        .find(|row| row[..4] == ["reference", "1", time, "robot"])
        .unwrap_or_else(|| panic!("no robot at {time} s"));
    (row[4].parse().unwrap(), row[5].parse().unwrap())
}

/// The topics that a run with a robot offers to Foxglove, and how many fields the schema of each has at least.
#[track_caller]
fn offers_all(found: &Value) {
    let channels = found["channels"].as_array().unwrap();
    let of =
        |topic: &str| channels.iter().find(|channel| channel["topic"] == topic).unwrap_or_else(|| panic!("{topic}"));
    for (topic, schema) in [
        ("/map", "foxglove.Grid"),
        ("/scene", "foxglove.SceneUpdate"),
        ("/tf", "foxglove.FrameTransforms"),
        ("/scan", "foxglove.LaserScan"),
        ("/robot/plan", "foxglove.PosesInFrame"),
        ("/robot/odom", "foxglove.Odometry"),
        ("/events", "foxglove.Log"),
        ("/socrates/labels", "foxglove.SceneUpdate"),
    ] {
        let channel = of(topic);
        assert_eq!((&channel["encoding"], &channel["schema"]), (&json!("protobuf"), &json!(schema)), "{topic}");
        assert!(channel["fields"].as_u64().unwrap() >= 1, "{channel}");
    }
}

/// Nothing that a viewer publishes is taken: it is told so, each time.
#[track_caller]
fn publishes_nothing(found: &Value) {
    let statuses = found["statuses"].as_array().unwrap();
    let refused = |status: &&Value| {
        let told = status["message"].as_str().is_some_and(|text| text.contains("viewers here only read"));
        status["id"] == "advertise" && status["level"] == 1 && told
    };
    assert_eq!(statuses.iter().filter(refused).count(), 1, "{statuses:?}");
    assert!(statuses.iter().filter(|status| status["level"] == 1).count() >= 2, "{statuses:?}");
    assert!(
        statuses.iter().all(|status| status["level"] != 2),
        "nothing of a client of others is unreadable: {statuses:?}"
    );
}

#[test]
fn the_client_of_foxglove_follows_a_live_run_and_cannot_publish() {
    let Some(modules) = node() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (running, address) = live(folder.path(), "2");
    let socket = format!("ws://{address}/run/lively.reference-1");
    is_begun(&address);
    let modules = modules.display().to_string();
    let found = saw(Path::new("node"), &[&script("fox.mjs"), &modules, "live", &socket, "30"], folder.path(), "fox");
    assert_eq!(found["protocol"], "foxglove.websocket.v1", "the name that this client knows");
    assert_eq!(found["info"]["name"], "socrates lively.reference-1");
    assert_eq!(found["info"]["capabilities"], json!(["time"]), "a live run cannot be stopped");
    assert_eq!(found["errors"], json!([]));
    offers_all(&found);
    publishes_nothing(&found);
    assert_eq!(found["closed"], true, "a viewer that leaves is answered, as the protocol wants it");
    let frames: Vec<(f64, f64)> =
        found["tf"].as_array().unwrap().iter().map(|frame| (number(&frame[0]), number(&frame[1]))).collect();
    assert!(frames.len() >= 30 && frames.windows(2).all(|pair| pair[0].0 < pair[1].0), "{frames:?}");
    assert!(number(&found["time_last"]) >= frames.last().unwrap().0 - 1e-9, "{}", found["time_last"]);
    for topic in ["/map", "/scene", "/robot/plan"] {
        assert!(found["counts"][topic].as_u64().unwrap_or(0) >= 1, "{topic}: {}", found["counts"]);
    }
    is_the_same_run(folder.path(), running);
}

/// Waits until the run of [`live`] can be seen.
#[track_caller]
fn is_begun(address: &str) {
    let asked = || {
        let mut line = TcpStream::connect(address).ok()?;
        write!(line, "GET /runs HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").ok()?;
        let mut answer = String::new();
        line.read_to_string(&mut answer).ok()?;
        answer.contains("\"state\":\"live\"").then_some(())
    };
    assert!(poll(asked).is_some(), "no run begins at {address}");
}

#[test]
fn the_client_of_foxglove_plays_stops_and_jumps_in_a_kept_run() {
    let Some(modules) = node() else { return };
    let folder = tempfile::tempdir().unwrap();
    let bundle = plain(folder.path());
    let (running, address) = gateway(folder.path(), "plain", &[]);
    let socket = format!("ws://{address}/run/plain.reference-1");
    let modules = modules.display().to_string();
    let found = saw(Path::new("node"), &[&script("fox.mjs"), &modules, "kept", &socket], folder.path(), "fox");
    assert_eq!(found["info"]["capabilities"], json!(["time", "playbackControl"]));
    assert_eq!(found["info"]["dataStartTime"], json!({"sec": 0, "nsec": 0}));
    let end = &found["info"]["dataEndTime"];
    let end_s = number(&end["sec"]) + number(&end["nsec"]) / 1e9;
    offers_all(&found);
    publishes_nothing(&found);
    assert_eq!(found["closed"], true, "a viewer that leaves is answered, as the protocol wants it");
    assert!(number(&found["stood_at"]) >= 2.0 && number(&found["stood_at"]) < end_s, "{}", found["stood_at"]);
    assert_eq!(found["frames_while_standing"], 0, "it stands");
    let (x, y) = robot_at(&bundle, "1.00");
    let there = &found["after_jump"];
    assert!((number(&there[0]) - 1.0).abs() < 1e-9, "{there}");
    assert!((number(&there[1]) - x).abs() < 1e-3 && (number(&there[2]) - y).abs() < 1e-3, "{there}: {x} {y}");
    assert!(found["last_before"] != found["after_jump"], "it was elsewhere before");
    assert_eq!((&found["jumped"]["status"], &found["jumped"]["jumped"]), (&json!(1), &json!(true)));
    assert!(found["frames_to_the_end"].as_u64().unwrap() >= 10, "{}", found["frames_to_the_end"]);
    assert!((number(&found["end"]["t"]) - end_s).abs() < 0.011, "{}: {end_s}", found["end"]);
    drop(running);
}

#[test]
fn what_the_recorder_of_foxglove_keeps_of_a_live_run_is_where_the_recording_has_everybody() {
    let (Some(modules), Some(python)) = (node(), snake()) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (running, address) = live(folder.path(), "2");
    is_begun(&address);
    let recorder = modules.join(".bin/ws-protocol-examples").display().to_string();
    let socket = format!("ws://{address}/run/lively.reference-1");
    // This recorder listens only some moments after its socket is open, and may miss the first texts: one of several does not.
    let names = ["recorder-0", "recorder-1", "recorder-2", "recorder-3", "recorder-4", "recorder-5"];
    let recorders = names.map(|name| {
        let file = format!("{name}.mcap");
        start("node", &[&recorder, "mcap-record", "-o", &file, &socket], folder.path(), name).unwrap()
    });
    let own = folder.path().join("lively");
    assert_eq!(result(&own).0, "realised");
    let mut said = Vec::new();
    for (name, child) in names.into_iter().zip(recorders) {
        assert!(signal(child.id(), "INT").unwrap());
        let ended = finish(child, folder.path(), name).unwrap();
        assert_eq!(ended.code, 0, "{}", ended.err);
        said.push((name, ended.err));
    }
    let heard = said.iter().find(|(_, err)| err.contains("subscribing to /tf"));
    let recorded = format!("{}.mcap", heard.unwrap_or_else(|| panic!("nobody subscribed: {said:?}")).0);
    let own = own.join("details/recordings/reference-1.mcap").display().to_string();
    let found = saw(&python, &[&script("record.py"), &recorded, &own], folder.path(), "record");
    // 20 frames a second of a run of 20.5 s at twice the pace of the clock, of which the first may be missed.
    assert!(found["frames"].as_u64().unwrap() >= 40, "{found}");
    assert_eq!(
        (&found["unknown"], &found["off_tick"], &found["sorted"]),
        (&json!(0), &json!(0), &json!(true)),
        "{found}"
    );
    assert_eq!(found["agents"], json!(["human_1", "human_2", "human_3", "robot"]), "{found}");
    assert!(found["poses"].as_u64() >= found["frames"].as_u64(), "{found}");
    assert!(number(&found["farthest_m"]) < 1e-3, "{found}");
    let (last, ticks) = (number(&found["last"]), number(&found["ticks_of_the_run"]));
    assert!(last >= 0.9 * ticks && last < ticks, "it was there until the end: {found}");
    for topic in ["/map", "/scene", "/events", "/robot/odom", "/scan", "/robot/plan"] {
        assert!(found["topics"][topic].as_u64().unwrap_or(0) >= 1, "{topic}: {found}");
    }
    is_the_same_run(folder.path(), running);
}

#[test]
fn the_first_texts_are_those_of_the_reference_server_of_foxglove() {
    let Some(python) = snake() else { return };
    let folder = tempfile::tempdir().unwrap();
    plain(folder.path());
    let (running, address) = gateway(folder.path(), "plain", &[]);
    let socket = format!("ws://{address}/run/plain.reference-1");
    let found = saw(&python, &[&script("reference.py"), &socket], folder.path(), "reference");
    assert_eq!(found["different"], json!([]), "{found}");
    assert_eq!(found["same"].as_array().unwrap().len(), 8, "{found}");
    assert_eq!((&found["spoken"], &found["kept"]), (&json!("foxglove.sdk.v1"), &json!(true)));
    assert_eq!((&found["only_ours"], &found["ids"]), (&json!([]), &json!(8)));
    drop(running);
}

#[test]
fn the_example_that_watches_over_zenoh_sees_the_ticks_of_the_recording() {
    let Some(python) = snake() else { return };
    let folder = tempfile::tempdir().unwrap();
    let running = Running::start(&["demo", "--pace", "4", "--out", "lively"], folder.path(), "lively");
    let bundle = folder.path().join("lively");
    poll(|| bundle.join(".socrates/endpoint").is_file().then_some(())).unwrap();
    let recording = bundle.join("details/recordings/reference-1.mcap").display().to_string();
    let watcher = root().join("deploy/python/examples/watcher.py").display().to_string();
    let args = [&script("watch.py"), watcher.as_str(), "lively", "lively.reference-1", &recording];
    let found = saw(&python, &args, folder.path(), "watch");
    assert_eq!(result(&bundle).0, "realised");
    let (ticks, seen) = (found["ticks"].as_u64().unwrap(), found["seen"].as_u64().unwrap());
    assert!(ticks > 1_000 && seen * 2 >= ticks, "{found}");
    assert_eq!(
        (&found["same"], &found["agents"]),
        (&json!(seen), &json!(4)),
        "everybody of every tick, bit by bit: {found}"
    );
    assert_eq!((&found["robot_lines"], &found["robot_lines_true"]), (&json!(seen), &json!(seen)), "{found}");
    assert!(found["told"][0].as_str().unwrap().starts_with("run lively.reference-1 in hospital: 4 agents"), "{found}");
    assert_eq!(found["last_line"], json!(format!("{seen} ticks seen live")));
    drop(running);
}

/// What the page says of itself at one moment.
#[track_caller]
fn is_clean(found: &Value) {
    for key in ["errors", "policy", "console", "strangers", "failed_requests"] {
        assert_eq!(found[key], json!([]), "{key}: {found}");
    }
}

#[track_caller]
fn fits(found: &Value, moments: &[&str]) {
    for moment in moments {
        let seen = &found[*moment];
        assert!(number(&seen["wide"]) <= number(&seen["inner"]), "{moment} is wider than its window: {seen}");
        assert_eq!((&seen["cut"], &seen["odd"]), (&json!([]), &json!([])), "{moment}: {seen}");
        assert!(
            number(&seen["map"][0]) >= 300.0 && number(&seen["map"][1]) >= 200.0,
            "{moment}: the map is tiny: {seen}"
        );
    }
}

/// Looks at a page in one window.
#[track_caller]
fn page(python: &Path, folder: &Path, what: (&str, &str, &str), more: &[&str]) -> Option<Value> {
    let chromium = browser::chromium()?.display().to_string();
    let (kind, size, address) = what;
    let folder_of_pictures = folder.display().to_string();
    let page = script("page.py");
    let args = [&[page.as_str(), &chromium, &folder_of_pictures, size, kind, address], more].concat();
    Some(saw(python, &args, folder, &format!("page-{kind}-{size}")))
}

#[test]
fn the_page_of_a_live_run_draws_goes_back_and_stays_after_the_end() {
    let Some(python) = snake() else { return };
    for size in SIZES {
        let folder = tempfile::tempdir().unwrap();
        let (running, address) = live(folder.path(), "0.5");
        is_begun(&address);
        let what = format!("http://{address}/run/lively.reference-1");
        let Some(found) = page(&python, folder.path(), ("live", size, &what), &[]) else { return };
        is_clean(&found);
        fits(&found, &["live", "past", "again", "over", "ended", "stays"]);
        let (live, past, again, ended) = (&found["live"], &found["past"], &found["again"], &found["ended"]);
        assert_eq!((&live["live"], &live["agents"]), (&json!(true), &json!(4)), "{live}");
        assert!(live["drawn"].as_u64() < again["drawn"].as_u64(), "{live} {again}");
        assert!(live["frames"].as_u64().unwrap() >= 20 && live["acked"].as_u64().unwrap() >= 20, "{live}");
        assert_eq!(past["live"], false);
        assert!((number(&past["time_s"]) - 1.0).abs() < 0.011, "{past}");
        assert!(number(&again["time_s"]) > number(&live["time_s"]), "back at what is newest: {again}");
        assert_eq!(ended["live"], false, "{ended}");
        assert!(ended["verdict"].as_str().unwrap().ends_with("realised"), "{ended}");
        assert!((number(&ended["time_s"]) - number(&ended["slider_max"])).abs() < 0.5, "it shows the end: {ended}");
        assert!(ended["recording"].as_str().unwrap().ends_with("/run/lively.reference-1/recording.mcap"), "{ended}");
        assert!(ended["clauses"].as_u64().unwrap() >= 14 && ended["events"].as_u64().unwrap() >= 10, "{ended}");
        assert_ne!(found["picture_past"], found["picture_end"]);
        assert!(found["drawn_after_the_end"].as_u64().unwrap() >= 2, "{}", found["drawn_after_the_end"]);
        is_the_same_run(folder.path(), running);
    }
}

#[test]
fn the_page_of_a_kept_run_plays_from_its_beginning_and_a_run_that_is_not_there_is_waited_for() {
    let Some(python) = snake() else { return };
    let folder = tempfile::tempdir().unwrap();
    plain(folder.path());
    let (running, address) = gateway(folder.path(), "plain", &[]);
    for size in SIZES {
        let what = format!("http://{address}/run/plain.reference-1");
        let Some(found) = page(&python, folder.path(), ("kept", size, &what), &[]) else { return };
        is_clean(&found);
        fits(&found, &["begin", "playing", "end", "past"]);
        assert!(number(&found["begin"]["time_s"]) < 1.5, "{}", found["begin"]);
        assert!(number(&found["playing"]["time_s"]) > 1.5 && found["playing"]["live"] == false, "{}", found["playing"]);
        assert!(number(&found["end"]["time_s"]) > 15.0, "{}", found["end"]);
        assert_ne!(found["picture_end"], found["picture_past"], "people are elsewhere");
        assert_eq!(found["picture_past"], found["picture_past_again"], "the same moment is the same picture");

        let nobody = format!("http://{address}/run/nobody.reference-1");
        let Some(waits) = page(&python, folder.path(), ("waits", size, &nobody), &[]) else { return };
        assert_eq!((&waits["errors"], &waits["policy"]), (&json!([]), &json!([])), "{waits}");
        // The one answer that there is no such run yet; what asks after it every second fills no console.
        assert!(waits["console"].as_array().unwrap().len() <= 1, "{waits}");
        assert!(waits["asked"].as_array().unwrap().len() >= 3, "{waits}");
        assert!(
            waits["seen"]["notice"].as_str().unwrap().starts_with("Waiting for nobody.reference-1 to begin"),
            "{waits}"
        );
        assert_eq!(waits["seen"]["frames"], 0);
        fits(&waits, &["seen"]);
    }
    drop(running);
}

/// Whether strangers have curl; where they have not, the running test is left out.
#[track_caller]
fn has_curl() -> bool {
    skip::installed(skip::program("curl").ok_or_else(|| "there is no curl in PATH".to_owned())).is_some()
}

/// What was answered to one attempt.
#[track_caller]
fn answered(found: &Value, wanted: &[(&str, Value)]) {
    for (name, answer) in wanted {
        assert_eq!(&found[*name]["found"], answer, "{name}: {found}");
    }
}

#[test]
fn strangers_are_refused_and_neither_the_gateway_nor_the_run_is_hurt() {
    let Some(python) = snake() else { return };
    if !has_curl() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (running, address) = live(folder.path(), "0.5");
    is_begun(&address);
    let pid = viewer(&running).to_string();
    let args = [&script("attacks.py"), address.as_str(), "lively.reference-1", &pid];
    let found = saw(&python, &args, folder.path(), "attacks");
    for name in ["origin_http", "origin_null", "origin_page", "origin_fox", "host", "host_page", "host_like_ours"] {
        answered(&found, &[(name, json!(403))]);
    }
    answered(
        &found,
        &[
            ("protocol_wrong", json!(400)),
            ("protocol_none", json!(400)),
            ("own", json!(101)),
            ("own_fox", json!(101)),
            ("words", json!(1008)),
            ("posts", json!([405, 405, 405, 405])),
            ("head_of_100_kb", json!(431)),
        ],
    );
    assert_ne!(found["protocol_fox_wrong"]["found"], 101, "{found}");
    for name in ["big_page", "big_fox", "flood", "flood_fox"] {
        assert!(found[name]["found"].as_u64().is_some_and(|code| code != 1000), "{name} is hung up on: {found}");
    }
    for (path, status) in found["paths"]["found"].as_object().unwrap() {
        assert!((400..500).contains(&status.as_u64().unwrap()), "{path}: {status}");
    }
    assert_eq!(found["leaks"], json!([]));
    let crowd = &found["crowd"]["found"];
    assert!(crowd["served"].as_u64().unwrap() <= 256 && crowd["served"].as_u64().unwrap() >= 100, "{crowd}");
    assert_eq!(found["slow"]["head"], true, "half a head is hung up on: {found}");
    assert!(found["slow"]["half"] == true && found["slow"]["half_fox"] == true, "half a frame is hung up on: {found}");
    // 100 MB were sent three times, and 2 000 connections made.
    assert!(number(&found["grown_mib"]) < 64.0, "{found}");
    let attempts = found.as_object().unwrap().iter().filter(|(_, attempt)| attempt.get("runs").is_some());
    let states: Vec<&Value> = attempts.map(|(_, attempt)| &attempt["runs"]["state"]).collect();
    assert!(states.len() >= 20, "{found}");
    assert!(states.iter().all(|state| state.is_string()), "the gateway answers after each: {found}");
    assert!(states.iter().filter(|state| **state == "live").count() >= 12, "most came while the run went on: {found}");
    assert_eq!(viewer(&running).to_string(), pid, "it is the same process still");
    is_the_same_run(folder.path(), running);
}

#[test]
fn a_gateway_with_a_token_shows_nothing_without_it() {
    let Some(python) = snake() else { return };
    if !has_curl() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    plain(folder.path());
    std::fs::write(folder.path().join("token"), format!("{TOKEN}\n")).unwrap();
    let (running, address) = gateway(folder.path(), "plain", &["--token-file", "token"]);
    let args = [&script("attacks.py"), address.as_str(), "plain.reference-1", "--token", TOKEN];
    let found = saw(&python, &args, folder.path(), "token");
    let answers = &found["answers"];
    for name in ["none", "wrong", "query", "floor", "scene", "frames", "recording"] {
        assert_eq!(answers[name], 401, "{name}: {answers}");
    }
    for name in ["ws_none", "ws_wrong", "fox_none"] {
        assert_eq!(answers[name][0].as_u64().or_else(|| answers[name].as_u64()), Some(401), "{name}: {answers}");
    }
    assert_eq!((&answers["right"], &answers["page"]), (&json!(200), &json!(200)), "{answers}");
    assert_eq!(answers["ws_right"], json!([101, "socrates.live.v1"]), "the token is not answered with");
    assert_eq!(
        (&answers["fox_right"], &answers["fox_bearer"]),
        (&json!([101, "foxglove.sdk.v1"]), &json!([101, "foxglove.sdk.v1"]))
    );
    assert_eq!(found["runs"]["state"], "kept");
    drop(running);
}

/// The process for viewers of a run.
#[track_caller]
fn viewer(running: &Running) -> u32 {
    let found = poll(|| children(running.pid()).into_iter().find(|(_, line)| line.contains(" view ")));
    found.unwrap_or_else(|| panic!("there is no process for viewers")).0
}

#[test]
fn a_gateway_that_is_killed_comes_back_at_its_address_and_the_run_is_the_same() {
    let Some(python) = snake() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (running, address) = live(folder.path(), "0.5");
    is_begun(&address);
    let pid = viewer(&running);
    let what = format!("http://{address}/run/lively.reference-1");
    let Some(found) = page(&python, folder.path(), ("killed", SIZES[0], &what), &[&pid.to_string()]) else { return };
    assert_ne!(viewer(&running), pid, "it is another process");
    let (live, gone, back) = (&found["live"], &found["gone"], &found["back"]);
    assert_eq!((&live["live"], &gone["live"], &back["live"]), (&json!(true), &json!(false), &json!(true)), "{found}");
    assert!(number(&back["time_s"]) > number(&live["time_s"]), "{found}");
    assert!(back["frames"].as_u64().unwrap() > gone["frames"].as_u64().unwrap() + 20, "{found}");
    assert_eq!((&found["errors"], &found["policy"]), (&json!([]), &json!([])), "{found}");
    is_the_same_run(folder.path(), running);
}
