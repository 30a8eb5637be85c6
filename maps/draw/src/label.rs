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
/// Cost of covering a wall, per px²: words on black cannot be read.
const DARKENS: f64 = 6.0;
/// Cost of covering a line, per px².
const CROSSES: f64 = 1.0;
/// Cost of one ring further out: about as much as 4 px of a line under a label.
const FURTHER: f64 = 24.0;
/// Distances beyond the gap at which a label may stand, px.
const RINGS: [f64; 6] = [0.0, 9.0, 20.0, 32.0, 46.0, 62.0];
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
        self.taken.extend(areas.into_iter().map(|area| (area, DARKENS)));
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
        self.place_within(at, size, gap, RINGS.len())
    }

    /// [`Labels::place`] in at most so many rings: with one the label touches its point.
    pub fn place_within(&mut self, at: (f64, f64), size: (f64, f64), gap: f64, rings: usize) -> Area {
        let (w, h) = size;
        let mut best: Option<(f64, Area)> = None;
        // Right, left, above, below, the diagonals, then the same further out.
        let mut ring = 0.0;
        for more in RINGS.into_iter().take(rings.max(1)) {
            let reach = gap + more * self.unit;
            let (above, below) = (at.1 - reach - h, at.1 + reach);
            let places = [
                (at.0 + reach, at.1 - h / 2.0),
                (at.0 - reach - w, at.1 - h / 2.0),
                (at.0 - w / 2.0, above),
                (at.0 - w / 2.0, below),
                (at.0 + reach * 0.8, at.1 - reach * 0.8 - h),
                (at.0 - reach * 0.8 - w, at.1 - reach * 0.8 - h),
                (at.0 + reach * 0.8, at.1 + reach * 0.8),
                (at.0 - reach * 0.8 - w, at.1 + reach * 0.8),
                (at.0 - w * 0.2, above),
                (at.0 - w * 0.8, above),
                (at.0 - w * 0.2, below),
                (at.0 - w * 0.8, below),
            ];
            for (order, (x, y)) in places.into_iter().enumerate() {
                let area = Area { x, y, w, h };
                let covered: f64 = self.taken.iter().map(|(other, cost)| area.overlap(other) * cost).sum();
                let outside = self.bounds.as_ref().map_or(0.0, |bounds| w * h - area.overlap(bounds));
                #[expect(clippy::cast_precision_loss, reason = "a dozen places")]
                let cost = covered + outside * 20.0 + (ring * FURTHER + order as f64) * self.unit * self.unit;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, area));
                }
            }
            ring += 1.0;
        }
        let area = best.map_or(Area { x: at.0, y: at.1, w, h }, |(_, area)| area);
        self.taken.push((area, HIDES));
        area
    }
}

/// A text broken into at most so many lines of a width in px; what is left over ends in `…`.
#[must_use]
pub fn wrapped(text: &str, width: f64, size_px: f64, lines: usize) -> Vec<String> {
    wrapped_beside(text, |_| width, size_px, lines)
}

/// [`wrapped`] where each line has a width of its own, such as beside a picture and below it.
#[must_use]
pub fn wrapped_beside(text: &str, width: impl Fn(usize) -> f64, size_px: f64, lines: usize) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut line = String::new();
    for piece in pieces(text) {
        let room = width(out.len());
        let longer = if line.is_empty() { piece.clone() } else { format!("{line} {piece}") };
        if text_width(&longer, size_px) <= room {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            out.push(std::mem::take(&mut line));
        }
        // A dot between two statements is not needed where a new line parts them.
        let piece = piece.strip_prefix("· ").map_or_else(|| piece.clone(), str::to_owned);
        for part in cut(&piece, width(out.len()), size_px) {
            if !line.is_empty() {
                out.push(std::mem::replace(&mut line, part));
            } else {
                line = part;
            }
        }
    }
    out.push(line);
    if out.len() > lines {
        out.truncate(lines);
        if let Some(last) = out.last_mut() {
            while !last.is_empty()
                && text_width(last, size_px) + text_width("…", size_px) > width(lines.saturating_sub(1))
            {
                last.pop();
            }
            last.truncate(last.trim_end().len());
            last.push('…');
        }
    }
    out
}

/// The words of a text; those that must stay on one line are one piece: a number with its unit, a word with its number, and a
/// dot between statements with what it leads.
fn pieces(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let stays = out.last().is_some_and(|last| stays_with(last.rsplit(' ').next().unwrap_or(last), word));
        match out.last_mut() {
            Some(last) if stays => {
                last.push(' ');
                last.push_str(word);
            }
            _ => out.push(word.to_owned()),
        }
    }
    out
}

fn stays_with(last: &str, word: &str) -> bool {
    const UNITS: [&str; 14] =
        ["s", "m", "m/s", "m/s²", "rad/s", "°", "%", "ms", "min", "kB", "MB", "Hz", "of", "times"];
    const NUMBERED: [&str; 4] = ["seed", "of", "attempt", "version"];
    let bare = |word: &str| word.trim_matches(|c: char| "()[],.;:".contains(c)).to_owned();
    let number = |word: &str| bare(word).starts_with(|c: char| c.is_ascii_digit());
    last == "·" || (number(last) && UNITS.contains(&bare(word).as_str())) || (NUMBERED.contains(&last) && number(word))
}

/// A piece that is wider than a line, cut anywhere: a text without spaces, such as a Chinese one.
fn cut(piece: &str, width: f64, size_px: f64) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut wide = 0.0;
    for c in piece.chars() {
        let more = text_width(c.encode_utf8(&mut [0; 4]), size_px);
        if wide + more > width && wide > 0.0 {
            out.push(String::new());
            wide = 0.0;
        }
        wide += more;
        if let Some(last) = out.last_mut() {
            last.push(c);
        }
    }
    out
}

/// Width of a text in the shipped font, px.
#[must_use]
pub fn text_width(text: &str, size_px: f64) -> f64 {
    // The thin outline of headings and labels, and fonts of browsers that are a little wider.
    const MORE: f64 = 1.04;
    text.chars().map(crate::fonts::advance).sum::<f64>() * size_px * MORE
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
        let tall = wrapped("一位护士推着病床穿过走廊", 60.0, 12.0, 9);
        assert!(tall.len() > 2 && tall.iter().all(|line| text_width(line, 12.0) <= 60.0), "{tall:?}");
        assert_eq!(tall.concat(), "一位护士推着病床穿过走廊");
    }

    #[test]
    fn a_number_stays_with_its_unit_and_a_line_ends_in_no_dot() {
        let text = "arrived after 47.9 s (smallest distance 0.63 m, human_2 at 14.7 s) · 10 of 10 clauses · seed 1";
        for width in 60..700 {
            let lines = wrapped(text, f64::from(width), 14.0, 40);
            for line in &lines {
                let ends = [" ·", " 47.9", " 0.63", " 14.7", " seed", " of"];
                // Where one piece alone is too wide it has to be cut.
                assert!(width < 90 || !ends.iter().any(|end| line.ends_with(end)), "{width}: {lines:?}");
                assert!(
                    width < 90 || !["s ", "s)", "·", "of"].iter().any(|begin| line.starts_with(begin)),
                    "{lines:?}"
                );
            }
        }
        assert_eq!(wrapped(text, 4000.0, 14.0, 1), [text]);
    }
}
