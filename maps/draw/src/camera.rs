//! Where a film looks: near enough that people can be seen, smoothly after what happens.

use socrates_model::{AgentState, Location, Paths, Point, Recording};

use crate::actor::moment;
use crate::label::Area;
use crate::map_layer::Frame;
use crate::play::spread;
use crate::presence::There;

/// Least size of a person in a film, px.
pub const LEAST_PX: f64 = 40.0;
/// A person takes at most this part of the height of a small picture, else nothing else could be seen.
const LARGEST_PART: f64 = 1.0 / 8.5;
/// A film comes at most so much nearer than it has to.
const NEARER: f64 = 1.8;
/// Radius below which nobody is taken for the scale, m: they are drawn larger than they are.
const LEAST_RADIUS_M: f64 = 0.2;
/// Up to this distance from the robot a human counts fully, and beyond the second not at all, m.
const CONCERNED_M: (f64, f64) = (4.0, 8.0);
/// Room kept around those who are looked at, m.
const ROOM_M: f64 = 1.2;
/// Seconds between two places of the camera, and places on each side over which its way is smoothed.
const STEP_SECS: f64 = 0.1;
const SMOOTH: usize = 12;

/// The camera of a still picture: the same for all runs of a scenario.
pub(crate) fn still(
    location: &Location,
    paths: Option<&Paths>,
    all: &[&Recording],
    size: (f64, f64),
    at: (f64, f64),
) -> Frame {
    let way = paths.map(|paths| location.graph.polyline(&paths.robot)).unwrap_or_default();
    let seen: Vec<Point> = all.iter().flat_map(|run| spread(run)).chain(way).collect();
    let mut frame = Frame::focused(location, &seen, size.0, size.1, at);
    // What does not fill the picture stands in its middle.
    let (w, h) = frame.size();
    frame.at = (at.0 + ((size.0 - w) / 2.0).max(0.0), at.1 + ((size.1 - h) / 2.0).max(0.0));
    frame
}

/// Least diameter of a person in a picture of this height, px.
pub(crate) fn least_px(height_px: f64) -> f64 {
    LEAST_PX.min(height_px * LARGEST_PART)
}

/// The camera of one run in a film: one scale, and a way over the map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Camera {
    /// The whole map at the scale of the film, its upper left corner at 0 0.
    world: Frame,
    /// Places of the map, in pixels of the world, that stand in the middle of the safe part; one every [`STEP_SECS`].
    centers: Vec<(f64, f64)>,
    from_s: f64,
    view: Area,
    safe: Area,
}

impl Camera {
    /// The camera for a run from one moment to another, s, in a part of a picture; those concerned stay in its `safe` part.
    /// Where all that happens in all runs of the scenario can be seen at once it stands still, the same for each of them.
    pub(crate) fn of(
        location: &Location,
        all: &[&Recording],
        run: &Recording,
        (from_s, to_s): (f64, f64),
        (view, safe): (Area, Area),
    ) -> Self {
        Self::near(location, all, Some(run), (from_s, to_s), (view, safe))
    }

    /// The camera that stands still whatever happens, the same for all these runs: as near as it can be for all of them.
    pub(crate) fn still(location: &Location, all: &[&Recording], part: (f64, f64), (view, safe): (Area, Area)) -> Self {
        Self::near(location, all, None, part, (view, safe))
    }

    /// As near as it should be; it follows the run, where one is named and where not all can be seen at once.
    fn near(
        location: &Location,
        all: &[&Recording],
        run: Option<&Recording>,
        (from_s, to_s): (f64, f64),
        (view, safe): (Area, Area),
    ) -> Self {
        let radii = all.iter().flat_map(|run| &run.header.agents).map(|info| info.radius_m);
        let radius_m = radii.fold(f64::MAX, f64::min).clamp(LEAST_RADIUS_M, 1.0);
        let cell_m = location.grid.resolution_m.max(1e-6);
        let whole = Frame::around(location, 1000.0, 1000.0, (0.0, 0.0));
        let world = |px_per_m: f64| Frame { scale: px_per_m * cell_m, ..whole };
        let least = least_px(view.h) / (2.0 * radius_m);
        let mut camera = Self { world: world(least), centers: Vec::new(), from_s, view, safe };
        let moments = steps(from_s, to_s);
        let mut seen: Option<(f64, f64, f64, f64)> = None;
        let eye = &camera;
        let places = all.iter().flat_map(|run| moments.iter().flat_map(move |now| eye.concerned(location, run, *now)));
        for ((x, y), _) in places {
            let (left, top, right, bottom) = seen.unwrap_or((x, y, x, y));
            seen = Some((left.min(x), top.min(y), right.max(x), bottom.max(y)));
        }
        let Some((left, top, right, bottom)) = seen else {
            let (w, h) = camera.world.size();
            camera.centers.push((w / 2.0, h / 2.0));
            return camera;
        };
        let room = 2.0 * ROOM_M * least;
        let fits = (safe.w / (right - left + room)).min(safe.h / (bottom - top + room));
        match run.filter(|_| fits < 1.0) {
            Some(run) => camera.centers = camera.way(location, run, &moments),
            None => {
                let nearer = fits.min(NEARER);
                camera.world = world(least * nearer);
                camera.centers.push((f64::midpoint(left, right) * nearer, f64::midpoint(top, bottom) * nearer));
            }
        }
        let ends: Vec<(f64, f64)> = camera.centers.iter().map(|center| camera.within(*center)).collect();
        camera.centers = ends;
        camera
    }

    /// Where the robot is and who is near it, in pixels of the world, with how much each of them counts; without a robot
    /// everybody.
    fn concerned(&self, location: &Location, run: &Recording, now_s: f64) -> Vec<((f64, f64), f64)> {
        let there = There::of(run);
        let states: Vec<&AgentState> = moment(run, now_s).iter().filter(|state| there.is(state)).collect();
        let robot = states.iter().find(|state| state.agent == 0).copied();
        let (full, none) = CONCERNED_M;
        let weight = |state: &AgentState| {
            let Some(robot) = robot.filter(|_| state.agent != 0) else { return 1.0 };
            let apart = (state.x - robot.x).hypot(state.y - robot.y);
            ((none - apart) / (none - full)).clamp(0.0, 1.0)
        };
        let counted = states.iter().map(|state| (self.world.px(location, &state.point()), weight(state)));
        counted.filter(|(_, weight)| *weight > 0.0).collect()
    }

    /// The smoothed way of the middle of those concerned, with the robot always in sight.
    fn way(&self, location: &Location, run: &Recording, moments: &[f64]) -> Vec<(f64, f64)> {
        let mut raw: Vec<(f64, f64)> = Vec::new();
        let mut robots: Vec<Option<(f64, f64)>> = Vec::new();
        for now in moments {
            let seen = self.concerned(location, run, *now);
            let weight: f64 = seen.iter().map(|(_, weight)| weight).sum();
            let sum = seen.iter().fold((0.0, 0.0), |(x, y), (at, weight)| (x + at.0 * weight, y + at.1 * weight));
            let before = raw.last().copied().unwrap_or((0.0, 0.0));
            raw.push(if weight > 0.0 { (sum.0 / weight, sum.1 / weight) } else { before });
            let there = There::of(run);
            let robot = moment(run, *now).iter().find(|state| state.agent == 0 && there.is(state));
            robots.push(robot.map(|state| self.world.px(location, &state.point())));
        }
        let smooth = smoothed(&smoothed(&raw));
        let room = |side: f64| (side * 0.5 - ROOM_M * self.px_per_m(location)).max(side * 0.2);
        let (aside, up) = (room(self.safe.w), room(self.safe.h));
        let near = |(x, y): (f64, f64), robot: &Option<(f64, f64)>| match robot {
            Some((rx, ry)) => (x.clamp(rx - aside, rx + aside), y.clamp(ry - up, ry + up)),
            None => (x, y),
        };
        smooth.into_iter().zip(&robots).map(|(center, robot)| near(center, robot)).collect()
    }

    /// The center moved so that the picture shows the map where there is enough of it.
    fn within(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (w, h) = self.world.size();
        let (left, top) = (self.middle().0 - self.view.x, self.middle().1 - self.view.y);
        let held = |at: f64, before: f64, behind: f64, size: f64| {
            if size <= before + behind { size / 2.0 + (before - behind) / 2.0 } else { at.clamp(before, size - behind) }
        };
        (held(x, left, self.view.w - left, w), held(y, top, self.view.h - top, h))
    }

    const fn middle(&self) -> (f64, f64) {
        (self.safe.x + self.safe.w / 2.0, self.safe.y + self.safe.h / 2.0)
    }

    /// Pixels per meter.
    pub(crate) fn px_per_m(&self, location: &Location) -> f64 {
        self.world.len(location, 1.0)
    }

    /// Whether it stands still.
    pub(crate) fn is_still(&self) -> bool {
        self.centers.len() == 1
    }

    /// The whole map with its upper left corner at 0 0.
    pub(crate) const fn world(&self) -> Frame {
        self.world
    }

    /// The whole map as it lies in the picture at a moment.
    pub(crate) fn frame(&self, now_s: f64) -> Frame {
        let (x, y) = self.center(now_s);
        let (left, top) = self.middle();
        Frame { at: (left - x, top - y), ..self.world }
    }

    /// The part of the map that is seen at a moment.
    pub(crate) fn part(&self, now_s: f64) -> Frame {
        seen(&self.frame(now_s), &self.view)
    }

    /// The place of the world that stands in the middle at a moment.
    fn center(&self, now_s: f64) -> (f64, f64) {
        let at = ((now_s - self.from_s) / STEP_SECS).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a step of the film, clipped")]
        let index = (at.floor() as usize).min(self.centers.len().saturating_sub(1));
        let from = self.centers.get(index).copied().unwrap_or((0.0, 0.0));
        let to = self.centers.get(index + 1).copied().unwrap_or(from);
        let part = at.fract();
        (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part)
    }
}

/// The part of a whole map that is seen in a part of a picture.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a map, clipped to its bounds"
)]
pub(crate) fn seen(whole: &Frame, view: &Area) -> Frame {
    let (x0, y0, w, h) = whole.cells;
    let span = |at: f64, start: f64, size: f64, cells: usize| {
        let first = ((start - at) / whole.scale).floor().clamp(0.0, cells as f64) as usize;
        let last = ((start + size - at) / whole.scale).ceil().clamp(0.0, cells as f64) as usize;
        (first, last.saturating_sub(first))
    };
    let (column, columns) = span(whole.at.0, view.x, view.w, w);
    let (row, rows) = span(whole.at.1, view.y, view.h, h);
    let at = (whole.at.0 + column as f64 * whole.scale, whole.at.1 + row as f64 * whole.scale);
    Frame { cells: (x0 + column, y0 + row, columns, rows), scale: whole.scale, at }
}

/// Moments from one to another, s.
fn steps(from_s: f64, to_s: f64) -> Vec<f64> {
    let mut moments = vec![from_s];
    let mut step = 1.0;
    while from_s + step * STEP_SECS <= to_s + STEP_SECS {
        moments.push(from_s + step * STEP_SECS);
        step += 1.0;
    }
    moments
}

/// Every place replaced by the mean of its neighbors; fewer of them near the ends.
fn smoothed(way: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mean = |index: usize| {
        let reach = SMOOTH.min(index).min(way.len() - 1 - index);
        let near = way.get(index - reach..=index + reach).unwrap_or(&[]);
        #[expect(clippy::cast_precision_loss, reason = "a few neighbors")]
        let count = near.len().max(1) as f64;
        let sum = near.iter().fold((0.0, 0.0), |(x, y), at| (x + at.0, y + at.1));
        (sum.0 / count, sum.1 / count)
    };
    (0..way.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{hall, human, recording, robot, walk};

    fn area(w: f64, h: f64) -> Area {
        Area { x: 0.0, y: 0.0, w, h }
    }

    /// The robot goes 7 m through a hall, somebody follows it at 1.5 m.
    fn long_walk() -> Recording {
        let ticks: Vec<Vec<AgentState>> = (0..=700)
            .map(|tick| {
                let t = f64::from(tick) / 100.0;
                vec![robot(0.5 + t, 1.5, 1.0, 0.0), human(1, t - 1.0, 1.5, 1.0, 0.0)]
            })
            .collect();
        recording(&ticks.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn people_are_large_enough_and_the_robot_stays_in_sight() {
        let (location, run) = (hall("hall"), long_walk());
        let (view, safe) = (area(400.0, 360.0), area(400.0, 300.0));
        let camera = Camera::of(&location, &[&run], &run, (0.0, 7.0), (view, safe));
        assert!(!camera.is_still());
        assert!(camera.px_per_m(&location) * 0.6 >= LEAST_PX - 1e-9);
        let mut before: Option<(f64, f64)> = None;
        for step in 0..=70 {
            let now = f64::from(step) / 10.0;
            let frame = camera.frame(now);
            let (x, y) = frame.px(&location, &moment(&run, now)[0].point());
            assert!((0.0..=400.0).contains(&x) && (0.0..=300.0).contains(&y), "{x} {y} at {now} s");
            // It moves no faster than twice a walker, and never jumps.
            if let Some((bx, by)) = before {
                let most = 0.2 * camera.px_per_m(&location);
                assert!((frame.at.0 - bx).hypot(frame.at.1 - by) <= most, "a jump at {now} s");
            }
            before = Some(frame.at);
        }
    }

    #[test]
    fn what_can_be_seen_at_once_is_seen_by_a_camera_that_stands_still_the_same_for_all_runs() {
        let location = hall("hall");
        let (one, other) = (walk(1), walk(3));
        let all = [&one, &other];
        let of =
            |run: &Recording| Camera::of(&location, &all, run, (0.0, 6.0), (area(1280.0, 720.0), area(1280.0, 620.0)));
        assert!(of(&one).is_still());
        assert_eq!(of(&one), of(&other));
    }

    #[test]
    fn only_the_part_of_the_map_that_is_seen_is_drawn_and_it_lies_in_its_place() {
        let (location, run) = (hall("hall"), long_walk());
        let camera = Camera::of(&location, &[&run], &run, (0.0, 7.0), (area(200.0, 160.0), area(200.0, 160.0)));
        let (whole, part) = (camera.frame(3.0), camera.part(3.0));
        assert!(part.cells.2 < whole.cells.2);
        let point = run.tick(300)[0].point();
        let (a, b) = (whole.px(&location, &point), part.px(&location, &point));
        assert!((a.0 - b.0).abs() < 1e-6 && (a.1 - b.1).abs() < 1e-6);
    }
}
