use std::collections::BTreeSet;

use socrates_model::wire::{Acquire, Outcome, Report, ScenarioSpec, Submit};
use socrates_model::{Digest, Fault, FaultCode};
use socrates_orchestrator::{Answer, Effect, Event, Policy, step};

use super::super::counts::Counts;
use super::*;

/// Labels with their values, in order.
type Labels = Vec<(String, String)>;
/// A sample: name, labels, value.
type Sample = (String, Labels, f64);

fn is_name(text: &str) -> bool {
    let first = text.chars().next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    first && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == ':')
}

/// `name{label="value",…} number`, as the format has it.
fn sample(line: &str) -> Sample {
    let (name, mut rest) = line.split_at(line.find(['{', ' ']).unwrap());
    assert!(is_name(name), "{line}");
    let mut labels = Vec::new();
    if let Some(inside) = rest.strip_prefix('{') {
        rest = inside;
        while !rest.starts_with('}') {
            let (label, quoted) = rest.split_once("=\"").unwrap();
            assert!(is_name(label), "{line}");
            let (mut value, mut end) = (String::new(), None);
            let mut signs = quoted.char_indices();
            while let Some((at, sign)) = signs.next() {
                match sign {
                    '"' => {
                        end = Some(at + 1);
                        break;
                    }
                    '\\' => match signs.next().unwrap().1 {
                        'n' => value.push('\n'),
                        other @ ('\\' | '"') => value.push(other),
                        other => panic!("`\\{other}` in {line}"),
                    },
                    other => value.push(other),
                }
            }
            labels.push((label.to_owned(), value));
            rest = quoted[end.unwrap()..].trim_start_matches(',');
        }
        rest = &rest[1..];
    }
    let number = rest.strip_prefix(' ').unwrap();
    (name.to_owned(), labels, number.parse().unwrap_or_else(|_| panic!("`{number}` is no number: {line}")))
}

/// Reads a whole text as a collector does, and gives its samples; panics where it is not well formed.
fn read(text: &str) -> Vec<Sample> {
    assert!(text.ends_with('\n'));
    let mut all: Vec<Sample> = Vec::new();
    let mut families: BTreeMap<String, String> = BTreeMap::new();
    let (mut helped, mut family, mut seen) = (None, String::new(), BTreeSet::new());
    for line in text.lines() {
        if let Some(help) = line.strip_prefix("# HELP ") {
            let (name, words) = help.split_once(' ').unwrap();
            assert!(!words.is_empty() && !families.contains_key(name), "{line}");
            helped = Some(name.to_owned());
        } else if let Some(kind) = line.strip_prefix("# TYPE ") {
            let (name, kind) = kind.split_once(' ').unwrap();
            assert_eq!(helped.take().as_deref(), Some(name), "help comes first: {line}");
            assert!(["counter", "gauge", "histogram"].contains(&kind), "{line}");
            assert_eq!(kind == "counter", name.ends_with("_total"), "{line}");
            assert!(name.starts_with("socrates_"), "{line}");
            family = name.to_owned();
            families.insert(family.clone(), kind.to_owned());
        } else {
            let found = sample(line);
            let of_family = match families[&family].as_str() {
                "histogram" => ["_bucket", "_sum", "_count"].iter().any(|end| found.0 == format!("{family}{end}")),
                _ => found.0 == family,
            };
            assert!(of_family, "`{line}` stands under `{family}`");
            assert!(seen.insert((found.0.clone(), found.1.clone())), "twice: {line}");
            all.push(found);
        }
    }
    for (name, _) in families.iter().filter(|(_, kind)| *kind == "histogram") {
        check_histogram(name, &all);
    }
    all
}

/// Ranges grow, the last is everything, and that is the count.
fn check_histogram(name: &str, all: &[Sample]) {
    let mut series: BTreeMap<Labels, Vec<(f64, f64)>> = BTreeMap::new();
    for (_, labels, value) in all.iter().filter(|(of, ..)| *of == format!("{name}_bucket")) {
        let (le, rest): (Vec<_>, Vec<_>) = labels.iter().cloned().partition(|(label, _)| label == "le");
        let bound = if le[0].1 == "+Inf" { f64::INFINITY } else { le[0].1.parse().unwrap() };
        series.entry(rest).or_default().push((bound, *value));
    }
    for (labels, ranges) in series {
        assert!(ranges.windows(2).all(|two| two[0].0 < two[1].0 && two[0].1 <= two[1].1), "{name} {ranges:?}");
        let (last, count) = ranges[ranges.len() - 1];
        assert!(last.is_infinite(), "{name}");
        let counted = all.iter().find(|(of, own, _)| *of == format!("{name}_count") && *own == labels).unwrap();
        assert!((counted.2 - count).abs() < 0.5, "{name}");
        assert!(all.iter().any(|(of, own, _)| *of == format!("{name}_sum") && *own == labels), "{name}");
    }
}

fn value(all: &[Sample], name: &str, labels: &[(&str, &str)]) -> f64 {
    let same = |own: &[(String, String)]| {
        labels.iter().all(|(label, value)| own.iter().any(|(known, is)| known == label && is == value))
    };
    all.iter().find(|(of, own, _)| of == name && same(own)).unwrap_or_else(|| panic!("no {name} {labels:?}")).2
}

/// One scenario submitted, its first job failed once.
fn state() -> State {
    let mut state = State::new(Policy { code_version: "9".to_owned(), ..Policy::default() });
    let spec = ScenarioSpec {
        id: "a".parse().unwrap(),
        request: Digest::of(b"r"),
        location: Digest::of(b"l"),
        reading: Digest::of(b"g"),
        seed: 1,
        planners: Vec::new(),
        run_seeds: vec![1],
        pinned: BTreeMap::new(),
        settings: BTreeMap::from([("author".to_owned(), "openai:a\"b\\c".to_owned())]),
        review: false,
        order: None,
    };
    let submit = Submit::new("b", socrates_model::wire::Priority::Normal, vec![spec]);
    step(&mut state, Event::Submit { submit, to: 0 }, 0);
    let ask = Acquire {
        req_id: "q".to_owned(),
        instance: "w".to_owned(),
        stages: vec![Stage::Proposal],
        credits: 1,
        code_version: "9".to_owned(),
    };
    let effects = step(&mut state, Event::Acquire { ask, to: 0 }, 2_500);
    let grant = effects.iter().find_map(|effect| {
        let Effect::Reply { answer, .. } = effect else { return None };
        let Answer::Acquired(socrates_model::wire::Acquired::Grants(grants)) = &**answer else { return None };
        grants.first().cloned()
    });
    let grant = grant.unwrap();
    let report = Report {
        instance: "w".to_owned(),
        key: grant.spec.key,
        attempt: grant.attempt,
        fence: grant.fence,
        outcome: Outcome::Failed {
            class: FailureClass::Transient,
            faults: vec![Fault::new(FaultCode::TNet, "x", "y")],
            retry_after_ms: None,
        },
        artifacts: Vec::new(),
        wall_ms: 1,
        tokens: (70, 30),
        remark: String::new(),
        repair: None,
        anew: Vec::new(),
        verdict: None,
        rates: None,
    };
    for _twice in 0..2 {
        step(&mut state, Event::Report { report: Box::new(report.clone()), to: 0 }, 4_000);
    }
    state
}

/// A commit, an answer, a refusal and an artifact.
fn counts() -> Counts {
    let counts = Counts::new();
    counts.committed(Duration::from_micros(300), 3);
    counts.answered(socrates_link::keys::STATUS, Duration::from_micros(700));
    counts.refused(socrates_link::keys::SUBMIT, Refusal::Busy);
    let moved = socrates_kit::BlobMove { put: true, bytes: 70, whole: true, refused: false, took: Duration::ZERO };
    counts.moved(moved);
    counts.moved(socrates_kit::BlobMove { put: false, refused: true, whole: false, ..moved });
    counts
}

#[test]
fn a_collector_reads_every_figure_and_none_grows_with_the_work() {
    let mut state = state();
    // A thousand tokens cost a thousandth of what a million do.
    state.policy.prices = BTreeMap::from([("openai:a\"b\\c".to_owned(), (2_000_000, 10_000_000))]);
    let text = text(&state, 5_000, &counts().now());
    let all = read(&text);
    let is = |name: &str, labels: &[(&str, &str)], wanted: f64| {
        let found = value(&all, name, labels);
        assert!((found - wanted).abs() < 1e-9, "{name} {labels:?} is {found}, not {wanted}");
    };
    is("socrates_jobs", &[("stage", "proposal"), ("state", "delayed")], 1.0);
    is("socrates_jobs", &[("stage", "scoring"), ("state", "blocked")], 1.0);
    is("socrates_attempts_total", &[("stage", "proposal"), ("outcome", "failed"), ("class", "transient")], 1.0);
    is("socrates_attempts_total", &[("stage", "paths"), ("outcome", "succeeded")], 0.0);
    is("socrates_attempt_duration_seconds_sum", &[("stage", "proposal")], 1.5);
    is("socrates_queue_wait_seconds_bucket", &[("stage", "proposal"), ("le", "2.5")], 1.0);
    is("socrates_queue_wait_seconds_bucket", &[("stage", "proposal"), ("le", "1")], 0.0);
    is("socrates_duplicate_reports_total", &[], 1.0);
    is("socrates_workers", &[("stage", "proposal"), ("state", "idle")], 1.0);
    is("socrates_llm_tokens_total", &[("model", "openai:a\"b\\c"), ("direction", "in")], 70.0);
    is("socrates_llm_cost_total", &[("model", "openai:a\"b\\c")], 0.000_44);
    is("socrates_rpc_duration_seconds_bucket", &[("method", "status"), ("le", "0.001")], 1.0);
    is("socrates_rpc_duration_seconds_count", &[("method", "beat")], 0.0);
    is("socrates_rpc_refusals_total", &[("method", "submit"), ("reason", "busy")], 1.0);
    is("socrates_rpc_refusals_total", &[("method", "blob_get"), ("reason", "refused")], 1.0);
    is("socrates_rpc_refusals_total", &[("method", "report"), ("reason", "unreadable")], 0.0);
    is("socrates_blob_bytes_total", &[("op", "put")], 70.0);
    is("socrates_blobs_total", &[("op", "put")], 1.0);
    is("socrates_blobs_total", &[("op", "get")], 0.0);
    is("socrates_circuit", &[("stage", "paths"), ("state", "closed")], 1.0);
    is("socrates_batch_open", &[("batch", "b"), ("priority", "normal")], 1.0);
    is("socrates_batch_running", &[("batch", "b")], 0.0);
    is("socrates_commit_duration_seconds_bucket", &[("le", "0.0005")], 1.0);
    is("socrates_commit_batch_size_sum", &[], 3.0);
    is("socrates_dead_letters", &[("stage", "proposal")], 0.0);
    is("socrates_build_info", &[("version", "9")], 1.0);
    for (name, labels, _) in &all {
        let known = [
            "stage",
            "state",
            "outcome",
            "class",
            "le",
            "model",
            "direction",
            "version",
            "method",
            "reason",
            "op",
            "batch",
            "priority",
        ];
        assert!(labels.iter().all(|(label, _)| known.contains(&label.as_str())), "{name} {labels:?}");
    }
}

#[test]
fn every_figure_that_the_shipped_alerts_speak_of_is_there() {
    let rules = include_str!("../../../../../deploy/prometheus/socrates.rules.yml");
    let mut state = state();
    // What was never lost or asked for has no series of its own.
    state.tally.tokens.insert("m".to_owned(), (1, 1));
    let names: BTreeSet<String> =
        read(&text(&state, 5_000, &Counts::new().now())).into_iter().map(|one| one.0).collect();
    let said: BTreeSet<&str> = rules
        .split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .filter(|word| word.starts_with("socrates_"))
        .collect();
    assert!(said.len() > 7, "{said:?}");
    let missing: Vec<_> = said.into_iter().filter(|word| !names.contains(*word)).collect();
    assert_eq!(missing, [""; 0], "{names:?}");
}

#[test]
fn parts_are_written_as_decimals_of_the_unit() {
    for (value, to_unit, text) in [
        (1_500, 1_000, "1.5"),
        (2_000, 1_000, "2"),
        (10, 1_000, "0.01"),
        (250, 1_000_000, "0.00025"),
        (7, 1, "7"),
        (0, 1_000, "0"),
        (10, 1, "10"),
    ] {
        assert_eq!(in_units(value, to_unit), text);
    }
}
