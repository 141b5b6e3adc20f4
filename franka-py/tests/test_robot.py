"""The connection of a robot, its state, and the process that it lives in."""

from __future__ import annotations

import asyncio
import os
import threading

import numpy as np
import pytest
from conftest import connection, program, until

from franka_async import ConnectError, FrankaError, MotionError, Robot, Sim, TareError, WrenchTare, condition


def test_a_robot_is_connected_within_a_block_and_not_after_it(sim: Sim) -> None:
    async def main() -> None:
        robot = connection(sim)
        assert not robot.is_connected and "not connected" in repr(robot)
        async with robot as entered:
            assert entered is robot and robot.is_connected
            assert await robot.connect() is robot, "connecting twice changes nothing"
            assert robot.address == sim.address
            assert robot.fci_version == (10 if "Fr3" in repr(sim) else 5)
            state = robot.state()
            np.testing.assert_allclose(robot.pose(), state.O_T_EE, atol=1e-3)
            np.testing.assert_allclose(robot.pose_at(state.q), state.O_T_EE, atol=1e-3)
            assert await robot.stop() is None and await robot.recover() is None
        assert not robot.is_connected
        with pytest.raises(FrankaError) as caught:
            robot.state()
        assert caught.value.kind == "not_connected" and sim.address in str(caught.value)
        async with robot:
            assert robot.state().time_ms > state.time_ms

    asyncio.run(main())


def test_what_cannot_be_is_refused_before_anything_is_sent() -> None:
    for options, text in [
        ({"realtime": "maybe"}, "'enforce' or 'ignore'"),
        ({"version": 7}, "5 or 10"),
        ({"connect_timeout": -1.0}, "connect_timeout is -1 s, expected"),
    ]:
        with pytest.raises(ValueError, match=text):
            Robot("127.0.0.1", **options)  # type: ignore[arg-type]


def test_the_environment_says_whether_real_time_is_enforced(sim: Sim, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRANKA_REALTIME", "ignore")
    robot = Robot(sim.address)
    robot.connect().wait()
    robot.shutdown().wait()
    monkeypatch.setenv("FRANKA_REALTIME", "perhaps")
    with pytest.raises(ValueError, match="FRANKA_REALTIME"):
        Robot(sim.address)


def test_a_robot_that_is_not_there_is_a_connect_error() -> None:
    with pytest.raises(ConnectError) as caught:
        Robot("127.0.0.1:9", realtime="ignore").connect().wait()
    error = caught.value
    assert (error.party, error.kind, error.entry) == ("robot", "refused", "connect-refused")
    assert getattr(error, "__notes__", None) in (["In the book: errors.md#connect-refused"], None), "None before Python 3.11"


def test_states_come_at_the_rate_that_is_asked_for(robot: Robot) -> None:
    times = [state.time_ms for state, _ in zip(robot.states(100), range(6))]
    assert min(np.diff(times)) >= 9, times
    stream = robot.state_stream()
    readings = [stream.next(timeout=20.0) for _ in range(20)]
    for before, after in zip(readings, readings[1:]):
        assert after.state.time_ms == before.state.time_ms + 1 + after.missed
    with pytest.raises(ValueError, match="rate"):
        robot.states(0.0)


def test_states_are_for_event_loops_too_and_end_with_the_connection(sim: Sim) -> None:
    async def main() -> None:
        async with connection(sim) as robot:
            times = []
            async for state in robot.states(200.0):
                times.append(state.time_ms)
                if len(times) == 5:
                    break
            assert times == sorted(set(times))
            stream = robot.state_stream()
        async for _ in stream:
            pass

    asyncio.run(asyncio.wait_for(main(), 60))


def test_an_operation_is_awaited_once_and_says_if_it_never_was(robot: Robot) -> None:
    operation = robot.stop()
    assert "not begun" in repr(operation)
    operation.wait()
    with pytest.raises(RuntimeError, match="already awaited"):
        operation.wait()
    with pytest.warns(RuntimeWarning, match="never awaited"):
        robot.stop()


def test_waiting_in_an_event_loop_is_refused(robot: Robot) -> None:
    async def main() -> None:
        with pytest.raises(RuntimeError, match="event loop"):
            robot.stop().wait()
        # An operation that was refused has not begun.
        operation = robot.stop()
        with pytest.raises(RuntimeError, match="event loop"):
            operation.wait()
        assert "not begun" in repr(operation)
        await operation

    asyncio.run(main())


def test_threads_share_a_robot(live: Sim) -> None:
    robot = connection(live)
    robot.connect().wait()
    ends: list[str] = []

    def move() -> None:
        try:
            robot.move_by([0.0, 0.0, 0.15], speed=0.2).wait()
        except MotionError as error:
            ends.append(error.kind)

    def read() -> None:
        for _ in range(500):
            robot.state()

    threads = [threading.Thread(target=move)] + [threading.Thread(target=read) for _ in range(4)]
    for thread in threads:
        thread.start()
    until(lambda: robot.reference() is not None)
    robot.stop().wait()
    for thread in threads:
        thread.join(20.0)
        assert not thread.is_alive()
    assert ends == ["stopped"]
    robot.shutdown().wait()


PROLOGUE = """
import asyncio, os, signal, sys, threading, time
import franka_async
sim = franka_async.Sim.fr3(patience=5.0)
robot = franka_async.Robot(sim.address, realtime="ignore", link_timeout=10.0).connect().wait()
def moving():
    end = time.monotonic() + 30
    while robot.reference() is None:
        assert time.monotonic() < end
        time.sleep(0.001)
"""


def test_the_interpreter_exits_with_a_motion_under_way() -> None:
    text = program(
        PROLOGUE
        + """
def move():
    try:
        robot.move_by([0.0, 0.0, 0.2], speed=0.2).wait()
    except franka_async.MotionError as error:
        print(error.kind, flush=True)
threading.Thread(target=move, daemon=True).start()
moving()
"""
    )
    assert "stopped" in text and "Fatal" not in text and "panicked" not in text


def test_the_interpreter_exits_from_an_event_loop_with_a_motion_under_way() -> None:
    for end in ["", "raise SystemExit", "asyncio.get_running_loop().stop()"]:
        text = program(
            PROLOGUE
            + f"""
async def main():
    task = asyncio.create_task(robot.move_by([0.0, 0.0, 0.2], speed=0.2))
    while robot.reference() is None:
        await asyncio.sleep(0.001)
    {end}
try:
    asyncio.run(main())
except RuntimeError as error:
    assert "loop stopped" in str(error), error
print("left", flush=True)
""",
        )
        assert "Fatal" not in text and "panicked" not in text
        assert "left" in text or end == "raise SystemExit"


def test_ctrl_c_brakes_the_arm_and_raises() -> None:
    text = program(
        PROLOGUE
        + """
def interrupt():
    moving()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
try:
    robot.move_by([0.0, 0.0, 0.2], speed=0.2).wait()
except KeyboardInterrupt:
    robot.stop().wait()
    print("interrupted", abs(robot.state().dq).max() < 0.05, robot.pose()[2, 3] < 0.65)
"""
    )
    assert "interrupted True True" in text


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_child_is_told_so_and_leaves_the_robot_alone() -> None:
    text = program(
        PROLOGUE
        + """
child = os.fork()
if child == 0:
    for use in [robot.state, lambda: robot.move_by([0.0, 0.0, 0.1]).wait(), lambda: franka_async.Sim.fr3()]:
        try:
            use()
            print("no error")
        except RuntimeError as error:
            print("forked" in str(error), flush=True)
    del robot, sim
    sys.exit(0)
_, status = os.waitpid(child, 0)
print("child", status, robot.move_by([0.0, 0.0, 0.01]).wait().duration > 0)
"""
    )
    assert text.count("True") == 4 and "child 0 True" in text and "no error" not in text, text


def test_a_tare_takes_off_what_an_untouched_arm_shows(robot: Robot) -> None:
    tare = robot.tare(0.1).wait()
    assert isinstance(tare, WrenchTare) and tare.states > 20
    assert tare.wrench.shape == tare.deviation.shape == (6,)
    state = robot.state()
    left = tare.compensate(state)
    assert left is not None
    np.testing.assert_allclose(left[:3], state.O_F_ext_hat_K[:3] - tare.wrench[:3])
    torques = state.tau_ext_hat_filtered - tare.joint_torques
    np.testing.assert_allclose(tare.compensate_torques(state), torques)
    assert tare.turned(state) < WrenchTare.NEAR
    for previous, (state, wrench, turned) in zip([state], robot.tared_states(tare, 100), strict=False):
        assert state.time_ms >= previous.time_ms and turned < WrenchTare.NEAR
        np.testing.assert_array_equal(wrench, tare.compensate(state))
    with pytest.raises(ValueError, match="rate is 0"):
        robot.tared_states(tare, 0.0)
    touched = condition.force_z(8.0).tared(tare)
    assert "tared(" in repr(touched)
    report = robot.move_by([0.0, 0.0, 0.01], until=touched).wait()
    assert report.reacted is None
    with pytest.raises(TareError, match="expected 20 ms to 60 s") as caught:
        robot.tare(0.001).wait()
    assert (caught.value.kind, caught.value.party) == ("duration", "caller")
