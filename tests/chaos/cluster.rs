//! A cluster under chaos: a router, an orchestrator and the workers of two machines, each a process that is started again when it ends.

use std::io::Write as _;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use socrates_tests::program::{children, poll, signal, start_typed};

use super::network::Network;
use crate::PROGRAM;

/// Length of a lease, ms: short, so that what is lost comes back while the test looks.
pub(super) const LEASE_MS: u64 = 2_000;
/// File that says how far the clock of the wall is off, for processes that are told a false time.
const CLOCK: &str = "clock";

/// A library that tells processes a false time of the wall; the monotonic clock stays.
pub(super) fn false_clock() -> Result<PathBuf, String> {
    let places = std::fs::read_dir("/usr/lib").into_iter().flatten().filter_map(Result::ok);
    let library =
        |place: std::fs::DirEntry| Some(place.path().join("faketime/libfaketimeMT.so.1")).filter(|file| file.is_file());
    places
        .filter_map(library)
        .next()
        .ok_or_else(|| "there is no libfaketimeMT (Debian: faketime): the clock does not jump".to_owned())
}

/// A file system of its own, gone with this.
pub(super) struct Disk(PathBuf);

impl Disk {
    /// Puts one of so many MiB at `at`.
    pub(super) fn mount(at: &Path, mib: u64) -> Result<Self, String> {
        std::fs::create_dir_all(at).map_err(|why| why.to_string())?;
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", &format!("size={mib}m,mode=700"), "tmpfs"]).arg(at);
        match command.output() {
            Ok(done) if done.status.success() => Ok(Self(at.to_owned())),
            Ok(done) => Err(format!(
                "no file system can be mounted, so no disk is full: {}",
                String::from_utf8_lossy(&done.stderr)
            )),
            Err(why) => Err(format!("no file system can be mounted, so no disk is full: {why}")),
        }
    }

    fn ballast(&self) -> PathBuf {
        self.0.join("ballast")
    }

    /// Fills it to the last byte; whether it really is full.
    pub(super) fn fill(&self) -> bool {
        let Ok(mut file) = std::fs::File::create(self.ballast()) else { return false };
        let mut size = 1 << 20;
        let block = vec![0_u8; size];
        loop {
            match file.write(&block[..size]) {
                Ok(_) => {}
                Err(why) if why.kind() == std::io::ErrorKind::StorageFull && size == 1 => return true,
                Err(why) if why.kind() == std::io::ErrorKind::StorageFull => size /= 2,
                Err(_) => return false,
            }
        }
    }

    /// Makes room again.
    pub(super) fn free(&self) -> bool {
        std::fs::remove_file(self.ballast()).is_ok()
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        drop(Command::new("umount").arg("-l").arg(&self.0).output());
    }
}

/// A process of the cluster, by its place: the newest that was started there.
struct Post {
    name: &'static str,
    /// The program and what it is told.
    line: Vec<String>,
    child: Child,
    starts: u32,
}

/// Where a process stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Router,
    Orchestrator,
    Crew(usize),
}

/// The processes.
pub(super) struct Cluster {
    folder: PathBuf,
    variables: Vec<(String, String)>,
    posts: Vec<Post>,
    /// Processes that ended without being asked to.
    pub(super) fell: u32,
    /// Where clients connect.
    pub(super) endpoint: String,
    address: String,
    /// The network of the second machine, where it has one of its own.
    pub(super) network: Option<Network>,
}

impl Cluster {
    /// Starts everything. `clock`: the library of a false clock, where there is one; `network`: that of the second machine.
    pub(super) fn start(folder: &Path, clock: Option<&Path>, network: Option<Network>) -> Self {
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let address = format!("127.0.0.1:{port}");
        let endpoint = format!("tcp/{address}");
        let mut variables = Vec::new();
        if let Some(library) = clock {
            let file = folder.join(CLOCK);
            std::fs::write(&file, "+0").unwrap();
            let set = |name: &str, value: String| (name.to_owned(), value);
            variables.push(set("LD_PRELOAD", library.display().to_string()));
            variables.push(set("FAKETIME_TIMESTAMP_FILE", file.display().to_string()));
            variables.push(set("FAKETIME_CACHE_DURATION", "1".to_owned()));
            variables.push(set("FAKETIME_DONT_FAKE_MONOTONIC", "1".to_owned()));
        }
        let mut cluster = Self {
            folder: folder.to_owned(),
            variables,
            posts: Vec::new(),
            fell: 0,
            endpoint: endpoint.clone(),
            address,
            network,
        };
        let lease = format!("orchestrator.lease_ms={LEASE_MS}");
        let dir = |name: &str| folder.join(name).display().to_string();
        let owned = |parts: &[&[&str]]| parts.concat().into_iter().map(str::to_owned).collect::<Vec<String>>();
        let up = ["cluster", "up", "--durable", "process", "--dir"];
        let (listen, far, enter) = match &cluster.network {
            Some(network) => {
                (format!("tcp/0.0.0.0:{port}"), format!("tcp/{}:{port}", network.address), network.enter())
            }
            None => (endpoint.clone(), endpoint.clone(), Vec::new()),
        };
        let router = ["--listen", &listen, "--insecure", "--namespace", "router"];
        cluster.post("router", &[], owned(&[&up, &[&dir("router")], &router]));
        assert!(poll(|| cluster.listens().then_some(())).is_some(), "nobody listens");
        let beats =
            ["--set", &lease, "--set", "orchestrator.beat_ms=400", "--set", "log.filter=warn,socrates_app=info"];
        cluster.post("orchestrator", &[], owned(&[&up, &[&dir("jobs"), "--connect", &endpoint], &beats]));
        for (name, enter, endpoint) in [("crew-0", &[][..], &endpoint), ("crew-1", &enter, &far)] {
            let own = dir(name);
            let work = ["cluster", "work", "--dir", &own, "--connect", endpoint, "--slots", "1"];
            // Every attempt says when it begins.
            let log = ["--set", "log.filter=warn,socrates_kit::attempt=debug"];
            cluster.post(name, enter, owned(&[&work, &log]));
        }
        cluster
    }

    fn spawn(&self, name: &str, line: &[String], number: u32) -> Child {
        let (program, args) = line.split_first().unwrap();
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let variables: Vec<(&str, &str)> =
            self.variables.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
        start_typed(program, &args, &self.folder, &format!("{name}.{number}"), "", &variables).unwrap()
    }

    /// `enter`: what the command begins with that leads into the network of its machine.
    fn post(&mut self, name: &'static str, enter: &[String], args: Vec<String>) {
        let line = [enter, &[PROGRAM.to_owned()], &args].concat();
        let child = self.spawn(name, &line, 0);
        self.posts.push(Post { name, line, child, starts: 1 });
    }

    fn index(place: Place) -> usize {
        match place {
            Place::Router => 0,
            Place::Orchestrator => 1,
            Place::Crew(number) => 2 + number,
        }
    }

    /// The process at a place.
    pub(super) fn pid(&self, place: Place) -> u32 {
        self.posts[Self::index(place)].child.id()
    }

    /// The worker of a stage on a machine; none while it is being started.
    pub(super) fn worker(&self, crew: usize, stage: &str) -> Option<u32> {
        let wanted = format!("worker {stage} ");
        children(self.pid(Place::Crew(crew))).into_iter().find(|(_, line)| line.contains(&wanted)).map(|(pid, _)| pid)
    }

    fn restart(&mut self, index: usize) {
        let number = self.posts[index].starts;
        let child = self.spawn(self.posts[index].name, &self.posts[index].line, number);
        self.posts[index].child = child;
        self.posts[index].starts += 1;
    }

    /// Kills the process at a place and starts another; whether it was a SIGKILL that ended it.
    pub(super) fn replace(&mut self, place: Place) -> bool {
        use std::os::unix::process::ExitStatusExt as _;
        let index = Self::index(place);
        let killed = signal(self.posts[index].child.id(), "KILL").unwrap();
        let ended = self.posts[index].child.wait().unwrap();
        self.restart(index);
        killed && ended.signal() == Some(9)
    }

    /// Starts again what ended by itself, as whoever runs a cluster has it done.
    pub(super) fn tend(&mut self) {
        for index in 0..self.posts.len() {
            if self.posts[index].child.try_wait().unwrap().is_some() {
                self.fell += 1;
                self.restart(index);
            }
        }
    }

    /// Whether its processes can be told a false time.
    pub(super) fn has_false_clock(&self) -> bool {
        !self.variables.is_empty()
    }

    /// Files into which the workers tell of their attempts, with the number of their machine, and orchestrators that they begin.
    pub(super) fn logs(&self) -> Vec<(Option<usize>, PathBuf)> {
        let of = |(place, machine): (Place, Option<usize>)| {
            let post = &self.posts[Self::index(place)];
            (0..post.starts).map(move |number| (machine, self.folder.join(format!("{}.{number}.err", post.name))))
        };
        let places = [(Place::Orchestrator, None), (Place::Crew(0), Some(0)), (Place::Crew(1), Some(1))];
        places.into_iter().flat_map(of).collect()
    }

    /// Whether the router takes connections.
    pub(super) fn listens(&self) -> bool {
        TcpStream::connect(&self.address).is_ok()
    }

    /// Sets the clock of the wall off by so many seconds; whether a process of the cluster's surroundings sees it.
    pub(super) fn set_clock(&self, off_s: i64) -> bool {
        std::fs::write(self.folder.join(CLOCK), format!("{off_s:+}")).unwrap();
        let told = |false_time: bool| -> Option<i64> {
            let mut command = Command::new("date");
            command.arg("+%s");
            if false_time {
                command.envs(self.variables.iter().map(|(name, value)| (name, value)));
            }
            String::from_utf8(command.output().ok()?.stdout).ok()?.trim().parse().ok()
        };
        let maps = format!("/proc/{}/maps", self.pid(Place::Orchestrator));
        let is_loaded = std::fs::read_to_string(maps).is_ok_and(|maps| maps.contains("libfaketime"));
        let seen = told(true).zip(told(false)).map(|(wrong, right)| wrong - right - off_s);
        is_loaded && seen.is_some_and(|rest| rest.abs() < 10)
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for post in &mut self.posts {
            drop(post.child.kill());
            drop(post.child.wait());
        }
    }
}
