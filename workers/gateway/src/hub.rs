//! All runs that can be seen, by name: those on the bus and those that were kept.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use async_trait::async_trait;
use serde_json::Value;
use socrates_model::RunId;

use crate::run::Run;

/// Runs that are held open at once; of those that nobody views, the first that were opened go.
const OPEN: usize = 32;

/// A place where runs are found.
#[async_trait]
pub trait Shelf: Send + Sync {
    /// Its runs in the order in which they are listed, as lines of the list. It waits for nobody.
    async fn list(&self) -> Vec<(RunId, Value)>;
    /// Opens one; none where it has no such run, or not yet.
    ///
    /// # Errors
    /// Why the run is there and cannot be shown, in a sentence.
    async fn open(&self, run: &RunId) -> Result<Option<Run>, String>;
    /// A run that is over and was recorded; none where it has no such run.
    ///
    /// # Errors
    /// Why the run is there and cannot be shown, in a sentence.
    async fn kept(&self, _run: &RunId) -> Result<Option<Run>, String> {
        Ok(None)
    }
    /// Begins whatever goes on beside an opened run. It ends by itself when the run is over or nobody holds it any more.
    async fn begin(&self, run: &Arc<Run>);
}

/// The runs.
pub struct Hub {
    shelves: Vec<Box<dyn Shelf>>,
    open: Mutex<Vec<Arc<Run>>>,
    /// One is opened at a time, so that two viewers get the same.
    opening: tokio::sync::Mutex<()>,
}

impl Hub {
    /// Runs of these places; of two of the same name the first counts.
    #[must_use]
    pub fn new(shelves: Vec<Box<dyn Shelf>>) -> Self {
        Self { shelves, open: Mutex::default(), opening: tokio::sync::Mutex::default() }
    }

    fn held(&self) -> MutexGuard<'_, Vec<Arc<Run>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The list of the page, runs that go on first.
    pub async fn list(&self) -> Vec<Value> {
        let mut lines: BTreeMap<RunId, Value> = BTreeMap::new();
        let mut order: Vec<RunId> = Vec::new();
        for shelf in &self.shelves {
            for (run, line) in shelf.list().await {
                if let Entry::Vacant(free) = lines.entry(run) {
                    order.push(free.key().clone());
                    free.insert(line);
                }
            }
        }
        // What is open is known better.
        for run in self.held().iter() {
            if let Some(line) = lines.get_mut(run.id()) {
                *line = run.line();
            }
        }
        let mut found: Vec<Value> = order.iter().filter_map(|run| lines.remove(run)).collect();
        found.sort_by_key(|line| line.get("state").and_then(Value::as_str) != Some("live"));
        found
    }

    /// A run by its name; none where there is no such run, or not yet.
    ///
    /// # Errors
    /// Why the run is there and cannot be shown.
    pub async fn run(&self, name: &RunId) -> Result<Option<Arc<Run>>, String> {
        let known = || self.held().iter().find(|run| run.id() == name).cloned();
        if let Some(run) = known().filter(|run| !run.is_bare()) {
            return Ok(Some(run));
        }
        let _alone = self.opening.lock().await;
        let bare = match known() {
            Some(run) if run.is_bare() => Some(run),
            Some(run) => return Ok(Some(run)),
            None => None,
        };
        for shelf in &self.shelves {
            // One whose recording could not be had from the bus may be kept by now; it does not go on again.
            let found = if bare.is_some() { shelf.kept(name).await? } else { shelf.open(name).await? };
            if let Some(run) = found {
                let run = Arc::new(run);
                self.held().retain(|other| other.id() != name);
                self.hold(&run);
                shelf.begin(&run).await;
                return Ok(Some(run));
            }
        }
        Ok(bare)
    }

    /// The run that a viewer without a name is shown: the newest that goes on, else the first of the list.
    pub async fn any(&self) -> Option<RunId> {
        let lines = self.list().await;
        let name = |line: &Value| RunId::new(line.get("run")?.as_str()?).ok();
        lines.first().and_then(name)
    }

    fn hold(&self, run: &Arc<Run>) {
        let mut held = self.held();
        while held.len() >= OPEN {
            let Some(idle) = held.iter().position(|other| other.viewers() == 0) else { break };
            held.remove(idle);
        }
        held.push(Arc::clone(run));
    }
}
