//! Places and ways on the floor: doors first, then rooms, then the network of everything else.

use std::collections::{BTreeMap, BTreeSet};

use socrates_maps::Layer;
use socrates_model::Vector;

use crate::attach::{attach, open_floor};
use crate::floor::{Floor, Spot};
use crate::kind::{RegionKind, sides_m};
use crate::middle::middle;
use crate::network::{Branch, Held, Network, length_m};
use crate::open::{CORE_M, Open, free_near};
use crate::region::Regions;
use crate::throat::Opening;
use crate::way::{KEPT_M, LEAST_M, approach, is_straight, least_m, simplified, way};

/// Longest edge before it is parted, m: somebody who stands at a node then is near to somebody who passes.
const EDGE_MOST_M: f64 = 4.6;
/// The same on open floor, m: there everybody sees everybody.
const OPEN_EDGE_MOST_M: f64 = 7.5;
/// A narrow way this long has a node of its own, m.
const NARROW_LEAST_M: f64 = 2.4;
/// A way with less clean clearance than this on both sides is narrow, m: two people of 0.6 m do not pass with ease.
pub(crate) const NARROW_M: f64 = 0.8;
/// Places in a long room are at least so far apart, m.
const ROOM_STEP_M: f64 = 2.4;
/// A place that is not seen from a door counts as so much farther away, m.
const UNSEEN_M: f64 = 4.0;
/// A door leads straight to a place in its room where the way over others is so many times as long.
const ROUND: f64 = 1.15;
/// A door is approached from so far before its wall, m.
const BEFORE_M: f64 = 0.35;
/// Interior corners nearer to each other than this are one, m.
const ONE_CORNER_M: f64 = 1.3;

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
    /// Where ways lead from each place.
    beside: Vec<Vec<usize>>,
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
    /// Open floor among them.
    pub(crate) open: &'a Open,
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
                    Opening::Wide | Opening::Mouth(_) => What::Mouth,
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
        made.shortcuts(ground);
        made.drop_blocked(ground.floor);
        made.repair(ground.floor);
        made
    }

    fn add(&mut self, at: Spot, what: What) -> usize {
        self.places.push(Place { at, what });
        self.beside.push(Vec::new());
        self.places.len() - 1
    }

    /// Joins two places, once.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        if a == b || self.beside(a).contains(&b) {
            return;
        }
        self.ways.push([a.min(b), a.max(b)]);
        for (one, other) in [(a, b), (b, a)] {
            if let Some(list) = self.beside.get_mut(one) {
                list.push(other);
            }
        }
    }

    /// The places to which ways lead from a place.
    pub(crate) fn beside(&self, place: usize) -> &[usize] {
        self.beside.get(place).map_or(&[], Vec::as_slice)
    }

    /// Takes away all ways.
    pub(crate) fn forget_ways(&mut self) {
        self.ways.clear();
        self.beside = vec![Vec::new(); self.places.len()];
    }

    pub(crate) fn at(&self, place: usize) -> Spot {
        self.places.get(place).map_or_else(Spot::origin, |place| place.at)
    }

    /// A place in the middle of a room and ways from it to its doors.
    fn room(&mut self, ground: &Ground<'_>, region: usize, doors: &BTreeMap<usize, usize>) {
        let own: Vec<(usize, usize)> =
            ground.regions.passages_of(region).filter_map(|(number, _)| Some((number, *doors.get(&number)?))).collect();
        let is_car = ground.cars.contains(&region);
        let what = match ground.kinds.get(&region) {
            _ if is_car => What::Car(region),
            Some(RegionKind::Bay) => What::Bay(region),
            Some(RegionKind::Room | RegionKind::Ways) | None => What::Room(region),
        };
        let seen: Vec<Spot> = own.iter().map(|(_, place)| self.at(*place)).collect();
        let center = self.add(middle(ground.floor, ground.regions, region, &seen), what);
        let mut inside = vec![center];
        if !is_car {
            for spot in beside_middle(ground, region, &self.at(center)) {
                let place = self.add(spot, what);
                self.join(center, place);
                inside.push(place);
            }
        }
        for (number, door) in &own {
            let Some(passage) = ground.regions.passages.get(*number) else { continue };
            let at = self.at(*door);
            let far = |place: &usize| {
                let seen = is_straight(ground.floor, &at, &self.at(*place), LEAST_M);
                (self.at(*place) - at).norm() + if seen { 0.0 } else { UNSEEN_M }
            };
            let mut near = inside.clone();
            near.sort_by(|a, b| far(a).total_cmp(&far(b)).then(a.cmp(b)));
            for (rank, place) in near.into_iter().enumerate() {
                let (to, direct) = (self.at(place), (self.at(place) - at).norm());
                let behind = (to - passage.throat.middle()).dot(&passage.throat.ahead) < 0.0;
                let before = passage.throat.beyond(behind, BEFORE_M);
                if rank == 0 {
                    self.lead(ground.floor, *door, place, &before);
                } else if is_straight(ground.floor, &at, &to, KEPT_M)
                    && self.length_m(*door, place, ROUND * direct) > ROUND * direct
                {
                    self.join(*door, place);
                }
            }
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

    /// Leads a door to a place past a spot right before it, with more places where the way is not straight.
    fn lead(&mut self, floor: &Floor, from: usize, to: usize, before: &Spot) {
        let Some(path) = approach(floor, &self.at(from), before, &self.at(to)) else { return };
        let corners = spread(floor, &simplified(floor, &path));
        let what = self.places.get(to).map_or(What::Corner, |place| place.what);
        self.chain(from, to, &corners, what);
    }

    /// Places along corners, the first and last of which are there.
    pub(crate) fn chain(&mut self, from: usize, to: usize, corners: &[Spot], what: What) {
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
        for (slot, open) in on.values.iter_mut().zip(&ground.open.on.values) {
            *slot = *slot && !open;
        }
        let mut network = Network::traced(ground.floor, &on);
        for knot in &mut network.knots {
            if ground.open.is_near(ground.floor, &knot.at) {
                knot.held = Some(Held::Rim);
            }
        }
        network.trim(ground.floor);
        network.clear(ground.floor);
        network.drop_behind_furniture(ground.floor);
        network.clear(ground.floor);
        open_floor(ground, &mut network);
        for number in doors.keys() {
            let Some(passage) = ground.regions.passages.get(*number) else { continue };
            let mut knot = None;
            for (behind, region) in [(false, passage.sides[0]), (true, passage.sides[1])] {
                if ground.kinds.get(&region) == Some(&RegionKind::Ways) {
                    let knot = *knot.get_or_insert_with(|| {
                        network.add(free_middle(ground.floor, &passage.throat), Some(Held::Door(*number)))
                    });
                    attach(ground, &mut network, knot, (region, passage.throat.beyond(behind, BEFORE_M)));
                }
            }
        }
        // A tip beside a door says nothing that the door does not.
        network.clear(ground.floor);
        let mut placed: BTreeMap<usize, usize> = BTreeMap::new();
        for (number, knot) in network.knots.iter().enumerate() {
            let at_door = if let Some(Held::Door(passage)) = knot.held { doors.get(&passage).copied() } else { None };
            let place = match at_door {
                Some(door) => door,
                None => self.add(free_near(ground.floor, &knot.at, LEAST_M, &|_| true).unwrap_or(knot.at), What::Way),
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
        let most_m = if floor.clean_m(&middle) > CORE_M { OPEN_EDGE_MOST_M } else { EDGE_MOST_M };
        let pieces = ((length / most_m).ceil() as u32).max(least);
        let mut last = from;
        for piece in 1..pieces {
            let at = a + (b - a) * (f64::from(piece) / f64::from(pieces));
            let next = self.add(at, What::Way);
            self.join(last, next);
            last = next;
        }
        last
    }
}

/// One more place on each side of the middle of a long room.
fn beside_middle(ground: &Ground<'_>, region: usize, middle: &Spot) -> Vec<Spot> {
    let Some(known) = ground.regions.all.get(region) else { return Vec::new() };
    let [wide, tall] = sides_m(ground.floor, known);
    let along = if wide >= tall { Vector::x() } else { Vector::y() };
    let corner = |cell: (usize, usize)| ground.floor.spot(cell).coords.dot(&along);
    let (low, high) =
        (corner((known.extent.columns.0, known.extent.rows.0)), corner((known.extent.columns.1, known.extent.rows.1)));
    let own = |spot: &Spot| ground.regions.of(ground.floor.cell(spot)) == Some(region);
    let place = |end: f64| {
        // Halfway between the middle and the end of the room, on its longer axis.
        let off = (end - middle.coords.dot(&along)) * 0.6;
        let spot = free_near(ground.floor, &(middle + along * off), KEPT_M, &own)?;
        let apart = (spot - middle).norm() >= ROOM_STEP_M && is_straight(ground.floor, middle, &spot, LEAST_M);
        apart.then_some(spot)
    };
    [low, high].into_iter().filter_map(place).collect()
}

/// Corners without those that are one with another; the first and the last stay.
pub(crate) fn spread(floor: &Floor, corners: &[Spot]) -> Vec<Spot> {
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
pub(crate) fn free_middle(floor: &Floor, throat: &crate::throat::Throat) -> Spot {
    let middle = throat.middle();
    if floor.raw_m(&middle) >= LEAST_M {
        return middle;
    }
    let spots = (1..20_u32).map(|part| throat.from + (throat.to - throat.from) * (f64::from(part) / 20.0));
    spots.max_by(|a, b| floor.raw_m(a).total_cmp(&floor.raw_m(b))).unwrap_or(middle)
}
