"""Uses of pylibfranka, right and wrong: types, attributes, keywords and misuse, without the texts of errors."""

from __future__ import annotations

import gc
import math
from typing import Any

import numpy as np
from programs_pylibfranka import shown

IDENTITY = [float(i % 5 == 0) for i in range(16)]
INERTIA = [0.001, 0.0, 0.0, 0.0, 0.001, 0.0, 0.0, 0.0, 0.001]
NAN, INF = math.nan, math.inf


def everything(p: Any, address: str, outcome: Any) -> None:
    """Runs all of them with one robot, as one process takes longer to start than a program to run."""
    commands(p, outcome)
    robot = p.Robot(robot_ip_address=address, realtime_config=p.RealtimeConfig.kIgnore)
    for use in (enumerations, states, parameters, frames, loads, models, cycle, modes, motions, poses, exceptions):
        outcome.note("use", use.__name__)
        use(p, robot, outcome)
        gc.collect()
    outcome.usage("realtime as a number", p.Robot, address, 1)
    outcome.usage("no address", p.Robot)


def kind(value: Any) -> str:
    return type(value).__name__


def commands(p: Any, outcome: Any) -> None:
    kinds = {"Torques": ("tau_J", 7), "JointPositions": ("q", 7), "CartesianPose": ("O_T_EE", 16), "CartesianVelocities": ("O_dP_EE", 6)}
    for name, (field, n) in kinds.items():
        make = getattr(p, name)
        values: list[Any] = [[0.5] * n, (0.5,) * n, [1] * n, np.full(n, 0.5), np.arange(n), [True] * n, [0.5] * (n - 1), [0.5] * (n + 1)]
        values += [range(n), "1" * n, ["1"] * n, None, 0.5, np.zeros((n, 1)), {i: i for i in range(n)}, [NAN] * n, [1j] * n]
        for number, value in enumerate(values):
            outcome.usage(f"{name} of {number}", make, value)
        for arguments in ([], [[0.0] * n, [0.0] * n]):
            outcome.usage(f"{name} of {len(arguments)} arguments", make, *arguments)
        outcome.usage(f"{name} by name", make, **{field: [0.0] * n})
        one = make([0.5] * n)
        getattr(one, field)[0] = 9.0
        outcome.note(f"{name} is not changed by its list", getattr(one, field))
        for value in ((1,) * n, np.full(n, 2.0), [1.0] * (n - 1), "no"):
            outcome.usage(f"{name} set", setattr, one, field, value)
            outcome.note(f"{name} now", getattr(one, field))
        for value in (True, 1, 0, None, "yes", np.bool_(True), [], 0.5):
            outcome.usage(f"{name} finished {value}", setattr, one, "motion_finished", value)
            outcome.note(f"{name} is finished {value}", [str(one.motion_finished), kind(one.motion_finished)])
        outcome.usage(f"{name} has no other attribute", setattr, one, "motion_finshed", True)


def enumerations(p: Any, _robot: Any, outcome: Any) -> None:
    for enumeration in (p.RobotMode, p.ControllerMode, p.RealtimeConfig):
        name, first = enumeration.__name__, enumeration(0)
        outcome.note(name, [f"{first}", "%s" % first, repr(first), first.name, kind(first.value), str([10, 20][first]), str(bool(first))])
        outcome.note(f"{name} compares", [str(first == other) for other in (first, 0, "x", None, 0.0)])
        for value in ("Idle", None, 0, 1):
            outcome.usage(f"{name} of {value}", enumeration, value)
        outcome.usage(f"{name} less", lambda: first < first)
        outcome.usage(f"{name} plus", lambda: first + 1)
        outcome.usage(f"{name} set", setattr, first, "value", 5)


def states(p: Any, robot: Any, outcome: Any) -> None:
    state = robot.read_once()
    # Ours has the names of the original, and so does the class.
    names = """EE_T_K F_T_EE F_T_NE F_x_Cee F_x_Cload F_x_Ctotal I_ee I_load I_total K_F_ext_hat_K NE_T_EE O_F_ext_hat_K O_T_EE O_T_EE_c
        O_T_EE_d O_dP_EE_c O_dP_EE_d O_ddP_EE_c O_ddP_O cartesian_collision cartesian_contact control_command_success_rate current_errors
        ddelbow_c ddq_d delbow_c dq dq_d dtau_J dtheta elbow elbow_c elbow_d joint_collision joint_contact last_motion_errors m_ee m_load
        m_total q q_d robot_mode tau_J tau_J_d tau_ext_hat_filtered theta time""".split()
    outcome.note("names", [name for name in names if hasattr(p.RobotState, name)])
    outcome.note("types", [kind(getattr(state, name)) for name in names])
    first = state.q
    first[0] += 9.0
    outcome.note("a list is a copy", [str(state.q[0] == first[0]), str(state.q is state.q)])
    values: list[tuple[str, Any]] = [("q", (2,) * 7), ("q", np.arange(7)), ("q", [1.0] * 6), ("m_ee", 3), ("m_ee", "x"), ("O_T_EE", IDENTITY)]
    values += [("O_T_EE", np.eye(4)), ("robot_mode", p.RobotMode.Reflex), ("robot_mode", 4), ("time", 3.0), ("current_errors", None)]
    for name, value in values:
        outcome.usage(f"set {name}", setattr, state, name, value)
        outcome.note(f"{name} now", str(getattr(state, name)) if name != "time" else "")
    outcome.usage("no other attribute", setattr, state, "nothing", 1)
    outcome.usage("not made", p.RobotState)
    outcome.usage("no vars", vars, state)
    outcome.usage("no iteration", list, state)
    outcome.usage("no length of time", float, state.time)
    errors = robot.read_once().last_motion_errors
    outcome.note("errors", sorted(name for name in dir(p.Errors) if not name.startswith("_")))
    outcome.note("of a bool", sorted({kind(getattr(errors, name)) for name in dir(errors) if not name.startswith("_")}))
    outcome.usage("errors set", setattr, errors, "joint_reflex", True)
    outcome.usage("errors made", p.Errors)


def parameters(_p: Any, robot: Any, outcome: Any) -> None:
    seven, six = [20.0] * 7, [20.0] * 6
    given: list[list[Any]] = [[seven, seven, six, six], [np.full(7, 20.0), tuple(seven), [20] * 6, six], [seven, seven, six], [six, six, seven, seven]]
    for n, thresholds in enumerate(given):
        outcome.usage(f"collision {n}", robot.set_collision_behavior, *thresholds)
    for value in (-1.0, NAN, INF, 0.0, 1e9):
        outcome.usage(f"collision of {value}", robot.set_collision_behavior, [value] * 7, seven, six, six)
        outcome.usage(f"joints of {value}", robot.set_joint_impedance, [value] * 7)
        outcome.usage(f"axes of {value}", robot.set_cartesian_impedance, [value] * 6)
    names = ("lower_torque_thresholds", "upper_torque_thresholds", "lower_force_thresholds", "upper_force_thresholds")
    outcome.usage("collision by name", robot.set_collision_behavior, **dict(zip(names, (seven, seven, six, six), strict=True)))
    outcome.usage("collision by a wrong name", robot.set_collision_behavior, seven, seven, six, upper=six)
    outcome.usage("joints by name", robot.set_joint_impedance, K_theta=[3000.0] * 7)
    outcome.usage("axes by name", robot.set_cartesian_impedance, K_x=[3000.0] * 6)
    outcome.usage("one number", robot.set_joint_impedance, 3000.0)
    for name in ("automatic_error_recovery", "stop", "read_once", "load_model", "start_torque_control"):
        outcome.usage(f"{name} with an argument", getattr(robot, name), 1)
    outcome.note("nothing returned", str([robot.stop(), robot.automatic_error_recovery(), robot.set_K(IDENTITY)]))


def frames(_p: Any, robot: Any, outcome: Any) -> None:
    turned = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1, 1.0]
    mirrored, nearly, transposed = IDENTITY.copy(), IDENTITY.copy(), IDENTITY.copy()
    mirrored[0], nearly[0], transposed[3] = -1.0, 1.0000001, 0.1
    for setter in (robot.set_K, robot.set_EE):
        for n, pose in enumerate([turned, mirrored, nearly, transposed, np.eye(4), np.eye(4).ravel(), [NAN] * 16, [0.0] * 15, IDENTITY]):
            outcome.usage(f"{setter.__name__} {n}", setter, pose)
    outcome.note("frames", str(shown(robot, lambda state: state.NE_T_EE == state.EE_T_K == IDENTITY)))


def loads(_p: Any, robot: Any, outcome: Any) -> None:
    origin = [0.0] * 3
    given: list[tuple[Any, ...]] = [(0.5, [0.0, 0.0, 0.05], INERTIA), (1, [0, 0, 0], INERTIA), (np.float64(0.5), np.zeros(3), np.eye(3).ravel())]
    given += [(0.5, origin, [0.0] * 9), (0.5, origin, np.eye(3)), (100.0, origin, INERTIA), (-1.0, origin, INERTIA), (NAN, origin, INERTIA)]
    given += [(0.5, [10.0] * 3, INERTIA), (0.5, [0.0] * 2, INERTIA), ("x", origin, INERTIA), (0.0, origin, [0.0] * 9)]
    for n, load in enumerate(given):
        if outcome.usage(f"load {n}", _returned, robot.set_load, *load):
            outcome.note(f"load {n} is shown", str(shown(robot, lambda state, mass=load[0]: state.m_load == mass)))
    outcome.usage("load by name", robot.set_load, load_mass=0.5, F_x_Cload=origin, load_inertia=INERTIA)


def _returned(call: Any, *arguments: Any) -> bool:
    call(*arguments)
    return True


def models(p: Any, robot: Any, outcome: Any) -> None:
    """Models of states that the program has changed."""
    model, state = robot.load_model(), robot.read_once()
    calls = (model.mass, model.gravity, model.coriolis, model.zero_jacobian)
    for n, call in enumerate(calls):
        outcome.note(f"type {n}", [kind(call(state)), kind(call(state)[0])])
        for arguments in ([], [state.q], [None], [state, state]):
            outcome.usage(f"model {n} of {len(arguments)}", call, *arguments)
        outcome.usage(f"model {n} by name", call, robot_state=state)
    changes = {"q": [0.1, -0.7, 0.2, -2.3, 0.1, 1.5, 0.7], "dq": [0.1] * 7, "m_total": 2.0, "F_x_Ctotal": [0.0, 0.0, 0.1], "O_ddP_O": [0.0, 0.0, -1.62], "F_T_EE": IDENTITY}
    for name, value in changes.items():
        setattr(state, name, value)
        outcome.note(f"after {name}", sum((call(state) for call in calls), []))
    outcome.usage("not made", p.Model)


def cycle(p: Any, robot: Any, outcome: Any) -> None:
    control, zero = robot.start_torque_control(), p.Torques([0.0] * 7)
    read = control.readOnce()
    outcome.note("types", [kind(read), *map(kind, read), kind(read[1].to_sec())])
    written: list[list[Any]] = [[[0.0] * 7], [], [None], [zero, zero], [np.zeros(7)]]
    for n, arguments in enumerate(written):
        outcome.usage(f"write {n}", control.writeOnce, *arguments)
    outcome.usage("write by name", control.writeOnce, command=zero)
    outcome.note("nothing returned", str(control.writeOnce(zero)))
    outcome.usage("read with an argument", control.readOnce, 1)
    busy: list[tuple[Any, ...]] = [(robot.set_K, IDENTITY), (robot.set_joint_impedance, [3000.0] * 7), (robot.automatic_error_recovery,)]
    busy += [(robot.start_joint_position_control, p.ControllerMode.JointImpedance), (robot.set_load, 0.0, [0.0] * 3, [0.0] * 9), (robot.load_model,)]
    for call, *arguments in busy:
        control.readOnce()
        control.writeOnce(zero)
        outcome.usage(f"meanwhile {call.__name__}", call, *arguments)
    control.readOnce()
    zero.motion_finished = True
    outcome.usage("last", control.writeOnce, zero)
    outcome.usage("after the last", control.writeOnce, zero)
    outcome.usage("another command after the last", control.writeOnce, p.JointPositions([0.0] * 7))
    outcome.note("mode", robot.read_once().robot_mode.name)
    outcome.usage("not made", p.ActiveControlBase)
    # A command may come before a state was read, and a second one for a state.
    control, zero = robot.start_torque_control(), p.Torques([0.0] * 7)
    for n, call in enumerate([lambda: control.writeOnce(zero), control.readOnce, lambda: control.writeOnce(zero), lambda: control.writeOnce(zero)]):
        outcome.usage(f"out of order {n}", call)
    control.readOnce()
    zero.motion_finished = True
    control.writeOnce(zero)


def modes(p: Any, robot: Any, outcome: Any) -> None:
    for name in ("joint_position", "joint_velocity", "cartesian_pose", "cartesian_velocity"):
        start = getattr(robot, f"start_{name}_control")
        given: list[list[Any]] = [[], [0], ["joint_impedance"], [p.RealtimeConfig.kIgnore]]
        for n, arguments in enumerate(given):
            outcome.usage(f"{name} {n}", start, *arguments)
        outcome.usage(f"{name} by name", start, control_type=p.ControllerMode.JointImpedance)


def motions(p: Any, robot: Any, outcome: Any) -> None:
    """Runs one after the other with one robot."""
    for turn in range(3):
        control = robot.start_joint_velocity_control(p.ControllerMode.CartesianImpedance)
        for n in range(20):
            _, step = control.readOnce()
            command = p.JointVelocities([0.0] * 7)
            command.motion_finished = n == 19
            control.writeOnce(command)
        outcome.note(f"turn {turn}", step.to_sec())
        outcome.note(f"mode {turn}", robot.read_once().robot_mode.name)


def poses(p: Any, robot: Any, outcome: Any) -> None:
    scaled, mirrored = [1.01, *IDENTITY[1:]], [-1.0, *IDENTITY[1:]]
    for n, pose in enumerate([scaled, mirrored, [0.0] * 16, [INF] * 16, [1.0, 0.0, 0.0, 0.3, *IDENTITY[4:]]]):
        control = robot.start_cartesian_pose_control(p.ControllerMode.CartesianImpedance)
        state, _ = control.readOnce()
        outcome.usage(f"pose {n}", control.writeOnce, p.CartesianPose(pose))
        last = p.CartesianPose(state.O_T_EE_c)
        last.motion_finished = True
        outcome.usage(f"the end after pose {n}", control.writeOnce, last)
        del control
        gc.collect()
        robot.automatic_error_recovery()
        while robot.read_once().robot_mode != p.RobotMode.Idle:
            pass


def exceptions(p: Any, _robot: Any, outcome: Any) -> None:
    for name in ("Franka", "Command", "Control", "Network", "InvalidOperation", "Realtime"):
        made = getattr(p, f"{name}Exception")
        outcome.note(name, [str(made("text")), repr(made("a", 2)), repr(made()), str([base.__name__ for base in made.__mro__])])
    outcome.note("version", p.__version__)


def hand(p: Any, address: str, outcome: Any) -> None:
    hand = p.Gripper(address)
    outcome.note("returns", list(map(kind, (hand.server_version(), hand.homing(), hand.move(0.05, 0.1), hand.stop()))))
    state = hand.read_once()
    names = ("width", "max_width", "is_grasped", "temperature", "time")
    outcome.note("state", [kind(getattr(state, name)) for name in names] + [str(hasattr(p.GripperState, name)) for name in names])
    outcome.note("numbers", [state.max_width, state.temperature])
    outcome.usage("set", setattr, state, "width", 1.0)
    outcome.usage("no other attribute", setattr, state, "other", 1)
    outcome.usage("not made", p.GripperState)
    for width, speed in ((0, 1), ("x", 0.1), (None, 0.1), (-0.01, 0.1), (0.01, -0.1), (0.05, 0.0), (NAN, 0.1), (INF, 0.1), (0.5, 0.1), (0.03, 100.0)):
        outcome.note(f"moves to {width} at {speed}", str(outcome.usage(f"move to {width} at {speed}", hand.move, width, speed)))
    outcome.usage("move by name", hand.move, width=0.02, speed=0.1)
    for rest in ((10.0,), (10.0, 0.1, 0.1), (-1.0,), (1e6,), (NAN,), (10.0, -0.1, -0.1), ()):
        outcome.note(f"grasps {rest}", str(outcome.usage(f"grasp {rest}", hand.grasp, 0.02, 0.1, *rest)))
    named = {"width": 0.02, "speed": 0.1, "force": 10.0, "epsilon_inner": 0.03, "epsilon_outer": 0.03}
    outcome.note("grasps by name", str(outcome.usage("grasp by name", hand.grasp, **named)))
    outcome.note("is grasped", str(hand.read_once().is_grasped))
    outcome.note("opens again", [str(hand.move(0.06, 0.1)), str(round(hand.read_once().width, 3))])
    outcome.usage("homing with an argument", hand.homing, 1)
    outcome.usage("no address", p.Gripper)
