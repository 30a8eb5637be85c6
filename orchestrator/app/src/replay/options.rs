//! Options of `score`.

use std::path::PathBuf;

/// Options of `score`: all but the first are for tracks of one's own.
#[derive(Debug, Clone)]
pub struct ScoreOptions {
    /// Bundle folder, CSV or MCAP file, or bag of ROS 2: its folder or its MCAP file.
    pub what: PathBuf,
    /// Location for tracks of your own: a shipped name or a folder.
    pub location: Option<String>,
    /// Goal of the robot on the map, m; default: columns `goal_x` and `goal_y`, the last of a bag's /goal_pose, or where the robot
    /// said that it arrived.
    pub goal: Option<socrates_model::Point>,
    /// Radius of the robot, m; default: as recorded, 0.25 for a CSV and for a bag that names none.
    pub radius: Option<f64>,
    /// Nominal speed of the robot for STL, m/s; default: as recorded, 0.8 for a CSV or a bag.
    pub speed: Option<f64>,
    /// People who belong together, such as `1+2,ped3+ped4`; default: the column `group`, the groups of HuNavSim.
    pub groups: Vec<super::tracks::Group>,
    /// Id of the robot in a table, such as `base_link`; default: `robot` or 0. All other ids are people. In a bag its topic or
    /// frame; default: HuNavSim's robot, else odometry, else `base_footprint` or `base_link`.
    pub robot: Option<String>,
    /// Topic of the people in a bag; default: HuNavSim's, else of people, else of poses that are called so.
    pub people: Option<String>,
    /// Planner of the run that is meant, in a table of several runs; default: that of its first line.
    pub planner: Option<String>,
    /// Seed of the run that is meant, in a table of several runs.
    pub seed: Option<u64>,
    /// Folder for a page with a player and every metric as a table.
    pub out: Option<PathBuf>,
}

impl ScoreOptions {
    /// Whether anything is said that a bundle knows by itself.
    pub const fn tells(&self) -> bool {
        self.location.is_some()
            || self.goal.is_some()
            || self.radius.is_some()
            || self.speed.is_some()
            || self.robot.is_some()
            || self.people.is_some()
            || self.planner.is_some()
            || self.seed.is_some()
            || self.out.is_some()
            || !self.groups.is_empty()
    }
}
