//! The page on which people label runs by hand: three questions, no verdict and no planner in sight.

use serde_json::{Value, json};
use socrates_model::{Digest, Location, Paths, Recording, Request};

use crate::play::{self, Places};
use crate::template::{self, template};

const TEMPLATE: &str = template!("web/labels.html");
const SCRIPT: &str = include_str!("web/labels.js");

/// The page while it is being filled, one run after another.
#[derive(Debug, Clone, Default)]
pub struct LabelPage {
    places: Places,
    runs: Vec<Value>,
}

impl LabelPage {
    /// Adds a run of a scenario with the camera of `all` its runs. The run is known by this name in the exported table.
    pub fn add(
        &mut self,
        name: &str,
        request: &Request,
        location: &Location,
        paths: &Paths,
        all: &[&Recording],
        recording: &Recording,
    ) {
        let index = self.places.number(location);
        let way = location.graph.polyline(&paths.robot);
        // The intended way stays hidden: what is judged is what is seen.
        let mut run = play::run(location, &[], recording, play::rate(all));
        if let Some(members) = run.as_object_mut() {
            members.insert("name".to_owned(), name.into());
            members.insert("place".to_owned(), index.into());
            members.insert("focus".to_owned(), json!(play::focus(location, &way, all)));
            members.insert("context".to_owned(), request.social_context.trim().into());
            members.insert("task".to_owned(), request.task.trim().into());
            members.insert("rough".to_owned(), json!(request.rough_scenario.as_deref().map(str::trim)));
            members.insert("location".to_owned(), location.name.clone().into());
            members.insert("about".to_owned(), location.description.clone().into());
        }
        self.runs.push(run);
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
        let runs = Value::Array(self.runs.clone());
        let key = Digest::of(runs.to_string().as_bytes()).short();
        let data = json!({ "runs": runs, "places": self.places.told(), "key": key });
        template::page(TEMPLATE, SCRIPT, title, self.places.floors(), &data, Vec::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, papers, walk};

    fn page(text: &str) -> String {
        let (request, _, _, paths) = papers(text);
        let (location, run) = (hall(text), walk(2));
        let mut page = LabelPage::default();
        assert!(page.is_empty());
        page.add(run.header.run.as_str(), &request, &location, &paths, &[&run], &run);
        assert_eq!(page.len(), 1);
        page.html(text)
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
        assert_eq!((run["task"].as_str(), run["rough"].as_str()), (Some("a hall"), Some("a hall")));
        for hidden in ["verdict", "planner", "clauses", "metrics", "events"] {
            assert!(run[hidden].is_null(), "{hidden}");
        }
    }

    #[test]
    fn the_table_has_the_columns_that_are_read_back() {
        assert!(SCRIPT.contains("\"run\", \"rater\", \"simulable\", \"appropriate\", \"as_asked\""));
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let html = page(EVIL);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }

    #[test]
    fn other_runs_have_another_key_and_the_same_runs_the_same_page() {
        assert_eq!(page("a"), page("a"));
        assert_ne!(data(&page("a"))["key"], data(&page("b"))["key"]);
        assert!(LabelPage::default().html("none").contains("\"runs\":[]"));
    }
}
