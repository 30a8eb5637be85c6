//! A batch of an experiment on real processes, and what strikes them.
//!
//! ```text
//! this process, the router ─┬─► orchestrator, a process with its store on disk ─► scenarios that ended ─┐
//!                           └─► workers, a process each ─► lines: begins, strike me now, ends ──────────┼─► what was observed
//!                kill -9, SIGSTOP, SIGCONT, seen by the kernel's word ──────────────────────────────────┘
//! ```

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use socrates_experiment::spec::{Cell, Spec};
use socrates_experiment::{BATCH, Kind, Observed, Played, Told, asked, texts};
use socrates_link::{Bus, keys};
use socrates_model::job::{JobKey, Stage};
use socrates_model::wire::{PastEnd, Priority};
use socrates_store::{Reader, audit};
use tokio::io::{AsyncBufReadExt as _, BufReader};
use tokio::process::{Child, ChildStdin};
use tokio::sync::mpsc;
use tokio::time::Instant;

use super::player::SINCE;
use crate::child::{command, leave};
use crate::config::Config;
use crate::crew::ours;
use crate::exit::{Code, Diagnostic};
use crate::router::Router;
use crate::{calls, work};

/// Namespace of the bus of an experiment.
pub(super) const NAMESPACE: &str = "experiment";
/// Lines that wait to be heard at most.
const HEARD: usize = 1024;
/// Pause between two looks at the ends of scenarios and at processes that ended by themselves: how exact a measured end is.
const LOOK: Duration = Duration::from_millis(25);
/// Longest time until all processes are there.
const START: Duration = Duration::from_secs(60);
/// How long nothing at all may happen, beyond the longest wait that the experiment itself knows.
const STILL: Duration = Duration::from_secs(60);
/// How long a process may take to stop, or to go on.
const STOPPING: Duration = Duration::from_secs(2);
/// Deaths of processes that nobody caused, after which a batch is given up.
const MOST_FELL: u32 = 20;

/// What the batches of an experiment have in common.
pub(super) struct Site<'a> {
    pub(super) config: &'a Config,
    pub(super) spec: &'a Spec,
    /// The same, for the processes to read.
    pub(super) file: &'a Path,
    /// Folder for job stores, artifacts and logs.
    pub(super) root: &'a Path,
}

/// What comes from outside.
enum Heard {
    /// A line of a worker, with its place and its life.
    Line(usize, u32, Told, Instant),
    /// How scenarios stand.
    Ends(Vec<PastEnd>, Instant),
    /// An orchestrator serves.
    Rose(Instant),
}

/// A place at which a process stands.
struct Post {
    /// Stage of a worker; none for the orchestrator.
    stage: Option<Stage>,
    name: String,
    child: Child,
    pipe: Option<ChildStdin>,
    /// How often one was started here.
    life: u32,
    /// Until when it is stopped.
    frozen_until: Option<Instant>,
}

/// Plays a batch of a cell: starts everything, does the faults that workers say are due, and reads what the store holds in the end.
pub(super) async fn play(site: &Site<'_>, cell: &Cell, batch: u32) -> Result<Played, Diagnostic> {
    let dir = site.root.join(format!("cell-{}-batch-{batch}", cell.number));
    std::fs::create_dir_all(&dir).map_err(|why| unwritten(&dir, &why))?;
    let mut scenarios = asked(site.spec, cell, batch);
    let blobs = work::blobs(&dir);
    for text in texts(&scenarios) {
        blobs.put(text.as_bytes()).map_err(|why| ours(&why.to_string()))?;
    }
    let Router { bus, socket, endpoint } = Router::open(&dir, site.config, NAMESPACE).await?;
    let (tell, heard) = mpsc::channel(HEARD);
    let mut crowd = Crowd { site, cell, dir: dir.clone(), endpoint, posts: Vec::new(), tell, fell: 0 };
    let listens = listen(Arc::clone(&bus), crowd.tell.clone()).await?;
    let played = async {
        crowd.start_all()?;
        crowd.gathered(bus.as_ref()).await?;
        let since = socrates_link::wall_ms().to_string();
        for (_, scenario) in &mut scenarios {
            scenario.settings.insert(SINCE.to_owned(), since.clone());
        }
        let begun = Instant::now();
        let wanted = scenarios.iter().map(|(_, scenario)| scenario.clone()).collect();
        calls::submit(bus.as_ref(), BATCH, Priority::Normal, wanted).await?;
        let mut course = Course { observed: Observed::of(&scenarios), begun, heard, due: VecDeque::new(), up: true };
        course.run(&mut crowd).await?;
        Ok::<Observed, Diagnostic>(course.observed)
    }
    .await;
    listens.abort();
    crowd.leave().await;
    bus.close().await;
    drop(socket);
    let observed = played?;
    let store = work::store(&dir);
    let rows = Reader::open(&store).and_then(|reader| reader.all()).map_err(work::unread)?;
    let wrong = audit(&store).map_err(work::unread)?.wrong();
    if wrong.is_empty() {
        drop(std::fs::remove_dir_all(&dir));
    }
    Ok(observed.closed(cell, rows, wrong))
}

fn unwritten(dir: &Path, why: &std::io::Error) -> Diagnostic {
    Diagnostic::input(format!("cannot write into `{}`: {why}", dir.display()), "--out chooses another folder")
}

/// Tells of orchestrators that begin to serve, and of scenarios that end, until it is aborted.
async fn listen(bus: Arc<dyn Bus>, tell: mpsc::Sender<Heard>) -> Result<tokio::task::JoinHandle<()>, Diagnostic> {
    let mut presence = bus.watch_alive(keys::ORCHESTRATORS_ALIVE).await.map_err(|why| ours(&why.to_string()))?;
    let ends = async move {
        let (bus, tell) = (bus, tell);
        let mut done = 0;
        loop {
            tokio::select! {
                biased;
                token = presence.next() => match token {
                    Some((_, true)) => drop(tell.send(Heard::Rose(Instant::now())).await),
                    Some((_, false)) => {}
                    None => return,
                },
                () = tokio::time::sleep(LOOK) => {
                    let Ok(reply) = calls::counts(bus.as_ref(), "").await else { continue };
                    let at = Instant::now();
                    if reply.done != done && let Ok(ends) = calls::ends(bus.as_ref()).await {
                        done = reply.done;
                        drop(tell.send(Heard::Ends(ends, at)).await);
                    }
                }
            }
        }
    };
    Ok(tokio::spawn(ends))
}

/// The processes of a batch.
struct Crowd<'a> {
    site: &'a Site<'a>,
    cell: &'a Cell,
    dir: PathBuf,
    endpoint: String,
    /// The orchestrator first.
    posts: Vec<Post>,
    tell: mpsc::Sender<Heard>,
    /// How many ended without anybody's doing.
    fell: u32,
}

impl Crowd<'_> {
    fn start_all(&mut self) -> Result<(), Diagnostic> {
        let mut places = vec![(None, "orchestrator".to_owned())];
        for stage in Stage::WORKERS {
            let of = |number: u32| (Some(stage), format!("{stage}-{number}"));
            places.extend((1..=self.site.spec.workers.of(stage)).map(of));
        }
        for (stage, name) in places {
            let place = self.posts.len();
            let (child, pipe) = self.spawn(stage, &name, place, 0)?;
            self.posts.push(Post { stage, name, child, pipe, life: 0, frozen_until: None });
        }
        Ok(())
    }

    /// Starts a process; what it says on standard output is heard, what it logs goes into a file.
    fn spawn(
        &self,
        stage: Option<Stage>,
        name: &str,
        place: usize,
        life: u32,
    ) -> Result<(Child, Option<ChildStdin>), Diagnostic> {
        let log = self.dir.join(format!("{name}.log"));
        let log =
            std::fs::OpenOptions::new().create(true).append(true).open(&log).map_err(|why| unwritten(&log, &why))?;
        let mut command = command(self.site.config.executable()?);
        command.arg("play").arg("--spec").arg(self.site.file).arg("--cell").arg(self.cell.number.to_string());
        command.arg("--connect").arg(&self.endpoint).arg("--dir").arg(&self.dir).arg("--name").arg(name);
        if let Some(stage) = stage {
            command.args(["--stage", stage.name()]);
        }
        command.args(self.site.config.passed_on()).stderr(Stdio::from(log));
        let mut child = command.spawn().map_err(|why| ours(&format!("the {name} process cannot be started: {why}")))?;
        let pipe = child.stdin.take();
        if let Some(out) = child.stdout.take() {
            let tell = self.tell.clone();
            drop(tokio::spawn(async move {
                let mut lines = BufReader::new(out).lines();
                while let Ok(Some(line)) = lines.next_line().await {
                    if let Ok(told) = serde_json::from_str(&line)
                        && tell.send(Heard::Line(place, life, told, Instant::now())).await.is_err()
                    {
                        return;
                    }
                }
            }));
        }
        Ok((child, pipe))
    }

    /// Starts the next process at a place.
    fn again(&mut self, place: usize) -> Result<(), Diagnostic> {
        let Some(post) = self.posts.get(place) else { return Ok(()) };
        let (stage, name, life) = (post.stage, post.name.clone(), post.life.saturating_add(1));
        let (child, pipe) = self.spawn(stage, &name, place, life)?;
        if let Some(post) = self.posts.get_mut(place) {
            *post = Post { stage, name, child, pipe, life, frozen_until: None };
        }
        Ok(())
    }

    /// Waits until every worker is known to the orchestrator.
    async fn gathered(&mut self, bus: &dyn Bus) -> Result<(), Diagnostic> {
        let begun = Instant::now();
        while begun.elapsed() < START {
            if let Ok(reply) = calls::counts(bus, "").await
                && calls::is_staffed(&reply, |stage| self.site.spec.workers.of(stage))
            {
                return Ok(());
            }
            tokio::time::sleep(LOOK).await;
        }
        Err(ours(&format!(
            "not all processes came within {} s; their logs are in `{}`",
            START.as_secs(),
            self.dir.display()
        )))
    }

    /// Kills the process at a place and starts another; whether it was this signal that ended it.
    async fn kill(&mut self, place: usize) -> Result<bool, Diagnostic> {
        use std::os::unix::process::ExitStatusExt as _;
        let Some(post) = self.posts.get_mut(place) else { return Ok(false) };
        let sent = post.child.start_kill().is_ok();
        let ended = post.child.wait().await;
        self.again(place)?;
        Ok(sent && ended.is_ok_and(|status| status.signal() == Some(Signal::KILL.as_raw())))
    }

    /// Stops the process at a place for a while; whether the kernel says that it is stopped.
    async fn freeze(&mut self, place: usize) -> bool {
        let until = Instant::now() + Duration::from_millis(self.site.spec.times_ms.cut);
        let Some(post) = self.posts.get_mut(place) else { return false };
        post.frozen_until = Some(until);
        signaled(&post.child, Signal::STOP) && becomes(&post.child, true).await
    }

    /// Lets those go on whose time has come, all of them at the end; places that did not.
    async fn thaw(&mut self, all: bool) -> Vec<usize> {
        let mut stuck = Vec::new();
        for (place, post) in self.posts.iter_mut().enumerate() {
            if post.frozen_until.is_none_or(|until| !all && until > Instant::now()) {
                continue;
            }
            post.frozen_until = None;
            if !(signaled(&post.child, Signal::CONT) && becomes(&post.child, false).await) {
                stuck.push(place);
            }
        }
        stuck
    }

    /// When the next is to go on.
    fn thaws_at(&self) -> Option<Instant> {
        self.posts.iter().filter_map(|post| post.frozen_until).min()
    }

    /// Starts again what ended by itself, and says what.
    fn tend(&mut self) -> Result<Vec<String>, Diagnostic> {
        let mut words = Vec::new();
        for place in 0..self.posts.len() {
            let Some(post) = self.posts.get_mut(place) else { continue };
            let Ok(Some(status)) = post.child.try_wait() else { continue };
            words.push(format!("the process of {} ended by itself: {status}", post.name));
            self.fell += 1;
            if self.fell > MOST_FELL {
                return Err(ours(&format!("{} times a process ended by itself, last: {}", self.fell, words.concat())));
            }
            self.again(place)?;
        }
        Ok(words)
    }

    /// Asks everybody to leave, the workers first, and waits for them.
    async fn leave(mut self) {
        drop(self.thaw(true).await);
        let mut posts = self.posts;
        let orchestrator = if posts.is_empty() { None } else { Some(posts.remove(0)) };
        for post in &mut posts {
            drop(post.pipe.take());
        }
        for post in posts.into_iter().chain(orchestrator) {
            leave(post.child, post.pipe, &post.name).await;
        }
    }
}

fn signaled(child: &Child, signal: Signal) -> bool {
    let id = child.id().and_then(|id| i32::try_from(id).ok()).and_then(Pid::from_raw);
    id.is_some_and(|id| kill_process(id, signal).is_ok())
}

/// Whether the kernel comes to say that a process is stopped, or that it is not.
async fn becomes(child: &Child, stopped: bool) -> bool {
    let Some(id) = child.id() else { return false };
    let begun = Instant::now();
    while begun.elapsed() < STOPPING {
        // The letter after the name in brackets: `T` where it is stopped.
        let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        match stat.rsplit_once(") ").and_then(|(_, rest)| rest.chars().next()) {
            Some(letter) if (letter == 'T') == stopped => return true,
            Some(_) => tokio::time::sleep(Duration::from_millis(1)).await,
            None => return false,
        }
    }
    false
}

/// The course of a batch.
struct Course {
    observed: Observed,
    begun: Instant,
    heard: mpsc::Receiver<Heard>,
    /// Attempts over whose reports the orchestrator is to be killed yet.
    due: VecDeque<(JobKey, u32)>,
    /// Whether the orchestrator serves, as far as is known.
    up: bool,
}

impl Course {
    fn since(&self, at: Instant) -> u64 {
        u64::try_from(at.saturating_duration_since(self.begun).as_millis()).unwrap_or(u64::MAX)
    }

    /// Until every scenario has ended.
    async fn run(&mut self, crowd: &mut Crowd<'_>) -> Result<(), Diagnostic> {
        let (times, policy) = (&crowd.site.spec.times_ms, &crowd.cell.policy);
        let longest =
            times.timeout.saturating_add(times.cut).saturating_add(policy.cap_ms).saturating_add(policy.lease_ms);
        let patience = STILL + Duration::from_millis(longest);
        let mut last = Instant::now();
        while self.observed.open() > 0 {
            let thaws_at = crowd.thaws_at();
            let wait = LOOK.min(thaws_at.map_or(LOOK, |at| at.saturating_duration_since(Instant::now())));
            if let Ok(heard) = tokio::time::timeout(wait, self.heard.recv()).await {
                last = Instant::now();
                let Some(heard) = heard else { return Err(ours("nobody tells how the batch stands")) };
                self.hears(crowd, heard).await?;
            }
            if thaws_at.is_some_and(|at| at <= Instant::now()) {
                let stuck = crowd.thaw(false).await;
                stuck.iter().for_each(|_| self.observed.complains("a stopped process did not go on".to_owned()));
            }
            while self.up
                && let Some((key, attempt)) = self.due.pop_front()
            {
                self.kills_orchestrator(crowd, key, attempt).await?;
            }
            for words in crowd.tend()? {
                self.observed.complains(words);
            }
            if last.elapsed() > patience {
                self.observed.complains(format!("nothing happened for {} s", patience.as_secs()));
                return Ok(());
            }
        }
        Ok(())
    }

    async fn hears(&mut self, crowd: &mut Crowd<'_>, heard: Heard) -> Result<(), Diagnostic> {
        match heard {
            Heard::Rose(at) => {
                self.up = true;
                self.observed.rose(self.since(at));
            }
            Heard::Ends(ends, at) => {
                let at = self.since(at);
                let ended = ends.into_iter().filter_map(|one| Some((one.scenario, one.end?)));
                ended.for_each(|(id, end)| self.observed.ended(at, &id, end));
            }
            Heard::Line(place, life, Told::Strikes { key, attempt, kind }, _) => {
                // One that died meanwhile is struck by nothing more.
                let living = crowd.posts.get(place).is_some_and(|post| post.life == life);
                let at = Instant::now();
                let struck = if kind == Kind::OrchestratorKill {
                    self.due.push_back((key.clone(), attempt));
                    false
                } else if kind == Kind::WorkerKill && living {
                    crowd.kill(place).await?
                } else {
                    kind == Kind::WorkerFreeze && living && crowd.freeze(place).await
                };
                if struck {
                    self.observed.struck(self.since(at), kind, key, attempt);
                }
            }
            Heard::Line(_, _, told, at) => self.observed.told(self.since(at), told),
        }
        Ok(())
    }

    /// Kills the orchestrator, which serves.
    async fn kills_orchestrator(&mut self, crowd: &mut Crowd<'_>, key: JobKey, attempt: u32) -> Result<(), Diagnostic> {
        let at = Instant::now();
        self.up = false;
        if crowd.kill(0).await? {
            self.observed.struck(self.since(at), Kind::OrchestratorKill, key, attempt);
        }
        Ok(())
    }
}

/// Reads of a diagnostic that it is about what was played, and nobody's input.
pub(super) fn about(cell: usize, why: Diagnostic) -> Diagnostic {
    Diagnostic { what: format!("cell {cell} could not be played: {}", why.what), ..why }.with_code(Code::Ours)
}
