//! `map`: locations.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::map;
use socrates_app::output::Printer;

use super::{Outcome, done};

/// Arguments of `map`.
#[derive(Debug, Args)]
pub(crate) struct Map {
    /// What to do.
    #[command(subcommand)]
    verb: MapVerb,
}

/// Verbs of `map`.
#[derive(Debug, Subcommand)]
enum MapVerb {
    /// List the shipped locations and their requests.
    List,
    /// Check a location: everything that is wrong with it, at once.
    Check {
        /// A shipped name or a folder.
        location: String,
    },
    /// Draw a location with its node ids.
    Draw {
        /// A shipped name or a folder.
        location: String,
        /// PNG or SVG file to write.
        #[arg(long, short, default_value = "map.png")]
        out: PathBuf,
    },
    /// Find rooms, doors and ways on a ROS map without a scene graph, and write a location folder with a picture.
    Annotate {
        /// A map file (map.yaml beside its image), or a folder with one.
        map: PathBuf,
        /// Folder to write; `<name>-annotated` by default. One that has a scene graph is left as it is.
        #[arg(long, short)]
        out: Option<PathBuf>,
        /// A point X,Y on the floor to annotate (map frame, m); by default the largest floor that hangs together.
        #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
        keep: Option<String>,
        /// Corners X,Y;X,Y;… of a polygon outside of which nothing is looked at (map frame, m).
        #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
        within: Option<String>,
        /// A point X,Y in a room that is the car of an elevator (map frame, m); once for each.
        #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
        elevator: Vec<String>,
    },
    /// Say how near the second annotation of a map comes to the first: nodes, edges, types, doors, detours, validity.
    Score {
        /// A shipped name or a folder: what counts as true.
        first: String,
        /// A shipped name, a folder, or a map without a scene graph, which is annotated.
        second: String,
    },
    /// Make a location folder from a floor plan (`plan.toml`), or from a plan drawn by a seed.
    Generate {
        /// The floor plan.
        #[arg(required_unless_present = "random", conflicts_with = "random")]
        plan: Option<PathBuf>,
        /// Draw a floor plan by this seed instead: the same seed and kind give the same files.
        #[arg(long, value_name = "SEED", requires = "kind")]
        random: Option<u64>,
        /// Kind of the drawn world: office, hospital, warehouse, hall or home.
        #[arg(long, requires = "random")]
        kind: Option<String>,
        /// Folder to write; for a drawn world `<kind>-<seed>` by default.
        #[arg(long, short, required_unless_present = "random")]
        out: Option<PathBuf>,
    },
}

impl Map {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(match &self.verb {
            MapVerb::List => map::list(talk),
            MapVerb::Check { location } => map::check(talk, location),
            MapVerb::Draw { location, out } => map::draw(talk, location, out),
            MapVerb::Annotate { map, out, keep, within, elevator } => {
                let options = map::AnnotateOptions {
                    out: out.clone(),
                    keep: keep.clone(),
                    within: within.clone(),
                    elevators: elevator.clone(),
                };
                map::annotate(talk, map, &options)
            }
            MapVerb::Score { first, second } => map::score(talk, first, second),
            MapVerb::Generate { plan, random, kind, out } => match (plan, random, kind, out) {
                (_, Some(seed), Some(kind), out) => map::random(talk, *seed, kind, out.as_deref()),
                (Some(plan), _, _, Some(out)) => map::generate(talk, plan, out),
                // The parser refuses every other combination.
                _ => Ok(()),
            },
        })
    }
}
