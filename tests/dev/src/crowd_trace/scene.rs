//! A scene file: constants, walls and agents.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use nalgebra::{Point2, Vector2};

use super::json::Json;
use socrates_crowd::obstacle::Segment;
use socrates_crowd::params::Params;
use socrates_crowd::person::{Goal, Person};
use socrates_crowd::strict::{Crowd, Model};
use socrates_crowd::walker::{Drive, Route, Walker};
use socrates_crowd::wrap;

/// A scene in which every value can be meant.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    /// Which model of the reference library.
    pub(crate) model: Model,
    /// Length of a step, s, above 0.
    pub(crate) dt_s: f64,
    /// Number of updates.
    pub(crate) steps: u32,
    /// Within this distance a wall is felt, m.
    pub(crate) wall_range_m: f64,
    /// Constants of the forces. `epsilon` is 0 in [`Model::Hunav`], whatever the file says: that call
    /// has no bias.
    pub(crate) params: Params,
    /// Walls; both ends equal for a point.
    pub(crate) walls: Vec<Segment>,
    /// Agents in list order, at least one.
    pub(crate) walkers: Vec<Walker>,
}

/// One value of a scene that cannot be meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Problem {
    /// Where, as `agents[2].radius`.
    pub(crate) field: String,
    /// What stands there.
    pub(crate) found: String,
    /// What would be taken.
    pub(crate) allowed: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is {}; allowed: {}", self.field, self.found, self.allowed)
    }
}

/// Why a scene cannot be run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SceneError {
    /// Not JSON.
    #[error("the scene is not JSON: line {line}, column {column}: {what}")]
    NotJson {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the reader met.
        what: String,
    },
    /// Values that cannot be meant, all of them, in the order of the format.
    #[error("the scene has {} wrong value{}:{}", .problems.len(), if .problems.len() == 1 { "" } else { "s" }, listed(.problems))]
    Wrong {
        /// At least one.
        problems: Vec<Problem>,
    },
}

/// At most this many are written out in a message.
const MOST_LISTED: usize = 50;

fn listed(problems: &[Problem]) -> String {
    let mut text = String::new();
    for problem in problems.iter().take(MOST_LISTED) {
        text.push_str("\n  ");
        text.push_str(&problem.to_string());
    }
    if problems.len() > MOST_LISTED {
        text.push_str(&format!("\n  and {} more", problems.len() - MOST_LISTED));
    }
    text
}

impl Scene {
    /// Reads a scene file.
    ///
    /// Every key of the format must be there once and no other; agent ids must differ; an agent under
    /// remote control needs the model `batch`, which alone moves it; a scene needs an agent.
    ///
    /// # Errors
    /// [`SceneError`] with every wrong value of the file.
    pub(crate) fn read(text: &str) -> Result<Self, SceneError> {
        let json: Json = serde_json::from_str(text).map_err(|error| SceneError::NotJson {
            line: error.line(),
            column: error.column(),
            what: what_is_wrong(&error.to_string()),
        })?;
        let mut reader = Reader::default();
        let scene = scene(&json, &mut reader);
        if reader.problems.is_empty() { Ok(scene) } else { Err(SceneError::Wrong { problems: reader.problems }) }
    }

    /// The crowd of the scene at step 0.
    #[must_use]
    pub(crate) fn crowd(&self) -> Crowd {
        Crowd::new(&self.walkers, &self.walls, self.wall_range_m, &self.params)
    }
}

/// The message of the JSON reader without its own line and column.
fn what_is_wrong(message: &str) -> String {
    message.rsplit_once(" at line ").map_or(message, |(what, _)| what).to_owned()
}

const SCENE_KEYS: &[&str] = &["name", "mode", "dt", "steps", "obstacle_range", "params", "segments", "agents"];
const PARAM_KEYS: &[&str] = &[
    "force_factor_desired",
    "force_factor_obstacle",
    "force_sigma_obstacle",
    "force_factor_social",
    "force_factor_group_gaze",
    "force_factor_group_coherence",
    "force_factor_group_repulsion",
    "lambda",
    "gamma",
    "n",
    "n_prime",
    "epsilon",
    "relaxation_time",
];
const AGENT_KEYS: &[&str] = &[
    "id",
    "x",
    "y",
    "vx",
    "vy",
    "yaw",
    "radius",
    "desired_velocity",
    "group_id",
    "cyclic_goals",
    "teleoperated",
    "linear_velocity",
    "angular_velocity",
    "goals",
];

/// More steps than this are a slip: a week at 100 Hz.
const MOST_STEPS: i128 = 60_480_000;

const ANY: &str = "a finite number";
const POSITIVE: &str = "a finite number above 0";
const NOT_NEGATIVE: &str = "a finite number of at least 0";

fn scene(json: &Json, reader: &mut Reader) -> Scene {
    if *json == Json::Null {
        reader.problem("scene", "`null`", "an object");
    }
    let file = reader.object(json, "scene", SCENE_KEYS);
    let model = reader.model(file.get("mode"));
    let given = reader.object(file.get("params"), "params", PARAM_KEYS);
    let mut factor = |key: &str| reader.number(given.get(key), &format!("params.{key}"), NOT_NEGATIVE);
    let params = Params {
        desired: factor("force_factor_desired"),
        obstacle: factor("force_factor_obstacle"),
        social: factor("force_factor_social"),
        gaze: factor("force_factor_group_gaze"),
        coherence: factor("force_factor_group_coherence"),
        repulsion: factor("force_factor_group_repulsion"),
        lambda: factor("lambda"),
        n: factor("n"),
        n_prime: factor("n_prime"),
        epsilon: factor("epsilon"),
        ..model.params()
    };
    let mut divisor = |key: &str| reader.number(given.get(key), &format!("params.{key}"), POSITIVE);
    let params = Params {
        obstacle_sigma_m: divisor("force_sigma_obstacle"),
        gamma_m: divisor("gamma"),
        relaxation_s: divisor("relaxation_time"),
        epsilon: if model == Model::Hunav { 0.0 } else { params.epsilon },
        ..params
    };
    reader.expect_text(file.get("name"), "name");
    let scene = Scene {
        model,
        dt_s: reader.number(file.get("dt"), "dt", POSITIVE),
        steps: u32::try_from(reader.whole(file.get("steps"), "steps", 0, MOST_STEPS)).unwrap_or(0),
        wall_range_m: reader.number(file.get("obstacle_range"), "obstacle_range", NOT_NEGATIVE),
        params,
        walls: walls(file.get("segments"), reader),
        walkers: walkers(file.get("agents"), model, reader),
    };
    reader.problems.sort_by_key(|problem| SCENE_KEYS.iter().position(|key| problem.field.starts_with(key)));
    scene
}

fn walls(json: &Json, reader: &mut Reader) -> Vec<Segment> {
    let mut walls = Vec::new();
    for (place, item) in reader.list(json, "segments", "a list of [x1, y1, x2, y2]").iter().enumerate() {
        let [ax, ay, bx, by] = reader.numbers(item, &format!("segments[{place}]"), [ANY; 4], "[x1, y1, x2, y2]");
        walls.push(Segment { from: Point2::new(ax, ay), to: Point2::new(bx, by) });
    }
    walls
}

fn walkers(json: &Json, model: Model, reader: &mut Reader) -> Vec<Walker> {
    let items = reader.list(json, "agents", "a list of at least one agent");
    if matches!(json, Json::List(_)) && items.is_empty() {
        reader.problem("agents", "an empty list", "at least one agent");
    }
    let mut ids = BTreeSet::new();
    let mut groups = BTreeMap::new();
    let mut walkers = Vec::new();
    for (place, item) in items.iter().enumerate() {
        let at = format!("agents[{place}]");
        if *item == Json::Null {
            reader.problem(&at, "`null`", "an agent");
        }
        let agent = reader.object(item, &at, AGENT_KEYS);
        let mut number =
            |key: &str, allowed: &'static str| reader.number(agent.get(key), &format!("{at}.{key}"), allowed);
        let position = Point2::new(number("x", ANY), number("y", ANY));
        let velocity = Vector2::new(number("vx", ANY), number("vy", ANY));
        let (yaw, radius_m) = (number("yaw", ANY), number("radius", NOT_NEGATIVE));
        let speed_mps = number("desired_velocity", NOT_NEGATIVE);
        let drive =
            Drive { linear_mps: number("linear_velocity", ANY), angular_radps: number("angular_velocity", ANY) };
        let id = reader.whole(agent.get("id"), &format!("{at}.id"), 0, i128::from(u32::MAX));
        if agent.has("id") && !ids.insert(id) {
            reader.problem(&format!("{at}.id"), &id.to_string(), "an id that no agent before it has");
        }
        let lowest = i128::from(i64::MIN);
        let number_of_group =
            reader.whole(agent.get("group_id"), &format!("{at}.group_id"), lowest, i128::from(i64::MAX));
        let number_of_group = i64::try_from(number_of_group).unwrap_or(-1);
        let teleoperated = reader.flag(agent.get("teleoperated"), &format!("{at}.teleoperated"));
        if teleoperated && model == Model::Hunav {
            let allowed = "false: only the mode `batch` moves agents under remote control";
            reader.problem(&format!("{at}.teleoperated"), "true", allowed);
        }
        let cyclic = reader.flag(agent.get("cyclic_goals"), &format!("{at}.cyclic_goals"));
        // Group numbers may be negative in a file; here they are counted as they come.
        let next = u32::try_from(groups.len()).unwrap_or(u32::MAX);
        let group = model.is_group(number_of_group).then(|| *groups.entry(number_of_group).or_insert(next));
        let goals = goals(agent.get("goals"), &format!("{at}.goals"), reader);
        let person = Person {
            velocity,
            yaw: wrap(yaw),
            radius_m,
            speed_mps,
            group,
            ..Person::standing(u32::try_from(id).unwrap_or(0), position)
        };
        walkers.push(Walker { person, route: Route::new(goals, cyclic), drive: teleoperated.then_some(drive) });
    }
    walkers
}

fn goals(json: &Json, at: &str, reader: &mut Reader) -> Vec<Goal> {
    let mut goals = Vec::new();
    for (place, item) in reader.list(json, at, "a list of [x, y, radius]").iter().enumerate() {
        let at = format!("{at}[{place}]");
        let [x, y, radius_m] = reader.numbers(item, &at, [ANY, ANY, NOT_NEGATIVE], "[x, y, radius]");
        goals.push(Goal { at: Point2::new(x, y), radius_m });
    }
    goals
}

/// The entries of an object; [`Json::Null`] for a key that is not there.
struct Entries<'a>(&'a [(String, Json)]);

impl<'a> Entries<'a> {
    fn get(&self, key: &str) -> &'a Json {
        self.0.iter().find(|(name, _)| name == key).map_or(&Json::Null, |(_, value)| value)
    }

    fn has(&self, key: &str) -> bool {
        self.0.iter().any(|(name, _)| name == key)
    }
}

/// Takes values out of JSON and keeps what is wrong. What is wrong reads as 0, false or nothing.
#[derive(Default)]
struct Reader {
    problems: Vec<Problem>,
}

impl Reader {
    fn problem(&mut self, field: &str, found: &str, allowed: &str) {
        self.problems.push(Problem { field: field.to_owned(), found: found.to_owned(), allowed: allowed.to_owned() });
    }

    fn wrong(&mut self, json: &Json, field: &str, allowed: &str) {
        // A key that is not there is reported by its object.
        if *json != Json::Null {
            self.problem(field, &format!("`{json}`"), allowed);
        }
    }

    /// The entries of an object that has each of `keys` once, not `null`, and no other.
    fn object<'a>(&mut self, json: &'a Json, field: &str, keys: &[&str]) -> Entries<'a> {
        let Json::Map(entries) = json else {
            self.wrong(json, field, &format!("an object with {}", keys.join(", ")));
            return Entries(&[]);
        };
        let name = |key: &str| if field == "scene" { key.to_owned() } else { format!("{field}.{key}") };
        let mut seen = BTreeSet::new();
        for (key, value) in entries {
            if !keys.contains(&key.as_str()) {
                self.problem(&name(key), "not known", &format!("one of {}", keys.join(", ")));
            } else if !seen.insert(key) {
                self.problem(&name(key), "there twice", "each key once");
            } else if *value == Json::Null {
                self.problem(&name(key), "`null`", "a value");
            }
        }
        for key in keys.iter().filter(|key| !entries.iter().any(|(name, _)| name == *key)) {
            self.problem(&name(key), "missing", "a value: every key of the format is needed");
        }
        Entries(entries)
    }

    fn list<'a>(&mut self, json: &'a Json, field: &str, allowed: &str) -> &'a [Json] {
        let Json::List(items) = json else {
            self.wrong(json, field, allowed);
            return &[];
        };
        items
    }

    fn number(&mut self, json: &Json, field: &str, allowed: &'static str) -> f64 {
        let number = as_number(json);
        let fits = number.is_some_and(|number| match allowed {
            POSITIVE => number > 0.0,
            NOT_NEGATIVE => number >= 0.0,
            _ => true,
        });
        match number {
            Some(number) if fits && number.is_finite() => number,
            _ => {
                self.wrong(json, field, allowed);
                0.0
            }
        }
    }

    fn numbers<const N: usize>(
        &mut self,
        json: &Json,
        field: &str,
        allowed: [&'static str; N],
        shape: &str,
    ) -> [f64; N] {
        let mut numbers = [0.0; N];
        let items = if let Json::List(items) = json { items.as_slice() } else { &[] };
        if items.len() != N {
            self.problem(field, &format!("`{json}`"), shape);
            return numbers;
        }
        for (place, ((item, number), allowed)) in items.iter().zip(&mut numbers).zip(allowed).enumerate() {
            let at = format!("{field}[{place}]");
            if *item == Json::Null {
                self.problem(&at, "`null`", allowed);
            }
            *number = self.number(item, &at, allowed);
        }
        numbers
    }

    fn whole(&mut self, json: &Json, field: &str, lowest: i128, highest: i128) -> i128 {
        if let Json::Whole(number) = json
            && (lowest..=highest).contains(number)
        {
            return *number;
        }
        self.wrong(json, field, &format!("a whole number from {lowest} to {highest}"));
        lowest
    }

    fn flag(&mut self, json: &Json, field: &str) -> bool {
        if let Json::Bool(value) = json {
            return *value;
        }
        self.wrong(json, field, "true or false");
        false
    }

    fn expect_text(&mut self, json: &Json, field: &str) {
        if !matches!(json, Json::Text(_)) {
            self.wrong(json, field, "a text");
        }
    }

    fn model(&mut self, json: &Json) -> Model {
        let named = Model::ALL.into_iter().find(|model| matches!(json, Json::Text(name) if name == model.name()));
        named.unwrap_or_else(|| {
            let names = Model::ALL.map(|model| format!("\"{}\"", model.name()));
            self.wrong(json, "mode", &names.join(" or "));
            Model::Batch
        })
    }
}

#[expect(clippy::cast_precision_loss, reason = "as the JSON reader does with whole numbers")]
fn as_number(json: &Json) -> Option<f64> {
    match json {
        Json::Whole(number) => Some(*number as f64),
        Json::Number(number) => Some(*number),
        Json::Null | Json::Bool(_) | Json::Text(_) | Json::List(_) | Json::Map(_) => None,
    }
}
