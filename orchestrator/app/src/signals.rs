//! The signals that end a run.

use tokio::signal::unix::{Signal, SignalKind, signal};

use crate::exit::{Code, Diagnostic};

/// The signals that end a run, from the moment on at which they are listened to: from then on nobody else hears them.
#[derive(Debug)]
pub(crate) struct Signals {
    /// SIGINT, which is Ctrl-C.
    pub(crate) interrupt: Signal,
    /// SIGTERM.
    pub(crate) terminate: Signal,
}

impl Signals {
    /// Begins to listen.
    pub(crate) fn listen() -> Result<Self, Diagnostic> {
        let on = |kind| signal(kind).map_err(|why| Diagnostic::resumes(why.to_string()));
        Ok(Self { interrupt: on(SignalKind::interrupt())?, terminate: on(SignalKind::terminate())? })
    }

    /// Waits for one of them and says what it means.
    pub(crate) async fn come(&mut self) -> Diagnostic {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
        stopped()
    }
}

/// What is said where one of them has come.
pub(crate) fn stopped() -> Diagnostic {
    Diagnostic::input("stopped before the end; nothing is lost", "the same command again resumes")
        .with_code(Code::Waits)
}
