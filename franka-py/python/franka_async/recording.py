"""Recordings of robots in files: how they are written, and what they hold.

``Recorder`` writes MCAP files, which viewers open, with every cycle, goals and how they end, events, requests and grippers. Columns
of a motion as arrays, without a file, are what ``robot.record([...])`` is for.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from .errors import RecordError

__all__ = ["BlackBox", "RecordStatus"]


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
