"""Parts of goals: targets, limits, gains, tolerances, guards. The driver checks all of them when a motion begins."""

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
"""Kind of setpoints for a controller of the robot."""

Backend: TypeAlias = 'Literal["torques"] | tuple[Controller, Setpoints]'
"""The controller that turns setpoints into torques: the control law of this package, or one of the robot's own controllers."""


@dataclass(frozen=True, eq=False)
class Joints(Value):
    """Joint positions as a target, 7 numbers, rad. A moving target also has velocities, rad/s."""

    q: ArrayLike
    dq: ArrayLike | None = None

    def __post_init__(self) -> None:
        _set(self, q=_native._row("q", self.q, 7))
        if self.dq is not None:
            _set(self, dq=_native._row("dq", self.dq, 7))


@dataclass(frozen=True, eq=False)
class Offset(Value):
    """A displacement of the end effector: 3 numbers, m; or 6 numbers, with a rotation vector, rad; or a pose, ``(4, 4)``.

    It is relative to the current target, so that several offsets add up exactly, or relative to the measured pose of the
    arm.
    """

    way: ArrayLike
    frame: Literal["base", "tool"] = "base"
    """The frame in whose axes the displacement is given."""

    from_arm: bool = False
    """True if the displacement is relative to the measured pose. Without a current target, it always is."""


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
    """Limits of one axis, or of a norm. ``None`` means the default."""

    velocity: float | None = None
    """Largest velocity, m/s or rad/s."""

    acceleration: float | None = None
    """Largest acceleration, m/s^2 or rad/s^2."""

    jerk: float | None = None
    """Largest jerk, m/s^3 or rad/s^3."""

    def _scaled(self, factor: float) -> Limits:
        if self.velocity is None or self.acceleration is None or self.jerk is None:
            raise ValueError("got incomplete limits, expected all: begin with the limits of robot.budget()")
        return Limits(self.velocity * factor, self.acceleration * factor**2, self.jerk * factor**3)


@dataclass(frozen=True)
class Budget:
    """Limits of the motion to a goal. ``None`` means the default of the robot: see ``robot.budget()``."""

    translation: Limits = Limits()
    """Limits of the norm of the end effector's translation."""

    rotation: Limits = Limits()
    """Limits of the norm of the end effector's rotation."""

    joints: Limits | Sequence[Limits] = Limits()
    """Limits of the joints: one for all, or seven."""

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
        """Returns the budget for the same paths ``factor`` times as fast. It multiplies velocities by ``factor``,
        accelerations by its square and jerks by its cube.
        """
        joints = [self.joints] * 7 if isinstance(self.joints, Limits) else self.joints
        return Budget(
            self.translation._scaled(factor), self.rotation._scaled(factor), [limits._scaled(factor) for limits in joints]
        )


_COMPLIANT: dict[str, Any] = _native._gains("cartesian")


@dataclass(frozen=True, kw_only=True)
class Gains:
    """Control law and gains: a spring and damper at the end effector, along the axes of the base frame, and a spring and
    damper at each joint.

    The default is ``Gains.cartesian()``.
    """

    law: Literal["hybrid", "operational_space"] = _COMPLIANT["law"]
    """Way in which the law turns springs into torques: summed in joint space, or coupled by the inertia at the end effector."""

    cartesian_stiffness: Sequence[float] = _COMPLIANT["cartesian_stiffness"]
    """Stiffness at the end effector, 6 numbers: along x y z, N/m, and about x y z, N m/rad."""

    cartesian_damping: Sequence[float] = _COMPLIANT["cartesian_damping"]
    """Damping at the end effector, 6 numbers: along x y z, N s/m, and about x y z, N m s/rad."""

    joint_stiffness: Sequence[float] = _COMPLIANT["joint_stiffness"]
    """Stiffness of each joint, N m/rad, 7 numbers."""

    joint_damping: Sequence[float] = _COMPLIANT["joint_damping"]
    """Damping of each joint, N m s/rad, 7 numbers."""

    feedforward: float = _COMPLIANT["feedforward"]
    """Weight of the reference velocity in the dampers, 0 to 1. With full weight, the dampers oppose only the velocity error."""

    feedforward_cutoff: float = _COMPLIANT["feedforward_cutoff"]
    """Cutoff frequency of the low-pass on the reference velocity, Hz; 1000 switches it off."""

    project_joint_gains: bool = _COMPLIANT["project_joint_gains"]
    """True if the joint springs act only in directions that do not push at the end effector."""

    compensation: Sequence[float] = _COMPLIANT["compensation"]
    """Largest compensation of friction and bias for each joint, N m, 7 numbers; 0 for no compensation."""

    torque_limits: Sequence[float] = _COMPLIANT["torque_limits"]
    """Largest commanded torque of each joint, N m, 7 numbers."""

    torque_cutoff: float = _COMPLIANT["torque_cutoff"]
    """Cutoff frequency of the low-pass on the torques, Hz; 1000 switches it off."""

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
        """Returns gains that are compliant at the end effector. Light springs at the joints keep the elbow. The default for
        poses.
        """
        return cls()

    @classmethod
    def joint(cls) -> Gains:
        """Returns gains with stiff joints, and without a spring at the end effector. The default for joint positions."""
        return cls(**_native._gains("joint"))

    @classmethod
    def droid(cls) -> Gains:
        """Returns compliant gains as on the DROID platform: a softer wrist and lighter damping, no feedforward, no
        compensation.
        """
        return cls(**_native._gains("droid"))

    def with_cartesian_stiffness(self, stiffness: ArrayLike) -> Gains:
        """Returns the same gains with another stiffness at the end effector, 6 numbers. The damping ratio does not change."""
        return Gains(**_native._softened(self, stiffness))

    def with_joint_stiffness(self, stiffness: ArrayLike) -> Gains:
        """Returns the same gains with another stiffness of the joints, 7 numbers, N m/rad. The damping ratio does not
        change.

        A joint without a spring has the damping ratio of ``Gains.joint()``.
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
    """Margin of gains up to the first oscillation, for an arm with the lag of the slowest realistic arms."""

    damping: float
    """Factor by which all dampers may grow."""

    stiffness: float
    """Factor by which all springs may grow while the dampers do not change."""

    @property
    def is_wanted(self) -> bool:
        """True if both factors are at least 2, which is recommended for gains."""
        return min(self.damping, self.stiffness) >= _native._MARGIN


@dataclass(frozen=True)
class Leash:
    """Largest distance by which the reference (the commanded motion) may be ahead of the arm."""

    translation: float = _native._LEASH[0]
    """Distance of the end effector, m."""

    rotation: float = _native._LEASH[1]
    """Angle of the end effector, rad."""

    joints: float = _native._LEASH[2]
    """Angle of each joint, rad."""


@dataclass(frozen=True)
class Deviation:
    """Largest deviation of the arm from its path. A larger deviation ends the motion. Infinity switches the check off."""

    translation: float = _native._DEVIATION[0]
    """Distance of the end effector, m."""

    rotation: float = _native._DEVIATION[1]
    """Angle of the end effector, rad."""

    joints: float = _native._DEVIATION[2]
    """Angle of each joint, rad."""


@dataclass(frozen=True)
class Tolerance:
    """Distance from the target, measured at the end effector, within which the arm counts as arrived."""

    translation: float = _native._TOLERANCE[0]
    """Distance, m."""

    rotation: float = _native._TOLERANCE[1]
    """Angle, rad."""


@dataclass(frozen=True)
class Settling:
    """Conditions under which an arm counts as settled (at rest) at its target."""

    hold: float = _native._SETTLING[0]
    """Time for which the arm must stay within the tolerance and at rest, s, in whole milliseconds."""

    timeout: float = _native._SETTLING[1]
    """Longest time until the arm settles, s, up to 60."""


@dataclass(frozen=True)
class Lead:
    """Largest distance by which a followed target may be ahead of the arm. A target further away is moved nearer."""

    translation: float
    """Distance, m."""

    rotation: float
    """Angle, rad."""

    joints: float
    """Angle of each joint, rad."""


@dataclass(frozen=True, eq=False)
class Waypoint(Value):
    """A place on a path."""

    target: Target
    """The place: a pose or ``Joints``."""

    blend: float = 0.0
    """Distance from the waypoint at which the path may begin to round the corner: m for poses, rad (norm) for joints. At 0
    the arm stops at the waypoint."""


@dataclass(frozen=True, eq=False)
class Chunk(Value):
    """Points with times, as a policy predicts them from one observation. Give ``dt`` or ``times``.

    ``points`` are positions ``(N, 3)``, at which the orientation does not change; or poses ``(N, 7)``, x y z and a
    quaternion x y z w; or poses ``(N, 4, 4)``. With ``joints=True`` they are joint positions ``(N, 7)``, rad.
    """

    points: ArrayLike
    dt: float | None = None
    """Time between two points, s. The first point is at the origin of time."""

    times: ArrayLike | None = None
    """Time of each point after the origin of time, ``(N,)`` s."""

    velocities: ArrayLike | None = None
    """Twists ``(N, 6)`` or joint velocities ``(N, 7)``. With ``None`` they are estimated from neighbouring points."""

    joints: bool = False
    """True if the points are joint positions."""

    observed_at: Any = None
    """Origin of time: the ``RobotState`` that the policy observed, or its ``time_ms``. With ``None`` it is the time at which
    the driver accepts the chunk."""

    blend: float | None = None
    """Time over which the chunk is blended with the current motion of the arm, s. At 0 the arm turns to it as fast as the
    limits allow. ``None`` is 0.1 s."""


@dataclass(frozen=True, eq=False)
class Plane(Value):
    """A region that the arm avoids: all points ``p`` with ``normal @ p < offset``, in the base frame."""

    normal: ArrayLike
    """Normal that points out of the region; 3 numbers of any length."""

    offset: float
    """Distance of the surface from the origin along the normal, m."""

    @classmethod
    def floor(cls, z: float) -> Plane:
        """Returns the region below the height ``z``, m."""
        return cls((0.0, 0.0, 1.0), z)


@dataclass(frozen=True, eq=False)
class Box(Value):
    """A region that the arm avoids: a box in any orientation, in the base frame."""

    pose: ArrayLike
    """Pose of the centre of the box, ``(4, 4)`` or 7 numbers."""

    sides: ArrayLike
    """Side lengths of the box, 3 numbers, m, along the axes of ``pose``."""


def _set(value: object, **fields: Any) -> None:
    for name, field in fields.items():
        object.__setattr__(value, name, field)
