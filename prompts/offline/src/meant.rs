//! Whom the mentions of a clause mean.

use crate::clause::Found;
use crate::cut::{Joint, Stretch};
use crate::lexicon::lexicon;
use crate::mention::{Mention, Who};
use crate::story::{Story, Subject, Thread};

/// Whom the mentions of a clause mean, in order, with their first and last words.
pub(crate) fn meant(
    story: &mut Story,
    thread: &Thread,
    stretch: &mut Stretch,
    found: &Found,
    text: &str,
    next: Option<Joint>,
) -> Vec<(usize, usize, Vec<usize>)> {
    let mut meant: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    let spoken_of = story.cast.last.clone();
    for mention in &found.mentions {
        // `my staff get grumpy` tells of whoever asks.
        let owned = |word: &crate::words::Word| matches!(word.text.as_str(), "my" | "our");
        let people = matches!(mention.who, Who::New { count: None, .. });
        let owner = |k: usize| {
            stretch.words.get(k).is_some_and(owned) || people && k > 0 && stretch.words.get(k - 1).is_some_and(owned)
        };
        let told = stretch
            .words
            .get(mention.to + 1)
            .is_some_and(|word| lexicon().verbs.contains(&word.stem) && word.stem != "be");
        if !found.acts() && told && owner(mention.from) && next != Some(Joint::Who) {
            for word in stretch.words.iter_mut().take(mention.to + 1).skip(mention.from) {
                word.used = false;
            }
            continue;
        }
        let words = stretch.words.get(mention.from..=mention.to).unwrap_or_default();
        let from = words.first().map_or(0, |word| word.from);
        let to = words.last().map_or(0, |word| word.to);
        let said = text.get(from..to).unwrap_or_default();
        let declares = found.declares
            || !found.acts() && mention.who != Who::Nobody && thread.pending.is_empty() && next != Some(Joint::And);
        let known = story.cast.people.len();
        let made_of: Vec<String> = words.iter().flat_map(|word| word.made_of.clone()).collect();
        let asked = asked(story, found, mention);
        let mut people = if let Some(asked) = asked.or_else(|| story.cast.called_so(mention, words)) {
            asked
        } else if made_of.is_empty() {
            story.cast.resolve(mention, declares && matches!(mention.who, Who::New { .. } | Who::Bare(_)), said)
        } else {
            told_otherwise(story, mention, said, made_of.len());
            story.cast.made_of(mention, declares, said, &made_of)
        };
        // `he tells his colleague to wait; she herself walks on`: whoever spoke.
        let itself = stretch
            .words
            .get(mention.to + 1)
            .is_some_and(|word| matches!(word.text.as_str(), "herself" | "himself" | "themselves"));
        if mention.who == Who::Same && itself {
            let speaker = match thread.said {
                Some(socrates_model::Trigger::HumanSays(id, _)) => {
                    usize::try_from(id.number()).ok().and_then(|n| n.checked_sub(1))
                }
                _ => None,
            };
            let other =
                speaker.map(|who| vec![who]).or_else(|| Some(story.cast.before.clone()).filter(|some| some.len() == 1));
            if let Some(other) = other.filter(|other| story.cast.last.len() == 1 && *other != story.cast.last) {
                people = other;
            }
        }
        story.cast.call(mention, words, &people);
        // `Dr. Weber … Weber walks past`
        if let ([who], [.., role, name]) = (people.as_slice(), words)
            && name.capital
            && !lexicon().roles.contains_key(&name.stem)
            && lexicon().roles.contains_key(&role.stem)
            && let Some(person) = story.cast.people.get_mut(*who)
        {
            person.name.get_or_insert_with(|| name.stem.clone());
        }
        let names: Vec<&String> = words.iter().flat_map(|word| &word.called).collect();
        story.cast.name(&people, &names);
        // `a few people`, `several nurses`
        let vague =
            words.iter().any(|word| matches!(word.text.as_str(), "few" | "several" | "some" | "handful" | "many"));
        if vague && mention.word.is_empty() && people.len() > 1 && people.iter().all(|i| *i >= known) {
            story.cast.notes.push(format!("`{said}` names no number; it was read as {} humans", people.len()));
        }
        let most = words.first().is_some_and(|word| word.text == "most");
        if most && matches!(mention.who, Who::PartOfNew(..)) {
            story.cast.notes.push(format!("`{said}` names no number; it was read as {} humans", people.len()));
        }
        if mention.who == Who::Object {
            // `The nurse wants the robot to follow her` is the nurse; `a second one follows him` is who came before.
            let robot = found.robots.iter().rev().find(|robot| **robot < mention.from);
            let own =
                meant.iter().rev().find(|(from, _, some)| robot.is_some_and(|robot| from < robot) && !some.is_empty());
            people = own.map_or_else(|| spoken_of.clone(), |(_, _, some)| some.clone());
            // `a nurse asks a patient to follow her`: whoever asks, and so `she` from here on.
            if let (true, [(_, _, asker), _, ..]) = (found.gesture.is_some() && own.is_none(), meant.as_slice()) {
                people.clone_from(asker);
                let word = if said == "him" { "he" } else { "she" };
                if let ([only], "him" | "her") = (people.as_slice(), said)
                    && let Some(person) = story.cast.people.get_mut(*only)
                {
                    person.pronoun.get_or_insert_with(|| word.to_owned());
                }
            }
            // `another girl who follows her`: somebody else than who follows.
            let himself = found.acts()
                && (thread.subject == Subject::People(people.clone())
                    && (stretch.joint == Joint::Who || people.len() > 1 || mention.from == 1 && robot.is_none())
                    || meant.last().is_some_and(|(_, _, own)| *own == people));
            if himself && !story.cast.before.is_empty() {
                people.clone_from(&story.cast.before);
            }
            meant.push((mention.from, mention.to, people));
            continue;
        }
        if !people.is_empty() && story.cast.last != people {
            story.cast.before = std::mem::replace(&mut story.cast.last, people.clone());
        }
        meant.push((mention.from, mention.to, people));
    }
    meant
}

/// `exactly three people: a nurse, two visitors and a cleaner`
fn told_otherwise(story: &mut Story, mention: &Mention, said: &str, listed: usize) {
    let Who::New { count: Some(n), .. } = mention.who else { return };
    if usize::try_from(n) != Ok(listed) && !mention.group {
        story.problems.push(
            socrates_model::Fault::new(
                socrates_model::FaultCode::PContra,
                "rough_scenario",
                format!("`{said}` counts {n}, but {listed} are listed; correct one of the two"),
            )
            .about([said]),
        );
    }
}

/// `Two people block it. The robot asks two people to step aside`: those two.
fn asked(story: &Story, found: &Found, mention: &Mention) -> Option<Vec<usize>> {
    let robot = found.robots.first().is_some_and(|robot| *robot < mention.from);
    let (Who::New { count: Some(n), article: false } | Who::Bare(n)) = mention.who else { return None };
    let them = story.cast.latest();
    let same = them.len() > 1 && usize::try_from(n) == Ok(them.len()) && mention.role.is_none();
    (robot && same && found.gesture.is_some()).then_some(them)
}
