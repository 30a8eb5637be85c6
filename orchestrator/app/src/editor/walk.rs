//! One person who walks a way, as people of the simulation walk: pulled by a point ahead of them, pushed by walls.

use serde::Serialize;
use socrates_crowd::{Goal, Params, Person, forces_on, integrate};
use socrates_edit::Spot;
use socrates_maps::Ground;
use socrates_model::{Point, Polyline};

/// Length of a step, s.
const STEP_S: f64 = 0.05;
/// Every so many steps are shown.
const SHOWN_EVERY: u32 = 2;
/// Longest walk, s.
const LONGEST_S: f64 = 900.0;
/// Somebody who comes no farther for so long stands for good, s.
const STUCK_S: f64 = 8.0;
/// Points ahead on the way that they may head for, farthest first, m: the farthest that nothing stands between counts.
const AHEAD_M: [f64; 5] = [2.0, 1.2, 0.7, 0.4, 0.2];
/// Their place on the way is looked for so far back and on, m.
const AROUND_M: (f64, f64) = (0.5, 2.5);
/// Walls are felt from so far, in so many sectors, as by people of the simulation.
const WALL_REACH_M: f64 = 3.0;
const SECTORS: usize = 8;
/// Nearer to the end than this they have arrived, m.
const THERE_M: f64 = 0.2;

/// Where somebody was, at even times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Walk {
    /// Time between two places, s.
    pub(super) every_s: f64,
    /// Places on the image.
    pub(super) places: Vec<Spot>,
    /// How long it took, s.
    pub(super) secs: f64,
    /// Whether they came to the end of the way.
    pub(super) arrives: bool,
}

/// Walks a way of points in the map frame, m, at 1.2 m/s.
pub(super) fn walk(ground: &Ground, points: &[Point]) -> Walk {
    let every_s = STEP_S * f64::from(SHOWN_EVERY);
    let way = Polyline::new(points);
    let (Some(start), Some(end)) = (points.first(), points.last()) else {
        return Walk { every_s, places: Vec::new(), secs: 0.0, arrives: false };
    };
    let params = Params::default();
    let mut person = Person::standing(1, *start);
    let (mut s, mut secs, mut best, mut since_s) = (0.0, 0.0, 0.0, 0.0);
    let mut places = vec![Spot::of(ground.grid(), start)];
    let mut step = 0_u32;
    let arrived = |at: &Point| (end - at).norm() < THERE_M;
    while secs < LONGEST_S && since_s < STUCK_S && !arrived(&person.position) {
        s = way.progress(&person.position, s, AROUND_M).0;
        let free = |ahead: &f64| ground.sight().clear(&person.position, &way.point(s + ahead));
        let ahead = AHEAD_M.iter().copied().find(free).unwrap_or(0.2);
        let target = way.point(s + ahead);
        person.goal = Some(Goal { at: target, radius_m: 0.02 });
        let walls = ground.field().sectors(&person.position, WALL_REACH_M, SECTORS);
        let mut forces = forces_on(0, std::slice::from_ref(&person), &walls, &params);
        // Walls beside a free way push aside, not back, as in the simulation.
        let toward = target - person.position;
        let back = forces.obstacle.dot(&toward) / toward.norm_squared().max(1e-9);
        if back < 0.0 {
            forces.obstacle -= toward * back;
        }
        integrate(&mut person, &forces.total(), STEP_S);
        secs += STEP_S;
        since_s = if s > best + 0.05 { 0.0 } else { since_s + STEP_S };
        best = f64::max(best, s);
        step += 1;
        if step.is_multiple_of(SHOWN_EVERY) {
            places.push(Spot::of(ground.grid(), &person.position));
        }
    }
    places.push(Spot::of(ground.grid(), &person.position));
    Walk { every_s, places, secs, arrives: arrived(&person.position) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn somebody_walks_through_a_doorway_of_the_office_and_touches_no_wall() {
        let location = socrates_maps::shipped::load("office").unwrap();
        let ground = Ground::of(&location.grid);
        let id = |text: &str| socrates_model::NodeId::new(text).unwrap();
        for (from, to) in [("h0", "m1a"), ("kt", "o1"), ("s1", "rx")] {
            let way = socrates_edit::way(&location, &id(from), &id(to)).unwrap();
            let walked = walk(&ground, &way.points);
            assert!(walked.arrives, "{from} to {to}: {} s", walked.secs);
            assert!(
                walked.secs > way.length_m / 1.4 && walked.secs < way.length_m,
                "{} s for {} m",
                walked.secs,
                way.length_m
            );
            let clear = walked.places.iter().map(|spot| ground.field().clearance(&spot.point(&location.grid)));
            assert!(clear.fold(f64::INFINITY, f64::min) > 0.2);
            assert_eq!(walked, walk(&ground, &way.points));
        }
    }
}
