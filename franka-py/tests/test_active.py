"""Active control from a thread of Python, on both robots in virtual time."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any

from conftest import PATIENT
import franka_async
import numpy as np
import pytest
from franka_async import ActiveControl, ActiveError, MotionError, Robot, Sim

ROBOTS = pytest.mark.parametrize("start", [Sim.fr3, Sim.fer])
Start = Callable[..., Sim]



def on(start: Start, program: Callable[[Robot], Coroutine[Any, Any, None]]) -> None:
    """Runs ``program`` with a robot that is connected to a simulated one in virtual time."""

    async def main() -> None:
        with start(virtual_time=True) as sim:
            async with Robot(sim.address, **PATIENT) as robot:
                await program(robot)

    asyncio.run(main())


@ROBOTS
def test_torques_are_written_for_every_state_until_the_last(start: Start) -> None:
    async def program(robot: Robot) -> None:
        control = await robot.active_torques()
        steps = []

        def cycle() -> None:
            with control:
                for number in range(200):
                    state, step = control.read_once()
                    assert state.robot_mode == "move"
                    steps.append(step)
                    control.write_once(np.zeros(7), finished=number == 199)

        await asyncio.to_thread(cycle)
        assert steps == [0.0] + 199 * [0.001]
        assert robot.state().robot_mode == "idle"

    on(start, program)


@ROBOTS
@pytest.mark.parametrize("kind", ["joint_positions", "joint_velocities", "cartesian_pose", "cartesian_velocities"])
def test_the_other_commands_move_the_arm(start: Start, kind: str) -> None:
    """A cosine of one second, there and back at no velocity."""

    async def program(robot: Robot) -> None:
        control = await getattr(robot, f"active_{kind}")("joint_impedance")
        assert repr(control) == f"<ActiveControl by {kind}>"

        def command(at: Any, time: float) -> Any:
            speed = 0.05 * (1.0 - np.cos(2.0 * np.pi * time))
            way = 0.05 * (time - np.sin(2.0 * np.pi * time) / (2.0 * np.pi))
            if kind == "joint_positions":
                return at.q_d + np.eye(7)[3] * way
            if kind == "joint_velocities":
                return np.eye(7)[3] * speed
            if kind == "cartesian_velocities":
                return np.eye(6)[2] * speed
            pose = at.O_T_EE_c
            pose[2, 3] += way
            return pose

        def cycle() -> float:
            first, _ = control.read_once()
            control.write_once(command(first, 0.0))
            for millisecond in range(1, 1101):
                control.read_once()
                time = min(millisecond / 1000.0, 1.0)
                control.write_once(command(first, time), finished=millisecond == 1100)
            last = robot.state()
            moved = last.q[3] - first.q[3] if kind.startswith("joint") else last.O_T_EE[2, 3] - first.O_T_EE[2, 3]
            return float(moved)

        assert await asyncio.to_thread(cycle) == pytest.approx(0.05, abs=0.01)

    on(start, program)


@ROBOTS
def test_a_block_that_raises_has_the_robot_stop(start: Start) -> None:
    async def program(robot: Robot) -> None:
        control = await robot.active_torques()

        def cycle() -> None:
            with control:
                control.read_once()
                control.write_once([0.0] * 7)
                raise KeyError("of the program")

        with pytest.raises(KeyError, match="of the program"):
            await asyncio.to_thread(cycle)
        with pytest.raises(RuntimeError, match="active control was stopped"):
            control.read_once()
        # The next one waits until the robot has stopped.
        with await robot.active_torques() as again:
            state, step = await asyncio.to_thread(again.read_once)
            assert (state.robot_mode, step) == ("move", 0.0)

    on(start, program)


@ROBOTS
def test_reading_leaves_the_interpreter_to_other_threads(start: Start) -> None:
    """Another thread observes that a call is in progress, which requires that the call does not hold the interpreter."""

    async def program(robot: Robot) -> None:
        control = await robot.active_torques()
        seen = threading.Event()

        def read() -> None:
            while not seen.is_set():
                try:
                    control.read_once()
                except RuntimeError:
                    continue  # The other thread is inside.

        def write() -> None:
            for _ in range(100_000):
                try:
                    control.write_once([0.0] * 7)
                except RuntimeError as error:
                    assert "another thread" in str(error)
                    return
                except (ActiveError, MotionError):
                    continue
            pytest.fail("no call was ever under way")

        reader = threading.Thread(target=read)
        reader.start()
        try:
            await asyncio.to_thread(write)
        finally:
            seen.set()
            control.stop()
            reader.join()

    on(start, program)


@ROBOTS
def test_what_cannot_be_sent_is_refused_and_the_motion_goes_on(start: Start) -> None:
    async def program(robot: Robot) -> None:
        control = await robot.active_joint_positions()

        def cycle() -> None:
            first, _ = control.read_once()
            with pytest.raises(ValueError, match=r"command has the shape \[6\], expected \(7,\)"):
                control.write_once([0.0] * 6)
            with pytest.raises(ValueError, match="command holds NaN, expected finite numbers"):
                control.write_once([np.nan] * 7)
            with pytest.raises(ActiveError, match="only be commanded in kExternalController") as refused:
                control.write_once(first.q_d, torques=[0.0] * 7)
            assert refused.value.party == "caller"
            control.write_once(first.q_d)
            control.read_once()
            control.write_once(first.q_d, finished=True)
            with pytest.raises(ActiveError) as over:
                control.read_once()
            assert over.value.kind == "finished"

        await asyncio.to_thread(cycle)
        with pytest.raises(ValueError, match='controller is "soft", expected'):
            robot.active_joint_positions("soft")  # type: ignore[arg-type]

    on(start, program)


@ROBOTS
def test_a_reflex_is_raised_with_its_log(start: Start) -> None:
    async def program(robot: Robot) -> None:
        control = await robot.active_joint_positions()

        def cycle() -> None:
            first, _ = control.read_once()
            with pytest.raises(franka_async.ControlError) as reflex:
                for _ in range(1000):
                    control.write_once(first.q_d + 0.1)
                    control.read_once()
            assert "joint_position_motion_generator_start_pose_invalid" in reflex.value.errors or any(
                "discontinuity" in error for error in reflex.value.errors
            )
            assert len(reflex.value.log.states()) > 0

        await asyncio.to_thread(cycle)

    on(start, program)


@ROBOTS
def test_while_active_control_runs_others_are_refused(start: Start) -> None:
    async def program(robot: Robot) -> None:
        control = await robot.active_torques()
        with pytest.raises(MotionError) as busy:
            await robot.active_torques()
        assert busy.value.kind == "busy"
        control.stop()

    on(start, program)


def test_a_program_without_a_connection_is_told_so() -> None:
    with pytest.raises(franka_async.FrankaError) as error:
        Robot("127.0.0.1").active_torques()
    assert error.value.kind == "not_connected"


def test_the_robot_itself_moves_to_sparse_targets() -> None:
    async def program(robot: Robot) -> None:
        with await robot.asynchronous_joint_positions() as control:
            assert control.status() == ("idle", None)
            target = robot.state().q_d + np.eye(7)[6] * 0.2
            control.set_target(target)
            await control.reached()
            assert control.status() == ("target_reached", None)
            assert np.linalg.norm(robot.state().q_d - target) < 1e-3
        with pytest.raises(RuntimeError, match="asynchronous control was stopped"):
            control.status()

    async def main() -> None:
        # Between targets no command comes that virtual time could wait for.
        with Sim.fr3() as sim:
            async with Robot(sim.address, **PATIENT) as robot:
                await program(robot)

    asyncio.run(main())


def test_a_franka_emika_robot_has_no_sparse_targets() -> None:
    async def program(robot: Robot) -> None:
        with pytest.raises(MotionError) as unsupported:
            await robot.asynchronous_joint_positions()
        assert unsupported.value.kind == "unsupported"

    on(Sim.fer, program)


def test_active_control_is_not_made_by_hand() -> None:
    with pytest.raises(TypeError):
        ActiveControl()
