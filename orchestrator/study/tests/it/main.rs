//! Simulated studies through every format, and what is refused.
#![cfg(test)]

mod formats;
mod kits;
mod origins;
mod planted;
mod reports;

use socrates_study::design::Design;

/// A study of three planners in one scenario, with reversed items and checks.
pub(crate) const STUDY: &str = r#"
title = "Elevator"
planners = ["mppi", "ha", "can"]
participants = 60
instruments = ["psi", "vega2020"]
checks = { check1 = 4, check2 = 5 }
resamples = 400
[[film]]
id = "k7f"
scenario = "elevator"
planner = "mppi"
length_s = 20
[[film]]
id = "q2b"
scenario = "elevator"
planner = "ha"
length_s = 20
[[film]]
id = "z9x"
scenario = "elevator"
planner = "can"
length_s = 20
[[hypothesis]]
text = "People rate robots that keep clear of groups as better adapted."
dimension = "psi.AB"
"#;

pub(crate) fn design() -> Design {
    Design::parse(STUDY, "study.toml").unwrap()
}
