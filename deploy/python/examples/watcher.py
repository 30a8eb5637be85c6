"""Watch a run: every tick of everybody, over zenoh alone (pip install eclipse-zenoh).

    socrates run my.toml --pace 1 &
    python3 watcher.py runs/my-1 [RUN]
"""

import json, pathlib, struct, sys, threading, zenoh  # noqa: E401

endpoint, namespace = (pathlib.Path(sys.argv[1]) / ".socrates/endpoint").read_text().splitlines()[:2]
config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", json.dumps([endpoint]))
config.insert_json5("scouting/multicast/enabled", "false")
session, over, ticks = zenoh.open(config), threading.Event(), {}
live = f"soc/v1/{namespace}/live/{sys.argv[2] if len(sys.argv) > 2 else '*'}"


def frames(sample):
    bytes_ = sample.payload.to_bytes()
    version, flags, part, tick = struct.unpack_from("<HHIQ", bytes_)
    if version != 2 or flags & 2:  # another version; bit 1: the run is over
        return over.set()
    for record in struct.iter_unpack("<QII6d", bytes_[16:]):
        ticks.setdefault(record[0], []).append(record)
        if record[1] == 0:  # agent 0 is the robot, k is human_k
            print(f"{record[0] / 100:.2f} s  robot at {record[3]:.2f}, {record[4]:.2f}")


def told(sample):
    meta = json.loads(sample.payload.to_string())
    print(f"run {meta['header']['run']} in {meta['location']['name']}: {meta['agents']} agents, goal {meta['goal']}")


watching = [session.declare_subscriber(f"{live}/agents", frames), session.declare_subscriber(f"{live}/meta", told)]
for reply in session.get(f"{live}/meta"):  # a run that goes on already
    told(reply.ok) if reply.ok else None
over.wait(600)
session.close()
print(f"{len(ticks)} ticks seen live")
