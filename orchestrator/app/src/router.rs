//! The bus of a folder: a router on a socket that its user alone can enter, and the file that names it.

use std::path::Path;
use std::sync::Arc;

use socrates_link::{Bus, Mode, ZenohConfig};
use tempfile::TempDir;

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::folder;

/// File in the work folder that tells `watch`, `status`, drivers and viewers where to connect, for its owner alone. Its lines:
/// the endpoint of the bus, the namespace, and the folder of the shared memory where the run has one.
pub(crate) const ENDPOINT_FILE: &str = "endpoint";
/// How the endpoint of a socket begins.
pub(crate) const SOCKET: &str = "unixsock-stream/";

/// The bus of one process with its children and guests.
pub(crate) struct Router {
    /// The bus, with this process as its router.
    pub(crate) bus: Arc<dyn Bus>,
    /// Closed to other users; removed with this.
    pub(crate) socket: TempDir,
    /// Where to connect.
    pub(crate) endpoint: String,
}

impl Router {
    /// Opens it, and names it in the work folder.
    pub(crate) async fn open(work: &Path, config: &Config, namespace: &str) -> Result<Self, Diagnostic> {
        if let Some((before, _)) = read_endpoint(work)
            && let Some(socket) = before.strip_prefix(SOCKET)
        {
            folder::remove_socket_folder(Path::new(socket));
        }
        let socket = folder::socket_folder(work, &config.program().temp)?;
        let endpoint = format!("{SOCKET}{}", folder::socket(socket.path()).display());
        let bus = listen(&endpoint, config.number("supervisor.port"), namespace).await?;
        let shared = crate::process::shared_memory(config).root;
        let places = format!("{endpoint}\n{namespace}\n{}\n", shared.display());
        folder::write_private(&work.join(ENDPOINT_FILE), &places).map_err(|why| {
            Diagnostic::input(format!("cannot write into `{}`: {why}", work.display()), "--out chooses another folder")
        })?;
        Ok(Self { bus, socket, endpoint })
    }
}

async fn listen(endpoint: &str, port: u64, namespace: &str) -> Result<Arc<dyn Bus>, Diagnostic> {
    let mut config = ZenohConfig::new(Mode::Router, namespace, "supervisor").listen(endpoint);
    if port != 0 {
        config = config.listen(&format!("tcp/127.0.0.1:{port}"));
    }
    socrates_link::join(config).await.map_err(|why| {
        let hint = "set supervisor.port to 0 for none, or to a free one; `socrates doctor` checks this machine";
        Diagnostic::input(format!("the bus of the run cannot be opened: {why}"), hint)
    })
}

/// Endpoint and namespace that a work folder names.
pub(crate) fn read_endpoint(work: &Path) -> Option<(String, String)> {
    let text = std::fs::read_to_string(work.join(ENDPOINT_FILE)).ok()?;
    let mut lines = text.lines();
    Some((lines.next()?.to_owned(), lines.next().unwrap_or("main").to_owned()))
}
