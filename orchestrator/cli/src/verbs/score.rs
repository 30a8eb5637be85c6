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
    /// Bundle folder, CSV or MCAP file.
    what: PathBuf,
    /// Location for tracks of your own: a shipped name or a folder.
    #[arg(long)]
    location: Option<String>,
    /// Goal of the robot on the map, m; default: columns `goal_x` and `goal_y`, or where it said that it arrived.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = replay::point)]
    goal: Option<Point>,
    /// Radius of the robot, m; default: as recorded, 0.25 for a CSV.
    #[arg(long, value_name = "M")]
    radius: Option<f64>,
    /// Nominal speed of the robot for STL, m/s; default: as recorded, 0.8 for a CSV.
    #[arg(long, value_name = "M/S")]
    speed: Option<f64>,
    /// People who belong together, such as `1+2,ped3+ped4`; default: the column `group`.
    #[arg(long, value_delimiter = ',', value_parser = replay::group)]
    groups: Vec<Group>,
    /// Id of the robot in a table, such as `base_link`; default: `robot` or 0. All other ids are people.
    #[arg(long, value_name = "ID")]
    robot: Option<String>,
    /// Planner of the run that is meant, in a table of several runs; default: that of its first line.
    #[arg(long)]
    planner: Option<String>,
    /// Seed of the run that is meant, in a table of several runs.
    #[arg(long)]
    seed: Option<u64>,
    /// Folder for a page with a player and every metric as a table.
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Score {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { what, location, goal, radius, speed, groups, robot, planner, seed, out } = self.clone();
        let options = ScoreOptions { what, location, goal, radius, speed, groups, robot, planner, seed, out };
        done(replay::score(talk, &options))
    }
}
