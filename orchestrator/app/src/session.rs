//! One making: start the system, submit, follow, hand on what is done.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use socrates_kit::LocalBlobs;
use socrates_link::{Overflow, keys};
use socrates_model::wire::{Notice, Priority, ScenarioSpec, ScenarioStatus, StatusAsk};
use socrates_model::{Digest, ScenarioEnd, ScenarioId};
use socrates_orchestrator::trace_of;
use socrates_store::Reader;
use tokio::time::Instant;

use crate::ask::Asking;
use crate::bundler::Bundler;
use crate::calls::{AWAY, status, submit};
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::folder::Hold;
use crate::history::History;
use crate::output::Printer;
use crate::progress::Progress;
use crate::run_options::RunOptions;
use crate::signals::{Signals, stopped};
use crate::stages;
use crate::supervise::Supervisor;
use crate::wanted::{Wanted, specs};
use crate::work::{self, blobs, fetch, store};

/// What was made.
#[derive(Debug)]
pub struct Made {
    /// One status per scenario, in order of submission.
    pub(crate) statuses: Vec<ScenarioStatus>,
    /// Every revision and attempt of each scenario.
    pub history: History,
    blobs: LocalBlobs,
    /// Until the bundle is written, nobody else makes it.
    _hold: Hold,
}

impl Made {
    /// An artifact from the work folder.
    pub(crate) fn fetch(&self, digest: &Digest) -> Result<Vec<u8>, Diagnostic> {
        fetch(&self.blobs, digest)
    }
}

/// Name of the batch of a run.
const BATCH: &str = "run";

/// What the store holds once its orchestrator has left.
fn made(work: &Path, wanted: &[Wanted<'_>], hold: Hold) -> Result<Made, Diagnostic> {
    let rows = Reader::open(&store(work)).and_then(|reader| reader.all()).map_err(work::unread)?;
    let mut found: BTreeMap<ScenarioId, ScenarioStatus> =
        socrates_orchestrator::standing(rows.clone()).into_iter().map(|status| (status.id.clone(), status)).collect();
    let statuses = wanted.iter().filter_map(|want| found.remove(&want.id)).collect();
    Ok(Made { statuses, history: History::of_rows(rows), blobs: blobs(work), _hold: hold })
}

/// What is made, and how. A work folder that holds a part of it already is resumed.
#[derive(Debug, Clone, Copy)]
pub struct Making<'a> {
    /// Says how far it is.
    pub talk: &'a Printer,
    /// Configuration.
    pub config: &'a Config,
    /// Options of the run.
    pub options: &'a RunOptions,
    /// Work folder.
    pub work: &'a Path,
    /// The scenarios.
    pub wanted: &'a [Wanted<'a>],
}

impl Making<'_> {
    /// Makes the scenarios, at most so many `at_once`; each goes to the bundler, where there is one, as soon as it is done.
    pub(crate) async fn all(&self, at_once: usize, bundler: Option<&mut Bundler>) -> Result<Made, Diagnostic> {
        let hold = Hold::take(self.work)?;
        self.carry_out(&hold, at_once, bundler, async {}).await?;
        made(self.work, self.wanted, hold)
    }

    /// Makes the scenarios one after the other: nothing waits for anything else.
    ///
    /// # Errors
    /// A work folder that is held, or processes that cannot be started or do not answer.
    pub async fn in_turn(&self) -> Result<Made, Diagnostic> {
        self.all(1, None).await
    }

    /// Makes the scenarios one after the other. What is to be done with them goes on while the processes leave.
    pub(crate) async fn and<T>(&self, then: impl Future<Output = T>) -> Result<(Made, T), Diagnostic> {
        let hold = Hold::take(self.work)?;
        let done = self.carry_out(&hold, 1, None, then).await?;
        Ok((made(self.work, self.wanted, hold)?, done))
    }

    /// Makes the scenarios, each of which goes to the bundler as soon as it is done. The hold is for as long as bundles are
    /// written.
    pub(crate) async fn bundled(&self, bundler: &mut Bundler) -> Result<Hold, Diagnostic> {
        let hold = Hold::take(self.work)?;
        // One of each request, then the next of each: whatever is there when it is stopped is of all kinds.
        let mut wanted = self.wanted.to_vec();
        wanted.sort_by_key(|want| want.index);
        let making = Making { wanted: &wanted, ..*self };
        making.carry_out(&hold, wanted.len(), Some(bundler), async {}).await?;
        Ok(hold)
    }

    /// Starts the system, submits so many at once and waits for them, until all are done; then ends the system, and does
    /// what comes then meanwhile.
    async fn carry_out<T>(
        &self,
        hold: &Hold,
        at_once: usize,
        mut bundler: Option<&mut Bundler>,
        then: impl Future<Output = T>,
    ) -> Result<T, Diagnostic> {
        let Self { talk, config, options, work, wanted } = self;
        let blobs = blobs(work);
        let specs = specs(wanted, config, options, &blobs)?;
        let workers =
            options.workers.unwrap_or_else(|| u32::try_from(config.number("supervisor.workers")).unwrap_or(1));
        let mut supervisor = Supervisor::start(work, config, workers, options.driver.as_deref()).await?;
        let mut asking = match wanted.first().filter(|want| want.prepared.looked_at) {
            Some(want) => {
                Some(Asking::start(talk, config, supervisor.bus.clone(), work, blobs.clone(), want.prepared)?)
            }
            None => None,
        };
        let mut followed = Ok(());
        for (index, some) in specs.chunks(at_once.max(1)).enumerate() {
            let before = u32::try_from(index.saturating_mul(at_once)).unwrap_or(u32::MAX);
            let some = some.to_vec();
            followed = follow(talk, &mut supervisor, hold, some, before, asking.as_mut(), bundler.as_deref_mut()).await;
            if followed.is_err() {
                break;
            }
        }
        talk.clear();
        if let Some(asking) = asking {
            asking.end().await;
        }
        if let Err(why) = followed {
            supervisor.stop().await;
            return Err(why);
        }
        Ok(tokio::join!(then, supervisor.stop()).0)
    }
}

/// Submits and waits until everything is done, besides the `before` that were done earlier.
async fn follow(
    talk: &Printer,
    supervisor: &mut Supervisor,
    hold: &Hold,
    specs: Vec<ScenarioSpec>,
    before: u32,
    mut asking: Option<&mut Asking>,
    mut bundler: Option<&mut Bundler>,
) -> Result<(), Diagnostic> {
    let ids: Vec<ScenarioId> = specs.iter().map(|spec| spec.id.clone()).collect();
    let bus = supervisor.bus.clone();
    let mut notices = bus
        .subscribe(keys::EVENTS, 4096, Overflow::DropOldest)
        .await
        .map_err(|why| Diagnostic::resumes(why.to_string()))?;
    for spec in &specs {
        tracing::info!(scenario = %spec.id, trace_id = trace_of(BATCH, spec).trace_id(), "a scenario is handed in");
    }
    submit(bus.as_ref(), BATCH, Priority::Normal, specs).await?;
    // Listened to all the time: a signal between two rounds must not get lost.
    let mut signals = Signals::listen()?;
    let mut last_heard = Instant::now();
    // Notices hasten; the poll behind them decides.
    let mut poll = tokio::time::interval(Duration::from_millis(if ids.len() > 1 { 500 } else { 100 }));
    let mut looks_done = true;
    let all_of_them = (before as usize).saturating_add(ids.len());
    let mut progress = (ids.len() > 1).then(|| Progress::new(*talk, "making", all_of_them));
    loop {
        // While a person has the terminal, its lines and its Ctrl-C are theirs.
        let looking = asking.as_ref().is_some_and(|asking| asking.is_looking());
        tokio::select! {
            _ = poll.tick() => looks_done = true,
            notice = notices.next() => if let Some((_, body)) = notice
                && let Ok(envelope) = socrates_link::decode::<Notice>("notice", &body) {
                looks_done = ids.len() == 1 && envelope.body.key.stage == socrates_model::job::Stage::Scoring;
                if ids.len() == 1 {
                    passing(talk, asking.as_deref(), &format!("{:<10} {} {}", envelope.body.key.stage.name(), envelope.body.state.name(), envelope.body.remark));
                }
            },
            diagnostic = supervisor.gave_up() => {
                // A folder that is gone is the reason for whatever else its processes complain of.
                hold.check()?;
                return Err(diagnostic);
            }
            diagnostic = left(&mut asking) => return Err(diagnostic),
            _ = signals.interrupt.recv() => if !looking || !talk.live {
                return Err(stopped());
            },
            _ = signals.terminate.recv() => return Err(stopped()),
        }
        if !looks_done {
            continue;
        }
        looks_done = false;
        hold.check()?;
        match status(bus.as_ref(), &StatusAsk::default()).await {
            Ok(reply) => {
                last_heard = Instant::now();
                if let Some(progress) = &mut progress {
                    progress.at(reply.done as usize, &counted(&reply.results));
                } else if let Some(line) = reply.scenarios.first() {
                    passing(talk, asking.as_deref(), &stages::line_of(line));
                }
                if let Some(bundler) = &mut bundler {
                    bundler.look()?;
                }
                if reply.done >= before.saturating_add(u32::try_from(ids.len()).unwrap_or(u32::MAX)) {
                    return Ok(());
                }
            }
            Err(why) if last_heard.elapsed() > AWAY => {
                return Err(Diagnostic::resumes(format!("the orchestrator does not answer: {why}")));
            }
            Err(_) => {}
        }
    }
}

/// `20 realised, 3 contradicted, 1 failed`.
fn counted(results: &BTreeMap<ScenarioEnd, u32>) -> String {
    let mut rows: Vec<(&ScenarioEnd, &u32)> = results.iter().collect();
    rows.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    rows.iter().map(|(result, count)| format!("{count} {result}")).collect::<Vec<_>>().join(", ")
}

/// Writes a passing line, but not over what a person types.
fn passing(talk: &Printer, asking: Option<&Asking>, text: &str) {
    match asking {
        Some(asking) => asking.passing(talk, text),
        None => talk.passing(text),
    }
}

/// Ends when the person who looks leaves; never where nobody looks.
async fn left(asking: &mut Option<&mut Asking>) -> Diagnostic {
    match asking {
        Some(asking) => asking.left().await,
        None => std::future::pending().await,
    }
}
