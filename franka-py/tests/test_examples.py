"""The examples, each run as a separate program against a simulator of the test."""

from __future__ import annotations

import contextlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from franka_async import Sim
from franka_async.options import SimOptions

DIRECTORY = Path(__file__).parents[1] / "examples"

# The last output of each.
PRINTS = {
    "quickstart": r"cancelled: the arm brakes\n",
    "policy": r"followed for \d\.\d s, .*\n",
    "episodes": r"(.*\n)*2 episodes, \d{2,} frames\nreplayed, \d+\.\d mm off at most\n",
    "script": r"back, \d\.\d+ mm off\n",
    "pick": r"holding 30\.0 mm\nput down\n",
    "guarded_move": r"contact at \d\.\d+ m .*\n",
    "impedance_law": r"tried out: 0\.0\d+ rad .*\nheld for 1\.00 s .*\n",
    "explain": r"cartesian_reflex\n<RecordingFile of fr3, .*Contact with the arm.*explained\n",
    "record": r"\d{3,} cycles, \d+ lost\neach joint .* at most \[[0-9. ]*\] rad\n",
    "recover": r"cartesian_reflex\n.*\nrecovered\n",
    "team": r"arrived after .*\nback on the table\n",
    "from_franka": r"\d+ mm up\n",
    "from_pylibfranka": r"finished 0\.0\d* rad from the start\n",
}

OWN_CLOCK = {"quickstart", "policy", "episodes", "script", "impedance_law"}
"""Examples that let time pass themselves: their robots run at most as fast as the clock on the wall, and wait for this
machine."""


def ran(name: str) -> subprocess.CompletedProcess[str]:
    """Runs an example against a simulator of this process."""
    if name == "team":
        sims = Sim.in_step("fr3", "fer", virtual_time=True)
    else:
        pace: SimOptions = {"patience": 5.0} if name in OWN_CLOCK else {"virtual_time": True}
        pace["hand"] = name in ("pick", "episodes")
        sims = [Sim.fr3(**pace)]
    with contextlib.ExitStack() as stack:
        for sim in sims:
            stack.enter_context(sim)
        arguments = [sim.address for sim in sims]
        if name == "guarded_move":
            sims[0].wall(sims[0].true_pose()[:3, 3] - [0.0, 0.0, 0.05], [0.0, 0.0, 1.0])
        elif name in ("pick", "episodes"):
            if name == "pick":
                sims[0].place_object(0.03)
            arguments.append(str(sims[0].hand_address))
        elif name == "team":
            arguments.append("10.0")
        elif name in ("recover", "explain"):
            # With its own simulator, which it pushes.
            arguments = []
        command = [sys.executable, str(DIRECTORY / f"{name}.py"), *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def runs() -> Iterator[dict[str, Future[subprocess.CompletedProcess[str]]]]:
    """Runs all of them in parallel, since most of them wait most of the time."""
    with ThreadPoolExecutor(len(PRINTS)) as pool:
        yield {name: pool.submit(ran, name) for name in PRINTS}


def test_every_example_is_run() -> None:
    assert {path.stem for path in DIRECTORY.glob("*.py")} == {*PRINTS, "test_my_code"}
    listed = set(re.findall(r"`(\w+)\.py`", (DIRECTORY.parent / "README.md").read_text()))
    assert listed == {path.stem for path in DIRECTORY.glob("*.py")}, "the README lists them"


@pytest.mark.parametrize("name", PRINTS)
def test_an_example_runs(name: str, runs: dict[str, Future[subprocess.CompletedProcess[str]]]) -> None:
    done = runs[name].result()
    if name == "impedance_law" and "No module named 'numba'" in done.stderr:
        pytest.skip("numba is not installed")
    assert done.returncode == 0 and not done.stderr, done.stdout + done.stderr
    assert re.search(PRINTS[name] + r"\Z", done.stdout, re.DOTALL), done.stdout


def test_the_tests_of_an_example_pass() -> None:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(DIRECTORY / "test_my_code.py")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, env={**os.environ, "PYTEST_ADDOPTS": ""})
    assert done.returncode == 0 and "5 passed" in done.stdout, done.stdout
