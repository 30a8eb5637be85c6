//! How long a server wants us to wait.
//!
//! Dates are taken relative to the `date` of the same answer: the server's clock against the server's clock.

use jiff::fmt::rfc2822;
use jiff::{SignedDuration, Timestamp};
use reqwest::header::HeaderMap;
use serde_json::Value;

/// Longest wait that a server may ask for, ms.
const LONGEST_MS: u64 = 120_000;

/// The wait in ms: `retry-after-ms`, else `retry-after` in seconds or as a date, else the reset time of the rate limit.
pub(crate) fn retry_after_ms(headers: &HeaderMap) -> Option<u64> {
    let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok()).map(str::trim);
    let ms = text("retry-after-ms").and_then(|value| value.parse::<f64>().ok());
    let secs = text("retry-after").and_then(|value| value.parse::<f64>().ok()).map(|secs| secs * 1e3);
    let date = || {
        let (then, now) = (http_date_s(text("retry-after")?)?, http_date_s(text("date")?)?);
        Some((then - now) * 1e3)
    };
    let reset = || {
        let resets = ["x-ratelimit-reset-requests", "x-ratelimit-reset-tokens"];
        resets.into_iter().filter_map(|name| text(name).and_then(duration_ms)).reduce(f64::max)
    };
    capped(ms.or(secs).or_else(date).or_else(reset)?)
}

/// The wait inside an error: an entry of `details` with `retryDelay`, such as `17s`.
pub(crate) fn retry_delay_ms(error: &Value) -> Option<u64> {
    let details = error.get("details")?.as_array()?;
    capped(details.iter().find_map(|detail| duration_ms(detail.get("retryDelay")?.as_str()?))?)
}

/// A reset time in ms from now: a duration, or a date of RFC 3339.
pub(crate) fn reset_ms(text: &str, headers: &HeaderMap) -> Option<u64> {
    let now = || http_date_s(headers.get("date")?.to_str().ok()?);
    let ms = duration_ms(text).or_else(|| Some((rfc3339_s(text)? - now()?) * 1e3))?;
    whole(ms)
}

fn capped(ms: f64) -> Option<u64> {
    whole(ms).map(|ms| ms.min(LONGEST_MS))
}

fn whole(ms: f64) -> Option<u64> {
    if !ms.is_finite() || ms < 0.0 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "finite and not negative")]
    {
        Some(ms.ceil() as u64)
    }
}

/// A duration such as `6m0s`, `1.5s` or `120ms` in ms.
fn duration_ms(text: &str) -> Option<f64> {
    Some(text.parse::<SignedDuration>().ok()?.as_secs_f64() * 1e3)
}

/// `Sun, 22 Nov 2026 02:00:30 GMT` (RFC 9110) in seconds since 1970.
fn http_date_s(text: &str) -> Option<f64> {
    Some(seconds(rfc2822::DateTimeParser::new().parse_timestamp(text).ok()?))
}

/// `2026-11-22T02:00:30Z` in seconds since 1970.
fn rfc3339_s(text: &str) -> Option<f64> {
    Some(seconds(text.parse::<Timestamp>().ok()?))
}

fn seconds(at: Timestamp) -> f64 {
    at.as_duration().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reqwest::header::{HeaderName, HeaderValue};
    use serde_json::json;

    fn wait(pairs: &[(&'static str, &'static str)]) -> Option<u64> {
        let pairs = pairs.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value)));
        retry_after_ms(&pairs.collect())
    }

    #[test]
    fn milliseconds_win_over_seconds_over_resets() {
        assert_eq!(wait(&[("retry-after-ms", "250"), ("retry-after", "3")]), Some(250));
        assert_eq!(wait(&[("retry-after", "1.5"), ("x-ratelimit-reset-tokens", "9s")]), Some(1500));
        assert_eq!(
            wait(&[("x-ratelimit-reset-requests", "120ms"), ("x-ratelimit-reset-tokens", "1m2s")]),
            Some(62_000)
        );
        assert_eq!(wait(&[("retry-after", "Wed, 21 Oct")]), None);
    }

    #[test]
    fn a_date_is_held_against_the_servers_own_clock() {
        let pairs = [("date", "Sat, 28 Feb 2026 23:59:50 GMT"), ("retry-after", "Sun, 01 Mar 2026 00:00:20 GMT")];
        assert_eq!(wait(&pairs), Some(30_000));
        assert_eq!(wait(&pairs[1..]), None);
        assert_eq!(http_date_s("Wed, 01 Mar 2000 00:00:00 GMT"), Some(11_017.0 * 86_400.0));
        assert_eq!(rfc3339_s("2000-03-01T00:00:00Z"), Some(11_017.0 * 86_400.0));
        assert_eq!((duration_ms("6m0s"), duration_ms("120ms"), duration_ms("soon")), (Some(3.6e5), Some(120.0), None));
    }

    #[test]
    fn an_error_may_hold_the_wait() {
        let error = json!({"details": [{"@type": "Help"}, {"@type": "RetryInfo", "retryDelay": "17s"}]});
        assert_eq!(retry_delay_ms(&error), Some(17_000));
        assert_eq!(retry_delay_ms(&json!({"details": "none"})), None);
    }

    #[test]
    fn nobody_makes_us_wait_for_an_hour() {
        assert_eq!(wait(&[("retry-after", "3600")]), Some(120_000));
    }
}
