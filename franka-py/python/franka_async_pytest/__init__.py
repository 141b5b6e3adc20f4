"""Fixtures for pytest: simulated robots in virtual time, and connections to them. Installed with the package.

* ``sim_fr3``, ``sim_fer``: a running ``Sim``.
* ``fr3``, ``fer``: a connected ``Robot``, to ``sim_fr3`` or ``sim_fer``.
* ``franka_sim``: a ``Sim``. The test runs twice, with a Franka Research 3 and with a Franka Emika Robot.
* ``franka_robot``: a connected ``Robot``, to ``franka_sim``.
* ``franka_options``: keyword arguments of ``Sim.fr3`` and ``Sim.fer``, as a ``dict``. Override it, or see below.

The next millisecond of a simulated robot begins with the command of the test, however busy the machine is, and its arm sticks and
flexes as real ones do. A marker changes that for a test, a class or a module::

    @pytest.mark.franka(ideal=True, seed=7, hand=True)
    def test_grasp(fr3, sim_fr3):
        ...

So does a parameter: ``ideal``, ``realistic``, or a ``dict`` of arguments::

    @pytest.mark.parametrize("franka_options", ["ideal", "realistic"], indirect=True)
    def test_reach(fr3):
        fr3.move_by([0.0, 0.0, 0.05]).wait()

A fixture of the same name in a test module or a ``conftest.py`` takes the place of one of these. Nothing but this module is loaded
before a test asks for one.

In a test that is a coroutine, ``await`` stands in the place of ``wait()``.

A test fails at its end if something with ``once_moving=True`` still waits for a motion: the disturbance did not happen.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from franka_async import Robot, Sim

__all__ = ["fer", "fr3", "franka_options", "franka_robot", "franka_sim", "sim_fer", "sim_fr3"]


def pytest_configure(config: pytest.Config) -> None:
    """Describes the marker."""
    config.addinivalue_line("markers", "franka(**options): keyword arguments of the simulated robots of a test")


@pytest.fixture
def franka_options(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Keyword arguments of the simulated robots: virtual time, then the markers, the nearest last, then the parameter."""
    options: dict[str, Any] = {"virtual_time": True}
    for marker in reversed(list(request.node.iter_markers("franka"))):
        if marker.args:
            raise pytest.UsageError(f"the marker franka takes keyword arguments, got {marker.args!r}")
        options.update(marker.kwargs)
    parameter = getattr(request, "param", {})
    if parameter in ("ideal", "realistic"):
        options["ideal"] = parameter == "ideal"
    elif isinstance(parameter, dict):
        options.update(parameter)
    else:
        raise pytest.UsageError(f"franka_options is {parameter!r}, expected 'ideal', 'realistic' or a dict")
    return options


def _sim(kind: str, options: dict[str, Any]) -> Iterator[Sim]:
    import franka_async

    with getattr(franka_async.Sim, kind)(**options) as sim:
        yield sim
        if sim.waiting:
            text = f"{sim.waiting} of once_moving=True still wait: the arm has not moved since; sim.let_go() takes them back"
            pytest.fail(text, pytrace=False)


def _robot(sim: Sim) -> Iterator[Robot]:
    import franka_async

    # A busy machine may delay the simulator for longer than the second after which a link counts as lost.
    robot = franka_async.Robot(sim.address, realtime="ignore", link_timeout=10.0)
    robot.connect().wait()
    try:
        yield robot
    finally:
        robot.shutdown().wait()


@pytest.fixture
def sim_fr3(franka_options: dict[str, Any]) -> Iterator[Sim]:
    """A simulated Franka Research 3."""
    yield from _sim("fr3", franka_options)


@pytest.fixture
def sim_fer(franka_options: dict[str, Any]) -> Iterator[Sim]:
    """A simulated Franka Emika Robot."""
    yield from _sim("fer", franka_options)


@pytest.fixture(params=["fr3", "fer"])
def franka_sim(request: pytest.FixtureRequest, franka_options: dict[str, Any]) -> Iterator[Sim]:
    """A simulated robot of each kind."""
    yield from _sim(request.param, franka_options)


@pytest.fixture
def fr3(sim_fr3: Sim) -> Iterator[Robot]:
    """A connection to a simulated Franka Research 3."""
    yield from _robot(sim_fr3)


@pytest.fixture
def fer(sim_fer: Sim) -> Iterator[Robot]:
    """A connection to a simulated Franka Emika Robot."""
    yield from _robot(sim_fer)


@pytest.fixture
def franka_robot(franka_sim: Sim) -> Iterator[Robot]:
    """A connection to a simulated robot of each kind."""
    yield from _robot(franka_sim)
