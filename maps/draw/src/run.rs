//! The picture of one run: where everybody went, and when.

use std::collections::BTreeSet;
use std::ops::Range;

use socrates_model::{
    AgentId, AgentState, EventKind, HumanId, Location, Paths, Point, Recording, Report, Verdict, ordinal,
};

use crate::label::{Area, Labels, text_width, wrapped, wrapped_beside};
use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_locator, draw_scale, scale_end_px, wall_areas};
use crate::marks::{draw_arrow, draw_body, draw_label, draw_legend, draw_line, draw_start, legend_px};
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Seconds between two time marks on a track.
const MARK_SECS: f64 = 5.0;
/// Below this speed somebody stands, m/s.
const STANDS_MPS: f64 = 0.1;

/// Nobody is drawn smaller, px.
const LEAST_RADIUS_PX: f64 = 7.0;
/// Height of the heading of a picture that has only a title, px.
const TITLE_PX: f64 = 50.0;
/// Most lines of the verdict's reason and of what the robot did: enough for a sentence with its cause at the end.
const LINES: usize = 4;
/// Most lines of what was asked for.
const ASKED_LINES: usize = 3;
/// The time of an encounter stands within so many rings around its mark: nobody must look for the mark of a time.
const TIME_RINGS: usize = 3;
/// From one line of the heading to the next, px.
const LINE_PX: f64 = 18.0;
/// Room of the small map beside the heading, px.
const LOCATOR_PX: (f64, f64) = (190.0, 96.0);

/// What stands over the picture of a run.
#[derive(Debug, Clone, Copy)]
pub struct Heading<'a> {
    /// The first line.
    pub title: &'a str,
    /// What was asked for, in words; nothing is drawn where it is empty.
    pub asked: &'a str,
}

/// Draws the part of the map where it happens, every track with marks every 5 s, starts, ends and encounters, and a legend.
#[must_use]
pub fn run_picture(
    location: &Location,
    recording: &Recording,
    paths: Option<&Paths>,
    report: Option<&Report>,
    heading: Heading<'_>,
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
    let mut frame = Frame::focused(location, &seen, 1160.0, 800.0, (20.0, TITLE_PX));
    let focused = frame.cells != Frame::around(location, 1160.0, 800.0, (20.0, TITLE_PX)).cells;
    let (w, h) = frame.size();
    let width = (w + 40.0).max(760.0);
    let beside = if focused { width - 40.0 - LOCATOR_PX.0 - 20.0 } else { width - 40.0 };
    let told = report.map(|report| Told::of(report, heading.asked, beside, width - 40.0));
    let locator = if focused { LOCATOR_PX.1 + 22.0 } else { 0.0 };
    let head = told.as_ref().map_or(TITLE_PX, Told::bottom).max(locator);
    // A map that is narrower than the words stands in their middle.
    frame.at = ((width - w) / 2.0, head);
    let marks = marks_told(location, width - 20.0 - scale_end_px(location, &frame), paths.is_some());
    #[expect(clippy::cast_precision_loss, reason = "a few lines")]
    let marks_px = marks.len().saturating_sub(MARKS_LINES) as f64 * MARKS_LINE_PX;
    let height = head + h + 40.0 + marks_px + legend_px(recording.header.agents.len()) + 14.0;
    let mut svg = Svg::new(width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    if focused {
        draw_locator(&mut svg, location, &frame, width - 20.0, 10.0, LOCATOR_PX);
    }
    svg.heading((20.0, 34.0), &wrapped(heading.title, beside, 24.0, 1).concat(), 24.0, palette::INK);
    if let Some(told) = told {
        told.draw(&mut svg);
    }
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
    let line: Vec<(f64, f64)> = way.iter().map(|p| frame.px(location, p)).collect();
    svg.polyline(
        &line,
        &format!("stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"3 5\" stroke-opacity=\"0.7\"", palette::ROBOT),
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
    let met = draw_encounters(&mut svg, location, recording, &frame, &mut labels);
    // Words come last: by now it is known what they must not hide. Times first, for they stay at their marks.
    for mark in &met {
        draw_time(&mut svg, &mut labels, mark);
    }
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
    svg.rect(frame.at, (w, h), &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"1\"", palette::GRAPH));
    draw_scale(&mut svg, location, &frame, 18.0);
    let style = format!("font-size=\"{MARKS_PX}\" text-anchor=\"end\" fill=\"{}\"", palette::QUIET);
    let mut y = frame.at.1 + h + 18.0;
    for line in &marks {
        svg.text((width - 20.0, y), line, &style);
        y += MARKS_LINE_PX;
    }
    let legend = legend(recording);
    draw_legend(&mut svg, &legend, width, head + h + 54.0 + marks_px);
    svg.finish()
}

/// Everybody's number and words for the legend.
fn legend(recording: &Recording) -> Vec<(u32, String)> {
    recording
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
        .collect()
}

/// Size of the words that say what each mark means, px.
const MARKS_PX: f64 = 13.0;
/// From one line of them to the next, px.
const MARKS_LINE_PX: f64 = MARKS_PX + 3.0;
/// Lines of them that have room above the legend; each further one moves it down.
const MARKS_LINES: usize = 2;

/// What each mark means, in lines no wider than `room`.
fn marks_told(location: &Location, room: f64, planned: bool) -> Vec<String> {
    let every = format!("arrow: every {MARK_SECS:.0} s");
    let told = [
        (true, "outline: start"),
        (true, "filled: end"),
        (true, &every),
        (planned, "diamond: robot and person nearest to each other"),
        (planned, "dots: intended way"),
        (!location.doors.is_empty(), "dashes: door"),
        (true, "gray lines: ways of the map"),
    ];
    let told: Vec<&str> = told.into_iter().filter(|(drawn, _)| *drawn).map(|(_, what)| what).collect();
    let lines = wrapped(&told.join(" · "), room, MARKS_PX, 4);
    lines.iter().map(|line| line.trim_matches([' ', '·']).to_owned()).collect()
}

/// What the heading tells of a run: what was asked for, the verdict with the reason beside it, and what the robot did, in lines.
struct Told {
    asked: Vec<String>,
    verdict: String,
    color: &'static str,
    pill: f64,
    reason: Vec<String>,
    robot: Vec<String>,
}

/// Where a line of the heading is, px, by how many lines there are above it.
fn line_y(above: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few lines")]
    let above = above as f64;
    63.0 + above * LINE_PX
}

impl Told {
    /// In lines `beside` the small map, and `below` it.
    fn of(report: &Report, asked: &str, beside: f64, below: f64) -> Self {
        let good = matches!(report.verdict, Verdict::Realised | Verdict::RealisedLate);
        let verdict = report.verdict.name().replace('_', " ");
        let pill = text_width(&verdict, 15.0) + 22.0;
        let room = |y: f64| if y > LOCATOR_PX.1 + 10.0 + LINE_PX { below } else { beside };
        let mut asked = wrapped_beside(asked, |line| room(line_y(line)), 14.0, ASKED_LINES);
        asked.retain(|line| !line.is_empty());
        let mut told = Self {
            asked,
            color: if good { palette::GOOD } else { palette::BAD },
            reason: vec![],
            robot: vec![],
            verdict,
            pill,
        };
        // Names stand in `code` marks in texts; here there is nothing that would draw them.
        let text = report.verdict_text.replace('`', "");
        told.reason = wrapped_beside(&text, |line| room(told.y(line)) - pill - 12.0, 15.0, LINES);
        let robot = format!("{} · seed {}", report.robot_text, report.seed);
        told.robot = wrapped_beside(&robot, |line| room(told.robot_y(line)), 14.0, LINES);
        told
    }

    /// Where the line of this number of the reason is, px: below what was asked for, a little apart.
    fn y(&self, line: usize) -> f64 {
        line_y(self.asked.len() + line) + if self.asked.is_empty() { 0.0 } else { 8.0 }
    }

    /// Lines of the robot begin below those of the reason, a little apart.
    fn robot_y(&self, line: usize) -> f64 {
        self.y(self.reason.len() + line) + 9.0
    }

    fn bottom(&self) -> f64 {
        self.robot_y(self.robot.len()) - 8.0
    }

    fn draw(&self, svg: &mut Svg) {
        let quiet = format!("font-size=\"14\" fill=\"{}\"", palette::QUIET);
        let ink = format!("font-size=\"15\" fill=\"{}\"", palette::INK);
        for (line, text) in self.asked.iter().enumerate() {
            svg.text((20.0, line_y(line)), text, &format!("font-size=\"14\" fill=\"{}\"", palette::INK));
        }
        svg.rect((20.0, self.y(0) - 17.0), (self.pill, 24.0), &format!("rx=\"12\" fill=\"{}\"", self.color));
        svg.text(
            (20.0 + self.pill / 2.0, self.y(0)),
            &self.verdict,
            "font-size=\"15\" text-anchor=\"middle\" fill=\"#ffffff\" stroke=\"#ffffff\" stroke-width=\"0.6\"",
        );
        for (line, text) in self.reason.iter().enumerate() {
            svg.text((32.0 + self.pill, self.y(line)), text, &ink);
        }
        for (line, text) in self.robot.iter().enumerate() {
            svg.text((20.0, self.robot_y(line)), text, &quiet);
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
    frame.len(location, radius_m).max(LEAST_RADIUS_PX)
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
    let robot = agent == AgentId::Robot;
    let apart = (start.0 - end.0).hypot(start.1 - end.1);
    draw_body(svg, end, last.yaw, robot, radius, color);
    if apart > 1.0 {
        // Where both lie on each other the start is a small outline on top.
        let small = if apart < 2.0 * radius { 0.5 } else { 1.0 };
        draw_start(svg, start, robot, radius * small, color, 3.0 * small.max(0.7));
    }
    for (x, y) in [start, end] {
        labels.block(Area { x: x - radius, y: y - radius, w: radius * 2.0, h: radius * 2.0 });
    }
}

/// The people who meet the robot more than once.
pub(crate) fn several(recording: &Recording) -> BTreeSet<HumanId> {
    let again =
        |kind: &EventKind| if let EventKind::Encounter { human, nth: 2.., .. } = kind { Some(*human) } else { None };
    recording.events.iter().filter_map(|event| again(&event.kind)).collect()
}

/// An encounter on the map: the middle between the robot and the person where they were nearest, who that was and when.
#[derive(Debug, Clone, PartialEq)]
struct Met {
    at: (f64, f64),
    human: HumanId,
    words: String,
}

/// Half the height of the diamond of an encounter, px.
const DIAMOND_PX: f64 = 8.0;

/// Where the robot and a human are nearest to each other in these ticks, with the first such tick; none where one of them is never there.
fn nearest(recording: &Recording, human: HumanId, ticks: Range<usize>) -> Option<(usize, Point, Point)> {
    let there = There::of(recording);
    let of = |states: &[AgentState], agent: u32| {
        states.iter().find(|state| state.agent == agent && there.is(state)).map(AgentState::point)
    };
    let both = ticks.filter_map(|tick| {
        let states = recording.tick(tick);
        Some((tick, of(states, 0)?, of(states, human.number())?))
    });
    both.min_by(|(_, a, b), (_, c, d)| (a - b).norm().total_cmp(&(c - d).norm()))
}

/// Draws each encounter where the two were nearest to each other, with a line between them. Of several with one human each has the
/// ticks that are nearer to it than to the others.
fn draw_encounters(
    svg: &mut Svg,
    location: &Location,
    recording: &Recording,
    frame: &Frame,
    labels: &mut Labels,
) -> Vec<Met> {
    let again = several(recording);
    let encounters: Vec<(HumanId, u32, usize)> = recording
        .events
        .iter()
        .filter_map(|event| {
            let EventKind::Encounter { human, nth, .. } = &event.kind else { return None };
            Some((*human, *nth, usize::try_from(event.time.tick()).unwrap_or(usize::MAX)))
        })
        .collect();
    let mut met = Vec::new();
    for (human, nth, tick) in &encounters {
        let own = encounters.iter().filter(|(other, ..)| other == human).map(|(.., at)| *at);
        let before = own.clone().filter(|at| at < tick).max().map_or(0, |at| usize::midpoint(at, *tick));
        let after = own.filter(|at| at > tick).min().map_or_else(|| recording.ticks(), |at| usize::midpoint(at, *tick));
        let Some((tick, robot, person)) = nearest(recording, *human, before..after) else { continue };
        let (from, to) = (frame.px(location, &robot), frame.px(location, &person));
        let (x, y) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        // Both ends: on crossing tracks nothing else tells who was where at that time.
        svg.line(from, to, "stroke=\"#ffffff\" stroke-width=\"3.4\" stroke-opacity=\"0.8\"");
        svg.line(from, to, &format!("stroke=\"{}\" stroke-width=\"1.4\"", palette::human(human.number())));
        svg.raw(&format!(
            "<path class=\"encounter\" d=\"M{x:.1} {:.1}l8 8l-8 8l-8 -8z\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.4\"/>",
            y - DIAMOND_PX,
            palette::human(human.number())
        ));
        labels.block(Area { x: x - DIAMOND_PX, y: y - DIAMOND_PX, w: 2.0 * DIAMOND_PX, h: 2.0 * DIAMOND_PX });
        let which = if again.contains(human) { format!("{}: ", ordinal(*nth)) } else { String::new() };
        #[expect(clippy::cast_precision_loss, reason = "a run has far fewer than 2^53 ticks")]
        let secs = tick as f64 * recording.header.step_s;
        met.push(Met { at: (x, y), human: *human, words: format!("{which}{secs:.1} s") });
    }
    met
}

/// The time of an encounter, in the color of whoever was met, right at its mark.
fn draw_time(svg: &mut Svg, labels: &mut Labels, mark: &Met) {
    const SIZE_PX: f64 = 15.0;
    let size = (text_width(&mark.words, SIZE_PX) + 4.0, SIZE_PX + 2.0);
    let area = labels.place_within(mark.at, size, DIAMOND_PX + 2.0, TIME_RINGS);
    let base = (area.x + area.w / 2.0, area.y + SIZE_PX - 1.0);
    svg.label(base, &mark.words, SIZE_PX, palette::agent_words(mark.human.number()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{hall, walk};

    const A_RUN: Heading<'static> = Heading { title: "a run", asked: "" };

    #[test]
    fn what_was_asked_for_stands_above_the_verdict() {
        let run = walk(1);
        let report = crate::fixture::report(&run, "9 of 9 setup clauses");
        let asked = "Task: bring the mail to the desk. Scenario: somebody comes towards the robot in a corridor.";
        let told = Told::of(&report, asked, 300.0, 300.0);
        let bare = Told::of(&report, "", 300.0, 300.0);
        let words = |lines: &[String]| lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
        assert_eq!((words(&told.asked), bare.asked.len()), (asked.to_owned(), 0));
        assert!(told.asked.len() > 1 && told.y(0) > line_y(told.asked.len() - 1) + 20.0, "the verdict is below it");
        assert!(told.bottom() > bare.bottom());
        let drawn = |asked| run_picture(&hall("hall"), &run, None, Some(&report), Heading { title: "a run", asked });
        assert!(drawn(asked).contains(">Task: bring the mail") && !drawn("").contains("Task"));
    }

    #[test]
    fn a_long_reason_goes_on_in_lines_and_the_map_moves_down() {
        let run = walk(1);
        let short = Told::of(&crate::fixture::report(&run, "9 of 9 setup clauses"), "", 900.0, 900.0);
        assert_eq!((short.reason.len(), short.robot_y(0)), (1, 90.0));
        let why = "9 of 10 setup clauses · encounter gap 0.0 s · c6: trigger at 6.6 s (when the robot says EXCUSE_ME), \
                   but human_1 never gives way to the robot";
        let long = Told::of(&crate::fixture::report(&run, why), "", 700.0, 700.0);
        assert!(long.reason.len() > 1 && long.bottom() > short.bottom(), "{:?}", long.reason);
        let words = |text: &str| text.split([' ', '·']).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
        assert_eq!(words(&long.reason.join(" ")), words(why), "nothing of the cause is cut");
    }

    /// The boxes of everything that is written with a rim, left to right as in the drawing, with its words.
    fn written(svg: &str) -> Vec<(String, Area)> {
        let value = |line: &str, key: &str| -> f64 {
            line.split_once(&format!(" {key}=\"")).unwrap().1.split('"').next().unwrap().parse().unwrap()
        };
        let rims = svg.lines().filter(|line| line.starts_with("<text") && line.contains("stroke-width=\"4.5\""));
        rims.map(|line| {
            let words = line.split_once('>').unwrap().1.trim_end_matches("</text>").to_owned();
            let (x, y, size) = (value(line, "x"), value(line, "y"), value(line, "font-size"));
            let w = text_width(&words, size);
            (words, Area { x: x - w / 2.0, y: y - size * 0.8, w, h: size })
        })
        .collect()
    }

    #[test]
    fn a_time_stands_at_its_mark_even_where_several_meet_the_robot_at_once() {
        let mut run = walk(3);
        let node = socrates_model::NodeId::new("m").unwrap();
        run.events = (1..=3_u32)
            .map(|n| {
                let kind = EventKind::Encounter { human: HumanId::new(n), node: node.clone(), gap_s: 0.4, nth: 1 };
                socrates_model::Event {
                    time: socrates_model::SimTime::from_nanos(2_900_000_000 + u64::from(n) * 100_000_000),
                    kind,
                }
            })
            .collect();
        let svg = run_picture(&hall("hall"), &run, None, None, A_RUN);
        let written = written(&svg);
        let marks = svg.lines().filter(|line| line.contains("class=\"encounter\""));
        for (n, path) in (1..=3_u32).zip(marks) {
            let (tick, ..) = nearest(&run, HumanId::new(n), 0..run.ticks()).unwrap();
            let time = format!("{:.1} s", f64::from(u32::try_from(tick).unwrap()) * run.header.step_s);
            let (x, y) = path.split_once(" d=\"M").unwrap().1.split_once('l').unwrap().0.split_once(' ').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse::<f64>().unwrap() + DIAMOND_PX);
            let away = |area: &Area| (x - x.clamp(area.x, area.x + area.w)).hypot(y - y.clamp(area.y, area.y + area.h));
            let own = written.iter().filter(|(words, _)| *words == time).map(|(_, area)| away(area));
            let away = own.min_by(f64::total_cmp).unwrap();
            // A pixel of a drawing is 25.4 / 96 mm.
            assert!(away * 25.4 / 96.0 < 9.0, "{time} stands {away:.0} px from its mark");
        }
        for (i, (one, a)) in written.iter().enumerate() {
            for (other, b) in written.iter().skip(i + 1) {
                assert!(a.overlap(b) < 4.0, "`{one}` and `{other}`");
            }
        }
    }

    #[test]
    fn an_encounter_is_drawn_where_both_were_nearest() {
        let run = walk(1);
        let (tick, robot, person) = nearest(&run, HumanId::new(1), 0..run.ticks()).unwrap();
        let apart = |tick: usize| {
            let states = run.tick(tick);
            (states[0].point() - states[1].point()).norm()
        };
        assert!((0..run.ticks()).all(|other| apart(other) >= (robot - person).norm() - 1e-12), "{tick}");
        assert!(nearest(&run, HumanId::new(7), 0..run.ticks()).is_none(), "nobody is there");
    }

    #[test]
    fn the_robot_is_a_square_and_people_are_discs() {
        let svg = run_picture(&hall("hall"), &walk(2), None, None, A_RUN);
        // One end of the robot on the map and its sign in the legend; two people have both as well.
        assert_eq!(svg.matches("<rect x=\"-").count(), 2, "{svg}");
        assert_eq!(svg.matches("<circle r=").count(), 4);
    }

    #[test]
    fn a_picture_without_a_verdict_has_no_empty_band() {
        let svg = run_picture(&hall("hall"), &walk(1), None, None, A_RUN);
        // The floor is the first thing that has the edges of cells.
        let floor = svg.lines().find(|line| line.contains("crispEdges")).unwrap();
        let top: f64 = floor.split_once(" y=\"").unwrap().1.split('"').next().unwrap().parse().unwrap();
        assert!(top <= TITLE_PX + 1.0, "{top}");
    }
}
