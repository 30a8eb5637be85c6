//! `study new`: a study file from the bundles of a comparison.

use std::path::{Component, Path, PathBuf};

use serde_json::json;
use socrates_model::{Digest, HumanId, PlannerName};
use socrates_study::design::{Design, williams};
use socrates_study::kit::setup::{ABOVE, CONSENT};

use super::scenes::{self, Scene};
use super::{bad, name};
use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::words::plural;

/// Letters and digits of names of films; no vowels, so that no word comes about.
const LETTERS: &[u8] = b"bcdfghjkmnpqrstvwxz";
const DIGITS: &[u8] = b"23456789";
/// Longest film that is proposed, s.
const LONGEST_S: f64 = 45.0;
/// People of a study where nothing else is said.
const PEOPLE: usize = 42;

/// Options of `study new`.
#[derive(Debug, Clone)]
pub struct NewOptions {
    /// Bundles, or folders of them.
    pub what: Vec<PathBuf>,
    /// File to write.
    pub out: PathBuf,
    /// Planners; none for those under test that all scenarios have.
    pub planners: Vec<PlannerName>,
    /// Seeds; none for the first that all have.
    pub seeds: Vec<u64>,
    /// Instruments.
    pub instruments: Vec<String>,
    /// People per scenario; none for 42 or the next multiple of the orders.
    pub people: Option<usize>,
    /// The person whose eyes films are seen with; none from above.
    pub from: Option<HumanId>,
    /// Title, which participants read.
    pub title: String,
    /// Whether an existing file may be replaced.
    pub force: bool,
}

/// Does `study new`.
pub fn new(talk: &Printer, options: &NewOptions) -> Result<(), Diagnostic> {
    if options.out.exists() && !options.force {
        return Err(Diagnostic::input(
            format!("`{}` is there already", options.out.display()),
            "--out names another file; --force replaces it",
        ));
    }
    let dirs = scenes::by_scenario(&options.what)?;
    let (planners, seeds) = chosen(options, &dirs)?;
    let mut scenes = Vec::new();
    for (scenario, dirs) in &dirs {
        scenes.push(Scene::read(scenario, dirs, &planners, &seeds)?);
    }
    let count = williams(planners.len()).len();
    let people = options.people.unwrap_or_else(|| PEOPLE.div_ceil(count) * count);
    let text = written(options, &planners, &seeds, &scenes, people)?;
    Design::parse(&text, &name(&options.out)).map_err(|why| bad(&why))?;
    files::write(&options.out, text.as_bytes())?;
    let films = scenes.len() * planners.len() * seeds.len();
    talk.line(&format!(
        "films      {films}: {}, {}, {}",
        plural(scenes.len(), "scenario"),
        plural(planners.len(), "planner"),
        plural(seeds.len(), "seed")
    ));
    talk.line(&format!("wrote      {}", options.out.display()));
    talk.line("next       fill the slots of `consent`, look at `context`, state your hypotheses; then `socrates study preregister` and `socrates study build`");
    talk.result(&json!({ "study": options.out, "films": films, "planners": planners, "seeds": seeds,
        "scenarios": scenes.iter().map(|scene| &scene.name).collect::<Vec<_>>() }));
    Ok(())
}

/// Planners and seeds.
fn chosen(
    options: &NewOptions,
    dirs: &std::collections::BTreeMap<String, Vec<PathBuf>>,
) -> Result<(Vec<PlannerName>, Vec<u64>), Diagnostic> {
    let (common, seeds) = scenes::common(dirs);
    let planners = if options.planners.is_empty() { common } else { options.planners.clone() };
    if planners.len() < 2 {
        let found: Vec<&str> = planners.iter().map(PlannerName::as_str).collect();
        let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
        return Err(Diagnostic::input(
            format!("films of at least two planners are compared, and the scenarios have in common: {found}"),
            "run the same requests with several: `socrates compare REQUEST --planner A,B,C`, or name them with --planner",
        ));
    }
    let seeds = if options.seeds.is_empty() { seeds.into_iter().take(1).collect() } else { options.seeds.clone() };
    if seeds.is_empty() {
        return Err(Diagnostic::input(
            "the scenarios have no seed in common with which all planners were run",
            "run them with the same: `socrates compare REQUESTS --planner A,B,C --seeds 1..3`",
        ));
    }
    Ok((planners, seeds))
}

/// The name of a film: it tells nothing, and is the same every time.
fn opaque(of: &str, taken: &[String], planners: &[PlannerName]) -> String {
    let mut round = 0_u32;
    loop {
        let digest = Digest::of(format!("film {of} {round}").as_bytes()).to_string();
        let pairs: Vec<usize> =
            (0..5).filter_map(|at| usize::from_str_radix(digest.get(at * 4 + 8..at * 4 + 12)?, 16).ok()).collect();
        let from = |letters: &[u8], at: usize| {
            let place = pairs.get(at).copied().unwrap_or(0) % letters.len();
            char::from(letters.get(place).copied().unwrap_or(b'x'))
        };
        let id: String = [from(LETTERS, 0), from(DIGITS, 1), from(LETTERS, 2), from(LETTERS, 3)].iter().collect();
        if !taken.contains(&id) && !planners.iter().any(|planner| id.contains(planner.as_str())) {
            return id;
        }
        round += 1;
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn list(texts: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let quoted: Vec<String> = texts.into_iter().map(|text| quoted(text.as_ref())).collect();
    format!("[{}]", quoted.join(", "))
}

/// A path as the study file names it: relative to the file's folder where both exist.
fn relative(file: &Path, path: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let (Ok(from), Ok(to)) = (std::path::absolute(folder), std::path::absolute(path)) else {
        return path.display().to_string();
    };
    let plain = |path: &Path| -> Vec<String> {
        let parts = path.components().filter(|part| !matches!(part, Component::CurDir));
        parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let (from, to) = (plain(&from), plain(&to));
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from.iter().skip(shared).map(|_| "..".to_owned());
    up.chain(to.iter().skip(shared).cloned()).collect::<Vec<_>>().join("/")
}

fn written(
    options: &NewOptions,
    planners: &[PlannerName],
    seeds: &[u64],
    scenes: &[Scene],
    people: usize,
) -> Result<String, Diagnostic> {
    let view = options.from.map_or_else(|| ABOVE.to_owned(), |who| who.to_string());
    let mut text = format!(
        "# A study of people who rate films of robots; docs/study.md explains every key.\n\
         title = {}                # participants read it\n\
         planners = {}             # the first is the reference of odds ratios\n\
         participants = {people}   # per scenario; a multiple of {}\n\
         all_scenarios = false     # true: each person sees several scenarios, up to films_per_person films (default 6)\n\
         instruments = {}\n\
         checks = {{ check1 = 4, check2 = 2 }}   # attention checks and their right answers\n\
         alpha = 0.05\n\
         # margin = 0.5            # smallest difference that matters, points: then equivalence is tested\n\
         seed = 1\n\n\
         # State what you expect before anybody answers; what no hypothesis names is exploratory.\n\
         # [[hypothesis]]\n# text = \"People rate … as better adapted.\"\n# dimension = \"psi.AB\"\n\n\
         [survey]\n\
         # completion_code = \"…\"  # of the recruiting platform, shown last\n\
         # completion_url = \"https://app.prolific.com/submissions/complete?cc=…\"\n\
         consent = \"\"\"\n{CONSENT}\n\"\"\"\n",
        quoted(&options.title),
        list(planners.iter().map(PlannerName::as_str)),
        williams(planners.len()).len(),
        list(&options.instruments),
    );
    for scene in scenes {
        let dirs: std::collections::BTreeSet<String> =
            scene.runs.iter().map(|(dir, ..)| relative(&options.out, dir)).collect();
        text.push_str(&format!(
            "\n[[scenario]]\nname = {}\nbundles = {}\ncontext = {}   # people read it before the film\nview = \"{view}\"   # above, or a person such as human_2\nlongest_s = {LONGEST_S}\n",
            quoted(&scene.name),
            list(&dirs),
            quoted(&scene.context()),
        ));
    }
    let mut taken: Vec<String> = Vec::new();
    for scene in scenes {
        for planner in planners {
            for seed in seeds {
                let id = opaque(&format!("{} {} {planner} {seed}", options.title, scene.name), &taken, planners);
                text.push_str(&format!(
                    "\n[[film]]\nid = \"{id}\"\nscenario = {}\nplanner = {}\nseed = {seed}\nlength_s = {}\n",
                    quoted(&scene.name),
                    quoted(planner.as_str()),
                    scene.length_s(LONGEST_S)
                ));
                taken.push(id);
            }
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_films_tell_nothing_and_differ() {
        let planners = [PlannerName::new("mppi").unwrap()];
        let mut taken = Vec::new();
        for at in 0..200 {
            let id = opaque(&format!("study scenario mppi {at}"), &taken, &planners);
            assert!(id.len() == 4 && !taken.contains(&id), "{id}");
            assert!(id.chars().next().unwrap().is_ascii_alphabetic());
            taken.push(id);
        }
        assert_eq!(opaque("a", &[], &planners), opaque("a", &[], &planners));
    }

    #[test]
    fn bundles_are_named_from_the_folder_of_the_study() {
        assert_eq!(relative(Path::new("study.toml"), Path::new("runs/a")), "runs/a");
        assert_eq!(relative(Path::new("/x/studies/study.toml"), Path::new("/x/runs/a")), "../runs/a");
    }
}
