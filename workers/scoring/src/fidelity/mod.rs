//! Fidelity: did the scenario that was asked for happen? Judged apart from how well the robot did.
//!
//! ```text
//! tracks + events ─► signals ─► monitors (one per predicate) ─► clauses ─► verdict, score F
//! ```

mod acts;
mod addressed;
mod aside;
mod clauses;
mod company;
mod coverage;
mod crowd;
pub(crate) mod doors;
mod doorway;
mod faces;
mod finding;
mod follow;
mod gaps;
mod going;
mod groups;
mod kept;
mod leaves;
mod meeting;
mod missed;
mod named_way;
mod openings;
mod plausible;
mod reactions;
mod ring;
mod robot;
mod robot_steps;
mod setting;
mod sides;
mod signals;
mod since;
mod steps;
mod times;
mod turns;
mod verdict;
mod windows;

pub use clauses::{Judged, clauses_of, judge, standing_of};
pub use finding::{Finding, Missed};
pub use plausible::Flaw;
pub use robot::{GOAL_M, goal as robot_goal};
pub use signals::{Moment, Signals};
pub use verdict::{Ruling, rule};

pub use gaps::Gaps;
pub(crate) use gaps::{by_name, encounter_gaps};
pub use since::{Since, since};
pub use steps::step_times;
pub(crate) use verdict::ruling_of_played;
