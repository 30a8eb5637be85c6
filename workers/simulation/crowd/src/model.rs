//! Models of a walking person, behind one trait.

use nalgebra::{Point2, Vector2};

use crate::fast::WallIndex;
use crate::forces::forces_on;
use crate::integrate::integrate;
use crate::near::{Found, Near};
use crate::obstacle::Segment;
use crate::orca::HalfPlane;
use crate::params::{BadParams, Params};
use crate::person::Person;
use crate::vector::norm;

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
    /// The same people and walls, sorted; without it models look at everybody and every wall.
    pub index: Option<&'a Index>,
}

/// People and walls of one moment, sorted by place. The answers of a model are the same with it and without it.
#[derive(Debug, Clone)]
pub struct Index {
    /// Everybody who is there.
    pub near: Near,
    /// All walls.
    pub walls: WallIndex,
}

/// Lists that models fill anew for every person.
#[derive(Debug, Clone, Default)]
pub struct Room {
    pub(crate) found: Vec<Found>,
    pub(crate) planes: Vec<HalfPlane>,
    pub(crate) projected: Vec<HalfPlane>,
    pub(crate) points: Vec<Point2<f64>>,
}

impl<'a> View<'a> {
    /// Everybody who is there but the person itself, each with its place.
    pub fn others(&self) -> impl Iterator<Item = (usize, &'a Person)> + use<'a> {
        let place = self.place;
        self.people.iter().enumerate().filter(move |(other, _)| Some(*other) != place)
    }

    /// Every wall within `range_m` of a place, in the order of walls; some more may be among them.
    pub fn walls_around(&self, at: &Point2<f64>, range_m: f64) -> impl Iterator<Item = &'a Segment> + use<'a> {
        let index = self.index.filter(|index| range_m < index.walls.range_m() * (1.0 - 1e-9));
        let all = if index.is_some() { &[][..] } else { self.walls };
        index.map(|index| index.walls.around(at)).into_iter().flatten().chain(all)
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
    /// The goal is handed through: taking the next one is for the caller. What `room` holds means nothing.
    fn next(&self, view: &View<'_>, room: &mut Room) -> Option<Person>;
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

    fn next(&self, view: &View<'_>, room: &mut Room) -> Option<Person> {
        let mut next = view.me.clone();
        if let Some(place) = view.place {
            let (at, range_m) = (view.me.position, self.wall_range_m);
            room.points.clear();
            let points = view.walls_around(&at, range_m).map(|wall| wall.closest(&at));
            room.points.extend(points.filter(|point| norm(&(at - point)) <= range_m));
            let force: Vector2<f64> = forces_on(place, view.people, &room.points, &self.params).total();
            integrate(&mut next, &force, view.dt_s);
        }
        Some(next)
    }
}
