//! What a server says of its rates, on every answer.

use reqwest::header::HeaderMap;
use serde::{Deserialize, Serialize};

use crate::waits;

/// One rate: how much of it there is, and how much is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rate {
    /// The limit per window.
    pub limit: u64,
    /// What is left of it.
    pub left: u64,
    /// Time until it is whole again, ms, where the server says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole_in_ms: Option<u64>,
}

/// Rates of requests and of tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Requests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub requests: Option<Rate>,
    /// Tokens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tokens: Option<Rate>,
}

/// The rates in the headers, in the spelling of either vendor.
pub(crate) fn limits(headers: &HeaderMap) -> Option<Limits> {
    let requests = rate(headers, "requests");
    let tokens = rate(headers, "tokens");
    (requests.is_some() || tokens.is_some()).then_some(Limits { requests, tokens })
}

fn rate(headers: &HeaderMap, of: &str) -> Option<Rate> {
    let text = |name: String| headers.get(name).and_then(|value| value.to_str().ok()).map(str::trim);
    let openai = |part: &str| text(format!("x-ratelimit-{part}-{of}"));
    let anthropic = |part: &str| text(format!("anthropic-ratelimit-{of}-{part}"));
    let either = |part: &str| openai(part).or_else(|| anthropic(part));
    let number = |part: &str| either(part).and_then(|value| value.parse::<u64>().ok());
    let whole_in_ms = either("reset").and_then(|value| waits::reset_ms(value, headers));
    Some(Rate { limit: number("limit")?, left: number("remaining")?, whole_in_ms })
}

#[cfg(test)]
mod tests {
    use super::*;
    use reqwest::header::{HeaderName, HeaderValue};

    fn of(pairs: &[(&'static str, &'static str)]) -> Option<Limits> {
        let pairs = pairs.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value)));
        limits(&pairs.collect())
    }

    #[test]
    fn both_spellings_are_read() {
        let found = of(&[
            ("x-ratelimit-limit-tokens", "30000"),
            ("x-ratelimit-remaining-tokens", "29000"),
            ("x-ratelimit-reset-tokens", "1m2s"),
        ]);
        let tokens = Some(Rate { limit: 30_000, left: 29_000, whole_in_ms: Some(62_000) });
        assert_eq!(found, Some(Limits { requests: None, tokens }));
        let found = of(&[
            ("date", "Sun, 22 Nov 2026 02:00:00 GMT"),
            ("anthropic-ratelimit-requests-limit", "50"),
            ("anthropic-ratelimit-requests-remaining", "0"),
            ("anthropic-ratelimit-requests-reset", "2026-11-22T02:00:30Z"),
        ]);
        let requests = Some(Rate { limit: 50, left: 0, whole_in_ms: Some(30_000) });
        assert_eq!(found, Some(Limits { requests, tokens: None }));
        assert_eq!(of(&[("x-ratelimit-limit-tokens", "many")]), None);
    }
}
