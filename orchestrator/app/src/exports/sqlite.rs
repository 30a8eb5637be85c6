//! Databases of SQLite, written as exporters state them.

use std::path::Path;

use rusqlite::types::Value as Cell;
use rusqlite::{Connection, params_from_iter};
use socrates_export::scenario::{Database, Value};

use crate::exit::Diagnostic;
use crate::files;

/// Writes a database anew; the same tables give the same bytes.
pub(super) fn write(path: &Path, database: &Database) -> Result<(), Diagnostic> {
    // Makes the folder, and says what keeps a file from being written there.
    files::write(path, b"")?;
    fill(path, database).map_err(|why| {
        Diagnostic::input(format!("cannot write `{}`: {why}", path.display()), "--out chooses another place")
    })
}

fn fill(path: &Path, database: &Database) -> rusqlite::Result<()> {
    let mut connection = Connection::open(path)?;
    // Nobody reads the file before it is whole.
    connection.pragma_update(None, "journal_mode", "OFF")?;
    connection.pragma_update(None, "synchronous", "OFF")?;
    let transaction = connection.transaction()?;
    for table in &database.tables {
        transaction.execute(table.create, [])?;
        let mut insert = transaction.prepare(table.insert)?;
        for row in &table.rows {
            insert.execute(params_from_iter(row.iter().map(cell)))?;
        }
    }
    for index in database.indexes {
        transaction.execute(index, [])?;
    }
    transaction.commit()
}

fn cell(value: &Value) -> Cell {
    match value {
        Value::Integer(number) => Cell::Integer(*number),
        Value::Real(number) => Cell::Real(*number),
        Value::Text(text) => Cell::Text(text.clone()),
    }
}

#[cfg(test)]
mod tests {
    use socrates_export::scenario::Table;

    use super::*;

    #[test]
    fn a_database_is_written_anew_with_the_same_bytes_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a b").join("t.sqlite");
        let rows = |count: i64| (0..count).map(|n| vec![Value::Integer(n), Value::Real(0.5), Value::Text("ü".into())]);
        let of = |count: i64| Database {
            tables: vec![Table {
                create: "CREATE TABLE t (a INTEGER, b REAL, c TEXT)",
                insert: "INSERT INTO t VALUES (?, ?, ?)",
                rows: rows(count).collect(),
            }],
            indexes: &["CREATE INDEX i ON t (a)"],
        };
        write(&path, &of(1000)).unwrap();
        let first = std::fs::read(&path).unwrap();
        write(&path, &of(3)).unwrap();
        write(&path, &of(1000)).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), first);
        let read = Connection::open(&path).unwrap();
        let found: (i64, f64, String) = read
            .query_row("SELECT count(*), sum(b), max(c) FROM t", [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))
            .unwrap();
        assert_eq!(found, (1000, 500.0, "ü".to_owned()));
        let told = write(&folder.path().join("a b"), &of(1)).unwrap_err();
        assert!(told.what.contains("a b"), "{}", told.what);
    }
}
