"""Writes bags of ROS 2 of a motion that can be computed by hand, with rosbags 0.11 (PyPI), which is not ours.

    python3 bag.py FOLDER KIND [OPTION ...]

The robot goes 0.5 m/s along x of `odom` for 12 s and stands for 2 s. `odom` stands in `map` at (2, 1), turned by 90 degrees, so that
the robot goes along y of `map`, from (2, 1) to (2, 7). `ann` goes from (3, 9) of `map` along -y at 0.8 m/s; `bob` stands at (0.5, 4).

KIND   people   /odom, /tf, /people in the camera's optical frame, /goal_pose twice, a string that nobody needs
       hunav1   HuNavSim 1.0: /robot_states, /human_states, /people, /odom, by the clock of a simulator at half speed
       hunav2   the same with the agents of HuNavSim 1.1
       poses    /tf alone for the robot, /tracker/people (PoseArray) in `odom`, and one PoseStamped each beside it
OPTION zstd, lz4 (by the package mcap), sqlite3, big (big-endian messages), short (2 s), message (messages compressed one by one)

`walk.mcap` beside this file is `people zstd`, `hunav.mcap` is `hunav1 short`.
"""
import math
import sys
from pathlib import Path

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PERSON = "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point velocity\nfloat64 reliability\nstring[] tagnames\nstring[] tags\n"
PEOPLE = "std_msgs/Header header\npeople_msgs/Person[] people\n"
AGENT1 = """uint8 PERSON=1
uint8 ROBOT=2
int32 id
uint8 type
uint8 skin
uint8 behavior
string name
uint8 behavior_state
int8 group_id
geometry_msgs/Pose position
float32 yaw
geometry_msgs/Twist velocity
float32 desired_velocity
float32 radius
float32 linear_vel
float32 angular_vel
geometry_msgs/Pose[] goals
bool cyclic_goals
float32 goal_radius
geometry_msgs/Point[] closest_obs
"""
AGENT2 = """int32 id
uint8 type
uint8 skin
string name
int8 group_id
geometry_msgs/Pose position
float32 yaw
geometry_msgs/Twist velocity
float32 desired_velocity
float32 radius
float32 linear_vel
float32 angular_vel
hunav_msgs/AgentBehavior behavior
geometry_msgs/Pose[] goals
bool cyclic_goals
float32 goal_radius
geometry_msgs/Point[] closest_obs
"""
BEHAVIOR = """uint8 type
uint8 state
uint8 configuration
float32 duration
bool once
float32 vel
float32 dist
float32 social_force_factor
float32 goal_force_factor
float32 obstacle_force_factor
float32 other_force_factor
"""
AGENTS = "std_msgs/Header header\nhunav_msgs/Agent[] agents\n"
# RIHS01 of the packages as they are published; a definition that is not theirs has another.
HASHES = {
    "people_msgs/msg/Person": "434c04a421c02370b4e2322c2a4201bebb3e32545e0145199743678ab9ce0fa0",
    "people_msgs/msg/People": "9ea98a5e58f833a9532957bca23a6b8006a12885d5a16c8ca41dd901d10c33b6",
}
AGENT_HASHES = {
    "hunav1": "2b4cb129e48203394c9eb092800f7dd302a0569158c9fa6a12281132912bfa48",
    "hunav2": "83663a582401b155043277cb39f4dcb59f7734960042612cbe292f6589490260",
}

folder, kind, options = Path(sys.argv[1]), sys.argv[2], set(sys.argv[3:])
store = get_typestore(Stores.ROS2_JAZZY)
types = {}
for text, name in [(PERSON, "people_msgs/msg/Person"), (PEOPLE, "people_msgs/msg/People"), (BEHAVIOR, "hunav_msgs/msg/AgentBehavior"),
                   (AGENT2 if kind == "hunav2" else AGENT1, "hunav_msgs/msg/Agent"), (AGENTS, "hunav_msgs/msg/Agents")]:
    types.update(get_types_from_msg(text, name))
store.register(types)
hashes = dict(HASHES)
if kind in AGENT_HASHES:
    hashes["hunav_msgs/msg/Agent"] = AGENT_HASHES[kind]
for name, wanted in hashes.items():
    assert store.hash_rihs01(name) == "RIHS01_" + wanted, name
T = store.types


def make(name, /, **fields):
    return T[name](**fields)


def point(x, y, z=0.0):
    return make("geometry_msgs/msg/Point", x=x, y=y, z=z)


def vector(x, y, z=0.0):
    return make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def turn(yaw):
    return make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def pose(x, y, yaw=0.0):
    return make("geometry_msgs/msg/Pose", position=point(x, y), orientation=turn(yaw))


def twist():
    return make("geometry_msgs/msg/Twist", linear=vector(0.0, 0.0), angular=vector(0.0, 0.0))


def header(nanos, frame):
    stamp = make("builtin_interfaces/msg/Time", sec=nanos // 10**9, nanosec=nanos % 10**9)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def transform(nanos, parent, child, x, y, quaternion, z=0.0):
    inner = make("geometry_msgs/msg/Transform", translation=vector(x, y, z), rotation=quaternion)
    return make("geometry_msgs/msg/TransformStamped", header=header(nanos, parent), child_frame_id=child, transform=inner)


def agent(number, name, kind_of, x, y, yaw, group, radius, goals=()):
    same = dict(id=number, type=kind_of, skin=0, name=name, group_id=group, position=pose(x, y, yaw), yaw=yaw, velocity=twist(),
                desired_velocity=0.8, radius=radius, linear_vel=0.5, angular_vel=0.0, goals=[pose(*goal) for goal in goals],
                cyclic_goals=False, goal_radius=0.3, closest_obs=[point(1.0, 1.0)] * 3)
    if kind == "hunav2":
        behavior = make("hunav_msgs/msg/AgentBehavior", type=1, state=0, configuration=0, duration=40.0, once=True, vel=0.6, dist=0.0,
                        social_force_factor=5.0, goal_force_factor=2.0, obstacle_force_factor=10.0, other_force_factor=20.0)
        return make("hunav_msgs/msg/Agent", behavior=behavior, **same)
    return make("hunav_msgs/msg/Agent", behavior=1, behavior_state=0, **same)


storage = StoragePlugin.SQLITE3 if "sqlite3" in options else StoragePlugin.MCAP
writer = Writer(folder, version=9, storage_plugin=storage)
if "zstd" in options:
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
if "message" in options:
    writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
WALL = 1_760_000_000 * 10**9
topics = {}
written = []


def send(topic, name, nanos, message):
    if topic not in topics:
        topics[topic] = writer.add_connection(topic, name, typestore=store)
    data = bytes(store.serialize_cdr(message, name, little_endian="big" not in options))
    writer.write(topics[topic], nanos, data)
    written.append((topic, name, nanos, data))


with writer:
    import numpy

    for k in range(21 if "short" in options else 141):
        t = k / 10
        is_simulated = kind.startswith("hunav")
        # A simulator counts from its own begin, and runs at half the speed of the recorder's clock.
        stamp = 5 * 10**9 + k * 10**8 if is_simulated else WALL + k * 10**8
        log = WALL + (2 if is_simulated else 1) * k * 10**8 + 2 * 10**6
        ahead = min(0.5 * t, 6.0)
        ann, bob = (3.0, 9.0 - 0.8 * t), (0.5, 4.0)
        in_odom = [(y - 1.0, -(x - 2.0)) for x, y in (ann, bob)]
        if k == 0 and kind != "poses":
            forward = make("geometry_msgs/msg/Quaternion", x=-0.5, y=0.5, z=-0.5, w=0.5)
            fixed = [transform(0, "base_footprint", "base_link", 0.0, 0.0, turn(0.0), 0.1),
                     transform(0, "base_link", "camera_optical", 0.2, 0.0, forward, 1.0)]
            send("/tf_static", "tf2_msgs/msg/TFMessage", log, make("tf2_msgs/msg/TFMessage", transforms=fixed))
        moving = [transform(stamp, "odom", "base_footprint", ahead, 0.0, turn(0.0)),
                  transform(stamp, "map", "odom", 2.0, 1.0, turn(math.pi / 2))]
        send("/tf", "tf2_msgs/msg/TFMessage", log, make("tf2_msgs/msg/TFMessage", transforms=moving))
        if kind != "poses":
            none = numpy.zeros(36)
            odometry = make("nav_msgs/msg/Odometry", header=header(stamp, "odom"), child_frame_id="base_footprint",
                            pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose(ahead, 0.0), covariance=none),
                            twist=make("geometry_msgs/msg/TwistWithCovariance", twist=twist(), covariance=none))
            send("/odom", "nav_msgs/msg/Odometry", log, odometry)
        if kind == "people":
            # Optical: x to the right, y down, z ahead of a camera 0.2 m before the robot's middle and 1.1 m above the floor.
            seen = [(-y, 0.1, x - ahead - 0.2) for x, y in in_odom]
        else:
            seen = [(*ann, 0.0), (*bob, 0.0)]
        if kind != "poses":
            people = [make("people_msgs/msg/Person", name=name, position=point(*at), velocity=point(0.0, 0.0), reliability=0.9,
                           tagnames=["id", "kind"], tags=["7", "adult"]) for name, at in zip(("ann", "bob"), seen)]
            frame = "camera_optical" if kind == "people" else "map"
            message = make("people_msgs/msg/People", header=header(stamp, frame), people=people)
            send("/people", "people_msgs/msg/People", log, message)
        if kind == "people":
            send("/chatter", "std_msgs/msg/String", log, make("std_msgs/msg/String", data="nobody needs this"))
            if k in (0, 10):
                goal = make("geometry_msgs/msg/PoseStamped", header=header(stamp, "map"), pose=pose(2.0, 7.0 if k else 3.0, math.pi / 2))
                send("/goal_pose", "geometry_msgs/msg/PoseStamped", log, goal)
        if is_simulated:
            agents = [agent(1, "ann", 1, *ann, -math.pi / 2, 1, 0.35), agent(2, "bob", 1, *bob, 0.0, 1, 0.4),
                      agent(0, "robot", 2, 2.0, 1.0 + ahead, 0.0, -1, 0.3)]
            message = make("hunav_msgs/msg/Agents", header=header(stamp, "map"), agents=agents)
            send("/human_states", "hunav_msgs/msg/Agents", log, message)
            robot = agent(0, "robot", 2, 2.0, 1.0 + ahead, math.pi / 2, -1, 0.3, [(2.0, 7.0)])
            send("/robot_states", "hunav_msgs/msg/Agent", log, robot)
        if kind == "poses":
            array = make("geometry_msgs/msg/PoseArray", header=header(stamp, "odom"), poses=[pose(*at) for at in in_odom])
            send("/tracker/people", "geometry_msgs/msg/PoseArray", log, array)
            for name, at in (("human_7", ann), ("human_8", bob)):
                stamped = make("geometry_msgs/msg/PoseStamped", header=header(stamp, "map"), pose=pose(*at))
                send(f"/mocap/{name}/pose", "geometry_msgs/msg/PoseStamped", log, stamped)

if "lz4" in options:
    from mcap.writer import CompressionType, Writer as McapWriter

    for path in folder.glob("*.mcap"):
        with path.open("wb") as file:
            lz4 = McapWriter(file, compression=CompressionType.LZ4, chunk_size=50_000)
            lz4.start(profile="ros2", library="mcap of PyPI")
            channels = {}
            for topic, name, nanos, data in written:
                if topic not in channels:
                    definition, _ = store.generate_msgdef(name, ros_version=2)
                    schema = lz4.register_schema(name=name, encoding="ros2msg", data=definition.encode())
                    channels[topic] = lz4.register_channel(topic=topic, message_encoding="cdr", schema_id=schema)
                lz4.add_message(channel_id=channels[topic], log_time=nanos, publish_time=nanos, data=data)
            lz4.finish()
