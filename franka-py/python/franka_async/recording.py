"""Recordings of robots in files.

``Recorder`` writes MCAP files, which viewers open. The files contain every cycle, goals and how they end, events, requests
and states of grippers. ``RecordingFile`` reads the files. ``robot.record([...])`` returns columns of a motion as arrays,
without a file.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from .errors import RecordError

__all__ = ["BlackBox", "Episode", "RecordStatus", "RecordedEvent", "RecordedRobot", "Recovery", "ReplayReport", "Spread"]


@dataclass(frozen=True)
class BlackBox:
    """Options of a black box, the keyword ``black_box`` of ``Recorder.to_file``. It writes the last seconds before an
    incident to a separate file.
    """

    directory: str | PathLike[str]
    """Directory of the files; the recorder creates it if necessary. The name of a file contains time (UTC), robot and cause."""

    before: float = 30.0
    """Recorded time before the incident, 1 to 300 s. A robot needs about 0.7 MB per second."""

    after: float = 1.0
    """Recorded time after the incident, s, at most 60. Another incident in this time gets no separate file."""

    keep: int = 20
    """Number of files to keep. The recorder deletes the oldest."""


@dataclass(frozen=True)
class RecordStatus:
    """Progress and errors of a recording."""

    cycles: int
    """Number of recorded cycles, of all robots."""

    dropped: int
    """Number of cycles without space, because this computer or its disk was busy. The file records where cycles are missing."""

    events_dropped: int
    """Number of events without space."""

    bytes: int
    """Number of bytes in the files of the recording."""

    waiting: int
    """Number of bytes that wait for the disk."""

    files: list[Path]
    """The files of the recording, oldest first."""

    black_boxes: list[Path]
    """The written files of the black box."""

    error: RecordError | None
    """The error that ended the recording early."""

    black_box_error: RecordError | None
    """The error that occurred when the newest black box was written."""


@dataclass(frozen=True)
class RecordedRobot:
    """A robot of a recording."""

    name: str
    """Name of the robot; empty for a single robot without a name."""

    kind: str | None
    """``fr3`` or ``fer``; ``None`` if the file does not name the kind."""

    metadata: dict[str, str]
    """Other metadata of the robot."""


@dataclass(frozen=True)
class RecordedEvent:
    """An event in a recording."""

    host_time: int
    """Time at which this computer learned of the event, ns since 1970."""

    time_ms: int
    """Robot clock of the newest cycle before the event, ms; 0 without such a cycle."""

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
    """Number of the goal to which the event belongs, as in the column ``goal``."""

    ending: str | None
    """End of the goal of an ``outcome``: ``arrived``, ``superseded``, ``stopped``, ``reflex``, ``guard``, ..."""


@dataclass(frozen=True)
class Episode:
    """An attempt at a task, between two marks in a recording."""

    name: str
    """Name of the episode."""

    task: str
    """Task of the episode, in words."""

    success: bool | None
    """True if the task succeeded; ``None`` if it was not judged."""

    begin: int
    """Time of the beginning, ns since 1970."""

    end: int
    """Time of the end, ns since 1970. ``recording.between(episode.begin, episode.end)`` returns the episode."""


@dataclass(frozen=True)
class Recovery:
    """Result of the recovery of a damaged file."""

    messages: int
    """Number of messages in the new file."""

    chunks: int
    """Number of intact chunks."""

    lost: int
    """Number of damaged chunks, which were omitted."""

    damage: str | None
    """Description of the damage; ``None`` if the file was not damaged."""


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
    """Distances of the joints from their recorded positions, rad. Each state counts with the joint that is furthest away."""

    position: Spread
    """Distances of the end effector from its recorded position, m."""

    states: int
    """Number of states that were compared."""
