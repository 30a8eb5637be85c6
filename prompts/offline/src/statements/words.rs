//! What kind of word it is: whether it says something, and whether it can be background.

use std::ops::Range;

use socrates_model::Location;
use socrates_model::statement::TextKey;
use socrates_reader::Reader;

use super::background::STUDIES;
use super::text::Token;
use crate::lexicon::lexicon;

/// Kinds of words, as far as the account needs them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Joins others, or stands for them: says nothing of its own.
    Connective,
    /// Somebody does something.
    Act,
    /// How somebody does it.
    Manner,
    /// A place, or something at which somebody is.
    Place,
    /// On which side: counts only where the reading would be another one on the other side.
    Side,
    /// In which direction, how near.
    Direction,
    /// How many, how far, how long.
    Number,
    /// Which comes first.
    Order,
    /// When, how often.
    Time,
    /// That something is not so.
    Denial,
    /// Anything else: what somebody is, wears, has with them.
    Other,
}

impl Kind {
    /// Whether such a word of a rough scenario asks for something that could be seen, so that it is no background.
    pub(super) const fn asks(self) -> bool {
        !matches!(self, Self::Connective | Self::Other)
    }

    /// Whether such a word may be read as a part of a phrase without changing anything itself: `comes` of `comes towards the robot`.
    pub(super) const fn joins_phrases(self) -> bool {
        match self {
            Self::Act | Self::Manner | Self::Place | Self::Direction | Self::Time | Self::Other => true,
            Self::Connective | Self::Side | Self::Number | Self::Order | Self::Denial => false,
        }
    }
}

/// Articles, pronouns, auxiliaries, conjunctions, and prepositions that only join.
const CONNECTIVES: &str = "a an the this that these those there here it its itself he him his himself she her hers herself they them \
    their theirs themselves we us our you your i me my one's who whom whose which what is are was were be been being am do does did \
    has have had having will would shall should must may might can could let lets to of in on at into onto from for with by as off out \
    up down along through via about over and but or nor so then than also too very just only if while when whenever where because \
    since though although however therefore how why whether both each every any some such same other others own else even still yet \
    way ways path paths direction directions inside finally afterwards afterward meanwhile all already more most less rather quite \
    please towards toward around within under during there's that's it's he's she's they're \
    i'd i'm we'd etc e.g i.e ok okay s ve ll d re m";

const SIDES: &str = "left right side sides lefthand righthand left-hand right-hand leftmost rightmost middle center centre edge wall \
    opposite sideways back outside north south east west facing";
const DIRECTIONS: &str = "behind ahead front backwards backward forward forwards beside near nearby next close closer away across past \
    between apart abreast diagonally straight perpendicular parallel together";
const ORDERS: &str = "first second third last before after previously simultaneously again twice thrice repeatedly until till former \
    latter";
const TIMES: &str = "seconds sec secs minute minutes moment moments time times immediately instantly briefly suddenly soon always \
    constantly long short shortly eventually sometimes often later once";
const DENIALS: &str = "not no never without nobody none neither nothing don't doesn't didn't won't can't cannot isn't aren't wouldn't \
    unless except instead hardly";
const ROBOT: &str = "robot robots robot's bot amr agv";

/// Nouns that end like a verb.
const NOUNS: &str = "meeting building evening morning ceiling landing crossing parking loading packing waiting opening turning \
    something anything nothing everything clothing during king thing things bus gas class glass boss";
/// Words before the name of where something is.
const AT: &[&str] = &[
    "in", "at", "on", "into", "onto", "near", "by", "along", "through", "behind", "beside", "between", "outside",
    "inside", "from", "to", "towards", "toward", "past", "around", "opposite", "against", "under", "over", "across",
    "down", "up", "via", "off",
];
/// Words that stand between such a word and the name.
const FILL: &[&str] =
    &["the", "a", "an", "its", "his", "her", "their", "our", "my", "one", "of", "this", "that", "same", "other"];
/// Words after which a verb in its base form stands.
const BEFORE_VERB: &[&str] = &[
    "to", "will", "would", "can", "could", "must", "should", "may", "might", "not", "don't", "doesn't", "didn't",
    "won't", "they", "and",
];
/// Words after which somebody does something.
const SUBJECTS: &[&str] = &[
    "he",
    "she",
    "they",
    "it",
    "who",
    "that",
    "which",
    "and",
    "then",
    "both",
    "all",
    "each",
    "everybody",
    "everyone",
    "somebody",
    "someone",
    "but",
];

fn among(table: &str, word: &str) -> bool {
    table.split_whitespace().any(|known| known == word)
}

/// The kind of each word.
pub(super) fn kinds(tokens: &[Token], location: &Location) -> Vec<Kind> {
    (0..tokens.len()).map(|place| kind(tokens, place, location)).collect()
}

/// The kinds of the words of a text that tells of nobody's deeds: a task, of which some words may deny something, or a context.
pub(super) fn plain(tokens: &[Token], denied: &[Range<usize>], key: TextKey) -> Vec<Kind> {
    let denies = |token: &Token| {
        key == TextKey::Task && denied.iter().any(|at| at.start < token.at.end && token.at.start < at.end)
    };
    let kind = |token: &Token| match Reader::shipped().says_nothing(&token.lower) {
        _ if denies(token) => Kind::Denial,
        true => Kind::Connective,
        false => Kind::Other,
    };
    tokens.iter().map(kind).collect()
}

fn kind(tokens: &[Token], place: usize, location: &Location) -> Kind {
    let Some(word) = tokens.get(place).map(|token| token.lower.as_str()) else { return Kind::Connective };
    let lex = lexicon();
    let stem = lex.stem(word);
    if among(CONNECTIVES, word) || among(ROBOT, word) || stem == "robot" {
        return Kind::Connective;
    }
    // `the moment it stops`, `as soon as`, `at any time`
    let before = place.checked_sub(1).and_then(|k| tokens.get(k)).map_or("", |token| token.lower.as_str());
    if word == "moment" && matches!(before, "the" | "this" | "that") || word == "soon" && before == "as" {
        return Kind::Connective;
    }
    let next = place.checked_add(1).and_then(|k| tokens.get(k)).map_or("", |token| token.lower.as_str());
    if word == "front" && before == "in" && next == "of" {
        return Kind::Connective;
    }
    // Doors open by themselves for whoever comes near.
    let door = |word: &str| matches!(word, "door" | "doors" | "elevator" | "lift");
    let opens = |word: &str| matches!(word, "open" | "opens" | "opened" | "opening");
    if opens(word) && door(before) || matches!(word, "door" | "doors") && opens(next) {
        return Kind::Connective;
    }
    // `the other one`, `the two`: those of whom was spoken.
    let definite = matches!(before, "the" | "these" | "those" | "all" | "both");
    let named = matches!(before, "other" | "this" | "that" | "each" | "every" | "which" | "same")
        || lex.ordinals.contains_key(before);
    if lex.numbers.contains_key(word) && (definite || word == "one" && named) {
        return Kind::Connective;
    }
    for (table, kind) in [
        (DENIALS, Kind::Denial),
        (SIDES, Kind::Side),
        (DIRECTIONS, Kind::Direction),
        (ORDERS, Kind::Order),
        (TIMES, Kind::Time),
    ] {
        if among(table, word) {
            return kind;
        }
    }
    if word.starts_with(|c: char| c.is_ascii_digit()) || lex.numbers.contains_key(word) {
        return Kind::Number;
    }
    if lex.roles.contains_key(&stem) {
        return Kind::Other;
    }
    if is_place(tokens, place, location) {
        return Kind::Place;
    }
    if is_act(tokens, place, &stem) {
        return Kind::Act;
    }
    if word.len() > 4 && word.ends_with("ly") || lex.pace.contains_key(word) { Kind::Manner } else { Kind::Other }
}

/// A word for a place, of the map or of any; or the name of something at which somebody is.
fn is_place(tokens: &[Token], place: usize, location: &Location) -> bool {
    let word = tokens.get(place).map_or("", |token| token.lower.as_str());
    let lex = lexicon();
    let known = |name: &str| lex.places.iter().any(|phrase| phrase.items.iter().any(|item| item.takes(name)));
    if known(word) || lex.nowhere.contains(word) || lex.nowhere.contains(&lex.stem(word)) {
        return true;
    }
    if on_map(word, location) {
        return true;
    }
    let clause = tokens.get(place).map_or(0, |token| token.clause);
    let before = (0..place).rev().filter_map(|k| tokens.get(k)).take_while(|token| token.clause == clause);
    let first =
        before.map(|token| token.lower.as_str()).find(|word| !FILL.contains(word) && !lex.adjectives.contains(*word));
    let sort = |word: &str| lex.verbs.contains(&lex.stem(word)) || word.ends_with("ing") && !among(NOUNS, word);
    // `in the scenario`
    let said = sort(word) || lex.goods.contains(word) || STUDIES.contains(&word);
    first.is_some_and(|word| AT.contains(&word)) && !said
}

/// Whether a word tells which place of this map is meant.
pub(super) fn tells_place(word: &str, location: &Location) -> bool {
    // `the office`, in an office
    on_map(word, location) && !crate::named::telling(word).is_empty() && !location.name.contains(word)
}

/// Whether a word stands in the name of a place of this map.
pub(super) fn on_map(word: &str, location: &Location) -> bool {
    let named = |node: &socrates_model::GraphNode| {
        node.kind.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|part| part.len() > 2 && part == word)
    };
    location.graph.nodes().iter().any(named)
}

fn is_act(tokens: &[Token], place: usize, stem: &str) -> bool {
    let word = tokens.get(place).map_or("", |token| token.lower.as_str());
    let before = place.checked_sub(1).and_then(|k| tokens.get(k)).map_or("", |token| token.lower.as_str());
    let lex = lexicon();
    // `a walk`, `the push`
    let noun = FILL.contains(&before) && !word.ends_with("ing");
    if among(NOUNS, word) || noun {
        return false;
    }
    let role = lex.roles.contains_key(&lex.stem(before));
    lex.impossible.contains(stem) && !lex.things.contains(word)
        || lex.verbs.contains(stem) && !lex.things.contains(word)
        || word.len() > 4 && word.ends_with("ing")
        || word.len() > 3
            && (word.ends_with('s') && !word.ends_with("ss") || word.ends_with("ed"))
            && (role || SUBJECTS.contains(&before) || before.ends_with("ly"))
        || BEFORE_VERB.contains(&before) && !matches!(before, "and" | "to") && !lex.adjectives.contains(word)
}

/// Words that say the opposite of each other, or at least something else: where one in place of the other changes nothing, neither
/// is read.
const OPPOSITES: &[(&str, &str)] = &[
    ("left", "right"),
    ("behind", "beside"),
    ("ahead", "behind"),
    ("front", "back"),
    ("first", "last"),
    ("second", "first"),
    ("third", "first"),
    ("before", "after"),
    ("until", "when"),
    ("past", "towards"),
    ("across", "along"),
    ("away", "closer"),
    ("next", "behind"),
    ("beside", "behind"),
    ("together", "apart"),
    ("again", "once"),
    ("twice", "once"),
    ("not", "also"),
    ("never", "always"),
    ("without", "with"),
    ("slowly", "quickly"),
    ("slow", "fast"),
    ("minutes", "seconds"),
    ("minute", "second"),
];

/// Words of the same kind that say something else, where there are any.
pub(super) fn others(word: &str) -> Vec<String> {
    let pair = OPPOSITES.iter().find_map(|(a, b)| if *a == word { Some(*b) } else { (*b == word).then_some(*a) });
    if let Some(other) = pair {
        return vec![other.to_owned()];
    }
    // `one` can be somebody: other numbers are larger.
    if let Some(count) = lexicon().numbers.get(word) {
        let named = |wanted: u32| {
            NAMED.iter().find(|(_, n)| *n == wanted).map_or_else(|| wanted.to_string(), |(name, _)| (*name).to_owned())
        };
        return [count + 1, count + 4].into_iter().map(named).collect();
    }
    let number: Option<f64> = word.parse().ok();
    number.map_or_else(Vec::new, |number| vec![(number + 1.0).to_string(), (number + 4.0).to_string()])
}

/// Names of small numbers.
const NAMED: &[(&str, u32)] = &[
    ("two", 2),
    ("three", 3),
    ("four", 4),
    ("five", 5),
    ("six", 6),
    ("seven", 7),
    ("eight", 8),
    ("nine", 9),
    ("ten", 10),
];

/// Whether a word names people.
pub(super) fn is_person(token: &Token) -> bool {
    lexicon().roles.contains_key(&lexicon().stem(&token.lower))
        || matches!(
            token.lower.as_str(),
            "he" | "she" | "they" | "him" | "her" | "them" | "everybody" | "everyone" | "somebody" | "someone"
        )
}
