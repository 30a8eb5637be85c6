//! The social force of many on a few people, for callers who choose the pairs themselves.

use std::ops::Range;

use nalgebra::Vector2;

use super::pairs::{Block, Constants, LANES, work_out};
use super::settings::Instructions;
use crate::forces::pair;
use crate::math::Portable;
use crate::params::Params;
use crate::vector::known;

/// Pairs of people with others: those of one person one after the other.
///
/// Keeps its memory. Every pair is worked out alone, and sums run in the order in which pairs came, so the bytes are
/// the same on every processor. Each pair is within 1e-13 m/s² of [`crate::forces_on`].
#[derive(Debug, Clone)]
pub struct Lanes {
    blocks: Vec<Block>,
    len: usize,
    arch: pulp::Arch,
}

impl Default for Lanes {
    fn default() -> Self {
        Self { blocks: Vec::new(), len: 0, arch: Instructions::Detected.arch() }
    }
}

impl Lanes {
    /// The same with a choice of instructions. Gives the same bytes; for tests and benches.
    #[must_use]
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch();
        self
    }

    /// Forgets all pairs.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// More pairs: where somebody else is from the person, m, and how much faster the person is, m/s. Gives their
    /// range.
    pub fn extend(&mut self, pairs: impl Iterator<Item = (Vector2<f64>, Vector2<f64>)>) -> Range<usize> {
        let start = self.len;
        for (way, faster) in pairs {
            if self.len == self.blocks.len() * LANES {
                self.blocks.push(Block::EMPTY);
            }
            if let Some(block) = self.blocks.get_mut(self.len / LANES) {
                block.set(self.len % LANES, &way, &faster);
            }
            self.len += 1;
        }
        start..self.len
    }

    /// Works out the social forces of all pairs.
    pub fn work_out(&mut self, params: &Params) {
        let blocks = self.blocks.get_mut(..self.len.div_ceil(LANES)).unwrap_or_default();
        self.arch.dispatch(All { blocks, constants: Constants::new(params) });
        for (place, block) in blocks.iter_mut().enumerate() {
            for lane in 0..LANES.min(self.len - place * LANES) {
                if block.force(lane).x.is_nan() {
                    edge(block, lane, params);
                }
            }
        }
    }

    /// Sum of the social forces of some pairs, m/s², once they are worked out.
    #[must_use]
    pub fn sum(&self, pairs: &Range<usize>) -> Vector2<f64> {
        pairs.clone().fold(Vector2::zeros(), |sum, pair| {
            sum + self.blocks.get(pair / LANES).map_or_else(Vector2::zeros, |block| block.force(pair % LANES))
        })
    }
}

/// A pair at an edge of the law, as the portable functions take it.
#[cold]
#[inline(never)]
fn edge(block: &mut Block, lane: usize, params: &Params) {
    let (way, faster) = block.pair(lane);
    block.set_force(lane, &known(pair::<Portable>(&way, &faster, params)));
}

/// All blocks, compiled once per set of instructions.
struct All<'a> {
    blocks: &'a mut [Block],
    constants: Constants,
}

impl pulp::WithSimd for All<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for block in self.blocks {
            work_out(block, &self.constants);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross::SplitMix64;
    use crate::forces_on;
    use crate::person::Person;
    use nalgebra::Point2;

    /// People around somebody: on one spot with it, alike, straight ahead, anywhere.
    fn people(random: &mut SplitMix64, count: u32) -> Vec<Person> {
        let mut number = |size: f64| (random.next_f64() - 0.5) * size;
        let mut people: Vec<Person> = (0..count)
            .map(|id| Person {
                velocity: Vector2::new(number(3.6), number(3.6)),
                ..Person::standing(id, Point2::new(number(10.0), number(10.0)))
            })
            .collect();
        people[1].position = people[0].position;
        people[2].position = people[0].position;
        people[2].velocity = people[0].velocity;
        people[3].position = people[0].position + people[0].velocity * 2.0;
        people[3].velocity = -people[0].velocity;
        people[4].velocity.x = f64::NAN;
        people
    }

    #[test]
    fn sums_are_those_of_the_portable_functions_on_every_processor() {
        let params = Params { social: 3.7, ..Params::default() };
        let mut random = SplitMix64::new(9);
        let mut all: Vec<Lanes> = [Instructions::Detected, Instructions::Avx2, Instructions::Baseline]
            .map(|instructions| Lanes::default().with_instructions(instructions))
            .to_vec();
        let mut worst: f64 = 0.0;
        for count in (5..60).cycle().take(2000) {
            let crowds = [people(&mut random, count), people(&mut random, 7)];
            let mut found = Vec::new();
            for lanes in &mut all {
                lanes.clear();
                let ranges = crowds.each_ref().map(|people| {
                    let pair =
                        |other: &Person| (other.position - people[0].position, people[0].velocity - other.velocity);
                    lanes.extend(people[1..].iter().map(pair))
                });
                lanes.work_out(&params);
                found.push(ranges.map(|range| lanes.sum(&range)));
            }
            for (place, people) in crowds.iter().enumerate() {
                let wanted = forces_on(0, people, &[], &params).social;
                worst = worst.max((found[0][place] - wanted).norm());
            }
            let bits = |sums: &[Vector2<f64>; 2]| sums.map(|sum| (sum.x.to_bits(), sum.y.to_bits()));
            assert!(found.iter().all(|sums| bits(sums) == bits(&found[0])));
        }
        assert!(worst < 1e-12, "{worst}");
        assert_eq!(Lanes::default().sum(&(0..0)), Vector2::zeros());
    }
}
