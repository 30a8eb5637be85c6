//! Figures of a chaos run: what began when, how long each kind of fault held things up, and the table.

use std::collections::BTreeMap;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::nemesis::Struck;
use super::schedule::Kind;

/// An attempt that a worker began.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Begun {
    pub(super) at: Instant,
    pub(super) crew: usize,
    pub(super) job: String,
    pub(super) attempt: u32,
}

/// What orchestrators and workers tell, read as they write it.
#[derive(Default)]
pub(super) struct Log {
    read: BTreeMap<PathBuf, u64>,
    /// When orchestrators began to serve.
    pub(super) reigns: Vec<Instant>,
    /// What workers began.
    pub(super) begun: Vec<Begun>,
}

/// Job and attempt of a line that says that one begins.
fn begins(line: &str) -> Option<(String, u32)> {
    if !line.contains("begins") {
        return None;
    }
    let value = |name: &str| line.split_whitespace().find_map(|word| word.strip_prefix(name));
    Some((value("job=")?.to_owned(), value("attempt=")?.parse().ok()?))
}

impl Log {
    /// Reads what is new in these files: of a machine's workers, or of orchestrators.
    pub(super) fn look(&mut self, files: Vec<(Option<usize>, PathBuf)>) {
        let at = Instant::now();
        for (crew, file) in files {
            let Ok(mut open) = std::fs::File::open(&file) else { continue };
            let from = self.read.entry(file).or_default();
            let mut text = Vec::new();
            if open.seek(SeekFrom::Start(*from)).is_err() || open.read_to_end(&mut text).is_err() {
                continue;
            }
            // A line that is not whole yet is read the next time.
            let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
            *from += whole as u64;
            let lines = String::from_utf8_lossy(&text[..whole]).into_owned();
            match crew {
                Some(crew) => {
                    let attempts = lines.lines().filter_map(begins);
                    self.begun.extend(attempts.map(|(job, attempt)| Begun { at, crew, job, attempt }));
                }
                None => {
                    self.reigns.extend(lines.lines().filter(|line| line.contains("orchestrator begins")).map(|_| at))
                }
            }
        }
    }
}

/// How long a fault held things up: until the same job began again, where it took one from a worker; else until any attempt began once
/// what was struck worked again. None where nothing was in the hands of what it struck.
fn recovery(struck: &Struck, log: &Log) -> Option<Duration> {
    let (fault, begun) = (struck.fault, &log.begun);
    let stage = format!("/{}/", fault.stage);
    let after = |one: &&Begun| one.at > struck.at;
    match fault.kind {
        Kind::KillWorker | Kind::FreezeWorker | Kind::KillCrew | Kind::Partition => {
            let all = matches!(fault.kind, Kind::KillCrew | Kind::Partition);
            let mut last: BTreeMap<&str, &Begun> = BTreeMap::new();
            for one in begun.iter().filter(|one| one.at <= struck.at && (all || one.job.contains(&stage))) {
                last.insert(&one.job, one);
            }
            let again = |one: &&Begun| {
                let before = last.get(one.job.as_str());
                before.is_some_and(|before| before.crew == fault.crew && before.attempt + 1 == one.attempt)
            };
            begun.iter().filter(after).find(again).map(|one| one.at - struck.at)
        }
        Kind::KillOrchestrator => {
            let serves = log.reigns.iter().find(|at| **at > struck.at)?;
            begun.iter().find(|one| one.at > *serves).map(|one| one.at - struck.at)
        }
        Kind::KillRouter | Kind::FreezeOrchestrator | Kind::FullDisk => {
            begun.iter().find(|one| one.at > struck.over).map(|one| one.at - struck.at)
        }
        Kind::ClockJump | Kind::Loss => None,
    }
}

/// The time that so many of a hundred are not above, ms; they stand in order.
fn quantile(sorted: &[Duration], of_hundred: usize) -> String {
    let index = (sorted.len() * of_hundred).div_ceil(100).max(1) - 1;
    sorted.get(index).map_or_else(|| "–".to_owned(), |one| one.as_millis().to_string())
}

/// The table of faults by kind.
pub(super) fn table(struck: &[Struck], log: &Log) -> Vec<String> {
    let mut lines = vec![
        "| fault | inflicted | seen to strike | measured | p50, ms | p99, ms |".to_owned(),
        "|---|---|---|---|---|---|".to_owned(),
    ];
    for (kind, _) in Kind::ALL {
        let of: Vec<&Struck> = struck.iter().filter(|struck| struck.fault.kind == kind).collect();
        if of.is_empty() {
            continue;
        }
        let mut times: Vec<Duration> = of.iter().filter_map(|struck| recovery(struck, log)).collect();
        times.sort_unstable();
        let fired = of.iter().filter(|struck| struck.fired).count();
        let (p50, p99) = (quantile(&times, 50), quantile(&times, 99));
        lines.push(format!("| {} | {} | {fired} | {} | {p50} | {p99} |", kind.name(), of.len(), times.len()));
    }
    lines
}

#[test]
fn a_recovery_is_the_time_until_the_same_job_begins_again() {
    use super::schedule::Fault;
    let zero = Instant::now();
    let at = |ms: u64| zero + Duration::from_millis(ms);
    let one = |ms, crew, job: &str, attempt| Begun { at: at(ms), crew, job: job.to_owned(), attempt };
    let begun = vec![
        one(0, 0, "a/simulation/reference-1/r0", 1),
        one(5, 1, "b/simulation/reference-1/r0", 1),
        one(50, 1, "c/simulation/reference-1/r0", 1),
        one(90, 1, "b/simulation/reference-1/r0", 2),
        one(120, 1, "a/simulation/reference-1/r0", 2),
    ];
    let log = Log { begun, reigns: vec![at(60)], ..Log::default() };
    let struck = |kind, crew, over| Struck {
        fault: Fault { at: 1, kind, stage: "simulation", crew, lasts_ms: 0, jump_s: 0 },
        at: at(10),
        over: at(over),
        fired: true,
    };
    assert_eq!(recovery(&struck(Kind::KillWorker, 0, 10), &log), Some(Duration::from_millis(110)));
    assert_eq!(recovery(&struck(Kind::KillWorker, 1, 10), &log), Some(Duration::from_millis(80)));
    assert_eq!(recovery(&struck(Kind::KillOrchestrator, 0, 10), &log), Some(Duration::from_millis(80)));
    assert_eq!(recovery(&struck(Kind::KillRouter, 0, 30), &log), Some(Duration::from_millis(40)));
    assert_eq!(recovery(&struck(Kind::ClockJump, 0, 10), &log), None);
    assert_eq!(
        begins("DEBUG socrates_kit::attempt: begins job=a/paths/r0 attempt=2"),
        Some(("a/paths/r0".to_owned(), 2))
    );
    assert_eq!(begins("WARN a child died and is started again"), None);
    let times: Vec<Duration> = (1..=100).map(Duration::from_millis).collect();
    assert_eq!((quantile(&times, 50), quantile(&times, 99), quantile(&[], 50)), ("50".into(), "99".into(), "–".into()));
}
