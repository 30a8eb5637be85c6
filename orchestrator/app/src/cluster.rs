//! `cluster submit`: requests handed to a running orchestrator.

use std::path::PathBuf;
use std::time::Duration;

use serde_json::json;
use socrates_kit::LocalBlobs;
use socrates_link::rules::Role;

use crate::calls;
use crate::config::Config;
use crate::exit::{Code, Complaint};
use crate::output::Printer;
use crate::prepare::{prepare, request_files};
use crate::process::client;
use crate::run_options::RunOptions;
use crate::variants;
use crate::wanted::{specs, wanted};
use crate::words::plural;

/// Submits requests and returns; `socrates status ENDPOINT` shows how they stand.
pub async fn submit(
    talk: &Printer,
    config: &Config,
    requests: &[PathBuf],
    connect: &str,
    namespace: &str,
    seed: u64,
) -> Result<(), Complaint> {
    let options = RunOptions::plain(seed);
    let files = request_files(requests)?;
    let prepared = files.iter().map(|file| prepare(file, Some(&options), config)).collect::<Result<Vec<_>, _>>()?;
    let bus = client(config, Role::Client, connect, namespace, "submit").await?;
    let folder = config.program().temp.join(format!("socrates-submit-{}", std::process::id()));
    let ours = |why: String| Complaint::input(why, "").with_code(Code::Ours);
    let blobs = LocalBlobs::new(&folder, false);
    let plans = variants::plans(talk, prepared.iter(), seed, options.repeats)?;
    let specs = specs(&wanted(&prepared, seed, &plans)?, config, &options, &blobs)?;
    let mut digests: Vec<_> = specs
        .iter()
        .flat_map(|spec| [spec.request, spec.location, spec.reading].into_iter().chain(spec.pinned.values().copied()))
        .collect();
    digests.sort();
    digests.dedup();
    let remote = socrates_kit::Blobs::Bus;
    for digest in digests {
        let bytes = blobs.get(&digest).map_err(|why| ours(why.to_string()))?;
        remote
            .put(&bus, bytes, Duration::from_secs(10))
            .await
            .map_err(|why| ours(format!("an artifact could not be handed over: {why}")))?;
    }
    let count = specs.len();
    calls::submit(bus.as_ref(), "cluster", specs).await?;
    bus.close().await;
    drop(std::fs::remove_dir_all(&folder));
    talk.line(&format!("submitted  {} from {}", plural(count, "scenario"), plural(prepared.len(), "request")));
    talk.line(&format!("next       socrates status {connect}@{namespace}"));
    talk.result(&json!({ "submitted": count }));
    Ok(())
}
