"""The robot and its model."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ... import _native
from ...goal import Budget, Deviation, Gains, Leash, Limits
from .._waiting import changed, wait
from ._errors import FrankaError, translated
from ._gripper import Gripper
from ._rotation import Array, vector
from ._targets import CartesianTargets, JointTargets

_CONTROLLERS = ("joint_impedance", "cartesian_impedance")
_HAND = np.array(
    [
        [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0],
        [-np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
"""Pose of the Hand on the flange: turned by -45 degrees about z."""


class Model:
    """Kinematics and dynamics of the connected arm."""

    def __init__(self, model: _native.Model) -> None:
        self._model = model
        self.pose = model.pose
        self.zero_jacobian = model.zero_jacobian
        self.body_jacobian = model.body_jacobian
        self.mass = model.mass
        self.gravity = model.gravity

    def __repr__(self) -> str:
        return "Model()"

    def coriolis(
        self,
        q: npt.ArrayLike,
        dq: npt.ArrayLike,
        I_total: npt.ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: npt.ArrayLike | None = None,
        gravity_earth: npt.ArrayLike | None = None,
    ) -> Array:
        """Returns the torques of Coriolis and centrifugal forces, (7,). They do not depend on ``gravity_earth``."""
        if gravity_earth is not None:
            vector("gravity_earth", gravity_earth, 3)
        return self._model.coriolis(q, dq, I_total, m_total, F_x_Ctotal)

    def link_poses(self, q: npt.ArrayLike) -> Array:
        """Returns the poses of the base and the seven links, ``(8, 4, 4)``."""
        return np.concatenate([np.eye(4)[np.newaxis], self._model.link_poses(q)[:7]])

    def hand_pose(self, q: npt.ArrayLike) -> Array:
        """Returns the pose of the Hand, (4, 4): the flange turned by -45 degrees about its z axis."""
        pose: Array = self._model.pose("flange", q) @ _HAND
        return pose


class Robot:
    """A connected robot. The constructor connects; the connection lasts as long as the object lives."""

    def __init__(self, address: str, *, realtime: str | None = None, log_size: int | None = None) -> None:
        if realtime is not None:
            _text("realtime", realtime)
        wanted = realtime if realtime is not None else os.environ.get("FRANKA_REALTIME") or "enforce"
        if wanted not in ("enforce", "ignore"):
            choices = "'enforce' or 'ignore' (also read from FRANKA_REALTIME)"
            raise ValueError(f'franka: realtime must be {choices}, got "{wanted}"')
        self._address = address
        self._robot = _native.Robot(address, realtime=realtime, log_size=log_size)  # type: ignore[arg-type]
        with translated():
            wait(self._robot.connect())

    @property
    def address(self) -> str:
        """Address of the robot, as the program gave it."""
        return self._address

    @property
    def fci_version(self) -> int:
        """The protocol version, 10 or 5."""
        return self._robot.fci_version

    @property
    def server_version(self) -> int:
        """The protocol version, as the robot reports it."""
        return self._robot.fci_version

    def __repr__(self) -> str:
        return f'Robot("{self.address}", fci_version={self.fci_version}, server_version={self.server_version})'

    def read_once(self) -> _native.RobotState:
        """Waits for the next state. This also works while a session runs."""
        with translated():
            state = changed(self._robot.state, lambda state: state.time_ms)
        if state is None:
            raise FrankaError("libfranka: UDP receive: Timeout", kind="network")
        return state

    def set_collision_behavior(
        self,
        lower_torque_thresholds_acceleration: npt.ArrayLike,
        upper_torque_thresholds_acceleration: npt.ArrayLike,
        lower_torque_thresholds_nominal: npt.ArrayLike,
        upper_torque_thresholds_nominal: npt.ArrayLike,
        lower_force_thresholds_acceleration: npt.ArrayLike,
        upper_force_thresholds_acceleration: npt.ArrayLike,
        lower_force_thresholds_nominal: npt.ArrayLike,
        upper_force_thresholds_nominal: npt.ArrayLike,
    ) -> None:
        """Sets the thresholds of contact (lower) and collision (upper), for an accelerating arm and for other motions."""
        given = {name: value for name, value in locals().items() if name != "self"}
        thresholds = {name: vector(name, value, 7 if "torque" in name else 6) for name, value in given.items()}
        self._set("Set Collision Behavior", lambda: self._robot.set_collision_behavior(**thresholds))

    def set_collision_behavior_simple(
        self,
        lower_torque_thresholds: npt.ArrayLike,
        upper_torque_thresholds: npt.ArrayLike,
        lower_force_thresholds: npt.ArrayLike,
        upper_force_thresholds: npt.ArrayLike,
    ) -> None:
        """Sets the thresholds of contact and collision, with the same values for an accelerating arm and for other motions."""
        torque, force = (lower_torque_thresholds, upper_torque_thresholds), (lower_force_thresholds, upper_force_thresholds)
        self.set_collision_behavior(*torque, *torque, *force, *force)

    def set_joint_impedance(self, K_theta: npt.ArrayLike) -> None:
        """Sets the stiffness of the robot's joint impedance controller, (7,), N m/rad."""
        stiffness = vector("K_theta", K_theta, 7)
        self._set("Set Joint Impedance", lambda: self._robot.set_joint_impedance(stiffness))

    def set_cartesian_impedance(self, K_x: npt.ArrayLike) -> None:
        """Sets the stiffness of the robot's Cartesian impedance controller, (6,), N/m and N m/rad."""
        stiffness = vector("K_x", K_x, 6)
        self._set("Set Cartesian Impedance", lambda: self._robot.set_cartesian_impedance(stiffness))

    def _set(self, command: str, setting: Callable[[], Any]) -> None:
        try:
            operation = setting()
        except ValueError as error:
            # The original does not check this; the robot does.
            raise FrankaError(f"libfranka: {command} command rejected: invalid argument!", kind="command") from error
        with translated():
            wait(operation)

    def automatic_error_recovery(self) -> None:
        """Recovers the robot from a reflex."""
        with translated():
            wait(self._robot.recover())

    def stop(self) -> None:
        """Stops every motion, from any thread. The ``stop`` of a session then raises ControlException."""
        with translated():
            wait(self._robot.stop())

    def model(self) -> Model:
        """Returns the model of this arm."""
        with translated():
            return Model(self._robot.model())

    def gripper(self) -> Gripper:
        """Connects to the Hand of this robot and returns it."""
        gripper = Gripper.__new__(Gripper)
        gripper._connect(self._robot.gripper())
        return gripper

    def cartesian_targets(
        self,
        *,
        max_velocity: float = 0.3,
        max_acceleration: float = 0.5,
        max_jerk: float = 20.0,
        max_deviation: float = 0.30,
        max_angular_velocity: float | None = None,
        max_angular_acceleration: float | None = None,
        max_angular_jerk: float | None = None,
        max_angular_deviation: float | None = None,
        backend: str = "impedance",
        cartesian_stiffness: npt.ArrayLike | None = None,
        cartesian_damping: npt.ArrayLike | None = None,
        joint_stiffness: npt.ArrayLike | None = None,
        joint_damping: npt.ArrayLike | None = None,
        torque_limits: npt.ArrayLike | None = None,
        posture: npt.ArrayLike | None = None,
        torque_cutoff: float | None = None,
        velocity_feedforward: bool | None = None,
        leash: Sequence[float] | None = None,
        project_joint_gains: bool = False,
        controller_mode: str = "cartesian_impedance",
        limit_rate: bool = True,
        realtime_priority: int | None = None,
    ) -> CartesianTargets:
        """Begins a session with targets of the end effector. Limits are in m/s, m/s^2 and m/s^3, and for angles in rad
        instead of m.

        ``limit_rate`` and ``realtime_priority`` have no effect: commands are always limited, and the priority belongs to the
        connection.
        """
        bounds = (_real("max_velocity", max_velocity), _real("max_acceleration", max_acceleration), _real("max_jerk", max_jerk))
        _check_unused(limit_rate, realtime_priority)
        limits = Budget(
            translation=Limits(*bounds),
            rotation=Limits(
                _or(max_angular_velocity, 0.5), _or(max_angular_acceleration, 1.0), _or(max_angular_jerk, 20.0)
            ),
        )
        deviation = Deviation(
            translation=_finite("max_deviation", max_deviation),
            rotation=_finite("max_angular_deviation", _or(max_angular_deviation, 0.5)),
        )
        gains = _given(
            cartesian_stiffness=_of_axes(cartesian_stiffness, Gains.droid().cartesian_stiffness),
            cartesian_damping=_of_axes(cartesian_damping, Gains.droid().cartesian_damping),
            joint_stiffness=joint_stiffness,
            joint_damping=joint_damping,
            torque_limits=torque_limits,
            torque_cutoff=torque_cutoff,
            feedforward=_feedforward(velocity_feedforward),
        )
        options: dict[str, Any] = {"limits": limits, "deviation": deviation}
        posture = None if posture is None else vector("posture", posture, 7)
        leash = None if leash is None else _leash(leash)
        if _by_robot(backend, controller_mode, project_joint_gains, **gains, posture=posture, leash=leash):
            options["backend"] = (controller_mode, "cartesian_poses")
        else:
            options["gains"] = _gains(Gains.droid(), gains, project_joint_gains)
            options |= _given(posture=posture, leash=None if leash is None else Leash(*leash))
        arm = self._engage(options)
        pose = self._robot.state().flat()
        return CartesianTargets(self._robot, arm, pose[28:35].copy())

    def joint_targets(
        self,
        *,
        fraction: float = 0.2,
        max_deviation: float = 1.0,
        backend: str = "impedance",
        joint_stiffness: npt.ArrayLike | None = None,
        joint_damping: npt.ArrayLike | None = None,
        torque_limits: npt.ArrayLike | None = None,
        torque_cutoff: float | None = None,
        velocity_feedforward: bool | None = None,
        leash: float | None = None,
        project_joint_gains: bool = False,
        controller_mode: str = "joint_impedance",
        limit_rate: bool = True,
        realtime_priority: int | None = None,
    ) -> JointTargets:
        """Begins a session with joint targets, at this fraction of the limits of this package. ``limit_rate`` and
        ``realtime_priority`` have no effect, as in ``cartesian_targets``.
        """
        gains = _given(
            joint_stiffness=joint_stiffness,
            joint_damping=joint_damping,
            torque_limits=torque_limits,
            torque_cutoff=torque_cutoff,
            feedforward=_feedforward(velocity_feedforward),
        )
        if not _real("fraction", fraction) > 0.0:
            raise ValueError(f"franka: fraction must be positive, got {fraction}")
        _check_unused(limit_rate, realtime_priority)
        deviation = Deviation(joints=_finite("max_deviation", max_deviation))
        options: dict[str, Any] = {"speed": fraction, "deviation": deviation}
        if leash is not None and np.ndim(leash) != 0:
            raise ValueError(f"franka: leash takes one float (rad) for joints, got {leash!r}")
        if _by_robot(backend, controller_mode, project_joint_gains, **gains, leash=leash):
            options["backend"] = (controller_mode, "joint_positions")
        else:
            # The law has no spring at the end effector, so it has no null space in which the joint springs could act.
            options["gains"] = _gains(Gains.joint(), gains, False)
            options |= _given(leash=None if leash is None else Leash(joints=leash))
        arm = self._engage(options)
        return JointTargets(self._robot, arm, self._robot.state().q)

    def _engage(self, options: dict[str, Any]) -> _native.Arm:
        try:
            with translated():
                arm: _native.Arm = wait(self._robot.engage(**options))
        except ValueError as error:
            raise FrankaError(str(error), kind="invalid_argument") from error
        return arm


def _text(name: str, value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"franka: {name} is text, got {value!r}")
    return value


def _real(name: str, value: object) -> float:
    if not isinstance(value, float | int | np.number):
        raise TypeError(f"franka: {name} is a number, got {value!r}")
    return float(value)


def _truth(name: str, value: object) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"franka: {name} is True or False, got {value!r}")
    return bool(value)


def _finite(name: str, value: object) -> float:
    number = _real(name, value)
    if not (0.0 < number < np.inf):
        raise FrankaError(f"target control: {name} must be finite and positive, got {number}", kind="invalid_argument")
    return number


def _feedforward(velocity_feedforward: bool | None) -> float | None:
    return None if velocity_feedforward is None else float(_truth("velocity_feedforward", velocity_feedforward))


def _leash(leash: Sequence[float]) -> list[float]:
    if np.ndim(leash) != 1:
        raise ValueError(f"franka: leash takes 2 values (m, rad), got {leash!r}")
    lengths: list[float] = vector("leash", leash, 2).tolist()
    return lengths


def _check_unused(limit_rate: bool, realtime_priority: int | None) -> None:
    _truth("limit_rate", limit_rate)
    if realtime_priority is not None and not 1 <= _real("realtime_priority", realtime_priority) <= 99:
        text = f"target control: realtime_priority must be within 1..=99, got {realtime_priority}"
        raise FrankaError(text, kind="invalid_argument")


def _or(value: float | None, default: float) -> float:
    return default if value is None else value


def _given(**options: Any) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}


def _of_axes(values: npt.ArrayLike | None, defaults: Any) -> Any:
    """Expands one number to all three translations."""
    if values is not None and np.ndim(values) == 0:
        return [float(np.float64(values))] * 3 + list(defaults[3:])  # type: ignore[arg-type]
    return values


_LENGTHS = {
    "cartesian_stiffness": 6,
    "cartesian_damping": 6,
    "joint_stiffness": 7,
    "joint_damping": 7,
    "torque_limits": 7,
}


def _gains(defaults: Gains, given: dict[str, Any], project: bool) -> Gains:
    chosen = {
        name: _of_length(name, value, _LENGTHS[name]) if name in _LENGTHS else value
        for name, value in given.items()
    }
    # Without an explicit value the original uses no feedforward.
    chosen = {"feedforward": 0.0, **chosen, "project_joint_gains": project}
    try:
        return dataclasses.replace(defaults, **chosen)
    except ValueError as error:
        raise FrankaError(f"target control: {error}", kind="invalid_argument") from error


def _of_length(name: str, values: npt.ArrayLike, length: int) -> list[float]:
    array = np.array(values, dtype=np.float64)
    if array.shape != (length,):
        raise ValueError(f"franka: {name} takes {length} values, got the shape {array.shape}")
    listed: list[float] = array.tolist()
    return listed


def _by_robot(backend: str, controller_mode: str, project_joint_gains: bool, **impedance: Any) -> bool:
    """True if the robot's own controller follows the targets. Raises ``ValueError``."""
    _text("backend", backend), _text("controller_mode", controller_mode)
    if _truth("project_joint_gains", project_joint_gains):
        impedance = {**impedance, "project_joint_gains=True": True}
    if backend not in ("impedance", "robot"):
        raise ValueError(f'franka: backend must be \'impedance\' or \'robot\', got "{backend}"')
    if controller_mode not in _CONTROLLERS:
        raise ValueError(
            f"franka: controller_mode must be 'joint_impedance' or 'cartesian_impedance', got \"{controller_mode}\""
        )
    if backend == "robot":
        for name, value in impedance.items():
            if value is not None:
                name = "velocity_feedforward" if name == "feedforward" else name
                raise ValueError(f"franka: {name} applies to backend='impedance' only, not to backend='robot'")
    return backend == "robot"
