"""Tools by name, their file, and identification."""

import asyncio
import json
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import PATIENT
from franka_async import CommandError, Identified, Robot, Sim, tools
from franka_async.tools import Tool, ToolFileError

FRAME = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.01], [0.0, 0.0, 1.0, 0.1], [0.0, 0.0, 0.0, 1.0]]
SCREWDRIVER = Tool(mass=0.7, center=(0.0, 0.01, 0.06), inertia=np.diag([1e-3, 1e-3, 5e-4]), frame=FRAME)


@pytest.fixture(autouse=True)
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("FRANKA_TOOLS", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "franka_async" / "tools.json"


def test_tools_are_kept_by_name(file: Path) -> None:
    assert tools.names() == [] and tools.path() == file
    tools.save("screwdriver", SCREWDRIVER)
    tools.save("brush", Tool(mass=0.1))
    assert tools.names() == ["brush", "screwdriver"]
    assert tools.get("screwdriver") == SCREWDRIVER
    tools.save("brush", Tool(mass=0.2))
    assert tools.get("brush").mass == 0.2
    tools.delete("brush")
    with pytest.raises(KeyError, match="got the tool 'brush', expected a tool of .*: screwdriver"):
        tools.get("brush")
    # No other file is left in the directory.
    assert os.listdir(file.parent) == ["tools.json"]
    assert pickle.loads(pickle.dumps(SCREWDRIVER)) == SCREWDRIVER


def test_a_robot_is_told_of_a_tool_and_of_none(franka_robot: Robot) -> None:
    async def main() -> None:
        tools.save("screwdriver", SCREWDRIVER)
        assert await tools.load(franka_robot, "screwdriver") == SCREWDRIVER
        # The answer comes before the state that shows it.
        async for state in franka_robot.states():
            if state.m_load > 0 and state.NE_T_EE[2, 3] > 0:
                break
        assert state.m_load == pytest.approx(0.7)
        np.testing.assert_allclose(state.F_x_Cload, np.asarray(SCREWDRIVER.center), atol=1e-7)
        np.testing.assert_allclose(state.I_load, np.asarray(SCREWDRIVER.inertia), atol=1e-9)
        np.testing.assert_allclose(state.NE_T_EE, FRAME, atol=1e-7)
        await tools.unload(franka_robot)
        async for state in franka_robot.states():
            if state.m_load == 0 and state.NE_T_EE[2, 3] == 0:
                break
        np.testing.assert_array_equal(state.NE_T_EE, np.eye(4))

    asyncio.run(main())


def test_a_robot_that_moves_refuses_a_tool(fr3: Robot) -> None:
    async def main() -> None:
        moving = asyncio.ensure_future(fr3.move_by([0.0, 0.0, 0.1], speed=0.1))
        while fr3.state().robot_mode != "move":
            await asyncio.sleep(0)
        with pytest.raises(CommandError):
            await tools.load(fr3, SCREWDRIVER)
        moving.cancel()

    asyncio.run(main())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "tools.json, line 1, column 2: Expecting property name"),
        ("[]", 'expected an object with "version" and "tools"'),
        ('{"version": 2, "tools": {}}', "got the version 2, expected 1"),
        ('{"version": 1, "tools": {"a": {"mass": -1}}}', "tool 'a': mass is -1, expected a finite number of 0 or more"),
        ('{"version": 1, "tools": {"a": {"weight": 1}}}', "tool 'a': .*unexpected keyword argument 'weight'"),
        (
            '{"version": 1, "tools": {"a": {"center": [1, 2]}}}',
            r"tool 'a': center has the shape \(2,\), expected \(3,\)",
        ),
    ],
)
def test_a_broken_file_is_named_and_left_alone(file: Path, text: str, message: str) -> None:
    file.parent.mkdir()
    file.write_text(text)
    with pytest.raises(ToolFileError, match=message):
        tools.names()
    with pytest.raises(ToolFileError):
        tools.save("brush", Tool(mass=0.1))
    assert file.read_text() == text


def test_a_write_that_fails_leaves_the_file_as_it_was(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tools.save("brush", Tool(mass=0.1))
    before = file.read_text()

    def fail(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="no space left"):
        tools.save("screwdriver", SCREWDRIVER)
    assert file.read_text() == before and os.listdir(file.parent) == ["tools.json"]


def test_the_file_may_be_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRANKA_TOOLS", str(tmp_path / "mine.json"))
    tools.save("brush", Tool(mass=0.1))
    assert json.loads((tmp_path / "mine.json").read_text())["tools"]["brush"]["mass"] == 0.1
    monkeypatch.delenv("FRANKA_TOOLS")
    monkeypatch.setenv("XDG_CONFIG_HOME", "relative")
    assert tools.path() == Path.home() / ".config" / "franka_async" / "tools.json"


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"mass": float("nan")}, "mass is nan"),
        ({"inertia": np.arange(9.0).reshape(3, 3)}, "expected a symmetric matrix"),
        ({"inertia": np.diag([1e-4, 1e-4, 5e-3])}, "principal moments 0.0001, 0.0001 and 0.005 kg m.2, expected no moment below 0"),
        ({"inertia": np.diag([1e-3, 1e-3, -1e-4])}, "principal moments -0.0001, 0.001 and 0.001 kg m.2, expected no moment below 0"),
        ({"frame": 2 * np.eye(4)}, "expected a rigid transformation"),
        ({"center": [0.0, float("inf"), 0.0]}, "center holds inf, expected finite numbers"),
    ],
)
def test_tools_that_make_no_sense_are_refused(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Tool(**fields)


def test_a_thin_plate_is_a_tool() -> None:
    """Its greatest moment is the sum of the others; rounded to six digits, it is greater than the sum."""
    for moment in (1.234567e-4, 4e-7):
        assert Tool(mass=0.1, inertia=np.diag([moment, moment, 2 * moment])).mass == 0.1


def test_a_plan_is_shown_before_anything_moves(fr3: Robot) -> None:
    plan = fr3.identify()
    assert plan.waypoints.shape == (31, 7)
    np.testing.assert_allclose(plan.waypoints[-1], fr3.state().q, atol=1e-4)
    assert 50 < plan.duration < 65 and 0 < plan.reach < 0.2 and plan.reach_down < plan.reach
    assert plan.reach_of_joints.shape == (7,)
    assert len(str(plan).splitlines()) == 31
    assert fr3.stats()["commands"] == 0


def test_what_is_on_the_flange_is_found_and_declared(fr3: Robot, sim_fr3: Sim) -> None:
    async def main() -> None:
        sim_fr3.attach(1.2, [0.0, 0.02, 0.05])
        found = await fr3.identify().run()
        assert found.kind == "fr3"
        assert found.mass == pytest.approx(1.2, abs=0.15)
        assert found.friction.shape == found.bias.shape == found.friction_deviation.shape == (7,)
        assert (found.friction > 0).any()
        assert found.center is not None
        np.testing.assert_allclose(found.center, [0.0, 0.02, 0.05], atol=0.03)
        # Stored, and used by a later connection from the beginning.
        again = Identified.from_json(found.to_json())
        assert again == found and pickle.loads(pickle.dumps(found)) == found
        assert "load" in str(found)
        await fr3.shutdown()
        async with Robot(sim_fr3.address, **PATIENT, known=again) as later:
            await later.move_by([0.0, 0.0, 0.02])

    asyncio.run(main())


def test_text_that_is_no_identification_is_refused() -> None:
    with pytest.raises(ValueError, match="text is not an identification"):
        Identified.from_json("{}")
