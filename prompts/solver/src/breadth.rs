//! How much is tried, and what is as good as the best: little where one good answer is wanted, much where many different ones are.

use socrates_model::Breadth;

/// The limits of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// Solutions within so many points of the best are as good: a draw may take any of them.
    pub(crate) alike: f64,
    /// Of those, people's ways may cost so much more than in the best: what was asked of them is not given up for variety.
    pub(crate) strained: f64,
    /// The robot's way may lack so much more room before and after the meeting than in the best, m.
    pub(crate) short_m: f64,
    /// Solutions among which different ones are looked for, at most.
    pub(crate) pool: usize,
    /// Meeting nodes that are tried, ways of the robot over each, and ends of each branch of them.
    pub(crate) nodes: usize,
    pub(crate) routes: usize,
    pub(crate) ends: usize,
    /// Ways of the robot that all meeting nodes share, where that is more for each.
    pub(crate) shared: usize,
    /// Whether people who cross are led from every side, and every different solution is as likely. Else they come from the best
    /// one, and what plays in the same place is one solution.
    pub(crate) wide: bool,
}

/// One good answer: its alternatives are as good for any eye.
const USUAL: Limits = Limits {
    alike: 2.5,
    strained: 0.75,
    short_m: 0.0,
    pool: 400,
    nodes: 14,
    routes: 10,
    ends: 9,
    shared: 0,
    wide: false,
};

/// Many different answers: 11.5 points are 38 m more of the robot's way than is wished, or a turn at the meeting and 18 m, and less
/// than an end in a doorway; 3 points are somebody who crosses and goes on along the robot's way.
const WIDE: Limits = Limits {
    alike: 11.5,
    strained: 3.0,
    short_m: 0.5,
    pool: 4000,
    nodes: 20,
    routes: 30,
    ends: 20,
    shared: 240,
    wide: true,
};

impl Limits {
    /// The limits of a breadth.
    pub(crate) const fn of(breadth: Breadth) -> Self {
        match breadth {
            Breadth::Usual => USUAL,
            Breadth::Wide => WIDE,
        }
    }
}
