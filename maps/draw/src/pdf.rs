//! SVG to PDF: lines stay lines, and words stay words in an embedded font.

use krilla::geom::Size;
use krilla::metadata::Metadata;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt as _, SvgSettings};
use resvg::usvg;

use crate::fonts;

/// Points of a printer in a pixel of a drawing.
const PT_PER_PX: f32 = 0.75;

/// Why a PDF could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// The SVG text is not valid.
    #[error("the drawing is not valid SVG")]
    Svg(#[source] usvg::Error),
    /// The page would have no size.
    #[error("a page of {width} by {height} pt cannot be written")]
    Size {
        /// Width, pt.
        width: f32,
        /// Height, pt.
        height: f32,
    },
    /// The PDF could not be written.
    #[error("the PDF could not be written: {0}")]
    Write(String),
}

/// A drawing as one page of a PDF, as large on paper as the drawing says.
///
/// # Errors
/// [`PdfError`] when the drawing is not valid or cannot be written.
pub fn pdf_from_svg(svg: &str, title: &str) -> Result<Vec<u8>, PdfError> {
    let (text, fonts) = fonts::readable(svg);
    let tree = usvg::Tree::from_str(&text, &fonts::options(fonts)).map_err(PdfError::Svg)?;
    let (width, height) = (tree.size().width() * PT_PER_PX, tree.size().height() * PT_PER_PX);
    let size = Size::from_wh(width, height).ok_or(PdfError::Size { width, height })?;
    let mut document = krilla::Document::new();
    // No date: the same drawing gives the same file.
    document.set_metadata(Metadata::new().title(title.to_owned()).creator("SocRATES".to_owned()));
    let mut page = document.start_page_with(PageSettings::new(size));
    let mut surface = page.surface();
    let drawn = surface.draw_svg(&tree, size, SvgSettings::default());
    surface.finish();
    page.finish();
    if drawn.is_none() {
        return Err(PdfError::Write("a part of the drawing has no counterpart".to_owned()));
    }
    document.finish().map_err(|why| PdfError::Write(format!("{why:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, walk};

    fn has(bytes: &[u8], words: &str) -> bool {
        bytes.windows(words.len()).any(|part| part == words.as_bytes())
    }

    #[test]
    fn a_figure_becomes_a_page_of_its_width_with_its_font_embedded() {
        let (location, run) = (hall("hall"), walk(2));
        let svg = crate::figure(&location, None, &[&run], &[&run], 84.0).unwrap();
        let pdf = pdf_from_svg(&svg, "hall").unwrap();
        assert!(pdf.starts_with(b"%PDF-1."));
        // 84 mm are 238.11 pt.
        assert!(has(&pdf, "/MediaBox[0 0 238.1"), "{}", String::from_utf8_lossy(&pdf));
        assert!(has(&pdf, "/FontFile") && has(&pdf, "Ubuntu-Light") && has(&pdf, "/ToUnicode"));
        assert_eq!(pdf, pdf_from_svg(&svg, "hall").unwrap());
    }

    #[test]
    fn hostile_words_and_a_broken_drawing_are_no_panic() {
        let mut run = walk(1);
        run.header.agents[1].role = "一 😀 \u{202e}".to_owned();
        let svg = crate::figure(&hall("hall"), None, &[&run], &[&run], 84.0).unwrap();
        assert!(pdf_from_svg(&svg, EVIL).is_ok());
        assert!(matches!(pdf_from_svg("<svg", ""), Err(PdfError::Svg(_))));
    }
}
