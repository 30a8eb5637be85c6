//! The rough scenario, clause by clause: subjects, triggers and deeds are bound to people.

use socrates_model::{Fault, FaultCode, Gesture, PlaceClass, Trigger};

use crate::again;
use crate::bind::{people_deed, subject_of};
use crate::cast::Cast;
use crate::clause::{self, Found};
use crate::cut::{Joint, Stretch, sentences};
use crate::deed::{self, Around};
use crate::ellipsis;
use crate::lexicon::{Act, lexicon};
use crate::mention::Who;
use crate::robot_deed::robot_deed;
use crate::timing::{quiet, robot_first, timing, trigger};
use crate::whereabouts::place_of;

/// Everything that was read of the rough scenario.
#[derive(Debug, Clone, Default)]
pub(crate) struct Story {
    pub(crate) cast: Cast,
    pub(crate) place: Option<(PlaceClass, String)>,
    pub(crate) robot_says: Vec<(Gesture, String)>,
    /// Card that the robot's own part asks for: it leads, follows or overtakes somebody.
    pub(crate) robot_part: Option<&'static str>,
    pub(crate) robot_enters: Option<(PlaceClass, String)>,
    pub(crate) robot_leaves: Option<(PlaceClass, String)>,
    /// Where people go: the robot goes there too if it leads them.
    pub(crate) headed: Option<(PlaceClass, String)>,
    pub(crate) ignored: Vec<String>,
    pub(crate) problems: Vec<Fault>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Subject {
    Nobody,
    Robot,
    People(Vec<usize>),
}

/// What reaches from clause to clause within a sentence.
pub(crate) struct Thread {
    pub(crate) subject: Subject,
    pub(crate) pending: Vec<usize>,
    pub(crate) waiting: Option<Trigger>,
    /// Words of the trigger that waits, until a deed takes it.
    pub(crate) untaken: Option<String>,
    /// Whether the trigger that waits names no distance.
    pub(crate) vague: bool,
    /// Rules of the clause before, by person and index, that a later `when` may still time.
    pub(crate) made: Vec<(usize, usize)>,
    /// The subject of the deed before in this sentence, for `stops and gestures`.
    pub(crate) doer: Option<Vec<usize>>,
    /// Whom somebody leads, and who: `A mother leads two children across`.
    pub(crate) led: Option<(Vec<usize>, Vec<usize>)>,
    /// What was said last, as what others may wait for.
    pub(crate) said: Option<Trigger>,
    /// The same, as long as nothing else was said to happen.
    pub(crate) fresh: Option<Trigger>,
    /// What the last acting clause said of its people, for `the other does not`.
    pub(crate) acts: Vec<(Act, Around)>,
    /// The clause before signals, or names the robot: a message alone is its message.
    pub(crate) speaks: bool,
    /// `does not move aside until …` says when it does.
    pub(crate) not_until: bool,
    /// What ended the deed before: `until it asks`.
    pub(crate) ended: Option<Trigger>,
    /// Who walked on in the clause before, which a later `when` may still time.
    pub(crate) went_on: Vec<usize>,
}

/// Reads the text.
pub(crate) fn read(text: &str) -> Story {
    read_on(Story::default(), sentences(text), text)
}

/// Reads sentences of a text about people of whom was spoken before.
pub(crate) fn read_on(mut story: Story, sentences: Vec<Vec<Stretch>>, text: &str) -> Story {
    let mut thread = Thread {
        subject: Subject::Nobody,
        pending: Vec::new(),
        waiting: None,
        untaken: None,
        vague: false,
        made: Vec::new(),
        doer: None,
        led: None,
        said: None,
        fresh: None,
        acts: Vec::new(),
        speaks: false,
        not_until: false,
        ended: None,
        went_on: Vec::new(),
    };
    for mut sentence in sentences {
        (thread.waiting, thread.doer) = (None, None);
        story.cast.listing = false;
        thread.made.clear();
        thread.pending.clear();
        let count = sentence.len();
        for i in 0..count {
            let next = sentence.get(i + 1).map(|next| next.joint);
            if let Some(stretch) = sentence.get_mut(i) {
                clause_of(&mut story, &mut thread, stretch, text, next);
            }
        }
        // A trigger without a deed is a wish that nothing was made of.
        if let Some(quote) = thread.untaken.take() {
            story.problems.push(Fault::new(
                FaultCode::PRead,
                "rough_scenario",
                format!("`{quote}` says when, but no reaction that was read waits for it; say who does what then (stop, look, follow, give way, gesture)"),
            ));
        }
        for word in sentence.iter().flat_map(|stretch| stretch.words.iter().chain(&stretch.also)) {
            let known =
                lexicon().stop.contains(&word.text) || lexicon().stop.contains(&word.stem) || word.stem == "robot";
            if !word.used && !known && !story.ignored.contains(&word.text) {
                story.ignored.push(word.text.clone());
            }
        }
    }
    story
}

fn clause_of(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, text: &str, next: Option<Joint>) {
    // Who somebody is, is no answer to what happens then; the clause after it may be.
    let suspended = (stretch.joint == Joint::Who).then(|| thread.waiting.take()).flatten();
    read_clause(story, thread, stretch, text, next);
    if thread.waiting.is_none() && suspended.is_some() {
        thread.waiting = suspended;
    }
}

fn read_clause(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, text: &str, next: Option<Joint>) {
    let quote = stretch.quote(text).to_owned();
    let found = clause::read(stretch);
    for i in &found.nowhere {
        let word = stretch.words.get(*i).map_or("", |word| word.text.as_str());
        story.problems.push(Fault::new(
            FaultCode::PPlace,
            "rough_scenario",
            format!("`{word}` in `{quote}` is a place that no location of this kind has"),
        ));
    }
    mark(stretch, &found.nowhere);
    if let Some(gesture) = found.only_says.filter(|_| thread.speaks) {
        return only_says(story, thread, stretch, gesture, &quote);
    }
    thread.speaks = found.gesture.is_some() || !found.acts() && !found.robots.is_empty() && found.mentions.is_empty();
    if stretch.joint == Joint::Said {
        (thread.waiting, thread.vague) = (thread.said.clone(), false);
    } else if answers(&found) && thread.waiting.is_none() && stretch.joint != Joint::Then {
        // `The robot says PROCEED. He walks on.`
        (thread.waiting, thread.vague) = (thread.fresh.take(), false);
    } else if stretch.joint == Joint::Then && thread.waiting.is_none() && found.acts() {
        // `blocks its way until it asks; then he steps aside`
        (thread.waiting, thread.vague) = (thread.ended.take(), false);
    }
    if found.acts() {
        thread.fresh = None;
    }
    let cue_only = found.cue.is_some()
        && (found.deeds.is_empty() || matches!(stretch.joint, Joint::When | Joint::Until) && robot_first(&found));
    let temporal = matches!(stretch.joint, Joint::Until | Joint::When | Joint::While);
    if cue_only && (temporal || found.gesture.is_none()) {
        return timing(story, thread, stretch, &found, &quote);
    }
    if !found.impossible.is_empty() {
        let verbs: Vec<&str> =
            found.impossible.iter().filter_map(|i| stretch.words.get(*i)).map(|word| word.text.as_str()).collect();
        story.problems.push(Fault::new(
            FaultCode::PRead,
            "rough_scenario",
            format!("`{}` in `{quote}` cannot be simulated; people walk, stop, look, follow, flee, block, give way, approach and gesture", verbs.join("`, `")),
        ));
        let at = found.impossible.clone();
        mark(stretch, &at);
    }
    place_of(story, &found, stretch, &thread.subject, &quote);
    if stretch.joint == Joint::Except && excepted(story, thread, &found) {
        return;
    }
    // `two people: a nurse who …, and a visitor who …` lists those two.
    if stretch.words.first().is_some_and(|word| word.after_colon) {
        story.cast.lists();
    }
    let nobody = found.mentions.iter().any(|mention| mention.who == Who::Nobody && mention.role.is_none());
    if nobody && found.declares && next != Some(Joint::Except) && !story.cast.people.is_empty() {
        let first = story.cast.count_quote.clone().unwrap_or_default();
        story.problems.push(Fault::new(
            FaultCode::PContra,
            "rough_scenario",
            format!(
                "`{first}` speaks of {}, but `{quote}` says that nobody is there; correct one of the two",
                story.cast.people.len()
            ),
        ));
    }
    // Whom the mentions mean, in order.
    let mut meant: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    let spoken_of = story.cast.last.clone();
    for mention in &found.mentions {
        let words = stretch.words.get(mention.from..=mention.to).unwrap_or_default();
        let from = words.first().map_or(0, |word| word.from);
        let to = words.last().map_or(0, |word| word.to);
        let said = text.get(from..to).unwrap_or_default();
        let declares = found.declares
            || !found.acts() && mention.who != Who::Nobody && thread.pending.is_empty() && next != Some(Joint::And);
        let mut people =
            story.cast.resolve(mention, declares && matches!(mention.who, Who::New { .. } | Who::Bare(_)), said);
        if mention.who == Who::Object {
            // `The nurse wants the robot to follow her` is the nurse; `a second one follows him` is who came before.
            let robot = found.robots.iter().rev().find(|robot| **robot < mention.from);
            let own =
                meant.iter().rev().find(|(from, _, some)| robot.is_some_and(|robot| from < robot) && !some.is_empty());
            people = own.map_or_else(|| spoken_of.clone(), |(_, _, some)| some.clone());
            meant.push((mention.from, mention.to, people));
            continue;
        }
        if !people.is_empty() {
            story.cast.last.clone_from(&people);
        }
        meant.push((mention.from, mention.to, people));
    }
    if !stretch.also.is_empty() {
        also_called(story, &meant, stretch);
    }
    if again::note(story, thread, stretch, &found, &meant, &quote) {
        return;
    }
    if let Some(does) = ellipsis::elided(stretch, &found) {
        return ellipsis::repeat(story, thread, &meant, does, stretch, &quote);
    }
    if found.obeys && !found.acts() && ellipsis::obeys(story, thread, &found, &meant, &quote) {
        return;
    }
    if !found.acts() {
        return quiet(story, thread, &found, &meant, stretch, &quote, next);
    }
    if let Some(secs) = found.after_s {
        thread.waiting = Some(Trigger::AfterSecs(secs));
    } else if let Some((cue, _)) = found.cue {
        thread.waiting = trigger(cue, &found, thread);
        thread.vague = found.distance_m.is_none();
    } else if found.distance_is_when
        && let (Some(waiting), Some(m)) = (&thread.waiting, found.distance_m)
    {
        // `When it sees the robot …, and at 1.5 m it stops`: the nearer distance is that of this deed.
        thread.waiting = Some(deed::with_distance(waiting.clone(), Some(m)));
        thread.vague = false;
    }
    let previous = thread.subject.clone();
    let mut joined = std::mem::take(&mut thread.pending);
    // `Five people: two follow the robot`: some of those who wait for a deed, not others beside them.
    if meant.iter().any(|(_, _, some)| !some.is_empty() && some.iter().all(|i| joined.contains(i))) {
        joined.clear();
    }
    thread.led = None;
    thread.made.clear();
    thread.acts.clear();
    thread.went_on.clear();
    thread.not_until = false;
    let mut acts: Vec<(Act, usize, usize, bool)> =
        found.deeds.iter().map(|deed| (deed.act, deed.at, deed.to, deed.negated)).collect();
    // `refuses to let it through for 20 seconds` blocks it so long.
    for (act, at, _, negated) in &mut acts {
        let lets = stretch.words.get(*at).is_some_and(|word| word.stem == "let");
        if *act == Act::GiveWay && *negated && lets && found.lasts_s.is_some() {
            (*act, *negated) = (Act::Block, false);
        }
    }
    if found.gesture.is_some() {
        acts.push((Act::Gesture, found.gesture_at, found.gesture_at, false));
        acts.sort_by_key(|(_, at, _, _)| *at);
    }
    for (act, at, to, negated) in acts {
        let passive = stretch.words.get(to + 1).is_some_and(|word| word.text == "by")
            && meant.iter().any(|(from, _, _)| *from > to);
        // `is overtaken by the robot`: whom the robot overtakes stands before the verb.
        let by_robot = !passive && done_by_robot(stretch, act, at, to);
        let object: Vec<usize> = if by_robot {
            let before = meant.iter().rev().find(|(from, _, some)| *from < at && !some.is_empty());
            before.map_or_else(
                || if let Subject::People(people) = &previous { people.clone() } else { Vec::new() },
                |(_, _, some)| some.clone(),
            )
        } else {
            meant.iter().find(|(from, _, _)| *from > at).map(|(_, _, some)| some.clone()).unwrap_or_default()
        };
        let subject = if by_robot {
            Subject::Robot
        } else {
            subject_of((act, at, to), passive, &found, &meant, &previous, &joined, &story.cast)
        };
        // Whoever is led goes where the one who leads goes.
        let subject = match (subject, &thread.led) {
            (Subject::People(people), Some((leaders, followers))) if people == *followers => {
                Subject::People(leaders.clone())
            }
            (subject, _) => subject,
        };
        let quote = quote.as_str();
        thread.untaken = None;
        match &subject {
            Subject::Robot => {
                // `robot stops, worker stops`
                if thread.waiting.is_none() && next == Some(Joint::Comma) && act == Act::Stop && !negated {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotStopped), false);
                }
                robot_deed(story, act, &found, &object, quote);
                // `The robot asks to be let through and the first one gives way`: what comes next answers it.
                if let Some(gesture) = found.gesture.filter(|_| act == Act::Gesture && thread.waiting.is_none()) {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotSays(gesture)), false);
                }
                if let Some(gesture) = found.gesture.filter(|_| act == Act::Gesture) {
                    thread.said = Some(Trigger::RobotSays(gesture));
                    thread.fresh.clone_from(&thread.said);
                }
            }
            // `does not move aside until the robot asks`: it does then.
            Subject::People(people) if negated && next == Some(Joint::Until) && deed::manner(act).is_some() => {
                people_deed(story, thread, (act, at, to), people, &found, &meant, stretch, quote);
                thread.not_until = true;
            }
            Subject::People(people) if negated => {
                for who in people {
                    deed::rule_out(&mut story.cast, *who, act, quote);
                }
                let people: Vec<String> = people.iter().map(|i| format!("human_{}", i + 1)).collect();
                story
                    .cast
                    .notes
                    .push(format!("`{quote}` rules something out for {}; no reaction is added", people.join(" and ")));
            }
            Subject::People(people) => {
                people_deed(story, thread, (act, at, to), people, &found, &meant, stretch, quote)
            }
            Subject::Nobody if found.mentions.iter().any(|mention| mention.who == Who::Nobody) => {
                for who in 0..story.cast.people.len() {
                    deed::rule_out(&mut story.cast, who, act, quote);
                }
                story.cast.notes.push(format!("`{quote}` rules something out for everybody; no reaction is added"));
            }
            Subject::Nobody => story.problems.push(Fault::new(
                FaultCode::PRead,
                "rough_scenario",
                format!("`{quote}` does not say who does it"),
            )),
        }
        if subject != Subject::Nobody && !(by_robot && matches!(previous, Subject::People(_))) {
            thread.subject = subject;
        }
    }
    if let Some(mps) = found.pace_mps {
        let object = meant.first().map(|(_, _, some)| some.clone()).unwrap_or_default();
        let paced = if let Subject::People(people) = &thread.subject { people.clone() } else { object };
        for i in &paced {
            if let Some(person) = story.cast.people.get_mut(*i) {
                person.speed_mps = Some(mps);
            }
        }
    }
    // `a nurse who …`: the relative clause speaks of whom this clause named last.
    if next == Some(Joint::Who)
        && let Some((_, _, people)) = meant.last()
    {
        thread.subject = Subject::People(people.clone());
    }
}

/// `except for one who …`: takes the clause before back for so many of its people, who are spoken of next.
fn excepted(story: &mut Story, thread: &mut Thread, found: &Found) -> bool {
    let Some(doers) = thread.doer.clone().filter(|doers| doers.len() > 1) else { return false };
    let count = match found.mentions.first().map(|mention| &mention.who) {
        Some(Who::Bare(n) | Who::PartOf(n)) => usize::try_from(*n).unwrap_or(usize::MAX),
        Some(Who::New { count: Some(n), .. }) if found.deeds.is_empty() => usize::try_from(*n).unwrap_or(usize::MAX),
        _ => return false,
    };
    if count == 0 || count >= doers.len() {
        return false;
    }
    let out: Vec<usize> = doers.iter().rev().take(count).rev().copied().collect();
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

fn mark(stretch: &mut Stretch, at: &[usize]) {
    for i in at {
        if let Some(word) = stretch.words.get_mut(*i) {
            word.used = true;
        }
    }
}

/// Whether the clause is an answer to what the robot said just before.
fn answers(found: &Found) -> bool {
    let answer = |act: Act| matches!(act, Act::GoOn | Act::GiveWay);
    found.distance_m.is_none()
        && found.robots.is_empty()
        && found.gesture.is_none()
        && found.deeds.first().is_some_and(|deed| answer(deed.act) && !deed.negated)
}

/// Whether the robot does it: `is followed by the robot`.
fn done_by_robot(stretch: &Stretch, act: Act, at: usize, to: usize) -> bool {
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
    let by = (at..to + 3).find(|k| text(*k) == "by");
    does && by.is_some_and(|by| (by + 1..by + 4).any(|k| stretch.words.get(k).is_some_and(|word| word.stem == "robot")))
}

/// `raises a hand (WAIT)`, `Robot: excuse me`: a message alone is that of the clause before.
fn only_says(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, gesture: Gesture, quote: &str) {
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
        }
    }
}

/// `the third one, a security guard`: the role by which somebody is also called.
fn also_called(story: &mut Story, meant: &[(usize, usize, Vec<usize>)], stretch: &mut Stretch) {
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
    for who in people {
        if let Some(person) = story.cast.people.get_mut(*who)
            && (person.role.is_empty() || !lexicon().roles.contains_key(&person.role))
        {
            person.role.clone_from(&role);
        }
    }
    for (at, word) in stretch.also.iter_mut().enumerate() {
        word.used |= named.as_ref().is_some_and(|mention| (mention.from..=mention.to).contains(&at));
    }
}
