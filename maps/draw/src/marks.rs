//! What pictures of ways have in common: lines with arrows, labels, the legend.

use crate::label::{Labels, text_width, wrapped};
use crate::palette;
use crate::svg::Svg;

/// The line of an agent, set off from what lies under it.
pub(crate) fn draw_line(svg: &mut Svg, line: &[(f64, f64)], color: &str) {
    svg.polyline(line, "stroke=\"#ffffff\" stroke-width=\"6.5\" stroke-linejoin=\"round\" opacity=\"0.8\"");
    svg.polyline(
        line,
        &format!("stroke=\"{color}\" stroke-width=\"3.6\" stroke-linejoin=\"round\" stroke-linecap=\"round\""),
    );
}

/// An arrow on a line, turned clockwise from pointing right.
pub(crate) fn draw_arrow(svg: &mut Svg, (x, y): (f64, f64), degrees: f64, color: &str) {
    svg.raw(&format!(
        "<path d=\"M8 0L-6 6.5L-3 0L-6 -6.5z\" transform=\"translate({x:.1} {y:.1}) rotate({degrees:.1})\" \
         fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1.4\"/>"
    ));
}

/// Words beside a place, where there is room for them.
pub(crate) fn draw_label(
    svg: &mut Svg,
    labels: &mut Labels,
    at: (f64, f64),
    text: &str,
    (color, size_px): (&str, f64),
    gap: f64,
) {
    let area = labels.place(at, (text_width(text, size_px) + 6.0, size_px + 3.0), gap);
    svg.label((area.x + area.w / 2.0, area.y + size_px - 1.0), text, size_px, color);
}

/// Height that the legend of so many agents takes, px.
pub(crate) fn legend_px(agents: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
    let rows = agents.div_ceil(4) as f64;
    rows * 24.0
}

/// Agents by number with their words, four to a row, from this height on.
pub(crate) fn draw_legend(svg: &mut Svg, entries: &[(u32, String)], width: f64, top: f64) {
    for (index, (number, text)) in entries.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
        let (column, row) = ((index % 4) as f64, (index / 4) as f64);
        let (x, y) = (27.0 + column * (width - 40.0) / 4.0, top + row * 24.0);
        svg.circle((x, y - 5.0), 6.5, &format!("fill=\"{}\"", palette::agent(*number)));
        let text = wrapped(text, (width - 40.0) / 4.0 - 24.0, 15.0, 1).concat();
        svg.heading((x + 13.0, y), &text, 15.0, palette::INK);
    }
}
