"""Reports of motions: how they ended, their progress, and the reference (the commanded motion) of the arm."""

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
    """Distance, m."""

    rotation: float
    """Angle, rad."""


@dataclass(frozen=True, eq=False)
class Reacted(Value):
    """State of a motion at the moment at which the condition ``until`` became true."""

    after: float
    """Time since the first state of the motion, s, by the robot's clock."""

    time_ms: int
    """The robot's clock at that moment, ms."""

    wrench: NDArray[np.float64]
    """External wrench at that moment, ``(6,)`` N and N m, in base axes, with the torque about the origin of the stiffness
    frame. It is positive when the arm pushes its environment."""

    pose: NDArray[np.float64]
    """Pose of the end effector at that moment, in the base frame, ``(4, 4)``."""


@dataclass(frozen=True)
class Quantiles:
    """Three values of a distribution of times, s."""

    p50: float
    """Median, with a resolution of 1/16."""

    p99: float
    """99th percentile, with a resolution of 1/16."""

    max: float
    """Longest time."""


@dataclass(frozen=True)
class Phases:
    """Durations of the parts of one cycle, s."""

    orders: float
    """Time for orders from outside the control thread."""

    decode: float
    """Time to decode the state."""

    program: float
    """Time for control law and guards, or for a compiled law. Under active control, time until the program wrote its
    command."""

    send: float
    """Time to encode and send the command."""

    publish: float
    """Time for everything after the command: log, newest state, records, events."""

    prepare: float
    """Time for the preparation of the next answer that is possible without the next state: goals, plans, the generator."""


@dataclass(frozen=True)
class CycleTimes:
    """Times of one control cycle, s."""

    time_ms: int
    """The robot's clock, ms."""

    late: float
    """Time from the due time of the state to its receipt by the control thread."""

    turnaround: float
    """Time from the receipt of the state to the departure of its command."""

    slack: float
    """Time left until the next state was due; negative if the command left later."""

    phases: Phases | None
    """Durations of the parts of the cycle."""


@dataclass(frozen=True, eq=False)
class MotionReport(Value):
    """Report of a motion that reached its goal. Times are in seconds."""

    duration: float
    """Time from the first state of the motion to the arrival, by the robot's clock. It excludes the time for which the arm
    must then stay at rest, 0.25 s unless ``settling`` states another time. The counts below include this time."""

    final_error: PoseError | None
    """Distance of the measured end effector from its target; ``None`` for a motion without a target."""

    released_error: PoseError | None
    """The same distance after the arm was released; ``None`` without a target, and if the arm is still held."""

    line_deviation: float | None
    """Greatest distance of the measured end effector from the straight line to its target, m; ``None`` for a motion without a
    line. Motions to joint positions, through waypoints and by a control function have no line, nor has a motion after its
    reaction."""

    compensation: NDArray[np.float64] | None
    """Compensation of friction and bias for each joint at the arrival, ``(7,)`` N m; ``None`` if another law computed the
    torques."""

    reacted: Reacted | None
    """State at the moment at which the condition ``until`` became true; ``None`` if the motion arrived without this."""

    lost_states: int
    """Number of states that never arrived."""

    skipped_states: int
    """Number of states that arrived after a newer state."""

    success_rate_min: float
    """Lowest success rate of commands that the robot reported, 0 to 1."""

    success_rate_avg: float
    """Mean of the success rate, 0 to 1."""

    worst_turnaround: float
    """Longest time from the receipt of a state to the departure of its command."""

    slack_min: float | None
    """Shortest time between the departure of a command and the due time of the next state; ``None`` if no command left, as
    for the fields below."""

    overruns: int
    """Number of commands that left after the next state was due."""

    worst_cycle: CycleTimes | None
    """The cycle that took longest."""

    interval: Quantiles | None
    """Times between two consecutive states, by the clock of this computer."""

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
    """Time since the motion began, s, by the robot's clock."""

    remaining: float
    """Time until the reference reaches the target if nothing delays it, s. The arm settles afterwards."""

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
"""Guards (checks of the driver) that may hold an arm back: see guards.md of the book."""


@dataclass(frozen=True, eq=False)
class Reference(Value):
    """The reference (the commanded motion) of target control in one cycle."""

    time_ms: int
    """The robot's clock, ms."""

    q: NDArray[np.float64]
    """Joint positions, ``(7,)`` rad."""

    dq: NDArray[np.float64]
    """Joint velocities, ``(7,)`` rad/s."""

    ddq: NDArray[np.float64]
    """Joint accelerations, ``(7,)`` rad/s^2."""

    pose: NDArray[np.float64]
    """Pose of the end effector at these positions, in the base frame, ``(4, 4)``."""

    guards: tuple[Guard, ...] = ()
    """Guards that have held the arm back recently: within the last 0.1 to 0.2 s."""
