//! How long a server wants us to wait.
//!
//! Dates are taken relative to the `date` of the same answer: the server's clock against the server's clock.

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
    let mut total = 0.0;
    let mut rest = text;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || c == '.'))?;
        let (number, tail) = rest.split_at_checked(digits)?;
        let unit_len = tail.find(|c: char| c.is_ascii_digit()).unwrap_or(tail.len());
        let (unit, next) = tail.split_at_checked(unit_len)?;
        let factor = match unit {
            "h" => 3.6e6,
            "m" => 6e4,
            "s" => 1e3,
            "ms" => 1.0,
            "us" | "µs" => 1e-3,
            _ => return None,
        };
        total += number.parse::<f64>().ok()? * factor;
        rest = next;
    }
    (!text.is_empty()).then_some(total)
}

/// `Sun, 22 Nov 2026 02:00:30 GMT` (RFC 9110) in seconds since 1970.
fn http_date_s(text: &str) -> Option<f64> {
    const MONTHS: [&str; 12] = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
    let mut parts = text.split_ascii_whitespace().skip(1);
    let day = parts.next()?.parse().ok()?;
    let month = parts.next()?;
    let month = MONTHS.iter().position(|name| *name == month)?;
    let year = parts.next()?.parse().ok()?;
    Some(days(year, i32::try_from(month).ok()? + 1, day)? * 86_400.0 + clock_s(parts.next()?)?)
}

/// `2026-11-22T02:00:30Z` in seconds since 1970; only in UTC.
fn rfc3339_s(text: &str) -> Option<f64> {
    let (date, time) = text.strip_suffix('Z')?.split_once('T')?;
    let mut parts = date.split('-').map(|part| part.parse::<i32>().ok());
    let (year, month, day) = (parts.next()??, parts.next()??, parts.next()??);
    Some(days(year, month, day)? * 86_400.0 + clock_s(time)?)
}

fn clock_s(text: &str) -> Option<f64> {
    let mut parts = text.split(':').map(|part| part.parse::<f64>().ok());
    Some(parts.next()?? * 3600.0 + parts.next()?? * 60.0 + parts.next()??)
}

/// Days from 1970-01-01 in the Gregorian calendar, counted in years that begin in March.
fn days(year: i32, month: i32, day: i32) -> Option<f64> {
    if !(1970..=9999).contains(&year) || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(f64::from(year * 365 + year / 4 - year / 100 + year / 400 + day_of_year - 719_468))
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
        assert_eq!(days(1970, 1, 1), Some(0.0));
        assert_eq!(days(2000, 3, 1), Some(11_017.0));
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
