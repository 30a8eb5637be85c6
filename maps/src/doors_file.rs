//! `location.toml`: the description and the doors of a location.

use serde::Deserialize;
use socrates_model::{Door, Fault, FaultCode};

use crate::read::EXTRA;

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
}

/// Reads the file; a problem goes to `faults`.
pub(crate) fn read(bytes: &[u8], faults: &mut Vec<Fault>) -> Option<LocationFile> {
    let text = String::from_utf8_lossy(bytes);
    match toml::from_str(&text) {
        Ok(file) => Some(file),
        Err(why) => {
            faults.push(toml_fault(EXTRA, &text, &why));
            None
        }
    }
}

/// A fault of a TOML file with its line.
pub(crate) fn toml_fault(file: &str, text: &str, why: &toml::de::Error) -> Fault {
    let at = why.span().map_or_else(|| file.to_owned(), |span| format!("{file}:{}", line_at(text, span.start)));
    let message = why.message().replace('\n', " ");
    let code = if message.contains("unknown field") || message.contains("missing field") {
        FaultCode::MKey
    } else if message.contains("unknown variant") || message.contains("invalid") && message.contains("expected") {
        FaultCode::MValue
    } else {
        FaultCode::MRead
    };
    Fault::new(code, at, message)
}

/// Line of a byte offset, from 1.
pub(crate) fn line_at(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use socrates_model::{DoorKind, DoorOpens};

    #[test]
    fn doors_are_read_and_unknown_keys_are_named_with_their_line() {
        let good = "description = \"A ward.\"\n[[doors]]\nid = \"d\"\nkind = \"elevator\"\nfrom = [1, 2]\nto = [1.0, 3.5]\nopens = { robot_near = 3 }\nhold_s = 15\ninside = [\"a\"]\n";
        let mut faults = Vec::new();
        let file = read(good.as_bytes(), &mut faults).unwrap();
        assert_eq!(faults, []);
        assert_eq!((file.doors[0].kind, &file.doors[0].opens), (DoorKind::Elevator, &DoorOpens::RobotNear(3.0)));
        assert_eq!(read(good.replace("hold_s", "hold").as_bytes(), &mut faults), None);
        assert_eq!((faults[0].code, faults[0].at.as_str()), (FaultCode::MKey, "location.toml:8"));
        assert!(faults[0].message.contains("hold"), "{}", faults[0]);
    }
}
