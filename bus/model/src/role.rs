//! Roles: what an artifact is to a job.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;
use crate::job::Stage;

macro_rules! roles {
    ($($name:ident $word:literal $about:literal;)*) => {
        /// What an artifact is to the job that takes or makes it. Sorted by name, as files list them.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum Role {
            $(#[doc = $about] $name,)*
        }

        impl Role {
            /// Every role, sorted by name.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// The name as in files, logs and messages.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $word,)* }
            }
        }
    };
}

roles! {
    Behaviors "behaviors" "One behavior tree for each human.";
    Commands "commands" "The commands that a driver outside gave in a run.";
    Exchange "exchange" "What passed between a stage and its author.";
    Location "location" "The location.";
    Metrics "metrics" "The metrics of a run as a table.";
    Paths "paths" "Paths and encounters.";
    Proposal "proposal" "The proposal.";
    Reading "reading" "What the request was read as.";
    Recording "recording" "The recording of a run.";
    Reference "reference" "The recording of the reference planner that another planner's run is compared with.";
    Refused "refused" "An answer that was refused, for the author to read.";
    Report "report" "The report of a run.";
    Request "request" "The request.";
    Said "said" "What a person typed who looked at a draft.";
    Simulation "simulation" "The summary of a run.";
    Twin "twin" "The recording of the same people without a robot.";
}

impl Role {
    /// What a person may pin in a request, which is what the authored stages make.
    pub const PINNED: [Self; 3] = [Self::Proposal, Self::Paths, Self::Behaviors];

    /// The output that a successful attempt of this stage must have.
    #[must_use]
    pub const fn made_by(stage: Stage) -> Option<Self> {
        match stage {
            Stage::Proposal => Some(Self::Proposal),
            Stage::Paths => Some(Self::Paths),
            Stage::Behaviors => Some(Self::Behaviors),
            Stage::Simulation => Some(Self::Recording),
            Stage::Scoring => Some(Self::Report),
            // A person who changes nothing hands nothing back.
            Stage::Review => None,
        }
    }

    /// Whether a scoring job waits for this input and does without it.
    #[must_use]
    pub const fn is_beside(self) -> bool {
        matches!(self, Self::Reference | Self::Twin)
    }

    /// The role under which the source of this input has it: a recording is beside another run as its reference.
    #[must_use]
    pub const fn made_as(self) -> Self {
        if self.is_beside() { Self::Recording } else { self }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Role {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        Self::ALL.iter().copied().find(|role| role.name() == text).ok_or_else(|| BadId {
            what: "role of an artifact",
            found: text.chars().take(40).collect(),
            allowed: "proposal, paths, behaviors, recording, report …",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_spelled_as_files_have_them_and_sort_by_name() {
        let names: Vec<&str> = Role::ALL.iter().map(|role| role.name()).collect();
        assert!(names.is_sorted(), "{names:?}");
        assert!(Role::ALL.is_sorted());
        for role in Role::ALL {
            assert_eq!(role.name().parse::<Role>().unwrap(), *role);
            assert_eq!(serde_json::to_value(role).unwrap(), serde_json::json!(role.name()));
        }
        assert!("picture".parse::<Role>().unwrap_err().to_string().contains("`picture` is not a role"));
    }
}
