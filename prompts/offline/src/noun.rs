//! Nouns for people: those of the tables, and words that do what only people do.

use crate::lexicon::{Item, Lexicon, lexicon};
use crate::words::Word;

/// Nouns of `the other end` and `one side` that are no people.
const THINGS: &[&str] = &[
    "side",
    "end",
    "direction",
    "way",
    "hand",
    "part",
    "corner",
    "door",
    "floor",
    "wall",
    "room",
    "time",
    "moment",
    "place",
    "thing",
    "leg",
    "spot",
    "stage",
    "trip",
    "lap",
    "minute",
    "seconds",
    "minutes",
];

/// Whether a number or `other` before this word counts things.
pub(crate) fn thing(words: &[Word], at: usize) -> bool {
    words.get(at).is_some_and(|word| {
        THINGS.contains(&word.text.as_str())
            || lexicon().places.iter().any(|place| place.items == [Item::Word(word.stem.clone())])
            || lexicon().labels.contains(&word.text) && !lexicon().verbs.contains(&word.stem)
            || lexicon().things.contains(&word.stem) && !lexicon().verbs.contains(&word.stem)
    })
}

/// Nouns for several people at once, with how many where the word says it.
pub(crate) const BANDS: &[(&str, Option<u32>)] = &[
    ("group", None),
    ("circle", None),
    ("cluster", None),
    ("bunch", None),
    ("team", None),
    ("pair", Some(2)),
    ("couple", Some(2)),
    ("duo", Some(2)),
    ("dyad", Some(2)),
    ("triad", Some(3)),
    ("trio", Some(3)),
    ("quartet", Some(4)),
    ("foursome", Some(4)),
    ("threesome", Some(3)),
    ("family", None),
    ("crew", None),
    ("gang", None),
    ("party", None),
    ("squad", None),
    ("class", None),
    ("crowd", Some(6)),
    ("band", None),
    ("queue", None),
    ("line", None),
    ("row", None),
    ("knot", None),
    ("huddle", None),
];

/// Whether the word is a noun for several people.
pub(crate) fn band(words: &[Word], at: usize) -> Option<&'static (&'static str, Option<u32>)> {
    words
        .get(at)
        .filter(|word| !word.label && !word.text.ends_with("ing"))
        .and_then(|word| BANDS.iter().find(|(name, _)| *name == word.stem))
}

/// The noun for people that ends a noun phrase from `at` on, with at most three describing words before it.
pub(crate) fn noun(words: &[Word], at: usize, lex: &Lexicon) -> Option<usize> {
    let mut end = None;
    // `in the corridor visitors stand`: behind a preposition, places and things describe nobody.
    let placed = at >= 2 && words.get(at - 2).is_some_and(|word| PREPOSITIONS.contains(&word.text.as_str()));
    for (i, word) in words.iter().enumerate().skip(at).take(4) {
        if word.label {
            break;
        }
        // `how patient it is`
        let quality = word.text == "patient"
            && i.checked_sub(1).and_then(|k| words.get(k)).is_some_and(|word| {
                matches!(
                    word.text.as_str(),
                    "how" | "very" | "too" | "so" | "more" | "be" | "stays" | "remains" | "quite"
                )
            });
        if lex.roles.contains_key(&word.stem) && !quality {
            end = Some(i);
            break;
        }
        let of_things = !placed
            && (lex.things.contains(&word.stem)
                || lex.labels.contains(&word.text)
                || lex.places.iter().any(|place| place.items == [Item::Word(word.text.clone())]))
            && words.get(i + 1).is_some_and(|next| lex.roles.contains_key(&next.stem));
        let describes = lex.adjectives.contains(&word.text)
            || of_things
            || !lex.known.contains(&word.stem)
                && !lex.stop.contains(&word.text)
                && word.number().is_none()
                && word.stem != "robot";
        if !describes {
            break;
        }
    }
    // `the nurse station`, `a staff room` are places, `a visitor badge` is a thing.
    let names_thing = end.is_some_and(|end| {
        let generic = words.get(end).and_then(|word| lex.roles.get(&word.stem)).is_none_or(|role| role.generic);
        words.get(end + 1).is_some_and(|next| {
            let place = |place: &crate::lexicon::Phrase<socrates_model::PlaceClass>| {
                place.items == [Item::Word(next.text.clone())]
            };
            matches!(
                next.text.as_str(),
                "station"
                    | "badge"
                    | "desk"
                    | "bed"
                    | "uniform"
                    | "trolley"
                    | "cart"
                    | "area"
                    | "office"
                    | "lounge"
                    | "effect"
                    | "behaviour"
                    | "behavior"
                    | "traffic"
                    | "transport"
                    | "flow"
                    | "safety"
                    | "experience"
                    | "entrance"
                    | "council"
                    | "canteen"
                    | "clinic"
                    | "university"
                    | "company"
                    | "site"
                    | "agency"
                    | "tour"
                    | "survey"
                    | "satisfaction"
            ) || !generic && lex.places.iter().any(place)
        })
    });
    if names_thing {
        return None;
    }
    // `warehouse employee` and `hospital staff member` end at the last noun.
    let mut end = end?;
    while words.get(end + 1).is_some_and(|word| lex.roles.contains_key(&word.stem) && !word.label) {
        end += 1;
    }
    if words.get(end + 1).is_some_and(|word| word.stem == "member") {
        end += 1;
    }
    // `doctor Miller`
    let name = |word: &Word| {
        word.capital && word.text.len() > 2 && !lex.known.contains(&word.stem) && !lex.stop.contains(&word.text)
    };
    if words.get(end + 1).is_some_and(name) {
        end += 1;
    }
    Some(end)
}

/// Words before a noun that tell where something is.
const PREPOSITIONS: &[&str] = &[
    "in", "at", "near", "by", "on", "along", "down", "through", "beside", "behind", "from", "into", "outside",
    "inside", "under", "across",
];

/// A word that no table has and that does what only people do: `two assistants come out`, `a florist who …`.
pub(crate) fn stranger(words: &[Word], at: usize, introduced: bool, lex: &Lexicon) -> Option<usize> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    // `the guide` is who guides.
    let leads = |k: usize| {
        words.get(k).is_some_and(|word| matches!(word.text.as_str(), "guide" | "escort"))
            && words
                .get(k + 1)
                .is_none_or(|next| lex.verbs.contains(&next.stem) || matches!(next.text.as_str(), "and" | "who" | "of"))
    };
    // `a tour guide`
    if let Some(at) = [at, at + 1].into_iter().find(|k| leads(*k) && (*k == at || text(at) == "tour")) {
        return Some(at);
    }
    // `a patient with a walking frame` has a thing with him.
    let back = |k: usize| at.checked_sub(k).and_then(|k| words.get(k));
    let has = back(1).is_some_and(|word| matches!(word.text.as_str(), "a" | "an" | "his" | "her"))
        && back(2).is_some_and(|word| word.text == "with")
        && back(3).is_some_and(|word| lex.roles.contains_key(&word.stem));
    // `repeated with a different planner`
    let variant = text(at) == "different"
        && back(1).is_some_and(|word| word.text == "a")
        && back(2).is_some_and(|word| word.text == "with");
    // `two people with two temperaments`
    // `draws a face on it with a marker`
    let tool = back(1).is_some_and(|word| matches!(word.text.as_str(), "a" | "an"))
        && back(2).is_some_and(|word| word.text == "with")
        && words.get(at + 1).is_none();
    let had =
        tool || back(1).is_some_and(|word| word.count().is_some()) && back(2).is_some_and(|word| word.text == "with");
    if !introduced || has || variant || had {
        return None;
    }
    let unknown = |k: usize| {
        words.get(k).is_some_and(|word| {
            !word.label
                && word.text.len() >= if word.capital { 2 } else { 4 }
                && word.text.chars().all(char::is_alphabetic)
                && !lex.has(word)
                && !thing(words, k)
                && !lex.places.iter().any(|place| place.items.contains(&Item::Word(word.text.clone())))
        })
    };
    // `an explicit gesture resolves it` is nobody who gestures.
    let one = back(1).is_some_and(|word| matches!(word.text.as_str(), "a" | "an"));
    let does = |k: usize| {
        words.get(k).is_some_and(|word| {
            lex.verbs.contains(&word.stem)
                && !lex.things.contains(&word.text)
                && !(one
                    && word.text == word.stem
                    && matches!(word.text.as_str(), "gesture" | "signal" | "wave" | "stop" | "start"))
                || matches!(word.text.as_str(), "who" | "whose")
        })
    };
    let between = |k: usize| {
        words.get(k).is_some_and(|word| {
            word.text.ends_with("ly")
                || matches!(
                    word.text.as_str(),
                    "just" | "then" | "also" | "now" | "both" | "never" | "not" | "always" | "soon"
                )
        })
    };
    // The last of at most three words, so that `a sales assistant waits` is an assistant.
    let describes = |k: usize| unknown(k) || words.get(k).is_some_and(|word| lex.adjectives.contains(&word.text));
    for end in at..at + 3 {
        if !describes(end) {
            break;
        }
        if !unknown(end) {
            continue;
        }
        let acts = does(end + 1) || between(end + 1) && does(end + 2);
        // Whoever is led, followed or accompanied is somebody too.
        let taken_along = (1..=3).filter_map(|back| at.checked_sub(back)).any(|k| {
            matches!(
                words.get(k).map_or("", |word| word.stem.as_str()),
                "lead" | "guide" | "escort" | "accompany" | "help"
            )
        });
        // At the head of the clause, with a verb after where it is: `the tester behind him stands`.
        let heads = at <= 1
            && (end + 2..end + 6).any(does)
            && words.get(end + 1).is_some_and(|word| PREPOSITIONS.contains(&word.text.as_str()));
        let modifies = words.get(end + 1).is_some_and(|word| {
            word.text == "one" || lex.things.contains(&word.stem) || lex.labels.contains(&word.text)
        });
        let named = words.get(end).is_some_and(agentive) && !unknown(end + 1) && !modifies;
        if acts || taken_along || heads || named {
            return Some(end);
        }
    }
    None
}

/// Whether a word has the ending of those who do something: `physiotherapist`, `accountant`, `welder`.
pub(crate) fn agentive(word: &Word) -> bool {
    const ENDS: &[&str] = &["er", "or", "ist", "ian", "ant", "eer", "ee", "man", "woman", "person", "ess"];
    word.stem.len() >= 5 && ENDS.iter().any(|end| word.stem.ends_with(end))
}

/// Whether a noun is in the plural.
pub(crate) fn plural(word: &Word) -> bool {
    matches!(word.text.as_str(), "people" | "men" | "women" | "children" | "staff")
        || word.text != word.stem && word.text.ends_with('s')
}
