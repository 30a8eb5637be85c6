//! A large crowd, stepped.

use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};

use super::elementary::{atan2, exp};
use super::settings::{BadSettings, BadStep, Settings};
use super::social::Social;
use super::walls::WallIndex;
use crate::forces::{Forces, desired, groups};
use crate::group;
use crate::math::Portable;
use crate::obstacle::Segment;
use crate::params::Params;
use crate::person::Person;
use crate::vector::{known, norm, unit};
use crate::walker::{Drive, Route, Walker};

/// A crowd that is stepped fast: same law as [`crate::strict`], social forces within an error bound,
/// portable functions, no memory taken by a step unless the crowd gets wider or denser than before.
#[derive(Debug, Clone)]
pub struct Crowd {
    people: Vec<Person>,
    routes: Vec<Route>,
    drives: Vec<Option<Drive>>,
    groups: BTreeMap<u32, Vec<usize>>,
    walls: WallIndex,
    params: Params,
    social: Social,
    forces: Vec<Forces>,
}

impl Crowd {
    /// A crowd among walls.
    ///
    /// # Errors
    /// [`BadSettings`] if a setting cannot be meant.
    pub fn new(walkers: &[Walker], walls: &[Segment], settings: &Settings) -> Result<Self, BadSettings> {
        settings.check()?;
        let people: Vec<Person> =
            walkers.iter().map(|walker| Person { goal: walker.route.goal(), ..walker.person.clone() }).collect();
        Ok(Self {
            groups: groups(&people),
            routes: walkers.iter().map(|walker| walker.route.clone()).collect(),
            drives: walkers.iter().map(|walker| walker.drive).collect(),
            walls: WallIndex::new(walls, settings.wall_range_m),
            params: settings.params.clone(),
            social: Social::new(&settings.params, settings.error_mps2)?.with_instructions(settings.instructions),
            forces: vec![Forces::default(); people.len()],
            people,
        })
    }

    /// Everybody, in the order given.
    #[must_use]
    pub fn people(&self) -> &[Person] {
        &self.people
    }

    /// How many goals each has reached, in the order given.
    pub fn reached(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.routes.iter().map(Route::reached)
    }

    /// The forces on everybody in the present state, in the order given.
    ///
    /// A part that is not a number counts as 0, as in [`crate::forces()`].
    pub fn forces(&mut self) -> &[Forces] {
        let social = self.social.forces(&self.people);
        for (index, ((person, social), forces)) in self.people.iter().zip(social).zip(&mut self.forces).enumerate() {
            let (wanted, wish) = desired(person, &self.params);
            let members = person.group.and_then(|group| self.groups.get(&group)).map_or(&[][..], Vec::as_slice);
            let group = group::on::<Portable>(person, index, members, &self.people, &wish, &self.params);
            *forces = Forces {
                desired: known(wanted),
                obstacle: known(walls_on(person, self.walls.points(person.position), &self.params)),
                social: known(*social),
                gaze: group.gaze,
                coherence: group.coherence,
                repulsion: group.repulsion,
            };
        }
        &self.forces
    }

    /// Moves everybody by `dt` seconds under the forces of the present state. With a `dt` of 0 nothing
    /// changes.
    ///
    /// # Errors
    /// [`BadStep`] if `dt` is negative or not finite; nothing changes then.
    pub fn step(&mut self, dt: f64) -> Result<(), BadStep> {
        if !(dt.is_finite() && dt >= 0.0) {
            return Err(BadStep { dt });
        }
        if dt > 0.0 {
            self.forces();
            let bodies = self.people.iter_mut().zip(&mut self.routes);
            for ((person, route), (drive, forces)) in bodies.zip(self.drives.iter().zip(&self.forces)) {
                match drive {
                    Some(drive) => drive.advance::<Portable>(person, dt),
                    None => advance(person, &known(forces.total()), dt),
                }
                route.follow(person);
            }
        }
        Ok(())
    }
}

/// The obstacle force of [`crate::forces()`], with the exponential of this module.
fn walls_on(person: &Person, points: impl Iterator<Item = Point2<f64>>, params: &Params) -> Vector2<f64> {
    points.fold(Vector2::zeros(), |sum, point| {
        let away = person.position - point;
        let distance = norm(&away) - person.radius_m;
        sum + unit(&away) * (params.obstacle * exp((-distance / params.obstacle_sigma_m).min(MOST)))
    })
}

/// The exponential is asked for no more than this: e^700 is beyond all force.
const MOST: f64 = 700.0;

/// [`crate::integrate()`] with the arc tangent of this module.
fn advance(person: &mut Person, force: &Vector2<f64>, dt: f64) {
    person.velocity += force * dt;
    let speed = norm(&person.velocity);
    if speed > person.speed_mps {
        person.velocity = Vector2::new(person.velocity.x / speed, person.velocity.y / speed) * person.speed_mps;
    }
    if speed > 0.0 && person.speed_mps > 0.0 {
        person.yaw = atan2(person.velocity.y, person.velocity.x);
    }
    person.position += person.velocity * dt;
}
