//! The report page of a bundle: one self-contained HTML file that needs no network.

use std::collections::BTreeSet;

use socrates_model::job::Stage;
use socrates_model::{JobState, Location, Paths, Proposal, Reading, Recording, Report, Request, Statement};

use crate::page_data::page_data;
use crate::svg::{escape, escape_code};
use crate::template::{self, template};
use crate::{palette, play};

const TEMPLATE: &str = template!("web/page.html");
const SCRIPT: &str = include_str!("web/page.js");

/// One line of the stage table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StageRow {
    /// Stage; `None` where the provenance does not say.
    pub stage: Option<Stage>,
    /// Planner and seed where there are several; empty otherwise.
    pub item: String,
    /// Revision, 0 for the first.
    pub revision: u64,
    /// Where the job stands; `None` where the provenance does not say.
    pub state: Option<JobState>,
    /// Attempts.
    pub attempts: u32,
    /// Working time, ms.
    pub wall_ms: u64,
    /// What happened: remark and faults.
    pub remark: String,
}

impl StageRow {
    /// `simulation reference-1 (revision 2)`
    fn name(&self) -> String {
        let revision = if self.revision == 0 { String::new() } else { format!("(revision {})", self.revision) };
        let stage = self.stage.map_or("", Stage::name);
        [stage, &self.item, &revision].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
    }
}

/// One line of the provenance table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvenanceRow {
    /// Name.
    pub name: String,
    /// Value.
    pub value: String,
}

/// Everything the page shows.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// Heading.
    pub title: &'a str,
    /// What the user gave.
    pub request: &'a Request,
    /// What was read.
    pub reading: &'a Reading,
    /// The reading in one line.
    pub reading_line: &'a str,
    /// The place.
    pub location: &'a Location,
    /// The proposal.
    pub proposal: &'a Proposal,
    /// The paths.
    pub paths: &'a Paths,
    /// Runs, the reference first.
    pub runs: &'a [(Recording, Report)],
    /// Stages.
    pub stages: &'a [StageRow],
    /// Provenance.
    pub provenance: &'a [ProvenanceRow],
}

impl Page<'_> {
    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let way = self.location.graph.polyline(&self.paths.robot);
        let data = page_data(self.location, &way, self.reading, self.runs);
        let (name, about) = (escape(&self.location.name), escape(&self.location.description));
        let location = if about.is_empty() { name } else { format!("<abbr title=\"{about}\">{name}</abbr>") };
        let own = vec![
            ("author", escape(&self.proposal.author.to_string())),
            ("location", location),
            ("reading_line", escape_code(self.reading_line)),
            ("reading", self.reading_html()),
            ("people", self.people_html()),
            ("stages", self.stages_html()),
            ("provenance", self.provenance_html()),
        ];
        template::page(TEMPLATE, SCRIPT, self.title, play::floors([self.location]), &data, own)
    }

    fn reading_html(&self) -> String {
        let mut out = format!("<p class=\"lead\">{}</p><dl>", escape_code(self.reading_line));
        let request = [
            ("Social context", Some(self.request.social_context.as_str())),
            ("Task", Some(self.request.task.as_str())),
            ("Rough scenario", Some(self.request.rough_scenario.as_deref().unwrap_or("(none: unguided)"))),
        ];
        for (name, text) in request {
            let text = text.unwrap_or_default();
            out.push_str(&format!("<dt>{name}</dt><dd class=\"said\">{}</dd>", escape(text.trim())));
        }
        if !self.reading.statements.is_empty() {
            out.push_str(&format!("<dt>Wishes</dt><dd>{}</dd>", self.statements_html()));
        }
        let notes: BTreeSet<&str> = self.reading.notes.iter().chain(&self.proposal.notes).map(String::as_str).collect();
        for note in notes {
            out.push_str(&format!("<dt>Assumed</dt><dd>{}</dd>", escape_code(note)));
        }
        for problem in &self.reading.problems {
            out.push_str(&format!("<dt>Problem</dt><dd class=\"bad\">{}</dd>", escape_code(&problem.to_string())));
        }
        out.push_str(&format!("<dt>Proposed</dt><dd>{}</dd></dl>", escape_code(&self.proposal.description)));
        out
    }

    /// Every piece of the texts, and what became of it.
    fn statements_html(&self) -> String {
        let row = |statement: &Statement| {
            let class = if statement.is_missing() { " class=\"bad\"" } else { "" };
            let (quote, told) = (escape(&statement.quote), escape_code(&statement.told()));
            format!("<tr{class}><td><q>{quote}</q></td><td>{}</td><td>{told}</td></tr>", statement.fate())
        };
        let rows: String = self.reading.statements.iter().map(row).collect();
        format!("<table class=\"statements\"><tr><th>words</th><th></th><th></th></tr>{rows}</table>")
    }

    fn people_html(&self) -> String {
        let mut out = String::new();
        out.push_str(&format!(
            "<tr><td><i class=\"robot\" style=\"background:{}\"></i>robot</td><td>{}</td><td>{}</td></tr>",
            palette::ROBOT,
            escape(&self.proposal.robot.task),
            escape(&self.proposal.robot.expected_behavior)
        ));
        for human in &self.proposal.humans {
            let group = human.group.map(|group| format!(" · {group}")).unwrap_or_default();
            out.push_str(&format!(
                "<tr><td><i style=\"background:{}\"></i>{}</td><td>{}{}</td><td>{}</td></tr>",
                palette::human(human.id.number()),
                human.id,
                escape(&human.role),
                escape(&group),
                escape(&human.behavior)
            ));
        }
        out
    }

    fn stages_html(&self) -> String {
        self.stages
            .iter()
            .map(|row| {
                format!(
                    "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{} ms</td><td>{}</td></tr>",
                    escape(&row.name()),
                    row.state.map_or("", JobState::name),
                    row.attempts,
                    row.wall_ms,
                    escape_code(&row.remark)
                )
            })
            .collect()
    }

    fn provenance_html(&self) -> String {
        self.provenance
            .iter()
            .map(|row| format!("<tr><td>{}</td><td><code>{}</code></td></tr>", escape(&row.name), escape(&row.value)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{EVIL, hall, papers, report, walk};

    fn html(text: &str, runs: &[(Recording, Report)]) -> String {
        let (request, reading, proposal, paths) = papers(text);
        let row = |text: &str| text.to_owned();
        let stages = [StageRow {
            stage: Some(Stage::Proposal),
            item: row(text),
            revision: 2,
            state: Some(JobState::Succeeded),
            attempts: 1,
            wall_ms: 2,
            remark: row(text),
        }];
        let provenance = [ProvenanceRow { name: row(text), value: row(text) }];
        let page = Page {
            title: text,
            request: &request,
            reading: &reading,
            reading_line: text,
            location: &hall(text),
            proposal: &proposal,
            paths: &paths,
            runs,
            stages: &stages,
            provenance: &provenance,
        };
        page.html()
    }

    fn run_of(humans: u32, text: &str) -> (Recording, Report) {
        let recording = walk(humans);
        let report = report(&recording, text);
        (recording, report)
    }

    /// The data of the page, as its script reads them.
    fn data(html: &str) -> serde_json::Value {
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        let (text, _) = rest.split_once("</script>").unwrap();
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn every_place_of_the_template_has_a_value() {
        let names: Vec<&str> =
            TEMPLATE.split("{{").skip(1).filter_map(|rest| rest.split_once("}}")).map(|(name, _)| name).collect();
        assert_eq!(names.len(), 14, "{names:?}");
        assert!(!html("hall", &[run_of(1, "x")]).contains("{{"));
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let html = html(EVIL, &[run_of(1, EVIL)]);
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2, "only the page's own two scripts end");
        assert!(html.matches("{{data}}").count() > 10, "what looks like a place of the template stays text");
    }

    #[test]
    fn clauses_come_with_ids_times_and_the_facts_that_they_promise() {
        let data = data(&html("hall", &[run_of(1, "told")]));
        let clause = &data["runs"][0]["clauses"][0];
        assert_eq!((&clause["id"], &clause["source"]), (&"c1".into(), &"f1".into()));
        assert_eq!(clause["times"], serde_json::json!([2.5, 3.25]));
        assert_eq!(data["facts"][0]["says"], "1 human");
        assert_eq!(data["facts"][1]["id"], "f2");
    }

    #[test]
    fn curves_and_tracks_have_as_many_samples() {
        let data = data(&html("hall", &[run_of(2, "x")]));
        let run = &data["runs"][0];
        let samples = run["series"]["distance"].as_array().unwrap().len();
        assert_eq!(samples, 61);
        assert_eq!(run["agents"].as_array().unwrap().len(), 3);
        assert_eq!(run["agents"][0]["track"].as_array().unwrap().len(), samples * 4);
        assert_eq!(run["series"]["ttc"].as_array().unwrap().len(), samples);
    }

    #[test]
    fn nobody_and_five_hundred_people_have_a_page_too() {
        for humans in [0, 500] {
            let run = run_of(humans, "x");
            let page = html("hall", &[run]);
            let agents = data(&page)["runs"][0]["agents"].as_array().unwrap().len();
            assert_eq!(agents, humans as usize + 1);
        }
        assert!(data(&html("hall", &[]))["runs"].as_array().unwrap().is_empty());
    }

    #[test]
    fn the_same_runs_give_the_same_page() {
        let runs = [run_of(3, "x"), run_of(3, "y")];
        assert_eq!(html("hall", &runs), html("hall", &runs));
    }
}
