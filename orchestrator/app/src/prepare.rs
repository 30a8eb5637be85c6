//! From request files to prepared scenarios: everything that can be wrong is said here, before anything runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use socrates_export::socrates_json::Imported;
use socrates_model::{
    AuthorSpec, Breadth, Fact, FactKind, Fault, FaultCode, HumanId, Location, PlannerName, Proposal, Reading, Request,
    Role, ScenarioId, Seeds,
};

use crate::config::Config;
use crate::exit::Diagnostic;
use crate::files;
use crate::layout;
use crate::raw_map;
use crate::run_options::RunOptions;
use crate::words::plural;

/// A request file larger than this is not read.
const MAX_REQUEST_BYTES: u64 = 256 * 1024;
/// A pinned artifact larger than this is not read.
const MAX_PIN_BYTES: u64 = 16 * 1024 * 1024;

/// A request with everything it names, read and checked.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Name of the scenario: the file's stem, or the name of the bundle whose request it is.
    pub name: String,
    /// The file it was read from, if it was one.
    pub(crate) file: Option<PathBuf>,
    /// The request, options applied.
    pub request: Request,
    /// The location.
    pub location: Location,
    /// Its files, for the bundle.
    pub(crate) location_files: BTreeMap<String, Vec<u8>>,
    /// The reading.
    pub reading: Reading,
    /// Pinned artifacts as JSON by role.
    pub(crate) pins: BTreeMap<Role, String>,
    /// Faults to be put into the author's answers, as settings of its jobs; empty for none.
    pub(crate) injected: BTreeMap<String, String>,
    /// Style of the questions, as settings of the author's jobs; empty for the default.
    pub(crate) style: BTreeMap<String, String>,
    /// What is to be said of its parameter files.
    pub(crate) notes: Vec<String>,
    /// Whether a person looks at it while it is made.
    pub(crate) looked_at: bool,
    /// What the program was built from.
    pub(crate) build: String,
    /// Whether the provenance keeps questions and answers.
    pub(crate) keep_answers: bool,
    /// Resolved author, never [`AuthorSpec::Auto`].
    pub(crate) author: AuthorSpec,
    /// Why this author, for the first line of a run.
    pub(crate) author_note: String,
}

impl Prepared {
    /// The author that is asked; none where every answer is pinned.
    pub(crate) fn asked(&self) -> Option<&AuthorSpec> {
        let wanted = [Role::Proposal, Role::Paths, Role::Behaviors];
        (!wanted.iter().all(|role| self.pins.contains_key(role))).then_some(&self.author)
    }

    /// Whether a driver outside drives in any of its runs.
    pub(crate) fn is_driven(&self) -> bool {
        is_driven(&self.request)
    }
}

/// Whether a driver outside drives the robot or a person in any run of a request.
fn is_driven(request: &Request) -> bool {
    !request.people.is_empty() || request.robot.planners.iter().any(|planner| planner.external().is_some())
}

/// Every request file named on the command line, folders opened.
pub fn request_files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Diagnostic> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut inside: Vec<PathBuf> = std::fs::read_dir(path)
                .map_err(|why| {
                    Diagnostic::input(
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
                return Err(Diagnostic::input(
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
pub fn prepare(file: &Path, options: Option<&RunOptions>, config: &Config) -> Result<Prepared, Diagnostic> {
    let text = files::text(file, MAX_REQUEST_BYTES, "`socrates new my.toml` writes a request to start from")?;
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let of_bundle = file.ends_with(layout::REQUEST.path) && folder.join(layout::MANIFEST.path).is_file();
    let named = if of_bundle { folder.canonicalize().unwrap_or_default() } else { file.with_extension("") };
    let name = named.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let shown = file.display().to_string();
    let prepared = prepare_text(&name, &text, &shown, folder, options, config).map_err(|why| {
        // Of hundreds of files, the name of the one is what helps.
        let what = if why.what.contains(&shown) { why.what } else { format!("`{shown}`: {}", why.what) };
        Diagnostic { what, ..why }
    })?;
    Ok(Prepared { file: Some(file.to_path_buf()), ..prepared })
}

/// Checks the text of a request. `shown` names it in messages, `folder` is where its paths start.
pub fn prepare_text(
    name: &str,
    text: &str,
    shown: &str,
    folder: &Path,
    options: Option<&RunOptions>,
    config: &Config,
) -> Result<Prepared, Diagnostic> {
    let planners = socrates_planners::names();
    let mut request = Request::of_toml(text, Some(&planners)).map_err(|problems| {
        let mut diagnostic = Diagnostic::input(
            format!("the request `{shown}` has {}", plural(problems.len(), "problem")),
            "`socrates new my.toml` writes a request with every key explained; `socrates explain J-REQUEST`",
        );
        diagnostic.causes = problems.iter().map(|bad| bad.told(shown)).collect();
        diagnostic
    })?;
    let mut notes = read_nav2(&mut request, folder)?;
    if let Some(options) = options {
        apply(&mut request, options)?;
    }
    // The reference robot always runs, whoever asks.
    if !request.robot.planners.contains(&PlannerName::reference()) {
        request.robot.planners.insert(0, PlannerName::reference());
    }
    let of_request = |why: Diagnostic| Diagnostic { what: format!("the request `{shown}`: {}", why.what), ..why };
    let (mut location, location_files, raw) = load_any(&request.location, folder).map_err(of_request)?;
    notes.extend(raw);
    if let Some(description) = &request.location_description {
        location.description.clone_from(description);
    }
    let mut pins = BTreeMap::new();
    if let Some(file) = &request.proposal {
        pins.insert(Role::Proposal, read_pin(Role::Proposal, &folder.join(file), |all| all.proposal)?);
    }
    if let Some(file) = &request.paths {
        pins.insert(Role::Paths, read_pin(Role::Paths, &folder.join(file), |all| all.paths)?);
    }
    if let Some(file) = &request.behaviors {
        pins.insert(Role::Behaviors, read_pin(Role::Behaviors, &folder.join(file), |all| all.behaviors)?);
    }
    let (author, mut author_note) = choose_author(&request.run.author, config).map_err(of_request)?;
    let pinned = request.proposal.as_ref().map(|file| folder.join(file));
    let reading = read(&request, &location, author.is_model(), pinned.as_deref());
    check_reading(&reading, &request, &location, shown)?;
    check_people(&request, &reading, &pins, shown)?;
    // What a language model would read out of the task is not known beforehand.
    if author == AuthorSpec::Offline && !pins.contains_key(&Role::Proposal) && !pins.contains_key(&Role::Paths) {
        check_ways(&reading, &request, &location, shown)?;
    }
    crate::prices::check_limit(config, &author)?;
    let long = socrates_prompts::too_long(&request);
    // Rules read the whole request; whoever is asked in messages would not see its end.
    if author != AuthorSpec::Offline && !long.is_empty() {
        let mut diagnostic = Diagnostic::input(
            format!("the request `{shown}` is too long for a language model"),
            "shorten these texts, or take `--author offline`, which reads them whole",
        );
        diagnostic.causes = long.iter().map(|why| format!("J-REQUEST {why}")).collect();
        return Err(diagnostic);
    }
    let injected = injected(options.map_or("", |options| options.inject.as_str()))?;
    if !injected.is_empty() {
        author_note.push_str("; FAULTS ARE PUT INTO ITS ANSWERS");
    }
    let mut style = crate::authors::style(config)?;
    if author == AuthorSpec::Offline {
        // Rules have no style of being asked: the offline author's results stay the same results. What it is told of faults
        // that were put in matters.
        style.retain(|key, _| key == "prompt.variants" || key == "prompt.feedback" && !injected.is_empty());
    }
    let behaviors = crate::authors::behaviors_by(&author, &style);
    style.extend(crate::authors::paths_by(config, &author)?);
    style.extend(behaviors);
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
        notes,
        looked_at: options.is_some_and(|options| options.ask),
        build: config.program().build.clone(),
        keep_answers: config.truth("author.keep_answers"),
        author,
        author_note,
    })
}

/// How the request is read: by the offline author's reader, or as far as it is stated where its author reads the texts. A pinned proposal
/// whose author read them brings its reading along.
fn read(request: &Request, location: &Location, by_author: bool, pinned: Option<&Path>) -> Reading {
    let kept = |pinned: &Path| {
        let bytes = std::fs::read(pinned.with_file_name(layout::READING.file_name())).ok()?;
        serde_json::from_slice::<Reading>(&bytes).ok().filter(|reading| reading.by.is_author())
    };
    match (by_author, pinned) {
        (false, _) => socrates_offline::read(request, location),
        (true, None) => socrates_offline::stated(request, location),
        (true, Some(pinned)) => kept(pinned).unwrap_or_else(|| socrates_offline::read(request, location)),
    }
}

/// Refuses a request whose reading says that it cannot be made, with what would settle it.
fn check_reading(reading: &Reading, request: &Request, location: &Location, shown: &str) -> Result<(), Diagnostic> {
    let stops: Vec<Fault> = socrates_model::fault::hard(&reading.problems);
    if !stops.is_empty() {
        return Err(Diagnostic::faults(
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

/// Refuses a request for which the map has no ways, with what does not fit, where, and by how much.
fn check_ways(reading: &Reading, request: &Request, location: &Location, shown: &str) -> Result<(), Diagnostic> {
    let Some(miss) = socrates_offline::impossible(request, reading, location) else { return Ok(()) };
    Err(Diagnostic::faults(
        format!("the request `{shown}` asks for ways that the location `{}` does not have", location.name),
        &[Fault::new(FaultCode::ECannot, "paths", miss.to_string())],
        format!(
            "`socrates map draw {} -o map.png` shows the nodes; correct the text or the map",
            files::shell(Path::new(&request.location))
        ),
    ))
}

/// People who are driven must be there: a pinned proposal says who is, or the reading, where the request says how many.
fn check_people(
    request: &Request,
    reading: &Reading,
    pins: &BTreeMap<Role, String>,
    shown: &str,
) -> Result<(), Diagnostic> {
    let pinned = pins.get(&Role::Proposal).and_then(|text| serde_json::from_str::<Proposal>(text).ok());
    let stated = |fact: &Fact| if let FactKind::Humans(count) = fact.kind { Some(count) } else { None };
    let read = || reading.facts.iter().find_map(stated).map(|count| (1..=count).map(HumanId::new).collect());
    let there = pinned.map(|proposal| proposal.humans.iter().map(|human| human.id).collect()).or_else(read);
    let Some(there): Option<Vec<HumanId>> = there else { return Ok(()) };
    let missing = request.people.iter().filter(|(id, _)| !there.contains(id));
    let causes: Vec<String> = missing
        .map(|(id, model)| format!("J-REQUEST {shown} `people.{id}`: `{model}` is to drive somebody who is not there"))
        .collect();
    if causes.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = there.iter().map(ToString::to_string).collect();
    let names = if names.is_empty() { "nobody".to_owned() } else { names.join(", ") };
    let what = format!("the request `{shown}` names people who are not in it");
    let hint = format!("there is {names}; `socrates read {}` shows who does what", files::shell(Path::new(shown)));
    Err(Diagnostic { causes, ..Diagnostic::input(what, hint) })
}

/// The settings of `--inject`.
fn injected(text: &str) -> Result<BTreeMap<String, String>, Diagnostic> {
    let mut settings = BTreeMap::new();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let (kind, rate) = part.split_once('=').ok_or_else(|| {
            Diagnostic::input(format!("`--inject {part}` has no rate"), "write --inject gdisc=0.3, for example")
        })?;
        settings.insert(format!("fault.{}", kind.trim()), rate.trim().to_owned());
    }
    socrates_author::FaultRates::from_settings(&settings).map_err(|why| {
        Diagnostic::input(format!("--inject: {}", why.message), "write --inject gdisc=0.3, for example")
    })?;
    Ok(settings)
}

/// Flags win over the request, and what it writes over what is not written.
fn apply(request: &mut Request, options: &RunOptions) -> Result<(), Diagnostic> {
    if let Some(seeds) = &options.seeds {
        request.run.seeds = Some(seeds.clone());
    }
    // A plain `--seed 7` moves authoring and simulation together where nobody names the seeds of the simulation.
    request.run.seeds.get_or_insert_with(|| Seeds::one(options.seed));
    if !options.planner.is_empty() {
        let known = socrates_planners::names();
        if let Some(planner) = options.planner.iter().find(|planner| {
            let own = planner.external().is_some() || request.robot.nav2.contains_key(planner);
            !own && !known.contains(&planner.as_str())
        }) {
            return Err(Diagnostic::input(
                format!("J-PLANNER `--planner`: there is no planner `{planner}`"),
                format!("planners: {}", known.join(", ")),
            ));
        }
        request.robot.planners.clone_from(&options.planner);
    }
    if options.driver.is_some() && !is_driven(request) {
        return Err(Diagnostic::input(
            "`--driver` starts a driver outside, and no planner and no person's model is one",
            "add --planner external:NAME with the name that the driver gives itself, or name it in [people] of the request",
        ));
    }
    if let Some(variants) = options.variants {
        request.run.variants = variants;
    }
    // Different scenarios want all that is open; seeds in turn give what single runs give.
    if request.run.variants > 1 && !options.repeats {
        request.run.breadth = Breadth::Wide;
    }
    if let Some(author) = &options.author {
        request.run.author.clone_from(author);
    }
    Ok(())
}

/// A location by shipped name or folder, with its files. A map without a scene graph is annotated.
pub fn load_location(name: &str, folder: &Path) -> Result<(Location, BTreeMap<String, Vec<u8>>), Diagnostic> {
    load_any(name, folder).map(|(location, files, _)| (location, files))
}

/// What is said where a shipped location has the name of a folder with a map: the shipped one is meant.
pub(crate) fn shadowed(name: &str, folder: &Path) -> Option<String> {
    let there = socrates_maps::shipped::files(name).is_some() && folder.join(name).join("map.yaml").is_file();
    there.then(|| format!("`{name}` is the location of that name that is shipped; `./{name}` is the folder here"))
}

/// A location with its files, and what is to be said of it where the program annotated it, or a folder has its name.
type Loaded = (Location, BTreeMap<String, Vec<u8>>, Option<String>);

/// A location by shipped name, folder or map file.
fn load_any(name: &str, folder: &Path) -> Result<Loaded, Diagnostic> {
    let wrong = |faults: Vec<Fault>| {
        Diagnostic::faults(
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
        return Ok((socrates_maps::shipped::load(name).map_err(wrong)?, files, shadowed(name, folder)));
    }
    let beside = folder.join(name);
    let dir = if beside.exists() { beside } else { PathBuf::from(name) };
    if let Some(file) = raw_map::file_of(&dir) {
        let map = raw_map::annotated(&file, &socrates_annotate::Options::default())?;
        let note = raw_map::note(&map, name);
        return Ok((map.location, map.files, Some(note)));
    }
    if !dir.is_dir() {
        return Err(Diagnostic::input(
            format!("there is no location `{name}`"),
            format!(
                "give a folder with a map (map.yaml and its image), or one of: {}",
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
    Ok((location, files, None))
}

/// A pinned artifact in our own form, or out of a file of the published tool, of whose artifacts one is taken.
fn read_pin<T: Serialize + DeserializeOwned>(
    role: Role,
    path: &Path,
    take: impl Fn(Imported) -> Option<T>,
) -> Result<String, Diagnostic> {
    let text = files::text(path, MAX_PIN_BYTES, "the path is taken from the folder of the request")?;
    let Err(own) = serde_json::from_str::<T>(&text) else { return Ok(text) };
    let wrong = |cause: String| {
        let mut diagnostic = Diagnostic::input(
            format!("the pinned {role} `{}` cannot be read", path.display()),
            format!("`socrates dev schema {role}` prints the form"),
        );
        diagnostic.causes =
            vec![format!("as our own form: {own}"), format!("as a file of the published tool: {cause}")];
        diagnostic
    };
    let imported = socrates_export::socrates_json::read(&text).map_err(|why| wrong(why.to_string()))?;
    match take(imported).map(|artifact| serde_json::to_string(&artifact)) {
        Some(Ok(json)) => Ok(json),
        Some(Err(why)) => Err(wrong(why.to_string())),
        None => Err(wrong(format!("it holds no {role}"))),
    }
}

/// Puts the text of every parameter file of Nav2 where its name stands, and refuses one that no robot could be driven with. Gives
/// back what is to be said of them.
fn read_nav2(request: &mut Request, folder: &Path) -> Result<Vec<String>, Diagnostic> {
    let mut notes = Vec::new();
    for (name, text) in &mut request.robot.nav2 {
        let mut file = "the request".to_owned();
        if !text.trim().contains('\n') {
            let path = folder.join(text.trim());
            file = path.display().to_string();
            *text = files::text(&path, MAX_PIN_BYTES, "the path is taken from the folder of the request")?;
        }
        let loaded = socrates_planners::params::read(text).map_err(|bad| {
            let hint = "Nav2's own nav2_params.yaml is such a file; what it leaves out has Nav2's default";
            let mut diagnostic =
                Diagnostic::input(format!("`robot.nav2.{name}`: the parameters of {file} cannot be used"), hint);
            diagnostic.causes = bad.to_string().lines().map(str::to_owned).collect();
            diagnostic
        })?;
        notes.extend(loaded.warning.map(|warning| format!("planner {name}: {warning}")));
    }
    Ok(notes)
}

/// The author to ask, and why this one.
fn choose_author(wish: &AuthorSpec, config: &Config) -> Result<(AuthorSpec, String), Diagnostic> {
    let configured = || {
        config.text("author.kind").parse::<AuthorSpec>().map_err(|bad| {
            Diagnostic::input(format!("`author.kind`: {bad}"), "`socrates config author` prints the manual")
        })
    };
    match if *wish == AuthorSpec::Auto { configured()? } else { wish.clone() } {
        AuthorSpec::Auto => crate::authors::auto(config),
        AuthorSpec::Offline => Ok((AuthorSpec::Offline, "offline, rules".to_owned())),
        named
        @ (AuthorSpec::Server(..) | AuthorSpec::Cassette(_) | AuthorSpec::Record(..) | AuthorSpec::Replay(..)) => {
            let named = crate::authors::settled(named, config)?;
            let note = named.to_string();
            Ok((named, note))
        }
    }
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

/// The scenario id of variant `index` of `count`.
pub fn scenario_id(name: &str, seed: u64, index: u32, count: u32) -> Result<ScenarioId, Diagnostic> {
    let id = if count == 1 { format!("{name}-{seed}") } else { format!("{name}-{seed}-{:05}", index + 1) };
    ScenarioId::new(id).map_err(|bad| Diagnostic::input(bad.to_string(), "rename the request file"))
}
