"""An exported bag, read by two readers of ROS 2 bags, beside the table of the run.

Arguments: folder of the bag, and the table (t, id, x, y) of the run. Prints an object: how many positions were compared and the largest
distance in meters, topics, and how many messages each reader found.
"""

import csv, glob, json, math, pathlib, sys
from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader

folder, table = sys.argv[1:]
run = {}
for row in csv.DictReader(open(table)):
    if row["leaf"] != "absent":
        run[(round(float(row["t"]) * 100), row["id"])] = (float(row["x"]), float(row["y"]))

found, counts, scans, cells = {}, {}, [], None
tick = lambda stamp: round((stamp.sec - 1 + stamp.nanosec / 1e9) * 100)
with AnyReader([pathlib.Path(folder)]) as reader:
    for connection, stamp, raw in reader.messages():
        message = reader.deserialize(raw, connection.msgtype)
        counts[connection.topic] = counts.get(connection.topic, 0) + 1
        if connection.topic == "/odom":
            at = message.pose.pose.position
            found[(tick(message.header.stamp), "robot")] = (at.x, at.y)
            assert abs(stamp - message.header.stamp.sec * 10**9 - message.header.stamp.nanosec) == 0
        elif connection.topic == "/human_states":
            for agent in message.agents:
                found[(tick(message.header.stamp), agent.name)] = (agent.position.position.x, agent.position.position.y)
                assert agent.radius > 0 and agent.type == 1
        elif connection.topic == "/scan":
            scans.append([float(value) for value in message.ranges if math.isfinite(value)])
            assert len(message.ranges) == 360
        elif connection.topic == "/map":
            cells = (message.info.width * message.info.height, len(message.data), int((message.data == 100).sum()))
(mcap,) = glob.glob(f"{folder}/*.mcap")
others = sum(1 for _ in read_ros2_messages(mcap))
wanted = {key for key in run if key[0] % 10 == 0}
seen = {key: at for key, at in found.items() if key[0] % 10 == 0}
assert set(seen) == wanted, (len(seen), len(wanted), sorted(set(seen) ^ wanted)[:5])
print(json.dumps({"positions": len(seen), "off": max(math.dist(at, run[key]) for key, at in seen.items()),
                  "topics": sorted(counts), "messages": sum(counts.values()), "others": others,
                  "scans": len(scans), "nearest": min(min(scan) for scan in scans if scan), "cells": cells}))
