//! A look into a store that belongs to somebody else. Nothing is written, begun or locked, so that it can be read while an
//! orchestrator works, and after it was killed.

use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, params};
use serde::de::DeserializeOwned;
use socrates_model::{ScenarioEnd, ScenarioId};
use socrates_orchestrator::Snapshot;

use crate::sqlite::{PAUSED, PAUSED_STAGES, failure, listed};
use crate::{StoreError, schema};

/// How one scenario stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing {
    /// Its place in the order of submission, from 0.
    pub place: u64,
    /// Its id.
    pub scenario: ScenarioId,
    /// The batch that it was submitted with.
    pub batch: String,
    /// How it ended; none while it is not done.
    pub result: Option<ScenarioEnd>,
}

/// Reads a store that another process writes.
#[derive(Debug)]
pub struct Reader {
    path: PathBuf,
    /// None while the tables are being made, when nothing stands in them.
    connection: Option<Connection>,
}

impl Reader {
    /// Opens the store at `path`.
    ///
    /// # Errors
    /// [`StoreError::Unwritable`] where there is no such file, [`StoreError::Sqlite`] when it is no store.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Ok(Self { path: path.to_owned(), connection: only_read(path)? })
    }

    /// How at most `limit` scenarios stand, from a place in the order of submission on.
    ///
    /// # Errors
    /// [`StoreError::Sqlite`].
    pub fn standings(&self, from: u64, limit: u64) -> Result<Vec<Standing>, StoreError> {
        let Some(connection) = &self.connection else { return Ok(Vec::new()) };
        let failed = |source| failure(&self.path, source);
        let number = |count: u64| i64::try_from(count).unwrap_or(i64::MAX);
        let sql = "select place, id, batch, result from scenario where place >= ?1 order by place limit ?2";
        let mut statement = connection.prepare_cached(sql).map_err(failed)?;
        let rows = statement
            .query_map(params![number(from), number(limit)], |row| {
                Ok((row.get::<_, i64>(0)?, row.get(1)?, row.get(2)?, row.get::<_, Option<String>>(3)?))
            })
            .map_err(failed)?;
        let mut standings = Vec::new();
        for row in rows {
            let (place, id, batch, result): (i64, String, String, Option<String>) = row.map_err(failed)?;
            let Ok(scenario) = ScenarioId::new(id) else { continue };
            let result = serde_json::from_value(result.into())
                .map_err(|source| StoreError::Row { table: "scenario", source })?;
            standings.push(Standing { place: u64::try_from(place).unwrap_or(0), scenario, batch, result });
        }
        Ok(standings)
    }

    /// Every row that tells what was tried: scenarios in order of submission, jobs, attempts and results, and what is paused. No reign
    /// begins.
    ///
    /// # Errors
    /// [`StoreError::Sqlite`] and [`StoreError::Row`].
    pub fn all(&self) -> Result<Snapshot, StoreError> {
        let Some(connection) = &self.connection else { return Ok(Snapshot::default()) };
        Ok(Snapshot {
            scenarios: bodies(connection, &self.path, "scenario", "order by place", &[])?,
            jobs: bodies(connection, &self.path, "job", "order by job", &[])?,
            attempts: bodies(connection, &self.path, "attempt", "order by job, number", &[])?,
            results: bodies(connection, &self.path, "result", "order by job", &[])?,
            batches: bodies(connection, &self.path, "batch", "order by name", &[])?,
            queues: bodies(connection, &self.path, "series", "order by place", &[])?,
            paused: listed(connection, &self.path, PAUSED)?,
            paused_stages: listed(connection, &self.path, PAUSED_STAGES)?,
            ..Snapshot::default()
        })
    }

    /// The rows of one scenario and what is paused, as of one moment; without a scenario where it is unknown.
    ///
    /// # Errors
    /// [`StoreError::Sqlite`] and [`StoreError::Row`].
    pub fn scenario(&self, id: &ScenarioId) -> Result<Snapshot, StoreError> {
        let Some(connection) = &self.connection else { return Ok(Snapshot::default()) };
        let failed = |source| failure(&self.path, source);
        // One moment for all four tables: a revision may begin between two of them.
        let moment = connection.unchecked_transaction().map_err(failed)?;
        // Jobs are called `SCENARIO/stage…`, so those of one scenario stand together; `0` follows `/`.
        let (first, beyond) = (format!("{id}/"), format!("{id}0"));
        let keys: [&dyn rusqlite::ToSql; 2] = [&first, &beyond];
        let own = "where job >= ?1 and job < ?2 order by job";
        let numbered = format!("{own}, number");
        let snapshot = Snapshot {
            scenarios: bodies(&moment, &self.path, "scenario", "where id = ?1", &[&id.as_str()])?,
            jobs: bodies(&moment, &self.path, "job", own, &keys)?,
            attempts: bodies(&moment, &self.path, "attempt", &numbered, &keys)?,
            results: bodies(&moment, &self.path, "result", own, &keys)?,
            paused: listed(&moment, &self.path, PAUSED)?,
            paused_stages: listed(&moment, &self.path, PAUSED_STAGES)?,
            ..Snapshot::default()
        };
        moment.commit().map_err(failed)?;
        Ok(snapshot)
    }
}

fn only_read(path: &Path) -> Result<Option<Connection>, StoreError> {
    let failed = |source| failure(path, source);
    let connection = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(failed)?;
    connection.execute_batch("pragma busy_timeout = 2000;").map_err(failed)?;
    let sql = "select exists(select 1 from sqlite_schema where name = ?1)";
    let made: bool = connection.query_row(sql, [schema::LAST], |row| row.get(0)).map_err(failed)?;
    let whole: bool = connection.query_row(schema::HAS_3, [], |row| row.get(0)).map_err(failed)?;
    if made && !whole {
        connection.execute_batch(schema::SINCE_3).map_err(failed)?;
    }
    Ok(made.then_some(connection))
}

/// The decoded bodies of a table, of the rows and in the order that the rest of the question says.
pub(crate) fn bodies<T: DeserializeOwned>(
    connection: &Connection,
    path: &Path,
    table: &'static str,
    rest: &str,
    values: &[&dyn rusqlite::ToSql],
) -> Result<Vec<T>, StoreError> {
    let failed = |source| failure(path, source);
    let sql = format!("select body from {table} {rest}");
    let mut statement = connection.prepare_cached(&sql).map_err(failed)?;
    let mut rows = statement.query(values).map_err(failed)?;
    let mut all = Vec::new();
    while let Some(row) = rows.next().map_err(failed)? {
        let body = row.get_ref(0).and_then(|body| Ok(body.as_str()?)).map_err(failed)?;
        all.push(serde_json::from_str(body).map_err(|source| StoreError::Row { table, source })?);
    }
    Ok(all)
}
