//! A figure for a paper: who went where and when, at the width of a column.

use std::collections::BTreeMap;

use socrates_model::{AgentId, EventKind, Location, Paths, Recording};

use crate::camera::still;
use crate::label::{Area, Labels, text_width, wrapped};
use crate::map_layer::{draw_doors, draw_floor, wall_areas};
use crate::marks::{draw_body, draw_start};
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Points of a printer in a millimeter.
const PT_PER_MM: f64 = 72.0 / 25.4;
/// Letters on the map and in the legend, pt: what journals ask for at least in a figure.
const TEXT_PT: f64 = 7.0;
/// Seconds between two marks on a track; doubled until there are at most [`MARKS`].
const MARK_SECS: f64 = 5.0;
/// Most marks on a track.
const MARKS: f64 = 8.0;
/// Tracks of so many humans get a name, a mark and a line of the legend; more are drawn thin.
const NAMED: usize = 8;
/// Colors and dashes of the robot's ways: they differ in gray print too.
const WAYS: [(&str, &str); 4] =
    [(palette::ROBOT, ""), ("#000000", "4 2"), ("#E69F00", "1.2 1.8"), ("#56B4E9", "6 2 1.2 2")];

/// Why a figure could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// There is nothing to show.
    #[error("the figure has no run to show")]
    Empty,
    /// More runs than line styles.
    #[error("`{found}` runs cannot be told apart in one figure; at most 4")]
    Crowded {
        /// Runs asked for.
        found: usize,
    },
    /// A width that no page has.
    #[error("`{found}` mm is no width of a figure; allowed: 40 to 400")]
    Width {
        /// Width asked for, mm.
        found: f64,
    },
}

/// The figure as SVG, its width in millimeters. Of the first run everybody is drawn, of further runs only the robot.
/// The camera is that of `all` runs of the scenario.
///
/// # Errors
/// [`FigureError`] when there is no run, or more than four, or the width is impossible.
pub fn figure(
    location: &Location,
    paths: Option<&Paths>,
    all: &[&Recording],
    shown: &[&Recording],
    width_mm: f64,
) -> Result<String, FigureError> {
    if !(40.0..=400.0).contains(&width_mm) {
        return Err(FigureError::Width { found: width_mm });
    }
    let Some(first) = shown.first() else { return Err(FigureError::Empty) };
    if shown.len() > WAYS.len() {
        return Err(FigureError::Crowded { found: shown.len() });
    }
    let width = width_mm * PT_PER_MM;
    let mut frame = still(location, paths, all, (width - 1.0, width * 0.8), (0.5, 0.5));
    let (w, h) = frame.size();
    // The map has the width of the column; a tall one stands in its middle.
    frame.at = ((width - w) / 2.0, 0.5);
    let entries = legend(first, shown);
    let (columns, rows) = legend_grid(&entries, width);
    #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
    let height = h + 1.0 + TEXT_PT * 1.5 * (rows as f64 + 0.75) + TEXT_PT;
    let mut svg = Svg::in_mm(width_mm, width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    svg.begin_clip(frame.at, (w, h));
    draw_floor(&mut svg, location, &frame);
    draw_doors(&mut svg, location, &frame);
    let mut labels = Labels::scaled(Area { x: frame.at.0, y: frame.at.1, w, h }, TEXT_PT / 16.0);
    labels.avoid(wall_areas(location, &frame));
    let px = |x: f64, y: f64| frame.px(location, &socrates_model::Point::new(x, y));
    let mut tracks = Vec::new();
    for info in first.header.agents.iter().filter(|info| info.agent != AgentId::Robot) {
        let named = first.header.agents.len() <= NAMED + 1;
        let width_pt = if named { 1.2 } else { 0.5 };
        tracks.push(Track {
            run: first,
            agent: info.agent,
            color: palette::agent(info.agent.number()),
            dash: "",
            width_pt,
            named,
        });
    }
    for (run, (color, dash)) in shown.iter().zip(WAYS).rev() {
        if run.header.agents.iter().any(|info| info.agent == AgentId::Robot) {
            tracks.push(Track { run, agent: AgentId::Robot, color, dash, width_pt: 1.6, named: true });
        }
    }
    for track in &tracks {
        let line = track.line(&px);
        labels.avoid_line(&line);
        let dash = if track.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", track.dash) };
        let common = "stroke-linejoin=\"round\" stroke-linecap=\"butt\"";
        svg.polyline(&line, &format!("stroke=\"#ffffff\" stroke-width=\"{:.1}\" {common}", track.width_pt + 1.2));
        svg.polyline(
            &line,
            &format!("stroke=\"{}\" stroke-width=\"{:.1}\"{dash} {common}", track.color, track.width_pt),
        );
    }
    for track in &tracks {
        track.draw_ends(&mut svg, &px, &mut labels);
    }
    let met = encounters(first, &px);
    // A mark under the diamond of an encounter would be neither seen nor read.
    let hidden = |at: (f64, f64)| met.iter().any(|(met, _)| (met.0 - at.0).hypot(met.1 - at.1) < 5.5);
    let named = tracks.iter().filter(|track| track.named);
    let marks: Vec<Mark> = named.flat_map(|track| track.marks(&px)).filter(|mark| !hidden(mark.at)).collect();
    for mark in &marks {
        svg.circle(mark.at, 1.3, &format!("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"0.8\"", mark.color));
        labels.block(Area { x: mark.at.0 - 2.0, y: mark.at.1 - 2.0, w: 4.0, h: 4.0 });
    }
    for (at, color) in met {
        draw_diamond(&mut svg, at, color, &mut labels);
    }
    // Names matter more than times: they take their places first.
    for track in tracks.iter().filter(|track| track.named && std::ptr::eq(track.run, *first)) {
        let Some(start) = track.line(&px).first().copied() else { continue };
        let name = track.agent.to_string().replace("human_", "h");
        label(&mut svg, &mut labels, start, &name, palette::agent_words(track.agent.number()), 3.5);
    }
    for mark in marks.iter().filter(|mark| mark.told) {
        label(&mut svg, &mut labels, mark.at, &mark.words, mark.ink, 2.0);
    }
    svg.end_clip();
    svg.rect(frame.at, (w, h), &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"0.5\"", palette::WALL));
    draw_legend(&mut svg, &entries, columns, width, h + 1.0, frame.len(location, 1.0), mark_secs(first));
    Ok(svg.finish())
}

/// One line on the map.
#[derive(Debug)]
struct Track<'a> {
    run: &'a Recording,
    agent: AgentId,
    color: &'static str,
    dash: &'static str,
    width_pt: f64,
    named: bool,
}

/// A moment on a line.
#[derive(Debug)]
struct Mark {
    at: (f64, f64),
    words: String,
    color: &'static str,
    ink: &'static str,
    told: bool,
}

impl Track<'_> {
    fn line(&self, px: &dyn Fn(f64, f64) -> (f64, f64)) -> Vec<(f64, f64)> {
        let mut line: Vec<(f64, f64)> = Vec::new();
        let there = There::of(self.run);
        for state in self.run.track(self.agent).filter(|state| there.is(state)) {
            let at = px(state.x, state.y);
            if line.last().is_none_or(|last| (last.0 - at.0).hypot(last.1 - at.1) > 0.7) {
                line.push(at);
            }
        }
        line
    }

    /// Every so many seconds, where somebody moves; only the first robot's and the humans' have their times written.
    fn marks(&self, px: &dyn Fn(f64, f64) -> (f64, f64)) -> Vec<Mark> {
        let every = mark_secs(self.run);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number of ticks")]
        let ticks = (every / self.run.header.step_s.max(1e-4)).round().max(1.0) as usize;
        let mut marks = Vec::new();
        let there = There::of(self.run);
        let line = self.line(px);
        let (Some(mut last), Some(end)) = (line.first().copied(), line.last().copied()) else { return marks };
        let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1) < 4.5;
        for (index, state) in self.run.track(self.agent).step_by(ticks).enumerate().skip(1) {
            if !there.is(state) {
                continue;
            }
            let at = px(state.x, state.y);
            // Who stands would get a heap of marks; both ends have marks of their own.
            if near(at, last) || near(at, end) {
                continue;
            }
            last = at;
            #[expect(clippy::cast_precision_loss, reason = "few marks")]
            let words = format!("{:.0}", index as f64 * every);
            let ink = palette::agent_words(self.agent.number());
            marks.push(Mark { at, words, color: self.color, ink, told: self.dash.is_empty() });
        }
        marks
    }

    fn draw_ends(&self, svg: &mut Svg, px: &dyn Fn(f64, f64) -> (f64, f64), labels: &mut Labels) {
        let there = There::of(self.run);
        let mut track = self.run.track(self.agent).filter(|state| there.is(state));
        let Some(first) = track.next() else { return };
        let last = track.last().unwrap_or(first);
        let r = if self.named { 3.0 } else { 1.2 };
        let (from, to) = (px(first.x, first.y), px(last.x, last.y));
        let robot = self.agent == AgentId::Robot;
        draw_body(svg, to, last.yaw, robot, r, self.color);
        let apart = (from.0 - to.0).hypot(from.1 - to.1);
        draw_start(svg, from, robot, if apart < 2.0 * r { r * 0.6 } else { r }, self.color, 1.0);
        for (x, y) in [from, to] {
            labels.block(Area { x: x - r, y: y - r, w: 2.0 * r, h: 2.0 * r });
        }
    }
}

/// Seconds between two marks of a run.
fn mark_secs(run: &Recording) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a recording has fewer than 2^53 ticks")]
    let length = run.ticks() as f64 * run.header.step_s;
    let mut every = MARK_SECS;
    while length / every > MARKS && every < 1e6 {
        every *= 2.0;
    }
    every
}

fn label(svg: &mut Svg, labels: &mut Labels, at: (f64, f64), words: &str, color: &str, gap: f64) {
    let area = labels.place(at, (text_width(words, TEXT_PT) + 1.5, TEXT_PT * 1.05), gap);
    let base = (area.x + area.w / 2.0, area.y + TEXT_PT * 0.85);
    // One text with a rim below its letters: whoever copies it out of a PDF gets it once.
    let style = format!("font-size=\"{TEXT_PT}\" text-anchor=\"middle\" fill=\"{color}\"");
    let rim = "stroke=\"#ffffff\" stroke-width=\"2\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
    svg.text(base, words, &format!("{style} {rim}"));
}

/// Every encounter, where the robot was, in the color of whoever it met.
fn encounters(run: &Recording, px: &dyn Fn(f64, f64) -> (f64, f64)) -> Vec<((f64, f64), &'static str)> {
    let mut met = BTreeMap::new();
    for event in &run.events {
        if let EventKind::Encounter { human, nth, .. } = &event.kind {
            met.entry((*human, *nth)).or_insert(event.time);
        }
    }
    met.into_iter()
        .filter_map(|((human, _), time)| {
            let tick = usize::try_from(time.tick()).unwrap_or(usize::MAX);
            let robot = run.tick(tick).iter().find(|state| state.agent == 0)?;
            Some((px(robot.x, robot.y), palette::human(human.number())))
        })
        .collect()
}

fn draw_diamond(svg: &mut Svg, (x, y): (f64, f64), color: &str, labels: &mut Labels) {
    svg.raw(&format!(
        "<path d=\"M{x:.2} {:.2}l3.2 3.2l-3.2 3.2l-3.2 -3.2z\" fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"0.6\"/>",
        y - 3.2
    ));
    labels.block(Area { x: x - 3.2, y: y - 3.2, w: 6.4, h: 6.4 });
}

/// One entry of the legend: color, dash, words.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    color: &'static str,
    dash: &'static str,
    words: String,
}

fn legend(first: &Recording, shown: &[&Recording]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = shown
        .iter()
        .zip(WAYS)
        .filter(|(run, _)| run.header.agents.iter().any(|info| info.agent == AgentId::Robot))
        .map(|(run, (color, dash))| Entry {
            color,
            dash,
            words: format!("robot, {} (seed {})", run.header.planner, run.header.seed),
        })
        .collect();
    let humans: Vec<_> = first.header.agents.iter().filter(|info| info.agent != AgentId::Robot).collect();
    if humans.len() > NAMED {
        entries.push(Entry { color: palette::human(1), dash: "", words: format!("{} humans", humans.len()) });
    } else {
        entries.extend(humans.iter().map(|info| {
            let name = info.agent.to_string().replace("human_", "h");
            let words = if info.role.is_empty() { name } else { format!("{name}, {}", info.role) };
            Entry { color: palette::agent(info.agent.number()), dash: "", words }
        }));
    }
    entries
}

/// As many columns as the longest entry allows.
fn legend_grid(entries: &[Entry], width: f64) -> (usize, usize) {
    let longest = entries.iter().map(|entry| text_width(&entry.words, TEXT_PT) + 24.0).fold(40.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "one to four columns")]
    let columns = (width / longest).floor().clamp(1.0, 4.0) as usize;
    (columns, entries.len().div_ceil(columns))
}

fn draw_legend(svg: &mut Svg, entries: &[Entry], columns: usize, width: f64, top: f64, px_per_m: f64, every_s: f64) {
    let line = TEXT_PT * 1.5;
    // A thin outline gives the light letters body in print.
    let style = format!("font-size=\"{TEXT_PT}\" fill=\"{0}\" stroke=\"{0}\" stroke-width=\"0.15\"", palette::INK);
    let meters = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|m| m * px_per_m >= 22.0).unwrap_or(100.0);
    let (y, w) = (top + line * 0.75, meters * px_per_m);
    svg.raw(&format!(
        "<path d=\"M1 {0:.2}v4M1 {1:.2}h{w:.2}M{2:.2} {0:.2}v4\" stroke=\"{3}\" stroke-width=\"0.8\" fill=\"none\"/>",
        y - 2.0,
        y,
        1.0 + w,
        palette::INK
    ));
    svg.text((w + 4.0, y + TEXT_PT * 0.35), &format!("{meters} m"), &style);
    let mut parts = vec![
        (Sign::Start, "start".to_owned()),
        (Sign::End, "end".to_owned()),
        (Sign::Encounter, "encounter".to_owned()),
        (Sign::Mark, format!("every {every_s:.0} s")),
    ];
    while parts.len() > 1 && note_width(&parts) > width - w - 14.0 - text_width("50 m", TEXT_PT) {
        parts.pop();
    }
    draw_note(svg, width - 1.0, y + TEXT_PT * 0.35, &parts, &style);
    for (index, entry) in entries.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
        let (column, row) = ((index % columns) as f64, (index / columns) as f64);
        #[expect(clippy::cast_precision_loss, reason = "one to four columns")]
        let wide = width / columns as f64;
        let (x, y) = (column * wide + 1.0, top + line * (row + 1.75));
        let dash = if entry.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", entry.dash) };
        svg.line((x, y), (x + 15.0, y), &format!("stroke=\"{}\" stroke-width=\"1.8\"{dash}", entry.color));
        let words = wrapped(&entry.words, wide - 20.0, TEXT_PT, 1).concat();
        svg.text((x + 18.0, y + TEXT_PT * 0.35), &words, &style);
    }
}

/// A sign of the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Start,
    End,
    Encounter,
    Mark,
}

/// Room of a sign and the gap behind its words, pt.
const SIGN_PT: f64 = 6.8;
const GAP_PT: f64 = 5.0;

fn note_width(parts: &[(Sign, String)]) -> f64 {
    parts.iter().map(|(_, words)| SIGN_PT + text_width(words, TEXT_PT) + GAP_PT).sum::<f64>() - GAP_PT
}

/// The explanation of the signs, ending at the right edge; the signs are drawn, for fonts differ in them.
fn draw_note(svg: &mut Svg, right: f64, base: f64, parts: &[(Sign, String)], style: &str) {
    let ink = palette::INK;
    let ring = |width: f64| format!("fill=\"#ffffff\" stroke=\"{ink}\" stroke-width=\"{width}\"");
    let mut x = right - note_width(parts);
    for (sign, words) in parts {
        let center = (x + 2.4, base - TEXT_PT * 0.33);
        match sign {
            Sign::Start => svg.circle(center, 1.9, &ring(0.9)),
            Sign::End => svg.circle(center, 2.35, &format!("fill=\"{ink}\"")),
            Sign::Encounter => svg.raw(&format!(
                "<path d=\"M{:.2} {:.2}l2.6 2.6l-2.6 2.6l-2.6 -2.6z\" fill=\"{ink}\"/>",
                center.0,
                center.1 - 2.6
            )),
            Sign::Mark => svg.circle(center, 1.3, &ring(0.8)),
        }
        svg.text((x + SIGN_PT, base), words, style);
        x += SIGN_PT + text_width(words, TEXT_PT) + GAP_PT;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, walk};

    #[test]
    fn the_figure_is_as_wide_as_the_column_and_its_letters_can_be_read() {
        let (location, run) = (hall("hall"), walk(2));
        let svg = figure(&location, None, &[&run], &[&run], 84.0).unwrap();
        assert!(svg.contains("width=\"84mm\""), "{}", svg.lines().next().unwrap());
        // Drawing units are points, so a font size of 7 is 7 pt on paper.
        assert!(svg.contains("viewBox=\"0 0 238.11 "));
        let least = svg.split("font-size=\"").skip(1).filter_map(|rest| rest.split('"').next()?.parse::<f64>().ok());
        assert!(least.fold(f64::MAX, f64::min) >= 7.0);
        for word in ["robot, reference", "h1, human_1", "start", "end", ">5<"] {
            assert!(svg.contains(word), "{word}");
        }
    }

    #[test]
    fn further_runs_add_the_robots_way_in_another_dash() {
        let (location, run) = (hall("hall"), walk(1));
        let one = figure(&location, None, &[&run], &[&run], 84.0).unwrap();
        let two = figure(&location, None, &[&run], &[&run, &run], 84.0).unwrap();
        assert!(!one.contains("stroke-dasharray=\"4 2\"") && two.contains("stroke-dasharray=\"4 2\""));
        assert_eq!(two, figure(&location, None, &[&run], &[&run, &run], 84.0).unwrap());
    }

    #[test]
    fn nobody_a_crowd_and_hostile_words_have_a_figure_too() {
        let mut evil = walk(1);
        evil.header.agents[1].role = EVIL.to_owned();
        for run in [walk(0), walk(300), evil] {
            let svg = figure(&hall("hall"), None, &[&run], &[&run], 84.0).unwrap();
            assert!(!svg.contains("<script") && !svg.contains("<img") && !svg.contains("NaN"));
            crate::png::png_at_dpi(&svg, 300.0).unwrap();
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let (location, run) = (hall("hall"), walk(0));
        assert_eq!(figure(&location, None, &[&run], &[], 84.0), Err(FigureError::Empty));
        assert_eq!(figure(&location, None, &[&run], &[&run; 5], 84.0), Err(FigureError::Crowded { found: 5 }));
        assert!(matches!(figure(&location, None, &[&run], &[&run], f64::NAN), Err(FigureError::Width { .. })));
        assert!(matches!(figure(&location, None, &[&run], &[&run], 4.0), Err(FigureError::Width { .. })));
    }
}
