//! From the behavior section of an agent to the numbers it reacts with; drawn ones by seed.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use socrates_model::seeds::{self, derive_seed};

use crate::agents::{AgentEntry, Configuration, Dialect, Reaction};

/// To what the values of a file are cut, least and most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Speed of the reaction, m/s.
    pub vel_mps: (f64, f64),
    /// Factor of the force to the goal.
    pub goal: (f64, f64),
    /// Factor of the force from obstacles.
    pub obstacle: (f64, f64),
    /// Factor of the force from people.
    pub social: (f64, f64),
    /// Factor of the extra force on somebody scared. The original means at most 25 and compares another variable.
    pub other: (f64, f64),
}

/// The limits of a dialect.
#[must_use]
pub const fn limits(dialect: Dialect) -> Limits {
    match dialect {
        Dialect::V1_0 | Dialect::V1_1 => Limits {
            vel_mps: (0.0, 1.8),
            goal: (2.0, 8.0),
            obstacle: (2.0, 30.0),
            social: (2.1, 20.0),
            other: (0.0, f64::MAX),
        },
        Dialect::V2_0 => Limits {
            vel_mps: (0.0, 1.8),
            goal: (2.0, 5.0),
            obstacle: (2.0, 50.0),
            social: (5.0, 20.0),
            other: (0.0, f64::MAX),
        },
    }
}

/// The numbers an agent reacts with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Factor of the force to the goal.
    pub goal_force: f64,
    /// Factor of the force from obstacles.
    pub obstacle_force: f64,
    /// Factor of the force from people.
    pub social_force: f64,
    /// Factor of the extra force on somebody scared.
    pub other_force: f64,
    /// Length of the reaction, s.
    pub duration_s: f64,
    /// Whether it happens once only.
    pub once: bool,
    /// Speed of the reaction, m/s.
    pub vel_mps: f64,
    /// Curious: where it stops; surprised, scared: how far it sees the robot; threatening: how far before the robot it
    /// stands; m.
    pub dist_m: f64,
}

/// The largest extra force factor that the original means, see [`Limits::other`].
const OTHER_MEANT: f64 = 25.0;
/// The shortest reaction that can be meant, s.
const SHORTEST_S: f64 = 1.0;

/// The numbers of an agent: fixed, from its file, or drawn with `seed`. With `mend`, values that cannot be meant
/// (durations below 1 s, speeds that are not above 0, distances below 0.5 m) are brought into range.
#[must_use]
pub fn configure(agent: &AgentEntry, dialect: Dialect, seed: u64, mend: bool) -> Parameters {
    let behavior = &agent.behavior;
    let mut out = fixed(behavior.reaction, agent.max_vel_mps, behavior.once);
    let second = dialect == Dialect::V2_0;
    match behavior.configuration {
        Configuration::Default => {}
        Configuration::Custom => {
            let limits = limits(dialect);
            let cut = |value: f64, (least, most): (f64, f64)| value.clamp(least, most);
            out = Parameters {
                goal_force: cut(behavior.goal_force_factor, limits.goal),
                obstacle_force: cut(behavior.obstacle_force_factor, limits.obstacle),
                social_force: cut(behavior.social_force_factor, limits.social),
                other_force: cut(behavior.other_force_factor, limits.other),
                duration_s: behavior.duration_s,
                once: behavior.once,
                vel_mps: cut(behavior.vel_mps, limits.vel_mps),
                dist_m: behavior.dist_m,
            };
        }
        Configuration::RandomNormal => {
            let mut draw = Draw::of(seed, agent);
            out.goal_force = draw.normal(2.0, 1.5).max(0.5);
            out.obstacle_force = draw.normal(10.0, 4.0).max(0.5);
            out.social_force = draw.normal(4.0, 3.5).max(if second { 3.0 } else { 2.0 });
            out.duration_s = draw.normal(40.0, 15.0);
            let (vel, dist, other) = (draw.normal(0.8, 0.35), draw.standard(), draw.normal(20.0, 6.0));
            match behavior.reaction {
                Reaction::Curious => (out.vel_mps, out.dist_m) = (vel.max(0.4), 1.5 + 0.3 * dist),
                Reaction::Surprised => out.dist_m = (4.5 + 2.5 * dist).max(1.5),
                Reaction::Scared => {
                    (out.vel_mps, out.dist_m, out.other_force) = (vel, (4.5 + 2.5 * dist).max(1.5), other);
                }
                Reaction::Threatening => out.dist_m = 1.4 + 0.3 * dist,
                Reaction::Regular | Reaction::Impassive | Reaction::Custom(_) => {}
            }
        }
        Configuration::RandomUniform => {
            let mut draw = Draw::of(seed, agent);
            out.goal_force = draw.uniform(2.0, 5.0);
            out.obstacle_force = if second { draw.uniform(2.0, 50.0) } else { draw.uniform(8.0, 15.0) };
            out.social_force = if second { draw.uniform(4.0, 20.0) } else { draw.uniform(2.1, 15.0) };
            out.duration_s = draw.uniform(25.0, 60.0);
            let (vel, dist, other) = (draw.uniform(0.6, 1.2), draw.unit(), draw.uniform(10.0, 25.0));
            match behavior.reaction {
                Reaction::Curious => (out.vel_mps, out.dist_m) = (vel, 1.0 + 1.5 * dist),
                Reaction::Surprised => out.dist_m = 2.0 + 4.0 * dist,
                Reaction::Scared => (out.vel_mps, out.dist_m, out.other_force) = (vel, 2.0 + 4.0 * dist, other),
                Reaction::Threatening => out.dist_m = 0.8 + 1.1 * dist,
                Reaction::Regular | Reaction::Impassive | Reaction::Custom(_) => {}
            }
        }
    }
    if mend { mended(out) } else { out }
}

/// The numbers of configuration 0.
fn fixed(reaction: Reaction, max_vel_mps: f64, once: bool) -> Parameters {
    let spare = Parameters {
        goal_force: 2.0,
        obstacle_force: 10.0,
        social_force: 5.0,
        other_force: 20.0,
        duration_s: 40.0,
        once,
        vel_mps: max_vel_mps,
        dist_m: 0.0,
    };
    match reaction {
        Reaction::Curious => Parameters { dist_m: 1.5, ..spare },
        Reaction::Surprised => Parameters { duration_s: 30.0, dist_m: 4.0, ..spare },
        Reaction::Scared => Parameters { vel_mps: 0.6, dist_m: 3.0, ..spare },
        Reaction::Threatening => Parameters { dist_m: 1.4, ..spare },
        Reaction::Regular | Reaction::Impassive | Reaction::Custom(_) => spare,
    }
}

fn mended(drawn: Parameters) -> Parameters {
    Parameters {
        duration_s: drawn.duration_s.max(SHORTEST_S),
        vel_mps: drawn.vel_mps.clamp(0.1, 1.8),
        dist_m: drawn.dist_m.max(0.5),
        other_force: drawn.other_force.clamp(0.0, OTHER_MEANT),
        ..drawn
    }
}

/// Seeded draws of one agent; the same number of them whatever the reaction, so that a change of one value of a file
/// does not move the others.
struct Draw(ChaCha8Rng);

impl Draw {
    fn of(seed: u64, agent: &AgentEntry) -> Self {
        Self(ChaCha8Rng::seed_from_u64(derive_seed(seed, &["behavior", &agent.name, &agent.id.to_string()])))
    }

    /// From 0 up to 1.
    fn unit(&mut self) -> f64 {
        seeds::unit(self.0.next_u64())
    }

    fn uniform(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    fn standard(&mut self) -> f64 {
        let (radius, turn) = (1.0 - self.unit(), self.unit());
        seeds::standard_normal(radius, turn)
    }

    fn normal(&mut self, mean: f64, deviation: f64) -> f64 {
        mean + deviation * self.standard()
    }
}
