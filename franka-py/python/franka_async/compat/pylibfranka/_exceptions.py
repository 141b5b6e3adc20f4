"""Exceptions. As in the original, each derives from ``RuntimeError``, but their common base does not."""

from __future__ import annotations

from ... import errors
from .._translation import text_of, translation


class FrankaException(Exception):
    """Error without a more specific class."""


class CommandException(RuntimeError):
    """The robot or the Hand refused a command."""


class NetworkException(RuntimeError):
    """No connection is possible, or the connection was lost."""


class ControlException(RuntimeError):
    """A motion did not end as requested. ``__cause__`` has the log and the diagnosis."""


class InvalidOperationException(RuntimeError):
    """Something else controls the robot."""


class RealtimeException(RuntimeError):
    """This computer does not allow real-time scheduling."""


PREEMPTED = "libfranka: Move command preempted!"
BUSY = "libfranka robot: Cannot perform this operation while another control or read operation is running."
SILENT = "libfranka: UDP receive: Timeout"

# Texts of errors that an argument causes begin like these.
_ARGUMENT = ("Commanding value is infinite or NaN", "libfranka: Attempt to set invalid", "Invalid ")


def _exception(error: errors.FrankaError) -> Exception:
    text, kind = text_of(error), error.kind
    match error:
        case errors.ConnectError():
            if kind == "realtime":
                return RealtimeException(text)
            return FrankaException(text) if kind == "incompatible_version" else NetworkException(text)
        case errors.CommandError():
            return CommandException(text) if error.party in ("robot", "caller") else NetworkException(text)
        case errors.ActionError():
            return CommandException(text) if kind in ("aborted", "failure", "out_of_range") else NetworkException(text)
        case errors.ControlError():
            # Under active control the original reports no rate.
            return ControlException(PREEMPTED if error.move_status == "preempted" else text.split("\ncontrol_command_success_rate")[0])
        case errors.ActiveError() if kind == "borrow":
            return InvalidOperationException(BUSY)
        case errors.ActiveError() | errors.MotionError() if text.startswith(_ARGUMENT):
            return ValueError(text)
        case errors.ActiveError() if error.party == "link":
            return NetworkException(text)
        case errors.MotionError():
            return _of_motion(kind, text)
        case errors.ReadError():
            return NetworkException(text)
    return NetworkException(text) if kind == "not_connected" else FrankaException(text)


def _of_motion(kind: str, text: str) -> Exception:
    match kind:
        case "busy":
            return InvalidOperationException(text)
        case "rejected" | "unsupported":
            return CommandException(text)
        case "invalid":
            return ValueError(text)
        case "stopped" | "superseded" | "braked":
            return ControlException(PREEMPTED)
        case "link_lost" | "connection_closed":
            return NetworkException(text)
    return ControlException(text)


translated = translation(_exception)
"""A context that raises the exceptions of the original package instead of the exceptions of this package."""
