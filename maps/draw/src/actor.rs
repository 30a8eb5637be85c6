//! Robot, people, their trails, gestures and doors at one moment, seen from above.

use socrates_model::{AgentState, Door, EventKind, Location, Recording};

use crate::label::{Area, text_width};
use crate::map_layer::Frame;
use crate::marks::draw_body;
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Above this many agents names would hide the crowd.
const CROWD: usize = 24;
/// Length of a trail, s; it fades.
const TRAIL_SECS: f64 = 4.0;
/// Radius of the ring around whoever says something, in their own.
pub(crate) const RING: f64 = 1.5;
/// Cost of a wall behind words, where a body or other words cost 1.
const WALL_COST: f64 = 0.4;
/// Pieces of a fading trail.
const PIECES: u8 = 6;

/// How agents look in one film or picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    /// Height of letters, px.
    pub(crate) text_px: f64,
    /// Whether names are written.
    names: bool,
    /// Whether it is shown where everybody came from.
    trails: bool,
    /// Whether humans are too many for names and long trails.
    crowd: bool,
    /// Pixels per meter.
    px_per_m: f64,
    /// Least radius of an agent, px.
    least_px: f64,
    /// Part of the picture in which words stay.
    bounds: Area,
}

/// Height of letters in a picture of this height, px.
pub(crate) fn text_px(height_px: f64) -> f64 {
    (height_px / 36.0).clamp(11.0, 26.0)
}

impl Look {
    /// The look of a recording at this scale, with nobody of a smaller radius than this, and letters of this height, px.
    pub(crate) fn new(
        recording: &Recording,
        (px_per_m, least_px): (f64, f64),
        text_px: f64,
        names: bool,
        bounds: Area,
    ) -> Self {
        let crowd = recording.header.agents.len() > CROWD;
        Self { text_px, names, trails: true, crowd, px_per_m, least_px, bounds }
    }

    /// The same without trails.
    pub(crate) const fn without_trails(self) -> Self {
        Self { trails: false, ..self }
    }

    /// Whether an agent's name is written.
    pub(crate) const fn named(&self, number: u32) -> bool {
        self.names && (!self.crowd || number == 0)
    }

    /// Radius of an agent in the picture, px.
    pub(crate) fn radius_px(&self, radius_m: f64) -> f64 {
        (radius_m * self.px_per_m).max(self.least_px)
    }
}

/// The states of the tick at a moment; after the end those of the last one.
pub(crate) fn moment(recording: &Recording, now_s: f64) -> &[AgentState] {
    let at = (now_s / recording.header.step_s.max(1e-4)).max(0.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a tick of the recording, clipped")]
    let tick = (at.floor() as usize).min(recording.ticks().saturating_sub(1));
    recording.tick(tick)
}

/// Whether a door stands open at a moment.
pub(crate) fn is_open(door: &Door, recording: &Recording, now_s: f64) -> bool {
    let mut told = recording.events.iter().filter(|event| event.time.secs() <= now_s + 1e-9).filter_map(|event| {
        let EventKind::Door { door: id, open } = &event.kind else { return None };
        (*id == door.id).then_some(*open)
    });
    told.next_back().unwrap_or(false)
}

/// Draws the doors as they stand at a moment: a closed door is a bar, an open one two stubs.
pub(crate) fn draw_doors(svg: &mut Svg, location: &Location, frame: &Frame, recording: &Recording, now_s: f64) {
    for door in &location.doors {
        let open = is_open(door, recording, now_s);
        let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
        let part = if open { 0.14 } else { 0.5 };
        let (dx, dy) = ((to.0 - from.0) * part, (to.1 - from.1) * part);
        let style =
            format!("stroke=\"{}\" stroke-width=\"{:.1}\"", palette::DOOR, (frame.len(location, 0.14)).max(3.0));
        svg.line(from, (from.0 + dx, from.1 + dy), &style);
        svg.line(to, (to.0 - dx, to.1 - dy), &style);
    }
}

/// Draws trails, then everybody with the robot on top, then names and what is said, off the walls where there is room.
pub(crate) fn draw_everybody(
    svg: &mut Svg,
    location: &Location,
    frame: &Frame,
    recording: &Recording,
    now_s: f64,
    look: &Look,
    walls: &[Area],
) {
    let there = There::of(recording);
    let states: Vec<AgentState> = moment(recording, now_s).iter().filter(|state| there.is(state)).copied().collect();
    let radius = |state: &AgentState| {
        let info = recording.header.agents.iter().find(|info| info.agent == state.agent_id());
        look.radius_px(info.map_or(0.28, |info| info.radius_m))
    };
    for state in states.iter().rev().filter(|_| look.trails) {
        draw_trail(svg, location, frame, recording, state, now_s, look);
    }
    for state in states.iter().rev() {
        let at = frame.px(location, &state.point());
        draw_agent(svg, at, state, radius(state));
    }
    let mut taken: Vec<(Area, f64)> = walls.iter().map(|wall| (*wall, WALL_COST)).collect();
    taken.extend(states.iter().map(|state| {
        let ((x, y), r) = (frame.px(location, &state.point()), radius(state));
        (Area { x: x - r, y: y - r, w: 2.0 * r, h: 2.0 * r }, 1.0)
    }));
    for state in &states {
        let at = frame.px(location, &state.point());
        draw_words(svg, at, state, radius(state), look, &mut taken);
    }
}

fn draw_trail(
    svg: &mut Svg,
    location: &Location,
    frame: &Frame,
    recording: &Recording,
    state: &AgentState,
    now_s: f64,
    look: &Look,
) {
    let (secs, pieces) = if look.crowd && state.agent != 0 { (TRAIL_SECS / 2.0, 2) } else { (TRAIL_SECS, PIECES) };
    let width = (look.least_px * 0.3).max(2.0);
    let there = There::of(recording);
    let place = recording.header.agents.iter().position(|info| info.agent == state.agent_id()).unwrap_or(usize::MAX);
    for piece in 0..pieces {
        let part = |index: u8| now_s - secs * (1.0 - f64::from(index) / f64::from(pieces));
        let (from, to) = (part(piece), part(piece + 1));
        if to <= 0.0 {
            continue;
        }
        // A point every fifth of a second is a smooth line at walking speed.
        let mut line = Vec::new();
        let mut t = from.max(0.0);
        loop {
            let now = moment(recording, t).get(place);
            line.extend(now.filter(|state| there.is(state)).map(|s| frame.px(location, &s.point())));
            if t >= to {
                break;
            }
            t = (t + 0.2).min(to);
        }
        let opacity = 0.6 * f64::from(piece + 1) / f64::from(pieces);
        svg.polyline(
            &line,
            &format!(
                "stroke=\"{}\" stroke-width=\"{width:.1}\" stroke-opacity=\"{opacity:.2}\" stroke-linejoin=\"round\"",
                palette::agent(state.agent)
            ),
        );
    }
}

/// The body, with a ring around whoever says something.
fn draw_agent(svg: &mut Svg, at: (f64, f64), state: &AgentState, r: f64) {
    if state.gesture().is_some() {
        svg.circle(at, r * RING, "fill=\"none\" stroke=\"#e69f00\" stroke-width=\"3\"");
    }
    draw_body(svg, at, state.yaw, state.agent == 0, r, palette::agent(state.agent));
}

/// Name and what is said, at the first place around the agent that is free.
pub(crate) fn draw_words(
    svg: &mut Svg,
    at: (f64, f64),
    state: &AgentState,
    r: f64,
    look: &Look,
    taken: &mut Vec<(Area, f64)>,
) {
    let size = look.text_px * 0.95;
    let name =
        if look.named(state.agent) { state.agent_id().to_string().replace("human_", "h") } else { String::new() };
    let gesture = state.gesture();
    let said = gesture.map(|gesture| gesture.name().replace('_', " ")).unwrap_or_default();
    // Whoever is out of the picture has no words in it.
    let Area { x: left, y: top, w: wide, h: high } = look.bounds;
    let seen = at.0 + r > left && at.0 - r < left + wide && at.1 + r > top && at.1 - r < top + high;
    if name.is_empty() && said.is_empty() || !seen {
        return;
    }
    let bubble = if said.is_empty() { 0.0 } else { size * 1.6 };
    let letters = if name.is_empty() { 0.0 } else { size * 1.1 };
    let w = text_width(&name, size).max(if said.is_empty() { 0.0 } else { text_width(&said, size) + size * 0.9 });
    let h = bubble + letters;
    let reach = r * if said.is_empty() { 1.0 } else { RING } + 3.0;
    let places = [
        (at.0 - w / 2.0, at.1 - reach - h),
        (at.0 - w / 2.0, at.1 + reach),
        (at.0 + reach, at.1 - h / 2.0),
        (at.0 - reach - w, at.1 - h / 2.0),
    ];
    // Words that would be cut at an edge are moved into the picture.
    let inside = |(x, y): (f64, f64)| (x.min(left + wide - w).max(left), y.min(top + high - h).max(top));
    let covered = |(x, y): &(f64, f64)| -> f64 {
        let area = Area { x: *x, y: *y, w, h };
        taken.iter().map(|(other, cost)| area.overlap(other) * cost).sum()
    };
    let mut best = (f64::MAX, (at.0, at.1));
    for place in places.map(inside) {
        let hidden = covered(&place);
        if hidden < best.0 - 1e-9 {
            best = (hidden, place);
        }
    }
    let (x, y) = best.1;
    taken.push((Area { x, y, w, h }, 1.0));
    let middle = x + w / 2.0;
    if !said.is_empty() {
        let wide = text_width(&said, size) + size * 0.9;
        svg.rect(
            (middle - wide / 2.0, y),
            (wide, size * 1.4),
            &format!("rx=\"{:.1}\" fill=\"#fff4d6\" stroke=\"#b07a00\" stroke-width=\"1.5\"", size * 0.3),
        );
        let ink = palette::INK;
        svg.text(
            (middle, y + size * 1.05),
            &said,
            &format!(
                "font-size=\"{size:.1}\" text-anchor=\"middle\" fill=\"{ink}\" stroke=\"{ink}\" stroke-width=\"0.7\""
            ),
        );
    }
    if !name.is_empty() {
        svg.label((middle, y + bubble + size * 0.85), &name, size, palette::agent_words(state.agent));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{hall, recording, robot, state, walk};

    fn drawn(run: &Recording, names: bool) -> String {
        let location = hall("hall");
        let frame = Frame::around(&location, 640.0, 360.0, (0.0, 0.0));
        let bounds = Area { x: 0.0, y: 0.0, w: 640.0, h: 360.0 };
        let look = Look::new(run, (frame.len(&location, 1.0), 5.0), 11.0, names, bounds);
        let mut svg = Svg::part();
        draw_everybody(&mut svg, &location, &frame, run, 2.0, &look, &[]);
        svg.text_so_far()
    }

    #[test]
    fn a_name_at_an_edge_stays_in_the_picture() {
        let at = (1.0, 2.0);
        let look_at = |bounds: Area| {
            let run = walk(1);
            let look = Look::new(&run, (30.0, 5.0), 11.0, true, bounds);
            let mut taken = vec![(Area { x: at.0 - 8.0, y: at.1 - 8.0, w: 16.0, h: 16.0 }, 1.0)];
            draw_words(&mut Svg::part(), at, &state(1, 0.0, 0.0, 0.0, 0.0), 8.0, &look, &mut taken);
            let Area { x, y, w, h } = taken[1].0;
            (x, y, w, h)
        };
        let (x, y, w, h) = look_at(Area { x: 0.0, y: 0.0, w: 640.0, h: 360.0 });
        assert!(x >= 0.0 && y >= 0.0 && x + w <= 640.0 && y + h <= 360.0, "{x} {y}");
        let (x, y, ..) = look_at(Area { x: -100.0, y: -100.0, w: 640.0, h: 360.0 });
        assert!(x < 0.0 && y < 0.0, "above and in the middle where there is room: {x} {y}");
    }

    #[test]
    fn what_somebody_says_is_seen_without_labels_too() {
        let mut speaker = state(1, 3.0, 1.0, 0.0, 0.0);
        speaker.flags = AgentState::flags(speaker.agent_id(), Some(socrates_model::Gesture::ExcuseMe), 0);
        let run = recording(&[&[robot(1.0, 1.0, 1.0, 0.0), speaker]]);
        assert!(drawn(&run, false).contains("EXCUSE ME") && !drawn(&run, false).contains(">h1<"));
        assert!(drawn(&run, true).contains(">h1<"));
    }

    #[test]
    fn a_crowd_has_no_names_but_the_robots() {
        let words = drawn(&walk(300), true);
        assert!(words.contains(">robot<") && !words.contains(">h7<"));
        assert_eq!(words.matches("<circle r=").count(), 300);
    }

    #[test]
    fn somebody_who_is_nowhere_is_not_drawn() {
        let run = recording(&[&[robot(1.0, 1.0, 1.0, 0.0), state(1, f64::NAN, 0.0, 0.0, 0.0)]]);
        let words = drawn(&run, true);
        assert!(!words.contains("NaN") && !words.contains("<circle r="));
    }
}
