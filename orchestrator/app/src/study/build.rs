//! `study build`: films, survey page and tables of a study, as a folder that can be given to participants as it is.
//!
//! ```text
//! study.toml ─► bundles ─► films ─┬─► kit/survey: page, films
//!                                 ├─► kit/clips: the same films for other survey programs (ffmpeg)
//!                                 ├─► kit/qualtrics.*, limesurvey.txt, jspsych: the survey in their formats
//!                                 └─► study.films.csv beside the study: which film shows which planner
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;
use socrates_draw::{Film, FilmOptions, Shown};
use socrates_model::{Digest, PlannerName, Recording};
use socrates_study::design::Design;
use socrates_study::kit::media::Media;
use socrates_study::kit::{advanced, asks, jspsych, limesurvey, orders, page, qsf};
use socrates_study::plan::minutes;
use socrates_study::rating::Film as Declared;

use super::scenes::{self, Scene};
use super::{bad, design, name};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::files;
use crate::output::Printer;
use crate::progress::Progress;
use crate::video::{Kind, by_ffmpeg, wrong};

/// Pictures per second of a film in the page.
const PAGE_FPS: u32 = 15;
/// Folder of the survey page.
pub(super) const SURVEY: &str = "survey";
/// Folder of the films beside it.
pub(super) const FILMS: &str = "films";
/// Folder of films for other survey programs.
const CLIPS: &str = "clips";
/// What the kit was made from.
const LOCK: &str = "study.lock";
/// Ending of the table that tells which film shows what: `study.films.csv` beside `study.toml`, never in the kit.
const SECRET: &str = "films.csv";
/// A film may be so much longer or shorter than the study says, s.
const LENGTH_S: f64 = 0.05;

/// Whether clips for other survey programs are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clips {
    /// Where ffmpeg is installed.
    Auto,
    /// No.
    None,
}

/// Options of `study build`.
#[derive(Debug, Clone)]
pub struct BuildOptions {
    /// Study file.
    pub design: PathBuf,
    /// Folder of the kit.
    pub out: PathBuf,
    /// Clips.
    pub clips: Clips,
    /// Address with https to which the clips will be uploaded: then the survey is written for programs that carry no films.
    pub media_url: Option<String>,
}

/// What a kit was made from, and what is in it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Lock {
    format: u32,
    /// Digest of the study file.
    pub(super) study: String,
    /// Digest of every file of the kit but this one.
    files: BTreeMap<String, Digest>,
}

/// The lock of a kit.
pub(super) fn lock(kit: &Path) -> Result<Lock, Diagnostic> {
    let path = kit.join(LOCK);
    let text = files::text(&path, 64 << 20, "`socrates study build` makes a kit")?;
    serde_json::from_str(&text).map_err(|why| {
        Diagnostic::input(format!("`{}` is no lock of a kit: {why}", path.display()), "build the kit again")
    })
}

/// A film that is made, and where it is from.
struct Made {
    film: Declared,
    view: String,
    bundle: PathBuf,
    recording: Digest,
    digest: Digest,
    /// Of its pictures alone.
    pictures: Digest,
}

/// A kit on its way to the disk.
struct Kit<'k> {
    root: &'k Path,
    planners: &'k [String],
    files: BTreeMap<String, Digest>,
}

impl Kit<'_> {
    /// Writes a text that participants can reach; one that names a planner is refused.
    fn text(&mut self, path: &str, text: &str) -> Result<Digest, Diagnostic> {
        if let Some(planner) = self.planners.iter().find(|planner| names(text, planner)) {
            return Err(Diagnostic::input(
                format!("`{path}` of the kit would tell participants of the planner `{planner}`"),
                "take its name out of title, consent, instructions, contexts and items of the study",
            ));
        }
        self.bytes(path, text.as_bytes())
    }

    fn bytes(&mut self, path: &str, bytes: &[u8]) -> Result<Digest, Diagnostic> {
        files::write(&self.root.join(path), bytes)?;
        let digest = Digest::of(bytes);
        self.files.insert(path.to_owned(), digest);
        Ok(digest)
    }
}

/// Whether a text has this name as a word of its own.
fn names(text: &str, planner: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    text.match_indices(planner).any(|(at, _)| {
        let before = text.get(..at).and_then(|before| before.chars().next_back());
        let behind = text.get(at + planner.len()..).and_then(|behind| behind.chars().next());
        !before.is_some_and(part) && !behind.is_some_and(part)
    })
}

/// Does `study build`.
pub fn build(talk: &Printer, config: &Config, options: &BuildOptions) -> Result<(), Diagnostic> {
    let design = design(&options.design)?;
    let out = &options.out;
    if out.exists() && !out.join(LOCK).exists() && std::fs::read_dir(out).is_ok_and(|mut dir| dir.next().is_some()) {
        return Err(Diagnostic::input(
            format!("`{}` holds something that is no kit", out.display()),
            "--out names another folder",
        ));
    }
    if out.join(LOCK).exists() && lock(out)?.study != design.digest {
        return Err(Diagnostic::input(
            format!("`{}` is the kit of another study file, or of this one before it was changed", out.display()),
            "--out names another folder; people may already answer this kit",
        ));
    }
    let media = options.media_url.as_deref().map(Media::parse).transpose().map_err(|why| bad(&why))?;
    // Before films are made, which takes longest.
    let survey = page::page(&design).map_err(|why| bad(&why))?;
    let scenes = read(&design, &options.design)?;
    let ffmpeg = if options.clips == Clips::None { None } else { config.installed("ffmpeg") };
    let mut kit = Kit { root: out, planners: &design.planners, files: BTreeMap::new() };
    let mut made = Vec::new();
    let mut progress = Progress::new(*talk, "filming", design.films.len());
    for (index, film) in design.films.iter().enumerate() {
        progress.at(index, "");
        made.push(filmed(&design, &scenes, film, &mut kit, ffmpeg.as_deref())?);
    }
    drop(progress);
    alike(&made).iter().for_each(|told| talk.warn(told));
    kit.text(&format!("{SURVEY}/index.html"), &survey)?;
    kit.text("consent.md", &format!("{}\n", design.survey.consent.text()))?;
    kit.text("codebook.csv", &codebook(&design))?;
    if let Some(media) = &media {
        formats(&mut kit, &design, media)?;
    }
    if ffmpeg.is_some() {
        kit.text("jspsych/index.html", &jspsych::jspsych(&design).map_err(|why| bad(&why))?)?;
        kit.text("upload.txt", &uploads(&design, media.as_ref()))?;
    } else if media.is_some() {
        talk.warn("the survey is written for other programs, and there are no films to upload: ffmpeg makes them");
    }
    let lock = Lock { format: 1, study: design.digest.clone(), files: kit.files };
    let lock = serde_json::to_string_pretty(&lock)
        .map_err(|why| Diagnostic::input(why.to_string(), "").with_code(Code::Ours))?;
    files::write(&out.join(LOCK), lock.as_bytes())?;
    let secret = options.design.with_extension(SECRET);
    files::write(&secret, manifest(&made).as_bytes())?;
    tell(talk, options, &design, (&scenes, ffmpeg.is_some()), &secret);
    Ok(())
}

/// Films of one scenario that show the same: people would rate one film twice, as two planners.
fn alike(made: &[Made]) -> Vec<String> {
    let pairs = made.iter().enumerate().flat_map(|(at, one)| {
        let later = made.get(at + 1..).unwrap_or_default().iter();
        later
            .filter(|other| other.pictures == one.pictures && other.film.scenario == one.film.scenario)
            .map(move |other| (one, other))
    });
    pairs
        .map(|(one, other)| {
            format!(
                "the films `{}` and `{}` of `{}` show the same: `{}` and `{}` did the same with seed {}; take another seed or leave one out",
                one.film.id, other.film.id, one.film.scenario, one.film.planner, other.film.planner, one.film.seed
            )
        })
        .collect()
}

fn read(design: &Design, file: &Path) -> Result<BTreeMap<String, Scene>, Diagnostic> {
    let mut scenes = BTreeMap::new();
    for scenario in &design.scenarios {
        let Some(source) = design.sources.iter().find(|source| source.name == *scenario) else {
            return Err(Diagnostic::input(
                format!("`{}`: nothing says where the films of `{scenario}` come from", name(file)),
                "add `[[scenario]]` with name and bundles; `socrates study new` writes them",
            ));
        };
        let dirs: Vec<PathBuf> = source.bundles.iter().map(|dir| file.with_file_name(dir)).collect();
        let of = || design.films.iter().filter(|film| film.scenario == *scenario);
        let mut planners: Vec<PlannerName> = Vec::new();
        for film in of() {
            let planner = PlannerName::new(&film.planner).map_err(|why| {
                Diagnostic::input(format!("film `{}`: {why}", film.id), "`socrates planners` lists their names")
            })?;
            if !planners.contains(&planner) {
                planners.push(planner);
            }
        }
        let mut seeds: Vec<u64> = of().map(|film| film.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        scenes.insert(scenario.clone(), Scene::read(scenario, &dirs, &planners, &seeds)?);
    }
    Ok(scenes)
}

/// Makes one film: for the page, and for other programs where they can be made.
fn filmed(
    design: &Design,
    scenes: &BTreeMap<String, Scene>,
    film: &Declared,
    kit: &mut Kit<'_>,
    ffmpeg: Option<&Path>,
) -> Result<Made, Diagnostic> {
    let missing = || Diagnostic::input(format!("film `{}` has no run", film.id), "`socrates study new` writes films");
    let scene = scenes.get(&film.scenario).ok_or_else(missing)?;
    let source = design.sources.iter().find(|source| source.name == film.scenario).ok_or_else(missing)?;
    let (dir, recording, _) = scene.run(&film.planner, film.seed).ok_or_else(missing)?;
    let (part, _) = scene.part(source.longest_s);
    let seen = scenes::seen(&source.view);
    let film_options =
        FilmOptions { labels: false, speed: Some(1.0), part: Some(part), seen, alike: true, ..FilmOptions::USUAL };
    let all: Vec<&Recording> = scene.runs.iter().map(|(_, recording, _)| recording).collect();
    let shown = [Shown { recording, report: None, name: None }];
    let drawn = Film::new(&scene.bundle.location, "", &all, &shown, film_options).map_err(wrong)?;
    let strip = drawn.strip(PAGE_FPS);
    if let Some(length_s) = film.length_s.filter(|length_s| (length_s - strip.length_s).abs() > LENGTH_S) {
        return Err(Diagnostic::input(
            format!("film `{}` lasts {:.1} s, and the study says `length_s = {length_s}`", film.id, strip.length_s),
            format!("write `length_s = {:.1}` for all films of `{}`", strip.length_s, film.scenario),
        ));
    }
    let picture = page::Picture {
        size: strip.size,
        fps: strip.fps,
        length_s: strip.length_s,
        ground: &strip.ground,
        pictures: &strip.pictures,
    };
    let digest = kit.text(&format!("{SURVEY}/{FILMS}/{}.js", film.id), &page::film_script(&film.id, &picture))?;
    // The ground is that of the scenario.
    let pictures = Digest::of(strip.pictures.join("\n").as_bytes());
    if let Some(program) = ffmpeg {
        let path = format!("{CLIPS}/{}.mp4", film.id);
        by_ffmpeg(program, &drawn, film_options, Kind::Mp4, &kit.root.join(&path), &|_| {})?;
        let bytes = files::bytes(&kit.root.join(&path), 1 << 30, "the clip that was just made")?;
        kit.files.insert(path, Digest::of(&bytes));
    }
    let film = Declared { length_s: Some(strip.length_s), ..film.clone() };
    Ok(Made { film, view: source.view.to_string(), bundle: dir.clone(), recording: recording.hash(), digest, pictures })
}

/// Which film shows what, from the bundle to the film.
fn manifest(made: &[Made]) -> String {
    let mut text = "film,scenario,planner,seed,view,length_s,bundle,recording,digest\n".to_owned();
    for one in made {
        let Declared { id, scenario, planner, seed, length_s } = &one.film;
        let (bundle, length) = (one.bundle.display(), length_s.unwrap_or_default());
        text.push_str(&format!(
            "{id},{scenario},{planner},{seed},{},{length:.1},{bundle},{},{}\n",
            one.view, one.recording, one.digest
        ));
    }
    text
}

/// What columns of answers mean.
fn codebook(design: &Design) -> String {
    let cell = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = "item,instrument,scale,text,reversed,low,high\n".to_owned();
    for dimension in design.dimensions() {
        for item in &dimension.scale.items {
            let (low, high) = dimension.instrument.points;
            text.push_str(&format!(
                "{},{},{},{},{},{low},{high}\n",
                item.code,
                dimension.instrument.id,
                dimension.scale.id,
                cell(&item.text),
                item.reversed
            ));
        }
    }
    text
}

/// The survey for programs that show films from elsewhere.
fn formats(kit: &mut Kit<'_>, design: &Design, media: &Media) -> Result<(), Diagnostic> {
    let wrong = |why| bad(&why);
    let found = qsf::qsf(design, media).map_err(wrong)?;
    kit.text("qualtrics.qsf", &found.survey)?;
    kit.text("codebook-qualtrics.csv", &found.codebook)?;
    kit.text("qualtrics.txt", &advanced::advanced(design, media).map_err(wrong)?)?;
    kit.text("limesurvey.txt", &limesurvey::limesurvey(design, media).map_err(wrong)?)?;
    Ok(())
}

/// The films that other programs need, with where they expect them.
fn uploads(design: &Design, media: Option<&Media>) -> String {
    let mut ids: Vec<&str> = design.films.iter().map(|film| film.id.as_str()).collect();
    ids.sort_unstable();
    let to = |id: &str| media.map_or_else(String::new, |media| format!(" to {}", media.of(id)));
    let lines: Vec<String> = ids.iter().map(|id| format!("{CLIPS}/{id}.mp4{}\n", to(id))).collect();
    format!("Upload these to a host with https; other survey programs show them from there.\n\n{}", lines.concat())
}

fn tell(
    talk: &Printer,
    options: &BuildOptions,
    design: &Design,
    (scenes, clips): (&BTreeMap<String, Scene>, bool),
    secret: &Path,
) {
    let all = orders::orders(design);
    let films = all.iter().map(|order| order.films.len()).max().unwrap_or(0);
    for source in &design.sources {
        let Some(scene) = scenes.get(&source.name) else { continue };
        let (_, cut) = scene.part(source.longest_s);
        if cut > 0.0 {
            talk.warn(&format!(
                "films of `{}` do not show the last {cut:.1} s, all alike: `longest_s` of the scenario allows more",
                source.name
            ));
        }
    }
    for slot in &design.survey.consent.open_slots {
        talk.warn(&format!("the text of consent has an open slot, which people would read: [{slot}]"));
    }
    if let Some(minutes) = minutes(design) {
        talk.line(&format!("time       about {minutes:.0} min for each person"));
    }
    for dimension in design.dimensions().into_iter().filter(|dimension| dimension.scale.is_single()) {
        talk.warn(&format!("`{}` is a single item: fewer than three items make no scale", dimension.id()));
    }
    if design.films.iter().any(|film| film.length_s.is_none()) {
        talk.warn("films without `length_s` in the study: nobody is left out for leaving them early");
    }
    let out = &options.out;
    let page = out.join(SURVEY).join("index.html");
    talk.line(&format!(
        "orders     {}, of {films} films each; {} questions about a film",
        all.len(),
        design.codes().count()
    ));
    let blocks: Vec<&str> = asks::blocks(design).into_iter().map(|block| block.of.id.as_str()).collect();
    talk.line(&format!("asks       {}", blocks.join(", ")));
    if options.media_url.is_some() {
        talk.line("formats    qualtrics.qsf, qualtrics.txt, limesurvey.txt; upload.txt lists the films that they need");
    }
    if !clips {
        talk.line("clips      none: other survey programs need them, and ffmpeg makes them");
    }
    talk.line(&format!("secret     {} tells which film shows which planner: it stays with you", secret.display()));
    talk.line(&format!("look       {}", page.display()));
    talk.line(&format!("serve      socrates study serve {}", out.display()));
    talk.result(&json!({ "kit": out, "page": page, "secret": secret, "orders": all.len(), "films": design.films.len(), "clips": clips,
        "digest": design.digest }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planner_is_found_as_a_word() {
        assert!(names("the mppi robot", "mppi") && names("\"mppi\"", "mppi"));
        assert!(!names("the mppix robot", "mppi") && !names("ha_mppi", "mppi") && !names("", "mppi"));
    }
}
