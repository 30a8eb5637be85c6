//! JSON schemas of the artifacts, made from the types.

use serde_json::Value;

/// Names of the artifacts that have a schema.
pub const NAMES: &[&str] = &[
    "request",
    "location",
    "reading",
    "proposal",
    "paths",
    "behaviors",
    "clause",
    "report",
    "fault",
    "job",
    "recording_header",
    "event",
];

/// The schema of an artifact.
#[must_use]
pub fn of(name: &str) -> Option<Value> {
    let schema = match name {
        "request" => schemars::schema_for!(crate::Request),
        "location" => schemars::schema_for!(crate::Location),
        "reading" => schemars::schema_for!(crate::Reading),
        "proposal" => schemars::schema_for!(crate::Proposal),
        "paths" => schemars::schema_for!(crate::Paths),
        "behaviors" => schemars::schema_for!(crate::Behaviors),
        "clause" => schemars::schema_for!(crate::Clause),
        "report" => schemars::schema_for!(crate::Report),
        "fault" => schemars::schema_for!(crate::Fault),
        "job" => schemars::schema_for!(crate::job::JobSpec),
        "recording_header" => schemars::schema_for!(crate::RecordingHeader),
        "event" => schemars::schema_for!(crate::Event),
        _ => return None,
    };
    serde_json::to_value(schema).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_artifact_has_a_schema() {
        for name in NAMES {
            let schema = of(name).unwrap();
            assert!(schema.get("properties").is_some(), "{name}");
        }
        assert!(of("nothing").is_none());
    }
}
