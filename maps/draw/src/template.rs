//! The shell of every page: one file of HTML that loads nothing and runs nothing that a user wrote.

use serde_json::Value;

use crate::svg::escape;

/// Words for building pages and the player of a run, in front of every page's own script.
const PLAYER: &str = include_str!("web/player.js");
/// The look of every page.
const STYLE: &str = include_str!("web/page.css");

/// A whole template: a page's own part between the head and the foot that all pages share.
macro_rules! template {
    ($own:literal) => {
        concat!(include_str!("web/head.html"), include_str!($own), include_str!("web/foot.html"))
    };
}
pub(crate) use template;

/// A page: what every page has, and what is its `own`.
pub(crate) fn page(
    template: &str,
    script: &str,
    title: &str,
    floors: String,
    data: &Value,
    own: Vec<(&str, String)>,
) -> String {
    let mut values = vec![
        ("style", STYLE.to_owned()),
        ("title", escape(title)),
        ("floors", floors),
        ("script", format!("{PLAYER}{script}")),
        ("data", json(data)),
    ];
    values.extend(own);
    fill(template, &values)
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

/// JSON for a script element. No `<` at all: neither the end of a script nor a comment can begin, whatever a user wrote.
fn json(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_looks_like_a_place_is_not_filled_again() {
        let out = fill("<{{a}}|{{b}}>", &[("a", "{{b}}".to_owned()), ("b", "2".to_owned())]);
        assert_eq!(out, "<{{b}}|2>");
    }

    #[test]
    fn no_page_loads_anything() {
        let parts = [
            PLAYER,
            STYLE,
            include_str!("web/head.html"),
            include_str!("web/foot.html"),
            include_str!("web/page.html"),
            include_str!("web/page.js"),
            include_str!("web/batch.html"),
            include_str!("web/batch.js"),
            include_str!("web/compare.html"),
            include_str!("web/compare.js"),
            include_str!("web/labels.html"),
            include_str!("web/labels.js"),
            include_str!("web/observe.html"),
            include_str!("web/observe.js"),
            include_str!("web/raters.js"),
            include_str!("web/tracks.html"),
            include_str!("web/tracks.js"),
        ];
        for part in parts {
            let part = part.replace("http://www.w3.org/2000/svg", "");
            assert!(
                !part.contains("://")
                    && !part.contains("@import")
                    && !part.contains("url(")
                    && !part.contains("fetch(")
            );
        }
    }
}
