//! Lines of the keys of a YAML text written in block style.

use std::collections::BTreeMap;

/// Line numbers by place (`agent1.init_pose.x`, `agent1.goals[2]`).
#[derive(Debug, Default)]
pub(crate) struct Lines {
    known: BTreeMap<String, usize>,
}

/// One open section.
struct Open {
    indent: usize,
    place: String,
    items: usize,
}

impl Lines {
    /// Reads the indentation of a text. What stands in brackets has the line of its section.
    pub(crate) fn of(text: &str) -> Self {
        let mut known = BTreeMap::new();
        let mut open: Vec<Open> = Vec::new();
        for (number, line) in (1_usize..).zip(text.lines()) {
            let bare = line.trim_start();
            if bare.is_empty() || bare.starts_with('#') || bare.starts_with("---") {
                continue;
            }
            let indent = line.len() - bare.len();
            let item = bare.strip_prefix("- ").or_else(|| (bare.trim_end() == "-").then_some(""));
            // The items of a list may stand as far to the left as its key.
            while open.last().is_some_and(|last| last.indent > indent || last.indent == indent && item.is_none()) {
                open.pop();
            }
            if item.is_some() {
                if let Some(parent) = open.last_mut() {
                    known.entry(format!("{}[{}]", parent.place, parent.items)).or_insert(number);
                    parent.items += 1;
                }
                continue;
            }
            let Some((key, _)) = bare.split_once(':') else { continue };
            let key = key.trim().trim_matches(['"', '\'']);
            let place = match open.last() {
                Some(parent) => format!("{}.{key}", parent.place),
                None => key.to_owned(),
            };
            // A key given twice is told with the line of the second.
            known.insert(place.clone(), number);
            open.push(Open { indent, place, items: 0 });
        }
        Self { known }
    }

    /// The same with the places inside a section known without its name, as its readers call them.
    pub(crate) fn inside(mut self, section: &str) -> Self {
        let inner = |(place, number): (&String, &usize)| {
            let place = place.strip_prefix(section)?.strip_prefix('.')?;
            Some((place.to_owned(), *number))
        };
        let inner: Vec<(String, usize)> = self.known.iter().filter_map(inner).collect();
        self.known.extend(inner);
        self
    }

    /// Line of a place, or of the nearest section around it.
    pub(crate) fn line(&self, place: &str) -> Option<usize> {
        let mut place = place;
        loop {
            if let Some(line) = self.known.get(place) {
                return Some(*line);
            }
            let cut = place.rfind(['.', '['])?;
            place = place.get(..cut)?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_items_have_their_lines_in_both_list_styles() {
        let lines = Lines::of("a:\n  # note\n  b:\n    - x\n    - y\n  c:\n  - z\n  d: {e: 1}\nf: 2\n");
        for (place, line) in [("a", 1), ("a.b", 3), ("a.b[1]", 5), ("a.c[0]", 7), ("a.d.e", 8), ("f", 9)] {
            assert_eq!(lines.line(place), Some(line), "{place}");
        }
        assert_eq!(lines.line("a.c.q"), Some(6));
        assert_eq!(lines.line("zzz"), None);
    }
}
