"""Compares what a recorder of others kept of a live run with the recording of the run's own bundle; prints one JSON line.

    python3 record.py RECORDED.mcap BUNDLE.mcap

Both are read with PyPI `mcap`; frames with PyPI `foxglove-schemas-protobuf`. Of the bundle the 64-byte records are read, so that
positions are compared at every tick that was seen, not only at those ten a second that the bundle has frames of.
"""

import json, struct, sys  # noqa: E401

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from mcap.reader import make_reader, NonSeekingReader

TICK_NS = 10_000_000


def messages(path, topics):
    with open(path, "rb") as file:
        try:
            yield from make_reader(file).iter_messages(topics=topics)
        except Exception:  # a recorder that was ended leaves no index
            file.seek(0)
            yield from NonSeekingReader(file).iter_messages(topics=topics)


own = {}
for _schema, _channel, message in messages(sys.argv[2], ["/socrates/agents"]):
    for tick, agent, flags, *rest in struct.iter_unpack("<QII6d", message.data):
        own[tick, "robot" if agent == 0 else f"human_{agent}"] = rest

farthest, frames, poses, unknown, off_tick, agents, seen = 0.0, 0, 0, 0, 0, set(), []
for _schema, _channel, message in messages(sys.argv[1], ["/tf"]):
    frames += 1
    tick, rest = divmod(message.publish_time, TICK_NS)
    off_tick += rest != 0
    seen.append(tick)
    transforms = FrameTransforms()
    transforms.ParseFromString(message.data)
    for one in transforms.transforms:
        name = one.child_frame_id
        if name == "map":
            continue
        here = own.get((tick, name))
        if here is None:
            unknown += 1
            continue
        agents.add(name)
        poses += 1
        farthest = max(farthest, abs(one.translation.x - here[0]), abs(one.translation.y - here[1]))
topics = {}
for _schema, channel, _message in messages(sys.argv[1], None):
    topics[channel.topic] = topics.get(channel.topic, 0) + 1
print(json.dumps({
    "frames": frames, "poses": poses, "unknown": unknown, "off_tick": off_tick, "farthest_m": farthest, "agents": sorted(agents),
    "sorted": seen == sorted(set(seen)), "first": min(seen, default=None), "last": max(seen, default=None), "topics": topics,
    "ticks_of_the_run": 1 + max((tick for tick, _ in own), default=-1),
}))
