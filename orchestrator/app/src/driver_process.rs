//! A driver that is started with a run, or to be checked.

use std::os::fd::AsFd as _;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Duration;

use socrates_kit::Stop;
use socrates_link::Presence;
use tokio::process::Child;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;

use crate::child::{command, ended, leave};
use crate::exit::Diagnostic;

/// Starts in a row without a claim after which it is not started again.
const IDLE: u32 = 2;

/// The command that starts a driver, and where it finds the bus.
#[derive(Debug, Clone)]
pub(crate) struct DriverCommand {
    line: String,
    program: PathBuf,
    args: Vec<String>,
    endpoint: String,
    namespace: String,
}

impl DriverCommand {
    /// Reads a command line as a shell would.
    pub(crate) fn read(line: &str, endpoint: &str, namespace: &str) -> Result<Self, Diagnostic> {
        let mut words = shlex::split(line).unwrap_or_default().into_iter();
        let Some(program) = words.next() else {
            let hint = "write --driver \"python3 my_planner.py\", for example; quotation marks come in pairs";
            return Err(Diagnostic::input(format!("`--driver {line}` is no command"), hint));
        };
        let (endpoint, namespace) = (endpoint.to_owned(), namespace.to_owned());
        Ok(Self { line: line.to_owned(), program: PathBuf::from(program), args: words.collect(), endpoint, namespace })
    }

    /// Starts it. It leaves when its standard input closes; what it prints goes beside our own words, so that results stay alone on
    /// standard output.
    pub(crate) fn start(&self) -> Result<Child, Diagnostic> {
        let cannot = |why: std::io::Error| {
            let hint = "name a program of the search path, or its path";
            Diagnostic::input(format!("the driver `{}` cannot be started: {why}", self.line), hint)
        };
        let said = std::io::stderr().as_fd().try_clone_to_owned().map_err(cannot)?;
        command(&self.program)
            .args(&self.args)
            .env("SOCRATES_ENDPOINT", &self.endpoint)
            .env("SOCRATES_NAMESPACE", &self.namespace)
            .env("SOCRATES_TIED", "1")
            .stdout(Stdio::from(said))
            .spawn()
            .map_err(cannot)
    }

    /// Keeps it alive until told to stop. A driver that dies in a run is started again, for the other runs; one that never claims a
    /// name is not.
    pub(crate) async fn keep(
        self,
        mut child: Child,
        mut claims: Presence,
        mut stopped: watch::Receiver<Stop>,
        report: mpsc::Sender<Diagnostic>,
    ) {
        let mut idle = 0;
        loop {
            let pipe = child.stdin.take();
            let Some(status) = ended(&mut child, &mut stopped).await else { return leave(child, pipe, "driver").await };
            let mut claimed = false;
            while let Ok(Some((_, alive))) = timeout(Duration::ZERO, claims.next()).await {
                claimed |= alive;
            }
            idle = if claimed { 0 } else { idle + 1 };
            let how = status.map_or_else(|why| why.to_string(), |status| status.to_string());
            let next = if idle < IDLE {
                tracing::warn!(how, "the driver died and is started again");
                self.start()
            } else {
                let what = format!("the driver `{}` ends by itself ({how})", self.line);
                let hint = "start it by hand to see why; it has to stay until its standard input closes";
                Err(Diagnostic::input(what, hint))
            };
            match next {
                Ok(next) => child = next,
                Err(diagnostic) => return drop(report.send(diagnostic).await),
            }
        }
    }
}
