//! The worker's stage: a job in, a recording and its summary out.

use std::sync::Arc;
use std::time::{Duration, Instant};

use socrates_engine::Setup;
use socrates_kit::{Cancel, Done, Failure, Job, Output, Stage, media};
use socrates_model::live::LiveEnd;
use socrates_model::{
    AgentState, Digest, Event, FailureClass, Fault, FaultCode, Location, Onlooker, PlannerName, Reading,
    RecordingHeader, Request, Role, RunId, Where, fault,
};
use socrates_stream::mcap::{Tape, Writer};
use socrates_stream::{Linger, LiveSink, SharedMemory, ShmHost, StreamError};
use tokio::runtime::Handle;

use crate::driving::{Drive, Mode, OverBus};
use crate::pace::Pace;
use crate::scene::scene;
use crate::simulate::{Driven, setup, simulate_into};
use crate::summary::Summary;

/// How long the frames of a finished run can still be fetched from the bus.
const LINGER: Duration = Duration::from_secs(3);
/// How many finished runs stay that nobody watches: a batch of short runs would gather many.
const LINGERING: usize = 4;

/// The simulation stage. Settings: `pace` (`max` or simulated seconds per second), `live` (`off`, `bus`,
/// `shm`, `on` for both; default `off`), `drive` and `drive_patience_s` of drivers outside (see [`Drive::read`]).
#[derive(Debug, Clone)]
pub struct Simulation {
    /// For readers on this machine.
    shm: ShmHost,
    linger: Linger,
}

impl Simulation {
    /// A stage that puts runs into this shared memory.
    #[must_use]
    pub fn new(shm: ShmHost) -> Self {
        Self { shm, linger: Linger::new(LINGER, LINGERING) }
    }
}

/// Everything of a job, decoded.
struct Inputs {
    setup: Setup,
    planner: PlannerName,
    request: Option<Request>,
    location: Location,
}

fn inputs(job: &Job) -> Result<Inputs, Failure> {
    let location: Location = job.json(Role::Location)?;
    let (proposal, paths, behaviors) = (job.json(Role::Proposal)?, job.json(Role::Paths)?, job.json(Role::Behaviors)?);
    let request: Option<Request> = job.json_if_there(Role::Request)?;
    let reading: Option<Reading> = job.json_if_there(Role::Reading)?;
    let hard = fault::hard(&socrates_checks::check_all(&location, reading.as_ref(), &proposal, &paths, &behaviors));
    if !hard.is_empty() {
        return Err(Failure::from_faults(hard));
    }
    let spec = job.spec();
    let run = spec.run().ok_or_else(|| {
        let message = "the job names no run: neither a planner nor a seed";
        Failure::new(FailureClass::Poison, vec![Fault::new(FaultCode::JSpec, &spec.key, message)])
    })?;
    let id = run.id(&spec.key.scenario);
    let setup = setup(location.clone(), proposal, paths, behaviors, request.as_ref(), id, run.seed);
    Ok(Inputs { setup, planner: run.planner.clone(), request, location })
}

/// Writes the run down while it goes, chunk by chunk.
struct Scribe {
    tape: Tape,
    location: Location,
    begun: Option<(Writer<Tape>, Summary)>,
    /// The first thing that went wrong; nothing more is written then.
    broken: Option<StreamError>,
}

impl Scribe {
    fn announce(&mut self, header: &RecordingHeader) {
        match self.tape.record(header, Some(&self.location)) {
            Ok(writer) => self.begun = Some((writer, Summary::begun(header))),
            Err(why) => self.broken = Some(why),
        }
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        let Some((writer, summary)) = &mut self.begun else { return };
        events.iter().for_each(|event| summary.event(event));
        let written = writer.tick(states).and_then(|()| events.iter().try_for_each(|event| writer.event(event)));
        if let Err(why) = written {
            self.broken = Some(why);
            self.begun = None;
        }
    }

    /// Ends the recording and makes the outputs of the job, and what viewers are told of it.
    fn outputs(self, run: &RunId) -> Result<(Done, LiveEnd), Failure> {
        let told = |why: &dyn std::fmt::Display| {
            Failure::from(Fault::new(
                FaultCode::JBlob,
                Where::key(run),
                format!("the recording cannot be written: {why}"),
            ))
        };
        let (writer, mut summary) = match (self.begun, self.broken) {
            (Some(begun), None) => begun,
            (_, Some(why)) => return Err(told(&why)),
            (None, None) => return Err(told(&"the run never began")),
        };
        let (tape, whole) = writer.finish().map_err(|why| told(&why))?;
        let file = tape.bytes();
        let end = LiveEnd { recording: Some(whole.hash), file: Some(Digest::of(&file)) };
        summary.ends(whole.ticks, whole.hash);
        let recording = Output::bytes(Role::Recording, media::MCAP, file);
        Ok((Done::with(vec![recording, Output::json(Role::Simulation, &summary)?]).remark(summary.remark()), end))
    }
}

/// Hands a run to whoever writes it down and to its viewers, and keeps the pace.
struct Viewers {
    scribe: Scribe,
    sinks: Vec<Box<dyn Onlooker + Send>>,
    pace: Pace,
    start: Instant,
    cancel: Cancel,
    handle: Handle,
}

impl Onlooker for Viewers {
    fn announce(&mut self, header: &RecordingHeader) {
        self.scribe.announce(header);
        self.sinks.iter_mut().for_each(|sink| sink.announce(header));
        self.start = Instant::now();
    }

    fn tick(&mut self, states: &[AgentState], events: &[Event]) {
        let tick = states.first().map_or(0, |state| state.tick);
        // First what is kept: whom a viewer asks for an older tick is the recording.
        self.scribe.tick(states, events);
        self.sinks.iter_mut().for_each(|sink| sink.tick(states, events));
        let left = self.pace.left(self.start, tick + 1);
        // Short waits are gathered; a canceled run is played to its end without waiting.
        if left > Duration::from_millis(2) && !self.cancel.is_stopped() {
            let _timed_out = self.handle.block_on(tokio::time::timeout(left, self.cancel.stopped()));
        }
    }
}

async fn viewers(
    job: &Job,
    setup: &Setup,
    location: Location,
    pace: Pace,
    stage: &Simulation,
) -> Result<Viewers, Failure> {
    let run = &setup.run;
    let tape = Tape::default();
    let live = job.setting("live").unwrap_or("off");
    let (bus, shm) = match live {
        "" | "off" | "0" | "false" => (false, false),
        "bus" => (true, false),
        "shm" => (false, true),
        _ => (true, true),
    };
    let mut sinks: Vec<Box<dyn Onlooker + Send>> = Vec::new();
    let mut shared = SharedMemory::default();
    // Announced before the bus, which then tells whether it is there.
    if shm && let Some((sink, place)) = stage.shm.sink(run) {
        sinks.push(sink);
        shared = place;
    }
    if bus {
        let has_robot = job.spec().run().is_none_or(|run| !run.planner.is_no_robot());
        let told = scene(setup, has_robot, job.spec(), pace);
        match LiveSink::open(Arc::clone(&job.live_bus()), run, told, tape.clone(), &stage.linger).await {
            Ok(sink) => sinks.push(Box::new(sink.sharing(shared))),
            // Viewers never decide about a run.
            Err(why) => tracing::warn!(%run, %why, "nobody can watch this run over the bus"),
        }
    }
    let scribe = Scribe { tape, location, begun: None, broken: None };
    let (start, cancel) = (Instant::now(), job.cancel().clone());
    Ok(Viewers { scribe, sinks, pace, start, cancel, handle: Handle::current() })
}

impl Stage for Simulation {
    const STAGE: socrates_model::job::Stage = socrates_model::job::Stage::Simulation;

    async fn run(&self, job: &Job) -> Result<Done, Failure> {
        let Inputs { setup, planner, request, location } = inputs(job)?;
        let run = setup.run.clone();
        let drive = Drive::read(job.setting("drive"), job.setting("drive_patience_s"))?;
        let is_driven =
            planner.external().is_some() || request.as_ref().is_some_and(|request| !request.people.is_empty());
        let pace = match Pace::read(job.setting("pace"))? {
            Pace::Max if drive.mode == Mode::Free && is_driven => Pace::Times(1.0),
            pace @ (Pace::Max | Pace::Times(_)) => pace,
        };
        let mut viewers = viewers(job, &setup, location, pace, self).await?;
        let mut outside = OverBus::new(job.live_bus(), Handle::current(), drive, job.cancel().clone());
        let named = run.clone();
        let work = tokio::task::spawn_blocking(move || {
            let driven = request.as_ref().map_or_else(|| Driven::from(&planner), |all| Driven::of(all, &planner));
            let commands = simulate_into(setup, driven, &mut outside, &mut viewers)?;
            let Viewers { scribe, mut sinks, .. } = viewers;
            let (mut done, end) = scribe.outputs(&named)?;
            if let Some(commands) = commands {
                done.artifacts.push(Output::json(Role::Commands, &commands)?);
            }
            // The recording is whole before the run is over for its viewers: what they ask for from now on is in it.
            sinks.iter_mut().for_each(|sink| sink.end(&end));
            Ok(done)
        });
        match work.await {
            Ok(done) => done,
            Err(why) => Err(Failure::from(Fault::new(
                FaultCode::JPanic,
                Where::key(&run),
                format!("the simulation broke: {why}"),
            ))),
        }
    }
}
