"""An engaged arm: its goals, streams of targets, chunks, and bounds."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from typing import Any, get_args

import numpy as np
import pytest
from conftest import begun, connection, outcome

from franka_async import (
    Arm,
    Box,
    BusyError,
    Chunk,
    ControlError,
    Deadman,
    Engagement,
    Gains,
    GuardError,
    Joints,
    Latest,
    Lead,
    MotionError,
    Offset,
    Plane,
    Robot,
    Sim,
)

from franka_async.motion import Guard

NEAR = 3e-3
"""Largest distance of an arm that sticks to its target, m."""


def run(sim: Sim, main: Any) -> None:
    """Runs ``main(robot)`` with a connection to the simulated robot."""

    async def connected() -> None:
        async with connection(sim) as robot:
            await main(robot)

    asyncio.run(asyncio.wait_for(connected(), 90))


def test_a_session_is_entered_or_awaited(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage() as arm:
            assert isinstance(arm, Arm) and arm.reference() is not None
            with pytest.raises(MotionError) as caught:
                await robot.move_by([0.0, 0.0, 0.02])
            assert isinstance(caught.value, BusyError) and caught.value.kind == "busy"
        with pytest.raises(MotionError) as caught:
            arm.try_set(Offset([0.0, 0.0, 0.01]))
        assert caught.value.kind == "disengaged" and arm.target() is None and arm.reference() is None
        arm = await robot.engage(speed=0.8)
        ended = arm.ended()
        report = await arm.disengage()
        assert report.duration >= 0.0 and (await ended).duration == report.duration
        engagement = robot.engage()
        assert isinstance(engagement, Engagement)
        arm = await engagement
        del arm, engagement
        # The last reference has gone: the session ends in the background.
        while isinstance(await outcome(robot.move_by([0.0, 0.0, 0.01])), MotionError):
            await asyncio.sleep(0.01)

    run(sim, main)


def test_the_error_of_a_block_is_not_replaced_by_its_end(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        with pytest.raises(KeyError):
            async with robot.engage() as arm:
                sim.trip("cartesian_reflex")
                await outcome(arm.ended())
                raise KeyError
        await robot.recover()
        with pytest.raises(MotionError) as caught:
            async with robot.engage() as arm:
                sim.trip("cartesian_reflex")
                await unnoticed_end(arm)
        assert caught.value.kind == "reflex_aborted"

    run(sim, main)


async def unnoticed_end(arm: Arm) -> None:
    """Waits for the end of a session without reading its cause."""
    while "disengaged" not in repr(arm):
        await asyncio.sleep(0.001)


def test_the_end_of_a_block_does_not_repeat_what_was_raised_in_it(live: Sim) -> None:
    async def ask(arm: Arm) -> None:
        while True:
            arm.try_set(Offset([0.0, 0.0, 0.001]))
            await asyncio.sleep(0.001)

    async def iterate(arm: Arm) -> None:
        def targets() -> Iterator[Any]:
            while True:
                yield here[0]
                time.sleep(0.002)

        await arm.follow(targets())

    asked: list[Callable[[Arm], Awaitable[Any]]] = [
        lambda arm: arm.move_by([0.0, 0.0, 0.2], speed=0.1),
        lambda arm: arm.ended(),
        lambda arm: arm.follow(latest),
        ask,
        iterate,
    ]
    latest = Latest()
    here: list[Joints] = []

    async def main(robot: Robot) -> None:
        here.append(Joints(robot.state().q))
        latest.set(here[0])
        for each in asked:
            async with robot.engage() as arm:
                assert repr(arm).startswith("<Arm of 127.0.0.1:") and repr(arm).endswith(", engaged>")
                await arm.hold()
                motion = asyncio.ensure_future(each(arm))
                await asyncio.sleep(0.02)
                live.trip("cartesian_reflex")
                with pytest.raises(ControlError):
                    await motion
                await robot.recover()
            # The arm of the finished session raises the same error as before.
            with pytest.raises(ControlError):
                await arm.hold()
        async with robot.engage() as arm:
            motion = asyncio.ensure_future(arm.move_by([0.0, 0.0, 0.2], speed=0.1))
            await begun(robot)
            await robot.stop()
            with pytest.raises(MotionError) as stopped:
                await motion
            assert stopped.value.kind == "stopped"
        # A goal that was stopped alone does not report the end of the session.
        with pytest.raises(MotionError) as stopped:
            async with robot.engage() as arm:
                goal = arm.move_by([0.0, 0.0, 0.2], speed=0.1)
                motion = asyncio.ensure_future(goal)
                await begun(robot)
                goal.handle().cancel()
                with pytest.raises(MotionError):
                    await motion
                await arm.hold()
                await robot.stop()
                await unnoticed_end(arm)
        assert stopped.value.kind == "stopped"

    run(live, main)


def test_goals_follow_each_other_without_a_stop(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage() as arm:
            start = robot.pose()
            await arm.move_by([0.0, 0.0, 0.03])
            await arm.move_joints(robot.state().q + 0.03)
            target = arm.target()
            assert isinstance(target, Joints)
            await arm.move_to(start)
            pose = arm.target()
            assert isinstance(pose, np.ndarray)
            np.testing.assert_allclose(pose, start, atol=1e-9)
            await arm.move_through([Joints(robot.state().q + 0.02), Joints(robot.state().q)])
            await arm.set(start)
            assert not await arm.at_rest(timeout=0.0)
            assert await arm.at_rest()
            assert np.linalg.norm(robot.pose()[:3, 3] - start[:3, 3]) < NEAR
            for _ in range(3):
                arm.try_set(Offset([0.0, 0.0, 0.01]))
                await arm.at_rest()
            assert abs(robot.pose()[2, 3] - start[2, 3] - 0.03) < NEAR
            await arm.set((start, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
            assert isinstance(arm.target(), tuple)
            report = await arm.hold()
            assert report.final_error is None

    run(sim, main)


def test_a_chunk_is_followed_to_its_end(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage() as arm:
            count = 20
            way = 0.04 * (1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2.0
            start = robot.pose()
            positions = start[:3, 3] + way[:, None] * [0.0, 1.0, 0.0]
            await arm.chunk(positions, dt=0.1, observed_at=robot.state())
            await arm.at_rest()
            assert np.linalg.norm(robot.pose()[:3, 3] - positions[-1]) < NEAR
            quaternions = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
            await arm.chunk(Chunk(np.hstack([positions[::-1], quaternions]), times=0.1 * np.arange(1, count + 1)))
            await arm.at_rest()
            assert np.linalg.norm(robot.pose()[:3, 3] - positions[0]) < NEAR
            poses = np.tile(robot.pose(), (count, 1, 1))
            poses[:, 2, 3] += way
            twists = np.zeros((count, 6))
            await arm.chunk(poses, dt=0.1, velocities=twists, blend=0.0)
            await arm.at_rest()
            q = robot.state().q
            joints = q + way[:, None]
            await arm.chunk(joints, dt=0.1, joints=True, velocities=np.gradient(joints, 0.1, axis=0))
            await arm.at_rest()
            np.testing.assert_allclose(robot.state().q, joints[-1], atol=5e-3)
            for wrong, text in [
                (dict(points=positions), "dt and times, expected one"),
                (dict(points=positions[:, :2], dt=0.1), r"positions \(N, 3\)"),
                (dict(points=positions, times=[0.1, 0.2]), "a time for each point"),
                (dict(points=joints, dt=0.1, joints=True, velocities=joints[:3]), "a row for each point"),
                (dict(points=positions * np.nan, dt=0.1), "finite"),
                (dict(points=positions, dt=-0.1), "expected a number of 0 or more"),
                (dict(points=positions[:0], dt=0.1), "point"),
            ]:
                with pytest.raises(ValueError, match=text):
                    arm.chunk(**wrong)  # type: ignore[arg-type]
            with pytest.raises(TypeError, match="observed_at is 0.5, expected a RobotState"):
                arm.chunk(positions, dt=0.1, observed_at=0.5)  # type: ignore[arg-type]

    run(sim, main)


def test_targets_come_from_any_iterator(sim: Sim) -> None:
    steps = 15

    async def main(robot: Robot) -> None:
        follow: Any
        targets: Any

        def heights() -> Iterator[np.ndarray]:
            pose = robot.pose()
            for _ in range(steps):
                pose[2, 3] += 0.002
                yield pose.copy()
                time.sleep(0.002)

        async def heights_later() -> AsyncIterator[tuple[np.ndarray, list[float]]]:
            for pose in heights():
                yield pose, [0.0, 0.0, 0.05, 0.0, 0.0, 0.0]
                await asyncio.sleep(0.001)

        for follow in [robot.follow, None]:
            if follow is None:
                arm = await robot.engage()
                follow = arm.follow
            for targets in [heights, heights_later]:
                start = robot.pose()[2, 3]
                report = await follow(targets(), lead=Lead(0.1, 0.5, 0.5), watchdog=(5.0, "brake"))
                assert report.duration > 0.0
                assert abs(robot.pose()[2, 3] - start - 0.002 * steps) < NEAR
            q = robot.state().q
            await follow(iter([Joints(q), Joints(q + 0.01), (q + 0.02, [0.0] * 7)]))

    run(sim, main)


def test_what_an_iterator_raises_brakes_the_arm_and_is_raised(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        def plain() -> Iterator[Any]:
            yield robot.pose()
            raise KeyError("plain")

        async def later() -> AsyncIterator[Any]:
            yield robot.pose()
            raise KeyError("later")

        def wrong() -> Iterator[Any]:
            yield [1.0, 2.0]

        async def wrong_later() -> AsyncIterator[Any]:
            yield [1.0, 2.0]

        async with robot.engage() as arm:
            targets: Any
            for targets, error in [(plain, KeyError), (later, KeyError), (wrong, ValueError), (wrong_later, ValueError)]:
                with pytest.raises(error):
                    await arm.follow(targets())
            with pytest.raises(TypeError, match="targets is 7"):
                arm.follow(7)  # type: ignore[arg-type]
            with pytest.raises(RuntimeError, match="event loop"):
                operation = arm.follow(later())
                await asyncio.to_thread(operation.wait)
            operation.close()

    run(sim, main)


def test_the_latest_target_is_set_from_anywhere(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        start = robot.pose()
        latest = Latest()
        following = asyncio.create_task(robot.follow(latest, speed=0.5))

        def policy() -> None:
            pose = start.copy()
            for _ in range(10):
                pose[2, 3] += 0.003
                latest.set(pose)
                time.sleep(0.002)
            latest.close()

        await asyncio.to_thread(policy)
        await following
        assert abs(robot.pose()[2, 3] - start[2, 3] - 0.03) < NEAR
        with pytest.raises(RuntimeError, match="close"):
            latest.set(start)
        with pytest.raises(ValueError, match="shape"):
            Latest([0.1, 0.2, 0.3])
        # The program holds no reference any more: the motion ends at the last target.
        latest = Latest(start)
        following = asyncio.create_task(robot.follow(latest))
        del latest
        await following
        assert np.linalg.norm(robot.pose()[:3, 3] - start[:3, 3]) < NEAR
        with pytest.raises(MotionError, match="ended before its first target") as caught:
            closed = Latest()
            closed.close()
            await robot.follow(closed)
        assert caught.value.kind == "goal"

    run(sim, main)


def test_a_silent_stream_is_given_up(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        for then, kind in [("brake", "braked"), ("hold", "held")]:
            latest = Latest(robot.pose())
            with pytest.raises(MotionError) as caught:
                await robot.follow(latest, watchdog=(0.1, then))  # type: ignore[arg-type]
            assert caught.value.kind == kind
        with pytest.raises(ValueError, match="'brake' or 'hold'"):
            robot.follow(Latest(), watchdog=(0.1, "stop"))  # type: ignore[arg-type]
        for name, value, expected in [
            ("watchdog", "brake", ": expected a pair"),
            ("speed", "fast", ": "),
            ("gains", "soft", ", expected Gains"),
            ("limits", 0.5, ", expected a Budget"),
            ("tolerance", 1.0, ", expected a Tolerance"),
            ("lead", 0.1, ", expected a Lead"),
        ]:
            with pytest.raises(TypeError, match=f"^{name} is {value!r}{expected}"):
                robot.follow(Latest(), **{name: value})  # type: ignore[arg-type]

    run(sim, main)


def test_a_session_is_tuned_and_guided(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage() as arm:
            await arm.tune(gains=Gains.droid(), force_cap=40.0, posture=robot.state().q)
            await arm.tune(limits=robot.budget().scaled(0.1), gains=Gains())
            slow = await arm.move_by([0.0, 0.0, 0.03])
            await arm.tune(limits=robot.budget(), force_cap=None)
            fast = await arm.move_by([0.0, 0.0, -0.03])
            assert slow.duration > 2.0 * fast.duration
            with pytest.raises(MotionError):
                await arm.tune(force_cap=1e6)
            with pytest.raises(TypeError, match="speed"):
                arm.tune(speed=0.5)  # type: ignore[call-arg]
            before = robot.pose()
            await arm.guide(axes=[False, True, False, False, False, False], elbow=False)
            sim.push([0.0, 15.0, 0.0], duration=1.0)
            async for state in robot.states():
                if state.O_T_EE[1, 3] > before[1, 3] + 0.02:
                    break
            sim.let_go()
            await arm.hold()
            assert abs(robot.pose()[2, 3] - before[2, 3]) < 0.02

    run(sim, main)


def test_regions_are_kept_out_of(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        height = robot.pose()[2, 3]
        box = Box([0.5, 0.0, height - 0.55, 0.0, 0.0, 0.0, 1.0], [2.0, 2.0, 1.0])
        regions: list[Plane | Box] = [Plane.floor(height - 0.05), box]
        for region in regions:
            async with robot.engage(keep_out=[region]) as arm:
                with pytest.raises(MotionError):
                    await arm.move_by([0.0, 0.0, -0.15])
                assert robot.pose()[2, 3] > height - 0.06
            await robot.move_by([0.0, 0.0, height - robot.pose()[2, 3]])
        with pytest.raises(TypeError, match="Plane or a Box"):
            robot.engage(keep_out=[3])  # type: ignore[list-item]

    run(sim, main)


def test_an_arm_that_ignores_its_commands_is_named(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        sim.freeze()
        with pytest.raises(MotionError, match="did not move although it received commands"):
            await robot.move_by([0.0, 0.1, 0.0])
        sim.freeze(None)
        await robot.move_by([0.0, 0.05, 0.0])
        with pytest.raises(ValueError, match="controllers"):
            sim.freeze("hand")  # type: ignore[arg-type]

    run(sim, main)


def test_a_session_is_no_faster_than_its_cap(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage(speed_cap=0.15) as arm:
            await arm.move_by([0.0, 0.0, -0.1], speed=1.0)
            turned = robot.state().q
            turned[0] += 0.4
            with pytest.raises(MotionError, match="exceeded its speed cap"):
                await arm.move_joints(turned, speed=1.5)
        with pytest.raises(MotionError, match="speed cap"):
            await robot.engage(speed_cap=0.01)

    run(sim, main)


def test_an_arm_holds_while_its_deadman_is_silent(live: Sim) -> None:
    async def main(robot: Robot) -> None:
        with pytest.raises(ValueError, match="expected at least 10 ms"):
            Deadman(0.0)
        deadman = Deadman(2.0)
        assert deadman.silence == 2.0
        async with robot.engage(deadman=deadman) as arm:
            motion = asyncio.create_task(arm.move_by([0.0, 0.0, 0.1], speed=0.1))
            await begun(robot)
            deadman.keep_alive()
            deadman.release()
            with pytest.raises(MotionError) as caught:
                await motion
            assert isinstance(caught.value, GuardError) and caught.value.kind == "held"
            reference = arm.reference()
            assert reference is not None and "deadman" in reference.guards
            assert set(reference.guards) <= set(get_args(Guard))
            # A stream that is closed then has no last target.
            targets = Latest(robot.pose())
            assert repr(targets) == "<Latest, with a target>" and "without" in repr(Latest())
            following = asyncio.ensure_future(arm.follow(targets))
            targets.close()
            assert repr(targets) == "<Latest, closed>"
            with pytest.raises(MotionError) as caught:
                await following
            assert caught.value.kind == "held"
            with pytest.raises(ValueError, match="bound to a session"):
                robot.engage(deadman=deadman)

    run(live, main)


def test_the_robots_own_controllers_are_backends(sim: Sim) -> None:
    async def main(robot: Robot) -> None:
        async with robot.engage(backend=("joint_impedance", "joint_positions")) as arm:
            report = await arm.move_by([0.0, 0.0, 0.02])
            assert report.compensation is None
        for wrong in ["robot", ("joint_impedance", "torques"), ("no", "joint_positions"), 3]:
            with pytest.raises(ValueError, match="backend is"):
                robot.engage(backend=wrong)  # type: ignore[arg-type]

    run(sim, main)
