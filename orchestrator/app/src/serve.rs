//! `serve`: scenarios that stay ready, whose runs drivers ask for one after the other.
//!
//! ```text
//! driver ─► serve/run {driver, seed, scenario} ─► run in this process ─► drive/<driver>/{mission,step}
//! ```

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::{Deserialize, Serialize};
use serde_json::json;
use socrates_kit::Cancel;
use socrates_link::{Ask, Bus, keys};
use socrates_model::{AgentState, Event, Location, Onlooker, PlannerName, RecordingHeader, Request, Run, ScenarioId};
use socrates_simulation::driving::{Drive, OverBus};
use tokio::runtime::Handle;
use tokio::task::JoinSet;

use crate::bundle;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::folder::Hold;
use crate::in_process::{self, Made};
use crate::output::Printer;
use crate::prepare::{prepare, request_files};
use crate::router::Router;
use crate::scribe::Scribe;
use crate::signals::Signals;

/// What is served, and where.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Request files, folders of them, and bundles.
    pub what: Vec<PathBuf>,
    /// Folder that names the bus to drivers; recordings go there too.
    pub out: PathBuf,
    /// Base seed with which requests are authored.
    pub seed: u64,
    /// Whether the recording of every run is kept.
    pub keep: bool,
}

/// A scenario that is ready to be run.
struct Scene {
    id: ScenarioId,
    request: Request,
    location: Location,
    made: Made,
}

/// What a driver asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Wish {
    /// Name of the driver, without `external:`.
    driver: String,
    /// Seed of the run.
    seed: u64,
    /// Name of the scenario; default the first.
    #[serde(default)]
    scenario: Option<String>,
}

/// What it is told.
#[derive(Debug, Serialize)]
struct Told {
    /// The run that begins now.
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<String>,
    /// Why none begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    /// Scenarios that are served.
    scenarios: Vec<String>,
}

/// Serves until it is stopped.
pub async fn serve(talk: &Printer, config: &Config, options: &ServeOptions) -> Result<(), Diagnostic> {
    let scenes = scenes(options, config).await?;
    let work = options.out.join(crate::place::WORK);
    std::fs::create_dir_all(&work).map_err(|why| {
        Diagnostic::input(format!("cannot write into `{}`: {why}", work.display()), "--out chooses another folder")
    })?;
    let hold = Hold::take(&work)?;
    let mut signals = Signals::listen()?;
    let router = Router::open(&work, config, "run").await?;
    let drive = Drive::read(
        Some(&config.text("simulation.drive")),
        Some(&config.number("simulation.drive_patience_s").to_string()),
    );
    let drive = drive.map_err(|fault| Diagnostic::input(fault.message.to_string(), "see `simulation.drive`"))?;
    let mut asks = router.bus.serve(keys::SERVE_RUN).await.map_err(|why| Diagnostic::resumes(why.to_string()))?;
    for scene in &scenes {
        talk.line(&format!("scenario   {:<26}location  {}", scene.id.to_string(), scene.location.name));
    }
    let place = options.out.display();
    talk.line(&format!("serving    drivers connect with place=\"{place}\"; Ctrl-C ends it"));
    let server = Server {
        scenes: scenes.into(),
        bus: Arc::clone(&router.bus),
        drive,
        kept: options.keep.then(|| options.out.clone()),
        cancel: Cancel::new(),
        ended: Arc::default(),
    };
    let mut runs: JoinSet<Result<(), String>> = JoinSet::new();
    loop {
        tokio::select! {
            ask = asks.next() => match ask {
                Some(ask) => server.answer(ask, &mut runs).await,
                None => break,
            },
            Some(ended) = runs.join_next() => match ended {
                Ok(Ok(())) => {}
                Ok(Err(why)) => talk.line(&format!("run        {why}")),
                Err(why) => talk.line(&format!("run        broke: {why}")),
            },
            _stop = signals.come() => break,
        }
    }
    server.cancel.stop();
    while runs.join_next().await.is_some() {}
    router.bus.close().await;
    drop(std::fs::remove_file(work.join(crate::router::ENDPOINT_FILE)));
    drop((router.socket, hold));
    let runs = server.ended.load(Ordering::Relaxed);
    talk.line(&format!("served     {runs} runs"));
    talk.result(&json!({ "runs": runs }));
    Ok(())
}

/// Everything that is served, made ready.
async fn scenes(options: &ServeOptions, config: &Config) -> Result<Vec<Scene>, Diagnostic> {
    let mut scenes: Vec<Scene> = Vec::new();
    for what in &options.what {
        if bundle::is_bundle(what) {
            scenes.push(of_bundle(what)?);
            continue;
        }
        for file in request_files(std::slice::from_ref(what))? {
            // Rules make it below.
            let prepared = prepare(&file, None, &config.without_servers())?;
            let made = in_process::author(&prepared.request, &prepared.reading, &prepared.location, options.seed);
            let made = made.await.map_err(|faults| {
                let what = format!("`{}` cannot be made", file.display());
                Diagnostic::faults(what, &faults, "`socrates run` of it says more; a bundle can be served as well")
            })?;
            let id = ScenarioId::new(&prepared.name)
                .map_err(|bad| Diagnostic::input(bad.to_string(), "name the file otherwise"))?;
            scenes.push(Scene { id, request: prepared.request, location: prepared.location, made });
        }
    }
    let mut names: Vec<&ScenarioId> = scenes.iter().map(|scene| &scene.id).collect();
    names.sort();
    if let Some([twice, _]) = names.windows(2).find(|pair| matches!(pair, [a, b] if a == b)) {
        return Err(Diagnostic::input(
            format!("two scenarios are called `{twice}`"),
            "drivers ask for a scenario by its name: rename a file",
        ));
    }
    Ok(scenes)
}

fn of_bundle(dir: &Path) -> Result<Scene, Diagnostic> {
    let read = bundle::read_some(dir, |_, _| false)?;
    let id = ScenarioId::new(&read.manifest.scenario)
        .map_err(|bad| Diagnostic::input(bad.to_string(), "the manifest was changed by hand or is damaged"))?;
    let made = Made { proposal: read.proposal, paths: read.paths, behaviors: read.behaviors };
    Ok(Scene { id, request: read.request, location: read.location, made })
}

/// The scenarios with what their runs need.
struct Server {
    scenes: Arc<[Scene]>,
    bus: Arc<dyn Bus>,
    drive: Drive,
    /// Folder of the recordings, where they are kept.
    kept: Option<PathBuf>,
    cancel: Cancel,
    ended: Arc<AtomicU64>,
}

impl Server {
    /// Begins the run that is asked for, and says which it is, or why none begins.
    async fn answer(&self, ask: Ask, runs: &mut JoinSet<Result<(), String>>) {
        let scenarios = self.scenes.iter().map(|scene| scene.id.to_string()).collect();
        let told = match self.begin(ask.body(), runs) {
            Ok(run) => Told { run: Some(run), error: None, scenarios },
            Err(error) => Told { run: None, error: Some(error), scenarios },
        };
        let body = serde_json::to_vec(&told).unwrap_or_default();
        if let Err(why) = ask.reply(body).await {
            tracing::warn!(%why, "a driver is gone that asked for a run");
        }
    }

    fn begin(&self, body: &[u8], runs: &mut JoinSet<Result<(), String>>) -> Result<String, String> {
        let wish: Wish = serde_json::from_slice(body).map_err(|why| {
            format!("the question cannot be read: {why}; such as {{\"driver\": \"mine\", \"seed\": 1, \"scenario\": \"my\"}}")
        })?;
        let named = |scene: &Scene| wish.scenario.as_ref().is_none_or(|name| scene.id.as_str() == name);
        let index = self.scenes.iter().position(named).ok_or_else(|| {
            let names: Vec<&str> = self.scenes.iter().map(|scene| scene.id.as_str()).collect();
            format!(
                "there is no scenario `{}`; served: {}",
                wish.scenario.as_deref().unwrap_or_default(),
                names.join(", ")
            )
        })?;
        let planner = PlannerName::new(format!("external:{}", wish.driver)).map_err(|bad| bad.to_string())?;
        let run = Run { planner, seed: wish.seed };
        let (scenes, kept, ended) = (Arc::clone(&self.scenes), self.kept.clone(), Arc::clone(&self.ended));
        let mut outside = OverBus::new(Arc::clone(&self.bus), Handle::current(), self.drive, self.cancel.clone());
        let name = scenes.get(index).map(|scene| run.id(&scene.id).to_string()).unwrap_or_default();
        let called = name.clone();
        runs.spawn_blocking(move || {
            let Some(scene) = scenes.get(index) else { return Ok(()) };
            let place = (&scene.request, &scene.location);
            let id = run.id(&scene.id);
            let path = kept.map(|folder| folder.join(format!("{called}.mcap")));
            let mut scribe = path.as_deref().map(|path| Scribe::new(Some(path), Some(&scene.location)));
            let mut nothing = Nothing;
            let onlooker: &mut dyn Onlooker = match &mut scribe {
                Some(scribe) => scribe,
                None => &mut nothing,
            };
            let played = in_process::simulate_into(place, scene.made.clone(), id, &run, &mut outside, onlooker);
            if let Some(scribe) = scribe {
                scribe.finish().map_err(|why| format!("{called}: {}", why.what))?;
            }
            ended.fetch_add(1, Ordering::Relaxed);
            played.map(|_commands| ()).map_err(|faults| {
                let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
                format!("{called}: {}", told.join("; "))
            })
        });
        Ok(name)
    }
}

/// Looks on at a run that nobody keeps.
struct Nothing;

impl Onlooker for Nothing {
    fn announce(&mut self, _header: &RecordingHeader) {}

    fn tick(&mut self, _states: &[AgentState], _events: &[Event]) {}
}
