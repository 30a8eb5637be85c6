//! YAML as a tree of nodes that keeps what ROS 2 looks at: whole numbers apart from reals, every entry
//! of a mapping, twice-given keys included. Bounded in size, depth and number of nodes.

use std::cell::Cell;
use std::fmt;

use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};

use crate::problem::{Problem, shortened};

/// Largest file, bytes: some ten thousand agents.
const MAX_BYTES: usize = 8 << 20;
/// Most nodes.
const MAX_NODES: usize = 2_000_000;
/// Deepest nesting of `[` and `{` on the way to a value; agents files need two levels.
const MAX_FLOW: usize = 32;

/// A YAML node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    Null,
    Flag(bool),
    Whole(i64),
    Real(f64),
    Text(String),
    List(Vec<Self>),
    Map(Vec<(String, Self)>),
}

impl Node {
    /// The node as a message shows it.
    pub(crate) fn shown(&self) -> String {
        match self {
            Self::Null => "(nothing)".to_owned(),
            Self::Flag(flag) => flag.to_string(),
            Self::Whole(whole) => whole.to_string(),
            Self::Real(real) => format!("{real:?}"),
            Self::Text(text) => shortened(text),
            Self::List(list) => format!("a list of {}", list.len()),
            Self::Map(map) => format!("a section of {}", map.len()),
        }
    }
}

/// Reads a document.
///
/// # Errors
/// A [`Problem`] with a line, where the YAML itself cannot be read or is made to exhaust the reader.
pub(crate) fn parse(text: &str, file: &str) -> Result<Node, Vec<Problem>> {
    if text.len() > MAX_BYTES {
        let problem = Problem::error(file, "", format!("the file has {} bytes", text.len()))
            .with_hint(format!("allowed: at most {MAX_BYTES}"));
        return Err(vec![problem]);
    }
    screen(text, file)?;
    let left = Cell::new(MAX_NODES);
    Seed { left: &left }.deserialize(yaml_serde::Deserializer::from_str(text)).map_err(|why| {
        let mut problem = Problem::error(file, "", format!("this is no YAML: {why}"))
            .with_hint("an agents file starts with `hunav_loader:` and `  ros__parameters:`");
        problem.line = why.location().map(|at| at.line());
        vec![problem]
    })
}

/// Refuses what ROS 2 refuses too (anchors and aliases), and nesting that only an attack has, before the parser
/// sees it: both can cost it time or memory out of all proportion to the file.
fn screen(text: &str, file: &str) -> Result<(), Vec<Problem>> {
    for (number, line) in (1_usize..).zip(text.lines()) {
        let mut quote: Option<char> = None;
        let mut depth = 0_usize;
        // Whether a value may start here: at the start of a line, after `- `, `: `, `[`, `{` or `,`.
        let mut fresh = true;
        let mut before = ' ';
        for c in line.chars() {
            match (quote, c) {
                (Some(open), _) => {
                    if c == open {
                        quote = None;
                    }
                }
                (None, '#') if before == ' ' || before == '\t' => break,
                (None, '\'' | '"') if fresh => quote = Some(c),
                (None, '&' | '*') if fresh => {
                    let mut problem = Problem::error(file, "", format!("`{c}` starts a YAML anchor or alias"))
                        .with_hint("ROS 2 parameter files have none; write the values out");
                    problem.line = Some(number);
                    return Err(vec![problem]);
                }
                (None, '[' | '{') => depth += 1,
                (None, ']' | '}') => depth = depth.saturating_sub(1),
                (None, _) => {}
            }
            if depth > MAX_FLOW {
                let mut problem = Problem::error(file, "", format!("brackets are nested more than {MAX_FLOW} deep"))
                    .with_hint("an agents file needs two levels");
                problem.line = Some(number);
                return Err(vec![problem]);
            }
            fresh = match c {
                ' ' | '\t' => fresh || matches!(before, ':' | '-' | ',' | '?'),
                '[' | '{' | ',' => true,
                '-' | '?' => false,
                _ => false,
            };
            before = c;
        }
    }
    Ok(())
}

/// Reads one node and counts it.
#[derive(Clone, Copy)]
struct Seed<'a> {
    left: &'a Cell<usize>,
}

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Node;

    fn deserialize<D: serde::Deserializer<'de>>(self, from: D) -> Result<Node, D::Error> {
        match self.left.get().checked_sub(1) {
            Some(left) => self.left.set(left),
            None => return Err(D::Error::custom(format!("more than {MAX_NODES} values"))),
        }
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_none<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_some<D: serde::Deserializer<'de>>(self, from: D) -> Result<Node, D::Error> {
        from.deserialize_any(self)
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Node, E> {
        Ok(Node::Flag(flag))
    }

    fn visit_i64<E>(self, whole: i64) -> Result<Node, E> {
        Ok(Node::Whole(whole))
    }

    fn visit_u64<E>(self, whole: u64) -> Result<Node, E> {
        // Larger than any id; kept as a text, it is shown as it was and refused where a number must stand.
        Ok(i64::try_from(whole).map_or_else(|_too_large| Node::Text(whole.to_string()), Node::Whole))
    }

    fn visit_i128<E>(self, whole: i128) -> Result<Node, E> {
        Ok(Node::Text(whole.to_string()))
    }

    fn visit_u128<E>(self, whole: u128) -> Result<Node, E> {
        Ok(Node::Text(whole.to_string()))
    }

    fn visit_f64<E>(self, real: f64) -> Result<Node, E> {
        Ok(Node::Real(real))
    }

    fn visit_str<E>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Node, A::Error> {
        let mut list = Vec::new();
        while let Some(node) = from.next_element_seed(self)? {
            list.push(node);
        }
        Ok(Node::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> Result<Node, A::Error> {
        let mut map = Vec::new();
        while let Some(key) = from.next_key_seed(self)? {
            let key = if let Node::Text(text) = key { text } else { key.shown() };
            map.push((key, from.next_value_seed(self)?));
        }
        Ok(Node::Map(map))
    }

    fn visit_enum<A: serde::de::EnumAccess<'de>>(self, from: A) -> Result<Node, A::Error> {
        // A tagged value (`!x 1`).
        let (tag, _) = from.variant_seed(self)?;
        Err(A::Error::custom(format!("the YAML tag `{}` has no meaning here", tag.shown())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_and_reals_are_told_apart_and_twice_given_keys_kept() {
        let node = parse("a: 1\nb: 1.0\na: .nan\n1: yes\n", "t").unwrap();
        let Node::Map(map) = node else { panic!() };
        assert_eq!(map[0], ("a".to_owned(), Node::Whole(1)));
        assert_eq!(map[1], ("b".to_owned(), Node::Real(1.0)));
        assert_eq!(map[2].0, "a");
        assert_eq!(map[3].0, "1");
    }

    #[test]
    fn aliases_and_deep_brackets_are_refused_with_their_line() {
        for (text, line) in [("a: 1\nb: &x [1, 2]\nc: *x\n", 2), ("a: [*x]\n", 1), ("- *x\n", 1)] {
            let problem = parse(text, "t").unwrap_err().remove(0);
            assert_eq!(problem.line, Some(line), "{text}");
            assert!(problem.message.contains("anchor"), "{problem}");
        }
        let deep = format!("a: {}\n", "[".repeat(1 << 20));
        assert!(parse(&deep, "t").unwrap_err()[0].message.contains("nested"));
        assert!(parse("a: 'x & y' # & *\nb: 2*3\nc: \"*\"\n", "t").is_ok());
    }

    #[test]
    fn a_file_that_is_too_large_is_refused_by_its_size() {
        let text = "#".repeat(10 << 20);
        assert!(parse(&text, "t").unwrap_err()[0].message.contains("10485760 bytes"));
    }

    #[test]
    fn broken_yaml_says_the_line() {
        let problem = parse("a: 1\nb: [1,\nc: }\n", "t").unwrap_err().remove(0);
        assert!(problem.line.is_some(), "{problem}");
    }
}
