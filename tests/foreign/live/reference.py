"""Compares the first texts of the gateway with those of the reference server of PyPI `foxglove-sdk`; prints one JSON line.

    python3 reference.py WS_ADDRESS

The reference server offers the same topics. Compared are the keys and types of serverInfo and advertise, and of every channel what it
is encoded as and its schema, byte for byte.
"""

import asyncio, json, sys  # noqa: E401

import foxglove
import websockets
from foxglove.channels import (
    FrameTransformsChannel, GridChannel, LaserScanChannel, LogChannel, OdometryChannel, PointCloudChannel, PosesInFrameChannel,
    SceneUpdateChannel,
)
from foxglove.websocket import Capability

PROTOCOL = "foxglove.sdk.v1"
TOPICS = {
    "/map": GridChannel, "/scene": SceneUpdateChannel, "/tf": FrameTransformsChannel, "/crowd": PointCloudChannel,
    "/scan": LaserScanChannel, "/robot/plan": PosesInFrameChannel, "/robot/odom": OdometryChannel, "/events": LogChannel,
    "/socrates/labels": SceneUpdateChannel,
}
# Longest time to wait for a text; a guard, never a measure.
GUARD_S = 30


async def opening(url, topics):
    """serverInfo and the channels: the reference server may advertise them one after the other."""
    ops, info, advertised, channels = [], None, None, {}
    async with websockets.connect(url, subprotocols=[PROTOCOL], max_size=None) as socket:
        spoken = socket.subprotocol
        while info is None or not channels or not topics <= set(channels):
            message = await asyncio.wait_for(socket.recv(), GUARD_S)
            if not isinstance(message, str):
                continue
            text = json.loads(message)
            ops.append(text["op"])
            if text["op"] == "serverInfo":
                info = text
            if text["op"] == "advertise":
                advertised = text
                channels.update({channel["topic"]: channel for channel in text["channels"]})
    return spoken, ops, info, advertised, channels


def kind(value):
    """Keys and types."""
    return {key: kind(one) for key, one in sorted(value.items())} if isinstance(value, dict) else type(value).__name__


async def main():
    server = foxglove.start_server(
        name="reference", host="127.0.0.1", port=0, capabilities=[Capability.Time, Capability.PlaybackControl],
        playback_time_range=(0, 60_000_000_000), session_id="s1",
    )
    keep = [make(topic) for topic, make in TOPICS.items()]
    _, their_ops, theirs, their_text, reference = await opening(f"ws://127.0.0.1:{server.port}", set(TOPICS))
    spoken, ops, ours, our_text, channels = await opening(sys.argv[1], set())
    server.stop()
    is_kept = "dataStartTime" in ours
    # Free text for people in both.
    for info in (theirs, ours):
        info.pop("metadata", None)
    if not is_kept:
        for key in ("dataStartTime", "dataEndTime"):
            theirs.pop(key)
        theirs["capabilities"].remove("playbackControl")
    different = []
    for what, one, other in [
        ("serverInfo", kind(theirs), kind(ours)),
        ("capabilities", sorted(theirs["capabilities"]), sorted(ours["capabilities"])),
        ("order", their_ops[:2], ops[:2]),
        ("advertise", sorted(their_text), sorted(our_text)),
    ]:
        if one != other:
            different.append([what, one, other])
    same = []
    for topic, mine in channels.items():
        channel = reference.get(topic)
        if channel is None:
            continue
        if kind(channel) != kind(mine):
            different.append([topic, kind(channel), kind(mine)])
        wrong = [key for key in ("encoding", "schemaName", "schemaEncoding", "schema") if channel[key] != mine[key]]
        different += [[topic, key, str(channel[key])[:60], str(mine[key])[:60]] for key in wrong]
        if not wrong:
            same.append(topic)
    print(json.dumps({
        "spoken": spoken, "kept": is_kept, "info": ours, "same": sorted(same), "different": different,
        "only_ours": sorted(set(channels) - set(reference)), "ids": len({channel["id"] for channel in channels.values()}), "kept_alive": len(keep),
    }))


asyncio.run(main())
