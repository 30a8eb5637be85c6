//! Artifacts over the bus, in parts of at most 48 KiB: the worker's side and the orchestrator's.

use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Ask, Bus, LinkError, call_envelope, keys};
use socrates_model::wire::{BlobGet, BlobPart, BlobPut};
use socrates_model::{Digest, TraceContext};
use tokio::task::JoinSet;
use tokio::time::Instant;

use crate::blobs::{BlobError, LocalBlobs, off_thread};

/// Kind of a message that asks for a part.
const KIND_GET: &str = "blob_get";
/// Kind of a message that hands over a part.
const KIND_PUT: &str = "blob_put";
/// Largest part, bytes.
const PART_BYTES: usize = 48 * 1024;
/// Tries per part before the whole transfer is given up; the attempt is then reported as passing trouble.
const TRIES: u32 = 5;
/// Parts that are read for somebody at one time at most.
const READING: usize = 64;
/// Largest artifact that is taken over the bus, bytes: a recording of an hour with forty people.
const MAX_BYTES: u64 = 1 << 30;

async fn ask<Req, Rep>(
    trace: Option<TraceContext>,
    bus: &Arc<dyn Bus>,
    key: &str,
    kind: &str,
    request: &Req,
    timeout: Duration,
) -> Result<Rep, LinkError>
where
    Req: serde::Serialize + Sync,
    Rep: serde::de::DeserializeOwned,
{
    let mut pause = Duration::from_millis(50);
    for _earlier in 1..TRIES {
        match call_envelope(&**bus, key, kind, request, (trace, None), timeout).await {
            Err(error) if error.is_transient() => tokio::time::sleep(pause).await,
            settled => return settled.map(|reply| reply.body),
        }
        pause *= 2;
    }
    Ok(call_envelope(&**bus, key, kind, request, (trace, None), timeout).await?.body)
}

/// Fetches an artifact part by part.
pub(crate) async fn fetch(
    trace: Option<TraceContext>,
    bus: &Arc<dyn Bus>,
    digest: Digest,
    timeout: Duration,
) -> Result<Vec<u8>, BlobError> {
    let mut whole: Vec<u8> = Vec::new();
    loop {
        let get = BlobGet { digest, offset: whole.len() as u64 };
        let part: BlobPart = ask(trace, bus, keys::BLOB_GET, KIND_GET, &get, timeout)
            .await
            .map_err(|why| BlobError::Link { digest, why })?;
        if !part.found {
            return Err(BlobError::Missing { digest });
        }
        let ended = part.bytes.is_empty();
        whole.extend(part.bytes);
        if ended || whole.len() as u64 >= part.len || part.len > MAX_BYTES {
            break;
        }
    }
    let found = Digest::of(&whole);
    if found == digest { Ok(whole) } else { Err(BlobError::Torn { digest, found }) }
}

/// Stores an artifact part by part.
pub(crate) async fn store(
    trace: Option<TraceContext>,
    bus: &Arc<dyn Bus>,
    bytes: &[u8],
    timeout: Duration,
) -> Result<Digest, BlobError> {
    let digest = Digest::of(bytes);
    let len = bytes.len() as u64;
    let mut offset = 0_usize;
    loop {
        let part = bytes.get(offset..bytes.len().min(offset.saturating_add(PART_BYTES))).unwrap_or(&[]);
        let put = BlobPut { digest, len, offset: offset as u64, bytes: part.to_vec() };
        let held: u64 = ask(trace, bus, keys::BLOB_PUT, KIND_PUT, &put, timeout)
            .await
            .map_err(|why| BlobError::Link { digest, why })?;
        if held >= len {
            return Ok(digest);
        }
        offset = usize::try_from(held).unwrap_or(usize::MAX);
    }
}

/// What an answer about an artifact was, for figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlobMove {
    /// Whether the artifact came in; else it went out.
    pub put: bool,
    /// Bytes of the part.
    pub bytes: u64,
    /// Whether it was the last part: the artifact is through.
    pub whole: bool,
    /// Whether it was refused, or could not be read as a question.
    pub refused: bool,
    /// Time from the question's coming to its answer.
    pub took: Duration,
}

/// Serves a folder of artifacts on the bus until the bus closes; the orchestrator's side. `seen` hears of every answer.
///
/// # Errors
/// [`LinkError`] when the keys cannot be served.
pub async fn serve_blobs(
    bus: Arc<dyn Bus>,
    blobs: LocalBlobs,
    seen: impl Fn(BlobMove) + Send + Sync + 'static,
) -> Result<(), LinkError> {
    let seen = Arc::new(seen);
    let (mut gets, mut puts) = (bus.serve(keys::BLOB_GET).await?, bus.serve(keys::BLOB_PUT).await?);
    let mut reading = JoinSet::new();
    loop {
        tokio::select! {
            // Parts of one artifact are written one after another; any number may be read at one time.
            Some(ask) = puts.next() => {
                let began = Instant::now();
                let nothing = BlobMove { put: true, ..NOTHING };
                told(&*seen, began, answer_put(&*bus, ask, &blobs, nothing).await);
            }
            Some(ask) = gets.next(), if reading.len() < READING => {
                let (bus, blobs, seen) = (Arc::clone(&bus), blobs.clone(), Arc::clone(&seen));
                reading.spawn(async move {
                    let began = Instant::now();
                    told(&*seen, began, answer_get(&*bus, ask, &blobs, NOTHING).await);
                });
            }
            Some(_read) = reading.join_next() => {}
            else => return Ok(()),
        }
    }
}

/// An answer that nothing moved with.
const NOTHING: BlobMove = BlobMove { put: false, bytes: 0, whole: false, refused: true, took: Duration::ZERO };

fn told(seen: &impl Fn(BlobMove), began: Instant, answered: Result<BlobMove, LinkError>) {
    match answered {
        Ok(moved) => seen(BlobMove { took: began.elapsed(), ..moved }),
        Err(why) => tracing::debug!(%why, "a reply about an artifact did not go out"),
    }
}

/// A line for each artifact that is through, with the trace of whoever asked.
fn tell(moved: BlobMove, digest: &Digest, len: u64, trace: Option<TraceContext>) {
    if moved.whole {
        let words = if moved.put { "an artifact came in" } else { "an artifact went out" };
        tracing::info!(
            %digest, len, trace_id = trace.map(|trace| trace.trace_id()), span_id = trace.map(|trace| trace.span_id()),
            "{words}"
        );
    }
}

async fn answer_get(bus: &dyn Bus, ask: Ask, blobs: &LocalBlobs, nothing: BlobMove) -> Result<BlobMove, LinkError> {
    let (get, trace): (BlobGet, _) = match ask.read(KIND_GET) {
        Ok(envelope) => (envelope.body, envelope.traceparent),
        Err(why) => return ask.refuse(bus.name(), 0, &why.to_string()).await.map(|()| nothing),
    };
    let folder = blobs.clone();
    let (digest, offset) = (get.digest, get.offset);
    let read = off_thread(blobs.path(&digest), move || read_part(&folder, &get)).await;
    match read {
        Ok(part) => {
            let (bytes, len) = (part.bytes.len() as u64, part.len);
            ask.answer(KIND_GET, bus.name(), 0, &part).await?;
            let moved = BlobMove { bytes, whole: offset.saturating_add(bytes) >= len, refused: false, ..nothing };
            tell(moved, &digest, len, trace);
            Ok(moved)
        }
        Err(BlobError::Missing { .. } | BlobError::Torn { .. }) => {
            ask.answer(KIND_GET, bus.name(), 0, &BlobPart { len: 0, found: false, bytes: Vec::new() }).await?;
            Ok(BlobMove { refused: false, ..nothing })
        }
        Err(why) => ask.refuse(bus.name(), 0, &why.to_string()).await.map(|()| nothing),
    }
}

/// Reads one part only; the fetcher checks the whole against its address.
fn read_part(blobs: &LocalBlobs, get: &BlobGet) -> Result<BlobPart, BlobError> {
    use std::io::{Read as _, Seek as _, SeekFrom};
    let path = blobs.path(&get.digest);
    if !blobs.has(&get.digest) {
        return Err(BlobError::Missing { digest: get.digest });
    }
    let read = || -> std::io::Result<BlobPart> {
        let mut file = std::fs::File::open(&path)?;
        let len = file.metadata()?.len();
        file.seek(SeekFrom::Start(get.offset))?;
        let mut bytes = Vec::new();
        file.take(PART_BYTES as u64).read_to_end(&mut bytes)?;
        Ok(BlobPart { len, found: true, bytes })
    };
    read().map_err(|why| BlobError::File { path: path.clone(), why })
}

async fn answer_put(bus: &dyn Bus, ask: Ask, blobs: &LocalBlobs, nothing: BlobMove) -> Result<BlobMove, LinkError> {
    let (put, trace): (BlobPut, _) = match ask.read(KIND_PUT) {
        Ok(envelope) => (envelope.body, envelope.traceparent),
        Err(why) => return ask.refuse(bus.name(), 0, &why.to_string()).await.map(|()| nothing),
    };
    if put.len > MAX_BYTES {
        let why = format!("{} bytes are too many, at most {MAX_BYTES}", put.len);
        return ask.refuse(bus.name(), 0, &why).await.map(|()| nothing);
    }
    let folder = blobs.clone();
    let path = blobs.path(&put.digest);
    let (digest, len, bytes) = (put.digest, put.len, put.bytes.len() as u64);
    let held = off_thread(path, move || folder.put_part(&put.digest, put.len, put.offset, &put.bytes)).await;
    match held {
        Ok(held) => {
            ask.answer(KIND_PUT, bus.name(), 0, &held).await?;
            let moved = BlobMove { bytes, whole: held >= len, refused: false, ..nothing };
            tell(moved, &digest, len, trace);
            Ok(moved)
        }
        Err(why) => ask.refuse(bus.name(), 0, &why.to_string()).await.map(|()| nothing),
    }
}
