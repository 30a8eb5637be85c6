//! Kits for HuNavSim: agents file, behavior trees, world, map and launch file, in the spelling of each version.
//!
//! The agents file is written by the table that reads it (`socrates-hunav`). In its Gazebo plugin an obstacle is the nearest
//! point of a model's box on the way to its middle, and a model at x = 0 or y = 0 is no obstacle: walls are models of at most
//! 1 m, none of them on an axis.

mod agents;
mod launch;
mod trees;

use socrates_bt::Library;
use socrates_hunav::Dialect;

use super::content::Content;
use super::frames::{file_name, real};
use super::sdf::{WALL_M, World, robot_yaml, walls};
use super::{File, Files, Foreign, Format, Scenario, map_files};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Longest side of a piece of wall, m.
const PIECE_M: f64 = 1.0;
/// Distance from an axis that keeps a model an obstacle, m.
const NUDGE_M: f64 = 0.001;

/// A version of HuNavSim.
#[derive(Debug, Clone, Copy)]
struct Kit {
    /// Spelling of its agents files.
    dialect: Dialect,
    /// Its nodes; `None` where its trees are fixed.
    library: Option<Library>,
    /// Height at which people are placed, m.
    z_m: f64,
    /// Whether it has the scenario manager of SocRATES's fork.
    manager: bool,
}

const V1_0: Kit = Kit { dialect: Dialect::V1_0, library: None, z_m: 1.25, manager: false };
const V1_1: Kit = Kit { dialect: Dialect::V1_1, library: None, z_m: 1.25, manager: false };
const V2_0: Kit = Kit { dialect: Dialect::V2_0, library: Some(Library::HunavSim2), z_m: 0.0, manager: false };
const FORK: Kit = Kit { dialect: Dialect::V1_0, library: Some(Library::SocratesFork), z_m: 1.25, manager: true };

const SIMULATED: &str = "people are simulated anew; the kit has where they begin, their ways and their pace";
const NO_PLACE: &str = "HuNavSim has no place for it";
const FIXED: &str = "this version has fixed reactions and no trees of one's own; everybody is `Regular`";
const NO_MANAGER: &str = "nobody waits for anybody; the pace of people is that of the run";

/// What a version lacks; every version lacks what is not an exception of it.
macro_rules! lacks {
    ($($more:expr),*) => {
        &[
            (Content::RobotTrack, "the robot is yours; its start and way points stand in a file of their own"),
            (Content::Velocities, SIMULATED),
            (Content::Gestures, SIMULATED),
            (Content::Leaves, SIMULATED),
            (Content::Events, SIMULATED),
            (Content::Roles, "people have a look, not a role"),
            (Content::Doors, "no version of HuNavSim has doors: they stand open"),
            (Content::DoorRules, "no version of HuNavSim has doors: they stand open"),
            (Content::Graph, NO_PLACE),
            (Content::AreaNames, NO_PLACE),
            (Content::Clauses, NO_PLACE),
            (Content::Texts, NO_PLACE),
            $($more),*
        ]
    };
}

const CHECKED: &str = "no ROS here: agents and trees are read and played by our reader, the world by `sdformat`";

/// HuNavSim 1.0.
pub(super) const HUNAV_1_0: Format = Format {
    name: "hunav-1.0",
    stem: "hunav",
    about: "HuNavSim 1.0 kit: agents file, world, map, launch file",
    foreign: Foreign::Neither,
    checked_by: CHECKED,
    needs_run: false,
    feature: None,
    lacks: lacks![(Content::Encounters, NO_MANAGER), (Content::Trees, FIXED)],
    write: |scenario, losses| write(scenario, losses, &V1_0),
};

/// HuNavSim 1.1.
pub(super) const HUNAV_1_1: Format = Format {
    name: "hunav-1.1",
    stem: "hunav",
    about: "HuNavSim 1.1 kit: agents file, world, map, launch file",
    write: |scenario, losses| write(scenario, losses, &V1_1),
    ..HUNAV_1_0
};

/// HuNavSim 2.0.
pub(super) const HUNAV_2_0: Format = Format {
    name: "hunav-2.0",
    stem: "hunav",
    about: "HuNavSim 2.0 kit: agents file, trees (BehaviorTree.CPP 4), world, map, launch file",
    lacks: lacks![(Content::Encounters, NO_MANAGER)],
    write: |scenario, losses| write(scenario, losses, &V2_0),
    ..HUNAV_1_0
};

/// SocRATES's fork of HuNavSim.
pub(super) const HUNAV_FORK: Format = Format {
    name: "hunav-fork",
    stem: "hunav",
    about: "kit for SocRATES's fork of HuNavSim: agents file, trees (BehaviorTree.CPP 3), scenario manager, world, map, launch file",
    lacks: lacks![],
    write: |scenario, losses| write(scenario, losses, &FORK),
    ..HUNAV_1_0
};

fn write(scenario: &Scenario, losses: &mut Losses, kit: &Kit) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let base = format!("{name}_agents");
    let mut files = Files::new();
    let trees = trees::trees(scenario, kit, &base, losses);
    let file = agents::agents(scenario, kit, &base, &trees, losses)?;
    files.insert(format!("config/{base}.yaml"), File::Text(file.to_yaml()));
    for (path, text) in trees.files {
        files.insert(format!("behavior_trees/{path}"), File::Text(text));
    }
    files.insert(format!("worlds/{name}.world"), File::Text(world(scenario, &name, losses)?));
    map_files::add(&mut files, "maps", &scenario.location.grid);
    if kit.manager {
        let trajectory = crate::socrates_json::trajectory(&scenario.proposal, &scenario.paths);
        files.insert("config/trajectory.json".to_owned(), File::Text(format!("{trajectory:#}\n")));
        files.insert("config/robot_poses.yaml".to_owned(), File::Text(agents::robot_poses(scenario)));
    } else {
        files.insert("config/robot.yaml".to_owned(), File::Text(robot_yaml(scenario)));
    }
    files.insert(format!("launch/{name}.launch.py"), File::Text(launch::launch(&name, &base)));
    Ok(files)
}

/// The world without people and plugin, which HuNavSim's generator adds.
fn world(scenario: &Scenario, name: &str, losses: &mut Losses) -> Result<String, Unusable> {
    let turn = scenario.location.grid.origin.yaw;
    let mut world = World { text: String::new(), turn };
    world.begin(name, "1.5");
    for (number, block) in walls(scenario, PIECE_M)?.iter().enumerate() {
        let off_axis = |at: f64| if at.abs() < NUDGE_M { NUDGE_M } else { at };
        let (x, y) = (real(off_axis(block.middle.x)), real(off_axis(block.middle.y)));
        let (z, yaw) = (real(WALL_M / 2.0), real(turn));
        let size = format!("{} {} {}", real(block.along_m), real(block.across_m), real(WALL_M));
        world.add(format_args!(
            r#"    <model name="wall_{number}">
      <static>true</static>
      <pose>{x} {y} {z} 0.0 0.0 {yaw}</pose>
      <link name="link">
        <collision name="collision">
          <geometry><box><size>{size}</size></box></geometry>
        </collision>
        <visual name="visual">
          <geometry><box><size>{size}</size></box></geometry>
        </visual>
      </link>
    </model>
"#
        ));
    }
    if turn != 0.0 {
        let why = "the plugin takes a box along the axes around each turned piece, which is up to 1.4 times as long";
        losses.note("turn of walls", "location.json grid.origin", why);
    }
    world.text.push_str("  </world>\n</sdf>\n");
    Ok(world.text)
}
