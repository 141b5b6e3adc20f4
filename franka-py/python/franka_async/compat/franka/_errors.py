"""Exceptions with the kinds of the original."""

from __future__ import annotations

from collections.abc import Sequence

from ... import errors
from .._translation import text_of, translation


class FrankaError(Exception):
    """Error of a robot or the Hand."""

    def __init__(self, *text: object, kind: str = "invalid_operation") -> None:
        super().__init__(*text)
        self.kind = kind
        """One of network, protocol, incompatible_version, command, control, realtime, invalid_operation, invalid_argument
        and model."""


class ControlException(FrankaError):
    """The robot ended a motion. ``__cause__`` has the log and the diagnosis."""

    def __init__(self, *text: object, reasons: Sequence[str] = (), move_status: str | None = None) -> None:
        super().__init__(*text, kind="control")
        self.errors = list(reasons)
        self.reason = "[" + ", ".join(f'"{reason}"' for reason in reasons) + "]"
        self.move_status = move_status


PREEMPTED = "libfranka: Move command preempted!"


def _exception(error: errors.FrankaError) -> FrankaError:
    text, kind = text_of(error), error.kind
    match error:
        case errors.ControlError():
            preempted = error.move_status == "preempted"
            status = "".join(word.capitalize() for word in error.move_status.split("_"))
            return ControlException(PREEMPTED if preempted else text, reasons=error.errors, move_status=status)
        case errors.MotionError() if kind in ("stopped", "superseded", "disengaged"):
            return ControlException(PREEMPTED, move_status="Preempted")
        case errors.MotionError():
            return FrankaError(text, kind=_OF_MOTION.get(kind, "control"))
        case errors.ConnectError() if kind in ("realtime", "incompatible_version", "model"):
            return FrankaError(text, kind=kind)
        case errors.CommandError() if error.party in ("robot", "caller"):
            return FrankaError(text, kind="command")
        case errors.ActionError() if kind in ("aborted", "failure", "out_of_range"):
            return FrankaError(text, kind="command")
    if error.party == "peer":
        return FrankaError(text, kind="protocol")
    return FrankaError(text, kind="network")


_OF_MOTION = {
    "busy": "invalid_operation",
    "goal": "invalid_argument",
    "path": "invalid_argument",
    "invalid": "invalid_argument",
    "rejected": "command",
    "unsupported": "command",
    "link_lost": "network",
    "connection_closed": "network",
    "violation": "protocol",
    "protocol": "protocol",
}


translated = translation(_exception)
"""A context that raises the exceptions of the original package instead of the exceptions of this package."""
