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

/// Cost of covering a label or a symbol, per px².
const HIDES: f64 = 10.0;
/// Cost of covering a line or a wall, per px².
const CROSSES: f64 = 1.0;
/// Cost of one ring further out: about as much as 4 px of a line under a label.
const FURTHER: f64 = 24.0;
/// Side of the boxes that stand for a line, px.
const LINE_STEP_PX: f64 = 6.0;

/// Places labels one after another.
#[derive(Debug, Clone)]
pub struct Labels {
    taken: Vec<(Area, f64)>,
    bounds: Option<Area>,
    unit: f64,
}

impl Labels {
    /// A sheet within which labels stay.
    #[must_use]
    pub fn within(bounds: Area) -> Self {
        Self::scaled(bounds, 1.0)
    }

    /// The same on a sheet whose drawing unit is so many pixels of a screen: 0.5 where letters are half as large.
    #[must_use]
    pub const fn scaled(bounds: Area, unit: f64) -> Self {
        Self { taken: Vec::new(), bounds: Some(bounds), unit }
    }

    /// Marks a box as taken by something that a label must not hide.
    pub fn block(&mut self, area: Area) {
        self.taken.push((area, HIDES));
    }

    /// Marks boxes that a label rather avoids, such as walls.
    pub fn avoid(&mut self, areas: impl IntoIterator<Item = Area>) {
        self.taken.extend(areas.into_iter().map(|area| (area, CROSSES)));
    }

    /// Marks a line that a label rather does not cross.
    pub fn avoid_line(&mut self, points: &[(f64, f64)]) {
        for (from, to) in points.iter().zip(points.iter().skip(1)) {
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let step = LINE_STEP_PX * self.unit;
            let n = (dx.hypot(dy) / step).ceil().clamp(1.0, 400.0);
            let mut i = 0.0;
            while i < n {
                let (x, y) = (from.0 + dx * i / n, from.1 + dy * i / n);
                let half = step / 2.0;
                self.taken.push((Area { x: x - half, y: y - half, w: step, h: step }, CROSSES));
                i += 1.0;
            }
        }
    }

    /// The top left corner for a label of this size near a point, `gap` px away from it.
    pub fn place(&mut self, at: (f64, f64), size: (f64, f64), gap: f64) -> Area {
        let (w, h) = size;
        let mut best: Option<(f64, Area)> = None;
        // Right, left, above, below, the diagonals, then the same further out.
        for (ring, reach) in [(0.0, gap), (1.0, gap + 9.0 * self.unit), (2.0, gap + 20.0 * self.unit)] {
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
                let covered: f64 = self.taken.iter().map(|(other, cost)| area.overlap(other) * cost).sum();
                let outside = self.bounds.as_ref().map_or(0.0, |bounds| w * h - area.overlap(bounds));
                #[expect(clippy::cast_precision_loss, reason = "eight places")]
                let cost = covered + outside * 20.0 + (ring * FURTHER + order as f64) * self.unit * self.unit;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, area));
                }
            }
        }
        let area = best.map_or(Area { x: at.0, y: at.1, w, h }, |(_, area)| area);
        self.taken.push((area, HIDES));
        area
    }
}

/// A text broken into at most so many lines of a width in px; what is left over ends in `…`.
#[must_use]
pub fn wrapped(text: &str, width: f64, size_px: f64, lines: usize) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if line.is_empty() || text_width(&longer, size_px) <= width {
            line = longer;
        } else {
            out.push(std::mem::replace(&mut line, word.to_owned()));
        }
    }
    out.push(line);
    let cut = out.len() > lines;
    out.truncate(lines);
    if let Some(last) = out.last_mut() {
        if cut {
            last.push('…');
        }
        if text_width(last, size_px) > width {
            let mut kept = String::new();
            for c in last.chars() {
                if text_width(&kept, size_px) > width - size_px * 1.5 {
                    break;
                }
                kept.push(c);
            }
            kept.push('…');
            *last = kept;
        }
    }
    out
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

    #[test]
    fn a_label_keeps_off_a_line_where_there_is_room_beside_it() {
        let mut labels = Labels::within(Area { x: 0.0, y: 0.0, w: 400.0, h: 400.0 });
        labels.avoid_line(&[(0.0, 200.0), (400.0, 200.0)]);
        let area = labels.place((200.0, 200.0), (40.0, 14.0), 8.0);
        assert!(area.y + area.h < 200.0 || area.y > 200.0, "{area:?}");
    }

    #[test]
    fn a_long_text_is_broken_and_then_cut() {
        let text = "one two three four five six seven eight nine ten";
        let two = wrapped(text, 90.0, 12.0, 2);
        assert_eq!(two.len(), 2);
        assert!(two.iter().all(|line| text_width(line, 12.0) <= 100.0), "{two:?}");
        assert!(two.last().unwrap().ends_with('…'));
        assert_eq!(wrapped(text, 4000.0, 12.0, 2), [text]);
        assert!(text_width(&wrapped(&"x".repeat(500), 100.0, 12.0, 3)[0], 12.0) <= 110.0);
    }
}
