//! The runs of the matrix.

use socrates_offline::Card;

use super::Place;
use super::outcome::{self, Outcome};
use crate::cards::request;
use crate::cores;
use crate::exit::{Code, Diagnostic};

/// A run: the card and the place by their numbers in the lists, and the seed of author and run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Item {
    pub(crate) card: usize,
    pub(crate) place: usize,
    pub(crate) seed: u64,
}

/// Plays every item and hands back what it became, in the order of the items. `at` is told how many of how many are done, and
/// which card was the last.
pub(super) fn all(
    cards: &[&'static Card],
    places: &[Place],
    items: &[Item],
    at: &mut dyn FnMut(usize, usize, &str),
) -> Result<Vec<Outcome>, Diagnostic> {
    // Place by place, so that what is computed of a map once serves all its runs.
    let mut order: Vec<(usize, Item)> = items.iter().copied().enumerate().collect();
    order.sort_by_key(|(_, item)| (item.place, item.card, item.seed));
    let mut done = 0;
    let mut told = |number: usize| {
        done += 1;
        let card = order.get(number).and_then(|(_, item)| cards.get(item.card));
        at(done, items.len(), card.map_or("", |card| card.id.as_str()));
    };
    let one = |number: usize| order.get(number).map(|(_, item)| one(cards, places, *item));
    let played: Vec<_> = cores::each(order.len(), one, &mut told).into_iter().flatten().collect();
    let mut outcomes: Vec<(usize, Outcome)> = Vec::with_capacity(items.len());
    for ((number, _), outcome) in order.iter().zip(played) {
        outcomes.push((*number, outcome?));
    }
    outcomes.sort_by_key(|(number, _)| *number);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// One run.
fn one(cards: &[&'static Card], places: &[Place], item: Item) -> Result<Outcome, Diagnostic> {
    let ours = |why: String| Diagnostic::input(why, "").with_code(Code::Ours);
    let (Some(card), Some(Place { location, .. })) = (cards.get(item.card), places.get(item.place)) else {
        return Err(ours("a run of a card or place that is not there".to_owned()));
    };
    let asked = request(card, &location.name)?;
    let runtime = tokio::runtime::Builder::new_current_thread().build().map_err(|why| ours(why.to_string()))?;
    let played = runtime.block_on(crate::in_process::play(&asked, location, item.seed));
    Ok(outcome::of(card, location, &played))
}
