"""Programs for ``franka`` of franka-rs, one for each of its features: ``(package, address, outcome)``."""

from __future__ import annotations

import time
from typing import Any

import numpy as np


def connect(f: Any, address: str) -> Any:
    return f.Robot(address, realtime="ignore")


def until(condition: Any) -> bool:
    """Waits until the condition is true; returns whether it became true."""
    end = time.monotonic() + 20.0
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


def aligned(target: Any) -> Any:
    """Returns the same target. Of its two quaternions, it has the quaternion whose largest part is positive."""
    quaternion = target[3:]
    return np.append(target[:3], quaternion * np.sign(quaternion[np.abs(quaternion).argmax()]))


def states(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    outcome.note("versions", [robot.fci_version, robot.server_version])
    state = robot.read_once()
    for name in """q q_d dq dq_d tau_J_d theta joint_contact cartesian_contact O_T_EE O_T_EE_d O_T_EE_c F_T_EE F_T_NE
        NE_T_EE EE_T_K I_ee I_load I_total F_x_Cee F_x_Cload F_x_Ctotal elbow m_ee m_load m_total
        accelerometer_top""".split():
        outcome.note(f"shape of {name}", list(np.shape(getattr(state, name))))
        if not name.startswith("accelerometer"):
            outcome.note(name, getattr(state, name))
    outcome.note("mode", [state.robot_mode, *state.current_errors, *state.last_motion_errors])
    outcome.note("flat", list(state.flat().shape))
    outcome.note("layout", [[str(part) for part in row] for row in f.FLAT_LAYOUT])
    outcome.note("length", f.FLAT_LEN)


def parameters(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    seven, six = [20.0] * 7, [20.0] * 6
    outcome.attempt("simple", robot.set_collision_behavior_simple, seven, [40.0] * 7, six, [40.0] * 6)
    outcome.attempt("all", robot.set_collision_behavior, seven, seven, seven, seven, six, six, six, six)
    outcome.attempt("joints", robot.set_joint_impedance, K_theta=[3000.0] * 7)
    outcome.attempt("refused", robot.set_joint_impedance, [-1.0] * 7)
    outcome.attempt("cartesian", robot.set_cartesian_impedance, (3000.0,) * 3 + (300.0,) * 3)
    outcome.attempt("recovery", robot.automatic_error_recovery)


def model(f: Any, address: str, outcome: Any) -> None:
    model = connect(f, address).model()
    q, dq = [0.1, -0.7, 0.2, -2.3, 0.1, 1.5, 0.7], [0.1, 0.2, -0.1, 0.3, 0.1, -0.2, 0.1]
    for frame in ("joint1", "joint4", "flange", "ee", "stiffness"):
        outcome.note(f"pose of {frame}", model.pose(frame, q))
        outcome.note(f"zero Jacobian of {frame}", model.zero_jacobian(frame, q))
        outcome.note(f"body Jacobian of {frame}", model.body_jacobian(frame=frame, q=q))
    load: dict[str, Any] = {"m_total": 0.5, "F_x_Ctotal": [0.0, 0.0, 0.05]}
    outcome.note("mass", model.mass(q, **load))
    outcome.note("coriolis", model.coriolis(q, dq, **load))
    outcome.note("gravity", model.gravity(q, **load, gravity_earth=[0.0, 0.1, -9.7]))
    outcome.note("links", model.link_poses(q))
    outcome.note("hand", model.hand_pose(q))


def rotations(f: Any, address: str, outcome: Any) -> None:
    outcome.note("half a radian", f.rotated([0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.0]))
    outcome.note("after another", f.rotated([0.5, 0.5, 0.5, 0.5], [0.1, -0.2, 0.3]))
    outcome.note("none", f.rotated([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))


def cartesian(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    with robot.cartesian_targets() as targets:
        begin = targets.target()
        outcome.note("begin", aligned(begin))
        outcome.note("running", targets.running)
        targets.move_by([0.0, 0.0, 0.05])
        outcome.note("moved by", targets.target() - begin)
        targets.move_by([0.0, 0.02, 0.0, 0.1, 0.0, 0.0])
        outcome.note("turned by", aligned(targets.target()))
        outcome.note("pose", targets.target_pose())
        targets.move_to(begin[:3] + [0.03, 0.0, 0.02])
        outcome.note("orientation kept", aligned(targets.target()))
        targets.move_to(begin + [0.03, 0.0, 0.02, 0.0, 0.0, 0.0, 0.0])
        outcome.attempt("two numbers", targets.move_to, [1.0, 2.0])
        outcome.attempt("no direction", targets.move_to, [0.0] * 7)
        outcome.attempt("busy", robot.joint_targets)
        outcome.attempt("refused", robot.set_joint_impedance, [3000.0] * 7)
        target = targets.target()[:3]
        near = until(lambda: np.linalg.norm(targets.state().O_T_EE[:3, 3] - target) < 0.01)
        outcome.note("near", near)
        outcome.note("mode", targets.state().robot_mode)
    outcome.note("ended", targets.running)
    outcome.attempt("after the end", targets.move_to, begin)
    outcome.attempt("once more", targets.stop)


def joints(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    with robot.joint_targets() as targets:
        begin = targets.target()
        outcome.note("begin", begin)
        targets.move_by([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1])
        outcome.note("moved by", targets.target() - begin)
        near = until(lambda: np.abs(targets.state().q - targets.target()).max() < 0.05)
        outcome.note("near", near)


def follow(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    with robot.cartesian_targets() as targets:
        begin = targets.target()
        targets.follow([begin[:3] + [0.0, 0.0, 0.002 * i] for i in range(11)], dt=0.01)
        followed = until(lambda: abs(targets.target()[2] - begin[2] - 0.02) < 1e-9)
        outcome.note("followed", followed)
        targets.follow([begin[:3]] * 1000, dt=0.01)
        # A thread of the original sets the first point, once it is scheduled.
        outcome.note("back", until(lambda: abs(targets.target()[2] - begin[2]) < 1e-9))
        targets.move_by([0.0, 0.0, 0.01])
        time.sleep(0.05)
        outcome.note("taken over", targets.target() - begin)


def stop(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    targets = robot.cartesian_targets()
    robot.stop()
    outcome.note("ended", until(lambda: not targets.running))
    try:
        targets.stop()
        outcome.note("raised", False)
    except f.ControlException as error:
        outcome.note("raised", [str(error), error.kind, error.reason, *error.errors, str(error.move_status)])
    outcome.attempt("once more", targets.stop)


def wrong_options(f: Any, address: str, outcome: Any) -> None:
    robot = connect(f, address)
    for options in (
        {"backend": "robot", "leash": (0.1, 0.1)},
        {"backend": "robot", "joint_stiffness": [1.0] * 7},
        {"backend": "other"},
        {"controller_mode": "other"},
    ):
        outcome.attempt(str(sorted(options)), robot.cartesian_targets, **options)
    outcome.attempt("positional", robot.cartesian_targets, 0.3)
    outcome.attempt("realtime", f.Robot, address, realtime="perhaps")
    outcome.attempt("nobody there", f.Robot, "127.255.255.1", realtime="ignore")
    outcome.attempt("no hand there", f.Gripper, "127.255.255.1")


def hand(f: Any, address: str, outcome: Any) -> None:
    gripper = f.Gripper(address)
    outcome.note("version", gripper.server_version)
    outcome.note("homing", gripper.homing())
    outcome.note("open", gripper.read_once().max_width)
    outcome.note("move", gripper.move(0.04, 0.1))
    outcome.note("nothing to grasp", gripper.grasp(0.02, 0.1, 10.0, epsilon_inner=0.001, epsilon_outer=0.001))
    outcome.attempt("too wide", gripper.move, 1.0, 0.1)
    outcome.note("stop", gripper.stop())
    state = gripper.read_once()
    outcome.note("state", [state.width, state.temperature])
    outcome.note("grasped", state.is_grasped)
