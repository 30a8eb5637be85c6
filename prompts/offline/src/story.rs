//! The rough scenario, clause by clause: subjects, triggers and deeds are bound to people.

use socrates_model::{Fault, FaultCode, Gesture, HumanId, PlaceClass, Trigger};

use crate::cast::Cast;
use crate::clause::{self, Found};
use crate::cut::{Joint, Stretch, sentences};
use crate::deed::{self, Around};
use crate::lexicon::{Act, Cue, lexicon};
use crate::mention::Who;
use crate::robot_deed::{place_of, robot_deed};

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
    pub(crate) ignored: Vec<String>,
    pub(crate) problems: Vec<Fault>,
}

#[derive(Debug, Clone, PartialEq)]
enum Subject {
    Nobody,
    Robot,
    People(Vec<usize>),
}

/// What reaches from clause to clause within a sentence.
struct Thread {
    subject: Subject,
    pending: Vec<usize>,
    waiting: Option<Trigger>,
    /// Words of the trigger that waits, until a deed takes it.
    untaken: Option<String>,
    /// Whether the trigger that waits names no distance.
    vague: bool,
    /// Rules of the clause before, by person and index, that a later `when` may still time.
    made: Vec<(usize, usize)>,
    /// The subject of the deed before in this sentence, for `stops and gestures`.
    doer: Option<Vec<usize>>,
    /// Whom somebody leads, and who: `A mother leads two children across`.
    led: Option<(Vec<usize>, Vec<usize>)>,
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
    };
    for mut sentence in sentences {
        (thread.waiting, thread.doer) = (None, None);
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
        for word in sentence.iter().flat_map(|stretch| &stretch.words) {
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
    place_of(story, &found, &quote);
    if stretch.joint == Joint::Except && excepted(story, thread, &found) {
        return;
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
        let mut people = story.cast.resolve(mention, declares && matches!(mention.who, Who::New { .. }), said);
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
    if !found.acts() {
        return quiet(story, thread, &found, &meant, stretch, &quote, next);
    }
    if let Some(secs) = found.after_s {
        thread.waiting = Some(Trigger::AfterSecs(secs));
    } else if let Some((cue, _)) = found.cue {
        thread.waiting = Some(trigger(cue, &found));
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
    let mut acts: Vec<(Act, usize, usize, bool)> =
        found.deeds.iter().map(|deed| (deed.act, deed.at, deed.to, deed.negated)).collect();
    if found.gesture.is_some() {
        acts.push((Act::Gesture, found.gesture_at, found.gesture_at, false));
        acts.sort_by_key(|(_, at, _, _)| *at);
    }
    for (act, at, to, negated) in acts {
        let passive = stretch.words.get(to + 1).is_some_and(|word| word.text == "by")
            && meant.iter().any(|(from, _, _)| *from > to);
        let subject = subject_of((act, at, to), passive, &found, &meant, &previous, &joined, &story.cast);
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
                robot_deed(story, act, &found, &meant, at, quote);
                // `The robot asks to be let through and the first one gives way`: what comes next answers it.
                if let Some(gesture) = found.gesture.filter(|_| act == Act::Gesture && thread.waiting.is_none()) {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotSays(gesture)), false);
                }
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
                story.cast.notes.push(format!("`{quote}` rules something out for everybody; no reaction is added"));
            }
            Subject::Nobody => story.problems.push(Fault::new(
                FaultCode::PRead,
                "rough_scenario",
                format!("`{quote}` does not say who does it"),
            )),
        }
        if subject != Subject::Nobody {
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

fn robot_first(found: &Found) -> bool {
    found.robots.first().is_some_and(|robot| found.mentions.iter().all(|mention| mention.from > *robot))
        || found.mentions.is_empty()
        || matches!(found.cue, Some((Cue::Visible, _)))
}

fn trigger(cue: Cue, found: &Found) -> Trigger {
    match cue {
        Cue::Visible => deed::with_distance(Trigger::RobotVisible(5.0), found.distance_m),
        Cue::Near => deed::with_distance(Trigger::RobotNear(3.0), found.distance_m),
        Cue::Blocking => deed::with_distance(Trigger::RobotBlocking(2.0), found.distance_m),
        Cue::Stopped => Trigger::RobotStopped,
        Cue::Moving => Trigger::RobotMoving,
        Cue::Goal => Trigger::GoalReached,
        Cue::Says => found.gesture.map_or(Trigger::RobotNear(3.0), Trigger::RobotSays),
    }
}

/// A clause that only says when: it times the deeds before it, or those still to come.
fn timing(story: &mut Story, thread: &mut Thread, stretch: &Stretch, found: &Found, quote: &str) {
    let Some((cue, _)) = found.cue else { return };
    place_of(story, found, quote);
    if let (Cue::Says, Some(gesture)) = (cue, found.gesture) {
        story.robot_says.push((gesture, quote.to_owned()));
    }
    // A word or a standstill of the robot ends the deed exactly; passing by takes a while.
    if stretch.joint == Joint::Until && matches!(cue, Cue::Stopped | Cue::Moving | Cue::Says) {
        let when = trigger(cue, found);
        let people: std::collections::BTreeSet<usize> = thread.made.iter().map(|(who, _)| *who).collect();
        for who in people {
            deed::walk_on(&mut story.cast, who, when.clone(), quote);
        }
        return;
    }
    if stretch.joint == Joint::Until {
        for (who, rule) in &thread.made {
            if let Some(read) = story.cast.people.get_mut(*who).and_then(|p| p.rules.get_mut(*rule)) {
                read.rule.for_s = Some(10.0);
            }
        }
        story.cast.notes.push(format!("`until {quote}` was read as 10 s"));
        return;
    }
    let back = matches!(stretch.joint, Joint::When | Joint::While) && !thread.made.is_empty() && !stretch.after_and;
    // `stays when they see the robot` speaks of whom it spoke before, be it one or many.
    for mention in found.mentions.iter().filter(|mention| !(back && matches!(mention.who, Who::All | Who::Same))) {
        let people = story.cast.resolve(mention, false, quote);
        if !people.is_empty() {
            story.cast.last.clone_from(&people);
            thread.subject = Subject::People(people);
        }
    }
    let when = trigger(cue, found);
    // `runs away upon seeing it` looks back; `When the robot comes near, …` looks ahead.
    if back {
        for (who, rule) in std::mem::take(&mut thread.made) {
            if let Some(read) = story.cast.people.get_mut(who).and_then(|p| p.rules.get_mut(rule)) {
                // A run away must still be a meeting; without a distance in the text the usual one stays.
                let usual = read.rule.when.first().cloned();
                read.rule.when = vec![match (usual, &when, found.distance_m) {
                    (Some(Trigger::RobotVisible(m)), Trigger::RobotVisible(_), None) => Trigger::RobotVisible(m),
                    _ => when.clone(),
                }];
                read.stated = true;
                read.exact = found.distance_m.is_some();
                read.quote = format!("{}, {quote}", read.quote);
            }
        }
    } else {
        thread.waiting = Some(when);
        // Who comes out waits for the door anyway.
        thread.untaken = Some(quote.to_owned()).filter(|quote| !quote.contains("open"));
        thread.vague = found.distance_m.is_none();
    }
}

/// A clause without a deed: it names people, places, a group, a pace.
fn quiet(
    story: &mut Story,
    thread: &mut Thread,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    stretch: &Stretch,
    quote: &str,
    next: Option<Joint>,
) {
    let mut people: Vec<usize> = Vec::new();
    for (_, _, some) in meant {
        people.extend(some.iter().filter(|i| !people.contains(i)).copied().collect::<Vec<_>>());
    }
    if let Some(secs) = found.after_s {
        thread.waiting = Some(Trigger::AfterSecs(secs));
    }
    if people.is_empty() {
        if !found.robots.is_empty() {
            thread.subject = Subject::Robot;
        } else if let Subject::People(last) = &thread.subject
            && (found.in_group || found.pace_mps.is_some() || found.lasts_s.is_some())
        {
            people.clone_from(last);
        }
    }
    if !thread.pending.is_empty() && matches!(stretch.joint, Joint::And | Joint::Comma) {
        let mut all = std::mem::take(&mut thread.pending);
        all.extend(people.iter().filter(|i| !all.contains(i)).copied().collect::<Vec<_>>());
        story.cast.together(&all, quote);
        people = all;
    }
    if people.is_empty() {
        return;
    }
    if found.in_group {
        story.cast.group(&people, quote);
    }
    for i in &people {
        if let Some(person) = story.cast.people.get_mut(*i) {
            person.speed_mps = found.pace_mps.or(person.speed_mps);
            if let Some((class, _)) =
                found.places.first().filter(|(class, _)| matches!(class, PlaceClass::Elevator | PlaceClass::Room))
            {
                person.start = Some(*class);
            }
            if let (Some(secs), Some(last)) = (found.lasts_s, person.rules.last_mut()) {
                last.rule.for_s = Some(secs);
            }
        }
    }
    // `a nurse and …`: only bare mentions wait for the deed of the next clause.
    let bare = stretch.words.iter().enumerate().all(|(i, word)| {
        meant.iter().any(|(from, to, _)| (*from..=*to).contains(&i)) || matches!(word.text.as_str(), "both" | "either")
    });
    if bare && matches!(next, Some(Joint::And | Joint::Comma)) {
        thread.pending.clone_from(&people);
    }
    story.cast.last.clone_from(&people);
    thread.subject = Subject::People(people);
}

fn subject_of(
    (act, at, to): (Act, usize, usize),
    passive: bool,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    previous: &Subject,
    joined: &[usize],
    cast: &Cast,
) -> Subject {
    let people = |some: &Vec<usize>| {
        let mut all = joined.to_vec();
        all.extend(some.iter().filter(|i| !joined.contains(i)));
        Subject::People(all)
    };
    if let Some((_, _, inside)) = meant.iter().find(|(from, to, _)| (*from..=*to).contains(&at)) {
        return people(inside);
    }
    if passive && let Some((_, _, agent)) = meant.iter().find(|(from, _, _)| *from > at) {
        return people(agent);
    }
    let before = meant.iter().rev().find(|(from, _, some)| *from < at && !some.is_empty());
    // `Behind the robot comes a doctor`: who does it stands after the verb.
    let turned = matches!(act, Act::Behind | Act::Ahead | Act::Walk | Act::Stand | Act::ComeOut | Act::Toward);
    if before.is_none()
        && turned
        && let Some((_, _, some)) = meant.iter().find(|(from, _, some)| *from == to + 1 && !some.is_empty())
    {
        return people(some);
    }
    let robot = found.robots.iter().rev().find(|robot| **robot < at);
    let robotic = matches!(
        act,
        Act::Pass
            | Act::Walk
            | Act::Stop
            | Act::Follow
            | Act::Lead
            | Act::Gesture
            | Act::Enter
            | Act::Overtake
            | Act::ComeOut
            | Act::GiveWay
            | Act::Abreast
            | Act::Stay
            | Act::Stand
            | Act::Toward
            | Act::Cross
    );
    match (before, robot) {
        (Some((from, _, some)), Some(robot)) if robotic && robot > from => {
            // The robot between a person and the deed is the object of an earlier one, unless it opens a clause of its own.
            if found.deeds.iter().any(|deed| deed.at > *from && deed.at < *robot) {
                people(some)
            } else {
                Subject::Robot
            }
        }
        (Some((_, _, some)), _) => people(some),
        (None, Some(_)) if robotic => Subject::Robot,
        (None, _) => {
            if !joined.is_empty() {
                return Subject::People(joined.to_vec());
            }
            match previous {
                Subject::Robot if robotic => Subject::Robot,
                Subject::Robot | Subject::Nobody => match meant.first() {
                    Some((_, _, some)) if !some.is_empty() => people(some),
                    Some(_) | None if !cast.last.is_empty() => Subject::People(cast.last.clone()),
                    Some(_) | None => Subject::Nobody,
                },
                Subject::People(some) => Subject::People(some.clone()),
            }
        }
    }
}

#[expect(clippy::too_many_arguments, reason = "all that surrounds a deed decides what it means")]
fn people_deed(
    story: &mut Story,
    thread: &mut Thread,
    (act, at, to): (Act, usize, usize),
    people: &[usize],
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    stretch: &Stretch,
    quote: &str,
) {
    let object = meant
        .iter()
        .find(|(from, _, some)| *from > to && some.iter().all(|i| !people.contains(i)))
        .and_then(|(_, _, some)| some.first());
    if act == Act::Lead {
        let followers: Vec<usize> =
            meant.iter().find(|(from, _, _)| *from > to).map(|(_, _, some)| some.clone()).unwrap_or_default();
        let leader = people.first().and_then(|i| u32::try_from(i + 1).ok()).map(HumanId::new);
        for who in followers.iter().filter(|who| !people.contains(who)) {
            let around = Around { object: leader, quote: quote.to_owned(), ..Around::default() };
            let _rule = deed::apply(&mut story.cast, *who, Act::Follow, &around);
        }
        thread.led = Some((people.to_vec(), followers));
    }
    let object = if act == Act::Follow && found.robots.iter().all(|robot| *robot < at) { object } else { None };
    let startled = (at..=to).any(|i| {
        stretch
            .words
            .get(i)
            .is_some_and(|word| matches!(word.stem.as_str(), "startle" | "surprise" | "shock" | "astonish" | "freeze"))
    });
    let inside = found.places.first().map(|(class, _)| *class);
    let place = if matches!(act, Act::ComeOut | Act::Stay) {
        found
            .places
            .iter()
            .map(|(class, _)| *class)
            .find(|class| matches!(class, PlaceClass::Elevator | PlaceClass::Room | PlaceClass::Doorway))
            .or_else(|| people.iter().find_map(|i| story.cast.people.get(*i).and_then(|p| p.start)))
            .or_else(|| story.place.as_ref().map(|(class, _)| *class).filter(|class| *class == PlaceClass::Elevator))
    } else {
        inside
    };
    let around = Around {
        trigger: thread.waiting.clone(),
        vague: thread.vague,
        distance_m: found.distance_m,
        lasts_s: found.lasts_s,
        gesture: found.gesture,
        object: object.and_then(|i| u32::try_from(i + 1).ok()).map(HumanId::new),
        place,
        startled,
        then: stretch.joint == Joint::Then,
        goes_on: thread.doer.as_deref() == Some(people),
        quote: quote.to_owned(),
    };
    for who in people {
        if let Some(rule) = deed::apply(&mut story.cast, *who, act, &around) {
            thread.made.push((*who, rule));
        }
    }
    if matches!(act, Act::Talk | Act::WalkTogether) || found.in_group {
        story.cast.group(people, quote);
    }
    story.cast.last = people.to_vec();
    thread.doer = Some(people.to_vec());
}
