"""Simulated robots in virtual time, and programs in separate processes."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Awaitable, Callable, Iterator
from typing import Any, TypeVar

import pytest

from franka_async import Robot, Sim

T = TypeVar("T")

PATIENT: dict[str, Any] = {"realtime": "ignore", "link_timeout": 10.0}
"""Options of a robot whose simulator a busy machine may delay for longer than the usual link timeout of a second."""

LOOPBACK = f"127.{1 + os.getpid() // 254 % 254}.{1 + os.getpid() % 254}"
"""First parts of the addresses on which this process starts robots with the ports of real ones, since the tests run in
several processes."""


@pytest.fixture(scope="session", autouse=True)
def interruptible() -> None:
    """Makes Ctrl-C raise ``KeyboardInterrupt``, even where a shell runs the tests in the background and ignores it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(params=["fr3", "fer"])
def sim(request: pytest.FixtureRequest) -> Iterator[Sim]:
    """A simulated robot of each kind, with a realistic arm."""
    kind: str = request.param
    # Two states that a busy machine reads at once cost this time each.
    with getattr(Sim, kind)(virtual_time=True, patience=5.0) as sim:
        yield sim


@pytest.fixture
def robot(sim: Sim) -> Iterator[Robot]:
    """A connection to the simulated robot, for programs without an event loop."""
    robot = connection(sim)
    robot.connect().wait()
    try:
        yield robot
    finally:
        robot.shutdown().wait()


def connection(sim: Sim) -> Robot:
    """A robot that is not connected yet."""
    return Robot(sim.address, **PATIENT)


def at_rest(robot: Robot) -> bool:
    """True if no joint moves."""
    return bool(abs(robot.state().dq).max() < 0.02)


def until(condition: Callable[[], bool], *, longest: float = 20.0) -> None:
    """Waits for a condition that must become true, regardless of how long the machine takes."""
    import time

    end = time.monotonic() + longest
    while not condition():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.002)


@pytest.fixture(params=["fr3", "fer"])
def live(request: pytest.FixtureRequest) -> Iterator[Sim]:
    """A simulated robot of each kind that is no faster than the clock on the wall, and waits for commands that come late: for tests
    that act while a motion is under way.
    """
    kind: str = request.param
    with getattr(Sim, kind)(patience=5.0) as sim:
        yield sim


async def begun(robot: Robot) -> None:
    """Waits until target control moves the arm."""
    while True:
        reference = robot.reference()
        if reference is not None and abs(reference.dq).max() > 0.005:
            return
        await asyncio.sleep(0.001)


async def outcome(work: Awaitable[T]) -> T | BaseException:
    """Returns the result or the exception of the work."""
    try:
        return await work
    except BaseException as error:
        return error


def program(text: str, *, expect: int = 0) -> str:
    """Runs a Python program in a separate process, with the interpreter's own checks, and returns its output."""
    done = subprocess.run([sys.executable, "-X", "dev", "-c", text], capture_output=True, text=True, timeout=60)
    assert done.returncode == expect, f"{done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr
