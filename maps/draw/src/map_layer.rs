//! The map under every picture: floor, walls, doors and, faintly, the scene graph.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use socrates_model::{Cell, Location, Point};

use crate::label::Area;
use crate::palette;
use crate::svg::Svg;

/// Part of the map that is shown and its scale: world meters to picture pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Cell columns and rows that are shown: first column, first row, columns, rows.
    pub cells: (usize, usize, usize, usize),
    /// Picture pixels per cell.
    pub scale: f64,
    /// Left and top margin of the map in the picture, px.
    pub at: (f64, f64),
}

/// Margin of unknown cells kept around the seen part.
const MARGIN_CELLS: usize = 6;
/// Room kept beside the tracks of a focused picture, m: enough to see the walls people keep off.
const FOCUS_ROOM_M: f64 = 2.5;
/// Room beside a scene graph, m.
const GRAPH_ROOM_M: f64 = 3.0;
/// A focused picture shows at least so much, m a side: less would hide where it is.
const FOCUS_LEAST_M: f64 = 9.0;
/// A focus that keeps more than this share of the map is no focus.
const FOCUS_SAVES: f64 = 0.75;

impl Frame {
    /// The frame around everything that is not unknown, at most so large in pixels.
    #[must_use]
    pub fn around(location: &Location, max_w: f64, max_h: f64, at: (f64, f64)) -> Self {
        let grid = &location.grid;
        let (mut left, mut top, mut right, mut bottom) = (usize::MAX, usize::MAX, 0, 0);
        for row in 0..grid.height {
            for column in 0..grid.width {
                if grid.at(column, row) == Cell::Free {
                    left = left.min(column);
                    right = right.max(column + 1);
                    top = top.min(row);
                    bottom = bottom.max(row + 1);
                }
            }
        }
        if left >= right || top >= bottom {
            (left, top, right, bottom) = (0, 0, grid.width.max(1), grid.height.max(1));
        }
        let (x0, y0) = (left.saturating_sub(MARGIN_CELLS), top.saturating_sub(MARGIN_CELLS));
        let (x1, y1) = ((right + MARGIN_CELLS).min(grid.width), (bottom + MARGIN_CELLS).min(grid.height));
        let (w, h) = (x1.saturating_sub(x0).max(1), y1.saturating_sub(y0).max(1));
        #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
        let scale = (max_w / w as f64).min(max_h / h as f64);
        Self { cells: (x0, y0, w, h), scale, at }
    }

    /// The frame around these points and some room beside them; the whole map where that saves little.
    #[must_use]
    pub fn focused(location: &Location, points: &[Point], max_w: f64, max_h: f64, at: (f64, f64)) -> Self {
        Self::with_room(location, points, FOCUS_ROOM_M, (max_w, max_h), at)
    }

    /// The frame around the scene graph and 3 m beside it; the whole map where that saves little, or where there is no graph.
    #[must_use]
    pub fn of_graph(location: &Location, max_w: f64, max_h: f64, at: (f64, f64)) -> Self {
        let points: Vec<Point> = location.graph.nodes().iter().map(|node| node.at).collect();
        Self::with_room(location, &points, GRAPH_ROOM_M, (max_w, max_h), at)
    }

    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "cells of a map, clipped to its bounds"
    )]
    fn with_room(
        location: &Location,
        points: &[Point],
        room_m: f64,
        (max_w, max_h): (f64, f64),
        at: (f64, f64),
    ) -> Self {
        let whole = Self::around(location, max_w, max_h, at);
        let (x0, y0, w, h) = whole.cells;
        let cell = location.grid.resolution_m.max(1e-6);
        let (mut left, mut top, mut right, mut bottom) = (f64::MAX, f64::MAX, f64::MIN, f64::MIN);
        for point in points {
            let (x, y) = location.grid.pixel_from_world(point);
            (left, right) = (left.min(x), right.max(x));
            (top, bottom) = (top.min(y), bottom.max(y));
        }
        if left > right || !(left + right + top + bottom).is_finite() {
            return whole;
        }
        let (room, least) = (room_m / cell, FOCUS_LEAST_M / cell);
        let (wish_w, wish_h) = ((right - left + 2.0 * room).max(least), (bottom - top + 2.0 * room).max(least));
        let (wish_w, wish_h) = (wish_w.max(wish_h * max_w / max_h), wish_h.max(wish_w * max_h / max_w));
        let (left, width) = widened(left, right, wish_w, (x0 as f64, w as f64));
        let (top, height) = widened(top, bottom, wish_h, (y0 as f64, h as f64));
        if width * height > FOCUS_SAVES * (w as f64) * (h as f64) {
            return whole;
        }
        let cells = (left.max(0.0) as usize, top.max(0.0) as usize, (width as usize).max(1), (height as usize).max(1));
        Self { cells, scale: (max_w / cells.2 as f64).min(max_h / cells.3 as f64), at }
    }

    /// Width and height in the picture, px.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    pub fn size(&self) -> (f64, f64) {
        (self.cells.2 as f64 * self.scale, self.cells.3 as f64 * self.scale)
    }

    /// Picture position of a world point.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    pub fn px(&self, location: &Location, point: &Point) -> (f64, f64) {
        let (x, y) = location.grid.pixel_from_world(point);
        (self.at.0 + (x - self.cells.0 as f64) * self.scale, self.at.1 + (y - self.cells.1 as f64) * self.scale)
    }

    /// The parts of a line, px, that lie in the picture of the map: what is not drawn needs no clip mask, which costs a painter
    /// more than everything else.
    #[must_use]
    pub fn inside(&self, line: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
        for pair in line.windows(2) {
            let [from, to] = pair else { continue };
            let Some((a, b)) = self.cut(*from, *to) else { continue };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&a) => part.push(b),
                Some(_) | None => parts.push(vec![a, b]),
            }
        }
        parts
    }

    /// The part of one straight line that lies in the picture of the map (Liang and Barsky 1984).
    fn cut(&self, from: (f64, f64), to: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
        let ((dx, dy), (w, h)) = ((to.0 - from.0, to.1 - from.1), self.size());
        let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
        let (left, top) = (from.0 - self.at.0, from.1 - self.at.1);
        for (step, room) in [(-dx, left), (dx, w - left), (-dy, top), (dy, h - top)] {
            if step < 0.0 {
                enters = enters.max(room / step);
            } else if step > 0.0 {
                leaves = leaves.min(room / step);
            } else if room < 0.0 {
                return None;
            }
        }
        let at = |share: f64| (from.0 + dx * share, from.1 + dy * share);
        let end = |share: f64| {
            if share <= 0.0 {
                from
            } else if share >= 1.0 {
                to
            } else {
                at(share)
            }
        };
        (enters <= leaves).then(|| (end(enters), end(leaves)))
    }

    /// Picture length of a world length.
    #[must_use]
    pub fn len(&self, location: &Location, meters: f64) -> f64 {
        meters / location.grid.resolution_m * self.scale
    }
}

/// Start and size of a span of this size around `lo..hi`, moved into bounds given by start and size.
fn widened(lo: f64, hi: f64, wish: f64, bounds: (f64, f64)) -> (f64, f64) {
    let size = wish.min(bounds.1);
    let start = f64::midpoint(lo, hi) - size / 2.0;
    (start.min(bounds.0 + bounds.1 - size).max(bounds.0), size)
}

/// A small map of the whole place with a box around what the frame shows.
pub fn draw_locator(svg: &mut Svg, location: &Location, frame: &Frame, right: f64, top: f64, size: (f64, f64)) {
    let mut small = Frame::around(location, size.0, size.1, (0.0, top));
    small.at.0 = right - small.size().0;
    draw_floor(svg, location, &small);
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let place = |cell: usize, first: usize| (cell as f64 - first as f64) * small.scale;
    let (x, y, w, h) = frame.cells;
    svg.rect(
        (small.at.0 + place(x, small.cells.0), small.at.1 + place(y, small.cells.1)),
        (place(w, 0), place(h, 0)),
        &format!("fill=\"{0}\" fill-opacity=\"0.14\" stroke=\"{0}\" stroke-width=\"2\"", palette::ROBOT),
    );
}

/// The boxes of the walls in the picture, for labels to keep off.
#[must_use]
pub fn wall_areas(location: &Location, frame: &Frame) -> Vec<Area> {
    merged(location, frame, &|cell| cell == Cell::Occupied)
}

/// Draws floor and walls as merged rectangles. The floor lies under the walls too, so that no seam shows between them, and
/// edges are crisp: they are those of cells.
pub fn draw_floor(svg: &mut Svg, location: &Location, frame: &Frame) {
    let (w, h) = frame.size();
    svg.rect(frame.at, (w, h), &format!("fill=\"{}\" shape-rendering=\"crispEdges\"", palette::UNKNOWN));
    let layers: [(&dyn Fn(Cell) -> bool, &str); 2] =
        [(&|cell| cell != Cell::Unknown, palette::FLOOR), (&|cell| cell == Cell::Occupied, palette::WALL)];
    for (shown, color) in layers {
        let mut path = String::new();
        for area in merged(location, frame, shown) {
            // Writing into a String cannot fail.
            if write!(path, "M{:.1} {:.1}h{:.1}v{:.1}h{:.1}z", area.x, area.y, area.w, area.h, -area.w).is_err() {
                return;
            }
        }
        if !path.is_empty() {
            svg.raw(&format!("<path fill=\"{color}\" shape-rendering=\"crispEdges\" d=\"{path}\"/>"));
        }
    }
}

/// Draws door lines: dashed where they may open.
pub fn draw_doors(svg: &mut Svg, location: &Location, frame: &Frame) {
    for door in &location.doors {
        let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
        for part in frame.inside(&[from, to]) {
            svg.polyline(&part, &format!("stroke=\"{}\" stroke-width=\"3\" stroke-dasharray=\"5 3\"", palette::DOOR));
        }
    }
}

/// Draws the ways of the scene graph as faint lines.
pub fn draw_graph(svg: &mut Svg, location: &Location, frame: &Frame, color: &str, width: f64) {
    for edge in location.graph.edges() {
        if let Some(points) = location.graph.edge_points(&edge.from, &edge.to) {
            let line: Vec<(f64, f64)> = points.iter().map(|p| frame.px(location, p)).collect();
            for part in frame.inside(&line) {
                svg.polyline(&part, &format!("stroke=\"{color}\" stroke-width=\"{width}\""));
            }
        }
    }
}

/// The round length of the scale bar of a frame, m.
fn scale_m(location: &Location, frame: &Frame) -> f64 {
    [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|m| frame.len(location, *m) >= 60.0).unwrap_or(100.0)
}

/// Where the words of the scale bar end, px from the left.
pub(crate) fn scale_end_px(location: &Location, frame: &Frame) -> f64 {
    const WORDS_PX: f64 = 48.0;
    frame.at.0 + frame.len(location, scale_m(location, frame)) + WORDS_PX
}

/// A scale bar of a round length at the lower left of the frame.
pub fn draw_scale(svg: &mut Svg, location: &Location, frame: &Frame, below: f64) {
    let length_m = scale_m(location, frame);
    let (x, y) = (frame.at.0, frame.at.1 + frame.size().1 + below);
    let w = frame.len(location, length_m);
    let ink = palette::QUIET;
    svg.line((x, y), (x + w, y), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.line((x, y - 4.0), (x, y + 4.0), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.line((x + w, y - 4.0), (x + w, y + 4.0), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.text((x + w + 8.0, y + 4.0), &format!("{length_m:.0} m"), &format!("font-size=\"12\" fill=\"{ink}\""));
}

/// Boxes of all cells of the wanted kinds: row runs, joined downward where they repeat.
fn merged(location: &Location, frame: &Frame, wanted: &dyn Fn(Cell) -> bool) -> Vec<Area> {
    let grid = &location.grid;
    let (x0, y0, w, h) = frame.cells;
    let mut open: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut areas = Vec::new();
    for row in y0..=y0 + h {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        if row < y0 + h {
            let mut start = None;
            for column in x0..=x0 + w {
                let here = column < x0 + w && wanted(grid.at(column, row));
                match (start, here) {
                    (None, true) => start = Some(column),
                    (Some(from), false) => {
                        runs.push((from, column));
                        start = None;
                    }
                    (None, false) | (Some(_), true) => {}
                }
            }
        }
        let ended: Vec<(usize, usize)> = open.keys().filter(|run| !runs.contains(run)).copied().collect();
        for run in ended {
            if let Some(top) = open.remove(&run) {
                areas.push(rectangle(frame, run, top, row));
            }
        }
        for run in runs {
            open.entry(run).or_insert(row);
        }
    }
    areas
}

#[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
fn rectangle(frame: &Frame, run: (usize, usize), top: usize, bottom: usize) -> Area {
    Area {
        x: frame.at.0 + (run.0 - frame.cells.0) as f64 * frame.scale,
        y: frame.at.1 + (top - frame.cells.1) as f64 * frame.scale,
        w: (run.1 - run.0) as f64 * frame.scale,
        h: (bottom - top) as f64 * frame.scale,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_the_frame() {
        let frame = Frame { cells: (0, 0, 10, 10), scale: 10.0, at: (20.0, 50.0) };
        let inside = |line: &[(f64, f64)]| frame.inside(line);
        assert_eq!(inside(&[(30.0, 60.0), (40.0, 60.0), (40.0, 70.0)]).len(), 1, "what lies inside stays one line");
        assert_eq!(inside(&[(0.0, 60.0), (140.0, 60.0)]), [[(20.0, 60.0), (120.0, 60.0)]]);
        assert_eq!(inside(&[(70.0, 100.0), (170.0, 200.0)]), [[(70.0, 100.0), (120.0, 150.0)]]);
        assert_eq!(inside(&[(0.0, 0.0), (10.0, 200.0)]), Vec::<Vec<(f64, f64)>>::new());
        let out_and_in = [(30.0, 60.0), (30.0, 0.0), (60.0, 0.0), (60.0, 60.0)];
        assert_eq!(inside(&out_and_in), [[(30.0, 60.0), (30.0, 50.0)], [(60.0, 50.0), (60.0, 60.0)]]);
    }

    #[test]
    fn a_span_is_widened_and_stays_inside() {
        assert_eq!(widened(4.0, 6.0, 4.0, (0.0, 20.0)), (3.0, 4.0));
        assert_eq!(widened(0.0, 2.0, 10.0, (0.0, 20.0)), (0.0, 10.0));
        assert_eq!(widened(19.0, 20.0, 10.0, (0.0, 20.0)), (10.0, 10.0));
        assert_eq!(widened(5.0, 6.0, 90.0, (0.0, 20.0)), (0.0, 20.0));
    }
}
