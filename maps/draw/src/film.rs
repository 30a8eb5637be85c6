//! The film of a scenario: seen from above, the same camera for every planner.
//!
//! ```text
//! shot (camera, times) ─┬─► pictures, one by one ─► ffmpeg, GIF
//!                       └─► animated SVG
//! ```

use socrates_model::{Action, EventKind, Location, Paths, Point, Recording};

use crate::actor::{self, Look, text_px};
use crate::label::{Area, wrapped};
use crate::map_layer::{Frame, draw_floor};
use crate::page_data::marks;
use crate::palette;
use crate::play::spread;
use crate::png::{Ground, PngError};
use crate::svg::Svg;

/// Seconds a film stands still before and after the run.
const STILL_SECS: f64 = 1.0;
/// Longest film, s.
pub const LONGEST_SECS: f64 = 20.0;
/// Most runs side by side.
pub const PANELS: usize = 4;
/// Seconds of the film for which a caption stands, and of the run where the film is slower.
const CAPTION_SECS: f64 = 2.0;
/// So many are told at once.
const CAPTIONS: usize = 3;
/// Height of a line of words beside the map, in heights of its letters.
const LINE: f64 = 1.5;
/// What begins within so long is how somebody starts, s.
const FIRST_SECS: f64 = 0.5;

/// How a film is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmOptions {
    /// Width and height, px.
    pub size: (u32, u32),
    /// Pictures per second.
    pub fps: u32,
    /// Names, clock, planner and captions; without them a film can be shown to a person who must not know the planner.
    pub labels: bool,
    /// Simulated seconds per second; `None`: 1, or as fast as is needed to show the whole run in 20 s.
    pub speed: Option<f64>,
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
    /// A picture could not be drawn.
    #[error("a picture of the film cannot be drawn")]
    Picture(#[source] PngError),
}

/// A film, ready to be drawn picture by picture.
#[derive(Debug)]
pub struct Film<'a> {
    /// Times and pictures of the film.
    pub times: Times,
    pub(crate) options: FilmOptions,
    ground: Ground,
    pub(crate) panels: Vec<Panel<'a>>,
}

/// Which part of the run a film shows, and how fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// First moment of the run, s.
    pub from_s: f64,
    /// Last moment of the run, s.
    pub to_s: f64,
    /// Simulated seconds per second.
    pub speed: f64,
    /// Pictures per second.
    pub fps: u32,
}

impl Times {
    /// Length of the film, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        2.0 * STILL_SECS + (self.to_s - self.from_s) / self.speed
    }

    /// Number of pictures.
    #[must_use]
    pub fn pictures(&self) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 20 s")]
        let count = (self.length_s() * f64::from(self.fps)).round() as usize;
        count.max(1)
    }

    /// The moment of the run that a picture shows, s.
    #[must_use]
    pub fn moment_s(&self, picture: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "at most some thousand pictures")]
        let film_s = picture as f64 / f64::from(self.fps.max(1));
        self.at_film_s(film_s)
    }

    /// The moment of the run at a time of the film, s.
    pub(crate) fn at_film_s(&self, film_s: f64) -> f64 {
        (self.from_s + (film_s - STILL_SECS).max(0.0) * self.speed).min(self.to_s)
    }

    /// When a moment of the run is seen first in the film, s: from the start where the run begins with it, to the end
    /// where it comes later.
    pub(crate) fn film_s(&self, moment_s: f64) -> f64 {
        if moment_s <= self.from_s {
            0.0
        } else if moment_s >= self.to_s {
            self.length_s()
        } else {
            STILL_SECS + (moment_s - self.from_s) / self.speed
        }
    }
}

/// One run in its part of the picture.
#[derive(Debug)]
pub(crate) struct Panel<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) location: &'a Location,
    pub(crate) frame: Frame,
    pub(crate) at: (f64, f64),
    pub(crate) size: (f64, f64),
    /// The part with the map: above it is the clock, below it the captions.
    pub(crate) view: Area,
    pub(crate) title: String,
    pub(crate) look: Look,
    pub(crate) captions: Vec<(f64, String)>,
}

impl Panel<'_> {
    /// Lower left corner of the line of letters with the clock.
    pub(crate) fn clock_at(&self) -> (f64, f64) {
        let size = self.look.text_px;
        (self.at.0 + size * 0.6, self.at.1 + size * 1.1)
    }

    /// Lower left corner of a caption, the newest in the lowest row.
    pub(crate) fn caption_at(&self, row: usize) -> (f64, f64) {
        let size = self.look.text_px;
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let up = size * LINE * row as f64;
        (self.at.0 + size * 0.6, self.at.1 + self.size.1 - up - size * 0.5)
    }

    /// What is told at a moment, the newest first, for so many seconds of the run.
    pub(crate) fn told(&self, now_s: f64, secs: f64) -> impl Iterator<Item = String> {
        let fresh = self.captions.iter().filter(move |(t, _)| *t <= now_s + 1e-9 && now_s - t < secs);
        let size = self.look.text_px;
        fresh.rev().take(CAPTIONS).map(move |(_, words)| wrapped(words, self.size.0 - size * 1.2, size, 1).concat())
    }
}

/// The times of a film of these runs.
///
/// # Errors
/// [`FilmError::Speed`] for a speed outside 0.1 to 20.
pub fn times(shown: &[&Recording], options: &FilmOptions) -> Result<Times, FilmError> {
    let whole = shown.iter().map(|run| length_s(run)).fold(0.0, f64::max);
    let room = LONGEST_SECS - 2.0 * STILL_SECS;
    let speed = match options.speed {
        Some(found) if !(0.1..=20.0).contains(&found) => return Err(FilmError::Speed { found }),
        Some(speed) => speed,
        // Rounded up to a tenth, so that it can be told in words.
        None => ((whole / room * 10.0 - 1e-9).ceil() / 10.0).max(1.0),
    };
    let most = room * speed;
    let (from_s, to_s) = if whole <= most {
        (0.0, whole)
    } else {
        let middle = shown.first().map_or(whole / 2.0, |run| heart_s(run));
        let from = (middle - most / 2.0).clamp(0.0, whole - most);
        (from, from + most)
    };
    Ok(Times { from_s, to_s, speed, fps: options.fps.max(1) })
}

/// Length of a recording, s.
fn length_s(recording: &Recording) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a recording has fewer than 2^53 ticks")]
    let ticks = recording.ticks().saturating_sub(1) as f64;
    ticks * recording.header.step_s
}

/// When it happens: the first encounter, else the moment of the smallest distance between robot and human.
fn heart_s(recording: &Recording) -> f64 {
    let met = recording.events.iter().find(|event| matches!(event.kind, EventKind::Encounter { .. }));
    if let Some(event) = met {
        return event.time.secs();
    }
    let curve = crate::series::curves(recording, 10).distance_m;
    let nearest = curve.iter().enumerate().filter_map(|(index, gap)| Some((index, (*gap)?)));
    let least = nearest.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
    #[expect(clippy::cast_precision_loss, reason = "a recording has fewer than 2^53 ticks")]
    let ticks = least as f64 * 10.0;
    ticks * recording.header.step_s
}

/// The camera of a scenario for a picture of this size: the same for all of its runs.
pub(crate) fn camera(
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

impl<'a> Film<'a> {
    /// A film of the runs `shown`, side by side, with the camera of `all` runs of the scenario.
    ///
    /// # Errors
    /// [`FilmError`] when there is nothing to show, or too much, or the options are impossible.
    pub fn new(
        location: &'a Location,
        paths: Option<&Paths>,
        all: &[&Recording],
        shown: &[&'a Recording],
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
        let times = times(shown, &options)?;
        let (columns, rows) = match shown.len() {
            1 => (1.0, 1.0),
            2 => (2.0, 1.0),
            _ => (2.0, 2.0),
        };
        let (w, h) = (f64::from(width), f64::from(height));
        let gap = if shown.len() == 1 { 0.0 } else { 4.0 };
        let size = ((w - gap * (columns - 1.0)) / columns, (h - gap * (rows - 1.0)) / rows);
        let mut ground = Svg::new(w, h);
        ground.rect((0.0, 0.0), (w, h), "fill=\"#ffffff\"");
        let mut panels = Vec::new();
        for (index, recording) in shown.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "at most four panels")]
            let at = ((index % 2) as f64 * (size.0 + gap), (index / 2) as f64 * (size.1 + gap));
            let view = view(at, size, text_px(h / rows), options.labels);
            let frame = camera(location, paths, all, (view.w, view.h), (view.x, view.y));
            ground.rect((view.x, view.y), (view.w, view.h), &format!("fill=\"{}\"", palette::UNKNOWN));
            draw_floor(&mut ground, location, &frame);
            draw_edges(&mut ground, &view, options.labels);
            let header = &recording.header;
            let look = Look::new(recording, frame.len(location, 1.0), h / rows, options.labels, view);
            panels.push(Panel {
                recording,
                location,
                frame,
                at,
                size,
                view,
                title: format!("{} · seed {}", header.planner, header.seed),
                look,
                captions: captions(recording),
            });
        }
        let ground = Ground::new(&ground.finish()).map_err(FilmError::Picture)?;
        Ok(Self { times, options, ground, panels })
    }

    /// A picture: red, green, blue, row by row.
    ///
    /// # Errors
    /// [`FilmError::Picture`] when it cannot be drawn.
    pub fn picture(&self, index: usize) -> Result<Vec<u8>, FilmError> {
        self.ground.with(&self.drawing(self.times.moment_s(index))).map_err(FilmError::Picture)
    }

    /// What moves, at a moment of the run, as SVG without the ground.
    fn drawing(&self, now_s: f64) -> String {
        let mut svg = Svg::new(f64::from(self.options.size.0), f64::from(self.options.size.1));
        // Doors and people outside the camera of one panel must not be seen in the next one, nor under the words; a lone
        // panel without words is cut by the picture itself.
        let clipped = self.panels.len() > 1 || self.options.labels;
        for (index, panel) in self.panels.iter().enumerate() {
            if clipped {
                svg.raw(&format!("<clipPath id=\"panel-{index}\">"));
                svg.rect((panel.view.x, panel.view.y), (panel.view.w, panel.view.h), "");
                svg.raw(&format!("</clipPath><g clip-path=\"url(#panel-{index})\">"));
            }
            actor::draw_doors(&mut svg, panel.location, &panel.frame, panel.recording, now_s);
            actor::draw_everybody(&mut svg, panel.location, &panel.frame, panel.recording, now_s, &panel.look);
            if clipped {
                svg.raw("</g>");
            }
            if self.options.labels {
                self.draw_words(&mut svg, panel, now_s);
            }
        }
        svg.finish()
    }

    /// Seconds of the run for which a caption stands.
    pub(crate) fn caption_s(&self) -> f64 {
        CAPTION_SECS * self.times.speed.max(1.0)
    }

    fn draw_words(&self, svg: &mut Svg, panel: &Panel<'_>, now_s: f64) {
        let size = panel.look.text_px;
        let speed = if (self.times.speed - 1.0).abs() < 1e-9 {
            String::new()
        } else {
            format!(" ({}×)", (self.times.speed * 100.0).round() / 100.0)
        };
        svg.heading(panel.clock_at(), &format!("{} · {now_s:.1} s{speed}", panel.title), size, palette::INK);
        // The newest ones, each on a line of its own, so that what comes fast is told as well.
        for (row, words) in panel.told(now_s, self.caption_s()).enumerate() {
            svg.heading(panel.caption_at(row), &words, size, palette::INK);
        }
    }
}

/// The part of a panel in which the map is seen: words have strips of their own, so that they hide nobody.
fn view(at: (f64, f64), size: (f64, f64), text_px: f64, labels: bool) -> Area {
    #[expect(clippy::cast_precision_loss, reason = "a few captions")]
    let (above, below) =
        if labels { (text_px * (LINE + 0.1), text_px * (LINE * CAPTIONS as f64 + 0.2)) } else { (0.0, 0.0) };
    Area { x: at.0, y: at.1 + above, w: size.0, h: size.1 - above - below }
}

/// Lines between the map and the strips of words: both may be white.
pub(crate) fn draw_edges(svg: &mut Svg, view: &Area, labels: bool) {
    for y in [view.y, view.y + view.h].into_iter().filter(|_| labels) {
        svg.line((view.x, y), (view.x + view.w, y), &format!("stroke=\"{}\" stroke-width=\"2\"", palette::UNKNOWN));
    }
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
        // Who walks, or stands there from the start, is seen, not told: it would be a line of names. Reactions are told.
        if kind == "leaf" && (words.ends_with(&walks) || t < FIRST_SECS && words.ends_with(&stands)) {
            continue;
        }
        match out.last_mut() {
            Some((last, told)) if (*last - t).abs() < 1e-9 => *told = format!("{told}, {words}"),
            _ => out.push((t, words.to_owned())),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{hall, walk};

    const SMALL: FilmOptions = FilmOptions { size: (320, 180), fps: 10, labels: true, speed: None };

    fn at(speed: Option<f64>, seconds: usize) -> Times {
        let mut run = walk(1);
        let tick: Vec<_> = run.tick(0).to_vec();
        while run.ticks() <= seconds * 100 {
            run.frames.extend(&tick);
        }
        times(&[&run], &FilmOptions { speed, ..SMALL }).unwrap()
    }

    #[test]
    fn a_short_run_is_shown_in_real_time_and_a_long_one_faster() {
        let short = at(None, 12);
        assert!((short.speed - 1.0).abs() < 1e-12 && short.length_s() < 14.1);
        let long = at(None, 60);
        assert!((long.speed - 3.4).abs() < 1e-12, "{long:?}");
        assert!(long.length_s() <= LONGEST_SECS && (long.to_s - 60.0).abs() < 0.02);
    }

    #[test]
    fn a_fixed_speed_shows_the_part_where_it_happens() {
        let part = at(Some(1.0), 60);
        assert!(part.length_s() <= LONGEST_SECS + 1e-9);
        // They pass each other after 3 s, so the film begins with the run.
        assert!(part.from_s.abs() < 1e-9 && (part.to_s - 18.0).abs() < 1e-9, "{part:?}");
    }

    #[test]
    fn a_film_stands_still_at_both_ends() {
        let times = at(None, 6);
        assert!((times.moment_s(0) - times.moment_s(9)).abs() < 1e-12);
        let last = times.pictures();
        assert!((times.moment_s(last - 1) - times.moment_s(last - 10)).abs() < 1e-12);
    }

    #[test]
    fn the_same_run_gives_the_same_pictures_and_labels_can_be_left_out() {
        let (location, run) = (hall("hall"), walk(2));
        let film = |labels: bool| {
            let options = FilmOptions { labels, ..SMALL };
            Film::new(&location, None, &[&run], &[&run], options).unwrap().picture(30).unwrap()
        };
        assert_eq!(film(true), film(true));
        assert_eq!(film(true).len(), 320 * 180 * 3);
        assert_ne!(film(true), film(false));
    }

    #[test]
    fn a_film_without_labels_names_no_planner() {
        let (location, run) = (hall("hall"), walk(2));
        let words = |labels: bool| {
            let options = FilmOptions { labels, ..SMALL };
            Film::new(&location, None, &[&run], &[&run], options).unwrap().drawing(2.0)
        };
        assert!(words(true).contains("reference") && words(true).contains("h2"));
        assert!(!words(false).contains("reference") && !words(false).contains("h2"));
    }

    #[test]
    fn clock_and_captions_stand_beside_the_map_and_hide_nobody() {
        let (location, mut run) = (hall("hall"), walk(2));
        let opens = |n: u64| EventKind::Door { door: format!("door {n}"), open: true };
        let time = |n: u64| socrates_model::SimTime::from_nanos(1_900_000_000 + n * 20_000_000);
        run.events = (0..4).map(|n| socrates_model::Event { time: time(n), kind: opens(n) }).collect();
        let film = Film::new(&location, None, &[&run], &[&run], FilmOptions { size: (640, 360), ..SMALL }).unwrap();
        let panel = &film.panels[0];
        let size = panel.look.text_px;
        assert!(panel.clock_at().1 + 0.3 * size <= panel.view.y, "below the letters of the clock is the map");
        let told: Vec<String> = panel.told(2.0, film.caption_s()).collect();
        assert_eq!(told, ["door 3 opens", "door 2 opens", "door 1 opens"]);
        let highest = panel.caption_at(told.len() - 1).1 - size;
        assert!(highest >= panel.view.y + panel.view.h, "{highest}");
        for agent in [0, 1, 2] {
            let state = run.tick(200)[agent];
            let (x, y) = panel.frame.px(&location, &state.point());
            let r = panel.look.radius_px(0.3);
            let view = panel.view;
            assert!(x - r >= view.x && x + r <= view.x + view.w && y - r >= view.y && y + r <= view.y + view.h);
        }
        let bare = FilmOptions { labels: false, ..SMALL };
        let bare = Film::new(&location, None, &[&run], &[&run], bare).unwrap().panels[0].view;
        assert_eq!((bare.w, bare.h), (320.0, 180.0));
    }

    #[test]
    fn the_camera_does_not_depend_on_which_run_is_shown() {
        let location = hall("hall");
        let (one, other) = (walk(1), walk(3));
        let all = [&one, &other];
        let frame = |shown: &Recording| Film::new(&location, None, &all, &[shown], SMALL).unwrap().panels[0].frame;
        assert_eq!(frame(&one), frame(&other));
    }

    #[test]
    fn nobody_walks_from_one_panel_into_the_next() {
        let (location, mut run) = (hall("hall"), walk(0));
        // Far to the right of the camera, in the middle of the second panel.
        for state in &mut run.frames {
            state.x += 7.0;
        }
        let still = walk(0);
        let film = |first: &Recording| {
            let options = FilmOptions { labels: false, ..SMALL };
            Film::new(&location, None, &[&still], &[first, &still], options).unwrap().picture(15).unwrap()
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
            let all = [&run];
            Film::new(&location, None, &all, shown, options).map(|_| ()).unwrap_err().to_string()
        };
        assert!(film(&[], SMALL).contains("no run"));
        assert!(film(&[&run; 5], SMALL).contains("`5` runs"));
        assert!(film(&[&run], FilmOptions { size: (321, 180), ..SMALL }).contains("321"));
        assert!(film(&[&run], FilmOptions { speed: Some(f64::NAN), ..SMALL }).contains("NaN"));
    }
}
