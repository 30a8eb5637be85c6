//! What moves somebody, where it is not the simulation: the model of a person as a request names it.
//!
//! ```text
//! external:mine    the driver that calls itself `mine`, which may drive the robot and other people as well
//! ```

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;
use crate::planner_name::PlannerName;

/// The model of a person: a driver outside. Whoever has none walks by the simulation's own.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct PersonModel(String);

impl PersonModel {
    /// What is allowed, for messages.
    pub const ALLOWED: &'static str = "`external:` and the name of a driver, 1 to 31 of a-z A-Z 0-9 . _ -";

    /// Reads a model.
    ///
    /// # Errors
    /// [`BadId`] for anything but `external:` and the name of a driver.
    pub fn new(text: impl Into<String>) -> Result<Self, BadId> {
        let text: String = text.into();
        let name = PlannerName::new(text.as_str()).ok();
        match name.as_ref().and_then(PlannerName::external) {
            Some(driver) => Ok(Self(driver.to_owned())),
            None => {
                let found = text.chars().take(80).collect();
                Err(BadId { what: "model of a person", found, allowed: Self::ALLOWED })
            }
        }
    }

    /// Name of the driver, without `external:`.
    #[must_use]
    pub fn driver(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for PersonModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "external:{}", self.0)
    }
}

impl FromStr for PersonModel {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::new(text)
    }
}

impl TryFrom<String> for PersonModel {
    type Error = BadId;
    fn try_from(text: String) -> Result<Self, BadId> {
        Self::new(text)
    }
}

impl From<PersonModel> for String {
    fn from(model: PersonModel) -> Self {
        model.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_of_a_person_is_the_name_of_a_driver_outside() {
        let model: PersonModel = "external:mine".parse().unwrap();
        assert_eq!((model.driver(), model.to_string().as_str()), ("mine", "external:mine"));
        for text in
            ["", "mine", "orca", "external:", "external:a b", "external:a/b", &format!("external:{}", "a".repeat(32))]
        {
            let bad = text.parse::<PersonModel>().unwrap_err().to_string();
            assert!(bad.contains(&format!("`{text}` is not a model of a person; allowed: `external:`")), "{bad}");
        }
    }
}
