//! Regulated Pure Pursuit (Macenski et al. 2023): steers at a point ahead on the path, and slows down in bends, near obstacles and
//! before the goal.

use socrates_model::geometry::wrap_angle;
use socrates_model::{Point, Pose, RobotModel};

use crate::controller::{Controller, Following, NoControl, Twist};
use crate::costmap::{FREE, MOST, UNKNOWN};
use crate::nav::touches;

/// Parameters of the controller; defaults are Nav2's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RppParams {
    /// Length of a cycle, s; default 0.05.
    pub period_s: f64,
    /// Speed on a free straight way, m/s; default 0.5.
    pub desired_linear_vel: f64,
    /// The point it steers at is so far ahead, m; default 0.6. Not used while `use_velocity_scaled_lookahead_dist`.
    pub lookahead_dist: f64,
    /// It is so far ahead at least, m; default 0.3.
    pub min_lookahead_dist: f64,
    /// And so far at most, m; default 0.9.
    pub max_lookahead_dist: f64,
    /// It is as far ahead as the robot goes in this time, s; default 1.5.
    pub lookahead_time: f64,
    /// Whether the distance goes by the speed; default true (Nav2 false: a fixed 0.6 m).
    pub use_velocity_scaled_lookahead_dist: bool,
    /// Whether bends are taken more slowly; default true.
    pub use_regulated_linear_velocity_scaling: bool,
    /// Those tighter than this radius are, m; default 0.9.
    pub regulated_linear_scaling_min_radius: f64,
    /// But not more slowly than this, m/s; default 0.25.
    pub regulated_linear_scaling_min_speed: f64,
    /// Whether obstacles are passed more slowly; default true.
    pub use_cost_regulated_linear_velocity_scaling: bool,
    /// Those nearer than this are, m; default 0.6.
    pub cost_scaling_dist: f64,
    /// Speed there as a multiple of the distance's share; default 1.
    pub cost_scaling_gain: f64,
    /// How costs fall with the distance in the costmap, 1/m, to tell the distance from them; default 3.
    pub inflation_cost_scaling_factor: f64,
    /// Inscribed radius of the robot, m; default 0.22.
    pub robot_radius: f64,
    /// So near to the end of the path it slows down, m; default 0.6.
    pub approach_velocity_scaling_dist: f64,
    /// But not more than to this, m/s; default 0.05.
    pub min_approach_linear_velocity: f64,
    /// Whether it turns on the spot: to a point far to the side, and to the goal's heading; default true.
    pub use_rotate_to_heading: bool,
    /// A point more than this to the side is turned to, rad; default 0.785.
    pub rotate_to_heading_min_angle: f64,
    /// At this speed, rad/s; default 1.8.
    pub rotate_to_heading_angular_vel: f64,
    /// So near to the goal it turns to the goal's heading, m; default 0.25.
    pub xy_goal_tolerance: f64,
    /// Whether it stops before obstacles; default true.
    pub use_collision_detection: bool,
    /// It does where it would hit something within this time, s; default 1.
    pub max_allowed_time_to_collision_up_to_carrot: f64,
    /// Largest acceleration, m/s²; default 2.5.
    pub max_linear_accel: f64,
    /// Largest acceleration of turning, rad/s²; default 3.2.
    pub max_angular_accel: f64,
}

impl Default for RppParams {
    fn default() -> Self {
        Self {
            period_s: 0.05,
            desired_linear_vel: 0.5,
            lookahead_dist: 0.6,
            min_lookahead_dist: 0.3,
            max_lookahead_dist: 0.9,
            lookahead_time: 1.5,
            use_velocity_scaled_lookahead_dist: true,
            use_regulated_linear_velocity_scaling: true,
            regulated_linear_scaling_min_radius: 0.9,
            regulated_linear_scaling_min_speed: 0.25,
            use_cost_regulated_linear_velocity_scaling: true,
            cost_scaling_dist: 0.6,
            cost_scaling_gain: 1.0,
            inflation_cost_scaling_factor: 3.0,
            robot_radius: 0.22,
            approach_velocity_scaling_dist: 0.6,
            min_approach_linear_velocity: 0.05,
            use_rotate_to_heading: true,
            rotate_to_heading_min_angle: 0.785,
            rotate_to_heading_angular_vel: 1.8,
            xy_goal_tolerance: 0.25,
            use_collision_detection: true,
            max_allowed_time_to_collision_up_to_carrot: 1.0,
            max_linear_accel: 2.5,
            max_angular_accel: 3.2,
        }
    }
}

impl RppParams {
    /// The same with the body and the limits of a robot.
    #[must_use]
    pub fn with_robot(self, robot: &RobotModel) -> Self {
        Self {
            desired_linear_vel: robot.v_max_mps,
            rotate_to_heading_angular_vel: self.rotate_to_heading_angular_vel.min(robot.omega_max_radps),
            max_linear_accel: self.max_linear_accel.min(robot.a_max_mps2),
            robot_radius: robot.radius_m,
            ..self
        }
    }
}

/// The controller. It keeps nothing between cycles.
#[derive(Debug, Clone, Copy, Default)]
pub struct RegulatedPurePursuit {
    params: RppParams,
}

impl RegulatedPurePursuit {
    /// The controller.
    #[must_use]
    pub const fn new(params: &RppParams) -> Self {
        Self { params: *params }
    }

    fn lookahead_m(&self, speed: f64) -> f64 {
        let params = &self.params;
        if params.use_velocity_scaled_lookahead_dist {
            let far = speed.abs() * params.lookahead_time;
            far.max(params.min_lookahead_dist).min(params.max_lookahead_dist)
        } else {
            params.lookahead_dist
        }
    }

    /// The speed after bends and obstacles, m/s.
    fn regulated(&self, curvature: f64, cost: u8) -> f64 {
        let params = &self.params;
        let desired = params.desired_linear_vel;
        let mut speed = desired;
        let radius = if curvature.abs() > 1e-9 { 1.0 / curvature.abs() } else { f64::INFINITY };
        if params.use_regulated_linear_velocity_scaling && radius < params.regulated_linear_scaling_min_radius {
            speed = speed.min(desired * radius / params.regulated_linear_scaling_min_radius);
        }
        if params.use_cost_regulated_linear_velocity_scaling && cost != FREE && cost != UNKNOWN {
            // The inflation layer's formula solved for the distance to the obstacle.
            let share = f64::from(cost.min(MOST)) / f64::from(MOST);
            let away_m = params.robot_radius - libm::log(share) / params.inflation_cost_scaling_factor;
            if away_m < params.cost_scaling_dist {
                speed = speed.min(desired * params.cost_scaling_gain * away_m / params.cost_scaling_dist);
            }
        }
        speed.max(params.regulated_linear_scaling_min_speed.min(desired))
    }

    /// Turns on the spot.
    fn turn(&self, angle: f64, omega: f64) -> Twist {
        let params = &self.params;
        // Comes to rest at the heading.
        let stops = libm::sqrt(2.0 * params.max_angular_accel * angle.abs());
        let wanted = params.rotate_to_heading_angular_vel.min(stops);
        let wanted = if angle < 0.0 { -wanted } else { wanted };
        let change = params.max_angular_accel * params.period_s;
        Twist { omega: wanted.max(omega - change).min(omega + change), ..Twist::default() }
    }

    /// Whether going on like this hits something within the time looked ahead, up to the point steered at.
    fn hits(&self, cycle: &Following<'_>, twist: &Twist, carrot_m: f64) -> bool {
        let params = &self.params;
        if touches(cycle.costmap, &cycle.pose, cycle.footprint) {
            return true;
        }
        let cell_m = cycle.costmap.resolution_m();
        let turning = twist.vx.abs() < 0.01;
        // A step of one cell; of one cell at the rim of the robot where it turns on the spot.
        let step_s = if turning {
            cell_m / (params.robot_radius.max(cell_m) * twist.omega.abs().max(1e-3))
        } else {
            cell_m / twist.vx.abs()
        };
        let mut pose = cycle.pose;
        let mut time_s = step_s;
        while time_s <= params.max_allowed_time_to_collision_up_to_carrot {
            pose.x += twist.vx * step_s * libm::cos(pose.yaw);
            pose.y += twist.vx * step_s * libm::sin(pose.yaw);
            pose.yaw += twist.omega * step_s;
            if (pose.point() - cycle.pose.point()).norm() > carrot_m {
                return false;
            }
            if touches(cycle.costmap, &pose, cycle.footprint) {
                return true;
            }
            time_s += step_s;
        }
        false
    }
}

/// The point on a path at a distance from the robot: on the step that leaves the circle; the last pose of a path inside it.
fn carrot(plan: &[Pose], robot: &Point, distance_m: f64) -> Option<Point> {
    let away = |pose: &Pose| (pose.point() - robot).norm();
    let Some(place) = plan.iter().position(|pose| away(pose) >= distance_m) else {
        return plan.last().map(Pose::point);
    };
    let outer = plan.get(place)?.point();
    let Some(inner) = place.checked_sub(1).and_then(|before| plan.get(before)) else { return Some(outer) };
    // |inner + s way - robot| = distance, the root that leaves the circle.
    let (way, from) = (outer - inner.point(), inner.point() - robot);
    let (a, b, c) = (way.norm_squared(), from.dot(&way), from.norm_squared() - distance_m * distance_m);
    let root = b * b - a * c;
    let share = if a > 0.0 && root >= 0.0 { (libm::sqrt(root) - b) / a } else { 1.0 };
    Some(inner.point() + way * share.clamp(0.0, 1.0))
}

impl Controller for RegulatedPurePursuit {
    fn command(&mut self, cycle: &Following<'_>) -> Result<Twist, NoControl> {
        let params = &self.params;
        let at = cycle.pose.point();
        let lookahead_m = self.lookahead_m(cycle.speed.vx);
        let target = carrot(cycle.plan, &at, lookahead_m).ok_or(NoControl::NoPlan)?;
        let (sin, cos) = (libm::sin(cycle.pose.yaw), libm::cos(cycle.pose.yaw));
        let way = target - at;
        let (x, y) = (way.x * cos + way.y * sin, way.y * cos - way.x * sin);
        let carrot2 = x * x + y * y;
        let angle = libm::atan2(y, x);
        let end = cycle.plan.last().map_or(target, Pose::point);
        // A way that only passes the goal leads on.
        let near = |from: Point| (cycle.goal.point() - from).norm() < params.xy_goal_tolerance;
        let turns = params.use_rotate_to_heading;
        let twist = if turns && near(at) && near(end) {
            self.turn(wrap_angle(cycle.goal.yaw - cycle.pose.yaw), cycle.speed.omega)
        } else if turns && angle.abs() > params.rotate_to_heading_min_angle {
            self.turn(angle, cycle.speed.omega)
        } else {
            // Nearer than a millimeter there is no bend to speak of.
            let curvature = if carrot2 > 1e-6 { 2.0 * y / carrot2 } else { 0.0 };
            let mut speed = self.regulated(curvature, cycle.costmap.cost_at(&at));
            let end_m = (end - at).norm();
            if end_m < params.approach_velocity_scaling_dist {
                let approach = params.desired_linear_vel * end_m / params.approach_velocity_scaling_dist;
                speed = speed.min(approach.max(params.min_approach_linear_velocity));
            }
            speed *= cycle.speed_share.clamp(0.0, 1.0);
            let change = params.max_linear_accel * params.period_s;
            speed = speed.max(cycle.speed.vx - change).min(cycle.speed.vx + change).max(0.0);
            Twist { vx: speed, vy: 0.0, omega: speed * curvature }
        };
        let hits = params.use_collision_detection && self.hits(cycle, &twist, libm::sqrt(carrot2));
        if hits { Err(NoControl::Collision) } else { Ok(twist) }
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{Costmap, INSCRIBED};

    fn map() -> Costmap {
        Costmap::new(200, 200, 0.05, Point::new(-5.0, -5.0), FREE)
    }

    /// One cycle at 0.5 m/s from the origin.
    fn command(plan: &[Pose], goal: Pose, costmap: &Costmap, vx: f64) -> Result<Twist, NoControl> {
        command_of(RppParams::default(), plan, goal, costmap, vx)
    }

    /// The same of a controller with other parameters.
    fn command_of(
        params: RppParams,
        plan: &[Pose],
        goal: Pose,
        costmap: &Costmap,
        vx: f64,
    ) -> Result<Twist, NoControl> {
        let speed = Twist { vx, ..Twist::default() };
        let pose = Pose::new(0.0, 0.0, 0.0);
        let cycle = Following { pose, speed, plan, goal, costmap, footprint: &[], speed_share: 1.0 };
        RegulatedPurePursuit::new(&params).command(&cycle)
    }

    fn path(points: &[(f64, f64)]) -> Vec<Pose> {
        points.iter().map(|(x, y)| Pose::new(*x, *y, 0.0)).collect()
    }

    const FAR: Pose = Pose::new(9.0, 0.0, 0.0);

    #[test]
    fn on_a_straight_way_it_goes_straight_at_full_speed() {
        let twist = command(&path(&[(0.0, 0.0), (2.0, 0.0)]), FAR, &map(), 0.5).unwrap();
        assert_eq!(twist, Twist { vx: 0.5, vy: 0.0, omega: 0.0 });
    }

    #[test]
    fn it_steers_along_the_arc_to_the_point_ahead_and_slows_down_in_a_tight_bend() {
        let point = (0.75_f64.sqrt() * 0.75, 0.375);
        let twist = command(&path(&[point, (1.0, 1.0)]), FAR, &map(), 0.5).unwrap();
        let curvature = 2.0 * point.1 / (point.0 * point.0 + point.1 * point.1);
        assert!((twist.omega / twist.vx - curvature).abs() < 1e-9);
        assert!((twist.vx - 0.5 / (0.9 * curvature)).abs() < 1e-9, "{twist:?}");
    }

    #[test]
    fn near_an_obstacle_and_near_the_end_it_is_slower() {
        let straight = path(&[(0.0, 0.0), (2.0, 0.0)]);
        let mut map = map();
        // 0.4 m from an obstacle by the costmap's own formula.
        let cost = (252.0 * (-3.0_f64 * (0.4 - 0.22)).exp()) as u8;
        map.set(100, 100, cost);
        let twist = command(&straight, FAR, &map, 0.3).unwrap();
        assert!((twist.vx - 0.5 * 0.4 / 0.6).abs() < 0.005, "{twist:?}");
        let near = path(&[(0.0, 0.0), (0.3, 0.0)]);
        let twist = command(&near, Pose::new(0.3, 0.0, 0.0), &map, 0.3).unwrap();
        assert!((twist.vx - 0.25).abs() < 1e-9, "{twist:?}");
    }

    #[test]
    fn it_turns_on_the_spot_to_a_way_behind_and_to_the_heading_of_the_goal() {
        let behind = command(&path(&[(0.0, 0.0), (-2.0, 0.5)]), FAR, &map(), 0.0).unwrap();
        assert!(behind.vx == 0.0 && (behind.omega - 0.16).abs() < 1e-9, "{behind:?}");
        let at_goal = command(&path(&[(0.0, 0.0), (0.1, 0.0)]), Pose::new(0.1, 0.0, -1.0), &map(), 0.0).unwrap();
        assert!(at_goal.vx == 0.0 && at_goal.omega < -0.1, "{at_goal:?}");
    }

    #[test]
    fn it_has_no_command_where_it_would_hit_something_within_a_second() {
        let straight = path(&[(0.0, 0.0), (2.0, 0.0)]);
        let hits = |x: f64| {
            let mut map = map();
            let (column, _) = map.cell(&Point::new(x, 0.0)).unwrap();
            (0..200).for_each(|row| map.set(column, row, INSCRIBED));
            command(&straight, FAR, &map, 0.5)
        };
        assert_eq!(hits(0.42), Err(NoControl::Collision));
        assert!(hits(0.62).is_ok());
        assert_eq!(command(&[], FAR, &map(), 0.5), Err(NoControl::NoPlan));
    }

    #[test]
    fn the_point_ahead_is_where_the_path_leaves_the_circle() {
        let at = Point::new(0.0, 0.0);
        let found = carrot(&path(&[(0.0, 0.0), (0.3, 0.4), (0.3, 2.0)]), &at, 1.0).unwrap();
        assert!((found.coords.norm() - 1.0).abs() < 1e-9 && (found.x - 0.3).abs() < 1e-12 && found.y > 0.4);
        assert_eq!(carrot(&path(&[(0.1, 0.0), (0.2, 0.0)]), &at, 1.0), Some(Point::new(0.2, 0.0)));
        assert_eq!(carrot(&path(&[(3.0, 0.0)]), &at, 1.0), Some(Point::new(3.0, 0.0)));
    }

    #[test]
    fn each_of_its_habits_can_be_switched_off() {
        let straight = path(&[(0.0, 0.0), (2.0, 0.0)]);
        let mut walled = map();
        let (column, _) = walled.cell(&Point::new(0.42, 0.0)).unwrap();
        (0..200).for_each(|row| walled.set(column, row, INSCRIBED));
        let blind = RppParams { use_collision_detection: false, ..RppParams::default() };
        assert!(command_of(blind, &straight, FAR, &walled, 0.5).is_ok());
        let mut costly = map();
        costly.set(100, 100, 200);
        let bold = RppParams { use_cost_regulated_linear_velocity_scaling: false, ..RppParams::default() };
        assert!(command(&straight, FAR, &costly, 0.5).unwrap().vx < 0.45);
        assert!((command_of(bold, &straight, FAR, &costly, 0.5).unwrap().vx - 0.5).abs() < 1e-9);
        let bend = path(&[(0.6, 0.4), (1.0, 1.0)]);
        let quick = RppParams { use_regulated_linear_velocity_scaling: false, ..RppParams::default() };
        assert!(command(&bend, FAR, &map(), 0.5).unwrap().vx < 0.45);
        assert!((command_of(quick, &bend, FAR, &map(), 0.5).unwrap().vx - 0.5).abs() < 1e-9);
        let behind = path(&[(0.0, 0.0), (-2.0, 0.5)]);
        let turns = RppParams { use_rotate_to_heading: false, ..RppParams::default() };
        assert!(command_of(turns, &behind, FAR, &map(), 0.3).unwrap().vx > 0.0, "an arc instead of a turn on the spot");
    }
}
