//! The cards of a film: what is shown at its beginning, what became of it at its end.

use socrates_model::{AgentId, Verdict};

use crate::film::{Film, LINE, Panel};
use crate::film_times::length_s;
use crate::label::{Area, text_width, wrapped};
use crate::palette;
use crate::svg::Svg;

/// Height of the letters of a title, in heights of the other letters.
const TITLE: f64 = 1.8;
/// Most lines of a title, of the people, of a verdict's reason and of what the robot did.
const LINES: usize = 3;
/// So many people are named on the first card.
const NAMED: usize = 8;

/// A line of a card: words, height in heights of the letters, color.
type Line = (String, f64, &'static str);

/// Lines in the middle of a part of the picture, on a light ground through which it can still be seen.
fn draw_card(svg: &mut Svg, area: Area, size: f64, lines: &[Line]) {
    svg.rect((area.x, area.y), (area.w, area.h), "fill=\"#ffffff\" fill-opacity=\"0.9\"");
    let high: f64 = lines.iter().map(|(_, large, _)| size * large * LINE).sum();
    let mut y = area.y + (area.h - high) / 2.0;
    for (words, large, color) in lines {
        let letters = size * large;
        y += letters * LINE;
        let x = area.x + (area.w - text_width(words, letters)) / 2.0;
        svg.heading((x, y - letters * (LINE - 1.0)), words, letters, color);
    }
}

fn in_lines(words: &str, width: f64, (size, large): (f64, f64), color: &'static str) -> Vec<Line> {
    wrapped(words, width, size * large, LINES).into_iter().map(|line| (line, large, color)).collect()
}

/// The card at the beginning: scenario, planner and seed of every run, people, and which part is shown.
pub(crate) fn draw_title(svg: &mut Svg, film: &Film<'_>) {
    let Some(first) = film.panels.first() else { return };
    let size = first.look.text_px;
    let (w, h) = (f64::from(film.options.size.0), f64::from(film.options.size.1));
    let width = w - 4.0 * size;
    let mut lines = in_lines(film.title, width, (size, TITLE), palette::INK);
    let runs: Vec<&str> = film.panels.iter().map(|panel| panel.title.as_str()).collect();
    let beside = if runs.len() > 1 { " | " } else { "" };
    lines.extend(in_lines(
        &format!("{} · {}", first.location.name, runs.join(beside)),
        width,
        (size, 1.0),
        palette::INK,
    ));
    let people: Vec<String> = first
        .recording
        .header
        .agents
        .iter()
        .filter(|info| info.agent != AgentId::Robot)
        .map(|info| {
            let name = crate::film::short_names(&info.agent.to_string());
            if info.role.is_empty() || info.role == info.agent.to_string() {
                name
            } else {
                format!("{name} {}", info.role)
            }
        })
        .collect();
    let people = match people.len() {
        0 => String::new(),
        count if count > NAMED => format!("{count} people"),
        _ => people.join(" · "),
    };
    lines.extend(
        in_lines(&people, width, (size, 1.0), palette::QUIET).into_iter().filter(|(words, ..)| !words.is_empty()),
    );
    let whole = film.panels.iter().map(|panel| length_s(panel.recording)).fold(0.0, f64::max);
    let times = film.times;
    let part = if times.to_s - times.from_s > whole - 0.05 {
        format!("{whole:.1} s{}", film.speed_words())
    } else {
        format!("{:.1} s to {:.1} s of {whole:.1} s{}", times.from_s, times.to_s, film.speed_words())
    };
    lines.extend(in_lines(&part, width, (size, 1.0), palette::QUIET));
    draw_card(svg, Area { x: 0.0, y: 0.0, w, h }, size, &lines);
}

/// The card at the end of a run: its verdict with the reason, and what the robot did.
pub(crate) fn draw_end(svg: &mut Svg, panel: &Panel<'_>) {
    let Some(report) = panel.report else { return };
    let size = panel.look.text_px;
    let width = panel.size.0 - 4.0 * size;
    let good = matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate);
    let color = if good { palette::GOOD } else { palette::BAD };
    let mut lines = in_lines(&panel.title, width, (size, 1.0), palette::QUIET);
    lines.extend(in_lines(&report.verdict.name().replace('_', " "), width, (size, TITLE), color));
    lines.extend(in_lines(&crate::film::short_names(&report.verdict_text), width, (size, 1.0), palette::INK));
    lines.extend(in_lines(&crate::film::short_names(&report.robot_text), width, (size, 1.0), palette::QUIET));
    let area = Area { x: panel.at.0, y: panel.at.1, w: panel.size.0, h: panel.size.1 };
    draw_card(svg, area, size, &lines);
}
