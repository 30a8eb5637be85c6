//! What pictures of ways have in common: lines with arrows, labels, the legend.

use crate::label::{Labels, text_width, wrapped};
use crate::palette;
use crate::svg::Svg;

/// The line of an agent, set off from what lies under it.
pub(crate) fn draw_line(svg: &mut Svg, line: &[(f64, f64)], color: &str) {
    svg.polyline(line, "stroke=\"#ffffff\" stroke-width=\"6.5\" stroke-linejoin=\"round\" stroke-opacity=\"0.8\"");
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

/// The body of an agent that looks along x, around 0 0, as the player of a page draws it: a robot is a rounded square, a
/// human a disc, and an arrow shows where they look.
pub(crate) fn body(robot: bool, r: f64, color: &str) -> String {
    let rim = format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"{:.2}\"", (r * 0.12).clamp(0.6, 2.5));
    if robot {
        return format!(
            "<rect x=\"{0:.2}\" y=\"{0:.2}\" width=\"{1:.2}\" height=\"{1:.2}\" rx=\"{2:.2}\" {rim}/>\
             <path d=\"M{3:.2} 0L{4:.2} {5:.2}L{6:.2} 0L{4:.2} -{5:.2}z\" fill=\"#ffffff\"/>",
            -r,
            2.0 * r,
            r * 0.3,
            r * 0.75,
            -r * 0.45,
            r * 0.55,
            -r * 0.2
        );
    }
    format!(
        "<circle r=\"{r:.2}\" {rim}/><path d=\"M{:.2} 0L{:.2} {:.2}L{:.2} -{:.2}z\" fill=\"#ffffff\"/>",
        r * 0.85,
        r * 0.2,
        r * 0.4,
        r * 0.2,
        r * 0.4
    )
}

/// [`body`] at a place of a drawing, turned counterclockwise from looking right, rad.
pub(crate) fn draw_body(svg: &mut Svg, (x, y): (f64, f64), yaw: f64, robot: bool, r: f64, color: &str) {
    svg.raw(&format!(
        "<g transform=\"translate({x:.2} {y:.2}) rotate({:.1})\">{}</g>",
        -yaw.to_degrees(),
        body(robot, r, color)
    ));
}

/// Where somebody started: the outline of their body.
pub(crate) fn draw_start(svg: &mut Svg, (x, y): (f64, f64), robot: bool, r: f64, color: &str, width: f64) {
    let style = format!("fill=\"#ffffff\" fill-opacity=\"0.9\" stroke=\"{color}\" stroke-width=\"{width}\"");
    if robot {
        svg.rect((x - r, y - r), (2.0 * r, 2.0 * r), &format!("rx=\"{:.2}\" {style}", r * 0.3));
    } else {
        svg.circle((x, y), r, &style);
    }
}

/// Words beside a place, where there is room for them; a thin line leads to words that stand apart from it.
pub(crate) fn draw_label(
    svg: &mut Svg,
    labels: &mut Labels,
    at: (f64, f64),
    text: &str,
    (color, size_px): (&str, f64),
    gap: f64,
) {
    /// Words so far beyond their gap need a line, px.
    const APART: f64 = 12.0;
    let area = labels.place(at, (text_width(text, size_px) + 6.0, size_px + 3.0), gap);
    let near = (at.0.clamp(area.x, area.x + area.w), at.1.clamp(area.y, area.y + area.h));
    let (dx, dy) = (near.0 - at.0, near.1 - at.1);
    let far = dx.hypot(dy);
    if far > gap + APART {
        let from = (at.0 + dx * gap / far, at.1 + dy * gap / far);
        svg.line(from, near, &format!("stroke=\"{color}\" stroke-width=\"1.2\""));
    }
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
        svg.raw(&format!("<g transform=\"translate({x:.1} {:.1})\">", y - 5.0));
        svg.raw(&body(*number == 0, 7.5, palette::agent(*number)));
        svg.raw("</g>");
        let text = wrapped(text, (width - 40.0) / 4.0 - 24.0, 15.0, 1).concat();
        svg.heading((x + 13.0, y), &text, 15.0, palette::INK);
    }
}
