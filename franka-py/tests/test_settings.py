"""Settings of the robot."""

import asyncio
from typing import Any

import numpy as np
import pytest

import franka_async
from franka_async import COLLISION_THRESHOLDS, CommandError, Robot

TORQUES, FORCES = [20.0] * 7, np.full(6, 30.0)
EIGHT = [TORQUES] * 4 + [FORCES] * 4


def test_every_setting_is_accepted_by_both_robots(franka_robot: Robot) -> None:
    async def main() -> None:
        robot = franka_robot
        for preset in ("careful", "compliant", "insensitive"):
            await robot.set_collision_behavior(preset)
        await robot.set_collision_behavior(TORQUES, TORQUES, FORCES, FORCES)
        await robot.set_collision_behavior(*EIGHT)
        await robot.set_collision_behavior(**dict(zip(COLLISION_THRESHOLDS, EIGHT, strict=True)))
        await robot.set_collision_behavior(
            TORQUES, TORQUES, lower_force_thresholds=FORCES, upper_force_thresholds=FORCES
        )
        await robot.set_joint_impedance([3000.0] * 7)
        await robot.set_cartesian_impedance([2000.0] * 3 + [200.0] * 3)
        await robot.set_guiding_mode([True, True, True, False, False, False], elbow=False)

    asyncio.run(main())


def test_frames_and_load_are_in_the_state_that_follows(franka_robot: Robot) -> None:
    async def main() -> None:
        robot = franka_robot
        frame = np.eye(4)
        frame[:3, 3] = [0.0, 0.01, 0.1]
        await robot.set_k(frame)
        await robot.set_ee([0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 1.0])
        inertia = np.diag([1e-3, 2e-3, 3e-3])
        events = robot.events()
        await robot.set_load(0.5, [0.0, 0.02, 0.03], inertia)
        async for event in events:
            if event.kind == "load_changed":
                break
        assert event.mass == 0.5
        # Robots report it in single precision.
        np.testing.assert_allclose(event.center, [0.0, 0.02, 0.03], rtol=1e-7)
        np.testing.assert_allclose(event.inertia, inertia, rtol=1e-7)
        state = robot.state()
        np.testing.assert_allclose(state.EE_T_K, frame, atol=1e-7)
        assert state.NE_T_EE[2, 3] == pytest.approx(0.05)
        assert state.m_load == pytest.approx(0.5)
        # In the form of the vendor.
        await robot.set_load(0.5, [0.0, 0.02, 0.03], 2.0 * inertia.ravel(order="F"))
        async for event in events:
            if event.kind == "load_changed":
                break
        np.testing.assert_allclose(event.inertia, 2.0 * inertia, rtol=1e-7)

    asyncio.run(main())


def test_what_only_one_robot_has_is_refused_by_the_other(fr3: Robot, fer: Robot) -> None:
    assert "<robot" in fr3.urdf().wait()
    fer.set_filters(joint_position=100.0, controller=500.0).wait()
    for operation in (fer.urdf(), fr3.set_filters(), fr3.virtual_wall(0)):
        with pytest.raises(CommandError) as raised:
            operation.wait()
        assert (raised.value.kind, raised.value.party) == ("request", "caller")


def test_a_wall_is_read(fer: Robot) -> None:
    wall = fer.virtual_wall(0).wait()
    assert (wall.size.shape, wall.pose.shape, wall.is_active) == ((3,), (4, 4), False)


def test_a_refusal_of_the_robot_is_raised(fr3: Robot) -> None:
    with pytest.raises(CommandError, match=r"\(got \[1000000.0, .*\] N m/rad, expected 0 to 14250 N m/rad for each joint\)") as raised:
        fr3.set_joint_impedance([1e6] * 7).wait()
    assert (raised.value.kind, raised.value.party) == ("invalid_argument", "caller")
    with pytest.raises(CommandError, match=r"\(I_load has the principal moments 0.0001, 0.0001 and 0.005 kg m\^2, expected") as raised:
        fr3.set_load(0.2, [0.0, 0.0, 0.1], np.diag([1e-4, 1e-4, 5e-3])).wait()
    assert (raised.value.kind, raised.value.party) == ("invalid_argument", "caller")


@pytest.mark.parametrize(
    ("arguments", "named", "message"),
    [
        (["gentle"], {}, "got 'gentle', expected 'careful', 'compliant' or 'insensitive'; four arrays, lower and upper torques"),
        ([TORQUES], {}, "expected 'careful'"),
        ([TORQUES, TORQUES], {}, "lower_force_thresholds is missing, expected 'careful', .* lower and upper forces \\(6,\\); or eight"),
        ([30.0] * 4, {}, r"lower_torque_thresholds has the shape \[\], not \(7,\): expected 'careful'.*; four arrays"),
        ([30.0, 30.0], {}, "lower_force_thresholds is missing, expected 'careful'"),
        ([TORQUES] * 9, {}, "got 9 arrays, expected 'careful'.*; four arrays.*; or eight"),
        ([], {"upper_torque": TORQUES}, "got upper_torque, expected one of lower_torque_thresholds_acceleration"),
        ([TORQUES], {"lower_torque_thresholds": TORQUES}, "got lower_torque_thresholds twice"),
        ([TORQUES, FORCES, FORCES, FORCES], {}, r"upper_torque_thresholds has the shape \[6\], not \(7,\): expected"),
        ([[np.nan] * 7, TORQUES, FORCES, FORCES], {}, "lower_torque_thresholds holds NaN"),
    ],
)
def test_thresholds_that_make_no_sense_are_refused(arguments: list[Any], named: dict[str, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        Robot("127.0.0.1").set_collision_behavior(*arguments, **named)


def test_loads_that_make_no_sense_are_refused() -> None:
    robot = Robot("127.0.0.1")
    with pytest.raises(ValueError, match="mass is -1, expected a finite number of 0 or more"):
        robot.set_load(-1.0)
    with pytest.raises(ValueError, match="expected a symmetric matrix"):
        robot.set_load(1.0, inertia=np.arange(9.0).reshape(3, 3))
    with pytest.raises(ValueError, match="expected a symmetric matrix"):
        robot.set_load(1.0, inertia=np.arange(9.0))
    with pytest.raises(ValueError, match=r"inertia has the shape \[6\], expected \(3, 3\) or \(9,\)"):
        robot.set_load(1.0, inertia=np.zeros(6))


def test_nothing_is_sent_without_a_connection() -> None:
    with pytest.raises(franka_async.FrankaError) as raised:
        Robot("127.0.0.1").set_collision_behavior("careful")
    assert raised.value.kind == "not_connected"
