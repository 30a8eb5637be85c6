//! What the player of every page shows: the floor of a place, and who is where at every moment.

use serde_json::{Value, json};
use socrates_model::{EventKind, Location, Point, Recording};

use crate::map_layer::{Frame, draw_floor, draw_graph};
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Size of a place's drawing units; pages scale them.
const SIZE: (f64, f64) = (1120.0, 720.0);
/// Samples per second of an animation, the finest first.
const SAMPLE_HZ: [u32; 4] = [10, 5, 2, 1];
/// A page holds at most about so many samples, or it would not open on a phone.
const SAMPLES: usize = 400_000;

/// The frame of a place in its drawing units.
pub(crate) fn frame(location: &Location) -> Frame {
    Frame::around(location, SIZE.0, SIZE.1, (0.0, 0.0))
}

/// The floor, walls and ways of a place as a group that views of the page refer to by its number.
pub(crate) fn floor(location: &Location, index: usize) -> String {
    let frame = frame(location);
    let mut svg = Svg::part();
    svg.raw(&format!("<g id=\"floor-{index}\" class=\"floor\">"));
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
    svg.raw("</g>");
    svg.text_so_far()
}

/// Floors of a page, out of sight.
pub(crate) fn floors<'a>(locations: impl IntoIterator<Item = &'a Location>) -> String {
    let floors: String = locations.into_iter().enumerate().map(|(index, location)| floor(location, index)).collect();
    format!("<svg class=\"floors\" aria-hidden=\"true\"><defs>{floors}</defs></svg>")
}

/// The places of a page of many scenarios, each drawn once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places(Vec<Location>);

impl Places {
    /// The number of a place.
    pub(crate) fn number(&mut self, location: &Location) -> usize {
        self.0.iter().position(|known| known == location).unwrap_or_else(|| {
            self.0.push(location.clone());
            self.0.len() - 1
        })
    }

    /// Their floors, out of sight.
    pub(crate) fn floors(&self) -> String {
        floors(&self.0)
    }

    /// What views need to know about them.
    pub(crate) fn told(&self) -> Vec<Value> {
        self.0.iter().enumerate().map(|(index, location)| place(location, index)).collect()
    }
}

/// What a view needs to know about a place.
pub(crate) fn place(location: &Location, index: usize) -> Value {
    let frame = frame(location);
    let (w, h) = frame.size();
    json!({ "index": index, "name": location.name, "whole": [0.0, 0.0, tenth(w), tenth(h)], "px_per_m": frame.len(location, 1.0) })
}

/// Where it happens, in drawing units: left, top, width, height. The same for every run of a scenario.
pub(crate) fn focus(location: &Location, way: &[Point], runs: &[&Recording]) -> [f64; 4] {
    let frame = frame(location);
    let seen: Vec<Point> = runs.iter().flat_map(|run| spread(run)).chain(way.iter().copied()).collect();
    let cells = Frame::focused(location, &seen, 1120.0, 640.0, (0.0, 0.0)).cells;
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    let place = |cell: usize, first: usize| tenth((cell as f64 - first as f64) * frame.scale);
    [place(cells.0, frame.cells.0), place(cells.1, frame.cells.1), place(cells.2, 0), place(cells.3, 0)]
}

/// Every position of a recording at which somebody is.
pub(crate) fn spread(recording: &Recording) -> impl Iterator<Item = Point> + '_ {
    let there = There::of(recording);
    recording.frames.iter().filter(move |state| there.is(state)).map(socrates_model::AgentState::point)
}

/// The finest rate at which these recordings together stay small enough for a page, Hz.
pub(crate) fn rate(runs: &[&Recording]) -> u32 {
    let samples = |hz: u32| -> usize {
        runs.iter().map(|run| run.ticks().div_ceil(ticks_per_sample(run, hz)) * run.header.agents.len()).sum()
    };
    SAMPLE_HZ.into_iter().find(|hz| samples(*hz) <= SAMPLES).unwrap_or(1)
}

/// Ticks of a recording from one sample to the next.
pub(crate) fn ticks_per_sample(recording: &Recording, hz: u32) -> usize {
    let ticks = (1.0 / recording.header.step_s.max(1e-4) / f64::from(hz.max(1))).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number of ticks")]
    let ticks = ticks as usize;
    ticks.max(1)
}

/// A recording as the player plays it. Tracks are flat lists of x, y (tenths of a drawing unit), heading (hundredths of
/// a radian) and gesture code, -1 while the agent is not there.
pub(crate) fn run(location: &Location, way: &[Point], recording: &Recording, hz: u32) -> Value {
    let frame = frame(location);
    let every = ticks_per_sample(recording, hz);
    let there = There::of(recording);
    let agents: Vec<Value> = recording
        .header
        .agents
        .iter()
        .map(|info| {
            let mut track: Vec<i64> = Vec::new();
            let mut last = [0_i64; 4];
            for state in recording.track(info.agent).step_by(every) {
                // Who is not there stays where it was, out of sight: nobody jumps to a corner.
                last[3] = -1;
                if there.is(state) {
                    let (x, y) = frame.px(location, &state.point());
                    last = [
                        whole(x * 10.0),
                        whole(y * 10.0),
                        whole(state.yaw * 100.0),
                        i64::from(socrates_model::Gesture::code_of(state.gesture())),
                    ];
                }
                track.extend(last);
            }
            json!({
                "name": info.agent.to_string(), "role": info.role, "color": palette::agent(info.agent.number()),
                "words": palette::agent_words(info.agent.number()), "number": info.agent.number(),
                "radius": tenth(frame.len(location, info.radius_m).clamp(3.0, 60.0)), "track": track,
            })
        })
        .collect();
    let doors: Vec<Value> = location
        .doors
        .iter()
        .map(|door| {
            let times: Vec<Value> = recording
                .events
                .iter()
                .filter_map(|event| {
                    let EventKind::Door { door: id, open } = &event.kind else { return None };
                    (*id == door.id).then(|| json!([event.time.secs(), open]))
                })
                .collect();
            let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
            json!({ "id": door.id, "line": [tenth(from.0), tenth(from.1), tenth(to.0), tenth(to.1)], "times": times })
        })
        .collect();
    let way: Vec<String> =
        way.iter().map(|point| frame.px(location, point)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    json!({ "hz": hz, "agents": agents, "doors": doors, "way": way.join(" ") })
}

/// A line of the story: its time and its words.
pub(crate) fn told(line: &str) -> Option<Value> {
    let (time, words) = line.trim_start().split_once(" s ")?;
    Some(json!([time.trim().parse::<f64>().ok()?, words.trim()]))
}

/// Rounded to a tenth.
pub(crate) fn tenth(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

#[expect(clippy::cast_possible_truncation, reason = "finite places on a map, far below 2^53")]
fn whole(x: f64) -> i64 {
    x.round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{hall, human, recording, robot, walk};

    #[test]
    fn a_sample_that_is_not_finite_repeats_the_one_before_out_of_sight() {
        let run_of = |x: f64| {
            let tick = [robot(1.0, 1.0, 0.0, 0.0)];
            let odd = [robot(x, 1.0, 0.0, 0.0)];
            let mut ticks: Vec<&[_]> = vec![&tick; 10];
            ticks.push(&odd);
            run(&hall("hall"), &[], &recording(&ticks), 10)["agents"][0]["track"].clone()
        };
        let track = run_of(f64::NAN);
        assert_eq!((&track[0], track[3].as_i64(), track[7].as_i64()), (&track[4], Some(0), Some(-1)));
        assert_ne!(run_of(2.0)[0], run_of(2.0)[4]);
    }

    #[test]
    fn a_line_of_the_story_is_a_time_and_words() {
        assert_eq!(told("  12.5 s  the robot stops"), Some(json!([12.5, "the robot stops"])));
        assert_eq!(told("nothing happened"), None);
    }

    #[test]
    fn a_crowd_is_sampled_more_coarsely() {
        let small = walk(3);
        assert_eq!(rate(&[&small]), 10);
        let crowd = walk(900);
        assert_eq!(rate(&[&crowd; 8]), 5);
        assert_eq!(ticks_per_sample(&small, 5), 20);
    }

    #[test]
    fn the_camera_is_that_of_all_runs_together() {
        let location = hall("hall");
        let (near, far) = (recording(&[&[robot(1.0, 1.0, 0.0, 0.0)]]), recording(&[&[human(1, 7.0, 2.0, 0.0, 0.0)]]));
        let bits = |runs: &[&Recording]| focus(&location, &[], runs).map(f64::to_bits);
        assert_eq!(bits(&[&near, &far]), bits(&[&far, &near]));
    }
}
