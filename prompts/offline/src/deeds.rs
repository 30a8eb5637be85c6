//! The deeds of a clause: phrases for what people do, the longest first, and which of them tell more than others.

use crate::clause::{Deed, Found, mark, mark_each, text_of};
use crate::cut::{Joint, Stretch};
use crate::lexicon::{Act, Item, lexicon};
use crate::negation::negated;
use crate::words::find;

pub(crate) fn deeds(stretch: &mut Stretch, found: &mut Found, taken: &mut [bool], placed: &[bool]) {
    // The name of a gesture is no deed: `with a WAIT gesture`.
    for i in 0..stretch.words.len() {
        let (Some(word), Some(next)) = (stretch.words.get(i), stretch.words.get(i + 1)) else { break };
        let message = [Item::Word(word.stem.clone())];
        if matches!(next.stem.as_str(), "gesture" | "signal" | "sign")
            && lexicon().gestures.iter().any(|phrase| phrase.items == message)
        {
            mark(stretch, i, i);
            if let Some(flag) = taken.get_mut(i) {
                *flag = true;
            }
        }
    }
    for phrase in &lexicon().actions {
        if phrase.means == Act::Gesture {
            continue;
        }
        let mut from = 0;
        while let Some(at) = find(&stretch.words, phrase, from, false, &|i| !taken.get(i).copied().unwrap_or(true)) {
            let (first, last) = (at.first().copied().unwrap_or(0), at.last().copied().unwrap_or(0));
            from = first + 1;
            // `in the lobby in front of it`: it is the place, not the robot.
            // Two who walk in opposite directions need not walk towards the robot.
            let apart = phrase.means == Act::Toward
                && at.iter().any(|i| stretch.words.get(*i).is_some_and(|word| word.text == "directions"));
            // `from behind the shelves` is not from behind the robot.
            let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
            let elsewhere = phrase.means == Act::Behind
                && text(last) == "behind"
                && matches!(text(last + 1), "the" | "a" | "some" | "one")
                && stretch.words.get(last + 2).is_some_and(|word| word.stem != "robot" && !word.label);
            // `in this run` nobody runs.
            let named = first.checked_sub(1).map_or("", text);
            let trip = at.len() == 1
                && matches!(text(first), "run" | "walk" | "drive" | "trip" | "test" | "pass")
                && matches!(
                    named,
                    "this" | "that" | "the" | "each" | "every" | "whole" | "entire" | "a" | "same" | "per" | "one"
                );
            // `arms crossed`
            let limbs = phrase.means == Act::Cross && matches!(named, "arms" | "legs" | "fingers");
            // `the remaining two`, `the last visitor to leave`, `leaves the detour to the robot`
            let told = matches!(phrase.means, Act::Stay | Act::ComeOut)
                && (found.mentions.iter().any(|mention| (mention.from..=mention.to).contains(&first))
                    || named == "to" && first > 1 && found.mentions.iter().any(|mention| mention.to + 2 == first)
                    || at.len() == 1
                        && text(first).starts_with("leave")
                        && (first + 2..first + 6).any(|k| {
                            text(k) == "to"
                                && (k + 1..k + 3).any(|k| stretch.words.get(k).is_some_and(|word| word.stem == "robot"))
                        })
                        && !placed.get(first + 1..first + 4).is_some_and(|words| words.contains(&true)));
            if trip || limbs || told {
                continue;
            }
            // `the guide signals`: a noun here.
            let noun = at.len() == 1
                && found.mentions.iter().any(|mention| {
                    mention.to == first
                        && mention.from < first
                        && mention.role.as_deref() == stretch.words.get(first).map(|word| word.stem.as_str())
                });
            // `staring at his phone` sees no robot.
            let aside = phrase.means == Act::Look && aside(stretch, last);
            // `starts walking after 12 s`
            let counted = stretch.words.get(last).is_some_and(|word| word.text == "after")
                && stretch.words.get(last + 1).is_some_and(|word| word.number().is_some());
            if counted && phrase.means == Act::Follow {
                continue;
            }
            // `come out of a room in front of the robot`: where they come out.
            let out = phrase.means == Act::Ahead && (first..last).any(|k| text(k) == "out");
            let of_place = noun
                || out
                || elsewhere
                || apart
                || stretch.words.get(last).is_some_and(|word| word.text == "it")
                    && (first..last).any(|i| !at.contains(&i) && placed.get(i).copied().unwrap_or(false));
            if of_place && !aside {
                continue;
            }
            for i in &at {
                if let Some(flag) = taken.get_mut(*i) {
                    *flag = true;
                }
            }
            mark_each(stretch, &at);
            let ends = phrase.means == Act::Stop
                && at.len() == 1
                && negated(stretch, first)
                && stretch.words.get(last + 1).is_some_and(|word| word.text.ends_with("ing"));
            if ends {
                continue;
            }
            // `finding its path obstructed`: nobody is said to do it.
            let found_so = phrase.means == Act::Block
                && stretch.words.get(first).is_some_and(|word| word.text.ends_with("ed"))
                && stretch.words.first().is_some_and(|word| matches!(word.text.as_str(), "finding" | "seeing"))
                && stretch.words.get(last + 1).is_none_or(|word| word.text != "by");
            if found_so {
                continue;
            }
            // `walks away in the opposite direction`: away from where it stood.
            let off = phrase.means == Act::Toward
                && (0..first + 2).any(|k| matches!(text_of(stretch, k), "away" | "off"))
                && at.iter().any(|i| matches!(text_of(stretch, *i), "opposite" | "other"));
            let says_not = stretch.words.get(first).is_some_and(|word| word.text == "not");
            found.deeds.push(Deed {
                act: if aside {
                    Act::Ignore
                } else if off {
                    Act::GoOn
                } else {
                    phrase.means
                },
                at: first,
                to: last,
                negated: !says_not && !aside && negated(stretch, first),
            });
        }
    }
    in_front(stretch, found);
    found.deeds.sort_by_key(|deed| deed.at);
    let has = |acts: &[Act]| found.deeds.iter().any(|deed| acts.contains(&deed.act) && !deed.negated);
    // The more telling word wins: `approaches from behind` is no coming up to the robot out of curiosity.
    let directed = has(&[Act::Toward, Act::Behind, Act::Cross, Act::Overtake]);
    let telling = found.deeds.iter().any(|deed| !matches!(deed.act, Act::Walk | Act::Pass | Act::Stand | Act::Stop));
    let directs = found.deeds.iter().any(|deed| {
        // `walks on without a glance at it`
        !deed.negated
            && !matches!(
                deed.act,
                Act::Walk | Act::Pass | Act::Stand | Act::Stop | Act::GoOn | Act::Ignore | Act::Abreast
            )
    });
    let follows = has(&[Act::Follow]);
    let stands = has(&[Act::Block, Act::Look]);
    let rear = stretch.words.iter().any(|word| matches!(word.text.as_str(), "behind" | "rear"));
    let keep = |deed: &Deed| match deed.act {
        // `walks behind the robot in the same direction`, `across the intersection in front of it`
        Act::Ahead => !(follows || has(&[Act::Behind]) && rear || has(&[Act::Cross])),
        // `walks past it in the opposite direction`
        Act::Overtake => rear || !has(&[Act::Toward]),
        // `a curious visitor follows` goes after the robot, not up to it.
        // `gives up after 10 seconds of following`
        Act::Follow => {
            !(deed.at.checked_sub(1).and_then(|k| stretch.words.get(k)).is_some_and(|word| word.text == "of")
                && stretch.words.get(deed.at).is_some_and(|word| word.text.ends_with("ing")))
        }
        Act::Approach if follows => !directed && deed.at != deed.to,
        Act::Approach => !directed,
        // `walks ahead of the robot on the way out`
        Act::ComeOut if text_of(stretch, deed.at) == "on" => {
            !has(&[Act::Ahead, Act::Toward, Act::Cross, Act::Follow, Act::Overtake])
        }
        Act::Walk | Act::Pass => !telling || deed.negated,
        Act::GoOn => !directs,
        Act::Stop => !stands,
        Act::RunAway
        | Act::GiveWay
        | Act::Block
        | Act::Look
        | Act::Toward
        | Act::Behind
        | Act::Abreast
        | Act::Cross
        | Act::ComeOut
        | Act::Stay
        | Act::Enter
        | Act::Talk
        | Act::WalkTogether
        | Act::Stand
        | Act::Ignore
        | Act::Gesture
        | Act::Lead
        | Act::TurnBack
        | Act::SlowDown
        | Act::SpeedUp
        | Act::Aside
        | Act::ComeClose
        | Act::OpenUp => true,
    };
    let kept = found.deeds.iter().copied().filter(keep).collect();
    found.deeds = kept;
}

/// Whether somebody looks at a thing that he holds or passes, and not at the robot: `at his phone`.
fn aside(stretch: &Stretch, last: usize) -> bool {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let from = if matches!(text(last), "at" | "into" | "out" | "on" | "down") { last } else { last + 1 };
    let to = from + usize::from(matches!(text(from), "down" | "up" | "intently" | "only" | "straight"));
    matches!(text(to), "at" | "into" | "out" | "on")
        && (to + 1..to + 5).take_while(|k| stretch.words.get(*k).is_some_and(|word| word.stem != "robot")).any(|k| {
            matches!(
                text(k),
                "phone"
                    | "smartphone"
                    | "mobile"
                    | "tablet"
                    | "watch"
                    | "screen"
                    | "display"
                    | "book"
                    | "newspaper"
                    | "magazine"
                    | "clipboard"
                    | "map"
                    | "laptop"
                    | "shoes"
                    | "feet"
                    | "floor"
                    | "ground"
                    | "papers"
                    | "paper"
                    | "notes"
                    | "poster"
                    | "ceiling"
                    | "file"
                    | "list"
                    | "chart"
                    | "charts"
                    | "skyline"
                    | "window"
                    | "wall"
                    | "view"
                    | "sky"
                    | "door"
                    | "board"
                    | "sign"
                    | "noticeboard"
                    | "clock"
                    | "menu"
                    | "shelf"
                    | "shelves"
                    | "rack"
                    | "racks"
            )
        })
}

/// `walks four meters in front`, `…, a few steps in front of it`: ahead of the robot.
fn in_front(stretch: &mut Stretch, found: &mut Found) {
    let text = |k: usize| stretch.words.get(k).map_or("", |word| word.text.as_str());
    let count = stretch.words.len();
    let Some(at) = (0..count).find(|k| text(*k) == "in" && text(k + 1) == "front") else { return };
    let robot =
        text(at + 2) == "of" && (at + 3..at + 5).any(|k| stretch.words.get(k).is_some_and(|word| word.stem == "robot"));
    if !text(at + 2).is_empty() && !robot {
        return;
    }
    let walks = found.deeds.iter().any(|deed| matches!(deed.act, Act::Walk | Act::GoOn) && deed.at < at);
    let manner = found.deeds.is_empty()
        && found.mentions.is_empty()
        && stretch.joint == Joint::Comma
        && found.distance_m.is_some();
    let other = found
        .deeds
        .iter()
        .any(|deed| !matches!(deed.act, Act::Walk | Act::GoOn | Act::Ignore | Act::Talk | Act::WalkTogether));
    if (walks || manner) && !other {
        found.deeds.push(Deed { act: Act::Ahead, at, to: at + 1, negated: false });
        mark(stretch, at, at + 1);
    }
}
