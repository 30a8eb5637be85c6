//! One clause: what people, deeds, places, distances and durations its words hold.

use socrates_model::{Gesture, PlaceClass};

use crate::cut::{Joint, Stretch};
use crate::deeds::deeds;
use crate::hands::{handles, mounts, pours, takes_along};
use crate::lexicon::{Act, Cue, lexicon};
use crate::mention::{Mention, Who, mentions};
use crate::negation::negated;
use crate::topic::drop_topics;
use crate::words::{Word, find};
use crate::{measure, message};

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
    /// Robot words that are part of what somebody does: `comes up to the robot`.
    pub(crate) met: Vec<usize>,
    pub(crate) deeds: Vec<Deed>,
    pub(crate) cue: Option<(Cue, usize)>,
    pub(crate) gesture: Option<Gesture>,
    /// The clause is nothing but a message: `(WAIT)`.
    pub(crate) only_says: Option<Gesture>,
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
    /// `obeys`, `does as it is told`.
    pub(crate) obeys: bool,
    /// `in a group`.
    pub(crate) in_group: bool,
    /// `is approached`, `gets overtaken`.
    pub(crate) passive: bool,
    /// `there are`, `in the scenario`.
    pub(crate) declares: bool,
    /// Amounts that cannot be played, with what is played instead.
    pub(crate) limited: Vec<String>,
    /// Who does it stands behind the verb: `from the other side comes Anna`.
    pub(crate) inverted: bool,
    /// Words of a door that somebody opens or closes to walk through.
    pub(crate) moves_door: Option<(usize, usize)>,
    /// Amounts beyond reason: `35 m/s`.
    pub(crate) absurd: Vec<String>,
}

/// So many times more than can be played is a slip or a joke, and nothing is played instead.
const BEYOND_REASON: f64 = 16.0;

impl Found {
    /// An amount within its limits; says so where it is not.
    pub(crate) fn within(&mut self, amount: f64, (least, most): (f64, f64), unit: &str) -> f64 {
        let kept = amount.clamp(least, most);
        if amount > most * BEYOND_REASON {
            self.absurd.push(format!("`{amount} {unit}` is beyond what people do; say {least} to {most} {unit}"));
        } else if amount < least || amount > most {
            self.limited
                .push(format!("`{amount} {unit}` is outside {least} to {most} {unit}; {kept} {unit} is played"));
        }
        kept
    }

    /// Whether a deed of people (not only walking about) is in it.
    pub(crate) fn acts(&self) -> bool {
        !self.deeds.is_empty() || self.gesture.is_some()
    }
}

/// The last word of a door that somebody opens or closes to walk through: it does so by itself for whoever comes near. Held open
/// for somebody else, it would be a deed of their own.
fn door_moved(words: &[Word], at: usize) -> Option<usize> {
    let stem = |k: usize| words.get(k).map_or("", |word| word.stem.as_str());
    if !matches!(stem(at), "open" | "close") {
        return None;
    }
    let door = (at + 1..at + 5).find(|k| matches!(stem(*k), "door" | "doors"))?;
    (!(door + 1..words.len()).any(|k| stem(k) == "for")).then_some(door)
}

/// Reads a clause; words that something was read from are marked as used.
pub(crate) fn read(stretch: &mut Stretch) -> Found {
    let mut found = Found { mentions: mentions(&stretch.words), ..Found::default() };
    drop_topics(stretch, &mut found.mentions);
    for mention in &found.mentions {
        for at in mention.from..=mention.to {
            // A word between that only describes, and that no table has, is read by nobody.
            let tells = matches!(mention.who, Who::ToldApart) && at != mention.to && at != mention.from;
            if at == mention.to || at == mention.from {
                mark(stretch, at, at);
            } else if known(stretch, at) && !tells {
                skim(stretch, at);
            }
        }
    }
    measure::measures(stretch, &mut found);
    let placed = places(stretch, &mut found);
    message::message(stretch, &mut found);
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
    // What a heading says, or who asks, nobody does; nor are places deeds.
    for ((flag, place), word) in taken.iter_mut().zip(&placed).zip(&stretch.words) {
        *flag |= *place || word.label;
    }
    deeds(stretch, &mut found, &mut taken, &placed);
    rest(stretch, &mut found, &taken);
    let comes = |k: usize| {
        stretch
            .words
            .get(k)
            .is_some_and(|word| matches!(word.text.as_str(), "comes" | "come" | "walks" | "walk" | "follows" | "steps"))
    };
    found.inverted = matches!(text_of(stretch, 0), "from" | "behind" | "ahead" | "towards" | "out" | "next")
        && found.mentions.first().is_some_and(|mention| mention.from > 1 && comes(mention.from - 1));
    let being = |k: usize| stretch.words.get(k).is_some_and(|word| matches!(word.stem.as_str(), "be" | "get"));
    found.passive =
        stretch.words.iter().enumerate().any(|(k, word)| word.text.ends_with("ed") && k > 0 && being(k - 1));
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

pub(crate) fn mark(stretch: &mut Stretch, from: usize, to: usize) {
    for word in stretch.words.iter_mut().take(to + 1).skip(from) {
        (word.used, word.skimmed) = (true, false);
    }
}

/// Takes a word as part of a phrase of which other words are read; one that only describes stays unread.
fn skim(stretch: &mut Stretch, at: usize) {
    let Some(word) = stretch.words.get_mut(at).filter(|word| !word.used) else { return };
    let lex = lexicon();
    word.skimmed = lex.adjectives.contains(&word.text) || lex.adjectives.contains(&word.stem);
    word.used = true;
}

pub(crate) fn mark_each(stretch: &mut Stretch, at: &[usize]) {
    for i in at {
        mark(stretch, *i, *i);
    }
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
            // `the door opens`, `the doors open`; but somebody holds the door open.
            let plural = stretch.words.get(end).is_some_and(|word| word.text.ends_with('s'));
            let opens = phrase.means != PlaceClass::Elevator
                && stretch
                    .words
                    .get(end + 1)
                    .is_some_and(|word| word.stem == "open" && (word.text != "open" || plural));
            // `a ward sister` is no ward.
            if found.mentions.iter().any(|mention| (mention.from..mention.to).contains(&end)) {
                continue;
            }
            // `does not lift a finger`
            let lifts = stretch.words.get(end).is_some_and(|word| word.text == "lift")
                && end.checked_sub(1).and_then(|i| stretch.words.get(i)).is_some_and(|word| {
                    matches!(word.text.as_str(), "not" | "to" | "never" | "will" | "would" | "can" | "could")
                });
            // `on her way out`
            let goes_out = phrase.means == PlaceClass::Exit
                && text_of(stretch, end) == "out"
                && (1..=3).filter_map(|back| end.checked_sub(back)).any(|k| text_of(stretch, k) == "on");
            if lifts || goes_out || raises(stretch, end) {
                continue;
            }
            // `makes room` is no room.
            let made = at.first().and_then(|i| i.checked_sub(1)).and_then(|i| stretch.words.get(i));
            // `leave room for it`, but `leave room 3`.
            let leaves = made.is_some_and(|word| word.stem == "leave")
                && stretch.words.get(end + 1).is_none_or(|word| !matches!(word.text.as_str(), "for" | "to" | "so"));
            if at.len() == 1
                && phrase.means == PlaceClass::Room
                && !leaves
                && made.is_some_and(|word| {
                    matches!(
                        word.stem.as_str(),
                        "make" | "enough" | "no" | "some" | "more" | "give" | "leave" | "for" | "free" | "have"
                    )
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
    // `the ward corridor` is a corridor.
    let heads = |at: usize| taken.get(at + 1).copied().unwrap_or(false);
    let starts: Vec<usize> = found.places.iter().map(|(_, at)| *at).collect();
    found.places.retain(|(_, at)| !(heads(*at) && starts.contains(&(at + 1))));
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

/// `lifts the robot off the floor`: no elevator.
fn raises(stretch: &Stretch, at: usize) -> bool {
    text_of(stretch, at) == "lifts"
        && matches!(text_of(stretch, at + 1), "the" | "a" | "an" | "his" | "her" | "its" | "it" | "him" | "them" | "up")
        && !at.checked_sub(1).is_some_and(|k| {
            matches!(text_of(stretch, k), "the" | "these" | "those" | "our" | "of" | "both")
                || stretch.words.get(k).is_some_and(|word| word.count().is_some())
        })
}

fn cue(stretch: &mut Stretch, found: &mut Found, taken: &mut [bool]) {
    let temporal = matches!(stretch.joint, Joint::When | Joint::Until | Joint::While);
    let robot = stretch.words.iter().position(|word| word.stem == "robot");
    if temporal && found.gesture.is_some() {
        let first = found.mentions.first().map(|mention| mention.from);
        let hears = stretch.words.iter().any(|word| matches!(word.stem.as_str(), "hear" | "listen"));
        match (robot, first) {
            _ if hears => found.cue = Some((Cue::Says, 0)),
            // `when human 1 gestures WAIT`: somebody else says it.
            (robot, Some(first)) if first < found.gesture_at && robot.is_none_or(|robot| first < robot) => {
                found.cue = Some((Cue::Told, first));
            }
            (Some(robot), first) if robot < found.gesture_at || first.is_none_or(|first| first > robot) => {
                found.cue = Some((Cue::Says, robot));
            }
            (_, _) => {}
        }
        if found.cue.is_some() {
            return;
        }
    }
    if temporal && let Some(at) = message::echoes(stretch) {
        found.cue = Some((Cue::Echo, 0));
        // `has made this gesture` is no deed of its own.
        let makes = |word: &crate::words::Word| matches!(word.stem.as_str(), "make" | "give");
        if let Some(verb) = at.checked_sub(1).filter(|verb| stretch.words.get(*verb).is_some_and(makes)) {
            mark(stretch, verb, verb);
            if let Some(flag) = taken.get_mut(verb) {
                *flag = true;
            }
        }
        return;
    }
    for phrase in &lexicon().cues {
        if !temporal && phrase.means != Cue::Visible {
            continue;
        }
        let free = |i: usize| !taken.get(i).copied().unwrap_or(true);
        let Some(at) = find(&stretch.words, phrase, 0, false, &free) else { continue };
        let first = at.first().copied().unwrap_or(0);
        // `walks up to it to see what it is`
        let why = !temporal
            && phrase.means == Cue::Visible
            && first > 0
            && text_of(stretch, first - 1) == "to"
            && stretch.words.get(first).is_some_and(|word| word.text == "see" || word.text == "look")
            && !first.checked_sub(2).is_some_and(|k| {
                stretch.words.get(k).is_some_and(|word| {
                    matches!(word.stem.as_str(), "surprise" | "startle" | "happen" | "shock" | "amaze")
                })
            });
        if why {
            continue;
        }
        // `I'd like to see it ask them`
        let word = |back: usize| {
            first.checked_sub(back).and_then(|k| stretch.words.get(k)).map_or("", |word| word.text.as_str())
        };
        let wished = word(1) == "to" && matches!(word(2), "like" | "want" | "love" | "need" | "wanted");
        if negated(stretch, first) || wished && !temporal {
            continue;
        }
        for i in &at {
            if let Some(flag) = taken.get_mut(*i) {
                *flag = true;
            }
        }
        mark_each(stretch, &at);
        // `walks to the break room, and when he has reached it`
        let last = at.last().copied().unwrap_or(first);
        let goal = phrase.means == Cue::Near
            && text_of(stretch, last) == "it"
            && stretch.words.get(first).is_some_and(|word| word.stem == "reach")
            && (first == 0 || found.mentions.iter().any(|mention| mention.to < first));
        found.cue = Some((if goal { Cue::Goal } else { phrase.means }, first));
        return;
    }
    // `when there is less than 1.5 m between them`, `with only one meter left`.
    let apart = stretch.joint == Joint::Until && stretch.words.iter().any(|word| word.text == "apart");
    if (stretch.joint == Joint::When || apart) && found.distance_m.is_some() {
        found.cue = Some((Cue::Near, 0));
    }
}

pub(crate) fn text_of(stretch: &Stretch, at: usize) -> &str {
    stretch.words.get(at).map_or("", |word| word.text.as_str())
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
            // `passes the robot`: what somebody passes does nothing in this clause.
            let verb = (0..i).rev().find_map(|k| stretch.words.get(k).filter(|word| !word.label && word.text != "the"));
            let object = verb.is_some_and(|word| {
                matches!(
                    word.stem.as_str(),
                    "pass"
                        | "approach"
                        | "meet"
                        | "encounter"
                        | "face"
                        | "reach"
                        | "past"
                        | "towards"
                        | "toward"
                        | "behind"
                        | "beside"
                )
            });
            if taken.get(i).copied().unwrap_or(false) {
                found.met.push(i);
            } else if before != "of" && before != "by" && !object {
                found.robots.push(i);
            }
            used.push(i);
        }
        let next = stretch.words.get(i + 1).map_or("", |word| word.text.as_str());
        if matches!(word.stem.as_str(), "obey" | "comply" | "oblige") && !negated(stretch, i)
            || word.stem == "do" && matches!(next, "so" | "as") && !negated(stretch, i)
        {
            found.obeys = true;
            used.push(i);
        }
        if matches!(text, "group" | "dyad" | "crowd" | "cluster")
            && matches!(
                before,
                "a" | "the"
                    | "one"
                    | "same"
                    | "small"
                    | "large"
                    | "big"
                    | "loose"
                    | "dense"
                    | "tight"
                    | "single"
                    | "close"
            )
        {
            found.in_group = true;
            used.push(i);
        }
        found.in_group |= text == "together" && i > 0 && !negated(stretch, i);
        if matches!(text, "suddenly" | "together") {
            used.push(i);
        }
        // Who comes out suddenly does not stroll out; who stops suddenly may have strolled.
        if text == "suddenly" && found.deeds.iter().any(|deed| deed.act == Act::ComeOut) {
            found.pace_mps = found.pace_mps.or_else(|| lex.pace.get("sudden").copied());
        }
        let exists = text == "there"
            && stretch
                .words
                .get(i + 1)
                .is_some_and(|next| matches!(next.text.as_str(), "are" | "is" | "will" | "should" | "must"));
        // `exactly three people`, but not `exactly one of them`.
        let exactly = text == "exactly" && stretch.words.get(i + 2).is_none_or(|next| next.text != "of");
        found.declares |= exists || text == "scenario" || exactly;
        // `the lift opens`: of itself, and nobody does it.
        let itself = matches!(word.stem.as_str(), "open" | "close") && matches!(before, "lift" | "elevator" | "doors")
            || text == "open" && matches!(before, "an" | "the" | "its")
            // `gets in when it opens`
            || matches!(word.stem.as_str(), "open" | "close") && before == "it" && next.is_empty();
        // `hands the robot a letter`, `joins the queue`
        let gives = matches!(text, "hands" | "handed" | "joins" | "joined")
            && matches!(next, "the" | "a" | "an" | "it" | "him" | "her" | "over" | "some");
        let taken = takes_along(&stretch.words, i) || gives;
        let door = door_moved(&stretch.words, i).filter(|_| !word.used);
        if let Some(to) = door {
            used.extend(i..=to);
            found.moves_door = Some((i, to));
        }
        // `at any point`
        let point = word.stem == "point" && matches!(before, "any" | "no" | "some" | "this" | "that" | "the" | "which");
        let handles = handles(&stretch.words, i) || mounts(&stretch.words, i);
        if (lex.impossible.contains(&word.stem) || taken) && !word.used && !itself && !point && door.is_none()
            || pours(&stretch.words, i)
            || handles
        {
            found.impossible.push(i);
            // Who sits is at least somewhere: it stands there.
            if matches!(word.stem.as_str(), "sit" | "kneel" | "lie")
                && found.deeds.iter().all(|deed| matches!(deed.act, Act::Ignore | Act::Look | Act::Talk))
            {
                seated.push(Deed { act: Act::Stand, at: i, to: i, negated: false });
            }
        }
    }
    found.deeds.extend(seated);
    mark_each(stretch, &used);
}
