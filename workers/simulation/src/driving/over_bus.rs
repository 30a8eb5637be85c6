//! Drivers that answer over the bus.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use socrates_kit::Cancel;
use socrates_link::{Bus, LinkError, keys};
use socrates_model::driver::{EndMessage, MissionAnswer, Shown};
use socrates_model::lockstep::{MAP_PART_CELLS, StepHead, map_bytes, read_command, step_bytes};
use socrates_model::{Command, Digest, Fault, Observation, Point, Polyline, RobotDriver, SeenPerson};
use tokio::runtime::Handle;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use super::mission::{cells, message};
use super::{Drive, Driver, Ended, Mode, Outside, Wanted, fault};

/// A command that is older than this holds no more: the robot stops, simulated s.
const WATCHDOG_S: f64 = 0.5;
/// Longest wait for a driver to take note of the end.
const FAREWELL: Duration = Duration::from_secs(1);
/// Sessions are told in JSON as well, whose numbers hold so many bits everywhere.
const SESSION_BITS: u32 = 53;

/// Numbers of the runs of this process.
static SESSIONS: AtomicU64 = AtomicU64::new(0);

/// Finds drivers over the bus. Its calls block: they are made where that is allowed.
pub struct OverBus {
    bus: Arc<dyn Bus>,
    handle: Handle,
    drive: Drive,
    cancel: Cancel,
}

impl OverBus {
    /// Over this bus; `handle` is of the runtime that the bus lives in.
    #[must_use]
    pub const fn new(bus: Arc<dyn Bus>, handle: Handle, drive: Drive, cancel: Cancel) -> Self {
        Self { bus, handle, drive, cancel }
    }

    /// A number that no other run of any process has.
    fn session(&self, wanted: &Wanted<'_>) -> u64 {
        let nth = SESSIONS.fetch_add(1, Ordering::Relaxed);
        let text = format!("{} {} {} {nth}", self.bus.name(), std::process::id(), wanted.run);
        let digest = Digest::of(text.as_bytes()).to_string();
        let number = digest.bytes().fold(0_u64, |number, byte| number.wrapping_mul(131).wrapping_add(u64::from(byte)));
        number >> (u64::BITS - SESSION_BITS)
    }

    /// Waits for the driver, tells it the mission, and gives it the map if it wants it.
    async fn hello(&self, wanted: &Wanted<'_>, session: u64) -> Result<MissionAnswer, Fault> {
        let failed = |why: String| fault(wanted.driver, why);
        let mission = message(wanted, session, self.drive.mode)?;
        let mission = serde_json::to_vec(&mission).map_err(|why| failed(format!("the mission: {why}")))?;
        let patience = self.drive.patience;
        let broken = |why: LinkError| failed(why.to_string());
        let mut claims = self.bus.watch_alive(keys::DRIVERS_ALIVE).await.map_err(broken)?;
        let (mut there, mut others) = (Vec::new(), std::collections::BTreeSet::new());
        let first = async {
            while let Some((claim, alive)) = claims.next().await {
                match keys::driver_of(&claim) {
                    Some(name) if alive && name == wanted.driver => return Some(claim),
                    Some(name) if alive => drop(others.insert(name.to_owned())),
                    Some(_) | None => {}
                }
            }
            None
        };
        let Some(first) = timeout(patience, first).await.ok().flatten() else {
            let token = keys::drive_claims(wanted.driver);
            let nobody =
                format!("no driver of this name came within {} s; it declares the token `{token}`", patience.as_secs());
            let others: Vec<String> = others.into_iter().map(|name| format!("`{name}`")).collect();
            return Err(failed(match others.as_slice() {
                [] => nobody,
                names => format!("{nobody}; there are drivers called {}", names.join(", ")),
            }));
        };
        there.push(first);
        let key = keys::drive_mission(wanted.driver);
        let answer = self.bus.query(&key, mission, patience).await.map_err(|why| failed(told(&why)))?;
        // Every token that was there before has come before the answer.
        while let Ok(Some((claim, alive))) = timeout(Duration::ZERO, claims.next()).await {
            if keys::driver_of(&claim) != Some(wanted.driver) {
                continue;
            }
            there.retain(|other| *other != claim);
            if alive {
                there.push(claim);
            }
        }
        if let [one, other, ..] = there.as_slice() {
            return Err(failed(format!("two drivers have this name: `{one}` and `{other}`; end one of them")));
        }
        let answer = MissionAnswer::read(&answer).map_err(|bad| failed(bad.to_string()))?;
        if answer.map {
            let cells = cells(&wanted.mission.grid);
            let whole = cells.len() as u64;
            let mut first = 0;
            for part in cells.chunks(MAP_PART_CELLS) {
                let body = map_bytes(session, first, whole, part);
                self.bus.query(&key, body, patience).await.map_err(|why| failed(format!("the map: {}", told(&why))))?;
                first += part.len() as u64;
            }
        }
        Ok(answer)
    }
}

/// What went wrong with a question to a driver.
fn told(why: &LinkError) -> String {
    match why {
        LinkError::NoReply { .. } => "it is gone, or gave no answer".to_owned(),
        LinkError::Timeout { after, .. } => format!("no answer within {:.1} s", after.as_secs_f64()),
        LinkError::TooLarge { .. }
        | LinkError::BadKey { .. }
        | LinkError::Encode { .. }
        | LinkError::Decode { .. }
        | LinkError::Incompatible { .. }
        | LinkError::Refused { .. }
        | LinkError::Absent { .. }
        | LinkError::Closed
        | LinkError::Transport { .. } => why.to_string(),
    }
}

impl Outside for OverBus {
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault> {
        let session = self.session(wanted);
        let answer = self.handle.block_on(self.hello(wanted, session))?;
        let plan = Polyline::new(&socrates_planners::free_way(wanted.mission));
        Ok(Box::new(Remote {
            name: wanted.driver.to_owned(),
            bus: Arc::clone(&self.bus),
            handle: self.handle.clone(),
            drive: self.drive,
            cancel: self.cancel.clone(),
            session,
            answer,
            goal: wanted.mission.waypoints.last().copied(),
            plan,
            s: 0.0,
            call: 0,
            last: Command::default(),
            last_s: 0.0,
            silent: Duration::ZERO,
            asked: None,
            fault: None,
        }))
    }
}

/// A question on its way.
type Asked = JoinHandle<Result<Vec<u8>, LinkError>>;

/// One run of a driver over the bus.
struct Remote {
    name: String,
    bus: Arc<dyn Bus>,
    handle: Handle,
    drive: Drive,
    cancel: Cancel,
    session: u64,
    answer: MissionAnswer,
    goal: Option<Point>,
    plan: Polyline,
    /// How far along the plan the robot is, m.
    s: f64,
    call: u32,
    last: Command,
    /// When the newest command came, simulated s.
    last_s: f64,
    /// For how long no answer came, one after the other.
    silent: Duration,
    /// The question that is not answered yet, and its number; mode `free` alone.
    asked: Option<(u32, Asked)>,
    fault: Option<Fault>,
}

impl Remote {
    fn head(&mut self, at: &Point) -> StepHead {
        self.s = self.plan.progress(at, self.s, (0.3, 3.0)).0;
        let goal = self.goal.unwrap_or(*at);
        let ahead =
            if self.plan.points().is_empty() { goal } else { self.plan.point(self.s + self.answer.look_ahead_m) };
        StepHead { session: self.session, call: self.call, goal, ahead }
    }

    fn bytes(&mut self, seen: &Observation<'_>) -> Vec<u8> {
        let head = self.head(&seen.pose.point());
        let hidden: Vec<SeenPerson> = match self.answer.people {
            Shown::Seen => Vec::new(),
            Shown::All => {
                let in_sight = |person: &SeenPerson| seen.people.iter().any(|other| other.id == person.id);
                (seen.everybody)().into_iter().filter(|person| !in_sight(person)).collect()
            }
        };
        let lidar = if self.answer.lidar { (seen.lidar)() } else { Vec::new() };
        step_bytes(&head, seen, &hidden, &lidar)
    }

    /// Takes the answer to a step.
    fn take(&mut self, answer: &[u8], call: u32, now_s: f64) {
        match read_command(answer, self.session, call) {
            Ok(command) => {
                (self.last, self.last_s, self.silent) = (command, now_s, Duration::ZERO);
            }
            Err(bad) => self.end(now_s, &bad.to_string()),
        }
    }

    fn end(&mut self, now_s: f64, why: &str) {
        self.fault = Some(fault(&self.name, format!("at {now_s:.2} s: {why}")));
    }

    /// The simulation stands until the answer is there, at most so long.
    fn wait(&mut self, body: Vec<u8>, limit: Duration, now_s: f64) {
        let (key, call) = (keys::drive_step(&self.name), self.call);
        match self.handle.block_on(self.bus.query(&key, body, limit)) {
            Ok(answer) => self.take(&answer, call, now_s),
            Err(LinkError::Timeout { .. }) if matches!(self.drive.mode, Mode::Wait(_)) => {
                self.silent = self.silent.saturating_add(limit);
                if self.silent > self.drive.patience {
                    self.end(now_s, &format!("no answer in time for {:.0} s", self.silent.as_secs_f64()));
                }
            }
            Err(why) => self.end(now_s, &told(&why)),
        }
    }

    /// The simulation goes on; the newest answer counts.
    fn go_on(&mut self, seen: &Observation<'_>, now_s: f64) {
        if let Some((call, asked)) = self.asked.take_if(|(_, asked)| asked.is_finished()) {
            match self.handle.block_on(asked) {
                Ok(Ok(answer)) => self.take(&answer, call, now_s),
                Ok(Err(why)) => self.end(now_s, &told(&why)),
                Err(why) => self.end(now_s, &why.to_string()),
            }
        }
        if self.asked.is_none() {
            let (body, key) = (self.bytes(seen), keys::drive_step(&self.name));
            let (bus, patience) = (Arc::clone(&self.bus), self.drive.patience);
            let asked = self.handle.spawn(async move { bus.query(&key, body, patience).await });
            self.asked = Some((self.call, asked));
        }
    }
}

impl RobotDriver for Remote {
    fn rate_hz(&self) -> f64 {
        self.answer.rate_hz
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let now_s = seen.time.secs();
        if self.cancel.is_stopped() {
            self.end(now_s, "the run was canceled");
        }
        if self.is_gone() {
            return Command::default();
        }
        match self.drive.mode {
            Mode::Step => {
                let body = self.bytes(seen);
                self.wait(body, self.drive.patience, now_s);
            }
            Mode::Wait(limit) => {
                let body = self.bytes(seen);
                self.wait(body, limit, now_s);
            }
            Mode::Free => self.go_on(seen, now_s),
        }
        self.call = self.call.saturating_add(1);
        // A gesture begins once, with the command that makes it.
        let fresh = (now_s - self.last_s).abs() < f64::EPSILON;
        let holds = now_s - self.last_s <= WATCHDOG_S;
        match (fresh, holds && !self.is_gone()) {
            (true, true) => self.last,
            (false, true) => Command { gesture: None, ..self.last },
            (_, false) => Command::default(),
        }
    }

    fn is_gone(&self) -> bool {
        self.fault.is_some()
    }
}

impl Driver for Remote {
    fn over(&mut self, ended: &Ended) {
        let message = EndMessage {
            socrates: "end".to_owned(),
            session: self.session,
            reason: ended.reason.clone(),
            time_s: ended.time_s,
            arrived: ended.arrived,
        };
        let key = keys::drive_mission(&self.name);
        if let Ok(body) = serde_json::to_vec(&message)
            && let Err(why) = self.handle.block_on(self.bus.query(&key, body, FAREWELL))
        {
            // The run is whole without it.
            tracing::debug!(driver = self.name, %why, "the driver did not take note of the end");
        }
    }

    fn fault(&self) -> Option<Fault> {
        self.fault.clone()
    }
}
