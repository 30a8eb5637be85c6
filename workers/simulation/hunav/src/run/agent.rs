//! One agent of a run: body, goals, reaction, memory of its tree's leaves.

use std::collections::{BTreeMap, VecDeque};

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;
use socrates_crowd::{CenterOrder, Params, Person};
use socrates_model::seeds::derive_seed;
use socrates_model::{AgentId, HumanId, Point, Polyline, Vector};

use crate::agents::{AgentEntry, GoalEntry, Reaction};
use crate::configure::Parameters;

/// Who moves an agent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum HumanModel {
    /// Social forces.
    #[default]
    SocialForces,
    /// Optimal reciprocal collision avoidance.
    Orca,
    /// A recorded track.
    Track,
}

impl HumanModel {
    /// All.
    pub const ALL: [Self; 3] = [Self::SocialForces, Self::Orca, Self::Track];

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SocialForces => "social-forces",
            Self::Orca => "orca",
            Self::Track => "track",
        }
    }

    /// The model of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}

/// What a leaf remembers between ticks.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Memory {
    /// Time counted by a timer, s.
    pub(crate) counted_s: f64,
    /// Whether a timer that fires once has fired.
    pub(crate) fired: bool,
    /// When a running leaf began, s.
    pub(crate) since_s: f64,
}

/// An agent.
#[derive(Debug, Clone)]
pub(crate) struct Agent {
    pub(crate) human: HumanId,
    /// Number that trees know it by.
    pub(crate) id: i64,
    pub(crate) name: String,
    pub(crate) reaction: Reaction,
    pub(crate) parameters: Parameters,
    pub(crate) forces: Params,
    pub(crate) radius_m: f64,
    pub(crate) max_vel_mps: f64,
    /// What `StopMovement` took away.
    pub(crate) stopped: bool,
    pub(crate) group: Option<u32>,
    pub(crate) goals: VecDeque<GoalEntry>,
    pub(crate) goal_radius_m: f64,
    pub(crate) cyclic: bool,
    pub(crate) at: Point,
    pub(crate) velocity: Vector,
    pub(crate) yaw: f64,
    pub(crate) omega: f64,
    /// 0 walks, 1 reacts, 2 gives way.
    pub(crate) state: u8,
    pub(crate) state_before: u8,
    /// Gesture code as the tree gave it.
    pub(crate) gesture: i64,
    /// Gesture code as others see it.
    pub(crate) shown: i64,
    pub(crate) said_s: Option<f64>,
    /// Force of this tick, computed before the trees.
    pub(crate) force: Vector,
    /// Place in the header's list of leaves; 0 none.
    pub(crate) leaf: u16,
    pub(crate) model: HumanModel,
    /// Whether a recorded track has it on the floor now.
    pub(crate) present: bool,
    pub(crate) memory: BTreeMap<u16, Memory>,
    pub(crate) random: ChaCha8Rng,
    pub(crate) errand: Errand,
}

/// What native motion remembers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Errand {
    /// A way round walls to a goal, and how far along it.
    pub(crate) way: Option<(Polyline, f64)>,
    /// When it was planned, s.
    pub(crate) planned_s: f64,
    /// A spot chosen to step aside or flee to.
    pub(crate) spot: Option<Point>,
    /// When it was chosen, s.
    pub(crate) chosen_s: f64,
    /// Until when it knows where the robot is without seeing it, s.
    pub(crate) aware_until_s: f64,
    /// For how long it has wanted to walk and not got on, s.
    pub(crate) jammed_s: f64,
    /// Until when it goes round whoever it is jammed with, s.
    pub(crate) dodges_until_s: f64,
    /// How often it has done so.
    pub(crate) dodges: u32,
    /// Where it stands while it stands.
    pub(crate) anchor: Option<Point>,
}

impl Agent {
    pub(crate) fn new(entry: &AgentEntry, number: u32, parameters: Parameters, native: bool, seed: u64) -> Self {
        let base = if native { Params::default() } else { Params::lightsfm_hunav() };
        let forces = Params {
            desired: parameters.goal_force,
            obstacle: parameters.obstacle_force,
            social: parameters.social_force,
            center: if native { CenterOrder::List } else { CenterOrder::SelfFirst },
            ..base
        };
        Self {
            human: HumanId::new(number),
            id: entry.id,
            name: entry.name.clone(),
            reaction: entry.behavior.reaction,
            parameters,
            forces,
            radius_m: entry.radius_m,
            max_vel_mps: entry.max_vel_mps,
            stopped: false,
            group: entry.group(),
            goals: entry.goals.iter().cloned().collect(),
            goal_radius_m: entry.goal_radius_m,
            cyclic: entry.cyclic_goals,
            at: entry.start_point(),
            velocity: Vector::zeros(),
            yaw: socrates_model::geometry::wrap_angle(entry.start.h),
            omega: 0.0,
            state: 0,
            state_before: 0,
            gesture: 0,
            shown: 0,
            said_s: None,
            force: Vector::zeros(),
            leaf: 0,
            model: HumanModel::SocialForces,
            present: true,
            memory: BTreeMap::new(),
            random: ChaCha8Rng::seed_from_u64(derive_seed(seed, &["chance", &entry.name, &entry.id.to_string()])),
            errand: Errand::default(),
        }
    }

    pub(crate) const fn agent(&self) -> AgentId {
        AgentId::Human(self.human)
    }

    /// Speed it would walk at, m/s.
    pub(crate) const fn speed_mps(&self) -> f64 {
        if self.stopped { 0.0 } else { self.max_vel_mps }
    }

    /// As the forces see it.
    pub(crate) fn person(&self) -> Person {
        Person {
            id: self.human.number(),
            position: self.at,
            velocity: self.velocity,
            yaw: self.yaw,
            radius_m: self.radius_m,
            speed_mps: self.speed_mps(),
            goal: None,
            group: self.group,
        }
    }

    /// Whether it is at its first goal as trees ask it.
    pub(crate) fn at_goal(&self) -> bool {
        self.goals.front().is_some_and(|goal| (goal.at - self.at).norm() <= self.goal_radius_m + 0.1)
    }

    /// Takes the first goal off the list; a cyclic list gets it back at its end. Gives back its name.
    pub(crate) fn next_goal(&mut self, keep_last: bool) -> Option<String> {
        if keep_last && self.goals.len() < 2 {
            return None;
        }
        let goal = self.goals.pop_front()?;
        let name = goal.name.clone();
        if self.cyclic {
            self.goals.push_back(goal);
        }
        Some(name)
    }
}
