//! The report page of a bundle: one self-contained HTML file that needs no network.

use std::collections::BTreeSet;

use socrates_model::{Location, Paths, Proposal, Reading, Recording, Report, Request};

use crate::map_layer::{Frame, draw_floor, draw_graph};
use crate::page_data::page_data;
use crate::palette;
use crate::svg::{Svg, escape};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Width of the map's drawing units; the page scales it.
const WIDTH: f64 = 1120.0;

/// One line of the stage table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StageRow {
    /// Stage name, with planner and seed where there are several.
    pub stage: String,
    /// `succeeded`, `superseded`, …
    pub state: String,
    /// Attempts.
    pub attempts: u32,
    /// Working time, ms.
    pub wall_ms: u64,
    /// What happened: remark and faults.
    pub remark: String,
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
        let frame = Frame::around(self.location, WIDTH, 720.0, (0.0, 0.0));
        let whole = frame.size();
        let mut map = Svg::new(whole.0, whole.1);
        draw_floor(&mut map, self.location, &frame);
        draw_graph(&mut map, self.location, &frame, palette::UNKNOWN, 1.5);
        let way = self.location.graph.polyline(&self.paths.robot);
        let line: Vec<(f64, f64)> = way.iter().map(|p| frame.px(self.location, p)).collect();
        let style = "stroke-width=\"1.6\" stroke-dasharray=\"3 5\" opacity=\"0.65\"";
        map.polyline(&line, &format!("stroke=\"{}\" {style}", palette::ROBOT));
        map.raw("<g id=\"trails\"></g><g id=\"agents\"></g><g id=\"scale\"></g>");
        let map =
            map.finish().replacen("<svg ", "<svg id=\"map\" role=\"img\" aria-label=\"animation of the run\" ", 1);
        let data = page_data(self.location, &frame, &way, self.runs);
        let style = STYLE.to_owned();
        let location = match self.location.description.as_str() {
            "" => escape(&self.location.name),
            about => format!("<abbr title=\"{}\">{}</abbr>", escape(about), escape(&self.location.name)),
        };
        fill(
            TEMPLATE,
            &[
                ("style", style),
                ("title", escape(self.title)),
                ("author", escape(&self.proposal.author)),
                ("location", location),
                ("reading_line", escape(self.reading_line)),
                ("reading", self.reading_html()),
                ("people", self.people_html()),
                ("stages", self.stages_html()),
                ("provenance", self.provenance_html()),
                ("map", map),
                ("script", SCRIPT.to_owned()),
                // No `<` at all: neither the end of a script nor a comment can begin, whatever a user wrote.
                ("data", data.to_string().replace('<', "\\u003c")),
            ],
        )
    }

    fn reading_html(&self) -> String {
        let mut out = format!("<p class=\"lead\">{}</p><dl>", escape(self.reading_line));
        let request = [
            ("Social context", Some(self.request.social_context.as_str())),
            ("Task", Some(self.request.task.as_str())),
            ("Rough scenario", Some(self.request.rough_scenario.as_deref().unwrap_or("(none: unguided)"))),
        ];
        for (name, text) in request {
            let text = text.unwrap_or_default();
            out.push_str(&format!("<dt>{name}</dt><dd class=\"said\">{}</dd>", escape(text.trim())));
        }
        let ignored =
            if self.reading.ignored.is_empty() { "nothing".to_owned() } else { self.reading.ignored.join(", ") };
        out.push_str(&format!("<dt>Ignored words</dt><dd>{}</dd>", escape(&ignored)));
        let notes: BTreeSet<&str> = self.reading.notes.iter().chain(&self.proposal.notes).map(String::as_str).collect();
        for note in notes {
            out.push_str(&format!("<dt>Assumed</dt><dd>{}</dd>", escape(note)));
        }
        for problem in &self.reading.problems {
            out.push_str(&format!("<dt>Problem</dt><dd class=\"bad\">{}</dd>", escape(&problem.to_string())));
        }
        out.push_str(&format!("<dt>Proposed</dt><dd>{}</dd></dl>", escape(&self.proposal.description)));
        out
    }

    fn people_html(&self) -> String {
        let mut out = String::new();
        out.push_str(&format!(
            "<tr><td><i style=\"background:{}\"></i>robot</td><td>{}</td><td>{}</td></tr>",
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
                    escape(&row.stage),
                    escape(&row.state),
                    row.attempts,
                    row.wall_ms,
                    escape(&row.remark)
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

/// The template with every `{{name}}` replaced in one pass: a value that looks like a name stays as it is.
fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut out = String::with_capacity(template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        out.push_str(before);
        let Some((name, tail)) = after.split_once("}}") else {
            out.push_str("{{");
            rest = after;
            break;
        };
        if let Some((_, value)) = values.iter().find(|(known, _)| *known == name) {
            out.push_str(value);
        }
        rest = tail;
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_value_that_looks_like_a_place_is_not_filled_again() {
        let out = fill("<{{a}}|{{b}}>", &[("a", "{{b}}".to_owned()), ("b", "2".to_owned())]);
        assert_eq!(out, "<{{b}}|2>");
    }

    #[test]
    fn every_place_of_the_template_has_a_value_and_the_page_loads_nothing() {
        let names: Vec<&str> =
            TEMPLATE.split("{{").skip(1).filter_map(|rest| rest.split_once("}}")).map(|(name, _)| name).collect();
        assert_eq!(names.len(), 13, "{names:?}");
        for part in [TEMPLATE, STYLE, SCRIPT] {
            let part = part.replace("http://www.w3.org/2000/svg", "");
            assert!(!part.contains("://") && !part.contains("@import") && !part.contains("url("));
        }
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        const EVIL: &str = "</script><script>alert(1)</script>{{data}}<!--\"'";
        fn read<T: serde::de::DeserializeOwned>(value: serde_json::Value) -> T {
            serde_json::from_value(value).unwrap()
        }
        let request: Request = read(json!({
            "location": EVIL, "social_context": EVIL, "task": EVIL, "rough_scenario": EVIL,
        }));
        let reading = Reading {
            task: EVIL.to_owned(),
            ignored: vec![EVIL.to_owned()],
            notes: vec![EVIL.to_owned()],
            ..Reading::default()
        };
        let proposal: Proposal = read(json!({
            "format": 1, "title": EVIL, "description": EVIL, "pattern": EVIL, "place": "corridor",
            "humans": [{"id": "human_1", "role": EVIL, "behavior": EVIL, "relation": "frontal", "rules": [], "speed_mps": 1.0}],
            "robot": {"task": EVIL, "script": [], "expected_behavior": EVIL}, "expected_events": [], "author": EVIL,
        }));
        let paths: Paths = read(json!({ "format": 1, "robot": [], "humans": {}, "encounters": [], "author": EVIL }));
        let location: Location = read(json!({
            "format": 1, "name": EVIL, "description": EVIL, "graph": { "nodes": [], "edges": [] },
            "grid": { "width": 4, "height": 1, "resolution_m": 0.1, "origin": { "x": 0.0, "y": 0.0, "yaw": 0.0 }, "cells": "1o2f1o" },
        }));
        let stages = [StageRow {
            stage: EVIL.to_owned(),
            state: EVIL.to_owned(),
            attempts: 1,
            wall_ms: 2,
            remark: EVIL.to_owned(),
        }];
        let provenance = [ProvenanceRow { name: EVIL.to_owned(), value: EVIL.to_owned() }];
        let page = Page {
            title: EVIL,
            request: &request,
            reading: &reading,
            reading_line: EVIL,
            location: &location,
            proposal: &proposal,
            paths: &paths,
            runs: &[],
            stages: &stages,
            provenance: &provenance,
        };
        let html = page.html();
        assert!(!html.contains("<script>alert") && !html.contains("<!--"));
        assert_eq!(html.matches("</script>").count(), 2, "only the page's own two scripts end");
        assert!(html.matches("{{data}}").count() > 10, "what looks like a place of the template stays text");
    }
}
