"""An operation is cancelled at any moment: the arm brakes, nothing hangs, and the robot takes the next motion."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Coroutine
from typing import Any

import pytest
from conftest import at_rest, begun, connection, outcome

from franka_async import FrankaError, Latest, MotionError, Operation, Robot, Sim


async def assert_braked(robot: Robot, beyond: float) -> None:
    """The motion has ended short of ``beyond``, m of height, and the arm rests."""
    await outcome(robot.stop())
    while not at_rest(robot):
        await asyncio.sleep(0.001)
    assert robot.pose()[2, 3] < beyond
    assert robot.reference() is None


async def by_timeout(motion: Operation[Any], robot: Robot) -> None:
    async def late() -> None:
        await begun(robot)
        # It has begun: no time is left.
        await asyncio.sleep(0)

    waiting = asyncio.create_task(late())
    task = asyncio.ensure_future(motion)
    await waiting
    with pytest.raises(asyncio.TimeoutError):
        await asyncio.wait_for(task, 0.0)


async def by_cancel(motion: Operation[Any], robot: Robot) -> None:
    task = asyncio.create_task(motion)
    await begun(robot)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task


async def by_group(motion: Operation[Any], robot: Robot) -> None:
    async def fails() -> None:
        await begun(robot)
        raise KeyError

    others = asyncio.all_tasks()
    with pytest.raises(KeyError):
        await asyncio.gather(motion, fails())
    for task in asyncio.all_tasks() - others:
        task.cancel()


async def by_close(motion: Operation[Any], robot: Robot) -> None:
    async def holder() -> None:
        await motion

    coroutine: Coroutine[Any, Any, None] = holder()
    coroutine.send(None)
    await begun(robot)
    coroutine.close()


async def by_forgetting(motion: Operation[Any], robot: Robot) -> None:
    async def holder(motion: Operation[Any]) -> None:
        await motion

    coroutine: Coroutine[Any, Any, None] = holder(motion)
    coroutine.send(None)
    del motion
    await begun(robot)
    del coroutine


WAYS = [by_timeout, by_cancel, by_group, by_close, by_forgetting]


@pytest.mark.parametrize("way", WAYS)
def test_a_motion_that_is_given_up_brakes(live: Sim, way: Any) -> None:
    async def main() -> None:
        async with connection(live) as robot:
            far = robot.pose()[2, 3] + 0.15
            # Only cancelling may end the motion here.
            await way(robot.move_by([0.0, 0.0, 0.2], speed=0.2), robot)
            await assert_braked(robot, far)
            await robot.move_by([0.0, 0.0, 0.01], from_arm=True)

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_stream_that_is_given_up_brakes(live: Sim) -> None:
    async def main() -> None:
        async with connection(live) as robot:
            far = robot.pose()
            far[2, 3] += 0.2

            async def targets() -> Any:
                while True:
                    yield far
                    await asyncio.sleep(0.01)

            for following in [robot.follow(targets(), speed=0.2), robot.follow(Latest(far), speed=0.2)]:
                await by_cancel(following, robot)
                await assert_braked(robot, far[2, 3] - 0.05)

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_cancelled_block_ends_its_session(live: Sim) -> None:
    async def main() -> None:
        async with connection(live) as robot:

            async def session() -> None:
                async with robot.engage() as arm:
                    await arm.move_by([0.0, 0.0, 0.2], speed=0.2)

            task = asyncio.create_task(session())
            await begun(robot)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            await robot.move_by([0.0, 0.0, 0.01], from_arm=True)

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_timeout_of_a_plain_thread_brakes(live: Sim) -> None:
    robot = connection(live)
    robot.connect().wait()
    height = robot.pose()[2, 3]
    with pytest.raises(TimeoutError):
        robot.move_by([0.0, 0.0, 0.2], speed=0.1).wait(timeout=0.3)
    robot.stop().wait()
    assert robot.pose()[2, 3] < height + 0.15
    robot.shutdown().wait()


def test_cancelling_at_random_moments_leaves_a_robot_that_moves(sim: Sim) -> None:
    seed = random.randrange(2**32)
    print(f"seed {seed}")
    chance = random.Random(seed)

    async def main() -> None:
        async with connection(sim) as robot:
            height = robot.pose()[2, 3]
            for _ in range(60):
                goal = robot.pose()
                goal[2, 3] = height + chance.uniform(-0.05, 0.05)
                begin: Any = chance.choice([
                    lambda: robot.move_to(goal),
                    lambda: robot.follow(Latest(goal)),
                    lambda: robot.follow(iter([goal] * 3)),
                    lambda: robot.stop(),
                    lambda: engaged(robot, goal),
                ])
                task = asyncio.ensure_future(begin())
                for _ in range(chance.randrange(4)):
                    await asyncio.sleep(0)
                await asyncio.sleep(chance.choice([0.0, 0.0, 0.0005, 0.003, 0.02]))
                if chance.random() < 0.8:
                    task.cancel()
                ended = await outcome(task)
                assert not isinstance(ended, Exception) or isinstance(ended, FrankaError), repr(ended)
            await outcome(robot.stop())
            # A cancelled session may still be releasing the arm.
            while True:
                ended = await outcome(robot.move_to(robot.pose()))
                if not isinstance(ended, MotionError):
                    break
                assert ended.kind in ("busy", "superseded", "stopped"), repr(ended)
            assert at_rest(robot)

    asyncio.run(asyncio.wait_for(main(), 90))


async def engaged(robot: Robot, goal: Any) -> None:
    async with robot.engage() as arm:
        await arm.set(goal)
        await arm.move_by([0.0, 0.01, 0.0])


def test_connecting_is_given_up(sim: Sim) -> None:
    async def main() -> None:
        robot = connection(sim)
        for turns in range(6):
            task = asyncio.ensure_future(robot.connect())
            for _ in range(turns):
                await asyncio.sleep(0.001)
            task.cancel()
            await outcome(task)
        # The simulated robot has one client at a time: the last client has to leave first.
        while isinstance(await outcome(robot.connect()), FrankaError):
            await asyncio.sleep(0.01)
        assert robot.state().time_ms > 0
        await robot.shutdown()

    asyncio.run(asyncio.wait_for(main(), 60))
