"""Recordings of robots in files.

``Recorder`` writes MCAP files, which viewers open. They hold every cycle, goals and how they end, events, requests and
grippers. ``RecordingFile`` reads them. ``robot.record([...])`` returns columns of a motion as arrays, without a file.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from .errors import RecordError

__all__ = ["BlackBox", "Episode", "RecordStatus", "RecordedEvent", "RecordedRobot", "Recovery", "ReplayReport", "Spread"]


@dataclass(frozen=True)
class BlackBox:
    """The last seconds before an incident, written to a separate file: the keyword ``black_box`` of ``Recorder.to_file``."""

    directory: str | PathLike[str]
    """Directory of the files; made if it is missing. The files are named by time (UTC), robot and cause."""

    before: float = 30.0
    """Time that is kept before the incident, 1 to 300 s. A robot takes about 0.7 MB per second."""

    after: float = 1.0
    """Time that is added after it, s, at most 60. Another incident meanwhile gets no separate file."""

    keep: int = 20
    """Number of files that are kept; the oldest are deleted."""


@dataclass(frozen=True)
class RecordStatus:
    """Progress and errors of a recording."""

    cycles: int
    """Cycles taken, of all robots."""

    dropped: int
    """Cycles for which there was no room, as this computer or its disk was busy. The file records where they are missing."""

    events_dropped: int
    """Events for which there was no room."""

    bytes: int
    """Bytes in the files of the recording."""

    waiting: int
    """Bytes that wait for the disk."""

    files: list[Path]
    """The files of the recording, oldest first."""

    black_boxes: list[Path]
    """The files of the black box that were written."""

    error: RecordError | None
    """The error that ended the recording early."""

    black_box_error: RecordError | None
    """The error that prevented the newest black box."""


@dataclass(frozen=True)
class RecordedRobot:
    """A robot of a recording."""

    name: str
    """Its name; empty for a single robot without a name."""

    kind: str | None
    """``fr3`` or ``fer``; ``None`` if the file does not contain it."""

    metadata: dict[str, str]
    """Other metadata of the robot."""


@dataclass(frozen=True)
class RecordedEvent:
    """Something that happened while a robot was recorded."""

    host_time: int
    """Time at which this computer was informed of it, ns since 1970."""

    time_ms: int
    """The robot's clock of the newest cycle before it; 0 if no cycle came before."""

    kind: str
    """Kind of the event: ``goal``, ``outcome``, ``mode``, ``errors``, ``diagnosis``, ``request``, ``note``,
    ``episode_start``, ..."""

    level: str
    """Severity: ``info``, ``warning`` or ``error``."""

    source: str
    """Source of the event."""

    text: str
    """Description in words."""

    goal: int | None
    """The number of the goal that it is about, as in the column ``goal``."""

    ending: str | None
    """The way in which the goal of an ``outcome`` ended: ``arrived``, ``superseded``, ``stopped``, ``reflex``, ``guard``, ..."""


@dataclass(frozen=True)
class Episode:
    """An attempt at a task, between two marks in a recording."""

    name: str
    """Its name."""

    task: str
    """Task of the episode, in words."""

    success: bool | None
    """True if the task was done; ``None`` if it was not judged."""

    begin: int
    """Begin, ns since 1970."""

    end: int
    """End, ns since 1970: ``recording.between(episode.begin, episode.end)`` is the episode."""


@dataclass(frozen=True)
class Recovery:
    """The recovered part of a damaged file."""

    messages: int
    """Messages in the new file."""

    chunks: int
    """Chunks that were intact."""

    lost: int
    """Chunks that were damaged, and are left out."""

    damage: str | None
    """Damage of the file; ``None`` if it has none."""


@dataclass(frozen=True)
class Spread:
    """Distribution of distances."""

    median: float
    """Median."""

    p95: float
    """95th percentile."""

    max: float
    """Maximum."""


@dataclass(frozen=True)
class ReplayReport:
    """Result of a replay."""

    duration: float
    """Time from the first target to the last, s."""

    joints: Spread
    """Distances between the joints and their positions in the recording, rad. Each state counts with its furthest joint."""

    position: Spread
    """Distances between the end effector and its place in the recording, m."""

    states: int
    """Number of states that were compared."""
