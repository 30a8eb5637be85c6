//! `view`: a run in a browser, in Foxglove or Lichtblick, and as files, while it happens and afterwards.
//!
//! ```text
//! bus of the folder, as soon as there is one ─┐
//! bundles of the folder ──────────────────────┴─► gateway: one port, loopback, read-only
//! ```

mod shelves;
pub(crate) mod viewing;

use std::io::Read as _;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use socrates_gateway::guard::{Rules, TOKEN_CHARS};
use socrates_gateway::http::Policy;
use socrates_gateway::{Gateway, Tls};
use tokio::net::TcpListener;

use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::process::leave;
use shelves::{Folder, Place, Runs};

/// Ports that are tried one after the other where none is named.
const PORTS: std::ops::Range<u16> = 8780..8790;

/// What is shown, and to whom.
#[derive(Debug, Clone)]
pub struct ViewOptions {
    /// Folder of a run, bundle, folder of bundles, or an endpoint of the bus.
    pub what: String,
    /// Address to listen on; none for a port of this machine alone that is free.
    pub listen: Option<SocketAddr>,
    /// Whether a browser is opened.
    pub open: bool,
    /// File with the token of those who may look; without one a token is made where one is needed.
    pub token_file: Option<PathBuf>,
    /// Names under which this machine may be asked for.
    pub hosts: Vec<String>,
    /// Pages of others that may look.
    pub origins: Vec<String>,
    /// Pages of others that may show ours in a frame.
    pub frames: Vec<String>,
    /// Certificate and key, PEM.
    pub tls: Option<(PathBuf, PathBuf)>,
    /// Connections at once.
    pub most: usize,
    /// Leave when standard input closes.
    pub tied: bool,
}

/// Shows it until it is told to leave.
pub async fn view(talk: &Printer, config: &Config, options: &ViewOptions) -> Result<(), Diagnostic> {
    let place = Place::of(&options.what)?;
    place.check(config)?;
    let listener = listen(options).await?;
    let address = listener.local_addr().map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
    let rules = rules(options, &address)?;
    let policy = Policy::letting(&options.frames)
        .map_err(|why| Diagnostic::input(why, "--allow-frame names an origin such as https://lab.example"))?;
    let tls = options.tls.as_ref().map(|(cert, key)| tls(cert, key)).transpose()?;
    let scheme = if tls.is_some() { "https" } else { "http" };
    let fragment = rules.token.as_ref().map_or_else(String::new, |token| format!("#token={token}"));
    let page = format!("{scheme}://{address}/{fragment}");
    let socket = if tls.is_some() { "wss" } else { "ws" };
    let (foxglove, layout) = (format!("{socket}://{address}"), format!("{scheme}://{address}/layout.json"));
    // Of a child the parent tells.
    if !options.tied {
        talk.line(&format!("view       {page}"));
        talk.line(&format!("foxglove   {foxglove} · layout {layout}"));
    }
    if !address.ip().is_loopback() {
        let named = if address.ip().is_unspecified() {
            format!(", with the name of this machine in place of {} (and `--allow-host NAME`)", address.ip())
        } else {
            String::new()
        };
        talk.warn(&format!(
            "warning: other machines can look at the runs here by the address above{named}; it holds the token that lets them"
        ));
    }
    // Programs read where it is before the first viewer comes.
    talk.result(&json!({ "view": page, "foxglove": foxglove, "layout": layout, "address": address.to_string(), "token": rules.token }));
    if options.open {
        let opens = page.clone();
        // The desktop's program may stay for as long as its window.
        drop(tokio::task::spawn_blocking(move || crate::files::open_outside(opens.as_ref())));
    }
    let mut leaves = leave(options.tied);
    let gateway = Gateway { rules, policy, tls };
    let folder = Folder::watch(place, config.clone());
    let served = gateway.serve(listener, vec![Box::new(Runs(Arc::clone(&folder)))]);
    tokio::select! {
        () = served => {}
        _ = leaves.changed() => {}
    }
    folder.close().await;
    Ok(())
}

async fn listen(options: &ViewOptions) -> Result<TcpListener, Diagnostic> {
    if let Some(address) = options.listen {
        return TcpListener::bind(address).await.map_err(|why| {
            let hint = "another port, `--listen 127.0.0.1:0` for any that is free, or end the program that has it";
            Diagnostic::input(format!("cannot listen on `{address}`: {why}"), hint)
        });
    }
    for port in PORTS.chain([0]) {
        if let Ok(listener) = TcpListener::bind((std::net::Ipv4Addr::LOCALHOST, port)).await {
            return Ok(listener);
        }
    }
    Err(Diagnostic::input("no port of this machine is free", "`socrates doctor` checks this machine")
        .with_code(Code::Ours))
}

/// What is let in: from this machine everybody, from elsewhere those with the token.
fn rules(options: &ViewOptions, address: &SocketAddr) -> Result<Rules, Diagnostic> {
    let token = match &options.token_file {
        Some(file) => Some(token_of(file)?),
        None if address.ip().is_loopback() => None,
        None => Some(new_token()?),
    };
    Ok(Rules {
        token,
        hosts: options.hosts.clone(),
        origins: options.origins.clone(),
        most: options.most,
        ..Rules::default()
    })
}

/// The token in a file.
fn token_of(file: &Path) -> Result<String, Diagnostic> {
    let token = crate::files::text(file, 4096, "a token")?.trim().to_owned();
    if token.len() < TOKEN_CHARS || !token.chars().all(|c| c.is_ascii_alphanumeric()) {
        let what = format!("the token in `{}` has {} characters", file.display(), token.len());
        let hint = format!("at least {TOKEN_CHARS} of a-z A-Z 0-9, such as `openssl rand -hex 32` prints");
        return Err(Diagnostic::input(what, hint));
    }
    Ok(token)
}

/// A token that nobody guesses: 128 bits of the system's chance.
pub(crate) fn new_token() -> Result<String, Diagnostic> {
    let mut bytes = [0_u8; TOKEN_CHARS / 2];
    let drawn = std::fs::File::open("/dev/urandom").and_then(|mut file| file.read_exact(&mut bytes));
    drawn.map_err(|why| {
        Diagnostic::input(format!("no token can be drawn: {why}"), "`socrates doctor` checks this machine")
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn tls(cert: &Path, key: &Path) -> Result<Tls, Diagnostic> {
    let read = |file: &Path| {
        std::fs::read(file).map_err(|why| {
            Diagnostic::input(format!("cannot read `{}`: {why}", file.display()), "--cert and --key name PEM files")
        })
    };
    Tls::of_pem(&read(cert)?, &read(key)?).map_err(|why| {
        let what = format!("`{}` and `{}` are no certificate with its key: {why}", cert.display(), key.display());
        Diagnostic::input(what, "both are PEM files, the chain with the server's own certificate first")
    })
}
