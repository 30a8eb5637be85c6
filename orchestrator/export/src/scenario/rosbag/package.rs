//! The package around a bag: manifest, build file and launch file of ROS 2.

/// Plays the bag beside map server and route server.
pub(super) fn launch(name: &str) -> String {
    let package = package_name(name);
    format!(
        r#"import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

# The bag has map, clock, transforms, scan and people; the servers give its map and its route graph to Nav2.


def generate_launch_description():
    share = get_package_share_directory("{package}")
    simulated = {{"use_sim_time": True}}
    served = ["map_server", "route_server"]
    return LaunchDescription([
        ExecuteProcess(cmd=["ros2", "bag", "play", os.path.join(share, "bag"), "--exclude-topics", "/map"]),
        Node(package="nav2_map_server", executable="map_server", name="map_server",
             parameters=[{{"yaml_filename": os.path.join(share, "maps", "map.yaml")}}, simulated]),
        Node(package="nav2_route", executable="route_server", name="route_server",
             parameters=[{{"graph_filepath": os.path.join(share, "route", "graph.geojson")}}, simulated]),
        Node(package="nav2_lifecycle_manager", executable="lifecycle_manager", name="lifecycle_manager",
             parameters=[{{"autostart": True, "node_names": served}}, simulated]),
    ])
"#
    )
}

pub(super) fn manifest(name: &str) -> String {
    let depends = ["launch_ros", "nav2_lifecycle_manager", "nav2_map_server", "nav2_route", "rosbag2_storage_mcap"];
    let lines: String = depends.iter().map(|on| format!("  <exec_depend>{on}</exec_depend>\n")).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<package format=\"3\">\n  <name>{}</name>\n  <version>1.0.0</version>\n  \
         <description>A scenario of SocRATES as a bag</description>\n  <maintainer email=\"nobody@example.org\">nobody</maintainer>\n  \
         <license>Apache-2.0</license>\n  <buildtool_depend>ament_cmake</buildtool_depend>\n{lines}  <export>\n    \
         <build_type>ament_cmake</build_type>\n  </export>\n</package>\n",
        package_name(name)
    )
}

pub(super) fn cmake(name: &str) -> String {
    format!(
        "cmake_minimum_required(VERSION 3.8)\nproject({})\nfind_package(ament_cmake REQUIRED)\n\
         install(DIRECTORY bag config launch maps route DESTINATION share/${{PROJECT_NAME}})\nament_package()\n",
        package_name(name)
    )
}

/// Names of packages are lower-case and begin with a letter (REP 144).
pub(super) fn package_name(name: &str) -> String {
    let small = name.to_ascii_lowercase();
    if small.starts_with(|letter: char| letter.is_ascii_lowercase()) { small } else { format!("s_{small}") }
}
