//! The schedule of a chaos run: which faults, at which points of a batch, all drawn from one seed.

use serde_json::{Value, json};
use socrates_model::seeds::derive_seed;

/// Stages that workers serve, by their names.
pub(super) const STAGES: [&str; 5] = ["proposal", "paths", "behaviors", "simulation", "scoring"];

/// What is done to a process, or to what it stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// SIGKILL of a worker.
    KillWorker,
    /// SIGKILL of the parent of one machine's workers, with whom they leave.
    KillCrew,
    /// SIGKILL of the orchestrator.
    KillOrchestrator,
    /// SIGKILL of the process that holds the router: nobody reaches anybody.
    KillRouter,
    /// SIGSTOP of a worker for longer than its lease, then SIGCONT: it goes on with what it lost.
    FreezeWorker,
    /// SIGSTOP of the orchestrator, then SIGCONT: its leases ran out meanwhile.
    FreezeOrchestrator,
    /// No room on the disk of the store and the artifacts, for a while.
    FullDisk,
    /// The clock of the wall jumps.
    ClockJump,
    /// No packet gets from or to one machine for longer than its leases.
    Partition,
    /// Packets from and to one machine are lost, for a while.
    Loss,
}

impl Kind {
    /// Every kind, and its weight among the faults that are drawn.
    pub(super) const ALL: [(Self, u64); 10] = [
        (Self::KillWorker, 40),
        (Self::KillCrew, 6),
        (Self::KillOrchestrator, 14),
        (Self::KillRouter, 6),
        (Self::FreezeWorker, 16),
        (Self::FreezeOrchestrator, 6),
        (Self::FullDisk, 4),
        (Self::ClockJump, 8),
        (Self::Partition, 5),
        (Self::Loss, 5),
    ];

    /// Its name in schedules and tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::KillWorker => "kill worker",
            Self::KillCrew => "kill all workers of a machine",
            Self::KillOrchestrator => "kill orchestrator",
            Self::KillRouter => "kill router",
            Self::FreezeWorker => "freeze worker",
            Self::FreezeOrchestrator => "freeze orchestrator",
            Self::FullDisk => "disk full",
            Self::ClockJump => "clock jump",
            Self::Partition => "cut off a machine",
            Self::Loss => "lose packets of a machine",
        }
    }

    /// How long it lasts, ms: at least and at most; 0 where it is over at once.
    const fn lasts(self) -> (u64, u64) {
        match self {
            Self::KillWorker | Self::KillCrew | Self::KillOrchestrator | Self::KillRouter | Self::ClockJump => (0, 0),
            Self::FreezeWorker => (2_500, 5_000),
            Self::FreezeOrchestrator => (500, 3_500),
            Self::FullDisk => (500, 2_500),
            // The longest outlast also the link's own lease of 10 s.
            Self::Partition => (2_500, 12_000),
            Self::Loss => (2_000, 6_000),
        }
    }
}

/// A fault of the schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fault {
    /// How many attempts have begun when it strikes.
    pub(super) at: u64,
    /// What is done.
    pub(super) kind: Kind,
    /// To the worker of which stage, where it is one of a worker.
    pub(super) stage: &'static str,
    /// On which of the two machines.
    pub(super) crew: usize,
    /// How long it lasts, ms.
    pub(super) lasts_ms: u64,
    /// By how much the clock jumps, s.
    pub(super) jump_s: i64,
}

/// This number of faults over a batch of about this number of attempts: each kind once, then by weight, in an order of their own.
pub(super) fn draw(seed: u64, count: usize, attempts: u64, kinds: &[(Kind, u64)]) -> Vec<Fault> {
    let throw = |what: &str, number: usize, sides: u64| derive_seed(seed, &[what, &number.to_string()]) % sides.max(1);
    let weights: u64 = kinds.iter().map(|(_, weight)| weight).sum();
    let by_weight = |number: usize| {
        let mut left = throw("kind", number, weights);
        let found = kinds.iter().find(|(_, weight)| {
            let is_it = left < *weight;
            left = left.saturating_sub(*weight);
            is_it
        });
        found.map_or(Kind::KillWorker, |(kind, _)| *kind)
    };
    let mut drawn: Vec<Kind> =
        (0..count).map(|number| kinds.get(number).map_or_else(|| by_weight(number), |(kind, _)| *kind)).collect();
    for number in (1..drawn.len()).rev() {
        drawn.swap(number, usize::try_from(throw("order", number, number as u64 + 1)).unwrap_or(0));
    }
    // The last third of the batch is left: a fault that lasts lets it go on meanwhile.
    let step = attempts * 2 / 3 / (count as u64).max(1);
    let fault = |(number, kind): (usize, Kind)| {
        let (least, most) = kind.lasts();
        let jump = i64::try_from(60 + throw("jump", number, 7_200)).unwrap_or(60);
        Fault {
            at: number as u64 * step + throw("at", number, step) + 1,
            kind,
            stage: STAGES[usize::try_from(throw("stage", number, STAGES.len() as u64)).unwrap_or(0)],
            // The second machine has a network of its own.
            crew: usize::from(throw("crew", number, 2) == 1 || matches!(kind, Kind::Partition | Kind::Loss)),
            lasts_ms: least + throw("lasts", number, most - least + 1),
            jump_s: if throw("back", number, 2) == 0 { jump } else { -jump },
        }
    };
    drawn.into_iter().enumerate().map(fault).collect()
}

/// The schedule as an object.
pub(super) fn told(seed: u64, faults: &[Fault]) -> Value {
    let one = |fault: &Fault| {
        json!({ "at_attempt": fault.at, "fault": fault.kind.name(), "stage": fault.stage, "crew": fault.crew,
                "lasts_ms": fault.lasts_ms, "jump_s": fault.jump_s })
    };
    json!({ "seed": seed, "faults": faults.iter().map(one).collect::<Vec<_>>() })
}

#[test]
fn a_seed_is_a_schedule_with_every_kind_in_the_order_of_its_points() {
    let faults = draw(7, 40, 1_000, &Kind::ALL);
    assert_eq!(faults, draw(7, 40, 1_000, &Kind::ALL));
    assert_ne!(faults, draw(8, 40, 1_000, &Kind::ALL));
    assert!(faults.is_sorted_by_key(|fault| fault.at) && faults.iter().all(|fault| (1..=667).contains(&fault.at)));
    for (kind, _) in Kind::ALL {
        assert!(faults.iter().any(|fault| fault.kind == kind), "{kind:?}");
    }
    let of = |kind: Kind| faults.iter().filter(move |fault| fault.kind == kind);
    assert!(of(Kind::FreezeWorker).all(|fault| (2_500..=5_000).contains(&fault.lasts_ms)));
    assert!(of(Kind::KillWorker).all(|fault| fault.lasts_ms == 0));
    assert_eq!(told(7, &faults)["faults"].as_array().unwrap().len(), 40);
}
