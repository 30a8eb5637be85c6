//! The film of a scenario: seen from above, near enough to see people, after what happens.

use socrates_model::{Action, HumanId, Location, Recording, Report};

use crate::actor::{self, Look, text_px};
use crate::camera::{Camera, least_px};
use crate::film_cards::{draw_end, draw_title};
use crate::film_eyes::Eyes;
use crate::film_times::{FIRST_SECS, Times};
use crate::label::{Area, text_width, wrapped};
use crate::map_layer::{draw_floor, wall_areas};
use crate::page_data::marks;
use crate::palette;
use crate::png::{Ground, PngError};
use crate::svg::Svg;

/// Most runs side by side.
pub const PANELS: usize = 4;
/// Seconds of the film for which a caption stands, and of the run where the film is slower.
const CAPTION_SECS: f64 = 2.0;
/// Lines that are told at once.
const CAPTIONS: usize = 3;
/// Least radius of an agent in films that are to be alike, px: so far away that it could not be seen at its own size.
const LEAST_ALIKE_PX: f64 = 5.0;
/// Height of a line of words, in heights of its letters.
pub(crate) const LINE: f64 = 1.5;

/// Where a film is seen from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Seen {
    /// From above.
    #[default]
    Above,
    /// By one of the people, who look where they go.
    By(HumanId),
}

/// How a film is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmOptions {
    /// Width and height, px.
    pub size: (u32, u32),
    /// Pictures per second.
    pub fps: u32,
    /// Names, clock, planner, captions and cards; without them a film can be shown to a person who must not know the planner.
    pub labels: bool,
    /// Simulated seconds per second; `None`: 1, or as fast as is needed to show all that happens in 20 s.
    pub speed: Option<f64>,
    /// Where it is seen from.
    pub seen: Seen,
    /// The part of the run that is shown, s; `None`: around what happens. After its end a run stands still.
    pub part: Option<(f64, f64)>,
    /// Whether films of different runs are to differ in nothing but what happens: the camera stands still, and nobody leaves a trail.
    pub alike: bool,
}

impl FilmOptions {
    /// 1280 by 720 px, 30 pictures a second, from above, with labels.
    pub const USUAL: Self =
        Self { size: (1280, 720), fps: 30, labels: true, speed: None, seen: Seen::Above, part: None, alike: false };
}

/// A run that a film shows, with what became of it for the card at the end.
#[derive(Debug, Clone)]
pub struct Shown<'a> {
    /// The run.
    pub recording: &'a Recording,
    /// Its report, where it has one.
    pub report: Option<&'a Report>,
    /// What stands for planner and seed; `None` for these themselves.
    pub name: Option<String>,
}

/// Why a film could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// There is nothing to show.
    #[error("the film has no run to show")]
    Empty,
    /// More runs than fit side by side.
    #[error("`{found}` runs cannot be shown side by side; at most {PANELS}")]
    Crowded {
        /// Runs asked for.
        found: usize,
    },
    /// A speed that is none.
    #[error("`{found}` is no speed; allowed: 0.1 to 20 simulated seconds per second")]
    Speed {
        /// Speed asked for.
        found: f64,
    },
    /// The size is impossible.
    #[error("a film of {width} by {height} px cannot be made; allowed: 160 to 3840 px a side, even numbers")]
    Size {
        /// Asked width, px.
        width: u32,
        /// Asked height, px.
        height: u32,
    },
    /// A part that is none.
    #[error("from {from_s} s to {to_s} s is no part of a run")]
    Part {
        /// Its first moment, s.
        from_s: f64,
        /// Its last moment, s.
        to_s: f64,
    },
    /// Nothing can be seen by somebody who is not there.
    #[error(
        "`{who}` is not in the run `{run}` at {at_s:.1} s, so nothing can be shown as they see it; people of the run: {people}"
    )]
    Absent {
        /// The person.
        who: HumanId,
        /// The run.
        run: String,
        /// When, s of the run.
        at_s: f64,
        /// Those who are there.
        people: String,
    },
    /// A picture could not be drawn.
    #[error("a picture of the film cannot be drawn")]
    Picture(#[source] PngError),
}

/// A film as a page plays it: see [`Film::strip`].
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Width and height, drawing units.
    pub size: (u32, u32),
    /// Pictures per second.
    pub fps: u32,
    /// Length, s.
    pub length_s: f64,
    /// What stays.
    pub ground: String,
    /// What moves, picture by picture.
    pub pictures: Vec<String>,
}

/// A film, ready to be drawn picture by picture.
#[derive(Debug)]
pub struct Film<'a> {
    /// Times and pictures of the film.
    pub times: Times,
    pub(crate) options: FilmOptions,
    pub(crate) title: &'a str,
    ground: Ground,
    pub(crate) panels: Vec<Panel<'a>>,
}

/// One run in its part of the picture.
#[derive(Debug)]
pub(crate) struct Panel<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) report: Option<&'a Report>,
    pub(crate) location: &'a Location,
    pub(crate) camera: Camera,
    pub(crate) at: (f64, f64),
    pub(crate) size: (f64, f64),
    /// The part with the map; above it is the clock.
    pub(crate) view: Area,
    pub(crate) title: String,
    pub(crate) look: Look,
    pub(crate) captions: Vec<(f64, String)>,
    /// Whose eyes it is seen with; none from above.
    pub(crate) eyes: Option<Eyes<'a>>,
}

impl Panel<'_> {
    /// Lower left corner of the line of letters with the clock.
    pub(crate) fn clock_at(&self) -> (f64, f64) {
        let size = self.look.text_px;
        (self.at.0 + size * 0.6, self.at.1 + size * 1.1)
    }

    /// The box of a caption, the newest in the lowest row.
    pub(crate) fn caption(&self, row: usize, words: &str) -> Area {
        let size = self.look.text_px;
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let up = size * (LINE * row as f64 + 0.3);
        let (w, h) = (text_width(words, size) + size * 0.8, size * LINE);
        Area { x: self.at.0 + size * 0.3, y: self.at.1 + self.size.1 - up - h, w, h }
    }

    /// Writes a caption on a light ground: the map goes on below it.
    pub(crate) fn draw_caption(&self, svg: &mut Svg, row: usize, words: &str) {
        let (size, area) = (self.look.text_px, self.caption(row, words));
        svg.rect((area.x, area.y), (area.w, area.h), "fill=\"#ffffff\" fill-opacity=\"0.88\"");
        svg.heading((area.x + size * 0.4, area.y + size * 1.1), words, size, palette::INK);
    }

    /// Draws what stays where it is while the camera does.
    fn draw_ground(&self, svg: &mut Svg, now_s: f64) {
        if let Some(eyes) = &self.eyes {
            eyes.draw_ground(svg);
            return;
        }
        let view = self.view;
        svg.rect((view.x, view.y), (view.w, view.h), &format!("fill=\"{}\"", palette::UNKNOWN));
        draw_floor(svg, self.location, &self.camera.part(now_s));
    }

    /// Draws what moves.
    fn draw_moving(&self, svg: &mut Svg, now_s: f64, labels: bool) {
        if let Some(eyes) = &self.eyes {
            eyes.draw(svg, now_s, self.look.text_px);
            return;
        }
        let (frame, part) = (self.camera.frame(now_s), self.camera.part(now_s));
        actor::draw_doors(svg, self.location, &frame, self.recording, now_s);
        let walls = if labels { wall_areas(self.location, &part) } else { Vec::new() };
        actor::draw_everybody(svg, self.location, &frame, self.recording, now_s, &self.look, &walls);
    }

    /// What is told at a moment, the newest first, for so many seconds of the run.
    pub(crate) fn told(&self, now_s: f64, secs: f64) -> impl Iterator<Item = String> {
        let fresh = self.captions.iter().filter(move |(t, _)| *t <= now_s + 1e-9 && now_s - t < secs);
        let size = self.look.text_px;
        fresh.rev().take(CAPTIONS).map(move |(_, words)| wrapped(words, self.size.0 - size * 1.6, size, 1).concat())
    }
}

impl<'a> Film<'a> {
    /// A film of the runs `shown`, side by side, of the scenario with this title; `all` are the runs of the scenario, so that
    /// the camera is as near in a film of each of them.
    ///
    /// # Errors
    /// [`FilmError`] when there is nothing to show, or too much, or the options are impossible.
    pub fn new(
        location: &'a Location,
        title: &'a str,
        all: &[&Recording],
        shown: &[Shown<'a>],
        options: FilmOptions,
    ) -> Result<Self, FilmError> {
        let (width, height) = options.size;
        if [width, height].iter().any(|side| !(160..=3840).contains(side) || side % 2 != 0) {
            return Err(FilmError::Size { width, height });
        }
        if shown.is_empty() {
            return Err(FilmError::Empty);
        }
        if shown.len() > PANELS {
            return Err(FilmError::Crowded { found: shown.len() });
        }
        let runs: Vec<&Recording> = shown.iter().map(|shown| shown.recording).collect();
        let times = Times::of(&runs, &options)?;
        let (columns, rows) = match shown.len() {
            1 => (1.0, 1.0),
            2 => (2.0, 1.0),
            _ => (2.0, 2.0),
        };
        let (w, h) = (f64::from(width), f64::from(height));
        let gap = if shown.len() == 1 { 0.0 } else { 4.0 };
        let size = ((w - gap * (columns - 1.0)) / columns, (h - gap * (rows - 1.0)) / rows);
        let mut panels = Vec::new();
        for (index, shown) in shown.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "at most four panels")]
            let at = ((index % 2) as f64 * (size.0 + gap), (index / 2) as f64 * (size.1 + gap));
            let (view, safe) = parts(at, size, text_px(h / rows), options.labels);
            let recording = shown.recording;
            let eyes = match options.seen {
                Seen::Above => None,
                Seen::By(who) => Some(Eyes::of(location, recording, who, view, (times.from_s, times.to_s))?),
            };
            let part = (times.from_s, times.to_s);
            let camera = if options.alike {
                Camera::still(location, all, part, (view, safe))
            } else {
                Camera::of(location, all, recording, part, (view, safe))
            };
            // Somebody drawn larger than they are seems to touch others.
            let least = if options.alike { LEAST_ALIKE_PX } else { least_px(view.h) / 2.0 };
            let look =
                Look::new(recording, (camera.px_per_m(location), least), text_px(h / rows), options.labels, safe);
            let look = if options.alike { look.without_trails() } else { look };
            let itself = || format!("{} · seed {}", recording.header.planner, recording.header.seed);
            let title = shown.name.clone().unwrap_or_else(itself);
            let mut captions = captions(recording);
            if runs.len() > 1 {
                // Side by side a caption says which run it is about.
                captions.iter_mut().for_each(|(_, words)| *words = format!("{title}: {words}"));
            }
            panels.push(Panel {
                recording,
                report: shown.report,
                location,
                camera,
                at,
                size,
                view,
                title,
                look,
                captions,
                eyes,
            });
        }
        let mut ground = Svg::new(w, h);
        ground.rect((0.0, 0.0), (w, h), "fill=\"#ffffff\"");
        let ground = Ground::new(&ground.finish()).map_err(FilmError::Picture)?;
        Ok(Self { times, options, title, ground, panels })
    }

    /// A picture: red, green, blue, row by row.
    ///
    /// # Errors
    /// [`FilmError::Picture`] when it cannot be drawn.
    pub fn picture(&self, index: usize) -> Result<Vec<u8>, FilmError> {
        self.ground.with(&self.drawing(self.times.picture_s(index))).map_err(FilmError::Picture)
    }

    /// A film of one run for a page: its ground, and what moves on it so many times a second, as parts of an SVG of the film's size.
    /// Nothing of it names a planner. A picture like the one before is left empty. For films that are [`FilmOptions::alike`]: the ground is
    /// that of a camera that stands still.
    #[must_use]
    pub fn strip(&self, fps: u32) -> Strip {
        let times = Times { fps: fps.max(1), ..self.times };
        let (mut ground, mut pictures) = (Svg::part(), Vec::new());
        let mut before = String::new();
        if let Some(panel) = self.panels.first() {
            panel.draw_ground(&mut ground, times.from_s);
            for index in 0..times.pictures() {
                let mut svg = Svg::part();
                panel.draw_moving(&mut svg, times.moment_s(index), false);
                let picture = svg.text_so_far();
                pictures.push(if picture == before { String::new() } else { picture.clone() });
                before = picture;
            }
        }
        let length_s = self.times.length_s();
        Strip { size: self.options.size, fps: times.fps, length_s, ground: ground.text_so_far(), pictures }
    }

    /// The picture at a time of the film as SVG, without the white below it.
    pub(crate) fn drawing(&self, film_s: f64) -> String {
        let now_s = self.times.at_film_s(film_s);
        let mut svg = Svg::new(f64::from(self.options.size.0), f64::from(self.options.size.1));
        for (index, panel) in self.panels.iter().enumerate() {
            let view = panel.view;
            // What is outside the camera of one panel must not be seen in the next one, nor under the words.
            svg.raw(&format!("<clipPath id=\"panel-{index}\">"));
            svg.rect((view.x, view.y), (view.w, view.h), "");
            svg.raw(&format!("</clipPath><g clip-path=\"url(#panel-{index})\">"));
            panel.draw_ground(&mut svg, now_s);
            panel.draw_moving(&mut svg, now_s, self.options.labels);
            svg.raw("</g>");
            if self.options.labels {
                self.draw_words(&mut svg, panel, now_s);
            }
        }
        if self.options.labels {
            if film_s < self.times.cards_s.0 - 1e-9 {
                draw_title(&mut svg, self);
            } else if film_s > self.times.length_s() - self.times.cards_s.1 + 1e-9 {
                self.panels.iter().for_each(|panel| draw_end(&mut svg, panel));
            }
        }
        svg.finish()
    }

    /// Seconds of the run for which a caption stands.
    pub(crate) fn caption_s(&self) -> f64 {
        CAPTION_SECS * self.times.speed.max(1.0)
    }

    /// How fast the film goes, in words; nothing where it goes as the run did.
    pub(crate) fn speed_words(&self) -> String {
        if (self.times.speed - 1.0).abs() < 1e-9 {
            return String::new();
        }
        format!(" ({}×)", (self.times.speed * 100.0).round() / 100.0)
    }

    fn draw_words(&self, svg: &mut Svg, panel: &Panel<'_>, now_s: f64) {
        let words = format!("{} · {now_s:.1} s{}", panel.title, self.speed_words());
        svg.heading(panel.clock_at(), &words, panel.look.text_px, palette::INK);
        // The newest ones, each on a line of its own, so that what comes fast is told as well.
        for (row, words) in panel.told(now_s, self.caption_s()).enumerate() {
            panel.draw_caption(svg, row, &words);
        }
    }
}

/// The part of a panel with the map, and the part of that in which no caption can hide anybody.
fn parts(at: (f64, f64), size: (f64, f64), text_px: f64, labels: bool) -> (Area, Area) {
    if !labels {
        let view = Area { x: at.0, y: at.1, w: size.0, h: size.1 };
        return (view, view);
    }
    let above = text_px * (LINE + 0.1);
    #[expect(clippy::cast_precision_loss, reason = "a few captions")]
    let below = text_px * (LINE * CAPTIONS as f64 + 0.3);
    let view = Area { x: at.0, y: at.1 + above, w: size.0, h: size.1 - above };
    (view, Area { h: view.h - below, ..view })
}

/// `h1` for `human_1`: as the names beside people are written.
pub(crate) fn short_names(words: &str) -> String {
    let mut out = String::new();
    let mut rest = words;
    while let Some((before, after)) = rest.split_once("human_") {
        out.push_str(before);
        out.push_str(if after.starts_with(|c: char| c.is_ascii_digit()) { "h" } else { "human_" });
        rest = after;
    }
    out.push_str(rest);
    out
}

/// What is told at the lower edge, with times: everything that happens at one moment in one line.
fn captions(recording: &Recording) -> Vec<(f64, String)> {
    let mut out: Vec<(f64, String)> = Vec::new();
    let (walks, stands) = (Action::Navigate.phrase(), Action::StandStill.phrase());
    for mark in marks(recording) {
        let (Some(t), Some(kind), Some(words)) = (
            mark.get(0).and_then(serde_json::Value::as_f64),
            mark.get(2).and_then(serde_json::Value::as_str),
            mark.get(3).and_then(serde_json::Value::as_str),
        ) else {
            continue;
        };
        // Somebody who walks, or stands there from the start, is seen, not told: it would be a line of names. Reactions are told.
        if kind == "leaf" && (words.ends_with(&walks) || t < FIRST_SECS && words.ends_with(&stands)) {
            continue;
        }
        let words = short_names(words);
        match out.last_mut() {
            Some((last, told)) if (*last - t).abs() < 1e-9 => *told = format!("{told}, {words}"),
            _ => out.push((t, words)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use socrates_model::EventKind;

    use super::*;
    use crate::fixture::{hall, report, walk};

    const SMALL: FilmOptions = FilmOptions { size: (320, 180), fps: 10, ..FilmOptions::USUAL };

    fn bare<'a>(runs: &[&'a Recording]) -> Vec<Shown<'a>> {
        runs.iter().map(|recording| Shown { recording, report: None, name: None }).collect()
    }

    fn film<'a>(location: &'a Location, runs: &[&'a Recording], options: FilmOptions) -> Film<'a> {
        Film::new(location, "they meet", runs, &bare(runs), options).unwrap()
    }

    #[test]
    fn the_same_run_gives_the_same_pictures_and_labels_can_be_left_out() {
        let (location, run) = (hall("hall"), walk(2));
        let picture = |labels: bool| film(&location, &[&run], FilmOptions { labels, ..SMALL }).picture(30).unwrap();
        assert_eq!(picture(true), picture(true));
        assert_eq!(picture(true).len(), 320 * 180 * 3);
        assert_ne!(picture(true), picture(false));
    }

    #[test]
    fn a_film_without_labels_names_no_planner_in_any_picture() {
        let (location, run) = (hall("hall"), walk(2));
        let words =
            |labels: bool, film_s: f64| film(&location, &[&run], FilmOptions { labels, ..SMALL }).drawing(film_s);
        assert!(words(true, 3.0).contains("reference") && words(true, 3.0).contains(">h2<"));
        for film_s in [0.0, 3.0, 99.0] {
            let words = words(false, film_s);
            assert!(
                !words.contains("reference") && !words.contains(">h2<") && !words.contains("they meet"),
                "{film_s}"
            );
        }
    }

    #[test]
    fn names_that_stand_for_the_planners_are_all_that_a_film_tells_of_them() {
        let (location, run) = (hall("hall"), walk(2));
        let report = report(&run, "9 of 9 setup clauses");
        let shown = ['A', 'B'].map(|letter| Shown {
            recording: &run,
            report: Some(&report),
            name: Some(format!("robot {letter}")),
        });
        let options = FilmOptions { size: (640, 360), ..SMALL };
        let film = Film::new(&location, "they meet", &[&run, &run], &shown, options).unwrap();
        for film_s in [0.0, 4.0, film.times.length_s() - 0.1] {
            let words = film.drawing(film_s);
            assert!(words.contains("robot A") && words.contains("robot B"), "{film_s}");
            assert!(!words.contains("reference"), "{film_s}");
        }
    }

    #[test]
    fn a_film_begins_with_a_title_and_ends_with_the_verdict() {
        let (location, run) = (hall("hall"), walk(2));
        let report = report(&run, "9 of 9 setup clauses");
        let shown = [Shown { recording: &run, report: Some(&report), name: None }];
        let options = FilmOptions { size: (640, 360), ..SMALL };
        let film = Film::new(&location, "they meet", &[&run], &shown, options).unwrap();
        let (first, middle, last) = (film.drawing(0.0), film.drawing(4.0), film.drawing(film.times.length_s() - 0.1));
        for (words, [begins, runs, ends]) in
            [("they meet", [true, false, false]), ("9 of 9", [false, false, true]), ("realised", [false, false, true])]
        {
            assert_eq!(
                [first.contains(words), middle.contains(words), last.contains(words)],
                [begins, runs, ends],
                "{words}"
            );
        }
        assert!(first.contains("reference · seed 1") && first.contains("h2"));
    }

    #[test]
    fn people_are_large_and_captions_hide_nobody_who_matters() {
        let (location, mut run) = (hall("hall"), walk(2));
        let opens = |n: u64| EventKind::Door { door: format!("door {n}"), open: true };
        let time = |n: u64| socrates_model::SimTime::from_nanos(1_900_000_000 + n * 20_000_000);
        run.events = (0..4).map(|n| socrates_model::Event { time: time(n), kind: opens(n) }).collect();
        let film = film(&location, &[&run], FilmOptions { size: (640, 360), ..SMALL });
        let panel = &film.panels[0];
        let size = panel.look.text_px;
        assert!(panel.clock_at().1 + 0.3 * size <= panel.view.y, "below the letters of the clock is the map");
        assert!((panel.view.y + panel.view.h - 360.0).abs() < 1e-9, "the map reaches the lower edge");
        let told: Vec<String> = panel.told(2.0, film.caption_s()).collect();
        assert_eq!(told, ["door 3 opens", "door 2 opens", "door 1 opens"]);
        let highest = panel.caption(told.len() - 1, &told[2]).y;
        for index in 0..film.times.pictures() {
            let now_s = film.times.moment_s(index);
            for state in actor::moment(&run, now_s) {
                let (_, y) = panel.camera.frame(now_s).px(&location, &state.point());
                let r = panel.look.radius_px(0.3);
                assert!(2.0 * r >= 40.0 - 1e-6, "{r}");
                assert!(state.agent != 0 || (y + r <= highest && y - r >= panel.view.y), "{y} at {now_s} s");
            }
        }
    }

    #[test]
    fn captions_use_the_names_beside_people_and_side_by_side_the_name_of_the_run() {
        let (location, mut run) = (hall("hall"), walk(2));
        let node = socrates_model::NodeId::new("m").unwrap();
        let kind = EventKind::Encounter { human: socrates_model::HumanId::new(2), node, gap_s: 0.4, nth: 1 };
        run.events = vec![socrates_model::Event { time: socrates_model::SimTime::from_nanos(3_000_000_000), kind }];
        let one = film(&location, &[&run], SMALL);
        assert!(one.panels[0].captions[0].1.starts_with("h2 and the robot meet"), "{:?}", one.panels[0].captions);
        let two = film(&location, &[&run, &run], FilmOptions { size: (640, 360), ..SMALL });
        assert!(two.panels[1].captions[0].1.starts_with("reference · seed 1: h2 and"), "{:?}", two.panels[1].captions);
        assert_eq!(short_names("human_12 and human_x"), "h12 and human_x");
    }

    #[test]
    fn nobody_walks_from_one_panel_into_the_next() {
        let (location, mut run) = (hall("hall"), walk(0));
        let still = walk(0);
        // Far to the right of the camera, in the middle of the second panel.
        for state in &mut run.frames {
            state.x += 7.0;
        }
        let film = |first: &Recording| {
            let options = FilmOptions { labels: false, ..SMALL };
            Film::new(&location, "", &[&still], &bare(&[first, &still]), options).unwrap().picture(15).unwrap()
        };
        let right_half = |picture: &[u8]| -> Vec<u8> {
            picture.chunks_exact(320 * 3).flat_map(|row| row.iter().skip(162 * 3).copied()).collect()
        };
        assert_eq!(right_half(&film(&run)), right_half(&film(&still)));
        assert_ne!(film(&run), film(&still));
    }

    #[test]
    fn what_cannot_be_filmed_is_refused() {
        let (location, run) = (hall("hall"), walk(0));
        let film = |shown: &[&Recording], options: FilmOptions| {
            Film::new(&location, "", &[&run], &bare(shown), options).map(|_| ()).unwrap_err().to_string()
        };
        assert!(film(&[], SMALL).contains("no run"));
        assert!(film(&[&run; 5], SMALL).contains("`5` runs"));
        assert!(film(&[&run], FilmOptions { size: (321, 180), ..SMALL }).contains("321"));
        assert!(film(&[&run], FilmOptions { speed: Some(f64::NAN), ..SMALL }).contains("NaN"));
    }
}
