//! How a child process leaves.

use std::time::Duration;

use tokio::process::{Child, ChildStdin};

/// How long a child may take to leave before it is ended.
const LEAVE_LIMIT: Duration = Duration::from_secs(3);

/// Ends a child: closing its standard input asks it to leave.
pub(crate) async fn leave(mut child: Child, pipe: Option<ChildStdin>, name: &str) {
    drop(pipe);
    if tokio::time::timeout(LEAVE_LIMIT, child.wait()).await.is_err()
        && let Err(why) = child.kill().await
    {
        tracing::warn!(role = name, %why, "a child could not be ended");
    }
}
