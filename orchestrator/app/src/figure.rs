//! `figure`: who went where and when, at the width of a paper's column.

use std::path::PathBuf;

use serde_json::json;
use socrates_model::{Recording, Run};

use crate::bundle;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::video::shown_runs;

/// Options of `figure`.
#[derive(Debug, Clone)]
pub struct FigureOptions {
    /// Bundle folder.
    pub bundle: PathBuf,
    /// SVG, PDF or PNG file to write; a PDF holds its words as text with their font.
    pub out: PathBuf,
    /// Width on paper, mm: 84 is a column of two, 174 a page.
    pub width_mm: f64,
    /// Runs to show, such as `reference-1`; of the second to fourth only the robot's way. Default: the first run.
    pub run: Vec<Run>,
    /// Pixels per inch of a PNG.
    pub dpi: u16,
}

/// Writes the figure.
pub fn figure(talk: &Printer, options: &FigureOptions) -> Result<(), Diagnostic> {
    let ending = options.out.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !matches!(ending.as_str(), "svg" | "png" | "pdf") {
        return Err(Diagnostic::input(
            format!("`{}` is no figure: its ending is `{ending}`", options.out.display()),
            "name a file that ends in .svg, .pdf or .png",
        ));
    }
    let bundle = bundle::read(&options.bundle)?;
    let runs = shown_runs(&bundle, &options.run)?;
    let names: Vec<String> = runs.iter().map(Run::to_string).collect();
    let all: Vec<&Recording> = bundle.runs.iter().map(|(recording, _)| recording).collect();
    let shown: Vec<&Recording> = runs.iter().filter_map(|run| bundle.recording(run)).collect();
    let svg = socrates_draw::figure(&bundle.location, Some(&bundle.paths), &all, &shown, options.width_mm)
        .map_err(|why| Diagnostic::input(why.to_string(), "`socrates figure --help` names what is allowed"))?;
    let bytes = match ending.as_str() {
        "png" => socrates_draw::png_at_dpi(&svg, f32::from(options.dpi))
            .map_err(|why| Diagnostic::input(why.to_string(), "a smaller --dpi, or an SVG").with_code(Code::Input))?,
        "pdf" => socrates_draw::pdf_from_svg(&svg, &bundle.proposal.title)
            .map_err(|why| Diagnostic::input(why.to_string(), "an SVG holds the same figure").with_code(Code::Ours))?,
        _ => svg.into_bytes(),
    };
    crate::files::write(&options.out, &bytes)?;
    talk.line(&format!("wrote      {} · {} mm wide · {}", options.out.display(), options.width_mm, names.join(", ")));
    talk.result(&json!({
        "figure": options.out.display().to_string(), "width_mm": options.width_mm, "runs": names,
        "digest": socrates_model::Digest::of(&bytes),
    }));
    Ok(())
}
