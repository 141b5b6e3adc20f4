"""Uses of ``franka``, right and wrong: types, keywords, defaults and misuse, without the texts of errors."""

from __future__ import annotations

import gc
import math
from typing import Any

import numpy as np

Q = [0.1, -0.7, 0.2, -2.3, 0.1, 1.5, 0.7]
NAN, INF = math.nan, math.inf


def everything(f: Any, address: str, outcome: Any) -> None:
    """Runs all of them with one robot, as one process takes longer to start than a program to run."""
    given: list[list[Any]] = [[], [address, "ignore"], [5]]
    for n, arguments in enumerate(given):
        outcome.usage(f"connect {n}", f.Robot, *arguments)
    options: list[dict[str, Any]] = [{"realtime": 1}, {"realtime": "Ignore"}, {"log_size": "5"}, {"log_size": -1}, {"speed": 1}]
    for n, named in enumerate(options):
        outcome.usage(f"connect with {n}", f.Robot, address, **{"realtime": "ignore", **named})
    outcome.usage("no port", f.Robot, f"{address}:abc", realtime="ignore")
    robot = f.Robot(address=address, realtime="ignore", log_size=10)
    for use in (values, model, dynamics, parameters, cartesian_options, joint_options, sessions, chunks, blocks, joints, rotations, errors):
        outcome.note("use", use.__name__)
        use(f, robot, outcome)
        gc.collect()


def kind(value: Any) -> str:
    return type(value).__name__


def described(value: Any) -> Any:
    return [kind(value), str(getattr(value, "dtype", "")), str(np.shape(value))]


def values(f: Any, robot: Any, outcome: Any) -> None:
    state = robot.read_once()
    for name in """EE_T_K F_T_EE F_x_Cee I_ee I_load K_F_ext_hat_K O_dP_EE_c O_ddP_O accelerometer_top cartesian_contact current_errors ddelbow_c
        ddq_d elbow joint_contact last_motion_errors m_ee q robot_mode time control_command_success_rate FLAT_LAYOUT FLAT_LEN""".split():
        outcome.note(name, described(getattr(state, name)))
    q = state.q
    q[0] = 99.0
    outcome.note("an array is a copy", [str(state.q[0] == 99.0), str(state.q is state.q), str(state.flat().flags.writeable)])
    outcome.note("layout", str(f.FLAT_LAYOUT))
    outcome.usage("set", setattr, state, "q", [0.0] * 7)
    outcome.usage("no other attribute", setattr, state, "other", 1)
    for name in ("RobotState", "GripperState", "CartesianTargets", "JointTargets", "Model", "Gripper"):
        outcome.usage(f"{name} not made", getattr(f, name))
    outcome.note("robot", [repr(robot).replace(robot.address, ""), repr(robot.model()), kind(robot.address), kind(robot.server_version)])
    outcome.usage("a version is no method", lambda: robot.server_version())
    outcome.usage("a robot is no block", lambda: robot.__enter__)
    outcome.note("nothing returned", str([robot.stop(), robot.automatic_error_recovery()]))
    outcome.note("all", sorted(f.__all__))


def model(_f: Any, robot: Any, outcome: Any) -> None:
    model, q, tool = robot.model(), np.array(Q), np.eye(4)
    tool[:3, 3] = [0.1, 0.2, 0.3]
    given: list[tuple[Any, ...]] = [("ee", Q), ("ee", tuple(Q)), ("ee", [0, 0, 0, -1, 0, 1, 0]), ("ee", q.astype(np.float32)), ("ee", np.repeat(q, 2)[::2])]
    given += [("ee", Q, tool), ("ee", Q, tool.tolist()), ("stiffness", Q, tool, tool), ("hand", Q), (3, Q), ("EE", Q), ("ee", Q[:6]), ("ee",), ("ee", Q, np.eye(3))]
    for name in ("pose", "zero_jacobian", "body_jacobian"):
        call = getattr(model, name)
        for n, arguments in enumerate(given):
            result = outcome.usage(f"{name} {n}", call, *arguments)
            outcome.note(f"{name} is {n}", "none" if result is None else result)
        outcome.note(f"{name} by name", call(frame="stiffness", q=Q, F_T_EE=tool, EE_T_K=tool))
        outcome.usage(f"{name} by a wrong name", call, "ee", Q, tool=tool)
    outcome.note("types", [described(model.pose("ee", Q)), described(model.link_poses(q=Q)), described(model.hand_pose(q=Q))])


def dynamics(_f: Any, robot: Any, outcome: Any) -> None:
    model, inertia, com = robot.model(), [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.03]], [0.0, 0.0, 0.1]
    for name, first in (("mass", [Q]), ("coriolis", [Q, [0.1] * 7]), ("gravity", [Q])):
        call = getattr(model, name)
        loads: list[dict[str, Any]] = [{}, {"m_total": 1}, {"m_total": 1.0, "F_x_Ctotal": com}, {"F_x_Ctotal": [0.0, 0.0]}, {"m_total": "x"}, {"load": 1}]
        loads += [{"gravity_earth": [0.0, 0.0, -1.62]}, {"gravity_earth": [0.0, 0.0]}, {"I_total": inertia, "m_total": 1.0}, {"I_total": np.eye(2)}]
        for n, load in enumerate(loads):
            result = outcome.usage(f"{name} {n}", call, *first, **load)
            outcome.note(f"{name} is {n}", "none" if result is None else result)
    outcome.note("by position", [model.gravity(Q, 1.0, com, [0.0, 0.0, -1.62]), model.coriolis(Q, Q, inertia, 1.0, com, None)])


def parameters(_f: Any, robot: Any, outcome: Any) -> None:
    seven, six = [20.0] * 7, [20.0] * 6
    names = [f"{bound}_{what}_thresholds_{when}" for what in ("torque", "force") for when in ("acceleration", "nominal") for bound in ("lower", "upper")]
    outcome.usage("all by name", robot.set_collision_behavior, **{name: seven if "torque" in name else six for name in names})
    outcome.usage("four of eight", robot.set_collision_behavior, seven, seven, six, six)
    given: list[Any] = [[20] * 7, np.full(7, 20.0, dtype=np.float32), seven[:6], [NAN] * 7, [INF] * 7, [-1.0] * 7, None, np.full((7, 1), 20.0), 20.0]
    for n, value in enumerate(given):
        outcome.usage(f"simple {n}", robot.set_collision_behavior_simple, value, value, six, six)
        outcome.usage(f"joints {n}", robot.set_joint_impedance, value)
    for n, value in enumerate([[200] * 6, [200.0] * 5, [NAN] * 6, [-1.0] * 6]):
        outcome.usage(f"axes {n}", robot.set_cartesian_impedance, value)
    outcome.usage("by a wrong name", robot.set_joint_impedance, stiffness=[3000.0] * 7)


def _options(begin: Any, options: list[dict[str, Any]], outcome: Any) -> None:
    for number, one in enumerate(options):
        targets = outcome.usage(f"option {number} {sorted(one)}", begin, **one)
        if targets is not None:
            targets.stop()


def cartesian_options(_f: Any, robot: Any, outcome: Any) -> None:
    options: list[dict[str, Any]] = [{"max_velocity": value} for value in (0.0, NAN, "x", None, 1)]
    options += [{"max_acceleration": 0.0}, {"max_jerk": -1.0}, {"max_angular_velocity": 0.0}, {"max_angular_deviation": -0.1}]
    options += [{"max_deviation": value} for value in (0.0, -1.0, INF, NAN)]
    options += [{"backend": value} for value in ("Impedance", None, "robot")]
    by_robot: dict[str, Any] = {"cartesian_stiffness": [1.0] * 6, "posture": Q, "velocity_feedforward": False, "project_joint_gains": True, "torque_cutoff": 1.0}
    options += [{"backend": "robot", name: value} for name, value in by_robot.items()]
    options += [{"cartesian_stiffness": value} for value in (500.0, 500, [500.0] * 3, [500.0] * 3 + [20.0] * 3, [-1.0] * 6, NAN, [0.0] * 6)]
    options += [{"cartesian_damping": value} for value in (50.0, [-1.0] * 6, [0.0] * 6)]
    options += [{"joint_stiffness": value} for value in ([40.0] * 7, [-1.0] * 7, [40.0] * 6, 40.0)]
    options += [{"torque_limits": value} for value in ([50.0] * 4 + [10.0] * 3, [1000.0] * 7, [0.0] * 7, [50.0] * 6)]
    options += [{"posture": value} for value in (Q, [0.0] * 6, [10.0] * 7, [NAN] * 7)]
    options += [{"torque_cutoff": value} for value in (50.0, 0.0, -1.0, INF)] + [{"velocity_feedforward": value} for value in (True, None, 1)]
    options += [{"leash": value} for value in ((0.02, 0.1), np.array([0.02, 0.1]), 0.02, (0.02,), (0.0, 0.0), (INF, INF))]
    options += [{"controller_mode": ""}, {"limit_rate": False}, {"limit_rate": 0}, {"unknown": 1}]
    options += [{"realtime_priority": value} for value in (50, 0, 100, "x")]
    _options(robot.cartesian_targets, options, outcome)


def joint_options(_f: Any, robot: Any, outcome: Any) -> None:
    options: list[dict[str, Any]] = [{"fraction": value} for value in (0.0, -0.1, 1.0, 1, NAN, "x", None)]
    options += [{"max_deviation": value} for value in (0.0, INF)] + [{"backend": "robot", "leash": 0.1}, {"backend": "robot"}]
    options += [{"leash": value} for value in (0.1, 0.0, (0.1, 0.1), INF, NAN)] + [{"joint_damping": [0.0] * 7}, {"project_joint_gains": True}]
    options += [{"velocity_feedforward": 0.5}, {"cartesian_stiffness": [1.0] * 6}, {"max_velocity": 0.1}, {"posture": Q}, {"controller_mode": "x"}]
    _options(robot.joint_targets, options, outcome)
    outcome.usage("by position", robot.joint_targets, 0.2)


def sessions(f: Any, robot: Any, outcome: Any) -> None:
    targets = robot.cartesian_targets()
    begin = targets.target()
    outcome.note("types", [kind(targets), repr(targets), kind(targets.running), str(targets.target() is targets.target()), str(targets.__enter__() is targets)])
    outcome.note("nothing returned", str([targets.move_to(begin), targets.move_by([0.0] * 3), targets.follow([begin])]))
    way, turned = list(begin[:3]), list(begin[3:])
    to: list[Any] = [tuple(begin), way, begin.astype(np.float32), targets.target_pose(), way + [0.0], None, [], [NAN] * 3, way + [5 * x for x in turned]]
    to += [way + [1e-9, 0.0, 0.0, 0.0], way + [0.0] * 4, begin.reshape(1, 7), 1.0, way + [NAN] * 4]
    for n, target in enumerate(to):
        outcome.usage(f"to {n}", targets.move_to, target)
        targets.move_to(begin)
    by: list[Any] = [(0.0, 0.0, 0.0), [0.0] * 6, [0.0] * 7, [0.0] * 5, [NAN] * 3, [0, 0, 0], None, np.eye(4)]
    for n, delta in enumerate(by):
        outcome.usage(f"by {n}", targets.move_by, delta)
        targets.move_to(begin)
    outcome.usage("running set", setattr, targets, "running", False)
    outcome.usage("second", robot.cartesian_targets)
    outcome.usage("recovery meanwhile", robot.automatic_error_recovery)
    outcome.usage("model meanwhile", robot.model)
    outcome.note("stopped", [str(targets.stop()), repr(targets)])
    calls = [lambda: targets.move_to(begin), lambda: targets.move_by([0.0] * 3), lambda: targets.follow([begin]), targets.target, targets.state]
    for n, call in enumerate([*calls, targets.target_pose, targets.stop]):
        outcome.usage(f"afterwards {n}", call)


def chunks(_f: Any, robot: Any, outcome: Any) -> None:
    targets = robot.cartesian_targets()
    begin = targets.target()
    way = list(begin[:3])
    given: list[tuple[Any, ...]] = [([begin, begin],), ([begin], 0.01), (begin,), ([],), (np.zeros((0, 7)),), ([way, way],), (np.zeros((2, 4)),), (None,), ()]
    given += [([begin], dt) for dt in (0.0, -1.0, NAN, INF, 1, None)] + [([begin, way],), (np.zeros((1, 1, 7)),), ([way, [NAN] * 3],), ([begin, way + [0.0] * 4],)]
    for n, arguments in enumerate(given):
        outcome.usage(f"chunk {n}", targets.follow, *arguments)
        targets.move_to(begin)
    outcome.usage("by name", targets.follow, chunk=[begin], dt=0.5)
    targets.stop()


def blocks(f: Any, robot: Any, outcome: Any) -> None:
    def raising(error: type[Exception]) -> None:
        with robot.joint_targets():
            raise error("of the program")

    def stopped_by_the_robot() -> None:
        with robot.joint_targets():
            robot.stop()

    def stopped_twice() -> None:
        with robot.joint_targets() as targets:
            targets.stop()
            targets.stop()

    def nested() -> None:
        with robot.joint_targets(), robot.cartesian_targets():
            pass

    def entered_twice() -> None:
        targets = robot.joint_targets()
        with targets, targets:
            pass

    for error in (ValueError, KeyError, RuntimeError):
        outcome.usage(f"raising {error.__name__}", raising, error)
    for call in (stopped_by_the_robot, stopped_twice, nested, entered_twice):
        outcome.usage(call.__name__, call)


def joints(_f: Any, robot: Any, outcome: Any) -> None:
    with robot.joint_targets() as targets:
        begin = targets.target()
        to: list[Any] = [list(begin), list(begin[:6]), [NAN] * 7, [5.0] * 7, None, begin.reshape(1, 7)]
        for n, target in enumerate(to):
            outcome.usage(f"to {n}", targets.move_to, target)
            targets.move_to(begin)
        for n, delta in enumerate([[0.0] * 7, [0.0] * 6 + [10.0], [0.0] * 3]):
            outcome.usage(f"by {n}", targets.move_by, delta)
        outcome.usage("no pose", lambda: targets.target_pose())


def rotations(f: Any, _robot: Any, outcome: Any) -> None:
    one, none = [0.0, 0.0, 0.0, 1.0], [0.0] * 3
    given: list[tuple[Any, ...]] = [(one, none), (one, [0.0, 0.0, math.pi / 2]), ([1.0, 0.0, 0.0, 0.0], [0.1, 0.2, 0.3]), (one, [1e-9, 0.0, 0.0])]
    given += [([0.0, 0.0, 0.0, 5.0], [0.0, 0.0, 1.0]), ([0.0] * 4, none), (one, [0.0, 0.0, 10.0]), ((0, 0, 0, 1), (0, 0, 1)), (one,)]
    for n, arguments in enumerate(given):
        result = outcome.usage(f"rotated {n}", f.rotated, *arguments)
        outcome.note(f"is {n}", "none" if result is None else result)
    outcome.note("by name", f.rotated(quaternion=one, rotation_vector=none))


def errors(f: Any, robot: Any, outcome: Any) -> None:
    for made in (f.FrankaError, f.ControlException):
        outcome.note(made.__name__, [str(made("text")), repr(made("text")), str(made()), str([base.__name__ for base in made.__mro__])])
    try:
        robot.set_joint_impedance([-1.0] * 7)
    except f.FrankaError as error:
        outcome.note("refused", [str(error), error.kind, repr(error), str(error.args)])


def hand(f: Any, address: str, outcome: Any) -> None:
    hand = f.Robot(address, realtime="ignore").gripper()
    outcome.note("types", [repr(hand), kind(hand.homing()), kind(hand.server_version)])
    state = hand.read_once()
    outcome.note("state", [kind(getattr(state, name)) for name in ("width", "max_width", "is_grasped", "temperature", "time")])
    outcome.usage("set", setattr, state, "width", 1.0)
    for width, speed in ((0, 1), ("x", 0.1), (-0.01, 0.1), (0.01, -0.1), (0.05, 0.0), (NAN, 0.1), (INF, 0.1), (0.5, 0.1), (0.03, 100.0)):
        outcome.note(f"moves to {width} at {speed}", str(outcome.usage(f"move to {width} at {speed}", hand.move, width, speed)))
    for rest in ((10.0,), (10.0, 0.1, 0.1), (-1.0,), (NAN,), (10.0, -0.1, -0.1), ()):
        outcome.note(f"grasps {rest}", str(outcome.usage(f"grasp {rest}", hand.grasp, 0.02, 0.1, *rest)))
    outcome.usage("by name", hand.move, width=0.02, speed=0.1)
    outcome.note("stops", str(hand.stop()))
