//! What is told before the story: `This one is about gestures between humans: …`, `Tenants have complained that it frightens people.`

use crate::clock::WEEKDAYS;
use crate::lexicon::lexicon;
use crate::mention::{Mention, Who, mentions};
use crate::words::{Piece, Word, silence, text_at, word_at};

/// Words of whoever asks, of studies, and of what people are like in general.
const SIGNS: &[&str] = &[
    "i",
    "we",
    "us",
    "my",
    "our",
    "you",
    "your",
    "study",
    "literature",
    "experiment",
    "research",
    "about",
    "interested",
    "wonder",
    "question",
    "questionnaire",
    "hypothesis",
    "claim",
    "claims",
    "complained",
    "complain",
    "report",
    "reported",
    "afraid",
    "scared",
    "like",
    "love",
    "hate",
    "tend",
    "cause",
    "worry",
    "worries",
    "cope",
    "copes",
    "rate",
    "proof",
    "affraid",
    "usually",
    "often",
    "always",
    "normally",
    "sometimes",
    "whether",
    "how",
    "than",
    "known",
    "survey",
    "suites",
    "reproduce",
    "replicate",
    "recreate",
    "represented",
];
/// How questions begin that ask for no scene: `Does the tracker cope with somebody who …?`
const ASKS: &[&str] = &["does", "do", "is", "are", "how", "why", "will", "did", "has"];
/// Words by which such a part speaks of somebody who is there after all.
const THERE: &[&str] =
    &["there", "have", "want", "need", "simulate", "show", "put", "add", "imagine", "let", "make", "create", "with"];

/// Makes nobody's a part of the text that speaks of people in general before the story names those who are in it.
///
/// The words stay unused, so that what they wish for is reported as not understood.
pub(crate) fn preamble(pieces: &mut [Piece]) {
    trials(pieces);
    wanted(pieces);
    outside(pieces);
    let mut parts: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    for at in 0..=pieces.len() {
        if matches!(pieces.get(at), Some(Piece::Stop | Piece::Colon) | None) {
            if at > from {
                parts.push((from, at));
            }
            from = at + 1;
        }
    }
    let words = |(from, to): (usize, usize)| -> Vec<Word> {
        let words = pieces.get(from..to).unwrap_or_default().iter();
        words.filter_map(|piece| if let Piece::Word(word) = piece { Some(word.clone()) } else { None }).collect()
    };
    let spoken: Vec<(Vec<Word>, Vec<Mention>)> = parts
        .iter()
        .map(|part| {
            let words = words(*part);
            let found = mentions(&words);
            (words, found)
        })
        .collect();
    let Some(first) = spoken.iter().position(|(words, found)| found.iter().any(|mention| !weak(words, mention))) else {
        return;
    };
    // `Monday 8:45, people coming in. Need 4 people, …`
    let counted = spoken.get(first).is_some_and(|(words, found)| {
        let many =
            |mention: &Mention| mention.role.is_none() && matches!(mention.who, Who::New { count: Some(2..), .. });
        found.first().is_some_and(many) && words.iter().take(4).any(wishes)
    });
    let silent: Vec<(usize, usize)> = parts
        .iter()
        .zip(&spoken)
        .take(first)
        .filter(|((_, to), (words, found))| {
            // `Role reversal, the human guides: an intern …`
            // A heading does not tell what anybody does to the robot: `A family comes towards the robot: a father …`
            let heads = matches!(pieces.get(*to), Some(Piece::Colon))
                && words.len() <= 9
                && words.iter().all(|word| word.stem != "robot");
            general(words, found, heads) || counted && dated(words) && found.iter().all(|mention| weak(words, mention))
        })
        .map(|(part, _)| *part)
        .collect();
    silence(pieces, silent.into_iter().flat_map(|(from, to)| from..to));
}

/// `(n = 24 participants)`: so many take part in a study, and not in the scene, if that is told of others.
fn trials(pieces: &mut [Piece]) {
    let word = |k: usize| word_at(pieces, k);
    let role = |k: usize| word(k).and_then(|word| lexicon().roles.get(&word.stem)).is_some_and(|role| !role.generic);
    let scene = (0..pieces.len()).any(role);
    // `from my pilot (n=24)`
    let sample = |k: &usize| {
        scene
            && word(*k).is_some_and(|word| word.count().is_some())
            && k.checked_sub(1).and_then(word).is_some_and(|word| word.text == "n")
            && word(k + 1).is_none()
    };
    let samples: Vec<usize> = (0..pieces.len()).filter(sample).collect();
    let taking_part = |k: usize| word(k).is_some_and(|noun| matches!(noun.stem.as_str(), "participant" | "subject"));
    let many = |k: usize| word(k).and_then(Word::count).is_some_and(|n| n > 6);
    // Whoever is in the scene is named again: `a participant comes round the corner`.
    let one = |k: usize| {
        k > 0 && taking_part(k) && word(k - 1).is_some_and(|word| matches!(word.text.as_str(), "a" | "one" | "the"))
    };
    let again = (0..pieces.len()).any(one);
    let samples_told: Vec<usize> =
        (0..pieces.len()).filter(|k| (scene || again) && many(*k) && taking_part(k + 1)).collect();
    let counts: Vec<u32> = samples_told.iter().filter_map(|k| word(*k).and_then(Word::count)).collect();
    // `the other 12 are controls`
    let others = (1..pieces.len()).filter(|k| {
        word(k - 1).is_some_and(|word| word.text == "other")
            && word(*k).and_then(Word::count).is_some_and(|n| n > 6 && counts.contains(&n))
    });
    let others: Vec<usize> = others.flat_map(|k| [k - 1, k]).collect();
    // `each of the 24 participants`
    let each = samples_told.iter().filter(|k| {
        k.checked_sub(3).and_then(word).is_some_and(|word| matches!(word.text.as_str(), "each" | "all" | "every"))
    });
    let each: Vec<usize> = each.map(|k| k - 3).collect();
    let told: Vec<usize> = samples_told.iter().flat_map(|k| [*k, k + 1]).chain(others).chain(each).collect();
    silence(pieces, told.into_iter().chain(samples));
}

/// `need one for the new robot`, `I want one where …`: a scenario is wanted, and nobody counted.
fn wanted(pieces: &mut [Piece]) {
    let text = |k: usize| word_at(pieces, k).map_or("", |word| word.text.as_str());
    let places: Vec<usize> = (1..pieces.len())
        .filter(|k| {
            text(*k) == "one"
                && matches!(
                    text(k - 1),
                    "need" | "want" | "like" | "have" | "get" | "make" | "build" | "create" | "another"
                )
                && (matches!(text(k + 1), "for" | "where")
                    || text(k + 1) == "in" && text(k + 2) == "which"
                    || text(k + 1) == "of" && matches!(text(k + 2), "them" | "these" | "those"))
        })
        .collect();
    silence(pieces, places);
}

/// `the people watching the video`, `this variant of pedestrian overtaking`, `the case from issue 7, the one near rack 3`:
/// nobody of the scene.
fn outside(pieces: &mut [Piece]) {
    too_many(pieces);
    let text = |k: usize| word_at(pieces, k).map_or("", |word| word.text.as_str());
    let stem = |k: usize| word_at(pieces, k).map_or("", |word| word.stem.as_str());
    let role = |k: usize| lexicon().roles.contains_key(stem(k));
    let (mut silent, mut nobody, mut case) = (Vec::new(), Vec::new(), false);
    for k in 1..pieces.len() {
        let film = (k + 1..k + 5).any(|k| matches!(stem(k), "video" | "clip" | "recording" | "film" | "footage"));
        let watches = matches!(stem(k), "watch" | "view" | "rate" | "judge" | "annotate" | "see") && film;
        // `twenty raters will watch the videos`
        let who =
            (1..=3).filter_map(|back| k.checked_sub(back)).find(|k| !matches!(text(*k), "will" | "who" | "later"));
        if let Some(who) = who.filter(|who| watches && *who > 0 && (role(*who) || text(*who).ends_with("ers"))) {
            silent.extend([who - 1, who, k]);
        }
        if text(k - 1) == "of" && role(k) && text(k) == stem(k) && text(k + 1).ends_with("ing") {
            silent.push(k);
        }
        case |= matches!(stem(k), "case" | "scene" | "situation" | "issue" | "bug" | "scenario");
        if case
            && text(k - 1) == "the"
            && text(k) == "one"
            && matches!(text(k + 1), "near" | "from" | "in" | "at" | "with")
        {
            silent.extend([k - 1, k]);
        }
        case &= !role(k);
        // `My supervisor wants the student to …`: whoever asks.
        let asker = matches!(text(k - 1), "my" | "our") && (role(k) || text(k) == "co");
        let asks = |k: &usize| {
            matches!(
                stem(*k),
                "want"
                    | "insist"
                    | "say"
                    | "think"
                    | "claim"
                    | "suggest"
                    | "believe"
                    | "argue"
                    | "expect"
                    | "wish"
                    | "demand"
            )
        };
        if let Some(verb) = (k + 1..k + 4).find(asks).filter(|_| asker) {
            silent.extend(k - 1..=verb + usize::from(text(verb + 1) == "that"));
        }
        // `a doctor who has nothing to do with them`
        if text(k) == "nothing" && text(k + 1) == "to" && text(k + 2) == "do" && text(k + 3) == "with" {
            silent.extend(k - 1..k + 5 + usize::from(text(k + 4) == "the"));
        }
        // `no member of the group ever …`
        if text(k) == "member" && text(k - 1) == "no" && text(k + 1) == "of" {
            silent.extend(k..k + 4);
            nobody.push(k - 1);
        }
    }
    silence(pieces, silent);
    for at in nobody {
        if let Some(Piece::Word(word)) = pieces.get_mut(at) {
            "nobody".clone_into(&mut word.text);
            "nobody".clone_into(&mut word.stem);
        }
    }
}

/// `Six agents are too many for CI, take four.`: four of them.
/// `had four pedestrians, but two are enough`: two of them.
fn too_many(pieces: &mut [Piece]) {
    let text = |k: usize| word_at(pieces, k).map_or("", |word| word.text.as_str());
    let count = |k: usize| word_at(pieces, k).filter(|word| word.count().is_some()).cloned();
    let role_at = |k: usize| word_at(pieces, k).is_some_and(|word| lexicon().roles.contains_key(&word.stem));
    for k in 2..pieces.len() {
        let many = matches!(text(k), "are" | "is") && text(k + 1) == "too" && matches!(text(k + 2), "many" | "much");
        let enough = text(k) == "enough" && matches!(text(k - 1), "are" | "is" | "be");
        let number = (k - 2..k).rev().find_map(count).filter(|_| enough);
        let first = (0..k.saturating_sub(2)).rev().find(|k| count(*k).is_some() && role_at(*k + 1));
        if let (Some(number), Some(first)) = (number, first) {
            if let Some(Piece::Word(word)) = pieces.get_mut(first) {
                (word.text, word.stem) = (number.text, number.stem);
            }
            // `one is enough: a cleaner who …`: it is told who.
            let listed = (k + 1..k + 8).find(|k| matches!(pieces.get(*k), Some(Piece::Colon | Piece::Comma)));
            let who = listed.is_some_and(|mark| matches!(text_at(pieces, mark + 1), "a" | "an"));
            silence(pieces, if who { first..=k } else { k.saturating_sub(3)..=k });
            return;
        }
        let end = (k..pieces.len()).find(|k| matches!(pieces.get(*k), Some(Piece::Stop))).unwrap_or(pieces.len());
        let Some(number) = (k + 3..end).rev().find_map(count).filter(|_| many && count(k - 2).is_some()) else {
            continue;
        };
        if let Some(Piece::Word(first)) = pieces.get_mut(k - 2) {
            (first.text, first.stem) = (number.text, number.stem);
        }
        silence(pieces, k..end);
        return;
    }
}

/// Whether a part speaks of people in general.
fn general(words: &[Word], found: &[Mention], heads: bool) -> bool {
    let signs = signs(words);
    let asks = words.first().is_some_and(|word| ASKS.contains(&word.text.as_str()));
    (signs || heads || asks) && !found.is_empty() && found.iter().all(|mention| weak(words, mention))
}

/// Whether words tell of a day.
fn dated(words: &[Word]) -> bool {
    let part = |word: &Word| matches!(word.text.as_str(), "weekend" | "morning" | "afternoon" | "evening");
    words.iter().any(|word| WEEKDAYS.contains(&word.text.as_str()) || part(word))
}

/// Whether words tell of whoever asks, or in general.
fn signs(words: &[Word]) -> bool {
    words.iter().any(|word| SIGNS.contains(&word.text.as_str()))
        // `so this one is for their induction`
        || words.windows(2).any(|two| matches!(two, [this, one] if this.text == "this" && one.text == "one"))
}

/// Whether a mention may be of somebody who is not in the scene.
fn weak(words: &[Word], mention: &Mention) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let signs = || signs(words) || ASKS.contains(&text(0));
    match mention.who {
        // `people in our ward`; but `I want people who …`
        Who::New { count: None, .. } => {
            !(0..mention.from).any(|k| THERE.contains(&text(k)) && mention.from - k <= 3)
                || mention.from > 1 && text(mention.from - 1) == "with"
        }
        // `some people love to tease it`
        Who::New { .. } if mention.role.is_none() && text(mention.from) == "some" => signs(),
        // `how a dyad affects the robot`
        Who::New { .. } if mention.group && mention.role.is_none() => signs(),
        // `somebody`, where nothing is asked for
        Who::New { count: Some(1), .. } if mention.role.is_none() => signs() && !words.iter().any(wishes),
        // `this one is about …`, `the human guides`
        Who::Definite { .. } if mention.role.is_none() => !mention.group,
        // `Retail is well covered in the literature`
        Who::Definite { .. } if mention.from == 0 && signs() => {
            let known = mention.role.as_ref().is_some_and(|role| lexicon().roles.contains_key(role));
            !known || opines(words, mention) || owned(words, mention)
        }
        Who::Definite { .. } => opines(words, mention) || owned(words, mention),
        Who::All | Who::Ordinal(_) | Who::ToldApart | Who::Bare(1) | Who::Same | Who::Object => true,
        Who::New { .. }
        | Who::More(_)
        | Who::PartOf(_)
        | Who::PartOfNew(..)
        | Who::AllOf(_)
        | Who::Bare(_)
        | Who::Other(_)
        | Who::Some { .. }
        | Who::SoMany(_)
        | Who::AllBut(_)
        | Who::OrdinalOf { .. }
        | Who::Further(_)
        | Who::Number(_)
        | Who::Nobody => false,
    }
}

/// Whether a word asks for a scene.
fn wishes(word: &Word) -> bool {
    word.text != "with" && THERE.contains(&word.text.as_str())
        || matches!(word.text.as_str(), "scene" | "scenario" | "case" | "please" | "if")
}

/// Whether somebody only has an opinion: `our safety officer wants proof that …`, `the sister won't let me …`.
fn opines(words: &[Word], mention: &Mention) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let own = matches!(text(mention.from), "our" | "my");
    let verb = text(mention.to + 1);
    let to_me = (mention.to + 2..mention.to + 6)
        .any(|k| matches!(text(k), "me" | "us" | "whether" | "if" | "proof" | "how" | "why" | "know" | "see"));
    let says = matches!(
        verb,
        "claim"
            | "claims"
            | "claimed"
            | "complain"
            | "complains"
            | "complained"
            | "insist"
            | "insists"
            | "think"
            | "thinks"
            | "suggest"
            | "suggests"
            | "believe"
            | "believes"
            | "worry"
            | "worries"
    );
    let asks = matches!(
        verb,
        "want"
            | "wants"
            | "wanted"
            | "keep"
            | "keeps"
            | "kept"
            | "ask"
            | "asks"
            | "asked"
            | "will"
            | "would"
            | "say"
            | "says"
            | "said"
            | "tell"
            | "tells"
            | "told"
            | "need"
            | "needs"
            | "has"
    );
    let general = matches!(
        verb,
        "hate"
            | "hates"
            | "love"
            | "loves"
            | "like"
            | "likes"
            | "tend"
            | "drives"
            | "works"
            | "get"
            | "have"
            | "want"
            | "wants"
            | "need"
            | "needs"
            | "keep"
            | "keeps"
    );
    says || asks && to_me || own && general
}

/// `… that it copes with our drivers`: people of whoever asks, in words about them.
fn owned(words: &[Word], mention: &Mention) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    matches!(text(mention.from), "our" | "my")
        && mention.from > 0
        && words.iter().take(mention.from).any(|word| {
            matches!(word.text.as_str(), "proof" | "copes" | "cope" | "claims" | "whether" | "complaints" | "handles")
        })
}
