"""Steps per second of the environments, and of the robots below them.

A step is 20 ms of the robot's time. Figures of a machine that does nothing else, with the package built by
``maturin develop --release``; ``python bench/gym.py [seconds]``.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from typing import Any, get_args

import numpy as np

from franka_async import VirtualRobots, gym

CYCLES = 20


def per_second(step: Callable[[], object], seconds: float) -> float:
    """Returns the calls of ``step`` per second, after a tenth of the time to warm up."""
    for duration in (seconds / 10.0, seconds):
        count, start = 0, time.perf_counter()
        while (passed := time.perf_counter() - start) < duration:
            step()
            count += 1
    return count / passed


def environment(action: Any, seconds: float) -> float:
    """Steps of one environment per second, resets included."""
    env = gym.FrankaEnv(action=action, max_steps=250)
    env.reset(seed=0)
    env.action_space.seed(0)

    def step() -> None:
        _, _, terminated, truncated, _ = env.step(0.2 * env.action_space.sample())
        if terminated or truncated:
            env.reset()

    return per_second(step, seconds)


def environments(count: int, threads: int, action: Any, seconds: float) -> float:
    """Steps of all environments together per second."""
    env = gym.FrankaVectorEnv(count, action=action, threads=threads, max_steps=250)
    env.reset(seed=0)
    env.action_space.seed(0)
    return count * per_second(lambda: env.step(0.2 * env.action_space.sample()), seconds)


def cycles(arm: Any, seconds: float) -> float:
    """Milliseconds of one robot's time per second, without an environment."""
    robots = VirtualRobots(arm=arm)
    still = np.zeros((1, 7))
    return 1000 * per_second(lambda: robots.step(still, 1000), seconds)


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 2.0
    threads = os.cpu_count() or 1
    print(f"{'action':<16} {'one':>10} {'64, 1 thread':>14} {f'64, {threads} threads':>14}   steps/s of {CYCLES} ms")
    for action in get_args(gym.ActionKind):
        one = environment(action, seconds)
        many = [environments(64, n, action, seconds) for n in (1, threads)]
        print(f"{action:<16} {one:>10.0f} {many[0]:>14.0f} {many[1]:>14.0f}")
    for arm in ("ideal", "realistic"):
        print(f"one {arm} arm alone: {cycles(arm, seconds) / 1000:.0f} times as fast as its own time")


if __name__ == "__main__":
    main()
