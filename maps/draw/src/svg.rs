//! Small words for writing SVG text.

use std::fmt::Write as _;

/// Text made safe for XML content and attributes.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // XML 1.0 has no way to write these at all.
            c if c.is_control() && !matches!(c, '\n' | '\t' | '\r') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Text made safe for HTML, with what stands in `backticks` set as code; a sign that has no second one stays as it is.
#[must_use]
pub fn escape_code(text: &str) -> String {
    if text.matches('`').count() % 2 == 1 {
        return escape(text);
    }
    let parts = text.split('`').enumerate();
    parts
        .map(|(index, part)| if index % 2 == 1 { format!("<code>{}</code>", escape(part)) } else { escape(part) })
        .collect()
}

/// An SVG document being written.
#[derive(Debug, Clone)]
pub struct Svg {
    text: String,
}

impl Svg {
    /// A document of this size in pixels, on white.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let mut svg = Self { text: String::new() };
        svg.raw(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif\">"
        ));
        svg
    }

    /// A document of this width on paper, mm, in drawing units of one point.
    #[must_use]
    pub fn in_mm(width_mm: f64, width_pt: f64, height_pt: f64) -> Self {
        let mut svg = Self { text: String::new() };
        let height_mm = height_pt * width_mm / width_pt.max(1e-9);
        svg.raw(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_mm}mm\" height=\"{height_mm:.2}mm\" \
             viewBox=\"0 0 {width_pt:.2} {height_pt:.2}\" font-family=\"Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif\">"
        ));
        svg
    }

    /// A part of a document: no frame of its own.
    #[must_use]
    pub const fn part() -> Self {
        Self { text: String::new() }
    }

    /// What was written so far, without an end.
    #[must_use]
    pub fn text_so_far(self) -> String {
        self.text
    }

    /// Adds text as it is.
    pub fn raw(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// A filled rectangle.
    pub fn rect(&mut self, at: (f64, f64), size: (f64, f64), style: &str) {
        self.raw(&format!(
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" {style}/>",
            at.0, at.1, size.0, size.1
        ));
    }

    /// A circle.
    pub fn circle(&mut self, at: (f64, f64), radius: f64, style: &str) {
        self.raw(&format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" {style}/>", at.0, at.1));
    }

    /// A line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &str) {
        self.raw(&format!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>",
            from.0, from.1, to.0, to.1
        ));
    }

    /// An open line through points; nothing where there are fewer than two different ones: a line without a length
    /// cannot be drawn.
    pub fn polyline(&mut self, points: &[(f64, f64)], style: &str) {
        const LEAST: f64 = 0.1;
        let Some(first) = points.first() else { return };
        if points.iter().all(|(x, y)| (x - first.0).abs() < LEAST && (y - first.1).abs() < LEAST) {
            return;
        }
        let mut list = String::new();
        for (x, y) in points {
            // Writing into a String cannot fail.
            if write!(list, "{x:.1},{y:.1} ").is_err() {
                return;
            }
        }
        self.raw(&format!("<polyline points=\"{}\" fill=\"none\" {style}/>", list.trim_end()));
    }

    /// Text at a base line point. `style` may hold anchor, size and fill.
    pub fn text(&mut self, at: (f64, f64), words: &str, style: &str) {
        self.raw(&format!("<text x=\"{:.1}\" y=\"{:.1}\" {style}>{}</text>", at.0, at.1, escape(words)));
    }

    /// A heading at a base line point: the shipped font has one light weight, a thin outline in the same color gives it body.
    pub fn heading(&mut self, at: (f64, f64), words: &str, size_px: f64, color: &str) {
        self.text(at, words, &format!("font-size=\"{size_px}\" fill=\"{color}\" {}", body(size_px, color)));
    }

    /// A label centered on a base line point, with a white rim that keeps it readable on walls and tracks.
    pub fn label(&mut self, at: (f64, f64), words: &str, size_px: f64, color: &str) {
        let common = format!("font-size=\"{size_px}\" text-anchor=\"middle\"");
        self.text(
            at,
            words,
            &format!("{common} fill=\"#ffffff\" stroke=\"#ffffff\" stroke-width=\"4.5\" stroke-linejoin=\"round\""),
        );
        self.text(at, words, &format!("{common} fill=\"{color}\" {}", body(size_px, color)));
    }

    /// Opens a group that shows nothing outside a box; [`Svg::end_clip`] closes it. One per document.
    pub fn begin_clip(&mut self, at: (f64, f64), size: (f64, f64)) {
        self.raw("<clipPath id=\"inside-map\">");
        self.rect(at, size, "");
        self.raw("</clipPath><g clip-path=\"url(#inside-map)\">");
    }

    /// Closes the group of [`Svg::begin_clip`].
    pub fn end_clip(&mut self) {
        self.raw("</g>");
    }

    /// The finished document.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.raw("</svg>");
        self.text
    }
}

/// Outline that makes light letters look half bold.
fn body(size_px: f64, color: &str) -> String {
    format!("stroke=\"{color}\" stroke-width=\"{:.2}\"", size_px * 0.045)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_needs_two_points() {
        let mut svg = Svg::new(10.0, 10.0);
        svg.polyline(&[], "");
        svg.polyline(&[(1.0, 1.0)], "");
        assert!(!svg.clone().finish().contains("polyline"));
        svg.polyline(&[(1.0, 1.0), (2.0, 2.0)], "");
        assert!(svg.finish().contains("polyline"));
    }

    #[test]
    fn words_in_backticks_are_code() {
        assert_eq!(escape_code("not read: `<bed>`, `stick`"), "not read: <code>&lt;bed&gt;</code>, <code>stick</code>");
        assert_eq!(escape_code("5` long"), "5` long");
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let mut svg = Svg::new(10.0, 10.0);
        svg.text((0.0, 0.0), "<script>\"&\u{1}", "");
        let out = svg.finish();
        assert!(!out.contains("<script>") && !out.contains('\u{1}'));
        assert!(out.contains("&lt;script&gt;&quot;&amp;"));
    }
}
