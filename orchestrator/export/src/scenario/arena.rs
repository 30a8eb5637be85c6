//! Worlds and scenarios of Arena 3 (ROS 1) and of Arena 4 and 5 (ROS 2).
//!
//! Arena 3 reads `worlds/NAME/map` and `worlds/NAME/scenarios/NAME.json`; the third number of a way point is a heading. The later ones
//! read `worlds/NAME/world.yaml` and `worlds/NAME/scenarios/NAME/scenario.yaml`; there the third number of a way point is a height, so
//! way points have two, and a pose has three reals. Unknown keys are passed over in silence.

use std::fmt::Write as _;

use serde_json::{Value, json};
use socrates_model::{AgentId, Cell, DoorKind, Point};

use super::content::{Content, WORDS};
use super::frames::{file_name, plain_name, point, real};
use super::outline::sides;
use super::routes::{self, SIMULATED, Walker};
use super::{File, Files, Foreign, Format, Scenario, map_files};
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;
use crate::outline::placed;

const ROBOT: &str = "the robot is yours; its start and its goal stand in the scenario";
const NO_WAITS: &str = "people walk from way point to way point without a stop";
const LOOPS: &str = "people walk their way points again and again; those of the scenario walk them once";
const MODEL: &str = "people are of a model of Arena, which has its own body";

/// What every version lacks.
macro_rules! lacks {
    ($($more:expr),*) => {
        &[
            (Content::RobotTrack, ROBOT),
            (Content::Velocities, SIMULATED),
            (Content::Gestures, SIMULATED),
            (Content::Leaves, SIMULATED),
            (Content::Events, SIMULATED),
            (Content::Radii, MODEL),
            (Content::Roles, WORDS),
            (Content::Groups, WORDS),
            (Content::DoorRules, "the format has no rules for doors"),
            (Content::Graph, WORDS),
            (Content::AreaNames, WORDS),
            (Content::Encounters, "nobody waits for anybody"),
            (Content::Trees, WORDS),
            (Content::Clauses, WORDS),
            $($more),*
        ]
    };
}

pub(super) const ARENA_3: Format = Format {
    name: "arena-3",
    stem: "arena",
    about: "world (map of Flatland) and scenario of Arena 3: people with way points, the robot with start and goal",
    foreign: Foreign::Neither,
    checked_by: "no reader in a package index; our test holds the keys and types of scenarios that Arena ships",
    needs_run: false,
    feature: None,
    lacks: lacks![
        (Content::Speeds, "people of the format have no pace"),
        (Content::Doors, "the format has no doors: they stand open"),
        (Content::Texts, WORDS)
    ],
    write: write_3,
};

pub(super) const ARENA_5: Format = Format {
    name: "arena-5",
    stem: "arena",
    about: "world (walls and doors) and scenario of Arena 4 and 5: people with way points and paces, the robot with start and goal",
    checked_by: "no reader in a package index; our test holds the keys and types that its classes name",
    lacks: lacks![],
    write: write_5,
    ..ARENA_3
};

/// People with what both versions leave behind of them, and the robot.
fn everybody(scenario: &Scenario, losses: &mut Losses) -> Result<(Option<Walker>, Vec<Walker>), Unusable> {
    let (robots, people): (Vec<Walker>, Vec<Walker>) =
        routes::walkers(scenario)?.into_iter().partition(|walker| walker.agent == AgentId::Robot);
    scenario.note_people(Content::PeopleTracks, "ways of people tick by tick", SIMULATED, losses);
    for walker in &people {
        walker.note_waits(NO_WAITS, losses);
        walker.note_absence(losses);
        losses.note("ends of ways", walker.place(), LOOPS);
    }
    if scenario.paths.robot.len() > 2 {
        losses.note("nodes of the robot's path", "paths.json robot", ROBOT);
    }
    Ok((robots.into_iter().next(), people))
}

/// A pose with a heading.
fn pose(at: &Point, yaw: f64) -> [f64; 3] {
    [micro(at.x), micro(at.y), micro(yaw)]
}

/// The heading with which a walker arrives, rad.
fn arrival(walker: &Walker) -> f64 {
    let end = walker.end();
    let before = walker.legs.iter().rev().nth(1).map_or_else(|| walker.start.point(), |leg| leg.at);
    let along = end - before;
    if along.norm() > 0.0 { libm::atan2(along.y, along.x) } else { walker.start.yaw }
}

fn write_3(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let (robot, people) = everybody(scenario, losses)?;
    let robots: Vec<Value> = robot
        .iter()
        .map(|robot| json!({"start": pose(&robot.start.point(), robot.start.yaw), "goal": pose(&robot.end(), arrival(robot))}))
        .collect();
    let dynamic: Vec<Value> = people
        .iter()
        .map(|walker| {
            let mut waypoints = vec![pose(&walker.start.point(), 0.0)];
            waypoints.extend(walker.legs.iter().map(|leg| pose(&leg.at, 0.0)));
            json!({
                "name": walker.agent.to_string(),
                "pos": pose(&walker.start.point(), walker.start.yaw),
                "type": "adult",
                "model": "actor1",
                "waypoints": waypoints,
                "waypoint_mode": 0,
            })
        })
        .collect();
    let value = json!({
        "map": name,
        "resets": 1,
        "robots": robots,
        "obstacles": {"static": [], "interactive": [], "dynamic": dynamic},
    });
    let world = "properties:\n  velocity_iterations: 10\n  position_iterations: 10\nlayers:\n- name: static\n  map: map.yaml\n  color: [0.4, 0.4, 0.4, 1.0]\n";
    let folder = format!("worlds/{name}");
    let mut files = Files::from([
        (format!("{folder}/scenarios/{name}.json"), File::Text(format!("{value:#}\n"))),
        (format!("{folder}/map/map.world.yaml"), File::Text(world.to_owned())),
    ]);
    map_files::add(&mut files, &format!("{folder}/map"), &scenario.location.grid);
    Ok(files)
}

fn write_5(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let (robot, people) = everybody(scenario, losses)?;
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        // Writing to a String cannot fail.
        let (Ok(()) | Err(std::fmt::Error)) = text.write_fmt(arguments);
    };
    let triple = |at: &Point, yaw: f64| format!("[{}, {}, {}]", real(at.x), real(at.y), real(yaw));
    match &robot {
        Some(robot) => {
            let (start, goal) = (triple(&robot.start.point(), robot.start.yaw), triple(&robot.end(), arrival(robot)));
            line(format_args!("robots:\n- start: {start}\n  goal: {goal}\n"));
        }
        None => line(format_args!("robots: []\n")),
    }
    let none = if people.is_empty() { " []" } else { "" };
    line(format_args!("obstacles:\n  static: []\n  interactive: []\n  dynamic:{none}\n"));
    for walker in &people {
        line(format_args!(
            "  - name: {}\n    model: actor1\n    pose: {}\n    velocity: {}\n    waypoints:\n    - [{}, {}]\n",
            walker.agent,
            triple(&walker.start.point(), walker.start.yaw),
            real(walker.speed_mps),
            real(walker.start.x),
            real(walker.start.y)
        ));
        for leg in &walker.legs {
            line(format_args!("    - [{}, {}]\n", real(leg.at.x), real(leg.at.y)));
        }
    }
    let folder = format!("worlds/{name}");
    let mut files = Files::from([
        (format!("{folder}/scenarios/{name}/scenario.yaml"), File::Text(text)),
        (format!("{folder}/world.yaml"), File::Text(world_5(scenario, losses))),
    ]);
    map_files::add(&mut files, &format!("{folder}/map"), &scenario.location.grid);
    Ok(files)
}

/// Walls and doors of the location as one zone; what the scenario is about stands in its description.
fn world_5(scenario: &Scenario, losses: &mut Losses) -> String {
    let location = &scenario.location;
    let grid = &location.grid;
    let pair = |at: Point| format!("[{}, {}]", real(at.x), real(at.y));
    let corners =
        [(0, grid.height), (grid.width, grid.height), (grid.width, 0), (0, 0)].map(|corner| pair(placed(grid, corner)));
    let mut text = format!(
        "zones:\n- name: {}\n  description: {}\n  corners: [{}]\n",
        plain_name(&location.name),
        scenario.texts(),
        corners.join(", ")
    );
    let wall = |[from, to]: [Point; 2]| format!("  - {{start: {}, end: {}}}\n", point(from), point(to));
    let walls: String =
        sides(grid, |column, row| grid.at(column, row) == Cell::Occupied).into_iter().map(wall).collect();
    text.push_str(&if walls.is_empty() { "  walls: []\n".to_owned() } else { format!("  walls:\n{walls}") });
    text.push_str(if location.doors.is_empty() { "  doors: []\n" } else { "  doors:\n" });
    for door in &location.doors {
        let (name, from, to) = (plain_name(&door.id), point(door.from), point(door.to));
        text.push_str(&format!("  - {{name: {name}, start: {from}, end: {to}, kind: sliding, height: 2.0}}\n"));
        if door.kind == DoorKind::Elevator {
            let at = format!("location.json door `{}`", door.id);
            losses.note(
                "elevator machinery",
                at,
                "the landing door is written as a door; no version reads cars everywhere",
            );
        }
    }
    text.push_str("  entities: {static: [], dynamic: []}\n");
    text
}
