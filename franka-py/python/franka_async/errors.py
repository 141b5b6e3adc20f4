"""What can go wrong, by who can act on it.

Every exception of the package is a :class:`FrankaError`. Mistakes in arguments are ``ValueError`` or ``TypeError``, as everywhere
in Python.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._native import ControlLog
    from .motion import MotionReport

__all__ = [
    "ActionError",
    "ActiveError",
    "CommandError",
    "ConnectError",
    "ControlError",
    "ExportError",
    "FrankaError",
    "IdentifyError",
    "MotionError",
    "ReadError",
    "RecordError",
    "RecordingError",
    "ReplayError",
    "TareError",
    "TeamError",
]


class FrankaError(Exception):
    """Anything that can go wrong with a robot or its end effectors."""

    kind: str
    """What went wrong, as one word or more in snake case: ``superseded``, ``link_lost``, ``refused``."""

    party: str
    """Who can act on it: ``caller``, ``robot``, ``link``, ``host`` or ``peer``."""

    entry: str | None = None
    """Row of the book's chapter of errors, which says what to do: ``errors.md#`` and this name. A traceback has it as a note."""


class ConnectError(FrankaError):
    """There is no connection."""


class CommandError(FrankaError):
    """A command other than a motion was not carried out."""


class ReadError(FrankaError):
    """States could not be read any further."""


class ActionError(FrankaError):
    """An end effector did not do it. The kind is ``aborted`` if a newer action or ``stop()`` ended it."""


class RecordError(FrankaError):
    """A recording is not written, or not to its end. Motions go on."""


class RecordingError(FrankaError):
    """A recording, or a part of it, cannot be read."""


class ExportError(FrankaError):
    """Nothing, or not everything, was exported."""


class IdentifyError(FrankaError):
    """An arm was not identified."""


class TareError(FrankaError):
    """No tare was taken: the arm moves, is touched or guided, or is near a singularity."""


class MotionError(FrankaError):
    """A motion ended short of its goal."""

    is_ready_for_more: bool
    """Whether the robot takes a new motion without help from outside."""

    code: int | None = None
    """What a control law returned that gave up, below 0; `None` unless the kind is ``given_up``."""


class ReplayError(MotionError):
    """A recorded motion was not made again. Unless the kind is ``off`` nothing has moved."""

    is_ready_for_more = True


class TeamError(MotionError):
    """A joint motion ended short of its goal. Its text, ``kind`` and ``party`` are those of the arm at fault."""

    member: int
    """Number of the arm at fault, in the order of the team."""

    outcomes: list[MotionReport | MotionError]
    """How the motion of each arm ended: a ``MotionReport`` if it arrived."""


class ActiveError(MotionError):
    """Active control could not go on."""


class ControlError(MotionError):
    """The robot ended the motion: a reflex, a user stop, another client's stop."""

    errors: list[str]
    """The errors that stopped it, by the vendor's names."""

    move_status: str
    """The robot's last word on the motion: ``reflex_aborted``, ``preempted``, ..."""

    log: ControlLog
    """The last cycles of the motion. One that was pickled can be read, but not given to ``explain``."""

    diagnosis: str | None
    """Which limit was exceeded, by how much, since when, and what to change; ``None`` if no limit was."""

    findings: dict[str, Any] | None
    """The diagnosis as data, for programs: ``finding``, ``causes``, ``advice`` and more, as lists, ``dict`` and numbers."""

    def to_csv(self) -> str:
        """Returns the log as comma-separated values, a line for each cycle."""
        return self.log.to_csv()
