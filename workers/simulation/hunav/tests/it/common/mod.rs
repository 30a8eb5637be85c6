//! Agents and places for tests.

use std::fmt::Write as _;
use std::path::PathBuf;

use socrates_hunav::{AgentsFile, Problem};
use socrates_model::Grid;

/// A folder of the reference data; `None` where it is not there, and the running test is left out.
#[track_caller]
pub(crate) fn data(folder: &str) -> Option<PathBuf> {
    socrates_tests::skip::shared(&format!("socrates_hunav/{folder}"))
}

/// A folder of agents files and trees of our own.
pub(crate) fn own(folder: &str) -> PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder)
}

/// Reads an agents file, or shows its problems.
pub(crate) fn read(text: &str) -> AgentsFile {
    AgentsFile::read(text, "agents.yaml").unwrap_or_else(|problems| panic!("{}", shown(&problems)))
}

/// Problems, one a line.
pub(crate) fn shown(problems: &[Problem]) -> String {
    problems.iter().map(|problem| format!("{problem}\n")).collect()
}

/// A free floor with its lower left corner at (-20, -20).
pub(crate) fn hall() -> Grid {
    let (width, height) = (400, 400);
    Grid {
        width,
        height,
        resolution_m: 0.1,
        origin: socrates_model::Pose::new(-20.0, -20.0, 0.0),
        cells: vec![socrates_model::Cell::Free; width * height],
    }
}

/// The same with a wall from (x, low) to (x, high), two cells thick.
pub(crate) fn hall_with_wall(x: f64, low: f64, high: f64) -> Grid {
    let mut grid = hall();
    for row in 0..grid.height {
        for column in 0..grid.width {
            let at = grid.center_of(column, row);
            if (at.x - x).abs() < 0.11 && at.y > low && at.y < high {
                grid.cells[row * grid.width + column] = socrates_model::Cell::Occupied;
            }
        }
    }
    grid
}

/// One agent for [`file_1_0`] and [`file_1_1`].
#[derive(Clone)]
pub(crate) struct Walker {
    pub(crate) id: i64,
    pub(crate) behavior: String,
    pub(crate) start: (f64, f64, f64),
    pub(crate) goals: Vec<(f64, f64)>,
    pub(crate) group: i64,
    pub(crate) speed: f64,
    pub(crate) cyclic: bool,
}

impl Walker {
    pub(crate) fn new(id: i64, behavior: &str, start: (f64, f64, f64), goals: &[(f64, f64)]) -> Self {
        Self { id, behavior: behavior.to_owned(), start, goals: goals.to_vec(), group: -1, speed: 1.5, cyclic: true }
    }
}

/// An agents file of the dialects 1.0 (a code as behavior) and 1.1 (a section as behavior).
pub(crate) fn file(walkers: &[Walker]) -> String {
    let mut out =
        String::from("hunav_loader:\n  ros__parameters:\n    map: hall\n    publish_people: true\n    agents:\n");
    for walker in walkers {
        writeln!(out, "      - agent{}", walker.id).unwrap();
    }
    for walker in walkers {
        let (x, y, h) = walker.start;
        writeln!(out, "    agent{}:\n      id: {}\n      skin: 0", walker.id, walker.id).unwrap();
        writeln!(out, "      group_id: {}\n      max_vel: {:?}\n      radius: 0.4", walker.group, walker.speed)
            .unwrap();
        writeln!(out, "      behavior:{}", walker.behavior).unwrap();
        writeln!(out, "      init_pose:\n        x: {x:?}\n        y: {y:?}\n        z: 1.25\n        h: {h:?}")
            .unwrap();
        writeln!(out, "      goal_radius: 0.3\n      cyclic_goals: {}\n      goals:", walker.cyclic).unwrap();
        for number in 0..walker.goals.len() {
            writeln!(out, "        - g{number}").unwrap();
        }
        for (number, (x, y)) in walker.goals.iter().enumerate() {
            writeln!(out, "      g{number}:\n        x: {x:?}\n        y: {y:?}\n        h: 1.25").unwrap();
        }
    }
    out
}

/// The behavior section of 1.1.
pub(crate) fn section(kind: u8, configuration: u8) -> String {
    format!(
        "\n        type: {kind}\n        configuration: {configuration}\n        duration: 40.0\n        once: true\n        \
         vel: 0.6\n        dist: 3.0\n        goal_force_factor: 2.0\n        obstacle_force_factor: 10.0\n        \
         social_force_factor: 5.0\n        other_force_factor: 20.0"
    )
}
