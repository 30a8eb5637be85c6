//! What people take back: `three, no, two people`, `two porters and a doctor – no, sorry, just one porter and the doctor`.

use crate::headings::described;
use crate::lexicon::lexicon;
use crate::words::Word;

/// Words with which people take back a number that they have just given.
const CORRECTS: &[&str] = &["no", "actually", "rather", "sorry", "correction"];

/// Words that stand between a number that is taken back and the one that holds; some of them take it back.
const BETWEEN: &[&str] = &[
    "wait", "or", "better", "make", "that", "it", "just", "only", "i", "mean", "meant", "hang", "on", "hmm", "well",
    "say", "should", "be", "strike", "scratch", "hold", "oops", "in", "fact", "now", "not", "is",
];

/// `Three nurses, no sorry, two, are standing there`, `six people, scratch that, three, stand`: the number that holds, where the
/// other one stood; `four packers and not three` are four.
fn recounted(mut words: Vec<Option<Word>>) -> Vec<Option<Word>> {
    let mut at = 1;
    while at < words.len() {
        let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
        let count = |k: usize| words.get(k).and_then(Option::as_ref).is_some_and(|word| word.count().is_some());
        let mark = |k: usize| words.get(k).is_some_and(Option::is_none);
        // `four packers and not three`
        let not = at + usize::from(text(at) == "and");
        let denied = (mark(at) || text(at) == "and") && text(not + usize::from(mark(at))) == "not";
        let number = not + 1 + usize::from(mark(at));
        let ends = |k: usize| k >= words.len() || mark(k);
        if denied && count(number) && ends(number + 1) && (0..at).any(count) {
            words.drain(at..=number);
            continue;
        }
        let takes_back = |k: usize| {
            CORRECTS.contains(&text(k))
                || matches!(text(k), "scratch" | "strike" | "better" | "oops" | "meant")
                || text(k) == "that" && text(k + 1) == "is" && mark(k + 2)
                || text(k) == "make" && matches!(text(k + 1), "that" | "it")
        };
        let opens = mark(at) || text(at) == "or";
        let skips = |k: usize| mark(k) || CORRECTS.contains(&text(k)) || BETWEEN.contains(&text(k));
        let next =
            (at..words.len()).find(|k| !skips(*k)).filter(|next| opens && count(*next) && (at..*next).any(takes_back));
        // `two take part, no one else`
        let next = next.filter(|next| !(text(*next) == "one" && text(next - 1) == "no"));
        let old = (at.saturating_sub(9)..at).rev().find(|k| count(*k));
        if let Some((next, old)) = next.zip(old) {
            let noun = |k: usize| {
                words.get(k).and_then(Option::as_ref).is_some_and(|word| {
                    lexicon().roles.contains_key(&word.stem) || lexicon().adjectives.contains(&word.text)
                })
            };
            // `three, no, two people`: what comes after says of whom.
            let bare = old + 1 == at;
            if !noun(next + 1) && (!bare || ends(next + 1)) {
                let number = words.get(next).cloned().flatten();
                // `people, maybe three, no, four, stand`: the mark parts what stood between marks before.
                let colon = words.get(next + 2).and_then(Option::as_ref).is_some_and(|word| word.after_colon);
                let close = usize::from(
                    (!bare || noun(next + 2)) && !colon && words.get(next + 1).is_some_and(Option::is_none),
                );
                if let Some(place) = words.get_mut(old) {
                    *place = number;
                }
                words.drain(at..next + 1 + close);
                continue;
            }
        }
        at += 1;
    }
    words
}

/// `Two porters and a doctor – no, sorry, just one porter and the doctor`: what stands behind, where nothing is told before.
fn taken_back(words: Vec<Option<Word>>) -> Vec<Option<Word>> {
    let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
    let corrects = |k: usize| CORRECTS.contains(&text(k));
    let told =
        |k: usize| words.get(k).and_then(Option::as_ref).is_some_and(|word| lexicon().verbs.contains(&word.stem));
    let Some(from) = (1..words.len()).find(|k| corrects(*k)) else { return words };
    let skips = |k: usize| {
        words.get(k).is_some_and(Option::is_none) || corrects(k) || matches!(text(k), "just" | "only" | "make" | "that")
    };
    let to = (from..words.len()).find(|k| !skips(*k)).unwrap_or(words.len());
    let counts = words.get(to).and_then(Option::as_ref).is_some_and(|word| word.count().is_some());
    let pairs = |range: std::ops::Range<usize>| range.clone().any(|k| text(k) == "and");
    if counts && pairs(0..from) && pairs(to..words.len()) && !(0..from).any(told) {
        return words.into_iter().skip(to).collect();
    }
    words
}

/// A sentence with its corrections made (`three, no, two people` are two), and with `left` told from `left`.
pub(crate) fn settled(words: Vec<Option<Word>>) -> Vec<Option<Word>> {
    let words = taken_back(recounted(words));
    let count = |item: &Option<Word>| item.as_ref().is_some_and(|word| word.count().is_some());
    let mut out: Vec<Option<Word>> = Vec::with_capacity(words.len());
    let mut i = 0;
    while let Some(item) = words.get(i) {
        // A number, at most two words, then a correction and another number.
        let taken_back = count(item).then(|| {
            let corrects = |k: &usize| {
                words.get(*k).and_then(Option::as_ref).is_some_and(|word| CORRECTS.contains(&word.text.as_str()))
            };
            let at = (i + 2..i + 6).find(corrects)?;
            let paused = words.get(i + 1..at)?.iter().any(|item| item.as_ref().is_none_or(|word| word.text == "or"));
            let nobody = |k: usize| {
                let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
                text(k) == "one" && text(k - 1) == "no"
            };
            (at + 1..at + 7).find(|k| words.get(*k).is_some_and(count)).filter(|k| paused && !nobody(*k))
        });
        if let Some(next) = taken_back.flatten() {
            i = next;
            // `two — no, three — visitors`: the dash after the number goes with what was taken back.
            let noun = words.get(next + 2).and_then(Option::as_ref);
            if words.get(next + 1).is_some_and(Option::is_none)
                && noun.is_some_and(|word| lexicon().roles.contains_key(&word.stem))
            {
                out.extend(words.get(next).cloned());
                i = next + 2;
            }
            continue;
        }
        // `three people stand there - no, make that four`
        let word = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
        let made = word(i) == "make" && matches!(word(i + 1), "that" | "it") && words.get(i + 2).is_some_and(count);
        if let Some(at) = out.iter().rposition(count).filter(|_| made) {
            if let (Some(place), Some(number)) = (out.get_mut(at), words.get(i + 2)) {
                place.clone_from(number);
            }
            let idle = |item: &Option<Word>| item.as_ref().is_none_or(|word| CORRECTS.contains(&word.text.as_str()));
            while out.last().is_some_and(idle) {
                out.pop();
            }
            i += 3;
            continue;
        }
        // `three people stand there, plus two people …`
        if word(i) == "plus" && words.get(i + 1).is_some_and(count) {
            out.extend(words.get(i + 1).cloned());
            let more = words.get(i).cloned().flatten().map(|word| Word {
                text: "more".to_owned(),
                stem: "more".to_owned(),
                ..word
            });
            out.push(more);
            i += 2;
            continue;
        }
        // `towards the robot, which asks him to wait`
        let robot =
            out.len().checked_sub(2).and_then(|k| out.get(k)).cloned().flatten().filter(|word| word.stem == "robot");
        // `asks him to follow it, which he does`
        let his = matches!(word(i + 1), "he" | "she" | "they" | "both" | "all");
        if let (Some(robot), "which", true, false) = (robot, word(i), out.last().is_some_and(Option::is_none), his) {
            out.push(Some(robot));
            i += 1;
            continue;
        }
        let mut item = item.clone();
        let before = out.last().and_then(Option::as_ref).map_or("", |word| word.text.as_str());
        if let Some(word) = &mut item
            && word.text == "left"
            && ((i + 1..i + 5).any(|k| words.get(k).and_then(Option::as_ref).is_some_and(|next| next.text == "right"))
                || words
                    .get(i + 1)
                    .and_then(Option::as_ref)
                    .is_some_and(|next| matches!(next.text.as_str(), "one" | "hand" | "side"))
                || matches!(
                    before,
                    "the"
                        | "on"
                        | "to"
                        | "its"
                        | "his"
                        | "her"
                        | "their"
                        | "from"
                        | "far"
                        | "turn"
                        | "turns"
                        | "turned"
                        | "turning"
                        | "keep"
                        | "keeps"
                        | "look"
                        | "looks"
                        | "bear"
                        | "veers"
                ))
        {
            // The side, nobody who leaves.
            word.stem = "left".to_owned();
        }
        out.push(item);
        i += 1;
    }
    described(&mut out);
    out
}
