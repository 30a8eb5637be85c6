//! What the verbs of the program do: requests become bundles, bundles are looked at, compared and scored again.
//!
//! ```text
//! config ─► prepare ─► session (supervise: orchestrator + workers) ─► bundler ─► bundle ─► page
//!                                                                        bundle ─► video, figure, labels, cost …
//! ```
//!
//! Every verb is a function that takes plain values and a [`output::Printer`] to say something with. `orchestrator/cli` turns
//! arguments into those values, and what is said into lines.
//!
//! *Never here:* a rule of authoring, simulation, scoring or retry; an argument of the command line, a variable of the
//! environment, a line printed, an exit of the process.

pub mod agents;
pub mod agreement;
mod ask;
pub mod authors;
mod batch;
mod batch_stats;
pub mod bt;
pub mod build;
pub mod bundle;
mod bundler;
pub mod calls;
pub mod cards;
mod child;
pub mod cite;
pub mod cluster;
pub mod cluster_work;
pub mod collect;
pub mod compare;
mod conclude;
pub mod config;
pub mod console;
mod cores;
pub mod cost;
mod coverage;
mod crew;
pub mod dev;
pub mod drive_check;
mod driver_process;
mod dry_run;
pub mod editor;
mod encounters;
pub mod evaluate;
pub mod exit;
pub mod expected_tokens;
pub mod experiment;
pub mod explain;
pub mod explain_job;
pub mod export_chat;
pub mod exports;
pub mod figure;
pub mod files;
mod folder;
pub mod fsck;
pub mod graphs;
pub mod history;
pub mod in_process;
mod index;
pub mod keep;
mod kept;
pub mod keys;
pub mod labels;
pub mod layout;
mod ledger;
pub mod library_coverage;
pub mod library_diversity;
mod library_index;
pub mod logs;
mod loopback;
pub mod machine;
mod many;
pub mod map;
pub mod merge;
pub mod new_request;
mod next;
mod opaque;
mod orchestrate;
mod order;
pub mod output;
#[cfg(feature = "parquet")]
mod parquet_file;
pub mod place;
pub mod prepare;
pub mod prices;
pub mod process;
mod progress;
pub mod protocol;
pub mod query;
pub mod rates;
mod raw_map;
mod reading;
mod refused;
pub mod replay;
pub mod report;
mod router;
pub mod run;
pub mod run_options;
pub mod scenarios;
mod scribe;
pub mod serve;
pub mod session;
pub mod shard;
mod signals;
mod stages;
pub mod standing;
pub mod steer;
pub mod study;
mod supervise;
pub mod top;
mod variants;
pub mod verify;
pub mod video;
pub mod view;
pub mod wanted;
pub mod watch;
pub mod words;
pub mod work;
