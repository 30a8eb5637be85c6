//! The page of a folder of bundles: every scenario with its verdict, picture and runs, to filter and to open.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use socrates_model::report::Standing;
use socrates_model::{ClauseRole, Location, Paths, Proposal, Recording, Report, Request};

use crate::palette;
use crate::play::{self, Places};
use crate::presence::There;
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/batch.html");
const SCRIPT: &str = include_str!("web/batch.js");

/// Scenarios of one page: more would make it too heavy to open.
const ON_A_PAGE: usize = 1000;
/// File of the first page, and what stands before the number of the others.
const FIRST: &str = "report.html";
const OTHERS: &str = "report-";
/// Tracks of so many agents are drawn in a small picture, the robot's among them.
const TRACKS: usize = 16;
/// A small track has a point whenever somebody went so far, drawing units.
const STEP: f64 = 5.0;

/// Where a bundle lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lies<'a> {
    /// In this folder, whose page is led to.
    Folder(&'a str),
    /// In this file, packed.
    File(&'a str),
    /// Nowhere: it was not kept.
    Nowhere,
}

/// One scenario of the folder.
#[derive(Debug, Clone, Copy)]
pub struct BatchEntry<'a> {
    /// Where its bundle lies, relative to the page.
    pub lies: Lies<'a>,
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
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Figures {
    /// Names of the columns.
    pub head: Vec<String>,
    /// A row per figure, as many cells as columns.
    pub rows: Vec<Vec<String>>,
    /// Signature of the thresholds that all figures used; empty where there is none.
    pub thresholds: String,
}

/// What the scenarios cover and lack, ready to be shown: on the first page alone.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Covered {
    /// How many cells of each kind hold a scenario, a phrase each.
    pub shares: Vec<String>,
    /// Canonical scenarios, each with its count.
    pub scenarios: Vec<Vec<String>>,
    /// Places, each with its count.
    pub places: Vec<Vec<String>>,
    /// Names of the columns of [`Self::encounters`].
    pub head: Vec<String>,
    /// Encounter angles by density of people, as many cells as columns.
    pub encounters: Vec<Vec<String>>,
    /// What lacks, a sentence each.
    pub gaps: Vec<String>,
}

/// The page while it is being filled, one scenario after another; of many scenarios several pages that lead to each other.
#[derive(Debug, Clone, Default)]
pub struct BatchPage {
    full: Vec<Part>,
    last: Part,
    figures: Value,
    covered: Value,
}

/// What one page holds.
#[derive(Debug, Clone, Default)]
struct Part {
    places: Places,
    rows: Vec<Value>,
}

/// What the page tells of one scenario, made wherever its recording is at hand.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BatchRow {
    told: Value,
    picture: Option<Picture>,
}

/// A small picture, without the number of its place: the page numbers places.
#[derive(Debug, Clone, Serialize, Deserialize)]
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
        let mut told = json!({
            "scenario": entry.scenario, "title": entry.proposal.title,
            "reading": entry.reading_line, "context": entry.request.social_context, "task": entry.request.task,
            "rough": entry.request.rough_scenario, "location": entry.location.name, "place": entry.proposal.place.name(),
            "pattern": entry.proposal.pattern, "humans": entry.proposal.humans.len(), "author": entry.proposal.author,
            "verdict": first.map_or("failed", |report| report.verdict.name()),
            "told": first.map_or("", |report| report.verdict_text.as_str()), "why": first.and_then(why), "runs": runs,
        });
        let lies = match entry.lies {
            Lies::Folder(folder) => Some(("folder", folder)),
            Lies::File(file) => Some(("file", file)),
            Lies::Nowhere => None,
        };
        if let (Some(members), Some((key, name))) = (told.as_object_mut(), lies) {
            members.insert(key.to_owned(), name.into());
        }
        Self { told, picture: entry.recording.map(|recording| picture(entry.location, entry.paths, recording)) }
    }
}

impl BatchPage {
    /// Adds a scenario at a place; `repeats` is the earlier scenario of the page that it repeats.
    pub fn add(&mut self, row: BatchRow, location: &Location, repeats: Option<&str>) {
        let part = self.part();
        let picture = row.picture.map(|picture| {
            json!({ "place": part.places.number(location), "focus": picture.focus, "tracks": picture.tracks })
        });
        let mut told = row.told;
        if let Some(members) = told.as_object_mut() {
            members.insert("repeats".to_owned(), repeats.into());
            members.insert("picture".to_owned(), picture.into());
        }
        part.rows.push(told);
    }

    /// The page that is being filled.
    fn part(&mut self) -> &mut Part {
        if self.last.rows.len() == ON_A_PAGE {
            self.full.push(std::mem::take(&mut self.last));
        }
        &mut self.last
    }

    /// Adds a scenario of which there is no bundle, and why; `repeats` is the earlier one that failed in the same way.
    pub fn add_failed(&mut self, scenario: &str, why: &str, repeats: Option<&str>) {
        let row = json!({ "scenario": scenario, "repeats": repeats, "verdict": "failed", "told": why, "runs": [] });
        self.part().rows.push(row);
    }

    /// Sets the figures over all scenarios.
    pub fn tell(&mut self, figures: Figures) {
        self.figures = json!(figures);
    }

    /// Sets what the scenarios cover.
    pub fn cover(&mut self, covered: Covered) {
        self.covered = json!(covered);
    }

    /// Says why there are no figures over all scenarios: then the page puts none together either.
    pub fn tell_none(&mut self, why: &str) {
        self.figures = json!({ "why": why });
    }

    /// Scenarios added so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows().count()
    }

    fn rows(&self) -> impl Iterator<Item = &Value> {
        self.full.iter().chain([&self.last]).flat_map(|part| &part.rows)
    }

    /// Scenarios added so far that repeat no earlier one.
    #[must_use]
    pub fn distinct(&self) -> usize {
        self.rows().filter(|row| row.get("repeats").is_none_or(Value::is_null)).count()
    }

    /// Whether no scenario was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.last.rows.is_empty()
    }

    /// The pages with the names of their files, which lie in one folder; the first is `report.html`.
    #[must_use]
    pub fn pages(&self, title: &str) -> Vec<(String, String)> {
        let parts: Vec<&Part> = self.full.iter().chain([&self.last]).collect();
        let mut from = 1;
        let links: Vec<Value> = parts
            .iter()
            .enumerate()
            .map(|(number, part)| {
                let link =
                    json!({ "href": Self::file(number), "from": from, "to": from + part.rows.len().saturating_sub(1) });
                from += part.rows.len();
                link
            })
            .collect();
        let page = |(number, part): (usize, &&Part)| {
            let mut data = json!({ "rows": part.rows, "places": part.places.told(), "figures": self.figures });
            if let Some(members) = data.as_object_mut().filter(|_| number == 0 && !self.covered.is_null()) {
                members.insert("covered".to_owned(), self.covered.clone());
            }
            if let Some(members) = data.as_object_mut().filter(|_| parts.len() > 1) {
                members.insert("parts".to_owned(), json!({ "links": links, "here": number, "all": self.shares() }));
            }
            (Self::file(number), template::page(TEMPLATE, SCRIPT, title, part.places.floors(), &data, Vec::new()))
        };
        parts.iter().enumerate().map(page).collect()
    }

    /// Name of the file of a page, the first being 0.
    #[must_use]
    pub fn file(number: usize) -> String {
        if number == 0 { FIRST.to_owned() } else { format!("{OTHERS}{}.html", number + 1) }
    }

    /// How many scenarios there are on all pages, how many of them differ, and how many of those were realised.
    fn shares(&self) -> Value {
        let distinct = || self.rows().filter(|row| row.get("repeats").is_none_or(Value::is_null));
        let realised = distinct().filter(|row| row.get("verdict").is_some_and(|verdict| verdict == "realised")).count();
        json!({ "scenarios": self.len(), "distinct": distinct().count(), "realised": realised })
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
                lies: Lies::Folder(text),
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
        html(&page, text)
    }

    /// The first page.
    fn html(page: &BatchPage, title: &str) -> String {
        page.pages(title).remove(0).1
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
    fn a_large_folder_has_several_pages_that_lead_to_each_other() {
        let (request, _, proposal, paths) = papers("hall");
        let (recording, location) = (walk(1), hall("hall"));
        let reports = [report(&recording, "hall")];
        let row = BatchRow::of(&BatchEntry {
            lies: Lies::File("hall.tar.zst"),
            scenario: "hall",
            request: &request,
            reading_line: "hall",
            location: &location,
            proposal: &proposal,
            paths: &paths,
            reports: &reports,
            recording: Some(&recording),
        });
        let mut all = BatchPage::default();
        for _ in 0..2 * ON_A_PAGE + 5 {
            all.add(row.clone(), &location, None);
        }
        all.cover(Covered { gaps: vec!["no scenario".to_owned()], ..Covered::default() });
        let pages = all.pages("hall");
        let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["report.html", "report-2.html", "report-3.html"]);
        let told: Vec<Value> = pages.iter().map(|(_, html)| data(html)).collect();
        let counts: Vec<usize> = told.iter().map(|data| data["rows"].as_array().unwrap().len()).collect();
        assert_eq!(counts, [ON_A_PAGE, ON_A_PAGE, 5]);
        assert_eq!(told[2]["parts"]["links"][1], json!({ "href": "report-2.html", "from": 1001, "to": 2000 }));
        assert_eq!(told[2]["parts"]["here"], 2);
        assert!(told[0]["covered"]["gaps"][0] == "no scenario" && told[1]["covered"].is_null());
        assert_eq!(told[0]["parts"]["all"], json!({ "scenarios": 2005, "distinct": 2005, "realised": 2005 }));
        assert!(
            told.iter().all(|data| data["rows"][0]["picture"].is_object() && data["rows"][0]["file"] == "hall.tar.zst")
        );
        assert!(data(&page("hall", 3, 1))["parts"].is_null(), "one page alone leads nowhere");
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
        let told = html(&page, "one");
        assert_eq!(told.matches("</script>").count(), 2);
        assert_eq!(data(&told)["figures"]["thresholds"], "standard-1");
        page.tell_none("thresholds differ");
        assert_eq!(data(&html(&page, "one"))["figures"]["why"], "thresholds differ");
    }

    #[test]
    fn an_empty_folder_and_a_failed_scenario_have_a_page() {
        let mut page = BatchPage::default();
        assert!(page.is_empty() && html(&page, "none").contains("\"rows\":[]"));
        page.add_failed("odd-1", "no author", None);
        assert_eq!(page.len(), 1);
        assert!(html(&page, "one").contains("no author"));
    }
}
