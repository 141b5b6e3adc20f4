"""Keyword arguments of motions, sessions, recordings and simulated robots."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._native import Condition, Deadman, Reaction, StartTicket
    from .goal import Backend, Box, Budget, Deviation, Gains, Lead, Leash, Plane, Settling, Tolerance
    from .recording import BlackBox
    from .simulation import Network

__all__ = [
    "EngageOptions",
    "FollowOptions",
    "GoalOptions",
    "MotionOptions",
    "RecordOptions",
    "SessionOptions",
    "SimOptions",
    "TeamOptions",
    "TuneOptions",
]


class TuneOptions(TypedDict, total=False):
    """Options that a session keeps, and that can be changed while it runs."""

    limits: Budget | None
    """Limits of the motion; by default ``robot.budget()``."""

    gains: Gains | None
    """Stiffness and damping; the default depends on the kind of the goal."""

    force_cap: float | None
    """Bounds the force with which springs press at the end effector, N, 5 to 200; ``None`` removes the cap. By default 30 N."""

    leash: Leash | None
    """Largest distance of the reference ahead of the arm."""

    deviation: Deviation | None
    """Largest deviation of the arm from its path before the motion is given up."""

    posture: ArrayLike | None
    """Joint positions, 7 numbers, rad, that the arm approaches where the pose of its end effector leaves it free."""


class SessionOptions(TuneOptions, total=False):
    """Options that hold for one goal or for all goals of a session."""

    speed: float | None
    """Speed along the same paths, as a factor of the fastest motion that the limits allow."""


class GoalOptions(SessionOptions, total=False):
    """Shared options of motions and followed targets."""

    stiffness: ArrayLike | None
    """Stiffness at the end effector, x y z N/m and about x y z N m/rad, base axes; dampings keep their ratio."""

    tolerance: Tolerance | None
    """Distance to the target that counts as arrived."""

    settling: Settling | None
    """Conditions under which the arm counts as settled."""

    until: Condition | Reaction | None
    """Continues until this is true, and then stops, or moves to the target that it names."""


class MotionOptions(GoalOptions, total=False):
    """Options of a motion."""

    start_with: StartTicket | None
    """Begins together with the motions that have the other tickets of ``start_tickets``."""

    joint_fallback: bool | None
    """Moves the joints to the pose where the arm cannot follow the straight line of ``move_to``."""


class FollowOptions(GoalOptions, total=False):
    """Options of following targets."""

    lead: Lead | None
    """Largest distance of a target ahead of the arm."""

    watchdog: tuple[float, Literal["brake", "hold"]] | None
    """Seconds without a target after which the watchdog acts, and its action."""


class TeamOptions(SessionOptions, total=False):
    """Options of the session of several robots, for each of them."""

    speed_cap: float | None
    """Largest speed of any joint, the flange and the end effector, m/s."""


class EngageOptions(TeamOptions, total=False):
    """Options of a session."""

    keep_out: Iterable[Plane | Box] | None
    """Regions that the arm keeps out of."""

    deadman: Deadman | None
    """The deadman. While it is silent, and once it is gone, the arm brakes and holds."""

    backend: Backend | None
    """The controller that turns setpoints into torques."""


class RecordOptions(TypedDict, total=False):
    """Options of a recording: see ``Recorder.to_file``."""

    thinned: bool
    flush: float
    sync: bool
    rotate_bytes: int | None
    rotate_time: float | None
    metadata: dict[str, str] | None
    attachments: dict[str, bytes] | None
    black_box: BlackBox | None


class SimOptions(TypedDict, total=False):
    """Options of a simulated robot: see ``Sim.fr3``."""

    virtual_time: bool
    patience: float
    arm: Literal["ideal", "nominal", "realistic", "bad"]
    arm_seed: int | None
    ideal: bool
    limits: Literal["5.9", "before-5.9"]
    state_geometry: Literal["described", "recorded", "random"]
    seed: int
    q: ArrayLike | None
    tool: Literal["hand"] | tuple[ArrayLike, float, ArrayLike] | None
    load: tuple[float, ArrayLike] | tuple[float, ArrayLike, ArrayLike] | None
    hand: bool
    vacuum_gripper: bool
    network: Network | None
    address: str
    enforce_limits: bool
