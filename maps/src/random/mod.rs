//! Random worlds: floor plans drawn by a seed, for tests on maps for which nothing was tuned.
//!
//! ```text
//! seed, kind ─► skeleton with widths ─► corridors, stations ─► strips of rooms ─► furniture ─► plan.toml ─generate─► location
//! ```
//!
//! All lengths are whole tenths of a meter, the size of a pixel, so that widths on the map are exactly those that were drawn.
//! The plan is laid out in one orientation and written in one of eight. Widths follow building rules: doorways 1.0 to 1.4 m
//! (a robot of 0.3 m radius passes; ADA standards of 2010, 404.2.3, ask for 0.82 m), corridors 1.2 to 3.0 m (403.5 asks for 0.92 m),
//! in hospitals at least 2.5 m (NFPA 101 asks for 2.44 m), aisles 1.0 to 3.7 m (picking by hand to forklifts), elevator cars
//! at least 2.1 m deep behind a lobby of one and a half times their depth.

mod brief;
mod chance;
mod corridors;
mod draft;
mod floors;
mod furnish;
mod hall;
mod rooms;
mod shape;
mod skeleton;
mod strip;
mod warehouse;
mod widths;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use socrates_model::{Fault, FaultCode, Location, Where};

use crate::generate::made;
pub use brief::{Built, NotBuilt, build};
use chance::Chance;
use draft::Draft;
pub use widths::Remark;

/// How often a building without a room that every one of its kind has is drawn anew.
const DRAWN_ANEW: usize = 30;

/// Kinds of random worlds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Offices, meeting rooms and open-plan areas along corridors.
    Office,
    /// Wards and treatment rooms along wide corridors, with elevators.
    Hospital,
    /// Racks with aisles, a packing area, docks.
    Warehouse,
    /// One large floor with stands or pillars.
    Hall,
    /// Rooms along a short passage.
    Home,
}

impl Kind {
    /// Every kind in order.
    pub const ALL: [Self; 5] = [Self::Office, Self::Hospital, Self::Warehouse, Self::Hall, Self::Home];

    /// Name as written in arguments and folders.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::Hospital => "hospital",
            Self::Warehouse => "warehouse",
            Self::Hall => "hall",
            Self::Home => "home",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kind {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| {
            let shown: String = text.chars().take(40).collect();
            let names = Self::ALL.map(Self::name).join(", ");
            Fault::new(
                FaultCode::MValue,
                Where::key("kind"),
                format!("`{shown}` is no kind of random world; allowed: {names}"),
            )
        })
    }
}

/// The floor plan of a random world, as the text of its `plan.toml`; the same seed and kind give the same text.
#[must_use]
pub fn plan(seed: u64, kind: Kind) -> String {
    let mut chance = Chance::new(seed, kind.name());
    let mut draft = drawn(kind, &mut chance);
    for _ in 1..DRAWN_ANEW {
        if !draft.lacks {
            break;
        }
        draft = drawn(kind, &mut chance);
    }
    draft.text(seed, kind.name(), &mut chance)
}

fn drawn(kind: Kind, chance: &mut Chance) -> Draft {
    match kind {
        Kind::Office => floors::draw(&floors::OFFICES, chance),
        Kind::Hospital => floors::draw(&floors::HOSPITALS, chance),
        Kind::Home => floors::draw(&floors::HOMES, chance),
        Kind::Warehouse => warehouse::draw(chance),
        Kind::Hall => hall::draw(chance),
    }
}

/// Name of a random world: its kind and its seed.
#[must_use]
pub fn name(seed: u64, kind: Kind) -> String {
    format!("{kind}-{seed}")
}

/// A random world as a location in memory, called by its [`name`]; no file is written or read.
///
/// # Errors
/// None that is known: every plan that was drawn passes [`crate::check`]. A flaw of a drawn plan would be named as one of
/// [`crate::generate`].
pub fn location(seed: u64, kind: Kind) -> Result<Location, Vec<Fault>> {
    let (_, location) = made(&plan(seed, kind))?;
    Ok(Location { name: name(seed, kind), ..location })
}

/// The files of a random world's folder, by name, its `plan.toml` included.
///
/// # Errors
/// As for [`location`].
pub fn files(seed: u64, kind: Kind) -> Result<BTreeMap<String, Vec<u8>>, Vec<Fault>> {
    let text = plan(seed, kind);
    let (mut files, _) = made(&text)?;
    files.insert(crate::plan::PLAN.to_owned(), text.into_bytes());
    Ok(files)
}
