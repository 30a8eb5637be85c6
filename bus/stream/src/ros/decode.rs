//! A message by the names of its fields.

use super::cdr::{CdrFault, Cursor};
use super::schema::{Holds, Layout, Times};

/// Most entries of a list of messages: people, agents, transforms.
const MOST_ENTRIES: usize = 65_536;

/// What a message says otherwise than its definition, or than is needed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum MessageFault {
    #[error("{why}")]
    Header { why: CdrFault },
    #[error("`{field}`: {why}")]
    Field { field: String, why: CdrFault },
    #[error("its type has no field `{field}` of the kind that is needed")]
    Lacks { field: &'static str },
    #[error("{what}")]
    Value { what: String },
}

/// What a field holds. Lists of numbers and of texts are passed over: none of them is needed.
#[derive(Debug, Clone, PartialEq)]
enum Value<'a> {
    Number(f64),
    Text(&'a str),
    Shape(Vec<Value<'a>>),
    List(Vec<Value<'a>>),
    Passed,
}

/// A message, or a part of one, with the names of its fields.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<'a> {
    layout: &'a Layout,
    shape: usize,
    values: &'a [Value<'a>],
}

/// A message that was read.
#[derive(Debug, Clone)]
pub(super) struct Message<'a> {
    layout: &'a Layout,
    values: Vec<Value<'a>>,
}

impl<'a> Message<'a> {
    /// Reads a message of a type. Bytes behind it are passed over: writers fill up to a multiple of four.
    pub(super) fn read(layout: &'a Layout, bytes: &'a [u8]) -> Result<Self, MessageFault> {
        let mut cursor = Cursor::of(bytes).map_err(|why| MessageFault::Header { why })?;
        let values = shape(layout, layout.root(), &mut cursor)
            .map_err(|Placed { field, why }| MessageFault::Field { field, why })?;
        Ok(Self { layout, values })
    }

    pub(super) fn view(&'a self) -> View<'a> {
        View { layout: self.layout, shape: self.layout.root(), values: &self.values }
    }
}

/// A fault with the field it is in.
struct Placed {
    field: String,
    why: CdrFault,
}

fn shape<'a>(layout: &Layout, at: usize, cursor: &mut Cursor<'a>) -> Result<Vec<Value<'a>>, Placed> {
    let read = |field: &super::schema::Field, cursor: &mut Cursor<'a>| match field.times {
        Times::One => one(layout, field.holds, cursor),
        Times::Exactly(count) => many(layout, field.holds, cursor, Some(count)),
        Times::Any => many(layout, field.holds, cursor, None),
    };
    let fields = layout.fields(at);
    let mut values = Vec::with_capacity(fields.len());
    for field in fields {
        values.push(read(field, cursor).map_err(|Placed { field: inner, why }| {
            let field = if inner.is_empty() { field.name.clone() } else { format!("{}.{inner}", field.name) };
            Placed { field, why }
        })?);
    }
    Ok(values)
}

fn one<'a>(layout: &Layout, holds: Holds, cursor: &mut Cursor<'a>) -> Result<Value<'a>, Placed> {
    let here = |why: CdrFault| Placed { field: String::new(), why };
    match holds {
        Holds::Number(kind) => cursor.number(kind).map(Value::Number).map_err(here),
        Holds::Text => cursor.text().map(Value::Text).map_err(here),
        Holds::Shape(at) => shape(layout, at, cursor).map(Value::Shape),
    }
}

fn many<'a>(layout: &Layout, holds: Holds, cursor: &mut Cursor<'a>, fixed: Option<usize>) -> Result<Value<'a>, Placed> {
    let here = |why: CdrFault| Placed { field: String::new(), why };
    match holds {
        Holds::Number(kind) => {
            let count = fixed.map_or_else(|| cursor.any_count(), Ok).map_err(here)?;
            cursor.pass(kind, count).map_err(here)?;
            Ok(Value::Passed)
        }
        Holds::Text => {
            let count = fixed.map_or_else(|| cursor.any_count(), Ok).map_err(here)?;
            // Each has four bytes at least, so the end of the message ends this.
            for _text in 0..count {
                cursor.text().map_err(here)?;
            }
            Ok(Value::Passed)
        }
        Holds::Shape(at) => {
            let claimed =
                |count: usize| CdrFault::Many { claimed: u32::try_from(count).unwrap_or(u32::MAX), most: MOST_ENTRIES };
            let count = match fixed {
                None => cursor.count(MOST_ENTRIES).map_err(here)?,
                Some(count) if count <= MOST_ENTRIES => count,
                Some(count) => return Err(here(claimed(count))),
            };
            // As many as there are bytes for, whatever is claimed.
            let mut entries = Vec::new();
            for place in 0..count {
                let entry = shape(layout, at, cursor).map_err(|Placed { field, why }| {
                    let field = if field.is_empty() { format!("{place}") } else { format!("{place}.{field}") };
                    Placed { field, why }
                })?;
                entries.push(Value::Shape(entry));
            }
            Ok(Value::List(entries))
        }
    }
}

impl<'a> View<'a> {
    fn value(&self, name: &str) -> Option<(Holds, &'a Value<'a>)> {
        let fields = self.layout.fields(self.shape);
        let at = fields.iter().position(|field| field.name == name)?;
        Some((fields.get(at)?.holds, self.values.get(at)?))
    }

    /// The part of this name.
    pub(super) fn part(&self, field: &'static str) -> Result<View<'a>, MessageFault> {
        match self.value(field) {
            Some((Holds::Shape(shape), Value::Shape(values))) => Ok(View { layout: self.layout, shape, values }),
            Some(_) | None => Err(MessageFault::Lacks { field }),
        }
    }

    /// The entries of the list of this name.
    pub(super) fn list(&self, field: &'static str) -> Result<impl Iterator<Item = View<'a>> + use<'a>, MessageFault> {
        let layout = self.layout;
        let (shape, entries) = match self.value(field) {
            Some((Holds::Shape(shape), Value::List(entries))) => (shape, entries),
            Some(_) | None => return Err(MessageFault::Lacks { field }),
        };
        Ok(entries.iter().filter_map(move |entry| match entry {
            Value::Shape(values) => Some(View { layout, shape, values: values.as_slice() }),
            Value::Number(_) | Value::Text(_) | Value::List(_) | Value::Passed => None,
        }))
    }

    /// The number of this name.
    pub(super) fn number(&self, field: &'static str) -> Result<f64, MessageFault> {
        match self.value(field) {
            Some((_, Value::Number(value))) => Ok(*value),
            Some(_) | None => Err(MessageFault::Lacks { field }),
        }
    }

    /// The text of this name.
    pub(super) fn text(&self, field: &'static str) -> Result<&'a str, MessageFault> {
        match self.value(field) {
            Some((_, Value::Text(text))) => Ok(text),
            Some(_) | None => Err(MessageFault::Lacks { field }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "string name\nfloat64[2] pair\nstring[] words\nSpot[] spots\nuint8 last\n\
                        ==========\nMSG: a/Spot\nfloat32 x\nstring label\n";

    fn bytes() -> Vec<u8> {
        let mut bytes = vec![0, 1, 0, 0, 3, 0, 0, 0, b'h', b'i', 0, 0];
        // The pair stands at a multiple of eight behind the header: at 8.
        bytes.extend([1.0_f64, 2.0].iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([1, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0]);
        bytes.extend([2, 0, 0, 0]);
        for x in [0.5_f32, -4.0] {
            bytes.extend(x.to_le_bytes());
            bytes.extend([2, 0, 0, 0, b's', 0, 0, 0]);
        }
        bytes.truncate(bytes.len() - 2);
        bytes.push(9);
        bytes
    }

    #[test]
    fn fields_are_found_by_name_wherever_they_stand() {
        let layout = Layout::read("a/msg/Top", "ros2msg", TEXT.as_bytes()).unwrap();
        let bytes = bytes();
        let message = Message::read(&layout, &bytes).unwrap();
        let view = message.view();
        assert_eq!(view.text("name"), Ok("hi"));
        assert_eq!(view.number("last").map(|value| value.to_string()), Ok("9".to_owned()));
        let xs: Vec<String> = view.list("spots").unwrap().map(|spot| spot.number("x").unwrap().to_string()).collect();
        assert_eq!(xs, ["0.5", "-4"]);
        assert_eq!(view.number("x"), Err(MessageFault::Lacks { field: "x" }));
        assert_eq!(view.number("name"), Err(MessageFault::Lacks { field: "name" }));
    }

    #[test]
    fn every_cut_of_a_message_is_refused_with_its_field() {
        let layout = Layout::read("a/msg/Top", "ros2msg", TEXT.as_bytes()).unwrap();
        let bytes = bytes();
        for end in 4..bytes.len() {
            let why = Message::read(&layout, &bytes[..end]).unwrap_err();
            assert!(matches!(&why, MessageFault::Field { field, .. } if !field.is_empty()), "{end}: {why}");
        }
        let why = Message::read(&layout, &bytes[..bytes.len() - 10]).unwrap_err().to_string();
        assert!(why.contains("`spots.1.x`") || why.contains("`spots.1.label`"), "{why}");
    }

    #[test]
    fn a_list_that_claims_more_than_there_is_costs_nothing() {
        let layout = Layout::read("a/msg/Top", "ros2msg", b"Spot[] spots\n==========\nMSG: a/Spot\nuint8 x\n").unwrap();
        let why = Message::read(&layout, &[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff]).unwrap_err().to_string();
        assert!(why.contains("4294967295 entries"), "{why}");
        let why = Message::read(&layout, &[0, 1, 0, 0, 0, 0xff, 0, 0, 1]).unwrap_err().to_string();
        assert!(why.contains("`spots.1.x`"), "{why}");
        let fixed = Layout::read("a/msg/Top", "ros2msg", b"Spot[99999999] spots\n==========\nMSG: a/Spot\nuint8 x\n");
        assert!(Message::read(&fixed.unwrap(), &[0, 1, 0, 0, 1]).unwrap_err().to_string().contains("99999999"));
    }
}
