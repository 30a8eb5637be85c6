//! `labels page --films`: a page for judges who must not know what they look at, the stills of its runs, and the key to them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use serde_json::json;
use socrates_draw::{Asks, LabelPage, Labeled, Signs};
use socrates_model::seeds::stream_seed;
use socrates_model::{Recording, Run};
use socrates_stream::csv::joined;

use super::key::{self, Named};
use super::{MOST, PageOptions, folders, texts, too_many};
use crate::batch;
use crate::bundle;
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::output::Printer;
use crate::progress::Progress;

/// A page with more bytes has its films beside it.
const MOST_BYTES: usize = 50_000_000;
/// Where the stills lie beside the page.
const STILLS: &str = "stills";
/// What judges are told; its places are filled here.
const PROTOCOL: &str = include_str!("PROTOCOL.md");
const CONTROLS: &str = "Among the runs is a control set, unmarked: runs of which it is known that something of the request did not happen. A judge who passes\n\
    more than 4 of 20 of them as `as_asked` is replaced.\n";
const NO_CONTROLS: &str = "No control set is mixed in with these runs, so nothing is known of the judges themselves; say so beside what is published.\n";

/// What makes a page blind.
#[derive(Debug, Clone)]
pub struct Blind {
    /// Stills of each run, 2 to 24.
    pub stills: usize,
    /// Seed of the order in which runs are numbered.
    pub seed: u64,
    /// Folders of bundles that are mixed in, unmarked: controls.
    pub mixed_in: Vec<PathBuf>,
}

/// A run that will be judged.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) dir: PathBuf,
    pub(super) run: Run,
    control: bool,
}

/// Writes the page and what lies beside it.
pub(super) fn page(talk: &Printer, options: &PageOptions, blind: &Blind) -> Result<(), Diagnostic> {
    if !socrates_draw::stills::STILLS.contains(&blind.stills) {
        let (least, most) = (socrates_draw::stills::STILLS.start(), socrates_draw::stills::STILLS.end());
        return Err(Diagnostic::input(
            format!("`--stills` is `{}`", blind.stills),
            format!("allowed: {least} to {most} stills of a run"),
        ));
    }
    let mut candidates = candidates(&options.bundles, options.first, false)?;
    let asked = candidates.len();
    candidates.extend(self::candidates(&blind.mixed_in, options.first, true)?);
    apart(&candidates)?;
    if asked == 0 {
        return Err(Diagnostic::input("the bundles hold no run with a robot", "`socrates run` makes one"));
    }
    if candidates.len() > MOST {
        return Err(too_many(candidates.len()));
    }
    shuffle(&mut candidates, blind.seed);
    let names = names(candidates.len());
    let folder = options.out.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    no_others(&folder.join(STILLS), &names)?;

    let mut page = LabelPage::asking(Asks::AsAsked);
    let (mut keys, mut told) = (Vec::new(), vec![joined(["run", "text"])]);
    let mut progress = Progress::new(*talk, "drawing", candidates.len());
    for (index, (candidate, name)) in candidates.iter().zip(&names).enumerate() {
        progress.at(index, name);
        let Candidate { dir, run, control } = candidate;
        let bundle = bundle::read_some(dir, |_, entry| entry.run() == *run)?;
        let Some((recording, report)) = bundle.runs.first() else { return Err(batch::none(dir)) };
        let texts = texts(&bundle.request);
        let all: [&Recording; 1] = [recording];
        let (location, paths) = (&bundle.location, &bundle.paths);
        page.add(&Labeled { name, texts: &texts, location, paths, all: &all, recording });
        let svg = socrates_draw::contact_sheet(name, location, recording, blind.stills, Signs::Numbers);
        let png = socrates_draw::png_from_svg(&svg, 1.0).map_err(|why| {
            Diagnostic::input(format!("the stills of `{}` cannot be drawn: {why}", dir.display()), "")
                .with_code(Code::Ours)
        })?;
        files::write(&folder.join(STILLS).join(format!("{name}.png")), &png)?;
        let text: Vec<String> = texts.iter().map(|(what, text)| format!("{what}: {text}")).collect();
        told.push(joined([name.as_str(), text.join("\n").as_str()]));
        keys.push(Named {
            name: name.clone(),
            bundle: dir.canonicalize().unwrap_or_else(|_why| dir.clone()).display().to_string(),
            run: report.run.to_string(),
            recording: recording.hash().to_string(),
            control: *control,
        });
    }
    drop(progress);

    let made = page.files(&options.title, MOST_BYTES);
    files::write(&options.out, made.html.as_bytes())?;
    for (path, film) in &made.films {
        files::write(&folder.join(path), film.as_bytes())?;
    }
    files::write(&folder.join(key::FILE), key::write(&keys).as_bytes())?;
    told.push(String::new());
    files::write(&folder.join("texts.csv"), told.join("\n").as_bytes())?;
    files::write(&folder.join("PROTOCOL.md"), protocol(&names, !blind.mixed_in.is_empty()).as_bytes())?;
    let key = folder.join(key::FILE);
    talk.line(&format!("wrote      {} · {} runs", options.out.display(), page.len()));
    talk.line(&format!("key        {} tells which run is which: keep it from the judges", key.display()));
    talk.result(&json!({
        "page": options.out.display().to_string(), "runs": names, "key": key.display().to_string(),
        "stills": folder.join(STILLS).display().to_string(), "films_beside": made.films.len(),
    }));
    Ok(())
}

/// The runs of these bundles, without the twins that have no robot.
pub(super) fn candidates(bundles: &[PathBuf], first: bool, control: bool) -> Result<Vec<Candidate>, Diagnostic> {
    let mut found = Vec::new();
    for dir in folders(bundles)? {
        let manifest = bundle::manifest(&dir).ok_or_else(|| batch::none(&dir))?;
        let runs = manifest.runs.iter().map(bundle::RunEntry::run).filter(|run| !run.planner.is_no_robot());
        let most = if first { 1 } else { usize::MAX };
        found.extend(runs.take(most).map(|run| Candidate { dir: dir.clone(), run, control }));
    }
    Ok(found)
}

/// Refuses a bundle that is to be judged and a control at once.
fn apart(candidates: &[Candidate]) -> Result<(), Diagnostic> {
    let settled = |dir: &Path| dir.canonicalize().unwrap_or_else(|_why| dir.to_path_buf());
    let controls: BTreeSet<PathBuf> =
        candidates.iter().filter(|candidate| candidate.control).map(|candidate| settled(&candidate.dir)).collect();
    match candidates.iter().find(|candidate| !candidate.control && controls.contains(&settled(&candidate.dir))) {
        Some(both) => Err(Diagnostic::input(
            format!("`{}` is named as a bundle and with --mixed-in", both.dir.display()),
            "a run is judged or a control, not both: name other folders",
        )),
        None => Ok(()),
    }
}

/// Another order, by the seed alone (Fisher and Yates).
pub(super) fn shuffle<T>(list: &mut [T], seed: u64) {
    let mut chance = ChaCha8Rng::seed_from_u64(stream_seed(seed, "order of judged runs"));
    for last in (1..list.len()).rev() {
        let below = u64::try_from(last).unwrap_or(u64::MAX).saturating_add(1);
        let other = usize::try_from(chance.next_u64() % below).unwrap_or(last);
        list.swap(last, other);
    }
}

/// `r01`, `r02`, …: as many digits as the last one has, two at least.
pub(super) fn names(count: usize) -> Vec<String> {
    let digits = count.to_string().len().max(2);
    (1..=count).map(|number| format!("r{number:0digits$}")).collect()
}

/// Refuses a folder with stills of another page: a judge would take them for runs.
fn no_others(stills: &Path, names: &[String]) -> Result<(), Diagnostic> {
    let mut old: Vec<String> = std::fs::read_dir(stills)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|file| !file.strip_suffix(".png").is_some_and(|name| names.iter().any(|known| known == name)))
        .collect();
    old.sort();
    match old.first() {
        Some(file) => Err(Diagnostic::input(
            format!("`{}` is none of these runs", stills.join(file).display()),
            "remove it, or choose another folder with --out FOLDER/labels.html",
        )),
        None => Ok(()),
    }
}

/// What judges are told, for these runs.
fn protocol(names: &[String], controls: bool) -> String {
    let name = |name: Option<&String>| name.cloned().unwrap_or_default();
    PROTOCOL
        .replace("{{count}}", &names.len().to_string())
        .replace("{{first}}", &name(names.first()))
        .replace("{{last}}", &name(names.last()))
        .replace("{{controls}}", if controls { CONTROLS } else { NO_CONTROLS })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_seed_and_holds_everything() {
        let shuffled = |seed: u64| {
            let mut list: Vec<u32> = (0..40).collect();
            shuffle(&mut list, seed);
            list
        };
        assert_eq!(shuffled(1), shuffled(1));
        assert_ne!(shuffled(1), shuffled(2));
        let mut all = shuffled(1);
        all.sort_unstable();
        assert_eq!(all, (0..40).collect::<Vec<u32>>());
    }

    #[test]
    fn names_sort_as_they_count() {
        assert_eq!(names(3), ["r01", "r02", "r03"]);
        let many = names(120);
        let mut sorted = many.clone();
        sorted.sort();
        assert_eq!((many[0].as_str(), many == sorted), ("r001", true));
    }

    #[test]
    fn the_protocol_has_no_empty_place_and_says_what_a_model_must_say() {
        for controls in [true, false] {
            let text = protocol(&names(12), controls);
            assert!(!text.contains("{{") && text.contains("judged by a language model, n = 12"), "{text}");
            assert_eq!(text.contains("more than 4 of 20"), controls);
        }
    }
}
