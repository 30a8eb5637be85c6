//! Places and ways on the floor: doors first, then rooms, then the network of everything else.

use std::collections::{BTreeMap, BTreeSet};

use socrates_maps::Layer;
use socrates_model::Vector;

use crate::cells::{Cell, height};
use crate::floor::{Floor, Spot};
use crate::kind::RegionKind;
use crate::network::{Branch, Network, length_m};
use crate::region::Regions;
use crate::throat::Opening;
use crate::way::{KEPT_M, LEAST_M, is_straight, least_m, simplified, way};

/// Longest edge before it is parted, m: somebody who stands at a node then is near to somebody who passes.
const EDGE_MOST_M: f64 = 4.6;
/// A narrow way this long has a node of its own, m.
const NARROW_LEAST_M: f64 = 2.4;
/// A way with less clean clearance than this on both sides is narrow, m: two people of 0.6 m do not pass with ease.
pub(crate) const NARROW_M: f64 = 0.8;
/// A tip of the network belongs to a door this near to it, m, beyond half its depth.
const ANCHOR_M: f64 = 0.6;
/// Interior corners nearer to each other than this are one, m.
const ONE_CORNER_M: f64 = 1.3;
/// The middle of a room is looked for on a lattice of this step, m.
const LATTICE_M: f64 = 0.25;
/// Clearance at the middle of a room beyond which more is no better, m.
const ROOMY_M: f64 = 1.0;

/// What a place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum What {
    /// In a doorway: the number of its passage.
    Door(usize),
    /// In a wide opening.
    Mouth,
    /// In a room: the number of its region.
    Room(usize),
    /// In a place that is open to another one: the number of its region.
    Bay(usize),
    /// In the car of an elevator.
    Car(usize),
    /// On a way of the network.
    Way,
    /// Where the network's way bends.
    Corner,
}

/// A node to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) at: Spot,
    pub(crate) what: What,
}

/// Places and the ways between them.
#[derive(Debug, Default)]
pub(crate) struct Sketch {
    pub(crate) places: Vec<Place>,
    pub(crate) ways: Vec<[usize; 2]>,
}

/// What a sketch is made from.
pub(crate) struct Ground<'a> {
    pub(crate) floor: &'a Floor,
    pub(crate) regions: &'a Regions,
    /// Kind of each region that is kept.
    pub(crate) kinds: &'a BTreeMap<usize, RegionKind>,
    /// Regions that are cars of elevators.
    pub(crate) cars: &'a BTreeSet<usize>,
    pub(crate) skeleton: &'a Layer<bool>,
}

impl Sketch {
    /// The sketch of a floor.
    pub(crate) fn of(ground: &Ground<'_>) -> Self {
        let mut made = Self::default();
        let mut doors: BTreeMap<usize, usize> = BTreeMap::new();
        for (number, passage) in ground.regions.passages.iter().enumerate() {
            if passage.sides.iter().any(|side| ground.kinds.contains_key(side)) {
                let at = free_middle(ground.floor, &passage.throat);
                let what = match passage.throat.opening {
                    Opening::Door => What::Door(number),
                    Opening::Wide => What::Mouth,
                };
                doors.insert(number, made.add(at, what));
            }
        }
        for (region, kind) in ground.kinds {
            if *kind != RegionKind::Ways {
                made.room(ground, *region, &doors);
            }
        }
        made.network(ground, &doors);
        made
    }

    fn add(&mut self, at: Spot, what: What) -> usize {
        self.places.push(Place { at, what });
        self.places.len() - 1
    }

    fn join(&mut self, a: usize, b: usize) {
        let way = [a.min(b), a.max(b)];
        if a != b && !self.ways.contains(&way) {
            self.ways.push(way);
        }
    }

    pub(crate) fn at(&self, place: usize) -> Spot {
        self.places.get(place).map_or_else(Spot::origin, |place| place.at)
    }

    /// A place in the middle of a room and ways from it to its doors.
    fn room(&mut self, ground: &Ground<'_>, region: usize, doors: &BTreeMap<usize, usize>) {
        let own: Vec<(usize, usize)> = ground
            .regions
            .passages_of(region)
            .filter_map(|(number, _)| Some((number, *doors.get(&number)?)))
            .collect();
        let middle = middle(ground, region, &own.iter().map(|(_, place)| self.at(*place)).collect::<Vec<_>>());
        let is_car = ground.cars.contains(&region);
        let what = match ground.kinds.get(&region) {
            _ if is_car => What::Car(region),
            Some(RegionKind::Bay) => What::Bay(region),
            Some(RegionKind::Room | RegionKind::Ways) | None => What::Room(region),
        };
        let center = self.add(middle, what);
        for (_, door) in &own {
            self.lead(ground.floor, *door, center, what);
        }
        if is_car && let Some((number, _)) = own.first() {
            self.car(ground, region, *number, center);
        }
    }

    /// Two more places at the back of a car, so that several people stand in it.
    fn car(&mut self, ground: &Ground<'_>, region: usize, passage: usize, center: usize) {
        let Some(passage) = ground.regions.passages.get(passage) else { return };
        let middle = self.at(center);
        let inward = (middle - passage.throat.middle()).try_normalize(1e-9).unwrap_or_else(Vector::x);
        let aside = Vector::new(-inward.y, inward.x);
        for side in [-1.0, 1.0] {
            let fits = |step: u32| {
                let off = 0.7 - 0.1 * f64::from(step);
                let at = middle + inward * (0.6 * off) + aside * (side * off);
                (ground.floor.raw_m(&at) >= LEAST_M).then_some(at)
            };
            if let Some(at) = (0..5).find_map(fits) {
                let back = self.add(at, What::Car(region));
                self.join(center, back);
            }
        }
    }

    /// Joins two places, with more places where the straight line is not free.
    fn lead(&mut self, floor: &Floor, from: usize, to: usize, what: What) {
        let (a, b) = (self.at(from), self.at(to));
        if is_straight(floor, &a, &b, LEAST_M) {
            self.join(from, to);
            return;
        }
        let Some(path) = way(floor, &a, &b) else { return };
        let corners = spread(floor, &simplified(floor, &path));
        self.chain(from, to, &corners, what);
    }

    /// Places along corners, the first and last of which are there.
    fn chain(&mut self, from: usize, to: usize, corners: &[Spot], what: What) {
        let mut last = from;
        for corner in corners.get(1..corners.len().saturating_sub(1)).unwrap_or_default() {
            let next = self.add(*corner, what);
            self.join(last, next);
            last = next;
        }
        self.join(last, to);
    }

    /// The network of the regions that are no rooms.
    fn network(&mut self, ground: &Ground<'_>, doors: &BTreeMap<usize, usize>) {
        let mut on = ground.skeleton.clone();
        let is_way = |cell: Cell| {
            let region = ground.regions.of(cell);
            region.is_some_and(|region| ground.kinds.get(&region) == Some(&RegionKind::Ways))
        };
        for row in 0..height(&on) {
            for column in 0..on.width {
                if on.get(column, row) == Some(true) && !is_way((column, row)) {
                    on.set(column, row, false);
                }
            }
        }
        let mut network = Network::traced(ground.floor, &on);
        let anchored = anchor(ground, &mut network);
        network.trim(ground.floor);
        network.clear(ground.floor);
        let mut placed: BTreeMap<usize, usize> = BTreeMap::new();
        for (number, knot) in network.knots.iter().enumerate() {
            let at_door = knot.door.and_then(|passage| doors.get(&passage).copied());
            let place = match at_door {
                Some(door) => door,
                None => self.add(knot.at, What::Way),
            };
            placed.insert(number, place);
        }
        let mut seen: BTreeSet<[usize; 2]> = BTreeSet::new();
        for branch in &network.branches {
            let ends = branch.ends.map(|end| placed.get(&end).copied());
            if let [Some(from), Some(to)] = ends {
                let again = !seen.insert([from.min(to), from.max(to)]);
                self.branch(ground.floor, branch, (from, to), again);
            }
        }
        self.loose_doors(ground, doors, &anchored);
    }

    /// Places along a branch: where it bends, and where it is long or narrow.
    fn branch(&mut self, floor: &Floor, branch: &Branch, (from, to): (usize, usize), again: bool) {
        let mut path = branch.path.clone();
        if let Some(first) = path.first_mut() {
            *first = self.at(from);
        }
        if let Some(last) = path.last_mut() {
            *last = self.at(to);
        }
        if least_m(floor, &path) < LEAST_M {
            // Something small lies on it.
            let (a, b) = (self.at(from), self.at(to));
            match way(floor, &a, &b) {
                Some(round) if length_m(&round) <= 1.5 * branch.length_m() + 2.0 => path = round,
                Some(_) | None => return,
            }
        }
        let loops = from == to;
        let corners = if loops {
            // A ring: from its beginning to its middle and back.
            let half = path.len() / 2;
            let first = simplified(floor, path.get(..=half).unwrap_or_default());
            let second = simplified(floor, path.get(half..).unwrap_or_default());
            first.into_iter().chain(second.into_iter().skip(1)).collect()
        } else {
            spread(floor, &simplified(floor, &path))
        };
        let mut last = from;
        for pair in corners.windows(2) {
            let [a, b] = pair else { continue };
            let ends_here = corners.last() == Some(b);
            let single = corners.len() == 2 && again || loops && corners.len() == 3;
            last = self.straight(floor, (*a, *b), last, single);
            let next = if ends_here { to } else { self.add(*b, What::Corner) };
            self.join(last, next);
            last = next;
        }
    }

    /// Places on a straight piece, evenly; gives the last one.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few pieces of a way")]
    fn straight(&mut self, floor: &Floor, (a, b): (Spot, Spot), from: usize, needed: bool) -> usize {
        let length = (b - a).norm();
        let middle = a + (b - a) * 0.5;
        let narrow = floor.clean_m(&middle) < NARROW_M && length >= NARROW_LEAST_M;
        let least = if narrow || needed { 2 } else { 1 };
        let pieces = ((length / EDGE_MOST_M).ceil() as u32).max(least);
        let mut last = from;
        for piece in 1..pieces {
            let at = a + (b - a) * (f64::from(piece) / f64::from(pieces));
            let next = self.add(at, What::Way);
            self.join(last, next);
            last = next;
        }
        last
    }

    /// Joins doors that no tip of the network came to with the nearest place before them.
    fn loose_doors(
        &mut self,
        ground: &Ground<'_>,
        doors: &BTreeMap<usize, usize>,
        anchored: &BTreeSet<(usize, bool)>,
    ) {
        for (number, door) in doors {
            let Some(passage) = ground.regions.passages.get(*number) else { continue };
            for (behind, region) in [(false, passage.sides[0]), (true, passage.sides[1])] {
                let ways = ground.kinds.get(&region) == Some(&RegionKind::Ways);
                if !ways || anchored.contains(&(*number, behind)) {
                    continue;
                }
                let before = passage.throat.beyond(behind, 0.35);
                let mut near: Vec<(f64, usize)> = self
                    .places
                    .iter()
                    .enumerate()
                    .filter(|(at, place)| {
                        at != door && ground.regions.of(ground.floor.cell(&place.at)) == Some(region)
                    })
                    .map(|(at, place)| ((place.at - before).norm(), at))
                    .collect();
                near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                match near.iter().find(|(_, at)| is_straight(ground.floor, &self.at(*at), &self.at(*door), LEAST_M)) {
                    Some((_, at)) => self.join(*at, *door),
                    None => {
                        if let Some((_, at)) = near.first() {
                            self.lead(ground.floor, *door, *at, What::Way);
                        } else {
                            // A piece of floor without a way of its own.
                            let at = middle(ground, region, &[before]);
                            let place = self.add(at, What::Way);
                            self.lead(ground.floor, *door, place, What::Way);
                        }
                    }
                }
            }
        }
    }
}

/// Corners without those that are one with another; the first and the last stay.
fn spread(floor: &Floor, corners: &[Spot]) -> Vec<Spot> {
    let mut out = corners.to_vec();
    let mut at = 1;
    while at + 2 < out.len() {
        let (Some(before), Some(one), Some(other), Some(after)) =
            (out.get(at - 1), out.get(at), out.get(at + 1), out.get(at + 2))
        else {
            break;
        };
        let middle = one + (other - one) * 0.5;
        let kept = least_m(floor, &[*one, *other]).min(KEPT_M) * 0.9;
        let fits = (other - one).norm() < ONE_CORNER_M
            && is_straight(floor, before, &middle, kept)
            && is_straight(floor, &middle, after, kept);
        if fits {
            out.remove(at + 1);
            if let Some(slot) = out.get_mut(at) {
                *slot = middle;
            }
        } else {
            at += 1;
        }
    }
    out
}

/// The middle of an opening, or the freest place on its line where something lies in it.
fn free_middle(floor: &Floor, throat: &crate::throat::Throat) -> Spot {
    let middle = throat.middle();
    if floor.raw_m(&middle) >= LEAST_M {
        return middle;
    }
    let spots = (1..20_u32).map(|part| throat.from + (throat.to - throat.from) * (f64::from(part) / 20.0));
    spots.max_by(|a, b| floor.raw_m(a).total_cmp(&floor.raw_m(b))).unwrap_or(middle)
}

/// Names the tips of the network that lie at doors; gives the passages with the sides, before or behind, from which they were reached.
fn anchor(ground: &Ground<'_>, network: &mut Network) -> BTreeSet<(usize, bool)> {
    let mut degrees = vec![0_usize; network.knots.len()];
    for end in network.branches.iter().flat_map(|branch| branch.ends) {
        if let Some(degree) = degrees.get_mut(end) {
            *degree += 1;
        }
    }
    let mut near: Vec<(f64, usize, usize, bool)> = Vec::new();
    for (number, knot) in network.knots.iter().enumerate() {
        let Some(region) = ground.regions.of(ground.floor.cell(&knot.at)) else { continue };
        if degrees.get(number) != Some(&1) {
            continue;
        }
        for (passage, known) in ground.regions.passages_of(region) {
            let away = knot.at - known.throat.middle();
            let (off, behind) = (away.norm(), away.dot(&known.throat.ahead) < 0.0);
            if off <= 0.5 * known.throat.depth_m() + ANCHOR_M {
                near.push((off, number, passage, behind));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut anchored = BTreeSet::new();
    for (_, number, passage, behind) in near {
        let Some(knot) = network.knots.get_mut(number).filter(|knot| knot.door.is_none()) else { continue };
        if anchored.insert((passage, behind)) {
            knot.door = Some(passage);
        }
    }
    anchored
}

/// Where somebody stands who is in the middle of a region: roomy, near the middle of its floor, in sight of its doors.
#[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of a map")]
fn middle(ground: &Ground<'_>, region: usize, doors: &[Spot]) -> Spot {
    let Some(known) = ground.regions.all.get(region) else { return Spot::origin() };
    let every = ((LATTICE_M / ground.floor.cell_m) as usize).max(1);
    let cells: Vec<Cell> = (known.extent.rows.0..=known.extent.rows.1)
        .step_by(every)
        .flat_map(|row| (known.extent.columns.0..=known.extent.columns.1).step_by(every).map(move |column| (column, row)))
        .chain([known.roomiest])
        .filter(|cell| ground.regions.of(*cell) == Some(region))
        .collect();
    let count = cells.len().max(1) as f64;
    let sum = cells.iter().map(|cell| ground.floor.spot(*cell).coords).fold(Vector::zeros(), |a, b| a + b);
    let center = Spot::from(sum / count);
    let score = |spot: &Spot| {
        let seen = doors.iter().filter(|door| is_straight(ground.floor, spot, door, LEAST_M)).count();
        let clear_m = ground.floor.raw_m(spot);
        let stands = if clear_m >= LEAST_M { 0.0 } else { -10.0 };
        stands + 2.0 * clear_m.min(ROOMY_M) + 0.8 * seen as f64 - 0.2 * (spot - center).norm()
    };
    let spots = cells.iter().map(|cell| ground.floor.spot(*cell));
    let best = spots.map(|spot| (score(&spot), spot)).reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map_or_else(|| crate::region::roomiest(ground.floor, known), |(_, spot)| spot)
}
