"""Recordings of robots in files: how they are written, and what they hold.

``Recorder`` writes MCAP files, which viewers open, with every cycle, goals and how they end, events, requests and grippers, and
``RecordingFile`` reads them. Columns
of a motion as arrays, without a file, are what ``robot.record([...])`` is for.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from .errors import RecordError

__all__ = ["BlackBox", "Episode", "RecordStatus", "RecordedEvent", "RecordedRobot", "Recovery", "ReplayReport", "Spread"]


@dataclass(frozen=True)
class BlackBox:
    """The last seconds before an incident, written to a file of their own: the keyword ``black_box`` of ``Recorder.to_file``."""

    directory: str | PathLike[str]
    """Where the files go; made if it is not there. They are named by time (UTC), robot and cause."""

    before: float = 30.0
    """How much is kept before the incident, 1 to 300 s: some 0.7 MB a second and robot."""

    after: float = 1.0
    """How much is added after it, s, 60 at most. Another incident meanwhile gets no file of its own."""

    keep: int = 20
    """How many files are kept; the oldest are deleted."""


@dataclass(frozen=True)
class RecordStatus:
    """What was recorded so far, and what has failed."""

    cycles: int
    """Cycles taken, of all robots."""

    dropped: int
    """Cycles for which there was no room, as this computer or its disk was busy. The file says where they are missing."""

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
    """Why the recording ended early."""

    black_box_error: RecordError | None
    """Why the newest black box could not be written."""


@dataclass(frozen=True)
class RecordedRobot:
    """A robot of a recording."""

    name: str
    """Its name; empty for an only robot that was given none."""

    kind: str | None
    """``fr3`` or ``fer``; ``None`` if the file does not say."""

    metadata: dict[str, str]
    """What else was known of it."""


@dataclass(frozen=True)
class RecordedEvent:
    """Something that happened while a robot was recorded."""

    host_time: int
    """When this computer had word of it, ns since 1970."""

    time_ms: int
    """The robot's clock of the newest cycle before it; 0 if there was none."""

    kind: str
    """What kind of thing: ``goal``, ``outcome``, ``mode``, ``errors``, ``diagnosis``, ``request``, ``note``, ``episode_start``, ..."""

    level: str
    """How much it matters: ``info``, ``warning`` or ``error``."""

    source: str
    """Who says it."""

    text: str
    """What happened, in words."""

    goal: int | None
    """The number of the goal that it is about, as in the column ``goal``."""

    ending: str | None
    """Of an ``outcome``, how the goal came to its end: ``arrived``, ``superseded``, ``stopped``, ``reflex``, ``guard``, ..."""


@dataclass(frozen=True)
class Episode:
    """An attempt at a task, between two marks in a recording."""

    name: str
    """Its name."""

    task: str
    """What was to be done, in words."""

    success: bool | None
    """Whether it was done; ``None`` if nobody judged it."""

    begin: int
    """When it began, ns since 1970."""

    end: int
    """When it ended, ns since 1970: ``recording.between(episode.begin, episode.end)`` is the episode."""


@dataclass(frozen=True)
class Recovery:
    """What was recovered of a damaged file."""

    messages: int
    """Messages in the new file."""

    chunks: int
    """Chunks that were whole."""

    lost: int
    """Chunks that were not, and are left out."""

    damage: str | None
    """What was wrong with the file; ``None`` if nothing was."""


@dataclass(frozen=True)
class Spread:
    """How distances spread."""

    median: float
    """Half of them are less."""

    p95: float
    """95 % of them are less."""

    max: float
    """The greatest."""


@dataclass(frozen=True)
class ReplayReport:
    """How a replay went."""

    duration: float
    """From the first target to the last, s."""

    joints: Spread
    """Between the joints and where they were in the recording, the one that was furthest off in each state, rad."""

    position: Spread
    """Between the end effector and where it was in the recording, m."""

    states: int
    """States that were compared."""
