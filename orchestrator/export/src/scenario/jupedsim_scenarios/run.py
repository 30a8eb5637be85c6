"""Runs the scenario beside this file in JuPedSim and prints what everybody did, as JSON.

    pip install "jupedsim-scenarios==0.7.4"
    python run.py [--out trajectories.sqlite]

For each person: where and when they began and ended, and how long they stayed at each place at which they are to wait. Ends with 1
where somebody is missing, is not at their end, or did not wait.
"""

import argparse
import json
import logging
import math
import pathlib
import sys

from jupedsim_scenarios import load_scenario, run_scenario

# A person may stand this far from the middle of a place, m.
NEAR_M = 0.6


def middle(area):
    corners = area["coordinates"][:-1]
    return [sum(corner[axis] for corner in corners) / len(corners) for axis in (0, 1)]


def longest(times, step):
    """Length of the longest part without a gap, s."""
    best, since = 0.0, None
    for place, time in enumerate(times):
        if place == 0 or time - times[place - 1] > 1.5 * step:
            since = time
        best = max(best, time - since)
    return best


def told(tracks, raw, rate):
    """What everybody of the scenario did, by their start."""
    rows, left = [], dict(tracks)
    journeys = {journey["id"]: journey["sequence"] for journey in raw["journeys_v2"]}
    for start in raw["distributions"].values():
        place, begins = middle(start), start["parameters"].get("flow_start_time", 0.0)
        sequence = journeys[start["journey_weights"][0]["journey_id"]]
        # Those who begin near the place; of several the one at whose time it is.
        off = lambda one: math.dist(one[1][0][1:], place) + abs(one[1][0][0] - begins)
        nearest = min(left.items(), key=off, default=None)
        if nearest is None or math.dist(nearest[1][0][1:], place) > NEAR_M:
            rows.append({"name": start["name"], "ok": False, "why": "never began"})
            continue
        track = left.pop(nearest[0])
        end = middle(raw["exits"][sequence[-1]])
        waits = []
        for stop in sequence[:-1]:
            wanted = raw["checkpoints"][stop]["waiting_time"]
            if wanted > 0.0:
                at = middle(raw["checkpoints"][stop])
                times = [time for time, x, y in track if math.dist((x, y), at) <= NEAR_M]
                waits.append({"at": at, "wanted_s": wanted, "stayed_s": round(longest(times, 1 / rate), 2)})
        off_m = math.dist(track[-1][1:], end)
        ok = off_m <= NEAR_M and all(wait["stayed_s"] >= wait["wanted_s"] - 0.1 for wait in waits)
        rows.append({
            "name": start["name"], "ok": ok, "began": track[0], "ended": track[-1], "end_off_m": round(off_m, 3), "waits": waits,
        })
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", help="keep the trajectories in this file (SQLite of JuPedSim)")
    options = parser.parse_args()
    logging.disable(logging.INFO)
    scenario = load_scenario(str(pathlib.Path(__file__).resolve().parent / "scenario"))
    result = run_scenario(scenario, every_nth_frame=10, output_path=options.out)
    tracks = {}
    for row in result.trajectory_dataframe().itertuples():
        tracks.setdefault(int(row.id), []).append((row.frame / result.frame_rate, row.x, row.y))
    people = told(tracks, scenario.raw, result.frame_rate)
    print(json.dumps({"wanted": len(scenario.raw["distributions"]), "people": len(tracks), "tracks": people}))
    if options.out is None:
        result.cleanup()
    sys.exit(0 if len(tracks) == len(people) and all(person["ok"] for person in people) else 1)


main()
