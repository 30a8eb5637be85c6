//! What a region is: a room, or floor along which ways lead.

use crate::floor::{BODY_M, Floor, Spot};
use crate::middle::middle;
use crate::region::{Passage, Region, Regions};
use crate::throat::Opening;
use crate::way::{LEAST_M, is_straight};

/// Largest floor of a room, m²; what is larger has ways of its own.
const ROOM_MOST_M2: f64 = 130.0;
/// How many times as long as wide a room is at most.
const ROOM_ASPECT: f64 = 3.6;
/// How many times as long as wide a bay is at most.
const BAY_ASPECT: f64 = 2.2;
/// Least floor of a bay, m².
const BAY_LEAST_M2: f64 = 6.0;
/// Doors from which on a slim region is a corridor.
const CORRIDOR_DOORS: usize = 3;
/// Sides of an elevator car, m: ADA standards of 2010, 407.4, ask for 1.7 by 1.3 m; cars for beds have 1.8 by 2.7 m.
const CAR_M: (f64, f64) = (1.05, 3.0);
/// Widest door of an elevator, m.
const CAR_DOOR_M: f64 = 1.85;

/// Kinds of regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RegionKind {
    /// One place with doors.
    Room,
    /// One place that is open to another one.
    Bay,
    /// Corridors, halls, aisles: a network.
    Ways,
}

/// Length over width of a rectangle with the region's area and width.
pub(crate) fn aspect(region: &Region) -> f64 {
    let wide = (2.0 * region.bare_m).max(0.1);
    region.area_m2 / (wide * wide)
}

/// The kind of a region.
pub(crate) fn kind(floor: &Floor, regions: &Regions, at: usize) -> RegionKind {
    let Some(region) = regions.all.get(at) else { return RegionKind::Ways };
    let doors = regions.passages_of(at).count();
    // An angled floor has a small area for its length.
    let slim = aspect(region).max(length_m(floor, region) / (2.0 * region.bare_m).max(0.1));
    let room = doors > 0
        && region.area_m2 <= ROOM_MOST_M2
        && if doors >= CORRIDOR_DOORS { slim < 0.5 * ROOM_ASPECT } else { slim < ROOM_ASPECT }
        && (doors < CORRIDOR_DOORS || is_overlooked(floor, regions, at));
    let open = regions.passages_of(at).any(|(_, passage)| passage.throat.opening != Opening::Door);
    match (room, open) {
        (true, false) => RegionKind::Room,
        (true, true) => RegionKind::Bay,
        (false, _) => RegionKind::Ways,
    }
}

/// The longer side of the box round a region, m.
pub(crate) fn length_m(floor: &Floor, region: &Region) -> f64 {
    sides_m(floor, region).into_iter().fold(0.0, f64::max)
}

/// Both sides of the box round a region, m: the robot's middle keeps its half width from the walls.
pub(crate) fn sides_m(floor: &Floor, region: &Region) -> [f64; 2] {
    [region.extent.columns, region.extent.rows].map(|(first, last)| {
        #[expect(clippy::cast_precision_loss, reason = "cells of a map")]
        let cells = (last + 1).saturating_sub(first) as f64;
        (cells - 1.0) * floor.cell_m + 2.0 * BODY_M
    })
}

/// Whether a mouth leads from a way to a bay, and not to a way that goes on: its region is compact.
pub(crate) fn is_bay(floor: &Floor, regions: &Regions, passage: &Passage) -> bool {
    let Opening::Mouth(behind) = passage.throat.opening else { return true };
    let [before, beyond] = passage.sides;
    let (bay, way) = if behind { (beyond, before) } else { (before, beyond) };
    let region = regions.all.get(bay);
    bay != way
        && region.is_some_and(|region| {
            region.area_m2 <= ROOM_MOST_M2 && aspect(region) <= BAY_ASPECT && region.area_m2 >= BAY_LEAST_M2
        })
        && kind(floor, regions, way) == RegionKind::Ways
}

/// Whether somebody in the middle of a region sees all its doors: what is round a corner is another place.
fn is_overlooked(floor: &Floor, regions: &Regions, at: usize) -> bool {
    let doors: Vec<Spot> = regions.passages_of(at).map(|(_, passage)| passage.throat.middle()).collect();
    let middle = middle(floor, regions, at, &doors);
    doors.iter().all(|door| is_straight(floor, &middle, door, LEAST_M))
}

/// Whether a region may be the car of an elevator: small, about square, one door.
pub(crate) fn may_be_car(floor: &Floor, regions: &Regions, at: usize) -> bool {
    let Some(region) = regions.all.get(at) else { return false };
    let [wide, tall] = sides_m(floor, region);
    let mut doors = regions.passages_of(at);
    let (Some((_, door)), None) = (doors.next(), doors.next()) else { return false };
    let sized = |m: f64| (CAR_M.0..=CAR_M.1).contains(&m);
    sized(wide) && sized(tall) && region.area_m2 >= 0.8 * wide * tall && door.throat.width_m <= CAR_DOOR_M
}
