#!/usr/bin/env python3
"""Solves the tasks of my_simulations.gym by short rules, without learning, and prints the returns.

    python3 examples/solve_tasks.py [navigate|reach|pick_and_place] [EPISODES]
"""
import math
import sys

import my_simulations.gym  # noqa: F401 (registers the environments; finds gymnasium in a workspace)

# isort: split
import gymnasium
import numpy as np


class Navigate:
    """Drives in the free direction that is nearest to that of the mark."""

    name = "my_simulations/Navigate-v0"
    clearance = 0.32   # m to each side of the way

    def __init__(self, env):
        self.directions = np.radians(np.arange(-180.0, 180.0, 10.0) + 5.0)  # of the sectors
        self.turn = 0.0

    def __call__(self, seen):
        ranges, (distance, bearing) = seen[:36], seen[36:38]
        points = ranges[:, None] * np.column_stack([np.cos(self.directions),
                                                    np.sin(self.directions)])
        tries = np.linspace(-math.pi, math.pi, 73)
        ahead = np.column_stack([np.cos(tries), np.sin(tries)])
        along = points @ ahead.T                          # (sectors, directions), m
        across = np.abs(points @ np.column_stack([-ahead[:, 1], ahead[:, 0]]).T)
        blocks = (along > 0.0) & (across < self.clearance)
        free = np.where(blocks, along, 10.0).min(axis=0)  # m to what is in the way
        enough = np.minimum(distance, 1.0)
        cost = np.abs(np.angle(np.exp(1j * (tries - bearing)))) + 0.3 * np.abs(tries - self.turn)
        cost += 4.0 * np.maximum(0.0, enough - free)
        turn = self.turn = float(tries[np.argmin(cost)])
        room = float(free[np.argmin(np.abs(tries))])
        speed = max(0.0, math.cos(turn)) * min(1.0, 1.2 * max(0.0, room - 0.25))
        return np.array([speed if abs(turn) < 1.2 else 0.0, 1.5 * turn])


class Reach:
    """Moves all axes towards the positions at which the fingers are at the target."""

    name = "my_simulations/Reach-v0"

    def __init__(self, env):
        self.arm = env.unwrapped.world.robot("arm")
        self.goal = None

    def __call__(self, seen):
        if self.goal is None:
            found = self.arm.inverse_kinematics("hand", seen[15:18], point=[0, 0, -0.08])
            self.goal = np.array([found.get(name, 0.0) for name in self.arm.joints[:6]])
        return 3.0 * (self.goal - seen[:6])


class PickAndPlace:
    """Opens above the cube, goes down, grips, carries, lets go and leaves."""

    name = "my_simulations/PickAndPlace-v0"

    def __init__(self, env):
        self.stage, self.since = 0, 0

    def __call__(self, seen):
        tool, cube, mark = seen[:3], seen[5:8], seen[8:11]
        #         towards, height, fingers
        stages = [(cube, 0.12, -1), (cube, 0.02, -1), (cube, 0.02, 1), (tool, 0.12, 1),
                  (mark, 0.12, 1), (mark, 0.024, 1), (mark, 0.024, -1), (tool, 0.12, -1)]
        towards, height, fingers = stages[self.stage]
        off = np.array([*(towards - tool)[:2], height - tool[2]])
        if self.stage in (4, 5):
            off[:2] = (mark - cube)[:2]
        self.since += 1
        if self.since >= 10 if self.stage in (2, 6) else np.abs(off).max() < 0.006:
            self.stage, self.since = min(self.stage + 1, len(stages) - 1), 0
        return np.array([*(15.0 * off), fingers])


TASKS = {"navigate": Navigate, "reach": Reach, "pick_and_place": PickAndPlace}


def episodes(task, seeds, **options):
    """Yield the seed, steps, return and success of one episode after another."""
    env = gymnasium.make(task.name, **options)
    try:
        for seed in seeds:
            seen, _ = env.reset(seed=seed)
            act = task(env)
            total, steps, over = 0.0, 0, False
            while not over:
                action = np.clip(act(seen), -1.0, 1.0).astype(np.float32)
                seen, reward, terminated, truncated, info = env.step(action)
                total, steps, over = total + reward, steps + 1, terminated or truncated
            yield seed, steps, total, info.get("is_success", False)
    finally:
        env.close()


def main():
    """Print a line for each episode."""
    names = [name for name in sys.argv[1:] if name in TASKS] or list(TASKS)
    count = next((int(word) for word in sys.argv[1:] if word.isdigit()), 3)
    for name in names:
        for seed, steps, total, success in episodes(TASKS[name], range(count)):
            print(f"{name:15} seed {seed}: {steps:4d} steps, return {total:6.2f},"
                  f" {'solved' if success else 'not solved'}")


if __name__ == "__main__":
    main()
