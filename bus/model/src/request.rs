//! The request: what the user gives.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::gesture::Gesture;

/// A request as written in its TOML file. Unknown keys are refused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// The robot.
    #[serde(default)]
    pub robot: RobotRequest,
    /// How to run.
    #[serde(default)]
    pub run: RunRequest,
    /// Facts that win over the text.
    #[serde(default)]
    pub expect: Expect,
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

/// A gesture of the robot: `{ when = "blocked 3 s", say = "EXCUSE_ME" }`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotGesture {
    /// `start`, `blocked N s`, `human within N m`, `after N s`.
    pub when: String,
    /// The gesture.
    pub say: Gesture,
}

/// The robot of a request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RobotRequest {
    /// Robot model; default `linorobot2`.
    pub model: String,
    /// Planners under test; `reference` is always run, first. Default `["reference"]`.
    pub planners: Vec<String>,
    /// Which nodes of its path the planner is given. Default `via`.
    pub waypoints: Waypoints,
    /// Gestures the robot makes by itself.
    pub gestures: Vec<RobotGesture>,
}

impl Default for RobotRequest {
    fn default() -> Self {
        Self {
            model: "linorobot2".to_owned(),
            planners: vec!["reference".to_owned()],
            waypoints: Waypoints::Via,
            gestures: Vec::new(),
        }
    }
}

/// How a request is run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RunRequest {
    /// Simulation seeds: `"1"`, `"1..20"`, `"1,4,9"`. Default `"1"`.
    #[serde(deserialize_with = "seeds_text")]
    pub seeds: String,
    /// `"auto"` (until done, at most 120 s) or seconds such as `"60s"`. Default `auto`.
    pub duration: String,
    /// `auto`, `offline`, or `provider:model`. Default `auto`.
    pub author: String,
    /// Number of scenarios to make from this request, 1 to 100 000. Default 1.
    pub variants: u32,
}

impl Default for RunRequest {
    fn default() -> Self {
        Self { seeds: "1".to_owned(), duration: "auto".to_owned(), author: "auto".to_owned(), variants: 1 }
    }
}

/// Reads the seeds, and says how to write them where they are no text.
fn seeds_text<'de, D: serde::Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    struct Text;
    impl serde::de::Visitor<'_> for Text {
        type Value = String;
        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("seeds as a text in quotation marks: \"1..3\" or \"1,2,3\"")
        }
        fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<String, E> {
            Ok(text.to_owned())
        }
    }
    from.deserialize_str(Text)
}

/// Facts that win over what the text says.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Expect {
    /// Number of humans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub humans: Option<u32>,
    /// Place class of the encounter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
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

    /// What is wrong with the groups: members that are nobody, or somebody twice.
    fn group_problems(&self) -> Vec<BadRequest> {
        let most = self.humans.unwrap_or(MAX_HUMANS).min(MAX_HUMANS);
        let mut problems = Vec::new();
        let mut bad = |found: String, hint: String| problems.push(BadRequest { key: "expect.groups", found, hint });
        let mut seen: Vec<u32> = Vec::new();
        for group in &self.groups {
            if !GROUP_SIZES.contains(&group.len()) {
                let hint = format!("{} to {} members", GROUP_SIZES.start(), GROUP_SIZES.end());
                bad(format!("{group:?} has {} members", group.len()), hint);
            }
            for member in group {
                if *member == 0 || *member > most {
                    bad(format!("{group:?} names human_{member}"), format!("numbers of humans, 1 to {most}"));
                }
                if seen.contains(member) {
                    bad(
                        format!("{group:?} names human_{member} again"),
                        "each human is in one group at most".to_owned(),
                    );
                }
                seen.push(*member);
            }
        }
        problems
    }
}

/// How many members a group has.
const GROUP_SIZES: std::ops::RangeInclusive<usize> = 2..=8;
/// Largest number of humans a request may ask for.
pub const MAX_HUMANS: u32 = 40;
/// Longest text of one field, characters.
pub const MAX_TEXT_CHARS: usize = 8_000;

/// One thing wrong with a request: which key, what was found, and a hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}`: {found}")]
pub struct BadRequest {
    /// The key, dotted.
    pub key: &'static str,
    /// What is wrong, with the value.
    pub found: String,
    /// What would be taken.
    pub hint: String,
}

impl Request {
    /// Every problem of the request's own texts and numbers; empty when it is good.
    #[must_use]
    pub fn problems(&self) -> Vec<BadRequest> {
        let mut problems = Vec::new();
        let texts: BTreeMap<&'static str, Option<&String>> = BTreeMap::from([
            ("social_context", Some(&self.social_context)),
            ("task", Some(&self.task)),
            ("rough_scenario", self.rough_scenario.as_ref()),
            ("location_description", self.location_description.as_ref()),
            ("location", Some(&self.location)),
        ]);
        for (key, text) in texts {
            let Some(text) = text else { continue };
            problems.extend(text_problems(key, text));
        }
        if self.task.trim().is_empty() {
            problems.push(BadRequest {
                key: "task",
                found: "is empty".to_owned(),
                hint: "say what the robot has to do, for example \"Deliver coffee to the meeting room\"".to_owned(),
            });
        }
        if let Err(why) = self.seeds() {
            problems.push(BadRequest {
                key: "run.seeds",
                found: why,
                hint: "\"1\", \"1..20\" or \"1,4,9\"".to_owned(),
            });
        }
        if let Err(why) = self.duration_s() {
            problems.push(BadRequest {
                key: "run.duration",
                found: why,
                hint: "\"auto\" or \"60s\" (1 to 600 s)".to_owned(),
            });
        }
        if self.run.variants == 0 || self.run.variants > 100_000 {
            problems.push(BadRequest {
                key: "run.variants",
                found: format!("{} is out of range", self.run.variants),
                hint: "1 to 100000".to_owned(),
            });
        }
        if let Some(humans) = self.expect.humans.filter(|n| *n == 0 || *n > MAX_HUMANS) {
            problems.push(BadRequest {
                key: "expect.humans",
                found: format!("{humans} humans"),
                hint: format!("1 to {MAX_HUMANS}; a social scenario needs somebody to meet"),
            });
        }
        if let Some(Err(bad)) = self.expect.place.as_ref().map(|place| place.parse::<crate::PlaceClass>()) {
            problems.push(BadRequest { key: "expect.place", found: bad.to_string(), hint: bad.allowed.to_owned() });
        }
        problems.extend(self.expect.group_problems());
        problems
    }

    /// The simulation seeds in order.
    ///
    /// # Errors
    /// A sentence that names the value when it is not of the form `1`, `1..20` or `1,4,9`.
    pub fn seeds(&self) -> Result<Vec<u64>, String> {
        let text = self.run.seeds.trim();
        let number = |part: &str| {
            part.trim().parse::<u64>().map_err(|_digits| format!("`{}` is not a whole number", part.trim()))
        };
        if let Some((from, to)) = text.split_once("..") {
            let (from, to) = (number(from)?, number(to.trim_start_matches('='))?);
            if from > to || to - from >= 10_000 {
                return Err(format!("`{text}` is no range of 1 to 10000 seeds"));
            }
            return Ok((from..=to).collect());
        }
        text.split(',').map(number).collect()
    }

    /// The fixed duration in seconds; `None` for `auto`.
    ///
    /// # Errors
    /// A sentence that names the value when it is neither `auto` nor 1 to 600 seconds.
    pub fn duration_s(&self) -> Result<Option<f64>, String> {
        let text = self.run.duration.trim();
        if text == "auto" {
            return Ok(None);
        }
        let digits = text.trim_end_matches('s').trim();
        match digits.parse::<f64>() {
            Ok(secs) if (1.0..=600.0).contains(&secs) => Ok(Some(secs)),
            Ok(_) | Err(_) => Err(format!("`{text}` is not a duration")),
        }
    }
}

fn text_problems(key: &'static str, text: &str) -> Vec<BadRequest> {
    let mut problems = Vec::new();
    let mut bad = |found: String, hint: &str| problems.push(BadRequest { key, found, hint: hint.to_owned() });
    let length = text.chars().count();
    if length > MAX_TEXT_CHARS {
        bad(format!("has {length} characters"), "at most 8000; a few sentences are enough");
    }
    if let Some(control) = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t')) {
        bad(
            format!("holds the control character U+{:04X}", u32::from(control)),
            "remove it; only text, line breaks and tabs are taken",
        );
    }
    if matches!(text.trim(), "None" | "none" | "NONE" | "null" | "nil") {
        bad(format!("is the word `{}`", text.trim()), "leave the key out for an unguided scenario");
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(rough: &str) -> Request {
        Request {
            location: "office".into(),
            social_context: "An office".into(),
            task: "Deliver mail".into(),
            rough_scenario: Some(rough.into()),
            location_description: None,
            robot: RobotRequest::default(),
            run: RunRequest::default(),
            expect: Expect::default(),
            proposal: None,
            paths: None,
            behaviors: None,
        }
    }

    #[test]
    fn the_word_none_is_an_error_with_a_hint() {
        let problems = request("None").problems();
        assert_eq!(problems[0].key, "rough_scenario");
        assert!(problems[0].hint.contains("leave the key out"));
    }

    #[test]
    fn groups_of_people_who_are_not_expected_are_refused() {
        let mut request = request("two people");
        let keys = |request: &Request| request.problems().iter().map(|bad| bad.found.clone()).collect::<Vec<_>>();
        (request.expect.humans, request.expect.groups) = (Some(3), vec![vec![1, 2]]);
        assert_eq!(keys(&request), Vec::<String>::new());
        request.expect.groups = vec![vec![1, 2], vec![2, 3]];
        assert_eq!(keys(&request), ["[2, 3] names human_2 again"]);
        request.expect.groups = vec![vec![0, 4], vec![1]];
        assert_eq!(keys(&request), ["[0, 4] names human_0", "[0, 4] names human_4", "[1] has 1 members"]);
        (request.expect.humans, request.expect.groups) = (None, vec![vec![1, 5]]);
        assert_eq!(request.expect.headcount(), Some(5));
    }

    #[test]
    fn seeds_are_read_as_one_range_or_list() {
        let mut request = request("two people");
        for (text, count) in [("3", 1), ("1..20", 20), ("1,4,9", 3)] {
            request.run.seeds = text.into();
            assert_eq!(request.seeds().unwrap().len(), count);
        }
        let list = serde_json::from_str::<RunRequest>(r#"{"seeds": [1, 2, 3]}"#).unwrap_err().to_string();
        assert!(list.contains(r#"expected seeds as a text in quotation marks: "1..3" or "1,2,3""#), "{list}");
        assert_eq!(serde_json::from_str::<RunRequest>(r#"{"seeds": "1,2"}"#).unwrap().seeds, "1,2");
        request.run.seeds = "9..1".into();
        assert!(request.seeds().is_err());
    }
}
