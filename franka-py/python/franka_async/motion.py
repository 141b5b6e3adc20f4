"""Reports of motions: how they ended, their progress, and the reference of the arm."""

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
    """State of a motion at the moment when the condition of ``until`` became true."""

    after: float
    """Time since the first state of the motion, s, by the robot's clock."""

    time_ms: int
    """The robot's clock at that moment, ms."""

    wrench: NDArray[np.float64]
    """External wrench at that moment, ``(6,)`` N and N m, in base axes with its torque about the origin of the stiffness
    frame. Positive values are exerted by the arm."""

    pose: NDArray[np.float64]
    """Pose of the end effector at that moment, base frame, ``(4, 4)``."""


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
    """Durations of the parts of one cycle, s."""

    orders: float
    """Orders from outside the control thread."""

    decode: float
    """The state, read from its bytes."""

    program: float
    """Law and guards, a compiled law, or, under active control, the work of the program until it wrote."""

    send: float
    """The command, written into bytes and sent."""

    publish: float
    """Time for everything after the command: log, newest state, records, events."""

    prepare: float
    """Time for the preparation of the next answer that needs no next state: goals, plans, the generator."""


@dataclass(frozen=True)
class CycleTimes:
    """The times of one cycle of control, s."""

    time_ms: int
    """The robot's clock, ms."""

    late: float
    """Time from the due time of the state to its receipt by the control thread."""

    turnaround: float
    """Time from the receipt to the departure of the command."""

    slack: float
    """Time left until the next state was due; negative if the command left later."""

    phases: Phases | None
    """Durations of the parts of the cycle."""


@dataclass(frozen=True, eq=False)
class MotionReport(Value):
    """Report of a motion that reached its goal. Times are in seconds."""

    duration: float
    """Time from the first state of the motion to the arrival, by the robot's clock. It excludes the time for which the arm
    then has to rest there, 0.25 s unless ``settling`` states another one; the counts below include it."""

    final_error: PoseError | None
    """Distance of the measured end effector from its target; ``None`` for a motion without one."""

    released_error: PoseError | None
    """The same distance after the arm was released; ``None`` without a target, and if the arm is still held."""

    compensation: NDArray[np.float64] | None
    """Compensation of friction and bias of each joint at the arrival, ``(7,)`` N m; ``None`` without this package's law."""

    reacted: Reacted | None
    """State at which the condition ``until`` became true; ``None`` if the motion arrived without."""

    lost_states: int
    """States that never arrived."""

    skipped_states: int
    """States that arrived, but after a newer one."""

    success_rate_min: float
    """The lowest success rate of commands that the robot reported, 0 to 1."""

    success_rate_avg: float
    """The mean of that rate."""

    worst_turnaround: float
    """The longest time from the receipt of a state to the departure of its command."""

    slack_min: float | None
    """The shortest time that was left until the next state was due; as below, ``None`` if no command left."""

    overruns: int
    """Commands that left only after the next state was due."""

    worst_cycle: CycleTimes | None
    """The cycle that took longest."""

    interval: Quantiles | None
    """Times between two states in a row, by the clock of this computer."""

    turnaround: Quantiles | None
    """Times from the receipt of a state to the departure of its command."""

    def __str__(self) -> str:
        """Returns one line for people; ``repr`` has all fields."""
        how = "arrived" if self.reacted is None else "reacted"
        off = self.final_error
        where = "" if off is None else f", {1e3 * off.translation:.1f} mm and {1e3 * off.rotation:.1f} mrad from the target"
        return f"{how} after {self.duration:.2f} s{where}; {self.lost_states} states lost"


@dataclass(frozen=True)
class Progress:
    """Progress of a motion."""

    elapsed: float
    """Since it began, s, by the robot's clock."""

    remaining: float
    """Time until the reference is at the target, s, if nothing delays it; the arm settles after that."""

    @property
    def fraction(self) -> float:
        """Share of the time that has passed, 0 to 1."""
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
"""Guards that may hold an arm back: see guards.md of the book."""


@dataclass(frozen=True, eq=False)
class Reference(Value):
    """The reference of target control in a cycle."""

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
    """Guards that have held the arm back within the last 0.1 s, and at most 0.2 s."""
