//! Bundles of a batch, written by threads of their own while other scenarios are still being made.
//!
//! ```text
//! store ─ what is done since the last look ─► line ─► a thread per core: rows and artifacts of the scenario
//!                                                     ─► files beside the folder ─► one rename ─► card
//! ```
//!
//! A bundle is there whole or not at all, so a batch that is killed leaves whole bundles, and the same command again finds
//! them and writes the rest.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use socrates_model::{Location, ScenarioId};
use socrates_store::Reader;
use tokio::sync::Notify;

use crate::batch::Card;
use crate::bundle;
use crate::conclude::Finished;
use crate::exit::Diagnostic;
use crate::keep::Keep;
use crate::kept::Lines;
use crate::output::Printer;
use crate::prepare::Prepared;
use crate::progress::Progress;
use crate::signals::Signals;
use crate::wanted::Wanted;
use crate::work;

/// Scenarios of the store that are looked at in one look: those before the first that is not done are not looked at again.
const WINDOW: u64 = 4096;
/// Between two looks at whether the threads are still at work, once nothing more is made.
const PAUSE: Duration = Duration::from_secs(1);

/// What a scenario is bundled from.
#[derive(Debug, Clone)]
struct Order {
    seed: u64,
    prepared: Arc<Prepared>,
    /// Its location, shared by the cards of all scenarios of the request.
    location: Arc<Location>,
}

/// What a scenario became: the card of its bundle, or why there is none.
pub(crate) type Bundled = Result<Card, Diagnostic>;

/// Writes the bundles of a batch.
#[derive(Debug)]
pub(crate) struct Bundler {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    store: PathBuf,
    reader: Option<Reader>,
    /// Place of the first scenario that was not done at the last look.
    first_open: u64,
    handed_on: BTreeSet<ScenarioId>,
}

#[derive(Debug)]
struct Shared {
    root: PathBuf,
    work: PathBuf,
    keep: Keep,
    orders: BTreeMap<ScenarioId, Order>,
    line: Mutex<Line>,
    /// For the threads: something waits, or the line is closed.
    news: Condvar,
    /// For whoever waits for the last bundle: one more is there.
    written: Notify,
}

/// Scenarios that wait for a thread, and what became of the others.
#[derive(Debug, Default)]
struct Line {
    waiting: VecDeque<ScenarioId>,
    closed: bool,
    bundled: BTreeMap<ScenarioId, Bundled>,
}

impl Bundler {
    /// Starts as many threads as the machine has cores. Bundles that are kept go into `root` and are called like their scenarios.
    pub(crate) fn start(
        root: &Path,
        work: &Path,
        keep: Keep,
        wanted: &[Wanted<'_>],
        prepared: &[Arc<Prepared>],
    ) -> Self {
        let known: Vec<(&Arc<Prepared>, Arc<Location>)> =
            prepared.iter().map(|one| (one, Arc::new(one.location.clone()))).collect();
        let order = |want: &Wanted<'_>| {
            let (prepared, location) = known.iter().find(|(one, _)| std::ptr::eq(&***one, want.prepared))?;
            let order = Order { seed: want.seed, prepared: Arc::clone(prepared), location: Arc::clone(location) };
            Some((want.id.clone(), order))
        };
        let shared = Arc::new(Shared {
            root: root.to_path_buf(),
            work: work.to_path_buf(),
            keep,
            orders: wanted.iter().filter_map(order).collect(),
            line: Mutex::default(),
            news: Condvar::new(),
            written: Notify::new(),
        });
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = (0..cores.min(wanted.len()).max(1))
            .map(|_| {
                let shared = Arc::clone(&shared);
                std::thread::spawn(move || shared.work())
            })
            .collect();
        Self { shared, threads, store: work::store(work), reader: None, first_open: 0, handed_on: BTreeSet::new() }
    }

    /// Hands on what is done since the last look.
    pub(crate) fn look(&mut self) -> Result<(), Diagnostic> {
        let reader = match self.reader.take() {
            Some(reader) => reader,
            // Until the orchestrator has made it, there is no store, and nothing is done.
            None if !self.store.is_file() => return Ok(()),
            None => Reader::open(&self.store).map_err(work::unread)?,
        };
        let standings = reader.standings(self.first_open, WINDOW).map_err(work::unread)?;
        let open = standings.iter().find(|one| one.result.is_none()).or_else(|| standings.last());
        self.first_open = open.map_or(self.first_open, |one| one.place);
        let done = standings.into_iter().filter(|one| one.result.is_some()).map(|one| one.scenario);
        let fresh: Vec<ScenarioId> = done.filter(|id| self.handed_on.insert(id.clone())).collect();
        // While the tables are being made there are none to be read from later either.
        self.reader = Some(reader).filter(|_| !self.handed_on.is_empty());
        if !fresh.is_empty() {
            self.shared.line().waiting.extend(fresh);
            self.shared.news.notify_all();
        }
        Ok(())
    }

    /// Waits for the bundles that are not written yet, and hands back what became of every scenario. A signal ends the wait; what is
    /// written stays.
    pub(crate) async fn finish(mut self, talk: &Printer) -> Result<BTreeMap<ScenarioId, Bundled>, Diagnostic> {
        let mut signals = Signals::listen()?;
        // A look moves on by its window at most.
        while {
            let before = self.first_open;
            self.look()?;
            self.first_open > before
        } {}
        self.shared.line().closed = true;
        self.shared.news.notify_all();
        let mut progress = Progress::new(*talk, "writing", self.handed_on.len());
        loop {
            let done = self.shared.line().bundled.len();
            if done == self.handed_on.len() || self.threads.iter().all(JoinHandle::is_finished) {
                break;
            }
            progress.at(done, "");
            tokio::select! {
                () = self.shared.written.notified() => {}
                // A thread that broke tells nobody.
                () = tokio::time::sleep(PAUSE) => {}
                why = signals.come() => return Err(why),
            }
        }
        drop(progress);
        Ok(std::mem::take(&mut self.shared.line().bundled))
    }
}

/// Whatever is begun is ended, so that nothing half written stays, and nothing else is begun.
impl Drop for Bundler {
    fn drop(&mut self) {
        let mut line = self.shared.line();
        line.closed = true;
        line.waiting.clear();
        drop(line);
        self.shared.news.notify_all();
        for thread in self.threads.drain(..) {
            if thread.join().is_err() {
                tracing::error!("a thread that wrote bundles broke");
            }
        }
    }
}

impl Shared {
    fn line(&self) -> MutexGuard<'_, Line> {
        self.line.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes one scenario after another until the line is closed and empty.
    fn work(&self) {
        let mut reader = None;
        loop {
            let mut line = self.line();
            let id = loop {
                match line.waiting.pop_front() {
                    Some(id) => break id,
                    None if line.closed => return,
                    None => line = self.news.wait(line).unwrap_or_else(PoisonError::into_inner),
                }
            };
            drop(line);
            let bundled = self.bundle(&id, &mut reader);
            self.line().bundled.insert(id, bundled);
            self.written.notify_one();
        }
    }

    /// The bundle of one scenario, or its line where no bundle is kept, written unless it lies there.
    fn bundle(&self, id: &ScenarioId, reader: &mut Option<Reader>) -> Bundled {
        let stranger = || Diagnostic::resumes(format!("the job store holds `{id}`, which nobody asked for"));
        let Order { seed, prepared, location } = self.orders.get(id).ok_or_else(stranger)?;
        let dir = self.root.join(id.as_str());
        if bundle::lies_in(&dir, prepared, *seed) {
            return Card::read(&self.root, id.as_str());
        }
        let lines = Lines::of(&self.work);
        if let Some((kept, _)) = lines.get(id) {
            return Ok(Card::kept(kept, Arc::clone(location)));
        }
        if reader.is_none() {
            *reader = Some(Reader::open(&work::store(&self.work)).map_err(work::unread)?);
        }
        let gone = || Diagnostic::resumes(format!("the job store has lost `{id}`"));
        let (work, keep) = (&self.work, self.keep);
        let finished = Finished { dir: &dir, work, id, prepared, seed: *seed, alone: false, keep };
        Card::written(&finished.by_store(reader.as_ref().ok_or_else(gone)?)?, location, id, keep, &lines)
    }
}
