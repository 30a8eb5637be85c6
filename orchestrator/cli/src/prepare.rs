//! From request files to prepared scenarios: everything that can be wrong is said here, before anything runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use socrates_model::{Fault, Location, Reading, Request, ScenarioId};

use crate::args::RunOptions;
use crate::config::Config;
use crate::exit::Complaint;
use crate::files;

/// A request file larger than this is not read.
const MAX_REQUEST_BYTES: u64 = 256 * 1024;
/// A pinned artifact larger than this is not read.
const MAX_PIN_BYTES: u64 = 16 * 1024 * 1024;

/// A request with everything it names, read and checked.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    /// Name of the scenario: the file's stem, or the name of the bundle whose request it is.
    pub(crate) name: String,
    /// The file it was read from, if it was one.
    pub(crate) file: Option<PathBuf>,
    /// The request, options applied.
    pub(crate) request: Request,
    /// The location.
    pub(crate) location: Location,
    /// Its files, for the bundle.
    pub(crate) location_files: BTreeMap<String, Vec<u8>>,
    /// The reading.
    pub(crate) reading: Reading,
    /// Pinned artifacts as JSON by role.
    pub(crate) pins: BTreeMap<String, String>,
    /// Faults to be put into the author's answers, as settings of its jobs; empty for none.
    pub(crate) injected: BTreeMap<String, String>,
    /// Style of the questions, as settings of the author's jobs; empty for the default.
    pub(crate) style: BTreeMap<String, String>,
    /// Whether a person looks at it while it is made.
    pub(crate) looked_at: bool,
    /// Whether the provenance keeps questions and answers.
    pub(crate) keep_answers: bool,
    /// Resolved author: `offline`, `openai:MODEL`, `cassette:FOLDER`.
    pub(crate) author: String,
    /// Why this author, for the first line of a run.
    pub(crate) author_note: String,
}

/// Every request file named on the command line, folders opened.
pub(crate) fn request_files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Complaint> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut inside: Vec<PathBuf> = std::fs::read_dir(path)
                .map_err(|why| {
                    Complaint::input(
                        format!("cannot list `{}`: {why}", path.display()),
                        "name request files or a folder of them",
                    )
                })?
                .filter_map(Result::ok)
                .map(|entry| entry.path())
                .filter(|file| file.extension().is_some_and(|ext| ext == "toml"))
                .collect();
            inside.sort();
            if inside.is_empty() {
                return Err(Complaint::input(
                    format!("`{}` holds no request (*.toml)", path.display()),
                    "`socrates new my.toml` writes one",
                ));
            }
            files.extend(inside);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

/// Reads and checks one request file.
pub(crate) fn prepare(file: &Path, options: Option<&RunOptions>, config: &Config) -> Result<Prepared, Complaint> {
    let text = files::text(file, MAX_REQUEST_BYTES, "`socrates new my.toml` writes a request to start from")?;
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let of_bundle = file.ends_with("request.toml") && crate::bundle::manifest(folder).is_some();
    let named = if of_bundle { folder.canonicalize().unwrap_or_default() } else { file.with_extension("") };
    let name = named.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let shown = file.display().to_string();
    let prepared = prepare_text(&name, &text, &shown, folder, options, config).map_err(|why| {
        // Of hundreds of files, the name of the one is what helps.
        let what = if why.what.contains(&shown) { why.what } else { format!("`{shown}`: {}", why.what) };
        Complaint { what, ..why }
    })?;
    Ok(Prepared { file: Some(file.to_path_buf()), ..prepared })
}

/// Checks the text of a request. `shown` names it in messages, `folder` is where its paths start.
pub(crate) fn prepare_text(
    name: &str,
    text: &str,
    shown: &str,
    folder: &Path,
    options: Option<&RunOptions>,
    config: &Config,
) -> Result<Prepared, Complaint> {
    let mut request: Request = toml::from_str(text).map_err(|why| {
        let mut complaint = Complaint::input(
            format!("the request `{shown}` cannot be read"),
            "`socrates new my.toml` writes a request with every key explained",
        );
        complaint.causes = why.to_string().lines().map(str::to_owned).collect();
        complaint
    })?;
    if let Some(options) = options {
        apply(&mut request, options);
    }
    // The reference robot always runs, whoever asks.
    if !request.robot.planners.iter().any(|planner| planner == "reference") {
        request.robot.planners.insert(0, "reference".to_owned());
    }
    let problems = request.problems();
    if !problems.is_empty() {
        let mut complaint =
            Complaint::input(format!("the request `{shown}` has {}", plural(problems.len(), "problem")), String::new());
        complaint.causes = problems.iter().map(|bad| format!("J-REQUEST {bad} ({})", bad.hint)).collect();
        complaint.hint = "`socrates explain J-REQUEST`".to_owned();
        return Err(complaint);
    }
    check_planners(&request, shown)?;
    let of_request = |why: Complaint| Complaint { what: format!("the request `{shown}`: {}", why.what), ..why };
    let (mut location, location_files) = load_location(&request.location, folder).map_err(of_request)?;
    if let Some(description) = &request.location_description {
        location.description.clone_from(description);
    }
    let reading = socrates_offline::read(&request, &location);
    check_reading(&reading, &request, &location, shown)?;
    let mut pins = BTreeMap::new();
    for (role, pinned) in
        [("proposal", &request.proposal), ("paths", &request.paths), ("behaviors", &request.behaviors)]
    {
        if let Some(pinned) = pinned {
            pins.insert(role.to_owned(), read_pin(role, &folder.join(pinned))?);
        }
    }
    let (author, mut author_note) = choose_author(&request.run.author, config).map_err(of_request)?;
    crate::cost::check_limit(config, &author)?;
    let long = socrates_prompts::too_long(&request);
    // Rules read the whole request; whoever is asked in messages would not see its end.
    if author != "offline" && !long.is_empty() {
        let mut complaint = Complaint::input(
            format!("the request `{shown}` is too long for a language model"),
            "shorten these texts, or take `--author offline`, which reads them whole",
        );
        complaint.causes = long.iter().map(|why| format!("J-REQUEST {why}")).collect();
        return Err(complaint);
    }
    let injected = injected(options.map_or("", |options| options.inject.as_str()))?;
    if !injected.is_empty() {
        author_note.push_str("; FAULTS ARE PUT INTO ITS ANSWERS");
    }
    let mut style = crate::authors::style(config)?;
    if author == "offline" {
        // Rules have no style of being asked: the offline author's results stay the same results. What it is told of faults
        // that were put in matters.
        style.retain(|key, _| key == "prompt.variants" || key == "prompt.feedback" && !injected.is_empty());
    }
    Ok(Prepared {
        name: slug(name),
        file: None,
        request,
        location,
        location_files,
        reading,
        pins,
        injected,
        style,
        looked_at: options.is_some_and(|options| options.ask),
        keep_answers: config.truth("author.keep_answers"),
        author,
        author_note,
    })
}

/// Refuses planners that do not exist.
fn check_planners(request: &Request, shown: &str) -> Result<(), Complaint> {
    let known = socrates_planners::names();
    for planner in &request.robot.planners {
        if !known.contains(&planner.as_str()) {
            return Err(Complaint::input(
                format!("J-PLANNER the request `{shown}`: `robot.planners`: there is no planner `{planner}`"),
                format!("planners: {}", known.join(", ")),
            ));
        }
    }
    Ok(())
}

/// Refuses a request whose reading says that it cannot be made, with what would settle it.
fn check_reading(reading: &Reading, request: &Request, location: &Location, shown: &str) -> Result<(), Complaint> {
    let stops: Vec<Fault> = socrates_model::fault::hard(&reading.problems);
    if !stops.is_empty() {
        return Err(Complaint::faults(
            format!("the request `{shown}` asks for something that cannot be made"),
            &stops,
            match socrates_offline::settled_by(request, location).as_slice() {
                [] => format!("correct the text; `socrates read {}` shows the reading", files::shell(Path::new(shown))),
                keys => format!(
                    "correct the text, or set {} under [expect]; `socrates read {}` shows the reading",
                    keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(" and "),
                    files::shell(Path::new(shown))
                ),
            },
        ));
    }
    Ok(())
}

/// The settings of `--inject`.
fn injected(text: &str) -> Result<BTreeMap<String, String>, Complaint> {
    let mut settings = BTreeMap::new();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let (kind, rate) = part.split_once('=').ok_or_else(|| {
            Complaint::input(format!("`--inject {part}` has no rate"), "write --inject gdisc=0.3, for example")
        })?;
        settings.insert(format!("fault.{}", kind.trim()), rate.trim().to_owned());
    }
    socrates_author::FaultRates::from_settings(&settings).map_err(|why| {
        Complaint::input(format!("--inject: {}", why.message), "write --inject gdisc=0.3, for example")
    })?;
    Ok(settings)
}

/// Flags win over the request.
fn apply(request: &mut Request, options: &RunOptions) {
    if let Some(seeds) = &options.seeds {
        request.run.seeds.clone_from(seeds);
    } else if request.run.seeds == "1" {
        // A plain `--seed 7` moves authoring and simulation together.
        request.run.seeds = options.seed.to_string();
    }
    if !options.planner.is_empty() {
        request.robot.planners.clone_from(&options.planner);
    }
    if let Some(variants) = options.variants {
        request.run.variants = variants;
    }
    if let Some(author) = &options.author {
        request.run.author.clone_from(author);
    }
}

/// A location by shipped name or folder, with its files.
pub(crate) fn load_location(name: &str, folder: &Path) -> Result<(Location, BTreeMap<String, Vec<u8>>), Complaint> {
    let wrong = |faults: Vec<Fault>| {
        Complaint::faults(
            format!("the location `{name}` is not usable"),
            &faults,
            format!(
                "`socrates map check {}` lists everything; shipped locations: {}",
                files::shell(Path::new(name)),
                socrates_maps::shipped::names().join(", ")
            ),
        )
    };
    if let Some(files) = socrates_maps::shipped::files(name) {
        return Ok((socrates_maps::shipped::load(name).map_err(wrong)?, files));
    }
    let beside = folder.join(name);
    let dir = if beside.is_dir() { beside } else { PathBuf::from(name) };
    if !dir.is_dir() {
        return Err(Complaint::input(
            format!("there is no location `{name}`"),
            format!(
                "give a folder with map.yaml and scene_graph.json, or one of: {}",
                socrates_maps::shipped::names().join(", ")
            ),
        ));
    }
    let location = socrates_maps::load(&dir).map_err(wrong)?;
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(&dir).into_iter().flatten().filter_map(Result::ok) {
        let file = entry.file_name().to_string_lossy().into_owned();
        let fits = ["yaml", "pgm", "png", "json", "toml"].iter().any(|ext| file.ends_with(&format!(".{ext}")));
        if fits && let Ok(bytes) = std::fs::read(entry.path()) {
            files.insert(file, bytes);
        }
    }
    Ok((location, files))
}

/// A pinned artifact in our own form, or out of a file of the published tool.
fn read_pin(role: &str, path: &Path) -> Result<String, Complaint> {
    let text = files::text(path, MAX_PIN_BYTES, "the path is taken from the folder of the request")?;
    let own = match role {
        "proposal" => serde_json::from_str::<socrates_model::Proposal>(&text).map(|_| ()),
        "paths" => serde_json::from_str::<socrates_model::Paths>(&text).map(|_| ()),
        _ => serde_json::from_str::<socrates_model::Behaviors>(&text).map(|_| ()),
    };
    let Err(own) = own else { return Ok(text) };
    let wrong = |cause: String| {
        let mut complaint = Complaint::input(
            format!("the pinned {role} `{}` cannot be read", path.display()),
            format!("`socrates dev schema {role}` prints the form"),
        );
        complaint.causes = vec![format!("as our own form: {own}"), format!("as a file of the published tool: {cause}")];
        complaint
    };
    let imported = socrates_export::socrates_json::read(&text).map_err(|why| wrong(why.to_string()))?;
    let json = match role {
        "proposal" => imported.proposal.map(|artifact| serde_json::to_string(&artifact)),
        "paths" => imported.paths.map(|artifact| serde_json::to_string(&artifact)),
        _ => imported.behaviors.map(|artifact| serde_json::to_string(&artifact)),
    };
    match json {
        Some(Ok(json)) => Ok(json),
        Some(Err(why)) => Err(wrong(why.to_string())),
        None => Err(wrong(format!("it holds no {role}"))),
    }
}

fn choose_author(wish: &str, config: &Config) -> Result<(String, String), Complaint> {
    let wish = if wish == "auto" { config.text("author.kind") } else { wish.to_owned() };
    if wish != "auto" {
        let note = if wish == "offline" { "offline, rules".to_owned() } else { wish.clone() };
        return Ok((wish, note));
    }
    let model = config.text("author.model");
    let key_found = crate::authors::key_found(config)?;
    Ok(if key_found && !model.is_empty() {
        (format!("openai:{model}"), format!("openai:{model}"))
    } else if key_found {
        (
            "offline".to_owned(),
            "offline, rules (a key was found, but no model: `socrates config author` to change)".to_owned(),
        )
    } else {
        ("offline".to_owned(), "offline, rules (no key found; `socrates config author` to change)".to_owned())
    })
}

/// A word that is safe as folder and scenario id.
pub(crate) fn slug(text: &str) -> String {
    let mut out: String = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_') { c.to_ascii_lowercase() } else { '-' })
        .take(60)
        .collect();
    if out.trim_matches('-').is_empty() {
        out = "scenario".to_owned();
    }
    out
}

/// `1 problem`, `2 problems`.
pub(crate) fn plural(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}

/// The scenario id of variant `index` of `count`.
pub(crate) fn scenario_id(name: &str, seed: u64, index: u32, count: u32) -> Result<ScenarioId, Complaint> {
    let id = if count == 1 { format!("{name}-{seed}") } else { format!("{name}-{seed}-{:05}", index + 1) };
    ScenarioId::new(id).map_err(|bad| Complaint::input(bad.to_string(), "rename the request file"))
}
