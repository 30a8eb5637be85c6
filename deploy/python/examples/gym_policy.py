"""An example policy in the Gymnasium environment: follows the plan, and slows down for people ahead.

    socrates serve my.toml --out served &
    python3 gym_policy.py served
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from socrates_env import SocratesEnv


def policy(observation):
    ahead, left = observation["ahead"]
    turn = math.atan2(left, ahead)
    near = min((math.hypot(row[0], row[1]) for row in observation["people"] if row[6] and row[0] > 0.0), default=9.0)
    return 0.8 * max(0.0, math.cos(turn)) * min(1.0, max(0.0, near - 0.9)), 1.5 * turn


def episode(env, seed):
    observation, info = env.reset(seed=seed)
    total, steps, over = 0.0, 0, False
    while not over:
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        total, steps, over = total + reward, steps + 1, terminated or truncated
    return info["end"], total, steps


if __name__ == "__main__":
    env = SocratesEnv(place=sys.argv[1])
    for seed in range(1, 1 + int(sys.argv[2] if len(sys.argv) > 2 else 3)):
        end, total, steps = episode(env, seed)
        print(f"seed {seed}: {end['reason']} after {end['time_s']:.1f} s, {steps} steps, return {total:.2f}")
    env.close()
