//! A bag of ROS 2 (MCAP with CDR) with what a robot and a tracker of people would have published, and a package that plays it beside the map
//! and the route graph.
//!
//! ```text
//! run ─► messages of each tick ─► bag/NAME.mcap, bag/metadata.yaml
//! location ─► maps/map.yaml, route/graph.geojson      paths ─► config/waypoints.yaml      ─► launch/NAME.launch.py
//! ```
//!
//! The scan is computed from the map and the discs of people: 360 beams, ten times a second.

mod bag;
mod cdr;
mod definitions;
mod package;
mod scan;

use std::collections::BTreeMap;

use socrates_model::recording::AgentInfo;
use socrates_model::{AgentId, AgentState, Grid, NodeId, Point, Recording};

use self::bag::{BEGIN_NANOS, Kept, Topic};
pub use self::bag::{Bag, Channel, Message};
use self::cdr::Cdr;
use self::scan::{BEAMS, Lidar};
use super::content::{Content, WORDS};
use super::frames::{Sample, file_name, number, samples, small_ids};
use super::sdf::robot_yaml;
use super::{File, Files, Foreign, Format, Scenario, map_files};
use crate::graph::Unusable;
use crate::not_carried::Losses;

const CLOCK: Topic = Topic { name: "/clock", kind: "rosgraph_msgs/Clock", kept: Kept::No };
const TF: Topic = Topic { name: "/tf", kind: "tf2_msgs/TFMessage", kept: Kept::No };
const TF_STATIC: Topic = Topic { name: "/tf_static", kind: "tf2_msgs/TFMessage", kept: Kept::Last };
const MAP: Topic = Topic { name: "/map", kind: "nav_msgs/OccupancyGrid", kept: Kept::Last };
const PLAN: Topic = Topic { name: "/plan", kind: "nav_msgs/Path", kept: Kept::Last };
const ODOM: Topic = Topic { name: "/odom", kind: "nav_msgs/Odometry", kept: Kept::No };
const SCAN: Topic = Topic { name: "/scan", kind: "sensor_msgs/LaserScan", kept: Kept::No };
const PEOPLE: Topic = Topic { name: "/people", kind: "people_msgs/People", kept: Kept::No };
const POSES: Topic = Topic { name: "/people_poses", kind: "geometry_msgs/PoseArray", kept: Kept::No };
const HUMANS: Topic = Topic { name: "/human_states", kind: "hunav_msgs/Agents", kept: Kept::No };
const ROBOT: Topic = Topic { name: "/robot_states", kind: "hunav_msgs/Agent", kept: Kept::No };

/// Ticks from one scan to the next.
const SCAN_TICKS: u64 = 10;
/// Distance at which HuNavSim takes a goal for reached, m.
const GOAL_M: f64 = 0.3;
/// Numbers by which HuNavSim knows people and robots, and its ordinary behavior.
const PERSON_TYPE: u8 = 1;
const ROBOT_TYPE: u8 = 2;
const REGULAR: u8 = 1;
/// Group of those who have none.
const ALONE: u8 = u8::MAX;

const NO_DOORS: &str = "an occupancy grid has no doors: they are free floor";

pub(super) const FORMAT: Format = Format {
    name: "rosbag2-5",
    stem: "rosbag2",
    about: "bag of ROS 2 (MCAP, CDR): clock, tf, odom, scan, map, plan, people, HuNavSim agents; with map, route graph and launch file",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `rosbags` 0.11.9 and `mcap-ros2-support` 0.6.0",
    needs_run: true,
    feature: None,
    lacks: &[
        (Content::Leaves, "messages of ROS have no place for it"),
        (Content::Events, "messages of ROS have no place for it"),
        (Content::Doors, NO_DOORS),
        (Content::DoorRules, NO_DOORS),
        (Content::Encounters, WORDS),
        (Content::Trees, WORDS),
        (Content::Clauses, WORDS),
        (Content::Texts, WORDS),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let name = file_name(&scenario.name, losses);
    let mcap = format!("{name}_0.mcap");
    let bag = recorded(scenario, run, losses)?;
    let metadata = bag.metadata(&mcap)?;
    let open = socrates_model::Location { doors: Vec::new(), ..scenario.location.clone() };
    let (route, _) = crate::nav2_route::write(&open);
    let mut files = Files::from([
        (format!("bag/{mcap}"), File::Bag(bag)),
        ("bag/metadata.yaml".to_owned(), File::Text(metadata)),
        ("route/graph.geojson".to_owned(), File::Text(route)),
        ("config/waypoints.yaml".to_owned(), File::Text(robot_yaml(scenario))),
        (format!("launch/{name}.launch.py"), File::Text(package::launch(&name))),
        ("package.xml".to_owned(), File::Text(package::manifest(&name))),
        ("CMakeLists.txt".to_owned(), File::Text(package::cmake(&name))),
    ]);
    map_files::add(&mut files, "maps", &scenario.location.grid);
    Ok(files)
}

/// The bag of a run.
fn recorded(scenario: &Scenario, run: &Recording, losses: &mut Losses) -> Result<Bag, Unusable> {
    small_ids(run.header.agents.iter().map(|info| info.agent))?;
    for group in scenario.proposal.groups.iter().filter(|group| group.id.0 >= u32::from(ALONE)) {
        let why = "HuNavSim's message has a byte for a group, and 255 is none: its people are written as alone";
        losses.note("groups above 254", format!("proposal.json groups: {}", group.id), why);
    }
    let mut bag = Bag::default();
    let cast = Cast::of(scenario, run);
    bag.send(TF_STATIC, 0, transform(0, "map", "odom", Point::origin(), 0.0));
    bag.send(MAP, 0, map(&scenario.location.grid));
    let goals = cast.goals.get(&AgentId::Robot).map_or(&[][..], Vec::as_slice);
    bag.send(PLAN, 0, path(goals));
    let lidar = Lidar::of(&scenario.location.grid);
    for sample in &samples(run, 1)? {
        cast.tick(&mut bag, sample, &lidar);
    }
    Ok(bag)
}

/// What is known of everybody besides their states.
struct Cast<'a> {
    infos: BTreeMap<AgentId, &'a AgentInfo>,
    /// Places of the nodes of everybody's intended path.
    goals: BTreeMap<AgentId, Vec<Point>>,
    groups: BTreeMap<AgentId, u32>,
    roles: BTreeMap<AgentId, &'a str>,
}

impl<'a> Cast<'a> {
    fn of(scenario: &'a Scenario, run: &'a Recording) -> Self {
        let places = |nodes: &[NodeId]| -> Vec<Point> {
            nodes.iter().filter_map(|id| scenario.location.graph.node(id)).map(|node| node.at).collect()
        };
        let humans = scenario.paths.humans.iter().map(|(id, nodes)| (AgentId::Human(*id), places(nodes)));
        let groups = scenario
            .proposal
            .groups
            .iter()
            .flat_map(|group| group.members.iter().map(|member| (AgentId::Human(*member), group.id.0)));
        Self {
            infos: run.header.agents.iter().map(|info| (info.agent, info)).collect(),
            goals: humans.chain([(AgentId::Robot, places(&scenario.paths.robot))]).collect(),
            groups: groups.collect(),
            roles: scenario.proposal.humans.iter().map(|human| (human.id.into(), human.role.as_str())).collect(),
        }
    }

    fn radius_m(&self, agent: AgentId) -> f64 {
        self.infos.get(&agent).map_or(0.0, |info| info.radius_m)
    }

    /// The messages of one tick.
    fn tick(&self, bag: &mut Bag, sample: &Sample<'_>, lidar: &Lidar) {
        let nanos = sample.time.nanos();
        let mut clock = Cdr::new();
        clock.time(BEGIN_NANOS + nanos);
        bag.send(CLOCK, nanos, clock);
        let (robots, people): (Vec<&AgentState>, Vec<&AgentState>) =
            sample.states.iter().copied().partition(|state| state.agent_id() == AgentId::Robot);
        if let Some(robot) = robots.first() {
            bag.send(TF, nanos, transform(nanos, "odom", "base_link", at(robot), robot.yaw));
            bag.send(ODOM, nanos, odometry(nanos, robot));
            let mut message = Cdr::new();
            self.agent(&mut message, robot);
            bag.send(ROBOT, nanos, message);
            if sample.number.is_multiple_of(SCAN_TICKS) {
                let discs: Vec<(Point, f64)> =
                    people.iter().map(|state| (at(state), self.radius_m(state.agent_id()))).collect();
                bag.send(SCAN, nanos, scan(nanos, &lidar.ranges(at(robot), robot.yaw, &discs)));
            }
        }
        bag.send(PEOPLE, nanos, self.people(nanos, &people));
        let mut poses = headed(nanos, "map");
        poses.count(people.len());
        people.iter().for_each(|state| poses.pose(at(state), state.yaw));
        bag.send(POSES, nanos, poses);
        let mut agents = headed(nanos, "map");
        agents.count(people.len());
        people.iter().for_each(|state| self.agent(&mut agents, state));
        bag.send(HUMANS, nanos, agents);
    }

    /// `people_msgs/People` with role, group and gesture as tags.
    fn people(&self, nanos: u64, people: &[&AgentState]) -> Cdr {
        let mut cdr = headed(nanos, "map");
        cdr.count(people.len());
        for state in people {
            let agent = state.agent_id();
            cdr.text(&agent.to_string());
            cdr.doubles(&[state.x, state.y, 0.0, state.vx, state.vy, 0.0, 1.0]);
            let role = self.roles.get(&agent).map(|role| ("role", (*role).to_owned()));
            let group = self.groups.get(&agent).map(|group| ("group", group.to_string()));
            let gesture = state.gesture().map(|gesture| ("gesture", gesture.name().to_owned()));
            let tags: Vec<(&str, String)> = role.into_iter().chain(group).chain(gesture).collect();
            cdr.count(tags.len());
            tags.iter().for_each(|(name, _)| cdr.text(name));
            cdr.count(tags.len());
            tags.iter().for_each(|(_, tag)| cdr.text(tag));
        }
        cdr
    }

    /// `hunav_msgs/Agent` of HuNavSim 1.0.
    fn agent(&self, cdr: &mut Cdr, state: &AgentState) {
        let agent = state.agent_id();
        cdr.int(i32::try_from(number(agent)).unwrap_or(i32::MAX));
        cdr.byte(if agent == AgentId::Robot { ROBOT_TYPE } else { PERSON_TYPE });
        cdr.byte(0);
        cdr.byte(REGULAR);
        cdr.text(&agent.to_string());
        cdr.byte(0);
        cdr.byte(self.groups.get(&agent).map_or(ALONE, |group| u8::try_from(*group).unwrap_or(ALONE)));
        cdr.pose(at(state), state.yaw);
        cdr.single(state.yaw);
        cdr.twist([state.vx, state.vy], state.omega);
        cdr.single(self.infos.get(&agent).map_or(0.0, |info| info.speed_mps));
        cdr.single(self.radius_m(agent));
        cdr.single(libm::hypot(state.vx, state.vy));
        cdr.single(state.omega);
        let goals = self.goals.get(&agent).map_or(&[][..], Vec::as_slice);
        cdr.count(goals.len());
        goals.iter().for_each(|goal| cdr.pose(*goal, 0.0));
        cdr.byte(0);
        cdr.single(GOAL_M);
        cdr.count(0);
    }
}

const fn at(state: &AgentState) -> Point {
    Point::new(state.x, state.y)
}

fn headed(nanos: u64, frame: &str) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.header(BEGIN_NANOS + nanos, frame);
    cdr
}

fn transform(nanos: u64, parent: &str, child: &str, at: Point, yaw: f64) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.count(1);
    cdr.header(BEGIN_NANOS + nanos, parent);
    cdr.text(child);
    cdr.pose(at, yaw);
    cdr
}

/// Where the robot is in `odom`, which is `map` here, and how fast in its own frame.
fn odometry(nanos: u64, robot: &AgentState) -> Cdr {
    let mut cdr = headed(nanos, "odom");
    cdr.text("base_link");
    cdr.pose(at(robot), robot.yaw);
    cdr.doubles(&[0.0; 36]);
    let (sin, cos) = libm::sincos(robot.yaw);
    cdr.twist([robot.vx * cos + robot.vy * sin, robot.vy * cos - robot.vx * sin], robot.omega);
    cdr.doubles(&[0.0; 36]);
    cdr
}

fn path(nodes: &[Point]) -> Cdr {
    let mut cdr = headed(0, "map");
    cdr.count(nodes.len());
    for node in nodes {
        cdr.header(BEGIN_NANOS, "map");
        cdr.pose(*node, 0.0);
    }
    cdr
}

/// Cells from the lower left one on, row by row: 0 free, 100 occupied, -1 never seen.
fn map(grid: &Grid) -> Cdr {
    let mut cdr = headed(0, "map");
    cdr.time(BEGIN_NANOS);
    cdr.single(grid.resolution_m);
    cdr.count(grid.width);
    cdr.count(grid.height);
    cdr.pose(Point::new(grid.origin.x, grid.origin.y), grid.origin.yaw);
    cdr.count(grid.cells.len());
    // Images begin at the top.
    for row in grid.cells.chunks(grid.width.max(1)).rev() {
        row.iter().for_each(|cell| cdr.byte(occupancy(*cell)));
    }
    cdr
}

const fn occupancy(cell: socrates_model::Cell) -> u8 {
    match cell {
        socrates_model::Cell::Free => 0,
        socrates_model::Cell::Occupied => 100,
        socrates_model::Cell::Unknown => u8::MAX,
    }
}

fn scan(nanos: u64, ranges: &[f64]) -> Cdr {
    use std::f64::consts::{PI, TAU};
    let mut cdr = headed(nanos, "base_link");
    let step = TAU / f64::from(BEAMS);
    for value in [-PI, PI - step, step, 0.0, 0.1, scan::NEAREST_M, scan::FARTHEST_M] {
        cdr.single(value);
    }
    cdr.count(ranges.len());
    ranges.iter().for_each(|range| cdr.single(*range));
    cdr.count(0);
    cdr
}
