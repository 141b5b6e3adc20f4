"""The simulated robot: its properties, and the actions of people and objects on it."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

import numpy as np
import pytest
from conftest import PATIENT, connection, outcome, until

from franka_async import ConnectError, ControlError, FrankaError, Gripper, Model, MotionError, Network, Robot, Sim, VacuumGripper, sync


def test_it_runs_in_both_kinds_of_blocks() -> None:
    with Sim.fr3(virtual_time=True) as sim:
        assert sim.address in repr(sim) and sim.hand_address is None and sim.vacuum_gripper_address is None
        assert sim.state().robot_mode == "idle"
    with pytest.raises(OSError, match="stopped"):
        sim.state()
    sim.stop()

    async def main() -> None:
        async with Sim.fer(virtual_time=True) as sim:
            assert sim.state().time_ms > 0
        with pytest.raises(OSError, match="stopped"):
            sim.state()

    asyncio.run(main())


def test_it_is_as_its_options_say() -> None:
    q = [0.1, -0.6, 0.2, -2.2, 0.1, 1.6, 0.6]
    with Sim.fr3(virtual_time=True, ideal=True, q=q, hand=True, vacuum_gripper=True) as sim:
        np.testing.assert_allclose(sim.state().q, q, atol=1e-3)
        assert sim.state().m_ee == 0.73 and sim.hand_address and sim.vacuum_gripper_address
        sim.place_object(0.03)
        sim.place_part()
        with pytest.raises(ValueError, match="does not fit"):
            sim.place_object(0.2)
    frame = np.eye(4)
    frame[2, 3] = 0.1
    with Sim.fer(virtual_time=True, tool=(frame, 0.4, [0.0, 0.0, 0.05]), load=(0.5, [0.0, 0.0, 0.1])) as sim:
        assert sim.state().m_ee == 0.4 and sim.state().m_load == 0.0
        np.testing.assert_allclose(sim.state().F_T_NE, frame)
        with pytest.raises(ValueError, match="no Hand"):
            sim.place_object(0.01)

    def rest(**options: Any) -> np.ndarray:
        """Returns the distance between the true pose of an arm with these options and the pose that it reports."""
        with Sim.fr3(virtual_time=True, **options) as sim:
            return np.asarray(sim.true_pose() - sim.state().O_T_EE)

    assert abs(rest(arm="ideal")).max() < 1e-6
    assert abs(rest(arm="bad", arm_seed=3)).max() > 1e-5
    np.testing.assert_allclose(rest(arm="realistic", arm_seed=7), rest(arm="realistic", arm_seed=7), atol=1e-4)
    assert abs(rest(arm="realistic", arm_seed=7) - rest(arm="realistic", arm_seed=8)).max() > 1e-5


def test_the_limits_are_those_of_the_system() -> None:
    q = [2.9, -0.7, 0.0, -2.0, 0.0, 2.0, 0.0]
    with Sim.fr3(virtual_time=True, ideal=True, q=q) as sim, sync.Robot(sim.address, **PATIENT) as robot:
        limits = robot.model().joint_limits
        np.testing.assert_allclose(limits.upper, [2.9007, 1.8361, 2.9007, -0.1169, 2.8763, 4.6216, 3.0508], atol=1e-12)
    with Sim.fr3(virtual_time=True, ideal=True, limits="before-5.9") as sim, sync.Robot(sim.address, **PATIENT) as robot:
        assert robot.model().joint_limits.upper[0] == 2.7437


def test_a_robot_may_compute_its_poses_with_other_lengths() -> None:
    with Sim.fr3(virtual_time=True) as sim, sync.Robot(sim.address, **PATIENT) as robot:
        state = robot.state()
        np.testing.assert_allclose(robot.model().pose("ee", state.q, state.F_T_EE), state.O_T_EE, atol=2e-6)
        assert np.abs(Model.fr3().pose("ee", state.q, state.F_T_EE) - state.O_T_EE).max() > 5e-5
        found = robot.model().ik(state.O_T_EE, joint7=state.q[6], F_T_EE=state.F_T_EE)
        assert np.abs(found - state.q).max(axis=1).min() < 2e-5
        np.testing.assert_allclose(robot.pose_at(state.q), state.O_T_EE, atol=2e-6)
        assert abs(robot.model().clearance(state.q).distance - Model.fr3().clearance(state.q).distance) > 1e-6
    described = Sim.fr3(virtual_time=True, state_geometry="described")
    with described as sim, sync.Robot(sim.address, **PATIENT) as robot:
        state = robot.state()
        np.testing.assert_allclose(Model.fr3().pose("ee", state.q, state.F_T_EE), state.O_T_EE, atol=2e-6)


def test_a_robot_with_an_unknown_geometry_is_refused_unless_that_is_accepted() -> None:
    with Sim.fr3(virtual_time=True, ideal=True, state_geometry="random", seed=3) as sim:
        with pytest.raises(ConnectError, match=r"µm from the pose of its model .*, expected 2 µm") as refused:
            sync.Robot(sim.address, realtime="ignore").connect()
        assert refused.value.entry == "connect-geometry"
        with sync.Robot(sim.address, realtime="ignore", accept_geometry_error=True) as robot:
            assert robot.geometry_residual is not None and robot.geometry_residual > 1e-5
    with Sim.fr3(virtual_time=True, ideal=True) as sim, sync.Robot(sim.address, **PATIENT) as robot:
        assert robot.geometry_residual is not None and robot.geometry_residual < 2e-6


def test_options_that_make_no_sense_are_refused() -> None:
    for options, kind, text in [
        ({"arm": "new"}, ValueError, "arm is .new."),
        ({"arm": "ideal", "arm_seed": 1}, ValueError, "without arm_seed"),
        ({"arm": "bad", "ideal": True}, ValueError, "one of them"),
        ({"tool": "claw"}, ValueError, "'hand' or a tuple"),
        ({"q": [0.0]}, ValueError, r"q has the shape \[1\]"),
        ({"network": Network(loss=2.0)}, ValueError, "loss is 2"),
        ({"address": "here"}, ValueError, "IP address"),
        ({"virtual": True}, TypeError, "unexpected keyword argument 'virtual'"),
        ({"load": (-1.0, [0.0, 0.0, 0.0])}, ValueError, "-1"),
        ({"q": [0.0, 0.0, 9.0, -2.0, 0.0, 2.0, 0.0]}, ValueError, "joint 3 of q is 9 rad, expected -2.9"),
        ({"state_geometry": "other"}, ValueError, "state_geometry is .other., expected 'described'"),
        ({"kinematic_error": "other"}, ValueError, "kinematic_error is .other., expected 'none' or 'random'"),
        ({"limits": "5.8"}, ValueError, "limits is .5.8., expected '5.9' or 'before-5.9'"),
        ({"limits": "before-5.9", "q": [2.9, -0.7, 0.0, -2.0, 0.0, 2.0, 0.0]}, ValueError, "expected -2.7501 to 2.7501"),
        ({"seed": -1}, ValueError, "seed is -1, expected an integer from 0"),
        ({"seed": "one"}, TypeError, "seed is one, expected an integer"),
        ({"network": Network(seed=-1)}, ValueError, "seed of network is -1"),
        ({"network": Network(cuts=3)}, TypeError, "cuts of network is 3, expected pairs of seconds"),  # type: ignore[arg-type]
        ({"network": 3}, TypeError, "network is 3, expected a Network"),
    ]:
        with pytest.raises(kind, match=text):
            Sim.fr3(**options)  # type: ignore[arg-type]


def test_touches_act_until_they_are_released() -> None:
    with Sim.fr3(virtual_time=True, ideal=True) as sim:
        push = sim.push([0.0, 0.0, 8.0])
        until(lambda: abs(sim.state().O_F_ext_hat_K[2] + 8.0) < 1.0 or abs(sim.state().O_F_ext_hat_K[2] - 8.0) < 1.0)
        felt = push.felt()
        assert felt is not None
        np.testing.assert_allclose(felt, [0, 0, 8, 0, 0, 0], atol=1e-9)
        assert push.release() and push.felt() is None
        for touch in [
            sim.push([0.0, 1.0, 0.0], [0.0, 0.0, 0.1], at="joint4", offset=[0.0, 0.0, 0.05], duration=0.05),
            sim.push_joints([0.5] * 7, duration=0.05),
            sim.pull(sim.true_pose()[:3, 3], 100.0, duration=0.05),
            sim.hold(duration=0.05),
            sim.block(4, duration=0.05),
            sim.wall([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], duration=0.05),
        ]:
            until(lambda touch=touch: not touch.release())  # type: ignore[misc]
        sim.hold()
        sim.let_go()
        wrong: Any
        for wrong in [
            lambda: sim.push([1.0, 2.0]),
            lambda: sim.push([0.0, 0.0, 1.0], at="elbow"),  # type: ignore[arg-type]
            lambda: sim.block(0),
            lambda: sim.block(-1),
            lambda: sim.place([9.0] * 7),
            lambda: sim.pull([0.0, 0.0, 0.0], -5.0),
            lambda: sim.wall([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
            lambda: sim.trip("no_such_error"),
        ]:
            with pytest.raises(ValueError):
                wrong()


def test_a_disturbance_may_wait_until_the_arm_moves(sim: Sim, robot: Robot) -> None:
    """It comes in mid-motion, by the robot's own time: in virtual time, in which a program may see no motion at all."""

    def lift() -> float:
        """Returns the height by which the hand has risen when a motion by 0.1 m was stopped."""
        before = robot.pose()[2, 3]
        with pytest.raises(ControlError):
            robot.move_by([0.0, 0.0, 0.1]).wait()
        return float(sim.true_pose()[2, 3] - before)

    sim.trip("joint_reflex", once_moving=True)
    sim.hold(once_moving=True)
    assert 0.0 < lift() < 0.03
    sim.let_go()
    robot.recover().wait()
    sim.press_user_stop(once_moving=True)
    assert 0.0 < lift() < 0.03
    sim.press_user_stop(False)
    until(lambda: robot.state().robot_mode == "idle")
    # A disturbance that was taken back does not come.
    push = sim.push([0.0, 0.0, -200.0], once_moving=True)
    assert push.felt() is None and push.release() and not push.release()
    assert sim.waiting == 0
    sim.trip("joint_reflex", once_moving=True)
    push = sim.push([0.0, 0.0, -200.0], once_moving=True)
    assert sim.waiting == 2
    sim.let_go()
    assert sim.waiting == 0 and not push.release()
    assert robot.move_by([0.0, 0.0, -0.05]).wait().final_error is not None
    # Last, the robot is gone.
    sim.stop(once_moving=True)
    with pytest.raises(MotionError) as caught:
        robot.move_by([0.0, 0.0, 0.1]).wait()
    assert caught.value.kind == "connection_closed" and sim.waiting == 0
    with pytest.raises(OSError, match="stopped"):
        sim.state()
    sim.stop(once_moving=True)


def test_a_simulator_without_grippers_has_no_address_of_them(sim: Sim) -> None:
    with pytest.raises(TypeError, match="only a simulator with hand=True has a Hand"):
        Gripper(sim.hand_address)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="only a simulator with vacuum_gripper=True has a vacuum gripper"):
        VacuumGripper(sim.vacuum_gripper_address)  # type: ignore[arg-type]


def test_a_network_is_cut_in_mid_motion() -> None:
    """Once a second, for as long as the slowest machine takes to begin. The motion lasts longer."""
    cuts = Network(cuts=[(second, second + 0.1) for second in range(2, 200)])
    with Sim.fr3(patience=0.5, network=cuts) as sim, sync.Robot(sim.address, realtime="ignore", link_timeout=10.0) as robot:
        with pytest.raises(ControlError, match="communication_constraints_violation"):
            robot.move_by([0.0, 0.0, -0.1], speed=0.1)


def test_people_at_the_robot(sim: Sim, robot: Robot) -> None:
    assert sim.guide() and robot.state().robot_mode in ("guiding", "idle")
    until(lambda: robot.state().robot_mode == "guiding")
    assert not sim.guide(False)
    sim.press_user_stop()
    until(lambda: robot.state().robot_mode == "user_stopped")
    with pytest.raises(MotionError):
        robot.move_by([0.0, 0.0, 0.02]).wait()
    sim.press_user_stop(False)
    until(lambda: robot.state().robot_mode == "idle")
    sim.trip("joint_reflex")
    until(lambda: robot.state().robot_mode == "reflex")
    assert robot.state().current_errors == ["joint_reflex"]
    robot.recover().wait()
    sim.lock()
    with pytest.raises(FrankaError):
        robot.move_by([0.0, 0.0, 0.02]).wait()
    sim.lock(False)
    sim.recover_manually()
    q = robot.state().q + 0.1
    sim.place(q)
    until(lambda: bool(abs(robot.state().q - q).max() < 0.01))
    sim.attach(0.1, [0.0, 0.0, 0.02])


def test_a_network_that_fails_is_noticed() -> None:
    async def main() -> None:
        lossy = Network(loss=0.02, delay=0.0002, jitter=0.0001, duplication=0.01, seed=3)
        async with Sim.fr3(virtual_time=True, patience=0.25, network=lossy) as sim, connection(sim) as robot:
            report = await robot.move_by([0.0, 0.0, 0.03])
            assert report.lost_states > 0
        cut = Network(cuts=[(1.0, 1e6)])
        async with Sim.fr3(patience=0.05, network=cut) as sim, Robot(sim.address, realtime="ignore") as robot:
            ended = await outcome(robot.move_by([0.0, 0.0, 0.2], speed=0.1))
            assert isinstance(ended, MotionError) and not isinstance(ended, ControlError), repr(ended)
            assert ended.party == "link"

    asyncio.run(asyncio.wait_for(main(), 60))


def test_methods_release_the_interpreter(sim: Sim) -> None:
    """Threads that ask at the same time all get answers, though each waits for the simulation."""
    answers: list[int] = []
    threads = [threading.Thread(target=lambda: answers.extend(sim.state().time_ms for _ in range(20))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20.0)
    assert len(answers) == 80
