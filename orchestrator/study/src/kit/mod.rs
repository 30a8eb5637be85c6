//! A study on its way to participants: orders of films, questions, the survey page, and the book of what was answered.
//!
//! ```text
//! Design ─┬─► orders ─┬─► survey page, files for other survey programs
//!         └─► asks ───┘
//! answers of people ─► journal ─► lines ─► read
//! ```
//!
//! *Never here:* a planner's or a scenario's name in anything that a participant can reach.

pub mod advanced;
pub mod asks;
pub mod journal;
pub mod jspsych;
pub mod legend;
pub mod limesurvey;
pub mod media;
pub mod orders;
pub mod page;
pub mod qsf;
pub mod setup;

#[cfg(test)]
pub(crate) mod tests {
    use crate::design::Design;

    /// Three planners in one scenario, a scale with words, two checks.
    pub(crate) fn design() -> Design {
        let film = |id: &str, planner: &str| {
            format!("[[film]]\nid = \"{id}\"\nscenario = \"elevator\"\nplanner = \"{planner}\"\nlength_s = 20\n")
        };
        let films = [film("k7f", "mppi"), film("q2b", "ha_mppi"), film("z9x", "nav2can")].concat();
        let text = format!(
            "title = \"Robots at doors\"\nplanners = [\"mppi\", \"ha_mppi\", \"nav2can\"]\nparticipants = 42\n\
             instruments = [\"psi\", \"godspeed\", \"slider\"]\nchecks = {{ check1 = 4, check2 = \"somewhat disagree\" }}\n{films}\
             [[scenario]]\nname = \"elevator\"\nbundles = [\"a\"]\ncontext = \"A hospital. The robot takes the elevator.\"\n\
             [survey]\ncompletion_code = \"CSECRET1\"\n"
        );
        Design::parse(&text, "study.toml").unwrap()
    }
}
