"""Runs the example that watches a run over zenoh, and compares every tick that it saw with the recording; prints one JSON line at last.

    python3 watch.py WATCHER.py FOLDER RUN RECORDING.mcap

The recording is there when the run has ended.
"""

import contextlib, io, json, os, runpy, struct, sys, time  # noqa: E401

from mcap.reader import make_reader

watcher, folder, run, recording = sys.argv[1:5]
# Longest time to wait for the bundle; a guard, never a measure.
GUARD_S = 60
sys.argv = [watcher, folder, run]
said = io.StringIO()
with contextlib.redirect_stdout(said):
    seen = runpy.run_path(watcher)["ticks"]
begun = time.monotonic()
while not os.path.exists(os.path.join(folder, "details/manifest.json")) and time.monotonic() - begun < GUARD_S:
    time.sleep(0.05)

own = {}
with open(recording, "rb") as file:
    for _schema, _channel, message in make_reader(file).iter_messages(topics=["/socrates/agents"]):
        for record in struct.iter_unpack("<QII6d", message.data):
            own.setdefault(record[0], []).append(record)
# Bits 16 to 31 are indices of names, which need not be numbered alike.
short = lambda records: [(r[0], r[1], r[2] & 0xFFFF, *r[3:]) for r in sorted(records, key=lambda r: r[1])]  # noqa: E731
lines = said.getvalue().splitlines()
robot = {f"{tick / 100:.2f} s  robot at {r[3]:.2f}, {r[4]:.2f}" for tick, records in own.items() for r in records if r[1] == 0}
print(json.dumps({
    "ticks": len(own), "seen": len(seen), "same": sum(short(records) == short(own.get(tick, [])) for tick, records in seen.items()),
    "agents": len(own.get(0, [])), "robot_lines": sum(" robot at " in line for line in lines), "robot_lines_true": sum(line in robot for line in lines),
    "told": [line for line in lines if line.startswith("run ")][:3], "last_line": lines[-1] if lines else None,
    "first": min(seen, default=None), "last": max(seen, default=None),
}))
