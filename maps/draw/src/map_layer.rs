//! The map under every picture: floor, walls, doors and, faintly, the scene graph.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use socrates_model::{Cell, Location, Point};

use crate::palette;
use crate::svg::Svg;

/// Part of the map that is shown and its scale: world metres to picture pixels.
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

    /// Picture length of a world length.
    #[must_use]
    pub fn len(&self, location: &Location, metres: f64) -> f64 {
        metres / location.grid.resolution_m * self.scale
    }
}

/// Draws floor and walls as merged rectangles.
pub fn draw_floor(svg: &mut Svg, location: &Location, frame: &Frame) {
    let (w, h) = frame.size();
    svg.rect(frame.at, (w, h), &format!("fill=\"{}\"", palette::UNKNOWN));
    for (cell, color) in [(Cell::Free, palette::FLOOR), (Cell::Occupied, palette::WALL)] {
        let path = merged(location, frame, cell);
        if !path.is_empty() {
            svg.raw(&format!("<path fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.4\" d=\"{path}\"/>"));
        }
    }
}

/// Draws door lines: dashed where they may open.
pub fn draw_doors(svg: &mut Svg, location: &Location, frame: &Frame) {
    for door in &location.doors {
        let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
        svg.line(from, to, &format!("stroke=\"{}\" stroke-width=\"3\" stroke-dasharray=\"5 3\"", palette::DOOR));
    }
}

/// Draws the ways of the scene graph as faint lines.
pub fn draw_graph(svg: &mut Svg, location: &Location, frame: &Frame, color: &str, width: f64) {
    for edge in &location.graph.edges {
        if let Some(points) = location.graph.edge_points(&edge.from, &edge.to) {
            let line: Vec<(f64, f64)> = points.iter().map(|p| frame.px(location, p)).collect();
            svg.polyline(&line, &format!("stroke=\"{color}\" stroke-width=\"{width}\""));
        }
    }
}

/// A scale bar of a round length at the lower left of the frame.
pub fn draw_scale(svg: &mut Svg, location: &Location, frame: &Frame, below: f64) {
    let length_m =
        [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|m| frame.len(location, *m) >= 60.0).unwrap_or(100.0);
    let (x, y) = (frame.at.0, frame.at.1 + frame.size().1 + below);
    let w = frame.len(location, length_m);
    let ink = palette::QUIET;
    svg.line((x, y), (x + w, y), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.line((x, y - 4.0), (x, y + 4.0), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.line((x + w, y - 4.0), (x + w, y + 4.0), &format!("stroke=\"{ink}\" stroke-width=\"2\""));
    svg.text((x + w + 8.0, y + 4.0), &format!("{length_m:.0} m"), &format!("font-size=\"12\" fill=\"{ink}\""));
}

/// Path data of all cells of one kind: row runs, joined downward where they repeat.
fn merged(location: &Location, frame: &Frame, wanted: Cell) -> String {
    let grid = &location.grid;
    let (x0, y0, w, h) = frame.cells;
    let mut open: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut path = String::new();
    for row in y0..=y0 + h {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        if row < y0 + h {
            let mut start = None;
            for column in x0..=x0 + w {
                let here = column < x0 + w && grid.at(column, row) == wanted;
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
                rectangle(&mut path, frame, run, top, row);
            }
        }
        for run in runs {
            open.entry(run).or_insert(row);
        }
    }
    path
}

#[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
fn rectangle(path: &mut String, frame: &Frame, run: (usize, usize), top: usize, bottom: usize) {
    let x = frame.at.0 + (run.0 - frame.cells.0) as f64 * frame.scale;
    let y = frame.at.1 + (top - frame.cells.1) as f64 * frame.scale;
    let (w, h) = ((run.1 - run.0) as f64 * frame.scale, (bottom - top) as f64 * frame.scale);
    // Writing into a String cannot fail.
    if write!(path, "M{x:.1} {y:.1}h{w:.1}v{h:.1}h-{w:.1}z").is_err() {
        path.clear();
    }
}
