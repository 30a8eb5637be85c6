//! What every store promises, run on each of them, and what the file promises besides.

use std::collections::BTreeMap;

use socrates_model::job::{Artifact, Stage};
use socrates_model::wire::{
    Acquire, Acquired, Outcome, Priority, Report, ScenarioSpec, Seeds, Series, Submit, Submitted,
};
use socrates_model::{Digest, ScenarioId, Verdict};
use socrates_orchestrator::{Answer, Effect, Event, JobState, Policy, Row, Snapshot, State, step};

use crate::{MemoryStore, Reader, SCHEMA_VERSION, SqliteStore, Standing, Store, StoreError};

macro_rules! keeps_store_promises {
    ($name:ident, $make:expr) => {
        mod $name {
            #[test]
            fn what_was_saved_is_loaded() {
                let (_keep, mut store) = $make;
                super::what_was_saved_is_loaded(&mut store);
            }
            #[test]
            fn a_second_result_is_refused_and_nothing_of_it_stays() {
                let (_keep, mut store) = $make;
                super::a_second_result_is_refused_and_nothing_of_it_stays(&mut store);
            }
            #[test]
            fn every_reign_has_a_higher_number() {
                let (_keep, mut store) = $make;
                super::every_reign_has_a_higher_number(&mut store);
            }
            #[test]
            fn small_texts_are_kept() {
                let (_keep, mut store) = $make;
                super::small_texts_are_kept(&mut store);
            }
        }
    };
}

keeps_store_promises!(memory, ((), crate::MemoryStore::new()));
keeps_store_promises!(sqlite, {
    let dir = tempfile::tempdir().unwrap();
    let store = crate::SqliteStore::open(&dir.path().join("jobs.sqlite")).unwrap();
    (dir, store)
});

fn scenario(id: &str) -> ScenarioSpec {
    ScenarioSpec {
        id: ScenarioId::new(id).unwrap(),
        request: Digest::of(id.as_bytes()),
        location: Digest::of(b"map"),
        reading: Digest::of(b"reading"),
        seed: 1,
        planners: vec!["mppi".parse().unwrap()],
        run_seeds: vec![1, 2],
        pinned: BTreeMap::new(),
        settings: BTreeMap::from([("author".to_owned(), "offline".to_owned())]),
        review: false,
        order: None,
    }
}

fn rows(effects: &[Effect]) -> Vec<Row> {
    let row = |effect: &Effect| match effect {
        Effect::Save(row) => Some(row.clone()),
        Effect::Reply { .. } | Effect::Notice { .. } | Effect::Hint(_) | Effect::ScenarioDone { .. } => None,
    };
    effects.iter().filter_map(row).collect()
}

pub(crate) fn submit(state: &mut State, id: &str) -> Vec<Row> {
    let submit = Submit::new("b", Priority::Normal, vec![scenario(id)]);
    rows(&step(state, Event::Submit { submit, to: 0 }, 0))
}

/// A series, the first of whose scenarios has this name.
pub(crate) fn submit_series(state: &mut State, first: &str, seeds: Vec<u64>) -> Vec<Row> {
    let first = ScenarioSpec { seed: seeds[0], ..scenario(first) };
    let series = vec![Series { first, seeds: Seeds::Listed(seeds) }];
    let submit = Submit { series, ..Submit::new("line", Priority::Bulk, Vec::new()) };
    let effects = step(state, Event::Submit { submit, to: 0 }, 0);
    let taken = |effect: &Effect| matches!(effect, Effect::Reply { answer, .. } if matches!(**answer, Answer::Submitted(Submitted::Accepted { .. })));
    assert!(effects.iter().any(taken), "{effects:?}");
    rows(&effects)
}

/// One acquire and one success; the rows of both.
pub(crate) fn work(state: &mut State) -> Vec<Row> {
    let ask = Acquire {
        req_id: state.next_fence.to_string(),
        instance: "w".to_owned(),
        stages: Stage::WORKERS.to_vec(),
        credits: 1,
        code_version: String::new(),
    };
    let effects = step(state, Event::Acquire { ask, to: 0 }, 0);
    let mut all = rows(&effects);
    let answer = effects.iter().find_map(|effect| match effect {
        Effect::Reply { answer, .. } => Some(&**answer),
        Effect::Save(_) | Effect::Notice { .. } | Effect::Hint(_) | Effect::ScenarioDone { .. } => None,
    });
    let granted =
        if let Some(Answer::Acquired(Acquired::Grants(grants))) = answer { grants.first().cloned() } else { None };
    let Some(grant) = granted else { return all };
    let role = socrates_model::Role::made_by(grant.spec.key.stage).unwrap();
    let text = format!("{role} of {}", grant.spec.key);
    let report = Report {
        instance: "w".to_owned(),
        key: grant.spec.key,
        attempt: grant.attempt,
        fence: grant.fence,
        outcome: Outcome::Ok,
        artifacts: vec![Artifact {
            role,
            digest: Digest::of(text.as_bytes()),
            len: text.len() as u64,
            media: "text/plain".to_owned(),
            inline: Some(text),
        }],
        wall_ms: 1,
        tokens: (0, 0),
        remark: "done".to_owned(),
        repair: None,
        anew: Vec::new(),
        rates: None,
        verdict: Some(Verdict::Realised),
    };
    all.extend(rows(&step(state, Event::Report { report: Box::new(report), to: 0 }, 0)));
    all
}

fn what_was_saved_is_loaded(store: &mut dyn Store) {
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    store.save(&submit(&mut state, "b")).unwrap();
    // More scenarios than are made ahead, all of the same work.
    store.save(&submit_series(&mut state, "line-1", vec![7; 40])).unwrap();
    while !state.is_done() {
        store.save(&work(&mut state)).unwrap();
        assert_eq!(store.fsck().unwrap(), Vec::<String>::new());
        let mut again = State::restore(store.load().unwrap(), Policy::default(), 0);
        step(&mut again, Event::Recover { alone: false }, 0);
        assert_eq!(socrates_orchestrator::fsck(&again), Vec::<String>::new());
        assert_eq!(again.counts(), state.counts());
        for (key, job) in &state.jobs {
            let kept = &again.jobs[key];
            let same = (kept.state, &kept.spec, &kept.result, &kept.attempts)
                == (job.state, &job.spec, &job.result, &job.attempts);
            assert!(same, "{key}");
        }
        assert!(again.next_fence >= state.next_fence && again.next_seq == state.next_seq);
    }
    assert_eq!(state.jobs.values().filter(|job| job.state == JobState::Succeeded).count(), 462);
}

fn a_second_result_is_refused_and_nothing_of_it_stays(store: &mut dyn Store) {
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    let done = work(&mut state);
    store.save(&done).unwrap();
    let mut again = submit(&mut state, "b");
    again.extend(done.into_iter().filter(|row| matches!(row, Row::Result(..))));
    assert!(matches!(store.save(&again), Err(StoreError::SecondResult { .. })));
    assert_eq!(store.load().unwrap().scenarios.len(), 1, "all or none");
}

fn every_reign_has_a_higher_number(store: &mut dyn Store) {
    let first = store.load().unwrap().epoch;
    assert_eq!(store.load().unwrap().epoch, first + 1);
}

fn small_texts_are_kept(store: &mut dyn Store) {
    let digest = Digest::of("größe".as_bytes());
    store.save(&[Row::Text(digest, "größe".to_owned())]).unwrap();
    assert_eq!(store.text(&digest).unwrap().as_deref(), Some("größe"));
    assert_eq!(store.texts().unwrap(), [digest]);
    assert_eq!(store.text(&Digest::of(b"other")).unwrap(), None);
}

#[test]
fn a_store_belongs_to_one_process_at_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let first = SqliteStore::open(&path).unwrap();
    assert!(matches!(SqliteStore::open(&path), Err(StoreError::Locked { .. })));
    drop(first);
    SqliteStore::open(&path).unwrap();
}

#[test]
fn a_store_can_be_looked_at_while_it_is_held_and_nothing_changes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let standings = |path: &std::path::Path| Reader::open(path).and_then(|reader| reader.standings(0, u64::MAX));
    assert!(standings(&path).is_err() && !path.exists(), "a look makes no store");
    drop(rusqlite::Connection::open(&path).unwrap().execute_batch("pragma journal_mode = wal;"));
    assert!(standings(&path).unwrap().is_empty(), "its tables are not made yet");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    let epoch = store.load().unwrap().epoch;
    let of = |standings: Vec<Standing>| {
        standings.into_iter().map(|one| (one.scenario.to_string(), one.result)).collect::<Vec<_>>()
    };
    assert_eq!(of(standings(&path).unwrap()), [("a".to_owned(), None)]);
    while !state.is_done() {
        store.save(&work(&mut state)).unwrap();
    }
    let peek = Reader::open(&path).unwrap().all().unwrap();
    assert_eq!(peek.scenarios[0].end, state.scenarios.values().next().unwrap().end);
    assert_eq!((peek.results.len(), peek.attempts.len()), (11, 11));
    let ended = peek.scenarios[0].end.unwrap();
    assert_eq!(of(standings(&path).unwrap()), [("a".to_owned(), Some(ended))]);
    // A scenario whose name begins alike is another one.
    store.save(&submit(&mut state, "a0")).unwrap();
    let reader = Reader::open(&path).unwrap();
    let own = reader.scenario(&ScenarioId::new("a").unwrap()).unwrap();
    assert_eq!(
        (own.scenarios, own.jobs, own.attempts, own.results),
        (peek.scenarios, peek.jobs, peek.attempts, peek.results)
    );
    assert_eq!(reader.scenario(&ScenarioId::new("b").unwrap()).unwrap(), Snapshot::default());
    let later = reader.standings(1, 5).unwrap();
    assert_eq!(later.iter().map(|one| (one.place, one.scenario.as_str())).collect::<Vec<_>>(), [(1, "a0")]);
    assert_eq!(store.load().unwrap().epoch, epoch + 1, "a look begins no reign");
}

#[test]
fn a_store_knows_its_last_64_starts_and_an_older_copy_only_those_before_it() {
    let dir = tempfile::tempdir().unwrap();
    let (path, copy) = (dir.path().join("jobs.sqlite"), dir.path().join("copy.sqlite"));
    assert_eq!(SqliteStore::open(&path).unwrap().begin(u64::MAX).unwrap(), [u64::MAX]);
    std::fs::copy(&path, &copy).unwrap();
    assert_eq!(SqliteStore::open(&path).unwrap().begin(7).unwrap(), [u64::MAX, 7]);
    assert_eq!(SqliteStore::open(&copy).unwrap().begin(8).unwrap(), [u64::MAX, 8]);
    let mut store = SqliteStore::open(&path).unwrap();
    for start in 100..200 {
        store.begin(start).unwrap();
    }
    assert_eq!(store.begin(200).unwrap(), (137..=200).collect::<Vec<u64>>());
}

#[test]
fn what_is_no_store_gives_a_clear_error() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    std::fs::write(&path, vec![7_u8; 4096]).unwrap();
    assert!(matches!(SqliteStore::open(&path), Err(StoreError::Sqlite { .. })));
    let file = dir.path().join("file");
    std::fs::write(&file, "x").unwrap();
    assert!(matches!(SqliteStore::open(&file.join("jobs.sqlite")), Err(StoreError::Unwritable { .. })));
}

#[test]
fn a_newer_layout_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    drop(SqliteStore::open(&path).unwrap());
    let raw = rusqlite::Connection::open(&path).unwrap();
    raw.execute("update meta set value = '99' where name = 'schema_version'", []).unwrap();
    drop(raw);
    let Err(StoreError::Newer { found, .. }) = SqliteStore::open(&path) else { panic!() };
    assert!(found > SCHEMA_VERSION);
}

#[test]
fn a_store_of_layout_1_is_read_and_kept_from_programs_that_would_misread_it() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    let before = store.load().unwrap();
    drop(store);
    let raw = rusqlite::Connection::open(&path).unwrap();
    raw.execute("update meta set value = '1' where name = 'schema_version'", []).unwrap();
    // Layout 1 had the run of a job twice more in its body.
    let told = "update job set body = json_set(body, '$.spec.planner', 'x', '$.spec.run_seed', 9)";
    assert!(raw.execute(told, []).unwrap() > 0);
    drop(raw);
    assert_eq!(SqliteStore::open(&path).unwrap().load().unwrap().jobs, before.jobs);
    let raw = rusqlite::Connection::open(&path).unwrap();
    let layout: String =
        raw.query_row("select value from meta where name = 'schema_version'", [], |row| row.get(0)).unwrap();
    assert_eq!(layout, SCHEMA_VERSION.to_string());
}

#[test]
fn a_cut_log_loses_the_end_and_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    while !state.is_done() {
        store.save(&work(&mut state)).unwrap();
    }
    let log = std::fs::read(dir.path().join("jobs.sqlite-wal")).unwrap();
    assert!(!log.is_empty());
    let mut lengths: Vec<usize> = (0..24).map(|n| log.len() * n / 24).collect();
    lengths.push(log.len());
    let mut before = 0;
    for (n, len) in lengths.into_iter().enumerate() {
        let copy = dir.path().join(format!("copy{n}"));
        std::fs::create_dir(&copy).unwrap();
        std::fs::copy(&path, copy.join("jobs.sqlite")).unwrap();
        std::fs::write(copy.join("jobs.sqlite-wal"), &log[..len]).unwrap();
        let mut cut = SqliteStore::open(&copy.join("jobs.sqlite")).unwrap();
        assert_eq!(cut.fsck().unwrap(), Vec::<String>::new(), "cut at {len}");
        let results = cut.load().unwrap().results.len();
        assert!(results >= before, "a longer log holds no less");
        before = results;
    }
    assert_eq!(before, 11, "the whole log holds all");
}

#[test]
fn the_checker_sees_what_is_wrong() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    store.save(&work(&mut state)).unwrap();
    drop(store);
    let raw = rusqlite::Connection::open(&path).unwrap();
    raw.execute("delete from result", []).unwrap();
    drop(raw);
    assert!(!SqliteStore::open(&path).unwrap().fsck().unwrap().is_empty());
    assert!(MemoryStore::new().fsck().unwrap().is_empty());
}
