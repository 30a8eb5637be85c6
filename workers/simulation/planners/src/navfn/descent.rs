//! The path down the gradient of the potentials, from the goal to the robot.

use super::wave::{NEUTRAL, UNREACHED, Wave};

/// Length of a step, cells.
const STEP: f32 = 0.5;
/// Slope of a cell that was not reached, away from the neighbors that were not.
const STEEP: f32 = 254.0;

/// Descends from a cell. `cells` gets the places passed, in cells, the robot's last. False where no way leads down.
pub(super) fn descend(wave: &Wave, from: (usize, usize), most_steps: usize, cells: &mut Vec<(f64, f64)>) -> bool {
    let (width, height) = (wave.width, wave.height);
    cells.clear();
    let mut place = from.1 * width + from.0;
    let (mut dx, mut dy) = (0.0_f32, 0.0_f32);
    for _ in 0..most_steps {
        let nearest = offset(place, dx.round() as isize, dy.round() as isize, width);
        let Some(nearest) = nearest.filter(|nearest| *nearest < width * height) else { return false };
        if wave.at(nearest) < NEUTRAL {
            cells.push(((nearest % width) as f64, (nearest / width) as f64));
            return true;
        }
        // All cells round this one must be on the map.
        if place < width + 1 || place + width + 1 >= width * height {
            return false;
        }
        cells.push(((place % width) as f64 + f64::from(dx), (place / width) as f64 + f64::from(dy)));
        let around = [
            place - width - 1,
            place - width,
            place - width + 1,
            place - 1,
            place,
            place + 1,
            place + width - 1,
            place + width,
            place + width + 1,
        ];
        let unreached = around.iter().any(|near| wave.at(*near) >= UNREACHED);
        if unreached || swings(cells) {
            let lowest = around.iter().copied().min_by_key(|near| wave.at(*near) as i64).unwrap_or(place);
            // The cell itself wins where no neighbor is lower.
            let lowest = if (wave.at(lowest) as i64) < wave.at(place) as i64 { lowest } else { place };
            if wave.at(lowest) >= UNREACHED {
                return false;
            }
            (place, dx, dy) = (lowest, 0.0, 0.0);
            continue;
        }
        let corner = |near: usize| gradient(wave, near, width, height);
        let (low, low_right) = (corner(place), corner(place + 1));
        let (high, high_right) = (corner(place + width), corner(place + width + 1));
        let blend = |low: f32, low_right: f32, high: f32, high_right: f32| {
            let below = (1.0 - dx) * low + dx * low_right;
            let above = (1.0 - dx) * high + dx * high_right;
            (1.0 - dy) * below + dy * above
        };
        let x = blend(low.0, low_right.0, high.0, high_right.0);
        let y = blend(low.1, low_right.1, high.1, high_right.1);
        let steep = (x * x + y * y).sqrt();
        if steep <= 0.0 {
            return false;
        }
        dx += x * STEP / steep;
        dy += y * STEP / steep;
        let carry = |rest: &mut f32| {
            let whole = if *rest > 1.0 {
                1
            } else if *rest < -1.0 {
                -1
            } else {
                0
            };
            *rest -= whole as f32;
            whole
        };
        let (columns, rows) = (carry(&mut dx), carry(&mut dy));
        let Some(moved) = offset(place, columns, rows, width) else { return false };
        place = moved;
    }
    false
}

fn offset(place: usize, columns: isize, rows: isize, width: usize) -> Option<usize> {
    place.checked_add_signed(columns)?.checked_add_signed(rows.checked_mul(isize::try_from(width).ok()?)?)
}

/// Whether the last place is the one before the last but one.
fn swings(cells: &[(f64, f64)]) -> bool {
    let [.., first, _, last] = cells else { return false };
    first == last
}

/// Where the potential of a cell falls, a unit vector; (0, 0) on the border and where nothing near was reached.
fn gradient(wave: &Wave, place: usize, width: usize, height: usize) -> (f32, f32) {
    if place < width || place + width >= width * height {
        return (0.0, 0.0);
    }
    let here = wave.at(place);
    let slope = |back: f32, on: f32| {
        if here >= UNREACHED {
            if back < UNREACHED {
                -STEEP
            } else if on < UNREACHED {
                STEEP
            } else {
                0.0
            }
        } else {
            let behind = if back < UNREACHED { back - here } else { 0.0 };
            let ahead = if on < UNREACHED { here - on } else { 0.0 };
            behind + ahead
        }
    };
    let x = slope(wave.at(place - 1), wave.at(place + 1));
    let y = slope(wave.at(place - width), wave.at(place + width));
    let norm = (x * x + y * y).sqrt();
    if norm > 0.0 { (x / norm, y / norm) } else { (0.0, 0.0) }
}
