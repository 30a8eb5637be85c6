//! One clause: what people, deeds, places, distances and durations its words hold.

use socrates_model::{Gesture, PlaceClass};

use crate::cut::{Joint, Stretch};
use crate::lexicon::{Act, Cue, Item, lexicon};
use crate::mention::{Mention, mentions};
use crate::words::find;

/// A deed and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Deed {
    pub(crate) act: Act,
    /// First word.
    pub(crate) at: usize,
    /// Last word.
    pub(crate) to: usize,
    /// `does not`, `without`.
    pub(crate) negated: bool,
}

/// What a clause holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Found {
    pub(crate) mentions: Vec<Mention>,
    /// Robot words that no phrase has as its object.
    pub(crate) robots: Vec<usize>,
    pub(crate) deeds: Vec<Deed>,
    pub(crate) cue: Option<(Cue, usize)>,
    pub(crate) gesture: Option<Gesture>,
    /// First word of the verb that says so.
    pub(crate) gesture_at: usize,
    pub(crate) places: Vec<(PlaceClass, usize)>,
    /// Places that no map can hold.
    pub(crate) nowhere: Vec<usize>,
    /// Verbs without a form in the simulation.
    pub(crate) impossible: Vec<usize>,
    pub(crate) distance_m: Option<f64>,
    /// `at 2 m`: the distance says when, not how far.
    pub(crate) distance_is_when: bool,
    pub(crate) lasts_s: Option<f64>,
    pub(crate) after_s: Option<f64>,
    pub(crate) pace_mps: Option<f64>,
    /// The pace was given as a number.
    pub(crate) pace_said: bool,
    /// `in a group`.
    pub(crate) in_group: bool,
    /// `there are`, `in the scenario`.
    pub(crate) declares: bool,
}

impl Found {
    /// Whether a deed of people (not only walking about) is in it.
    pub(crate) fn acts(&self) -> bool {
        !self.deeds.is_empty() || self.gesture.is_some()
    }
}

/// Reads a clause; words that something was read from are marked as used.
pub(crate) fn read(stretch: &mut Stretch) -> Found {
    let mut found = Found { mentions: mentions(&stretch.words), ..Found::default() };
    for mention in &found.mentions {
        for at in mention.from..=mention.to {
            // A word between that only describes, and that no table has, is read by nobody.
            if at == mention.to || at == mention.from || known(stretch, at) {
                mark(stretch, at, at);
            }
        }
    }
    measures(stretch, &mut found);
    let placed = places(stretch, &mut found);
    gesture(stretch, &mut found);
    let mut taken = vec![false; stretch.words.len()];
    if found.gesture.is_some() {
        for (i, word) in stretch.words.iter().enumerate() {
            if let Some(flag) = taken.get_mut(i) {
                *flag = word.used
                    && !found.mentions.iter().any(|mention| (mention.from..=mention.to).contains(&i))
                    && word.stem != "robot";
            }
        }
    }
    cue(stretch, &mut found, &mut taken);
    for (i, at) in placed.iter().enumerate() {
        if let Some(flag) = taken.get_mut(i) {
            *flag |= *at;
        }
    }
    deeds(stretch, &mut found, &mut taken);
    rest(stretch, &mut found, &taken);
    found
}

fn known(stretch: &Stretch, at: usize) -> bool {
    let lex = lexicon();
    stretch.words.get(at).is_some_and(|word| {
        [&lex.known, &lex.stop, &lex.adjectives]
            .iter()
            .any(|table| table.contains(&word.text) || table.contains(&word.stem))
            || word.number().is_some()
    })
}

fn mark(stretch: &mut Stretch, from: usize, to: usize) {
    for word in stretch.words.iter_mut().take(to + 1).skip(from) {
        word.used = true;
    }
}

fn mark_each(stretch: &mut Stretch, at: &[usize]) {
    for i in at {
        mark(stretch, *i, *i);
    }
}

/// `3 m`, `for 5 seconds`, `after 10 s`, `very close`.
fn measures(stretch: &mut Stretch, found: &mut Found) {
    for i in 0..stretch.words.len() {
        let Some(number) =
            stretch.words.get(i).filter(|word| !word.used || word.is_digits()).and_then(|word| word.number())
        else {
            continue;
        };
        let unit = stretch.words.get(i + 1).map_or("", |word| word.stem.as_str());
        let before = if i == 0 { "" } else { stretch.words.get(i - 1).map_or("", |word| word.text.as_str()) };
        // `0.5 m/s`, `2 meters per second`, `3 km/h`: a pace.
        let next = |k: usize| stretch.words.get(i + k).map_or("", |word| word.stem.as_str());
        let per_second = unit == "meter" && (next(2) == "second" || next(2) == "per" && next(3) == "second");
        let per_hour = unit == "km" && (matches!(next(2), "h" | "hour") || next(2) == "per" && next(3) == "hour");
        if per_second || per_hour {
            found.pace_mps = Some((if per_hour { number / 3.6 } else { number }).clamp(0.3, 1.8));
            found.pace_said = true;
            mark(stretch, i, i + 2 + usize::from(next(2) == "per"));
            continue;
        }
        if matches!(unit, "meter" | "centimeter") {
            found.distance_is_when |= matches!(before, "at" | "within" | "from" | "under");
        }
        match unit {
            "meter" => found.distance_m = Some(number.clamp(0.3, 15.0)),
            "centimeter" => found.distance_m = Some((number / 100.0).clamp(0.3, 15.0)),
            "second" | "minute" => {
                let secs = (if unit == "minute" { number * 60.0 } else { number }).clamp(0.5, 120.0);
                if before == "after" { found.after_s = Some(secs) } else { found.lasts_s = Some(secs) }
            }
            _ => continue,
        }
        mark(stretch, i, i + 1);
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

/// Finds places; says which words they take, so that `the exit` is no deed.
fn places(stretch: &mut Stretch, found: &mut Found) -> Vec<bool> {
    let mut taken = vec![false; stretch.words.len()];
    for phrase in &lexicon().places {
        let mut from = 0;
        while let Some(at) = find(&stretch.words, phrase, from, true, &|i| !taken.get(i).copied().unwrap_or(true)) {
            from = at.first().map_or(usize::MAX, |i| i + 1);
            // `corner of the warehouse` is an end of the map, no blind corner.
            let end = at.last().copied().unwrap_or(0);
            let of = stretch.words.get(end + 1).is_some_and(|word| word.text == "of");
            let opens = stretch.words.get(end + 1).is_some_and(|word| word.stem == "open");
            // `makes room` is no room.
            let made = at.first().and_then(|i| i.checked_sub(1)).and_then(|i| stretch.words.get(i));
            if at.len() == 1
                && phrase.means == PlaceClass::Room
                && made.is_some_and(|word| {
                    matches!(word.stem.as_str(), "make" | "enough" | "no" | "some" | "more" | "give")
                })
            {
                continue;
            }
            for i in &at {
                if let Some(flag) = taken.get_mut(*i) {
                    *flag = true;
                }
            }
            mark_each(stretch, &at);
            let map_end = phrase.means == PlaceClass::BlindCorner && of && at.len() == 1;
            if !opens && !map_end {
                found.places.push((phrase.means, at.first().copied().unwrap_or(0)));
            }
        }
    }
    found.places.sort_by_key(|(_, at)| *at);
    found.nowhere = (0..stretch.words.len())
        .filter(|i| {
            stretch
                .words
                .get(*i)
                .is_some_and(|word| lexicon().nowhere.contains(&word.text) || lexicon().nowhere.contains(&word.stem))
        })
        .collect();
    taken
}

/// A gesture needs a verb (or the word `gesture`) and a message near it.
fn gesture(stretch: &mut Stretch, found: &mut Found) {
    let verbs = lexicon().actions.iter().filter(|phrase| phrase.means == Act::Gesture);
    let Some(verb) = verbs.filter_map(|phrase| find(&stretch.words, phrase, 0, false, &|_| true)).min() else { return };
    let (first, last) = (verb.first().copied().unwrap_or(0), verb.last().copied().unwrap_or(0));
    found.gesture_at = first;
    if stretch.words.get(first).is_some_and(|word| word.stem == "acknowledge") {
        found.gesture = Some(Gesture::Acknowledged);
        mark_each(stretch, &verb);
        return;
    }
    // `waves it on`, `beckons the robot through`, `motions it back`.
    if stretch.words.get(first).is_some_and(|word| matches!(word.stem.as_str(), "wave" | "beckon" | "motion")) {
        let robot =
            |word: &crate::words::Word| word.stem == "robot" || matches!(word.text.as_str(), "the" | "at" | "to");
        let next = (last + 1..stretch.words.len()).find(|i| stretch.words.get(*i).is_some_and(|word| !robot(word)));
        let says = next.and_then(|i| stretch.words.get(i)).and_then(|word| match word.text.as_str() {
            "on" | "through" | "past" | "by" | "along" | "across" | "forward" | "closer" | "over" => {
                Some(Gesture::Proceed)
            }
            "back" | "off" | "away" => Some(Gesture::Wait),
            _ => None,
        });
        if let (Some(says), Some(at)) = (says, next) {
            found.gesture = Some(says);
            mark_each(stretch, &verb);
            mark(stretch, at, at);
            return;
        }
    }
    let noun = stretch.words.get(last).is_some_and(|word| word.stem == "gesture" || word.stem == "signal");
    for (from, to) in [(last + 1, last + 9), (first.saturating_sub(if noun { 3 } else { 0 }), first)] {
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
}

fn cue(stretch: &mut Stretch, found: &mut Found, taken: &mut [bool]) {
    let temporal = matches!(stretch.joint, Joint::When | Joint::Until | Joint::While);
    let robot = stretch.words.iter().position(|word| word.stem == "robot");
    if let Some(robot) = robot.filter(|robot| {
        temporal && found.gesture.is_some() && found.mentions.iter().all(|mention| mention.from > *robot)
    }) {
        found.cue = Some((Cue::Says, robot));
        return;
    }
    for phrase in &lexicon().cues {
        if !temporal && phrase.means != Cue::Visible {
            continue;
        }
        let free = |i: usize| !taken.get(i).copied().unwrap_or(true);
        let Some(at) = find(&stretch.words, phrase, 0, false, &free) else { continue };
        let first = at.first().copied().unwrap_or(0);
        if negated(stretch, first) {
            continue;
        }
        for i in &at {
            if let Some(flag) = taken.get_mut(*i) {
                *flag = true;
            }
        }
        mark_each(stretch, &at);
        found.cue = Some((phrase.means, first));
        return;
    }
}

fn negated(stretch: &Stretch, at: usize) -> bool {
    let before =
        |back: usize| at.checked_sub(back).and_then(|i| stretch.words.get(i)).map_or("", |word| word.text.as_str());
    (1..=2).any(|back| {
        matches!(before(back), "not" | "never" | "without" | "cannot" | "refuses" | "refuse" | "fails" | "fail" | "nor")
            || before(back) == "of" && before(back + 1) == "instead"
            || before(back) == "than" && before(back + 1) == "rather"
    }) || (0..at).any(|i| stretch.words.get(i).is_some_and(|word| matches!(word.text.as_str(), "neither" | "none")))
}

fn deeds(stretch: &mut Stretch, found: &mut Found, taken: &mut [bool]) {
    // The name of a gesture is no deed: `with a WAIT gesture`.
    for i in 0..stretch.words.len() {
        let (Some(word), Some(next)) = (stretch.words.get(i), stretch.words.get(i + 1)) else { break };
        let message = [Item::Word(word.stem.clone())];
        if matches!(next.stem.as_str(), "gesture" | "signal" | "sign")
            && lexicon().gestures.iter().any(|phrase| phrase.items == message)
        {
            mark(stretch, i, i);
            if let Some(flag) = taken.get_mut(i) {
                *flag = true;
            }
        }
    }
    for phrase in &lexicon().actions {
        if phrase.means == Act::Gesture {
            continue;
        }
        let mut from = 0;
        while let Some(at) = find(&stretch.words, phrase, from, false, &|i| !taken.get(i).copied().unwrap_or(true)) {
            let (first, last) = (at.first().copied().unwrap_or(0), at.last().copied().unwrap_or(0));
            from = first + 1;
            for i in &at {
                if let Some(flag) = taken.get_mut(*i) {
                    *flag = true;
                }
            }
            mark_each(stretch, &at);
            let says_not = stretch.words.get(first).is_some_and(|word| word.text == "not");
            found.deeds.push(Deed {
                act: phrase.means,
                at: first,
                to: last,
                negated: !says_not && negated(stretch, first),
            });
        }
    }
    found.deeds.sort_by_key(|deed| deed.at);
    let has = |acts: &[Act]| found.deeds.iter().any(|deed| acts.contains(&deed.act) && !deed.negated);
    // The more telling word wins: `approaches from behind` is no coming up to the robot out of curiosity.
    let directed = has(&[Act::Toward, Act::Behind, Act::Cross, Act::Overtake]);
    let telling = found.deeds.iter().any(|deed| !matches!(deed.act, Act::Walk | Act::Pass | Act::Stand | Act::Stop));
    let follows = has(&[Act::Follow]);
    let stands = has(&[Act::Block, Act::Look]);
    let keep = |deed: &Deed| match deed.act {
        // `a curious visitor follows` goes after the robot, not up to it.
        Act::Approach if follows => !directed && deed.at != deed.to,
        Act::Approach => !directed,
        Act::Walk | Act::Pass => !telling || deed.negated,
        Act::Stop => !stands,
        Act::RunAway
        | Act::GiveWay
        | Act::Block
        | Act::Look
        | Act::Toward
        | Act::Overtake
        | Act::Behind
        | Act::Abreast
        | Act::Ahead
        | Act::Follow
        | Act::Cross
        | Act::ComeOut
        | Act::Stay
        | Act::Enter
        | Act::Talk
        | Act::WalkTogether
        | Act::Stand
        | Act::Ignore
        | Act::Gesture
        | Act::Lead => true,
    };
    let kept = found.deeds.iter().copied().filter(keep).collect();
    found.deeds = kept;
}

fn rest(stretch: &mut Stretch, found: &mut Found, taken: &[bool]) {
    let lex = lexicon();
    let (mut used, mut seated) = (Vec::new(), Vec::new());
    for (i, word) in stretch.words.iter().enumerate() {
        let text = word.text.as_str();
        let before = if i == 0 { "" } else { stretch.words.get(i - 1).map_or("", |word| word.text.as_str()) };
        if let Some(mps) = lex.pace.get(text).or_else(|| lex.pace.get(&word.stem)) {
            found.pace_mps = found.pace_mps.filter(|_| found.pace_said).or(Some(*mps));
            used.push(i);
        }
        if word.stem == "robot" {
            if !taken.get(i).copied().unwrap_or(false) && before != "of" && before != "by" {
                found.robots.push(i);
            }
            used.push(i);
        }
        if text == "group" && matches!(before, "a" | "the" | "one" | "same" | "small" | "large") {
            found.in_group = true;
            used.push(i);
        }
        if text == "suddenly" || text == "together" {
            used.push(i);
        }
        let exists = text == "there"
            && stretch
                .words
                .get(i + 1)
                .is_some_and(|next| matches!(next.text.as_str(), "are" | "is" | "will" | "should" | "must"));
        found.declares |= exists || text == "scenario" || text == "exactly";
        if lex.impossible.contains(&word.stem) && !word.used {
            found.impossible.push(i);
            // Who sits is at least somewhere: it stands there.
            if matches!(word.stem.as_str(), "sit" | "kneel" | "lie") && found.deeds.is_empty() {
                seated.push(Deed { act: Act::Stand, at: i, to: i, negated: false });
            }
        }
    }
    found.deeds.extend(seated);
    mark_each(stretch, &used);
}
