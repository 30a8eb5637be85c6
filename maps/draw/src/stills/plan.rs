//! Where the pictures of a sheet stand, and what each of them shows of the map.

use socrates_model::Point;

use super::{NEAR_M, Scene};
use crate::label::Area;

/// Width of a sheet, px: what readers of pictures take without making it smaller.
const WIDTH: f64 = 1560.0;
/// A sheet is about so high where that is enough, px.
const HEIGHT: f64 = 1560.0;
/// Edge of the sheet and gap between pictures, px.
pub(super) const MARGIN: f64 = 14.0;
/// Words under a picture, px.
const BAND: f64 = 76.0;
/// Pictures side by side at most.
const COLUMNS: usize = 4;
/// Pixels per meter: with fewer nobody's number could be read, and the pictures follow the robot instead of showing all.
const PX_PER_M: std::ops::RangeInclusive<f64> = 24.0..=70.0;
/// Room around those who are shown, m.
const ROOM_M: f64 = 1.6;
/// Height of a picture that follows the robot, in widths.
const FOLLOWS_HIGH: f64 = 0.66;
/// Least and greatest height of a picture, in widths.
const HIGH: (f64, f64) = (0.25, 1.2);
/// Seconds between two looks at where everybody is.
const LOOK_SECS: f64 = 0.2;

/// One picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// Its place on the sheet; words stand below it.
    pub(super) area: Area,
    /// What stands in its middle.
    pub(super) center: Point,
    /// Its scale.
    pub(super) px_per_m: f64,
}

/// Everything about a sheet's places.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    /// The picture of all ways, then the stills.
    pub(super) cells: Vec<Cell>,
}

/// A part of the world: its middle and its size, m.
#[derive(Debug, Clone, Copy)]
struct Part {
    center: Point,
    size_m: (f64, f64),
}

impl Part {
    /// The part that holds these points, with room around them; nothing where there is none.
    fn around(points: impl Iterator<Item = Point>) -> Option<Self> {
        let mut ends: Option<(f64, f64, f64, f64)> = None;
        for (x, y) in points.map(|point| (point.x, point.y)) {
            let (left, low, right, high) = ends.unwrap_or((x, y, x, y));
            ends = Some((left.min(x), low.min(y), right.max(x), high.max(y)));
        }
        ends.map(|(left, low, right, high)| Self {
            center: Point::new(f64::midpoint(left, right), f64::midpoint(low, high)),
            size_m: (right - left + 2.0 * ROOM_M, high - low + 2.0 * ROOM_M),
        })
    }

    fn fits(&self, (w, h): (f64, f64)) -> f64 {
        (w / self.size_m.0).min(h / self.size_m.1)
    }
}

/// Robot and people near it at a moment; without a robot everybody.
fn concerned(scene: &Scene<'_>, now_s: f64, near_m: f64) -> Vec<Point> {
    let robot = scene.states(now_s).find(|state| state.agent == 0).copied();
    let counts = |x: f64, y: f64| robot.is_none_or(|robot| (x - robot.x).hypot(y - robot.y) <= near_m);
    scene.states(now_s).filter(|state| counts(state.x, state.y)).map(socrates_model::AgentState::point).collect()
}

/// Width of a picture in so many columns, and the height that it may have below a head, px.
fn cell_size(columns: usize, count: usize, top: f64) -> (f64, f64) {
    let rows = count.div_ceil(columns);
    #[expect(clippy::cast_precision_loss, reason = "a few columns and rows")]
    let (columns, rows) = (columns as f64, rows as f64);
    let w = (WIDTH - MARGIN * (columns + 1.0)) / columns;
    (w, ((HEIGHT - top) / rows - BAND).min(w * HIGH.1))
}

/// Columns, scale and size of the pictures that show a part of the world largest; nothing where too many would make them flat.
fn largest(part: &Part, count: usize, top: f64) -> Option<(usize, f64, (f64, f64))> {
    let mut best: Option<(usize, f64, (f64, f64))> = None;
    for columns in 1..=COLUMNS {
        let (w, most_h) = cell_size(columns, count, top);
        if most_h < w * HIGH.0 {
            continue;
        }
        let px_per_m = part.fits((w, most_h)).min(*PX_PER_M.end());
        if best.is_none_or(|(_, most, _)| px_per_m > most) {
            best = Some((columns, px_per_m, (w, (part.size_m.1 * px_per_m).clamp(w * HIGH.0, most_h))));
        }
    }
    best
}

impl Plan {
    pub(super) fn of(scene: &Scene<'_>, times: &[f64], top: f64) -> Self {
        let nobody = Part { center: Point::new(0.0, 0.0), size_m: (10.0, 10.0) };
        let (from_s, to_s) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let shown = |from: f64, to: f64, near_m: f64| {
            Part::around(Scene::looks(from, to, LOOK_SECS).flat_map(|now| concerned(scene, now, near_m)))
        };
        let near = shown(from_s, to_s, NEAR_M).unwrap_or(nobody);
        let whole = shown(0.0, scene.end_s(), f64::INFINITY).unwrap_or(near);
        let count = times.len() + 1;
        // Where all of it would be too small to read, or there are too many pictures, each follows the robot.
        let all = largest(&near, count, top).filter(|(_, px_per_m, _)| px_per_m >= PX_PER_M.start());
        let (columns, px_per_m, (w, h)) = all.unwrap_or_else(|| {
            let columns = if count > 12 { COLUMNS } else { 3 };
            let (w, _) = cell_size(columns, count, top);
            (columns, *PX_PER_M.start(), (w, w * FOLLOWS_HIGH))
        });
        let place = |index: usize| {
            #[expect(clippy::cast_precision_loss, reason = "a few columns and rows")]
            let (column, row) = ((index % columns) as f64, (index / columns) as f64);
            Area { x: MARGIN + column * (w + MARGIN), y: top + row * (h + BAND), w, h }
        };
        let mut cells = vec![Cell { area: place(0), center: whole.center, px_per_m: whole.fits((w, h)).min(px_per_m) }];
        for (index, now) in times.iter().enumerate() {
            let here = if all.is_none() {
                Part::around(concerned(scene, *now, NEAR_M).into_iter()).unwrap_or(near)
            } else {
                near
            };
            cells.push(Cell { area: place(index + 1), center: here.center, px_per_m });
        }
        Self { cells }
    }

    /// Width and height of the sheet, px.
    pub(super) fn size(&self) -> (f64, f64) {
        let low = self.cells.iter().map(|cell| cell.area.y + cell.area.h).fold(0.0, f64::max);
        (WIDTH, (low + BAND).ceil())
    }
}
