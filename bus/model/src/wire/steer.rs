//! What a client has done about jobs, and what came of it.

use serde::{Deserialize, Serialize};

use crate::ids::ScenarioId;
use crate::job::Stage;

/// What is paused or goes on again.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Everything.
    All,
    /// One batch.
    Batch(String),
    /// One stage of all batches.
    Stage(Stage),
}

/// Scenarios that are given up or tried once more.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Chosen {
    /// All that there are.
    All,
    /// Those of one batch.
    Batch(String),
    /// These, at most as many as fit a message.
    Scenarios(Vec<ScenarioId>),
}

/// What is done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Steer {
    /// No more jobs of this are handed out; what workers hold is finished.
    Pause(Part),
    /// They are handed out again.
    Resume(Part),
    /// What is not done is given up.
    Cancel(Chosen),
    /// Dead and failed jobs once more, with new budgets.
    Requeue(Chosen),
}

/// What came of a [`Steer`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Steered {
    /// Scenarios that it touched.
    pub scenarios: u32,
    /// Jobs that it touched and that no worker held.
    pub jobs: u32,
    /// Jobs that it touched while a worker held them: finished where something was paused, told to stop where it was canceled.
    #[serde(default)]
    pub held: u32,
    /// What it did not touch, by reason.
    #[serde(default)]
    pub left: Vec<Left>,
}

/// What was left as it was, for one reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Left {
    /// Why, in a few words.
    pub why: String,
    /// How many.
    pub count: u32,
    /// Some of them by name.
    #[serde(default)]
    pub some: Vec<String>,
    /// Whether nothing of these names is there.
    #[serde(default)]
    pub unknown: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_steered_is_written_as_it_was_released() {
        let kept = [
            (Steer::Pause(Part::All), r#"{"pause":"all"}"#),
            (Steer::Resume(Part::Stage(Stage::Paths)), r#"{"resume":{"stage":"paths"}}"#),
            (Steer::Cancel(Chosen::Batch("b".to_owned())), r#"{"cancel":{"batch":"b"}}"#),
            (Steer::Requeue(Chosen::Scenarios(vec!["a".parse().unwrap()])), r#"{"requeue":{"scenarios":["a"]}}"#),
        ];
        for (steer, text) in kept {
            assert_eq!(serde_json::to_string(&steer).unwrap(), text);
            assert_eq!(serde_json::from_str::<Steer>(text).unwrap(), steer);
        }
        let old: Steered = serde_json::from_str(r#"{"scenarios":1,"jobs":2}"#).unwrap();
        assert_eq!(old, Steered { scenarios: 1, jobs: 2, ..Steered::default() });
    }
}
