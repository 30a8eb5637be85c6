//! What our page shows of many agents: frames that it acknowledged once they were drawn, per second, in Debian's chromium without a screen.
//!
//! ```text
//! cargo bench -p socrates-gateway --bench page
//! ```
//!
//! Frames are sent at 20 Hz; the server is a process of its own. Without chromium it says so and measures nothing.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::indexing_slicing,
    reason = "a bench ends where it cannot measure, and prints what it measured"
)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::{Value, json};
use tokio::net::{TcpListener, TcpStream};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream};

use synthetic::{RUN, Server, gateway};

mod synthetic;

/// How long a case is measured, and how long the page has before that.
const MEASURED: Duration = Duration::from_secs(10);
const WARM: Duration = Duration::from_secs(3);
/// Longest start of a browser.
const START: Duration = Duration::from_secs(30);

fn chromium() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file())
}

/// A browser of its own, with a port for its debugging protocol.
struct Browser {
    child: Child,
    profile: PathBuf,
}

impl Browser {
    fn start(program: &Path) -> Self {
        let profile = std::env::temp_dir().join(format!("socrates-page-bench-{}", std::process::id()));
        let child = Command::new(program)
            .args(["--headless=new", "--no-sandbox", "--no-first-run", "--remote-debugging-port=0"])
            .args(["--window-size=1280,720", &format!("--user-data-dir={}", profile.display()), "about:blank"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        Self { child, profile }
    }

    /// A connection to the browser, once it tells where.
    async fn connect(&self) -> WebSocketStream<MaybeTlsStream<TcpStream>> {
        let (file, begun) = (self.profile.join("DevToolsActivePort"), Instant::now());
        let mut step = tokio::time::interval(Duration::from_millis(50));
        loop {
            step.tick().await;
            let told = std::fs::read_to_string(&file).unwrap_or_default();
            if let [port, path] = told.lines().collect::<Vec<_>>()[..] {
                return tokio_tungstenite::connect_async(format!("ws://127.0.0.1:{port}{path}")).await.unwrap().0;
            }
            assert!(begun.elapsed() < START, "the browser did not start");
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
        drop(std::fs::remove_dir_all(&self.profile));
    }
}

/// Asks the browser, and gives its answer; what it tells meanwhile is dropped.
async fn ask(socket: &mut WebSocketStream<MaybeTlsStream<TcpStream>>, question: Value) -> Value {
    let id = question["id"].clone();
    socket.send(Message::text(question.to_string())).await.unwrap();
    loop {
        let Message::Text(text) = socket.next().await.unwrap().unwrap() else { continue };
        let told: Value = serde_json::from_str(&text).unwrap();
        if told["id"] == id {
            assert!(told["error"].is_null(), "{told}");
            return told["result"].clone();
        }
    }
}

/// Acknowledged frames per second of a page that shows so many agents, processor time of the gateway, s a second, and its memory, MB.
async fn case(browser: &Path, agents: u32) -> (f64, f64, f64) {
    let server = Server::start("gateway", agents);
    let browser = Browser::start(browser);
    let mut socket = browser.connect().await;
    let target =
        ask(&mut socket, json!({ "id": 1, "method": "Target.createTarget", "params": { "url": "about:blank" } })).await;
    let attach = json!({ "targetId": target["targetId"], "flatten": true });
    let session = ask(&mut socket, json!({ "id": 2, "method": "Target.attachToTarget", "params": attach })).await;
    let session = session["sessionId"].clone();
    ask(&mut socket, json!({ "id": 3, "sessionId": session, "method": "Network.enable" })).await;
    let page = json!({ "url": format!("http://{}/run/{RUN}", server.at) });
    ask(&mut socket, json!({ "id": 4, "sessionId": session, "method": "Page.navigate", "params": page })).await;
    let (begun, cpu_s, mut acks) = (Instant::now(), server.cpu_s(), 0_u32);
    while begun.elapsed() < WARM + MEASURED {
        let Ok(Some(Ok(message))) = tokio::time::timeout(MEASURED, socket.next()).await else { break };
        let Message::Text(text) = message else { continue };
        let told: Value = serde_json::from_str(&text).unwrap();
        // Four bytes, the number of the frame: what the page says of a frame that it has drawn.
        let ack = told["method"] == "Network.webSocketFrameSent" && told["params"]["response"]["opcode"] == 2;
        acks += u32::from(ack && begun.elapsed() >= WARM);
    }
    let used = (server.cpu_s() - cpu_s) / begun.elapsed().as_secs_f64();
    (f64::from(acks) / MEASURED.as_secs_f64(), used, server.peak_mb())
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    if let Some(place) = args.iter().position(|arg| arg == "--serve") {
        runtime.block_on(async {
            let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
            println!("{}", listener.local_addr().unwrap());
            gateway(listener, args[place + 2].parse().unwrap()).await;
        });
        return;
    }
    let Some(browser) = chromium() else {
        println!("not measured: there is no chromium on this machine");
        return;
    };
    println!("| agents x 20 Hz | acknowledged frames/s | CPU of the gateway | its memory, MB |");
    println!("|---|---|---|---|");
    for agents in [50, 1_000, 10_000] {
        let (frames, cpu, peak_mb) = runtime.block_on(case(&browser, agents));
        println!("| {agents} | {frames:.1} | {:.1} % | {peak_mb:.0} |", cpu * 100.0);
    }
}
