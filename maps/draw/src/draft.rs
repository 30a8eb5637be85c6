//! The picture of a draft: who is to go where, before anything was simulated.

use socrates_model::{AgentId, Location, NodeId, Paths, Point};

use crate::label::{Area, Labels, wrapped};
use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_locator, draw_scale, wall_areas};
use crate::marks::{draw_arrow, draw_body, draw_label, draw_legend, draw_line, draw_start, legend_px};
use crate::palette;
use crate::svg::Svg;

/// Distance between the lines of two agents on the same way, px.
const APART_PX: f64 = 4.5;
/// Distance between two arrows on a line, px.
const ARROWS_PX: f64 = 90.0;
/// Height of the heading, px.
const HEAD_PX: f64 = 60.0;

/// Draws the ways of everybody with arrows, starts, ends, encounters and the ids of their nodes.
///
/// `roles` names the humans beside their ids in the legend. Lines on the same way are drawn beside each other.
#[must_use]
pub fn draft_picture(location: &Location, paths: &Paths, roles: &[(AgentId, String)], title: &str) -> String {
    let agents: Vec<AgentId> =
        std::iter::once(AgentId::Robot).chain(paths.humans.keys().copied().map(AgentId::Human)).collect();
    let way = |agent: AgentId| paths.of(agent).map(|nodes| location.graph.polyline(nodes)).unwrap_or_default();
    let all: Vec<Point> = agents.iter().flat_map(|agent| way(*agent)).collect();
    let mut frame = Frame::focused(location, &all, 1160.0, 800.0, (20.0, HEAD_PX));
    let focused = frame.cells != Frame::around(location, 1160.0, 800.0, (20.0, HEAD_PX)).cells;
    let (w, h) = frame.size();
    let width = (w + 40.0).max(760.0);
    let head = if focused { 118.0 } else { HEAD_PX };
    frame.at.1 = head;
    let height = head + h + 40.0 + legend_px(agents.len()) + 14.0;
    let mut svg = Svg::new(width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    let words = if focused {
        draw_locator(&mut svg, location, &frame, width - 20.0, 10.0, (190.0, 96.0));
        width - 250.0
    } else {
        width - 40.0
    };
    svg.heading((20.0, 34.0), &wrapped(title, words, 24.0, 1).concat(), 24.0, palette::INK);
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
    draw_doors(&mut svg, location, &frame);
    let mut labels = Labels::within(Area { x: frame.at.0, y: frame.at.1, w, h });
    labels.avoid(wall_areas(location, &frame));
    let lines: Vec<(AgentId, Vec<(f64, f64)>)> = agents
        .iter()
        .enumerate()
        .map(|(index, agent)| {
            let aside = aside_px(index);
            let line =
                way(*agent).into_iter().map(|point| frame.px(location, &point)).map(|(x, y)| (x + aside, y - aside));
            (*agent, line.collect())
        })
        .collect();
    // The robot is drawn last, so that its line lies on top.
    for (agent, line) in lines.iter().rev() {
        draw_way(&mut svg, line, palette::agent(agent.number()));
        labels.avoid_line(line);
    }
    for (agent, line) in lines.iter().rev() {
        draw_ends(&mut svg, line, *agent, &mut labels);
    }
    draw_encounters(&mut svg, location, &frame, paths, &mut labels);
    for (agent, line) in &lines {
        if let Some(start) = line.first() {
            let ink = (palette::agent_words(agent.number()), 15.0);
            draw_label(&mut svg, &mut labels, *start, &agent.to_string(), ink, 11.0);
        }
    }
    for node in nodes_of(paths) {
        let Some(at) = location.graph.node(node).map(|node| frame.px(location, &node.at)) else { continue };
        svg.circle(at, 2.2, &format!("fill=\"{}\"", palette::QUIET));
        draw_label(&mut svg, &mut labels, at, node.as_str(), (palette::QUIET, 12.0), 5.0);
    }
    svg.rect(frame.at, (w, h), &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"1\"", palette::GRAPH));
    draw_scale(&mut svg, location, &frame, 18.0);
    svg.text(
        (width - 20.0, frame.at.1 + h + 22.0),
        "outline: start · filled: end · diamond: encounter · small words: nodes",
        &format!("font-size=\"13\" text-anchor=\"end\" fill=\"{}\"", palette::QUIET),
    );
    let role = |agent: &AgentId| roles.iter().find(|(of, _)| of == agent).map(|(_, role)| format!(" ({role})"));
    let legend: Vec<(u32, String)> =
        agents.iter().map(|agent| (agent.number(), format!("{agent}{}", role(agent).unwrap_or_default()))).collect();
    draw_legend(&mut svg, &legend, width, head + h + 54.0);
    svg.finish()
}

/// How far the line of the agent at this place is moved, px: 0, 1, -1, 2, -2 … distances.
fn aside_px(index: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "few agents")]
    let steps = index.div_ceil(2) as f64;
    if index % 2 == 1 { steps * APART_PX } else { -steps * APART_PX }
}

/// Nodes of all ways, once each, in order of the agents.
fn nodes_of(paths: &Paths) -> Vec<&NodeId> {
    let mut nodes: Vec<&NodeId> = Vec::new();
    for node in paths.robot.iter().chain(paths.humans.values().flatten()) {
        if !nodes.contains(&node) {
            nodes.push(node);
        }
    }
    nodes
}

fn draw_way(svg: &mut Svg, line: &[(f64, f64)], color: &str) {
    draw_line(svg, line, color);
    let mut until = ARROWS_PX / 2.0;
    for pair in line.windows(2) {
        let [from, to] = pair else { continue };
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        if length < 1e-6 {
            continue;
        }
        let mut at = until;
        while at < length {
            let place = (from.0 + dx * at / length, from.1 + dy * at / length);
            draw_arrow(svg, place, dy.atan2(dx).to_degrees(), color);
            at += ARROWS_PX;
        }
        until = at - length;
    }
}

fn draw_ends(svg: &mut Svg, line: &[(f64, f64)], agent: AgentId, labels: &mut Labels) {
    const RADIUS: f64 = 8.0;
    let (Some(start), Some(end)) = (line.first(), line.last()) else { return };
    let (robot, color) = (agent == AgentId::Robot, palette::agent(agent.number()));
    let before = line.iter().rev().find(|point| *point != end).unwrap_or(end);
    draw_body(svg, *end, (before.1 - end.1).atan2(end.0 - before.0), robot, RADIUS, color);
    if line.len() > 1 {
        draw_start(svg, *start, robot, RADIUS, color, 3.0);
    }
    for (x, y) in [start, end] {
        labels.block(Area { x: x - RADIUS, y: y - RADIUS, w: RADIUS * 2.0, h: RADIUS * 2.0 });
    }
}

fn draw_encounters(svg: &mut Svg, location: &Location, frame: &Frame, paths: &Paths, labels: &mut Labels) {
    for encounter in &paths.encounters {
        let Some(node) = location.graph.node(&encounter.node) else { continue };
        let (x, y) = frame.px(location, &node.at);
        svg.raw(&format!(
            "<path d=\"M{x:.1} {:.1}l9 9l-9 9l-9 -9z\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.6\"/>",
            y - 9.0,
            palette::human(encounter.human.number())
        ));
        labels.block(Area { x: x - 9.0, y: y - 9.0, w: 18.0, h: 18.0 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_on_the_same_way_lie_beside_each_other() {
        let places: Vec<f64> = (0..5).map(aside_px).collect();
        assert_eq!(places, [0.0, APART_PX, -APART_PX, 2.0 * APART_PX, -2.0 * APART_PX]);
    }

    #[test]
    fn an_arrow_stands_on_every_long_line_and_words_are_no_markup() {
        let mut svg = Svg::part();
        draw_way(&mut svg, &[(0.0, 0.0), (100.0, 0.0), (100.0, 0.0), (100.0, 100.0)], "#000000");
        let text = svg.text_so_far();
        assert_eq!(text.matches("<path").count(), 2, "{text}");
        let mut labels = Labels::within(Area { x: 0.0, y: 0.0, w: 100.0, h: 100.0 });
        let mut svg = Svg::part();
        draw_label(&mut svg, &mut labels, (10.0, 10.0), crate::fixture::EVIL, ("#000000", 12.0), 5.0);
        assert!(!svg.text_so_far().contains("<script"));
    }
}
