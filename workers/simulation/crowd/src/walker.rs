//! A person together with the places it goes to.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::math::Math;
use crate::person::{Goal, Person};
use crate::vector::{norm, wrap};

/// The goals of somebody, taken one after the other.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Route {
    goals: Vec<Goal>,
    cyclic: bool,
    reached: u64,
}

impl Route {
    /// Goals in the order in which they are visited; with `cyclic` the first follows the last, without
    /// end.
    #[must_use]
    pub fn new(goals: Vec<Goal>, cyclic: bool) -> Self {
        Self { goals, cyclic, reached: 0 }
    }

    /// The goal of now; `None` when all are reached.
    #[must_use]
    pub fn goal(&self) -> Option<Goal> {
        let count = u64::try_from(self.goals.len()).unwrap_or(u64::MAX);
        let place = if self.cyclic { self.reached.checked_rem(count)? } else { self.reached };
        usize::try_from(place).ok().and_then(|place| self.goals.get(place)).copied()
    }

    /// How many goals have been reached so far; a goal counts again on each round.
    #[must_use]
    pub fn reached(&self) -> u64 {
        self.reached
    }

    /// Takes the next goal if `person` stands within the radius of the present one (one goal at a
    /// time), and hands the person its goal of now.
    pub fn follow(&mut self, person: &mut Person) {
        let goal = self.goal();
        if let Some(goal) = goal
            && norm(&(goal.at - person.position)) <= goal.radius_m
        {
            self.reached += 1;
            person.goal = self.goal();
        } else {
            person.goal = goal;
        }
    }
}

/// Speeds of somebody who is driven from outside: a robot under remote control.
///
/// Others feel it; no force moves it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Forward speed, m/s.
    pub linear_mps: f64,
    /// Turn rate, rad/s; positive to the left.
    pub angular_radps: f64,
}

impl Drive {
    /// Moves `person` as a unicycle by one midpoint step of `dt` seconds.
    pub(crate) fn advance<M: Math>(&self, person: &mut Person, dt: f64) {
        let way = self.linear_mps * dt;
        let (sin, cos) = M::sin_cos(person.yaw + self.angular_radps * dt * 0.5);
        person.position += Vector2::new(way * cos, way * sin);
        person.yaw = wrap(person.yaw + self.angular_radps * dt);
        let (sin, cos) = M::sin_cos(person.yaw);
        person.velocity = Vector2::new(self.linear_mps * cos, self.linear_mps * sin);
    }
}

/// Somebody with a route, who walks or is driven.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Walker {
    /// State. Its own `goal` is replaced by that of the route.
    pub person: Person,
    /// Where it goes.
    pub route: Route,
    /// Set for somebody under remote control.
    pub drive: Option<Drive>,
}

impl Walker {
    /// Somebody who walks along `route`.
    #[must_use]
    pub fn walking(person: Person, route: Route) -> Self {
        Self { person, route, drive: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Portable;
    use nalgebra::Point2;

    fn goal(x: f64) -> Goal {
        Goal { at: Point2::new(x, 0.0), radius_m: 0.5 }
    }

    #[test]
    fn one_goal_is_taken_at_a_time_and_a_round_starts_anew() {
        let mut person = Person::standing(1, Point2::origin());
        let mut route = Route::new(vec![goal(0.0), goal(0.2), goal(5.0)], true);
        route.follow(&mut person);
        assert_eq!((route.reached(), person.goal), (1, Some(goal(0.2))));
        route.follow(&mut person);
        assert_eq!((route.reached(), person.goal), (2, Some(goal(5.0))));
        person.position.x = 5.0;
        route.follow(&mut person);
        assert_eq!((route.reached(), person.goal), (3, Some(goal(0.0))));
    }

    #[test]
    fn a_route_without_goals_has_no_goal() {
        assert_eq!(Route::new(Vec::new(), true).goal(), None);
        let mut person = Person::standing(1, Point2::origin());
        let mut route = Route::new(vec![goal(0.0)], false);
        route.follow(&mut person);
        assert_eq!((route.goal(), person.goal), (None, None));
    }

    #[test]
    fn a_driven_quarter_turn_ends_beside_where_it_began() {
        let mut person = Person::standing(1, Point2::origin());
        let drive = Drive { linear_mps: 1.0, angular_radps: std::f64::consts::FRAC_PI_2 };
        for _ in 0..100 {
            drive.advance::<Portable>(&mut person, 0.01);
        }
        let radius = 2.0 / std::f64::consts::PI;
        assert!((person.position - Point2::new(radius, radius)).norm() < 1e-4);
        assert!(person.velocity.x.abs() < 1e-12 && (person.velocity.y - 1.0).abs() < 1e-12);
    }
}
