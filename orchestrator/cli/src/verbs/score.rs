//! `score`.

use std::path::PathBuf;

use clap::Args;
use socrates_app::output::Printer;
use socrates_app::replay::{self, Group, ScoreOptions};
use socrates_model::Point;

use super::{Outcome, done};

/// Arguments of `score`: all but the first are for tracks of one's own.
#[derive(Debug, Clone, Args)]
pub(crate) struct Score {
    /// Bundle folder, CSV or MCAP file, or bag of ROS 2: its folder (with metadata.yaml) or its MCAP file.
    what: PathBuf,
    /// Location for tracks of your own: a shipped name or a folder.
    #[arg(long)]
    location: Option<String>,
    /// Goal of the robot on the map, m; default: columns `goal_x` and `goal_y`, the last of a bag's /goal_pose, or where the robot said that it arrived.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = replay::point)]
    goal: Option<Point>,
    /// Radius of the robot, m; default: as recorded, 0.25 for a CSV and for a bag that names none.
    #[arg(long, value_name = "M")]
    radius: Option<f64>,
    /// Nominal speed of the robot for STL, m/s; default: as recorded, 0.8 for a CSV or a bag.
    #[arg(long, value_name = "M/S")]
    speed: Option<f64>,
    /// People who belong together, such as `1+2,ped3+ped4`; default: the column `group`, the groups of HuNavSim.
    #[arg(long, value_delimiter = ',', value_parser = replay::group)]
    groups: Vec<Group>,
    /// Id of the robot in a table, such as `base_link` (default: `robot` or 0; all other ids are people); in a bag its topic or frame, such as /odom.
    #[arg(long, value_name = "ID")]
    robot: Option<String>,
    /// Topic of the people in a bag; default: HuNavSim's, else of people, else of poses that are called so.
    #[arg(long, value_name = "TOPIC")]
    people: Option<String>,
    /// Planner of the run that is meant, in a table of several runs; default: that of its first line.
    #[arg(long)]
    planner: Option<String>,
    /// Seed of the run that is meant, in a table of several runs.
    #[arg(long)]
    seed: Option<u64>,
    /// Folder for a page with a player and every metric as a table; of a bag also its tracks as a table.
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Score {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { what, location, goal, radius, speed, groups, robot, people, planner, seed, out } = self.clone();
        let options = ScoreOptions { what, location, goal, radius, speed, groups, robot, people, planner, seed, out };
        done(replay::score(talk, &options))
    }
}
