//! What is asked of an orchestrator over the bus: to take scenarios, and how they stand.

use std::time::Duration;

use socrates_link::{Bus, LinkError, call, keys};
use socrates_model::job::Stage;
use socrates_model::wire::{
    Control, Limits, PastAsk, PastEnd, PastPart, Priority, ScenarioSpec, Series, StatusAsk, StatusReply, Steer,
    Steered, Submit, Submitted,
};
use socrates_model::{Digest, ScenarioId};
use tokio::time::Instant;

use crate::exit::{Code, Diagnostic};

/// Limit of one call.
const CALL: Duration = Duration::from_secs(2);
/// Limit of a call that may move every job of a large batch.
const STEERING: Duration = Duration::from_secs(20);
/// Limit of one part of an artifact.
pub(crate) const PART: Duration = Duration::from_secs(10);
/// How long the orchestrator may be away before the run is given up.
pub(crate) const AWAY: Duration = Duration::from_secs(60);
/// Times that the rows of a scenario may change while they are read.
const MOMENTS: u32 = 20;
/// Rows of one scenario that are taken, bytes, at most.
const ROWS_MOST: u64 = 256 << 20;
/// Scenarios in one submit message; keeps it under 64 KiB.
const SUBMIT_AT_ONCE: usize = 40;

/// Submits scenarios, in several messages if need be; gives how many were not known before.
pub async fn submit(
    bus: &dyn Bus,
    batch: &str,
    priority: Priority,
    specs: Vec<ScenarioSpec>,
) -> Result<u64, Diagnostic> {
    let mut fresh: u64 = 0;
    let mut specs = specs.into_iter().peekable();
    while specs.peek().is_some() {
        let scenarios: Vec<ScenarioSpec> = specs.by_ref().take(SUBMIT_AT_ONCE).collect();
        let (new, _) = hand_in(bus, &Submit::new(batch, priority, scenarios)).await?;
        fresh = fresh.saturating_add(new.into());
    }
    Ok(fresh)
}

/// Submits a series; gives how many of its scenarios were not known before.
pub(crate) async fn submit_series(
    bus: &dyn Bus,
    batch: &str,
    priority: Priority,
    series: Series,
) -> Result<u64, Diagnostic> {
    let count = series.count();
    let wish = Submit { series: vec![series], ..Submit::new(batch, priority, Vec::new()) };
    match hand_in(bus, &wish).await? {
        (new, held) if held == count => Ok(new.into()),
        (_, held) => Err(earlier(&format!("it took {held} of the {count} scenarios of a series"))),
    }
}

/// Says what a batch may take; before its scenarios are submitted.
pub(crate) async fn limit(bus: &dyn Bus, batch: &str, limits: Limits) -> Result<(), Diagnostic> {
    hand_in(bus, &Submit { limits, ..Submit::new(batch, Priority::Normal, Vec::new()) }).await?;
    Ok(())
}

fn earlier(what: &str) -> Diagnostic {
    Diagnostic::input(
        format!("the orchestrator is of an earlier version: {what}"),
        "start `socrates cluster up` of this version, and its workers",
    )
}

/// Puts one submission until it is taken or refused; gives how many scenarios are new, and how many its series have.
async fn hand_in(bus: &dyn Bus, wish: &Submit) -> Result<(u32, u32), Diagnostic> {
    let started = Instant::now();
    loop {
        match call::<Submit, Submitted>(bus, keys::SUBMIT, "submit", wish, CALL).await {
            Ok(Submitted::Accepted { new, held }) => return Ok((new, held)),
            Ok(Submitted::Refused { why }) => {
                return Err(Diagnostic::input(format!("the orchestrator refuses: {why}"), ""));
            }
            Ok(Submitted::Busy { retry_after_ms }) => {
                tokio::time::sleep(Duration::from_millis(retry_after_ms.clamp(50, 5_000))).await;
            }
            Err(LinkError::NoReply { .. } | LinkError::Timeout { .. }) if started.elapsed() < AWAY => {
                tokio::time::sleep(Duration::from_millis(50)).await;
            }
            Err(why) => return Err(Diagnostic::resumes(why.to_string())),
        }
    }
}

/// How things stand.
pub(crate) async fn status(bus: &dyn Bus, ask: &StatusAsk) -> Result<StatusReply, LinkError> {
    call(bus, keys::STATUS, "status", ask, CALL).await
}

/// How many there are of what, in one batch or, where its name is empty, in all: no line of a scenario comes with it.
pub async fn counts(bus: &dyn Bus, batch: &str) -> Result<StatusReply, LinkError> {
    status(bus, &StatusAsk { batch: batch.to_owned(), from: u32::MAX, ..StatusAsk::default() }).await
}

/// Whether so many workers of every stage are there.
pub fn is_staffed(reply: &StatusReply, wanted: impl Fn(Stage) -> u32) -> bool {
    Stage::WORKERS.into_iter().all(|stage| reply.workers.get(stage.name()).is_some_and(|count| *count >= wanted(stage)))
}

/// What is said where the orchestrator does not answer.
pub(crate) fn silent(why: LinkError) -> Diagnostic {
    Diagnostic::input(format!("the orchestrator does not answer: {why}"), "try again in a moment").with_code(Code::Ours)
}

/// Has something done about jobs. It is asked once: without an answer, look how things stand before asking again.
pub(crate) async fn steer(bus: &dyn Bus, steer: Steer) -> Result<Steered, Diagnostic> {
    let wish = Control::Steer(steer);
    let answer = call::<Control, Steered>(bus, keys::CONTROL, "control", &wish, STEERING).await;
    answer.map_err(|why| {
        if let LinkError::Refused { why, .. } = why {
            return Diagnostic::input(
                format!("the orchestrator refuses: {why}"),
                "one of an earlier version does not know this; start `socrates cluster up` of this version",
            );
        }
        silent(why)
    })
}

/// How every scenario stands, in order of submission.
pub(crate) async fn ends(bus: &dyn Bus) -> Result<Vec<PastEnd>, Diagnostic> {
    let mut all: Vec<PastEnd> = Vec::new();
    loop {
        let from = all.last().map_or(0, |end| end.place.saturating_add(1));
        match past(bus, PastAsk::Ends { from }).await? {
            PastPart::Ends(ends) if ends.is_empty() => return Ok(all),
            // One that answers with earlier places would be asked without end.
            PastPart::Ends(ends) if ends.iter().any(|end| end.place < from) => {
                return Err(Diagnostic::resumes(format!(
                    "the orchestrator told places before {from}, which was asked for"
                )));
            }
            PastPart::Ends(ends) => all.extend(ends),
            PastPart::Rows { .. } => return Err(another()),
            PastPart::Unknown { why } => return Err(Diagnostic::resumes(why)),
        }
    }
}

/// Everything that was tried for a scenario, as the JSON text of its rows.
pub(crate) async fn rows(bus: &dyn Bus, scenario: &ScenarioId) -> Result<Vec<u8>, Diagnostic> {
    let mut text: Vec<u8> = Vec::new();
    let mut moment = None;
    let mut moments = 0_u32;
    loop {
        let offset = u64::try_from(text.len()).unwrap_or(u64::MAX);
        match past(bus, PastAsk::Rows { scenario: scenario.clone(), offset }).await? {
            PastPart::Rows { digest, .. } if moment.is_some_and(|moment| moment != digest) => {
                // Of another moment: from the beginning.
                text.clear();
                moment = None;
                moments += 1;
                if moments > MOMENTS {
                    return Err(Diagnostic::resumes(format!(
                        "the rows of `{scenario}` change faster than they can be read"
                    )));
                }
            }
            PastPart::Rows { digest, len, bytes } => {
                if len > ROWS_MOST {
                    let what = format!("the rows of `{scenario}` have {len} bytes, more than {ROWS_MOST}");
                    return Err(Diagnostic::resumes(what));
                }
                moment = Some(digest);
                let ended = bytes.is_empty();
                text.extend(bytes);
                if ended || u64::try_from(text.len()).unwrap_or(u64::MAX) >= len {
                    return if Digest::of(&text) == digest {
                        Ok(text)
                    } else {
                        Err(Diagnostic::resumes(format!("the rows of `{scenario}` came torn")))
                    };
                }
            }
            PastPart::Ends(_) => return Err(another()),
            PastPart::Unknown { why } => return Err(Diagnostic::resumes(why)),
        }
    }
}

/// One question about the past, asked again while the orchestrator is away.
async fn past(bus: &dyn Bus, ask: PastAsk) -> Result<PastPart, Diagnostic> {
    let started = Instant::now();
    loop {
        match call::<PastAsk, PastPart>(bus, keys::PAST, "past", &ask, CALL).await {
            Ok(part) => return Ok(part),
            Err(why) if why.is_transient() && started.elapsed() < AWAY => {
                tokio::time::sleep(Duration::from_millis(100)).await
            }
            Err(why) => return Err(Diagnostic::resumes(format!("the orchestrator cannot be asked: {why}"))),
        }
    }
}

fn another() -> Diagnostic {
    Diagnostic::resumes("the orchestrator answered another question than was asked")
}
