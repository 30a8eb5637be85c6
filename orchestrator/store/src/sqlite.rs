//! The store in one `SQLite` file: write-ahead log, synced at every commit, one writer.

use std::fs::{File, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, ErrorCode, OptionalExtension as _, params};
use serde::Serialize;
use serde::de::DeserializeOwned;
use socrates_model::Digest;
use socrates_orchestrator::{Row, Snapshot};

use crate::reader::bodies;
use crate::{OUTBOX, SCHEMA_VERSION, Store, StoreError, check, schema};

/// Names under which the paused batches and the paused stages stand.
pub(crate) const PAUSED: &str = "paused";
pub(crate) const PAUSED_STAGES: &str = "paused_stages";
/// Name under which the numbers of the starts stand, in hexadecimal digits, oldest first.
const STARTED: &str = "starts";
/// Starts that are remembered.
const STARTS: usize = 64;

/// The job store of one orchestrator. Do not put it on a network file system: its locks and its log
/// need a local disk.
#[derive(Debug)]
pub struct SqliteStore {
    path: PathBuf,
    connection: Connection,
    /// Held as long as the store is open; the kernel lets go of it when the process dies.
    _lock: File,
}

/// What a commit outlives. Either way it is whole or not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Durability {
    /// The machine: the log is on the disk before a commit returns. For orchestrators whose workers run elsewhere.
    #[default]
    Disk,
    /// The process, by whatever signal. A power cut may take the last commits, and with them everybody who knew of
    /// them: right where all workers share the machine, and a commit costs no wait for the disk.
    Process,
}

impl Durability {
    const fn pragma(self) -> &'static str {
        match self {
            Self::Disk => "pragma synchronous = full;",
            Self::Process => "pragma synchronous = normal;",
        }
    }
}

impl SqliteStore {
    /// Opens or makes the store at `path`, for this process alone; every commit outlives the machine.
    ///
    /// # Errors
    /// As [`Self::open_with`].
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_with(path, Durability::Disk)
    }

    /// Opens or makes the store at `path`, for this process alone.
    ///
    /// # Errors
    /// [`StoreError::Locked`] when another process has it, [`StoreError::Unwritable`],
    /// [`StoreError::Newer`], [`StoreError::Sqlite`] when the file is no store.
    pub fn open_with(path: &Path, durability: Durability) -> Result<Self, StoreError> {
        let unwritable = |source| StoreError::Unwritable { path: path.to_owned(), source };
        if let Some(dir) = path.parent() {
            std::fs::create_dir_all(dir).map_err(unwritable)?;
        }
        let beside = path.with_extension("lock");
        let mut lock = File::options().create(true).truncate(false).write(true).open(&beside).map_err(unwritable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let pid = std::fs::read_to_string(&beside).unwrap_or_default();
                return Err(StoreError::Locked { path: path.to_owned(), holder: format!("process {}", pid.trim()) });
            }
            Err(TryLockError::Error(source)) => return Err(unwritable(source)),
        }
        let told = lock.set_len(0).and_then(|()| writeln!(lock, "{}", std::process::id()));
        told.map_err(unwritable)?;
        let failed = |source| failure(path, source);
        let connection = Connection::open(path).map_err(failed)?;
        connection.execute_batch(schema::PRAGMAS).map_err(failed)?;
        connection.execute_batch(durability.pragma()).map_err(failed)?;
        let mut store = Self { path: path.to_owned(), connection, _lock: lock };
        store.prepare()?;
        Ok(store)
    }

    fn prepare(&mut self) -> Result<(), StoreError> {
        let known: bool = self
            .connection
            .query_row("select exists(select 1 from sqlite_schema where name = 'meta')", [], |row| row.get(0))
            .map_err(|source| self.failure(source))?;
        if known {
            let found = self.number("schema_version")?.unwrap_or(0);
            if found > u64::from(SCHEMA_VERSION) {
                let found = u32::try_from(found).unwrap_or(u32::MAX);
                return Err(StoreError::Newer { path: self.path.clone(), found });
            }
        }
        self.connection.execute_batch(schema::TABLES).map_err(|source| self.failure(source))?;
        self.set("schema_version", &SCHEMA_VERSION.to_string())
    }

    fn failure(&self, source: rusqlite::Error) -> StoreError {
        failure(&self.path, source)
    }

    /// Writes down a start of an orchestrator by a number that no other has; gives the last 64 starts of this store, this one among
    /// them. A worker that served one of them knows the jobs of this store, in this state or an earlier one.
    ///
    /// # Errors
    /// [`StoreError::Sqlite`].
    pub fn begin(&mut self, id: u64) -> Result<Vec<u64>, StoreError> {
        let written = self.meta(STARTED)?.unwrap_or_default();
        let mut starts: Vec<u64> =
            written.split_whitespace().filter_map(|start| u64::from_str_radix(start, 16).ok()).collect();
        starts.push(id);
        starts.drain(..starts.len().saturating_sub(STARTS));
        let text: Vec<String> = starts.iter().map(|start| format!("{start:016x}")).collect();
        self.set(STARTED, &text.join(" "))?;
        Ok(starts)
    }

    fn meta(&self, name: &str) -> Result<Option<String>, StoreError> {
        meta(&self.connection, &self.path, name)
    }

    fn number(&self, name: &str) -> Result<Option<u64>, StoreError> {
        Ok(self.meta(name)?.and_then(|text| text.parse().ok()))
    }

    fn set(&self, name: &str, value: &str) -> Result<(), StoreError> {
        self.connection
            .execute("insert or replace into meta values(?1, ?2)", [name, value])
            .map(drop)
            .map_err(|source| self.failure(source))
    }

    fn bodies<T: DeserializeOwned>(&self, table: &'static str, order: &str) -> Result<Vec<T>, StoreError> {
        bodies(&self.connection, &self.path, table, &format!("order by {order}"), &[])
    }

    fn read(&self) -> Result<Snapshot, StoreError> {
        let last: i64 = self
            .connection
            .query_row("select coalesce(max(seq), 0) from event", [], |row| row.get(0))
            .map_err(|source| self.failure(source))?;
        Ok(Snapshot {
            epoch: self.number("epoch")?.unwrap_or(0),
            scenarios: self.bodies("scenario", "place")?,
            jobs: self.bodies("job", "job")?,
            attempts: self.bodies("attempt", "job, number")?,
            results: self.bodies("result", "job")?,
            batches: self.bodies("batch", "name")?,
            queues: self.bodies("series", "place")?,
            paused: listed(&self.connection, &self.path, PAUSED)?,
            paused_stages: listed(&self.connection, &self.path, PAUSED_STAGES)?,
            next_seq: u64::try_from(last).unwrap_or(0) + 1,
        })
    }
}

impl Store for SqliteStore {
    fn save(&mut self, rows: &[Row]) -> Result<(), StoreError> {
        if rows.is_empty() {
            return Ok(());
        }
        let path = self.path.clone();
        let failed = |source| failure(&path, source);
        // Dropped without a commit, it rolls back.
        let transaction = self.connection.transaction().map_err(failed)?;
        for row in rows {
            write(&transaction, row, &failed)?;
        }
        transaction.commit().map_err(failed)
    }

    fn load(&mut self) -> Result<Snapshot, StoreError> {
        let epoch = self.number("epoch")?.unwrap_or(0) + 1;
        self.set("epoch", &epoch.to_string())?;
        let snapshot = self.read()?;
        let oldest = i64::try_from(snapshot.next_seq.saturating_sub(OUTBOX)).unwrap_or(0);
        self.connection.execute("delete from event where seq < ?1", [oldest]).map_err(|source| self.failure(source))?;
        Ok(snapshot)
    }

    fn text(&self, digest: &Digest) -> Result<Option<String>, StoreError> {
        self.connection
            .query_row("select content from text where digest = ?1", [digest.to_string()], |row| row.get(0))
            .optional()
            .map_err(|source| self.failure(source))
    }

    fn texts(&self) -> Result<Vec<Digest>, StoreError> {
        let failed = |source| self.failure(source);
        let mut statement = self.connection.prepare("select digest from text order by digest").map_err(failed)?;
        let rows = statement.query_map([], |row| row.get::<_, String>(0)).map_err(failed)?;
        let mut all = Vec::new();
        for row in rows {
            // An address that is none was not written by us; the checker speaks of it.
            all.extend(row.map_err(failed)?.parse::<Digest>().ok());
        }
        Ok(all)
    }

    fn fsck(&self) -> Result<Vec<String>, StoreError> {
        let failed = |source| self.failure(source);
        let verdict: String =
            self.connection.query_row("pragma integrity_check", [], |row| row.get(0)).map_err(failed)?;
        let mut wrong = if verdict == "ok" { Vec::new() } else { vec![format!("file: {verdict}")] };
        wrong.extend(check(&self.read()?));
        for digest in self.texts()? {
            if self.text(&digest)?.is_some_and(|text| Digest::of(text.as_bytes()) != digest) {
                wrong.push(format!("the text under `{digest}` is another one"));
            }
        }
        Ok(wrong)
    }
}

fn meta(connection: &Connection, path: &Path, name: &str) -> Result<Option<String>, StoreError> {
    let asked = connection.query_row("select value from meta where name = ?1", [name], |row| row.get(0)).optional();
    asked.map_err(|source| failure(path, source))
}

/// A list that stands under a name; empty where there is none.
pub(crate) fn listed<T: DeserializeOwned>(
    connection: &Connection,
    path: &Path,
    name: &str,
) -> Result<Vec<T>, StoreError> {
    let Some(text) = meta(connection, path, name)? else { return Ok(Vec::new()) };
    serde_json::from_str(&text).map_err(|source| StoreError::Row { table: "meta", source })
}

type Failed<'a> = dyn Fn(rusqlite::Error) -> StoreError + 'a;

fn write(to: &Connection, row: &Row, failed: &Failed<'_>) -> Result<(), StoreError> {
    let run = |sql: &str, values: &[&dyn rusqlite::ToSql]| {
        to.prepare_cached(sql).and_then(|mut statement| statement.execute(values)).map(drop).map_err(failed)
    };
    match row {
        Row::Scenario(scenario) => {
            let (id, place) = (scenario.spec.id.as_str(), i64::try_from(scenario.order).unwrap_or(i64::MAX));
            let result = scenario.end.map(socrates_orchestrator::ScenarioEnd::name);
            let body = body("scenario", scenario)?;
            let sql = "insert or replace into scenario values(?1, ?2, ?3, ?4, ?5)";
            run(sql, params![id, scenario.batch, place, result, body])
        }
        Row::Job(job) => {
            let key = &job.key;
            let body = body("job", job)?;
            let sql = "insert or replace into job values(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)";
            run(
                sql,
                params![
                    key.to_string(),
                    key.scenario.as_str(),
                    key.stage.name(),
                    key.item.to_string(),
                    key.revision,
                    job.state.name(),
                    job.idem_key.map(|idem_key| idem_key.to_string()),
                    body
                ],
            )
        }
        Row::Attempt(key, attempt) => {
            let fence = i64::try_from(attempt.fence).unwrap_or(i64::MAX);
            let outcome = attempt.end.map(|end| format!("{end:?}").to_lowercase());
            let body = body("attempt", &(key, attempt))?;
            let sql = "insert or replace into attempt values(?1, ?2, ?3, ?4, ?5, ?6)";
            run(sql, params![key.to_string(), attempt.number, attempt.instance, fence, outcome, body])
        }
        Row::Result(key, result) => {
            let verdict = result.verdict.map(socrates_model::Verdict::name);
            let body = body("result", &(key, result))?;
            let inserted = to
                .prepare_cached("insert or ignore into result values(?1, ?2, ?3, ?4)")
                .and_then(|mut insert| insert.execute(params![key.to_string(), result.attempt, verdict, body]))
                .map_err(failed)?;
            if inserted == 1 { Ok(()) } else { Err(StoreError::SecondResult { job: key.to_string() }) }
        }
        Row::Text(digest, content) => {
            run("insert or ignore into text values(?1, ?2)", params![digest.to_string(), content])
        }
        Row::Event(batch, notice) => {
            let seq = i64::try_from(notice.seq).unwrap_or(i64::MAX);
            let body = body("event", notice)?;
            run("insert or replace into event values(?1, ?2, ?3)", params![seq, batch, body])
        }
        Row::Dead(key, reason) => run("insert or replace into dead values(?1, ?2)", params![key.to_string(), reason]),
        Row::Revived(key) => run("delete from dead where job = ?1", params![key.to_string()]),
        Row::Batch(batch) => {
            run("insert or replace into batch values(?1, ?2)", params![batch.name, body("batch", batch)?])
        }
        Row::Queue(queue) => {
            let (place, body) = (i64::try_from(queue.place).unwrap_or(i64::MAX), body("series", queue)?);
            let sql = "insert or replace into series values(?1, ?2, ?3, ?4, ?5)";
            run(sql, params![place, queue.batch, queue.series.count(), queue.left_out, body])
        }
        Row::Paused(paused) => {
            run("insert or replace into meta values(?1, ?2)", params![PAUSED, body("meta", paused)?])
        }
        Row::PausedStages(stages) => {
            run("insert or replace into meta values(?1, ?2)", params![PAUSED_STAGES, body("meta", stages)?])
        }
    }
}

fn body(table: &'static str, of: &impl Serialize) -> Result<String, StoreError> {
    serde_json::to_string(of).map_err(|source| StoreError::Row { table, source })
}

pub(crate) fn failure(path: &Path, source: rusqlite::Error) -> StoreError {
    let path = path.to_owned();
    match source.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => StoreError::Full { path },
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
            StoreError::Locked { path, holder: "another process".to_owned() }
        }
        Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => {
            StoreError::Unwritable { path, source: std::io::Error::other(source) }
        }
        Some(_) | None => StoreError::Sqlite { path, source },
    }
}
