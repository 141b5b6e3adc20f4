"""Kinds and classes of errors."""

from __future__ import annotations

import asyncio
import re
import typing
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import begun, connection, outcome

import franka_async
from franka_async import Gripper, MotionError, Robot, Sim, _native, errors, kinds, motion, supervision

BOOK = Path(__file__).parents[2] / "docs" / "src" / "errors.md"

NEVER = {
    "ActiveError": {"motion"},
    "ControlError": {"motion_started", "success"},
    "ExportError": {"option"},
    "IdentifyError": {"motion"},
    "MotionError": {"control"},
    "RecordError": {"capacity", "cycles", "option", "record"},
    "ReplayError": {"motion", "refused", "speed"},
}
"""Kinds that no program sees: the inner error has its own class, or is a ``ValueError``."""


@pytest.mark.parametrize("name", sorted(_native._names()["errors"]))
def test_kinds_of_a_class_are_in_its_type(name: str) -> None:
    listed = typing.get_args(getattr(kinds, f"{name}Kind"))
    assert set(listed) == set(_native._names()["errors"][name]) - NEVER.get(name, set())
    assert list(listed) == sorted(listed)
    hints = typing.get_type_hints(getattr(errors, name), localns=vars(franka_async) | vars(motion))
    assert set(listed) <= set(typing.get_args(hints["kind"])) | {kind for part in typing.get_args(hints["kind"]) for kind in typing.get_args(part)}


def test_names_of_what_happens_are_in_their_types() -> None:
    named = _native._names()["values"]
    assert set(typing.get_args(supervision.EventKind)) == set(named["EventKind"])
    assert set(typing.get_args(supervision.Condition)) == set(named["Condition"]) - {"unready"}
    assert set(typing.get_args(motion.Guard)) == set(named["Guard"])


def rows() -> dict[str, set[str]]:
    """The variants of each enum in the book, as kinds."""
    tables: dict[str, set[str]] = {}
    rows: set[str] | None = None
    for line in BOOK.read_text().splitlines():
        cells = line.strip("|").split("|")
        if not line.startswith("|"):
            rows = None
        elif rows is None:
            rows = tables.setdefault("".join(re.findall("`(.*?)`", cells[0])), set())
        else:
            variants = re.findall("`(.*?)`", re.sub("<a .*?</a>", "", cells[0]))
            rows |= {re.sub("(?<!^)([A-Z])", r"_\1", variant).lower() for variant in variants}
    return tables


def test_every_variant_in_the_book_has_its_name() -> None:
    """The book has all of them: a check of the workspace compares it with the code."""
    book, named = rows(), _native._names()["variants"]
    assert len(named) > 10
    # Of the feature `foxglove`, which the package is built without.
    book["RecordError"].remove("live")
    for name, variants in named.items():
        assert set(variants) == book[name], name


def test_classes_say_what_happened(live: Sim) -> None:
    async def main(robot: Robot) -> None:
        far = robot.pose()
        far[2, 3] += 0.2
        causes: list[tuple[type, Callable[[], Awaitable[Any]]]] = [
            (errors.SupersededError, lambda: robot.move_to(robot.pose())),
            (errors.StoppedError, robot.stop),
        ]
        for expected, cause in causes:
            moving = asyncio.create_task(outcome(robot.move_to(far, speed=0.1)))
            await begun(robot)
            await cause()
            assert type(await moving) is expected
        refused = await outcome(robot.move_to([5.0, 0.0, 0.0]))
        assert type(refused) is errors.GoalError and refused.kind == "goal"

    async def connected() -> None:
        async with connection(live) as robot:
            await main(robot)

    asyncio.run(asyncio.wait_for(connected(), 60))


def test_lost_connections_are_one_class() -> None:
    with Sim.fr3(virtual_time=True, patience=5.0, hand=True) as sim:
        robot, hand = connection(sim), Gripper(str(sim.hand_address))
        robot.connect().wait()
        hand.connect().wait()
        sim.stop()
        with pytest.raises(errors.ConnectionLostError) as lost:
            robot.move_by([0.0, 0.0, 0.1]).wait()
        assert isinstance(lost.value, MotionError) and lost.value.kind in ("link_lost", "connection_closed")
        with pytest.raises(errors.ConnectionLostError) as unanswered:
            robot.set_collision_behavior("compliant").wait()
        assert isinstance(unanswered.value, errors.CommandError)
        with pytest.raises(errors.ConnectionLostError) as stopped:
            hand.homing().wait()
        assert isinstance(stopped.value, errors.ActionError) and stopped.value.party == "link"
