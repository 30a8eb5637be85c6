//! The request: what the user gives.
//!
//! It is parsed once, where it is read ([`Request::of_toml`], [`Request::of_json`], or serde, which goes the same way),
//! into types that cannot be wrong. Nobody behind that door sees the text of a seed, a duration, a moment or an author.

mod author;
mod form;
#[cfg(test)]
mod form_tests;
mod people;
mod read;
mod steps;
mod tree;
mod values;
mod words;

use std::fmt;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

pub use author::{AuthorSpec, ServerKind};
pub use tree::TextPlace;
pub use values::{Duration, Moment, Seeds};

use crate::fault::FaultCode;
use crate::form::{Form, PlaceWord, RobotStep};
use crate::gesture::Gesture;
use crate::ids::HumanId;
use crate::person_model::PersonModel;
use crate::place::PlaceClass;
use crate::planner_name::PlannerName;
use crate::robot::RobotModel;
use crate::rule::{RobotDo, RobotRule};

/// A request as written in its TOML file. Unknown keys are refused.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// A shipped location's name, or a folder.
    pub location: String,
    /// Where and among whom the robot works, in a sentence.
    pub social_context: String,
    /// What the robot has to do, in a sentence.
    pub task: String,
    /// What should happen. Leave out for an unguided scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rough_scenario: Option<String>,
    /// Overrides the location's own description.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location_description: Option<String>,
    /// People, groups and order stated exactly; they win over the text.
    #[serde(default, flatten)]
    pub form: Form,
    /// The robot.
    #[serde(default)]
    pub robot: RobotRequest,
    /// People whom drivers outside move instead of the simulation: `people = { human_2 = "external:mine" }`. No author looks here.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub people: BTreeMap<HumanId, PersonModel>,
    /// How to run.
    #[serde(default)]
    pub run: RunRequest,
    /// Facts that win over the text.
    #[serde(default)]
    pub expect: Expect,
    /// Words of the texts that are given up: that they are not read or not played costs nothing, and stays visible.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waive: Vec<String>,
    /// Pinned proposal: a file beside the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposal: Option<String>,
    /// Pinned paths: a file beside the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paths: Option<String>,
    /// Pinned behaviors: a file beside the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub behaviors: Option<String>,
}

/// Which path nodes the planner is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Waypoints {
    /// Start and goal only.
    Ends,
    /// Start, goal and the nodes needed to keep the intended way.
    #[default]
    Via,
    /// Every node.
    All,
}

/// How much of what a text leaves open is drawn: by rules, a language model draws as it likes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Breadth {
    /// The usual: of places and ways those that are as good as the best, and distances that suit what is done.
    #[default]
    Usual,
    /// All that is natural: more places, ends of ways and sides, and nearer or farther moments of noticing the robot.
    Wide,
}

/// A gesture of the robot: `{ when = "blocked 3 s", say = "EXCUSE_ME" }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotGesture {
    /// `start`, `blocked N s`, `human within N m`, `after N s`.
    pub when: Moment,
    /// The gesture.
    pub say: Gesture,
}

impl RobotGesture {
    /// The line of the robot script that plays it.
    #[must_use]
    pub const fn line(&self) -> RobotRule {
        RobotRule { when: self.when.when(), act: RobotDo::Say(self.say) }
    }
}

/// The robot of a request.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RobotRequest {
    /// Robot model; default `linorobot2`.
    pub model: RobotModel,
    /// Planners under test; `reference` is always run, first. Default `["reference"]`.
    pub planners: Vec<PlannerName>,
    /// Which nodes of its path the planner is given. Default `via`.
    pub waypoints: Waypoints,
    /// Gestures the robot makes by itself.
    pub gestures: Vec<RobotGesture>,
    /// Where its way begins. Default: as the task says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<PlaceWord>,
    /// Planners of your own by name: Nav2's stack with a parameter file of yours, relative to the request, or its text.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub nav2: BTreeMap<PlannerName, String>,
    /// Where its way ends. Default: as the task says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlaceWord>,
    /// A place that its way leads past. Default: as the task says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub via: Option<PlaceWord>,
    /// Places that its way keeps out of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<PlaceWord>,
    /// Whether it comes back from its goal to where it began.
    #[serde(rename = "return", skip_serializing_if = "std::ops::Not::not")]
    pub returns: bool,
    /// What it does on its way.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub does: Vec<RobotStep>,
}

impl Default for RobotRequest {
    fn default() -> Self {
        Self {
            model: RobotModel::default(),
            planners: vec![PlannerName::reference()],
            waypoints: Waypoints::Via,
            gestures: Vec::new(),
            nav2: BTreeMap::new(),
            start: None,
            goal: None,
            via: None,
            avoid: Vec::new(),
            returns: false,
            does: Vec::new(),
        }
    }
}

/// How a request is run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RunRequest {
    /// Simulation seeds: `"1"`, `"1..20"`, `"1,4,9"`. Default: the base seed of the run, which is 1 unless it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seeds: Option<Seeds>,
    /// `"auto"` (until done, at most 120 s) or seconds such as `"60s"`. Default `auto`.
    pub duration: Duration,
    /// `auto`, `offline`, or `provider:model`. Default `auto`.
    pub author: AuthorSpec,
    /// Number of scenarios to make from this request, 1 to 100 000. Default 1.
    pub variants: u32,
    /// How much of what the text leaves open is drawn. Default `usual`; of several different variants `wide`.
    #[serde(skip_serializing_if = "is_usual")]
    pub breadth: Breadth,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
const fn is_usual(breadth: &Breadth) -> bool {
    matches!(breadth, Breadth::Usual)
}

impl Default for RunRequest {
    fn default() -> Self {
        Self { seeds: None, duration: Duration::Auto, author: AuthorSpec::Auto, variants: 1, breadth: Breadth::Usual }
    }
}

impl RunRequest {
    /// The simulation seeds in order; 1 where none are named.
    #[must_use]
    pub fn seeds(&self) -> &[u64] {
        self.seeds.as_ref().map_or(&[1], Seeds::list)
    }
}

/// Facts that win over what the text says.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Expect {
    /// Number of humans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub humans: Option<u32>,
    /// Place class of the encounter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<PlaceClass>,
    /// Groups as lists of human numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<Vec<u32>>,
    /// Pattern (card id) to use.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
}

impl Expect {
    /// How many humans the request expects at least: so many as it says, or as its groups name.
    #[must_use]
    pub fn headcount(&self) -> Option<u32> {
        self.humans.or_else(|| self.groups.iter().flatten().copied().max())
    }
}

/// How many members a group has.
const GROUP_SIZES: std::ops::RangeInclusive<usize> = 2..=8;
/// Largest number of humans a request may ask for.
pub const MAX_HUMANS: u32 = 40;
/// Longest text of one field, characters.
pub const MAX_TEXT_CHARS: usize = 8_000;

/// Largest number of scenarios made of one request.
pub const MAX_VARIANTS: u32 = 100_000;

/// One thing wrong with a request: which key, what was found, where, and a hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct BadRequest {
    /// `J-REQUEST`, or `J-PLANNER` for a planner that does not exist.
    pub code: FaultCode,
    /// The key, dotted; empty where the text is no table at all.
    pub key: String,
    /// What is wrong, with the value.
    pub found: String,
    /// What would be taken.
    pub hint: String,
    /// Where the value stands, if the request came as a text.
    pub at: Option<TextPlace>,
}

impl fmt::Display for BadRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.key.is_empty() { f.write_str(&self.found) } else { write!(f, "`{}`: {}", self.key, self.found) }
    }
}

impl BadRequest {
    /// One line with everything: `J-REQUEST my.toml:12:9 ‘run.seeds’: … (hint)`.
    #[must_use]
    pub fn told(&self, file: &str) -> String {
        let at = self.at.map_or_else(|| file.to_owned(), |at| format!("{file}:{at}"));
        format!("{} {at} {self} ({})", self.code, self.hint)
    }
}

impl<'de> Deserialize<'de> for Request {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(from)?;
        Self::of_json(&value, None).map_err(|problems| {
            let told: Vec<String> = problems.iter().map(|bad| format!("{bad} ({})", bad.hint)).collect();
            serde::de::Error::custom(told.join("; "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: &str = "location = \"office\"\nsocial_context = \"An office\"\ntask = \"Deliver mail\"\n";

    /// What is told of a request with these lines.
    fn told(more: &str) -> Vec<String> {
        let problems =
            Request::of_toml(&format!("{PLAIN}{more}"), Some(&["reference", "none"])).err().unwrap_or_default();
        problems.iter().map(|bad| bad.told("my.toml")).collect()
    }

    #[test]
    fn the_word_none_is_an_error_with_a_hint() {
        let told = told("rough_scenario = \"None\"\n");
        assert_eq!(
            told,
            [
                "J-REQUEST my.toml:4:18 `rough_scenario`: is the word `None` (leave the key out for an unguided scenario)"
            ]
        );
    }

    #[test]
    fn groups_of_people_who_are_not_expected_are_refused() {
        let found = |more: &str| {
            let read = Request::of_toml(&format!("{PLAIN}[expect]\n{more}\n"), None);
            read.err().unwrap_or_default().into_iter().map(|bad| bad.found).collect::<Vec<_>>()
        };
        assert_eq!(found("humans = 3\ngroups = [[1, 2]]"), Vec::<String>::new());
        assert_eq!(found("humans = 3\ngroups = [[1, 2], [2, 3]]"), ["[2, 3] names human_2 again"]);
        let twice = ["[0, 4] names human_0", "[0, 4] names human_4", "[1] has 1 members"];
        assert_eq!(found("humans = 3\ngroups = [[0, 4], [1]]"), twice);
        let request = Request::of_toml(&format!("{PLAIN}[expect]\ngroups = [[1, 5]]\n"), None).unwrap();
        assert_eq!(request.expect.headcount(), Some(5));
    }

    #[test]
    fn everything_that_is_wrong_is_told_at_once_with_line_and_column() {
        let text = "color = 1\n[robot]\nmodel = \"hal\"\nplanners = [\"none\", \"telepathy\", \"a/b\"]\n\
                    gestures = [{ when = \"whenever\", say = \"WAIT\" }, { say = \"SING\" }]\n\
                    [run]\nseeds = \"9..1\"\nduration = \"long\"\nauthor = \"nobody\"\nvariants = 0\n\
                    [expect]\nplace = \"moon\"\nhumans = 99\n";
        let told = told(text);
        let at = |place: &str, words: &str| {
            let line = told
                .iter()
                .find(|line| line.contains(&format!("my.toml:{place} ")))
                .unwrap_or_else(|| panic!("{place}: {told:#?}"));
            assert!(line.contains(words), "{place} `{words}`: {line}");
        };
        at("4:1", "`color`: is not a key of a request (keys: location, social_context, task");
        at("6:9", "`robot.model`: `hal` is not a robot model; allowed: linorobot2");
        at(
            "7:21",
            "J-PLANNER my.toml:7:21 `robot.planners`: there is no planner `telepathy` (planners: reference, none)",
        );
        at("7:34", "`a/b` is not a planner name");
        at("8:22", "`robot.gestures.when`: `whenever` is not a moment");
        at("8:50", "`robot.gestures.when`: is missing");
        at("8:58", "`robot.gestures.say`");
        at("10:9", "`run.seeds`: `9..1` is not a list or range of seeds");
        at("11:12", "`run.duration`: `long` is not a duration");
        at("12:10", "`run.author`: `nobody` is not a name of an author");
        at("13:12", "`run.variants`: 0 is out of range (1 to 100000)");
        at("15:9", "`expect.place`: `moon` is not a place class");
        at("16:10", "`expect.humans`: 99 humans");
        assert_eq!(told.len(), 13, "{told:#?}");
    }

    #[test]
    fn a_text_that_is_no_toml_and_a_request_without_its_keys_are_told_with_their_places() {
        let broken = Request::of_toml("location = \"office\"\ntask = = 3\n", None).unwrap_err();
        assert!(broken.iter().any(|bad| bad.told("my.toml").starts_with("J-REQUEST my.toml:2:")), "{broken:?}");
        let empty: Vec<String> = Request::of_toml("", None).unwrap_err().into_iter().map(|bad| bad.key).collect();
        assert_eq!(empty, ["location", "social_context", "task"]);
        let seeds = told("[run]\nseeds = [1, 2, 3]\n");
        assert!(seeds[0].contains("a text in quotation marks: \"1\", \"1..20\" or \"1,4,9\""), "{seeds:?}");
    }

    #[test]
    fn json_goes_through_the_same_door() {
        let json =
            serde_json::json!({ "location": "office", "social_context": "", "task": " ", "run": { "seeds": "x" } });
        let why = serde_json::from_value::<Request>(json).unwrap_err().to_string();
        assert!(why.contains("`task`: is empty") && why.contains("`run.seeds`: `x` is not"), "{why}");
    }

    #[test]
    fn a_request_is_written_as_it_is_read_and_requests_of_before_stay_readable() {
        // As bundles of before hold it, with every key.
        let old = format!(
            "{PLAIN}[robot]\nmodel = \"jackal\"\nplanners = [\"reference\"]\nwaypoints = \"via\"\n\
             [[robot.gestures]]\nwhen = \"blocked 3 s\"\nsay = \"EXCUSE_ME\"\n\
             [run]\nseeds = \"1..3\"\nduration = \"60s\"\nauthor = \"auto\"\nvariants = 1\n\
             [expect]\nplace = \"corridor\"\n"
        );
        let request = Request::of_toml(&old, None).unwrap();
        assert_eq!(request.robot.model.name, "jackal");
        assert_eq!(request.robot.gestures[0].when, Moment::Blocked(3.0));
        assert_eq!((request.run.seeds(), request.run.duration.fixed_s()), (&[1, 2, 3][..], Some(60.0)));
        assert_eq!(request.expect.place, Some(PlaceClass::Corridor));
        assert_eq!(Request::of_toml(&toml::to_string(&request).unwrap(), None).unwrap(), request);
        let json = serde_json::to_value(&request).unwrap();
        assert_eq!(json["run"]["seeds"], "1..3");
        assert_eq!(json["run"].get("breadth"), None, "what is usual is not written");
        let wide = Request::of_toml(&old.replace("variants = 1", "variants = 1\nbreadth = \"wide\""), None).unwrap();
        assert_eq!(wide.run.breadth, Breadth::Wide);
        assert_eq!(Request::of_toml(&toml::to_string(&wide).unwrap(), None).unwrap(), wide);
        assert_eq!(serde_json::from_value::<Request>(json).unwrap(), request);
    }

    #[test]
    fn seeds_that_are_written_are_told_apart_from_those_that_are_not() {
        let read = |more: &str| Request::of_toml(&format!("{PLAIN}{more}"), None).unwrap().run;
        assert_eq!((read("").seeds, read("").seeds().to_vec()), (None, vec![1]));
        assert_eq!(read("[run]\nseeds = \"1\"\n").seeds, Some(Seeds::one(1)));
    }
}
