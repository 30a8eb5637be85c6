//! The picture of one run: where everybody went, and when.

use socrates_model::{AgentId, EventKind, Location, Paths, Recording, Report};

use crate::label::{Area, Labels, text_width};
use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_scale};
use crate::palette;
use crate::svg::Svg;

/// Seconds between two time marks on a track.
const MARK_SECS: f64 = 5.0;

/// Draws the map, every track with marks every 5 s, starts, ends and encounters, and a legend.
#[must_use]
pub fn run_picture(
    location: &Location,
    recording: &Recording,
    paths: Option<&Paths>,
    report: Option<&Report>,
    title: &str,
) -> String {
    let frame = Frame::around(location, 1160.0, 820.0, (20.0, 70.0));
    let (w, h) = frame.size();
    let width = (w + 40.0).max(700.0);
    #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
    let rows = recording.header.agents.len().div_ceil(4) as f64;
    let height = h + 70.0 + 48.0 + rows * 22.0 + 10.0;
    let mut svg = Svg::new(width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    svg.text(
        (20.0, 30.0),
        &shortened(title, width - 40.0, 19.0),
        &format!("font-size=\"19\" font-weight=\"600\" fill=\"{}\"", palette::INK),
    );
    if let Some(report) = report {
        let line = format!("{} · {}", report.verdict, report.verdict_text);
        let color = if report.verdict == socrates_model::Verdict::Realised { palette::GOOD } else { palette::BAD };
        svg.text((20.0, 54.0), &shortened(&line, width - 40.0, 14.0), &format!("font-size=\"14\" fill=\"{color}\""));
    }
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
    if let Some(paths) = paths {
        let line: Vec<(f64, f64)> =
            location.graph.polyline(&paths.robot).iter().map(|p| frame.px(location, p)).collect();
        svg.polyline(
            &line,
            &format!("stroke=\"{}\" stroke-width=\"1.4\" stroke-dasharray=\"3 5\" opacity=\"0.6\"", palette::ROBOT),
        );
    }
    draw_doors(&mut svg, location, &frame);
    let mut labels = Labels::within(Area { x: 4.0, y: 60.0, w: width - 8.0, h: h + 20.0 });
    // The robot is drawn last, so that its track lies on top.
    let mut agents: Vec<AgentId> = recording.header.agents.iter().map(|info| info.agent).collect();
    agents.reverse();
    for agent in &agents {
        draw_track(&mut svg, location, recording, &frame, *agent);
    }
    for agent in &agents {
        draw_ends(&mut svg, location, recording, &frame, *agent, &mut labels);
    }
    draw_encounters(&mut svg, location, recording, &frame, &mut labels);
    draw_scale(&mut svg, location, &frame, 18.0);
    svg.text(
        (frame.at.0 + w, frame.at.1 + h + 22.0),
        &format!("a mark every {MARK_SECS:.0} s · ring: start · disc: end · diamond: encounter"),
        &format!("font-size=\"12\" text-anchor=\"end\" fill=\"{}\"", palette::QUIET),
    );
    for (index, info) in recording.header.agents.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
        let (x, y) = (26.0 + (index % 4) as f64 * (width - 40.0) / 4.0, h + 70.0 + 48.0 + (index / 4) as f64 * 22.0);
        svg.circle((x, y - 4.5), 6.0, &format!("fill=\"{}\"", palette::agent(info.agent.number())));
        let text = if info.agent == AgentId::Robot {
            format!("robot ({})", recording.header.planner)
        } else {
            format!("{} ({})", info.agent, info.role)
        };
        svg.text((x + 13.0, y), &text, &format!("font-size=\"14\" fill=\"{}\"", palette::INK));
    }
    svg.finish()
}

fn shortened(text: &str, width: f64, size: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut out = String::new();
    for c in text.chars() {
        if text_width(&out, size) > width - size * 1.5 {
            break;
        }
        out.push(c);
    }
    out.push('…');
    out
}

fn draw_track(svg: &mut Svg, location: &Location, recording: &Recording, frame: &Frame, agent: AgentId) {
    let color = palette::agent(agent.number());
    let mut line: Vec<(f64, f64)> = Vec::new();
    let mut marks: Vec<(f64, f64)> = Vec::new();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive constant")]
    let mark_ticks = (MARK_SECS / recording.header.step_s.max(1e-3)).round() as usize;
    for (tick, state) in recording.track(agent).enumerate() {
        let at = frame.px(location, &state.point());
        let moved = line.last().is_none_or(|last: &(f64, f64)| (last.0 - at.0).hypot(last.1 - at.1) > 1.0);
        if moved {
            line.push(at);
        }
        if tick > 0 && tick % mark_ticks.max(1) == 0 {
            marks.push(at);
        }
    }
    svg.polyline(&line, "stroke=\"#ffffff\" stroke-width=\"6\" stroke-linejoin=\"round\" opacity=\"0.8\"");
    svg.polyline(
        &line,
        &format!("stroke=\"{color}\" stroke-width=\"3.2\" stroke-linejoin=\"round\" stroke-linecap=\"round\""),
    );
    for at in marks {
        svg.circle(at, 2.6, &format!("fill=\"#ffffff\" stroke=\"{color}\" stroke-width=\"1.6\""));
    }
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
    let radius_m = recording.header.agents.iter().find(|info| info.agent == agent).map_or(0.28, |info| info.radius_m);
    let radius = frame.len(location, radius_m).max(5.0);
    let mut track = recording.track(agent);
    let Some(first) = track.next() else { return };
    let last = track.last().unwrap_or(first);
    let (start, end) = (frame.px(location, &first.point()), frame.px(location, &last.point()));
    svg.circle(start, radius, &format!("fill=\"#ffffff\" stroke=\"{color}\" stroke-width=\"2.6\""));
    svg.circle(end, radius, &format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1.5\""));
    let nose = (end.0 + radius * last.yaw.cos(), end.1 - radius * last.yaw.sin());
    svg.line(end, nose, "stroke=\"#ffffff\" stroke-width=\"2\"");
    labels.block(Area { x: start.0 - radius, y: start.1 - radius, w: radius * 2.0, h: radius * 2.0 });
    labels.block(Area { x: end.0 - radius, y: end.1 - radius, w: radius * 2.0, h: radius * 2.0 });
    label(svg, labels, start, &agent.to_string(), color, radius + 3.0);
}

fn draw_encounters(svg: &mut Svg, location: &Location, recording: &Recording, frame: &Frame, labels: &mut Labels) {
    for event in &recording.events {
        let EventKind::Encounter { human, .. } = &event.kind else { continue };
        let tick = usize::try_from(event.time.tick()).unwrap_or(usize::MAX);
        let Some(robot) = recording.tick(tick).iter().find(|state| state.agent == 0) else { continue };
        let (x, y) = frame.px(location, &robot.point());
        svg.raw(&format!(
            "<path d=\"M{x:.1} {:.1}l8 8l-8 8l-8 -8z\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.4\"/>",
            y - 8.0,
            palette::human(human.number())
        ));
        labels.block(Area { x: x - 8.0, y: y - 8.0, w: 16.0, h: 16.0 });
        label(svg, labels, (x, y), &format!("{:.1} s", event.time.secs()), palette::INK, 11.0);
    }
}

fn label(svg: &mut Svg, labels: &mut Labels, at: (f64, f64), text: &str, color: &str, gap: f64) {
    let area = labels.place(at, (text_width(text, 13.0) + 6.0, 17.0), gap);
    svg.rect((area.x, area.y), (area.w, area.h), "rx=\"3\" fill=\"#ffffff\" fill-opacity=\"0.88\"");
    svg.text(
        (area.x + area.w / 2.0, area.y + 13.0),
        text,
        &format!("font-size=\"13\" font-weight=\"600\" text-anchor=\"middle\" fill=\"{color}\""),
    );
}
