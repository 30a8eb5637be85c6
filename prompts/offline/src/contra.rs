//! Wishes that exclude each other: the same place, count or moment told in two ways.
//!
//! What one clause says is held against what others said; both are quoted, and the request waits for a person.

use socrates_model::{Action, Fault, FaultCode, PlaceClass, Trigger, Where};

use crate::clause::{self, Found};
use crate::cut::{Joint, Stretch, sentences};
use crate::deed;
use crate::lexicon::{Act, lexicon};
use crate::mention::Who;
use crate::story::{Story, Subject, Thread};
use crate::timing::trigger;
use crate::whereabouts::before;

/// What was said so far that something else may exclude.
#[derive(Debug, Clone, Default)]
pub(crate) struct Held {
    /// Who stands in a place of which class, with the words.
    places: Vec<(usize, PlaceClass, String)>,
    /// Words that say that nobody is there.
    empty: Option<String>,
    /// Who does something in a condition of this sentence, with the words.
    condition: Option<(Vec<usize>, String)>,
}

impl Held {
    /// A new sentence begins.
    pub(crate) fn sentence(&mut self) {
        self.condition = None;
    }
}

fn contradiction(at: impl Into<Where>, first: &str, second: &str, why: &str) -> Fault {
    Fault::new(
        FaultCode::PContra,
        at,
        format!("`{}` and `{}` cannot both hold: {why}; correct one of the two", first.trim(), second.trim()),
    )
    .about([first.trim(), second.trim()])
}

/// Words by which something is so only for a while, or for others.
const PASSING: &[&str] = &[
    "then",
    "later",
    "afterwards",
    "now",
    "first",
    "next",
    "initially",
    "finally",
    "again",
    "soon",
    "before",
    "after",
    "yet",
    "else",
    "other",
    "but",
    "except",
    "start",
    "beginning",
    "still",
];

fn passing(quote: &str) -> bool {
    let lower = quote.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| PASSING.contains(&word))
}

/// `The two members` of a group of three.
pub(crate) fn members(story: &mut Story, found: &mut Found, stretch: &Stretch, text: &str) {
    let cast = &story.cast;
    let everybody = cast.people.len();
    if everybody == 0 {
        return;
    }
    for mention in &mut found.mentions {
        let Who::Definite { plural: true, count: Some(n) } = mention.who else { continue };
        let wanted = usize::try_from(n).unwrap_or(usize::MAX);
        let of_group = mention.role.as_deref() == Some("member");
        if of_group {
            mention.role = None;
        }
        // `the two on the left`, `the two who wait` are told apart by what comes next.
        let next = stretch.words.get(mention.to + 1);
        let acts = next.is_none_or(|word| lexicon().verbs.contains(&word.stem));
        if wanted < 2 || mention.role.is_some() || !mention.word.is_empty() || !acts {
            continue;
        }
        let rest = |set: &[usize]| set.iter().filter(|i| !cast.last.contains(i)).count();
        let all: Vec<usize> = (0..everybody).collect();
        let sets = cast.sets.iter().map(|set| &set.members).chain(cast.groups.iter().map(|(_, members, _)| members));
        let sets: Vec<&Vec<usize>> = sets.chain([&cast.last, &all]).collect();
        let open = cast.sets.iter().map(|set| cast.open(set).count());
        let fits =
            sets.iter().any(|set| set.len() == wanted || rest(set) == wanted) || open.into_iter().any(|n| n == wanted);
        let named = cast.sets.iter().rev().find(|set| set.members.len() > 1);
        let Some(set) = named.filter(|set| !fits && (of_group || set.members.len() == everybody)) else { continue };
        let said = stretch.words.get(mention.from).zip(stretch.words.get(mention.to));
        let said = said.and_then(|(from, to)| text.get(from.from..to.to)).unwrap_or_default();
        let why = format!("the one speaks of {} humans, the other of {n}", set.members.len());
        let fault = contradiction("rough_scenario", &set.quote, said, &why);
        story.problems.push(fault);
        return;
    }
}

/// `Three visitors … Nobody is there.`
pub(crate) fn emptied(story: &mut Story, found: &Found, next: Option<Joint>, quote: &str) {
    let nobody = found.mentions.iter().any(|mention| mention.who == Who::Nobody && mention.role.is_none());
    if !nobody || !found.declares || next == Some(Joint::Except) || story.cast.people.is_empty() {
        return;
    }
    let first = story.cast.count_quote.clone().unwrap_or_default();
    story.problems.push(
        Fault::new(
            FaultCode::PContra,
            "rough_scenario",
            format!(
                "`{first}` speaks of {}, but `{quote}` says that nobody is there; correct one of the two",
                story.cast.people.len()
            ),
        )
        .about([first.as_str(), quote]),
    );
}

/// `Nobody is there.`, before anybody is.
pub(crate) fn nobody(story: &mut Story, found: &Found, stretch: &Stretch, next: Option<Joint>, quote: &str) {
    let nobody = found.mentions.iter().any(|mention| mention.who == Who::Nobody);
    let alone = found.places.is_empty() && !found.acts() && next != Some(Joint::Except) && story.cast.people.is_empty();
    let there = stretch.words.iter().any(|word| matches!(word.text.as_str(), "there" | "present" | "around" | "here"));
    if nobody && alone && (found.declares || there) && !passing(quote) {
        story.held.empty = Some(quote.to_owned());
    }
}

/// Whether nobody is in both at once.
fn apart(a: PlaceClass, b: PlaceClass) -> bool {
    let ways = |class| matches!(class, PlaceClass::Corridor | PlaceClass::NarrowPassage | PlaceClass::Intersection);
    let beside = |class| {
        ways(class)
            || matches!(class, PlaceClass::OpenArea | PlaceClass::Room | PlaceClass::ElevatorLobby | PlaceClass::Exit)
    };
    let one = |a, b| a == PlaceClass::Elevator && beside(b) || a == PlaceClass::Room && ways(b);
    one(a, b) || one(b, a)
}

/// `The doctor is in the elevator. The doctor is in the corridor.`
pub(crate) fn place(
    story: &mut Story,
    thread: &Thread,
    stretch: &Stretch,
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    quote: &str,
) {
    let [(class, at)] = found.places.as_slice() else { return };
    let timed = found.after_s.is_some()
        || found.cue.is_some()
        || thread.waiting.is_some()
        || matches!(stretch.joint, Joint::When | Joint::While | Joint::Until | Joint::Then | Joint::Except);
    let stands = found.deeds.iter().all(|deed| matches!(deed.act, Act::Stand | Act::Stop | Act::Talk) && !deed.negated)
        && stretch
            .words
            .iter()
            .take(*at)
            .any(|word| matches!(word.stem.as_str(), "be" | "stand" | "wait" | "sit" | "talk"));
    // `in the office` may be all of the map.
    let whole = stretch.words.get(*at).is_some_and(|word| {
        matches!(word.stem.as_str(), "office" | "hospital" | "warehouse" | "building" | "department" | "floor")
    });
    if timed
        || !stands
        || whole
        || !found.robots.is_empty()
        || passing(quote)
        || !before(*at, stretch, &["in", "inside"])
    {
        return;
    }
    let named = meant.iter().find(|(from, _, some)| from < at && !some.is_empty()).map(|(_, _, some)| some.clone());
    let people = match (named, &thread.subject) {
        (Some(people), _) => people,
        (None, Subject::People(people)) if stretch.joint == Joint::Who => people.clone(),
        (None, Subject::People(_) | Subject::Robot | Subject::Nobody) => return,
    };
    for who in people {
        let moves = story.cast.people.get(who).is_none_or(|person| {
            let relation = person.relation.as_ref().map(|(relation, _)| *relation);
            relation.is_some_and(|relation| !relation.stands())
        });
        let known = story.held.places.iter().find(|(other, old, _)| *other == who && apart(*old, *class) && !moves);
        if let Some((_, _, first)) = known {
            let fault = contradiction(crate::order::agent(who), first, quote, "nobody is in both places at once");
            story.problems.push(fault);
            return;
        }
        story.held.places.push((who, *class, quote.to_owned()));
    }
}

/// `Only if the first has stopped does the second stop`: nobody waits for what another human does without a word.
pub(crate) fn condition(story: &mut Story, thread: &Thread, stretch: &Stretch, found: &Found, quote: &str) {
    let reacts = found.deeds.iter().any(|deed| deed::manner(deed.act).is_some() && !deed.negated);
    let (Some(doers), true) = (thread.doer.clone(), reacts && thread.subject != Subject::Robot) else { return };
    if stretch.joint == Joint::When && found.gesture.is_none() && !found.mentions.is_empty() {
        story.held.condition = Some((doers, quote.to_owned()));
        return;
    }
    let Some((first, when)) = story.held.condition.take() else { return };
    if stretch.joint == Joint::Who || doers.iter().any(|who| first.contains(who)) {
        return;
    }
    let message = format!(
        "`{when}` is what another human does, and `{quote}` should wait for it; people wait for the robot, for a time, or for a \
         gesture of another human: the two are played on their own"
    );
    story.problems.push(Fault::new(FaultCode::PRead, "rough_scenario", message).about([when.as_str(), quote]));
}

/// Two motions of which only one can be done.
fn exclusive(a: &Action, b: &Action) -> bool {
    let still = |act: &Action| matches!(act, Action::StandStill | Action::LookAtRobot);
    let goes = |act: &Action| matches!(act, Action::RunAway | Action::Approach | Action::FollowRobot | Action::Block);
    still(a) && goes(b) || still(b) && goes(a)
}

/// How many clauses say that something happens at this.
fn times_said(when: &Trigger, rough: &str) -> usize {
    let says = |mut stretch: Stretch| {
        let found = clause::read(&mut stretch);
        let cue = found.cue.and_then(|(cue, _)| trigger(cue, &found, &Thread::default()));
        let near = when.distance_m().is_some() && found.distance_m == when.distance_m();
        near || cue.as_ref() == Some(when)
    };
    sentences(rough).into_iter().flatten().filter(|stretch| says(stretch.clone())).count()
}

/// What shows only once all of it is read.
pub(crate) fn finish(story: &mut Story, rough: &str) {
    if let Some(empty) = story.held.empty.take()
        && !story.cast.people.is_empty()
    {
        let some = story.cast.people.iter().find_map(|person| {
            let related = person.relation.as_ref().map(|(_, quote)| quote.clone());
            related.or_else(|| person.rules.first().map(|read| read.quote.clone()))
        });
        let some = some.or_else(|| story.cast.count_quote.clone());
        let some = some.or_else(|| story.cast.sets.first().map(|set| set.quote.clone())).unwrap_or_default();
        let why = format!("{} humans are there, or nobody", story.cast.people.len());
        story.problems.push(contradiction("rough_scenario", &empty, &some, &why));
    }
    // `Exactly one person takes part. … two engineers …`
    let lower = rough.to_lowercase();
    let single = [
        "exactly one person",
        "exactly one human",
        "exactly one pedestrian",
        "exactly 1 human",
        "exactly 1 person",
        "one single person",
        "a single person",
        "only one person",
    ]
    .into_iter()
    .find(|words| lower.contains(words) && !lower.contains(&format!("not {words}")));
    if let (Some(single), 2..) = (single, story.cast.people.len()) {
        let quote =
            story.cast.sets.iter().rev().find(|set| set.members.len() > 1).map_or("the text", |set| set.quote.as_str());
        let why = format!("{} humans are there, or one", story.cast.people.len());
        story.problems.push(contradiction("rough_scenario", single, quote, &why));
    }
    for (who, person) in story.cast.people.iter().enumerate() {
        for (k, first) in person.rules.iter().enumerate() {
            let clash = person.rules.iter().skip(k + 1).find(|second| {
                first.stated
                    && second.stated
                    && first.rule.when == second.rule.when
                    && !second.then
                    && !first.lasts
                    && exclusive(&first.rule.act, &second.rule.act)
            });
            let Some(second) = clash else { continue };
            let Some(when) = first.rule.when.first() else { continue };
            // `stops and runs away when …` is one after the other; a moment that is told twice is the same moment.
            if times_said(when, rough) > 1 {
                let why = format!("both should be done {}", when.phrase());
                story.problems.push(contradiction(crate::order::agent(who), &first.quote, &second.quote, &why));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    fn faults(rough: &str, code: FaultCode) -> Vec<String> {
        let reading = crate::read(&request("Deliver a parcel", Some(rough)), &map("hospital"));
        reading.problems.into_iter().filter(|fault| fault.code == code).map(|fault| fault.message.to_string()).collect()
    }

    #[test]
    fn what_excludes_each_other_is_quoted_before_the_run() {
        for (rough, first, second) in [
            (
                "A nurse stops when the robot is 2 m away and runs away when the robot is 2 m away.",
                "stops",
                "runs away",
            ),
            ("A visitor freezes at 3 m. At 3 m the visitor runs away.", "freezes", "runs away"),
            ("A doctor is in the elevator. The doctor is in the corridor.", "in the elevator", "in the corridor"),
            ("A nurse stands in the corridor. The nurse is in the elevator.", "in the corridor", "in the elevator"),
            (
                "A group of three people stands in the corridor. The two members look at the robot.",
                "three",
                "The two members",
            ),
            ("Nobody is there. Two people talk.", "Nobody is there", "Two people talk"),
            ("There are no people. A nurse crosses.", "no people", "A nurse crosses"),
        ] {
            let found = faults(rough, FaultCode::PContra);
            assert_eq!(found.len(), 1, "{rough}: {found:?}");
            assert!(found[0].contains(first) && found[0].contains(second), "{rough}: {found:?}");
        }
    }

    #[test]
    fn what_comes_one_after_the_other_is_no_contradiction() {
        for rough in [
            "A nurse stops when the robot is 2 m away and then runs away.",
            "A nurse stops at 3 m and runs away when the robot is 1 m away.",
            "A doctor is in the elevator. The doctor gets out. Later the doctor is in the corridor.",
            "A doctor is in the elevator. A nurse is in the corridor.",
            "A group of three people stands in the corridor. The three members look at the robot.",
            "A group of three people stands in the corridor. One looks at the robot. The other two walk on.",
            "Five people come towards the robot: the two in front step aside.",
            "Nobody is in the corridor at first. Then two people come out of a room.",
            "Nobody reacts to the robot. Two people talk in the corridor.",
        ] {
            assert_eq!(faults(rough, FaultCode::PContra), Vec::<String>::new(), "{rough}");
        }
    }

    #[test]
    fn who_should_wait_for_another_humans_deed_is_named() {
        for rough in [
            "Two people come towards the robot. Only if the first has stopped does the second stop.",
            "Two people come towards the robot. When the first stops, the second runs away.",
        ] {
            let found = faults(rough, FaultCode::PRead);
            assert!(found.iter().any(|message| message.contains("is what another human does")), "{rough}: {found:?}");
        }
    }
}
