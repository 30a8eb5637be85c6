//! Clauses that only say when, and clauses that only name people.

use socrates_model::{Fault, FaultCode, Gesture, HumanId, PlaceClass, Trigger};

use crate::clause::Found;
use crate::cut::{Joint, Stretch};
use crate::deed;
use crate::lexicon::{Act, Cue};
use crate::mention::Who;
use crate::order;
use crate::relation;
use crate::robot_deed::robot_deed;
use crate::story::{Story, Subject, Thread};
use crate::whereabouts::place_of;

/// What is done until the robot has passed is done for no longer than this, s.
const PASSES_S: f64 = 30.0;

/// How long is done what lasts until something that has no exact moment, s.
const UNTIL_S: f64 = 10.0;

/// Whether the robot is who the clause speaks of.
pub(crate) fn robot_first(found: &Found) -> bool {
    found.robots.first().is_some_and(|robot| found.mentions.iter().all(|mention| mention.from > *robot))
        || found.mentions.is_empty()
        || matches!(found.cue, Some((Cue::Visible, _)))
}

/// What a cue waits for.
pub(crate) fn trigger(cue: Cue, found: &Found, thread: &Thread) -> Option<Trigger> {
    Some(match cue {
        Cue::Visible => Trigger::RobotVisible(found.distance_m.unwrap_or(5.0)),
        Cue::Near => Trigger::RobotNear(found.distance_m.unwrap_or(3.0)),
        Cue::Blocking => Trigger::RobotBlocking(found.distance_m.unwrap_or(2.0)),
        Cue::Stopped => Trigger::RobotStopped,
        Cue::Moving => Trigger::RobotMoving,
        Cue::Passed => Trigger::RobotPassed,
        Cue::Goal => Trigger::GoalReached,
        Cue::Meet => Trigger::AtEncounter,
        // `when he hears it`: what was said just before.
        Cue::Says => match (found.gesture, &thread.said) {
            (Some(gesture), _) => Trigger::RobotSays(gesture),
            (None, Some(said @ (Trigger::HumanSays(..) | Trigger::RobotSays(_)))) => said.clone(),
            (None, _) => Trigger::RobotNear(3.0),
        },
        Cue::Told | Cue::Echo => thread.said.clone()?,
    })
}

/// Somebody makes a gesture for which another one waits: `when human 1 gestures WAIT, …`.
fn told(story: &mut Story, thread: &mut Thread, found: &Found, quote: &str) {
    let Some(gesture) = found.gesture else { return };
    let mention = found.mentions.iter().rev().find(|mention| mention.from < found.gesture_at);
    let people = mention.map(|mention| story.cast.resolve(mention, false, quote)).unwrap_or_default();
    let Some(first) = people.first().copied() else { return };
    let makes = |story: &Story| {
        story
            .cast
            .people
            .get(first)
            .is_some_and(|person| person.rules.iter().any(|read| read.rule.gesture == Some(gesture)))
    };
    if !makes(story) {
        let around = deed::Around { gesture: Some(gesture), quote: quote.to_owned(), ..deed::Around::default() };
        let _rule = deed::apply(&mut story.cast, first, Act::Gesture, &around);
    }
    let id = HumanId::new(u32::try_from(first + 1).unwrap_or(u32::MAX));
    thread.said = Some(Trigger::HumanSays(id, gesture));
    // `When the boss tells him to make room, he steps aside`: whoever was told.
    // `When Anna tells Ben to wait, he stops`
    let whom = found.mentions.iter().find(|mention| {
        mention.from > found.gesture_at && matches!(mention.who, Who::Definite { .. } | Who::Other(_) | Who::Ordinal(_))
    });
    if let Some(whom) = whom {
        let people = story.cast.resolve(whom, false, quote);
        if !people.is_empty() && !people.contains(&first) {
            story.cast.last = people;
        }
    }
    let told = found.mentions.iter().any(|mention| mention.from > found.gesture_at && mention.who == Who::Object);
    if told {
        let before: Vec<usize> =
            story.cast.last.iter().chain(&story.cast.before).copied().filter(|i| *i != first).collect();
        let other = if story.cast.people.len() == 2 { vec![1 - first.min(1)] } else { before };
        if let Some(who) = other.first() {
            story.cast.last = vec![*who];
        }
    }
}

/// `after the robot has asked`, of which nothing was said before: for its way.
fn asked(thread: &Thread, stretch: &Stretch, found: &Found) -> Option<Found> {
    let (Cue::Echo, at) = found.cue? else { return None };
    let asks = stretch.words.iter().any(|word| matches!(word.stem.as_str(), "ask" | "request"));
    let says = Found { cue: Some((Cue::Says, at)), gesture: Some(Gesture::ExcuseMe), ..found.clone() };
    (asks && thread.said.is_none() && robot_leads(found)).then_some(says)
}

/// A clause that only says when: it times the deeds before it, or those still to come.
pub(crate) fn timing(
    story: &mut Story,
    thread: &mut Thread,
    stretch: &Stretch,
    found: &Found,
    (quote, next): (&str, Option<Joint>),
) {
    let asked = asked(thread, stretch, found);
    let found = asked.as_ref().unwrap_or(found);
    let Some((cue, _)) = found.cue else { return };
    thread.paused = false;
    let bare = thread.bare_before;
    place_of(story, found, stretch, &thread.subject, quote);
    // `just as the robot wants to get in`
    let comes_in = stretch.words.last().is_some_and(|word| word.text == "in")
        && stretch.words.iter().any(|word| matches!(word.stem.as_str(), "come" | "drive" | "roll" | "go" | "get"))
        || stretch.words.iter().any(|word| word.stem == "enter");
    let enters = found.deeds.iter().any(|deed| deed.act == Act::Enter) && !found.robots.is_empty() || comes_in;
    if enters && robot_first(found) && found.mentions.is_empty() {
        robot_deed(story, Act::Enter, found, &[], quote);
    }
    if let (Cue::Says, Some(gesture)) = (cue, found.gesture) {
        story.robot_says.push((gesture, quote.to_owned()));
        thread.said = Some(Trigger::RobotSays(gesture));
    }
    if cue == Cue::Told {
        told(story, thread, found, quote);
    }
    let until = stretch.joint == Joint::Until && !std::mem::take(&mut thread.not_until);
    if until
        && thread.joiner == Some(order::Joiner::Unless)
        && thread.made.is_empty()
        && thread.doer.is_none()
        && next == Some(Joint::Comma)
    {
        thread.unless = trigger(cue, found, thread);
    }
    // A word or a standstill of the robot ends the deed exactly; passing by takes a while.
    if until
        && matches!(cue, Cue::Stopped | Cue::Moving | Cue::Passed | Cue::Says | Cue::Told | Cue::Echo)
        && let Some(when) = trigger(cue, found, thread)
    {
        let people: std::collections::BTreeSet<usize> = thread.made.iter().map(|(who, _)| *who).collect();
        // `does not let it through unless it says excuse me`: then it does.
        let lets = |who: usize| {
            thread.made.iter().filter(|(of, _)| *of == who).any(|(_, rule)| {
                let read = story.cast.people.get(who).and_then(|person| person.rules.get(*rule));
                read.is_some_and(|read| read.rule.act == socrates_model::Action::Block && read.quote.contains(" let "))
            })
        };
        let lets: Vec<usize> = people.iter().copied().filter(|who| lets(*who)).collect();
        for who in lets {
            let around =
                deed::Around { trigger: Some(when.clone()), quote: quote.to_owned(), ..deed::Around::default() };
            let _rule = deed::apply(&mut story.cast, who, Act::GiveWay, &around);
        }
        for who in people {
            deed::walk_on(&mut story.cast, who, when.clone(), quote);
        }
        // Until it has passed takes as long as it takes.
        for (who, rule) in thread.made.iter().filter(|_| when == Trigger::RobotPassed) {
            let own = story.cast.people.get_mut(*who).and_then(|person| person.rules.get_mut(rule + 1));
            if let Some(read) = own.filter(|read| !read.lasts) {
                read.rule.for_s = Some(PASSES_S);
            }
        }
        thread.said = Some(when.clone());
        thread.ended = Some(when);
        return;
    }
    if until {
        let mut timed: Option<String> = None;
        for (who, rule) in &thread.made {
            if let Some(read) = story.cast.people.get_mut(*who).and_then(|p| p.rules.get_mut(*rule)) {
                read.rule.for_s = Some(UNTIL_S);
                timed.get_or_insert_with(|| read.quote.clone());
            }
        }
        // `notices nothing until it is 1 m away; he then freezes`, `stands still until it is 3 m away, then he walks off`
        if thread.made.is_empty() || found.distance_m.is_some() {
            thread.ended = trigger(cue, found, thread);
        }
        // `and only then gets out of its way`
        if thread.made.is_empty() {
            thread.said.clone_from(&thread.ended);
        }
        // Whoever stands there anyway, or does nothing of their own until then, does so as long as it takes.
        story.problems.extend(timed.map(|deed| {
            let why =
                format!("`{deed}`, until `{quote}`: it is played for {UNTIL_S} s, whether or not that comes before");
            Fault::new(FaultCode::PRead, "rough_scenario", why).about([quote])
        }));
        return;
    }
    // `if it moves they wait, if it stops they walk on`: what has its own time already is not timed by what comes after it.
    let timed = thread.made.iter().all(|(who, rule)| {
        let read = story.cast.people.get(*who).and_then(|person| person.rules.get(*rule));
        read.is_some_and(|read| {
            read.stated && matches!(read.rule.when[..], [Trigger::RobotMoving | Trigger::RobotStopped])
        })
    });
    // `When it says wait both stop, when it says proceed both go on.`
    let again = stretch.joint == Joint::When
        && next == Some(Joint::Comma)
        && !thread.made.is_empty()
        && already_timed(story, thread);
    let fronted = matches!(cue, Cue::Stopped | Cue::Moving) && timed || again;
    let back = matches!(stretch.joint, Joint::When | Joint::While | Joint::Until)
        && !thread.made.is_empty()
        && !stretch.after_and
        && !fronted
        // `then the nurse steps aside, while the doctor signals`: each does something of its own.
        && (stretch.joint != Joint::While || cue != Cue::Told || !already_timed(story, thread));
    // `stays when they see the robot` speaks of whom it spoke before, be it one or many.
    for mention in found
        .mentions
        .iter()
        .filter(|mention| cue != Cue::Told && !(back && matches!(mention.who, Who::All | Who::Same)))
    {
        let people = story.cast.resolve(mention, false, quote);
        story.cast.call(mention, stretch.words.get(mention.from..=mention.to).unwrap_or_default(), &people);
        // `the latter, once the former has …, clears the way`: the latter does.
        if !people.is_empty() && thread.pending.is_empty() {
            story.cast.last.clone_from(&people);
            thread.subject = Subject::People(people);
        }
    }
    // `when it is 80 cm behind her does she notice it`: what is noticed then is when it is there.
    let known = thread.waiting.is_some() && !thread.vague;
    if known && cue == Cue::Visible && !matches!(stretch.joint, Joint::When | Joint::While | Joint::Until) {
        return;
    }
    let Some(when) = trigger(cue, found, thread) else { return };
    if stretch.joint == Joint::When && order::passed(story, thread, &when, quote) {
        return;
    }
    if thread.made.is_empty() && !thread.went_on.is_empty() && !stretch.after_and {
        // `and goes on when it has stopped`
        for who in std::mem::take(&mut thread.went_on) {
            deed::walk_on(&mut story.cast, who, when.clone(), quote);
        }
        return;
    }
    // `does not step aside, only after it has asked`: then what was denied is done.
    if std::mem::take(&mut thread.only_then)
        && let Some(act) = thread.denied.filter(|act| deed::manner(*act).is_some())
    {
        let around = deed::Around { trigger: Some(when), quote: quote.to_owned(), ..deed::Around::default() };
        for who in std::mem::take(&mut thread.only) {
            if let Some(person) = story.cast.people.get_mut(who) {
                person.never.retain(|(never, _)| *never != act);
            }
            let _rule = deed::apply(&mut story.cast, who, act, &around);
        }
        return;
    }
    // `The first steps aside at 3 m, the second when it is 1 m away`
    if let (Subject::People(people), true) = (&thread.subject, bare && stretch.joint == Joint::When)
        && people.iter().all(|who| !thread.made.iter().any(|(of, _)| of == who))
        && next != Some(Joint::Comma)
        && !thread.acts.is_empty()
    {
        for (act, around) in thread.acts.clone() {
            let around = deed::Around { trigger: Some(when.clone()), quote: quote.to_owned(), vague: false, ..around };
            for who in people.clone() {
                if let Some(rule) = deed::apply(&mut story.cast, who, act, &around) {
                    thread.made.push((who, rule));
                }
            }
        }
        return;
    }
    // `runs away upon seeing it` looks back; `When the robot comes near, …` looks ahead.
    if back {
        // `the first when it is 4 m away, the second only at 1 m`
        let named = match &thread.subject {
            Subject::People(people) if named_again(thread, people) => people.clone(),
            Subject::People(_) | Subject::Robot | Subject::Nobody => Vec::new(),
        };
        let (now, later): (Vec<_>, Vec<_>) =
            std::mem::take(&mut thread.made).into_iter().partition(|(who, _)| named.is_empty() || named.contains(who));
        thread.made = later;
        for (who, rule) in now {
            if let Some(read) = story.cast.people.get_mut(who).and_then(|p| p.rules.get_mut(rule)) {
                // A run away must still be a meeting; without a distance in the text the usual one stays.
                let usual = read.rule.when.first().cloned();
                // `5 s after the start he looks at it as it comes through`: a time that was told stays.
                if read.stated
                    && matches!(usual, Some(Trigger::AfterSecs(_)))
                    && found.distance_m.is_none()
                    && cue == Cue::Near
                {
                    continue;
                }
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
        // Who comes out waits for the door anyway; whoever is met is there as the robot passes by.
        let met = cue == Cue::Near && quote.contains("pass");
        thread.untaken = Some(quote.to_owned()).filter(|quote| !quote.contains("open") && !met);
        thread.vague = found.distance_m.is_none();
    }
}

/// Whether the clause before only names some of those whose deeds were told.
fn named_again(thread: &Thread, people: &[usize]) -> bool {
    thread.renamed
        && people.iter().all(|who| thread.made.iter().any(|(of, _)| of == who))
        && thread.made.iter().any(|(who, _)| !people.contains(who))
}

/// Whether the text said before when the last deeds are done.
fn already_timed(story: &Story, thread: &Thread) -> bool {
    thread.made.iter().all(|(who, rule)| {
        story.cast.people.get(*who).and_then(|person| person.rules.get(*rule)).is_some_and(|read| read.stated)
    })
}

/// Whether the robot is named before anybody else.
fn robot_leads(found: &Found) -> bool {
    found.robots.first().is_some_and(|robot| found.mentions.iter().all(|mention| mention.from > *robot))
}

/// A clause without a deed: it names people, places, a group, a pace.
pub(crate) fn quiet(
    story: &mut Story,
    thread: &mut Thread,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    stretch: &Stretch,
    quote: &str,
    next: Option<Joint>,
) {
    // `The robot, in its friendly voice, asks her …`
    let robot = stretch.words.iter().any(|word| word.stem == "robot");
    if robot
        && stretch
            .words
            .iter()
            .all(|word| word.label || word.text == "the" || word.text == "this" || word.stem == "robot")
    {
        thread.subject = Subject::Robot;
        return;
    }
    let mut people: Vec<usize> = Vec::new();
    for (_, _, some) in meant {
        people.extend(some.iter().filter(|i| !people.contains(i)).copied().collect::<Vec<_>>());
    }
    if let Some(secs) = found.after_s.filter(|_| people.is_empty() && next.is_none() && !thread.made.is_empty()) {
        // `only the last one looks at it, namely after 8 seconds`
        for (who, rule) in &thread.made {
            let read = story.cast.people.get_mut(*who).and_then(|person| person.rules.get_mut(*rule));
            if let Some(read) = read.filter(|read| !read.stated) {
                (read.rule.when, read.stated, read.exact) = (vec![Trigger::AfterSecs(secs)], true, true);
            }
        }
        return;
    }
    if let Some(secs) = found.after_s {
        thread.waiting = Some(Trigger::AfterSecs(secs));
    } else if let Some(m) =
        found.distance_m.filter(|_| found.distance_is_when && people.is_empty() || robot_leads(found))
    {
        // `at 2 m`, `then it is 2 m in front of him`
        (thread.waiting, thread.vague) = (Some(Trigger::RobotNear(m)), false);
        if robot_leads(found) {
            return;
        }
    }
    if people.is_empty() && robot_leads(found) && found.mentions.is_empty() && stretch.joint != Joint::Who {
        thread.subject = Subject::Robot;
    }
    let behind = stretch.words.iter().position(|word| word.text == "behind");
    // `one behind it`, where the verb is left out
    let of_robot = behind.filter(|at| {
        stretch.words.iter().skip(at + 1).take(3).any(|word| word.stem == "robot")
            && found.mentions.first().is_some_and(|mention| mention.to < *at)
    });
    if of_robot.is_some() {
        for who in &people {
            relation::relate(&mut story.cast, *who, socrates_model::Relation::Behind, quote);
        }
    }
    if let Some(behind) = behind.filter(|behind| robot_leads(found) && found.robots.iter().all(|robot| robot < behind))
    {
        // `the robot is behind him`
        for who in meant.iter().filter(|(from, _, _)| *from > behind).flat_map(|(_, _, some)| some) {
            relation::relate(&mut story.cast, *who, socrates_model::Relation::Ahead, quote);
        }
    }
    if people.is_empty() {
        if !found.robots.is_empty() {
            // `who has never seen a robot` tells of whom the sentence tells.
            if stretch.joint != Joint::Who {
                thread.subject = Subject::Robot;
            }
        } else if let Subject::People(last) = &thread.subject
            && (found.in_group || found.pace_mps.is_some() || found.lasts_s.is_some())
        {
            people.clone_from(last);
        }
    }
    // `a second visitor, right behind the first, …`: only where the second is.
    let placed =
        found.mentions.first().and_then(|mention| mention.from.checked_sub(1)).and_then(|k| stretch.words.get(k));
    let placed =
        placed.is_some_and(|word| matches!(word.text.as_str(), "behind" | "beside" | "to" | "with" | "near" | "by"));
    if placed && !thread.pending.is_empty() && stretch.joint == Joint::Comma {
        thread.subject = Subject::People(std::mem::take(&mut thread.pending));
        return;
    }
    if !thread.pending.is_empty() && matches!(stretch.joint, Joint::And | Joint::Comma) {
        let mut all = std::mem::take(&mut thread.pending);
        // `two people: a guard …` speaks of one of the two.
        if !people.is_empty() && people.iter().all(|i| all.contains(i)) {
            all.clear();
        }
        all.extend(people.iter().filter(|i| !all.contains(i)).copied().collect::<Vec<_>>());
        story.cast.together(&all, quote);
        people = all;
    }
    if people.is_empty() {
        return;
    }
    thread.paused = true;
    thread.renamed = people.iter().all(|who| thread.made.iter().any(|(of, _)| of == who));
    // `the second only at 1 m`
    if let Some(m) = found.distance_m.filter(|_| found.distance_is_when && thread.renamed) {
        for (who, rule) in thread.made.iter().filter(|(who, _)| people.contains(who)) {
            let read = story.cast.people.get_mut(*who).and_then(|person| person.rules.get_mut(*rule));
            if let Some(read) = read {
                (read.rule.when, read.stated, read.exact) = (vec![Trigger::RobotNear(m)], true, true);
            }
        }
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
    // `on the left stands a doctor, on the right a nurse`: the nurse stands too.
    let sides =
        stretch.words.iter().any(|word| matches!(word.text.as_str(), "left" | "right" | "side" | "end" | "middle"));
    let verb =
        stretch.words.iter().any(|word| crate::lexicon::lexicon().verbs.contains(&word.stem) && word.stem != "left");
    if sides && !verb && thread.doer.is_some() && matches!(stretch.joint, Joint::And | Joint::Comma) {
        for (act, around) in thread.acts.clone() {
            for who in &people {
                let _rule = deed::apply(&mut story.cast, *who, act, &around);
            }
        }
    }
    // `a nurse and …`: only bare mentions wait for the deed of the next clause.
    let bare = stretch.words.iter().enumerate().all(|(i, word)| {
        meant.iter().any(|(from, to, _)| (*from..=*to).contains(&i))
            || word.label
            || matches!(
                word.text.as_str(),
                "both" | "either" | "only" | "just" | "exactly" | "simply" | "perhaps" | "maybe"
            )
    });
    thread.bare = bare;
    if bare && matches!(next, Some(Joint::And | Joint::Comma | Joint::When | Joint::While)) {
        thread.pending.clone_from(&people);
    }
    // `there should be a doctor and a nurse standing together`
    if !bare && next == Some(Joint::And) && meant.last().is_some_and(|(_, to, _)| to + 1 == stretch.words.len()) {
        thread.listed.clone_from(&people);
    }
    // `a nurse crosses it, then a visitor`: the visitor does too, and later.
    if bare && stretch.joint == Joint::Then && next.is_none() {
        for (act, around) in thread.acts.clone() {
            for who in &people {
                let _rule = deed::apply(&mut story.cast, *who, act, &around);
            }
            order::note(story, thread, stretch, (act, &people), None, quote);
        }
    }
    story.cast.last.clone_from(&people);
    // `The robot picks up a visitor, says "follow me" and …`: what comes then is the robot's.
    let robot = found.robots.first().copied();
    let does = robot.is_some_and(|robot| {
        robot <= 2
            && stretch.joint != Joint::Who
            && found.mentions.first().is_some_and(|mention| {
                stretch.words.get(robot + 1..mention.from).is_some_and(|words| {
                    words.iter().any(|word| {
                        let lex = crate::lexicon::lexicon();
                        word.stem != "be"
                            && word.stem != "have"
                            && (lex.verbs.contains(&word.stem)
                                || lex.impossible.contains(&word.stem)
                                || lex.task.contains(&word.stem))
                    })
                })
            })
    });
    thread.subject = if does { Subject::Robot } else { Subject::People(people) };
}
