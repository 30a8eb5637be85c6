//! `map`: list, check, draw, generate.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_maps::random::Kind;
use socrates_model::Fault;

use crate::exit::Complaint;
use crate::files;
use crate::output::Printer;
use crate::prepare::load_location;
use crate::words::plural;

/// Largest floor plan that is read, bytes.
const MAX_PLAN_BYTES: u64 = 4 * 1024 * 1024;

/// Lists the shipped locations and their requests.
pub fn list(talk: &Printer) -> Result<(), Complaint> {
    let mut all = Vec::new();
    for name in socrates_maps::shipped::names() {
        let (location, _) = load_location(name, Path::new("."))?;
        talk.line(&format!("{name:<11} {}", location.description));
        let requests: Vec<String> =
            socrates_maps::shipped::requests(name).into_iter().map(|(stem, _)| stem.to_owned()).collect();
        talk.line(&format!("{:<11} requests: {}", "", requests.join(", ")));
        all.push(json!({ "name": name, "description": location.description, "requests": requests }));
    }
    talk.result(&json!({ "locations": all }));
    Ok(())
}

/// Says everything that is wrong with a location.
pub fn check(talk: &Printer, name: &str) -> Result<(), Complaint> {
    let (location, _) = load_location(name, Path::new("."))?;
    let faults = socrates_maps::check(&location);
    let (hard, soft): (Vec<_>, Vec<_>) = faults.into_iter().partition(|fault| !fault.is_soft());
    for warning in &location.warnings {
        talk.line(&format!("warning    {warning}"));
    }
    for fault in &soft {
        talk.line(&format!("warning    {fault}"));
    }
    if !hard.is_empty() {
        return Err(Complaint::faults(
            format!("the location `{name}` has {}", plural(hard.len(), "fault")),
            &hard,
            "`socrates explain CODE` says what to do",
        ));
    }
    let grid = &location.grid;
    talk.line(&format!(
        "good       {name}: {} × {} cells of {} m, {}, {}, {}",
        grid.width,
        grid.height,
        grid.resolution_m,
        plural(location.graph.nodes().len(), "node"),
        plural(location.graph.edges().len(), "edge"),
        plural(location.doors.len(), "door")
    ));
    talk.result(&json!({ "location": name, "nodes": location.graph.nodes().len(), "edges": location.graph.edges().len(), "warnings": location.warnings }));
    Ok(())
}

/// Draws a location with its node ids.
pub fn draw(talk: &Printer, name: &str, out: &Path) -> Result<(), Complaint> {
    let (location, _) = load_location(name, Path::new("."))?;
    let svg = socrates_draw::annotated_map(&location);
    let bytes = if out.extension().is_some_and(|ext| ext == "svg") {
        svg.into_bytes()
    } else {
        socrates_draw::png_from_svg(&svg, 1.0)
            .map_err(|why| Complaint::input(why.to_string(), "choose an .svg file instead"))?
    };
    std::fs::write(out, bytes)
        .map_err(|why| Complaint::input(format!("cannot write `{}`: {why}", out.display()), "check the folder"))?;
    talk.line(&format!("look       {}", out.display()));
    talk.result(&json!({ "picture": out.display().to_string() }));
    Ok(())
}

/// The files of a location that a floor plan describes.
pub(crate) fn generated(plan: &Path) -> Result<BTreeMap<String, Vec<u8>>, Complaint> {
    let hint = "see maps/README.md for the form of a floor plan";
    let text = files::text(plan, MAX_PLAN_BYTES, hint)?;
    socrates_maps::generate(&text).map_err(|faults| {
        Complaint::faults(format!("the floor plan `{}` is not usable", plan.display()), &faults, hint)
    })
}

/// Makes a location folder from a floor plan; files of a folder that is there are written anew.
pub fn generate(talk: &Printer, plan: &Path, out: &Path) -> Result<(), Complaint> {
    write(talk, &generated(plan)?, out)
}

/// Makes a location folder from a floor plan that is drawn by a seed, with the plan in it.
///
/// Without `out` the folder is called by kind and seed. A folder that holds anything already is left as it is.
pub fn random(talk: &Printer, seed: u64, kind: &str, out: Option<&Path>) -> Result<(), Complaint> {
    let kind = self::kind(kind)?;
    let out = out.map_or_else(|| PathBuf::from(socrates_maps::random::name(seed, kind)), Path::to_path_buf);
    let taken = match std::fs::read_dir(&out) {
        Ok(mut entries) => entries.next().is_some(),
        Err(why) => why.kind() != std::io::ErrorKind::NotFound,
    };
    if taken {
        let message = format!("`{}` is there already and is not an empty folder", out.display());
        return Err(Complaint::input(message, "name another folder with `--out`, or remove it"));
    }
    let files = socrates_maps::random::files(seed, kind).map_err(|faults| not_usable(seed, kind, &faults))?;
    write(talk, &files, &out)
}

/// The kind of random worlds of this name.
pub(crate) fn kind(name: &str) -> Result<Kind, Complaint> {
    name.parse().map_err(|fault| {
        Complaint::faults("there is no such random world", &[fault], "choose one of the kinds with `--kind`")
    })
}

/// What is said of a random world that its own checks refuse.
pub(crate) fn not_usable(seed: u64, kind: Kind, faults: &[Fault]) -> Complaint {
    let message = format!("the {kind} of seed {seed} is not usable");
    Complaint::faults(message, faults, "please report the kind and the seed; another seed gives another world")
}

fn write(talk: &Printer, files: &BTreeMap<String, Vec<u8>>, out: &Path) -> Result<(), Complaint> {
    let cannot = |path: &Path, why: std::io::Error| {
        Complaint::input(format!("cannot write `{}`: {why}", path.display()), "check the folder")
    };
    std::fs::create_dir_all(out).map_err(|why| cannot(out, why))?;
    for (name, bytes) in files {
        let path = out.join(name);
        std::fs::write(&path, bytes).map_err(|why| cannot(&path, why))?;
    }
    talk.line(&format!("wrote      {} ({})", out.display(), files.keys().cloned().collect::<Vec<_>>().join(", ")));
    talk.line(&format!("next       socrates map draw {}", out.display()));
    talk.result(&json!({ "location": out.display().to_string(), "files": files.keys().collect::<Vec<_>>() }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Format;

    #[test]
    fn a_random_world_is_written_once_and_other_kinds_are_refused() {
        let talk = Printer::to_nobody(Format::Json);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("home-7");
        random(&talk, 7, "home", Some(&out)).unwrap();
        let location = socrates_maps::load(&out).unwrap();
        assert_eq!(location, socrates_maps::random::location(7, Kind::Home).unwrap());
        let plan = std::fs::read(out.join("plan.toml")).unwrap();
        let again = random(&talk, 8, "home", Some(&out)).unwrap_err();
        assert!(again.what.contains("home-7") && again.what.contains("not an empty folder"), "{}", again.what);
        assert_eq!(std::fs::read(out.join("plan.toml")).unwrap(), plan);
        // The plan in the folder makes the folder.
        let copy = folder.path().join("copy");
        generate(&talk, &out.join("plan.toml"), &copy).unwrap();
        assert_eq!(std::fs::read(copy.join("map.png")).unwrap(), std::fs::read(out.join("map.png")).unwrap());
        let castle = random(&talk, 7, "castle", Some(&folder.path().join("castle-7"))).unwrap_err();
        assert!(castle.short().contains("`castle`") && castle.short().contains("warehouse"), "{}", castle.short());
        assert!(!folder.path().join("castle-7").exists());
    }
}
