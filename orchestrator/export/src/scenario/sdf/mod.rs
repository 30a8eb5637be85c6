//! Worlds of Gazebo in SDF 1.6: walls as boxes, doors on sliding joints, lights, and people as actors who replay the run.
//!
//! Sun and ground stand in the file itself: `model://` is found by one Gazebo and not by another.

pub(super) mod script;

use std::fmt::Write as _;

use socrates_model::{AgentId, Cell, Door, DoorKind, DoorOpens};

use self::script::Waypoint;
use super::boxes::{Block, blocks};
use super::content::Content;
use super::frames::{file_name, plain_name, real};
use super::{File, Files, Foreign, Format, Scenario, map_files};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Height of walls, m.
pub(super) const WALL_M: f64 = 2.5;
/// Height of doors, m.
pub(super) const DOOR_M: f64 = 2.1;
/// Thickness of doors, m.
pub(super) const LEAF_M: f64 = 0.05;
/// Height of the lamp of an elevator, m.
const LAMP_M: f64 = 2.4;
/// Largest number of boxes of a world.
const MOST_BLOCKS: usize = 200_000;

const REPLAY: &str = "actors replay places and headings alone";
const FLOOR: &str = "a world has bodies, not graphs or names of areas";
const RULES: &str = "a world has no place for rules of a scenario";

pub(super) const FORMAT: Format = Format {
    name: "sdf-1.6",
    stem: "sdf",
    about: "world of Gazebo Classic and Gz Sim: walls, doors, lights, people as actors; map.yaml and the robot's way beside it",
    foreign: Foreign::Parsed,
    checked_by: "crate `sdformat` 0.1.0, and Debian's `libsdformat12` where it is installed",
    needs_run: false,
    feature: None,
    lacks: &[
        (Content::RobotTrack, "the robot is yours; its start and way points stand in robot.yaml"),
        (Content::Velocities, REPLAY),
        (Content::Gestures, REPLAY),
        (Content::Leaves, REPLAY),
        (Content::Events, REPLAY),
        (Content::Radii, "actors have no bodies that touch anything"),
        (Content::Speeds, REPLAY),
        (Content::Roles, RULES),
        (Content::Groups, RULES),
        (Content::Graph, FLOOR),
        (Content::AreaNames, FLOOR),
        (Content::Encounters, RULES),
        (Content::Trees, RULES),
        (Content::Clauses, RULES),
        (Content::Texts, RULES),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let mut world = World { text: String::new(), turn: scenario.location.grid.origin.yaw };
    world.begin(&name, "1.6");
    world.walls(&walls(scenario, f64::INFINITY)?);
    for door in &scenario.location.doors {
        world.door(door, scenario);
    }
    for place in Content::DoorRules.places(scenario) {
        losses.note(
            "times of doors",
            place,
            "doors have joints and no controller: those that are not always open stand closed",
        );
    }
    if let Some(door) = scenario.location.doors.iter().find(|door| door.kind == DoorKind::Elevator) {
        let at = format!("location.json door `{}`", door.id);
        losses.note("elevator machinery", at, "a car is a lit room behind its landing door; the world has one floor");
    }
    if let Some(run) = &scenario.recording {
        let absent = run.header.absent();
        for info in run.header.agents.iter().filter(|info| info.agent != AgentId::Robot) {
            let poses = script::script(run, info.agent);
            if run.track(info.agent).any(|state| !state.is_there(absent)) {
                let at = format!("recording: {}", info.agent);
                losses.note(
                    "absence of people",
                    at,
                    "an actor stands at its first place until it walks, and at its last one then",
                );
            }
            world.actor(&info.agent.to_string(), &poses);
        }
    }
    world.text.push_str("  </world>\n</sdf>\n");
    scenario.note_people(Content::Paths, "paths of people", "actors replay the run", losses);
    let mut files = Files::from([
        (format!("{name}.world"), File::Text(world.text)),
        ("robot.yaml".to_owned(), File::Text(robot_yaml(scenario))),
    ]);
    map_files::add(&mut files, "map", &scenario.location.grid);
    Ok(files)
}

/// The walls of a location as boxes.
pub(super) fn walls(scenario: &Scenario, longest_m: f64) -> Result<Vec<Block>, Unusable> {
    boxes(scenario, Cell::Occupied, longest_m)
}

/// The cells of a kind as boxes.
pub(super) fn boxes(scenario: &Scenario, kind: Cell, longest_m: f64) -> Result<Vec<Block>, Unusable> {
    let blocks = blocks(&scenario.location.grid, kind, longest_m);
    if blocks.len() > MOST_BLOCKS {
        let problem = format!("the cells of a kind are {} boxes; at most {MOST_BLOCKS} are written", blocks.len());
        return Err(Unusable::new(
            "location.json grid",
            problem,
            "remove specks of the map first, or use a coarser map",
        ));
    }
    Ok(blocks)
}

/// The robot's start and way points, as the nodes of its intended path.
pub(super) fn robot_yaml(scenario: &Scenario) -> String {
    let graph = &scenario.location.graph;
    let nodes: Vec<_> = scenario.paths.robot.iter().filter_map(|id| graph.node(id)).map(|node| node.at).collect();
    let yaw = |place: usize| match (nodes.get(place), nodes.get(place + 1)) {
        (Some(here), Some(next)) => libm::atan2(next.y - here.y, next.x - here.x),
        _ => 0.0,
    };
    let row = |place: usize| {
        let at = nodes.get(place).copied().unwrap_or_default();
        // The last one keeps the heading with which the robot arrives.
        let heading = if place + 1 == nodes.len() { yaw(place.saturating_sub(1)) } else { yaw(place) };
        format!("{{x: {}, y: {}, yaw: {}}}", real(at.x), real(at.y), real(heading))
    };
    let mut text = format!("frame_id: map\nradius: {}\n", real(scenario.robot_radius_m));
    if nodes.is_empty() {
        text.push_str("waypoints: []\n");
        return text;
    }
    text.push_str(&format!("initial_pose: {}\nwaypoints:\n", row(0)));
    for place in 1..nodes.len() {
        text.push_str(&format!("  - {}\n", row(place)));
    }
    text
}

/// The text of a world as it grows.
#[derive(Debug, Default)]
pub(super) struct World {
    pub(super) text: String,
    /// Yaw of the map, rad.
    pub(super) turn: f64,
}

impl World {
    /// Adds lines; writing to a String cannot fail.
    pub(super) fn add(&mut self, text: std::fmt::Arguments<'_>) {
        let (Ok(()) | Err(std::fmt::Error)) = self.text.write_fmt(text);
    }

    /// What every world begins with.
    pub(super) fn begin(&mut self, name: &str, version: &str) {
        self.add(format_args!(
            r#"<?xml version="1.0"?>
<sdf version="{version}">
  <world name="{name}">
    <gravity>0 0 -9.8</gravity>
    <magnetic_field>6e-06 2.3e-05 -4.2e-05</magnetic_field>
    <atmosphere type="adiabatic"/>
    <physics name="step_10ms" default="1" type="ode">
      <max_step_size>0.01</max_step_size>
      <real_time_factor>1.0</real_time_factor>
      <real_time_update_rate>100</real_time_update_rate>
    </physics>
    <scene>
      <ambient>0.6 0.6 0.6 1.0</ambient>
      <background>0.8 0.8 0.8 1.0</background>
      <shadows>false</shadows>
    </scene>
    <light name="sun" type="directional">
      <cast_shadows>false</cast_shadows>
      <pose>0.0 0.0 10.0 0.0 0.0 0.0</pose>
      <diffuse>0.8 0.8 0.8 1.0</diffuse>
      <specular>0.2 0.2 0.2 1.0</specular>
      <direction>-0.5 0.1 -0.9</direction>
    </light>
    <model name="ground_plane">
      <static>true</static>
      <link name="link">
        <collision name="collision">
          <geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry>
        </collision>
        <visual name="visual">
          <geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry>
        </visual>
      </link>
    </model>
"#
        ));
    }

    /// All walls as one model that stands still.
    fn walls(&mut self, blocks: &[Block]) {
        if blocks.is_empty() {
            return;
        }
        self.text.push_str("    <model name=\"walls\">\n      <static>true</static>\n      <link name=\"link\">\n");
        for (number, block) in blocks.iter().enumerate() {
            let pose = format!(
                "{} {} {} 0.0 0.0 {}",
                real(block.middle.x),
                real(block.middle.y),
                real(WALL_M / 2.0),
                real(self.turn)
            );
            let size = format!("{} {} {}", real(block.along_m), real(block.across_m), real(WALL_M));
            self.add(format_args!(
                r#"        <collision name="wall_{number}">
          <pose>{pose}</pose>
          <geometry><box><size>{size}</size></box></geometry>
          <surface><contact><collide_bitmask>1</collide_bitmask></contact></surface>
        </collision>
        <visual name="wall_{number}_visual">
          <pose>{pose}</pose>
          <geometry><box><size>{size}</size></box></geometry>
        </visual>
"#
            ));
        }
        self.text.push_str("      </link>\n    </model>\n");
    }

    /// A door as a leaf that slides along its line into the wall; walls and leaves do not touch each other.
    fn door(&mut self, door: &Door, scenario: &Scenario) {
        let line = door.to - door.from;
        let (length, yaw) = (line.norm(), libm::atan2(line.y, line.x));
        let (name, middle) = (plain_name(&door.id), door.middle());
        let (x, y) = (real(middle.x), real(middle.y));
        // The joint is at 0 where the leaf begins.
        let (slid, least, most) =
            if door.opens == DoorOpens::Always { (length, -length, 0.0) } else { (0.0, 0.0, length) };
        let (slid, least, most, height) = (real(slid), real(least), real(most), real(DOOR_M / 2.0));
        let (yaw, size) = (real(yaw), format!("{} {} {}", real(length), real(LEAF_M), real(DOOR_M)));
        let kind = match door.kind {
            DoorKind::Room => "door",
            DoorKind::Elevator => "elevator_door",
        };
        self.add(format_args!(
            r#"    <model name="{kind}_{name}">
      <pose>{x} {y} 0.0 0.0 0.0 {yaw}</pose>
      <link name="leaf">
        <pose>{slid} 0.0 {height} 0.0 0.0 0.0</pose>
        <gravity>false</gravity>
        <collision name="leaf">
          <geometry><box><size>{size}</size></box></geometry>
          <surface><contact><collide_bitmask>2</collide_bitmask></contact></surface>
        </collision>
        <visual name="leaf_visual">
          <geometry><box><size>{size}</size></box></geometry>
        </visual>
      </link>
      <joint name="slide" type="prismatic">
        <parent>world</parent>
        <child>leaf</child>
        <axis>
          <xyz>1 0 0</xyz>
          <limit><lower>{least}</lower><upper>{most}</upper></limit>
        </axis>
      </joint>
    </model>
"#
        ));
        if door.kind == DoorKind::Elevator
            && let Some(node) = door.inside.first().and_then(|id| scenario.location.graph.node(id))
        {
            let (x, y, z) = (real(node.at.x), real(node.at.y), real(LAMP_M));
            self.add(format_args!(
                r#"    <light name="elevator_lamp_{name}" type="point">
      <pose>{x} {y} {z} 0.0 0.0 0.0</pose>
      <diffuse>0.6 0.6 0.5 1.0</diffuse>
      <specular>0.1 0.1 0.1 1.0</specular>
      <direction>0 0 -1</direction>
      <attenuation><range>4.0</range><constant>0.5</constant><linear>0.1</linear><quadratic>0.01</quadratic></attenuation>
    </light>
"#
            ));
        }
    }

    /// Somebody who replays the run.
    fn actor(&mut self, name: &str, poses: &[Waypoint]) {
        if poses.is_empty() {
            return;
        }
        // One Gazebo takes poses of a script in the world, another in the actor's own frame: here both are the same.
        self.add(format_args!(
            r#"    <actor name="{name}">
      <pose>0.0 0.0 0.0 0.0 0.0 0.0</pose>
      <skin><filename>walk.dae</filename><scale>1.0</scale></skin>
      <animation name="walking"><filename>walk.dae</filename><scale>1.0</scale><interpolate_x>true</interpolate_x></animation>
      <script>
        <loop>false</loop>
        <delay_start>0.0</delay_start>
        <auto_start>true</auto_start>
        <trajectory id="0" type="walking">
"#
        ));
        for pose in poses {
            self.add(format_args!(
                "          <waypoint><time>{}</time><pose>{} {} 0.0 0.0 0.0 {}</pose></waypoint>\n",
                real(pose.time_s),
                real(pose.x),
                real(pose.y),
                real(pose.yaw)
            ));
        }
        self.text.push_str("        </trajectory>\n      </script>\n    </actor>\n");
    }
}
