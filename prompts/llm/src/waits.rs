//! How long a server wants us to wait.

use reqwest::header::HeaderMap;

/// Longest wait that a server may ask for, ms.
const LONGEST_MS: u64 = 120_000;

/// The wait in ms: `retry-after-ms`, else `retry-after` in seconds, else the reset time of the rate limit.
pub(crate) fn retry_after_ms(headers: &HeaderMap) -> Option<u64> {
    let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok()).map(str::trim);
    let ms = text("retry-after-ms").and_then(|value| value.parse::<f64>().ok());
    let secs = text("retry-after").and_then(|value| value.parse::<f64>().ok()).map(|secs| secs * 1e3);
    let reset = || {
        let resets = ["x-ratelimit-reset-requests", "x-ratelimit-reset-tokens"];
        resets.into_iter().filter_map(|name| text(name).and_then(duration_ms)).reduce(f64::max)
    };
    let wait = ms.or(secs).or_else(reset).filter(|ms| ms.is_finite() && *ms >= 0.0)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "finite, not negative, and capped below"
    )]
    Some((wait.ceil() as u64).min(LONGEST_MS))
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
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use reqwest::header::{HeaderName, HeaderValue};

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
    fn nobody_makes_us_wait_for_an_hour() {
        assert_eq!(wait(&[("retry-after", "3600")]), Some(120_000));
    }
}
