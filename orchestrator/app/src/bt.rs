//! `bt`: behavior trees checked, drawn and converted.

use std::path::{Path, PathBuf};

use serde_json::json;
use socrates_bt::{Format, Includes, Library, Meaning, Options, Tree};
use socrates_model::Fault;

use crate::exit::Diagnostic;
use crate::files;
use crate::output::Printer;
use crate::words::plural;

/// Largest tree that is read, bytes.
const MAX_BYTES: u64 = 32 * 1024 * 1024;

/// Reads trees, ticks every case of their conditions, and says what is wrong.
pub fn check(talk: &Printer, trees: &[PathBuf], library: &str) -> Result<(), Diagnostic> {
    let library = named(library)?;
    let (mut reports, mut wrong, mut broken) = (Vec::new(), Vec::new(), 0);
    for tree in trees {
        let before = wrong.len();
        reports.push(check_one(talk, tree, library, &mut wrong)?);
        broken += usize::from(wrong.len() > before);
    }
    let result = json!({ "trees": reports });
    if broken == 0 {
        talk.result(&result);
        return Ok(());
    }
    let mut diagnostic = Diagnostic::input(
        format!("{broken} of {} cannot be loaded as {}", plural(trees.len(), "tree"), library.name()),
        "`socrates explain CODE` says what each fault means",
    );
    diagnostic.causes = wrong;
    diagnostic.result = Some(Box::new(result));
    Err(diagnostic)
}

/// Writes a tree in the XML version `to`, for the simulator `target` where one is named.
pub fn convert(
    talk: &Printer,
    tree: &Path,
    to: &str,
    library: Option<&str>,
    target: Option<&str>,
    out: Option<&Path>,
) -> Result<(), Diagnostic> {
    let (read, from) = load(tree, library)?;
    let target = target.map(named).transpose()?.unwrap_or(from);
    let (xml, notes) = socrates_bt::convert(&read, if to == "v3" { Format::V3 } else { Format::V4 }, target);
    for note in &notes {
        talk.warn(&format!("{} {note}", if note.changes_meaning { "meaning   " } else { "spelling  " }));
    }
    files::write_or_say(talk, &xml, out)?;
    let notes: Vec<_> = notes
        .iter()
        .map(|note| json!({ "at": note.at, "message": note.message, "changes_meaning": note.changes_meaning }))
        .collect();
    talk.result(&json!({ "xml": xml, "notes": notes }));
    Ok(())
}

/// A library by its name.
fn named(name: &str) -> Result<Library, Diagnostic> {
    Library::named(name).ok_or_else(|| {
        let names: Vec<&str> = Library::ALL.iter().map(|library| library.name()).collect();
        Diagnostic::input(format!("there is no node library `{name}`"), format!("libraries: {}", names.join(", ")))
    })
}

/// An included file, looked for from the folder of the tree on.
pub fn including(folder: &Path, path: &str) -> Option<String> {
    std::fs::read_to_string(folder.join(path)).ok()
}

/// How a tree's file is read: every leaf of the library is taken, whoever would tick it.
fn options<'a>(shown: &'a str, includes: Includes<'a>, library: Library) -> Options<'a> {
    Options { file: shown, includes: Some(includes), library, meaning: Meaning::World, ..Options::default() }
}

/// The faults of a tree's file.
pub fn faulty(tree: &Path, faults: &[Fault]) -> Diagnostic {
    Diagnostic::faults(
        format!("`{}` has {}", tree.display(), plural(faults.len(), "fault")),
        faults,
        "`socrates explain CODE` says what each fault means",
    )
}

fn check_one(
    talk: &Printer,
    file: &Path,
    library: Library,
    wrong: &mut Vec<String>,
) -> Result<serde_json::Value, Diagnostic> {
    let bytes = files::bytes(file, MAX_BYTES, "name a tree in BehaviorTree.CPP XML")?;
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let includes = |path: &str| including(folder, path);
    let shown = file.display().to_string();
    let options = |library| options(&shown, &includes, library);
    let xml = match socrates_bt::decode(&bytes) {
        Ok(xml) => xml,
        Err(fault) => {
            wrong.push(format!("{}: {fault}", file.display()));
            return Ok(json!({ "tree": file.display().to_string(), "faults": [fault] }));
        }
    };
    let report = socrates_bt::check_report(xml, &options(library));
    for fault in &report.faults {
        wrong.push(fault.to_string());
    }
    if let Some(analysis) = &report.analysis {
        let word = if report.is_clean() { "good" } else { "loads" };
        talk.line(&format!("{word:<10} {} ({})", file.display(), library.name()));
        for line in analysis.to_string().lines() {
            talk.line(&format!("           {line}"));
        }
    } else if let Some(other) = Library::ALL
        .into_iter()
        .filter(|other| *other != library)
        .find(|other| Tree::parse_with(xml, &options(*other)).is_ok())
    {
        wrong.push(format!("{}: it loads with --library {}", file.display(), other.name()));
    }
    Ok(json!({ "tree": file.display().to_string(), "faults": report.faults, "analysis": report.analysis }))
}

/// A tree, by the library that was asked for, or the first that takes it.
pub fn load(file: &Path, library: Option<&str>) -> Result<(Tree, Library), Diagnostic> {
    let bytes = files::bytes(file, MAX_BYTES, "name a tree in BehaviorTree.CPP XML")?;
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let includes = |path: &str| including(folder, path);
    let xml = socrates_bt::decode(&bytes).map_err(|fault| faulty(file, &[fault]))?;
    let tries = match library {
        Some(name) => vec![named(name)?],
        None => {
            let ours = [Library::Native, Library::SocratesFork];
            ours.into_iter().chain([Library::HunavSim1_1, Library::HunavSim1_0, Library::HunavSim2]).collect()
        }
    };
    let shown = file.display().to_string();
    let mut first = None;
    for library in tries {
        match Tree::parse_with(xml, &options(&shown, &includes, library)) {
            Ok(tree) => return Ok((tree, library)),
            Err(faults) => first = first.or(Some(faults)),
        }
    }
    Err(faulty(file, &first.unwrap_or_default()))
}

/// Draws a tree as text, or into a file.
pub fn show(talk: &Printer, file: &Path, out: Option<&Path>, library: Option<&str>) -> Result<(), Diagnostic> {
    let (tree, library) = load(file, library)?;
    let text = socrates_bt::draw_text(&tree);
    let Some(out) = out else {
        talk.line(text.trim_end());
        talk.result(&json!({ "text": text, "library": library.name() }));
        return Ok(());
    };
    let svg = socrates_bt::draw_svg(&tree);
    let bytes = if out.extension().is_some_and(|ext| ext == "png") {
        socrates_draw::png_from_svg(&svg, 1.5)
            .map_err(|why| Diagnostic::input(why.to_string(), "choose an .svg file instead"))?
    } else {
        svg.into_bytes()
    };
    files::write(out, &bytes)?;
    talk.line(&format!("look       {}", out.display()));
    talk.result(&json!({ "picture": out.display().to_string(), "library": library.name() }));
    Ok(())
}
