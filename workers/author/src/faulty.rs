//! Faults put in on purpose, at set rates, for reliability experiments.

use std::collections::BTreeMap;
use std::str::FromStr;

use async_trait::async_trait;
use socrates_model::FaultCode;
use socrates_model::hash::derive_seed;
use socrates_model::job::Stage;
use socrates_prompts::Question;

use crate::author::{Answer, AskError, Author};
use crate::mutate;

macro_rules! fault_kinds {
    ($($name:ident $word:literal $code:ident $about:literal;)*) => {
        /// A kind of fault that can be put into an answer. Each is found again under its own code.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum FaultKind {
            $(#[doc = $about] $name,)*
        }

        impl FaultKind {
            /// Every kind in order.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Word in settings: `fault.<word>`.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$name => $word,)* }
            }

            /// The code under which it should be found.
            #[must_use]
            pub const fn code(self) -> FaultCode {
                match self { $(Self::$name => FaultCode::$code,)* }
            }
        }
    };
}

fault_kinds! {
    T429 "t429" T429 "The server asks to slow down.";
    T5xx "t5xx" T5xx "The server fails.";
    Tnet "tnet" TNet "The server cannot be reached.";
    Timeout "timeout" TTimeout "The server does not answer in time.";
    Refusal "refusal" ERefusal "The model refuses.";
    Empty "empty" EEmpty "The answer is empty.";
    Trunc "trunc" ETrunc "The answer is cut off.";
    Json "json" EJson "The answer is not JSON.";
    Fence "fence" EExtra "The answer stands in a code fence; repaired, never refused.";
    Schema "schema" ESchema "A member has a wrong name.";
    Pcount "pcount" PCount "A human is missing.";
    Pverify "pverify" PVerify "A clause is missing.";
    Pcap "pcap" PCap "A behavior cannot be simulated.";
    Gdisc "gdisc" GDisc "A node in the middle of the robot's path is missing.";
    Gunknown "gunknown" GUnknown "A node has a look-alike name.";
    Gshort "gshort" GShort "The robot's path is too short.";
    Gmeet "gmeet" GMeet "An encounter is not on the robot's path.";
    Gmeetend "gmeetend" GMeetEnd "The robot's path ends at the encounter.";
    Gagents "gagents" GAgents "There is a path for a stranger.";
    Bagents "bagents" BAgents "A tree is missing.";
    Bxml "bxml" BXml "A tree is cut XML.";
    Bdead "bdead" BDead "A rule can never run.";
    Bhear "bhear" BHear "A rule waits for a gesture that nobody makes.";
    Brange "brange" BRange "A distance is out of range.";
    Bmatch "bmatch" BMatch "A rule of the proposal is missing.";
}

impl FromStr for FaultKind {
    type Err = AskError;
    fn from_str(text: &str) -> Result<Self, AskError> {
        Self::ALL.iter().copied().find(|kind| kind.word() == text).ok_or_else(|| {
            let words: Vec<&str> = Self::ALL.iter().map(|kind| kind.word()).collect();
            let message =
                format!("`{text}` is no kind of fault; allowed: {}, first_only, sticky, seed", words.join(", "));
            AskError::new(FaultCode::JRequest, message)
        })
    }
}

/// How often each kind of fault is put in.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaultRates {
    /// Probability per ask and kind, 0 to 1.
    pub rates: BTreeMap<FaultKind, f64>,
    /// Whether only the first attempt is touched. Default false.
    pub first_only: bool,
    /// Probability that a fault which the feedback names comes again by itself, before its rate is drawn. Default 0.
    pub sticky: f64,
    /// Seed of the experiment, beside the question's own. Default 0.
    pub seed: u64,
}

impl FaultRates {
    /// The rates in a job's settings: `fault.gdisc = "0.3"` (or `fault_rate.gdisc`), `fault.first_only = "true"`,
    /// `fault.sticky`, `fault.seed`.
    ///
    /// # Errors
    /// [`AskError`] `J-REQUEST` for an unknown kind or a value that is no probability.
    pub fn from_settings(settings: &BTreeMap<String, String>) -> Result<Self, AskError> {
        let mut rates = Self::default();
        for (key, value) in settings {
            let Some(word) = key.strip_prefix("fault.").or_else(|| key.strip_prefix("fault_rate.")) else { continue };
            let bad = |allowed: &str| {
                AskError::new(FaultCode::JRequest, format!("setting `{key}` is `{value}`; allowed: {allowed}"))
            };
            let probability = || {
                value
                    .parse::<f64>()
                    .ok()
                    .filter(|p| (0.0..=1.0).contains(p))
                    .ok_or_else(|| bad("a probability from 0 to 1"))
            };
            match word {
                "first_only" => rates.first_only = value.parse().map_err(|_word| bad("true or false"))?,
                "sticky" => rates.sticky = probability()?,
                "seed" => rates.seed = value.parse().map_err(|_digits| bad("a whole number"))?,
                kind => {
                    rates.rates.insert(kind.parse()?, probability()?);
                }
            }
        }
        Ok(rates)
    }

    /// Whether nothing is ever put in.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.rates.values().all(|rate| *rate <= 0.0)
    }
}

/// Wraps an author and puts faults into its answers.
///
/// Draws are keyed by experiment seed, question seed, stage, attempt and kind, so that results depend neither on the number of
/// workers nor on their order.
pub struct FaultyAuthor<A> {
    inner: A,
    rates: FaultRates,
    attempt: u32,
}

impl<A: Author> FaultyAuthor<A> {
    /// The author with faults, for this attempt of its job (from 1).
    #[must_use]
    pub const fn new(inner: A, rates: FaultRates, attempt: u32) -> Self {
        Self { inner, rates, attempt }
    }

    fn draw(&self, question: &Question, kind: FaultKind, what: &str) -> u64 {
        let attempt = self.attempt.to_string();
        let base = question.seed ^ self.rates.seed.rotate_left(17);
        derive_seed(base, &["fault", question.stage.name(), kind.word(), &attempt, what])
    }

    /// Whether a kind of fault strikes this time.
    fn strikes(&self, question: &Question, kind: FaultKind, rate: f64) -> bool {
        if self.rates.first_only && self.attempt > 1 {
            return false;
        }
        let named = question.feedback.iter().any(|fault| fault.code == kind.code());
        let again = named && share(self.draw(question, kind, "sticky")) < self.rates.sticky;
        again || share(self.draw(question, kind, "rate")) < rate
    }
}

/// A draw as a share in [0, 1).
#[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
fn share(draw: u64) -> f64 {
    (draw >> 11) as f64 / (1_u64 << 53) as f64
}

#[async_trait]
impl<A: Author> Author for FaultyAuthor<A> {
    async fn ask(&self, question: &Question) -> Result<Answer, AskError> {
        let struck: Vec<FaultKind> = self
            .rates
            .rates
            .iter()
            .filter(|(kind, rate)| self.strikes(question, **kind, **rate))
            .map(|(kind, _)| *kind)
            .collect();
        for kind in &struck {
            let message = format!("injected: {}", kind.code().about());
            if *kind == FaultKind::T429 {
                return Err(AskError { code: kind.code(), message, retry_after_ms: Some(100) });
            }
            if matches!(kind, FaultKind::T5xx | FaultKind::Tnet | FaultKind::Timeout | FaultKind::Refusal) {
                return Err(AskError::new(kind.code(), message));
            }
        }
        let mut answer = self.inner.ask(question).await?;
        // Faults of the text come last: after them the answer can no longer be changed as JSON.
        let textual =
            |kind: &FaultKind| matches!(kind, FaultKind::Empty | FaultKind::Trunc | FaultKind::Json | FaultKind::Fence);
        let (last, mut first): (Vec<FaultKind>, Vec<FaultKind>) = struck.into_iter().partition(textual);
        // What takes a rule away goes before what puts one in, or one fault would undo the other.
        first.sort_by_key(|kind| *kind != FaultKind::Bmatch);
        for kind in first.into_iter().chain(last) {
            let draw = self.draw(question, kind, "where");
            if let Some(text) = mutate::apply(kind, question.stage, &answer.text, draw) {
                answer.text = text;
                answer.injected.push(kind.word().to_owned());
            }
        }
        if !answer.injected.is_empty() {
            tracing::debug!(stage = %question.stage, injected = ?answer.injected, "fault injected");
        }
        Ok(answer)
    }

    fn name(&self) -> String {
        format!("{} with injected faults", self.inner.name())
    }
}

/// Whether a stage has this kind of fault at all.
#[must_use]
pub fn concerns(kind: FaultKind, stage: Stage) -> bool {
    match kind.code().code().split_once('-').map_or("", |(letter, _)| letter) {
        "P" => stage == Stage::Proposal,
        "G" => stage == Stage::Paths,
        "B" => stage == Stage::Behaviors,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attempt::attempt;
    use crate::testing::{Scripted, good_behaviors, good_paths, good_proposal, question};

    fn only(kind: FaultKind, rate: f64) -> FaultRates {
        FaultRates { rates: BTreeMap::from([(kind, rate)]), ..FaultRates::default() }
    }

    fn good(stage: Stage) -> String {
        match stage {
            Stage::Proposal => good_proposal(),
            Stage::Paths => good_paths(),
            Stage::Behaviors | Stage::Simulation | Stage::Scoring | Stage::Review => good_behaviors(),
        }
    }

    #[tokio::test]
    async fn good_answers_are_good_without_faults() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            let faulty = FaultyAuthor::new(Scripted::says(&good(stage)), FaultRates::default(), 1);
            let made = attempt(&faulty, &question(stage)).await.unwrap();
            assert!(made.exchange.faults.is_empty(), "{stage}: {:?}", made.exchange.faults);
        }
    }

    #[tokio::test]
    async fn every_injected_fault_is_found_under_its_own_code() {
        for stage in [Stage::Proposal, Stage::Paths, Stage::Behaviors] {
            for kind in FaultKind::ALL.iter().copied().filter(|kind| concerns(*kind, stage)) {
                let faulty = FaultyAuthor::new(Scripted::says(&good(stage)), only(kind, 1.0), 1);
                let outcome = attempt(&faulty, &question(stage)).await;
                if kind == FaultKind::Fence {
                    assert_eq!(outcome.unwrap().exchange.repairs[0].code, kind.code());
                    continue;
                }
                let faults = outcome.expect_err(kind.word()).faults;
                assert!(faults.iter().any(|fault| fault.code == kind.code()), "{stage} {}: {faults:?}", kind.word());
            }
        }
    }

    #[tokio::test]
    async fn rates_are_kept_and_the_attempt_draws_anew() {
        let mut struck = 0;
        let mut differs = false;
        for seed in 0..400 {
            let mut asked = question(Stage::Paths);
            asked.seed = seed;
            let hit = |attempt| FaultyAuthor::new(Scripted::says(&good_paths()), only(FaultKind::Gdisc, 0.3), attempt);
            let injected = |answer: Answer| !answer.injected.is_empty();
            let (one, two) = (hit(1).ask(&asked).await.unwrap(), hit(2).ask(&asked).await.unwrap());
            let again = hit(1).ask(&asked).await.unwrap();
            assert_eq!(one, again);
            let (one, two) = (injected(one), injected(two));
            struck += u32::from(one);
            differs |= one != two;
        }
        assert!((90..150).contains(&struck), "{struck} of 400 at a rate of 0.3");
        assert!(differs);
    }

    #[tokio::test]
    async fn first_only_leaves_later_attempts_alone() {
        let rates = FaultRates { first_only: true, ..only(FaultKind::Trunc, 1.0) };
        let asked = question(Stage::Paths);
        assert!(attempt(&FaultyAuthor::new(Scripted::says(&good_paths()), rates.clone(), 1), &asked).await.is_err());
        assert!(attempt(&FaultyAuthor::new(Scripted::says(&good_paths()), rates, 2), &asked).await.is_ok());
    }
}
