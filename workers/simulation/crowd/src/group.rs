//! Forces among the members of a group.

use nalgebra::{Point2, Vector2};

use crate::math::Math;
use crate::params::{CenterOrder, Params};
use crate::person::Person;
use crate::vector::{dot, known, norm};

/// Gaze, coherence and repulsion, each 0 outside a group.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct GroupForces {
    pub(crate) gaze: Vector2<f64>,
    pub(crate) coherence: Vector2<f64>,
    pub(crate) repulsion: Vector2<f64>,
}

/// Group forces on `me`, who is at `index` in the crowd; `wish` is the direction of its goal.
///
/// `members` are the places of everybody in the group (with `index`), in list order.
pub(crate) fn on<M: Math>(
    me: &Person,
    index: usize,
    members: &[usize],
    people: &[Person],
    wish: &Vector2<f64>,
    params: &Params,
) -> GroupForces {
    if members.len() < 2 {
        return GroupForces::default();
    }
    #[expect(clippy::cast_precision_loss, reason = "a group never has 2^53 members")]
    let n = members.len() as f64;
    let others = || members.iter().filter(|place| **place != index).filter_map(|place| people.get(*place));
    let center = match params.center {
        CenterOrder::List => {
            let sum = members
                .iter()
                .filter_map(|place| people.get(*place))
                .fold(Vector2::zeros(), |sum: Vector2<f64>, person| sum + person.position.coords);
            Point2::from(sum / n)
        }
        CenterOrder::SelfFirst => {
            let sum = others().fold(me.position.coords, |sum, person| sum + person.position.coords);
            Point2::from(sum / n)
        }
    };
    GroupForces {
        gaze: known(gaze::<M>(me, &center, n, wish) * params.gaze),
        coherence: known(coherence::<M>(me, &center, n) * params.coherence),
        repulsion: known(repulsion(me, others()) * params.repulsion),
    }
}

/// Turns the walk so that the others stay within a right angle of the way ahead.
fn gaze<M: Math>(me: &Person, center: &Point2<f64>, n: f64, wish: &Vector2<f64>) -> Vector2<f64> {
    let center_of_others = (center.coords * n - me.position.coords) * (1.0 / (n - 1.0));
    let to_others = center_of_others - me.position.coords;
    let ahead = dot(wish, &to_others);
    let turn = M::acos(ahead / (norm(wish) * norm(&to_others)));
    // Not a number when there is no goal direction: then nobody needs to turn.
    if turn > std::f64::consts::FRAC_PI_2 { wish * (ahead / dot(wish, wish)) } else { Vector2::zeros() }
}

/// Pulls towards the center, softly inside half a meter per other member.
fn coherence<M: Math>(me: &Person, center: &Point2<f64>, n: f64) -> Vector2<f64> {
    let to_center = center - me.position;
    let softness = M::tanh(norm(&to_center) - (n - 1.0) / 2.0) + 1.0;
    to_center * (softness / 2.0)
}

/// Keeps touching members apart.
fn repulsion<'a>(me: &Person, others: impl Iterator<Item = &'a Person>) -> Vector2<f64> {
    others.fold(Vector2::zeros(), |sum, other| {
        let apart = me.position - other.position;
        if norm(&apart) < me.radius_m + other.radius_m { sum + apart } else { sum }
    })
}
