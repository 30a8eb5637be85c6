//! Every message of workers and clients as version 3 wrote it: later versions read those bytes, and write what version 3 reads.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;
use serde::de::DeserializeOwned;
use socrates_link::{Envelope, VERSION, decode, encode};
use socrates_model::fault::{Fault, FaultCode, Where};
use socrates_model::job::{Artifact, Item, JobKey, JobSpec, Stage};
use socrates_model::report::{Repair, Verdict};
use socrates_model::standing::{JobState, ScenarioEnd};
use socrates_model::wire::{
    Acquire, Acquired, Beat, BeatReply, BeatVerdict, BlobGet, BlobPart, BlobPut, Control, Grant, Held, Hello,
    JobStatus, Limits, NoWork, Notice, Outcome, PastAsk, PastEnd, PastPart, Priority, Rate, Rates, Recorded, Release,
    Report, ScenarioSpec, ScenarioStatus, Seeds, Series, StatusAsk, StatusReply, Submit, Submitted, Welcome,
};
use socrates_model::{AgentId, Digest, FailureClass, PlannerName, Role, Run, ScenarioId};

/// `KIND HEX` a line. A version that is out is never changed here; the next one gets a file of its own.
const KEPT: &str = include_str!("../messages.v3.txt");

/// Reads bytes as one kind of message and gives what they say as JSON; the bytes again, as they are written now.
type Read = fn(&str, &[u8]) -> (serde_json::Value, Vec<u8>);

/// A kind with a message of it as it is written now, and its reader.
struct Kind {
    name: &'static str,
    written: Vec<u8>,
    read: Read,
}

fn kind<T: Serialize + DeserializeOwned>(name: &'static str, body: T) -> Kind {
    Kind { name, written: written(name.split('.').next().unwrap(), body), read: read::<T> }
}

fn written<T: Serialize>(kind: &str, body: T) -> Vec<u8> {
    let (msg_id, sender) = ("m".to_owned(), "s".to_owned());
    let fresh = Envelope::fresh(kind, &sender, 7, body);
    encode(&Envelope { v: 3, msg_id, sent_ms: 1, ..fresh }).unwrap()
}

fn read<T: Serialize + DeserializeOwned>(kind: &str, bytes: &[u8]) -> (serde_json::Value, Vec<u8>) {
    let kept = decode::<T>(kind.split('.').next().unwrap(), bytes);
    let body = kept.unwrap_or_else(|why| panic!("{kind}: {why}")).body;
    (serde_json::to_value(&body).unwrap(), written(kind.split('.').next().unwrap(), body))
}

fn key(stage: Stage, item: Item) -> JobKey {
    JobKey { scenario: ScenarioId::new("hall-1").unwrap(), stage, item, revision: 2 }
}

fn run() -> Run {
    Run { planner: PlannerName::reference(), seed: 4 }
}

fn fault() -> Fault {
    Fault::new(FaultCode::GDisc, Where::agent(AgentId::Robot).step(3), "jumps").about(["to the lift"])
}

fn artifact() -> Artifact {
    let (digest, media) = (Digest::of(b"paths"), "application/json".to_owned());
    Artifact { role: Role::Paths, digest, len: 5, media, inline: Some("paths".to_owned()) }
}

fn grant() -> Grant {
    let spec = JobSpec {
        key: key(Stage::Simulation, run().into()),
        inputs: BTreeMap::from([(Role::Paths, Digest::of(b"paths"))]),
        seed: 11,
        feedback: vec![fault()],
        refused: Some(Digest::of(b"refused")),
        settings: BTreeMap::from([("pace".to_owned(), "max".to_owned())]),
    };
    let inline = BTreeMap::from([(Digest::of(b"paths"), "paths".to_owned())]);
    let (idem_key, traceparent) = (Digest::of(b"key"), None);
    Grant { spec, attempt: 3, fence: 41, lease_ms: 15_000, deadline_ms: 120_000, idem_key, inline, traceparent }
}

fn spec() -> ScenarioSpec {
    ScenarioSpec {
        id: ScenarioId::new("hall-1").unwrap(),
        request: Digest::of(b"request"),
        location: Digest::of(b"location"),
        reading: Digest::of(b"reading"),
        seed: 9,
        planners: vec![PlannerName::reference()],
        run_seeds: vec![4, 5],
        pinned: BTreeMap::from([(Role::Proposal, Digest::of(b"proposal"))]),
        settings: BTreeMap::from([("author".to_owned(), "offline".to_owned())]),
        review: true,
        order: Some(Digest::of(b"order")),
    }
}

fn report(outcome: Outcome) -> Report {
    let rate = Rate { limit: 100, left: 7, whole_in_ms: Some(60_000) };
    Report {
        instance: "i".to_owned(),
        key: key(Stage::Scoring, run().into()),
        attempt: 3,
        fence: 41,
        outcome,
        artifacts: vec![artifact()],
        wall_ms: 12,
        tokens: (900, 100),
        remark: "2 people".to_owned(),
        repair: Some(Repair { stage: Stage::Paths, faults: vec![fault()] }),
        anew: vec![Repair { stage: Stage::Proposal, faults: Vec::new() }],
        verdict: Some(Verdict::NotTriggered),
        rates: Some(Rates { requests: Some(rate), tokens: None }),
    }
}

/// Messages of workers.
fn of_workers() -> Vec<Kind> {
    let (instance, req_id, version) = ("i".to_owned(), "q1".to_owned(), "0.1.0".to_owned());
    let hello = Hello {
        instance: instance.clone(),
        stages: vec![Stage::Paths, Stage::Scoring],
        code_version: version.clone(),
        pid: 12,
        host: "lab-3".to_owned(),
    };
    let acquire =
        Acquire { req_id, instance: instance.clone(), stages: vec![Stage::Paths], credits: 2, code_version: version };
    let held = Held { key: key(Stage::Paths, Item::Whole), attempt: 1, fence: 40, characters: 0 };
    let verdicts = vec![
        (key(Stage::Paths, Item::Whole), 1, BeatVerdict::Ok),
        (key(Stage::Behaviors, Item::Whole), 2, BeatVerdict::Cancel),
        (key(Stage::Proposal, Item::Whole), 3, BeatVerdict::Lost),
    ];
    let failed = Outcome::Failed { class: FailureClass::Semantic, faults: vec![fault()], retry_after_ms: Some(2_000) };
    let release = Release { instance: instance.clone(), key: key(Stage::Paths, Item::Whole), attempt: 1, fence: 40 };
    vec![
        kind("hello", hello),
        kind("hello.answer", Welcome::Welcome { epoch: 7, lease_ms: 15_000, beat_ms: 2_000 }),
        kind("hello.refused", Welcome::Incompatible { range: "0.1.0".to_owned() }),
        kind("acquire", acquire),
        kind("acquire.answer", Acquired::Grants(vec![grant()])),
        kind("acquire.none", Acquired::None { retry_after_ms: 500, reason: NoWork::Throttled }),
        kind("beat", Beat { instance, held: vec![held], draining: true }),
        kind("beat.answer", BeatReply { verdicts, missing: vec![grant()], epoch: 7 }),
        kind("report", report(Outcome::Ok)),
        kind("report.failed", report(failed)),
        kind("report.answer", Recorded::Late),
        kind("release", release),
        kind("blob_get", BlobGet { digest: Digest::of(b"paths"), offset: 3 }),
        kind("blob_get.answer", BlobPart { len: 5, found: true, bytes: b"hs".to_vec() }),
        kind("blob_put", BlobPut { digest: Digest::of(b"paths"), len: 5, offset: 0, bytes: b"paths".to_vec() }),
    ]
}

/// Messages of clients and viewers.
fn of_clients() -> Vec<Kind> {
    let scenario = ScenarioId::new("hall-1").unwrap();
    let job = JobStatus {
        key: key(Stage::Paths, Item::Whole),
        state: JobState::Succeeded,
        attempts: 2,
        wall_ms: 12,
        characters: 0,
        remark: "34 m".to_owned(),
        faults: vec![fault()],
        artifacts: vec![artifact()],
    };
    let done = ScenarioEnd::Judged(Verdict::Realised);
    let status = StatusReply {
        total: 3,
        done: 1,
        running: 1,
        results: BTreeMap::from([(done, 1)]),
        serving_ms: 5_000,
        done_before: 1,
        workers: BTreeMap::from([("paths".to_owned(), 2)]),
        scenarios: vec![ScenarioStatus { id: scenario.clone(), done: true, result: Some(done), jobs: vec![job] }],
        ..StatusReply::default()
    };
    let notice = Notice {
        seq: 8,
        key: key(Stage::Simulation, run().into()),
        state: JobState::Leased,
        attempt: 1,
        remark: "61.2 s simulated".to_owned(),
        wall_ms: 12,
    };
    let end = PastEnd { place: 4, scenario: scenario.clone(), batch: "b".to_owned(), end: Some(ScenarioEnd::Failed) };
    let limits = Limits { deadline_ms: 3_600_000, tokens: 100_000, money: 2_000_000 };
    let listed = Series {
        first: ScenarioSpec { id: ScenarioId::new("m-01").unwrap(), ..spec() },
        seeds: Seeds::Listed(vec![7, 9]),
    };
    let next = Series { first: ScenarioSpec { id: ScenarioId::new("n-01").unwrap(), ..spec() }, seeds: Seeds::Next(3) };
    let long = Submit { series: vec![listed, next], limits, ..Submit::new("b", Priority::Normal, Vec::new()) };
    let rows = PastPart::Rows { digest: Digest::of(b"rows"), len: 4, bytes: b"rows".to_vec() };
    vec![
        kind("submit", Submit::new("b", Priority::Bulk, vec![spec()])),
        kind("submit.series", long),
        kind("submit.answer", Submitted::Accepted { new: 1, held: 0 }),
        kind("submit.series_answer", Submitted::Accepted { new: 5, held: 5 }),
        kind("submit.refused", Submitted::Refused { why: "known".to_owned() }),
        kind("submit.busy", Submitted::Busy { retry_after_ms: 2_000 }),
        kind("control.pause", Control::Pause("b".to_owned())),
        kind("control.resume", Control::Resume(String::new())),
        kind("control.cancel", Control::Cancel("b".to_owned())),
        kind("control.requeue", Control::Requeue(scenario.clone())),
        kind("status", StatusAsk { batch: "b".to_owned(), from: 200, ..StatusAsk::default() }),
        kind("status.answer", status),
        kind("notice", notice),
        kind("past.ends", PastAsk::Ends { from: 4 }),
        kind("past.rows", PastAsk::Rows { scenario, offset: 9 }),
        kind("past.ends_answer", PastPart::Ends(vec![end])),
        kind("past.rows_answer", rows),
        kind("past.unknown", PastPart::Unknown { why: "gone".to_owned() }),
    ]
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

fn unhex(text: &str) -> Vec<u8> {
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

/// A grant as it is written since attempts are traced: what version 3 of before reads of it is all that it wrote itself.
#[test]
fn a_grant_with_a_trace_says_the_same_to_a_reader_of_before() {
    let parent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01".parse().unwrap();
    let traced = Grant { traceparent: Some(parent), ..grant() };
    let bytes = written("acquire", Acquired::Grants(vec![traced.clone()]));
    let read = decode::<Acquired>("acquire", &bytes).unwrap().body;
    assert_eq!(read, Acquired::Grants(vec![traced.clone()]));
    let (mut now, before) = (serde_json::to_value(&traced).unwrap(), serde_json::to_value(grant()).unwrap());
    assert!(now.as_object_mut().unwrap().remove("traceparent").is_some() && now == before, "{now}");
}

#[test]
fn every_message_of_version_3_is_read_as_it_was_meant() {
    let kinds: Vec<Kind> = of_workers().into_iter().chain(of_clients()).collect();
    assert_eq!(VERSION, 3, "a new version keeps its messages in a file of its own, and reads this one");
    let kept: BTreeMap<&str, &str> = KEPT.lines().filter_map(|line| line.split_once(' ')).collect();
    let now: String = kinds.iter().map(|kind| format!("{} {}\n", kind.name, hex(&kind.written))).collect();
    let (names, known): (Vec<&str>, Vec<&str>) = (
        kinds.iter().map(|kind| kind.name).collect(),
        KEPT.lines().filter_map(|line| line.split(' ').next()).collect(),
    );
    assert_eq!(names, known, "a kind came or went; the file would be:\n{now}");
    for kind in &kinds {
        let (meant, _) = (kind.read)(kind.name, &kind.written);
        let (said, again) = (kind.read)(kind.name, &unhex(kept[kind.name]));
        assert_eq!(said, meant, "{}", kind.name);
        // What was read is written with the same meaning: a neighbor of the version before understands it.
        assert_eq!((kind.read)(kind.name, &again).0, meant, "{}", kind.name);
    }
}
