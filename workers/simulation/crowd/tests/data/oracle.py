#!/usr/bin/env python3
"""Scenes of our own and what the social force model of lightsfm makes of them, worked out apart from the Rust code.

The formulas are those of Moussaid et al., Experimental study of the behavioural mechanisms underlying self-organization in human
crowds (2009), and of The walking behaviour of pedestrian social groups (2010), with the parameters and the order of one step of
lightsfm (https://github.com/robotics-upo/lightsfm, BSD-3, commit b30327c). Nothing of its source is used here, nor of ours.

    python3 oracle.py        # Python 3.8 or newer, no packages; writes NAME.json, NAME.traj.csv and NAME.forces.csv beside itself
"""
import json
import math
import os

PARAMS = {
    "force_factor_desired": 2, "force_factor_obstacle": 10, "force_sigma_obstacle": 0.2, "force_factor_social": 0,
    "force_factor_group_gaze": 3, "force_factor_group_coherence": 2, "force_factor_group_repulsion": 1,
    "lambda": 2, "gamma": 0.35, "n": 2, "n_prime": 3, "epsilon": 0, "relaxation_time": 0.5,
}
# `batch`: the call for a whole crowd, with its bias of angles. `hunav`: the call for one agent, as HuNavSim uses it.
MODES = {"batch": {"force_factor_social": 2.1, "epsilon": 0.005}, "hunav": {"force_factor_social": 5, "epsilon": 0}}


def agent(number, x, y, yaw, speed, goals, group=-1, cyclic=False, radius=0.35):
    return {
        "id": number, "x": x, "y": y, "vx": 0.5 * speed * math.cos(yaw), "vy": 0.5 * speed * math.sin(yaw), "yaw": yaw,
        "radius": radius, "desired_velocity": speed, "group_id": group, "cyclic_goals": cyclic, "teleoperated": False,
        "linear_velocity": 0, "angular_velocity": 0, "goals": [[gx, gy, 0.3] for gx, gy in goals],
    }


SCENES = [
    # Three people want through one gap of a wall, two from one side.
    ("gap", "hunav", [[0, -3, 0, -0.7], [0, 0.7, 0, 3]], [
        agent(1, -2.5, 0.4, 0.0, 1.3, [(3, 0)]),
        agent(2, -2.6, -0.5, 0.1, 1.1, [(3, 0.5)]),
        agent(3, 2.4, 0.2, 3.0, 1.0, [(-3, -0.3)]),
    ]),
    # A pair that stays together meets somebody between two walls.
    ("pair", "batch", [[-4, 1.5, 4, 1.5], [-4, -1.5, 4, -1.5]], [
        agent(1, -2.0, 0.35, 0.0, 1.0, [(4, 0.3)], group=7),
        agent(2, -2.1, -0.4, 0.0, 1.0, [(4, -0.4)], group=7),
        agent(3, 2.2, 0.1, math.pi, 1.2, [(-4, 0)]),
    ]),
    # Four cross a square with a post near its middle, and turn back.
    ("square", "hunav", [[0.3, 0.9, 0.3, 0.9]], [
        agent(1, -2.0, 0.1, 0.0, 1.2, [(0.8, 0.1), (-2, 0)], cyclic=True),
        agent(2, 2.1, -0.2, math.pi, 1.4, [(-0.9, -0.3), (2, 0)], cyclic=True),
        agent(3, 0.2, -2.2, 0.5 * math.pi, 0.9, [(0.1, 1.0)]),
        agent(4, -0.4, 2.3, -0.5 * math.pi, 1.1, [(-0.2, -1.0)]),
    ]),
    # Three of one group close to each other: they look at each other, come together and do not touch.
    ("three", "batch", [], [
        agent(1, 0.0, 0.0, 0.2, 1.0, [(6, 1)], group=1, radius=0.4),
        agent(2, 0.1, 0.75, 0.1, 1.0, [(6, 1.5)], group=1, radius=0.4),
        agent(3, -1.6, 0.5, 0.0, 0.8, [(6, 0.5)], group=1, radius=0.4),
    ]),
]
STEPS, DT, RANGE = 240, 0.01, 3.0


def add(a, b):
    return (a[0] + b[0], a[1] + b[1])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1])


def times(k, a):
    return (k * a[0], k * a[1])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return times(1 / length(a), a)


def wrapped(angle):
    while angle <= -math.pi:
        angle += 2 * math.pi
    while angle > math.pi:
        angle -= 2 * math.pi
    return angle


def points(at, segments):
    """The nearest point of every segment that is near enough."""
    found = []
    for ax, ay, bx, by in segments:
        along, to = (bx - ax, by - ay), (at[0] - ax, at[1] - ay)
        square = dot(along, along)
        share = min(1.0, max(0.0, dot(to, along) / square)) if square > 0 else 0.0
        point = (ax + along[0] * share, ay + along[1] * share)
        if length(sub(at, point)) <= RANGE:
            found.append(point)
    return found


def to_goal(me):
    """The direction to the goal, or none where there is no goal, or it is reached."""
    if me["goals"]:
        gx, gy, radius = me["goals"][0]
        way = sub((gx, gy), me["p"])
        if length(way) > radius:
            return unit(way)
    return None


def group_force(me, people, p):
    zero = (0.0, 0.0)
    members = [other for other in people if other["group"] >= 0 and other["group"] == me["group"]]
    n = len(members)
    if n < 2:
        return zero, zero, zero
    middle = times(1 / n, (sum(m["p"][0] for m in members), sum(m["p"][1] for m in members)))
    gaze, heading = zero, to_goal(me)
    if heading is not None:
        others = times(1 / (n - 1), sub(times(n, middle), me["p"]))
        to_others = sub(others, me["p"])
        between = math.acos(max(-1.0, min(1.0, dot(heading, to_others) / (length(heading) * length(to_others)))))
        if between > math.pi / 2:
            gaze = times(p["force_factor_group_gaze"] * dot(heading, to_others) / dot(heading, heading), heading)
    to_middle = sub(middle, me["p"])
    pull = p["force_factor_group_coherence"] * (math.tanh(length(to_middle) - (n - 1) / 2) + 1) / 2
    repulsion = zero
    for other in members:
        apart = sub(me["p"], other["p"])
        if other is not me and length(apart) < me["radius"] + other["radius"]:
            repulsion = add(repulsion, apart)
    return gaze, times(pull, to_middle), times(p["force_factor_group_repulsion"], repulsion)


def forces(me, people, segments, p):
    heading = to_goal(me)
    if heading is None:
        desired = times(-1 / p["relaxation_time"], me["v"])
    else:
        wanted = sub(times(me["speed"], heading), me["v"])
        desired = times(p["force_factor_desired"] / p["relaxation_time"], wanted)
    obstacle = (0.0, 0.0)
    near = points(me["p"], segments)
    for point in near:
        away = sub(me["p"], point)
        push = math.exp(-(length(away) - me["radius"]) / p["force_sigma_obstacle"])
        obstacle = add(obstacle, times(p["force_factor_obstacle"] * push, unit(away)))
    social = (0.0, 0.0)
    for other in people:
        if other is me:
            continue
        apart = sub(other["p"], me["p"])
        line = unit(apart)
        meeting = add(times(p["lambda"], sub(me["v"], other["v"])), line)
        reach = p["gamma"] * length(meeting)
        along = unit(meeting)
        angle = wrapped(math.atan2(line[1], line[0]) - math.atan2(along[1], along[0]))
        if p["epsilon"]:
            angle = wrapped(angle + p["epsilon"] * reach)
        slower = -math.exp(-length(apart) / reach - (p["n_prime"] * reach * angle) ** 2)
        side = (angle > 0) - (angle < 0)
        aside = -side * math.exp(-length(apart) / reach - (p["n"] * reach * angle) ** 2)
        left = (-along[1], along[0])
        social = add(social, times(p["force_factor_social"], add(times(slower, along), times(aside, left))))
    return [desired, obstacle, social, *group_force(me, people, p)], len(near)


def moved(me, force):
    """The state after one step; reached goals are taken off, or put to the end."""
    v = add(me["v"], times(DT, force))
    if length(v) > me["speed"]:
        v = times(me["speed"], unit(v))
    goals, p, reached = list(me["goals"]), add(me["p"], times(DT, v)), me["reached"]
    if goals and length(sub((goals[0][0], goals[0][1]), p)) <= goals[0][2]:
        first = goals.pop(0)
        reached += 1
        if me["cyclic"]:
            goals.append(first)
    return {**me, "v": v, "yaw": math.atan2(v[1], v[0]), "p": p, "goals": goals, "reached": reached}


def row(values):
    return ",".join(repr(value) for value in values) + "\n"


def write(name, mode, segments, agents):
    params = {**PARAMS, **MODES[mode]}
    here = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
    head = {"name": name, "mode": mode, "dt": DT, "steps": STEPS, "obstacle_range": RANGE, "params": params}
    with open(here + ".json", "w") as file:
        json.dump({**head, "segments": segments, "agents": agents}, file, indent=1)
        file.write("\n")
    people = [
        {"id": a["id"], "p": (a["x"], a["y"]), "v": (a["vx"], a["vy"]), "yaw": a["yaw"], "radius": a["radius"],
         "speed": a["desired_velocity"], "group": a["group_id"], "cyclic": a["cyclic_goals"], "goals": a["goals"], "reached": 0}
        for a in agents
    ]
    kinds = ["desired", "obstacle", "social", "gaze", "coherence", "repulsion", "global"]
    with open(here + ".traj.csv", "w") as track, open(here + ".forces.csv", "w") as table:
        track.write("step,id,x,y,vx,vy,yaw,goals_reached\n")
        table.write("step,id,n_obstacles," + ",".join(f"{kind}_x,{kind}_y" for kind in kinds) + "\n")
        for step in range(STEPS + 1):
            found = [forces(me, people, segments, params) for me in people]
            totals = []
            for me, (parts, near) in zip(people, found):
                group = add(add(parts[3], parts[4]), parts[5])
                totals.append(add(add(add(parts[0], parts[2]), parts[1]), group))
                track.write(row([step, me["id"], *me["p"], *me["v"], me["yaw"], me["reached"]]))
                if step % 20 == 0:
                    flat = [part for pair in [*parts, totals[-1]] for part in pair]
                    table.write(row([step, me["id"], near, *flat]))
            people = [moved(me, total) for me, total in zip(people, totals)]


for scene in SCENES:
    write(*scene)
