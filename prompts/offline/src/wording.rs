//! Words that stand for others, and people of whom only is told what does not happen: `wants out`, `she thinks that people …`,
//! `we had a complaint about a patient …`, `the only person left is a guard`.

use crate::lexicon::lexicon;
use crate::words::{Piece, Word, comma_at, silence, text_at, word_at};

/// Verbs of minds: what is thought happens to nobody.
const THINKS: &[&str] = &[
    "thinks", "think", "believes", "believe", "assumes", "assume", "supposes", "reckons", "reckon", "hopes", "fears",
    "wonders", "doubts", "imagines", "guesses", "knows", "finds",
];
/// Words of reports of what happened before, which a scene then shows anew.
const REPORTS: &[&str] = &[
    "complaint",
    "complaints",
    "complained",
    "incident",
    "incidents",
    "accident",
    "reported",
    "miss",
    "clipped",
    "injured",
];
/// Who stands for somebody of whom it is then said who it is.
const ANYBODY: &[&str] = &["somebody", "someone"];

/// Rewrites such words, and makes nobody's those of whom only is told what happened before.
pub(crate) fn reworded(text: &str, pieces: &mut Vec<Piece>) {
    wishes(pieces);
    slips(pieces);
    only_some(pieces);
    idle(pieces);
    cars(pieces);
    settings(pieces);
    this_one(pieces);
    only_one(pieces);
    placeholders(pieces);
    let told: Vec<usize> = thoughts(pieces)
        .into_iter()
        .chain(reports(text, pieces))
        .chain(points(pieces))
        .chain(nobodies(pieces))
        .chain(away(pieces))
        .collect();
    silence(pieces, told);
}

fn set(pieces: &mut [Piece], at: usize, text: &str, stem: &str) {
    if let Some(Piece::Word(word)) = pieces.get_mut(at) {
        text.clone_into(&mut word.text);
        stem.clone_into(&mut word.stem);
    }
}

fn role(pieces: &[Piece], at: usize) -> Option<&Word> {
    word_at(pieces, at).filter(|word| lexicon().roles.contains_key(&word.stem) && !word.label)
}

fn generic(pieces: &[Piece], at: usize) -> bool {
    role(pieces, at).and_then(|word| lexicon().roles.get(&word.stem)).is_some_and(|role| role.generic)
}

/// First and last place of every sentence.
fn sentences(pieces: &[Piece]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = 0;
    for at in 0..=pieces.len() {
        if matches!(pieces.get(at), Some(Piece::Stop) | None) {
            if at > from {
                found.push((from, at));
            }
            from = at + 1;
        }
    }
    found
}

/// `the robot wants into the room, an employee wants out`, `the robot asks, then he clears it`.
fn wishes(pieces: &mut [Piece]) {
    for at in 0..pieces.len() {
        let wants = word_at(pieces, at).is_some_and(|word| word.stem == "want");
        if wants && matches!(text_at(pieces, at + 1), "out" | "into" | "in" | "inside" | "through" | "past") {
            set(pieces, at, "goes", "go");
        }
        let clears = matches!(text_at(pieces, at), "clears" | "clear") && text_at(pieces, at + 1) == "it";
        if clears && text_at(pieces, at + 2) != "of" {
            set(pieces, at + 1, "way", "way");
        }
    }
}

/// `closer then 2 m`, `office 312`.
fn slips(pieces: &mut [Piece]) {
    for at in 1..pieces.len() {
        let compared =
            matches!(text_at(pieces, at - 1), "closer" | "nearer" | "less" | "rather" | "other" | "slower" | "faster");
        if compared && text_at(pieces, at) == "then" {
            set(pieces, at, "than", "than");
        }
        if text_at(pieces, at - 1) == "office" && word_at(pieces, at).is_some_and(Word::is_digits) {
            set(pieces, at - 1, "room", "room");
        }
    }
}

/// `The night team has 12 members, but only one of them is in the corridor: …`, `Of a team of nine, just two are there`: so many.
fn only_some(pieces: &mut [Piece]) {
    let count = |k: usize| word_at(pieces, k).and_then(Word::count);
    let mut told = Vec::new();
    for (from, to) in sentences(pieces) {
        for at in from + 2..to {
            if !matches!(text_at(pieces, at), "only" | "just") {
                continue;
            }
            let wants = matches!(text_at(pieces, at + 1), "need" | "want" | "use" | "take" | "have");
            let number = at + 1 + usize::from(wants);
            let him = matches!(text_at(pieces, number), "him" | "her").then_some(1);
            let Some(some) = count(number).or(him) else { continue };
            let person =
                |k: usize| role(pieces, k).is_some() || matches!(text_at(pieces, k), "members" | "them" | "us");
            let whole = (from..at).any(|k| {
                count(k).is_some_and(|all| all > some)
                    && ((k + 1..k + 4).any(person)
                        || (1..=3).filter_map(|back| k.checked_sub(back)).any(|k| {
                            matches!(text_at(pieces, k), "team" | "shift" | "crew" | "group" | "class" | "staff")
                        }))
            });
            let robot = (from..at).any(|k| word_at(pieces, k).is_some_and(|word| word.stem == "robot"));
            let measured = matches!(
                text_at(pieces, number + 1),
                "m" | "meter" | "meters" | "metre" | "metres" | "s" | "seconds" | "second" | "minutes"
            );
            let of = if matches!(text_at(pieces, number + 1), "of") { number + 3 } else { number + 1 };
            // `just one nurse in the corridor`
            let of = if role(pieces, of).is_some() { of + 1 } else { of };
            let be = of + usize::from(matches!(text_at(pieces, of), "is" | "are"));
            let there = matches!(
                text_at(pieces, be),
                "in" | "at"
                    | "on"
                    | "here"
                    | "there"
                    | "matter"
                    | "matters"
                    | "count"
                    | "counts"
                    | "needed"
                    | "relevant"
                    | "present"
                    | "around"
            ) || word_at(pieces, of).is_none();
            if whole && !robot && !measured && (wants || there) {
                told.extend(from..number);
                let of = if text_at(pieces, number + 1) == "of" { number + 3 } else { number + 1 };
                if matches!(text_at(pieces, of), "matter" | "matters" | "count" | "counts") {
                    told.extend(number..=of);
                }
                if text_at(pieces, number + 1) == "of"
                    && matches!(text_at(pieces, number + 2), "them" | "these" | "us" | "those")
                {
                    told.extend([number + 1, number + 2]);
                }
            }
        }
    }
    silence(pieces, told);
}

/// Verbs by which somebody is in a scene.
const THERE: &[&str] = &[
    "come", "walk", "stand", "cross", "wait", "sit", "block", "follow", "overtake", "run", "step", "stop", "approach",
    "leave", "enter", "chat", "talk", "look", "stay", "gather", "queue", "work", "pass", "meet", "crowd", "surround",
    "give", "move", "go", "get", "hurry",
];

/// `The point of the scene is a person who …`: why a scene is wanted.
fn points(pieces: &[Piece]) -> Vec<usize> {
    let why = |k: usize| {
        matches!(
            text_at(pieces, k),
            "point" | "purpose" | "aim" | "idea" | "question" | "focus" | "gist" | "reason" | "interest" | "thing"
        )
    };
    sentences(pieces)
        .into_iter()
        .filter(|(from, to)| {
            matches!(text_at(pieces, *from), "the" | "my" | "our" | "main")
                && (why(from + 1) || why(from + 2))
                && (*from..*to).any(|k| matches!(text_at(pieces, k), "is" | "was"))
                && !(*from..*to).any(|k| matches!(pieces.get(k), Some(Piece::Colon)))
        })
        .flat_map(|(from, to)| from..to)
        .collect()
}

/// `people are tired`, `I need someone who obeys it. A doctor …`: people in general, and somebody of whom it is told next who it is.
fn nobodies(pieces: &[Piece]) -> Vec<usize> {
    let spans = sentences(pieces);
    let mut told = Vec::new();
    let counted = |k: usize| {
        (1..=2).filter_map(|back| k.checked_sub(back)).any(|k| {
            word_at(pieces, k).is_some_and(|word| word.count().is_some())
                || matches!(
                    text_at(pieces, k),
                    "the"
                        | "these"
                        | "those"
                        | "some"
                        | "several"
                        | "few"
                        | "no"
                        | "more"
                        | "all"
                        | "other"
                        | "young"
                        | "old"
                        | "of"
                )
        })
    };
    let introduced = |from: usize, to: usize, first: bool| {
        (from..to).any(|k| {
            role(pieces, k).is_some()
                && !generic(pieces, k)
                && (1..=3).filter_map(|back| k.checked_sub(back)).any(|back| {
                    (matches!(text_at(pieces, back), "a" | "an")
                        || word_at(pieces, back).is_some_and(|word| word.count().is_some()))
                        && (!first || back == from)
                })
        })
    };
    for (n, (from, to)) in spans.iter().enumerate() {
        let roles: Vec<usize> = (*from..*to).filter(|k| role(pieces, *k).is_some()).collect();
        let there = (*from..*to)
            .any(|k| word_at(pieces, k).is_some_and(|word| THERE.contains(&word.stem.as_str()) && !word.label));
        for k in &roles {
            let many = matches!(
                text_at(pieces, *k),
                "people" | "participants" | "humans" | "persons" | "users" | "families" | "everyone" | "staff"
            );
            let verb = (k + 1..k + 4).find(|k| {
                word_at(pieces, *k).is_some_and(|word| lexicon().verbs.contains(&word.stem) || word.stem == "be")
            });
            let idle = verb.is_none_or(|verb| {
                let next = word_at(pieces, verb + 1).map_or("", |word| word.stem.as_str());
                word_at(pieces, verb).is_some_and(|word| !THERE.contains(&word.stem.as_str()))
                    && !THERE.contains(&next)
                    && next != "there"
                    && !matches!(next, "in" | "at" | "on")
            });
            let others = spans.iter().any(|(from, to)| introduced(*from, *to, false));
            if many
                && !counted(*k)
                && idle
                && others
                && word_at(pieces, k + 1).is_some()
                && !matches!(text_at(pieces, k + 1), "who" | "in" | "at" | "with")
            {
                told.push(*k);
            }
        }
        // Somebody, and in the next sentence who it is.
        let single = roles.len() == 1
            && roles.iter().all(|k| {
                generic(pieces, *k)
                    && !word_at(pieces, *k).is_some_and(crate::noun::plural)
                    && text_at(pieces, *k) != "people"
            });
        let next = spans.get(n + 1).is_some_and(|(from, to)| introduced(*from, *to, true));
        if single && !there && next {
            told.extend(*from..*to);
        }
    }
    told
}

/// `at no point in the scene`, `besides the robot`: words that only say that it is a scene, and a slip.
fn settings(pieces: &mut Vec<Piece>) {
    let mut at = 1;
    while at + 2 < pieces.len() {
        let scene = text_at(pieces, at) == "in"
            && matches!(text_at(pieces, at + 1), "the" | "this")
            && matches!(text_at(pieces, at + 2), "scene" | "run" | "test" | "trial" | "video" | "clip");
        let there = matches!(text_at(pieces, at - 1), "is" | "are" | "be" | "people" | "anybody" | "nobody" | "else");
        if scene && !there {
            pieces.drain(at..at + 3);
            continue;
        }
        let robot = |k: usize| word_at(pieces, k).is_some_and(|word| word.stem == "robot");
        if text_at(pieces, at) == "besides" && (robot(at + 1) || robot(at + 2)) {
            set(pieces, at, "beside", "beside");
        }
        at += 1;
    }
}

/// `The landlord wants to know what it does`, `I know it's an odd spot, but two of our participants …`, `nine people, is elsewhere`: who
/// has an opinion or is away.
fn away(pieces: &[Piece]) -> Vec<usize> {
    let mut told = Vec::new();
    for (from, to) in sentences(pieces) {
        let text = |k: usize| text_at(pieces, k);
        let knows = text(from) == "i"
            && matches!(text(from + 1), "know" | "realise" | "realize" | "admit" | "understand" | "remember");
        let wants = matches!(text(from), "the" | "our" | "my" | "your")
            && (from + 1..from + 4).find(|k| role(pieces, *k).is_some()).is_some_and(|k| {
                let verb = k + 1 + usize::from(text(k + 1) == "would");
                matches!(text(verb), "wants" | "want" | "like" | "likes" | "needs" | "wanted")
                    && text(verb + 1) == "to"
                    && matches!(text(verb + 2), "know" | "see" | "find" | "check" | "understand" | "be")
                    && (text(verb + 2) != "be" || text(verb + 3) == "sure")
            });
        if knows || wants {
            told.extend(from..to);
        }
        // `HR asked for something with a newcomer`
        let asks = word_at(pieces, from)
            .is_some_and(|word| word.capital && !lexicon().roles.contains_key(&word.stem) && !lexicon().has(word))
            && matches!(text(from + 1), "asked" | "asks" | "wants" | "wanted" | "requested")
            && (text(from + 2) == "for" || text(from + 1).starts_with("want"));
        if asks {
            told.extend([from, from + 1]);
        }
        for at in from..to {
            let counted = word_at(pieces, at).is_some_and(|word| word.count().is_some());
            let gone = (at + 1..at + 6)
                .any(|k| matches!(text(k), "elsewhere" | "absent") || text(k) == "not" && text(k + 1) == "there");
            if counted && gone && role(pieces, at + 1).is_some() {
                told.extend([at, at + 1]);
            }
        }
    }
    told
}

/// `which he then does`, `says excuse me while doing so`, `I first wrote four`, `three is right`, `Eight people? Make it 4`.
fn idle(pieces: &mut Vec<Piece>) {
    let mut told = Vec::new();
    let mut at = 1;
    while at < pieces.len() {
        let text = |k: usize| text_at(pieces, k);
        if text(at) == "then"
            && matches!(text(at - 1), "he" | "she" | "they" | "it")
            && matches!(text(at + 1), "does" | "do" | "did")
        {
            pieces.remove(at);
            continue;
        }
        if matches!(text(at - 1), "while" | "in" | "when" | "by")
            && text(at) == "doing"
            && matches!(text(at + 1), "so" | "this" | "that")
        {
            pieces.drain(at - 1..at + 2);
            continue;
        }
        let count = |k: usize| word_at(pieces, k).is_some_and(|word| word.count().is_some());
        let wrote = matches!(text(at), "wrote" | "said" | "typed" | "planned")
            && (text(at - 1) == "i" || at > 1 && text(at - 2) == "i");
        if wrote && count(at + 1) {
            told.push(at + 1);
        }
        if count(at) && matches!(text(at + 1), "is" | "are") && matches!(text(at + 2), "right" | "correct") {
            told.push(at);
        }
        // `Eight people in the hall? Overkill. Make it 4, standing around …`
        let opens = !matches!(pieces.get(at - 1), Some(Piece::Word(_)));
        if opens
            && text(at) == "make"
            && matches!(text(at + 1), "it" | "that")
            && count(at + 2)
            && role(pieces, at + 3).is_none()
        {
            let old = (0..at).rev().find(|k| count(*k) && (k + 1..k + 4).any(|k| role(pieces, k).is_some()));
            if let (Some(old), Some(Piece::Word(number))) = (old, pieces.get(at + 2)) {
                let (text, stem) = (number.text.clone(), number.stem.clone());
                set(pieces, old, &text, &stem);
                let close = usize::from(comma_at(pieces, at + 3));
                pieces.drain(at..at + 3 + close);
                continue;
            }
        }
        at += 1;
    }
    silence(pieces, told);
    // `one curious person in the hall: a packer who …`, `just one single person, a technician`
    let mut told = Vec::new();
    for at in 1..pieces.len() {
        if !generic(pieces, at)
            || word_at(pieces, at).is_some_and(crate::noun::plural)
            || text_at(pieces, at) == "people"
        {
            continue;
        }
        let one = (1..=3).filter_map(|back| at.checked_sub(back)).find(|k| {
            word_at(pieces, *k).is_some_and(|word| word.count() == Some(1)) || matches!(text_at(pieces, *k), "a" | "an")
        });
        let Some(one) = one else { continue };
        let counted = text_at(pieces, one) == "one";
        let mark = (at + 1..at + 7).find(|k| word_at(pieces, *k).is_none());
        let colon = mark.is_some_and(|mark| matches!(pieces.get(mark), Some(Piece::Colon)));
        let next = mark.map_or(0, |mark| mark + 1);
        let who = matches!(text_at(pieces, next), "a" | "an")
            && (next + 1..next + 4).find(|k| role(pieces, *k).is_some()).is_some_and(|k| !generic(pieces, k));
        if who && (colon || counted && mark.is_some_and(|mark| comma_at(pieces, mark))) {
            told.extend(one..=at);
        }
    }
    silence(pieces, told);
}

/// `the car` of a text about an elevator is that of the elevator.
fn cars(pieces: &mut [Piece]) {
    let lift = |k: usize| matches!(text_at(pieces, k), "elevator" | "lift" | "elevators" | "lifts");
    if !(0..pieces.len()).any(lift) {
        return;
    }
    for at in 0..pieces.len() {
        let car = matches!(text_at(pieces, at), "car" | "cabin");
        let named = at > 0 && matches!(text_at(pieces, at - 1), "elevator" | "lift" | "a");
        if car && !named {
            set(pieces, at, "elevator", "elevator");
        }
    }
}

/// `Nobody stops in this one`, `keep it to one person`, `a night shift of 12`: words that count nobody.
fn this_one(pieces: &mut [Piece]) {
    let mut told = Vec::new();
    for at in 0..pieces.len() {
        let text = |k: usize| text_at(pieces, k);
        if matches!(text(at), "in" | "for")
            && text(at + 1) == "this"
            && text(at + 2) == "one"
            && word_at(pieces, at + 3).is_none()
        {
            told.extend([at + 1, at + 2]);
        }
        let counted = word_at(pieces, at + 3).is_some_and(|word| word.count().is_some());
        if text(at) == "keep" && text(at + 1) == "it" && matches!(text(at + 2), "to" | "at") && counted {
            told.extend(at..at + 4 + usize::from(role(pieces, at + 4).is_some()));
        }
        let shift = matches!(text(at), "shift" | "crew" | "staff") && text(at + 1) == "of";
        if shift && word_at(pieces, at + 2).is_some_and(Word::is_digits) && role(pieces, at + 3).is_none() {
            told.extend(at..at + 3);
        }
    }
    silence(pieces, told);
}

/// `the only person left is a guard`: a guard.
fn only_one(pieces: &mut Vec<Piece>) {
    let mut at = 0;
    while at + 3 < pieces.len() {
        let only = text_at(pieces, at) == "the"
            && matches!(text_at(pieces, at + 1), "only" | "one")
            && (generic(pieces, at + 2) || matches!(text_at(pieces, at + 2), "one" | "soul"));
        let is = (at + 3..at + 6).find(|k| matches!(text_at(pieces, *k), "is" | "are"));
        if let Some(is) = is.filter(|is| only && matches!(text_at(pieces, is + 1), "a" | "an")) {
            pieces.drain(at..=is);
            // Whatever came before told of others.
            if at > 0
                && comma_at(pieces, at - 1)
                && let Some(mark) = pieces.get_mut(at - 1)
            {
                *mark = Piece::Stop;
            }
        }
        at += 1;
    }
}

/// `it is the human, a welder, who …`, `somebody from the service, let's say a gardener, stands`: who it is then said to be.
fn placeholders(pieces: &mut Vec<Piece>) {
    let mut at = 0;
    while at + 3 < pieces.len() {
        let human =
            matches!(text_at(pieces, at), "the" | "a" | "one") && generic(pieces, at + 1) && comma_at(pieces, at + 2);
        let somebody = ANYBODY.contains(&text_at(pieces, at));
        let mark =
            if human { Some(at + 2) } else { (at + 1..at + 8).find(|k| comma_at(pieces, *k)).filter(|_| somebody) };
        let Some(mark) = mark else {
            at += 1;
            continue;
        };
        let says = (mark + 1..mark + 4)
            .take_while(|k| {
                matches!(
                    text_at(pieces, *k),
                    "let" | "let's" | "lets" | "say" | "maybe" | "perhaps" | "probably" | "us"
                )
            })
            .count();
        let article = mark + 1 + says;
        let noun = (article + 1..article + 4).find(|k| role(pieces, *k).is_some());
        let who = matches!(text_at(pieces, article), "a" | "an") && noun.is_some_and(|noun| !generic(pieces, noun));
        // Behind a bare `somebody, a nurse` the list of who is there may go on.
        if who && (human || says > 0) {
            pieces.drain(at..article);
            let close =
                (at..at + 12).take_while(|k| !matches!(pieces.get(*k), Some(Piece::Stop | Piece::Colon) | None));
            let close = close.into_iter().find(|k| comma_at(pieces, *k)).filter(|k| {
                word_at(pieces, k + 1).is_some_and(|word| lexicon().verbs.contains(&word.stem) || word.text == "who")
            });
            if let Some(close) = close {
                pieces.remove(close);
            }
        }
        at += 1;
    }
}

/// `she thinks that robots should go around people`: what nobody does.
fn thoughts(pieces: &[Piece]) -> Vec<usize> {
    let mut told = Vec::new();
    for at in 1..pieces.len() {
        let subject = matches!(text_at(pieces, at - 1), "he" | "she" | "they" | "who" | "because" | "that")
            || role(pieces, at - 1).is_some();
        // `finds it exciting`, and not `finds the robot in his way`
        // `thinks it is funny to block the door` blocks it.
        let does = matches!(text_at(pieces, at + 1), "it" | "it's" | "its")
            && (at + 2..at + 6).any(|k| text_at(pieces, k) == "to");
        if does {
            continue;
        }
        let finds = text_at(pieces, at) != "finds" || matches!(text_at(pieces, at + 1), "it" | "that" | "this");
        if !subject || !THINKS.contains(&text_at(pieces, at)) || !finds || text_at(pieces, at + 1) == "twice" {
            continue;
        }
        let ends = |k: &usize| {
            word_at(pieces, *k).is_none()
                || matches!(text_at(pieces, *k), "and" | "but" | "so" | "when" | "until") && *k > at + 1
        };
        let end = (at + 1..=pieces.len()).find(ends).unwrap_or(pieces.len());
        told.extend(at..end);
    }
    told
}

/// `We had a complaint about a patient near room 214. So: … an elderly patient …`, `Could we have a person beside it for once? An
/// assistant …`: of whom a later sentence tells anew.
fn reports(text: &str, pieces: &[Piece]) -> Vec<usize> {
    let spans: Vec<(usize, usize)> = sentences(pieces)
        .into_iter()
        .flat_map(|(from, to)| {
            let colon =
                (from..to).find(|k| matches!(pieces.get(*k), Some(Piece::Colon))).filter(|k| *k > from && *k + 1 < to);
            colon.map_or_else(|| vec![(from, to)], |colon| vec![(from, colon), (colon + 1, to)])
        })
        .collect();
    let mut told = Vec::new();
    for (n, (from, to)) in spans.iter().enumerate() {
        let words = || (*from..*to).filter_map(|k| word_at(pieces, k));
        let anew = |stem: &str| {
            spans.iter().skip(n + 1).any(|(from, to)| {
                let acts =
                    (*from..*to).any(|k| word_at(pieces, k).is_some_and(|word| lexicon().verbs.contains(&word.stem)));
                acts && (*from..*to).any(|k| {
                    role(pieces, k).is_some_and(|word| stem.is_empty() && !generic(pieces, k) || word.stem == stem)
                        && (1..=3).filter_map(|back| k.checked_sub(back)).any(|k| {
                            matches!(text_at(pieces, k), "a" | "an")
                                || word_at(pieces, k).is_some_and(|word| word.count().is_some())
                        })
                })
            })
        };
        let roles: Vec<&Word> = (*from..*to).filter_map(|k| role(pieces, k)).collect();
        let reported =
            words().any(|word| REPORTS.contains(&word.text.as_str())) && roles.iter().all(|word| anew(&word.stem));
        let head = n
            .checked_sub(1)
            .and_then(|before| spans.get(before))
            .filter(|(_, end)| end + 1 == *from)
            .map_or(*from, |(from, _)| *from);
        let background = text_at(pieces, head) == "background" && anew("");
        let asked = words()
            .next_back()
            .is_some_and(|word| text.get(word.to..).is_some_and(|rest| rest.trim_start().starts_with('?')))
            && roles.len() == 1
            && (*from..*to).any(|k| generic(pieces, k))
            && words()
                .next()
                .is_some_and(|word| matches!(word.text.as_str(), "could" | "can" | "what" | "how" | "would" | "may"))
            && anew("");
        if (reported || asked || background) && !roles.is_empty() {
            told.extend(*from..*to);
        }
    }
    told
}
