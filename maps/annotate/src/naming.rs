//! Types, names and confidences of the places of a sketch.

use std::collections::BTreeMap;

use crate::floor::{Floor, Spot};
use crate::kind::aspect;
use crate::region::Regions;
use crate::sketch::{NARROW_M, Sketch, What};

/// Floor with more clean clearance than this is an open area, m: wider than any corridor.
const OPEN_M: f64 = 2.2;
/// The end of a way with more clearance than this is a bay, m.
const BAY_M: f64 = 1.7;
/// A doorway narrower than this is narrow, m: ADA standards of 2010, 404.2.3, ask for 0.82 m of free width.
const NARROW_DOOR_M: f64 = 0.9;
/// Least turn of a way that is a corner, rad.
const CORNER_RAD: f64 = 0.87;
/// A corner hides where two people so far before and behind it do not see each other, m.
const HIDES_M: f64 = 2.5;

/// What is known of the places of a sketch.
pub(crate) struct Naming<'a> {
    pub(crate) floor: &'a Floor,
    pub(crate) regions: &'a Regions,
    pub(crate) sketch: &'a Sketch,
    /// Number of the elevator of a region.
    pub(crate) elevators: &'a BTreeMap<usize, usize>,
    neighbors: Vec<Vec<usize>>,
}

impl<'a> Naming<'a> {
    pub(crate) fn new(
        floor: &'a Floor,
        regions: &'a Regions,
        sketch: &'a Sketch,
        elevators: &'a BTreeMap<usize, usize>,
    ) -> Self {
        let mut neighbors = vec![Vec::new(); sketch.places.len()];
        for [a, b] in &sketch.ways {
            for (one, other) in [(a, b), (b, a)] {
                if let Some(list) = neighbors.get_mut(*one) {
                    list.push(*other);
                }
            }
        }
        Self { floor, regions, sketch, elevators, neighbors }
    }

    fn neighbors(&self, place: usize) -> &[usize] {
        self.neighbors.get(place).map_or(&[], Vec::as_slice)
    }

    fn what(&self, place: usize) -> What {
        self.sketch.places.get(place).map_or(What::Way, |place| place.what)
    }

    fn elevator(&self, region: usize) -> String {
        format!("IN ELEVATOR {}", self.elevators.get(&region).copied().unwrap_or(0))
    }

    /// Whether a place is right before the door of an elevator.
    fn is_lobby(&self, place: usize) -> bool {
        self.neighbors(place).iter().any(|next| match self.what(*next) {
            What::Door(passage) => {
                let sides = self.regions.passages.get(passage).map(|passage| passage.sides);
                sides.into_iter().flatten().any(|side| self.elevators.contains_key(&side))
            }
            What::Mouth | What::Room(_) | What::Bay(_) | What::Car(_) | What::Way | What::Corner => false,
        })
    }

    /// Whether the way turns at a place with two neighbors, and whether what comes round it is hidden.
    fn corner(&self, place: usize) -> (bool, bool) {
        let [a, b] = self.neighbors(place) else { return (false, false) };
        let (here, a, b) = (self.sketch.at(place), self.sketch.at(*a), self.sketch.at(*b));
        let (into, out) = (here - a, b - here);
        let turn = into.perp(&out).atan2(into.dot(&out)).abs();
        let off = |to: &Spot| here + (to - here).normalize() * HIDES_M.min((to - here).norm());
        (turn >= CORNER_RAD, turn >= CORNER_RAD && self.floor.line_m(&off(&a), &off(&b)) <= 0.0)
    }

    /// The type of a place, and how sure it is, 0 to 1.
    pub(crate) fn kind(&self, place: usize) -> (String, f64) {
        let degree = self.neighbors(place).len();
        let at = self.sketch.at(place);
        let what = self.what(place);
        // The clean map is closed across openings.
        let clear_m = if what == What::Mouth { self.floor.raw_m(&at) } else { self.floor.clean_m(&at) };
        let sure = |value: f64, limit: f64| 0.6 + 0.4 * ((value / limit).ln().abs() / 0.4).min(1.0);
        let told = |kind: &str, sure: f64| (kind.to_owned(), sure);
        match what {
            What::Door(number) => {
                let Some(passage) = self.regions.passages.get(number) else { return told("DOORWAY", 0.5) };
                let outward =
                    passage.sides.iter().any(|side| self.regions.all.get(*side).is_some_and(|region| region.outside));
                let kind = if outward {
                    "EXIT"
                } else if passage.throat.width_m < NARROW_DOOR_M {
                    "NARROW DOORWAY"
                } else {
                    "DOORWAY"
                };
                told(kind, passage.throat.confidence())
            }
            What::Room(region) => {
                let doors: Vec<f64> =
                    self.regions.passages_of(region).map(|(_, passage)| passage.throat.confidence()).collect();
                let least = doors.into_iter().fold(1.0, f64::min);
                let slim = self.regions.all.get(region).map_or(1.0, aspect);
                told("ROOM", least * (1.2 - 0.1 * slim).clamp(0.6, 1.0))
            }
            What::Bay(_) if self.is_lobby(place) => told("ELEVATOR LOBBY", 1.0),
            What::Bay(_) => told("OPEN AREA", 0.85),
            What::Car(region) => (self.elevator(region), 1.0),
            What::Mouth | What::Way | What::Corner if self.is_lobby(place) => told("ELEVATOR LOBBY", 1.0),
            What::Mouth | What::Way | What::Corner if degree >= 3 => {
                if clear_m > OPEN_M {
                    told("OPEN AREA", sure(clear_m, OPEN_M))
                } else {
                    told("INTERSECTION", 0.9)
                }
            }
            What::Mouth | What::Way | What::Corner if degree <= 1 => {
                if clear_m > BAY_M {
                    told("OPEN AREA", sure(clear_m, BAY_M))
                } else {
                    told("CORRIDOR END", sure(clear_m, BAY_M))
                }
            }
            What::Mouth | What::Way | What::Corner => {
                let (turns, hides) = self.corner(place);
                if hides {
                    told("BLIND CORNER", 0.85)
                } else if turns {
                    told("CORRIDOR", 0.8)
                } else if clear_m > OPEN_M {
                    told("OPEN AREA", sure(clear_m, OPEN_M))
                } else if clear_m < NARROW_M {
                    told("NARROW CORRIDOR", sure(clear_m, NARROW_M))
                } else {
                    told("CORRIDOR", sure(clear_m, NARROW_M).min(sure(clear_m, OPEN_M)))
                }
            }
        }
    }

    /// The type of the way between two places.
    pub(crate) fn way(&self, [a, b]: [usize; 2]) -> String {
        let both = [self.what(a), self.what(b)];
        if both.iter().any(|what| matches!(what, What::Door(_))) {
            return "DOORWAY".to_owned();
        }
        if let [What::Car(region), _] | [_, What::Car(region)] = both {
            return self.elevator(region);
        }
        if both.iter().any(|what| matches!(what, What::Room(_))) {
            return "ROOM".to_owned();
        }
        if both.iter().any(|what| matches!(what, What::Bay(_))) {
            return "OPEN AREA".to_owned();
        }
        let (a, b) = (self.sketch.at(a), self.sketch.at(b));
        let clear_m = self.floor.clean_m(&(a + (b - a) * 0.5));
        let kind = if clear_m < NARROW_M {
            "NARROW CORRIDOR"
        } else if clear_m > OPEN_M {
            "OPEN AREA"
        } else {
            "CORRIDOR"
        };
        kind.to_owned()
    }
}

/// First letter of the names of nodes of a type.
pub(crate) fn letter(kind: &str) -> char {
    match kind {
        "DOORWAY" | "NARROW DOORWAY" => 'd',
        "ROOM" => 'r',
        "INTERSECTION" => 'i',
        "OPEN AREA" => 'o',
        "BLIND CORNER" => 'k',
        "CORRIDOR END" | "EXIT" => 'x',
        "NARROW CORRIDOR" => 'n',
        "ELEVATOR LOBBY" => 'l',
        _ if kind.starts_with("IN ELEVATOR") => 'e',
        _ => 'c',
    }
}
