//! Scenarios of Arena HumanSim: walls, people with goals, and the robot, as its loader of 2026 reads them.
//!
//! The keys move with the program, which has no releases; what is written here are those that its own scenarios of commit 4160eb8 have.
//! Unknown keys are passed over in silence.

use socrates_model::{AgentId, Cell};

use super::content::{Content, NEVER_SEEN, WORDS};
use super::frames::{file_name, number, point, real};
use super::outline::sides;
use super::routes::{self, SIMULATED, Walker};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::Unusable;
use crate::not_carried::Losses;

/// Step of its simulation, s.
const STEP_S: f64 = 0.05;
/// Steps where no run tells how many there are; none is without end.
const ENDLESS: u64 = 0;

const OPEN: &str = "the format has no doors: they stand open";

pub(super) const FORMAT: Format = Format {
    name: "humansim-4160eb8",
    stem: "humansim",
    about: "scenario of Arena HumanSim: walls, people with start, goals, pace and radius, and the robot",
    foreign: Foreign::Neither,
    checked_by: "no reader in a package index; our test holds the keys and types of its own scenarios",
    needs_run: false,
    feature: None,
    lacks: &[
        (Content::RobotTrack, "the robot is simulated anew on its path"),
        (Content::Velocities, SIMULATED),
        (Content::Gestures, SIMULATED),
        (Content::Leaves, SIMULATED),
        (Content::Events, SIMULATED),
        (Content::Roles, "every person is of the type `adult`"),
        (Content::Groups, "talks of groups are actions of the format, and groups here only stand or walk together"),
        (Content::UnknownCells, NEVER_SEEN),
        (Content::Doors, OPEN),
        (Content::DoorRules, OPEN),
        (Content::Graph, WORDS),
        (Content::AreaNames, WORDS),
        (Content::Encounters, "nobody waits for anybody"),
        (Content::Trees, "its trees have other nodes; everybody walks to their goals"),
        (Content::Clauses, WORDS),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let walkers = routes::walkers(scenario)?;
    scenario.note_people(Content::PeopleTracks, "ways of people tick by tick", SIMULATED, losses);
    let length_s = routes::length_s(scenario);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a run is never so long")]
    let steps = if length_s > 0.0 { (length_s / STEP_S).ceil() as u64 } else { ENDLESS };
    let mut text = format!(
        "name: {name}\ndescription: {}\nsimulation:\n  seed: 1\n  dt: {}\n  bt_tick_interval: 5\n  max_ticks: {steps}\n  execution_mode: master\n",
        scenario.texts(),
        real(STEP_S)
    );
    text.push_str(&walls(scenario));
    text.push_str(if walkers.is_empty() { "agents: []\n" } else { "agents:\n" });
    for walker in &walkers {
        agent(&mut text, walker);
        walker.note_waits("people walk from goal to goal without a stop", losses);
        walker.note_absence(losses);
    }
    text.push_str("interaction_scripts: []\n");
    Ok(Files::from([(format!("{name}.yaml"), File::Text(text))]))
}

/// Somebody: the robot has the id -1, as in its own scenarios.
fn agent(text: &mut String, walker: &Walker) {
    let id = match walker.agent {
        AgentId::Robot => "-1\n    kind: 1\n    policy: straight\n    agent_type: robot".to_owned(),
        AgentId::Human(_) => format!("{}\n    agent_type: adult", number(walker.agent)),
    };
    let start = &walker.start;
    let goals: Vec<String> = walker.legs.iter().map(|leg| point(leg.at)).collect();
    text.push_str(&format!(
        "  - agent_id: {id}\n    spawn_pose: {{x: {}, y: {}, theta: {}}}\n    desired_velocity: {}\n    agent_radius: {}\n    goal_sequence: [{}]\n",
        real(start.x),
        real(start.y),
        real(start.yaw),
        real(walker.speed_mps),
        real(walker.radius_m),
        goals.join(", ")
    ));
}

/// Outlines of what is no floor.
fn walls(scenario: &Scenario) -> String {
    let grid = &scenario.location.grid;
    let sides = sides(grid, |column, row| grid.at(column, row) != Cell::Free);
    let rows: String = sides
        .iter()
        .enumerate()
        .map(|(count, side)| {
            let [from, to] = side.map(point);
            format!("  - {{name: wall_{count}, start: {from}, end: {to}}}\n")
        })
        .collect();
    if rows.is_empty() { "walls: []\n".to_owned() } else { format!("walls:\n{rows}") }
}
