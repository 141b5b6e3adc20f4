"""The classes that wait."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from conftest import until
from sync_stub import STUB, stub

from franka_async import FrankaError, Joints, Latest, MotionError, Sim, sync


def test_a_program_without_an_event_loop(sim: Sim) -> None:
    with sync.Robot(sim.address, realtime="ignore") as robot:
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


def test_a_stop_of_another_thread_ends_what_waits(live: Sim) -> None:
    with sync.Robot(live.address, realtime="ignore") as robot:

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
    with sync.Robot(live.address, realtime="ignore") as robot:

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


def test_the_stub_is_that_of_the_native_classes() -> None:
    assert STUB.read_text() == stub(), "run tests/sync_stub.py"
