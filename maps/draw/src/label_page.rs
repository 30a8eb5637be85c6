//! The page on which people label runs by hand: the request, the film of a run, and questions; no verdict and no planner in sight.

use serde_json::{Value, json};
use socrates_model::{Digest, Location, Paths, Recording};

use crate::play::{self, Places};
use crate::svg::escape;
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/labels.html");
const SCRIPT: &str = concat!(include_str!("web/raters.js"), include_str!("web/labels.js"));
/// Folder of the films beside a page.
const FILMS: &str = "films";
/// Members of a run that are its film.
const FILM: [&str; 4] = ["hz", "agents", "doors", "way"];

/// A question of a page: the column of its answers, what is asked and meant, and the answers with their keys.
#[derive(Debug, Clone, Copy)]
struct Question {
    column: &'static str,
    words: &'static str,
    about: &'static str,
    answers: [(&'static str, &'static str); 3],
}

impl Question {
    fn told(&self) -> Value {
        json!({ "id": self.column, "words": self.words, "about": self.about, "answers": self.answers })
    }
}

const YES_NO: [(&str, &str); 3] = [("yes", "y"), ("no", "n"), ("unsure", "u")];

/// What is asked on a page of labels.
const QUALITIES: [Question; 3] = [
    Question {
        column: "simulable",
        words: "Is it simulable?",
        about: "Everybody moves as people and robots can: nobody passes through walls or others, jumps, or is stuck.",
        answers: YES_NO,
    },
    Question {
        column: "appropriate",
        words: "Is it appropriate?",
        about: "People, places and what happens fit the social context, the task and the location.",
        answers: YES_NO,
    },
    Question {
        column: "as_asked",
        words: "Is it as asked?",
        about: "What the request describes is what you see: who, where, how they react, and the robot meets them.",
        answers: YES_NO,
    },
];

/// What is asked on a page of a blind judgment.
const AS_ASKED: [Question; 1] = [Question {
    column: "as_asked",
    words: "Did it happen as asked?",
    about: "As asked: every sentence happened. Partly: at least one did not happen, the others did. Not: what the request is about did \
            not happen. Then copy the words of the request that did not happen.",
    answers: [("as_asked", "y"), ("partly", "h"), ("not", "n")],
}];

const HOW: &str = "Read what was asked for, watch the run to its end, and answer the questions as <em>you</em> see it; there is no right \
    answer to find out. When in doubt, say unsure.";
const HOW_BLIND: &str = "Read what was asked for, watch the run to its end, and say for each of its sentences whether you saw it happen. \
    Looks, beauty and manners are not judged. Where a sentence did not happen, copy its words. <code>PROTOCOL.md</code> beside this \
    page says more.";

/// What is asked of a rater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Asks {
    /// Whether a run is simulable, appropriate and as asked, by people who may know what they look at.
    #[default]
    Qualities,
    /// Whether what was asked happened, and which words did not; nothing on the page tells where a run is from.
    AsAsked,
}

impl Asks {
    const fn questions(self) -> &'static [Question] {
        match self {
            Self::Qualities => &QUALITIES,
            Self::AsAsked => &AS_ASKED,
        }
    }

    /// The columns of the table that the page saves, without the comment that stands behind them.
    #[must_use]
    pub fn columns(self) -> Vec<&'static str> {
        let sentence = (self == Self::AsAsked).then_some("sentence");
        ["run", "rater"]
            .into_iter()
            .chain(self.questions().iter().map(|question| question.column))
            .chain(sentence)
            .collect()
    }
}

/// A run for a page.
#[derive(Debug, Clone, Copy)]
pub struct Labeled<'a> {
    /// What it is called in the table of answers.
    pub name: &'a str,
    /// What was asked for, text by text: what it is, and its words.
    pub texts: &'a [(&'a str, String)],
    /// Where it happens.
    pub location: &'a Location,
    /// The ways of the scenario.
    pub paths: &'a Paths,
    /// All runs of the scenario: the camera is the same for each of them.
    pub all: &'a [&'a Recording],
    /// The run.
    pub recording: &'a Recording,
}

/// The page while it is being filled, one run after another.
#[derive(Debug, Clone, Default)]
pub struct LabelPage {
    asks: Asks,
    places: Places,
    runs: Vec<Value>,
}

/// A page, and its films where they are too large to stand in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelFiles {
    /// The page.
    pub html: String,
    /// Path beside the page and text of every film.
    pub films: Vec<(String, String)>,
}

impl LabelPage {
    /// A page that asks this.
    #[must_use]
    pub fn asking(asks: Asks) -> Self {
        Self { asks, ..Self::default() }
    }

    /// Adds a run.
    pub fn add(&mut self, run: &Labeled<'_>) {
        let index = self.places.number(run.location);
        let way = run.location.graph.polyline(&run.paths.robot);
        // The intended way stays hidden: what is judged is what is seen.
        let mut played = play::run(run.location, &[], run.recording, play::rate(run.all));
        if let Some(members) = played.as_object_mut() {
            members.insert("name".to_owned(), run.name.into());
            members.insert("place".to_owned(), index.into());
            members.insert("focus".to_owned(), json!(play::focus(run.location, &way, run.all)));
            members.insert("texts".to_owned(), json!(run.texts));
        }
        self.runs.push(played);
    }

    /// Runs added so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether no run was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// The page. What a rater has answered is kept by the browser under a key that belongs to these very runs.
    #[must_use]
    pub fn html(&self, title: &str) -> String {
        self.page(title, &self.runs, "")
    }

    /// The page in one file, or, where that would have more bytes than this, with its films beside it.
    #[must_use]
    pub fn files(&self, title: &str, most_bytes: usize) -> LabelFiles {
        let html = self.html(title);
        if html.len() <= most_bytes {
            return LabelFiles { html, films: Vec::new() };
        }
        let mut films = Vec::new();
        let mut runs = self.runs.clone();
        for run in &mut runs {
            let Some(members) = run.as_object_mut() else { continue };
            let film: serde_json::Map<String, Value> =
                FILM.iter().filter_map(|key| members.remove(*key).map(|value| ((*key).to_owned(), value))).collect();
            let name = members.get("name").cloned().unwrap_or_default();
            let path = format!("{FILMS}/{}.js", name.as_str().unwrap_or_default());
            members.insert("film".to_owned(), path.clone().into());
            films.push((path, format!("film({name}, {});\n", Value::Object(film))));
        }
        // A page from a disk may load scripts that lie beside it, and nothing else.
        LabelFiles { html: self.page(title, &runs, " 'self' file:"), films }
    }

    fn page(&self, title: &str, runs: &[Value], scripts: &str) -> String {
        let blind = self.asks == Asks::AsAsked;
        let mut places = self.places.told();
        if blind {
            // The name of a folder may tell what lies in it.
            places.iter_mut().filter_map(Value::as_object_mut).for_each(|place| drop(place.remove("name")));
        }
        let questions: Vec<Value> = self.asks.questions().iter().map(Question::told).collect();
        let key = Digest::of(Value::Array(self.runs.clone()).to_string().as_bytes()).short();
        // Words for people: kept in the table, and read by no figure.
        let columns: Vec<&str> = self.asks.columns().into_iter().chain(["comment"]).collect();
        let data = json!({
            "runs": runs, "places": places, "key": key, "questions": questions, "columns": columns, "named": blind,
        });
        let keys = self.asks.questions().first().map_or(&YES_NO, |question| &question.answers);
        let keys: Vec<String> = keys.iter().map(|(_, key)| format!("<kbd>{}</kbd>", escape(key))).collect();
        let own = vec![
            ("how", if blind { HOW_BLIND } else { HOW }.to_owned()),
            ("keys", keys.join(" ")),
            ("scripts", scripts.to_owned()),
        ];
        template::page(TEMPLATE, SCRIPT, title, self.places.floors(), &data, own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, papers, walk};

    fn filled(asks: Asks, text: &str) -> LabelPage {
        let (request, _, _, paths) = papers(text);
        let (location, run) = (hall(text), walk(2));
        let mut page = LabelPage::asking(asks);
        assert!(page.is_empty());
        let texts = [("Task of the robot", request.task), ("Asked for", request.rough_scenario.unwrap_or_default())];
        let name = if asks == Asks::AsAsked { "r01" } else { run.header.run.as_str() };
        page.add(&Labeled { name, texts: &texts, location: &location, paths: &paths, all: &[&run], recording: &run });
        assert_eq!(page.len(), 1);
        page
    }

    fn page(text: &str) -> String {
        filled(Asks::Qualities, text).html(text)
    }

    fn data(html: &str) -> Value {
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn a_rater_sees_the_request_and_the_run_and_neither_verdict_nor_planner() {
        let data = data(&page("a hall"));
        let run = &data["runs"][0];
        assert_eq!(run["name"], "test.reference-1");
        assert_eq!(run["texts"], json!([["Task of the robot", "a hall"], ["Asked for", "a hall"]]));
        for hidden in ["verdict", "planner", "clauses", "metrics", "events"] {
            assert!(run[hidden].is_null(), "{hidden}");
        }
    }

    #[test]
    fn the_tables_have_the_columns_that_are_read_back() {
        assert_eq!(
            data(&page("a"))["columns"],
            json!(["run", "rater", "simulable", "appropriate", "as_asked", "comment"])
        );
        let blind = data(&filled(Asks::AsAsked, "a").html("a"));
        assert_eq!(blind["columns"], json!(["run", "rater", "as_asked", "sentence", "comment"]));
        let answers = json!([["as_asked", "y"], ["partly", "h"], ["not", "n"]]);
        assert_eq!(blind["questions"][0]["answers"], answers);
    }

    #[test]
    fn a_blind_page_names_neither_run_nor_planner_nor_folder() {
        let html = filled(Asks::AsAsked, "they pass").html("they pass");
        let (_, body) = html.split_once("</style>").unwrap();
        for hidden in ["test.reference", "reference-1", "native"] {
            assert!(!body.contains(hidden), "{hidden}");
        }
        assert!(data(&html)["places"][0]["name"].is_null());
        assert_eq!(data(&html)["runs"][0]["name"], "r01");
    }

    #[test]
    fn films_stand_beside_a_page_that_would_be_too_large() {
        let page = filled(Asks::AsAsked, "a");
        let whole = page.files("a", usize::MAX);
        assert_eq!((whole.html.as_str(), whole.films.len()), (page.html("a").as_str(), 0));
        assert!(whole.html.contains("script-src 'unsafe-inline';"));
        let parted = page.files("a", 10);
        let run = &data(&parted.html)["runs"][0];
        assert_eq!((run["film"].as_str(), run["agents"].is_null()), (Some("films/r01.js"), true));
        assert!(parted.html.contains("script-src 'unsafe-inline' 'self' file:;"));
        let (path, film) = &parted.films[0];
        assert_eq!(path, "films/r01.js");
        let film = film.strip_prefix("film(\"r01\", ").unwrap().strip_suffix(");\n").unwrap();
        let film: Value = serde_json::from_str(film).unwrap();
        assert_eq!(film["agents"], data(&whole.html)["runs"][0]["agents"]);
        assert_eq!(data(&whole.html)["key"], data(&parted.html)["key"], "answers are kept for both");
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        for html in [page(EVIL), filled(Asks::AsAsked, EVIL).files(EVIL, 10).html] {
            assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
            assert_eq!(html.matches("</script>").count(), 2);
        }
    }

    #[test]
    fn other_runs_have_another_key_and_the_same_runs_the_same_page() {
        assert_eq!(page("a"), page("a"));
        assert_ne!(data(&page("a"))["key"], data(&page("b"))["key"]);
        assert!(LabelPage::default().html("none").contains("\"runs\":[]"));
    }
}
