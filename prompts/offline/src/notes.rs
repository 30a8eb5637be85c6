//! Notes as test engineers write them: `ped A (nurse): bot @ 3m -> stops`, before they are cut into clauses.
//!
//! ```text
//! pieces ─► items ─► shorthand ─► actors ─► ends ─► arrows ─► pieces
//! ```
//!
//! Nothing is read here: notes are only written out as sentences, and what says nothing of people is made nobody's.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, word};

/// A mark between words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    Comma,
    Colon,
    Stop,
}

/// A word with what stands right before it.
#[derive(Debug, Clone)]
pub(crate) struct Item {
    pub(crate) marks: Vec<Mark>,
    /// The text between the word before and this one.
    pub(crate) gap: String,
    /// `->`, `=>`, `→`.
    pub(crate) arrow: bool,
    pub(crate) word: Word,
}

impl Item {
    /// A word that nobody wrote, at the place of another.
    pub(crate) fn said(text: &str, at: &Item) -> Self {
        let word = Word { used: true, ..word(text.to_owned(), at.word.from, at.word.from) };
        Self { marks: Vec::new(), gap: String::new(), arrow: false, word }
    }

    pub(crate) fn with(mut self, marks: &[Mark]) -> Self {
        self.marks = marks.to_vec();
        self
    }

    pub(crate) fn equals(&self) -> bool {
        self.gap.contains('=') && !self.arrow && !self.gap.contains(['<', '>'])
    }

    pub(crate) fn opens(&self) -> bool {
        self.gap.contains(['(', '['])
    }

    pub(crate) fn closes(&self) -> bool {
        self.gap.contains([')', ']'])
    }
}

/// The words of a text with what stands between them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Items(pub(crate) Vec<Item>);

impl Items {
    pub(crate) fn text(&self, at: usize) -> &str {
        self.0.get(at).map_or("", |item| item.word.text.as_str())
    }

    pub(crate) fn stem(&self, at: usize) -> &str {
        self.0.get(at).map_or("", |item| item.word.stem.as_str())
    }

    pub(crate) fn word(&self, at: usize) -> Option<&Word> {
        self.0.get(at).map(|item| &item.word)
    }

    /// Whether a mark stands before this place; none stands before nothing but the end.
    pub(crate) fn marked(&self, at: usize) -> bool {
        at == 0 || self.0.get(at).is_none_or(|item| !item.marks.is_empty() || item.arrow)
    }

    pub(crate) fn has(&self, at: usize, mark: Mark) -> bool {
        self.0.get(at).is_some_and(|item| item.marks.contains(&mark))
    }

    /// Whether a sentence begins here.
    pub(crate) fn begins(&self, at: usize) -> bool {
        at == 0 || at >= self.0.len() || self.has(at, Mark::Stop)
    }

    /// Where the sentence that holds this place begins.
    pub(crate) fn start(&self, at: usize) -> usize {
        (0..=at).rev().find(|k| self.begins(*k)).unwrap_or(0)
    }

    /// Where the next sentence begins.
    pub(crate) fn end(&self, at: usize) -> usize {
        (at + 1..).find(|k| self.begins(*k)).unwrap_or(at + 1)
    }

    /// Where the next mark stands.
    pub(crate) fn mark(&self, at: usize) -> usize {
        (at + 1..).find(|k| self.marked(*k)).unwrap_or(at + 1)
    }

    /// The words from here to the next mark.
    pub(crate) fn run(&self, at: usize) -> Vec<Word> {
        self.0
            .get(at..self.mark(at).min(self.0.len()))
            .unwrap_or_default()
            .iter()
            .map(|item| item.word.clone())
            .collect()
    }

    /// Makes words nobody's whose meaning is told otherwise.
    pub(crate) fn spend(&mut self, from: usize, to: usize) {
        for item in self.0.iter_mut().take(to).skip(from) {
            (item.word.label, item.word.used) = (true, true);
        }
    }

    /// Makes words nobody's; they are reported as not understood.
    pub(crate) fn label(&mut self, from: usize, to: usize) {
        for item in self.0.iter_mut().take(to).skip(from) {
            item.word.label = true;
        }
    }
}

/// Writes notes out; other texts stay as they are.
pub(crate) fn notes(text: &str, pieces: Vec<Piece>) -> Vec<Piece> {
    let (items, tail) = itemized(text, pieces);
    let mut items = shorthand(steps(items));
    crate::terse::numbered(&mut items);
    let items = crate::terse::located(items);
    let items = crate::actors::actors(items);
    let items = triggers(ends(items));
    let mut items = crate::arrows::arrows(items);
    aims(&mut items);
    let items = crate::terse::terse(items);
    let mut out = Vec::with_capacity(items.0.len() * 2);
    for item in items.0 {
        if item.arrow && item.marks.is_empty() {
            out.push(Piece::Comma);
        }
        out.extend(item.marks.into_iter().map(piece));
        out.push(Piece::Word(item.word));
    }
    out.extend(tail.into_iter().map(piece));
    out
}

/// Pieces as a line of text: words in lower case, those of nobody in brackets.
#[cfg(test)]
pub(crate) fn written(pieces: &[Piece]) -> String {
    let mut line = String::new();
    for piece in pieces {
        match piece {
            Piece::Word(word) if word.label => line.push_str(&format!(" [{}]", word.text)),
            Piece::Word(word) if !word.made_of.is_empty() => {
                line.push_str(&format!(" {}({})", word.text, word.made_of.join(" ")));
            }
            Piece::Word(word) => line.push_str(&format!(" {}", word.text)),
            Piece::Comma => line.push(','),
            Piece::Colon => line.push(':'),
            Piece::Stop => line.push('.'),
        }
    }
    line.trim_start_matches(['.', ' ']).to_owned()
}

fn piece(mark: Mark) -> Piece {
    match mark {
        Mark::Comma => Piece::Comma,
        Mark::Colon => Piece::Colon,
        Mark::Stop => Piece::Stop,
    }
}

fn itemized(text: &str, pieces: Vec<Piece>) -> (Items, Vec<Mark>) {
    let (mut items, mut marks, mut last) = (Vec::new(), Vec::new(), 0);
    for piece in pieces {
        match piece {
            Piece::Word(word) => {
                let gap = text.get(last..word.from).unwrap_or_default().to_owned();
                let arrow = ["->", "=>", "→", "⇒", "➔"].iter().any(|sign| gap.contains(sign));
                if arrow {
                    marks.retain(|mark| *mark != Mark::Comma);
                }
                // `\n- ped 2: crossing`
                let line = gap.rsplit_once('\n').map(|(_, line)| line.trim_start());
                if line.is_some_and(|line| line.starts_with(['-', '*', '•', '·'])) && !marks.contains(&Mark::Stop) {
                    marks = vec![Mark::Stop];
                }
                last = word.to;
                items.push(Item { marks: std::mem::take(&mut marks), gap, arrow, word });
            }
            Piece::Comma => marks.push(Mark::Comma),
            Piece::Colon => marks.push(Mark::Colon),
            Piece::Stop => marks.push(Mark::Stop),
        }
    }
    let mut items = Items(items);
    for k in 1..items.0.len() {
        // `\nped 2: crossing`
        let line = items.0.get(k).is_some_and(|item| item.gap.contains('\n') && !item.arrow);
        let colon = (k + 1..k + 4).find(|next| items.marked(*next)).is_some_and(|next| items.has(next, Mark::Colon));
        if line
            && colon
            && !items.has(k, Mark::Stop)
            && let Some(item) = items.0.get_mut(k)
        {
            item.marks = vec![Mark::Stop];
        }
    }
    (items, marks)
}

/// Short forms of words.
const SHORT: &[(&str, &[&str])] = &[
    ("rm", &["room"]),
    ("grp", &["group"]),
    ("dir", &["direction"]),
    ("thru", &["through"]),
    ("dist", &["distance"]),
    ("opp", &["opposite"]),
    ("perp", &["perpendicular"]),
    ("behav", &["behavior"]),
    ("intersec", &["intersection"]),
    ("elev", &["elevator"]),
    ("loc", &["location"]),
    ("cond", &["condition"]),
    ("actor", &["human"]),
    ("actors", &["humans"]),
    ("ack", &["acknowledges"]),
    ("emp", &["employee"]),
    ("frontal", &["head", "on"]),
    ("frontally", &["head", "on"]),
];

/// Words before a number that names a version or a place.
const NAMES: &[&str] = &[
    "rev", "build", "version", "ver", "v", "tc", "scn", "reg", "id", "map", "sw", "fw", "release", "timeout", "speed",
    "seed", "firmware", "revision", "sprint",
];

/// `1) the doctor comes out 2) he waits`: a sentence for each.
fn steps(mut items: Items) -> Items {
    let mut open = false;
    for k in 0..items.0.len() {
        let Some(item) = items.0.get(k) else { break };
        open = item.opens() || open && !item.closes();
        let step = !open && item.word.is_digits() && item.word.text.len() <= 2 && !item.word.label;
        if step && items.0.get(k + 1).is_some_and(|next| next.gap.starts_with(')')) {
            for item in items.0.iter_mut().take(k + 2).skip(k) {
                item.marks = vec![Mark::Stop];
            }
            items.spend(k, k + 1);
        }
    }
    items
}

/// Signs and short forms as words.
fn shorthand(items: Items) -> Items {
    let mut out: Vec<Item> = Vec::with_capacity(items.0.len());
    let mut skip = 0;
    for (k, item) in items.0.iter().enumerate() {
        if skip > 0 {
            skip -= 1;
            continue;
        }
        let mut item = item.clone();
        let next = items.0.get(k + 1);
        let before = out.last().map_or("", |item| item.word.text.as_str()).to_owned();
        // `L->R` is from the left.
        let way = next.filter(|next| next.arrow || next.word.text == "to").and_then(|next| {
            let to = if next.arrow { next } else { items.0.get(k + 2)? };
            let side = side_of(&item)?;
            (Some(side) != side_of(to) && side_of(to).is_some()).then_some((side, usize::from(!next.arrow)))
        });
        if let Some((side, more)) = way {
            let marks = std::mem::take(&mut item.marks);
            // `1 courier, L->R, 1.2 m/s`
            if marks.is_empty() {
                out.push(Item::said("from", &item));
            } else {
                let across = next.is_some_and(|next| next.word.text == "to");
                let crosses = Item::said(if across { "from" } else { "crosses" }, &item);
                out.push(crosses.with(&marks));
                out.extend((!across).then(|| Item::said("from", &item)));
            }
            out.push(Item::said("the", &item));
            out.push(Item::said(side, &item));
            skip = 1 + more;
            continue;
        }
        let digits = item.word.is_digits();
        // `4-way crossing`
        let word_at = |back: usize| items.0.get(k + back).map_or("", |item| item.word.text.as_str());
        if digits && word_at(1) == "way" && word_at(2) == "crossing" && next.is_some_and(|next| next.gap == "-") {
            item.word = Word { to: item.word.to, ..word("intersection".to_owned(), item.word.from, item.word.to) };
            out.push(item);
            skip = 2;
            continue;
        }
        // `2x employee`
        let of = next.is_some_and(|next| lexicon().roles.contains_key(&next.word.stem));
        if item.word.text == "x" && of && item.gap.is_empty() && out.last().is_some_and(|last| last.word.is_digits()) {
            continue;
        }
        let many = k > 1 && items.0.get(k - 1).is_some_and(|x| x.word.text == "x" && x.gap.is_empty());
        if many && before != "1" && item.word.text == item.word.stem && lexicon().roles.contains_key(&item.word.stem) {
            item.word.text.push('s');
        }
        // `w/ bot`, where the stroke is no end of a sentence.
        if before == "with" && item.gap.starts_with('/') {
            item.marks.clear();
            if item.word.text == "o" {
                if let Some(last) = out.last_mut() {
                    last.word = Word { from: last.word.from, to: item.word.to, ..word("without".to_owned(), 0, 0) };
                }
                continue;
            }
        }
        if item.word.text == "w" && next.is_some_and(|next| next.gap.starts_with('/')) {
            item.word = Word { from: item.word.from, to: item.word.to, ..word("with".to_owned(), 0, 0) };
        }
        // `map rev 7`, `dock-02`: the number names something.
        let named = NAMES.contains(&before.as_str()) && !item.gap.contains(['<', '>'])
            || item.gap == "-" && out.last().is_some_and(|last| !last.word.is_digits() && last.word.text.len() > 1);
        if digits && named && !lexicon().roles.contains_key(&lexicon().stem(&before)) {
            item.word.label = true;
        }
        let sign = if item.gap.contains('@') {
            Some("at")
        } else if item.gap.contains('&') {
            Some("and")
        } else if digits && item.gap.contains(['<', '≤']) {
            Some("within")
        } else if digits && item.gap.ends_with('+') && item.gap != "+" {
            Some("after")
        } else {
            None
        };
        if digits && !item.arrow && item.gap.contains('>') {
            item.marks.retain(|mark| *mark != Mark::Comma);
        }
        let marks = std::mem::take(&mut item.marks);
        let arrow = std::mem::take(&mut item.arrow);
        let first = out.len();
        out.extend(sign.filter(|sign| *sign != before).map(|sign| Item::said(sign, &item)));
        match SHORT.iter().find(|(short, _)| *short == item.word.text) {
            Some((_, [rest @ .., last])) => {
                out.extend(rest.iter().map(|text| Item::said(text, &item)));
                let word = word((*last).to_owned(), item.word.from, item.word.to);
                out.push(Item { word, ..item.clone() });
            }
            Some((_, [])) | None => out.push(item.clone()),
        }
        if let Some(opening) = out.get_mut(first) {
            (opening.marks, opening.arrow, opening.gap) = (marks, arrow, item.gap);
        }
    }
    Items(out)
}

fn side_of(item: &Item) -> Option<&'static str> {
    match item.word.text.as_str() {
        "l" | "left" => Some("left"),
        "r" | "right" => Some("right"),
        _ => None,
    }
}

/// Whether the words are the robot's name.
pub(crate) fn robot(items: &Items, at: usize) -> bool {
    items.stem(at) == "robot" && !matches!(items.text(at), "it" | "its" | "itself")
}

/// `robot goal: loading dock`, `goal = exit`, `bot start: corridor`: where the robot comes from and goes, in a sentence.
fn ends(mut items: Items) -> Items {
    let mut at = 0;
    while at < items.0.len() {
        let goal = matches!(items.text(at), "goal" | "destination" | "target");
        let from = at.checked_sub(1).filter(|k| robot(&items, *k)).unwrap_or(at);
        let first = items.marked(from);
        let next = at + 1;
        let given = items.has(next, Mark::Colon) || items.0.get(next).is_some_and(Item::equals);
        let to = items.mark(next).min(items.0.len());
        let placed = to > next && to - next <= 5 && place(&items, to - 1, next);
        let bare = !items.marked(next) && (from < at || items.has(from, Mark::Comma) || items.begins(from));
        if (goal || items.text(at) == "start") && first && placed && (given || bare) {
            let Some(item) = items.0.get(next).cloned() else { break };
            let said: &[&str] = if goal { &["robot", "goal", "be", "the"] } else { &["robot", "starts", "in", "the"] };
            let words = said.iter().map(|text| Item::said(text, &item));
            let mut words: Vec<Item> = words.collect();
            if let Some(first) = words.first_mut() {
                first.marks.push(Mark::Stop);
            }
            if let Some(item) = items.0.get_mut(next) {
                (item.marks, item.gap) = (Vec::new(), String::new());
            }
            if let Some(item) = items.0.get_mut(to) {
                item.marks = vec![Mark::Stop];
            }
            let count = words.len();
            let _old: Vec<Item> = items.0.splice(from..next, words).collect();
            at = from + count;
        }
        at += 1;
    }
    items
}

/// `trigger: robot within 1 m; reaction: the employee stops`: an arrow.
fn triggers(mut items: Items) -> Items {
    let mut at = 0;
    while at < items.0.len() {
        let cue = matches!(items.text(at), "trigger" | "cue" | "event" | "stimulus")
            && items.begins(at)
            && items.has(at + 1, Mark::Colon);
        let next = items.end(at);
        let answer = matches!(
            items.text(next),
            "reaction" | "response" | "action" | "effect" | "behavior" | "behaviour" | "then"
        );
        if cue && answer && items.has(next + 1, Mark::Colon) {
            if let Some(item) = items.0.get_mut(next + 1) {
                (item.arrow, item.marks) = (true, Vec::new());
            }
            items.0.remove(next);
            if let Some(item) = items.0.get_mut(at + 1) {
                item.marks = vec![Mark::Stop];
            }
            items.0.remove(at);
        }
        at += 1;
    }
    items
}

/// Whether the words up to this one name a place.
fn place(items: &Items, last: usize, first: usize) -> bool {
    (first..=last).any(|k| names_place(items, k))
}

/// Whether a word ends the name of a place.
pub(crate) fn names_place(items: &Items, at: usize) -> bool {
    let ends = |items_: &[crate::lexicon::Item]| matches!(items_.last(), Some(crate::lexicon::Item::Word(word)) if word == items.text(at));
    lexicon().places.iter().any(|place| ends(&place.items))
}

/// What opens a sentence that tells how a test is judged, with what must follow.
const AIMS: &[&str] = &[
    "expected",
    "expectation",
    "expect",
    "exp",
    "pass",
    "post",
    "result",
    "outcome",
    "verify",
    "assert",
    "metric",
    "metrics",
    "kpi",
    "t",
    "fail",
    "criterion",
    "criteria",
    "crit",
    "log",
    "note",
    "timeout",
    "success",
    "ok",
];

/// `expected: bot reaches goal`, `pass crit: bot thru in <20s`, `fail if bot speed > 0.3m/s`: nobody does it.
fn aims(items: &mut Items) {
    let mut at = 0;
    while at < items.0.len() {
        let end = items.end(at).min(items.0.len());
        let opens = AIMS.contains(&items.text(at));
        let colon = (at + 1..(at + 4).min(end)).find(|k| items.has(*k, Mark::Colon));
        let body = colon.or_else(|| (matches!(items.text(at + 1), "if" | "when")).then_some(at + 2));
        let measured =
            matches!(items.text(at), "log" | "timeout") || items.text(at) == "t" && items.text(at + 1) == "max";
        let person =
            |k: usize| lexicon().roles.contains_key(items.stem(k)) || lexicon().numbers.contains_key(items.text(k));
        let from = body.unwrap_or(at);
        let of_robot = robot(items, from) || items.text(from) == "no" || !(from..end).any(person);
        if opens && (body.is_some() || measured) && of_robot && !(from..end).any(person) {
            items.label(at, end);
        }
        at = end.max(at + 1);
    }
}
