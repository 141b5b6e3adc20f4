"""Tests of your code against a simulated robot: ``pytest test_my_code.py``. The fixtures come with the package."""

import asyncio

import pytest
from franka_async import ControlError, MotionError, Robot, Sim


async def nod(robot: Robot, depth: float = 0.04) -> None:
    """The code that is tested: the hand goes down by ``depth``, m, and back."""
    if not 0.0 < depth <= 0.1:
        raise ValueError(f"depth is {depth} m, expected up to 0.1 m")
    await robot.move_by([0.0, 0.0, -depth])
    await robot.move_by([0.0, 0.0, depth])


def test_a_nod_ends_where_it_began(franka_robot: Robot) -> None:
    """Runs twice: with a Franka Research 3, and with a Franka Emika Robot."""
    before = franka_robot.pose()[:3, 3]
    asyncio.run(nod(franka_robot))
    assert abs(franka_robot.pose()[:3, 3] - before).max() < 3e-3


@pytest.mark.franka(ideal=True, seed=7)
def test_a_pressed_user_stop_is_not_hidden(fr3: Robot, sim_fr3: Sim) -> None:
    sim_fr3.press_user_stop()
    with pytest.raises(MotionError):
        asyncio.run(nod(fr3))


def test_a_reflex_in_mid_motion_can_be_recovered_from(fr3: Robot, sim_fr3: Sim) -> None:
    """By the robot's own time: in virtual time, a motion may be over before a program sees it move."""
    sim_fr3.trip("cartesian_reflex", once_moving=True)
    with pytest.raises(ControlError, match="cartesian_reflex"):
        asyncio.run(nod(fr3, depth=0.1))
    fr3.recover().wait()
    asyncio.run(nod(fr3))


def test_a_deep_nod_is_refused(fr3: Robot) -> None:
    with pytest.raises(ValueError, match="expected up to 0.1 m"):
        asyncio.run(nod(fr3, depth=0.5))
