//! A judge asked several times about one run, the facts in another order each time, and what most of the answers say.

use std::collections::BTreeMap;
use std::time::Duration;

use async_trait::async_trait;
use socrates_author::pictured::{Looked, Onlooker, Pictured};
use socrates_author::{Answer, AskError};
use socrates_model::seeds::stream_seed;
use socrates_model::{Family, Remedy};
use socrates_prompts::opinion::{Opinion, Said, Seen};

use super::super::blind::shuffle;

/// Times that a question without an answer is put again where its server may answer later.
const TRIES: u32 = 4;
/// First pause before that where the server names none, ms; it doubles each time.
const PAUSE_MS: u64 = 2_000;
/// Longest pause, ms.
const MOST_MS: u64 = 60_000;
/// Name of the form of an answer.
const FORM: &str = "opinion";

/// One who looks at pictures of a run.
#[async_trait]
pub(in super::super) trait Judge: Sync {
    /// Answers one question about one sheet of pictures.
    async fn look(&self, asked: &Opinion, png: &[u8], seed: u64) -> Looked<Vec<Seen>>;
}

#[async_trait]
impl Judge for Onlooker {
    async fn look(&self, asked: &Opinion, png: &[u8], seed: u64) -> Looked<Vec<Seen>> {
        let question = Pictured {
            form: FORM.to_owned(),
            messages: asked.messages(),
            png: png.to_vec(),
            schema: asked.schema(),
            seed,
        };
        let mut answers = Vec::new();
        let mut pause_ms = PAUSE_MS;
        for tries in 1.. {
            let looked = self.ask(&question, |text| asked.read(text)).await;
            answers.extend(looked.answers);
            let Err(why) = looked.read else { return Looked { answers, read: looked.read } };
            if why.code.family() == Family::Transport {
                // The books have every call.
                answers.push(Answer { model: String::new(), ..Answer::default() });
            }
            if tries >= TRIES || !passes(&why) {
                return Looked { answers, read: Err(why) };
            }
            tokio::time::sleep(Duration::from_millis(why.retry_after_ms.unwrap_or(pause_ms).min(MOST_MS))).await;
            pause_ms = pause_ms.saturating_mul(2);
        }
        Looked { answers, read: Ok(None) }
    }
}

/// Whether the same question may be answered later.
fn passes(why: &AskError) -> bool {
    why.code.family() == Family::Transport && why.code.remedy() == Remedy::Wait
}

/// What one repeat came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Repeat {
    /// Place of each fact in the question, from 1.
    pub(super) places: Vec<usize>,
    /// What was said of each fact; nothing where no answer could be read.
    pub(super) seen: Option<Vec<Seen>>,
    /// Everything that was answered, for the books.
    pub(super) answers: Vec<Answer>,
}

/// A run's facts asked once more: in an order of its own, drawn by a seed.
pub(super) async fn repeat(
    judge: &dyn Judge,
    asked: &Opinion,
    png: &[u8],
    seed: u64,
) -> (Repeat, Result<(), AskError>) {
    let mut order: Vec<usize> = (0..asked.statements.len()).collect();
    shuffle(&mut order, seed);
    let statements = order.iter().filter_map(|fact| asked.statements.get(*fact).cloned()).collect();
    let looked = judge.look(&Opinion { statements, ..asked.clone() }, png, seed).await;
    let mut places = vec![0; order.len()];
    for (place, fact) in order.iter().enumerate() {
        if let Some(slot) = places.get_mut(*fact) {
            *slot = place + 1;
        }
    }
    let (seen, end) = match looked.read {
        Ok(seen) => (seen, Ok(())),
        Err(why) => (None, Err(why)),
    };
    let by_fact = seen.map(|seen| places.iter().filter_map(|place| seen.get(place - 1).cloned()).collect());
    (Repeat { places, seen: by_fact, answers: looked.answers }, end)
}

/// The seed of a repeat, by the recording that is shown: other runs of the library make no difference.
pub(super) fn seed_of(seed: u64, recording: &str, repeat: usize) -> u64 {
    stream_seed(seed, &format!("second opinion {repeat} on {recording}"))
}

/// What a judge holds of a fact, all repeats together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Held {
    /// More than half of the repeats say so.
    Said(Said),
    /// No answer has more than half of the repeats.
    NoMajority,
    /// No repeat has an answer that could be read.
    NoAnswer,
}

impl Held {
    pub(super) const ALL: [Self; 5] = [
        Self::Said(Said::Shown),
        Self::Said(Said::NotShown),
        Self::Said(Said::CannotTell),
        Self::NoMajority,
        Self::NoAnswer,
    ];

    pub(in super::super) const fn word(self) -> &'static str {
        match self {
            Self::Said(said) => said.word(),
            Self::NoMajority => "no_majority",
            Self::NoAnswer => "no_answer",
        }
    }

    /// Whether the fact is shown; nothing where that is not said.
    pub(in super::super) const fn shown(self) -> Option<bool> {
        match self {
            Self::Said(Said::Shown) => Some(true),
            Self::Said(Said::NotShown) => Some(false),
            Self::Said(Said::CannotTell) | Self::NoMajority | Self::NoAnswer => None,
        }
    }
}

/// What most say of one fact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Majority {
    pub(super) held: Held,
    /// Repeats that gave the most frequent answer.
    pub(super) agree: usize,
    /// Pictures that more than half of those repeats name.
    pub(super) pictures: Vec<u32>,
}

/// What most repeats say of a fact.
pub(super) fn majority(repeats: &[Repeat], fact: usize) -> Majority {
    let seen: Vec<&Seen> = repeats.iter().filter_map(|repeat| repeat.seen.as_ref()?.get(fact)).collect();
    let count = |said: Said| seen.iter().filter(|one| one.said == said).count();
    let (said, agree) = Said::ALL
        .into_iter()
        .map(|said| (said, count(said)))
        .fold((Said::CannotTell, 0), |best, one| if one.1 > best.1 { one } else { best });
    let held = match agree {
        0 => Held::NoAnswer,
        _ if agree * 2 > repeats.len() => Held::Said(said),
        _ => Held::NoMajority,
    };
    let mut named: BTreeMap<u32, usize> = BTreeMap::new();
    for picture in seen.iter().filter(|one| one.said == said).flat_map(|one| &one.pictures) {
        *named.entry(*picture).or_default() += 1;
    }
    let pictures = named.into_iter().filter(|(_, times)| times * 2 > agree).map(|(picture, _)| picture).collect();
    Majority { held, agree, pictures }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repeat_of(said: &[Option<Said>]) -> Vec<Repeat> {
        let one = |said: &Option<Said>| Repeat {
            places: vec![1],
            seen: said.map(|said| vec![Seen { said, pictures: vec![2, 5] }]),
            answers: Vec::new(),
        };
        said.iter().map(one).collect()
    }

    #[test]
    fn the_majority_is_of_all_repeats_and_no_answer_is_never_not_shown() {
        use Said::{CannotTell, NotShown, Shown};
        let held = |said: &[Option<Said>]| {
            let found = majority(&repeat_of(said), 0);
            (found.held, found.agree)
        };
        assert_eq!(held(&[Some(Shown), Some(Shown), Some(Shown), Some(NotShown), None]), (Held::Said(Shown), 3));
        assert_eq!(held(&[Some(Shown), Some(Shown), None, None, None]), (Held::NoMajority, 2));
        assert_eq!(held(&[Some(CannotTell); 5]), (Held::Said(CannotTell), 5));
        assert_eq!(held(&[None; 5]), (Held::NoAnswer, 0));
        assert_eq!(Held::NoAnswer.shown(), None);
        assert_eq!(majority(&repeat_of(&[Some(Shown); 3]), 0).pictures, [2, 5]);
    }

    /// Answers by the words of a statement alone, and keeps the order in which it was asked.
    struct ByWords(std::sync::Mutex<Vec<Vec<String>>>);

    #[async_trait]
    impl Judge for ByWords {
        async fn look(&self, asked: &Opinion, _png: &[u8], _seed: u64) -> Looked<Vec<Seen>> {
            self.0.lock().unwrap().push(asked.statements.clone());
            let said = |words: &String| if words.starts_with("true") { Said::Shown } else { Said::NotShown };
            let seen = asked.statements.iter().map(|words| Seen { said: said(words), pictures: vec![1] }).collect();
            Looked { answers: Vec::new(), read: Ok(Some(seen)) }
        }
    }

    #[tokio::test]
    async fn every_repeat_has_an_order_of_its_own_and_answers_find_their_facts() {
        let statements: Vec<String> =
            (0..8).map(|n| format!("{} {n}", if n % 3 == 0 { "true" } else { "false" })).collect();
        let asked = Opinion { setting: Vec::new(), people: Vec::new(), statements, last_picture: 8 };
        let judge = ByWords(std::sync::Mutex::default());
        for number in 0..5 {
            let (repeat, end) = repeat(&judge, &asked, &[], seed_of(7, "b3:00", number)).await;
            end.unwrap();
            let shown: Vec<bool> = repeat.seen.unwrap().iter().map(|seen| seen.said == Said::Shown).collect();
            assert_eq!(shown, (0..8).map(|n| n % 3 == 0).collect::<Vec<_>>());
            let orders = judge.0.lock().unwrap();
            for (fact, place) in repeat.places.iter().enumerate() {
                assert_eq!(orders[number][place - 1], asked.statements[fact]);
            }
        }
        let orders = judge.0.lock().unwrap();
        let distinct: std::collections::BTreeSet<&Vec<String>> = orders.iter().collect();
        assert_eq!(distinct.len(), 5, "{orders:?}");
    }
}
