//! `explain` and `config`: the manual.

use clap::Args;
use socrates_app::output::Printer;
use socrates_app::{config, explain};

use super::{Outcome, done};

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// Fault code, metric such as `ttc_min`, or word such as `encounter gap`; `metrics` and `words` list all of them.
    code: Vec<String>,
}

impl Explain {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        done(explain::explain(talk, &self.code))
    }
}

/// Arguments of `config`.
#[derive(Debug, Args)]
pub(crate) struct Config {
    /// Only this part, such as `author`.
    part: Option<String>,
}

impl Config {
    pub(super) fn act(&self, talk: &Printer, config: &config::Config) -> Outcome {
        done(explain::config(talk, config, self.part.as_deref()))
    }
}
