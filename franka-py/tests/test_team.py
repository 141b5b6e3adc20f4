"""Several arms as one, and motions that begin together."""

import asyncio

import numpy as np
import pytest
from numpy.typing import NDArray

import franka_async
from franka_async import Follow, Latest, Motion, MotionError, MotionReport, Robot, Sim, Team, TeamError, start_tickets

# The times of the simulators do not run in step: a robot that waits for the machine is not at fault here.
SILENCE = 10.0


def up(robot: Robot, height: float) -> NDArray[np.float64]:
    pose = robot.pose()
    pose[2, 3] += height
    return pose


async def moves(robots: tuple[Robot, ...], motion: asyncio.Future[list[MotionReport]]) -> None:
    """Waits until each of the arms follows a target: measured velocities are noisy at rest. The motion takes far longer."""
    for robot in robots:
        while (reference := robot.reference()) is None or np.abs(reference.dq).max() < 2e-3:
            assert not motion.done()
            await asyncio.sleep(0)


def test_both_arms_arrive_and_each_has_its_report(fr3: Robot, fer: Robot) -> None:
    async def main() -> None:
        async with await Team.engage(fr3, fer, silence=SILENCE) as team:
            assert len(team) == 2 and team.stopped() is None
            targets = [up(fr3, 0.05), up(fer, -0.05)]
            reports = await team.move_to(targets, speed=1.5)
            assert [type(report) for report in reports] == [MotionReport, MotionReport]
            for robot, target in zip((fr3, fer), targets, strict=True):
                np.testing.assert_allclose(robot.pose()[:3, 3], target[:3, 3], atol=6e-3)
            left, right = team.arms
            reports = await team.run([left.move_by([0.0, 0.0, -0.03]), right.move_by([0.0, 0.0, 0.02])])
            assert len(reports) == 2
            # A held arm keeps its place and does not hold the other one; two held arms keep both places.
            for held in ((True, False), (False, True), (True, True)):
                before = [robot.pose()[2, 3] for robot in (fr3, fer)]
                await team.run([arm.hold() if hold else arm.move_by([0.0, 0.0, 0.02]) for arm, hold in zip(team.arms, held, strict=True)])
                for robot, height, hold in zip((fr3, fer), before, held, strict=True):
                    assert robot.pose()[2, 3] - height == pytest.approx(0.0 if hold else 0.02, abs=6e-3)

    asyncio.run(main())


def test_an_arm_follows_while_the_other_moves() -> None:
    async def main(left: Robot, right: Robot) -> None:
        async with left, right, await Team.engage(left, right, silence=SILENCE) as team:
            one, other = team.arms
            targets = Latest()
            joint = asyncio.ensure_future(team.run([one.move_by([0.0, 0.0, 0.04]), other.follow(targets)]))
            start, end = right.pose(), up(right, 0.02)
            await asyncio.sleep(0.05)
            # Both wait for the first target.
            assert np.abs(left.state().dq).max() < 0.02
            for height in np.linspace(start[2, 3], end[2, 3], 20):
                start[2, 3] = height
                targets.set(start)
                await asyncio.sleep(0.002)
            targets.close()
            reports = await joint
            assert len(reports) == 2
            np.testing.assert_allclose(right.pose()[:3, 3], end[:3, 3], atol=6e-3)
            motions: list[Motion | Follow] = [one.hold(), other.follow(iter([end]))]
            with pytest.raises(ValueError, match="motion 1 follows an iterator, expected a Latest"):
                team.run(motions)
            for motion in motions:
                motion.close()
            with pytest.raises(TypeError):
                team.run([one.hold, other.hold])  # type: ignore[list-item]

    left, right = Sim.in_step("fr3", "fer", virtual_time=True)
    with left, right:
        asyncio.run(main(Robot(left.address, realtime="ignore"), Robot(right.address, realtime="ignore")))


def test_robots_in_step_have_the_same_time() -> None:
    sims = Sim.in_step("fr3", "fr3", "fer", virtual_time=True)
    with sims[0], sims[1], sims[2]:
        for _ in range(100):
            times = [sim.state().time_ms for sim in sims]
            assert max(times) - min(times) <= 60, "between two looks"
    with pytest.raises(ValueError, match="got 1 robots, expected 2 to 4"):
        Sim.in_step("fr3")
    with pytest.raises(ValueError, match="got the robot \"ur5\", expected 'fr3' or 'fer'"):
        Sim.in_step("fr3", "ur5")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="in_step"):
        Sim.in_step("fr3", "fr3", idea=True)  # type: ignore[call-arg]


def test_the_fault_of_one_brakes_the_other_and_is_the_cause(fr3: Robot, sim_fr3: Sim, fer: Robot) -> None:
    async def main() -> None:
        team = await Team.engage(fr3, fer, silence=SILENCE, speed_cap=1.0)
        moving = asyncio.ensure_future(team.move_to([up(fr3, 0.1), up(fer, 0.1)], speed=0.1))
        await moves((fr3, fer), moving)
        sim_fr3.trip("cartesian_reflex")
        with pytest.raises(TeamError, match="arm 0: libfranka: Move command aborted") as raised:
            await moving
        error = raised.value
        assert error.member == 0 and isinstance(error.__cause__, franka_async.ControlError)
        first, second = error.outcomes
        assert first is error.__cause__
        assert isinstance(second, MotionError) and second.kind == "braked"
        assert team.stopped() == ("robot_stopped", 0)
        # The other one is held.
        await team.arms[1].move_to(up(fer, -0.02))
        with pytest.raises(TeamError):
            await team.disengage()
        # A cause that was reported is not raised again.
        async with team:
            pass
        await fr3.recover()
        async with await Team.engage(fr3, fer, silence=SILENCE) as team:
            moving = asyncio.ensure_future(team.move_to([up(fr3, 0.1), up(fer, 0.1)], speed=0.1))
            await moves((fr3, fer), moving)
            sim_fr3.trip("cartesian_reflex")
            with pytest.raises(TeamError):
                await moving
            await fr3.recover()

    asyncio.run(main())


def test_a_stop_and_a_cancellation_brake_all(fr3: Robot, fer: Robot) -> None:
    async def main() -> None:
        async with await Team.engage(fr3, fer, silence=SILENCE) as team:
            for stop in (team.stop, None):
                moving = asyncio.ensure_future(team.move_to([up(fr3, 0.1), up(fer, 0.1)], speed=0.1))
                await moves((fr3, fer), moving)
                if stop is None:
                    moving.cancel()
                    with pytest.raises(asyncio.CancelledError):
                        await moving
                else:
                    stop()
                    with pytest.raises(TeamError) as raised:
                        await moving
                    assert [getattr(outcome, "kind", None) for outcome in raised.value.outcomes] == ["braked", "braked"]
                    assert team.stopped() == "requested"
                # At rest, short of the target.
                for arm, robot in zip(team.arms, (fr3, fer), strict=True):
                    await arm.at_rest()
                    assert np.abs(robot.state().dq).max() < 0.02

    asyncio.run(main())


def test_an_object_in_two_hands_moves(fr3: Robot, fer: Robot) -> None:
    async def main() -> None:
        async with await Team.engage(fr3, fer, silence=SILENCE) as team:
            bases = [np.eye(4), np.eye(4)]
            bases[1][:3, 3] = [1.2, 0.0, 0.0]
            bases[1][:2, :2] = -np.eye(2)
            middle = np.eye(4)
            middle[:3, 3] = [0.6, 0.0, 0.4]
            grasp = team.grasp(bases, middle)
            before = grasp.measured()
            for where in before:
                np.testing.assert_allclose(where, middle, atol=5e-3)
            target = middle.copy()
            target[2, 3] += 0.04
            await grasp.move_to(target, speed=0.8)
            for where in grasp.measured():
                np.testing.assert_allclose(where[:3, 3], target[:3, 3], atol=8e-3)

    asyncio.run(main())


def test_what_makes_no_team_is_refused(fr3: Robot, fer: Robot) -> None:
    with pytest.raises(ValueError, match="got 1 robots, expected 2 to 4"):
        Team.engage(fr3)

    async def main() -> None:
        async with await Team.engage(fr3, fer, silence=SILENCE) as team:
            left, right = team.arms
            with pytest.raises(TypeError, match="got 1 targets, expected 2, one for each arm"):
                team.move_to([up(fr3, 0.1)])
            motions = [left.hold(), left.hold()]
            with pytest.raises(ValueError, match=r"motion 1 belongs to another arm, expected a motion of arms\[1\] of this team"):
                team.run(motions)
            for motion in motions:
                motion.close()
            with pytest.raises(TypeError, match="unexpected keyword argument 'sped'"):
                team.move_to([up(fr3, 0.1), up(fer, 0.1)], sped=1.0)  # type: ignore[call-arg]

    asyncio.run(main())


def test_motions_with_tickets_begin_together(fr3: Robot, fer: Robot) -> None:
    async def main() -> None:
        left, right = start_tickets(2)
        first = asyncio.ensure_future(fr3.move_by([0.0, 0.0, 0.03], start_with=left))
        while fr3.state().robot_mode != "move":
            await asyncio.sleep(0)
        # It waits for the other one.
        assert np.abs(fr3.state().dq).max() < 0.02
        await fer.move_by([0.0, 0.0, 0.03], start_with=right)
        assert isinstance(await first, MotionReport)
        with pytest.raises(RuntimeError, match="this ticket already belongs to a motion"):
            fr3.move_by([0.0, 0.0, 0.03], start_with=left)

    asyncio.run(main())


def test_a_member_that_goes_ends_the_wait(fr3: Robot) -> None:
    async def main() -> None:
        left, right = start_tickets(2)
        first = asyncio.ensure_future(fr3.move_by([0.0, 0.0, 0.03], start_with=left))
        while fr3.state().robot_mode != "move":
            await asyncio.sleep(0)
        del right
        with pytest.raises(MotionError) as raised:
            await first
        assert raised.value.kind == "start"

    asyncio.run(main())


def test_a_start_has_members() -> None:
    with pytest.raises(ValueError, match="members is 0, expected 1 to 65535"):
        start_tickets(0)
