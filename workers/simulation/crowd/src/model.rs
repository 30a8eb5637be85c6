//! Models of a walking person, behind one trait.

use nalgebra::{Point2, Vector2};

use crate::forces::forces_on;
use crate::integrate::integrate;
use crate::obstacle::{Segment, points_in_range};
use crate::params::{BadParams, Params};
use crate::person::Person;

/// What one person goes by: the state at the start of a step.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The person itself; for somebody who is not there yet, as it will be apart from its state.
    pub me: &'a Person,
    /// Where the person stands in `people`; `None` while it is not there.
    pub place: Option<usize>,
    /// Everybody who is there, the person included.
    pub people: &'a [Person],
    /// Walls; both ends of a segment equal for a point.
    pub walls: &'a [Segment],
    /// Time at the start of the step, s.
    pub now_s: f64,
    /// Length of the step, s, above 0.
    pub dt_s: f64,
}

impl<'a> View<'a> {
    /// Everybody who is there but the person itself, each with its place.
    pub fn others(&self) -> impl Iterator<Item = (usize, &'a Person)> + use<'a> {
        let place = self.place;
        self.people.iter().enumerate().filter(move |(other, _)| Some(*other) != place)
    }
}

/// A model of how one person walks.
///
/// A model keeps no state of its own: the same view gives the same answer, so people of different
/// models can be mixed and moved in any order.
pub trait CrowdModel {
    /// The word for the model in settings and reports.
    fn name(&self) -> &'static str;

    /// The person after the step; `None` if it is not there then.
    ///
    /// The goal is handed through: taking the next one is for the caller.
    fn next(&self, view: &View<'_>) -> Option<Person>;
}

/// Social forces, by the portable functions.
///
/// For many people at once, [`crate::fast::Crowd`] does the same work faster.
#[derive(Debug, Clone)]
pub struct SocialForces {
    params: Params,
    wall_range_m: f64,
}

impl SocialForces {
    /// People who feel walls within `wall_range_m` (3 m in the reference).
    ///
    /// # Errors
    /// [`BadParams`] if a constant cannot be meant.
    pub fn new(params: Params, wall_range_m: f64) -> Result<Self, BadParams> {
        params.check()?;
        if !(wall_range_m.is_finite() && wall_range_m >= 0.0) {
            let allowed = "a finite number of at least 0";
            return Err(BadParams { name: "wall_range_m", value: wall_range_m, allowed });
        }
        Ok(Self { params, wall_range_m })
    }
}

impl CrowdModel for SocialForces {
    fn name(&self) -> &'static str {
        "social-forces"
    }

    fn next(&self, view: &View<'_>) -> Option<Person> {
        let mut next = view.me.clone();
        if let Some(place) = view.place {
            let walls: Vec<Point2<f64>> = points_in_range(&view.me.position, view.walls, self.wall_range_m);
            let force: Vector2<f64> = forces_on(place, view.people, &walls, &self.params).total();
            integrate(&mut next, &force, view.dt_s);
        }
        Some(next)
    }
}
