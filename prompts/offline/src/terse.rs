//! What notes leave out: verbs (`ped to the side`), subjects of denials (`no stop, no look`), and what nobody does in them.

use crate::arrows::insert;
use crate::lexicon::lexicon;
use crate::notes::{Item, Items, Mark, robot};

/// Writes out what terse notes leave out.
pub(crate) fn terse(mut items: Items) -> Items {
    let mut at = 0;
    while at < items.0.len() {
        overview(&mut items, at);
        passed(&mut items, at);
        visible(&mut items, at);
        wants_in(&mut items, at);
        verbless(&mut items, at);
        denied(&mut items, at);
        ward(&mut items, at);
        answered(&mut items, at);
        from_behind(&mut items, at);
        at += 1;
    }
    items
}

/// Words behind people that make a heading of them: `ped list`, `actor overview`.
const OVERVIEWS: &[&str] =
    &["list", "roster", "overview", "count", "types", "type", "table", "definition", "definitions", "setup", "model"];

/// `Ped list: …` and `multi-actor` name nobody.
fn overview(items: &mut Items, at: usize) {
    let generic = |k: usize| {
        lexicon().roles.get(items.stem(k)).is_some_and(|role| role.generic)
            || matches!(items.stem(k), "actor" | "agent")
    };
    let heading =
        generic(at) && OVERVIEWS.contains(&items.text(at + 1)) && !items.marked(at + 1) && items.marked(at + 2);
    let hyphen = |k: usize| items.0.get(k).is_some_and(|item| item.gap == "-");
    let many = matches!(items.text(at), "multi" | "single" | "two" | "dual")
        && hyphen(at + 1)
        && generic(at + 1)
        && items.marked(at + 2);
    if (heading && items.marked(at)) || many {
        items.label(at, at + 2);
    }
}

/// Whether a number is that of a step: `1. the robot asks; 2. ped 1 steps aside`.
fn step(items: &Items, at: usize) -> bool {
    let digits = items.word(at).is_some_and(|word| word.is_digits() && word.text.len() <= 2);
    let after = items.0.get(at + 1).is_some_and(|next| next.gap.starts_with(['.', ')']) && next.gap.len() > 1);
    let before = items.begins(at) || items.has(at, Mark::Colon) || items.has(at, Mark::Comma);
    let total = at > 0
        && lexicon().roles.contains_key(items.stem(at - 1))
        && items.word(at - 1).is_some_and(|word| !word.label && crate::noun::plural(word));
    digits && after && before && !total
}

/// Numbers of steps count nobody.
pub(crate) fn numbered(items: &mut Items) {
    let first = (0..items.0.len()).find(|k| items.text(*k) == "1" && step(items, *k));
    let second = first.and_then(|at| (at + 1..items.0.len()).find(|k| items.text(*k) == "2" && step(items, *k)));
    let Some(from) = first.filter(|_| second.is_some()) else { return };
    for k in from..items.0.len() {
        if step(items, k) {
            items.spend(k, k + 1);
        }
    }
}

/// `robot asks to pass; then ped 1 steps aside` is one sentence.
fn answered(items: &mut Items, at: usize) {
    let semicolon = items.0.get(at).is_some_and(|item| item.marks == [Mark::Stop] && item.gap.trim() == ";");
    if items.text(at) != "then" || !semicolon || at == 0 {
        return;
    }
    let mut from = items.start(at - 1);
    while items.word(from).is_some_and(|word| word.label || word.text == "the") {
        from += 1;
    }
    if robot(items, from)
        && let Some(item) = items.0.get_mut(at)
    {
        item.marks = vec![Mark::Comma];
    }
}

/// `corridor ward B` is a corridor.
fn ward(items: &mut Items, at: usize) {
    let place =
        matches!(items.text(at), "corridor" | "hallway" | "aisle" | "doorway" | "intersection" | "elevator" | "lobby");
    let of = matches!(items.text(at + 1), "ward" | "room" | "floor" | "level" | "wing" | "unit" | "block" | "building");
    let named = items.word(at + 2).is_some_and(|word| word.is_digits() || word.capital && word.text.len() == 1);
    if place
        && of
        && named
        && !items.marked(at + 1)
        && !items.marked(at + 2)
        && let Some(item) = items.0.get_mut(at + 1)
    {
        item.marks = vec![Mark::Comma];
    }
}

/// `location: corridor` is said first: what is named in passing is no place of the encounter.
pub(crate) fn located(mut items: Items) -> Items {
    let names = |k: &usize| {
        let word = matches!(items.text(*k), "location" | "place" | "where" | "site" | "environment" | "env" | "venue");
        let given =
            items.has(k + 1, Mark::Colon) || items.0.get(k + 1).is_some_and(Item::equals) || items.end(*k) == k + 2;
        *k > 0 && word && given && items.begins(*k) && items.end(*k) <= k + 6
    };
    let Some(from) = (0..items.0.len()).find(names) else { return items };
    let to = items.end(from).min(items.0.len());
    if !(from + 1..to).any(|k| crate::notes::names_place(&items, k)) {
        return items;
    }
    let mut moved: Vec<Item> = items.0.drain(from..to).collect();
    if let Some(first) = moved.first_mut() {
        first.marks.clear();
    }
    if let Some(first) = items.0.first_mut() {
        first.marks = vec![Mark::Stop];
    }
    let _none: Vec<Item> = items.0.splice(0..0, moved).collect();
    items
}

/// `same direction, from rear`: who comes from behind is not ahead.
fn from_behind(items: &mut Items, at: usize) {
    let same = items.text(at) == "same" && matches!(items.text(at + 1), "direction" | "heading" | "way");
    if !same {
        return;
    }
    let (from, end) = (items.start(at), items.end(at).min(items.0.len()));
    let rear = (from..end).any(|k| {
        items.text(k) == "rear" && items.text(k.wrapping_sub(1)) != "to"
            || items.text(k) == "behind"
                && (items.text(k.wrapping_sub(1)) == "from" || robot(items, k + 1) || robot(items, k + 2))
            || items.stem(k) == "overtake"
    });
    if rear {
        items.spend(at, at + 2);
    }
}

/// `bot past`, `robot gone`: it has driven past.
fn passed(items: &mut Items, at: usize) {
    if robot(items, at)
        && matches!(items.text(at + 1), "past" | "gone" | "by" | "through")
        && !items.marked(at + 1)
        && items.marked(at + 2)
        && matches!(items.text(at.wrapping_sub(1)), "when" | "until" | "till" | "once" | "if" | "after")
        && let Some(item) = items.0.get(at + 1).cloned()
    {
        let past = ["drives", "past"].map(|text| Item::said(text, &item));
        let _old: Vec<Item> = items.0.splice(at + 1..at + 2, past).collect();
    }
}

/// `robot at elevator, wants in` wants to get in.
fn wants_in(items: &mut Items, at: usize) {
    if items.stem(at) == "want"
        && items.text(at + 1) == "in"
        && !items.marked(at + 1)
        && items.marked(at + 2)
        && let Some(item) = items.0.get(at + 1).cloned()
    {
        insert(items, at + 1, &["to", "get"], &item);
    }
}

/// `bot visible` is visible.
fn visible(items: &mut Items, at: usize) {
    if robot(items, at)
        && items.text(at + 1) == "visible"
        && !items.marked(at + 1)
        && let Some(item) = items.0.get(at + 1).cloned()
    {
        insert(items, at + 1, &["is"], &item);
    }
}

/// Whether the word before this place ends a subject: `human 1`, `ped`, `nurse`.
fn subject(items: &Items, at: usize) -> bool {
    let Some(before) = at.checked_sub(1) else { return false };
    if items.marked(at) {
        return false;
    }
    let role = |k: usize| lexicon().roles.contains_key(items.stem(k)) && items.word(k).is_some_and(|word| !word.label);
    let number = items.word(before).is_some_and(|word| word.is_digits() && !word.label);
    let named = role(before) || number && before > 0 && role(before - 1);
    // `the robot asks the nurse to the side`
    let start = (0..=before).rev().find(|k| items.marked(*k)).unwrap_or(0);
    let acts = (start..before).any(|k| {
        let word = items.text(k);
        lexicon().verbs.contains(items.stem(k)) && !matches!(word, "when" | "if" | "both") || items.stem(k) == "robot"
    });
    named && !acts
}

/// `ped to the side` steps there; `ped 2 static` stands.
fn verbless(items: &mut Items, at: usize) {
    let Some(item) = items.0.get(at).cloned() else { return };
    let aside = match items.text(at) {
        "to" => {
            let from = at + 1 + usize::from(matches!(items.text(at + 1), "the" | "one" | "his" | "her"));
            matches!(items.text(from), "side" | "wall")
        }
        "aside" => true,
        "out" => items.text(at + 1) == "of" && (at + 2..at + 4).any(|k| matches!(items.text(k), "way" | "path")),
        _ => false,
    };
    let after = subject(items, at);
    // `ped 2 behind bot`, `nurse ahead of bot`
    let beside = matches!(items.text(at), "behind" | "ahead" | "beside") && after && {
        let end = items.mark(at).min(items.0.len());
        let verbs = (at..end).any(|k| lexicon().verbs.contains(items.stem(k)));
        (at + 1..end).any(|k| robot(items, k) || items.stem(k) == "human") && !verbs
    };
    if beside {
        items.0.insert(at, Item::said("walks", &item));
        return;
    }
    if aside && after {
        items.0.insert(at, Item::said("steps", &item));
        return;
    }
    let alone = items.marked(at) && items.marked(at + 1) && !items.begins(at);
    // `steps left`
    let moves =
        at.checked_sub(1).is_some_and(|k| matches!(items.stem(k), "step" | "move" | "shift" | "swerve" | "dodge"));
    if matches!(items.text(at), "left" | "right") && moves && !items.marked(at) && items.marked(at + 1) {
        items.spend(at, at + 1);
        insert(items, at, &["to", "the", "side"], &item);
        return;
    }
    // `oncoming, group`
    if items.text(at) == "group" && alone {
        insert(items, at, &["in", "a"], &item);
        return;
    }
    let told = items.has(at, Mark::Colon) && at > 0 && lexicon().roles.contains_key(items.stem(at - 1));
    if items.text(at) == "static"
        && (after || alone || told)
        && let Some(word) = items.0.get_mut(at)
    {
        "stands".clone_into(&mut word.word.text);
        "stand".clone_into(&mut word.word.stem);
    }
}

/// Nouns of deeds, with their verbs.
const DEEDS: &[(&str, &str)] = &[
    ("stop", "stop"),
    ("stops", "stop"),
    ("halt", "stop"),
    ("pause", "stop"),
    ("look", "look"),
    ("looks", "look"),
    ("glance", "look"),
    ("glances", "look"),
    ("gaze", "look"),
    ("yield", "yield"),
    ("reaction", "react"),
    ("reactions", "react"),
    ("response", "react"),
    ("interaction", "react"),
    ("attention", "react"),
    ("talk", "talk"),
    ("follow", "follow"),
    ("block", "block"),
    ("blocking", "block"),
    ("wait", "wait"),
    ("evasion", "yield"),
    ("avoidance", "yield"),
    ("dodge", "yield"),
    ("deviation", "yield"),
    ("contact", "look"),
];

/// The verb of a denied deed.
fn verb(items: &Items, at: usize) -> Option<String> {
    let text = items.text(at);
    if let Some((_, verb)) = DEEDS.iter().find(|(noun, _)| *noun == text) {
        return Some((*verb).to_owned());
    }
    let word = items.word(at)?;
    (text.ends_with("ing") && lexicon().verbs.contains(&word.stem)).then(|| word.stem.clone())
}

/// `no stop, no look`: does not stop, does not look; `either one` says that nobody does.
fn denied(items: &mut Items, at: usize) {
    if items.text(at) != "no" || items.word(at).is_none_or(|word| word.label) {
        return;
    }
    let opens =
        items.marked(at) || matches!(items.text(at.wrapping_sub(1)), "and" | "or" | "but") || subject(items, at);
    // `no ped reaction`
    let people = lexicon().roles.contains_key(items.stem(at + 1)) && !items.marked(at + 1) && !items.marked(at + 2);
    let eye = matches!(items.text(at + 1), "eye" | "visual") && items.text(at + 2) == "contact";
    let of = at + 1 + usize::from(people || eye);
    if items.text(of) == "contact" && !eye {
        return;
    }
    let Some(verb) = verb(items, of).filter(|_| opens && !items.marked(of)) else { return };
    let Some(item) = items.0.get(at).cloned() else { return };
    let from = items.start(at);
    let end = items.end(at).min(items.0.len());
    let everybody = (from..end)
        .any(|k| matches!(items.text(k), "either" | "both" | "anyone" | "anybody" | "all") && !items.begins(k));
    let initial = |k: usize| {
        (from..k).all(|k| {
            items.text(k) == "no"
                || DEEDS.iter().any(|(_, verb)| *verb == items.text(k))
                || items.word(k).is_some_and(|word| word.used)
        })
    };
    let nobody = people || everybody && initial(at);
    let text: &[&str] = if nobody { &["nobody"] } else { &["does", "not"] };
    let mut words: Vec<Item> = text.iter().map(|text| Item::said(text, &item)).collect();
    let mut does = Item::said(&verb, items.0.get(of).unwrap_or(&item));
    // `no reaction for 5 s, then steps aside` is a reaction after 5 s.
    let then = (of + 1..of + 6).find(|k| items.text(*k) == "then" && items.marked(*k)).filter(|k| items.mark(of) == *k);
    let wait = then.filter(|_| verb == "react" && items.text(of + 1) == "for");
    if let Some(first) = words.first_mut() {
        (first.marks, first.arrow) = (item.marks, item.arrow);
    }
    does.word.to = items.word(of).map_or(does.word.to, |word| word.to);
    words.push(does);
    if let Some(then) = wait {
        if let Some(word) = items.0.get_mut(of + 1) {
            *word = Item::said("after", word).with(&[Mark::Comma]);
        }
        items.0.remove(then);
        if let Some(next) = items.0.get_mut(then) {
            next.marks.clear();
        }
    }
    let _old: Vec<Item> = items.0.splice(at..=of, words).collect();
}
