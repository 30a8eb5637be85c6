//! The fault model: which kinds of faults there are, and which of them strike an answer. Pure: a strike is a function of
//! rates, seeds, attempt and what the question says of the answer before.
//!
//! ```text
//! first answer:  each kind strikes at its rate
//! asked again:   a kind that was found comes again with probability ρ, else strikes at its rate;
//!                with probability `collateral` a kind is added that was not there
//! ρ = 1 − fix_if_named, 1 − fix_if_vague or 1 − fix_if_none, by what the author is told
//! ```
//!
//! With one kind a stage, a share d of faulty answers that is found and K attempts, a stage
//! ends right with probability [`expected`].

use std::collections::BTreeMap;
use std::str::FromStr;

use socrates_model::job::Stage;
use socrates_model::seeds::derive_seed;
use socrates_model::{Family, Fault, FaultCode};
use socrates_prompts::{Question, Telling};

use crate::author::AskError;

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

            /// What is wrong, in a sentence.
            #[must_use]
            pub const fn about(self) -> &'static str {
                match self { $(Self::$name => $about,)* }
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
    Pname "pname" PName "A human has a wrong name.";
    Pverify "pverify" PVerify "A clause is missing.";
    Pcap "pcap" PCap "A behavior cannot be simulated.";
    Pother "pother" POther "A behavior depends on another human.";
    Pplace "pplace" PPlace "The place is none of the map.";
    Prough "prough" PRough "A wish of the request is forgotten.";
    Probot "probot" PRobot "The robot has nothing that is expected of it.";
    Gdisc "gdisc" GDisc "A node in the middle of the robot's path is missing.";
    Gunknown "gunknown" GUnknown "A node has a look-alike name.";
    Gempty "gempty" GEmpty "The robot's path has no node.";
    Gshort "gshort" GShort "The robot's path is too short.";
    Gmeet "gmeet" GMeet "An encounter is not on the robot's path.";
    Gmeetend "gmeetend" GMeetEnd "The robot's path ends at the encounter.";
    Gagents "gagents" GAgents "There is a path for a stranger.";
    Gcoll "gcoll" GColl "A human starts where the robot does.";
    Gtype "gtype" GType "The encounters are at another kind of place.";
    Grel "grel" GRel "A human walks with the robot, or against it, where it was to do otherwise.";
    Ggrp "ggrp" GGrp "A member of a group is far from the others.";
    Bagents "bagents" BAgents "A tree is missing.";
    Bxml "bxml" BXml "A tree is cut XML.";
    Bmain "bmain" BMain "The main tree has another name.";
    Bnode "bnode" BNode "A node has a wrong tag.";
    Bport "bport" BPort "A node lacks an attribute.";
    Brange "brange" BRange "A distance is out of range.";
    Barity "barity" BArity "A decorator has no child.";
    Bnav "bnav" BNav "Nothing walks along the path.";
    Btimer "btimer" BTimer "A timer comes after the motion that it should end.";
    Border "border" BOrder "A motion comes before its condition.";
    Bdead "bdead" BDead "A rule can never run.";
    Bmove2 "bmove2" BMove2 "A reaction has two motions.";
    Bstill "bstill" BStill "A reaction has no motion.";
    Blatch "blatch" BLatch "A gesture is never taken back.";
    Bhear "bhear" BHear "A rule waits for a gesture that nobody makes.";
    Bcode "bcode" BCode "A gesture has a name in place of its code.";
    Bmatch "bmatch" BMatch "A rule of the proposal is missing.";
    Bcontra "bcontra" BContra "Two rules want different motions at once.";
}

impl FaultKind {
    /// Whether it comes in place of an answer: no text is there that could be changed.
    #[must_use]
    pub const fn is_of_server(self) -> bool {
        matches!(self, Self::T429 | Self::T5xx | Self::Tnet | Self::Timeout | Self::Refusal)
    }
}

impl FromStr for FaultKind {
    type Err = AskError;
    fn from_str(text: &str) -> Result<Self, AskError> {
        Self::ALL.iter().copied().find(|kind| kind.word() == text).ok_or_else(|| {
            let words: Vec<&str> = Self::ALL.iter().map(|kind| kind.word()).collect();
            let message = format!("`{text}` is no kind of fault; allowed: {}, {OTHERS}", words.join(", "));
            AskError::new(FaultCode::JRequest, message)
        })
    }
}

/// Settings beside the rates, for messages.
const OTHERS: &str = "first_only, sticky, fix_if_named, fix_if_vague, fix_if_none, collateral, seed";

/// How often each kind of fault is put in, and what becomes of it when the author is asked again.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultRates {
    /// Probability per ask and kind, 0 to 1.
    pub rates: BTreeMap<FaultKind, f64>,
    /// Whether only the first attempt is touched. Default false.
    pub first_only: bool,
    /// Probability that a found fault comes again whatever the author is told; without one, as `fix_if_…` say.
    pub sticky: Option<f64>,
    /// Probability that a found fault is gone when the reasons name it. Default 0.7.
    pub fix_if_named: f64,
    /// The same where the author is only told that its answer was wrong. Default 0.4.
    pub fix_if_vague: f64,
    /// The same where it is asked the same question again. Default 0: the same question has the same answer.
    pub fix_if_none: f64,
    /// Probability that an answer to a question that is asked again has a fault that was not there before. Default 0.05.
    pub collateral: f64,
    /// What the author is told of its refused answer; of the style, not of the rates. Default everything.
    pub told: Telling,
    /// Seed of the experiment, beside the question's own. Default 0.
    pub seed: u64,
}

impl Default for FaultRates {
    fn default() -> Self {
        Self {
            rates: BTreeMap::new(),
            first_only: false,
            sticky: None,
            fix_if_named: 0.7,
            fix_if_vague: 0.4,
            fix_if_none: 0.0,
            collateral: 0.05,
            told: Telling::Named,
            seed: 0,
        }
    }
}

/// What the fault model looks at of a question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked<'a> {
    /// Stage.
    pub stage: Stage,
    /// Seed of the question.
    pub seed: u64,
    /// Attempt, from 1.
    pub attempt: u32,
    /// Faults that were found in the answer before; empty where there is none that the author is to mend.
    pub found: &'a [Fault],
}

impl<'a> Asked<'a> {
    /// What a question and its attempt say. Where the refused answer is not in the question the author begins anew and has
    /// nothing that could come again.
    #[must_use]
    pub fn of(question: &'a Question, attempt: u32) -> Self {
        let found = if question.refused.is_some() { question.feedback.as_slice() } else { &[] };
        Self { stage: question.stage, seed: question.seed, attempt, found }
    }
}

impl FaultRates {
    /// The rates in a job's settings: `fault.gdisc = "0.3"` (or `fault_rate.gdisc`), `fault.first_only = "true"`,
    /// `fault.sticky`, `fault.fix_if_named`, `fault.fix_if_vague`, `fault.fix_if_none`, `fault.collateral`, `fault.seed`.
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
                "sticky" => rates.sticky = Some(probability()?),
                "fix_if_named" => rates.fix_if_named = probability()?,
                "fix_if_vague" => rates.fix_if_vague = probability()?,
                "fix_if_none" => rates.fix_if_none = probability()?,
                "collateral" => rates.collateral = probability()?,
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

    /// Probability that a found fault comes again by itself.
    #[must_use]
    pub fn repeats(&self) -> f64 {
        let mended = match self.told {
            Telling::Named => self.fix_if_named,
            Telling::Vague => self.fix_if_vague,
            Telling::Silent => self.fix_if_none,
        };
        self.sticky.unwrap_or(1.0 - mended)
    }

    /// A draw that depends on experiment, question, attempt and kind alone: neither the number of workers nor their order
    /// changes it.
    pub(crate) fn draw(&self, asked: &Asked<'_>, of: &str, what: &str) -> u64 {
        let base = asked.seed ^ self.seed.rotate_left(17);
        derive_seed(base, &["fault", asked.stage.name(), of, &asked.attempt.to_string(), what])
    }

    /// The kinds that strike this answer, in order.
    #[must_use]
    pub fn struck(&self, asked: &Asked<'_>) -> Vec<FaultKind> {
        if self.first_only && asked.attempt > 1 {
            return Vec::new();
        }
        let repeats = self.repeats();
        let strikes = |kind: FaultKind, rate: f64| {
            let found = asked.found.iter().any(|fault| fault.code == kind.code());
            let again = found && share(self.draw(asked, kind.word(), "sticky")) < repeats;
            again || share(self.draw(asked, kind.word(), "rate")) < rate
        };
        let mut struck: Vec<FaultKind> =
            self.rates.iter().filter(|(kind, rate)| strikes(**kind, **rate)).map(|(kind, _)| *kind).collect();
        if !asked.found.is_empty() && share(self.draw(asked, "collateral", "rate")) < self.collateral {
            let added = self.added(asked, &struck);
            struck.extend(added);
            struck.sort_unstable();
        }
        struck
    }

    /// A kind that is not there yet, in proportion to the rates.
    fn added(&self, asked: &Asked<'_>, there: &[FaultKind]) -> Option<FaultKind> {
        let others: Vec<(FaultKind, f64)> = self
            .rates
            .iter()
            .map(|(kind, rate)| (*kind, *rate))
            .filter(|(kind, rate)| *rate > 0.0 && concerns(*kind, asked.stage) && !there.contains(kind))
            .collect();
        let mut left =
            share(self.draw(asked, "collateral", "which")) * others.iter().map(|(_, rate)| rate).sum::<f64>();
        others
            .into_iter()
            .find(|(_, rate)| {
                left -= rate;
                left < 0.0
            })
            .map(|(kind, _)| kind)
    }
}

/// Probability that a stage ends with a right answer: faults strike with probability `rate`, a share
/// `detected` of the faulty answers is found and asked again, `attempts` answers are given at most, and a found fault comes
/// again with probability `repeats`, else the next answer is drawn as the first.
///
/// With n answers left, Rₙ = ρ d Rₙ₋₁ + (1 − ρ) (1 − q + q d Rₙ₋₁) and R₀ = 0; the stage ends right with 1 − q + q d Rₖ₋₁.
#[must_use]
pub fn expected(rate: f64, detected: f64, attempts: u32, repeats: f64) -> f64 {
    let fresh = |after: f64| 1.0 - rate + rate * detected * after;
    let mut after = 0.0;
    for _ in 1..attempts {
        after = repeats * detected * after + (1.0 - repeats) * fresh(after);
    }
    if attempts == 0 { 0.0 } else { fresh(after) }
}

/// A draw as a share in [0, 1).
#[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
pub(crate) fn share(draw: u64) -> f64 {
    (draw >> 11) as f64 / (1_u64 << 53) as f64
}

/// Whether a stage has this kind of fault at all.
#[must_use]
pub fn concerns(kind: FaultKind, stage: Stage) -> bool {
    match kind.code().family() {
        Family::Proposal => stage == Stage::Proposal,
        Family::Paths => stage == Stage::Paths,
        Family::Behaviors => stage == Stage::Behaviors,
        Family::Transport | Family::Answer | Family::Dynamic | Family::Map | Family::Job => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates of a stage's residual faults: proposal, paths, behaviors of each of two humans. One choice of many that gives the four
    /// shares of right scenarios in SocRATES (arXiv 2412.19595): 73 of 100, 22 of 40, 30 of 100 and 2 of 20.
    const PROFILES: [(&str, [f64; 3]); 4] = [
        ("paper-guided", [0.02, 0.10, 0.09]),
        ("paper-unguided", [0.08, 0.17, 0.15]),
        ("naive-guided", [0.05, 0.35, 0.30]),
        ("naive-unguided", [0.20, 0.50, 0.50]),
    ];
    /// Columns of the table: share that is found, attempts, chance to come again.
    const COLUMNS: [(f64, u32, f64); 6] =
        [(0.0, 1, 0.0), (0.5, 3, 0.3), (0.8, 3, 0.3), (0.95, 3, 0.3), (0.95, 5, 0.3), (0.95, 3, 0.6)];
    /// Shares of right scenarios by the closed form, worked out apart from this code: a row a profile, a column a setting.
    const CELLS: [[f64; 6]; 4] = [
        [0.730, 0.825, 0.901, 0.945, 0.973, 0.873],
        [0.552, 0.690, 0.812, 0.887, 0.946, 0.764],
        [0.303, 0.457, 0.614, 0.718, 0.857, 0.543],
        [0.100, 0.203, 0.334, 0.432, 0.647, 0.267],
    ];
    /// Scenarios that are drawn for a cell.
    const DRAWN: u32 = 4_000;

    /// The questions of a scenario: stage, the kind that stands for its residual faults, number of the rate.
    const QUESTIONS: [(Stage, FaultKind, usize); 4] = [
        (Stage::Proposal, FaultKind::Pverify, 0),
        (Stage::Paths, FaultKind::Gshort, 1),
        (Stage::Behaviors, FaultKind::Bmatch, 2),
        (Stage::Behaviors, FaultKind::Bmatch, 2),
    ];

    /// Whether the answer that is taken in the end is right: the loop of the orchestrator with the model's draws.
    fn ends_right(rates: &FaultRates, stage: Stage, seed: u64, (detected, attempts): (f64, u32)) -> bool {
        let mut found: Vec<Fault> = Vec::new();
        for attempt in 1..=attempts {
            let asked = Asked { stage, seed, attempt, found: &found };
            let struck = rates.struck(&asked);
            let Some(kind) = struck.first() else { return true };
            if share(rates.draw(&asked, kind.word(), "found")) >= detected {
                return false;
            }
            found = vec![Fault::new(kind.code(), "answer", "is wrong")];
        }
        false
    }

    #[test]
    fn the_closed_form_gives_the_table() {
        for ((name, rates), cells) in PROFILES.iter().zip(CELLS) {
            for ((detected, attempts, repeats), cell) in COLUMNS.iter().zip(cells) {
                let found: f64 = QUESTIONS
                    .iter()
                    .map(|(.., place)| expected(rates[*place], *detected, *attempts, *repeats))
                    .product();
                assert!(
                    (found - cell).abs() <= 0.000_6,
                    "{name} d {detected} K {attempts} ρ {repeats}: {found:.4}, {cell}"
                );
            }
        }
    }

    #[test]
    fn the_drawn_faults_give_the_table_within_sampling_error() {
        for ((name, rates), cells) in PROFILES.iter().zip(CELLS) {
            for ((detected, attempts, repeats), cell) in COLUMNS.iter().zip(cells) {
                let model = |kind: FaultKind, rate: f64| FaultRates {
                    rates: BTreeMap::from([(kind, rate)]),
                    fix_if_named: 1.0 - repeats,
                    collateral: 0.0,
                    ..FaultRates::default()
                };
                let right = (0..DRAWN)
                    .filter(|scenario| {
                        QUESTIONS.iter().zip(0_u32..).all(|((stage, kind, place), number)| {
                            let seed = derive_seed(u64::from(*scenario), &[name, &number.to_string()]);
                            ends_right(&model(*kind, rates[*place]), *stage, seed, (*detected, *attempts))
                        })
                    })
                    .count();
                let found = f64::from(u32::try_from(right).unwrap()) / f64::from(DRAWN);
                // Four standard errors: one false alarm in 16 000 cells, and the same draws every time.
                let error = 4.0 * (cell * (1.0 - cell) / f64::from(DRAWN)).sqrt();
                assert!((found - cell).abs() <= error, "{name} d {detected} K {attempts} ρ {repeats}: {found}, {cell}");
            }
        }
    }

    #[test]
    fn more_said_is_more_mended_and_a_new_beginning_repeats_nothing() {
        let found = [Fault::new(FaultCode::GDisc, "robot", "jumps")];
        let again = |told: Telling, found: &[Fault]| {
            let rates = FaultRates { rates: BTreeMap::from([(FaultKind::Gdisc, 0.0)]), told, ..FaultRates::default() };
            (0..1_000)
                .filter(|seed| !rates.struck(&Asked { stage: Stage::Paths, seed: *seed, attempt: 2, found }).is_empty())
                .count()
        };
        let counts = [Telling::Named, Telling::Vague, Telling::Silent].map(|told| again(told, &found));
        assert!((250..350).contains(&counts[0]) && (550..650).contains(&counts[1]) && counts[2] == 1_000, "{counts:?}");
        assert_eq!(again(Telling::Silent, &[]), 0);
    }

    #[test]
    fn asking_again_may_break_something_else() {
        let rates = FaultRates {
            rates: BTreeMap::from([(FaultKind::Gdisc, 0.0), (FaultKind::Gmeet, 1e-9), (FaultKind::Bdead, 0.5)]),
            collateral: 0.2,
            ..FaultRates::default()
        };
        let found = [Fault::new(FaultCode::EJson, "answer", "is no JSON")];
        let count = |found: &[Fault]| {
            let asked = |seed| Asked { stage: Stage::Paths, seed, attempt: 2, found };
            (0..1_000).filter(|seed| rates.struck(&asked(*seed)).contains(&FaultKind::Gmeet)).count()
        };
        // Of the kinds of this stage only one has a rate.
        assert!((150..250).contains(&count(&found)), "{}", count(&found));
        assert_eq!(count(&[]), 0, "a first answer has no collateral faults");
    }
}
