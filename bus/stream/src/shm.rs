//! Frames through shared memory, for readers on the same host. A run never depends on it.

use std::io::Write as _;
use std::path::Path as FsPath;
use std::sync::{Arc, Mutex, PoisonError};

use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::{
    AllocationStrategy, Config, FileName, LogLevel, Node, NodeBuilder, Path, SemanticString as _, ServiceName,
    SignalHandlingMode, ZeroCopySend, ipc_threadsafe, set_log_level,
};
use iceoryx2::service::port_factory::PortFactory as _;
use socrates_model::recording::{AGENT_STATE_BYTES, AgentState, Event, RecordingHeader};
use socrates_model::{Onlooker, RunId};

use crate::corner::{SharedMemory, ShmConfig};
use crate::error::StreamError;
use crate::order::{Order, Seen, TickRange};

/// Folder where shared memory segments live on this system.
const SHM_FOLDER: &str = "/dev/shm";
/// Readers at a time.
const READERS: usize = 4;
/// Ticks that wait for a reader, and that a late reader still gets, at most; the oldest is replaced.
const BUFFER: usize = 64;
/// Ticks that wait at least, however many agents there are.
const LEAST_BUFFER: usize = 4;
/// Bytes of shared memory that a run takes, where the least buffer needs no more.
const ROOM: usize = 16 * 1024 * 1024;

/// Ticks of so many agents that wait for a reader.
const fn buffer(agents: usize) -> usize {
    let ticks = ROOM / (agents * AGENT_STATE_BYTES);
    // As `samples` counts them.
    let fit = ticks.saturating_sub(2 * READERS + 2) / (READERS + 1);
    if fit > BUFFER {
        BUFFER
    } else if fit < LEAST_BUFFER {
        LEAST_BUFFER
    } else {
        fit
    }
}

/// Ticks that a writer needs room for: those that wait, those that are read, those for who comes late.
const fn samples(buffer: usize) -> usize {
    READERS * (buffer + 2) + buffer + 2
}

/// [`AgentState`] in the layout that is shared: the same 64 bytes.
#[derive(Debug, Clone, Copy, PartialEq, ZeroCopySend)]
#[type_name("socrates.AgentState.v1")]
#[repr(C)]
pub struct ShmState {
    /// Tick number.
    pub tick: u64,
    /// 0 for the robot, k for `human_k`.
    pub agent: u32,
    /// Kind, gesture, leaf.
    pub flags: u32,
    /// x, m.
    pub x: f64,
    /// y, m.
    pub y: f64,
    /// Heading, rad.
    pub yaw: f64,
    /// Velocity along x, m/s.
    pub vx: f64,
    /// Velocity along y, m/s.
    pub vy: f64,
    /// Turning rate, rad/s.
    pub omega: f64,
}

const _: () = assert!(size_of::<ShmState>() == AGENT_STATE_BYTES && align_of::<ShmState>() == 8);

impl From<&AgentState> for ShmState {
    fn from(state: &AgentState) -> Self {
        let AgentState { tick, agent, flags, x, y, yaw, vx, vy, omega } = *state;
        Self { tick, agent, flags, x, y, yaw, vx, vy, omega }
    }
}

impl From<&ShmState> for AgentState {
    fn from(state: &ShmState) -> Self {
        let ShmState { tick, agent, flags, x, y, yaw, vx, vy, omega } = *state;
        Self { tick, agent, flags, x, y, yaw, vx, vy, omega }
    }
}

impl ShmConfig {
    /// Closes the user's segments to others: the library opens one to everybody, a counter of its nodes. What cannot be
    /// closed is not the user's.
    fn close_segments(&self) {
        use std::os::unix::fs::PermissionsExt as _;
        let segments = std::fs::read_dir(SHM_FOLDER).into_iter().flatten().filter_map(Result::ok);
        for segment in segments.filter(|entry| entry.file_name().to_string_lossy().starts_with(&self.prefix)) {
            drop(std::fs::set_permissions(segment.path(), std::fs::Permissions::from_mode(0o600)));
        }
    }

    /// Makes the folder, or looks whether the one that is there is the user's own and closed to everybody else: another
    /// user may have made one of that name, to read what is put there.
    fn claim(&self) -> Result<(), String> {
        use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
        match std::fs::DirBuilder::new().mode(0o700).create(&self.root) {
            Err(why) if why.kind() != std::io::ErrorKind::AlreadyExists => return Err(why.to_string()),
            Ok(()) | Err(_) => {}
        }
        // The folder itself, not what a link of its name points to.
        let there = std::fs::symlink_metadata(&self.root).map_err(|why| why.to_string())?;
        let (owner, mode) = (there.uid(), there.mode() & 0o777);
        if there.is_dir() && owner == self.user && mode == 0o700 {
            return Ok(());
        }
        Err(format!("`{}` is of user {owner} with mode {mode:o}, not of user {} alone", self.root.display(), self.user))
    }
}

type Ipc = ipc_threadsafe::Service;

/// Shared memory as one process sees it: joined at the first run and left with the last clone. Joining takes longer than
/// many a run, so it is done once.
#[derive(Clone)]
pub struct ShmHost {
    config: ShmConfig,
    node: Arc<Mutex<Option<Node<Ipc>>>>,
}

impl std::fmt::Debug for ShmHost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ShmHost").field("config", &self.config).finish_non_exhaustive()
    }
}

impl ShmHost {
    /// The shared memory that is arranged so; nothing is done before the first run.
    #[must_use]
    pub fn new(config: ShmConfig) -> Self {
        Self { config, node: Arc::default() }
    }

    /// A sink for the ticks of a run, and where it puts them; none where shared memory cannot be had, which is logged.
    #[must_use]
    pub fn sink(&self, run: &RunId) -> Option<(Box<dyn Onlooker + Send>, SharedMemory)> {
        match ShmSink::open(run, self) {
            Ok(sink) => {
                let place = sink.place.clone();
                Some((Box::new(sink), place))
            }
            Err(why) => {
                tracing::warn!(%why, "no shared memory for this run");
                None
            }
        }
    }

    /// Joins, unless that was done.
    fn join(&self, node: &mut Option<Node<Ipc>>) -> Result<(), (&'static str, String)> {
        if node.is_some() {
            return Ok(());
        }
        let failed = |what: &'static str, why: &dyn std::fmt::Debug| (what, format!("{why:?}"));
        self.config.claim().map_err(|why| failed("claiming the folder", &why))?;
        // Failures come back as values; the library's own lines would reach a terminal.
        set_log_level(LogLevel::Fatal);
        let mut settings = Config::default();
        let root = Path::new(self.config.root.as_os_str().as_encoded_bytes())
            .map_err(|why| failed("reading the root path", &why))?;
        settings.global.set_root_path(&root);
        settings.global.prefix =
            FileName::new(self.config.prefix.as_bytes()).map_err(|why| failed("reading the prefix", &why))?;
        // Corpses of killed processes are cleared away by whoever comes next.
        settings.global.node.cleanup_dead_nodes_on_creation = true;
        settings.global.service.cleanup_dead_nodes_on_open = true;
        let joined = NodeBuilder::new()
            .config(&settings)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|why| failed("joining", &why))?;
        self.config.close_segments();
        *node = Some(joined);
        Ok(())
    }

    /// Calls `with` with the node of this process.
    fn with<T>(
        &self,
        with: impl FnOnce(&Node<Ipc>) -> Result<T, (&'static str, String)>,
    ) -> Result<T, (&'static str, String)> {
        let mut node = self.node.lock().unwrap_or_else(PoisonError::into_inner);
        self.join(&mut node)?;
        node.as_ref().map_or_else(|| Err(("joining", "there is no node".to_owned())), with)
    }
}

/// The run's corner of shared memory.
struct Corner {
    run: String,
    host: ShmHost,
    name: ServiceName,
}

impl Corner {
    fn open(run: &RunId, host: &ShmHost) -> Result<Self, StreamError> {
        let told = |(what, why)| StreamError::Shm { run: run.to_string(), what, why };
        host.with(|_node| Ok(())).map_err(told)?;
        let name = ServiceName::new(&format!("socrates/{run}")).map_err(|why| told(("naming", format!("{why:?}"))))?;
        Ok(Self { run: run.to_string(), host: host.clone(), name })
    }

    fn failed(&self, what: &'static str, why: &dyn std::fmt::Debug) -> StreamError {
        self.told((what, format!("{why:?}")))
    }

    fn told(&self, (what, why): (&'static str, String)) -> StreamError {
        StreamError::Shm { run: self.run.clone(), what, why }
    }
}

/// Puts the ticks of a run into shared memory. When that fails, it says so once and takes no more.
pub struct ShmSink {
    corner: Corner,
    port: Option<Publisher<Ipc, [ShmState], ()>>,
    place: SharedMemory,
}

impl ShmSink {
    /// Prepares a run; memory is taken at the announcement, when the number of agents is known.
    ///
    /// # Errors
    /// [`StreamError::Shm`]: the caller goes on without.
    pub fn open(run: &RunId, host: &ShmHost) -> Result<Self, StreamError> {
        Ok(Self { corner: Corner::open(run, host)?, port: None, place: SharedMemory::default() })
    }

    fn create(&self, agents: usize) -> Result<Publisher<Ipc, [ShmState], ()>, StreamError> {
        let buffer = buffer(agents);
        room_for(samples(buffer) * agents * AGENT_STATE_BYTES)
            .map_err(|why| self.corner.failed("finding room", &why))?;
        let created = self.corner.host.with(|node| {
            let service = node.service_builder(&self.corner.name).publish_subscribe::<[ShmState]>();
            service
                .max_publishers(1)
                .max_subscribers(READERS)
                .max_nodes(READERS + 4)
                .subscriber_max_buffer_size(buffer)
                .history_size(buffer)
                .enable_safe_overflow(true)
                .open_or_create()
                .map_err(|why| ("creating the service", format!("{why:?}")))
        });
        let service = created.map_err(|why| self.corner.told(why))?;
        service
            .publisher_builder()
            .initial_max_slice_len(agents)
            .allocation_strategy(AllocationStrategy::Static)
            .create()
            .map_err(|why| self.corner.failed("creating the publisher", &why))
    }

    fn send(&self, states: &[AgentState]) -> Result<(), StreamError> {
        let Some(port) = &self.port else { return Ok(()) };
        let sample = port.loan_slice_uninit(states.len()).map_err(|why| self.corner.failed("loaning", &why))?;
        let mut left = states.iter();
        // The loan has exactly as many places as there are states.
        let end = AgentState { tick: 0, agent: 0, flags: 0, x: 0., y: 0., yaw: 0., vx: 0., vy: 0., omega: 0. };
        let sample = sample.write_from_fn(|_place| ShmState::from(left.next().unwrap_or(&end)));
        sample.send().map_err(|why| self.corner.failed("sending", &why))?;
        Ok(())
    }
}

impl Onlooker for ShmSink {
    fn announce(&mut self, header: &RecordingHeader) {
        match self.create(header.agents.len().max(1)) {
            Ok(port) => {
                self.port = Some(port);
                self.place.is_at(self.corner.name.as_str());
            }
            Err(why) => tracing::warn!(%why, "no shared memory for this run"),
        }
    }

    fn tick(&mut self, states: &[AgentState], _events: &[Event]) {
        if let Err(why) = self.send(states) {
            tracing::warn!(%why, "shared memory is given up for this run");
            self.port = None;
        }
    }
}

/// Whether so many bytes are free in shared memory: over-committing it shows as a signal, not as an error.
fn room_for(bytes: usize) -> std::io::Result<()> {
    if !FsPath::new(SHM_FOLDER).is_dir() {
        return Ok(());
    }
    let probe = FsPath::new(SHM_FOLDER).join(format!("socrates-probe-{}", std::process::id()));
    let written = std::fs::File::create(&probe).and_then(|mut file| {
        let page = [0_u8; 4096];
        (0..bytes.div_ceil(page.len())).try_for_each(|_page| file.write_all(&page))
    });
    std::fs::remove_file(&probe)?;
    written
}

/// Reads the ticks of a run from shared memory.
pub struct ShmWatch {
    corner: Corner,
    port: Subscriber<Ipc, [ShmState], ()>,
    order: Order,
}

impl ShmWatch {
    /// Joins a run that was announced; the last ticks before are still seen.
    ///
    /// # Errors
    /// [`StreamError::Shm`], also when there is no such run.
    pub fn open(run: &RunId, host: &ShmHost) -> Result<Self, StreamError> {
        let corner = Corner::open(run, host)?;
        let opened = corner.host.with(|node| {
            let service = node.service_builder(&corner.name).publish_subscribe::<[ShmState]>().open();
            service.map_err(|why| ("opening the service", format!("{why:?}")))
        });
        let service = opened.map_err(|why| corner.told(why))?;
        let buffer = service.static_config().subscriber_max_buffer_size();
        let port = service
            .subscriber_builder()
            .buffer_size(buffer)
            .create()
            .map_err(|why| corner.failed("creating the subscriber", &why))?;
        Ok(Self { corner, port, order: Order::new() })
    }

    /// The next tick, if one is here now; never an older one.
    ///
    /// # Errors
    /// [`StreamError::Shm`].
    pub fn poll(&mut self) -> Result<Option<Vec<AgentState>>, StreamError> {
        self.look(|states| states.iter().map(AgentState::from).collect())
    }

    /// The same without a copy: `with` reads the tick where the simulation wrote it, in the header's order.
    ///
    /// # Errors
    /// [`StreamError::Shm`].
    pub fn look<T>(&mut self, with: impl FnOnce(&[ShmState]) -> T) -> Result<Option<T>, StreamError> {
        while let Some(sample) = self.port.receive().map_err(|why| self.corner.failed("receiving", &why))? {
            let Some(first) = sample.payload().first() else { continue };
            if self.order.saw(first.tick) != Seen::Old {
                return Ok(Some(with(sample.payload())));
            }
        }
        Ok(None)
    }

    /// Ticks that were overwritten before they were read, in order.
    #[must_use]
    pub fn missing(&self) -> &[TickRange] {
        self.order.missing()
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use socrates_tests::skip::elsewhere;

    use super::*;
    use crate::csv;

    fn config(dir: &FsPath) -> ShmConfig {
        use std::os::unix::fs::MetadataExt as _;
        let prefix = format!("soct{}_", dir.file_name().unwrap().to_string_lossy().replace('.', ""));
        ShmConfig { root: dir.join("shm"), prefix, user: std::fs::metadata(dir).unwrap().uid() }
    }

    #[test]
    fn a_folder_that_others_can_enter_is_not_used() {
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().unwrap();
        let own = config(dir.path());
        own.claim().unwrap();
        own.claim().unwrap();
        std::fs::set_permissions(&own.root, std::fs::Permissions::from_mode(0o755)).unwrap();
        assert!(own.claim().unwrap_err().contains("mode 755"));
        std::fs::set_permissions(&own.root, std::fs::Permissions::from_mode(0o700)).unwrap();
        let other = ShmConfig { user: own.user + 1, ..own.clone() };
        assert!(other.claim().unwrap_err().contains(&format!("is of user {}", own.user)));
        let link = dir.path().join("link");
        std::os::unix::fs::symlink(&own.root, &link).unwrap();
        assert!(ShmConfig { root: link, ..own }.claim().is_err(), "a link is no folder");
    }

    /// Every segment and folder that a run has, with its mode.
    fn modes(config: &ShmConfig) -> Vec<(PathBuf, u32)> {
        use std::os::unix::fs::PermissionsExt as _;
        let of = |path: PathBuf| std::fs::metadata(&path).ok().map(|there| (path, there.permissions().mode() & 0o777));
        let segments = std::fs::read_dir(SHM_FOLDER).unwrap().filter_map(Result::ok).map(|entry| entry.path());
        let segments = segments.filter(|path| path.file_name().unwrap().to_string_lossy().contains(&config.prefix));
        segments.chain([config.root.clone()]).filter_map(of).collect()
    }

    #[test]
    fn a_reader_gets_every_tick_in_order_and_knows_what_was_overwritten() {
        let dir = tempfile::tempdir().unwrap();
        let mut text = String::from("t,id,x,y\n");
        for n in 0..3 {
            text.push_str(&format!("{n},robot,{n},0\n{n},human_1,0,{n}\n"));
        }
        let recording = csv::read_tracks(&text).unwrap();
        let run = RunId::new("shm-test").unwrap();
        let (writing, reading) = (ShmHost::new(config(dir.path())), ShmHost::new(config(dir.path())));
        let Some(mut sink) = elsewhere(ShmSink::open(&run, &writing).map_err(|why| why.to_string())) else { return };
        assert!(ShmWatch::open(&run, &reading).is_err(), "nobody has announced the run");
        sink.announce(&recording.header);
        assert!(sink.port.is_some(), "the service was not created");
        let modes = modes(&config(dir.path()));
        assert!(modes.len() > 1, "{modes:?}: a folder and segments");
        assert!(modes.iter().all(|(_, mode)| mode & 0o077 == 0), "{modes:?}: others can look in");
        for tick in 0..10 {
            sink.tick(recording.tick(tick), &[]);
        }
        // A late reader still gets the history.
        let mut watch = ShmWatch::open(&run, &reading).unwrap();
        let mut next = 0;
        for tick in 10..20 {
            sink.tick(recording.tick(tick), &[]);
            while let Some(states) = watch.poll().unwrap() {
                assert_eq!(states, recording.tick(next));
                next += 1;
            }
        }
        assert_eq!(next, 20);
        assert!(watch.missing().is_empty());
        // A reader that sleeps loses the oldest and knows which.
        for tick in 20..200 {
            sink.tick(recording.tick(tick), &[]);
        }
        let mut got = Vec::new();
        while let Some(states) = watch.poll().unwrap() {
            got.push(states[0].tick);
        }
        let lost: u64 = watch.missing().iter().map(|range| range.len()).sum();
        assert_eq!(got.len() as u64 + lost, 180);
        assert_eq!(got.last(), Some(&199));
        assert!(lost > 0);
    }

    #[test]
    fn a_second_run_of_the_same_name_says_that_it_has_no_shared_memory() {
        let dir = tempfile::tempdir().unwrap();
        let recording = csv::read_tracks("t,id,x,y\n0,human_1,0,0\n1,human_1,1,0\n").unwrap();
        let run = RunId::new("twice").unwrap();
        let (one, other) = (ShmHost::new(config(dir.path())), ShmHost::new(config(dir.path())));
        let Some(mut first) = elsewhere(ShmSink::open(&run, &one).map_err(|why| why.to_string())) else { return };
        first.announce(&recording.header);
        assert_eq!(first.place.name().as_deref(), Some("socrates/twice"));
        let mut second = ShmSink::open(&run, &other).unwrap();
        second.announce(&recording.header);
        assert_eq!(second.place.name(), None, "what a reader of it would find is the first");
    }

    #[test]
    fn three_thousand_agents_are_read_whole_and_in_bounded_room() {
        for agents in [1, 10, 1_000, 3_000, 10_000] {
            let room = samples(buffer(agents)) * agents * AGENT_STATE_BYTES;
            assert!(room <= ROOM || buffer(agents) == LEAST_BUFFER, "{agents} agents: {room} bytes");
        }
        let dir = tempfile::tempdir().unwrap();
        let mut recording = csv::read_tracks("t,id,x,y\n0,human_1,0,0\n1,human_1,1,0\n").unwrap();
        let (info, state) = (recording.header.agents[0].clone(), recording.frames[0]);
        recording.header.agents = vec![info; 3_000];
        let states = |tick: u64| -> Vec<AgentState> {
            (0..3_000).map(|agent| AgentState { tick, agent, x: f64::from(agent), ..state }).collect()
        };
        let run = RunId::new("shm-crowd").unwrap();
        let (writing, reading) = (ShmHost::new(config(dir.path())), ShmHost::new(config(dir.path())));
        let Some(mut sink) = elsewhere(ShmSink::open(&run, &writing).map_err(|why| why.to_string())) else { return };
        sink.announce(&recording.header);
        let enough = sink.port.is_some();
        if elsewhere(enough.then_some(()).ok_or_else(|| format!("less shared memory than {ROOM} bytes"))).is_none() {
            return;
        }
        let mut watch = ShmWatch::open(&run, &reading).unwrap();
        for tick in 0..30 {
            sink.tick(&states(tick), &[]);
            assert!(watch.poll().unwrap().unwrap() == states(tick), "tick {tick}");
        }
        assert!(watch.missing().is_empty());
    }

    #[test]
    fn a_process_joins_once_for_all_its_runs() {
        let dir = tempfile::tempdir().unwrap();
        let host = ShmHost::new(config(dir.path()));
        let open = |name: &str| ShmSink::open(&RunId::new(name).unwrap(), &host);
        let Some(first) = elsewhere(open("shm-first").map_err(|why| why.to_string())) else { return };
        let node = || host.with(|node| Ok(format!("{:?}", node.id()))).unwrap();
        let joined = node();
        drop(first);
        let _second = open("shm-second").unwrap();
        assert_eq!(node(), joined);
        assert_ne!(ShmHost::new(config(dir.path())).with(|node| Ok(format!("{:?}", node.id()))).unwrap(), joined);
    }
}
