"""Parts of goals: targets, limits, gains, tolerances, guards. All of them are checked when a motion begins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from . import _native
from .value import Value

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "Backend",
    "Box",
    "Budget",
    "Chunk",
    "Controller",
    "Destination",
    "Deviation",
    "Gains",
    "Joints",
    "Lead",
    "Leash",
    "Limits",
    "Margin",
    "Offset",
    "Plane",
    "Setpoints",
    "Settling",
    "Target",
    "Tolerance",
    "Waypoint",
]

Controller = Literal["joint_impedance", "cartesian_impedance"]
"""The robot's own controllers."""

Setpoints = Literal["joint_positions", "joint_velocities", "cartesian_poses", "cartesian_velocities"]
"""The kind of setpoints that a controller of the robot gets."""

Backend: TypeAlias = 'Literal["torques"] | tuple[Controller, Setpoints]'
"""The controller that turns setpoints into torques: the law of this package, or one of the robot's own controllers."""


@dataclass(frozen=True, eq=False)
class Joints(Value):
    """Joint positions as a target: 7 numbers, rad; with velocities, rad/s, for a target that moves."""

    q: ArrayLike
    dq: ArrayLike | None = None

    def __post_init__(self) -> None:
        _set(self, q=_native._row("q", self.q, 7))
        if self.dq is not None:
            _set(self, dq=_native._row("dq", self.dq, 7))


@dataclass(frozen=True, eq=False)
class Offset(Value):
    """A way of the end effector: 3 numbers, m, or 6, with a rotation vector, rad; or a pose, ``(4, 4)``.

    It counts from the present target, so that several add up exactly, or from the measured arm.
    """

    way: ArrayLike
    frame: Literal["base", "tool"] = "base"
    """The frame whose axes it is along and about."""

    from_arm: bool = False
    """True if it counts from the measured arm. It also does if there is no target."""


Target: TypeAlias = "ArrayLike | Joints | tuple[ArrayLike, ArrayLike]"
"""A target is one of:

* a pose of the end effector in the base frame, ``(4, 4)``;
* the same pose as 7 numbers, x y z and a quaternion x y z w;
* a pair of position and quaternion;
* ``Joints``;
* a pose with its velocity, ``(pose, twist)``, where the twist has 6 numbers;
* joint positions with their velocity, ``(q, dq)``, each with 7 numbers.
"""

Destination: TypeAlias = "ArrayLike | Joints | Offset | tuple[ArrayLike, ArrayLike]"
"""A destination is one of:

* a ``Target``;
* 3 numbers: a position that is reached with the orientation kept;
* ``(3, 3)`` or 4 numbers: an orientation (rotation matrix or quaternion x y z w) that is taken with the position kept;
* an ``Offset``.
"""


@dataclass(frozen=True)
class Limits:
    """Limits of one axis, or of a norm. ``None`` stands for the default."""

    velocity: float | None = None
    """m/s or rad/s."""

    acceleration: float | None = None
    """m/s^2 or rad/s^2."""

    jerk: float | None = None
    """m/s^3 or rad/s^3."""

    def _scaled(self, factor: float) -> Limits:
        if self.velocity is None or self.acceleration is None or self.jerk is None:
            raise ValueError("got incomplete limits, expected all: begin with the limits of robot.budget()")
        return Limits(self.velocity * factor, self.acceleration * factor**2, self.jerk * factor**3)


@dataclass(frozen=True)
class Budget:
    """Limits of the approach to a goal. ``None`` stands for the default of the robot: see ``robot.budget()``."""

    translation: Limits = Limits()
    """For the norm of the end effector's translation."""

    rotation: Limits = Limits()
    """For the norm of its rotation."""

    joints: Limits | Sequence[Limits] = Limits()
    """For each joint: the same for all, or seven."""

    def __post_init__(self) -> None:
        for name, limits in (("translation", self.translation), ("rotation", self.rotation)):
            if not isinstance(limits, Limits):
                raise TypeError(f"{name} is {limits!r}, expected Limits")
        if not isinstance(self.joints, Limits):
            joints = tuple(self.joints) if isinstance(self.joints, Sequence) else ()
            if not joints or not all(isinstance(limits, Limits) for limits in joints):
                raise TypeError(f"joints is {self.joints!r}, expected Limits, or seven of them")
            if len(joints) != 7:
                raise ValueError(f"joints has {len(joints)} limits, expected 1 or 7")
            _set(self, joints=joints)

    def scaled(self, factor: float) -> Budget:
        """The budget for the same paths ``factor`` times as fast: velocities times it, accelerations times its square, and so on."""
        joints = [self.joints] * 7 if isinstance(self.joints, Limits) else self.joints
        return Budget(
            self.translation._scaled(factor), self.rotation._scaled(factor), [limits._scaled(factor) for limits in joints]
        )


_COMPLIANT: dict[str, Any] = _native._gains("cartesian")


@dataclass(frozen=True, kw_only=True)
class Gains:
    """Law and gains: a spring and damper at the end effector, along the axes of the base frame, and one at each joint.

    The default is ``Gains.cartesian()``.
    """

    law: Literal["hybrid", "operational_space"] = _COMPLIANT["law"]
    """The way from springs to torques: summed in joint space, or coupled by the inertia at the end effector."""

    cartesian_stiffness: Sequence[float] = _COMPLIANT["cartesian_stiffness"]
    """At the end effector, x y z N/m and about x y z N m/rad, 6 numbers."""

    cartesian_damping: Sequence[float] = _COMPLIANT["cartesian_damping"]
    """At the end effector, N s/m and N m s/rad, 6 numbers."""

    joint_stiffness: Sequence[float] = _COMPLIANT["joint_stiffness"]
    """Stiffness of each joint, N m/rad, 7 numbers."""

    joint_damping: Sequence[float] = _COMPLIANT["joint_damping"]
    """Damping of each joint, N m s/rad, 7 numbers."""

    feedforward: float = _COMPLIANT["feedforward"]
    """Weight of the reference velocity in the dampers, 0 to 1. At full weight they oppose only the velocity error."""

    feedforward_cutoff: float = _COMPLIANT["feedforward_cutoff"]
    """Cutoff frequency of the low-pass on that velocity, Hz; 1000 is off."""

    project_joint_gains: bool = _COMPLIANT["project_joint_gains"]
    """True if the springs of the joints act only where they do not push at the end effector."""

    compensation: Sequence[float] = _COMPLIANT["compensation"]
    """Largest compensation of friction and bias of each joint, N m, 7 numbers; 0 for none."""

    torque_limits: Sequence[float] = _COMPLIANT["torque_limits"]
    """Largest commanded torque of each joint, N m, 7 numbers."""

    torque_cutoff: float = _COMPLIANT["torque_cutoff"]
    """Cutoff frequency of the low-pass on the torques, Hz; 1000 is off."""

    def __post_init__(self) -> None:
        for name, length in [
            ("cartesian_stiffness", 6),
            ("cartesian_damping", 6),
            ("joint_stiffness", 7),
            ("joint_damping", 7),
            ("compensation", 7),
            ("torque_limits", 7),
        ]:
            _set(self, **{name: tuple(_native._row(name, getattr(self, name), length).tolist())})

    @classmethod
    def cartesian(cls) -> Gains:
        """Compliant at the end effector, with light springs at the joints, which keep the elbow: the default for poses."""
        return cls()

    @classmethod
    def joint(cls) -> Gains:
        """Stiff joints, and no spring at the end effector: the default for joint positions."""
        return cls(**_native._gains("joint"))

    @classmethod
    def droid(cls) -> Gains:
        """As compliant, with the softer wrist and lighter damping of the DROID platform, without feedforward and compensation."""
        return cls(**_native._gains("droid"))

    def with_cartesian_stiffness(self, stiffness: ArrayLike) -> Gains:
        """The same with another stiffness at the end effector, 6 numbers; dampings keep their ratio."""
        return Gains(**_native._softened(self, stiffness))

    def with_joint_stiffness(self, stiffness: ArrayLike) -> Gains:
        """The same with another stiffness of the joints, 7 numbers, N m/rad; dampings keep their ratio.

        A joint without a spring takes its ratio from ``Gains.joint()``.
        """
        preset = Gains.joint()
        wanted = _native._row("joint_stiffness", stiffness, 7).tolist()
        damping = []
        for joint, spring in enumerate(wanted):
            ratio_of = self if self.joint_stiffness[joint] > 0.0 else preset
            factor = math.sqrt(max(spring, 0.0) / ratio_of.joint_stiffness[joint])
            damping.append(ratio_of.joint_damping[joint] * factor)
        return replace(self, joint_stiffness=wanted, joint_damping=damping)


@dataclass(frozen=True)
class Margin:
    """Distance of gains to the first oscillation of an arm that lags like the slowest realistic ones."""

    damping: float
    """The factor by which all dampers may grow."""

    stiffness: float
    """The factor by which all springs may grow while the dampers stay."""

    @property
    def is_wanted(self) -> bool:
        """True if both are at least 2, as gains should have."""
        return min(self.damping, self.stiffness) >= _native._MARGIN


@dataclass(frozen=True)
class Leash:
    """Largest distance of the reference ahead of the arm."""

    translation: float = _native._LEASH[0]
    """Distance of the end effector, m."""

    rotation: float = _native._LEASH[1]
    """Angle of the end effector, rad."""

    joints: float = _native._LEASH[2]
    """Angle of each joint, rad."""


@dataclass(frozen=True)
class Deviation:
    """Largest deviation of the arm from its path before the motion is given up. Infinite numbers switch it off."""

    translation: float = _native._DEVIATION[0]
    """Distance of the end effector, m."""

    rotation: float = _native._DEVIATION[1]
    """Angle of the end effector, rad."""

    joints: float = _native._DEVIATION[2]
    """Angle of each joint, rad."""


@dataclass(frozen=True)
class Tolerance:
    """Distance to the target that counts as arrived, measured at the end effector."""

    translation: float = _native._TOLERANCE[0]
    """m."""

    rotation: float = _native._TOLERANCE[1]
    """rad."""


@dataclass(frozen=True)
class Settling:
    """Conditions under which an arm counts as settled at its target."""

    hold: float = _native._SETTLING[0]
    """Time for which it has to stay within the tolerance and at rest, s, in whole milliseconds."""

    timeout: float = _native._SETTLING[1]
    """Longest time for that, s, up to 60."""


@dataclass(frozen=True)
class Lead:
    """Largest distance of a followed target ahead of the arm; a target that is further away is drawn nearer."""

    translation: float
    """m."""

    rotation: float
    """rad."""

    joints: float
    """Angle of each joint, rad."""


@dataclass(frozen=True, eq=False)
class Waypoint(Value):
    """A place on a path."""

    target: Target
    """The place: a pose or ``Joints``."""

    blend: float = 0.0
    """Distance from it at which the path may begin to round its corner: m for poses, rad (norm) for joints. At 0 the arm
    stops there."""


@dataclass(frozen=True, eq=False)
class Chunk(Value):
    """Points with times, as a policy predicts them from one observation. Give ``dt`` or ``times``.

    ``points`` are positions ``(N, 3)``, with the orientation kept; poses ``(N, 7)``, x y z and a quaternion x y z w, or
    ``(N, 4, 4)``; with ``joints=True`` joint positions ``(N, 7)``, rad.
    """

    points: ArrayLike
    dt: float | None = None
    """Time between two points, s; the first one is at the origin."""

    times: ArrayLike | None = None
    """Time of each point after the origin, ``(N,)`` s."""

    velocities: ArrayLike | None = None
    """Twists ``(N, 6)`` or joint velocities ``(N, 7)``; estimated from the neighbours if ``None``."""

    joints: bool = False
    """True if the points are joint positions."""

    observed_at: Any = None
    """The ``RobotState`` that the policy saw, or its ``time_ms``: the origin. ``None`` counts from the time at which the
    chunk is taken up."""

    blend: float | None = None
    """Time over which it is blended with the present motion of the arm, s; 0 turns to it as fast as the limits allow.
    ``None`` is 0.1 s."""


@dataclass(frozen=True, eq=False)
class Plane(Value):
    """A region that the arm keeps out of: all points ``p`` with ``normal @ p < offset``, base frame."""

    normal: ArrayLike
    """Points out of the region; 3 numbers of any length."""

    offset: float
    """Distance of the surface from the origin along the normal, m."""

    @classmethod
    def floor(cls, z: float) -> Plane:
        """Everything below the height ``z``, m."""
        return cls((0.0, 0.0, 1.0), z)


@dataclass(frozen=True, eq=False)
class Box(Value):
    """A region that the arm keeps out of: a box in any orientation, base frame."""

    pose: ArrayLike
    """Pose of its centre, ``(4, 4)`` or 7 numbers."""

    sides: ArrayLike
    """Its sides, 3 numbers, m, along the axes of ``pose``."""


def _set(value: object, **fields: Any) -> None:
    for name, field in fields.items():
        object.__setattr__(value, name, field)
