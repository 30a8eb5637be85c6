//! The page: one file with its style and its scripts in it, which loads nothing from anywhere.

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse as _, Response};

use crate::loopback::refused;
use crate::view::new_token;

/// The page, with places for what stands in files of its own.
const PAGE: &str = include_str!("web/editor.html");
const STYLE: &str = include_str!("web/editor.css");
/// The scripts in the order in which they build on each other.
const SCRIPTS: [&str; 4] = [
    include_str!("web/net.js"),
    include_str!("web/view.js"),
    include_str!("web/panel.js"),
    include_str!("web/tools.js"),
];

/// The page with a policy under which only its own style and scripts count: they bear a word that is drawn anew for every answer.
pub(super) async fn page() -> Response {
    let Ok(nonce) = new_token() else {
        return refused(
            StatusCode::INTERNAL_SERVER_ERROR,
            "no random word can be drawn on this machine",
            None,
            "no_chance",
        );
    };
    let policy = format!(
        "default-src 'none'; connect-src 'self'; img-src data:; style-src 'nonce-{nonce}'; script-src 'nonce-{nonce}'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'"
    );
    let Ok(policy) = HeaderValue::from_str(&policy) else {
        return refused(StatusCode::INTERNAL_SERVER_ERROR, "the policy of the page is no header", None, "no_policy");
    };
    let page = PAGE.replace("{nonce}", &nonce).replace("{style}", STYLE).replace("{scripts}", &SCRIPTS.concat());
    let heads = [
        (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::CONTENT_SECURITY_POLICY, policy),
    ];
    (heads, page).into_response()
}
