//! Protocol buffers, as much of them as pictures need: a writer of messages, and their description for a reader that does
//! not know them.
//!
//! The messages are those of `foxglove`, which Foxglove, Lichtblick and Rerun know by name. They are few and fixed, so they
//! are a table here: the bytes then depend on no library's version.

/// A message that is being written. Zeros and empty texts are left out, as everywhere in protocol buffers.
#[derive(Debug, Default)]
pub(super) struct Proto(Vec<u8>);

const VARINT: u32 = 0;
const FIXED_64: u32 = 1;
const FIXED_32: u32 = 5;
const COUNTED: u32 = 2;

impl Proto {
    /// The bytes so far.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Begins another message in the same memory.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether nothing was written.
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            #[expect(clippy::cast_possible_truncation, reason = "seven bits and the mark that more follow")]
            self.0.push((value as u8) | 0x80);
            value >>= 7;
        }
        #[expect(clippy::cast_possible_truncation, reason = "less than 128")]
        self.0.push(value as u8);
    }

    fn tag(&mut self, field: u32, wire: u32) {
        self.varint(u64::from(field << 3 | wire));
    }

    /// An integer that is not negative, an enumeration or a truth value.
    pub(super) fn number(&mut self, field: u32, value: u64) {
        if value > 0 {
            self.tag(field, VARINT);
            self.varint(value);
        }
    }

    /// An integer of four bytes.
    pub(super) fn fixed(&mut self, field: u32, value: u32) {
        if value > 0 {
            self.tag(field, FIXED_32);
            self.0.extend_from_slice(&value.to_le_bytes());
        }
    }

    pub(super) fn data(&mut self, field: u32, value: &[u8]) {
        if !value.is_empty() {
            self.tag(field, COUNTED);
            self.varint(value.len() as u64);
            self.0.extend_from_slice(value);
        }
    }

    pub(super) fn double(&mut self, field: u32, value: f64) {
        if value.to_bits() != 0 {
            self.tag(field, FIXED_64);
            self.0.extend_from_slice(&value.to_le_bytes());
        }
    }

    pub(super) fn text(&mut self, field: u32, value: &str) {
        self.data(field, value.as_bytes());
    }

    /// A message within; it is there even where nothing is written into it.
    pub(super) fn message(&mut self, field: u32, write: impl FnOnce(&mut Self)) {
        self.tag(field, COUNTED);
        let begin = self.0.len();
        write(self);
        // Its length comes before it and is known only now; of short messages, which most are, it is one byte.
        let len = self.0.len() - begin;
        self.varint(len as u64);
        self.0.get_mut(begin..).into_iter().for_each(|written| written.rotate_right(varint_len(len)));
    }
}

/// Bytes of a number as it is written.
const fn varint_len(value: usize) -> usize {
    let bits = (usize::BITS - value.leading_zeros()) as usize;
    if bits == 0 { 1 } else { bits.div_ceil(7) }
}

/// Type of a field, with the numbers that descriptors give them.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Double,
    Int64,
    Int32,
    Fixed32,
    Bool,
    Text,
    Bytes,
    Message(&'static str),
    /// Enumeration of this name in the same message.
    Choice(&'static str),
}

/// One field: name, number, type, whether there may be several.
type Field = (&'static str, u32, Kind, bool);

/// One message: its name, the names of its enumeration, its fields.
struct Message(&'static str, &'static [&'static str], &'static [Field]);

const ONE: bool = false;
const MANY: bool = true;
const STAMP: Kind = Kind::Message(".google.protobuf.Timestamp");
const DURATION: Kind = Kind::Message(".google.protobuf.Duration");
const POSE: Kind = Kind::Message(".foxglove.Pose");
const VECTOR: Kind = Kind::Message(".foxglove.Vector3");
const QUATERNION: Kind = Kind::Message(".foxglove.Quaternion");
const POINT: Kind = Kind::Message(".foxglove.Point3");
const COLOR: Kind = Kind::Message(".foxglove.Color");

/// The messages of package `foxglove` that recordings hold, and those within them.
const FOXGLOVE: &[Message] = &[
    Message("Vector3", &[], &[("x", 1, Kind::Double, ONE), ("y", 2, Kind::Double, ONE), ("z", 3, Kind::Double, ONE)]),
    Message("Point3", &[], &[("x", 1, Kind::Double, ONE), ("y", 2, Kind::Double, ONE), ("z", 3, Kind::Double, ONE)]),
    Message(
        "Quaternion",
        &[],
        &[
            ("x", 1, Kind::Double, ONE),
            ("y", 2, Kind::Double, ONE),
            ("z", 3, Kind::Double, ONE),
            ("w", 4, Kind::Double, ONE),
        ],
    ),
    Message(
        "Color",
        &[],
        &[
            ("r", 1, Kind::Double, ONE),
            ("g", 2, Kind::Double, ONE),
            ("b", 3, Kind::Double, ONE),
            ("a", 4, Kind::Double, ONE),
        ],
    ),
    Message("Pose", &[], &[("position", 1, VECTOR, ONE), ("orientation", 2, QUATERNION, ONE)]),
    Message(
        "FrameTransform",
        &[],
        &[
            ("timestamp", 1, STAMP, ONE),
            ("parent_frame_id", 2, Kind::Text, ONE),
            ("child_frame_id", 3, Kind::Text, ONE),
            ("translation", 4, VECTOR, ONE),
            ("rotation", 5, QUATERNION, ONE),
        ],
    ),
    Message("FrameTransforms", &[], &[("transforms", 1, Kind::Message(".foxglove.FrameTransform"), MANY)]),
    Message(
        "PoseInFrame",
        &[],
        &[("timestamp", 1, STAMP, ONE), ("frame_id", 2, Kind::Text, ONE), ("pose", 3, POSE, ONE)],
    ),
    Message(
        "PosesInFrame",
        &[],
        &[("timestamp", 1, STAMP, ONE), ("frame_id", 2, Kind::Text, ONE), ("poses", 3, POSE, MANY)],
    ),
    Message("KeyValuePair", &[], &[("key", 1, Kind::Text, ONE), ("value", 2, Kind::Text, ONE)]),
    Message(
        "ArrowPrimitive",
        &[],
        &[
            ("pose", 1, POSE, ONE),
            ("shaft_length", 2, Kind::Double, ONE),
            ("shaft_diameter", 3, Kind::Double, ONE),
            ("head_length", 4, Kind::Double, ONE),
            ("head_diameter", 5, Kind::Double, ONE),
            ("color", 6, COLOR, ONE),
        ],
    ),
    Message("CubePrimitive", &[], &[("pose", 1, POSE, ONE), ("size", 2, VECTOR, ONE), ("color", 3, COLOR, ONE)]),
    Message("SpherePrimitive", &[], &[("pose", 1, POSE, ONE), ("size", 2, VECTOR, ONE), ("color", 3, COLOR, ONE)]),
    Message(
        "CylinderPrimitive",
        &[],
        &[
            ("pose", 1, POSE, ONE),
            ("size", 2, VECTOR, ONE),
            ("bottom_scale", 3, Kind::Double, ONE),
            ("top_scale", 4, Kind::Double, ONE),
            ("color", 5, COLOR, ONE),
        ],
    ),
    Message(
        "LinePrimitive",
        &["LINE_STRIP", "LINE_LOOP", "LINE_LIST"],
        &[
            ("type", 1, Kind::Choice("Type"), ONE),
            ("pose", 2, POSE, ONE),
            ("thickness", 3, Kind::Double, ONE),
            ("scale_invariant", 4, Kind::Bool, ONE),
            ("points", 5, POINT, MANY),
            ("color", 6, COLOR, ONE),
            ("colors", 7, COLOR, MANY),
            ("indices", 8, Kind::Fixed32, MANY),
        ],
    ),
    Message(
        "TriangleListPrimitive",
        &[],
        &[
            ("pose", 1, POSE, ONE),
            ("points", 2, POINT, MANY),
            ("color", 3, COLOR, ONE),
            ("colors", 4, COLOR, MANY),
            ("indices", 5, Kind::Fixed32, MANY),
        ],
    ),
    Message(
        "TextPrimitive",
        &[],
        &[
            ("pose", 1, POSE, ONE),
            ("billboard", 2, Kind::Bool, ONE),
            ("font_size", 3, Kind::Double, ONE),
            ("scale_invariant", 4, Kind::Bool, ONE),
            ("color", 5, COLOR, ONE),
            ("text", 6, Kind::Text, ONE),
        ],
    ),
    Message(
        "ModelPrimitive",
        &[],
        &[
            ("pose", 1, POSE, ONE),
            ("scale", 2, VECTOR, ONE),
            ("color", 3, COLOR, ONE),
            ("override_color", 4, Kind::Bool, ONE),
            ("url", 5, Kind::Text, ONE),
            ("media_type", 6, Kind::Text, ONE),
            ("data", 7, Kind::Bytes, ONE),
        ],
    ),
    Message(
        "SceneEntityDeletion",
        &["MATCHING_ID", "ALL"],
        &[("timestamp", 1, STAMP, ONE), ("type", 2, Kind::Choice("Type"), ONE), ("id", 3, Kind::Text, ONE)],
    ),
    Message(
        "SceneEntity",
        &[],
        &[
            ("timestamp", 1, STAMP, ONE),
            ("frame_id", 2, Kind::Text, ONE),
            ("id", 3, Kind::Text, ONE),
            ("lifetime", 4, DURATION, ONE),
            ("frame_locked", 5, Kind::Bool, ONE),
            ("metadata", 6, Kind::Message(".foxglove.KeyValuePair"), MANY),
            ("arrows", 7, Kind::Message(".foxglove.ArrowPrimitive"), MANY),
            ("cubes", 8, Kind::Message(".foxglove.CubePrimitive"), MANY),
            ("spheres", 9, Kind::Message(".foxglove.SpherePrimitive"), MANY),
            ("cylinders", 10, Kind::Message(".foxglove.CylinderPrimitive"), MANY),
            ("lines", 11, Kind::Message(".foxglove.LinePrimitive"), MANY),
            ("triangles", 12, Kind::Message(".foxglove.TriangleListPrimitive"), MANY),
            ("texts", 13, Kind::Message(".foxglove.TextPrimitive"), MANY),
            ("models", 14, Kind::Message(".foxglove.ModelPrimitive"), MANY),
        ],
    ),
    Message("Vector2", &[], &[("x", 1, Kind::Double, ONE), ("y", 2, Kind::Double, ONE)]),
    Message(
        "PackedElementField",
        &["UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"],
        &[
            ("name", 1, Kind::Text, ONE),
            ("offset", 2, Kind::Fixed32, ONE),
            ("type", 3, Kind::Choice("NumericType"), ONE),
        ],
    ),
    Message(
        "Grid",
        &[],
        &[
            ("timestamp", 1, STAMP, ONE),
            ("frame_id", 2, Kind::Text, ONE),
            ("pose", 3, POSE, ONE),
            ("column_count", 4, Kind::Fixed32, ONE),
            ("cell_size", 5, Kind::Message(".foxglove.Vector2"), ONE),
            ("row_stride", 6, Kind::Fixed32, ONE),
            ("cell_stride", 7, Kind::Fixed32, ONE),
            ("fields", 8, Kind::Message(".foxglove.PackedElementField"), MANY),
            ("data", 9, Kind::Bytes, ONE),
        ],
    ),
    Message(
        "SceneUpdate",
        &[],
        &[
            ("deletions", 1, Kind::Message(".foxglove.SceneEntityDeletion"), MANY),
            ("entities", 2, Kind::Message(".foxglove.SceneEntity"), MANY),
        ],
    ),
];

/// The messages of package `google.protobuf` within those.
const GOOGLE: &[(&str, Message)] = &[
    (
        "google/protobuf/timestamp.proto",
        Message("Timestamp", &[], &[("seconds", 1, Kind::Int64, ONE), ("nanos", 2, Kind::Int32, ONE)]),
    ),
    (
        "google/protobuf/duration.proto",
        Message("Duration", &[], &[("seconds", 1, Kind::Int64, ONE), ("nanos", 2, Kind::Int32, ONE)]),
    ),
];

/// The description of a message of package `foxglove` and of all that is within it, as a `FileDescriptorSet`.
pub(super) fn description(name: &str) -> Vec<u8> {
    let used = within(name);
    let uses = |message: &Message| used.contains(&message.0);
    let google = || GOOGLE.iter().filter(|(_, message)| uses(message));
    let mut set = Proto::default();
    for (file, described) in google() {
        set.message(1, |out| {
            out.text(1, file);
            out.text(2, "google.protobuf");
            message(out, described);
            out.text(12, "proto3");
        });
    }
    set.message(1, |out| {
        out.text(1, &format!("foxglove/{name}.proto"));
        out.text(2, "foxglove");
        google().for_each(|(file, _)| out.text(3, file));
        FOXGLOVE.iter().filter(|message| uses(message)).for_each(|described| message(out, described));
        out.text(12, "proto3");
    });
    set.0
}

/// Names of the messages within one, and its own.
fn within(name: &str) -> Vec<&str> {
    let mut used = vec![name];
    let mut next = 0;
    while let Some(name) = used.get(next).copied() {
        let fields = FOXGLOVE.iter().find(|message| message.0 == name).map_or(&[][..], |message| message.2);
        for (_, _, kind, _) in fields {
            let Kind::Message(full) = kind else { continue };
            let short = full.rsplit('.').next().unwrap_or(full);
            if !used.contains(&short) {
                used.push(short);
            }
        }
        next += 1;
    }
    used
}

/// A `DescriptorProto`, as a message of a file.
fn message(out: &mut Proto, Message(name, choices, fields): &Message) {
    out.message(4, |out| {
        out.text(1, name);
        for (field, number, kind, many) in *fields {
            let (code, refers) = match kind {
                Kind::Double => (1, None),
                Kind::Int64 => (3, None),
                Kind::Int32 => (5, None),
                Kind::Fixed32 => (7, None),
                Kind::Bool => (8, None),
                Kind::Text => (9, None),
                Kind::Message(full) => (11, Some((*full).to_owned())),
                Kind::Bytes => (12, None),
                Kind::Choice(choice) => (14, Some(format!(".foxglove.{name}.{choice}"))),
            };
            out.message(2, |out| {
                out.text(1, field);
                out.number(3, u64::from(*number));
                out.number(4, if *many { 3 } else { 1 });
                out.number(5, code);
                out.text(6, refers.as_deref().unwrap_or(""));
            });
        }
        let chosen =
            fields.iter().find_map(|(_, _, kind, _)| if let Kind::Choice(choice) = kind { Some(choice) } else { None });
        if let Some(choice) = chosen {
            out.message(4, |out| {
                out.text(1, choice);
                for (number, value) in (0_u64..).zip(*choices) {
                    out.message(2, |out| {
                        out.text(1, value);
                        out.number(2, number);
                    });
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_written_as_the_standard_has_it() {
        // The examples of the encoding guide: 150 as field 1, "testing" as field 2, and a message within as field 3.
        let mut out = Proto::default();
        out.number(1, 150);
        out.text(2, "testing");
        out.message(3, |out| out.number(1, 150));
        let mut expected = vec![0x08, 0x96, 0x01, 0x12, 0x07];
        expected.extend(b"testing");
        expected.extend([0x1a, 0x03, 0x08, 0x96, 0x01]);
        assert_eq!(out.bytes(), expected);
        out.clear();
        assert!(out.is_empty());
        out.double(1, 1.0);
        out.double(2, 0.0);
        assert_eq!(out.bytes(), [0x09, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    }

    #[test]
    fn a_long_message_within_has_a_long_length() {
        for len in [0, 1, 127, 128, 129, 16_383, 16_384, 70_000_usize] {
            let text = "x".repeat(len);
            let mut out = Proto::default();
            out.message(1, |out| out.0.extend_from_slice(text.as_bytes()));
            let mut expected = Proto::default();
            expected.tag(1, COUNTED);
            expected.varint(len as u64);
            expected.0.extend_from_slice(text.as_bytes());
            assert_eq!(out.bytes(), expected.bytes(), "{len}");
        }
    }

    #[test]
    fn every_message_within_is_described_and_no_number_is_given_twice() {
        for Message(name, choices, fields) in FOXGLOVE {
            let mut numbers: Vec<u32> = fields.iter().map(|(_, number, _, _)| *number).collect();
            numbers.dedup();
            assert_eq!(numbers.len(), fields.len(), "{name}");
            for (field, _, kind, _) in *fields {
                match kind {
                    Kind::Message(full) => {
                        let known = FOXGLOVE.iter().any(|other| *full == format!(".foxglove.{}", other.0))
                            || GOOGLE.iter().any(|(_, other)| *full == format!(".google.protobuf.{}", other.0));
                        assert!(known, "{name}.{field}: {full}");
                    }
                    Kind::Choice(_) => assert!(!choices.is_empty(), "{name}.{field}"),
                    Kind::Double
                    | Kind::Int64
                    | Kind::Int32
                    | Kind::Fixed32
                    | Kind::Bool
                    | Kind::Text
                    | Kind::Bytes => {}
                }
            }
        }
        let found = within("FrameTransforms");
        assert!(
            found.contains(&"Quaternion") && found.contains(&"Timestamp") && !found.contains(&"Color"),
            "{found:?}"
        );
        assert!(description("SceneUpdate").len() > description("PoseInFrame").len());
    }
}
