//! Settings of one worker. The command line reads them from file and environment; nobody here does.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::Bus;

use crate::blobs::Blobs;
use crate::error::KitError;

/// How a worker is asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stop {
    /// It is not.
    #[default]
    Run,
    /// Takes no more work, finishes what it holds within its drain time, hands back the rest.
    Drain,
    /// Hands everything back at once.
    Now,
}

/// Settings of one call of [`crate::serve`].
#[derive(Clone)]
pub struct WorkerConfig {
    /// Fresh for every call of `serve`: never a host or pod name, which a restarted process would share.
    pub instance: String,
    /// Jobs at a time. Default 1.
    pub slots: u32,
    /// Longest pause between two asks for work. Default 500 ms; hints shorten it.
    pub poll: Duration,
    /// Where artifacts are.
    pub blobs: Blobs,
    /// Folder of unrecorded reports; one per worker, kept over restarts.
    pub spool_dir: PathBuf,
    /// Forces reports to disk before they are sent. Default true; off, a power cut may lose a report (a crash may not).
    pub durable: bool,
    /// Whether a full disk or a vanished folder is waited out. Default true: a worker of a cluster keeps what it has made
    /// until there is room. Off, [`crate::serve`] ends with the reason, for whoever supervises it.
    pub waits_for_disk: bool,
    /// Version of the stage's code; part of the idempotency key.
    pub code_version: String,
    /// Host name, for people.
    pub host: String,
    /// Limit of one message and its answer. Default 2 s.
    pub timeout: Duration,
    /// Longest time for finishing held jobs after [`Stop::Drain`]. Default 20 s.
    pub drain: Duration,
    /// The bus for live streams; `None` takes the one for jobs.
    pub live: Option<Arc<dyn Bus>>,
    /// What goes wrong on purpose. Default nothing.
    pub faults: FaultPlan,
}

impl WorkerConfig {
    /// Default settings with a fresh instance.
    #[must_use]
    pub fn new(blobs: Blobs, spool_dir: impl Into<PathBuf>, code_version: &str) -> Self {
        Self {
            instance: uuid::Uuid::new_v4().to_string(),
            slots: 1,
            poll: Duration::from_millis(500),
            blobs,
            spool_dir: spool_dir.into(),
            durable: true,
            waits_for_disk: true,
            code_version: code_version.to_owned(),
            host: String::new(),
            timeout: Duration::from_secs(2),
            drain: Duration::from_secs(20),
            live: None,
            faults: FaultPlan::default(),
        }
    }
}

/// Faults on purpose, for experiments and chaos tests. Reports are counted from 1 per call of `serve`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaultPlan {
    /// Dies when so many reports are ready, before the last is spooled or sent.
    pub die_before_report: Option<u32>,
    /// Dies when so many reports were sent, before the answer to the last is seen.
    pub die_after_report: Option<u32>,
    /// Loses the first sending of this report.
    pub drop_report: Option<u32>,
    /// Waits so long before every report.
    pub delay: Option<Duration>,
}

impl FaultPlan {
    /// Reads `die_before_report=2,delay_ms=50`; empty text is no fault.
    ///
    /// # Errors
    /// [`KitError::FaultPlan`] for an unknown name or a value that is no whole number.
    pub fn parse(text: &str) -> Result<Self, KitError> {
        let mut plan = Self::default();
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let bad = || KitError::FaultPlan { found: part.to_owned() };
            let (name, value) = part.split_once('=').ok_or_else(bad)?;
            let number: u32 = value.trim().parse().map_err(|_digits| bad())?;
            match name.trim() {
                "die_before_report" => plan.die_before_report = Some(number),
                "die_after_report" => plan.die_after_report = Some(number),
                "drop_report" => plan.drop_report = Some(number),
                "delay_ms" => plan.delay = Some(Duration::from_millis(u64::from(number))),
                _ => return Err(bad()),
            }
        }
        Ok(plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_plan_is_read_and_a_wrong_one_is_named() {
        let plan = FaultPlan::parse("die_before_report=2, delay_ms=50").unwrap();
        assert_eq!(plan.die_before_report, Some(2));
        assert_eq!(plan.delay, Some(Duration::from_millis(50)));
        assert_eq!(FaultPlan::parse("").unwrap(), FaultPlan::default());
        assert!(FaultPlan::parse("die=1").unwrap_err().to_string().contains("`die=1`"));
        assert!(FaultPlan::parse("delay_ms=soon").is_err());
    }
}
