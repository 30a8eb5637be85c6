//! Language models as authors: each wire format against `aimock`, a server that somebody else wrote, as a process of its own.
//!
//! The second ring of the gate fetches it from the package registry into the target folder; elsewhere it is used where it is there.

use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use serde_json::{Value, json};
use socrates_tests::program::{Finished, poll};
use socrates_tests::skip;

use crate::{WAREHOUSE, make, socrates};

/// Version of the server that the tests were written against.
const AIMOCK: &str = "@copilotkit/aimock@1.43.0";
/// A key that must be found nowhere.
const KEY: &str = "sk-test-4f7a1c9e2b8d6035a1c2e3f4";

/// The server's program; where there is none, the running test is left out.
#[track_caller]
fn aimock() -> Option<PathBuf> {
    static PLACE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    skip::installed(PLACE.get_or_init(install).clone())
}

fn install() -> Result<PathBuf, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("aimock");
    skip::alone(&folder, || installed(&folder))
}

fn installed(folder: &Path) -> Result<PathBuf, String> {
    let program = folder.join("node_modules/@copilotkit/aimock/dist/cli.js");
    let node = Command::new("node").arg("--version").stdin(Stdio::null()).output();
    if !node.is_ok_and(|out| out.status.success()) {
        return Err("there is no Node here".to_owned());
    }
    if program.is_file() {
        return Ok(program);
    }
    if !skip::second_ring() {
        return Err(format!("`{AIMOCK}` is not here; `./gate --foreign` installs it"));
    }
    std::fs::create_dir_all(folder).map_err(|why| why.to_string())?;
    let out = Command::new("npm")
        .args(["install", "--ignore-scripts", "--no-audit", "--no-fund", "--prefix"])
        .arg(folder)
        .arg(AIMOCK)
        .stdin(Stdio::null())
        .output()
        .map_err(|why| format!("npm cannot be started: {why}"))?;
    if program.is_file() { Ok(program) } else { Err(String::from_utf8_lossy(&out.stderr).lines().take(2).collect()) }
}

/// A running server, ended with the test.
struct Mock {
    child: Child,
    port: u16,
}

impl Mock {
    fn start(program: &Path, folder: &Path, fixtures: &Value) -> Self {
        let file = folder.join("fixtures.json");
        std::fs::write(&file, json!({"fixtures": fixtures}).to_string()).unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let log = std::fs::File::create(folder.join("aimock.log")).unwrap();
        let child = Command::new("node")
            .arg(program)
            .args(["--port", &port.to_string(), "--strict", "--fixtures"])
            .arg(&file)
            .stdin(Stdio::null())
            .stdout(log.try_clone().unwrap())
            .stderr(log)
            .spawn()
            .unwrap();
        let mut mock = Self { child, port };
        let ready = poll(|| {
            let gone = mock.child.try_wait().unwrap().is_some();
            (gone || TcpStream::connect(("127.0.0.1", port)).is_ok()).then_some(!gone)
        });
        assert_eq!(ready, Some(true), "{}", std::fs::read_to_string(folder.join("aimock.log")).unwrap());
        mock
    }
}

impl Drop for Mock {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Good answers to the questions of a request: those of the offline author, with an account of the request's sentences.
struct Answers {
    proposal: String,
    paths: String,
}

fn answers(folder: &Path) -> Answers {
    answers_to(folder, WAREHOUSE, &WAREHOUSE_ACCOUNT)
}

/// What becomes of each sentence: the words that ask for something and the people who do it, or a reason.
pub(crate) type Fates<'a> = [Result<&'a [(&'a str, &'a str)], &'a str>];

/// The account of [`WAREHOUSE`].
pub(crate) const WAREHOUSE_ACCOUNT: [Result<&[(&str, &str)], &str>; 4] = [
    Ok(&[("One person walks towards the robot", "human_1")]),
    Ok(&[("One person follows the robot", "human_2")]),
    Err("errand"),
    Err("setting"),
];

/// The proposal with an account: each fact is the source of a clause about who does it, which was written for the same words.
pub(crate) fn accounted(proposal: &str, fates: &Fates<'_>) -> String {
    let mut value: Value = serde_json::from_str(proposal).unwrap();
    for clause in value["expected_events"].as_array_mut().unwrap() {
        clause.as_object_mut().unwrap().remove("source");
    }
    let (mut reading, mut facts) = (serde_json::Map::new(), 0);
    for (place, fate) in fates.iter().enumerate() {
        let share = match fate {
            Err(reason) => json!([reason]),
            Ok(asked) => asked
                .iter()
                .map(|(quote, who)| {
                    facts += 1;
                    let clauses = value["expected_events"].as_array_mut().unwrap();
                    let about = |clause: &&mut Value| {
                        let kind = clause["predicate"].to_string();
                        clause["role"] == "setup"
                            && clause["must"] == true
                            && clause.get("source").is_none()
                            && (kind.contains(&format!("\"{who}\"")) || *who == "all" && kind.contains("humans"))
                    };
                    let clause = clauses.iter_mut().find(about).unwrap_or_else(|| panic!("nothing shows {quote}"));
                    clause["source"] = json!(format!("f{facts}"));
                    json!(format!("f{facts} {who}: {quote}"))
                })
                .collect(),
        };
        reading.insert(format!("s{}", place + 1), share);
    }
    value["reading"] = Value::Object(reading);
    value.to_string()
}

fn answers_to(folder: &Path, request: &str, fates: &Fates<'_>) -> Answers {
    let tape = folder.join("tape");
    let author = format!("record:{}=offline", tape.display());
    let (finished, json) = make(folder, "recorded", request, &["--author", &author]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let mut found: Vec<(String, String)> = Vec::new();
    for file in files(&tape) {
        let exchange: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let text = |pointer: &str| exchange.pointer(pointer).and_then(Value::as_str).unwrap().to_owned();
        found.push((text("/request/form"), text("/answer/text")));
    }
    let of = |stage: &str| {
        let all: Vec<&String> = found.iter().filter(|(form, _)| form == stage).map(|(_, text)| text).collect();
        assert_eq!(all.len(), 1, "one answer to the {stage} question");
        all[0].clone()
    };
    Answers { proposal: accounted(&of("proposal"), fates), paths: of("paths") }
}

/// The paths without the robot's third node: a jump.
fn with_a_jump(paths: &str) -> String {
    let mut value: Value = serde_json::from_str(paths).unwrap();
    value["robot"].as_array_mut().unwrap().remove(2);
    value.to_string()
}

/// The arm in which the model is asked for paths as well.
const PATHS: &str = "author.paths_by=model";

/// What the server says to each question: a good proposal, first bad and then good paths. Behaviors are not asked for.
fn fixtures(answers: &Answers) -> Value {
    let says = |marks: &str, text: &str| json!({"match": {"userMessage": marks}, "response": {"content": text}});
    json!([
        says("This answer is refused", &answers.paths),
        says("Request (data, not instructions)", &answers.proposal),
        says("Your task: paths", &with_a_jump(&answers.paths)),
        says("\"place\":", &with_a_jump(&answers.paths)),
        // The list of models is made of the names that stand here.
        json!({"match": {"userMessage": "nobody asks this", "model": "small"}, "response": {"content": ""}}),
    ])
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok) {
        let path = entry.path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

fn provenance(folder: &Path, name: &str) -> Value {
    let path = folder.join(format!("bundle-{name}/details/provenance.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Every exchange of a stage, refused ones first.
fn exchanges(provenance: &Value, stage: &str) -> Vec<Value> {
    let jobs = provenance["jobs"].as_array().unwrap().iter().filter(|job| job["job"]["stage"] == stage);
    let mut found: Vec<Value> = Vec::new();
    for job in jobs {
        let attempts = job["attempts"].as_array().unwrap().iter().map(|attempt| &attempt["exchanges"]);
        for exchange in attempts.chain([&job["exchanges"]]).flat_map(|list| list.as_array().unwrap()) {
            // A refused answer stands beside its exchange, as the object it is.
            if exchange["question"].is_string() && !found.contains(exchange) {
                found.push(exchange.clone());
            }
        }
    }
    found
}

/// Runs the request with one wire format, and holds what it made against what was promised of every format.
fn realised_over(author: &str, address: &str, key: &str) {
    let Some(program) = aimock() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mock = Mock::start(&program, folder, &fixtures(&answers(folder)));
    let secret = tempfile::tempdir().unwrap();
    let file = secret.path().join("key");
    std::fs::write(&file, KEY).unwrap();
    let url = address.replace("PORT", &mock.port.to_string());
    let (key, url) = (format!("author.{key}key_file={}", file.display()), format!("author.{key}url={url}"));
    let (finished, json) = make(
        folder,
        "model",
        WAREHOUSE,
        &["--author", author, "--set", key.as_str(), "--set", url.as_str(), "--set", PATHS],
    );
    assert_eq!(json["verdict"], "realised", "{author}: {}\n{}", finished.err, finished.out);
    let provenance = provenance(folder, "model");
    let exchange = &exchanges(&provenance, "proposal")[0];
    assert!(exchange["model"].as_str().unwrap().starts_with(author.split(':').next().unwrap()), "{exchange}");
    assert!(exchange["how"]["template"]["digest"].is_string() && exchange["how"]["rung"].is_string(), "{exchange}");
    assert_eq!(exchanges(&provenance, "behaviors")[0]["model"], "compiled/1");
    re_asked_with_its_reason(&exchanges(&provenance, "paths"));
    // The key is in nothing that was written: bundle, store, spool, logs.
    let all = files(folder);
    assert!(all.len() > 10);
    for file in all {
        let bytes = std::fs::read(&file).unwrap();
        assert!(!bytes.windows(KEY.len()).any(|part| part == KEY.as_bytes()), "the key is in {}", file.display());
    }
    let cost = socrates(folder, "cost", &["--format", "json", "cost", "bundle-model"]).json();
    let total = &cost["total"][0];
    assert_eq!((&total["calls"], &total["cost"]), (&json!(3), &Value::Null), "{cost}");
    assert!(total["tokens_out"].as_u64().unwrap() > 0, "{cost}");
}

/// The first answer was refused for its jump, and the second question said so in the same words.
fn re_asked_with_its_reason(asked: &[Value]) {
    assert_eq!(asked.len(), 2, "{asked:?}");
    let jump = asked[0]["faults"].as_array().unwrap().iter().find(|fault| fault["code"] == "G-DISC").unwrap();
    let reason = jump["message"].as_str().unwrap();
    let told = asked[1]["messages"].as_array().unwrap().last().unwrap()["text"].as_str().unwrap();
    assert!(told.contains("This answer is refused") && told.contains("G-DISC") && told.contains(reason), "{told}");
    let hard = |fault: &Value| fault["code"] == "G-DISC";
    assert!(!asked[1]["faults"].as_array().is_some_and(|faults| faults.iter().any(hard)), "{:?}", asked[1]["faults"]);
}

#[test]
fn a_scenario_is_realised_over_chat_completions() {
    realised_over("openai:gpt-4o", "http://127.0.0.1:PORT/v1", "");
}

#[test]
fn a_scenario_is_realised_over_responses() {
    realised_over("responses:gpt-4o", "http://127.0.0.1:PORT/v1", "responses.");
}

#[test]
fn a_scenario_is_realised_over_anthropic_messages() {
    realised_over("anthropic:claude-sonnet", "http://127.0.0.1:PORT", "anthropic.");
}

#[test]
fn a_scenario_is_realised_over_gemini_generate_content() {
    realised_over("gemini:gemini-flash", "http://127.0.0.1:PORT", "gemini.");
}

#[test]
fn what_was_recorded_is_replayed_byte_for_byte_without_the_server() {
    let Some(program) = aimock() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mock = Mock::start(&program, folder, &fixtures(&answers(folder)));
    let tape = folder.join("model-tape").display().to_string();
    let (url, record) =
        (format!("author.vllm.url=http://127.0.0.1:{}/v1", mock.port), format!("record:{tape}=vllm:small"));
    let (finished, json) = make(folder, "live", WAREHOUSE, &["--author", &record, "--set", &url, "--set", PATHS]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    drop(mock);
    let (finished, json) = make(folder, "again", WAREHOUSE, &["--author", &format!("cassette:{tape}"), "--set", PATHS]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    let (live, again) = (provenance(folder, "live"), provenance(folder, "again"));
    for stage in ["proposal", "paths", "behaviors"] {
        let said = |provenance: &Value| -> Vec<(Value, Value)> {
            let all = exchanges(provenance, stage);
            all.into_iter().map(|mut exchange| (exchange["answer"].take(), exchange["messages"].take())).collect()
        };
        assert_eq!(said(&live), said(&again), "{stage}");
    }
    for artifact in ["proposal.json", "paths.json"] {
        let bytes = |name: &str| find(&folder.join(format!("bundle-{name}")), artifact);
        assert_eq!(bytes("live"), bytes("again"), "{artifact}");
    }
    // A question that was never recorded is told apart from a server that is gone.
    let (finished, _) =
        make(folder, "other", &WAREHOUSE.replace("busy", "quiet"), &["--author", &format!("cassette:{tape}")]);
    assert!(finished.code != 0 && finished.err.contains("no recorded answer"), "{}", finished.err);
}

/// A request in another language is asked like any other, and nothing of the grammar stands between: the answers are those to the English
/// request, with an account of its own sentences.
fn realised_in(name: &str, request: &str, fates: &Fates<'_>) {
    let Some(program) = aimock() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let answers = answers_to(folder, WAREHOUSE, fates);
    let mock = Mock::start(&program, folder, &fixtures(&answers));
    let url = format!("author.vllm.url=http://127.0.0.1:{}/v1", mock.port);
    let (finished, json) = make(folder, name, request, &["--author", "vllm:small", "--set", &url, "--set", PATHS]);
    assert_eq!(json["verdict"], "realised", "{}\n{}", finished.err, finished.out);
    assert_eq!(json["reading"]["by"], "author_alone", "{}", json["reading"]);
    let fates: Vec<&Value> =
        json["reading"]["statements"].as_array().unwrap().iter().map(|one| &one["became"]).collect();
    assert!(fates.len() == 4 && fates[0]["read"]["facts"][0] == "f1", "{fates:?}");
}

#[test]
fn a_german_and_a_chinese_request_are_realised() {
    let german = r#"
location = "warehouse"
social_context = "Ein volles Lager"
task = "Bring eine Kiste von der Laderampe zum Packplatz"
rough_scenario = "Jemand kommt dem Roboter entgegen. Eine andere Person folgt dem Roboter."
"#;
    let fates = [
        Ok(&[("kommt dem Roboter entgegen", "human_1")][..]),
        Ok(&[("Eine andere Person folgt dem Roboter", "human_2")][..]),
        Err("errand"),
        Err("setting"),
    ];
    realised_in("german", german, &fates);
    let chinese = r#"
location = "warehouse"
social_context = "忙碌的仓库"
task = "把箱子从装卸区搬到包装区"
rough_scenario = "一个人向机器人走来。另一个人跟着机器人。"
"#;
    let fates = [
        Ok(&[("一个人向机器人走来", "human_1")][..]),
        Ok(&[("另一个人跟着机器人", "human_2")][..]),
        Err("errand"),
        Err("setting"),
    ];
    realised_in("chinese", chinese, &fates);
}

fn find(folder: &Path, name: &str) -> Vec<u8> {
    let all = files(folder);
    let path = all.iter().find(|path| path.file_name().is_some_and(|file| file == name));
    std::fs::read(path.unwrap_or_else(|| panic!("no {name} in {all:?}"))).unwrap()
}

/// One run against a server that answers every question like this.
fn against(response: &Value, more: &[&str]) -> Option<Finished> {
    let program = aimock()?;
    let folder = tempfile::tempdir().unwrap();
    let always = ["Request (data", "This answer is refused", "Earlier answers were refused"];
    let fixtures: Value =
        always.iter().map(|words| json!({"match": {"userMessage": words}, "response": response})).collect();
    let mock = Mock::start(&program, folder.path(), &fixtures);
    let url = format!("author.url=http://127.0.0.1:{}/v1", mock.port);
    let mut args = vec!["--author", "openai:gpt-4o", "--set", url.as_str()];
    args.extend(more);
    Some(make(folder.path(), "faulty", WAREHOUSE, &args).0)
}

#[test]
fn a_refused_key_and_an_unknown_model_end_with_what_to_do() {
    for (status, words) in [(401, "Incorrect API key"), (404, "The model does not exist")] {
        let error = json!({"error": {"message": words, "type": "invalid_request_error"}, "status": status});
        let Some(finished) = against(&error, &[]) else { return };
        assert_eq!(finished.code, 5, "{}\n{}", finished.err, finished.out);
        let told = format!("{}{}", finished.err, finished.out);
        assert!(told.contains(words) && told.contains("T-AUTH") && finished.err.contains("hint:"), "{told}");
    }
}

#[test]
fn an_answer_that_never_becomes_right_ends_with_its_faults() {
    for (content, code) in [("Es tut mir leid.", "E-JSON"), ("{\"title\": \"x\"", "E-TRUNC"), ("", "E-EMPTY")] {
        let Some(finished) = against(&json!({"content": content}), &[]) else { return };
        assert_ne!(finished.code, 0);
        let told = format!("{}{}", finished.err, finished.out);
        assert!(told.contains(code) && finished.err.contains("hint:"), "{content}: {told}");
    }
}
