//! The stills of a run on one sheet: who is where at a few moments, for a judge who reads pictures.
//!
//! The first picture shows the ways of the whole run; the others are moments from when the robot and a person are first near each
//! other to when they last are. Nothing is told but what can be seen: places, headings, gestures while they are made, doors.

mod cell;
mod head;
mod plan;

use socrates_model::{AgentId, AgentState, EventKind, Location, Point, Recording};

use self::plan::{Cell, Plan};
use crate::actor::moment;
use crate::map_layer::Frame;
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// How many stills a sheet may have.
pub const STILLS: std::ops::RangeInclusive<usize> = 2..=24;
/// So near are robot and person between the first still and the last, center to center, m.
pub const NEAR_M: f64 = 8.0;
/// Seconds between two looks at who is near whom.
const LOOK_SECS: f64 = 0.1;
/// Seconds on each side over which somebody's speed is taken.
const PACE_SECS: f64 = 0.3;
/// Below this somebody stands, m/s.
const STANDS_MPS: f64 = 0.15;

/// What stands on bodies, and how pictures are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signs {
    /// `R` for the robot, a person's number; pictures have their times.
    Numbers,
    /// `R` for the robot, a letter for a person, see [`letter`]; pictures are numbered from 0, the one of all ways.
    Letters,
}

/// The sheet of a run as SVG: the ways of the whole run, then so many stills in order of time. It is headed by this name alone.
#[must_use]
pub fn contact_sheet(name: &str, location: &Location, recording: &Recording, stills: usize, signs: Signs) -> String {
    let stills = stills.clamp(*STILLS.start(), *STILLS.end());
    let scene = Scene { location, recording, there: There::of(recording), signs };
    let (from_s, to_s) = scene.span_s();
    #[expect(clippy::cast_precision_loss, reason = "a few stills")]
    let time = |index: usize| from_s + (to_s - from_s) * index as f64 / (stills - 1) as f64;
    let times: Vec<f64> = (0..stills).map(time).collect();
    let head = head::Head::of(&scene);
    let plan = Plan::of(&scene, &times, head.height_px());
    let (w, h) = plan.size();
    let mut svg = Svg::new(w, h);
    svg.rect((0.0, 0.0), (w, h), "fill=\"#ffffff\"");
    head.draw(&mut svg, &scene, name);
    for (index, cell) in plan.cells.iter().enumerate() {
        cell::draw(&mut svg, &scene, &times, index, cell);
    }
    svg.finish()
}

/// A run in its place.
#[derive(Debug, Clone, Copy)]
struct Scene<'a> {
    location: &'a Location,
    recording: &'a Recording,
    there: There,
    signs: Signs,
}

impl Scene<'_> {
    /// What stands on somebody's body.
    fn sign(&self, agent: AgentId) -> String {
        match self.signs {
            Signs::Letters => letter(agent),
            Signs::Numbers if agent.number() == 0 => "R".to_owned(),
            Signs::Numbers => agent.number().to_string(),
        }
    }

    /// Time of the last tick, s.
    fn end_s(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a run has fewer than 2^53 ticks")]
        let ticks = self.recording.ticks().saturating_sub(1) as f64;
        ticks * self.recording.header.step_s
    }

    /// Everybody who is there at a moment.
    fn states(&self, now_s: f64) -> impl Iterator<Item = &AgentState> {
        moment(self.recording, now_s).iter().filter(|state| self.there.is(state))
    }

    /// Times from one to another, s, with both ends.
    fn looks(from_s: f64, to_s: f64, every_s: f64) -> impl Iterator<Item = f64> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count of looks")]
        let steps = ((to_s - from_s).max(0.0) / every_s).ceil() as u32;
        (0..=steps).map(move |step| (from_s + f64::from(step) * every_s).min(to_s))
    }

    /// From the first moment at which a person is near the robot to the last one, s; the whole run where nobody ever is.
    fn span_s(&self) -> (f64, f64) {
        let near = |now: &f64| {
            let robot = self.states(*now).find(|state| state.agent == 0);
            robot.is_some_and(|robot| {
                self.states(*now)
                    .any(|state| state.agent != 0 && (state.x - robot.x).hypot(state.y - robot.y) <= NEAR_M)
            })
        };
        let mut found: Option<(f64, f64)> = None;
        for now in Self::looks(0.0, self.end_s(), LOOK_SECS).filter(near) {
            found = Some((found.map_or(now, |(first, _)| first), now));
        }
        // One moment alone is no span to take stills of.
        found.filter(|(first, last)| last - first > 1.0).unwrap_or_else(|| (0.0, self.end_s()))
    }

    /// The way of somebody between two times, cut where they are not there.
    fn way(&self, agent: AgentId, from_s: f64, to_s: f64, every_s: f64) -> Vec<Vec<Point>> {
        let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
        for now in Self::looks(from_s, to_s, every_s) {
            match (self.states(now).find(|state| state.agent_id() == agent), parts.last_mut()) {
                (Some(state), Some(part)) => part.push(state.point()),
                (None, Some(part)) if !part.is_empty() => parts.push(Vec::new()),
                (Some(_) | None, _) => {}
            }
        }
        parts.retain(|part| !part.is_empty());
        parts
    }

    /// How far somebody comes in a second around a moment, m along x and y.
    fn pace(&self, agent: AgentId, now_s: f64) -> (f64, f64) {
        let (before, after) = ((now_s - PACE_SECS).max(0.0), (now_s + PACE_SECS).min(self.end_s()));
        let at = |t: f64| self.states(t).find(|state| state.agent_id() == agent).map(AgentState::point);
        match (at(before), at(after)) {
            (Some(a), Some(b)) if after > before => ((b.x - a.x) / (after - before), (b.y - a.y) / (after - before)),
            _ => (0.0, 0.0),
        }
    }

    /// Radius of somebody, m.
    fn radius_m(&self, agent: AgentId) -> f64 {
        self.recording.header.agents.iter().find(|info| info.agent == agent).map_or(0.28, |info| info.radius_m)
    }

    /// Gestures and doors after one time and up to another, in words.
    fn happened(&self, after_s: f64, to_s: f64) -> Vec<String> {
        let fresh = self.recording.events.iter().filter(|event| {
            let at = event.time.secs();
            at > after_s + 1e-9 && at <= to_s + 1e-9
        });
        fresh
            .filter_map(|event| {
                let at = event.time.secs();
                match &event.kind {
                    EventKind::Gesture { agent, gesture: Some(gesture), .. } => {
                        Some(format!("{} says {} at {at:.1} s", self.sign(*agent), gesture.name().replace('_', " ")))
                    }
                    EventKind::Door { open, .. } => {
                        Some(format!("a door {} at {at:.1} s", if *open { "opens" } else { "closes" }))
                    }
                    EventKind::Gesture { .. }
                    | EventKind::Leaf { .. }
                    | EventKind::StepEnded { .. }
                    | EventKind::Node { .. }
                    | EventKind::Sees { .. }
                    | EventKind::Encounter { .. }
                    | EventKind::Contact { .. }
                    | EventKind::WallContact { .. }
                    | EventKind::RobotArrived
                    | EventKind::Stuck { .. }
                    | EventKind::End { .. } => None,
                }
            })
            .collect()
    }

    /// The whole map around a point that stands in the middle of a cell.
    fn frame(&self, center: &Point, px_per_m: f64, cell: &Cell) -> Frame {
        let whole = Frame::around(self.location, 1000.0, 1000.0, (0.0, 0.0));
        let world = Frame { scale: px_per_m * self.location.grid.resolution_m.max(1e-6), ..whole };
        let (x, y) = world.px(self.location, center);
        let (left, top) = (cell.area.x + cell.area.w / 2.0, cell.area.y + cell.area.h / 2.0);
        Frame { at: (left - x, top - y), ..world }
    }
}

/// Letters of people; the robot has `R`.
const LETTERS: &[u8; 25] = b"ABCDEFGHIJKLMNOPQSTUVWXYZ";

/// What stands on somebody's body on a sheet with letters: `R` for the robot, `A` to `Z` without `R` for the first 25 people, then
/// `A2` to `Z2`, and so on.
#[must_use]
pub fn letter(agent: AgentId) -> String {
    let Some(index) = agent.number().checked_sub(1) else { return "R".to_owned() };
    let (round, place) = (index / 25, index % 25);
    let letter = usize::try_from(place).ok().and_then(|place| LETTERS.get(place)).copied().map_or('?', char::from);
    if round == 0 { letter.to_string() } else { format!("{letter}{}", round + 1) }
}

/// The color of a body: dark enough for the white number on it.
fn color(agent: AgentId) -> &'static str {
    palette::agent_words(agent.number())
}

/// A body that looks along x, around 0 0: a disc or the robot's square, with a nose outside of it that leaves room for a number.
fn body(robot: bool, r: f64, color: &str) -> String {
    let rim = format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1.5\"");
    let shape = if robot {
        format!("<rect x=\"{0:.1}\" y=\"{0:.1}\" width=\"{1:.1}\" height=\"{1:.1}\" rx=\"2\" {rim}/>", -r, 2.0 * r)
    } else {
        format!("<circle r=\"{r:.1}\" {rim}/>")
    };
    format!(
        "<path d=\"M{:.1} 0L{2:.1} {1:.1}L{2:.1} -{1:.1}z\" fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1\"/>{shape}",
        r * 1.75,
        r * 0.7,
        r * 0.7
    )
}

/// [`body`] at a place, turned, with its sign.
fn draw_body(svg: &mut Svg, at: (f64, f64), yaw: f64, agent: AgentId, words: &str, r: f64) {
    let degrees = -yaw.to_degrees();
    let body = body(agent.number() == 0, r, color(agent));
    svg.raw(&format!("<g transform=\"translate({:.1} {:.1}) rotate({degrees:.1})\">{body}</g>", at.0, at.1));
    let size = if words.len() > 1 { r * 1.15 } else { r * 1.45 };
    svg.text(
        (at.0, at.1 + size * 0.36),
        words,
        &format!(
            "font-size=\"{size:.1}\" text-anchor=\"middle\" fill=\"#ffffff\" stroke=\"#ffffff\" stroke-width=\"0.6\""
        ),
    );
}

#[cfg(test)]
mod tests {
    use socrates_model::{Event, Gesture, SimTime};

    use super::*;
    use crate::fixture::{away, hall, human, recording, robot, walk};

    fn sheet(run: &Recording) -> String {
        contact_sheet("r07", &hall("hall"), run, 8, Signs::Numbers)
    }

    #[test]
    fn a_sheet_has_the_ways_and_so_many_stills_with_their_times_and_is_always_the_same() {
        let run = walk(2);
        let svg = sheet(&run);
        assert_eq!(svg, sheet(&run));
        assert_eq!(svg.matches("<clipPath").count(), 9);
        for words in [">r07<", ">0.0 s<", ">6.0 s<", "walk: R 1 2"] {
            assert!(svg.contains(words), "{words}");
        }
        assert!(crate::png_from_svg(&svg, 1.0).is_ok());
    }

    #[test]
    fn a_sheet_names_neither_run_nor_planner() {
        let svg = sheet(&walk(2));
        for hidden in ["reference", "test", "seed", "native", "hall"] {
            assert!(!svg.contains(hidden), "{hidden}");
        }
    }

    #[test]
    fn stills_are_taken_while_robot_and_person_are_near_each_other() {
        // From 20 m away a person comes to 10 m: never near. From 12 m to 2 m: near from 4 s on.
        let run = |from_m: f64| {
            let ticks: Vec<Vec<AgentState>> = (0..=1000)
                .map(|tick| vec![robot(0.0, 1.0, 0.0, 0.0), human(1, from_m - f64::from(tick) / 100.0, 1.0, -1.0, 0.0)])
                .collect();
            recording(&ticks.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        let span = |run: &Recording| {
            Scene { location: &hall("hall"), recording: run, there: There::of(run), signs: Signs::Numbers }.span_s()
        };
        assert_eq!(span(&run(20.0)), (0.0, 10.0));
        let (from, to) = span(&run(12.0));
        assert!((from - 4.0).abs() < 0.11 && (to - 10.0).abs() < 1e-9, "{from} {to}");
        // Somebody who is not there is not near.
        assert_eq!(span(&away(run(12.0), 1, 0..1001)), (0.0, 10.0));
    }

    #[test]
    fn who_stands_who_walks_and_what_was_said_between_two_stills_is_written_under_them() {
        let tick = |x: f64| vec![robot(1.0 + x, 1.0, 1.0, 0.0), human(1, 5.0, 2.0, 0.0, 0.0)];
        let ticks: Vec<Vec<AgentState>> = (0..=400).map(|tick_no| tick(f64::from(tick_no) / 100.0)).collect();
        let mut run = recording(&ticks.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let agent = AgentId::from_number(1);
        let kind = EventKind::Gesture { agent, gesture: Some(Gesture::Wait), to: None };
        run.events = vec![Event { time: SimTime::from_nanos(1_300_000_000), kind }];
        let svg = sheet(&run);
        assert!(svg.contains("walk: R · stand: 1"), "{svg}");
        assert_eq!(svg.matches("1 says WAIT at 1.3 s").count(), 1, "under the still after it alone");
    }

    #[test]
    fn a_sheet_with_letters_numbers_its_pictures_and_shows_no_number_of_a_person() {
        let run = walk(2);
        let svg = contact_sheet("a run", &hall("hall"), &run, 8, Signs::Letters);
        for words in ["walk: R A B", ">picture 0: all ways, 0 to 6.0 s<", ">picture 1 · 0.0 s<", ">picture 8 · 6.0 s<"]
        {
            assert!(svg.contains(words), "{words}: {svg}");
        }
        assert!(!svg.contains(">1<") && !svg.contains(">2<"));
        let names: Vec<String> = [0, 1, 17, 18, 25, 26, 51].map(|number| letter(AgentId::from_number(number))).to_vec();
        assert_eq!(names, ["R", "A", "Q", "S", "Z", "A2", "A3"]);
    }

    #[test]
    fn a_run_without_people_and_a_crowd_have_a_sheet_too() {
        for humans in [0, 60] {
            assert!(crate::png_from_svg(&sheet(&walk(humans)), 1.0).is_ok(), "{humans}");
        }
    }
}
