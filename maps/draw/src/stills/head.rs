//! What stands over the pictures of a sheet: the name of the run, what the signs mean, and who is who.

use socrates_model::AgentId;

use super::plan::MARGIN;
use super::{Scene, body, draw_body};
use crate::label::text_width;
use crate::marks::draw_arrow;
use crate::palette;
use crate::svg::Svg;

/// Height of letters, of a line, and of the line with the name, px.
const LETTERS: f64 = 16.0;
const LINE: f64 = 26.0;
const NAME_LINE: f64 = 38.0;
/// Width of a sheet's lines, px.
const WIDTH: f64 = 1530.0;
/// Radius of a body in the head, px.
const BODY: f64 = 9.0;
/// More people are not listed one by one.
const LISTED: usize = 40;

/// The head of a sheet.
#[derive(Debug)]
pub(super) struct Head {
    /// Lines of people with their places from the left, px, and their roles.
    lines: Vec<Vec<(f64, AgentId, String)>>,
}

impl Head {
    pub(super) fn of(scene: &Scene<'_>) -> Self {
        let mut lines: Vec<Vec<(f64, AgentId, String)>> = vec![Vec::new()];
        let mut x = MARGIN;
        for info in scene.recording.header.agents.iter().take(LISTED) {
            let role = if info.agent.number() == 0 { "robot" } else { info.role.as_str() };
            let w = 2.0 * BODY + 18.0 + text_width(role, LETTERS) + 24.0;
            if x + w > WIDTH && x > MARGIN {
                lines.push(Vec::new());
                x = MARGIN;
            }
            if let Some(line) = lines.last_mut() {
                line.push((x, info.agent, role.to_owned()));
            }
            x += w;
        }
        Self { lines }
    }

    pub(super) fn height_px(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a few lines")]
        let lines = self.lines.len() as f64;
        NAME_LINE + LINE * (lines + 1.0) + 8.0
    }

    pub(super) fn draw(&self, svg: &mut Svg, scene: &Scene<'_>, name: &str) {
        svg.heading((MARGIN, 28.0), name, 26.0, palette::INK);
        let mut top = NAME_LINE + 18.0;
        for line in &self.lines {
            for (x, agent, role) in line {
                draw_body(svg, (x + BODY, top - 5.0), 0.0, *agent, &scene.sign(*agent), BODY);
                words(svg, (x + 2.0 * BODY + 14.0, top), role);
            }
            top += LINE;
        }
        draw_signs(svg, top);
    }
}

fn words(svg: &mut Svg, at: (f64, f64), text: &str) -> f64 {
    svg.text(at, text, &format!("font-size=\"{LETTERS}\" fill=\"{}\"", palette::INK));
    at.0 + text_width(text, LETTERS) + 22.0
}

/// What the signs mean, in one line.
fn draw_signs(svg: &mut Svg, top: f64) {
    let (mut x, y) = (MARGIN, top - 5.0);
    let ink = palette::QUIET;
    svg.raw(&format!("<g transform=\"translate({:.1} {y:.1})\">{}</g>", x + BODY, body(false, 8.0, ink)));
    x = words(svg, (x + 30.0, top), "the tip shows where they face");
    svg.line((x, y), (x + 26.0, y), &format!("stroke=\"{ink}\" stroke-width=\"3\""));
    draw_arrow(svg, (x + 26.0, y), 0.0, ink);
    x = words(svg, (x + 42.0, top), "walks: their next second; no arrow: stands");
    svg.line((x, y), (x + 34.0, y), &format!("stroke=\"{ink}\" stroke-width=\"3\" stroke-opacity=\"0.6\""));
    for dot in [0.0, 17.0, 34.0] {
        svg.circle((x + dot, y), 2.6, &format!("fill=\"{ink}\""));
    }
    x = words(svg, (x + 44.0, top), "way since the last picture, a dot each second");
    svg.line((x, y), (x + 26.0, y), &format!("stroke=\"{}\" stroke-width=\"4\"", palette::DOOR));
    x = words(svg, (x + 34.0, top), "closed door");
    svg.rect((x, y - 9.0), (46.0, 18.0), "rx=\"4\" fill=\"#fff4d6\" stroke=\"#b07a00\" stroke-width=\"1.5\"");
    svg.text((x + 5.0, y + 4.5), "WAIT", &format!("font-size=\"13\" fill=\"{}\"", palette::INK));
    words(svg, (x + 54.0, top), "gesture, while it is made");
}
