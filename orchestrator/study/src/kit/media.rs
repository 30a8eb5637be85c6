//! Films on a host, for survey programs that carry none: where they lie, and the words that show one.

use crate::problem::Problem;

/// A script, `gate(film, done)`, that lets nobody past a film before they have seen it.
pub(super) const GATE: &str = include_str!("web/gate.js");

/// Where films were uploaded: an address with https, without an ending slash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Media(String);

impl Media {
    /// The address of a folder of films.
    ///
    /// # Errors
    /// Anything but https: survey pages with https show nothing that comes without it.
    pub fn parse(text: &str) -> Result<Self, Problem> {
        let bad = |what: &str| {
            let hint =
                "the address of a folder to which the films are uploaded, such as https://films.example.org/study1";
            Problem::new("--media-url", what, hint).value(text)
        };
        let rest = text.strip_prefix("https://").ok_or_else(|| bad("survey pages show films from https only"))?;
        if rest.is_empty() || rest.starts_with('/') || rest.contains(['?', '#', ' ', '"', '\'', '<', '>', '\\']) {
            return Err(bad("no address of a folder"));
        }
        Ok(Self(text.trim_end_matches('/').to_owned()))
    }

    /// The address of a film.
    #[must_use]
    pub fn of(&self, film: &str) -> String {
        format!("{}/{film}.mp4", self.0)
    }
}

/// The film in a page, as HTML.
#[must_use]
pub fn video(address: &str, id: &str) -> String {
    format!(
        "<video id=\"film-{id}\" src=\"{address}\" controls controlslist=\"nodownload noplaybackrate\" disablepictureinpicture playsinline muted preload=\"auto\" style=\"width:100%;max-width:1280px\"></video>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_without_https_is_refused() {
        assert_eq!(Media::parse("https://a.example/b/").unwrap().of("k7f"), "https://a.example/b/k7f.mp4");
        for wrong in ["http://a.example/b", "a.example", "https://", "https://a b", "https://a.example/?x=\""] {
            let why = Media::parse(wrong).unwrap_err().to_string();
            assert!(why.contains("`--media-url`") && why.contains("hint"), "{why}");
        }
    }
}
