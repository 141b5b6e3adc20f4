"""The programs of the book's pages on Python, run as a reader would run them."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import PATIENT, begun, connection

from franka_async import ControlError, Robot, Sim, sync

BOOK = Path(__file__).parents[2] / "docs" / "src"


def run(page: str, skipped: int = 0) -> dict[str, Any]:
    """Runs the programs of a page except the first ones, and returns the names that they define."""
    programs = re.findall(r"^```python\n(.*?)^```", (BOOK / page).read_text(), re.MULTILINE | re.DOTALL)
    assert programs
    names: dict[str, Any] = {}
    for program in programs[skipped:]:
        # On a busy machine commands and targets come late, so the programs wait for them.
        program = program.replace("Sim.fr3()", "Sim.fr3(patience=0.25)")
        program = program.replace("Deadman(0.5)", "Deadman(60.0)")
        exec(program.replace("watchdog=(0.5, ", "watchdog=(60.0, "), names)
    return names


@pytest.fixture(scope="module")
def chapter() -> dict[str, Any]:
    return run("python.md")


def test_the_programs_of_the_tutorial_run(capsys: pytest.CaptureFixture[str]) -> None:
    run("tutorial/python.md")
    printed = capsys.readouterr().out
    for begin in ("arrived after ", "stopped at ", "followed to ", "caller "):
        assert f"\n{begin}" in printed, printed


def test_the_model_gives_the_pose_of_the_flange() -> None:
    height = run("python-computing.md")["flange"][2, 3]
    assert height == pytest.approx(0.59, abs=0.01)


def test_chunks_are_followed(capsys: pytest.CaptureFixture[str]) -> None:
    run("how-to/chunks.md")
    [line] = capsys.readouterr().out.splitlines()
    assert float(line.split(" mm")[0]) < 20.0


@pytest.mark.parametrize("name", ["careful", "touch", "follow_policy", "follow_moving", "watched"])
def test_the_functions_of_the_chapter_run(chapter: dict[str, Any], live: Sim, name: str) -> None:
    function: Callable[[Robot], Awaitable[None]] = chapter[name]

    async def main() -> None:
        async with connection(live) as robot:
            await function(robot)

    asyncio.run(main())


def test_the_functions_of_the_page_on_franky_run(live: Sim) -> None:
    chapter = run("from-franky.md", skipped=1)  # the first is a table of both packages
    with sync.Robot(live.address, **PATIENT) as robot:
        before = robot.pose()
        chapter["up"](robot)
        assert robot.pose()[2, 3] - before[2, 3] == pytest.approx(0.1, abs=0.002)
        chapter["waypoints"](robot)
        chapter["until_contact"](robot)
        start = robot.pose()
        chapter["at_velocity"](robot, [0.0, 0.05, 0.0, 0.0, 0.0, 0.3], 1.5)
        assert robot.pose()[1, 3] > start[1, 3] + 0.005
        assert robot.pose()[1, 0] > start[1, 0] + 0.05
        chapter["redirected"](robot, robot.pose() @ chapter["by"](0.02, 0.0, 0.0), start)
        assert abs(robot.pose() - start).max() < 0.01


def test_the_pace_of_the_page_on_franky_leaves_room_up_to_a_factor_of_0_8() -> None:
    chapter = run("from-franky.md", skipped=1)

    def turn(factor: float, **options: Any) -> None:
        with Sim.fr3(virtual_time=True, **options) as sim, sync.Robot(sim.address, realtime="ignore", link_timeout=10.0) as robot:
            robot.move_joints(robot.state().q + [1.5, 0, 0, 0, 0, 0, 0], limits=chapter["pace"](robot.model(), factor))

    for options in ({}, {"arm_seed": 1}, {"arm_seed": 2}, {"arm_seed": 3}):
        turn(0.8, **options)
    with pytest.raises(ControlError, match="joint_velocity_violation"):
        turn(1.0)


def test_a_reflex_is_explained_and_recovered_from(
    chapter: dict[str, Any], sim: Sim, capsys: pytest.CaptureFixture[str]
) -> None:
    async def main() -> None:
        async with connection(sim) as robot:
            target = robot.pose()
            target[2, 3] += 0.05
            explained = asyncio.create_task(chapter["move_or_explain"](robot, target))
            await begun(robot)
            sim.trip("cartesian_reflex")
            await explained
            await robot.move_to(target)

    asyncio.run(main())
    assert "cartesian_reflex" in capsys.readouterr().out
