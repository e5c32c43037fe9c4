#!/usr/bin/env python3
"""Prints how many steps a second the tasks of gymnasium make, beside loops of bare PyBullet.

usage: environments.py [-t TASK]… [COUNT …]   TASK: a name of `bare_tasks.SCENES` (default: all)
                                              COUNT: worlds side by side (default: 1 8 32)

Both simulate the same robots and boxes with random actions, steps of 1 ms, and read what the task
observes (`bare_tasks.py`). Worlds of bare PyBullet are clients of one process, stepped one after
another. Rates are per second of wall time; a ratio of processor times counts all processes. Nothing
here fails on a slow machine.
"""
from __future__ import annotations

import argparse
import os
import time
from typing import Callable, TextIO, Tuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")   # idle ones of `bare` would slow down ours
import numpy as np
from bare_tasks import SCENES, Bare
from server import children, processor

SECONDS, PAIRS = 2.0, 3


def processor_time() -> float:
    """Of this process and of its children that run, s."""
    return processor([os.getpid(), *children(os.getpid())])


def measured(step: Callable[[np.ndarray], object], count: int, actions: int,
             ) -> Tuple[float, float]:
    """Steps of single worlds a second of wall time, and processor time of one, s."""
    random = np.random.default_rng(1)
    steps, busy, started = 0, processor_time(), time.perf_counter()
    while time.perf_counter() - started < SECONDS:
        step(random.uniform(-1.0, 1.0, (count, actions)).astype(np.float32))
        steps += count
    return (steps / (time.perf_counter() - started), (processor_time() - busy) / steps)


def compare(task: str, count: int, answers: TextIO) -> None:
    """Write one row."""
    import gymnasium

    from my_simulations.gym import WorldVectorEnv

    name, _, camera = task.partition(" with ")
    options = {"camera": True} if camera else {}
    envs = WorldVectorEnv([lambda: gymnasium.make(f"my_simulations/{name}-v0", **options)] * count)
    bare, actions = Bare(SCENES[task], count), SCENES[task].actions
    try:
        envs.reset(seed=1)
        pairs = [(measured(envs.step, count, actions), measured(bare.step, count, actions))
                 for _ in range(PAIRS)]
    finally:
        envs.close()
        bare.close()
    (rate, used), (bare_rate, bare_used) = (np.median([pair[k] for pair in pairs], axis=0)
                                            for k in (0, 1))
    print(f"{task:17} {count:3d} worlds: {rate:7.0f} steps/s, bare {bare_rate:7.0f}:"
          f" {rate / bare_rate:.2f} of bare; processor time {1000 * used:.2f} ms a step, bare"
          f" {1000 * bare_used:.2f} ms: {bare_used / used:.2f} of bare (bar 0.7)",
          file=answers, flush=True)


def main() -> None:
    """Compare the tasks that are asked for."""
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("-t", "--task", action="append", choices=SCENES)
    parser.add_argument("counts", nargs="*", type=int, default=[1, 8, 32])
    options = parser.parse_args()
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # PyBullet prints there, too
    for task in options.task or SCENES:
        for count in options.counts:
            compare(task, count, answers)


if __name__ == "__main__":
    main()
