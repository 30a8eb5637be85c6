//! The command line, word by word.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::again::ScoreOptions;

/// From a few sentences and a map to a social-navigation scenario that is simulated, checked and scored.
#[derive(Debug, Parser)]
#[command(
    name = "socrates",
    version,
    about,
    disable_help_subcommand = true,
    after_help = "First time? Run `socrates demo`."
)]
pub(crate) struct Cli {
    /// How results are printed; with json the last line of standard output is one object.
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Configuration.
    #[command(flatten)]
    pub(crate) flags: Flags,
    /// What to do.
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Where the configuration comes from; child processes get the same.
#[derive(Debug, Clone, Args)]
pub(crate) struct Flags {
    /// Configuration file; default `socrates.toml` in the current folder, if there is one.
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// One configuration value, such as `--set supervisor.workers=2`; may be repeated.
    #[arg(long, global = true, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run a shipped request, with nothing to prepare.
    Demo(RunOptions),
    /// Write a commented request file.
    New {
        /// File to write.
        file: PathBuf,
        /// Location: a shipped name or a folder.
        #[arg(long, default_value = "office")]
        location: String,
    },
    /// Print how a request is read, and run nothing.
    Read {
        /// Request file.
        request: PathBuf,
    },
    /// Make scenarios from requests: propose, simulate, check, score.
    Run {
        /// Request files, or folders of them.
        #[arg(required = true)]
        requests: Vec<PathBuf>,
        /// Options.
        #[command(flatten)]
        options: RunOptions,
    },
    /// Open the page of a bundle.
    Open {
        /// Bundle folder.
        bundle: PathBuf,
    },
    /// Write the page of a bundle anew, or one page for a folder of bundles.
    Report {
        /// Bundle folder, or a folder that holds bundles.
        what: PathBuf,
    },
    /// Film a bundle, seen from above: MP4 or WebM with ffmpeg, GIF or animated SVG without.
    Video(crate::video::VideoOptions),
    /// Draw a figure for a paper: who went where and when.
    Figure(crate::figure::FigureOptions),
    /// Print what a paper says about how a bundle was made, and what to cite.
    Cite {
        /// Bundle folder.
        bundle: PathBuf,
    },
    /// Add up what the authors of bundles were asked, in calls, tokens and money.
    Cost {
        /// Bundle folders, or folders that hold bundles.
        #[arg(required = true)]
        what: Vec<PathBuf>,
        /// Table of prices (TOML, a table per model); default: `author.prices` of the configuration.
        #[arg(long, value_name = "FILE")]
        prices: Option<PathBuf>,
    },
    /// Let people label runs by hand.
    Labels {
        /// What to do.
        #[command(subcommand)]
        verb: crate::labels::LabelsVerb,
    },
    /// Simulate a bundle again and compare the recording hashes, or run a HuNavSim agents file.
    Simulate(SimulateOptions),
    /// Score a bundle again, or tracks of your own (CSV with `t,id,x,y[,yaw,gesture]`, or MCAP).
    Score(ScoreOptions),
    /// Watch the agent states of a run that is being made.
    Watch {
        /// Its bundle folder, or a zenoh endpoint such as `tcp/127.0.0.1:7447`.
        what: String,
        /// Run name; default: the first that is announced.
        #[arg(long)]
        run: Option<String>,
    },
    /// Show how the scenarios of a folder stand, while they are made and afterwards.
    Status {
        /// Bundle or library folder, a folder of bundles, or a zenoh endpoint.
        what: String,
        /// List those of which no bundle could be made, with the reason.
        #[arg(long)]
        failed: bool,
        /// List every scenario with what its stages did.
        #[arg(long)]
        all: bool,
    },
    /// Explain a fault code, such as G-DISC, a metric, or a word of output, pages and tables; without one, list the codes.
    Explain {
        /// Fault code, metric such as `ttc_min`, or word such as `encounter gap`; `metrics` and `words` list all of them.
        code: Vec<String>,
    },
    /// Check what this machine can do, and say what is missing.
    Doctor,
    /// Print the effective configuration and where each value comes from.
    Config {
        /// Only this part, such as `author`.
        part: Option<String>,
    },
    /// Check, draw and convert behavior trees (BehaviorTree.CPP XML).
    Bt {
        /// What to do.
        #[command(subcommand)]
        verb: BtVerb,
    },
    /// Check, draw and generate locations.
    Map {
        /// What to do.
        #[command(subcommand)]
        verb: MapVerb,
    },
    /// Measure authors: how often scenarios are right at first, after asking again, and in the run.
    Evaluate {
        /// What to evaluate.
        #[command(subcommand)]
        verb: crate::evaluate::EvaluateVerb,
    },
    /// Take out of a library what others can use.
    Library {
        /// What to do.
        #[command(subcommand)]
        verb: crate::chat::LibraryVerb,
    },
    /// List, show and rate the canonical scenarios of the catalog.
    Scenarios {
        /// What to do.
        #[command(subcommand)]
        verb: ScenariosVerb,
    },
    /// The same parts spread over machines.
    Cluster {
        /// What to do.
        #[command(subcommand)]
        verb: ClusterVerb,
    },
    /// For developers of SocRATES.
    Dev {
        /// What to do.
        #[command(subcommand)]
        verb: DevVerb,
    },
    /// One worker process; started by `run` and `cluster worker`.
    #[command(hide = true)]
    Worker(WorkerOptions),
    /// The orchestrator process; started by `run` and `cluster up`.
    #[command(hide = true)]
    Orchestrator(OrchestratorOptions),
}

impl Verb {
    /// Whether this process is the child of a supervisor.
    pub(crate) const fn is_tied(&self) -> bool {
        matches!(self, Self::Worker(WorkerOptions { tied: true, .. }))
            || matches!(self, Self::Orchestrator(OrchestratorOptions { tied: true, .. }))
    }
}

/// Verbs on the catalog.
#[derive(Debug, Subcommand)]
pub(crate) enum ScenariosVerb {
    /// List every scenario.
    List,
    /// Show the card of a scenario.
    Show {
        /// Its id, or the letter of a canonical one.
        id: String,
    },
    /// Play scenarios with the reference robot and count how often each is realised.
    Rate {
        /// Ids or letters; all of them where none is named.
        ids: Vec<String>,
        /// Seeds 1 to N for each.
        #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
        seeds: u64,
        /// A location for all of them; default: the shipped ones that fit, in turn.
        #[arg(long)]
        location: Option<String>,
        /// Markdown file for the table.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
}

/// Options of `run` and `demo`.
#[derive(Debug, Clone, Args)]
pub(crate) struct RunOptions {
    /// Folder for the bundle; default `runs/<name>`. With several scenarios: the folder that holds them.
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Base seed of authoring and simulation.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Simulation seeds, `1..20` or `1,4,9`; wins over the request.
    #[arg(long)]
    pub(crate) seeds: Option<String>,
    /// Planners under test, separated by commas; wins over the request.
    #[arg(long, value_delimiter = ',')]
    pub(crate) planner: Vec<String>,
    /// Scenarios to make from each request; wins over the request.
    #[arg(long)]
    pub(crate) variants: Option<u32>,
    /// Author: `auto`, `offline`, `openai:MODEL`, `anthropic:MODEL`, `gemini:MODEL`, `vllm:`, `ollama:`, `llamacpp:` or
    /// `lmstudio:MODEL`, `cassette:FOLDER`, `record:FOLDER=AUTHOR`, `replay:FOLDER=AUTHOR`; wins over the request.
    #[arg(long)]
    pub(crate) author: Option<String>,
    /// Pace of the simulation: `max`, or simulated seconds per second.
    #[arg(long, default_value = "max")]
    pub(crate) pace: String,
    /// Exit with 3 unless the verdict is at least this.
    #[arg(long, value_parser = ["realised", "any"], default_value = "realised")]
    pub(crate) require: String,
    /// Worker processes of the simulation stage.
    #[arg(long)]
    pub(crate) workers: Option<u32>,
    /// Faults put into the author's answers, for experiments: `gdisc=0.3,bxml=0.1,first_only=true`; each number is
    /// a probability per ask.
    #[arg(long, value_name = "KIND=RATE,…", default_value = "")]
    pub(crate) inject: String,
    /// Look at the proposal, then at paths and behaviors, before they go on: accept, change in words, edit, have made again.
    #[arg(long)]
    pub(crate) ask: bool,
}

/// Options of `simulate`.
#[derive(Debug, Clone, Args)]
pub(crate) struct SimulateOptions {
    /// Bundle folder, or an agents file (`*.yaml`).
    pub(crate) what: PathBuf,
    /// Seed: another than the bundle's own; for an agents file the draws of behaviors, default 1.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Folder for what is recorded; default: nothing is written for a bundle, `runs/<name>` for an agents file.
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Bundle: only this planner.
    #[arg(long)]
    pub(crate) planner: Option<String>,
    /// Agents file: map (map_server YAML), location folder, or shipped location; without one the floor is open.
    #[arg(long)]
    pub(crate) map: Option<String>,
    /// Agents file: `native`, `socrates-fork`, `hunav-1.0`, `hunav-1.1`, `hunav-2.0`. Default: native.
    #[arg(long)]
    pub(crate) profile: Option<String>,
    /// Agents file: length of the run, s.
    #[arg(long, default_value_t = 60.0)]
    pub(crate) duration: f64,
    /// Agents file: a robot that stands at x,y,yaw or drives on through more points: `0,0,0;5,0;5,3`.
    #[arg(long, value_name = "X,Y,YAW[;X,Y…]", allow_hyphen_values = true)]
    pub(crate) robot: Option<String>,
    /// Agents file: who moves an agent: `2=orca`, `social-forces`, or `track`; may be repeated.
    #[arg(long, value_name = "ID=MODEL")]
    pub(crate) model: Vec<String>,
    /// Agents file: recorded tracks (CSV with `t,id,x,y`) of people who are replayed.
    #[arg(long)]
    pub(crate) tracks: Option<PathBuf>,
    /// Agents file: folder of the behavior trees it names; default: beside it.
    #[arg(long)]
    pub(crate) trees: Option<PathBuf>,
}

impl RunOptions {
    /// What a run is asked for that is asked for nothing, with this seed.
    pub(crate) fn plain(seed: u64) -> Self {
        Self {
            out: None,
            seed,
            seeds: None,
            planner: Vec::new(),
            variants: None,
            author: None,
            pace: "max".to_owned(),
            require: "any".to_owned(),
            workers: None,
            inject: String::new(),
            ask: false,
        }
    }
}

/// Verbs of `bt`.
#[derive(Debug, Subcommand)]
pub(crate) enum BtVerb {
    /// Read trees, tick every case of their conditions, and say what is wrong, with line and column.
    Check {
        /// XML files.
        #[arg(required = true)]
        trees: Vec<PathBuf>,
        /// Whose nodes: `native`, `socrates-fork`, `hunav-1.0`, `hunav-1.1`, `hunav-2.0`.
        #[arg(long, default_value = "native")]
        library: String,
    },
    /// Draw a tree as text, or as SVG or PNG.
    Show {
        /// XML file.
        tree: PathBuf,
        /// SVG or PNG file to write.
        #[arg(long, short)]
        out: Option<PathBuf>,
        /// Whose nodes; default: the first library that knows them all.
        #[arg(long)]
        library: Option<String>,
    },
    /// Write a tree in the other XML version or for another simulator, with a note for what changes meaning.
    Convert {
        /// XML file.
        tree: PathBuf,
        /// `v3` or `v4`.
        #[arg(long, value_parser = ["v3", "v4"])]
        to: String,
        /// Whose nodes it is read with; default: the first library that knows them all.
        #[arg(long)]
        library: Option<String>,
        /// Simulator it is written for; default: as it is read.
        #[arg(long = "for")]
        target: Option<String>,
        /// File to write; default: standard output.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
}

/// Verbs of `map`.
#[derive(Debug, Subcommand)]
pub(crate) enum MapVerb {
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
    /// Make a location folder from a floor plan (`plan.toml`).
    Generate {
        /// The floor plan.
        plan: PathBuf,
        /// Folder to write.
        #[arg(long, short)]
        out: PathBuf,
    },
}

/// Verbs of `cluster`.
#[derive(Debug, Subcommand)]
pub(crate) enum ClusterVerb {
    /// Start the orchestrator and listen for workers.
    Up(OrchestratorOptions),
    /// Serve stages on this machine.
    Worker(WorkerOptions),
    /// Hand requests to a running orchestrator and return.
    Submit {
        /// Request files, or folders of them.
        #[arg(required = true)]
        requests: Vec<PathBuf>,
        /// Endpoint of the orchestrator.
        #[arg(long)]
        connect: String,
        /// Namespace.
        #[arg(long, default_value = "main")]
        namespace: String,
        /// Base seed.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
}

/// Verbs of `dev`.
#[derive(Debug, Subcommand)]
pub(crate) enum DevVerb {
    /// Ask a model's server one small question that tells how far it enforces the form of an answer.
    Probe {
        /// Author, such as `ollama:MODEL`.
        author: String,
    },
    /// Count the tokens that a scenario of two people costs a model, by style, and time our own part of a call.
    Tokens {
        /// Folder for the questions as they are sent, and the picture of the map.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Print the JSON schema of an artifact.
    Schema {
        /// `request`, `reading`, `proposal`, `paths`, `behaviors`, `report`, `location`, `clause`.
        artifact: String,
    },
    /// Read a file of the published SocRATES tool and print what it holds.
    Import {
        /// Scenario, trajectory, tree or combined JSON.
        file: PathBuf,
    },
    /// Write a bundle as the published tool's stage files.
    Export {
        /// Bundle folder.
        bundle: PathBuf,
        /// Folder to write.
        #[arg(long, short)]
        out: PathBuf,
    },
    /// Run a crowd scene by the reference social forces, for comparison with the original library.
    SfmTrace {
        /// Scene (JSON).
        scene: PathBuf,
        /// Trajectory to write: `step,id,x,y,vx,vy,yaw,goals_reached`.
        #[arg(long, short)]
        out: PathBuf,
        /// Forces to write, where wanted.
        #[arg(long)]
        forces: Option<PathBuf>,
    },
    /// Tick a behavior tree with scripted leaves, for comparison with BehaviorTree.CPP.
    BtTrace {
        /// XML file.
        tree: PathBuf,
        /// Script: `{"ticks":[{"leaf":"SUCCESS"}]}`.
        script: PathBuf,
        /// Status of every node after every tick.
        #[arg(long, short)]
        out: PathBuf,
        /// Leaf ticks, halts and what the root gave.
        #[arg(long)]
        events: PathBuf,
    },
    /// Check a HuNavSim agents file, and write it in the form of another version.
    Agents {
        /// Agents file.
        file: PathBuf,
        /// Version to write: `1.0` (also the SocRATES fork), `1.1`, `2.0`.
        #[arg(long, value_parser = ["1.0", "1.1", "2.0"])]
        to: Option<String>,
        /// File to write; default: standard output.
        #[arg(long, short)]
        out: Option<PathBuf>,
    },
    /// Calibrate the judge: share of spoiled runs that it refuses and of harmless changes that it lets pass.
    Mutations {
        /// Request files or folders of them; default: every request of the shipped locations.
        requests: Vec<PathBuf>,
        /// Seeds of each scenario.
        #[arg(long, default_value_t = 2)]
        seeds: u64,
        /// Print every mutant and not only what went wrong.
        #[arg(long)]
        all: bool,
    },
    /// Compare labels that people gave to runs with the verdicts: Cohen's kappa, Krippendorff's alpha.
    Agreement {
        /// Labels (CSV): `run,rater,simulable,appropriate,as_asked`, yes or no.
        labels: PathBuf,
        /// Bundles that hold the runs.
        #[arg(required = true)]
        bundles: Vec<PathBuf>,
    },
    /// Print the recording hash of each shipped request, each canonical scenario and these agents files, for two seeds.
    Golden {
        /// HuNavSim agents files.
        agents: Vec<PathBuf>,
    },
    /// Let damaged inputs in at every door: each must be read or refused with the name of its file.
    Fuzz(crate::fuzz::FuzzOptions),
    /// Measure the main job on this machine.
    Bench {
        /// Runs to take the median of.
        #[arg(long, default_value_t = 9)]
        runs: u32,

        /// Make a library of at least so many scenarios of all shipped requests instead: CPU, memory, growth.
        #[arg(long, value_name = "SCENARIOS", conflicts_with = "runs")]
        library: Option<u32>,
    },
}

/// Options of one worker process.
#[derive(Debug, Clone, Args)]
pub(crate) struct WorkerOptions {
    /// Stage it serves.
    pub(crate) stage: String,
    /// Endpoint of the orchestrator's router.
    #[arg(long)]
    pub(crate) connect: String,
    /// Namespace.
    #[arg(long, default_value = "main")]
    pub(crate) namespace: String,
    /// Artifact folder shared with the orchestrator; without it artifacts travel over the bus.
    #[arg(long)]
    pub(crate) blobs: Option<PathBuf>,
    /// Folder for reports that are not yet recorded.
    #[arg(long)]
    pub(crate) spool: PathBuf,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    pub(crate) tied: bool,
    /// Faults to inject, for experiments: `die_before_report=0.1,drop_report=0.05`.
    #[arg(long, default_value = "")]
    pub(crate) inject: String,
}

/// Options of the orchestrator process.
#[derive(Debug, Clone, Args)]
pub(crate) struct OrchestratorOptions {
    /// Folder of the job store and the artifacts; on a local disk.
    #[arg(long)]
    pub(crate) dir: PathBuf,
    /// Endpoint to listen on, such as `tcp/127.0.0.1:7447`; one that other machines can reach, such as `tcp/0.0.0.0:7447`,
    /// needs `--insecure`.
    #[arg(long)]
    pub(crate) listen: Option<String>,
    /// Listens where other machines can reach it: whoever does may hand in and read jobs, and join as a worker that
    /// returns any result. There is no password and no encryption.
    #[arg(long)]
    pub(crate) insecure: bool,
    /// Endpoint of a router to use instead of listening.
    #[arg(long)]
    pub(crate) connect: Option<String>,
    /// Namespace.
    #[arg(long, default_value = "main")]
    pub(crate) namespace: String,
    /// What a commit outlives: `disk` (a power cut) or `process` (any signal; for workers on this machine alone).
    #[arg(long, default_value = "disk", value_parser = ["disk", "process"])]
    pub(crate) durable: String,
    /// Leave when standard input closes.
    #[arg(long, hide = true)]
    pub(crate) tied: bool,
    /// No worker of before is alive: what they held is handed out again at once.
    #[arg(long, hide = true)]
    pub(crate) alone: bool,
}
