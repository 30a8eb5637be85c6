//! The picture of one run: where everybody went, and when.

use std::collections::BTreeSet;

use socrates_model::{AgentId, EventKind, HumanId, Location, Paths, Point, Recording, Report, Verdict, ordinal};

use crate::label::{Area, Labels, text_width, wrapped};
use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_locator, draw_scale, wall_areas};
use crate::marks::{draw_arrow, draw_label, draw_legend, draw_line, legend_px};
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Seconds between two time marks on a track.
const MARK_SECS: f64 = 5.0;
/// Below this speed somebody stands, m/s.
const STANDS_MPS: f64 = 0.1;

/// Height of the heading where nothing in it takes more than its line, px.
const HEAD_PX: f64 = 118.0;
/// Most lines of the verdict's reason and of what the robot did: enough for a sentence with its cause at the end.
const LINES: usize = 4;
/// From one line of the heading to the next, px.
const LINE_PX: f64 = 18.0;
/// Height of the small map beside the heading, px.
const LOCATOR_PX: f64 = 96.0;

/// Draws the part of the map where it happens, every track with marks every 5 s, starts, ends and encounters, and a legend.
#[must_use]
pub fn run_picture(
    location: &Location,
    recording: &Recording,
    paths: Option<&Paths>,
    report: Option<&Report>,
    title: &str,
) -> String {
    let way = paths.map(|paths| location.graph.polyline(&paths.robot)).unwrap_or_default();
    let there = There::of(recording);
    let seen: Vec<Point> = recording
        .header
        .agents
        .iter()
        .flat_map(|info| recording.track(info.agent).filter(|state| there.is(state)).map(|state| state.point()))
        .chain(way.iter().copied())
        .collect();
    let mut frame = Frame::focused(location, &seen, 1160.0, 800.0, (20.0, HEAD_PX));
    let focused = frame.cells != Frame::around(location, 1160.0, 800.0, (20.0, HEAD_PX)).cells;
    let (w, h) = frame.size();
    let width = (w + 40.0).max(760.0);
    let words = width - 40.0 - if focused { 210.0 } else { 0.0 };
    let told = report.map(|report| Told::of(report, words));
    let head = told.as_ref().map_or(HEAD_PX, |told| told.bottom().max(HEAD_PX));
    frame.at.1 = head;
    let height = head + h + 40.0 + legend_px(recording.header.agents.len()) + 14.0;
    let mut svg = Svg::new(width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    if focused {
        draw_locator(&mut svg, location, &frame, width - 20.0, 10.0, (190.0, LOCATOR_PX));
    }
    svg.heading((20.0, 34.0), &wrapped(title, words, 24.0, 1).concat(), 24.0, palette::INK);
    if let Some(told) = told {
        told.draw(&mut svg);
    }
    svg.begin_clip(frame.at, frame.size());
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
    let line: Vec<(f64, f64)> = way.iter().map(|p| frame.px(location, p)).collect();
    svg.polyline(
        &line,
        &format!("stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"3 5\" opacity=\"0.7\"", palette::ROBOT),
    );
    draw_doors(&mut svg, location, &frame);
    let mut labels = Labels::within(Area { x: frame.at.0, y: frame.at.1, w, h });
    labels.avoid(wall_areas(location, &frame));
    // The robot is drawn last, so that its track lies on top.
    let mut agents: Vec<AgentId> = recording.header.agents.iter().map(|info| info.agent).collect();
    agents.reverse();
    for agent in &agents {
        draw_track(&mut svg, location, recording, &frame, *agent, &mut labels);
    }
    for agent in &agents {
        draw_ends(&mut svg, location, recording, &frame, *agent, &mut labels);
    }
    draw_encounters(&mut svg, location, recording, &frame, &mut labels);
    // Names come last: by now it is known what they must not hide.
    for agent in &agents {
        if let Some(first) = recording.track(*agent).find(|state| there.is(state)) {
            let gap = radius_px(location, recording, &frame, *agent) + 3.0;
            let color = palette::agent_words(agent.number());
            draw_label(
                &mut svg,
                &mut labels,
                frame.px(location, &first.point()),
                &agent.to_string(),
                (color, 15.0),
                gap,
            );
        }
    }
    svg.end_clip();
    svg.rect(frame.at, (w, h), &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"1\"", palette::GRAPH));
    draw_scale(&mut svg, location, &frame, 18.0);
    let more = if paths.is_some() { " · diamond: encounter · dots: intended way" } else { "" };
    svg.text(
        (width - 20.0, frame.at.1 + h + 22.0),
        &format!("ring: start · disc: end · arrow: every {MARK_SECS:.0} s{more}"),
        &format!("font-size=\"13\" text-anchor=\"end\" fill=\"{}\"", palette::QUIET),
    );
    let legend: Vec<(u32, String)> = recording
        .header
        .agents
        .iter()
        .map(|info| {
            let text = if info.agent == AgentId::Robot {
                format!("robot ({})", recording.header.planner)
            } else {
                format!("{} ({})", info.agent, info.role)
            };
            (info.agent.number(), text)
        })
        .collect();
    draw_legend(&mut svg, &legend, width, head + h + 54.0);
    svg.finish()
}

/// What the heading tells of a run: its verdict with the reason beside it, and what the robot did, in lines.
struct Told {
    verdict: String,
    color: &'static str,
    pill: f64,
    reason: Vec<String>,
    robot: Vec<String>,
}

impl Told {
    fn of(report: &Report, width: f64) -> Self {
        let good = matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate);
        let verdict = report.verdict.name().replace('_', " ");
        let pill = text_width(&verdict, 15.0) + 22.0;
        Self {
            color: if good { palette::GOOD } else { palette::BAD },
            reason: wrapped(&report.verdict_text, width - pill - 12.0, 15.0, LINES),
            robot: wrapped(&format!("{} · seed {}", report.robot_text, report.seed), width, 14.0, LINES),
            verdict,
            pill,
        }
    }

    /// Where the line of this number is, px.
    fn y(line: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a few lines")]
        let line = line as f64;
        63.0 + line * LINE_PX
    }

    /// Lines of the robot begin below those of the reason, a little apart.
    fn robot_y(&self, line: usize) -> f64 {
        Self::y(self.reason.len() + line) + 9.0
    }

    fn bottom(&self) -> f64 {
        self.robot_y(self.robot.len()) - 8.0
    }

    fn draw(&self, svg: &mut Svg) {
        svg.rect((20.0, 46.0), (self.pill, 24.0), &format!("rx=\"12\" fill=\"{}\"", self.color));
        svg.text(
            (20.0 + self.pill / 2.0, 63.0),
            &self.verdict,
            "font-size=\"15\" text-anchor=\"middle\" fill=\"#ffffff\" stroke=\"#ffffff\" stroke-width=\"0.6\"",
        );
        for (line, text) in self.reason.iter().enumerate() {
            let style = format!("font-size=\"15\" fill=\"{}\"", palette::INK);
            svg.text((32.0 + self.pill, Self::y(line)), text, &style);
        }
        for (line, text) in self.robot.iter().enumerate() {
            svg.text((20.0, self.robot_y(line)), text, &format!("font-size=\"14\" fill=\"{}\"", palette::QUIET));
        }
    }
}

fn draw_track(
    svg: &mut Svg,
    location: &Location,
    recording: &Recording,
    frame: &Frame,
    agent: AgentId,
    labels: &mut Labels,
) {
    let color = palette::agent(agent.number());
    let mut line: Vec<(f64, f64)> = Vec::new();
    let mut marks: Vec<((f64, f64), f64)> = Vec::new();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive constant")]
    let mark_ticks = (MARK_SECS / recording.header.step_s.max(1e-3)).round() as usize;
    let there = There::of(recording);
    for (tick, state) in recording.track(agent).enumerate().filter(|(_, state)| there.is(state)) {
        let at = frame.px(location, &state.point());
        let moved = line.last().is_none_or(|last: &(f64, f64)| (last.0 - at.0).hypot(last.1 - at.1) > 1.0);
        if moved {
            line.push(at);
        }
        // Somebody who stands has no direction of going, and a heap of marks at one place says nothing.
        if tick > 0 && tick % mark_ticks.max(1) == 0 && state.vx.hypot(state.vy) > STANDS_MPS {
            marks.push((at, -state.vy.atan2(state.vx).to_degrees()));
        }
    }
    labels.avoid_line(&line);
    draw_line(svg, &line, color);
    for (at, degrees) in marks {
        draw_arrow(svg, at, degrees, color);
    }
}

fn radius_px(location: &Location, recording: &Recording, frame: &Frame, agent: AgentId) -> f64 {
    let radius_m = recording.header.agents.iter().find(|info| info.agent == agent).map_or(0.28, |info| info.radius_m);
    frame.len(location, radius_m).max(5.0)
}

fn draw_ends(
    svg: &mut Svg,
    location: &Location,
    recording: &Recording,
    frame: &Frame,
    agent: AgentId,
    labels: &mut Labels,
) {
    let color = palette::agent(agent.number());
    let radius = radius_px(location, recording, frame, agent);
    let there = There::of(recording);
    let mut track = recording.track(agent).filter(|state| there.is(state));
    let Some(first) = track.next() else { return };
    let last = track.last().unwrap_or(first);
    let (start, end) = (frame.px(location, &first.point()), frame.px(location, &last.point()));
    if (start.0 - end.0).hypot(start.1 - end.1) > 1.0 {
        svg.circle(
            start,
            radius,
            &format!("fill=\"#ffffff\" fill-opacity=\"0.85\" stroke=\"{color}\" stroke-width=\"3\""),
        );
    }
    svg.circle(end, radius, &format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1.5\""));
    let nose = (end.0 + radius * last.yaw.cos(), end.1 - radius * last.yaw.sin());
    svg.line(end, nose, "stroke=\"#ffffff\" stroke-width=\"2.4\"");
    for (x, y) in [start, end] {
        labels.block(Area { x: x - radius, y: y - radius, w: radius * 2.0, h: radius * 2.0 });
    }
}

/// Who meets the robot more than once.
pub(crate) fn several(recording: &Recording) -> BTreeSet<HumanId> {
    let again =
        |kind: &EventKind| if let EventKind::Encounter { human, nth: 2.., .. } = kind { Some(*human) } else { None };
    recording.events.iter().filter_map(|event| again(&event.kind)).collect()
}

fn draw_encounters(svg: &mut Svg, location: &Location, recording: &Recording, frame: &Frame, labels: &mut Labels) {
    let again = several(recording);
    for event in &recording.events {
        let EventKind::Encounter { human, nth, .. } = &event.kind else { continue };
        let tick = usize::try_from(event.time.tick()).unwrap_or(usize::MAX);
        let Some(robot) = recording.tick(tick).iter().find(|state| state.agent == 0) else { continue };
        let (x, y) = frame.px(location, &robot.point());
        svg.raw(&format!(
            "<path d=\"M{x:.1} {:.1}l8 8l-8 8l-8 -8z\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.4\"/>",
            y - 8.0,
            palette::human(human.number())
        ));
        labels.block(Area { x: x - 8.0, y: y - 8.0, w: 16.0, h: 16.0 });
        let which = if again.contains(human) { format!("{}: ", ordinal(*nth)) } else { String::new() };
        let words = format!("{which}{:.1} s", event.time.secs());
        draw_label(svg, labels, (x, y), &words, (palette::INK, 15.0), 11.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_reason_goes_on_in_lines_and_the_map_moves_down() {
        let run = crate::fixture::walk(1);
        let short = Told::of(&crate::fixture::report(&run, "9 of 9 setup clauses"), 900.0);
        assert_eq!((short.reason.len(), short.robot_y(0)), (1, 90.0));
        let why = "9 of 10 setup clauses · encounter gap 0.0 s · c6: trigger at 6.6 s (when the robot says EXCUSE_ME), \
                   but human_1 never gives way to the robot";
        let long = Told::of(&crate::fixture::report(&run, why), 700.0);
        assert!(long.reason.len() > 1 && long.bottom() > short.bottom(), "{:?}", long.reason);
        assert_eq!(long.reason.join(" "), why, "nothing of the cause is cut");
    }
}
