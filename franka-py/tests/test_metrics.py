"""Metrics of several robots as one text."""

from __future__ import annotations

from collections import Counter

import pytest
from conftest import PATIENT, connection, until

import franka_async
from franka_async import Sim, metrics, sync


def test_metrics_of_several_robots_are_one_text(sim: Sim) -> None:
    """Follows OpenMetrics: one end, and every family once, with all of its samples."""
    left, absent = connection(sim), franka_async.Robot("127.255.255.1")
    left.connect().wait()
    with Sim.fer(virtual_time=True, patience=5.0) as other, sync.Robot(other.address, **PATIENT) as right:
        text = metrics.text({"left": left, 'the "right"': right, "absent": absent})
        assert text.endswith("# EOF\n") and text.count("# EOF") == 1
        types = Counter(line.split()[2] for line in text.splitlines() if line.startswith("# TYPE"))
        assert len(types) > 10 and set(types.values()) == {1}
        assert 'franka_connected{robot="left"} 1' in text and r'franka_connected{robot="the \"right\""} 1' in text
        assert "absent" not in text and sim.address not in text
        # The families of one robot's own text, and no others.
        alone = {line.split()[2] for line in left.metrics().splitlines() if line.startswith("# TYPE")}
        assert alone <= set(types)
    # A lost robot is seen, a robot that was shut down has left.
    sim.stop()
    until(lambda: 'franka_connected{robot="left"} 0' in metrics.text({"left": left}))
    left.shutdown().wait()
    assert 'robot="left"' not in metrics.text({"left": left}) and metrics.text({}).endswith("# EOF\n")
    assert metrics.CONTENT_TYPE.startswith("application/openmetrics-text")
    with pytest.raises(TypeError):
        metrics.text({"left": "127.0.0.1"})  # type: ignore[dict-item]
