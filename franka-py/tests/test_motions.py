"""Motions of a robot: every form of target, every option, reports and errors."""

from __future__ import annotations

import asyncio
import math
import pickle
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import at_rest, begun, connection, until
from numpy.typing import ArrayLike, NDArray

from franka_async import (
    Budget,
    ControlError,
    Deviation,
    Gains,
    Joints,
    Latest,
    Leash,
    Limits,
    MotionError,
    MotionReport,
    Offset,
    Robot,
    Settling,
    Sim,
    Tolerance,
    Waypoint,
    condition,
)
from franka_async.condition import POSITION_Z, SPEED, elapsed, force_z, joint_position

NEAR = 2e-3
"""Largest distance of an arm that sticks to its target, m and rad."""


def turned_about_z(angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def angle_between(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(np.arccos(np.clip((np.trace(a[:3, :3].T @ b[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)))


def assert_near(robot: Robot, target: NDArray[np.float64]) -> None:
    pose = robot.pose()
    assert np.linalg.norm(pose[:3, 3] - target[:3, 3]) < NEAR
    assert angle_between(pose, target) < 2 * NEAR


def test_a_pose_is_said_in_many_ways(robot: Robot) -> None:
    goal = robot.pose()
    goal[:3, 3] += [0.0, 0.02, 0.03]
    quaternion = [1.0, 0.0, 0.0, 0.0]
    upright = goal.copy()
    upright[:3, :3] = np.diag([1.0, -1.0, -1.0])
    position = goal[:3, 3]
    ways: list[tuple[Any, NDArray[np.float64]]] = [
        (goal, goal),
        (goal.astype(np.float32), goal),
        (goal.tolist(), goal),
        ([*position, *quaternion], upright),
        ((position, quaternion), upright),
        (position, upright),
        (turned_about_z(0.2) @ upright[:3, :3], np.block([[turned_about_z(0.2) @ upright[:3, :3], upright[:3, 3:]], [0, 0, 0, 1]])),
        (quaternion, upright),
        (Offset([0.0, -0.02, 0.0]), upright + np.array([[0, 0, 0, 0], [0, 0, 0, -0.02], [0, 0, 0, 0], [0, 0, 0, 0]])),
    ]
    for target, expected in ways:
        report = robot.move_to(target).wait()
        assert report.final_error is not None and report.final_error.translation < NEAR
        assert_near(robot, expected)


def test_an_offset_where_only_a_place_can_be_is_a_type_error(robot: Robot) -> None:
    with pytest.raises(TypeError, match="waypoint 1 is an Offset, expected a pose or Joints"):
        robot.move_through([Offset([0.0, 0.0, 0.02])])  # type: ignore[list-item]
    with pytest.raises(TypeError, match="target is an Offset"):
        force_z(8.0).then(Offset([0.0, 0.0, 0.02]))  # type: ignore[arg-type]


def test_joints_go_where_they_are_told(robot: Robot) -> None:
    q = robot.state().q + 0.05
    robot.move_joints(q).wait()
    np.testing.assert_allclose(robot.state().q, q, atol=5e-3)
    robot.move_to(Joints(q - 0.05)).wait()
    np.testing.assert_allclose(robot.state().q, q - 0.05, atol=5e-3)


def test_an_offset_is_along_the_axes_that_are_named(robot: Robot) -> None:
    start = robot.pose()
    robot.move_by([0.0, 0.0, 0.03, 0.0, 0.0, 0.1]).wait()
    goal = start.copy()
    goal[:3, :3] = turned_about_z(0.1) @ start[:3, :3]
    goal[2, 3] += 0.03
    assert_near(robot, goal)
    start = robot.pose()
    robot.move_by([0.0, 0.0, 0.02], frame="tool", from_arm=True).wait()
    goal = start.copy()
    goal[:3, 3] += start[:3, :3] @ [0.0, 0.0, 0.02]
    assert_near(robot, goal)


@pytest.mark.parametrize(
    ("target", "text"),
    [
        ([0.1, 0.2], r"target has the shape \[2\], expected a pose \(4, 4\)"),
        ([[1.0, 2.0]], r"shape \[1, 2\]"),
        ([np.nan, 0.0, 0.5], "finite"),
        ([0.3, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0], "length 0.000 after its position, expected 1"),
        ([0.4, 0.0, 0.3, -2.4, 0.0, 1.6, 0.8], "joint positions are Joints"),
        ([0.0, 0.0, 0.0, 0.0], "expected a length above 0"),
        (np.full((4, 4), 2.0), "not a rigid transformation"),
        (([0.3, 0.0, 0.5], [1.0, 2.0]), "second of the pair"),
    ],
)
def test_a_target_that_makes_no_sense_is_a_value_error(robot: Robot, target: Any, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        robot.move_to(target)


def test_other_mistakes_in_arguments_are_named(robot: Robot) -> None:
    with pytest.raises(TypeError, match="target has text, expected numbers"):
        robot.move_to("home")
    with pytest.raises(TypeError, match="unexpected keyword argument 'sped'"):
        robot.move_to(robot.pose(), sped=0.5)  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="'base' or 'tool'"):
        robot.move_by([0.0, 0.0, 0.1], frame="world")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"stiffness has the shape \[3\], expected \(6,\)"):
        robot.move_by([0.0, 0.0, 0.1], stiffness=[1.0, 2.0, 3.0])
    with pytest.raises(TypeError, match="until"):
        robot.move_by([0.0, 0.0, 0.1], until=True)  # type: ignore[arg-type]


def test_a_target_out_of_reach_raises_and_nothing_moves(robot: Robot) -> None:
    before = robot.state().q
    with pytest.raises(MotionError) as caught:
        robot.move_to([2.0, 0.0, 0.5]).wait()
    assert (caught.value.kind, caught.value.party, caught.value.is_ready_for_more) == ("goal", "caller", True)
    np.testing.assert_allclose(robot.state().q, before, atol=1e-3)


def test_the_joints_go_where_there_is_no_straight_line(robot: Robot) -> None:
    target = robot.pose()
    target[:3, 3] -= [2.2 * target[0, 3], 0.0, 0.4]  # to the other side of the base
    with pytest.raises(MotionError, match="cannot move to .* in a straight line"):
        robot.move_to(target).wait()
    robot.move_to(target, joint_fallback=True).wait()
    np.testing.assert_allclose(robot.pose(), target, atol=3e-3)


def test_options_change_the_motion(robot: Robot) -> None:
    plain = robot.move_by([0.0, 0.0, 0.04]).wait()
    slow = robot.move_by([0.0, 0.0, -0.04], speed=0.2).wait()
    gentle = robot.move_by([0.0, 0.0, 0.04], limits=Budget(translation=Limits(velocity=0.02))).wait()
    assert slow.duration > 2.0 * plain.duration and gentle.duration > 2.0
    robot.move_by(
        [0.0, 0.0, -0.02],
        limits=robot.budget().scaled(1.2),
        gains=Gains.cartesian().with_cartesian_stiffness([900.0, 900.0, 900.0, 60.0, 60.0, 60.0]),
        stiffness=[800.0] * 3 + [60.0] * 3,
        force_cap=None,
        leash=Leash(translation=0.03),
        deviation=Deviation(joints=float("inf")),
        posture=robot.state().q,
        tolerance=Tolerance(3e-3, 6e-3),
        settling=Settling(hold=0.1, timeout=6.0),
    ).wait()
    with pytest.raises(MotionError, match="faster|speed"):
        robot.move_by([0.0, 0.0, 0.02], speed=100.0).wait()
    with pytest.raises(MotionError, match="stiffness"):
        robot.move_by([0.0, 0.0, 0.02], gains=Gains(cartesian_stiffness=[1e5] * 6)).wait()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda robot: robot.move_to(None), "^target has None, expected numbers"),
        (lambda robot: robot.move_by(None), "^way has None, expected numbers"),
        (lambda robot: robot.move_joints([0.0] * 6 + [None]), "^q has None, expected numbers"),
        (lambda robot: robot.move_joints(["0"] * 7), "^q has text, expected numbers"),
        (lambda robot: robot.move_joints([True] * 7), "^q has truth values, expected numbers"),
        (lambda robot: robot.move_joints(np.zeros(7) * 1j), "^q has complex numbers, expected numbers"),
        (lambda robot: robot.move_through([None]), "^waypoint 1 has None, expected numbers"),
        (lambda robot: robot.move_through([Waypoint(None)]), "^waypoint 1 has None, expected numbers"),  # type: ignore[arg-type]
        (lambda robot: Latest().set(None), "^target has None, expected numbers"),  # type: ignore[arg-type]
        (lambda robot: Joints(None), "^q has None, expected numbers"),  # type: ignore[arg-type]
        (lambda robot: robot.follow(iter([None])).wait(), "^a target has None, expected numbers"),
        (lambda robot: robot.record("q"), r"^columns is 'q', expected a list of names: \['q'\]"),
    ],
)
def test_what_is_no_number_is_named(robot: Robot, call: Callable[[Any], Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        call(robot)


def test_numbers_of_any_kind_are_numbers(robot: Robot) -> None:
    q = robot.state().q
    kinds: list[Any] = [q.tolist(), tuple(q), q.astype(np.float32), np.rint(q).astype(int), [Fraction(x) for x in q], q[::-1][::-1]]
    for same in kinds:
        robot.move_joints(same).close()


def test_a_threshold_is_named_as_in_python() -> None:
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: condition.FORCE_Z.beyond(-8.0), "FORCE_Z"),
        (lambda: condition.force_z(-8.0), "FORCE_Z"),
        (lambda: condition.SPEED > math.inf, "SPEED"),
        (lambda: condition.joint_torque(3) > math.nan, r"joint_torque\(3\)"),
    ]
    for call, name in calls:
        with pytest.raises(ValueError, match=f"the threshold for {name} is .*, expected a finite number"):
            call()


def test_values_compare_and_print_and_pickle() -> None:
    for value in [
        Gains.joint(),
        Gains.droid(),
        Budget(translation=Limits(velocity=0.05)),
        Joints([0.1] * 7),
        Joints(np.arange(7), dq=[0.0] * 7),
        Leash(),
        Waypoint(np.eye(4), 0.02),
        Offset([0.0, 0.0, 0.1], frame="tool"),
    ]:
        assert pickle.loads(pickle.dumps(value)) == value
        assert repr(value).startswith(type(value).__name__)
    assert Gains.joint() != Gains.cartesian() and Gains() == Gains.cartesian()
    assert Joints([0.1] * 7) != Joints([0.2] * 7)
    with pytest.raises(ValueError, match=r"cartesian_stiffness has the shape \[3\], expected \(6,\)"):
        Gains(cartesian_stiffness=[1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="incomplete limits"):
        Budget().scaled(0.5)
    for name, wrong in [("translation", 0.1), ("joints", [1.0] * 7)]:
        with pytest.raises(TypeError, match=f"^{name} is .*, expected Limits"):
            Budget(**{name: wrong})  # type: ignore[arg-type]


def test_another_stiffness_of_the_joints_keeps_the_damping_ratio() -> None:
    preset = Gains.joint()
    soft = preset.with_joint_stiffness(np.array(preset.joint_stiffness) / 4.0)
    assert soft.joint_damping == pytest.approx(np.array(preset.joint_damping) / 2.0)
    assert soft.cartesian_stiffness == preset.cartesian_stiffness
    assert Gains(joint_stiffness=[0.0] * 7).with_joint_stiffness(preset.joint_stiffness) == Gains(
        joint_stiffness=preset.joint_stiffness, joint_damping=preset.joint_damping
    )
    assert preset.with_joint_stiffness([-1.0] * 7).joint_damping == (0.0,) * 7  # refused when a motion begins
    with pytest.raises(ValueError, match=r"joint_stiffness has the shape \[3\], expected \(7,\)"):
        preset.with_joint_stiffness([100.0] * 3)


def test_a_report_has_what_happened(robot: Robot) -> None:
    report = robot.move_by([0.0, 0.0, 0.02]).wait()
    assert report.duration > 0.2 and report.lost_states == 0 and 0.0 < report.success_rate_min <= 1.0
    assert report.final_error is not None and report.released_error is not None and report.reacted is None
    assert report.line_deviation is not None and 0.0 < report.line_deviation < 0.01
    assert report.compensation is not None and report.compensation.shape == (7,)
    assert report.turnaround is not None and 0.0 < report.turnaround.p50 <= report.turnaround.max
    assert report.worst_cycle is not None and report.worst_cycle.time_ms > 0
    phases = report.worst_cycle.phases
    assert phases is not None and 0.0 < phases.program < 1.0 and 0.0 < phases.send < 1.0
    same: MotionReport = pickle.loads(pickle.dumps(report))
    assert same == report and report != robot.move_by([0.0, 0.0, -0.02]).wait()
    assert repr(report).startswith("MotionReport(duration=")
    assert str(report).startswith(f"arrived after {report.duration:.2f} s, ") and str(report).endswith("target; 0 states lost")


def test_a_path_goes_through_its_waypoints(robot: Robot) -> None:
    start = robot.pose()
    up, aside = start.copy(), start.copy()
    up[2, 3] += 0.05
    aside[:3, 3] += [0.0, 0.05, 0.05]
    rests = (SPEED < 0.01) & elapsed(0.3)
    stopped = robot.move_through([up, aside], until=rests).wait().reacted
    assert stopped is not None and np.linalg.norm(stopped.pose[:3, 3] - up[:3, 3]) < 0.01
    robot.move_to(start).wait()
    rounded = robot.move_through([Waypoint(up, 0.025), aside], until=rests).wait().reacted
    assert rounded is not None and np.linalg.norm(rounded.pose[:3, 3] - aside[:3, 3]) < 0.01
    robot.move_through([up, aside], 0.02).wait()
    assert_near(robot, aside)
    q = robot.state().q
    robot.move_through([Joints(q + 0.05), Joints(q)], blend=0.02).wait()
    with pytest.raises(MotionError, match="waypoint 2"):
        robot.move_through([robot.pose(), Joints(q)]).wait()
    with pytest.raises(ValueError, match="waypoint 1"):
        robot.move_through([[0.0, 0.0]])


def test_a_motion_goes_on_until_a_condition(robot: Robot) -> None:
    height = robot.pose()[2, 3]
    down: ArrayLike = [0.0, 0.0, -0.1]
    report = robot.move_by(down, until=(POSITION_Z <= -0.03).relative()).wait()
    assert report.reacted is not None
    assert abs(report.reacted.pose[2, 3] - (height - 0.03)) < 1e-3 and report.reacted.wrench.shape == (6,)
    assert robot.pose()[2, 3] > height - 0.06
    home = robot.pose()
    report = robot.move_by(down, until=elapsed(0.4).then(home)).wait()
    assert report.reacted is not None and abs(report.reacted.after - 0.4) < 2e-3
    assert_near(robot, home)
    never = (SPEED > 5.0) | (joint_position(1) >= 3.0) & ~elapsed(0.1).held_for(0.2)
    assert robot.move_by([0.0, 0.0, 0.02], until=never).wait().reacted is None


def test_contact_is_felt(robot: Robot, sim: Sim) -> None:
    surface = robot.pose()[:3, 3] - [0.0, 0.0, 0.04]
    wall = sim.wall(surface, [0.0, 0.0, 1.0])
    slow = Budget(translation=Limits(velocity=0.05))
    touched = force_z(10.0).relative() & elapsed(0.2)
    report = robot.move_by([0.0, 0.0, -0.12], limits=slow, until=touched).wait()
    assert report.reacted is not None and abs(report.reacted.pose[2, 3] - surface[2]) < 0.02
    felt = wall.felt()
    assert felt is not None and felt[2] > 0.0
    assert wall.release() and not wall.release()


def test_conditions_say_what_they_are() -> None:
    condition = (force_z(5.0) & elapsed(0.2) | ~(POSITION_Z < 0.15)).held_for(0.1)
    assert repr(condition) == "((force_z(5.0) & elapsed(0.2)) | ~(POSITION_Z <= 0.15)).held_for(0.1)"
    assert force_z(5.0) == force_z(5.0) and force_z(5.0) != force_z(6.0)
    assert repr(force_z(5.0).then(Joints([0.0] * 7))).startswith("force_z(5.0).then(Joints(")
    with pytest.raises(TypeError, match="neither true nor false"):
        bool(force_z(5.0) and elapsed(0.2))
    make: Any
    for make in [lambda: force_z(-1.0), lambda: force_z(np.nan), lambda: joint_position(8) > 0.0, lambda: elapsed(-1.0)]:
        with pytest.raises(ValueError):
            make()
    many = elapsed(0.1)
    with pytest.raises(ValueError, match="at most 24"):
        for _ in range(20):
            many = many | elapsed(0.1)


def test_a_motion_is_seen_paused_and_cancelled_from_elsewhere(live: Sim) -> None:
    async def main() -> None:
        async with connection(live) as robot:
            motion = robot.move_by([0.0, 0.0, 0.15], speed=0.2)
            handle = motion.handle()
            assert motion.progress() is None
            task = asyncio.create_task(motion)
            await begun(robot)
            progress = handle.progress()
            assert progress is not None and 0.0 < progress.fraction < 1.0 and progress.remaining > 0.0
            motion.pause()
            while (reference := robot.reference()) is None or abs(reference.dq).max() > 1e-3:
                await asyncio.sleep(0.001)
            assert not task.done()
            handle.resume()
            await begun(robot)
            handle.cancel()
            with pytest.raises(MotionError) as caught:
                await task
            assert caught.value.kind == "stopped" and motion.progress() is None
            never = robot.move_by([0.0, 0.0, 0.05])
            never.cancel()
            with pytest.raises(MotionError):
                await never

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_newer_motion_supersedes_the_older_one(live: Sim) -> None:
    async def main() -> None:
        async with connection(live) as robot:
            older = asyncio.create_task(robot.move_by([0.0, 0.0, 0.2], speed=0.1))
            await begun(robot)
            report = await robot.move_by([0.0, 0.02, 0.0], from_arm=True)
            assert report.final_error is not None
            with pytest.raises(MotionError) as caught:
                await older
            assert caught.value.kind == "superseded"

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_reflex_comes_out_of_the_motion_at_once_with_its_log(live: Sim) -> None:
    async def main() -> None:
        async with connection(live) as robot:
            motion = asyncio.create_task(robot.move_by([0.0, 0.0, 0.2], speed=0.1))
            await begun(robot)
            live.trip("cartesian_reflex")
            with pytest.raises(ControlError) as caught:
                await motion
            error = caught.value
            assert (error.kind, error.errors, error.is_ready_for_more) == ("reflex_aborted", ["cartesian_reflex"], False)
            cycles = len(error.log)
            assert 0 < cycles <= 50
            assert error.log.q.shape == error.log.tau_J.shape == (cycles, 7)
            assert error.log.O_T_EE.shape == (cycles, 4, 4) and error.log.sent("tau_J_d").shape == (cycles, 7)
            # A busy machine skips states.
            assert (np.diff(error.log.time_ms) >= 1).all()
            assert error.log.states()[-1].current_errors == error.log.current_errors[-1]
            lines = error.to_csv().strip().splitlines()
            assert len(lines) == cycles + 1 and "q" in lines[0]
            assert error.diagnosis is not None and "cartesian_reflex" in error.diagnosis
            assert error.findings is not None and error.findings["cycles"] == cycles
            assert {"q", "O_T_EE", "robot_mode"} <= set(dir(error.log)) and not hasattr(error.log, "FLAT_LEN")
            assert "(7,)" in (type(error.log).q.__doc__ or "")
            with pytest.raises(MotionError):
                await robot.move_by([0.0, 0.0, 0.02])
            await robot.recover()
            await robot.move_by([0.0, 0.0, 0.02])

    asyncio.run(asyncio.wait_for(main(), 60))


def test_a_motion_is_awaited_once(robot: Robot) -> None:
    async def main() -> None:
        motion = robot.move_by([0.0, 0.0, 0.01])
        await motion
        assert repr(motion) == "<Robot.move_by over>"
        with pytest.raises(RuntimeError, match=r"Robot.move_by\(\) was already awaited: call it again for another"):
            await motion

    asyncio.run(main())


def test_an_arm_rests_after_a_stop(robot: Robot) -> None:
    robot.stop().wait()
    until(lambda: at_rest(robot))
    margin = robot.margin(Gains())
    assert margin is not None and margin.is_wanted and margin.damping > 2.0
    assert robot.reference() is None
