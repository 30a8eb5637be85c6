//! Which edges the robot gets through: wide enough for its disc, and behind no door that never opens.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use socrates_maps::{Ground, Kept, shortest_path};
use socrates_model::{DoorOpens, GraphEdge, Location, NodeId, Point};

/// Distance between two looks at the floor along an edge, m.
const STEP_M: f64 = 0.1;
/// An edge that cuts a corner is driven round it: the way round is at most so many times as long, and so much longer, m.
const ROUND: f64 = 1.5;
const ROUND_M: f64 = 1.0;

/// Why an edge is closed to the robot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Closed {
    pub(crate) between: [NodeId; 2],
    pub(crate) why: Why,
}

/// What closes an edge.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Why {
    /// The floor is so wide at a point, m.
    Narrow(Point, f64),
    /// A door of this name never opens.
    Shut(String),
}

/// Lengths that differ by less are the same, m.
const ROUNDED_M: f64 = 1e-6;

/// Something that is worked out of a map once, by two points and the radius as bits.
type Once<T> = Mutex<BTreeMap<[u64; 5], T>>;

/// What is worked out of a map.
#[derive(Debug, Default)]
struct Known {
    /// The narrowest point of an edge that is closed, and the free width there, m.
    narrow: Once<Option<(Point, f64)>>,
    /// The shortest way between the points, m.
    floor_m: Once<Option<f64>>,
}

fn key(from: &Point, to: &Point, radius_m: f64) -> [u64; 5] {
    [from.x, from.y, to.x, to.y, radius_m].map(f64::to_bits)
}

fn length_m(points: &[Point]) -> f64 {
    points.windows(2).map(|leg| if let [a, b] = leg { (b - a).norm() } else { 0.0 }).sum()
}

/// Length of the way of a disc between two points on the floor, m: hardly more than the shortest, with room to the walls where
/// there is room. `None` where there is none.
pub(crate) fn floor_m(location: &Location, from: &Point, to: &Point, radius_m: f64) -> Option<f64> {
    let ground = Ground::of(&location.grid);
    let known = KNOWN.of(&location.grid, |_| Known::default());
    let lock = || known.floor_m.lock().unwrap_or_else(PoisonError::into_inner);
    let key = key(from, to, radius_m);
    if let Some(answer) = lock().get(&key) {
        return *answer;
    }
    let answer = shortest_path(ground.grid(), ground.field(), from, to, radius_m).map(|way| length_m(&way));
    lock().insert(key, answer);
    answer
}

static KNOWN: Kept<Known> = Kept::new();

/// The edges of a map that a robot of this radius does not get through.
pub(crate) fn closed(location: &Location, radius_m: f64) -> Vec<Closed> {
    let ground = Ground::of(&location.grid);
    let known = KNOWN.of(&location.grid, |_| Known::default());
    let mut found = Vec::new();
    for edge in location.graph.edges() {
        let between = [edge.from.clone(), edge.to.clone()];
        if let Some(door) = shut(location, edge) {
            found.push(Closed { between, why: Why::Shut(door) });
        } else if let Some((at, width_m)) = narrow(location, &ground, &known, edge, radius_m) {
            found.push(Closed { between, why: Why::Narrow(at, width_m) });
        }
    }
    found
}

/// The door across an edge that never opens.
fn shut(location: &Location, edge: &GraphEdge) -> Option<String> {
    let never = location.doors.iter().filter(|door| door.opens == DoorOpens::Never);
    let points = location.graph.edge_points(&edge.from, &edge.to)?;
    let crosses =
        |from: &Point, to: &Point| points.windows(2).any(|leg| matches!(leg, [a, b] if cross((a, b), (from, to))));
    never.into_iter().find(|door| crosses(&door.from, &door.to)).map(|door| door.id.clone())
}

/// Whether two segments cross.
fn cross((a, b): (&Point, &Point), (c, d): (&Point, &Point)) -> bool {
    let side = |p: &Point, q: &Point, r: &Point| (q - p).perp(&(r - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// The narrowest point of an edge and its width there, where the robot fits neither through it nor round it.
fn narrow(
    location: &Location,
    ground: &Ground,
    known: &Known,
    edge: &GraphEdge,
    radius_m: f64,
) -> Option<(Point, f64)> {
    let points = location.graph.edge_points(&edge.from, &edge.to)?;
    let (first, last) = (points.first()?, points.last()?);
    let key = key(first, last, radius_m);
    let lock = || known.narrow.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(answer) = lock().get(&key) {
        return *answer;
    }
    let field = ground.field();
    let grid = ground.grid();
    let mut least: Option<(Point, f64)> = None;
    for leg in points.windows(2) {
        let [a, b] = leg else { continue };
        let steps = (libm::ceil((b - a).norm() / STEP_M)).max(1.0) as u32;
        for step in 0..=steps {
            let at = a + (b - a) * (f64::from(step) / f64::from(steps));
            let clear_m = field.clearance(&at);
            if least.is_none_or(|(_, known)| clear_m < known) {
                least = Some((at, clear_m));
            }
        }
    }
    // Where the line runs beside the middle of the floor the way round it tells: what is narrower than the robot stops it.
    let fits = |clear_m: f64| clear_m >= radius_m - ROUNDED_M;
    let answer = least.filter(|(_, clear_m)| !fits(*clear_m)).filter(|_| {
        let round = shortest_path(grid, field, first, last, radius_m);
        round.is_none_or(|way| length_m(&way) > ROUND * length_m(&points) + ROUND_M)
    });
    let answer = answer.map(|(at, clear_m)| (at, 2.0 * clear_m));
    lock().insert(key, answer);
    answer
}
