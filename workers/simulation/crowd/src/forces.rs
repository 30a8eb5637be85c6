//! The forces on people.

use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

use crate::group;
use crate::math::{Math, Portable};
use crate::params::Params;
use crate::person::Person;
use crate::vector::{known, left, norm, unit, wrap};

/// The forces on one person, m/s² (unit mass).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Forces {
    /// Towards the goal at the desired speed, or to rest.
    pub desired: Vector2<f64>,
    /// Away from obstacle points.
    pub obstacle: Vector2<f64>,
    /// Around other people, own group included.
    pub social: Vector2<f64>,
    /// Keeps the group in sight.
    pub gaze: Vector2<f64>,
    /// Keeps the group together.
    pub coherence: Vector2<f64>,
    /// Keeps touching members of the group apart.
    pub repulsion: Vector2<f64>,
}

impl Forces {
    /// Sum of all, in the order of the reference: desired, social, obstacle, group.
    #[must_use]
    pub fn total(&self) -> Vector2<f64> {
        let group = self.gaze + self.coherence + self.repulsion;
        self.desired + self.social + self.obstacle + group
    }
}

/// Forces on everybody, all from the same state; `obstacles` holds the points each person feels, by
/// its place in `people` (missing lists count as empty).
///
/// A component that is not a number (two people on one spot, no goal direction) is 0.
#[must_use]
pub fn forces(people: &[Person], obstacles: &[Vec<Point2<f64>>], params: &Params) -> Vec<Forces> {
    forces_by::<Portable>(people, obstacles, params)
}

/// [`forces`] with a chosen source of transcendental functions.
pub(crate) fn forces_by<M: Math>(people: &[Person], obstacles: &[Vec<Point2<f64>>], params: &Params) -> Vec<Forces> {
    let groups = groups(people);
    people
        .iter()
        .enumerate()
        .map(|(index, me)| {
            let points = obstacles.get(index).map_or(&[][..], Vec::as_slice);
            let members = me.group.and_then(|group| groups.get(&group)).map_or(&[][..], Vec::as_slice);
            on::<M>(me, index, people, members, points, params)
        })
        .collect()
}

/// Forces on the person at `index` alone; zero where there is no such person.
#[must_use]
pub fn forces_on(index: usize, people: &[Person], obstacles_of_it: &[Point2<f64>], params: &Params) -> Forces {
    let Some(me) = people.get(index) else { return Forces::default() };
    let members: Vec<usize> = match me.group {
        Some(group) => {
            people.iter().enumerate().filter(|(_, other)| other.group == Some(group)).map(|(place, _)| place).collect()
        }
        None => Vec::new(),
    };
    on::<Portable>(me, index, people, &members, obstacles_of_it, params)
}

/// Places of the members of every group, in list order.
pub(crate) fn groups(people: &[Person]) -> BTreeMap<u32, Vec<usize>> {
    let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (place, person) in people.iter().enumerate() {
        if let Some(group) = person.group {
            groups.entry(group).or_default().push(place);
        }
    }
    groups
}

fn on<M: Math>(
    me: &Person,
    index: usize,
    people: &[Person],
    members: &[usize],
    obstacles: &[Point2<f64>],
    params: &Params,
) -> Forces {
    let (desired, wish) = desired(me, params);
    let group = group::on::<M>(me, index, members, people, &wish, params);
    Forces {
        desired: known(desired),
        obstacle: known(obstacle::<M>(me, obstacles, params)),
        social: social::<M>(me, index, people, params),
        gaze: group.gaze,
        coherence: group.coherence,
        repulsion: group.repulsion,
    }
}

/// Desired force and the direction of the goal (zero without one, or inside its radius).
///
/// Coming to rest has no factor: so does the reference.
pub(crate) fn desired(me: &Person, params: &Params) -> (Vector2<f64>, Vector2<f64>) {
    if let Some(goal) = me.goal {
        let way = goal.at - me.position;
        if norm(&way) > goal.radius_m {
            let wish = unit(&way);
            let lacking = wish * me.speed_mps - me.velocity;
            return ((lacking * params.desired) / params.relaxation_s, wish);
        }
    }
    (-me.velocity / params.relaxation_s, Vector2::zeros())
}

/// Sum over obstacle points, not their mean.
fn obstacle<M: Math>(me: &Person, obstacles: &[Point2<f64>], params: &Params) -> Vector2<f64> {
    obstacles.iter().fold(Vector2::zeros(), |sum, point| {
        let away = me.position - point;
        let distance = norm(&away) - me.radius_m;
        let strength = params.obstacle * M::exp(-distance / params.obstacle_sigma_m);
        sum + unit(&away) * strength
    })
}

/// Sum over everybody else, without a cut-off or a field of view; radii are not used.
fn social<M: Math>(me: &Person, index: usize, people: &[Person], params: &Params) -> Vector2<f64> {
    let mut sum = Vector2::zeros();
    for (place, other) in people.iter().enumerate() {
        if place != index {
            let way = other.position - me.position;
            sum += known(pair::<M>(&way, &(me.velocity - other.velocity), params));
        }
    }
    sum
}

/// The social force of one other person who is `way` away and comes nearer at `closing`.
pub(crate) fn pair<M: Math>(way: &Vector2<f64>, closing: &Vector2<f64>, params: &Params) -> Vector2<f64> {
    let direction = unit(way);
    let interaction = closing * params.lambda + direction;
    let strength = norm(&interaction);
    let along = Vector2::new(interaction.x / strength, interaction.y / strength);
    let range = params.gamma_m * strength;
    let mut theta = wrap(M::angle(&direction) - M::angle(&along));
    if params.epsilon > 0.0 {
        theta = wrap(theta + params.epsilon * range);
    }
    let distance = norm(way);
    let slow_width = params.n_prime * range * theta;
    let turn_width = params.n * range * theta;
    let slow = -M::exp(-distance / range - slow_width * slow_width);
    let side = if theta > 0.0 {
        1.0
    } else if theta < 0.0 {
        -1.0
    } else {
        0.0
    };
    let turn = -side * M::exp(-distance / range - turn_width * turn_width);
    (along * slow + left(&along) * turn) * params.social
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::person::Goal;

    fn walker(x: f64, y: f64, goal_x: f64) -> Person {
        let goal = Some(Goal { at: Point2::new(goal_x, y), radius_m: 0.3 });
        Person { goal, ..Person::standing(1, Point2::new(x, y)) }
    }

    #[test]
    fn a_goal_pulls_at_twice_the_lacking_speed_per_half_second() {
        let forces = forces_on(0, &[walker(0.0, 0.0, 10.0)], &[], &Params::default());
        assert!((forces.total().x - 2.0 * 1.2 / 0.5).abs() < 1e-12);
        assert!(forces.total().y.abs() < 1e-12);
    }

    #[test]
    fn two_people_on_one_spot_give_no_nan() {
        let people = [walker(0.0, 0.0, 0.0), walker(0.0, 0.0, 0.0)];
        for forces in forces(&people, &[], &Params::default()) {
            assert!(forces.total().iter().all(|component| component.is_finite()));
        }
    }

    #[test]
    fn a_wall_point_pushes_away_from_itself() {
        let person = Person::standing(1, Point2::new(0.0, 0.0));
        let forces = forces_on(0, &[person], &[Point2::new(0.5, 0.0)], &Params::default());
        assert!(forces.obstacle.x < 0.0 && forces.obstacle.y.abs() < 1e-12);
    }

    #[test]
    fn one_person_at_a_time_gives_the_same_as_all_at_once() {
        let mut people = vec![walker(0.0, 0.1, 9.0), walker(4.0, 0.0, -9.0), walker(0.5, -0.6, 9.0)];
        for place in [0, 2] {
            people[place].group = Some(7);
        }
        let params = Params::default();
        let points = vec![vec![Point2::new(1.0, 1.0)]; 3];
        let all = forces(&people, &points, &params);
        for (index, one) in all.iter().enumerate() {
            assert_eq!(*one, forces_on(index, &people, &points[index], &params));
        }
    }

    #[test]
    fn the_bias_breaks_the_tie_of_an_exact_meeting() {
        let mut people = vec![walker(0.0, 0.0, 9.0), walker(3.0, 0.0, -9.0)];
        people[0].velocity.x = 1.0;
        people[1].velocity.x = -1.0;
        let tie = forces_on(0, &people, &[], &Params::lightsfm_hunav());
        let broken = forces_on(0, &people, &[], &Params::default());
        assert!(tie.social.y.abs() < 1e-12);
        assert!(broken.social.y.abs() > 1e-6);
    }
}
