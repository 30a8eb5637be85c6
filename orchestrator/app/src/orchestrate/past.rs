//! What became of scenarios, for whoever writes their bundles elsewhere: read beside the state machine, from the store itself.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use socrates_link::{Ask, Bus, Serving, keys};
use socrates_model::wire::{PastAsk, PastEnd, PastPart};
use socrates_model::{Digest, ScenarioId};
use socrates_store::Reader;

use super::counts::{Counts, Refusal};
use super::reader::{kind, told};

/// Scenarios in one answer, at most: keeps it under 64 KiB with names of the longest kind.
const ENDS: u64 = 400;
/// Bytes of rows in one answer, at most.
const PART_BYTES: usize = 48 * 1024;

/// Answers until the bus closes.
pub(super) async fn serve(bus: Arc<dyn Bus>, mut serving: Serving, store: PathBuf, counts: Counts) {
    // The rows that were asked for last: their parts are asked for one after the other.
    let mut last = None;
    while let Some(ask) = serving.next().await {
        let came = Instant::now();
        let wish = match ask.read::<PastAsk>(kind(keys::PAST)) {
            Ok(envelope) => envelope.body,
            Err(why) => {
                counts.refused(keys::PAST, Refusal::Unreadable);
                told(ask.refuse(bus.name(), 0, &why.to_string()).await);
                continue;
            }
        };
        let (store, held) = (store.clone(), last.take());
        let looked = tokio::task::spawn_blocking(move || look(&store, wish, held)).await;
        let part = match looked {
            Ok((part, held)) => {
                last = held;
                part
            }
            Err(broke) => PastPart::Unknown { why: format!("the answer could not be put together: {broke}") },
        };
        answer(bus.as_ref(), ask, &part).await;
        counts.answered(keys::PAST, came.elapsed());
    }
}

async fn answer(bus: &dyn Bus, ask: Ask, part: &PastPart) {
    told(ask.answer(kind(keys::PAST), bus.name(), 0, part).await);
}

/// The rows of a scenario as they are told.
#[derive(Debug)]
struct Rows {
    scenario: ScenarioId,
    digest: Digest,
    text: Vec<u8>,
}

/// The answer, and the rows that it is a part of.
fn look(store: &Path, wish: PastAsk, held: Option<Rows>) -> (PastPart, Option<Rows>) {
    let unknown = |why: String| PastPart::Unknown { why };
    match wish {
        PastAsk::Ends { from } => match ends(store, from) {
            Ok(ends) => (PastPart::Ends(ends), held),
            Err(why) => (unknown(why), held),
        },
        PastAsk::Rows { scenario, offset } => {
            // From its beginning it is read anew: more may have been tried since.
            let known = held.filter(|held| held.scenario == scenario && offset > 0);
            let read = known.map_or_else(|| rows(store, scenario), Ok);
            match read {
                Ok(rows) => (rows.part(offset), Some(rows)),
                Err(why) => (unknown(why), None),
            }
        }
    }
}

fn ends(store: &Path, from: u64) -> Result<Vec<PastEnd>, String> {
    let standings =
        Reader::open(store).and_then(|reader| reader.standings(from, ENDS)).map_err(|why| why.to_string())?;
    let end = |one: socrates_store::Standing| PastEnd {
        place: one.place,
        scenario: one.scenario,
        batch: one.batch,
        end: one.result,
    };
    Ok(standings.into_iter().map(end).collect())
}

fn rows(store: &Path, scenario: ScenarioId) -> Result<Rows, String> {
    let snapshot = Reader::open(store).and_then(|reader| reader.scenario(&scenario)).map_err(|why| why.to_string())?;
    if snapshot.scenarios.is_empty() {
        return Err(format!("scenario `{scenario}` is not known here"));
    }
    let text = serde_json::to_vec(&snapshot).map_err(|why| why.to_string())?;
    Ok(Rows { scenario, digest: Digest::of(&text), text })
}

impl Rows {
    fn part(&self, offset: u64) -> PastPart {
        let from = usize::try_from(offset).unwrap_or(usize::MAX).min(self.text.len());
        let to = from.saturating_add(PART_BYTES).min(self.text.len());
        let bytes = self.text.get(from..to).unwrap_or_default().to_vec();
        PastPart::Rows { digest: self.digest, len: u64::try_from(self.text.len()).unwrap_or(u64::MAX), bytes }
    }
}
