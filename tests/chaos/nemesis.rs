//! The nemesis: inflicts the faults of a schedule and makes sure that each really struck.

use std::time::{Duration, Instant};

use socrates_tests::program::{poll, signal};

use super::cluster::{Cluster, Disk, Place};
use super::figures::Log;
use super::network::{Network, Trouble};
use super::schedule::{Fault, Kind};

/// How long a worker that is to be struck at work may be idle.
const IDLE: Duration = Duration::from_secs(2);
/// Packets of a hundred that are lost each way, where they are.
const LOST: u32 = 20;

/// A fault that was inflicted.
pub(super) struct Struck {
    pub(super) fault: Fault,
    /// When.
    pub(super) at: Instant,
    /// When what it struck could work again.
    pub(super) over: Instant,
    /// Whether it was seen to strike.
    pub(super) fired: bool,
}

/// What the kernel says a process does: `T` where it is stopped; none where it is gone.
fn doing(pid: u32) -> Option<char> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    stat.rsplit_once(") ")?.1.chars().next()
}

/// What faults are done to.
pub(super) struct Storm {
    pub(super) cluster: Cluster,
    pub(super) disk: Option<Disk>,
    /// What the workers tell.
    pub(super) log: Log,
    /// How far the clock of the wall is off, s.
    pub(super) off_s: i64,
}

impl Storm {
    /// Starts again what ended by itself, and reads on.
    pub(super) fn tend(&mut self) {
        self.cluster.tend();
        self.log.look(self.cluster.logs());
    }

    /// Lets so much time pass, while the cluster is looked after.
    fn last(&mut self, ms: u64) {
        let begun = Instant::now();
        let over = poll(|| {
            self.tend();
            (begun.elapsed() >= Duration::from_millis(ms)).then_some(())
        });
        assert!(over.is_some());
    }

    /// The worker that a fault is about, at the moment at which it begins something; after a while also an idle one.
    fn worker(&mut self, fault: Fault) -> u32 {
        let stage = format!("/{}/", fault.stage);
        let (begun, before) = (Instant::now(), self.log.begun.len());
        let found = poll(|| {
            self.tend();
            let pid = self.cluster.worker(fault.crew, fault.stage)?;
            let begins =
                self.log.begun.iter().skip(before).any(|one| one.crew == fault.crew && one.job.contains(&stage));
            (begins || begun.elapsed() > IDLE).then_some(pid)
        });
        found.unwrap()
    }

    /// Stops a process for a while; whether it was seen to stop and to go on.
    fn freeze(&mut self, pid: u32, ms: u64) -> bool {
        let stopped = signal(pid, "STOP").unwrap() && poll(|| (doing(pid) == Some('T')).then_some(())).is_some();
        self.last(ms);
        signal(pid, "CONT").unwrap() && poll(|| (doing(pid)? != 'T').then_some(())).is_some() && stopped
    }

    /// Troubles the packets of the second machine for a while; whether the kernel dropped some.
    fn packets(&mut self, trouble: Trouble, ms: u64) -> bool {
        let begun = self.cluster.network.as_ref().is_some_and(|network| network.begin(trouble));
        self.last(ms);
        let dropped = self.cluster.network.as_ref().and_then(Network::end);
        begun && dropped.is_some_and(|packets| packets > 0)
    }

    /// Inflicts a fault.
    pub(super) fn inflict(&mut self, fault: Fault) -> Struck {
        let struck = match fault.kind {
            Kind::KillWorker | Kind::FreezeWorker => Some(self.worker(fault)),
            Kind::FreezeOrchestrator => Some(self.cluster.pid(Place::Orchestrator)),
            Kind::KillCrew
            | Kind::KillOrchestrator
            | Kind::KillRouter
            | Kind::FullDisk
            | Kind::ClockJump
            | Kind::Partition
            | Kind::Loss => None,
        };
        let at = Instant::now();
        let fired = match (fault.kind, struck) {
            (Kind::KillWorker, Some(pid)) => {
                let gone = || doing(pid).is_none_or(|state| state == 'Z').then_some(());
                signal(pid, "KILL").unwrap() && poll(gone).is_some()
            }
            (_, Some(pid)) => self.freeze(pid, fault.lasts_ms),
            (Kind::KillCrew, None) => self.cluster.replace(Place::Crew(fault.crew)),
            (Kind::KillOrchestrator, None) => self.cluster.replace(Place::Orchestrator),
            (Kind::KillRouter, None) => {
                self.cluster.replace(Place::Router) && poll(|| self.cluster.listens().then_some(())).is_some()
            }
            (Kind::ClockJump, None) => {
                self.off_s += fault.jump_s;
                self.cluster.set_clock(self.off_s)
            }
            (Kind::Partition, None) => self.packets(Trouble::Cut, fault.lasts_ms),
            (Kind::Loss, None) => self.packets(Trouble::Loses(LOST), fault.lasts_ms),
            (_, None) => {
                let full = self.disk.as_ref().is_some_and(Disk::fill);
                self.last(fault.lasts_ms);
                self.disk.as_ref().is_some_and(Disk::free) && full
            }
        };
        Struck { fault, at, over: Instant::now(), fired }
    }
}
