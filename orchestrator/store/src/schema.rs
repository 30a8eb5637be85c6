//! The tables. Columns beside `body` are for people with a SQL shell; the program reads `body`.

/// Every table of the store.
pub(crate) const TABLES: &str = "
create table if not exists meta(name text primary key, value text not null) without rowid;
create table if not exists scenario(
  id text primary key, batch text not null, place integer not null, result text, body text not null) without rowid;
create index if not exists scenario_place on scenario(place);
create table if not exists job(
  job text primary key, scenario text not null, stage text not null, item text not null, revision integer not null,
  state text not null, idem_key text, body text not null) without rowid;
create table if not exists attempt(
  job text not null, number integer not null, instance text not null, fence integer not null,
  outcome text, body text not null, primary key(job, number)) without rowid;
create table if not exists result(
  job text primary key, attempt integer not null, verdict text, body text not null) without rowid;
create table if not exists text(digest text primary key, content text not null);
create table if not exists event(seq integer primary key, batch text not null, body text not null);
create table if not exists batch(name text primary key, body text not null) without rowid;
create table if not exists series(
  place integer primary key, batch text not null, count integer not null, left_out integer not null, body text not null);
create table if not exists dead(job text primary key, reason text not null) without rowid;
";

/// What stands for the tables that a store of layout 2 lacks, where it is only read.
pub(crate) const SINCE_3: &str = "
create temp table if not exists batch(name text, body text);
create temp table if not exists series(place integer, batch text, count integer, left_out integer, body text);
";

/// Whether a store has the tables of layout 3.
pub(crate) const HAS_3: &str = "select exists(select 1 from sqlite_schema where name = 'series')";

/// The table that is made last: where it is, all are.
pub(crate) const LAST: &str = "dead";

/// How a connection works; how far a commit reaches is set apart.
pub(crate) const PRAGMAS: &str = "
pragma journal_mode = wal;
pragma busy_timeout = 2000;
pragma wal_autocheckpoint = 2000;
";
