//! Kinds of injected faults.

use serde::{Deserialize, Serialize};
use socrates_model::job::Stage;

macro_rules! kinds {
    ($($name:ident $word:literal $authored:literal $about:literal;)*) => {
        /// What can go wrong with an attempt.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Kind {
            $(#[doc = $about] $name,)*
        }

        impl Kind {
            /// Every kind, in the order in which they are looked at.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Word in specifications and tables.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$name => $word,)* }
            }

            /// What happens, in a sentence.
            #[must_use]
            pub const fn about(self) -> &'static str {
                match self { $(Self::$name => $about,)* }
            }

            /// Whether only stages that ask an author have it.
            #[must_use]
            pub const fn is_of_author(self) -> bool {
                match self { $(Self::$name => $authored,)* }
            }
        }
    };
}

kinds! {
    WorkerKill "worker_kill" false "The worker dies in the middle of its work; another is started in its place.";
    Partition "partition" false "No message of the worker gets through for a while; it works on.";
    LlmTimeout "llm_timeout" true "The author's server does not answer in time.";
    Overload "overload" true "The author's server asks to slow down.";
    LlmError "llm_error" true "The author's server fails.";
    Malformed "malformed" true "The answer cannot be parsed.";
    SemanticViolation "semantic_violation" true "The answer breaks a rule of its stage.";
    WorkerFreeze "worker_freeze" false "The worker is stopped for a while, and then goes on with what it held.";
    OrchestratorKill "orchestrator_kill" false "The orchestrator dies while it records the report, before or after its commit, and is started again on what was saved.";
    SlowStore "slow_store" false "The commit of the report takes long; nothing else is answered meanwhile.";
}

impl Kind {
    /// Why it cannot be done to real processes, and what can be done instead; none where it can.
    #[must_use]
    pub const fn lacks_processes(self) -> Option<&'static str> {
        match self {
            Self::Partition => {
                Some("processes of one machine cannot be cut off; `worker_freeze` silences a worker for as long")
            }
            Self::SlowStore => {
                Some("the store of a process cannot be slowed down; leave it to `level = \"simulator\"`")
            }
            Self::WorkerKill
            | Self::LlmTimeout
            | Self::Overload
            | Self::LlmError
            | Self::Malformed
            | Self::SemanticViolation
            | Self::WorkerFreeze
            | Self::OrchestratorKill => None,
        }
    }

    /// Whether it can strike an attempt at this stage.
    #[must_use]
    pub const fn strikes(self, stage: Stage) -> bool {
        !self.is_of_author() || socrates_orchestrator::pipeline::is_authored(stage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_an_author_strike_only_stages_that_ask_one() {
        let at = |stage| Kind::ALL.iter().filter(|kind| kind.strikes(stage)).count();
        assert_eq!((at(Stage::Paths), at(Stage::Simulation), at(Stage::Scoring)), (10, 5, 5));
    }
}
