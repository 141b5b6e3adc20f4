"""Programs that were written for other packages: the same outcomes through the originals and through the layers for them.

Each runs in a separate process, against a separate simulated robot with the same settings.
"""

from __future__ import annotations

import importlib.util
import inspect
import json
import subprocess
import sys
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

import franka_async.compat.franka as franka_layer
import franka_async.compat.pylibfranka as pylibfranka_layer
import numpy as np
import programs_franka
import programs_pylibfranka
import pytest
from conftest import LOOPBACK
from franka_async import Sim

RUN = Path(__file__).with_name("run_program.py")

HOSTS = iter(range(10, 250))
"""The last part of the addresses on which robots listen: pylibfranka takes no port, and each has its own."""


def programs_of(module: ModuleType) -> list[str]:
    functions = inspect.getmembers(module, inspect.isfunction)
    own = [name for name, function in functions if list(inspect.signature(function).parameters)[2:] == ["outcome"]]
    assert own
    return [name for name in own if not name.startswith("_")]


def outcome(programs: str, program: str, package: str, kind: str) -> list[tuple[str, Any]]:
    """Runs a program with a package against a separate robot; returns its notes."""
    start = getattr(Sim, kind)
    with start(virtual_time=True, patience=0.25, ideal=True, hand=True, address=f"{LOOPBACK}.{next(HOSTS)}:1337") as sim:
        address = sim.address.removesuffix(":1337")
        command = [sys.executable, str(RUN), programs, program, package, str(address)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=100, cwd=RUN.parent)
    assert done.returncode == 0, f"{package}: {done.stderr}"
    line = next(line for line in done.stdout.splitlines() if line.startswith("outcome "))
    notes: list[tuple[str, Any]] = json.loads(line.removeprefix("outcome "))
    assert notes, "a program notes something"
    return notes


TOLERANCE = {"way of joints": 2e-3, "height": 2e-3, "ended": 0.0}


def assert_same(ours: list[tuple[str, Any]], theirs: list[tuple[str, Any]]) -> None:
    assert [name for name, _ in ours] == [name for name, _ in theirs]
    for (name, mine), (_, other) in zip(ours, theirs, strict=True):
        if any(isinstance(part, str) or part is None for part in np.asarray(other, dtype=object).ravel()):
            assert mine == other, name
        else:
            # The position of the arm differs between two runs by as much as it shakes.
            np.testing.assert_allclose(mine, other, rtol=1e-4, atol=TOLERANCE.get(name, 1e-3), err_msg=name)


def beside(original: str, program: str, programs: str) -> None:
    if importlib.util.find_spec(original) is None:
        pytest.skip(f"{original} is not installed: there is none for this platform or version of Python")
    programs = f"{programs}_{original}"
    ours = outcome(programs, program, f"franka_async.compat.{original}", "fr3")
    assert_same(ours, outcome(programs, program, original, "fr3"))


@pytest.mark.parametrize("program", programs_of(programs_pylibfranka))
def test_programs_for_pylibfranka_have_the_same_outcome(program: str) -> None:
    beside("pylibfranka", program, "programs")


@pytest.mark.parametrize("program", programs_of(programs_franka))
def test_programs_for_franka_have_the_same_outcome(program: str) -> None:
    beside("franka", program, "programs")


@pytest.mark.parametrize("program", ["everything", "hand"])
@pytest.mark.parametrize("original", ["pylibfranka", "franka"])
def test_every_use_and_misuse_has_the_same_outcome(original: str, program: str) -> None:
    """The texts of errors, and the differences that the book lists, are exempt."""
    beside(original, program, "usage")


FR3_ONLY = {"asynchronous", "asynchronous_as_in_the_example", "tolerances"}


@pytest.mark.parametrize("program", sorted({*programs_of(programs_pylibfranka)} - FR3_ONLY))
def test_programs_for_pylibfranka_run_with_a_franka_emika_robot(program: str) -> None:
    """The original does not support this robot: only the names of the notes are compared."""
    package = "franka_async.compat.pylibfranka"
    fer = outcome("programs_pylibfranka", program, package, "fer")
    fr3 = outcome("programs_pylibfranka", program, package, "fr3")
    assert [name for name, _ in fer] == [name for name, _ in fr3]
    raised = [[name, note[:2]] for name, note in fr3 if isinstance(note, list) and len(note) == 4]
    assert raised == [[name, note[:2]] for name, note in fer if isinstance(note, list) and len(note) == 4]


@pytest.mark.parametrize("original, layer", [("pylibfranka", pylibfranka_layer), ("franka", franka_layer)])
def test_the_layers_have_every_name(original: str, layer: ModuleType) -> None:
    if importlib.util.find_spec(original) is None:
        pytest.skip(f"{original} is not installed: there is none for this platform or version of Python")
    program = (
        f"import {original} as o, json, sys\n"
        "names = [n for n in dir(o) if not n.startswith('_')]\n"
        "print(json.dumps({n: [m for m in dir(getattr(o, n)) if not m.startswith('_')] for n in names"
        " if isinstance(getattr(o, n), type)}))"
    )
    printed = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    for name, members in json.loads(printed).items():
        missing = set(members) - set(dir(getattr(layer, name)))
        # The class does not show members that are made per object.
        made = {"Errors", "RobotState", "GripperState", "Model", "FrankaError", "ControlException"}
        if name not in made and not issubclass(getattr(layer, name), BaseException):
            assert not missing - {"motion_finished", "name", "value"}, name


def test_waiting_works_where_an_event_loop_runs() -> None:
    """As in the cells of a notebook."""
    import asyncio

    async def cell() -> str:
        with Sim.fr3(virtual_time=True, ideal=True) as sim:
            robot = pylibfranka_layer.Robot(sim.address, pylibfranka_layer.RealtimeConfig.kIgnore)
            return str(robot.read_once().robot_mode.name)

    assert asyncio.run(cell()) == "Idle"


def test_target_control_of_franka_ends_on_an_arm_that_is_held() -> None:
    with Sim.fr3(virtual_time=True, ideal=True, hand=True) as sim:
        robot = franka_layer.Robot(sim.address, realtime="ignore")
        robot.set_collision_behavior_simple([100.0] * 7, [100.0] * 7, [200.0] * 6, [200.0] * 6)
        targets = robot.cartesian_targets(max_velocity=0.1)
        sim.wall(targets.target()[:3] - [0.0, 0.0, 0.04], [0.0, 0.0, 1.0])
        targets.move_by([0.0, 0.0, -0.12])
        stopping = threading.Thread(target=targets.stop, daemon=True)
        stopping.start()
        stopping.join(60.0)
        assert not stopping.is_alive()
        assert not targets.running


@pytest.mark.parametrize("name", ["ActiveControlBase", "AsyncPositionControlHandler", "Duration", "GripperState", "Model", "RobotState"])
def test_classes_of_pylibfranka_without_a_constructor_make_nothing(name: str) -> None:
    for arguments in ((), (5,)):
        with pytest.raises(TypeError, match="No constructor defined"):
            getattr(pylibfranka_layer, name)(*arguments)


def test_robot_of_pylibfranka_is_looked_for_before_the_real_time_kernel() -> None:
    for realtime in pylibfranka_layer.RealtimeConfig:
        with pytest.raises(pylibfranka_layer.NetworkException):
            pylibfranka_layer.Robot("127.255.255.1", realtime)
