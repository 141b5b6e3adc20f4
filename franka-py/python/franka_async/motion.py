"""What motions report: how they ended, how far they are, where the arm is to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from .value import Value

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["CycleTimes", "Guard", "MotionReport", "Phases", "PoseError", "Progress", "Quantiles", "Reacted", "Reference"]


@dataclass(frozen=True)
class PoseError:
    """Distance of the measured end effector from its target."""

    translation: float
    """m."""

    rotation: float
    """rad."""


@dataclass(frozen=True, eq=False)
class Reacted(Value):
    """What a motion saw when the condition became true that it was to go on until."""

    after: float
    """Time since the first state of the motion, s, by the robot's clock."""

    time_ms: int
    """The robot's clock then, ms."""

    wrench: NDArray[np.float64]
    """External wrench then, in base axes with its torque about the origin of the stiffness frame, ``(6,)`` N and N m: positive is what the arm exerts."""

    pose: NDArray[np.float64]
    """Pose of the end effector then, base frame, ``(4, 4)``."""


@dataclass(frozen=True)
class Quantiles:
    """Three numbers of a distribution of times, s."""

    p50: float
    """The median, to 1/16."""

    p99: float
    """The 99th percentile, to 1/16."""

    max: float
    """The longest one."""


@dataclass(frozen=True)
class Phases:
    """Where the time of one cycle went, s."""

    orders: float
    """Orders from outside the control thread."""

    decode: float
    """The state, read from its bytes."""

    program: float
    """Law and guards, a compiled law, or under active control what the program did until it wrote."""

    send: float
    """The command, written into bytes and sent."""

    publish: float
    """What follows the command: log, newest state, records, events."""

    prepare: float
    """What the next answer does not need the next state for: goals, plans, the generator."""


@dataclass(frozen=True)
class CycleTimes:
    """The times of one cycle of control, s."""

    time_ms: int
    """The robot's clock, ms."""

    late: float
    """From when the state was due to when the control thread had it."""

    turnaround: float
    """From then to the departure of the command."""

    slack: float
    """What was left until the next state was due; negative if the command left later."""

    phases: Phases | None
    """Where the time went."""


@dataclass(frozen=True, eq=False)
class MotionReport(Value):
    """How a motion went that did what it was to do. Times are in seconds."""

    duration: float
    """From the first state of the motion to the arrival, by the robot's clock. The time for which the arm then has to rest there, 0.25 s
    unless ``settling`` says otherwise, is not in it; what is counted below includes it."""

    final_error: PoseError | None
    """Distance of the measured end effector from its target; ``None`` for a motion without one."""

    released_error: PoseError | None
    """The same once the arm had been let go; ``None`` without a target, and where the arm is held on."""

    compensation: NDArray[np.float64] | None
    """What friction and bias of each joint were compensated by at the arrival, ``(7,)`` N m; ``None`` without this package's law."""

    reacted: Reacted | None
    """What was seen when the condition ``until`` became true; ``None`` if the motion arrived without."""

    lost_states: int
    """States that never arrived."""

    skipped_states: int
    """States that arrived, but after a newer one."""

    success_rate_min: float
    """The lowest success rate of commands that the robot reported, 0 to 1."""

    success_rate_avg: float
    """The mean of it."""

    worst_turnaround: float
    """The longest time from the receipt of a state to the departure of its command."""

    slack_min: float | None
    """The least time that was left until the next state was due; as below, ``None`` if no command left."""

    overruns: int
    """Commands that left only after the next state was due."""

    worst_cycle: CycleTimes | None
    """The cycle that took longest."""

    interval: Quantiles | None
    """Times between two states in a row, by the clock of this computer."""

    turnaround: Quantiles | None
    """Times from the receipt of a state to the departure of its command."""

    def __str__(self) -> str:
        """One line for people; ``repr`` has all."""
        how = "arrived" if self.reacted is None else "reacted"
        off = self.final_error
        where = "" if off is None else f", {1e3 * off.translation:.1f} mm and {1e3 * off.rotation:.1f} mrad from the target"
        return f"{how} after {self.duration:.2f} s{where}; {self.lost_states} states lost"


@dataclass(frozen=True)
class Progress:
    """How far a motion has come."""

    elapsed: float
    """Since it began, s, by the robot's clock."""

    remaining: float
    """Until the reference is at the target, s, if nothing holds it up; the arm settles after that."""

    @property
    def fraction(self) -> float:
        """The share of its time that has passed, 0 to 1."""
        whole = self.elapsed + self.remaining
        return self.elapsed / whole if whole > 0.0 else 1.0


Guard = Literal[
    "leash",
    "inverse_kinematics",
    "torque_clamp",
    "force_cap",
    "velocity_barrier",
    "torque_rate",
    "watchdog",
    "deadman",
    "backstop",
    "joint_velocity",
    "position_envelope",
    "clearance",
    "deviation",
    "lead",
    "plan_failure",
    "reaction",
    "team",
    "speed_cap",
    "unresponsive",
]
"""What may hold an arm back: see guards.md of the book."""


@dataclass(frozen=True, eq=False)
class Reference(Value):
    """Where target control has the arm go in a cycle."""

    time_ms: int
    """The robot's clock, ms."""

    q: NDArray[np.float64]
    """Joint positions, ``(7,)`` rad."""

    dq: NDArray[np.float64]
    """Joint velocities, ``(7,)`` rad/s."""

    ddq: NDArray[np.float64]
    """Joint accelerations, ``(7,)`` rad/s^2."""

    pose: NDArray[np.float64]
    """The end effector at those positions, base frame, ``(4, 4)``."""

    guards: tuple[Guard, ...] = ()
    """Which guards have held the arm back within the last 0.1 s, and at most 0.2 s."""
