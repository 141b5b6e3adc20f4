"""Supervised robots: policies of the supervisor, events, and the condition of a robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from . import _native

__all__ = ["Backoff", "CloseReason", "Condition", "Event", "EventKind", "Health", "Policy", "Reflex"]

Condition = Literal[
    "ready",
    "disconnected",
    "silent",
    "recovering",
    "agreement_awaited",
    "unrecognised",
    "configuring",
    "not_configured",
    "reflex",
    "user_stopped",
    "guided",
    "braked",
    "stop_latched",
    "closed",
]

EventKind = Literal[
    "connected",
    "realtime_refused",
    "unrecognised",
    "not_configured",
    "lost",
    "silent",
    "resumed",
    "reflex",
    "not_recovered",
    "recovered",
    "user_stop",
    "guiding",
    "brakes",
    "stop_latch",
    "motion_begun",
    "motion_ended",
    "load_changed",
    "closed",
]


@dataclass(frozen=True)
class Backoff:
    """Pauses between attempts: ``first`` seconds after the first attempt, and after each further attempt twice as long as
    before.

    The first attempt is made immediately.
    """

    first: float = 0.1
    """First pause, s."""

    most: float = 5.0
    """Longest pause, s."""

    jitter: float = 0.3
    """Random share of each pause, 0 to 1. A pause is shorter by up to this share."""


@dataclass(frozen=True, kw_only=True)
class Policy:
    """Reaction of a robot's supervisor when the connection or the robot fails.

    The default reconnects for as long as necessary, never recovers from a reflex, and refuses motions meanwhile. No policy
    resumes a motion: motions and sessions end with the failure.

    Raises ``ValueError`` for values that make no sense.
    """

    recover: tuple[int, float] | None = None
    """Limit of automatic recoveries from reflexes: the number allowed within a window, and this window in seconds. Failed
    attempts count."""

    only: Iterable[str] | None = None
    """Permits recovery only from reflexes whose errors are all in this list, by the vendor's names. Needs ``recover``."""

    ask_first: bool = False
    """Recovers only after a person has agreed, by ``robot.agree(reflex)`` or in a function ``ask_before_recovery``."""

    reconnect: Backoff | None = field(default_factory=Backoff)
    """Pauses between two attempts to connect, and between two attempts to recover. With ``None`` the supervisor does not
    reconnect."""

    give_up_after: float | None = None
    """Seconds after which the supervisor gives up a lost connection; ``None`` means never."""

    silence: float = 3.0
    """Seconds without a state on an open connection after which the supervisor closes the connection and makes a new one."""

    motions_wait: float | None = None
    """Seconds for which a motion waits while the supervisor reconnects or recovers. With ``None`` the motion is refused."""

    seed: int | None = None
    """Seed of the random part of pauses. With ``None`` each robot draws its own seed."""

    def __post_init__(self) -> None:
        if self.only is not None:
            names = [self.only] if isinstance(self.only, str) else self.only
            object.__setattr__(self, "only", tuple(names))
        _native._check_policy(self)


@dataclass(frozen=True)
class Reflex:
    """A reflex: the robot stopped itself."""

    number: int
    """Number of the reflex, counted from 1, as ``robot.agree(number)`` expects it."""

    errors: list[str]
    """The errors that hold the robot, by the vendor's names."""

    error: Exception | None
    """The ``ControlError`` of the motion that ran, with log and diagnosis; ``None`` if no motion of this program ran."""

    differences: str | None = None
    """Differences from the robot before the connection was lost, if the robot is not recognised. A person must then agree."""


@dataclass(frozen=True)
class CloseReason:
    """The reason for the end of a connection."""

    kind: str
    """``closed_by_us``, ``closed_by_peer``, ``io``, ``protocol``, ``thread_ended``, ``silent``, ``given_up``, ``another_robot``
    or ``runtime_ended``."""

    text: str
    """The reason as text."""

    party: str
    """Who can act on the reason: ``caller``, ``robot``, ``link``, ``host`` or ``peer``."""


@dataclass(frozen=True)
class Event:
    """Something that happened to a robot. Each kind has its own fields, which are attributes as well:

    * ``connected``: ``attempts``; ``after``, seconds since the loss, ``None`` for the first connection.
    * ``realtime_refused``: ``refusals``, the rights that the operating system refused the control thread, as texts.
    * ``unrecognised``: ``differences`` from the robot before the connection was lost, as a text.
    * ``not_configured``: ``command`` that is not set again, and the reason as ``text``.
    * ``lost``: ``reason``, a ``CloseReason``.
    * ``silent``: ``silence``, seconds without a state, on a connection that still stands.
    * ``resumed``: ``after``, seconds since the silence was noticed.
    * ``reflex``: ``reflex``, a ``Reflex``.
    * ``not_recovered``: ``number`` of the reflex; ``why``: ``never``, ``other_error``, ``too_often``, ``declined``, ``by_hand``.
    * ``recovered``: ``number`` of the reflex; ``after``, seconds since it was noticed; ``by_supervisor``.
    * ``user_stop``: ``pressed``.
    * ``guiding``: ``active``.
    * ``brakes``: ``closed``.
    * ``stop_latch``: ``latched``.
    * ``motion_begun``: ``goal``, its name, as in the log.
    * ``motion_ended``: ``goal``; ``error``, the reason, ``None`` if it arrived.
    * ``load_changed``: ``mass``, kg; ``center`` in the flange frame, ``(3,)`` m; ``inertia`` about it, ``(3, 3)`` kg m^2.
    * ``closed``: ``reason``, a ``CloseReason``. No other event follows.
    """

    kind: EventKind
    """The kind of event."""

    at: float
    """Time by this computer's clock: seconds since the robot was first connected to."""

    robot_time: float | None
    """Time by the robot's clock, s; ``None`` without a connection."""

    lost: int
    """Number of events missing before this event, because the listener was too slow. It may be up to 256 events behind."""

    fields: Mapping[str, Any]
    """The fields of this kind."""

    text: str
    """One line for people."""

    def __str__(self) -> str:
        return self.text

    def __getattr__(self, name: str) -> Any:
        # Called only for names that are not attributes. `fields` itself is missing while an event is unpickled.
        fields = self.__dict__.get("fields", {})
        if name in fields:
            return fields[name]
        kind = self.__dict__.get("kind")
        raise AttributeError(f"an event of the kind {kind!r} has no {name!r}, but {sorted(fields)}")


@dataclass(frozen=True)
class Health:
    """Condition of a robot."""

    condition: Condition
    """``ready`` if the robot accepts motions, or if a motion runs; otherwise the reason why it does not."""

    since: float
    """Time since which the condition holds, in seconds after the robot was first connected to."""

    reflex: int | None
    """Number of the reflex that holds the robot, if any."""

    attempts: int
    """Number of attempts to connect since the connection was lost; 0 while connected."""

    reconnects: int
    """Number of connections made after the first connection."""

    recoveries: int
    """Number of recoveries by the supervisor."""

    last_reconnect: float | None
    """Duration of the newest reconnection, from the loss of the connection, s."""

    last_recovery: float | None
    """Duration of the newest recovery by the supervisor, from the detection of the reflex, s."""

    @property
    def is_ready(self) -> bool:
        """True if the robot accepts motions, or if a motion runs."""
        return self.condition == "ready"
