//! What the tests share: a run on a bus that counts what is done on it, a gateway, and a small client.

use std::net::SocketAddr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use async_trait::async_trait;
use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::Value;
use socrates_gateway::Gateway;
use socrates_gateway::air::Air;
use socrates_gateway::guard::Rules;
use socrates_gateway::http::Policy;
use socrates_gateway::hub::Shelf;
use socrates_link::{AliveToken, Bus, LinkError, MemoryBus, Overflow, Presence, Publish, Qos, Serving, Subscription};
use socrates_model::driver::{MissionDoor, MissionMap, map_cells};
use socrates_model::live::{LiveDoor, LiveEnd, LivePlace, LiveScene};
use socrates_model::recording::{AgentInfo, Event, EventKind, Recording, RecordingHeader};
use socrates_model::robot::RobotFile;
use socrates_model::{
    AgentId, AgentState, Cell, Grid, HumanId, Onlooker as _, PlannerName, Pose, RobotModel, RunId, SimTime,
};
use socrates_stream::mcap::{Tape, Writer};
use socrates_stream::{Linger, LiveSink};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio_tungstenite::MaybeTlsStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;

/// Limit of a test.
const WATCHDOG: Duration = Duration::from_secs(60);

pub(crate) async fn guarded<T>(what: impl Future<Output = T>) -> T {
    tokio::time::timeout(WATCHDOG, what).await.expect("within the watchdog's time")
}

/// A room of 8 x 6 m with a door, a robot that drives through it and a person who stands.
pub(crate) fn recording(agents: u32, ticks: u64) -> Recording {
    let mut text = vec![AgentInfo { agent: AgentId::Robot, radius_m: 0.25, speed_mps: 1.0, role: "robot".into() }];
    text.extend((1..agents).map(|number| AgentInfo {
        agent: AgentId::Human(HumanId::new(number)),
        radius_m: 0.3,
        speed_mps: 1.2,
        role: "<b>visitor</b>".into(),
    }));
    let state = |tick: u64, agent: u32| {
        let along = tick as f64 * 0.01;
        let (x, y) = if agent == 0 { (1.0 + along, 2.0) } else { (4.0, 1.0 + f64::from(agent) * 0.01) };
        let flags = AgentState::flags(AgentId::from_number(agent), None, 1);
        AgentState { tick, agent, flags, x, y, yaw: if agent == 0 { 0.0 } else { 3.0 }, vx: 1.0, vy: 0.0, omega: 0.0 }
    };
    let event = |tick, kind| Event { time: SimTime::at_tick(tick), kind };
    Recording {
        header: RecordingHeader {
            format: socrates_model::FORMAT,
            run: RunId::new("hall.reference-1").unwrap(),
            planner: PlannerName::reference(),
            seed: 1,
            profile: "native".into(),
            step_s: 0.01,
            agents: text,
            leaves: vec![String::new(), "walk".into()],
        },
        frames: (0..ticks).flat_map(|tick| (0..agents).map(move |agent| state(tick, agent))).collect(),
        events: vec![
            event(20, EventKind::Sees { human: HumanId::new(1), distance_m: 3.2 }),
            event(40, EventKind::Door { door: "d1".into(), open: true }),
            event(ticks - 1, EventKind::End { reason: "done".into() }),
        ],
    }
}

fn grid() -> Grid {
    let (width, height) = (80, 60);
    let wall = |place: usize| {
        let (column, row) = (place % width, place / width);
        if column == 0 || row == 0 || column == width - 1 || row == height - 1 { Cell::Occupied } else { Cell::Free }
    };
    let cells = (0..width * height).map(wall).collect();
    Grid { width, height, resolution_m: 0.1, origin: Pose::new(0.0, 0.0, 0.0), cells }
}

/// What was done on a bus by one participant.
#[derive(Default)]
pub(crate) struct Deeds {
    /// Publications, declarations of keys and presence: things that others can notice.
    pub(crate) noticed: AtomicUsize,
    /// Keys that were asked.
    pub(crate) asked: Mutex<Vec<String>>,
}

/// A bus that counts what is done on it.
struct Counted {
    bus: MemoryBus,
    deeds: Arc<Deeds>,
}

impl Counted {
    fn notice(&self) {
        self.deeds.noticed.fetch_add(1, Ordering::Relaxed);
    }
}

#[async_trait]
impl Bus for Counted {
    fn name(&self) -> &str {
        "counted"
    }
    async fn query(&self, key: &str, body: Vec<u8>, timeout: Duration) -> Result<Vec<u8>, LinkError> {
        self.deeds.asked.lock().unwrap().push(key.to_owned());
        self.bus.query(key, body, timeout).await
    }
    async fn query_all(
        &self,
        expression: &str,
        body: Vec<u8>,
        most: usize,
        timeout: Duration,
    ) -> Result<Vec<Vec<u8>>, LinkError> {
        self.deeds.asked.lock().unwrap().push(expression.to_owned());
        self.bus.query_all(expression, body, most, timeout).await
    }
    async fn serve(&self, key: &str) -> Result<Serving, LinkError> {
        self.notice();
        self.bus.serve(key).await
    }
    async fn publish(&self, key: &str, body: Vec<u8>, qos: Qos) -> Result<(), LinkError> {
        self.notice();
        self.bus.publish(key, body, qos).await
    }
    async fn publisher(&self, key: &str, qos: Qos) -> Result<Box<dyn Publish>, LinkError> {
        self.notice();
        self.bus.publisher(key, qos).await
    }
    async fn subscribe(&self, expression: &str, depth: usize, overflow: Overflow) -> Result<Subscription, LinkError> {
        self.bus.subscribe(expression, depth, overflow).await
    }
    async fn declare_alive(&self, key: &str) -> Result<AliveToken, LinkError> {
        self.notice();
        self.bus.declare_alive(key).await
    }
    async fn watch_alive(&self, expression: &str) -> Result<Presence, LinkError> {
        self.bus.watch_alive(expression).await
    }
    async fn close(&self) {}
}

/// A run that the test moves, tick by tick.
pub(crate) struct Playing {
    pub(crate) recording: Recording,
    sink: LiveSink,
    writer: Option<Writer<Tape>>,
    next: usize,
}

impl Playing {
    pub(crate) async fn begin(bus: &MemoryBus, recording: Recording) -> Self {
        let grid = grid();
        let door = MissionDoor { id: "d1".into(), from: [6.0, 1.0], to: [6.0, 3.0] };
        let scene = LiveScene {
            location: Some(LivePlace { name: "hall".into(), map: MissionMap::of(&grid, &map_cells(&grid)) }),
            doors: vec![LiveDoor { door, open: false }],
            robot: Some(RobotFile::from(&RobotModel::default())),
            goal: Some([7.0, 2.0]),
            way: vec![[1.0, 2.0], [7.0, 2.0]],
            pace: Some(1.0),
            ..LiveScene::default()
        };
        let (tape, linger) = (Tape::default(), Linger::new(Duration::from_secs(30), 4));
        let run = recording.header.run.clone();
        let bus: Arc<dyn Bus> = Arc::new(bus.named("simulation"));
        let mut sink = LiveSink::open(bus, &run, (scene, map_cells(&grid)), tape.clone(), &linger).await.unwrap();
        let writer = Some(tape.record(&recording.header, None).unwrap());
        sink.announce(&recording.header);
        Self { recording, sink, writer, next: 0 }
    }

    /// Plays so many ticks.
    pub(crate) fn play(&mut self, ticks: usize) {
        for tick in self.next..(self.next + ticks).min(self.recording.ticks()) {
            let states = self.recording.tick(tick);
            let writer = self.writer.as_mut().unwrap();
            writer.tick(states).unwrap();
            let now = self.recording.events.iter().filter(|event| event.time.tick() == tick as u64);
            let events: Vec<Event> = now.cloned().collect();
            events.iter().for_each(|event| writer.event(event).unwrap());
            self.sink.tick(states, &events);
            self.next = tick + 1;
        }
    }

    /// Plays the rest and ends; gives the hash of what was written down.
    pub(crate) fn end(&mut self) -> socrates_model::Digest {
        self.play(usize::MAX / 2);
        let (_, whole) = self.writer.take().unwrap().finish().unwrap();
        self.sink.end(&LiveEnd { recording: Some(whole.hash), file: None });
        whole.hash
    }
}

/// A gateway in front of a bus.
pub(crate) struct Doors {
    pub(crate) at: SocketAddr,
    pub(crate) deeds: Arc<Deeds>,
    task: tokio::task::JoinHandle<()>,
}

impl Drop for Doors {
    fn drop(&mut self) {
        self.task.abort();
    }
}

impl Doors {
    pub(crate) async fn open(bus: &MemoryBus, rules: Rules) -> Self {
        let deeds = Arc::new(Deeds::default());
        let counted: Arc<dyn Bus> = Arc::new(Counted { bus: bus.named("view"), deeds: Arc::clone(&deeds) });
        let air: Box<dyn Shelf> = Box::new(Air::listen(counted).await.unwrap());
        Self::of(vec![air], rules, deeds).await
    }

    pub(crate) async fn of(shelves: Vec<Box<dyn Shelf>>, rules: Rules, deeds: Arc<Deeds>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let at = listener.local_addr().unwrap();
        let task =
            tokio::spawn(Gateway { rules, policy: Policy::letting(&[]).unwrap(), tls: None }.serve(listener, shelves));
        Self { at, deeds, task }
    }

    /// Asks with these headers besides the host; gives status, head and body.
    pub(crate) async fn ask(&self, what: &str, headers: &[(&str, &str)]) -> (u16, String, Vec<u8>) {
        let own = self.at.to_string();
        let mut request = format!("{what} HTTP/1.1\r\n");
        for (name, value) in [("Connection", "close"), ("Host", own.as_str())] {
            if !headers.iter().any(|(given, _)| *given == name) {
                request.push_str(&format!("{name}: {value}\r\n"));
            }
        }
        headers.iter().for_each(|(name, value)| request.push_str(&format!("{name}: {value}\r\n")));
        request.push_str("\r\n");
        let mut stream = TcpStream::connect(self.at).await.unwrap();
        stream.write_all(request.as_bytes()).await.unwrap();
        let (mut answer, mut head) = (Vec::new(), None);
        loop {
            let end = answer.windows(4).position(|four| four == b"\r\n\r\n");
            if let (None, Some(end)) = (&head, end) {
                let text = String::from_utf8(answer.drain(..end + 4).collect()).unwrap();
                let length = text.lines().find_map(|line| line.strip_prefix("content-length: ")?.parse::<usize>().ok());
                head = Some((text, length.unwrap_or_default()));
            }
            match &head {
                // A connection that is kept for more says how long its answer is.
                Some((text, length)) if answer.len() >= *length => {
                    let status = text.split(' ').nth(1).unwrap().parse().unwrap();
                    return (status, text.clone(), answer);
                }
                Some(_) | None => {}
            }
            assert!(stream.read_buf(&mut answer).await.unwrap() > 0, "an answer: {head:?}");
        }
    }

    /// Sends bytes and reads until the gateway closes.
    pub(crate) async fn raw(&self, bytes: &[u8]) -> Vec<u8> {
        let mut stream = TcpStream::connect(self.at).await.unwrap();
        stream.write_all(bytes).await.unwrap();
        let mut answer = Vec::new();
        // A connection that is cut has said all that it says.
        drop(stream.read_to_end(&mut answer).await);
        answer
    }

    /// The JSON at an address, once it is there.
    pub(crate) async fn json(&self, path: &str) -> Value {
        loop {
            let (status, _, body) = self.ask(&format!("GET {path}"), &[]).await;
            if status == 200 {
                return serde_json::from_slice(&body).unwrap();
            }
            tokio::task::yield_now().await;
        }
    }

    /// A socket with this subprotocol.
    pub(crate) async fn socket(&self, path: &str, protocol: &str) -> Socket {
        let mut request = format!("ws://{}{path}", self.at).into_client_request().unwrap();
        request.headers_mut().insert("Sec-WebSocket-Protocol", protocol.parse().unwrap());
        let (socket, answer) = tokio_tungstenite::connect_async(request).await.expect("a socket");
        assert_eq!(answer.headers()["sec-websocket-protocol"], protocol);
        Socket(socket)
    }
}

/// A viewer's socket.
pub(crate) struct Socket(tokio_tungstenite::WebSocketStream<MaybeTlsStream<TcpStream>>);

impl Socket {
    /// The next message; none once it is closed.
    pub(crate) async fn next(&mut self) -> Option<Message> {
        self.0.next().await?.ok()
    }

    pub(crate) async fn say(&mut self, message: Message) {
        // A socket that the other side has closed takes nothing; what it said comes with the next message.
        drop(self.0.send(message).await);
    }

    pub(crate) async fn json(&mut self, message: &Value) {
        self.say(Message::text(message.to_string())).await;
    }

    /// The next text with this `op`, and the binary messages that came before it.
    pub(crate) async fn op(&mut self, op: &str) -> (Value, Vec<Vec<u8>>) {
        let mut before = Vec::new();
        loop {
            match self.next().await.expect("an open socket") {
                Message::Text(text) => {
                    let told: Value = serde_json::from_str(&text).unwrap();
                    if told["op"] == op {
                        return (told, before);
                    }
                }
                Message::Binary(bytes) => before.push(bytes.to_vec()),
                Message::Ping(_) | Message::Pong(_) | Message::Close(_) | Message::Frame(_) => {}
            }
        }
    }

    /// The next bytes.
    pub(crate) async fn bytes(&mut self) -> Vec<u8> {
        loop {
            if let Message::Binary(bytes) = self.next().await.expect("an open socket") {
                return bytes.to_vec();
            }
        }
    }
}
