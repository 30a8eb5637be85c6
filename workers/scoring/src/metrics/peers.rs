//! Names that other tools' tables have: for each the metric of ours that it is meant to be, or one that is computed as
//! the tool defines it, in SI units and at any sampling rate.
//!
//! ```text
//! sean.* socnavbench.* arena.* crowdnav.* socnavgym.*  ─►  an id of the catalog  ─►  value, unit, reason
//! ```
//!
//! A name is looked up when somebody asks for it ([`ours`], [`named`]): reports hold each value once. Defects of the
//! tools are not copied; `WHY_OUR_NUMBER_DIFFERS.md` lists them.

use std::collections::VecDeque;

use socrates_model::{MetricValue, Point};

use crate::metrics::online::{End, Now, Running, Setting};
use crate::metrics::scene::EVEN_SECS;
use crate::metrics::{Begin, Family, Measure, Measured, or_why};
use crate::running::{AreaBelow, Below, Least, MeanWhileBelow, Pen};

/// SEAN's radius of the goal, m.
const SEAN_GOAL_M: f64 = 1.2;
/// A robot that gets less far than this in this time does not move (SEAN), m and s.
const SEAN_STILL_M: f64 = 0.05;
const SEAN_STILL_SECS: f64 = 1.0;
/// Arena's personal space, m between centers.
const ARENA_SPACE_M: f64 = 1.0;
/// `CrowdNav`: nearer than this is danger, m; what a second at a depth of 1 m costs; what an arrival and a collision give.
const CROWDNAV_NEAR_M: f64 = 0.2;
const CROWDNAV_NEAR_PER_MS: f64 = 0.5;
const CROWDNAV_GOAL: f64 = 1.0;
const CROWDNAV_COLLISION: f64 = -0.25;

/// What other tools define otherwise than we do.
pub(super) const FAMILY: Family = Family {
    name: "peers",
    thresholds: &[
        ("sean_goal_m", SEAN_GOAL_M),
        ("sean_still_m", SEAN_STILL_M),
        ("sean_still_secs", SEAN_STILL_SECS),
        ("arena_space_m", ARENA_SPACE_M),
        ("crowdnav_near_m", CROWDNAV_NEAR_M),
        ("crowdnav_near_per_ms", CROWDNAV_NEAR_PER_MS),
        ("crowdnav_goal", CROWDNAV_GOAL),
        ("crowdnav_collision", CROWDNAV_COLLISION),
    ],
    measure: Measure::Online(Begin(|_| Box::new(Peers::new()))),
};

/// A name of another tool's table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Name {
    /// Namespace and name as the tool has it.
    pub name: &'static str,
    /// Id of the catalog.
    pub ours: &'static str,
    /// In what the tool's own figure differs; empty for nothing that is known.
    pub differs: &'static str,
}

const fn name(name: &'static str, ours: &'static str, differs: &'static str) -> Name {
    Name { name, ours, differs }
}

const RATE: &str = "theirs is counted in samples";
const ARENA: &str = "theirs is of the distance to the origin, or counts yaw and the way from the end to the start";
const ENDS: &str = "theirs ends the run at the first and is 0 or 1";

/// Every name, tool by tool, but for those that are ids of the catalog themselves.
pub const NAMES: &[Name] = &[
    name("sean.dist_to_target", "goal_distance_final", ""),
    name("sean.min_dist_to_target", "goal_distance_min", ""),
    name("sean.min_dist_to_ped", "human_distance_min", "theirs is between centers"),
    name("sean.robot_on_person_intimate_dist_violations", "intimate_entries_by_robot", RATE),
    name("sean.person_on_robot_intimate_dist_violations", "intimate_entries_by_person", RATE),
    name("sean.robot_on_person_personal_dist_violations", "personal_entries_by_robot", RATE),
    name("sean.person_on_robot_personal_dist_violations", "personal_entries_by_person", RATE),
    name("sean.robot_on_person_collisions", "robot_on_person_collisions", RATE),
    name("sean.person_on_robot_collisions", "person_on_robot_collisions", RATE),
    name("sean.obj_collisions", "wall_collisions", RATE),
    name("sean.path_length", "path_length", ""),
    name("sean.path_irregularity", "turning_excess", ""),
    name("sean.path_efficiency", "path_efficiency", ""),
    name("sean.episode_timed_out", "timeout", ""),
    name("socnavbench.success", "success", ""),
    name("socnavbench.wall_wait_time", "planner_wait", ""),
    name("socnavbench.robot_speed", "robot_speed_mean", ""),
    name("socnavbench.robot_acceleration", "acceleration_mean", ""),
    name("socnavbench.robot_jerk", "jerk_mean", ""),
    name("socnavbench.robot_motion_energy", "motion_energy", ""),
    name("socnavbench.path_length", "path_length", ""),
    name("socnavbench.path_length_ratio", "path_length_ratio", "theirs is the inverse of what it documents"),
    name("socnavbench.path_irregularity", "path_irregularity", "theirs depends on the origin of the map"),
    name("socnavbench.goal_traversal_ratio", "goal_ratio", "theirs is along straight lines"),
    name("socnavbench.time_to_collision", "ttc_min", "theirs leaves out radius and sideways motion of people"),
    name("socnavbench.closest_pedestrian_distance", "human_distance_min", ""),
    name("arena.path_length", "path_length", ARENA),
    name("arena.velocity", "robot_speed_mean", ARENA),
    name("arena.acceleration", "acceleration_mean", ARENA),
    name("arena.jerk", "jerk_mean", ARENA),
    name("arena.curvature", "curvature_mean", ARENA),
    name("arena.normalized_curvature", "curvature_normalized", ARENA),
    name("arena.roughness", "roughness", ARENA),
    name("arena.angle_over_length", "angle_over_length", ARENA),
    name("arena.collision_amount", "collisions", "theirs is of laser ranges"),
    name("arena.time_diff", "time_to_goal", "theirs is in units of 10 s and knows no timeout"),
    name("arena.total_time_looking_at_pedestrians", "time_watching", ""),
    name("arena.total_time_looked_at_by_pedestrians", "time_watched", "theirs takes the mirrored bearing"),
    name("crowdnav.success_rate", "success", "theirs does not know walls"),
    name("crowdnav.nav_time", "time_to_goal", "theirs is the mean over successes alone"),
    name("crowdnav.danger_frequency", "discomfort_share", RATE),
    name("crowdnav.danger_distance", "discomfort_distance", RATE),
    name("socnavgym.SUCCESS", "success", ""),
    name("socnavgym.COLLISION", "collisions", ENDS),
    name("socnavgym.COLLISION_HUMAN", "human_collisions", ENDS),
    name("socnavgym.COLLISION_WALL", "wall_collisions", ENDS),
    name("socnavgym.TIMEOUT", "timeout", ""),
    name("socnavgym.FAILURE_TO_PROGRESS", "failure_to_progress", ""),
    name("socnavgym.STALLED_TIME", "stalled_time", "theirs asks for a speed of exactly 0"),
    name("socnavgym.TIME_TO_REACH_GOAL", "time_to_goal", ""),
    name("socnavgym.STL", "stl", "theirs is against a run that may fail"),
    name("socnavgym.SPL", "spl", "theirs is against a run that may fail"),
    name("socnavgym.PATH_LENGTH", "path_length", ""),
    name("socnavgym.V_MIN", "robot_speed_min", ""),
    name("socnavgym.V_AVG", "robot_speed_mean", ""),
    name("socnavgym.V_MAX", "robot_speed_max", ""),
    name("socnavgym.A_MIN", "acceleration_min", ""),
    name("socnavgym.A_AVG", "acceleration_mean", ""),
    name("socnavgym.A_MAX", "acceleration_max", ""),
    name("socnavgym.JERK_MIN", "jerk_min", ""),
    name("socnavgym.JERK_AVG", "jerk_mean", ""),
    name("socnavgym.JERK_MAX", "jerk_max", ""),
    name("socnavgym.TIME_TO_COLLISION", "ttc_min", "theirs is in rounded ticks"),
    name("socnavgym.MINIMUM_DISTANCE_TO_HUMAN", "human_distance_min", ""),
    name("socnavgym.PERSONAL_SPACE_COMPLIANCE", "personal_space_compliance", ""),
    name("socnavgym.MINIMUM_OBSTACLE_DISTANCE", "clearing_distance_min", ""),
    name("socnavgym.AVERAGE_OBSTACLE_DISTANCE", "clearing_distance_mean", ""),
];

/// The name as another tool's table has it, whatever its case.
#[must_use]
pub fn ours(name: &str) -> Option<&'static Name> {
    NAMES.iter().find(|one| one.name.eq_ignore_ascii_case(name))
}

/// The values of a report under the names of other tools.
#[must_use]
pub fn named(values: &[MetricValue]) -> Vec<MetricValue> {
    let of = |name: &Name| values.iter().find(|value| value.id == name.ours).map(|value| (name.name, value));
    NAMES.iter().filter_map(of).map(|(name, value)| MetricValue { id: name.to_owned(), ..value.clone() }).collect()
}

#[derive(Clone)]
struct Peers {
    goal: Least,
    /// Places of the last second, the oldest first.
    second: VecDeque<(f64, Point)>,
    still: (Pen, Below),
    centers: Pen,
    speed: Pen,
    near: MeanWhileBelow,
    danger: AreaBelow,
    contact: AreaBelow,
}

impl Peers {
    fn new() -> Self {
        Self {
            goal: Least::default(),
            second: VecDeque::new(),
            still: (Pen::default(), Below::level(SEAN_STILL_M)),
            centers: Pen::default(),
            speed: Pen::default(),
            near: MeanWhileBelow::level(ARENA_SPACE_M),
            danger: AreaBelow::level(CROWDNAV_NEAR_M),
            contact: AreaBelow::level(0.0),
        }
    }

    /// How far the robot is from where it was a second before; `None` in its first second.
    fn moved_m(&mut self, t: f64, at: Point) -> Option<f64> {
        if self.second.back().is_some_and(|(last, _)| t - last > 1.5 * EVEN_SECS) {
            self.second.clear();
        }
        self.second.push_back((t, at));
        while self.second.get(1).is_some_and(|(next, _)| t - next >= SEAN_STILL_SECS - 1e-9) {
            self.second.pop_front();
        }
        let (then, from) = self.second.front()?;
        (t - then >= SEAN_STILL_SECS - 1e-9).then(|| (at - from).norm())
    }
}

impl Running for Peers {
    fn push(&mut self, setting: &Setting<'_>, now: &Now<'_>) {
        let robot = now.robot.filter(|robot| robot.there);
        self.goal.add(robot.zip(setting.goal).map(|(robot, goal)| (robot.at - goal).norm()));
        let moved = robot.and_then(|robot| self.moved_m(now.t, robot.at));
        let (pen, below) = &mut self.still;
        below.add(pen.to(now.t, moved));
        let there = now.humans.iter().filter(|human| human.there);
        let center = robot.and_then(|robot| there.map(|human| (robot.at - human.at).norm()).reduce(f64::min));
        let speed = self.speed.to(now.t, robot.map(crate::tracks::Sample::speed));
        self.near.add(speed, self.centers.to(now.t, center));
        self.danger.add(now.nearest_piece);
        self.contact.add(now.nearest_piece);
    }

    fn values(&self, end: &End<'_>) -> Vec<Measured> {
        let straight = |at: Point| end.setting.goal.map(|goal| (goal - at).norm());
        let whole = end.first.and_then(|first| straight(first.at)).filter(|way| *way > 1e-6);
        let left = end.last.and_then(|last| straight(last.at));
        let yes = |is: bool| if is { 1.0 } else { 0.0 };
        let touched = end.contacts > 0;
        let arrived = yes(end.arrived_s.is_some() && !touched) * CROWDNAV_GOAL;
        // Contacts are as deep as 0 m, however much the discs overlap.
        let discomfort = (self.danger.area() - self.contact.area()) * CROWDNAV_NEAR_PER_MS;
        vec![
            or_why(
                self.goal.value().map(|least| yes(least <= SEAN_GOAL_M || end.arrived_s.is_some())),
                "the recording is empty",
            ),
            or_why(whole.zip(left).map(|(whole, left)| left / whole), "start and goal are one place"),
            Ok(self.still.1.seconds()),
            Ok(end.length_s()),
            Ok(self.near.seconds()),
            or_why(self.near.mean(), "nobody's center comes within 1 m"),
            Ok(yes(touched)),
            Ok(arrived + yes(touched) * CROWDNAV_COLLISION - discomfort),
        ]
    }
}

#[cfg(test)]
mod tests;
