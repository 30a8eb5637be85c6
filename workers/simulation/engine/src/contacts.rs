//! Contacts: nobody overlaps anybody, a wall or a closed door.
//!
//! rapier2d's narrow phase finds depth and normal. It works in f32, so every pair is handed to it in a
//! local frame around the first body; corrections below a tenth of a millimeter are left out, because
//! they would only be rounding.

use rapier2d::math::Pose;
use rapier2d::parry::query;
use rapier2d::parry::shape::{Ball, Segment};
use socrates_model::{AgentId, Point, Vector};

use crate::floor::Floor;

/// Corrections smaller than this are not applied, m.
const LEAST_M: f64 = 1e-4;
/// Most passes over all pairs. People who walk settle in two or three; thirty who press towards one spot are left
/// with less than 1 cm of overlap.
const PASSES: usize = 20;

/// Bodies farther apart than this, surface to surface, never touch while one tick's contacts are resolved, m.
const MARGIN_M: f64 = 0.5;

/// A disc that may have to give way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Who.
    pub agent: AgentId,
    /// Center in the map frame, m. Where it would be without contacts in, where it is out.
    pub at: Point,
    /// Velocity in the map frame, m/s. The part that leads into a contact is taken out.
    pub velocity: Vector,
    /// Radius, m.
    pub radius_m: f64,
    /// Share of a correction it takes, 0 to 1: 1 for somebody who walks, near 0 for somebody who stands.
    /// Of two bodies with 0 neither moves.
    pub yields: f64,
    /// Whether no wall and no door can be touched, as its own side knows: then none is looked for.
    pub clear: bool,
}

/// What touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Touch {
    /// Two bodies, in the order of the list, and how deep they were in each other, m.
    Agents(AgentId, AgentId, f64),
    /// A body and a wall or closed door, and how deep it was in it, m.
    Wall(AgentId, f64),
}

/// Moves overlapping bodies apart and out of walls and closed doors, and takes the speed out of their contacts.
///
/// Give it the bodies where they would be after the step; take places and velocities back. A contact of
/// less than 0.1 mm is none. Gives back what touched, with the depth before the correction.
pub fn resolve(bodies: &mut [Body], floor: &Floor) -> Vec<Touch> {
    let mut touches = Vec::new();
    let pairs = pairs(bodies);
    for pass in 0..PASSES {
        let mut moved = false;
        for (first, second) in &pairs {
            let (first, second) = (*first, *second);
            let (Some(a), Some(b)) = (bodies.get(first), bodies.get(second)) else { continue };
            let Some((depth, normal)) = disc_disc(a, b) else { continue };
            if pass == 0 {
                touches.push(Touch::Agents(a.agent, b.agent, depth));
            }
            moved = true;
            let total = (a.yields + b.yields).max(1e-9);
            let (back, on) = (depth * a.yields / total, depth * b.yields / total);
            push(bodies, first, &(-normal * back), &-normal);
            push(bodies, second, &(normal * on), &normal);
        }
        for place in 0..bodies.len() {
            let Some(body) = bodies.get(place).filter(|body| !body.clear).copied() else { continue };
            let Some((depth, normal)) = disc_wall(&body, floor) else { continue };
            if pass == 0 {
                touches.push(Touch::Wall(body.agent, depth));
            }
            moved = true;
            push(bodies, place, &(normal * depth), &normal);
        }
        if !moved {
            break;
        }
    }
    touches
}

/// Pairs that may touch while contacts are resolved, in the order of the list: everybody nearer than [`MARGIN_M`].
fn pairs(bodies: &[Body]) -> Vec<(usize, usize)> {
    let mut order: Vec<(f64, usize)> = bodies.iter().enumerate().map(|(place, body)| (body.at.x, place)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let widest = bodies.iter().fold(0.0_f64, |most, body| most.max(body.radius_m));
    let mut pairs = Vec::new();
    for (step, (x, first)) in order.iter().enumerate() {
        let Some(a) = bodies.get(*first) else { continue };
        let reach = a.radius_m + widest + MARGIN_M;
        for (_, second) in order.iter().skip(step + 1).take_while(|(other, _)| *other - x < reach) {
            let Some(b) = bodies.get(*second) else { continue };
            let near = a.radius_m + b.radius_m + MARGIN_M;
            if (b.at - a.at).norm_squared() < near * near {
                pairs.push((*first.min(second), *first.max(second)));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

fn push(bodies: &mut [Body], place: usize, step: &Vector, away: &Vector) {
    if let Some(body) = bodies.get_mut(place) {
        body.at += step;
        let into = body.velocity.dot(away);
        if into < 0.0 {
            body.velocity -= away * into;
        }
    }
}

/// Depth and normal (from `a` to `b`) of two overlapping discs.
fn disc_disc(a: &Body, b: &Body) -> Option<(f64, Vector)> {
    let apart = b.at - a.at;
    let reach = a.radius_m + b.radius_m;
    // The cheap test first: most pairs are far apart.
    if apart.norm_squared() >= (reach - LEAST_M) * (reach - LEAST_M) {
        return None;
    }
    if apart.norm() < 1e-6 {
        // On one spot there is no normal; the frame number decides the side.
        return Some((reach, Vector::new(1.0, 0.0)));
    }
    let contact = query::contact(
        &Pose::translation(0.0, 0.0),
        &Ball::new(narrow(a.radius_m)),
        &Pose::translation(narrow(apart.x), narrow(apart.y)),
        &Ball::new(narrow(b.radius_m)),
        0.0,
    );
    let contact = contact.ok().flatten()?;
    let normal = unit(&Vector::new(f64::from(contact.normal1.x), f64::from(contact.normal1.y)));
    let depth = -f64::from(contact.dist);
    (depth > LEAST_M).then_some((depth, normal))
}

/// Depth and normal (away from the wall) of a disc in a wall or closed door.
fn disc_wall(body: &Body, floor: &Floor) -> Option<(f64, Vector)> {
    if floor.clearance_m(&body.at) >= body.radius_m - LEAST_M {
        return None;
    }
    // The deepest counts: between a wall and a closed door the other one has its turn in the next pass.
    let doors = floor.closed().iter().filter_map(|(from, to)| disc_segment(body, from, to));
    let wall = floor.nearest_wall(&body.at, body.radius_m + 0.5).and_then(|(distance, wall)| {
        let depth = body.radius_m - distance;
        let away = body.at - wall;
        (depth > LEAST_M && away.norm() > 1e-6).then(|| (depth, unit(&away)))
    });
    doors.fold(wall, |deepest, found| match deepest {
        Some(deepest) if deepest.0 > found.0 => Some(deepest),
        Some(_) | None => Some(found),
    })
}

fn disc_segment(body: &Body, from: &Point, to: &Point) -> Option<(f64, Vector)> {
    let (a, b) = (from - body.at, to - body.at);
    if a.norm().min(b.norm()) > 20.0 {
        return None;
    }
    let segment = Segment::new([narrow(a.x), narrow(a.y)].into(), [narrow(b.x), narrow(b.y)].into());
    let contact = query::contact(
        &Pose::translation(0.0, 0.0),
        &segment,
        &Pose::translation(0.0, 0.0),
        &Ball::new(narrow(body.radius_m)),
        0.0,
    );
    let contact = contact.ok().flatten()?;
    let normal = unit(&Vector::new(f64::from(contact.normal1.x), f64::from(contact.normal1.y)));
    let depth = -f64::from(contact.dist);
    (depth > LEAST_M).then_some((depth, normal))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rapier works in f32; the frame is local, so a meter keeps 7 digits"
)]
const fn narrow(value: f64) -> f32 {
    value as f32
}

fn unit(vector: &Vector) -> Vector {
    let norm = vector.norm();
    if norm > 0.0 { vector / norm } else { Vector::new(1.0, 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    fn body(number: u32, x: f64, yields: f64) -> Body {
        Body {
            agent: AgentId::from_number(number),
            at: Point::new(x, 0.0),
            velocity: Vector::new(1.0, 0.0),
            radius_m: 0.28,
            yields,
            clear: false,
        }
    }

    #[test]
    fn overlapping_bodies_are_apart_afterwards_and_the_stander_stays() {
        let floor = Floor::new(&fixture::hall(20.0, 10.0));
        let mut bodies = [body(1, 5.0, 1.0), body(2, 5.4, 0.0)];
        for body in &mut bodies {
            body.at.y = 5.0;
        }
        let touches = resolve(&mut bodies, &floor);
        assert_eq!(touches.len(), 1);
        assert!((bodies[1].at - bodies[0].at).norm() > 0.56 - 2e-4);
        assert!((bodies[1].at.x - 5.4).abs() < 1e-9);
        assert!(bodies[0].velocity.x < 1e-6);
    }

    #[test]
    fn a_closed_door_is_not_walked_through() {
        let mut floor = Floor::new(&fixture::hall(20.0, 10.0));
        floor.close(vec![(Point::new(10.0, 4.0), Point::new(10.0, 6.0))]);
        let mut bodies = [body(1, 9.8, 1.0)];
        bodies[0].at.y = 5.0;
        resolve(&mut bodies, &floor);
        assert!(bodies[0].at.x < 10.0 - 0.28 + 2e-4, "{}", bodies[0].at.x);
    }

    #[test]
    fn a_wall_pushes_back() {
        let floor = Floor::new(&fixture::hall(20.0, 10.0));
        let mut bodies = [body(1, 0.3, 1.0)];
        bodies[0].at.y = 5.0;
        let wall = floor.clearance_m(&bodies[0].at);
        resolve(&mut bodies, &floor);
        assert!(wall < 0.28 && floor.clearance_m(&bodies[0].at) > 0.28 - 1e-3);
    }
}
