//! Names of planners, among them those that drive from outside.
//!
//! ```text
//! mppi             a planner of the catalog
//! external:mine    the driver that calls itself `mine`       requests, command line, reports
//! external.mine    the same where a colon cannot be          names of runs, of files, of the bus
//! ```

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{BadId, text_traits};

/// A planner under test, as requests and reports name it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub struct PlannerName(String);

/// What stands before the name of a driver, and its spelling in names of runs and files.
const EXTERNAL: &str = "external:";
const EXTERNAL_IN_RUNS: &str = "external.";
/// Longest name, characters.
const CHARS: usize = 40;

impl PlannerName {
    /// Name of the planner that plays the robot script; it always runs.
    pub const REFERENCE: &'static str = "reference";
    /// Name of the planner that is no robot: the twin run.
    pub const NO_ROBOT: &'static str = "none";

    /// Reads a name.
    ///
    /// # Errors
    /// [`BadId`] when the text is empty, too long or holds a character that is not allowed.
    pub fn new(text: impl Into<String>) -> Result<Self, BadId> {
        let text: String = text.into();
        let driver = text.strip_prefix(EXTERNAL).or_else(|| text.strip_prefix(EXTERNAL_IN_RUNS));
        let name = driver.unwrap_or(&text);
        let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
        if !name.is_empty() && text.chars().count() <= CHARS && name.chars().all(fits) {
            Ok(Self(driver.map_or_else(|| text.clone(), |driver| format!("{EXTERNAL}{driver}"))))
        } else {
            let allowed = "1 to 40 of a-z A-Z 0-9 . _ -, or `external:` and the name of a driver";
            Err(BadId { what: "planner name", found: text.chars().take(80).collect(), allowed })
        }
    }

    /// The name of the driver, if it drives from outside.
    #[must_use]
    pub fn external(&self) -> Option<&str> {
        self.0.strip_prefix(EXTERNAL)
    }

    /// The name as it stands in names of runs and files.
    #[must_use]
    pub fn in_runs(&self) -> String {
        self.external().map_or_else(|| self.0.clone(), |driver| format!("{EXTERNAL_IN_RUNS}{driver}"))
    }

    /// The planner that plays the robot script.
    #[must_use]
    pub fn reference() -> Self {
        Self(Self::REFERENCE.to_owned())
    }

    /// The planner that is no robot.
    #[must_use]
    pub fn no_robot() -> Self {
        Self(Self::NO_ROBOT.to_owned())
    }

    /// The robot of a `HuNavSim` agents file, which goes from way point to way point.
    #[must_use]
    pub fn waypoints() -> Self {
        Self("waypoints".to_owned())
    }

    /// The robot of somebody's tracks: nobody knows what drove it.
    #[must_use]
    pub fn tracks() -> Self {
        Self("tracks".to_owned())
    }

    /// Whether it plays the robot script.
    #[must_use]
    pub fn is_reference(&self) -> bool {
        self.0 == Self::REFERENCE
    }

    /// Whether it is no robot.
    #[must_use]
    pub fn is_no_robot(&self) -> bool {
        self.0 == Self::NO_ROBOT
    }
}

text_traits!(PlannerName);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_has_one_name_in_two_spellings() {
        for text in ["external:mine", "external.mine"] {
            let name: PlannerName = text.parse().unwrap();
            assert_eq!(name.as_str(), "external:mine");
            assert_eq!(name.external(), Some("mine"));
            assert_eq!(name.in_runs(), "external.mine");
        }
        let own: PlannerName = "mppi".parse().unwrap();
        assert_eq!((own.external(), own.in_runs().as_str()), (None, "mppi"));
    }

    #[test]
    fn a_name_that_no_file_could_have_is_refused() {
        for text in ["", "external:", "external.", "a:b", "external:a/b", "external:a:b", "a b", "external:a b"] {
            let bad = text.parse::<PlannerName>().unwrap_err().to_string();
            assert!(bad.contains(&format!("`{text}` is not a planner name")), "{bad}");
        }
    }
}
