//! Steps of a form: what somebody does, when it begins and what ends it; and the rules that they make.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Form, FormHuman, Pace, PlaceWord};
use crate::act::{ACTS, ActRow, Action, Destination, Translate};
use crate::gesture::Gesture;
use crate::ids::{AgentId, HumanId};
use crate::rule::{Rule, Trigger};

/// One step of `does`, or one rule of `reacts`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// All of these must hold for it to begin; empty in `does`: as soon as the step before has ended.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub when: Vec<When>,
    /// What is done. Default `stand_still` where something is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub act: Option<Deed>,
    /// For how long, s; without: as long as it takes, or to the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// It ends when all of these hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub until: Vec<When>,
    /// Gesture made with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub say: Option<Gesture>,
    /// To whom: a person, `robot`, or `all`. Default: whoever notices it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// A trigger of a form: people by name.
pub type When = Trigger<String>;

/// An act of a form: people and places by name, paces in words.
pub type Deed = Action<String, PlaceWord, Pace>;

impl When {
    /// Its number, with what it may be and what it counts.
    pub(crate) fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        let meters = self.distance_m().map(|m| (m, [0.3, 15.0], "m"));
        meters.or_else(|| self.secs().map(|s| (s, [0.1, 600.0], "s")))
    }
}

impl Deed {
    /// How near somebody may come up to the robot, m: bodies touch at 0.55 m.
    const NEAR_M: [f64; 2] = [0.7, 2.0];

    /// The acts, for messages.
    pub(crate) fn allowed() -> String {
        let words: Vec<String> = ACTS.iter().map(ActRow::toml).collect();
        words.join(", ")
    }

    /// Its number, with what it may be and what it counts.
    pub(crate) fn number(&self) -> Option<(f64, [f64; 2], &'static str)> {
        if let Self::ApproachTo(near_m) = self {
            return Some((*near_m, Self::NEAR_M, "m"));
        }
        if let Self::ChangePace(pace) = self { pace.mps().map(|mps| (mps, Pace::MPS, "m/s")) } else { None }
    }
}

/// The words of a form as what they mean in a run; nodes of places are those of a map, and come later.
impl Translate<String, PlaceWord, Pace> for Form {
    type Person = HumanId;
    type Place = Destination;
    type Pace = f64;

    fn person(&self, name: &String) -> Option<HumanId> {
        self.one(name)
    }

    fn place(&self, place: &PlaceWord) -> Option<Destination> {
        Some(Destination { place: place.to_string().replace('_', " "), nodes: Vec::new() })
    }

    fn pace(&self, pace: &Pace) -> Option<f64> {
        Some(pace.mps().unwrap_or(Step::NORMAL_MPS))
    }
}

impl Step {
    /// A sign without an act lasts so long, s.
    pub const SIGN_S: f64 = 2.0;
    /// Another pace is taken up in so much time, s; it stays.
    pub const PACE_S: f64 = 1.0;
    /// Usual walking speed, m/s: what `normal` means for a pace that changes.
    const NORMAL_MPS: f64 = 1.2;

    /// For how long it lasts at most, s: as stated; a sign for a moment where nothing else is said.
    fn lasts_s(&self) -> Option<f64> {
        let sign = self.act.is_none() && self.say.is_some() && self.until.is_empty();
        let pace = matches!(self.act, Some(Deed::ChangePace(_))) && self.until.is_empty();
        self.for_s.or_else(|| sign.then_some(Self::SIGN_S)).or_else(|| pace.then_some(Self::PACE_S))
    }

    /// What ends it by itself.
    fn by_itself(&self) -> Option<Trigger> {
        let open = self.lasts_s().is_none() && self.until.is_empty();
        self.act.as_ref().filter(|_| open).and_then(|act| act.row().ends.clone())
    }

    /// Whether nothing ends it but the end of the run.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.lasts_s().is_none() && self.until.is_empty() && self.by_itself().is_none()
    }
}

impl Form {
    /// `does` and `reacts` as rules. A step of `does` begins when the one before it has ended and its own triggers hold, and goes on
    /// to its end.
    pub(super) fn rules(&self, id: HumanId, human: &FormHuman) -> Vec<Rule> {
        let mut rules: Vec<Rule> = human.reacts.iter().filter_map(|step| self.rule(step)).collect();
        for (number, step) in (1..).zip(&human.does) {
            let Some(mut rule) = self.rule(step) else { continue };
            if number > 1 {
                rule.when.retain(|trigger| *trigger != Trigger::Always);
                rule.when.insert(0, Trigger::Did(id, number - 1));
            }
            (rule.latched, rule.step) = (true, Some(number));
            rule.until = self.triggers(&step.until).unwrap_or_default();
            rule.until.extend(step.by_itself());
            rules.push(rule);
        }
        rules
    }

    fn rule(&self, step: &Step) -> Option<Rule> {
        let when = self.triggers(&step.when)?;
        let when = if when.is_empty() { vec![Trigger::Always] } else { when };
        let to = step.to.as_deref().filter(|_| step.say.is_some()).and_then(|name| self.agents(name).first().copied());
        let act = match (&step.act, to) {
            // A sign is made facing whomever it is made to.
            (None | Some(Deed::StandStill), Some(AgentId::Human(id))) => Action::LookAt(id),
            (None | Some(Deed::StandStill), Some(AgentId::Robot)) => Action::LookAtRobot,
            (None, None) => Action::StandStill,
            (Some(deed), _) => deed.translated(self)?,
        };
        Some(Rule { when, act, gesture: step.say, to, for_s: step.lasts_s(), ..Rule::default() })
    }

    fn triggers(&self, when: &[When]) -> Option<Vec<Trigger>> {
        let one = |when: &When| {
            let several = matches!(when, When::Done(_));
            let people = |name: &String| if several { self.named(name) } else { self.one(name).into_iter().collect() };
            Some(when.of_people(people)).filter(|all| several || !all.is_empty())
        };
        let all: Option<Vec<Vec<Trigger>>> = when.iter().map(one).collect();
        all.map(|all| all.concat())
    }
}
