//! The launch file of a kit.

/// Starts loader, world generator, Gazebo and agent manager, each when the one before has had its time.
pub(super) fn launch(name: &str, base: &str) -> String {
    format!(
        r#"import os

from launch import LaunchDescription
from launch.actions import ExecuteProcess, TimerAction
from launch_ros.actions import Node

KIT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def generate_launch_description():
    loader = Node(
        package="hunav_agent_manager",
        executable="hunav_loader",
        output="screen",
        parameters=[os.path.join(KIT, "config", "{base}.yaml")],
    )
    generator = Node(
        package="hunav_gazebo_wrapper",
        executable="hunav_gazebo_world_generator",
        output="screen",
        parameters=[
            {{
                "base_world": os.path.join(KIT, "worlds", "{name}.world"),
                "use_gazebo_obs": True,
                "update_rate": 100.0,
                "robot_name": "robot",
                "global_frame_to_publish": "map",
                "use_navgoal_to_start": False,
                "navgoal_topic": "goal_pose",
                "ignore_models": "ground_plane robot",
            }}
        ],
    )
    world = os.path.join(KIT, "worlds", "generatedWorld.world")
    server = ExecuteProcess(
        cmd=["gzserver", world, "-s", "libgazebo_ros_init.so", "-s", "libgazebo_ros_factory.so"],
        output="screen",
    )
    client = ExecuteProcess(cmd=["gzclient"], output="screen")
    manager = Node(package="hunav_agent_manager", executable="hunav_agent_manager", output="screen")
    return LaunchDescription(
        [
            loader,
            TimerAction(period=2.0, actions=[generator]),
            TimerAction(period=4.0, actions=[server, client, manager]),
        ]
    )
"#
    )
}
