//! Every parameter of the stack.

use socrates_model::{Point, RobotModel};

use super::{GoalParams, PathParams, ProgressParams, RecoveryParams, SmootherParams, WaypointParams};
use crate::costmap::{CostmapParams, InflationParams, LayerParams, ObstacleParams, StaticParams};
use crate::navfn::NavFnParams;

/// All parameters of a [`Stack`](super::Stack). The defaults are the setup of the `SocRATES` case study, as its authors' files give
/// it; where those say nothing, Nav2's.
#[derive(Debug, Clone, PartialEq)]
pub struct StackParams {
    /// Commands per second; default 30.
    pub controller_frequency: f64,
    /// Plans per second; default 1, as in Nav2's tree for navigation.
    pub planner_frequency: f64,
    /// Scans per second; default 10. Layers see the latest one.
    pub scan_frequency: f64,
    /// So long the controller may have no command before that is an error, s; default 0.3.
    pub failure_tolerance: f64,
    /// Measured speeds below these read as 0: forward, to the left, m/s, turning, rad/s; default 0.001, 0, 0.001.
    pub least_speeds: [f64; 3],
    /// Radius of a round robot, and the inscribed radius of any other, m; default 0.22.
    pub robot_radius: f64,
    /// Outline of the robot in its own frame, m; default none: a disc.
    pub footprint: Vec<Point>,
    /// The map that plans are made on: the whole location; default walls, lidar, inflation of 0.25 m, once a second.
    pub global_costmap: CostmapParams,
    /// The map that the controller sees: a window that goes with the robot; default 15 x 15 m, lidar, inflation of 0.5 m, 30 Hz.
    pub local_costmap: CostmapParams,
    /// The planner.
    pub navfn: NavFnParams,
    /// How far the controller sees the path.
    pub path: PathParams,
    /// When the goal is reached.
    pub goal: GoalParams,
    /// When the robot is stuck.
    pub progress: ProgressParams,
    /// The list of waypoints.
    pub waypoints: WaypointParams,
    /// Limits of speed after the controller; they cap it at 0.5 m/s.
    pub smoother: SmootherParams,
    /// What is done when stuck.
    pub recovery: RecoveryParams,
}

impl Default for StackParams {
    fn default() -> Self {
        Self {
            controller_frequency: 30.0,
            planner_frequency: 1.0,
            scan_frequency: 10.0,
            failure_tolerance: 0.3,
            least_speeds: [0.001, 0.0, 0.001],
            robot_radius: 0.22,
            footprint: Vec::new(),
            global_costmap: global(inflation(0.25)),
            local_costmap: CostmapParams {
                width_m: 15.0,
                height_m: 15.0,
                resolution_m: 0.05,
                update_frequency_hz: 30.0,
                ..local(inflation(0.5))
            },
            navfn: NavFnParams::default(),
            path: PathParams::default(),
            goal: GoalParams::default(),
            progress: ProgressParams::default(),
            waypoints: WaypointParams::default(),
            smoother: SmootherParams::default(),
            recovery: RecoveryParams::default(),
        }
    }
}

/// Inflation as Nav2's shipped files have it, but for the radius.
const fn inflation(inflation_radius: f64) -> InflationParams {
    InflationParams { inflation_radius, cost_scaling_factor: 3.0, inflate_unknown: false }
}

fn global(inflation: InflationParams) -> CostmapParams {
    CostmapParams {
        update_frequency_hz: 1.0,
        track_unknown_space: true,
        layers: vec![
            LayerParams::Static(StaticParams::default()),
            LayerParams::Obstacle(ObstacleParams::default()),
            LayerParams::Inflation(inflation),
        ],
        ..CostmapParams::default()
    }
}

fn local(inflation: InflationParams) -> CostmapParams {
    CostmapParams {
        rolling_window: true,
        layers: vec![LayerParams::Obstacle(ObstacleParams::default()), LayerParams::Inflation(inflation)],
        ..CostmapParams::default()
    }
}

impl StackParams {
    /// The same with the body and the limits of a robot.
    #[must_use]
    pub fn with_robot(mut self, robot: &RobotModel) -> Self {
        let (v, a, omega) = (robot.v_max_mps, robot.a_max_mps2, robot.omega_max_radps);
        self.robot_radius = robot.radius_m;
        let side = robot.vy_max_mps;
        self.smoother.max_velocity = [v, side, omega];
        self.smoother.min_velocity = [robot.v_min_mps, -side, -omega];
        let [_, _, turning] = self.smoother.max_accel;
        self.smoother.max_accel = [a, a, turning];
        self.smoother.max_decel = [-a, -a, -turning];
        self
    }

    /// A setup for baselines, after Nav2's shipped files: 20 commands a second, costs up to 0.7 m from obstacles, a window of 6 m
    /// at 10 Hz. No way leads over unknown cells, where nobody walks either.
    #[must_use]
    pub fn shipped(robot: &RobotModel) -> Self {
        let params = Self {
            controller_frequency: 20.0,
            global_costmap: global(inflation(0.7)),
            local_costmap: CostmapParams {
                width_m: 6.0,
                height_m: 6.0,
                resolution_m: 0.05,
                update_frequency_hz: 10.0,
                ..local(inflation(0.7))
            },
            navfn: NavFnParams { allow_unknown: false, ..NavFnParams::default() },
            ..Self::default()
        };
        params.with_robot(robot)
    }
}
