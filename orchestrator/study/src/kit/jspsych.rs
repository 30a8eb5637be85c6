//! The survey as an experiment of jsPsych 8: one page that shows the films beside it. It is served, and its data are saved or sent by whoever
//! serves it; `study read` takes its CSV back.

use serde_json::json;

use super::asks::{checks, told};
use super::legend;
use super::media::GATE;
use super::orders::orders;
use super::page::escape;
use super::setup::agreed;
use crate::design::Design;
use crate::problem::Problem;

/// Where jsPsych is loaded from where it does not lie beside the page.
const HOST: &str = "https://unpkg.com";
/// Its parts, of the version that the page was written for.
const PARTS: [&str; 4] = [
    "jspsych@8.3.0/dist/index.browser.min.js",
    "@jspsych/plugin-html-button-response@2.1.0/dist/index.browser.min.js",
    "@jspsych/plugin-survey-likert@2.2.0/dist/index.browser.min.js",
    "@jspsych/plugin-html-slider-response@2.1.0/dist/index.browser.min.js",
];
const STYLE: &str = "jspsych@8.3.0/css/jspsych.css";
/// On a phone: room beside the text, and whole words at the ends of a slider.
const LOOK: &str = ".jspsych-content{padding:0 12px;box-sizing:border-box}.jspsych-html-slider-response-container{margin:0 3.5em 3em!important}";
const SCRIPT: &str = include_str!("web/jspsych.js");

/// The page.
///
/// # Errors
/// An attention check that cannot be answered, a text of consent that does not say how long it takes.
pub fn jspsych(design: &Design) -> Result<String, Problem> {
    let all = orders(design);
    let most = all.iter().map(|order| order.films.len()).max().unwrap_or(0);
    let checks: Vec<_> = checks(design, most)?
        .into_iter()
        .map(|check| json!({ "name": check.name, "position": check.position, "block": check.instrument, "text": check.text }))
        .collect();
    let films: serde_json::Map<String, serde_json::Value> = design
        .films
        .iter()
        .map(|film| {
            let source = design.sources.iter().find(|source| source.name == film.scenario);
            (film.id.clone(), json!(source.map_or("", |source| source.context.as_str())))
        })
        .collect();
    let orders: Vec<_> = all.iter().map(|order| json!({ "name": order.name, "films": order.films })).collect();
    let data = json!({ "consent": agreed(design)?.paragraphs, "instructions": design.survey.instructions, "orders": orders, "contexts": films,
        "about": legend::FILMS, "shapes": legend::shapes(design), "blocks": told(design), "checks": checks });
    let data = data.to_string().replace('<', "\\u003c");
    let parts: String = PARTS.iter().map(|part| format!("<script src=\"{HOST}/{part}\"></script>\n")).collect();
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<link rel=\"stylesheet\" href=\"{HOST}/{STYLE}\">\n<style>{LOOK}</style>\n{parts}</head>\n<body></body>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n<script>\"use strict\";\n{GATE}{SCRIPT}</script>\n</html>\n",
        escape(&design.title)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;

    #[test]
    fn the_page_names_no_planner() {
        let html = jspsych(&design()).unwrap();
        assert!(!html.contains("mppi") && !html.contains("nav2can") && html.contains("k7f"));
        assert_eq!(html.matches("</script>").count(), 2 + PARTS.len());
    }
}
