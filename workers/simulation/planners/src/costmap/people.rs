//! People as obstacles, and what the layers about people share.

use socrates_model::{Point, SeenPerson, Vector};

use super::grid::{Bounds, Costmap, LETHAL, MOST, UNKNOWN};
use super::layered::{Layer, Sensed};

/// People seen of late: whoever is no longer seen is kept for a while.
#[derive(Debug)]
pub(super) struct Kept {
    keep_s: f64,
    people: Vec<(SeenPerson, f64)>,
    /// What the layer wrote at the last update.
    last: Bounds,
}

impl Kept {
    pub(super) fn new(keep_s: f64) -> Self {
        Self { keep_s, people: Vec::new(), last: Bounds::EMPTY }
    }

    /// Takes in who is seen.
    pub(super) fn see(&mut self, sensed: &Sensed<'_>) {
        let keep_s = self.keep_s;
        let seen = |person: &SeenPerson| sensed.people.iter().any(|seen| seen.id == person.id);
        self.people.retain(|(person, at_s)| !seen(person) && sensed.now_s - at_s <= keep_s);
        self.people.extend(sensed.people.iter().map(|person| (*person, sensed.now_s)));
    }

    pub(super) fn people(&self) -> impl Iterator<Item = &SeenPerson> {
        self.people.iter().map(|(person, _)| person)
    }

    /// Widens `bounds` by what the layer writes now and by what it wrote before.
    pub(super) fn widen(&mut self, now: Bounds, bounds: &mut Bounds) {
        bounds.join(&self.last);
        bounds.join(&now);
        self.last = now;
    }

    /// The window moved: everything is written anew anyway.
    pub(super) fn roll(&mut self) {
        self.last = Bounds::EMPTY;
    }

    pub(super) fn clear(&mut self) {
        self.people.clear();
        self.last = Bounds::EMPTY;
    }
}

/// Raises cells of a box to a cost that hangs on the offset of the cell's center from a point, m. Unknown cells stay so.
pub(super) fn raise(map: &mut Costmap, here: &Bounds, center: &Point, cost: impl Fn(&Vector) -> Option<u8>) {
    if here.is_empty() {
        return;
    }
    let corner = map.center(here.left, here.bottom) - center;
    let cell_m = map.resolution_m();
    for (up, row) in map.rows_mut(here).enumerate() {
        for (along, cell) in row.iter_mut().enumerate() {
            let offset = corner + Vector::new(along as f64 * cell_m, up as f64 * cell_m);
            if let Some(cost) = cost(&offset)
                && *cell != UNKNOWN
            {
                *cell = (*cell).max(cost);
            }
        }
    }
}

/// The cost of a real number: cut to a whole one. At most 252, so that a person's middle is neither an obstacle nor unknown.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
pub(super) fn cost_of(value: f64) -> u8 {
    value.clamp(0.0, f64::from(MOST)) as u8
}

/// Parameters of [`OraclePeople`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OraclePeopleParams {
    /// Room round a body that counts as the body, m; default 0.
    pub padding: f64,
}

/// People in sight as discs, without the lidar: an obstacle where their body is, and none where they were.
#[derive(Debug)]
pub struct OraclePeople {
    params: OraclePeopleParams,
    kept: Kept,
}

impl OraclePeople {
    /// The layer.
    #[must_use]
    pub fn new(params: &OraclePeopleParams) -> Self {
        Self { params: *params, kept: Kept::new(0.0) }
    }
}

impl Layer for OraclePeople {
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        self.kept.see(sensed);
        let mut now = Bounds::EMPTY;
        for person in self.kept.people() {
            now.join(&map.square(&person.at, person.radius_m + self.params.padding));
        }
        self.kept.widen(now, bounds);
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        for person in self.kept.people() {
            let radius_m = person.radius_m + self.params.padding;
            // The cell that the center is in is part of even the smallest body.
            let least_m = map.resolution_m() / std::f64::consts::SQRT_2;
            let reach_m = radius_m.max(least_m);
            let here = map.square(&person.at, reach_m).meet(bounds);
            raise(map, &here, &person.at, |offset| (offset.norm() <= reach_m).then_some(LETHAL));
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {
        self.kept.roll();
    }

    fn clear(&mut self) {
        self.kept.clear();
    }
}
