"""Programs for pylibfranka, one for each of its features: ``(package, address, outcome)``."""

from __future__ import annotations

import math
import time
from typing import Any

IDENTITY = [float(i % 5 == 0) for i in range(16)]


def connect(p: Any, address: str) -> Any:
    return p.Robot(address, p.RealtimeConfig.kIgnore)


def shown(robot: Any, condition: Any) -> bool:
    """Reads states until one meets the condition; the first states may be older than the last command."""
    end = time.monotonic() + 20.0
    while not condition(robot.read_once()):
        if time.monotonic() > end:
            return False
    return True


def states(p: Any, address: str, outcome: Any) -> None:
    state = connect(p, address).read_once()
    for name in """q q_d dq dq_d ddq_d tau_J tau_J_d theta dtheta joint_contact joint_collision cartesian_contact
        cartesian_collision O_T_EE O_T_EE_d O_T_EE_c F_T_EE F_T_NE NE_T_EE EE_T_K I_ee I_load I_total F_x_Cee F_x_Cload
        F_x_Ctotal elbow elbow_d elbow_c O_dP_EE_d m_ee m_load m_total control_command_success_rate""".split():
        outcome.note(name, getattr(state, name))
        outcome.note(f"type of {name}", type(getattr(state, name)).__name__)
    outcome.note("mode", [str(state.robot_mode), repr(state.robot_mode), state.robot_mode.name, state.robot_mode.value])
    outcome.note("time", state.time.to_sec() > 0.0)
    outcome.note("errors", [str(state.current_errors), str(bool(state.current_errors)), str(state.current_errors.joint_reflex)])


def parameters(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    outcome.attempt("collision", robot.set_collision_behavior, [20.0] * 7, [40.0] * 7, [10.0] * 6, [20.0] * 6)
    outcome.attempt("six of seven", robot.set_collision_behavior, [20.0] * 6, [40.0] * 7, [10.0] * 6, [20.0] * 6)
    outcome.attempt("joints", robot.set_joint_impedance, [3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0])
    outcome.attempt("below zero", robot.set_joint_impedance, [-1.0] * 7)
    outcome.attempt("cartesian", robot.set_cartesian_impedance, [3000.0] * 3 + [300.0] * 3)
    outcome.attempt("K", robot.set_K, IDENTITY)
    outcome.attempt("no pose", robot.set_K, [2.0] * 16)
    outcome.attempt("EE", robot.set_EE, IDENTITY)
    outcome.attempt("load", robot.set_load, 0.5, [0.0, 0.0, 0.05], [0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001])
    outcome.attempt("no mass", robot.set_load, -0.5, [0.0, 0.0, 0.05], [0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001])
    outcome.note("mass", shown(robot, lambda state: state.m_load == 0.5))


def model(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    model = robot.load_model()
    state = robot.read_once()
    outcome.note("mass", model.mass(state))
    outcome.note("gravity", model.gravity(state))
    outcome.note("coriolis", model.coriolis(state))
    outcome.note("jacobian", model.zero_jacobian(state))


def torques(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    control = robot.start_torque_control()
    outcome.attempt("busy", robot.start_torque_control)
    steps = []
    for cycle in range(100):
        state, step = control.readOnce()
        steps.append(step.to_sec())
        command = p.Torques([0.0] * 7)
        command.motion_finished = cycle == 99
        control.writeOnce(command)
    outcome.note("steps", steps)
    outcome.note("mode", str(state.robot_mode))
    outcome.attempt("after the last", control.writeOnce, p.Torques([0.0] * 7))


def _moved(p: Any, address: str, outcome: Any, kind: str) -> None:
    """A path of 5 cm or 0.05 rad in a second, at no velocity in the beginning and at the end."""
    robot = connect(p, address)
    begin = getattr(robot, f"start_{kind}_control")
    control = begin(p.ControllerMode.JointImpedance)
    first, _ = control.readOnce()
    for cycle in range(1200):
        at = min(cycle / 1000.0, 1.0)
        speed = 0.05 * (1.0 - math.cos(2.0 * math.pi * at))
        way = 0.05 * (at - math.sin(2.0 * math.pi * at) / (2.0 * math.pi))
        if kind == "joint_position":
            command = p.JointPositions([q + way * (i == 3) for i, q in enumerate(first.q_d)])
        elif kind == "joint_velocity":
            command = p.JointVelocities([speed * (i == 3) for i in range(7)])
        elif kind == "cartesian_pose":
            command = p.CartesianPose([x + way * (i == 14) for i, x in enumerate(first.O_T_EE_c)])
        else:
            command = p.CartesianVelocities([speed * (i == 2) for i in range(6)])
        command.motion_finished = cycle == 1199
        control.writeOnce(command)
        if cycle < 1199:
            control.readOnce()
    last = robot.read_once()
    outcome.note("way of joints", [a - b for a, b in zip(last.q_d, first.q_d)])
    outcome.note("height", last.O_T_EE[14] - first.O_T_EE[14])


def joint_positions(p: Any, address: str, outcome: Any) -> None:
    _moved(p, address, outcome, "joint_position")


def joint_velocities(p: Any, address: str, outcome: Any) -> None:
    _moved(p, address, outcome, "joint_velocity")


def cartesian_pose(p: Any, address: str, outcome: Any) -> None:
    _moved(p, address, outcome, "cartesian_pose")


def cartesian_velocities(p: Any, address: str, outcome: Any) -> None:
    _moved(p, address, outcome, "cartesian_velocity")


def wrong_commands(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    control = robot.start_torque_control()
    control.readOnce()
    outcome.attempt("NaN", control.writeOnce, p.Torques([math.nan] * 7))
    outcome.attempt("of another motion", control.writeOnce, p.JointPositions([0.0] * 7))
    outcome.attempt("six numbers", p.Torques, [0.0] * 6)
    last = p.Torques([0.0] * 7)
    last.motion_finished = True
    outcome.attempt("last", control.writeOnce, last)
    del control
    control = robot.start_cartesian_pose_control(p.ControllerMode.CartesianImpedance)
    state, _ = control.readOnce()
    outcome.attempt("no pose", control.writeOnce, p.CartesianPose([2.0] * 16))
    pose = p.CartesianPose(state.O_T_EE_c)
    pose.motion_finished = True
    outcome.attempt("last pose", control.writeOnce, pose)


def reflex(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    control = robot.start_joint_position_control(p.ControllerMode.JointImpedance)
    state, _ = control.readOnce()

    def jump() -> None:
        for _ in range(100):
            control.writeOnce(p.JointPositions([q + 0.1 for q in state.q_d]))
            control.readOnce()

    outcome.attempt("jump", jump)
    del control, jump
    state = robot.read_once()
    outcome.note("mode", str(state.robot_mode))
    outcome.note("errors", [str(state.current_errors), str(state.last_motion_errors)])
    outcome.note("start", state.last_motion_errors.joint_position_motion_generator_start_pose_invalid)
    outcome.attempt("refused", robot.start_torque_control)
    outcome.attempt("recovery", robot.automatic_error_recovery)
    end = time.monotonic() + 20.0
    while robot.read_once().robot_mode == p.RobotMode.AutomaticErrorRecovery and time.monotonic() < end:
        pass
    outcome.note("recovered", str(robot.read_once().robot_mode))


def stop(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    control = robot.start_torque_control()
    control.readOnce()
    control.writeOnce(p.Torques([0.0] * 7))
    outcome.attempt("stop", robot.stop)

    def read() -> None:
        for _ in range(50):
            control.readOnce()

    outcome.attempt("stopped", read)


def asynchronous(p: Any, address: str, outcome: Any) -> None:
    robot = connect(p, address)
    q = robot.read_once().q_d
    handlers = p.AsyncPositionControlHandler
    made = handlers.configure(robot, handlers.Configuration([0.6] * 7, 1e-3))
    outcome.note("error", str(made.error_message))
    handler = made.handler
    outcome.note("before", str(handler.get_target_feedback().status))
    target = handlers.JointPositionTarget([joint + 0.1 * (i == 6) for i, joint in enumerate(q)])
    taken = handler.set_joint_position_target(target)
    outcome.note("taken", [taken.was_successful, bool(taken.motion_uuid), taken.error_message is None])
    end = time.monotonic() + 20.0
    while handler.get_target_feedback().status.name == "kExecuting" and time.monotonic() < end:
        time.sleep(0.01)
    outcome.note("reached", str(handler.get_target_feedback().status))
    outcome.attempt("stop", handler.stop_control)
    after = handler.get_target_feedback()
    outcome.note("after", [str(after.status), str(after.error_message)])
    refused = handler.set_joint_position_target(target)
    outcome.note("refused", [str(refused.was_successful), str(refused.motion_uuid), str(refused.error_message)])


def asynchronous_as_in_the_example(p: Any, address: str, outcome: Any) -> None:
    """Uses the numbers of the vendor's example for sparse targets: a tolerance that every posture is within, targets at 50 Hz."""
    robot = connect(p, address)
    handlers = p.AsyncPositionControlHandler
    made = handlers.configure(robot, handlers.Configuration([0.655] * 4 + [1.315] * 3, 10.0))
    outcome.note("error", str(made.error_message))
    ready = [0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, math.pi / 2, math.pi / 4]
    errors = set()
    for step in range(30):
        errors.add(str(made.handler.get_target_feedback().error_message))
        target = handlers.JointPositionTarget([q + (0.05 if step < 15 else -0.05) for q in ready])
        errors.add(str(made.handler.set_joint_position_target(target).error_message))
        time.sleep(0.02)
    outcome.note("errors", sorted(errors))
    outcome.note("reached", _status_at_rest(made.handler, robot))
    made.handler.stop_control()


def _status_at_rest(handler: Any, robot: Any) -> str:
    """Returns the status once the robot has stopped planning motions."""
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        time.sleep(0.05)
        if max(map(abs, robot.read_once().dq_d)) < 1e-3:
            return str(handler.get_target_feedback().status)
    return "never at rest"


def tolerances(p: Any, address: str, outcome: Any) -> None:
    """Notes the status of targets with any number as the tolerance."""
    robot = connect(p, address)
    handlers = p.AsyncPositionControlHandler
    for tolerance in (10.0, math.inf, 0.0, -1.0, math.nan, None):
        configuration = handlers.Configuration([0.6] * 7, 1.0)
        configuration.goal_tolerance = tolerance
        made = handlers.configure(robot, configuration)
        outcome.note(f"error of {tolerance}", str(made.error_message))
        q = robot.read_once().q_d
        made.handler.set_joint_position_target(handlers.JointPositionTarget([*q[:6], q[6] + 0.02]))
        time.sleep(0.2)
        outcome.note(f"reached with {tolerance}", _status_at_rest(made.handler, robot))
        made.handler.stop_control()
        while robot.read_once().robot_mode != p.RobotMode.Idle:
            pass


def enumerations(p: Any, address: str, outcome: Any) -> None:
    for enumeration in (p.ControllerMode, p.RealtimeConfig, p.RobotMode):
        members = enumeration.__members__
        outcome.note(enumeration.__name__, [[str(one), repr(one), str(int(one)), one.name] for one in members.values()])
    for name in ("Command", "Control", "InvalidOperation", "Network", "Realtime"):
        outcome.note(name, getattr(p, f"{name}Exception").__mro__[1].__name__)
    outcome.note("Franka", p.FrankaException.__mro__[1].__name__)
    outcome.attempt("nobody there", p.Robot, "127.255.255.1", p.RealtimeConfig.kIgnore)
    outcome.attempt("no hand there", p.Gripper, "127.255.255.1")
