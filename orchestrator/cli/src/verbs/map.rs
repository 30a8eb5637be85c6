//! `map`: locations.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use socrates_app::build::{self, BuildOptions};
use socrates_app::config::Config;
use socrates_app::editor::{self, EditOptions};
use socrates_app::output::Printer;
use socrates_app::{graphs, map};

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
    /// Draw a location's scene graph and doors at a page in the browser, checked as you draw.
    Edit(Edit),
    /// Say how near the second annotation of a map comes to the first: nodes, edges, types, doors, detours, validity.
    Score {
        /// A shipped name or a folder: what counts as true.
        first: String,
        /// A shipped name, a folder, or a map without a scene graph, which is annotated.
        second: String,
    },
    /// Build a floor with the rooms, corridors and elevators that a brief asks for.
    Build {
        /// A brief (a .toml file), or a sentence: "a hospital with two wards, a lobby with two elevators".
        what: String,
        /// Language model that makes a brief of the sentence, such as openai:MODEL or console; without, rules of this program do.
        #[arg(long)]
        author: Option<String>,
        /// What the brief leaves open is drawn by this seed; the same brief and seed give the same files.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Folder to write. One that holds anything is left as it is.
        #[arg(long, short)]
        out: PathBuf,
    },
    /// Write a location in a format of others, with a list of what that format cannot hold beside it.
    Export {
        /// A shipped name or a folder.
        location: String,
        /// Format: node-link (SocRATES, networkx), nav2-route (GeoJSON of Nav2's route server), rmf (building.yaml of Open-RMF).
        #[arg(long, value_name = "FORMAT")]
        to: String,
        /// File to write; named by location and format by default.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
    /// Make a location folder from a file of another tool, with a list of what a location cannot hold in it.
    Import {
        /// The file.
        file: PathBuf,
        /// Format: node-link, nav2-route or rmf.
        #[arg(long, value_name = "FORMAT")]
        from: String,
        /// The map on which the graph was drawn: a map file or a folder with one; a building of rmf brings its own.
        #[arg(long)]
        map: Option<PathBuf>,
        /// Level of a building that has several.
        #[arg(long)]
        level: Option<String>,
        /// Folder to write. One that has a scene graph is left as it is.
        #[arg(long, short)]
        out: PathBuf,
    },
    /// Give an area a name that requests may use, such as `pharmacy` for a room.
    Name {
        /// A folder; a shipped name with `--out`.
        location: String,
        /// A node of the area (`map draw` shows the ids): its whole room where it lies in one; several joined by commas.
        area: String,
        /// The name, without an article.
        name: String,
        /// Folder for the named copy; by default the name is written into the location's own location.toml.
        #[arg(long, short)]
        out: Option<PathBuf>,
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

/// Arguments of `map edit`.
#[derive(Debug, Args)]
struct Edit {
    /// A folder, a map file (map.yaml beside its image), or a shipped name. A folder is edited where it is, of the others a copy.
    location: String,
    /// Edit a copy in this folder; for a map file or a shipped name `<name>-edited` by default.
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Only look: nothing is changed, and somebody else may edit the folder meanwhile.
    #[arg(long, conflicts_with = "fresh")]
    read_only: bool,
    /// Begin with the files as they are: what was drawn before and not saved is put aside.
    #[arg(long)]
    fresh: bool,
    /// Port of this machine; default any that is free.
    #[arg(long)]
    port: Option<u16>,
    /// Open a browser.
    #[arg(long)]
    open: bool,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    tied: bool,
}

impl Map {
    /// Whether this process is the child of another one that it leaves with.
    pub(super) const fn is_tied(&self) -> bool {
        matches!(self.verb, MapVerb::Edit(Edit { tied: true, .. }))
    }

    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
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
            MapVerb::Build { what, author, seed, out } => {
                let options =
                    BuildOptions { what: what.clone(), author: author.clone(), seed: *seed, out: out.clone() };
                build::build(talk, config, &options).await
            }
            MapVerb::Export { location, to, out } => graphs::export(talk, location, to, out.as_deref()),
            MapVerb::Import { file, from, map, level, out } => {
                let options = graphs::ImportOptions {
                    from: from.clone(),
                    map: map.clone(),
                    level: level.clone(),
                    out: out.clone(),
                };
                graphs::import(talk, file, &options)
            }
            MapVerb::Name { location, area, name, out } => graphs::name(talk, location, area, name, out.as_deref()),
            MapVerb::Edit(Edit { location, out, read_only, fresh, port, open, tied }) => {
                let options = EditOptions {
                    location: location.clone(),
                    out: out.clone(),
                    read_only: *read_only,
                    fresh: *fresh,
                    port: *port,
                    open: *open,
                    tied: *tied,
                };
                editor::edit(talk, &options).await
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
