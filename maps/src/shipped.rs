//! The locations that come with the program.
//!
//! ```text
//! maps/<name>/plan.toml ──generate──► map.yaml, map.png, scene_graph.json, location.toml
//! maps/<name>/scenarios/*.toml         sample requests
//! ```

use std::collections::BTreeMap;
use std::sync::OnceLock;

use socrates_model::{Fault, FaultCode, Location, Where};

use crate::read::parse;

/// A location compiled into the program.
struct Shipped {
    name: &'static str,
    files: &'static [(&'static str, &'static [u8])],
    requests: &'static [(&'static str, &'static str)],
}

macro_rules! shipped {
    ($($name:literal: $($request:literal)*;)*) => {
        /// Every shipped location. Adding one is a folder and a line here.
        const CATALOG: &[Shipped] = &[$(Shipped {
            name: $name,
            files: &[
                ("map.yaml", include_bytes!(concat!("../", $name, "/map.yaml"))),
                ("map.png", include_bytes!(concat!("../", $name, "/map.png"))),
                ("scene_graph.json", include_bytes!(concat!("../", $name, "/scene_graph.json"))),
                ("location.toml", include_bytes!(concat!("../", $name, "/location.toml"))),
                ("plan.toml", include_bytes!(concat!("../", $name, "/plan.toml"))),
            ],
            requests: &[$(($request, include_str!(concat!("../", $name, "/scenarios/", $request, ".toml"))),)*],
        },)*];
        const NAMES: &[&str] = &[$($name,)*];
    };
}

shipped! {
    "hospital": "elevator" "crossing" "visitor_follows" "frontal";
    "office": "corridor" "intersection" "doorway" "proceed";
    "warehouse": "group" "coffee" "blind_corner" "unguided";
}

/// Names of the shipped locations, in order.
#[must_use]
pub fn names() -> &'static [&'static str] {
    NAMES
}

fn entry(name: &str) -> Option<&'static Shipped> {
    CATALOG.iter().find(|shipped| shipped.name == name)
}

/// The files of a shipped location's folder, by name; `None` where there is no such location.
#[must_use]
pub fn files(name: &str) -> Option<BTreeMap<String, Vec<u8>>> {
    entry(name).map(files_of)
}

fn files_of(shipped: &Shipped) -> BTreeMap<String, Vec<u8>> {
    shipped.files.iter().map(|(file, bytes)| ((*file).to_owned(), bytes.to_vec())).collect()
}

/// A shipped location.
///
/// # Errors
/// A fault that lists the names, where there is no such location.
pub fn load(name: &str) -> Result<Location, Vec<Fault>> {
    let Some((place, shipped)) = CATALOG.iter().enumerate().find(|(_, shipped)| shipped.name == name) else {
        let message =
            format!("there is no shipped location `{name}`; shipped are {}, or name a folder", NAMES.join(", "));
        return Err(vec![Fault::new(FaultCode::MRead, Where::key(name), message)]);
    };
    // Read once: a catalog of scenarios asks for the same three again and again.
    static READ: [OnceLock<Location>; NAMES.len()] = [const { OnceLock::new() }; NAMES.len()];
    let Some(kept) = READ.get(place) else { return parse(&files_of(shipped), name) };
    if let Some(location) = kept.get() {
        return Ok(location.clone());
    }
    let location = parse(&files_of(shipped), name)?;
    Ok(kept.get_or_init(|| location).clone())
}

/// Sample requests of a shipped location: file stem and TOML text; empty where there is no such location.
#[must_use]
pub fn requests(name: &str) -> Vec<(&'static str, &'static str)> {
    entry(name).map(|shipped| shipped.requests.to_vec()).unwrap_or_default()
}

#[cfg(test)]
mod tests;
