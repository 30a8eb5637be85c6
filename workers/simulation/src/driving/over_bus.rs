//! Drivers that answer over the bus.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use socrates_kit::Cancel;
use socrates_link::{Bus, LinkError};
use socrates_model::driver::{EndMessage, MissionAnswer, ShownPeople, map_cells};
use socrates_model::lockstep::{StepHead, read_command, step_bytes};
use socrates_model::{Command, Digest, Fault, Observation, Point, Polyline, RobotDriver, SeenPerson};
use tokio::runtime::Handle;
use tokio::task::JoinHandle;

use super::line::{Line, told};
use super::mission::message;
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
        Digest::of(text.as_bytes()).seed() >> (u64::BITS - SESSION_BITS)
    }

    /// Waits for the driver, tells it the mission, and gives it the map if it wants it.
    async fn hello(
        &self,
        line: &Line,
        wanted: &Wanted<'_>,
        plan: &[Point],
        session: u64,
    ) -> Result<MissionAnswer, Fault> {
        let failed = |why: String| wanted.fault(why);
        let cells = map_cells(&wanted.mission.grid);
        let mission = message(wanted, session, self.drive.mode, plan, &cells)?;
        let claims = line.claims().await.map_err(failed)?;
        let answer = line.mission(&mission).await;
        claims.alone().await.map_err(failed)?;
        let answer = answer.map_err(failed)?;
        if answer.map {
            line.map(session, &cells).await.map_err(failed)?;
        }
        Ok(answer)
    }
}

impl Outside for OverBus {
    fn begin(&mut self, wanted: &Wanted<'_>) -> Result<Box<dyn Driver>, Fault> {
        let session = self.session(wanted);
        let line = Line::new(Arc::clone(&self.bus), wanted.driver, self.drive.patience);
        let plan = socrates_planners::free_way(wanted.mission);
        let answer = self.handle.block_on(self.hello(&line, wanted, &plan, session))?;
        Ok(Box::new(Remote {
            line,
            place: wanted.place(),
            handle: self.handle.clone(),
            drive: self.drive,
            cancel: self.cancel.clone(),
            session,
            answer,
            goal: wanted.mission.waypoints.last().copied(),
            plan: Polyline::new(&plan),
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
    line: Line,
    /// Where its faults are.
    place: String,
    handle: Handle,
    drive: Drive,
    cancel: Cancel,
    session: u64,
    answer: MissionAnswer,
    goal: Option<Point>,
    plan: Polyline,
    /// How far along the plan the one who is driven is, m.
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
            ShownPeople::Seen => Vec::new(),
            ShownPeople::All => {
                let in_sight = |person: &SeenPerson| seen.people.iter().any(|other| other.id == person.id);
                (seen.everybody)().into_iter().filter(|person| !in_sight(person)).collect()
            }
        };
        let lidar = if self.answer.lidar { (seen.lidar)() } else { Vec::new() };
        let robot = seen.robot.filter(|robot| robot.in_sight || self.answer.people == ShownPeople::All);
        step_bytes(&head, &Observation { robot, ..*seen }, &hidden, &lidar)
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
        self.fault = Some(fault(&self.place, format!("at {now_s:.2} s: {why}")));
    }

    /// The simulation stands until the answer is there, at most so long.
    fn wait(&mut self, seen: &Observation<'_>, limit: Duration, now_s: f64) {
        let (body, call) = (self.bytes(seen), self.call);
        match self.handle.block_on(self.line.step(body, limit)) {
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
            let (body, line, patience) = (self.bytes(seen), self.line.clone(), self.drive.patience);
            let asked = self.handle.spawn(async move { line.step(body, patience).await });
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
            Mode::Step => self.wait(seen, self.drive.patience, now_s),
            Mode::Wait(limit) => self.wait(seen, limit, now_s),
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
        if let Err(why) = self.handle.block_on(self.line.end(&message, FAREWELL)) {
            // The run is whole without it.
            tracing::debug!(driver = self.line.driver(), why, "the driver did not take note of the end");
        }
    }

    fn fault(&self) -> Option<Fault> {
        self.fault.clone()
    }
}
