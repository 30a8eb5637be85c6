//! Judges of whom it is known how often they err, for tests.

use async_trait::async_trait;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use socrates_author::pictured::Looked;
use socrates_model::seeds::stream_seed;
use socrates_prompts::opinion::{Opinion, Said, Seen};

pub(in super::super) use super::poll::Judge;
use super::{About, Asked, Made, Row, poll};

/// A judge who calls this share of true facts shown, and this share of false ones not shown. They err on a fact, not on an answer: the
/// same one in every repeat.
pub(in super::super) struct Stub {
    pub(in super::super) sensitivity: f64,
    pub(in super::super) specificity: f64,
    pub(in super::super) seed: u64,
}

/// A share that is drawn by a seed and these words.
pub(in super::super) fn drawn(seed: u64, words: &str) -> f64 {
    let mut chance = ChaCha8Rng::seed_from_u64(stream_seed(seed, words));
    f64::from(chance.next_u32()) / f64::from(u32::MAX)
}

/// A judge who calls the first half of every question shown, whatever it is.
pub(in super::super) struct ByPlace;

#[async_trait]
impl Judge for ByPlace {
    async fn look(&self, asked: &Opinion, _png: &[u8], _seed: u64) -> Looked<Vec<Seen>> {
        let half = asked.statements.len().div_ceil(2);
        let say = |place: usize| if place < half { Said::Shown } else { Said::NotShown };
        let seen = (0..asked.statements.len()).map(|place| Seen { said: say(place), pictures: vec![1] });
        Looked { answers: Vec::new(), read: Ok(Some(seen.collect())) }
    }
}

/// Statements of tests say themselves whether they hold.
fn holds(words: &str) -> bool {
    words.starts_with("true")
}

#[async_trait]
impl Judge for Stub {
    async fn look(&self, asked: &Opinion, _png: &[u8], _seed: u64) -> Looked<Vec<Seen>> {
        let say = |words: &String| {
            let right = drawn(self.seed, words) < if holds(words) { self.sensitivity } else { self.specificity };
            let shown = holds(words) == right;
            Seen { said: if shown { Said::Shown } else { Said::NotShown }, pictures: vec![1] }
        };
        Looked { answers: Vec::new(), read: Ok(Some(asked.statements.iter().map(say).collect())) }
    }
}

/// A run of so many facts, of which a share holds, and one planted one.
fn about(run: usize, facts: usize, share: f64, seed: u64) -> About {
    let own = |fact: usize| {
        let word = if drawn(seed, &format!("fact {fact} of {run}")) < share { "true" } else { "false" };
        let words = format!("{word} sentence {fact} of run {run} holds.");
        Asked { quote: words.clone(), words, kinds: Vec::new(), program: Some(true) }
    };
    let facts: Vec<Asked> = (0..facts).map(own).collect();
    let planted = vec![format!("false planted fact of run {run}")];
    let statements = facts.iter().map(|fact| fact.words.clone()).chain(planted.iter().cloned()).collect();
    About {
        bundle: format!("/lib/x-{run}"),
        run: format!("x-{run}.reference-1"),
        recording: format!("b3:{run}"),
        facts,
        planted,
        question: Opinion { setting: Vec::new(), people: Vec::new(), statements, last_picture: 8 },
        png: Vec::new(),
    }
}

/// What a judge makes of so many runs of four facts each, of which a share holds, in three repeats.
pub(in super::super) async fn rows(judge: &dyn Judge, runs: usize, share: f64, seed: u64) -> Vec<Row> {
    judged(judge, runs, share, seed).await.rows
}

pub(super) async fn judged(judge: &dyn Judge, runs: usize, share: f64, seed: u64) -> Made {
    let mut made = Made::default();
    for run in 0..runs {
        let asked = about(run, 4, share, seed);
        let mut repeats = Vec::new();
        for number in 0..3 {
            let seed = poll::seed_of(seed, &asked.recording, number);
            let (repeat, end) = poll::repeat(judge, &asked.question, &asked.png, seed).await;
            end.unwrap();
            repeats.push(repeat);
        }
        made.runs += 1;
        made.take(&format!("r{run:04}"), &asked, &repeats);
    }
    made
}
