//! `map build`: a building from a brief, in a file or in words.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_maps::random::{Built, NotBuilt};
use socrates_model::BuildingBrief;

use crate::authors;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::files;
use crate::map;
use crate::output::Printer;
use crate::words::plural;

/// Largest brief that is read, bytes.
const MAX_BYTES: u64 = 256 * 1024;
/// Name of the brief in the folder of its building.
const BRIEF: &str = "building.toml";

/// What is built, and how.
#[derive(Debug, Clone)]
pub struct BuildOptions {
    /// A file with a brief, or a sentence.
    pub what: String,
    /// The language model that makes a brief of a sentence; none for the rules of this program.
    pub author: Option<String>,
    /// What the brief leaves open is drawn by it.
    pub seed: u64,
    /// Folder to write.
    pub out: PathBuf,
}

/// Builds what a brief asks for into a folder: the floor plan, the location that it makes, and the brief.
///
/// A folder that holds anything already is left as it is.
pub async fn build(talk: &Printer, config: &Config, options: &BuildOptions) -> Result<(), Diagnostic> {
    let BuildOptions { what, author, seed, out } = options;
    map::is_free(out)?;
    let (brief, built) = match author {
        Some(author) if author != socrates_offline::NAME && !is_file(what) => {
            asked(talk, config, author, what, *seed).await?
        }
        Some(_) | None => ruled(what, *seed)?,
    };
    write(talk, &brief, &built, *seed, out)
}

/// What the rules of this program make of a sentence, or a brief says.
fn ruled(what: &str, seed: u64) -> Result<(BuildingBrief, Built), Diagnostic> {
    let brief = brief(what)?;
    let built = socrates_maps::random::build(&brief, seed).map_err(|why| not_built(&why))?;
    Ok((brief, built))
}

/// Writes a building with its brief.
fn write(talk: &Printer, brief: &BuildingBrief, built: &Built, seed: u64, out: &Path) -> Result<(), Diagnostic> {
    let mut all = built.files.clone();
    let text = toml::to_string(brief)
        .map_err(|why| Diagnostic::input(format!("the brief cannot be written: {why}"), "leave unusual letters out"))?;
    all.insert(BRIEF.to_owned(), text.into_bytes());
    map::folder(&all, out)?;
    told(talk, built);
    talk.line(&format!("wrote      {} ({})", out.display(), all.keys().cloned().collect::<Vec<_>>().join(", ")));
    talk.line(&format!("next       socrates map draw {}", files::shell(out)));
    talk.result(&json!({
        "location": out.display().to_string(),
        "brief": brief,
        "seed": seed,
        "rooms": built.rooms,
        "others": built.others,
        "remarks": built.remarks,
        "files": all.keys().collect::<Vec<_>>(),
    }));
    Ok(())
}

/// Says what there is, and what is narrower than in real buildings.
fn told(talk: &Printer, built: &Built) {
    let mut kinds: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for room in &built.rooms {
        kinds.entry(&room.kind).or_default().push(room.area_m2);
    }
    talk.line(&format!("built      {}", built.location.description));
    for (kind, areas) in kinds {
        let (least, most) =
            areas.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), area| (least.min(*area), most.max(*area)));
        let size = if areas.len() == 1 { format!("{most:.0} m²") } else { format!("{least:.0} to {most:.0} m²") };
        let whose = if built.others.iter().any(|other| other == kind) { ", not asked for" } else { "" };
        talk.line(&format!("rooms      {} {}: {size}{whose}", areas.len(), kind.to_lowercase()));
    }
    for remark in &built.remarks {
        talk.line(&format!(
            "remark     {} of {:.2} m; such buildings have at least {} m ({})",
            remark.what, remark.found_m, remark.least_m, remark.source
        ));
    }
}

fn not_built(why: &NotBuilt) -> Diagnostic {
    match why {
        NotBuilt::Unmet(unmet) => {
            let listed: Vec<String> = unmet.iter().map(ToString::to_string).collect();
            Diagnostic::input(
                format!("no such building: {}", listed.join("; ")),
                "ask for less of it, or leave the form and the sizes open; another `--seed` draws others (docs/buildings.md)",
            )
        }
        NotBuilt::Flawed(faults) => Diagnostic::faults(
            "the building that was drawn is not usable",
            faults,
            "please report the brief and the seed; another seed draws another building",
        ),
    }
}

/// The building of the brief that a language model makes of a sentence; asked again with what cannot be built. Says what was left out.
async fn asked(
    talk: &Printer,
    config: &Config,
    author: &str,
    words: &str,
    seed: u64,
) -> Result<(BuildingBrief, Built), Diagnostic> {
    let builds = |brief: &BuildingBrief| {
        socrates_maps::random::build(brief, seed).map_err(|why| match why {
            NotBuilt::Unmet(unmet) => unmet.iter().map(ToString::to_string).collect(),
            NotBuilt::Flawed(faults) => faults.iter().map(ToString::to_string).collect(),
        })
    };
    let keys = authors::keys(config)?;
    let asked = socrates_author::building::brief(author, &keys, words, seed, builds).await;
    let (made, built) = asked.map_err(|why| {
        let hint = "say it in simpler words, write a brief as a file, or leave `--author` out (docs/buildings.md)";
        authors::unasked(format!("`{author}` made no building"), &why, hint)
    })?;
    for wish in &made.left_out {
        talk.line(&format!("left out   {wish}"));
    }
    Ok((made.brief, built))
}

fn is_file(what: &str) -> bool {
    let path = Path::new(what);
    path.is_file() || path.extension().is_some_and(|ext| ext == "toml")
}

/// The brief in a file, or the one that a sentence says.
fn brief(what: &str) -> Result<BuildingBrief, Diagnostic> {
    let path = PathBuf::from(what);
    if is_file(what) {
        let hint = "docs/buildings.md shows the form of a brief";
        let text = files::text(&path, MAX_BYTES, hint)?;
        return toml::from_str(&text).map_err(|why| {
            let line =
                why.span().map_or(1, |span| text.bytes().take(span.start).filter(|byte| *byte == b'\n').count() + 1);
            Diagnostic::input(format!("`{}` line {line}: {}", path.display(), why.message().replace('\n', " ")), hint)
        });
    }
    let read = socrates_offline::building::building(what);
    if !read.unread.is_empty() {
        let words: Vec<String> = read.unread.iter().map(|word| format!("`{word}`")).collect();
        return Err(Diagnostic::input(
            format!("{} not understood: {}", plural(words.len(), "word"), words.join(", ")),
            "say it with rooms, counts, sizes and `next to`, ask a model (`--author`), or write a brief as a file (docs/buildings.md)",
        ));
    }
    read.brief.ok_or_else(|| {
        Diagnostic::input(
            format!("`{what}` names no kind of building"),
            "begin with `a hospital`, `an office` or `a home`; halls and warehouses: `socrates map generate --random`",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

    /// A building without a model.
    fn build(talk: &Printer, what: &str, seed: u64, out: &Path) -> Result<(), Diagnostic> {
        map::is_free(out)?;
        let (brief, built) = ruled(what, seed)?;
        write(talk, &brief, &built, seed, out)
    }

    #[test]
    fn a_sentence_becomes_a_folder_whose_brief_builds_it_again() {
        let talk = Printer::to_nobody(Format::Json);
        let folder = tempfile::tempdir().unwrap();
        let (first, second) = (folder.path().join("first"), folder.path().join("second"));
        build(&talk, "a hospital with two wards, a lobby with two elevators", 1, &first).unwrap();
        let location = socrates_maps::load(&first).unwrap();
        assert!(!location.named("ward 2").unwrap().nodes.is_empty());
        assert_eq!(location.doors.iter().filter(|door| door.id.starts_with("elevator")).count(), 2);
        build(&talk, &first.join(BRIEF).display().to_string(), 1, &second).unwrap();
        for name in ["map.png", "scene_graph.json", "location.toml", "plan.toml", BRIEF] {
            assert_eq!(std::fs::read(first.join(name)).unwrap(), std::fs::read(second.join(name)).unwrap(), "{name}");
        }
        let again = build(&talk, "a home", 1, &first).unwrap_err();
        assert!(again.what.contains("not an empty folder"), "{}", again.what);
    }

    #[test]
    fn what_cannot_be_built_is_refused_with_the_reason() {
        let talk = Printer::to_nobody(Format::Json);
        let folder = tempfile::tempdir().unwrap();
        let bad = folder.path().join("bad.toml");
        std::fs::write(&bad, "kind = \"office\"\nroms = []\n").unwrap();
        for (what, part) in [
            ("an office with a moat", "`moat`"),
            ("two wards", "no kind of building"),
            ("an office with a meeting room of 900 m²", "rooms `meeting room`: area_m2: asked 720 to 1125 m²"),
            (bad.to_str().unwrap(), "line 2"),
            ("nowhere.toml", "nowhere.toml"),
        ] {
            let told = build(&talk, what, 1, &folder.path().join("out")).unwrap_err();
            assert!(told.short().contains(part), "{part} not in {}", told.short());
        }
        assert!(!folder.path().join("out").exists());
    }
}
