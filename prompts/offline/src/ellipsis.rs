//! Clauses that leave their verb out: `the other does not`, `and the nurse does as well`.

use socrates_model::{Gesture, Trigger};

use crate::clause::Found;
use crate::cut::Stretch;
use crate::deed::{self, Around};
use crate::lexicon::Act;
use crate::story::{Story, Subject, Thread};

/// Words that such a clause is made of, beside those whom it speaks of.
const LEFT: &[&str] = &[
    "do",
    "be",
    "will",
    "would",
    "can",
    "could",
    "have",
    "should",
    "not",
    "never",
    "too",
    "so",
    "as",
    "well",
    "either",
    "also",
    "likewise",
    "same",
    "the",
    "neither",
    "nor",
    "just",
    "however",
    "though",
    "equally",
    "similarly",
    "and",
    "both",
    "all",
    "must",
    "thing",
    "only",
    "that",
    "what",
    "exactly",
];

/// Whether the clause leaves its verb out, and whether its people do what was said before.
pub(crate) fn elided(stretch: &Stretch, found: &Found) -> Option<bool> {
    let same =
        stretch.words.iter().any(|word| word.text == "same") && stretch.words.iter().any(|word| word.stem == "do");
    if found.mentions.is_empty() && !same || found.acts() || found.cue.is_some() {
        return None;
    }
    let outside = stretch.words.iter().enumerate();
    let left: Vec<&str> = outside
        .filter(|(at, _)| !found.mentions.iter().any(|mention| (mention.from..=mention.to).contains(at)))
        .map(|(_, word)| word.stem.as_str())
        .collect();
    if left.is_empty() || !left.iter().all(|word| LEFT.contains(word)) {
        return None;
    }
    let has = |words: &[&str]| left.iter().any(|word| words.contains(word));
    let verb = has(&["do", "be", "will", "would", "can", "could", "have", "should", "must"]);
    if verb && has(&["not", "never", "neither", "nor"]) {
        Some(false)
    } else if has(&["too", "likewise", "same", "well", "also", "similarly", "equally"])
        || verb && has(&["so", "only"])
        || has(&["do"])
            && left.iter().all(|word| {
                matches!(*word, "do" | "only" | "just" | "all" | "both" | "that" | "what" | "be" | "exactly")
            })
    {
        Some(true)
    } else {
        None
    }
}

/// `The one who stays`: whoever was said to do so before, if that is somebody else than was guessed.
pub(crate) fn told_before(story: &mut Story, found: &Found, guessed: usize) -> Option<usize> {
    let [only] = found.deeds.as_slice() else { return None };
    if !found.mentions.is_empty() || only.negated {
        return None;
    }
    let relation = crate::relation::relation(only.act)?;
    let is = |i: &usize| {
        story
            .cast
            .people
            .get(*i)
            .is_some_and(|person| person.relation.as_ref().is_some_and(|(own, _)| *own == relation))
    };
    let set = story.cast.latest();
    let mut fitting = set.iter().copied().filter(is);
    let who = fitting.next().filter(|_| fitting.next().is_none())?;
    if who != guessed
        && let Some(person) = story.cast.people.get_mut(guessed)
    {
        person.bound = person.relation.is_some() || !person.rules.is_empty();
    }
    Some(who)
}

/// `his colleague stops for 6 s because of it`: because of what was said.
pub(crate) fn because_of_it(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch) -> bool {
    let of_it = matches!(stretch.words.as_slice(), [of, it] if of.text == "of" && matches!(it.text.as_str(), "it" | "that" | "this"));
    let Some(said) = thread.said.clone().filter(|_| of_it) else { return false };
    for (who, rule) in &thread.made {
        let read = story.cast.people.get_mut(*who).and_then(|person| person.rules.get_mut(*rule));
        if let Some(read) = read.filter(|read| !read.stated) {
            (read.rule.when, read.stated) = (vec![said.clone()], true);
        }
    }
    for word in &mut stretch.words {
        word.used = true;
    }
    true
}

/// `The robot, which must not crowd him, asks …`, `The robot is to fetch a client, say "follow me" and bring her …`: what comes then is
/// the robot's.
pub(crate) fn of_robot(thread: &mut Thread, stretch: &Stretch) -> bool {
    use crate::cut::Joint;
    use crate::lexicon::lexicon;
    let first = stretch.words.first();
    let base = first.is_some_and(|word| word.text == word.stem && lexicon().verbs.contains(&word.stem));
    if thread.robot_to && base && matches!(stretch.joint, Joint::Comma | Joint::And) {
        thread.subject = Subject::Robot;
    }
    if matches!(stretch.joint, Joint::Opens) {
        let robot = stretch.words.iter().take(3).any(|word| word.stem == "robot");
        let to = stretch.words.windows(2).any(|two| {
            matches!(two, [to, verb] if to.text == "to" && verb.text == verb.stem && lexicon().verbs.contains(&verb.stem))
        });
        thread.robot_to = robot && to;
    }
    let relative = stretch.joint == Joint::Who || first.is_some_and(|word| word.text == "whose");
    relative && thread.subject == Subject::Robot
}

/// `He says wait, so both packers stop`: because of what was said just before.
pub(crate) fn consequence(thread: &Thread, text: &str, stretch: &Stretch, found: &Found) -> bool {
    let before = stretch.words.first().and_then(|first| text.get(..first.from)).unwrap_or_default();
    let word = before.trim_end().rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
    let spoken = thread.acts.last().is_some_and(|(act, _)| *act == Act::Gesture)
        && matches!(thread.said, Some(Trigger::HumanSays(..)));
    // `The mother says wait, and then the child stops`: somebody else does what was asked for.
    let asked = match thread.said {
        Some(Trigger::HumanSays(_, gesture)) => asked_for(gesture),
        _ => None,
    };
    let answers = matches!(word, "then" | "and")
        && matches!(thread.acts.as_slice(), [(Act::Gesture, _)])
        && found.deeds.first().is_some_and(|deed| Some(deed.act) == asked)
        && found
            .mentions
            .first()
            .is_some_and(|mention| mention.from == 0 && !matches!(mention.who, crate::mention::Who::Same));
    (matches!(word, "so" | "hence" | "thus" | "therefore") || answers)
        && spoken
        && thread.waiting.is_none()
        && found
            .deeds
            .first()
            .is_some_and(|deed| !deed.negated && deed::manner(deed.act).is_some() || deed.act == Act::GoOn)
}

/// What a gesture asks somebody to do.
const fn asked_for(gesture: Gesture) -> Option<Act> {
    match gesture {
        Gesture::Wait => Some(Act::Stop),
        Gesture::Proceed => Some(Act::GoOn),
        Gesture::ExcuseMe => Some(Act::GiveWay),
        Gesture::FollowMe => Some(Act::Follow),
        Gesture::Acknowledged => None,
    }
}

/// Whether somebody who stops or gives way does what another human asked for: `he asks her to wait; she then freezes`.
pub(crate) fn responds(said: Option<&Trigger>, act: Act) -> bool {
    matches!(said, Some(Trigger::HumanSays(_, gesture)) if asked_for(*gesture) == Some(act))
        && matches!(act, Act::Stop | Act::GiveWay)
}

/// `obeys`, `does so`: what the robot, or somebody else, asked for just before.
pub(crate) fn obeys(
    story: &mut Story,
    thread: &mut Thread,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    quote: &str,
) -> bool {
    let Some(said) = thread.said.clone() else { return false };
    let (Trigger::RobotSays(gesture) | Trigger::HumanSays(_, gesture)) = said else { return false };
    let Some(act) = asked_for(gesture) else { return false };
    let named: Vec<usize> = meant.iter().flat_map(|(_, _, some)| some.iter().copied()).collect();
    let people = match (named.is_empty(), &thread.subject) {
        (false, _) => named,
        (true, Subject::People(people)) => people.clone(),
        (true, Subject::Robot | Subject::Nobody) => return false,
    };
    // Whoever asked to be followed is followed.
    let object = if let Trigger::HumanSays(id, Gesture::FollowMe) = said { Some(id) } else { None };
    let around =
        Around { trigger: Some(said), object, lasts_s: found.lasts_s, quote: quote.to_owned(), ..Around::default() };
    for who in &people {
        let _rule = deed::apply(&mut story.cast, *who, act, &around);
    }
    thread.subject = Subject::People(people);
    true
}

/// Says of these people what the clause before said of others, or rules it out for them.
pub(crate) fn repeat(
    story: &mut Story,
    thread: &mut Thread,
    meant: &[(usize, usize, Vec<usize>)],
    (does, timed): (bool, bool),
    stretch: &mut Stretch,
    quote: &str,
) {
    for word in &mut stretch.words {
        word.used = true;
    }
    let waits = matches!(thread.waiting, Some(Trigger::RobotSays(_) | Trigger::HumanSays(..)));
    if does && waits && thread.made.is_empty() && obeys(story, thread, &Found::default(), meant, quote) {
        return;
    }
    let mut acts = thread.acts.clone();
    // `…; the second does so only when it asks`: the deed, not when the first one does it.
    let timed = timed && does && !acts.is_empty();
    if timed {
        thread.made.clear();
        for (_, around) in &mut acts {
            (around.trigger, around.distance_m) = (None, None);
        }
    }
    // `the first one does not stop; the other two do`
    let asks = matches!(thread.said, Some(Trigger::RobotSays(gesture)) if asked_for(gesture) == thread.denied);
    if does && acts.is_empty() && thread.made.is_empty() && !asks {
        let around = Around { quote: quote.to_owned(), ..Around::default() };
        acts.extend(thread.denied.map(|act| (act, around)));
    }
    let fresh = timed || thread.acts.is_empty() && !acts.is_empty();
    // `each time the robot stops, so does the intern`
    if does && thread.made.is_empty() && thread.waiting == Some(Trigger::RobotStopped) {
        acts.clear();
        let around = Around { trigger: thread.waiting.clone(), quote: quote.to_owned(), ..Around::default() };
        acts.push((Act::Stop, around));
        thread.untaken = None;
    }
    // `a guide asks two guests to follow her, and both do so`
    let asked = matches!(thread.said, Some(Trigger::HumanSays(..))) && acts.iter().all(|(act, _)| *act == Act::Gesture);
    if does && asked && !acts.is_empty() && obeys(story, thread, &Found::default(), meant, quote) {
        return;
    }
    // `the robot tells them to go ahead, which they do`
    if does && acts.is_empty() && obeys(story, thread, &Found::default(), meant, quote) {
        return;
    }
    let mut people: Vec<usize> = meant.iter().flat_map(|(_, _, some)| some.iter().copied()).collect();
    // `the second and the third do so`
    let listed = if stretch.joint == crate::cut::Joint::And { std::mem::take(&mut thread.pending) } else { Vec::new() };
    if !people.is_empty() {
        people.splice(0..0, listed.into_iter().filter(|who| !meant.iter().any(|(_, _, some)| some.contains(who))));
    }
    if let (true, Subject::People(some)) = (people.is_empty(), &thread.subject) {
        people.clone_from(some);
    }
    for who in &people {
        for (act, around) in &acts {
            if does {
                if let Some(rule) = deed::apply(&mut story.cast, *who, *act, around).filter(|_| fresh) {
                    thread.made.push((*who, rule));
                }
            } else {
                deed::rule_out(&mut story.cast, *who, *act, quote);
            }
        }
        if let Some(person) = story.cast.people.get_mut(*who) {
            person.bound = true;
        }
    }
    if acts.is_empty() {
        story.cast.notes.push(format!("`{quote}` leaves out what is done, and nothing before says it"));
    }
    if !people.is_empty() {
        story.cast.last.clone_from(&people);
        thread.subject = Subject::People(people);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clause;
    use crate::cut::sentences;

    #[test]
    fn a_clause_without_its_verb_is_told_from_one_that_has_it() {
        for (text, does) in [
            ("the other does not", Some(false)),
            ("the nurse will not either", Some(false)),
            ("the second one does the same", Some(true)),
            ("so does the intern", Some(true)),
            ("only one does", Some(true)),
            ("one is there", None),
            ("the nurse does not move", None),
        ] {
            let mut stretch = sentences(text).remove(0).remove(0);
            let found = clause::read(&mut stretch);
            assert_eq!(elided(&stretch, &found), does, "{text}");
        }
    }
}
