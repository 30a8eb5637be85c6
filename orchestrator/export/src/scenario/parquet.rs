//! Tracks as tables of Parquet: a row for each tick of everybody who is there, and a row for each agent.
//!
//! Here the columns are made; the shell writes them.

use socrates_model::AgentId;

use super::content::{Content, WORDS};
use super::frames::{angle, file_name, samples};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// The values of a column, a row each; `None` where a row has no value.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Whole numbers.
    Whole(Vec<Option<i64>>),
    /// Reals.
    Real(Vec<Option<f64>>),
    /// Text.
    Text(Vec<Option<String>>),
}

impl Cells {
    /// How many rows it has.
    #[must_use]
    pub const fn rows(&self) -> usize {
        match self {
            Self::Whole(values) => values.len(),
            Self::Real(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }
}

/// A table by its columns, which have the same number of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Name of the table.
    pub name: &'static str,
    /// Names and values in order.
    pub columns: Vec<(&'static str, Cells)>,
}

const FLOOR: &str = "tables have no map; `location` of the bundle has it";

pub(super) const FORMAT: Format = Format {
    name: "parquet",
    stem: "parquet",
    about: "tables of Parquet: a row for each agent and tick with place, heading, velocities, gesture and leaf; a row for each agent",
    foreign: Foreign::Parsed,
    checked_by: "PyPI `pyarrow` 26.0.1; written by a program with the feature `parquet`",
    needs_run: true,
    feature: Some("parquet"),
    lacks: &[
        (Content::Events, "tables have states alone"),
        (Content::Walls, FLOOR),
        (Content::UnknownCells, FLOOR),
        (Content::Doors, FLOOR),
        (Content::DoorRules, FLOOR),
        (Content::Graph, FLOOR),
        (Content::AreaNames, FLOOR),
        (Content::Paths, WORDS),
        (Content::Encounters, WORDS),
        (Content::Trees, WORDS),
        (Content::Clauses, WORDS),
        (Content::Texts, WORDS),
    ],
    write,
};

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let Some(run) = &scenario.recording else { return Ok(Files::new()) };
    let samples = samples(run, 1)?;
    let rows = || samples.iter().flat_map(|sample| sample.states.iter().map(move |state| (sample, *state)));
    let real = |value: fn(&socrates_model::AgentState) -> f64| {
        Cells::Real(rows().map(|(_, state)| Some(micro(value(state)))).collect())
    };
    let leaf = |state: &socrates_model::AgentState| {
        run.header.leaves.get(usize::from(state.leaf())).filter(|leaf| !leaf.is_empty()).cloned()
    };
    let tracks = Columns {
        name: "tracks",
        columns: vec![
            ("tick", Cells::Whole(rows().map(|(sample, _)| i64::try_from(sample.number).ok()).collect())),
            ("t_s", Cells::Real(rows().map(|(sample, _)| Some(sample.time.secs())).collect())),
            ("agent", Cells::Whole(rows().map(|(_, state)| Some(i64::from(state.agent))).collect())),
            ("x_m", real(|state| state.x)),
            ("y_m", real(|state| state.y)),
            ("yaw_rad", real(|state| angle(state.yaw))),
            ("vx_mps", real(|state| state.vx)),
            ("vy_mps", real(|state| state.vy)),
            ("omega_radps", real(|state| state.omega)),
            ("gesture", Cells::Text(rows().map(|(_, state)| state.gesture().map(|one| one.to_string())).collect())),
            ("leaf", Cells::Text(rows().map(|(_, state)| leaf(state)).collect())),
        ],
    };
    let agents = &run.header.agents;
    let human = |agent: AgentId| scenario.proposal.humans.iter().find(|human| AgentId::Human(human.id) == agent);
    let role = |agent: AgentId| human(agent).map(|human| human.role.clone()).filter(|role| !role.is_empty());
    let group = |agent: AgentId| human(agent).and_then(|human| human.group).map(|group| i64::from(group.0));
    let agents = Columns {
        name: "agents",
        columns: vec![
            ("agent", Cells::Whole(agents.iter().map(|info| Some(i64::from(info.agent.number()))).collect())),
            ("name", Cells::Text(agents.iter().map(|info| Some(info.agent.to_string())).collect())),
            ("role", Cells::Text(agents.iter().map(|info| role(info.agent)).collect())),
            ("group", Cells::Whole(agents.iter().map(|info| group(info.agent)).collect())),
            ("radius_m", Cells::Real(agents.iter().map(|info| Some(micro(info.radius_m))).collect())),
            ("speed_mps", Cells::Real(agents.iter().map(|info| Some(micro(info.speed_mps))).collect())),
        ],
    };
    let name = file_name(&scenario.name, losses);
    Ok(Files::from([
        (format!("{name}_tracks.parquet"), File::Columns(tracks)),
        (format!("{name}_agents.parquet"), File::Columns(agents)),
    ]))
}
