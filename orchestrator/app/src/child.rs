//! How a child process is started and leaves.

use std::ffi::OsStr;
use std::process::{ExitStatus, Stdio};
use std::time::Duration;

use socrates_kit::Stop;
use tokio::process::{Child, ChildStdin, Command};
use tokio::sync::watch;

/// How long a child may take to leave before it is ended.
const LEAVE_LIMIT: Duration = Duration::from_secs(3);

/// The command of a child. Its standard input is held here: closing it asks the child to leave. Ctrl-C reaches this process alone, and a
/// child whose owner is dropped is ended.
pub(crate) fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit()).kill_on_drop(true).process_group(0);
    command
}

/// How a child ended; none where it is told to stop before, or nobody can tell it any more.
pub(crate) async fn ended(
    child: &mut Child,
    stopped: &mut watch::Receiver<Stop>,
) -> Option<std::io::Result<ExitStatus>> {
    tokio::select! {
        status = child.wait() => Some(status),
        changed = stopped.wait_for(|stop| *stop != Stop::Run) => {
            drop(changed);
            None
        }
    }
}

/// Ends a child: closing its standard input asks it to leave.
pub(crate) async fn leave(mut child: Child, pipe: Option<ChildStdin>, name: &str) {
    drop(pipe);
    if tokio::time::timeout(LEAVE_LIMIT, child.wait()).await.is_err()
        && let Err(why) = child.kill().await
    {
        tracing::warn!(role = name, %why, "a child could not be ended");
    }
}
