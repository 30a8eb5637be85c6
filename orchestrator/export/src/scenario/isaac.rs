//! People of Isaac Sim, by generation: command files of `omni.anim.people` up to 5.1, configurations of its Replicator Agent since 6.0.
//!
//! Each package has the stage without people, which Isaac adds. No schema of the configurations can be had: keys are those of the
//! published guides. Headings are in degrees, `_` is any heading.

use socrates_model::{AgentId, Point};

use super::content::{Content, WORDS};
use super::frames::{file_name, real};
use super::routes::{self, SIMULATED, Walker};
use super::usd::stage;
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Folder of characters among the assets of Isaac.
const CHARACTERS: &str = "Isaac/People/Characters/";
/// Frames a second of Isaac's simulation up to 5.1.
const FPS: f64 = 30.0;
/// Length where no run tells it, s.
const ALONE_S: f64 = 120.0;

const MODEL: &str = "people are characters of Isaac, which have their own bodies";

/// What every generation lacks.
macro_rules! lacks {
    ($($more:expr),*) => {
        &[
            (Content::RobotTrack, "the robot is yours; its start and way points stand in robot.yaml"),
            (Content::Headings, SIMULATED),
            (Content::Velocities, SIMULATED),
            (Content::Gestures, SIMULATED),
            (Content::Leaves, SIMULATED),
            (Content::Events, SIMULATED),
            (Content::Radii, MODEL),
            (Content::Roles, WORDS),
            (Content::Groups, WORDS),
            (Content::Graph, WORDS),
            (Content::AreaNames, WORDS),
            (Content::Encounters, "nobody waits for anybody"),
            (Content::Trees, "its behavior trees are an experiment of each release"),
            (Content::Clauses, WORDS),
            (Content::Texts, WORDS),
            $($more),*
        ]
    };
}

const CHECKED: &str =
    "no schema of its files can be had; our test holds their keys, and the stage is that of `usda-1.0`";

pub(super) const PEOPLE_5_1: Format = Format {
    name: "isaac-people-5.1",
    stem: "isaac-people",
    about: "Isaac Sim 4.5 to 5.1: stage, command file of people (ways and waits), configuration of Replicator Agent 0.7",
    foreign: Foreign::Neither,
    checked_by: CHECKED,
    needs_run: false,
    feature: None,
    lacks: lacks![(Content::Speeds, "people of the format have no pace")],
    write: write_commands,
};

pub(super) const PEOPLE_6_0: Format = Format {
    name: "isaac-people-6.0",
    stem: "isaac-people",
    about: "Isaac Sim 6.0: stage and configuration of Replicator Agent 1.6.0, a group of one for each person (ways and paces)",
    lacks: lacks![],
    write: |scenario, losses| write_groups(scenario, losses, "1.6.0"),
    ..PEOPLE_5_1
};

pub(super) const PEOPLE_6_1: Format = Format {
    name: "isaac-people-6.1",
    stem: "isaac-people",
    about: "Isaac Sim 6.1: stage and configuration of Replicator Agent 1.7.0, a group of one for each person (ways and paces)",
    lacks: lacks![],
    write: |scenario, losses| write_groups(scenario, losses, "1.7.0"),
    ..PEOPLE_5_1
};

/// People with what every generation leaves behind of them.
fn people(scenario: &Scenario, losses: &mut Losses) -> Result<Vec<Walker>, Unusable> {
    scenario.note_people(Content::PeopleTracks, "ways of people tick by tick", SIMULATED, losses);
    let why = "Isaac bakes it from the stage: Window > Navigation > NavMesh, add a volume over the floor, and Bake";
    losses.note("mesh for navigation", "location.json grid", why);
    let people = routes::walkers(scenario)?;
    let people: Vec<Walker> = people.into_iter().filter(|walker| walker.agent != AgentId::Robot).collect();
    for walker in &people {
        let why = "Isaac puts characters anywhere on its mesh; they go to their start first";
        losses.note("starts of people", walker.place(), why);
        walker.note_absence(losses);
    }
    Ok(people)
}

fn length_s(scenario: &Scenario) -> f64 {
    let length_s = routes::length_s(scenario);
    if length_s > 0.0 { length_s } else { ALONE_S }
}

/// Stage and way of the robot, which all generations share.
fn shared(scenario: &Scenario, name: &str, losses: &mut Losses) -> Result<Files, Unusable> {
    Ok(Files::from([
        (format!("{name}.usda"), File::Text(stage(scenario, false, losses)?)),
        ("robot.yaml".to_owned(), File::Text(super::sdf::robot_yaml(scenario))),
    ]))
}

fn write_commands(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let people = people(scenario, losses)?;
    let mut commands = String::new();
    for (place, walker) in people.iter().enumerate() {
        let character = if place == 0 { "Character".to_owned() } else { format!("Character_{place:02}") };
        let go = |at: Point| format!("{character} GoTo {} {} 0.0 _\n", real(at.x), real(at.y));
        commands.push_str(&go(walker.start.point()));
        for leg in &walker.legs {
            commands.push_str(&go(leg.at));
            if leg.wait_s > 0.0 {
                commands.push_str(&format!("{character} Idle {}\n", real(leg.wait_s)));
            }
        }
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a run is never so long")]
    let frames = (length_s(scenario) * FPS).ceil() as u64;
    let config = format!(
        "isaacsim.replicator.agent:\n  version: 0.7.0\n  global:\n    seed: 1\n    simulation_length: {frames}\n  scene:\n    \
         asset_path: {name}.usda\n  character:\n    asset_path: {CHARACTERS}\n    command_file: commands.txt\n    num: {}\n",
        people.len()
    );
    let mut files = shared(scenario, &name, losses)?;
    files.insert("commands.txt".to_owned(), File::Text(commands));
    files.insert(format!("{name}_agents.yaml"), File::Text(config));
    Ok(files)
}

fn write_groups(scenario: &Scenario, losses: &mut Losses, version: &str) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let people = people(scenario, losses)?;
    let mut config = format!(
        "isaacsim.replicator.agent:\n  version: {version}\n  seed: 1\n  simulation_duration: {}\n  environment:\n    \
         base_stage_asset_path: {name}.usda\n  character:\n    root_prim_path: /World/Characters\n    groups:{}\n",
        real(length_s(scenario)),
        if people.is_empty() { " {}" } else { "" }
    );
    for walker in &people {
        walker.note_waits("a patrol has points without waits", losses);
        let pace = real(walker.speed_mps);
        config.push_str(&format!(
            "      {}:\n        asset_path: {CHARACTERS}\n        num: 1\n        routines:\n        - patrol:\n            weight: 1.0\n            \
             repeat: 1\n            speed_range: [{pace}, {pace}]\n            path_points:\n            - [{}, {}, 0.0]\n",
            walker.agent,
            real(walker.start.x),
            real(walker.start.y)
        ));
        for leg in &walker.legs {
            config.push_str(&format!("            - [{}, {}, 0.0]\n", real(leg.at.x), real(leg.at.y)));
        }
    }
    let mut files = shared(scenario, &name, losses)?;
    files.insert(format!("{name}_agents.yaml"), File::Text(config));
    Ok(files)
}
