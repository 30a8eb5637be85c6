//! Who is near whom: people sorted into cells, so that nobody looks at everybody.

use nalgebra::{Point2, Vector2};

use crate::fast::cells::{Cells, Extent};
use crate::fast::pairs::Body;

/// People per cell, on average over the rectangle around the crowd.
const PER_CELL: f64 = 2.0;
/// A first look for the nearest few goes so far that about this many times as many are found.
const FIRST_SHARE: f64 = 1.7;
/// Each next look goes farther by this factor.
const GROWTH: f64 = 1.6;
/// Covers the rounding of cells and circles, as shares of a range and of the largest coordinate.
const SLACK: (f64, f64) = (1e-9, 1e-13);

/// Up to so many are sorted by counting who is nearer.
const FEW: usize = 32;

/// Somebody who was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Distance, m.
    pub distance_m: f64,
    /// Place in the list that was taken over.
    pub place: usize,
}

/// People at one moment, sorted into cells.
///
/// Whose position or velocity is not finite is never found. Keeps its memory from moment to moment.
#[derive(Debug, Clone, Default)]
pub struct Near {
    bodies: Vec<Body>,
    cells: Cells,
    /// Place in the list of each person, cell after cell.
    order: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// People per m², over the rectangle around all.
    density: f64,
    /// Rounding of cells, m.
    slack_m: f64,
}

impl Near {
    /// Takes over positions and velocities of everybody.
    pub fn fill(&mut self, people: impl Iterator<Item = (Point2<f64>, Vector2<f64>)>) {
        self.bodies.clear();
        self.bodies.extend(people.map(|(at, velocity)| Body { x: at.x, y: at.y, vx: velocity.x, vy: velocity.y }));
        self.order.clear();
        self.x.clear();
        self.y.clear();
        let Some(extent) = Extent::of(self.bodies.iter().filter(|body| body.is_finite())) else { return };
        #[expect(clippy::cast_precision_loss, reason = "a crowd never has 2^53 people")]
        let count = self.bodies.len() as f64;
        // A crowd in a line has no area; its length counts as wide as it has people per meter.
        let area = (extent.right - extent.left) * (extent.top - extent.bottom);
        let area = area.max(extent.size_m() * extent.size_m() / count);
        self.density = count / area;
        let ends = [extent.left, extent.right, extent.bottom, extent.top];
        self.slack_m = SLACK.1 * ends.into_iter().fold(0.0, |most: f64, end| most.max(end.abs()));
        let side_m = (area / count * PER_CELL).sqrt();
        self.cells.sort(&self.bodies, &extent, side_m, side_m, &mut self.order);
        let sorted = self.order.iter().filter_map(|place| self.bodies.get(*place as usize));
        for body in sorted {
            self.x.push(body.x);
            self.y.push(body.y);
        }
    }

    /// Adds everybody nearer than `range_m` to `at` to `found`, in no order that means anything.
    pub fn within(&self, at: &Point2<f64>, range_m: f64, found: &mut Vec<Found>) {
        if self.order.is_empty() || !(at.x.is_finite() && at.y.is_finite() && range_m > 0.0) {
            return;
        }
        let before = found.len();
        let reach_m = range_m * (1.0 + SLACK.0) + self.slack_m;
        for row in self.cells.row(at.y - reach_m)..=self.cells.row(at.y + reach_m) {
            let off = self.cells.off_row(row, at.y);
            if off.abs() > reach_m {
                continue;
            }
            let half = (reach_m * reach_m - off * off).sqrt();
            let (from, to) = self.cells.span(row, at.x - half, at.x + half);
            let places = self.order.get(from..to).into_iter().flatten();
            let spots = self.x.get(from..to).into_iter().flatten().zip(self.y.get(from..to).into_iter().flatten());
            // Without a branch on the outcome, which would be guessed wrong: everybody is written, and the next one
            // over whoever is too far off.
            let mut count = found.len();
            found.resize(count + to.saturating_sub(from), Found { distance_m: 0.0, place: 0 });
            for (place, (x, y)) in places.zip(spots) {
                let (dx, dy) = (x - at.x, y - at.y);
                let square = dx * dx + dy * dy;
                if let Some(slot) = found.get_mut(count) {
                    *slot = Found { distance_m: square, place: *place as usize };
                }
                count += usize::from(square <= reach_m * reach_m);
            }
            found.truncate(count);
        }
        for found in found.iter_mut().skip(before) {
            found.distance_m = found.distance_m.sqrt();
        }
        // The reach is a little more than the range.
        found.retain(|found| found.distance_m < range_m);
    }

    /// Makes `found` the nearest `most` of those who are nearer than `range_m` to `at` and not at the place `me`: the
    /// nearest first, those at one distance in the order of places.
    pub fn nearest(&self, at: &Point2<f64>, me: Option<usize>, range_m: f64, most: usize, found: &mut Vec<Found>) {
        #[expect(clippy::cast_precision_loss, reason = "a few people")]
        let wanted = most as f64;
        // Often the few are found long before the end of the range.
        let mut look_m = (FIRST_SHARE * wanted / (std::f64::consts::PI * self.density)).sqrt();
        loop {
            // Nothing of a length to look at is a crowd on one spot.
            look_m = if look_m > 0.0 && look_m < range_m { look_m } else { range_m };
            found.clear();
            self.within(at, look_m, found);
            found.retain(|found| Some(found.place) != me);
            if found.len() >= most || look_m >= range_m || found.len() >= self.order.len() {
                break;
            }
            look_m *= GROWTH;
        }
        nearest_first(found, most);
    }
}

/// Leaves the nearest `most`, the nearest first, those at one distance in the order of places.
pub(crate) fn nearest_first(found: &mut Vec<Found>, most: usize) {
    if found.len() <= FEW && by_rank(found, most) {
        return;
    }
    let order = |a: &Found, b: &Found| a.distance_m.total_cmp(&b.distance_m).then(a.place.cmp(&b.place));
    if found.len() > most {
        if most > 0 {
            found.select_nth_unstable_by(most - 1, order);
        }
        found.truncate(most);
    }
    found.sort_unstable_by(order);
}

/// The same for at most [`FEW`] of different distances; with two at one distance nothing changes, and the answer is no.
///
/// Every comparison is made, and none is waited for.
fn by_rank(found: &mut Vec<Found>, most: usize) -> bool {
    let mut distances = [f64::INFINITY; FEW];
    for (distance, found) in distances.iter_mut().zip(&*found) {
        *distance = found.distance_m;
    }
    let (half, _) = distances.split_at(FEW / 2);
    let distances = if found.len() <= half.len() { half } else { &distances };
    let mut sorted = [None; FEW];
    for found in &*found {
        let nearer: u32 = distances.iter().map(|distance| u32::from(*distance < found.distance_m)).sum();
        if let Some(slot) = sorted.get_mut(nearer as usize) {
            *slot = Some(*found);
        }
    }
    let count = found.len().min(most);
    let whole = sorted.iter().take(found.len()).all(Option::is_some);
    if whole {
        found.truncate(count);
        for (found, sorted) in found.iter_mut().zip(sorted.into_iter().flatten()) {
            *found = sorted;
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;
    use crate::vector::norm;

    type Crowd = Vec<(Point2<f64>, Vector2<f64>)>;

    /// Crowds of every kind: thin, dense, in a line, on few spots, with somebody far off and with nobody finite.
    fn crowds() -> Vec<Crowd> {
        let mut random = SplitMix64::new(12);
        let mut number = |size: f64| (random.next_f64() - 0.5) * size;
        let mut crowds: Vec<Crowd> = Vec::new();
        for (count, width, height) in
            [(1, 1.0, 1.0), (300, 40.0, 30.0), (300, 5.0, 5.0), (200, 90.0, 0.0), (100, 0.0, 0.0)]
        {
            crowds.push(
                (0..count)
                    .map(|_| (Point2::new(number(width), number(height)), Vector2::new(number(2.0), number(2.0))))
                    .collect(),
            );
        }
        // Spots of a lattice, each taken by several: many at exactly one distance.
        crowds.push((0..200).map(|k| (Point2::new(f64::from(k % 7), f64::from(k % 5)), Vector2::zeros())).collect());
        let mut strange = crowds[1].clone();
        strange[3].0.x = f64::NAN;
        strange[5].1.y = f64::INFINITY;
        strange[8].0 = Point2::new(1e7, -3e5);
        crowds.push(strange);
        crowds.push(vec![(Point2::new(f64::NAN, 0.0), Vector2::zeros()); 3]);
        crowds.push(Vec::new());
        crowds
    }

    fn by_looking_at_all(crowd: &Crowd, at: &Point2<f64>, me: usize, range_m: f64) -> Vec<Found> {
        let finite = |(at, velocity): &(Point2<f64>, Vector2<f64>)| {
            at.iter().chain(velocity.iter()).all(|number| number.is_finite())
        };
        let others = crowd.iter().enumerate().filter(|(place, other)| *place != me && finite(other));
        let mut found: Vec<Found> =
            others.map(|(place, (other, _))| Found { distance_m: norm(&(other - at)), place }).collect();
        found.retain(|found| found.distance_m < range_m);
        found.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.place.cmp(&b.place)));
        found
    }

    #[test]
    fn the_nearest_are_those_that_a_look_at_everybody_finds() {
        let mut near = Near::default();
        let mut some = 0;
        for crowd in crowds() {
            near.fill(crowd.iter().copied());
            for (me, (at, _)) in crowd.iter().enumerate().filter(|(_, (at, _))| at.x.is_finite()) {
                for (range_m, most) in [(5.0, 10), (5.0, 1), (2.0, 0), (0.0, 4), (1e9, 12), (60.0, 10_000), (1.0, 3)] {
                    let mut wanted = by_looking_at_all(&crowd, at, me, range_m);
                    wanted.truncate(most);
                    let mut found = vec![Found { distance_m: 0.0, place: 9 }];
                    near.nearest(at, Some(me), range_m, most, &mut found);
                    assert_eq!(found, wanted, "{me} of {}, {most} in {range_m} m", crowd.len());
                    some += found.len();
                }
            }
        }
        assert!(some > 10_000, "{some}");
    }

    #[test]
    fn everybody_within_a_range_is_found_also_from_outside_the_crowd() {
        let mut near = Near::default();
        let mut random = SplitMix64::new(13);
        for crowd in crowds() {
            near.fill(crowd.iter().copied());
            for _ in 0..200 {
                let at = Point2::new(80.0 * random.next_f64() - 40.0, 80.0 * random.next_f64() - 40.0);
                let mut found = Vec::new();
                near.within(&at, 7.0, &mut found);
                found.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.place.cmp(&b.place)));
                assert_eq!(found, by_looking_at_all(&crowd, &at, usize::MAX, 7.0));
            }
        }
    }
}
