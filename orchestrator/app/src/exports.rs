//! `export`: bundles as packages of simulators and data sets, each with a list of what the format cannot hold.

mod sqlite;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_export::scenario::{Bag, Columns, Content, FORMATS, File, Format, Package, Scenario};
use socrates_export::{Losses, Unusable};
use socrates_model::Run;
use socrates_stream::ros::BagPen;

use crate::bundle;
use crate::cost::bundles_in;
use crate::exit::Diagnostic;
use crate::files;
use crate::layout;
use crate::output::Printer;
use crate::words::plural;

/// Name of the list of what was left behind.
const NOT_CARRIED: &str = "not_carried.json";

/// What is exported, and to what.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// A bundle or a folder of bundles.
    pub what: PathBuf,
    /// Name of the format.
    pub format: String,
    /// The run to export; none for the first of each bundle.
    pub run: Option<Run>,
    /// Folder to write; none for one named after bundle and format. Each bundle of a library gets a folder in it.
    pub out: Option<PathBuf>,
}

/// Features that this program has, of those that formats need.
const FEATURES: &[&str] = if cfg!(feature = "parquet") { &["parquet"] } else { &[] };

/// The feature that a format needs and this program lacks.
fn missing(format: &Format) -> Option<&'static str> {
    format.feature.filter(|feature| !FEATURES.contains(feature))
}

/// Why something is not written by a program without a feature.
fn unbuilt(what: &dyn Display, feature: &str) -> Diagnostic {
    Diagnostic::input(
        format!("cannot write `{what}`: this program was built without the feature `{feature}`"),
        format!("build it with `cargo build --release -p socrates --features {feature}`"),
    )
}

/// Lists the formats that this program writes, a line each: name, and what it is.
pub fn formats(talk: &Printer) {
    let written: Vec<&Format> = FORMATS.iter().filter(|format| missing(format).is_none()).collect();
    for format in &written {
        talk.line(&format!("{:<24}{}", format.name, format.about));
    }
    let rows = written.iter().map(|format| {
        let carried: Vec<&str> =
            Content::ALL.into_iter().filter(|content| format.carries(*content)).map(Content::name).collect();
        json!({
            "name": format.name, "about": format.about, "carried": carried, "by_others": format.foreign.name(),
            "checked_by": format.checked_by, "needs_run": format.needs_run,
        })
    });
    talk.result(&Value::Array(rows.collect()));
}

/// Writes bundles in a format of others, and beside each the list of what that format cannot hold.
///
/// # Errors
/// A format that is none, or a bundle that cannot be exported; of a library all others are written first.
pub fn export(talk: &Printer, options: &ExportOptions) -> Result<(), Diagnostic> {
    let format = Format::named(&options.format).map_err(|why| diagnostic(&why, None))?;
    if let Some(feature) = missing(format) {
        return Err(unbuilt(&format.name, feature));
    }
    let bundles = bundles_in(std::slice::from_ref(&options.what))?;
    if let [only] = bundles.as_slice()
        && *only == options.what
    {
        let out = options.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-{}", stem(only), format.name)));
        let (package, run) = one(only, format, options.run.as_ref(), &out)?;
        talk.line(&format!("exported   {} as {}: {}", run, format.name, plural(package.files.len(), "file")));
        for row in package.losses.rows() {
            let first = row.at.first().map_or("", String::as_str);
            let more = if row.count > 1 { format!(" and {} more", row.count - 1) } else { String::new() };
            talk.line(&format!("left       {}: {first}{more}; {}", row.what, row.why));
        }
        talk.line(&format!("wrote      {} ({NOT_CARRIED} beside the files)", out.display()));
        talk.result(&told(only, format, &out, &package));
        return Ok(());
    }
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-{}", stem(&options.what), format.name)));
    library(talk, &bundles, format, options.run.as_ref(), &out)
}

/// Exports every bundle of a library, and tells each kind of loss once.
fn library(
    talk: &Printer,
    bundles: &[PathBuf],
    format: &Format,
    run: Option<&Run>,
    out: &Path,
) -> Result<(), Diagnostic> {
    let mut left: Vec<(String, String, usize)> = Vec::new();
    let (mut made, mut refused) = (Vec::new(), Vec::new());
    for (index, dir) in bundles.iter().enumerate() {
        talk.passing(&format!("exporting  {} of {}", index + 1, bundles.len()));
        let folder = out.join(stem(dir));
        match one(dir, format, run, &folder) {
            Ok((package, _)) => {
                for row in package.losses.rows() {
                    match left.iter_mut().find(|(what, why, _)| *what == row.what && *why == row.why) {
                        Some((_, _, count)) => *count += 1,
                        None => left.push((row.what.clone(), row.why.clone(), 1)),
                    }
                }
                made.push(told(dir, format, &folder, &package));
            }
            Err(why) => refused.push(why),
        }
    }
    talk.clear();
    talk.line(&format!("exported   {} of {} as {}", made.len(), plural(bundles.len(), "bundle"), format.name));
    for (what, why, count) in &left {
        talk.line(&format!("left       {what}: in {count} of {}; {why}", plural(made.len(), "bundle")));
    }
    talk.line(&format!("wrote      {} (a folder for each bundle, {NOT_CARRIED} beside the files)", out.display()));
    let refusals: Vec<String> = refused.iter().map(Diagnostic::short).collect();
    let result =
        json!({ "format": format.name, "out": out.display().to_string(), "bundles": made, "refused": refusals });
    let Some(first) = refused.first() else {
        talk.result(&result);
        return Ok(());
    };
    let what = format!("{} of {} cannot be exported", refusals.len(), plural(bundles.len(), "bundle"));
    Err(Diagnostic { causes: refusals, result: Some(Box::new(result)), ..Diagnostic::input(what, first.hint.clone()) })
}

/// Exports one bundle into a folder; what was written, and which run.
fn one(dir: &Path, format: &Format, run: Option<&Run>, out: &Path) -> Result<(Package, String), Diagnostic> {
    let (scenario, run) = scenario(dir, run)?;
    let package = format.export(&scenario).map_err(|why| diagnostic(&why, Some(dir)))?;
    for (name, file) in &package.files {
        let path = out.join(name);
        match file {
            File::Text(text) => files::write(&path, text.as_bytes())?,
            File::Bytes(bytes) => files::write(&path, bytes)?,
            File::Database(database) => sqlite::write(&path, database)?,
            File::Columns(table) => columns(&path, table)?,
            File::Bag(bag) => {
                let problem = |why: String| Diagnostic::input(format!("{}: {why}", path.display()), "please report it");
                files::write(&path, &bag_bytes(bag).map_err(problem)?)?;
            }
        }
    }
    files::write(&out.join(NOT_CARRIED), list(&package.losses, format).as_bytes())?;
    Ok((package, run))
}

/// Writes a table of Parquet.
#[cfg(feature = "parquet")]
fn columns(path: &Path, table: &Columns) -> Result<(), Diagnostic> {
    // Makes the folder, and says what keeps a file from being written there.
    files::write(path, b"")?;
    crate::parquet_file::table(path, table)
}

#[cfg(not(feature = "parquet"))]
fn columns(path: &Path, _: &Columns) -> Result<(), Diagnostic> {
    Err(unbuilt(&path.display(), "parquet"))
}

/// The file of a bag.
fn bag_bytes(bag: &Bag) -> Result<Vec<u8>, String> {
    let mut pen = BagPen::new().map_err(|why| why.to_string())?;
    let mut numbers = Vec::with_capacity(bag.channels.len());
    for channel in &bag.channels {
        let number = pen.channel(channel.topic, &channel.kind, &channel.definition, &channel.qos);
        numbers.push(number.map_err(|why| why.to_string())?);
    }
    for message in &bag.messages {
        let Some(number) = numbers.get(message.channel) else { continue };
        pen.send(*number, message.nanos, &message.data).map_err(|why| why.to_string())?;
    }
    pen.finish().map_err(|why| why.to_string())
}

/// The list of losses as a file.
fn list(losses: &Losses, format: &Format) -> String {
    losses.json(format.name)
}

/// A bundle as exporters get it, and the name of its run.
fn scenario(dir: &Path, run: Option<&Run>) -> Result<(Scenario, String), Diagnostic> {
    let manifest = bundle::read_some(dir, |_, _| false)?.manifest;
    let runs: Vec<Run> = manifest.runs.iter().map(bundle::RunEntry::run).collect();
    let chosen = match run {
        Some(run) => runs.iter().position(|other| other == run).ok_or_else(|| {
            let names: Vec<String> = runs.iter().map(ToString::to_string).collect();
            Diagnostic::input(
                format!("`{}` has no run `{run}`", dir.display()),
                format!("its runs: {}", names.join(", ")),
            )
        })?,
        None => 0,
    };
    let name = runs.get(chosen).map(ToString::to_string).unwrap_or_default();
    let whole = match bundle::read_some(dir, |index, _| index == chosen) {
        Ok(whole) => whole,
        // A bundle without the file of the run is still a scenario; any other fault is told.
        Err(why) if bundle::file(dir, &layout::RECORDINGS.of(&name)).is_ok() => return Err(why),
        Err(_without) => bundle::read_some(dir, |_, _| false)?,
    };
    let robot_radius_m = whole.request.robot.model.radius_m;
    let scenario = Scenario {
        name: whole.manifest.scenario,
        location: whole.location,
        proposal: whole.proposal,
        paths: whole.paths,
        behaviors: whole.behaviors,
        robot_radius_m,
        recording: whole.runs.into_iter().next().map(|(recording, _)| recording),
    };
    Ok((scenario, name))
}

/// What was written of a bundle, for programs.
fn told(dir: &Path, format: &Format, out: &Path, package: &Package) -> Value {
    let files: Vec<&String> = package.files.keys().collect();
    json!({
        "bundle": dir.display().to_string(), "format": format.name, "out": out.display().to_string(), "files": files,
        "not_carried": package.losses.rows(),
    })
}

/// The name of a bundle without the ending of an archive.
fn stem(dir: &Path) -> String {
    let name = dir.canonicalize().ok().and_then(|dir| dir.file_name().map(|name| name.to_string_lossy().into_owned()));
    let name = name.unwrap_or_else(|| "scenario".to_owned());
    name.strip_suffix(bundle::PACKED).unwrap_or(&name).to_owned()
}

fn diagnostic(why: &Unusable, dir: Option<&Path>) -> Diagnostic {
    let of = dir.map_or_else(String::new, |dir| format!("`{}`: ", dir.display()));
    Diagnostic::input(format!("{of}{why}"), why.hint.clone())
}
