//! Labels of people in notes: `ped A (employee): head-on`, `actor 1 = patient`, `P1+P2 = workers`, `#1 oncoming`.
//!
//! Who is told by a label is spoken of as `human 1` from there on; a sentence before the first label says how many there are
//! and what each is.

use std::collections::BTreeMap;

use crate::labels::{GENERIC, Key, Labels, listed, role};
use crate::lexicon::lexicon;
use crate::mention::{Who, mentions};
use crate::notes::{Item, Items, Mark};
use crate::noun::{noun, plural};
use crate::words::Word;

/// Rewrites labels; a text without any stays as it is.
pub(crate) fn actors(items: Items) -> Items {
    let items = listed_roles(generic_roles(items));
    let labels = Labels::of(items);
    let keys = labels.keys();
    if keys.is_empty() {
        return labels.items;
    }
    let mut written = Written { keys, roles: BTreeMap::new(), out: Vec::new(), first: None, marks: None };
    labels.write(&mut written);
    written.finish()
}

/// `1 ped (cleaner)` is one cleaner.
fn generic_roles(items: Items) -> Items {
    let mut items = items;
    let mut at = 0;
    while at + 1 < items.0.len() {
        let generic = lexicon().roles.get(items.stem(at)).is_some_and(|role| role.generic)
            && items.word(at).is_some_and(|word| !word.label);
        // `peds: 2 (employees)`
        let counted = generic
            && items.word(at + 1).is_some_and(|word| word.is_digits() && word.count().is_some())
            && items.0.get(at + 1).is_some_and(|item| item.equals() || item.marks == [Mark::Colon])
            && items.0.get(at + 2).is_some_and(|item| item.opens() && !item.closes());
        if counted
            && let Some((name, end)) = role(&items, at + 2)
            && !name.is_empty()
            && items.0.get(end).is_none_or(Item::closes)
        {
            let marks = items.0.get(at).map(|item| item.marks.clone()).unwrap_or_default();
            if let Some(item) = items.0.get_mut(at + 1) {
                (item.marks, item.gap) = (marks, String::new());
            }
            if let Some(item) = items.0.get_mut(at + 2) {
                (item.marks, item.gap) = (Vec::new(), " ".to_owned());
            }
            let _generic = items.0.remove(at);
            continue;
        }
        let opens = items.0.get(at + 1).is_some_and(|item| item.opens() && !item.closes());
        if generic
            && opens
            && let Some((role, end)) = role(&items, at + 1)
        {
            let closes = items.0.get(end).is_none_or(Item::closes);
            if closes && !role.is_empty() && !items.has(end, Mark::Colon) || closes && end >= items.0.len() {
                let marks = items.0.get(at).map(|item| item.marks.clone()).unwrap_or_default();
                let gap = items.0.get(at).map(|item| item.gap.clone()).unwrap_or_default();
                if let Some(item) = items.0.get_mut(at + 1) {
                    (item.marks, item.gap) = (marks, gap);
                }
                // The closing bracket is no pause.
                if let Some(item) =
                    items.0.get_mut(end).filter(|item| item.marks == [Mark::Comma] && !item.gap.contains(','))
                {
                    item.marks.clear();
                }
                let _generic = items.0.remove(at);
            }
        }
        at += 1;
    }
    items
}

/// `roles: doctor + visitor` are two people.
fn listed_roles(mut items: Items) -> Items {
    let heads = |k: &usize| matches!(items.text(*k), "role" | "roles" | "cast") && items.begins(*k);
    let Some(at) = (0..items.0.len()).find(heads) else { return items };
    let end = items.end(at).min(items.0.len());
    let (mut roles, mut k) = (Vec::new(), at + 1);
    while k < end {
        let Some((name, to)) = role(&items, k) else { break };
        roles.push(name);
        k = to + usize::from(items.text(to) == "and");
    }
    if roles.len() < 2 || k < end {
        return items;
    }
    let count = u32::try_from(roles.len()).unwrap_or(u32::MAX);
    // `human_count 2`
    for k in 0..at {
        let counts = items.word(k).and_then(Word::count) == Some(count);
        let generic = |back: usize| k.checked_sub(back).is_some_and(|k| GENERIC.contains(&items.stem(k)));
        let from = if generic(1) {
            Some(k - 1)
        } else if generic(2) && matches!(items.text(k - 1), "count" | "number") {
            Some(k - 2)
        } else {
            None
        };
        if counts && let Some(from) = from {
            items.spend(from, k + 1);
        }
    }
    let Some(first) = items.0.get(at).cloned() else { return items };
    let mut people = Item::said("people", &first);
    people.word.made_of = roles;
    let number = Item::said(&count.to_string(), &first).with(&first.marks);
    let _old: Vec<Item> = items.0.splice(at..end, [number, people]).collect();
    items
}

/// The text as it is written anew.
struct Written {
    keys: BTreeMap<Key, u32>,
    roles: BTreeMap<u32, String>,
    out: Vec<Item>,
    /// The word at which the first label stands.
    first: Option<usize>,
    /// Marks that the next word gets instead of its own.
    marks: Option<Vec<Mark>>,
}

impl Written {
    fn numbers(&self, keys: &[Key]) -> Vec<u32> {
        keys.iter().filter_map(|key| self.keys.get(key).copied()).collect()
    }

    fn define(&mut self, numbers: &[u32], role: &str) {
        for number in numbers {
            if self.roles.get(number).is_none_or(String::is_empty) {
                self.roles.insert(*number, role.to_owned());
            }
        }
    }

    fn push(&mut self, item: &Item) {
        let mut item = item.clone();
        if let Some(marks) = self.marks.take() {
            item.marks = marks;
        }
        self.out.push(item);
    }

    /// `human 1 and human 2`, with the marks of what stood there.
    fn speak(&mut self, numbers: &[u32], at: &Item) {
        if self.out.last().is_some_and(|last| last.word.text == "the") && at.marks.is_empty() {
            self.out.pop();
        }
        let mut words = spoken(numbers, at);
        if let Some(first) = words.first_mut() {
            first.marks = self.marks.take().unwrap_or_else(|| at.marks.clone());
            (first.arrow, first.gap) = (at.arrow, at.gap.clone());
        }
        self.out.extend(words);
    }
}

/// `human 1 and human 2` at the place of a word.
fn spoken(numbers: &[u32], at: &Item) -> Vec<Item> {
    let mut words = Vec::new();
    for number in numbers {
        if !words.is_empty() {
            words.push(Item::said("and", at));
        }
        words.push(Item::said("human", at));
        words.push(Item::said(&number.to_string(), at));
    }
    words
}

impl Labels {
    fn write(&self, written: &mut Written) {
        let mut k = 0;
        while let Some(item) = self.items.0.get(k) {
            // `(1) doctor - same direction`
            if self.listed
                && let (Some(number), Some((name, end))) = (listed(&item.gap), role(&self.items, k))
            {
                let numbers = written.numbers(&[Key::Number(number)]);
                written.first.get_or_insert(written.out.len());
                written.define(&numbers, &name);
                written.speak(&numbers, item);
                written.marks = (!self.items.begins(end)).then(Vec::new);
                k = end;
            } else if let Some((keys, end)) = self.list(k) {
                written.first.get_or_insert(written.out.len());
                let numbers = written.numbers(&keys);
                k = self.label(written, &numbers, k, end);
            } else {
                written.push(item);
                k += 1;
            }
        }
    }

    /// Writes a list of labels, with what defines it; says where to read on.
    fn label(&self, written: &mut Written, numbers: &[u32], at: usize, end: usize) -> usize {
        let items = &self.items;
        let Some(item) = items.0.get(at) else { return end };
        let next = items.0.get(end);
        // `worker A`
        if end >= at + 2 && (self.letter(end - 1).is_some() && self.role_before(end - 1) || self.named(end - 1)) {
            let named = items.stem(end - 2);
            if lexicon().roles.get(named).is_some_and(|role| !role.generic) {
                written.define(numbers, named);
            }
        }
        // `guard (actor 1)`, `two dockers (actor 1, actor 2)`, `grp (A, B, C)`
        let inside = item.opens() && !item.closes() && next.is_none_or(Item::closes);
        if inside && written.inside(numbers, item) {
            let comma = next.is_some_and(|next| next.gap.contains(','));
            written.marks = (!items.begins(end)).then(|| if comma { vec![Mark::Comma] } else { Vec::new() });
            // `+ D`
            let more = (items.text(end) == "and").then(|| self.list(end + 1)).flatten();
            return match more.filter(|(_, to)| items.marked(*to)) {
                Some((_, to)) => {
                    written.marks = None;
                    to
                }
                None => end,
            };
        }
        if inside && written.out.last().is_some_and(|last| last.word.stem == "group") {
            return end;
        }
        let equal = next.is_some_and(Item::equals);
        let colon = items.has(end, Mark::Colon);
        if let Some((role, to)) = role(items, end) {
            let closes = items.marked(to);
            let gap = next.map_or("", |next| next.gap.as_str());
            let article = matches!(items.text(end), "a" | "an" | "both" | "all") || gap.contains(['-', '–', '—']);
            let apposed = items.has(end, Mark::Comma) && closes && article;
            let paren = next.is_some_and(Item::opens)
                && items.0.get(to).is_none_or(|item| item.closes() || item.gap.contains(','));
            let beside = gap == " " && closes && self.letter(end - 1).is_some() && self.noun_follows(end - 1);
            if equal || colon || paren || apposed || beside {
                written.define(numbers, &role);
                return self.defined(written, numbers, at, to, paren);
            }
        }
        written.speak(numbers, item);
        if colon || equal {
            written.marks = (!items.begins(end)).then(Vec::new);
        }
        end
    }

    /// Writes on behind a definition: `P1+P2 = workers, cross`, `actor 1 = patient, actor 2 = nurse`.
    fn defined(&self, written: &mut Written, numbers: &[u32], at: usize, to: usize, paren: bool) -> usize {
        let items = &self.items;
        let Some(item) = items.0.get(at) else { return to };
        // `patient with walking frame`
        let mut end = to;
        let mut tail: Vec<Item> = Vec::new();
        if !items.marked(to) && items.text(to) == "with" {
            end = items.mark(to).min(items.0.len());
            tail = items.0.get(to..end).unwrap_or_default().to_vec();
            if tail.iter().any(|item| item.word.stem == "robot") {
                (end, tail) = (to, Vec::new());
            }
            for item in &mut tail {
                item.word.label = true;
            }
        }
        let next = items.0.get(end);
        let another = self.list(end + usize::from(items.text(end) == "and")).is_some()
            || self.listed && next.is_some_and(|next| listed(&next.gap).is_some());
        if !paren && items.marked(end) && (items.begins(end) || another) {
            for item in &tail {
                written.push(item);
            }
            // A list of definitions is a sentence of its own.
            written.marks = Some(vec![Mark::Stop]);
            return end;
        }
        written.speak(numbers, item);
        for item in &tail {
            written.push(item);
        }
        let listed = another && next.is_some_and(|next| next.gap.contains(','));
        written.marks = if items.begins(end) {
            None
        } else if listed {
            Some(vec![Mark::Comma])
        } else {
            Some(Vec::new())
        };
        end
    }
}

impl Written {
    /// Puts labels in brackets in the place of the noun before them: `a guard (actor 1)`.
    fn inside(&mut self, numbers: &[u32], at: &Item) -> bool {
        let from = self.out.iter().rposition(|item| !item.marks.is_empty() || item.arrow).unwrap_or(0);
        let run: Vec<Word> = self.out.get(from..).unwrap_or_default().iter().map(|item| item.word.clone()).collect();
        let grouped = run.last().is_some_and(|word| word.stem == "group");
        let mut banded = false;
        let people = if grouped {
            // `standing grp`
            let adjective =
                |word: &Word| lexicon().adjectives.contains(&word.text) || matches!(word.text.as_str(), "a" | "the");
            let first = run.iter().rev().skip(1).take_while(|word| adjective(word)).count();
            Some((run.len() - 1 - first, run.len() - 1))
        } else {
            let found = mentions(&run)
                .into_iter()
                .rev()
                .find(|mention| !matches!(mention.who, Who::Same | Who::All | Who::Number(_)));
            if let Some(role) = found.as_ref().and_then(|mention| mention.role.clone()) {
                self.define(numbers, &role);
            }
            banded = found.as_ref().is_some_and(|mention| mention.group);
            found.map(|mention| (mention.from, mention.to))
        };
        let Some((first, last)) = people else { return false };
        let (first, last) = (from + first, from + last);
        let mut words = spoken(numbers, self.out.get(first).unwrap_or(at));
        if grouped {
            words.extend(["stand", "in", "a", "group"].map(|text| Item::said(text, at)));
        }
        if banded {
            words.extend(["in", "a", "group"].map(|text| Item::said(text, at)));
        }
        if let (Some(new), Some(old)) = (words.first_mut(), self.out.get(first)) {
            (new.marks, new.arrow, new.gap) = (old.marks.clone(), old.arrow, old.gap.clone());
            // `4 peds = standing grp (A, B, C)`
            if old.equals() {
                new.marks = vec![Mark::Stop];
            }
        }
        let _old: Vec<Item> = self.out.splice(first..=last, words).collect();
        true
    }

    /// The text, with a sentence that says who is there.
    fn finish(mut self) -> Items {
        let count = self.keys.values().copied().max().unwrap_or(0);
        let total = self.total(count);
        if let Some((_, _, role)) = &total
            && !self.roles.values().all(String::is_empty)
        {
            let all: Vec<u32> = (1..=count).collect();
            let role = role.clone();
            self.define(&all, &role);
        }
        let known = self.roles.values().any(|role| !role.is_empty());
        if !known {
            return Items(self.out);
        }
        let first = self.first.unwrap_or(0).min(self.out.len().saturating_sub(1));
        if let Some((from, to, _)) = total {
            let does = self.out.get(to + 1).is_some_and(|next| {
                next.marks.is_empty() && !next.equals() && lexicon().verbs.contains(&next.word.stem)
            });
            if does && let Some(at) = self.out.get(from).cloned() {
                let mut words = spoken(&(1..=count).collect::<Vec<u32>>(), &at);
                if let Some(word) = words.first_mut() {
                    (word.marks, word.arrow) = (at.marks.clone(), at.arrow);
                }
                let _old: Vec<Item> = self.out.splice(from..=to, words).collect();
            } else {
                for item in self.out.iter_mut().take(to + 1).skip(from) {
                    (item.word.label, item.word.used) = (true, true);
                }
            }
        }
        let mut items = Items(self.out);
        let start = items.start(first);
        let Some(at) = items.0.get(start).cloned() else { return items };
        let roles = (1..=count).map(|number| self.roles.get(&number).cloned().unwrap_or_default()).collect();
        let mut people = Item::said(if count == 1 { "person" } else { "people" }, &at);
        people.word.made_of = roles;
        let mut marks = vec![Mark::Stop];
        if let Some(next) = items.0.get_mut(start) {
            std::mem::swap(&mut next.marks, &mut marks);
        }
        if !marks.contains(&Mark::Stop) {
            marks.push(Mark::Stop);
        }
        let number = Item::said(&count.to_string(), &at).with(&marks);
        let _none: Vec<Item> = items.0.splice(start..start, [number, people]).collect();
        items
    }

    /// Where so many people are named as there are labels, with their role: `3 peds`, `two workers`.
    fn total(&self, count: u32) -> Option<(usize, usize, String)> {
        (0..self.out.len()).find_map(|from| {
            let number = self.out.get(from)?;
            let counts = number.word.count() == Some(count) && !number.word.used;
            if !counts {
                return None;
            }
            // `n=2`
            let sample =
                from > 0 && number.equals() && self.out.get(from - 1).is_some_and(|item| item.word.text == "n");
            let near =
                |(k, item): &(usize, &Item)| *k == 0 || item.marks.is_empty() && !item.equals() && !item.word.used;
            let words = self.out.iter().skip(from + 1).take(4).enumerate().take_while(near);
            let run: Vec<Word> = words.map(|(_, item)| item.word.clone()).collect();
            let end = noun(&run, 0, lexicon());
            // `pedestrians: 2`
            let before = from.checked_sub(1).and_then(|k| self.out.get(k)).filter(|noun| {
                let given = number.equals() || number.marks == [Mark::Colon];
                given && plural(&noun.word) && lexicon().roles.contains_key(&noun.word.stem)
            });
            if let Some(noun) = before.filter(|_| self.out.get(from + 1).is_none_or(|next| !next.marks.is_empty())) {
                let role =
                    lexicon().roles.get(&noun.word.stem).filter(|role| !role.generic).map(|_| noun.word.stem.clone());
                return Some((from - 1, from, role.unwrap_or_default()));
            }
            let of = self.out.get(from + 1).is_some_and(|item| !item.marks.is_empty());
            match end.filter(|_| !of) {
                Some(end) => {
                    let word = run.get(end)?;
                    let role = lexicon().roles.get(&word.stem).filter(|role| !role.generic).map(|_| word.stem.clone());
                    Some((from, from + 1 + end, role.unwrap_or_default()))
                }
                None => sample.then(|| (from - 1, from, String::new())),
            }
        })
    }
}
