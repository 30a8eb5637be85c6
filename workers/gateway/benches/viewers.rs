//! What viewers cost: CPU of the gateway against that of a bare WebSocket server that sends the same bytes, age of what a slow viewer
//! sees, and memory.
//!
//! ```text
//! cargo bench -p socrates-gateway --bench viewers
//! ```
//!
//! Servers are processes of their own, so that the clients' work is not counted. Linux alone: CPU and memory are read from `/proc`.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::indexing_slicing,
    reason = "a bench ends where it cannot measure, and prints what it measured"
)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use futures_util::{SinkExt as _, StreamExt as _};
use socrates_gateway::frame::{Sights, encode};
use socrates_gateway::page::PROTOCOL;
use socrates_model::SimTime;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::{Bytes, Message};

use synthetic::{EVERY, RUN, Server, gateway, states};

mod synthetic;

/// How long a case is measured.
const MEASURED: Duration = Duration::from_secs(10);

/// A bare server: the newest frame to everybody, as fast as each one takes it.
async fn bare(listener: TcpListener, agents: u32) {
    let newest = watch::Sender::new(Bytes::new());
    let sender = newest.clone();
    tokio::spawn(async move {
        let mut step = tokio::time::interval(EVERY);
        for tick in (0..).step_by(5) {
            step.tick().await;
            let number = u32::try_from(tick / 5).unwrap_or_default();
            let bytes = encode(number, SimTime::at_tick(tick).secs(), &states(tick, agents), None, &Sights::default());
            sender.send_replace(bytes.into());
        }
    });
    loop {
        let (stream, _) = listener.accept().await.unwrap();
        stream.set_nodelay(true).unwrap();
        let mut news = newest.subscribe();
        tokio::spawn(async move {
            let Ok(mut socket) = tokio_tungstenite::accept_async(stream).await else { return };
            while news.changed().await.is_ok() {
                let bytes = news.borrow_and_update().clone();
                if socket.send(Message::Binary(bytes)).await.is_err() {
                    return;
                }
            }
        });
    }
}

async fn serve(kind: &str, agents: u32) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    println!("{}", listener.local_addr().unwrap());
    if kind == "bare" {
        bare(listener, agents).await;
    } else {
        gateway(listener, agents).await;
    }
}

async fn connect(
    at: &str,
    kind: &str,
) -> tokio_tungstenite::WebSocketStream<tokio_tungstenite::MaybeTlsStream<TcpStream>> {
    let path = if kind == "bare" { String::new() } else { format!("/run/{RUN}/ws") };
    let mut request = format!("ws://{at}{path}").into_client_request().unwrap();
    if kind != "bare" {
        request.headers_mut().insert("Sec-WebSocket-Protocol", PROTOCOL.parse().unwrap());
    }
    tokio_tungstenite::connect_async(request).await.unwrap().0
}

/// Frames that clients get and CPU that the server takes, per second.
async fn case(kind: &str, agents: u32, clients: u32) -> (f64, f64, f64) {
    let server = Server::start(kind, agents);
    let frames = Arc::new(std::sync::atomic::AtomicU64::new(0));
    let mut readers = Vec::new();
    for _ in 0..clients {
        let mut socket = connect(&server.at, kind).await;
        let (frames, acks) = (Arc::clone(&frames), kind != "bare");
        readers.push(tokio::spawn(async move {
            while let Some(Ok(message)) = socket.next().await {
                let Message::Binary(bytes) = message else { continue };
                frames.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                if acks && socket.send(Message::Binary(bytes.slice(12..16))).await.is_err() {
                    return;
                }
            }
        }));
    }
    tokio::time::sleep(Duration::from_secs(1)).await;
    let (before, cpu, begun) = (frames.load(std::sync::atomic::Ordering::Relaxed), server.cpu_s(), Instant::now());
    tokio::time::sleep(MEASURED).await;
    let secs = begun.elapsed().as_secs_f64();
    let seen = frames.load(std::sync::atomic::Ordering::Relaxed) - before;
    let used = server.cpu_s() - cpu;
    readers.iter().for_each(tokio::task::JoinHandle::abort);
    (seen as f64 / secs, used / secs, server.peak_mb())
}

/// Ages of the frames of a viewer that reads 1 MB/s of 3.2 MB/s, s: the time of a frame's last byte against that of the server's clock, which is
/// known from frames that an unhurried viewer got.
async fn staleness(agents: u32) -> Vec<f64> {
    let server = Server::start("gateway", agents);
    let born = |tick: u64, zero: Instant| zero + Duration::from_secs_f64(tick as f64 * 0.01);
    let mut quick = connect(&server.at, "gateway").await;
    let mut zero: Option<Instant> = None;
    for _ in 0..40 {
        let Some(Ok(Message::Binary(bytes))) = quick.next().await else { continue };
        let tick = u64::from_le_bytes(bytes[4..12].try_into().unwrap());
        let at = Instant::now().checked_sub(Duration::from_secs_f64(tick as f64 * 0.01)).unwrap();
        zero = Some(zero.map_or(at, |zero| zero.min(at)));
        quick.send(Message::Binary(bytes.slice(12..16))).await.unwrap();
    }
    let zero = zero.unwrap();
    // The slow one lies behind a proxy that lets 1 MB/s through and holds 64 kB.
    let proxy = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let (at, behind) = (proxy.local_addr().unwrap().to_string(), server.at.clone());
    let host = server.at.clone();
    tokio::spawn(async move {
        use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
        let (mut near, _) = proxy.accept().await.unwrap();
        let socket = tokio::net::TcpSocket::new_v4().unwrap();
        socket.set_recv_buffer_size(32 * 1024).unwrap();
        let mut far = socket.connect(behind.parse().unwrap()).await.unwrap();
        let (mut far_read, mut far_write) = far.split();
        let (mut near_read, mut near_write) = near.split();
        let down = async {
            let mut piece = vec![0; 10_000];
            let mut step = tokio::time::interval(Duration::from_millis(10));
            loop {
                step.tick().await;
                let Ok(count @ 1..) = far_read.read(&mut piece).await else { return };
                if near_write.write_all(&piece[..count]).await.is_err() {
                    return;
                }
            }
        };
        tokio::select! {
            () = down => {}
            _ = tokio::io::copy(&mut near_read, &mut far_write) => {}
        }
    });
    let mut request = format!("ws://{at}/run/{RUN}/ws").into_client_request().unwrap();
    request.headers_mut().insert("Sec-WebSocket-Protocol", PROTOCOL.parse().unwrap());
    request.headers_mut().insert("Host", host.parse().unwrap());
    let mut slow = tokio_tungstenite::connect_async(request).await.unwrap().0;
    let (mut ages, begun) = (Vec::new(), Instant::now());
    while begun.elapsed() < MEASURED {
        let Some(Ok(message)) = slow.next().await else { break };
        let Message::Binary(bytes) = message else { continue };
        let tick = u64::from_le_bytes(bytes[4..12].try_into().unwrap());
        ages.push(born(tick, zero).elapsed().as_secs_f64());
        slow.send(Message::Binary(bytes.slice(12..16))).await.unwrap();
    }
    ages.sort_by(f64::total_cmp);
    ages
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    if let Some(place) = args.iter().position(|arg| arg == "--serve") {
        runtime.block_on(serve(&args[place + 1], args[place + 2].parse().unwrap()));
        return;
    }
    println!(
        "{} cores, {}-{}",
        std::thread::available_parallelism().unwrap(),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    println!(
        "| agents x 20 Hz x viewers | bare: frames/s | CPU | gateway: frames/s | CPU | CPU a frame, ratio | memory, MB |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (agents, clients) in [(50, 100), (10_000, 40)] {
        let (bare_frames, bare_cpu, _) = runtime.block_on(case("bare", agents, clients));
        let (frames, cpu, peak_mb) = runtime.block_on(case("gateway", agents, clients));
        let ratio = (cpu / frames) / (bare_cpu / bare_frames);
        println!(
            "| {agents} x {clients} | {bare_frames:.0} | {:.1} % | {frames:.0} | {:.1} % | {ratio:.2} | {peak_mb:.0} |",
            bare_cpu * 100.0,
            cpu * 100.0
        );
    }
    let ages = runtime.block_on(staleness(10_000));
    let at = |share: f64| ages.get(((ages.len() - 1) as f64 * share).round() as usize).copied().unwrap_or(f64::NAN);
    println!(
        "a viewer that reads 1 of 3.2 MB/s: {} frames, age p50 {:.2} s, p95 {:.2} s",
        ages.len(),
        at(0.5),
        at(0.95)
    );
}
