//! What one of the people sees: floor, walls and doors, the robot and the others, each as large as it is at its distance.
//!
//! ```text
//! state of the person ─► point, direction ─┬─► rays over the grid ─► walls by column ─► floor, walls
//!                                          └─► the others, the farthest first, where no wall is nearer
//! ```

use std::f64::consts::TAU;

use socrates_model::recording::AgentInfo;
use socrates_model::{AgentState, Cell, HumanId, Location, Point, Recording};

use crate::actor::{is_open, moment};
use crate::film::FilmError;
use crate::label::{Area, text_width};
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Width of what is seen, degrees: about what people see sharply enough to walk by without turning the head.
pub const FIELD_DEGREES: f64 = 100.0;
/// Height of the eyes of a grown person, m.
pub const EYE_M: f64 = 1.6;
/// Height of walls, m.
const WALL_M: f64 = 2.6;
/// Height of a person up to the shoulders and of their head, and radius of the head, m.
const BODY_M: (f64, f64, f64) = (1.42, 1.57, 0.13);
/// Height of the robot, m: no file of a robot tells it.
const ROBOT_M: f64 = 1.0;
/// Rays over the width.
const COLUMNS: usize = 160;
/// Beyond this nothing is seen, m.
const FAR_M: f64 = 40.0;
/// Nearer than this nothing is drawn, m.
const NEAR_M: f64 = 0.2;
/// Tiles of the floor are seen so far, m: without them nobody would feel how they move.
const TILES_M: i32 = 10;
/// The direction is the mean of so many seconds before and after: a head does not jerk as a step does.
const STEADY_SECS: f64 = 0.4;

/// The eyes of one of the people in a run.
#[derive(Debug, Clone)]
pub(crate) struct Eyes<'a> {
    location: &'a Location,
    recording: &'a Recording,
    /// Place of the person in a tick.
    place: usize,
    view: Area,
}

/// Where somebody stands and looks.
#[derive(Debug, Clone, Copy)]
struct Pose {
    at: Point,
    forward: (f64, f64),
    right: (f64, f64),
}

/// What is seen in a column: how far away, and whether it is a door.
#[derive(Debug, Clone, Copy)]
struct Hit {
    depth_m: f64,
    door: bool,
}

impl<'a> Eyes<'a> {
    /// The eyes of somebody who is there all the time.
    ///
    /// # Errors
    /// [`FilmError::Absent`].
    pub(crate) fn of(
        location: &'a Location,
        recording: &'a Recording,
        who: HumanId,
        view: Area,
        (from_s, to_s): (f64, f64),
    ) -> Result<Self, FilmError> {
        let agents = &recording.header.agents;
        let people = || {
            let names: Vec<String> =
                agents.iter().filter(|info| info.agent.number() != 0).map(|info| info.agent.to_string()).collect();
            if names.is_empty() { "nobody".to_owned() } else { names.join(", ") }
        };
        let absent = |at_s| FilmError::Absent { who, run: recording.header.run.to_string(), at_s, people: people() };
        let is = |info: &AgentInfo| info.agent.number() == who.number();
        let place = agents.iter().position(is).ok_or_else(|| absent(from_s))?;
        let there = There::of(recording);
        let mut at_s = from_s;
        while at_s <= to_s {
            if !moment(recording, at_s).get(place).is_some_and(|state| there.is(state)) {
                return Err(absent(at_s));
            }
            at_s += 0.1;
        }
        Ok(Self { location, recording, place, view })
    }

    fn pose(&self, now_s: f64) -> Option<Pose> {
        let own = moment(self.recording, now_s).get(self.place)?;
        let (mut x, mut y) = (0.0, 0.0);
        for step in -4_i8..=4 {
            let then = (now_s + STEADY_SECS * f64::from(step) / 4.0).max(0.0);
            let Some(state) = moment(self.recording, then).get(self.place) else { continue };
            x += state.yaw.cos();
            y += state.yaw.sin();
        }
        let yaw = if x.hypot(y) > 1e-6 { y.atan2(x) } else { own.yaw };
        let forward = (yaw.cos(), yaw.sin());
        Some(Pose { at: own.point(), forward, right: (forward.1, -forward.0) })
    }

    /// Pixels per meter at a distance of one meter.
    fn focal(&self) -> f64 {
        self.view.w / 2.0 / (FIELD_DEGREES.to_radians() / 2.0).tan()
    }

    /// Height of the horizon in the picture: a little above the middle, for what matters stands on the floor.
    fn horizon(&self) -> f64 {
        self.view.y + self.view.h * 0.45
    }

    /// Where something is seen: `ahead` and `aside` m away, `up` m above the floor.
    fn px(&self, ahead: f64, aside: f64, up: f64) -> (f64, f64) {
        let scale = self.focal() / ahead.max(NEAR_M);
        (self.view.x + self.view.w / 2.0 + aside * scale, self.horizon() + (EYE_M - up) * scale)
    }

    /// Draws what is there in every direction: floor and ceiling.
    pub(crate) fn draw_ground(&self, svg: &mut Svg) {
        let Area { x, y, w, h } = self.view;
        svg.rect((x, y), (w, h), "fill=\"#eef1f4\"");
        svg.rect((x, self.horizon()), (w, y + h - self.horizon()), "fill=\"#dcd8d0\"");
    }

    /// Draws what is seen at a moment.
    pub(crate) fn draw(&self, svg: &mut Svg, now_s: f64, text_px: f64) {
        let Some(pose) = self.pose(now_s) else { return };
        let hits = self.hits(&pose, now_s);
        self.draw_tiles(svg, &pose);
        self.draw_walls(svg, &hits);
        let there = There::of(self.recording);
        let mut seen: Vec<(f64, f64, &AgentState)> = moment(self.recording, now_s)
            .iter()
            .enumerate()
            .filter(|(place, state)| *place != self.place && there.is(state))
            .map(|(_, state)| {
                let apart = (state.x - pose.at.x, state.y - pose.at.y);
                (dot(apart, pose.forward), dot(apart, pose.right), state)
            })
            .filter(|(ahead, ..)| *ahead > NEAR_M)
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (index, (ahead, aside, state)) in seen.iter().enumerate() {
            let info = self.recording.header.agents.iter().find(|info| info.agent == state.agent_id());
            let radius_m = info.map_or(0.28, |info| info.radius_m);
            let Some(spans) = self.spans((*ahead, *aside), radius_m, &hits) else { continue };
            let Area { y, h, .. } = self.view;
            svg.raw(&format!("<clipPath id=\"seen-{index}\">"));
            spans.iter().for_each(|(from, to)| svg.rect((*from, y), (to - from, h), ""));
            svg.raw(&format!("</clipPath><g clip-path=\"url(#seen-{index})\">"));
            // 0 looks at the viewer, positive turns to the viewer's right.
            let facing = (pose.at.y - state.y).atan2(pose.at.x - state.x) - state.yaw;
            let facing = -(facing - TAU * (facing / TAU).round());
            if state.agent == 0 {
                self.draw_robot(svg, (*ahead, *aside), radius_m, facing);
            } else {
                self.draw_person(svg, (*ahead, *aside), radius_m, facing, palette::agent(state.agent));
            }
            svg.raw("</g>");
        }
        for (ahead, aside, state) in &seen {
            let shown = self.spans((*ahead, *aside), BODY_M.2, &hits).is_some();
            if let Some(gesture) = state.gesture().filter(|_| shown) {
                let up = if state.agent == 0 { ROBOT_M } else { BODY_M.1 + BODY_M.2 };
                self.draw_said(svg, self.px(*ahead, *aside, up + 0.1), &gesture.name().replace('_', " "), text_px);
            }
        }
    }

    /// The nearest wall or closed door in every column.
    fn hits(&self, pose: &Pose, now_s: f64) -> Vec<Hit> {
        let widest = (FIELD_DEGREES.to_radians() / 2.0).tan();
        let shut: Vec<(Point, Point)> = self
            .location
            .doors
            .iter()
            .filter(|door| !is_open(door, self.recording, now_s))
            .map(|door| (door.from, door.to))
            .collect();
        let (px, py) = self.location.grid.pixel_from_world(&pose.at);
        (0..COLUMNS)
            .map(|column| {
                #[expect(clippy::cast_precision_loss, reason = "some hundred columns")]
                let slope = ((column as f64 + 0.5) / COLUMNS as f64 * 2.0 - 1.0) * widest;
                let ray = (pose.forward.0 + pose.right.0 * slope, pose.forward.1 + pose.right.1 * slope);
                let ahead = Point::new(pose.at.x + ray.0, pose.at.y + ray.1);
                let (tx, ty) = self.location.grid.pixel_from_world(&ahead);
                let wall_m = self.wall_m((px, py), (tx - px, ty - py));
                let door_m = shut.iter().filter_map(|door| crossed(&pose.at, ray, door)).fold(FAR_M, f64::min);
                Hit { depth_m: wall_m.min(door_m).max(NEAR_M), door: door_m < wall_m }
            })
            .collect()
    }

    /// How far it is from a place of the grid to the first cell that is not free, along a step of one meter (Amanatides and Woo 1987).
    fn wall_m(&self, (px, py): (f64, f64), (dx, dy): (f64, f64)) -> f64 {
        let (mut column, mut row) = (px.floor(), py.floor());
        let first = |at: f64, cell: f64, step: f64| {
            if step > 0.0 {
                (cell + 1.0 - at) / step
            } else if step < 0.0 {
                (cell - at) / step
            } else {
                f64::INFINITY
            }
        };
        let (mut next_x, mut next_y) = (first(px, column, dx), first(py, row, dy));
        loop {
            let at_m = next_x.min(next_y);
            if at_m >= FAR_M {
                return FAR_M;
            }
            if next_x < next_y {
                column += dx.signum();
                next_x += 1.0 / dx.abs();
            } else {
                row += dy.signum();
                next_y += 1.0 / dy.abs();
            }
            if column < 0.0 || row < 0.0 {
                return at_m;
            }
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell, not below 0")]
            if self.location.grid.at(column as usize, row as usize) != Cell::Free {
                return at_m;
            }
        }
    }

    /// Lines of the floor, one every meter; those behind walls are covered by them.
    fn draw_tiles(&self, svg: &mut Svg, pose: &Pose) {
        let reach = f64::from(TILES_M);
        let mut path = String::new();
        for step in -TILES_M..=TILES_M {
            let (x, y) = (pose.at.x.floor() + f64::from(step), pose.at.y.floor() + f64::from(step));
            let across = ((x, pose.at.y - reach), (x, pose.at.y + reach));
            let along = ((pose.at.x - reach, y), (pose.at.x + reach, y));
            for (from, to) in [across, along] {
                let seen = |(x, y): (f64, f64)| {
                    let apart = (x - pose.at.x, y - pose.at.y);
                    (dot(apart, pose.forward), dot(apart, pose.right))
                };
                let (mut a, mut b) = (seen(from), seen(to));
                // The part before the eyes; nearer than this the floor is below the picture.
                let near = 1.0;
                if a.0 < near && b.0 < near {
                    continue;
                }
                let cut = |inside: (f64, f64), outside: (f64, f64)| {
                    let part = (near - outside.0) / (inside.0 - outside.0);
                    (near, outside.1 + (inside.1 - outside.1) * part)
                };
                if a.0 < near {
                    a = cut(b, a);
                } else if b.0 < near {
                    b = cut(a, b);
                }
                let (from, to) = (self.px(a.0, a.1, 0.0), self.px(b.0, b.1, 0.0));
                path.push_str(&format!("M{:.0} {:.0}L{:.0} {:.0}", from.0, from.1, to.0, to.1));
            }
        }
        svg.raw(&format!("<path d=\"{path}\" stroke=\"#c4bfb4\" stroke-width=\"1.5\" fill=\"none\"/>"));
    }

    /// Walls as pieces that are straight on the floor: along them the inverse of the distance grows evenly.
    fn draw_walls(&self, svg: &mut Svg, hits: &[Hit]) {
        #[expect(clippy::cast_precision_loss, reason = "some hundred columns")]
        let wide = self.view.w / COLUMNS as f64;
        let mut from = 0;
        while from < hits.len() {
            let to = straight(hits, from);
            let (Some(first), Some(last)) = (hits.get(from), hits.get(to)) else { return };
            #[expect(clippy::cast_precision_loss, reason = "some hundred columns")]
            let (a, b, count) = (from as f64, to as f64, (to - from) as f64);
            let (near, far) = (1.0 / first.depth_m, 1.0 / last.depth_m);
            let step = if count > 0.0 { (far - near) / count } else { 0.0 };
            // From the outer edges of the columns, whose middles were looked at.
            let (left, right) = ((near - step / 2.0).max(1e-3), (far + step / 2.0).max(1e-3));
            let x = |column: f64| self.view.x + column * wide;
            let y = |inverse: f64, up: f64| self.horizon() + (EYE_M - up) * self.focal() * inverse;
            let (x0, x1) = (x(a), x(b + 1.0));
            let fill = shade(first.door, 1.0 / left.max(right), step * 40.0);
            svg.raw(&format!(
                "<path d=\"M{x0:.0} {:.0}L{x1:.0} {:.0}L{x1:.0} {:.0}L{x0:.0} {:.0}z\" fill=\"{fill}\" stroke=\"{fill}\"/>",
                y(left, WALL_M),
                y(right, WALL_M),
                y(right, 0.0),
                y(left, 0.0)
            ));
            from = to + 1;
        }
    }

    /// The parts of the width in which somebody is not hidden; none where all is hidden or out of the picture.
    fn spans(&self, (ahead, aside): (f64, f64), radius_m: f64, hits: &[Hit]) -> Option<Vec<(f64, f64)>> {
        #[expect(clippy::cast_precision_loss, reason = "some hundred columns")]
        let wide = self.view.w / COLUMNS as f64;
        let (left, _) = self.px(ahead, aside - radius_m, 0.0);
        let (right, _) = self.px(ahead, aside + radius_m, 0.0);
        let mut spans: Vec<(f64, f64)> = Vec::new();
        let mut x = self.view.x;
        for hit in hits {
            if x + wide > left && x < right && hit.depth_m > ahead - radius_m {
                match spans.last_mut() {
                    Some((_, to)) if (*to - x).abs() < 1e-6 => *to = x + wide,
                    _ => spans.push((x, x + wide)),
                }
            }
            x += wide;
        }
        (!spans.is_empty()).then_some(spans)
    }

    fn draw_shadow(&self, svg: &mut Svg, (ahead, aside): (f64, f64), radius_m: f64) {
        let (x, y) = self.px(ahead, aside, 0.0);
        let (rx, ry) = (radius_m * 1.1 * self.focal() / ahead, radius_m * EYE_M * self.focal() / (ahead * ahead));
        svg.raw(&format!(
            "<ellipse cx=\"{x:.0}\" cy=\"{y:.0}\" rx=\"{rx:.0}\" ry=\"{:.0}\" fill=\"#000000\" fill-opacity=\"0.18\"/>",
            ry.min(rx)
        ));
    }

    /// A person: a body, and a head whose eyes are seen by whoever it is turned to.
    fn draw_person(&self, svg: &mut Svg, at: (f64, f64), radius_m: f64, facing: f64, color: &str) {
        let scale = self.focal() / at.0;
        self.draw_shadow(svg, at, radius_m);
        let (x, top) = self.px(at.0, at.1, BODY_M.0);
        let half = radius_m * 0.85 * scale;
        // Narrower seen from the side.
        let half = half * (0.72 + 0.28 * facing.cos().abs());
        let rim = format!("stroke=\"#ffffff\" stroke-width=\"{:.1}\"", (scale * 0.015).clamp(0.5, 3.0));
        svg.raw(&format!(
            "<rect x=\"{:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{:.1}\" fill=\"{color}\" {rim}/>",
            x - half,
            half * 2.0,
            BODY_M.0 * scale,
            half * 0.8
        ));
        let (_, y) = self.px(at.0, at.1, BODY_M.1);
        let r = BODY_M.2 * scale;
        svg.raw(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" fill=\"#7a5c43\" {rim}/>"));
        if facing.cos() > -0.2 {
            let face = x + facing.sin() * r * 0.35;
            let wide = r * (0.35 + 0.45 * facing.cos().max(0.0));
            svg.raw(&format!(
                "<ellipse cx=\"{face:.1}\" cy=\"{:.1}\" rx=\"{wide:.1}\" ry=\"{:.1}\" fill=\"#efd2b4\"/>",
                y + r * 0.12,
                r * 0.78
            ));
            let apart = r * 0.3 * facing.cos().max(0.15);
            for side in [-1.0, 1.0] {
                let eye = (x + facing.sin() * r * 0.6 + side * apart, y - r * 0.05);
                svg.circle(eye, r * 0.11, "fill=\"#1f2328\"");
            }
        }
    }

    /// The robot: a barrel with a white front.
    fn draw_robot(&self, svg: &mut Svg, at: (f64, f64), radius_m: f64, facing: f64) {
        let scale = self.focal() / at.0;
        self.draw_shadow(svg, at, radius_m);
        let (x, top) = self.px(at.0, at.1, ROBOT_M);
        let half = radius_m * scale;
        let rim = format!("stroke=\"#ffffff\" stroke-width=\"{:.1}\"", (scale * 0.015).clamp(0.5, 3.0));
        svg.raw(&format!(
            "<rect x=\"{:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{:.1}\" fill=\"{}\" {rim}/>",
            x - half,
            half * 2.0,
            ROBOT_M * scale,
            half * 0.25,
            palette::ROBOT
        ));
        if facing.cos() > 0.0 {
            let (middle, wide) = (x + facing.sin() * half * 0.75, half * 0.62 * facing.cos());
            svg.raw(&format!(
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{:.1}\" fill=\"#ffffff\"/>",
                middle - wide,
                top + ROBOT_M * 0.12 * scale,
                wide * 2.0,
                ROBOT_M * 0.22 * scale,
                (wide * 0.3).min(ROBOT_M * 0.1 * scale)
            ));
            for side in [-0.45, 0.45] {
                let eye = (middle + wide * side, top + ROBOT_M * 0.23 * scale);
                svg.circle(eye, (ROBOT_M * 0.035 * scale).min(wide * 0.3), "fill=\"#1f2328\"");
            }
        }
    }

    /// What somebody says, in a bubble above them and within the picture.
    fn draw_said(&self, svg: &mut Svg, (x, y): (f64, f64), said: &str, text_px: f64) {
        let Area { x: left, y: top, w, h } = self.view;
        let size = text_px * 1.1;
        let (wide, high) = (text_width(said, size) + size, size * 1.6);
        let at = (
            (x - wide / 2.0).clamp(left + 2.0, (left + w - wide - 2.0).max(left + 2.0)),
            (y - high).clamp(top + 2.0, top + h - high - 2.0),
        );
        svg.rect(at, (wide, high), &format!("rx=\"{:.1}\" fill=\"#fff4d6\" stroke=\"#b07a00\"", size * 0.35));
        svg.heading((at.0 + size * 0.5, at.1 + size * 1.15), said, size, palette::INK);
    }
}

fn dot(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.0 + a.1 * b.1
}

/// How far along a ray, in lengths of it, a segment is crossed.
fn crossed(at: &Point, ray: (f64, f64), (from, to): &(Point, Point)) -> Option<f64> {
    let (along, apart) = ((to.x - from.x, to.y - from.y), (from.x - at.x, from.y - at.y));
    let cross = |a: (f64, f64), b: (f64, f64)| a.0 * b.1 - a.1 * b.0;
    let turn = cross(ray, along);
    if turn.abs() < 1e-9 {
        return None;
    }
    let (far, part) = (cross(apart, along) / turn, cross(apart, ray) / turn);
    (far > NEAR_M && (0.0..=1.0).contains(&part)).then_some(far)
}

/// The last column of the straight piece of wall that begins with one: cells of a map are steps, which a wall is not.
fn straight(hits: &[Hit], from: usize) -> usize {
    let inverse = |index: usize| hits.get(index).map_or(0.0, |hit| 1.0 / hit.depth_m);
    let door = |index: usize| hits.get(index).is_some_and(|hit| hit.door);
    let mut to = from;
    while to + 1 < hits.len() && door(to + 1) == door(from) {
        let end = to + 1;
        #[expect(clippy::cast_precision_loss, reason = "some hundred columns")]
        let fits = (from..=end).all(|index| {
            let part = (index - from) as f64 / (end - from) as f64;
            let even = inverse(from) + (inverse(end) - inverse(from)) * part;
            (inverse(index) - even).abs() <= 0.03 * even + 0.004
        });
        if !fits {
            break;
        }
        to = end;
    }
    to
}

/// The color of a wall: paler far away, and darker where it leads away to the one side.
fn shade(door: bool, depth_m: f64, turned: f64) -> String {
    let light = 168.0 + 52.0 * (depth_m / 18.0).min(1.0) + 14.0 * turned.clamp(-1.0, 1.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a color, clipped")]
    let part = |by: f64| (light * by).clamp(0.0, 255.0) as u8;
    let (red, green, blue) =
        if door { (part(0.95), part(0.68), part(0.42)) } else { (part(0.97), part(0.99), part(1.02)) };
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, FilmOptions, Seen, Shown};
    use crate::fixture::{away, hall, walk};

    fn seen(run: &Recording, who: u32) -> Result<Vec<String>, String> {
        let location = hall("hall");
        let options = FilmOptions {
            size: (640, 360),
            labels: false,
            seen: Seen::By(HumanId::new(who)),
            part: Some((0.0, 6.0)),
            alike: true,
            ..FilmOptions::USUAL
        };
        let shown = [Shown { recording: run, report: None, name: None }];
        let film = Film::new(&location, "they meet", &[run], &shown, options).map_err(|why| why.to_string())?;
        Ok(film.strip(10).pictures)
    }

    /// Width of the robot in a picture, px; none where it is not seen.
    fn robot_px(picture: &str) -> Option<f64> {
        let (before, _) = picture.split_once(&format!("fill=\"{}\"", palette::ROBOT))?;
        before.rsplit_once("width=\"")?.1.split('"').next()?.parse().ok()
    }

    #[test]
    fn the_robot_grows_as_it_comes_and_is_gone_when_it_has_passed() {
        // They start 6 m apart and pass each other after 3 s; the first second of a film stands still.
        let pictures = seen(&walk(1), 1).unwrap();
        let at = |film_s: usize| robot_px(&pictures[film_s * 10]);
        let focal = 320.0 / 50_f64.to_radians().tan();
        let first = pictures.iter().find_map(|picture| robot_px(picture)).unwrap();
        assert!((first - 0.6 * focal / 6.0).abs() < 0.5, "{first}");
        assert!((at(3).unwrap() - 0.6 * focal / 2.0).abs() < 0.5, "a third of the distance, three times the size");
        assert!(at(5).is_none() && at(7).is_none(), "behind");
    }

    #[test]
    fn walls_are_where_rays_end_and_a_straight_one_is_one_piece() {
        let (location, run) = (hall("hall"), walk(1));
        let view = Area { x: 0.0, y: 0.0, w: 640.0, h: 360.0 };
        let eyes = Eyes::of(&location, &run, HumanId::new(1), view, (0.0, 1.0)).unwrap();
        let pose = eyes.pose(0.0).unwrap();
        let hits = eyes.hits(&pose, 0.0);
        // From 7 m the far wall, whose inner face is at 0.1 m, is 6.9 m away.
        assert!((hits[COLUMNS / 2].depth_m - 6.9).abs() < 0.01, "{}", hits[COLUMNS / 2].depth_m);
        let mut svg = Svg::part();
        eyes.draw_walls(&mut svg, &hits);
        let pieces = svg.text_so_far().matches("<path").count();
        assert!((3..=6).contains(&pieces), "two sides and an end, {pieces} pieces");
    }

    #[test]
    fn who_is_not_there_sees_nothing() {
        assert!(seen(&walk(1), 2).unwrap_err().contains("`human_2` is not in the run `test.reference-1` at 0.0 s"));
        let gone = away(walk(2), 2, 300..601);
        let told = seen(&gone, 2).unwrap_err();
        assert!(told.contains("at 3.0 s") && told.contains("human_1, human_2"), "{told}");
    }

    #[test]
    fn a_strip_tells_nothing_of_the_planner_and_repeats_no_picture() {
        let pictures = seen(&walk(2), 1).unwrap();
        assert_eq!(pictures.len(), 80);
        assert!(pictures.iter().all(|picture| !picture.contains("reference") && !picture.contains("human")));
        assert!(!pictures[0].is_empty() && pictures[1].is_empty(), "it stands still at first");
    }
}
