//! The process that shows a run to viewers, as a child of the one that makes it: whatever becomes of it, the run goes on.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;
use socrates_kit::Stop;
use tokio::io::{AsyncBufReadExt as _, BufReader};
use tokio::process::Child;
use tokio::sync::watch;
use tokio::task::JoinHandle;

use crate::child;
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::signals::Signals;

/// How long it may take to say where it is.
const START_LIMIT: Duration = Duration::from_secs(10);
/// How often it is started again.
const RESTARTS: u32 = 20;
/// Pause before it is started again.
const PAUSE: Duration = Duration::from_millis(200);

/// The viewers' process of a run.
pub(crate) struct Viewing {
    stop: watch::Sender<Stop>,
    keeper: JoinHandle<()>,
}

/// How it is started.
struct Start {
    program: PathBuf,
    args: Vec<String>,
}

impl Start {
    fn child(&self, listen: Option<&str>) -> Result<Child, Diagnostic> {
        child::command(&self.program)
            .args(&self.args)
            .args(listen.into_iter().flat_map(|address| ["--listen", address]))
            .spawn()
            .map_err(|why| ours(&format!("the process for viewers cannot be started: {why}")))
    }
}

fn ours(what: &str) -> Diagnostic {
    Diagnostic::input(what, "`socrates doctor` checks this machine; without --view the run goes on")
        .with_code(Code::Ours)
}

/// The first thing that a child says: where it is.
async fn said(child: &mut Child) -> Option<Value> {
    let mut lines = BufReader::new(child.stdout.as_mut()?).lines();
    let line = tokio::time::timeout(START_LIMIT, lines.next_line()).await.ok()?.ok()??;
    serde_json::from_str(&line).ok()
}

impl Viewing {
    /// Starts it for a folder and says where viewers find it.
    pub(crate) async fn begin(talk: &Printer, config: &Config, folder: &Path) -> Result<Self, Diagnostic> {
        let mut args = vec!["view".to_owned(), folder.display().to_string(), "--tied".to_owned()];
        args.extend(["--format".to_owned(), "json".to_owned()]);
        args.extend_from_slice(config.passed_on());
        let start = Start { program: config.executable()?.to_path_buf(), args };
        let mut child = start.child(None)?;
        let told = said(&mut child).await.ok_or_else(|| ours("the process for viewers did not say where it is"))?;
        let text = |key: &str| told.get(key).and_then(Value::as_str).map(str::to_owned);
        let (Some(page), Some(address)) = (text("view"), text("address")) else {
            let why = Diagnostic::of_object(&told).map_or_else(|| told.to_string(), |why| why.to_string());
            return Err(ours(&why));
        };
        talk.line(&format!("view       {page}"));
        let [foxglove, layout] = ["foxglove", "layout"].map(|key| text(key).unwrap_or_default());
        talk.line(&format!("foxglove   {foxglove} · layout {layout}"));
        let stop = watch::Sender::new(Stop::Run);
        let keeper = tokio::spawn(keep(start, child, address, stop.subscribe()));
        Ok(Self { stop, keeper })
    }

    /// Shows what was made until somebody ends it.
    pub(crate) async fn stay(self, talk: &Printer) -> Result<(), Diagnostic> {
        talk.line("view       stays until Ctrl-C");
        let mut signals = Signals::listen()?;
        let _asked_to_leave = signals.come().await;
        self.leave().await;
        Ok(())
    }

    /// Ends it.
    pub(crate) async fn leave(self) {
        self.stop.send_replace(Stop::Now);
        drop(self.keeper.await);
    }
}

/// Keeps it alive at the same address.
async fn keep(start: Start, mut child: Child, address: String, mut stopped: watch::Receiver<Stop>) {
    for _start in 0..RESTARTS {
        let pipe = child.stdin.take();
        if child::ended(&mut child, &mut stopped).await.is_none() {
            return child::leave(child, pipe, "view").await;
        }
        tracing::warn!("the process for viewers has ended; it is started again");
        tokio::time::sleep(PAUSE).await;
        match start.child(Some(&address)) {
            Ok(again) => child = again,
            Err(why) => {
                tracing::warn!(%why, "nobody can watch any more; the run goes on");
                return;
            }
        }
        if said(&mut child).await.is_none() {
            tracing::debug!("the process for viewers did not say where it is");
        }
    }
}
