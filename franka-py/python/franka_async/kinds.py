"""Kinds of errors: the values that ``error.kind`` of each class of :mod:`franka_async.errors` may have.

Internal changes of the driver do not alter the kinds. The removal of a kind changes the interface, and the change log
mentions it. New kinds may be added.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

__all__ = [
    "ActionErrorKind",
    "ActiveErrorKind",
    "CommandErrorKind",
    "ConnectErrorKind",
    "ControlErrorKind",
    "ExportErrorKind",
    "IdentifyErrorKind",
    "MotionErrorKind",
    "Party",
    "ReadErrorKind",
    "RecordErrorKind",
    "RecordingErrorKind",
    "ReplayErrorKind",
    "TareErrorKind",
]

Party: TypeAlias = Literal["caller", "robot", "link", "host", "peer"]

ActionErrorKind: TypeAlias = Literal[
    "aborted",
    "connection_closed",
    "failure",
    "out_of_range",
    "request",
    "violation",
]

ActiveErrorKind: TypeAlias = Literal[
    "borrow",
    "ended",
    "finished",
    "write",
]

CommandErrorKind: TypeAlias = Literal[
    "connection_closed",
    "invalid_argument",
    "link_lost",
    "not_finite",
    "refused",
    "request",
    "timeout",
    "violation",
]

ConnectErrorKind: TypeAlias = Literal[
    "connection_closed",
    "datagram",
    "endpoint",
    "frame",
    "geometry",
    "handshake_timeout",
    "incompatible_version",
    "known",
    "link_timeout",
    "log_size",
    "model",
    "network",
    "no_address",
    "no_state",
    "realtime",
    "refused",
    "system",
    "timeout",
    "unsupervised",
    "violation",
]

ControlErrorKind: TypeAlias = Literal[
    "aborted",
    "command_not_possible_rejected",
    "command_rejected_due_to_activated_safety_functions",
    "emergency_aborted",
    "input_error_aborted",
    "invalid_argument_rejected",
    "preempted",
    "preempted_due_to_activated_safety_functions",
    "reflex_aborted",
    "start_at_singular_pose_rejected",
]

ExportErrorKind: TypeAlias = Literal[
    "cycles",
    "dataset",
    "episode",
    "exists",
    "io",
    "table",
    "write",
]

IdentifyErrorKind: TypeAlias = Literal[
    "fit",
    "moved",
]

MotionErrorKind: TypeAlias = Literal[
    "after_reaction",
    "braked",
    "busy",
    "connection_closed",
    "disengaged",
    "given_up",
    "goal",
    "held",
    "hung",
    "invalid",
    "link_lost",
    "not_at_rest",
    "not_ready",
    "panicked",
    "path",
    "protocol",
    "rejected",
    "stalled",
    "start",
    "stopped",
    "superseded",
    "target_not_reached",
    "unsupported",
    "violation",
]

ReadErrorKind: TypeAlias = Literal[
    "connection_closed",
    "link_lost",
]

RecordErrorKind: TypeAlias = Literal[
    "attached",
    "black_box",
    "busy",
    "create",
    "encode",
    "ended",
    "exists",
    "same_name",
    "thread",
    "too_many",
    "unfinished",
    "unknown",
    "write",
]

RecordingErrorKind: TypeAlias = Literal[
    "chunk",
    "compression",
    "file",
    "foreign",
    "message",
    "no_robot",
    "not_mcap",
    "read",
]

ReplayErrorKind: TypeAlias = Literal[
    "chunk",
    "fast",
    "gap",
    "kind",
    "not_finite",
    "off",
    "short",
    "target",
    "uncontrolled",
]

TareErrorKind: TypeAlias = Literal[
    "contact",
    "duration",
    "mode",
    "moves",
    "no_estimate",
    "under_way",
]
