//! A scenario of `jupedsim-scenarios` 0.7: floor, people with their ways and waits, and a program that runs it in JuPedSim.
//!
//! Facts are those of the released reader: a start area begins with `jps-distributions_`, or the first part of the way is skipped; the
//! ways of people stand in `journeys_v2`; misspelt keys and unknown stages are passed over in silence; a start area in which nobody has
//! room drops its person. So every place is moved to where there is room, and noted.

use serde_json::{Map, Value, json};
use socrates_model::{AgentId, Grid, Point};

use super::content::{Content, NEVER_SEEN, WORDS};
use super::frames::file_name;
use super::outline::{Floor, walkable};
use super::routes::{self, Leg, SIMULATED, Walker};
use super::{File, Files, Foreign, Format, Scenario};
use crate::graph::{Unusable, micro};
use crate::not_carried::Losses;

/// Sides of an area around a place.
const SIDES: u8 = 8;
/// Farthest that somebody is put from their start, m.
const START_M: f64 = 0.05;
/// Half the width of an area that people walk through, m: at 2 m/s they are in it for the 0.2 s that the reader wants.
const PASS_M: f64 = 0.4;
/// Half the width of an area in which somebody waits, m: the reader places them 0.25 m within it.
const WAIT_M: f64 = 0.35;
/// Half the width of an exit, m: whoever touches it is gone.
const EXIT_M: f64 = 0.1;
/// How long a person is tried to be put on a start that is taken, s.
const TRIED_S: f64 = 10.0;
/// How much longer than the run the simulation may take, s.
const LONGER_S: f64 = 180.0;
/// Longest simulation where no run tells how long it takes, s.
const ALONE_S: f64 = 600.0;

const OPEN: &str = "the floor of the format never changes: doors stand open";

pub(super) const FORMAT: Format = Format {
    name: "jupedsim-scenarios-0.7",
    stem: "jupedsim-scenarios",
    about: "scenario of JuPedSim (`config.json`, floor as WKT) with a program that runs it: starts, times, ways, waits and paces; the robot walks as a pedestrian",
    foreign: Foreign::Run,
    checked_by: "PyPI `jupedsim-scenarios` 0.7.4 on `jupedsim` 1.4.2: everybody begins, waits and ends where the scenario says",
    needs_run: false,
    feature: None,
    lacks: &[
        (Content::RobotTrack, "the robot is a pedestrian who walks its path"),
        (Content::Headings, SIMULATED),
        (Content::Velocities, SIMULATED),
        (Content::Gestures, SIMULATED),
        (Content::Leaves, SIMULATED),
        (Content::Events, SIMULATED),
        (Content::Roles, WORDS),
        (Content::Groups, WORDS),
        (Content::UnknownCells, NEVER_SEEN),
        (Content::Doors, OPEN),
        (Content::DoorRules, OPEN),
        (Content::Graph, WORDS),
        (Content::AreaNames, WORDS),
        (Content::Encounters, "nobody waits for anybody; waits are those of the run"),
        (Content::Trees, WORDS),
        (Content::Clauses, WORDS),
        (Content::Texts, WORDS),
    ],
    write,
};

/// The program that runs the scenario and says what everybody did.
const RUN: &str = include_str!("run.py");

fn write(scenario: &Scenario, losses: &mut Losses) -> Result<Files, Unusable> {
    let name = file_name(&scenario.name, losses);
    let floor = walkable(&scenario.location.grid, losses)?;
    let mut config = Config::new(&scenario.location.grid, &floor);
    for walker in &routes::walkers(scenario)? {
        config.add(walker, losses)?;
    }
    scenario.note_people(Content::PeopleTracks, "ways of people tick by tick", SIMULATED, losses);
    let length_s = routes::length_s(scenario);
    let longest_s = if length_s > 0.0 { length_s + LONGER_S } else { ALONE_S };
    let value = config.value(&name, longest_s);
    Ok(Files::from([
        ("run.py".to_owned(), File::Text(RUN.to_owned())),
        ("scenario/config.json".to_owned(), File::Text(format!("{value:#}\n"))),
        ("scenario/geometry.wkt".to_owned(), File::Text(format!("{}\n", floor.polygon()))),
    ]))
}

/// The configuration as it grows.
struct Config<'a> {
    grid: &'a Grid,
    floor: &'a Floor,
    starts: Map<String, Value>,
    stops: Map<String, Value>,
    exits: Map<String, Value>,
    journeys: Vec<Value>,
}

impl<'a> Config<'a> {
    fn new(grid: &'a Grid, floor: &'a Floor) -> Self {
        Self { grid, floor, starts: Map::new(), stops: Map::new(), exits: Map::new(), journeys: Vec::new() }
    }

    fn value(self, name: &str, longest_s: f64) -> Value {
        let parameters = json!({"model_type": "CollisionFreeSpeedModel", "max_simulation_time": micro(longest_s)});
        json!({
            "name": name,
            "config": {"simulation_settings": {"baseSeed": 1, "simulationParams": parameters}},
            "distributions": self.starts,
            "checkpoints": self.stops,
            "exits": self.exits,
            "journeys_v2": self.journeys,
        })
    }

    fn add(&mut self, walker: &Walker, losses: &mut Losses) -> Result<(), Unusable> {
        let number = self.journeys.len();
        let agent = walker.agent;
        let (start, room_m) = self.place(&walker.start.point(), across(walker.radius_m + START_M), losses, agent)?;
        let radius_m = micro(walker.radius_m.min(room_m / across(1.0) - START_M).max(START_M));
        if radius_m < walker.radius_m {
            losses.note(
                "radii beside walls",
                format!("recording: radius of {agent}"),
                "the body is as large as its start has room for",
            );
        }
        let mut parameters = Map::from_iter([
            ("number".to_owned(), json!(1)),
            ("radius".to_owned(), json!(radius_m)),
            ("v0".to_owned(), json!(walker.speed_mps)),
            ("distribution_mode".to_owned(), json!("by_number")),
        ]);
        if walker.from_s > 0.0 {
            parameters.insert("use_flow_spawning".to_owned(), json!(true));
            parameters.insert("flow_start_time".to_owned(), json!(walker.from_s));
            parameters.insert("flow_end_time".to_owned(), json!(micro(walker.from_s + TRIED_S)));
        }
        let journey = format!("journey_{number}");
        self.starts.insert(
            format!("jps-distributions_{number}"),
            json!({
                "name": agent.to_string(),
                "type": "polygon",
                "coordinates": area(&start, radius_m + START_M),
                "parameters": parameters,
                "journey_weights": [{"journey_id": journey, "weight": 100}],
            }),
        );
        let mut sequence = Vec::new();
        for (place, leg) in walker.legs.iter().enumerate() {
            // The exit stands for the last part, unless somebody waits there first.
            if leg.wait_s > 0.0 || place + 1 < walker.legs.len() {
                sequence.push(self.stop(leg, agent, losses)?);
            }
        }
        let exit = format!("jps-exits_{number}");
        let (end, _) = self.place(&walker.end(), EXIT_M, losses, agent)?;
        self.exits.insert(exit.clone(), json!({"type": "polygon", "coordinates": area(&end, EXIT_M)}));
        sequence.push(exit);
        self.journeys.push(json!({"id": journey, "sequence": sequence}));
        Ok(())
    }

    /// Adds a place on the way; its name.
    fn stop(&mut self, leg: &Leg, agent: AgentId, losses: &mut Losses) -> Result<String, Unusable> {
        let wanted_m = if leg.wait_s > 0.0 { WAIT_M } else { PASS_M };
        let (at, room_m) = self.place(&leg.at, across(wanted_m), losses, agent)?;
        let name = format!("jps-checkpoints_{}", self.stops.len());
        self.stops.insert(
            name.clone(),
            json!({
                "type": "polygon",
                "coordinates": area(&at, wanted_m.min(room_m / across(1.0))),
                "waiting_time": leg.wait_s,
                "waiting_time_distribution": "constant",
            }),
        );
        Ok(name)
    }

    /// The nearest place with room, and how much there is, m.
    fn place(&self, at: &Point, room_m: f64, losses: &mut Losses, agent: AgentId) -> Result<(Point, f64), Unusable> {
        let Some((place, room_m)) = self.floor.spot(self.grid, at, room_m) else {
            let problem = format!("{agent} comes to ({:.2}, {:.2}), which has no floor around it", at.x, at.y);
            return Err(Unusable::new("paths.json", problem, "`socrates map check` shows places that lie in walls"));
        };
        let off_m = (place - at).norm();
        if off_m > 0.0 {
            let why = "an area of the format lies on the floor with its whole width: places were moved to where there is room";
            losses.note("places beside walls", format!("{agent}: ({:.2}, {:.2}) by {off_m:.2} m", at.x, at.y), why);
        }
        Ok((place, room_m))
    }
}

/// Distance of the corners of an area from its middle, m, where its sides are so far away.
fn across(side_m: f64) -> f64 {
    side_m / libm::cos(std::f64::consts::PI / f64::from(SIDES))
}

/// An area around a place whose sides are so far from it, as a closed ring.
fn area(at: &Point, side_m: f64) -> Vec<[f64; 2]> {
    let corner = |number: u8| {
        let angle = (2.0 * f64::from(number % SIDES) + 1.0) * std::f64::consts::PI / f64::from(SIDES);
        [micro(at.x + across(side_m) * libm::cos(angle)), micro(at.y + across(side_m) * libm::sin(angle))]
    };
    (0..=SIDES).map(corner).collect()
}
