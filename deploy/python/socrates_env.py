"""Drive the robot of a SocRATES run from Python, or its people: a planner or pedestrian model of your own, or Gymnasium.

One file; it needs `pip install eclipse-zenoh`, and for `SocratesEnv` also `pip install gymnasium` (which brings numpy).

    from socrates_env import Driver

    def act(step, mission):                      # called for every step of every run
        return 0.3, 0.0                          # forward speed in m/s, turning rate in rad/s

    Driver("mine", act).run()

    export PYTHONPATH=deploy/python              # the folder of this file
    socrates run my.toml --planner external:mine --driver "python3 my_planner.py"

A person of the request is driven by the same `act`, if `[people]` says so (`human_1 = "external:mine"`): `mission.person` tells who,
`step.robot` is the robot as they see it, and speeds go in every direction: (v, vy, omega).

`examples/` beside this file holds a planner and a person in thirty lines each, and a policy in the environment. The bytes are documented in docs/wire.md; this file reads and writes nothing else.
"""

import atexit
import json
import math
import os
import queue
import struct
import sys
import threading
import traceback
import uuid
from collections import namedtuple

import zenoh

VERSION = 1
GESTURES = ("NONE", "WAIT", "PROCEED", "ACKNOWLEDGED", "EXCUSE_ME", "FOLLOW_ME")

_HEAD = struct.Struct("<4sHHQIHHHHI11d")
_PERSON = struct.Struct("<IHH6d")
_COMMAND = struct.Struct("<4sHHQII3d")
_MAP = struct.Struct("<4sHHQQQ")

Person = namedtuple("Person", "number in_sight gesture x y vx vy yaw radius")
"""Somebody: number k of `human_k`, or 0 for the robot where a person is driven, whether they are in sight, the name of their gesture, center in m, velocity in m/s,
heading in rad, radius in m."""

class Step(namedtuple("Step", "session call time x y yaw v vy omega goal ahead people doors lidar")):
    """What the one who is driven, the robot or a person, knows at one step: time in s, pose in m and rad, speeds in m/s and rad/s, goal
    and the point of the plan that is `look_ahead` ahead as (x, y), a list of `Person`, whether each door of the mission is open, ranges
    of 360 beams in m (beam 0 straight ahead, then counter-clockwise; infinite where nothing is hit; empty unless asked for)."""

    __slots__ = ()

    @property
    def robot(self):
        """The robot as a `Person`, where a person is driven who is shown it; else None."""
        return self.people[0] if self.people and self.people[0].number == 0 else None


Command = namedtuple("Command", "v vy omega gesture waiting", defaults=(0.0, 0.0, 0.0, "NONE", False))
"""What the one who is driven is told: speeds forward and to the left in m/s, turning rate in rad/s, a gesture to begin, and whether
they stand on purpose, so that they do not count as stuck."""


def read_step(data):
    """The step in these bytes. ValueError for anything else."""
    if len(data) < _HEAD.size:
        raise ValueError(f"a step has at least {_HEAD.size} bytes, not {len(data)}")
    head = _HEAD.unpack_from(data)
    magic, version, head_bytes, session, call, people, person_bytes, doors, beams, _ = head[:10]
    if magic != b"SOCO" or version != VERSION:
        raise ValueError(f"a step of version {VERSION} begins with SOCO; these bytes begin with {magic!r}, version {version}")
    time, x, y, yaw, v, vy, omega, goal_x, goal_y, way_x, way_y = head[10:]
    at, seen = head_bytes, []
    for _ in range(people):
        number, flags, code, *rest = _PERSON.unpack_from(data, at)
        seen.append(Person(number, bool(flags & 1), GESTURES[code] if code < len(GESTURES) else "NONE", *rest))
        at += person_bytes
    opened = [byte != 0 for byte in data[at : at + doors]]
    at += (doors + 3) // 4 * 4
    lidar = struct.unpack_from(f"<{beams}f", data, at) if beams else ()
    return Step(session, call, time, x, y, yaw, v, vy, omega, (goal_x, goal_y), (way_x, way_y), seen, opened, lidar)


def command_bytes(session, call, command):
    """The bytes of a `Command`, of (v, omega), or of (v, vy, omega)."""
    if isinstance(command, (dict, str)) or not hasattr(command, "__iter__"):
        raise ValueError(f"a command is (v, omega), (v, vy, omega) or a Command, not {command!r}")
    if not isinstance(command, Command):
        numbers = [float(number) for number in command]
        if len(numbers) == 2:
            command = Command(v=numbers[0], omega=numbers[1])
        elif len(numbers) == 3:
            command = Command(*numbers)
        else:
            raise ValueError(f"a command is (v, omega), (v, vy, omega) or a Command, not {len(numbers)} numbers")
    gesture = command.gesture or "NONE"
    if gesture not in GESTURES:
        raise ValueError(f"gesture {gesture!r}; allowed: {', '.join(GESTURES)}")
    code = GESTURES.index(gesture)
    numbers = (float(command.v), float(command.vy), float(command.omega))
    return _COMMAND.pack(b"SOCC", VERSION, code, session, call, 1 if command.waiting else 0, *numbers)


def gives_up_bytes(why):
    """The bytes with which a driver ends a run that it cannot drive."""
    return b"SOCE" + struct.pack("<HH", VERSION, 0) + str(why).encode()[:2000]


def find(place=None, namespace=None):
    """Endpoint and namespace of a bus: of `place` (an endpoint, or the folder of a run or of `socrates serve`), else of the
    variables SOCRATES_ENDPOINT and SOCRATES_NAMESPACE, which `--driver` sets."""
    place = place or os.environ.get("SOCRATES_ENDPOINT")
    namespace = namespace or os.environ.get("SOCRATES_NAMESPACE") or "run"
    if not place:
        raise ValueError("name the folder of a run that is going on, or an endpoint; `socrates run --driver` tells it by itself")
    for file in (os.path.join(place, ".socrates", "endpoint"), os.path.join(place, "endpoint")):
        if os.path.isfile(file):
            with open(file, encoding="utf-8") as text:
                lines = text.read().split("\n")
            return lines[0], lines[1]
    if "/" not in place or os.path.isdir(place):
        raise ValueError(f"{place!r} is no folder in which something is made or served, and no endpoint such as tcp/127.0.0.1:7447")
    return place, namespace


def _secured(endpoint, keys):
    """Settings for an endpoint with TLS: the folder of the role `driver`, as `socrates cluster keys` made it."""
    if not endpoint.startswith("quic/"):
        return ()
    keys = keys or os.environ.get("SOCRATES_BUS__KEYS")
    if not keys:
        raise ValueError(f"{endpoint} needs keys: name the folder of the role driver, as `keys` or by SOCRATES_BUS__KEYS")
    files = (("root_ca_certificate", "ca.pem"), ("connect_certificate", "cert.pem"), ("connect_private_key", "key.pem"))
    paths = [(name, os.path.abspath(os.path.join(keys, file))) for name, file in files]
    for _, path in paths:
        if not os.path.isfile(path):
            raise ValueError(f"there is no file {path!r}; copy the folder of the role driver whole")
    settings = [(name, json.dumps(path)) for name, path in paths] + [("enable_mtls", "true")]
    return tuple((f"transport/link/tls/{name}", value) for name, value in settings)


def connect(endpoint, keys=None):
    """A session with the run's router, which nobody else is looked for beside. An endpoint that begins with `quic/` needs `keys`, the
    folder of the role driver, or the variable SOCRATES_BUS__KEYS that names it."""
    config = zenoh.Config()
    for key, value in (
        ("mode", '"client"'),
        ("connect/endpoints", json.dumps([endpoint])),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("transport/shared_memory/enabled", "false"),
        *_secured(endpoint, keys),
    ):
        config.insert_json5(key, value)
    session = zenoh.open(config)
    # Its threads would keep a program alive whose main part has ended, be it by an exception.
    getattr(threading, "_register_atexit", atexit.register)(session.close)
    return session


def _ends_with_input():
    """A driver that a run has started leaves when its standard input closes, whatever became of the run."""

    def wait():
        while os.read(0, 4096):
            pass
        os._exit(0)

    threading.Thread(target=wait, daemon=True).start()


class Mission(dict):
    """The task of a run as JSON tells it, and the driver's own `rate_hz`; `cells` holds the map where it was asked for: bytes, row by row from the lower left,
    0 free, 100 occupied, 255 unknown."""

    cells = b""

    @property
    def person(self):
        """The person who is driven: `id`, `role`, `relation`, `behavior`, `pace_mps`, `meets`, `group`; None for the robot."""
        return self.get("person")


class Driver:
    """Answers every step of every run that wants the planner `external:NAME`, or the model of a person of that name.

    `act(step, mission)` gives the command, for the robot and for each person who is driven; a run of several has a mission for each.
    `begin(mission)` and `end(mission, end)` are called around a run, if given; what
    `begin` raises refuses the run. An exception in `act` ends that run alone.
    """

    def __init__(self, name, act, begin=None, end=None, *, rate_hz=10.0, look_ahead=0.8, people="seen", lidar=False,
                 map=False, place=None, namespace=None):
        self.name, self.act, self.begin, self.end = name, act, begin, end
        self.answer = {"version": VERSION, "rate_hz": rate_hz, "look_ahead_m": look_ahead, "people": people,
                       "lidar": lidar, "map": map}
        self.missions = {}
        endpoint, namespace = find(place, namespace)
        self.session = connect(endpoint)
        self.root = f"soc/v1/{namespace}"
        keys = f"{self.root}/drive/{name}"
        self.session.declare_queryable(f"{keys}/mission", self._mission, complete=True)
        self.session.declare_queryable(f"{keys}/step", self._step, complete=True)
        # The claim comes last: whoever sees it may ask.
        self._claim = self.session.liveliness().declare_token(f"{keys}/claim/{uuid.uuid4().hex}")
        if os.environ.get("SOCRATES_TIED"):
            _ends_with_input()

    def run(self):
        """Drives until the process ends."""
        threading.Event().wait()

    def close(self):
        """Leaves the bus."""
        self.session.close()

    def _mission(self, query):
        with query:
            data = query.payload.to_bytes()
            query.reply(query.key_expr, self._told(data))

    def _told(self, data):
        if data[:4] == b"SOCM":
            _, _, head_bytes, session, first, whole = _MAP.unpack_from(data)
            mission = self.missions.get(session)
            if mission is not None:
                mission.cells += data[head_bytes:]
            return b"{}"
        try:
            message = json.loads(data)
            if message["socrates"] == "end":
                mission = self.missions.pop(message["session"], None)
                if mission is not None and self.end:
                    self.end(mission, message)
                return b"{}"
            mission = Mission(message, rate_hz=self.answer["rate_hz"])
            if self.begin:
                self.begin(mission)
            self.missions[message["session"]] = mission
            return json.dumps(self.answer).encode()
        except Exception as why:  # what the planner raises is the run's to know
            traceback.print_exc()
            return json.dumps({"version": VERSION, "error": f"{type(why).__name__}: {why}"}).encode()

    def _step(self, query):
        with query:
            query.reply(query.key_expr, self._commanded(query.payload.to_bytes()))

    def _commanded(self, data):
        try:
            step = read_step(data)
            return command_bytes(step.session, step.call, self.act(step, self.missions[step.session]))
        except Exception as why:
            traceback.print_exc()
            return gives_up_bytes(f"{type(why).__name__}: {why}")


class Pilot(Driver):
    """Drives one run at a time from outside of its callbacks: `step()` waits for the next step, `tell(command)` answers it.

    `ask(scenario, seed)` asks a `socrates serve` for a run.
    """

    def __init__(self, name, **options):
        self._steps, self._query = queue.SimpleQueue(), None
        super().__init__(name, None, **options)

    def ask(self, scenario=None, seed=1, patience_s=30.0):
        """Asks for a run; gives its name. What is left of the run before is given up."""
        self.give_up("another run was asked for")
        wish = {"driver": self.name, "seed": int(seed), "scenario": scenario}
        replies = self.session.get(f"{self.root}/serve/run", payload=json.dumps(wish), timeout=patience_s)
        for reply in replies:
            if reply.ok is None:
                break
            told = json.loads(reply.ok.payload.to_bytes())
            if "error" in told:
                raise ValueError(told["error"])
            self._asked = told["run"]
            return told["run"]
        raise ConnectionError("no `socrates serve` answers here; start one and name its folder")

    def step(self, patience_s=30.0):
        """The next thing that happens: ("step", Step), or ("end", dict) when the run is over."""
        try:
            return self._steps.get(timeout=patience_s)
        except queue.Empty:
            raise TimeoutError(f"nothing was heard of the run for {patience_s} s") from None

    def tell(self, command):
        """Answers the step that was given last."""
        if self._query is None:
            raise RuntimeError("no step waits for a command: the run is over, or none was begun; call reset first")
        query, at = self._query, self._at
        self._query = None
        with query:
            query.reply(query.key_expr, command_bytes(at.session, at.call, command))

    def give_up(self, why):
        """Ends the run that is going on, if one is, and forgets what it said."""
        if self._query is not None:
            query, self._query = self._query, None
            with query:
                query.reply(query.key_expr, gives_up_bytes(why))
            while self.step()[0] != "end":
                pass

    def _step(self, query):
        # The answer is given by `tell`, from the thread of whoever drives.
        at = read_step(query.payload.to_bytes())
        self._query, self._at = query, at
        self._steps.put(("step", at))

    def _told(self, data):
        told = super()._told(data)
        if data[:1] == b"{":
            message = json.loads(data)
            if message["socrates"] == "end":
                self._steps.put(("end", message))
        return told


try:
    import gymnasium
    import numpy
except ImportError:
    pass
else:

    class SocratesEnv(gymnasium.Env):
        """A run of a scenario as a Gymnasium environment; the runs come from a `socrates serve` that goes on.

        Observation: `robot` (x, y, yaw, v, vy, omega), `goal` and `ahead` (the point of the
        plan 0.8 m ahead) relative to the robot (ahead, to the left),
        `people` [most, 7] (ahead, to the left, velocity ahead, to the left, radius, in sight, here) nearest first, and
        `lidar` [360] where it is asked for. Action: (v, omega), of an omnidirectional robot (v, vy, omega), within the robot's
        limits. An episode ends some seconds after the robot came
        within 0.5 m of its goal (`info["end"]["arrived"]`), when it stood for 45 s (`stuck`), or when its time is over
        (truncated). `reset(seed=…, options={"scenario": NAME})` chooses the run; without a seed a random one is drawn from the
        environment's own generator. `reward(before, command, after, info)` is yours; the default is the progress toward the
        goal, m, less 1 for each step within 0.2 m of a person.
        """

        metadata = {"render_modes": []}
        # One process, one environment: a zenoh session does not outlive a fork. AsyncVectorEnv wants context="spawn".

        def __init__(self, scenario=None, *, place=None, namespace=None, name=None, most=8, lidar=False, rate_hz=10.0,
                     omnidirectional=False, v_max=1.0, omega_max=2.0, reward=None):
            self.scenario, self.most = scenario, most
            self.omnidirectional = omnidirectional
            self.reward = reward or progress
            self.pilot = Pilot(name or f"gym-{uuid.uuid4().hex[:8]}", rate_hz=rate_hz, people="seen", lidar=lidar,
                               place=place, namespace=namespace)
            box = gymnasium.spaces.Box
            real = numpy.float32
            spaces = {
                "robot": box(-numpy.inf, numpy.inf, (6,), real),
                "goal": box(-numpy.inf, numpy.inf, (2,), real),
                "ahead": box(-numpy.inf, numpy.inf, (2,), real),
                "people": box(-numpy.inf, numpy.inf, (most, 7), real),
            }
            if lidar:
                spaces["lidar"] = box(0.0, numpy.inf, (360,), real)
            self.observation_space = gymnasium.spaces.Dict(spaces)
            limits = [v_max, v_max, omega_max] if omnidirectional else [v_max, omega_max]
            limits = numpy.array(limits, real)
            self.action_space = box(-limits, limits, dtype=real)
            self._last = None

        def reset(self, *, seed=None, options=None):
            super().reset(seed=seed)
            number = seed if seed is not None else int(self.np_random.integers(1, 2**31))
            scenario = (options or {}).get("scenario", self.scenario)
            run = self.pilot.ask(scenario, number)
            kind, told = self.pilot.step()
            if kind != "step":
                raise RuntimeError(f"the run {run} ended before it began: {told['reason']}")
            self._last = told
            mission = self.pilot.missions.get(told.session, {})
            # The same seed gives the same words: the number of the session is left out.
            mission = {key: value for key, value in mission.items() if key != "session"}
            return self._observed(told), {"run": run, "mission": mission, "step": told._replace(session=0)}

        def step(self, action):
            action = numpy.clip(numpy.asarray(action, dtype=float), self.action_space.low, self.action_space.high)
            numbers = [float(number) for number in action]
            command = Command(*numbers) if self.omnidirectional else Command(v=numbers[0], omega=numbers[1])
            before = self._last
            self.pilot.tell(command)
            kind, told = self.pilot.step()
            if kind == "step":
                self._last = told
                info = {"step": told._replace(session=0)}
                return self._observed(told), float(self.reward(before, command, told, info)), False, False, info
            # What was seen last stays in sight: the run has no later state.
            told = {key: value for key, value in told.items() if key != "session"}
            info = {"step": before._replace(session=0), "end": told}
            done = told["reason"] != "time"
            return self._observed(before), float(self.reward(before, command, before, info)), done, not done, info

        def close(self):
            self.pilot.give_up("the environment was closed")
            self.pilot.close()

        def _observed(self, step):
            real = numpy.float32
            ahead, left = math.cos(step.yaw), math.sin(step.yaw)

            def turned(x, y):
                return ahead * x + left * y, ahead * y - left * x

            def relative(x, y):
                return turned(x - step.x, y - step.y)

            people = numpy.zeros((self.most, 7), real)
            near = sorted(step.people, key=lambda person: math.hypot(person.x - step.x, person.y - step.y))
            for row, person in zip(people, near):
                row[:] = (*relative(person.x, person.y), *turned(person.vx, person.vy), person.radius, person.in_sight, 1.0)
            seen = {
                "robot": numpy.array((step.x, step.y, step.yaw, step.v, step.vy, step.omega), real),
                "goal": numpy.array(relative(*step.goal), real),
                "ahead": numpy.array(relative(*step.ahead), real),
                "people": people,
            }
            if "lidar" in self.observation_space.spaces:
                seen["lidar"] = numpy.array(step.lidar, real)
            return seen

    def progress(before, command, after, info):
        """Progress toward the goal, m, less 1 while a person is nearer than 0.2 m, surface to surface with a robot of 0.25 m."""

        def left(step):
            return math.hypot(step.goal[0] - step.x, step.goal[1] - step.y)

        gap = min((math.hypot(p.x - after.x, p.y - after.y) - p.radius - 0.25 for p in after.people), default=math.inf)
        return left(before) - left(after) - (1.0 if gap < 0.2 else 0.0)


# ---- policies of CrowdNav and its successors -------------------------------------------------------------------------------

FullState = namedtuple("FullState", "px py vx vy radius gx gy v_pref theta")
ObservableState = namedtuple("ObservableState", "px py vx vy radius")
JointState = namedtuple("JointState", "self_state human_states")


def crowdnav(predict, *, v_pref=None):
    """An `act` for `Driver` out of a CrowdNav policy: `predict(state)` gets `self_state` and `human_states` and gives an
    `ActionXY` (`vx`, `vy`: velocity in the map) or an `ActionRot` (`v`, `r`: speed and the turn of one step, rad).

    The goal that the policy sees is the point of the plan ahead: give the driver a `look_ahead` of some meters. A robot that
    cannot go to the side turns toward an `ActionXY` and drives as far as it faces it.
    """

    def act(step, mission):
        robot = mission["robot"]
        fast = v_pref or robot["v_max_mps"]
        ahead, left = math.cos(step.yaw), math.sin(step.yaw)
        vx, vy = ahead * step.v - left * step.vy, left * step.v + ahead * step.vy
        me = FullState(step.x, step.y, vx, vy, robot["radius_m"], *step.ahead, fast, step.yaw)
        people = [ObservableState(p.x, p.y, p.vx, p.vy, p.radius) for p in step.people]
        action = predict(JointState(me, people))
        if hasattr(action, "vx"):
            forward, aside = ahead * action.vx + left * action.vy, ahead * action.vy - left * action.vx
            if robot["kinematics"] == "omnidirectional":
                return forward, aside, 0.0
            turn = math.atan2(aside, forward) if math.hypot(forward, aside) > 1e-3 else 0.0
            return max(0.0, forward), 2.0 * turn
        return action.v, action.r * mission["rate_hz"]

    return act


if __name__ == "__main__":
    print(__doc__, file=sys.stderr)
