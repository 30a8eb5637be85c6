//! Which kind of edit a clause asks for.

use socrates_model::PlaceClass;

use crate::clause;
use crate::cut::{Joint, Stretch, sentences};
use crate::mention::{Mention, Who, mentions};

/// What an edit wants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// A longer path.
    Longer,
    /// A shorter path.
    Shorter,
    /// The path the other way round.
    Reverse,
    /// A path that does not lead past a place.
    Avoid,
    /// A path from somewhere.
    Start,
    /// A path to somewhere.
    End,
    /// Another place of the meeting.
    Move,
    /// Somebody leaves the scenario.
    Remove,
    /// A desired speed times this.
    Pace(f64),
    /// Nobody gestures.
    NoGestures,
    /// A group is no group any more.
    Ungroup,
    /// Some of those who are there form a group.
    Group,
    /// Two people change places.
    Swap,
    /// A gesture more, or another one instead.
    Gesture,
    /// What the grammar of requests reads: somebody new, what somebody does.
    Story,
}

/// One wish of an edit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wish {
    pub(crate) kind: Kind,
    /// Its clauses, whose words are not read yet.
    pub(crate) clauses: Vec<Stretch>,
    /// Its words.
    pub(crate) quote: String,
    /// Where, if it says.
    pub(crate) place: Option<PlaceClass>,
    /// So many meters, if it says.
    pub(crate) meters: Option<f64>,
    /// Whether it speaks of another place of the same kind.
    pub(crate) other: bool,
    /// Words that may be node ids.
    pub(crate) names: Vec<String>,
}

/// Every wish of the words, in order.
pub(crate) fn wishes(text: &str) -> Vec<Wish> {
    let mut found: Vec<Wish> = Vec::new();
    for sentence in sentences(text) {
        let mut open = false;
        let mut rest = sentence.as_slice();
        while let [stretch, more @ ..] = rest {
            // `make the nurse and the visitor a group`, `swap the nurse and the visitor`
            if let Some((kind, more)) = of_several(rest) {
                let mut next = wish(kind, stretch.clone(), text);
                next.clauses.extend(rest.iter().skip(1).take(more).cloned());
                let to = next.clauses.last().and_then(|last| last.words.last()).map_or(0, |word| word.to);
                let from = stretch.words.first().map_or(0, |word| word.from);
                text.get(from..to).unwrap_or_default().clone_into(&mut next.quote);
                found.push(next);
                rest = rest.get(1 + more..).unwrap_or_default();
                open = true;
                continue;
            }
            rest = more;
            let stretch = stretch.clone();
            let kind = kind(&stretch);
            let goes_on = open && kind == Kind::Story && stretch.joint != Joint::Opens;
            // `human 2: slower` names whom the next clause means.
            let named = found.last().filter(|last| open && kind != Kind::Story && names_only(last)).cloned();
            if let Some(named) = named {
                found.pop();
                let mut next = wish(kind, stretch, text);
                next.quote = format!("{}, {}", named.quote, next.quote);
                next.clauses.splice(0..0, named.clauses);
                found.push(next);
                continue;
            }
            match found.last_mut().filter(|last| goes_on && last.kind == Kind::Story) {
                Some(last) => {
                    let to = stretch.words.last().map_or(0, |word| word.to);
                    let from = last.clauses.first().and_then(|first| first.words.first()).map_or(0, |word| word.from);
                    last.quote = text.get(from..to).unwrap_or_default().to_owned();
                    last.clauses.push(stretch);
                }
                None => found.push(wish(kind, stretch, text)),
            }
            open = true;
        }
    }
    // `slower and longer`: a clause of courtesy alone asks for nothing.
    // `let`, where the cut has put those whom it speaks of into a clause of their own.
    let asks = |wish: &Wish| !matches!(wish.quote.trim().to_lowercase().as_str(), "" | "let");
    found.retain(|wish| asks(wish) && !polite(wish));
    found
}

/// What is asked of people who are listed in clauses of their own, and how many clauses go on the list.
fn of_several(rest: &[Stretch]) -> Option<(Kind, usize)> {
    let (first, others) = rest.split_first()?;
    let lists = |stretch: &&Stretch| {
        let named = mentions(&stretch.words);
        let said = |i: usize| named.iter().any(|mention| (mention.from..=mention.to).contains(&i));
        let fills = |text: &str| {
            matches!(
                text,
                "a" | "an"
                    | "one"
                    | "the"
                    | "group"
                    | "into"
                    | "in"
                    | "to"
                    | "form"
                    | "their"
                    | "places"
                    | "positions"
                    | "paths"
                    | "ways"
                    | "together"
                    | "please"
                    | "single"
            )
        };
        matches!(stretch.joint, Joint::And | Joint::Comma)
            && stretch.words.iter().enumerate().all(|(i, word)| said(i) || fills(&word.text))
    };
    let more = others.iter().take_while(lists).count();
    let words = rest.iter().take(1 + more).flat_map(|stretch| stretch.words.clone()).collect();
    let kind = kind(&Stretch { words, ..first.clone() });
    matches!(kind, Kind::Group | Kind::Swap).then_some((kind, more))
}

fn names_only(wish: &Wish) -> bool {
    wish.kind == Kind::Story
        && wish.clauses.iter().all(|clause| {
            let mentions = mentions(&clause.words);
            (0..clause.words.len()).all(|i| mentions.iter().any(|mention| (mention.from..=mention.to).contains(&i)))
        })
}

fn polite(wish: &Wish) -> bool {
    let words = wish.clauses.iter().flat_map(|clause| &clause.words);
    words.clone().count() > 0
        && words.into_iter().all(|word| {
            matches!(
                word.text.as_str(),
                "please" | "thanks" | "thank" | "you" | "ok" | "okay" | "now" | "also" | "just" | "let"
            )
        })
}

fn wish(kind: Kind, stretch: Stretch, text: &str) -> Wish {
    let quote = stretch.quote(text).to_owned();
    let found = clause::read(&mut stretch.clone());
    let other =
        stretch.words.iter().any(|word| matches!(word.text.as_str(), "other" | "another" | "different" | "elsewhere"));
    let names = stretch.words.iter().map(|word| text.get(word.from..word.to).unwrap_or_default().to_owned()).collect();
    Wish {
        kind,
        quote,
        place: found.places.first().map(|(class, _)| *class),
        meters: found.distance_m,
        other,
        names,
        clauses: vec![stretch],
    }
}

fn kind(stretch: &Stretch) -> Kind {
    let has = |names: &[&str]| {
        stretch.words.iter().any(|word| names.contains(&word.text.as_str()) || names.contains(&word.stem.as_str()))
    };
    let path = has(&["path", "route", "way", "trip", "trajectory", "walk", "drive", "distance"]);
    let no = has(&["no", "without", "drop", "remove", "delete", "not"]);
    if no && has(&["gesture", "gestures", "gesturing", "signal", "signals"]) {
        return Kind::NoGestures;
    }
    if has(&["ungroup", "dissolve"]) || has(&["break", "split", "separate"]) && has(&["group"]) {
        return Kind::Ungroup;
    }
    if has(&["swap", "exchange", "trade"])
        || has(&["switch"]) && has(&["place", "position", "path", "way", "with", "and"])
    {
        return Kind::Swap;
    }
    let makes = &["form", "make", "put", "join", "turn", "merge", "gather", "together", "into", "let"];
    let first = stretch.words.first().is_some_and(|word| word.text == "group");
    if has(&["group"]) && (has(makes) || first) && !has(&["add", "new", "another", "of", "remove", "delete", "drop"]) {
        return Kind::Group;
    }
    let changes = &["add", "change", "replace", "give", "set", "additional", "another", "instead", "turn", "switch"];
    if has(&["gesture", "gestures", "signal", "sign"]) && has(changes) && mentions(&stretch.words).iter().all(known) {
        return Kind::Gesture;
    }
    if has(&["remove", "delete", "drop", "kick", "omit", "erase"])
        || has(&["without"]) && !has(&["gesture"]) && stretch.words.first().is_some_and(|word| word.text == "without")
    {
        return Kind::Remove;
    }
    if has(&["longer", "lengthen", "extend", "farther", "further"]) && (path || has(&["robot", "lengthen", "extend"])) {
        return Kind::Longer;
    }
    if has(&["shorter", "shorten"]) && (path || has(&["robot", "shorten"])) {
        return Kind::Shorter;
    }
    if has(&["reverse", "invert", "flip"]) || path && has(&["opposite"]) && has(&["take", "make", "turn"]) {
        return Kind::Reverse;
    }
    if has(&["slower"]) || has(&["slow"]) && has(&["down"]) {
        return Kind::Pace(0.7);
    }
    if has(&["faster", "quicker"]) || has(&["speed"]) && has(&["up"]) {
        return Kind::Pace(1.35);
    }
    if has(&["avoid", "bypass"])
        && !has(&["avoids"])
        && (path || has(&["robot"]) || places(stretch))
        && !avoids_robot(stretch)
    {
        return Kind::Avoid;
    }
    let somewhere = places(stretch) || has(&["node"]);
    if has(&["move", "relocate", "shift", "put", "place", "meet", "meeting", "encounter", "happen", "set"])
        && (somewhere || has(&["elsewhere"]))
        && !has(&["add"])
        && !says_who_acts(stretch)
    {
        return Kind::Move;
    }
    if has(&["start", "begin"]) && somewhere && !has(&["add"]) {
        return Kind::Start;
    }
    if has(&["end", "finish", "goal", "destination", "arrive"]) && somewhere && !has(&["add"]) {
        return Kind::End;
    }
    Kind::Story
}

/// Whether a mention is of somebody who may be there, and of nobody new.
fn known(mention: &Mention) -> bool {
    !matches!(mention.who, Who::New { article: true, .. } | Who::Further(_) | Who::More(_))
}

/// `move aside at the door` is a deed, no edit of the place.
fn says_who_acts(stretch: &Stretch) -> bool {
    let found = clause::read(&mut stretch.clone());
    let acts = found.deeds.iter().filter(|deed| {
        !matches!(deed.act, crate::lexicon::Act::Walk | crate::lexicon::Act::Pass | crate::lexicon::Act::Stand)
    });
    acts.count() > 0
}

fn avoids_robot(stretch: &Stretch) -> bool {
    let at = stretch.words.iter().position(|word| word.stem == "avoid");
    at.is_some_and(|at| stretch.words.iter().skip(at).take(3).any(|word| word.stem == "robot"))
}

fn places(stretch: &Stretch) -> bool {
    let found = clause::read(&mut stretch.clone());
    !found.places.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_told_apart() {
        for (text, kind) in [
            ("Make the robot's path longer", Kind::Longer),
            ("please shorten the way of the robot", Kind::Shorter),
            ("the second one should be slower", Kind::Pace(0.7)),
            ("move it to the other corridor", Kind::Move),
            ("remove the group", Kind::Remove),
            ("no gestures", Kind::NoGestures),
            ("let her stop 3 m before the robot", Kind::Story),
            ("add a third person who waits at the door", Kind::Story),
            ("reverse the robot's path", Kind::Reverse),
            ("the robot should avoid the doorway", Kind::Avoid),
            ("start the nurse at the door", Kind::Start),
            ("the nurse should move aside", Kind::Story),
            ("swap the nurse and the visitor", Kind::Swap),
            ("make the nurse and the visitor a group", Kind::Group),
            ("break up the group", Kind::Ungroup),
            ("change the nurse's gesture to PROCEED", Kind::Gesture),
            ("the nurse gestures WAIT to the robot", Kind::Story),
        ] {
            assert_eq!(wishes(text)[0].kind, kind, "{text}");
        }
        assert_eq!(wishes("make the robot's path longer and remove the nurse").len(), 2);
        assert!(wishes("please, thanks").is_empty());
    }
}
