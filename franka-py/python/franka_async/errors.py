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
    """Anything that can go wrong with a robot or its end effectors."""

    kind: str
    """The cause in snake case: ``superseded``, ``link_lost``, ``refused``. :mod:`franka_async.kinds` lists the kinds of each
    class. They are part of the interface."""

    party: kinds.Party
    """Who can act on it."""

    entry: str | None = None
    """Row of the book's chapter of errors, which states the remedy: ``errors.md#`` and this name. A traceback has it as a
    note."""


class ConnectError(FrankaError):
    """There is no connection."""

    kind: kinds.ConnectErrorKind


class ConnectionLostError(FrankaError):
    """The robot is silent (``link_lost``), or the connection has ended (``connection_closed``): under a motion, a command,
    a read or an action of a gripper."""


class CommandError(FrankaError):
    """A command other than a motion was not carried out."""

    kind: kinds.CommandErrorKind


class CommandConnectionLostError(CommandError, ConnectionLostError):
    """A connection was lost before the answer to a command; the robot may have carried it out."""


class ReadError(FrankaError):
    """States could not be read any further."""

    kind: kinds.ReadErrorKind


class ReadConnectionLostError(ReadError, ConnectionLostError):
    """A connection was lost while states were read."""


class ActionError(FrankaError):
    """An end effector did not carry out an action. The kind is ``aborted`` if a newer action or ``stop()`` ended it."""

    kind: kinds.ActionErrorKind


class ActionConnectionLostError(ActionError, ConnectionLostError):
    """A connection was lost before an end effector had answered; it may have carried out the action."""


class RecordError(FrankaError):
    """A recording is not written, or not to its end. Motions continue."""

    kind: kinds.RecordErrorKind


class RecordingError(FrankaError):
    """A recording, or a part of it, cannot be read."""

    kind: kinds.RecordingErrorKind


class ExportError(FrankaError):
    """Nothing, or not everything, was exported."""

    kind: kinds.ExportErrorKind


class IdentifyError(FrankaError):
    """An arm was not identified."""

    kind: kinds.IdentifyErrorKind


class TareError(FrankaError):
    """No tare was taken: the arm moves, is touched or guided, or is near a singularity."""

    kind: kinds.TareErrorKind


class MotionError(FrankaError):
    """A motion ended short of its goal. An error after a reaction has its usual class and the kind ``after_reaction``."""

    kind: kinds.MotionErrorKind | kinds.ActiveErrorKind | kinds.ControlErrorKind | kinds.ReplayErrorKind

    is_ready_for_more: bool
    """True if the robot takes a new motion without help from outside."""

    code: int | None = None
    """Value below 0 that the control law returned when it gave up; `None` unless the kind is ``given_up``."""


class GoalError(MotionError):
    """A goal or a path was refused. Nothing has moved; a stream that the goal belongs to brakes the arm. The kind is ``goal``
    or ``path``.
    """


class SupersededError(MotionError):
    """A newer goal took the place of this one."""


class StoppedError(MotionError):
    """The motion was stopped: by ``stop()`` or ``cancel()``."""


class GuardError(MotionError):
    """A guard ended the goal. The kind is ``held`` if the arm holds where it is, or ``braked`` if its session has ended."""


class BusyError(MotionError):
    """Something else controls the arm."""


class NotReadyError(MotionError):
    """A supervised robot takes no motions now. The motion has not begun."""


class TargetNotReachedError(MotionError):
    """The arm rests away from its target."""


class MotionConnectionLostError(MotionError, ConnectionLostError):
    """A connection was lost under a motion."""


class ReplayError(MotionError):
    """A recorded motion was not repeated. Unless the kind is ``off`` nothing has moved."""

    kind: kinds.ReplayErrorKind

    is_ready_for_more = True


class TeamError(MotionError):
    """A joint motion ended short of its goal. Its text, ``kind`` and ``party`` are copied from the arm at fault."""

    member: int
    """Number of the arm at fault, in the order of the team."""

    outcomes: list[MotionReport | MotionError]
    """The end of the motion of each arm: a ``MotionReport`` if it arrived."""


class ActiveError(MotionError):
    """Active control could not continue."""

    kind: kinds.ActiveErrorKind


class ControlError(MotionError):
    """The robot ended the motion: a reflex, a user stop, another client's stop."""

    kind: kinds.ControlErrorKind

    errors: list[str]
    """The errors that stopped it, by the vendor's names."""

    move_status: str
    """The robot's last report on the motion: ``reflex_aborted``, ``preempted``, ..."""

    log: ControlLog
    """The last cycles of the motion. A log that was pickled can be read, but not given to ``explain``."""

    diagnosis: str | None
    """The limit that was exceeded, by how much, since when, and what to change; ``None`` if no limit was."""

    findings: dict[str, Any] | None
    """The diagnosis as data, for programs: ``finding``, ``causes``, ``advice`` and more, as lists, ``dict`` and numbers."""

    def to_csv(self) -> str:
        """Returns the log as comma-separated values, a line for each cycle."""
        return self.log.to_csv()
