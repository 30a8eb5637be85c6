//! Out of the robot's way: to a spot beside its line, for good or until it has passed.

use std::f64::consts::TAU;

use socrates_model::geometry::nearest_on_segment;
use socrates_model::{Action, Point, Polyline, Trigger, Vector};

use crate::human::Human;
use crate::motion::{Scene, Want, refuge, round, stay};
use crate::robot::Robot;

/// Distance from the robot's line that gives it way, m.
pub(crate) const ASIDE_M: f64 = 1.0;
/// So much farther from it goes who is aside already, m.
const GOES_M: f64 = 0.45;
/// Gap, surface to surface, at which somebody who makes room goes by a robot that stands, m: in a doorway less is no way
/// out.
const BY_ROBOT_M: f64 = 0.25;

/// Steps out of the robot's way until it has passed, and goes back to where they stood.
pub(crate) fn open(human: &mut Human, scene: &Scene<'_>) -> Want {
    // Whoever has let the robot through goes back to their place: see `stay`.
    human.yields_until_s = human.yields_until_s.max(scene.now_s);
    let passed =
        scene.robot.is_some_and(|robot| Trigger::is_passed((robot.at() - human.at).norm(), human.nearest_robot_m));
    if passed { stay(human, scene) } else { give_way(human, scene) }
}

/// The robot's line: its way ahead while it keeps to it, else straight on.
fn line(robot: &Robot) -> Polyline {
    let (_, aside) = robot.route.project_within(&robot.at(), robot.s - 0.5, robot.s + 2.0);
    if aside < 1.2 {
        robot.route.from((robot.s - 0.3).max(0.0))
    } else {
        Polyline::new(&[robot.at(), robot.at() + robot.heading() * 8.0])
    }
}

/// Goes to the nearest spot beside the robot's line, and waits there.
pub(crate) fn give_way(human: &mut Human, scene: &Scene<'_>) -> Want {
    let Some(robot) = scene.robot else { return Want::STAND };
    let line = line(robot);
    let off = |point: &Point| line.project(point).1;
    let here = off(&human.at);
    if human.errand.spot.is_none()
        || human.errand.spot.is_some_and(|spot| off(&spot) < 0.85) && scene.now_s - human.errand.since_s > 1.0
    {
        human.errand.since_s = scene.now_s;
        // Whoever does so of their own is seen to go, also from where they are aside already.
        let gives = matches!(human.action, Action::GiveWay | Action::MakeRoom);
        let wanted_m = if gives { ASIDE_M.max(here + GOES_M) } else { ASIDE_M };
        let mut found = if here >= wanted_m { human.at } else { aside_spot(human, scene, wanted_m, &off) };
        if off(&found) < human.radius_m + robot.model.radius_m + 0.1 {
            // In a narrow aisle there is no aside: it walks ahead of the robot to where there is one.
            found = bay(human, scene, &line).or_else(|| refuge(human, scene, robot)).unwrap_or(found);
        }
        // Between two spots that are about as good it would go to and fro before the robot.
        if human.errand.spot.is_none_or(|spot| off(&found) > off(&spot) + 0.25) {
            human.errand.spot = Some(found);
        }
    }
    let spot = human.errand.spot.unwrap_or(human.at);
    let left = (spot - human.at).norm();
    if left < 0.08 {
        return Want::stand_facing(robot.at());
    }
    let target = if left > 1.0 { round(human, scene, &spot).unwrap_or(spot) } else { spot };
    Want { face: Some(robot.at()), ..Want::go(target, (2.0 * left + 0.1).min(human.speed_mps.max(0.9))) }
}

/// The first place beside the robot's line, ahead of the human, where the robot can pass it.
fn bay(human: &Human, scene: &Scene<'_>, line: &Polyline) -> Option<Point> {
    let (from, _) = line.project(&human.at);
    (1..=30_u32).find_map(|step| {
        let s = from + 0.5 * f64::from(step);
        let along = line.direction(s);
        let left = Vector::new(-along.y, along.x) * ASIDE_M;
        [left, -left].into_iter().map(|aside| line.point(s) + aside).find(|spot| {
            s < line.length_m()
                && scene.floor.clearance_m(spot) >= human.radius_m + 0.04
                && line.project(spot).1 > 0.8 * ASIDE_M
                && scene.floor.straight(&line.point(s), spot, human.radius_m - 0.05)
        })
    })
}

/// The nearest free spot so far off the robot's line that can be reached straight; the farthest off where none is far enough.
pub(crate) fn aside_spot(human: &Human, scene: &Scene<'_>, wanted_m: f64, off: &dyn Fn(&Point) -> f64) -> Point {
    let mut best = (off(&human.at), human.at);
    let toward = scene.robot.map_or_else(Vector::zeros, |robot| {
        let way = robot.at() - human.at;
        way / way.norm().max(0.1)
    });
    // A robot that drives has gone on by then.
    let berth = scene.robot.map_or(0.0, |robot| if robot.velocity.norm() < 0.1 { BY_ROBOT_M } else { 0.0 });
    // In a doorway the body has less room than it would like; what it has is enough to step out of it.
    let room = human.radius_m.min(scene.floor.wall_clearance_m(&human.at) - 0.02).max(0.1);
    for ring in 1..=12_u32 {
        for turn in 0..24_u32 {
            let angle = f64::from(turn) / 24.0 * TAU;
            let spot = human.at + Vector::new(libm::cos(angle), libm::sin(angle)) * (0.3 * f64::from(ring));
            let crowded = scene.others.iter().any(|other| {
                other.id.is_some()
                    && other.id != Some(human.id)
                    && (other.at - spot).norm() < other.radius_m + human.radius_m + 0.1
            });
            // Nor through the robot to behind it, nor so close by it that its forces push whoever tries back again.
            let through = scene.robot.is_some_and(|robot| {
                nearest_on_segment(&robot.at(), &human.at, &spot).0
                    < (robot.at() - human.at).norm().min(human.radius_m + robot.model.radius_m + berth) - 0.01
            });
            if crowded
                || through
                || !scene.floor.straight(&human.at, &spot, room)
                || scene.floor.shut_between(&human.at, &spot)
                || scene.floor.clearance_m(&spot) < human.radius_m + 0.04
            {
                continue;
            }
            // Back or aside rather than towards the robot, and no farther than it takes.
            let nearer = (spot - human.at).dot(&toward).max(0.0);
            let distance = off(&spot).min(wanted_m + 0.05) - 0.15 * (nearer + (spot - human.at).norm());
            if distance > best.0 + 0.02 {
                best = (distance, spot);
            }
        }
    }
    best.1
}
