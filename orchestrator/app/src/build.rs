//! `map build`: a building from a brief, in a file or in words.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_maps::random::{Built, NotBuilt};
use socrates_model::BuildingBrief;

use crate::exit::Complaint;
use crate::files;
use crate::map;
use crate::output::Printer;
use crate::words::plural;

/// Largest brief that is read, bytes.
const MAX_BYTES: u64 = 256 * 1024;
/// Name of the brief in the folder of its building.
const BRIEF: &str = "building.toml";

/// Builds what a brief asks for into a folder: the floor plan, the location that it makes, and the brief.
///
/// `what` is a file, or a sentence. A folder that holds anything already is left as it is.
pub fn build(talk: &Printer, what: &str, seed: u64, out: &Path) -> Result<(), Complaint> {
    let brief = brief(what)?;
    if std::fs::read_dir(out).is_ok_and(|mut entries| entries.next().is_some()) {
        let message = format!("`{}` is there already and is not an empty folder", out.display());
        return Err(Complaint::input(message, "name another folder with `--out`, or remove it"));
    }
    let built = socrates_maps::random::build(&brief, seed).map_err(|why| not_built(&why))?;
    let mut all = built.files.clone();
    let text = toml::to_string(&brief)
        .map_err(|why| Complaint::input(format!("the brief cannot be written: {why}"), "leave unusual letters out"))?;
    all.insert(BRIEF.to_owned(), text.into_bytes());
    map::folder(&all, out)?;
    told(talk, &built);
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

fn not_built(why: &NotBuilt) -> Complaint {
    match why {
        NotBuilt::Unmet(unmet) => {
            let listed: Vec<String> = unmet.iter().map(ToString::to_string).collect();
            Complaint::input(
                format!("no such building: {}", listed.join("; ")),
                "ask for less of it, or leave the form and the sizes open; another `--seed` draws others (docs/buildings.md)",
            )
        }
        NotBuilt::Flawed(faults) => Complaint::faults(
            "the building that was drawn is not usable",
            faults,
            "please report the brief and the seed; another seed draws another building",
        ),
    }
}

/// The brief in a file, or the one that a sentence says.
fn brief(what: &str) -> Result<BuildingBrief, Complaint> {
    let path = PathBuf::from(what);
    if path.is_file() || path.extension().is_some_and(|ext| ext == "toml") {
        let hint = "docs/buildings.md shows the form of a brief";
        let text = files::text(&path, MAX_BYTES, hint)?;
        return toml::from_str(&text).map_err(|why| {
            let line =
                why.span().map_or(1, |span| text.bytes().take(span.start).filter(|byte| *byte == b'\n').count() + 1);
            Complaint::input(format!("`{}` line {line}: {}", path.display(), why.message().replace('\n', " ")), hint)
        });
    }
    let read = socrates_offline::building::building(what);
    if !read.unread.is_empty() {
        let words: Vec<String> = read.unread.iter().map(|word| format!("`{word}`")).collect();
        return Err(Complaint::input(
            format!("{} not understood: {}", plural(words.len(), "word"), words.join(", ")),
            "say it with rooms, counts, sizes and `next to`, or write a brief as a file (docs/buildings.md)",
        ));
    }
    read.brief.ok_or_else(|| {
        Complaint::input(
            format!("`{what}` names no kind of building"),
            "begin with `a hospital`, `an office` or `a home`; halls and warehouses: `socrates map generate --random`",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

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
