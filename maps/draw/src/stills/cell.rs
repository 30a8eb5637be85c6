//! One picture of a sheet, and the words under it.

use socrates_model::{AgentId, AgentState, Location, PlaceClass};

use super::plan::Cell;
use super::{STANDS_MPS, Scene, Signs, color, draw_body};
use crate::actor::{self, Look, RING};
use crate::camera::seen;
use crate::label::{Area, Labels, text_width, wrapped};
use crate::map_layer::{Frame, draw_floor, draw_scale, wall_areas};
use crate::marks::draw_arrow;
use crate::palette;
use crate::svg::Svg;

/// Least radius of a body, px: its number must be read.
const LEAST_PX: f64 = 9.5;
/// Height of letters of times, of the words below them, of gestures and of places, px.
const TIME_PX: f64 = 18.0;
const WORDS_PX: f64 = 15.0;
const SAID_PX: f64 = 15.0;
const PLACE_PX: f64 = 13.0;
/// Lines of words about what happened since the picture before.
const LINES: usize = 2;
/// With more people their numbers are not listed.
const LISTED: usize = 16;

/// Draws the picture of this number: 0 shows the ways of the whole run, the others the moments in order.
pub(super) fn draw(svg: &mut Svg, scene: &Scene<'_>, times: &[f64], index: usize, cell: &Cell) {
    let Area { x, y, w, h } = cell.area;
    let whole = scene.frame(&cell.center, cell.px_per_m, cell);
    let part = seen(&whole, &cell.area);
    svg.raw(&format!("<clipPath id=\"still-{index}\">"));
    svg.rect((x, y), (w, h), "");
    svg.raw(&format!("</clipPath><g clip-path=\"url(#still-{index})\">"));
    svg.rect((x, y), (w, h), &format!("fill=\"{}\"", palette::UNKNOWN));
    draw_floor(svg, scene.location, &part);
    let before_s = index.checked_sub(2).and_then(|before| times.get(before)).copied().unwrap_or(0.0);
    let now_s = index.checked_sub(1).and_then(|now| times.get(now)).copied();
    actor::draw_doors(svg, scene.location, &whole, scene.recording, now_s.unwrap_or(0.0));
    draw_places(svg, scene.location, &whole, &part, &cell.area, bodies(scene, now_s, cell, &whole));
    match now_s {
        Some(now_s) => draw_moment(svg, scene, (before_s, now_s), cell, &whole, &part),
        None => draw_ways(svg, scene, times, cell, &whole),
    }
    svg.raw("</g>");
    svg.rect((x, y), (w, h), &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"1\"", palette::QUIET));
    let (head, lines) = match now_s {
        Some(now_s) => told(scene, (before_s, now_s, index == 1), cell, &whole),
        None => told_of_all(scene, times),
    };
    let head = match (scene.signs, now_s) {
        (Signs::Numbers, _) => head,
        (Signs::Letters, None) => format!("picture {index}: {head}"),
        (Signs::Letters, Some(_)) => format!("picture {index} · {head}"),
    };
    svg.heading((x + 2.0, y + h + 20.0), &head, TIME_PX, palette::INK);
    let mut top = y + h + 20.0;
    let style = format!("font-size=\"{WORDS_PX}\" fill=\"{}\"", palette::INK);
    for (line, lines) in lines.iter().zip([1, LINES]) {
        for piece in wrapped(line, w - 4.0, WORDS_PX, lines) {
            top += WORDS_PX * 1.15;
            svg.text((x + 2.0, top), &piece, &style);
        }
    }
}

/// Where bodies stand at a moment, or at the beginning and the end of the run.
fn bodies(scene: &Scene<'_>, now_s: Option<f64>, cell: &Cell, whole: &Frame) -> Vec<Area> {
    let times = now_s.map_or_else(|| vec![0.0, scene.end_s()], |now_s| vec![now_s]);
    let states = times.into_iter().flat_map(|time| scene.states(time));
    states
        .map(|state| {
            let ((x, y), r) = (whole.px(scene.location, &state.point()), radius_px(scene, cell, state.agent_id()));
            Area { x: x - r, y: y - r, w: 2.0 * r, h: 2.0 * r }
        })
        .collect()
}

/// The names of places, once for neighbors of one name, where they hide nothing.
fn draw_places(svg: &mut Svg, location: &Location, whole: &Frame, part: &Frame, area: &Area, bodies: Vec<Area>) {
    const TOLD: [PlaceClass; 6] = [
        PlaceClass::Room,
        PlaceClass::Elevator,
        PlaceClass::ElevatorLobby,
        PlaceClass::OpenArea,
        PlaceClass::Exit,
        PlaceClass::Doorway,
    ];
    let mut labels = Labels::within(*area);
    labels.avoid(wall_areas(location, part));
    labels.avoid(bodies);
    let mut named: Vec<(&str, (f64, f64))> = Vec::new();
    for node in location.graph.nodes() {
        let at = whole.px(location, &node.at);
        let inside = at.0 > area.x && at.0 < area.x + area.w && at.1 > area.y && at.1 < area.y + area.h;
        let known = named.iter().any(|(kind, (x, y))| *kind == node.kind && (at.0 - x).hypot(at.1 - y) < 120.0);
        if !inside || known || !TOLD.contains(&PlaceClass::of_type(&node.kind)) {
            continue;
        }
        let words = node.kind.to_lowercase();
        let size = (text_width(&words, PLACE_PX), PLACE_PX + 2.0);
        let spot = labels.place_within((at.0, at.1), size, 2.0, 2);
        labels.block(spot);
        svg.text(
            (spot.x, spot.y + PLACE_PX),
            &words,
            &format!(
                "font-size=\"{PLACE_PX}\" font-style=\"italic\" fill=\"{}\" fill-opacity=\"0.85\"",
                palette::QUIET
            ),
        );
        named.push((&node.kind, at));
    }
}

/// Radius of somebody in a picture, px.
fn radius_px(scene: &Scene<'_>, cell: &Cell, agent: AgentId) -> f64 {
    (scene.radius_m(agent) * cell.px_per_m).clamp(LEAST_PX, 2.0 * LEAST_PX)
}

/// A way as a line, with a dot each second that counts from its end.
fn draw_way(svg: &mut Svg, scene: &Scene<'_>, agent: AgentId, (from_s, to_s): (f64, f64), whole: &Frame, dots: &[f64]) {
    let color = color(agent);
    for piece in scene.way(agent, from_s, to_s, 0.2) {
        let line: Vec<(f64, f64)> = piece.iter().map(|point| whole.px(scene.location, point)).collect();
        svg.polyline(
            &line,
            &format!("stroke=\"{color}\" stroke-width=\"2.6\" stroke-opacity=\"0.55\" stroke-linejoin=\"round\""),
        );
    }
    for dot in dots {
        if let Some(state) = scene.states(*dot).find(|state| state.agent_id() == agent) {
            svg.circle(whole.px(scene.location, &state.point()), 2.6, &format!("fill=\"{color}\""));
        }
    }
}

/// The ways of the whole run: a white body where somebody starts, the dark one where they end, a dot at each still.
fn draw_ways(svg: &mut Svg, scene: &Scene<'_>, times: &[f64], cell: &Cell, whole: &Frame) {
    let end_s = scene.end_s();
    let agents = || scene.recording.header.agents.iter().rev().map(|info| info.agent);
    for agent in agents() {
        draw_way(svg, scene, agent, (0.0, end_s), whole, times);
    }
    for agent in agents() {
        let r = radius_px(scene, cell, agent);
        let track: Vec<&AgentState> = scene.recording.track(agent).filter(|state| scene.there.is(state)).collect();
        let (Some(first), Some(last)) = (track.first(), track.last()) else { continue };
        let at = whole.px(scene.location, &first.point());
        crate::marks::draw_start(svg, at, agent.number() == 0, r * 0.8, color(agent), 2.0);
        svg.label((at.0, at.1 + r * 0.45), &scene.sign(agent), r * 1.25, color(agent));
        draw_body(svg, whole.px(scene.location, &last.point()), last.yaw, agent, &scene.sign(agent), r);
    }
}

/// Everybody at a moment, with their ways since the one before.
fn draw_moment(
    svg: &mut Svg,
    scene: &Scene<'_>,
    (before_s, now_s): (f64, f64),
    cell: &Cell,
    whole: &Frame,
    part: &Frame,
) {
    let seconds: Vec<f64> = Scene::looks(0.0, now_s - before_s, 1.0).map(|gone| now_s - gone).collect();
    let states: Vec<AgentState> = scene.states(now_s).copied().collect();
    let place = |state: &AgentState| whole.px(scene.location, &state.point());
    for state in states.iter().rev() {
        draw_way(svg, scene, state.agent_id(), (before_s, now_s), whole, &seconds);
    }
    let mut taken: Vec<(Area, f64)> = wall_areas(scene.location, part).into_iter().map(|wall| (wall, 0.4)).collect();
    for state in states.iter().rev() {
        let (at, r) = (place(state), radius_px(scene, cell, state.agent_id()));
        draw_pace(svg, scene, state, now_s, at, r, cell.px_per_m);
        if state.gesture().is_some() {
            svg.circle(at, r * RING, "fill=\"none\" stroke=\"#e69f00\" stroke-width=\"3\"");
        }
        draw_body(svg, at, state.yaw, state.agent_id(), &scene.sign(state.agent_id()), r);
        taken.push((Area { x: at.0 - r, y: at.1 - r, w: 2.0 * r, h: 2.0 * r }, 1.0));
    }
    let look = Look::new(scene.recording, (cell.px_per_m, LEAST_PX), SAID_PX, false, cell.area);
    for state in &states {
        actor::draw_words(svg, place(state), state, radius_px(scene, cell, state.agent_id()), &look, &mut taken);
    }
    draw_scale(
        svg,
        scene.location,
        &Frame { at: (cell.area.x + 10.0, cell.area.y), cells: (0, 0, 0, 0), ..*whole },
        cell.area.h - 12.0,
    );
}

/// The arrow of somebody who walks: as long as they come in the next second, from the tip of their body.
fn draw_pace(svg: &mut Svg, scene: &Scene<'_>, state: &AgentState, now_s: f64, at: (f64, f64), r: f64, px_per_m: f64) {
    let (x, y) = scene.pace(state.agent_id(), now_s);
    let speed = x.hypot(y);
    if speed < STANDS_MPS {
        return;
    }
    // Pictures have y downward.
    let (x, y) = (x / speed, -y / speed);
    let (near, far) = (r, r * 1.75 + (speed * px_per_m).max(8.0));
    let (from, to) = ((at.0 + x * near, at.1 + y * near), (at.0 + x * far, at.1 + y * far));
    let color = color(state.agent_id());
    svg.line(from, to, "stroke=\"#ffffff\" stroke-width=\"5.5\"");
    svg.line(from, to, &format!("stroke=\"{color}\" stroke-width=\"3\""));
    draw_arrow(svg, to, y.atan2(x).to_degrees(), color);
}

/// Numbers of people after a word; nothing where there are none.
fn listed(scene: &Scene<'_>, word: &str, who: &[AgentId]) -> Option<String> {
    let names = || who.iter().map(|agent| scene.sign(*agent)).collect::<Vec<_>>().join(" ");
    match who.len() {
        0 => None,
        1..=LISTED => Some(format!("{word}: {}", names())),
        many => Some(format!("{word}: {many} people")),
    }
}

/// The time of a still, who walks, who stands, who is not in the picture, and what happened since the one before.
fn told(
    scene: &Scene<'_>,
    (before_s, now_s, first): (f64, f64, bool),
    cell: &Cell,
    whole: &Frame,
) -> (String, [String; 2]) {
    let (mut walk, mut stand, mut out) = (Vec::new(), Vec::new(), Vec::new());
    for state in scene.states(now_s) {
        let agent = state.agent_id();
        let (x, y) = whole.px(scene.location, &state.point());
        let area = cell.area;
        let shown = x > area.x && x < area.x + area.w && y > area.y && y < area.y + area.h;
        let (dx, dy) = scene.pace(agent, now_s);
        let list = if !shown {
            &mut out
        } else if dx.hypot(dy) < STANDS_MPS {
            &mut stand
        } else {
            &mut walk
        };
        list.push(agent);
    }
    let who: Vec<String> = [("walk", &walk), ("stand", &stand), ("not in the picture", &out)]
        .into_iter()
        .filter_map(|(word, who)| listed(scene, word, who))
        .collect();
    let after_s = if first { -1.0 } else { before_s };
    (format!("{now_s:.1} s"), [who.join(" · "), scene.happened(after_s, now_s).join(", ")])
}

/// What stands under the picture of all ways.
fn told_of_all(scene: &Scene<'_>, times: &[f64]) -> (String, [String; 2]) {
    let after = scene.happened(times.last().copied().unwrap_or(0.0), f64::INFINITY);
    let after = if after.is_empty() { String::new() } else { format!("after the last picture: {}", after.join(", ")) };
    let head = format!("all ways, 0 to {:.1} s", scene.end_s());
    (head, ["white: start; dark: end; dots: at the times of the pictures".to_owned(), after])
}
