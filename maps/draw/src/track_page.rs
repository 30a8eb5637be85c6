//! The page of tracks that nobody asked a scenario for: a player, the key figures, and what looks wrong.

use serde::Serialize;
use serde_json::{Value, json};
use socrates_model::{Cell, FORMAT, Grid, Location, Point, Pose, Recording, Report, SceneGraph};

use crate::play;
use crate::svg::escape;
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/tracks.html");
const SCRIPT: &str = include_str!("web/tracks.js");

/// Floor around the tracks where there is no map, m.
const ROOM_M: f64 = 2.0;
/// Cells along the longer side of such a floor.
const CELLS: f64 = 400.0;

/// A figure as it is shown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FigureRow {
    /// Id of the metric.
    pub name: String,
    /// Its value in words.
    pub value: String,
    /// Whether more is better.
    pub better: &'static str,
    /// Why there is no value.
    pub note: String,
}

/// Everything the page shows.
#[derive(Debug, Clone)]
pub struct TrackPage<'a> {
    /// Heading: the name of the file.
    pub title: &'a str,
    /// The map, where one is known.
    pub location: Option<&'a Location>,
    /// Where the robot wants to go, where that is known.
    pub goal: Option<Point>,
    /// The tracks.
    pub recording: &'a Recording,
    /// Their report.
    pub report: &'a Report,
    /// The key figures.
    pub key: &'a [FigureRow],
    /// Every metric.
    pub all: &'a [FigureRow],
    /// What looks wrong, and what was assumed, in sentences.
    pub told: &'a [String],
}

impl TrackPage<'_> {
    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let open = open_floor(self.recording);
        let location = self.location.unwrap_or(&open);
        let name = if self.location.is_some() { escape(&location.name) } else { "no map".to_owned() };
        let goal: Vec<Point> = self.goal.into_iter().collect();
        let mut run = play::run(location, &[], self.recording, play::rate(&[self.recording]));
        if let Some(members) = run.as_object_mut() {
            members.insert("name".to_owned(), self.title.into());
        }
        let story: Vec<Value> = self.report.story.iter().filter_map(|line| play::told(line)).collect();
        let data = json!({
            "run": run, "place": play::place(location, 0), "focus": play::focus(location, &goal, &[self.recording]),
            "key": self.key, "all": self.all, "told": self.told, "story": story, "thresholds": self.report.thresholds,
        });
        let own = vec![("robot", escape(&self.report.robot_text)), ("location", name)];
        template::page(TEMPLATE, SCRIPT, self.title, play::floors([location]), &data, own)
    }
}

/// Free floor around everybody.
fn open_floor(recording: &Recording) -> Location {
    let seen = || play::spread(recording).filter(|at| at.x.is_finite() && at.y.is_finite());
    let (low, high) =
        seen().fold((Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN)), |(low, high), at| {
            (Point::new(low.x.min(at.x), low.y.min(at.y)), Point::new(high.x.max(at.x), high.y.max(at.y)))
        });
    let (low, high) = if low.x > high.x { (Point::origin(), Point::origin()) } else { (low, high) };
    let (wide, high) = (high.x - low.x + 2.0 * ROOM_M, high.y - low.y + 2.0 * ROOM_M);
    let resolution_m = (wide.max(high) / CELLS).max(0.01);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive and at most CELLS")]
    let cells = |meters: f64| ((meters / resolution_m).ceil() as usize).max(1);
    let (width, height) = (cells(wide), cells(high));
    let grid = Grid {
        width,
        height,
        resolution_m,
        origin: Pose::new(low.x - ROOM_M, low.y - ROOM_M, 0.0),
        cells: vec![Cell::Free; width * height],
    };
    let (name, description) = ("open floor".to_owned(), String::new());
    Location {
        format: FORMAT,
        name,
        description,
        grid,
        graph: SceneGraph::default(),
        doors: Vec::new(),
        names: Vec::new(),
        warnings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, report, walk};

    fn page(text: &str, map: bool) -> String {
        let (location, recording) = (hall(text), walk(2));
        let report = report(&recording, text);
        let row = FigureRow { name: text.into(), value: text.into(), better: "more is better", note: text.into() };
        TrackPage {
            title: text,
            location: map.then_some(&location),
            goal: None,
            recording: &recording,
            report: &report,
            key: std::slice::from_ref(&row),
            all: std::slice::from_ref(&row),
            told: &[text.to_owned()],
        }
        .html()
    }

    fn data(html: &str) -> Value {
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn tracks_play_on_a_map_and_on_an_open_floor_and_nothing_is_judged() {
        for map in [true, false] {
            let html = page("hall", map);
            let data = data(&html);
            assert_eq!(data["run"]["agents"].as_array().unwrap().len(), 3);
            assert_eq!(data["key"][0]["name"], "hall");
            assert_eq!(html.contains("no map"), !map);
            assert!(!html.to_lowercase().contains("verdict</"), "no verdict where nothing was asked");
            // Everybody is inside the picture.
            let whole = &data["place"]["whole"];
            let track = data["run"]["agents"][0]["track"].as_array().unwrap();
            let (x, w) = (track[0].as_f64().unwrap() / 10.0, whole[2].as_f64().unwrap());
            assert!(x >= 0.0 && x <= w, "{x} of {w}");
        }
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let html = page(EVIL, true);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }
}
