"""The network between a simulated robot and its clients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Network"]


@dataclass(frozen=True, kw_only=True)
class Network:
    """A network with faults, for datagrams in both directions. The command connection is not affected."""

    loss: float = 0.0
    """Probability that a datagram is lost, 0 to 1."""

    delay: float = 0.0
    """Delay of a packet, s."""

    jitter: float = 0.0
    """Largest additional delay of a datagram, s. Datagrams keep their order."""

    duplication: float = 0.0
    """Probability that a datagram arrives twice, 0 to 1."""

    stalls: bool = False
    """True if states are delayed as in the network interface of a Franka Emika Robot: for 2 to 7 ms, seven times a second."""

    cuts: Sequence[tuple[float, float]] = ()
    """Periods in which nothing arrives: pairs (from, to) of seconds since the robot's start. For example, a ``state().time``
    of 101.5 s is 1.5 s after the start."""

    seed: int = 1
    """Seed of the faults."""
