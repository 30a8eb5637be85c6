//! The page of a comparison: what became of the runs, every figure by planner, and the runs side by side.

use serde::Serialize;
use serde_json::{Value, json};
use socrates_model::{Location, Point, Recording, Report};

use crate::play::{self, Places};
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/compare.html");
const SCRIPT: &str = include_str!("web/compare.js");

/// What became of a planner's runs.
#[derive(Debug, Clone, Serialize)]
pub struct PlannerRow {
    /// Name of the planner.
    pub name: String,
    /// Runs that were wanted.
    pub runs: usize,
    /// Runs by what became of them, none twice: a key, its words, its meaning, and how many.
    pub parts: Vec<Part>,
    /// Runs in which the robot had success.
    pub success: usize,
    /// Runs in which the robot touched somebody.
    pub contact: usize,
}

/// A part of a planner's runs.
#[derive(Debug, Clone, Serialize)]
pub struct Part {
    /// Its key, which chooses the color: `realised`, `late`, `robot`, `scenario`, `failed`.
    pub key: &'static str,
    /// Its name in words.
    pub words: &'static str,
    /// What it means.
    pub about: &'static str,
    /// How many runs.
    pub count: usize,
}

/// The figures of one metric.
#[derive(Debug, Clone, Serialize)]
pub struct MetricRow {
    /// Id of the metric.
    pub id: &'static str,
    /// Unit; empty for counts and shares.
    pub unit: &'static str,
    /// What it is, with its formula.
    pub about: &'static str,
    /// 1 where more is better, -1 where less is, 0 where neither.
    pub sign: i8,
    /// Runs that the figures are of.
    pub runs: usize,
    /// Runs without a value, by planner.
    pub without: Vec<usize>,
    /// Figures, by planner.
    pub means: Vec<MeanRow>,
    /// Planners from the best to the worst, each with whether it is as good as the one before; empty without an order.
    pub order: Vec<(usize, bool)>,
    /// Share of the resamples with the same order.
    pub stable: Option<f64>,
    /// Share of the resamples in which a planner is best, by planner; empty without an order.
    pub best: Vec<f64>,
    /// The planner that is marked as best, where one is.
    pub marked: Option<usize>,
    /// Decimals that tell its figure from the others'.
    pub decimals: usize,
    /// Planners that are not ordered, because they arrived too seldom; empty without an order.
    pub unordered: Vec<usize>,
}

/// The figure of a planner.
#[derive(Debug, Clone, Serialize)]
pub struct MeanRow {
    /// Mean.
    pub mean: f64,
    /// Ends of its interval.
    pub interval: Option<(f64, f64)>,
    /// Means of scenarios or seeds.
    pub parts: Vec<f64>,
    /// Difference to the first planner with the ends of its interval; none of the first itself.
    pub difference: Option<(f64, Option<(f64, f64)>)>,
}

/// One scenario and seed that is played side by side.
#[derive(Debug, Clone)]
pub struct Beside<'a> {
    /// Title of the scenario.
    pub title: &'a str,
    /// Its folder, from where the page lies.
    pub folder: String,
    /// The seed.
    pub seed: u64,
    /// The location.
    pub location: &'a Location,
    /// The robot's way.
    pub way: Vec<Point>,
    /// Runs by planner; none of a planner without a result.
    pub runs: Vec<Option<(&'a Recording, &'a Report)>>,
    /// Order in which the planners stand while their names are hidden.
    pub hidden_order: Vec<usize>,
}

/// The page while scenarios are added to it, one at a time.
#[derive(Debug, Clone, Default)]
pub struct ComparePage {
    places: Places,
    beside: Vec<Value>,
    samples: usize,
}

/// The page holds at most about so many samples of runs, or it would not open on a phone.
const SAMPLES: usize = 1_200_000;

impl ComparePage {
    /// Adds a scenario and seed to play, unless the page is full; whether it was added.
    pub fn add(&mut self, beside: &Beside<'_>) -> bool {
        let recordings: Vec<&Recording> = beside.runs.iter().flatten().map(|(recording, _)| *recording).collect();
        let hz = play::rate(&recordings);
        let samples: usize = recordings
            .iter()
            .map(|run| run.ticks().div_ceil(play::ticks_per_sample(run, hz)) * run.header.agents.len())
            .sum();
        if recordings.is_empty() || (self.samples > 0 && self.samples + samples > SAMPLES) {
            return false;
        }
        self.samples += samples;
        let Beside { location, way, .. } = beside;
        let run = |(recording, report): (&Recording, &Report)| {
            let mut value = play::run(location, way, recording, hz);
            if let Some(members) = value.as_object_mut() {
                members.insert("name".to_owned(), format!("{} · seed {}", report.planner, report.seed).into());
                members.insert("verdict".to_owned(), report.verdict.name().into());
                members.insert("verdict_text".to_owned(), report.verdict_text.clone().into());
                members.insert("robot_text".to_owned(), report.robot_text.clone().into());
                members.insert("success".to_owned(), report.success.into());
                members.insert("story".to_owned(), report.story.iter().filter_map(|line| play::told(line)).collect());
            }
            value
        };
        let runs: Vec<Option<Value>> = beside.runs.iter().map(|one| one.map(run)).collect();
        self.beside.push(json!({
            "title": beside.title, "folder": beside.folder, "seed": beside.seed, "place": self.places.number(location),
            "focus": play::focus(location, way, &recordings), "runs": runs, "hidden_order": beside.hidden_order,
        }));
        true
    }

    /// The page. `basis` says what the figures are of; `left_out` is how many scenarios and seeds are not played on the page.
    #[must_use]
    pub fn html(&self, title: &str, head: &Head<'_>) -> String {
        let data = json!({
            "places": self.places.told(), "beside": self.beside, "planners": head.planners, "rows": head.rows,
            "basis": head.basis, "thresholds": head.thresholds, "common": head.common, "left_out": head.left_out,
        });
        template::page(TEMPLATE, SCRIPT, title, self.places.floors(), &data, Vec::new())
    }
}

/// What the page says in numbers.
#[derive(Debug, Clone)]
pub struct Head<'a> {
    /// What the figures are of, in a sentence.
    pub basis: &'a str,
    /// Signature of the thresholds.
    pub thresholds: &'a str,
    /// Runs that the planners have in common.
    pub common: usize,
    /// Scenarios and seeds that are not played on the page.
    pub left_out: usize,
    /// Planners.
    pub planners: &'a [PlannerRow],
    /// Figures.
    pub rows: &'a [MetricRow],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, report, walk};

    fn page(text: &str) -> (String, usize) {
        let (location, recording) = (hall(text), walk(2));
        let report = report(&recording, text);
        let mut page = ComparePage::default();
        let added = (1..=4)
            .filter(|seed| {
                page.add(&Beside {
                    title: text,
                    folder: text.to_owned(),
                    seed: *seed,
                    location: &location,
                    way: Vec::new(),
                    runs: vec![Some((&recording, &report)), None],
                    hidden_order: vec![1, 0],
                })
            })
            .count();
        let part = Part { key: "realised", words: "realised", about: "seen", count: 1 };
        let planner = PlannerRow { name: text.to_owned(), runs: 1, parts: vec![part], success: 1, contact: 0 };
        let mean = MeanRow { mean: 1.0, interval: Some((0.5, 1.5)), parts: vec![0.5, 1.5], difference: None };
        let row = MetricRow {
            id: "success",
            unit: "",
            about: "whether it arrived",
            sign: 1,
            runs: 1,
            without: vec![0, 1],
            means: vec![mean.clone(), mean],
            order: vec![(0, false), (1, true)],
            stable: Some(0.9),
            best: vec![0.5, 0.5],
            marked: None,
            decimals: 2,
            unordered: Vec::new(),
        };
        let head = Head {
            basis: text,
            thresholds: "standard-1",
            common: 1,
            left_out: 0,
            planners: &[planner.clone(), planner],
            rows: &[row],
        };
        (page.html(text, &head), added)
    }

    #[test]
    fn a_place_is_drawn_once_and_a_planner_without_a_result_has_an_empty_panel() {
        let (html, added) = page("hall");
        assert_eq!((html.matches("id=\"floor-").count(), added), (1, 4));
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        let data: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
        assert_eq!(data["beside"][0]["runs"][0]["agents"].as_array().unwrap().len(), 3);
        assert!(data["beside"][0]["runs"][1].is_null());
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let (html, _) = page(EVIL);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }

    #[test]
    fn a_full_page_takes_no_more_and_says_so() {
        let (location, crowd) = (hall("hall"), walk(900));
        let report = report(&crowd, "hall");
        let mut page = ComparePage::default();
        let beside = Beside {
            title: "crowd",
            folder: String::new(),
            seed: 1,
            location: &location,
            way: Vec::new(),
            runs: vec![Some((&crowd, &report)); 8],
            hidden_order: (0..8).collect(),
        };
        assert!(page.add(&beside), "the first always fits");
        let more = (0..60).filter(|_| page.add(&beside)).count();
        assert!(more < 60, "{more}");
    }
}
