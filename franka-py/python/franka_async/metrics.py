"""Metrics of several robots as one OpenMetrics text, for Prometheus and other readers of that format.

::

    async def scrape(request):
        text = franka_async.metrics.text({"left": left, "right": right})
        return web.Response(body=text.encode(), headers={"Content-Type": franka_async.metrics.CONTENT_TYPE})

``robot.metrics()`` is the text of one robot. Readers refuse two such texts in one answer, because each text has an end mark.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from . import _native

if TYPE_CHECKING:
    from . import Robot, sync

__all__ = ["CONTENT_TYPE", "text"]

CONTENT_TYPE = _native._METRICS_CONTENT_TYPE
"""Content type of the text, for the answer to a scrape."""


def text(robots: Mapping[str, Robot | sync.Robot]) -> str:
    """Returns the metrics of these robots. The keys become the label ``robot``. Use the same keys in every run of the
    program.

    The text omits a robot that is not connected yet or was shut down. A robot whose connection was lost has
    ``franka_connected`` 0.
    """
    return _native._metrics([(label, getattr(robot, "_awaiting", robot)) for label, robot in robots.items()])
