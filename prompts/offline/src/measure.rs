//! Distances, durations and paces of a clause.

use crate::clause::{Found, mark, mark_each};
use crate::cut::Stretch;
use crate::lexicon::lexicon;
use crate::words::find;

/// Words behind a length that make it the size of a thing.
const SIZES: &[&str] = &["wide", "tall", "long", "high", "broad", "deep", "width", "height", "thick", "big"];

/// `3 m`, `for 5 seconds`, `after 10 s`, `very close`.
pub(crate) fn measures(stretch: &mut Stretch, found: &mut Found) {
    for i in 0..stretch.words.len() {
        let Some(number) =
            stretch.words.get(i).filter(|word| !word.used || word.is_digits()).and_then(|word| word.number())
        else {
            continue;
        };
        // `one and a half meters`
        let half = |k: usize| {
            ["and", "a", "half"]
                .iter()
                .enumerate()
                .all(|(n, word)| stretch.words.get(k + n).is_some_and(|at| at.text == *word))
        };
        let (number, i) = if half(i + 1) { (number + 0.5, i + 3) } else { (number, i) };
        // `a couple of meters`
        let of = stretch.words.get(i + 1).is_some_and(|word| word.text == "of");
        let unit_at = i + 1 + usize::from(of && !stretch.words.get(i).is_some_and(|word| word.is_digits()));
        let unit = stretch.words.get(unit_at).map_or("", |word| word.stem.as_str());
        let before = if i == 0 { "" } else { stretch.words.get(i - 1).map_or("", |word| word.text.as_str()) };
        // `0.5 m/s`, `2 meters per second`, `3 km/h`: a pace.
        let next = |k: usize| stretch.words.get(i + k).map_or("", |word| word.stem.as_str());
        let per_second = unit == "meter" && (next(2) == "second" || next(2) == "per" && next(3) == "second");
        let per_hour = unit == "km" && (matches!(next(2), "h" | "hour") || next(2) == "per" && next(3) == "hour");
        if per_second || per_hour {
            let mps = if per_hour { number / 3.6 } else { number };
            found.pace_mps = Some(found.within(mps, (0.3, 1.8), "m/s"));
            found.pace_said = true;
            mark(stretch, i, i + 2 + usize::from(next(2) == "per"));
            continue;
        }
        let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
        if matches!(unit, "meter" | "centimeter") {
            // `2.4 m wide`, `a corridor of 2 m width`, `1.80 m tall` measure things.
            if SIZES.contains(&text(unit_at + 1)) {
                continue;
            }
            let apart = |word: &str| matches!(word, "distance" | "separation" | "range" | "radius" | "gap");
            found.distance_is_when |= matches!(
                before,
                "at" | "within" | "from" | "under" | "below" | "than" | "inside" | "only" | "just" | "last" | "robot"
            ) || matches!(before, "of" | "to" | "about" | "roughly" | "around")
                && (0..i).any(|k| apart(text(k)) || text(k) == "at" || text(k) == "within")
                || matches!(text(unit_at + 1), "away" | "off" | "left" | "before" | "apart" | "out" | "distant");
        }
        match unit {
            "meter" => found.distance_m = Some(found.within(number, (0.3, 15.0), "m")),
            "centimeter" => found.distance_m = Some(found.within(number / 100.0, (0.3, 15.0), "m")),
            "second" | "minute" => {
                let secs = if unit == "minute" { number * 60.0 } else { number };
                let secs = found.within(secs, (0.5, 120.0), "s");
                // `after just a few seconds`
                let roughly = |word: &str| {
                    matches!(word, "a" | "about" | "some" | "another" | "roughly" | "approximately" | "only" | "just")
                };
                let about = (0..i).rev().find(|k| !roughly(text(*k)));
                let after = about.is_some_and(|k| text(k) == "after")
                    || matches!(before, "at" | "t")
                    || matches!(text(unit_at + 1), "later" | "after" | "into")
                    || text(unit_at + 1) == "in" && text(unit_at + 2).is_empty();
                if after { found.after_s = Some(secs) } else { found.lasts_s = Some(secs) }
            }
            _ => continue,
        }
        mark(stretch, i, unit_at);
    }
    if let Some((at, secs)) = span(stretch) {
        let before = at.checked_sub(1).and_then(|i| stretch.words.get(i)).map_or("", |word| word.text.as_str());
        if before == "after" {
            found.after_s = Some(secs)
        } else {
            found.lasts_s = Some(secs)
        }
        let to = (at..stretch.words.len()).find(|i| unit_s(stretch, *i).is_some()).unwrap_or(at);
        mark(stretch, at, to);
    }
    // `a meter away`, `half a meter`.
    if found.distance_m.is_none() {
        let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
        let at = (1..stretch.words.len()).find(|k| {
            matches!(text(*k), "meter" | "metre" | "m") && text(k - 1) == "a" && !SIZES.contains(&text(k + 1))
        });
        if let Some(at) = at {
            let half = at >= 2 && text(at - 2) == "half";
            let more = text(at + 1) == "and" && text(at + 2) == "a" && text(at + 3) == "half";
            found.distance_m = Some(if half {
                0.5
            } else if more {
                1.5
            } else {
                1.0
            });
            found.distance_is_when = true;
            mark(stretch, at, at);
        }
    }
    if found.distance_m.is_none() {
        for phrase in &lexicon().distances {
            let free = |_: usize| true;
            if let Some(at) = find(&stretch.words, phrase, 0, false, &free) {
                found.distance_m = Some(phrase.means);
                mark_each(stretch, &at);
                break;
            }
        }
    }
}

/// Seconds that a word of time stands for.
fn unit_s(stretch: &Stretch, at: usize) -> Option<f64> {
    match stretch.words.get(at)?.stem.as_str() {
        "minute" => Some(60.0),
        "second" => Some(1.0),
        "moment" | "instant" => Some(3.0),
        "while" => Some(6.0),
        _ => None,
    }
}

/// `half a minute`, `a moment`, `a short while`: from which word on, and how long, s.
fn span(stretch: &Stretch) -> Option<(usize, f64)> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    (0..stretch.words.len()).find_map(|at| {
        let half = text(at) == "half" && matches!(text(at + 1), "a" | "an");
        // `a quarter of a minute`, `three quarters of a minute`
        let quarters = match (text(at), text(at + 1), text(at + 2)) {
            ("a", "quarter", "of") => Some(1.0),
            ("three", "quarters", "of") => Some(3.0),
            _ => None,
        };
        if let Some(unit) = quarters.filter(|_| text(at + 3) == "a").and_then(|_| unit_s(stretch, at + 4)) {
            return Some((at, unit * quarters? / 4.0));
        }
        let start = at + usize::from(half);
        if !matches!(text(start), "a" | "an") {
            return None;
        }
        let long = matches!(text(start + 1), "short" | "brief" | "little" | "long" | "full");
        // `the second nurse` and `a second one` count nothing.
        let unit = unit_s(stretch, start + 1 + usize::from(long))
            .filter(|_| half || text(start + 1 + usize::from(long)) != "second")?;
        Some((
            at,
            unit * if half {
                0.5
            } else if text(start + 1) == "long" {
                3.0
            } else {
                1.0
            },
        ))
    })
}
