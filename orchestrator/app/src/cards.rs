//! The cards of the catalog by id and letter, where they fit, and the request that plays one.

use std::path::Path;

use serde_json::json;
use socrates_model::{Location, Request};
use socrates_offline::{Card, catalog};

use crate::exit::Diagnostic;

/// `a`, `+3`, or a dash: the place of a card in the lists.
pub(crate) fn mark(card: &Card) -> String {
    match (card.letter, card.further) {
        (Some(letter), _) => letter.to_string(),
        (None, Some(number)) => format!("+{number}"),
        (None, None) => "–".to_owned(),
    }
}

/// Shipped locations that can hold the card.
pub(crate) fn fitting(card: &Card) -> Vec<&'static str> {
    let fits = |name: &&str| socrates_maps::shipped::load(name).is_ok_and(|location| card.fits(&location));
    socrates_maps::shipped::names().iter().copied().filter(fits).collect()
}

pub(crate) fn find(id: &str) -> Result<&'static Card, Diagnostic> {
    catalog()
        .iter()
        .find(|card| card.id == id || card.letter.is_some_and(|letter| letter.to_string() == id))
        .ok_or_else(|| {
            let known: Vec<&str> = catalog().iter().map(|card| card.id.as_str()).collect();
            let first = id.chars().next().unwrap_or(' ');
            let near: Vec<&str> = known.iter().copied().filter(|other| other.starts_with(first)).collect();
            let hint = if near.is_empty() {
                "`socrates scenarios list` lists them".to_owned()
            } else {
                format!("`socrates scenarios list` lists them; with `{first}` begin: {}", near.join(", "))
            };
            Diagnostic::input(format!("there is no scenario `{id}`"), hint)
        })
}

/// The shipped locations where a card fits.
pub fn places(card: &Card) -> Result<Vec<Location>, Diagnostic> {
    let load = |name: &str| crate::prepare::load_location(name, Path::new(".")).map(|(location, _)| location);
    fitting(card).into_iter().map(load).collect()
}

/// A request for this card, in a place where it fits.
pub fn request(card: &Card, location: &str) -> Result<Request, Diagnostic> {
    serde_json::from_value(json!({
        "location": location, "social_context": "", "task": "Deliver mail", "expect": { "pattern": card.id },
    }))
    .map_err(|why| Diagnostic::input(format!("the card `{}` makes no request: {why}", card.id), ""))
}
