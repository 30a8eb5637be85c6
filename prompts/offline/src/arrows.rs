//! Arrows in notes: `bot <2m -> ped stops -> walks on`, where what stands first is a condition or the first of a row of deeds.

use crate::lexicon::lexicon;
use crate::notes::{Item, Items, Mark, robot};
use crate::words::Word;

/// Writes `when X, Y` and `X, then Y` for arrows.
pub(crate) fn arrows(items: Items) -> Items {
    let mut items = items;
    let mut at = 0;
    while at < items.0.len() {
        // `dist < 1.5 m: runs`
        let colon = items.has(at, Mark::Colon) && at > 0 && {
            let from = (0..at).rev().find(|k| items.marked(*k)).unwrap_or(0);
            matches!(condition(&items, from, at), Some(Condition::Distance | Condition::Contact | Condition::Time))
        };
        if colon || items.0.get(at).is_some_and(|item| item.arrow) {
            at = row(&mut items, at);
        } else {
            at += 1;
        }
    }
    items
}

/// Nouns for what a test ends in: nobody does it.
const RESULTS: &[&str] =
    &["collision", "contact", "deadlock", "crash", "timeout", "fail", "failure", "ok", "error", "success", "abort"];

/// Rewrites the row of arrows of which this is the first; says where to read on.
fn row(items: &mut Items, at: usize) -> usize {
    let end = items.end(at).min(items.0.len());
    // `-> collision w/ left bumper`
    if RESULTS.contains(&items.text(at)) {
        if let Some(item) = items.0.get_mut(at) {
            (item.arrow, item.marks) = (false, vec![Mark::Stop]);
        }
        items.label(at, end);
        return end;
    }
    let from = (0..at).rev().find(|k| items.marked(*k)).unwrap_or(0);
    let condition = condition(items, from, at);
    let plain = |items: &mut Items, k: usize, mark: Mark| {
        if let Some(item) = items.0.get_mut(k) {
            item.arrow = false;
            item.marks = vec![mark];
        }
    };
    let Some(condition) = condition else {
        // `walks out -> nods`
        plain(items, at, Mark::Comma);
        if items.text(at) != "then"
            && let Some(item) = items.0.get(at).cloned()
        {
            insert(items, at, &["then"], &item);
        }
        return at + 1;
    };
    plain(items, at, Mark::Comma);
    // Whose deed it is stands before the condition: `A: bot <2m -> stops`.
    let subject = subject(items, from);
    let own = speaks_of(items, at);
    let mut shift = 0;
    if let Some((first, last)) = subject.filter(|_| condition != Condition::Meets) {
        let moved: Vec<Item> = items.0.get(first..last).unwrap_or_default().to_vec();
        let marks = moved.first().map(|item| item.marks.clone()).unwrap_or_default();
        if let Some(item) = items.0.get_mut(last) {
            (item.marks, item.arrow) = (marks, false);
        }
        items.0.drain(first..last);
        shift = last - first;
        if !own && let Some(next) = items.0.get(at - shift).cloned() {
            let words: Vec<String> = moved.iter().map(|item| item.word.text.clone()).collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            insert(items, at - shift, &words, &next);
        }
        let from = first;
        return opened(items, from, condition).max(at - shift + 1);
    }
    // `when it sees the robot, nurse …`: who notices is who reacts.
    opened(items, from, condition).max(at - shift + 1)
}

/// Opens a clause with `when`, and mends what has no verb.
fn opened(items: &mut Items, from: usize, condition: Condition) -> usize {
    let Some(item) = items.0.get(from).cloned() else { return from };
    let opens = matches!(
        items.text(from),
        "when" | "if" | "once" | "as" | "after" | "until" | "upon" | "whenever" | "at" | "while"
    );
    let words: &[&str] = match condition {
        Condition::Contact => &["when", "robot", "is", "visible"],
        Condition::Distance if items.word(from).is_some_and(Word::is_digits) => &["when", "robot", "within"],
        Condition::Distance | Condition::Robot => &["when", "robot"],
        Condition::Said | Condition::Meets if opens => &[],
        Condition::Said | Condition::Meets => &["when"],
        Condition::Time if opens => &[],
        Condition::Time => &["after"],
    };
    insert(items, from, words, &item);
    if condition == Condition::Distance && items.text(from + words.len()) == "d" {
        items.spend(from + words.len(), from + words.len() + 1);
    }
    if condition == Condition::Contact {
        let first = from + words.len();
        items.spend(first, items.mark(first));
    }
    from
}

/// Puts words before a place; the first takes the marks of what stands there.
pub(crate) fn insert(items: &mut Items, at: usize, words: &[&str], model: &Item) {
    if words.is_empty() {
        return;
    }
    let mut said: Vec<Item> = words.iter().map(|text| Item::said(text, model)).collect();
    if let (Some(first), Some(next)) = (said.first_mut(), items.0.get_mut(at)) {
        (first.marks, first.arrow) = (std::mem::take(&mut next.marks), std::mem::take(&mut next.arrow));
    }
    let _none: Vec<Item> = items.0.splice(at..at, said).collect();
}

/// What somebody waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Condition {
    /// The robot does or is something, or somebody else does.
    Said,
    /// Somebody notices the robot.
    Meets,
    /// `visual contact`.
    Contact,
    /// `robot behind them, says EXCUSE_ME`: the robot does what stands after a comma.
    Robot,
    /// `dist <1.5m`.
    Distance,
    /// `+6s`.
    Time,
}

/// What a stretch waits for, if it is no deed.
fn condition(items: &Items, from: usize, to: usize) -> Option<Condition> {
    let person = subject(items, from);
    let start = person.map_or(from, |(_, last)| last);
    let has = |words: &[&str]| (start..to).any(|k| words.contains(&items.text(k)) || words.contains(&items.stem(k)));
    let length = has(&["m", "meter", "metre", "cm", "centimeter"]);
    let time = has(&["s", "second", "sec", "minute", "min"]);
    if has(&["contact"]) && has(&["visual", "eye"]) || has(&["los"]) {
        return Some(Condition::Contact);
    }
    if matches!(items.text(start), "when" | "if" | "once" | "as" | "until" | "upon" | "whenever") {
        return Some(Condition::Said);
    }
    if robot(items, start) || matches!(items.text(start), "the" | "a") && robot(items, start + 1) {
        return Some(Condition::Said);
    }
    if matches!(items.stem(start), "door" | "elevator" | "lift") && (start..to).any(|k| items.stem(k) == "open") {
        return Some(Condition::Said);
    }
    let alone = items.word(start).is_some_and(Word::is_digits) && to - start <= 2;
    if length && alone {
        return Some(Condition::Distance);
    }
    let head = items.start(from);
    let says = matches!(
        items.stem(start),
        "say" | "ask" | "signal" | "stop" | "move" | "beep" | "wait" | "gesture" | "announce"
    );
    if says && from > head && robot(items, head) && person.is_none() && items.has(from, Mark::Comma) {
        return Some(Condition::Robot);
    }
    if length && (matches!(items.text(start), "distance" | "within" | "at" | "d" | "range" | "gap")) {
        return Some(Condition::Distance);
    }
    if time && matches!(items.text(start), "after" | "t") && person.is_none() {
        return Some(Condition::Time);
    }
    let sees = (start..to).any(|k| matches!(items.stem(k), "see" | "notice" | "spot" | "detect" | "hear"));
    let at_robot = (start..to).any(|k| items.stem(k) == "robot");
    if sees
        && (at_robot || to - start == 1)
        && person.is_some()
        && items.0.get(start).is_some_and(|item| item.marks.is_empty())
    {
        return Some(Condition::Meets);
    }
    // `A waves -> B goes`
    let other = subject(items, to);
    let (Some((first, last)), Some((next, end))) = (person, other) else { return None };
    let words = |from: usize, to: usize| (from..to).map(|k| items.text(k).to_owned()).collect::<Vec<String>>();
    let does = (start..to).any(|k| lexicon().verbs.contains(items.stem(k)));
    (does && words(first, last) != words(next, end)).then_some(Condition::Meets)
}

/// The people named right here, up to where the rest begins: `human 1 and human 2`, `nurse`.
fn subject(items: &Items, from: usize) -> Option<(usize, usize)> {
    let run = items.run(from);
    let run_from = 0;
    let mut end = None;
    let mut at = run_from;
    for mention in crate::mention::mentions(&run) {
        if mention.from != at {
            break;
        }
        end = Some(from + mention.to + 1);
        at = mention.to + 1;
        if run.get(at).is_some_and(|word| word.text == "and") {
            at += 1;
        } else {
            break;
        }
    }
    end.map(|end| (from, end))
}

/// Whether the stretch names who does it.
fn speaks_of(items: &Items, at: usize) -> bool {
    subject(items, at).is_some() || robot(items, at) || matches!(items.text(at), "then" | "both" | "all")
}
