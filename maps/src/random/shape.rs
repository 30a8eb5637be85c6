//! Places and rectangles in tenths of a meter: one tenth is one pixel of the map, so that every width is exact.

/// A position, tenths of a meter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Spot {
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A rectangle, tenths of a meter; the first corner is the lower left one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) x0: i32,
    pub(super) y0: i32,
    pub(super) x1: i32,
    pub(super) y1: i32,
}

impl Area {
    /// The rectangle between two corners, in whatever order.
    pub(super) fn between(a: Spot, b: Spot) -> Self {
        Self { x0: a.x.min(b.x), y0: a.y.min(b.y), x1: a.x.max(b.x), y1: a.y.max(b.y) }
    }

    /// Whether the insides share a place.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }

    /// The rectangle, larger on every side.
    pub(super) fn grown(&self, by: i32) -> Self {
        Self { x0: self.x0 - by, y0: self.y0 - by, x1: self.x1 + by, y1: self.y1 + by }
    }

    /// Whether the other one lies in it; a shared side is allowed.
    pub(super) fn holds(&self, other: &Self) -> bool {
        self.x0 <= other.x0 && self.y0 <= other.y0 && self.x1 >= other.x1 && self.y1 >= other.y1
    }
}

/// A side of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    Left,
    Right,
    Bottom,
    Top,
}

impl Side {
    pub(super) const ALL: [Self; 4] = [Self::Bottom, Self::Top, Self::Left, Self::Right];

    /// Whether the side runs along x.
    pub(super) const fn along_x(self) -> bool {
        matches!(self, Self::Bottom | Self::Top)
    }
}

/// Coordinates of somebody who stands at a side of a rectangle and looks in: `u` along the side, `v` inward.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    area: Area,
    side: Side,
}

impl Frame {
    pub(super) const fn new(area: Area, side: Side) -> Self {
        Self { area, side }
    }

    /// Length of the side.
    pub(super) const fn length(&self) -> i32 {
        if self.side.along_x() { self.area.x1 - self.area.x0 } else { self.area.y1 - self.area.y0 }
    }

    /// From the side to the opposite one.
    pub(super) const fn depth(&self) -> i32 {
        if self.side.along_x() { self.area.y1 - self.area.y0 } else { self.area.x1 - self.area.x0 }
    }

    /// `u` of a coordinate along the side.
    pub(super) const fn u_of(&self, along: i32) -> i32 {
        if self.side.along_x() { along - self.area.x0 } else { along - self.area.y0 }
    }

    pub(super) const fn spot(&self, u: i32, v: i32) -> Spot {
        let area = &self.area;
        match self.side {
            Side::Bottom => Spot { x: area.x0 + u, y: area.y0 + v },
            Side::Top => Spot { x: area.x0 + u, y: area.y1 - v },
            Side::Left => Spot { x: area.x0 + v, y: area.y0 + u },
            Side::Right => Spot { x: area.x1 - v, y: area.y0 + u },
        }
    }

    /// The frame of a piece of the side, from one `u` to another.
    pub(super) fn part(&self, u: (i32, i32)) -> Self {
        Self { area: self.area(u, (0, self.depth())), side: self.side }
    }

    /// The rectangle over two ranges of `u` and `v`.
    pub(super) fn area(&self, (u0, u1): (i32, i32), (v0, v1): (i32, i32)) -> Area {
        Area::between(self.spot(u0, v0), self.spot(u1, v1))
    }
}
