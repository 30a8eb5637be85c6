//! What surrounds a clause: suppositions and exceptions, answers, messages alone, and other names of the same people.

use socrates_model::{Gesture, Trigger};

use crate::clause::Found;
use crate::cut::{Joint, Stretch};
use crate::deed;
use crate::lexicon::{Act, lexicon};
use crate::mention::Who;
use crate::story::{Story, Subject, Thread};

/// Whether a sentence only supposes something, or tells what happens at times.
pub(crate) fn supposes(sentence: &[Stretch]) -> bool {
    let words: Vec<&str> =
        sentence.iter().flat_map(|stretch| &stretch.words).map(|word| word.text.as_str()).take(4).collect();
    let condition = sentence.get(1).is_some_and(|stretch| stretch.joint == Joint::When);
    let habit = words.iter().any(|word| matches!(*word, "sometimes" | "often" | "usually" | "normally" | "typically"));
    habit
        || matches!(words.first(), Some(&"what")) && (condition || words.get(1) == Some(&"if"))
        || matches!(
            words.as_slice(),
            ["you", "know", ..]
                | ["what", "happens" | "about", ..]
                | ["is", "it", "possible", ..]
                | ["what", "does", ..]
        )
}

/// Whether a sentence makes an exception from what was said before.
pub(crate) fn excepts(sentence: &[Stretch]) -> bool {
    sentence.iter().any(|stretch| {
        matches!(stretch.joint, Joint::Until | Joint::Except)
            || stretch
                .words
                .iter()
                .any(|word| matches!(word.text.as_str(), "only" | "except" | "but" | "unless" | "just"))
    })
}

/// `except for one who …`: takes the clause before back for so many of its people, who are spoken of next.
pub(crate) fn excepted(story: &mut Story, thread: &mut Thread, found: &Found) -> bool {
    let Some(doers) = thread.doer.clone().filter(|doers| doers.len() > 1) else { return false };
    let last = |n: u32| doers.len().checked_sub(usize::try_from(n).unwrap_or(usize::MAX)).filter(|from| *from > 0);
    let out = match found.mentions.first().map(|mention| &mention.who) {
        Some(Who::Bare(n) | Who::PartOf(n)) => last(*n).and_then(|from| doers.get(from..)),
        Some(Who::New { count: Some(n), .. }) if found.deeds.is_empty() => last(*n).and_then(|from| doers.get(from..)),
        // `everybody except the nurse`: of those who do it.
        Some(Who::Definite { plural: false, .. }) if found.deeds.is_empty() => {
            let role = found.mentions.first().and_then(|mention| mention.role.clone());
            let who = |i: &usize| role.is_some() && story.cast.people.get(*i).map(|one| &one.role) == role.as_ref();
            doers.iter().position(who).map(|at| doers.get(at..=at).unwrap_or_default())
        }
        Some(Who::Ordinal(0)) => doers.get(doers.len() - 1..),
        Some(Who::Ordinal(n)) if *n > 0 => usize::try_from(*n).ok().map(|n| doers.get(n - 1..n).unwrap_or_default()),
        _ => None,
    };
    let Some(out) = out.map(<[usize]>::to_vec).filter(|out| !out.is_empty()) else { return false };
    for who in &out {
        let rules: Vec<usize> = thread.made.iter().filter(|(of, _)| of == who).map(|(_, rule)| *rule).collect();
        deed::except(&mut story.cast, *who, &rules);
    }
    thread.made.retain(|(who, _)| !out.contains(who));
    story.cast.last.clone_from(&out);
    thread.subject = Subject::People(out);
    thread.doer = None;
    true
}

/// Whether the clause is an answer to what the robot said just before.
pub(crate) fn answers(found: &Found, said: Option<&Trigger>) -> bool {
    let to = |gesture: Gesture| said == Some(&Trigger::RobotSays(gesture));
    let answer = |act: Act| {
        matches!(act, Act::GoOn | Act::GiveWay)
            || act == Act::Follow && to(Gesture::FollowMe)
            || act == Act::Stop && to(Gesture::Wait)
    };
    found.distance_m.is_none()
        && found.robots.iter().all(|robot| found.deeds.first().is_some_and(|deed| deed.at < *robot))
        && found.gesture.is_none()
        && found.deeds.first().is_some_and(|deed| answer(deed.act) && !deed.negated)
}

/// Whether the robot does it: `is followed by the robot`.
pub(crate) fn done_by_robot(stretch: &Stretch, act: Act, at: usize, to: usize) -> bool {
    let does = matches!(
        act,
        Act::Overtake
            | Act::Follow
            | Act::Lead
            | Act::Abreast
            | Act::Pass
            | Act::Approach
            | Act::Toward
            | Act::Block
            | Act::Gesture
    );
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    // `is told "follow me" by the robot`
    let reach = if act == Act::Gesture && at > 0 && stretch.words.get(at - 1).is_some_and(|word| word.stem == "be") {
        8
    } else {
        3
    };
    let by = (at..to + reach).find(|k| text(*k) == "by");
    does && by.is_some_and(|by| (by + 1..by + 4).any(|k| stretch.words.get(k).is_some_and(|word| word.stem == "robot")))
}

/// `raises a hand (WAIT)`, `Robot: excuse me`: a message alone is that of the clause before.
pub(crate) fn only_says(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, gesture: Gesture, quote: &str) {
    for word in &mut stretch.words {
        word.used = true;
    }
    let signals = thread.made.last().copied();
    match signals.and_then(|(who, rule)| story.cast.people.get_mut(who).and_then(|person| person.rules.get_mut(rule))) {
        Some(read) if read.rule.gesture.is_some() => read.rule.gesture = Some(gesture),
        Some(_) | None => {
            story.robot_says.push((gesture, quote.to_owned()));
            (thread.waiting, thread.vague) = (Some(Trigger::RobotSays(gesture)), false);
            thread.said = Some(Trigger::RobotSays(gesture));
            thread.fresh.clone_from(&thread.said);
        }
    }
}

/// `the third one, a security guard`: the role by which somebody is also called.
pub(crate) fn also_called(story: &mut Story, meant: &[(usize, usize, Vec<usize>)], stretch: &mut Stretch) {
    let Some((_, _, people)) = meant.first() else { return };
    if let ([name], [who]) = (stretch.also.as_mut_slice(), people.as_slice())
        && name.capital
        && !lexicon().known.contains(&name.stem)
    {
        name.used = true;
        if let Some(person) = story.cast.people.get_mut(*who) {
            person.name = Some(name.stem.clone());
        }
        return;
    }
    let named = crate::mention::mentions(&stretch.also).into_iter().next();
    let Some(role) = named.as_ref().and_then(|mention| mention.role.clone()) else {
        // A name: nothing is lost where only the role counts.
        if let [name] = stretch.also.as_mut_slice() {
            name.used = true;
        }
        return;
    };
    // `Dr. Meyer, a surgeon`
    let titled = stretch.words.first().is_some_and(|word| word.text == "dr");
    for who in people {
        if let Some(person) = story.cast.people.get_mut(*who)
            && (person.role.is_empty()
                || !lexicon().roles.contains_key(&person.role)
                || titled && person.role == "doctor")
        {
            person.role.clone_from(&role);
        }
    }
    for (at, word) in stretch.also.iter_mut().enumerate() {
        word.used |= named.as_ref().is_some_and(|mention| (mention.from..=mention.to).contains(&at));
    }
}
