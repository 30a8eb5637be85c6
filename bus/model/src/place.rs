//! Place classes: the closed list of places that scenarios speak of.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::BadId;

/// A class of places. Maps spell their types freely; [`PlaceClass::of_type`] reads them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlaceClass {
    /// A corridor, hallway or wide passage.
    Corridor,
    /// An aisle or corridor too narrow for two to pass with ease.
    NarrowPassage,
    /// Where ways meet; also every node of degree 3 or more, whatever its type says.
    Intersection,
    /// A corner that hides what comes round it.
    BlindCorner,
    /// A door or doorway.
    Doorway,
    /// Inside an elevator car.
    Elevator,
    /// In front of elevator doors.
    ElevatorLobby,
    /// Inside a room.
    Room,
    /// Open floor: hall, packaging or waiting area.
    OpenArea,
    /// A way out, a gate, the end of a passage, a loading dock.
    Exit,
    /// A node or edge without a telling type.
    Plain,
}

impl PlaceClass {
    /// Every class in order.
    pub const ALL: [Self; 11] = [
        Self::Corridor,
        Self::NarrowPassage,
        Self::Intersection,
        Self::BlindCorner,
        Self::Doorway,
        Self::Elevator,
        Self::ElevatorLobby,
        Self::Room,
        Self::OpenArea,
        Self::Exit,
        Self::Plain,
    ];

    /// Name as written in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::NarrowPassage => "narrow_passage",
            Self::Intersection => "intersection",
            Self::BlindCorner => "blind_corner",
            Self::Doorway => "doorway",
            Self::Elevator => "elevator",
            Self::ElevatorLobby => "elevator_lobby",
            Self::Room => "room",
            Self::OpenArea => "open_area",
            Self::Exit => "exit",
            Self::Plain => "plain",
        }
    }

    /// The class of a map's own type name, such as `PASSAGEWAY_END` or `WITHIN_ELEVATOR_1`.
    ///
    /// Spelling is free: case, blanks, underscores and trailing numbers do not matter. The more
    /// telling word wins (`NARROW AISLE` is narrow before it is an aisle).
    #[must_use]
    pub fn of_type(text: &str) -> Self {
        let words: String =
            text.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { ' ' }).collect();
        let has = |needle: &str| words.contains(needle);
        if has("outside elevator") || (has("elevator") || has("lift")) && (has("lobby") || has("hall")) {
            Self::ElevatorLobby
        } else if has("door") || has("threshold") || has("entrance") {
            Self::Doorway
        } else if has("elevator") || has("lift car") {
            Self::Elevator
        } else if has("blind") || has("corner") {
            Self::BlindCorner
        } else if has("intersection") || has("junction") || has("crossing") {
            Self::Intersection
        } else if has("end") || has("exit") || has("gate") || has("dock") || has("stairs") {
            Self::Exit
        } else if has("narrow") || has("aisle") {
            Self::NarrowPassage
        } else if has("passage") || has("corridor") || has("hallway") || has("walkway") {
            Self::Corridor
        } else if has("room") || has("office") || has("kitchen") || has("ward") || has("lab") || has("restroom") {
            Self::Room
        } else if has("open") || has("area") || has("hall") || has("lobby") || has("plaza") || has("lounge") {
            Self::OpenArea
        } else {
            Self::Plain
        }
    }
}

impl fmt::Display for PlaceClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for PlaceClass {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let spelled: String =
            text.trim().chars().map(|c| if c == ' ' || c == '-' { '_' } else { c.to_ascii_lowercase() }).collect();
        Self::ALL.into_iter().find(|class| class.name() == spelled).ok_or_else(|| BadId {
            what: "place class",
            found: text.chars().take(40).collect(),
            allowed: "corridor, narrow_passage, intersection, blind_corner, doorway, elevator, elevator_lobby, room, open_area, exit, plain",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_spellings_of_maps_are_read() {
        for (text, class) in [
            ("PASSAGEWAY_END", PlaceClass::Exit),
            ("PASSAGEWAY END", PlaceClass::Exit),
            ("WITHIN_ELEVATOR_1", PlaceClass::Elevator),
            ("OUTSIDE_ELEVATOR_2", PlaceClass::ElevatorLobby),
            ("ELEVATOR_DOORWAY", PlaceClass::Doorway),
            ("NARROW AISLE", PlaceClass::NarrowPassage),
            ("WIDE PASSAGEWAY", PlaceClass::Corridor),
            ("BLIND CORNER", PlaceClass::BlindCorner),
            ("SIMPLE NODE", PlaceClass::Plain),
            ("OPEN AREA", PlaceClass::OpenArea),
            ("ROOM", PlaceClass::Room),
        ] {
            assert_eq!(PlaceClass::of_type(text), class, "{text}");
        }
    }
}
