//! The survey page: one file that asks nobody but the server that sent it, and needs none where it is opened from a disk.

use serde_json::{Value, json};

use super::asks::{checks, told};
use super::legend;
use super::orders::orders;
use super::setup::{View, agreed};
use crate::design::Design;
use crate::problem::Problem;

const TEMPLATE: &str = include_str!("web/survey.html");
const STYLE: &str = include_str!("web/survey.css");
const SCRIPT: &str = include_str!("web/survey.js");

/// A film as a page plays it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture<'f> {
    /// Width and height, drawing units.
    pub size: (u32, u32),
    /// Pictures per second.
    pub fps: u32,
    /// Length, s.
    pub length_s: f64,
    /// What stays, as a part of an SVG.
    pub ground: &'f str,
    /// What moves; a picture like the one before is empty.
    pub pictures: &'f [String],
}

/// The file of a film, beside the page.
#[must_use]
pub fn film_script(id: &str, film: &Picture<'_>) -> String {
    let parts = json!({ "size": [film.size.0, film.size.1], "fps": film.fps, "length_s": film.length_s, "ground": film.ground,
        "pictures": film.pictures });
    format!("film({}, {parts});\n", json!(id))
}

/// The page of a study.
///
/// # Errors
/// An attention check that cannot be answered, a text of consent that does not say how long it takes.
pub fn page(design: &Design) -> Result<String, Problem> {
    let consent = agreed(design)?;
    let orders = orders(design);
    let most = orders.iter().map(|order| order.films.len()).max().unwrap_or(0);
    let checks: Vec<Value> = checks(design, most)?
        .into_iter()
        .map(|check| {
            json!({ "name": check.name, "position": check.position, "block": check.instrument, "before": check.before,
                "text": check.text })
        })
        .collect();
    let scenario = |name: &str| design.scenarios.iter().position(|known| known == name);
    let films: serde_json::Map<String, Value> =
        design.films.iter().map(|film| (film.id.clone(), json!({ "scenario": scenario(&film.scenario) }))).collect();
    let source = |name: &String| design.sources.iter().find(|source| source.name == *name);
    let contexts: Vec<&str> =
        design.scenarios.iter().map(|name| source(name).map_or("", |source| source.context.as_str())).collect();
    let orders: Vec<Value> = orders.iter().map(|order| json!({ "name": order.name, "films": order.films })).collect();
    let data = json!({ "key": design.digest.get(..16), "consent": consent.paragraphs, "instructions": design.survey.instructions,
        "orders": orders, "films": films, "contexts": contexts, "about": legend::FILMS, "shapes": legend::shapes(design), "blocks": told(design), "checks": checks });
    // No `<` at all: neither the end of a script nor a comment can begin, whatever somebody wrote.
    let data = data.to_string().replace('<', "\\u003c");
    let title = escape(&design.title);
    let fill = [("title", title.as_str()), ("style", STYLE), ("data", &data), ("script", SCRIPT)];
    Ok(filled(TEMPLATE, &fill))
}

/// With whose eyes films are seen: `above`, `person`, or both.
pub(super) fn views(design: &Design) -> Vec<&'static str> {
    let source = |name: &String| design.sources.iter().find(|source| source.name == *name);
    let is_above = |name: &String| source(name).is_none_or(|source| source.view == View::Above);
    let mut found = Vec::new();
    if design.scenarios.iter().any(is_above) {
        found.push("above");
    }
    if !design.scenarios.iter().all(is_above) {
        found.push("person");
    }
    found
}

/// Every `{{name}}` replaced in one pass: a value that looks like a name stays as it is.
fn filled(template: &str, values: &[(&str, &str)]) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some((name, rest)) = part.split_once("}}") else { continue };
        out.push_str(values.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value));
        out.push_str(rest);
    }
    out
}

/// Texts as paragraphs of HTML.
pub(super) fn paragraphs(texts: &[String]) -> String {
    texts.iter().map(|text| format!("<p>{}</p>", escape(text))).collect()
}

/// Text for HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;

    #[test]
    fn the_page_names_no_planner_no_scenario_and_no_code_and_asks_nobody_outside() {
        let design = design();
        let html = page(&design).unwrap();
        for hidden in ["mppi", "nav2can", "ha_mppi", "elevator\"", "CSECRET1"] {
            assert!(!html.contains(hidden), "{hidden}");
        }
        let outside = html
            .replace(super::super::asks::blocks(&design)[0].of.source.as_str(), "")
            .replace("http://www.w3.org/2000/svg", "");
        assert!(!outside.contains("://"));
        assert!(html.contains("A hospital. The robot takes the elevator."));
    }

    #[test]
    fn words_of_a_user_cannot_become_markup() {
        let mut design = design();
        let evil = "</script><script>alert(1)</script>{{data}}<!--\"'<img src=x>";
        design.title = evil.to_owned();
        design.survey.consent = evil.to_owned().into();
        design.sources[0].context = evil.to_owned();
        let html = page(&design).unwrap();
        assert!(!html.contains("<script>alert") && !html.contains("<!--") && !html.contains("<img"));
        assert_eq!(html.matches("</script>").count(), 2);
    }

    #[test]
    fn a_film_is_one_call() {
        let pictures = vec!["<g/>".to_owned(), String::new()];
        let film = Picture { size: (4, 2), fps: 15, length_s: 1.0, ground: "", pictures: &pictures };
        assert!(film_script("k7f", &film).starts_with("film(\"k7f\", {"));
    }
}
