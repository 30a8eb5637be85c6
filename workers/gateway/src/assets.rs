//! The page, in the program.

pub(crate) use crate::fox::LAYOUT;

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Media type and text of a part of the page.
#[must_use]
pub(crate) fn find(name: &str) -> Option<(&'static str, &'static str)> {
    PARTS.iter().find(|(part, ..)| *part == name).map(|(_, media, text)| (*media, *text))
}

const PARTS: [(&str, &str, &str); 17] = [
    ("camera.js", SCRIPT, include_str!("../web/camera.js")),
    ("clock.js", SCRIPT, include_str!("../web/clock.js")),
    ("controls.js", SCRIPT, include_str!("../web/controls.js")),
    ("element.js", SCRIPT, include_str!("../web/element.js")),
    ("gl.js", SCRIPT, include_str!("../web/gl.js")),
    ("index.html", "text/html; charset=utf-8", include_str!("../web/index.html")),
    ("labels.js", SCRIPT, include_str!("../web/labels.js")),
    ("list.js", SCRIPT, include_str!("../web/list.js")),
    ("live.css", "text/css; charset=utf-8", include_str!("../web/live.css")),
    ("live.js", SCRIPT, include_str!("../web/live.js")),
    ("model.js", SCRIPT, include_str!("../web/model.js")),
    ("panel.js", SCRIPT, include_str!("../web/panel.js")),
    ("socket.js", SCRIPT, include_str!("../web/socket.js")),
    ("stage.js", SCRIPT, include_str!("../web/stage.js")),
    ("view.js", SCRIPT, include_str!("../web/view.js")),
    ("wire.js", SCRIPT, include_str!("../web/wire.js")),
    ("words.js", SCRIPT, include_str!("../web/words.js")),
];
