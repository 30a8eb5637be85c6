//! What is asked of an orchestrator over the bus: to take scenarios, and how they stand.

use std::time::Duration;

use socrates_link::{Bus, LinkError, call, keys};
use socrates_model::wire::{ScenarioSpec, StatusAsk, StatusReply, Submit, Submitted};
use tokio::time::Instant;

use crate::exit::Complaint;

/// Limit of one call.
const CALL: Duration = Duration::from_secs(2);
/// How long the orchestrator may be away before the run is given up.
pub(crate) const AWAY: Duration = Duration::from_secs(60);
/// Scenarios in one submit message; keeps it under 64 KiB.
const SUBMIT_AT_ONCE: usize = 40;

/// Submits scenarios, in several messages if need be.
pub(crate) async fn submit(bus: &dyn Bus, batch: &str, specs: Vec<ScenarioSpec>) -> Result<(), Complaint> {
    let mut specs = specs.into_iter().peekable();
    while specs.peek().is_some() {
        let scenarios: Vec<ScenarioSpec> = specs.by_ref().take(SUBMIT_AT_ONCE).collect();
        let wish = Submit { batch: batch.to_owned(), scenarios };
        let started = Instant::now();
        loop {
            match call::<Submit, Submitted>(bus, keys::SUBMIT, "submit", &wish, CALL).await {
                Ok(Submitted::Accepted { .. }) => break,
                Ok(Submitted::Refused { why }) => {
                    return Err(Complaint::input(format!("the orchestrator refuses: {why}"), ""));
                }
                Ok(Submitted::Busy { retry_after_ms }) => {
                    tokio::time::sleep(Duration::from_millis(retry_after_ms.clamp(50, 5_000))).await
                }
                Err(LinkError::NoReply { .. } | LinkError::Timeout { .. }) if started.elapsed() < AWAY => {
                    tokio::time::sleep(Duration::from_millis(50)).await;
                }
                Err(why) => return Err(Complaint::resumes(why.to_string())),
            }
        }
    }
    Ok(())
}

/// One page of statuses.
pub(crate) async fn status(bus: &dyn Bus, from: u32) -> Result<StatusReply, LinkError> {
    call(bus, keys::STATUS, "status", &StatusAsk { batch: String::new(), from }, CALL).await
}
