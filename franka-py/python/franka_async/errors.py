"""Errors, grouped by who can act on them.

Every exception of the package is a :class:`FrankaError`. Mistakes in arguments are ``ValueError`` or ``TypeError``, as everywhere
in Python.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import kinds
    from ._native import ControlLog
    from .motion import MotionReport

__all__ = [
    "ActionConnectionLostError",
    "ActionError",
    "ActiveError",
    "BusyError",
    "CommandConnectionLostError",
    "CommandError",
    "ConnectError",
    "ConnectionLostError",
    "ControlError",
    "ExportError",
    "FrankaError",
    "GoalError",
    "GuardError",
    "IdentifyError",
    "MotionConnectionLostError",
    "MotionError",
    "NotReadyError",
    "ReadConnectionLostError",
    "ReadError",
    "RecordError",
    "RecordingError",
    "ReplayError",
    "StoppedError",
    "SupersededError",
    "TareError",
    "TargetNotReachedError",
    "TeamError",
]


class FrankaError(Exception):
    """Base of all errors of a robot and its end effectors."""

    kind: str
    """The cause in snake case: ``superseded``, ``link_lost``, ``refused``. :mod:`franka_async.kinds` lists the kinds of each
    class. The kinds are part of the interface."""

    party: kinds.Party
    """Who can act on the error."""

    entry: str | None = None
    """Name of the error's row in the book's chapter of errors, ``errors.md#`` and this name. The row states the remedy. A
    traceback shows it as a note."""


class ConnectError(FrankaError):
    """No connection could be made."""

    kind: kinds.ConnectErrorKind


class ConnectionLostError(FrankaError):
    """No more states arrive (``link_lost``), or the connection has ended (``connection_closed``), during a motion, a
    command, a read or an action of a gripper.
    """


class CommandError(FrankaError):
    """A command other than a motion was not carried out."""

    kind: kinds.CommandErrorKind


class CommandConnectionLostError(CommandError, ConnectionLostError):
    """The connection was lost before the answer to a command arrived. The robot may have carried out the command."""


class ReadError(FrankaError):
    """States could not be read any further."""

    kind: kinds.ReadErrorKind


class ReadConnectionLostError(ReadError, ConnectionLostError):
    """The connection was lost while the program read states."""


class ActionError(FrankaError):
    """An end effector did not carry out an action. The kind is ``aborted`` if a newer action or ``stop()`` ended it."""

    kind: kinds.ActionErrorKind


class ActionConnectionLostError(ActionError, ConnectionLostError):
    """The connection was lost before an end effector answered. It may have carried out the action."""


class RecordError(FrankaError):
    """A recording could not be written, or not completely. Motions continue."""

    kind: kinds.RecordErrorKind


class RecordingError(FrankaError):
    """A recording, or a part of it, cannot be read."""

    kind: kinds.RecordingErrorKind


class ExportError(FrankaError):
    """An export failed or is incomplete."""

    kind: kinds.ExportErrorKind


class IdentifyError(FrankaError):
    """The load and friction of an arm could not be identified."""

    kind: kinds.IdentifyErrorKind


class TareError(FrankaError):
    """No tare (zero of the wrench) was taken, because the arm moves, is touched or guided, or is near a singularity."""

    kind: kinds.TareErrorKind


class MotionError(FrankaError):
    """A motion ended before its goal. An error after a reaction has its usual class and the kind ``after_reaction``."""

    kind: kinds.MotionErrorKind | kinds.ActiveErrorKind | kinds.ControlErrorKind | kinds.ReplayErrorKind

    is_ready_for_more: bool
    """True if the robot accepts a new motion without action by a person."""

    code: int | None = None
    """Negative value that the control law returned when it gave up; `None` unless the kind is ``given_up``."""


class GoalError(MotionError):
    """The driver refused a goal or a path. Nothing has moved. If the goal belongs to a stream, the stream brakes the arm.
    The kind is ``goal`` or ``path``.
    """


class SupersededError(MotionError):
    """A newer goal replaced this goal."""


class StoppedError(MotionError):
    """The motion was stopped by ``stop()`` or ``cancel()``."""


class GuardError(MotionError):
    """A guard (a safety check of the driver) ended the goal. The kind is ``held`` if the arm holds its position, or
    ``braked`` if the session has ended.
    """


class BusyError(MotionError):
    """Something else controls the arm."""


class NotReadyError(MotionError):
    """A supervised robot accepts no motions now. The motion has not begun."""


class TargetNotReachedError(MotionError):
    """The arm is at rest, but not at its target."""


class MotionConnectionLostError(MotionError, ConnectionLostError):
    """The connection was lost during a motion."""


class ReplayError(MotionError):
    """A recorded motion was not repeated. Nothing has moved, unless the kind is ``off``."""

    kind: kinds.ReplayErrorKind

    is_ready_for_more = True


class TeamError(MotionError):
    """A common motion of several arms ended before its goal. The text, ``kind`` and ``party`` come from the arm that
    caused the end.
    """

    member: int
    """Number of the arm that caused the end, in the order of the team."""

    outcomes: list[MotionReport | MotionError]
    """End of the motion of each arm: a ``MotionReport`` if the arm arrived."""


class ActiveError(MotionError):
    """Active control could not continue."""

    kind: kinds.ActiveErrorKind


class ControlError(MotionError):
    """The robot ended the motion, because of a reflex, a user stop, or a stop by another client."""

    kind: kinds.ControlErrorKind

    errors: list[str]
    """Errors that stopped the robot, by the vendor's names."""

    move_status: str
    """The robot's last report on the motion: ``reflex_aborted``, ``preempted``, ..."""

    log: ControlLog
    """The last cycles of the motion. A log that was pickled can be read, but ``explain`` does not accept it."""

    diagnosis: str | None
    """The exceeded limit, the excess, its first cycle, and what to change; ``None`` if no limit was exceeded."""

    findings: dict[str, Any] | None
    """The diagnosis as data, for programs: ``finding``, ``causes``, ``advice`` and more, as lists, ``dict`` and numbers."""

    def to_csv(self) -> str:
        """Returns the log as comma-separated values, with a line for each cycle."""
        return self.log.to_csv()
