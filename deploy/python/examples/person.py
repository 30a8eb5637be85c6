"""A pedestrian in thirty lines: walks the plan at their own pace, and stops while the robot is within 1.5 m.

    [people]                                     in the request
    human_1 = "external:person"

    socrates run my.toml --driver "python3 person.py"
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from socrates_env import Command, Driver


def act(step, mission):
    if step.robot and math.hypot(step.robot.x - step.x, step.robot.y - step.y) < 1.5:
        return Command(waiting=True)
    to_x, to_y = step.ahead[0] - step.x, step.ahead[1] - step.y
    turn = math.remainder(math.atan2(to_y, to_x) - step.yaw, math.tau)
    usual = mission.person["pace_mps"] if mission.person else mission["robot"]["v_max_mps"]
    pace = min(usual, 2.0 * math.hypot(to_x, to_y))
    return pace * math.cos(turn), pace * math.sin(turn), 3.0 * turn


if __name__ == "__main__":
    Driver("person", act).run()
