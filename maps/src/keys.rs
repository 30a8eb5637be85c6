//! Which keys the tables of our TOML files have: what kind of mistake a file holds is told from them, not from the words of its
//! reader.

use socrates_model::FaultCode;
use toml::{Table, Value};

/// The keys of a table.
pub(crate) struct Keys {
    /// Keys that must be there.
    pub(crate) needed: &'static [&'static str],
    /// Keys that may be.
    pub(crate) other: &'static [&'static str],
    /// Of them those that hold tables, or lists of tables, of known keys.
    pub(crate) tables: &'static [(&'static str, &'static Self)],
}

/// `[[doors]]`.
pub(crate) const DOOR: Keys =
    Keys { needed: &["id", "kind", "from", "to", "opens"], other: &["hold_s", "inside"], tables: &[] };

/// `[[names]]`.
pub(crate) const AREA_NAME: Keys = Keys { needed: &["name", "nodes"], other: &[], tables: &[] };

impl Keys {
    /// What kind of mistake a text holds that its type refuses: it is no TOML, a key is unknown or missing, or a value is wrong.
    pub(crate) fn mistake(&self, text: &str) -> FaultCode {
        match text.parse::<Table>() {
            Err(_syntax) => FaultCode::MRead,
            Ok(table) if self.fit(&table) => FaultCode::MValue,
            Ok(_) => FaultCode::MKey,
        }
    }

    fn fit(&self, table: &Table) -> bool {
        let known = |key: &String| self.needed.iter().chain(self.other).any(|known| known == key);
        self.needed.iter().all(|key| table.contains_key(*key)) && table.keys().all(known) && self.below(table)
    }

    fn below(&self, table: &Table) -> bool {
        self.tables.iter().all(|(key, keys)| match table.get(*key) {
            Some(Value::Table(inner)) => keys.fit(inner),
            Some(Value::Array(items)) => items.iter().filter_map(Value::as_table).all(|inner| keys.fit(inner)),
            _ => true,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doors_file::LOCATION;
    use crate::plan::{PLAN_KEYS, Plan};

    /// A plan that says all that can be said.
    const WHOLE: &str = r#"description = "Two rooms."
size_m = [8.0, 5.0]
resolution_m = 0.1
wall_thickness_m = 0.2
floors = [[0.5, 0.5, 7.5, 4.5]]
walls = [[4.0, 0.5, 4.0, 4.5]]
openings = [[4.0, 2.0, 4.0, 3.0]]
blocks = []
nodes = [{ id = "a", type = "ROOM", at = [2.0, 2.5] }, { id = "b", type = "ROOM", at = [6.0, 2.5] }]
edges = [{ type = "DOORWAY", along = ["a", "b"] }]

[[doors]]
id = "d"
kind = "room"
from = [4.0, 2.0]
to = [4.0, 3.0]
opens = "always"
hold_s = 12.0
inside = ["b"]

[[names]]
name = "pharmacy"
nodes = ["b"]
"#;

    /// Every key of a table, in the whole plan.
    fn all<'k>(keys: &'k Keys, out: &mut Vec<&'k str>) {
        out.extend(keys.needed.iter().chain(keys.other));
        keys.tables.iter().for_each(|(_, below)| all(below, out));
    }

    #[test]
    fn the_keys_are_those_that_the_type_reads() {
        assert!(Plan::read(WHOLE).is_ok());
        assert!(PLAN_KEYS.fit(&WHOLE.parse().unwrap()));
        let mut keys = Vec::new();
        all(&PLAN_KEYS, &mut keys);
        assert!(
            keys.iter().all(|key| WHOLE.contains(&format!("{key} = ")) || ["doors", "names"].contains(key)),
            "{keys:?}"
        );
        // A needed key that is left out, and one that nobody knows, are refused by the type too, and are mistakes of keys.
        for key in PLAN_KEYS.needed.iter().chain(DOOR.needed).chain(AREA_NAME.needed) {
            let without = WHOLE.replacen(&format!("{key} = "), "unknown_key = ", 1);
            let faults = Plan::read(&without).unwrap_err();
            assert_eq!(faults[0].code, FaultCode::MKey, "{key}: {}", faults[0]);
        }
        for key in PLAN_KEYS.other.iter().chain(DOOR.other).filter(|key| !["doors", "names"].contains(key)) {
            let lines: Vec<&str> = WHOLE.lines().filter(|line| !line.starts_with(&format!("{key} = "))).collect();
            assert!(Plan::read(&lines.join("\n")).is_ok(), "{key} is needed");
        }
    }

    #[test]
    fn what_is_wrong_is_told_by_the_file_and_not_by_the_words_of_its_reader() {
        for (text, code) in [
            ("description = ", FaultCode::MRead),
            ("describtion = \"a ward\"", FaultCode::MKey),
            ("[[doors]]\nid = \"d\"", FaultCode::MKey),
            ("description = 3", FaultCode::MValue),
            // The value holds the words that readers say about keys.
            ("doors = \"unknown field\"", FaultCode::MValue),
            (
                "doors = [{ id = \"d\", kind = \"gate\", from = [0, 0], to = [1, 0], opens = \"always\" }]",
                FaultCode::MValue,
            ),
            (
                "doors = [{ id = \"d\", kind = \"room\", from = [0, 0], to = [1, 0], opens = \"always\", inside = [\"a b\"] }]",
                FaultCode::MValue,
            ),
        ] {
            let mut faults = Vec::new();
            assert!(crate::doors_file::read(text.as_bytes(), &mut faults).is_none(), "{text}");
            assert_eq!(faults[0].code, code, "{text}: {}", faults[0]);
            assert_eq!(LOCATION.mistake(text), code, "{text}");
        }
    }
}
