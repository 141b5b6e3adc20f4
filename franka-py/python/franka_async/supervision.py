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
    """Time between two attempts: ``first`` seconds after the first one, twice as long as before after each other one.

    The first attempt is made at once.
    """

    first: float = 0.1
    """The first pause, s."""

    most: float = 5.0
    """The longest pause, s."""

    jitter: float = 0.3
    """Random share of each pause, 0 to 1: a pause is shorter by up to this share."""


@dataclass(frozen=True, kw_only=True)
class Policy:
    """Policy of the supervisor of a robot when the connection or the robot fails.

    The default reconnects for as long as it takes, never recovers from a reflex, and refuses motions meanwhile. No policy
    resumes a movement: motions and sessions end with the mishap.

    Raises ``ValueError`` for values that make no sense.
    """

    recover: tuple[int, float] | None = None
    """Limit of automatic recoveries from reflexes: a count, and the window in seconds that it holds for. Attempts that fail
    count."""

    only: Iterable[str] | None = None
    """Limits recovery to reflexes whose errors are all among these, by the vendor's names. Needs ``recover``."""

    ask_first: bool = False
    """Recovers only after someone has agreed: by ``robot.agree(reflex)``, or a function ``ask_before_recovery``."""

    reconnect: Backoff | None = field(default_factory=Backoff)
    """Pauses between two attempts to connect, and between two attempts to recover; ``None`` makes no new connection."""

    give_up_after: float | None = None
    """Seconds after which the supervisor gives up a lost connection; ``None``: never."""

    silence: float = 3.0
    """Seconds that the robot may be silent on an open connection, before the connection is closed and a new one made."""

    motions_wait: float | None = None
    """Seconds that a motion waits while the supervisor reconnects or recovers; ``None`` refuses it."""

    seed: int | None = None
    """Seed of the random part of pauses; ``None``: each robot draws its own."""

    def __post_init__(self) -> None:
        if self.only is not None:
            names = [self.only] if isinstance(self.only, str) else self.only
            object.__setattr__(self, "only", tuple(names))
        _native._check_policy(self)


@dataclass(frozen=True)
class Reflex:
    """The robot stopped itself."""

    number: int
    """Its number, counted from 1, as ``robot.agree(number)`` takes it."""

    errors: list[str]
    """The errors that hold the robot, by the vendor's names."""

    error: Exception | None
    """The ``ControlError`` of the motion that ran, with its log and diagnosis; ``None`` if no motion of this program did."""

    differences: str | None = None
    """Differences from the robot before the connection was lost, if it is not recognised. Someone has to agree then."""


@dataclass(frozen=True)
class CloseReason:
    """The reason for the end of a connection."""

    kind: str
    """``closed_by_us``, ``closed_by_peer``, ``io``, ``protocol``, ``thread_ended``, ``silent``, ``given_up``, ``another_robot``
    or ``runtime_ended``."""

    text: str
    """The reason in words."""

    party: str
    """Who can act on it: ``caller``, ``robot``, ``link``, ``host`` or ``peer``."""


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
    """Number of events that are missing before this one, because the listener lagged: it may lag 256 behind."""

    fields: Mapping[str, Any]
    """The fields of this kind."""

    text: str
    """One line for people."""

    def __str__(self) -> str:
        return self.text

    def __getattr__(self, name: str) -> Any:
        # Only for names that are no attributes otherwise; `fields` itself is missing while an event is unpickled.
        fields = self.__dict__.get("fields", {})
        if name in fields:
            return fields[name]
        kind = self.__dict__.get("kind")
        raise AttributeError(f"an event of the kind {kind!r} has no {name!r}, but {sorted(fields)}")


@dataclass(frozen=True)
class Health:
    """Condition of a robot."""

    condition: Condition
    """``ready`` if the robot takes motions, or a motion runs; otherwise the reason why it does not."""

    since: float
    """Time since which the condition holds, in seconds after the robot was first connected to."""

    reflex: int | None
    """Number of the reflex that holds the robot, if any."""

    attempts: int
    """Attempts to connect since the connection was lost; 0 while connected."""

    reconnects: int
    """Connections made after the first one."""

    recoveries: int
    """Recoveries by the supervisor."""

    last_reconnect: float | None
    """Duration of the newest reconnect, from the loss on, s."""

    last_recovery: float | None
    """Duration of the newest recovery by the supervisor, from the notice of the reflex on, s."""

    @property
    def is_ready(self) -> bool:
        """True if the robot takes motions, or one runs."""
        return self.condition == "ready"
