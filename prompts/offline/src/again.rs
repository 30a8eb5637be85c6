//! Somebody meets the robot twice: `meets the robot twice`, `meets it again later`, `crosses its path a second time`.

use socrates_model::{FactKind, Fault, FaultCode, HumanId, Location, PlaceClass, Reading, Relation};

use crate::clause::Found;
use crate::cut::Stretch;
use crate::lexicon::{Act, lexicon};
use crate::place;
use crate::story::{Story, Subject, Thread};
use crate::words::{Piece, Word};

/// What was said of meeting the robot more than once.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Again {
    /// The words.
    pub(crate) quote: String,
    /// Class of the place of the second meeting, if said.
    pub(crate) place: Option<PlaceClass>,
    /// More than two meetings are wanted.
    pub(crate) oftener: bool,
}

const TWICE: &str = "twice";
const OFTENER: &str = "thrice";
const AGAIN: &str = "again";

/// Phrases that are read as one word.
const PHRASES: &[(&[&str], &str)] = &[
    (&["two", "times"], TWICE),
    (&["2", "times"], TWICE),
    (&["two", "separate", "times"], TWICE),
    (&["three", "times"], OFTENER),
    (&["3", "times"], OFTENER),
    (&["four", "times"], OFTENER),
    (&["4", "times"], OFTENER),
    (&["five", "times"], OFTENER),
    (&["a", "third", "time"], OFTENER),
    (&["for", "the", "third", "time"], OFTENER),
    (&["for", "a", "second", "time"], AGAIN),
    (&["for", "the", "second", "time"], AGAIN),
    (&["a", "second", "time"], AGAIN),
    (&["the", "second", "time"], AGAIN),
    (&["once", "more"], AGAIN),
    (&["once", "again"], AGAIN),
    (&["one", "more", "time"], AGAIN),
];

/// Phrases of more words become one word with their place in the text.
pub(crate) fn joined(pieces: Vec<Piece>) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        out.push(piece);
        for (words, one) in PHRASES {
            let Some(from) = out.len().checked_sub(words.len()) else { continue };
            let tail = out.get(from..).unwrap_or_default();
            let is = |(piece, word): (&Piece, &&str)| matches!(piece, Piece::Word(found) if found.text == **word);
            if !tail.iter().zip(words.iter()).all(is) {
                continue;
            }
            let to = if let Some(Piece::Word(last)) = out.last() { last.to } else { continue };
            out.truncate(from + 1);
            if let Some(Piece::Word(word)) = out.last_mut() {
                word.to = to;
                (*one).clone_into(&mut word.text);
                (*one).clone_into(&mut word.stem);
            }
            break;
        }
    }
    out
}

/// The words of the text that say how often, where nothing was made of them: `three times`, `a second time`.
pub(crate) fn how_often<'a>(word: &Word, text: &'a str) -> Option<&'a str> {
    let said = text.get(word.from..word.to)?;
    let joined = matches!(word.text.as_str(), TWICE | OFTENER | AGAIN) && said.contains(char::is_whitespace);
    (joined && !word.used).then_some(said)
}

/// Notes who is to meet the robot twice. True where the clause tells of nothing but the second meeting, so that no more is
/// read from it.
pub(crate) fn note(
    story: &mut Story,
    thread: &mut Thread,
    stretch: &mut Stretch,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    quote: &str,
) -> bool {
    let often = |word: &str| matches!(word, TWICE | OFTENER | AGAIN);
    // `two times as fast` tells of a pace.
    let counts =
        |at: &usize| stretch.words.get(at + 1).is_none_or(|next| !matches!(next.text.as_str(), "as" | "faster"));
    let Some(at) = stretch.words.iter().position(|word| often(&word.text)).filter(counts) else { return false };
    let said = stretch.words.get(at).map_or_else(String::new, |word| word.text.clone());
    let meets = |act: Act| matches!(act, Act::Toward | Act::Pass | Act::Cross);
    if !found.deeds.iter().any(|deed| meets(deed.act) && !deed.negated) {
        return false;
    }
    let mut who: Vec<usize> = meant.iter().flat_map(|(_, _, some)| some).copied().collect();
    who.sort_unstable();
    who.dedup();
    if who.is_empty() {
        who = if let Subject::People(people) = &thread.subject { people.clone() } else { story.cast.last.clone() };
    }
    if who.is_empty() && story.cast.people.len() == 1 {
        who = vec![0];
    }
    let known = who.iter().all(|i| story.cast.people.get(*i).is_some_and(|person| !person.doings.is_empty()));
    if who.is_empty() {
        return false;
    }
    if let Some(word) = stretch.words.get_mut(at) {
        word.used = true;
    }
    let only = said == AGAIN
        && known
        && found.gesture.is_none()
        && found.deeds.iter().all(|deed| meets(deed.act) || matches!(deed.act, Act::Walk | Act::GoOn));
    // The place of a clause of its own is that of the second meeting.
    let place = found.places.first().map(|(class, _)| *class).filter(|_| only);
    if only {
        let here = |slot: &Option<(PlaceClass, String)>| slot.as_ref().is_some_and(|(_, words)| words == quote);
        for slot in [&mut story.place, &mut story.robot_enters, &mut story.robot_leaves, &mut story.headed] {
            if here(slot) {
                *slot = None;
            }
        }
        for word in stretch.words.iter_mut().filter(|word| word.text == "later" || word.text == "same") {
            word.used = true;
        }
    }
    for i in &who {
        if let Some(person) = story.cast.people.get_mut(*i) {
            let before = person.again.take().unwrap_or_default();
            person.again = Some(Again {
                quote: quote.to_owned(),
                place: place.or(before.place),
                oftener: before.oftener || said == OFTENER || !before.quote.is_empty() && said == AGAIN,
            });
        }
    }
    if only {
        thread.subject = Subject::People(who);
    }
    only
}

/// The fact of somebody who is to meet the robot twice, where that can be played.
pub(crate) fn fact(
    human: HumanId,
    relation: Option<Relation>,
    again: &Again,
    location: &Location,
    reading: &mut Reading,
) -> Option<(String, FactKind)> {
    let quote = &again.quote;
    let mut problem = |code: FaultCode, message: String| {
        let fault = Fault::new(code, human, message).about([quote.as_str()]);
        if !reading.problems.contains(&fault) {
            reading.problems.push(fault);
        }
    };
    let walks = relation.is_none_or(|relation| {
        matches!(
            relation,
            Relation::Frontal | Relation::Crossing | Relation::Leaving | Relation::Ahead | Relation::Abreast
        )
    });
    if !walks {
        problem(
            FaultCode::PRead,
            format!(
                "`{quote}`: who stands or goes behind the robot meets it once; ask for somebody who comes towards it or crosses its way"
            ),
        );
        return None;
    }
    if again.oftener {
        problem(
            FaultCode::PRead,
            format!("`{quote}`: somebody meets the robot twice at most; the meetings after the second are not played"),
        );
    }
    let graph = &location.graph;
    let through = |class: PlaceClass| {
        graph.nodes().iter().any(|node| graph.node_is(&node.id, class) && graph.neighbors(&node.id).len() > 1)
    };
    if let Some(class) = again.place.filter(|class| !through(*class)) {
        problem(
            FaultCode::PPlace,
            format!(
                "`{quote}` asks for a second meeting at {}, where on this map no way leads on; it is elsewhere on the robot's way",
                place::an(class)
            ),
        );
    }
    let place = again.place.filter(|class| through(*class));
    Some((quote.clone(), FactKind::MeetsTimes { human, times: 2, place }))
}

/// Notes of a sentence which words some rule read, and which content words none did.
pub(crate) fn leftover(story: &mut Story, sentence: &[Stretch], text: &str) {
    for word in sentence.iter().flat_map(|stretch| stretch.words.iter().chain(&stretch.also)) {
        if !word.unread() && word.to > word.from {
            story.used.push(word.from..word.to);
        }
        let often = how_often(word, text);
        let known = often.is_none()
            && (lexicon().stop.contains(&word.text) || lexicon().stop.contains(&word.stem) || word.stem == "robot");
        let said = often.unwrap_or(&word.text);
        if word.unread() && !known && !story.ignored.iter().any(|word| word == said) {
            story.ignored.push(said.to_owned());
        }
    }
}
