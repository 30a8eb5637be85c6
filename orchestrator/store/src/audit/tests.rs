//! The auditor sees what is damaged by hand, names it by the rule that it breaks, and says nothing of what is sound.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rusqlite::Connection;
use socrates_orchestrator::{Policy, State};

use super::{Audit, audit};
use crate::promises::{submit, submit_series, work};
use crate::{SCHEMA_VERSION, SqliteStore, Store as _, StoreError};

/// A store of two scenarios, of which the first is done and the second begun.
fn store(dir: &Path) -> (PathBuf, SqliteStore) {
    let path = dir.join("jobs.sqlite");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    while !state.is_done() {
        store.save(&work(&mut state)).unwrap();
    }
    store.save(&submit(&mut state, "b")).unwrap();
    store.save(&work(&mut state)).unwrap();
    (path, store)
}

fn is_sound(audit: &Audit) -> bool {
    audit.wrong().is_empty()
}

#[test]
fn a_sound_store_passes_after_every_step_while_it_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.sqlite");
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit(&mut state, "a")).unwrap();
    store.save(&submit(&mut state, "b")).unwrap();
    store.save(&submit_series(&mut state, "line-1", vec![7, 8, 9])).unwrap();
    store.load().unwrap();
    let mut asked = BTreeSet::new();
    while !state.is_done() {
        let told = audit(&path).unwrap();
        assert!(is_sound(&told), "{:#?}", told.wrong());
        asked.extend(told.checked.iter().filter(|one| one.looked_at > 0).map(|one| one.rule));
        assert_eq!(told.counts.attempts, told.counts.results, "each attempt of these succeeded");
        store.save(&work(&mut state)).unwrap();
    }
    let told = audit(&path).unwrap();
    assert!(is_sound(&told), "{:#?}", told.wrong());
    let counts = told.counts;
    assert_eq!((counts.scenarios, counts.ended, counts.jobs, counts.results, counts.reigns), (5, 5, 55, 55, 1));
    // Every rule was asked of something, so that none passes because it looks nowhere.
    asked.extend(told.checked.iter().filter(|one| one.looked_at > 0).map(|one| one.rule));
    assert_eq!(asked, told.checked.iter().map(|one| one.rule).collect());
    assert_eq!(
        told.scenarios.iter().map(|one| (one.scenario.as_str(), one.scored)).collect::<Vec<_>>(),
        [("a", true), ("b", true), ("line-1", true), ("line-2", true), ("line-3", true)]
    );
    // One output a result, and three inputs a scenario.
    assert_eq!(told.named.len(), 55 + 15);
}

#[test]
fn what_is_damaged_is_named_by_the_rule_that_it_breaks() {
    let double = "create table other as select * from result; drop table result; alter table other rename to result; \
                  insert into result select * from result where job = 'a/paths/r0'";
    let dir = tempfile::tempdir().unwrap();
    let whole = store(dir.path()).0;
    assert!(is_sound(&audit(&whole).unwrap()), "{:#?}", audit(&whole).unwrap().wrong());
    for (damage, rule, words) in [
        (double, "once", "job `a/paths/r0` has 2 results"),
        (
            "delete from result where job = 'a/paths/r0'",
            "result-or-dead",
            "job `a/paths/r0` succeeded and has no result",
        ),
        ("delete from result where job = 'a/paths/r0'", "inputs", "without the result of `a/paths/r0`"),
        (
            "insert into result select 'c/paths/r0', 1, null, body from result limit 1",
            "owner",
            "`c/paths/r0`, which is not there",
        ),
        ("delete from scenario where id = 'b'", "owner", "belongs to scenario `b`, which is not there"),
        ("update attempt set fence = 0 where job = 'b/proposal/r0'", "columns", "has fence 0 by its column"),
        (
            "update job set state = 'dead' where job = 'a/paths/r0'",
            "columns",
            "is dead by its column, succeeded by its body",
        ),
        ("update scenario set place = 7 where id = 'b'", "place", "place 6 of the scenarios is empty"),
        ("update scenario set result = null where id = 'a'", "scenario-end", "scenario `a` has not ended"),
        (
            "update scenario set result = 'realised' where id = 'b'",
            "scenario-end",
            "scenario `b` ended as `realised` with open jobs",
        ),
        (
            "update job set state = 'blocked' where scenario = 'b' and state = 'ready'",
            "scenario-moves",
            "scenario `b` is open, and nothing moves it",
        ),
        (
            "update result set verdict = 'contradicted'",
            "scenario-verdict",
            "scenario `a` ended as `realised`, and no scoring job says so",
        ),
        (
            "insert into dead values('a/paths/r0', 'why')",
            "result-or-dead",
            "job `a/paths/r0` is succeeded and has a dead letter",
        ),
        (
            "update attempt set outcome = 'failed' where job = 'a/paths/r0'",
            "result-attempt",
            "is of attempt 1, which ended as `failed`",
        ),
        ("delete from attempt where job = 'a/paths/r0'", "result-attempt", "is of attempt 1, which is not there"),
        (
            "update attempt set number = 2 where job = 'a/paths/r0'",
            "attempt-number",
            "attempt 1 of `a/paths/r0` lacks before attempt 2",
        ),
        (
            "update attempt set outcome = null where job = 'a/paths/r0'",
            "attempt-open",
            "is succeeded and has 1 open attempts",
        ),
        ("update attempt set fence = 1", "fence", "fence 1 was given to 12 attempts"),
        (
            "insert into attempt select job, 2, instance, 0, 'lapsed', body from attempt where job = 'a/paths/r0'",
            "fence",
            "attempt 2 of `a/paths/r0` has fence 0, not above",
        ),
        ("delete from event where seq between 5 and 7", "outbox", "no entries from 5 to 7"),
        ("delete from event where seq = (select max(seq) from event)", "outbox-newest", "job `b/"),
        (
            "update attempt set body = json_set(body, '$[1].reported', json('false'))",
            "report",
            "succeeded without a report",
        ),
        ("update text set content = 'x'", "text", "has the digest"),
        ("update job set body = 'x' where job = 'a/paths/r0'", "readable", "the row of job `a/paths/r0` is no JSON"),
    ] {
        let path = dir.path().join("damaged.sqlite");
        std::fs::copy(&whole, &path).unwrap();
        Connection::open(&path).unwrap().execute_batch(damage).unwrap();
        let told = audit(&path).unwrap();
        let wrong = &told.checked.iter().find(|one| one.rule == rule).unwrap().wrong;
        assert!(wrong.iter().any(|wrong| wrong.contains(words)), "{damage}: {:#?}", told.wrong());
    }
}

#[test]
fn a_series_of_which_the_wrong_scenarios_are_made_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let whole = dir.path().join("jobs.sqlite");
    let mut store = SqliteStore::open(&whole).unwrap();
    let mut state = State::new(Policy::default());
    store.save(&submit_series(&mut state, "line-1", (7..107).collect())).unwrap();
    store.save(&submit(&mut state, "after")).unwrap();
    let told = audit(&whole).unwrap();
    // The places of scenarios that are not made yet are no gap.
    assert!(is_sound(&told) && told.counts.scenarios == 17, "{:#?}", told.wrong());
    drop(store);
    for (damage, words) in [
        ("update scenario set place = 40 where id = 'line-7'", "scenario `line-7` is made, and the one before it"),
        ("update series set left_out = 90", "scenario `line-11` is made, and its series leaves it out"),
        ("update scenario set batch = 'x' where id = 'line-2'", "is of batch `x`, its series of `line`"),
        (
            "insert into series select 50, batch, 9, 0, body from series",
            "from place 50 on begins in the one from place 0 on",
        ),
    ] {
        let path = dir.path().join("damaged.sqlite");
        std::fs::copy(&whole, &path).unwrap();
        Connection::open(&path).unwrap().execute_batch(damage).unwrap();
        let wrong = audit(&path).unwrap().checked.into_iter().find(|one| one.rule == "series").unwrap().wrong;
        assert!(wrong.iter().any(|wrong| wrong.contains(words)), "{damage}: {wrong:#?}");
    }
}

#[test]
fn a_store_of_before_series_is_audited_and_read_as_it_is() {
    let dir = tempfile::tempdir().unwrap();
    let (path, open) = store(dir.path());
    drop(open);
    let old = "drop table series; drop table batch; update meta set value = '2' where name = 'schema_version'";
    Connection::open(&path).unwrap().execute_batch(old).unwrap();
    let told = audit(&path).unwrap();
    assert!(is_sound(&told) && told.counts.scenarios == 2, "{:#?}", told.wrong());
    let read = crate::Reader::open(&path).unwrap().all().unwrap();
    assert_eq!((read.scenarios.len(), read.queues.len(), read.batches.len()), (2, 0, 0));
    // The next orchestrator writes on in it.
    let mut store = SqliteStore::open(&path).unwrap();
    let mut state = State::restore(store.load().unwrap(), Policy::default(), 0);
    store.save(&submit_series(&mut state, "line-1", vec![7, 8])).unwrap();
    assert_eq!(crate::Reader::open(&path).unwrap().all().unwrap().queues.len(), 1);
}

#[test]
fn a_store_of_a_killed_orchestrator_is_read_as_it_was_committed() {
    let dir = tempfile::tempdir().unwrap();
    let (_path, open) = store(dir.path());
    let copy = dir.path().join("copy");
    std::fs::create_dir(&copy).unwrap();
    // What kill -9 leaves: the file and the log, nobody who holds them.
    let mut files = 0;
    for name in ["jobs.sqlite", "jobs.sqlite-wal"] {
        files += usize::from(std::fs::copy(dir.path().join(name), copy.join(name)).is_ok());
    }
    drop(open);
    assert_eq!(files, 2);
    let told = audit(&copy.join("jobs.sqlite")).unwrap();
    assert!(is_sound(&told) && told.counts.scenarios == 2, "{:#?}", told.wrong());
}

#[test]
fn what_is_no_store_of_ours_is_refused_with_its_reason() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    assert!(matches!(audit(&at("none")), Err(StoreError::Unwritable { .. })));
    assert!(!at("none").exists(), "a look makes no store");
    std::fs::write(at("text"), vec![7_u8; 4096]).unwrap();
    assert!(matches!(audit(&at("text")), Err(StoreError::Sqlite { .. })));
    Connection::open(at("other")).unwrap().execute_batch("create table song(name text)").unwrap();
    assert!(matches!(audit(&at("other")), Err(StoreError::Stranger { .. })));
    let path = store(dir.path()).0;
    let told = format!("update meta set value = '{}' where name = 'schema_version'", SCHEMA_VERSION + 1);
    Connection::open(&path).unwrap().execute_batch(&told).unwrap();
    assert!(matches!(audit(&path), Err(StoreError::Newer { found, .. }) if found == SCHEMA_VERSION + 1));
    // Just being made: nothing is in it, and nothing is wrong.
    Connection::open(at("young")).unwrap().execute_batch("pragma journal_mode = wal").unwrap();
    assert_eq!(audit(&at("young")).unwrap(), Audit::default());
}
