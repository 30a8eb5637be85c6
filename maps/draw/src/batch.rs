//! The page of a folder of bundles: every scenario with its verdict, picture and runs, to filter and to open.

use serde_json::{Value, json};
use socrates_model::report::Standing;
use socrates_model::{ClauseRole, Location, Paths, Proposal, Recording, Report, Request};

use crate::palette;
use crate::play::{self, Places};
use crate::presence::There;
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/batch.html");
const SCRIPT: &str = include_str!("web/batch.js");

/// So many scenarios have a small picture; more would make the page too heavy to open.
const PICTURES: usize = 1000;
/// Tracks of so many agents are drawn in a small picture, the robot's among them.
const TRACKS: usize = 16;
/// A small track has a point whenever somebody went so far, drawing units.
const STEP: f64 = 5.0;

/// One scenario of the folder.
#[derive(Debug, Clone, Copy)]
pub struct BatchEntry<'a> {
    /// Its folder, relative to the page.
    pub folder: &'a str,
    /// Its id.
    pub scenario: &'a str,
    /// What the user gave.
    pub request: &'a Request,
    /// The reading in one line.
    pub reading_line: &'a str,
    /// The place.
    pub location: &'a Location,
    /// The proposal.
    pub proposal: &'a Proposal,
    /// The paths.
    pub paths: &'a Paths,
    /// Reports of all runs, the reference first.
    pub reports: &'a [Report],
    /// The first run, for the picture.
    pub recording: Option<&'a Recording>,
}

/// What the planners did over all scenarios, ready to be shown.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Figures {
    /// Names of the columns.
    pub head: Vec<String>,
    /// A row per figure, as many cells as columns.
    pub rows: Vec<Vec<String>>,
    /// Signature of the thresholds that all figures used; empty where there is none.
    pub thresholds: String,
}

/// The page while it is being filled, one scenario after another.
#[derive(Debug, Clone, Default)]
pub struct BatchPage {
    places: Places,
    rows: Vec<Value>,
    figures: Value,
}

/// What the page tells of one scenario, made wherever its recording is at hand.
#[derive(Debug, Clone)]
pub struct BatchRow {
    told: Value,
    picture: Option<Picture>,
}

/// A small picture, without the number of its place: the page numbers places.
#[derive(Debug, Clone)]
struct Picture {
    focus: [f64; 4],
    tracks: Vec<Value>,
}

impl BatchRow {
    /// The row of a scenario.
    #[must_use]
    pub fn of(entry: &BatchEntry<'_>) -> Self {
        let first = entry.reports.first();
        let runs: Vec<Value> = entry.reports.iter().map(run_row).collect();
        let told = json!({
            "folder": entry.folder, "scenario": entry.scenario, "title": entry.proposal.title,
            "reading": entry.reading_line, "context": entry.request.social_context, "task": entry.request.task,
            "rough": entry.request.rough_scenario, "location": entry.location.name, "place": entry.proposal.place.name(),
            "pattern": entry.proposal.pattern, "humans": entry.proposal.humans.len(), "author": entry.proposal.author,
            "verdict": first.map_or("failed", |report| report.verdict.name()),
            "told": first.map_or("", |report| report.verdict_text.as_str()), "why": first.and_then(why), "runs": runs,
        });
        Self { told, picture: entry.recording.map(|recording| picture(entry.location, entry.paths, recording)) }
    }
}

impl BatchPage {
    /// Adds a scenario at a place; `repeats` is the earlier scenario of the page that it repeats.
    pub fn add(&mut self, row: BatchRow, location: &Location, repeats: Option<&str>) {
        let picture = row.picture.filter(|_| self.rows.len() < PICTURES).map(|picture| {
            json!({ "place": self.places.number(location), "focus": picture.focus, "tracks": picture.tracks })
        });
        let mut told = row.told;
        if let Some(members) = told.as_object_mut() {
            members.insert("repeats".to_owned(), repeats.into());
            members.insert("picture".to_owned(), picture.into());
        }
        self.rows.push(told);
    }

    /// Adds a scenario of which there is no bundle, and why; `repeats` is the earlier one that failed in the same way.
    pub fn add_failed(&mut self, scenario: &str, why: &str, repeats: Option<&str>) {
        let row = json!({ "scenario": scenario, "repeats": repeats, "verdict": "failed", "told": why, "runs": [] });
        self.rows.push(row);
    }

    /// Sets the figures over all scenarios.
    pub fn tell(&mut self, figures: Figures) {
        self.figures = json!(figures);
    }

    /// Says why there are no figures over all scenarios: then the page puts none together either.
    pub fn tell_none(&mut self, why: &str) {
        self.figures = json!({ "why": why });
    }

    /// Scenarios added so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Scenarios added so far that repeat no earlier one.
    #[must_use]
    pub fn distinct(&self) -> usize {
        self.rows.iter().filter(|row| row.get("repeats").is_none_or(Value::is_null)).count()
    }

    /// Whether no scenario was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The page.
    #[must_use]
    pub fn html(&self, title: &str) -> String {
        let data = json!({ "rows": self.rows, "places": self.places.told(), "figures": self.figures });
        template::page(TEMPLATE, SCRIPT, title, self.places.floors(), &data, Vec::new())
    }
}

fn run_row(report: &Report) -> Value {
    let metric = |id: &str| report.metrics.iter().find(|metric| metric.id == id).and_then(|metric| metric.value);
    json!({
        "planner": report.planner, "seed": report.seed, "verdict": report.verdict.name(), "success": report.success,
        "distance": metric("human_distance_min"), "time": metric("time_to_goal"), "contacts": metric("human_collisions"),
    })
}

/// The first clause that was needed and not seen.
fn why(report: &Report) -> Option<String> {
    report
        .clauses
        .iter()
        .find(|clause| {
            clause.must
                && clause.role == ClauseRole::Setup
                && matches!(clause.standing, Standing::Fails | Standing::NotTriggered)
        })
        .map(|clause| format!("{}: {}", clause.id, clause.text))
}

fn picture(location: &Location, paths: &Paths, recording: &Recording) -> Picture {
    let frame = play::frame(location);
    let way = location.graph.polyline(&paths.robot);
    let mut tracks: Vec<Value> = Vec::new();
    let there = There::of(recording);
    for info in recording.header.agents.iter().take(TRACKS) {
        let mut line: Vec<(f64, f64)> = Vec::new();
        let mut last = None;
        for state in recording.track(info.agent).filter(|state| there.is(state)) {
            let at = frame.px(location, &state.point());
            if line.last().is_none_or(|before| (before.0 - at.0).hypot(before.1 - at.1) >= STEP) {
                line.push(at);
            }
            last = Some(at);
        }
        line.extend(last);
        let points: Vec<String> = line.iter().map(|(x, y)| format!("{x:.0},{y:.0}")).collect();
        tracks.push(json!([palette::agent(info.agent.number()), points.join(" ")]));
    }
    // The robot lies on top.
    tracks.reverse();
    Picture { focus: play::focus(location, &way, &[recording]), tracks }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, papers, report, walk};

    fn page(text: &str, count: usize, humans: u32) -> String {
        let (request, _, proposal, paths) = papers(text);
        let recording = walk(humans);
        let reports = [report(&recording, text)];
        let location = hall(text);
        let mut page = BatchPage::default();
        for _ in 0..count {
            let row = BatchRow::of(&BatchEntry {
                folder: text,
                scenario: text,
                request: &request,
                reading_line: text,
                location: &location,
                proposal: &proposal,
                paths: &paths,
                reports: &reports,
                recording: Some(&recording),
            });
            let repeats = (page.len() > 1).then_some(text);
            page.add(row, &location, repeats);
        }
        page.html(text)
    }

    fn data(html: &str) -> Value {
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn a_row_says_what_was_asked_what_became_of_it_and_where_it_lies() {
        let data = data(&page("hall", 1, 2));
        let row = &data["rows"][0];
        assert_eq!((row["folder"].as_str(), row["verdict"].as_str()), (Some("hall"), Some("realised")));
        assert_eq!(row["why"], "c2: hall");
        assert_eq!(row["runs"][0]["time"], 6.0);
        assert_eq!(row["picture"]["tracks"].as_array().unwrap().len(), 3);
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let html = page(EVIL, 1, 1);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }

    #[test]
    fn a_place_is_drawn_once_however_many_scenarios_it_has() {
        let html = page("hall", 7, 1);
        assert_eq!(html.matches("id=\"floor-").count(), 1);
        assert_eq!(data(&html)["rows"].as_array().unwrap().len(), 7);
    }

    #[test]
    fn a_row_says_what_it_repeats_and_the_page_counts_distinct_scenarios() {
        let html = page("hall", 5, 1);
        let rows = data(&html)["rows"].as_array().unwrap().clone();
        let repeats: Vec<&Value> = rows.iter().map(|row| &row["repeats"]).collect();
        assert!(repeats[0].is_null() && repeats[4] == "hall", "{repeats:?}");
        let mut page = BatchPage::default();
        page.add_failed("odd", "no author", None);
        page.add_failed("odd-2", "no author", Some("odd"));
        assert_eq!((page.distinct(), page.len()), (1, 2));
    }

    #[test]
    fn a_large_folder_has_a_page_without_pictures_for_the_rest() {
        let html = page("hall", PICTURES + 5, 0);
        let rows = data(&html)["rows"].as_array().unwrap().clone();
        assert!(rows[PICTURES - 1]["picture"].is_object() && rows[PICTURES]["picture"].is_null());
    }

    #[test]
    fn figures_over_all_scenarios_are_told_or_why_there_are_none() {
        let mut page = BatchPage::default();
        let figures = Figures {
            head: vec!["figure".into()],
            rows: vec![vec!["</script>".into()]],
            thresholds: "standard-1".into(),
        };
        page.tell(figures);
        let html = page.html("one");
        assert_eq!(html.matches("</script>").count(), 2);
        assert_eq!(data(&html)["figures"]["thresholds"], "standard-1");
        page.tell_none("thresholds differ");
        assert_eq!(data(&page.html("one"))["figures"]["why"], "thresholds differ");
    }

    #[test]
    fn an_empty_folder_and_a_failed_scenario_have_a_page() {
        let mut page = BatchPage::default();
        assert!(page.is_empty() && page.html("none").contains("\"rows\":[]"));
        page.add_failed("odd-1", "no author", None);
        assert_eq!(page.len(), 1);
        assert!(page.html("one").contains("no author"));
    }
}
