//! The auditor: whether the tables of a store agree with each other, asked of the file alone.
//!
//! ```text
//! file, only read ─► one moment ─► a question a rule ─► what was looked at, what is wrong
//! ```
//!
//! It shares nothing with the state machine and its checker, so that a fault of theirs is not its own: no row is decoded into their types, and
//! what must hold is asked of the database in [`rules`]. It reads one moment of the store, also while an orchestrator writes and after it was
//! killed.

mod rules;

#[cfg(test)]
mod tests;

use std::path::Path;

use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Row};
use serde::Serialize;
use socrates_model::{Digest, ScenarioEnd};

use crate::sqlite::failure;
use crate::{SCHEMA_VERSION, StoreError, schema};
use rules::{READABLE, RULES, Rule};

/// What a rule found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Checked {
    /// Name of the rule.
    pub rule: &'static str,
    /// What must hold.
    pub about: &'static str,
    /// How many things it was asked of.
    pub looked_at: u64,
    /// What breaks it, a sentence each.
    pub wrong: Vec<String>,
}

/// An artifact that a row names, to be looked for where artifacts are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// What names it, in words.
    pub by: String,
    /// Its content address as it is written there.
    pub digest: String,
    /// Its length, bytes, where the row says.
    pub len: Option<u64>,
    /// Whether the store has it as a text too, from which the next orchestrator puts it back among the artifacts.
    pub kept: bool,
}

/// How a scenario of the store stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stands {
    /// Which.
    pub scenario: String,
    /// How it ended; none while it is open, or where its row says what is no end.
    pub end: Option<ScenarioEnd>,
    /// Whether one of its scoring jobs has a result.
    pub scored: bool,
}

/// What the store holds, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Scenarios.
    pub scenarios: u64,
    /// Scenarios that ended.
    pub ended: u64,
    /// Scenarios that ended as failed.
    pub failed: u64,
    /// Jobs.
    pub jobs: u64,
    /// Attempts.
    pub attempts: u64,
    /// Attempts whose worker was lost.
    pub lapsed: u64,
    /// Results.
    pub results: u64,
    /// Results taken over from a job with the same key.
    pub taken_over: u64,
    /// Dead letters.
    pub dead: u64,
    /// Entries of the outbox.
    pub outbox: u64,
    /// Tokens of all attempts, in and out.
    pub tokens: u64,
    /// Reigns of orchestrators so far.
    pub reigns: u64,
}

/// What an audit of a store found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Audit {
    /// What the store holds.
    pub counts: Counts,
    /// Every rule with what it found.
    pub checked: Vec<Checked>,
    /// Artifacts that results and failed attempts left, and those that scenarios are made from.
    pub named: Vec<Named>,
    /// Scenarios in order of submission.
    pub scenarios: Vec<Stands>,
}

/// Tables that stand beside the store for the time of a look.
const BESIDE: &str = "
create temp table source as
  select job.job as job, one.key as role,
    json_extract(one.value, '$.scenario') || '/' || json_extract(one.value, '$.stage') ||
    case coalesce(json_extract(one.value, '$.item'), '') when '' then '' else '/' || json_extract(one.value, '$.item') end ||
    '/r' || json_extract(one.value, '$.revision') as parent
  from job, json_each(job.body, '$.sources') as one;
create index temp.source_job on source(job);
create temp table said as
  select json_extract(body, '$.key.scenario') || '/' || json_extract(body, '$.key.stage') ||
    case coalesce(json_extract(body, '$.key.item'), '') when '' then '' else '/' || json_extract(body, '$.key.item') end ||
    '/r' || json_extract(body, '$.key.revision') as job,
    max(seq) as seq, json_extract(body, '$.state') as state
  from event group by 1;
create index temp.said_job on said(job);
create temp table brief as select job, scenario, stage, state from job;
create index temp.brief_job on brief(job);
create index temp.brief_scenario on brief(scenario);
";

/// The question for artifacts: what names it, content address, length, whether the store keeps it as a text.
const NAMED: &str = "
select by, digest, len, exists (select 1 from text where text.digest = named.digest) from (
select 'the result of `' || result.job || '`' as by, json_extract(one.value, '$.digest') as digest, json_extract(one.value, '$.len') as len
  from result, json_each(result.body, '$[1].artifacts') as one
union all select 'attempt ' || number || ' of `' || job || '`', json_extract(one.value, '$.digest'), json_extract(one.value, '$.len')
  from attempt, json_each(attempt.body, '$[1].artifacts') as one
union all select 'scenario `' || scenario.id || '`', json_extract(body, path.value), null
  from scenario, json_each('[\"$.spec.request\", \"$.spec.location\", \"$.spec.reading\", \"$.spec.order\"]') as path
  where json_extract(body, path.value) is not null
union all select 'scenario `' || scenario.id || '`', one.value, null from scenario, json_each(scenario.body, '$.spec.pinned') as one
) as named";

/// The question for the counts, in the order of [`Counts`].
const COUNTS: &str = "
select (select count(*) from scenario), (select count(*) from scenario where result is not null),
  (select count(*) from scenario where result = 'failed'), (select count(*) from job), (select count(*) from attempt),
  (select count(*) from attempt where outcome = 'lapsed'), (select count(*) from result),
  (select count(*) from result where attempt = 0), (select count(*) from dead), (select count(*) from event),
  (select coalesce(sum(json_extract(body, '$[1].tokens[0]') + json_extract(body, '$[1].tokens[1]')), 0) from attempt),
  (select coalesce(max(cast(value as integer)), 0) from meta where name = 'epoch')";

/// Whether there are tables, and none of them is the one that every store has first.
const STRANGE: &str = "
select exists (select 1 from sqlite_schema where type = 'table')
  and not exists (select 1 from sqlite_schema where type = 'table' and name = 'meta')";

/// How every scenario stands.
const STANDS: &str = "
select id, result, exists (select 1 from brief join result as made on made.job = brief.job
  where brief.scenario = id and brief.stage = 'scoring') from scenario order by place";

/// Audits the store at `path`. Nothing is written, begun or locked.
///
/// # Errors
/// [`StoreError::Unwritable`] where there is no such file or it cannot be opened, [`StoreError::Newer`] when a newer program wrote it,
/// [`StoreError::Stranger`] when it is a database of another kind, [`StoreError::Sqlite`] when it is none or cannot be read.
pub fn audit(path: &Path) -> Result<Audit, StoreError> {
    let failed = |source| failure(path, source);
    let connection = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(failed)?;
    connection.execute_batch("pragma busy_timeout = 2000; pragma temp_store = memory;").map_err(failed)?;
    // All questions are about one moment; an orchestrator writes on meanwhile. Dropped without a commit: there is nothing to keep.
    let moment = connection.unchecked_transaction().map_err(failed)?;
    if !is_made(&moment, path)? {
        return Ok(Audit::default());
    }
    if !moment.query_row(schema::HAS_3, [], |row| row.get::<_, bool>(0)).map_err(failed)? {
        moment.execute_batch(schema::SINCE_3).map_err(failed)?;
    }
    let mut checked = vec![whole(&moment).map_err(failed)?];
    for rule in &READABLE {
        checked.push(ask(&moment, rule).map_err(failed)?);
    }
    if checked.iter().any(|checked| !checked.wrong.is_empty()) {
        // What cannot be read cannot be asked either.
        return Ok(Audit { checked, ..Audit::default() });
    }
    moment.execute_batch(BESIDE).map_err(failed)?;
    for rule in &RULES {
        checked.push(ask(&moment, rule).map_err(failed)?);
    }
    checked.push(texts(&moment).map_err(failed)?);
    Ok(Audit {
        counts: counts(&moment).map_err(failed)?,
        named: named(&moment).map_err(failed)?,
        scenarios: stands(&moment).map_err(failed)?,
        checked,
    })
}

/// Whether the tables are there; a file without them may be a store that is just being made.
fn is_made(moment: &Connection, path: &Path) -> Result<bool, StoreError> {
    let failed = |source| failure(path, source);
    let has = |sql: &str| moment.query_row(sql, [], |row| row.get::<_, bool>(0)).map_err(failed);
    let stranger = || StoreError::Stranger { path: path.to_owned() };
    if has(STRANGE)? {
        return Err(stranger());
    }
    if !has("select exists(select 1 from sqlite_schema where name = 'meta')")? {
        return Ok(false);
    }
    let sql = "select value from meta where name = 'schema_version'";
    let layout: Option<String> = moment.query_row(sql, [], |row| row.get(0)).optional().map_err(failed)?;
    let Some(layout) = layout else { return Ok(false) };
    let found = layout.parse::<u32>().map_err(|_no_number| stranger())?;
    if found > SCHEMA_VERSION { Err(StoreError::Newer { path: path.to_owned(), found }) } else { Ok(true) }
}

/// Whether the file itself is whole.
fn whole(moment: &Connection) -> rusqlite::Result<Checked> {
    let mut statement = moment.prepare("pragma integrity_check")?;
    let told = statement.query_map([], |row| row.get::<_, String>(0))?.collect::<rusqlite::Result<Vec<_>>>()?;
    let looked_at = moment.query_row("select page_count from pragma_page_count()", [], |row| number(row, 0))?;
    let wrong =
        told.into_iter().filter(|line| line != "ok").map(|line| format!("the file of the store: {line}")).collect();
    Ok(Checked { rule: "file", about: "the pages of the file are whole", looked_at, wrong })
}

/// A count; what is below 0 is none.
fn number(row: &Row<'_>, index: usize) -> rusqlite::Result<u64> {
    Ok(u64::try_from(row.get::<_, i64>(index)?).unwrap_or(0))
}

fn ask(moment: &Connection, rule: &Rule) -> rusqlite::Result<Checked> {
    let looked_at = moment.query_row(rule.looked_at, [], |row| number(row, 0))?;
    let mut statement = moment.prepare(rule.wrong)?;
    let wrong = statement.query_map([], |row| row.get(0))?.collect::<rusqlite::Result<_>>()?;
    Ok(Checked { rule: rule.name, about: rule.about, looked_at, wrong })
}

/// Whether small texts are what their addresses say.
fn texts(moment: &Connection) -> rusqlite::Result<Checked> {
    let mut statement = moment.prepare("select digest, content from text order by digest")?;
    let mut rows = statement.query([])?;
    let (mut looked_at, mut wrong) = (0, Vec::new());
    while let Some(row) = rows.next()? {
        let (digest, content): (String, String) = (row.get(0)?, row.get(1)?);
        looked_at += 1;
        let found = Digest::of(content.as_bytes()).to_string();
        if found != digest {
            wrong.push(format!("the text under `{digest}` has the digest `{found}`"));
        }
    }
    Ok(Checked {
        rule: "text",
        about: "the texts that came with reports are what their addresses say",
        looked_at,
        wrong,
    })
}

fn counts(moment: &Connection) -> rusqlite::Result<Counts> {
    moment.query_row(COUNTS, [], |row| {
        Ok(Counts {
            scenarios: number(row, 0)?,
            ended: number(row, 1)?,
            failed: number(row, 2)?,
            jobs: number(row, 3)?,
            attempts: number(row, 4)?,
            lapsed: number(row, 5)?,
            results: number(row, 6)?,
            taken_over: number(row, 7)?,
            dead: number(row, 8)?,
            outbox: number(row, 9)?,
            tokens: number(row, 10)?,
            reigns: number(row, 11)?,
        })
    })
}

fn named(moment: &Connection) -> rusqlite::Result<Vec<Named>> {
    let mut statement = moment.prepare(NAMED)?;
    let rows = statement.query_map([], |row| {
        let len = row.get::<_, Option<i64>>(2)?.map(|len| u64::try_from(len).unwrap_or(0));
        Ok(Named { by: row.get(0)?, digest: row.get(1)?, len, kept: row.get(3)? })
    })?;
    rows.collect()
}

fn stands(moment: &Connection) -> rusqlite::Result<Vec<Stands>> {
    let mut statement = moment.prepare(STANDS)?;
    let rows = statement.query_map([], |row| {
        let end = row.get::<_, Option<String>>(1)?.and_then(|end| end.parse().ok());
        Ok(Stands { scenario: row.get(0)?, end, scored: row.get(2)? })
    })?;
    rows.collect()
}

impl Audit {
    /// Everything that is wrong, each with the name of its rule before it.
    #[must_use]
    pub fn wrong(&self) -> Vec<String> {
        let told = |checked: &Checked| -> Vec<String> {
            checked.wrong.iter().map(|wrong| format!("{}: {wrong}", checked.rule)).collect()
        };
        self.checked.iter().flat_map(told).collect()
    }
}
