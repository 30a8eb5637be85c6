//! `view`: runs in a browser, in Foxglove or Lichtblick, while they happen and afterwards.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use socrates_app::config::Config;
use socrates_app::output::Printer;
use socrates_app::view::{self, ViewOptions};

use super::keys::Keys;
use super::{Outcome, done};

/// Arguments of `view`.
#[derive(Debug, Args)]
pub(crate) struct View {
    /// Folder of a run, bundle, folder of bundles, or an endpoint of the bus such as `tcp/127.0.0.1:7447@main`.
    #[arg(default_value = ".")]
    what: String,
    /// Open a browser.
    #[arg(long)]
    open: bool,
    /// Address to listen on; default a free port of this machine alone, from 8780 on. Where other machines can reach it, they need the
    /// token that is printed.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<SocketAddr>,
    /// File with the token that viewers need, at least 32 letters and digits; default a new one where one is needed.
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// Name under which this machine may be asked for, besides localhost and its addresses; may be repeated.
    #[arg(long, value_name = "NAME")]
    allow_host: Vec<String>,
    /// Pages of others that may look, such as `https://app.foxglove.dev`; may be repeated.
    #[arg(long, value_name = "ORIGIN")]
    allow_origin: Vec<String>,
    /// Pages of others that may show ours in a frame; may be repeated.
    #[arg(long, value_name = "ORIGIN")]
    allow_frame: Vec<String>,
    /// Certificate chain, PEM: viewers then come over https and wss.
    #[arg(long, value_name = "FILE", requires = "key")]
    cert: Option<PathBuf>,
    /// Its key, PEM.
    #[arg(long, value_name = "FILE", requires = "cert")]
    key: Option<PathBuf>,
    /// Connections at once.
    #[arg(long, default_value_t = 256)]
    max_clients: usize,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    pub(super) tied: bool,
    #[command(flatten)]
    keys: Keys,
}

impl View {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let config = &self.keys.over(config)?;
        let options = ViewOptions {
            what: self.what.clone(),
            listen: self.listen,
            open: self.open,
            token_file: self.token_file.clone(),
            hosts: self.allow_host.clone(),
            origins: self.allow_origin.clone(),
            frames: self.allow_frame.clone(),
            tls: self.cert.clone().zip(self.key.clone()),
            most: self.max_clients,
            tied: self.tied,
        };
        done(view::view(talk, config, &options).await)
    }
}
