//! A building in a few rows: which rooms there are, how large, beside what, along which corridors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kinds of buildings with rooms along corridors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BuildingKind {
    /// Offices and meeting rooms.
    Office,
    /// Wards and treatment rooms along wide corridors.
    Hospital,
    /// Rooms along a short passage.
    Home,
}

impl BuildingKind {
    /// Every kind in order.
    pub const ALL: [Self; 3] = [Self::Office, Self::Hospital, Self::Home];

    /// Name as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::Hospital => "hospital",
            Self::Home => "home",
        }
    }
}

/// How corridors lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CorridorForm {
    /// One straight corridor.
    Spine,
    /// A corridor round a corner.
    Bend,
    /// A corridor with a wing.
    Tee,
    /// Two corridors that cross.
    Cross,
    /// Two wings and a corridor between them.
    Wings,
    /// A main corridor with side corridors.
    Comb,
    /// A corridor all round a core of rooms.
    Ring,
    /// Corridors round two cores of rooms.
    TwoRings,
}

impl CorridorForm {
    /// Every form in order.
    pub const ALL: [Self; 8] =
        [Self::Spine, Self::Bend, Self::Tee, Self::Cross, Self::Wings, Self::Comb, Self::Ring, Self::TwoRings];

    /// Name as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spine => "spine",
            Self::Bend => "bend",
            Self::Tee => "tee",
            Self::Cross => "cross",
            Self::Wings => "wings",
            Self::Comb => "comb",
            Self::Ring => "ring",
            Self::TwoRings => "two_rings",
        }
    }
}

/// Rooms of a type.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoomBrief {
    /// Type, such as `ward` or `meeting room`; free text.
    #[serde(rename = "type")]
    pub kind: String,
    /// How many, from 1 to 40; default 1.
    #[serde(default = "one")]
    pub count: u32,
    /// What people call it; rooms of a count above 1 are numbered: `ward 1`, `ward 2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Least and largest floor of each, m²; by default what such rooms have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_m2: Option<[f64; 2]>,
    /// Type of a room of this brief that shares a wall with each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<String>,
    /// Whether it is open to the corridor instead of behind a doorway; by default as such rooms are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open: Option<bool>,
    /// Clear width of its doorway, m, from 0.8 to 2.4; by default that of the building.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub door_m: Option<f64>,
}

const fn one() -> u32 {
    1
}

/// What a building is to have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BuildingBrief {
    /// Kind of building.
    pub kind: BuildingKind,
    /// How its corridors lie; drawn by the seed where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<CorridorForm>,
    /// Width of its corridors, m, from 1.2 to 6; drawn where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corridor_m: Option<f64>,
    /// Clear width of its doorways, m, from 0.8 to 2.4; drawn where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub door_m: Option<f64>,
    /// Elevators behind a lobby, from 0 to 4; default none.
    #[serde(default)]
    pub elevators: u32,
    /// Whether there are no other rooms than those below; by default what is left of the strips is filled with rooms of other types.
    #[serde(default)]
    pub only: bool,
    /// Its rooms, each type once.
    #[serde(default)]
    pub rooms: Vec<RoomBrief>,
}

/// Something of a brief that a building does not have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{what}: asked {asked}; {answer}")]
pub struct Unmet {
    /// What it is, by its key in the brief.
    pub what: String,
    /// What was asked.
    pub asked: String,
    /// What there is, why there is none, or what is allowed: `got 2`, `allowed: 1 to 40`.
    pub answer: String,
}

impl Unmet {
    /// Something that is not met.
    #[must_use]
    pub fn new(what: impl Into<String>, asked: impl Into<String>, answer: impl Into<String>) -> Self {
        Self { what: what.into(), asked: asked.into(), answer: answer.into() }
    }
}

/// Rooms that a brief may have in all.
const MOST_ROOMS: u32 = 60;

impl BuildingBrief {
    /// What of the brief no building could have: numbers out of their ranges, a room beside one that is not there.
    #[must_use]
    pub fn problems(&self) -> Vec<Unmet> {
        let mut out = Vec::new();
        let mut range = |what: String, value: Option<f64>, least: f64, most: f64| {
            if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
                out.push(Unmet::new(what, format!("{value} m"), format!("allowed: {least} to {most} m")));
            }
        };
        range("corridor_m".to_owned(), self.corridor_m, 1.2, 6.0);
        range("door_m".to_owned(), self.door_m, 0.8, 2.4);
        for room in &self.rooms {
            range(format!("rooms `{}`: door_m", room.kind), room.door_m, 0.8, 2.4);
        }
        if self.elevators > 4 {
            out.push(Unmet::new(
                "elevators",
                self.elevators.to_string(),
                "allowed: at most 4, which stand at one lobby",
            ));
        }
        let all: u32 = self.rooms.iter().map(|room| room.count).fold(0, u32::saturating_add);
        if all > MOST_ROOMS {
            out.push(Unmet::new("rooms", all.to_string(), format!("allowed: at most {MOST_ROOMS} in a building")));
        }
        if self.rooms.is_empty() && self.elevators == 0 {
            out.push(Unmet::new("rooms", "none", "needed: a room or an elevator"));
        }
        for (place, room) in self.rooms.iter().enumerate() {
            let what = |key: &str| format!("rooms `{}`: {key}", room.kind);
            let letters = room.kind.trim().chars().count();
            if !(1..=40).contains(&letters) || !room.kind.chars().all(|c| c.is_alphanumeric() || " -/".contains(c)) {
                out.push(Unmet::new(
                    what("type"),
                    format!("`{}`", room.kind),
                    "allowed: 1 to 40 letters, digits, blanks, - or /",
                ));
            }
            if self.rooms.iter().take(place).any(|other| same(&other.kind, &room.kind)) {
                out.push(Unmet::new(what("type"), "a second row", "allowed: one row of a type, with a `count`"));
            }
            if !(1..=40).contains(&room.count) {
                out.push(Unmet::new(what("count"), room.count.to_string(), "allowed: 1 to 40 of a type"));
            }
            if let Some([least, most]) =
                room.area_m2.filter(|[least, most]| !(*least > 0.0 && most >= least && *most <= 1000.0))
            {
                out.push(Unmet::new(
                    what("area_m2"),
                    format!("{least} to {most} m²"),
                    "allowed: two sizes above 0 and at most 1000 m², the larger one last",
                ));
            }
            if let Some(beside) = &room.beside
                && (same(beside, &room.kind) || !self.rooms.iter().any(|other| same(&other.kind, beside)))
            {
                out.push(Unmet::new(
                    what("beside"),
                    format!("`{beside}`"),
                    "needed: the type of another room of the brief",
                ));
            }
        }
        out
    }
}

/// Whether two types are the same word.
#[must_use]
pub fn same(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}
