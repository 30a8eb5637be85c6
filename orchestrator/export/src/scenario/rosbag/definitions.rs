//! Definitions of the messages of a bag, as ROS 2 and HuNavSim 1.0 have them.

use std::collections::BTreeSet;

/// Types and the lines of their definitions.
const TYPES: [(&str, &str); 24] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose"),
    ("geometry_msgs/PoseArray", "std_msgs/Header header\ngeometry_msgs/Pose[] poses"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms"),
    ("rosgraph_msgs/Clock", "builtin_interfaces/Time clock"),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist",
    ),
    (
        "nav_msgs/MapMetaData",
        "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin",
    ),
    ("nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data"),
    ("nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses"),
    (
        "sensor_msgs/LaserScan",
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n\
         float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities",
    ),
    (
        "people_msgs/Person",
        "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point velocity\nfloat64 reliability\nstring[] tagnames\n\
         string[] tags",
    ),
    ("people_msgs/People", "std_msgs/Header header\npeople_msgs/Person[] people"),
    (
        "hunav_msgs/Agent",
        "uint8 PERSON=1\nuint8 ROBOT=2\nuint8 OTHER=3\nuint8 BEH_REGULAR=1\nint32 id\nuint8 type\nuint8 skin\n\
         uint8 behavior\nstring name\nuint8 behavior_state\nint8 group_id\ngeometry_msgs/Pose position\nfloat32 yaw\n\
         geometry_msgs/Twist velocity\nfloat32 desired_velocity\nfloat32 radius\nfloat32 linear_vel\nfloat32 angular_vel\n\
         geometry_msgs/Pose[] goals\nbool cyclic_goals\nfloat32 goal_radius\ngeometry_msgs/Point[] closest_obs",
    ),
    ("hunav_msgs/Agents", "std_msgs/Header header\nhunav_msgs/Agent[] agents"),
];

/// The definition of a type (`nav_msgs/Odometry`) with those of all that it is made of, as the encoding `ros2msg` has it.
pub(super) fn definition(kind: &str) -> String {
    let mut text = lines(kind).to_owned();
    text.push('\n');
    let mut open: Vec<&str> = parts(lines(kind));
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    while let Some(next) = open.pop() {
        if seen.insert(next) {
            text.push_str(&format!("{}\nMSG: {next}\n{}\n", "=".repeat(80), lines(next)));
            open.extend(parts(lines(next)));
        }
    }
    text
}

fn lines(kind: &str) -> &'static str {
    TYPES.iter().find(|(name, _)| *name == kind).map_or("", |(_, lines)| lines)
}

/// The types that the lines of a definition name.
fn parts(lines: &str) -> Vec<&str> {
    let of_line = |line: &'_ str| line.split(' ').next().and_then(|kind| kind.split('[').next()).map(str::len);
    lines.lines().filter_map(|line| line.get(..of_line(line)?)).filter(|kind| kind.contains('/')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_holds_every_type_that_it_names_once() {
        for (kind, lines) in TYPES {
            let text = definition(kind);
            for part in parts(lines) {
                assert_eq!(text.matches(&format!("MSG: {part}\n")).count(), 1, "{kind}: {part}\n{text}");
            }
        }
        assert_eq!(definition("nav_msgs/Odometry").matches("MSG: ").count(), 9);
    }
}
