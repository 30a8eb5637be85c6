//! `socrates-dev golden`: the recording hash of each shipped request, each canonical scenario, and agents files.
//!
//! ```text
//! request warehouse-group                            1 5f0c…
//! card    office-frontal_approach                    1 91aa…
//! agents  codes.yaml/hunav-1.0                       1 07be…
//! ```
//!
//! `tests/golden/recordings.txt` keeps this list: a change of the engine, of an author or of a map shows as a changed line.

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_app::cards;
use socrates_app::config::Config;
use socrates_app::exit::Diagnostic;
use socrates_app::files;
use socrates_app::in_process::play;
use socrates_app::output::Printer;
use socrates_hunav::{AgentsFile, Dialect, Inputs, Profile, RobotSpec};
use socrates_model::{Fault, Location, Point, Pose, Request};
use socrates_offline::catalog;

use crate::mutations::shipped;

/// Seeds of each run.
const SEEDS: [u64; 2] = [1, 2];
/// Simulated time of an agents file, s.
const AGENTS_SECS: f64 = 30.0;
/// Largest agents file that is read, bytes.
const MAX_BYTES: u64 = 16 * 1024 * 1024;

/// A scenario of the offline author.
struct Scenario {
    kind: &'static str,
    name: String,
    request: Request,
    location: Location,
    seed: u64,
}

/// Prints the list.
///
/// # Errors
/// An agents file that cannot be read or simulated.
pub async fn golden(talk: &Printer, config: &Config, agents: &[PathBuf]) -> Result<(), Diagnostic> {
    let mut lines = Vec::new();
    let mut waiting = tokio::task::JoinSet::new();
    for (place, scenario) in scenarios(config)?.into_iter().enumerate() {
        waiting.spawn(async move {
            let Scenario { kind, name, request, location, seed } = scenario;
            let outcome = match play(&request, &location, seed).await {
                Ok(played) => played.recording.hash().to_string(),
                Err(faults) => refused(&faults),
            };
            (place, line(kind, &name, seed, &outcome))
        });
    }
    while let Some(done) = waiting.join_next().await {
        lines.push(done.map_err(|why| Diagnostic::input(format!("a run ended: {why}"), ""))?);
    }
    lines.sort();
    let mut lines: Vec<String> = lines.into_iter().map(|(_, line)| line).collect();
    for path in agents {
        lines.extend(of_agents(path)?);
    }
    lines.iter().for_each(|line| talk.line(line));
    talk.result(&json!({ "recordings": lines }));
    Ok(())
}

fn line(kind: &str, name: &str, seed: u64, outcome: &str) -> String {
    format!("{kind:<7} {name:<42} {seed} {outcome}")
}

/// Codes of the faults for which a scenario was not made.
fn refused(faults: &[Fault]) -> String {
    let mut codes: Vec<&str> = faults.iter().filter(|fault| !fault.is_soft()).map(|fault| fault.code.code()).collect();
    codes.dedup();
    format!("not made: {}", codes.join(" "))
}

/// Each shipped request and each canonical scenario, for each seed; a canonical scenario goes round the locations that it fits.
fn scenarios(config: &Config) -> Result<Vec<Scenario>, Diagnostic> {
    let mut found = Vec::new();
    for prepared in shipped(config)? {
        for seed in SEEDS {
            found.push(Scenario {
                kind: "request",
                name: prepared.name.clone(),
                request: prepared.request.clone(),
                location: prepared.location.clone(),
                seed,
            });
        }
    }
    for card in catalog().iter().filter(|card| card.letter.is_some()) {
        let places = cards::places(card)?;
        for (seed, location) in SEEDS.into_iter().zip(places.iter().cycle()) {
            found.push(Scenario {
                kind: "card",
                name: format!("{}-{}", location.name, card.id),
                request: cards::request(card, &location.name)?,
                location: location.clone(),
                seed,
            });
        }
    }
    Ok(found)
}

/// The profile that plays a dialect as its own simulator does.
const fn profile(dialect: Dialect) -> Profile {
    match dialect {
        Dialect::V1_0 => Profile::Hunav10,
        Dialect::V1_1 => Profile::Hunav11,
        Dialect::V2_0 => Profile::Hunav20,
    }
}

/// An agents file on an open floor with a robot that drives across it, natively and as its own simulator does.
fn of_agents(path: &Path) -> Result<Vec<String>, Diagnostic> {
    let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let text = files::text(path, MAX_BYTES, "name a HuNavSim agents file")?;
    let wrong = |problems: &[socrates_hunav::Problem]| {
        let mut diagnostic = Diagnostic::input(format!("`{}` cannot be simulated", path.display()), "mend the file");
        diagnostic.causes = problems.iter().map(ToString::to_string).collect();
        diagnostic
    };
    let agents = AgentsFile::read(&text, &file).map_err(|problems| wrong(&problems))?;
    let mut lines = Vec::new();
    for profile in [Profile::Native, profile(agents.dialect)] {
        for seed in SEEDS {
            let mut robot = RobotSpec::standing(Pose { x: -6.0, y: 0.0, yaw: 0.0 });
            robot.goals.push(Point::new(6.0, 0.0));
            let inputs =
                Inputs { profile, seed, duration_s: AGENTS_SECS, robot: Some(robot), ..Inputs::new(&agents, &file) };
            let recording = socrates_hunav::simulate(&inputs).map_err(|problems| wrong(&problems))?;
            lines.push(line("agents", &format!("{file}/{}", profile.name()), seed, &recording.hash().to_string()));
        }
    }
    Ok(lines)
}
