"""A planner in thirty lines: follows the plan, and stops for people who are close ahead of it."""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from socrates_env import Command, Driver


def act(step, mission):
    robot = mission["robot"]
    to_x, to_y = step.ahead[0] - step.x, step.ahead[1] - step.y
    turn = math.remainder(math.atan2(to_y, to_x) - step.yaw, math.tau)
    if math.hypot(step.goal[0] - step.x, step.goal[1] - step.y) < 0.15:
        return Command(waiting=True)

    def ahead(person):
        x, y = person.x - step.x, person.y - step.y
        bearing = math.remainder(math.atan2(y, x) - step.yaw, math.tau)
        gap = math.hypot(x, y) - person.radius - robot["radius_m"]
        return gap < 0.8 and abs(bearing) < 0.8

    speed = robot["v_max_mps"] * max(0.0, math.cos(turn)) ** 2
    if any(ahead(person) for person in step.people):
        return Command(omega=0.0, gesture="EXCUSE_ME" if step.call % 50 == 0 else "NONE", waiting=True)
    return speed, 1.5 * turn


if __name__ == "__main__":
    Driver("example", act).run()
