//! Furniture: blocks against walls or with a way all round, never on a way that the graph has.

use super::draft::Draft;
use super::rooms::Furniture;
use super::shape::{Area, Frame, Spot};

/// Least gap between two things that do not touch, tenths: a way of 0.9 m.
const AISLE: i32 = 9;
/// Free floor on both sides of a way of the graph, tenths.
const BESIDE: i32 = 6;

/// A room as seen from its door: `u` along the wall with the door, `v` inward, both from the room's own corner.
pub(super) struct Furnished<'a> {
    pub(super) frame: Frame,
    pub(super) draft: &'a mut Draft,
    kept: Vec<Area>,
    placed: Vec<Area>,
    room: Area,
}

impl<'a> Furnished<'a> {
    /// A room without furniture, whose ways are kept free.
    pub(super) fn new(frame: Frame, ways: &[(Spot, Spot)], draft: &'a mut Draft) -> Self {
        let room = frame.area((0, frame.length()), (0, frame.depth()));
        let kept = ways.iter().map(|(a, b)| Area::between(*a, *b).grown(BESIDE)).collect();
        Self { frame, draft, kept, placed: Vec::new(), room }
    }

    /// Places a block over two ranges, where there is room for it.
    fn put(&mut self, u: (i32, i32), v: (i32, i32)) -> bool {
        let block = self.frame.area(u, v);
        let room = self.room;
        let gaps = [block.x0 - room.x0, room.x1 - block.x1, block.y0 - room.y0, room.y1 - block.y1];
        let fits = room.holds(&block)
            && gaps.iter().all(|gap| *gap == 0 || *gap >= AISLE)
            && !self.kept.iter().any(|kept| kept.meets(&block))
            && self.placed.iter().all(|other| !other.grown(AISLE).meets(&block));
        if fits {
            self.placed.push(block);
            self.draft.block(block);
        }
        fits
    }

    /// Blocks along the far wall: `wide` along it, `deep` from it.
    fn along_far(&mut self, wide: i32, deep: i32, most: usize) {
        let (length, depth) = (self.frame.length(), self.frame.depth());
        let mut left = most;
        let mut u = 0;
        while left > 0 && u + wide <= length {
            // The last one stands in the corner.
            let u1 = if length - u - wide < AISLE { length } else { u + wide };
            if self.put((u1 - wide, u1), (depth - deep, depth)) {
                left -= 1;
                u += wide + AISLE;
            } else {
                u += 2;
            }
        }
    }

    /// Blocks along a side wall: `wide` along it, `deep` from it; the right wall where `right`.
    fn along_side(&mut self, right: bool, (wide, deep): (i32, i32), most: usize) {
        let (length, depth) = (self.frame.length(), self.frame.depth());
        let u = if right { (length - deep, length) } else { (0, deep) };
        let mut left = most;
        let mut v = 0;
        while left > 0 && v + wide <= depth {
            if self.put(u, (v, v + wide)) {
                left -= 1;
                v += wide + AISLE;
            } else {
                v += 2;
            }
        }
    }

    /// One block as long as fits along the far wall.
    fn far_strip(&mut self, deep: i32) {
        let (length, depth) = (self.frame.length(), self.frame.depth());
        if !self.put((0, length), (depth - deep, depth)) {
            self.along_far((length / 2).min(30), deep, 1);
        }
    }

    /// Blocks all over the floor.
    fn rows(&mut self, wide: i32, deep: i32, aisle: i32) {
        let (length, depth) = (self.frame.length(), self.frame.depth());
        let mut v = AISLE;
        while v + deep <= depth - AISLE {
            let mut u = AISLE;
            let mut any = false;
            while u + wide <= length - AISLE {
                let stands = self.put((u, u + wide), (v, v + deep));
                any |= stands;
                u += if stands { wide + aisle } else { 2 };
            }
            v += if any { deep + aisle } else { 2 };
        }
    }

    /// One block, as large as allowed, with a way all round it or nothing.
    fn middle(&mut self, wide: (i32, i32), deep: (i32, i32)) {
        let (length, depth) = (self.frame.length(), self.frame.depth());
        let mut w = wide.1.min(length - 2 * AISLE);
        while w >= wide.0 {
            let mut d = deep.1.min(depth - 2 * AISLE);
            while d >= deep.0 {
                let (u, v) = ((length - w) / 2, depth - AISLE - d);
                // In the middle of what is left behind the way from the door.
                for back in (0..=(v / 2)).rev().step_by(3) {
                    if self.put((u, u + w), (v - back, v - back + d)) {
                        return;
                    }
                }
                d -= 2;
            }
            w -= 4;
        }
    }

    /// Everything that belongs into a room of this furniture.
    pub(super) fn furnish(&mut self, furniture: Furniture) {
        match furniture {
            Furniture::Desks => {
                self.along_far(16, 8, 2);
                self.along_side(false, (16, 8), 1);
                self.along_side(true, (16, 8), 1);
            }
            Furniture::DeskRows => self.rows(16, 16, 16),
            Furniture::Table => self.middle((12, 44), (10, 16)),
            Furniture::Tables => {
                self.far_strip(6);
                self.rows(9, 9, 14);
            }
            Furniture::Beds => {
                self.along_far(10, 20, 4);
                self.along_side(false, (10, 20), 2);
                self.along_side(true, (10, 20), 2);
            }
            Furniture::BedInside => {
                self.middle((8, 10), (20, 20));
                self.along_far(14, 6, 1);
            }
            Furniture::Bedroom => {
                self.along_far(16, 20, 1);
                self.along_side(true, (16, 6), 1);
                self.along_side(false, (16, 6), 1);
            }
            Furniture::Shelves => {
                self.far_strip(6);
                self.along_side(false, (20, 5), 1);
                self.along_side(true, (20, 5), 1);
            }
            Furniture::Chairs => {
                self.far_strip(6);
                self.along_side(false, (24, 6), 3);
                self.along_side(true, (24, 6), 3);
                self.rows(24, 10, 20);
            }
            Furniture::Counter => {
                self.middle((14, 40), (7, 8));
                self.along_side(false, (18, 8), 1);
            }
            Furniture::Worktop => self.far_strip(6),
            Furniture::Sofas => {
                self.along_far(20, 9, 1);
                self.along_side(false, (20, 9), 1);
                self.along_side(true, (20, 9), 1);
                self.middle((10, 16), (8, 10));
            }
            Furniture::PalletRows => self.rows(12, 10, 24),
            Furniture::Pallets => {
                self.along_far(12, 10, 3);
                self.along_side(false, (12, 10), 2);
            }
        }
    }
}
