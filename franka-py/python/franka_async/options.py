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
    """What a session keeps, and can be changed while it runs."""

    limits: Budget | None
    """How fast; by default ``robot.budget()``."""

    gains: Gains | None
    """How stiff; by default as the kind of the goal wants it."""

    force_cap: float | None
    """Bounds the force with which springs press at the end effector, N, 5 to 200; ``None`` removes the cap. By default 30 N."""

    leash: Leash | None
    """How far the reference may be ahead of the arm."""

    deviation: Deviation | None
    """How far the arm may be pushed off its way before the motion is given up."""

    posture: ArrayLike | None
    """Joint positions, 7 numbers, rad, that the arm takes as far as the pose of its end effector leaves it free."""


class SessionOptions(TuneOptions, total=False):
    """What holds for one goal or for all goals of a session."""

    speed: float | None
    """Walks the same paths so many times as fast as the limits allow."""


class GoalOptions(SessionOptions, total=False):
    """What motions and followed targets have in common."""

    stiffness: ArrayLike | None
    """Stiffness at the end effector, x y z N/m and about x y z N m/rad, base axes; dampings keep their ratio."""

    tolerance: Tolerance | None
    """How near counts as arrived."""

    settling: Settling | None
    """How the arm has to settle."""

    until: Condition | Reaction | None
    """Goes on until this is true, and then stops, or goes where it says."""


class MotionOptions(GoalOptions, total=False):
    """Options of a motion."""

    start_with: StartTicket | None
    """Begins together with the motions that have the other tickets of ``start_tickets``."""

    joint_fallback: bool | None
    """Moves the joints to the pose where the arm cannot follow the straight line of ``move_to``."""


class FollowOptions(GoalOptions, total=False):
    """Options of following targets."""

    lead: Lead | None
    """How far ahead of the arm a target may be."""

    watchdog: tuple[float, Literal["brake", "hold"]] | None
    """What happens when no target has come for so many seconds."""


class TeamOptions(SessionOptions, total=False):
    """Options of the session of several robots, for each of them."""

    speed_cap: float | None
    """The most of any joint, the flange and the end effector, in m/s."""


class EngageOptions(TeamOptions, total=False):
    """Options of a session."""

    keep_out: Iterable[Plane | Box] | None
    """Regions that the arm keeps out of."""

    deadman: Deadman | None
    """While it is silent, and once it is gone, the arm brakes and holds."""

    backend: Backend | None
    """What turns setpoints into torques."""


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
