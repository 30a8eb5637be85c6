//! Children that work together: each is kept alive, and all are asked to leave together.
//!
//! A child that dies is started again, unless it says that this would not help.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Duration;

use socrates_kit::Stop;
use tokio::io::AsyncReadExt as _;
use tokio::process::{Child, ChildStdin};
use tokio::sync::{mpsc, watch};
use tokio::task::{AbortHandle, JoinHandle};
use tokio::time::Instant;

use crate::child::{command, ended, leave};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};

/// Deaths of a child in a minute after which it is not started again at once.
const SUDDEN: u32 = 3;
/// First pause before a child that dies again and again is started again; it doubles with every death.
const PAUSE: Duration = Duration::from_millis(50);
/// Longest such pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);
/// Longest time in which children that are asked to leave at once are gone. Each is killed much earlier: this is for one whose end
/// is never reported, so that a run whose bundle is written ends.
const GONE_LIMIT: Duration = Duration::from_secs(15);
/// Most of what a child says at its end that is read, bytes.
const LAST_WORDS: u64 = 64 * 1024;
/// Pools of memory of a process, for the C library of most Linux systems: with one for each of its threads a worker keeps twice
/// what it needs.
const ARENAS: (&str, &str) = ("MALLOC_ARENA_MAX", "2");

/// Children that leave together.
pub(crate) struct Crew {
    /// What they are asked for.
    pub(crate) stop: watch::Sender<Stop>,
    /// Those who keep one child alive each.
    pub(crate) keepers: Vec<JoinHandle<()>>,
}

impl Crew {
    /// Nobody yet.
    pub(crate) fn new() -> Self {
        Self { stop: watch::Sender::new(Stop::Run), keepers: Vec::new() }
    }

    /// Starts a child and keeps it alive until it died so often in a minute.
    pub(crate) fn add(
        &mut self,
        role: Member,
        report: mpsc::Sender<Diagnostic>,
        restarts: usize,
    ) -> Result<(), Diagnostic> {
        let child = spawn(&role, &role.first)?;
        self.keepers.push(tokio::spawn(keep(role, child, self.stop.subscribe(), report, restarts)));
        Ok(())
    }

    /// Asks the children to leave at once, and waits until they have; a child that is not seen to leave is killed.
    pub(crate) async fn leave(self) {
        self.leave_within(GONE_LIMIT).await;
    }

    async fn leave_within(self, limit: Duration) {
        self.stop.send_replace(Stop::Now);
        let keepers: Vec<AbortHandle> = self.keepers.iter().map(JoinHandle::abort_handle).collect();
        if tokio::time::timeout(limit, self.ended()).await.is_err() {
            tracing::warn!(limit_s = limit.as_secs(), "children were not seen to leave, and are killed");
            // Whoever keeps a child owns it, and a child whose owner is dropped is killed.
            keepers.iter().for_each(AbortHandle::abort);
        }
    }

    /// Asks the children to finish what they hold and to leave.
    pub(crate) fn drain(&self) {
        self.stop.send_replace(Stop::Drain);
    }

    /// Waits until every child has left.
    pub(crate) async fn ended(self) {
        for keeper in self.keepers {
            if let Err(why) = keeper.await {
                tracing::warn!(%why, "a keeper ended early");
            }
        }
    }
}

/// What a child is started with.
#[derive(Debug, Clone)]
pub(crate) struct Member {
    /// What it is called in messages.
    pub(crate) name: String,
    args: Vec<String>,
    /// What it is told besides when it is started for the first time.
    pub(crate) first: Vec<String>,
    /// The program that plays it.
    program: PathBuf,
    /// Whether the environment says nothing of [`ARENAS`].
    few_arenas: bool,
}

impl Member {
    /// A child of this program with these arguments, and those that are passed on to every child.
    pub(crate) fn new(config: &Config, name: &str, own: Vec<String>, first: Vec<String>) -> Result<Self, Diagnostic> {
        let mut args = own;
        args.extend_from_slice(config.passed_on());
        let program = config.executable()?.to_path_buf();
        Ok(Self { name: name.to_owned(), args, first, program, few_arenas: config.variable(ARENAS.0).is_none() })
    }
}

/// A fault of ours.
pub(crate) fn ours(what: &str) -> Diagnostic {
    Diagnostic::input(what, "`socrates doctor` checks this machine").with_code(Code::Ours)
}

fn spawn(role: &Member, more: &[String]) -> Result<Child, Diagnostic> {
    let mut command = command(&role.program);
    if role.few_arenas {
        command.env(ARENAS.0, ARENAS.1);
    }
    command
        .args(&role.args)
        .args(more)
        .spawn()
        .map_err(|why| ours(&format!("the {} process cannot be started: {why}", role.name)))
}

/// What a child said last: why it ended.
async fn last_words(child: &mut Child) -> Option<Diagnostic> {
    let mut words = Vec::new();
    child.stdout.take()?.take(LAST_WORDS).read_to_end(&mut words).await.ok()?;
    Diagnostic::of_object(&serde_json::from_slice(&words).ok()?)
}

/// How long to wait before a child is started again that died so often in the last minute.
fn pause(deaths: usize) -> Duration {
    let again = u32::try_from(deaths).unwrap_or(u32::MAX).saturating_sub(SUDDEN);
    if again == 0 { Duration::ZERO } else { PAUSE.saturating_mul(1 << again.min(10)).min(LONGEST_PAUSE) }
}

/// Sees a child off that is asked to leave: at once, or when it has finished what it holds.
async fn drained(mut child: Child, pipe: Option<ChildStdin>, stopped: &mut watch::Receiver<Stop>, name: &str) {
    let asked = *stopped.borrow();
    if asked == Stop::Drain {
        let id = child.id().and_then(|id| i32::try_from(id).ok()).and_then(rustix::process::Pid::from_raw);
        if let Some(Err(why)) = id.map(|id| rustix::process::kill_process(id, rustix::process::Signal::TERM)) {
            tracing::warn!(role = name, %why, "a child could not be asked to finish");
        }
        tokio::select! {
            _left = child.wait() => return,
            _now = stopped.wait_for(|stop| *stop == Stop::Now) => {}
        }
    }
    leave(child, pipe, name).await;
}

/// Keeps one child alive until told to stop.
async fn keep(
    role: Member,
    mut child: Child,
    mut stopped: watch::Receiver<Stop>,
    report: mpsc::Sender<Diagnostic>,
    restarts: usize,
) {
    let mut deaths: VecDeque<Instant> = VecDeque::new();
    // Waiting for a child closes its standard input, unless somebody else holds the pipe.
    let mut pipe = child.stdin.take();
    loop {
        let Some(status) = ended(&mut child, &mut stopped).await else {
            return drained(child, pipe, &mut stopped, &role.name).await;
        };
        let now = Instant::now();
        deaths.push_back(now);
        while deaths.front().is_some_and(|first| now.duration_since(*first) > Duration::from_secs(60)) {
            deaths.pop_front();
        }
        let stuck = matches!(&status, Ok(status) if status.code() == Some(i32::from(Code::Stuck as u8)));
        let how = status.map_or_else(|why| why.to_string(), |status| status.to_string());
        let words = last_words(&mut child).await;
        let why = words.as_ref().map(|words| words.what.clone()).unwrap_or_default();
        let gave_up = if stuck {
            words
        } else if deaths.len() > restarts {
            let often = format!("the {} process died {} times in a minute, last with {how}", role.name, deaths.len());
            Some(ours(&if why.is_empty() { often } else { format!("{often}: {why}") }))
        } else {
            None
        };
        if let Some(diagnostic) = gave_up {
            // A process of ours that cannot go on is no fault of the input.
            drop(report.send(diagnostic.with_code(Code::Ours)).await);
            return;
        }
        tracing::warn!(role = role.name, how, why, "a child died and is started again");
        tokio::select! {
            () = tokio::time::sleep(pause(deaths.len())) => {}
            _stop = stopped.wait_for(|stop| *stop != Stop::Run) => return,
        }
        match spawn(&role, &[]) {
            Ok(next) => {
                child = next;
                pipe = child.stdin.take();
            }
            Err(why) => {
                drop(report.send(why.with_code(Code::Ours)).await);
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_crew_is_left_whose_end_nobody_reports() {
        let mut crew = Crew::new();
        let (held, dropped) = tokio::sync::oneshot::channel::<()>();
        crew.keepers.push(tokio::spawn(async move {
            std::future::pending::<()>().await;
            drop(held);
        }));
        crew.leave_within(Duration::from_millis(1)).await;
        assert!(dropped.await.is_err(), "what the keeper owned is dropped");
    }

    #[test]
    fn a_child_that_dies_again_and_again_is_started_ever_later() {
        assert_eq!((pause(1), pause(3)), (Duration::ZERO, Duration::ZERO));
        assert!(pause(4) > Duration::ZERO && pause(5) > pause(4));
        assert_eq!(pause(1_000), LONGEST_PAUSE);
        let until_given_up: Duration = (1..=20).map(pause).sum();
        assert!(until_given_up > Duration::from_secs(20), "{until_given_up:?}: no storm");
    }
}
