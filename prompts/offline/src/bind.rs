//! Who does what is said: the subject of a deed, and the deed itself.

use socrates_model::{Action, HumanId, PlaceClass, Relation, Trigger};

use crate::cast::Cast;
use crate::clause::Found;
use crate::cut::{Joint, Stretch};
use crate::deed::{self, Around};
use crate::ellipsis;
use crate::lexicon::Act;
use crate::mention::Who;
use crate::order;
use crate::story::{Story, Subject, Thread};

/// Who does it.
pub(crate) fn subject_of(
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
    // `nobody steps aside`
    let nearest = found.mentions.iter().rev().find(|mention| mention.from < at && mention.who != Who::Object);
    if nearest.is_some_and(|mention| mention.who == Who::Nobody) && !found.robots.iter().any(|robot| *robot < at) {
        return Subject::Nobody;
    }
    if passive && let Some((_, _, agent)) = meant.iter().find(|(from, _, _)| *from > at) {
        return people(agent);
    }
    // `the tester behind him stands`: whoever is only told where from does nothing.
    let object = |from: &usize| {
        found.mentions.iter().any(|mention| {
            let them =
                mention.word == "them" && act == Act::Gesture && found.robots.iter().any(|robot| *robot < mention.from);
            mention.from == *from && (mention.who == Who::Object || them)
        })
    };
    let before = meant.iter().rev().find(|(from, _, some)| *from < at && !some.is_empty() && !object(from));
    // `Behind the robot comes a doctor`: who does it stands after the verb.
    let turned = matches!(act, Act::Behind | Act::Ahead | Act::Walk | Act::Stand | Act::ComeOut | Act::Toward);
    // `coming towards it there is a driver`
    let there = (found.declares || found.inverted) && !found.robots.iter().any(|robot| *robot < at);
    // `it catches up with an intern`
    let catches = act == Act::Behind && found.robots.iter().any(|robot| robot + 1 == at || robot + 2 == at);
    if before.is_none()
        && turned
        && !catches
        && let Some((_, _, some)) =
            meant.iter().find(|(from, _, some)| (*from == to + 1 || there && *from > to) && !some.is_empty())
    {
        return people(some);
    }
    let robot = found.robots.iter().rev().find(|robot| **robot < at);
    // `has the robot coming up behind him`: the robot is behind.
    let after = found.mentions.iter().any(|mention| mention.from > to && mention.who == Who::Object);
    let next_to = robot.is_some_and(|robot| robot + 1 == at || robot + 2 == at);
    if act == Act::Behind && after && next_to {
        return Subject::Robot;
    }
    // `The robot approaches an employee from behind.`
    let between = before.is_some_and(|(from, _, _)| {
        found.robots.iter().any(|robot| robot < from) && found.deeds.iter().all(|deed| deed.at >= at)
    });
    if act == Act::Behind && between && joined.is_empty() && !found.passive {
        return Subject::Robot;
    }
    // `The robot comes from behind`; but `the robot is approached from behind`.
    if act == Act::Behind && before.is_none() && joined.is_empty() && next_to && !found.passive {
        return Subject::Robot;
    }
    let robotic = matches!(
        act,
        Act::Pass
            | Act::Walk
            | Act::TurnBack
            | Act::SlowDown
            | Act::SpeedUp
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
    ) || act == Act::GoOn && robot.is_some()
        || act == Act::Approach && !found.robots.iter().chain(&found.met).any(|robot| *robot > at);
    // `out of the room that the robot drives into and nods to it`: what is nodded to nods not.
    let object_robot = act == Act::Gesture
        && found.robots.first().is_some_and(|robot| *robot > to && *robot <= to + 3)
        && !found.mentions.iter().any(|mention| mention.from > to);
    match (before, robot) {
        (Some((from, _, some)), Some(robot)) if robotic && robot > from => {
            // The robot between a person and the deed is the object of an earlier one, unless it opens a clause of its own.
            // `out of the room the robot wants to enter`
            let own = act == Act::Enter && found.places.iter().any(|(_, place)| (place + 1..place + 4).contains(robot));
            if !own && found.deeds.iter().any(|deed| deed.at > *from && deed.at < *robot) {
                people(some)
            } else {
                Subject::Robot
            }
        }
        (Some((_, _, some)), _) => people(some),
        // `a guest and the robot arrive from opposite sides`
        (None, Some(_)) if !joined.is_empty() && robotic => Subject::People(joined.to_vec()),
        (None, Some(_)) if robotic => Subject::Robot,
        (None, _) => {
            if !joined.is_empty() {
                return Subject::People(joined.to_vec());
            }
            match previous {
                Subject::Robot if robotic && !(object_robot && cast.last.len() == 1) => Subject::Robot,
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

/// What people do, with all that surrounds it.
#[expect(clippy::too_many_arguments, reason = "all that surrounds a deed decides what it means")]
pub(crate) fn people_deed(
    story: &mut Story,
    thread: &mut Thread,
    (act, at, to): (Act, usize, usize),
    people: &[usize],
    found: &Found,
    meant: &[(usize, usize, Vec<usize>)],
    stretch: &Stretch,
    quote: &str,
) {
    // `looks at it, then goes towards it`: by then it is no way that it goes, but up to the robot.
    let act = if act == Act::Toward && stretch.joint == Joint::Then && thread.doer.as_deref() == Some(people) {
        Act::Approach
    } else {
        act
    };
    // `it says EXCUSE_ME, and she moves`: out of its way.
    let moves = stretch.words.get(at).is_some_and(|word| word.stem == "move");
    let asked = matches!(thread.waiting, Some(Trigger::RobotSays(socrates_model::Gesture::ExcuseMe)));
    let act = if asked && moves && matches!(act, Act::Walk | Act::GoOn) { Act::GiveWay } else { act };
    // `blocks it, waits ten seconds and leaves`: there is nothing that it could come out of.
    let gone = act == Act::ComeOut
        && found.places.is_empty()
        && stretch.words.get(at).is_some_and(|word| word.stem == "leave")
        && people.iter().all(|who| {
            story.cast.people.get(*who).is_some_and(|person| !person.rules.is_empty() && person.start.is_none())
        });
    let act = if gone { Act::GoOn } else { act };
    // `gets a shock and runs`
    let flees = act == Act::Walk
        && at + 1 == stretch.words.len()
        && stretch
            .words
            .get(at)
            .is_some_and(|word| matches!(word.stem.as_str(), "run" | "bolt" | "dash" | "sprint" | "rush"))
        && people.iter().all(|who| {
            story.cast.people.get(*who).is_some_and(|person| person.doings.iter().any(|doing| doing == "startled"))
        });
    let act = if flees { Act::RunAway } else { act };
    // `stops when it is near, stays put for 6 s`
    let stopped = |who: &usize| {
        let person = story.cast.people.get(*who);
        person.and_then(|person| person.rules.last()).is_some_and(|last| last.rule.act == Action::StandStill)
    };
    let act = if act == Act::Stay && found.lasts_s.is_some() && found.places.is_empty() && people.iter().all(stopped) {
        Act::Stop
    } else {
        act
    };
    // `is standing against the wall` makes room for nobody, where nothing is waited for.
    let leans = act == Act::GiveWay
        && thread.waiting.is_none()
        && stretch.words.get(at).is_some_and(|word| matches!(word.text.as_str(), "stands" | "standing" | "stand"))
        && stretch.words.get(to).is_some_and(|word| word.text == "wall");
    let act = if leans { Act::Stand } else { act };
    // `steps to the left`
    let aside = act == Act::Walk
        && matches!(
            stretch.words.get(at).map(|word| word.stem.as_str()),
            Some("step" | "move" | "shift" | "dodge" | "jump")
        )
        && (to + 1..to + 4).any(|k| {
            stretch.words.get(k).is_some_and(|word| matches!(word.text.as_str(), "left" | "right"))
                && (to + 1..k).all(|k| {
                    stretch.words.get(k).is_some_and(|word| {
                        word.label || matches!(word.text.as_str(), "to" | "the" | "its" | "his" | "her")
                    })
                })
        });
    let act = if aside { Act::GiveWay } else { act };
    // `walks 2 m behind participant 1`
    let trails = act == Act::Walk
        && (to + 1..to + 5).any(|k| {
            stretch.words.get(k).is_some_and(|word| word.text == "behind")
                && meant.iter().any(|(from, _, some)| {
                    *from == k + 1 && !some.is_empty() && some.iter().all(|i| !people.contains(i))
                })
        });
    let act = if trails { Act::Follow } else { act };
    // `is accompanied by a technician`
    let beside = act == Act::Lead
        && stretch.words.get(at).is_some_and(|word| word.stem == "accompany")
        && !found.robots.is_empty()
        && !meant.iter().any(|(from, _, some)| *from > to && some.iter().any(|i| !people.contains(i)));
    let act = if beside { Act::Abreast } else { act };
    // `walks next to her`
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let joins = act == Act::Walk
        && meant.iter().any(|(from, _, some)| {
            *from > to
                && *from <= to + 4
                && !some.is_empty()
                && some.iter().all(|i| !people.contains(i))
                && from.checked_sub(1).is_some_and(|k| {
                    matches!(text(k), "beside" | "alongside")
                        || text(k) == "to" && k > 0 && text(k - 1) == "next"
                        || text(k) == "with" && k > 0 && matches!(text(k - 1), "together" | "along")
                })
        });
    let act = if joins { Act::WalkTogether } else { act };
    // `the robot signals it to wait, he then stands for 4 s`
    let halts = act == Act::Stand
        && found.lasts_s.is_some()
        && matches!(thread.waiting, Some(Trigger::RobotSays(_) | Trigger::HumanSays(..) | Trigger::RobotStopped));
    let act = if halts { Act::Stop } else { act };
    // `sits on a chair next to it`
    let seated = act == Act::Abreast
        && (0..at).any(|k| {
            stretch.words.get(k).is_some_and(|word| matches!(word.stem.as_str(), "stand" | "sit" | "wait" | "lean"))
        });
    let act = if seated { Act::Stand } else { act };
    // `is standing in the packing area in the robot's way`
    let stands_there = act == Act::Block
        && thread.waiting.is_none()
        && found.lasts_s.is_none()
        && (0..=at).any(|k| {
            stretch.words.get(k).is_some_and(|word| {
                matches!(word.stem.as_str(), "stand" | "wait" | "sit" | "linger" | "loiter")
                    && (k > at.saturating_sub(8))
            })
        });
    for who in people.iter().filter(|_| stands_there) {
        if story.cast.people.get(*who).is_some_and(|person| person.relation.is_none() && person.rules.is_empty()) {
            crate::relation::relate(&mut story.cast, *who, Relation::Static, quote);
        }
    }
    // `waits 5 seconds and then goes in`: whatever it did, it goes on.
    let after = matches!(stretch.joint, Joint::Then | Joint::And) && thread.doer.as_deref() == Some(people);
    // `follow it and want to pass`: as yet they only want to.
    let wanted = act == Act::Pass
        && text(at.wrapping_sub(1)) == "to"
        && stretch
            .words
            .get(at.wrapping_sub(2))
            .is_some_and(|word| matches!(word.stem.as_str(), "want" | "try" | "wish" | "hope" | "like"));
    if after && !wanted && thread.waiting.is_none() && matches!(act, Act::Walk | Act::Pass | Act::Enter) {
        for who in people {
            let halted = story.cast.people.get_mut(*who).filter(|person| !person.rules.is_empty());
            if let Some(person) = halted {
                person.goes_on.get_or_insert_with(|| quote.to_owned());
                thread.went_on.push(*who);
            }
        }
    }
    if act == Act::GoOn {
        thread.went_on.extend(people);
    }
    let object = meant
        .iter()
        .find(|(from, _, some)| *from > to && some.iter().any(|i| !people.contains(i)))
        .and_then(|(_, _, some)| some.iter().find(|i| !people.contains(i)));
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
    // `follows the facilitator rather than the robot`
    let rather =
        |robot: usize| (1..=3).filter_map(|back| robot.checked_sub(back)).any(|k| matches!(text(k), "than" | "not"));
    let object =
        if matches!(act, Act::Follow | Act::Look) && found.robots.iter().all(|robot| *robot < at || rather(*robot)) {
            object
        } else {
            None
        };
    let startled = (at..=to).any(|i| {
        stretch
            .words
            .get(i)
            .is_some_and(|word| matches!(word.stem.as_str(), "startle" | "surprise" | "shock" | "astonish" | "freeze"))
    });
    let inside = found.places.first().map(|(class, _)| *class);
    let place = if matches!(act, Act::ComeOut | Act::Stay) {
        // `runs out of the ward and goes to the elevator`: what stands first behind the verb.
        let inside =
            |class: &PlaceClass| matches!(class, PlaceClass::Elevator | PlaceClass::Room | PlaceClass::Doorway);
        let behind = found.places.iter().filter(|(class, place)| inside(class) && *place > at);
        behind
            .min_by_key(|(_, place)| *place)
            .or_else(|| found.places.iter().find(|(class, _)| inside(class)))
            .map(|(class, _)| *class)
            .or_else(|| people.iter().find_map(|i| story.cast.people.get(*i).and_then(|p| p.start)))
            .or_else(|| at_elevator(story, act))
    } else if act == Act::Enter {
        // `the door opens and they all get in`, before an elevator
        inside.or_else(|| at_elevator(story, act))
    } else {
        inside
    };
    // `gives way at 2 m` says when; `follows at 2 m` says how.
    let at_distance = found.distance_m.filter(|_| found.distance_is_when && thread.waiting.is_none());
    let near = at_distance
        .filter(|_| !matches!(act, Act::Follow | Act::Ahead | Act::Behind | Act::Abreast))
        .map(Trigger::RobotNear);
    // `At 1.5 m he looks up and jumps aside`: both then.
    if near.is_some()
        && (thread.next == Some(Joint::And)
            || stretch.words.first().is_some_and(|word| matches!(word.text.as_str(), "at" | "within" | "from")))
    {
        thread.waiting.clone_from(&near);
        thread.vague = false;
    }
    if matches!(act, Act::Stay | Act::ComeOut) {
        told_apart(&mut story.cast, people, act);
    }
    // `he asks the picker to wait; she then freezes`
    if ellipsis::responds(thread.said.as_ref(), act)
        && thread.waiting.is_none()
        && near.is_none()
        && !thread.addressed.is_empty()
        && people.iter().all(|who| thread.addressed.contains(who))
    {
        thread.waiting.clone_from(&thread.said);
    }
    // `The robot says EXCUSE_ME. A worker who blocks the aisle answers that it may proceed.`
    let replies = act == Act::Gesture
        && thread.waiting.is_none()
        && matches!(thread.said, Some(Trigger::RobotSays(_)))
        && stretch.words.get(at).is_some_and(|word| matches!(word.stem.as_str(), "answer" | "reply" | "respond"));
    if replies {
        thread.waiting.clone_from(&thread.said);
    }
    let around = Around {
        vague: thread.vague && near.is_none(),
        trigger: thread.waiting.clone().or(near),
        distance_m: found.distance_m,
        lasts_s: found.lasts_s,
        gesture: found.gesture,
        object: object.and_then(|i| u32::try_from(i + 1).ok()).map(HumanId::new),
        place,
        startled,
        stands: to > at
            && thread.waiting.is_none()
            && found.lasts_s.is_none()
            && (at..=to).any(|k| stretch.words.get(k).is_some_and(|word| word.stem == "stand"))
            || stretch.words.get(at).is_some_and(|word| matches!(word.text.as_str(), "standing" | "waiting"))
                && stretch.words.get(at + 1).is_none_or(|word| word.text != "still")
            // `both labourers wait at the intersection`
            || act == Act::Stop
                && thread.waiting.is_none()
                && found.lasts_s.is_none()
                && stretch.words.get(at).is_some_and(|word| word.stem == "wait")
                && !stretch.words.iter().any(|word| matches!(word.text.as_str(), "until" | "then"))
                && stretch.words.get(at + 1).is_some_and(|word| {
                    matches!(word.text.as_str(), "at" | "in" | "by" | "near" | "outside" | "there" | "beside")
                }),
        gives_up: act == Act::GoOn
            && stretch.words.get(at).is_some_and(|word| matches!(word.stem.as_str(), "give" | "lose" | "get")),
        then: stretch.joint == Joint::Then,
        goes_on: thread.doer.as_deref() == Some(people) && !replies,
        quote: quote.to_owned(),
    };
    let answers = matches!(act, Act::Gesture).then(|| around.gesture).flatten();
    if let (Some(gesture), Some(first)) = (answers, people.first()) {
        let id = HumanId::new(u32::try_from(first + 1).unwrap_or(u32::MAX));
        thread.said = Some(Trigger::HumanSays(id, gesture));
    }
    thread.acts.push((act, around.clone()));
    order::note(story, thread, stretch, (act, people), around.trigger.as_ref(), quote);
    for who in people {
        if let Some(rule) = deed::apply(&mut story.cast, *who, act, &around) {
            let late = thread.delay_s.filter(|_| deed::manner(act).is_some());
            let rule = late.and_then(|secs| deed::delay(&mut story.cast, *who, rule, secs)).unwrap_or(rule);
            thread.made.push((*who, rule));
        }
    }
    // `a doctor talks to a patient`: both do.
    let partner = |from: usize| {
        let before = from.checked_sub(1).and_then(|k| stretch.words.get(k)).map_or("", |word| word.text.as_str());
        act == Act::Talk && matches!(before, "to" | "with")
            || act == Act::WalkTogether && matches!(before, "with" | "beside" | "alongside" | "to" | "of")
    };
    let others: Vec<usize> = meant
        .iter()
        .filter(|(from, _, _)| *from > to && partner(*from))
        .flat_map(|(_, _, some)| some.iter().copied())
        .filter(|i| !people.contains(i))
        .collect();
    for who in &others {
        let _rule = deed::apply(&mut story.cast, *who, act, &around);
    }
    if !others.is_empty() {
        let all: Vec<usize> = people.iter().chain(&others).copied().collect();
        story.cast.together(&all, quote);
        story.cast.group(&all, quote);
    } else if queues(act, (at, to), stretch) {
        story.cast.group(people, quote);
        for person in people.iter().filter(|_| people.len() > 1) {
            if let Some(person) = story.cast.people.get_mut(*person) {
                person.doings.retain(|doing| doing != "stands" && doing != QUEUES);
                person.doings.push(QUEUES.to_owned());
            }
        }
    } else if matches!(act, Act::Talk | Act::WalkTogether) || found.in_group {
        story.cast.group(people, quote);
    }
    story.cast.last = people.to_vec();
    thread.doer = Some(people.to_vec());
}

/// The elevator, where the text tells of one or of the place before it.
fn at_elevator(story: &Story, act: Act) -> Option<PlaceClass> {
    // Who stays in the lobby stands there, unless somebody comes out of the elevator.
    let left = || story.cast.people.iter().any(|person| matches!(person.relation, Some((Relation::Leaving, _))));
    let lobby = act != Act::Stay || left();
    let near = |class: PlaceClass| class == PlaceClass::Elevator || lobby && class == PlaceClass::ElevatorLobby;
    story.place.as_ref().filter(|(class, _)| near(*class)).map(|_| PlaceClass::Elevator)
}

/// What those do who stand one behind the other.
pub(crate) const QUEUES: &str = "queues";

/// `four people queue`, `three wait in line`: one group, one behind the other.
fn queues(act: Act, (at, to): (usize, usize), stretch: &Stretch) -> bool {
    let word = |k: usize| stretch.words.get(k).map_or("", |word| word.stem.as_str());
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let row = |k: usize| {
        word(k) == "queue"
            || word(k) == "line" && (text(k + 1) == "up" || k > 0 && matches!(text(k - 1), "in" | "a" | "form"))
    };
    matches!(act, Act::Stand | Act::Stop) && (at..=to + 3).any(row)
}

/// `people come out; one of them stays inside`: takes back of some what was said of all of them.
fn told_apart(cast: &mut Cast, people: &[usize], act: Act) {
    let opposite = if act == Act::Stay { Relation::Leaving } else { Relation::Staying };
    let said = |cast: &Cast, who: usize| {
        let person = cast.people.get(who)?;
        let (_, quote) = person.relation.as_ref().filter(|(relation, _)| *relation == opposite)?;
        Some((quote.clone(), person.role.clone()))
    };
    let Some(first) = people.first().and_then(|who| said(cast, *who)) else { return };
    // Told alike of several, of whom these are some: the exception. Of all of them it is a contradiction.
    let alike = (0..cast.people.len()).filter(|who| said(cast, *who).as_ref() == Some(&first)).count();
    if alike <= people.len() || people.iter().any(|who| said(cast, *who).as_ref() != Some(&first)) {
        return;
    }
    for who in people {
        if let Some(person) = cast.people.get_mut(*who) {
            person.relation = None;
            person.doings.retain(|doing| {
                !doing.starts_with("comes out of") && !doing.starts_with("leaves the") && doing != "stays"
            });
        }
    }
}
