//! The reference library, bit for bit.
//!
//! Same equations as [`crate::forces()`], in the same order of operations, but with the transcendental
//! functions of the platform and with the reference's own rules at the edges (the heading of somebody
//! at rest is 0, angles lie in (-pi, pi]). On a machine whose C library the reference was built with,
//! positions, velocities, headings and every force equal the recorded ones in every bit, however long
//! the run. Elsewhere compare one step at a time, with a tolerance of 1e-12.
//!
//! Sums run over all pairs: the cost of a step grows with the square of the crowd. [`crate::fast`] is
//! the way to large crowds.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

use crate::forces::{Forces, forces_by};
use crate::math::{Math as _, Platform};
use crate::obstacle::{Segment, points_in_range};
use crate::params::Params;
use crate::person::Person;
use crate::vector::norm;
use crate::walker::{Drive, Route, Walker};

/// Which of the two models of the reference library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// The one-agent call, as HuNavSim uses it: no angle bias, social factor 5, every group number but
    /// -1 is a group, the center of a group is summed from the agent itself on.
    Hunav,
    /// The whole-crowd call: angle bias 0.005, social factor 2.1, group numbers from 0 on are groups,
    /// centers are summed in list order; agents under remote control are moved.
    Batch,
}

impl Model {
    /// Both, in the order of their names in files.
    pub const ALL: [Self; 2] = [Self::Hunav, Self::Batch];

    /// The name in scene files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hunav => "hunav",
            Self::Batch => "batch",
        }
    }

    /// The constants that the reference uses in this model.
    #[must_use]
    pub fn params(self) -> Params {
        match self {
            Self::Hunav => Params::lightsfm_hunav(),
            Self::Batch => Params::lightsfm_batch(),
        }
    }

    /// Whether agents with this group number form a group.
    #[must_use]
    pub const fn is_group(self, number: i64) -> bool {
        match self {
            Self::Hunav => number != -1,
            Self::Batch => number >= 0,
        }
    }
}

/// A crowd that is stepped as the reference steps it.
#[derive(Debug, Clone)]
pub struct Crowd {
    people: Vec<Person>,
    routes: Vec<Route>,
    drives: Vec<Option<Drive>>,
    walls: Vec<Segment>,
    range_m: f64,
    params: Params,
}

impl Crowd {
    /// A crowd among walls that are felt within `range_m` (3 m in the reference).
    #[must_use]
    pub fn new(walkers: &[Walker], walls: &[Segment], range_m: f64, params: &Params) -> Self {
        Self {
            people: walkers
                .iter()
                .map(|walker| Person { goal: walker.route.goal(), ..walker.person.clone() })
                .collect(),
            routes: walkers.iter().map(|walker| walker.route.clone()).collect(),
            drives: walkers.iter().map(|walker| walker.drive).collect(),
            walls: walls.to_vec(),
            range_m,
            params: params.clone(),
        }
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

    /// The wall points that each feels: the closest point of every segment in range, in list order.
    #[must_use]
    pub fn wall_points(&self) -> Vec<Vec<Point2<f64>>> {
        self.people.iter().map(|person| points_in_range(&person.position, &self.walls, self.range_m)).collect()
    }

    /// The forces on everybody, given the wall points of [`Crowd::wall_points`].
    #[must_use]
    pub fn forces(&self, wall_points: &[Vec<Point2<f64>>]) -> Vec<Forces> {
        forces_by::<Platform>(&self.people, wall_points, &self.params)
    }

    /// Moves everybody by `dt` seconds under the forces of the present state.
    pub fn step(&mut self, dt: f64) {
        let forces = self.forces(&self.wall_points());
        self.advance(&forces, dt);
    }

    /// Moves everybody by `dt` seconds under `forces`, one for each.
    pub fn advance(&mut self, forces: &[Forces], dt: f64) {
        let bodies = self.people.iter_mut().zip(&mut self.routes);
        for ((person, route), (drive, force)) in bodies.zip(self.drives.iter().zip(forces)) {
            match drive {
                Some(drive) => drive.advance::<Platform>(person, dt),
                None => integrate(person, &force.total(), dt),
            }
            route.follow(person);
        }
    }
}

/// Velocity first, cut to the desired speed, then heading, then position.
fn integrate(person: &mut Person, force: &Vector2<f64>, dt: f64) {
    person.velocity += force * dt;
    let speed = norm(&person.velocity);
    if speed > person.speed_mps {
        let direction = Vector2::new(person.velocity.x / speed, person.velocity.y / speed);
        person.velocity = direction * person.speed_mps;
    }
    person.yaw = Platform::angle(&person.velocity);
    person.position += person.velocity * dt;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_numbers_mean_what_each_call_of_the_reference_takes_them_for() {
        assert!(!Model::Hunav.is_group(-1) && Model::Hunav.is_group(-2) && Model::Hunav.is_group(0));
        assert!(!Model::Batch.is_group(-1) && !Model::Batch.is_group(-2) && Model::Batch.is_group(0));
    }

    #[test]
    fn somebody_at_rest_looks_along_the_x_axis_as_in_the_reference() {
        let person = Person { yaw: 2.0, ..Person::standing(1, Point2::origin()) };
        let walker = Walker::walking(person, Route::default());
        let mut crowd = Crowd::new(&[walker], &[], 3.0, &Params::default());
        crowd.step(0.01);
        assert_eq!(crowd.people()[0].yaw.to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn a_driven_robot_is_moved_by_its_speeds_alone() {
        let robot = Walker {
            person: Person::standing(0, Point2::origin()),
            route: Route::default(),
            drive: Some(Drive { linear_mps: 0.5, angular_radps: 0.0 }),
        };
        let near = Walker::walking(Person::standing(1, Point2::new(0.4, 0.1)), Route::default());
        let mut crowd = Crowd::new(&[robot, near], &[], 3.0, &Params::default());
        for _ in 0..100 {
            crowd.step(0.01);
        }
        assert!((crowd.people()[0].position - Point2::new(0.5, 0.0)).norm() < 1e-12);
        assert!(crowd.people()[1].position.x > 0.4);
    }
}
