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
    """Options of a session that can change while the session runs."""

    limits: Budget | None
    """Limits of the motion; the default is ``robot.budget()``."""

    gains: Gains | None
    """Stiffness and damping; the default depends on the kind of the goal."""

    force_cap: float | None
    """Largest force with which the springs press at the end effector, N, 5 to 200; ``None`` removes the limit. The default
    is 30 N."""

    leash: Leash | None
    """Largest distance by which the reference may be ahead of the arm."""

    deviation: Deviation | None
    """Largest deviation of the arm from its path. A larger deviation ends the motion."""

    posture: ArrayLike | None
    """Preferred joint positions, 7 numbers, rad. The arm approaches them to the extent that its end effector allows."""


class SessionOptions(TuneOptions, total=False):
    """Options that apply to one goal, or to all goals of a session."""

    speed: float | None
    """Speed along the same path, as a factor of the fastest motion that the limits allow."""


class GoalOptions(SessionOptions, total=False):
    """Options that motions and followed targets share."""

    stiffness: ArrayLike | None
    """Stiffness at the end effector in base axes: along x y z, N/m, and about x y z, N m/rad. The damping ratio does not
    change."""

    tolerance: Tolerance | None
    """Distance from the target within which the arm counts as arrived."""

    settling: Settling | None
    """Conditions under which the arm counts as settled."""

    until: Condition | Reaction | None
    """Condition on which the motion ends early. The arm then stops, or moves to the target that the condition names."""


class MotionOptions(GoalOptions, total=False):
    """Options of a motion."""

    start_with: StartTicket | None
    """Ticket for a common start. The motions with the tickets of one call of ``start_tickets`` begin together."""

    joint_fallback: bool | None
    """Moves the joints to the pose if the arm cannot follow the straight line of ``move_to``."""


class FollowOptions(GoalOptions, total=False):
    """Options for following targets."""

    lead: Lead | None
    """Largest distance by which a target may be ahead of the arm."""

    watchdog: tuple[float, Literal["brake", "hold"]] | None
    """Watchdog on the targets: the number of seconds without a target after which it acts, and its action."""


class TeamOptions(SessionOptions, total=False):
    """Options of a session of several robots. They apply to each robot."""

    speed_cap: float | None
    """Largest speed of every joint, the flange and the end effector, m/s."""


class EngageOptions(TeamOptions, total=False):
    """Options of a session."""

    keep_out: Iterable[Plane | Box] | None
    """Regions that the arm avoids."""

    deadman: Deadman | None
    """The deadman. While it is not kept alive, and after it has been deleted, the arm brakes and holds its position."""

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
    kinematic_error: Literal["none", "random"]
    seed: int
    q: ArrayLike | None
    tool: Literal["hand"] | tuple[ArrayLike, float, ArrayLike] | None
    load: tuple[float, ArrayLike] | tuple[float, ArrayLike, ArrayLike] | None
    hand: bool
    vacuum_gripper: bool
    network: Network | None
    address: str
    enforce_limits: bool
