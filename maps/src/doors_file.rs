//! `location.toml`: the description, the doors and the names of areas of a location.

use serde::Deserialize;
use socrates_model::{AreaName, Door, Fault, Where};

use crate::keys::{AREA_NAME, DOOR, Keys};
use crate::read::EXTRA;

/// The keys of the file.
pub(crate) const LOCATION: Keys =
    Keys { needed: &[], other: &["description", "doors", "names"], tables: &[("doors", &DOOR), ("names", &AREA_NAME)] };

/// What the file may say; unknown keys are refused.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LocationFile {
    /// What kind of place it is, in a sentence or two.
    #[serde(default)]
    pub(crate) description: Option<String>,
    /// Doors in the map frame.
    #[serde(default)]
    pub(crate) doors: Vec<Door>,
    /// Names that people gave to areas.
    #[serde(default)]
    pub(crate) names: Vec<AreaName>,
}

/// Reads the file; a problem goes to `faults`.
pub(crate) fn read(bytes: &[u8], faults: &mut Vec<Fault>) -> Option<LocationFile> {
    let text = String::from_utf8_lossy(bytes);
    match toml::from_str(&text) {
        Ok(file) => Some(file),
        Err(why) => {
            faults.push(toml_fault(EXTRA, &LOCATION, &text, &why));
            None
        }
    }
}

/// A fault of a TOML file with its line.
pub(crate) fn toml_fault(file: &str, keys: &Keys, text: &str, why: &toml::de::Error) -> Fault {
    let at = Where::file(file);
    let at = match why.span() {
        Some(span) => at.line(line_at(text, span.start)),
        None => at,
    };
    Fault::new(keys.mistake(text), at, why.message().replace('\n', " "))
}

/// Line of a byte offset, from 1.
pub(crate) fn line_at(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{DoorKind, DoorOpens, FaultCode};

    #[test]
    fn doors_are_read_and_unknown_keys_are_named_with_their_line() {
        let good = "description = \"A ward.\"\n[[doors]]\nid = \"d\"\nkind = \"elevator\"\nfrom = [1, 2]\nto = [1.0, 3.5]\nopens = { robot_near = 3 }\nhold_s = 15\ninside = [\"a\"]\n";
        let mut faults = Vec::new();
        let file = read(good.as_bytes(), &mut faults).unwrap();
        assert_eq!(faults, []);
        assert_eq!((file.doors[0].kind, &file.doors[0].opens), (DoorKind::Elevator, &DoorOpens::RobotNear(3.0)));
        assert_eq!(read(good.replace("hold_s", "hold").as_bytes(), &mut faults), None);
        assert_eq!((faults[0].code, faults[0].at.to_string()), (FaultCode::MKey, "location.toml:8".to_owned()));
        assert!(faults[0].message.to_string().contains("hold"), "{}", faults[0]);
    }
}
