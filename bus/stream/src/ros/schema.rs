//! What a message looks like, read from the definition that a bag carries (`ros2msg`).
//!
//! The types are those of the file, so that every version of a package is read by the names of its fields: HuNavSim's `Agent`
//! came in three incompatible layouts.

use std::collections::BTreeMap;

use super::cdr::Primitive;

/// Longest definition, bytes: those of whole navigation stacks have some thousand.
const MOST_BYTES: usize = 1024 * 1024;
/// Most types of a definition.
const MOST_TYPES: usize = 512;
/// Most fields of a definition.
const MOST_FIELDS: usize = 8192;
/// Deepest nesting.
const DEEPEST: usize = 32;
/// Fewest equal signs of a line between two types; ROS writes eighty.
const RULE: usize = 8;

/// Why a definition cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum SchemaFault {
    #[error("the bag holds no definition of `{name}`")]
    Missing { name: String },
    #[error("the definition of `{name}` is of kind `{kind}`; `ros2msg` is read")]
    Kind { name: String, kind: String },
    #[error("its definition has {found} {what}; at most {most} are read")]
    Large { what: &'static str, found: usize, most: usize },
    #[error("its definition is not UTF-8 text")]
    NotUtf8,
    #[error("`{line}` in the definition of `{name}` is no field")]
    Line { name: String, line: String },
    #[error("`{name}` holds itself")]
    Recursive { name: String },
    #[error("`{name}` is nested deeper than {DEEPEST}")]
    Deep { name: String },
    #[error("`{name}` has a `{kind}`, which is not read")]
    Wide { name: String, kind: String },
}

/// How often a field is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Times {
    One,
    Exactly(usize),
    Any,
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    Number(Primitive),
    Text,
    /// Fields of its own, by their place in the layout.
    Shape(usize),
}

/// A field of a type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) holds: Holds,
    pub(super) times: Times,
}

/// A type of messages with all that it holds. No type holds itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    shapes: Vec<Vec<Field>>,
    root: usize,
}

impl Layout {
    /// Reads the definition of a type.
    pub(super) fn read(name: &str, kind: &str, text: &[u8]) -> Result<Self, SchemaFault> {
        if text.iter().all(u8::is_ascii_whitespace) {
            return Err(SchemaFault::Missing { name: name.to_owned() });
        }
        if kind != "ros2msg" {
            return Err(SchemaFault::Kind { name: name.to_owned(), kind: short(kind) });
        }
        let large = |what, found, most| SchemaFault::Large { what, found, most };
        if text.len() > MOST_BYTES {
            return Err(large("bytes", text.len(), MOST_BYTES));
        }
        let text = std::str::from_utf8(text).map_err(|_why| SchemaFault::NotUtf8)?;
        let written = written(name, text)?;
        let fields = written.values().map(Vec::len).sum();
        if written.len() > MOST_TYPES {
            return Err(large("types", written.len(), MOST_TYPES));
        }
        if fields > MOST_FIELDS {
            return Err(large("fields", fields, MOST_FIELDS));
        }
        let mut resolver = Resolver { written, shapes: Vec::new(), done: BTreeMap::new(), open: Vec::new() };
        let root = resolver.resolve(&plain(name))?;
        Ok(Self { shapes: resolver.shapes, root })
    }

    /// Fields of the message itself.
    pub(super) const fn root(&self) -> usize {
        self.root
    }

    /// Fields of a shape, in the order of their bytes.
    pub(super) fn fields(&self, shape: usize) -> &[Field] {
        self.shapes.get(shape).map_or(&[], Vec::as_slice)
    }
}

/// `geometry_msgs/msg/Pose` and `geometry_msgs/Pose` are one type.
pub(super) fn plain(name: &str) -> String {
    let mut parts = name.split('/').filter(|part| !part.is_empty());
    let (first, last) = (parts.next(), parts.next_back());
    match (first, last) {
        (Some(package), Some(last)) => format!("{package}/{last}"),
        (Some(only), None) => only.to_owned(),
        (None, _) => String::new(),
    }
}

fn short(text: &str) -> String {
    text.chars().take(60).collect()
}

/// A field as it is written: its type, its name.
struct Line {
    kind: String,
    name: String,
}

/// The lines of every type of a definition.
fn written(name: &str, text: &str) -> Result<BTreeMap<String, Vec<Line>>, SchemaFault> {
    let mut types: BTreeMap<String, Vec<Line>> = BTreeMap::new();
    let mut now = plain(name);
    let mut named = true;
    for raw in text.lines() {
        let line = raw.split('#').next().unwrap_or_default().trim();
        if line.len() >= RULE && line.bytes().all(|byte| byte == b'=') {
            named = false;
            continue;
        }
        if line.is_empty() {
            continue;
        }
        if let Some(next) = line.strip_prefix("MSG:").filter(|_| !named) {
            (now, named) = (plain(next.trim()), true);
            types.entry(now.clone()).or_default();
            continue;
        }
        let bad = || SchemaFault::Line { name: now.clone(), line: short(line) };
        let (kind, rest) = line.split_once(char::is_whitespace).ok_or_else(bad)?;
        let rest = rest.trim_start();
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let (field, after) = rest.split_at_checked(end).filter(|(field, _)| !field.is_empty()).ok_or_else(bad)?;
        // Constants take no bytes.
        if !after.trim_start().starts_with('=') {
            types.entry(now.clone()).or_default().push(Line { kind: kind.to_owned(), name: field.to_owned() });
        }
    }
    types.entry(plain(name)).or_default();
    Ok(types)
}

/// Brings the types of a definition into a layout.
struct Resolver {
    written: BTreeMap<String, Vec<Line>>,
    shapes: Vec<Vec<Field>>,
    done: BTreeMap<String, usize>,
    /// The types around the one that is read.
    open: Vec<String>,
}

impl Resolver {
    fn resolve(&mut self, name: &str) -> Result<usize, SchemaFault> {
        if let Some(done) = self.done.get(name) {
            return Ok(*done);
        }
        if self.open.iter().any(|open| open == name) {
            return Err(SchemaFault::Recursive { name: name.to_owned() });
        }
        if self.open.len() >= DEEPEST {
            return Err(SchemaFault::Deep { name: name.to_owned() });
        }
        let lines = self.written.remove(name).ok_or_else(|| SchemaFault::Missing { name: name.to_owned() })?;
        self.open.push(name.to_owned());
        let mut fields = Vec::with_capacity(lines.len());
        for line in &lines {
            let (holds, times) = self.field(name, line)?;
            fields.push(Field { name: line.name.clone(), holds, times });
        }
        // A type without fields has a byte all the same.
        if fields.is_empty() {
            let holds = Holds::Number(Primitive::U8);
            fields.push(Field { name: String::new(), holds, times: Times::One });
        }
        self.open.pop();
        let place = self.shapes.len();
        self.shapes.push(fields);
        self.done.insert(name.to_owned(), place);
        Ok(place)
    }

    fn field(&mut self, within: &str, line: &Line) -> Result<(Holds, Times), SchemaFault> {
        let bad =
            || SchemaFault::Line { name: within.to_owned(), line: short(&format!("{} {}", line.kind, line.name)) };
        let (base, times) = match line.kind.split_once('[') {
            None => (line.kind.as_str(), Times::One),
            Some((base, size)) => {
                let size = size.strip_suffix(']').ok_or_else(bad)?;
                let fixed = !size.is_empty() && !size.starts_with("<=");
                let times = if fixed { Times::Exactly(size.parse().map_err(|_why| bad())?) } else { Times::Any };
                (base, times)
            }
        };
        let base = base.split("<=").next().unwrap_or_default();
        let holds = match base {
            "bool" | "byte" | "char" | "uint8" => Holds::Number(Primitive::U8),
            "int8" => Holds::Number(Primitive::I8),
            "uint16" => Holds::Number(Primitive::U16),
            "int16" => Holds::Number(Primitive::I16),
            "uint32" => Holds::Number(Primitive::U32),
            "int32" => Holds::Number(Primitive::I32),
            "uint64" => Holds::Number(Primitive::U64),
            "int64" => Holds::Number(Primitive::I64),
            "float32" => Holds::Number(Primitive::F32),
            "float64" => Holds::Number(Primitive::F64),
            "string" => Holds::Text,
            "wstring" => return Err(SchemaFault::Wide { name: within.to_owned(), kind: base.to_owned() }),
            other => Holds::Shape(self.resolve(&self.full(within, other))?),
        };
        Ok((holds, times))
    }

    /// The full name of a type as it is named within another: without a package it is of the same one.
    fn full(&self, within: &str, name: &str) -> String {
        if name.contains('/') {
            return plain(name);
        }
        let package = within.split('/').next().unwrap_or_default();
        let own = format!("{package}/{name}");
        let header = "std_msgs/Header";
        let is_header = name == "Header" && !self.written.contains_key(&own) && !self.done.contains_key(&own);
        if is_header { header.to_owned() } else { own }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE80: &str = "================================================================================";

    fn read(text: &str) -> Result<Layout, SchemaFault> {
        Layout::read("a_msgs/msg/Top", "ros2msg", text.as_bytes())
    }

    #[test]
    fn fields_types_constants_defaults_and_bounds_are_told_apart() {
        let text = format!(
            "# a comment\nuint8 PERSON=1\nstring WORD = \"a # b\"\nstd_msgs/Header header # why\nstring<=10 name \"x=1\"\n\
             float64[36] covariance\nPoint[] points\nint32[<=4] few\n\n{RULE80}\nMSG: std_msgs/Header\nint32 sec\n{RULE80}\n\
             MSG: a_msgs/Point\nfloat64 x 0.5\n"
        );
        let layout = read(&text).unwrap();
        let fields: Vec<(&str, Times)> =
            layout.fields(layout.root()).iter().map(|field| (field.name.as_str(), field.times)).collect();
        let wanted = [
            ("header", Times::One),
            ("name", Times::One),
            ("covariance", Times::Exactly(36)),
            ("points", Times::Any),
            ("few", Times::Any),
        ];
        assert_eq!(fields, wanted);
    }

    #[test]
    fn a_type_without_fields_has_one_byte() {
        let layout = read("uint8 ONLY=1\n").unwrap();
        assert_eq!(layout.fields(layout.root()).len(), 1);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let deep: String = (0..40).map(|k| format!("T{} x\n{RULE80}\nMSG: a_msgs/T{k}\n", k)).collect();
        let many = "uint8 a\n".repeat(9000);
        for (text, word) in [
            ("  \n", "holds no definition of `a_msgs/msg/Top`"),
            ("other/Thing x\n", "holds no definition of `other/Thing`"),
            ("Top x\n", "`a_msgs/Top` holds itself"),
            (&format!("B b\n{RULE80}\nMSG: a_msgs/B\nTop[] back\n"), "`a_msgs/Top` holds itself"),
            (&deep, "nested deeper than 32"),
            ("wstring w\n", "`wstring`"),
            ("float64[x] a\n", "`float64[x] a`"),
            ("float64\n", "`float64`"),
            ("float64 -\n", "`float64 -`"),
            (&many, "9000 fields"),
        ] {
            let why = read(text).unwrap_err().to_string();
            assert!(why.contains(word), "{word}: {why}");
        }
        let idl = Layout::read("a/msg/B", "ros2idl", b"struct").unwrap_err().to_string();
        assert!(idl.contains("`ros2idl`"), "{idl}");
        assert_eq!(Layout::read("a/msg/B", "ros2msg", &[0xff, 0xfe]), Err(SchemaFault::NotUtf8));
    }
}
