//! Labels that do not cover each other: each tries places around its point and takes the emptiest.

/// Axis-aligned box in pixels: left, top, width, height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Top edge.
    pub y: f64,
    /// Width.
    pub w: f64,
    /// Height.
    pub h: f64,
}

impl Area {
    /// Shared area with another box, px².
    #[must_use]
    pub fn overlap(&self, other: &Self) -> f64 {
        let w = (self.x + self.w).min(other.x + other.w) - self.x.max(other.x);
        let h = (self.y + self.h).min(other.y + other.h) - self.y.max(other.y);
        if w > 0.0 && h > 0.0 { w * h } else { 0.0 }
    }
}

/// Places labels one after another.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    taken: Vec<Area>,
    bounds: Option<Area>,
}

impl Labels {
    /// A sheet within which labels stay.
    #[must_use]
    pub fn within(bounds: Area) -> Self {
        Self { taken: Vec::new(), bounds: Some(bounds) }
    }

    /// Marks a box as taken by something else.
    pub fn block(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// The top left corner for a label of this size near a point, `gap` px away from it.
    pub fn place(&mut self, at: (f64, f64), size: (f64, f64), gap: f64) -> Area {
        let (w, h) = size;
        let mut best: Option<(f64, Area)> = None;
        // Right, left, above, below, the diagonals, then the same further out.
        for (ring, reach) in [(0.0, gap), (1.0, gap * 2.2), (2.0, gap * 3.6)] {
            let places = [
                (at.0 + reach, at.1 - h / 2.0),
                (at.0 - reach - w, at.1 - h / 2.0),
                (at.0 - w / 2.0, at.1 - reach - h),
                (at.0 - w / 2.0, at.1 + reach),
                (at.0 + reach * 0.8, at.1 - reach * 0.8 - h),
                (at.0 - reach * 0.8 - w, at.1 - reach * 0.8 - h),
                (at.0 + reach * 0.8, at.1 + reach * 0.8),
                (at.0 - reach * 0.8 - w, at.1 + reach * 0.8),
            ];
            for (order, (x, y)) in places.into_iter().enumerate() {
                let area = Area { x, y, w, h };
                let covered: f64 = self.taken.iter().map(|other| area.overlap(other)).sum();
                let outside = self.bounds.as_ref().map_or(0.0, |bounds| w * h - area.overlap(bounds));
                #[expect(clippy::cast_precision_loss, reason = "eight places")]
                let cost = covered * 10.0 + outside * 20.0 + ring * 4.0 + order as f64 * 0.1;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, area));
                }
            }
        }
        let area = best.map_or(Area { x: at.0, y: at.1, w, h }, |(_, area)| area);
        self.taken.push(area);
        area
    }
}

/// Width of a text in the shipped font, px; a fair estimate is enough to keep labels apart.
#[must_use]
pub fn text_width(text: &str, size_px: f64) -> f64 {
    text.chars()
        .map(|c| match c {
            'i' | 'l' | 'j' | 'I' | '.' | ',' | ' ' | ':' | '|' | '\'' => 0.30,
            'm' | 'w' | 'M' | 'W' => 0.88,
            c if c.is_uppercase() => 0.68,
            _ => 0.56,
        })
        .sum::<f64>()
        * size_px
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_neighbors_do_not_overlap() {
        let mut labels = Labels::within(Area { x: 0.0, y: 0.0, w: 400.0, h: 400.0 });
        let placed: Vec<Area> =
            (0..6).map(|i| labels.place((200.0 + f64::from(i) * 6.0, 200.0), (40.0, 14.0), 8.0)).collect();
        for (i, a) in placed.iter().enumerate() {
            for b in placed.iter().skip(i + 1) {
                assert!(a.overlap(b) < 1.0, "{a:?} {b:?}");
            }
        }
    }
}
