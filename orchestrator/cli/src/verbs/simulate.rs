//! `simulate`.

use std::path::PathBuf;

use clap::Args;
use socrates_app::agents::{self, SimulateOptions};
use socrates_app::output::Printer;
use socrates_app::replay;
use socrates_model::PlannerName;

use super::{Outcome, done};

/// Arguments of `simulate`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Simulate {
    /// Bundle folder, or an agents file (`*.yaml`).
    what: PathBuf,
    /// Seed: another than the bundle's own; for an agents file the draws of behaviors, default 1.
    #[arg(long)]
    seed: Option<u64>,
    /// Folder for what is recorded; default: nothing is written for a bundle, `runs/<name>` for an agents file.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Bundle: only this planner.
    #[arg(long)]
    planner: Option<PlannerName>,
    /// Agents file: map (map_server YAML), location folder, or shipped location; without one the floor is open.
    #[arg(long)]
    map: Option<String>,
    /// Agents file: `native`, `socrates-fork`, `hunav-1.0`, `hunav-1.1`, `hunav-2.0`. Default: native.
    #[arg(long)]
    profile: Option<String>,
    /// Agents file: length of the run, s.
    #[arg(long, default_value_t = 60.0)]
    duration: f64,
    /// Agents file: a robot that stands at x,y,yaw or drives on through more points: `0,0,0;5,0;5,3`.
    #[arg(long, value_name = "X,Y,YAW[;X,Y…]", allow_hyphen_values = true)]
    robot: Option<String>,
    /// Agents file: who moves an agent: `2=orca`, `social-forces`, or `track`; may be repeated.
    #[arg(long, value_name = "ID=MODEL")]
    model: Vec<String>,
    /// Agents file: recorded tracks (CSV with `t,id,x,y`) of people who are replayed; without `--robot`, 0 is the robot.
    #[arg(long)]
    tracks: Option<PathBuf>,
    /// Agents file: folder of the behavior trees it names; default: beside it.
    #[arg(long)]
    trees: Option<PathBuf>,
}

impl Simulate {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { what, seed, out, planner, map, profile, duration, robot, model, tracks, trees } = self.clone();
        if !agents::is_agents_file(&what) {
            return done(replay::simulate(talk, &what, planner.as_ref(), seed, out.as_ref()));
        }
        let options = SimulateOptions { what, seed, out, map, profile, duration, robot, model, tracks, trees };
        done(agents::simulate(talk, &options))
    }
}
