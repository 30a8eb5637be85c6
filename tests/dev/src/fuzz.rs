//! `socrates-dev fuzz`: damaged inputs at every door, each of which must be read or refused with the name of its file.
//!
//! ```text
//! good input ─► damage (seeded) ─► a lane: a thread with a folder of its own ─► read │ refused │ panicked │ hung
//! ```
//!
//! An input that is not answered within the limit keeps its thread, which nothing can end; another lane goes on.

mod doors;
mod mutate;

use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::json;
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::files;
use socrates_app::output::Printer;
use socrates_app::words::plural;

use crate::fuzz::doors::{ALARM, DOORS, Door, Kit, Sample, damage};
use crate::fuzz::mutate::Chance;
use crate::program;

/// Options of `socrates-dev fuzz`.
#[derive(Debug, Clone)]
pub struct FuzzOptions {
    /// Damaged inputs for each door.
    pub seeds: u64,
    /// Seed of the first of them.
    pub first: u64,
    /// Only this door; may be repeated. Default: all of them.
    pub door: Vec<String>,
    /// Longest time for one input, s.
    pub limit: u64,
    /// Folder that keeps the inputs that were not answered well.
    pub keep: PathBuf,
    /// Bundle to damage; default: one of the shipped request is made.
    pub bundle: Option<PathBuf>,
}

/// How an input ended.
#[derive(Debug, Clone, PartialEq, Eq)]
enum End {
    Read,
    Refused,
    /// Refused without the name of a file, in these words.
    Unnamed(String),
    /// Called our fault, in these words.
    Ours(String),
    /// Panicked, with place and words.
    Panicked(String),
    Hung,
}

impl End {
    /// What is wrong, in a word; `None` for a good answer.
    const fn word(&self) -> Option<&'static str> {
        match self {
            Self::Read | Self::Refused => None,
            Self::Unnamed(_) => Some("unnamed"),
            Self::Ours(_) => Some("ours"),
            Self::Panicked(_) => Some("panicked"),
            Self::Hung => Some("hung"),
        }
    }

    fn why(&self) -> &str {
        match self {
            Self::Unnamed(why) | Self::Ours(why) | Self::Panicked(why) => why,
            Self::Read | Self::Refused | Self::Hung => "",
        }
    }
}

/// Where the newest panic was; the hook of the process writes it.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// What a door is called with: it, its good inputs, and what they need.
struct Test {
    kit: Arc<Kit>,
    door: &'static Door,
    samples: Vec<Sample>,
}

impl Test {
    /// The damaged input of a seed, with the sample that it was made of.
    fn input(&self, seed: u64) -> Option<(&Sample, Vec<u8>)> {
        let mut chance = Chance::of(seed, self.door.name);
        let sample = chance.pick(&self.samples)?;
        let bytes = damage(&self.kit, self.door, sample, &mut chance);
        Some((sample, bytes))
    }

    /// Lets the input of a seed in; the folder is as before afterwards.
    fn one(&self, folder: &Path, seed: u64) -> End {
        let Some((sample, bytes)) = self.input(seed) else { return End::Read };
        let path = folder.join(&sample.file);
        if let Err(why) = std::fs::write(&path, &bytes) {
            return End::Ours(format!("`{}` cannot be written: {why}", path.display()));
        }
        let mut chance = Chance::of(seed, "open");
        let open = || (self.door.open)(&self.kit, folder, sample, &bytes, &mut chance);
        let end = match std::panic::catch_unwind(AssertUnwindSafe(open)) {
            Ok(Ok(())) => End::Read,
            Ok(Err(why)) => self.judged(folder, &why),
            Err(_payload) => End::Panicked(PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone()),
        };
        match std::fs::write(&path, &sample.bytes) {
            Ok(()) => end,
            Err(why) => End::Ours(format!("`{}` cannot be written: {why}", path.display())),
        }
    }

    fn judged(&self, folder: &Path, why: &Diagnostic) -> End {
        let text = why.to_string();
        if why.code == Code::Ours {
            return End::Ours(text);
        }
        let last = |file: &str| file.rsplit('/').next().unwrap_or(file).to_owned();
        let inside = format!("{}/", folder.display());
        let is_named = text.contains(&inside) || self.samples.iter().any(|sample| text.contains(&last(&sample.file)));
        if is_named || !self.door.names_file { End::Refused } else { End::Unnamed(text) }
    }
}

/// A thread that lets inputs in, one after the other.
struct Lane {
    seeds: SyncSender<u64>,
    ends: Receiver<End>,
}

impl Lane {
    fn start(test: &Arc<Test>, folder: PathBuf) -> std::io::Result<Self> {
        std::fs::create_dir_all(&folder)?;
        test.kit.furnish(test.door, &folder)?;
        let (seeds, wanted) = sync_channel::<u64>(1);
        let (made, ends) = sync_channel::<End>(1);
        let test = Arc::clone(test);
        std::thread::Builder::new().name(test.door.name.to_owned()).stack_size(8 << 20).spawn(move || {
            for seed in wanted {
                if made.send(test.one(&folder, seed)).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { seeds, ends })
    }
}

/// One input that was not answered well.
struct Find {
    door: &'static str,
    seed: u64,
    end: End,
    kept: PathBuf,
}

/// Counts of one door.
#[derive(Default)]
struct Tally {
    read: u64,
    refused: u64,
    unnamed: u64,
    ours: u64,
    panicked: u64,
    hung: u64,
}

impl Tally {
    fn add(&mut self, end: &End) {
        let slot = match end {
            End::Read => &mut self.read,
            End::Refused => &mut self.refused,
            End::Unnamed(_) => &mut self.unnamed,
            End::Ours(_) => &mut self.ours,
            End::Panicked(_) => &mut self.panicked,
            End::Hung => &mut self.hung,
        };
        *slot += 1;
    }
}

/// Lets damaged inputs in at every door and says which were not answered well.
pub fn fuzz(talk: &Printer, config: &Config, options: &FuzzOptions) -> Result<(), Diagnostic> {
    let doors = wanted(&options.door)?;
    let cannot = |why: std::io::Error| {
        Diagnostic::input(
            format!("cannot write into `{}`: {why}", options.keep.display()),
            "--keep chooses another folder",
        )
    };
    // An input that ends the whole process is still here afterwards.
    let work = options.keep.join("work");
    if work.exists() {
        std::fs::remove_dir_all(&work).map_err(cannot)?;
    }
    std::fs::create_dir_all(&work).map_err(cannot)?;
    let bundle = match &options.bundle {
        Some(bundle) => bundle.clone(),
        None => demo(config, &work)?,
    };
    let kit = Arc::new(Kit::of(config, &bundle, &work)?);
    std::panic::set_hook(Box::new(|info| {
        *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string();
    }));
    talk.line(&format!(
        "{:<12}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
        "door", "inputs", "read", "refused", "unnamed", "ours", "panicked", "hung"
    ));
    let (mut finds, mut rows) = (Vec::new(), Vec::new());
    for door in doors {
        let tally = at(talk, door, &kit, options, &work, &mut finds)?;
        let Tally { read, refused, unnamed, ours, panicked, hung } = tally;
        talk.line(&format!(
            "{:<12}{:>9}{read:>9}{refused:>9}{unnamed:>9}{ours:>9}{panicked:>9}{hung:>9}",
            door.name, options.seeds
        ));
        rows.push(json!({ "door": door.name, "inputs": options.seeds, "read": read, "refused": refused,
            "unnamed": unnamed, "ours": ours, "panicked": panicked, "hung": hung }));
    }
    drop(std::panic::take_hook());
    let listed: Vec<_> = finds
        .iter()
        .map(|find| {
            json!({ "door": find.door, "seed": find.seed, "what": find.end.word(), "why": find.end.why(),
                "input": find.kept.display().to_string() })
        })
        .collect();
    let result = json!({ "doors": rows, "finds": listed });
    // What hangs may still write into its folder.
    if let Err(why) = std::fs::remove_dir_all(&work) {
        talk.warn(&format!("`{}` is left: {why}", work.display()));
    }
    if finds.is_empty() {
        // Only where nothing of the user's is in it.
        drop(std::fs::remove_dir(&options.keep));
        talk.result(&result);
        return Ok(());
    }
    let what = format!("{} not answered well", plural(finds.len(), "input"));
    let mut diagnostic =
        Diagnostic::input(what, "the same again: `socrates-dev fuzz --door DOOR --first SEED --seeds 1`");
    diagnostic.code = Code::Ours;
    diagnostic.causes = finds
        .iter()
        .map(|find| {
            let word = find.end.word().unwrap_or_default();
            let why: String = find.end.why().replace('\n', " · ").chars().take(300).collect();
            format!("{} seed {} {word}: {} {why}", find.door, find.seed, find.kept.display())
        })
        .collect();
    diagnostic.result = Some(Box::new(result));
    Err(diagnostic)
}

/// The doors of these names, or all that are real.
fn wanted(names: &[String]) -> Result<Vec<&'static Door>, Diagnostic> {
    if names.is_empty() {
        return Ok(DOORS.iter().collect());
    }
    let found = |name: &String| {
        DOORS.iter().chain([&ALARM]).find(|door| door.name == name.as_str()).ok_or_else(|| {
            let known: Vec<&str> = DOORS.iter().map(|door| door.name).collect();
            Diagnostic::input(format!("there is no door `{name}`"), format!("doors: {}", known.join(", ")))
        })
    };
    names.iter().map(found).collect()
}

/// A bundle of the shipped request.
fn demo(config: &Config, work: &Path) -> Result<PathBuf, Diagnostic> {
    let ours = |why: String| Diagnostic::input(why, "`--bundle` takes one that was made before").with_code(Code::Ours);
    let program = program::of(config)?;
    let bundle = work.join("bundle");
    let made = std::process::Command::new(program)
        .args(["demo", "--out"])
        .arg(&bundle)
        .output()
        .map_err(|why| ours(format!("the demo cannot be run: {why}")))?;
    if !bundle.join(socrates_app::layout::MANIFEST.path).is_file() {
        return Err(ours(format!("the demo made no bundle: {}", String::from_utf8_lossy(&made.stderr))));
    }
    Ok(bundle)
}

/// All inputs of one door.
fn at(
    talk: &Printer,
    door: &'static Door,
    kit: &Arc<Kit>,
    options: &FuzzOptions,
    work: &Path,
    finds: &mut Vec<Find>,
) -> Result<Tally, Diagnostic> {
    let test = Arc::new(Test { kit: Arc::clone(kit), door, samples: (door.samples)(kit) });
    let ours = |why: String| Diagnostic::input(why, "").with_code(Code::Ours);
    if test.samples.is_empty() {
        return Err(ours(format!("the door `{}` has no good input", door.name)));
    }
    let mut lanes = 0_u32;
    let mut lane = || {
        lanes += 1;
        Lane::start(&test, work.join(format!("{}-{lanes}", door.name)))
            .map_err(|why| ours(format!("no thread can be started: {why}")))
    };
    let mut now = lane()?;
    let mut tally = Tally::default();
    for seed in options.first..options.first.saturating_add(options.seeds) {
        talk.passing(&format!("{} {seed}", door.name));
        now.seeds.send(seed).map_err(|why| ours(why.to_string()))?;
        let end = match now.ends.recv_timeout(Duration::from_secs(options.limit)) {
            Ok(end) => end,
            Err(RecvTimeoutError::Timeout) => {
                now = lane()?;
                End::Hung
            }
            Err(RecvTimeoutError::Disconnected) => {
                now = lane()?;
                End::Panicked("the thread ended".to_owned())
            }
        };
        tally.add(&end);
        if let Some(word) = end.word() {
            let Some((sample, bytes)) = test.input(seed) else { continue };
            let file = sample.file.replace('/', "-");
            let kept = options.keep.join(format!("{}-{seed}-{word}-{file}", door.name));
            files::write(&kept, &bytes)?;
            finds.push(Find { door: door.name, seed, end, kept });
        }
    }
    talk.clear();
    Ok(tally)
}
