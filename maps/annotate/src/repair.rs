//! A sketch made whole: parts that nothing joins are led together, and what is far on the ways and near over free floor gets a way.

use std::collections::{BTreeMap, BTreeSet};

use socrates_model::geometry::segments_cross;

use crate::floor::Floor;
use crate::sketch::{Ground, Sketch, What, spread};
use crate::way::{KEPT_M, is_straight, simplified, way};

/// Longest straight way that is added beside others, m.
const SHORTCUT_MOST_M: f64 = 8.0;
/// Clearance in the middle of such a way, m.
const SHORTCUT_CLEAR_M: f64 = 1.2;
/// How many times as long the way along the others is at least.
const SHORTCUT: f64 = 1.5;
/// Pairs of places that are tried to join two parts.
const REPAIRS: usize = 4;

impl Sketch {
    /// Adds straight ways over wide floor where the way along the others is much longer.
    pub(crate) fn shortcuts(&mut self, ground: &Ground<'_>) {
        let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
        let walked =
            |at: &usize| self.places.get(*at).is_some_and(|place| matches!(place.what, What::Way | What::Corner));
        let mut places: Vec<usize> = (0..self.places.len()).filter(walked).collect();
        places.sort_by(|a, b| self.at(*a).x.total_cmp(&self.at(*b).x).then(a.cmp(b)));
        for (rank, one) in places.iter().enumerate() {
            // Those to the right, as far as they are near.
            let rest = places.get(rank + 1..).unwrap_or_default();
            for other in rest.iter().take_while(|other| self.at(**other).x - self.at(*one).x <= SHORTCUT_MOST_M) {
                let length = (self.at(*one) - self.at(*other)).norm();
                if length <= SHORTCUT_MOST_M {
                    pairs.push((length, [*one.min(other), *one.max(other)]));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (length, [a, b]) in pairs {
            let (from, to) = (self.at(a), self.at(b));
            let crosses = || {
                self.ways.iter().any(|way| {
                    !way.contains(&a)
                        && !way.contains(&b)
                        && segments_cross(&from, &to, &self.at(way[0]), &self.at(way[1]))
                })
            };
            let floor = ground.floor;
            if floor.clean_m(&(from + (to - from) * 0.5)) >= SHORTCUT_CLEAR_M
                && floor.line_m(&from, &to) >= KEPT_M
                && floor.clean_line_m(&from, &to) > 0.0
                && self.length_m(a, b, SHORTCUT * length) > SHORTCUT * length
                && !crosses()
            {
                self.join(a, b);
            }
        }
    }

    /// Length of the shortest way between two places, m; infinite where it is longer than the most.
    pub(crate) fn length_m(&self, from: usize, to: usize, most_m: f64) -> f64 {
        let mut away: BTreeMap<usize, f64> = BTreeMap::from([(from, 0.0)]);
        let mut open: Vec<(f64, usize)> = vec![(0.0, from)];
        while let Some(next) = open.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0)).map(|(at, _)| at) {
            let (so_far, here) = open.swap_remove(next);
            if here == to || so_far > most_m {
                return if here == to { so_far } else { f64::INFINITY };
            }
            for other in self.beside(here).iter().copied() {
                let total = so_far + (self.at(other) - self.at(here)).norm();
                if away.get(&other).is_none_or(|known| total < *known) {
                    away.insert(other, total);
                    open.push((total, other));
                }
            }
        }
        f64::INFINITY
    }

    /// Takes away ways along which the robot does not get.
    pub(crate) fn drop_blocked(&mut self, floor: &Floor) {
        let ways = std::mem::take(&mut self.ways);
        self.forget_ways();
        for [a, b] in ways {
            if is_straight(floor, &self.at(a), &self.at(b), 0.0) {
                self.join(a, b);
            }
        }
    }

    /// Number of the part of each place that hangs together, the lowest of its places.
    pub(crate) fn parts(&self) -> Vec<usize> {
        let mut up: Vec<usize> = (0..self.places.len()).collect();
        let root = |up: &[usize], mut at: usize| {
            while let Some(next) = up.get(at).copied().filter(|next| *next != at) {
                at = next;
            }
            at
        };
        for [a, b] in &self.ways {
            let (a, b) = (root(&up, *a), root(&up, *b));
            if let Some(slot) = up.get_mut(a.max(b)) {
                *slot = a.min(b);
            }
        }
        (0..up.len()).map(|at| root(&up, at)).collect()
    }

    /// The number of the largest part.
    pub(crate) fn largest(parts: &[usize]) -> Option<usize> {
        let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
        for part in parts {
            *sizes.entry(*part).or_insert(0) += 1;
        }
        sizes.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0))).map(|(part, _)| *part)
    }

    /// Leads parts that nothing joins with the largest one there, round what lies between them.
    pub(crate) fn repair(&mut self, floor: &Floor) {
        let mut hopeless: BTreeSet<usize> = BTreeSet::new();
        for _ in 0..self.places.len() {
            let parts = self.parts();
            let Some(main) = Self::largest(&parts) else { return };
            let of_main = |place: &usize| parts.get(*place) == Some(&main);
            let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
            for (place, part) in parts.iter().enumerate() {
                if *part == main || hopeless.contains(part) {
                    continue;
                }
                let others = (0..self.places.len()).filter(of_main);
                pairs.extend(others.map(|other| ((self.at(other) - self.at(place)).norm(), place, other)));
            }
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
            let Some((_, first, _)) = pairs.first().copied() else { return };
            let Some(part) = parts.get(first).copied() else { return };
            let own = pairs.iter().filter(|(_, place, _)| parts.get(*place) == Some(&part)).take(REPAIRS);
            let found = own.into_iter().find_map(|(_, place, other)| {
                let path = way(floor, &self.at(*place), &self.at(*other))?;
                Some((*place, *other, path))
            });
            match found {
                Some((place, other, path)) => {
                    let corners = spread(floor, &simplified(floor, &path));
                    self.chain(place, other, &corners, What::Corner);
                    if self.parts().get(place) != self.parts().get(other) {
                        hopeless.insert(part);
                    }
                }
                None => {
                    hopeless.insert(part);
                }
            }
        }
    }
}
