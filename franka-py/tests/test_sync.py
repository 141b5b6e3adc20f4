"""The classes that wait."""

from __future__ import annotations

import ast
import inspect
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import PATIENT, until
from stubs import NATIVE, SYNC, native, sync as sync_stub

import franka_async
from franka_async import ControlError, FrankaError, Joints, Latest, MotionError, Sim, _native, sync


def test_a_program_without_an_event_loop(sim: Sim) -> None:
    with sync.Robot(sim.address, **PATIENT) as robot:
        assert isinstance(robot, sync.Robot) and robot.is_connected and "Robot at" in repr(robot)
        height = robot.pose()[2, 3]
        report = robot.move_by([0.0, 0.0, 0.03])
        assert report.final_error is not None and report.final_error.translation < 2e-3
        with robot.engage() as arm:
            assert isinstance(arm, sync.Arm)
            arm.move_by([0.0, 0.0, -0.03])
            arm.set(Joints(robot.state().q))
            arm.at_rest()
            pose = robot.pose()

            def targets() -> Iterator[Any]:
                for _ in range(5):
                    pose[2, 3] += 0.002
                    yield pose

            arm.follow(targets())
            latest = Latest(pose)
            latest.close()
            with pytest.raises(MotionError):
                arm.follow(latest)
        with pytest.raises(MotionError):
            arm.move_by([0.0, 0.0, 0.01])
        for state in robot.states():
            assert abs(state.O_T_EE[2, 3] - height) < 0.05
            break
        assert robot.connect() is robot
        np.testing.assert_allclose(robot.pose_at(robot.state().q), robot.pose(), atol=1e-3)
    with pytest.raises(FrankaError):
        robot.state()


def test_the_end_of_a_block_does_not_repeat_what_was_raised_in_it(sim: Sim) -> None:
    with sync.Robot(sim.address, **PATIENT) as robot:
        with robot.engage() as arm:
            sim.trip("cartesian_reflex")
            with pytest.raises(ControlError):
                arm.ended()
            robot.recover()
        with pytest.raises(ControlError), robot.engage() as arm:
            sim.trip("cartesian_reflex")
            until(lambda: "disengaged" in repr(arm))


def test_a_stop_of_another_thread_ends_what_waits(live: Sim) -> None:
    with sync.Robot(live.address, **PATIENT) as robot:

        def stop() -> None:
            until(lambda: robot.reference() is not None)
            robot.stop()

        thread = threading.Thread(target=stop)
        thread.start()
        with pytest.raises(MotionError) as caught:
            robot.move_by([0.0, 0.0, 0.2], speed=0.1)
        thread.join()
        assert caught.value.kind == "stopped"


def test_ctrl_c_ends_what_waits(live: Sim) -> None:
    with sync.Robot(live.address, **PATIENT) as robot:

        def interrupt() -> None:
            until(lambda: robot.reference() is not None)
            signal.raise_signal(signal.SIGINT)

        height = robot.pose()[2, 3]
        thread = threading.Thread(target=interrupt)
        with pytest.raises(KeyboardInterrupt):
            thread.start()
            robot.move_by([0.0, 0.0, 0.2], speed=0.1)
        thread.join()
        robot.stop()
        assert robot.pose()[2, 3] < height + 0.15


def test_stubs_are_made_of_the_native_module() -> None:
    """Docstrings, and the classes that wait."""
    assert native(NATIVE.read_text()) == NATIVE.read_text(), "run tests/stubs.py"
    assert SYNC.read_text() == sync_stub(), "run tests/stubs.py"


def test_every_public_method_has_a_docstring() -> None:
    """Checks the stub, which editors show."""
    without = []
    classes = (node for node in ast.parse(NATIVE.read_text()).body if isinstance(node, ast.ClassDef))
    for node in classes:
        for member in node.body:
            is_setter = isinstance(member, ast.FunctionDef) and any("setter" in ast.unparse(one) for one in member.decorator_list)
            if isinstance(member, ast.FunctionDef) and not member.name.startswith("_") and not is_setter:
                without += [f"{node.name}.{member.name}"] if ast.get_docstring(member) is None else []
    assert without == []


def test_whatever_waits_has_a_twin_with_every_name() -> None:
    tree = ast.parse(NATIVE.read_text())
    awaitables = {"Operation", "Motion", "Follow", "Engagement"}
    checked = []
    for node in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        methods = [method for method in node.body if isinstance(method, ast.FunctionDef)]
        returned = {method.name: ast.unparse(method.returns).split("[")[0] for method in methods if method.returns}
        waiting = {name for name, what in returned.items() if what in awaitables} - {"__aenter__", "__aexit__"}
        native = getattr(_native, node.name)
        if not waiting or node.name == "Source":
            assert hasattr(native, "__enter__") or "__aenter__" not in returned or node.name in awaitables, node.name
            continue
        twin = getattr(sync, node.name)
        wanted = {name for name in vars(native) if not name.startswith("_")}
        wanted |= {name.replace("a", "", 1) for name in vars(native) if name in ("__aenter__", "__aexit__")}
        assert wanted <= set(vars(twin)), node.name
        checked.append(node.name)
    assert set(checked) == {name for name in sync.__all__ if isinstance(getattr(sync, name), type)}


def test_every_coroutine_function_has_a_twin() -> None:
    modules = [franka_async, franka_async.tools, franka_async.otg, franka_async.laws, franka_async.condition, franka_async.pose]
    for module in modules:
        here = module.__name__.removeprefix("franka_async").lstrip(".")
        for name in module.__all__:
            if inspect.iscoroutinefunction(getattr(module, name)):
                twin = getattr(getattr(sync, here), name)
                assert not inspect.iscoroutinefunction(twin)
    assert set(sync.tools.__all__) == set(franka_async.tools.__all__)


def test_tools_and_a_team(sim_fr3: Sim, sim_fer: Sim, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRANKA_TOOLS", str(tmp_path / "tools.json"))
    with (
        sync.Robot(sim_fr3.address, **PATIENT) as left,
        sync.Robot(sim_fer.address, **PATIENT) as right,
    ):
        sync.tools.save("brush", sync.tools.Tool(mass=0.3, center=[0.0, 0.0, 0.05]))
        assert sync.tools.load(left, "brush").mass == 0.3
        until(lambda: abs(left.state().m_load - 0.3) < 1e-6)
        sync.tools.unload(left)
        with sync.Team.engage(left, right, silence=10.0) as team:
            assert isinstance(team, sync.Team) and len(team) == 2
            up = np.eye(4)
            up[2, 3] = 0.03
            reports = team.move_to([up @ left.pose(), up @ right.pose()])
            assert len(reports) == 2
            arm = team.arms[0]
            assert isinstance(arm, sync.Arm)
            arm.move_by([0.0, 0.0, -0.01])
            height = right.pose()[2, 3]
            team.run([lambda arm: arm.hold(), lambda arm: arm.move_by([0.0, 0.0, -0.03])])
            assert right.pose()[2, 3] < height - 0.02
            with pytest.raises(TypeError, match="got 1 motions, expected 2: one for each arm"):
                team.run([lambda arm: arm.hold()])


def test_keyword_arguments_are_taken_as_positional_ones_are(sim: Sim, tmp_path: Path) -> None:
    with sync.Robot(sim.address, **PATIENT) as robot, sync.Recorder.to_file(tmp_path / "run.mcap") as recorder:
        recorder.attach(robot=robot)
        with pytest.raises(FrankaError, match="not connected"):
            recorder.attach_gripper(gripper=sync.Gripper("127.0.0.1"))
