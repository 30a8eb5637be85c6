//! The robot's path against the shortest one.

use socrates_maps::{DistanceField, Geodesic};
use socrates_model::Point;
use socrates_model::geometry::wrap_angle;

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::{Begin, Family, Measure, Measured, count, or_why};
use crate::tracks::Sample;

/// Step at which the shortest way is followed, m.
const TRACE_M: f64 = 0.25;
/// Steps shorter than this have no direction, m.
const STEP_M: f64 = 0.02;

/// The family.
pub(super) const FAMILY: Family = Family {
    name: "path",
    thresholds: &[("step_m", STEP_M)],
    measure: Measure::Online(Begin(|_| Box::new(Way::default()))),
};

/// A step longer than this is a jump of the recording and no way, m: nobody covers it between two samples.
const JUMP_M: f64 = 1000.0;

/// Points of a path, half a meter of way apart.
#[derive(Debug, Clone, Default)]
pub(super) struct Spaced {
    way_m: f64,
    next_m: f64,
    before: Option<Point>,
    /// The last two points that came.
    last: [Option<Point>; 2],
}

impl Spaced {
    /// Goes on to a place; each point that comes is handed on with the two before it.
    pub(super) fn step(&mut self, at: Point, mut triple: impl FnMut(&Point, &Point, &Point)) {
        // The point at the very length, not the sample after it: else the spacing would follow the grid.
        if let Some(from) = self.before.replace(at) {
            let step = (at - from).norm();
            if step > JUMP_M {
                // Points every half meter of a jump would be a walk as long as the jump, and a curve of none of them.
                *self = Self { before: Some(at), ..Self::default() };
                return;
            }
            while self.way_m + step >= self.next_m && step > 0.0 {
                let point = from + (at - from) * ((self.next_m - self.way_m) / step);
                self.next_m += 0.5;
                if let [Some(p), Some(q)] = &self.last {
                    triple(p, q, &point);
                }
                self.last = [self.last[1], Some(point)];
            }
            self.way_m += step;
        }
    }
}

/// The way so far, on the even grid.
#[derive(Clone, Default)]
struct Way {
    start: Option<Point>,
    before: Option<Sample>,
    length_m: f64,
    heading_rad: f64,
    /// Where the last step of some length ended, and its direction; the direction of the first.
    from: Option<Point>,
    direction: Option<f64>,
    first_direction: Option<f64>,
    turned_rad: f64,
    spaced: Spaced,
    curvature: f64,
    triples: usize,
}

impl Way {
    fn step(&mut self, sample: &Sample) {
        self.start.get_or_insert(sample.at);
        if let Some(before) = self.before.replace(*sample) {
            self.length_m += (sample.at - before.at).norm();
            self.heading_rad += wrap_angle(sample.yaw - before.yaw).abs();
        }
        let step = sample.at - *self.from.get_or_insert(sample.at);
        if step.norm() >= STEP_M {
            let direction = libm::atan2(step.y, step.x);
            if let Some(before) = self.direction.replace(direction) {
                self.turned_rad += wrap_angle(direction - before).abs();
            }
            self.first_direction.get_or_insert(direction);
            self.from = Some(sample.at);
        }
        let (curvature, triples) = (&mut self.curvature, &mut self.triples);
        self.spaced.step(sample.at, |p, q, r| {
            let (a, b, c) = ((q - p).norm(), (r - q).norm(), (r - p).norm());
            if a * b * c > 1e-9 {
                *curvature += 2.0 * (q - p).perp(&(r - p)).abs() / (a * b * c);
                *triples += 1;
            }
        });
    }

    /// Turning beyond that along the shortest way, rad.
    fn excess(&self, setting: &Setting<'_>) -> Measured {
        let ends = self.first_direction.zip(self.direction).map(|(first, last)| wrap_angle(last - first).abs());
        let least = setting.field.zip(setting.geodesic).zip(self.start.zip(setting.goal));
        let least = least.and_then(|((field, geodesic), (start, goal))| {
            shortest_turn(field, geodesic, &start, &goal, setting.robot_radius_m)
        });
        let turn = ends.map(|ends| (self.turned_rad - least.unwrap_or(ends)).max(0.0));
        or_why(turn, "the robot does not move")
    }
}

/// Turning along the shortest way, rad: of the way down the distances, pulled straight wherever the robot's disc fits.
fn shortest_turn(
    field: &DistanceField,
    geodesic: &Geodesic,
    start: &Point,
    goal: &Point,
    radius_m: f64,
) -> Option<f64> {
    // As wide as the disc for which the shortest ways are.
    let room = (radius_m - 0.05).max(0.05);
    let mut way = vec![*start];
    let most = geodesic.distance(start)? / TRACE_M * 2.0 + 10.0;
    while let Some(at) = way.last().copied().filter(|at| (goal - at).norm() > TRACE_M) {
        if count(way.len()) > most {
            return None;
        }
        way.push(at + geodesic.direction(&at)?.try_normalize(1e-9)? * TRACE_M);
    }
    way.push(*goal);
    let open = |from: &Point, to: &Point| {
        let steps = libm::ceil((to - from).norm() / 0.1).max(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "ways on maps are short")]
        let steps = steps as usize;
        // The ends are on the way itself.
        (1..steps).all(|k| field.clearance(&(from + (to - from) * (count(k) / count(steps)))) >= room)
    };
    let (mut turned, mut before, mut index) = (0.0, None::<f64>, 0);
    while let Some(from) = way.get(index).filter(|_| index + 1 < way.len()) {
        let mut next = index + 1;
        while way.get(next + 1).is_some_and(|to| open(from, to)) {
            next += 1;
        }
        let step = way.get(next)? - from;
        let direction = libm::atan2(step.y, step.x);
        turned += before.map_or(0.0, |before| wrap_angle(direction - before).abs());
        before = Some(direction);
        index = next;
    }
    Some(turned)
}

impl Running for Way {
    fn push(&mut self, _setting: &Setting<'_>, now: &Now<'_>) {
        if let Some(robot) = now.robot.filter(|robot| robot.there) {
            self.step(robot);
        }
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let length = self.length_m;
        let shortest = self.start.and_then(|start| end.setting.to_goal_m(&start)).filter(|way| *way > 0.0);
        let speed = end.setting.robot_speed_mps;
        let succeeded = if end.succeeded() { 1.0 } else { 0.0 };
        let excess = self.excess(end.setting);
        let no_way = "the map has no way to the goal for the robot's disc";
        let straight =
            self.start.zip(end.setting.goal).map(|(start, goal)| (goal - start).norm()).filter(|way| *way > 1e-6);
        vec![
            Ok(length),
            or_why(shortest.map(|way| succeeded * way / length.max(way)), no_way),
            match (shortest, end.trip_s()) {
                (Some(_), None) => Ok(0.0),
                (Some(way), Some(time)) if speed > 0.0 => Ok(succeeded * (way / speed) / time.max(way / speed)),
                (Some(_), Some(_)) => Err("the robot's nominal speed is not known".to_owned()),
                (None, _) => Err(no_way.to_owned()),
            },
            match shortest {
                None => Err(no_way.to_owned()),
                Some(_) if end.arrived_s.is_none() => Err("the robot never arrives".to_owned()),
                Some(way) => or_why((length > 0.0).then(|| (way / length).min(1.0)), "the robot does not move"),
            },
            or_why(straight.map(|straight| length / straight), "start and goal are one place"),
            excess.clone().map(|excess| excess / self.length_m.max(STEP_M)),
            excess,
            match (shortest, end.trip_s()) {
                (None, _) => Err(no_way.to_owned()),
                (Some(_), None) => Err("the robot never arrives".to_owned()),
                (Some(way), Some(time)) => {
                    or_why((speed > 0.0).then(|| time * speed / way), "the robot's nominal speed is not known")
                }
            },
            Ok(self.heading_rad),
            or_why((self.triples > 0).then(|| self.curvature / count(self.triples)), "the path is shorter than 1 m"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use socrates_model::{AgentId, EventKind, Point};

    use crate::evidence::Evidence;
    use crate::fixture::{Walk, event, floor, recording};
    use crate::metrics::tests::{at_both_rates, value, value_of};

    #[test]
    fn a_circle_has_the_curvature_of_its_radius_and_turns_once_round() {
        let circle = || vec![Walk::circle(2.0, 20.0)];
        at_both_rates(&circle, 19.9, "curvature_mean", 0.5, 0.01);
        at_both_rates(&circle, 19.9, "path_length", 2.0 * TAU * 19.9 / 20.0, 0.02);
        at_both_rates(&circle, 19.9, "cumulative_heading_change", TAU * 19.9 / 20.0, 0.06);
    }

    #[test]
    fn a_straight_path_is_not_irregular_wherever_it_lies() {
        for (x, y) in [(0., 0.), (30., -7.)] {
            let run = recording(&[Walk::robot(x, y, 0.5, 0.1)], 10.0, 0.1);
            assert!(value(&run, "path_irregularity").unwrap() < 1e-9);
        }
    }

    #[test]
    fn turning_that_the_shortest_way_asks_for_is_not_irregular() {
        // Over a wall that ends at y = 2 m and under one that begins at 1 m, as the shortest way does: no turn from the
        // first to the last direction, and two turns on the way.
        let place = floor(&[(-0.2, -9., 0.2, 2.), (3.0, 1., 3.4, 9.)], &[], &[]);
        let slalom =
            [(0., -4., 0.), (5., -0.3, 2.35), (6., 0.3, 2.35), (10., 2.9, 0.65), (11., 3.5, 0.65), (16., 7., 3.)];
        let run = recording(&[Walk::through(AgentId::Robot, &slalom)], 16.0, 0.1);
        let evidence = Evidence { location: Some(&place), goal: Some(Point::new(7., 3.)), ..Evidence::of(&run) };
        let of = |evidence: &Evidence<'_>| value_of(evidence, "path_irregularity").unwrap();
        let (with, without) = (of(&evidence), value(&run, "path_irregularity").unwrap());
        assert!(with < 0.05 && without > 0.15, "{with} {without}");
        // A weave on the way is irregular.
        let weave = [
            (0., -4., 0.),
            (2., -3., 1.6),
            (4., -1.5, 1.2),
            (5., -0.3, 2.35),
            (6., 0.3, 2.35),
            (10., 2.9, 0.65),
            (11., 3.5, 0.65),
            (16., 7., 3.),
        ];
        let run = recording(&[Walk::through(AgentId::Robot, &weave)], 16.0, 0.1);
        assert!(of(&Evidence { recording: &run, ..evidence }) > with + 0.1);
    }

    #[test]
    fn a_detour_costs_its_share_of_spl() {
        let place = floor(&[], &[], &[]);
        // 3 m and 4 m instead of 5 m.
        let walk = Walk::through(AgentId::Robot, &[(0., 0., 0.), (3., 3., 0.), (7., 3., 4.)]);
        let mut run = recording(&[walk], 7.0, 0.1);
        event(&mut run, 7.0, EventKind::RobotArrived);
        let evidence = Evidence { location: Some(&place), ..Evidence::of(&run) };
        let spl = value_of(&evidence, "spl").unwrap();
        assert!((spl - 5.0 / 7.0).abs() < 0.05, "{spl}");
        // 7 s for 5 m at a nominal 0.8 m/s, and a right angle that only the goal's direction asks for in part.
        let late = value_of(&evidence, "time_over_ideal").unwrap();
        assert!((late - 7.0 * 0.8 / 5.0).abs() < 0.08, "{late}");
        assert_eq!(value(&run, "time_over_ideal"), None);
        let turned = value_of(&evidence, "turning_excess").unwrap();
        assert!((turned - std::f64::consts::FRAC_PI_2).abs() < 0.3, "{turned}");
        assert_eq!(value(&run, "spl"), None);
        assert!((value(&run, "path_length_ratio").unwrap() - 1.4).abs() < 1e-6);
    }
}
