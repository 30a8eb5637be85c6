//! The rough scenario, clause by clause: subjects, triggers and deeds are bound to people.

use socrates_model::{Fault, FaultCode, Gesture, Payload, PlaceClass, Trigger};

use crate::addressee;
use crate::again;
use crate::around::{also_called, answers, done_by_robot, excepted, excepts, only_says, supposes};
use crate::bind::{people_deed, subject_of};
use crate::cast::Cast;
use crate::clause::{self, mark_each};
use crate::contra;
use crate::cut::{Joint, Stretch, sentences};
use crate::deed;
use crate::ellipsis;
use crate::facing;
use crate::lexicon::{Act, Cue, lexicon};
use crate::meant::meant;
use crate::mention::Who;
use crate::order::{self, Order};
use crate::relation;
use crate::robot_deed::robot_deed;
use crate::short;
use crate::sides;
pub(crate) use crate::thread::Thread;
use crate::timing::{quiet, robot_first, timing, trigger};
use crate::whereabouts::place_of;

/// Everything that was read of the rough scenario.
#[derive(Debug, Clone, Default)]
pub(crate) struct Story {
    pub(crate) cast: Cast,
    pub(crate) place: Option<(PlaceClass, String)>,
    /// A place in a heading, or in words about nobody: it counts where no other is named.
    pub(crate) weak_place: Option<(PlaceClass, String)>,
    pub(crate) robot_says: Vec<(Gesture, String)>,
    /// Card that the robot's own part asks for: it leads, follows or overtakes somebody.
    pub(crate) robot_part: Option<&'static str>,
    pub(crate) robot_enters: Option<(PlaceClass, String)>,
    pub(crate) robot_leaves: Option<(PlaceClass, String)>,
    /// Where people go: the robot goes there too if it leads them.
    pub(crate) headed: Option<(PlaceClass, String)>,
    /// Words of doors that somebody opens or closes.
    pub(crate) doors: Vec<String>,
    /// What the robot does on its way, as it would anyway: `drives past`, `comes to`.
    pub(crate) on_its_way: Vec<Act>,
    pub(crate) ignored: Vec<String>,
    /// Where the words stand that some rule read, in bytes of the text.
    pub(crate) used: Vec<std::ops::Range<usize>>,
    pub(crate) order: Order,
    pub(crate) held: contra::Held,
    pub(crate) problems: Vec<Fault>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) enum Subject {
    #[default]
    Nobody,
    Robot,
    People(Vec<usize>),
}

/// Reads the text.
pub(crate) fn read(text: &str) -> Story {
    read_on(Story::default(), sentences(text), text)
}

/// Reads sentences of a text about people of whom was spoken before.
pub(crate) fn read_on(mut story: Story, sentences: Vec<Vec<Stretch>>, text: &str) -> Story {
    let mut thread = Thread::default();
    let named = sentences
        .iter()
        .flatten()
        .flat_map(|stretch| stretch.also.iter().chain(&stretch.words))
        .filter(|word| word.name);
    for word in named {
        if !story.cast.names.contains(&word.stem) {
            story.cast.names.push(word.stem.clone());
        }
    }
    for mut sentence in sentences {
        (thread.waiting, thread.doer, thread.in_turn, thread.unless) = (None, None, false, None);
        story.cast.listing = false;
        story.cast.supposed = supposes(&sentence);
        story.cast.excepting = excepts(&sentence);
        thread.made.clear();
        thread.pending.clear();
        story.held.sentence();
        story.cast.sentence();
        let count = sentence.len();
        for i in 0..count {
            let next = sentence.get(i + 1).map(|next| next.joint);
            if let Some(stretch) = sentence.get_mut(i) {
                clause_of(&mut story, &mut thread, stretch, text, next);
            }
        }
        if story.cast.supposed {
            story.cast.forget_idle();
        }
        // A trigger without a deed is a wish that nothing was made of.
        if let Some(quote) = thread.untaken.take() {
            story.problems.push(Fault::new(
                FaultCode::PRead,
                "rough_scenario",
                format!("`{quote}` says when, but no reaction that was read waits for it; say who does what then (stop, look, follow, give way, gesture)"),
            ).about([quote.as_str()]).with(Payload::TriggerAlone));
        }
        again::leftover(&mut story, &sentence, text);
    }
    story
}

fn clause_of(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, text: &str, next: Option<Joint>) {
    let of_robot = ellipsis::of_robot(thread, stretch);
    thread.next = next;
    thread.bare_before = std::mem::take(&mut thread.bare);
    // Who somebody is, is no answer to what happens then; the clause after it may be.
    let suspended = (stretch.joint == Joint::Who).then(|| thread.waiting.take()).flatten();
    read_clause(story, thread, stretch, text, next);
    if thread.waiting.is_none() && suspended.is_some() {
        thread.waiting = suspended;
    }
    // `until an employee signals him to go ahead, who comes …`: who signals.
    if let (Some(Trigger::HumanSays(id, _)), Some(Joint::Who), Joint::When | Joint::Until | Joint::While) =
        (&thread.said, next, stretch.joint)
        && stretch.words.iter().any(|word| matches!(word.text.as_str(), "him" | "her" | "them"))
        && let Some(who) = usize::try_from(id.number()).ok().and_then(|n| n.checked_sub(1))
    {
        thread.subject = Subject::People(vec![who]);
    }
    if of_robot && next == Some(Joint::Comma) {
        thread.subject = Subject::Robot;
    }
}

fn read_clause(story: &mut Story, thread: &mut Thread, stretch: &mut Stretch, text: &str, next: Option<Joint>) {
    let quote = stretch.quote(text).to_owned();
    // `…, only after the robot has said EXCUSE_ME`: then it is done after all.
    if stretch.joint == Joint::Comma
        && matches!(stretch.words.as_slice(), [word] if matches!(word.text.as_str(), "only" | "just"))
        && next == Some(Joint::When)
    {
        thread.only_then = !thread.only.is_empty();
        return;
    }
    if order::in_turn(stretch) && stretch.words.len() <= 4 {
        return order::alone_in_turn(story, thread, stretch, &quote);
    }
    let mut found = clause::read(stretch);
    thread.joiner = order::joiner(text, stretch);
    if stretch.joint == Joint::When {
        order::condition(thread, &found);
    }
    for limited in std::mem::take(&mut found.limited) {
        if !story.cast.notes.contains(&limited) {
            story.cast.notes.push(limited);
        }
    }
    if let Some((from, to)) = found.moves_door {
        let words = stretch.words.get(from..=to).unwrap_or_default();
        story.doors.push(words.iter().map(|word| word.text.as_str()).collect::<Vec<_>>().join(" "));
    }
    let absurd = std::mem::take(&mut found.absurd).into_iter();
    story.problems.extend(absurd.map(|message| Fault::new(FaultCode::PLimit, "rough_scenario", message)));
    for i in &found.nowhere {
        let word = stretch.words.get(*i).map_or("", |word| word.text.as_str());
        story.problems.push(Fault::new(
            FaultCode::PPlace,
            "rough_scenario",
            format!("`{word}` in `{quote}` is a place that no location of this kind has"),
        ));
    }
    mark_each(stretch, &found.nowhere);
    if let Some(gesture) = found.only_says.filter(|_| thread.speaks) {
        return only_says(story, thread, stretch, gesture, &quote);
    }
    thread.speaks = found.gesture.is_some() || !found.acts() && !found.robots.is_empty() && found.mentions.is_empty();
    if stretch.joint == Joint::Said || ellipsis::consequence(thread, text, stretch, &found) {
        (thread.waiting, thread.vague) = (thread.said.clone(), false);
    } else if answers(&found, thread.fresh.as_ref())
        && thread.waiting.is_none()
        && (stretch.joint != Joint::Then || thread.fresh.is_some())
    {
        // `The robot says PROCEED. He walks on.`
        (thread.waiting, thread.vague) = (thread.fresh.take(), false);
    } else if found.gesture == Some(Gesture::Acknowledged)
        && found.deeds.is_empty()
        && found.robots.is_empty()
        && thread.waiting.is_none()
        && matches!(thread.fresh, Some(Trigger::RobotSays(_)))
    {
        // `The robot tells him to go first. He nods and goes.`
        (thread.waiting, thread.vague) = (thread.fresh.take(), false);
    } else if stretch.joint == Joint::Then
        && thread.waiting.is_none()
        && thread.ended.is_none()
        && matches!(thread.fresh, Some(Trigger::RobotSays(_)))
        && found.deeds.first().is_some_and(|deed| deed::manner(deed.act).is_some() && !deed.negated)
    {
        // `First the robot says excuse me; then she looks at it`
        (thread.waiting, thread.vague) = (thread.fresh.take(), false);
    } else if stretch.joint == Joint::Then && thread.waiting.is_none() && found.acts() {
        // `blocks its way until it asks; then he steps aside`
        (thread.waiting, thread.vague) = (thread.ended.take(), false);
    }
    if ellipsis::because_of_it(story, thread, stretch) {
        return;
    }
    // Who somebody is, is no answer.
    if found.acts() && stretch.joint != Joint::Who {
        thread.fresh = None;
    }
    // `when a picker crosses and the robot is in her way, …`
    let condition = std::mem::replace(&mut thread.condition, stretch.joint == Joint::When && found.acts());
    if condition && stretch.joint == Joint::And && found.deeds.is_empty() && robot_first(&found) {
        stretch.joint = Joint::When;
        let again = clause::read(stretch);
        if let Some((cue @ (Cue::Blocking | Cue::Near | Cue::Stopped), _)) = again.cue {
            (thread.waiting, thread.vague) = (trigger(cue, &again, thread), again.distance_m.is_none());
            return;
        }
        stretch.joint = Joint::And;
    }
    let cue_only = found.cue.is_some()
        && (found.deeds.is_empty() || matches!(stretch.joint, Joint::When | Joint::Until) && robot_first(&found));
    let temporal = matches!(stretch.joint, Joint::Until | Joint::When | Joint::While);
    if cue_only && (temporal || found.gesture.is_none()) {
        return timing(story, thread, stretch, &found, (&quote, next));
    }
    // `while it is cleaning` is the robot's errand.
    found.impossible.retain(|at| {
        let errand = stretch.words.get(*at).is_some_and(|word| lexicon().task.contains(&word.stem));
        let robot =
            found.robots.iter().any(|robot| robot < at) && found.mentions.iter().all(|mention| mention.from > *at);
        if errand
            && robot
            && let Some(word) = stretch.words.get_mut(*at)
        {
            word.used = true;
        }
        !(errand && robot)
    });
    if !found.impossible.is_empty() {
        let verbs: Vec<&str> =
            found.impossible.iter().filter_map(|i| stretch.words.get(*i)).map(|word| word.text.as_str()).collect();
        story.problems.push(Fault::new(
            FaultCode::PRead,
            "rough_scenario",
            format!("`{}` in `{quote}` cannot be simulated; people walk, stop, look, follow, flee, block, give way, approach and gesture", verbs.join("`, `")),
        ).about(verbs));
        mark_each(stretch, &found.impossible);
    }
    place_of(story, &found, stretch, &thread.subject, &quote);
    if stretch.joint == Joint::Except && excepted(story, thread, &found) {
        return;
    }
    // `two people: a nurse who …, and a visitor who …` lists those two.
    // `three of the five, namely two nurses and a visitor, …` lists those three.
    let namely = stretch.words.first().is_some_and(|word| matches!(word.text.as_str(), "namely" | "specifically"));
    if namely {
        let last = story.cast.last.clone();
        story.cast.together(&last, &quote);
    }
    if namely || stretch.words.first().is_some_and(|word| word.after_colon) {
        story.cast.lists();
    }
    contra::emptied(story, &found, next, &quote);
    if let Some(apart) = thread.apart.take().filter(|_| stretch.joint == Joint::Who)
        && let Some(who) = ellipsis::told_before(story, &found, apart)
    {
        story.cast.last = vec![who];
        thread.subject = Subject::People(vec![who]);
        if found.gesture.is_none() {
            return;
        }
        found.deeds.clear();
    }
    contra::nobody(story, &found, stretch, next, &quote);
    contra::members(story, &mut found, stretch, text);
    let meant = meant(story, thread, stretch, &found, text, next);
    sides::note(story, &thread.subject, stretch, &found, &meant, &quote);
    facing::note(story, &thread.subject, stretch, &meant, &quote);
    contra::place(story, thread, stretch, &found, &meant, &quote);
    let one = found.mentions.iter().any(|mention| mention.who == Who::ToldApart && !found.acts());
    thread.apart = match meant.as_slice() {
        [(_, _, people)] if one && next == Some(Joint::Who) => people.first().copied(),
        _ => None,
    };
    if !stretch.also.is_empty() {
        also_called(story, &meant, stretch);
    }
    if again::note(story, thread, stretch, &found, &meant, &quote) {
        return;
    }
    if let Some(does) = ellipsis::elided(stretch, &found) {
        return ellipsis::repeat(story, thread, &meant, (does, next == Some(Joint::When)), stretch, &quote);
    }
    if found.obeys && !found.acts() && ellipsis::obeys(story, thread, &found, &meant, &quote) {
        return;
    }
    if !found.acts() {
        short::keeps(story, stretch, &found, &quote);
        return quiet(story, thread, &found, &meant, stretch, &quote, next);
    }
    let said = matches!(thread.waiting, Some(Trigger::RobotSays(_) | Trigger::HumanSays(..)));
    let reacts = found.deeds.iter().any(|deed| deed::manner(deed.act).is_some());
    // `she does not react; after six seconds she steps aside anyway`: not because it asked.
    thread.delay_s = found.after_s.filter(|_| said && reacts && !thread.paused && thread.acts.is_empty());
    thread.paused = false;
    if let Some(secs) = found.after_s {
        // `The robot asks, and after a few seconds he steps aside`: so long after that, not after the start.
        if thread.delay_s.is_none() {
            thread.waiting = Some(Trigger::AfterSecs(secs));
        }
    } else if let Some((cue, _)) = found.cue {
        thread.waiting = trigger(cue, &found, thread);
        thread.vague = found.distance_m.is_none();
    } else if found.distance_is_when
        && let (Some(waiting), Some(m)) = (&thread.waiting, found.distance_m)
    {
        // `When it sees the robot …, and at 1.5 m it stops`: the nearer distance is that of this deed.
        thread.waiting = Some(waiting.clone().at_distance(m));
        thread.vague = false;
    }
    let previous = thread.subject.clone();
    let mut joined = std::mem::take(&mut thread.pending);
    // `Inside are a doctor and a patient: the doctor leaves`
    if stretch.words.first().is_some_and(|word| word.after_colon) {
        joined.clear();
    }
    let listed = std::mem::take(&mut thread.listed);
    // `a doctor and a nurse who come round the corner`: both do.
    let both = stretch.joint == Joint::Who
        && !listed.is_empty()
        && found.mentions.is_empty()
        && stretch
            .words
            .first()
            .is_some_and(|word| word.text == word.stem && lexicon().verbs.contains(&word.stem) || word.text == "are");
    let previous = if let Subject::People(people) = &previous
        && both
        && people.iter().all(|i| !listed.contains(i))
    {
        let all: Vec<usize> = listed.iter().chain(people).copied().collect();
        story.cast.together(&all, &quote);
        Subject::People(all)
    } else {
        previous
    };
    // `… standing together`, `have an operator and a trainee stroll`
    let shared = |to: usize| {
        stretch.words.get(to + 1).is_some_and(|word| {
            word.text.ends_with("ing")
                || word.text == word.stem && lexicon().verbs.contains(&word.stem) && word.stem != "be"
        }) || (to + 1..to + 6).any(|k| {
            // `I'd like a porter and a patient from ward 6 to come out`
            stretch.words.get(k).is_some_and(|word| word.text == "to")
                && stretch.words.get(k + 1).is_some_and(|word| lexicon().verbs.contains(&word.stem))
        })
    };
    if joined.is_empty()
        && stretch.joint == Joint::And
        && found.mentions.first().is_some_and(|first| first.from == 0 && shared(first.to))
    {
        joined = listed;
    }
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
    // Whom the robot spoke to in this clause: `who is told to follow it by the robot walks after it`.
    let mut told: Vec<usize> = Vec::new();
    for (act, at, to, negated) in acts {
        // `is overtaken by a visitor`, `is overtaken in the corridor by a visitor`
        let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
        let being = at.checked_sub(1).is_some_and(|k| stretch.words.get(k).is_some_and(|word| word.stem == "be"));
        let by = (to + 1..to + if being { 7 } else { 2 }).find(|k| text(*k) == "by");
        let passive = by.is_some_and(|by| meant.iter().any(|(from, _, _)| *from > by));
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
        // `who finds the machine fascinating keeps following it`
        let relative = stretch.joint == Joint::Who
            && found.mentions.is_empty()
            && found.robots.first().is_some_and(|robot| *robot > 1 && *robot < at)
            && found.deeds.first().is_some_and(|deed| deed.at == at);
        let subject = if by_robot {
            Subject::Robot
        } else if relative && matches!(previous, Subject::People(_)) {
            previous.clone()
        } else {
            subject_of((act, at, to), passive, &found, &meant, &previous, &joined, &story.cast)
        };
        // `An employee walks along. The robot comes from behind and wants to overtake.`: him.
        let object = if matches!(act, Act::Behind | Act::Overtake) && subject == Subject::Robot && object.is_empty() {
            story.cast.overtaken()
        } else {
            object
        };
        let answers = !told.is_empty() && !by_robot && subject == Subject::Robot;
        let subject = if answers { Subject::People(told.clone()) } else { subject };
        if by_robot && act == Act::Gesture {
            told.clone_from(&object);
        }
        // Whoever is led goes where the one who leads goes.
        let subject = match (subject, &thread.led) {
            (Subject::People(people), Some((leaders, followers))) if people == *followers => {
                Subject::People(leaders.clone())
            }
            (subject, _) => subject,
        };
        let sayer = |said: Option<&Trigger>, people: &[usize]| {
            matches!((said, people), (Some(Trigger::HumanSays(id, _)), [only])
                if usize::try_from(id.number()) == Ok(only + 1))
        };
        // `waves his colleague through, and at that he walks on`: whoever was waved at.
        let own = |people: &[usize]| {
            sayer(thread.waiting.as_ref(), people) && act != Act::Gesture && stretch.joint == Joint::Said
        };
        // `tells him to make room, and then he gets out of its way`: whoever was told to.
        let told_to = |people: &[usize]| {
            sayer(thread.said.as_ref(), people)
                && ellipsis::responds(thread.said.as_ref(), act)
                && matches!(stretch.joint, Joint::Then | Joint::And | Joint::Comma | Joint::Opens)
                && found.mentions.first().is_some_and(|mention| mention.who == Who::Same)
        };
        let subject = match subject {
            Subject::People(people) if (own(&people) || told_to(&people)) && !thread.addressed.is_empty() => {
                Subject::People(thread.addressed.clone())
            }
            Subject::People(_) | Subject::Robot | Subject::Nobody => subject,
        };
        if act == Act::Gesture {
            thread.addressed =
                meant.iter().filter(|(from, _, _)| *from > at).flat_map(|(_, _, some)| some.clone()).collect();
        }
        let quote = quote.as_str();
        thread.untaken = None;
        match &subject {
            Subject::Robot => {
                // `robot stops, worker stops`
                if thread.waiting.is_none() && next == Some(Joint::Comma) && act == Act::Stop && !negated {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotStopped), false);
                }
                // `robot starts moving, the cleaner runs away`; `The robot stops. Then, and only then, she walks on.`
                let starts = matches!(act, Act::GoOn | Act::Walk)
                    && text(at) != "goes"
                    && stretch.words.iter().any(|word| word.stem == "start");
                if thread.waiting.is_none() && next == Some(Joint::Comma) && starts && !negated {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotMoving), false);
                }
                if act == Act::Stop && !negated && thread.waiting.is_none() {
                    thread.ended = Some(Trigger::RobotStopped);
                }
                // `a nurse with a trolley and the robot meet head-on`
                if act == Act::Toward
                    && stretch.joint == Joint::And
                    && let Subject::People(people) = &previous
                {
                    for who in people {
                        relation::relate(&mut story.cast, *who, socrates_model::Relation::Frontal, quote);
                    }
                }
                // `goes down the aisle behind a picker`
                let behind = meant.iter().find(|(from, _, some)| {
                    *from > to
                        && !some.is_empty()
                        && (1..=3).filter_map(|back| from.checked_sub(back)).any(|k| text(k) == "behind")
                });
                if let (Some((_, _, some)), Act::Walk | Act::GoOn | Act::Follow) = (behind, act) {
                    for who in some {
                        relation::relate(&mut story.cast, *who, socrates_model::Relation::Ahead, quote);
                    }
                }
                robot_deed(story, act, &found, &object, quote);
                // `The robot asks to be let through and the first one gives way`: what comes next answers it.
                if let Some(gesture) = found
                    .gesture
                    .filter(|_| act == Act::Gesture && matches!(thread.waiting, None | Some(Trigger::RobotSays(_))))
                {
                    (thread.waiting, thread.vague) = (Some(Trigger::RobotSays(gesture)), false);
                }
                if let Some(gesture) = found.gesture.filter(|_| act == Act::Gesture) {
                    thread.said = Some(Trigger::RobotSays(gesture));
                    thread.fresh.clone_from(&thread.said);
                }
            }
            // `does not move aside until the robot asks`: it does then.
            Subject::People(people)
                if negated
                    && next == Some(Joint::Until)
                    && (deed::manner(act).is_some() || matches!(act, Act::GoOn | Act::Walk | Act::Pass)) =>
            {
                let act = if deed::manner(act).is_some() { act } else { Act::GoOn };
                people_deed(story, thread, (act, at, to), people, &found, &meant, stretch, quote);
                thread.not_until = true;
            }
            // `Unless the robot says excuse me, the picker won't make room.`
            Subject::People(people) if negated && thread.unless.is_some() && deed::manner(act).is_some() => {
                (thread.waiting, thread.vague) = (thread.unless.clone(), false);
                people_deed(story, thread, (act, at, to), people, &found, &meant, stretch, quote);
            }
            Subject::People(people) if negated => {
                for who in people {
                    deed::rule_out(&mut story.cast, *who, act, quote);
                }
                thread.denied = Some(act);
                thread.only.clone_from(people);
                let people: Vec<String> = people.iter().map(|i| format!("human_{}", i + 1)).collect();
                story
                    .cast
                    .notes
                    .push(format!("`{quote}` rules something out for {}; no reaction is added", people.join(" and ")));
            }
            Subject::People(people) => {
                // `he walks off, followed by a trainee`
                let mut around = meant.clone();
                if let (true, Act::Follow, Subject::People(led)) = (passive && found.robots.is_empty(), act, &previous)
                {
                    around.push((stretch.words.len(), stretch.words.len(), led.clone()));
                }
                people_deed(story, thread, (act, at, to), people, &found, &around, stretch, quote);
                if act == Act::Gesture && !passive && !found.robots.iter().any(|robot| *robot > at) {
                    addressee::settle(&mut story.cast, people, &object);
                }
            }
            Subject::Nobody if found.mentions.iter().any(|mention| mention.who == Who::Nobody) => {
                for who in 0..story.cast.people.len() {
                    deed::rule_out(&mut story.cast, who, act, quote);
                }
                story.cast.notes.push(format!("`{quote}` rules something out for everybody; no reaction is added"));
            }
            Subject::Nobody => {
                let message = format!("`{quote}` does not say who does it");
                story.problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([quote]));
            }
        }
        if by_robot && act == Act::Gesture && !object.is_empty() {
            thread.subject = Subject::People(object);
        } else if subject != Subject::Nobody
            && !(by_robot && matches!(previous, Subject::People(_)))
            // `comes out of the room the robot is going into and gives way`
            && !(subject == Subject::Robot
                && act == Act::Enter
                && found.deeds.first().is_some_and(|first| first.act == Act::ComeOut && first.at < at)
                && !found.mentions.is_empty())
            // `The robot, finding its way obstructed by a visitor, asks …`
            && !(passive && previous == Subject::Robot && stretch.words.first().is_some_and(|word| word.text == "finding"))
        {
            thread.subject = subject;
        }
    }
    if matches!(thread.subject, Subject::People(_)) {
        short::note(story, stretch, &found, &meant, (&quote, thread.waiting.is_some()));
    }
    contra::condition(story, thread, stretch, &found, &quote);
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
