//! Two people face to face where only one gets through: one of them makes room.
//!
//! Who of the two it is does not depend on who is asked first: the one with the higher number, or the other where the first
//! has no place to go to within a while. It goes aside if the floor allows it, else back along its own way to where it is wide
//! enough, lets the other past, and goes on.

use socrates_model::{Point, Polyline, Vector};

use crate::give_way::{self, aside_spot};
use crate::human::Human;
use crate::motion::{Scene, Want, round};
use crate::near::Other;

/// Somebody ahead is face to face with us nearer than this, m.
const FACE_M: f64 = 1.3;
/// Slower than this nobody gets on, m/s.
const STILL_MPS: f64 = 0.2;
/// The one with the higher number makes room after so long, the other one later, s.
const PATIENCE_S: (f64, f64) = (1.5, 6.0);
/// Longest time that somebody makes room, s.
const LONGEST_S: f64 = 9.0;
/// From the other's line, m: two bodies and a hand between them.
const ASIDE_M: f64 = 0.68;
/// How far back somebody goes for a wider place, m.
const BACK_M: f64 = 14.0;

/// What somebody remembers who is face to face with somebody else.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Facing {
    /// For how long it has not got on, s.
    still_s: f64,
    /// The place to which it goes, and until when it stays there.
    aside: Option<(Point, f64)>,
}

/// Whether somebody on its way has to see who is before it: it does not get on, or makes room already.
pub(crate) fn is_held_up(human: &Human) -> bool {
    human.facing.aside.is_some() || human.started && human.velocity.dot(&travel(human)) < STILL_MPS
}

fn travel(human: &Human) -> Vector {
    human.route.direction(human.s + 0.3)
}

/// What somebody on its way wants who makes room; `None` where it just walks on.
pub(crate) fn make_room(human: &mut Human, scene: &Scene<'_>) -> Option<Want> {
    if !is_held_up(human) {
        human.facing.still_s = 0.0;
        return None;
    }
    if let Some((spot, until_s)) = human.facing.aside {
        let ahead = travel(human);
        let waits = scene.others.iter().filter(|other| of_people(human, other)).find(|other| {
            let way = other.at - human.at;
            way.norm() < 2.5 && way.dot(&ahead) > -0.3 && other.velocity.dot(&ahead) < STILL_MPS
        });
        let (Some(other), true) = (waits, scene.now_s < until_s) else {
            human.facing = Facing::default();
            human.errand.way = None;
            return None;
        };
        let left = (spot - human.at).norm();
        if left < 0.1 {
            return Some(Want { face: Some(other.at), ..Want::STAND });
        }
        let target = if left > 0.8 { round(human, scene, &spot).unwrap_or(spot) } else { spot };
        return Some(Want::go(target, (2.0 * left + 0.1).min(human.speed_mps.max(0.8))));
    }
    let travel = travel(human);
    let face = scene.others.iter().filter(|other| of_people(human, other)).find(|other| {
        let way = other.at - human.at;
        way.norm() < FACE_M && way.dot(&travel) > 0.6 * way.norm() && other.velocity.norm() < STILL_MPS
    });
    // To and fro before the other is no getting on.
    let Some(other) = face else {
        human.facing.still_s = 0.0;
        return None;
    };
    human.facing.still_s += 0.01;
    let patience = if other.id.is_some_and(|id| human.id > id) { PATIENCE_S.0 } else { PATIENCE_S.1 };
    if human.facing.still_s < patience {
        return None;
    }
    human.facing.still_s = 0.0;
    let spot = spot(human, scene, other)?;
    human.facing.aside = Some((spot, scene.now_s + LONGEST_S));
    human.errand.way = None;
    Some(Want::STAND)
}

/// People of other groups: one's own group walks along.
fn of_people(human: &Human, other: &Other) -> bool {
    other.id.is_some_and(|id| id != human.id) && (human.group.is_none() || other.group != human.group)
}

/// Where to make room: beside the other's line, else the first place back along the own way that is wide enough.
fn spot(human: &Human, scene: &Scene<'_>, other: &Other) -> Option<Point> {
    let toward = human.at - other.at;
    let ahead = toward / toward.norm().max(0.1);
    let line = Polyline::new(&[other.at - ahead * 4.0, other.at + ahead * (BACK_M + FACE_M)]);
    let beside = aside_spot(human, scene, give_way::ASIDE_M, &|point| line.project(point).1);
    if line.project(&beside).1 >= ASIDE_M && (beside - human.at).dot(&-ahead) < 0.3 {
        return Some(beside);
    }
    back(human, scene)
}

fn back(human: &Human, scene: &Scene<'_>) -> Option<Point> {
    (1..=28_u32).find_map(|step| {
        let s = human.s - 0.5 * f64::from(step);
        if s < 0.0 || human.s - s > BACK_M {
            return None;
        }
        let (at, along) = (human.route.point(s), human.route.direction(s));
        let left = Vector::new(-along.y, along.x) * (ASIDE_M + 0.15);
        [-left, left].into_iter().map(|aside| at + aside).find(|spot| {
            let crowded = scene.others.iter().any(|other| {
                of_people(human, other) && (other.at - spot).norm() < other.radius_m + human.radius_m + 0.1
            });
            !crowded
                && scene.floor.clearance_m(spot) >= human.radius_m + 0.04
                && scene.floor.straight(&at, spot, human.radius_m - 0.05)
        })
    })
}
