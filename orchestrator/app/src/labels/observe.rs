//! `labels observe`: a page for observers, who look at films once and move a slider, follow a belief, or choose of two; and its key.

use std::path::{Path, PathBuf};

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use serde_json::{Value, json};
use socrates_draw::{Look, LookKind, ObservePage, Observed};
use socrates_model::seeds::stream_seed;
use socrates_model::{Point, Recording};
use socrates_scoring::fidelity::Signals;
use socrates_scoring::metrics::{Scene, rival_goals};
use socrates_scoring::{Evidence, Tracks};

use super::blind::{Candidate, candidates, names, shuffle};
use super::task::{self, Task, Truth};
use super::{MOST, too_many};
use crate::batch;
use crate::bundle;
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::progress::Progress;

/// What `labels observe` is given.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
pub struct ObserveOptions {
    /// Bundles, or folders of bundles.
    pub bundles: Vec<PathBuf>,
    /// File of the page; the key is written beside it.
    pub out: PathBuf,
    /// Only the first run of each bundle.
    pub first: bool,
    /// Heading of the page.
    pub title: String,
    /// A slider after each film.
    pub slider: bool,
    /// A belief during each film.
    pub belief: bool,
    /// Pairs of planners.
    pub pairs: bool,
    /// Films that come once more.
    pub repeat: usize,
    /// Films that every rater rates.
    pub control: usize,
    /// How many of the others a rater gets; none for all.
    pub each: Option<usize>,
    /// Seed of every order.
    pub seed: u64,
}

/// A film that is on the page.
struct Film {
    name: String,
    /// Bundle it is from and seed of the run: pairs are of one bundle and seed.
    scene: (PathBuf, u64),
    run: String,
    planner: String,
    goals: Option<[Point; 2]>,
}

/// Does `labels observe`.
///
/// # Errors
/// Nothing that is asked, bundles that hold no run, too many runs, no pair or no second goal where these are asked for, more repeats
/// than films.
pub fn observe(talk: &Printer, options: &ObserveOptions) -> Result<(), Diagnostic> {
    let asks = options.slider || options.belief || options.pairs;
    if !asks {
        return Err(Diagnostic::input(
            "nothing is asked of observers",
            "--slider, --belief or --pairs; several may stand together",
        ));
    }
    let mut found = candidates(&options.bundles, options.first, false)?;
    if found.is_empty() {
        return Err(Diagnostic::input("the bundles hold no run with a robot", "`socrates run` makes one"));
    }
    if found.len() > MOST {
        return Err(too_many(found.len()));
    }
    shuffle(&mut found, options.seed);
    let mut chance = ChaCha8Rng::seed_from_u64(stream_seed(options.seed, "sides of observed films"));
    let mut side = || chance.next_u64() & 1 == 1;
    let mut page = ObservePage::default();
    let mut films: Vec<Film> = Vec::new();
    let mut progress = Progress::new(*talk, "drawing", found.len());
    for (index, (Candidate { dir, run, .. }, name)) in found.iter().zip(names(found.len())).enumerate() {
        progress.at(index, &name);
        let bundle = bundle::read_some(dir, |_, entry| entry.run() == *run)?;
        let Some((recording, report)) = bundle.runs.first() else { return Err(batch::none(dir)) };
        let goals = if options.belief { goals(&bundle, recording) } else { None };
        let all: [&Recording; 1] = [recording];
        let (location, paths, context) = (&bundle.location, &bundle.paths, bundle.request.social_context.trim());
        // On either side the true goal stands as often.
        let shown = goals.map(|[goal, other]| if side() { [goal, other] } else { [other, goal] });
        page.add(&Observed { location, paths, all: &all, recording, context, goals: shown });
        let truth = goals.zip(shown);
        films.push(Film {
            name,
            scene: (dir.clone(), report.seed),
            run: report.run.to_string(),
            planner: report.planner.to_string(),
            goals: truth.map(|([goal, _], [a, _])| [goal, a]),
        });
    }
    drop(progress);
    let tasks = tasks(&films, options, &mut side)?;
    let told: Vec<(String, Look)> = tasks.iter().map(|(task, look)| (task.id.clone(), *look)).collect();
    let each = options.each.unwrap_or(films.len());
    files::write(&options.out, page.html(&options.title, &told, each).as_bytes())?;
    let key = options.out.parent().map_or_else(PathBuf::new, Path::to_path_buf).join(task::FILE);
    let rows: Vec<Task> = tasks.into_iter().map(|(task, _)| task).collect();
    files::write(&key, task::write(&rows).as_bytes())?;
    let count = |kind: LookKind| rows.iter().filter(|task| task.kind == kind).count();
    talk.line(&format!("wrote      {} · {} films", options.out.display(), films.len()));
    talk.line(&format!(
        "asks       {} sliders, {} again, {} beliefs, {} pairs",
        count(LookKind::Rate),
        count(LookKind::Again),
        count(LookKind::Belief),
        count(LookKind::Pair)
    ));
    let counts: serde_json::Map<String, Value> =
        LookKind::ALL.iter().map(|kind| (kind.word().to_owned(), count(*kind).into())).collect();
    talk.line(&format!("key        {} tells which film is which: keep it from the observers", key.display()));
    talk.result(&json!({
        "page": options.out.display().to_string(), "key": key.display().to_string(), "films": films.len(),
        "tasks": counts,
    }));
    Ok(())
}

/// The goal of a run and another place that it might be taken to go to.
fn goals(bundle: &bundle::Bundle, recording: &Recording) -> Option<[Point; 2]> {
    let evidence = Evidence {
        location: Some(&bundle.location),
        proposal: Some(&bundle.proposal),
        paths: Some(&bundle.paths),
        ..Evidence::of(recording)
    };
    let tracks = Tracks::read(recording).ok()?;
    let signals = Signals::new(&evidence, &tracks);
    rival_goals(&Scene::new(&signals))
}

/// Everything that is asked, with its row of the key.
fn tasks(
    films: &[Film],
    options: &ObserveOptions,
    side: &mut dyn FnMut() -> bool,
) -> Result<Vec<(Task, Look)>, Diagnostic> {
    let mut looks: Vec<Look> = Vec::new();
    if options.slider {
        let control = options.control.min(films.len());
        if options.repeat > control {
            return Err(Diagnostic::input(
                format!("`--repeat {}` is more than the `{control}` films that every observer rates", options.repeat),
                "name more bundles, more --control or fewer repeats: only a film that everybody rates can come again",
            ));
        }
        looks.extend((0..films.len()).map(|film| Look::Rate { film, all: film < control }));
        looks.extend((0..options.repeat).map(|film| Look::Again { film }));
    }
    if options.belief {
        let with = (0..films.len()).filter(|film| films.get(*film).is_some_and(|film| film.goals.is_some()));
        let before = looks.len();
        looks.extend(with.map(|film| Look::Belief { film }));
        if looks.len() == before {
            return Err(Diagnostic::input(
                "no run has a second place that it might be going to",
                "a belief needs a scene graph with a junction or an end 3 m or more from goal and start; leave out --belief",
            ));
        }
    }
    if options.pairs {
        let before = looks.len();
        for (left, one) in films.iter().enumerate() {
            for (right, other) in films.iter().enumerate().skip(left + 1) {
                if one.scene == other.scene && one.planner != other.planner {
                    looks.push(if side() {
                        Look::Pair { left, right }
                    } else {
                        Look::Pair { left: right, right: left }
                    });
                }
            }
        }
        if looks.len() == before {
            return Err(Diagnostic::input(
                "no two runs are of one scenario and seed under different planners",
                "`socrates compare` makes them; leave out --first, or --pairs",
            ));
        }
    }
    let row = |(number, look): (usize, Look)| {
        let (one, other) = match look {
            Look::Rate { film, .. } | Look::Again { film } | Look::Belief { film } => (films.get(film), None),
            Look::Pair { left, right } => (films.get(left), films.get(right)),
        };
        let truth = match (look, one.and_then(|film| film.goals)) {
            (Look::Belief { .. }, Some([goal, a])) => Some(if goal == a { Truth::A } else { Truth::B }),
            (Look::Belief { .. } | Look::Rate { .. } | Look::Again { .. } | Look::Pair { .. }, _) => None,
        };
        let of = |film: Option<&Film>| {
            film.map(|film| [film.name.clone(), film.run.clone(), film.planner.clone()]).unwrap_or_default()
        };
        let ([film, run, planner], [other, other_run, other_planner]) = (of(one), of(other));
        let id = format!("t{:03}", number + 1);
        (Task { id, kind: look.kind(), film, run, planner, other, other_run, other_planner, truth }, look)
    };
    Ok(looks.into_iter().enumerate().map(row).collect())
}
