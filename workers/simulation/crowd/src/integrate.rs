//! One step of a person under a force.

use nalgebra::Vector2;

use crate::math::{Math as _, Portable};
use crate::person::Person;
use crate::vector::norm;

/// Moves a person by `dt` seconds under `force` (semi-implicit Euler): velocity first, cut to the
/// desired speed, then heading along the velocity, then position.
///
/// Somebody at rest keeps the heading: the direction of a zero velocity says nothing.
pub fn integrate(person: &mut Person, force: &Vector2<f64>, dt: f64) {
    person.velocity += force * dt;
    let speed = norm(&person.velocity);
    if speed > person.speed_mps {
        let unit = Vector2::new(person.velocity.x / speed, person.velocity.y / speed);
        person.velocity = unit * person.speed_mps;
    }
    if person.velocity.x != 0.0 || person.velocity.y != 0.0 {
        person.yaw = Portable::angle(&person.velocity);
    }
    person.position += person.velocity * dt;
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn nobody_gets_faster_than_the_desired_speed() {
        let mut person = Person::standing(1, Point2::origin());
        for _ in 0..100 {
            integrate(&mut person, &Vector2::new(50.0, 30.0), 0.01);
        }
        assert!((norm(&person.velocity) - 1.2).abs() < 1e-12);
    }

    #[test]
    fn standing_still_keeps_the_heading() {
        let mut person = Person { yaw: 2.0, ..Person::standing(1, Point2::origin()) };
        integrate(&mut person, &Vector2::zeros(), 0.01);
        assert!((person.yaw - 2.0).abs() < 1e-15);
    }
}
