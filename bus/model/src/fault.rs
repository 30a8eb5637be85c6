//! Faults: typed reasons why an attempt failed, with a stable code and what to do about it.
//!
//! A fault says *what* by its [`FaultCode`], *where* by its [`Where`], and carries the facts that later code decides by as a
//! [`Payload`]. Its [`Message`] is for people and authors to read: the type gives it to a display and to nothing else.

mod codes;
mod place;
mod text;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::job::Stage;

pub use codes::{Family, FaultCode};
pub use place::{Span, Where};
pub use text::{Label, Message, mask_messages};

/// How the orchestrator treats a failure: what is transient is tried again after a pause with full jitter, a wrong answer is
/// asked again with its faults, and what no repetition mends ends the job at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FailureClass {
    /// Passing: time-out, 5xx, no reply. Wait and retry.
    Transient,
    /// Too much asked of a shared resource: 429. Wait as told, shrink the bucket.
    Overload,
    /// A wrong answer: ask again with the reasons.
    Semantic,
    /// A cut or unreadable answer: ask again with a fixed short reason.
    Unparsable,
    /// The worker died or was lost.
    WorkerDeath,
    /// The job kills its worker or cannot be decoded.
    Poison,
    /// Cannot get better by itself: missing map, wrong configuration, unauthorized.
    Permanent,
}

impl FailureClass {
    /// From the heaviest to the lightest: what cannot get better, then a wrong answer, then an unreadable one, then passing trouble.
    /// A job that breaks its worker outweighs a wrong configuration: with the configuration mended it would break the next worker.
    const BY_WEIGHT: [Self; 7] = [
        Self::Poison,
        Self::Permanent,
        Self::Semantic,
        Self::Unparsable,
        Self::Overload,
        Self::WorkerDeath,
        Self::Transient,
    ];

    /// The class of a failure with these faults: that of its heaviest hard fault.
    ///
    /// A failure without a hard fault is a wrong answer: it is asked again within the budget and the number of tries of its job. As
    /// passing trouble it would be repeated outside of the budget, and would count against every job of its stage.
    #[must_use]
    pub fn of(faults: &[Fault]) -> Self {
        let has = |class: &Self| faults.iter().any(|fault| !fault.is_soft() && fault.code.class() == *class);
        Self::BY_WEIGHT.into_iter().find(has).unwrap_or(Self::Semantic)
    }
}

/// What the orchestrator does about a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Remedy {
    /// Ask the same stage again with the reason.
    AskAgain,
    /// Wait, then try the same again.
    Wait,
    /// Go back to this stage with the reason.
    BackTo(Stage),
    /// Repair without the author (counted apart).
    Repair,
    /// Ask a person.
    AskPerson,
    /// Stop.
    Stop,
}

/// A fact about a fault that later code decides by. Whatever only people read stays in the message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Payload {
    /// P-READ: words say when something happens, and nobody does anything then.
    TriggerAlone,
}

/// One fault: code, where, and the exact message that the author reads next.
///
/// Stored in artifacts, in rows of the job store and in reports, and sent on the bus. A reader of this version also reads
/// faults of versions before `at` was an object, when it was a text: the text becomes the [`Where::key`]. A reader of such a
/// version refuses faults of this one, and names the field; a fault without place and payload is read by neither as another
/// than it is.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema, thiserror::Error)]
#[error("{code}{}{at}: {message}", if .at.is_nowhere() { "" } else { " " })]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// Code.
    pub code: FaultCode,
    /// Agent, step, node, file and line, or key.
    #[serde(default)]
    pub at: Where,
    /// What was found and what is allowed, with every value.
    pub message: Message,
    /// Words of the request that it is about, as written there; empty where it is about none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quotes: Vec<String>,
    /// What later code decides by, where the code and the place do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<Payload>,
}

impl Fault {
    /// A fault.
    pub fn new(code: FaultCode, at: impl Into<Where>, message: impl Into<Message>) -> Self {
        Self { code, at: at.into(), message: message.into(), quotes: Vec::new(), payload: None }
    }

    /// The same fault, about these words of the request.
    #[must_use]
    pub fn about(mut self, quotes: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.quotes.extend(quotes.into_iter().map(Into::into));
        self
    }

    /// The same fault with this fact.
    #[must_use]
    pub fn with(mut self, payload: Payload) -> Self {
        self.payload = Some(payload);
        self
    }

    /// The same fault of this agent, where it names none.
    #[must_use]
    pub fn of(mut self, agent: impl Into<crate::AgentId>) -> Self {
        self.at = self.at.of(agent);
        self
    }

    /// Whether both give the same reason, whatever their messages say.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        (self.code, &self.at, &self.quotes, self.payload) == (other.code, &other.at, &other.quotes, other.payload)
    }

    /// Whether it is only a warning.
    #[must_use]
    pub const fn is_soft(&self) -> bool {
        self.code.is_soft()
    }

    /// The same fault with at most so many characters of message, and of each text of its place.
    #[must_use]
    pub fn shortened(self, message: usize, place: usize) -> Self {
        Self { at: self.at.shortened(place), message: self.message.shortened(message), ..self }
    }

    /// Bytes of its texts, for limits of messages on the bus.
    #[must_use]
    pub fn text_bytes(&self) -> usize {
        self.at.to_string().len() + self.message.bytes()
    }
}

/// The faults that fail an attempt.
#[must_use]
pub fn hard(faults: &[Fault]) -> Vec<Fault> {
    faults.iter().filter(|fault| !fault.is_soft()).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AgentId, HumanId};

    #[test]
    fn the_heaviest_hard_fault_gives_the_class() {
        use FaultCode::{EJson, GDisc, JLost, JSpec, PContra, PLabel, PRead, T429, TNet};
        let of = |codes: &[FaultCode]| {
            FailureClass::of(&codes.iter().map(|code| Fault::new(*code, "x", "y")).collect::<Vec<_>>())
        };
        let by_weight = [JSpec, PContra, GDisc, EJson, T429, JLost, TNet];
        for (place, code) in by_weight.iter().enumerate() {
            let lighter: Vec<FaultCode> = by_weight[place..].iter().rev().copied().collect();
            assert_eq!(of(&lighter), code.class(), "{lighter:?}");
        }
        assert_eq!(by_weight.map(FaultCode::class), FailureClass::BY_WEIGHT);
        assert_eq!(of(&[PRead, TNet]), FailureClass::Transient, "a soft fault is only a warning");
        assert_eq!((of(&[PLabel]), of(&[])), (FailureClass::Semantic, FailureClass::Semantic));
    }

    #[test]
    fn a_fault_is_written_as_an_object_and_read_back() {
        let at = Where::agent(AgentId::Robot).step(3);
        let fault = Fault::new(FaultCode::GDisc, at, "jumps").about(["to the exit"]).with(Payload::TriggerAlone);
        let text = serde_json::to_string(&fault).unwrap();
        let written = r#"{"code":"G-DISC","at":{"agent":"robot","step":3},"message":"jumps","quotes":["to the exit"],"payload":"trigger_alone"}"#;
        assert_eq!(text, written);
        assert_eq!(serde_json::from_str::<Fault>(&text).unwrap(), fault);
        let plain = Fault::new(FaultCode::EJson, Where::default(), "is no JSON");
        assert_eq!(serde_json::to_string(&plain).unwrap(), r#"{"code":"E-JSON","at":{},"message":"is no JSON"}"#);
        assert_eq!(plain.to_string(), "E-JSON: is no JSON");
    }

    #[test]
    fn a_fault_of_the_version_before_is_read() {
        let old = r#"{"code":"G-DISC","at":"robot step 3","message":"jumps"}"#;
        let fault: Fault = serde_json::from_str(old).unwrap();
        assert_eq!(fault, Fault::new(FaultCode::GDisc, Where::key("robot step 3"), "jumps"));
        assert_eq!(fault.to_string(), "G-DISC robot step 3: jumps");
        let strange = serde_json::from_str::<Fault>(r#"{"code":"G-DISC","at":{"agnt":"robot"},"message":"x"}"#);
        assert!(strange.unwrap_err().to_string().contains("`agnt`"));
    }

    #[test]
    fn a_fault_gets_the_agent_it_does_not_name() {
        let fault = Fault::new(FaultCode::BXml, Where::default().line(3).column(5), "x");
        assert_eq!(fault.clone().of(HumanId::new(2)).at.to_string(), "human_2 3:5");
        assert_eq!(fault.of(HumanId::new(2)).of(HumanId::new(1)).at.to_string(), "human_2 3:5");
    }

    #[test]
    fn long_texts_are_cut_by_characters() {
        let fault = Fault::new(FaultCode::MRead, Where::file("äöü.yaml").line(2), "ßßß");
        let short = fault.shortened(2, 3);
        assert_eq!(short.to_string(), "M-READ äöü:2: ßß");
        assert_eq!(short.text_bytes(), "äöü:2".len() + 4);
    }
}
