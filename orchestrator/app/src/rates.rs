//! `scenarios rate`: how often each card really happens on each of many maps, and how straight the reference robot goes.
//!
//! ```text
//! cards × places ─┬─► unfit ─────────────────────► the reason, with its number
//!                 └─► fits ─► seeds in turn ─► work ─► a thread per core ─► outcomes in order ─► table
//! ```

mod outcome;
mod table;
mod work;

use std::path::{Path, PathBuf};

use socrates_maps::random::{self, Kind};
use socrates_model::{Location, Seeds};
use socrates_offline::{Card, Unfit, catalog};

use crate::cards::{find, fitting};
use crate::exit::Diagnostic;
use crate::output::Printer;
use crate::progress::Progress;
pub(crate) use outcome::Outcome;
pub(crate) use work::Item;

/// A map that cards are played on, and the column of the matrix where its runs are counted.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) location: Location,
    /// What the place is called where one run is told of: no two places have the same.
    pub(crate) name: String,
    /// Name of the column: the location's own, or that of a whole kind of maps.
    pub(crate) column: String,
}

/// What is rated.
#[derive(Debug, Clone, Default)]
pub struct RateOptions {
    /// Ids or letters of cards; all of them where none is named.
    pub ids: Vec<String>,
    /// Seeds 1 to N of each card.
    pub seeds: u64,
    /// Whether a card is played with every seed on each location instead of on the fitting ones in turn.
    pub each: bool,
    /// Shipped names or folders; the shipped locations where none is named and no random world is asked for.
    pub locations: Vec<String>,
    /// Seeds of random worlds that are played on besides.
    pub worlds: Option<Seeds>,
    /// Names of the kinds of random worlds; every kind where none is named.
    pub kinds: Vec<String>,
    /// Markdown file for the tables.
    pub out: Option<PathBuf>,
}

/// What was played.
#[derive(Debug)]
pub(crate) struct Played {
    pub(crate) cards: Vec<&'static Card>,
    pub(crate) places: Vec<Place>,
    /// Why a card does not fit a place, by their numbers in the lists.
    pub(crate) unfit: Vec<(usize, usize, Unfit)>,
    /// Every run, by card, seed and place, with what it became.
    pub(crate) runs: Vec<(Item, Outcome)>,
}

/// The cards of these ids or letters; all of them where none is named.
fn cards(ids: &[String]) -> Result<Vec<&'static Card>, Diagnostic> {
    if ids.is_empty() { Ok(catalog().iter().collect()) } else { ids.iter().map(|id| find(id)).collect() }
}

/// Every place of the options: locations by name and random worlds, the shipped locations where neither is named.
fn all_places(options: &RateOptions) -> Result<Vec<Place>, Diagnostic> {
    let Some(worlds) = &options.worlds else { return places(&options.locations) };
    let mut all = if options.locations.is_empty() { Vec::new() } else { places(&options.locations)? };
    all.extend(drawn(worlds, &options.kinds)?);
    Ok(all)
}

/// The random worlds of these seeds and kinds, with a column for each kind.
pub(crate) fn drawn(seeds: &Seeds, kinds: &[String]) -> Result<Vec<Place>, Diagnostic> {
    let named = kinds.iter().map(|kind| crate::map::kind(kind)).collect::<Result<Vec<Kind>, Diagnostic>>()?;
    let kinds = if named.is_empty() { Kind::ALL.to_vec() } else { named };
    let mut places = Vec::new();
    // Seed by seed, so that few runs of a card already see every kind.
    for (seed, kind) in seeds.list().iter().flat_map(|seed| kinds.iter().map(move |kind| (*seed, *kind))) {
        let location = random::location(seed, kind).map_err(|faults| crate::map::not_usable(seed, kind, &faults))?;
        places.push(Place { name: location.name.clone(), location, column: kind.name().to_owned() });
    }
    Ok(places)
}

/// The locations of these names or folders, the shipped ones where none is named; a name that is there twice gets a number.
pub(crate) fn places(names: &[String]) -> Result<Vec<Place>, Diagnostic> {
    let shipped: Vec<String> = socrates_maps::shipped::names().iter().map(|name| (*name).to_owned()).collect();
    let names = if names.is_empty() { &shipped } else { names };
    let mut places: Vec<Place> = Vec::new();
    for name in names {
        let (location, _) = crate::prepare::load_location(name, Path::new("."))?;
        let same = places.iter().filter(|place| place.location.name == location.name).count();
        let column = if same == 0 { location.name.clone() } else { format!("{}-{}", location.name, same + 1) };
        places.push(Place { location, name: column.clone(), column });
    }
    Ok(places)
}

/// Plays cards on places: each card with seeds 1 to `seeds`, on the places that it fits in turn, or on `each` of them.
pub(crate) fn play(
    cards: &[&'static Card],
    places: Vec<Place>,
    (seeds, each): (u64, bool),
    at: &mut dyn FnMut(usize, usize, &str),
) -> Result<Played, Diagnostic> {
    let (mut unfit, mut items) = (Vec::new(), Vec::new());
    for (number, card) in cards.iter().enumerate() {
        let mut fits = Vec::new();
        for (place, Place { location, .. }) in places.iter().enumerate() {
            match card.fit(location) {
                Ok(()) => fits.push(place),
                Err(why) => unfit.push((number, place, why)),
            }
        }
        for seed in 1..=seeds {
            let turn = usize::try_from(seed).unwrap_or(0) % fits.len().max(1);
            let here: Vec<usize> = if each { fits.clone() } else { fits.get(turn).copied().into_iter().collect() };
            items.extend(here.into_iter().map(|place| Item { card: number, place, seed }));
        }
    }
    let outcomes = work::all(cards, &places, &items, at)?;
    Ok(Played { cards: cards.to_vec(), places, unfit, runs: items.into_iter().zip(outcomes).collect() })
}

/// Plays scenarios with the reference robot and counts how often each is realised.
///
/// # Errors
/// A card or location that is not known, or cards that fit none of the locations.
pub fn rate(talk: &Printer, options: &RateOptions) -> Result<(), Diagnostic> {
    let cards = cards(&options.ids)?;
    let places = all_places(options)?;
    if !cards.iter().any(|card| places.iter().any(|place| card.fit(&place.location).is_ok())) {
        return Err(nothing_fits(&cards, &places));
    }
    let mut progress = None;
    let mut at = |done: usize, total: usize, remark: &str| {
        progress.get_or_insert_with(|| Progress::new(*talk, "playing", total)).at(done, remark);
    };
    let played = play(&cards, places, (options.seeds, options.each), &mut at)?;
    drop(progress);
    table::told(&played).iter().for_each(|line| talk.line(line));
    if let Some(path) = &options.out {
        crate::files::write(path, table::markdown(&played, options).as_bytes())?;
        talk.line(&format!("wrote      {}", path.display()));
    }
    talk.result(&table::object(&played));
    Ok(())
}

/// What is wrong where no card fits any of the places.
fn nothing_fits(cards: &[&'static Card], places: &[Place]) -> Diagnostic {
    let ids: Vec<String> = cards.iter().map(|card| format!("`{}`", card.id)).collect();
    let found = cards.first().map_or_else(Vec::new, |card| fitting(card));
    let hint = format!("{} fits {}", ids.first().map_or("", String::as_str), found.join(", "));
    let mut diagnostic = Diagnostic::input(format!("{} fits no location that was named", ids.join(", ")), hint);
    let reasons = cards.iter().flat_map(|card| {
        places.iter().filter_map(move |place| {
            let why = card.fit(&place.location).err()?;
            Some(format!("{} on {}: {why}", card.id, place.column))
        })
    });
    diagnostic.causes = reasons.collect();
    diagnostic
}

#[cfg(test)]
mod tests;
