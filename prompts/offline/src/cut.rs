//! Words into sentences and clauses.

use crate::apposed::apposed;
use crate::arrange::arranged;
use crate::asker::takes_part;
use crate::begins::begins;
use crate::called::called;
use crate::clock::clock;
use crate::headings::{labels, names, titled, totals};
use crate::interject::{interjected, no_wait, notions};
use crate::lexicon::lexicon;
use crate::mention::{Who, mentions};
use crate::notes::notes;
use crate::preamble::preamble;
use crate::retract::settled;
use crate::wording::reworded;
use crate::words::{Piece, Word, pieces, word};

/// How a clause is joined to the one before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joint {
    /// It opens the sentence.
    Opens,
    /// Comma, `but`, `so`, `because`, brackets.
    Comma,
    /// `and`.
    And,
    /// `then`.
    Then,
    /// `while`, `whereas`.
    While,
    /// `when`, `once`, `upon`, `if`, `as`, `after` …
    When,
    /// `until`.
    Until,
    /// `who`, `that`, `which`.
    Who,
    /// `whereupon`: on what was said just now.
    Said,
    /// `except`: of those just spoken of, not these.
    Except,
}

/// A clause: a stretch of words between two joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stretch {
    pub(crate) joint: Joint,
    /// Whether `and` stood before the joint: `…, and when it stops, …` looks ahead, not back.
    pub(crate) after_and: bool,
    pub(crate) words: Vec<Word>,
    /// What its first mention is also called: `the cleaner, a shy man, stands`.
    pub(crate) also: Vec<Word>,
}

impl Stretch {
    /// The words of the text that it spans.
    pub(crate) fn quote<'a>(&self, text: &'a str) -> &'a str {
        let from = self.words.iter().map(|word| word.from).min().unwrap_or(0);
        let to = self.words.iter().map(|word| word.to).max().unwrap_or(0);
        text.get(from..to).unwrap_or_default()
    }
}

/// Sentences, each as its clauses.
pub(crate) fn sentences(text: &str) -> Vec<Vec<Stretch>> {
    let mut found = Vec::new();
    let mut words: Vec<Option<Word>> = Vec::new();
    let mut colon = false;
    let mut pieces = pieces(text);
    no_wait(&mut pieces);
    let mut pieces = notes(text, pieces);
    totals(&mut pieces);
    clock(&mut pieces);
    interjected(&mut pieces);
    reworded(text, &mut pieces);
    notions(&mut pieces);
    let known = called(&mut pieces);
    names(&mut pieces, known);
    takes_part(&mut pieces);
    preamble(&mut pieces);
    for (at, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Word(word) => {
                words.push(Some(Word { after_colon: std::mem::take(&mut colon), ..word.clone() }));
            }
            Piece::Comma => words.push(None),
            Piece::Colon => {
                labels(&mut words);
                if states(&words) {
                    // `Robot stops: driver stops too.`
                    words.insert(0, Some(word("when".to_owned(), 0, 0)));
                    words.push(None);
                    continue;
                }
                // `Worker: "wait".`
                let own = !words.is_empty() && says_alone(&words, pieces.get(at + 1..).unwrap_or_default());
                words.push(own.then(|| word("says".to_owned(), 0, 0)));
                colon = !own;
            }
            Piece::Stop => {
                titled(&mut words);
                found.push(arranged(stretches(apposed(settled(std::mem::take(&mut words))))));
            }
        }
    }
    titled(&mut words);
    found.push(arranged(stretches(apposed(settled(words)))));
    found.retain(|sentence| !sentence.is_empty());
    introduced(found)
}

/// `He stops when he sees it. He is a technician.`, `Freezes as soon as he sees it: that is the porter who comes along`: who it is
/// stands before what he does.
fn introduced(mut found: Vec<Vec<Stretch>>) -> Vec<Vec<Stretch>> {
    let who = |stretches: &[Stretch]| -> (bool, bool) {
        let all: Vec<Who> =
            stretches.iter().flat_map(|stretch| mentions(&stretch.words)).map(|mention| mention.who).collect();
        let noun = |who: &Who| !matches!(who, Who::Same | Who::Object | Who::All | Who::Nobody);
        (all.iter().any(|who| matches!(who, Who::Same)), all.iter().any(noun))
    };
    // Within a sentence: what stands behind a colon.
    for sentence in &mut found {
        let colon = sentence.iter().position(|stretch| stretch.words.first().is_some_and(|word| word.after_colon));
        if let Some(colon) = colon {
            let (before, after) = sentence.split_at(colon);
            if who(before) == (true, false) && who(after).1 {
                sentence.rotate_left(colon);
                if let Some(first) = sentence.first_mut() {
                    first.joint = Joint::Opens;
                }
            }
        }
        if who(sentence).1 {
            break;
        }
    }
    let first = found.iter().position(|sentence| who(sentence).1);
    let told = found.iter().take(first.unwrap_or(0)).take_while(|sentence| who(sentence) == (true, false)).count();
    if let Some(first) = first.filter(|first| told > 0 && told == *first) {
        let who = found.remove(first);
        found.insert(0, who);
    }
    found
}

/// Whether somebody who is not the robot is all that stands before a colon, and a message all that stands behind it.
fn says_alone(words: &[Option<Word>], rest: &[Piece]) -> bool {
    let said: Vec<Word> = words.iter().flatten().cloned().collect();
    let who = mentions(&said);
    let alone =
        matches!(who.as_slice(), [only] if only.from == 0 && only.to + 1 == said.len()) && said.len() == words.len();
    let message: Vec<Word> =
        rest.iter().map_while(|piece| if let Piece::Word(word) = piece { Some(word.clone()) } else { None }).collect();
    alone
        && (1..=3).contains(&message.len())
        && !message.iter().any(|word| word.text != word.stem && word.text.ends_with('s'))
        && lexicon().gestures.iter().any(|phrase| {
            crate::words::find(&message, phrase, 0, false, &|_| true)
                .is_some_and(|at| at.first() == Some(&0) && at.last() == Some(&(message.len() - 1)))
        })
}

/// Whether a sentence so far says nothing but what the robot does: `robot stops`, `robot moving`.
fn states(words: &[Option<Word>]) -> bool {
    let said: Option<Vec<&Word>> = words.iter().map(Option::as_ref).collect();
    let said = said.map(|said| said.into_iter().skip_while(|word| word.text == "the").collect::<Vec<&Word>>());
    said.is_some_and(|said| match said.as_slice() {
        [robot, verb] | [robot, verb, _] => {
            robot.stem == "robot"
                && matches!(verb.stem.as_str(), "stop" | "move" | "drive" | "halt" | "wait" | "stand" | "start")
        }
        _ => false,
    })
}

/// Cuts a sentence (`None` is a comma) at its joints.
fn stretches(words: Vec<Option<Word>>) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    let mut open = Stretch { joint: Joint::Opens, after_and: false, words: Vec::new(), also: Vec::new() };
    let mut i = 0;
    let mut inner: Vec<usize> = Vec::new();
    while let Some(item) = words.get(i) {
        let (joint, took) = match item {
            None => (Some(Joint::Comma), 1),
            Some(_) => match joint_at(&words, i) {
                (None, _) if begins(&words, i, &open) => (Some(Joint::Comma), 0),
                joint => joint,
            },
        };
        if let Some(joint) = joint {
            let done =
                std::mem::replace(&mut open, Stretch { joint, after_and: false, words: Vec::new(), also: Vec::new() });
            // `…, and only once it has stopped does she look at it`
            let only = done.joint == Joint::And
                && joint == Joint::When
                && matches!(done.words.as_slice(), [word] if matches!(word.text.as_str(), "only" | "just"));
            // `a carer who, while the patient stands there, gestures …`
            if done.words.is_empty() && done.joint == Joint::Who && matches!(joint, Joint::While | Joint::When) {
                inner.push(found.len());
            }
            if done.words.is_empty() || only {
                open.after_and = done.after_and
                    || done.joint == Joint::And && joint != Joint::And
                    || done.joint == Joint::Then && joint == Joint::When;
                // `, and when`: the stronger joint stays; a sentence that opens with `when` is known by its index.
                if matches!(joint, Joint::Comma | Joint::And)
                    && !matches!(done.joint, Joint::Opens | Joint::Comma | Joint::And)
                {
                    open.joint = done.joint;
                }
            } else {
                found.push(done);
            }
            if took == 0 {
                open.words.extend(item.clone());
                i += 1;
            }
        } else {
            open.words.extend(item.clone());
        }
        i += took;
    }
    if !open.words.is_empty() {
        found.push(open);
    }
    for at in inner {
        let people = found.get(at).is_some_and(|inner| !mentions(&inner.words).is_empty());
        if let Some(rest) = found.get_mut(at + 1).filter(|rest| rest.joint == Joint::Comma) {
            rest.joint = Joint::Who;
            if people {
                found.swap(at, at + 1);
            }
        }
    }
    found
}

fn joint_at(words: &[Option<Word>], i: usize) -> (Option<Joint>, usize) {
    let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
    let stem = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.stem.as_str());
    let sees = |k: usize| matches!(stem(k), "see" | "notice" | "spot");
    let before = if i == 0 { "" } else { stem(i - 1) };
    let person = lexicon().roles.contains_key(before)
        || matches!(
            before,
            "one" | "other" | "two" | "three" | "four" | "pair" | "couple" | "group" | "family" | "team" | "crowd"
        );
    let digit = words.get(i + 1).and_then(Option::as_ref).is_some_and(|word| word.number().is_some());
    let said = |k: usize| matches!(stem(k), "signal" | "gesture" | "sign" | "request" | "command" | "call" | "cue");
    // `seeing the robot, …`, `having noticed it, …`
    let opens = i == 0 || words.get(i - 1).is_some_and(Option::is_none) || before == "and" || before == "then";
    let seeing = |k: usize| (sees(k) || stem(k) == "hear") && text(k).ends_with("ing");
    let counted = |k: usize| words.get(k).and_then(Option::as_ref).is_some_and(|word| word.count().is_some());
    let message =
        |verb: &str| matches!(verb, "signal" | "tell" | "indicate" | "show" | "gesture" | "announce" | "inform");
    match text(i) {
        "and" if text(i + 1) == "a" && text(i + 2) == "half" => (None, 1),
        "at" | "with" | "on"
            if matches!(text(i + 1), "that" | "this")
                && matches!(text(i + 2), "he" | "she" | "they" | "it" | "both") =>
        {
            (Some(Joint::Said), 2)
        }
        "having" if opens && matches!(stem(i + 1), "reach" | "arrive") => (Some(Joint::When), 1),
        // `up and down`, `back and forth` is one way of walking.
        "and" if matches!((before, text(i + 1)), ("up", "down") | ("back", "forth") | ("round", "round")) => (None, 1),
        "and" if meeting(words, i) || !before.is_empty() && before == text(i + 1) => (None, 1),
        "and" => (Some(Joint::And), 1),
        // `all but two`, `all except one`, `everyone save two`
        "but" | "except" | "save" if matches!(before, "all" | "everyone" | "everybody") && counted(i + 1) => (None, 1),
        // `all of them but the second`
        "but"
            if matches!(before, "them" | "everyone" | "everybody")
                && text(i + 1) == "the"
                && (i >= 3 && text(i - 3) == "all" || before != "them") =>
        {
            (Some(Joint::Except), 1)
        }
        // `all but the third step aside`; `all but runs` nearly does.
        "but"
            if before == "all"
                && matches!(text(i + 1), "the" | "a" | "an" | "her" | "his" | "him" | "human" | "for")
                && (!counted(i + 3) || text(i + 3) == "one") =>
        {
            (Some(Joint::Except), 1 + usize::from(text(i + 1) == "for"))
        }
        "but" if before == "all" => (None, 1),
        "except" | "apart" if matches!(text(i + 1), "for" | "from") => (Some(Joint::Except), 2),
        "besides" => (Some(Joint::Except), 1),
        "other" | "rather" if text(i + 1) == "than" && text(i.wrapping_sub(1)) != "each" && text(i) == "other" => {
            (Some(Joint::Except), 2)
        }
        "except" => (Some(Joint::Except), 1),
        "at" if text(i + 1) == "which" && matches!(text(i + 2), "point" | "moment") => (Some(Joint::Said), 3),
        "at" | "upon" if text(i + 1) == "which" && matches!(text(i + 2), "he" | "she" | "they" | "it") => {
            (Some(Joint::Said), 2)
        }
        "thereupon" if matches!(before, "who" | "which") => (None, 1),
        "whereupon" | "thereupon" => (Some(Joint::Said), 1),
        "only" if text(i + 1) == "then" => (Some(Joint::Said), 2),
        "in" if text(i + 1) == "which" && text(i + 2) == "case" => (Some(Joint::Said), 3),
        "in" if text(i + 1) == "that" && text(i + 2) == "case" => (Some(Joint::Then), 3),
        "not" if matches!(text(i + 1), "until" | "unless") => (Some(Joint::When), 2),
        // `an engineer, who thereupon follows it`
        "at" if text(i + 1) == "the" && matches!(text(i + 2), "moment" | "instant" | "sight" | "very") => {
            (Some(Joint::When), if text(i + 2) == "very" { 4 } else { 3 - usize::from(text(i + 2) == "sight") })
        }
        "at" if (text(i + 1) == "its" && said(i + 2)) || stem(i + 2) == "robot" && said(i + 3) => {
            (Some(Joint::When), 1)
        }
        "by" if text(i + 1) == "the" && text(i + 2) == "time" => (Some(Joint::When), 3),
        "the"
            if (matches!(text(i + 1), "moment" | "instant")
                || matches!(text(i + 1), "second" | "minute")
                    && (matches!(text(i + 2), "he" | "she" | "it" | "they") || stem(i + 3) == "robot"))
                && !matches!(before, "at" | "for" | "of" | "last" | "in" | "from" | "until")
                && words.get(i + 2).is_some_and(Option::is_some) =>
        {
            (Some(Joint::When), 2)
        }
        "as" | "so" if text(i + 1) == "long" && text(i + 2) == "as" => (Some(Joint::While), 3),
        "but" | "so" | "because" | "since" | "although" | "though" | "however" | "meanwhile" | "yet"
            if text(i) != "so"
                || !matches!(before, "do" | "say" | "tell" | "ask")
                    && !matches!(stem(i + 1), "do" | "be" | "that" | "will" | "slow" | "slowly" | "much") =>
        {
            (Some(Joint::Comma), 1)
        }
        "finally" | "lastly" if opens => (Some(Joint::Then), 1),
        "then" | "afterwards" | "afterward" | "subsequently" | "thereafter" => (Some(Joint::Then), 1),
        "while" | "whilst" | "whereas" if before != "a" && before != "short" && before != "long" => {
            (Some(Joint::While), 1)
        }
        "as" if text(i + 1) == "soon" => (Some(Joint::When), 3),
        "as" if matches!(text(i + 1), "they" | "he" | "she" | "it")
            || stem(i + 1) == "robot"
            || stem(i + 2) == "robot"
                && !matches!(before, "way" | "direction" | "time" | "pace" | "speed" | "moment" | "instant") =>
        {
            (Some(Joint::When), 1)
        }
        "each" | "every" | "any" if text(i + 1) == "time" => (Some(Joint::When), 2),
        "that" if i > 0 && sees(i - 1) && (stem(i + 1) == "robot" || stem(i + 2) == "robot") => (Some(Joint::Comma), 1),
        "when" | "whenever" | "upon" | "if" => (Some(Joint::When), 1),
        // `Should the robot say excuse me, …`
        "should" if i == 0 && (stem(1) == "robot" || stem(2) == "robot") => (Some(Joint::When), 1),
        "once" if opens || !text(i + 1).is_empty() && !before.is_empty() => (Some(Joint::When), 1),
        "on" | "after" if sees(i + 1) || stem(i + 1) == "hear" => (Some(Joint::When), 1),
        "on" if text(i + 1) == "request" && words.get(i + 2).is_none_or(Option::is_none) => (Some(Joint::When), 1),
        "on" if text(i + 1) == "being" => (Some(Joint::When), 1),
        "on" if matches!(text(i + 1), "this" | "that" | "the" | "his" | "her" | "its" | "their") && said(i + 2) => {
            (Some(Joint::When), 1)
        }
        "on" if stem(i + 2) == "robot"
            && matches!(stem(i + 3), "approach" | "arrival" | "appearance" | "request" | "signal") =>
        {
            (Some(Joint::When), 1)
        }
        "having" if opens && (sees(i + 1) || stem(i + 1) == "hear") => (Some(Joint::When), 1),
        _ if opens && seeing(i) => (Some(Joint::When), 0),
        "with"
            if opens
                && matches!(text(i + 1), "only" | "the" | "less" | "just")
                && (i..i + 8).any(|k| matches!(stem(k), "meter" | "centimeter")) =>
        {
            (Some(Joint::When), 1)
        }
        // `one after another`, `one after the other` is a manner.
        "after"
            if matches!(
                text(i + 1),
                "hours" | "work" | "lunch" | "dark" | "closing" | "dinner" | "school" | "breakfast"
            ) =>
        {
            (None, 1)
        }
        "after" if before == "one" && (text(i + 1) == "another" || text(i + 2) == "other") => (None, 1),
        "after" if text(i + 1) == "which" => (Some(Joint::Then), 2),
        // `two clients come out, and after them an intern`
        "after"
            if matches!(text(i + 1), "him" | "her" | "them")
                && matches!(text(i + 2), "a" | "an" | "the" | "another" | "two" | "three")
                && words
                    .iter()
                    .skip(i + 2)
                    .map_while(Option::as_ref)
                    .all(|word| !lexicon().verbs.contains(&word.stem) || lexicon().roles.contains_key(&word.stem)) =>
        {
            (Some(Joint::Then), 2)
        }
        // `she continues only after that`
        "after" if text(i + 1) == "that" && i + 2 == words.len() && before == "only" => (Some(Joint::When), 1),
        "after"
            if text(i + 1) == "that"
                && words.get(i + 2).is_none_or(|next| {
                    next.as_ref().is_none_or(|next| {
                        next.text != next.stem && next.text.ends_with('s') && lexicon().verbs.contains(&next.stem)
                            || matches!(
                                next.text.as_str(),
                                "he" | "she" | "they" | "it" | "all" | "both" | "one" | "everyone"
                            )
                    })
                }) =>
        {
            (Some(Joint::Then), 2)
        }
        "after"
            if matches!(before, "second" | "minute")
                && [i + 1, i + 2].iter().any(|k| matches!(text(*k), "start" | "beginning" | "outset")) =>
        {
            (None, 1)
        }
        // `does not walk on before it has passed`
        "before" if denies(words.get(..i).unwrap_or_default()) && !digit => (Some(Joint::Until), 1),
        "after" | "before"
            if !digit
                && !matches!(text(i + 1), "a" | "half" | "you" | "some")
                && (!trails(words.get(..i).unwrap_or_default())
                    || matches!(text(i + 1), "it" | "he" | "she" | "they")
                        && lexicon().verbs.contains(stem(i + 2))) =>
        {
            (Some(Joint::When), 1)
        }
        // `does not move unless the robot asks` is `… until it asks`.
        "until" | "till" | "unless" => (Some(Joint::Until), 1),
        "who" | "whom" | "which" if before != "of" => (Some(Joint::Who), 1),
        // `signals to the visitors that they may go first`
        "that" if person && !(i.saturating_sub(5)..i).any(|k| message(stem(k))) => (Some(Joint::Who), 1),
        "where" if !matches!(text(i + 1), "he" | "she" | "they" | "it") && i > 0 => (Some(Joint::Comma), 0),
        _ => (None, 1),
    }
}

/// `when the inspector and the robot meet`: of two who meet, one clause tells.
fn meeting(words: &[Option<Word>], and: usize) -> bool {
    let text = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.text.as_str());
    let stem = |k: usize| words.get(k).and_then(Option::as_ref).map_or("", |word| word.stem.as_str());
    let robot = and + 1 + usize::from(text(and + 1) == "the");
    let meets = stem(robot) == "robot" && stem(robot + 1) == "meet";
    let before = (1..=4)
        .filter_map(|back| and.checked_sub(back))
        .find(|k| matches!(text(*k), "when" | "once" | "as" | "until" | "moment"));
    meets
        && before.is_some_and(|k| {
            (k + 1..and).all(|k| !lexicon().verbs.contains(stem(k)) || lexicon().roles.contains_key(stem(k)))
        })
}

/// Whether the clause that ends here rules something out: `does not resume her walk before …`.
fn denies(before: &[Option<Word>]) -> bool {
    let own: Vec<&Word> = before.iter().rev().map_while(Option::as_ref).collect();
    let said = own.iter().take_while(|word| !matches!(word.text.as_str(), "and" | "but" | "when" | "who"));
    let asked = said.clone().any(|word| matches!(word.text.as_str(), "should" | "must" | "may" | "shall"));
    let verbs = !asked && said.clone().any(|word| lexicon().verbs.contains(&word.stem));
    verbs && said.clone().any(|word| matches!(word.text.as_str(), "not" | "never"))
}

/// `runs after the robot`: `after` belongs to the verb.
fn trails(before: &[Option<Word>]) -> bool {
    let last = before.last().and_then(Option::as_ref);
    last.is_some_and(|word| {
        matches!(word.stem.as_str(), "trail" | "chase" | "tag" | "look" | "along" | "straight" | "right")
            || lexicon().kind("go").contains(&word.stem)
    })
}
