//! The scenario that an author states: people, groups, orders and the robot's part, in the words of the form of a request.
//!
//! It goes through the door of requests ([`Request::of_json`]), so that every name in it exists and every number is in its range.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};

use crate::form::{Form, PlaceWord, RobotStep};
use crate::request::{BadRequest, Expect, Request, RobotRequest};

/// Keys of a scenario.
const KEYS: [&str; 4] = ["robot", "human", "group", "order"];

/// The people, what each of them does, and the robot's part.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// The robot's way, and what it does on it.
    pub robot: RobotPart,
    /// People, groups and orders.
    #[serde(flatten)]
    pub form: Form,
}

/// The robot of a scenario. The program chooses what is absent.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotPart {
    /// Where its way begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<PlaceWord>,
    /// Where its way ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlaceWord>,
    /// A place that its way leads past.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub via: Option<PlaceWord>,
    /// Places that its way keeps out of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<PlaceWord>,
    /// Whether it comes back from its goal to where it began.
    #[serde(rename = "return", skip_serializing_if = "std::ops::Not::not")]
    pub returns: bool,
    /// Its steps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub does: Vec<RobotStep>,
}

impl Scenario {
    /// Reads a scenario. Keys that are absent may be written as null.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with its key, the value and what is allowed.
    pub fn of_json(value: &Value) -> Result<Self, Vec<BadRequest>> {
        let mut request = Map::new();
        for (key, text) in [("location", "here"), ("social_context", "any"), ("task", "any")] {
            request.insert(key.to_owned(), json!(text));
        }
        let Value::Object(members) = value else {
            return Err(vec![wrong(format!("is {value}"), "an object with robot, human, group and order")]);
        };
        for (key, value) in members {
            if !KEYS.contains(&key.as_str()) {
                return Err(vec![wrong(format!("has `{key}`"), "keys: robot, human, group, order")]);
            }
            request.insert(key.clone(), value.clone());
        }
        let mut request = Value::Object(request);
        without_nulls(&mut request);
        Request::of_json(&request, None).map(|request| Self::of(&request))
    }

    /// The scenario that a request states.
    #[must_use]
    pub fn of(request: &Request) -> Self {
        let robot = request.robot.clone();
        let robot = RobotPart {
            start: robot.start,
            goal: robot.goal,
            via: robot.via,
            avoid: robot.avoid,
            returns: robot.returns,
            does: robot.does,
        };
        Self { robot, form: request.form.clone() }
    }

    /// The request that states this scenario, and has no text that could be read beside it. Statements of the request win.
    #[must_use]
    pub fn stated_in(&self, request: &Request) -> Request {
        let (own, stated) = (self.robot.clone(), request.robot.clone());
        let robot = RobotRequest {
            start: stated.start.or(own.start),
            goal: stated.goal.or(own.goal),
            via: stated.via.or(own.via),
            avoid: if stated.avoid.is_empty() { own.avoid } else { stated.avoid },
            returns: stated.returns || own.returns,
            does: if stated.does.is_empty() { own.does } else { stated.does },
            ..stated
        };
        let form = if request.form.is_empty() { &self.form } else { &request.form };
        Request {
            form: form.clone(),
            robot,
            rough_scenario: None,
            task: String::new(),
            social_context: String::new(),
            waive: Vec::new(),
            expect: Expect::default(),
            ..request.clone()
        }
    }
}

impl<'de> Deserialize<'de> for Scenario {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(from)?;
        Self::of_json(&value).map_err(|problems| {
            let all: Vec<String> = problems.iter().map(|bad| format!("{bad} ({})", bad.hint)).collect();
            serde::de::Error::custom(all.join("; "))
        })
    }
}

fn wrong(found: String, hint: &str) -> BadRequest {
    let code = crate::fault::FaultCode::JRequest;
    BadRequest { code, key: String::new(), found, hint: hint.to_owned(), at: None }
}

/// Removes members that are null: strict schemas say nothing with `null`, and the types by leaving the member out.
pub fn without_nulls(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|_, member| !member.is_null());
            members.values_mut().for_each(without_nulls);
        }
        Value::Array(items) => items.iter_mut().for_each(without_nulls),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario() -> Value {
        json!({
            "robot": {"goal": "elevator", "via": null, "does": [{"when": {"at_encounter": "human_2"}, "say": "EXCUSE_ME"}]},
            "human": [
                {"relation": "leaving", "place": "elevator", "side": null},
                {"role": "guard", "relation": "static", "does": [{"when": [{"robot_near": 4.0}], "say": "WAIT", "act": null}]},
            ],
            "order": [{"first": "human_1", "then": "robot", "at": "elevator"}],
        })
    }

    #[test]
    fn a_scenario_is_written_as_it_is_read() {
        let read = Scenario::of_json(&scenario()).unwrap();
        assert_eq!((read.form.headcount(), read.form.orders.len(), read.robot.does.len()), (2, 1, 1));
        let written = serde_json::to_value(&read).unwrap();
        assert_eq!(serde_json::from_value::<Scenario>(written).unwrap(), read);
        let request = Request::of_toml("location = \"a\"\nsocial_context = \"b\"\ntask = \"c\"\n", None).unwrap();
        let stated = read.stated_in(&request);
        assert_eq!((Scenario::of(&stated), stated.task.as_str()), (read, ""));
    }

    #[test]
    fn everything_that_is_wrong_is_named_at_once() {
        let mut bad = scenario();
        bad["human"][0]["relation"] = json!("sideways");
        bad["robot"]["does"][0]["when"] = json!({"at_encounter": "human_9"});
        bad["order"][0]["then"] = json!("ghost");
        let keys: Vec<String> = Scenario::of_json(&bad).unwrap_err().into_iter().map(|bad| bad.key).collect();
        assert!(keys.contains(&"human.relation".to_owned()), "{keys:?}");
        let found = Scenario::of_json(&json!({"humans": []})).unwrap_err();
        assert!(found[0].found.contains("`humans`") && found[0].hint.contains("human"), "{found:?}");
        assert!(Scenario::of_json(&json!([])).is_err());
    }
}
