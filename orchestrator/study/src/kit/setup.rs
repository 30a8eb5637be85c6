//! What a study file says about the survey: texts for participants, and the bundles that films come from.

use serde::Deserialize;

use crate::design::Design;
use crate::problem::Problem;

/// What participants read besides films and questions.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Survey {
    /// What people agree to, paragraphs parted by empty lines; `[words in brackets]` are open slots. `[minutes]` is filled where films
    /// have lengths.
    pub consent: Consent,
    /// What is said before the first film, behind how people and robot are drawn.
    pub instructions: String,
    /// Code that proves at the recruiting platform that somebody came to the end; shown last, and in no file of the kit.
    pub completion_code: Option<String>,
    /// Page of the recruiting platform that people are sent back to.
    pub completion_url: Option<String>,
}

/// The default text of consent: what ethics boards ask for, with slots for what nobody else can know.
pub const CONSENT: &str = "You are invited to take part in a study of how robots move among people. It is done by [name and \
institution].\n\nYou will watch short films and answer questions about them. There are no right or wrong answers. Nothing in the films is \
meant to upset anybody.\n\nIt takes about [minutes] minutes. You are paid [amount and currency] for it, also if you stop for a reason that lies \
with us.\n\nTaking part is voluntary. You may stop at any time, without giving a reason, by closing this page; what you \
have answered until then can be deleted if you write to us within [days] days.\n\nWe keep your answers and the times you took, under a \
random name. We do not keep your network address, your place or anything else that tells who you are. Answers are published without \
names.\n\nQuestions: [mail]. Ethics approval: [board and number].";

/// The slot for how long it takes.
pub const MINUTES: &str = "minutes";

impl Default for Survey {
    fn default() -> Self {
        Self {
            consent: Consent::from(CONSENT.to_owned()),
            instructions: String::new(),
            completion_code: None,
            completion_url: None,
        }
    }
}

/// A text that people agree to.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(from = "String")]
pub struct Consent {
    /// Its paragraphs.
    pub paragraphs: Vec<String>,
    /// Slots that nobody has filled.
    pub open_slots: Vec<String>,
}

impl From<String> for Consent {
    fn from(text: String) -> Self {
        let paragraphs = text.split("\n\n").map(|part| part.trim().replace('\n', " "));
        let slots = text.split('[').skip(1).filter_map(|part| part.split_once(']').map(|(slot, _)| slot.to_owned()));
        Self { open_slots: slots.collect(), paragraphs: paragraphs.filter(|part| !part.is_empty()).collect() }
    }
}

impl Consent {
    /// As text: an empty line between paragraphs.
    #[must_use]
    pub fn text(&self) -> String {
        self.paragraphs.join("\n\n")
    }

    /// Writes words into a slot, wherever it stands.
    pub(crate) fn fill(&mut self, slot: &str, words: &str) {
        let written = format!("[{slot}]");
        self.paragraphs.iter_mut().for_each(|part| *part = part.replace(&written, words));
        self.open_slots.retain(|open| open != slot);
    }
}

/// The text that participants of a study agree to.
///
/// # Errors
/// It is to say how long taking part lasts, and no film has a length.
pub fn agreed(design: &Design) -> Result<&Consent, Problem> {
    let consent = &design.survey.consent;
    if consent.open_slots.iter().any(|slot| slot == MINUTES) {
        let hint = "give films their `length_s`, from which the minutes follow, or write the minutes yourself";
        return Err(Problem::new("the study", "no film has a length, and people would read the open slot", hint)
            .column("survey.consent")
            .value(&format!("[{MINUTES}]")));
    }
    Ok(consent)
}

/// Where a film is seen from.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "String")]
pub enum View {
    /// From above.
    #[default]
    Above,
    /// By the person of this number.
    Person(u32),
}

impl TryFrom<String> for View {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if text == ABOVE {
            return Ok(Self::Above);
        }
        let number = text.strip_prefix("human_").and_then(|number| number.parse().ok()).filter(|number| *number > 0);
        number.map(Self::Person).ok_or_else(|| format!("`{text}` is no view: `{ABOVE}`, or a person such as `human_2`"))
    }
}

impl std::fmt::Display for View {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Above => f.write_str(ABOVE),
            Self::Person(number) => write!(f, "human_{number}"),
        }
    }
}

/// Where the films of a scenario come from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The scenario, as films name it.
    pub name: String,
    /// Bundles with its runs, relative to the study file.
    pub bundles: Vec<String>,
    /// What people read before a film of it: the place, and what the robot is to do there.
    #[serde(default)]
    pub context: String,
    /// `above`, or the person whose eyes it is seen with, such as `human_2`.
    #[serde(default)]
    pub view: View,
    /// Longest film, s; of what lasts longer the end is not shown, in all films of the scenario alike.
    #[serde(default = "longest")]
    pub longest_s: f64,
}

/// Width of what is seen in a film in first person, degrees; the films are drawn so.
pub const FIELD_DEGREES: f64 = 100.0;
/// Height of its eyes, m.
pub const EYE_M: f64 = 1.6;
/// The word for a film from above.
pub const ABOVE: &str = "above";

const fn longest() -> f64 {
    45.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_consent_has_slots_and_paragraphs() {
        let consent = Survey::default().consent;
        assert_eq!(
            consent.open_slots,
            ["name and institution", MINUTES, "amount and currency", "days", "mail", "board and number"]
        );
        assert_eq!(consent.paragraphs.len(), 6);
        assert_eq!(Consent::from(consent.text()), consent);
    }

    #[test]
    fn the_minutes_follow_from_films_and_items_or_the_survey_is_refused() {
        let text = "title = \"t\"\nplanners = [\"mppi\", \"ha\"]\nparticipants = 42\ninstruments = [\"psi\"]\nfilm = [\
            { id = \"k7f\", scenario = \"s\", planner = \"mppi\", length_s = 20 }, { id = \"q2b\", scenario = \"s\", planner = \"ha\", length_s = 20 }]\n";
        let design = Design::parse(text, "study.toml").unwrap();
        let told = agreed(&design).unwrap();
        // 4 min, two films of 20 s, eight items of 5 s about each.
        assert!(told.text().contains("It takes about 6 minutes.") && !told.open_slots.contains(&MINUTES.to_owned()));
        assert_eq!(told.open_slots.len(), 5, "what nobody else can know stays open");
        let unknown = Design::parse(&text.replace(", length_s = 20", ""), "study.toml").unwrap();
        for why in [crate::kit::page::page(&unknown), crate::kit::jspsych::jspsych(&unknown)] {
            let why = why.unwrap_err().to_string();
            assert!(why.contains("`survey.consent` is `[minutes]`") && why.contains("length_s"), "{why}");
        }
        let own = format!("{}[survey]\nconsent = \"It takes 5 minutes.\"\n", text.replace(", length_s = 20", ""));
        assert!(agreed(&Design::parse(&own, "study.toml").unwrap()).is_ok());
    }

    #[test]
    fn a_view_is_from_above_or_by_a_person() {
        let view = |text: &str| View::try_from(text.to_owned());
        assert_eq!((view("above"), view("human_2")), (Ok(View::Above), Ok(View::Person(2))));
        assert!(view("robot").unwrap_err().contains("`robot` is no view") && view("human_0").is_err());
    }
}
