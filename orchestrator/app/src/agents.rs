//! `simulate AGENTS.yaml`: a HuNavSim agents file, run by our semantics or by those of its simulator.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_crowd::tracks::Tracks;
use socrates_hunav::{AgentsFile, Dialect, HumanModel, Inputs, Problem, Profile, RobotSpec, Severity};
use socrates_model::{Location, Point, Pose};

use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::prepare::{load_location, slug};
use crate::scribe::Scribe;
use crate::words::plural;

/// How an agents file is run.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// The agents file.
    pub what: PathBuf,
    /// Seed of the draws of behaviors; none for 1.
    pub seed: Option<u64>,
    /// Folder for what is recorded; none for `runs/<name>`.
    pub out: Option<PathBuf>,
    /// Map (map_server YAML), location folder, or shipped location; without one the floor is open.
    pub map: Option<String>,
    /// `native`, `socrates-fork`, `hunav-1.0`, `hunav-1.1`, `hunav-2.0`. Default: native.
    pub profile: Option<String>,
    /// Length of the run, s.
    pub duration: f64,
    /// A robot that stands at x,y,yaw or drives on through more points: `0,0,0;5,0;5,3`.
    pub robot: Option<String>,
    /// Model that moves an agent: `2=orca`, `social-forces`, or `track`; may be repeated.
    pub model: Vec<String>,
    /// Recorded tracks (CSV with `t,id,x,y`) of people who are replayed; 0 is the robot where neither file nor `robot` has one.
    pub tracks: Option<PathBuf>,
    /// Folder of the behavior trees it names; default: beside it.
    pub trees: Option<PathBuf>,
}

/// Largest agents file that is read, bytes.
const MAX_BYTES: u64 = 16 * 1024 * 1024;
/// Largest file of tracks that is read, bytes.
const MAX_TRACKS_BYTES: u64 = 1024 * 1024 * 1024;

/// Whether `simulate` is given an agents file, not a bundle.
pub fn is_agents_file(what: &Path) -> bool {
    what.extension().is_some_and(|ext| ext == "yaml" || ext == "yml") && !what.is_dir()
}

/// Runs an agents file and writes what happened.
pub fn simulate(talk: &Printer, options: &SimulateOptions) -> Result<(), Diagnostic> {
    let (file, agents) = read(&options.what)?;
    let profile: Profile = match &options.profile {
        Some(name) => name.parse().map_err(|why: socrates_hunav::BadProfile| Diagnostic::input(why.to_string(), ""))?,
        None => Profile::Native,
    };
    let location = options.map.as_deref().map(map).transpose()?;
    let folder = options
        .trees
        .clone()
        .or_else(|| options.what.parent().map(Path::to_path_buf))
        .unwrap_or_else(|| PathBuf::from("."));
    let trees = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let tracks = options.tracks.as_deref().map(tracks).transpose()?;
    let mut inputs = Inputs::new(&agents, &file);
    inputs.tracks = tracks.as_ref();
    inputs.grid = location.as_ref().map(|location| &location.grid);
    inputs.profile = profile;
    inputs.seed = options.seed.unwrap_or(1);
    inputs.duration_s = options.duration;
    // Number 0 of a recording is the robot, unless the file has somebody of this number.
    let replayed =
        tracks.as_ref().and_then(|tracks| tracks.get(0)).filter(|_| agents.agents.iter().all(|agent| agent.id != 0));
    inputs.robot = match &options.robot {
        Some(text) => Some(robot(text)?),
        None => replayed.cloned().map(RobotSpec::replaying),
    };
    inputs.trees = &trees;
    inputs.models = options.model.iter().map(|text| model(text)).collect::<Result<BTreeMap<_, _>, _>>()?;
    let problems = socrates_hunav::check(&inputs);
    let (errors, warnings): (Vec<Problem>, Vec<Problem>) =
        problems.into_iter().partition(|problem| problem.severity == Severity::Error);
    if !errors.is_empty() {
        return Err(listed(&file, &errors));
    }
    for warning in &warnings {
        talk.warn(&warning.to_string());
    }
    talk.line(&format!(
        "agents     {} of {} · profile {} · {}",
        plural(agents.agents.len(), "agent"),
        agents.dialect.name(),
        profile.name(),
        location.as_ref().map_or_else(|| "open floor".to_owned(), |location| format!("map {}", location.name)),
    ));
    let name = slug(&options.what.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default());
    let dir = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs").join(format!("{name}-{}-{}", profile.name(), inputs.seed)));
    let path = dir.join("recording.mcap");
    let mut scribe = Scribe::new(Some(&path), location.as_ref()).with_table(&dir.join("agents.csv"));
    socrates_hunav::simulate_into(&inputs, &mut scribe).map_err(|problems| listed(&file, &problems))?;
    let written = scribe.finish()?;
    let (last, contacts) = (written.last_s, written.contacts);
    let mut look = dir.join("agents.csv");
    if let Some(location) = &location {
        let title = format!("{name} · {} · {}", profile.name(), location.name);
        let bytes = files::bytes(&path, u64::MAX, "it was just written")?;
        let recording = socrates_stream::mcap::read(&bytes).map_err(|why| Diagnostic::input(why.to_string(), ""))?;
        let heading = socrates_draw::Heading { title: &title, asked: "" };
        let svg = socrates_draw::run_picture(location, &recording, None, None, heading);
        let png = socrates_draw::png_from_svg(&svg, 1.5).map_err(|why| Diagnostic::input(why.to_string(), ""))?;
        files::write(&dir.join("run.svg"), svg.as_bytes())?;
        look = dir.join("run.png");
        files::write(&look, &png)?;
    }
    talk.line(&format!("simulated  {last:.1} s, {}, recording {}", plural(contacts, "contact"), written.hash.short()));
    talk.line(&format!("look       {}", look.display()));
    talk.line(&format!("next       socrates score {}", dir.join("recording.mcap").display()));
    talk.result(&json!({
        "out": dir.display().to_string(), "agents": agents.agents.len(), "dialect": agents.dialect.name(),
        "profile": profile.name(), "seed": inputs.seed, "simulated_s": last, "contacts": contacts,
        "recording_hash": written.hash, "warnings": warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    }));
    Ok(())
}

/// Checks an agents file and writes it in the form of another version, with a note for what is lost.
pub fn convert(talk: &Printer, path: &Path, to: Option<&str>, out: Option<&Path>) -> Result<(), Diagnostic> {
    let (file, agents) = read(path)?;
    for warning in &agents.warnings {
        talk.warn(&warning.to_string());
    }
    let Some(to) = to else {
        talk.line(&format!("good       {file}: {} of {}", plural(agents.agents.len(), "agent"), agents.dialect.name()));
        talk.result(&json!({ "agents": agents.agents.len(), "dialect": agents.dialect.name() }));
        return Ok(());
    };
    let dialect = match to {
        "1.0" => Dialect::V1_0,
        "1.1" => Dialect::V1_1,
        _ => Dialect::V2_0,
    };
    let (converted, notes) = agents.converted(dialect);
    for note in &notes {
        talk.warn(&format!("note       {note}"));
    }
    let yaml = converted.to_yaml();
    files::write_or_say(talk, &yaml, out)?;
    talk.result(&json!({ "yaml": yaml, "dialect": dialect.name(), "notes": notes }));
    Ok(())
}

/// An agents file with its name in messages.
pub fn read(path: &Path) -> Result<(String, AgentsFile), Diagnostic> {
    let file = path.display().to_string();
    let text = files::text(path, MAX_BYTES, "name a HuNavSim agents file")?;
    let agents = AgentsFile::read(&text, &file).map_err(|problems| listed(&file, &problems))?;
    Ok((file, agents))
}

/// The problems of an agents file.
pub fn listed(file: &str, problems: &[Problem]) -> Diagnostic {
    let mut diagnostic = Diagnostic::input(
        format!("`{file}` has {}", plural(problems.len(), "problem")),
        "the README of `workers/simulation/hunav` describes agents files",
    );
    diagnostic.causes = problems.iter().map(ToString::to_string).collect();
    diagnostic
}

/// Recorded people.
fn tracks(path: &Path) -> Result<Tracks, Diagnostic> {
    let hint = "CSV with the columns t,id,x,y and, where known, yaw,vx,vy";
    let text = files::text(path, MAX_TRACKS_BYTES, hint)?;
    Tracks::read(&text).map_err(|why| {
        let mut diagnostic = Diagnostic::input(format!("`{}` cannot be replayed", path.display()), hint);
        diagnostic.causes = why.to_string().lines().map(|line| line.trim().to_owned()).collect();
        diagnostic
    })
}

/// A map_server file, a location folder, or a shipped location.
fn map(name: &str) -> Result<Location, Diagnostic> {
    if name.ends_with(".yaml") || name.ends_with(".yml") {
        return socrates_maps::load_map(Path::new(name)).map_err(|faults| {
            Diagnostic::faults(
                format!("the map `{name}` is not usable"),
                &faults,
                "`socrates explain CODE` says what to do",
            )
        });
    }
    load_location(name, Path::new(".")).map(|(location, _)| location)
}

/// `x,y,yaw` and more points to drive through.
fn robot(text: &str) -> Result<RobotSpec, Diagnostic> {
    let wrong = || {
        Diagnostic::input(
            format!("`--robot {text}` is no robot"),
            "write x,y,yaw and, where it drives, points: --robot \"0,0,0;5,0;5,3\" (m, rad)",
        )
    };
    let mut parts = text.split(';').map(|part| {
        part.split(',')
            .map(|number| number.trim().parse::<f64>().ok().filter(|n| n.is_finite()))
            .collect::<Option<Vec<_>>>()
    });
    let Some(Some(start)) = parts.next() else { return Err(wrong()) };
    let [x, y, yaw] = start[..] else { return Err(wrong()) };
    let mut spec = RobotSpec::standing(Pose { x, y, yaw });
    for part in parts {
        let Some(point) = part else { return Err(wrong()) };
        let [x, y] = point[..] else { return Err(wrong()) };
        spec.goals.push(Point::new(x, y));
    }
    Ok(spec)
}

/// `2=orca`.
fn model(text: &str) -> Result<(i64, HumanModel), Diagnostic> {
    let names: Vec<&str> = HumanModel::ALL.iter().map(|model| model.name()).collect();
    let wrong = || {
        Diagnostic::input(
            format!("`--model {text}` is no model of an agent"),
            format!("write ID=MODEL; models: {}", names.join(", ")),
        )
    };
    let (id, name) = text.split_once('=').ok_or_else(wrong)?;
    let id = id.trim().parse().map_err(|_digits| wrong())?;
    let model = HumanModel::ALL.into_iter().find(|model| model.name() == name.trim()).ok_or_else(wrong)?;
    Ok((id, model))
}
