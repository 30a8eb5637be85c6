//! The messages of package `foxglove` as a table, and their description for a reader that does not know them.
//!
//! They are few and fixed: with a table the bytes depend on no library's version.

use std::collections::BTreeSet;

use super::proto::Proto;

/// Messages of package `google.protobuf`.
const GOOGLE: [&str; 2] = ["Timestamp", "Duration"];

/// The messages that recordings and live views hold, and those within them: the name, then the fields in order of their
/// numbers, from 1. A star is for several, a question mark for one that may be absent; an enumeration
/// has its values, from 0.
const MESSAGES: &[&str] = &[
    "Timestamp seconds:int64 nanos:int32",
    "Duration seconds:int64 nanos:int32",
    "Vector3 x:double y:double z:double",
    "Point3 x:double y:double z:double",
    "Quaternion x:double y:double z:double w:double",
    "Color r:double g:double b:double a:double",
    "Pose position:Vector3 orientation:Quaternion",
    "FrameTransform timestamp:Timestamp parent_frame_id:string child_frame_id:string translation:Vector3 \
     rotation:Quaternion",
    "FrameTransforms transforms:FrameTransform*",
    "PoseInFrame timestamp:Timestamp frame_id:string pose:Pose",
    "PosesInFrame timestamp:Timestamp frame_id:string poses:Pose*",
    "KeyValuePair key:string value:string",
    "ArrowPrimitive pose:Pose shaft_length:double shaft_diameter:double head_length:double \
     head_diameter:double color:Color",
    "CubePrimitive pose:Pose size:Vector3 color:Color",
    "SpherePrimitive pose:Pose size:Vector3 color:Color",
    "CylinderPrimitive pose:Pose size:Vector3 bottom_scale:double top_scale:double color:Color",
    "LinePrimitive type:Type=LINE_STRIP|LINE_LOOP|LINE_LIST pose:Pose thickness:double scale_invariant:bool \
     points:Point3* color:Color colors:Color* indices:fixed32*",
    "TriangleListPrimitive pose:Pose points:Point3* color:Color colors:Color* indices:fixed32*",
    "TextPrimitive pose:Pose billboard:bool font_size:double scale_invariant:bool color:Color text:string",
    "ModelPrimitive pose:Pose scale:Vector3 color:Color override_color:bool url:string media_type:string data:bytes",
    "SceneEntityDeletion timestamp:Timestamp type:Type=MATCHING_ID|ALL id:string",
    "SceneEntity timestamp:Timestamp frame_id:string id:string lifetime:Duration frame_locked:bool \
     metadata:KeyValuePair* arrows:ArrowPrimitive* cubes:CubePrimitive* spheres:SpherePrimitive* \
     cylinders:CylinderPrimitive* lines:LinePrimitive* triangles:TriangleListPrimitive* texts:TextPrimitive* \
     models:ModelPrimitive*",
    "Vector2 x:double y:double",
    "PackedElementField name:string offset:fixed32 \
     type:NumericType=UNKNOWN|UINT8|INT8|UINT16|INT16|UINT32|INT32|FLOAT32|FLOAT64",
    "Grid timestamp:Timestamp frame_id:string pose:Pose column_count:fixed32 cell_size:Vector2 row_stride:fixed32 \
     cell_stride:fixed32 fields:PackedElementField* data:bytes",
    "SceneUpdate deletions:SceneEntityDeletion* entities:SceneEntity*",
    "PointCloud timestamp:Timestamp frame_id:string pose:Pose point_stride:fixed32 fields:PackedElementField* \
     data:bytes",
    "LaserScan timestamp:Timestamp frame_id:string pose:Pose start_angle:double end_angle:double ranges:double* \
     intensities:double*",
    "Odometry timestamp:Timestamp frame_id:string body_frame_id:string pose:Pose linear_velocity:Vector3? \
     angular_velocity:Vector3? pose_covariance:double* velocity_covariance:double* metadata:KeyValuePair*",
    "Log timestamp:Timestamp level:Level=UNKNOWN|DEBUG|INFO|WARNING|ERROR|FATAL message:string name:string file:string \
     line:fixed32",
];

/// Types of fields beside messages and enumerations, with the numbers that descriptors give them.
const SCALARS: [(&str, u64); 7] =
    [("double", 1), ("int64", 3), ("int32", 5), ("fixed32", 7), ("bool", 8), ("string", 9), ("bytes", 12)];

/// Type of a field.
enum Kind {
    /// Its number.
    Scalar(u64),
    /// Its name.
    Message(&'static str),
    /// Its name, and its values.
    Enumeration(&'static str, &'static str),
}

/// One field: its name, its type, and its mark.
struct FieldRow(&'static str, Kind, &'static str);

/// The name of a message of the table.
fn name_of(message: &'static str) -> &'static str {
    message.split(' ').next().unwrap_or_default()
}

fn fields(message: &'static str) -> impl Iterator<Item = FieldRow> {
    message.split(' ').filter_map(|field| field.split_once(':')).map(|(name, kind)| {
        let single = kind.trim_end_matches(['*', '?']);
        let scalar = SCALARS.iter().find(|(name, _)| *name == single).map(|(_, number)| Kind::Scalar(*number));
        let choice = single.split_once('=').map(|(name, values)| Kind::Enumeration(name, values));
        FieldRow(
            name,
            scalar.or(choice).unwrap_or(Kind::Message(single)),
            kind.strip_prefix(single).unwrap_or_default(),
        )
    })
}

/// The messages that the fields of a message hold, in order of their files.
fn inner(message: &'static str) -> BTreeSet<(bool, &'static str)> {
    let messages =
        fields(message).filter_map(|field| if let Kind::Message(name) = field.1 { Some(name) } else { None });
    messages.map(|name| (is_google(name), name)).collect()
}

/// A message after all that are within it.
fn with_inner(name: &str) -> Vec<&'static str> {
    fn add(name: &str, found: &mut Vec<&'static str>) {
        let of_name = MESSAGES.iter().find(|message| name_of(message) == name);
        if let Some(message) = of_name.filter(|message| !found.contains(message)) {
            inner(message).into_iter().for_each(|(_, name)| add(name, found));
            found.push(message);
        }
    }
    let mut found = Vec::new();
    add(name, &mut found);
    found
}

fn is_google(name: &str) -> bool {
    GOOGLE.contains(&name)
}

fn package(name: &str) -> &'static str {
    if is_google(name) { "google.protobuf" } else { "foxglove" }
}

/// The file that declares a message.
fn path(name: &str) -> String {
    let file = if is_google(name) { name.to_lowercase() } else { name.to_owned() };
    format!("{}/{file}.proto", package(name).replace('.', "/"))
}

/// The description of a message, such as `Grid`, and of all that is within it, as a `FileDescriptorSet` for recordings:
/// one file for all of package `foxglove`.
pub(crate) fn description(name: &str) -> Vec<u8> {
    let used = with_inner(name);
    let used = MESSAGES.iter().copied().filter(|message| used.contains(message));
    let (google, own): (Vec<&str>, Vec<&str>) = used.partition(|message| is_google(name_of(message)));
    let imports: Vec<&str> = google.iter().map(|message| name_of(message)).collect();
    let mut set = Proto::default();
    for message in google {
        file(&mut set, name_of(message), &[], &[message], false);
    }
    file(&mut set, name, &imports, &own, false);
    set.into_bytes()
}

/// The description of a message by its full name, such as `foxglove.Grid`, byte by byte as Foxglove's own library has
/// it: one file a message, with the names that fields have in JSON.
#[must_use]
pub fn description_by_files(name: &str) -> Vec<u8> {
    let mut set = Proto::default();
    for message in with_inner(name.trim_start_matches("foxglove.")) {
        let imports: Vec<&str> = inner(message).into_iter().map(|(_, name)| name).collect();
        file(&mut set, name_of(message), &imports, &[message], true);
    }
    set.into_bytes()
}

/// A `FileDescriptorProto`; `is_full` with the names in JSON and the options of Google's files.
fn file(set: &mut Proto, name: &str, imports: &[&str], messages: &[&'static str], is_full: bool) {
    set.message(1, |out| {
        out.text(1, &path(name));
        out.text(2, package(name));
        imports.iter().for_each(|name| out.text(3, &path(name)));
        messages.iter().for_each(|message| descriptor(out, message, is_full));
        if is_full && is_google(name) {
            out.message(8, |out| {
                out.text(1, "com.google.protobuf");
                out.text(8, &format!("{name}Proto"));
                out.number(10, 1);
                out.text(11, &format!("google.golang.org/protobuf/types/known/{}pb", name.to_lowercase()));
                out.number(31, 1);
                out.text(36, "GPB");
                out.text(37, "Google.Protobuf.WellKnownTypes");
            });
        }
        out.text(12, "proto3");
    });
}

/// A `DescriptorProto`, as a message of a file.
fn descriptor(out: &mut Proto, message: &'static str, is_full: bool) {
    out.message(4, |out| {
        out.text(1, name_of(message));
        let mut absent = Vec::new();
        for (number, FieldRow(name, kind, mark)) in (1..).zip(fields(message)) {
            let (kind, refers_to) = match kind {
                Kind::Scalar(kind) => (kind, String::new()),
                Kind::Message(name) => (11, format!(".{}.{name}", package(name))),
                Kind::Enumeration(name, _) => (14, format!(".foxglove.{}.{name}", name_of(message))),
            };
            out.message(2, |out| {
                out.text(1, name);
                out.number(3, number);
                out.number(4, if mark == "*" { 3 } else { 1 });
                out.number(5, kind);
                out.text(6, &refers_to);
                if mark == "?" {
                    out.present(9, absent.len() as u64);
                }
                out.text(10, &if is_full { in_json(name) } else { String::new() });
                out.number(17, u64::from(mark == "?"));
            });
            absent.extend((mark == "?").then(|| format!("_{name}")));
        }
        for FieldRow(_, kind, _) in fields(message) {
            let Kind::Enumeration(name, values) = kind else { continue };
            out.message(4, |out| {
                out.text(1, name);
                for (number, value) in (0..).zip(values.split('|')) {
                    out.message(2, |out| {
                        out.text(1, value);
                        if is_full { out.present(2, number) } else { out.number(2, number) }
                    });
                }
            });
        }
        absent.iter().for_each(|name| out.message(8, |out| out.text(1, name)));
    });
}

/// The name of a field in JSON: `frameId` of `frame_id`.
fn in_json(name: &str) -> String {
    let words = name.split('_').enumerate();
    let word = |(place, word): (usize, &str)| {
        let (initial, rest) = word.split_at(word.len().min(usize::from(place > 0)));
        initial.to_uppercase() + rest
    };
    words.map(word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_within_is_described_after_what_it_holds() {
        for message in MESSAGES {
            for FieldRow(field, kind, _) in fields(message) {
                let Kind::Message(name) = kind else { continue };
                assert!(MESSAGES.iter().any(|other| name_of(other) == name), "{message}: {field}");
            }
        }
        let found: Vec<&str> = with_inner("FrameTransforms").into_iter().map(name_of).collect();
        assert_eq!(found, ["Quaternion", "Vector3", "Timestamp", "FrameTransform", "FrameTransforms"]);
        assert!(description("SceneUpdate").len() > description("PoseInFrame").len());
    }
}
