//! `cluster collect`: bundles, page and tables of what a cluster has made, on whichever machine they are wanted.
//!
//! ```text
//! places of a batch ─► done and not yet here ─► rows and artifacts over the bus ─► bundle ─► list, page and tables
//! ```
//!
//! It may be done while the cluster works, and again: what is here is not fetched twice.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use socrates_kit::Blobs;
use socrates_link::Bus;
use socrates_link::rules::Role;
use socrates_model::wire::PastEnd;
use socrates_model::{Digest, Location};
use socrates_orchestrator::Snapshot;
use tokio::runtime::Handle;
use tokio::task::JoinSet;

use crate::batch::Card;
use crate::conclude::Finished;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::folder::Hold;
use crate::keep::{self, Keep};
use crate::kept::Lines;
use crate::library_index::Library;
use crate::many::{self, Ended};
use crate::order::Order;
use crate::output::Printer;
use crate::place::{self, Place};
use crate::prepare::Prepared;
use crate::progress::Progress;
use crate::run_options::Require;
use crate::words::plural;
use crate::{bundle, calls, process};

/// What is collected.
#[derive(Debug, Clone)]
pub struct CollectOptions {
    /// Endpoint of the orchestrator.
    pub connect: String,
    /// Namespace.
    pub namespace: String,
    /// Name of the batch; needed where there are several.
    pub batch: Option<String>,
    /// Folder of the library.
    pub out: PathBuf,
    /// Which bundles are kept; none decides by the number of scenarios.
    pub keep: Option<Keep>,
}

/// Writes the bundles of a batch that are done and not in the folder yet, and its list, page and tables.
///
/// # Errors
/// No orchestrator, no such batch or several, a folder that holds something else, or scenarios that were submitted without an order.
pub async fn collect(talk: &Printer, config: &Config, options: &CollectOptions) -> Result<Code, Diagnostic> {
    let bus = process::client(config, Role::Client, &options.connect, &options.namespace, "collect").await?;
    let ends = of_batch(calls::ends(bus.as_ref()).await?, options.batch.as_deref())?;
    let Some(first) = ends.first() else { return Err(empty(&options.connect)) };
    let total = total(bus.as_ref(), &first.batch).await?.max(ends.len());
    let known = Arc::new(Known { bus: Arc::clone(&bus), config: config.clone(), orders: Mutex::default() });
    let library = Known::library(&known, first).await?;
    let done: Vec<PastEnd> = ends.iter().filter(|end| end.end.is_some()).cloned().collect();
    talk.line(&format!("batch      `{}` · {} of {} done", first.batch, done.len(), plural(total, "scenario")));
    let root = match place::place(&options.out, library, false) {
        Place::Finished(root) | Place::New(root) => place::told(talk, &options.out, root),
    };
    let fixed = keep::agreed(&root, place::fixed(&root), options.keep)?;
    let keep = fixed.unwrap_or_else(|| Keep::of(total));
    let work = place::claim(&root, library)?;
    place::fix(&work, keep)?;
    Lines::of(&work).adopt(&root)?;
    let hold = Hold::take(&work)?;
    let into = Target { root: &root, work: &work, keep };
    let made = bundles(talk, &known, &done, into, &hold).await?;
    bus.close().await;
    many::write(talk, &root, &work, Library::new(library, None, Some(keep), total, known.readings()), made)?;
    drop(std::fs::remove_dir_all(&work));
    let code = many::finish(talk, Require::Any, &root, &[])?;
    if done.len() < ends.len() {
        let open = plural(ends.len() - done.len(), "scenario");
        talk.line(&format!("open       {open} are being made; the same command again fetches them"));
    }
    if ends.len() < total {
        let later = plural(total - ends.len(), "scenario");
        talk.line(&format!(
            "later      {later} were not begun; `socrates status {}` says whether they will be",
            options.connect
        ));
    }
    Ok(code)
}

/// Scenarios of a batch, those that are not made yet among them.
async fn total(bus: &dyn Bus, batch: &str) -> Result<usize, Diagnostic> {
    let told = calls::counts(bus, batch).await.map_err(calls::silent)?;
    Ok(usize::try_from(told.total).unwrap_or(usize::MAX))
}

/// The scenarios of one batch in their order.
fn of_batch(ends: Vec<PastEnd>, batch: Option<&str>) -> Result<Vec<PastEnd>, Diagnostic> {
    let mut batches: BTreeMap<String, usize> = BTreeMap::new();
    ends.iter().for_each(|end| *batches.entry(end.batch.clone()).or_default() += 1);
    let told = || batches.iter().map(|(name, count)| format!("`{name}` ({count})")).collect::<Vec<_>>().join(", ");
    match batch {
        Some(name) if !batches.is_empty() && !batches.contains_key(name) => {
            Err(Diagnostic::input(format!("there is no batch `{name}`"), format!("batches there: {}", told())))
        }
        Some(name) => Ok(ends.into_iter().filter(|end| end.batch == name).collect()),
        None if batches.len() > 1 => Err(Diagnostic::input(
            format!("there are {} batches, and each is a library of its own", batches.len()),
            format!("--batch names one of: {}", told()),
        )),
        None => Ok(ends),
    }
}

fn empty(connect: &str) -> Diagnostic {
    Diagnostic::input(
        format!("nothing was submitted to `{connect}`"),
        format!("`socrates cluster submit REQUESTS --connect {connect}` hands scenarios in"),
    )
}

/// Writes the bundles that are not there yet, some at once.
async fn bundles(
    talk: &Printer,
    known: &Arc<Known>,
    done: &[PastEnd],
    into: Target<'_>,
    hold: &Hold,
) -> Result<Vec<Ended>, Diagnostic> {
    let at_once = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut progress = Progress::new(*talk, "collecting", done.len());
    let mut made: BTreeMap<u64, Ended> = BTreeMap::new();
    let mut waiting = done.iter();
    let mut tasks: JoinSet<(u64, Result<Ended, Diagnostic>)> = JoinSet::new();
    loop {
        while tasks.len() < at_once
            && let Some(end) = waiting.next()
        {
            let (known, end, keep) = (Arc::clone(known), end.clone(), into.keep);
            let (root, work) = (into.root.to_path_buf(), into.work.to_path_buf());
            tasks
                .spawn(async move { (end.place, known.bundle(&end, Target { root: &root, work: &work, keep }).await) });
        }
        let Some(came) = tasks.join_next().await else { break };
        let (place, ended) = came.map_err(|broke| {
            Diagnostic::input(format!("a bundle could not be written: {broke}"), "").with_code(Code::Ours)
        })?;
        hold.check()?;
        made.insert(place, ended?);
        progress.at(made.len(), "");
    }
    Ok(made.into_values().collect())
}

/// The library that is collected into.
#[derive(Debug, Clone, Copy)]
struct Target<'a> {
    root: &'a Path,
    work: &'a Path,
    keep: Keep,
}

/// What was fetched once and serves all scenarios of a request.
struct Known {
    bus: Arc<dyn Bus>,
    config: Config,
    orders: Mutex<BTreeMap<Digest, Request>>,
}

/// A request of the batch, in the order of its first scenario.
#[derive(Clone)]
struct Request {
    place: u64,
    prepared: Arc<Prepared>,
    location: Arc<Location>,
}

impl Known {
    /// What the whole batch is made from.
    async fn library(known: &Arc<Self>, first: &PastEnd) -> Result<Digest, Diagnostic> {
        let rows = known.rows(first).await?;
        let (known, handle) = (Arc::clone(known), Handle::current());
        let read = move || {
            let scenario = rows.scenarios.first().ok_or_else(|| lost("its scenario"))?;
            Ok(Order::read(&scenario.spec, &|digest| known.get(&handle, digest))?.library)
        };
        blocking(read).await
    }

    async fn rows(&self, end: &PastEnd) -> Result<Snapshot, Diagnostic> {
        let text = calls::rows(self.bus.as_ref(), &end.scenario).await?;
        serde_json::from_slice(&text).map_err(|why| {
            Diagnostic::input(
                format!("the rows of `{}` cannot be read: {why}", end.scenario),
                "orchestrator and this program must be of one version",
            )
        })
    }

    /// The bundle of a scenario, fetched and written unless it lies there.
    async fn bundle(self: Arc<Self>, end: &PastEnd, into: Target<'_>) -> Result<Ended, Diagnostic> {
        let rows = self.rows(end).await?;
        let (known, handle) = (self, Handle::current());
        let (id, place, keep) = (end.scenario.clone(), end.place, into.keep);
        let (root, work) = (into.root.to_path_buf(), into.work.to_path_buf());
        blocking(move || {
            let fetch = |digest: &Digest| known.get(&handle, digest);
            let spec = rows.scenarios.first().map(|scenario| scenario.spec.clone());
            let spec = spec.ok_or_else(|| lost(id.as_str()))?;
            let request = known.request(&spec, place, &fetch)?;
            let dir = root.join(id.as_str());
            let name = request.prepared.name.clone();
            let prepared = &request.prepared;
            if bundle::lies_in(&dir, prepared, spec.seed) {
                return Ok(Ended { what: Ok(Card::read(&root, id.as_str())?), scenario: id, request: name });
            }
            let lines = Lines::of(&work);
            if let Some((kept, _)) = lines.get(&id) {
                let card = Card::kept(kept, Arc::clone(&request.location));
                return Ok(Ended { what: Ok(card), scenario: id, request: name });
            }
            let finished = Finished { dir: &dir, work: &work, id: &id, prepared, seed: spec.seed, alone: false, keep };
            let written = finished.by_rows(rows, &fetch);
            let what = written.and_then(|bundle| Card::written(&bundle, &request.location, &id, keep, &lines));
            match what {
                // The cluster, the disk or this program, not the scenario: nothing is listed as failed that is not.
                Err(why) if matches!(why.code, Code::Ours | Code::Input) => Err(why),
                what => Ok(Ended { what, scenario: id, request: name }),
            }
        })
        .await
    }

    /// The prepared request of a scenario, put together once.
    fn request(
        &self,
        spec: &socrates_model::wire::ScenarioSpec,
        place: u64,
        fetch: &dyn Fn(&Digest) -> Result<Vec<u8>, Diagnostic>,
    ) -> Result<Request, Diagnostic> {
        let orders = || self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        let digest = spec.order.unwrap_or_else(|| Digest::of(b""));
        if let Some(known) = orders().get_mut(&digest) {
            known.place = known.place.min(place);
            return Ok(known.clone());
        }
        let prepared = Order::read(spec, fetch)?.prepared(spec, fetch, &self.config)?;
        let location = Arc::new(prepared.location.clone());
        let request = Request { place, prepared: Arc::new(prepared), location };
        Ok(orders().entry(digest).or_insert(request).clone())
    }

    /// Readings of the requests in the order in which they were submitted.
    fn readings(&self) -> Vec<socrates_model::Reading> {
        let orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        let mut requests: Vec<&Request> = orders.values().collect();
        requests.sort_by_key(|request| request.place);
        requests.iter().map(|request| request.prepared.reading.clone()).collect()
    }

    /// An artifact over the bus; for threads that may wait.
    fn get(&self, handle: &Handle, digest: &Digest) -> Result<Vec<u8>, Diagnostic> {
        let came = handle.block_on(Blobs::Bus.get(&self.bus, *digest, calls::PART));
        came.map_err(|why| Diagnostic::resumes(format!("artifact {} cannot be fetched: {why}", digest.short())))
    }
}

fn lost(what: &str) -> Diagnostic {
    Diagnostic::resumes(format!("the orchestrator has lost `{what}`"))
}

/// Work that waits for the disk and the bus, on a thread of its own.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Diagnostic> + Send + 'static,
) -> Result<T, Diagnostic> {
    tokio::task::spawn_blocking(work)
        .await
        .unwrap_or_else(|broke| Err(Diagnostic::input(format!("a thread broke: {broke}"), "").with_code(Code::Ours)))
}

#[cfg(test)]
mod tests {
    use socrates_model::ScenarioId;

    use super::*;

    fn ends(batches: &[&str]) -> Vec<PastEnd> {
        let end = |(place, batch): (usize, &&str)| PastEnd {
            place: u64::try_from(place).unwrap(),
            scenario: ScenarioId::new(format!("s-{place}")).unwrap(),
            batch: (*batch).to_owned(),
            end: None,
        };
        batches.iter().enumerate().map(end).collect()
    }

    #[test]
    fn a_batch_is_named_where_there_are_several() {
        assert_eq!(of_batch(ends(&["a", "a"]), None).unwrap().len(), 2);
        let why = of_batch(ends(&["a", "b", "a"]), None).unwrap_err();
        assert!(why.hint.contains("`a` (2), `b` (1)"), "{why}");
        let picked = of_batch(ends(&["a", "b", "a"]), Some("a")).unwrap();
        assert_eq!(picked.iter().map(|end| end.place).collect::<Vec<_>>(), [0, 2]);
        let why = of_batch(ends(&["a"]), Some("c")).unwrap_err();
        assert!(why.what.contains("`c`") && why.hint.contains("`a` (1)"), "{why}");
        assert!(of_batch(Vec::new(), None).unwrap().is_empty());
    }
}
