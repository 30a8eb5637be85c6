//! Where `view` finds runs: on the bus of a folder while there is one, and in its bundles.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use async_trait::async_trait;
use bytes::Bytes;
use serde_json::{Value, json};
use socrates_gateway::air::Air;
use socrates_gateway::hub::Shelf;
use socrates_gateway::judge::standing;
use socrates_gateway::run::{Run, Standing};
use socrates_gateway::scene::Scene;
use socrates_link::rules::Role;
use socrates_link::{Bus, Mode, ZenohConfig};
use socrates_model::driver::map_cells;
use socrates_model::{RunId, SimTime};
use socrates_simulation::scene::live_scene;
use tokio::task::JoinHandle;

use crate::batch;
use crate::bundle::{self, Manifest};
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::keys;
use crate::layout;
use crate::process::client;
use crate::supervise::endpoint;

/// How often the folder is looked at for a bus.
const LOOK: Duration = Duration::from_millis(400);
/// Bundles of a folder that are listed.
const LISTED: usize = 2_000;

/// What is viewed.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// A folder, which may come to be.
    Folder(PathBuf),
    /// An endpoint of the bus.
    Endpoint(String),
}

impl Place {
    /// Reads what a person named.
    pub(super) fn of(what: &str) -> Result<Self, Diagnostic> {
        let path = Path::new(what);
        if path.is_dir() || bundle::is_bundle(path) {
            return Ok(Self::Folder(path.to_path_buf()));
        }
        if what.contains('/') && endpoint(what).is_some() {
            return Ok(Self::Endpoint(what.to_owned()));
        }
        Err(Diagnostic::input(
            format!("`{what}` is no folder"),
            "name the folder of a run, a bundle, a folder of bundles, or an endpoint such as tcp/127.0.0.1:7447@main",
        ))
    }

    /// Endpoint and namespace of its bus, if there is one now.
    fn bus(&self) -> Option<(String, String)> {
        match self {
            // A run of one scenario lies in a folder of its own.
            Self::Folder(folder) => endpoint(folder.to_str()?).or_else(|| {
                let below = std::fs::read_dir(folder).ok()?.take(LISTED).filter_map(Result::ok);
                let mut dirs: Vec<PathBuf> = below.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
                dirs.sort();
                dirs.iter().find_map(|dir| endpoint(dir.to_str()?))
            }),
            Self::Endpoint(what) => endpoint(what),
        }
    }

    /// Whether the keys that it needs are there.
    pub(super) fn check(&self, config: &Config) -> Result<(), Diagnostic> {
        let Self::Endpoint(what) = self else { return Ok(()) };
        let Some((endpoint, namespace)) = endpoint(what) else { return Ok(()) };
        let keys = keys::of(config, Role::Viewer, &endpoint)?;
        let settings = ZenohConfig::new(Mode::Client, &namespace, "view").connect(&endpoint).credentials(keys);
        settings.check().map_err(|why| keys::told(why, &format!("cannot view `{endpoint}`"), ""))
    }

    fn folder(&self) -> Option<&Path> {
        match self {
            Self::Folder(folder) => Some(folder),
            Self::Endpoint(_) => None,
        }
    }
}

/// The bus of now.
struct Joined {
    at: (String, String),
    bus: Arc<dyn Bus>,
    air: Arc<Air>,
}

/// Names of a bundle's runs, with what the list says of them.
type Lines = Arc<Vec<(RunId, Value)>>;

/// The runs of a place.
pub(super) struct Folder {
    place: Place,
    config: Config,
    /// Bundles whose manifest was read, and when that was written.
    known: Mutex<BTreeMap<PathBuf, (SystemTime, Lines)>>,
    joined: Mutex<Option<Joined>>,
    looking: Mutex<Option<JoinHandle<()>>>,
}

impl Folder {
    /// Looks at the place from now on: a bus that comes, goes, or is another one is joined.
    pub(super) fn watch(place: Place, config: Config) -> Arc<Self> {
        let folder = Arc::new(Self {
            place,
            config,
            known: Mutex::default(),
            joined: Mutex::default(),
            looking: Mutex::default(),
        });
        let looks = Arc::downgrade(&folder);
        let looking = tokio::spawn(async move {
            let mut look = tokio::time::interval(LOOK);
            loop {
                look.tick().await;
                let Some(folder) = looks.upgrade() else { return };
                folder.join().await;
            }
        });
        *folder.looking.lock().unwrap_or_else(PoisonError::into_inner) = Some(looking);
        folder
    }

    async fn join(&self) {
        let now = self.place.bus();
        let before = self.joined().as_ref().map(|joined| joined.at.clone());
        let Some(at) = now.filter(|at| before.as_ref() != Some(at)) else { return };
        let (endpoint, namespace) = &at;
        let Ok(bus) = client(&self.config, Role::Viewer, endpoint, namespace, "view").await else { return };
        match Air::listen(Arc::clone(&bus)).await {
            Ok(air) => {
                let old = self.joined().replace(Joined { at, bus, air: Arc::new(air) });
                if let Some(old) = old {
                    old.bus.close().await;
                }
            }
            Err(why) => tracing::warn!(%why, "the bus of the run cannot be listened to"),
        }
    }

    fn joined(&self) -> std::sync::MutexGuard<'_, Option<Joined>> {
        self.joined.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn air(&self) -> Option<Arc<Air>> {
        self.joined().as_ref().map(|joined| Arc::clone(&joined.air))
    }

    /// Leaves the bus.
    pub(super) async fn close(&self) {
        let looking = self.looking.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(looking) = looking {
            looking.abort();
        }
        let joined = self.joined().take();
        if let Some(joined) = joined {
            joined.bus.close().await;
        }
    }

    /// The finished bundles of the folder, the folder itself among them, with their runs.
    fn bundles(&self) -> Vec<(PathBuf, Lines)> {
        let Some(folder) = self.place.folder() else { return Vec::new() };
        if let Some(lines) = self.lines(folder) {
            return vec![(folder.to_path_buf(), lines)];
        }
        let names = batch::bundles(folder).unwrap_or_default();
        let dirs = names.into_iter().take(LISTED).map(|name| folder.join(name));
        dirs.filter_map(|dir| self.lines(&dir).map(|lines| (dir, lines))).collect()
    }

    /// The runs of a bundle; its manifest is read once, as long as nobody writes it anew: pages ask for the list again and again.
    fn lines(&self, dir: &Path) -> Option<Lines> {
        let file = bundle::archive(dir).unwrap_or_else(|| dir.join(layout::MANIFEST.path));
        let written = std::fs::metadata(file).ok()?.modified().ok()?;
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((at, lines)) = known.get(dir)
            && *at == written
        {
            return Some(Arc::clone(lines));
        }
        let lines = Arc::new(runs_of(&bundle::manifest(dir)?));
        known.insert(dir.to_path_buf(), (written, Arc::clone(&lines)));
        Some(lines)
    }

    /// The run of a bundle, read whole.
    fn kept(&self, name: &RunId) -> Result<Option<Run>, String> {
        let found = self.bundles().into_iter().find_map(|(dir, lines)| {
            let place = lines.iter().position(|(run, _)| run == name)?;
            Some((dir, place))
        });
        let Some((dir, place)) = found else { return Ok(None) };
        let bundle = bundle::read_some(&dir, |index, _| index == place).map_err(|why| why.to_string())?;
        let Some((recording, report)) = bundle.runs.first().cloned() else { return Ok(None) };
        let entry = bundle.manifest.runs.get(place);
        let path = entry.map(|entry| layout::RECORDINGS.of(&entry.run())).unwrap_or_default();
        let file = bundle::file(&dir, &path).map_err(|why| why.what)?;
        let robot = (!recording.header.planner.is_no_robot()).then_some(&bundle.request.robot.model);
        let cells = map_cells(&bundle.location.grid);
        let told = live_scene(&bundle.location, &cells, &bundle.paths, robot, bundle.request.robot.waypoints);
        let scene = Scene::of(recording.header.clone(), bundle.manifest.scenario, bundle.location, &told);
        let time_s = SimTime::of_last(recording.ticks() as u64).secs();
        let standing: Standing = standing(&report, time_s, true);
        Ok(Some(Run::kept(scene, recording, Bytes::from(file), standing)))
    }
}

/// Names of a bundle's runs, with what its manifest says of them.
fn runs_of(manifest: &Manifest) -> Vec<(RunId, Value)> {
    let Ok(scenario) = socrates_model::ScenarioId::new(&manifest.scenario) else { return Vec::new() };
    let line = |entry: &bundle::RunEntry| {
        let run = entry.run().id(&scenario);
        let told = json!({
            "run": run, "state": "kept", "planner": entry.planner, "seed": entry.seed, "title": manifest.scenario,
            "location": null, "time_s": null, "agents": null, "verdict": entry.verdict,
        });
        (run, told)
    };
    manifest.runs.iter().map(line).collect()
}

/// The folder as the gateway asks it.
pub(super) struct Runs(pub(super) Arc<Folder>);

#[async_trait]
impl Shelf for Runs {
    async fn list(&self) -> Vec<(RunId, Value)> {
        let folder = Arc::clone(&self.0);
        let kept = tokio::task::spawn_blocking(move || {
            folder.bundles().iter().flat_map(|(_, lines)| lines.to_vec()).collect::<Vec<_>>()
        });
        let mut lines = kept.await.unwrap_or_default();
        if let Some(air) = self.0.air() {
            lines.extend(air.list().await);
        }
        lines
    }

    async fn open(&self, run: &RunId) -> Result<Option<Run>, String> {
        // A bundle is written when all is over: then it has more than the bus.
        if let Some(run) = self.kept(run).await? {
            return Ok(Some(run));
        }
        match self.0.air() {
            Some(air) => air.open(run).await,
            None => Ok(None),
        }
    }

    async fn kept(&self, run: &RunId) -> Result<Option<Run>, String> {
        let (folder, name) = (Arc::clone(&self.0), run.clone());
        let kept = tokio::task::spawn_blocking(move || folder.kept(&name));
        kept.await.unwrap_or_else(|why| Err(why.to_string()))
    }

    async fn begin(&self, run: &Arc<Run>) {
        if let Some(air) = self.0.air() {
            air.begin(run).await;
        }
    }
}
