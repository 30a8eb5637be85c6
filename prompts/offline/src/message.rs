//! What somebody says or signals in a clause.

use socrates_model::Gesture;

use crate::clause::{Found, mark, mark_each};
use crate::cut::{Joint, Stretch};
use crate::lexicon::{Act, lexicon};
use crate::words::{Word, find};

/// Verbs that ask for something for the one who asks: `asks to pass`.
const ASKS: &[&str] = &["ask", "request", "beg", "demand", "call"];
/// What a signal without words means.
const MUTE: &[(&[&str], Gesture)] = &[
    (&["request", "beep", "honk", "buzz", "chime", "horn", "ring", "hoot", "toot"], Gesture::ExcuseMe),
    (&["hand", "hands", "palm", "arm", "flag"], Gesture::Wait),
    (&["thumb", "nod", "greet"], Gesture::Acknowledged),
    (&["acknowledge", "thank", "confirm"], Gesture::Acknowledged),
];

/// A gesture needs a verb (or the word `gesture`) and a message near it; a raised hand and a horn are their own.
pub(crate) fn message(stretch: &mut Stretch, found: &mut Found) {
    let temporal = matches!(stretch.joint, Joint::When | Joint::Until | Joint::While);
    // `lets it go first with a warm wave of her hand`
    let stems: Vec<&str> = stretch.words.iter().map(|word| word.stem.as_str()).collect();
    let lets = stems.iter().position(|stem| *stem == "let");
    let with = lets.and_then(|lets| (lets..stems.len()).find(|k| stems.get(*k) == Some(&"with")));
    if let Some(with) = with
        && let Some(at) = (with + 1..stems.len().min(with + 5))
            .find(|k| matches!(stems.get(*k), Some(&("wave" | "gesture" | "sign" | "signal" | "motion"))))
    {
        (found.gesture, found.gesture_at) = (Some(Gesture::Proceed), at);
        found.mentions.retain(|mention| mention.from < with);
        mark(stretch, with, stretch.words.len().saturating_sub(1));
        return;
    }
    // `stops the robot with a gesture`
    let stops = stems
        .windows(2)
        .position(|pair| matches!(pair, ["stop" | "halt", "robot"]))
        .or_else(|| stems.windows(3).position(|three| matches!(three, ["stop" | "halt", "the", "robot"])));
    let with = stops.and_then(|stops| (stops..stems.len()).find(|k| stems.get(*k) == Some(&"with")));
    if let (Some(stops), Some(with)) = (stops, with)
        && (with + 1..stems.len().min(with + 5))
            .any(|k| matches!(stems.get(k), Some(&("hand" | "palm" | "gesture" | "sign" | "signal" | "motion"))))
    {
        (found.gesture, found.gesture_at) = (Some(Gesture::Wait), stops);
        mark(stretch, stops, stops);
        mark(stretch, with, stretch.words.len().saturating_sub(1));
        return;
    }
    let verbs = lexicon().actions.iter().filter(|phrase| phrase.means == Act::Gesture);
    let verb = verbs
        .filter_map(|phrase| find(&stretch.words, phrase, 0, false, &|_| true))
        .min_by_key(|at| (at.first().copied(), std::cmp::Reverse(at.len())));
    let Some(verb) = verb else {
        alone(stretch, found, temporal);
        return;
    };
    let (first, last) = (verb.first().copied().unwrap_or(0), verb.last().copied().unwrap_or(0));
    found.gesture_at = first;
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    if stem(first) == "acknowledge" {
        found.gesture = Some(Gesture::Acknowledged);
        mark_each(stretch, &verb);
        return;
    }
    if let Some((says, at)) = pointed(stretch, first, last) {
        found.gesture = Some(says);
        mark_each(stretch, &verb);
        mark(stretch, at, at);
        return;
    }
    if let Some(to) = own_way(stretch, first, last) {
        found.gesture = Some(Gesture::ExcuseMe);
        mark_each(stretch, &verb);
        mark(stretch, last, to);
        return;
    }
    let noun = matches!(stem(last), "gesture" | "signal" | "sign");
    // `without asking it for space`, `the robot is not supposed to say excuse me`
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let denied = first.checked_sub(1).is_some_and(|k| text(k) == "without")
        || text(first.wrapping_sub(1)) == "to"
            && matches!(text(first.wrapping_sub(2)), "supposed" | "meant" | "allowed" | "expected")
            && text(first.wrapping_sub(3)) == "not";
    // `the robot must not ask for room`
    let robot = stretch.words.iter().take(3).any(|word| word.stem == "robot")
        && found.mentions.iter().all(|mention| mention.from > first);
    let never = robot && !temporal && crate::negation::negated(stretch, first);
    if denied || never {
        mark_each(stretch, &verb);
        return;
    }
    // `was asked to follow somebody` is an errand, nothing that is said now.
    let told = matches!(stem(first), "ask" | "tell" | "order" | "instruct" | "request")
        && first.checked_sub(1).is_some_and(|k| stem(k) == "be")
        && !stretch.words.iter().any(|word| word.text == "by");
    if told {
        return;
    }
    for (from, to) in
        [(first + 1, last), (last + 1, last + 15), (first.saturating_sub(if noun { 3 } else { 0 }), first)]
    {
        for phrase in &lexicon().gestures {
            let inside = |i: usize| (from..to).contains(&i) && !verb.contains(&i);
            if let Some(at) = find(&stretch.words, phrase, from, false, &inside) {
                found.gesture = Some(phrase.means);
                mark_each(stretch, &at);
                mark_each(stretch, &verb);
                return;
            }
        }
    }
    // `the robot asks`: for nothing but its way.
    let asks = stem(first) == "ask"
        && stretch.words.iter().skip(last + 1).all(|word| {
            matches!(
                word.text.as_str(),
                "once"
                    | "twice"
                    | "again"
                    | "politely"
                    | "nicely"
                    | "kindly"
                    | "loudly"
                    | "him"
                    | "her"
                    | "them"
                    | "to"
                    | "so"
                    | "thrice"
            )
        })
        && first.checked_sub(1).is_some_and(|k| stem(k) == "robot");
    if asks {
        found.gesture = Some(Gesture::ExcuseMe);
        mark_each(stretch, &verb);
        return;
    }
    // `waves at the robot`: a greeting.
    let greets = stem(first) == "wave"
        && (last + 1..last + 3).any(|at| {
            let between = at == last + 1
                || stretch.words.get(last + 1).is_some_and(|word| {
                    matches!(word.text.as_str(), "once" | "twice" | "thrice") || word.text.ends_with("ly")
                });
            between
                && stretch.words.get(at).is_some_and(|word| matches!(word.text.as_str(), "at" | "to"))
                && (at + 1..at + 3).any(|k| stem(k) == "robot")
        });
    if greets {
        found.gesture = Some(Gesture::Acknowledged);
        mark_each(stretch, &verb);
        return;
    }
    let mute = MUTE.iter().find(|(words, _)| verb.iter().any(|i| words.contains(&stem(*i))));
    if let Some((_, gesture)) = mute {
        found.gesture = Some(*gesture);
        mark_each(stretch, &verb);
    }
}

/// `waves it on`, `beckons the robot through`, `motions it back`: the message and where it stands.
fn pointed(stretch: &Stretch, first: usize, last: usize) -> Option<(Gesture, usize)> {
    let word = stretch.words.get(first)?;
    if !matches!(
        word.stem.as_str(),
        "wave" | "beckon" | "motion" | "gesture" | "signal" | "gesticulate" | "point" | "wink"
    ) {
        return None;
    }
    let robot = |word: &Word| {
        word.label
            || word.stem == "robot"
            || matches!(word.text.as_str(), "the" | "at" | "to" | "for" | "them" | "him" | "her")
    };
    let next = (last + 1..stretch.words.len()).find(|i| stretch.words.get(*i).is_some_and(|word| !robot(word)))?;
    let gesture = match stretch.words.get(next)?.text.as_str() {
        "on" | "through" | "past" | "by" | "along" | "across" | "forward" | "forwards" | "closer" | "over"
        | "onward" | "onwards" | "ahead" | "in" | "inside" => Gesture::Proceed,
        "back" | "off" | "away" => Gesture::Wait,
        _ => return None,
    };
    Some((gesture, next))
}

/// `asks to pass`, `requests passage`: the one who asks wants to get through. Where that ends.
fn own_way(stretch: &Stretch, first: usize, last: usize) -> Option<usize> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    if !ASKS.contains(&stem(first)) {
        return None;
    }
    let next = (last + 1..stretch.words.len())
        .find(|k| !matches!(text(*k), "politely" | "loudly" | "again" | "kindly" | "only"))?;
    let way = |k: usize| matches!(stem(k), "pass" | "passage" | "way" | "room" | "space" | "path" | "access" | "place");
    let goes = |k: usize| {
        matches!(stem(k), "pass" | "get" | "go" | "come" | "drive" | "move" | "squeeze" | "cross" | "continue")
            || text(k) == "be" && matches!(stem(k + 1), "let" | "allow")
    };
    match text(next) {
        "to" if goes(next + 1) => Some(next + 1),
        "for" if (next + 1..next + 4).any(way) => (next + 1..next + 4).find(|k| way(*k)),
        // `asks whether it may pass`
        "if" | "whether" => (stem(next + 1) == "robot"
            && matches!(stem(next + 2), "may" | "can" | "could" | "might")
            && goes(next + 3)
            && first.checked_sub(1).is_some_and(|k| stem(k) == "robot"))
        .then_some(next + 3),
        _ if way(next) => Some(next),
        _ => None,
    }
}

/// Where what was said before is spoken of: `upon the request`, `once the former has made this gesture`, `when he sees that`.
pub(crate) fn echoes(stretch: &mut Stretch) -> Option<usize> {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    let count = stretch.words.len();
    let noun =
        |k: usize| matches!(stem(k), "signal" | "gesture" | "sign" | "request" | "command" | "call" | "cue" | "order");
    // `Unless it says excuse me, he stays; if it does (say so), he …`
    let does = stretch.joint == Joint::When
        && (1..count.min(4)).any(|k| {
            matches!(text(k), "does" | "do" | "did")
                && (k + 1..count).all(|k| {
                    matches!(
                        text(k),
                        "so" | "that" | "it" | "get" | "close" | "say" | "ask" | "come" | "near" | "this" | "indeed"
                    )
                })
        });
    if does || matches!((count, text(0)), (1, "that" | "this")) {
        mark(stretch, 0, count.saturating_sub(1));
        return Some(0);
    }
    let at = (0..count).find(|k| {
        matches!(text(*k), "this" | "that" | "the" | "his" | "her" | "its" | "such") && noun(k + 1)
            // `once it has said that`, `as soon as she does so`, `if it does ask`
            || matches!(text(*k), "so" | "that" | "this")
                && k + 1 == count
                && *k > 0
                && matches!(stem(k - 1), "do" | "say" | "ask" | "signal" | "request" | "tell")
            // `only when the robot says it`
            || text(*k) == "it" && k + 1 == count && *k > 0 && matches!(stem(k - 1), "say")
            || matches!(stem(*k), "ask" | "say" | "signal" | "request" | "tell" | "gesture")
                && *k > 0
                // `if it does ask`, `once it has asked`
                && matches!(stem(k - 1), "do" | "have")
                && k + 2 >= count
            || matches!(text(*k), "that" | "this")
                && k + 1 == count
                && *k > 0
                && matches!(stem(k - 1), "see" | "hear" | "notice")
    });
    if let Some(at) = at {
        // How often it was said is another wish.
        let next = if matches!(text(at + 1), "twice" | "thrice" | "again") { at } else { at + 1 };
        mark(stretch, at, next.min(count.saturating_sub(1)));
    }
    at
}

/// A message without a verb: what somebody hears, or nothing but the message itself.
fn alone(stretch: &mut Stretch, found: &mut Found, temporal: bool) {
    let says = |at: usize| {
        temporal && at.checked_sub(1).and_then(|k| stretch.words.get(k)).is_some_and(|word| word.stem == "robot")
    };
    let hears = temporal && stretch.words.iter().any(|word| word.stem == "hear");
    for phrase in &lexicon().gestures {
        let Some(at) = find(&stretch.words, phrase, 0, false, &|_| true) else { continue };
        let (first, last) = (at.first().copied().unwrap_or(0), at.last().copied().unwrap_or(0));
        // `waits` is done, `WAIT` is said.
        let said = stretch.words.iter().all(|word| word.text == word.stem);
        // `upon the robot's PROCEED`
        let written = stretch.words.get(first).is_some_and(|word| word.capital);
        let hears = hears || written && says(first) && last + 1 == stretch.words.len();
        if hears
            || said
                && first == 0
                && last + 1 == stretch.words.len()
                && phrase.items.iter().all(|item| *item != crate::lexicon::Item::Gap)
        {
            if hears {
                (found.gesture, found.gesture_at) = (Some(phrase.means), first);
                mark_each(stretch, &at);
            } else {
                found.only_says = Some(phrase.means);
            }
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::sentences;

    fn said(text: &str) -> Option<Gesture> {
        let mut stretch = sentences(text).remove(0).remove(0);
        let mut found = Found::default();
        message(&mut stretch, &mut found);
        found.gesture
    }

    #[test]
    fn who_asks_to_pass_asks_for_room_and_who_lets_pass_gives_it() {
        for text in
            ["the robot asks to pass", "it requests passage", "the robot honks", "she asks the robot to let her by"]
        {
            assert_eq!(said(text), Some(Gesture::ExcuseMe), "{text}");
        }
        for text in
            ["the guard signals the robot to pass", "she waves it through", "he tells the robot that it may go on"]
        {
            assert_eq!(said(text), Some(Gesture::Proceed), "{text}");
        }
        for text in ["she puts her hand up", "he raises a hand", "a worker waves it back"] {
            assert_eq!(said(text), Some(Gesture::Wait), "{text}");
        }
        assert_eq!(said("the robot was asked to follow the doctor"), None);
    }
}
