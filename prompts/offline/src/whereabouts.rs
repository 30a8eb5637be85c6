//! Where things happen, where the robot comes from and where it goes.

use socrates_model::{PlaceClass, Relation};

use crate::clause::Found;
use crate::cut::{Joint, Stretch};
use crate::lexicon::{Act, lexicon};
use crate::mention::Who;
use crate::story::{Story, Subject};
use crate::words::Word;

/// Words before a place that make it the end of a way, its beginning, or what somebody stands beside.
const TO: &[&str] = &["to", "towards", "toward", "for", "into", "reach", "reaches", "is", "be"];
const FROM: &[&str] = &["from", "leaves", "leave", "leaving", "of"];
const IN: &[&str] = &["in", "inside", "at", "from", "outside"];
const BESIDE: &[&str] = &["at", "by", "near", "outside", "beside", "before", "front", "for", "facing"];

/// What a place has to do with the clause that names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// It happens there.
    There,
    /// The robot goes there.
    Goal,
    /// The robot comes from there.
    Start,
    /// It only tells who somebody is: `a nurse from ward 4`.
    Origin,
    /// The robot passes it on its way: `via the pharmacy`.
    Via,
}

/// Takes the places of a clause.
pub(crate) fn place_of(story: &mut Story, found: &Found, stretch: &Stretch, subject: &Subject, quote: &str) {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let comes_out =
        found.deeds.iter().find(|deed| matches!(deed.act, Act::ComeOut | Act::Enter | Act::Stay)).map(|deed| deed.at);
    // Where the robot leads somebody to is where it goes.
    let leads = found.deeds.iter().find(|deed| {
        let robot = found.robots.iter().any(|robot| *robot < deed.at)
            && found.mentions.iter().all(|mention| mention.from > deed.at);
        deed.act == Act::Lead && robot
    });
    let leads = leads.map(|deed| deed.at);
    referred(story, found, stretch, quote);
    for (class, at) in &found.places {
        let class = beside_elevator(story, *class, *at, found, stretch);
        if leads.is_some_and(|deed| *at > deed) {
            story.robot_enters = Some((class, quote.to_owned()));
            continue;
        }
        // A way leads through corridors and crossings; it ends in rooms.
        let transit = matches!(
            class,
            PlaceClass::Corridor
                | PlaceClass::Intersection
                | PlaceClass::Doorway
                | PlaceClass::BlindCorner
                | PlaceClass::NarrowPassage
        );
        let named = stretch.words.iter().any(|word| matches!(word.stem.as_str(), "goal" | "destination" | "target"));
        // `from the corridor to a room`
        let both = found.places.len() >= 2
            && before(*at, stretch, &["from"])
            && found.places.iter().any(|(_, other)| other > at && before(*other, stretch, &["to", "into"]));
        match part(*at, found, stretch, subject) {
            Part::Goal | Part::Start if transit && !named && !both => {}
            Part::Via if transit => {}
            Part::Goal => {
                // Who gets into an elevator meets people there.
                if class == PlaceClass::Elevator {
                    story.weak_place.get_or_insert_with(|| (class, quote.to_owned()));
                }
                story.robot_enters = Some((class, quote.to_owned()));
                continue;
            }
            Part::Start => {
                story.robot_leaves = Some((class, quote.to_owned()));
                continue;
            }
            Part::Origin => continue,
            Part::Via => {
                story.weak_place.get_or_insert_with(|| (class, quote.to_owned()));
                continue;
            }
            Part::There => {}
        }
        // `Not in the corridor this time, use the blind corner.`
        if text(0) == "not" && *at <= 3 && found.mentions.is_empty() {
            continue;
        }
        let heading = stretch.words.get(*at).is_some_and(|word| word.label);
        let idle = found.mentions.is_empty() && !found.acts() && class == PlaceClass::Room;
        if heading || idle {
            story.weak_place.get_or_insert_with(|| (class, quote.to_owned()));
            continue;
        }
        let enters = found.deeds.iter().all(|deed| deed.act != Act::ComeOut && deed.act != Act::Stay);
        // The room that people come out of is where they start, not where they are met.
        let source = comes_out.is_some_and(|deed| *at > deed)
            && matches!(class, PlaceClass::Room | PlaceClass::Doorway | PlaceClass::Exit)
            && !(enters && class == PlaceClass::Doorway);
        let weak =
            story.place.as_ref().is_none_or(|(old, _)| class == PlaceClass::Elevator && *old != PlaceClass::Elevator);
        let in_lobby = class == PlaceClass::ElevatorLobby && text(*at) == "lobby";
        // `come out of a room and walk to the loading dock`: where people go is not where they are met.
        let headed = before(*at, stretch, &["to", "into", "for"])
            && matches!(class, PlaceClass::Exit | PlaceClass::Room | PlaceClass::OpenArea)
            && found.mentions.iter().all(|mention| mention.to < *at)
            && found.robots.is_empty()
            && (found.deeds.iter().any(|deed| matches!(deed.act, Act::Walk | Act::GoOn) && deed.at < *at)
                // `until he turns into the ward`
                || before(*at, stretch, &["into"]) && found.deeds.is_empty() && !found.mentions.is_empty());
        // `walks from the kitchen to the reception`: neither is where he is met.
        let walks = found.mentions.first().is_some_and(|mention| mention.to < *at)
            && found.robots.is_empty()
            && comes_out.is_none()
            && !transit;
        let trip = walks
            && matches!(found.places.as_slice(), [(_, from), (_, to)]
            if before(*from, stretch, &["from"]) && before(*to, stretch, &["to", "into"]));
        if trip && before(*at, stretch, &["from"]) {
            let why =
                format!("people are met on their way; that they start at {} is not demanded", crate::place::an(class));
            story.cast.leave_out(quote, &why);
            continue;
        }
        let headed = headed || trip;
        if headed && story.robot_part != Some("leading") {
            let why = format!(
                "people are met on their way and walk on; that they end at {} is not demanded",
                crate::place::an(class)
            );
            story.cast.leave_out(quote, &why);
        }
        if !headed && !source && (weak || in_lobby) {
            story.place = Some((class, quote.to_owned()));
        }
        // Where people go in words of their own is where a robot that leads them goes.
        if before(*at, stretch, TO) && found.mentions.first().is_some_and(|mention| mention.from < *at) {
            story.headed = Some((class, quote.to_owned()));
        }
    }
}

/// `in the lobby, where it starts`, `drives from there to the dock`, `a guard is posted there`: places that were named before.
fn referred(story: &mut Story, found: &Found, stretch: &Stretch, quote: &str) {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let robot = stretch.words.iter().position(|word| word.stem == "robot");
    let starts = |k: usize| {
        stretch.words.get(k).is_some_and(|word| matches!(word.stem.as_str(), "start" | "begin" | "leave" | "depart"))
    };
    // `…, which is also the robot's goal`
    let goal = stretch.words.iter().any(|word| matches!(word.stem.as_str(), "goal" | "destination"))
        && robot.is_some()
        && found.places.is_empty()
        && found.mentions.is_empty()
        && !stretch.words.iter().any(|word| word.stem == "reach");
    if goal && story.robot_enters.is_none() {
        story.robot_enters = story.headed.clone().or_else(|| story.place.clone());
        return;
    }
    let there = (0..stretch.words.len()).find(|k| {
        text(*k) == "there" && (*k > 0 || !matches!(text(k + 1), "is" | "are" | "will" | "should" | "must" | ""))
    });
    let from_there = there.is_some_and(|k| k > 0 && text(k - 1) == "from");
    let begins = robot.is_some_and(|robot| robot <= 2 && text(0) == "where" && starts(robot + 1));
    if robot.is_some() && story.robot_leaves.is_none() && (begins || from_there) {
        let last = story.place.clone().or_else(|| story.weak_place.clone());
        if from_there {
            story.place = None;
        }
        story.robot_leaves = last;
        return;
    }
    let stands = found.deeds.iter().any(|deed| matches!(deed.act, Act::Stand | Act::Stop | Act::Block | Act::Talk));
    let at_goal = found.places.is_empty() && !found.mentions.is_empty() && story.place.is_none();
    let where_it_goes = (there.is_some_and(|k| (k == 0 || k + 1 == stretch.words.len()) && !from_there)
        || text(0) == "where")
        && stands;
    if at_goal
        && where_it_goes
        && let Some((class, _)) = &story.robot_enters
    {
        story.weak_place.get_or_insert_with(|| (*class, quote.to_owned()));
    }
}

/// `in the elevator`, and not in the lobby before it.
pub(crate) fn in_car(quote: &str) -> bool {
    let quote = quote.to_lowercase();
    ["elevator", "lift"].iter().any(|car| {
        quote.match_indices(car).any(|(at, _)| {
            let (before, after) =
                (quote.get(..at).unwrap_or_default(), quote.get(at + car.len()..).unwrap_or_default());
            let inside = ["in the ", "inside the ", "in an ", "in a ", "in ", "inside "];
            let besides = [" lobby", " hall", " area", " door"];
            inside.iter().any(|words| before.ends_with(words)) && !besides.iter().any(|words| after.starts_with(words))
        })
    })
}

/// Whether one of these words stands before a place, with at most two words between.
pub(crate) fn before(at: usize, stretch: &Stretch, words: &[&str]) -> bool {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let between = |k: usize| {
        !matches!(
            text(k),
            "the" | "a" | "an" | "its" | "their" | "his" | "her" | "of" | "this" | "nearest" | "main" | "next" | "same"
        )
    };
    // `the mail room`, `the linen store`
    let describes = |k: usize| {
        let lex = lexicon();
        let article = k.checked_sub(1).is_some_and(|k| matches!(text(k), "the" | "a" | "an" | "its"));
        let plain = |word: &Word| {
            !word.used
                && !lex.verbs.contains(&word.stem)
                && !lex.stop.contains(&word.text)
                && (lex.things.contains(&word.stem) || lex.task.contains(&word.stem) || !lex.known.contains(&word.stem))
        };
        k + 1 == at && article && stretch.words.get(k).is_some_and(plain)
    };
    // The first word before the place that is no article.
    let near = (1..=4).filter_map(|back| at.checked_sub(back)).find(|k| between(*k) && !describes(*k));
    near.is_some_and(|k| words.contains(&text(k)))
        || at.checked_sub(1).is_some_and(|k| words.contains(&"of") && text(k) == "of" && k > 0 && text(k - 1) == "out")
}

/// Words before a place that the robot's way leads past.
const VIA: &[&str] = &["via", "past"];

/// `Meds run from the pharmacy to the ward`, `Task: lobby to pharmacy via the waiting area`: a way that nobody walks is the robot's.
fn errand(at: usize, found: &Found, stretch: &Stretch, subject: &Subject) -> Option<Part> {
    let own = stretch.joint == Joint::Opens || !matches!(subject, Subject::People(_));
    if !own || !found.mentions.is_empty() || found.places.len() < 2 {
        return None;
    }
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let filler = |k: usize| {
        stretch
            .words
            .get(k)
            .is_some_and(|word| word.label || matches!(word.text.as_str(), "the" | "a" | "an" | "route" | "task"))
    };
    let goal = found.places.iter().map(|(_, at)| *at).find(|at| before(*at, stretch, &["to", "into"]))?;
    let start = found
        .places
        .iter()
        .map(|(_, at)| *at)
        .find(|at| *at < goal && (before(*at, stretch, &["from"]) || (0..*at).all(filler)))?;
    if at == start {
        Some(Part::Start)
    } else if at == goal {
        Some(Part::Goal)
    } else if before(at, stretch, VIA) || text(at.wrapping_sub(2)) == "way" && text(at.wrapping_sub(1)) == "of" {
        Some(Part::Via)
    } else {
        None
    }
}

fn part(at: usize, found: &Found, stretch: &Stretch, subject: &Subject) -> Part {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    let people = found.mentions.iter().any(|mention| mention.from < at && !matches!(mention.who, Who::Nobody));
    let robot = stretch.words.iter().take(at).any(|word| word.stem == "robot");
    // `the goal of the robot is the elevator`, `with the elevator as its goal`
    let goal = stretch.words.iter().position(|word| matches!(word.stem.as_str(), "goal" | "destination" | "target"));
    if goal.is_some()
        && !people
        && !stretch.words.iter().any(|word| matches!(word.text.as_str(), "reaches" | "reached"))
    {
        return Part::Goal;
    }
    // `a nurse from ward 4`, `somebody from the lab`
    let of_whom =
        found.mentions.iter().any(|mention| text(mention.to + 1) == "from" && at > mention.to && at <= mention.to + 3);
    if of_whom {
        return Part::Origin;
    }
    let moves = |k: usize| {
        matches!(
            stem(k),
            "go" | "drive"
                | "travel"
                | "move"
                | "head"
                | "navigate"
                | "bring"
                | "carry"
                | "deliver"
                | "take"
                | "transport"
                | "return"
                | "roll"
                | "fetch"
                | "way"
                | "depart"
                | "leave"
                | "start"
                | "come"
                | "set"
                | "run"
                | "proceed"
                | "begin"
                | "get"
                | "send"
                | "dispatch"
                | "want"
                | "route"
        )
    };
    // `Starting in a room, the robot heads for the exit.`
    let opens = matches!(text(0), "starting" | "start" | "starts") && !robot && found.mentions.is_empty();
    let robot = robot || opens;
    let own = !people && (robot || *subject == Subject::Robot && found.mentions.is_empty()) && (0..at).any(moves);
    // Who follows the robot to a place goes where it goes.
    let along = (people || matches!(subject, Subject::People(_)))
        && robot
        && found.deeds.iter().any(|deed| matches!(deed.act, Act::Follow | Act::Abreast | Act::Behind) && deed.at < at);
    // `starts in a room`
    let starts = (0..at).rev().find(|k| moves(*k)).is_some_and(|k| matches!(stem(k), "start" | "begin" | "set"));
    // `she follows it, all the way to the ward`
    let all_the_way = text(0) == "all" && text(1) == "the" && text(2) == "way" && before(at, stretch, TO);
    if all_the_way {
        return Part::Goal;
    }
    if let Some(part) = errand(at, found, stretch, subject) {
        return part;
    }
    if (own || robot && !people) && before(at, stretch, VIA) {
        return Part::Via;
    }
    // `to take him to the meeting room`: where the robot takes somebody is where it goes.
    let takes = |k: usize| matches!(stem(k), "take" | "bring" | "lead" | "guide" | "escort" | "show" | "accompany");
    let whose = robot || *subject == Subject::Robot;
    let led = whose
        && (before(at, stretch, TO) || before(at, stretch, FROM))
        && (0..at).rev().find(|k| takes(*k)).is_some_and(|verb| {
            (stretch.words.iter().take(verb).any(|word| word.stem == "robot") || *subject == Subject::Robot)
                && found.mentions.iter().all(|mention| mention.from > verb)
        });
    if led {
        return if before(at, stretch, FROM) { Part::Start } else { Part::Goal };
    }
    // `has to get past them to reach reception`
    let first = found.robots.first().is_some_and(|robot| found.mentions.iter().all(|mention| mention.from > *robot));
    // `drives past them to the exit`
    let past = found.gesture.is_none()
        && before(at, stretch, TO)
        && found.robots.first().is_some_and(|robot| {
            stretch.words.get(robot + 1).is_some_and(|word| {
                matches!(word.stem.as_str(), "drive" | "go" | "travel" | "navigate" | "move" | "roll" | "head")
            })
        })
        && found.deeds.iter().all(|deed| matches!(deed.act, Act::Pass | Act::Walk | Act::Overtake | Act::GoOn));
    if first && (past || before(at, stretch, &["reach", "reaches"])) {
        return Part::Goal;
    }
    if own && starts && before(at, stretch, IN) {
        Part::Start
    } else if (own || along) && before(at, stretch, TO) {
        Part::Goal
    } else if (own || along) && before(at, stretch, FROM) {
        Part::Start
    } else {
        Part::There
    }
}

/// Who waits at the elevator is in its lobby; a lobby of an elevator is one too.
fn beside_elevator(story: &Story, class: PlaceClass, at: usize, found: &Found, stretch: &Stretch) -> PlaceClass {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let moves = found.deeds.iter().any(|deed| matches!(deed.act, Act::ComeOut | Act::Enter));
    let stands = found.deeds.iter().any(|deed| matches!(deed.act, Act::Stop | Act::Stand | Act::Talk));
    match class {
        // `heads for the elevator` is no waiting for it.
        PlaceClass::Elevator
            if (stands || !moves)
                && before(at, stretch, BESIDE)
                && !(0..at)
                    .any(|k| text(k + 1) == "for" && stretch.words.get(k).is_some_and(|word| word.stem == "head")) =>
        {
            PlaceClass::ElevatorLobby
        }
        PlaceClass::Elevator if (0..at).any(|k| text(k) == "lobby") => PlaceClass::ElevatorLobby,
        PlaceClass::OpenArea
            if text(at) == "lobby"
                && [&story.weak_place, &story.robot_enters, &story.robot_leaves]
                    .into_iter()
                    .any(|place| place.as_ref().is_some_and(|(class, _)| *class == PlaceClass::ElevatorLobby)) =>
        {
            PlaceClass::ElevatorLobby
        }
        PlaceClass::OpenArea if text(at) == "lobby" => {
            let inside = |person: &crate::cast::Person| {
                person
                    .relation
                    .as_ref()
                    .is_some_and(|(relation, _)| matches!(relation, Relation::Leaving | Relation::Staying))
            };
            let car = found.places.iter().any(|(class, _)| *class == PlaceClass::Elevator)
                || story.place.as_ref().is_some_and(|(class, _)| *class == PlaceClass::Elevator)
                    && found.robots.is_empty()
                    && !story.cast.people.iter().any(inside);
            if car { PlaceClass::ElevatorLobby } else { class }
        }
        PlaceClass::Elevator
        | PlaceClass::OpenArea
        | PlaceClass::ElevatorLobby
        | PlaceClass::Corridor
        | PlaceClass::NarrowPassage
        | PlaceClass::Intersection
        | PlaceClass::BlindCorner
        | PlaceClass::Doorway
        | PlaceClass::Room
        | PlaceClass::Exit
        | PlaceClass::Plain => class,
    }
}
