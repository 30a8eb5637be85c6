//! A recording as a file, also a part of it: viewers of others read the index at its end and then what they need.

use axum::http::{HeaderMap, Method, Response, StatusCode, header};
use bytes::Bytes;

/// What a `Range` header asks for of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// All of it: none was asked for, or in a way that may be passed over.
    Whole,
    /// From one byte to before another.
    Span(usize, usize),
    /// Beyond the end.
    Beyond,
}

/// Reads `bytes=first-last`, `bytes=first-` or `bytes=-count`; several at once are answered with all.
fn part(range: Option<&str>, len: usize) -> Part {
    let Some((first, last)) = range.and_then(|range| range.strip_prefix("bytes=")?.split_once('-')) else {
        return Part::Whole;
    };
    let number = |text: &str| text.trim().parse::<usize>().ok();
    let span = match (first.trim(), last.trim()) {
        ("", count) => number(count).map(|count| (len.saturating_sub(count), len)),
        (first, "") => number(first).map(|first| (first, len)),
        (first, last) => number(first).zip(number(last)).map(|(first, last)| (first, last.saturating_add(1).min(len))),
    };
    match span {
        None => Part::Whole,
        Some((first, end)) if first < end => Part::Span(first, end),
        Some(_) => Part::Beyond,
    }
}

/// The answer to a question for a file of this digest.
pub fn answer(method: &Method, headers: &HeaderMap, digest: &str, file: Bytes) -> Response<Bytes> {
    let text = |name: header::HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    let tag = format!("\"{digest}\"");
    let answer = Response::builder()
        .header(header::CONTENT_TYPE, "application/octet-stream")
        .header(header::CONTENT_DISPOSITION, "attachment")
        .header(header::ACCEPT_RANGES, "bytes")
        .header(header::ETAG, &tag);
    if text(header::IF_NONE_MATCH).is_some_and(|known| known.split(',').any(|known| known.trim() == tag)) {
        return answer.status(StatusCode::NOT_MODIFIED).body(Bytes::new()).unwrap_or_default();
    }
    // A part of another file is of no use to one who has the beginning of this one.
    let same = text(header::IF_RANGE).is_none_or(|known| known == tag);
    let (len, whole) = (file.len(), method == Method::HEAD);
    let part = part(text(header::RANGE).filter(|_| same), len);
    let answer = match part {
        Part::Whole => answer.header(header::CONTENT_LENGTH, len).body(if whole { Bytes::new() } else { file }),
        Part::Span(first, end) => answer
            .status(StatusCode::PARTIAL_CONTENT)
            .header(header::CONTENT_RANGE, format!("bytes {first}-{}/{len}", end - 1))
            .header(header::CONTENT_LENGTH, end - first)
            .body(if whole { Bytes::new() } else { file.slice(first..end) }),
        Part::Beyond => answer
            .status(StatusCode::RANGE_NOT_SATISFIABLE)
            .header(header::CONTENT_RANGE, format!("bytes */{len}"))
            .body(Bytes::new()),
    };
    answer.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_read_as_the_standard_has_it() {
        for (range, wanted) in [
            (None, Part::Whole),
            (Some("bytes=0-9"), Part::Span(0, 10)),
            (Some("bytes=90-"), Part::Span(90, 100)),
            (Some("bytes=-8"), Part::Span(92, 100)),
            (Some("bytes=-800"), Part::Span(0, 100)),
            (Some("bytes=90-900"), Part::Span(90, 100)),
            (Some("bytes=100-"), Part::Beyond),
            (Some("bytes=9-3"), Part::Beyond),
            (Some("bytes=-0"), Part::Beyond),
            (Some("bytes=0-1,5-6"), Part::Whole),
            (Some("bytes=a-b"), Part::Whole),
            (Some("lines=0-1"), Part::Whole),
            (Some("bytes=99999999999999999999999-"), Part::Whole),
        ] {
            assert_eq!(part(range, 100), wanted, "{range:?}");
        }
    }

    #[test]
    fn a_known_file_is_not_sent_again_and_a_changed_one_is_sent_whole() {
        let file = Bytes::from_static(b"0123456789");
        let ask = |pairs: &[(header::HeaderName, &str)]| {
            let headers = pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect();
            answer(&Method::GET, &headers, "abc", file.clone())
        };
        assert_eq!(ask(&[(header::IF_NONE_MATCH, "\"x\", \"abc\"")]).status(), StatusCode::NOT_MODIFIED);
        let part = ask(&[(header::RANGE, "bytes=2-4"), (header::IF_RANGE, "\"abc\"")]);
        assert_eq!((part.status(), &part.body()[..]), (StatusCode::PARTIAL_CONTENT, &b"234"[..]));
        assert_eq!(part.headers()[header::CONTENT_RANGE], "bytes 2-4/10");
        let other = ask(&[(header::RANGE, "bytes=2-4"), (header::IF_RANGE, "\"old\"")]);
        assert_eq!((other.status(), other.body().len()), (StatusCode::OK, 10));
        assert_eq!(ask(&[(header::RANGE, "bytes=10-")]).status(), StatusCode::RANGE_NOT_SATISFIABLE);
    }
}
